/* SPDX-License-Identifier: MIT */
/* environment.c: sky or a map of it, chequered floor and solids, for any ray: the twin of shaders/environment.glsl. */
#include "passes/environment.h"

#include "scene/solid.h"

static const double *map_texel(const ssfr_field *map, int x, int y)
{
    return ssfr_field_at(map, (x + map->w) % map->w, ssfr_clamp_int(y, 0, map->h - 1));
}

/* Between four texels: around the globe they close up, at the poles they end. A zero vector is level, towards +z. */
static void map_at(const ssfr_field *map, const double dir[3], double color[3])
{
    const double level = fmax(sqrt(dir[0] * dir[0] + dir[2] * dir[2]), 1e-20);
    const double z = dir[0] == 0 && dir[2] == 0 ? 1 : dir[2];
    const double u = (0.5 - atan2(dir[0], z) / (2 * M_PI)) * map->w - 0.5;
    const double v = atan2(level, dir[1]) / M_PI * map->h - 0.5;
    const double a = u - floor(u), b = v - floor(v);
    const int x = (int)floor(u), y = (int)floor(v);
    for (int k = 0; k < 3; k++)
        color[k] = ssfr_mix(ssfr_mix(map_texel(map, x, y)[k], map_texel(map, x + 1, y)[k], a),
                            ssfr_mix(map_texel(map, x, y + 1)[k], map_texel(map, x + 1, y + 1)[k], a), b);
}

static bool has_floor(const ssfr_block *b)
{
    return b->right[3] > -SSFR_SURFACE;
}

/* Below the horizon, the horizon's; the map's own without a floor. */
void ssfr_environment_sky(const ssfr_frame *frame, const double dir[3], double color[3])
{
    const ssfr_block *b = &frame->block;
    const double t = sqrt(fmax(dir[1], 0)), level[3] = {dir[0], has_floor(b) ? fmax(dir[1], 0) : dir[1], dir[2]};
    if (frame->scene->environment)
        map_at(frame->scene->environment, level, color);
    else
        for (int k = 0; k < 3; k++) color[k] = ssfr_mix(b->horizon[k], b->zenith[k], t);
}

double ssfr_environment_lambert(const ssfr_block *b, const double normal[3])
{
    const double ambient = b->fluid[3];
    return ambient + (1 - ambient) * b->light[3] * fmax(ssfr_dot(normal, b->light), 0);
}

/* The tiles' contrast fades where one of them is no wider than a few pixels: no aliasing. */
static double floor_shade(const ssfr_block *b, double x, double z, double footprint)
{
    static const double upwards[3] = {0, 1, 0};
    const double tile = b->floor[0], sum = floor((b->up[3] + x) / tile) + floor((b->back[3] + z) / tile);
    const bool odd = fmod(fabs(sum), 2) >= 0.5;
    const double contrast = ssfr_clamp(1.5 - 4 * footprint / tile, 0, 1);
    const double mean = 0.5 * (b->floor[1] + b->floor[2]), side = 0.5 * (b->floor[1] - b->floor[2]);
    return (mean + (odd ? -side : side) * contrast) * ssfr_environment_lambert(b, upwards);
}

static const double HAZES = 16;

/* Nothing is left of the floor beyond HAZES times the haze: it ends there, before a float has no digits left. */
static double meet_floor(const ssfr_block *b, const double origin[3], const double dir[3], double color[3])
{
    const double t = (b->right[3] - origin[1]) / dir[1], length = sqrt(ssfr_dot(dir, dir));
    if (!(has_floor(b) && dir[1] != 0 && t > 0 && t * length < HAZES * b->floor[3])) return SSFR_EMPTY;
    const double footprint = t * b->image[3] * ssfr_dot(dir, dir) / fmax(fabs(dir[1]), 1e-6);
    const double shade = floor_shade(b, origin[0] + t * dir[0], origin[2] + t * dir[2], footprint);
    const double clear = exp(-t * length / b->floor[3]);
    for (int k = 0; k < 3; k++) color[k] = ssfr_mix(color[k], shade, clear);
    return t;
}

int ssfr_environment_meet(const ssfr_frame *frame, const ssfr_solid_set solids, const double origin[3],
                          const double dir[3], double *t, double normal[3])
{
    int first = -1;
    for (int i = 0; i < frame->n_solids; i++) {
        double n[3];
        if (!(solids[i / 32] >> i % 32 & 1)) continue;
        const double hit = ssfr_solid_enter(&frame->solids[i], origin, dir, n);
        if (!(hit > 0 && hit < *t)) continue;
        first = i;
        *t = hit;
        memcpy(normal, n, sizeof n);
    }
    return first;
}

double ssfr_environment_trace(const ssfr_frame *frame, const ssfr_solid_set solids, const double origin[3],
                              const double dir[3], double color[3])
{
    const ssfr_block *b = &frame->block;
    double unit[3] = {dir[0], dir[1], dir[2]}, normal[3];
    ssfr_normalize(unit);
    ssfr_environment_sky(frame, unit, color);
    double t = meet_floor(b, origin, dir, color);
    const int i = ssfr_environment_meet(frame, solids, origin, dir, &t, normal);
    for (int k = 0; k < 3 && i >= 0; k++) color[k] = b->solid[i][4][k] * ssfr_environment_lambert(b, normal);
    return t;
}

void ssfr_environment_defines(const ssfr_frame *frame, bool solids, bool meshes, char text[SSFR_DEFINES])
{
    bool shapes = false;
    for (int i = 0; i < frame->n_solids; i++)
        shapes |= frame->solids[i].shape != SSFR_BOX && frame->solids[i].shape != SSFR_MESH;
    const bool any = solids && frame->n_solids > 0;
    const int level = any && meshes && frame->n_meshes ? 3 : any && shapes ? 2 : any ? 1 : 0;
    snprintf(text, SSFR_DEFINES, "#define SOLIDS %d\n#define MAP %d\n", level, frame->scene->environment != NULL);
}

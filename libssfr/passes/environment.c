/* SPDX-License-Identifier: MIT */
/* environment.c: sky, chequered floor and boxes, for any ray: the twin of shaders/environment.glsl. */
#include "passes/environment.h"

void ssfr_environment_sky(const ssfr_block *block, const double dir[3], double color[3])
{
    const double t = sqrt(fmax(dir[1], 0));
    for (int k = 0; k < 3; k++) color[k] = ssfr_mix(block->horizon[k], block->zenith[k], t);
}

static double lambert(const ssfr_block *b, const double normal[3])
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
    return (mean + (odd ? -side : side) * contrast) * lambert(b, upwards);
}

static double enter_solid(const double solid[5][4], const double origin[3], const double dir[3], double normal[3])
{
    double enter = -SSFR_EMPTY, leave = SSFR_EMPTY;
    double to[3];
    for (int k = 0; k < 3; k++) to[k] = solid[0][k] - origin[k], normal[k] = 0;
    for (int k = 0; k < 3; k++) {
        const double *axis = solid[1 + k], half = axis[3];
        const double d = ssfr_dot(dir, axis), c = ssfr_dot(to, axis), side = d > 0 ? 1 : -1;
        if (d == 0) {
            if (fabs(c) > half) leave = -SSFR_EMPTY;
            continue;
        }
        if ((c - side * half) / d > enter) {
            enter = (c - side * half) / d;
            for (int j = 0; j < 3; j++) normal[j] = -side * axis[j];
        }
        leave = fmin(leave, (c + side * half) / d);
    }
    return enter < leave && enter > 0 ? enter : -1;
}

static const double HAZES = 16;

double ssfr_environment_trace(const ssfr_block *b, const double origin[3], const double dir[3], double color[3])
{
    double t = SSFR_EMPTY, unit[3] = {dir[0], dir[1], dir[2]}, normal[3];
    const double length = sqrt(ssfr_dot(dir, dir));
    const double floor_t = (b->right[3] - origin[1]) / dir[1];
    ssfr_normalize(unit);
    ssfr_environment_sky(b, unit, color);
    /* Nothing is left of the floor beyond HAZES times the haze: it ends there, before a float has no digits left. */
    if (b->right[3] > -SSFR_SURFACE && dir[1] != 0 && floor_t > 0 && floor_t * length < HAZES * b->floor[3]) {
        t = floor_t;
        const double footprint = t * b->image[3] * ssfr_dot(dir, dir) / fmax(fabs(dir[1]), 1e-6);
        const double shade = floor_shade(b, origin[0] + t * dir[0], origin[2] + t * dir[2], footprint);
        const double clear = exp(-t * length / b->floor[3]);
        for (int k = 0; k < 3; k++) color[k] = ssfr_mix(color[k], shade, clear);
    }
    for (int i = 0; i < (int)b->zenith[3]; i++) {
        const double hit = enter_solid(b->solid[i], origin, dir, normal);
        if (!(hit > 0 && hit < t)) continue;
        t = hit;
        for (int k = 0; k < 3; k++) color[k] = b->solid[i][4][k] * lambert(b, normal);
    }
    return t;
}

/* SPDX-License-Identifier: MIT */
/* optics.c: refraction, attenuation, reflection and highlight at a surface of water, in double. */
#include "passes/optics.h"

#include "passes/environment.h"

const char *const ssfr_optics_reflections[] = {"sky", "scene", NULL};
const char *const ssfr_optics_attenuations[] = {"beer_lambert", "single", NULL};

bool ssfr_optics_defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    const ssfr_optics *optics = run->coeffs;
    const bool solids = optics->reflection != 0;
    (void)i;
    ssfr_environment_defines(run->frame, solids, solids, text);
    return true;
}

double ssfr_optics_value(const ssfr_field *field, int x, int y, double most)
{
    const double value = *ssfr_field_fetch(field, x, y);
    return value > 0 ? fmin(value, most) : 0;
}

ssfr_surface ssfr_surface_make(const ssfr_run *run, int x, int y, const double position[3], const double n[3])
{
    ssfr_surface s = {.run = run, .optics = run->coeffs, .block = &run->frame->block, .x = x, .y = y, .z = position[2]};
    if (!ssfr_is_surface(s.z)) return s;
    for (int k = 0; k < 3; k++) s.n[k] = n[k], s.position[k] = position[k], s.view[k] = -position[k];
    ssfr_normalize(s.view);
    s.cosine = ssfr_clamp(ssfr_dot(s.n, s.view), 0, 1);
    return s;
}

ssfr_surface ssfr_surface_at(const ssfr_run *run, int x, int y)
{
    const double z = *ssfr_field_fetch(run->in[SSFR_OPTICS_DEPTH], x, y);
    double position[3];
    ssfr_slope_at(&run->frame->block, x + 0.5, y + 0.5, position);
    for (int k = 0; k < 2; k++) position[k] *= -z;
    position[2] = z;
    return ssfr_surface_make(run, x, y, position, ssfr_field_fetch(run->in[SSFR_OPTICS_NORMAL], x, y));
}

/* Between the four pixels around (x, y), px; centres stand at halves. */
static void fetch_linear(const ssfr_field *f, double x, double y, double out[3])
{
    const double fx = floor(x - 0.5), fy = floor(y - 0.5), ax = x - 0.5 - fx, ay = y - 0.5 - fy;
    const int i = (int)fx, j = (int)fy;
    for (int k = 0; k < 3; k++)
        out[k] = ssfr_mix(ssfr_mix(ssfr_field_fetch(f, i, j)[k], ssfr_field_fetch(f, i + 1, j)[k], ax),
                          ssfr_mix(ssfr_field_fetch(f, i, j + 1)[k], ssfr_field_fetch(f, i + 1, j + 1)[k], ax), ay);
}

void ssfr_surface_refracted(const ssfr_surface *s, const double d[2], double out[3])
{
    double x = s->x + 0.5, y = s->y + 0.5;
    const double px = ssfr_clamp(x + d[0], 0, s->run->w), py = ssfr_clamp(y + d[1], 0, s->run->h);
    const ssfr_field *depth = s->run->in[SSFR_OPTICS_SCENE_DEPTH];
    const double behind = *ssfr_field_fetch(depth, (int)floor(px), (int)floor(py));
    if (!(s->optics->reject && behind > s->z)) x = px, y = py;
    fetch_linear(s->run->in[SSFR_OPTICS_SCENE_COLOR], x, y, out);
}

void ssfr_surface_through(const ssfr_surface *s, double thickness, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = exp(-(s->optics->single ? s->optics->attenuation : s->block->absorption[k]) * thickness);
}

double ssfr_surface_fresnel(const ssfr_surface *s)
{
    const double ior = s->block->absorption[3], cosine = s->cosine;
    const double inside = sqrt(ior * ior - 1 + cosine * cosine); /* ior times the cosine inside the fluid */
    const double across = (cosine - inside) / fmax(cosine + inside, 1e-20); /* 0 / 0 for index 1 at grazing angles */
    const double along = (ior * ior * cosine - inside) / fmax(ior * ior * cosine + inside, 1e-20);
    return 0.5 * (across * across + along * along);
}

void ssfr_surface_reflected(const ssfr_surface *s, double out[3])
{
    double mirror[3], dir[3], origin[3];
    ssfr_solid_set solids;
    const double turn = 2 * ssfr_dot(s->n, s->view);
    for (int k = 0; k < 3; k++) mirror[k] = turn * s->n[k] - s->view[k];
    ssfr_world_from_eye(s->block, mirror, dir);
    ssfr_world_from_eye(s->block, s->position, origin);
    ssfr_normalize(dir);
    ssfr_frame_all_solids(s->run->frame, solids);
    if (s->optics->reflection == 0) ssfr_environment_sky(s->run->frame, dir, out);
    else ssfr_environment_trace(s->run->frame, solids, origin, dir, out);
}

double ssfr_surface_highlight(const ssfr_surface *s)
{
    double n[3], half[3];
    ssfr_world_from_eye(s->block, s->n, n);
    ssfr_world_from_eye(s->block, s->view, half);
    for (int k = 0; k < 3; k++) half[k] += s->block->light[k];
    ssfr_normalize(half);
    const double lit = ssfr_dot(n, s->block->light) > 0 ? s->block->light[3] : 0;
    return lit * s->optics->specular * pow(fmax(ssfr_dot(n, half), 0), s->optics->shininess);
}

/* SPDX-License-Identifier: MIT */
/* spray_cpu.c: the sum of the spray's light at each pixel, in double. */
#include "passes/spray.h"

static void add(const ssfr_run *run, const ssfr_fragment *f, double *pixel)
{
    const ssfr_spray_coeffs *c = run->coeffs;
    double before = *ssfr_field_fetch(run->in[SSFR_SPRAY_SCENE_DEPTH], f->x, f->y);
    for (int k = SSFR_SPRAY_DEPTH; k <= SSFR_SPRAY_FOAM_DEPTH && c->by_surface; k++)
        before = fmax(before, *ssfr_field_fetch(run->in[k], f->x, f->y));
    if (f->front < before) return;
    const double share = exp(-c->falloff * (c->exponential ? sqrt(f->r2) : f->r2));
    for (int k = 0; k < 3; k++) pixel[k] += c->color[k] * share;
}

void ssfr_spray_cpu(const ssfr_run *run)
{
    ssfr_streak_cpu(run, add);
}

/* SPDX-License-Identifier: MIT */
/* thickness_cpu.c: the sum of the particles' chords at each pixel, in double. */
#include "passes/thickness.h"

double ssfr_thickness_of(const ssfr_run *run, ssfr_fragment *f)
{
    const ssfr_thickness_coeffs *c = run->coeffs;
    const double scene = *ssfr_field_fetch(run->in[0], f->x, f->y), back = f->back;
    if (f->front < scene) return 0;
    double t = f->chord * c->scale;
    if (c->exponential) t *= exp(-2 * f->r2);
    if (c->clipped) {
        f->back = fmax(back, scene);
        t *= (f->front - f->back) / fmax(f->front - back, 1e-20);
    }
    return t;
}

static void add(const ssfr_run *run, const ssfr_fragment *hit, double *pixel)
{
    ssfr_fragment f = *hit;
    ssfr_thickness_add(((const ssfr_thickness_coeffs *)run->coeffs)->half, ssfr_thickness_of(run, &f), pixel);
}

void ssfr_thickness_cpu(const ssfr_run *run)
{
    ssfr_splat_cpu(run, add);
}

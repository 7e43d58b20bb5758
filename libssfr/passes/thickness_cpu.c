/* SPDX-License-Identifier: MIT */
/* thickness_cpu.c: the sum of the particles' chords at each pixel, in double. */
#include "passes/thickness.h"

static void add(const ssfr_run *run, const ssfr_fragment *f, double *pixel)
{
    const ssfr_thickness_coeffs *c = run->coeffs;
    const double scene = *ssfr_field_fetch(run->in[0], f->x, f->y);
    double t = f->chord * c->scale;
    if (f->front < scene) return;
    if (c->exponential) t *= exp(-2 * f->r2);
    if (c->clipped) t *= (f->front - fmax(f->back, scene)) / fmax(f->front - f->back, 1e-20);
    *pixel += t;
}

void ssfr_thickness_cpu(const ssfr_run *run)
{
    ssfr_splat_cpu(run, add);
}

/* SPDX-License-Identifier: MIT */
/* thickness_cpu.c: the sum of the particles' chords at each pixel, in double. */
#include "passes/thickness.h"

double ssfr_thickness_of(const ssfr_run *run, const ssfr_thickness_sum *sum, ssfr_fragment *f)
{
    const double scene = *ssfr_field_fetch(run->in[0], f->x, f->y), back = f->back;
    if (f->front < scene) return 0;
    double t = f->chord * sum->scale;
    if (sum->exponential) t *= exp(-2 * f->r2);
    t /= f->area;
    if (sum->clipped) {
        f->back = fmax(back, scene);
        t *= (f->front - f->back) / fmax(f->front - back, 1e-20);
    }
    return t;
}

static void add(const ssfr_run *run, const ssfr_fragment *hit, double *pixel)
{
    const ssfr_thickness_sum *sum = &((const ssfr_thickness_coeffs *)run->coeffs)->sum;
    ssfr_fragment f = *hit;
    ssfr_thickness_add(sum->half, ssfr_thickness_of(run, sum, &f), pixel);
}

void ssfr_thickness_cpu(const ssfr_run *run)
{
    ssfr_splat_cpu(run, add);
}

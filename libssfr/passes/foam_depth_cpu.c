/* SPDX-License-Identifier: MIT */
/* foam_depth_cpu.c: the nearest foam at each pixel, in double. */
#include "passes/foam_depth.h"

static void keep_nearest(const ssfr_run *run, const ssfr_fragment *f, double *pixel)
{
    if (f->front >= *ssfr_field_fetch(run->in[0], f->x, f->y)) *pixel = fmax(*pixel, f->front);
}

void ssfr_foam_depth_cpu(const ssfr_run *run)
{
    ssfr_streak_cpu(run, keep_nearest);
}

/* SPDX-License-Identifier: MIT */
/* foam_depth_cpu.c: the nearest foam at each pixel, in double. */
#include "passes/foam_depth.h"

void ssfr_foam_depth_cpu(const ssfr_run *run)
{
    ssfr_streak_cpu(run, ssfr_splat_keep_nearest);
}

/* SPDX-License-Identifier: MIT */
/* sphere_depth_cpu.c: the nearest sphere at each pixel, in double. */
#include "passes/sphere_depth.h"

void ssfr_sphere_depth_cpu(const ssfr_run *run)
{
    ssfr_splat_cpu(run, ssfr_splat_keep_nearest);
}

/* SPDX-License-Identifier: MIT */
/* sphere_depth.h: the frontmost surface of the particles' spheres; see sphere_depth.c. */
#ifndef SSFR_SPHERE_DEPTH_H
#define SSFR_SPHERE_DEPTH_H

#include "passes/splat.h"

void ssfr_sphere_depth_cpu(const ssfr_run *run);

#endif

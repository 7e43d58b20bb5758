/* SPDX-License-Identifier: MIT */
/* spray.h: spray over the finished picture; see spray.c. */
#ifndef SSFR_SPRAY_H
#define SSFR_SPRAY_H

#include "passes/streak.h"

enum { SSFR_SPRAY_GAUSSIAN, SSFR_SPRAY_EXPONENTIAL };
enum { SSFR_SPRAY_BEHIND_SCENE, SSFR_SPRAY_BEHIND_SURFACE };
enum { SSFR_SPRAY_SCENE_DEPTH = 1, SSFR_SPRAY_DEPTH, SSFR_SPRAY_FOAM_DEPTH }; /* inputs */

typedef struct ssfr_spray_coeffs {
    ssfr_streak streak;
    double color[3]; /* of the middle of a particle, linear */
    double falloff;
    int exponential, by_surface;
} ssfr_spray_coeffs;

void ssfr_spray_cpu(const ssfr_run *run);

#endif

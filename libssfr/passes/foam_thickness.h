/* SPDX-License-Identifier: MIT */
/* foam_thickness.h: length of foam along the view ray; see foam_thickness.c. */
#ifndef SSFR_FOAM_THICKNESS_H
#define SSFR_FOAM_THICKNESS_H

#include "passes/streak.h"
#include "passes/thickness.h"

enum { SSFR_FOAM_PERLIN = 2 }; /* of its tables, behind those of streak.h */
enum { SSFR_FOAM_NOISE_EXACT, SSFR_FOAM_NOISE_TEXTURE, SSFR_FOAM_NOISE_CONSTANT };

/* s; older foam has one pattern, so that ages of any length are places in the noise. */
#define SSFR_FOAM_OLDEST 1e9

typedef struct ssfr_foam_thickness_coeffs {
    ssfr_streak streak;
    ssfr_thickness_sum sum;
    double noise_rate; /* periods of the noise a second */
    double delta_foam; /* m */
    int kept, by_centre, noise, by_id, has_ids;
} ssfr_foam_thickness_coeffs;

void ssfr_foam_thickness_cpu(const ssfr_run *run);

#endif

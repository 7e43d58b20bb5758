/* SPDX-License-Identifier: MIT */
/* thickness.h: length of fluid along the view ray; see thickness.c. */
#ifndef SSFR_THICKNESS_H
#define SSFR_THICKNESS_H

#include "passes/splat.h"

typedef struct ssfr_thickness_coeffs {
    ssfr_splat splat;
    double scale; /* of the sum */
    int exponential, clipped;
} ssfr_thickness_coeffs;

void ssfr_thickness_cpu(const ssfr_run *run);

#endif

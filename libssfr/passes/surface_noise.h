/* SPDX-License-Identifier: MIT */
/* surface_noise.h: fine waves that move with the particles; see surface_noise.c. */
#ifndef SSFR_SURFACE_NOISE_H
#define SSFR_SURFACE_NOISE_H

#include "passes/splat.h"

typedef struct ssfr_surface_noise_coeffs {
    ssfr_splat splat;
    double frequency; /* noise cells a splat radius */
    double sharpness; /* of the Gaussian e^(-sharpness r^2) */
    double falloff;   /* 1/m */
    int has_ids;
} ssfr_surface_noise_coeffs;

void ssfr_surface_noise_cpu(const ssfr_run *run);

#endif

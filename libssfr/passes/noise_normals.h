/* SPDX-License-Identifier: MIT */
/* noise_normals.h: normals disturbed by the surface noise; see noise_normals.c. */
#ifndef SSFR_NOISE_NORMALS_H
#define SSFR_NOISE_NORMALS_H

#include "graph/pass.h"

typedef struct ssfr_noise_normals_coeffs {
    double height; /* m */
    double c[2];   /* eye-space size of a pixel at unit depth */
} ssfr_noise_normals_coeffs;

void ssfr_noise_normals_cpu(const ssfr_run *run);

#endif

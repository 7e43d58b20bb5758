/* SPDX-License-Identifier: MIT */
/* noise_foam.h: greyish foam where the surface noise is strong; see noise_foam.c. */
#ifndef SSFR_NOISE_FOAM_H
#define SSFR_NOISE_FOAM_H

#include "graph/pass.h"

enum { SSFR_FOAM_ADD, SSFR_FOAM_OVER };

typedef struct ssfr_noise_foam_coeffs {
    double strength;            /* [0, 1] */
    double threshold, softness; /* of the noise's magnitude: where foam begins, and over how much more it is full */
    double color[3];            /* reflectance, linear */
    int blend;
} ssfr_noise_foam_coeffs;

void ssfr_noise_foam_cpu(const ssfr_run *run);

#endif

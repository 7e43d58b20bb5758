/* SPDX-License-Identifier: MIT */
/* upsample.h: low-resolution depth back at full resolution; see upsample.c. */
#ifndef SSFR_UPSAMPLE_H
#define SSFR_UPSAMPLE_H

#include "graph/pass.h"

typedef struct ssfr_upsample_coeffs {
    double falloff; /* m */
    int factor; /* pixels of the guide a pixel of the depth, along each axis */
    int filter; /* 0 nearest, 1 linear, 2 cubic */
} ssfr_upsample_coeffs;

void ssfr_upsample_cpu(const ssfr_run *run);

#endif

/* SPDX-License-Identifier: MIT */
/* normals.h: unit normals of a depth image; see normals.c. */
#ifndef SSFR_NORMALS_H
#define SSFR_NORMALS_H

#include "graph/pass.h"

enum { SSFR_NORMALS_SMALLER, SSFR_NORMALS_CENTRAL };

typedef struct ssfr_normals_coeffs {
    double c[2];    /* eye-space size of a pixel at unit depth */
    double falloff; /* m */
    double divisor; /* full-resolution pixels a pixel */
    int edge, off_axis;
} ssfr_normals_coeffs;

void ssfr_normals_cpu(const ssfr_run *run);

#endif

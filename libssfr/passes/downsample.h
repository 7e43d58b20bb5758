/* SPDX-License-Identifier: MIT */
/* downsample.h: depth at a lower resolution; see downsample.c. */
#ifndef SSFR_DOWNSAMPLE_H
#define SSFR_DOWNSAMPLE_H

#include "graph/pass.h"

enum { SSFR_DOWNSAMPLE_NEAREST, SSFR_DOWNSAMPLE_NEAREST_TO_EYE, SSFR_DOWNSAMPLE_MEAN };

typedef struct ssfr_downsample_coeffs {
    int factor, rule;
} ssfr_downsample_coeffs;

void ssfr_downsample_cpu(const ssfr_run *run);

#endif

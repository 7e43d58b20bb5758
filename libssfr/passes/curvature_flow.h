/* SPDX-License-Identifier: MIT */
/* curvature_flow.h: smoothing by mean curvature; see curvature_flow.c. */
#ifndef SSFR_CURVATURE_FLOW_H
#define SSFR_CURVATURE_FLOW_H

#include "graph/pass.h"

typedef struct ssfr_curvature_flow_coeffs {
    double dt;         /* m^2 */
    double c[2];       /* eye-space size of a pixel of the filtered image at unit depth */
    double falloff;    /* m */
    double limit;      /* dt is at most this times |z| (over the off-axis factor) at every pixel; SSFR_EMPTY for none */
    double divisor;    /* full-resolution pixels a pixel */
    int iterations, cross_term, off_axis;
} ssfr_curvature_flow_coeffs;

/* The share of the stability bound that the per-pixel limit allows: at the bound itself checkerboards flip undamped. */
#define SSFR_CURVATURE_FLOW_SAFE 0.9

void ssfr_curvature_flow_cpu(const ssfr_run *run);

#endif

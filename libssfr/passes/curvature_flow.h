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

/* The derivatives of a pixel that are zero, as bits: a step beyond the falloff, or a hole, lies in their way. */
enum { SSFR_CURVATURE_FLOW_CUT_X = 1, SSFR_CURVATURE_FLOW_CUT_Y = 2, SSFR_CURVATURE_FLOW_CUT_XY = 4 };

/* The largest step, m, to a neighbour that one of these derivatives needs; NaN where a neighbour is NaN. */
double ssfr_curvature_flow_jump(const ssfr_field *depth, int x, int y, unsigned cut);
/* All cuts of a pixel. That of z_xy is set only where neither of the others is: with them there is no z_xy. */
unsigned ssfr_curvature_flow_cuts(const ssfr_run *run, const ssfr_field *depth, int x, int y);
/* What an Euler step adds to the depth of a pixel with a surface, m: -H times dt, or times the limit of dt there. */
double ssfr_curvature_flow_rate(const ssfr_run *run, const ssfr_field *depth, int x, int y, unsigned cuts);

void ssfr_curvature_flow_cpu(const ssfr_run *run);

#endif

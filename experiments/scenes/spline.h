/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spline.h: curves through values at times: natural cubic splines, twice continuously differentiable. */
#ifndef SSFR_SPLINE_H
#define SSFR_SPLINE_H

#include "base/base.h"

typedef struct ssfr_curve ssfr_curve;

/* Through n points (at least 2; two give a line) of n_channels values each, at strictly rising times. */
SSFR_MUST ssfr_result ssfr_curve_create(ssfr_curve **out, size_t n_channels, size_t n, const double *times,
                                        const double *values);
void ssfr_curve_destroy(ssfr_curve **curve);

/* The values at a time; before the first and after the last they stand. */
void ssfr_curve_at(const ssfr_curve *curve, double time, double *values);

#endif

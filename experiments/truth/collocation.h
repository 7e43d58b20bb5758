/* SPDX-License-Identifier: GPL-3.0-or-later */
/* collocation.h: a smooth function as the polynomial through Gauss points, to integrate it up to each of them. */
#ifndef SSFR_TRUTH_COLLOCATION_H
#define SSFR_TRUTH_COLLOCATION_H

#include "base/base.h"

enum { SSFR_COLLOCATION_MOST = 16 };

/* On [0, 1]: the integral of f is sum weight[i] f(at[i]), exact for polynomials of degree 2 n - 1; that up to at[i] is
 * sum upto[i][j] f(at[j]), exact for degree n - 1. */
typedef struct ssfr_collocation {
    int n;
    double at[SSFR_COLLOCATION_MOST], weight[SSFR_COLLOCATION_MOST];
    double upto[SSFR_COLLOCATION_MOST][SSFR_COLLOCATION_MOST];
} ssfr_collocation;

/* n: points, [1, SSFR_COLLOCATION_MOST]. */
SSFR_MUST ssfr_result ssfr_collocation_init(ssfr_collocation *out, int n);

#endif

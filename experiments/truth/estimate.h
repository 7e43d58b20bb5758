/* SPDX-License-Identifier: GPL-3.0-or-later */
/* estimate.h: means over an image of which one pixel of each square was cast, and how far off they may be. */
#ifndef SSFR_TRUTH_ESTIMATE_H
#define SSFR_TRUTH_ESTIMATE_H

#include "experiments/truth/truth.h"

enum { SSFR_MAX_ESTIMATES = 8 };

typedef struct ssfr_estimate {
    const char *quantity, *unit;
    double value, low, high; /* the true mean of all pixels lies in between in 95 of 100 samples; NaN: nothing to take
                              * the mean of. With every pixel cast: it lies there for certain */
    size_t n;                /* pixels that count */
} ssfr_estimate;

/* What the channels of this truth allow; how many goes to *n. */
SSFR_MUST ssfr_result ssfr_truth_estimate(const ssfr_truth *truth, ssfr_estimate out[SSFR_MAX_ESTIMATES], int *n);

#endif

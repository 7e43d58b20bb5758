/* SPDX-License-Identifier: MIT */
/* tally.h: one pass over the counted pixels of a pair, from which most metrics follow. */
#ifndef SSFR_TALLY_H
#define SSFR_TALLY_H

#include "metrics/metrics.h"

#include "base/base.h"

/* Of the values v that were added: how many, sum of v, sum of v^2, largest |v|. NaN spreads to the last three. */
typedef struct ssfr_tally {
    size_t n;
    double sum, squares, max;
} ssfr_tally;

/* The larger, or NaN when either is. */
static inline double ssfr_tally_larger(double a, double b)
{
    return isnan(b) || b > a ? b : a;
}

static inline void ssfr_tally_add(ssfr_tally *tally, double v)
{
    tally->n++;
    tally->sum += v;
    tally->squares += v * v;
    tally->max = ssfr_tally_larger(tally->max, fabs(v));
}

static inline bool ssfr_pair_counts(const ssfr_pair *pair, int x, int y)
{
    return !pair->mask || *ssfr_field_at(pair->mask, x, y) != 0;
}

/* SSFR_ERR_VALUE for sizes or channels that do not fit, in the name of a metric. */
SSFR_MUST ssfr_result ssfr_pair_check(const ssfr_pair *pair, const char *name, ssfr_metric_kind kind);

/* Adds what a counted pixel is worth, which may be nothing or several values. */
typedef void ssfr_visit(const ssfr_pair *pair, int x, int y, ssfr_tally *tally);

SSFR_MUST ssfr_result ssfr_tally_pixels(const ssfr_pair *pair, ssfr_visit *visit, ssfr_tally *out);

/* The same, and what was asked of it in *out: NaN when nothing was added. */
SSFR_MUST ssfr_result ssfr_tally_mean(const ssfr_pair *pair, ssfr_visit *visit, double *out);
SSFR_MUST ssfr_result ssfr_tally_mean_square(const ssfr_pair *pair, ssfr_visit *visit, double *out);
SSFR_MUST ssfr_result ssfr_tally_rms(const ssfr_pair *pair, ssfr_visit *visit, double *out);
SSFR_MUST ssfr_result ssfr_tally_max(const ssfr_pair *pair, ssfr_visit *visit, double *out);

/* The mean of a map of one channel where the mask counts; mask may be NULL. */
SSFR_MUST ssfr_result ssfr_tally_map(const ssfr_field *map, const ssfr_field *mask, double *out);

#endif

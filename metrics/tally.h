/* SPDX-License-Identifier: MIT */
/* tally.h: one pass over the counted pixels of a pair, from which most metrics follow. */
#ifndef SSFR_TALLY_H
#define SSFR_TALLY_H

#include "metrics/metrics.h"

#include "base/base.h"

/* Of the values v that were added: how many, sum of v, sum of v^2, largest |v|. NaN spreads to the last three. */
struct ssfr_tally {
    size_t n;
    double sum, squares, max;
};

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

SSFR_MUST ssfr_result ssfr_tally_pixels(const ssfr_pair *pair, ssfr_visit *visit, ssfr_tally *out);

/* The mean that a form is made of: of the values, or of their squares. NaN when nothing was added. */
double ssfr_tally_mean(const ssfr_tally *tally, ssfr_metric_form form);

/* The mean of a map of one channel where the mask counts; mask may be NULL. */
SSFR_MUST ssfr_result ssfr_tally_map(const ssfr_field *map, const ssfr_field *mask, double *out);

#endif

/* SPDX-License-Identifier: MIT */
/* any.c: metrics of numbers, whatever they stand for. */
#include "metrics/run.h"
#include "metrics/tally.h"

static void visit_values(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double *a = ssfr_field_at(pair->a, x, y), *b = ssfr_field_at(pair->b, x, y);
    for (int k = 0; k < pair->a->c; k++) ssfr_tally_add(tally, a[k] - b[k]);
}

static void visit_nonfinite(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double *a = ssfr_field_at(pair->a, x, y);
    for (int k = 0; k < pair->a->c; k++)
        if (!isfinite(a[k])) ssfr_tally_add(tally, 1);
}

ssfr_result ssfr_metric_run_mse(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_mean_square(pair, visit_values, out);
}

ssfr_result ssfr_metric_run_max_abs(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_max(pair, visit_values, out);
}

ssfr_result ssfr_metric_run_nan_count(const ssfr_pair *pair, double *out)
{
    ssfr_tally tally;
    const ssfr_result result = ssfr_tally_pixels(pair, visit_nonfinite, &tally);
    if (result == SSFR_OK) *out = (double)tally.n;
    return result;
}

/* SPDX-License-Identifier: MIT */
/* colour.c: metrics of linear colour, and of the display values that papers measure. */
#include "metrics/run.h"
#include "metrics/tally.h"

#include "image/srgb.h"

static const double relmse_epsilon = 1e-2; /* as metrics.def says */

static void visit_display(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double *a = ssfr_field_at(pair->a, x, y), *b = ssfr_field_at(pair->b, x, y);
    for (int k = 0; k < pair->a->c; k++) ssfr_tally_add(tally, ssfr_srgb_encode(a[k]) - ssfr_srgb_encode(b[k]));
}

static void visit_relative(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double *a = ssfr_field_at(pair->a, x, y), *b = ssfr_field_at(pair->b, x, y);
    for (int k = 0; k < pair->a->c; k++)
        ssfr_tally_add(tally, (a[k] - b[k]) / sqrt(ssfr_square(b[k]) + relmse_epsilon));
}

ssfr_result ssfr_metric_run_psnr(const ssfr_pair *pair, double *out)
{
    const ssfr_result result = ssfr_tally_mean_square(pair, visit_display, out);
    if (result == SSFR_OK) *out = -10 * log10(*out);
    return result;
}

ssfr_result ssfr_metric_run_relmse(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_mean_square(pair, visit_relative, out);
}

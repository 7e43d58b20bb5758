/* SPDX-License-Identifier: MIT */
/* colour.c: metrics of linear colour, and of the display values that papers measure. */
#include "metrics/run.h"

#include "image/srgb.h"

static const double relmse_epsilon = 1e-2; /* as metrics.def says */

void ssfr_visit_display(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double *a = ssfr_field_at(pair->a, x, y), *b = ssfr_field_at(pair->b, x, y);
    for (int k = 0; k < pair->a->c; k++) ssfr_tally_add(tally, ssfr_srgb_encode(a[k]) - ssfr_srgb_encode(b[k]));
}

void ssfr_visit_relative(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double *a = ssfr_field_at(pair->a, x, y), *b = ssfr_field_at(pair->b, x, y);
    for (int k = 0; k < pair->a->c; k++)
        ssfr_tally_add(tally, (a[k] - b[k]) / sqrt(ssfr_square(b[k]) + relmse_epsilon));
}

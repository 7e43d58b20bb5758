/* SPDX-License-Identifier: MIT */
/* any.c: metrics of numbers, whatever they stand for. */
#include "metrics/run.h"

void ssfr_visit_number(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double *a = ssfr_field_at(pair->a, x, y), *b = ssfr_field_at(pair->b, x, y);
    for (int k = 0; k < pair->a->c; k++) ssfr_tally_add(tally, a[k] - b[k]);
}

void ssfr_visit_nonfinite(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double *a = ssfr_field_at(pair->a, x, y);
    for (int k = 0; k < pair->a->c; k++)
        if (!isfinite(a[k])) ssfr_tally_add(tally, 1);
}

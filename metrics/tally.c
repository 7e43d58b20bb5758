/* SPDX-License-Identifier: MIT */
/* tally.c: one pass over the counted pixels of a pair, a row a thread, rows added in order. */
#include "metrics/tally.h"

ssfr_result ssfr_tally_pixels(const ssfr_pair *pair, ssfr_visit *visit, ssfr_tally *out)
{
    ssfr_result result = SSFR_OK;
    ssfr_tally *rows = NULL;
    const int w = pair->a->w, h = pair->a->h;
    *out = (ssfr_tally){0};
    SSFR_TRY(ssfr_alloc(&rows, (size_t)h, sizeof *rows, "sums of rows"));
#pragma omp parallel for schedule(static)
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            if (ssfr_pair_counts(pair, x, y)) visit(pair, x, y, &rows[y]);
    for (int y = 0; y < h; y++) {
        out->n += rows[y].n;
        out->sum += rows[y].sum;
        out->squares += rows[y].squares;
        out->max = ssfr_tally_larger(out->max, rows[y].max);
    }
end:
    free(rows);
    return result;
}

ssfr_result ssfr_tally_mean(const ssfr_pair *pair, ssfr_visit *visit, double *out)
{
    ssfr_tally tally;
    const ssfr_result result = ssfr_tally_pixels(pair, visit, &tally);
    if (result == SSFR_OK) *out = tally.n ? tally.sum / (double)tally.n : (double)NAN;
    return result;
}

ssfr_result ssfr_tally_mean_square(const ssfr_pair *pair, ssfr_visit *visit, double *out)
{
    ssfr_tally tally;
    const ssfr_result result = ssfr_tally_pixels(pair, visit, &tally);
    if (result == SSFR_OK) *out = tally.n ? tally.squares / (double)tally.n : (double)NAN;
    return result;
}

ssfr_result ssfr_tally_rms(const ssfr_pair *pair, ssfr_visit *visit, double *out)
{
    const ssfr_result result = ssfr_tally_mean_square(pair, visit, out);
    if (result == SSFR_OK) *out = sqrt(*out);
    return result;
}

ssfr_result ssfr_tally_max(const ssfr_pair *pair, ssfr_visit *visit, double *out)
{
    ssfr_tally tally;
    const ssfr_result result = ssfr_tally_pixels(pair, visit, &tally);
    if (result == SSFR_OK) *out = tally.n ? tally.max : (double)NAN;
    return result;
}

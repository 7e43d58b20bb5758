/* SPDX-License-Identifier: MIT */
/* tally.c: pairs that fit, and one pass over their counted pixels, a row a thread, rows added in order. */
#include "metrics/tally.h"

static bool channels_fit(ssfr_metric_kind kind, int c)
{
    switch (kind) {
    case SSFR_METRIC_DEPTH: return c == 1;
    case SSFR_METRIC_NORMAL: return c == 3;
    case SSFR_METRIC_COLOUR: return c == 1 || c == 3;
    default: return true;
    }
}

ssfr_result ssfr_pair_check(const ssfr_pair *pair, const char *name, ssfr_metric_kind kind)
{
    const ssfr_field *a = pair->a, *b = pair->b, *mask = pair->mask;
    if (a->w != b->w || a->h != b->h || a->c != b->c)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %d x %d pixels of %d channels against %d x %d of %d", name, a->w, a->h,
                         a->c, b->w, b->h, b->c);
    if (!channels_fit(kind, a->c))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %d channels do not make a %s image", name, a->c,
                         ssfr_metric_kind_name(kind));
    if (mask && (mask->w != a->w || mask->h != a->h || mask->c != 1))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: a mask of %d x %d pixels and %d channels for %d x %d pixels", name,
                         mask->w, mask->h, mask->c, a->w, a->h);
    return SSFR_OK;
}

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

double ssfr_tally_mean(const ssfr_tally *tally, ssfr_metric_form form)
{
    const bool squares = form == SSFR_FORM_MEAN_SQUARE || form == SSFR_FORM_RMS || form == SSFR_FORM_PSNR;
    return tally->n ? (squares ? tally->squares : tally->sum) / (double)tally->n : (double)NAN;
}

static void visit_map(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    ssfr_tally_add(tally, *ssfr_field_at(pair->a, x, y));
}

ssfr_result ssfr_tally_map(const ssfr_field *map, const ssfr_field *mask, double *out)
{
    ssfr_tally tally;
    const ssfr_result result = ssfr_tally_pixels(&(ssfr_pair){.a = map, .b = map, .mask = mask}, visit_map, &tally);
    if (result == SSFR_OK) *out = ssfr_tally_mean(&tally, SSFR_FORM_MEAN);
    return result;
}

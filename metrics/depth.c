/* SPDX-License-Identifier: MIT */
/* depth.c: metrics of eye-space depth and of the silhouette it draws. */
#include "metrics/run.h"

#include "base/field.h"

static bool is_surface(const ssfr_field *depth, int x, int y)
{
    return ssfr_is_surface(*ssfr_field_at(depth, x, y));
}

static bool has_nan(const ssfr_pair *pair, int x, int y)
{
    return isnan(*ssfr_field_at(pair->a, x, y)) || isnan(*ssfr_field_at(pair->b, x, y));
}

static bool is_common(const ssfr_pair *pair, int x, int y)
{
    return is_surface(pair->a, x, y) && is_surface(pair->b, x, y);
}

/* A pixel at the image's border lacks neighbours, and is not interior. */
static bool is_interior(const ssfr_pair *pair, int x, int y)
{
    bool interior = x > 0 && y > 0 && x < pair->a->w - 1 && y < pair->a->h - 1 && is_common(pair, x, y);
    for (int j = -1; j <= 1 && interior; j++)
        for (int i = -1; i <= 1 && interior; i++)
            interior = is_surface(pair->a, x + i, y + j) && (pair->sampled || is_surface(pair->b, x + i, y + j));
    return interior;
}

void ssfr_visit_depth(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    if (has_nan(pair, x, y) || is_common(pair, x, y))
        ssfr_tally_add(tally, *ssfr_field_at(pair->a, x, y) - *ssfr_field_at(pair->b, x, y));
}

void ssfr_visit_depth_interior(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    if (has_nan(pair, x, y) || is_interior(pair, x, y)) ssfr_visit_depth(pair, x, y, tally);
}

void ssfr_visit_depth_edge(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    if (!is_interior(pair, x, y)) ssfr_visit_depth(pair, x, y, tally);
}

/* The middle one of n values, which it sorts; NaN when there is none, or one of them is NaN. */
static double find_median(double *values, size_t n)
{
    bool nan = n == 0;
    for (size_t i = 0; i < n; i++) nan |= isnan(values[i]);
    if (nan) return (double)NAN;
    qsort(values, n, sizeof *values, ssfr_by_value);
    return ssfr_mix(values[(n - 1) / 2], values[n / 2], 0.5);
}

ssfr_result ssfr_metric_run_depth_median_interior(const ssfr_pair *pair, double *out)
{
    ssfr_result result = SSFR_OK;
    double *values = NULL;
    size_t n = 0;
    SSFR_TRY(ssfr_alloc(&values, (size_t)pair->a->w * (size_t)pair->a->h, sizeof *values, "differences in depth"));
    for (int y = 0; y < pair->a->h; y++)
        for (int x = 0; x < pair->a->w; x++)
            if (ssfr_pair_counts(pair, x, y) && (has_nan(pair, x, y) || is_interior(pair, x, y)))
                values[n++] = *ssfr_field_at(pair->a, x, y) - *ssfr_field_at(pair->b, x, y);
    *out = find_median(values, n);
end:
    free(values);
    return result;
}

/* 1 for the intersection, 0 for the rest of the union. */
void ssfr_visit_silhouette(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    if (has_nan(pair, x, y)) ssfr_tally_add(tally, (double)NAN);
    else if (is_surface(pair->a, x, y) || is_surface(pair->b, x, y))
        ssfr_tally_add(tally, is_common(pair, x, y) ? 1 : 0);
}

/* SPDX-License-Identifier: MIT */
/* depth.c: metrics of eye-space depth and of the silhouette it draws. */
#include "metrics/run.h"
#include "metrics/tally.h"

#include "base/field.h"

static bool has_nan(const ssfr_pair *pair, int x, int y)
{
    return isnan(*ssfr_field_at(pair->a, x, y)) || isnan(*ssfr_field_at(pair->b, x, y));
}

static bool is_common(const ssfr_pair *pair, int x, int y)
{
    return ssfr_is_surface(*ssfr_field_at(pair->a, x, y)) && ssfr_is_surface(*ssfr_field_at(pair->b, x, y));
}

/* A pixel at the image's border lacks neighbours, and is not interior. */
static bool is_interior(const ssfr_pair *pair, int x, int y)
{
    bool interior = x > 0 && y > 0 && x < pair->a->w - 1 && y < pair->a->h - 1;
    for (int j = -1; j <= 1 && interior; j++)
        for (int i = -1; i <= 1 && interior; i++) interior = is_common(pair, x + i, y + j);
    return interior;
}

static void visit_difference(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    if (has_nan(pair, x, y) || is_common(pair, x, y))
        ssfr_tally_add(tally, *ssfr_field_at(pair->a, x, y) - *ssfr_field_at(pair->b, x, y));
}

static void visit_interior(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    if (has_nan(pair, x, y) || is_interior(pair, x, y)) visit_difference(pair, x, y, tally);
}

static void visit_edge(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    if (!is_interior(pair, x, y)) visit_difference(pair, x, y, tally);
}

/* 1 for the intersection, 0 for the rest of the union. */
static void visit_union(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double a = *ssfr_field_at(pair->a, x, y), b = *ssfr_field_at(pair->b, x, y);
    if (has_nan(pair, x, y)) ssfr_tally_add(tally, (double)NAN);
    else if (ssfr_is_surface(a) || ssfr_is_surface(b)) ssfr_tally_add(tally, is_common(pair, x, y) ? 1 : 0);
}

ssfr_result ssfr_metric_run_depth_rms(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_rms(pair, visit_difference, out);
}

ssfr_result ssfr_metric_run_depth_max(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_max(pair, visit_difference, out);
}

ssfr_result ssfr_metric_run_depth_mean(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_mean(pair, visit_difference, out);
}

ssfr_result ssfr_metric_run_depth_rms_interior(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_rms(pair, visit_interior, out);
}

ssfr_result ssfr_metric_run_depth_rms_edge(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_rms(pair, visit_edge, out);
}

ssfr_result ssfr_metric_run_silhouette_iou(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_mean(pair, visit_union, out);
}

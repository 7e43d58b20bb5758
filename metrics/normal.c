/* SPDX-License-Identifier: MIT */
/* normal.c: metrics of the angle between normals. */
#include "metrics/run.h"

static const double degrees = 180 / M_PI;

static bool is_zero(const double v[3])
{
    return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

/* atan2 of cross and dot: the arc cosine alone loses half the digits at small angles. a x (b - a) is a x b without
 * the large products that cancel, and so is right for the numbers given however small the angle. */
static double angle(const double a[3], const double b[3])
{
    const double difference[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double cross[3];
    ssfr_cross(a, difference, cross);
    return atan2(sqrt(ssfr_dot(cross, cross)), ssfr_dot(a, b));
}

static bool has_normal(const ssfr_field *normals, int x, int y)
{
    return !is_zero(ssfr_field_at(normals, x, y));
}

static bool has_nan(const ssfr_pair *pair, int x, int y)
{
    const double *a = ssfr_field_at(pair->a, x, y), *b = ssfr_field_at(pair->b, x, y);
    return isnan(a[0] + a[1] + a[2] + b[0] + b[1] + b[2]);
}

/* As of depth: the border lacks neighbours, and of a sampled reference only the pixel itself is known. */
static bool is_interior(const ssfr_pair *pair, int x, int y)
{
    bool interior = x > 0 && y > 0 && x < pair->a->w - 1 && y < pair->a->h - 1 && has_normal(pair->b, x, y);
    for (int j = -1; j <= 1 && interior; j++)
        for (int i = -1; i <= 1 && interior; i++)
            interior = has_normal(pair->a, x + i, y + j) && (pair->sampled || has_normal(pair->b, x + i, y + j));
    return interior;
}

void ssfr_visit_normal(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double *a = ssfr_field_at(pair->a, x, y), *b = ssfr_field_at(pair->b, x, y);
    if (has_nan(pair, x, y)) ssfr_tally_add(tally, (double)NAN);
    else if (!is_zero(a) && !is_zero(b)) ssfr_tally_add(tally, angle(a, b) * degrees);
}

void ssfr_visit_normal_interior(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    if (has_nan(pair, x, y) || is_interior(pair, x, y)) ssfr_visit_normal(pair, x, y, tally);
}

void ssfr_visit_normal_edge(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    if (has_nan(pair, x, y) || !is_interior(pair, x, y)) ssfr_visit_normal(pair, x, y, tally);
}

/* SPDX-License-Identifier: MIT */
/* normal.c: metrics of the angle between normals. */
#include "metrics/run.h"
#include "metrics/tally.h"

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

static void visit_angle(const ssfr_pair *pair, int x, int y, ssfr_tally *tally)
{
    const double *a = ssfr_field_at(pair->a, x, y), *b = ssfr_field_at(pair->b, x, y);
    const bool has_nan = isnan(a[0] + a[1] + a[2] + b[0] + b[1] + b[2]);
    if (has_nan) ssfr_tally_add(tally, (double)NAN);
    else if (!is_zero(a) && !is_zero(b)) ssfr_tally_add(tally, angle(a, b) * degrees);
}

ssfr_result ssfr_metric_run_normal_mean_deg(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_mean(pair, visit_angle, out);
}

ssfr_result ssfr_metric_run_normal_rms_deg(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_rms(pair, visit_angle, out);
}

ssfr_result ssfr_metric_run_normal_max_deg(const ssfr_pair *pair, double *out)
{
    return ssfr_tally_max(pair, visit_angle, out);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* depth.c: stored depths to eye-space z. */
#include "experiments/depth.h"

/* t is the share of the window's depth range that is left to the far plane: 1 at near, 0 at far. */
static double from_share(double t, double near, double far)
{
    return far > 0 ? near * far / (near + t * (far - near)) : near / t;
}

double ssfr_depth_distance(const ssfr_depth_format *format, double stored)
{
    const double near = format->near, far = format->far;
    const double left = format->kind == SSFR_DEPTH_WINDOW ? 1 - stored : stored;
    double distance = NAN;
    switch (format->kind) {
    case SSFR_DEPTH_EYE: distance = -stored; break;
    case SSFR_DEPTH_POSITIVE: distance = stored; break;
    default:
        if (left > 0 && left <= 1) distance = from_share(left, near, far);
        break;
    }
    return distance > 0 && distance < SSFR_SURFACE ? distance : NAN;
}

void ssfr_depth_convert(const ssfr_depth_format *format, ssfr_field *field, ssfr_depth_range *range)
{
    const size_t n = (size_t)field->w * (size_t)field->h * (size_t)field->c;
    for (size_t i = 0; i < n; i++) {
        const double distance = ssfr_depth_distance(format, field->data[i]);
        field->data[i] = isnan(distance) ? -SSFR_EMPTY : -distance;
        if (isnan(distance)) continue;
        range->nearest = range->n ? fmin(range->nearest, distance) : distance;
        range->farthest = fmax(range->farthest, distance);
        range->sum += distance;
        range->n++;
    }
}

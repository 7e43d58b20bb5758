/* SPDX-License-Identifier: GPL-3.0-or-later */
/* depth.h: how programs store depth, and what distance it means. */
#ifndef SSFR_DEPTH_H
#define SSFR_DEPTH_H

#include "base/base.h"

/* In the order of the words of --depth. */
typedef enum ssfr_depth_kind {
    SSFR_DEPTH_EYE,      /* eye-space z, m, negative in front */
    SSFR_DEPTH_POSITIVE, /* distance along the view axis, m */
    SSFR_DEPTH_WINDOW,   /* [0, 1], 0 at the near plane */
    SSFR_DEPTH_REVERSED, /* [0, 1], 1 at the near plane */
} ssfr_depth_kind;

typedef struct ssfr_depth_format {
    ssfr_depth_kind kind;
    double near, far; /* m, of window depth; far 0: infinitely far */
} ssfr_depth_format;

typedef struct ssfr_depth_range { /* of distances along the view axis, m */
    double nearest, farthest;
    double sum; /* over the n surface pixels */
    size_t n;
} ssfr_depth_range;

/* Distance along the view axis, m; NaN where the stored value shows no surface: not in front of the eye, on or beyond
 * the far plane of window depth, beyond SSFR_SURFACE, not finite. */
double ssfr_depth_distance(const ssfr_depth_format *format, double stored);

/* To eye-space z in place, -SSFR_EMPTY where there is no surface; adds the surface's pixels to the range, which
 * starts zeroed. */
void ssfr_depth_convert(const ssfr_depth_format *format, ssfr_field *field, ssfr_depth_range *range);

#endif

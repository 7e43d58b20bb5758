/* SPDX-License-Identifier: MIT */
/* metrics.h: how far a measured image lies from its reference, each way of saying it found by name or by index.
 *
 * Said once, for all metrics:
 *  - a is the measured field, b the reference; both have the same size and the channels of the metric's kind.
 *  - A mask has one channel, and only pixels where it is not 0 are counted; NULL counts all.
 *  - NaN in a counted pixel of a or b makes the metric NaN, and so does a mask or a pair of images without a pixel
 *    to count. These are results, not errors. nan_count alone is a number always. Around the pixels counted ssim
 *    looks 5 pixels far, flip and flip_hdr 10.
 *  - Rows are added from the top whatever the number of threads, so that a metric is the same to the bit. */
#ifndef SSFR_METRICS_H
#define SSFR_METRICS_H

#include "ssfr.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ssfr_metric_kind {
    SSFR_METRIC_ANY,    /* any channels, compared as numbers */
    SSFR_METRIC_DEPTH,  /* 1 channel: eye-space z, m; a surface where fabs(z) < SSFR_SURFACE */
    SSFR_METRIC_NORMAL, /* 3 channels: unit vectors; a zero vector is no surface */
    SSFR_METRIC_COLOUR, /* 1 or 3 channels: linear colour */
} ssfr_metric_kind;

typedef struct ssfr_pair { /* what a metric compares; mask may be NULL */
    const ssfr_field *a, *b, *mask;
} ssfr_pair;

typedef struct ssfr_metric {
    const char *name, *unit, *help; /* unit "1" for none */
    ssfr_metric_kind kind;
    ssfr_result (*run)(const ssfr_pair *pair, double *out); /* for ssfr_metric_measure, which checks the pair first */
} ssfr_metric;

const ssfr_metric *ssfr_metric_find(const char *name); /* NULL when there is none */
const ssfr_metric *ssfr_metric_at(int i);              /* NULL past the end */
const char *ssfr_metric_kind_name(ssfr_metric_kind kind); /* "any", "depth" and so on */

/* Writes *out only when it gives SSFR_OK; SSFR_ERR_VALUE for sizes or channels that do not fit. mask may be NULL. */
SSFR_MUST ssfr_result ssfr_metric_measure(const ssfr_metric *metric, const ssfr_field *a, const ssfr_field *b,
                                          const ssfr_field *mask, double *out);

#ifdef __cplusplus
}
#endif
#endif

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
    bool sampled; /* of b only the pixels counted are known: what their neighbours are, a says alone */
} ssfr_pair;

/* What a metric makes of the values v that its pixels have. */
typedef enum ssfr_metric_form {
    SSFR_FORM_MEAN,        /* of v */
    SSFR_FORM_SHARE,       /* the same, v being 0 or 1 */
    SSFR_FORM_MEAN_SQUARE, /* of v^2, */
    SSFR_FORM_RMS,         /* its root, */
    SSFR_FORM_PSNR,        /* and -10 log10 of it */
    SSFR_FORM_MAX,         /* the largest |v| */
    SSFR_FORM_COUNT,       /* how many */
    SSFR_FORM_WHOLE,       /* none of these: it looks around pixels, and a sample of them says nothing of it */
} ssfr_metric_form;

typedef struct ssfr_tally ssfr_tally;

/* Adds what a counted pixel is worth, which may be nothing or several values. */
typedef void ssfr_visit(const ssfr_pair *pair, int x, int y, ssfr_tally *tally);

typedef struct ssfr_metric {
    const char *name, *unit, *help; /* unit "1" for none */
    ssfr_metric_kind kind;
    ssfr_metric_form form;
    ssfr_visit *visit;                                      /* NULL of the form WHOLE, */
    ssfr_result (*run)(const ssfr_pair *pair, double *out); /* which has this; it does not check the pair */
} ssfr_metric;

const ssfr_metric *ssfr_metric_find(const char *name); /* NULL when there is none */
const ssfr_metric *ssfr_metric_at(int i);              /* NULL past the end */
const char *ssfr_metric_kind_name(ssfr_metric_kind kind); /* "any", "depth" and so on */

/* Writes *out only when it gives SSFR_OK; SSFR_ERR_VALUE for sizes or channels that do not fit. mask may be NULL. */
SSFR_MUST ssfr_result ssfr_metric_measure(const ssfr_metric *metric, const ssfr_field *a, const ssfr_field *b,
                                          const ssfr_field *mask, double *out);
/* The same of a pair, which may be sampled. */
SSFR_MUST ssfr_result ssfr_metric_measure_pair(const ssfr_metric *metric, const ssfr_pair *pair, double *out);

/* ---- samples: where only some pixels of the reference are known ------------------------------------------------- */

/* Forms that are made of a mean, which a sample estimates: all but the last three. */
bool ssfr_metric_is_mean(const ssfr_metric *metric);
/* What one pixel adds to that mean: the sum of its values or of their squares, and how many they are; 0 where it does
 * not count. The pair was measured before: it fits. */
void ssfr_metric_at_pixel(const ssfr_metric *metric, const ssfr_pair *pair, int x, int y, double *sum, double *n);
/* The metric of that mean, which rises or falls with it: the root of a mean square and so on. */
double ssfr_metric_of_mean(const ssfr_metric *metric, double mean);
/* Whether metrics of this kind count the pixel, the mask apart: a surface or a normal in both. */
bool ssfr_metric_counts(ssfr_metric_kind kind, const ssfr_pair *pair, int x, int y);

#ifdef __cplusplus
}
#endif
#endif

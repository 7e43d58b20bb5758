/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sampled.h: metrics against a reference of which one pixel of each square is known, with 95 % intervals.
 *
 * Square h has the share W_h of the image's pixels; one, drawn with equal chances, has the values (s_h, n_h):
 * what it adds to a sum and to the number of what is summed. The mean over the whole image is estimated by the ratio
 * R = sum W_h s_h / sum W_h n_h. Its variance is that of the residuals W_h (s_h - R n_h) over sum W_h n_h; as one pixel
 * tells nothing of how its square varies, neighbours are taken together in pairs, along rows that are followed to and
 * fro (collapsed strata: Cochran 1977, Sampling Techniques, sec. 5A.12 and ch. 6): too wide where neighbours differ,
 * never too narrow in the mean. The interval is Student's, with degrees of freedom by Satterthwaite from the pairs. */
#ifndef SSFR_SAMPLED_H
#define SSFR_SAMPLED_H

#include "metrics/metrics.h"

typedef struct ssfr_sampled {
    double value, low, high; /* infinite ends where less than ten pixels count, of a sample: too few to tell */
} ssfr_sampled;

/* N of a channel that is not 0 at one pixel of each square of N x N pixels, cut at the right and the bottom; 1: of all
 * pixels. path: for the error line, where it is no such sample. */
SSFR_MUST ssfr_result ssfr_sampled_find(const ssfr_field *cast, const char *path, int *every);

/* What a pixel adds to a sum and to the number of what is summed. */
typedef void ssfr_sampled_fn(const void *user, int x, int y, double *sum, double *n);

typedef struct ssfr_sampled_range {
    double least, most; /* that a pixel's value can be; equal: not known, or so wide that it says nothing */
} ssfr_sampled_range;

/* The mean of all pixels; with every pixel known the interval is the value. With a range the interval takes in what is
 * too rare to be seen, whatever it is worth: a share p of what counts escapes every square with a chance of
 * exp(-p / W), W the largest of their shares. */
SSFR_MUST ssfr_result ssfr_sampled_mean(const ssfr_field *cast, int every, ssfr_sampled_fn *value, const void *user,
                                        ssfr_sampled_range range, ssfr_sampled *out);
/* A metric that is made of a mean (ssfr_metric_is_mean). The pair's mask counts as well. Shares and
 * metrics of depth take in what is too rare to be seen. */
SSFR_MUST ssfr_result ssfr_sampled_metric(const ssfr_metric *metric, const ssfr_pair *pair, const ssfr_field *cast,
                                          int every, ssfr_sampled *out);

#endif

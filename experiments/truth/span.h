/* SPDX-License-Identifier: GPL-3.0-or-later */
/* span.h: a piece of a line with the kernels that reach into it, and bounds of the field there that rounding cannot
 * break.
 *
 * The field is positive inside the fluid and negative outside, and 0 on the surface:
 *
 *      density, anisotropic    f = sum weight w(q) - level
 *      zhu_bridson             f = r^2 K^2 - |S|^2,  K = sum k, S = sum k (x - x_i), k = (1 - q^2)^3:
 *                              |x - xm| <= r without the division; outside where K = 0
 *
 * Along a ray a kernel rises to its middle and falls from there, so between two places its least value is at the
 * farther end, its greatest at the middle or the nearer end. Its slope is -weight stretch (t - middle) m(q), and m
 * falls with q: a product of two intervals. Sums of such bounds bound the field and its slope, and the slope's bound
 * bounds the field once more, around its value in the middle.
 *
 * A kernel of a density that rounding keeps out of the line stands at its rim: it has the cube of digits / support of
 * its weight, 1e-16 for an eye that is 1e9 supports away. That is left out. */
#ifndef SSFR_TRUTH_SPAN_H
#define SSFR_TRUTH_SPAN_H

#include "experiments/truth/line.h"

typedef struct ssfr_span_bounds {
    double lo, hi;             /* of the field as it is: what rounding may have done is in them */
    double slope_lo, slope_hi; /* 1/m, likewise */
    double err;                /* the share of rounding in lo and hi */
} ssfr_span_bounds;

typedef struct ssfr_span {
    const ssfr_line *line;
    size_t n, capacity;
    struct ssfr_span_kernel *kernels; /* that reach into the span */
    size_t next;                      /* of the line's: the first that has not been seen yet */
    double across[2][3];              /* unit, with the ray's direction an orthonormal frame; zhu_bridson */
    double slope_slack;               /* of density: what rounding does to the slope */
    double value_slack;               /* and to the value, beyond what the slope tells */
    double known[2];                  /* of zhu_bridson: the bounds that were found last, and from where to where */
    ssfr_span_bounds bounds;
    size_t evaluations;               /* of what follows, since init */
} ssfr_span;

void ssfr_span_init(ssfr_span *span);
void ssfr_span_finish(ssfr_span *span);

/* Before a line's first span. */
void ssfr_span_begin(ssfr_span *span, const ssfr_line *line);
/* To the span from a to b (m), which must begin nowhere before the last one did. */
SSFR_MUST ssfr_result ssfr_span_move(ssfr_span *span, double a, double b);
/* Where the next kernel begins of those that do not reach into the span, m; infinite when there is none. */
double ssfr_span_next(const ssfr_span *span);

/* 1: from a to b all is inside; -1: all outside; 0: not known. The cheaper bounds. */
int ssfr_span_side(ssfr_span *span, double a, double b);
ssfr_span_bounds ssfr_span_bound(ssfr_span *span, double a, double b);

typedef struct ssfr_span_value {
    double value, slope;
    double err; /* bound on the value's */
} ssfr_span_value;

ssfr_span_value ssfr_span_at(ssfr_span *span, double t);
/* 1: certainly inside; -1: certainly outside; 0: rounding hides it. */
int ssfr_span_side_at(ssfr_span *span, double t);

/* The unit normal out of the fluid at a crossing, and a bound on its error in rad: t is known up to t_err (m). */
void ssfr_span_normal(ssfr_span *span, double t, double t_err, double normal[3], double *err);

#endif

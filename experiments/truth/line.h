/* SPDX-License-Identifier: GPL-3.0-or-later */
/* line.h: the fluid along one ray. What the ray meets is gathered once; from then on everything is a function of one
 * variable, t (m), and costs as much as the ray crosses, however large the fluid is.
 *
 * Along the ray a kernel is weight w(q(t)), q^2 = near2 + stretch (t - middle)^2. */
#ifndef SSFR_TRUTH_LINE_H
#define SSFR_TRUTH_LINE_H

#include "experiments/truth/continuum.h"

typedef struct ssfr_line_kernel {
    double enters, leaves; /* m, the ray in its support */
    double middle;         /* m, where the ray is nearest to its middle, as the kernel measures distances */
    double near2;          /* squared distance there, in supports */
    double stretch;        /* 1/m^2 */
    double steep;          /* 1/m: q changes by no more than this with a place, in any direction */
    double weight;
    double aside[3];       /* m, from the kernel's centre to the ray's place at t = middle: what zhu_bridson's mean of
                            * places needs */
    uint32_t index;        /* into the fluid's arrays */
} ssfr_line_kernel;

typedef struct ssfr_line {
    const ssfr_continuum *fluid;
    ssfr_ray ray;
    double from, to;           /* m */
    size_t n, capacity;
    ssfr_line_kernel *kernels; /* in the order of `enters`, then of index */
    double longest;            /* m, of all of them, from enters to leaves */
    double digits;             /* m, what rounding may have moved a kernel, at most */
    double margin;             /* m, what enters and leaves may be off by because of that */
    double hidden;             /* m, where a support's rim is surface, as of spheres: parts of the line in supports that
                                * rounding may have hidden */
    double hidden_at;          /* m, where the first of them begins; infinite when there is none */
    double *breaks;            /* see ssfr_line_breaks */
    size_t breaks_capacity;
    ssfr_line_kernel *spare;   /* scratch, as the following */
    struct ssfr_line_key *keys;
    uint32_t *begins;
} ssfr_line;

/* One thread's; used again and again it soon allocates no more. */
void ssfr_line_init(ssfr_line *line, const ssfr_continuum *fluid);
void ssfr_line_finish(ssfr_line *line);

/* Gathers all that meets the ray between from and to (m, 0 <= from < to, infinite to is well). */
SSFR_MUST ssfr_result ssfr_line_cast(ssfr_line *line, const ssfr_ray *ray, double from, double to);

/* sum weight w at t: rho / rho_0, the number of balls, or an extinction in 1/m. Which kernels may reach t is found by
 * bisection: they enter before t by no more than the longest of all is long. Cheap, but who asks for many rising t
 * should keep a window of its own. */
double ssfr_line_density(const ssfr_line *line, double t);
/* A bound on what the kernel's enters and leaves are off by, m; whether rounding hides if the ray meets it at all. */
double ssfr_line_rim_err(const ssfr_line *line, const ssfr_line_kernel *k, bool *grazes);

/* The closed form of its integral from a to b, within [from, to], and a bound on what rounding does to it, which may
 * be NULL. */
double ssfr_line_chords(const ssfr_line *line, double a, double b, double *err);

/* Where kernels, and the pieces that they are made of, begin or end inside (a, b), and the middles of those that the
 * ray nearly goes through, with a and b themselves: rising, each once. Between two of them the density is smooth. The
 * line's until the next call. */
SSFR_MUST ssfr_result ssfr_line_breaks(ssfr_line *line, double a, double b, size_t *n, const double **breaks);

#endif

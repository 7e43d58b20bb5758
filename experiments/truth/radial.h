/* SPDX-License-Identifier: GPL-3.0-or-later */
/* radial.h: smoothing kernels as functions of the distance alone, and what a straight line collects in one.
 *
 * A kernel is W(r) = w(q) / h^3, q = r / h, h the support; its integral over space is 1. All are sums of layers, each a
 * polynomial in q that vanishes at its cut-off and beyond: so every chord integral has a closed form. */
#ifndef SSFR_TRUTH_RADIAL_H
#define SSFR_TRUTH_RADIAL_H

#include "base/base.h"

enum { SSFR_RADIAL_LAYERS = 2, SSFR_RADIAL_DEGREE = 7 };

typedef struct ssfr_radial {
    const char *name, *source;
    int n_layers;
    struct ssfr_radial_layer {
        double cutoff;                        /* (0, 1] */
        int degree;
        double coef[SSFR_RADIAL_DEGREE + 1];  /* of q^k */
    } layers[SSFR_RADIAL_LAYERS];
} ssfr_radial;

/* The kernels and their names in the same order, NULL-terminated: cubic_spline, poly6, wendland. */
extern const ssfr_radial ssfr_radials[];
extern const char *const ssfr_radial_names[];

/* w(q), q >= 0; falls from q = 0 on and is 0 from 1 on. */
double ssfr_radial_value(const ssfr_radial *radial, double q);
/* -w'(q) / q, which is finite at 0, never negative, and falls, too: along a line q q' is known, so the slope along it
 * is -(this) q q'. */
double ssfr_radial_steepness(const ssfr_radial *radial, double q);
/* The integral of w along a line that passes the middle at the distance b >= 0, from there to s; odd in s. Distances in
 * units of the support. Absolute error at most 4e-16 times the value at s = 1, b = 0 or so. */
double ssfr_radial_chord(const ssfr_radial *radial, double b, double s);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* radial.h: smoothing kernels as functions of the distance alone, and what a straight line collects in one.
 *
 * A kernel is W(r) = w(q) / h^3, q = r / h, h the support; its integral over space is 1. All are polynomials in q, in
 * one piece or two, and 0 from q = 1 on: so every chord integral has a closed form. Not for NaN. */
#ifndef SSFR_TRUTH_RADIAL_H
#define SSFR_TRUTH_RADIAL_H

#include "base/base.h"

typedef struct ssfr_radial {
    const char *name, *source;
    double (*value)(double q);
    double (*steepness)(double q);
    double (*both)(double q, double *steepness);
    double (*chord)(double b, double s);
    double chord_err; /* bound on the absolute error of a chord that rounding leaves */
    double seam;      /* q, (0, 1]: w is of two smooth pieces that meet there; 1: of one */
    bool even;        /* of even powers of q alone: smooth through its middle */
} ssfr_radial;

enum { SSFR_N_RADIALS = 3 };

/* The kernels and their names in the same order, NULL-terminated: cubic_spline, poly6, wendland. */
extern const ssfr_radial ssfr_radials[SSFR_N_RADIALS];
extern const char *const ssfr_radial_names[SSFR_N_RADIALS + 1];

/* w(q), q >= 0; falls from q = 0 on and is 0 from 1 on. Relative error a few 1e-16, also where it is next to 0. */
static inline double ssfr_radial_value(const ssfr_radial *radial, double q)
{
    return radial->value(q);
}

/* -w'(q) / q, which is finite at 0, never negative, and falls, too: along a line q q' is known, so the slope along it
 * is -(this) q q'. */
static inline double ssfr_radial_steepness(const ssfr_radial *radial, double q)
{
    return radial->steepness(q);
}

/* Gives the value and the steepness, for less than both cost alone; bit for bit the same. */
static inline double ssfr_radial_both(const ssfr_radial *radial, double q, double *steepness)
{
    return radial->both(q, steepness);
}

/* The integral of w along a line that passes the middle at the distance b >= 0, from there to s, which may be beyond
 * the kernel and infinite; odd in s. Distances in units of the support. The whole chord is twice that to s = 1. */
static inline double ssfr_radial_chord(const ssfr_radial *radial, double b, double s)
{
    return radial->chord(b, s);
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* kernel.h: the cubic spline, times a particle's volume, and its integral over the other side of a wall.
 *
 * With q = r/h and h the support,
 *      W(r) = 8 / (pi h^3) (2 (1 - q)+^3 - 8 (1/2 - q)+^3),    (a)+ = max(a, 0),
 * which is the usual piecewise form (Monaghan 1992) in one piece. Sums of V W, V = m / rho0, are densities in units of
 * the rest density. */
#ifndef SSFR_KERNEL_H
#define SSFR_KERNEL_H

#include "experiments/scenes/lanes.h"

typedef struct ssfr_kernel {
    float support;     /* m, h */
    float per_support; /* 1/m */
    float value;       /* 1, 8 V / (pi h^3): a particle's share in its own density */
    float slope;       /* 1/m, value / h */
} ssfr_kernel;

static inline ssfr_kernel ssfr_kernel_make(double support, double volume)
{
    const double value = 8 * volume / (acos(-1) * support * support * support);
    return (ssfr_kernel){(float)support, (float)(1 / support), (float)value, (float)(value / support)};
}

/* V W. */
static inline ssfr_lanes ssfr_kernel_value(const ssfr_kernel *kernel, ssfr_lanes r)
{
    const ssfr_lanes q = r * kernel->per_support;
    const ssfr_lanes u = ssfr_lanes_positive(1 - q), v = ssfr_lanes_positive(0.5f - q);
    return kernel->value * (2 * u * u * u - 8 * v * v * v);
}

/* V W'(r), 1/m: the gradient of V W at x_i is this along (x_i - x_j) / r. Inside of q = 1/3, where W' is steepest, it
 * stays what it is there: with the spline's own, particles that have come close would not part again (Thomas and
 * Couchman 1992). Particles at rest are at q = 0.46. */
static inline ssfr_lanes ssfr_kernel_slope(const ssfr_kernel *kernel, ssfr_lanes r)
{
    const ssfr_lanes q = 1.0f / 3 + ssfr_lanes_positive(r * kernel->per_support - 1.0f / 3);
    const ssfr_lanes u = ssfr_lanes_positive(1 - q), v = ssfr_lanes_positive(0.5f - q);
    return kernel->slope * (24 * v * v - 6 * u * u);
}

/* The integral of W over a half-space at distance q h, (0, 1): what a wall's inside, full of fluid at rest, adds to the
 * density, in units of the rest density. The derivative with respect to q goes to *slope.
 *      A(q) = int_q^1 W 2 pi q' dq' = 16 (u^4 / 2 - 2 u^5 / 5 - v^4 + 8 v^5 / 5),   u = (1 - q)+, v = (1/2 - q)+
 *      I(q) = int_q^1 A dq'         = 16 (u^5 / 10 - u^6 / 15 - v^5 / 5 + 4 v^6 / 15),   I(-q) = 1 - I(q) */
static inline float ssfr_kernel_behind(float q, float *slope)
{
    const float u = fmaxf(1 - fabsf(q), 0), v = fmaxf(0.5f - fabsf(q), 0);
    const float u4 = u * u * u * u, v4 = v * v * v * v;
    const float integral = 16 * (u4 * u * (0.1f - u / 15) - v4 * v * (0.2f - v * (4.0f / 15)));
    *slope = -16 * (u4 * (0.5f - 0.4f * u) - v4 * (1 - 1.6f * v));
    return q < 0 ? 1 - integral : integral;
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* radiance.h: what a ray collects on its way through spray, foam and bubbles, a medium that absorbs and shines.
 *
 * With sigma = sum sigma_j the extinction and c(x) = sum sigma_j c_j / sigma the colour there,
 *      dL/dt = sigma (c - L)   towards the eye:   L = int_0^T sigma c e^(-tau(t)) dt + e^(-tau(T)) L_behind,
 * tau(t) the optical depth up to t, a sum of closed-form chords. Where all colours are one the integral has a closed
 * form, too: c (1 - e^(-tau)). Ihmsen et al. 2012 step along the ray instead (integrator `steps`). */
#ifndef SSFR_TRUTH_RADIANCE_H
#define SSFR_TRUTH_RADIANCE_H

#include "experiments/truth/course.h"

typedef struct ssfr_radiance {
    double colour[3];      /* collected, before what is behind */
    double transmittance;  /* share of what is behind that comes through, [0, 1] */
    double err;            /* of any channel and of the transmittance, absolute: see below */
    bool closed;           /* by the closed form alone */
    size_t evaluations;
} ssfr_radiance;

/* What the ray collects between a and b (m) of a line that was cast through extinction->kernels. `chords` takes the
 * closed form where what the ray crosses is of one colour; where colours mix, piece by piece, a polynomial that agrees
 * with the closed-form depth, or qags where none does. `steps` takes the optical depth by steps, too, as renderers do.
 * err is what rounding does, and the rule's own estimate where there is no closed form; of `steps` the difference to
 * half as many and to the closed-form transmittance. What the least and the largest colour and the closed-form depth
 * leave open bounds it from above, and from below where a value is outside of that. */
SSFR_MUST ssfr_result ssfr_radiance_collect(const ssfr_extinction *extinction, ssfr_line *line, ssfr_integration *work,
                                            ssfr_integrator_id id, const ssfr_integrate_params *params, double a,
                                            double b, ssfr_radiance *out);

#endif

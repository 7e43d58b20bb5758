/* SPDX-License-Identifier: GPL-3.0-or-later */
/* extinction.h: spray, foam and bubbles as a medium: how much light each particle takes, and what it shines with.
 *
 * Particle j adds sigma_j(x) = Q pi a^2 W(|x - x_j|), 1/m, to the extinction: the cross-section of a ball of radius a,
 * spread by a kernel. */
#ifndef SSFR_TRUTH_EXTINCTION_H
#define SSFR_TRUTH_EXTINCTION_H

#include "experiments/truth/continuum.h"

typedef struct ssfr_extinction_params {
    double radius;     /* a, in radii of the fluid's particles */
    double support;    /* of its kernel, in radii of the fluid's particles */
    double efficiency; /* Q */
    double spray, foam, bubble; /* what each kind shines with, grey, of the light's brightness 1 */
} ssfr_extinction_params;

extern const ssfr_param ssfr_extinction_rows[];

typedef struct ssfr_extinction {
    ssfr_continuum kernels;    /* its density is the extinction, 1/m */
    double (*colour)[3];   /* of each particle; NULL: all are `same` */
    double same[3];
} ssfr_extinction;

/* Diffuse particles (NULL, or none: no extinction anywhere), foam where kinds are missing; radius: that of the fluid's,
 * m; origin: of the fluid, m. */
SSFR_MUST ssfr_result ssfr_extinction_init(ssfr_extinction *out, const ssfr_particles *particles, double radius,
                                     const double origin[3], const ssfr_extinction_params *params);
void ssfr_extinction_finish(ssfr_extinction *extinction);

#endif

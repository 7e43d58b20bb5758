/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foam.h: spray, foam and bubbles beside a simulated fluid (Ihmsen, Akinci, Akinci and Teschner 2012).
 *
 * The same input gives the same bits for any number of threads: random numbers come from seed, particle and step. */
#ifndef SSFR_FOAM_H
#define SSFR_FOAM_H

#include "experiments/scenes/fluid.h"

typedef struct ssfr_foam_params {
    double trapped_air_rate;   /* k_ta, particles a second and fluid particle of full potential */
    double wave_crest_rate;    /* k_wc */
    double trapped_air_min, trapped_air_max; /* tau_ta, m/s: sums of scaled velocity differences */
    double wave_crest_min, wave_crest_max;   /* tau_wc, 1: sums of curvatures */
    double energy_min, energy_max;           /* tau_k, J for a particle of the radius 0.02 m; scaled by the mass */
    double lifetime_min, lifetime_max;       /* s, of foam */
    int spray_below;           /* fluid neighbours: fewer are spray */
    int bubbles_above;         /* more are bubbles; between is foam */
    double buoyancy;           /* k_b, of bubbles, in gravities */
    double drag;               /* k_d, of bubbles, [0, 1] */
    int max_particles;         /* 0: no limit */
} ssfr_foam_params;

extern const ssfr_param ssfr_foam_rows[];

typedef struct ssfr_foam ssfr_foam;

SSFR_MUST ssfr_result ssfr_foam_create(ssfr_foam **out, const ssfr_foam_params *params, const double gravity[3],
                                       uint64_t seed);
void ssfr_foam_destroy(ssfr_foam **foam);

/* Emits, classifies, moves and ages by dt (s), with the fluid as it is at the step's end. */
SSFR_MUST ssfr_result ssfr_foam_step(ssfr_foam *foam, const ssfr_fluid *fluid, double dt, int n_obstacles,
                                     const ssfr_obstacle *obstacles);

/* Removes what is inside the solid, or outside of the box. */
void ssfr_foam_remove(ssfr_foam *foam, const ssfr_solid *sink);
void ssfr_foam_keep(ssfr_foam *foam, const double lo[3], const double hi[3]);

size_t ssfr_foam_count(const ssfr_foam *foam);
/* Packs position, velocity, kind (ssfr_kind), lifetime (remaining), initial_lifetime and id. radius: m, what they are
 * to be drawn with. */
SSFR_MUST ssfr_result ssfr_foam_export(const ssfr_foam *foam, double radius, ssfr_particles **out);

SSFR_MUST ssfr_result ssfr_foam_write(const ssfr_foam *foam, FILE *file);
SSFR_MUST ssfr_result ssfr_foam_read(ssfr_foam *foam, FILE *file);

#endif

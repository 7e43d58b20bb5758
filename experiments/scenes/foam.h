/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foam.h: spray, foam and bubbles beside a simulated fluid (Ihmsen, Akinci, Akinci and Teschner 2012).
 *
 * The same input gives the same bits for any number of threads: random numbers come from seed, particle and step.
 * A particle takes 49 bytes; beside that there are 44 for each particle of the fluid. */
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
    double bubble_step;        /* s, the step that k_b and k_d are meant for; 0: every step */
    int max_particles;         /* 0: no limit */
} ssfr_foam_params;

extern const ssfr_param ssfr_foam_rows[];

/* For the same water in particles `scale` times as large: velocities within the support differ by about as much more,
 * and without this so many more particles would emit. max_particles stays. */
void ssfr_foam_params_coarsen(ssfr_foam_params *params, double scale);

typedef struct ssfr_foam ssfr_foam;

SSFR_MUST ssfr_result ssfr_foam_create(ssfr_foam **out, const ssfr_foam_params *params, const double gravity[3],
                                       uint64_t seed);
void ssfr_foam_destroy(ssfr_foam **foam);

/* Adds n particles, ids in their order: m, world; m/s; s. They are spray until a step finds what they are. Nothing is
 * added when one is not finite, or when they exceed max_particles. */
SSFR_MUST ssfr_result ssfr_foam_add(ssfr_foam *foam, size_t n, const double *positions, const float *velocities,
                                    const float *lifetimes);

/* The domain: closed sides (-x +x -y +y -z +z) are walls; what leaves by an open one is removed. Without a call there
 * is no end. */
void ssfr_foam_bound(ssfr_foam *foam, const double lo[3], const double hi[3], const bool open[6]);

/* Classifies, moves and ages by dt (s), then emits, with the fluid as it is at the step's end. At the limit
 * max_particles nobody gives way: of the new, those that find no room are left out, evenly over the fluid. Walls and
 * solids keep all out. Fails with SSFR_ERR_VALUE for a malformed dt, and where counts or ids would no longer fit. */
SSFR_MUST ssfr_result ssfr_foam_step(ssfr_foam *foam, const ssfr_fluid *fluid, double dt, int n_obstacles,
                                     const ssfr_obstacle *obstacles);

/* What a fluid particle's potentials are made of: to choose the limits by. */
typedef struct ssfr_foam_cause {
    float trapped_air; /* m/s, eq. 2 */
    float wave_crest;  /* 1, eq. 4 of convex places that move outwards, else 0 */
    float energy;      /* J, of this particle's mass */
} ssfr_foam_cause;

/* Of all n particles of the fluid. */
SSFR_MUST ssfr_result ssfr_foam_causes(ssfr_foam *foam, const ssfr_fluid *fluid, int n_obstacles,
                                       const ssfr_obstacle *obstacles, ssfr_foam_cause *out);

/* Removes what is inside the solid. */
void ssfr_foam_remove(ssfr_foam *foam, const ssfr_solid *sink);

size_t ssfr_foam_count(const ssfr_foam *foam);
/* Packs position, velocity, kind (ssfr_kind), lifetime (remaining), initial_lifetime and id. radius: m, what they are
 * to be drawn with. */
SSFR_MUST ssfr_result ssfr_foam_export(const ssfr_foam *foam, double radius, ssfr_particles **out);

/* The state of foam made from the same parameters and seed: it goes on as if it had never stopped. After a reading that
 * failed there are no particles. */
SSFR_MUST ssfr_result ssfr_foam_write(const ssfr_foam *foam, FILE *file);
SSFR_MUST ssfr_result ssfr_foam_read(ssfr_foam *foam, FILE *file);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* solver.h: the embedded simulator: position based fluids (Macklin and Mueller 2013).
 *
 * The same input gives the same bits for any number of threads. A solver in the middle of a simulation can be written
 * to a file and read back, and goes on as if it had never stopped. */
#ifndef SSFR_SOLVER_H
#define SSFR_SOLVER_H

#include "experiments/scenes/fluid.h"

/* Grows whenever the same scene would give other bits: frames made before are then made anew. */
enum { SSFR_SOLVER_VERSION = 4 };

typedef struct ssfr_solver_params {
    double max_step;      /* s, the longest step */
    double cfl;           /* radii that the fastest particle may move in a step */
    int iterations;       /* of the density constraint, a step */
    double relaxation;    /* epsilon of eq. 11, in units of the constraint's gradients at rest */
    double pressure_k;    /* k of the artificial pressure, eq. 13 */
    double pressure_dq;   /* |delta q| of eq. 13, in supports */
    int pressure_n;       /* n of eq. 13 */
    double viscosity;     /* c of XSPH, eq. 17 */
    double vorticity;     /* epsilon of vorticity confinement, eq. 16 */
} ssfr_solver_params;

extern const ssfr_param ssfr_solver_rows[];

typedef struct ssfr_solver_setup {
    ssfr_solver_params params;
    double radius;         /* m */
    double gravity[3];     /* m/s^2 */
    double lo[3], hi[3];   /* m, world: the domain */
    bool open[6];          /* -x +x -y +y -z +z: no wall on that side; what leaves by it is removed */
    size_t max_particles;  /* those beyond are not added */
} ssfr_solver_setup;

typedef struct ssfr_solver ssfr_solver;

SSFR_MUST ssfr_result ssfr_solver_create(ssfr_solver **out, const ssfr_solver_setup *setup);
void ssfr_solver_destroy(ssfr_solver **solver);

/* Adds n particles of age 0 with ids in the order of birth; positions are world, m. Those beyond max_particles are
 * left out. velocities NULL: at rest. */
SSFR_MUST ssfr_result ssfr_solver_add(ssfr_solver *solver, size_t n, const double *positions, const float *velocities);
/* Removes what is inside the solid (a sink); returns how many there were. */
size_t ssfr_solver_remove(ssfr_solver *solver, const ssfr_solid *sink);

/* How long the next step may be, s: the CFL condition, for particles and for waves on fluid of this depth, and
 * max_step. */
double ssfr_solver_limit(const ssfr_solver *solver);
/* Advances by dt (s). Fails with SSFR_ERR_VALUE, naming the particle, when a value is no longer finite; the solver is
 * then of no further use. Friction is taken as the share in a step of max_step. */
SSFR_MUST ssfr_result ssfr_solver_step(ssfr_solver *solver, double dt, int n_obstacles,
                                       const ssfr_obstacle *obstacles);

/* The fluid as it is after a step, densities and grid included. */
ssfr_fluid ssfr_solver_fluid(const ssfr_solver *solver);
/* The id of the i-th particle of it. */
uint32_t ssfr_solver_id(const ssfr_solver *solver, size_t i);
/* Packs position, velocity, density, neighbours within the support, id and age. */
SSFR_MUST ssfr_result ssfr_solver_export(const ssfr_solver *solver, ssfr_particles **out);

/* The state of a solver made from the same setup. */
SSFR_MUST ssfr_result ssfr_solver_write(const ssfr_solver *solver, FILE *file);
SSFR_MUST ssfr_result ssfr_solver_read(ssfr_solver *solver, FILE *file);

size_t ssfr_solver_bytes(const ssfr_solver *solver); /* memory held */

/* What a step does, in its order; each is a loop over all particles, the two of the iterations are several. */
typedef enum ssfr_solver_stage {
    SSFR_SOLVER_PREDICT,     /* where particles would go, the walls and obstacles that they would meet there */
    SSFR_SOLVER_MULTIPLIERS, /* of the density constraint: the first half of its iterations */
    SSFR_SOLVER_CORRECT,     /* the second half */
    SSFR_SOLVER_ARRIVE,      /* contacts, new positions and velocities */
    SSFR_SOLVER_SORT,        /* by the grid's cells */
    SSFR_SOLVER_LIST,        /* neighbours */
    SSFR_SOLVER_DENSITY,
    SSFR_SOLVER_SMOOTH,      /* velocities: viscosity and vorticity */
    SSFR_N_SOLVER_STAGES
} ssfr_solver_stage;

extern const char *const ssfr_solver_stage_words[]; /* in their order, then NULL */
/* What the last step spent in each, s. */
const double *ssfr_solver_seconds(const ssfr_solver *solver);

#endif

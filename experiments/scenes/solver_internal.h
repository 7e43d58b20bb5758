/* SPDX-License-Identifier: GPL-3.0-or-later */
/* solver_internal.h: the solver's state, shared by its files.
 *
 *      solver.c            creating, the step from begin to end
 *      solver_passes.c     sums over neighbours: constraints, corrections, viscosity, vorticity
 *      solver_boundary.c   walls and obstacles
 *      solver_state.c      adding, removing, packing, writing and reading
 *
 * Particles stand in the grid's order at all times between steps: neighbours in space are neighbours in memory. All
 * sums are gathered by the particle that they belong to, in the order of its list. */
#ifndef SSFR_SOLVER_INTERNAL_H
#define SSFR_SOLVER_INTERNAL_H

#include "experiments/scenes/kernel.h"
#include "experiments/scenes/solver.h"

enum {
    SSFR_MAX_LISTED = 256,  /* neighbours of a particle that its sums see; at rest it has about 40 */
    SSFR_MAX_CONTACTS = 6,  /* walls and obstacles that a particle sees at once */
    SSFR_MAX_OBSTACLES = 64,
    SSFR_PASS_CHUNK = 256,  /* particles, what a thread takes at a time */
};

/* A wall or obstacle near a particle, as the plane through its nearest point. */
typedef struct ssfr_contact {
    float normal[3]; /* towards the fluid */
    float offset;    /* m: the distance of x from the plane is normal . x + offset */
    float keep;      /* m, how near the particle may come */
    int32_t obstacle; /* -1 for a wall of the domain */
} ssfr_contact;

typedef struct ssfr_label { /* what goes with a particle but is not summed over */
    double birth;     /* s, simulated time */
    uint32_t id;
    float multiplier; /* m^2, lambda, summed over the iterations of a step */
    uint32_t contact_begin; /* in contacts */
    uint8_t n_contacts;
    bool crowded;     /* another particle stands at the same place */
} ssfr_label;

struct ssfr_solver {
    ssfr_solver_setup setup;
    double origin[3];   /* m, world: positions are relative to it */
    double lo[3], hi[3]; /* m, relative: the domain */
    ssfr_kernel kernel;
    float rest;         /* density at rest, in units of the rest density */
    double closest;     /* m, that centres keep from a surface: half the spacing at rest */
    float wall;         /* m, how far inside a surface its density begins */
    float gradients;    /* 1/m^2, sum of the squared gradients of the constraint at rest */
    double time;        /* s, simulated */
    double felt_step;   /* s, the step that the constraint's stiffness belongs to */
    float stiffness;    /* of this step, (0, 1], in that of a lone step of its length */
    uint32_t next_id;
    bool stale;         /* order, lists and densities are not of these positions */
    size_t n, capacity; /* arrays of lanes have one more: a particle out of everyone's reach that fills up lists */
    ssfr_lanes *x;      /* m; at the step's begin */
    ssfr_lanes *at;     /* m; in the iterations. Fourth lane: the multiplier's last change */
    ssfr_lanes *from;   /* m; what the iteration in progress reads */
    ssfr_lanes *moved;  /* m; from x, in this step */
    ssfr_lanes *v;      /* m/s; fourth lane: size of the vorticity */
    float *axes[3];     /* m; x once more, axis by axis: neighbours are sought in it */
    ssfr_label *labels, *spare_labels;
    float *position, *velocity, *density; /* for others: 3 n, 3 n, n */
    uint32_t *neighbours;
    size_t *list_begin;   /* into listed */
    uint32_t *list_end;   /* from list_begin; whole lanes */
    uint32_t *listed;
    size_t listed_capacity;
    ssfr_contact *contacts;
    size_t contacts_capacity;
    ssfr_grid *grid;
    double seconds[SSFR_N_SOLVER_STAGES]; /* of the last step */
    double lap;         /* s by the clock, at which the last stage ended */
};

/* A stage ends here. */
static inline void ssfr_solver_lap(ssfr_solver *solver, ssfr_solver_stage stage)
{
    const double now = ssfr_clock();
    solver->seconds[stage] += now - solver->lap;
    solver->lap = now;
}

/* The solid relative to the solver's origin: far from the world's, it is as exact as at it. */
static inline ssfr_solid ssfr_solver_local(const ssfr_solver *solver, const ssfr_solid *solid)
{
    ssfr_solid local = *solid;
    for (int k = 0; k < 3; k++) local.centre[k] -= solver->origin[k];
    return local;
}

/* Makes room for n particles, those there are keep their values. */
SSFR_MUST ssfr_result ssfr_solver_reserve(ssfr_solver *solver, size_t n);
/* Sorts particles by cells and lists neighbours; densities are not summed. */
SSFR_MUST ssfr_result ssfr_solver_sort(ssfr_solver *solver);
/* Sorts, and sums densities. */
SSFR_MUST ssfr_result ssfr_solver_arrange(ssfr_solver *solver);
/* Copies positions and velocities to where others see them. */
void ssfr_solver_publish(ssfr_solver *solver);
/* Removes what has left by an open side. */
void ssfr_solver_drop_left(ssfr_solver *solver);

/* ---- solver_passes.c: each is a loop over all particles ---------------------------------------------------------- */

SSFR_MUST ssfr_result ssfr_solver_list(ssfr_solver *solver);
void ssfr_solver_sum_density(ssfr_solver *solver);
void ssfr_solver_find_multipliers(ssfr_solver *solver);
void ssfr_solver_correct(ssfr_solver *solver);
/* XSPH and vorticity confinement. */
void ssfr_solver_smooth_velocity(ssfr_solver *solver, double dt);

/* ---- solver_boundary.c ------------------------------------------------------------------------------------------- */

/* Finds the contacts of all particles around where they are predicted to go. In a step, those that begin it too close
 * to something are moved. */
SSFR_MUST ssfr_result ssfr_solver_find_contacts(ssfr_solver *solver, bool in_step, int n_obstacles,
                                                const ssfr_obstacle *obstacles);
/* The density that walls and obstacles add at x, in units of the rest density; its gradient goes to gradient. */
float ssfr_solver_boundary(const ssfr_solver *solver, size_t i, ssfr_lanes x, float gradient[3]);
/* x, moved out of what it touches. */
ssfr_lanes ssfr_solver_project(const ssfr_solver *solver, size_t i, ssfr_lanes x);
/* Friction, and exact distances where planes were only near. */
void ssfr_solver_finish_contacts(ssfr_solver *solver, double dt, const ssfr_obstacle *obstacles);

#endif

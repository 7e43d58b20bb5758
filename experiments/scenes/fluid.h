/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fluid.h: what a simulation shows of its fluid, and the solids that it moves among. */
#ifndef SSFR_FLUID_H
#define SSFR_FLUID_H

#include "scene/grid.h"
#include "scene/solid.h"

static inline double ssfr_particle_mass(double radius) /* kg */
{
    return SSFR_VOLUME_SHARE * 8 * radius * radius * radius * SSFR_REST_DENSITY;
}

/* A view of particles that another owns, valid until its next step. */
typedef struct ssfr_fluid {
    size_t n;
    double origin[3];      /* m, world */
    const float *position; /* m, 3 n, relative to origin */
    const float *velocity; /* m/s, 3 n */
    const float *density;  /* kg/m^3, n */
    double radius;         /* m */
    const ssfr_grid *grid; /* built of these positions; its cells have the support's edge */
} ssfr_fluid;

/* A solid at a step's begin and at its end: a point that sticks to it moves between the two. */
typedef struct ssfr_obstacle {
    ssfr_solid before, now;
    double friction; /* share of the tangential motion relative to the solid that contact takes away, [0, 1] */
} ssfr_obstacle;

/* How far the solid carries the place `at` (world, m, at the step's end) in the step, m. */
static inline void ssfr_obstacle_motion(const ssfr_obstacle *obstacle, const double at[3], double out[3])
{
    double local[3], before[3];
    ssfr_solid_local(&obstacle->now, at, local);
    ssfr_solid_world(&obstacle->before, local, before);
    for (int k = 0; k < 3; k++) out[k] = at[k] - before[k];
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foam_flow.h: what foam sees of the fluid: velocities around a place, the surface, and where the flow is violent. */
#ifndef SSFR_FOAM_FLOW_H
#define SSFR_FOAM_FLOW_H

#include "experiments/scenes/foam.h"
#include "experiments/scenes/kernel.h"
#include "experiments/scenes/walls.h"

/* The fluid in the order of the grid's cells: neighbours are neighbours in memory. Zeroed before the first use. */
typedef struct ssfr_foam_flow {
    size_t n, capacity;
    const ssfr_grid *grid;
    const uint32_t *order;         /* the fluid's index of each */
    double origin[3];              /* m, world */
    double radius;                 /* m */
    ssfr_kernel kernel;            /* the cubic spline; its scale does not count */
    float lo[3], hi[3];            /* m, relative to origin: nobody outside has a neighbour */
    float *at[3], *velocity[3];    /* n each, and some zeros: m relative to origin, m/s */
    float *normal[3];              /* unit, or 0 where there is no surface */
} ssfr_foam_flow;

/* Copies the fluid; its grid must stay. Normals are not found yet. */
SSFR_MUST ssfr_result ssfr_foam_flow_sort(ssfr_foam_flow *flow, const ssfr_fluid *fluid);
void ssfr_foam_flow_finish(ssfr_foam_flow *flow);

/* The fluid's momentum around a place, weighted by the cubic spline, and the number of neighbours. */
typedef struct ssfr_foam_average {
    float momentum[3], weight;
    int n;
} ssfr_foam_average;

ssfr_foam_average ssfr_foam_flow_average(const ssfr_foam_flow *flow, const double at[3]);

/* Surface normals, as if the fluid went on behind walls. */
void ssfr_foam_flow_find_normals(ssfr_foam_flow *flow, const ssfr_walls *walls);

void ssfr_foam_flow_velocity(const ssfr_foam_flow *flow, size_t s, float out[3]); /* m/s */
float ssfr_foam_flow_energy(const float velocity[3], double radius); /* J, kinetic */
/* Of particle s in the flow's order; normals are found. */
ssfr_foam_cause ssfr_foam_flow_cause(const ssfr_foam_flow *flow, size_t s);

#endif

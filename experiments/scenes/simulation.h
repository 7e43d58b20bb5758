/* SPDX-License-Identifier: GPL-3.0-or-later */
/* simulation.h: a description in motion: the solver and its foam among moving solids, emitters and sinks, frame by
 * frame. The same description and seed give the same bits, for any number of threads and across write and read: a
 * change that gives others raises SSFR_SOLVER_VERSION. */
#ifndef SSFR_SIMULATION_H
#define SSFR_SIMULATION_H

#include "experiments/scenes/description.h"

typedef struct ssfr_simulation ssfr_simulation;

/* The pools are filled, nothing has moved. The description must stay. */
SSFR_MUST ssfr_result ssfr_simulation_create(ssfr_simulation **out, const ssfr_description *description, uint64_t seed);
void ssfr_simulation_destroy(ssfr_simulation **simulation);

/* Simulates the next frame. Fails where a value is no longer finite, and after a signal (see interrupt.h): then the
 * simulation is of no further use. */
SSFR_MUST ssfr_result ssfr_simulation_advance(ssfr_simulation *simulation);
/* The frame that it stands at. Those below 0 are the time of rest, in which solids stand as they do at time 0; at first
 * it is one before them. */
int ssfr_simulation_frame(const ssfr_simulation *simulation);
long ssfr_simulation_steps(const ssfr_simulation *simulation); /* so far */

/* The frame's fluid, and its diffuse particles, NULL when the description has none. */
SSFR_MUST ssfr_result ssfr_simulation_export(const ssfr_simulation *simulation, ssfr_particles **fluid,
                                             ssfr_particles **foam);

/* The state at a frame. */
SSFR_MUST ssfr_result ssfr_simulation_write(const ssfr_simulation *simulation, FILE *file);
SSFR_MUST ssfr_result ssfr_simulation_read(ssfr_simulation *simulation, FILE *file);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* surroundings.h: floor, solids and sky of a scene as what light comes from that has left the fluid. */
#ifndef SSFR_TRUTH_SURROUNDINGS_H
#define SSFR_TRUTH_SURROUNDINGS_H

#include "experiments/truth/light.h"
#include "graph/frame.h"

/* The scene without its particles, for rays relative to origin (m, world): the same radiance as the passes `background`
 * and `composite` have it. Its meshes and its environment must stay; the rest may go. All threads may trace at
 * once. */
SSFR_MUST ssfr_result ssfr_surroundings_create(ssfr_surroundings **out, const ssfr_scene *scene,
                                               const ssfr_world *world, const double origin[3]);
void ssfr_surroundings_destroy(ssfr_surroundings **around);

#endif

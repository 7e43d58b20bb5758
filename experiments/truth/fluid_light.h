/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fluid_light.h: the continuous fluid, and what floats in and over it, as the body that light goes through. */
#ifndef SSFR_TRUTH_FLUID_LIGHT_H
#define SSFR_TRUTH_FLUID_LIGHT_H

#include "experiments/truth/crossings.h"
#include "experiments/truth/light.h"
#include "experiments/truth/radiance.h"
#include "graph/frame.h"

/* One thread's. */
typedef struct ssfr_fluid_light ssfr_fluid_light;

/* floating NULL: nothing floats. params: of the integrals of its colours by the integrator. Fluid and what floats must
 * stay. */
SSFR_MUST ssfr_result ssfr_fluid_light_create(ssfr_fluid_light **out, const ssfr_continuum *fluid,
                                              const ssfr_extinction *floating, const ssfr_medium *medium,
                                              ssfr_integrator_id integrator, const ssfr_integrate_params *params);
void ssfr_fluid_light_destroy(ssfr_fluid_light **light);

/* For rays relative to the fluid's origin. */
const ssfr_refractor *ssfr_fluid_light_refractor(const ssfr_fluid_light *light);

/* How often a ray only grazed the surface, so that crossings may be missing in pairs. */
size_t ssfr_fluid_light_touches(const ssfr_fluid_light *light);

#endif

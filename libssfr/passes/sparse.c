/* SPDX-License-Identifier: MIT */
/* sparse.c: particles shrink where the fluid is thin and where they turn to foam; below a density they are spray. */
#include "passes/sparse.h"

static const ssfr_param rows[] = {
    /* A calm surface has 0.83 of the rest density and so its full size; alone a particle has 0.25, two have 0.33, and a
     * droplet of three 0.41: it is water. */
    SSFR_PARAM_REAL(ssfr_sparse_params, density_threshold, "kg/m^3", 0.4 * SSFR_REST_DENSITY, 0, 1e9,
                    "a particle of a lower density is spray and not drawn as water; it has its full size from twice "
                    "the threshold on"),
    SSFR_PARAM_REAL(ssfr_sparse_params, point_shrink, "1", 0.5, 0, 1,
                    "size of a water particle at the threshold; 1: none shrinks (listing A.15)"),
    SSFR_PARAM_FLAG(ssfr_sparse_params, by_foam, 1,
                    "a particle shrinks as water and grows as foam while it turns to foam (the text); off: all are "
                    "drawn as water, and those with any foam as foam (listings A.8, A.10; errata B22, B23)"),
    SSFR_PARAM_END,
};

static bool needed(const ssfr_run *run)
{
    const ssfr_sparse_params *p = run->params;
    return p->density_threshold > 0 || !run->values[1]->same;
}

const ssfr_pass ssfr_sparse = {
    .name = "sparse",
    .source = "Bagar 2010, secs 3.2.1, 4.6.1 and 4.9.5, listings A.8 and A.10",
    .help = "tells how large each particle is as water, foam and spray, by how thin the fluid is and how much is foam",
    .inputs = {{"density", SSFR_SLOT_density}, {"foam", SSFR_SLOT_foam}},
    .outputs = {{"water_size", SSFR_SLOT_water_size},
                {"foam_size", SSFR_SLOT_foam_size},
                {"spray_size", SSFR_SLOT_spray_size}},
    .params = rows,
    .params_size = sizeof(ssfr_sparse_params),
    .needed = needed,
    .needless = "the density threshold is 0, and there is no foam",
    .particles_run = ssfr_sparse_run,
};

/* SPDX-License-Identifier: MIT */
/* sparse.c: particles of thin fluid shrink, and below a density they are spray and no water. */
#include "passes/sparse.h"

static const ssfr_param rows[] = {
    SSFR_PARAM_REAL(ssfr_sparse_params, density_threshold, "kg/m^3", 0.5 * SSFR_REST_DENSITY, 0, 1e9,
                    "a particle of a lower density is spray and not drawn as water; it has its full size from twice "
                    "the threshold on"),
    SSFR_PARAM_REAL(ssfr_sparse_params, point_shrink, "1", 0.5, 0, 1,
                    "size of a water particle at the threshold; 1: none shrinks (listing A.15)"),
    SSFR_PARAM_FLAG(ssfr_sparse_params, by_foam, 1,
                    "water particles shrink as they turn to foam (the text; listings A.8 and A.14 do not, errata B23)"),
    SSFR_PARAM_END,
};

static bool needed(const ssfr_run *run)
{
    const ssfr_sparse_params *p = run->params;
    return p->density_threshold > 0 || (p->by_foam && !run->values[1]->same);
}

const ssfr_pass ssfr_sparse = {
    .name = "sparse",
    .source = "Bagar 2010, secs 3.2.1, 4.6.1 and 4.9.5, listing A.8",
    .help = "draws particles of thin fluid smaller, and those below a density as spray",
    .inputs = {{"density", SSFR_SLOT_density}, {"foam", SSFR_SLOT_foam}},
    .outputs = {{"water_size", SSFR_SLOT_water_size}, {"spray_size", SSFR_SLOT_spray_size}},
    .params = rows,
    .params_size = sizeof(ssfr_sparse_params),
    .needed = needed,
    .needless = "the density threshold is 0, and no foam shrinks the water",
    .particles_run = ssfr_sparse_run,
};

/* SPDX-License-Identifier: MIT */
/* sparse_cpu.c: sizes from densities and foam, in double: listing A.8's scaledPointRadius over particleSize. */
#include "passes/sparse.h"

/* GLSL's, which has no value where both edges are the same: there it is a step. */
static double smoothstep(double lo, double hi, double v)
{
    if (!(hi > lo)) return v >= lo;
    const double t = ssfr_clamp((v - lo) / (hi - lo), 0, 1);
    return t * t * (3 - 2 * t);
}

ssfr_result ssfr_sparse_run(const ssfr_run *run)
{
    const ssfr_sparse_params *p = run->params;
    const double threshold = p->density_threshold;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < run->frame->particles->n; i++) {
        const double density = (double)*ssfr_values_at(run->values[0], i);
        const double foam = (double)*ssfr_values_at(run->values[1], i);
        const bool spray = density < threshold;
        const double full = smoothstep(threshold, 2 * threshold, density);
        const double water = ssfr_mix(p->point_shrink, 1, full) * (p->by_foam ? 1 - foam : 1);
        run->values_out[0][i] = spray ? 0 : (float)water;
        run->values_out[1][i] = spray ? 0 : p->by_foam ? (float)foam : foam > 0;
        run->values_out[2][i] = spray;
    }
    return SSFR_OK;
}

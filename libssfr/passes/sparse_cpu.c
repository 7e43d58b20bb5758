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

/* A particle that is neither spray nor not would be drawn by nobody, and without a word. */
static ssfr_result check(const ssfr_values *density)
{
    size_t bad = SIZE_MAX;
#pragma omp parallel for schedule(static) reduction(min : bad)
    for (size_t i = 0; i < density->n; i++)
        if (isnan(density->data[i]) && i < bad) bad = i;
    if (bad != SIZE_MAX)
        return ssfr_fail(SSFR_ERR_VALUE, "particle %zu (from 0): density nan kg/m^3 tells no size", bad);
    return SSFR_OK;
}

ssfr_result ssfr_sparse_run(const ssfr_run *run)
{
    ssfr_result result = SSFR_OK;
    const ssfr_sparse_params *p = run->params;
    const double threshold = p->density_threshold;
    SSFR_TRY(check(run->values[0]));
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
end:
    return result;
}

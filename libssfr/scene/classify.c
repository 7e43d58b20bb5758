/* SPDX-License-Identifier: MIT */
/* classify.c: splashes, spray and strays told from water by density (Imai 2016) or neighbours (Neto 2015). */
#include "scene/classify.h"
#include "scene/reader.h"

ssfr_result ssfr_particles_need(const ssfr_particles *particles, const char *array, const char *why)
{
    if (particles->n == 0 || ssfr_array_get(particles, ssfr_array_find(array))) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_VALUE, "the particles have no array \"%s\": %s needs it", array, why);
}

static void count(size_t n, const unsigned char *classes, size_t *counts)
{
    for (int c = 0; counts && c < SSFR_N_CLASSES; c++) counts[c] = 0;
    for (size_t i = 0; counts && i < n; i++) counts[classes[i]]++;
}

ssfr_result ssfr_classify_by_density(const ssfr_particles *particles, double threshold, unsigned char *classes,
                                     size_t *counts)
{
    ssfr_result result = SSFR_OK;
    if (isnan(threshold)) SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "density threshold of splashes: %g kg/m^3", threshold));
    SSFR_TRY(ssfr_particles_need(particles, "density", "telling splashes by density"));
    for (size_t i = 0; i < particles->n; i++) {
        const double density = (double)particles->density[i];
        if (isnan(density)) SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "particle %zu (from 0): density %g", i, density));
        classes[i] = density < threshold ? SSFR_CLASS_SPLASH : SSFR_CLASS_LIQUID;
    }
    count(particles->n, classes, counts);
end:
    return result;
}

ssfr_result ssfr_classify_by_neighbours(const ssfr_particles *particles, int t_stray, int t_foam,
                                        unsigned char *classes, size_t *counts)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_particles_need(particles, "neighbours", "telling foam by neighbours"));
    for (size_t i = 0; i < particles->n; i++) {
        const int64_t n_count = particles->neighbours[i];
        classes[i] = n_count <= t_stray ? SSFR_CLASS_STRAY : n_count <= t_foam ? SSFR_CLASS_FOAM : SSFR_CLASS_LIQUID;
    }
    count(particles->n, classes, counts);
end:
    return result;
}

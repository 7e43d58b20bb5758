/* SPDX-License-Identifier: MIT */
/* quantities.c: what a particle's neighbours say of it: the fluid's density, and how many they are. */
#include "scene/neighbours.h"

/* The cubic spline at q = distance / support in [0, 1): its integral over the unit ball is 1. */
static double cubic_spline(double q)
{
    const double rest = 1 - q, norm = 8 / M_PI;
    return norm * (q <= 0.5 ? 6 * q * q * (q - 1) + 1 : 2 * rest * rest * rest);
}

/* kg/m^3: a particle's mass over its support cubed, where the radius cancels and no length can be too small. */
static const double mass_per_support = SSFR_REST_DENSITY * SSFR_VOLUME_SHARE * 8 /
                                       (SSFR_SUPPORT * SSFR_SUPPORT * SSFR_SUPPORT);

static double measure(const ssfr_neighbours *set, size_t k, double support, uint32_t *n_neighbours)
{
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    const int n_ranges = ssfr_neighbours_near(set, k, ranges);
    double sum = 0;
    uint32_t count = 0;
    for (int r = 0; r < n_ranges; r++)
        for (size_t j = ranges[r].begin; j < ranges[r].end; j++) {
            double d[3];
            const double square = ssfr_neighbours_between(set, k, j, d);
            if (square >= support * support) continue;
            sum += cubic_spline(sqrt(square) / support);
            count++;
        }
    *n_neighbours = count - 1; /* it met itself, too */
    return mass_per_support * sum;
}

static void measure_all(const ssfr_neighbours *set, double support, float *density, uint32_t *neighbours)
{
#pragma omp parallel for schedule(dynamic, 1024)
    for (size_t k = 0; k < set->n; k++) {
        uint32_t n_neighbours;
        const double sum = measure(set, k, support, &n_neighbours);
        if (density) density[set->order[k]] = (float)sum;
        if (neighbours) neighbours[set->order[k]] = n_neighbours;
    }
}

ssfr_result ssfr_particles_complete(ssfr_particles *particles, unsigned *computed)
{
    ssfr_result result = SSFR_OK;
    const unsigned missing = (particles->density ? 0 : SSFR_COMPUTED_DENSITY) |
                             (particles->neighbours ? 0 : SSFR_COMPUTED_NEIGHBOURS);
    const double support = SSFR_SUPPORT * particles->radius;
    ssfr_neighbours set = {0};
    float *density = NULL;
    uint32_t *neighbours = NULL;
    if (computed) *computed = 0;
    if (!missing) goto end;
    if (!(particles->radius > 0 && isnormal(support * support)))
        SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "particle radius %g m: densities and neighbours need a positive, finite one",
                           particles->radius));
    SSFR_TRY(ssfr_neighbours_init(&set, particles, support));
    if (missing & SSFR_COMPUTED_DENSITY) SSFR_TRY(ssfr_alloc(&density, set.n, sizeof *density, "densities"));
    if (missing & SSFR_COMPUTED_NEIGHBOURS) SSFR_TRY(ssfr_alloc(&neighbours, set.n, sizeof *neighbours, "neighbours"));
    measure_all(&set, support, density, neighbours);
    if (density) particles->density = density;
    if (neighbours) particles->neighbours = neighbours;
    density = NULL, neighbours = NULL;
    if (computed) *computed = missing;
end:
    ssfr_neighbours_finish(&set);
    free(density);
    free(neighbours);
    return result;
}

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
    const bool any = particles->n > 0;
    const double support = any ? SSFR_SUPPORT * particles->radius : 1; /* m */
    ssfr_neighbours set = {0};
    float *density = NULL;
    uint32_t *neighbours = NULL;
    if (computed) *computed = 0;
    if (!missing) goto end;
    if (any && !(particles->radius > 0 && isnormal(support * support)))
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

/* ---- the radius -------------------------------------------------------------------------------------------------- */

enum { MAX_SAMPLES = 512 };

/* kg/m^3, were the particles of this radius. */
static double median_density(const ssfr_neighbours *set, double radius)
{
    double densities[MAX_SAMPLES];
    const size_t m = set->n < MAX_SAMPLES ? set->n : MAX_SAMPLES;
    uint32_t unused;
    for (size_t s = 0; s < m; s++) densities[s] = measure(set, s * set->n / m, SSFR_SUPPORT * radius, &unused);
    qsort(densities, m, sizeof *densities, ssfr_by_value);
    return densities[m / 2];
}

/* The nearest of others is nearer than fluid at rest is spaced: by a quarter in that of SPlisHSPlasH, never by more
 * than if all places were random, where the radius would be 1.9 half spacings. Closest packed it is 0.96 of them. */
ssfr_result ssfr_particles_estimate_radius(const ssfr_particles *particles, double *radius)
{
    enum { HALVINGS = 24, MOST_CELLS = 1 << 19 /* along an axis: what a grid holds */ };
    ssfr_result result = SSFR_OK;
    ssfr_neighbours set = {0};
    const double half = ssfr_particles_spacing(particles), reach = SSFR_SUPPORT * 1.6 * half;
    double least = 0.9 * half, most = 1.6 * half, lo[3], hi[3], extent = 0;
    *radius = half;
    ssfr_particles_bounds(particles, lo, hi);
    for (int k = 0; k < 3; k++) extent = fmax(extent, hi[k] - lo[k]);
    if (!isnormal(reach * reach) || extent > MOST_CELLS * reach) goto end;
    SSFR_TRY(ssfr_neighbours_init(&set, particles, reach));
    if (median_density(&set, least) > SSFR_REST_DENSITY || median_density(&set, most) < SSFR_REST_DENSITY) goto end;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (least + most);
        *(median_density(&set, middle) < SSFR_REST_DENSITY ? &least : &most) = middle;
    }
    *radius = most;
end:
    ssfr_neighbours_finish(&set);
    return result;
}

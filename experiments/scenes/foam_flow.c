/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foam_flow.c: what foam sees of the fluid: average velocities, surface normals, trapped air and wave crests. */
#include "experiments/scenes/foam_flow.h"

#include <assert.h>

#define CREST_COSINE 0.6f /* eq. 7: between velocity and normal, from which a crest counts */
/* Of the colour field's gradient, in the sum of its terms' magnitudes: 0.28 at the flat surface of a cubic lattice;
 * inside a simulated fluid (39 neighbours and more) it stays below 0.18. */
#define SURFACE_SHARE 0.2f

static ssfr_result resize(float **array, size_t n)
{
    float *memory = realloc(*array, 3 * n * sizeof **array);
    if (!memory) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %zu places of the fluid around foam", n);
    *array = memory;
    return SSFR_OK;
}

static ssfr_result reserve(ssfr_foam_flow *f, size_t n)
{
    ssfr_result result = SSFR_OK;
    if (n <= f->capacity) return SSFR_OK;
    SSFR_TRY(resize(&f->at, n));
    SSFR_TRY(resize(&f->velocity, n));
    SSFR_TRY(resize(&f->normal, n));
    f->capacity = n;
end:
    return result;
}

ssfr_result ssfr_foam_flow_sort(ssfr_foam_flow *f, const ssfr_fluid *fluid)
{
    ssfr_result result = SSFR_OK;
    f->n = fluid->n;
    f->radius = fluid->radius;
    f->support = (float)(SSFR_SUPPORT * fluid->radius);
    for (int k = 0; k < 3; k++) f->origin[k] = fluid->origin[k], f->lo[k] = INFINITY, f->hi[k] = -INFINITY;
    if (f->n == 0) return SSFR_OK;
    assert(ssfr_grid_cell(fluid->grid) > 0.999999 * SSFR_SUPPORT * fluid->radius);
    SSFR_TRY(reserve(f, f->n));
    f->grid = fluid->grid;
    f->order = ssfr_grid_order(fluid->grid);
    for (size_t s = 0; s < f->n; s++)
        for (size_t k = 0; k < 3; k++) {
            const float at = fluid->position[3 * (size_t)f->order[s] + k];
            f->at[3 * s + k] = at;
            f->velocity[3 * s + k] = fluid->velocity[3 * (size_t)f->order[s] + k];
            if (at - f->support < f->lo[k]) f->lo[k] = at - f->support;
            if (at + f->support > f->hi[k]) f->hi[k] = at + f->support;
        }
end:
    return result;
}

void ssfr_foam_flow_finish(ssfr_foam_flow *f)
{
    free(f->at);
    free(f->velocity);
    free(f->normal);
    *f = (ssfr_foam_flow){0};
}

/* ---- neighbours -------------------------------------------------------------------------------------------------- */

/* What is done with neighbour s, `distance` (m) away; d points from the neighbour to the place. */
typedef void visit(void *sums, const ssfr_foam_flow *f, size_t s, const float d[3], float distance);

/* Visits all of the fluid nearer than the support. Inlined, so that the visit costs no call. */
__attribute__((always_inline)) static inline void each_near(const ssfr_foam_flow *f, const float at[3], visit *visit,
                                                            void *sums)
{
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    const float reach = f->support * f->support;
    bool inside = true; /* false also for places so far away that no float holds them */
    for (int k = 0; k < 3; k++) inside = inside && at[k] >= f->lo[k] && at[k] <= f->hi[k];
    const int n = inside ? ssfr_grid_near(f->grid, at, ranges) : 0;
    for (int r = 0; r < n; r++)
        for (size_t s = ranges[r].begin; s < ranges[r].end; s++) {
            const float *other = f->at + 3 * s;
            const float d[3] = {at[0] - other[0], at[1] - other[1], at[2] - other[2]};
            const float square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            if (square < reach) visit(sums, f, s, d, sqrtf(square));
        }
}

static inline float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The cubic spline and minus its slope, not normalised, at q = distance / support, [0, 1). */
static inline float spline(float q)
{
    const float a = 1 - q, b = q < 0.5f ? 0.5f - q : 0;
    return 2 * a * a * a - 8 * b * b * b;
}

static inline float spline_slope(float q)
{
    const float a = 1 - q, b = q < 0.5f ? 0.5f - q : 0;
    return 6 * a * a - 24 * b * b;
}

static inline void add_velocity(void *sums, const ssfr_foam_flow *f, size_t s, const float d[3], float distance)
{
    ssfr_foam_average *a = sums;
    const float weight = spline(distance / f->support);
    (void)d;
    for (size_t k = 0; k < 3; k++) a->momentum[k] += weight * f->velocity[3 * s + k];
    a->weight += weight;
    a->n++;
}

ssfr_foam_average ssfr_foam_flow_average(const ssfr_foam_flow *f, const double at[3])
{
    ssfr_foam_average a = {0};
    float relative[3];
    for (int k = 0; k < 3; k++) relative[k] = (float)(at[k] - f->origin[k]);
    each_near(f, relative, add_velocity, &a);
    return a;
}

/* ---- the surface ------------------------------------------------------------------------------------------------- */

/* The gradient of the colour field, of particles of one volume, and the sum of its terms' magnitudes: all that counts
 * is their ratio. */
typedef struct gradient {
    float sum[3], magnitude;
} gradient;

static inline void add_gradient(void *sums, const ssfr_foam_flow *f, size_t s, const float d[3], float distance)
{
    gradient *g = sums;
    const float slope = spline_slope(distance / f->support), scale = distance > 0 ? slope / distance : 0;
    (void)s;
    for (int k = 0; k < 3; k++) g->sum[k] += scale * d[k];
    g->magnitude += slope;
}

/* Were the fluid mirrored behind a wall, its gradient would not point into the wall. */
static void mirror(const ssfr_walls *walls, const double at[3], float sum[3])
{
    for (int i = 0; i < ssfr_walls_count(walls); i++) {
        double normal[3];
        if (!(ssfr_walls_distance(walls, i, at, normal) < walls->support)) continue;
        const double away = normal[0] * (double)sum[0] + normal[1] * (double)sum[1] + normal[2] * (double)sum[2];
        for (int k = 0; k < 3 && away < 0; k++) sum[k] -= (float)(away * normal[k]);
    }
}

static bool is_surface(const gradient *g)
{
    return sqrtf(dot(g->sum, g->sum)) > SURFACE_SHARE * g->magnitude;
}

static void find_normal(ssfr_foam_flow *f, const ssfr_walls *walls, size_t s)
{
    gradient g = {0};
    double at[3];
    each_near(f, f->at + 3 * s, add_gradient, &g);
    for (size_t k = 0; k < 3; k++) at[k] = f->origin[k] + (double)f->at[3 * s + k];
    if (is_surface(&g)) mirror(walls, at, g.sum);
    const float length = sqrtf(dot(g.sum, g.sum));
    for (size_t k = 0; k < 3; k++) f->normal[3 * s + k] = is_surface(&g) ? g.sum[k] / length : 0;
}

void ssfr_foam_flow_find_normals(ssfr_foam_flow *f, const ssfr_walls *walls)
{
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t s = 0; s < f->n; s++) find_normal(f, walls, s);
}

/* ---- causes: what potentials are made of ------------------------------------------------------------------------- */

/* Of a particle with the rest of the fluid. */
typedef struct meeting {
    const float *velocity, *normal;
    float trapped_air, curvature;
} meeting;

static inline void add_meeting(void *sums, const ssfr_foam_flow *f, size_t s, const float d[3], float distance)
{
    meeting *m = sums;
    const float *v = f->velocity + 3 * s, *normal = f->normal + 3 * s;
    const float weight = 1 - distance / f->support;
    const float apart[3] = {m->velocity[0] - v[0], m->velocity[1] - v[1], m->velocity[2] - v[2]};
    /* |v| (1 - v^ . x^) without dividing by |v|; in one place there is no x^, and no direction counts. */
    const float leaving = distance > 0 ? dot(apart, d) / distance : 0;
    m->trapped_air += (sqrtf(dot(apart, apart)) - leaving) * weight;
    /* Of neighbours that are surface themselves and lie below: x_ji . n_i < 0. */
    if (dot(d, m->normal) > 0 && dot(normal, normal) > 0) m->curvature += (1 - dot(m->normal, normal)) * weight;
}

static bool is_crest(const float velocity[3], const float normal[3])
{
    const float along = dot(velocity, normal);
    return along > 0 && along >= CREST_COSINE * sqrtf(dot(velocity, velocity));
}

float ssfr_foam_flow_energy(const float velocity[3], double radius)
{
    return (float)(0.5 * ssfr_particle_mass(radius) * (double)dot(velocity, velocity));
}

ssfr_foam_cause ssfr_foam_flow_cause(const ssfr_foam_flow *f, size_t s)
{
    meeting m = {f->velocity + 3 * s, f->normal + 3 * s, 0, 0};
    each_near(f, f->at + 3 * s, add_meeting, &m);
    return (ssfr_foam_cause){.trapped_air = m.trapped_air,
                             .wave_crest = is_crest(m.velocity, m.normal) ? m.curvature : 0,
                             .energy = ssfr_foam_flow_energy(m.velocity, f->radius)};
}

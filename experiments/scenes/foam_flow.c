/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foam_flow.c: what foam sees of the fluid: average velocities, surface normals, trapped air and wave crests. */
#include "experiments/scenes/foam_flow.h"

#include <assert.h>

#define CREST_COSINE 0.6f /* eq. 7: between velocity and normal, from which a crest counts */
/* Of the colour field's gradient, in the sum of its terms' magnitudes: 0.28 at the flat surface of a cubic lattice;
 * inside a simulated fluid (39 neighbours and more) it stays below 0.18. */
#define SURFACE_SHARE 0.2f

/* Room for n, and for the last four to be read at once. */
static ssfr_result resize(float *arrays[3], size_t n)
{
    for (int k = 0; k < 3; k++) {
        float *memory = realloc(arrays[k], (n + SSFR_LANES) * sizeof *memory);
        if (!memory) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %zu places of the fluid around foam", n);
        arrays[k] = memory;
    }
    return SSFR_OK;
}

static ssfr_result reserve(ssfr_foam_flow *f, size_t n)
{
    ssfr_result result = SSFR_OK;
    if (n <= f->capacity) return SSFR_OK;
    SSFR_TRY(resize(f->at, n));
    SSFR_TRY(resize(f->velocity, n));
    SSFR_TRY(resize(f->normal, n));
    f->capacity = n;
end:
    return result;
}

/* Values k of all particles, in the order of cells. */
static void gather(const ssfr_foam_flow *f, int k, const float *values, float *out)
{
    for (size_t s = 0; s < f->n; s++) out[s] = values[3 * (size_t)f->order[s] + (size_t)k];
    memset(out + f->n, 0, SSFR_LANES * sizeof *out);
}

ssfr_result ssfr_foam_flow_sort(ssfr_foam_flow *f, const ssfr_fluid *fluid)
{
    ssfr_result result = SSFR_OK;
    const double support = SSFR_SUPPORT * fluid->radius;
    f->n = fluid->n;
    f->radius = fluid->radius;
    f->kernel = ssfr_kernel_make(support, 1);
    for (int k = 0; k < 3; k++) f->origin[k] = fluid->origin[k], f->lo[k] = INFINITY, f->hi[k] = -INFINITY;
    if (f->n == 0) return SSFR_OK;
    assert(ssfr_grid_cell(fluid->grid) > 0.999999 * support);
    SSFR_TRY(reserve(f, f->n));
    f->grid = fluid->grid;
    f->order = ssfr_grid_order(fluid->grid);
    for (int k = 0; k < 3; k++) {
        gather(f, k, fluid->position, f->at[k]);
        gather(f, k, fluid->velocity, f->velocity[k]);
        memset(f->normal[k], 0, (f->n + SSFR_LANES) * sizeof *f->normal[k]);
        for (size_t s = 0; s < f->n; s++) {
            if (f->at[k][s] < f->lo[k]) f->lo[k] = f->at[k][s];
            if (f->at[k][s] > f->hi[k]) f->hi[k] = f->at[k][s];
        }
        f->lo[k] -= f->kernel.support;
        f->hi[k] += f->kernel.support;
    }
end:
    return result;
}

void ssfr_foam_flow_finish(ssfr_foam_flow *f)
{
    for (int k = 0; k < 3; k++) {
        free(f->at[k]);
        free(f->velocity[k]);
        free(f->normal[k]);
    }
    *f = (ssfr_foam_flow){0};
}

void ssfr_foam_flow_velocity(const ssfr_foam_flow *f, size_t s, float out[3])
{
    for (int k = 0; k < 3; k++) out[k] = f->velocity[k][s];
}

/* ---- neighbours -------------------------------------------------------------------------------------------------- */

/* Four particles from s on, as seen from a place. Those that are not near are to count nothing. */
typedef struct four {
    size_t s;
    ssfr_lanes d[3], r; /* m, from each particle to the place, and the length */
    ssfr_lanes_mask near;
} four;

/* The loop over x, y and z, all of it in registers. */
#define UNROLL _Pragma("GCC unroll 3")

typedef void visit(void *sums, const ssfr_foam_flow *f, const four *four);

static inline ssfr_lanes dot(const ssfr_lanes a[3], const ssfr_lanes b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Visits all of the fluid nearer than the support. Inlined, so that the visit costs no call. */
__attribute__((always_inline)) static inline void each_near(const ssfr_foam_flow *f, const float at[3], visit *visit,
                                                            void *sums)
{
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    bool inside = true; /* false also for places so far away that no float holds them */
    for (int k = 0; k < 3; k++) inside = inside && at[k] >= f->lo[k] && at[k] <= f->hi[k];
    const int n = inside ? ssfr_grid_near(f->grid, at, ranges) : 0;
    for (int i = 0; i < n; i++)
        for (size_t s = ranges[i].begin; s < ranges[i].end; s += SSFR_LANES) {
            const ssfr_lanes_mask lane = {0, 1, 2, 3}, in_range = lane < (int32_t)(ranges[i].end - s);
            four four;
            four.s = s;
            UNROLL for (int k = 0; k < 3; k++) four.d[k] = at[k] - ssfr_lanes_load(f->at[k] + s);
            four.r = ssfr_lanes_sqrt(dot(four.d, four.d));
            four.near = (four.r < f->kernel.support) & in_range;
            visit(sums, f, &four);
        }
}

typedef struct momentum {
    ssfr_lanes sum[3], weight;
    ssfr_lanes_mask n; /* negative */
} momentum;

static inline void add_velocity(void *sums, const ssfr_foam_flow *f, const four *four)
{
    momentum *m = sums;
    const ssfr_lanes weight = ssfr_lanes_where(four->near, ssfr_kernel_value(&f->kernel, four->r));
    UNROLL for (int k = 0; k < 3; k++) m->sum[k] += weight * ssfr_lanes_load(f->velocity[k] + four->s);
    m->weight += weight;
    m->n += four->near;
}

ssfr_foam_average ssfr_foam_flow_average(const ssfr_foam_flow *f, const double at[3])
{
    momentum m = {0};
    float relative[3];
    for (int k = 0; k < 3; k++) relative[k] = (float)(at[k] - f->origin[k]);
    each_near(f, relative, add_velocity, &m);
    return (ssfr_foam_average){
        .momentum = {ssfr_lanes_sum(m.sum[0]), ssfr_lanes_sum(m.sum[1]), ssfr_lanes_sum(m.sum[2])},
        .weight = ssfr_lanes_sum(m.weight), .n = -(m.n[0] + m.n[1] + m.n[2] + m.n[3])};
}

/* ---- the surface ------------------------------------------------------------------------------------------------- */

/* The gradient of the colour field, of particles of one volume, and the sum of its terms' magnitudes: all that counts
 * is their ratio. */
typedef struct gradient {
    ssfr_lanes sum[3], magnitude;
} gradient;

static inline void add_gradient(void *sums, const ssfr_foam_flow *f, const four *four)
{
    gradient *g = sums;
    const ssfr_lanes slope = ssfr_lanes_where(four->near, -ssfr_kernel_slope(&f->kernel, four->r));
    const ssfr_lanes scale = ssfr_lanes_where(four->r > 0, slope / four->r);
    UNROLL for (int k = 0; k < 3; k++) g->sum[k] += scale * four->d[k];
    g->magnitude += slope;
}

/* Were the fluid mirrored behind a wall, its gradient would not point into the wall. */
static void mirror(const ssfr_walls *walls, const double at[3], double sum[3])
{
    for (int i = 0; i < ssfr_walls_count(walls); i++) {
        double normal[3];
        if (!(ssfr_walls_distance(walls, i, at, normal) < walls->support)) continue;
        const double away = ssfr_dot(normal, sum);
        for (int k = 0; k < 3 && away < 0; k++) sum[k] -= away * normal[k];
    }
}

static void find_normal(ssfr_foam_flow *f, const ssfr_walls *walls, size_t s)
{
    const float place[3] = {f->at[0][s], f->at[1][s], f->at[2][s]};
    gradient g = {0};
    double sum[3], at[3];
    each_near(f, place, add_gradient, &g);
    for (int k = 0; k < 3; k++) sum[k] = (double)ssfr_lanes_sum(g.sum[k]), at[k] = f->origin[k] + (double)place[k];
    const double least = (double)(SURFACE_SHARE * ssfr_lanes_sum(g.magnitude));
    if (ssfr_dot(sum, sum) > least * least) mirror(walls, at, sum);
    const bool surface = ssfr_normalize(sum) > least;
    for (int k = 0; k < 3; k++) f->normal[k][s] = surface ? (float)sum[k] : 0;
}

void ssfr_foam_flow_find_normals(ssfr_foam_flow *f, const ssfr_walls *walls)
{
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t s = 0; s < f->n; s++) find_normal(f, walls, s);
}

/* ---- causes: what potentials are made of ------------------------------------------------------------------------- */

/* Of a particle with the rest of the fluid. */
typedef struct meeting {
    ssfr_lanes velocity[3], normal[3];
    ssfr_lanes trapped_air, curvature;
} meeting;

static inline void add_meeting(void *sums, const ssfr_foam_flow *f, const four *four)
{
    meeting *m = sums;
    ssfr_lanes apart[3], normal[3];
    UNROLL for (int k = 0; k < 3; k++) {
        apart[k] = m->velocity[k] - ssfr_lanes_load(f->velocity[k] + four->s);
        normal[k] = ssfr_lanes_load(f->normal[k] + four->s);
    }
    const ssfr_lanes weight = ssfr_lanes_where(four->near, 1 - four->r * f->kernel.per_support);
    /* |v| (1 - v^ . x^) without dividing by |v|; in one place there is no x^, and no direction counts. */
    const ssfr_lanes leaving = ssfr_lanes_where(four->r > 0, dot(apart, four->d) / four->r);
    m->trapped_air += (ssfr_lanes_sqrt(dot(apart, apart)) - leaving) * weight;
    /* Of neighbours that are surface themselves and lie below: x_ji . n_i < 0. */
    const ssfr_lanes_mask below = (dot(four->d, m->normal) > 0) & (dot(normal, normal) > 0);
    m->curvature += ssfr_lanes_where(below, (1 - dot(m->normal, normal)) * weight);
}

static bool is_crest(const ssfr_foam_flow *f, size_t s)
{
    float along = 0, square = 0;
    for (int k = 0; k < 3; k++) {
        along += f->velocity[k][s] * f->normal[k][s];
        square += f->velocity[k][s] * f->velocity[k][s];
    }
    return along > 0 && along >= CREST_COSINE * sqrtf(square);
}

float ssfr_foam_flow_energy(const float v[3], double radius)
{
    return (float)(0.5 * ssfr_particle_mass(radius) * (double)(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
}

ssfr_foam_cause ssfr_foam_flow_cause(const ssfr_foam_flow *f, size_t s)
{
    const float place[3] = {f->at[0][s], f->at[1][s], f->at[2][s]};
    meeting m = {0};
    float velocity[3];
    ssfr_foam_flow_velocity(f, s, velocity);
    for (int k = 0; k < 3; k++) {
        m.velocity[k] = ssfr_lanes_all(velocity[k]);
        m.normal[k] = ssfr_lanes_all(f->normal[k][s]);
    }
    each_near(f, place, add_meeting, &m);
    return (ssfr_foam_cause){.trapped_air = ssfr_lanes_sum(m.trapped_air),
                             .wave_crest = is_crest(f, s) ? ssfr_lanes_sum(m.curvature) : 0,
                             .energy = ssfr_foam_flow_energy(velocity, f->radius)};
}

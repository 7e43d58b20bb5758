/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tank.c: filling tanks, moving their water, and measuring it. */
#include "experiments/scenes/tank.h"

#include "base/param.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>

/* Length of the mean unit vector to a particle's neighbours. Inside it is below 0.1, on a plane surface 0.5, and on the
 * layer below that, which still feels the surface, between. */
#define ONE_SIDED 0.2

typedef struct shape {
    double lo[3], hi[3]; /* m, the domain */
    double from[3];      /* m, the water's lowest corner */
    int size[3];         /* of the water, in layers */
} shape;

static const shape shapes[] = {
    [SSFR_TANK_POOL] = {{0, 0, 0}, {1, 2, 0.5}, {0, 0, 0}, {2, 1, 1}},
    [SSFR_TANK_DAM_BREAK] = {{0, 0, 0}, {1, 2, 0.5}, {0, 0, 0}, {1, 2, 1}},
    [SSFR_TANK_DROP] = {{-1, -6, -1}, {1, 1, 1}, {-0.25, 0, -0.25}, {1, 1, 1}},
};
static const double width = 0.5; /* m, of all the water: `layers` particles */

const char *const ssfr_tank_words[] = {"pool", "dam_break", "drop", NULL};
const char *const ssfr_tank_help[] = {
    "1 m long, 0.5 m wide, 0.5 m deep, between walls",
    "0.5 m long, 0.5 m wide, 1 m high, in one half of the pool's tank",
    "a cube of 0.5 m that falls from rest and touches nothing",
    NULL,
};

/* ---- filling ----------------------------------------------------------------------------------------------------- */

static ssfr_result fill(ssfr_tank *tank, const shape *s, int layers)
{
    ssfr_result result = SSFR_OK;
    double *positions = NULL, *at;
    int n[3];
    for (int k = 0; k < 3; k++) n[k] = s->size[k] * layers;
    SSFR_TRY(ssfr_alloc(&positions, tank->n, 3 * sizeof *positions, "water"));
    at = positions;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++, at += 3) {
                const int cell[3] = {x, y, z};
                for (int k = 0; k < 3; k++) at[k] = s->from[k] + (cell[k] + 0.5) * tank->spacing;
            }
    SSFR_TRY(ssfr_solver_add(tank->solver, tank->n, positions, NULL));
end:
    free(positions);
    return result;
}

ssfr_result ssfr_tank_create(ssfr_tank **out, ssfr_tank_kind kind, int layers, const ssfr_solver_params *params)
{
    ssfr_result result = SSFR_OK;
    ssfr_tank *tank = NULL;
    const shape *s = &shapes[kind];
    ssfr_solver_setup setup = {.gravity = {0, -9.81, 0}};
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&tank, 1, sizeof *tank, "a tank"));
    *tank = (ssfr_tank){.kind = kind, .n = 1, .spacing = width / layers, .gravity = -setup.gravity[1],
                        .floor = {s->hi[0] - s->lo[0], s->hi[2] - s->lo[2]}};
    for (int k = 0; k < 3; k++) tank->n *= (size_t)(s->size[k] * layers);
    tank->radius = tank->spacing / (2 * cbrt(SSFR_VOLUME_SHARE));
    setup.radius = tank->radius;
    setup.max_particles = tank->n;
    memcpy(setup.lo, s->lo, sizeof setup.lo);
    memcpy(setup.hi, s->hi, sizeof setup.hi);
    if (params)
        setup.params = *params;
    else
        ssfr_params_default(ssfr_solver_rows, &setup.params);
    SSFR_TRY(ssfr_solver_create(&tank->solver, &setup));
    SSFR_TRY(fill(tank, s, layers));
    *out = tank;
    tank = NULL;
end:
    ssfr_tank_destroy(&tank);
    return result;
}

void ssfr_tank_destroy(ssfr_tank **tank)
{
    if (*tank) ssfr_solver_destroy(&(*tank)->solver);
    free(*tank);
    *tank = NULL;
}

ssfr_result ssfr_tank_step(ssfr_tank *tank, double end)
{
    const double left = end - tank->time, limit = ssfr_solver_limit(tank->solver);
    const double n = ceil(left / limit - 1e-9), dt = isfinite(n) ? left / n : limit;
    const ssfr_result result = ssfr_solver_step(tank->solver, dt, 0, NULL);
    tank->time = n <= 1 ? end : tank->time + dt;
    tank->steps++;
    return result;
}

/* ---- the interior ------------------------------------------------------------------------------------------------ */

static bool near_wall(const ssfr_tank *tank, const float x[3], const double origin[3])
{
    const shape *s = &shapes[tank->kind];
    const double support = SSFR_SUPPORT * tank->radius;
    bool near = false;
    for (int k = 0; k < 3; k++) {
        const double at = origin[k] + (double)x[k];
        near |= at - s->lo[k] < support || s->hi[k] - at < support;
    }
    return near;
}

typedef struct surroundings { /* neighbours within the support */
    double towards[3]; /* sum of unit vectors to them */
    int n;
    bool marked;       /* one of them is */
} surroundings;

/* marks may be NULL. */
static surroundings look_around(const ssfr_fluid *fluid, size_t i, const bool *marks)
{
    surroundings s = {0};
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    const uint32_t *order = ssfr_grid_order(fluid->grid);
    const float *xi = fluid->position + 3 * i;
    const int n = ssfr_grid_near(fluid->grid, xi, ranges);
    for (int r = 0; r < n; r++)
        for (uint32_t o = ranges[r].begin; o < ranges[r].end; o++) {
            const size_t j = order[o];
            double d[3];
            for (size_t k = 0; k < 3; k++) d[k] = (double)fluid->position[3 * j + k] - (double)xi[k];
            const double distance = ssfr_normalize(d);
            if (j == i || distance >= SSFR_SUPPORT * fluid->radius) continue;
            for (int k = 0; k < 3; k++) s.towards[k] += d[k];
            s.marked |= marks && marks[j];
            s.n++;
        }
    return s;
}

/* Next to walls neighbours lie to one side too: there nothing is marked. */
static void mark_surface(const ssfr_tank *tank, const ssfr_fluid *fluid, bool *marks)
{
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t i = 0; i < fluid->n; i++) {
        const surroundings s = look_around(fluid, i, NULL);
        marks[i] = !near_wall(tank, fluid->position + 3 * i, fluid->origin) &&
                   sqrt(ssfr_dot(s.towards, s.towards)) >= ONE_SIDED * s.n;
    }
}

static void mark_interior(const ssfr_tank *tank, const ssfr_fluid *fluid, const bool *surface, bool *interior)
{
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t i = 0; i < fluid->n; i++)
        interior[i] = !surface[i] && !near_wall(tank, fluid->position + 3 * i, fluid->origin) &&
                      !look_around(fluid, i, surface).marked;
}

/* ---- sums -------------------------------------------------------------------------------------------------------- */

static void sum_densities(const ssfr_fluid *fluid, const bool *interior, ssfr_tank_state *out)
{
    double sum = 0, squares = 0, compressed = 0;
    for (size_t i = 0; i < fluid->n; i++) {
        const double deviation = (double)fluid->density[i] / SSFR_REST_DENSITY - 1, compression = fmax(deviation, 0);
        if (!interior[i]) continue;
        out->interior++;
        sum += deviation;
        squares += ssfr_square(deviation);
        compressed += ssfr_square(compression);
        out->density_max = fmax(out->density_max, fabs(deviation));
        out->compression_max = fmax(out->compression_max, compression);
    }
    const double n = (double)out->interior;
    out->density_mean = sum / n; /* 0 / 0 is NaN */
    out->density_rms = sqrt(squares / n);
    out->compression_rms = sqrt(compressed / n);
    if (out->interior == 0) out->density_max = out->compression_max = NAN;
}

static void sum_motion(const ssfr_tank *tank, const ssfr_fluid *fluid, ssfr_tank_state *out)
{
    const double mass = ssfr_particle_mass(tank->radius), n = (double)fluid->n;
    double squares = 0, heights = 0, fastest = 0;
    for (size_t i = 0; i < fluid->n; i++) {
        const float *v = fluid->velocity + 3 * i;
        const double square = ssfr_square((double)v[0]) + ssfr_square((double)v[1]) + ssfr_square((double)v[2]);
        squares += square;
        fastest = fmax(fastest, square);
        heights += fluid->origin[1] + (double)fluid->position[3 * i + 1] - shapes[tank->kind].lo[1];
        out->volume += mass / (double)fluid->density[i];
    }
    out->speed_rms = sqrt(squares / n);
    out->speed_max = sqrt(fastest);
    out->centre = heights / n;
    out->energy = mass * (0.5 * squares + tank->gravity * heights);
}

/* Columns are two spacings wide: in one as wide as the spacing a particle may be missing. */
static ssfr_result find_surface(const ssfr_tank *tank, const ssfr_fluid *fluid, ssfr_tank_state *out)
{
    ssfr_result result = SSFR_OK;
    const shape *s = &shapes[tank->kind];
    double *tops = NULL;
    int n[2];
    for (int k = 0; k < 2; k++) n[k] = ssfr_max_int(1, (int)(tank->floor[k] / (2 * tank->spacing)));
    const size_t n_columns = (size_t)n[0] * (size_t)n[1];
    SSFR_TRY(ssfr_alloc(&tops, n_columns, sizeof *tops, "columns"));
    for (size_t i = 0; i < fluid->n; i++) {
        const float *x = fluid->position + 3 * i;
        int at[2];
        for (int k = 0; k < 2; k++) {
            const double along = fluid->origin[2 * k] + (double)x[2 * k] - s->lo[2 * k];
            at[k] = ssfr_clamp_int((int)(along / tank->floor[k] * n[k]), 0, n[k] - 1);
        }
        double *top = &tops[at[1] * n[0] + at[0]];
        *top = fmax(*top, fluid->origin[1] + (double)x[1] - s->lo[1] + 0.5 * tank->spacing);
    }
    gsl_sort(tops, 1, n_columns);
    out->surface = gsl_stats_median_from_sorted_data(tops, 1, n_columns);
end:
    free(tops);
    return result;
}

ssfr_result ssfr_tank_measure(const ssfr_tank *tank, ssfr_tank_state *out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_fluid fluid = ssfr_solver_fluid(tank->solver);
    bool *surface = NULL, *interior = NULL;
    *out = (ssfr_tank_state){0};
    SSFR_TRY(ssfr_alloc(&surface, fluid.n, sizeof *surface, "marks"));
    SSFR_TRY(ssfr_alloc(&interior, fluid.n, sizeof *interior, "marks"));
    mark_surface(tank, &fluid, surface);
    mark_interior(tank, &fluid, surface, interior);
    sum_densities(&fluid, interior, out);
    sum_motion(tank, &fluid, out);
    SSFR_TRY(find_surface(tank, &fluid, out));
end:
    free(surface);
    free(interior);
    return result;
}

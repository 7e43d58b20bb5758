/* SPDX-License-Identifier: GPL-3.0-or-later */
/* solver_passes.c: the solver's sums over neighbours, four at a time. Equations are Macklin and Mueller's (2013). */
#include "experiments/scenes/solver_internal.h"

#define COINCIDE 1e-3f /* supports: particles as near as that stand at one place */
#define MOST 0.1f       /* of the constraint: what is denser was put there, and is not thrown out at once */
#define FEWEST 1e-6f   /* of the gradients at rest: keeps divisors positive where a particle is alone */

/* Four neighbours of a particle: x_i - x_j, the distance, and the neighbours' fourth lane. */
typedef struct four {
    ssfr_lanes dx, dy, dz, r, w;
} four;

static inline four load_four(const ssfr_lanes *x, ssfr_lanes xi, const uint32_t *j)
{
    ssfr_lanes m[4] = {x[j[0]], x[j[1]], x[j[2]], x[j[3]]};
    ssfr_lanes_transpose(m);
    const ssfr_lanes dx = xi[0] - m[0], dy = xi[1] - m[1], dz = xi[2] - m[2];
    return (four){dx, dy, dz, ssfr_lanes_sqrt(dx * dx + dy * dy + dz * dz), m[3]};
}

/* Divisor for directions: particles at one place have none, and then x_i - x_j is 0 anyway. */
static inline ssfr_lanes apart(ssfr_lanes r)
{
    return r + 1e-20f;
}

/* ---- lists of neighbours ----------------------------------------------------------------------------------------- */

/* The lanes whose bits are set, in the first places; and how many. */
static const struct {
    uint32_t lane[SSFR_LANES], n;
} packed[1 << SSFR_LANES] = {
    {{0, 0, 0, 0}, 0}, {{0, 0, 0, 0}, 1}, {{1, 0, 0, 0}, 1}, {{0, 1, 0, 0}, 2},
    {{2, 0, 0, 0}, 1}, {{0, 2, 0, 0}, 2}, {{1, 2, 0, 0}, 2}, {{0, 1, 2, 0}, 3},
    {{3, 0, 0, 0}, 1}, {{0, 3, 0, 0}, 2}, {{1, 3, 0, 0}, 2}, {{0, 1, 3, 0}, 3},
    {{2, 3, 0, 0}, 2}, {{0, 2, 3, 0}, 3}, {{1, 2, 3, 0}, 3}, {{0, 1, 2, 3}, 4},
};

/* Appends those of a range's particles, but i, that are within the support. Returns the new length. *crowded becomes
 * true when one of them stands at i's place. */
static size_t list_range(const ssfr_solver *solver, size_t i, ssfr_grid_range range, size_t n, uint32_t *list,
                         bool *crowded)
{
    const ssfr_lanes xi = solver->x[i];
    const float reach = solver->kernel.support * solver->kernel.support, coincide = reach * COINCIDE * COINCIDE;
    for (uint32_t j = range.begin; j < range.end && n < SSFR_MAX_LISTED; j += SSFR_LANES) {
        const ssfr_lanes dx = xi[0] - ssfr_lanes_load(solver->axes[0] + j);
        const ssfr_lanes dy = xi[1] - ssfr_lanes_load(solver->axes[1] + j);
        const ssfr_lanes dz = xi[2] - ssfr_lanes_load(solver->axes[2] + j);
        const ssfr_lanes squares = dx * dx + dy * dy + dz * dz;
        const uint32_t left = range.end - j, self = (uint32_t)i - j;
        unsigned near = ssfr_lanes_bits(squares < reach);
        if (left < SSFR_LANES) near &= (1u << left) - 1;
        if (self < SSFR_LANES) near &= ~(1u << self);
        if (near & ssfr_lanes_bits(squares < coincide)) *crowded = true;
        for (uint32_t l = 0; l < SSFR_LANES; l++) list[n + l] = j + packed[near].lane[l];
        n += packed[near].n;
    }
    return n;
}

/* Lists the neighbours of all particles of a cell, as far as there is room; *used grows by all that they take. */
static void list_cell(ssfr_solver *solver, size_t cell, size_t *used)
{
    const ssfr_grid_range members = ssfr_grid_cell_at(solver->grid, cell);
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    const int n_ranges = ssfr_grid_near(solver->grid, solver->position + 3 * (size_t)members.begin, ranges);
    uint32_t list[SSFR_MAX_LISTED + 2 * SSFR_LANES];
    for (size_t i = members.begin; i < members.end; i++) {
        size_t n = 0, begin;
        solver->labels[i].crowded = false;
        for (int r = 0; r < n_ranges; r++)
            n = list_range(solver, i, ranges[r], n, list, &solver->labels[i].crowded);
        solver->neighbours[i] = (uint32_t)n;
        while (n % SSFR_LANES) list[n++] = (uint32_t)solver->n;
#pragma omp atomic capture
        {
            begin = *used;
            *used += n;
        }
        solver->list_begin[i] = begin;
        solver->list_end[i] = (uint32_t)n;
        if (n > 0 && begin + n <= solver->listed_capacity) memcpy(solver->listed + begin, list, n * sizeof *list);
    }
}

/* Where a list lies in memory depends on the threads; what it holds does not. */
ssfr_result ssfr_solver_list(ssfr_solver *solver)
{
    ssfr_result result = SSFR_OK;
    for (;;) {
        const size_t n_cells = ssfr_grid_n_cells(solver->grid);
        size_t used = 0;
#pragma omp parallel for schedule(dynamic, 32)
        for (size_t c = 0; c < n_cells; c++) list_cell(solver, c, &used);
        if (used <= solver->listed_capacity) break;
        free(solver->listed);
        solver->listed = NULL;
        solver->listed_capacity = 0;
        SSFR_TRY(ssfr_alloc(&solver->listed, used + used / 16, sizeof *solver->listed, "neighbours"));
        solver->listed_capacity = used + used / 16;
    }
end:
    return result;
}

/* ---- density ----------------------------------------------------------------------------------------------------- */

void ssfr_solver_sum_density(ssfr_solver *solver)
{
#pragma omp parallel for schedule(dynamic, SSFR_PASS_CHUNK)
    for (size_t i = 0; i < solver->n; i++) {
        const uint32_t *list = solver->listed + solver->list_begin[i];
        ssfr_lanes sum = {0};
        float gradient[3];
        for (uint32_t k = 0; k < solver->list_end[i]; k += SSFR_LANES)
            sum += ssfr_kernel_value(&solver->kernel, load_four(solver->x, solver->x[i], list + k).r);
        const float density = solver->kernel.value + ssfr_lanes_sum(sum) +
                              ssfr_solver_boundary(solver, i, solver->x[i], gradient);
        solver->density[i] = (float)SSFR_REST_DENSITY * density;
    }
}

/* ---- the density constraint -------------------------------------------------------------------------------------- */

/* lambda_i = -C_i / (sum_k |grad_k C_i|^2 + eps), eq. 11, where C_i = rho_i / rho0 - 1, eq. 1. The sum of all changes
 * stays at or below 0: particles push each other, but do not pull. */
static float find_multiplier(ssfr_solver *solver, size_t i)
{
    const uint32_t *list = solver->listed + solver->list_begin[i];
    const ssfr_lanes xi = solver->at[i];
    ssfr_lanes density = {0}, squares = {0}, gx = {0}, gy = {0}, gz = {0};
    float g[3];
    for (uint32_t k = 0; k < solver->list_end[i]; k += SSFR_LANES) {
        const four f = load_four(solver->at, xi, list + k);
        const ssfr_lanes slope = ssfr_kernel_slope(&solver->kernel, f.r), along = slope / apart(f.r);
        density += ssfr_kernel_value(&solver->kernel, f.r);
        squares += slope * slope;
        gx += along * f.dx, gy += along * f.dy, gz += along * f.dz;
    }
    const float behind = ssfr_solver_boundary(solver, i, xi, g);
    const ssfr_lanes own = {ssfr_lanes_sum(gx) + g[0], ssfr_lanes_sum(gy) + g[1], ssfr_lanes_sum(gz) + g[2], 0};
    const float rest = solver->rest;
    const float constraint = fminf((solver->kernel.value + ssfr_lanes_sum(density) + behind) / rest - 1, MOST);
    const float all = (ssfr_lanes_sum(squares) + ssfr_lanes_sum(own * own)) / (rest * rest) +
                      (float)solver->setup.params.relaxation * solver->gradients;
    float *total = &solver->labels[i].multiplier;
    const float before = *total;
    *total = fminf(before - solver->stiffness * constraint / fmaxf(all, solver->gradients * FEWEST), 0);
    return *total - before;
}

void ssfr_solver_find_multipliers(ssfr_solver *solver)
{
#pragma omp parallel for schedule(dynamic, SSFR_PASS_CHUNK)
    for (size_t i = 0; i < solver->n; i++) {
        const float change = find_multiplier(solver, i);
        solver->from[i] = solver->at[i];
        solver->from[i][3] = change;
    }
}

/* s_corr = -k (W(r) / W(|delta q|))^n, eq. 13, in units of the multipliers at rest. */
typedef struct tension {
    float k, per_value;
    int n;
} tension;

static inline ssfr_lanes artificial_pressure(const tension *t, ssfr_lanes value)
{
    const ssfr_lanes ratio = value * t->per_value;
    ssfr_lanes power = ratio;
    for (int m = 1; m < t->n; m++) power *= ratio;
    return -t->k * power;
}

/* delta x_i = V sum_j (lambda_i + lambda_j + s_corr) grad W, eq. 14. */
static void correct(ssfr_solver *solver, size_t i, const tension *t)
{
    const uint32_t *list = solver->listed + solver->list_begin[i];
    const ssfr_lanes xi = solver->from[i];
    ssfr_lanes sx = {0}, sy = {0}, sz = {0};
    float g[3];
    for (uint32_t k = 0; k < solver->list_end[i]; k += SSFR_LANES) {
        const four f = load_four(solver->from, xi, list + k);
        ssfr_lanes scale = xi[3] + f.w;
        if (t->k > 0) scale += artificial_pressure(t, ssfr_kernel_value(&solver->kernel, f.r));
        const ssfr_lanes along = scale * ssfr_kernel_slope(&solver->kernel, f.r) / apart(f.r);
        sx += along * f.dx, sy += along * f.dy, sz += along * f.dz;
    }
    ssfr_solver_boundary(solver, i, xi, g);
    const ssfr_lanes change = {ssfr_lanes_sum(sx) + xi[3] * g[0], ssfr_lanes_sum(sy) + xi[3] * g[1],
                               ssfr_lanes_sum(sz) + xi[3] * g[2], 0};
    const ssfr_lanes before = solver->x[i];
    const ssfr_lanes after = ssfr_solver_project(solver, i, before + solver->moved[i] + change);
    const ssfr_lanes free = before + (solver->moved[i] + change);
    solver->moved[i] += change + (after - free);
    solver->at[i] = after;
}

void ssfr_solver_correct(ssfr_solver *solver)
{
    const ssfr_solver_params *p = &solver->setup.params;
    const float dq = (float)p->pressure_dq * solver->kernel.support;
    const tension t = {.k = (float)p->pressure_k * solver->stiffness / solver->gradients,
                       .per_value = 1 / ssfr_kernel_value(&solver->kernel, ssfr_lanes_all(dq))[0],
                       .n = p->pressure_n};
#pragma omp parallel for schedule(dynamic, SSFR_PASS_CHUNK)
    for (size_t i = 0; i < solver->n; i++) correct(solver, i, &t);
}

/* ---- velocity ---------------------------------------------------------------------------------------------------- */

/* omega_i = curl v = sum_j V (v_j - v_i) x grad_j W, eq. 15, where grad_j W = -grad_i W. */
static ssfr_lanes find_vorticity(const ssfr_solver *solver, size_t i)
{
    const uint32_t *list = solver->listed + solver->list_begin[i];
    ssfr_lanes wx = {0}, wy = {0}, wz = {0};
    for (uint32_t k = 0; k < solver->list_end[i]; k += SSFR_LANES) {
        const four f = load_four(solver->x, solver->x[i], list + k);
        const four u = load_four(solver->v, solver->v[i], list + k); /* v_i - v_j */
        const ssfr_lanes along = ssfr_kernel_slope(&solver->kernel, f.r) / apart(f.r);
        wx += along * (u.dy * f.dz - u.dz * f.dy);
        wy += along * (u.dz * f.dx - u.dx * f.dz);
        wz += along * (u.dx * f.dy - u.dy * f.dx);
    }
    return (ssfr_lanes){ssfr_lanes_sum(wx), ssfr_lanes_sum(wy), ssfr_lanes_sum(wz), 0};
}

static float length_of(ssfr_lanes a)
{
    return sqrtf(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* N x omega_i, N = eta / |eta|, eta = grad |omega|: eq. 16 without its epsilon. */
static ssfr_lanes confinement(ssfr_lanes eta, ssfr_lanes omega)
{
    const float length = length_of(eta);
    const ssfr_lanes n = eta / (length > 0 ? length : 1);
    return (ssfr_lanes){n[1] * omega[2] - n[2] * omega[1], n[2] * omega[0] - n[0] * omega[2],
                        n[0] * omega[1] - n[1] * omega[0], 0};
}

/* v_i + c sum_j V (v_j - v_i) W, eq. 17, and the vorticity's part; `push` is epsilon dt. */
static ssfr_lanes smooth(const ssfr_solver *solver, size_t i, float c, float push)
{
    const uint32_t *list = solver->listed + solver->list_begin[i];
    const ssfr_lanes vi = solver->moved[i];
    ssfr_lanes sx = {0}, sy = {0}, sz = {0}, ex = {0}, ey = {0}, ez = {0};
    for (uint32_t k = 0; k < solver->list_end[i]; k += SSFR_LANES) {
        const four f = load_four(solver->x, solver->x[i], list + k);
        const four u = load_four(solver->moved, vi, list + k);
        const ssfr_lanes value = ssfr_kernel_value(&solver->kernel, f.r);
        sx += value * u.dx, sy += value * u.dy, sz += value * u.dz;
        if (push > 0) {
            const ssfr_lanes along = (u.w - vi[3]) * ssfr_kernel_slope(&solver->kernel, f.r) / apart(f.r);
            ex += along * f.dx, ey += along * f.dy, ez += along * f.dz;
        }
    }
    const ssfr_lanes eta = {ssfr_lanes_sum(ex), ssfr_lanes_sum(ey), ssfr_lanes_sum(ez), 0};
    const ssfr_lanes drag = {ssfr_lanes_sum(sx), ssfr_lanes_sum(sy), ssfr_lanes_sum(sz), 0};
    ssfr_lanes v = vi - c * drag;
    if (push > 0) v += push * confinement(eta, solver->from[i]);
    v[3] = 0;
    return v;
}

void ssfr_solver_smooth_velocity(ssfr_solver *solver, double dt)
{
    const ssfr_solver_params *p = &solver->setup.params;
    const float c = (float)(p->viscosity * dt / p->max_step), push = (float)(p->vorticity * dt);
#pragma omp parallel for schedule(dynamic, SSFR_PASS_CHUNK)
    for (size_t i = 0; i < solver->n; i++) {
        solver->moved[i] = solver->v[i]; /* for all to read while v is written */
        if (!(push > 0)) continue;
        solver->from[i] = find_vorticity(solver, i);
        solver->moved[i][3] = length_of(solver->from[i]);
    }
#pragma omp parallel for schedule(dynamic, SSFR_PASS_CHUNK)
    for (size_t i = 0; i < solver->n; i++) solver->v[i] = smooth(solver, i, c, push);
}

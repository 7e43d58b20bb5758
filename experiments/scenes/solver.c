/* SPDX-License-Identifier: GPL-3.0-or-later */
/* solver.c: position based fluids: parameters, creating, and a step from begin to end. */
#include "experiments/scenes/solver_internal.h"

#include "base/param.h"

/* Particles at one place know no direction to part in: they are moved by this, in radii. */
#define JITTER 1e-3

typedef ssfr_solver_params params;

const ssfr_param ssfr_solver_rows[] = {
    SSFR_PARAM_REAL(params, max_step, "s", 1.0 / 120, 1e-6, 1, "longest step"),
    SSFR_PARAM_REAL(params, cfl, "1", 1, 0.01, 100, "radii that the fastest particle may move in a step"),
    SSFR_PARAM_INT(params, iterations, "1", 4, 1, 1000, "of the density constraint, a step"),
    SSFR_PARAM_REAL(params, relaxation, "1", 1, 0, 1000,
                    "epsilon of eq. 11, in units of the constraint's squared gradients at rest"),
    SSFR_PARAM_REAL(params, pressure_k, "1", 0, 0, 1, "k of the artificial pressure, eq. 13"),
    SSFR_PARAM_REAL(params, pressure_dq, "1", 0.2, 0, 0.9, "|delta q| of eq. 13, in supports"),
    SSFR_PARAM_INT(params, pressure_n, "1", 4, 1, 16, "n of eq. 13"),
    SSFR_PARAM_REAL(params, viscosity, "1", 0.01, 0, 1, "c of XSPH, eq. 17, in a step of max_step"),
    SSFR_PARAM_REAL(params, vorticity, "m/s", 0, 0, 100, "epsilon of vorticity confinement, eq. 16"),
    SSFR_PARAM_END,
};

/* ---- creating ----------------------------------------------------------------------------------------------------- */

static ssfr_result check_setup(const ssfr_solver_setup *s)
{
    if (!(s->radius > 0 && isfinite(s->radius) && isfinite(1 / s->radius)))
        return ssfr_fail(SSFR_ERR_VALUE, "solver: radius %g m: expected a positive number", s->radius);
    for (int k = 0; k < 3; k++) {
        if (!isfinite(s->gravity[k]))
            return ssfr_fail(SSFR_ERR_VALUE, "solver: gravity %g m/s^2 along %c is not finite", s->gravity[k], "xyz"[k]);
        if (!(s->lo[k] < s->hi[k] && isfinite(s->lo[k]) && isfinite(s->hi[k])))
            return ssfr_fail(SSFR_ERR_VALUE, "solver: domain from %g to %g m along %c", s->lo[k], s->hi[k], "xyz"[k]);
    }
    for (const ssfr_param *row = ssfr_solver_rows; row->name; row++) {
        const double value = ssfr_param_number(row, &s->params);
        if (!(value >= row->min && value <= row->max))
            return ssfr_fail(SSFR_ERR_VALUE, "solver: %s=%g: expected %g to %g", row->name, value, row->min, row->max);
    }
    return SSFR_OK;
}

/* The sum of the squared gradients of a constraint whose particle stands in a cubic lattice at the rest density. */
static double gradients_at_rest(const ssfr_kernel *kernel, double spacing)
{
    const int reach = (int)((double)kernel->support / spacing);
    double sum = 0;
    for (int z = -reach; z <= reach; z++)
        for (int y = -reach; y <= reach; y++)
            for (int x = -reach; x <= reach; x++) {
                const double r = spacing * sqrt(x * x + y * y + z * z);
                sum += ssfr_square((double)ssfr_kernel_slope(kernel, ssfr_lanes_all((float)r))[0]);
            }
    return sum - ssfr_square((double)ssfr_kernel_slope(kernel, ssfr_lanes_all(0))[0]);
}

ssfr_result ssfr_solver_create(ssfr_solver **out, const ssfr_solver_setup *setup)
{
    ssfr_result result = SSFR_OK;
    ssfr_solver *solver = NULL;
    *out = NULL;
    SSFR_TRY(check_setup(setup));
    SSFR_TRY(ssfr_alloc(&solver, 1, sizeof *solver, "a solver"));
    solver->setup = *setup;
    const double volume = ssfr_particle_mass(setup->radius) / SSFR_REST_DENSITY; /* m^3 */
    solver->kernel = ssfr_kernel_make(SSFR_SUPPORT * setup->radius, volume);
    solver->closest = 0.5 * cbrt(volume);
    solver->gradients = (float)gradients_at_rest(&solver->kernel, cbrt(volume));
    for (int k = 0; k < 3; k++) {
        solver->origin[k] = 0.5 * setup->lo[k] + 0.5 * setup->hi[k];
        solver->lo[k] = setup->lo[k] - solver->origin[k];
        solver->hi[k] = setup->hi[k] - solver->origin[k];
    }
    SSFR_TRY(ssfr_grid_create(&solver->grid));
    SSFR_TRY(ssfr_solver_reserve(solver, 0));
    SSFR_TRY(ssfr_solver_arrange(solver));
    *out = solver;
    solver = NULL;
end:
    ssfr_solver_destroy(&solver);
    return result;
}

void ssfr_solver_destroy(ssfr_solver **solver)
{
    ssfr_solver *s = *solver;
    if (s) {
        free(s->x), free(s->at), free(s->from), free(s->moved), free(s->v);
        free(s->labels), free(s->spare_labels);
        free(s->position), free(s->velocity), free(s->density), free(s->neighbours);
        free(s->list_begin), free(s->list_end), free(s->listed);
        free(s->contacts);
        ssfr_grid_destroy(&s->grid);
    }
    free(s);
    *solver = NULL;
}

/* ---- the step ----------------------------------------------------------------------------------------------------- */

double ssfr_solver_limit(const ssfr_solver *solver)
{
    const ssfr_solver_params *p = &solver->setup.params;
    double fastest = 0; /* squared */
#pragma omp parallel for schedule(static) reduction(max : fastest)
    for (size_t i = 0; i < solver->n; i++) {
        const ssfr_lanes v = solver->v[i];
        const double square = (double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] + (double)v[2] * (double)v[2];
        fastest = square > fastest ? square : fastest;
    }
    return fmin(p->max_step, p->cfl * solver->setup.radius / fmax(sqrt(fastest), 1e-300));
}

/* x* - x = dt (v + dt g): algorithm 1, lines 2 and 3. */
static void predict(ssfr_solver *solver, double dt)
{
    const double *g = solver->setup.gravity;
    const ssfr_lanes change = {(float)(g[0] * dt), (float)(g[1] * dt), (float)(g[2] * dt), 0};
    for (size_t i = 0; i < solver->n; i++) {
        solver->v[i][3] = 0;
        solver->moved[i] = (solver->v[i] + change) * (float)dt;
    }
}

/* A direction that depends on the particle alone. */
static ssfr_lanes jitter(uint32_t id)
{
    const double phi = 2.399963229728653 * id, z = 2 * fmod(0.6180339887498949 * (double)id, 1) - 1;
    const double across = sqrt(1 - z * z);
    return (ssfr_lanes){(float)(across * cos(phi)), (float)z, (float)(across * sin(phi)), 0};
}

/* Where the iterations begin; contacts may have put x elsewhere. */
static void begin_iterations(ssfr_solver *solver)
{
    const float apart = (float)(JITTER * solver->setup.radius);
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < solver->n; i++) {
        if (solver->labels[i].crowded) solver->moved[i] += apart * jitter(solver->labels[i].id);
        const ssfr_lanes to = solver->x[i] + solver->moved[i];
        solver->at[i] = ssfr_solver_project(solver, i, to);
        solver->moved[i] += solver->at[i] - to;
        solver->labels[i].multiplier = 0;
    }
}

/* v = (x* - x) / dt: algorithm 1, lines 21 and 23. */
static ssfr_result arrive(ssfr_solver *solver, double dt)
{
    size_t bad = solver->n;
    for (size_t i = 0; i < solver->n; i++) {
        solver->v[i] = solver->moved[i] / (float)dt;
        solver->x[i] += solver->moved[i];
        float sum = 0; /* not finite when one of them is not */
        for (int k = 0; k < 3; k++) sum += 0 * solver->v[i][k] + 0 * solver->x[i][k];
        if (!(sum == 0) && (bad == solver->n || solver->labels[i].id < solver->labels[bad].id)) bad = i;
    }
    if (bad == solver->n) return SSFR_OK;
    const ssfr_lanes x = solver->x[bad], v = solver->v[bad];
    return ssfr_fail(SSFR_ERR_VALUE, "particle %u: position (%g, %g, %g), velocity (%g, %g, %g) after %g s",
                     solver->labels[bad].id, (double)x[0], (double)x[1], (double)x[2], (double)v[0], (double)v[1],
                     (double)v[2], solver->time);
}

ssfr_result ssfr_solver_step(ssfr_solver *solver, double dt, int n_obstacles, const ssfr_obstacle *obstacles)
{
    ssfr_result result = SSFR_OK;
    if (!(dt >= 0 && isfinite(dt))) return ssfr_fail(SSFR_ERR_VALUE, "solver: a step of %g s", dt);
    if (n_obstacles > SSFR_MAX_OBSTACLES)
        return ssfr_fail(SSFR_ERR_VALUE, "solver: %d obstacles, at most %d", n_obstacles, SSFR_MAX_OBSTACLES);
    if (solver->stale) SSFR_TRY(ssfr_solver_arrange(solver));
    if (!(dt > 0)) goto end;
    predict(solver, dt);
    SSFR_TRY(ssfr_solver_find_contacts(solver, n_obstacles, obstacles));
    begin_iterations(solver);
    for (int i = 0; i < solver->setup.params.iterations; i++) {
        ssfr_solver_find_multipliers(solver);
        ssfr_solver_correct(solver);
    }
    ssfr_solver_finish_contacts(solver, dt, obstacles);
    solver->time += dt;
    SSFR_TRY(arrive(solver, dt));
    ssfr_solver_drop_left(solver);
    SSFR_TRY(ssfr_solver_arrange(solver));
    ssfr_solver_smooth_velocity(solver, dt);
    ssfr_solver_publish(solver);
end:
    return result;
}

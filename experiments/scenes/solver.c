/* SPDX-License-Identifier: GPL-3.0-or-later */
/* solver.c: position based fluids: parameters, creating, and a step from begin to end. */
#include "experiments/scenes/solver_internal.h"

#include "base/param.h"

/* Particles at one place know no direction to part in: they are moved by this, in radii. */
#define JITTER 1e-2
#define JITTER_RATE 1e3 /* 1/s, of its directions: another one in every step */

/* Radii that a wave on fluid of this depth may move in a step. The constraint's error at the bottom, which is what
 * four iterations leave of g dt^2, depends on nothing else: here it is about 2.5 %. */
#define WAVE_CFL 0.6

#define FORGETTING 0.1 /* s, long against steps and short against what one sees */

/* No function of the C library whose last digit may depend on the machine (exp, pow, sin) stands in a step: the same
 * scene has the same bits on all machines. */

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
    SSFR_PARAM_REAL(params, viscosity, "1", 0.02, 0, 1, "c of XSPH, eq. 17, in a step of max_step"),
    SSFR_PARAM_REAL(params, vorticity, "m/s", 0, 0, 100, "epsilon of vorticity confinement, eq. 16"),
    SSFR_PARAM_END,
};

#define MAX_DOMAIN 4e6 /* radii along an axis, which the grid can tell apart */

const char *const ssfr_solver_stage_words[] = {"predict", "multipliers", "correct", "arrive", "sort",
                                               "list",    "density",     "smooth",  NULL};

/* ---- creating ---------------------------------------------------------------------------------------------------- */

static ssfr_result check_setup(const ssfr_solver_setup *s)
{
    if (!(s->radius > 0 && isfinite(s->radius) && isfinite(1 / s->radius)))
        return ssfr_fail(SSFR_ERR_VALUE, "solver: radius %g m: expected a positive number", s->radius);
    for (int k = 0; k < 3; k++) {
        if (!isfinite(s->gravity[k]))
            return ssfr_fail(SSFR_ERR_VALUE, "solver: gravity %g m/s^2 along %c is not finite", s->gravity[k],
                             "xyz"[k]);
        if (!(s->lo[k] < s->hi[k] && isfinite(s->lo[k]) && isfinite(s->hi[k])))
            return ssfr_fail(SSFR_ERR_VALUE, "solver: domain from %g to %g m along %c", s->lo[k], s->hi[k], "xyz"[k]);
        if (!(s->hi[k] - s->lo[k] < MAX_DOMAIN * s->radius))
            return ssfr_fail(SSFR_ERR_VALUE, "solver: a domain of %g m along %c: at most %g radii", s->hi[k] - s->lo[k],
                             "xyz"[k], MAX_DOMAIN);
    }
    for (const ssfr_param *row = ssfr_solver_rows; row->name; row++) {
        const double value = ssfr_param_number(row, &s->params);
        if (!(value >= row->min && value <= row->max))
            return ssfr_fail(SSFR_ERR_VALUE, "solver: %s=%g: expected %g to %g", row->name, value, row->min, row->max);
    }
    return SSFR_OK;
}

/* What the sums over neighbours give in the cubic lattice that pools and emitters are filled with: its density is what
 * the constraint asks for, so that nothing jumps apart when it is let go. A wall's surface stands where it takes the
 * place of the lattice's other half, with particles half a spacing off it. */
static void measure_rest(ssfr_solver *solver, double spacing)
{
    const ssfr_kernel *kernel = &solver->kernel;
    const int reach = (int)((double)kernel->support / spacing);
    double density = 0, gradients = 0, behind = 0;
    for (int z = -reach; z <= reach; z++)
        for (int y = -reach; y <= reach; y++)
            for (int x = -reach; x <= reach; x++) {
                const ssfr_lanes r = ssfr_lanes_all((float)(spacing * sqrt(x * x + y * y + z * z)));
                density += (double)ssfr_kernel_value(kernel, r)[0];
                if (y < 0) behind += (double)ssfr_kernel_value(kernel, r)[0];
                if (x || y || z) gradients += ssfr_square((double)ssfr_kernel_slope(kernel, r)[0]);
            }
    solver->rest = (float)density;
    solver->gradients = (float)(gradients / ssfr_square(density));
    solver->closest = 0.5 * spacing;
    double low = 0, high = 1; /* supports, between which the integral falls below what is lacking */
    while (high - low > 1e-7) {
        const double middle = 0.5 * (low + high);
        float slope;
        *((double)ssfr_kernel_behind((float)middle, &slope) > behind ? &low : &high) = middle;
    }
    solver->wall = (float)(high * (double)kernel->support - solver->closest);
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
    measure_rest(solver, cbrt(volume));
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
        for (int k = 0; k < 3; k++) free(s->axes[k]);
        free(s->labels), free(s->spare_labels);
        free(s->position), free(s->velocity), free(s->density), free(s->neighbours);
        free(s->list_begin), free(s->list_end), free(s->listed);
        free(s->contacts);
        ssfr_grid_destroy(&s->grid);
    }
    free(s);
    *solver = NULL;
}

/* ---- the step ---------------------------------------------------------------------------------------------------- */

/* Speed of the longest waves on the fluid, sqrt(|g| depth), m/s. The depth is taken from where the fluid is on average:
 * for a pool at rest it is exact, and what is in the air only makes it larger. */
static double wave_speed(const ssfr_solver *solver)
{
    const double *g = solver->setup.gravity, size = sqrt(ssfr_dot(g, g));
    double sum = 0, lowest = INFINITY; /* heights times |g|, m^2/s^2 */
    for (size_t i = 0; i < solver->n; i++) { /* by one thread: sums in another order have other bits */
        const ssfr_lanes x = solver->x[i];
        const double height = -(g[0] * (double)x[0] + g[1] * (double)x[1] + g[2] * (double)x[2]);
        sum += height;
        lowest = fmin(lowest, height);
    }
    return solver->n && size > 0 ? sqrt(2 * fmax(sum / (double)solver->n - lowest, 0)) : 0;
}

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
    const double speed = fmax(sqrt(fastest) / p->cfl, wave_speed(solver) / WAVE_CFL);
    return fmin(p->max_step, solver->setup.radius / fmax(speed, 1e-300));
}

/* What a few iterations leave of the constraint's error at rest grows with dt^2. A shorter step after longer ones would
 * throw out at once what those had left, at a speed of error over dt. So multipliers are scaled as if the step were
 * as long as those before it, whose length is forgotten slowly. */
static void soften(ssfr_solver *solver, double dt)
{
    solver->felt_step = fmax(dt, solver->felt_step / (1 + dt / FORGETTING));
    solver->stiffness = (float)ssfr_square(dt / solver->felt_step);
}

/* x* - x = dt (v + dt g): algorithm 1, lines 2 and 3. */
static void predict(ssfr_solver *solver, double dt)
{
    const double *g = solver->setup.gravity;
    const ssfr_lanes change = {(float)(g[0] * dt), (float)(g[1] * dt), (float)(g[2] * dt), 0};
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < solver->n; i++) solver->moved[i] = (solver->v[i] + change) * (float)dt;
}

/* A place in the cube [-1, 1]^3 that depends on the particle and the time alone: digits of multiples of numbers that
 * spread evenly (Roberts 2018, R_3). It changes with time, because in a corner of walls not every direction helps. */
static ssfr_lanes jitter(uint32_t id, double time)
{
    static const double step[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    ssfr_lanes out = {0};
    for (int k = 0; k < 3; k++) {
        const double value = step[k] * ((double)id + JITTER_RATE * time);
        out[k] = (float)(2 * (value - floor(value)) - 1);
    }
    return out;
}

/* Where the iterations begin; contacts may have put x elsewhere. */
static void begin_iterations(ssfr_solver *solver)
{
    const float apart = (float)(JITTER * solver->setup.radius);
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < solver->n; i++) {
        if (solver->labels[i].crowded) solver->moved[i] += apart * jitter(solver->labels[i].id, solver->time);
        const ssfr_lanes to = solver->x[i] + solver->moved[i];
        solver->at[i] = ssfr_solver_project(solver, i, to);
        solver->moved[i] += solver->at[i] - to;
        solver->labels[i].multiplier = 0;
    }
}

static bool is_finite(const ssfr_solver *solver, size_t i)
{
    float sum = 0;
    for (int k = 0; k < 3; k++) sum += 0 * solver->v[i][k] + 0 * solver->x[i][k];
    return sum == 0;
}

/* The error line for the first-born of the particles that went wrong: which one that is depends on no order. */
static ssfr_result refuse_nonfinite(const ssfr_solver *solver)
{
    size_t bad = solver->n;
    for (size_t i = 0; i < solver->n; i++)
        if (!is_finite(solver, i) && (bad == solver->n || solver->labels[i].id < solver->labels[bad].id)) bad = i;
    const ssfr_lanes x = solver->x[bad], v = solver->v[bad];
    return ssfr_fail(SSFR_ERR_VALUE, "particle %u after %g s: position (%g, %g, %g) m, velocity (%g, %g, %g) m/s",
                     solver->labels[bad].id, solver->time, solver->origin[0] + (double)x[0],
                     solver->origin[1] + (double)x[1], solver->origin[2] + (double)x[2], (double)v[0], (double)v[1],
                     (double)v[2]);
}

/* v = (x* - x) / dt, x = x*: algorithm 1, lines 21 and 23. */
static ssfr_result arrive(ssfr_solver *solver, double dt)
{
    bool finite = true;
#pragma omp parallel for schedule(static) reduction(&& : finite)
    for (size_t i = 0; i < solver->n; i++) {
        solver->v[i] = solver->moved[i] / (float)dt;
        solver->x[i] += solver->moved[i];
        finite = finite && is_finite(solver, i);
    }
    return finite ? SSFR_OK : refuse_nonfinite(solver);
}

ssfr_result ssfr_solver_step(ssfr_solver *solver, double dt, int n_obstacles, const ssfr_obstacle *obstacles)
{
    ssfr_result result = SSFR_OK;
    ssfr_obstacle near[SSFR_MAX_OBSTACLES]; /* relative to the solver's origin */
    if (!(dt >= 0 && isfinite(dt))) return ssfr_fail(SSFR_ERR_VALUE, "solver: a step of %g s", dt);
    if (n_obstacles > SSFR_MAX_OBSTACLES)
        return ssfr_fail(SSFR_ERR_VALUE, "solver: %d obstacles, at most %d", n_obstacles, SSFR_MAX_OBSTACLES);
    if (!(dt > 0)) goto end;
    memset(solver->seconds, 0, sizeof solver->seconds);
    solver->lap = ssfr_clock();
    if (solver->stale) SSFR_TRY(ssfr_solver_sort(solver));
    solver->stale = false; /* densities are summed at the end */
    soften(solver, dt);
    predict(solver, dt);
    for (int o = 0; o < n_obstacles; o++)
        near[o] = (ssfr_obstacle){ssfr_solver_local(solver, &obstacles[o].before),
                                  ssfr_solver_local(solver, &obstacles[o].now), obstacles[o].friction};
    SSFR_TRY(ssfr_solver_find_contacts(solver, true, n_obstacles, near));
    begin_iterations(solver);
    ssfr_solver_lap(solver, SSFR_SOLVER_PREDICT);
    for (int i = 0; i < solver->setup.params.iterations; i++) {
        ssfr_solver_find_multipliers(solver);
        ssfr_solver_lap(solver, SSFR_SOLVER_MULTIPLIERS);
        ssfr_solver_correct(solver);
        ssfr_solver_lap(solver, SSFR_SOLVER_CORRECT);
    }
    ssfr_solver_finish_contacts(solver, dt, near);
    solver->time += dt;
    SSFR_TRY(arrive(solver, dt));
    ssfr_solver_drop_left(solver);
    ssfr_solver_lap(solver, SSFR_SOLVER_ARRIVE);
    SSFR_TRY(ssfr_solver_arrange(solver));
    ssfr_solver_smooth_velocity(solver, dt);
    ssfr_solver_publish(solver);
    ssfr_solver_lap(solver, SSFR_SOLVER_SMOOTH);
end:
    return result;
}

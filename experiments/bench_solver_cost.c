/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_solver_cost.c: how long steps of the solver and of its foam take, stage by stage, and what memory they hold. */
#include "experiments/bench_solver.h"
#include "experiments/measure.h"
#include "experiments/scenes/foam.h"

#include "base/param.h"

#include <omp.h>

enum {
    MAX_SAMPLES = 2000,
    MIN_WINDOW = 10,  /* steps */
    STRIDE = 1 + SSFR_N_SOLVER_STAGES, /* of samples: the step, then its stages */
    SETTLING = 20,    /* steps of a pool, in which its lattice gives way to walls and surface */
    FOAM_LAYERS = 32, /* 64 K particles of fluid: what foam is measured beside */
    MAX_SPLASH = 51,  /* layers: a dam break of more takes minutes until it splashes */
};
static const int sizes[] = {8, 13, 20, 32, 51, 80}; /* layers: 1 K, 4 K, 16 K, 64 K, 256 K, 1 M particles */
static const int quick_sizes[] = {5, 8};
static const double splash = 0.3;    /* s, when the dam break's wave runs up the wall */
static const double window = 0.1;    /* s, simulated: longer and it would no longer be the splash */
static const size_t diffuse[] = {1, 100000, 200000}, quick_diffuse[] = {1, 1000};

typedef struct samples { /* ms */
    size_t n;
    double values[MAX_SAMPLES * STRIDE], work[2 * MAX_SAMPLES];
} samples;

typedef struct cost {
    ssfr_tank_kind kind;
    int layers;
} cost;

static size_t particles_of(const cost *c)
{
    return 2 * (size_t)c->layers * (size_t)c->layers * (size_t)c->layers;
}

/* 1, 2, 4, ... up to all threads; 0 past the end. */
static int threads_after(const ssfr_bench *bench, int threads)
{
    return threads >= bench->max_threads ? 0 : ssfr_min_int(2 * threads, bench->max_threads);
}

static void name(ssfr_bench_key *key, const cost *c, int threads, const char *part, size_t n_diffuse)
{
    ssfr_bench_key_set(key, 0, "%s", ssfr_tank_words[c->kind]);
    ssfr_bench_key_set(key, 1, "%zu", particles_of(c));
    ssfr_bench_key_set(key, 2, "%d", threads);
    ssfr_bench_key_set(key, 3, "%s", part);
    ssfr_bench_key_set(key, 4, "%zu", n_diffuse);
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

/* What is said of a step as a whole; NaN in the rows of its stages. */
typedef struct whole {
    double bytes, neighbours; /* a particle */
    double dt, real_time;     /* s; mean step over median time */
} whole;

static const whole no_whole = {NAN, NAN, NAN, NAN};

static ssfr_result add_row(ssfr_bench *bench, const ssfr_bench_key *key, const ssfr_tank *tank, const ssfr_timing *t,
                           double share, const whole *w)
{
    const double numbers[] = {tank->radius, t->min, t->median, t->mad, (double)t->n, (double)t->outliers, share,
                              w->bytes, w->neighbours, w->dt, 1 / w->dt, w->real_time};
    return ssfr_ledger_add(&bench->tables[SSFR_BENCH_COST], key->cells, "ok", numbers);
}

static ssfr_result add_rows(ssfr_bench *bench, const cost *c, const ssfr_tank *tank, int threads, samples *s,
                            const whole *w)
{
    ssfr_result result = SSFR_OK;
    ssfr_bench_key key;
    const ssfr_timing step = ssfr_timing_of(s->values, STRIDE, s->n, s->work);
    for (int i = 0; i < SSFR_N_SOLVER_STAGES; i++) {
        const ssfr_timing stage = ssfr_timing_of(s->values + 1 + i, STRIDE, s->n, s->work);
        name(&key, c, threads, ssfr_solver_stage_words[i], 0);
        SSFR_TRY(add_row(bench, &key, tank, &stage, stage.median / step.median, &no_whole));
    }
    name(&key, c, threads, "(step)", 0);
    SSFR_TRY(add_row(bench, &key, tank, &step, 1, w));
end:
    return result;
}

/* ---- steps ------------------------------------------------------------------------------------------------------- */

static ssfr_result count_neighbours(const ssfr_tank *tank, double *out)
{
    ssfr_result result = SSFR_OK;
    ssfr_particles *particles = NULL;
    double sum = 0;
    SSFR_TRY(ssfr_solver_export(tank->solver, &particles));
    for (size_t i = 0; i < particles->n; i++) sum += particles->neighbours[i];
    *out = sum / (double)particles->n;
end:
    ssfr_particles_destroy(&particles);
    return result;
}

/* Choosing a step's length is part of the step. */
static ssfr_result time_step(ssfr_tank *tank, double *row)
{
    const double begun = ssfr_clock();
    const ssfr_result result = ssfr_tank_step(tank, INFINITY);
    row[0] = 1e3 * (ssfr_clock() - begun);
    for (int i = 0; i < SSFR_N_SOLVER_STAGES; i++) row[1 + i] = 1e3 * ssfr_solver_seconds(tank->solver)[i];
    return result;
}

/* From the state that is kept: every number of threads has the same work to do. The first step wakes threads and is not
 * timed. until: the clock's, after which no more steps are needed than the fewest. */
static ssfr_result time_window(ssfr_bench *bench, ssfr_tank *tank, FILE *kept, double until, samples *s,
                               whole *sum)
{
    ssfr_result result = SSFR_OK;
    rewind(kept);
    SSFR_TRY(ssfr_solver_read(tank->solver, kept));
    SSFR_TRY(ssfr_tank_step(tank, INFINITY));
    const double time = tank->time;
    for (int i = 0; s->n < MAX_SAMPLES; i++) {
        if (i >= MIN_WINDOW && (tank->time - time >= window || ssfr_clock() >= until)) break;
        SSFR_TRY(time_step(tank, s->values + s->n++ * STRIDE));
        SSFR_TRY(ssfr_bench_tick(bench, 0, 0));
    }
    sum->dt += tank->time - time;
end:
    return result;
}

static ssfr_result time_steps(ssfr_bench *bench, const cost *c, ssfr_tank *tank, FILE *kept, int threads, samples *s)
{
    ssfr_result result = SSFR_OK;
    const ssfr_measure_options m = ssfr_measure_defaults(bench->quick);
    whole w = {0};
    omp_set_num_threads(threads);
    s->n = 0;
    const double until = ssfr_clock() + m.min_seconds;
    do
        SSFR_TRY(time_window(bench, tank, kept, until, s, &w));
    while (s->n < MAX_SAMPLES && ssfr_clock() < until);
    w.dt /= (double)s->n;
    w.real_time = 1e3 * w.dt / ssfr_timing_of(s->values, STRIDE, s->n, s->work).median;
    w.bytes = (double)ssfr_solver_bytes(tank->solver) / (double)tank->n;
    SSFR_TRY(count_neighbours(tank, &w.neighbours));
    SSFR_TRY(add_rows(bench, c, tank, threads, s, &w));
end:
    return result;
}

/* A pool some steps old, or a dam break at its splash. */
static ssfr_result prepare(ssfr_bench *bench, const cost *c, ssfr_tank *tank, double expected)
{
    ssfr_result result = SSFR_OK;
    omp_set_num_threads(bench->max_threads);
    while (c->kind == SSFR_TANK_POOL ? tank->steps < SETTLING : tank->time < splash) {
        SSFR_TRY(ssfr_tank_step(tank, c->kind == SSFR_TANK_POOL ? INFINITY : splash));
        SSFR_TRY(ssfr_bench_tick(bench, expected, 0.5 * tank->time / splash));
    }
end:
    return result;
}

/* ---- foam -------------------------------------------------------------------------------------------------------- */

/* Within a support of the fluid's particles, drawn by chance: bubbles inside, foam and spray at the surface. As many as
 * there may be, so that none is born; none lives so short that it would end. */
static ssfr_result scatter(const ssfr_tank *tank, size_t n, ssfr_foam **out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_fluid fluid = ssfr_solver_fluid(tank->solver);
    ssfr_foam_params params;
    double *positions = NULL;
    float *velocities = NULL, *lifetimes = NULL;
    uint64_t state = 1;
    ssfr_params_default(ssfr_foam_rows, &params);
    params.max_particles = (int)n;
    SSFR_TRY(ssfr_foam_create(out, &params, (double[3]){0, -tank->gravity, 0}, 1));
    SSFR_TRY(ssfr_alloc(&positions, n, 3 * sizeof *positions, "diffuse particles"));
    SSFR_TRY(ssfr_alloc(&velocities, n, 3 * sizeof *velocities, "diffuse particles"));
    SSFR_TRY(ssfr_alloc(&lifetimes, n, sizeof *lifetimes, "diffuse particles"));
    for (size_t i = 0; i < n; i++) {
        double chance[4]; /* Knuth's generator of MMIX: its high bits are good enough to scatter by */
        for (int k = 0; k < 4; k++) {
            state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            chance[k] = ldexp((double)(state >> 11), -53);
        }
        const size_t j = (size_t)(chance[3] * (double)fluid.n);
        for (size_t k = 0; k < 3; k++) {
            const double off = SSFR_SUPPORT * tank->radius * (2 * chance[k] - 1);
            positions[3 * i + k] = fluid.origin[k] + (double)fluid.position[3 * j + k] + off;
            velocities[3 * i + k] = fluid.velocity[3 * j + k];
        }
        lifetimes[i] = 100; /* s */
    }
    SSFR_TRY(ssfr_foam_add(*out, n, positions, velocities, lifetimes));
end:
    free(positions);
    free(velocities);
    free(lifetimes);
    return result;
}

static ssfr_result time_foam(ssfr_bench *bench, const cost *c, const ssfr_tank *tank, int threads, size_t n,
                             samples *s)
{
    ssfr_result result = SSFR_OK;
    const ssfr_measure_options m = ssfr_measure_defaults(bench->quick);
    const ssfr_fluid fluid = ssfr_solver_fluid(tank->solver);
    const double dt = ssfr_solver_limit(tank->solver);
    ssfr_foam *foam = NULL;
    ssfr_bench_key key;
    omp_set_num_threads(threads);
    s->n = 0;
    SSFR_TRY(scatter(tank, n, &foam));
    SSFR_TRY(ssfr_foam_step(foam, &fluid, dt, 0, NULL)); /* allocates */
    const double begun = ssfr_clock();
    double now = begun;
    while (s->n < MAX_SAMPLES && (s->n < m.min_runs || now - begun < m.min_seconds)) {
        const double before = now;
        SSFR_TRY(ssfr_foam_step(foam, &fluid, dt, 0, NULL));
        now = ssfr_clock();
        s->values[s->n++] = 1e3 * (now - before);
        SSFR_TRY(ssfr_bench_tick(bench, 0, 0));
    }
    const ssfr_timing t = ssfr_timing_of(s->values, 1, s->n, s->work);
    name(&key, c, threads, "(foam)", n);
    SSFR_TRY(add_row(bench, &key, tank, &t, NAN, &no_whole));
end:
    ssfr_foam_destroy(&foam);
    return result;
}

static ssfr_result time_foams(ssfr_bench *bench, const cost *c, const ssfr_tank *tank, samples *s)
{
    ssfr_result result = SSFR_OK;
    const size_t *counts = bench->quick ? quick_diffuse : diffuse;
    const size_t n = bench->quick ? SSFR_COUNT(quick_diffuse) : SSFR_COUNT(diffuse);
    for (int threads = 1; threads; threads = threads_after(bench, threads))
        for (size_t i = 0; i < n; i++) SSFR_TRY(time_foam(bench, c, tank, threads, counts[i], s));
end:
    return result;
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

static bool has_foam(const ssfr_bench *bench, const cost *c)
{
    return c->kind == SSFR_TANK_DAM_BREAK && c->layers == (bench->quick ? quick_sizes[0] : FOAM_LAYERS);
}

static ssfr_result run(ssfr_bench *bench, const void *what, double expected)
{
    ssfr_result result = SSFR_OK;
    const cost *c = what;
    ssfr_tank *tank = NULL;
    samples *s = NULL;
    FILE *kept = NULL;
    SSFR_TRY(ssfr_alloc(&s, 1, sizeof *s, "samples"));
    SSFR_TRY(ssfr_tank_create(&tank, c->kind, c->layers, NULL));
    SSFR_TRY(prepare(bench, c, tank, expected));
    kept = tmpfile();
    if (!kept) {
        result = ssfr_fail(SSFR_ERR_IO, "no temporary file for the state of %zu particles", tank->n);
        goto end;
    }
    SSFR_TRY(ssfr_solver_write(tank->solver, kept));
    if (has_foam(bench, c)) SSFR_TRY(time_foams(bench, c, tank, s));
    for (int threads = 1; threads; threads = threads_after(bench, threads))
        SSFR_TRY(time_steps(bench, c, tank, kept, threads, s));
end:
    omp_set_num_threads(bench->max_threads);
    if (kept) fclose(kept);
    ssfr_tank_destroy(&tank);
    free(s);
    return result;
}

/* s. Steps of the dam break are about a radius at 5 m/s long. */
static double expect(const ssfr_bench *bench, const cost *c)
{
    const double step = ssfr_bench_pace * (double)particles_of(c), dt = 0.27 / c->layers / 5;
    const ssfr_measure_options m = ssfr_measure_defaults(bench->quick);
    double sum = step / bench->max_threads * (c->kind == SSFR_TANK_POOL ? SETTLING : splash / dt);
    for (int threads = 1; threads; threads = threads_after(bench, threads))
        sum += fmax(m.min_seconds, (double)(m.min_runs + 1) * step / threads);
    return sum;
}

ssfr_result ssfr_bench_cost(ssfr_bench *bench)
{
    ssfr_result result = SSFR_OK;
    const int *layers = bench->quick ? quick_sizes : sizes;
    const size_t n = bench->quick ? SSFR_COUNT(quick_sizes) : SSFR_COUNT(sizes);
    for (size_t i = 0; i < n; i++)
        for (int kind = SSFR_TANK_POOL; kind <= SSFR_TANK_DAM_BREAK; kind++) {
            const cost c = {(ssfr_tank_kind)kind, layers[i]};
            ssfr_bench_key last;
            if (particles_of(&c) > bench->max_particles) continue;
            if (kind == SSFR_TANK_DAM_BREAK && layers[i] > MAX_SPLASH) continue;
            name(&last, &c, bench->max_threads, "(step)", 0);
            SSFR_TRY(ssfr_bench_visit(bench, run, &c, expect(bench, &c), SSFR_BENCH_COST, last.cells));
        }
end:
    return result;
}

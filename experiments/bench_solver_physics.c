/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_solver_physics.c: how dense, how voluminous, how still the solver's water is, and how it falls. */
#include "experiments/bench_solver.h"

#include "base/param.h"

static const int iterations[] = {1, 2, 4, 8, 16}, quick_iterations[] = {1, 4};
enum { LAYERS = 16, QUICK_LAYERS = 6 }; /* 8 K, 432 particles */
static const double duration = 5, quick_duration = 0.3; /* s */
static const double sample_rate = 30;                   /* 1/s */
static const double depth = 0.5;                        /* m, of the tank's water at rest */

/* Parts of the duration that rows are made of. */
static const struct phase {
    ssfr_tank_kind kind;
    const char *name;
    double from, to; /* shares of the duration */
} phases[] = {
    {SSFR_TANK_POOL, "rest", 0, 1},
    {SSFR_TANK_DAM_BREAK, "motion", 0.02, 0.3}, /* the wave is back from the wall */
    {SSFR_TANK_DAM_BREAK, "settled", 0.8, 1},
};

typedef struct physics {
    ssfr_tank_kind kind;
    int iterations;
} physics;

typedef struct moment {
    double time; /* s */
    long steps;  /* so far */
    ssfr_tank_state state;
} moment;

typedef struct course { /* of a simulation */
    const ssfr_tank *tank;
    double duration;
    size_t n;
    moment *moments;
} course;

/* ---- simulating -------------------------------------------------------------------------------------------------- */

static ssfr_result simulate(ssfr_bench *bench, ssfr_tank *tank, course *c, double expected)
{
    ssfr_result result = SSFR_OK;
    const size_t n = (size_t)(c->duration * sample_rate + 0.5);
    SSFR_TRY(ssfr_alloc(&c->moments, n + 1, sizeof *c->moments, "a course"));
    for (; c->n <= n; c->n++) {
        moment *m = &c->moments[c->n];
        m->time = (double)c->n / sample_rate;
        while (tank->time < m->time) {
            SSFR_TRY(ssfr_tank_step(tank, m->time));
            SSFR_TRY(ssfr_bench_tick(bench, expected, tank->time / c->duration));
        }
        m->steps = tank->steps;
        SSFR_TRY(ssfr_tank_measure(tank, &m->state));
    }
end:
    return result;
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

static ssfr_result add_series(ssfr_bench *bench, const physics *p, const course *c)
{
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < c->n; i++) {
        const moment *m = &c->moments[i];
        const ssfr_tank_state *s = &m->state;
        const double numbers[] = {s->volume / c->moments[0].state.volume - 1, s->surface, s->centre, s->speed_rms,
                                  s->speed_max, s->energy, (double)s->interior / (double)c->tank->n,
                                  s->density_mean, s->density_rms, s->density_max, (double)m->steps};
        ssfr_bench_key key;
        ssfr_bench_key_set(&key, 0, "%s", ssfr_tank_words[p->kind]);
        ssfr_bench_key_set(&key, 1, "%d", p->iterations);
        ssfr_bench_key_set(&key, 2, "%.4f", m->time);
        SSFR_TRY(ssfr_ledger_add(&bench->tables[SSFR_BENCH_SERIES], key.cells, "ok", numbers));
    }
end:
    return result;
}

typedef struct summary { /* over the moments of a phase */
    size_t n;
    double interior; /* particles, summed; what divides the sums over them */
    ssfr_tank_state sum; /* sums of values and of squares, or greatest */
} summary;

static void add_moment(summary *s, const ssfr_tank_state *m)
{
    ssfr_tank_state *sum = &s->sum;
    const double n = (double)m->interior;
    s->n++;
    sum->volume += m->volume;
    sum->surface += m->surface;
    sum->centre += m->centre;
    sum->speed_rms += ssfr_square(m->speed_rms);
    sum->speed_max = fmax(sum->speed_max, m->speed_max);
    if (m->interior == 0) return;
    s->interior += n;
    sum->density_mean += n * m->density_mean;
    sum->density_rms += n * ssfr_square(m->density_rms);
    sum->compression_rms += n * ssfr_square(m->compression_rms);
    sum->density_max = fmax(sum->density_max, m->density_max);
    sum->compression_max = fmax(sum->compression_max, m->compression_max);
}

static void name(ssfr_bench_key *key, const physics *p, const struct phase *phase)
{
    ssfr_bench_key_set(key, 0, "%s", ssfr_tank_words[p->kind]);
    ssfr_bench_key_set(key, 1, "%s", phase->name);
    ssfr_bench_key_set(key, 2, "%d", p->iterations);
}

/* Heights say nothing of water that is in motion. */
static ssfr_result add_phase(ssfr_bench *bench, const physics *p, const struct phase *phase, const course *c)
{
    const double from = phase->from * c->duration, to = phase->to * c->duration;
    const bool still = strcmp(phase->name, "motion") != 0;
    summary s = {0};
    ssfr_bench_key key;
    for (size_t i = 0; i < c->n; i++)
        if (c->moments[i].time >= from - 1e-9 && c->moments[i].time <= to + 1e-9) add_moment(&s, &c->moments[i].state);
    const double n = (double)s.n, inside = s.interior > 0 ? s.interior : NAN;
    const double numbers[] = {(double)c->tank->n,
                              c->tank->radius,
                              from,
                              to,
                              s.interior / n / (double)c->tank->n,
                              s.sum.density_mean / inside,
                              sqrt(s.sum.density_rms / inside),
                              s.interior > 0 ? s.sum.density_max : NAN,
                              sqrt(s.sum.compression_rms / inside),
                              s.interior > 0 ? s.sum.compression_max : NAN,
                              s.sum.volume / n / c->moments[0].state.volume - 1,
                              still ? s.sum.surface / n / depth - 1 : NAN,
                              still ? 2 * s.sum.centre / n / depth - 1 : NAN,
                              sqrt(s.sum.speed_rms / n),
                              s.sum.speed_max,
                              (double)c->moments[c->n - 1].steps / c->duration};
    name(&key, p, phase);
    return ssfr_ledger_add(&bench->tables[SSFR_BENCH_PHYSICS], key.cells, "ok", numbers);
}

static ssfr_result run(ssfr_bench *bench, const void *what, double expected)
{
    ssfr_result result = SSFR_OK;
    const physics *p = what;
    ssfr_solver_params params;
    ssfr_tank *tank = NULL;
    course c = {.duration = bench->quick ? quick_duration : duration};
    ssfr_params_default(ssfr_solver_rows, &params);
    params.iterations = p->iterations;
    SSFR_TRY(ssfr_tank_create(&tank, p->kind, bench->quick ? QUICK_LAYERS : LAYERS, &params));
    c.tank = tank;
    SSFR_TRY(simulate(bench, tank, &c, expected));
    SSFR_TRY(add_series(bench, p, &c));
    for (size_t i = 0; i < SSFR_COUNT(phases); i++)
        if (phases[i].kind == p->kind) SSFR_TRY(add_phase(bench, p, &phases[i], &c));
end:
    free(c.moments);
    ssfr_tank_destroy(&tank);
    return result;
}

static const struct phase *last_phase(ssfr_tank_kind kind)
{
    const struct phase *last = NULL;
    for (size_t i = 0; i < SSFR_COUNT(phases); i++)
        if (phases[i].kind == kind) last = &phases[i];
    return last;
}

/* s. Half of a step of four iterations does not depend on their number. */
static double expect(const ssfr_bench *bench, const physics *p)
{
    const double layers = bench->quick ? QUICK_LAYERS : LAYERS, n = 2 * layers * layers * layers;
    const double dt = 0.6 * 0.27 / layers / 3, steps = (bench->quick ? quick_duration : duration) / dt;
    return steps * n * ssfr_bench_pace / bench->max_threads * (0.5 + 0.5 * p->iterations / 4);
}

ssfr_result ssfr_bench_physics(ssfr_bench *bench)
{
    ssfr_result result = SSFR_OK;
    const int *counts = bench->quick ? quick_iterations : iterations;
    const size_t n = bench->quick ? SSFR_COUNT(quick_iterations) : SSFR_COUNT(iterations);
    for (int kind = SSFR_TANK_POOL; kind <= SSFR_TANK_DAM_BREAK; kind++)
        for (size_t i = 0; i < n; i++) {
            const physics p = {(ssfr_tank_kind)kind, counts[i]};
            ssfr_bench_key last;
            name(&last, &p, last_phase(p.kind));
            SSFR_TRY(ssfr_bench_visit(bench, run, &p, expect(bench, &p), SSFR_BENCH_PHYSICS, last.cells));
        }
end:
    return result;
}

/* ---- free fall --------------------------------------------------------------------------------------------------- */

enum { DROP_LAYERS = 3, FEWEST_STEPS = 60, MOST_STEPS = 1920, QUICK_STEPS = 240 }; /* a second */
static const double fall_time = 1; /* s */

static void name_fall(ssfr_bench_key *key, int steps)
{
    ssfr_bench_key_set(key, 0, "%.9g", fall_time / steps);
}

/* The error of the coarser run, which the order is told by; NaN for the first. */
static double error_before(const ssfr_bench *bench, int steps)
{
    const ssfr_csv_table view = ssfr_ledger_view(&bench->tables[SSFR_BENCH_FALL]);
    const int error = ssfr_csv_column(&view, "error");
    double found = NAN;
    for (size_t row = 0; row < view.n_rows; row++)
        if (fabs(ssfr_csv_cell_number(&view, row, 0) * steps / fall_time - 2) < 1e-6)
            found = ssfr_csv_cell_number(&view, row, error);
    return found;
}

static ssfr_result run_fall(ssfr_bench *bench, const void *what, double expected)
{
    ssfr_result result = SSFR_OK;
    const int steps = *(const int *)what;
    ssfr_solver_params params;
    ssfr_tank *tank = NULL;
    ssfr_tank_state before, after;
    ssfr_bench_key key;
    ssfr_params_default(ssfr_solver_rows, &params);
    params.max_step = fall_time / steps;
    params.cfl = 100; /* the speed is to have no say; what waves would allow is longer */
    SSFR_TRY(ssfr_tank_create(&tank, SSFR_TANK_DROP, DROP_LAYERS, &params));
    SSFR_TRY(ssfr_tank_measure(tank, &before));
    while (tank->time < fall_time) {
        SSFR_TRY(ssfr_tank_step(tank, fall_time));
        SSFR_TRY(ssfr_bench_tick(bench, expected, tank->time / fall_time));
    }
    SSFR_TRY(ssfr_tank_measure(tank, &after));
    const double fallen = before.centre - after.centre, exact = 0.5 * tank->gravity * ssfr_square(fall_time);
    const double error = fabs(fallen - exact), numbers[] = {(double)tank->steps, fallen, error,
                                                            log2(error_before(bench, steps) / error)};
    name_fall(&key, steps);
    SSFR_TRY(ssfr_ledger_add(&bench->tables[SSFR_BENCH_FALL], key.cells, "ok", numbers));
end:
    ssfr_tank_destroy(&tank);
    return result;
}

ssfr_result ssfr_bench_fall(ssfr_bench *bench)
{
    ssfr_result result = SSFR_OK;
    for (int steps = FEWEST_STEPS; steps <= (bench->quick ? QUICK_STEPS : MOST_STEPS); steps *= 2) {
        ssfr_bench_key key;
        name_fall(&key, steps);
        SSFR_TRY(ssfr_bench_visit(bench, run_fall, &steps, 1e-4 * steps, SSFR_BENCH_FALL, key.cells));
    }
end:
    return result;
}

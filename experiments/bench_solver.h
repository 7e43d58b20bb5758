/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_solver.h: `ssfr bench solver`: what the embedded simulator costs, and how far its
 * water is from real water.
 *
 *      bench_solver.c            the command: visiting all that is measured, printing, saving
 *      bench_solver_tables.c     columns and charts
 *      bench_solver_cost.c       time of steps and memory, against the number of particles and threads
 *      bench_solver_physics.c    density, volume, stillness, free fall */
#ifndef SSFR_BENCH_SOLVER_H
#define SSFR_BENCH_SOLVER_H

#include "experiments/chart.h"
#include "experiments/ledger.h"
#include "experiments/scenes/tank.h"

/* argv[0] is "bench", argv[1] "solver"; gives the exit status. */
int ssfr_bench_solver(int argc, char **argv);

/* ---- shared by its files ----------------------------------------------------------------------------------------- */

enum { SSFR_BENCH_KEYS = 5, SSFR_BENCH_PANELS = 4 };

/* The tables, in the order in which they are made. */
typedef enum ssfr_bench_table {
    SSFR_BENCH_COST,
    SSFR_BENCH_PHYSICS,
    SSFR_BENCH_SERIES, /* made with PHYSICS */
    SSFR_BENCH_FALL,
    SSFR_N_BENCH_TABLES
} ssfr_bench_table;

typedef struct ssfr_bench_layout {
    const char *ending; /* of the file, instead of the .csv of the first */
    int n_keys, n_columns;
    const ssfr_column *columns;
    const char *title;  /* of the charts */
    int n_panels;
    const ssfr_panel *panels; /* where an `only` has no cell it is the number of all threads */
} ssfr_bench_layout;

extern const ssfr_bench_layout ssfr_bench_tables[SSFR_N_BENCH_TABLES];

typedef struct ssfr_bench {
    bool quick;
    size_t max_particles;
    int max_threads;
    ssfr_ledger tables[SSFR_N_BENCH_TABLES];
    bool counting;      /* what is to be done is summed up, nothing is measured */
    double done, total; /* s, as expected: for the progress bar alone */
} ssfr_bench;

/* Each makes the rows that are missing, or only counts them. */
SSFR_MUST ssfr_result ssfr_bench_cost(ssfr_bench *bench);
SSFR_MUST ssfr_result ssfr_bench_physics(ssfr_bench *bench);
SSFR_MUST ssfr_result ssfr_bench_fall(ssfr_bench *bench);

/* What a measurement will take that is `share` through, s; it fails when it is to be given up. */
SSFR_MUST ssfr_result ssfr_bench_tick(ssfr_bench *bench, double expected, double share);
/* Runs a measurement expected to take so long, or counts it. Where it fails a row of these keys says why, and the bench
 * goes on, unless it was interrupted. */
typedef ssfr_result ssfr_bench_run(ssfr_bench *bench, const void *what, double expected);
SSFR_MUST ssfr_result ssfr_bench_visit(ssfr_bench *bench, ssfr_bench_run *run, const void *what, double expected,
                                       ssfr_bench_table table, const char *const *keys);

/* Text of keys. */
typedef struct ssfr_bench_key {
    char text[SSFR_BENCH_KEYS][32];
    const char *cells[SSFR_BENCH_KEYS];
} ssfr_bench_key;

/* The k-th cell. */
__attribute__((format(printf, 3, 4))) void ssfr_bench_key_set(ssfr_bench_key *key, int k, const char *format, ...);

extern const double ssfr_bench_pace; /* s a particle and step on one thread, roughly: for expectations */

#endif

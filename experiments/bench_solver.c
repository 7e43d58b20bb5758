/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_solver.c: `ssfr bench solver`: its options, tables, metadata and charts. */
#include "experiments/bench_solver.h"
#include "experiments/capture.h"
#include "experiments/command.h"
#include "experiments/interrupt.h"
#include "experiments/measure.h"
#include "experiments/meta.h"
#include "experiments/output.h"
#include "experiments/shown.h"

#include "base/param.h"

#include <omp.h>
#include <stdarg.h>

const double ssfr_bench_pace = 2e-6;

typedef struct words {
    const char *output;
    bool quick, resume, no_plot;
    long max_particles;
} words;

#define ROW(...) SSFR_OPTION(words, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(output, "output", 'o', TEXT, "FILE.csv",
        "write the tables as CSV too: costs to FILE.csv, and beside it FILE_physics.csv, FILE_series.csv and "
        "FILE_fall.csv, each with its .meta.json and .svg",
        0, 0),
    ROW(resume, "resume", 0, FLAG, NULL, "go on with FILE.csv: keep its rows, make those that it lacks", 0, 0),
    ROW(quick, "quick", 0, FLAG, NULL, "a few seconds instead of minutes: few particles, short simulations", 0, 0),
    ROW(max_particles, "max-particles", 0, INTEGER, "N", "measure the cost of no more than these (default 1100000)",
        1024, 1e9),
    ROW(no_plot, "no-plot", 0, FLAG, NULL, "draw no charts", 0, 0),
    SSFR_OPTION_END,
};

/* ---- visiting ---------------------------------------------------------------------------------------------------- */

void ssfr_bench_key_set(ssfr_bench_key *key, int k, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(key->text[k], sizeof key->text[k], format, args);
    va_end(args);
    key->cells[k] = key->text[k];
}

ssfr_result ssfr_bench_tick(ssfr_bench *bench, double expected, double share)
{
    const double done = bench->done + expected * share;
    if (bench->total > 0)
        ssfr_console_progress("bench solver", (size_t)fmin(100 * done / bench->total, 99), 100);
    return ssfr_interrupt_came() ? ssfr_fail(SSFR_ERR_IO, "interrupted") : SSFR_OK;
}

ssfr_result ssfr_bench_visit(ssfr_bench *bench, ssfr_bench_run *run, const void *what, double expected,
                             ssfr_bench_table table, const char *const *keys)
{
    ssfr_result result = SSFR_OK;
    char error[SSFR_CAPTURE_SIZE];
    if (ssfr_ledger_has(&bench->tables[table], keys)) return SSFR_OK;
    if (bench->counting) {
        bench->total += expected;
        return SSFR_OK;
    }
    ssfr_capture_begin("bench");
    result = run(bench, what, expected);
    ssfr_capture_end(error);
    bench->done += expected;
    if (result == SSFR_OK) return SSFR_OK;
    if (ssfr_interrupt_came()) return ssfr_ledger_interrupted(&bench->tables[table]);
    return ssfr_ledger_add(&bench->tables[table], keys, error[0] ? error : ssfr_result_text(result), NULL);
}

static ssfr_result visit_all(ssfr_bench *bench, bool counting)
{
    ssfr_result result = SSFR_OK;
    bench->counting = counting;
    SSFR_TRY(ssfr_bench_cost(bench));
    SSFR_TRY(ssfr_bench_physics(bench));
    SSFR_TRY(ssfr_bench_fall(bench));
end:
    if (!counting) ssfr_console_progress("bench solver", 100, 100);
    return result;
}

/* ---- for people -------------------------------------------------------------------------------------------------- */

static const ssfr_shown steps_shown[] = {
    {"case", "case", NULL, 0}, {"particles", "particles", NULL, 0}, {"threads", "threads", NULL, 0},
    {"ms_median", "ms a step", "%.2f", 1}, {"ms_mad", "MAD", "%.2f", 1}, {"runs", "n", NULL, 0},
    {"bytes_per_particle", "B a particle", "%.0f", 1}, {"neighbours", "neighbours", "%.1f", 1},
    {"steps_per_second", "steps/s", "%.0f", 1}, {"real_time", "x real time", "%.4f", 1}};
static const ssfr_shown stages_shown[] = {
    {"case", "case", NULL, 0}, {"particles", "particles", NULL, 0}, {"threads", "threads", NULL, 0},
    {"part", "stage", NULL, 0}, {"ms_median", "ms", "%.3f", 1}, {"ms_mad", "MAD", "%.3f", 1},
    {"share", "% of the step", "%.1f", 100}};
static const ssfr_shown foam_shown[] = {
    {"particles", "fluid", NULL, 0}, {"diffuse", "diffuse", NULL, 0}, {"threads", "threads", NULL, 0},
    {"ms_median", "ms a step", "%.2f", 1}, {"ms_mad", "MAD", "%.2f", 1}, {"runs", "n", NULL, 0}};
static const ssfr_shown physics_shown[] = {
    {"case", "case", NULL, 0}, {"phase", "phase", NULL, 0}, {"iterations", "iterations", NULL, 0},
    {"density_mean", "density % mean", "%+.2f", 100}, {"density_rms", "RMS", "%.2f", 100},
    {"density_max", "max", "%.2f", 100}, {"compression_max", "max above", "%.2f", 100},
    {"volume_change", "volume %", "%+.2f", 100}, {"surface_change", "surface %", "%+.2f", 100},
    {"centre_change", "centre %", "%+.2f", 100}, {"speed_rms", "m/s RMS", "%.4f", 1},
    {"speed_max", "max", "%.3f", 1}, {"steps_per_second", "steps/s", "%.0f", 1}};
static const ssfr_shown fall_shown[] = {
    {"max_step", "step s", "%.6f", 1}, {"fallen", "fallen m", "%.6f", 1}, {"error", "error m", "%.3g", 1},
    {"order", "order", "%.2f", 1}};

static bool is_part(const ssfr_csv_table *table, size_t row, const char *part)
{
    return strcmp(ssfr_csv_cell(table, row, ssfr_csv_column(table, "part")), part) == 0;
}

static bool is_step(const ssfr_csv_table *table, size_t row)
{
    return is_part(table, row, "(step)");
}

static bool is_foam(const ssfr_csv_table *table, size_t row)
{
    return is_part(table, row, "(foam)");
}

/* Of the dam break of the most particles, with the most threads. */
static bool is_stage(const ssfr_csv_table *table, size_t row)
{
    const int particles = ssfr_csv_column(table, "particles"), threads = ssfr_csv_column(table, "threads");
    bool most = !is_step(table, row) && !is_foam(table, row) && strcmp(ssfr_csv_cell(table, row, 0), "dam_break") == 0;
    for (size_t i = 0; i < table->n_rows && most; i++)
        most = strcmp(ssfr_csv_cell(table, i, 0), "dam_break") != 0 ||
               (ssfr_csv_cell_number(table, i, particles) <= ssfr_csv_cell_number(table, row, particles) &&
                ssfr_csv_cell_number(table, i, threads) <= ssfr_csv_cell_number(table, row, threads));
    return most;
}

static ssfr_result print_all(const ssfr_bench *bench)
{
    ssfr_result result = SSFR_OK;
    const ssfr_ledger *t = bench->tables;
#define PRINT(table, title, chosen, columns) \
    SSFR_TRY(ssfr_shown_print(&t[table], title, chosen, columns, SSFR_COUNT(columns)))
    PRINT(SSFR_BENCH_COST, "Steps:", is_step, steps_shown);
    PRINT(SSFR_BENCH_COST, "Stages of a step:", is_stage, stages_shown);
    PRINT(SSFR_BENCH_COST, "Steps of the foam beside the dam break:", is_foam, foam_shown);
    PRINT(SSFR_BENCH_PHYSICS, "Densities inside, volume, stillness:", NULL, physics_shown);
    PRINT(SSFR_BENCH_FALL, "Free fall for one second:", NULL, fall_shown);
end:
    return result;
}

/* ---- for programs ------------------------------------------------------------------------------------------------ */

typedef struct command {
    words words;
    ssfr_command_line line;
    int argc;
    char **argv;
    ssfr_bench bench;
    char *paths[SSFR_N_BENCH_TABLES]; /* NULL without -o */
    double bandwidth;                 /* bytes/s */
} command;

/* Rows of another length of simulation must not stand in one table. */
static uint64_t identity_of(const command *c)
{
    char text[128];
    snprintf(text, sizeof text, "bench solver %d %d %d", SSFR_SOLVER_VERSION, c->bench.max_threads, c->bench.quick);
    return ssfr_hash_text(ssfr_meta_hash(), text);
}

static ssfr_result record_parameters(ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    ssfr_solver_params params;
    ssfr_params_default(ssfr_solver_rows, &params);
    SSFR_TRY(ssfr_record_params(record, "solver", ssfr_solver_rows, &params));
    SSFR_TRY(ssfr_record_number(record, "solver.version", SSFR_SOLVER_VERSION));
end:
    return result;
}

static ssfr_result save_meta(const command *c, int table)
{
    ssfr_result result = SSFR_OK;
    ssfr_record parameters = {0}, scenes[3] = {{0}};
    SSFR_TRY(record_parameters(&parameters));
    for (size_t i = 0; i < SSFR_COUNT(scenes); i++) {
        SSFR_TRY(ssfr_record_text(&scenes[i], "scene", ssfr_tank_words[i]));
        SSFR_TRY(ssfr_record_text(&scenes[i], "water", ssfr_tank_help[i]));
    }
    SSFR_TRY(ssfr_meta_save(c->paths[table], &(ssfr_meta){.argc = c->argc,
                                                          .argv = c->argv,
                                                          .seed = c->line.seed,
                                                          .identity = identity_of(c),
                                                          .parameters = &parameters,
                                                          .n_columns = ssfr_bench_tables[table].n_columns,
                                                          .columns = ssfr_bench_tables[table].columns,
                                                          .n_scenes = SSFR_COUNT(scenes),
                                                          .scenes = scenes,
                                                          .bandwidth_gl = NAN,
                                                          .bandwidth_cpu = c->bandwidth}));
end:
    ssfr_record_finish(&parameters);
    for (size_t i = 0; i < SSFR_COUNT(scenes); i++) ssfr_record_finish(&scenes[i]);
    return result;
}

static ssfr_result begin_tables(command *c)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < SSFR_N_BENCH_TABLES && c->words.output; i++) {
        SSFR_TRY(ssfr_meta_path(&c->paths[i], c->words.output, ssfr_bench_tables[i].ending));
        SSFR_TRY(ssfr_output_check_file(c->paths[i]));
    }
    for (int i = 0; i < SSFR_N_BENCH_TABLES; i++) {
        bool resumed;
        const ssfr_bench_layout *layout = &ssfr_bench_tables[i];
        SSFR_TRY(ssfr_ledger_begin(&c->bench.tables[i], c->paths[i], layout->n_columns, layout->columns,
                                   layout->n_keys, c->words.resume, &resumed));
        if (resumed) SSFR_TRY(ssfr_meta_check(c->paths[i], identity_of(c)));
    }
    c->bandwidth = c->words.output && !c->words.quick ? ssfr_measure_copy_bandwidth(NULL, 0) : NAN;
    for (int i = 0; i < SSFR_N_BENCH_TABLES && c->words.output; i++) SSFR_TRY(save_meta(c, i));
end:
    return result;
}

static ssfr_result draw_table(const command *c, int table)
{
    const ssfr_bench_layout *layout = &ssfr_bench_tables[table];
    ssfr_panel panels[SSFR_BENCH_PANELS];
    char threads[16];
    snprintf(threads, sizeof threads, "%d", c->bench.max_threads);
    memcpy(panels, layout->panels, (size_t)layout->n_panels * sizeof *panels);
    ssfr_panels_fill(layout->n_panels, panels, threads);
    return ssfr_shown_draw(&c->bench.tables[table], c->paths[table], layout->title, layout->n_panels, panels);
}

static ssfr_result run(command *c)
{
    ssfr_result result = SSFR_OK;
    c->bench.quick = c->words.quick;
    c->bench.max_particles = (size_t)c->words.max_particles;
    c->bench.max_threads = omp_get_max_threads();
    SSFR_TRY(begin_tables(c));
    SSFR_TRY(visit_all(&c->bench, true));
    ssfr_interrupt_begin();
    result = visit_all(&c->bench, false);
    ssfr_interrupt_end();
    if (result != SSFR_OK) goto end;
    SSFR_TRY(print_all(&c->bench));
    for (int i = 0; i < SSFR_N_BENCH_TABLES && c->words.output && !c->words.no_plot; i++) SSFR_TRY(draw_table(c, i));
end:
    return result;
}

int ssfr_bench_solver(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    command c = {.argc = argc, .argv = argv, .words = {.max_particles = 1100000}};
    const ssfr_option_set sets[] = {{"bench solver", rows, &c.words}, {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = "bench solver",
        .arguments = "",
        .sets = sets,
        .help = "Measures the embedded simulator: time of a step stage by stage, memory, foam; and how far its water "
                "is from rest density, constant volume, stillness and free fall."};
    SSFR_TRY(ssfr_options_parse(&c.line, &usage, argc - 1, argv + 1));
    if (c.line.help) goto end;
    SSFR_TRY(ssfr_output_check_resume(c.words.resume, c.words.output));
    SSFR_TRY(run(&c));
end:
    for (int i = 0; i < SSFR_N_BENCH_TABLES; i++) {
        ssfr_ledger_finish(&c.bench.tables[i]);
        free(c.paths[i]);
    }
    return ssfr_exit_status(result);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_solver.c: `ssfr bench solver`: its options, tables, metadata and charts. */
#include "experiments/bench_solver.h"
#include "experiments/capture.h"
#include "experiments/chart.h"
#include "experiments/command.h"
#include "experiments/interrupt.h"
#include "experiments/measure.h"
#include "experiments/meta.h"
#include "experiments/output.h"

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

/* ---- columns ----------------------------------------------------------------------------------------------------- */

static const ssfr_column cost_columns[] = {
    {"case", "1", 0, "pool: at rest; dam_break: at its splash"},
    {"particles", "1", 0, "of the fluid"},
    {"threads", "1", 0, "of OpenMP"},
    {"part", "1", 0, "(step): a step of the solver as a whole; its stages; (foam): a step of diffuse particles beside it"},
    {"diffuse", "1", 0, "diffuse particles"},
    {"status", "1", 0, "ok, or why it failed"},
    {"radius", "m", 0, "of the fluid's particles"},
    {"ms_min", "ms", -1, "shortest time"},
    {"ms_median", "ms", -1, "median time"},
    {"ms_mad", "ms", -1, "median absolute deviation of the time"},
    {"runs", "1", 0, "timed steps"},
    {"outliers", "1", 0, "timed steps whose modified z-score exceeds 3.5"},
    {"share", "1", 0, "median time over that of the step"},
    {"bytes_per_particle", "B", -1, "memory that the solver holds"},
    {"neighbours", "1", 0, "of a particle within the support, on average"},
    {"step", "s", 0, "mean length of the timed steps"},
    {"steps_per_second", "1/s", -1, "steps in a simulated second"},
    {"real_time", "1", 1, "mean length of a step over median time"},
};

static const ssfr_column physics_columns[] = {
    {"case", "1", 0, "pool: at rest from the start; dam_break: the same water, collapsing"},
    {"phase", "1", 0, "rest: all the time; motion: from the fall to when the wave is back from the wall; settled: the end"},
    {"iterations", "1", 0, "of the density constraint in a step"},
    {"status", "1", 0, "ok, or why it failed"},
    {"particles", "1", 0, "of the fluid"},
    {"radius", "m", 0, "of the particles"},
    {"from", "s", 0, "begin of the phase"},
    {"to", "s", 0, "end of the phase; all is over its moments, 30 a second"},
    {"interior", "1", 0, "share of particles farther than a support from walls and surface: densities are theirs"},
    {"density_mean", "1", 0, "mean deviation of densities from 1000 kg/m^3, relative to it"},
    {"density_rms", "1", -1, "root mean square of the deviations"},
    {"density_max", "1", -1, "largest size of a deviation"},
    {"compression_rms", "1", -1, "root mean square of the deviations, those below 0 as 0"},
    {"compression_max", "1", -1, "largest deviation above 0"},
    {"volume_change", "1", 0, "sum of m/rho over all particles, relative to the start"},
    {"surface_change", "1", 0, "height of the surface, relative to the water's volume over the floor's area"},
    {"centre_change", "1", 0, "twice the height of the centre of mass, relative to the same"},
    {"speed_rms", "m/s", -1, "root mean square of the speeds"},
    {"speed_max", "m/s", -1, "largest speed"},
    {"steps_per_second", "1/s", -1, "steps in a simulated second, over the whole simulation"},
};

static const ssfr_column series_columns[] = {
    {"case", "1", 0, "pool or dam_break"},
    {"iterations", "1", 0, "of the density constraint in a step"},
    {"time", "s", 0, "simulated"},
    {"status", "1", 0, "ok, or why it failed"},
    {"volume_change", "1", 0, "sum of m/rho over all particles, relative to the start"},
    {"surface", "m", 0, "height of the surface: the median over columns two particles wide"},
    {"centre", "m", 0, "height of the centre of mass"},
    {"speed_rms", "m/s", -1, "root mean square of the speeds"},
    {"speed_max", "m/s", -1, "largest speed"},
    {"energy", "J", 0, "kinetic energy, and potential energy over the floor"},
    {"interior", "1", 0, "share of particles farther than a support from walls and surface: densities are theirs"},
    {"density_mean", "1", 0, "mean deviation of densities from 1000 kg/m^3, relative to it"},
    {"density_rms", "1", -1, "root mean square of the deviations"},
    {"density_max", "1", -1, "largest size of a deviation"},
    {"steps", "1", 0, "since the start"},
};

static const ssfr_column fall_columns[] = {
    {"max_step", "s", 0, "length of a step"},
    {"status", "1", 0, "ok, or why it failed"},
    {"steps", "1", 0, "in one second"},
    {"fallen", "m", 0, "how far the drop's centre of mass falls in one second from rest"},
    {"error", "m", -1, "distance from where the exact parabola ends"},
    {"order", "1", 1, "logarithm to the base 2 of the error with twice as long steps over this error"},
};

/* ---- charts ------------------------------------------------------------------------------------------------------ */

enum { MAX_PANELS = 4 };

/* A cell that is not given is the number of all threads. */
#define EVERY_CASE {{"case", NULL}, {"threads", "threads "}}
#define WHOLE {{"part", "(step)"}}

static const ssfr_panel cost_panels[] = {
    {.title = "Time of a step", .x = "particles", .y = "ms_median", .x_label = "particles",
     .y_label = "median time of a step [ms]", .log_x = true, .log_y = true, .keys = EVERY_CASE, .only = WHOLE,
     .mark = {65536, 60}, .mark_text = "aim: 60 ms for 64 K"},
    {.title = "Against real time", .x = "particles", .y = "real_time", .x_label = "particles",
     .y_label = "simulated over computed time", .log_x = true, .log_y = true, .keys = EVERY_CASE, .only = WHOLE,
     .levels = {1}, .level_text = "as fast as it happens"},
    {.title = "Where the time of the dam break's steps goes", .x = "particles", .y = "share",
     .x_label = "particles", .y_label = "share of the step, all threads [%]", .y_factor = 100, .log_x = true,
     .keys = {{"part", NULL}},
     .only = {{"case", "dam_break"}, {"threads", NULL}, {"diffuse", "0"}, {"part", "predict"}, {"part", "multipliers"},
              {"part", "correct"}, {"part", "arrive"}, {"part", "sort"}, {"part", "list"}, {"part", "density"},
              {"part", "smooth"}}},
    {.title = "Memory", .x = "particles", .y = "bytes_per_particle", .x_label = "particles",
     .y_label = "bytes a particle", .log_x = true, .keys = {{"case", NULL}}, .only = {{"part", "(step)"}, {"threads", "1"}},
     .levels = {512}, .level_text = "aim: 512"},
};

static const ssfr_panel physics_panels[] = {
    {.title = "Density: RMS deviation", .x = "iterations", .y = "density_rms",
     .x_label = "iterations a step", .y_label = "deviation from 1000 kg/m^3 inside, RMS [%]", .y_factor = 100,
     .log_x = true, .log_y = true, .keys = {{"case", NULL}, {"phase", NULL}}},
    {.title = "Density: largest compression", .x = "iterations", .y = "compression_max",
     .x_label = "iterations a step", .y_label = "largest density above 1000 kg/m^3 inside [%]", .y_factor = 100,
     .log_x = true, .log_y = true, .keys = {{"case", NULL}, {"phase", NULL}}},
    {.title = "Volume, by the centre of mass", .x = "iterations", .y = "centre_change",
     .x_label = "iterations a step", .y_label = "change of twice the centre's height [%]", .y_factor = 100,
     .log_x = true, .keys = {{"case", NULL}, {"phase", NULL}}, .only = {{"phase", "rest"}, {"phase", "settled"}},
     .levels = {3, -3}, .level_text = "aim: within 3 %"},
    {.title = "Stillness", .x = "iterations", .y = "speed_rms", .x_label = "iterations a step",
     .y_label = "RMS speed [m/s]", .log_x = true, .log_y = true, .keys = {{"case", NULL}, {"phase", NULL}},
     .only = {{"phase", "rest"}, {"phase", "settled"}}},
};

#define EVERY_COUNT {{"iterations", "iterations "}}

static const ssfr_panel series_panels[] = {
    {.title = "Dam break: volume as the sum of m/rho", .x = "time", .y = "volume_change", .x_label = "time [s]",
     .y_label = "change since the start [%]", .y_factor = 100, .keys = EVERY_COUNT, .only = {{"case", "dam_break"}},
     .levels = {3, -3}, .level_text = "aim: within 3 %"},
    {.title = "Dam break: mean density inside", .x = "time", .y = "density_mean", .x_label = "time [s]",
     .y_label = "deviation from 1000 kg/m^3 [%]", .y_factor = 100, .keys = EVERY_COUNT,
     .only = {{"case", "dam_break"}}},
    {.title = "Dam break: energy over the floor", .x = "time", .y = "energy", .x_label = "time [s]",
     .y_label = "kinetic and potential energy [J]", .keys = EVERY_COUNT, .only = {{"case", "dam_break"}}},
    {.title = "Pool at rest: speeds", .x = "time", .y = "speed_max", .x_label = "time [s]",
     .y_label = "largest speed [m/s]", .log_y = true, .keys = EVERY_COUNT, .only = {{"case", "pool"}}},
};

static const ssfr_panel fall_panels[] = {
    {.title = "A drop falls for one second, 4.905 m", .x = "max_step", .y = "error", .x_label = "length of a step [s]",
     .y_label = "distance from the exact parabola's end [m]", .log_x = true, .log_y = true},
};

/* ---- tables ------------------------------------------------------------------------------------------------------ */

static const struct table {
    const char *ending;
    int n_keys, n_columns;
    const ssfr_column *columns;
    const char *title;
    int n_panels;
    const ssfr_panel *panels;
} tables[SSFR_N_BENCH_TABLES] = {
#define TABLE(ending, n_keys, name, title) \
    {ending, n_keys, SSFR_COUNT(name##_columns), name##_columns, title, SSFR_COUNT(name##_panels), name##_panels}
    [SSFR_BENCH_COST] = TABLE(".csv", 5, cost, "What the embedded solver costs"),
    [SSFR_BENCH_PHYSICS] = TABLE("_physics.csv", 3, physics, "How well the embedded solver keeps its water"),
    [SSFR_BENCH_SERIES] = TABLE("_series.csv", 3, series, "The embedded solver's water over time"),
    [SSFR_BENCH_FALL] = TABLE("_fall.csv", 1, fall, "Free fall"),
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
    double nothing[SSFR_LEDGER_COLUMNS];
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
    if (ssfr_interrupt_came())
        return ssfr_fail(SSFR_ERR_IO, "interrupted%s", bench->tables[table].csv
                         ? ": whole rows stay, the same command with --resume goes on from there" : "");
    for (size_t i = 0; i < SSFR_COUNT(nothing); i++) nothing[i] = NAN;
    return ssfr_ledger_add(&bench->tables[table], keys, error[0] ? error : ssfr_result_text(result), nothing);
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

typedef struct shown {
    const char *column, *title;
    const char *format; /* of a number; NULL for text */
    double factor;
} shown;

static const shown steps_shown[] = {
    {"case", "case", NULL, 0}, {"particles", "particles", NULL, 0}, {"threads", "threads", NULL, 0},
    {"ms_median", "ms a step", "%.2f", 1}, {"ms_mad", "MAD", "%.2f", 1}, {"runs", "n", NULL, 0},
    {"bytes_per_particle", "B a particle", "%.0f", 1}, {"neighbours", "neighbours", "%.1f", 1},
    {"steps_per_second", "steps/s", "%.0f", 1}, {"real_time", "x real time", "%.4f", 1}};
static const shown stages_shown[] = {
    {"case", "case", NULL, 0}, {"particles", "particles", NULL, 0}, {"threads", "threads", NULL, 0},
    {"part", "stage", NULL, 0}, {"ms_median", "ms", "%.3f", 1}, {"ms_mad", "MAD", "%.3f", 1},
    {"share", "% of the step", "%.1f", 100}};
static const shown foam_shown[] = {
    {"particles", "fluid", NULL, 0}, {"diffuse", "diffuse", NULL, 0}, {"threads", "threads", NULL, 0},
    {"ms_median", "ms a step", "%.2f", 1}, {"ms_mad", "MAD", "%.2f", 1}, {"runs", "n", NULL, 0}};
static const shown physics_shown[] = {
    {"case", "case", NULL, 0}, {"phase", "phase", NULL, 0}, {"iterations", "iterations", NULL, 0},
    {"density_mean", "density % mean", "%+.2f", 100}, {"density_rms", "RMS", "%.2f", 100},
    {"density_max", "max", "%.2f", 100}, {"compression_max", "max above", "%.2f", 100},
    {"volume_change", "volume %", "%+.2f", 100}, {"surface_change", "surface %", "%+.2f", 100},
    {"centre_change", "centre %", "%+.2f", 100}, {"speed_rms", "m/s RMS", "%.4f", 1},
    {"speed_max", "max", "%.3f", 1}, {"steps_per_second", "steps/s", "%.0f", 1}};
static const shown fall_shown[] = {
    {"max_step", "step s", "%.6f", 1}, {"fallen", "fallen m", "%.6f", 1}, {"error", "error m", "%.3g", 1},
    {"order", "order", "%.2f", 1}};

/* Tells which rows are printed. */
typedef bool chooser(const ssfr_csv_table *table, size_t row);

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

static bool is_any(const ssfr_csv_table *table, size_t row)
{
    (void)table, (void)row;
    return true;
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

static ssfr_result add_shown(ssfr_table *out, const ssfr_csv_table *table, size_t row, const shown *s)
{
    const int column = ssfr_csv_column(table, s->column);
    char text[64];
    if (!s->format) return ssfr_table_add(out, "%s", ssfr_csv_cell(table, row, column));
    const double value = s->factor * ssfr_csv_cell_number(table, row, column);
    if (!isfinite(value)) return ssfr_table_add(out, "-");
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    snprintf(text, sizeof text, s->format, value);
#pragma GCC diagnostic pop
    return ssfr_table_add(out, "%s", text);
}

static ssfr_result print_rows(const ssfr_ledger *from, const char *title, chooser *chosen, const shown *columns,
                              int n_columns)
{
    ssfr_result result = SSFR_OK;
    const ssfr_csv_table view = ssfr_ledger_view(from);
    ssfr_table out;
    ssfr_table_init(&out, n_columns);
    for (int i = 0; i < n_columns; i++) SSFR_TRY(ssfr_table_add(&out, "%s", columns[i].title));
    for (size_t row = 0; row < view.n_rows; row++)
        for (int i = 0; i < n_columns && chosen(&view, row); i++) SSFR_TRY(add_shown(&out, &view, row, &columns[i]));
    printf("%s\n", title);
    ssfr_table_print(&out, stdout);
    printf("\n");
end:
    ssfr_table_finish(&out);
    return result;
}

static ssfr_result print_all(const ssfr_bench *bench)
{
    ssfr_result result = SSFR_OK;
    const ssfr_ledger *t = bench->tables;
#define PRINT(table, title, chosen, columns) \
    SSFR_TRY(print_rows(&t[table], title, chosen, columns, SSFR_COUNT(columns)))
    PRINT(SSFR_BENCH_COST, "Steps:", is_step, steps_shown);
    PRINT(SSFR_BENCH_COST, "Stages of a step:", is_stage, stages_shown);
    PRINT(SSFR_BENCH_COST, "Steps of the foam beside the dam break:", is_foam, foam_shown);
    PRINT(SSFR_BENCH_PHYSICS, "Densities inside, volume, stillness:", is_any, physics_shown);
    PRINT(SSFR_BENCH_FALL, "Free fall for one second:", is_any, fall_shown);
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

/* Rows of another build, another machine or another length of simulation must not stand in one table. */
static uint64_t identity_of(const command *c)
{
    char text[256], processor[128];
    ssfr_meta_processor(processor, sizeof processor);
    snprintf(text, sizeof text, "bench solver %s %s %d %d %d %s", ssfr_version(), ssfr_meta_commit(),
             SSFR_SOLVER_VERSION, c->bench.max_threads, c->bench.quick, processor);
    return ssfr_hash_text(SSFR_HASH, text);
}

static ssfr_result record_parameters(ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    ssfr_solver_params params;
    ssfr_params_default(ssfr_solver_rows, &params);
    for (const ssfr_param *row = ssfr_solver_rows; row->name; row++) {
        char key[64];
        snprintf(key, sizeof key, "solver.%s", row->name);
        SSFR_TRY(ssfr_record_number(record, key, ssfr_param_number(row, &params)));
    }
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
                                                          .n_columns = tables[table].n_columns,
                                                          .columns = tables[table].columns,
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
        SSFR_TRY(ssfr_meta_path(&c->paths[i], c->words.output, tables[i].ending));
        SSFR_TRY(ssfr_output_check_file(c->paths[i]));
    }
    for (int i = 0; i < SSFR_N_BENCH_TABLES; i++) {
        bool resumed;
        SSFR_TRY(ssfr_ledger_begin(&c->bench.tables[i], c->paths[i], tables[i].n_columns, tables[i].columns,
                                 tables[i].n_keys, c->words.resume, &resumed));
        if (resumed) SSFR_TRY(ssfr_meta_check(c->paths[i], identity_of(c)));
    }
    c->bandwidth = c->words.output && !c->words.quick ? ssfr_measure_copy_bandwidth(NULL) : NAN;
    for (int i = 0; i < SSFR_N_BENCH_TABLES && c->words.output; i++) SSFR_TRY(save_meta(c, i));
end:
    return result;
}

static ssfr_result draw_table(const command *c, int table)
{
    ssfr_result result = SSFR_OK;
    const ssfr_csv_table view = ssfr_ledger_view(&c->bench.tables[table]);
    ssfr_panel panels[MAX_PANELS];
    char threads[16], *svg = NULL;
    snprintf(threads, sizeof threads, "%d", c->bench.max_threads);
    memcpy(panels, tables[table].panels, (size_t)tables[table].n_panels * sizeof *panels);
    for (int p = 0; p < tables[table].n_panels; p++)
        for (int i = 0; i < SSFR_CHART_ONLY && panels[p].only[i].column; i++)
            if (!panels[p].only[i].cell) panels[p].only[i].cell = threads;
    SSFR_TRY(ssfr_meta_path(&svg, c->paths[table], ".svg"));
    SSFR_TRY(ssfr_chart_save(svg, &view, tables[table].title, tables[table].n_panels, panels));
end:
    free(svg);
    return result;
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
    static char name[] = "bench solver";
    command c = {.argc = argc, .argv = argv, .words = {.max_particles = 1100000}};
    char **own = NULL;
    const ssfr_option_set sets[] = {{"bench solver", rows, &c.words}, {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = name,
        .arguments = "",
        .sets = sets,
        .help = "Measures the embedded simulator: time of a step stage by stage, memory, foam; and how far its water is "
                "from rest density, constant volume, stillness and free fall."};
    SSFR_TRY(ssfr_alloc(&own, (size_t)argc, sizeof *own, "arguments"));
    memcpy(own, argv + 1, (size_t)(argc - 1) * sizeof *own);
    own[0] = name;
    SSFR_TRY(ssfr_options_parse(&c.line, &usage, argc - 1, own));
    if (c.line.help) goto end;
    if (c.words.resume && !c.words.output) {
        result = ssfr_fail(SSFR_ERR_VALUE, "--resume needs the table to go on with: -o FILE.csv");
        goto end;
    }
    SSFR_TRY(run(&c));
end:
    for (int i = 0; i < SSFR_N_BENCH_TABLES; i++) {
        ssfr_ledger_finish(&c.bench.tables[i]);
        free(c.paths[i]);
    }
    free(own);
    return ssfr_exit_status(result);
}

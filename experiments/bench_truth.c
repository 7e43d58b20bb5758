/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_truth.c: `ssfr bench truth`: its options, its table, metadata and charts. */
#include "experiments/bench_truth.h"
#include "experiments/capture.h"
#include "experiments/command.h"
#include "experiments/interrupt.h"
#include "experiments/meta.h"
#include "experiments/options.h"
#include "experiments/output.h"
#include "experiments/shown.h"
#include "experiments/truth/truth.h"

#include "base/param.h"
#include "scene/anisotropy.h"

#include <omp.h>

typedef struct words {
    const char *output;
    bool quick, resume, no_plot;
    long max_particles;
} words;

#define ROW(...) SSFR_OPTION(words, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(output, "output", 'o', TEXT, "FILE.csv", "write the table as CSV too, beside it .meta.json and .svg", 0, 0),
    ROW(resume, "resume", 0, FLAG, NULL, "go on with FILE.csv: keep its rows, make those that it lacks", 0, 0),
    ROW(quick, "quick", 0, FLAG, NULL, "a few seconds instead of minutes: few particles, few rays", 0, 0),
    ROW(max_particles, "max-particles", 0, INTEGER, "N", "measure no more than these (default 1048576)", 1000, 1e9),
    ROW(no_plot, "no-plot", 0, FLAG, NULL, "draw no chart", 0, 0),
    SSFR_OPTION_END,
};

/* ---- the table --------------------------------------------------------------------------------------------------- */

enum { N_KEYS = 4 };

static const ssfr_column columns[] = {
    {"water", "1", 0, "finer: more particles are smaller; wider: they are more water beside what is seen"},
    {"continuum", "1", 0, "what the particles are taken for"},
    {"particles", "1", 0, "asked for"},
    {"threads", "1", 0, "of OpenMP"},
    {"status", "1", 0, "ok, or why it failed"},
    {"placed", "1", 0, "particles that there are"},
    {"radius", "m", 0, "of the particles"},
    {"rays", "1", 0, "cast at a time: one in each of as many squares of the image"},
    {"whole", "1", 0, "1: these are all pixels of the image; 0: its time is extrapolated from a part"},
    {"covered", "1", 0, "share of the rays that cross the surface"},
    {"kernels", "1", 0, "that a ray meets which crosses the surface"},
    {"crossings", "1", 0, "of the surface, by such a ray"},
    {"touches", "1", 0, "share of the rays that touch the surface, so that rounding decides whether they cross it"},
    {"evaluations", "1", 0, "of bounds and values of the field along such a ray"},
    {"runs", "1", 0, "how often all these rays were cast"},
    {"ms_min", "ms", -1, "shortest time for all these rays"},
    {"ms_median", "ms", -1, "median time for all these rays"},
    {"ms_mad", "ms", -1, "median absolute deviation of the time"},
    {"rays_per_second", "1/s", 1, "rays over median time"},
    {"ray_us", "us", -1, "time of a thread for a ray that crosses the surface"},
    {"kernel_ns", "ns", -1, "the same over the kernels that it meets"},
    {"gather", "1", 0, "share of that time: finding the kernels along the ray"},
    {"find", "1", 0, "share of that time: finding crossings and normals"},
    {"chords", "1", 0, "share of that time: the density's integral"},
    {"image_s", "s", -1, "time of an image of 1280x720: depth, normal, thickness and the density's integral"},
    {"bytes_per_particle", "B", -1, "of the fluid's arrays"},
    {"build_s", "s", -1, "time to make the fluid of the particles"},
};

#define EVERY_CONTINUUM {{"continuum", NULL}}

static const ssfr_panel panels[] = {
    {.title = "Time of a ray against what it crosses", .x = "kernels", .y = "ray_us", .x_label = "kernels a ray",
     .y_label = "time of a thread [us a ray]", .log_x = true, .log_y = true, .keys = EVERY_CONTINUUM,
     .only = {{"water", "finer"}, {"threads", "1"}}},
    {.title = "Time of a ray through finer, and through wider, water (density)", .x = "particles", .y = "ray_us",
     .x_label = "particles of the whole water", .y_label = "time of a thread [us a ray]", .log_x = true, .log_y = true,
     .keys = {{"water", NULL}}, .only = {{"continuum", "density"}, {"threads", "1"}}},
    {.title = "Rays a second against what they cross", .x = "kernels", .y = "rays_per_second",
     .x_label = "kernels a ray", .y_label = "rays a second, all threads", .log_x = true, .log_y = true,
     .keys = EVERY_CONTINUUM, .only = {{"water", "finer"}, {"threads", NULL}}},
    {.title = "Time of an image", .x = "particles", .y = "image_s", .x_label = "particles",
     .y_label = "1280x720, all threads [s]", .log_x = true, .log_y = true, .keys = EVERY_CONTINUUM,
     .only = {{"water", "finer"}, {"threads", NULL}}, .levels = {180}, .level_text = "aim: 3 minutes",
     .mark = {65536, 180}, .mark_text = "for 64 K, density"},
};

static const ssfr_shown shown[] = {
    {"water", "water", NULL, 0}, {"continuum", "continuum", NULL, 0}, {"particles", "particles", NULL, 0},
    {"threads", "threads", NULL, 0}, {"rays_per_second", "rays/s", "%.0f", 1}, {"ray_us", "us a ray", "%.1f", 1},
    {"kernels", "kernels", "%.0f", 1}, {"crossings", "crossings", "%.2f", 1},
    {"evaluations", "evaluations", "%.0f", 1}, {"kernel_ns", "ns a kernel", "%.0f", 1},
    {"gather", "% gather", "%.0f", 100}, {"find", "find", "%.0f", 100}, {"chords", "chords", "%.0f", 100},
    {"image_s", "s an image", "%.1f", 1}, {"whole", "whole", "%.0f", 1},
    {"bytes_per_particle", "B a particle", "%.0f", 1}, {"build_s", "s to build", "%.2f", 1}};

/* ---- measuring --------------------------------------------------------------------------------------------------- */

enum { MAX_RUNS = 200 };

typedef struct bench {
    bool quick;
    size_t max_particles;
    int max_threads;
    uint64_t seed;
    ssfr_ledger table;
    bool counting;      /* what is to be done is summed up, nothing is measured */
    double done, total; /* s, as expected: for the progress bar alone */
    double expected;    /* s, of what is measured now */
} bench;

typedef struct cost {
    ssfr_waters water;
    ssfr_continuum_kind continuum;
    size_t particles;
    int threads;
    int every; /* px */
} cost;

typedef struct key {
    char text[N_KEYS][32];
    const char *cells[N_KEYS];
} key;

static void name(key *out, const cost *c)
{
    snprintf(out->text[0], sizeof out->text[0], "%s", ssfr_water_names[c->water]);
    snprintf(out->text[1], sizeof out->text[1], "%s", ssfr_continuum_names[c->continuum]);
    snprintf(out->text[2], sizeof out->text[2], "%zu", c->particles);
    snprintf(out->text[3], sizeof out->text[3], "%d", c->threads);
    for (int i = 0; i < N_KEYS; i++) out->cells[i] = out->text[i];
}

/* s; a kernel takes about 0.5 us, and an image of finer has 14 n^(1/3) of them a ray. */
static double expect(const bench *b, const cost *c)
{
    const double kernels = 14 * cbrt((double)(c->water == SSFR_WATER_FINER ? c->particles : 4096));
    const double rays = 1280.0 * 720 / (c->every * c->every);
    return 5e-7 * kernels * rays * (c->every > 1 && !b->quick ? 4 : 1) / c->threads;
}

static void tick(void *user, double share)
{
    const bench *b = user;
    if (b->total > 0)
        ssfr_console_progress("bench truth", (size_t)fmin(100 * (b->done + b->expected * share) / b->total, 99), 100);
}

/* Until there are enough runs; all are of the same rays. */
static ssfr_result time_runs(bench *b, const cost *c, const ssfr_continuum *fluid, const ssfr_camera *camera,
                             ssfr_rays_tally *tally, ssfr_timing *timing)
{
    ssfr_result result = SSFR_OK;
    const ssfr_measure_options m = ssfr_measure_defaults(true);
    const bool once = c->every == 1 || b->quick;
    const size_t least = once ? 1 : m.min_runs;
    const double seconds = once ? 0 : m.min_seconds;
    double samples[MAX_RUNS], work[2 * MAX_RUNS], sum = 0;
    size_t n = 0;
    while (n < MAX_RUNS && (n < least || sum < seconds)) {
        const double begun = ssfr_clock();
        SSFR_TRY(ssfr_rays_cast(fluid, camera, c->every, b->seed, n == 0 ? tick : NULL, b, tally));
        samples[n] = 1e3 * (ssfr_clock() - begun);
        sum += 1e-3 * samples[n++];
    }
    *timing = ssfr_timing_of(samples, 1, n, work);
end:
    return result;
}

static ssfr_result add_row(bench *b, const cost *c, const ssfr_particles *particles, const ssfr_continuum *fluid,
                           double build, const ssfr_rays_tally *t, const ssfr_timing *ms)
{
    key k;
    const double rays = (double)t->rays, covered = (double)t->covered, pixels = 1280.0 * 720;
    const double busy = t->seconds[0] + t->seconds[1] + t->seconds[2], ray = 1e6 * busy / covered;
    const double numbers[] = {(double)particles->n,
                              particles->radius,
                              rays,
                              c->every == 1,
                              covered / rays,
                              (double)t->kernels / covered,
                              (double)t->crossings / covered,
                              (double)t->touches / rays,
                              (double)t->evaluations / covered,
                              (double)ms->n,
                              ms->min,
                              ms->median,
                              ms->mad,
                              1e3 * rays / ms->median,
                              ray,
                              1e3 * ray * covered / (double)t->kernels,
                              t->seconds[0] / busy,
                              t->seconds[1] / busy,
                              t->seconds[2] / busy,
                              1e-3 * ms->median * pixels / rays,
                              (double)ssfr_continuum_bytes(fluid) / (double)particles->n,
                              build};
    name(&k, c);
    _Static_assert(SSFR_COUNT(numbers) == SSFR_COUNT(columns) - N_KEYS - 1, "a number for each column");
    return ssfr_ledger_add(&b->table, k.cells, "ok", numbers);
}

static ssfr_result measure(bench *b, const cost *c)
{
    ssfr_result result = SSFR_OK;
    ssfr_continuum_params params;
    ssfr_continuum fluid = {0};
    ssfr_water water = {0};
    ssfr_rays_tally tally;
    ssfr_timing timing;
    ssfr_params_default(ssfr_continuum_rows, &params);
    params.kind = (int)c->continuum;
    omp_set_num_threads(c->threads);
    SSFR_TRY(ssfr_water_create(&water, c->water, c->particles));
    const double begun = ssfr_clock();
    SSFR_TRY(ssfr_continuum_init(&fluid, water.particles, &params, NULL));
    const double build = ssfr_clock() - begun;
    SSFR_TRY(time_runs(b, c, &fluid, &water.camera, &tally, &timing));
    SSFR_TRY(add_row(b, c, water.particles, &fluid, build, &tally, &timing));
end:
    omp_set_num_threads(b->max_threads);
    ssfr_continuum_finish(&fluid);
    ssfr_water_finish(&water);
    return result;
}

/* Where it fails a row says why, and the bench goes on, unless it was interrupted. */
static ssfr_result visit(bench *b, const cost *c)
{
    ssfr_result result = SSFR_OK;
    key k;
    char error[SSFR_CAPTURE_SIZE];
    name(&k, c);
    if (c->particles > b->max_particles || ssfr_ledger_has(&b->table, k.cells)) return SSFR_OK;
    b->expected = expect(b, c);
    if (b->counting) {
        b->total += b->expected;
        return SSFR_OK;
    }
    tick(b, 0);
    ssfr_capture_begin("bench");
    result = measure(b, c);
    ssfr_capture_end(error);
    b->done += b->expected;
    if (result == SSFR_OK) return SSFR_OK;
    if (ssfr_interrupt_came()) return ssfr_ledger_interrupted(&b->table);
    return ssfr_ledger_add(&b->table, k.cells, error[0] ? error : ssfr_result_text(result), NULL);
}

/* Where n particles are cast whole: by all threads, for the density, which is what the aim was set for. */
static int every_of(const bench *b, ssfr_waters water, ssfr_continuum_kind kind, size_t n, int threads)
{
    enum { WHOLE = 65536, EVERY = 16 /* 3600 rays */, QUICK = 64 };
    if (b->quick) return QUICK;
    return water == SSFR_WATER_FINER && kind == SSFR_CONTINUUM_DENSITY && n == WHOLE && threads == b->max_threads ? 1
                                                                                                          : EVERY;
}

static ssfr_result visit_all(bench *b, bool counting)
{
    static const size_t sizes[] = {4096, 65536, 1048576}, quick_sizes[] = {1000, 4096};
    ssfr_result result = SSFR_OK;
    const size_t *counts = b->quick ? quick_sizes : sizes;
    const size_t n_counts = b->quick ? SSFR_COUNT(quick_sizes) : SSFR_COUNT(sizes);
    b->counting = counting;
    for (int water = 0; water < SSFR_N_WATERS; water++)
        for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
            if (water == SSFR_WATER_WIDER && kind != SSFR_CONTINUUM_DENSITY) continue; /* one tells it */
            for (size_t i = 0; i < n_counts; i++)
                for (int threads = 1; threads; threads = threads < b->max_threads ? b->max_threads : 0) {
                    cost c = {(ssfr_waters)water, (ssfr_continuum_kind)kind, counts[i], threads, 0};
                    c.every = every_of(b, c.water, c.continuum, c.particles, threads);
                    SSFR_TRY(visit(b, &c));
                }
        }
end:
    if (!counting) ssfr_console_progress("bench truth", 100, 100);
    return result;
}

/* ---- for programs ------------------------------------------------------------------------------------------------ */

typedef struct command {
    words words;
    ssfr_command_line line;
    int argc;
    char **argv;
    bench bench;
} command;

/* Rows of another length must not stand in one table. */
static uint64_t identity_of(const command *c)
{
    char text[128];
    snprintf(text, sizeof text, "bench truth %d %d %d %ld", SSFR_TRUTH_VERSION, c->bench.max_threads, c->bench.quick,
             c->line.seed);
    return ssfr_hash_text(ssfr_meta_hash(), text);
}

static ssfr_result record_parameters(ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    ssfr_continuum_params fluid;
    ssfr_anisotropy_params anisotropy;
    ssfr_params_default(ssfr_continuum_rows, &fluid);
    ssfr_params_default(ssfr_anisotropy_rows, &anisotropy);
    SSFR_TRY(ssfr_record_params(record, "truth", ssfr_continuum_rows + 1, &fluid)); /* the first, kind, is a column */
    SSFR_TRY(ssfr_record_params(record, "anisotropy", ssfr_anisotropy_rows, &anisotropy));
    SSFR_TRY(ssfr_record_number(record, "truth.version", SSFR_TRUTH_VERSION));
end:
    return result;
}

static ssfr_result save_meta(const command *c)
{
    ssfr_result result = SSFR_OK;
    ssfr_record parameters = {0}, scenes[SSFR_N_WATERS] = {{0}};
    SSFR_TRY(record_parameters(&parameters));
    for (int i = 0; i < SSFR_N_WATERS; i++) {
        SSFR_TRY(ssfr_record_text(&scenes[i], "scene", ssfr_water_names[i]));
        SSFR_TRY(ssfr_record_text(&scenes[i], "water", ssfr_water_help[i]));
    }
    SSFR_TRY(ssfr_meta_save(c->words.output, &(ssfr_meta){.argc = c->argc,
                                                          .argv = c->argv,
                                                          .seed = c->line.seed,
                                                          .identity = identity_of(c),
                                                          .parameters = &parameters,
                                                          .n_columns = SSFR_COUNT(columns),
                                                          .columns = columns,
                                                          .n_scenes = SSFR_N_WATERS,
                                                          .scenes = scenes,
                                                          .bandwidth_gl = NAN,
                                                          .bandwidth_cpu = NAN}));
end:
    ssfr_record_finish(&parameters);
    for (int i = 0; i < SSFR_N_WATERS; i++) ssfr_record_finish(&scenes[i]);
    return result;
}

static ssfr_result begin_table(command *c)
{
    ssfr_result result = SSFR_OK;
    bool resumed;
    if (c->words.output) SSFR_TRY(ssfr_output_check_file(c->words.output));
    SSFR_TRY(ssfr_ledger_begin(&c->bench.table, c->words.output, SSFR_COUNT(columns), columns, N_KEYS, c->words.resume,
                               &resumed));
    if (resumed) SSFR_TRY(ssfr_meta_check(c->words.output, identity_of(c)));
    if (c->words.output) SSFR_TRY(save_meta(c));
end:
    return result;
}

/* An `only` without a cell is the number of all threads. */
static ssfr_result draw(const command *c)
{
    ssfr_panel own[SSFR_COUNT(panels)];
    char threads[16];
    snprintf(threads, sizeof threads, "%d", c->bench.max_threads);
    memcpy(own, panels, sizeof own);
    ssfr_panels_fill(SSFR_COUNT(own), own, threads);
    return ssfr_shown_draw(&c->bench.table, c->words.output, "What ground truth costs", SSFR_COUNT(own), own);
}

static ssfr_result run(command *c)
{
    ssfr_result result = SSFR_OK;
    c->bench.quick = c->words.quick;
    c->bench.max_particles = (size_t)c->words.max_particles;
    c->bench.max_threads = omp_get_max_threads();
    c->bench.seed = (uint64_t)c->line.seed;
    SSFR_TRY(begin_table(c));
    SSFR_TRY(visit_all(&c->bench, true));
    ssfr_interrupt_begin();
    result = visit_all(&c->bench, false);
    ssfr_interrupt_end();
    if (result != SSFR_OK) goto end;
    SSFR_TRY(ssfr_shown_print(&c->bench.table, "Rays:", NULL, shown, SSFR_COUNT(shown)));
    if (c->words.output && !c->words.no_plot) SSFR_TRY(draw(c));
end:
    return result;
}

int ssfr_bench_truth(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    command c = {.argc = argc, .argv = argv, .words = {.max_particles = 1048576}};
    const ssfr_option_set sets[] = {{"bench truth", rows, &c.words}, {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = "bench truth",
        .arguments = "",
        .sets = sets,
        .help = "Measures what ground truth costs: rays a second, for what each continuum is, against the number of "
                "particles and what a ray crosses of them; with all threads and with one."};
    SSFR_TRY(ssfr_options_parse(&c.line, &usage, argc - 1, argv + 1));
    if (c.line.help) goto end;
    SSFR_TRY(ssfr_output_check_resume(c.words.resume, c.words.output));
    SSFR_TRY(run(&c));
end:
    ssfr_ledger_finish(&c.bench.table);
    return ssfr_exit_status(result);
}

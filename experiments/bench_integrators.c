/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_integrators.c: `ssfr bench integrators`: its options, table, metadata and chart. */
#include "experiments/bench_integrators.h"
#include "experiments/capture.h"
#include "experiments/command.h"
#include "experiments/interrupt.h"
#include "experiments/ledger.h"
#include "experiments/meta.h"
#include "experiments/output.h"
#include "experiments/shown.h"

#include "base/param.h"

static const double aim = 1e-6; /* largest error that printed settings may have; the table has all */

typedef struct words {
    const char *output;
    bool resume, no_plot;
} words;

#define ROW(...) SSFR_OPTION(words, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(output, "output", 'o', TEXT, "FILE.csv", "write the table as CSV too, with its .meta.json and .svg beside it",
        0, 0),
    ROW(resume, "resume", 0, FLAG, NULL, "go on with FILE.csv: keep its rows, make those that it lacks", 0, 0),
    ROW(no_plot, "no-plot", 0, FLAG, NULL, "draw no chart", 0, 0),
    SSFR_OPTION_END,
};

static const ssfr_column columns[] = {
    {"scene", "1", 0, "whose rays"},
    {"integral", "1", 0, "density: rho over rest density along the ray, in particle diameters; radiance: of spray, "
                         "foam and bubbles, the brightest of three channels, light = 1"},
    {"rays", "1", 0, "which rays, as the study calls them"},
    {"integrator", "1", 0, "the rule"},
    {"setting", "1", 0, "relative tolerance of qags, qagp, cquad, and of chords where a rule is needed; points a "
                        "piece of gauss; steps; - for none"},
    {"status", "1", 0, "ok, or why it failed"},
    {"n_rays", "1", 0, "rays"},
    {"kernels", "1", 0, "that a ray meets, mean"},
    {"value", "1", 0, "of the integral, mean"},
    {"us_median", "us", -1, "time of an integral with its break points, without gathering kernels: median over the "
                            "rays of each one's median"},
    {"us_mad", "us", -1, "median absolute deviation of the rays' medians"},
    {"us_min", "us", -1, "least of the rays' medians"},
    {"runs", "1", 0, "timed integrals of all rays"},
    {"us_gathering", "us", -1, "time of gathering the kernels along a ray, once: median over the rays"},
    {"evaluations", "1", -1, "of the integrand, mean"},
    {"error_max", "1", -1, "largest difference to the reference, or the reference's own error or 2.2e-16 where that is "
                           "more"},
    {"error_median", "1", -1, "median of the same"},
    {"claimed_max", "1", 0, "largest error that the rule itself tells of"},
    {"claimed_median", "1", 0, "median of the same"},
    {"exceeded", "1", -1, "share of the rays whose error is above what the rule claims and the reference's own"},
    {"reference_err", "1", 0, "the reference's own error, largest: of the density the closed form's difference to "
                              "GSL's sum of each kernel by itself, of the radiance qagp's to cquad, both at 1e-14"},
};
enum { N_KEYS = 5, N_COLUMNS = SSFR_COUNT(columns), N_NUMBERS = N_COLUMNS - N_KEYS - 1 };

/* ---- what is to be measured -------------------------------------------------------------------------------------- */

typedef struct place { /* a row of the table */
    size_t scene;
    ssfr_study_integral integral;
    size_t kind;
    ssfr_integrator_id id;
    double setting;
} place;

/* What rows that follow each other have in common, made when the first of them is to be measured. */
typedef enum level { SCENE, CANDIDATES, RAYS, N_LEVELS } level;

typedef struct bench {
    words words;
    ssfr_command_line line;
    int argc;
    char **argv;
    ssfr_study study;
    char *text; /* of the study */
    ssfr_ledger table;
    size_t n_missing; /* rows */
    place *missing;
    ssfr_study_scene scene;
    size_t n_candidates, n_rays;
    ssfr_study_ray *candidates;
    ssfr_study_ray rays[SSFR_STUDY_RAYS];
    char why[N_LEVELS][SSFR_CAPTURE_SIZE]; /* it could not be made; "" when it could */
} bench;

typedef struct key {
    char setting[32];
    const char *cells[N_KEYS];
} key;

static void key_of(const bench *b, const place *at, key *out)
{
    if (isnan(at->setting))
        strcpy(out->setting, "-");
    else
        snprintf(out->setting, sizeof out->setting, "%g", at->setting);
    out->cells[0] = b->study.scenes[at->scene];
    out->cells[1] = ssfr_study_integrals[at->integral];
    out->cells[2] = b->study.kinds[at->integral][at->kind].name;
    out->cells[3] = ssfr_integrators[at->id].name;
    out->cells[4] = out->setting;
}

/* All settings of one rule for one kind of rays; only counts them where there is no array yet. */
static void list_settings(bench *b, place at)
{
    const ssfr_study_numbers settings = ssfr_study_settings(&b->study, at.integral, at.id);
    for (size_t i = 0; i < settings.n; i++) {
        key k;
        at.setting = settings.values[i];
        key_of(b, &at, &k);
        if (ssfr_ledger_has(&b->table, k.cells)) continue;
        if (b->missing) b->missing[b->n_missing] = at;
        b->n_missing++;
    }
}

static void list_rows(bench *b)
{
    b->n_missing = 0;
    for (size_t scene = 0; scene < b->study.n_scenes; scene++)
        for (int integral = 0; integral < SSFR_N_STUDY_INTEGRALS; integral++)
            for (size_t kind = 0; kind < b->study.n_kinds[integral]; kind++)
                for (int id = 0; id < SSFR_N_INTEGRATORS; id++)
                    if (b->study.integrators[id])
                        list_settings(b, (place){.scene = scene, .integral = (ssfr_study_integral)integral,
                                                 .kind = kind, .id = (ssfr_integrator_id)id});
}

/* ---- measuring it ------------------------------------------------------------------------------------------------ */

static ssfr_result prepare(bench *b, const place *at, level what)
{
    ssfr_result result = SSFR_OK;
    const uint64_t seed = (uint64_t)b->line.seed;
    switch (what) {
    case SCENE:
        ssfr_study_scene_finish(&b->scene);
        return ssfr_study_scene_init(&b->scene, &b->study, b->study.scenes[at->scene], seed);
    case CANDIDATES:
        free(b->candidates);
        return ssfr_study_survey(&b->scene, &b->study, at->integral, seed, &b->n_candidates, &b->candidates);
    default:
        SSFR_TRY(ssfr_study_choose(&b->study.kinds[at->integral][at->kind], b->n_candidates, b->candidates, &b->n_rays,
                                   b->rays));
        for (size_t i = 0; i < b->n_rays && result == SSFR_OK; i++)
            result = ssfr_study_refer(&b->scene, at->integral, &b->rays[i]);
    }
end:
    return result;
}

/* The outermost level at which two rows differ. */
static level first_new(const place *before, const place *at)
{
    if (!before || before->scene != at->scene) return SCENE;
    if (before->integral != at->integral) return CANDIDATES;
    return before->kind != at->kind ? RAYS : N_LEVELS;
}

static void prepare_all(bench *b, const place *before, const place *at)
{
    for (level what = first_new(before, at); what < N_LEVELS; what++) {
        if (what > SCENE && b->why[what - 1][0]) {
            memcpy(b->why[what], b->why[what - 1], sizeof b->why[what]);
            continue;
        }
        ssfr_capture_begin("bench");
        const ssfr_result result = prepare(b, at, what);
        ssfr_capture_end(b->why[what]);
        if (result != SSFR_OK && !b->why[what][0]) strcpy(b->why[what], ssfr_result_text(result));
    }
}

static ssfr_result add_row(bench *b, const place *at, const char *status, const ssfr_study_row *r)
{
    const double numbers[N_NUMBERS] = {(double)r->rays, r->kernels, r->value, r->time.median, r->time.mad, r->time.min,
                                       (double)r->runs, r->gathering, r->evaluations, r->error_max, r->error_median,
                                       r->claimed_max, r->claimed_median, r->exceeded, r->reference_err};
    key k;
    key_of(b, at, &k);
    return ssfr_ledger_add(&b->table, k.cells, status, strcmp(status, "ok") == 0 ? numbers : NULL);
}

/* Where the row cannot be measured it says why, and the bench goes on. */
static ssfr_result measure_row(bench *b, const place *before, const place *at)
{
    char error[SSFR_CAPTURE_SIZE];
    ssfr_study_row row = {0};
    prepare_all(b, before, at);
    if (b->why[RAYS][0]) return add_row(b, at, b->why[RAYS], &row);
    ssfr_capture_begin("bench");
    const ssfr_result result =
        ssfr_study_measure(&b->scene, at->integral, b->n_rays, b->rays, at->id, at->setting, &row);
    ssfr_capture_end(error);
    return add_row(b, at, result == SSFR_OK ? "ok" : error[0] ? error : ssfr_result_text(result), &row);
}

static ssfr_result measure_rows(bench *b)
{
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < b->n_missing; i++) {
        ssfr_console_progress("bench integrators", i, b->n_missing);
        SSFR_TRY(measure_row(b, i > 0 ? &b->missing[i - 1] : NULL, &b->missing[i]));
        if (ssfr_interrupt_came() && i + 1 < b->n_missing)
            SSFR_TRY(ssfr_ledger_interrupted(&b->table));
    }
end:
    ssfr_console_progress("bench integrators", 1, 1);
    return result;
}

/* ---- for people -------------------------------------------------------------------------------------------------- */

static double cell(const ssfr_csv_table *t, size_t row, const char *column)
{
    return ssfr_csv_cell_number(t, row, ssfr_csv_column(t, column));
}

/* Of the rows of one rule that begin there: the fastest that reaches the aim, else the most exact. */
static size_t best_of(const ssfr_csv_table *t, size_t begin, size_t end)
{
    size_t best = begin;
    for (size_t row = begin + 1; row < end; row++) {
        const double error = cell(t, row, "error_max"), so_far = cell(t, best, "error_max");
        const bool faster = cell(t, row, "us_median") < cell(t, best, "us_median");
        if (so_far <= aim ? error <= aim && faster : !(error >= so_far)) best = row;
    }
    return best;
}

/* Rows of one rule follow each other, but for those that a resumed table lacked. */
static bool is_best(const ssfr_csv_table *t, size_t row)
{
    size_t begin = row, end = row + 1;
    while (begin > 0 && ssfr_csv_same_cells(t, begin - 1, row, N_KEYS - 1)) begin--;
    while (end < t->n_rows && ssfr_csv_same_cells(t, end, row, N_KEYS - 1)) end++;
    return best_of(t, begin, end) == row;
}

static ssfr_result print_table(const bench *b)
{
    static const ssfr_shown best_shown[] = {
        {"scene", "scene", NULL, 0}, {"integral", "integral", NULL, 0}, {"rays", "rays", NULL, 0},
        {"integrator", "integrator", NULL, 0}, {"setting", "setting", NULL, 0}, {"error_max", "error", "%.1e", 1},
        {"claimed_max", "claimed", "%.1e", 1}, {"exceeded", "% exceed it", "%.0f", 100}, {"us_median", "us", "%.2f", 1},
        {"us_mad", "MAD", "%.2f", 1}, {"n_rays", "n", NULL, 0}, {"evaluations", "calls", "%.0f", 1},
        {"kernels", "kernels", "%.0f", 1}, {"status", "status", NULL, 0}};
    char title[128];
    snprintf(title, sizeof title, "Of each rule the fastest setting that is wrong by %g at most on every ray, else the "
                                  "most exact:", aim);
    return ssfr_shown_print(&b->table, title, is_best, best_shown, SSFR_COUNT(best_shown));
}

/* ---- for programs ------------------------------------------------------------------------------------------------ */

/* Rows of another study must not stand in one table. */
static uint64_t identity_of(const bench *b)
{
    char text[128];
    snprintf(text, sizeof text, "bench integrators %ld", b->line.seed);
    return ssfr_hash_text(ssfr_hash_text(ssfr_meta_hash(), text), b->text);
}

static ssfr_result save_meta(const bench *b)
{
    ssfr_result result = SSFR_OK;
    ssfr_record parameters = {0}, scenes[SSFR_STUDY_SCENES] = {{0}};
    SSFR_TRY(ssfr_record_text(&parameters, "study", b->text));
    SSFR_TRY(ssfr_record_params(&parameters, "truth", ssfr_continuum_rows, &b->study.fluid));
    SSFR_TRY(ssfr_record_params(&parameters, "extinction", ssfr_extinction_rows, &b->study.extinction));
    for (size_t i = 0; i < b->study.n_scenes; i++) SSFR_TRY(ssfr_record_text(&scenes[i], "scene", b->study.scenes[i]));
    SSFR_TRY(ssfr_meta_save(b->words.output, &(ssfr_meta){.argc = b->argc,
                                                          .argv = b->argv,
                                                          .seed = b->line.seed,
                                                          .identity = identity_of(b),
                                                          .parameters = &parameters,
                                                          .n_columns = N_COLUMNS,
                                                          .columns = columns,
                                                          .n_scenes = (int)b->study.n_scenes,
                                                          .scenes = scenes,
                                                          .bandwidth_gl = NAN,
                                                          .bandwidth_cpu = NAN}));
end:
    ssfr_record_finish(&parameters);
    for (size_t i = 0; i < SSFR_COUNT(scenes); i++) ssfr_record_finish(&scenes[i]);
    return result;
}

static ssfr_result begin_table(bench *b)
{
    ssfr_result result = SSFR_OK;
    bool resumed;
    SSFR_TRY(ssfr_output_check_resume(b->words.resume, b->words.output));
    if (b->words.output) SSFR_TRY(ssfr_output_check_file(b->words.output));
    SSFR_TRY(ssfr_ledger_begin(&b->table, b->words.output, N_COLUMNS, columns, N_KEYS, b->words.resume, &resumed));
    if (resumed) SSFR_TRY(ssfr_meta_check(b->words.output, identity_of(b)));
    if (b->words.output) SSFR_TRY(save_meta(b));
end:
    return result;
}

static bool has_points(const ssfr_csv_table *t, const char *integral, const char *kind)
{
    bool any = false;
    for (size_t row = 0; row < t->n_rows && !any; row++)
        any = strcmp(ssfr_csv_cell(t, row, 1), integral) == 0 && strcmp(ssfr_csv_cell(t, row, 2), kind) == 0 &&
              strcmp(ssfr_csv_cell(t, row, N_KEYS), "ok") == 0;
    return any;
}

/* A panel for each kind of rays that there is. */
static ssfr_result draw(const bench *b)
{
    enum { MOST = SSFR_N_STUDY_INTEGRALS * SSFR_STUDY_KINDS };
    static const char *const what[] = {"integral of density", "radiance"};
    static const char *const x_labels[] = {"largest error, at least the reference's own [particle diameters]",
                                           "largest error, at least the reference's own [light = 1]"};
    const ssfr_csv_table view = ssfr_ledger_view(&b->table);
    ssfr_panel panels[MOST];
    char titles[MOST][128], title[256];
    int n = 0;
    for (int i = 0; i < SSFR_N_STUDY_INTEGRALS; i++)
        for (size_t k = 0; k < b->study.n_kinds[i]; k++) {
            const char *kind = b->study.kinds[i][k].name;
            if (!has_points(&view, ssfr_study_integrals[i], kind)) continue;
            snprintf(titles[n], sizeof titles[n], "%s along %.80s rays", what[i], kind);
            panels[n] = (ssfr_panel){.title = titles[n], .x = "error_max", .y = "us_median", .x_label = x_labels[i],
                                     .y_label = "median time of an integral [us]", .log_x = true, .log_y = true,
                                     .keys = {{"integrator", NULL}, {b->study.n_scenes > 1 ? "scene" : NULL, NULL}},
                                     .only = {{"integral", ssfr_study_integrals[i]}, {"rays", kind}}};
            n++;
        }
    snprintf(title, sizeof title, "%.160s (a sign: one tolerance, number of points or of steps)", b->study.title);
    return n > 0 ? ssfr_shown_draw(&b->table, b->words.output, title, n, panels) : SSFR_OK;
}

static ssfr_result run(bench *b)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(begin_table(b));
    list_rows(b);
    SSFR_TRY(ssfr_alloc(&b->missing, b->n_missing, sizeof *b->missing, "rows to measure"));
    list_rows(b);
    ssfr_interrupt_begin();
    result = measure_rows(b);
    ssfr_interrupt_end();
    if (result != SSFR_OK) goto end;
    SSFR_TRY(print_table(b));
    if (b->words.output && !b->words.no_plot) SSFR_TRY(draw(b));
end:
    return result;
}

static void finish(bench *b)
{
    ssfr_ledger_finish(&b->table);
    ssfr_study_scene_finish(&b->scene);
    ssfr_study_finish(&b->study);
    free(b->candidates);
    free(b->missing);
    free(b->text);
    free(b);
}

int ssfr_bench_integrators(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    bench *b = NULL;
    SSFR_TRY(ssfr_alloc(&b, 1, sizeof *b, "a bench"));
    b->argc = argc, b->argv = argv;
    const ssfr_option_set sets[] = {{"bench integrators", rows, &b->words}, {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = "bench integrators",
        .arguments = "[STUDY.yaml]",
        .max_arguments = 1,
        .sets = sets,
        .help = "Measures what integrals along rays cost for the error that they reach: rule by rule, setting by "
                "setting, along rays of each kind. Without a STUDY.yaml the built-in one, "
                "experiments/truth/integrators.yaml."};
    SSFR_TRY(ssfr_options_parse(&b->line, &usage, argc - 1, argv + 1));
    if (b->line.help) goto end;
    SSFR_TRY(ssfr_study_load(&b->study, b->line.arguments.n ? b->line.arguments.items[0] : NULL, &b->text));
    SSFR_TRY(run(b));
end:
    if (b) finish(b);
    return ssfr_exit_status(result);
}

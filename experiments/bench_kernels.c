/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_kernels.c: square roots from a ramp, thickness of splats against their radius, foam's noise along a row: each
 * beside its exact form, point by point. */
#include "experiments/bench_kernels.h"
#include "experiments/command.h"
#include "experiments/meta.h"
#include "experiments/options.h"
#include "experiments/output.h"
#include "experiments/shown.h"

#include "passes/perlin.h"
#include "passes/root.h"

typedef struct words {
    const char *output;
    bool no_plot;
} words;

#define ROW(...) SSFR_OPTION(words, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(output, "output", 'o', TEXT, "FILE.csv", "write the table as CSV too, beside it .meta.json and .svg", 0, 0),
    ROW(no_plot, "no-plot", 0, FLAG, NULL, "draw no chart", 0, 0),
    SSFR_OPTION_END,
};

/* ---- the table --------------------------------------------------------------------------------------------------- */

enum { N_KEYS = 4 };

static const ssfr_column columns[] = {
    {"figure", "1", 0, "fig4_3: square roots; fig4_13: thickness of a water particle; fig4_15: of a foam particle"},
    {"kernel", "1", 0, "words of root, of thickness.kernel (exponential_r: e^(-2 r), as eq. 3.4 prints it), of "
                       "foam_thickness.noise"},
    {"lifetime", "s", 0, "of the foam particle, whose id is 0; else 0"},
    {"place", "1", 0, "fig4_3: u; fig4_13: r; fig4_15: right on a row an eighth of a radius "
                        "below the middle, in radii"},
    {"status", "1", 0, "ok"},
    {"value", "1", 0, "fig4_3: the root; else thickness over the particle's diameter"},
    {"exact", "1", 0, "fig4_3: sqrt(u); fig4_13: the chord; fig4_15: with noise computed"},
    {"error", "1", 0, "value less exact"},
    {"volume", "1", 0, "of the whole particle over that of its sphere; of fig4_15 the mean over lifetimes"},
};

static const ssfr_panel panels[] = {
    {.title = "Square root from 128 texels", .x = "place", .y = "value", .x_label = "u", .y_label = "root of u",
     .log_x = true, .keys = {{"kernel", NULL}}, .only = {{"figure", "fig4_3"}}},
    {.title = "Its error, which is that of the normal's z", .x = "place", .y = "error", .x_label = "u = 1 - r^2",
     .y_label = "looked up less exact", .log_x = true, .keys = {{"kernel", NULL}},
     .only = {{"figure", "fig4_3"}, {"kernel", "ramp"}, {"kernel", "ramp_printed"}}, .levels = {-0.022, -0.062},
     .level_text = "0.022 and 0.062"},
    {.title = "Splat of water", .x = "place", .y = "value", .x_label = "r", .y_label = "thickness over the diameter",
     .keys = {{"kernel", NULL}}, .only = {{"figure", "fig4_13"}}},
    {.title = "Splat of foam, e^(-2 r^2) times noise, along a row", .x = "place", .y = "value",
     .x_label = "place, in radii", .y_label = "thickness over the diameter",
     .keys = {{"kernel", NULL}, {"lifetime", "lifetime "}},
     .only = {{"figure", "fig4_15"}, {"kernel", "texture"}, {"kernel", "constant"}}},
};

static const ssfr_shown shown[] = {
    {"figure", "figure", NULL, 0}, {"kernel", "kernel", NULL, 0}, {"lifetime", "lifetime s", NULL, 0},
    {"place", "largest error at", "%.5f", 1}, {"error", "error", "%+.5f", 1}, {"volume", "volume", "%.3f", 1}};

/* ---- curves ------------------------------------------------------------------------------------------------------ */

typedef struct bench {
    words words;
    ssfr_command_line line;
    ssfr_ledger table;
    ssfr_texels ramps[2], perlin;
} bench;

typedef struct point {
    const char *figure, *kernel;
    double lifetime, place, value, exact, volume;
} point;

static ssfr_result add_point(bench *b, const point *p)
{
    char lifetime[32], place[32];
    const char *const cells[N_KEYS] = {p->figure, p->kernel, lifetime, place};
    const double numbers[] = {p->value, p->exact, p->value - p->exact, p->volume};
    _Static_assert(SSFR_COUNT(numbers) == SSFR_COUNT(columns) - N_KEYS - 1, "a number for each column");
    snprintf(lifetime, sizeof lifetime, "%g", p->lifetime);
    snprintf(place, sizeof place, "%.9g", p->place);
    return ssfr_ledger_add(&b->table, cells, "ok", numbers);
}

/* Four points a texel: where the ramp is farthest off, at a quarter of the first, is one of them. */
static ssfr_result add_roots(bench *b)
{
    enum { STEPS = 4 * (SSFR_ROOT_TEXELS - 1) };
    ssfr_result result = SSFR_OK;
    const ssfr_texels *const ramps[2] = {&b->ramps[0], &b->ramps[1]};
    for (int root = 0; ssfr_roots[root]; root++)
        for (int i = 0; i <= STEPS; i++) {
            const double u = (double)i / STEPS;
            SSFR_TRY(add_point(b, &(point){"fig4_3", ssfr_roots[root], 0, u, ssfr_root_of(root, ramps, u), sqrt(u),
                                           NAN}));
        }
end:
    return result;
}

/* Over the diameter, at r from the middle. */
static double chord(double r) { return sqrt(1 - r * r); }
static double exponential(double r) { return chord(r) * exp(-2 * r * r); }
static double exponential_r(double r) { return chord(r) * exp(-2 * r); }

/* 3/2 of the integral of 2 r t(r), with r = sin(a), whose chord is cos(a). */
static double volume_of(double (*t)(double))
{
    enum { STEPS = 2000 }; /* the midpoint rule's error is its square's inverse */
    const double step = 0.5 * M_PI / STEPS;
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        const double a = (i + 0.5) * step;
        sum += 2 * sin(a) * cos(a) * t(sin(a)) * step;
    }
    return 1.5 * sum;
}

static ssfr_result add_water(bench *b)
{
    enum { STEPS = 100 };
    static const struct {
        const char *name;
        double (*t)(double);
    } kernels[] = {{"chord", chord}, {"exponential", exponential}, {"exponential_r", exponential_r}};
    ssfr_result result = SSFR_OK;
    for (size_t k = 0; k < SSFR_COUNT(kernels); k++) {
        const double volume = volume_of(kernels[k].t);
        for (int i = 0; i <= STEPS; i++) {
            const double r = (double)i / STEPS;
            SSFR_TRY(add_point(b, &(point){"fig4_13", kernels[k].name, 0, r, kernels[k].t(r), chord(r), volume}));
        }
    }
end:
    return result;
}

/* Noise of foam_thickness, at its default rate; the mean is 1/2 in each of its forms. */
static ssfr_result add_foam_at(bench *b, double lifetime)
{
    enum { STEPS = 128 };
    static const double rate = 0.25 /* periods a second */, below = 0.125 /* radii: amid cells of the noise */;
    ssfr_result result = SSFR_OK;
    const double volume = 0.5 * volume_of(exponential);
    for (int i = 0; i <= STEPS; i++) {
        const double a = (2.0 * i / STEPS - 1) * sqrt(1 - below * below);
        const double place[3] = {0.5 + 0.5 * a, 0.5 + 0.5 * below, lifetime * rate + ssfr_lattice_share(0)};
        const double t = exponential(fmin(hypot(a, below), 1)), exact = t * ssfr_foam_noise(place, 0);
        SSFR_TRY(add_point(b, &(point){"fig4_15", "exact", lifetime, a, exact, exact, volume}));
        SSFR_TRY(add_point(b, &(point){"fig4_15", "texture", lifetime, a, t * ssfr_texels_between(&b->perlin, place, 0),
                                       exact, volume}));
        if (lifetime == 0) SSFR_TRY(add_point(b, &(point){"fig4_15", "constant", 0, a, 0.5 * t, exact, volume}));
    }
end:
    return result;
}

static ssfr_result add_all(bench *b)
{
    static const double lifetimes[] = {0, 0.25, 0.5, 1, 2}; /* s */
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_texels_init(&b->ramps[0], &ssfr_root_ramp));
    SSFR_TRY(ssfr_texels_init(&b->ramps[1], &ssfr_root_ramp_printed));
    SSFR_TRY(ssfr_texels_init(&b->perlin, &ssfr_foam_perlin));
    SSFR_TRY(add_roots(b));
    SSFR_TRY(add_water(b));
    for (size_t i = 0; i < SSFR_COUNT(lifetimes); i++) SSFR_TRY(add_foam_at(b, lifetimes[i]));
end:
    return result;
}

/* Of each curve that is not exact, the row whose error is largest; its rows need not follow each other. */
static bool is_worst(const ssfr_csv_table *t, size_t row)
{
    const int error = ssfr_csv_column(t, "error");
    const double own = fabs(ssfr_csv_cell_number(t, row, error));
    bool worst = own > 0;
    for (size_t i = 0; i < t->n_rows && worst; i++) {
        const double other = fabs(ssfr_csv_cell_number(t, i, error));
        worst = !ssfr_csv_same_cells(t, i, row, N_KEYS - 1) || other < own || (other == own && i >= row);
    }
    return worst;
}

/* ---- for programs ------------------------------------------------------------------------------------------------ */

static ssfr_result save_meta(const bench *b, int argc, char **argv)
{
    return ssfr_meta_save(b->words.output, &(ssfr_meta){.argc = argc,
                                                        .argv = argv,
                                                        .seed = b->line.seed,
                                                        .n_columns = SSFR_COUNT(columns),
                                                        .columns = columns,
                                                        .bandwidth_gl = NAN,
                                                        .bandwidth_cpu = NAN});
}

static ssfr_result run(bench *b, int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    const char *path = b->words.output;
    if (path) SSFR_TRY(ssfr_output_check_file(path));
    SSFR_TRY(ssfr_ledger_begin_aside(&b->table, path, SSFR_COUNT(columns), columns, N_KEYS));
    SSFR_TRY(add_all(b));
    if (path) SSFR_TRY(save_meta(b, argc, argv));
    SSFR_TRY(ssfr_shown_print(&b->table, "Each curve where it is farthest from exact:", is_worst, shown,
                              SSFR_COUNT(shown)));
    if (path && !b->words.no_plot)
        SSFR_TRY(ssfr_shown_draw(&b->table, path, "Roots and kernels of Bagar 2010", SSFR_COUNT(panels), panels));
end:
    return result;
}

int ssfr_bench_kernels(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    bench b = {0};
    const ssfr_option_set sets[] = {{"bench kernels", rows, &b.words}, {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = "bench kernels",
        .arguments = "",
        .sets = sets,
        .help = "Tells what the square-root ramp and the splat kernels of Bagar 2010 (figs 4.3, 4.13 and 4.15) have "
                "beside their exact forms. What they cost is told by 'ssfr bench bagar2010 --set ...'."};
    SSFR_TRY(ssfr_options_parse(&b.line, &usage, argc - 1, argv + 1));
    if (b.line.help) goto end;
    SSFR_TRY(run(&b, argc, argv));
end:
    result = ssfr_ledger_end(&b.table, result);
    for (int i = 0; i < 2; i++) ssfr_texels_finish(&b.ramps[i]);
    ssfr_texels_finish(&b.perlin);
    return ssfr_exit_status(result);
}

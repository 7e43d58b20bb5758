/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_flow.c: `ssfr bench flow`: its options, its two tables, their metadata and charts. */
#include "experiments/bench_flow.h"
#include "experiments/command.h"
#include "experiments/meta.h"
#include "experiments/output.h"
#include "experiments/setup.h"
#include "experiments/shown.h"
#include "experiments/slot_picture.h"

typedef struct words {
    const char *output;
    bool quick, pictures, no_plot;
    ssfr_list views;
    ssfr_bumps_setup bumps;
} words;

#define ROW(...) SSFR_OPTION(words, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(output, "output", 'o', TEXT, "FILE.csv", "write the table as CSV too, beside it .meta.json and .svg", 0, 0),
    ROW(views, "view", 0, LIST, "NAME=SCENE,CAMERA,FRAME",
        "in the place of SCENE: a view of that name; can be repeated, for a table of several", 0, 0),
    ROW(quick, "quick", 0, FLAG, NULL, "without a scene: three distances instead of ten", 0, 0),
    ROW(pictures, "pictures", 0, FLAG, NULL,
        "of views: write FILE_NAME_before.png and _after.png, the magnitude of the mean curvature from 0 to 1 over the "
        "particle radius, and _steps.png, from none to the most that a pixel takes, in false colours",
        0, 0),
    ROW(no_plot, "no-plot", 0, FLAG, NULL, "draw no chart", 0, 0),
    SSFR_OPTION_END,
};
static const ssfr_option plane_rows[] = {
    ROW(bumps.radius, "particle", 0, NUMBER, "M", "radius of a particle, m (default 0.02)", 1e-6, 1e6),
    ROW(bumps.cell, "cell", 0, NUMBER, "C", "eye-space size of a pixel at unit depth (default 0.0023)", 1e-6, 1),
    ROW(bumps.nearest, "nearest", 0, NUMBER, "M", "nearest of the distances, m (default 0.5)", 0.02, 1e6),
    ROW(bumps.iterations, "iterations", 0, INTEGER, "N", "steps where their number is fixed (default 40)", 1, 100000),
    ROW(bumps.paper, "smoothing", 0, NUMBER, "RADII", "r_w of eq. 3.1, in particle radii (default 10)", 1e-3, 1e6),
    ROW(bumps.metres, "width", 0, NUMBER, "RADII", "the width of metres, in particle radii (default 0.5)", 1e-3, 1e6),
    SSFR_OPTION_END,
};

/* ---- the tables -------------------------------------------------------------------------------------------------- */

typedef struct layout {
    const char *title, *chart;
    int n_keys, n_columns, n_shown, n_panels;
    const ssfr_column *columns;
    const ssfr_shown *shown;
    const ssfr_panel *panels;
} layout;

static const ssfr_column plane_columns[] = {
    {"flow", "1", 0, "what is the same at every distance: fixed: the number of steps; paper: steps times distance, "
                     "eq. 3.1; metres: the width; over_depth: the number of steps of -H / |z|"},
    {"distance", "m", 0, "of the plane, which faces the eye"},
    {"period", "radii", 0, "wavelength of the bumps, asked for"},
    {"status", "1", 0, "ok, or why there is nothing"},
    {"wavelength", "m", 0, "of the cosine next to it that the image's border mirrors"},
    {"height", "m", 0, "of the bumps before, from trough to crest"},
    {"residual", "m", 0, "of the bumps after"},
    {"gain", "1", 0, "residual over height"},
    {"gain_predicted", "1", 0, "the same by the steps' own damping of that cosine"},
    {"steps", "1", 0, "taken; of metres the last in part"},
    {"width", "m", 0, "of the smoothing: standard deviation of its kernel, from how all periods are damped"},
    {"width_radii", "radii", 0, "the same in particle radii"},
    {"width_steps", "m", 0, "expected of these steps: sqrt(n dt C |z|)"},
    {"width_rule", "m", 0, "expected of the rule: sqrt(r_w dt) of paper, r_w of metres, sqrt(n dt C) of over_depth"},
    {"reach", "m", 0, "n pixels, which sec. 3.1 takes for the radius"},
};
static const ssfr_shown plane_shown[] = {
    {"flow", "flow", NULL, 0}, {"distance", "m", NULL, 0}, {"steps", "steps", "%.4g", 1},
    {"width", "width m", "%.5f", 1}, {"width_radii", "radii", "%.3f", 1}, {"width_steps", "by steps", "%.5f", 1},
    {"width_rule", "by the rule", "%.5f", 1}, {"reach", "reach m", "%.4f", 1}, {"gain", "left of 8 radii", "%.4f", 1},
    {"gain_predicted", "predicted", "%.4f", 1}};
#define SHOWN_PERIOD "8" /* of the bumps whose rows are printed and drawn against the distance, radii */
#define EVERY_FLOW {{"flow", NULL}}
static const ssfr_panel plane_panels[] = {
    {.title = "Width of the smoothing", .x = "distance", .y = "width_radii", .x_label = "distance [m]",
     .y_label = "standard deviation [particle radii]", .log_x = true, .log_y = true, .keys = EVERY_FLOW,
     .only = {{"period", SHOWN_PERIOD}}},
    {.title = "What is left of bumps of 8 radii", .x = "distance", .y = "gain", .x_label = "distance [m]",
     .y_label = "height after over before", .log_x = true, .keys = EVERY_FLOW, .only = {{"period", SHOWN_PERIOD}}},
    {.title = "Fixed number of steps, at distances in m", .x = "period", .y = "gain",
     .x_label = "wavelength [particle radii]", .y_label = "height after over before", .log_x = true,
     .keys = {{"distance", "at "}}, .only = {{"flow", "fixed"}}},
    {.title = "Steps times distance (eq. 3.1), at distances in m", .x = "period", .y = "gain",
     .x_label = "wavelength [particle radii]", .y_label = "height after over before", .log_x = true,
     .keys = {{"distance", "at "}}, .only = {{"flow", "paper"}}},
};

static const ssfr_column view_columns[] = {
    {"view", "1", 0, "its name, where there are several"},
    {"scene", "1", 0, "what is seen"},
    {"camera", "1", 0, "from where"},
    {"what", "1", 0, "steps: that pixels take, by their depth before the first; range: the fewest and the most of these; "
                     "before, after: mean curvature of the surface there, its magnitude, where no silhouette is in "
                     "the way"},
    {"at", "1", 0, "a number of steps, or a share of the pixels: of range 0, the fewest, and 1, the most"},
    {"status", "1", 0, "ok, or why there is nothing"},
    {"pixels", "1", 0, "that take so many steps; of curvatures all that have one"},
    {"share", "1", 0, "of these pixels: that take so many steps, or whose curvature is at most this"},
    {"steps", "1", 0, "of range"},
    {"curvature", "1/m", 0, "quantile"},
    {"curvature_radii", "1/radii", 0, "the same in particle radii"},
};
static const ssfr_shown view_shown[] = {
    {"view", "view", NULL, 0}, {"what", "what", NULL, 0}, {"at", "at", NULL, 0}, {"pixels", "pixels", NULL, 0}, {"share", "share %", "%.2f", 100},
    {"steps", "steps", "%.0f", 1}, {"curvature", "1/m", "%.4g", 1}, {"curvature_radii", "1/radii", "%.4g", 1}};
static const ssfr_panel view_panels[] = {
    {.title = "Steps", .x = "at", .y = "share", .x_label = "steps that a pixel takes",
     .y_label = "share of the pixels [%]", .y_factor = 100, .keys = {{"view", NULL}, {"camera", NULL}}, .only = {{"what", "steps"}}},
    {.title = "Curvature", .x = "curvature_radii", .y = "share", .x_label = "magnitude of the mean curvature [1/radii]",
     .y_label = "share of the pixels below [%]", .y_factor = 100, .log_x = true, .keys = {{"view", NULL}, {"what", NULL}},
     .only = {{"what", "before"}, {"what", "after"}}},
};

#define LAYOUT(name, keys, title, chart)                                                                      \
    {title, chart, keys, SSFR_COUNT(name##_columns), SSFR_COUNT(name##_shown), SSFR_COUNT(name##_panels), \
     name##_columns, name##_shown, name##_panels}
static const layout plane_layout = LAYOUT(plane, 3, "Widths, and what is left of bumps of 8 particle radii:",
                                          "Curvature flow of bumps on a plane that faces the eye");
static const layout view_layout = LAYOUT(view, 5, "Steps and curvatures of the pixels:",
                                         "Curvature flow: the pixels of a view");

enum { MOST_VIEWS = 32 };

typedef struct command {
    words words;
    ssfr_command_line line;
    int argc;
    char **argv;
    const layout *layout;
    bool is_view;
    char name[64]; /* of the view; empty where there is one alone */
    int n_scenes;
    ssfr_record scenes[MOST_VIEWS];
    ssfr_ledger table;
    ssfr_setup_options setup_options;
    ssfr_stage_options stage_options;
    ssfr_setup setup; /* of a view */
    ssfr_stage *stage;
} command;

/* ---- bumps ------------------------------------------------------------------------------------------------------- */

static ssfr_result add_bumps(command *c, ssfr_bumps_flow flow, const char *distance, const ssfr_bumps *b)
{
    ssfr_result result = SSFR_OK;
    char period[32];
    for (int i = 0; i < SSFR_BUMPS_PERIODS && result == SSFR_OK; i++) {
        const ssfr_bumps_period *p = &b->periods[i];
        const double numbers[] = {p->wavelength, p->height, p->residual, p->gain, p->predicted, b->steps, b->width,
                                  b->width / c->words.bumps.radius, b->by_steps, b->by_rule, b->reach};
        snprintf(period, sizeof period, "%g", ssfr_bumps_periods[i]);
        const char *const keys[] = {ssfr_bumps_flows[flow], distance, period};
        result = ssfr_ledger_add(&c->table, keys, isnan(p->wavelength) ? "shorter than 4 pixels" : "ok", numbers);
    }
    return result;
}

static ssfr_result measure_plane(command *c)
{
    ssfr_result result = SSFR_OK;
    const int stride = c->words.quick ? 4 : 1, n = (SSFR_BUMPS_DISTANCES + stride - 1) / stride;
    ssfr_bumps b;
    for (int flow = 0; flow < SSFR_N_BUMPS_FLOWS; flow++)
        for (int i = 0; i < n; i++) {
            const double distance = ssfr_bumps_distance(&c->words.bumps, i * stride);
            char text[32];
            ssfr_console_progress("bench flow", (size_t)(flow * n + i), (size_t)(SSFR_N_BUMPS_FLOWS * n));
            snprintf(text, sizeof text, "%.6g", distance);
            SSFR_TRY(ssfr_bumps_measure(&c->words.bumps, (ssfr_bumps_flow)flow, distance, &b));
            SSFR_TRY(add_bumps(c, (ssfr_bumps_flow)flow, text, &b));
        }
end:
    ssfr_console_progress("bench flow", 1, 1);
    return result;
}

static bool is_shown_period(const ssfr_csv_table *table, size_t row)
{
    return strcmp(ssfr_csv_cell(table, row, ssfr_csv_column(table, "period")), SHOWN_PERIOD) == 0;
}

/* ---- a view ------------------------------------------------------------------------------------------------------ */

static ssfr_result add_view_row(command *c, const char *what, double at, double pixels, double share, double steps,
                                double curvature)
{
    const ssfr_stage *stage = c->stage;
    char text[32];
    snprintf(text, sizeof text, "%g", at);
    const char *const keys[] = {c->name, stage->name, c->stage_options.camera ? c->stage_options.camera : "", what, text};
    const double numbers[] = {pixels, share, steps, curvature, curvature * stage->particles->radius};
    return ssfr_ledger_add(&c->table, keys, "ok", numbers);
}

static ssfr_result add_steps(command *c, const ssfr_flow_pixels *p)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i <= p->most; i++)
        if (p->counts[i])
            SSFR_TRY(add_view_row(c, "steps", i, (double)p->counts[i], (double)p->counts[i] / (double)p->n, NAN,
                                  NAN));
end:
    return result;
}

/* That any pixel takes. */
static int most_steps(const ssfr_flow_pixels *p)
{
    int most = p->most;
    while (most > 0 && p->counts[most] == 0) most--;
    return most;
}

/* The fewest and the most that any pixel takes. */
static ssfr_result add_range(command *c, const ssfr_flow_pixels *p)
{
    ssfr_result result = SSFR_OK;
    int ends[2] = {0, most_steps(p)};
    while (ends[0] < ends[1] && p->counts[ends[0]] == 0) ends[0]++;
    for (int i = 0; i < 2 && p->n > 0; i++)
        SSFR_TRY(add_view_row(c, "range", i, (double)p->counts[ends[i]], NAN, ends[i], NAN));
end:
    return result;
}

static ssfr_result add_curvatures(command *c, const char *what, const ssfr_flow_curvatures *k)
{
    static const double shares[] = {0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99};
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < SSFR_COUNT(shares) && k->n > 0; i++) {
        const double value = k->values[(size_t)(shares[i] * (double)k->n)];
        SSFR_TRY(add_view_row(c, what, shares[i], (double)k->n, shares[i], NAN, value));
    }
end:
    return result;
}

/* "views_5.1_steps.png" beside views.csv. */
static ssfr_result save_picture(const command *c, const char *what, const ssfr_field *image, const char *unit,
                                double hi)
{
    char end[128];
    char *path = NULL;
    snprintf(end, sizeof end, "%s%s_%s.png", c->name[0] ? "_" : "", c->name, what);
    const ssfr_false_colours colours = {.name = what, .unit = unit, .neutral = NAN, .lo = 0, .hi = hi};
    ssfr_result result = ssfr_meta_path(&path, c->words.output, end);
    if (result == SSFR_OK) result = ssfr_false_colours_save(path, image, &colours);
    free(path);
    return result;
}

static ssfr_result save_pictures(const command *c, const ssfr_flow_pixels *p)
{
    ssfr_result result = SSFR_OK;
    const double most = 1 / c->stage->particles->radius; /* 1/m */
    SSFR_TRY(save_picture(c, "before", p->before.image, "1/m", most));
    SSFR_TRY(save_picture(c, "after", p->after.image, "1/m", most));
    SSFR_TRY(save_picture(c, "steps", p->steps, "", most_steps(p)));
end:
    return result;
}

static ssfr_result look(command *c)
{
    ssfr_result result = SSFR_OK;
    ssfr_flow_pixels p = {0};
    SSFR_TRY(ssfr_graph_run(c->setup.graph, &c->stage->scene, NULL));
    SSFR_TRY(ssfr_flow_look(c->setup.graph, &p));
    SSFR_TRY(add_steps(c, &p));
    SSFR_TRY(add_range(c, &p));
    SSFR_TRY(add_curvatures(c, "before", &p.before));
    SSFR_TRY(add_curvatures(c, "after", &p.after));
    if (c->words.pictures) SSFR_TRY(save_pictures(c, &p));
end:
    ssfr_flow_pixels_finish(&p);
    return result;
}

/* "NAME=SCENE,CAMERA,FRAME": its scene to scene[], which the options' words then point into. */
static ssfr_result split_view(command *c, const char *view, char scene[256])
{
    char frame[16];
    const char form[] = "%63[^=]=%255[^\n]";
    char *camera, *number, *end;
    const bool two = sscanf(view, form, c->name, scene) == 2;
    number = two ? strrchr(scene, ',') : NULL;
    if (number) *number++ = '\0';
    camera = number ? strrchr(scene, ',') : NULL;
    if (camera) *camera++ = '\0';
    c->stage_options.frame = camera ? strtol(number, &end, 10) : -1;
    snprintf(frame, sizeof frame, "%ld", c->stage_options.frame);
    if (!camera || strcmp(frame, number) != 0 || c->stage_options.frame < 0)
        return ssfr_fail(SSFR_ERR_VALUE, "--view %.80s: expected NAME=SCENE,CAMERA,FRAME", view);
    c->stage_options.camera = camera;
    return SSFR_OK;
}

static void close_view(command *c)
{
    ssfr_stage_destroy(&c->stage);
    ssfr_setup_finish(&c->setup);
}

/* A scene's settings are of its views alone: each has a graph of its own. */
static ssfr_result measure_view(command *c, const char *scene)
{
    ssfr_result result = SSFR_OK;
    close_view(c);
    SSFR_TRY(ssfr_setup_init(&c->setup, &c->setup_options, NULL));
    SSFR_TRY(ssfr_stage_create(&c->stage, scene, &c->stage_options));
    SSFR_TRY(ssfr_setup_scene(&c->setup, &c->setup_options, c->stage->description));
    SSFR_TRY(ssfr_meta_record_scene(&c->scenes[c->n_scenes++], c->stage));
    SSFR_TRY(look(c));
end:
    return result;
}

static ssfr_result measure_views(command *c)
{
    ssfr_result result = SSFR_OK;
    const ssfr_list *views = &c->words.views;
    char scene[256];
    if (c->line.arguments.n) SSFR_TRY(measure_view(c, c->line.arguments.items[0]));
    for (int i = 0; i < (int)views->n; i++) {
        ssfr_console_progress("bench flow", (size_t)i, (size_t)views->n);
        SSFR_TRY(split_view(c, views->items[i], scene));
        SSFR_TRY(measure_view(c, scene));
    }
end:
    ssfr_console_progress("bench flow", 1, 1);
    return result;
}

/* All that can be said before long work. */
static ssfr_result check_views(command *c)
{
    ssfr_result result = SSFR_OK;
    const ssfr_list *views = &c->words.views, *scenes = &c->line.arguments;
    ssfr_scene_source source;
    char scene[256];
    c->is_view = views->n > 0 || scenes->n > 0;
    if (c->is_view) c->layout = &view_layout;
    if (views->n > 0 && scenes->n > 0)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: beside --view, which names scenes of its own", scenes->items[0]);
    if (views->n > MOST_VIEWS) return ssfr_fail(SSFR_ERR_VALUE, "--view: %d views, at most %d", (int)views->n, MOST_VIEWS);
    if (c->words.pictures && !(c->is_view && c->words.output))
        return ssfr_fail(SSFR_ERR_VALUE, "--pictures: they are of views, and stand beside -o FILE.csv");
    if (scenes->n) SSFR_TRY(ssfr_scene_find(scenes->items[0], &source));
    for (int i = 0; i < (int)views->n; i++) {
        SSFR_TRY(split_view(c, views->items[i], scene));
        SSFR_TRY(ssfr_scene_find(scene, &source));
    }
end:
    return result;
}

/* ---- both -------------------------------------------------------------------------------------------------------- */

static ssfr_result record_plane(ssfr_record *record, const ssfr_bumps_setup *s)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_record_number(record, "radius [m]", s->radius));
    SSFR_TRY(ssfr_record_number(record, "cell", s->cell));
    SSFR_TRY(ssfr_record_number(record, "nearest [m]", s->nearest));
    SSFR_TRY(ssfr_record_number(record, "iterations", (double)s->iterations));
    SSFR_TRY(ssfr_record_number(record, "smoothing [radii]", s->paper));
    SSFR_TRY(ssfr_record_number(record, "width [radii]", s->metres));
end:
    return result;
}

static ssfr_result save_meta(const command *c)
{
    ssfr_result result = SSFR_OK;
    ssfr_record plane = {0};
    if (!c->is_view) SSFR_TRY(record_plane(&plane, &c->words.bumps));
    SSFR_TRY(ssfr_meta_save(c->words.output, &(ssfr_meta){.argc = c->argc,
                                                          .argv = c->argv,
                                                          .seed = c->line.seed,
                                                          .pipeline = c->is_view ? ssfr_pipeline_name(c->setup.pipeline)
                                                                               : NULL,
                                                          .graph = c->setup.graph,
                                                          .parameters = c->is_view ? NULL : &plane,
                                                          .n_columns = c->layout->n_columns,
                                                          .columns = c->layout->columns,
                                                          .n_scenes = c->n_scenes,
                                                          .scenes = c->scenes,
                                                          .bandwidth_gl = NAN,
                                                          .bandwidth_cpu = NAN}));
end:
    ssfr_record_finish(&plane);
    return result;
}

static ssfr_result run(command *c)
{
    ssfr_result result = SSFR_OK;
    const layout *l = c->layout;
    if (c->words.output) SSFR_TRY(ssfr_output_check_file(c->words.output));
    SSFR_TRY(ssfr_ledger_begin_aside(&c->table, c->words.output, l->n_columns, l->columns, l->n_keys));
    SSFR_TRY(c->is_view ? measure_views(c) : measure_plane(c));
    if (c->words.output) SSFR_TRY(save_meta(c));
    SSFR_TRY(ssfr_shown_print(&c->table, l->title, c->is_view ? NULL : is_shown_period, l->shown, l->n_shown));
    if (c->words.output && !c->words.no_plot)
        SSFR_TRY(ssfr_shown_draw(&c->table, c->words.output, l->chart, l->n_panels, l->panels));
end:
    return result;
}

int ssfr_bench_flow(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    command c = {.argc = argc, .argv = argv, .words = {.bumps = ssfr_bumps_defaults}, .layout = &plane_layout};
    const ssfr_option_set sets[] = {{"bench flow", rows, &c.words},
                                    {"the plane", plane_rows, &c.words},
                                    {"what runs on a scene", ssfr_setup_rows, &c.setup_options},
                                    SSFR_STAGE_SETS(&c.stage_options),
                                    {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = "bench flow",
        .arguments = "[SCENE]",
        .max_arguments = 1,
        .sets = sets,
        .help = "Measures how wide the curvature flows smooth: on a plane with bumps of every wavelength, at ten "
                "distances; or, of a SCENE or several views, how many steps each pixel takes and how curved the "
                "surface is before and after (on the CPU, bagar2010 unless said otherwise)."};
    ssfr_setup_defaults(&c.setup_options);
    ssfr_stage_defaults(&c.stage_options);
    c.setup_options.pipeline = "bagar2010";
    c.setup_options.backend = SSFR_BACKEND_CPU;
    SSFR_TRY(ssfr_options_parse(&c.line, &usage, argc - 1, argv + 1));
    if (c.line.help) goto end;
    c.stage_options.seed = (uint64_t)c.line.seed;
    SSFR_TRY(check_views(&c));
    SSFR_TRY(run(&c));
end:
    result = ssfr_ledger_end(&c.table, result);
    close_view(&c);
    for (int i = 0; i < c.n_scenes; i++) ssfr_record_finish(&c.scenes[i]);
    return ssfr_exit_status(result);
}

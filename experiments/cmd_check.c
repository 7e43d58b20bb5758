/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_check.c: `ssfr check`: both twins of each pass on the same input, and where they differ. */
#include "experiments/capture.h"
#include "experiments/command.h"
#include "experiments/console.h"
#include "experiments/corners.h"
#include "experiments/output.h"
#include "experiments/setup.h"
#include "experiments/stage.h"

#include "base/field.h"
#include "graph/twins.h"

typedef struct check_options {
    ssfr_list scenes, settings;
    const char *dump;
    bool corners;
} check_options;

#define ROW(...) SSFR_OPTION(check_options, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(scenes, "scene", 0, LIST, "SCENE",
        "compare on this scene, with the settings of --set alone; can be repeated (default: sphere, plane, block, "
        "splash)", 0, 0),
    ROW(settings, "set", 's', LIST, "KEY=VALUE",
        "a parameter, as pass.param, or param when a PASS is named; can be repeated", 0, 0),
    ROW(corners, "corners", 0, FLAG, NULL,
        "compare at every word of a choice, every flag, half and twice every number too", 0, 0),
    ROW(dump, "dump", 0, TEXT, "DIR", "write both outputs, their difference, ratio and a map of NaN as EXR files", 0,
        0),
    SSFR_OPTION_END,
};

static const char *const default_scenes[] = {"sphere", "plane", "block", "splash"};

enum { MAX_SETTINGS = SSFR_MAX_LIST + 2, CORNER_SIZE = 256 };

typedef struct check {
    const check_options *o;
    const ssfr_pass *only; /* NULL: all passes */
    ssfr_gl *gl;
    ssfr_table table;
    size_t n_compared, n_failed, n_refused;
} check;

/* ---- settings ---------------------------------------------------------------------------------------------------- */

/* The part of a "pass.param=value" behind the pass, when it is for this pass; else NULL. */
static const char *setting_for(const check *c, const ssfr_pass *pass, const char *setting)
{
    const size_t head = strcspn(setting, ".="), n = strlen(ssfr_pass_name(pass));
    if (setting[head] != '.') return c->only ? setting : NULL;
    return head == n && memcmp(setting, ssfr_pass_name(pass), n) == 0 ? setting + n + 1 : NULL;
}

/* A setting that no pass takes would be ignored. */
static ssfr_result check_settings(const check *c)
{
    for (int i = 0; i < c->o->settings.n; i++) {
        const char *setting = c->o->settings.items[i];
        bool taken = false;
        for (int k = 0; ssfr_pass_at(k); k++)
            if (!c->only || ssfr_pass_at(k) == c->only) taken |= setting_for(c, ssfr_pass_at(k), setting) != NULL;
        if (!taken || !strchr(setting, '='))
            return ssfr_fail(SSFR_ERR_UNKNOWN, "--set %s: expected %s=VALUE", setting,
                             c->only ? "PARAM" : "PASS.PARAM");
    }
    return SSFR_OK;
}

static void collect_settings(const check *c, const ssfr_pass *pass, const char *corner,
                             const char *settings[MAX_SETTINGS])
{
    int n = 0;
    for (int i = 0; i < c->o->settings.n; i++) {
        const char *setting = setting_for(c, pass, c->o->settings.items[i]);
        if (setting) settings[n++] = setting;
    }
    if (corner[0]) settings[n++] = corner;
    settings[n] = NULL;
}

/* ---- dumping ----------------------------------------------------------------------------------------------------- */

enum { MAP_REFERENCE, MAP_MEASURED, MAP_DIFFERENCE, MAP_RATIO, MAP_NAN, N_MAPS };
static const char *const map_names[N_MAPS] = {"reference", "measured", "difference", "ratio", "nan"};

/* Where only one of the twins has a surface there is no difference to draw: NaN. */
static double map_value(int map, double reference, double measured)
{
    const bool both = ssfr_is_surface(reference) && ssfr_is_surface(measured);
    switch (map) {
    case MAP_REFERENCE: return reference;
    case MAP_MEASURED: return measured;
    case MAP_DIFFERENCE: return measured == reference ? 0 : both ? measured - reference : NAN;
    case MAP_RATIO: return measured == reference ? 1 : both ? measured / reference : NAN;
    default: return isfinite(reference) && isfinite(measured) ? 0 : 1;
    }
}

static ssfr_result make_map(ssfr_field **out, const ssfr_twins_row *row, int map)
{
    const ssfr_field *r = row->reference;
    const ssfr_result result = ssfr_field_create(out, r->w, r->h, r->c);
    const size_t n = (size_t)r->w * (size_t)r->h * (size_t)r->c;
    for (size_t i = 0; i < n && result == SSFR_OK; i++)
        (*out)->data[i] = map_value(map, r->data[i], row->measured->data[i]);
    return result;
}

/* "difference", or "difference.R,difference.G,difference.B". */
static void name_channels(const char *name, int channels, char *text, size_t size)
{
    size_t used = 0;
    if (channels == 1) snprintf(text, size, "%s", name);
    for (int k = 0; channels > 1 && k < channels && used < size; k++)
        used += (size_t)snprintf(text + used, size - used, "%s%s.%c", k ? "," : "", name, "RGBA"[k % 4]);
}

static ssfr_result dump(const check *c, const ssfr_twins_row *row, const char *name)
{
    ssfr_result result = SSFR_OK;
    ssfr_layer layers[N_MAPS] = {0};
    char channels[N_MAPS][128], path[1024];
    for (int map = 0; map < N_MAPS; map++) {
        name_channels(map_names[map], row->reference->c, channels[map], sizeof channels[map]);
        layers[map].channels = channels[map];
        SSFR_TRY(make_map(&layers[map].field, row, map));
    }
    if ((size_t)snprintf(path, sizeof path, "%s/%s.exr", c->o->dump, name) >= sizeof path) {
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: the name is too long", c->o->dump);
        goto end;
    }
    result = ssfr_exr_save(path, N_MAPS, layers, 0, NULL);
end:
    for (int map = 0; map < N_MAPS; map++) ssfr_field_destroy(&layers[map].field);
    return result;
}

/* "curvature_flow.smooth.block.iterations=20", with what a path cannot hold replaced. */
static void name_file(const ssfr_pass *pass, const ssfr_twins_row *row, const char *scene, const char *corner,
                      char *text, size_t size)
{
    snprintf(text, size, "%s.%s.%s%s%s", ssfr_pass_name(pass), row->output, scene, corner[0] ? "." : "", corner);
    for (char *at = text; *at; at++)
        if (*at == '/') *at = '_';
}

/* ---- comparing --------------------------------------------------------------------------------------------------- */

static ssfr_result print_row(check *c, const ssfr_pass *pass, const ssfr_twins_row *row, const char *scene,
                             const char *corner)
{
    ssfr_result result = SSFR_OK;
    ssfr_table *t = &c->table;
    SSFR_TRY(ssfr_table_add(t, "%s", ssfr_pass_name(pass)));
    SSFR_TRY(ssfr_table_add(t, "%s", row->output));
    SSFR_TRY(ssfr_table_add(t, "%s", scene));
    SSFR_TRY(ssfr_table_add(t, "%s", corner[0] ? corner : c->o->settings.n ? "as given" : "defaults"));
    SSFR_TRY(ssfr_table_add(t, "%.3g", row->max_abs));
    SSFR_TRY(ssfr_table_add(t, "%.3g + %.3g |cpu|", row->tolerance.abs, row->tolerance.rel));
    SSFR_TRY(ssfr_table_add(t, "%.3g", row->outliers));
    SSFR_TRY(ssfr_table_add(t, "%.3g", row->tolerance.outliers));
    SSFR_TRY(ssfr_table_add(t, "%ld", row->n_nan));
    SSFR_TRY(ssfr_table_add(t, "%s", row->ok ? "ok" : "FAILED"));
end:
    return result;
}

/* A corner that this GPU does not support is no disagreement. */
static ssfr_result compare(check *c, const ssfr_pass *pass, const ssfr_twins *twins, const ssfr_stage *stage,
                           const char *corner)
{
    ssfr_result result = SSFR_OK;
    const char *settings[MAX_SETTINGS];
    ssfr_twins_row outputs[SSFR_MAX_OUTPUTS] = {0};
    char error[SSFR_CAPTURE_SIZE];
    int n = 0;
    collect_settings(c, pass, corner, settings);
    ssfr_capture_begin("check");
    result = ssfr_twins_compare(twins, settings, outputs, &n);
    ssfr_capture_end(error);
    if (result == SSFR_ERR_UNSUPPORTED && corner[0]) {
        c->n_refused++;
        ssfr_log(SSFR_INFO, "%s on %s: %s", ssfr_pass_name(pass), stage->name, error);
        result = SSFR_OK;
    } else if (result != SSFR_OK) {
        ssfr_log(SSFR_ERROR, "%s on %s: %s", ssfr_pass_name(pass), stage->name, error);
    }
    if (result != SSFR_OK) goto end;
    for (int i = 0; i < n; i++) {
        char name[512];
        name_file(pass, &outputs[i], stage->name, corner, name, sizeof name);
        SSFR_TRY(print_row(c, pass, &outputs[i], stage->name, corner));
        if (c->o->dump) SSFR_TRY(dump(c, &outputs[i], name));
        c->n_compared++;
        c->n_failed += !outputs[i].ok;
    }
end:
    ssfr_twins_finish(outputs, n);
    return result;
}

/* At its defaults, and at its corners where they are asked for. */
static ssfr_result check_pass(check *c, const ssfr_pass *pass, const ssfr_stage *stage)
{
    ssfr_result result = SSFR_OK;
    ssfr_twins *twins = NULL;
    char corner[CORNER_SIZE] = "";
    SSFR_TRY(ssfr_twins_create(&twins, pass, &stage->scene, c->gl, NULL));
    for (int k = 0; ssfr_corner_at(pass, k, corner, sizeof corner) && (k == 0 || c->o->corners); k++)
        SSFR_TRY(compare(c, pass, twins, stage, corner));
end:
    ssfr_twins_destroy(&twins);
    return result;
}

/* All passes, or the one named, on one scene. */
static ssfr_result check_scene(check *c, const char *scene, const ssfr_stage_options *options, size_t done,
                               size_t total)
{
    ssfr_result result = SSFR_OK;
    ssfr_stage *stage = NULL;
    SSFR_TRY(ssfr_stage_create(&stage, scene, options));
    for (int i = 0; ssfr_pass_at(i); i++) {
        const ssfr_pass *pass = ssfr_pass_at(i);
        if ((c->only && pass != c->only) || pass->particles_run) continue; /* these have one form for both */
        ssfr_console_progress("check", done++, total);
        SSFR_TRY(check_pass(c, pass, stage));
    }
end:
    ssfr_stage_destroy(&stage);
    return result;
}

static ssfr_result run(check *c, const ssfr_stage_options *options)
{
    static const char *const titles[] = {"pass",     "output",  "scene",   "settings",   "max difference",
                                         "tolerance", "outliers", "allowed", "not finite", "result"};
    ssfr_result result = SSFR_OK;
    const bool given = c->o->scenes.n > 0;
    const int n = given ? c->o->scenes.n : (int)SSFR_COUNT(default_scenes);
    size_t n_passes = 0;
    for (int i = 0; ssfr_pass_at(i); i++) n_passes += !c->only || ssfr_pass_at(i) == c->only;
    SSFR_TRY(ssfr_gl_create(&c->gl, SSFR_GL_OWN));
    SSFR_TRY(ssfr_table_row(&c->table, titles));
    for (int i = 0; i < n; i++)
        SSFR_TRY(check_scene(c, given ? c->o->scenes.items[i] : default_scenes[i], options, (size_t)i * n_passes,
                             (size_t)n * n_passes));
end:
    ssfr_console_progress("check", 1, 1);
    if (result == SSFR_OK) {
        ssfr_table_print(&c->table, stdout);
        printf("%zu outputs compared, %zu failed", c->n_compared, c->n_failed);
        if (c->n_refused) printf("; %zu settings that this GPU does not support (--verbose says which)", c->n_refused);
        printf("\n");
    }
    return result;
}

int ssfr_cmd_check(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    check_options options = {0};
    ssfr_stage_options stage_options;
    ssfr_command_line line;
    check c = {.o = &options};
    const ssfr_option_set sets[] = {
        {"check", rows, &options}, SSFR_STAGE_SETS(&stage_options), {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0],
        .arguments = "[PASS]",
        .max_arguments = 1,
        .sets = sets,
        .help = "Runs the GPU and the CPU twin of each pass on the same input and compares their outputs, at "
                "160x90 px unless told otherwise. Exit status 1 when one is outside its tolerance."};
    ssfr_stage_defaults(&stage_options);
    stage_options.size[0] = 160, stage_options.size[1] = 90;
    ssfr_table_init(&c.table, 10);
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    stage_options.seed = (uint64_t)line.seed;
    if (line.arguments.n) SSFR_TRY(ssfr_setup_find_pass(&c.only, line.arguments.items[0]));
    if (c.only && c.only->particles_run)
        SSFR_TRY(ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: works on particles, on the CPU for both backends: it has no twin",
                           c.only->name));
    SSFR_TRY(check_settings(&c));
    if (options.dump) SSFR_TRY(ssfr_output_check_folder(options.dump));
    if (options.dump) SSFR_TRY(ssfr_output_make_folder(options.dump));
    SSFR_TRY(run(&c, &stage_options));
end:
    ssfr_table_finish(&c.table);
    ssfr_gl_destroy(&c.gl);
    return result == SSFR_OK && c.n_failed > 0 ? SSFR_EXIT_FAILED : ssfr_exit_status(result);
}

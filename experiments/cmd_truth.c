/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_truth.c: `ssfr truth`: a scene's ray-cast ground truth, with bounds on its own errors. */
#include "experiments/command.h"
#include "experiments/console.h"
#include "experiments/csv.h"
#include "experiments/output.h"
#include "experiments/param_table.h"
#include "experiments/setup.h"
#include "experiments/truth/estimate.h"
#include "experiments/truth/truth_file.h"

#include "base/param.h"

typedef struct truth_options {
    const char *output, *preview, *frames, *only, *integrator;
    long every;
    bool anew, no_cache, parameters;
    ssfr_list settings;
} truth_options;

#define ROW(...) SSFR_OPTION(truth_options, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(output, "output", 'o', TEXT, "FILE.exr",
        "where to write: Z; N.X,N.Y,N.Z; T; D; F.R,F.G,F.B,F.A; R,G,B; bounds on their errors (Z.err ..)", 0, 0),
    ROW(preview, "preview", 0, TEXT, "FILE.png", "write a picture to look at, too: colour, or else normals", 0, 0),
    ROW(every, "every", 0, INTEGER, "N",
        "cast one pixel of each square of N x N, chosen by --seed, and print 95 % intervals (default 1: all)",
        1, SSFR_MAX_SIZE),
    ROW(only, "only", 0, TEXT, "LIST", "of surface,thickness,foam,colour (default all): the same as truth.parts", 0, 0),
    ROW(integrator, "integrator", 0, TEXT, "NAME",
        "how integrals along a ray are found (default chords): the same as truth.integrator", 0, 0),
    ROW(settings, "set", 's', LIST, "KEY=VALUE", "set a parameter of --parameters; can be repeated", 0, 0),
    ROW(parameters, "parameters", 0, FLAG, NULL, "list all parameters instead", 0, 0),
    ROW(frames, "frames", 0, TEXT, "A:B:STEP",
        "cast these frames, \":\" for all; FILE then has a %d, or %04d, where the number goes", 0, 0),
    ROW(anew, "anew", 0, FLAG, NULL, "cast again what is in the cache", 0, 0),
    ROW(no_cache, "no-cache", 0, FLAG, NULL, "neither read nor write the cache", 0, 0),
    SSFR_OPTION_END,
};

/* One call of the command. */
typedef struct call {
    const truth_options *o;
    const ssfr_stage_options *stage_options;
    const ssfr_command_line *line;
    int argc;
    char **argv;
    ssfr_truth_params params;
    ssfr_stage *stage;
    ssfr_csv *table;
} call;

/* ---- parameters -------------------------------------------------------------------------------------------------- */

static ssfr_result set_one(ssfr_truth_params *params, const char *setting)
{
    char key[256];
    const char *value;
    const ssfr_result result = ssfr_setup_split(setting, key, &value);
    return result == SSFR_OK ? ssfr_truth_set(params, key, value) : result;
}

/* The defaults, the scene's, the user's: the last counts. */
static ssfr_result set_all(ssfr_truth_params *params, const truth_options *o, const ssfr_description *description)
{
    ssfr_result result = SSFR_OK;
    ssfr_truth_defaults(params);
    if (description) SSFR_TRY(ssfr_truth_apply_scene(params, description));
    if (o->only) SSFR_TRY(ssfr_truth_set(params, "truth.parts", o->only));
    if (o->integrator) SSFR_TRY(ssfr_truth_set(params, "truth.integrator", o->integrator));
    for (int i = 0; i < o->settings.n; i++) SSFR_TRY(set_one(params, o->settings.items[i]));
end:
    return result;
}

static ssfr_result list_parameters(const ssfr_truth_params *params)
{
    ssfr_result result = SSFR_OK;
    ssfr_table table;
    const ssfr_param *row;
    const void *group;
    char key[128], value[256];
    SSFR_TRY(ssfr_param_table_begin(&table));
    for (int i = 0; ssfr_truth_key_at(params, i, key, &row, &group); i++) {
        ssfr_param_format(row, group, value, sizeof value);
        SSFR_TRY(ssfr_param_table_add(&table, key, row, value));
    }
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    return result;
}

/* ---- results ----------------------------------------------------------------------------------------------------- */

static ssfr_result open_table(call *c)
{
    static const char *const columns[] = {"frame", "quantity", "unit", "estimate", "low", "high", "n"};
    const int skip = c->o->frames ? 0 : 1;
    return ssfr_csv_create(&c->table, NULL, (int)SSFR_COUNT(columns) - skip, columns + skip, 0, false);
}

static ssfr_result print_estimate(const call *c, const ssfr_estimate *e)
{
    ssfr_result result = SSFR_OK;
    const double numbers[] = {e->value, e->low, e->high, (double)e->n};
    if (c->o->frames) SSFR_TRY(ssfr_csv_number(c->table, (double)c->stage->frame));
    SSFR_TRY(ssfr_csv_text(c->table, e->quantity));
    SSFR_TRY(ssfr_csv_text(c->table, e->unit));
    for (size_t i = 0; i < SSFR_COUNT(numbers); i++) SSFR_TRY(ssfr_csv_number(c->table, numbers[i]));
    SSFR_TRY(ssfr_csv_end_row(c->table));
end:
    return result;
}

static ssfr_result print_estimates(call *c, const ssfr_truth *truth)
{
    ssfr_result result = SSFR_OK;
    ssfr_estimate estimates[SSFR_MAX_ESTIMATES];
    int n = 0;
    SSFR_TRY(ssfr_truth_estimate(truth, estimates, &n));
    if (!c->table) SSFR_TRY(open_table(c));
    for (int i = 0; i < n; i++) SSFR_TRY(print_estimate(c, &estimates[i]));
end:
    return result;
}

/* A lone particle's density is below the level at which a surface is: who looks for it is told. */
static void say_unseen(const ssfr_truth *truth)
{
    const ssfr_field *depth = truth->channels[SSFR_TRUTH_depth], *content = truth->channels[SSFR_TRUTH_content];
    bool seen = !depth || !content, there = false;
    for (size_t i = 0; !seen && i < (size_t)truth->w * (size_t)truth->h; i++) {
        seen = depth->data[i] > -SSFR_SURFACE;
        there = there || content->data[i] > 0;
    }
    if (!seen && there)
        ssfr_log(SSFR_WARNING, "rays cross particles, but no surface: none is as dense as truth.level; "
                               "truth.kind=spheres shows each particle");
}

static void say(const ssfr_truth_stats *s)
{
    const double too_far = 10; /* GSL's estimates are no bounds */
    ssfr_log(SSFR_INFO, "%zu rays, %.3f ms of one core each%s; %zu crossings, %zu touches, of light %zu", s->rays,
             1e3 * s->seconds / (double)(s->rays ? s->rays : 1), s->cached ? " (all from the cache)" : "", s->crossings,
             s->touches, s->light_touches);
    if (s->judged)
        ssfr_log(SSFR_INFO, "%zu closed forms are within %.2g m of GSL's integrals, %.2g of both errors together",
                 s->judged, s->judged_max, s->judged_ratio);
    if (s->judged_ratio > too_far)
        ssfr_log(SSFR_WARNING, "a closed form is %.2g m off GSL's integral, %.3g times what both allow", s->judged_max,
                 s->judged_ratio);
}

static ssfr_result save(const call *c, const ssfr_truth *truth, const char *path)
{
    ssfr_result result = SSFR_OK;
    const ssfr_setup nothing = {0};
    ssfr_record record = {0};
    SSFR_TRY(ssfr_record_program(&record, &nothing, c->line, c->argc, c->argv));
    SSFR_TRY(ssfr_record_stage(&record, c->stage));
    SSFR_TRY(ssfr_truth_record(&record, truth, &c->params));
    SSFR_TRY(ssfr_truth_save(path, truth, &record));
end:
    ssfr_record_finish(&record);
    return result;
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

static ssfr_truth_options options_of(const call *c)
{
    return (ssfr_truth_options){.every = (int)c->o->every, .seed = (uint64_t)c->line->seed,
                                .cache = c->stage_options->cache, .no_cache = c->o->no_cache, .anew = c->o->anew,
                                .progress = true};
}

/* The frame that the stage shows. */
static ssfr_result cast(call *c, const char *output, const char *preview)
{
    ssfr_result result = SSFR_OK;
    const ssfr_truth_options options = options_of(c);
    ssfr_truth *truth = NULL;
    SSFR_TRY(ssfr_truth_create(&truth, c->stage, &c->params, &options));
    say(&truth->stats);
    say_unseen(truth);
    if (output) SSFR_TRY(save(c, truth, output));
    if (preview) SSFR_TRY(ssfr_truth_preview(preview, truth));
    SSFR_TRY(print_estimates(c, truth));
end:
    ssfr_truth_destroy(&truth);
    return result;
}

static ssfr_result cast_numbered(call *c, long frame)
{
    ssfr_result result = SSFR_OK;
    char *output = NULL, *preview = NULL;
    if (c->o->output) SSFR_TRY(ssfr_sequence_path(c->o->output, frame, &output));
    if (c->o->preview) SSFR_TRY(ssfr_sequence_path(c->o->preview, frame, &preview));
    SSFR_TRY(ssfr_stage_show(c->stage, c->stage_options, frame));
    SSFR_TRY(cast(c, output, preview));
end:
    free(output);
    free(preview);
    return result;
}

static ssfr_result cast_frames(call *c)
{
    ssfr_result result = SSFR_OK;
    ssfr_frame_range range;
    long *frames = NULL;
    size_t n = 0;
    SSFR_TRY(ssfr_frame_range_parse(&range, c->o->frames));
    SSFR_TRY(ssfr_stage_choose(c->stage, &range, &n, &frames));
    SSFR_TRY(ssfr_stage_hold(c->stage, c->stage_options, n, frames));
    for (size_t i = 0; i < n; i++) SSFR_TRY(cast_numbered(c, frames[i]));
end:
    free(frames);
    return result;
}

static ssfr_result run(call *c)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_stage_open(&c->stage, c->line->arguments.items[0], c->stage_options));
    SSFR_TRY(set_all(&c->params, c->o, c->stage->description));
    if (!c->o->frames) SSFR_TRY(ssfr_stage_show(c->stage, c->stage_options, -1));
    SSFR_TRY(c->o->frames ? cast_frames(c) : cast(c, c->o->output, c->o->preview));
end:
    return result;
}

/* ---- the command ------------------------------------------------------------------------------------------------- */

static ssfr_result check_name(const char *name, bool numbered, ssfr_output_kind kind, const char *ending)
{
    ssfr_result result = SSFR_OK;
    char *first = NULL; /* of several frames */
    if (!name) return SSFR_OK;
    if (ssfr_output_kind_of(name) != kind)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: the name must end in %s", name, ending);
    if (numbered) SSFR_TRY(ssfr_sequence_path(name, 0, &first));
    SSFR_TRY(ssfr_output_check_file(first ? first : name));
end:
    free(first);
    return result;
}

/* All that can be said before long work. */
static ssfr_result check(const call *c)
{
    ssfr_result result = SSFR_OK;
    ssfr_truth_params params;
    const ssfr_truth_options options = options_of(c);
    if (c->line->arguments.n == 0)
        return ssfr_fail(SSFR_ERR_VALUE, "too few arguments: usage: ssfr truth SCENE [-o FILE.exr]");
    if (c->o->no_cache && c->o->anew)
        return ssfr_fail(SSFR_ERR_VALUE, "--no-cache and --anew: without the cache all is cast anew");
    SSFR_TRY(check_name(c->o->output, c->o->frames, SSFR_OUTPUT_EXR, ".exr"));
    SSFR_TRY(check_name(c->o->preview, c->o->frames, SSFR_OUTPUT_PNG, ".png"));
    SSFR_TRY(set_all(&params, c->o, NULL));
    SSFR_TRY(ssfr_truth_check(&params, &options));
end:
    return result;
}

int ssfr_cmd_truth(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    truth_options options = {.every = 1};
    ssfr_stage_options stage_options;
    ssfr_command_line line;
    call c = {.o = &options, .stage_options = &stage_options, .line = &line, .argc = argc, .argv = argv};
    const ssfr_option_set sets[] = {{"truth", rows, &options}, SSFR_STAGE_SETS(&stage_options), {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0], .arguments = "SCENE [-o FILE.exr]", .max_arguments = 1, .sets = sets,
        .help = "Casts a ray through the middle of each pixel of a scene (see ssfr render --help) into the continuous "
                "fluid that its particles stand for (truth.kind), in double precision, and writes what it meets with "
                "bounds on the error. Prints the means over the image as CSV. Tiles that are done are kept in "
                "DIR/truth of --cache DIR (default: ssfr/truth in $XDG_CACHE_HOME or ~/.cache): the same command goes "
                "on where it was interrupted."};
    ssfr_stage_defaults(&stage_options);
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    stage_options.seed = (uint64_t)line.seed;
    if (options.parameters) {
        SSFR_TRY(set_all(&c.params, &options, NULL));
        SSFR_TRY(list_parameters(&c.params));
        goto end;
    }
    SSFR_TRY(check(&c));
    SSFR_TRY(run(&c));
end:
    ssfr_csv_destroy(&c.table);
    ssfr_stage_destroy(&c.stage);
    return ssfr_exit_status(result);
}

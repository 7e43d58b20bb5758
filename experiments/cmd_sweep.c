/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_sweep.c: `ssfr sweep`: a table of parameters into a CSV. */
#include "experiments/command.h"
#include "experiments/options.h"
#include "experiments/output.h"
#include "experiments/play.h"
#include "experiments/sweep.h"

typedef struct sweep_words {
    const char *output, *scene, *pipeline, *backend, *shard;
    ssfr_list vary, settings, reference;
    bool resume, dry_run, quick, no_plot, no_twin;
    double max_time;
} sweep_words;

#define ROW(...) SSFR_OPTION(sweep_words, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(vary, "vary", 0, LIST, "AXIS",
        "KEY=A,B,C, KEY=LO:HI:STEP or 'KEY=LO:HI:N log'; a parameter, pipeline, variant, scene, camera, view, frame, "
        "size, leave_out, cull or backend; the last given runs fastest",
        0, 0),
    ROW(scene, "scene", 0, TEXT, "SCENE", "the scene (default splash)", 0, 0),
    ROW(pipeline, "pipeline", 'p', TEXT, "NAME", "what to render with (default vanderlaan2009)", 0, 0),
    ROW(backend, "backend", 0, TEXT, "gl,cpu", "OpenGL, the double-precision twins on the CPU, or both (default gl)", 0,
        0),
    ROW(settings, "set", 's', LIST, "KEY=VALUE", "a setting of every run; can be repeated", 0, 0),
    ROW(reference, "reference", 0, LIST, "truth|KEY=VALUE",
        "what the columns ref_ and method_ compare with: the ray-cast truth, or a frame with this setting, made once "
        "by the CPU twins; settings can be repeated",
        0, 0),
    ROW(output, "output", 'o', TEXT, "FILE.csv",
        "the table (default: standard output); FILE.meta.json, FILE.svg and FILE_curves.svg are written beside it", 0,
        0),
    ROW(resume, "resume", 0, FLAG, NULL, "go on with FILE.csv: keep its rows, make those that it lacks", 0, 0),
    ROW(shard, "shard", 0, TEXT, "K/N", "make the K-th of N parts of the runs", 0, 0),
    ROW(dry_run, "dry-run", 0, FLAG, NULL, "check everything and list the runs, but make none", 0, 0),
    ROW(quick, "quick", 0, FLAG, NULL, "3 runs and 0.2 s a row instead of 10 and 1 s", 0, 0),
    ROW(max_time, "max-time", 0, NUMBER, "S",
        "cap the timed frames of a row, and the copies that all are held against, s; one is always timed", 1e-3, 1e6),
    ROW(no_twin, "no-twin", 0, FLAG, NULL,
        "do not compare OpenGL with the CPU twins, which take their time: twin_ and method_ stay empty", 0, 0),
    ROW(no_plot, "no-plot", 0, FLAG, NULL, "do not draw the figures that the SPEC asks for", 0, 0),
    SSFR_OPTION_END,
};

static ssfr_result parse_shard(const char *text, ssfr_sweep_options *o)
{
    char *end = NULL;
    o->shard = o->shards = 1;
    if (!text) return SSFR_OK;
    const long k = strtol(text, &end, 10), n = *end == '/' ? strtol(end + 1, &end, 10) : 0;
    if (text[strspn(text, "0123456789/")] || *end || k < 1 || n < k)
        return ssfr_fail(SSFR_ERR_VALUE, "--shard %s: expected K/N with K from 1 to N", text);
    o->shard = (size_t)k;
    o->shards = (size_t)n;
    return SSFR_OK;
}

static ssfr_result vary_size(ssfr_sweep_spec *spec, const int size[2])
{
    char text[32];
    snprintf(text, sizeof text, "%dx%d", size[0], size[1]);
    return ssfr_sweep_spec_vary(spec, "--size", "size", text);
}

static ssfr_result vary_frame(ssfr_sweep_spec *spec, long frame)
{
    char text[32];
    snprintf(text, sizeof text, "%ld", frame);
    return ssfr_sweep_spec_vary(spec, "--frame", "frame", text);
}

/* What the command line says counts for more than what the file says. */
static ssfr_result merge(ssfr_sweep_spec *spec, const sweep_words *w, const ssfr_stage_options *stage)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < w->vary.n; i++) SSFR_TRY(ssfr_sweep_spec_vary_text(spec, "--vary", w->vary.items[i]));
    for (int i = 0; i < w->settings.n; i++) SSFR_TRY(ssfr_sweep_spec_set_text(spec, "--set", w->settings.items[i]));
    for (int i = 0; i < w->reference.n; i++)
        SSFR_TRY(ssfr_sweep_spec_reference_text(spec, "--reference", w->reference.items[i]));
    if (w->scene) SSFR_TRY(ssfr_sweep_spec_vary(spec, "--scene", "scene", w->scene));
    if (stage->size[0]) SSFR_TRY(vary_size(spec, stage->size));
    if (stage->camera) SSFR_TRY(ssfr_sweep_spec_vary(spec, "--camera", "camera", stage->camera));
    if (stage->frame >= 0) SSFR_TRY(vary_frame(spec, stage->frame));
    if (w->backend) SSFR_TRY(ssfr_sweep_spec_vary(spec, "--backend", "backend", w->backend));
    if (w->pipeline) SSFR_TRY(ssfr_sweep_spec_vary(spec, "--pipeline", "pipeline", w->pipeline));
    SSFR_TRY(ssfr_sweep_spec_complete(spec));
end:
    return result;
}

static ssfr_result check(const sweep_words *w, const ssfr_list *arguments)
{
    if (arguments->n == 0 && w->vary.n == 0)
        return ssfr_fail(SSFR_ERR_VALUE, "nothing to run: give a SPEC.yaml or --vary AXIS");
    return ssfr_output_check_resume(w->resume, w->output);
}

int ssfr_cmd_sweep(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    sweep_words words = {0};
    ssfr_sweep_options options = {0};
    ssfr_sweep_spec *spec = NULL;
    ssfr_published *published = NULL;
    ssfr_command_line line;
    const ssfr_option_set sets[] = {
        {"sweep", rows, &words}, SSFR_STAGE_SETS(&options.stage), SSFR_PLAY_SET(&options.stage), {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0],
        .arguments = "[SPEC.yaml|-]",
        .max_arguments = 1,
        .sets = sets,
        .help = "Runs the product of all axes and writes one row a run: times, work, and errors."};
    ssfr_stage_defaults(&options.stage);
    options.stage.size[0] = 0; /* not given */
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    SSFR_TRY(check(&words, &line.arguments));
    SSFR_TRY(ssfr_play_check(&options.stage));
    SSFR_TRY(parse_shard(words.shard, &options));
    options.stage.seed = (uint64_t)line.seed;
    options.output = words.output, options.max_time = words.max_time;
    options.resume = words.resume, options.dry_run = words.dry_run, options.quick = words.quick;
    options.no_plot = words.no_plot, options.no_twin = words.no_twin;
    options.argc = argc, options.argv = argv, options.seed = line.seed;
    if (line.arguments.n)
        SSFR_TRY(ssfr_sweep_spec_load(&spec, line.arguments.items[0]));
    else
        SSFR_TRY(ssfr_sweep_spec_create(&spec));
    SSFR_TRY(merge(spec, &words, &options.stage));
    if (spec->published.file)
        SSFR_TRY(ssfr_published_load(&published, &spec->published, line.arguments.items[0]));
    options.published = published;
    SSFR_TRY(ssfr_sweep_run(spec, &options));
end:
    ssfr_published_destroy(&published);
    ssfr_sweep_spec_destroy(&spec);
    return ssfr_exit_status(result);
}

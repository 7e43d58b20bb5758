/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_render.c: `ssfr render`: a scene through a pipeline into pictures, or into all of their intermediate images. */
#include "experiments/command.h"
#include "experiments/console.h"
#include "experiments/frame_file.h"
#include "experiments/output.h"
#include "experiments/play.h"
#include "experiments/slot_picture.h"

typedef struct render_options {
    const char *output, *dump, *background, *frames;
    bool keep_all;
    ssfr_slot_picture picture; /* its slot NULL: the frame itself */
} render_options;

#define ROW(...) SSFR_OPTION(render_options, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(output, "output", 'o', TEXT, "FILE",
        "where to write: .exr (R,G,B; Z; N.X,N.Y,N.Z; T; camera and parameters as attributes) or .png", 0, 0),
    ROW(dump, "dump", 0, TEXT, "DIR", "write every slot as DIR/<slot>.exr, and what ran as DIR/graph.json", 0, 0),
    ROW(picture.slot, "slot", 0, TEXT, "NAME",
        "write this intermediate image of one channel to FILE.png, in false colours, in the place of the frame", 0, 0),
    ROW(picture.lo, "from", 0, NUMBER, "X",
        "the slot's value, in its unit, that the colours begin at (default: 2 % of the pixels lie below)", -1e30, 1e30),
    ROW(picture.hi, "to", 0, NUMBER, "X", "where they end (default: 2 % of the pixels lie above)", -1e30, 1e30),
    ROW(frames, "frames", 0, TEXT, "A:B:STEP",
        "render these frames, \":\" for all; FILE and DIR then have a %d, or %04d, where the number goes", 0, 0),
    ROW(background, "background", 0, TEXT, "FILE.exr",
        "a picture of the scene without the fluid: R,G,B, linear, and Z, eye-space depth in m", 0, 0),
    ROW(keep_all, "keep-all", 0, FLAG, NULL, "leave nothing out (the picture must stay the same, bit by bit)", 0, 0),
    SSFR_OPTION_END,
};

/* One call of the command. */
typedef struct render {
    const render_options *o;
    const ssfr_stage_options *stage_options;
    const ssfr_command_line *line;
    int argc;
    char **argv;
    ssfr_setup setup;
    ssfr_stage *stage;
} render;

/* That the pipeline has the slot is known when it is wanted. */
static ssfr_result check_slot(const render_options *options)
{
    const ssfr_slot_picture *p = &options->picture;
    if (!p->slot && !(isnan(p->lo) && isnan(p->hi)))
        return ssfr_fail(SSFR_ERR_VALUE, "--from and --to are of the colours of a --slot");
    if (p->slot && (!options->output || ssfr_output_kind_of(options->output) != SSFR_OUTPUT_PNG))
        return ssfr_fail(SSFR_ERR_VALUE, "--slot %.40s: false colours are a picture: give -o FILE.png", p->slot);
    if (p->lo > p->hi) return ssfr_fail(SSFR_ERR_VALUE, "--from %g is above --to %g", p->lo, p->hi);
    return SSFR_OK;
}

static ssfr_result check(const render_options *options)
{
    ssfr_result result = SSFR_OK;
    char *output = NULL, *dump = NULL; /* of the first frame */
    if (!options->output && !options->dump)
        return ssfr_fail(SSFR_ERR_VALUE, "nothing to write: give -o FILE or --dump DIR");
    SSFR_TRY(check_slot(options));
    if (options->frames && options->output) SSFR_TRY(ssfr_sequence_path(options->output, 0, &output));
    if (options->frames && options->dump) SSFR_TRY(ssfr_sequence_path(options->dump, 0, &dump));
    if (options->output) SSFR_TRY(ssfr_output_check_image(output ? output : options->output, true));
    if (options->dump) SSFR_TRY(ssfr_output_check_folder(dump ? dump : options->dump));
end:
    free(output);
    free(dump);
    return result;
}

/* ---- a frame ----------------------------------------------------------------------------------------------------- */

static ssfr_result prepare(const render *r)
{
    ssfr_result result = SSFR_OK;
    const ssfr_description *d = r->stage->description;
    const char *background = r->o->background ? r->o->background : d ? d->background : NULL;
    const ssfr_output_kind kind = r->o->output ? ssfr_output_kind_of(r->o->output) : SSFR_OUTPUT_OTHER;
    SSFR_TRY(ssfr_setup_background(r->setup.graph, background, &r->stage->scene.camera));
    if (kind == SSFR_OUTPUT_EXR) SSFR_TRY(ssfr_frame_want(&r->setup));
    if (r->o->picture.slot) SSFR_TRY(ssfr_frame_want_slot(r->setup.graph, r->o->picture.slot));
    if (r->o->dump) ssfr_graph_want_all(r->setup.graph, true);
end:
    return result;
}

static ssfr_result save_slot(const render *r, const char *output)
{
    const ssfr_camera *camera = &r->stage->scene.camera;
    ssfr_field *field = NULL;
    ssfr_result result = ssfr_frame_read(&field, r->setup.graph, r->o->picture.slot, camera->w, camera->h);
    if (result == SSFR_OK) result = ssfr_slot_picture_save(output, field, &r->o->picture);
    ssfr_field_destroy(&field);
    return result;
}

static ssfr_result save(const render *r, const char *output, const char *dump, const ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    const ssfr_camera *camera = &r->stage->scene.camera;
    if (output && r->o->picture.slot)
        SSFR_TRY(save_slot(r, output));
    else if (output && ssfr_output_kind_of(output) == SSFR_OUTPUT_PNG)
        SSFR_TRY(ssfr_frame_save_png(output, &r->setup, camera->w, camera->h));
    else if (output)
        SSFR_TRY(ssfr_frame_save_exr(output, &r->setup, camera->w, camera->h, record));
    if (dump) SSFR_TRY(ssfr_frame_dump(dump, &r->setup, camera->w, camera->h, record));
end:
    return result;
}

/* The frame that the stage shows. */
static ssfr_result draw(const render *r, const char *output, const char *dump)
{
    ssfr_result result = SSFR_OK;
    const ssfr_run_options run = {.keep_all = r->o->keep_all, .timing = r->line->verbose || dump};
    ssfr_record record = {0};
    SSFR_TRY(ssfr_graph_run(r->setup.graph, &r->stage->scene, &run));
    ssfr_frame_say(r->setup.graph);
    SSFR_TRY(ssfr_record_program(&record, &r->setup, r->line, r->argc, r->argv));
    SSFR_TRY(ssfr_record_stage(&record, r->stage));
    SSFR_TRY(ssfr_record_graph(&record, r->setup.graph));
    SSFR_TRY(save(r, output, dump, &record));
end:
    ssfr_record_finish(&record);
    return result;
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

/* since: the frame drawn before, -1 for none. */
static ssfr_result draw_numbered(const render *r, long frame, long since)
{
    ssfr_result result = SSFR_OK;
    char *output = NULL, *dump = NULL;
    if (r->o->output) SSFR_TRY(ssfr_sequence_path(r->o->output, frame, &output));
    if (r->o->dump) SSFR_TRY(ssfr_sequence_path(r->o->dump, frame, &dump));
    SSFR_TRY(ssfr_stage_show(r->stage, r->stage_options, frame));
    SSFR_TRY(ssfr_play(r->setup.graph, r->stage, r->stage_options, since));
    SSFR_TRY(draw(r, output, dump));
end:
    free(output);
    free(dump);
    return result;
}

static ssfr_result draw_frames(const render *r)
{
    ssfr_result result = SSFR_OK;
    ssfr_frame_range range;
    long *frames = NULL;
    size_t n = 0;
    SSFR_TRY(ssfr_frame_range_parse(&range, r->o->frames));
    SSFR_TRY(ssfr_stage_choose(r->stage, &range, &n, &frames));
    SSFR_TRY(ssfr_stage_hold(r->stage, r->stage_options, n, frames));
    SSFR_TRY(prepare(r));
    for (size_t i = 0; i < n; i++) {
        ssfr_console_progress("render", i, n);
        SSFR_TRY(draw_numbered(r, frames[i], i ? frames[i - 1] : -1));
    }
end:
    ssfr_console_progress("render", n, n);
    free(frames);
    return result;
}

static ssfr_result draw_one(const render *r)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_stage_show(r->stage, r->stage_options, -1));
    SSFR_TRY(prepare(r));
    SSFR_TRY(ssfr_play(r->setup.graph, r->stage, r->stage_options, -1));
    SSFR_TRY(draw(r, r->o->output, r->o->dump));
end:
    return result;
}

int ssfr_cmd_render(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    render_options options = {.picture = {.lo = NAN, .hi = NAN}};
    ssfr_setup_options setup_options;
    ssfr_stage_options stage_options;
    ssfr_command_line line;
    render r = {.o = &options, .stage_options = &stage_options, .line = &line, .argc = argc, .argv = argv};
    const ssfr_option_set sets[] = {{"render", rows, &options},
                                    {"what runs", ssfr_setup_rows, &setup_options},
                                    SSFR_STAGE_SETS(&stage_options),
                                    SSFR_PLAY_SET(&stage_options),
                                    {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0], .arguments = "SCENE -o FILE|--dump DIR", .min_arguments = 1, .max_arguments = 1,
        .sets = sets,
        .help = "Renders a scene: one that 'ssfr scene list' names, a scene file (.yaml), a file of particles, or a "
                "sequence of such files as one name with a %d ('ssfr scene formats' lists them). Frames of a "
                "simulation that are missing are made first."};
    ssfr_setup_defaults(&setup_options);
    ssfr_stage_defaults(&stage_options);
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    stage_options.seed = (uint64_t)line.seed;
    SSFR_TRY(check(&options));
    SSFR_TRY(ssfr_play_check(&stage_options));
    SSFR_TRY(ssfr_setup_init(&r.setup, &setup_options, NULL));
    SSFR_TRY(ssfr_stage_open(&r.stage, line.arguments.items[0], &stage_options));
    SSFR_TRY(ssfr_setup_scene(&r.setup, &setup_options, r.stage->description));
    SSFR_TRY(options.frames ? draw_frames(&r) : draw_one(&r));
end:
    ssfr_stage_destroy(&r.stage);
    ssfr_setup_finish(&r.setup);
    return ssfr_exit_status(result);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_render.c: `ssfr render`: a scene through a pipeline into a picture, or into all of its intermediate images. */
#include "experiments/command.h"
#include "experiments/frame_file.h"
#include "experiments/output.h"

typedef struct render_options {
    const char *output, *dump, *background;
    bool keep_all;
} render_options;

#define ROW(...) SSFR_OPTION(render_options, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(output, "output", 'o', TEXT, "FILE",
        "where to write: .exr (R,G,B; Z; N.X,N.Y,N.Z; T; camera and parameters as attributes) or .png", 0, 0),
    ROW(dump, "dump", 0, TEXT, "DIR", "write every slot as DIR/<slot>.exr, and what ran as DIR/graph.json", 0, 0),
    ROW(background, "background", 0, TEXT, "FILE.exr",
        "a picture of the scene without the fluid: R,G,B, linear, and Z, eye-space depth in m", 0, 0),
    ROW(keep_all, "keep-all", 0, FLAG, NULL, "leave nothing out (the picture must stay the same, bit by bit)", 0, 0),
    SSFR_OPTION_END,
};

static ssfr_result check(const render_options *options)
{
    ssfr_result result = SSFR_OK;
    if (!options->output && !options->dump)
        return ssfr_fail(SSFR_ERR_VALUE, "nothing to write: give -o FILE or --dump DIR");
    if (options->output) SSFR_TRY(ssfr_output_check_image(options->output, true));
    if (options->dump) SSFR_TRY(ssfr_output_check_folder(options->dump));
end:
    return result;
}

/* The user's image of the scene takes the place of the pipeline's own. */
static ssfr_result import(ssfr_graph *graph, const char *path, const char *slot, const ssfr_camera *camera)
{
    ssfr_field *field = NULL;
    ssfr_result result = ssfr_exr_load(path, ssfr_slot_channels(slot), &field);
    if (result == SSFR_OK && (field->w != camera->w || field->h != camera->h))
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: %dx%d pixels, the image has %dx%d: add --size %dx%d", path, field->w,
                           field->h, camera->w, camera->h, field->w, field->h);
    if (result == SSFR_OK) result = ssfr_graph_import(graph, slot, field);
    ssfr_field_destroy(&field);
    return result;
}

static ssfr_result draw(const ssfr_setup *setup, const ssfr_stage *stage, const render_options *options, bool verbose)
{
    ssfr_result result = SSFR_OK;
    const ssfr_run_options run = {.keep_all = options->keep_all, .timing = verbose || options->dump};
    const ssfr_output_kind kind = options->output ? ssfr_output_kind_of(options->output) : SSFR_OUTPUT_OTHER;
    if (options->background) SSFR_TRY(import(setup->graph, options->background, "scene_color", &stage->scene.camera));
    if (options->background) SSFR_TRY(import(setup->graph, options->background, "scene_depth", &stage->scene.camera));
    if (kind == SSFR_OUTPUT_EXR) SSFR_TRY(ssfr_frame_want(setup));
    if (options->dump) ssfr_graph_want_all(setup->graph, true);
    SSFR_TRY(ssfr_graph_run(setup->graph, &stage->scene, &run));
    ssfr_frame_say(setup->graph);
end:
    return result;
}

static ssfr_result save(const ssfr_setup *setup, const ssfr_stage *stage, const render_options *options,
                        const ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    const ssfr_camera *camera = &stage->scene.camera;
    if (options->output && ssfr_output_kind_of(options->output) == SSFR_OUTPUT_PNG)
        SSFR_TRY(ssfr_frame_save_png(options->output, setup, camera->w, camera->h));
    else if (options->output)
        SSFR_TRY(ssfr_frame_save_exr(options->output, setup, camera->w, camera->h, record));
    if (options->dump) SSFR_TRY(ssfr_frame_dump(options->dump, setup, camera->w, camera->h, record));
end:
    return result;
}

int ssfr_cmd_render(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    render_options options = {0};
    ssfr_setup_options setup_options;
    ssfr_stage_options stage_options;
    ssfr_command_line line;
    ssfr_setup setup = {0};
    ssfr_stage *stage = NULL;
    ssfr_record record = {0};
    const ssfr_option_set sets[] = {{"render", rows, &options},
                                    {"what runs", ssfr_setup_rows, &setup_options},
                                    {"scene and view", ssfr_stage_rows, &stage_options},
                                    {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0], .arguments = "SCENE -o FILE|--dump DIR", .min_arguments = 1, .max_arguments = 1,
        .sets = sets,
        .help = "Renders a scene: a built-in one ('ssfr scene list') or a particle file (.ply, .vtk, .pos, .h5)."};
    ssfr_setup_defaults(&setup_options);
    ssfr_stage_defaults(&stage_options);
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    stage_options.seed = (uint64_t)line.seed;
    SSFR_TRY(check(&options));
    SSFR_TRY(ssfr_setup_init(&setup, &setup_options, NULL));
    SSFR_TRY(ssfr_stage_create(&stage, line.arguments.items[0], &stage_options));
    SSFR_TRY(draw(&setup, stage, &options, line.verbose));
    SSFR_TRY(ssfr_record_program(&record, &setup, &line, argc, argv));
    SSFR_TRY(ssfr_record_stage(&record, stage));
    SSFR_TRY(ssfr_record_graph(&record, setup.graph));
    SSFR_TRY(save(&setup, stage, &options, &record));
end:
    ssfr_record_finish(&record);
    ssfr_stage_destroy(&stage);
    ssfr_setup_finish(&setup);
    return ssfr_exit_status(result);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_scene_import.c: `ssfr scene import`: files of particles from one format to another, with what they lacked. */
#include "experiments/cmd_scene.h"
#include "experiments/console.h"
#include "experiments/output.h"
#include "experiments/stage.h"

typedef struct import_words {
    const char *output, *frames;
    bool as_is;
} import_words;

#define ROW(...) SSFR_OPTION(import_words, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(output, "output", 'o', TEXT, "FILE",
        "where to write; the ending says the format ('ssfr scene formats' lists them)", 0, 0),
    ROW(frames, "frames", 0, TEXT, "A:B:STEP",
        "of a sequence or a simulated scene (default: all); FILE has a %d, or %04d, where the number goes", 0, 0),
    ROW(as_is, "as-is", 0, FLAG, NULL, "do not compute density and neighbours where they are missing", 0, 0),
    SSFR_OPTION_END,
};

/* What was written. */
typedef struct outcome {
    size_t n_files, n_particles;
    unsigned computed; /* bits as of ssfr_particles_complete */
} outcome;

static ssfr_result convert(ssfr_stage *stage, const import_words *words, const char *output, outcome *all)
{
    ssfr_result result = SSFR_OK;
    unsigned computed = 0;
    if (!words->as_is) SSFR_TRY(ssfr_particles_complete(stage->particles, &computed));
    SSFR_TRY(ssfr_particles_save(stage->particles, output));
    all->n_files++;
    all->n_particles += stage->particles->n;
    all->computed |= computed;
end:
    return result;
}

static void tell(const import_words *words, const ssfr_stage *stage, const outcome *all)
{
    printf("%s: ", words->output);
    if (ssfr_sequence_is(words->output)) printf("%zu frames, ", all->n_files);
    else if (stage->frame >= 0) printf("frame %ld, ", stage->frame);
    printf("%zu particles", all->n_particles);
    if (stage->estimate > 0) printf(", radius estimated as %g m", stage->estimate);
    if (all->computed & SSFR_COMPUTED_DENSITY) printf(", density computed");
    if (all->computed & SSFR_COMPUTED_NEIGHBOURS) printf(", neighbours computed");
    printf("\n");
}

static ssfr_result convert_frame(ssfr_stage *stage, const ssfr_stage_options *options, const import_words *words,
                                 long frame, outcome *all)
{
    ssfr_result result = SSFR_OK;
    char *output = NULL;
    SSFR_TRY(ssfr_sequence_path(words->output, frame, &output));
    SSFR_TRY(ssfr_stage_show(stage, options, frame));
    SSFR_TRY(convert(stage, words, output, all));
end:
    free(output);
    return result;
}

static ssfr_result convert_frames(ssfr_stage *stage, const ssfr_stage_options *options, const import_words *words,
                                  outcome *all)
{
    ssfr_result result = SSFR_OK;
    ssfr_frame_range range = ssfr_frame_range_all;
    long *frames = NULL;
    size_t n = 0;
    if (words->frames) SSFR_TRY(ssfr_frame_range_parse(&range, words->frames));
    SSFR_TRY(ssfr_stage_choose(stage, &range, &n, &frames));
    for (size_t i = 0; i < n; i++) {
        ssfr_console_progress("import", i, n);
        SSFR_TRY(convert_frame(stage, options, words, frames[i], all));
    }
end:
    ssfr_console_progress("import", n, n);
    free(frames);
    return result;
}

static ssfr_result check(const import_words *words)
{
    ssfr_result result = SSFR_OK;
    char *first = NULL;
    if (!words->output) return ssfr_fail(SSFR_ERR_VALUE, "nothing to write: give -o FILE");
    if (ssfr_sequence_is(words->output)) SSFR_TRY(ssfr_sequence_path(words->output, 0, &first));
    SSFR_TRY(ssfr_particles_check_name(words->output));
    SSFR_TRY(ssfr_output_check_file(first ? first : words->output));
end:
    free(first);
    return result;
}

static ssfr_result run(const char *scene, const ssfr_stage_options *options, const import_words *words)
{
    ssfr_result result = SSFR_OK;
    ssfr_stage *stage = NULL;
    outcome all = {0};
    SSFR_TRY(check(words));
    SSFR_TRY(ssfr_stage_open(&stage, scene, options));
    if (words->frames || ssfr_sequence_is(words->output)) {
        SSFR_TRY(convert_frames(stage, options, words, &all));
    } else {
        SSFR_TRY(ssfr_stage_show(stage, options, -1));
        SSFR_TRY(convert(stage, words, words->output, &all));
    }
    tell(words, stage, &all);
end:
    ssfr_stage_destroy(&stage);
    return result;
}

ssfr_result ssfr_scene_import(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    import_words words = {0};
    ssfr_stage_options options;
    ssfr_command_line line;
    const ssfr_option_set sets[] = {{"import", rows, &words},
                                    {"particle files", ssfr_file_rows, &options},
                                    {"scene", ssfr_scene_rows, &options},
                                    {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0], .arguments = "SCENE -o FILE", .min_arguments = 1, .max_arguments = 1, .sets = sets,
        .help = "Converts: reads a file of particles, a sequence of them or the frames of a scene, turns and scales "
                "them, computes density and neighbours where they are missing, and writes them in any format that is "
                "written; so it exports as well."};
    ssfr_stage_defaults(&options);
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    options.seed = (uint64_t)line.seed;
    SSFR_TRY(run(line.arguments.items[0], &options, &words));
end:
    return result;
}

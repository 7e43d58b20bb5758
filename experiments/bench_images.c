/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_images.c: each image and table that a graph holds after a frame: its size, format and memory. */
#include "experiments/bench_images.h"
#include "experiments/command.h"
#include "experiments/meta.h"
#include "experiments/output.h"
#include "experiments/play.h"
#include "experiments/setup.h"
#include "experiments/shown.h"

typedef struct words {
    const char *scene, *output;
} words;

#define ROW(...) SSFR_OPTION(words, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(scene, "scene", 0, TEXT, "SCENE", "the scene (default splash)", 0, 0),
    ROW(output, "output", 'o', TEXT, "FILE.csv", "write the table as CSV too, with FILE.meta.json beside it", 0, 0),
    SSFR_OPTION_END,
};

static const ssfr_column columns[] = {
    {"pipeline", "1", 0, "what rendered"},
    {"backend", "1", 0, "gl, or cpu for the double-precision twins"},
    {"number", "1", 0, "in the order of the nodes, from 0"},
    {"name", "1", 0, "slot or table; (sum): all"},
    {"node", "1", 0, "of the pipeline, that writes it"},
    {"kind", "1", 0, "image; scratch: beside the node's outputs; given: a copy of a field; table; environment"},
    {"format", "1", 0, "as it is stored: letters are channels, then bits and F for floats"},
    {"status", "1", 0, "ok"},
    {"width", "px", 0, "texels in a row"},
    {"height", "px", 0, "rows"},
    {"depth", "px", 0, "layers, of a table"},
    {"channels", "1", 0, "that are asked for; three are stored as four where they are drawn into"},
    {"bytes", "B", -1, "that it takes"},
    {"bits_per_pixel", "1", -1, "bits a pixel of the view"},
};
enum { N_KEYS = 7 };

static const ssfr_shown shown[] = {
    {"name", "name", NULL, 1},       {"node", "node", NULL, 1},         {"kind", "kind", NULL, 1},
    {"format", "format", NULL, 1},   {"width", "width", "%.0f", 1},     {"height", "height", "%.0f", 1},
    {"depth", "depth", "%.0f", 1},   {"channels", "channels", "%.0f", 1}, {"bytes", "MiB", "%.3f", 1.0 / (1 << 20)},
    {"bits_per_pixel", "bits/px", "%.1f", 1},
};

typedef struct bench {
    words words;
    ssfr_setup setup;
    ssfr_setup_options setup_options;
    ssfr_stage_options stage_options;
    ssfr_command_line line;
    ssfr_stage *stage;
    ssfr_ledger table;
} bench;

static ssfr_result add(bench *b, int number, const ssfr_memory *m)
{
    const ssfr_camera *camera = &b->stage->scene.camera;
    char text[16];
    snprintf(text, sizeof text, "%d", number);
    const char *keys[N_KEYS] = {ssfr_pipeline_name(b->setup.pipeline), b->setup.gl ? "gl" : "cpu", text, m->name,
                                m->node, m->kind, m->format};
    return ssfr_ledger_add(&b->table, keys, "ok",
                           (const double[]){m->w, m->h, m->d, m->c, m->bytes,
                                            8 * m->bytes / ((double)camera->w * camera->h)});
}

static ssfr_result add_all(bench *b)
{
    ssfr_result result = SSFR_OK;
    ssfr_memory m;
    int n = 0;
    while (ssfr_graph_memory_at(b->setup.graph, n, &m)) SSFR_TRY(add(b, n++, &m));
    m = (ssfr_memory){.name = "(sum)", .node = "", .kind = "", .format = "",
                      .bytes = ssfr_graph_report(b->setup.graph)->image_bytes};
    SSFR_TRY(add(b, n, &m));
end:
    return result;
}

/* As ssfr render does, but for the picture. */
static ssfr_result run_frame(bench *b)
{
    ssfr_result result = SSFR_OK;
    ssfr_setup *s = &b->setup;
    SSFR_TRY(ssfr_setup_init(s, &b->setup_options, NULL));
    SSFR_TRY(ssfr_stage_create(&b->stage, b->words.scene, &b->stage_options));
    const ssfr_description *scene = b->stage->description;
    SSFR_TRY(ssfr_setup_scene(s, &b->setup_options, scene));
    SSFR_TRY(ssfr_setup_background(s->graph, scene ? scene->background : NULL, &b->stage->scene.camera));
    SSFR_TRY(ssfr_play(s->graph, b->stage, &b->stage_options, -1));
    SSFR_TRY(ssfr_graph_run(s->graph, &b->stage->scene, NULL));
end:
    return result;
}

static ssfr_result save_meta(const bench *b, int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    ssfr_record scene = {0};
    SSFR_TRY(ssfr_meta_record_scene(&scene, b->stage));
    SSFR_TRY(ssfr_meta_save(b->words.output, &(ssfr_meta){.argc = argc,
                                                          .argv = argv,
                                                          .seed = b->line.seed,
                                                          .gl = b->setup.gl,
                                                          .pipeline = ssfr_pipeline_name(b->setup.pipeline),
                                                          .graph = b->setup.graph,
                                                          .n_columns = SSFR_COUNT(columns),
                                                          .columns = columns,
                                                          .n_scenes = 1,
                                                          .scenes = &scene,
                                                          .bandwidth_gl = NAN,
                                                          .bandwidth_cpu = NAN}));
end:
    ssfr_record_finish(&scene);
    return result;
}

static ssfr_result run(bench *b, int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    const char *path = b->words.output;
    char title[256];
    if (path) SSFR_TRY(ssfr_output_check_file(path));
    SSFR_TRY(run_frame(b));
    SSFR_TRY(ssfr_ledger_begin_aside(&b->table, path, SSFR_COUNT(columns), columns, N_KEYS));
    SSFR_TRY(add_all(b));
    if (path) SSFR_TRY(save_meta(b, argc, argv));
    snprintf(title, sizeof title, "%s of %s, %dx%d px:", ssfr_pipeline_name(b->setup.pipeline), b->stage->name,
             b->stage->scene.camera.w, b->stage->scene.camera.h);
    SSFR_TRY(ssfr_shown_print(&b->table, title, NULL, shown, SSFR_COUNT(shown)));
end:
    return result;
}

int ssfr_bench_images(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    bench b = {.words = {.scene = "splash"}};
    const ssfr_option_set sets[] = {
        {"bench images", rows, &b.words},
        {"what runs", ssfr_setup_rows + 1, &b.setup_options}, /* the pipeline is an argument */
        SSFR_STAGE_SETS(&b.stage_options),
        SSFR_PLAY_SET(&b.stage_options),
        {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = "bench images",
        .arguments = "[PIPELINE]",
        .max_arguments = 1,
        .sets = sets,
        .help = "Lists the images and tables that a pipeline (default vanderlaan2009) holds after a frame of a scene: "
                "sizes, formats, memory. Buffers of particles are not among them."};
    ssfr_setup_defaults(&b.setup_options);
    ssfr_stage_defaults(&b.stage_options);
    SSFR_TRY(ssfr_options_parse(&b.line, &usage, argc - 1, argv + 1));
    if (b.line.help) goto end;
    b.stage_options.seed = (uint64_t)b.line.seed;
    if (b.line.arguments.n) b.setup_options.pipeline = b.line.arguments.items[0];
    SSFR_TRY(ssfr_play_check(&b.stage_options));
    SSFR_TRY(run(&b, argc, argv));
end:
    result = ssfr_ledger_end(&b.table, result);
    ssfr_stage_destroy(&b.stage);
    ssfr_setup_finish(&b.setup);
    return ssfr_exit_status(result);
}

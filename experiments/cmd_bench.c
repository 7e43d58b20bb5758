/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_bench.c: `ssfr bench`: where the time of a frame goes, pass by pass. */
#include "experiments/bench_flow.h"
#include "experiments/bench_integrators.h"
#include "experiments/bench_kernels.h"
#include "experiments/bench_solver.h"
#include "experiments/bench_truth.h"
#include "experiments/columns.h"
#include "experiments/command.h"
#include "experiments/console.h"
#include "experiments/csv.h"
#include "experiments/frame_file.h"
#include "experiments/measure.h"
#include "experiments/meta.h"
#include "experiments/output.h"
#include "experiments/play.h"
#include "experiments/setup.h"

typedef struct bench_options {
    const char *scene, *output;
    bool quick;
    double max_time;
} bench_options;

#define ROW(...) SSFR_OPTION(bench_options, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(scene, "scene", 0, TEXT, "SCENE", "the scene (default splash)", 0, 0),
    ROW(output, "output", 'o', TEXT, "FILE.csv", "write the table as CSV too, with FILE.meta.json beside it", 0, 0),
    ROW(quick, "quick", 0, FLAG, NULL, "3 runs and 0.2 s instead of 10 and 1 s", 0, 0),
    ROW(max_time, "max-time", 0, NUMBER, "S",
        "cap the timed frames, and the copies that they are held against, s; one is always timed", 1e-3, 1e6),
    SSFR_OPTION_END,
};

typedef struct bench {
    ssfr_setup setup;
    ssfr_stage *stage;
    ssfr_measured *frame, *timed; /* without and with the time of each node */
    double bandwidth;             /* bytes/s */
    double sum, staged;           /* ms, of the nodes' medians; of those that belong to a stage */
    ssfr_aside aside;
    ssfr_csv *csv;                /* NULL without -o */
} bench;

/* As ssfr render does. */
static ssfr_result import_background(const bench *b)
{
    const ssfr_description *scene = b->stage->description;
    return ssfr_setup_background(b->setup.graph, scene ? scene->background : NULL, &b->stage->scene.camera);
}

static ssfr_result measure(bench *b, const bench_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_measure_options m = ssfr_measure_defaults(options->quick);
    m.max_seconds = options->max_time;
    b->bandwidth = ssfr_measure_copy_bandwidth(b->setup.gl, options->max_time);
    SSFR_TRY(ssfr_measure_graph(&b->frame, b->setup.graph, &b->stage->scene, &m));
    m.nodes = true;
    SSFR_TRY(ssfr_measure_graph(&b->timed, b->setup.graph, &b->stage->scene, &m));
    for (int i = 0; i < b->timed->n_nodes; i++)
        if (b->timed->nodes[i].n && !b->timed->reports[i].kept) {
            b->sum += b->timed->nodes[i].median;
            if (*b->timed->reports[i].stage) b->staged += b->timed->nodes[i].median;
        }
end:
    return result;
}

/* ---- for people -------------------------------------------------------------------------------------------------- */

static ssfr_result add_titles(ssfr_table *t, const char *const *titles, int n)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < n && result == SSFR_OK; i++) result = ssfr_table_add(t, "%s", titles[i]);
    return result;
}

static ssfr_result add_node(ssfr_table *t, const bench *b, int i)
{
    ssfr_result result = SSFR_OK;
    const ssfr_node_report *r = &b->timed->reports[i];
    const ssfr_timing *time = &b->timed->nodes[i];
    SSFR_TRY(ssfr_table_add(t, "%s", r->node));
    if (r->status != SSFR_RAN) {
        SSFR_TRY(ssfr_table_add(t, "%s: %s", ssfr_status_text(r->status), r->why));
        for (int k = 0; k < 8; k++) SSFR_TRY(ssfr_table_add(t, "-"));
        goto end;
    }
    SSFR_TRY(ssfr_table_add(t, "%s", ssfr_status_text(r->status)));
    SSFR_TRY(ssfr_table_add(t, "%.3f", time->median));
    SSFR_TRY(ssfr_table_add(t, "%.3f", time->mad));
    if (r->kept) SSFR_TRY(ssfr_table_add(t, "-")); /* not of this frame */
    else SSFR_TRY(ssfr_table_add(t, "%.1f %%", 100 * time->median / b->sum));
    SSFR_TRY(ssfr_table_add(t, "%.1f", r->taps));
    SSFR_TRY(ssfr_table_add(t, "%g", r->iterations));
    SSFR_TRY(ssfr_table_add(t, "%.0f", r->vertices));
    SSFR_TRY(ssfr_table_add(t, "%.2f", 1e-6 * r->bytes));
    SSFR_TRY(ssfr_table_add(t, "%.1f", ssfr_measure_roofline(time->median, r->bytes, b->bandwidth)));
end:
    return result;
}

static void print_frame(const bench *b)
{
    const ssfr_measured *f = b->frame, *t = b->timed;
    const ssfr_camera *camera = &b->stage->scene.camera;
    printf("\n%s on %s, %s, %dx%d px, %zu particles\n", ssfr_pipeline_name(b->setup.pipeline),
           b->setup.gl ? ssfr_gl_renderer(b->setup.gl) : "the CPU, in double", b->stage->name, camera->w, camera->h,
           b->stage->particles->n);
    printf("frame: %.3f ms (median of %zu, MAD %.3f, least %.3f, outliers %zu)\n", f->frame.median, f->frame.n,
           f->frame.mad, f->frame.min, f->frame.outliers);
    printf("passes: %.3f ms in all, in a frame of %.3f ms while they are timed: a share of %.3f\n", b->sum,
           t->frame.median, b->sum / t->frame.median);
    printf("copying: %.2f GB/s read and written; the frame takes %.1f times as long as moving its bytes once\n",
           1e-9 * b->bandwidth, ssfr_measure_roofline(f->frame.median, f->bytes, b->bandwidth));
}

static ssfr_result print(const bench *b)
{
    static const char *const titles[] = {"pass", "status", "ms",       "MAD", "share",
                                         "taps", "sweeps", "vertices", "MB",  "x copy"};
    ssfr_result result = SSFR_OK;
    ssfr_table t;
    ssfr_table_init(&t, SSFR_COUNT(titles));
    SSFR_TRY(add_titles(&t, titles, SSFR_COUNT(titles)));
    for (int i = 0; i < b->timed->n_nodes; i++) SSFR_TRY(add_node(&t, b, i));
    ssfr_table_print(&t, stdout);
    print_frame(b);
end:
    ssfr_table_finish(&t);
    return result;
}

/* ---- for programs ------------------------------------------------------------------------------------------------ */

static const ssfr_column columns[] = {
    {"scene", "1", 0, "a built-in scene or a file"},
    {"pipeline", "1", 0, "what rendered it"},
    {"backend", "1", 0, "gl, or cpu for the double-precision twins"},
    {"width", "1", 0, "width of the image, px"},
    {"height", "1", 0, "height of the image, px"},
    {"node", "1", 0, "node of the pipeline; (frame): all, untimed one by one; (frame while timed): all, each timed"},
    {"pass", "1", 0, "what the node runs"},
    {"stage", "1", 0, "of the frame, as the paper divides it; rows of the node (stage) sum up its nodes"},
    {"status", "1", 0, "ran, or how it was left out"},
    {"why", "1", 0, "why it was left out, empty when it ran"},
    {"ms_min", "ms", -1, "shortest time"},
    {"ms_median", "ms", -1, "median time"},
    {"ms_mad", "ms", -1, "median absolute deviation of the time"},
    {"runs", "1", 0, "timed runs"},
    {"outliers", "1", 0, "timed runs whose modified z-score exceeds 3.5"},
    {"share", "1", 0, "median time over the sum of those of the nodes, of a stage over that of all stages"},
    {"taps", "1", -1, "samples a written pixel, summed over the passes in a frame"},
    {"iterations", "1", -1, "sweeps over the image"},
    {"vertices", "1", -1, "vertices drawn"},
    {"bytes", "B", -1, "fewest bytes that must be moved"},
    {"roofline", "1", -1, "time over that of moving these bytes at the copy bandwidth"},
    {"tiles", "1", -1, "tiles of 32 x 32 pixels that its sweeps draw"},
    {"unstable", "1", -1, "pixels whose step of smoothing is longer than what keeps it stable"},
};
enum { N_KEYS = 8, N_COLUMNS = SSFR_COUNT(columns) };

/* share: of the sum that the time is a part of */
static ssfr_result write_row(ssfr_csv *csv, const bench *b, const ssfr_node_report *r, const ssfr_timing *time,
                             double share)
{
    ssfr_result result = SSFR_OK;
    const double numbers[] = {time->min, time->median, time->mad, (double)time->n, (double)time->outliers,
                              share, r->taps, r->iterations, r->vertices, r->bytes,
                              ssfr_measure_roofline(time->median, r->bytes, b->bandwidth), r->tiles, r->unstable};
    SSFR_TRY(ssfr_csv_text(csv, b->stage->name));
    SSFR_TRY(ssfr_csv_text(csv, ssfr_pipeline_name(b->setup.pipeline)));
    SSFR_TRY(ssfr_csv_text(csv, b->setup.gl ? "gl" : "cpu"));
    SSFR_TRY(ssfr_csv_number(csv, b->stage->scene.camera.w));
    SSFR_TRY(ssfr_csv_number(csv, b->stage->scene.camera.h));
    SSFR_TRY(ssfr_csv_text(csv, r->node));
    SSFR_TRY(ssfr_csv_text(csv, r->pass));
    SSFR_TRY(ssfr_csv_text(csv, r->stage));
    SSFR_TRY(ssfr_csv_text(csv, ssfr_status_text(r->status)));
    SSFR_TRY(ssfr_csv_text(csv, r->status == SSFR_RAN ? "" : r->why));
    for (size_t i = 0; i < SSFR_COUNT(numbers); i++) SSFR_TRY(ssfr_csv_number(csv, numbers[i]));
    SSFR_TRY(ssfr_csv_end_row(csv));
end:
    return result;
}

/* Of one stage: sums of its nodes' medians and work; of how the sums spread, nothing is known. */
static ssfr_result write_stage(ssfr_csv *csv, const bench *b, const char *stage)
{
    ssfr_node_report whole = {.node = "(stage)", .pass = "", .stage = stage, .status = SSFR_RAN, .why = ""};
    ssfr_timing time = {.min = NAN, .mad = NAN};
    for (int i = 0; i < b->timed->n_nodes; i++) {
        const ssfr_node_report *r = &b->timed->reports[i];
        if (strcmp(r->stage, stage) != 0 || r->status != SSFR_RAN || r->kept) continue;
        time.n = b->timed->nodes[i].n, time.median += b->timed->nodes[i].median;
        whole.taps += r->taps, whole.iterations += r->iterations, whole.vertices += r->vertices;
        whole.bytes += r->bytes, whole.tiles += r->tiles, whole.unstable += r->unstable;
    }
    return write_row(csv, b, &whole, &time, time.median / b->staged);
}

/* Each stage once, in the order of their first nodes. */
static ssfr_result write_stages(ssfr_csv *csv, const bench *b)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < b->timed->n_nodes; i++) {
        const char *stage = b->timed->reports[i].stage;
        bool is_first = *stage;
        for (int k = 0; k < i && is_first; k++) is_first = strcmp(b->timed->reports[k].stage, stage) != 0;
        if (is_first) SSFR_TRY(write_stage(csv, b, stage));
    }
end:
    return result;
}

/* The frame as a whole: as users have it, and while its nodes are timed. */
static ssfr_result write_frame(ssfr_csv *csv, const bench *b, const char *name, const ssfr_measured *m)
{
    const ssfr_node_report whole = {.node = name, .pass = "", .stage = "", .status = SSFR_RAN, .why = "",
                                    .taps = m->taps, .iterations = m->iterations, .vertices = m->vertices,
                                    .bytes = m->bytes, .tiles = m->tiles, .unstable = m->unstable};
    return write_row(csv, b, &whole, &m->frame, m->frame.median / b->sum);
}

/* Before anything is measured: a place that cannot be written is found out at once. */
static ssfr_result open_csv(bench *b, const char *path)
{
    ssfr_result result = SSFR_OK;
    char headers[N_COLUMNS][64];
    const char *names[N_COLUMNS];
    for (int i = 0; i < N_COLUMNS; i++) {
        ssfr_column_header(columns[i].name, columns[i].unit, headers[i], sizeof headers[i]);
        names[i] = headers[i];
    }
    SSFR_TRY(ssfr_output_check_file(path));
    SSFR_TRY(ssfr_aside_begin(&b->aside, path));
    SSFR_TRY(ssfr_csv_create(&b->csv, b->aside.temporary, N_COLUMNS, names, N_KEYS, false));
end:
    return result;
}

static ssfr_result write_csv(bench *b)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < b->timed->n_nodes; i++) {
        const ssfr_node_report *node = &b->timed->reports[i];
        const ssfr_timing *time = &b->timed->nodes[i];
        SSFR_TRY(write_row(b->csv, b, node, time, node->kept ? NAN : time->median / b->sum));
    }
    SSFR_TRY(write_stages(b->csv, b));
    SSFR_TRY(write_frame(b->csv, b, "(frame)", b->frame));
    SSFR_TRY(write_frame(b->csv, b, "(frame while timed)", b->timed));
end:
    ssfr_csv_destroy(&b->csv);
    return ssfr_aside_end(&b->aside, result);
}

static ssfr_result save(bench *b, const char *path, const ssfr_command_line *line, int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    ssfr_record scene = {0};
    SSFR_TRY(ssfr_meta_record_scene(&scene, b->stage));
    SSFR_TRY(write_csv(b));
    SSFR_TRY(ssfr_meta_save(path, &(ssfr_meta){.argc = argc,
                                               .argv = argv,
                                               .seed = line->seed,
                                               .gl = b->setup.gl,
                                               .pipeline = ssfr_pipeline_name(b->setup.pipeline),
                                               .graph = b->setup.graph,
                                               .n_columns = N_COLUMNS,
                                               .columns = columns,
                                               .n_scenes = 1,
                                               .scenes = &scene,
                                               .bandwidth_gl = b->setup.gl ? b->bandwidth : NAN,
                                               .bandwidth_cpu = b->setup.gl ? NAN : b->bandwidth}));
end:
    ssfr_record_finish(&scene);
    return result;
}

int ssfr_cmd_bench(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "solver") == 0) return ssfr_bench_solver(argc, argv);
    if (argc > 1 && strcmp(argv[1], "truth") == 0) return ssfr_bench_truth(argc, argv);
    if (argc > 1 && strcmp(argv[1], "flow") == 0) return ssfr_bench_flow(argc, argv);
    if (argc > 1 && strcmp(argv[1], "integrators") == 0) return ssfr_bench_integrators(argc, argv);
    if (argc > 1 && strcmp(argv[1], "kernels") == 0) return ssfr_bench_kernels(argc, argv);
    ssfr_result result = SSFR_OK;
    bench_options options = {.scene = "splash"};
    ssfr_setup_options setup_options;
    ssfr_stage_options stage_options;
    ssfr_command_line line;
    bench b = {0};
    const ssfr_option_set sets[] = {
        {"bench", rows, &options},
        {"what runs", ssfr_setup_rows + 1, &setup_options}, /* the pipeline is an argument */
        SSFR_STAGE_SETS(&stage_options),
        SSFR_PLAY_SET(&stage_options),
        {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0],
        .arguments = "[PIPELINE|solver|truth|integrators|flow|kernels]",
        .max_arguments = 1,
        .sets = sets,
        .help = "Times a pipeline (default vanderlaan2009), pass by pass: medians, work, and how far each "
                "is from the time that moving its bytes takes. 'ssfr bench solver --help' tells of the simulator's, "
                "'ssfr bench truth --help' of ray casting's, "
                "'ssfr bench integrators --help' of integrals along rays, "
                "'ssfr bench flow --help' of how wide the curvature flows smooth, "
                "'ssfr bench kernels --help' of roots and splats."};
    ssfr_setup_defaults(&setup_options);
    ssfr_stage_defaults(&stage_options);
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    stage_options.seed = (uint64_t)line.seed;
    SSFR_TRY(ssfr_play_check(&stage_options));
    if (line.arguments.n) setup_options.pipeline = line.arguments.items[0];
    SSFR_TRY(ssfr_setup_init(&b.setup, &setup_options, NULL));
    SSFR_TRY(ssfr_stage_create(&b.stage, options.scene, &stage_options));
    SSFR_TRY(ssfr_setup_scene(&b.setup, &setup_options, b.stage->description));
    SSFR_TRY(import_background(&b));
    SSFR_TRY(ssfr_play(b.setup.graph, b.stage, &stage_options, -1));
    if (options.output) SSFR_TRY(open_csv(&b, options.output));
    SSFR_TRY(measure(&b, &options));
    SSFR_TRY(print(&b));
    if (options.output) SSFR_TRY(save(&b, options.output, &line, argc, argv));
end:
    ssfr_csv_destroy(&b.csv);
    if (result != SSFR_OK) result = ssfr_aside_end(&b.aside, result);
    ssfr_measured_destroy(&b.frame);
    ssfr_measured_destroy(&b.timed);
    ssfr_stage_destroy(&b.stage);
    ssfr_setup_finish(&b.setup);
    return ssfr_exit_status(result);
}

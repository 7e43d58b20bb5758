/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_bench.c: `ssfr bench`: where the time of a frame goes, pass by pass. */
#include "experiments/bench_flow.h"
#include "experiments/bench_images.h"
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

enum { MAX_VIEWS = 10000 };

typedef struct bench_options {
    const char *scene, *output;
    bool quick;
    long views; /* 0: the one that the other options say */
    double max_time;
} bench_options;

#define ROW(...) SSFR_OPTION(bench_options, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(scene, "scene", 0, TEXT, "SCENE", "the scene (default splash)", 0, 0),
    ROW(output, "output", 'o', TEXT, "FILE.csv", "write the table as CSV too, with FILE.meta.json beside it", 0, 0),
    ROW(views, "views", 0, INTEGER, "N",
        "time N views of the camera's path, evenly spaced in time from its first key to its last, each of the frame at "
        "that time",
        1, MAX_VIEWS),
    ROW(quick, "quick", 0, FLAG, NULL, "3 runs and 0.2 s instead of 10 and 1 s", 0, 0),
    ROW(max_time, "max-time", 0, NUMBER, "S",
        "cap the timed frames, and the copies that they are held against, s; one is always timed", 1e-3, 1e6),
    SSFR_OPTION_END,
};

typedef struct bench {
    ssfr_setup setup;
    ssfr_stage *stage;
    const ssfr_view *path;        /* NULL without --views */
    long view, n_views;
    ssfr_measured *frame, *timed; /* of the view: without and with the time of each node */
    double bandwidth;             /* bytes/s */
    double sum, staged;           /* ms, of nodes' medians: of those in a frame; of those of a stage, kept or not */
    struct {                      /* of all views; nothing where a node did not run */
        ssfr_timing frame, timed, *nodes;
        ssfr_node_report *reports;
        double bytes, sum;
    } mean;
    ssfr_aside aside;
    ssfr_csv *csv;                /* NULL without -o */
} bench;

/* ---- one view ---------------------------------------------------------------------------------------------------- */

/* The frame follows the camera: what says which frame, or where the camera is, says it alone. */
static ssfr_result find_path(bench *b, const ssfr_stage_options *stage, long views)
{
    ssfr_result result = SSFR_OK;
    b->n_views = views ? views : 1;
    if (!views) return SSFR_OK;
    if (stage->frame >= 0 || !isnan(stage->time) || !isnan(stage->camera_time))
        return ssfr_fail(SSFR_ERR_VALUE, "--views: --frame, --time or --camera-time says which, too");
    SSFR_TRY(ssfr_stage_find_path(b->stage, stage, true, &b->path));
end:
    return result;
}

static ssfr_result show_view(bench *b, const ssfr_stage_options *stage)
{
    ssfr_result result = SSFR_OK;
    ssfr_stage_options options = *stage;
    if (b->path)
        options.time = options.camera_time = ssfr_stage_view_time(b->path, (size_t)b->view, (size_t)b->n_views);
    SSFR_TRY(ssfr_stage_turn(b->stage, &options));
end:
    return result;
}

/* As ssfr render does. */
static ssfr_result import_background(const bench *b)
{
    const ssfr_description *scene = b->stage->description;
    return ssfr_setup_background(b->setup.graph, scene ? scene->background : NULL, &b->stage->scene.camera);
}

static void add_up(bench *b)
{
    b->sum = b->staged = 0;
    for (int i = 0; i < b->timed->n_nodes; i++) {
        const ssfr_node_report *r = &b->timed->reports[i];
        const double median = b->timed->nodes[i].n ? b->timed->nodes[i].median : 0;
        if (!r->kept) b->sum += median;
        if (*r->stage) b->staged += median;
    }
}

static ssfr_result measure(bench *b, const bench_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_measure_options m = ssfr_measure_defaults(options->quick);
    m.max_seconds = options->max_time;
    ssfr_measured_destroy(&b->frame);
    ssfr_measured_destroy(&b->timed);
    SSFR_TRY(ssfr_measure_graph(&b->frame, b->setup.graph, &b->stage->scene, &m));
    m.nodes = true;
    SSFR_TRY(ssfr_measure_graph(&b->timed, b->setup.graph, &b->stage->scene, &m));
    add_up(b);
end:
    return result;
}

/* ---- their mean -------------------------------------------------------------------------------------------------- */

static void mean_timing(ssfr_timing *mean, const ssfr_timing *t, double weight)
{
    if (t->n == 0) return;
    mean->min = mean->n ? fmin(mean->min, t->min) : t->min;
    mean->median += weight * t->median;
    mean->mad += weight * t->mad;
    mean->n += t->n;
    mean->outliers += t->outliers;
}

/* It ran if it did in any view. */
static void mean_report(ssfr_node_report *mean, const ssfr_node_report *r, double weight)
{
    if (!mean->node || r->status == SSFR_RAN)
        mean->node = r->node, mean->status = r->status, mean->why = r->why, mean->kept = r->kept;
    if (r->status != SSFR_RAN) return;
    mean->taps += weight * r->taps;
    mean->iterations += weight * r->iterations;
    mean->vertices += weight * r->vertices;
    mean->bytes += weight * r->bytes;
}

static ssfr_result add_view(bench *b)
{
    ssfr_result result = SSFR_OK;
    const double weight = 1 / (double)b->n_views;
    const size_t n = (size_t)b->timed->n_nodes;
    if (!b->mean.nodes) SSFR_TRY(ssfr_alloc(&b->mean.nodes, n, sizeof *b->mean.nodes, "mean times"));
    if (!b->mean.reports) SSFR_TRY(ssfr_alloc(&b->mean.reports, n, sizeof *b->mean.reports, "mean work"));
    for (size_t i = 0; i < n; i++) {
        mean_timing(&b->mean.nodes[i], &b->timed->nodes[i], weight);
        mean_report(&b->mean.reports[i], &b->timed->reports[i], weight);
    }
    mean_timing(&b->mean.frame, &b->frame->frame, weight);
    mean_timing(&b->mean.timed, &b->timed->frame, weight);
    b->mean.bytes += weight * b->frame->bytes;
    b->mean.sum += weight * b->sum;
end:
    return result;
}

/* ---- for people -------------------------------------------------------------------------------------------------- */

static ssfr_result add_node(ssfr_table *t, const bench *b, int i)
{
    ssfr_result result = SSFR_OK;
    const ssfr_node_report *r = &b->mean.reports[i];
    const ssfr_timing *time = &b->mean.nodes[i];
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
    else SSFR_TRY(ssfr_table_add(t, "%.1f %%", 100 * time->median / b->mean.sum));
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
    const ssfr_timing *f = &b->mean.frame, *t = &b->mean.timed;
    const ssfr_camera *camera = &b->stage->scene.camera;
    printf("\n%s on %s, %s, %dx%d px, %zu particles\n", ssfr_pipeline_name(b->setup.pipeline),
           b->setup.gl ? ssfr_gl_renderer(b->setup.gl) : "the CPU, in double", b->stage->name, camera->w, camera->h,
           b->stage->particles->n);
    if (b->path) printf("mean over %ld views of %s\n", b->n_views, b->path->name);
    printf("frame: %.3f ms (median of %zu, MAD %.3f, least %.3f, outliers %zu)\n", f->median, f->n, f->mad,
           f->min, f->outliers);
    printf("passes: %.3f ms in all, in a frame of %.3f ms while they are timed: a share of %.3f\n", b->mean.sum,
           t->median, b->mean.sum / t->median);
    printf("copying: %.2f GB/s read and written; the frame takes %.1f times as long as moving its bytes once\n",
           1e-9 * b->bandwidth, ssfr_measure_roofline(f->median, b->mean.bytes, b->bandwidth));
}

static ssfr_result print(const bench *b)
{
    static const char *const titles[] = {"pass", "status", "ms",       "MAD", "share",
                                         "taps", "sweeps", "vertices", "MB",  "x copy"};
    ssfr_result result = SSFR_OK;
    ssfr_table t;
    ssfr_table_init(&t, SSFR_COUNT(titles));
    SSFR_TRY(ssfr_table_row(&t, titles));
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
    {"view", "1", 0, "of the views of the camera's path, from 0"},
    {"node", "1", 0, "node of the pipeline; (frame): all, untimed one by one; (frame while timed): all, each timed"},
    {"pass", "1", 0, "what the node runs"},
    {"stage", "1", 0, "of the frame, as the paper divides it; rows of the node (stage) sum up its nodes, kept or not"},
    {"status", "1", 0, "ran, or how it was left out"},
    {"why", "1", 0, "why it was left out, empty when it ran"},
    {"ms_min", "ms", -1, "shortest time"},
    {"ms_median", "ms", -1, "median time"},
    {"ms_mad", "ms", -1, "median absolute deviation of the time"},
    {"ms_kept", "ms", -1,
     "the part of ms_median that is of values of particles: computed once a frame of the scene, in no time of (frame)"},
    {"runs", "1", 0, "timed runs"},
    {"outliers", "1", 0, "timed runs whose modified z-score exceeds 3.5"},
    {"share", "1", 0,
     "median time over the sum of those of the nodes, NaN for what is kept; of a stage over that of all stages"},
    {"taps", "1", -1, "samples a written pixel, summed over the passes in a frame"},
    {"iterations", "1", -1, "sweeps over the image"},
    {"vertices", "1", -1, "vertices drawn"},
    {"bytes", "B", -1, "fewest bytes that must be moved"},
    {"roofline", "1", -1, "time over that of moving these bytes at the copy bandwidth"},
    {"tiles", "1", -1, "tiles of 32 x 32 pixels that its sweeps draw"},
    {"unstable", "1", -1, "pixels whose step of smoothing is longer than what keeps it stable"},
};
enum { N_KEYS = 9, N_COLUMNS = SSFR_COUNT(columns) };

/* kept: ms of what is computed once a frame of the scene; share: of the sum that the time is a part of */
static ssfr_result write_row(ssfr_csv *csv, const bench *b, const ssfr_node_report *r, const ssfr_timing *time,
                             double kept, double share)
{
    ssfr_result result = SSFR_OK;
    const double numbers[] = {time->min, time->median, time->mad, kept, (double)time->n,
                              (double)time->outliers, share, r->taps, r->iterations, r->vertices, r->bytes,
                              ssfr_measure_roofline(time->median, r->bytes, b->bandwidth), r->tiles, r->unstable};
    SSFR_TRY(ssfr_csv_text(csv, b->stage->name));
    SSFR_TRY(ssfr_csv_text(csv, ssfr_pipeline_name(b->setup.pipeline)));
    SSFR_TRY(ssfr_csv_text(csv, b->setup.gl ? "gl" : "cpu"));
    SSFR_TRY(ssfr_csv_number(csv, b->stage->scene.camera.w));
    SSFR_TRY(ssfr_csv_number(csv, b->stage->scene.camera.h));
    SSFR_TRY(ssfr_csv_number(csv, (double)b->view));
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

/* Of one stage: sums of its nodes' medians and work; of how the sums spread, nothing is known. Values of particles are
 * updated once a frame of the simulation: in a stage they count as often as what is drawn. */
static ssfr_result write_stage(ssfr_csv *csv, const bench *b, const char *stage)
{
    ssfr_node_report whole = {.node = "(stage)", .pass = "", .stage = stage, .status = SSFR_RAN, .why = ""};
    ssfr_timing time = {.min = NAN, .mad = NAN};
    double kept = 0;
    for (int i = 0; i < b->timed->n_nodes; i++) {
        const ssfr_node_report *r = &b->timed->reports[i];
        if (strcmp(r->stage, stage) != 0 || r->status != SSFR_RAN) continue;
        time.n = b->timed->nodes[i].n, time.median += b->timed->nodes[i].median;
        if (r->kept) kept += b->timed->nodes[i].median;
        whole.taps += r->taps, whole.iterations += r->iterations, whole.vertices += r->vertices;
        whole.bytes += r->bytes, whole.tiles += r->tiles, whole.unstable += r->unstable;
    }
    return write_row(csv, b, &whole, &time, kept, time.median / b->staged);
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
    return write_row(csv, b, &whole, &m->frame, 0, m->frame.median / b->sum);
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

static ssfr_result write_view(bench *b)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < b->timed->n_nodes; i++) {
        const ssfr_node_report *node = &b->timed->reports[i];
        const ssfr_timing *time = &b->timed->nodes[i];
        SSFR_TRY(write_row(b->csv, b, node, time, node->kept ? time->median : 0,
                           node->kept ? NAN : time->median / b->sum));
    }
    SSFR_TRY(write_stages(b->csv, b));
    SSFR_TRY(write_frame(b->csv, b, "(frame)", b->frame));
    SSFR_TRY(write_frame(b->csv, b, "(frame while timed)", b->timed));
end:
    return result;
}

static ssfr_result save(bench *b, const char *path, const ssfr_command_line *line, int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    ssfr_record scene = {0};
    SSFR_TRY(ssfr_meta_record_scene(&scene, b->stage));
    ssfr_csv_destroy(&b->csv);
    SSFR_TRY(ssfr_aside_end(&b->aside, SSFR_OK));
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

static ssfr_result bench_view(bench *b, const bench_options *options, const ssfr_stage_options *stage)
{
    ssfr_result result = SSFR_OK;
    const long before = b->view > 0 ? b->stage->frame : -1; /* what the graph drew last */
    if (b->n_views > 1) ssfr_console_progress("bench", (size_t)b->view, (size_t)b->n_views);
    if (b->view > 0) SSFR_TRY(show_view(b, stage));
    SSFR_TRY(ssfr_play(b->setup.graph, b->stage, stage, before));
    SSFR_TRY(measure(b, options));
    SSFR_TRY(add_view(b));
    if (b->csv) SSFR_TRY(write_view(b));
end:
    return result;
}

/* The first view is there before anything is measured: what cannot be shown is found out at once. */
static ssfr_result bench_views(bench *b, const bench_options *options, const ssfr_stage_options *stage)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(show_view(b, stage));
    SSFR_TRY(import_background(b));
    if (options->output) SSFR_TRY(open_csv(b, options->output));
    b->bandwidth = ssfr_measure_copy_bandwidth(b->setup.gl, options->max_time);
    for (b->view = 0; b->view < b->n_views; b->view++) SSFR_TRY(bench_view(b, options, stage));
    if (b->n_views > 1) ssfr_console_progress("bench", 1, 1);
end:
    return result;
}

int ssfr_cmd_bench(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "solver") == 0) return ssfr_bench_solver(argc, argv);
    if (argc > 1 && strcmp(argv[1], "truth") == 0) return ssfr_bench_truth(argc, argv);
    if (argc > 1 && strcmp(argv[1], "images") == 0) return ssfr_bench_images(argc, argv);
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
        .arguments = "[PIPELINE|solver|truth|integrators|flow|kernels|images]",
        .max_arguments = 1,
        .sets = sets,
        .help = "Times a pipeline (default vanderlaan2009), pass by pass: medians, work, and how far each "
                "is from the time that moving its bytes takes. 'ssfr bench solver --help' tells of the simulator's, "
                "'ssfr bench truth --help' of ray casting's, "
                "'ssfr bench integrators --help' of integrals along rays, "
                "'ssfr bench flow --help' of how wide the curvature flows smooth, "
                "'ssfr bench kernels --help' of roots and splats, "
                "'ssfr bench images --help' of what is allocated."};
    ssfr_setup_defaults(&setup_options);
    ssfr_stage_defaults(&stage_options);
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    stage_options.seed = (uint64_t)line.seed;
    SSFR_TRY(ssfr_play_check(&stage_options));
    if (line.arguments.n) setup_options.pipeline = line.arguments.items[0];
    SSFR_TRY(ssfr_setup_init(&b.setup, &setup_options, NULL));
    SSFR_TRY(ssfr_stage_open(&b.stage, options.scene, &stage_options));
    SSFR_TRY(find_path(&b, &stage_options, options.views));
    SSFR_TRY(ssfr_setup_scene(&b.setup, &setup_options, b.stage->description));
    SSFR_TRY(bench_views(&b, &options, &stage_options));
    SSFR_TRY(print(&b));
    if (options.output) SSFR_TRY(save(&b, options.output, &line, argc, argv));
end:
    ssfr_csv_destroy(&b.csv);
    if (result != SSFR_OK) result = ssfr_aside_end(&b.aside, result);
    ssfr_measured_destroy(&b.frame);
    ssfr_measured_destroy(&b.timed);
    free(b.mean.nodes);
    free(b.mean.reports);
    ssfr_stage_destroy(&b.stage);
    ssfr_setup_finish(&b.setup);
    return ssfr_exit_status(result);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_measure.c: robust statistics of times, the runs that are timed, and the bandwidth that they are held against. */
#include "experiments/measure.h"
#include "experiments/stage.h"
#include "tests/gl_host.h"

enum { MAX_SAMPLES = 16 };

static ssfr_timing timing_of(size_t n, const double *samples, size_t stride)
{
    double work[2 * MAX_SAMPLES];
    return ssfr_timing_of(samples, stride, n, work);
}

static void the_median_and_its_deviation_are_those_of_the_definition(void **state)
{
    (void)state;
    const double odd[] = {7, 2.385, 3, 100, 4}, even[] = {4, 1, 2.5, 8};
    const ssfr_timing a = timing_of(5, odd, 1), b = timing_of(4, even, 1);
    assert_int_equal(a.n, 5);
    assert_close(a.min, 2.385, 0, 0);
    assert_close(a.median, 4, 0, 0);
    assert_close(a.mad, 1.615, 1e-12, 0); /* of 0, 1, 1.615, 3, 96 */
    assert_close(b.median, 3.25, 0, 1e-15);
    assert_close(b.mad, 1.5, 0, 1e-15); /* of 0.75, 0.75, 2.25, 4.75 */
}

static void samples_may_stand_apart_and_stay_as_they_are(void **state)
{
    (void)state;
    double rows[12];
    for (int i = 0; i < 12; i++) rows[i] = i % 3 == 1 ? 2.385 * (4 - i / 3) : NAN;
    const ssfr_timing t = timing_of(4, rows + 1, 3);
    assert_close(t.min, 2.385, 0, 1e-15);
    assert_close(t.median, 2.5 * 2.385, 0, 1e-15);
    assert_close(rows[1], 4 * 2.385, 0, 0);
}

static void one_sample_is_its_own_median(void **state)
{
    (void)state;
    const double one[] = {2.385};
    const ssfr_timing t = timing_of(1, one, 1);
    assert_close(t.median, 2.385, 0, 0);
    assert_close(t.mad, 0, 0, 0);
    assert_int_equal(t.outliers, 0);
}

static void no_sample_has_no_median(void **state)
{
    (void)state;
    const ssfr_timing t = timing_of(0, NULL, 1);
    assert_int_equal(t.n, 0);
    assert_true(isnan(t.min) && isnan(t.median) && isnan(t.mad));
}

/* The modified z-score is 0.6745 |x - median| / MAD: with MAD 1 the limit of 3.5 is 5.189 away. */
static void outliers_are_counted_by_the_modified_z_score_and_kept(void **state)
{
    (void)state;
    double samples[] = {8, 9, 9, 10, 11, 11, 10 + 5.18};
    assert_int_equal(timing_of(7, samples, 1).outliers, 0);
    samples[6] = 10 + 5.2;
    assert_int_equal(timing_of(7, samples, 1).outliers, 1);
    samples[0] = 10 - 5.2;
    const ssfr_timing t = timing_of(7, samples, 1);
    assert_int_equal(t.outliers, 2);
    assert_int_equal(t.n, 7);
    assert_close(t.min, 4.8, 0, 1e-15);
}

/* More than half of the samples are equal, so the MAD is 0 and the mean deviation takes its place. */
static void an_outlier_among_equal_samples_is_found(void **state)
{
    (void)state;
    const double samples[] = {5, 5, 5, 5, 5, 5, 5, 5, 5, 7.385}, equal[] = {5, 5, 5, 5};
    const ssfr_timing t = timing_of(10, samples, 1);
    assert_close(t.mad, 0, 0, 0);
    assert_int_equal(t.outliers, 1);
    assert_int_equal(timing_of(4, equal, 1).outliers, 0);
}

static void the_roofline_is_time_over_the_least_time(void **state)
{
    (void)state;
    assert_close(ssfr_measure_roofline(2.385, 1e6, 2e9), 4.77, 0, 1e-14); /* 1 MB takes 0.5 ms */
    assert_true(isnan(ssfr_measure_roofline(2.385, 0, 2e9)));
    assert_true(isnan(ssfr_measure_roofline(2.385, 1e6, NAN)));
}

static void quick_measuring_asks_for_less(void **state)
{
    (void)state;
    const ssfr_measure_options full = ssfr_measure_defaults(false), quick = ssfr_measure_defaults(true);
    assert_int_equal(full.min_runs, 10);
    assert_close(full.min_seconds, 1, 0, 0);
    assert_int_equal(quick.min_runs, 3);
    assert_close(quick.min_seconds, 0.2, 0, 0);
    assert_true(full.max_seconds == 0 && quick.max_seconds == 0);
}

static void memory_has_a_bandwidth(void **state)
{
    (void)state;
    const double bandwidth = ssfr_measure_copy_bandwidth(NULL, 0.01);
    assert_true(bandwidth > 1e8 && bandwidth < 1e13);
}

static void a_gpu_has_a_bandwidth(void **state)
{
    (void)state;
    ssfr_gl *gl = test_gl_or_skip();
    const double bandwidth = ssfr_measure_copy_bandwidth(gl, 0);
    ssfr_gl_destroy(&gl);
    assert_true(bandwidth > 1e8 && bandwidth < 1e14);
}

/* ---- graphs ------------------------------------------------------------------------------------------------------ */

typedef struct bench {
    ssfr_gl *gl;
    ssfr_stage *stage;
    ssfr_graph *graph;
    ssfr_measured *measured;
} bench;

static void bench_create(bench *b, ssfr_gl *gl)
{
    ssfr_stage_options options;
    *b = (bench){.gl = gl};
    ssfr_stage_defaults(&options);
    options.size[0] = 64, options.size[1] = 48;
    assert_int_equal(ssfr_stage_create(&b->stage, "block", &options), SSFR_OK);
    assert_int_equal(ssfr_graph_create(&b->graph, ssfr_pipeline_find("vanderlaan2009"), gl), SSFR_OK);
}

static void bench_destroy(bench *b)
{
    ssfr_measured_destroy(&b->measured);
    ssfr_graph_destroy(&b->graph);
    ssfr_stage_destroy(&b->stage);
    ssfr_gl_destroy(&b->gl);
}

static void measure(bench *b, ssfr_measure_options options)
{
    ssfr_measured_destroy(&b->measured);
    assert_int_equal(ssfr_measure_graph(&b->measured, b->graph, &b->stage->scene, &options), SSFR_OK);
}

static void assert_sane(const bench *b)
{
    const ssfr_measured *m = b->measured;
    const ssfr_report *report = ssfr_graph_report(b->graph);
    double taps = 0, bytes = 0, iterations = 0, tiles = 0;
    assert_int_equal(m->n_nodes, report->n_nodes);
    assert_true(m->frame.min > 0 && m->frame.min <= m->frame.median && m->frame.mad >= 0);
    assert_true(m->frame.outliers < m->frame.n);
    for (int i = 0; i < m->n_nodes; i++) {
        const bool ran = m->reports[i].status == SSFR_RAN;
        assert_string_equal(m->reports[i].node, report->nodes[i].node);
        if (!ran) assert_int_equal(m->nodes[i].n, 0);
        taps += ran ? m->reports[i].taps : 0;
        bytes += ran ? m->reports[i].bytes : 0;
        iterations += ran ? m->reports[i].iterations : 0;
        tiles += ran ? m->reports[i].tiles : 0;
    }
    assert_close(m->taps, taps, 0, 0);
    assert_close(m->bytes, bytes, 0, 0);
    assert_close(m->iterations, iterations, 0, 0);
    assert_close(m->tiles, tiles, 0, 0);
    assert_true(m->bytes > 0 && m->taps > 0 && m->iterations >= 40 && m->tiles >= 40 && m->unstable == 0);
}

static void a_frame_is_run_as_often_and_as_long_as_asked(void **state)
{
    (void)state;
    bench b;
    bench_create(&b, NULL);
    measure(&b, (ssfr_measure_options){.min_runs = 5});
    assert_int_equal(b.measured->frame.n, 5);
    assert_sane(&b);
    const double begun = ssfr_clock();
    measure(&b, (ssfr_measure_options){.min_runs = 1, .min_seconds = 0.15});
    assert_true(ssfr_clock() - begun >= 0.15);
    assert_true(b.measured->frame.n > 1);
    assert_sane(&b);
    bench_destroy(&b);
    assert_null(b.measured);
}

static void the_cap_on_time_leaves_one_run(void **state)
{
    (void)state;
    bench b;
    bench_create(&b, NULL);
    measure(&b, (ssfr_measure_options){.min_runs = 100000, .min_seconds = 1000, .max_seconds = 1e-9});
    assert_int_equal(b.measured->frame.n, 1);
    measure(&b, (ssfr_measure_options){.min_runs = 100000, .min_seconds = 1000, .max_seconds = 0.1});
    assert_true(b.measured->frame.n < 100000);
    bench_destroy(&b);
}

/* The sum of the nodes' times cannot exceed the frame's, and what is left is planning alone. */
static void the_nodes_of_the_cpu_add_up_to_the_frame(void **state)
{
    (void)state;
    bench b;
    double sum = 0;
    bench_create(&b, NULL);
    measure(&b, (ssfr_measure_options){.min_runs = 11, .nodes = true});
    for (int i = 0; i < b.measured->n_nodes; i++) {
        if (b.measured->reports[i].status != SSFR_RAN) continue;
        assert_int_equal(b.measured->nodes[i].n, 11);
        sum += b.measured->nodes[i].min;
    }
    assert_true(sum > 0);
    assert_true(sum <= b.measured->frame.median);
    bench_destroy(&b);
}

static void the_nodes_of_the_gpu_are_timed_when_asked(void **state)
{
    (void)state;
    bench b;
    bench_create(&b, test_gl_or_skip());
    measure(&b, (ssfr_measure_options){.min_runs = 3});
    assert_sane(&b);
    for (int i = 0; i < b.measured->n_nodes; i++) assert_int_equal(b.measured->nodes[i].n, 0);
    measure(&b, (ssfr_measure_options){.min_runs = 3, .nodes = true});
    assert_sane(&b);
    for (int i = 0; i < b.measured->n_nodes; i++)
        assert_int_equal(b.measured->nodes[i].n, b.measured->reports[i].status == SSFR_RAN ? 3 : 0);
    bench_destroy(&b);
}

/* The values of a frame that is drawn again were computed once, in no run that is timed. */
static void what_is_kept_is_timed_once_and_no_part_of_the_frame(void **state)
{
    (void)state;
    ssfr_stage_options options;
    bench b = {0};
    ssfr_stage_defaults(&options);
    options.size[0] = 64, options.size[1] = 48;
    assert_int_equal(ssfr_stage_create(&b.stage, "splash", &options), SSFR_OK);
    assert_int_equal(ssfr_graph_create(&b.graph, ssfr_pipeline_find("bagar2010"), NULL), SSFR_OK);
    measure(&b, (ssfr_measure_options){.min_runs = 3, .nodes = true});
    double bytes = 0;
    for (int i = 0; i < b.measured->n_nodes; i++) {
        const ssfr_node_report *node = &b.measured->reports[i];
        const bool values = strcmp(node->node, "weber") == 0 || strcmp(node->node, "sparse") == 0;
        assert_true(node->kept == values);
        if (node->status != SSFR_RAN) continue;
        assert_int_equal(b.measured->nodes[i].n, values ? 1 : 3);
        assert_true(b.measured->nodes[i].median > 0 && node->bytes > 0);
        if (!values) bytes += node->bytes;
    }
    assert_close(b.measured->bytes, bytes, 0, 1e-12);
    bench_destroy(&b);
}

static void a_graph_that_cannot_run_cannot_be_measured(void **state)
{
    (void)state;
    bench b;
    const ssfr_measure_options options = {.min_runs = 1};
    bench_create(&b, NULL);
    b.stage->scene.camera.w = 0;
    test_clear_log();
    assert_int_not_equal(ssfr_measure_graph(&b.measured, b.graph, &b.stage->scene, &options), SSFR_OK);
    assert_int_equal(test_n_errors(), 1);
    assert_null(b.measured);
    bench_destroy(&b);
}

static void two_subjects_run_by_turns_and_are_compared_pair_by_pair(void **state)
{
    (void)state;
    const ssfr_measure_options options = {.min_runs = 4};
    ssfr_measured *measured[2];
    ssfr_graph *other = NULL;
    ssfr_paired paired;
    bench b;
    bench_create(&b, NULL);
    assert_int_equal(ssfr_graph_create(&other, ssfr_pipeline_find("bagar2010"), NULL), SSFR_OK);
    const ssfr_subject subjects[] = {{b.graph, {.keep_all = true}}, {other, {0}}};
    assert_int_equal(ssfr_measure_subjects(measured, &paired, 2, subjects, &b.stage->scene, &options), SSFR_OK);
    for (int k = 0; k < 2; k++) {
        assert_true(measured[k]->frame.n == 4 && measured[k]->frame.median > 0);
        assert_int_equal(measured[k]->n_nodes, ssfr_graph_report(subjects[k].graph)->n_nodes);
        ssfr_measured_destroy(&measured[k]);
    }
    assert_true(ssfr_graph_report(b.graph)->covered == 1); /* nothing was left out */
    assert_true(isfinite(paired.saved) && paired.ratio > 0 && paired.ratio_mad >= 0);
    assert_int_equal(ssfr_measure_subjects(measured, &paired, 1, subjects, &b.stage->scene, &options), SSFR_OK);
    assert_true(isnan(paired.saved) && isnan(paired.ratio) && isnan(paired.ratio_mad));
    ssfr_measured_destroy(&measured[0]);
    ssfr_graph_destroy(&other);
    bench_destroy(&b);
}

static void subjects_that_fail_leave_nothing(void **state)
{
    (void)state;
    const ssfr_measure_options options = {.min_runs = 1};
    ssfr_measured *measured[2];
    ssfr_graph *other = NULL;
    ssfr_field *image = NULL;
    ssfr_paired paired;
    bench b;
    bench_create(&b, NULL);
    assert_int_equal(ssfr_graph_create(&other, ssfr_pipeline_find("bagar2010"), NULL), SSFR_OK);
    assert_int_equal(ssfr_field_create(&image, 5, 7, 3), SSFR_OK);
    assert_int_equal(ssfr_graph_import(other, "scene_color", image), SSFR_OK);
    const ssfr_subject subjects[] = {{b.graph, {0}}, {other, {0}}};
    assert_fails(SSFR_ERR_VALUE, ssfr_measure_subjects(measured, &paired, 2, subjects, &b.stage->scene, &options),
                 "scene_color");
    assert_true(measured[0] == NULL && measured[1] == NULL && isnan(paired.saved));
    ssfr_field_destroy(&image);
    ssfr_graph_destroy(&other);
    bench_destroy(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_median_and_its_deviation_are_those_of_the_definition),
        cmocka_unit_test(samples_may_stand_apart_and_stay_as_they_are),
        cmocka_unit_test(one_sample_is_its_own_median),
        cmocka_unit_test(no_sample_has_no_median),
        cmocka_unit_test(outliers_are_counted_by_the_modified_z_score_and_kept),
        cmocka_unit_test(an_outlier_among_equal_samples_is_found),
        cmocka_unit_test(the_roofline_is_time_over_the_least_time),
        cmocka_unit_test(quick_measuring_asks_for_less),
        cmocka_unit_test(memory_has_a_bandwidth),
        cmocka_unit_test(a_gpu_has_a_bandwidth),
        cmocka_unit_test(a_frame_is_run_as_often_and_as_long_as_asked),
        cmocka_unit_test(the_cap_on_time_leaves_one_run),
        cmocka_unit_test(the_nodes_of_the_cpu_add_up_to_the_frame),
        cmocka_unit_test(the_nodes_of_the_gpu_are_timed_when_asked),
        cmocka_unit_test(what_is_kept_is_timed_once_and_no_part_of_the_frame),
        cmocka_unit_test(a_graph_that_cannot_run_cannot_be_measured),
        cmocka_unit_test(two_subjects_run_by_turns_and_are_compared_pair_by_pair),
        cmocka_unit_test(subjects_that_fail_leave_nothing),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

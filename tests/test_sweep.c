/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_sweep.c: a sweep that is stopped before its first run, or can write no table. */
#include "experiments/csv.h"
#include "experiments/interrupt.h"
#include "experiments/sweep.h"
#include "tests/util.h"

#include <signal.h>

static const char text[] = "{scene: block, size: 16x8, backend: cpu, vary: {curvature_flow.iterations: [0, 1]}}";

static size_t count_rows(const char *path)
{
    ssfr_csv_table *table = NULL;
    assert_int_equal(ssfr_csv_load(&table, path), SSFR_OK);
    const size_t n = table->n_rows;
    ssfr_csv_table_destroy(&table);
    return n;
}

static void a_signal_before_the_first_run_leaves_all_runs_to_be_made(void **state)
{
    (void)state;
    char name[] = "sweep", *argv[] = {name};
    const char *path = test_path("stopped.csv");
    ssfr_sweep_spec *spec = NULL;
    ssfr_sweep_options options = {.output = path, .resume = true, .max_time = 1e-3, .shard = 1, .shards = 1, .argc = 1,
                                  .argv = argv, .what = "paper/item"};
    ssfr_stage_defaults(&options.stage);
    assert_int_equal(ssfr_sweep_spec_parse(&spec, "spec.yaml", text, sizeof text - 1), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    ssfr_interrupt_begin(); /* as the command does that the sweep is part of */
    assert_int_equal(raise(SIGTERM), 0);
    assert_fails(SSFR_ERR_IO, ssfr_sweep_run(spec, &options),
                 "paper/item: interrupted after 0 of 2 runs; the same command goes on from there");
    ssfr_interrupt_end();
    assert_int_equal(count_rows(path), 0);
    assert_int_equal(ssfr_sweep_run(spec, &options), SSFR_OK);
    assert_int_equal(count_rows(path), 2);
    ssfr_interrupt_begin();
    assert_int_equal(raise(SIGTERM), 0);
    assert_int_equal(ssfr_sweep_run(spec, &options), SSFR_OK); /* nothing was left to be stopped */
    ssfr_interrupt_end();
    ssfr_sweep_spec_destroy(&spec);
}

static void where_nothing_can_be_written_no_scene_is_loaded(void **state)
{
    (void)state;
    char name[] = "sweep", *argv[] = {name};
    const char *scene = test_path("broken.ply");
    char yaml[400];
    ssfr_sweep_spec *spec = NULL;
    ssfr_sweep_options options = {.max_time = 1e-3, .shard = 1, .shards = 1, .argc = 1, .argv = argv};
    ssfr_stage_defaults(&options.stage);
    test_write_file(scene, "ply?", 4);
    snprintf(yaml, sizeof yaml, "{scene: '%s', size: 16x8, backend: cpu}", scene);
    assert_int_equal(ssfr_sweep_spec_parse(&spec, "spec.yaml", yaml, strlen(yaml)), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    options.output = test_path("absent/table.csv");
    assert_fails(SSFR_ERR_IO, ssfr_sweep_run(spec, &options), "absent: No such file or directory");
    options.output = test_path("");
    assert_fails(SSFR_ERR_IO, ssfr_sweep_run(spec, &options), "is a folder");
    options.output = test_path("table.csv");
    assert_fails(SSFR_ERR_FORMAT, ssfr_sweep_run(spec, &options), "broken.ply"); /* then it is */
    ssfr_sweep_spec_destroy(&spec);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(where_nothing_can_be_written_no_scene_is_loaded),
        /* last, for a run that was made gives the log to the console */
        cmocka_unit_test(a_signal_before_the_first_run_leaves_all_runs_to_be_made),
    };
    return cmocka_run_group_tests_name("sweep", tests, test_capture_log, NULL);
}

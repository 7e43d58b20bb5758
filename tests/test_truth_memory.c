/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_truth_memory.c: casting truth runs out of memory at every allocation, one after the other. */
#include "tests/counted_memory.h"
#include "tests/truths.h"

#include "experiments/truth/estimate.h"
#include "experiments/truth/truth_file.h"

#include <omp.h>

/* Balls with foam before a wall: every part has something to show. */
static ssfr_stage *some_stage(void)
{
    static const double positions[] = {0, 0, 0, 0.31, 0.1, -0.2, -0.4, -0.23, 0.1}, eye[] = {0.2, 0.3, 2.385},
                        target[] = {0, 0, 0}, foam[] = {0.1, 0.2, 0.4, -0.1, -0.2, 0.35};
    static uint32_t kinds[] = {SSFR_SPRAY, SSFR_BUBBLE};
    const ssfr_particles given = {.radius = 0.05, .kind = kinds};
    ssfr_stage *stage = test_truth_stage(3, positions, 0.25, eye, target, 5, 4);
    assert_int_equal(ssfr_particles_create(&stage->foam, 2, foam, &given), SSFR_OK);
    stage->solids[0] = (ssfr_solid){.shape = SSFR_BOX, .centre = {0, 0, -1}, .half = {1, 1, 0.1},
                                    .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    stage->scene.n_solids = 1;
    return stage;
}

/* Casts, and fails with one line where the n-th allocation does; leaves nothing behind. False when none failed. */
static bool cast_without(long n, const ssfr_stage *stage, const ssfr_truth_params *params,
                         const ssfr_truth_options *options)
{
    ssfr_truth *truth = NULL;
    const long before = n_live;
    n_made = 0;
    fails_at = n;
    test_clear_log();
    const ssfr_result result = ssfr_truth_create(&truth, stage, params, options);
    fails_at = -1;
    if (n_made <= n) assert_int_equal(result, SSFR_OK);
    else assert_int_equal(result, SSFR_ERR_MEMORY);
    assert_int_equal(truth != NULL, result == SSFR_OK);
    if (result != SSFR_OK) test_assert_logged("no memory", __FILE__, __LINE__);
    ssfr_truth_destroy(&truth);
    assert_int_equal(n_live, before);
    return result != SSFR_OK;
}

static void casting_runs_out_of_memory_in_one_line(void **state)
{
    (void)state;
    static const char *const kinds[] = {"spheres", "density", "anisotropic"};
    const ssfr_truth_options options = {.every = 1, .cache = test_path("cache")};
    ssfr_stage *stage = some_stage();
    omp_set_num_threads(1);
    for (size_t k = 0; k < SSFR_COUNT(kinds); k++) {
        const char *const settings[] = {"truth.kind", kinds[k], "truth.judged", "1", NULL};
        const ssfr_truth_params params = test_truth_params(settings);
        long n = 0, cached = 0;
        while (cast_without(n, stage, &params, &options)) n++;
        while (cast_without(cached, stage, &params, &options)) cached++;
        assert_true(n > cached + 10 && cached > 10);
    }
    ssfr_stage_destroy(&stage);
}

static void estimates_and_files_run_out_of_memory_in_one_line(void **state)
{
    (void)state;
    static const char *const settings[] = {"truth.kind", "spheres", NULL};
    const ssfr_truth_params params = test_truth_params(settings);
    ssfr_stage *stage = some_stage();
    ssfr_truth *truth = test_truth_cast(stage, &params);
    ssfr_result result = SSFR_ERR_MEMORY;
    for (long n = 0; result != SSFR_OK; n++) {
        ssfr_estimate estimates[SSFR_MAX_ESTIMATES];
        ssfr_record record = {0};
        const long before = n_live;
        int count = 0;
        n_made = 0;
        fails_at = n;
        test_clear_log();
        result = ssfr_truth_estimate(truth, estimates, &count);
        if (result == SSFR_OK) result = ssfr_truth_record(&record, truth, &params);
        if (result == SSFR_OK) result = ssfr_truth_save(test_path("truth.exr"), truth, &record);
        if (result == SSFR_OK) result = ssfr_truth_preview(test_path("truth.png"), truth);
        fails_at = -1;
        ssfr_record_finish(&record);
        assert_true(result == SSFR_OK || n < 1000);
        if (result != SSFR_OK) test_assert_logged("memory", __FILE__, __LINE__);
        assert_int_equal(n_live, before);
    }
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(casting_runs_out_of_memory_in_one_line),
        cmocka_unit_test(estimates_and_files_run_out_of_memory_in_one_line),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_rig.c: the runs of a sweep: what is compared with what, and that what is kept between runs changes no number. */
#include "experiments/rig.h"
#include "tests/gl_host.h"

typedef struct fixture {
    ssfr_sweep_spec *spec;
    ssfr_rig_options options;
    ssfr_rig *rig;
} fixture;

static void begin(fixture *f, ssfr_gl *gl, const char *const *axes, bool reference)
{
    *f = (fixture){0};
    assert_int_equal(ssfr_sweep_spec_create(&f->spec), SSFR_OK);
    for (; *axes; axes++) assert_int_equal(ssfr_sweep_spec_vary_text(f->spec, "--vary", *axes), SSFR_OK);
    if (reference) {
        assert_int_equal(ssfr_sweep_spec_reference_text(f->spec, "", "curvature_flow.iterations=6"), SSFR_OK);
        assert_int_equal(ssfr_sweep_spec_reference_text(f->spec, "", "sphere_depth.splat=exact"), SSFR_OK);
    }
    assert_int_equal(ssfr_sweep_spec_complete(f->spec), SSFR_OK);
    f->options = (ssfr_rig_options){.spec = f->spec, .gl = gl,
                                    .measure = {.min_runs = 2}, .bandwidth_gl = 2.385e9, .bandwidth_cpu = 2.385e9};
    ssfr_stage_defaults(&f->options.stage);
    assert_int_equal(ssfr_rig_check(f->spec, &f->options.stage), SSFR_OK);
    assert_int_equal(ssfr_rig_create(&f->rig, &f->options), SSFR_OK);
}

static void end(fixture *f)
{
    ssfr_rig_destroy(&f->rig);
    assert_null(f->rig);
    ssfr_sweep_spec_destroy(&f->spec);
}

static void run(const fixture *f, size_t i, double values[SSFR_N_COLUMNS])
{
    size_t index[SSFR_MAX_AXES];
    ssfr_sweep_spec_run(f->spec, i, index);
    ssfr_rig_row row;
    assert_int_equal(ssfr_rig_run(f->rig, index, &row), SSFR_OK);
    memcpy(values, row.values, sizeof row.values);
}

/* Errors and work, not times. */
static void assert_same_errors(const double a[SSFR_N_COLUMNS], const double b[SSFR_N_COLUMNS])
{
    for (int i = SSFR_COLUMN_taps; i < SSFR_N_COLUMNS; i++)
        if (i != SSFR_COLUMN_roofline && memcmp(&a[i], &b[i], sizeof a[i]) != 0)
            fail_msg("%s: %.17g and %.17g", ssfr_columns[i].name, a[i], b[i]);
}

static void sizes_are_two_whole_numbers(void **state)
{
    (void)state;
    static const char *const bad[] = {"",
                                      "640",
                                      "640x",
                                      "x360",
                                      "640x360x1",
                                      "640 x 360",
                                      "0x360",
                                      "640x-1",
                                      "640x16385",
                                      "6.5x3",
                                      "99999999999999999999x1",
                                      "640X360"};
    int size[2] = {2, 385};
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) assert_false(ssfr_rig_size(bad[i], size));
    assert_true(size[0] == 2 && size[1] == 385);
    assert_true(ssfr_rig_size("16384x1", size));
    assert_true(size[0] == 16384 && size[1] == 1);
}

static void a_run_is_measured_and_compared(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=block", "size=64x48", "backend=cpu", "curvature_flow.iterations=0,6",
                                       NULL};
    double v[SSFR_N_COLUMNS];
    fixture f;
    begin(&f, NULL, axes, true);
    run(&f, 0, v);
    assert_true(v[SSFR_COLUMN_ms_min] > 0 && v[SSFR_COLUMN_ms_median] >= v[SSFR_COLUMN_ms_min]);
    assert_close(v[SSFR_COLUMN_runs], 2, 0, 0);
    assert_close(v[SSFR_COLUMN_roofline], 1e-3 * v[SSFR_COLUMN_ms_median] / (v[SSFR_COLUMN_bytes] / 2.385e9), 0, 1e-12);
    assert_close(v[SSFR_COLUMN_nan_count], 0, 0, 0);
    assert_true(isnan(v[SSFR_COLUMN_twin_depth_rms]) && isnan(v[SSFR_COLUMN_twin_psnr]));
    assert_true(v[SSFR_COLUMN_ref_depth_rms] > 0 && v[SSFR_COLUMN_ref_normal_mean_deg] > 0);
    assert_true(v[SSFR_COLUMN_ref_iou] > 0.9 && v[SSFR_COLUMN_ref_ssim] > 0.5 && v[SSFR_COLUMN_ref_psnr] > 10);
    end(&f);
}

static void a_run_that_is_the_reference_has_no_error(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=block", "size=64x48", "backend=cpu", "curvature_flow.iterations=0,6",
                                       "sphere_depth.splat=point,exact", NULL};
    double v[SSFR_N_COLUMNS];
    fixture f;
    begin(&f, NULL, axes, true);
    run(&f, 3, v);
    assert_close(v[SSFR_COLUMN_ref_depth_rms], 0, 0, 0);
    assert_close(v[SSFR_COLUMN_ref_normal_mean_deg], 0, 0, 0);
    assert_close(v[SSFR_COLUMN_ref_iou], 1, 0, 0);
    assert_true(isinf(v[SSFR_COLUMN_ref_psnr]));
    end(&f);
}

static void without_a_reference_its_columns_are_empty(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=block", "size=64x48", "backend=cpu", NULL};
    double v[SSFR_N_COLUMNS];
    fixture f;
    begin(&f, NULL, axes, false);
    run(&f, 0, v);
    for (int i = SSFR_COLUMN_ref_depth_rms; i <= SSFR_COLUMN_ref_flip; i++) assert_true(isnan(v[i]));
    end(&f);
}

/* Scene, size and parameters change between runs; each run gives what it gives on a rig of its own. */
static void what_is_kept_between_runs_changes_no_number(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=block,sphere", "size=64x48,48x64", "curvature_flow.iterations=0,3",
                                       "sphere_depth.splat=point,exact", "backend=cpu", NULL};
    static const size_t order[] = {0, 15, 3, 0, 4, 5, 12, 8, 1};
    fixture shared;
    begin(&shared, NULL, axes, true);
    for (size_t i = 0; i < SSFR_COUNT(order); i++) {
        double a[SSFR_N_COLUMNS], b[SSFR_N_COLUMNS];
        fixture own;
        run(&shared, order[i], a);
        begin(&own, NULL, axes, true);
        run(&own, order[i], b);
        end(&own);
        assert_same_errors(a, b);
    }
    end(&shared);
}

static void a_scene_without_particles_can_be_compared(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=empty", "size=64x48", "backend=cpu", NULL};
    double v[SSFR_N_COLUMNS];
    fixture f;
    begin(&f, NULL, axes, true);
    run(&f, 0, v);
    assert_true(isnan(v[SSFR_COLUMN_ref_depth_rms])); /* no surface in common */
    assert_true(isinf(v[SSFR_COLUMN_ref_psnr]));
    end(&f);
}

static void a_run_that_fails_leaves_the_next_as_it_was(void **state)
{
    (void)state;
    const char *path = test_path("gone.ply");
    char axis[256];
    static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                              "property float z\nend_header\n0 0\n";
    test_write_file(path, ply, sizeof ply - 1); /* one coordinate is missing */
    snprintf(axis, sizeof axis, "scene=%s,block", path);
    const char *const axes[] = {axis, "size=64x48", "backend=cpu", NULL};
    double v[SSFR_N_COLUMNS];
    size_t index[SSFR_MAX_AXES] = {0};
    fixture f;
    begin(&f, NULL, axes, true);
    test_clear_log();
    assert_int_not_equal(ssfr_rig_run(f.rig, index, v), SSFR_OK);
    assert_int_equal(test_n_errors(), 1);
    for (int i = 0; i < SSFR_N_COLUMNS; i++) assert_true(isnan(v[i]));
    run(&f, 1, v);
    assert_true(v[SSFR_COLUMN_ms_median] > 0);
    end(&f);
}

static void what_a_pipeline_does_not_take_is_refused(void **state)
{
    (void)state;
    static const struct {
        ssfr_result code;
        const char *axis, *message;
    } cases[] = {
        {SSFR_ERR_UNKNOWN, "curvature_flow.speed=1",
         "--vary: curvature_flow.speed: pipeline vanderlaan2009 has no such"},
        {SSFR_ERR_VALUE, "curvature_flow.iterations=1,2,-3", "curvature_flow.iterations=-3: out of range"},
        {SSFR_ERR_VALUE, "sphere_depth.splat=exact,exactly", "sphere_depth.splat=exactly: expected one of"},
        {SSFR_ERR_VALUE, "backend=gl,vulkan", "--vary: backend vulkan: expected gl or cpu"},
        {SSFR_ERR_VALUE, "size=64x48,64", "--vary: size 64: expected WxH"},
        {SSFR_ERR_UNKNOWN, "scene=block,/nowhere/at.all", "--vary: /nowhere/at.all: no such file"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_sweep_spec *spec = NULL;
        assert_int_equal(ssfr_sweep_spec_create(&spec), SSFR_OK);
        assert_int_equal(ssfr_sweep_spec_vary_text(spec, "--vary", cases[i].axis), SSFR_OK);
        assert_fails(cases[i].code, ssfr_rig_check(spec, &stage), cases[i].message);
        ssfr_sweep_spec_destroy(&spec);
    }
}

static void rounding_is_told_from_what_the_method_does(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=block", "size=64x48", "curvature_flow.iterations=3", "backend=gl,cpu",
                                       NULL};
    double gl[SSFR_N_COLUMNS], cpu[SSFR_N_COLUMNS];
    fixture f;
    ssfr_gl *context = test_gl_or_skip();
    begin(&f, context, axes, true);
    run(&f, 0, gl);
    run(&f, 1, cpu);
    assert_true(gl[SSFR_COLUMN_twin_depth_rms] < 1e-5 && gl[SSFR_COLUMN_twin_psnr] > 60);
    assert_true(gl[SSFR_COLUMN_twin_depth_rms] > 0);
    assert_true(isnan(cpu[SSFR_COLUMN_twin_depth_rms]));
    assert_close(gl[SSFR_COLUMN_ref_depth_rms], cpu[SSFR_COLUMN_ref_depth_rms], 1e-5, 0);
    assert_true(cpu[SSFR_COLUMN_ref_depth_rms] > 100 * gl[SSFR_COLUMN_twin_depth_rms]);
    assert_close(gl[SSFR_COLUMN_bytes], cpu[SSFR_COLUMN_bytes], 0, 0);
    f.options.no_twin = true;
    run(&f, 0, gl);
    assert_true(isnan(gl[SSFR_COLUMN_twin_depth_rms]));
    assert_true(gl[SSFR_COLUMN_ref_depth_rms] > 0);
    end(&f);
    ssfr_gl_destroy(&context);
}

/* The iterations that a graph has after a run of scene i. */
static const char *iterations_of(const fixture *f, size_t i, char text[32])
{
    double v[SSFR_N_COLUMNS];
    run(f, i, v);
    assert_int_equal(ssfr_graph_get(ssfr_rig_graph(f->rig), "curvature_flow.iterations", text, 32), SSFR_OK);
    return text;
}

static void what_a_scene_sets_is_gone_with_it_and_yields_to_the_sweep(void **state)
{
    (void)state;
    static const char scene[] =
        "title: A drop\nradius: 0.05\nparticles: 30\nduration: 0\ndomain: {lo: [0, 0, 0], hi: [1, 1, 1]}\n"
        "fluid: {drop: {lo: [0, 0, 0], hi: [0.3, 0.3, 0.3]}}\nset: {curvature_flow.iterations: 7}\n";
    const char *path = test_path("drop.yaml"), *cache = test_path("frames");
    char axis[160], text[32], given[32];
    fixture f;
    test_write_file(path, scene, sizeof scene - 1);
    snprintf(axis, sizeof axis, "scene=%s,block", path);
    const char *const axes[] = {axis, "size=64x48", "backend=cpu", NULL};
    begin(&f, NULL, axes, false);
    f.options.stage.cache = cache;
    f.options.stage.scale = SSFR_SCALE_FULL;
    iterations_of(&f, 1, given);
    assert_string_not_equal(given, "7");
    assert_string_equal(iterations_of(&f, 0, text), "7");
    assert_string_equal(iterations_of(&f, 1, text), given);
    assert_string_equal(iterations_of(&f, 0, text), "7");
    assert_int_equal(ssfr_sweep_spec_set_text(f.spec, "--set", "curvature_flow.iterations=5"), SSFR_OK);
    assert_string_not_equal(iterations_of(&f, 1, text), "7");
    assert_string_equal(iterations_of(&f, 0, text), "5");
    end(&f);
    char command[256];
    snprintf(command, sizeof command, "rm -rf '%s'", cache);
    assert_int_equal(system(command), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes_are_two_whole_numbers),
        cmocka_unit_test(a_run_is_measured_and_compared),
        cmocka_unit_test(a_run_that_is_the_reference_has_no_error),
        cmocka_unit_test(without_a_reference_its_columns_are_empty),
        cmocka_unit_test(what_is_kept_between_runs_changes_no_number),
        cmocka_unit_test(what_a_scene_sets_is_gone_with_it_and_yields_to_the_sweep),
        cmocka_unit_test(a_scene_without_particles_can_be_compared),
        cmocka_unit_test(a_run_that_fails_leaves_the_next_as_it_was),
        cmocka_unit_test(what_a_pipeline_does_not_take_is_refused),
        cmocka_unit_test(rounding_is_told_from_what_the_method_does),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

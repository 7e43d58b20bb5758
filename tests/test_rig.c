/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_rig.c: the runs of a sweep: what is compared with what, and that what is kept between runs changes no number. */
#include "experiments/rig.h"
#include "tests/gl_host.h"

typedef struct fixture {
    ssfr_sweep_spec *spec;
    ssfr_rig_options options;
    ssfr_rig *rig;
} fixture;

/* With what the axes say beside what the YAML (NULL: nothing) does. */
static void begin_yaml(fixture *f, ssfr_gl *gl, const char *yaml, const char *const *axes, bool reference)
{
    *f = (fixture){0};
    if (yaml)
        assert_int_equal(ssfr_sweep_spec_parse(&f->spec, "spec.yaml", yaml, strlen(yaml)), SSFR_OK);
    else
        assert_int_equal(ssfr_sweep_spec_create(&f->spec), SSFR_OK);
    for (; *axes; axes++) assert_int_equal(ssfr_sweep_spec_vary_text(f->spec, "--vary", *axes), SSFR_OK);
    if (reference) {
        assert_int_equal(ssfr_sweep_spec_reference_text(f->spec, "", "curvature_flow.iterations=6"), SSFR_OK);
        assert_int_equal(ssfr_sweep_spec_reference_text(f->spec, "", "sphere_depth.splat=exact"), SSFR_OK);
    }
    assert_int_equal(ssfr_sweep_spec_complete(f->spec), SSFR_OK);
    f->options = (ssfr_rig_options){.spec = f->spec, .gl = gl, .measure = {.min_runs = 2}, .bandwidth_gl = 2.385e9,
                                    .bandwidth_cpu = 2.385e9};
    ssfr_stage_defaults(&f->options.stage);
    assert_int_equal(ssfr_rig_check(f->spec, &f->options.stage), SSFR_OK);
    assert_int_equal(ssfr_rig_create(&f->rig, &f->options), SSFR_OK);
}

static void begin(fixture *f, ssfr_gl *gl, const char *const *axes, bool reference)
{
    begin_yaml(f, gl, NULL, axes, reference);
}

static void remove_folder(const char *path)
{
    char command[256];
    snprintf(command, sizeof command, "rm -rf '%s'", path);
    assert_int_equal(system(command), 0);
}

static void end(fixture *f)
{
    ssfr_rig_destroy(&f->rig);
    assert_null(f->rig);
    ssfr_sweep_spec_destroy(&f->spec);
}

static void run_row(const fixture *f, size_t i, ssfr_rig_row *row)
{
    size_t index[SSFR_MAX_AXES];
    ssfr_sweep_spec_run(f->spec, i, index);
    assert_int_equal(ssfr_rig_run(f->rig, index, row), SSFR_OK);
}

static void run(const fixture *f, size_t i, double values[SSFR_N_COLUMNS])
{
    ssfr_rig_row row;
    run_row(f, i, &row);
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

static double bytes_of_picture(const char *pipeline, const char *surface)
{
    ssfr_stage *stage = NULL;
    ssfr_stage_options options;
    ssfr_graph *graph = NULL;
    double bytes = 0;
    ssfr_stage_defaults(&options);
    options.size[0] = 64, options.size[1] = 48;
    assert_int_equal(ssfr_stage_create(&stage, "block", &options), SSFR_OK);
    assert_int_equal(ssfr_graph_create(&graph, ssfr_pipeline_find(pipeline), NULL), SSFR_OK);
    assert_int_equal(ssfr_graph_set(graph, "layer_composite.surface", surface), SSFR_OK);
    assert_int_equal(ssfr_graph_run(graph, &stage->scene, NULL), SSFR_OK);
    const ssfr_report *report = ssfr_graph_report(graph);
    for (int i = 0; i < report->n_nodes; i++) bytes += report->nodes[i].bytes;
    ssfr_graph_destroy(&graph);
    ssfr_stage_destroy(&stage);
    return bytes;
}

/* Depth and normals are compared, but with surface=split no picture needs them. */
static void what_no_picture_needs_is_compared_and_not_timed(void **state)
{
    (void)state;
    static const char *const axes[] = {"pipeline=bagar2010", "scene=block", "size=64x48", "backend=cpu",
                                       "downsample.factor=2,1", "layer_composite.surface=split,image", NULL};
    fixture f;
    begin(&f, NULL, axes, false);
    for (size_t i = 0; i < 2; i++) {
        double v[SSFR_N_COLUMNS];
        run(&f, i, v);
        assert_close(v[SSFR_COLUMN_bytes], bytes_of_picture("bagar2010", i ? "image" : "split"), 0, 0);
        assert_close(v[SSFR_COLUMN_nan_count], 0, 0, 0);
    }
    assert_true(bytes_of_picture("bagar2010", "split") < bytes_of_picture("bagar2010", "image"));
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
    ssfr_rig_row row;
    size_t index[SSFR_MAX_AXES] = {0};
    fixture f;
    begin(&f, NULL, axes, true);
    test_clear_log();
    assert_int_not_equal(ssfr_rig_run(f.rig, index, &row), SSFR_OK);
    assert_int_equal(test_n_errors(), 1);
    for (int i = 0; i < SSFR_N_COLUMNS; i++) assert_true(isnan(row.values[i]));
    for (int i = 0; i < SSFR_N_COLUMN_TEXTS; i++) assert_string_equal(row.texts[i], "");
    run_row(&f, 1, &row);
    assert_true(row.values[SSFR_COLUMN_ms_median] > 0);
    end(&f);
}

/* As ssfr_sweep_spec_vary_text takes an axis, or a whole sweep. */
static void assert_refused(ssfr_result code, const char *yaml, const char *axis, const char *message)
{
    ssfr_sweep_spec *spec = NULL;
    ssfr_stage_options stage;
    ssfr_stage_defaults(&stage);
    if (yaml)
        assert_int_equal(ssfr_sweep_spec_parse(&spec, "spec.yaml", yaml, strlen(yaml)), SSFR_OK);
    else
        assert_int_equal(ssfr_sweep_spec_create(&spec), SSFR_OK);
    if (axis) assert_int_equal(ssfr_sweep_spec_vary_text(spec, "--vary", axis), SSFR_OK);
    if (yaml) assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    assert_fails(code, ssfr_rig_check(spec, &stage), message);
    ssfr_sweep_spec_destroy(&spec);
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
        {SSFR_ERR_VALUE, "leave_out=true,yes", "--vary: leave_out yes: expected true or false"},
        {SSFR_ERR_VALUE, "cull=true,1", "--vary: cull 1: expected true or false"},
        {SSFR_ERR_VALUE, "frame=1,1.5", "--vary: frame 1.5: expected a whole number from 0"},
        {SSFR_ERR_VALUE, "frame=-1", "--vary: frame -1: expected a whole number from 0"},
        {SSFR_ERR_VALUE, "view=0", "--vary: view 0: the path has 0, from 0"},
        {SSFR_ERR_UNKNOWN, "variant=a", "--vary: a: no such variant; there are none"},
        {SSFR_ERR_UNKNOWN, "pipeline=vanderlaan2009,laan", "--vary: laan: no such pipeline; there are vanderlaan2009"},
        {SSFR_ERR_UNKNOWN, "scene=block,/nowhere/at.all", "--vary: /nowhere/at.all: no such file"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        assert_refused(cases[i].code, NULL, cases[i].axis, cases[i].message);
}

static void variants_are_checked_before_any_run(void **state)
{
    (void)state;
    static const struct {
        ssfr_result code;
        const char *yaml, *axis, *message;
    } cases[] = {
        {SSFR_ERR_UNKNOWN, "variants: {a: {}, b: {pipeline: laan}}", NULL, "spec.yaml:1:23: laan: no such pipeline"},
        {SSFR_ERR_UNKNOWN, "variants: {a: {}, b: {set: {curvature_flow.stop: 1}}}", NULL,
         "spec.yaml:1:29: curvature_flow.stop: pipeline vanderlaan2009 has no such parameter"},
        {SSFR_ERR_VALUE, "variants: {a: {set: {curvature_flow.iterations: -1}}}", NULL,
         "spec.yaml:1:22: curvature_flow.iterations=-1: out of range"},
        {SSFR_ERR_UNKNOWN, "variants: {a: {}, b: {pipeline: bagar2010}}\nvary: {curvature_flow.iterations: [1]}", NULL,
         "spec.yaml:2:8: curvature_flow.iterations: pipeline bagar2010 has no such parameter"},
        {SSFR_ERR_UNKNOWN, "pipeline: [vanderlaan2009, bagar2010]\nset: {curvature_flow.iterations: 1}", NULL,
         "spec.yaml:2:7: curvature_flow.iterations: pipeline bagar2010 has no such parameter"},
        {SSFR_ERR_VALUE, "variants: {a: {size: 3}}", NULL, "spec.yaml:1:16: size 3: expected WxH"},
        {SSFR_ERR_VALUE, "variants: {a: {frame: x}}", NULL, "spec.yaml:1:16: frame x: expected a whole number"},
        {SSFR_ERR_UNKNOWN, "variants: {a: {scene: no.where}}", NULL, "spec.yaml:1:16: no.where: no such file"},
        {SSFR_ERR_VALUE, "variants: {a: {scene: block}}\nscene: [block, sphere]", NULL,
         "spec.yaml:1:16: variant a has a scene of its own, and spec.yaml:2:1 has several"},
        {SSFR_ERR_UNKNOWN, "variants: {a: {}, b: {}}", "variant=b,c", "--vary: c: no such variant; there are a, b"},
        {SSFR_ERR_UNKNOWN, "variants: {a: {set: {truth.level: 0.4}}}", NULL,
         "spec.yaml:1:22: truth.level: only a sweep with `reference: truth` has it"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        assert_refused(cases[i].code, cases[i].yaml, cases[i].axis, cases[i].message);
}

static void cameras_and_paths_are_checked_before_any_run(void **state)
{
    (void)state;
    static const struct {
        ssfr_result code;
        const char *yaml, *message;
    } cases[] = {
        {SSFR_ERR_UNKNOWN, "{scene: block, camera: top}", "spec.yaml:1:16: --camera top: block has no cameras"},
        {SSFR_ERR_UNKNOWN, "{scene: bagar2010/bamboo, camera: [default, top]}",
         "spec.yaml:1:27: bagar2010/bamboo: no camera top: there are default, close"},
        {SSFR_ERR_UNKNOWN, "{scene: bagar2010/bamboo, variants: {a: {camera: top}}}",
         "spec.yaml:1:42: bagar2010/bamboo: no camera top"},
        {SSFR_ERR_VALUE, "{scene: bagar2010/bamboo, path: {camera: close, views: 2}}",
         "spec.yaml:1:27: path: bagar2010/bamboo: close: the camera has no path"},
        {SSFR_ERR_VALUE, "{scene: block, path: {views: 2}}", "spec.yaml:1:16: path: block: there is no camera"},
        {SSFR_ERR_VALUE, "{scene: bagar2010/bamboo, frame: 3, path: {views: 2, frames: follow}}",
         "spec.yaml:1:37: path: the frames follow the camera: spec.yaml:1:27 says which, too"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        assert_refused(cases[i].code, cases[i].yaml, NULL, cases[i].message);
}

static void what_cannot_be_held_against_each_other_is_refused(void **state)
{
    (void)state;
    static const struct {
        ssfr_result code;
        const char *yaml, *message;
    } cases[] = {
        {SSFR_ERR_UNKNOWN, "against: {variant: a}", "spec.yaml:1:11: against: variant is no axis of the sweep"},
        {SSFR_ERR_VALUE, "{variants: {a: {}}, against: {variant: b}}", "1:31: against: variant has no value b"},
        {SSFR_ERR_VALUE, "{scene: block, against: {scene: block}}", "against: scene: only pipeline, variant"},
        {SSFR_ERR_VALUE, "{backend: [gl, cpu], against: {backend: cpu}}", "against: backend: only pipeline, variant"},
        {SSFR_ERR_VALUE, "{reference: truth, against: {truth.kind: density}}", "against: truth.kind: only pipeline"},
        {SSFR_ERR_VALUE, "{variants: {a: {}, b: {size: 32x24}}, against: {variant: a}}",
         "against: variants b and a differ in their size"},
        {SSFR_ERR_VALUE, "{variants: {a: {frame: 1}, b: {frame: 2}}, against: {variant: a}}",
         "against: variants b and a differ in their frame"},
        {SSFR_ERR_UNKNOWN, "{variants: {a: {}}, against: {variant: a}, added: [flip]}",
         "spec.yaml:1:21: added: flip is no column of errors"},
        {SSFR_ERR_UNKNOWN, "{variants: {a: {}}, against: {variant: a}, added: [ms_median]}",
         "added: ms_median is no column of errors"},
        {SSFR_ERR_UNKNOWN, "{variants: {a: {}}, against: {variant: a}, added: [left_out]}",
         "added: left_out is no column of errors"},
        {SSFR_ERR_VALUE, "{added: [ref_flip]}", "spec.yaml:1:2: added: to what? there is no against"},
        {SSFR_ERR_VALUE, "{added: [ref_flip, ref_iou, ref_flip]}", "spec.yaml:1:2: added: ref_flip stands twice"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        assert_refused(cases[i].code, cases[i].yaml, NULL, cases[i].message);
}

/* What one sets must not stay for the next: each gives what it gives on a rig of its own. */
static void variants_leave_nothing_to_each_other(void **state)
{
    (void)state;
    static const char yaml[] =
        "size: 64x48\nbackend: cpu\nset: {sphere_depth.splat: exact}\n"
        "variants: {base: {scene: block}, few: {scene: block, set: {curvature_flow.iterations: 3}},\n"
        "  layers: {scene: sphere, pipeline: bagar2010, size: 48x32}, round: {scene: sphere}}\n";
    static const size_t order[] = {0, 1, 0, 2, 3, 2, 1};
    static const char *const none[] = {NULL};
    fixture shared;
    begin_yaml(&shared, NULL, yaml, none, false);
    for (size_t i = 0; i < SSFR_COUNT(order); i++) {
        ssfr_rig_row a, b;
        fixture own;
        run_row(&shared, order[i], &a);
        begin_yaml(&own, NULL, yaml, none, false);
        run_row(&own, order[i], &b);
        end(&own);
        assert_same_errors(a.values, b.values);
        assert_string_equal(a.texts[SSFR_COLUMN_TEXT_color_hash], b.texts[SSFR_COLUMN_TEXT_color_hash]);
    }
    end(&shared);
}

static void a_row_is_held_against_another(void **state)
{
    (void)state;
    static const char yaml[] = "{scene: block, size: 64x48, backend: cpu, variants: {base: {set: "
                               "{curvature_flow.iterations: 6}}, few: {set: {curvature_flow.iterations: 1}}}, against: "
                               "{variant: base}, added: [ref_depth_rms, ref_iou]}";
    static const char *const none[] = {NULL};
    fixture f;
    ssfr_rig_row base, few;
    begin_yaml(&f, NULL, yaml, none, true);
    run_row(&f, 0, &base);
    run_row(&f, 1, &few);
    assert_true(isfinite(base.values[SSFR_COLUMN_ms_saved]) && base.values[SSFR_COLUMN_ms_ratio] > 0);
    assert_true(few.values[SSFR_COLUMN_ms_ratio] > 0 && few.values[SSFR_COLUMN_ms_ratio_mad] >= 0);
    assert_true(base.values[SSFR_COLUMN_same_picture] == 1 && few.values[SSFR_COLUMN_same_picture] == 0);
    assert_close(base.added[0], 0, 0, 0);
    assert_true(few.added[0] != 0);
    assert_close(few.added[0], few.values[SSFR_COLUMN_ref_depth_rms] - base.values[SSFR_COLUMN_ref_depth_rms], 0, 0);
    assert_close(few.added[1], few.values[SSFR_COLUMN_ref_iou] - base.values[SSFR_COLUMN_ref_iou], 0, 0);
    assert_true(isnan(few.added[2]));
    end(&f);
}

/* Normals, which no picture of layers needs, are not asked for while times are measured; afterwards they are again. */
static void what_no_picture_needs_is_compared_of_the_other_row_too(void **state)
{
    (void)state;
    static const char yaml[] = "{pipeline: bagar2010, scene: block, size: 64x48, backend: cpu, variants: {base: {}, few: "
                               "{set: {adaptive_flow.iterations: 1}}}, against: {variant: base}, added: "
                               "[ref_normal_mean_deg], reference: {sphere_depth.splat: exact}}";
    static const char *const none[] = {NULL};
    fixture f;
    ssfr_rig_row base, few;
    begin_yaml(&f, NULL, yaml, none, false);
    run_row(&f, 0, &base);
    run_row(&f, 1, &few);
    assert_close(base.added[0], 0, 0, 0);
    assert_true(isfinite(few.added[0]) && few.added[0] != 0);
    end(&f);
}

static void without_another_row_nothing_is_saved_or_added(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=block", "size=64x48", "backend=cpu", NULL};
    fixture f;
    ssfr_rig_row row;
    begin(&f, NULL, axes, true);
    run_row(&f, 0, &row);
    assert_true(isnan(row.values[SSFR_COLUMN_ms_saved]) && isnan(row.values[SSFR_COLUMN_ms_ratio]) &&
                isnan(row.values[SSFR_COLUMN_ms_ratio_mad]) && isnan(row.added[0]));
    assert_true(isnan(row.values[SSFR_COLUMN_same_picture]) && isnan(row.values[SSFR_COLUMN_camera_time]));
    end(&f);
}

static void leaving_out_is_an_axis_and_changes_no_bit(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=block", "size=64x48", "backend=cpu", "leave_out=true,false", NULL};
    fixture f;
    ssfr_rig_row lean, full;
    begin(&f, NULL, axes, false);
    run_row(&f, 0, &lean);
    run_row(&f, 1, &full);
    assert_string_equal(lean.texts[SSFR_COLUMN_TEXT_left_out],
                        "surface_noise unwanted;noise_normals needless;noise_foam needless");
    assert_string_equal(full.texts[SSFR_COLUMN_TEXT_left_out], "");
    assert_int_equal(strlen(lean.texts[SSFR_COLUMN_TEXT_color_hash]), 16);
    assert_string_equal(lean.texts[SSFR_COLUMN_TEXT_color_hash], full.texts[SSFR_COLUMN_TEXT_color_hash]);
    assert_true(lean.values[SSFR_COLUMN_covered] <= 1 && full.values[SSFR_COLUMN_covered] == 1);
    assert_true(full.values[SSFR_COLUMN_taps] > lean.values[SSFR_COLUMN_taps]);
    end(&f);
}

static void culling_is_an_axis_and_changes_no_bit(void **state)
{
    (void)state;
    static const char yaml[] = "against: {cull: false}\n";
    static const char *const axes[] = {"scene=splash", "size=64x48", "backend=cpu", "cull=true,false", NULL};
    fixture f;
    ssfr_rig_row culled, all;
    begin_yaml(&f, NULL, yaml, axes, false);
    f.options.stage.eye[0] = 0.1, f.options.stage.eye[1] = 0.3, f.options.stage.eye[2] = 0.2;
    run_row(&f, 0, &culled);
    run_row(&f, 1, &all);
    const double *a = culled.values, *b = all.values;
    assert_string_equal(culled.texts[SSFR_COLUMN_TEXT_color_hash], all.texts[SSFR_COLUMN_TEXT_color_hash]);
    assert_string_equal(culled.texts[SSFR_COLUMN_TEXT_left_out], all.texts[SSFR_COLUMN_TEXT_left_out]);
    assert_true(b[SSFR_COLUMN_packets_seen] == b[SSFR_COLUMN_packets]);
    assert_true(a[SSFR_COLUMN_packets] == b[SSFR_COLUMN_packets]);
    assert_true(a[SSFR_COLUMN_packets_seen] > 0 && a[SSFR_COLUMN_packets_seen] < a[SSFR_COLUMN_packets]);
    assert_true(a[SSFR_COLUMN_particles_seen] < b[SSFR_COLUMN_particles_seen]);
    assert_true(a[SSFR_COLUMN_covered] <= 1 && b[SSFR_COLUMN_covered] == 1);
    assert_true(isfinite(a[SSFR_COLUMN_ms_ratio]));
    assert_true(isnan(a[SSFR_COLUMN_simulation_ms])); /* it is made by code */
    assert_true(a[SSFR_COLUMN_foam_share] == 0 && a[SSFR_COLUMN_spray_share] == 0);
    end(&f);
}

/* With a threshold of 0 all is foam, with one that nothing reaches none is; spray is what has few neighbours. */
static void shares_of_foam_and_spray_are_those_of_all_particles(void **state)
{
    (void)state;
    static const char *const axes[] = {"pipeline=bagar2010", "scene=splash", "size=48x32", "backend=cpu",
                                       "weber_foam.threshold=0,1e30", NULL};
    fixture f;
    ssfr_rig_row foam, water;
    begin(&f, NULL, axes, false);
    run_row(&f, 0, &foam);
    run_row(&f, 1, &water);
    assert_true(foam.values[SSFR_COLUMN_foam_share] == 1);
    assert_true(water.values[SSFR_COLUMN_foam_share] == 0);
    assert_true(foam.values[SSFR_COLUMN_spray_share] > 0 && foam.values[SSFR_COLUMN_spray_share] < 1);
    end(&f);
}

static void smoothing_that_is_not_stable_is_not_bounded(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=block", "size=64x48", "backend=cpu", "curvature_flow.iterations=100",
                                       "curvature_flow.unstable=limit,allow", NULL};
    fixture f;
    ssfr_rig_row stable, wild;
    begin(&f, NULL, axes, false);
    assert_int_equal(ssfr_sweep_spec_set_text(f.spec, "--set", "curvature_flow.step=100"), SSFR_OK);
    run_row(&f, 0, &stable);
    run_row(&f, 1, &wild);
    assert_true(stable.values[SSFR_COLUMN_bounded] == 1 && stable.values[SSFR_COLUMN_finite] == 1);
    assert_true(wild.values[SSFR_COLUMN_bounded] == 0);
    end(&f);
}

/* A drop in the middle, and a camera that goes past it. */
static const char drop[] =
    "title: A drop\nradius: 0.05\nparticles: 30\nduration: 0.2\nframe_rate: 10\n"
    "domain: {lo: [0, 0, 0], hi: [1, 1, 1]}\nfluid: {drop: {lo: [0, 0, 0], hi: [0.3, 0.3, 0.3]}}\n"
    "cameras: {path: {target: [0.2, 0.1, 0.2], keys: [{time: 0, eye: [0, 1, 2]}, {time: 0.2, eye: [1, 0.5, 3]}]}}\n";

static void begin_drop(fixture *f, const char *rest)
{
    const char *path = test_path("drop_path.yaml");
    char yaml[512];
    static const char *const none[] = {NULL};
    test_write_file(path, drop, sizeof drop - 1);
    snprintf(yaml, sizeof yaml, "{scene: %s, size: 32x24, backend: cpu, %s}", path, rest);
    begin_yaml(f, NULL, yaml, none, false);
    f->options.stage.cache = test_path("drop_frames");
    f->options.stage.scale = SSFR_SCALE_FULL;
}

static void assert_view(const fixture *f, size_t i, double x, long frame)
{
    size_t index[SSFR_MAX_AXES];
    const ssfr_stage *stage;
    ssfr_sweep_spec_run(f->spec, i, index);
    assert_int_equal(ssfr_rig_stage(f->rig, index, &stage), SSFR_OK);
    assert_close(stage->scene.camera.eye[0], x, 1e-12, 0);
    assert_int_equal(stage->frame, frame);
}

static void end_drop(fixture *f)
{
    end(f);
    remove_folder(test_path("drop_frames"));
}

static void views_are_evenly_spaced_along_the_path(void **state)
{
    (void)state;
    fixture f;
    ssfr_rig_row row;
    begin_drop(&f, "frame: 1, path: {camera: path, views: 5}");
    for (int i = 0; i < 5; i++) assert_view(&f, (size_t)i, 0.25 * i, 1);
    run_row(&f, 3, &row);
    assert_close(row.values[SSFR_COLUMN_camera_time], 0.15, 1e-15, 0);
    end_drop(&f);
    begin_drop(&f, "path: {views: 1}");
    assert_view(&f, 0, 0, 2); /* of three frames the one two thirds of the way */
    end_drop(&f);
    begin_drop(&f, "path: {views: 5, frames: follow}");
    static const long frames[] = {0, 1, 1, 2, 2}; /* those nearest to 0, 0.05, .. 0.2 s */
    for (int i = 4; i >= 0; i--) assert_view(&f, (size_t)i, 0.25 * i, frames[i]);
    end_drop(&f);
}

static void what_tells_the_time_twice_is_refused(void **state)
{
    (void)state;
    fixture f;
    begin_drop(&f, "path: {views: 2, frames: follow}");
    f.options.stage.camera_time = 0.1;
    assert_fails(SSFR_ERR_VALUE, ssfr_rig_check(f.spec, &f.options.stage), "--camera-time says where the camera is");
    f.options.stage.camera_time = NAN;
    f.options.stage.time = 0.1;
    assert_fails(SSFR_ERR_VALUE, ssfr_rig_check(f.spec, &f.options.stage), "--frame or --time says which, too");
    end_drop(&f);
    begin_drop(&f, "frame: 1");
    f.options.stage.time = 0.1;
    assert_fails(SSFR_ERR_VALUE, ssfr_rig_check(f.spec, &f.options.stage), "frame: --time says which, too");
    end_drop(&f);
    begin_drop(&f, "frame: [1, 9]");
    size_t index[SSFR_MAX_AXES];
    ssfr_rig_row row;
    ssfr_sweep_spec_run(f.spec, 1, index);
    assert_fails(SSFR_ERR_VALUE, ssfr_rig_run(f.rig, index, &row), "there is no frame 9");
    run_row(&f, 0, &row);
    end_drop(&f);
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
    remove_folder(cache);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes_are_two_whole_numbers),
        cmocka_unit_test(a_run_is_measured_and_compared),
        cmocka_unit_test(a_run_that_is_the_reference_has_no_error),
        cmocka_unit_test(without_a_reference_its_columns_are_empty),
        cmocka_unit_test(what_no_picture_needs_is_compared_and_not_timed),
        cmocka_unit_test(what_is_kept_between_runs_changes_no_number),
        cmocka_unit_test(what_a_scene_sets_is_gone_with_it_and_yields_to_the_sweep),
        cmocka_unit_test(a_scene_without_particles_can_be_compared),
        cmocka_unit_test(a_run_that_fails_leaves_the_next_as_it_was),
        cmocka_unit_test(what_a_pipeline_does_not_take_is_refused),
        cmocka_unit_test(variants_are_checked_before_any_run),
        cmocka_unit_test(cameras_and_paths_are_checked_before_any_run),
        cmocka_unit_test(what_cannot_be_held_against_each_other_is_refused),
        cmocka_unit_test(variants_leave_nothing_to_each_other),
        cmocka_unit_test(a_row_is_held_against_another),
        cmocka_unit_test(what_no_picture_needs_is_compared_of_the_other_row_too),
        cmocka_unit_test(without_another_row_nothing_is_saved_or_added),
        cmocka_unit_test(leaving_out_is_an_axis_and_changes_no_bit),
        cmocka_unit_test(culling_is_an_axis_and_changes_no_bit),
        cmocka_unit_test(shares_of_foam_and_spray_are_those_of_all_particles),
        cmocka_unit_test(smoothing_that_is_not_stable_is_not_bounded),
        cmocka_unit_test(views_are_evenly_spaced_along_the_path),
        cmocka_unit_test(what_tells_the_time_twice_is_refused),
        cmocka_unit_test(rounding_is_told_from_what_the_method_does),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

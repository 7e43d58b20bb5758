/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_truth_sweep.c: splats and rays judge each other: exact splats are the union of the particles' spheres, and so is
 * one kind of truth. Then sweeps whose reference is the truth. */
#include "experiments/rig.h"
#include "tests/util.h"

/* Both are found in doubles from the same floats: what is left is rounding, of places a few metres from the eye. */
static const double rounding = 1e-9; /* m */

/* ---- the same image by two ways ---------------------------------------------------------------------------------- */

typedef struct both { /* images of one scene */
    ssfr_stage *stage;
    ssfr_field *depth, *thickness; /* splatted */
    ssfr_truth *truth;             /* of spheres */
} both;

static void splat(both *b)
{
    static const char *const settings[][2] = {{"sphere_depth.splat", "exact"}, {"thickness.splat", "exact"}};
    ssfr_graph *graph = NULL;
    assert_int_equal(ssfr_graph_create(&graph, ssfr_pipeline_find("vanderlaan2009"), NULL), SSFR_OK);
    for (size_t i = 0; i < SSFR_COUNT(settings); i++)
        assert_int_equal(ssfr_graph_set(graph, settings[i][0], settings[i][1]), SSFR_OK);
    assert_int_equal(ssfr_graph_want(graph, "fluid_depth"), SSFR_OK);
    assert_int_equal(ssfr_graph_want(graph, "thickness"), SSFR_OK);
    assert_int_equal(ssfr_graph_run(graph, &b->stage->scene, NULL), SSFR_OK);
    assert_int_equal(ssfr_graph_read(graph, "fluid_depth", &b->depth), SSFR_OK);
    assert_int_equal(ssfr_graph_read(graph, "thickness", &b->thickness), SSFR_OK);
    ssfr_graph_destroy(&graph);
}

/* Without what could hide fluid from the splats: walls and floor hide none from these rays. */
static void make_both(both *b, const char *scene, int w, int h)
{
    const ssfr_truth_options options = {.every = 1, .no_cache = true};
    ssfr_stage_options stage;
    ssfr_truth_params params;
    *b = (both){0};
    ssfr_stage_defaults(&stage);
    stage.size[0] = w, stage.size[1] = h;
    assert_int_equal(ssfr_stage_create(&b->stage, scene, &stage), SSFR_OK);
    b->stage->scene.n_solids = 0;
    b->stage->scene.floor = -INFINITY;
    splat(b);
    ssfr_truth_defaults(&params);
    params.fluid.kind = SSFR_CONTINUUM_SPHERES;
    params.cast.parts = SSFR_TRUTH_SURFACE | SSFR_TRUTH_THICKNESS;
    assert_int_equal(ssfr_truth_create(&b->truth, b->stage, &params, &options), SSFR_OK);
}

static void finish_both(both *b)
{
    ssfr_truth_destroy(&b->truth);
    ssfr_field_destroy(&b->depth);
    ssfr_field_destroy(&b->thickness);
    ssfr_stage_destroy(&b->stage);
}

/* Depth and outline, and the sum of all chords, in every pixel. Where a ray only grazes a sphere the two may differ in
 * whether it meets it: there the chord is as short as rounding makes it. */
static void assert_same_spheres(const char *scene, int w, int h)
{
    both b;
    size_t n_surface = 0, n_alone = 0;
    make_both(&b, scene, w, h);
    for (int i = 0; i < w * h; i++) {
        const double splatted = b.depth->data[i], cast = b.truth->channels[SSFR_TRUTH_depth]->data[i];
        const bool a = fabs(splatted) < SSFR_SURFACE, t = fabs(cast) < SSFR_SURFACE;
        n_surface += a && t;
        n_alone += a != t;
        if (a && t) assert_close(splatted, cast, rounding, 0);
        assert_close(b.thickness->data[i], b.truth->channels[SSFR_TRUTH_content]->data[i], rounding, rounding);
        assert_true(b.truth->channels[SSFR_TRUTH_thickness]->data[i] <= b.thickness->data[i] + rounding);
    }
    assert_true(n_surface > (size_t)(w * h) / 50);
    assert_int_equal(n_alone, 0);
    finish_both(&b);
}

static void an_exact_splat_is_the_sphere_that_a_ray_meets(void **state)
{
    (void)state;
    assert_same_spheres("sphere", 97, 61);
}

static void exact_splats_of_a_fluid_are_the_union_of_its_spheres(void **state)
{
    (void)state;
    assert_same_spheres("block", 96, 64);
    assert_same_spheres("splash", 64, 36);
}

static void nothing_is_seen_of_no_fluid(void **state)
{
    (void)state;
    both b;
    make_both(&b, "empty", 16, 9);
    for (int i = 0; i < 16 * 9; i++) {
        assert_true(b.truth->channels[SSFR_TRUTH_depth]->data[i] <= -SSFR_SURFACE);
        assert_close(b.truth->channels[SSFR_TRUTH_content]->data[i], 0, 0, 0);
    }
    finish_both(&b);
}

/* ---- sweeps ------------------------------------------------------------------------------------------------------ */

typedef struct fixture {
    ssfr_sweep_spec *spec;
    ssfr_rig_options options;
    ssfr_rig *rig;
} fixture;

static void begin(fixture *f, const char *const *axes, const char *const *settings)
{
    *f = (fixture){0};
    assert_int_equal(ssfr_sweep_spec_create(&f->spec), SSFR_OK);
    for (; *axes; axes++) assert_int_equal(ssfr_sweep_spec_vary_text(f->spec, "--vary", *axes), SSFR_OK);
    for (; *settings; settings++) assert_int_equal(ssfr_sweep_spec_set_text(f->spec, "--set", *settings), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_reference_text(f->spec, "--reference", "truth"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_complete(f->spec), SSFR_OK);
    f->options = (ssfr_rig_options){.spec = f->spec, .measure = {.min_runs = 1}, .bandwidth_gl = 2.385e9,
                                    .bandwidth_cpu = 2.385e9};
    ssfr_stage_defaults(&f->options.stage);
    f->options.stage.cache = test_path("cache");
    assert_int_equal(ssfr_rig_check(f->spec, &f->options.stage), SSFR_OK);
    assert_int_equal(ssfr_rig_create(&f->rig, &f->options), SSFR_OK);
}

static void end(fixture *f)
{
    ssfr_rig_destroy(&f->rig);
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

static const char *const block[] = {"scene=block", "size=64x48", "backend=cpu", NULL};
static const char *const nothing[] = {NULL};

/* What the truth's own channels say of its errors, pixel by pixel. */
static void columns_of_the_truths_errors_are_those_of_its_channels(void **state)
{
    (void)state;
    static const char *const settings[] = {"curvature_flow.iterations=0", NULL};
    const size_t index[SSFR_MAX_AXES] = {0};
    const ssfr_truth_options options = {.every = 1};
    const ssfr_stage *stage;
    ssfr_truth *truth = NULL;
    double v[SSFR_N_COLUMNS], sums[3] = {0}, n[2] = {0}, largest = 0;
    fixture f;
    begin(&f, block, settings);
    run(&f, 0, v);
    assert_int_equal(ssfr_rig_stage(f.rig, index, &stage), SSFR_OK);
    assert_int_equal(ssfr_truth_create(&truth, stage, ssfr_rig_truth(f.rig), &options), SSFR_OK);
    ssfr_field *const *c = truth->channels;
    for (int i = 0; i < truth->w * truth->h; i++) {
        const bool surface = fabs(c[SSFR_TRUTH_depth]->data[i]) < SSFR_SURFACE;
        const bool fluid = c[SSFR_TRUTH_thickness]->data[i] > 0;
        n[0] += surface, n[1] += fluid;
        if (surface) sums[0] += c[SSFR_TRUTH_depth_err]->data[i], sums[1] += c[SSFR_TRUTH_normal_err]->data[i];
        if (surface) largest = fmax(largest, c[SSFR_TRUTH_depth_err]->data[i]);
        if (fluid) sums[2] += c[SSFR_TRUTH_thickness_err]->data[i];
    }
    assert_true(n[0] > 100 && n[0] < truth->w * truth->h && sums[0] > 0 && sums[1] > 0 && sums[2] > 0);
    assert_close(v[SSFR_COLUMN_truth_depth_err_mean], sums[0] / n[0], 0, 1e-9);
    assert_close(v[SSFR_COLUMN_truth_depth_err_max], largest, 0, 1e-12);
    assert_close(v[SSFR_COLUMN_truth_normal_err_mean_deg], sums[1] / n[0] * 180 / acos(-1), 0, 1e-9);
    assert_close(v[SSFR_COLUMN_truth_thickness_err_mean], sums[2] / n[1], 0, 1e-9);
    ssfr_truth_destroy(&truth);
    end(&f);
}

static void exact_splats_have_no_error_against_spheres(void **state)
{
    (void)state;
    static const char *const settings[] = {"truth.kind=spheres", "sphere_depth.splat=exact", "thickness.splat=exact",
                                           "curvature_flow.iterations=0", "downsample.factor=1", NULL};
    double v[SSFR_N_COLUMNS];
    fixture f;
    begin(&f, block, settings);
    run(&f, 0, v);
    assert_close(v[SSFR_COLUMN_ref_depth_rms], 0, rounding, 0);
    assert_close(v[SSFR_COLUMN_method_depth_rms], 0, rounding, 0);
    assert_close(v[SSFR_COLUMN_ref_depth_mean_interior], 0, rounding, 0);
    assert_close(v[SSFR_COLUMN_ref_depth_median_interior_radii], 0, rounding, 0);
    assert_close(v[SSFR_COLUMN_ref_iou], 1, 0, 0);
    assert_true(v[SSFR_COLUMN_ref_thickness_ratio] > 1); /* balls overlap: the sum of chords counts that twice */
    assert_true(v[SSFR_COLUMN_truth_depth_err_max] >= v[SSFR_COLUMN_truth_depth_err_mean]);
    assert_true(v[SSFR_COLUMN_truth_depth_err_mean] < rounding);
    assert_true(v[SSFR_COLUMN_truth_thickness_err_mean] < rounding);
    assert_true(v[SSFR_COLUMN_truth_normal_err_mean_deg] < 1e-3);
    end(&f);
}

/* What a wall or the floor hides is not seen by rays either. */
static void solids_hide_from_rays_what_they_hide_from_splats(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=splash", "size=64x36", "backend=cpu", "truth.solids=1,0", NULL};
    static const char *const settings[] = {"truth.kind=spheres", "sphere_depth.splat=exact", "downsample.factor=1",
                                           "curvature_flow.iterations=0", NULL};
    double hidden[SSFR_N_COLUMNS], seen[SSFR_N_COLUMNS];
    fixture f;
    begin(&f, axes, settings);
    run(&f, 0, hidden);
    run(&f, 1, seen);
    assert_close(hidden[SSFR_COLUMN_ref_iou], 1, 0, 0);
    assert_close(hidden[SSFR_COLUMN_ref_depth_rms], 0, rounding, 0);
    assert_true(seen[SSFR_COLUMN_ref_thickness_ratio] < hidden[SSFR_COLUMN_ref_thickness_ratio]);
    end(&f);
}

/* The twin is the frame itself here, so that the method's error is all the error there is. */
static void errors_stand_in_metres_and_in_radii_and_for_the_twin(void **state)
{
    (void)state;
    double v[SSFR_N_COLUMNS];
    fixture f;
    const ssfr_stage *stage;
    size_t index[SSFR_MAX_AXES] = {0};
    begin(&f, block, nothing);
    run(&f, 0, v);
    assert_int_equal(ssfr_rig_stage(f.rig, index, &stage), SSFR_OK);
    const double radius = stage->particles->radius;
    assert_true(v[SSFR_COLUMN_ref_depth_rms_interior] > 0.01 * radius);
    assert_close(v[SSFR_COLUMN_ref_depth_rms_interior_radii] * radius, v[SSFR_COLUMN_ref_depth_rms_interior], 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_depth_mean_interior_radii] * radius, v[SSFR_COLUMN_ref_depth_mean_interior], 0,
                 1e-12);
    assert_close(v[SSFR_COLUMN_method_depth_rms], v[SSFR_COLUMN_ref_depth_rms], 0, 0);
    assert_close(v[SSFR_COLUMN_method_depth_rms_interior], v[SSFR_COLUMN_ref_depth_rms_interior], 0, 0);
    assert_close(v[SSFR_COLUMN_method_depth_mean_interior], v[SSFR_COLUMN_ref_depth_mean_interior], 0, 0);
    assert_close(v[SSFR_COLUMN_method_normal_interior_deg], v[SSFR_COLUMN_ref_normal_interior_deg], 0, 0);
    assert_true(v[SSFR_COLUMN_ref_normal_interior_deg] > 1 && v[SSFR_COLUMN_ref_normal_interior_deg] < 60);
    assert_true(v[SSFR_COLUMN_ref_depth_rms_edge] > 0);
    assert_true(isnan(v[SSFR_COLUMN_ref_psnr]) && isnan(v[SSFR_COLUMN_twin_depth_rms])); /* no colour was cast */
    end(&f);
}

static void the_parts_of_truth_say_which_errors_there_are(void **state)
{
    (void)state;
    static const char *const thickness[] = {"truth.parts=thickness", NULL};
    static const char *const colour[] = {"truth.parts=colour", "path.depth=2", NULL};
    double v[SSFR_N_COLUMNS];
    fixture f;
    begin(&f, block, thickness);
    run(&f, 0, v);
    assert_true(isnan(v[SSFR_COLUMN_ref_depth_rms]) && isnan(v[SSFR_COLUMN_ref_normal_interior_deg]));
    assert_true(isnan(v[SSFR_COLUMN_truth_depth_err_mean]));
    assert_true(v[SSFR_COLUMN_ref_thickness_rms] > 0 && v[SSFR_COLUMN_truth_thickness_err_mean] >= 0);
    end(&f);
    begin(&f, block, colour);
    run(&f, 0, v);
    assert_true(isnan(v[SSFR_COLUMN_ref_depth_rms]) && isnan(v[SSFR_COLUMN_ref_thickness_rms]));
    assert_true(v[SSFR_COLUMN_ref_psnr] > 5 && v[SSFR_COLUMN_ref_psnr] < 60 && v[SSFR_COLUMN_ref_ssim] > 0.2);
    assert_true(v[SSFR_COLUMN_ref_flip] > 0 && v[SSFR_COLUMN_ref_flip] < 0.5);
    end(&f);
}

/* Of what is measured, all but times. */
static void assert_same_errors(const double a[SSFR_N_COLUMNS], const double b[SSFR_N_COLUMNS])
{
    for (int i = SSFR_COLUMN_taps; i < SSFR_N_COLUMNS; i++)
        if (i != SSFR_COLUMN_roofline && memcmp(&a[i], &b[i], sizeof a[i]) != 0)
            fail_msg("%s: %.17g and %.17g", ssfr_columns[i].name, a[i], b[i]);
}

static void what_is_kept_of_truth_changes_no_number(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=block,sphere", "size=40x30,30x40", "curvature_flow.iterations=0,3",
                                       "truth.kind=spheres,density", "truth.level=0.5,0.4", "backend=cpu", NULL};
    static const size_t order[] = {0, 31, 3, 1, 0, 8, 21, 2};
    fixture shared;
    begin(&shared, axes, nothing);
    for (size_t i = 0; i < SSFR_COUNT(order); i++) {
        double a[SSFR_N_COLUMNS], b[SSFR_N_COLUMNS];
        fixture own;
        run(&shared, order[i], a);
        begin(&own, axes, nothing);
        run(&own, order[i], b);
        end(&own);
        assert_same_errors(a, b);
    }
    end(&shared);
}

/* Seven digits of a time are not alike by chance. */
static void runs_that_differ_in_truth_alone_share_a_frame(void **state)
{
    (void)state;
    static const char *const axes[] = {"scene=block", "size=40x30", "curvature_flow.iterations=0,3",
                                       "truth.kind=spheres,density", "backend=cpu", NULL};
    double a[SSFR_N_COLUMNS], b[SSFR_N_COLUMNS], other[SSFR_N_COLUMNS];
    fixture f;
    begin(&f, axes, nothing);
    run(&f, 0, a);
    run(&f, 1, b);
    run(&f, 2, other);
    assert_close(a[SSFR_COLUMN_ms_median], b[SSFR_COLUMN_ms_median], 0, 0);
    assert_true(a[SSFR_COLUMN_ref_depth_rms_interior] != b[SSFR_COLUMN_ref_depth_rms_interior]);
    assert_true(a[SSFR_COLUMN_iterations] != other[SSFR_COLUMN_iterations]);
    end(&f);
}

static void what_is_set_of_the_water_is_set_in_truth_too(void **state)
{
    (void)state;
    static const char *const settings[] = {"medium.ior=1.2385", "truth.level=0.42", NULL};
    fixture f;
    begin(&f, block, settings);
    const ssfr_truth_params *truth = ssfr_rig_truth(f.rig);
    assert_non_null(truth);
    assert_close(truth->world.medium.ior, 1.2385, 0, 0);
    assert_close(truth->fluid.level, 0.42, 0, 0);
    assert_int_equal(truth->cast.parts, SSFR_TRUTH_SURFACE | SSFR_TRUTH_THICKNESS);
    assert_true(truth->cast.solids);
    end(&f);
}

static void parameters_of_truth_are_checked_before_anything_runs(void **state)
{
    (void)state;
    static const struct {
        bool truth;
        ssfr_result code;
        const char *axis, *message;
    } cases[] = {
        {true, SSFR_ERR_UNKNOWN, "truth.hind=1", "--vary: truth.hind: no such parameter; there are kind"},
        {true, SSFR_ERR_VALUE, "truth.kind=spheres,cubes", "--vary: truth.kind=cubes: expected one of"},
        {true, SSFR_ERR_VALUE, "truth.level=0.5,1.5", "--vary: truth.level=1.5: out of range"},
        {true, SSFR_ERR_VALUE, "medium.ior=-1", "--vary: medium.ior=-1: out of range"},
        {true, SSFR_ERR_UNKNOWN, "curvature_flow.speed=1", "--vary: curvature_flow.speed: pipeline vanderlaan2009"},
        {false, SSFR_ERR_UNKNOWN, "truth.kind=spheres", "--vary: truth.kind: only a sweep with `reference: truth`"},
        {false, SSFR_ERR_UNKNOWN, "path.depth=3", "--vary: path.depth: only a sweep with `reference: truth`"},
    };
    ssfr_stage_options stage;
    ssfr_stage_defaults(&stage);
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_sweep_spec *spec = NULL;
        assert_int_equal(ssfr_sweep_spec_create(&spec), SSFR_OK);
        if (cases[i].truth) assert_int_equal(ssfr_sweep_spec_reference_text(spec, "--reference", "truth"), SSFR_OK);
        assert_int_equal(ssfr_sweep_spec_vary_text(spec, "--vary", cases[i].axis), SSFR_OK);
        assert_fails(cases[i].code, ssfr_rig_check(spec, &stage), cases[i].message);
        ssfr_sweep_spec_destroy(&spec);
    }
}

static int remove_cache(void **state)
{
    (void)state;
    char command[512];
    snprintf(command, sizeof command, "rm -rf '%s'", test_path("cache"));
    return system(command);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_exact_splat_is_the_sphere_that_a_ray_meets),
        cmocka_unit_test(exact_splats_of_a_fluid_are_the_union_of_its_spheres),
        cmocka_unit_test(nothing_is_seen_of_no_fluid),
        cmocka_unit_test(columns_of_the_truths_errors_are_those_of_its_channels),
        cmocka_unit_test(exact_splats_have_no_error_against_spheres),
        cmocka_unit_test(solids_hide_from_rays_what_they_hide_from_splats),
        cmocka_unit_test(errors_stand_in_metres_and_in_radii_and_for_the_twin),
        cmocka_unit_test(the_parts_of_truth_say_which_errors_there_are),
        cmocka_unit_test(what_is_kept_of_truth_changes_no_number),
        cmocka_unit_test(runs_that_differ_in_truth_alone_share_a_frame),
        cmocka_unit_test(what_is_set_of_the_water_is_set_in_truth_too),
        cmocka_unit_test(parameters_of_truth_are_checked_before_anything_runs),
    };
    return cmocka_run_group_tests(tests, test_capture_log, remove_cache);
}

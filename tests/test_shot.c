/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_shot.c: a sweep's columns of errors, of images whose differences are known. */
#include "experiments/shot.h"
#include "tests/frames.h"

enum { W = 12, H = 9 };

static const double radius = 0.02;

static ssfr_shot make(double depth, const double normal[3], double thickness, double grey)
{
    static const int channels[SSFR_SHOT_PARTS] = {3, 1, 3, 1};
    ssfr_shot shot = {0};
    for (int part = 0; part < SSFR_SHOT_PARTS; part++)
        assert_int_equal(ssfr_field_create(&shot.parts[part], W, H, channels[part]), SSFR_OK);
    ssfr_field_fill(shot.parts[SSFR_SHOT_COLOUR], grey);
    ssfr_field_fill(shot.parts[SSFR_SHOT_DEPTH], depth);
    ssfr_field_fill(shot.parts[SSFR_SHOT_THICKNESS], thickness);
    for (int i = 0; i < 3 * W * H; i++) shot.parts[SSFR_SHOT_NORMAL]->data[i] = normal[i % 3];
    return shot;
}

static const double towards[] = {0, 0, 1};

static void clear(double values[SSFR_N_COLUMNS])
{
    for (int i = 0; i < SSFR_N_COLUMNS; i++) values[i] = NAN;
}

/* Most interior pixels are 0.01 m nearer, others 0.05 m farther; the rim is 0.3 m nearer, its normals 90 deg off. */
static void make_pair(ssfr_shot *shot, ssfr_shot *reference)
{
    *shot = make(-2, towards, 0.3, 0.5), *reference = make(-2, towards, 0.2, 0.25);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            const bool rim = x == 0 || y == 0 || x == W - 1 || y == H - 1;
            const double wrong = rim ? 0.3 : x % 4 == 3 || (x == 10 && y > 3) ? -0.05 : 0.01;
            *ssfr_field_at(shot->parts[SSFR_SHOT_DEPTH], x, y) = -2 + wrong;
            if (rim) memcpy(ssfr_field_at(shot->parts[SSFR_SHOT_NORMAL], x, y), (double[]){1, 0, 0}, sizeof towards);
        }
}

enum { RIM = 2 * (W + H) - 4, INTERIOR = W * H - RIM, FAR = 2 * (H - 2) + 4 }; /* pixels; of the interior, farther */

static void errors_are_those_of_the_interior_and_of_the_edge(void **state)
{
    (void)state;
    ssfr_shot shot, reference;
    double v[SSFR_N_COLUMNS];
    const double mean = (0.01 * (INTERIOR - FAR) - 0.05 * FAR) / INTERIOR;
    const double rms = sqrt((1e-4 * (INTERIOR - FAR) + 25e-4 * FAR) / INTERIOR);
    make_pair(&shot, &reference);
    clear(v);
    assert_int_equal(ssfr_shot_compare_reference(&shot, &reference, radius, v), SSFR_OK);
    assert_close(v[SSFR_COLUMN_ref_depth_rms_interior], rms, 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_depth_mean_interior], mean, 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_depth_rms_interior_radii], rms / radius, 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_depth_mean_interior_radii], mean / radius, 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_depth_median_interior_radii], 0.01 / radius, 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_depth_rms_edge], 0.3, 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_depth_mean], (mean * INTERIOR + 0.3 * RIM) / (W * H), 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_depth_rms], sqrt((rms * rms * INTERIOR + 0.09 * RIM) / (W * H)), 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_normal_interior_deg], 0, 1e-12, 0);
    assert_close(v[SSFR_COLUMN_ref_normal_mean_deg], 90.0 * RIM / (W * H), 0, 1e-12);
    assert_true(v[SSFR_COLUMN_ref_iou] == 1 && isnan(v[SSFR_COLUMN_method_depth_rms]));
    assert_int_equal(ssfr_shot_compare_method(&shot, &reference, v), SSFR_OK);
    assert_close(v[SSFR_COLUMN_method_depth_rms_interior], rms, 0, 1e-12);
    assert_close(v[SSFR_COLUMN_method_depth_mean_interior], mean, 0, 1e-12);
    assert_true(v[SSFR_COLUMN_method_depth_rms] == v[SSFR_COLUMN_ref_depth_rms]);
    assert_true(v[SSFR_COLUMN_method_normal_mean_deg] == v[SSFR_COLUMN_ref_normal_mean_deg]);
    assert_true(v[SSFR_COLUMN_method_normal_interior_deg] == v[SSFR_COLUMN_ref_normal_interior_deg]);
    assert_true(isnan(v[SSFR_COLUMN_twin_depth_rms]));
    ssfr_shot_finish(&shot), ssfr_shot_finish(&reference);
}

static void lengths_in_radii_need_a_radius(void **state)
{
    (void)state;
    ssfr_shot shot, reference;
    double v[SSFR_N_COLUMNS];
    make_pair(&shot, &reference);
    clear(v);
    assert_int_equal(ssfr_shot_compare_reference(&shot, &reference, 0, v), SSFR_OK);
    assert_true(isfinite(v[SSFR_COLUMN_ref_depth_rms_interior]));
    assert_true(isnan(v[SSFR_COLUMN_ref_depth_rms_interior_radii]) &&
                isnan(v[SSFR_COLUMN_ref_depth_mean_interior_radii]) &&
                isnan(v[SSFR_COLUMN_ref_depth_median_interior_radii]));
    ssfr_shot_finish(&shot), ssfr_shot_finish(&reference);
}

/* A third of the pixels have fluid in the frame alone, a third in both, a third in none. */
static void thickness_is_compared_where_either_is_fluid(void **state)
{
    (void)state;
    ssfr_shot shot, reference;
    double v[SSFR_N_COLUMNS];
    make_pair(&shot, &reference);
    double *a = shot.parts[SSFR_SHOT_THICKNESS]->data, *b = reference.parts[SSFR_SHOT_THICKNESS]->data;
    for (int i = 0; i < W * H; i++) {
        if (i % 3 != 1) b[i] = 0;
        if (i % 3 == 2) a[i] = 0;
    }
    assert_int_equal(ssfr_shot_compare_reference(&shot, &reference, radius, v), SSFR_OK);
    assert_close(v[SSFR_COLUMN_ref_thickness_mean], (0.3 + 0.1) / 2, 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_thickness_rms], sqrt((0.09 + 0.01) / 2), 0, 1e-12);
    assert_close(v[SSFR_COLUMN_ref_thickness_ratio], 0.6 / 0.2, 0, 1e-12);
    ssfr_field_fill(reference.parts[SSFR_SHOT_THICKNESS], 0);
    assert_int_equal(ssfr_shot_compare_reference(&shot, &reference, radius, v), SSFR_OK);
    assert_true(isnan(v[SSFR_COLUMN_ref_thickness_ratio])); /* over nothing */
    assert_close(v[SSFR_COLUMN_ref_thickness_mean], 0.3, 0, 1e-12);
    ssfr_field_fill(shot.parts[SSFR_SHOT_THICKNESS], 0);
    assert_int_equal(ssfr_shot_compare_reference(&shot, &reference, radius, v), SSFR_OK);
    assert_true(isnan(v[SSFR_COLUMN_ref_thickness_mean]) && isnan(v[SSFR_COLUMN_ref_thickness_rms]));
    ssfr_shot_finish(&shot), ssfr_shot_finish(&reference);
}

static void what_is_missing_leaves_its_columns(void **state)
{
    (void)state;
    ssfr_shot shot, reference;
    double v[SSFR_N_COLUMNS];
    make_pair(&shot, &reference);
    ssfr_field_destroy(&reference.parts[SSFR_SHOT_COLOUR]);
    ssfr_field_destroy(&shot.parts[SSFR_SHOT_THICKNESS]);
    clear(v);
    assert_int_equal(ssfr_shot_compare_reference(&shot, &reference, radius, v), SSFR_OK);
    assert_true(isnan(v[SSFR_COLUMN_ref_psnr]) && isnan(v[SSFR_COLUMN_ref_flip]));
    assert_true(isnan(v[SSFR_COLUMN_ref_thickness_ratio]) && isfinite(v[SSFR_COLUMN_ref_depth_rms]));
    ssfr_shot_finish(&shot), ssfr_shot_finish(&reference);
}

static void what_is_not_finite_is_counted_in_all_images(void **state)
{
    (void)state;
    ssfr_shot shot = make(-2, towards, 0.3, 0.5);
    double v[SSFR_N_COLUMNS];
    assert_int_equal(ssfr_shot_count_nan(&shot, v), SSFR_OK);
    assert_true(v[SSFR_COLUMN_nan_count] == 0);
    for (int part = 0; part < SSFR_SHOT_PARTS; part++)
        for (int i = 0; i <= part; i++) shot.parts[part]->data[i] = i % 2 ? INFINITY : (double)NAN;
    assert_int_equal(ssfr_shot_count_nan(&shot, v), SSFR_OK);
    assert_true(v[SSFR_COLUMN_nan_count] == 1 + 2 + 3 + 4);
    ssfr_shot_finish(&shot);
}

static ssfr_field *thickness_of(ssfr_graph *graph, const ssfr_scene *scene)
{
    ssfr_shot shot = {0};
    const ssfr_pipeline *pipeline = ssfr_pipeline_find("bagar2010");
    assert_int_equal(ssfr_shot_want(graph, pipeline, true), SSFR_OK);
    assert_int_equal(ssfr_graph_run(graph, scene, NULL), SSFR_OK);
    assert_int_equal(ssfr_shot_take(&shot, graph, pipeline, W, H), SSFR_OK);
    ssfr_field *thickness = shot.parts[SSFR_SHOT_THICKNESS];
    shot.parts[SSFR_SHOT_THICKNESS] = NULL;
    ssfr_shot_finish(&shot);
    assert_non_null(thickness);
    return thickness;
}

/* Layers are one pixel, or images: the shot has the sum. */
static void the_thickness_of_layers_is_their_sum(void **state)
{
    (void)state;
    test_scene s;
    test_scene_create_usual(&s, W, H);
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("bagar2010"), NULL);
    ssfr_field *alone = thickness_of(graph, &s.scene), *back = test_graph_read(graph, "thickness_back");
    ssfr_field *given = test_image(W, H, 1, 0.125);
    assert_int_equal(test_n_different(alone, back), 0);
    assert_int_equal(ssfr_graph_import(graph, "thickness_front", given), SSFR_OK);
    ssfr_field *both = thickness_of(graph, &s.scene);
    double most = 0;
    for (int i = 0; i < W * H; i++) {
        assert_true(both->data[i] == back->data[i] + 0.125);
        most = fmax(most, back->data[i]);
    }
    assert_true(most > 0.1);
    ssfr_field *const all[] = {alone, back, given, both};
    for (size_t i = 0; i < SSFR_COUNT(all); i++) ssfr_field_destroy(&(ssfr_field *){all[i]});
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_those_of_the_interior_and_of_the_edge),
        cmocka_unit_test(lengths_in_radii_need_a_radius),
        cmocka_unit_test(thickness_is_compared_where_either_is_fluid),
        cmocka_unit_test(what_is_missing_leaves_its_columns),
        cmocka_unit_test(what_is_not_finite_is_counted_in_all_images),
        cmocka_unit_test(the_thickness_of_layers_is_their_sum),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

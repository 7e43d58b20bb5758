/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_noise_normals.c: normals that lean with the slope of the noise, and with nothing else. */
#include "tests/pass_util.h"

enum { W = 32, H = 24 };
static const double z0 = -2.385, radius = 0.25;

/* A surface that faces the eye, with normals of its own. */
static test_twin *begin(void **state, const double n[3])
{
    static const double c[1][3] = {{0, 0, -2.385}};
    test_twin *t = test_twin_create(state, "noise_normals", W, H);
    ssfr_field *normals = test_field(W, H, 3);
    for (int i = 0; i < 3 * W * H; i++) normals->data[i] = n[i % 3];
    test_twin_place(t, 1, c, radius, NULL);
    test_twin_give(t, "normal", normals);
    test_twin_give(t, "depth", test_field_filled(W, H, 1, z0));
    test_twin_set(t, "height", "0.8");
    return t;
}

/* noise = a u + b v in eye-space metres of the surface. */
static ssfr_field *ramp(const test_twin *t, double a, double b)
{
    ssfr_field *noise = test_field(W, H, 1);
    for (int i = 0; i < W * H; i++) {
        const test_ray at = test_ray_at(t, i % W, i / W, 1);
        noise->data[i] = -z0 * (a * at.u + b * at.v);
    }
    return noise;
}

static const ssfr_field *run(test_twin *t, const ssfr_field *noise)
{
    test_twin_give(t, "noise", noise);
    return test_twin_run(t, "shading_normal");
}

static void assert_normal(const double *got, const double expected[3], double tolerance)
{
    for (int k = 0; k < 3; k++) assert_close(got[k], expected[k], tolerance, 0);
}

static const double normals[][3] = {{0, 0, 1}, {0.6, 0, 0.8}, {-0.48, 0.64, 0.6}};

/* Waves of the height h lean the normal by -h times the noise's slope per metre, everywhere, the image's border and
 * its corners included. Rounding: the noise's differences over a pixel. */
static void normals_lean_with_the_slope(void **state)
{
    for (size_t i = 0; i < SSFR_COUNT(normals); i++) {
        test_twin *t = begin(state, normals[i]);
        const ssfr_field *leaning = run(t, ramp(t, 1.7, -0.9));
        const double h = 0.8 * radius;
        double expected[3] = {normals[i][0] - h * 1.7, normals[i][1] + h * 0.9, normals[i][2]};
        ssfr_normalize(expected);
        for (int k = 0; k < W * H; k++) assert_normal(leaning->data + 3 * k, expected, 100 * t->eps);
    }
}

static void slope_is_taken_across_pixels_of_any_shape_at_any_distance(void **state)
{
    test_twin *t = begin(state, normals[0]);
    t->scene.camera.tan_x = 2.385;
    ssfr_field *depth = test_field(W, H, 1);
    for (int i = 0; i < W * H; i++) depth->data[i] = i / W < 10 ? -1 : -7;
    test_twin_give(t, "depth", depth);
    const ssfr_field *leaning = run(t, ramp(t, 1.7, 0));
    double near[3] = {-0.8 * radius * 1.7 * -z0, 0, 1}, far[3] = {near[0] / 7, 0, 1};
    ssfr_normalize(near), ssfr_normalize(far);
    for (int i = 0; i < W * H; i++) assert_normal(leaning->data + 3 * i, i / W < 10 ? near : far, 100 * t->eps);
}

/* A pixel of half the resolution is twice as wide. */
static void slope_is_taken_across_pixels_of_any_resolution(void **state)
{
    static const double c[1][3] = {{0, 0, -2.385}};
    test_twin *t = test_twin_create(state, "noise_normals", 2 * W, 2 * H);
    ssfr_field *normal = test_field(W, H, 3), *noise = test_field(W, H, 1);
    double expected[3] = {-0.8 * radius * 1.7, 0.8 * radius * 0.9, 1};
    ssfr_normalize(expected);
    for (int i = 0; i < W * H; i++) {
        const test_ray at = test_ray_at(t, i % W, i / W, 2);
        normal->data[3 * i + 2] = 1, noise->data[i] = -z0 * (1.7 * at.u - 0.9 * at.v);
    }
    test_twin_place(t, 1, c, radius, NULL);
    test_twin_set(t, "height", "0.8");
    test_twin_give(t, "normal", normal);
    test_twin_give(t, "depth", test_field_filled(W, H, 1, z0));
    const ssfr_field *leaning = run(t, noise);
    assert_int_equal(leaning->w, W);
    for (int i = 0; i < W * H; i++) assert_normal(leaning->data + 3 * i, expected, 100 * t->eps);
}

/* Where there is no surface there is no noise: that is no slope. A patch of constant noise stays as it is to its rim,
 * and a ramp keeps its slope. */
static void rim_of_the_fluid_is_no_slope(void **state)
{
    test_twin *t = begin(state, normals[1]);
    ssfr_field *depth = test_field(W, H, 1), *constant = test_field(W, H, 1), *sloped = ramp(t, 1.7, -0.9);
    for (int i = 0; i < W * H; i++) {
        const int x = i % W, y = i / W;
        const bool in = (x > 4 && x < 20 && y > 3 && y < 15) || (x == 27 && y == 20);
        depth->data[i] = in ? z0 : -SSFR_EMPTY;
        constant->data[i] = in ? 0.4 : 0;
        if (!in) sloped->data[i] = 0;
    }
    test_twin_give(t, "depth", depth);
    const ssfr_field *still = run(t, constant), *leaning = run(t, sloped);
    double expected[3] = {0.6 - 0.8 * radius * 1.7, 0.8 * radius * 0.9, 0.8};
    ssfr_normalize(expected);
    for (int i = 0; i < W * H; i++) {
        static const double none[3] = {0, 0, 0};
        const bool in = ssfr_is_surface(depth->data[i]), alone = i == 20 * W + 27;
        assert_normal(still->data + 3 * i, in ? normals[1] : none, 4 * t->eps);
        assert_normal(leaning->data + 3 * i, alone ? normals[1] : in ? expected : none, 100 * t->eps);
    }
}

static void waves_of_height_0_are_the_identity_to_the_last_bit(void **state)
{
    static const double odd[3] = {0.25, -0.375, 0.875}; /* not even of unit length */
    ssfr_node_status status;
    test_twin *t = begin(state, odd);
    test_twin_set(t, "height", "0");
    const ssfr_field *same = run(t, ramp(t, 1.7, -0.9));
    for (int i = 0; i < 3 * W * H; i++) assert_true(same->data[i] == odd[i % 3]);
    assert_true(test_same_bits(same, test_twin_run_if_needed(t, "shading_normal", &status)));
    assert_int_equal(status, SSFR_NEEDLESS);
}

static void still_water_keeps_its_normals(void **state)
{
    test_twin *t = begin(state, normals[2]);
    const ssfr_field *same = run(t, test_field_filled(W, H, 1, 0.7));
    for (int i = 0; i < W * H; i++) assert_normal(same->data + 3 * i, normals[2], 4 * t->eps);
}

static void one_pixel_has_no_slope(void **state)
{
    static const double c[1][3] = {{0, 0, -2.385}};
    test_twin *t = test_twin_create(state, "noise_normals", 1, 1);
    ssfr_field *normal = test_field(1, 1, 3);
    memcpy(normal->data, normals[1], sizeof normals[1]);
    test_twin_place(t, 1, c, radius, NULL);
    test_twin_give(t, "normal", normal);
    test_twin_give(t, "depth", test_field_filled(1, 1, 1, z0));
    test_twin_set(t, "height", "2.385");
    assert_normal(run(t, test_field_filled(1, 1, 1, 0.7))->data, normals[1], 4 * t->eps);
}

/* A normal of no length has none (normals left out), on both twins, not NaN. */
static void no_normal_stays_none(void **state)
{
    static const double none[3] = {0, 0, 0};
    test_twin *t = begin(state, none);
    const ssfr_field *same = run(t, test_field_filled(W, H, 1, 0.7));
    for (int i = 0; i < W * H; i++) assert_normal(same->data + 3 * i, none, 0);
}

static void noise_that_is_no_number_leaves_normals_alone(void **state)
{
    static const double none[] = {NAN, INFINITY, -INFINITY, -1e30};
    test_twin *t = begin(state, normals[2]);
    uint64_t random = 43;
    for (size_t i = 0; i < SSFR_COUNT(none); i++) {
        ssfr_field *noise = test_field(W, H, 1);
        const ssfr_field *still = run(t, test_field_filled(W, H, 1, none[i]));
        for (int k = 0; k < W * H; k++) assert_normal(still->data + 3 * k, normals[2], 4 * t->eps);
        for (int k = 0; k < W * H; k++) noise->data[k] = test_random(&random, 0, 1) < 0.3 ? none[i] : 0.4;
        const ssfr_field *torn = run(t, noise);
        for (int k = 0; k < W * H; k++) assert_normal(torn->data + 3 * k, normals[2], 4 * t->eps);
    }
}

static void noise_normals_refuse_values_out_of_range(void **state)
{
    test_twin *t = begin(state, normals[0]);
    test_twin_refuses(t, "height", "-0.1", "noise_normals.height");
    test_twin_refuses(t, "height", "2.385m", "2.385m");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(normals_lean_with_the_slope),
        TEST_TWINS(slope_is_taken_across_pixels_of_any_shape_at_any_distance),
        TEST_TWINS(slope_is_taken_across_pixels_of_any_resolution),
        TEST_TWINS(rim_of_the_fluid_is_no_slope),
        TEST_TWINS(waves_of_height_0_are_the_identity_to_the_last_bit),
        TEST_TWINS(still_water_keeps_its_normals),
        TEST_TWINS(one_pixel_has_no_slope),
        TEST_TWINS(no_normal_stays_none),
        TEST_TWINS(noise_that_is_no_number_leaves_normals_alone),
        TEST_TWINS(noise_normals_refuse_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

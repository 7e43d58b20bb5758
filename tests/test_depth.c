/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_depth.c: stored depths against the projection matrices that made them. */
#include "tests/util.h"

#include "experiments/depth.h"

static const double distances[] = {0.125, 0.2385, 1, 2.385, 77.7, 999.5};

/* Window depth by the matrix of glFrustum and a depth range of [0, 1]. */
static double window_depth(double distance, double near, double far)
{
    const double z = -distance;
    const double clip_z = -(far + near) / (far - near) * z - 2 * far * near / (far - near);
    return 0.5 * clip_z / -z + 0.5;
}

static void distances_along_the_axis_are_taken_as_they_are(void **state)
{
    (void)state;
    const ssfr_depth_format eye = {.kind = SSFR_DEPTH_EYE}, positive = {.kind = SSFR_DEPTH_POSITIVE};
    for (size_t i = 0; i < SSFR_COUNT(distances); i++) {
        assert_close(ssfr_depth_distance(&eye, -distances[i]), distances[i], 0, 0);
        assert_close(ssfr_depth_distance(&positive, distances[i]), distances[i], 0, 0);
    }
}

static void window_depth_is_undone(void **state)
{
    (void)state;
    const ssfr_depth_format window = {SSFR_DEPTH_WINDOW, 0.125, 1000}, reversed = {SSFR_DEPTH_REVERSED, 0.125, 1000};
    for (size_t i = 0; i < SSFR_COUNT(distances); i++) {
        const double d = window_depth(distances[i], 0.125, 1000);
        /* Of window depth a distance z keeps eps z / near relative digits. */
        assert_close(ssfr_depth_distance(&window, d), distances[i], 0, 1e-11);
        assert_close(ssfr_depth_distance(&reversed, 1 - d), distances[i], 0, 1e-11);
    }
}

static void an_infinite_far_plane_is_the_limit_of_a_distant_one(void **state)
{
    (void)state;
    const ssfr_depth_format window = {SSFR_DEPTH_WINDOW, 0.125, 0}, reversed = {SSFR_DEPTH_REVERSED, 0.125, 0};
    for (size_t i = 0; i < SSFR_COUNT(distances); i++) {
        assert_close(ssfr_depth_distance(&window, 1 - 0.125 / distances[i]), distances[i], 0, 1e-11);
        assert_close(ssfr_depth_distance(&reversed, 0.125 / distances[i]), distances[i], 0, 1e-15);
        const ssfr_depth_format distant = {SSFR_DEPTH_REVERSED, 0.125, 1e12};
        assert_close(ssfr_depth_distance(&distant, 0.125 / distances[i]), distances[i], 0, 1e-8);
    }
}

static void what_is_no_surface_is_nan(void **state)
{
    (void)state;
    const ssfr_depth_format formats[] = {{SSFR_DEPTH_EYE, 0, 0},
                                         {SSFR_DEPTH_POSITIVE, 0, 0},
                                         {SSFR_DEPTH_WINDOW, 0.125, 1000},
                                         {SSFR_DEPTH_REVERSED, 0.125, 0}};
    static const double stored[][6] = {{0, 2.385, -1e30, 1e30, NAN, -INFINITY},
                                       {0, -2.385, 1e30, -1e30, NAN, INFINITY},
                                       {1, 1.0001, -0.0001, 1e30, NAN, INFINITY},
                                       {0, -0.0001, 1.0001, 1e30, NAN, 1e-320}};
    for (size_t i = 0; i < SSFR_COUNT(formats); i++)
        for (size_t k = 0; k < SSFR_COUNT(stored[i]); k++)
            assert_true(isnan(ssfr_depth_distance(&formats[i], stored[i][k])));
}

static void an_image_is_converted_in_place_and_its_range_told(void **state)
{
    (void)state;
    const ssfr_depth_format positive = {.kind = SSFR_DEPTH_POSITIVE};
    ssfr_depth_range range = {0};
    ssfr_field *field = NULL;
    assert_int_equal(ssfr_field_create(&field, 3, 2, 1), SSFR_OK);
    const double values[] = {0, 2.385, 0.5, NAN, 7.75, 1e30}, expected[] = {-1e30, -2.385, -0.5, -1e30, -7.75, -1e30};
    memcpy(field->data, values, sizeof values);
    ssfr_depth_convert(&positive, field, &range);
    for (size_t i = 0; i < SSFR_COUNT(values); i++) assert_close(field->data[i], expected[i], 0, 0);
    assert_close(range.nearest, 0.5, 0, 0);
    assert_close(range.farthest, 7.75, 0, 0);
    assert_close(range.sum, 2.385 + 0.5 + 7.75, 0, 1e-15);
    assert_int_equal(range.n, 3);
    ssfr_depth_convert(&(ssfr_depth_format){.kind = SSFR_DEPTH_EYE}, field, &range); /* the same again: now z */
    assert_int_equal(range.n, 6);
    assert_close(range.nearest, 0.5, 0, 0);
    ssfr_field_destroy(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_along_the_axis_are_taken_as_they_are),
        cmocka_unit_test(window_depth_is_undone),
        cmocka_unit_test(an_infinite_far_plane_is_the_limit_of_a_distant_one),
        cmocka_unit_test(what_is_no_surface_is_nan),
        cmocka_unit_test(an_image_is_converted_in_place_and_its_range_told),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

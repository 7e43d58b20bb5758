/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_camera.c: cameras look where they are told, with square pixels, and refuse what has no answer. */
#include "tests/util.h"

#include <float.h>

static const double pi = 3.14159265358979323846, y_axis[3] = {0, 1, 0};

static ssfr_camera look(const double eye[3], const double target[3], const double up[3], double fov, int w, int h)
{
    ssfr_camera c;
    assert_int_equal(ssfr_camera_look(&c, eye, target, up, fov, w, h), SSFR_OK);
    return c;
}

static void assert_orthonormal(const ssfr_camera *c)
{
    double cross[3];
    assert_close(ssfr_dot(c->right, c->right), 1, 1e-14, 0);
    assert_close(ssfr_dot(c->up, c->up), 1, 1e-14, 0);
    assert_close(ssfr_dot(c->back, c->back), 1, 1e-14, 0);
    assert_close(ssfr_dot(c->right, c->up), 0, 1e-14, 0);
    assert_close(ssfr_dot(c->right, c->back), 0, 1e-14, 0);
    assert_close(ssfr_dot(c->up, c->back), 0, 1e-14, 0);
    ssfr_cross(c->right, c->up, cross);
    for (int k = 0; k < 3; k++) assert_close(cross[k], c->back[k], 1e-14, 0); /* right-handed */
}

static void the_camera_looks_at_its_target(void **state)
{
    (void)state;
    const double eye[3] = {2.385, -1.7, 0.31}, target[3] = {-4.1, 0.23, 7.7}, up[3] = {0.2, 0.9, -0.1};
    const ssfr_camera c = look(eye, target, up, 0.77, 640, 360);
    assert_orthonormal(&c);
    double to[3] = {target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]};
    const double distance = ssfr_normalize(to);
    assert_true(distance > 0);
    for (int k = 0; k < 3; k++) {
        assert_close(to[k], -c.back[k], 1e-15, 0);
        assert_true(c.eye[k] == eye[k]);
    }
    assert_true(ssfr_dot(up, c.up) > 0);
    assert_close(ssfr_dot(up, c.right), 0, 1e-15, 0);
    assert_true(c.near > 0 && c.near < c.far);
}

static void pixels_are_square_for_every_size(void **state)
{
    (void)state;
    static const int sizes[][2] = {{1, 1}, {37, 23}, {1920, 1080}, {1, SSFR_MAX_SIZE}, {SSFR_MAX_SIZE, 1}};
    const double eye[3] = {0, 0, 2.385}, target[3] = {0, 0, 0};
    for (size_t i = 0; i < SSFR_COUNT(sizes); i++) {
        const ssfr_camera c = look(eye, target, y_axis, 0.9, sizes[i][0], sizes[i][1]);
        assert_int_equal(c.w, sizes[i][0]);
        assert_int_equal(c.h, sizes[i][1]);
        assert_close(c.tan_y, tan(0.45), 0, 1e-15);
        assert_close(c.tan_x / c.w, c.tan_y / c.h, 0, 1e-15);
    }
}

static void random_cameras_are_orthonormal(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int i = 0; i < 1000; i++) {
        double v[3][3];
        const double scale = pow(10, test_random(&seed, -150, 150));
        for (int j = 0; j < 9; j++) v[j / 3][j % 3] = scale * test_random(&seed, -1, 1);
        const ssfr_camera c = look(v[0], v[1], v[2], test_random(&seed, 0.01, 3.1), 64, 48);
        assert_orthonormal(&c);
        assert_true(ssfr_dot(v[2], c.up) > 0);
    }
}

static void the_length_of_up_does_not_matter(void **state)
{
    (void)state;
    const double eye[3] = {1, 2, 3}, target[3] = {0, 0.5, -0.7};
    const ssfr_camera unit = look(eye, target, y_axis, 1, 64, 48);
    static const double lengths[] = {1e-300, 1e-20, 2.385, 1e200, DBL_MAX};
    for (size_t i = 0; i < SSFR_COUNT(lengths); i++) {
        const ssfr_camera c = look(eye, target, (const double[3]){0, lengths[i], 0}, 1, 64, 48);
        for (int k = 0; k < 3; k++) assert_close(c.right[k], unit.right[k], 1e-15, 0);
    }
}

static void an_up_almost_along_the_view_gives_right_angles(void **state)
{
    (void)state;
    const double eye[3] = {2.385, -1.7, 0.31}, target[3] = {0, 0, 0};
    for (double lean = 0.1; lean > 1e-11; lean /= 10) {
        const double up[3] = {eye[0], eye[1] + lean, eye[2]};
        const ssfr_camera c = look(eye, target, up, 0.77, 640, 360);
        assert_orthonormal(&c);
        assert_true(c.up[1] > 0);
    }
}

static void angles_of_view_lie_between_0_and_pi(void **state)
{
    (void)state;
    const double eye[3] = {1, 2, 3}, target[3] = {0, 0, 0};
    const double bad[] = {0, -0.1, pi, 3.2, (double)NAN, INFINITY, -INFINITY};
    ssfr_camera c = {.w = -1};
    for (size_t i = 0; i < SSFR_COUNT(bad); i++)
        assert_fails(SSFR_ERR_VALUE, ssfr_camera_look(&c, eye, target, y_axis, bad[i], 64, 48),
                     "rad is not in (0, pi)");
    assert_int_equal(c.w, -1); /* untouched */
    const ssfr_camera narrow = look(eye, target, y_axis, 1e-6, 64, 48);
    const ssfr_camera wide = look(eye, target, y_axis, 3.1415, 64, 48);
    assert_close(narrow.tan_y, 5e-7, 0, 1e-12);
    assert_close(wide.tan_y, tan(3.1415 / 2), 0, 1e-12);
}

static void sizes_outside_the_limits_are_refused(void **state)
{
    (void)state;
    static const int bad[][2] = {{0, 48}, {64, 0}, {-3, 48}, {SSFR_MAX_SIZE + 1, 48}, {64, SSFR_MAX_SIZE + 1}};
    const double eye[3] = {1, 2, 3}, target[3] = {0, 0, 0};
    ssfr_camera c;
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) {
        char text[64];
        snprintf(text, sizeof text, "image of %d x %d pixels", bad[i][0], bad[i][1]);
        assert_fails(SSFR_ERR_VALUE, ssfr_camera_look(&c, eye, target, y_axis, 1, bad[i][0], bad[i][1]), text);
    }
}

static void views_without_a_direction_are_refused(void **state)
{
    (void)state;
    ssfr_camera c;
    const double eye[3] = {2.385, -1, 4}, above[3] = {2.385, 7, 4}, origin[3] = {0, 0, 0}, down[3] = {0, -5, 0};
    assert_fails(SSFR_ERR_VALUE, ssfr_camera_look(&c, eye, eye, y_axis, 1, 64, 48), "the same point 2.385,-1,4");
    assert_fails(SSFR_ERR_VALUE, ssfr_camera_look(&c, eye, above, y_axis, 1, 64, 48), "up 0,1,0 is along the view");
    assert_fails(SSFR_ERR_VALUE, ssfr_camera_look(&c, eye, above, down, 1, 64, 48), "up 0,-5,0 is along the view");
    assert_fails(SSFR_ERR_VALUE, ssfr_camera_look(&c, eye, above, origin, 1, 64, 48), "up 0,0,0 is along the view");
}

static void places_that_are_not_finite_are_refused(void **state)
{
    (void)state;
    ssfr_camera c;
    const double good[3] = {1, 2, 3}, zero[3] = {0, 0, 0};
    const double bad[] = {(double)NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < SSFR_COUNT(bad); i++)
        for (int k = 0; k < 3; k++) {
            double v[3] = {0.1, 0.2, 0.3};
            v[k] = bad[i];
            assert_fails(SSFR_ERR_VALUE, ssfr_camera_look(&c, v, zero, y_axis, 1, 64, 48), "must be finite");
            assert_fails(SSFR_ERR_VALUE, ssfr_camera_look(&c, good, v, y_axis, 1, 64, 48), "must be finite");
            assert_fails(SSFR_ERR_VALUE, ssfr_camera_look(&c, good, zero, v, 1, 64, 48), "must be finite");
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_camera_looks_at_its_target),
        cmocka_unit_test(pixels_are_square_for_every_size),
        cmocka_unit_test(random_cameras_are_orthonormal),
        cmocka_unit_test(the_length_of_up_does_not_matter),
        cmocka_unit_test(an_up_almost_along_the_view_gives_right_angles),
        cmocka_unit_test(angles_of_view_lie_between_0_and_pi),
        cmocka_unit_test(sizes_outside_the_limits_are_refused),
        cmocka_unit_test(views_without_a_direction_are_refused),
        cmocka_unit_test(places_that_are_not_finite_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_normals.c: normals of planes and spheres, what eq. 2.10 errs by, and what happens at silhouettes. */
#include "tests/pass_util.h"

typedef double surface(test_ray ray);
typedef void direction(test_ray ray, double n[3]);

/* One particle of 10 m: by default nothing within 50 m is a silhouette. */
static test_twin *begin(void **state, int w, int h, double tan_x, double tan_y)
{
    static const double c[1][3] = {{0, 0, -2.385}};
    test_twin *t = test_twin_create(state, "normals", w, h);
    t->scene.camera.tan_x = tan_x, t->scene.camera.tan_y = tan_y;
    test_twin_place(t, 1, c, 10, NULL);
    return t;
}

static const ssfr_field *run(test_twin *t, const ssfr_field *depth)
{
    test_twin_give(t, "depth", depth);
    return test_twin_run(t, "normal");
}

static ssfr_field *draw(const test_twin *t, surface *z, int divisor)
{
    ssfr_field *depth = test_field(t->scene.camera.w / divisor, t->scene.camera.h / divisor, 1);
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++) *ssfr_field_at(depth, x, y) = z(test_ray_at(t, x, y, divisor));
    return depth;
}

static double apart(const double a[3], const double b[3])
{
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(ssfr_dot(d, d));
}

typedef enum region { INSIDE, BORDER } region;

/* Inside is an eighth of the image away from its border, at every resolution. */
static bool is_in(const ssfr_field *f, int x, int y, region where)
{
    const int dx = ssfr_min_int(x, f->w - 1 - x), dy = ssfr_min_int(y, f->h - 1 - y);
    return where == BORDER ? dx == 0 || dy == 0 : dx >= f->w / 8 && dy >= f->h / 8;
}

/* The largest distance between unit normals, rad. */
static double error(const test_twin *t, const ssfr_field *normals, direction *expected, int divisor, region where)
{
    double largest = 0, n[3];
    for (int y = 0; y < normals->h; y++)
        for (int x = 0; x < normals->w; x++) {
            if (!is_in(normals, x, y, where)) continue;
            expected(test_ray_at(t, x, y, divisor), n);
            largest = fmax(largest, apart(ssfr_field_at(normals, x, y), n));
        }
    return largest;
}

/* What rounding does to a normal: differences of z over a pixel. */
static double rounding(const test_twin *t)
{
    const ssfr_camera *c = &t->scene.camera;
    return 4 * t->eps * fmax(c->w / c->tan_x, c->h / c->tan_y);
}

/* ---- planes ------------------------------------------------------------------------------------------------------ */

static double tilted(test_ray at)
{
    return test_plane(-2.385, 0.6, -0.35, at);
}

static void tilted_normal(test_ray at, double n[3])
{
    (void)at;
    n[0] = -0.6, n[1] = 0.35, n[2] = 1;
    ssfr_normalize(n);
}

static void plane_that_faces_the_eye_has_normal_0_0_1(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.7, 0.5);
    for (int k = 0; k < 4; k++) {
        test_twin_set(t, "off_axis", "%d", k / 2);
        test_twin_set(t, "edge", "%s", k % 2 ? "central" : "smaller");
        const ssfr_field *n = run(t, test_field_filled(32, 24, 1, -2.385));
        for (int i = 0; i < 32 * 24; i++)
            assert_true(n->data[3 * i] == 0 && n->data[3 * i + 1] == 0 && n->data[3 * i + 2] == 1);
    }
}

/* The depth of a plane is a rational function of the pixel: central differences err by the square of a pixel, and
 * one-sided ones, at the image's border, by a pixel. In floats rounding grows with the resolution instead, and bounds
 * the error. */
static void tilted_plane_is_right_to_second_order_and_at_the_border_to_first(void **state)
{
    double inner = 0, outer = 0;
    for (int w = 16; w <= 128; w *= 2) {
        test_twin *t = begin(state, w, w, 0.8, 0.5);
        const ssfr_field *normals = run(t, draw(t, tilted, 1));
        const double in = error(t, normals, tilted_normal, 1, INSIDE);
        const double out = error(t, normals, tilted_normal, 1, BORDER);
        const double pixel = 1.6 / w;
        assert_true(in < 0.5 * pixel * pixel + rounding(t));
        assert_true(out < 0.6 * pixel + rounding(t));
        if (inner > 0 && !t->gl) assert_close(test_order(inner, in, 2), 2, 0.1, 0);
        if (outer > 0) assert_close(test_order(outer, out, 2), 1, 0.15, 0);
        inner = in, outer = out;
    }
}

/* A half-resolution image has its pixels' middles elsewhere, and wider pixels. */
static void low_resolution_knows_its_pixels(void **state)
{
    test_twin *t = begin(state, 128, 96, 0.8, 0.5);
    for (int divisor = 2; divisor <= 8; divisor *= 2) {
        const ssfr_field *normals = run(t, draw(t, tilted, divisor));
        const double pixel = 1.6 / 128 * divisor;
        assert_int_equal(normals->w, 128 / divisor);
        assert_true(error(t, normals, tilted_normal, divisor, INSIDE) < pixel * pixel + rounding(t));
    }
}

/* Eq. 2.10 is the normal (-p, -q, -z) where the surface's is (-p, -q, -z - u p - v q). */
static void printed_normal(test_ray at, double n[3])
{
    const double z = tilted(at), p = -0.6 * z * z / -2.385, q = 0.35 * z * z / -2.385;
    n[0] = -p, n[1] = -q, n[2] = -z;
    ssfr_normalize(n);
}

static void printed_normal_is_right_on_the_axis_alone(void **state)
{
    test_twin *t = begin(state, 129, 129, 0.8, 0.5);
    test_twin_set(t, "off_axis", "0");
    const ssfr_field *normals = run(t, draw(t, tilted, 1));
    const double pixel = 1.6 / 129;
    double n[3];
    assert_true(error(t, normals, printed_normal, 1, INSIDE) < pixel * pixel + rounding(t));
    tilted_normal((test_ray){0, 0}, n);
    assert_true(apart(ssfr_field_at(normals, 64, 64), n) < pixel * pixel + rounding(t));
    assert_true(apart(ssfr_field_at(normals, 127, 64), n) > 0.1);
    assert_true(apart(ssfr_field_at(normals, 64, 1), n) > 0.05);
}

/* ---- spheres ----------------------------------------------------------------------------------------------------- */

static const double centre[3] = {0.5, -0.4, -6}, radius = 2.385;

static double ball(test_ray at)
{
    return test_meet(centre, radius, at).front;
}

static void ball_normal(test_ray at, double n[3])
{
    const double z = ball(at), p[3] = {-z * at.u, -z * at.v, z};
    for (int k = 0; k < 3; k++) n[k] = (p[k] - centre[k]) / radius;
}

static void sphere_is_right_to_second_order(void **state)
{
    double before = 0;
    for (int w = 16; w <= 64; w *= 2) {
        test_twin *t = begin(state, w, w, 0.15, 0.1);
        const double now = error(t, run(t, draw(t, ball, 1)), ball_normal, 1, INSIDE);
        assert_true(now < 4 * ssfr_square(0.3 / w) + 3 * rounding(t));
        if (before > 0 && !t->gl) assert_close(test_order(before, now, 2), 2, 0.15, 0);
        before = now;
    }
}

/* ---- silhouettes ------------------------------------------------------------------------------------------------- */

/* A step of 2 m beyond the falloff of 1 m: the smaller difference takes each side for itself, the central one leans by
 * half the step over a pixel. A step within the falloff is a slope. */
static void smaller_difference_does_not_look_across_a_silhouette(void **state)
{
    test_twin *t = begin(state, 33, 25, 0.7, 0.5);
    ssfr_field *depth = test_field(33, 25, 1);
    for (int i = 0; i < 33 * 25; i++) depth->data[i] = i % 33 < 16 ? -2.5 : -4.5;
    test_twin_set(t, "depth_falloff", "0.1");
    const ssfr_field *smaller = run(t, depth);
    for (int i = 0; i < 33 * 25; i++) assert_true(smaller->data[3 * i + 2] == 1);
    test_twin_set(t, "edge", "central");
    const ssfr_field *central = run(t, depth);
    test_twin_set(t, "edge", "smaller");
    test_twin_set(t, "depth_falloff", "0.3");
    const ssfr_field *wide = run(t, depth);
    const double slope = -2 / (2 * (1.4 / 33)), u = test_ray_at(t, 15, 12, 1).u;
    double n[3] = {-slope, 0, 2.5 - u * slope};
    ssfr_normalize(n);
    assert_true(apart(ssfr_field_at(central, 15, 12), n) < rounding(t));
    assert_true(apart(ssfr_field_at(wide, 15, 12), n) < rounding(t));
    assert_true(ssfr_field_at(central, 14, 12)[2] == 1);
}

/* The smaller of two steps, both beyond the falloff, in x and in y. */
static void smaller_difference_is_the_smaller_one(void **state)
{
    static const double column[3] = {-2, -3.25, -4}, row[3] = {-3.25 - 1.5, -3.25, -3.25 - 2};
    test_twin *t = begin(state, 3, 3, 0.5, 0.5);
    ssfr_field *depth = test_field_filled(3, 3, 1, -3.25);
    for (int k = 0; k < 3; k++) *ssfr_field_at(depth, k, 1) = column[k];
    for (int k = 0; k < 3; k++) *ssfr_field_at(depth, 1, k) = row[k];
    test_twin_set(t, "depth_falloff", "0.01");
    const double *n = ssfr_field_at(run(t, depth), 1, 1);
    double expected[3] = {0.75 * 3, 1.5 * -3 * -1, 3.25}; /* p = -0.75 / c rightwards; q = -1.5 / c upwards; c = 1/3 */
    ssfr_normalize(expected);
    assert_true(apart(n, expected) < 8 * t->eps);
}

/* Of two that are as steep the one after: rightwards in x, upwards in y. */
static void of_equal_differences_the_one_after_is_taken(void **state)
{
    test_twin *t = begin(state, 3, 3, 0.5, 0.5);
    ssfr_field *depth = test_field_filled(3, 3, 1, -4);
    double expected[3] = {3, 3, 3.25}; /* p = q = -1 / c; c = 1/3 */
    *ssfr_field_at(depth, 0, 1) = *ssfr_field_at(depth, 2, 1) = -4.25;
    *ssfr_field_at(depth, 1, 0) = *ssfr_field_at(depth, 1, 2) = -4.25;
    *ssfr_field_at(depth, 1, 1) = -3.25;
    test_twin_set(t, "depth_falloff", "0.01");
    ssfr_normalize(expected);
    assert_true(apart(ssfr_field_at(run(t, depth), 1, 1), expected) < 8 * t->eps);
}

/* Whatever is no surface: the slope is that of the other side. */
static void not_a_number_is_a_hole(void **state)
{
    test_twin *t = begin(state, 33, 25, 0.7, 0.5);
    ssfr_field *empty = draw(t, tilted, 1), *nan = draw(t, tilted, 1);
    for (int i = 0; i < 33 * 25; i += 4) empty->data[i] = -SSFR_EMPTY, nan->data[i] = i % 8 ? NAN : INFINITY;
    for (int k = 0; k < 2; k++) {
        test_twin_set(t, "edge", "%s", k ? "central" : "smaller");
        const ssfr_field *expected = run(t, empty);
        assert_true(test_same_bits(run(t, nan), expected));
    }
}

static void isolated_pixel_faces_the_eye(void **state)
{
    test_twin *t = begin(state, 9, 7, 0.7, 0.5);
    ssfr_field *depth = test_field_filled(9, 7, 1, -SSFR_EMPTY);
    *ssfr_field_at(depth, 7, 1) = -2.385;
    *ssfr_field_at(depth, 0, 6) = -2.385;
    for (int k = 0; k < 2; k++) {
        test_twin_set(t, "edge", "%s", k ? "central" : "smaller");
        const ssfr_field *normals = run(t, depth);
        for (int i = 0; i < 9 * 7; i++) {
            const double *n = normals->data + 3 * i;
            assert_true(n[0] == 0 && n[1] == 0 && n[2] == ssfr_is_surface(depth->data[i]));
        }
    }
}

/* Whatever the depths are: |n| = 1 and n faces the eye, because it is normal to two edges whose plane has the eye
 * before it. */
static void any_depth_gives_unit_normals_towards_the_eye(void **state)
{
    uint64_t random = 13;
    test_twin *t = begin(state, 40, 30, 1.2, 0.9);
    ssfr_field *depth = test_field(40, 30, 1);
    for (int i = 0; i < 40 * 30; i++) {
        depth->data[i] = -pow(10, test_random(&random, -1, 3));
        if (test_random(&random, 0, 1) < 0.2) depth->data[i] = -SSFR_EMPTY;
    }
    for (int k = 0; k < 2; k++) {
        test_twin_set(t, "edge", "%s", k ? "central" : "smaller");
        test_twin_set(t, "depth_falloff", "%s", k ? "0" : "0.03");
        const ssfr_field *normals = run(t, depth);
        for (int y = 0; y < 30; y++)
            for (int x = 0; x < 40; x++) {
                const test_ray at = test_ray_at(t, x, y, 1);
                const double *n = ssfr_field_at(normals, x, y);
                if (!ssfr_is_surface(*ssfr_field_at(depth, x, y))) continue;
                assert_close(ssfr_dot(n, n), 1, 8 * t->eps, 0);
                assert_true(n[2] - n[0] * at.u - n[1] * at.v > -8 * t->eps);
            }
    }
}

static void normals_are_left_out_without_fluid(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    ssfr_node_status status;
    test_twin *t = begin(state, 9, 7, 0.7, 0.5);
    test_twin_place(t, 1, behind, 0.3, NULL);
    const ssfr_field *normals = test_twin_run_if_needed(t, "normal", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_true(normals->w == 1 && normals->data[0] == 0 && normals->data[1] == 0 && normals->data[2] == 0);
}

static void normals_refuse_values_out_of_range(void **state)
{
    test_twin *t = begin(state, 9, 7, 0.7, 0.5);
    test_twin_refuses(t, "edge", "largest", "largest");
    test_twin_refuses(t, "off_axis", "2", "normals.off_axis");
    test_twin_refuses(t, "depth_falloff", "-2.385", "normals.depth_falloff");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(plane_that_faces_the_eye_has_normal_0_0_1),
        TEST_TWINS(tilted_plane_is_right_to_second_order_and_at_the_border_to_first),
        TEST_TWINS(low_resolution_knows_its_pixels),
        TEST_TWINS(printed_normal_is_right_on_the_axis_alone),
        TEST_TWINS(sphere_is_right_to_second_order),
        TEST_TWINS(smaller_difference_does_not_look_across_a_silhouette),
        TEST_TWINS(smaller_difference_is_the_smaller_one),
        TEST_TWINS(of_equal_differences_the_one_after_is_taken),
        TEST_TWINS(not_a_number_is_a_hole),
        TEST_TWINS(isolated_pixel_faces_the_eye),
        TEST_TWINS(any_depth_gives_unit_normals_towards_the_eye),
        TEST_TWINS(normals_are_left_out_without_fluid),
        TEST_TWINS(normals_refuse_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

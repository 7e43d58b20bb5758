/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_thickness.c: chords of spheres along the ray, and the volumes that kernels keep. */
#include "tests/pass_util.h"

#include <float.h>

static const double pi = 3.14159265358979323846;

static const ssfr_field *splat(test_twin *t, const char *form, const double c[3], double radius)
{
    const double one[1][3] = {{c[0], c[1], c[2]}};
    test_twin_set(t, "splat", "%s", form);
    test_twin_place(t, 1, one, radius, NULL);
    return test_twin_run(t, "thickness");
}

static double chord(double radius, double miss)
{
    return miss < radius ? 2 * sqrt((radius - miss) * (radius + miss)) : 0;
}

/* Length along a ray over length along the view axis. */
static double slant(test_ray ray)
{
    return sqrt(1 + ray.u * ray.u + ray.v * ray.v);
}

static const double places[][3] = {{0, 0, -3}, {0.6, -0.45, -2.385}, {-0.9, 0.7, -2.1}};

/* ---- the kernel along the ray ------------------------------------------------------------------------------------ */

static void exact_chord_is_the_length_of_the_ray_in_the_sphere(void **state)
{
    test_twin *t = test_twin_create(state, "thickness", 61, 48);
    for (size_t i = 0; i < SSFR_COUNT(places); i++) {
        const ssfr_field *thickness = splat(t, "exact", places[i], 0.41);
        double largest = 0;
        for (int y = 0; y < 48; y++)
            for (int x = 0; x < 61; x++) {
                const double miss = test_meet(places[i], 0.41, test_ray_at(t, x, y, 1)).miss;
                const double value = *ssfr_field_at(thickness, x, y);
                assert_close(value, chord(0.41, miss), test_chord_rounding(t->eps, places[i], 0.41, miss), 0);
                largest = fmax(largest, value);
            }
        assert_true(largest > 0.81);
    }
}

/* An orthographic disc: 2 R sqrt(1 - a^2 - b^2), times e^(-2 r^2) with the exponential kernel. */
static void assert_disc(const test_twin *t, const ssfr_field *thickness, const double c[3], double radius,
                        bool exponential)
{
    for (int y = 0; y < thickness->h; y++)
        for (int x = 0; x < thickness->w; x++) {
            const test_ray ray = test_ray_at(t, x, y, 1);
            const double a = (ray.u + c[0] / c[2]) * -c[2], b = (ray.v + c[1] / c[2]) * -c[2];
            const double miss = sqrt(a * a + b * b), tolerance = test_chord_rounding(t->eps, c, radius, miss);
            const double kernel = exponential ? exp(-2 * miss * miss / (radius * radius)) : 1;
            assert_close(*ssfr_field_at(thickness, x, y), kernel * chord(radius, miss), tolerance, 0);
        }
}

static void quads_and_points_have_the_chord_of_a_parallel_ray(void **state)
{
    static const char *const forms[] = {"point", "quad"}, *const kernels[] = {"chord", "exponential"};
    test_twin *t = test_twin_create(state, "thickness", 61, 48);
    for (size_t i = 0; i < SSFR_COUNT(places); i++)
        for (int k = 0; k < 4; k++) {
            test_twin_set(t, "kernel", "%s", kernels[k / 2]);
            assert_disc(t, splat(t, forms[k % 2], places[i], 0.41), places[i], 0.41, k / 2 == 1);
        }
}

static void exponential_kernel_of_exact_splats_takes_the_distance_from_the_ray(void **state)
{
    test_twin *t = test_twin_create(state, "thickness", 61, 48);
    test_twin_set(t, "kernel", "exponential");
    const ssfr_field *thickness = splat(t, "exact", places[1], 0.41);
    for (int y = 0; y < 48; y++)
        for (int x = 0; x < 61; x++) {
            const double miss = test_meet(places[1], 0.41, test_ray_at(t, x, y, 1)).miss, r = miss / 0.41;
            assert_close(*ssfr_field_at(thickness, x, y), chord(0.41, miss) * exp(-2 * r * r),
                         test_chord_rounding(t->eps, places[1], 0.41, miss), 0);
        }
}

static void overlapping_spheres_add_up(void **state)
{
    static const double both[2][3] = {{-0.15, 0.1, -2.5}, {0.2, 0, -2.9}};
    static const char *const forms[] = {"point", "quad", "exact"};
    test_twin *t = test_twin_create(state, "thickness", 61, 48);
    for (size_t f = 0; f < SSFR_COUNT(forms); f++) {
        const ssfr_field *a = splat(t, forms[f], both[0], 0.4), *b = splat(t, forms[f], both[1], 0.4);
        test_twin_place(t, 2, both, 0.4, NULL);
        const ssfr_field *sum = test_twin_run(t, "thickness");
        int n_both = 0;
        for (int i = 0; i < 61 * 48; i++) {
            const test_ray ray = test_ray_at(t, i % 61, i / 61, 1);
            const double miss_a = test_meet(both[0], 0.4, ray).miss, miss_b = test_meet(both[1], 0.4, ray).miss;
            /* A packet of two holds places as floats relative to its middle. */
            const double rim = test_chord_rounding(FLT_EPSILON, both[0], 0.4, miss_a) +
                               test_chord_rounding(FLT_EPSILON, both[1], 0.4, miss_b);
            assert_close(sum->data[i], a->data[i] + b->data[i], rim, 0);
            n_both += a->data[i] > 0 && b->data[i] > 0;
        }
        assert_true(n_both > 50);
    }
}

static void scale_multiplies(void **state)
{
    test_twin *t = test_twin_create(state, "thickness", 61, 48);
    const ssfr_field *once = splat(t, "quad", places[0], 0.41);
    test_twin_set(t, "scale", "2.385");
    const ssfr_field *scaled = splat(t, "quad", places[0], 0.41);
    for (int i = 0; i < 61 * 48; i++) assert_close(scaled->data[i], 2.385 * once->data[i], 0, 4 * t->eps);
}

/* ---- volumes ----------------------------------------------------------------------------------------------------- */

static double volume(const test_twin *t, const ssfr_field *thickness, double distance)
{
    const ssfr_camera *c = &t->scene.camera;
    double sum = 0;
    for (int i = 0; i < c->w * c->h; i++) sum += thickness->data[i];
    return sum * 4 * c->tan_x * c->tan_y / (c->w * c->h) * distance * distance;
}

/* The kernel ends like a root at its rim: the mean over pixels errs by about (pixel / R)^(3/2), and by chance less.
 * Radius 41 px. */
#define QUADRATURE 1e-3

static void chord_kernel_keeps_the_volume_of_the_sphere(void **state)
{
    static const double c[3] = {0.021, -0.033, -2};
    test_twin *t = test_twin_create(state, "thickness", 100, 100);
    const double sphere = 4 * pi / 3 * 0.82 * 0.82 * 0.82;
    assert_close(volume(t, splat(t, "quad", c, 0.82), 2), sphere, 0, QUADRATURE);
    assert_close(volume(t, splat(t, "point", c, 0.82), 2), sphere, 0, QUADRATURE);
}

/* Far away all rays are parallel: pixels see the volume to (R / |z|)^2. */
static void exact_chords_of_a_far_sphere_keep_its_volume(void **state)
{
    static const double c[3] = {0, 0, -100};
    test_twin *t = test_twin_create(state, "thickness", 100, 100);
    t->scene.camera.tan_x = t->scene.camera.tan_y = 0.01;
    assert_close(volume(t, splat(t, "exact", c, 0.82), 100), 4 * pi / 3 * 0.82 * 0.82 * 0.82, 0, QUADRATURE);
}

/* 3/2 times the integral of sqrt(s) e^(-2 (1 - s)) over s = 1 - r^2 from 0 to 1, by its series in s. */
static double exponential_share(void)
{
    double term = 1, sum = 0;
    for (int k = 0; k < 40; k++) {
        sum += term / (k + 1.5);
        term *= 2.0 / (k + 1);
    }
    return 1.5 * exp(-2) * sum;
}

static void exponential_kernel_keeps_51_percent_of_the_volume(void **state)
{
    static const double c[3] = {0.021, -0.033, -2};
    test_twin *t = test_twin_create(state, "thickness", 100, 100);
    test_twin_set(t, "kernel", "exponential");
    const double share = volume(t, splat(t, "quad", c, 0.82), 2) / (4 * pi / 3 * 0.82 * 0.82 * 0.82);
    assert_close(exponential_share(), 0.51, 0.001, 0);
    assert_close(share, exponential_share(), 0, QUADRATURE);
}

static void radius_scale_spreads_the_same_volume(void **state)
{
    static const double c[3] = {0.021, -0.033, -2};
    test_twin *t = test_twin_create(state, "thickness", 100, 100);
    const double plain = volume(t, splat(t, "quad", c, 0.51), 2);
    test_twin_set(t, "radius_scale", "1.6");
    const ssfr_field *wide = splat(t, "quad", c, 0.51);
    assert_close(volume(t, wide, 2), plain, 0, 2 * QUADRATURE);
    /* A chord of 2 R s over s^3. */
    assert_close(*ssfr_field_at(wide, 50, 51), 2 * 0.51 / (1.6 * 1.6), 0, 1e-3);
}

/* ---- before and behind the scene --------------------------------------------------------------------------------- */

/* A wall before, through and behind the sphere. Whole: all of the chord where the front is before the wall; clipped:
 * what is. */
static void wall_takes_what_is_behind_it(void **state)
{
    static const double walls[] = {-2.4, -2.8, -3, -3.17, -3.6};
    test_twin *t = test_twin_create(state, "thickness", 61, 48);
    for (size_t k = 0; k < SSFR_COUNT(walls); k++) {
        test_twin_give(t, "scene_depth", test_field_filled(61, 48, 1, walls[k]));
        test_twin_set(t, "occlusion", "front");
        const ssfr_field *whole = splat(t, "exact", places[0], 0.5);
        test_twin_set(t, "occlusion", "clipped");
        const ssfr_field *clipped = splat(t, "exact", places[0], 0.5);
        for (int y = 0; y < 48; y++)
            for (int x = 0; x < 61; x++) {
                const test_ray ray = test_ray_at(t, x, y, 1);
                const test_hit hit = test_meet(places[0], 0.5, ray);
                const double tolerance = test_chord_rounding(t->eps, places[0], 0.5, hit.miss);
                if (hit.miss < 0.5 && fabs(hit.front - walls[k]) < tolerance) continue;
                const bool shows = hit.miss < 0.5 && hit.front > walls[k];
                const double before = shows ? hit.front - fmax(hit.back, walls[k]) : 0;
                assert_close(*ssfr_field_at(whole, x, y), shows ? chord(0.5, hit.miss) : 0, tolerance, 0);
                assert_close(*ssfr_field_at(clipped, x, y), before * slant(ray), tolerance, 0);
            }
    }
}

static void wall_through_the_middle_leaves_half(void **state)
{
    static const double c[3] = {0, 0, -3};
    test_twin *t = test_twin_create(state, "thickness", 61, 49);
    test_twin_give(t, "scene_depth", test_field_filled(61, 49, 1, -3));
    test_twin_set(t, "occlusion", "clipped");
    assert_close(*ssfr_field_at(splat(t, "exact", c, 0.5), 30, 24), 0.5, 8 * t->eps, 0);
    assert_close(*ssfr_field_at(splat(t, "quad", c, 0.5), 30, 24), 0.5, 8 * t->eps, 0);
    test_twin_set(t, "occlusion", "front");
    assert_close(*ssfr_field_at(splat(t, "exact", c, 0.5), 30, 24), 1, 8 * t->eps, 0);
}

/* What is behind the eye or before the near plane is not seen through. */
static void eye_inside_a_sphere_looks_through_what_is_before_it(void **state)
{
    static const double c[3] = {0.1, 0.05, -0.2};
    static const char *const occlusions[] = {"front", "clipped"};
    test_twin *t = test_twin_create(state, "thickness", 40, 33);
    for (int k = 0; k < 2; k++) {
        test_twin_set(t, "occlusion", "%s", occlusions[k]);
        const ssfr_field *thickness = splat(t, "exact", c, 1);
        for (int y = 0; y < 33; y++)
            for (int x = 0; x < 40; x++) {
                const test_ray ray = test_ray_at(t, x, y, 1);
                const double visible = -0.01 - test_meet(c, 1, ray).back;
                assert_close(*ssfr_field_at(thickness, x, y), visible * slant(ray), 0, 32 * t->eps);
            }
    }
}

/* ---- the rest ---------------------------------------------------------------------------------------------------- */

static void thickness_is_zero_without_particles_in_view(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    ssfr_node_status status;
    test_twin *t = test_twin_create(state, "thickness", 16, 16);
    test_twin_place(t, 1, behind, 0.3, NULL);
    const ssfr_field *thickness = test_twin_run_if_needed(t, "thickness", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_true(thickness->w == 1 && thickness->h == 1 && thickness->data[0] == 0);
    assert_true(test_difference(test_twin_run(t, "thickness"), test_field(16, 16, 1)) == 0);
}

static void thickness_refuses_values_out_of_range(void **state)
{
    test_twin *t = test_twin_create(state, "thickness", 16, 16);
    test_twin_refuses(t, "scale", "-2.385", "thickness.scale");
    test_twin_refuses(t, "kernel", "gaussian", "gaussian");
    test_twin_refuses(t, "occlusion", "", "thickness.occlusion");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(exact_chord_is_the_length_of_the_ray_in_the_sphere),
        TEST_TWINS(quads_and_points_have_the_chord_of_a_parallel_ray),
        TEST_TWINS(exponential_kernel_of_exact_splats_takes_the_distance_from_the_ray),
        TEST_TWINS(overlapping_spheres_add_up),
        TEST_TWINS(scale_multiplies),
        TEST_TWINS(chord_kernel_keeps_the_volume_of_the_sphere),
        TEST_TWINS(exact_chords_of_a_far_sphere_keep_its_volume),
        TEST_TWINS(exponential_kernel_keeps_51_percent_of_the_volume),
        TEST_TWINS(radius_scale_spreads_the_same_volume),
        TEST_TWINS(wall_takes_what_is_behind_it),
        TEST_TWINS(wall_through_the_middle_leaves_half),
        TEST_TWINS(eye_inside_a_sphere_looks_through_what_is_before_it),
        TEST_TWINS(thickness_is_zero_without_particles_in_view),
        TEST_TWINS(thickness_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_root.c: the square-root ramp of 128 texels: its errors against the root, and on spheres of both twins. */
#include "passes/root.h"
#include "tests/pass_util.h"

enum { N = 127 * 1024 };

static ssfr_texels stored[2];
static const ssfr_texels *const ramps[2] = {&stored[0], &stored[1]};

static int make_ramps(void **state)
{
    assert_int_equal(ssfr_texels_init(&stored[0], &ssfr_root_ramp), SSFR_OK);
    assert_int_equal(ssfr_texels_init(&stored[1], &ssfr_root_ramp_printed), SSFR_OK);
    return test_capture_log(state);
}

static int free_ramps(void **state)
{
    for (int i = 0; i < 2; i++) ssfr_texels_finish(&stored[i]);
    return test_end_gl(state);
}

static double error_at(int root, double u)
{
    return fabs(ssfr_root_of(root, ramps, u) - sqrt(u));
}

static double largest_error(int root, double lo, double hi, double *at)
{
    double largest = -1;
    *at = lo;
    for (int i = 0; i <= N; i++) {
        const double u = lo + (hi - lo) * i / N, e = error_at(root, u);
        if (e > largest) largest = e, *at = u;
    }
    return largest;
}

/* ---- the ramps --------------------------------------------------------------------------------------------------- */

/* Between 0 and h = 1/127 the chord of the root is u / sqrt(h), which is farthest from it at h/4, by sqrt(h)/4; between
 * later texels the root bends less. */
static void the_ramp_is_off_by_a_quarter_of_its_first_step(void **state)
{
    (void)state;
    double at;
    assert_close(largest_error(SSFR_ROOT_RAMP, 0, 1, &at), 1 / (4 * sqrt(127)), 1e-7, 0);
    assert_close(at, 1.0 / 508, 1e-5, 0);
    assert_close(error_at(SSFR_ROOT_RAMP, 1.0 / 508), 0.022, 5e-4, 0);
    assert_true(largest_error(SSFR_ROOT_RAMP, 1.0 / 127, 1, &at) < 0.0039); /* sqrt(h) / 4 (sqrt(2) - 1)^2 */
}

static void the_ramp_has_the_root_at_its_texels(void **state)
{
    (void)state;
    for (int i = 0; i < 128; i++) assert_true(error_at(SSFR_ROOT_RAMP, i / 127.0) < 2e-7); /* of float */
    assert_true(ssfr_root_of(SSFR_ROOT_RAMP, ramps, 0) == 0 && ssfr_root_of(SSFR_ROOT_RAMP, ramps, 1) == 1);
}

/* Half a texel beside: up to u = 1/256 all is the first texel, 0, where the root has risen to 1/16. */
static void the_ramp_as_printed_is_off_by_a_sixteenth(void **state)
{
    (void)state;
    double at;
    assert_close(largest_error(SSFR_ROOT_RAMP_PRINTED, 0, 1, &at), 1.0 / 16, 1e-6, 0);
    assert_close(at, 1.0 / 256, 1e-5, 0);
    assert_true(ssfr_root_of(SSFR_ROOT_RAMP_PRINTED, ramps, 1.0 / 256) == 0);
    assert_close(error_at(SSFR_ROOT_RAMP_PRINTED, 1.0 / 256), 0.062, 6e-4, 0);
    assert_true(ssfr_root_of(SSFR_ROOT_RAMP_PRINTED, ramps, 255.5 / 256) == 1); /* and 1 before u = 1 */
}

static void ramps_never_fall(void **state)
{
    (void)state;
    for (int root = SSFR_ROOT_RAMP; root <= SSFR_ROOT_RAMP_PRINTED; root++)
        for (int i = 1; i <= N; i++)
            assert_true(ssfr_root_of(root, ramps, (double)i / N) >= ssfr_root_of(root, ramps, (i - 1.0) / N));
}

static void the_exact_root_is_the_root_and_needs_no_table(void **state)
{
    (void)state;
    static const ssfr_texels *const none[2];
    assert_true(ssfr_root_of(SSFR_ROOT_EXACT, none, 0.2385) == sqrt(0.2385));
    assert_true(ssfr_root_rounding(SSFR_ROOT_EXACT) == 0);
    assert_close(ssfr_root_rounding(SSFR_ROOT_RAMP), 1.73e-4, 1e-6, 0);
    assert_close(ssfr_root_rounding(SSFR_ROOT_RAMP_PRINTED), 1.73e-4 + 1.0 / 255, 1e-6, 0);
}

/* ---- spheres ----------------------------------------------------------------------------------------------------- */

static const double c[3] = {0.003, -0.007, -2};
static const double radius = 0.41;
enum { SIDE = 300 }; /* px: the sphere is 120 px wide */

static ssfr_field *depth_of(test_twin *t, const char *splat, const char *root)
{
    test_twin_set(t, "splat", "%s", splat);
    test_twin_set(t, "root", "%s", root);
    test_twin_place(t, 1, &c, radius, NULL);
    return test_twin_run(t, "depth");
}

/* The largest error of the normal's z, which is the sphere's height in radii. */
static double drawn_error(const test_twin *t, const ssfr_field *depth, int root)
{
    double largest = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            const test_ray ray = test_ray_at(t, x, y, 1);
            const double a = -ray.u * c[2] - c[0], b = -ray.v * c[2] - c[1];
            const double u = 1 - (a * a + b * b) / (radius * radius), z = *ssfr_field_at(depth, x, y);
            if (!ssfr_is_surface(z)) continue;
            const double height = (z - c[2]) / radius, expected = ssfr_root_of(root, ramps, fmax(u, 0));
            /* float's place of the pixel moves u by some 1e-6, and the root is steep where u is 0 */
            const double rounding = t->gl ? ssfr_root_rounding(root) + 5e-6 + 1e-6 / fmax(expected, 1e-3) : 1e-13;
            assert_close(height, expected, rounding, 0);
            largest = fmax(largest, fabs(height - sqrt(fmax(u, 0))));
        }
    return largest;
}

static void spheres_are_as_high_as_their_ramp(void **state)
{
    static const char *const splats[] = {"point", "quad"};
    test_twin *t = test_twin_create(state, "sphere_depth", SIDE, SIDE);
    for (int i = 0; i < 2; i++) {
        assert_close(drawn_error(t, depth_of(t, splats[i], "ramp"), SSFR_ROOT_RAMP), 0.022, 5e-4, 0);
        assert_close(drawn_error(t, depth_of(t, splats[i], "ramp_printed"), SSFR_ROOT_RAMP_PRINTED), 0.062, 5e-3, 0);
        assert_true(drawn_error(t, depth_of(t, splats[i], "exact"), SSFR_ROOT_EXACT) < 2e-3);
    }
}

static void roots_of_exact_splats_are_computed(void **state)
{
    test_twin *t = test_twin_create(state, "sphere_depth", 100, 100);
    const ssfr_field *computed = depth_of(t, "exact", "exact");
    assert_true(test_same_bits(depth_of(t, "exact", "ramp"), computed));
    assert_true(test_same_bits(depth_of(t, "exact", "ramp_printed"), computed));
    assert_false(test_same_bits(depth_of(t, "quad", "ramp"), depth_of(t, "quad", "exact")));
    assert_int_equal(test_count(computed), test_count(depth_of(t, "exact", "ramp")));
}

static void ramps_draw_where_roots_do(void **state)
{
    test_twin *t = test_twin_create(state, "sphere_depth", SIDE, SIDE);
    const int n = test_count(depth_of(t, "quad", "exact"));
    assert_true(n > 10000);
    assert_int_equal(test_count(depth_of(t, "quad", "ramp")), n);
    assert_int_equal(test_count(depth_of(t, "quad", "ramp_printed")), n);
}

static void other_roots_are_refused(void **state)
{
    test_twin *t = test_twin_create(state, "thickness", 16, 16);
    test_twin_refuses(t, "root", "cube", "thickness.root");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ramp_is_off_by_a_quarter_of_its_first_step),
        cmocka_unit_test(the_ramp_has_the_root_at_its_texels),
        cmocka_unit_test(the_ramp_as_printed_is_off_by_a_sixteenth),
        cmocka_unit_test(ramps_never_fall),
        cmocka_unit_test(the_exact_root_is_the_root_and_needs_no_table),
        TEST_TWINS(spheres_are_as_high_as_their_ramp),
        TEST_TWINS(roots_of_exact_splats_are_computed),
        TEST_TWINS(ramps_draw_where_roots_do),
        TEST_TWINS(other_roots_are_refused),
    };
    return cmocka_run_group_tests(tests, make_ramps, free_ramps);
}

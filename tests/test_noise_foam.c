/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_noise_foam.c: how much foam a magnitude of noise makes, how it is lit, and that nothing else changes. */
#include "tests/pass_util.h"

enum { W = 32, H = 24, N = W * H };
static const double pi = 3.14159265358979323846, z0 = -2.385;
static const double grey[3] = {0.625, 0.5, 0.375};

typedef struct foam {
    test_twin *t;
    ssfr_field *water, *noise, *depth, *normal;
} foam;

/* Water of many colours that faces the eye. Foam begins at noise 0.25 and is full at 0.75; light from all sides. */
static foam begin(void **state)
{
    static const double c[1][3] = {{0, 0, -2.385}};
    static const char *const colors[] = {"color_r", "color_g", "color_b"};
    const foam f = {.t = test_twin_create(state, "noise_foam", W, H), .water = test_field(W, H, 3),
                    .noise = test_field(W, H, 1), .depth = test_field_filled(W, H, 1, z0),
                    .normal = test_field(W, H, 3)};
    uint64_t random = 29;
    for (int i = 0; i < 3 * N; i++) f.water->data[i] = (double)(float)test_random(&random, 0, 1);
    for (int i = 0; i < N; i++) f.normal->data[3 * i + 2] = 1;
    test_twin_place(f.t, 1, c, 0.25, NULL);
    for (int k = 0; k < 3; k++) test_twin_set(f.t, colors[k], "%g", grey[k]);
    test_twin_set(f.t, "threshold", "0.25");
    test_twin_set(f.t, "softness", "0.5");
    test_twin_set(f.t, "light.ambient", "1");
    return f;
}

static void give(const foam *f)
{
    test_twin_give(f->t, "water", f->water);
    test_twin_give(f->t, "noise", f->noise);
    test_twin_give(f->t, "depth", f->depth);
    test_twin_give(f->t, "normal", f->normal);
}

static const ssfr_field *run(const foam *f)
{
    give(f);
    return test_twin_run(f->t, "color");
}

/* What foam added, in shares of its lit colour. */
static double share(const foam *f, const ssfr_field *color, int i)
{
    return (color->data[i] - f->water->data[i]) / grey[i % 3];
}

static void assert_share(const foam *f, double noise, double expected)
{
    ssfr_field_fill(f->noise, noise);
    const ssfr_field *color = run(f);
    for (int i = 0; i < 3 * N; i++) assert_close(share(f, color, i), expected, 8 * f->t->eps, 0);
}

/* ---- how much foam ----------------------------------------------------------------------------------------------- */

/* s s (3 - 2 s) for quarters s of the way from 0.25 to 0.75. */
static void foam_grows_by_smoothstep_from_the_threshold(void **state)
{
    static const double shares[][2] = {{0, 0},          {0.125, 0},       {0.25, 0}, {0.375, 0.15625}, {0.5, 0.5},
                                       {0.625, 0.84375}, {0.75, 1}, {2.385, 1}, {1e30, 1}};
    const foam f = begin(state);
    for (size_t i = 0; i < SSFR_COUNT(shares); i++) assert_share(&f, shares[i][0], shares[i][1]);
    test_twin_set(f.t, "strength", "0.375");
    for (size_t i = 0; i < SSFR_COUNT(shares); i++) assert_share(&f, shares[i][0], 0.375 * shares[i][1]);
}

static void noise_counts_by_its_magnitude(void **state)
{
    const foam f = begin(state);
    uint64_t random = 31;
    for (int i = 0; i < N; i++) f.noise->data[i] = (double)(float)test_random(&random, 0, 1);
    const ssfr_field *plus = run(&f);
    for (int i = 0; i < N; i += 2) f.noise->data[i] *= -1;
    assert_true(test_same_bits(run(&f), plus));
    assert_false(test_same_bits(plus, f.water));
}

static void softness_0_is_a_step(void **state)
{
    const foam f = begin(state);
    test_twin_set(f.t, "softness", "0");
    assert_share(&f, 0.25, 0);
    assert_share(&f, (double)nextafterf(0.25f, 1), 1);
    assert_share(&f, (double)nextafterf(-0.25f, -1), 1);
    test_twin_set(f.t, "threshold", "0");
    assert_share(&f, 0, 0);
    assert_share(&f, 1e-30, 1);
}

static void water_below_the_threshold_keeps_every_bit(void **state)
{
    static const char *const blends[] = {"add", "over"};
    const foam f = begin(state);
    uint64_t random = 37;
    for (int i = 0; i < N; i++) f.noise->data[i] = (double)(float)test_random(&random, -0.25, 0.25);
    for (int i = 0; i < 3 * N; i += 7) f.normal->data[i] = NAN; /* which nobody asks for */
    for (size_t i = 0; i < SSFR_COUNT(blends); i++) {
        test_twin_set(f.t, "blend", "%s", blends[i]);
        assert_true(test_same_bits(run(&f), f.water));
    }
}

/* ---- its colour -------------------------------------------------------------------------------------------------- */

static void foam_over_water_hides_as_much_as_there_is_of_it(void **state)
{
    static const double shares[][2] = {{0.375, 0.15625}, {0.5, 0.5}, {0.75, 1}, {9, 1}};
    const foam f = begin(state);
    test_twin_set(f.t, "blend", "over");
    for (size_t i = 0; i < SSFR_COUNT(shares); i++) {
        ssfr_field_fill(f.noise, shares[i][0]);
        const ssfr_field *color = run(&f);
        for (int k = 0; k < 3 * N; k++)
            assert_close(color->data[k], ssfr_mix(f.water->data[k], grey[k % 3], shares[i][1]), 8 * f.t->eps, 0);
    }
}

/* Turned from the light by an angle, in any direction, foam has the ambient share and the cosine of the rest. */
static void foam_is_lit_by_the_cosine_and_the_ambient_share(void **state)
{
    static const double degrees[] = {0, 30, 60, 90, 120, 180}, cosines_squared[] = {1, 0.75, 0.25, 0, 0, 0};
    const double a = 20 * pi / 180, e = 50 * pi / 180, light[3] = {cos(e) * cos(a), sin(e), cos(e) * sin(a)};
    const foam f = begin(state);
    double side[3], other[3];
    ssfr_cross(light, (const double[3]){0, 1, 0}, side);
    ssfr_normalize(side);
    ssfr_cross(light, side, other);
    test_twin_set(f.t, "light.azimuth_deg", "20");
    test_twin_set(f.t, "light.elevation_deg", "50");
    test_twin_set(f.t, "light.intensity", "1.5");
    test_twin_set(f.t, "light.ambient", "0.25");
    ssfr_field_fill(f.noise, 1);
    for (size_t i = 0; i < SSFR_COUNT(degrees); i++) {
        const double angle = degrees[i] * pi / 180, cosine = sqrt(cosines_squared[i]);
        for (int k = 0; k < 3 * N; k++)
            f.normal->data[k] = cos(angle) * light[k % 3] + sin(angle) * (cos(k / 3) * side[k % 3] +
                                                                          sin(k / 3) * other[k % 3]);
        const ssfr_field *color = run(&f);
        for (int k = 0; k < 3 * N; k++)
            assert_close(share(&f, color, k), 0.25 + 0.75 * 1.5 * cosine, 32 * f.t->eps, 0);
    }
}

/* Where the normals are left out there are none: the ambient share is left, and no NaN. */
static void foam_without_normals_has_the_ambient_share(void **state)
{
    const foam f = begin(state);
    test_twin_set(f.t, "light.ambient", "0.375");
    ssfr_field_fill(f.normal, 0);
    assert_share(&f, 1, 0.375);
}

static void foam_turns_with_the_eye(void **state)
{
    static const double above[3] = {0, 3, 0}, down[3] = {0, 0, -1e-3};
    const foam f = begin(state);
    test_twin_look(f.t, above, down); /* what faces the eye looks up, to the light */
    test_twin_set(f.t, "light.elevation_deg", "90");
    test_twin_set(f.t, "light.ambient", "0");
    ssfr_field_fill(f.noise, 1);
    const ssfr_field *color = run(&f);
    for (int i = 0; i < 3 * N; i++) assert_close(share(&f, color, i), 1, 1e-6, 0); /* by 1e-3 / 3 rad, squared */
}

/* ---- what is left alone ------------------------------------------------------------------------------------------ */

static void pixels_without_surface_have_no_foam(void **state)
{
    const foam f = begin(state);
    uint64_t random = 41;
    ssfr_field_fill(f.noise, 1);
    for (int i = 0; i < N; i++)
        if (test_random(&random, 0, 1) < 0.5) f.depth->data[i] = -SSFR_EMPTY;
    const ssfr_field *color = run(&f);
    for (int i = 0; i < 3 * N; i++)
        assert_true((color->data[i] == f.water->data[i]) == !ssfr_is_surface(f.depth->data[i / 3]));
}

static void foam_of_strength_0_is_left_out_and_changes_no_bit(void **state)
{
    static const char *const blends[] = {"add", "over"};
    const foam f = begin(state);
    ssfr_field_fill(f.noise, 1);
    test_twin_set(f.t, "strength", "0");
    for (size_t i = 0; i < SSFR_COUNT(blends); i++) {
        ssfr_node_status status;
        test_twin_set(f.t, "blend", "%s", blends[i]);
        assert_true(test_same_bits(run(&f), f.water));
        assert_true(test_same_bits(test_twin_run_if_needed(f.t, "color", &status), f.water));
        assert_int_equal(status, SSFR_NEEDLESS);
    }
}

static void without_fluid_foam_is_left_out(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    ssfr_node_status status;
    const foam f = begin(state);
    test_twin_place(f.t, 1, behind, 0.1, NULL);
    test_twin_give(f.t, "water", f.water);
    assert_true(test_same_bits(test_twin_run_if_needed(f.t, "color", &status), f.water));
    assert_int_equal(status, SSFR_NEEDLESS);
}

static void noise_that_is_no_number_makes_none_of_the_picture(void **state)
{
    static const char *const softness[] = {"0", "0.5"};
    const foam f = begin(state);
    for (int i = 0; i < N; i++) f.noise->data[i] = i % 3 == 0 ? NAN : i % 3 == 1 ? INFINITY : -INFINITY;
    for (size_t s = 0; s < SSFR_COUNT(softness); s++) {
        test_twin_set(f.t, "softness", "%s", softness[s]);
        const ssfr_field *color = run(&f);
        for (int i = 0; i < 3 * N; i++) assert_close(share(&f, color, i), i / 3 % 3 > 0, 8 * f.t->eps, 0);
    }
}

static void noise_foam_refuses_values_out_of_range(void **state)
{
    const foam f = begin(state);
    test_twin_refuses(f.t, "strength", "1.5", "noise_foam.strength");
    test_twin_refuses(f.t, "strength", "-0.1", "noise_foam.strength");
    test_twin_refuses(f.t, "threshold", "-0.1", "noise_foam.threshold");
    test_twin_refuses(f.t, "softness", "-2.385", "noise_foam.softness");
    test_twin_refuses(f.t, "color_g", "1.1", "noise_foam.color_g");
    test_twin_refuses(f.t, "blend", "under", "under");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(foam_grows_by_smoothstep_from_the_threshold),
        TEST_TWINS(noise_counts_by_its_magnitude),
        TEST_TWINS(softness_0_is_a_step),
        TEST_TWINS(water_below_the_threshold_keeps_every_bit),
        TEST_TWINS(foam_over_water_hides_as_much_as_there_is_of_it),
        TEST_TWINS(foam_is_lit_by_the_cosine_and_the_ambient_share),
        TEST_TWINS(foam_without_normals_has_the_ambient_share),
        TEST_TWINS(foam_turns_with_the_eye),
        TEST_TWINS(pixels_without_surface_have_no_foam),
        TEST_TWINS(foam_of_strength_0_is_left_out_and_changes_no_bit),
        TEST_TWINS(without_fluid_foam_is_left_out),
        TEST_TWINS(noise_that_is_no_number_makes_none_of_the_picture),
        TEST_TWINS(noise_foam_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

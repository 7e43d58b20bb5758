/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_radial.c: each kernel's mass, slope and chords, against integrals by GSL and against antiderivatives by hand. */
#include "experiments/truth/radial.h"
#include "tests/util.h"

#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>

#define EACH(radial) const ssfr_radial *radial = ssfr_radials; radial < ssfr_radials + SSFR_N_RADIALS; radial++

/* ---- the kernel itself ------------------------------------------------------------------------------------------- */

static double shell(double q, void *radial)
{
    return 4 * M_PI * q * q * ssfr_radial_value(radial, q);
}

/* Each piece of a kernel is a polynomial, which eight points integrate exactly up to the degree 15. */
static void the_mass_of_a_kernel_is_one(void **state)
{
    (void)state;
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(8);
    for (EACH(radial)) {
        const gsl_function f = {shell, (void *)radial};
        const double seam = radial->seam;
        const double mass = gsl_integration_glfixed(&f, 0, seam, table) + gsl_integration_glfixed(&f, seam, 1, table);
        assert_close(mass, 1, 4e-15, 0);
    }
    gsl_integration_glfixed_table_free(table);
}

/* As the papers write them, with h half of the support for the spline. */
static void kernels_are_those_of_the_papers(void **state)
{
    (void)state;
    for (double q = 0; q < 1.2; q += 0.02385) {
        const double u = 2 * q;
        const double spline = u < 1 ? 1 - 1.5 * u * u + 0.75 * u * u * u : u < 2 ? 0.25 * pow(2 - u, 3) : 0;
        assert_close(ssfr_radial_value(&ssfr_radials[0], q), 8 / M_PI * spline, 1e-15, 1e-14);
        const double in = q < 1;
        assert_close(ssfr_radial_value(&ssfr_radials[1], q), in * 315 / (64 * M_PI) * pow(1 - q * q, 3), 1e-15, 1e-14);
        assert_close(ssfr_radial_value(&ssfr_radials[2], q), in * 21 / (2 * M_PI) * pow(1 - q, 4) * (1 + 4 * q), 1e-15,
                     1e-14);
    }
}

static void a_kernel_falls_to_nothing_at_its_support(void **state)
{
    (void)state;
    for (EACH(radial)) {
        double last = ssfr_radial_value(radial, 0), last_steepness = ssfr_radial_steepness(radial, 0);
        for (int i = 1; i < 10000; i++) {
            const double q = i / 10000.0, value = ssfr_radial_value(radial, q);
            const double steepness = ssfr_radial_steepness(radial, q);
            assert_true(value > 0 && value < last && steepness > 0 && steepness <= last_steepness);
            last = value, last_steepness = steepness;
        }
        for (double q = 1; q < 1e300; q *= 2.385) {
            assert_true(ssfr_radial_value(radial, q) == 0);
            assert_true(ssfr_radial_steepness(radial, q) == 0);
        }
        assert_true(ssfr_radial_value(radial, INFINITY) == 0 && ssfr_radial_steepness(radial, INFINITY) == 0);
    }
}

/* A distance of 1e-9 before the support the values are 1e-27 to 1e-36: relative digits are there all the same. */
static void digits_last_up_to_the_support(void **state)
{
    (void)state;
    const double left = ldexp(1, -30), q = 1 - left; /* exact */
    assert_close(ssfr_radial_value(&ssfr_radials[0], q), 16 / M_PI * pow(left, 3), 0, 1e-15);
    assert_close(ssfr_radial_value(&ssfr_radials[1], q), 315 / (64 * M_PI) * pow(left * (2 - left), 3), 0, 1e-15);
    assert_close(ssfr_radial_value(&ssfr_radials[2], q), 21 / (2 * M_PI) * pow(left, 4) * (5 - 4 * left), 0, 1e-15);
}

static void the_steepness_is_the_slope_over_the_distance(void **state)
{
    (void)state;
    const double step = 1e-5;
    for (EACH(radial)) {
        for (double q = 0.0101; q < 0.98; q += 0.0477) {
            const double fall = ssfr_radial_value(radial, q - step) - ssfr_radial_value(radial, q + step);
            assert_close(q * ssfr_radial_steepness(radial, q), fall / (2 * step), 2e-8, 0);
        }
        /* w(0) - w = steepness q^2 / 2 */
        const double fall = ssfr_radial_value(radial, 0) - ssfr_radial_value(radial, 1e-4);
        assert_close(ssfr_radial_steepness(radial, 0), 2 * fall / 1e-8, 0, 1e-3);
        assert_true(isfinite(ssfr_radial_steepness(radial, 0)));
    }
}

static void value_and_steepness_together_are_the_same_bits(void **state)
{
    (void)state;
    for (EACH(radial))
        for (double q = 0; q < 1.1; q += 0.002385) {
            double steepness;
            assert_true(ssfr_radial_both(radial, q, &steepness) == ssfr_radial_value(radial, q));
            assert_true(steepness == ssfr_radial_steepness(radial, q));
        }
}

static void names_are_in_the_order_of_the_kernels(void **state)
{
    (void)state;
    for (int i = 0; i < SSFR_N_RADIALS; i++) {
        assert_string_equal(ssfr_radial_names[i], ssfr_radials[i].name);
        assert_true(ssfr_radials[i].source[0] != '\0');
    }
    assert_null(ssfr_radial_names[SSFR_N_RADIALS]);
}

/* ---- chords ------------------------------------------------------------------------------------------------------ */

typedef struct line {
    const ssfr_radial *radial;
    double b;
} line;

static double along(double s, void *user)
{
    const line *l = user;
    return ssfr_radial_value(l->radial, hypot(l->b, s));
}

/* By GSL between the places where a piece of the kernel begins, and others that close in on the middle: there the slope
 * turns within a length of b. */
static double by_gsl(gsl_integration_workspace *work, const line *l, double s)
{
    double breaks[64] = {0}, value, err;
    size_t n = 1;
    for (double radius = 0.5; radius <= 1; radius += 0.5) {
        const double half = l->b < radius ? sqrt((radius - l->b) * (radius + l->b)) : 0;
        if (half > 0 && half < s) breaks[n++] = half;
    }
    for (double at = l->b; at < s && n < 63; at *= 4) breaks[n++] = at;
    breaks[n++] = s;
    qsort(breaks, n, sizeof *breaks, ssfr_by_value);
    gsl_function f = {along, (void *)l};
    gsl_integration_qagp(&f, breaks, n, 1e-15, 1e-14, work->limit, work, &value, &err);
    return value;
}

static void chords_are_what_gsl_integrates(void **state)
{
    (void)state;
    gsl_set_error_handler_off(); /* it warns of rounding at these tolerances */
    gsl_integration_workspace *work = gsl_integration_workspace_alloc(1000);
    uint64_t random = 2385;
    for (EACH(radial)) {
        for (int i = 0; i < 2000; i++) {
            const line l = {radial, i % 7 == 0 ? pow(10, test_random(&random, -12, 0)) : test_random(&random, 0, 1.1)};
            const double s = i % 5 == 0 ? pow(10, test_random(&random, -9, 0)) : test_random(&random, 0, 1.3);
            assert_close(ssfr_radial_chord(radial, l.b, s), by_gsl(work, &l, s), radial->chord_err + 2e-15, 0);
        }
    }
    gsl_integration_workspace_free(work);
}

static void chords_through_the_middle_are_antiderivatives(void **state)
{
    (void)state;
    for (double s = 0; s < 1.4; s += 0.02385) {
        const double t = fmin(s, 1), u = fmin(s, 0.5);
        const double spline = 8 / M_PI * (0.5 * (1 - pow(1 - t, 4)) - 2 * (0.0625 - pow(0.5 - u, 4)));
        const double poly6 = 315 / (64 * M_PI) * (t - pow(t, 3) + 0.6 * pow(t, 5) - pow(t, 7) / 7);
        const double wendland = 21 / (2 * M_PI) * (1 - pow(1 - t, 5) - 2 * (1 - pow(1 - t, 6)) / 3);
        assert_close(ssfr_radial_chord(&ssfr_radials[0], 0, s), spline, 1e-15, 0);
        assert_close(ssfr_radial_chord(&ssfr_radials[1], 0, s), poly6, 1e-15, 0);
        assert_close(ssfr_radial_chord(&ssfr_radials[2], 0, s), wendland, 2e-15, 0);
    }
}

/* sqrt(b^2 + s^2), s / b and its logarithm are all near their ends there. */
static void chords_have_a_limit_at_the_middle(void **state)
{
    (void)state;
    for (EACH(radial))
        for (double s = 1e-6; s < 2; s *= 3.385)
            for (double b = 1e-9; b > 0; b *= 1e-7) /* down through denormals */
                assert_close(ssfr_radial_chord(radial, b, s), ssfr_radial_chord(radial, 0, s), 2e-15, 0);
}

static void chords_are_odd_rise_and_end_at_the_support(void **state)
{
    (void)state;
    for (EACH(radial))
        for (double b = 0; b < 1.1; b += 0.02385) {
            const double whole = ssfr_radial_chord(radial, b, 1);
            double last = 0;
            assert_true(b < 1 ? whole > 0 : whole == 0);
            assert_true(ssfr_radial_chord(radial, b, 0) == 0);
            for (double s = 0.0043; s < 1; s += 0.0043) {
                const double chord = ssfr_radial_chord(radial, b, s);
                assert_true(chord >= last - 2 * radial->chord_err && ssfr_radial_chord(radial, b, -s) == -chord);
                last = chord;
            }
            assert_true(ssfr_radial_chord(radial, b, INFINITY) == whole);
            assert_true(ssfr_radial_chord(radial, b, -2.385) == -whole);
        }
}

static void chords_do_not_jump_where_pieces_begin(void **state)
{
    (void)state;
    for (EACH(radial))
        for (double radius = 0.5; radius <= 1; radius += 0.5) {
            for (double b = 0.01; b < radius; b += 0.02385) {
                const double half = sqrt(radius * radius - b * b), beyond = ssfr_radial_chord(radial, b, half + 1e-15);
                assert_close(ssfr_radial_chord(radial, b, half - 1e-15), beyond, 2 * radial->chord_err + 4e-15, 0);
            }
            const double inside = ssfr_radial_chord(radial, radius * (1 - DBL_EPSILON), 1);
            assert_close(inside, ssfr_radial_chord(radial, radius, 1), 2e-15, 0);
        }
}

/* All the chords of parallel lines together are the kernel: int 2 pi b 2 chord(b) db = 1. */
static double ring(double b, void *radial)
{
    return 4 * M_PI * b * ssfr_radial_chord(radial, b, 1);
}

static void chords_of_parallel_lines_add_up_to_one(void **state)
{
    (void)state;
    gsl_integration_workspace *work = gsl_integration_workspace_alloc(1000);
    for (EACH(radial)) {
        double breaks[] = {0, 0.5, 1}, value, err;
        gsl_function f = {ring, (void *)radial};
        assert_int_equal(gsl_integration_qagp(&f, breaks, 3, 1e-13, 0, work->limit, work, &value, &err), GSL_SUCCESS);
        assert_close(value, 1, 1e-13, 0);
    }
    gsl_integration_workspace_free(work);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_mass_of_a_kernel_is_one),
        cmocka_unit_test(kernels_are_those_of_the_papers),
        cmocka_unit_test(a_kernel_falls_to_nothing_at_its_support),
        cmocka_unit_test(digits_last_up_to_the_support),
        cmocka_unit_test(the_steepness_is_the_slope_over_the_distance),
        cmocka_unit_test(value_and_steepness_together_are_the_same_bits),
        cmocka_unit_test(names_are_in_the_order_of_the_kernels),
        cmocka_unit_test(chords_are_what_gsl_integrates),
        cmocka_unit_test(chords_through_the_middle_are_antiderivatives),
        cmocka_unit_test(chords_have_a_limit_at_the_middle),
        cmocka_unit_test(chords_are_odd_rise_and_end_at_the_support),
        cmocka_unit_test(chords_do_not_jump_where_pieces_begin),
        cmocka_unit_test(chords_of_parallel_lines_add_up_to_one),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

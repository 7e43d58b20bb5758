/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_kernel.c: the cubic spline, its slope and its share behind a wall, against integrals; four floats at a time. */
#include "experiments/scenes/kernel.h"
#include "tests/util.h"

static const double support = 0.0954, volume = 2.385e-5; /* m, m^3 */

static ssfr_kernel make(void)
{
    return ssfr_kernel_make(support, volume);
}

static double value(double r)
{
    const ssfr_kernel kernel = make();
    return (double)ssfr_kernel_value(&kernel, ssfr_lanes_all((float)r))[0];
}

static double slope(double r)
{
    const ssfr_kernel kernel = make();
    return (double)ssfr_kernel_slope(&kernel, ssfr_lanes_all((float)r))[0];
}

/* ---- the kernel -------------------------------------------------------------------------------------------------- */

/* As it is usually written, in two pieces with h half of where it ends. */
static double spline(double r)
{
    const double h = 0.5 * support, q = r / h, norm = 1 / (M_PI * h * h * h);
    return q < 1 ? norm * (1 - 1.5 * q * q + 0.75 * q * q * q) : q < 2 ? 0.25 * norm * pow(2 - q, 3) : 0;
}

static void the_kernel_is_the_cubic_spline(void **state)
{
    (void)state;
    for (int i = 0; i <= 240; i++) {
        const double r = i * support / 200;
        assert_close(value(r), volume * spline(r), 2e-6 * volume * spline(0), 0);
    }
    assert_true(value(1.0001 * support) == 0 && slope(1.0001 * support) == 0);
    assert_close((double)make().value, value(0), 0, 1e-6);
}

static void the_kernel_of_a_unit_volume_adds_up_to_one(void **state)
{
    (void)state;
    enum { N = 4000 };
    double sum = 0;
    for (int i = 0; i < N; i++) {
        const double r = (i + 0.5) * support / N;
        sum += 4 * M_PI * r * r * value(r) / volume * support / N;
    }
    assert_close(sum, 1, 1e-5, 0);
}

static void the_slope_is_the_derivative_and_no_weaker_within_a_third(void **state)
{
    (void)state;
    const double step = 1e-5 * support;
    const double steepest = (spline(support / 3 + step) - spline(support / 3 - step)) / (2 * step);
    for (int i = 1; i < 200; i++) {
        const double r = i * support / 200;
        const double derivative = (spline(r + step) - spline(r - step)) / (2 * step);
        assert_close(slope(r), volume * (r < support / 3 ? steepest : derivative), -1e-5 * volume * steepest, 0);
    }
    assert_close(slope(0), volume * steepest, 0, 1e-5);
}

/* ---- behind a wall ----------------------------------------------------------------------------------------------- */

/* The integral of the spline of support 1 over the half-space from q on: shells of the ball, each with its cap. */
static double behind(double q)
{
    enum { N = 20000 };
    double sum = 0;
    for (int i = 0; i < N; i++) {
        const double r = (i + 0.5) / N, cap = r <= fabs(q) ? (q < 0 ? 4 * M_PI * r * r : 0) : 2 * M_PI * r * (r - q);
        sum += cap * spline(r * support) * pow(support, 3) / N;
    }
    return sum;
}

static void the_share_behind_a_wall_is_the_kernels_integral(void **state)
{
    (void)state;
    for (double q = -1.15; q < 1.2; q += 0.05) {
        float derivative;
        assert_close((double)ssfr_kernel_behind((float)q, &derivative), behind(q), 2e-6, 0);
        assert_close((double)derivative, (behind(q + 1e-3) - behind(q - 1e-3)) / 2e-3, 1e-4, 0);
    }
}

/* ---- lanes ------------------------------------------------------------------------------------------------------- */

static void lanes_do_what_one_float_after_the_other_would(void **state)
{
    (void)state;
    const float from[5] = {2.385f, -1.117f, 0, 0x1p-149f, 9};
    const ssfr_lanes a = ssfr_lanes_load(from), b = ssfr_lanes_load(from + 1);
    const ssfr_lanes roots = ssfr_lanes_sqrt(a * a), positive = ssfr_lanes_positive(a);
    for (int l = 0; l < SSFR_LANES; l++) {
        assert_true(a[l] == from[l] && b[l] == from[l + 1]);
        assert_true(roots[l] == sqrtf(from[l] * from[l]));
        assert_true(positive[l] == fmaxf(from[l], 0));
        assert_true(ssfr_lanes_where(a < 0, b)[l] == (from[l] < 0 ? from[l + 1] : 0));
        assert_true(ssfr_lanes_all(2.385f)[l] == 2.385f);
    }
    for (unsigned bits = 0; bits < 16; bits++) {
        ssfr_lanes_mask mask;
        for (int l = 0; l < SSFR_LANES; l++) mask[l] = bits >> l & 1 ? -1 : 0;
        assert_int_equal(ssfr_lanes_bits(mask), bits);
    }
    assert_true(ssfr_lanes_sum((ssfr_lanes){0x1p24f, 1, -0x1p24f, 2}) == 3); /* pairs two apart first */
}

static void four_rows_become_four_columns(void **state)
{
    (void)state;
    ssfr_lanes m[4];
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) m[i][k] = (float)(10 * i + k);
    ssfr_lanes_transpose(m);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) assert_true(m[i][k] == (float)(10 * k + i));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_kernel_is_the_cubic_spline),
        cmocka_unit_test(the_kernel_of_a_unit_volume_adds_up_to_one),
        cmocka_unit_test(the_slope_is_the_derivative_and_no_weaker_within_a_third),
        cmocka_unit_test(the_share_behind_a_wall_is_the_kernels_integral),
        cmocka_unit_test(lanes_do_what_one_float_after_the_other_would),
        cmocka_unit_test(four_rows_become_four_columns),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

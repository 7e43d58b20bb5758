/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_half.c: rounding to 16-bit floats, at every one of them and between all neighbours. */
#include "tests/util.h"

#include "base/half.h"

enum { INFINITE = 0x7c00 }; /* the bits of it */

/* What the bits of a half mean, sign left out. */
static double value_of(unsigned bits)
{
    const int exponent = (int)(bits >> 10);
    const double fraction = bits & 1023;
    return exponent == 0 ? ldexp(fraction, -24) : ldexp(1024 + fraction, exponent - 25);
}

static void assert_rounds(double v, double to)
{
    const double got = ssfr_half_round(v), opposite = ssfr_half_round(-v);
    if (!(got == to) || !(opposite == -to) || signbit(got) != signbit(v) || signbit(opposite) == signbit(v))
        fail_msg("%.17g gives %.17g and %.17g, expected %.17g", v, got, opposite, to);
}

static void every_half_is_left_as_it_is(void **state)
{
    (void)state;
    for (unsigned bits = 0; bits < INFINITE; bits++) assert_rounds(value_of(bits), value_of(bits));
    assert_rounds(INFINITY, INFINITY);
    assert_true(isnan(ssfr_half_round(NAN)));
}

/* The value of what would come after the largest is where infinity takes its place in the rounding. */
static void what_is_midway_goes_to_the_even_one_and_all_else_to_the_nearest(void **state)
{
    (void)state;
    for (unsigned bits = 0; bits < INFINITE; bits++) {
        const double low = value_of(bits), high = value_of(bits + 1), middle = 0.5 * (low + high);
        const double above = bits + 1 == INFINITE ? INFINITY : high;
        assert_rounds(middle, bits % 2 ? above : low);
        assert_rounds(nextafter(middle, 0), low);
        assert_rounds(nextafter(middle, INFINITY), above);
        assert_rounds(nextafter(low, INFINITY), low);
        assert_rounds(nextafter(high, 0), above);
    }
}

static void numbers_out_of_range_become_nothing_or_infinite(void **state)
{
    (void)state;
    static const double huge[] = {65520, 65536, 1e30, 1e308}, tiny[] = {0x1p-25, 1e-30, 5e-324};
    for (size_t i = 0; i < SSFR_COUNT(huge); i++) assert_rounds(huge[i], INFINITY);
    for (size_t i = 0; i < SSFR_COUNT(tiny); i++) assert_rounds(tiny[i], 0);
    assert_rounds(nextafter(65520, 0), 65504);
    assert_rounds(nextafter(0x1p-25, 1), 0x1p-24);
}

/* A little more than midway between 1 and the next: a float would be midway itself, and that rounds to 1. */
static void nothing_is_rounded_twice(void **state)
{
    (void)state;
    const double v = 1 + 0x1p-11 + 0x1p-40;
    assert_true(ssfr_half_round((double)(float)v) == 1);
    assert_rounds(v, 1 + 0x1p-10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_half_is_left_as_it_is),
        cmocka_unit_test(what_is_midway_goes_to_the_even_one_and_all_else_to_the_nearest),
        cmocka_unit_test(numbers_out_of_range_become_nothing_or_infinite),
        cmocka_unit_test(nothing_is_rounded_twice),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

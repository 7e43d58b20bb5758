/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_field.c: fields are zeroed, laid out from the top, fetched within bounds, rounded to float, copied. */
#include "tests/util.h"

#include "base/field.h"

#include <float.h>

static ssfr_field *make(int w, int h, int c)
{
    ssfr_field *field = NULL;
    assert_int_equal(ssfr_field_create(&field, w, h, c), SSFR_OK);
    return field;
}

static void a_new_field_is_zero(void **state)
{
    (void)state;
    ssfr_field *f = make(37, 23, 3);
    assert_int_equal(f->w, 37);
    assert_int_equal(f->h, 23);
    assert_int_equal(f->c, 3);
    for (int i = 0; i < 37 * 23 * 3; i++) assert_true(f->data[i] == 0 && !signbit(f->data[i]));
    ssfr_field_destroy(&f);
    assert_null(f);
    ssfr_field_destroy(&f);
}

static void sizes_outside_the_limits_are_refused(void **state)
{
    (void)state;
    static const struct {
        int w, h, c;
        const char *text;
    } bad[] = {
        {0, 4, 1, "0 x 4"},
        {4, 0, 1, "4 x 0"},
        {-23, 4, 1, "-23 x 4"},
        {4, -1, 1, "4 x -1"},
        {SSFR_MAX_SIZE + 1, 1, 1, "16385 x 1"},
        {1, SSFR_MAX_SIZE + 1, 1, "sides go from 1 to 16384"},
        {4, 4, 0, "4 x 4 pixels and 0 channels"},
        {4, 4, 17, "channels from 1 to 16"},
        {INT32_MAX, INT32_MAX, INT32_MAX, "2147483647 x 2147483647"},
    };
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) {
        ssfr_field *f = (ssfr_field *)&bad;
        assert_fails(SSFR_ERR_VALUE, ssfr_field_create(&f, bad[i].w, bad[i].h, bad[i].c), bad[i].text);
        assert_null(f);
    }
    ssfr_field *wide = make(SSFR_MAX_SIZE, 1, 16);
    ssfr_field_destroy(&wide);
}

static void rows_run_from_the_top_with_channels_interleaved(void **state)
{
    (void)state;
    ssfr_field *f = make(5, 4, 2);
    for (int i = 0; i < 40; i++) f->data[i] = i;
    assert_true(ssfr_field_at(f, 0, 0) == f->data);
    assert_true(ssfr_field_at(f, 3, 2)[1] == (2 * 5 + 3) * 2 + 1);
    ssfr_field_destroy(&f);
}

static void fetching_clamps_to_the_border(void **state)
{
    (void)state;
    ssfr_field *f = make(5, 4, 1), *one = make(1, 1, 1);
    for (int i = 0; i < 20; i++) f->data[i] = i;
    assert_true(*ssfr_field_fetch(f, -3, 2) == 10);
    assert_true(*ssfr_field_fetch(f, 9, 2) == 14);
    assert_true(*ssfr_field_fetch(f, 2, -1) == 2);
    assert_true(*ssfr_field_fetch(f, 2, 4) == 17);
    assert_true(*ssfr_field_fetch(f, INT32_MIN, INT32_MAX) == 15);
    *one->data = 2.385;
    assert_true(*ssfr_field_fetch(one, 117, 23) == 2.385);
    ssfr_field_destroy(&one);
    ssfr_field_destroy(&f);
}

static void filling_and_copying_touch_every_value(void **state)
{
    (void)state;
    ssfr_field *f = make(7, 3, 3), *copy = NULL;
    ssfr_field_fill(f, 2.385);
    for (int i = 0; i < 63; i++) assert_true(f->data[i] == 2.385);
    for (int i = 0; i < 63; i++) f->data[i] = i % 5 ? -1.0 / (i + 1) : (double)NAN;
    assert_int_equal(ssfr_field_copy(&copy, f), SSFR_OK);
    assert_int_equal(copy->w, 7);
    assert_int_equal(copy->h, 3);
    assert_int_equal(copy->c, 3);
    assert_memory_equal(copy->data, f->data, 63 * sizeof *f->data);
    ssfr_field_destroy(&copy);
    ssfr_field_destroy(&f);
}

static void rounding_gives_what_a_float_holds(void **state)
{
    (void)state;
    static const double values[] = {0.1, -2.385, SSFR_EMPTY, -SSFR_EMPTY, 1e-50, 1.5, 16777217};
    ssfr_field *f = make((int)SSFR_COUNT(values), 1, 1);
    memcpy(f->data, values, sizeof values);
    ssfr_field_round(f);
    for (size_t i = 0; i < SSFR_COUNT(values); i++) assert_true(f->data[i] == (double)(float)values[i]);
    assert_true(f->data[0] != 0.1 && fabs(f->data[0] - 0.1) < 0.1 * (double)FLT_EPSILON);
    assert_true(f->data[4] == 0 && f->data[5] == 1.5 && f->data[6] == 16777216);
    ssfr_field_destroy(&f);
}

static void empty_pixels_are_no_surface_in_double_float_and_half(void **state)
{
    (void)state;
    assert_true(ssfr_is_surface(-2.385));
    assert_true(ssfr_is_surface(-1e28));
    assert_false(ssfr_is_surface(-SSFR_EMPTY));
    assert_false(ssfr_is_surface(SSFR_EMPTY));
    assert_false(ssfr_is_surface((double)(float)-SSFR_EMPTY));
    assert_false(ssfr_is_surface(-INFINITY)); /* what -1e30 is in a half float */
    assert_false(ssfr_is_surface((double)NAN));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_new_field_is_zero),
        cmocka_unit_test(sizes_outside_the_limits_are_refused),
        cmocka_unit_test(rows_run_from_the_top_with_channels_interleaved),
        cmocka_unit_test(fetching_clamps_to_the_border),
        cmocka_unit_test(filling_and_copying_touch_every_value),
        cmocka_unit_test(rounding_gives_what_a_float_holds),
        cmocka_unit_test(empty_pixels_are_no_surface_in_double_float_and_half),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

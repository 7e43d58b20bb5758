/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_param.c: parameter rows: defaults, parsing, ranges, units in messages, text that reads back the same. */
#include "tests/util.h"

#include "base/param.h"

#include <float.h>

typedef struct box {
    char before;
    double length, ratio, any;
    int steps, all;
    int thin, colour;
    unsigned errata;
    char after;
} box;

static const char *const colours[] = {"red", "green", "greenish", NULL};
static const char *const errata[] = {"B10", "B11", "B2", NULL};

static const ssfr_param rows[] = {
    SSFR_PARAM_REAL(box, length, "m", 2.385, 0.001, 1e6, "how long it is"),
    SSFR_PARAM_REAL(box, ratio, "1", 0.5, 0, 1, "how full it is"),
    SSFR_PARAM_REAL(box, any, "1", 0, -DBL_MAX, DBL_MAX, "any number"),
    SSFR_PARAM_INT(box, steps, "px", 7, -3, 100000, "how many steps"),
    SSFR_PARAM_INT(box, all, "1", -1, INT32_MIN, INT32_MAX, "any int"),
    SSFR_PARAM_FLAG(box, thin, 1, "whether it is thin"),
    SSFR_PARAM_CHOICE(box, colour, colours, 1, "its colour"),
    SSFR_PARAM_SET(box, errata, errata, 5, "its faults"),
    SSFR_PARAM_END,
};

static box defaults(void)
{
    box b = {.before = 'b', .after = 'a'};
    ssfr_params_default(rows, &b);
    return b;
}

static ssfr_result set(box *b, const char *name, const char *text)
{
    char key[32];
    const ssfr_param *row = ssfr_param_find(rows, name);
    assert_non_null(row);
    snprintf(key, sizeof key, "box.%s", name);
    return ssfr_param_set(row, b, key, text);
}

static const char *get(const box *b, const char *name)
{
    static char text[64];
    ssfr_param_format(ssfr_param_find(rows, name), b, text, sizeof text);
    return text;
}

static void defaults_fill_the_members_and_nothing_else(void **state)
{
    (void)state;
    const box b = defaults();
    assert_true(b.length == 2.385 && b.ratio == 0.5 && b.any == 0);
    assert_int_equal(b.steps, 7);
    assert_int_equal(b.all, -1);
    assert_int_equal(b.thin, 1);
    assert_int_equal(b.colour, 1);
    assert_int_equal(b.errata, 5);
    assert_true(b.before == 'b' && b.after == 'a');
    ssfr_params_default(NULL, NULL); /* a pass without parameters */
}

static void rows_are_found_by_their_whole_name(void **state)
{
    (void)state;
    assert_ptr_equal(ssfr_param_find(rows, "ratio"), &rows[1]);
    assert_null(ssfr_param_find(rows, "rati"));
    assert_null(ssfr_param_find(rows, "ratios"));
    assert_null(ssfr_param_find(rows, ""));
    assert_null(ssfr_param_find(NULL, "ratio"));
    assert_int_equal(ssfr_param_n_words(ssfr_param_find(rows, "colour")), 3);
    assert_int_equal(ssfr_param_n_words(ssfr_param_find(rows, "ratio")), 0);
}

static void values_of_every_type_are_parsed(void **state)
{
    (void)state;
    box b = defaults();
    assert_int_equal(set(&b, "length", "0.001"), SSFR_OK);
    assert_true(b.length == 0.001);
    assert_int_equal(set(&b, "length", "1e6"), SSFR_OK);
    assert_true(b.length == 1e6);
    assert_int_equal(set(&b, "steps", "-3"), SSFR_OK);
    assert_int_equal(b.steps, -3);
    assert_int_equal(set(&b, "steps", "1e5"), SSFR_OK);
    assert_int_equal(b.steps, 100000);
    assert_int_equal(set(&b, "all", "-2147483648"), SSFR_OK);
    assert_int_equal(b.all, INT32_MIN);
    assert_int_equal(set(&b, "all", "2147483647"), SSFR_OK);
    assert_int_equal(b.all, INT32_MAX);
    assert_int_equal(set(&b, "colour", "greenish"), SSFR_OK);
    assert_int_equal(b.colour, 2);
    assert_int_equal(set(&b, "errata", "B11,B2"), SSFR_OK);
    assert_int_equal(b.errata, 6);
    assert_true(b.before == 'b' && b.after == 'a');
}

static void flags_have_four_spellings(void **state)
{
    (void)state;
    static const char *const words[][2] = {{"0", "1"}, {"off", "on"}, {"false", "true"}, {"no", "yes"}};
    static const char *const bad[] = {"", "2", "On", "maybe", "1.0", " 1", "offf"};
    box b = defaults();
    for (size_t i = 0; i < SSFR_COUNT(words); i++)
        for (int k = 0; k < 2; k++) {
            assert_int_equal(set(&b, "thin", words[i][k]), SSFR_OK);
            assert_int_equal(b.thin, k);
            assert_string_equal(get(&b, "thin"), k ? "1" : "0");
        }
    for (size_t i = 0; i < SSFR_COUNT(bad); i++)
        assert_fails(SSFR_ERR_VALUE, set(&b, "thin", bad[i]), "expected on or off");
    assert_int_equal(b.thin, 1);
}

static void what_is_no_finite_number_is_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {"", "nan", "NAN", "inf", "-inf", "1e400", "many", "2.385 m", "1,2", "2..3"};
    box b = defaults();
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) {
        char text[64];
        snprintf(text, sizeof text, "box.any=%s: expected a finite number", bad[i]);
        assert_fails(SSFR_ERR_VALUE, set(&b, "any", bad[i]), text);
        assert_fails(SSFR_ERR_VALUE, set(&b, "steps", bad[i]), "expected a finite number");
    }
    assert_true(b.any == 0);
    assert_int_equal(b.steps, 7);
}

static void whole_numbers_have_no_fraction(void **state)
{
    (void)state;
    box b = defaults();
    assert_fails(SSFR_ERR_VALUE, set(&b, "steps", "2.385"), "box.steps=2.385: expected a whole number");
    assert_fails(SSFR_ERR_VALUE, set(&b, "steps", "1e-3"), "expected a whole number");
    assert_int_equal(set(&b, "steps", "23.0"), SSFR_OK);
    assert_int_equal(b.steps, 23);
}

static void values_out_of_range_name_range_and_unit(void **state)
{
    (void)state;
    box b = defaults();
    assert_fails(SSFR_ERR_VALUE, set(&b, "length", "0.0009"), "box.length=0.0009: out of range [0.001, 1e+06] m");
    assert_fails(SSFR_ERR_VALUE, set(&b, "length", "1000000.1"), "box.length=1000000.1: out of range [0.001, 1e+06] m");
    assert_fails(SSFR_ERR_VALUE, set(&b, "steps", "-4"), "box.steps=-4: out of range [-3, 100000] px");
    assert_fails(SSFR_ERR_VALUE, set(&b, "all", "2147483648"), "out of range");
    assert_fails(SSFR_ERR_VALUE, set(&b, "all", "1e300"), "out of range");
    assert_fails(SSFR_ERR_VALUE, set(&b, "ratio", "-1e-300"), "box.ratio=-1e-300: out of range [0, 1]");
    assert_null(strstr(test_last_error(), "] 1"));
    const box untouched = defaults();
    assert_true(b.length == untouched.length && b.ratio == untouched.ratio && b.steps == untouched.steps);
}

static void unknown_words_are_answered_with_the_known_ones(void **state)
{
    (void)state;
    box b = defaults();
    assert_fails(SSFR_ERR_VALUE, set(&b, "colour", "blue"), "box.colour=blue: expected one of red, green, greenish");
    assert_fails(SSFR_ERR_VALUE, set(&b, "colour", ""), "expected one of red");
    assert_fails(SSFR_ERR_VALUE, set(&b, "colour", "gree"), "expected one of red");
    assert_fails(SSFR_ERR_VALUE, set(&b, "colour", "red,green"), "expected one of red");
    assert_fails(SSFR_ERR_VALUE, set(&b, "colour", "1"), "expected one of red");
    assert_int_equal(b.colour, 1);
}

static void sets_are_lists_or_none(void **state)
{
    (void)state;
    box b = defaults();
    assert_int_equal(set(&b, "errata", "none"), SSFR_OK);
    assert_int_equal(b.errata, 0);
    assert_string_equal(get(&b, "errata"), "none");
    assert_int_equal(set(&b, "errata", "B2,B10"), SSFR_OK);
    assert_int_equal(b.errata, 5);
    assert_string_equal(get(&b, "errata"), "B10,B2");
    static const char *const bad[] = {"", "B1", "B10,", ",B10", "B10,none", "B10 ,B11", "B10;B11", "all", "B10,,B11"};
    for (size_t i = 0; i < SSFR_COUNT(bad); i++)
        assert_fails(SSFR_ERR_VALUE, set(&b, "errata", bad[i]),
                     "expected none or a comma-separated list of B10, B11, B2");
    assert_fails(SSFR_ERR_VALUE, set(&b, "errata", "B10,B2,B10"), "box.errata=B10,B2,B10: B10 stands in it twice");
    assert_int_equal(b.errata, 5);
}

static void errors_stay_on_one_line(void **state)
{
    (void)state;
    box b = defaults();
    assert_fails(SSFR_ERR_VALUE, set(&b, "colour", "red\ngreen\r"), "box.colour=red green : expected");
}

static void reals_come_back_to_the_last_bit(void **state)
{
    (void)state;
    static const double values[] = {0.1, 1e-310, 2.385, 1.0 / 3, 4e-324, DBL_MAX, DBL_MIN, DBL_EPSILON,
                                    123456789.123456789, -0.1, 1e22, 9007199254740993.0, 5e-5, 0.30000000000000004};
    box b = defaults();
    for (size_t i = 0; i < SSFR_COUNT(values); i++) {
        b.any = values[i];
        const char *text = get(&b, "any");
        b.any = 7;
        assert_int_equal(set(&b, "any", text), SSFR_OK);
        assert_memory_equal(&b.any, &values[i], sizeof b.any);
    }
    uint64_t seed = 23;
    for (int i = 0; i < 10000; i++) {
        const double value = ldexp(test_random(&seed, -1, 1), (int)test_random(&seed, -1070, 1020));
        b.any = value;
        assert_int_equal(set(&b, "any", get(&b, "any")), SSFR_OK);
        assert_memory_equal(&b.any, &value, sizeof value);
    }
}

static void text_is_as_short_as_it_can_be(void **state)
{
    (void)state;
    box b = defaults();
    assert_string_equal(get(&b, "length"), "2.385");
    b.length = 0.1;
    assert_string_equal(get(&b, "length"), "0.1");
    b.length = 0.30000000000000004;
    assert_string_equal(get(&b, "length"), "0.30000000000000004");
    assert_string_equal(get(&b, "steps"), "7");
    assert_string_equal(get(&b, "all"), "-1");
    assert_string_equal(get(&b, "colour"), "green");
}

static void numbers_are_told_for_every_type(void **state)
{
    (void)state;
    const box b = defaults();
    static const double expected[] = {2.385, 0.5, 0, 7, -1, 1, 1, 5};
    for (size_t i = 0; i < SSFR_COUNT(expected); i++) assert_true(ssfr_param_number(&rows[i], &b) == expected[i]);
}

static void numbers_have_decimal_points_in_every_locale(void **state)
{
    (void)state;
    double value = 0;
    char text[64];
    const ssfr_param row = {"x", SSFR_REAL, "m", "", 0, 0, -10, 10, NULL};
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8")) skip();
    const ssfr_result result = ssfr_param_set(&row, &value, "x", "2.385");
    ssfr_param_format(&row, &value, text, sizeof text);
    setlocale(LC_NUMERIC, "C");
    assert_int_equal(result, SSFR_OK);
    assert_true(value == 2.385);
    assert_string_equal(text, "2.385");
}

static void structs_are_held_to_their_rows(void **state)
{
    (void)state;
    box b = defaults();
    assert_int_equal(ssfr_params_check(rows, &b, "box"), SSFR_OK);
    b.ratio = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_params_check(rows, &b, "box"), "box.ratio=nan: out of range [0, 1]");
    b = defaults(), b.steps = -4;
    assert_fails(SSFR_ERR_VALUE, ssfr_params_check(rows, &b, "box"), "box.steps=-4");
    b = defaults(), b.thin = 2;
    assert_fails(SSFR_ERR_VALUE, ssfr_params_check(rows, &b, "box"), "box.thin=2: out of range [0, 1]");
    b = defaults(), b.colour = 3;
    assert_fails(SSFR_ERR_VALUE, ssfr_params_check(rows, &b, "box"), "box.colour=3: out of range [0, 2]");
    b = defaults(), b.colour = -1;
    assert_fails(SSFR_ERR_VALUE, ssfr_params_check(rows, &b, "box"), "box.colour=-1");
    b = defaults(), b.errata = 7;
    assert_int_equal(ssfr_params_check(rows, &b, "box"), SSFR_OK);
    b.errata = 8;
    assert_fails(SSFR_ERR_VALUE, ssfr_params_check(rows, &b, "box"), "box.errata=8");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_have_decimal_points_in_every_locale),
        cmocka_unit_test(defaults_fill_the_members_and_nothing_else),
        cmocka_unit_test(rows_are_found_by_their_whole_name),
        cmocka_unit_test(values_of_every_type_are_parsed),
        cmocka_unit_test(flags_have_four_spellings),
        cmocka_unit_test(what_is_no_finite_number_is_refused),
        cmocka_unit_test(whole_numbers_have_no_fraction),
        cmocka_unit_test(values_out_of_range_name_range_and_unit),
        cmocka_unit_test(unknown_words_are_answered_with_the_known_ones),
        cmocka_unit_test(sets_are_lists_or_none),
        cmocka_unit_test(errors_stay_on_one_line),
        cmocka_unit_test(reals_come_back_to_the_last_bit),
        cmocka_unit_test(text_is_as_short_as_it_can_be),
        cmocka_unit_test(numbers_are_told_for_every_type),
        cmocka_unit_test(structs_are_held_to_their_rows),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

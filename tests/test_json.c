/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_json.c: JSON as it is written: nesting, escapes, numbers. */
#include "tests/util.h"

#include "experiments/json.h"

static ssfr_json json;
static const char *path;

static int begin(void **state)
{
    (void)state;
    path = test_path("out.json");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    ssfr_json_init(&json, file);
    return 0;
}

static void assert_written(const char *expected)
{
    char *text = NULL;
    size_t size = 0;
    assert_int_equal(fclose(json.file), 0);
    assert_int_equal(ssfr_read_file(path, 1 << 16, &text, &size), SSFR_OK);
    assert_string_equal(text, expected);
    free(text);
}

static void nested_values_are_separated_by_commas(void **state)
{
    (void)state;
    ssfr_json_object(&json, NULL);
    ssfr_json_integer(&json, "n", -12);
    ssfr_json_array(&json, "list");
    ssfr_json_flag(&json, NULL, true);
    ssfr_json_object(&json, NULL);
    ssfr_json_close(&json);
    ssfr_json_text(&json, NULL, NULL);
    ssfr_json_close(&json);
    ssfr_json_array(&json, "none");
    ssfr_json_close(&json);
    ssfr_json_flag(&json, "last", false);
    ssfr_json_close(&json);
    assert_written("{\n  \"n\": -12,\n  \"list\": [\n    true,\n    {},\n    null\n  ],"
                   "\n  \"none\": [],\n  \"last\": false\n}\n");
}

static void strings_are_escaped(void **state)
{
    (void)state;
    ssfr_json_object(&json, NULL);
    ssfr_json_text(&json, "a \"key\"", "C:\\x\n\ty\x01\x7f");
    ssfr_json_close(&json);
    assert_written("{\n  \"a \\\"key\\\"\": \"C:\\\\x\\n\\ty\\u0001\\u007f\"\n}\n");
}

static void utf8_stays_and_other_bytes_are_replaced(void **state)
{
    (void)state;
    ssfr_json_array(&json, NULL);
    ssfr_json_text(&json, NULL, "\xc3\xbc \xe2\x82\xac \xf0\x9f\x8c\x8a"); /* 2, 3 and 4 bytes */
    ssfr_json_text(&json, NULL, "caf\xe9");                                /* Latin-1 */
    ssfr_json_text(&json, NULL, "\xc0\xaf");                               /* an overlong slash */
    ssfr_json_text(&json, NULL, "\xed\xa0\x80");                           /* a surrogate */
    ssfr_json_text(&json, NULL, "\xf4\x90\x80\x80");                       /* past U+10FFFF */
    ssfr_json_text(&json, NULL, "\xe2\x82");                               /* torn */
    ssfr_json_close(&json);
    assert_written("[\n  \"\xc3\xbc \xe2\x82\xac \xf0\x9f\x8c\x8a\",\n  \"caf\\ufffd\",\n  \"\\ufffd\\ufffd\",\n"
                   "  \"\\ufffd\\ufffd\\ufffd\",\n  \"\\ufffd\\ufffd\\ufffd\\ufffd\",\n  \"\\ufffd\\ufffd\"\n]\n");
}

static void numbers_read_back_exactly_and_nonfinite_ones_are_null(void **state)
{
    (void)state;
    const double third = 1.0 / 3;
    ssfr_json_array(&json, NULL);
    ssfr_json_number(&json, NULL, 2.385);
    ssfr_json_number(&json, NULL, third);
    ssfr_json_number(&json, NULL, -1e30);
    ssfr_json_number(&json, NULL, 5e-324);
    ssfr_json_number(&json, NULL, NAN);
    ssfr_json_number(&json, NULL, -INFINITY);
    ssfr_json_integer(&json, NULL, 9007199254740993);
    ssfr_json_close(&json);
    assert_written("[\n  2.385,\n  0.3333333333333333,\n  -1e+30,\n  4.94066e-324,"
                   "\n  null,\n  null,\n  9007199254740993\n]\n");
}

static void a_lone_value_is_a_document(void **state)
{
    (void)state;
    ssfr_json_number(&json, NULL, 0.5);
    assert_written("0.5");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(nested_values_are_separated_by_commas, begin),
        cmocka_unit_test_setup(strings_are_escaped, begin),
        cmocka_unit_test_setup(utf8_stays_and_other_bytes_are_replaced, begin),
        cmocka_unit_test_setup(numbers_read_back_exactly_and_nonfinite_ones_are_null, begin),
        cmocka_unit_test_setup(a_lone_value_is_a_document, begin),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

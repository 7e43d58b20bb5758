/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_options.c: the command line's rows: every kind of value, every error, --help. */
#include "tests/util.h"

#include "experiments/options.h"

typedef struct values {
    bool flag;
    const char *text;
    double number, any;
    long integer;
    double vector[3];
    int size[2];
    int word;
    ssfr_list list;
} values;

#define ROW(...) SSFR_OPTION(values, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(flag, "keep-all", 'k', FLAG, NULL, "a flag", 0, 0),
    ROW(text, "output", 'o', TEXT, "FILE", "a text", 0, 0),
    ROW(number, "radius", 0, NUMBER, "M", "a number with a range", 0.5, 4),
    ROW(any, "any", 0, NUMBER, "X", "a number without a range", 0, 0),
    SSFR_OPTION_END,
};
static const ssfr_option more_rows[] = {
    ROW(integer, "every", 'n', INTEGER, "N", "a whole number", -7, 40),
    ROW(vector, "eye", 0, VECTOR, "X,Y,Z", "a vector", 0, 0),
    ROW(size, "size", 0, SIZE, "WxH", "a size", 0, 0),
    ROW(word, "backend", 0, WORD, "gl|cpu|both", "one of some words", 0, 0),
    ROW(list, "set", 's', LIST, "KEY=VALUE",
        "what can be repeated, with a help text that is so long that it does not fit into a single line of a terminal",
        0, 0),
    SSFR_OPTION_END,
};

static values got;
static ssfr_command_line line;

static const ssfr_option_set sets[] = {
    {"first", rows, &got},
    {"second", more_rows, &got},
    {NULL, NULL, NULL},
};
static const ssfr_usage usage = {.command = "render", .arguments = "SCENE [IMAGE]", .help = "draw a scene",
                                 .min_arguments = 1, .max_arguments = 2, .sets = sets};

/* The words of a command line up to NULL, after the command and the argument that it needs. */
#define parse(...) parse_words((char *[]){"render", "block", __VA_ARGS__, NULL})

static ssfr_result parse_words(char **argv)
{
    int argc = 0;
    while (argv[argc]) argc++;
    got = (values){.number = 2.385, .word = 1};
    return ssfr_options_parse(&line, &usage, argc, argv);
}

static void each_kind_of_value_is_read(void **state)
{
    (void)state;
    assert_int_equal(parse("--keep-all", "--output", "a.exr", "--radius", "3.25", "--every", "-7", "--eye",
                           "-1.5,2e3,0", "--size", "1279x719", "--backend", "both"),
                     SSFR_OK);
    assert_true(got.flag);
    assert_string_equal(got.text, "a.exr");
    assert_close(got.number, 3.25, 0, 0);
    assert_int_equal(got.integer, -7);
    assert_close(got.vector[0], -1.5, 0, 0);
    assert_close(got.vector[1], 2000, 0, 0);
    assert_close(got.vector[2], 0, 0, 0);
    assert_int_equal(got.size[0], 1279);
    assert_int_equal(got.size[1], 719);
    assert_int_equal(got.word, 2);
}

static void what_is_not_given_keeps_its_default(void **state)
{
    (void)state;
    assert_int_equal(parse("--keep-all"), SSFR_OK);
    assert_close(got.number, 2.385, 0, 0);
    assert_int_equal(got.word, 1);
    assert_null(got.text);
    assert_int_equal(line.seed, 1);
    assert_int_equal(line.threads, 0);
    assert_false(line.quiet || line.verbose || line.help);
}

static void a_value_may_stand_in_the_same_word(void **state)
{
    (void)state;
    assert_int_equal(parse("--output=a=b.exr", "-n12", "--eye=1,2,3"), SSFR_OK);
    assert_string_equal(got.text, "a=b.exr");
    assert_int_equal(got.integer, 12);
    assert_close(got.vector[2], 3, 0, 0);
    assert_int_equal(parse("--output=", "-o", "-"), SSFR_OK);
    assert_string_equal(got.text, "-");
}

static void a_repeated_option_counts_last_and_a_list_adds_up(void **state)
{
    (void)state;
    assert_int_equal(parse("--any", "1", "--set", "a.b=1", "--any", "-2e-300", "-s", "c=2", "-sd=3"), SSFR_OK);
    assert_close(got.any, -2e-300, 0, 0);
    assert_int_equal(got.list.n, 3);
    assert_string_equal(got.list.items[0], "a.b=1");
    assert_string_equal(got.list.items[1], "c=2");
    assert_string_equal(got.list.items[2], "d=3");
}

static void arguments_stand_anywhere_and_two_dashes_end_the_options(void **state)
{
    (void)state;
    assert_int_equal(parse("-k", "--", "--size"), SSFR_OK);
    assert_true(got.flag);
    assert_int_equal(line.arguments.n, 2);
    assert_string_equal(line.arguments.items[0], "block");
    assert_string_equal(line.arguments.items[1], "--size");
    assert_int_equal(parse("-"), SSFR_OK);
    assert_string_equal(line.arguments.items[1], "-");
}

static void every_command_has_the_common_options(void **state)
{
    (void)state;
    static const ssfr_usage bare = {.command = "info", .arguments = "", .help = "versions"};
    char *argv[] = {"info", "--seed", "77", "-q", "--verbose", NULL};
    assert_int_equal(ssfr_options_parse(&line, &bare, 5, argv), SSFR_OK);
    assert_int_equal(line.seed, 77);
    assert_true(line.quiet && line.verbose);
    assert_fails(SSFR_ERR_VALUE, parse("--threads", "0"), "--threads 0: out of range [1, 1024]");
    assert_fails(SSFR_ERR_VALUE, parse("--seed", "-1"), "--seed -1: out of range");
}

static void threads_are_put_into_effect(void **state)
{
    (void)state;
    assert_int_equal(parse("--threads", "3"), SSFR_OK);
    assert_int_equal(line.threads, 3);
    assert_string_equal(getenv("LP_NUM_THREADS"), "3");
}

static void what_was_put_into_effect_can_be_taken_back(void **state)
{
    (void)state;
    for (int set = 0; set < 2; set++) {
        if (set)
            setenv("LP_NUM_THREADS", "5", 1);
        else
            unsetenv("LP_NUM_THREADS");
        const ssfr_manner before = ssfr_options_manner();
        assert_int_equal(parse("--threads", "3", "--quiet"), SSFR_OK);
        assert_int_equal(ssfr_options_manner().threads, 3);
        assert_int_equal(ssfr_options_manner().level, SSFR_ERROR);
        assert_int_equal(parse("x"), SSFR_OK); /* says nothing of these, so they stay */
        assert_int_equal(ssfr_options_manner().level, SSFR_ERROR);
        ssfr_options_resume(&before);
        assert_int_equal(ssfr_options_manner().threads, before.threads);
        assert_int_equal(ssfr_options_manner().level, before.level);
        assert_string_equal(getenv("LP_NUM_THREADS") ? getenv("LP_NUM_THREADS") : "none", set ? "5" : "none");
    }
    unsetenv("LP_NUM_THREADS");
}

static void unknown_options_are_named(void **state)
{
    (void)state;
    assert_fails(SSFR_ERR_UNKNOWN, parse("--colour", "red"), "unknown option --colour (ssfr render --help");
    assert_fails(SSFR_ERR_UNKNOWN, parse("--siz=3x3"), "unknown option --siz=3x3");
    assert_fails(SSFR_ERR_UNKNOWN, parse("-z"), "unknown option -z");
    assert_fails(SSFR_ERR_UNKNOWN, parse("--=1"), "unknown option --=1");
}

static void missing_and_needless_values_are_refused(void **state)
{
    (void)state;
    assert_fails(SSFR_ERR_VALUE, parse("--output"), "--output needs a value: FILE");
    assert_fails(SSFR_ERR_VALUE, parse("-s"), "-s needs a value: KEY=VALUE");
    assert_fails(SSFR_ERR_VALUE, parse("--keep-all=yes"), "--keep-all takes no value, got yes");
    assert_fails(SSFR_ERR_VALUE, parse("-kx"), "-k takes no value, got x");
}

static void malformed_numbers_are_refused(void **state)
{
    (void)state;
    assert_fails(SSFR_ERR_VALUE, parse("--radius", "2.385m"), "--radius 2.385m: expected a finite number");
    assert_fails(SSFR_ERR_VALUE, parse("--any", "nan"), "--any nan: expected a finite number");
    assert_fails(SSFR_ERR_VALUE, parse("--any=inf"), "--any inf: expected a finite number");
    assert_fails(SSFR_ERR_VALUE, parse("--any="), "--any : expected a finite number");
    assert_fails(SSFR_ERR_VALUE, parse("--radius", "4.0001"), "--radius 4.0001: out of range [0.5, 4]");
    assert_fails(SSFR_ERR_VALUE, parse("--radius=0.4999"), "out of range");
    assert_fails(SSFR_ERR_VALUE, parse("-n", "1.5"), "-n 1.5: expected a whole number");
    assert_fails(SSFR_ERR_VALUE, parse("-n", "99999999999999999999"), "expected a whole number");
    assert_fails(SSFR_ERR_VALUE, parse("--every", "41"), "--every 41: out of range [-7, 40]");
}

static void malformed_vectors_sizes_and_words_are_refused(void **state)
{
    (void)state;
    assert_fails(SSFR_ERR_VALUE, parse("--eye", "1,2"), "--eye 1,2: expected three numbers");
    assert_fails(SSFR_ERR_VALUE, parse("--eye", "1,,2"), "expected three numbers");
    assert_fails(SSFR_ERR_VALUE, parse("--eye", "1,2,3,4"), "--eye 1,2,3,4: more than three numbers");
    assert_fails(SSFR_ERR_VALUE, parse("--eye", "1,2,inf"), "expected three numbers");
    assert_fails(SSFR_ERR_VALUE,
                 parse("--eye", "1,2,3000000000000000000000000000000000000000000000000000000000000000000000000"),
                 "expected three numbers");
    assert_fails(SSFR_ERR_VALUE, parse("--size", "1280"), "--size 1280: expected a size in pixels, such as 1280x720");
    assert_fails(SSFR_ERR_VALUE, parse("--size", "1280x720x3"), "expected a size");
    assert_fails(SSFR_ERR_VALUE, parse("--size", "12.5x720"), "expected a size");
    assert_fails(SSFR_ERR_VALUE, parse("--size", "0x720"), "--size 0x720: sides go from 1 to 16384");
    assert_fails(SSFR_ERR_VALUE, parse("--size", "1280x16385"), "sides go from 1 to 16384");
    assert_fails(SSFR_ERR_VALUE, parse("--backend", "vulkan"), "--backend vulkan: expected gl|cpu|both");
    assert_fails(SSFR_ERR_VALUE, parse("--backend", "g"), "expected gl|cpu|both");
}

static void a_wrong_number_of_arguments_is_refused(void **state)
{
    (void)state;
    char *none[] = {"render", "-k", NULL};
    assert_fails(SSFR_ERR_VALUE, parse_words(none), "too few arguments: usage: ssfr render SCENE [IMAGE]");
    assert_fails(SSFR_ERR_VALUE, parse("b", "c"), "one argument too many: c (usage: ssfr render SCENE [IMAGE])");
}

static void a_list_that_is_too_long_is_refused(void **state)
{
    static char *argv[2 + SSFR_MAX_LIST + 2];
    (void)state;
    argv[0] = "render", argv[1] = "block";
    for (int i = 0; i <= SSFR_MAX_LIST; i++) argv[2 + i] = "-sa=1";
    assert_fails(SSFR_ERR_VALUE, parse_words(argv), "-s a=1: more than 256 of them");
}

static void words_are_told_by_number(void **state)
{
    (void)state;
    char word[8];
    const ssfr_option *backend = &more_rows[3];
    assert_true(ssfr_option_word(backend, 0, word, sizeof word));
    assert_string_equal(word, "gl");
    assert_true(ssfr_option_word(backend, 2, word, sizeof word));
    assert_string_equal(word, "both");
    assert_false(ssfr_option_word(backend, 3, word, sizeof word));
}

static char *help_text(void)
{
    char *text = NULL;
    size_t size = 0;
    const char *path = test_path("help.txt");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    ssfr_options_print(file, &usage);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(ssfr_read_file(path, 1 << 16, &text, &size), SSFR_OK);
    return text;
}

static void help_shows_every_row_in_lines_that_fit(void **state)
{
    (void)state;
    char *text = help_text();
    assert_non_null(strstr(text, "usage: ssfr render SCENE [IMAGE] [options]\n"));
    assert_non_null(strstr(text, "\nfirst:\n"));
    for (const ssfr_option *row = rows; row->name; row++) assert_non_null(strstr(text, row->name));
    for (const ssfr_option *row = more_rows; row->name; row++) assert_non_null(strstr(text, row->name));
    assert_non_null(strstr(text, "  -o, --output FILE"));
    assert_non_null(strstr(text, "--threads N"));
    for (const char *at = text; *at; at += strcspn(at, "\n") + 1) assert_true(strcspn(at, "\n") <= 100);
    free(text);
}

static void help_is_printed_without_the_arguments(void **state)
{
    (void)state;
    char *argv[] = {"render", "--help", NULL};
    fflush(stdout);
    assert_int_equal(parse_words(argv), SSFR_OK);
    assert_true(line.help);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_kind_of_value_is_read),
        cmocka_unit_test(what_is_not_given_keeps_its_default),
        cmocka_unit_test(a_value_may_stand_in_the_same_word),
        cmocka_unit_test(a_repeated_option_counts_last_and_a_list_adds_up),
        cmocka_unit_test(arguments_stand_anywhere_and_two_dashes_end_the_options),
        cmocka_unit_test(every_command_has_the_common_options),
        cmocka_unit_test(threads_are_put_into_effect),
        cmocka_unit_test(what_was_put_into_effect_can_be_taken_back),
        cmocka_unit_test(unknown_options_are_named),
        cmocka_unit_test(missing_and_needless_values_are_refused),
        cmocka_unit_test(malformed_numbers_are_refused),
        cmocka_unit_test(malformed_vectors_sizes_and_words_are_refused),
        cmocka_unit_test(a_wrong_number_of_arguments_is_refused),
        cmocka_unit_test(a_list_that_is_too_long_is_refused),
        cmocka_unit_test(words_are_told_by_number),
        cmocka_unit_test(help_shows_every_row_in_lines_that_fit),
        cmocka_unit_test(help_is_printed_without_the_arguments),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

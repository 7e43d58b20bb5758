/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_recipe.c: items of papers that are other commands: what is malformed is refused with file, line and column. */
#include "experiments/recipe.h"
#include "tests/util.h"

static ssfr_result parse(ssfr_recipe **out, const char *text)
{
    return ssfr_recipe_parse(out, "item.yaml", text, strlen(text));
}

static void a_command_is_words_and_its_table_may_have_published_numbers(void **state)
{
    (void)state;
    ssfr_recipe *r = NULL;
    assert_int_equal(parse(&r, "title: T\ncommand: [bench, bagar2010, --size, 64x48]\n"
                               "published: {file: a.csv, on: [node], column: ms}\n"
                               "quick: {title: Q, command: [bench]}\n"),
                     SSFR_OK);
    assert_string_equal(r->title, "T");
    assert_false(r->pictures);
    assert_int_equal(r->steps.n, 1);
    assert_int_equal(r->steps.items[0].n, 4);
    assert_string_equal(r->steps.items[0].words[3], "64x48");
    assert_string_equal(r->steps.items[0].name, "");
    assert_string_equal(r->published.file, "a.csv");
    ssfr_recipe_quicken(r);
    assert_string_equal(r->title, "Q");
    assert_int_equal(r->steps.n, 1);
    assert_int_equal(r->steps.items[0].n, 1);
    ssfr_recipe_quicken(r); /* nothing is left to be replaced by */
    assert_int_equal(r->steps.n, 1);
    ssfr_recipe_destroy(&r);
    assert_null(r);
    ssfr_recipe_destroy(&r);
}

static void pictures_are_renderings_with_names(void **state)
{
    (void)state;
    ssfr_recipe *r = NULL;
    assert_int_equal(parse(&r, "pictures:\n  - {name: foam_1, args: [block, -p, bagar2010]}\n"
                               "  - {name: B, args: [block]}\nquick: {title: Q}\n"),
                     SSFR_OK);
    assert_true(r->pictures);
    assert_int_equal(r->steps.n, 2);
    assert_string_equal(r->steps.items[0].name, "foam_1");
    assert_string_equal(r->steps.items[0].words[0], "render");
    assert_string_equal(r->steps.items[0].words[3], "bagar2010");
    assert_int_equal(r->steps.items[1].n, 2);
    assert_null(r->title);
    ssfr_recipe_quicken(r);
    assert_string_equal(r->title, "Q");
    assert_int_equal(r->steps.n, 2);
    ssfr_recipe_destroy(&r);
}

/* words of a step, a space before each */
static void assert_words(const ssfr_recipe *r, size_t i, const char *expected)
{
    char text[256] = "";
    for (int k = 0; k < r->steps.items[i].n; k++)
        snprintf(text + strlen(text), sizeof text - strlen(text), " %s", r->steps.items[i].words[k]);
    assert_string_equal(text, expected);
}

static void all_steps_share_words_and_quick_has_others_in_their_place(void **state)
{
    (void)state;
    ssfr_recipe *r = NULL;
    assert_int_equal(parse(&r, "args: [--size, 9x8]\npictures: [{name: a, args: [b]}, {name: c, args: [d]}]\n"
                               "quick: {args: [-q]}\n"),
                     SSFR_OK);
    assert_words(r, 0, " render b --size 9x8");
    assert_words(r, 1, " render d --size 9x8");
    ssfr_recipe_quicken(r);
    assert_words(r, 0, " render b -q");
    assert_words(r, 1, " render d -q");
    assert_string_equal(r->steps.items[1].name, "c");
    ssfr_recipe_destroy(&r);
    assert_int_equal(parse(&r, "{command: [bench, flow], args: [a], quick: {command: [bench]}}"), SSFR_OK);
    assert_words(r, 0, " bench flow a");
    ssfr_recipe_quicken(r);
    assert_words(r, 0, " bench a");
    ssfr_recipe_destroy(&r);
    assert_int_equal(parse(&r, "{command: [bench, flow], quick: {args: [b]}}"), SSFR_OK);
    ssfr_recipe_quicken(r);
    assert_words(r, 0, " bench flow b");
    ssfr_recipe_destroy(&r);
}

static void a_sweep_is_no_recipe(void **state)
{
    (void)state;
    static const char *const texts[] = {"vary: {a.b: 1}", "title: x", "- a", "just words"};
    for (size_t i = 0; i < SSFR_COUNT(texts); i++) {
        ssfr_recipe *r = NULL;
        assert_int_equal(parse(&r, texts[i]), SSFR_OK);
        assert_null(r);
    }
}

static void malformed_recipes_are_refused_with_their_place(void **state)
{
    (void)state;
    static const struct {
        ssfr_result code;
        const char *text, *message;
    } cases[] = {
        {SSFR_ERR_FORMAT, "", "item.yaml:1:1: an empty file"},
        {SSFR_ERR_FORMAT, "command: [a\n", "item.yaml:2:1: did not find expected"},
        {SSFR_ERR_FORMAT, "command: bench\n", "item.yaml:1:10: command: expected a list"},
        {SSFR_ERR_FORMAT, "command: []\n", "item.yaml:1:10: command: expected 1 to 256 words"},
        {SSFR_ERR_FORMAT, "command: [bench, [a]]\n", "item.yaml:1:18: command: expected one value"},
        {SSFR_ERR_UNKNOWN, "command: [bunch]\n", "item.yaml:1:11: command: bunch: there is no such command"},
        {SSFR_ERR_UNKNOWN, "command: [reproduce]\n",
         "item.yaml:1:11: command: reproduce: a sweep is an item by itself"},
        {SSFR_ERR_UNKNOWN, "command: [sweep]\n", "item.yaml:1:11: command: sweep: a sweep is an item by itself"},
        {SSFR_ERR_VALUE, "command: [bench, -o, a.csv]\n", "item.yaml:1:18: command: -o: where it goes"},
        {SSFR_ERR_VALUE, "command: [bench, -oa.csv]\n", "item.yaml:1:18: command: -oa.csv: where it goes"},
        {SSFR_ERR_VALUE, "command: [bench, --output=a]\n", "item.yaml:1:18: command: --output=a: where it goes"},
        {SSFR_ERR_FORMAT, "command: [bench]\nvary: {}\n",
         "item.yaml:2:1: no key vary: a reproduction has title, command"},
        {SSFR_ERR_FORMAT, "command: [bench]\npictures: [{name: a, args: [b]}]\n",
         "item.yaml:2:1: command and pictures: an item has one of the two"},
        {SSFR_ERR_FORMAT, "command: [bench]\nquick: {pictures: [{name: a, args: [b]}]}\n",
         "item.yaml:2:1: quick: an item is a command or pictures at both scales"},
        {SSFR_ERR_FORMAT, "command: [bench]\npublished: {file: a}\n", "item.yaml:2:1: published: on must be given"},
        {SSFR_ERR_FORMAT, "command: [bench]\nargs: []\n", "item.yaml:2:7: args: expected 1 to 256 words"},
        {SSFR_ERR_FORMAT, "command: [bench]\nargs: a\n", "item.yaml:2:7: args: expected a list"},
        {SSFR_ERR_VALUE, "command: [bench]\nquick: {args: [-o, a]}\n", "item.yaml:2:16: args: -o: where it goes"},
        {SSFR_ERR_FORMAT, "pictures: a\n", "item.yaml:1:11: pictures: expected a list"},
        {SSFR_ERR_FORMAT, "pictures: []\n", "item.yaml:1:11: pictures: expected 1 to 256 pictures"},
        {SSFR_ERR_FORMAT, "pictures: [a]\n", "item.yaml:1:12: pictures: expected a map"},
        {SSFR_ERR_FORMAT, "pictures: [{name: a}]\n", "item.yaml:1:12: pictures: args must be given"},
        {SSFR_ERR_FORMAT, "pictures: [{args: [a]}]\n", "item.yaml:1:12: pictures: name must be given"},
        {SSFR_ERR_FORMAT, "pictures: [{name: a, args: []}]\n", "item.yaml:1:28: args: expected 1 to 256 words"},
        {SSFR_ERR_VALUE, "pictures: [{name: a/b, args: [c]}]\n", "item.yaml:1:12: name: a/b: expected letters, digits"},
        {SSFR_ERR_VALUE, "pictures: [{name: \"\", args: [c]}]\n", "item.yaml:1:12: name: : expected letters, digits"},
        {SSFR_ERR_VALUE, "pictures: [{name: a, args: [c]}, {name: a, args: [d]}]\n",
         "item.yaml:1:34: the name a stands twice"},
        {SSFR_ERR_FORMAT, "pictures: [{name: a, args: [c]}]\npublished: {file: a, on: [b], column: c}\n",
         "item.yaml:2:1: published: beside pictures"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_recipe *r = NULL;
        assert_fails(cases[i].code, parse(&r, cases[i].text), cases[i].message);
        assert_null(r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_command_is_words_and_its_table_may_have_published_numbers),
        cmocka_unit_test(pictures_are_renderings_with_names),
        cmocka_unit_test(all_steps_share_words_and_quick_has_others_in_their_place),
        cmocka_unit_test(a_sweep_is_no_recipe),
        cmocka_unit_test(malformed_recipes_are_refused_with_their_place),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

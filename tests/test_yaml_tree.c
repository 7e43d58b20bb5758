/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_yaml_tree.c: trees keep what a document says and where; rows read maps; every error tells its place. */
#include "experiments/yaml_tree.h"
#include "base/param.h"
#include "tests/util.h"

static ssfr_result parse(ssfr_yaml **tree, const char *text)
{
    return ssfr_yaml_parse(tree, "a.yaml", "thing", text, strlen(text));
}

static ssfr_yaml *tree_of(const char *text)
{
    ssfr_yaml *tree = NULL;
    assert_int_equal(parse(&tree, text), SSFR_OK);
    return tree;
}

/* ---- the tree ---------------------------------------------------------------------------------------------------- */

static void a_tree_keeps_order_texts_and_places(void **state)
{
    (void)state;
    char place[SSFR_YAML_PLACE];
    ssfr_yaml *tree = tree_of("b: 2.385\na: [x, 'y z', \"\\u00e9\"]\nc:\n  d: {}\n");
    const ssfr_yaml_node *root = ssfr_yaml_root(tree);
    assert_int_equal(root->kind, SSFR_YAML_MAP);
    assert_int_equal(root->n, 3);
    assert_string_equal(root->keys[0]->text, "b");
    assert_string_equal(root->values[0]->text, "2.385");
    assert_ptr_equal(root->values[0]->key, root->keys[0]);
    const ssfr_yaml_node *list = root->values[1];
    assert_int_equal(list->kind, SSFR_YAML_LIST);
    assert_int_equal(list->n, 3);
    assert_string_equal(list->values[1]->text, "y z");
    assert_string_equal(list->values[2]->text, "\u00e9");
    assert_string_equal(list->values[2]->name, "a");
    assert_null(list->values[2]->key);
    assert_string_equal(ssfr_yaml_place(list->values[1], place), "a.yaml:2:8");
    assert_string_equal(ssfr_yaml_place(ssfr_yaml_head(list), place), "a.yaml:2:1");
    assert_ptr_equal(ssfr_yaml_head(list->values[1]), list->values[1]);
    const ssfr_yaml_node *d = ssfr_yaml_find(ssfr_yaml_find(root, "c"), "d");
    assert_int_equal(d->kind, SSFR_YAML_MAP);
    assert_int_equal(d->n, 0);
    assert_string_equal(ssfr_yaml_place(d, place), "a.yaml:4:6");
    assert_null(ssfr_yaml_find(root, "d"));
    ssfr_yaml_destroy(&tree);
    assert_null(tree);
    ssfr_yaml_destroy(&tree);
}

static void line_ends_of_any_kind_and_a_byte_order_mark_are_taken(void **state)
{
    (void)state;
    ssfr_yaml *tree = tree_of("\xef\xbb\xbf" "a: 1\r\nb: 2\r\n");
    const ssfr_yaml_node *root = ssfr_yaml_root(tree);
    assert_int_equal(root->n, 2);
    assert_string_equal(root->keys[0]->text, "a");
    assert_string_equal(root->values[1]->text, "2");
    assert_int_equal(root->values[1]->line, 2);
    ssfr_yaml_destroy(&tree);
}

static void an_alias_has_its_anchors_content_and_its_own_name_and_place(void **state)
{
    (void)state;
    ssfr_yaml *tree = tree_of("a: &x {k: 2.385}\nb: *x\nc: &x [1]\nd: *x\n");
    const ssfr_yaml_node *root = ssfr_yaml_root(tree), *b = ssfr_yaml_find(root, "b");
    assert_int_equal(b->kind, SSFR_YAML_MAP);
    assert_string_equal(ssfr_yaml_find(b, "k")->text, "2.385");
    assert_string_equal(b->name, "b");
    assert_int_equal(b->line, 2);
    assert_int_equal(b->column, 4);
    assert_int_equal(ssfr_yaml_find(root, "d")->kind, SSFR_YAML_LIST); /* the last anchor of a name */
    ssfr_yaml_destroy(&tree);
}

static void an_alias_may_stand_in_what_it_stands_for(void **state)
{
    (void)state;
    ssfr_yaml *tree = tree_of("a: &x [1, *x]\n");
    const ssfr_yaml_node *a = ssfr_yaml_root(tree)->values[0];
    assert_int_equal(a->n, 2);
    assert_int_equal(a->values[1]->kind, SSFR_YAML_LIST);
    assert_ptr_equal(a->values[1]->values, a->values);
    ssfr_yaml_destroy(&tree);
}

static void malformed_documents_are_refused_with_their_place(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "a.yaml:1:1: an empty file"},
        {"# nothing\n", "a.yaml:1:1: an empty file"},
        {"a: 1\na: 2\n", "a.yaml:2:1: a stands twice"},
        {"b: {c: 1, d: 2, c: 3}\n", "a.yaml:1:17: c stands twice"},
        {"b:\n  [1]: 2\n", "a.yaml:2:3: b: expected one value as a key"},
        {"b:\n  {x: 1}: 2\n", "a.yaml:2:3: b: expected one value as a key"},
        {"b: &x 1\nc:\n  *x : 2\n", "a.yaml:3:3: c: expected one value as a key"},
        {"a: *x\n", "a.yaml:1:4: found undefined alias *x"},
        {"a: \"b\\0c\"\n", "a.yaml:1:4: a: a zero byte in the value"},
        {"\"b\\0c\": 1\n", "a.yaml:1:1: the thing: a zero byte in the value"},
        {"a: 1\n---\nb: 2\n", "a.yaml:3:1: a second document, a thing has one"},
        {"a: 1\n...\n---\n", "a.yaml:4:1: a second document"},
        {"a: [1\n", "a.yaml:2:1: did not find expected ',' or ']'"},
        {"a: {b: 1\n", "a.yaml:2:1: did not find expected ',' or '}'"},
        {"a: 1\n\tb: 2\n", "a.yaml:2:1: found a tab character"},
        {"a: 'x\n", "a.yaml:2:1: found unexpected end of stream"},
        {"a: 1\nb: \xff\n", "a.yaml:2:4: byte 8: invalid leading UTF-8 octet"},
        {"a: \x01\n", "a.yaml:1:4: byte 3: control characters are not allowed"},
        {"%YAML 7.3\n---\na: 1\n", "a.yaml:1:1: found incompatible YAML document"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_yaml *tree = NULL;
        assert_fails(SSFR_ERR_FORMAT, parse(&tree, cases[i].text), cases[i].message);
        assert_null(tree);
    }
}

static void zero_bytes_and_other_encodings_are_refused(void **state)
{
    (void)state;
    static const char zero[] = "a: 1\0b: 2\n", wide[] = "\xff\xfe" "a\0:\0 \0001\0\n\0";
    ssfr_yaml *tree = NULL;
    assert_fails(SSFR_ERR_FORMAT, ssfr_yaml_parse(&tree, "a.yaml", "thing", zero, sizeof zero - 1),
                 "a.yaml:1:5: byte 4: control characters");
    assert_fails(SSFR_ERR_FORMAT, ssfr_yaml_parse(&tree, "a.yaml", "thing", wide, sizeof wide - 1),
                 "a.yaml:1:1: byte 0: invalid leading UTF-8 octet");
}

/* n times a text, between others; to free(). */
static char *repeat(const char *before, const char *text, int n, const char *after)
{
    char *out = NULL;
    const size_t length = strlen(text);
    assert_int_equal(ssfr_alloc(&out, strlen(before) + (size_t)n * length + strlen(after) + 1, 1, "a text"), SSFR_OK);
    strcpy(out, before);
    char *at = out + strlen(before);
    for (int i = 0; i < n; i++, at += length) memcpy(at, text, length);
    strcpy(at, after);
    return out;
}

static void assert_repeated_fails(ssfr_result code, const char *before, const char *text, int n, const char *message)
{
    ssfr_yaml *tree = NULL;
    char *all = repeat(before, text, n, "");
    assert_fails(code, parse(&tree, all), message);
    free(all);
}

static void documents_beyond_all_measure_are_refused(void **state)
{
    (void)state;
    assert_repeated_fails(SSFR_ERR_FORMAT, "a: ", "[", 1 << 20 >> 1, "lists and maps in each other more than 32 deep");
    assert_repeated_fails(SSFR_ERR_FORMAT, "a: ", "{b: ", 1 << 17, "lists and maps in each other more than 32 deep");
    assert_repeated_fails(SSFR_ERR_FORMAT, "", "- ", 1 << 18, "lists and maps in each other more than 32 deep");
    assert_repeated_fails(SSFR_ERR_FORMAT, "a: [", "1,", 1 << 18, "more than 262144 values");
    assert_repeated_fails(SSFR_ERR_FORMAT, "", "- &a 1\n", 101, "a.yaml:101:3: more than 100 anchors");
    assert_repeated_fails(SSFR_ERR_VALUE, "", "# what\n", 1 << 18, "1835008 bytes, a thing has at most 1048576");
}

static void a_map_of_too_many_keys_is_refused(void **state)
{
    (void)state;
    char *text = NULL;
    size_t used = 0;
    ssfr_yaml *tree = NULL;
    assert_int_equal(ssfr_alloc(&text, 20000, 1, "a text"), SSFR_OK);
    for (int i = 0; i <= SSFR_YAML_KEYS; i++) used += (size_t)snprintf(text + used, 20000 - used, "k%d: 1\n", i);
    assert_fails(SSFR_ERR_FORMAT, parse(&tree, text), "a.yaml:1001:1: the thing: more than 1000 keys");
    free(text);
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

typedef struct params {
    double step;
    int rounds;
} params;

static const ssfr_param param_rows[] = {
    SSFR_PARAM_REAL(params, step, "m", 0.25, 0, 1, "how far"),
    SSFR_PARAM_INT(params, rounds, "1", 3, 1, 10, "how often"),
    SSFR_PARAM_END,
};

typedef struct thing {
    char *title;
    double width, plain, pair[2], place[3];
    size_t count;
    bool shown, sides[3];
    int colour;
    params p;
    const ssfr_yaml_node *more;
} thing;

static const char *const colours[] = {"red", "green", NULL}, *const sides[] = {"left", "right", "top", NULL};

static const ssfr_yaml_row rows[] = {
    SSFR_YAML_ROW("title", ssfr_yaml_read_text, thing, title),
    SSFR_YAML_ROW("width", ssfr_yaml_read_real, thing, width, .needed = true, .unit = "m", .min = 0.5, .max = 4),
    SSFR_YAML_ROW("plain", ssfr_yaml_read_real, thing, plain),
    SSFR_YAML_ROW("pair", ssfr_yaml_read_real2, thing, pair),
    SSFR_YAML_ROW("place", ssfr_yaml_read_real3, thing, place, .min = -1, .max = 5),
    SSFR_YAML_ROW("count", ssfr_yaml_read_count, thing, count),
    SSFR_YAML_ROW("shown", ssfr_yaml_read_flag, thing, shown),
    SSFR_YAML_ROW("colour", ssfr_yaml_read_word, thing, colour, .words = colours),
    SSFR_YAML_ROW("sides", ssfr_yaml_read_words, thing, sides, .words = sides),
    SSFR_YAML_ROW("p", ssfr_yaml_read_params, thing, p, .params = param_rows),
    SSFR_YAML_ROW("more", ssfr_yaml_read_node, thing, more),
    SSFR_YAML_ROW_END,
};

static ssfr_result read_thing(ssfr_yaml **tree, const char *text, thing *t)
{
    const ssfr_result result = parse(tree, text);
    return result == SSFR_OK ? ssfr_yaml_read_map(ssfr_yaml_root(*tree), rows, t) : result;
}

static void rows_read_each_kind_of_value(void **state)
{
    (void)state;
    ssfr_yaml *tree;
    thing t = {.plain = 7.5};
    ssfr_params_default(param_rows, &t.p);
    assert_int_equal(read_thing(&tree, "title: a b\nwidth: 2.385\npair: [1e3, -0.5]\nplace: [0, 4.5, -1]\ncount: 12e3\n"
                                       "shown: yes\ncolour: green\nsides: [top, left]\np: {rounds: 5}\nmore: [1, {}]\n",
                                &t),
                     SSFR_OK);
    assert_string_equal(t.title, "a b");
    assert_close(t.width, 2.385, 0, 0);
    assert_close(t.plain, 7.5, 0, 0); /* not given, stays */
    assert_close(t.pair[0], 1000, 0, 0);
    assert_close(t.pair[1], -0.5, 0, 0);
    assert_close(t.place[1], 4.5, 0, 0);
    assert_close(t.place[2], -1, 0, 0);
    assert_int_equal(t.count, 12000);
    assert_true(t.shown);
    assert_int_equal(t.colour, 1);
    assert_true(t.sides[0] && !t.sides[1] && t.sides[2]);
    assert_int_equal(t.p.rounds, 5);
    assert_close(t.p.step, 0.25, 0, 0);
    assert_int_equal(t.more->n, 2);
    free(t.title);
    ssfr_yaml_destroy(&tree);
}

static void numbers_have_a_point_in_any_locale(void **state)
{
    (void)state;
    ssfr_yaml *tree;
    thing t = {0};
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8")) skip();
    const ssfr_result result = read_thing(&tree, "width: 2.385\n", &t);
    setlocale(LC_NUMERIC, "C");
    assert_int_equal(result, SSFR_OK);
    assert_close(t.width, 2.385, 0, 0);
    ssfr_yaml_destroy(&tree);
}

static void values_that_no_row_takes_are_refused(void **state)
{
    (void)state;
    static const struct {
        ssfr_result code;
        const char *text, *message;
    } cases[] = {
        {SSFR_ERR_FORMAT, "[1]", "a.yaml:1:1: the thing: expected a map of key: value"},
        {SSFR_ERR_FORMAT, "words", "a.yaml:1:1: the thing: expected a map of key: value"},
        {SSFR_ERR_FORMAT, "width: 1\nwidht: 2\n",
         "a.yaml:2:1: no key widht: a thing has title, width, plain, pair, place, count, shown, colour, sides"},
        {SSFR_ERR_FORMAT, "title: x\n", "a.yaml:1:1: the thing: width must be given"},
        {SSFR_ERR_FORMAT, "title: [x]\n", "a.yaml:1:8: title: expected one value"},
        {SSFR_ERR_FORMAT, "width: [1]\n", "a.yaml:1:8: width: expected one value"},
        {SSFR_ERR_FORMAT, "width: wide\n", "a.yaml:1:8: width: \"wide\" is not a finite number"},
        {SSFR_ERR_FORMAT, "width:\n", "width: \"\" is not a finite number"},
        {SSFR_ERR_FORMAT, "width: 1 m\n", "width: \"1 m\" is not a finite number"},
        {SSFR_ERR_FORMAT, "width: .nan\n", "width: \".nan\" is not a finite number"},
        {SSFR_ERR_FORMAT, "width: nan\n", "width: \"nan\" is not a finite number"},
        {SSFR_ERR_FORMAT, "width: .inf\n", "width: \".inf\" is not a finite number"},
        {SSFR_ERR_FORMAT, "width: 1e999\n", "width: \"1e999\" is not a finite number"},
        {SSFR_ERR_VALUE, "width: 0.49\n", "a.yaml:1:8: width: 0.49 is out of range [0.5, 4] m"},
        {SSFR_ERR_VALUE, "width: 4.01\n", "width: 4.01 is out of range [0.5, 4] m"},
        {SSFR_ERR_FORMAT, "pair: [1]\n", "a.yaml:1:7: pair: expected a list of 2 numbers"},
        {SSFR_ERR_FORMAT, "place: [1, 2]\n", "a.yaml:1:8: place: expected a list of 3 numbers"},
        {SSFR_ERR_FORMAT, "place: [1, 2, 3, 4]\n", "place: expected a list of 3 numbers"},
        {SSFR_ERR_FORMAT, "place: 1\n", "place: expected a list of 3 numbers"},
        {SSFR_ERR_FORMAT, "place: [1, [2], 3]\n", "a.yaml:1:12: place: expected one value"},
        {SSFR_ERR_FORMAT, "place: [1, two, 3]\n", "a.yaml:1:12: place: \"two\" is not a finite number"},
        {SSFR_ERR_VALUE, "place: [1, 2, 6]\n", "a.yaml:1:15: place: 6 is out of range [-1, 5]"},
        {SSFR_ERR_VALUE, "count: 1.5\n", "a.yaml:1:8: count: 1.5 is not a whole number"},
        {SSFR_ERR_VALUE, "count: -1\n", "count: -1 is not a whole number"},
        {SSFR_ERR_VALUE, "count: 1e16\n", "count: 1e16 is not a whole number"},
        {SSFR_ERR_FORMAT, "shown: maybe\n", "a.yaml:1:8: shown: \"maybe\" is neither true nor false"},
        {SSFR_ERR_FORMAT, "shown: []\n", "a.yaml:1:8: shown: expected one value"},
        {SSFR_ERR_VALUE, "colour: blue\n", "a.yaml:1:9: colour: \"blue\" is none of red, green"},
        {SSFR_ERR_FORMAT, "colour: {}\n", "a.yaml:1:9: colour: expected one value"},
        {SSFR_ERR_FORMAT, "sides: left\n", "a.yaml:1:8: sides: expected a list"},
        {SSFR_ERR_VALUE, "sides: [left, below]\n", "a.yaml:1:15: sides: \"below\" is none of left, right, top"},
        {SSFR_ERR_FORMAT, "sides: [top, top]\n", "a.yaml:1:14: sides: top stands twice"},
        {SSFR_ERR_FORMAT, "p: 1\n", "a.yaml:1:4: p: expected a map of key: value"},
        {SSFR_ERR_FORMAT, "p: {steps: 1}\n", "a.yaml:1:5: p: no key steps: it has step, rounds"},
        {SSFR_ERR_VALUE, "p: {step: 2}\n", "a.yaml:1:11: p.step=2: out of range [0, 1] m"},
        {SSFR_ERR_VALUE, "p: {rounds: 2.5}\n", "a.yaml:1:13: p.rounds=2.5: expected a whole number"},
        {SSFR_ERR_FORMAT, "p: {rounds: [1]}\n", "a.yaml:1:13: rounds: expected one value"},
        {SSFR_ERR_FORMAT, "width: &a [*a]\n", "width: expected one value"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_yaml *tree = NULL;
        thing t = {0};
        assert_fails(cases[i].code, read_thing(&tree, cases[i].text, &t), cases[i].message);
        free(t.title);
        ssfr_yaml_destroy(&tree);
    }
}

static void errors_of_long_names_stay_one_line(void **state)
{
    (void)state;
    ssfr_yaml *tree = NULL;
    thing t = {0};
    char *text = repeat("? \"", "long\\n", 1000, "\"\n: 1\n");
    assert_fails(SSFR_ERR_FORMAT, read_thing(&tree, text, &t), "a.yaml:1:3: no key long long");
    ssfr_yaml_destroy(&tree);
    free(text);
}

static void a_document_cut_at_any_byte_gives_a_tree_or_an_error(void **state)
{
    (void)state;
    static const char whole[] = "title: &t \"x\\u00e9\"\nwidth: 2.385\nplace: [0, 4.5, -1] # there\n"
                                "sides:\n  - top\n  - left\np: {rounds: 5}\nmore:\n  ? k\n  : [{a: *t}, |\n";
    int n_read = 0;
    for (size_t n = 0; n < sizeof whole; n++) {
        ssfr_yaml *tree = NULL;
        thing t = {0};
        test_clear_log();
        ssfr_result result = ssfr_yaml_parse(&tree, "a.yaml", "thing", whole, n);
        assert_int_equal(result == SSFR_OK, tree != NULL);
        if (tree) result = ssfr_yaml_read_map(ssfr_yaml_root(tree), rows, &t);
        assert_int_equal(test_n_errors(), result == SSFR_OK ? 0 : 1);
        n_read += result == SSFR_OK;
        free(t.title);
        ssfr_yaml_destroy(&tree);
    }
    assert_true(n_read > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tree_keeps_order_texts_and_places),
        cmocka_unit_test(line_ends_of_any_kind_and_a_byte_order_mark_are_taken),
        cmocka_unit_test(an_alias_has_its_anchors_content_and_its_own_name_and_place),
        cmocka_unit_test(an_alias_may_stand_in_what_it_stands_for),
        cmocka_unit_test(malformed_documents_are_refused_with_their_place),
        cmocka_unit_test(zero_bytes_and_other_encodings_are_refused),
        cmocka_unit_test(documents_beyond_all_measure_are_refused),
        cmocka_unit_test(a_map_of_too_many_keys_is_refused),
        cmocka_unit_test(rows_read_each_kind_of_value),
        cmocka_unit_test(numbers_have_a_point_in_any_locale),
        cmocka_unit_test(values_that_no_row_takes_are_refused),
        cmocka_unit_test(errors_of_long_names_stay_one_line),
        cmocka_unit_test(a_document_cut_at_any_byte_gives_a_tree_or_an_error),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

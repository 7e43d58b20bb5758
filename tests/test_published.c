/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_published.c: a paper's numbers find their rows, and tables that cannot be joined are refused. */
#include "experiments/hash.h"
#include "experiments/published.h"
#include "tests/util.h"

static char file[] = "tab1.csv", ms[] = "ms", scene[] = "scene", steps[] = "steps", n[] = "n",
            place[] = "item.yaml:7:1";
static const ssfr_published_spec
    spec = {.file = file, .column = ms, .n_on = 2, .on = {scene, steps}, .with = {scene, n}, .where = place},
    otherwise = {.file = file, .column = ms, .n_on = 2, .on = {scene, steps}, .with = {n, scene}, .where = place};
static const char table[] = "scene,steps,ms [ms],gpu\nblock,0,14,x\nblock,2.0,15.50,x\n\"a, b\",,16,x\n";

static ssfr_published *parse(const char *text)
{
    ssfr_published *p = NULL;
    assert_int_equal(ssfr_published_parse(&p, &spec, "tab1.csv", text, strlen(text)), SSFR_OK);
    return p;
}

static const char *find(const ssfr_published *p, const char *in, const char *after)
{
    return ssfr_published_find(p, (const char *const[]){in, after});
}

static void a_row_is_found_by_all_its_cells(void **state)
{
    (void)state;
    ssfr_published *p = parse(table);
    assert_string_equal(p->header, "published_ms");
    assert_string_equal(find(p, "block", "0"), "14");
    assert_string_equal(find(p, "block", "2"), "15.50");
    assert_string_equal(find(p, "block", "20e-1"), "15.50");
    assert_string_equal(find(p, "a, b", ""), "16");
    assert_string_equal(find(p, "a, b", "0"), "");
    assert_string_equal(find(p, "rock", "0"), "");
    ssfr_published_destroy(&p);
    assert_null(p);
    ssfr_published_destroy(&p);
}

static void other_numbers_have_another_hash(void **state)
{
    (void)state;
    static const char other[] = "scene,steps,ms\nblock,0,14.5\n";
    ssfr_published *a = parse(table), *b = parse(other), *c = parse(table);
    assert_true(ssfr_published_hash(a, SSFR_HASH) != ssfr_published_hash(b, SSFR_HASH));
    assert_true(ssfr_published_hash(a, SSFR_HASH) == ssfr_published_hash(c, SSFR_HASH));
    c->spec = &otherwise; /* joined by other columns */
    assert_true(ssfr_published_hash(a, SSFR_HASH) != ssfr_published_hash(c, SSFR_HASH));
    ssfr_published_destroy(&a);
    ssfr_published_destroy(&b);
    ssfr_published_destroy(&c);
}

static void a_table_that_cannot_be_joined_is_refused(void **state)
{
    static const struct {
        ssfr_result code;
        const char *text, *message;
    } cases[] = {
        {SSFR_ERR_UNKNOWN, "scene,steps\n", "item.yaml:7:1: published: tab1.csv has no column ms"},
        {SSFR_ERR_UNKNOWN, "scene,ms\n", "item.yaml:7:1: published: tab1.csv has no column steps"},
        {SSFR_ERR_UNKNOWN, "", "item.yaml:7:1: published: tab1.csv has no column ms"},
        {SSFR_ERR_FORMAT, "scene,steps,ms\na,0,1\nb,0,2\na,0.0,3\n", "rows 1 and 3 of tab1.csv have the same scene"},
        {SSFR_ERR_FORMAT, "scene,steps,ms\na,0,1\nb,0,2", "tab1.csv: the last line does not end"},
        {SSFR_ERR_FORMAT, "scene,steps,ms\na,0\n", "tab1.csv:2: 2 cells, the header has 3"},
    };
    (void)state;
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_published *p = (ssfr_published *)&cases; /* is nulled */
        assert_fails(cases[i].code, ssfr_published_parse(&p, &spec, "tab1.csv", cases[i].text, strlen(cases[i].text)),
                     cases[i].message);
        assert_null(p);
    }
}

static void a_file_is_sought_beside_the_sweep(void **state)
{
    (void)state;
    ssfr_published *p = NULL;
    assert_fails(SSFR_ERR_IO, ssfr_published_load(&p, &spec, "nowhere/item.yaml"), "nowhere/published/tab1.csv");
    assert_fails(SSFR_ERR_IO, ssfr_published_load(&p, &spec, "item.yaml"), "published/tab1.csv");
    assert_null(p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_row_is_found_by_all_its_cells),
        cmocka_unit_test(other_numbers_have_another_hash),
        cmocka_unit_test(a_table_that_cannot_be_joined_is_refused),
        cmocka_unit_test(a_file_is_sought_beside_the_sweep),
    };
    return cmocka_run_group_tests_name("published", tests, test_capture_log, NULL);
}

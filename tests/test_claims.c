/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_claims.c: claims are read with the place of every error, held to tables, and written beside those of others. */
#include "experiments/claims.h"
#include "tests/disk.h"
#include "tests/util.h"

#include <sys/stat.h>
#include <unistd.h>

static const char good[] = "# two of them\n"
                           "- id: cheap\n"
                           "  where: Tab. 1, \"here\"\n"
                           "  statement: it is cheap\n"
                           "  published: 1.14, 1.36\n"
                           "  unit: ms\n"
                           "  rule: max(tab1.ms) <= 3\n"
                           "  note: in a dry place\n"
                           "- {id: close, where: Fig. 2, statement: it is close, rule: min(fig2.m) < max(tab1.ms)}\n";

static ssfr_claims *parse(const char *paper, const char *text)
{
    ssfr_claims *claims = NULL;
    assert_int_equal(ssfr_claims_parse(&claims, paper, "claims.yaml", text, strlen(text)), SSFR_OK);
    return claims;
}

/* A folder for results, with tables of a paper. */
static const char *folder_with(const char *name, const char *tab1, const char *fig2)
{
    char path[1000];
    const char *folder = test_path(name);
    assert_int_equal(mkdir(folder, 0777), 0);
    snprintf(path, sizeof path, "%s/paper", folder);
    assert_int_equal(mkdir(path, 0777), 0);
    snprintf(path, sizeof path, "%s/paper/tab1.csv", folder);
    if (tab1) test_write_file(path, tab1, strlen(tab1));
    snprintf(path, sizeof path, "%s/paper/fig2.csv", folder);
    if (fig2) test_write_file(path, fig2, strlen(fig2));
    return folder;
}

static const char *claims_in(const char *folder)
{
    static char path[1000];
    snprintf(path, sizeof path, "%s/claims.csv", folder);
    return path;
}

/* Cell of a row of the file that was written. */
static void assert_cell(const char *folder, size_t row, const char *column, const char *expected)
{
    ssfr_csv_table *table = NULL;
    assert_int_equal(ssfr_csv_load(&table, claims_in(folder)), SSFR_OK);
    assert_true(row < table->n_rows);
    assert_true(ssfr_csv_column(table, column) >= 0);
    assert_string_equal(ssfr_csv_cell(table, row, ssfr_csv_column(table, column)), expected);
    ssfr_csv_table_destroy(&table);
}

static void assert_claims(const char *folder, const char *expected)
{
    char joined[1000] = "";
    ssfr_csv_table *table = NULL;
    assert_int_equal(ssfr_csv_load(&table, claims_in(folder)), SSFR_OK);
    for (size_t row = 0; row < table->n_rows; row++)
        for (int column = 0; column < 2; column++) {
            strcat(joined, ssfr_csv_cell(table, row, column));
            strcat(joined, column ? " " : ":");
        }
    ssfr_csv_table_destroy(&table);
    assert_string_equal(joined, expected);
}

static void save(const char *paper, const char *text, const char *folder)
{
    ssfr_claims *claims = parse(paper, text);
    assert_int_equal(ssfr_claims_judge(claims, folder), SSFR_OK);
    assert_int_equal(ssfr_claims_save(claims, folder), SSFR_OK);
    ssfr_claims_destroy(&claims);
    assert_null(claims);
}

static void claims_are_read(void **state)
{
    (void)state;
    ssfr_claims *claims = parse("paper", good);
    assert_int_equal(claims->n, 2);
    assert_string_equal(claims->paper, "paper");
    assert_string_equal(claims->claims[0].where, "Tab. 1, \"here\"");
    assert_string_equal(claims->claims[0].published, "1.14, 1.36");
    assert_null(claims->claims[1].note);
    ssfr_claims_destroy(&claims);
    claims = parse("paper", "[]");
    assert_int_equal(claims->n, 0);
    ssfr_claims_destroy(&claims);
    ssfr_claims_destroy(&claims);
}

static void a_claim_holds_or_not(void **state)
{
    (void)state;
    const char *folder = folder_with("holds", "status,ms\nok,2.5\nok,NaN\n", "m\n4\n");
    ssfr_claims *claims = parse("paper", good);
    assert_int_equal(ssfr_claims_judge(claims, folder), SSFR_OK);
    assert_string_equal(ssfr_claim_holds(&claims->claims[0]), "yes");
    assert_string_equal(ssfr_claim_holds(&claims->claims[1]), "no");
    assert_int_equal(ssfr_claims_save(claims, folder), SSFR_OK);
    ssfr_claims_destroy(&claims);
    assert_cell(folder, 0, "where", "Tab. 1, \"here\"");
    assert_cell(folder, 0, "statement", "it is cheap");
    assert_cell(folder, 0, "published", "1.14, 1.36");
    assert_cell(folder, 0, "measured", "2.5");
    assert_cell(folder, 0, "unit", "ms");
    assert_cell(folder, 0, "rule", "max(tab1.ms) <= 3");
    assert_cell(folder, 0, "holds", "yes");
    assert_cell(folder, 0, "note", "in a dry place; missing values left out: 1");
    assert_cell(folder, 1, "holds", "no");
    assert_cell(folder, 1, "measured", "4");
    assert_cell(folder, 1, "unit", "1");
    assert_cell(folder, 1, "note", "compared with 2.5; missing values left out: 1");
}

static void a_missing_table_is_not_measured(void **state)
{
    (void)state;
    const char *folder = folder_with("missing", "status,ms\nok,2.5\n", NULL);
    save("paper", good, folder);
    assert_cell(folder, 0, "holds", "yes");
    assert_cell(folder, 1, "holds", "not measured");
    assert_cell(folder, 1, "measured", "");
    assert_cell(folder, 1, "note", "not measured: there is no table fig2");
}

static void what_was_left_out_is_told_of_what_was_measured_alone(void **state)
{
    (void)state;
    const char *folder = folder_with("nothing", "status,ms\nok,NaN\n", NULL);
    save("paper", good, folder);
    assert_cell(folder, 0, "holds", "not measured");
    assert_cell(folder, 0, "note", "in a dry place; not measured: no row has the number that is asked for");
}

static void rows_of_other_papers_stay(void **state)
{
    static const char one[] = "[{id: a, where: b, statement: c, rule: 1 < 2}]",
                      other[] = "[{id: z, where: b, statement: 'two\n\n lines', rule: 1 > 2}]";
    (void)state;
    const char *folder = folder_with("others", NULL, NULL);
    save("first", one, folder);
    save("second", good, folder);
    save("third", one, folder);
    assert_claims(folder, "a:first cheap:second close:second a:third ");
    save("second", other, folder);
    assert_claims(folder, "a:first z:second a:third ");
    assert_cell(folder, 1, "statement", "two\nlines");
    save("third", other, folder);
    save("first", good, folder);
    assert_claims(folder, "cheap:first close:first z:second z:third ");
    assert_cell(folder, 2, "statement", "two\nlines");
    save("second", "[]", folder);
    assert_claims(folder, "cheap:first close:first z:third ");
    assert_int_equal(test_count_files(claims_in(folder), "claims"), 1);
}

static void a_table_that_is_none_is_an_error(void **state)
{
    (void)state;
    const char *folder = folder_with("torn", "a,b\n1\n", NULL);
    ssfr_claims *claims = parse("paper", good);
    assert_fails(SSFR_ERR_FORMAT, ssfr_claims_judge(claims, folder), "tab1.csv:2: 1 cells, the header has 2");
    ssfr_claims_destroy(&claims);
}

static void another_table_is_not_replaced(void **state)
{
    (void)state;
    const char *folder = folder_with("another", NULL, NULL);
    ssfr_claims *claims = parse("paper", good);
    test_write_file(claims_in(folder), "claim,paper\na,b\n", 16);
    assert_fails(SSFR_ERR_FORMAT, ssfr_claims_save(claims, folder), "claims.csv: is no table of claims");
    test_write_file(claims_in(folder), "a,b,c,d,e,f,g,h,i,j\n", 20);
    assert_fails(SSFR_ERR_FORMAT, ssfr_claims_save(claims, folder), "claims.csv: is no table of claims");
    test_write_file(claims_in(folder), "", 0);
    assert_int_equal(ssfr_claims_save(claims, folder), SSFR_OK);
    assert_fails(SSFR_ERR_IO, ssfr_claims_save(claims, test_path("nowhere")), "nowhere");
    ssfr_claims_destroy(&claims);
}

static void a_full_disk_leaves_what_was_there(void **state)
{
    (void)state;
    const char *folder = folder_with("full", NULL, NULL);
    save("first", "[{id: a, where: b, statement: c, rule: 1 < 2}]", folder);
    ssfr_claims *claims = parse("paper", good);
    test_limit_file_size(150);
    assert_fails(SSFR_ERR_IO, ssfr_claims_save(claims, folder), "claims.csv");
    test_limit_file_size(SIZE_MAX);
    ssfr_claims_destroy(&claims);
    assert_claims(folder, "a:first ");
    assert_int_equal(test_count_files(claims_in(folder), "claims"), 1);
}

static void assert_refused(const char *text, const char *error)
{
    ssfr_claims *claims = (ssfr_claims *)&good; /* is nulled */
    assert_fails(SSFR_ERR_FORMAT, ssfr_claims_parse(&claims, "paper", "claims.yaml", text, strlen(text)), error);
    assert_null(claims);
}

static void an_error_names_its_place(void **state)
{
    (void)state;
    assert_refused("a: b", "claims.yaml:1:1: ");
    assert_refused("- a", "claims.yaml:1:3: ");
    assert_refused("- {id: a}", "where must be given");
    assert_refused("- {id: a, where: b, statement: c}", "rule must be given");
    assert_refused("- {id: a, colour: red}", "claims.yaml:1:11: ");
    assert_refused("- {id: a, where: b, statement: c, rule: 1 < 2}\n- {id: a, where: b, statement: c, rule: 1 < 2}\n",
                   "claims.yaml:2:3: the id a stands twice");
}

static void an_error_in_a_rule_names_its_place(void **state)
{
    (void)state;
    assert_refused("- id: a\n  where: b\n  statement: c\n  rule: max(a.b) <= 3 +\n",
                   "claims.yaml:4:24: expected a number, table.column or function() at the end");
    assert_refused("- id: a\n  where: b\n  statement: c\n  rule: \"max(a.b) <= x\"\n",
                   "claims.yaml:4:22: expected a number, table.column or function() at x");
    assert_refused("- id: a\n  where: b\n  statement: c\n  rule: 'maxi(a.b) <= 1'\n",
                   "claims.yaml:4:10: no such function");
    assert_refused("- id: a\n  where: b\n  statement: c\n  rule: >\n    max(a.b)\n    <= ?\n",
                   "expected a number, table.column or function() at ?");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(claims_are_read),
        cmocka_unit_test(a_claim_holds_or_not),
        cmocka_unit_test(a_missing_table_is_not_measured),
        cmocka_unit_test(what_was_left_out_is_told_of_what_was_measured_alone),
        cmocka_unit_test(rows_of_other_papers_stay),
        cmocka_unit_test(a_table_that_is_none_is_an_error),
        cmocka_unit_test(another_table_is_not_replaced),
        cmocka_unit_test(a_full_disk_leaves_what_was_there),
        cmocka_unit_test(an_error_names_its_place),
        cmocka_unit_test(an_error_in_a_rule_names_its_place),
    };
    return cmocka_run_group_tests_name("claims", tests, test_capture_log, NULL);
}

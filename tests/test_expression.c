/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_expression.c: rules mean what they say, over tables whose answers are known; errors name the place. */
#include "experiments/expression.h"
#include "tests/util.h"

/* Keys, the status, numbers. Row 5 failed, row 6 has no number. */
static const char flow_text[] = "method,steps,status,ms [ms],error_deg\n"
                                "old,0,ok,2.5,40\n"
                                "old,10,ok,5,20\n"
                                "old,20,ok,7.5,10\n"
                                "new,0,ran,2,40\n"
                                "new,10,no memory,999,999\n"
                                "new,20,ok,3,NaN\n"
                                "a b,(1),ok,0,-3\n";
static const char bare_text[] = "scene,ms\na,1.5\nb,2.25\n";

typedef struct fixture {
    ssfr_csv_table *flow, *bare;
} fixture;

static int setup(void **state)
{
    static fixture f;
    *state = &f;
    test_capture_log(state);
    *state = &f;
    return ssfr_csv_parse(&f.flow, "flow.csv", flow_text, strlen(flow_text)) != SSFR_OK ||
           ssfr_csv_parse(&f.bare, "bare.csv", bare_text, strlen(bare_text)) != SSFR_OK;
}

static int teardown(void **state)
{
    fixture *f = *state;
    ssfr_csv_table_destroy(&f->flow);
    ssfr_csv_table_destroy(&f->bare);
    return 0;
}

static ssfr_result find(void *user, const char *name, const ssfr_csv_table **table)
{
    fixture *f = user;
    *table = strcmp(name, "flow") == 0 ? f->flow : strcmp(name, "bare") == 0 ? f->bare : NULL;
    return strcmp(name, "broken") == 0 ? ssfr_fail(SSFR_ERR_IO, "broken.csv: no disk") : SSFR_OK;
}

static const ssfr_text_place place = {"claims.yaml", 7, 11};

static ssfr_verdict judge(void **state, const char *rule)
{
    ssfr_expression *e = NULL;
    ssfr_verdict verdict;
    const ssfr_table_source source = {find, *state};
    assert_int_equal(ssfr_expression_parse(&e, rule, &place), SSFR_OK);
    assert_int_equal(ssfr_expression_judge(e, &source, &verdict), SSFR_OK);
    ssfr_expression_destroy(&e);
    assert_null(e);
    return verdict;
}

static void assert_value(void **state, const char *sum, double expected)
{
    char rule[500];
    snprintf(rule, sizeof rule, "%s >= 1e9", sum);
    const ssfr_verdict verdict = judge(state, rule);
    if (!verdict.measured) print_error("%s: %s\n", sum, verdict.why);
    assert_true(verdict.measured);
    assert_true(verdict.constant);
    assert_false(verdict.holds);
    assert_close(verdict.left, expected, 1e-12, 1e-12);
}

static void assert_not_measured(void **state, const char *sum, const char *why)
{
    char rule[500];
    snprintf(rule, sizeof rule, "%s <= 1", sum);
    const ssfr_verdict verdict = judge(state, rule);
    assert_false(verdict.measured);
    assert_false(verdict.holds);
    assert_true(isnan(verdict.left) && isnan(verdict.right));
    if (!strstr(verdict.why, why)) print_error("%s: %s, expected %s\n", sum, verdict.why, why);
    assert_non_null(strstr(verdict.why, why));
}

static void arithmetic_has_its_usual_precedence(void **state)
{
    assert_value(state, "2 + 3 * 4", 14);
    assert_value(state, "(2 + 3) * 4", 20);
    assert_value(state, "2.385 - 1 - 1", 0.385);
    assert_value(state, "16 / 4 / 2", 2);
    assert_value(state, "8 / 4 * 2", 4);
    assert_value(state, "-2 * -3", 6);
    assert_value(state, "1 - -2", 3);
    assert_value(state, "--2", 2);
    assert_value(state, "-(1 + 2) * 3", -9);
    assert_value(state, "1.5e-3*2E+3", 3);
    assert_value(state, ".5", 0.5);
    assert_value(state, "  ( ( 7 ) )\n", 7);
}

static void a_comparison_is_what_it_says(void **state)
{
    static const struct {
        const char *sign;
        bool below, equal, above;
    } signs[] = {{"<=", true, true, false}, {"<", true, false, false}, {">=", false, true, true},
                 {">", false, false, true}, {"==", false, true, false}, {"!=", true, false, true}};
    for (size_t i = 0; i < SSFR_COUNT(signs); i++)
        for (int left = 1; left <= 3; left++) {
            char rule[32];
            snprintf(rule, sizeof rule, "%d %s 2", left, signs[i].sign);
            const bool expected = left == 1 ? signs[i].below : left == 2 ? signs[i].equal : signs[i].above;
            const ssfr_verdict verdict = judge(state, rule);
            assert_true(verdict.measured);
            assert_int_equal(verdict.holds, expected);
            assert_close(verdict.right, 2, 0, 0);
        }
}

static void a_verdict_tells_both_sides(void **state)
{
    const ssfr_verdict verdict = judge(state, "max(flow.ms, method=old) > 2 * min(flow.ms, method=old)");
    assert_true(verdict.holds);
    assert_false(verdict.constant);
    assert_close(verdict.left, 7.5, 0, 0);
    assert_close(verdict.right, 5, 0, 0);
    assert_string_equal(verdict.why, "");
}

static void a_list_becomes_one_number(void **state)
{
    assert_value(state, "max(flow.ms, method=old)", 7.5);
    assert_value(state, "min(flow.ms, method=old)", 2.5);
    assert_value(state, "mean(flow.ms, method=old)", 5);
    assert_value(state, "median(flow.ms, method=old)", 5);
    assert_value(state, "median(flow.ms, method=old, steps<20)", 3.75);
    assert_value(state, "mean(flow.error_deg, method=old)", 70. / 3);
    assert_value(state, "count(flow.ms, method=old)", 3);
    assert_value(state, "max(bare.ms)", 2.25);
}

static void each_value_is_computed_with(void **state)
{
    assert_value(state, "max(2 * flow.ms - 1, method=old)", 14);
    assert_value(state, "max(flow.error_deg / flow.ms, method=old)", 16);
    assert_value(state, "min(-flow.ms, method=old)", -7.5);
    assert_value(state, "max(abs(flow.error_deg - 30), method=old)", 20);
    assert_value(state, "min(abs(flow.error_deg, method='a b'))", 3);
    assert_value(state, "abs(-2.385)", 2.385);
    assert_value(state, "log(2.718281828459045)", 1);
    assert_value(state, "max(log(flow.error_deg), method=old)", log(40));
}

static void filters_choose_rows(void **state)
{
    assert_value(state, "max(flow.error_deg, method=old, steps=10)", 20);
    assert_value(state, "max(flow.error_deg, method = old , steps = 1e1)", 20);
    assert_value(state, "count(flow.ms, steps=0|20)", 4);
    assert_value(state, "count(flow.ms, method!=old)", 3);
    assert_value(state, "count(flow.ms, method!=old|new)", 1);
    assert_value(state, "count(flow.ms, steps>=10)", 3);
    assert_value(state, "count(flow.ms, steps>10)", 2);
    assert_value(state, "count(flow.ms, steps<=10)", 3);
    assert_value(state, "count(flow.ms, steps<10)", 2);
}

static void a_cell_in_quotes_may_hold_anything(void **state)
{
    assert_value(state, "max(flow.ms, steps='(1)')", 0);
    assert_value(state, "count(flow.ms, method='no, such | method')", 0);
    assert_value(state, "count(flow.ms, method='')", 0);
}

static void filters_reach_what_is_within(void **state)
{
    assert_value(state, "max(abs(flow.ms, steps<20), method=old)", 5);
    assert_value(state, "max(flow.ms, method=old) - max(flow.ms, method=new)", 4.5);
}

static void what_is_missing_is_left_out_and_counted(void **state)
{
    const ssfr_verdict verdict = judge(state, "max(flow.ms, method=new) <= 3");
    assert_true(verdict.holds);
    assert_close(verdict.left, 3, 0, 0); /* not the 999 of a run that failed */
    assert_int_equal(verdict.left_out, 1);
    assert_int_equal(judge(state, "max(flow.error_deg, method=new) <= 40").left_out, 2);
    assert_value(state, "count(flow.error_deg, method=new)", 1);
    assert_value(state, "count(flow.error_deg, method=newer)", 0);
}

static void a_ratio_is_of_rows_that_are_else_alike(void **state)
{
    assert_value(state, "max(ratio(flow.ms, method=old, method=new))", 2.5);
    assert_value(state, "min(ratio(flow.ms, method=old, method=new))", 1.25);
    assert_value(state, "min(ratio(flow.ms, method=new, method=old))", 0.4);
    assert_value(state, "count(ratio(flow.ms, method=old, method=new))", 2);
    assert_value(state, "max(ratio(flow.ms, steps=20, steps=0), method=old)", 3);
    assert_value(state, "max(ratio(flow.ms, method=old, steps=20, steps=0))", 3);
    assert_value(state, "max(ratio(flow.ms, steps=20, method=old, steps=0))", 3);
    assert_value(state, "max(ratio(2 * flow.ms + 1, steps=20, steps=0, method=old))", 16. / 6);
    assert_int_equal(judge(state, "max(ratio(flow.ms, steps=0, steps=20)) <= 1").left_out, 0);
    assert_int_equal(judge(state, "max(ratio(flow.ms, method=old, method=new)) <= 1").left_out, 1);
}

static void a_ratio_that_cannot_be_taken_is_not_measured(void **state)
{
    assert_not_measured(state, "max(ratio(bare.ms, scene=a, scene=b))", "before its column status");
    assert_not_measured(state, "max(ratio(flow.ms, error_deg=40, error_deg=20))", "error_deg is no key");
    assert_not_measured(state, "max(ratio(flow.ms, status=ok, status=ok))", "status is no key");
    assert_not_measured(state, "max(ratio(flow.ms, method=old, method=older))", "no row has the number");
    assert_not_measured(state, "max(ratio(flow.ms, steps=0, steps=0|0.0|20))", "2 partners of another steps");
}

static void a_slope_is_that_of_the_line(void **state)
{
    assert_value(state, "slope(flow.ms, flow.steps, method=old)", 0.25);
    assert_value(state, "slope(flow.error_deg, flow.steps, method=old)", -1.5);
    assert_value(state, "slope(log(flow.error_deg), flow.steps, method=old)", -log(2) / 10);
    assert_not_measured(state, "slope(flow.ms, flow.steps, method=old, steps=10)",
                        "two rows with numbers, there are 1");
    assert_not_measured(state, "slope(flow.ms, flow.steps, steps=0)", "all at 0");
    assert_not_measured(state, "slope(flow.ms, bare.ms)", "of different rows");
}

static void a_trend_rises_or_falls_or_neither(void **state)
{
    assert_value(state, "monotone(flow.ms, flow.steps, method=old)", 1);
    assert_value(state, "monotone(flow.error_deg, flow.steps, method=old)", -1);
    assert_value(state, "monotone(flow.error_deg, flow.ms, method=old)", -1);
    assert_value(state, "monotone(0 * flow.ms, flow.steps, method=old)", 0);
    assert_value(state, "monotone(abs(flow.ms - 5), flow.steps, method=old)", 0);
    assert_not_measured(state, "monotone(flow.ms, flow.steps)", "several rows stand at 0");
    assert_not_measured(state, "monotone(flow.ms, flow.steps, method=new, steps>0)", "there are 1");
}

static void what_tables_lack_is_not_measured(void **state)
{
    assert_not_measured(state, "max(nowhere.ms)", "there is no table nowhere");
    assert_not_measured(state, "max(flow.speed)", "table flow has no column speed");
    assert_not_measured(state, "max(flow.ms, speed=3)", "table flow has no column speed");
    assert_not_measured(state, "max(flow.ms, method=newer)", "no row has the number");
    assert_not_measured(state, "min(flow.error_deg, method=new, steps>0)", "no row has the number");
    assert_not_measured(state, "max(flow.method)", "no row has the number");
    assert_not_measured(state, "max(flow.ms + bare.ms)", "+ is between lists of different rows");
    assert_not_measured(state, "max(flow.ms + abs(flow.ms, steps=0))", "+ is between lists of different rows");
}

static void what_is_no_number_is_not_measured(void **state)
{
    assert_not_measured(state, "1 / 0", "division by 0");
    assert_not_measured(state, "1 / (max(flow.ms, method=old) - 7.5)", "division by 0");
    assert_not_measured(state, "max(1 / flow.ms)", "division by 0");
    assert_not_measured(state, "log(0)", "the logarithm of 0");
    assert_not_measured(state, "max(log(flow.error_deg))", "the logarithm of -3");
    assert_not_measured(state, "1e300 * 1e300", "it comes to inf");
    const ssfr_verdict verdict = judge(state, "1 <= 1 / 0");
    assert_false(verdict.measured);
    assert_true(isnan(verdict.left));
}

static void a_table_that_cannot_be_read_is_an_error(void **state)
{
    ssfr_expression *e = NULL;
    ssfr_verdict verdict;
    const ssfr_table_source source = {find, *state};
    assert_int_equal(ssfr_expression_parse(&e, "max(broken.ms) <= 1", &place), SSFR_OK);
    assert_fails(SSFR_ERR_IO, ssfr_expression_judge(e, &source, &verdict), "broken.csv: no disk");
    assert_false(verdict.measured);
    ssfr_expression_destroy(&e);
}

/* column: of the error in the rule, from 1. */
static void assert_refused(const char *rule, int column, const char *text)
{
    ssfr_expression *e = (ssfr_expression *)&place; /* is nulled */
    char expected[200];
    snprintf(expected, sizeof expected, "claims.yaml:7:%d: %s", 10 + column, text);
    assert_fails(SSFR_ERR_FORMAT, ssfr_expression_parse(&e, rule, &place), expected);
    assert_null(e);
}

static void an_error_names_its_place(void **state)
{
    (void)state;
    assert_refused("", 1, "expected a number, table.column or function() at the end");
    assert_refused("1", 2, "expected one of <= < >= > == != at the end");
    assert_refused("1 = 2", 3, "expected one of <= < >= > == != at = 2");
    assert_refused("1 <", 4, "expected a number");
    assert_refused("1 < 2 < 3", 7, "a second comparison at < 3");
    assert_refused("1 < 2 3", 7, "expected an operator or the end at 3");
    assert_refused("1 + < 2", 5, "expected a number");
    assert_refused("(1 < 2", 4, "expected )");
    assert_refused("1..2 < 3", 1, "no number at 1..2");
    assert_refused("1e < 3", 1, "no number");
    assert_refused("1 # 2", 3, "expected one of <=");
    assert_refused("flow < 3", 1, "expected a number, table.column or function()");
    assert_refused("flow. < 3", 1, "expected a number");
    assert_refused("flow.ms < 3", 1, "a list: max, min, mean or median make it one number");
    assert_refused("3 < 2 * flow.ms", 5, "a list");
    assert_refused("abs(flow.ms) < 3", 1, "a list");
    assert_refused("ratio(flow.ms, a=b, a=c) < 3", 1, "a list");
}

static void an_error_of_a_function_names_its_place(void **state)
{
    (void)state;
    assert_refused("maximum(a.b) < 1", 1, "no such function; there are max, min, mean, median, count");
    assert_refused("max() < 1", 5, "expected a number");
    assert_refused("max(a.b < 1", 12, "expected )");
    assert_refused("max(3) < 1", 1, "max is of a column, not of one number");
    assert_refused("1 + max(max(a.b)) < 1", 5, "max is of a column");
    assert_refused("max(a=b) < 1", 1, "max takes 1 before its filters, not 0");
    assert_refused("max(a.b, a.c) < 1", 1, "max takes 1 before its filters, not 2");
    assert_refused("slope(a.b) < 1", 1, "slope takes 2 before its filters, not 1");
    assert_refused("slope(a.b, a.c, a.d) < 1", 17, "expected a filter or )");
    assert_refused("max(a=b, a.c) < 1", 10, "expected a filter");
    assert_refused("max(a.b, c=) < 1", 12, "expected a cell at ) < 1");
    assert_refused("max(a.b, c=d|) < 1", 14, "expected a cell");
    assert_refused("max(a.b, c='d) < 1", 12, "a quote without its end");
    assert_refused("max(a.b, c<d) < 1", 12, "expected one number");
    assert_refused("max(a.b, c<1|2) < 1", 12, "expected one number");
    assert_refused("max(ratio(a.b, c=d)) < 1", 5, "a ratio needs one pair");
    assert_refused("max(ratio(a.b, c=d, c!=e)) < 1", 5, "a ratio needs one pair");
    assert_refused("max(ratio(a.b, c=d, c=e, c=f)) < 1", 5, "a ratio needs one pair");
}

/* before, n times middle, after. */
static char *repeat(const char *before, const char *middle, int n, const char *after)
{
    static char text[4000];
    snprintf(text, sizeof text, "%s", before);
    for (int i = 0; i < n; i++) strcat(text, middle);
    return strcat(text, after);
}

static void a_rule_has_a_size(void **state)
{
    (void)state;
    assert_refused(repeat("", "1+", 40, "1 < 2"), 66, "more than 64 parts");
    assert_refused(repeat("", "(", 40, "1 < 2"), 17, "deeper than 16");
    assert_refused(repeat("", "-", 40, "1 < 2"), 17, "deeper than 16");
    assert_refused(repeat("max(a.b", ", c=1", 13, ") < 2"), 70, "more than 12 filters");
    assert_refused(repeat("max(a.b, c=1", "|2", 13, ") < 2"), 36, "more than 12 cells");
    assert_value(state, "((((((((((((((7))))))))))))))", 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arithmetic_has_its_usual_precedence),
        cmocka_unit_test(a_comparison_is_what_it_says),
        cmocka_unit_test(a_verdict_tells_both_sides),
        cmocka_unit_test(a_list_becomes_one_number),
        cmocka_unit_test(each_value_is_computed_with),
        cmocka_unit_test(filters_choose_rows),
        cmocka_unit_test(a_cell_in_quotes_may_hold_anything),
        cmocka_unit_test(filters_reach_what_is_within),
        cmocka_unit_test(what_is_missing_is_left_out_and_counted),
        cmocka_unit_test(a_ratio_is_of_rows_that_are_else_alike),
        cmocka_unit_test(a_ratio_that_cannot_be_taken_is_not_measured),
        cmocka_unit_test(a_slope_is_that_of_the_line),
        cmocka_unit_test(a_trend_rises_or_falls_or_neither),
        cmocka_unit_test(what_tables_lack_is_not_measured),
        cmocka_unit_test(what_is_no_number_is_not_measured),
        cmocka_unit_test(a_table_that_cannot_be_read_is_an_error),
        cmocka_unit_test(an_error_names_its_place),
        cmocka_unit_test(an_error_of_a_function_names_its_place),
        cmocka_unit_test(a_rule_has_a_size),
    };
    return cmocka_run_group_tests_name("expression", tests, setup, teardown);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_bench_solver.c: how the bench goes through its measurements: once each, and on when one of them fails. The
 * measurements themselves are in test_bench_solver.sh. */
#include "experiments/bench_solver.h"
#include "experiments/interrupt.h"
#include "tests/util.h"

#include <signal.h>

static const ssfr_column columns[] = {
    {"case", "1", 0, "a key"}, {"status", "1", 0, "ok"}, {"a", "1", 0, "a number"}, {"b", "1", 0, "a number"}};

static int n_runs;

static ssfr_result measure(ssfr_bench *bench, const void *what, double expected)
{
    const char *const keys[] = {what};
    n_runs++;
    const ssfr_result result = ssfr_bench_tick(bench, expected, 0.5);
    return result == SSFR_OK ? ssfr_ledger_add(&bench->tables[0], keys, "ok", (double[]){2.385, 1}) : result;
}

static ssfr_result fail_to(ssfr_bench *bench, const void *what, double expected)
{
    (void)bench, (void)what, (void)expected;
    n_runs++;
    return ssfr_fail(SSFR_ERR_VALUE, "water of %g m, \"solid\"", 2.385);
}

static void begin(ssfr_bench *bench)
{
    bool resumed;
    *bench = (ssfr_bench){0};
    n_runs = 0;
    assert_int_equal(ssfr_ledger_begin(&bench->tables[0], NULL, SSFR_COUNT(columns), columns, 1, false, &resumed),
                     SSFR_OK);
}

static ssfr_result visit(ssfr_bench *bench, ssfr_bench_run *run, const char *name)
{
    const char *const keys[] = {name};
    return ssfr_bench_visit(bench, run, name, 3, SSFR_BENCH_COST, keys);
}

static void each_measurement_is_made_once(void **state)
{
    (void)state;
    ssfr_bench bench;
    begin(&bench);
    bench.counting = true;
    for (int i = 0; i < 2; i++) assert_int_equal(visit(&bench, measure, i ? "dam" : "pool"), SSFR_OK);
    assert_int_equal(n_runs, 0);
    assert_close(bench.total, 6, 0, 0);
    bench.counting = false;
    for (int i = 0; i < 4; i++) assert_int_equal(visit(&bench, measure, i % 2 ? "dam" : "pool"), SSFR_OK);
    assert_int_equal(n_runs, 2);
    assert_close(bench.done, 6, 0, 0);
    assert_int_equal(ssfr_ledger_view(&bench.tables[0]).n_rows, 2);
    ssfr_ledger_finish(&bench.tables[0]);
}

static void a_failure_is_a_row_that_says_why(void **state)
{
    (void)state;
    ssfr_bench bench;
    begin(&bench);
    assert_int_equal(visit(&bench, fail_to, "pool"), SSFR_OK);
    assert_int_equal(visit(&bench, measure, "dam"), SSFR_OK);
    const ssfr_csv_table view = ssfr_ledger_view(&bench.tables[0]);
    assert_int_equal(view.n_rows, 2);
    assert_string_equal(ssfr_csv_cell(&view, 0, 1), "water of 2.385 m, \"solid\"");
    assert_string_equal(ssfr_csv_cell(&view, 0, 2), "NaN");
    assert_string_equal(ssfr_csv_cell(&view, 1, 1), "ok");
    assert_int_equal(visit(&bench, fail_to, "pool"), SSFR_OK); /* it is known already */
    assert_int_equal(n_runs, 2);
    ssfr_ledger_finish(&bench.tables[0]);
}

/* The console takes the log over, so that the line itself is looked for from outside, in test_bench_solver.sh. */
static void a_signal_ends_it_without_a_row(void **state)
{
    (void)state;
    ssfr_bench bench;
    begin(&bench);
    ssfr_interrupt_begin();
    raise(SIGINT);
    assert_int_equal(visit(&bench, measure, "pool"), SSFR_ERR_IO);
    ssfr_interrupt_end();
    assert_int_equal(n_runs, 1);
    assert_int_equal(ssfr_ledger_view(&bench.tables[0]).n_rows, 0);
    ssfr_ledger_finish(&bench.tables[0]);
}

static void keys_keep_their_texts(void **state)
{
    (void)state;
    ssfr_bench_key key;
    ssfr_bench_key_set(&key, 0, "%s", "dam_break");
    ssfr_bench_key_set(&key, 1, "%.4f", 2.385);
    assert_string_equal(key.cells[0], "dam_break");
    assert_string_equal(key.cells[1], "2.3850");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_measurement_is_made_once),
        cmocka_unit_test(a_failure_is_a_row_that_says_why),
        cmocka_unit_test(a_signal_ends_it_without_a_row),
        cmocka_unit_test(keys_keep_their_texts),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

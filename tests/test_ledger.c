/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_ledger.c: a table in memory is the one on disk, row for row, also when it is gone on with. */
#include "experiments/ledger.h"
#include "tests/disk.h"
#include "tests/util.h"

static const ssfr_column columns[] = {
    {"case", "1", 0, "a key"}, {"n", "1", 0, "a key"}, {"status", "1", 0, "ok"}, {"height", "m", 0, "a number"},
    {"speed", "m/s", 0, "a number"}};

static bool begin(ssfr_ledger *ledger, const char *path, bool resume)
{
    bool resumed;
    assert_int_equal(ssfr_ledger_begin(ledger, path, SSFR_COUNT(columns), columns, 2, resume, &resumed), SSFR_OK);
    return resumed;
}

static void add(ssfr_ledger *ledger, const char *name, const char *n, double height, double speed)
{
    const char *const keys[] = {name, n};
    assert_int_equal(ssfr_ledger_add(ledger, keys, "ok", (double[]){height, speed}), SSFR_OK);
}

static void assert_same(const ssfr_csv_table *a, const ssfr_csv_table *b)
{
    assert_int_equal(a->n_columns, b->n_columns);
    assert_int_equal(a->n_rows, b->n_rows);
    for (size_t i = 0; i < (1 + a->n_rows) * (size_t)a->n_columns; i++) assert_string_equal(a->cells[i], b->cells[i]);
}

/* What memory holds is what a reader finds. */
static void assert_saved(const ssfr_ledger *ledger, const char *path)
{
    ssfr_csv_table *read = NULL;
    const ssfr_csv_table view = ssfr_ledger_view(ledger);
    assert_int_equal(ssfr_csv_load(&read, path), SSFR_OK);
    assert_same(&view, read);
    ssfr_csv_table_destroy(&read);
}

static void rows_are_kept_and_written_alike(void **state)
{
    (void)state;
    const char *path = test_path("kept.csv");
    ssfr_ledger ledger;
    assert_false(begin(&ledger, path, false));
    add(&ledger, "a, \"quoted\" case", "7", 2.385, NAN);
    add(&ledger, "pool", "8", -1e-12, INFINITY);
    assert_saved(&ledger, path);
    const ssfr_csv_table view = ssfr_ledger_view(&ledger);
    assert_int_equal(view.n_rows, 2);
    assert_string_equal(view.cells[3], "height [m]");
    assert_close(ssfr_csv_cell_number(&view, 0, ssfr_csv_column(&view, "height")), 2.385, 0, 0);
    assert_string_equal(ssfr_csv_cell(&view, 0, 4), "NaN");
    ssfr_ledger_finish(&ledger);
}

static void a_row_without_numbers_has_nan_for_each(void **state)
{
    (void)state;
    const char *path = test_path("failed.csv"), *const keys[] = {"pool", "8"};
    ssfr_ledger ledger;
    assert_false(begin(&ledger, path, false));
    assert_int_equal(ssfr_ledger_add(&ledger, keys, "out of memory", NULL), SSFR_OK);
    assert_saved(&ledger, path);
    const ssfr_csv_table view = ssfr_ledger_view(&ledger);
    const char *const cells[] = {"pool", "8", "out of memory", "NaN", "NaN"};
    for (int i = 0; i < 5; i++) assert_string_equal(ssfr_csv_cell(&view, 0, i), cells[i]);
    ssfr_ledger_finish(&ledger);
}

static void interrupted_a_file_tells_how_it_goes_on(void **state)
{
    (void)state;
    const char *const paths[] = {test_path("interrupted.csv"), NULL};
    for (int i = 0; i < 2; i++) {
        ssfr_ledger ledger;
        assert_false(begin(&ledger, paths[i], false));
        assert_fails(SSFR_ERR_IO, ssfr_ledger_interrupted(&ledger), "interrupted");
        assert_int_equal(strstr(test_last_error(), "the same command with --resume goes on") != NULL, i == 0);
        ssfr_ledger_finish(&ledger);
    }
}

static void a_row_stands_once(void **state)
{
    (void)state;
    const char *const there[] = {"pool", "8"}, *const other[] = {"pool", "9"};
    ssfr_ledger ledger;
    assert_false(begin(&ledger, NULL, false));
    add(&ledger, "pool", "8", 1, 2);
    add(&ledger, "pool", "8", 3, 4);
    assert_true(ssfr_ledger_has(&ledger, there));
    assert_false(ssfr_ledger_has(&ledger, other));
    const ssfr_csv_table view = ssfr_ledger_view(&ledger);
    assert_int_equal(view.n_rows, 1);
    assert_string_equal(ssfr_csv_cell(&view, 0, 3), "1");
    ssfr_ledger_finish(&ledger);
}

/* Wherever the file is cut off, going on gives the same table. */
static void a_table_that_was_cut_off_is_gone_on_with(void **state)
{
    (void)state;
    const char *path = test_path("cut.csv");
    char *whole = NULL;
    size_t size;
    ssfr_ledger ledger;
    for (int round = 0; round < 2; round++) {
        begin(&ledger, path, false);
        for (int i = 0; i < 5; i++) add(&ledger, "dam_break", (const char *[]){"1", "2", "4", "8", "16"}[i], i, 2.385);
        ssfr_ledger_finish(&ledger);
    }
    assert_int_equal(ssfr_read_file(path, 1 << 16, &whole, &size), SSFR_OK);
    for (size_t cut = 0; cut <= size; cut++) {
        char *again = NULL;
        size_t size_again;
        test_write_file(path, whole, cut);
        const bool resumed = begin(&ledger, path, true);
        assert_int_equal(resumed, ssfr_ledger_view(&ledger).n_rows > 0);
        for (int i = 0; i < 5; i++) add(&ledger, "dam_break", (const char *[]){"1", "2", "4", "8", "16"}[i], i, 2.385);
        assert_saved(&ledger, path);
        ssfr_ledger_finish(&ledger);
        assert_int_equal(ssfr_read_file(path, 1 << 16, &again, &size_again), SSFR_OK);
        assert_int_equal(size_again, size);
        assert_memory_equal(again, whole, size);
        free(again);
    }
    free(whole);
}

static void another_table_is_not_gone_on_with(void **state)
{
    (void)state;
    const char *path = test_path("other.csv");
    ssfr_ledger ledger;
    bool resumed;
    test_write_file(path, "case,m,status\n", 14);
    assert_fails(SSFR_ERR_VALUE,
                 ssfr_ledger_begin(&ledger, path, SSFR_COUNT(columns), columns, 2, true, &resumed),
                 "column 2 is m, expected n");
    ssfr_ledger_finish(&ledger);
    path = test_path("absent/t.csv");
    assert_fails(SSFR_ERR_IO,
                 ssfr_ledger_begin(&ledger, path, SSFR_COUNT(columns), columns, 2, false, &resumed), "absent/t.csv");
    ssfr_ledger_finish(&ledger);
}

static void a_table_made_aside_takes_its_place_when_it_is_whole(void **state)
{
    (void)state;
    const char *path = test_path("aside.csv");
    static const ssfr_result ends[] = {SSFR_ERR_IO, SSFR_OK, SSFR_ERR_MEMORY};
    ssfr_ledger ledger;
    for (size_t i = 0; i < SSFR_COUNT(ends); i++) {
        assert_int_equal(ssfr_ledger_begin_aside(&ledger, path, SSFR_COUNT(columns), columns, 2), SSFR_OK);
        add(&ledger, "pool", "8", (double)i, 1);
        assert_int_equal(ssfr_ledger_end(&ledger, ends[i]), ends[i]);
        assert_int_equal(test_count_files(path, "aside.csv"), i > 0); /* and nothing lies about */
    }
    ssfr_csv_table *table = NULL;
    assert_int_equal(ssfr_csv_load(&table, path), SSFR_OK);
    assert_int_equal(table->n_rows, 1);
    assert_string_equal(ssfr_csv_cell(table, 0, 3), "1"); /* of the second time */
    ssfr_csv_table_destroy(&table);
    assert_fails(SSFR_ERR_IO,
                 ssfr_ledger_begin_aside(&ledger, test_path("absent/t.csv"), SSFR_COUNT(columns), columns, 2),
                 "absent/t.csv");
    assert_int_equal(ssfr_ledger_end(&ledger, SSFR_ERR_IO), SSFR_ERR_IO);
    assert_int_equal(ssfr_ledger_begin_aside(&ledger, NULL, SSFR_COUNT(columns), columns, 2), SSFR_OK); /* no file */
    add(&ledger, "pool", "8", 1, 1);
    assert_int_equal(ssfr_ledger_end(&ledger, SSFR_OK), SSFR_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_kept_and_written_alike),
        cmocka_unit_test(a_row_without_numbers_has_nan_for_each),
        cmocka_unit_test(interrupted_a_file_tells_how_it_goes_on),
        cmocka_unit_test(a_row_stands_once),
        cmocka_unit_test(a_table_that_was_cut_off_is_gone_on_with),
        cmocka_unit_test(another_table_is_not_gone_on_with),
        cmocka_unit_test(a_table_made_aside_takes_its_place_when_it_is_whole),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

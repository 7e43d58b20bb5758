/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_csv.c: tables keep every cell, survive a kill at any byte, and resume without a row twice. */
#include "experiments/csv.h"
#include "tests/util.h"

#include <sys/resource.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const columns[] = {"key", "size", "value [m^2]"};
enum { N_COLUMNS = 3, N_KEYS = 2 };

static ssfr_result write_row(ssfr_csv *csv, const char *key, const char *size, double value)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_csv_text(csv, key));
    SSFR_TRY(ssfr_csv_text(csv, size));
    SSFR_TRY(ssfr_csv_number(csv, value));
    SSFR_TRY(ssfr_csv_end_row(csv));
end:
    return result;
}

static const char *const keys[][N_KEYS] = {
    {"a,b", "1x1"}, {"say \"yes\"", "2x2"}, {"two\nlines", "3x3"}, {"plain", "4x4"}, {"", "5x5"}};

/* Writes the rows of `keys` that the file lacks; gives how many it wrote. */
static int fill(const char *path, bool resume)
{
    ssfr_csv *csv = NULL;
    int written = 0;
    assert_int_equal(ssfr_csv_create(&csv, path, N_COLUMNS, columns, N_KEYS, resume), SSFR_OK);
    for (size_t i = 0; i < SSFR_COUNT(keys); i++)
        if (!ssfr_csv_has(csv, keys[i])) {
            assert_int_equal(write_row(csv, keys[i][0], keys[i][1], 2.385 * (double)(i + 1)), SSFR_OK);
            written++;
        }
    ssfr_csv_destroy(&csv);
    assert_null(csv);
    return written;
}

static char *text_of(const char *path, size_t *size)
{
    char *text = NULL;
    assert_int_equal(ssfr_read_file(path, 1 << 20, &text, size), SSFR_OK);
    return text;
}

static void a_table_is_written_as_rfc_4180_says(void **state)
{
    (void)state;
    const char *path = test_path("rfc.csv");
    size_t size;
    assert_int_equal(fill(path, false), 5);
    char *text = text_of(path, &size);
    assert_string_equal(text, "key,size,value [m^2]\n\"a,b\",1x1,2.385\n\"say \"\"yes\"\"\",2x2,4.77\n"
                              "\"two\nlines\",3x3,7.155\nplain,4x4,9.54\n,5x5,11.925\n");
    free(text);
}

static void every_cell_is_read_back(void **state)
{
    (void)state;
    const char *path = test_path("back.csv");
    ssfr_csv_table *table = NULL;
    fill(path, false);
    assert_int_equal(ssfr_csv_load(&table, path), SSFR_OK);
    assert_int_equal(table->n_columns, N_COLUMNS);
    assert_int_equal(table->n_rows, SSFR_COUNT(keys));
    for (size_t i = 0; i < SSFR_COUNT(keys); i++) {
        assert_string_equal(ssfr_csv_cell(table, i, 0), keys[i][0]);
        assert_string_equal(ssfr_csv_cell(table, i, 1), keys[i][1]);
        assert_close(ssfr_csv_cell_number(table, i, 2), 2.385 * (double)(i + 1), 0, 1e-8);
    }
    ssfr_csv_table_destroy(&table);
    assert_null(table);
}

static void numbers_have_nine_digits_or_are_named(void **state)
{
    (void)state;
    const char *path = test_path("numbers.csv");
    static const char *const one[] = {"x"};
    static const double values[] = {1.0 / 3, 2.385e-300, 1234567890123.0, 0, -0.0, 40, NAN, INFINITY, -INFINITY};
    ssfr_csv *csv = NULL;
    size_t size;
    assert_int_equal(ssfr_csv_create(&csv, path, 1, one, 1, false), SSFR_OK);
    for (size_t i = 0; i < SSFR_COUNT(values); i++) {
        assert_int_equal(ssfr_csv_number(csv, values[i]), SSFR_OK);
        assert_int_equal(ssfr_csv_end_row(csv), SSFR_OK);
    }
    ssfr_csv_destroy(&csv);
    char *text = text_of(path, &size);
    assert_string_equal(text, "x\n0.333333333\n2.385e-300\n1.23456789e+12\n0\n-0\n40\nNaN\ninf\n-inf\n");
    free(text);
}

static void special_numbers_are_read_back_and_words_are_no_numbers(void **state)
{
    (void)state;
    const char *path = test_path("special.csv");
    static const char text[] = "a,b,c,d\nNaN,inf,2.385 m,\n";
    ssfr_csv_table *table = NULL;
    test_write_file(path, text, sizeof text - 1);
    assert_int_equal(ssfr_csv_load(&table, path), SSFR_OK);
    assert_true(isnan(ssfr_csv_cell_number(table, 0, 0)));
    assert_true(isinf(ssfr_csv_cell_number(table, 0, 1)));
    assert_true(isnan(ssfr_csv_cell_number(table, 0, 2)));
    assert_true(isnan(ssfr_csv_cell_number(table, 0, 3)));
    ssfr_csv_table_destroy(&table);
}

static void a_column_is_found_with_and_without_its_unit(void **state)
{
    (void)state;
    const char *path = test_path("columns.csv");
    static const char text[] = "flow.dt [m^2],flow.dt2,ms\n1,2,3\n";
    ssfr_csv_table *table = NULL;
    test_write_file(path, text, sizeof text - 1);
    assert_int_equal(ssfr_csv_load(&table, path), SSFR_OK);
    assert_int_equal(ssfr_csv_column(table, "flow.dt"), 0);
    assert_int_equal(ssfr_csv_column(table, "flow.dt [m^2]"), 0);
    assert_int_equal(ssfr_csv_column(table, "flow.dt2"), 1);
    assert_int_equal(ssfr_csv_column(table, "m"), -1);
    assert_int_equal(ssfr_csv_column(table, ""), -1);
    ssfr_csv_table_destroy(&table);
}

static void carriage_returns_before_line_feeds_are_read(void **state)
{
    (void)state;
    const char *path = test_path("crlf.csv");
    static const char text[] = "a,b\r\n1,\"2\"\r\n3,4\r\n";
    ssfr_csv_table *table = NULL;
    test_write_file(path, text, sizeof text - 1);
    assert_int_equal(ssfr_csv_load(&table, path), SSFR_OK);
    assert_int_equal(table->n_rows, 2);
    assert_string_equal(table->cells[1], "b");
    assert_string_equal(ssfr_csv_cell(table, 0, 1), "2");
    assert_string_equal(ssfr_csv_cell(table, 1, 1), "4");
    assert_int_equal(table->whole, sizeof text - 1);
    ssfr_csv_table_destroy(&table);
}

static void malformed_tables_are_refused_with_their_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"a,b\n1,2\n3\n", "bad.csv:3: 1 cells, the header has 2"},
        {"a,b\n1,2,3\n", "bad.csv:2: 3 cells, the header has 2"},
        {"a,b\n1,\"2\"x\n", "bad.csv:2: expected a comma or the line's end at byte 9"},
        {"a,b\n1\"2,3\n", "bad.csv:2: expected a comma"},
        {"a,b\n\"x\ny\",2\n3\n", "bad.csv:4: 1 cells"},
        {"a,b\n\n", "bad.csv:2: 1 cells, the header has 2"},
    };
    const char *path = test_path("bad.csv");
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_csv_table *table = NULL;
        test_write_file(path, cases[i].text, strlen(cases[i].text));
        assert_fails(SSFR_ERR_FORMAT, ssfr_csv_load(&table, path), cases[i].message);
        assert_null(table);
    }
    ssfr_csv_table *table = NULL;
    test_write_file(path, "a\n1\0\n", 5);
    assert_fails(SSFR_ERR_FORMAT, ssfr_csv_load(&table, path), "a zero byte at byte 3");
    assert_fails(SSFR_ERR_IO, ssfr_csv_load(&table, test_path("absent.csv")), "absent.csv");
}

static void a_table_cut_at_any_byte_keeps_its_whole_lines(void **state)
{
    (void)state;
    const char *path = test_path("whole.csv"), *cut = test_path("cut.csv");
    size_t size;
    fill(path, false);
    char *text = text_of(path, &size);
    for (size_t n = 0; n <= size; n++) {
        ssfr_csv_table *table = NULL;
        test_write_file(cut, text, n);
        assert_int_equal(ssfr_csv_load(&table, cut), SSFR_OK);
        assert_true(table->whole <= n);
        assert_true(table->whole == 0 || text[table->whole - 1] == '\n');
        assert_true(table->n_rows <= SSFR_COUNT(keys));
        ssfr_csv_table_destroy(&table);
    }
    free(text);
}

static void a_table_cut_at_any_byte_is_resumed_with_every_row_once(void **state)
{
    (void)state;
    const char *path = test_path("full.csv"), *cut = test_path("resumed.csv");
    size_t size, again;
    fill(path, false);
    char *text = text_of(path, &size);
    for (size_t n = 0; n <= size; n++) {
        test_write_file(cut, text, n);
        const int written = fill(cut, true);
        assert_true((written == 0) == (n == size));
        char *resumed = text_of(cut, &again);
        assert_string_equal(resumed, text);
        free(resumed);
    }
    free(text);
}

static void rows_are_found_in_any_order(void **state)
{
    (void)state;
    const char *path = test_path("order.csv");
    ssfr_csv *csv = NULL;
    fill(path, false);
    assert_int_equal(ssfr_csv_create(&csv, path, N_COLUMNS, columns, N_KEYS, true), SSFR_OK);
    for (int i = (int)SSFR_COUNT(keys) - 1; i >= 0; i--) assert_true(ssfr_csv_has(csv, keys[i]));
    assert_false(ssfr_csv_has(csv, (const char *const[]){"a,b", "2x2"}));
    assert_false(ssfr_csv_has(csv, (const char *const[]){"other", "1x1"}));
    ssfr_csv_destroy(&csv);
}

static void without_resume_an_old_table_is_replaced(void **state)
{
    (void)state;
    const char *path = test_path("replaced.csv");
    fill(path, false);
    assert_int_equal(fill(path, false), 5);
    assert_int_equal(fill(path, true), 0);
}

static void another_header_is_not_resumed(void **state)
{
    (void)state;
    const char *path = test_path("header.csv");
    static const char *const renamed[] = {"key", "area", "value [m^2]"}, *const more[] = {"key", "size", "value [m^2]",
                                                                                          "x"};
    ssfr_csv *csv = NULL;
    size_t before, after;
    fill(path, false);
    char *text = text_of(path, &before);
    assert_fails(SSFR_ERR_VALUE, ssfr_csv_create(&csv, path, 3, renamed, 2, true), "column 2 is size, expected area");
    assert_null(csv);
    assert_fails(SSFR_ERR_VALUE, ssfr_csv_create(&csv, path, 4, more, 2, true), "column 4 is missing, expected x");
    assert_fails(SSFR_ERR_VALUE, ssfr_csv_create(&csv, path, 2, columns, 2, true),
                 "column 3 is value [m^2], expected none");
    char *untouched = text_of(path, &after);
    assert_string_equal(untouched, text);
    free(untouched);
    free(text);
}

static void a_table_has_one_writer(void **state)
{
    (void)state;
    const char *path = test_path("busy.csv");
    ssfr_csv *first = NULL, *second = NULL;
    fill(path, false);
    assert_int_equal(ssfr_csv_create(&first, path, N_COLUMNS, columns, N_KEYS, true), SSFR_OK);
    assert_fails(SSFR_ERR_IO, ssfr_csv_create(&second, path, N_COLUMNS, columns, N_KEYS, false),
                 "busy.csv: another process is writing it");
    ssfr_csv_destroy(&first);
    assert_int_equal(fill(path, true), 0);
}

static void a_place_that_cannot_be_written_is_an_error(void **state)
{
    (void)state;
    ssfr_csv *csv = NULL;
    const char *folder = test_path("folder");
    assert_int_equal(mkdir(folder, 0777), 0);
    assert_fails(SSFR_ERR_IO, ssfr_csv_create(&csv, folder, N_COLUMNS, columns, N_KEYS, false), "folder");
    assert_int_equal(rmdir(folder), 0);
    assert_fails(SSFR_ERR_IO, ssfr_csv_create(&csv, test_path("absent/x.csv"), N_COLUMNS, columns, N_KEYS, false),
                 "absent/x.csv");
    assert_fails(SSFR_ERR_IO, ssfr_csv_create(&csv, "/dev/full", N_COLUMNS, columns, N_KEYS, false), "/dev/full");
}

/* The limit makes the file system full in the middle of a row. */
static void a_row_that_does_not_fit_is_taken_back(void **state)
{
    (void)state;
    const char *path = test_path("full_disk.csv");
    struct rlimit limit, small;
    ssfr_csv *csv = NULL;
    ssfr_csv_table *table = NULL;
    assert_int_equal(ssfr_csv_create(&csv, path, N_COLUMNS, columns, N_KEYS, false), SSFR_OK);
    assert_int_equal(write_row(csv, "fits", "1x1", 2.385), SSFR_OK);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    small = limit;
    small.rlim_cur = 48;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    assert_fails(SSFR_ERR_IO, write_row(csv, "a row that is longer than the room left", "1x1", 2.385), "full_disk.csv");
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    signal(SIGXFSZ, SIG_DFL);
    assert_int_equal(write_row(csv, "next", "2x2", 4.77), SSFR_OK);
    ssfr_csv_destroy(&csv);
    assert_int_equal(ssfr_csv_load(&table, path), SSFR_OK);
    assert_int_equal(table->n_rows, 2);
    assert_string_equal(ssfr_csv_cell(table, 1, 0), "next");
    ssfr_csv_table_destroy(&table);
}

static void without_a_path_the_table_goes_to_standard_output(void **state)
{
    (void)state;
    const char *path = test_path("stdout.txt");
    ssfr_csv *csv = NULL;
    size_t size;
    fflush(stdout);
    const int kept = dup(STDOUT_FILENO);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    dup2(fileno(file), STDOUT_FILENO);
    const ssfr_result created = ssfr_csv_create(&csv, NULL, N_COLUMNS, columns, N_KEYS, false);
    const ssfr_result written = write_row(csv, "x", "1x1", 2.385);
    ssfr_csv_destroy(&csv);
    dup2(kept, STDOUT_FILENO);
    close(kept);
    fclose(file);
    assert_int_equal(created, SSFR_OK);
    assert_int_equal(written, SSFR_OK);
    char *text = text_of(path, &size);
    assert_string_equal(text, "key,size,value [m^2]\nx,1x1,2.385\n");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_table_is_written_as_rfc_4180_says),
        cmocka_unit_test(every_cell_is_read_back),
        cmocka_unit_test(numbers_have_nine_digits_or_are_named),
        cmocka_unit_test(special_numbers_are_read_back_and_words_are_no_numbers),
        cmocka_unit_test(a_column_is_found_with_and_without_its_unit),
        cmocka_unit_test(carriage_returns_before_line_feeds_are_read),
        cmocka_unit_test(malformed_tables_are_refused_with_their_line),
        cmocka_unit_test(a_table_cut_at_any_byte_keeps_its_whole_lines),
        cmocka_unit_test(a_table_cut_at_any_byte_is_resumed_with_every_row_once),
        cmocka_unit_test(rows_are_found_in_any_order),
        cmocka_unit_test(without_resume_an_old_table_is_replaced),
        cmocka_unit_test(another_header_is_not_resumed),
        cmocka_unit_test(a_table_has_one_writer),
        cmocka_unit_test(a_place_that_cannot_be_written_is_an_error),
        cmocka_unit_test(a_row_that_does_not_fit_is_taken_back),
        cmocka_unit_test(without_a_path_the_table_goes_to_standard_output),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

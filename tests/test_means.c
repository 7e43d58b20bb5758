/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_means.c: tables averaged over one of their keys. */
#include "experiments/csv.h"
#include "experiments/means.h"
#include "tests/util.h"

static const char *const columns[] = {"ms", "error"};

static const char *write_table(const char *text)
{
    const char *path = test_path("t.csv");
    test_write_file(path, text, strlen(text));
    return path;
}

static void assert_means(const char *table, const char *expected)
{
    char text[1024] = "";
    assert_int_equal(ssfr_means_save(write_table(table), "view", 2, columns), SSFR_OK);
    FILE *file = fopen(test_path("t_mean.csv"), "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    assert_string_equal(text, expected);
}

static void rows_of_all_views_become_one(void **state)
{
    (void)state;
    assert_means("variant,view,scene,status,camera,ms,error [m]\n"
                 "a,0,x,ok,c,1,0.5\n"
                 "a,1,x,ok,c,4,0.25\n"
                 "b,0,x,ok,c,7,1\n"
                 "a,0,y,ok,c,8,2\n"
                 "b,1,x,ok,c,9,3\n",
                 "variant,scene,status,rows,ms,error [m]\n"
                 "a,x,ok,2,2.5,0.375\n"
                 "b,x,ok,2,8,2\n"
                 "a,y,ok,1,8,2\n");
}

static void what_failed_or_is_no_number_does_not_count(void **state)
{
    (void)state;
    assert_means("view,variant,status,ms,error\n"
                 "0,a,ok,1,NaN\n"
                 "1,a,out of memory,100,100\n"
                 "2,a,ok,2,inf\n"
                 "3,a,ok,3,\n"
                 "0,b,out of memory,1,1\n",
                 "variant,status,rows,ms,error\n"
                 "a,ok,3,2,NaN\n"
                 "b,no row is ok,0,NaN,NaN\n");
    assert_means("view,status,ms,error\n", "status,rows,ms,error\n");
}

static void tables_without_such_columns_are_refused(void **state)
{
    (void)state;
    static const struct {
        ssfr_result code;
        const char *table, *message;
    } cases[] = {
        {SSFR_ERR_UNKNOWN, "variant,status,ms,error\n", "t.csv: has no column view"},
        {SSFR_ERR_UNKNOWN, "view,ms,error\n", "t.csv: has no column status"},
        {SSFR_ERR_UNKNOWN, "view,status,ms\n", "t.csv: has no column error"},
        {SSFR_ERR_UNKNOWN, "variant,status,view,ms,error\n", "t.csv: view is no key of it"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        assert_fails(cases[i].code, ssfr_means_save(write_table(cases[i].table), "view", 2, columns),
                     cases[i].message);
    assert_fails(SSFR_ERR_IO, ssfr_means_save("/nowhere/t.csv", "view", 2, columns), "/nowhere/t.csv");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_of_all_views_become_one),
        cmocka_unit_test(what_failed_or_is_no_number_does_not_count),
        cmocka_unit_test(tables_without_such_columns_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

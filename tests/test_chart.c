/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_chart.c: charts hold the curves that the table's rows make, and nothing else. */
#include "experiments/chart.h"
#include "tests/util.h"

#include <unistd.h>

static const char rows[] = "case,threads,particles,status,ms_median,share [1],zero\n"
                           "pool,1,1000,ok,2.5,0.2,0\n"
                           "pool,1,8000,ok,20,0.3,0\n"
                           "it's <odd> & long,1,1000,ok,3,0.25,0\n"
                           "pool,2,1000,ok,1.5,0.1,0\n"
                           "pool,4,1000,out of memory,1e9,0.1,0\n"
                           "dam,2,4000,ok,-7,0.15,0\n"
                           "dam,2,9000,ok,NaN,0.35,0\n";

/* Draws one chart of the rows; NULL when none was written. To free(). */
static char *drawn(int n_panels, const ssfr_panel *panels)
{
    const char *table_path = test_path("table.csv"), *path = test_path("chart.svg");
    ssfr_csv_table *table = NULL;
    char *text = NULL;
    size_t size;
    if (access("/usr/bin/gnuplot", X_OK) != 0) skip();
    test_write_file(table_path, rows, strlen(rows));
    assert_int_equal(ssfr_csv_load(&table, table_path), SSFR_OK);
    unlink(path);
    assert_int_equal(ssfr_chart_save(path, table, "Isn't `it` a \\n \"chart\"?", n_panels, panels), SSFR_OK);
    if (access(path, F_OK) == 0) assert_int_equal(ssfr_read_file(path, 1 << 22, &text, &size), SSFR_OK);
    ssfr_csv_table_destroy(&table);
    return text;
}

static void assert_holds(const char *svg, const char *text, bool expected)
{
    assert_non_null(svg);
    if ((strstr(svg, text) != NULL) != expected) fail_msg("the chart %s %s", expected ? "lacks" : "holds", text);
}

static const ssfr_panel times = {.title = "Times & more", .x = "particles", .y = "ms_median", .x_label = "how many",
                                 .y_label = "how long [ms]", .log_x = true, .log_y = true,
                                 .keys = {{"case", NULL}, {"threads", "on "}}, .levels = {2.385},
                                 .level_text = "a line", .mark = {5000, 5}, .mark_text = "an aim"};

static void a_chart_names_what_it_shows(void **state)
{
    (void)state;
    static const char *const parts[] = {"Isn't `it` a \\n \"chart\"?", "Times &amp; more", "how many", "how long [ms]",
                                        "pool, on 1", "pool, on 2", "it's &lt;odd> &amp; long, on 1", "a line",
                                        "an aim", "</svg>"};
    char *svg = drawn(1, &times);
    for (size_t i = 0; i < SSFR_COUNT(parts); i++) assert_holds(svg, parts[i], true);
    free(svg);
}

static void rows_that_failed_or_have_no_place_are_left_out(void **state)
{
    (void)state;
    char *svg = drawn(1, &times);
    assert_holds(svg, "pool, on 4", false); /* not ok */
    assert_holds(svg, "dam, on 2", false);  /* below 0 on a logarithmic axis, or not a number */
    free(svg);
    ssfr_panel panel = times;
    panel.log_y = false;
    svg = drawn(1, &panel);
    assert_holds(svg, "dam, on 2", true);
    free(svg);
}

static void a_panel_shows_the_rows_that_it_asks_for(void **state)
{
    (void)state;
    ssfr_panel panel = times;
    panel.only[0].column = "case", panel.only[0].cell = "pool";
    char *svg = drawn(1, &panel);
    assert_holds(svg, "pool, on 2", true);
    assert_holds(svg, "odd", false);
    free(svg);
    panel.only[1].column = "threads", panel.only[1].cell = "1";
    svg = drawn(1, &panel);
    assert_holds(svg, "pool, on 1", true);
    assert_holds(svg, "pool, on 2", false);
    free(svg);
    panel.only[2].column = "threads", panel.only[2].cell = "2"; /* either */
    svg = drawn(1, &panel);
    assert_holds(svg, "pool, on 1", true);
    assert_holds(svg, "pool, on 2", true);
    free(svg);
}

static void panels_stand_side_by_side(void **state)
{
    (void)state;
    const ssfr_panel panels[] = {times,
                                 {.title = "Shares", .x = "particles", .y = "share", .x_label = "how many",
                                  .y_label = "how much [%]", .y_factor = 100, .keys = {{"case", "of "}}}};
    char *svg = drawn(2, panels);
    assert_holds(svg, "pool, on 1", true);
    assert_holds(svg, "of dam", true);
    assert_holds(svg, "<text> 35<", true); /* 0.35 is 35 % */
    free(svg);
}

static void a_panel_without_points_is_a_warning(void **state)
{
    (void)state;
    ssfr_panel panel = times;
    panel.y = "zero";
    test_clear_log();
    assert_null(drawn(1, &panel));
    assert_int_equal(test_n_errors(), 0);
}

static void a_column_that_is_missing_is_an_error(void **state)
{
    (void)state;
    const char *table_path = test_path("table.csv"), *path = test_path("missing.svg");
    ssfr_csv_table *table = NULL;
    test_write_file(table_path, rows, strlen(rows));
    assert_int_equal(ssfr_csv_load(&table, table_path), SSFR_OK);
    ssfr_panel panels[4] = {times, times, times, times};
    panels[0].x = panels[1].y = panels[2].keys[1].column = panels[3].only[0].column = "nothing";
    for (int i = 0; i < 4; i++) {
        const ssfr_panel both[] = {times, panels[i]};
        assert_fails(SSFR_ERR_UNKNOWN, ssfr_chart_save(path, table, "", 2, both), "the table has no column nothing");
    }
    assert_int_equal(access(path, F_OK), -1);
    ssfr_csv_table_destroy(&table);
}

/* One more curve than there can be. */
static void too_many_curves_are_an_error(void **state)
{
    (void)state;
    char text[4096] = "particles,ms_median\n";
    const char *path = test_path("many.csv");
    ssfr_csv_table *table = NULL;
    for (int i = 0; i <= SSFR_CHART_CURVES; i++) sprintf(text + strlen(text), "%d,2.385\n", i + 1);
    test_write_file(path, text, strlen(text));
    assert_int_equal(ssfr_csv_load(&table, path), SSFR_OK);
    const ssfr_panel panel = {.title = "", .x = "particles", .y = "ms_median", .x_label = "", .y_label = "",
                              .keys = {{"particles", NULL}}};
    assert_fails(SSFR_ERR_VALUE, ssfr_chart_save(test_path("many.svg"), table, "", 1, &panel),
                 "more than 24 curves, the next is 25");
    ssfr_csv_table_destroy(&table);
}

static void a_place_that_cannot_be_written_is_an_error(void **state)
{
    (void)state;
    const char *table_path = test_path("table.csv");
    ssfr_csv_table *table = NULL;
    if (access("/usr/bin/gnuplot", X_OK) != 0) skip();
    test_write_file(table_path, rows, strlen(rows));
    assert_int_equal(ssfr_csv_load(&table, table_path), SSFR_OK);
    assert_fails(SSFR_ERR_IO, ssfr_chart_save(test_path("absent/chart.svg"), table, "", 1, &times), "absent/chart.svg");
    ssfr_csv_table_destroy(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chart_names_what_it_shows),
        cmocka_unit_test(rows_that_failed_or_have_no_place_are_left_out),
        cmocka_unit_test(a_panel_shows_the_rows_that_it_asks_for),
        cmocka_unit_test(panels_stand_side_by_side),
        cmocka_unit_test(a_panel_without_points_is_a_warning),
        cmocka_unit_test(a_column_that_is_missing_is_an_error),
        cmocka_unit_test(too_many_curves_are_an_error),
        cmocka_unit_test(a_place_that_cannot_be_written_is_an_error),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

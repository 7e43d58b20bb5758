/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_plot.c: fronts, and drawings that hold what the table says. */
#include "experiments/columns.h"
#include "experiments/plot.h"
#include "tests/util.h"

#include <unistd.h>

static void a_front_holds_what_nothing_else_beats(void **state)
{
    (void)state;
    ssfr_point points[] = {{3, 1, 0, false}, {1, 4, 1, false}, {2, 2.385, 2, false}, {2.5, 2.385, 3, false},
                           {4, 1, 4, false}, {2, 5, 5, false}, {1, 4, 6, false}};
    bool front[7] = {false};
    ssfr_plot_front(points, 7);
    for (size_t i = 0; i < 7; i++) front[points[i].line] = points[i].front;
    const bool expected[7] = {true, true, true, false, false, false, true};
    assert_memory_equal(front, expected, sizeof front);
}

/* Against the definition, point by point. */
static void a_front_agrees_with_its_definition(void **state)
{
    (void)state;
    enum { N = 200 };
    ssfr_point points[N];
    uint64_t seed = 2385;
    int n_front = 0;
    for (size_t i = 0; i < N; i++)
        points[i] =
            (ssfr_point){.x = floor(test_random(&seed, 0, 30)), .y = floor(test_random(&seed, 0, 30)), .line = i};
    ssfr_plot_front(points, N);
    for (size_t i = 0; i < N; i++) {
        bool beaten = false;
        for (size_t k = 0; k < N; k++)
            beaten |= points[k].x <= points[i].x && points[k].y <= points[i].y &&
                      (points[k].x < points[i].x || points[k].y < points[i].y);
        assert_int_equal(points[i].front, !beaten);
        n_front += points[i].front;
    }
    assert_true(n_front > 1 && n_front < N);
}

static void a_header_names_the_unit_once(void **state)
{
    (void)state;
    char text[64];
    static const char *const cases[][3] = {{"flow.dt", "m^2", "flow.dt [m^2]"}, {"ms_median", "ms", "ms_median"},
                                           {"normal_deg", "deg", "normal_deg"}, {"ref_iou", "1", "ref_iou"},
                                           {"form", "m", "form [m]"},           {"m", "m", "m [m]"}};
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_column_header(cases[i][0], cases[i][1], text, sizeof text);
        assert_string_equal(text, cases[i][2]);
    }
}

static void columns_are_found_by_name_and_in_order(void **state)
{
    (void)state;
    for (int i = 0; i < SSFR_N_COLUMNS; i++) assert_ptr_equal(ssfr_column_find(ssfr_columns[i].name), &ssfr_columns[i]);
    assert_string_equal(ssfr_columns[SSFR_COLUMN_ref_psnr].name, "ref_psnr");
    assert_null(ssfr_column_find("speed"));
}

static const char rows[] = "splat.kind,flow.step [1],backend,status,ms_median,ref_normal_mean_deg,ref_psnr [dB],zero\n"
                           "point,1,gl,ok,10,20,30,0\n"
                           "point,2,gl,ok,20,10,35,0\n"
                           "point,3,gl,ok,30,15,33,0\n"
                           "quad,1,gl,ok,15,18,31,0\n"
                           "quad,2,gl,out of memory,NaN,NaN,NaN,0\n"
                           "quad,3,gl,ok,25,0,inf,0\n"
                           "\"it's <odd> & \"\"quoted\"\"\",1,gl,ok,100,5,40,0\n";

static ssfr_csv_table *table_of(const char *text)
{
    ssfr_csv_table *table = NULL;
    const char *path = test_path("table.csv");
    test_write_file(path, text, strlen(text));
    assert_int_equal(ssfr_csv_load(&table, path), SSFR_OK);
    return table;
}

static ssfr_plot_spec spec_of(char *title, char *x, char *y)
{
    static char kind[] = "splat.kind", backend[] = "backend";
    return (ssfr_plot_spec){.title = title, .x = x, .y = y, .n_lines = 2, .lines = {kind, backend}};
}

static char *drawn(const char *name, ssfr_plot_spec spec)
{
    const char *path = test_path(name);
    ssfr_csv_table *table = table_of(rows);
    char *text = NULL;
    size_t size;
    if (access("/usr/bin/gnuplot", X_OK) != 0) skip();
    assert_int_equal(ssfr_plot_save(path, table, &spec), SSFR_OK);
    assert_int_equal(ssfr_read_file(path, 1 << 22, &text, &size), SSFR_OK);
    ssfr_csv_table_destroy(&table);
    return text;
}

static void a_plot_names_what_it_shows(void **state)
{
    (void)state;
    char title[] = "Isn't `work` \\n worth \"it\"?", x[] = "ref_normal_mean_deg", y[] = "ms_median";
    char *svg = drawn("plot.svg", spec_of(title, x, y));
    static const char *const parts[] = {"Isn't `work` \\n worth \"it\"?", "normal: mean angle to the reference's [deg]",
                                        "median time of a frame [ms]",    "kind point, gl",
                                        "kind quad, gl",                  "kind it's &lt;odd> &amp; \"quoted\", gl",
                                        "Pareto front",                   "2 of 7 runs failed or have no value to draw",
                                        "</svg>"};
    for (size_t i = 0; i < SSFR_COUNT(parts); i++)
        if (!strstr(svg, parts[i])) fail_msg("the drawing lacks %s", parts[i]);
    free(svg);
}

/* px from the left: the drawing moves to each text before it writes it. */
static double place_of(const char *svg, const char *text)
{
    const char *end = strstr(svg, text), *move = NULL;
    assert_non_null(end);
    for (const char *at = strstr(svg, "translate("); at && at < end; at = strstr(at + 1, "translate(")) move = at;
    assert_non_null(move);
    return strtod(move + strlen("translate("), NULL);
}

static void a_measure_that_grows_for_the_better_is_turned_round(void **state)
{
    (void)state;
    char title[] = "quality", x[] = "ref_psnr", y[] = "ms_median";
    char *svg = drawn("psnr.svg", spec_of(title, x, y));
    assert_non_null(strstr(svg, "colour: PSNR to the reference [dB]"));
    assert_non_null(strstr(svg, "2 of 7 runs failed"));
    assert_true(place_of(svg, "<text> 30<") > place_of(svg, "<text> 40<"));
    free(svg);
}

static void a_column_that_is_missing_is_an_error(void **state)
{
    (void)state;
    char x[] = "ref_nothing", y[] = "ms_median", good[] = "ref_psnr";
    ssfr_csv_table *table = table_of(rows);
    ssfr_plot_spec spec = spec_of(NULL, x, y);
    const char *path = test_path("missing.svg");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_plot_save(path, table, &spec), "plot: the table has no column ref_nothing");
    spec = spec_of(NULL, good, x);
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_plot_save(path, table, &spec), "no column ref_nothing");
    spec = spec_of(NULL, good, y);
    spec.lines[1] = x;
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_plot_save(path, table, &spec), "no column ref_nothing");
    assert_int_not_equal(access(path, F_OK), 0);
    ssfr_csv_table_destroy(&table);
}

static void more_lines_than_can_be_told_apart_are_refused(void **state)
{
    (void)state;
    char text[4096] = "name,x,y\n", name[] = "name", x[] = "x", y[] = "y";
    for (int i = 0; i < 65; i++) snprintf(text + strlen(text), 32, "n%d,%d,2.385\n", i, i + 1);
    ssfr_csv_table *table = table_of(text);
    const ssfr_plot_spec spec = {.x = x, .y = y, .n_lines = 1, .lines = {name}};
    assert_fails(SSFR_ERR_VALUE, ssfr_plot_save(test_path("many.svg"), table, &spec),
                 "more than 64 lines, the next is name n64");
    ssfr_csv_table_destroy(&table);
}

static void a_table_with_nothing_to_draw_is_a_warning(void **state)
{
    (void)state;
    char x[] = "zero", y[] = "ms_median";
    const char *path = test_path("nothing.svg");
    ssfr_csv_table *table = table_of(rows);
    const ssfr_plot_spec spec = spec_of(NULL, x, y);
    test_clear_log();
    assert_int_equal(ssfr_plot_save(path, table, &spec), SSFR_OK);
    assert_int_equal(test_n_errors(), 0);
    assert_int_not_equal(access(path, F_OK), 0);
    ssfr_csv_table_destroy(&table);
}

static void without_gnuplot_nothing_is_drawn_and_nothing_fails(void **state)
{
    (void)state;
    char x[] = "ref_psnr", y[] = "ms_median", kept[4096];
    const char *path = test_path("none.svg");
    ssfr_csv_table *table = table_of(rows);
    const ssfr_plot_spec spec = spec_of(NULL, x, y);
    snprintf(kept, sizeof kept, "%s", getenv("PATH"));
    setenv("PATH", "/nowhere", 1);
    test_clear_log();
    const ssfr_result result = ssfr_plot_save(path, table, &spec);
    setenv("PATH", kept, 1);
    assert_int_equal(result, SSFR_OK);
    assert_int_equal(test_n_errors(), 0);
    assert_int_not_equal(access(path, F_OK), 0);
    ssfr_csv_table_destroy(&table);
}

static void a_folder_that_is_missing_is_an_error(void **state)
{
    (void)state;
    char x[] = "ref_psnr", y[] = "ms_median";
    ssfr_csv_table *table = table_of(rows);
    const ssfr_plot_spec spec = spec_of(NULL, x, y);
    if (access("/usr/bin/gnuplot", X_OK) != 0) skip();
    assert_fails(SSFR_ERR_IO, ssfr_plot_save(test_path("absent/plot.svg"), table, &spec),
                 "absent/plot.svg: gnuplot failed");
    ssfr_csv_table_destroy(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_front_holds_what_nothing_else_beats),
        cmocka_unit_test(a_front_agrees_with_its_definition),
        cmocka_unit_test(a_header_names_the_unit_once),
        cmocka_unit_test(columns_are_found_by_name_and_in_order),
        cmocka_unit_test(a_plot_names_what_it_shows),
        cmocka_unit_test(a_measure_that_grows_for_the_better_is_turned_round),
        cmocka_unit_test(a_column_that_is_missing_is_an_error),
        cmocka_unit_test(more_lines_than_can_be_told_apart_are_refused),
        cmocka_unit_test(a_table_with_nothing_to_draw_is_a_warning),
        cmocka_unit_test(without_gnuplot_nothing_is_drawn_and_nothing_fails),
        cmocka_unit_test(a_folder_that_is_missing_is_an_error),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_chart.c: charts hold the curves that the table's rows make, and nothing else. */
#include "experiments/chart.h"
#include "experiments/gnuplot.h"
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

/* Draws one chart of a table; NULL when none was written. To free(). */
static char *drawn_of(const char *rows_of_it, int n_panels, const ssfr_panel *panels)
{
    const char *table_path = test_path("table.csv"), *path = test_path("chart.svg");
    ssfr_csv_table *table = NULL;
    char *text = NULL;
    size_t size;
    if (access("/usr/bin/gnuplot", X_OK) != 0) skip();
    test_write_file(table_path, rows_of_it, strlen(rows_of_it));
    assert_int_equal(ssfr_csv_load(&table, table_path), SSFR_OK);
    unlink(path);
    assert_int_equal(ssfr_chart_save(path, table, "Isn't `it` a \\n \"chart\"?", n_panels, panels), SSFR_OK);
    if (access(path, F_OK) == 0) assert_int_equal(ssfr_read_file(path, 1 << 22, &text, &size), SSFR_OK);
    ssfr_csv_table_destroy(&table);
    return text;
}

static char *drawn(int n_panels, const ssfr_panel *panels)
{
    return drawn_of(rows, n_panels, panels);
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

/* ---- keys and labels --------------------------------------------------------------------------------------------- */

typedef struct place {
    double x, y; /* px from the drawing's upper left corner */
} place;

/* Where a text begins, or its middle; fails where it is not written. */
static place place_of(const char *svg, const char *text)
{
    char tag[256];
    place p = {0};
    snprintf(tag, sizeof tag, "<text>%s<", text);
    const char *end = strstr(svg, tag), *move = NULL;
    if (!end) fail_msg("the chart lacks %s", text);
    for (const char *at = strstr(svg, "translate("); at && at < end; at = strstr(at + 1, "translate(")) move = at;
    assert_int_equal(sscanf(move, "translate(%lf,%lf)", &p.x, &p.y), 2);
    return p;
}

static double height_of(const char *svg)
{
    double size[2];
    assert_int_equal(sscanf(strstr(svg, "viewBox"), "viewBox=\"0 0 %lf %lf\"", &size[0], &size[1]), 2);
    return size[1];
}

enum { PANEL_WIDTH = 620 /* px */ };

static void name_curve(char name[64], int i, int length)
{
    snprintf(name, 64, "%0*d", length, i + 1);
}

/* A chart of n curves beside one of a single curve. */
static char *draw_names(int n, int length)
{
    static const ssfr_panel panels[] = {
        {.title = "Many", .x = "x", .y = "y", .x_label = "across", .y_label = "up", .keys = {{"name", NULL}}},
        {.title = "One", .x = "x", .y = "y", .x_label = "along", .y_label = "up", .keys = {{"kind", NULL}}}};
    char table[4096] = "name,kind,x,y\n", name[64];
    for (int i = 0; i < n; i++) {
        name_curve(name, i, length);
        snprintf(table + strlen(table), sizeof table - strlen(table), "%s,alone,%d,2.385\n", name, i);
    }
    return drawn_of(table, 2, panels);
}

static void assert_key_is_clear(int n, int length)
{
    const double letter = 7.3; /* px, of the key's font */
    char *svg = draw_names(n, length), name[64];
    const double label = place_of(svg, "across").y, height = height_of(svg);
    place places[SSFR_CHART_CURVES];
    assert_true(place_of(svg, "along").y == label);
    for (int i = 0; i < n; i++) {
        name_curve(name, i, length);
        const place p = places[i] = place_of(svg, name);
        if (!(p.y > label + 15 && p.y < height && p.x + letter * length < PANEL_WIDTH))
            fail_msg("%d names of %d: one at %g, %g; label at %g, height %g", n, length, p.x, p.y, label, height);
        for (int k = 0; k < i; k++)
            assert_true(fabs(places[k].y - p.y) > 15 || fabs(places[k].x - p.x) > letter * length);
    }
    free(svg);
}

static void names_of_any_number_and_length_touch_no_label_and_no_other_name(void **state)
{
    (void)state;
    static const int numbers[] = {1, 2, 5, 8, 13, SSFR_CHART_CURVES}, lengths[] = {2, 6, 14, 25, 40, 60};
    for (size_t i = 0; i < SSFR_COUNT(numbers); i++)
        assert_key_is_clear(numbers[i], lengths[SSFR_COUNT(lengths) - 1 - i]);
    for (size_t i = 0; i < SSFR_COUNT(lengths); i++) assert_key_is_clear(9, lengths[i]);
}

static void a_drawing_grows_with_its_key_and_its_frames_do_not_shrink(void **state)
{
    (void)state;
    char *few = draw_names(2, 30), *many = draw_names(9, 30);
    assert_true(height_of(many) > height_of(few) + 100);
    assert_true(place_of(many, "across").y == place_of(few, "across").y);
    free(few);
    free(many);
    for (size_t n = 1; n < 40; n++) {
        const ssfr_gnuplot_key key = ssfr_gnuplot_key_fit(n, 20, 500), longer = ssfr_gnuplot_key_fit(n, 200, 500);
        assert_true(key.rows <= ssfr_gnuplot_key_fit(n + 1, 20, 500).rows && key.rows < n + (n < 3));
        assert_true(longer.rows == n && longer.height >= key.height);
    }
    assert_int_equal(ssfr_gnuplot_key_fit(0, 0, 500).height, 0);
}

static void long_labels_are_broken_between_words_and_units_stay_whole(void **state)
{
    (void)state;
    ssfr_panel panel = times;
    panel.y_label = "what a reader who knows nothing of it must be told to understand [particle radii]";
    char *svg = drawn(1, &panel);
    assert_holds(svg, panel.y_label, false);
    assert_holds(svg, "what a reader who knows ", true);
    assert_holds(svg, "[particle radii]<", true);
    free(svg);
    assert_int_equal(ssfr_gnuplot_lines(NULL, "", 100, 15), 1);
    assert_int_equal(ssfr_gnuplot_lines(NULL, "oneword", 1, 15), 1);
    assert_int_equal(ssfr_gnuplot_lines(NULL, "a b c", 1, 15), 3);
    assert_int_equal(ssfr_gnuplot_lines(NULL, "a b c", 1000, 15), 1);
    assert_int_equal(ssfr_gnuplot_lines(NULL, "a [b c] d", 1, 15), 3);
    assert_int_equal(ssfr_gnuplot_lines(NULL, "a [b c d", 1, 15), 2);
}

static size_t n_of(const char *svg, const char *text)
{
    size_t n = 0;
    for (const char *at = strstr(svg, text); at; at = strstr(at + 1, text)) n++;
    return n;
}

/* Nine curves of five kinds, for which there are colours enough. */
static void curves_of_one_kind_share_a_colour_where_there_are_too_few(void **state)
{
    (void)state;
    char table[1024] = "kind,half,x,y\n";
    const ssfr_panel panel = {.title = "", .x = "x", .y = "y", .x_label = "", .y_label = "",
                              .keys = {{"kind", NULL}, {"half", NULL}}};
    for (int i = 0; i < 9; i++) sprintf(table + strlen(table), "k%d,h%d,%d,1\n", i / 2, i % 2, i);
    char *svg = drawn_of(table, 1, &panel);
    const char *fifth = strstr(svg, "<text>k4, h0<");
    assert_non_null(fifth);
    assert_true(n_of(svg, "rgb(230, 159,   0)") > 0);  /* the fifth colour */
    assert_true(n_of(svg, "rgb( 86, 180, 233)") == 0); /* the sixth */
    assert_true(n_of(svg, "stroke-dasharray") > 0);
    free(svg);
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
        cmocka_unit_test(names_of_any_number_and_length_touch_no_label_and_no_other_name),
        cmocka_unit_test(a_drawing_grows_with_its_key_and_its_frames_do_not_shrink),
        cmocka_unit_test(long_labels_are_broken_between_words_and_units_stay_whole),
        cmocka_unit_test(curves_of_one_kind_share_a_colour_where_there_are_too_few),
        cmocka_unit_test(a_place_that_cannot_be_written_is_an_error),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_twins.c: the twins of every pass agree on every scene at every corner: being listed is being tested. */
#include "experiments/corners.h"
#include "experiments/stage.h"
#include "graph/twins.h"
#include "tests/gl_host.h"

static const char *const scenes[] = {"sphere", "plane", "block", "far", "empty", "splash"};

enum { W = 64, H = 48, CORNER_SIZE = 256 };

/* ---- corners ----------------------------------------------------------------------------------------------------- */

static const char *const kinds[] = {"none", "one", "two", NULL};

typedef struct made_up {
    int flag, choice, whole, zero;
    unsigned set;
    double real, capped;
} made_up;

static const ssfr_param made_up_rows[] = {
    SSFR_PARAM_FLAG(made_up, flag, 1, "on unless told otherwise"),
    SSFR_PARAM_CHOICE(made_up, choice, kinds, 1, "the middle one"),
    SSFR_PARAM_INT(made_up, whole, "1", 5, 1, 100, "halves are rounded down"),
    SSFR_PARAM_INT(made_up, zero, "1", 0, 0, 100, "twice nothing is nothing"),
    SSFR_PARAM_SET(made_up, set, kinds + 1, 0, "two words"),
    SSFR_PARAM_REAL(made_up, real, "m", 2.385, 0, 100, "a number"),
    SSFR_PARAM_REAL(made_up, capped, "m", 1, 1, 1.5, "a number in a narrow range"),
    SSFR_PARAM_END,
};

static void corners_leave_the_defaults_one_parameter_at_a_time(void **state)
{
    (void)state;
    static const ssfr_pass pass = {.name = "made_up", .params = made_up_rows, .params_size = sizeof(made_up)};
    static const char *const expected[] = {"",          "flag=off",  "choice=none", "choice=two",  "whole=2",
                                           "whole=10",  "set=one",   "set=two",     "set=one,two", "real=1.1925",
                                           "real=4.77", "capped=1.5"};
    char text[CORNER_SIZE];
    for (size_t i = 0; i < SSFR_COUNT(expected); i++) {
        assert_true(ssfr_corner_at(&pass, (int)i, text, sizeof text));
        assert_string_equal(text, expected[i]);
    }
    assert_false(ssfr_corner_at(&pass, SSFR_COUNT(expected), text, sizeof text));
    assert_string_equal(text, "");
}

static void every_corner_is_a_setting_that_its_pass_takes(void **state)
{
    (void)state;
    int n = 0;
    for (int i = 0; ssfr_pass_at(i); i++) {
        char text[CORNER_SIZE], key[2 * CORNER_SIZE];
        ssfr_graph *graph = NULL;
        assert_int_equal(ssfr_graph_create_for_pass(&graph, ssfr_pass_at(i), NULL), SSFR_OK);
        for (int k = 1; ssfr_corner_at(ssfr_pass_at(i), k, text, sizeof text); k++, n++) {
            const size_t length = strcspn(text, "=");
            snprintf(key, sizeof key, "%s.%.*s", ssfr_pass_name(ssfr_pass_at(i)), (int)length, text);
            assert_int_equal(ssfr_graph_set(graph, key, text + length + 1), SSFR_OK);
        }
        ssfr_graph_destroy(&graph);
    }
    assert_true(n > 20);
}

/* ---- twins ------------------------------------------------------------------------------------------------------- */

static ssfr_stage *stage_of(const char *scene)
{
    ssfr_stage *stage = NULL;
    ssfr_stage_options options;
    ssfr_stage_defaults(&options);
    options.size[0] = W, options.size[1] = H;
    assert_int_equal(ssfr_stage_create(&stage, scene, &options), SSFR_OK);
    return stage;
}

/* Compares one pass at one corner; each output that is outside its tolerance is printed. */
static int count_failures(const ssfr_twins *twins, const char *pass, const char *scene, const char *corner)
{
    ssfr_twins_row rows[SSFR_MAX_OUTPUTS] = {0};
    const char *const settings[] = {corner[0] ? corner : NULL, NULL};
    int n = 0, n_failed = 0;
    test_clear_log();
    const ssfr_result result = ssfr_twins_compare(twins, settings, rows, &n);
    if (result == SSFR_ERR_UNSUPPORTED && corner[0]) return 0; /* a limit of this GPU, or what it is told to refuse */
    if (result != SSFR_OK) {
        print_error("%s on %s with \"%s\": %s\n", pass, scene, corner, test_last_error());
        n_failed = 1;
    }
    for (int i = 0; i < n; i++) {
        if (rows[i].ok) continue;
        print_error("%s.%s on %s with \"%s\": largest difference %.3g, outside %.3g + %.3g |cpu| %.3g of the values, "
                    "allowed %.3g, not finite %ld\n",
                    pass, rows[i].output, scene, corner, rows[i].max_abs, rows[i].tolerance.abs, rows[i].tolerance.rel,
                    rows[i].outliers, rows[i].tolerance.outliers, rows[i].n_nan);
        n_failed++;
    }
    if (n == 0) n_failed++;
    ssfr_twins_finish(rows, n);
    return n_failed;
}

/* At every corner; *n counts them. */
static int count_failures_of(const ssfr_pass *pass, const ssfr_stage *stage, ssfr_gl *gl, int *n)
{
    char corner[CORNER_SIZE];
    ssfr_twins *twins = NULL;
    int n_failed = 0;
    assert_int_equal(ssfr_twins_create(&twins, pass, &stage->scene, gl, NULL), SSFR_OK);
    for (int k = 0; ssfr_corner_at(pass, k, corner, sizeof corner); k++, ++*n)
        n_failed += count_failures(twins, ssfr_pass_name(pass), stage->name, corner);
    ssfr_twins_destroy(&twins);
    return n_failed;
}

static void the_twins_of_every_pass_agree_at_every_corner(void **state)
{
    (void)state;
    ssfr_gl *gl = test_gl_or_skip();
    int n_failed = 0, n = 0;
    for (size_t s = 0; s < SSFR_COUNT(scenes); s++) {
        ssfr_stage *stage = stage_of(scenes[s]);
        for (int i = 0; ssfr_pass_at(i); i++)
            if (!ssfr_pass_at(i)->particles_run) /* those have one form for both backends */
                n_failed += count_failures_of(ssfr_pass_at(i), stage, gl, &n);
        ssfr_stage_destroy(&stage);
    }
    ssfr_gl_destroy(&gl);
    print_message("%d comparisons\n", n);
    assert_int_equal(n_failed, 0);
}

static void a_setting_that_a_pass_does_not_have_is_refused(void **state)
{
    (void)state;
    ssfr_gl *gl = test_gl_or_skip();
    ssfr_stage *stage = stage_of("sphere");
    ssfr_twins *twins = NULL;
    ssfr_twins_row rows[SSFR_MAX_OUTPUTS] = {0};
    const char *const unknown[] = {"speed=2.385", NULL}, *const wild[] = {"iterations=-1", NULL};
    const ssfr_pass *pass = ssfr_pass_find("curvature_flow");
    int n = 1;
    assert_int_equal(ssfr_twins_create(&twins, pass, &stage->scene, gl, NULL), SSFR_OK);
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_twins_compare(twins, unknown, rows, &n), "speed");
    assert_int_equal(n, 0);
    assert_fails(SSFR_ERR_VALUE, ssfr_twins_compare(twins, wild, rows, &n), "iterations=-1");
    ssfr_twins_destroy(&twins);
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_twins_create(&twins, pass, &stage->scene, gl, unknown), "speed");
    assert_null(twins);
    assert_fails(SSFR_ERR_UNSUPPORTED,
                 ssfr_twins_create(&twins, ssfr_pass_find("sparse"), &stage->scene, gl, NULL),
                 "sparse: works on particles: it has no twin");
    ssfr_stage_destroy(&stage);
    ssfr_gl_destroy(&gl);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_leave_the_defaults_one_parameter_at_a_time),
        cmocka_unit_test(every_corner_is_a_setting_that_its_pass_takes),
        cmocka_unit_test(the_twins_of_every_pass_agree_at_every_corner),
        cmocka_unit_test(a_setting_that_a_pass_does_not_have_is_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

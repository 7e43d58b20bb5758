/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_downsample.c: each rule on an image made by hand, of odd size and with holes. */
#include "tests/pass_util.h"

enum { W = 7, H = 5 };
#define NONE 1e30

/* Distances; depths are their negatives. */
static const double image[H][W] = {
    {2.5, 3.25, NONE, 4, 1.5, NONE, 2},
    {2.75, 6.125, NONE, NONE, 6.5, 5, NONE},
    {NONE, NONE, 3, 3.5, NONE, NONE, 7.25},
    {NONE, NONE, 4.25, NONE, NONE, NONE, NONE},
    {1.75, 8, NONE, 2.25, NONE, 9.5, 3.75},
};

typedef struct expected {
    const char *factor;
    int w, h;
    double nearest[12], nearest_to_eye[12], sum[12], count[12];
} expected;

/* Of partial blocks at the right and bottom border: the block's middle is brought into the image. */
static const expected rows[] = {
    {"2", 4, 3,
     {6.125, NONE, 5, NONE, NONE, NONE, NONE, NONE, 8, 2.25, 9.5, 3.75},
     {2.5, 4, 1.5, 2, NONE, 3, NONE, 7.25, 1.75, 2.25, 9.5, 3.75},
     {14.625, 4, 13, 2, 0, 10.75, 0, 7.25, 9.75, 2.25, 9.5, 3.75},
     {4, 1, 3, 1, 0, 3, 0, 1, 2, 1, 1, 1}},
    {"4", 2, 2, {3, 7.25, NONE, 3.75}, {2.5, 1.5, 1.75, 3.75}, {29.375, 22.25, 12, 13.25}, {8, 5, 3, 2}},
    {"8", 1, 1, {NONE}, {1.5}, {76.875}, {18}},
};

static test_twin *begin(void **state, const char *factor)
{
    static const double c[1][3] = {{0, 0, -2.385}};
    test_twin *t = test_twin_create(state, "downsample", W, H);
    ssfr_field *depth = test_field(W, H, 1);
    for (int i = 0; i < W * H; i++) depth->data[i] = -image[i / W][i % W];
    test_twin_place(t, 1, c, 0.1, NULL);
    test_twin_give(t, "depth", depth);
    test_twin_set(t, "factor", "%s", factor);
    return t;
}

/* Depths are sums of eighths, exact in both twins; a mean divides, which rounds once, or thrice where the GPU
 * multiplies by an inverse. */
static void each_rule_gives_what_a_hand_finds(void **state)
{
    for (size_t i = 0; i < SSFR_COUNT(rows); i++) {
        const expected *e = &rows[i];
        test_twin *t = begin(state, e->factor);
        test_twin_set(t, "rule", "nearest");
        const ssfr_field *nearest = test_twin_run(t, "low");
        assert_int_equal(nearest->w, e->w);
        assert_int_equal(nearest->h, e->h);
        test_twin_set(t, "rule", "nearest_to_eye");
        const ssfr_field *to_eye = test_twin_run(t, "low");
        test_twin_set(t, "rule", "mean");
        const ssfr_field *mean = test_twin_run(t, "low");
        for (int k = 0; k < e->w * e->h; k++) {
            assert_close(nearest->data[k], -e->nearest[k], 0, e->nearest[k] == NONE ? 1e-7 : 0);
            assert_close(to_eye->data[k], -e->nearest_to_eye[k], 0, e->nearest_to_eye[k] == NONE ? 1e-7 : 0);
            if (e->count[k] > 0) assert_close(mean->data[k], -e->sum[k] / e->count[k], 0, 3 * t->eps);
            else assert_false(ssfr_is_surface(mean->data[k]));
        }
    }
}

static void factor_1_copies(void **state)
{
    static const char *const rules[] = {"nearest", "nearest_to_eye", "mean"};
    test_twin *t = begin(state, "1");
    for (size_t i = 0; i < SSFR_COUNT(rules); i++) {
        test_twin_set(t, "rule", "%s", rules[i]);
        const ssfr_field *low = test_twin_run(t, "low");
        for (int k = 0; k < W * H; k++)
            assert_true(low->data[k] == -image[k / W][k % W] || low->data[k] < -SSFR_SURFACE);
        assert_int_equal(test_count(low), 18);
    }
}

static void nothing_is_left_where_there_was_nothing(void **state)
{
    static const char *const rules[] = {"nearest", "nearest_to_eye", "mean"};
    test_twin *t = begin(state, "4");
    test_twin_give(t, "depth", test_field_filled(W, H, 1, -SSFR_EMPTY));
    for (size_t i = 0; i < SSFR_COUNT(rules); i++) {
        test_twin_set(t, "rule", "%s", rules[i]);
        const ssfr_field *low = test_twin_run(t, "low");
        for (int k = 0; k < 4; k++) assert_close(low->data[k], -SSFR_EMPTY, 0, 1e-7);
    }
}

/* A single pixel at the right and bottom border is a block of its own for each factor. */
static void last_column_and_row_are_not_lost(void **state)
{
    static const char *const rules[] = {"nearest", "nearest_to_eye", "mean"};
    static const double c[1][3] = {{0, 0, -2.385}};
    for (int shift = 1; shift <= 3; shift++) {
        const int n = 1 << shift;
        test_twin *t = test_twin_create(state, "downsample", 2 * n + 1, n + 1);
        test_twin_place(t, 1, c, 0.1, NULL);
        test_twin_give(t, "depth", test_field_filled(2 * n + 1, n + 1, 1, -2.5));
        test_twin_set(t, "factor", "%d", n);
        for (size_t i = 0; i < SSFR_COUNT(rules); i++) {
            test_twin_set(t, "rule", "%s", rules[i]);
            const ssfr_field *low = test_twin_run(t, "low");
            assert_int_equal(low->w * low->h, 3 * 2);
            for (int k = 0; k < 6; k++) assert_true(low->data[k] == -2.5);
        }
    }
}

static void full_resolution_needs_no_pass(void **state)
{
    ssfr_node_status status;
    test_twin *t = begin(state, "1");
    const ssfr_field *low = test_twin_run_if_needed(t, "low", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_true(test_same_bits(low, test_twin_run(t, "low")));
}

static void nothing_runs_without_fluid(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    ssfr_node_status status;
    test_twin *t = test_twin_create(state, "downsample", W, H);
    test_twin_place(t, 1, behind, 0.1, NULL);
    assert_int_equal(test_count(test_twin_run_if_needed(t, "low", &status)), 0);
    assert_int_equal(status, SSFR_NEEDLESS);
}

/* Samples a pixel of the result. */
static void the_report_counts_the_samples_of_a_block(void **state)
{
    test_twin *t = begin(state, "4");
    test_twin_run(t, "low");
    assert_true(ssfr_graph_report(t->graph)->nodes[0].taps == 16);
    test_twin_set(t, "rule", "nearest");
    test_twin_run(t, "low");
    assert_true(ssfr_graph_report(t->graph)->nodes[0].taps == 1);
}

static void downsample_refuses_other_factors_and_rules(void **state)
{
    test_twin *t = begin(state, "2");
    test_twin_refuses(t, "factor", "3", "downsample.factor");
    test_twin_refuses(t, "factor", "16", "16");
    test_twin_refuses(t, "rule", "median", "median");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(each_rule_gives_what_a_hand_finds),
        TEST_TWINS(factor_1_copies),
        TEST_TWINS(nothing_is_left_where_there_was_nothing),
        TEST_TWINS(last_column_and_row_are_not_lost),
        TEST_TWINS(full_resolution_needs_no_pass),
        TEST_TWINS(nothing_runs_without_fluid),
        TEST_TWINS(the_report_counts_the_samples_of_a_block),
        TEST_TWINS(downsample_refuses_other_factors_and_rules),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

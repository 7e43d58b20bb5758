/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_shadow_basis.c: cosines and sines of given depths, their sum against the closed form, and the box filter. */
#include "tests/pass_util.h"

#include "passes/shadow_basis.h"

/* Without solids the light's square has depths from 0 down to -1 m. */
static ssfr_field *run(void **state, const ssfr_field *map, int terms, int radius, double alpha)
{
    test_twin *t = test_twin_create(state, "shadow_basis", 8, 6);
    test_twin_set(t, "terms", "%d", terms);
    test_twin_set(t, "radius", "%d", radius);
    test_twin_set(t, "alpha", "%.17g", alpha);
    test_twin_give(t, "light_depth", map);
    return test_twin_run(t, "basis");
}

/* What depth i of a ramp with some holes is, m. */
static double ramp(int i)
{
    return i % 7 == 3 ? -SSFR_EMPTY : -0.031 * i;
}

static ssfr_field *ramp_map(int w, int h)
{
    ssfr_field *map = test_field(w, h, 1);
    for (int i = 0; i < w * h; i++) map->data[i] = ramp(i);
    return map;
}

static double value_at(const ssfr_field *basis, int side, int x, int y, int i)
{
    return ssfr_field_at(basis, x, y + i / 4 * side)[i % 4];
}

static double epsilon(void **state)
{
    return strcmp(*state, "gpu") == 0 ? 1e-5 : 1e-14;
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

static void every_value_is_a_cosine_or_sine_of_the_depth(void **state)
{
    static const int terms[] = {1, 2, 3, 4, 5, 8, 16}, images[] = {1, 2, 2, 3, 3, 5, 9};
    const double pi = acos(-1), alpha = 0.785;
    for (size_t t = 0; t < SSFR_COUNT(terms); t++) {
        const ssfr_field *map = ramp_map(6, 5), *basis = run(state, map, terms[t], 0, alpha);
        assert_int_equal(basis->w, 6);
        assert_int_equal(basis->h, 5 * images[t]);
        for (int i = 0; i < 6 * 5; i++)
            for (int j = 0; j < 4 * images[t]; j++) {
                const int k = (j + 1) / 2;
                const double c = pi * (2 * k - 1), z = -ramp(i) * ssfr_shadow_span(images[t]);
                const double weight = 2 * exp(-alpha * ssfr_square((double)k / terms[t])) / c;
                const double wave = weight * (j % 2 ? cos(c * z) : sin(c * z));
                const double expected = i % 7 == 3 || k > terms[t] ? 0 : j == 0 ? 1 : wave;
                assert_close(value_at(basis, 5, i % 6, i / 6, j), expected, epsilon(state), 0);
            }
    }
}

/* At 1 - 1/(2 M), M being the most terms that the images hold. */
static void depths_end_before_the_series_turns_back(void **state)
{
    (void)state;
    for (int terms = 1; terms <= 16; terms *= 2)
        assert_close(ssfr_shadow_span(ssfr_shadow_images(terms)), 1 - 0.5 / terms, 1e-15, 0);
    for (int terms = 1; terms <= 16; terms++) assert_true(ssfr_shadow_span(ssfr_shadow_images(terms)) <= 1 - 0.5 / terms);
}

static void depths_beyond_the_range_count_as_its_ends(void **state)
{
    ssfr_field *map = test_field(5, 1, 1);
    static const double depths[] = {0.5, 0, -1e6, NAN, INFINITY};
    memcpy(map->data, depths, sizeof depths);
    const ssfr_field *basis = run(state, map, 1, 0, 0);
    const double z[] = {0, 0, 1, 0, 0};
    for (int i = 0; i < 5; i++) {
        assert_close(value_at(basis, 1, i, 0, 0), i < 3, 0, 0);
        assert_close(value_at(basis, 1, i, 0, 1), i < 3 ? 2 / acos(-1) * cos(acos(-1) * z[i]) : 0, epsilon(state), 0);
    }
}

/* The sum of the first M cosines at odd multiples is sin(2 M pi t) / (2 sin(pi t)); by Simpson's rule. */
static double integrated(int terms, double x)
{
    enum { N = 4000 };
    const double pi = acos(-1);
    double sum = 0;
    for (int i = 0; i <= N; i++) {
        const double t = x * i / N, f = i == 0 ? 2 * terms : sin(2 * terms * pi * t) / sin(pi * t);
        sum += f * (i == 0 || i == N ? 1 : i % 2 ? 4 : 2);
    }
    return 0.5 + sum * x / N / 3;
}

static void the_series_is_that_of_a_square_wave(void **state)
{
    static const int terms[] = {1, 2, 4, 8, 16};
    const double pi = acos(-1);
    for (size_t t = 0; t < SSFR_COUNT(terms); t++) {
        const int n = ssfr_shadow_images(terms[t]);
        const ssfr_field *map = test_field_filled(1, 1, 1, -0.385), *basis = run(state, map, terms[t], 0, 0);
        const double z = 0.385 * ssfr_shadow_span(n);
        for (int i = 1; i < 40; i++) {
            const double d = i / 40. * ssfr_shadow_span(n);
            double s = 0.5;
            for (int k = 1; k <= terms[t]; k++)
                s += cos(pi * (2 * k - 1) * d) * value_at(basis, 1, 0, 0, 2 * k) -
                     sin(pi * (2 * k - 1) * d) * value_at(basis, 1, 0, 0, 2 * k - 1);
            assert_close(s, integrated(terms[t], z - d), 20 * epsilon(state) + 1e-9, 0);
        }
    }
}

/* ---- the filter -------------------------------------------------------------------------------------------------- */

static void a_lone_caster_spreads_over_its_box(void **state)
{
    for (int radius = 0; radius <= 3; radius++) {
        ssfr_field *map = test_field_filled(9, 9, 1, -SSFR_EMPTY);
        *ssfr_field_at(map, 4, 4) = -0.2;
        const ssfr_field *basis = run(state, map, 4, radius, 0);
        for (int y = 0; y < 9; y++)
            for (int x = 0; x < 9; x++) {
                const bool inside = abs(x - 4) <= radius && abs(y - 4) <= radius;
                assert_close(value_at(basis, 9, x, y, 0), inside / ssfr_square(2 * radius + 1), epsilon(state), 0);
            }
    }
}

/* Neither the border nor the other images come into a mean. */
static void what_is_the_same_everywhere_stays_so(void **state)
{
    const ssfr_field *map = test_field_filled(5, 4, 1, -0.385);
    const ssfr_field *plain = run(state, map, 8, 0, 0), *filtered = run(state, map, 8, 7, 0);
    assert_true(test_difference(plain, filtered) < 10 * epsilon(state));
}

static void the_filter_is_the_mean_of_the_box(void **state)
{
    const int radius = 2, side = 6;
    const ssfr_field *map = ramp_map(side, side);
    const ssfr_field *plain = run(state, map, 3, 0, 0), *filtered = run(state, map, 3, radius, 0);
    for (int i = 0; i < 8; i++)
        for (int y = 0; y < side; y++)
            for (int x = 0; x < side; x++) {
                double sum = 0;
                for (int v = y - radius; v <= y + radius; v++)
                    for (int u = x - radius; u <= x + radius; u++)
                        sum += value_at(plain, side, ssfr_clamp_int(u, 0, side - 1), ssfr_clamp_int(v, 0, side - 1), i);
                assert_close(value_at(filtered, side, x, y, i), sum / ssfr_square(2 * radius + 1),
                             10 * epsilon(state), 0);
            }
}

/* ---- what it is run for ------------------------------------------------------------------------------------------ */

/* Once to write, and twice to read 2 radius + 1 and write four channels. */
static void taps_and_bytes_are_those_of_its_sweeps(void **state)
{
    const ssfr_field *map = ramp_map(6, 6);
    test_twin *t = test_twin_create(state, "shadow_basis", 8, 6);
    double bytes[2];
    test_twin_give(t, "light_depth", map);
    for (int filtered = 0; filtered < 2; filtered++) {
        test_twin_set(t, "radius", "%d", filtered ? 3 : 0);
        test_twin_run(t, "basis");
        const ssfr_node_report *node = &ssfr_graph_report(t->graph)->nodes[0];
        assert_true(node->taps == (filtered ? 1 + 2 * 7 : 1));
        if (filtered) assert_int_equal(node->iterations, 3);
        bytes[filtered] = node->bytes;
    }
    assert_true(bytes[1] - bytes[0] == 2 * 2 * 4 * sizeof(float) * 6 * 6 * 3);
}

static void without_casters_there_is_nothing_to_filter(void **state)
{
    test_twin *t = test_twin_create(state, "shadow_basis", 8, 6);
    const double at[1][3] = {{0, 0, -3}};
    ssfr_node_status status;
    test_twin_place(t, 1, at, 0.1, NULL);
    const ssfr_field *left_out = test_twin_run_if_needed(t, "basis", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_int_equal(left_out->w * left_out->h, 1);
    const ssfr_field *empty = test_field_filled(4, 3, 1, -SSFR_EMPTY);
    const ssfr_field *basis = run(state, empty, 4, 2, 0);
    for (int i = 0; i < basis->w * basis->h * 4; i++) assert_true(basis->data[i] == 0);
}

static void parameters_out_of_range_are_refused(void **state)
{
    test_twin *t = test_twin_create(state, "shadow_basis", 8, 6);
    test_twin_refuses(t, "terms", "0", "terms=0");
    test_twin_refuses(t, "terms", "17", "terms=17");
    test_twin_refuses(t, "radius", "-1", "radius=-1");
    test_twin_refuses(t, "alpha", "-1", "alpha=-1");
    test_twin_refuses(t, "alpha", "nan", "alpha=nan");
}

static void images_too_large_are_refused(void **state)
{
    test_twin *t = test_twin_create(state, "shadow_basis", 8, 6);
    test_twin_set(t, "terms", "16");
    test_twin_give(t, "light_depth", test_field(1, 2048, 1));
    ssfr_graph_want_all(t->graph, true);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(t->graph, &t->scene, &(ssfr_run_options){.keep_all = true}), "18432");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(every_value_is_a_cosine_or_sine_of_the_depth),
        cmocka_unit_test(depths_end_before_the_series_turns_back),
        TEST_TWINS(depths_beyond_the_range_count_as_its_ends),
        TEST_TWINS(the_series_is_that_of_a_square_wave),
        TEST_TWINS(a_lone_caster_spreads_over_its_box),
        TEST_TWINS(what_is_the_same_everywhere_stays_so),
        TEST_TWINS(the_filter_is_the_mean_of_the_box),
        TEST_TWINS(taps_and_bytes_are_those_of_its_sweeps),
        TEST_TWINS(without_casters_there_is_nothing_to_filter),
        TEST_TWINS(parameters_out_of_range_are_refused),
        TEST_TWINS(images_too_large_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

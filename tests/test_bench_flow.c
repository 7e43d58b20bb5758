/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_bench_flow.c: widths and damping by formulas; steps and curvatures of images that have known ones. */
#include "experiments/bench_flow.h"
#include "tests/pass_util.h"

#define TEST_CPU(test) {#test, test, NULL, test_clean, "cpu"}

static const double pi = 3.14159265358979323846;

/* ---- bumps ------------------------------------------------------------------------------------------------------- */

static ssfr_bumps measure(const ssfr_bumps_setup *s, ssfr_bumps_flow flow, double distance)
{
    ssfr_bumps b;
    assert_int_equal(ssfr_bumps_measure(s, flow, distance, &b), SSFR_OK);
    return b;
}

/* n steps of 0.8 of the bound at the nearest distance, C z0 / 2: n dt C z = 0.4 n C^2 z0 z. */
static void a_fixed_number_of_steps_smooths_by_the_root_of_the_distance(void **state)
{
    (void)state;
    ssfr_bumps_setup s = ssfr_bumps_defaults;
    s.iterations = 25, s.cell = 0.002, s.nearest = 0.7;
    for (int i = 0; i < SSFR_BUMPS_DISTANCES; i += 3) {
        const double z = ssfr_bumps_distance(&s, i);
        const ssfr_bumps b = measure(&s, SSFR_BUMPS_FIXED, z);
        assert_close(b.width, sqrt(0.4 * 25 * 0.7 * z) * 0.002, 0, 2e-3);
        assert_close(b.by_rule, b.by_steps, 0, 0);
        assert_close(b.reach, 25 * 0.002 * z, 0, 1e-12);
    }
}

/* The paper's steps are up to two more than r_s = r_w / (C z), and its width is sqrt(r_w dt), not r_w. */
static void steps_times_distance_and_metres_smooth_alike_everywhere(void **state)
{
    (void)state;
    const ssfr_bumps_setup s = ssfr_bumps_defaults;
    const double r_w = s.paper * s.radius, dt = 0.4 * s.cell * s.nearest;
    for (int i = 0; i < SSFR_BUMPS_DISTANCES; i += 3) {
        const double z = ssfr_bumps_distance(&s, i), r_s = r_w / (s.cell * z);
        const ssfr_bumps paper = measure(&s, SSFR_BUMPS_PAPER, z), metres = measure(&s, SSFR_BUMPS_METRES, z);
        assert_true(paper.steps == floor(r_s) + 2);
        assert_close(paper.by_rule, sqrt(r_w * dt), 0, 1e-12);
        assert_close(paper.width, paper.by_rule * sqrt(paper.steps / r_s), 0, 5e-3);
        assert_true(paper.reach >= r_w && paper.width < 0.06 * r_w);
        assert_close(metres.width, s.metres * s.radius, 0, 2e-3);
        assert_close(metres.by_steps, metres.by_rule, 0, 1e-12);
    }
}

static void the_curvature_over_the_distance_smooths_alike_in_a_fixed_number_of_steps(void **state)
{
    (void)state;
    const ssfr_bumps_setup s = ssfr_bumps_defaults;
    for (int i = 0; i < SSFR_BUMPS_DISTANCES; i += 4) {
        const ssfr_bumps b = measure(&s, SSFR_BUMPS_OVER_DEPTH, ssfr_bumps_distance(&s, i));
        assert_close(b.width, sqrt(0.4 * (double)s.iterations) * s.cell * s.nearest, 0, 2e-3);
        assert_close(b.by_rule, b.width, 0, 2e-3);
    }
}

/* Long bumps by exp(-(2 pi width / wavelength)^2 / 2), and short ones by more than they would: steps are Euler's. */
static void bumps_are_damped_by_what_is_predicted(void **state)
{
    (void)state;
    const ssfr_bumps_setup s = ssfr_bumps_defaults;
    for (int flow = 0; flow < SSFR_N_BUMPS_FLOWS; flow++) {
        const ssfr_bumps b = measure(&s, (ssfr_bumps_flow)flow, 1.4);
        for (int i = 0; i < SSFR_BUMPS_PERIODS; i++) {
            const ssfr_bumps_period *p = &b.periods[i];
            /* Crests and troughs of the paper's may differ by a step of some eighty. */
            assert_close(p->gain, p->predicted, 1e-3, flow == SSFR_BUMPS_PAPER ? 0.02 : 2e-3);
            assert_close(p->residual, p->gain * p->height, 0, 1e-12);
            assert_close(p->wavelength, ssfr_bumps_periods[i] * s.radius, 0, 0.13);
            assert_close(p->height, 2 * 0.05 * p->wavelength / (2 * pi), 0, 1e-12);
            const double smooth = exp(-ssfr_square(2 * pi * b.width / p->wavelength) / 2);
            if (i >= SSFR_BUMPS_PERIODS / 2) assert_close(p->gain, smooth, 0, 5e-3);
            if (i) assert_true(p->gain > b.periods[i - 1].gain);
        }
    }
}

static void bumps_that_pixels_do_not_resolve_are_left_out(void **state)
{
    (void)state;
    ssfr_bumps_setup s = ssfr_bumps_defaults;
    s.cell = 0.02;
    const ssfr_bumps b = measure(&s, SSFR_BUMPS_FIXED, 2); /* pixels of two radii */
    for (int i = 0; i < SSFR_BUMPS_PERIODS; i++)
        assert_true(isnan(b.periods[i].gain) == (ssfr_bumps_periods[i] < 8) &&
                    isnan(b.periods[i].wavelength) == isnan(b.periods[i].gain));
    s.cell = 0.2;
    assert_true(isnan(measure(&s, SSFR_BUMPS_FIXED, 2).width));
}

/* ---- a view ------------------------------------------------------------------------------------------------------ */

enum { W = 60, H = 40 };

static test_twin *begin(void **state, const char *pass)
{
    static const double behind[1][3] = {{0, 0, 5}};
    test_twin *t = test_twin_create(state, pass, W, H);
    test_twin_place(t, 1, behind, 1, NULL); /* how far the fluid is, the depth tells */
    return t;
}

static void pixels_are_counted_by_their_steps(void **state)
{
    test_twin *t = begin(state, "adaptive_flow");
    const double cell = 2 * t->scene.camera.tan_x / W, r_w = 1.7;
    ssfr_field *depth = test_field(W, H, 1);
    for (int i = 0; i < W * H; i++) depth->data[i] = i % W < 20 ? -1.83 : i % W < 35 ? -11.9 : -SSFR_EMPTY;
    test_twin_set(t, "radius", "%.17g", r_w);
    test_twin_give(t, "depth", depth);
    test_twin_run(t, "smooth");
    ssfr_flow_pixels p;
    assert_int_equal(ssfr_flow_look(t->graph, &p), SSFR_OK);
    const int near = (int)floor(r_w / (cell * 1.83)) + 2, far = (int)floor(r_w / (cell * 11.9)) + 2;
    assert_int_equal(p.n, 35 * H);
    assert_true(p.most == near && near > far);
    for (int i = 0; i <= p.most; i++) assert_int_equal(p.counts[i], i == near ? 20 * H : i == far ? 15 * H : 0);
    for (int i = 0; i < W * H; i++) {
        if (i % W < 35) assert_true(p.steps->data[i] == (i % W < 20 ? near : far));
        else assert_true(isnan(p.steps->data[i]));
    }
    ssfr_flow_pixels_finish(&p);
}

/* A sphere of 0.8 m has a mean curvature of 1.25 / m; steps smooth away a little noise on it. */
static void curvatures_are_those_of_the_surface(void **state)
{
    static const double centre[3] = {0.1, -0.05, -2};
    test_twin *t = begin(state, "curvature_flow");
    ssfr_field *depth = test_field_filled(W, H, 1, -SSFR_EMPTY);
    for (int i = 0; i < W * H; i++) {
        const test_hit hit = test_meet(centre, 0.8, test_ray_at(t, i % W, i / W, 1));
        if (hit.miss < 0.5) depth->data[i] = hit.front;
    }
    ssfr_flow_pixels p;
    test_twin_set(t, "iterations", "0");
    test_twin_give(t, "depth", depth);
    test_twin_run(t, "smooth");
    assert_int_equal(ssfr_flow_look(t->graph, &p), SSFR_OK);
    assert_true(p.before.n > 100 && p.before.n == p.after.n && p.before.n < p.n && p.counts[0] == p.n);
    for (size_t i = 0; i < p.before.n; i++) assert_close(p.before.values[i], 1.25, 0, 0.02);
    size_t n = 0;
    for (int i = 0; i < W * H; i++) {
        const double value = p.before.image->data[i];
        n += isfinite(value);
        assert_true(isnan(value) || (fabs(value - 1.25) < 0.025 && value == p.after.image->data[i]));
    }
    assert_int_equal(n, p.before.n);
    ssfr_flow_pixels_finish(&p);

    uint64_t random = 3;
    for (int i = 0; i < W * H; i++) depth->data[i] += test_random(&random, -1e-3, 1e-3);
    test_twin_set(t, "iterations", "9");
    test_twin_give(t, "depth", depth);
    test_twin_run(t, "smooth");
    assert_int_equal(ssfr_flow_look(t->graph, &p), SSFR_OK);
    const size_t high = p.before.n * 9 / 10;
    assert_true(p.counts[9] == p.n && p.after.values[high] < 0.5 * p.before.values[high]);
    for (size_t i = 1; i < p.after.n; i++) assert_true(p.after.values[i] >= p.after.values[i - 1]);
    ssfr_flow_pixels_finish(&p);
}

static void a_graph_without_a_flow_is_refused(void **state)
{
    test_twin *t = begin(state, "downsample"), *idle = begin(state, "curvature_flow");
    ssfr_flow_pixels p;
    test_twin_give(t, "depth", test_field_filled(W, H, 1, -3));
    test_twin_run(t, "low");
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_flow_look(t->graph, &p), "no curvature flow ran");
    ssfr_node_status status;
    test_twin_set(idle, "iterations", "0");
    test_twin_give(idle, "depth", test_field_filled(W, H, 1, -3));
    test_twin_run_if_needed(idle, "smooth", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_flow_look(idle->graph, &p), "no curvature flow ran");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fixed_number_of_steps_smooths_by_the_root_of_the_distance),
        cmocka_unit_test(steps_times_distance_and_metres_smooth_alike_everywhere),
        cmocka_unit_test(the_curvature_over_the_distance_smooths_alike_in_a_fixed_number_of_steps),
        cmocka_unit_test(bumps_are_damped_by_what_is_predicted),
        cmocka_unit_test(bumps_that_pixels_do_not_resolve_are_left_out),
        TEST_CPU(pixels_are_counted_by_their_steps),
        TEST_CPU(curvatures_are_those_of_the_surface),
        TEST_CPU(a_graph_without_a_flow_is_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_flow.c: the flow without steps against closed forms, against its two solvers, and as the limit of the twin's
 * steps; cliffs, stiffness, sizes. */
#include "experiments/truth/flow.h"
#include "passes/curvature_flow.h"
#include "tests/pass_util.h"

#include <omp.h>

static const double z0 = -2.385; /* m */

/* ---- a run of the pass ------------------------------------------------------------------------------------------- */

/* One particle of 10 m: by default nothing within 50 m is a silhouette. */
static test_twin *begin(void **state, int w, int h)
{
    static const double c[1][3] = {{0, 0, -2.385}};
    test_twin *t = test_twin_create(state, "curvature_flow", w, h);
    test_twin_place(t, 1, c, 10, NULL);
    test_twin_set(t, "unstable", "allow");
    return t;
}

/* The bound of the step at depth z. */
static double bound(const test_twin *t, double z)
{
    const ssfr_camera *c = &t->scene.camera;
    const double cx = 2 * c->tan_x / c->w, cy = 2 * c->tan_y / c->h;
    return fabs(z) * cx * cy / (cx + cy);
}

typedef struct setting { /* a run that stands by itself, with coefficients of its own */
    ssfr_run run;
    ssfr_curvature_flow_coeffs coeffs;
} setting;

/* `steps` of dt on the depth, as the pass itself derives them. */
static setting *prepare(test_twin *t, const ssfr_field *depth, int steps, double dt)
{
    static setting settings[64];
    static int n;
    setting *s = &settings[n++ % 64];
    test_twin_set(t, "iterations", "%d", steps);
    test_twin_set(t, "dt", "%.17g", dt);
    test_twin_give(t, "depth", depth);
    test_twin_run(t, "smooth");
    assert_non_null(ssfr_graph_last_run(t->graph, 0));
    s->run = *ssfr_graph_last_run(t->graph, 0);
    s->coeffs = *(const ssfr_curvature_flow_coeffs *)s->run.coeffs;
    s->run.coeffs = &s->coeffs;
    s->run.in[0] = depth;
    s->run.scratch[0] = test_field(depth->w, depth->h, 1);
    return s;
}

static ssfr_field *flow(setting *s, ssfr_flow_method method, ssfr_flow_report *report)
{
    ssfr_flow_report own;
    s->run.out[0] = test_field(s->run.w, s->run.h, 1);
    assert_int_equal(ssfr_flow_run(&s->run, method, SSFR_FLOW_TOLERANCE, report ? report : &own), SSFR_OK);
    return s->run.out[0];
}

/* The twin with n times as many steps, each as much shorter. */
static ssfr_field *euler(const setting *s, int n)
{
    setting finer = *s;
    finer.run.coeffs = &finer.coeffs;
    finer.coeffs.iterations *= n, finer.coeffs.dt /= n, finer.coeffs.limit /= n;
    finer.run.out[0] = test_field(s->run.w, s->run.h, 1);
    ssfr_curvature_flow_cpu(&finer.run);
    return finer.run.out[0];
}

/* A bump, four pixels wide, on water that leans; all slopes in reach of what is not linear. */
static ssfr_field *bump(int w, int h)
{
    ssfr_field *depth = test_field(w, h, 1);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            const double i = (x - 0.4 * w) / 4, j = (y - 0.55 * h) / 4;
            *ssfr_field_at(depth, x, y) = z0 + 0.3 * exp(-i * i - j * j) + 0.02 * x - 0.015 * y;
        }
    return depth;
}

static ssfr_field *noisy(int w, int h, double a, uint64_t seed)
{
    ssfr_field *depth = test_field(w, h, 1);
    for (int i = 0; i < w * h; i++) depth->data[i] = z0 + test_random(&seed, -a, a);
    return depth;
}

static double roughness(const ssfr_field *depth)
{
    double largest = 0;
    for (int y = 0; y < depth->h; y++)
        for (int x = 1; x < depth->w; x++)
            largest = fmax(largest, fabs(*ssfr_field_at(depth, x, y) - *ssfr_field_at(depth, x - 1, y)));
    return largest;
}

/* ---- closed forms ------------------------------------------------------------------------------------------------ */

static void a_plane_that_faces_the_viewer_stays(void **state)
{
    test_twin *t = begin(state, 12, 9);
    const ssfr_field *flat = test_field_filled(12, 9, 1, z0);
    for (int method = 0; method < SSFR_N_FLOWS; method++) {
        ssfr_flow_report report;
        setting *s = prepare(t, flat, 40, bound(t, z0));
        assert_true(test_same_bits(flow(s, (ssfr_flow_method)method, &report), flat));
        assert_int_equal(report.unknowns, 12 * 9);
        assert_true(report.err == 0 && report.reached == report.time && report.crossings == 0);
        assert_close(report.time, 40 * bound(t, z0), 0, 1e-15);
    }
}

/* z0 + a cos(kx x) cos(ky y), mirrored by the border, is a mode of the whole image: it falls by
 * exp(-T ((1 - cos kx) / C_x + (1 - cos ky) / C_y) / |z0|), and 1 - cos k is k^2 / 2 where k is small: diffusion with
 * the coefficient 1 / (2 C |z|) in pixels. What is not linear is a / (C |z|) as large, squared. */
static void a_small_cosine_decays_as_diffusion_does(void **state)
{
    static const int modes[][2] = {{1, 0}, {1, 1}, {5, 2}, {11, 8}};
    const double pi = acos(-1), a = 1e-4;
    test_twin *t = begin(state, 12, 9);
    const double c = 2 * t->scene.camera.tan_x / 12, dt = 0.8 * bound(t, z0);
    for (size_t m = 0; m < SSFR_COUNT(modes); m++) {
        const double kx = pi * modes[m][0] / 12, ky = pi * modes[m][1] / 9, T = 10 * dt;
        ssfr_field *wave = test_field(12, 9, 1), *depth = test_field(12, 9, 1);
        for (int i = 0; i < 12 * 9; i++) {
            wave->data[i] = cos(kx * (i % 12 + 0.5)) * cos(ky * (i / 12 + 0.5));
            depth->data[i] = z0 + a * wave->data[i];
        }
        const ssfr_field *smooth = flow(prepare(t, depth, 10, dt), SSFR_FLOW_RK8PD, NULL);
        double before = 0, after = 0;
        for (int i = 0; i < 12 * 9; i++) {
            before += wave->data[i] * (depth->data[i] - z0);
            after += wave->data[i] * (smooth->data[i] - z0);
        }
        const double exact = exp(-T * (2 - cos(kx) - cos(ky)) / (c * fabs(z0)));
        assert_close(after / before, exact, 1e-5, 0);
        if (m < 2) assert_close(log(after / before), -T * (kx * kx + ky * ky) / (2 * c * fabs(z0)), 0, 0.02);
    }
}

/* ---- solvers and steps ------------------------------------------------------------------------------------------- */

static void both_solvers_give_the_same_smooth_bump(void **state)
{
    test_twin *t = begin(state, 12, 10);
    const ssfr_field *depth = bump(12, 10);
    for (int form = 0; form < 4; form++) {
        ssfr_flow_report explicit, implicit;
        test_twin_set(t, "cross_term", "%d", form % 2);
        test_twin_set(t, "off_axis", "%d", form / 2);
        setting *s = prepare(t, depth, 5, 0.9 * bound(t, z0));
        const ssfr_field *a = flow(s, SSFR_FLOW_RK8PD, &explicit), *b = flow(s, SSFR_FLOW_MSBDF, &implicit);
        assert_true(test_difference(a, b) < 1e-8);
        assert_true(explicit.err < 1e-8 && implicit.err < 1e-7);
        assert_true(explicit.jacobians == 0 && implicit.jacobians > 0);
        assert_true(test_difference(a, depth) > 0.01);
    }
}

/* Halving all steps halves the difference, also where each pixel's limit is its own. */
static void the_twins_steps_converge_with_order_one(void **state)
{
    test_twin *t = begin(state, 24, 20);
    const ssfr_field *depth = bump(24, 20);
    for (int form = 0; form < 4; form++) {
        ssfr_flow_report report;
        test_twin_set(t, "unstable", "%s", form % 2 ? "limit" : "allow");
        test_twin_set(t, "off_axis", "%d", form / 2);
        setting *s = prepare(t, depth, 10, (form % 2 ? 7 : 0.9) * bound(t, z0));
        const ssfr_field *exact = flow(s, SSFR_FLOW_RK8PD, &report);
        double before = test_difference(euler(s, 8), exact);
        assert_true(report.err < 1e-8 && before > 1e4 * report.err);
        for (int n = 16; n <= 64; n *= 2) {
            const double error = test_difference(euler(s, n), exact);
            assert_close(before / error, 2, 0.05, 0);
            before = error;
        }
    }
}

/* ---- cliffs ------------------------------------------------------------------------------------------------------ */

/* A ramp of nearly the falloff a pixel, with noise: steps pass it in both directions. */
static ssfr_field *ramp(int w, int h, double slope, double noise)
{
    ssfr_field *depth = noisy(w, h, noise, 7);
    for (int i = 0; i < w * h; i++) depth->data[i] -= slope * (i % w);
    return depth;
}

/* Crossings are where the flow is not smooth: what the twin's steps come to is still the same. */
static void the_twin_converges_across_the_falloff(void **state)
{
    test_twin *t = begin(state, 12, 10);
    const ssfr_field *depth = ramp(12, 10, 0.29, 0.01);
    test_twin_set(t, "depth_falloff", "0.03"); /* 0.3 m */
    for (int method = 0; method < SSFR_N_FLOWS; method++) {
        ssfr_flow_report report;
        setting *s = prepare(t, depth, 20, 0.9 * bound(t, z0));
        const ssfr_field *exact = flow(s, (ssfr_flow_method)method, &report);
        assert_true(report.crossings > 10 && report.flickers == 0 && report.err < 1e-6);
        assert_true(report.failed < report.steps / 4); /* steps cut short at a crossing have not failed */
        const double coarse = test_difference(euler(s, 8), exact), fine = test_difference(euler(s, 128), exact);
        assert_close(coarse / fine, 16, 8, 0);
        assert_true(coarse < 1e-3 && fine > report.err);
    }
}

/* Where both rates lead back to the falloff there is no smooth flow: it ends all the same, and says how well. */
static void flickering_edges_end_and_are_told(void **state)
{
    test_twin *t = begin(state, 12, 10);
    const ssfr_field *depth = ramp(12, 10, 0.0999, 0.001);
    test_twin_set(t, "depth_falloff", "0.01");
    for (int method = 0; method < SSFR_N_FLOWS; method++) {
        ssfr_flow_report report;
        setting *s = prepare(t, depth, 40, 0.9 * bound(t, z0));
        const ssfr_field *end = flow(s, (ssfr_flow_method)method, &report);
        assert_true(report.flickers > 0 && report.reached == report.time);
        assert_true(report.crossings < 1024); /* not one after the other */
        assert_true(report.err > 1e-8 && report.err < 0.1);
        assert_int_equal(test_count(end), 12 * 10);
        assert_true(test_difference(euler(s, 64), end) < 10 * report.err);
    }
}

static void holes_stay_and_pull_nothing(void **state)
{
    test_twin *t = begin(state, 12, 10);
    ssfr_field *depth = bump(12, 10), *other;
    const double holes[] = {-SSFR_EMPTY, (double)NAN, INFINITY};
    for (int i = 0; i < 12 * 10; i += 7) depth->data[i] = holes[i % 3];
    for (int method = 0; method < SSFR_N_FLOWS; method++) {
        ssfr_flow_report report;
        setting *s = prepare(t, depth, 5, 0.9 * bound(t, z0));
        const ssfr_field *smooth = flow(s, (ssfr_flow_method)method, &report);
        assert_int_equal(report.unknowns, 12 * 10 - 18);
        for (int i = 0; i < 12 * 10; i++)
            if (i % 7 == 0) assert_memory_equal(&smooth->data[i], &depth->data[i], sizeof(double));
            else assert_true(fabs(smooth->data[i] - depth->data[i]) < 0.2);
        other = euler(s, 512);
        for (int i = 0; i < 12 * 10; i++)
            if (i % 7) assert_close(smooth->data[i], other->data[i], 2e-4, 0);
    }
}

static void an_empty_image_and_no_steps_change_nothing(void **state)
{
    test_twin *t = begin(state, 12, 10);
    const ssfr_field *empty = test_field_filled(12, 10, 1, -SSFR_EMPTY), *depth = bump(12, 10);
    for (int method = 0; method < SSFR_N_FLOWS; method++) {
        ssfr_flow_report report;
        assert_true(test_same_bits(flow(prepare(t, empty, 5, 1e-3), (ssfr_flow_method)method, &report), empty));
        assert_true(report.unknowns == 0 && report.err == 0 && report.steps == 0 && report.reached == report.time);
        assert_true(test_same_bits(flow(prepare(t, depth, 0, 1e-3), (ssfr_flow_method)method, &report), depth));
        assert_true(report.unknowns == 120 && report.err == 0 && report.reached == 0);
    }
}

/* ---- stiffness --------------------------------------------------------------------------------------------------- */

/* Twice the bound of a close-up: the twin's checkerboards grow threefold a step, the flow's decay. */
static void a_stiff_close_up_stays_smooth(void **state)
{
    test_twin *t = begin(state, 10, 8);
    ssfr_field *depth = bump(10, 8);
    for (int i = 0; i < 10 * 8; i++) depth->data[i] *= 0.05; /* some 0.12 m away */
    ssfr_flow_report implicit, explicit;
    setting *s = prepare(t, depth, 200, 2 * bound(t, 0.12));
    const ssfr_field *smooth = flow(s, SSFR_FLOW_MSBDF, &implicit), *same = flow(s, SSFR_FLOW_RK8PD, &explicit);
    assert_true(roughness(euler(s, 1)) > 2 * roughness(depth));
    assert_true(roughness(smooth) < 0.2 * roughness(depth));
    assert_true(test_difference(smooth, same) < 1e-7 * 0.12 && implicit.err < 1e-6 * 0.12);
    assert_true(implicit.evaluations < explicit.evaluations);
}

/* An explicit solver pays for stiffness by steps: here for more than it has. */
static void a_run_out_of_steps_says_so(void **state)
{
    test_twin *t = begin(state, 3, 3);
    ssfr_flow_report report;
    setting *s = prepare(t, bump(3, 3), 1000, 1e4 * bound(t, z0));
    const ssfr_field *stopped = flow(s, SSFR_FLOW_RK8PD, &report);
    assert_true(report.err == INFINITY && report.reached < report.time && report.reached > 0);
    assert_int_equal(test_count(stopped), 9);
    const ssfr_field *smooth = flow(s, SSFR_FLOW_MSBDF, &report);
    assert_true(report.reached == report.time && report.err < 1e-6 && report.steps < 1000);
    assert_true(test_difference(smooth, stopped) < 1e-3); /* both have long come to rest */
}

/* ---- the Jacobian ------------------------------------------------------------------------------------------------ */

/* Facing the viewer: 1 / (2 C |z|) for each neighbour beside, above and below, times dt. */
static void jacobian_of_flat_water_is_the_laplacian(void **state)
{
    enum { W = 5, H = 4 };
    test_twin *t = begin(state, W, H);
    const double c = 2 * t->scene.camera.tan_x / W, dt = 0.37 * bound(t, z0), k = dt / (2 * c * fabs(z0));
    size_t n = 0;
    double *matrix = NULL;
    assert_int_equal(ssfr_flow_jacobian(&prepare(t, test_field_filled(W, H, 1, z0), 1, dt)->run, &n, &matrix), SSFR_OK);
    assert_int_equal(n, W * H);
    for (int i = 0; i < W * H; i++)
        for (int j = 0; j < W * H; j++) {
            const int dx = abs(i % W - j % W), dy = abs(i / W - j / W), x = i % W, y = i / W;
            const int sides = (x > 0) + (x < W - 1) + (y > 0) + (y < H - 1);
            const double expected = i == j ? -k * sides : dx + dy == 1 ? k : 0;
            assert_close(matrix[i * W * H + j], expected, 1e-7 * k, 0);
        }
    free(matrix);
}

/* The rate of pixel i of the twin's own step when depth j is moved by h. */
static double moved_rate(setting *s, ssfr_field *depth, int i, int j, double h)
{
    const int x = i % depth->w, y = i / depth->w;
    const double before = depth->data[j];
    depth->data[j] += h;
    const unsigned cuts = ssfr_curvature_flow_cuts(&s->run, depth, x, y);
    const double rate = ssfr_curvature_flow_rate(&s->run, depth, x, y, cuts);
    depth->data[j] = before;
    return rate;
}

/* One depth at a time, by differences of fourth order. */
static void jacobian_is_that_of_differences(void **state)
{
    enum { W = 4, H = 5 };
    test_twin *t = begin(state, W, H);
    ssfr_field *depth = bump(W, H);
    depth->data[9] = -SSFR_EMPTY;
    depth->data[14] -= 3; /* a cliff */
    test_twin_set(t, "depth_falloff", "0.1");
    for (int form = 0; form < 4; form++) {
        size_t n = 0;
        double *matrix = NULL;
        test_twin_set(t, "off_axis", "%d", form % 2);
        test_twin_set(t, "unstable", "%s", form / 2 ? "limit" : "allow");
        setting *s = prepare(t, depth, 1, bound(t, z0));
        assert_int_equal(ssfr_flow_jacobian(&s->run, &n, &matrix), SSFR_OK);
        assert_int_equal(n, W * H - 1);
        for (int i = 0; i < W * H; i++)
            for (int j = 0; j < W * H; j++) {
                if (i == 9 || j == 9) continue;
                const size_t a = (size_t)(i - (i > 9)), b = (size_t)(j - (j > 9)); /* unknowns */
                const double h = 1e-4;
                const double near = moved_rate(s, depth, i, j, h) - moved_rate(s, depth, i, j, -h);
                const double far = moved_rate(s, depth, i, j, 2 * h) - moved_rate(s, depth, i, j, -2 * h);
                assert_close(matrix[a * n + b], (8 * near - far) / (12 * h), 1e-7, 0);
            }
        free(matrix);
    }
}

/* ---- limits ------------------------------------------------------------------------------------------------------ */

static void images_that_are_too_large_are_refused(void **state)
{
    test_twin *large = begin(state, 129, 128), *small = begin(state, 25, 24);
    ssfr_flow_report report;
    double *matrix;
    size_t n;
    ssfr_field *depth = test_field_filled(129, 128, 1, z0);
    setting *s = prepare(large, depth, 1, 1e-5), *m = prepare(small, bump(25, 24), 1, 1e-5);
    s->run.out[0] = test_field(129, 128, 1), m->run.out[0] = test_field(25, 24, 1);
    assert_fails(SSFR_ERR_VALUE, ssfr_flow_run(&s->run, SSFR_FLOW_RK8PD, 1e-10, &report), "rk8pd takes up to 128x128");
    assert_fails(SSFR_ERR_VALUE, ssfr_flow_run(&m->run, SSFR_FLOW_MSBDF, 1e-10, &report), "msbdf takes up to 24x24");
    assert_non_null(strstr(test_last_error(), "25x24 pixels, 600 with a surface"));
    assert_fails(SSFR_ERR_VALUE, ssfr_flow_jacobian(&m->run, &n, &matrix), "msbdf takes up to 24x24");
    assert_null(matrix);
    for (int i = 0; i < 129 * 128; i++)
        if (i % 129 > 3) depth->data[i] = -SSFR_EMPTY; /* holes are no unknowns */
    flow(s, SSFR_FLOW_RK8PD, &report);
    assert_int_equal(report.unknowns, 4 * 128);
}

/* Whatever is given: surfaces stay finite. */
static void wild_depths_never_make_nan(void **state)
{
    static const double scales[] = {1e-6, 1e-2, 1e3, 1e9};
    test_twin *t = begin(state, 5, 4);
    for (size_t i = 0; i < SSFR_COUNT(scales); i++)
        for (int form = 0; form < 4; form++) {
            ssfr_flow_report report;
            ssfr_field *depth = noisy(5, 4, 2.3, 5 + i);
            for (int k = 0; k < 5 * 4; k++) depth->data[k] *= scales[i];
            test_twin_set(t, "off_axis", "%d", form % 2);
            test_twin_set(t, "unstable", "%s", form / 2 ? "limit" : "allow");
            test_twin_set(t, "depth_falloff", "%g", i % 2 ? 1e6 : 0.05);
            setting *s = prepare(t, depth, 3, 0.9 * bound(t, z0 * scales[i]));
            for (int method = 0; method < SSFR_N_FLOWS; method++) {
                const ssfr_field *end = flow(s, (ssfr_flow_method)method, &report);
                for (int k = 0; k < 5 * 4; k++) assert_true(isfinite(end->data[k]));
                assert_true(report.err >= 0);
            }
        }
}

static void threads_change_no_bit(void **state)
{
    const int n_threads = omp_get_max_threads();
    test_twin *t = begin(state, 70, 64); /* enough that threads share the work */
    setting *s = prepare(t, bump(70, 64), 3, 0.9 * bound(t, z0));
    omp_set_num_threads(1);
    const ssfr_field *one = flow(s, SSFR_FLOW_RK8PD, NULL);
    omp_set_num_threads(3);
    assert_true(test_same_bits(flow(s, SSFR_FLOW_RK8PD, NULL), one));
    omp_set_num_threads(n_threads);
}

/* The run that the flow takes over is there only where the pass ran. */
static void a_pass_that_was_left_out_has_no_run(void **state)
{
    ssfr_node_status status;
    test_twin *t = begin(state, 5, 4);
    assert_null(ssfr_graph_last_run(t->graph, 0));
    test_twin_give(t, "depth", bump(5, 4));
    test_twin_set(t, "iterations", "0");
    test_twin_run_if_needed(t, "smooth", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_null(ssfr_graph_last_run(t->graph, 0));
    test_twin_set(t, "iterations", "1");
    test_twin_run_if_needed(t, "smooth", &status);
    assert_non_null(ssfr_graph_last_run(t->graph, 0));
    assert_null(ssfr_graph_last_run(t->graph, 1));
    assert_null(ssfr_graph_last_run(t->graph, -1));
}

int main(void)
{
#define TEST(test) {#test, test, NULL, test_clean, "cpu"}
    const struct CMUnitTest tests[] = {
        TEST(a_plane_that_faces_the_viewer_stays),
        TEST(a_small_cosine_decays_as_diffusion_does),
        TEST(both_solvers_give_the_same_smooth_bump),
        TEST(the_twins_steps_converge_with_order_one),
        TEST(the_twin_converges_across_the_falloff),
        TEST(flickering_edges_end_and_are_told),
        TEST(holes_stay_and_pull_nothing),
        TEST(an_empty_image_and_no_steps_change_nothing),
        TEST(a_stiff_close_up_stays_smooth),
        TEST(a_run_out_of_steps_says_so),
        TEST(jacobian_of_flat_water_is_the_laplacian),
        TEST(jacobian_is_that_of_differences),
        TEST(images_that_are_too_large_are_refused),
        TEST(wild_depths_never_make_nan),
        TEST(threads_change_no_bit),
        TEST(a_pass_that_was_left_out_has_no_run),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

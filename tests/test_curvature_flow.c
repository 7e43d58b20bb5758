/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_curvature_flow.c: the rate by eq. 2.14 and by differential geometry; what grows, what stays, what spreads. */
#include "passes/curvature_flow.h"
#include "tests/pass_util.h"

/* ---- one step ---------------------------------------------------------------------------------------------------- */

/* One particle of 10 m: by default nothing within 50 m is a silhouette. aspect: width over height of a pixel. */
static test_twin *begin(void **state, int w, int h, double tan_y, double aspect)
{
    static const double c[1][3] = {{0, 0, -2.385}};
    test_twin *t = test_twin_create(state, "curvature_flow", w, h);
    t->scene.camera.tan_y = tan_y;
    t->scene.camera.tan_x = tan_y * w / h * aspect;
    test_twin_place(t, 1, c, 10, NULL);
    test_twin_set(t, "unstable", "allow");
    return t;
}

typedef struct cell { /* eye-space width and height of a pixel at unit depth */
    double x, y;
} cell;

static cell cell_of(const test_twin *t)
{
    const ssfr_camera *c = &t->scene.camera;
    return (cell){2 * c->tan_x / c->w, 2 * c->tan_y / c->h};
}

/* The bound of the step at depth z (design: |z| C_x C_y / (C_x + C_y)). */
static double bound(const test_twin *t, double z)
{
    const cell c = cell_of(t);
    return fabs(z) * c.x * c.y / (c.x + c.y);
}

static ssfr_field *flow(test_twin *t, const ssfr_field *depth, int steps, double dt)
{
    test_twin_set(t, "iterations", "%d", steps);
    test_twin_set(t, "dt", "%.17g", dt);
    test_twin_give(t, "depth", depth);
    return test_twin_run(t, "smooth");
}

typedef double surface(test_ray ray);

static ssfr_field *draw(const test_twin *t, surface *z)
{
    ssfr_field *depth = test_field(t->scene.camera.w, t->scene.camera.h, 1);
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++) *ssfr_field_at(depth, x, y) = z(test_ray_at(t, x, y, 1));
    if (t->gl) ssfr_field_round(depth);
    return depth;
}

/* dz/dt by one step of half the bound. */
static ssfr_field *rates(test_twin *t, const ssfr_field *depth)
{
    const double dt = 0.5 * bound(t, 2.385);
    ssfr_field *rate = flow(t, depth, 1, dt);
    for (int i = 0; i < depth->w * depth->h; i++) rate->data[i] = (rate->data[i] - depth->data[i]) / dt;
    return rate;
}

/* What rounding does to a rate: second differences of z over c, and z over dt = c |z| / 4. */
static double rounding(const test_twin *t)
{
    const cell c = cell_of(t);
    return 16 * t->eps / fmin(c.x, c.y);
}

/* ---- the formula ------------------------------------------------------------------------------------------------- */

typedef struct jet { /* z and its derivatives by u and v */
    double z, u, v, uu, uv, vv;
} jet;

/* Central differences are exact on a quadratic. */
static const jet quadratic = {-2.385, 0.31, -0.17, 0.83, -0.61, 0.47};

static jet jet_at(test_ray at)
{
    const jet k = quadratic;
    const double u = at.u, v = at.v;
    return (jet){k.z + k.u * u + k.v * v + k.uu * u * u / 2 + k.uv * u * v + k.vv * v * v / 2,
                 k.u + k.uu * u + k.uv * v, k.v + k.uv * u + k.vv * v, k.uu, k.uv, k.vv};
}

static double quadratic_surface(test_ray at)
{
    return jet_at(at).z;
}

/* -H by eqs 2.11, 2.14 to 2.16 as they are printed (with 3/2 for 2/3), in pixels. */
static double printed_rate(jet k, cell c, bool cross_term)
{
    const double zx = c.x * k.u, zy = c.y * k.v, zxx = c.x * c.x * k.uu, zyy = c.y * c.y * k.vv;
    const double zxy = cross_term ? c.x * c.y * k.uv : 0, cx2 = c.x * c.x, cy2 = c.y * c.y;
    const double D = cy2 * zx * zx + cx2 * zy * zy + cx2 * cy2 * k.z * k.z;
    const double Dx = 2 * (cy2 * zx * zxx + cx2 * zy * zxy + cx2 * cy2 * k.z * zx);
    const double Dy = 2 * (cy2 * zx * zxy + cx2 * zy * zyy + cx2 * cy2 * k.z * zy);
    return -(c.y * (zx * Dx / 2 - zxx * D) + c.x * (zy * Dy / 2 - zyy * D)) / (2 * pow(D, 1.5));
}

/* Mean curvature of the surface (-z u, -z v, z) by its fundamental forms, the normal towards the eye. */
static double mean_curvature(jet k, test_ray at)
{
    const double pu[3] = {-k.u * at.u - k.z, -k.u * at.v, k.u}, pv[3] = {-k.v * at.u, -k.v * at.v - k.z, k.v};
    const double puu[3] = {-k.uu * at.u - 2 * k.u, -k.uu * at.v, k.uu};
    const double pvv[3] = {-k.vv * at.u, -k.vv * at.v - 2 * k.v, k.vv};
    const double puv[3] = {-k.uv * at.u - k.v, -k.uv * at.v - k.u, k.uv};
    double n[3];
    ssfr_cross(pu, pv, n);
    ssfr_normalize(n);
    const double E = ssfr_dot(pu, pu), F = ssfr_dot(pu, pv), G = ssfr_dot(pv, pv);
    const double L = ssfr_dot(puu, n), M = ssfr_dot(puv, n), N = ssfr_dot(pvv, n);
    assert_true(n[0] * at.u + n[1] * at.v - n[2] < 0);
    return (E * N - 2 * F * M + G * L) / (2 * (E * G - F * F));
}

static void assert_rates(test_twin *t, bool cross_term, bool off_axis)
{
    const cell c = cell_of(t);
    const ssfr_field *rate = rates(t, draw(t, quadratic_surface));
    for (int y = 1; y < rate->h - 1; y++)
        for (int x = 1; x < rate->w - 1; x++) {
            const test_ray at = test_ray_at(t, x, y, 1);
            jet k = jet_at(at);
            if (!cross_term) k.uv = 0;
            const double exact = sqrt(c.x * c.y) * fabs(k.z) * mean_curvature(k, at);
            assert_close(*ssfr_field_at(rate, x, y), off_axis ? exact : printed_rate(k, c, cross_term), rounding(t), 0);
        }
}

static void rate_is_eq_2_14(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 1), *wide = begin(state, 20, 30, 0.8, 2.385);
    assert_rates(t, true, false);
    assert_rates(wide, true, false);
    test_twin_set(t, "cross_term", "0");
    assert_rates(t, false, false);
}

static void off_axis_rate_is_the_mean_curvature(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 1), *wide = begin(state, 20, 30, 0.8, 2.385);
    test_twin_set(t, "off_axis", "1");
    test_twin_set(wide, "off_axis", "1");
    assert_rates(t, true, true);
    assert_rates(wide, true, true);
    test_twin_set(t, "cross_term", "0");
    assert_rates(t, false, true);
}

static double saddle(test_ray at)
{
    return -2.385 + 0.9 * at.u * at.v;
}

/* On z0 + k u v both second derivatives vanish, and so does the whole of the flow's diffusion: what is left is
 * -C (2 p q t + z (p^2 + q^2)) / (2 S^(3/2)), with its first term only by the cross term. */
static void cross_term_changes_a_saddle(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    const ssfr_field *depth = draw(t, saddle), *with = rates(t, depth);
    test_twin_set(t, "cross_term", "0");
    const ssfr_field *without = rates(t, depth);
    double largest = 0;
    for (int y = 1; y < 23; y++)
        for (int x = 1; x < 31; x++) {
            const test_ray at = test_ray_at(t, x, y, 1);
            const double p = 0.9 * at.v, q = 0.9 * at.u, z = saddle(at), S = p * p + q * q + z * z;
            const double expected = -cell_of(t).x * p * q * 0.9 / (S * sqrt(S));
            assert_close(*ssfr_field_at(with, x, y) - *ssfr_field_at(without, x, y), expected, 2 * rounding(t), 0);
            largest = fmax(largest, fabs(expected));
        }
    assert_true(largest > 10 * rounding(t));
}

/* ---- diffusion on flat water ------------------------------------------------------------------------------------- */

static void constant_depth_is_a_fixed_point(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 2);
    ssfr_field *flat = test_field_filled(32, 24, 1, -2.385);
    if (t->gl) ssfr_field_round(flat);
    for (int k = 0; k < 4; k++) {
        test_twin_set(t, "off_axis", "%d", k / 2);
        test_twin_set(t, "cross_term", "%d", k % 2);
        assert_true(test_same_bits(flow(t, flat, 7, bound(t, 2.385)), flat));
    }
}

/* z0 + a cos(kx x) cos(ky y) with x, y from the corner in pixels: the image's border mirrors it, so it is a mode of
 * the whole image. One step multiplies it by 1 - dt (2 (1 - cos kx) / C_x + 2 (1 - cos ky) / C_y) / (2 |z|). What is
 * not linear makes other modes, and is a / |z| as large; floats hold only larger amplitudes. */
static void cosines_decay_at_the_discrete_rate(void **state)
{
    static const int modes[][2] = {{1, 0}, {0, 3}, {7, 4}, {20, 23}, {31, 0}};
    const double pi = 3.14159265358979323846, z0 = -2.385;
    test_twin *t = begin(state, 32, 24, 0.5, 1.6);
    const double a = t->gl ? 3e-3 : 1e-6, tolerance = t->gl ? 0.02 : 1e-6, dt = 0.8 * bound(t, z0);
    const cell c = cell_of(t);
    for (size_t m = 0; m < SSFR_COUNT(modes); m++) {
        const double kx = pi * modes[m][0] / 32, ky = pi * modes[m][1] / 24;
        ssfr_field *wave = test_field(32, 24, 1), *depth = test_field(32, 24, 1);
        double before = 0, after = 0;
        for (int i = 0; i < 32 * 24; i++) {
            wave->data[i] = cos(kx * (i % 32 + 0.5)) * cos(ky * (i / 32 + 0.5));
            depth->data[i] = z0 + a * wave->data[i];
        }
        if (t->gl) ssfr_field_round(depth);
        const ssfr_field *smooth = flow(t, depth, 1, dt);
        for (int i = 0; i < 32 * 24; i++) {
            before += wave->data[i] * (depth->data[i] - z0);
            after += wave->data[i] * (smooth->data[i] - z0);
        }
        const double lost = dt * ((1 - cos(kx)) / c.x + (1 - cos(ky)) / c.y) / fabs(z0);
        if (!t->gl || lost > 0.01) assert_close(1 - after / before, lost, 0, tolerance);
    }
}

/* A bump spreads like heat: n steps make it n dt / (C |z|) square pixels wide, along each axis with its own C. */
static void bump_spreads_by_n_dt_over_c_z(void **state)
{
    enum { N = 41, M = 20, STEPS = 10 };
    const double z0 = -2.385;
    test_twin *t = begin(state, N, N, 0.5, 1.6);
    const double a = t->gl ? 6e-3 : 1e-7, tolerance = t->gl ? 0.03 : 1e-5, dt = 0.9 * bound(t, z0);
    const cell c = cell_of(t);
    ssfr_field *depth = test_field_filled(N, N, 1, z0);
    if (t->gl) ssfr_field_round(depth);
    const double base = depth->data[0];
    *ssfr_field_at(depth, M, M) += a;
    const ssfr_field *smooth = flow(t, depth, STEPS, dt);
    double mass = 0, xx = 0, yy = 0;
    for (int y = M - STEPS; y <= M + STEPS; y++) /* a step moves nothing further than a pixel */
        for (int x = M - STEPS; x <= M + STEPS; x++) {
            const double d = *ssfr_field_at(smooth, x, y) - base;
            mass += d, xx += d * (x - M) * (x - M), yy += d * (y - M) * (y - M);
        }
    assert_close(mass, a, 0, tolerance);
    assert_close(xx / mass, STEPS * dt / (c.x * fabs(z0)), 0, tolerance);
    assert_close(yy / mass, STEPS * dt / (c.y * fabs(z0)), 0, tolerance);
}

/* ---- stability --------------------------------------------------------------------------------------------------- */

static ssfr_field *checkerboard(int w, int h, double z0, double a)
{
    ssfr_field *depth = test_field(w, h, 1);
    for (int i = 0; i < w * h; i++) depth->data[i] = z0 + ((i % w + i / w) % 2 ? a : -a);
    return depth;
}

static double roughness(const ssfr_field *depth, double z0)
{
    double largest = 0;
    for (int i = 0; i < depth->w * depth->h; i++) largest = fmax(largest, fabs(depth->data[i] - z0));
    return largest;
}

/* At the share s of the bound a checkerboard is multiplied by 1 - 2 s: it decays below 1 and grows above, and the
 * limit of each pixel's own step keeps it from growing. */
static void checkerboard_grows_only_beyond_the_bound(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 1.6);
    const double z0 = -2.5, a = 1e-3;
    const ssfr_field *board = checkerboard(32, 24, z0, a);
    assert_close(roughness(flow(t, board, 1, 0.9 * bound(t, z0)), z0), 0.8 * a, 0.01 * a, 0);
    assert_true(roughness(flow(t, board, 60, 0.9 * bound(t, z0)), z0) < 0.1 * a);
    assert_close(roughness(flow(t, board, 1, 1.1 * bound(t, z0)), z0), 1.2 * a, 0.01 * a, 0);
    assert_true(roughness(flow(t, board, 12, 1.1 * bound(t, z0)), z0) > 5 * a);
    test_twin_set(t, "unstable", "limit");
    assert_true(roughness(flow(t, board, 60, 1.1 * bound(t, z0)), z0) < 0.1 * a);
    assert_true(roughness(flow(t, board, 60, 1e6), z0) < 0.1 * a);
}

static double facing(test_ray at)
{
    return 0 * at.u - 2.385;
}

static double around_the_eye(test_ray at)
{
    return -2.385 / sqrt(1 + at.u * at.u + at.v * at.v);
}

static double leaning(test_ray at)
{
    return test_plane(-2.385, 0.2, -0.1, at);
}

/* How a little noise on a surface grows in 40 steps that the limit shortens to what it takes for safe. */
static double growth(test_twin *t, surface *z)
{
    uint64_t random = 5;
    ssfr_field *plain = draw(t, z), *noisy = draw(t, z);
    for (int i = 0; i < plain->w * plain->h; i++) noisy->data[i] += test_random(&random, -1e-5, 1e-5);
    if (t->gl) ssfr_field_round(noisy);
    const double before = test_difference(noisy, plain);
    return test_difference(flow(t, noisy, 40, 1e9), flow(t, plain, 40, 1e9)) / before;
}

/* For pixels of any shape, in both forms, on surfaces that face the eye, the ray, or neither, in a view of 127
 * degrees. In floats there is noise enough already. */
static void limit_is_safe_for_every_form_and_pixel(void **state)
{
    static surface *const surfaces[] = {facing, around_the_eye, leaning};
    static const double aspects[] = {0.25, 1, 3};
    for (size_t i = 0; i < SSFR_COUNT(surfaces); i++)
        for (size_t k = 0; k < SSFR_COUNT(aspects); k++) {
            test_twin *t = begin(state, 24, 20, 2 / fmax(1, aspects[k]), aspects[k]);
            test_twin_set(t, "unstable", "limit");
            for (int off_axis = 0; off_axis < 2; off_axis++) {
                test_twin_set(t, "off_axis", "%d", off_axis);
                assert_true(growth(t, surfaces[i]) < 1);
            }
        }
}

/* Two regions apart, each with 0.9 of its own bound. */
static void limit_is_each_pixels_own(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    ssfr_field *depth = test_field(32, 24, 1);
    uint64_t random = 9;
    for (int i = 0; i < 32 * 24; i++) depth->data[i] = (i % 32 < 16 ? -1.5 : -6) + test_random(&random, -1e-3, 1e-3);
    if (t->gl) ssfr_field_round(depth);
    test_twin_set(t, "depth_falloff", "0.1"); /* 1 m */
    test_twin_set(t, "unstable", "limit");
    const ssfr_field *limited = flow(t, depth, 1, 1e9);
    test_twin_set(t, "unstable", "allow");
    const ssfr_field *left = flow(t, depth, 1, 0.9 * bound(t, 1.5)), *right = flow(t, depth, 1, 0.9 * bound(t, 6));
    for (int i = 0; i < 32 * 24; i++) {
        const double expected = i % 32 < 16 ? left->data[i] : right->data[i];
        /* Each pixel's own depth, and so its own bound, varies by 1e-3. */
        assert_close(limited->data[i] - depth->data[i], expected - depth->data[i], 8 * t->eps, 2e-3);
    }
    assert_true(test_difference(limited, depth) > 1e-4);
}

/* How many pixels of an image bear less than dt, by the bound of each. */
static int count_unstable(const test_twin *t, const ssfr_field *depth, double dt, bool off_axis)
{
    int n = 0;
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++) {
            const double z = *ssfr_field_at(depth, x, y);
            const test_ray at = test_ray_at(t, x, y, 1);
            const double away = off_axis ? pow(1 + at.u * at.u + at.v * at.v, 1.5) : 1;
            n += ssfr_is_surface(z) && dt > bound(t, z) / away;
        }
    return n;
}

static void pixels_that_step_beyond_their_bound_are_counted(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    ssfr_field *depth = draw(t, leaning);
    for (int i = 5; i < 32 * 24; i += 50) depth->data[i] = -SSFR_EMPTY;
    for (int k = 0; k < 2; k++) {
        const double dt = bound(t, 2.3007) * (k ? 0.7 : 1);
        const int n = count_unstable(t, depth, dt, k);
        test_twin_set(t, "off_axis", "%d", k);
        test_twin_set(t, "unstable", "allow");
        flow(t, depth, 3, dt);
        assert_true(n > 32 && n < 32 * 24 - 32);
        assert_true(ssfr_graph_report(t->graph)->nodes->unstable == n);
        char text[64];
        snprintf(text, sizeof text, "is longer than %d pixels", n);
        test_twin_set(t, "unstable", "refuse");
        assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_run(t->graph, &t->scene, NULL), text);
        flow(t, depth, 3, 0.5 * dt);
        assert_true(ssfr_graph_report(t->graph)->nodes->unstable == 0);
    }
}

/* 5.6 times the bound of the nearest pixel is cut into ceil(5.6 / 0.9) = 7 parts; off the axis the bound is that of the
 * image's corner. */
static void a_step_beyond_the_bound_is_cut_into_equal_parts(void **state)
{
    static const double behind[1][3] = {{0, 0, 11}}; /* how near the fluid is, the depth alone tells */
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    const double z0 = -2.5, a = 1e-3, dt = 5.6 * bound(t, z0 + a);
    ssfr_field *board = checkerboard(32, 24, z0, a);
    if (t->gl) ssfr_field_round(board);
    test_twin_place(t, 1, behind, 10, NULL);
    const ssfr_field *parts = flow(t, board, 21, dt / 7);
    test_twin_set(t, "unstable", "substep");
    assert_true(test_same_bits(flow(t, board, 3, dt), parts));
    assert_true(roughness(parts, z0) < 0.1 * a);
    assert_true(ssfr_graph_report(t->graph)->nodes->iterations == 21);
    assert_true(test_same_bits(flow(t, board, 21, dt / 7), parts)); /* which needs no cut */
    assert_true(roughness(flow(t, board, 2, 1e9), z0) < 0.1 * a);
    assert_true(ssfr_graph_report(t->graph)->nodes->iterations == 2 * 64); /* at most */
    test_twin_set(t, "off_axis", "1");
    const double corner = pow(1 + 0.25 + ssfr_square(0.5 * 32 / 24), 1.5);
    assert_true(roughness(flow(t, board, 2, dt), z0) < 0.5 * a);
    assert_true(ssfr_graph_report(t->graph)->nodes->iterations == 2 * ceil(5.6 / 0.9 * corner));
}

/* `step` is a share of the bound at the mean or the nearest distance; off the axis that of the image's corner. */
static void step_is_a_share_of_the_bound_at_a_distance(void **state)
{
    static const double two[2][3] = {{0, 0, -2}, {0, 0, -6}};
    static const char *const words[] = {"mean", "nearest"};
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    const ssfr_field *depth = draw(t, quadratic_surface);
    const double corner = pow(1 + 0.25 + ssfr_square(0.5 * 32 / 24), 1.5);
    test_twin_place(t, 2, two, 10, NULL);
    test_twin_set(t, "step", "0.37");
    for (int k = 0; k < 4; k++) {
        test_twin_set(t, "reference", "%s", words[k % 2]);
        test_twin_set(t, "off_axis", "%d", k / 2);
        const double dt = 0.37 * bound(t, k % 2 ? 2 : 4) / (k / 2 ? corner : 1);
        assert_true(test_difference(flow(t, depth, 3, 0), flow(t, depth, 3, dt)) < 8 * t->eps);
    }
}

static void step_without_particles_knows_the_depth_that_is_given(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    static const char *const words[] = {"mean", "nearest"};
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    const ssfr_field *depth = draw(t, quadratic_surface);
    double sum = 0, nearest = INFINITY;
    for (int i = 0; i < 32 * 24; i++) sum -= depth->data[i], nearest = fmin(nearest, -depth->data[i]);
    test_twin_place(t, 1, behind, 10, NULL);
    test_twin_set(t, "step", "0.37");
    for (int k = 0; k < 2; k++) {
        test_twin_set(t, "reference", "%s", words[k]);
        const double dt = 0.37 * bound(t, k ? nearest : sum / (32 * 24));
        assert_true(test_difference(flow(t, depth, 3, 0), flow(t, depth, 3, dt)) < 8 * t->eps);
    }
}

/* ---- silhouettes ------------------------------------------------------------------------------------------------- */

/* A step as high as the falloff is none beyond it: listing A.13 compares by >. */
static void a_step_of_the_falloff_is_smoothed(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    for (int k = 0; k < 4; k++) { /* a column, and a row, before the others */
        ssfr_field *depth = test_field(32, 24, 1);
        for (int i = 0; i < 32 * 24; i++) depth->data[i] = (k / 2 ? i / 32 == 12 : i % 32 == 16) ? -2.25 : -2.5;
        test_twin_set(t, "depth_falloff", "%s", k % 2 ? "0.0249" : "0.025"); /* 0.25 m */
        const ssfr_field *smooth = flow(t, depth, 1, 0.5 * bound(t, 2.25));
        assert_int_equal(test_same_bits(smooth, depth), k % 2);
        assert_int_equal(*ssfr_field_at(smooth, 16, 12) < -2.25, 1 - k % 2);
    }
}

/* Noise on both sides of a step, and holes. */
static ssfr_field *cliff(double far_side, bool holes)
{
    ssfr_field *depth = test_field(32, 24, 1);
    uint64_t random = 11;
    for (int i = 0; i < 32 * 24; i++) {
        const double noise = test_random(&random, -0.01, 0.01), hole = test_random(&random, 0, 1);
        depth->data[i] = (i % 32 < 17 ? -2.5 : far_side) + noise;
        if (holes && hole < 0.1) depth->data[i] = -SSFR_EMPTY;
    }
    return depth;
}

/* What lies beyond a step is not seen at all: moving it changes no bit on this side, and each side smooths by itself.
 * */
static void nothing_crosses_a_step_beyond_the_falloff(void **state)
{
    static const char *const forms[] = {"0", "1"};
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    const double dt = 0.9 * bound(t, 2.4);
    test_twin_set(t, "depth_falloff", "0.1"); /* 1 m */
    for (int k = 0; k < 2; k++) {
        test_twin_set(t, "off_axis", "%s", forms[k]);
        const ssfr_field *near = flow(t, cliff(-4.5, false), 20, dt), *far = flow(t, cliff(-9.25, false), 20, dt);
        for (int i = 0; i < 32 * 24; i++)
            if (i % 32 < 17) assert_true(near->data[i] == far->data[i] && fabs(near->data[i] + 2.5) < 0.01);
    }
    test_twin_set(t, "depth_falloff", "0.5"); /* 5 m: now both steps are crossed */
    const ssfr_field *near = flow(t, cliff(-4.5, false), 20, dt), *far = flow(t, cliff(-6.25, false), 20, dt);
    assert_true(fabs(*ssfr_field_at(near, 16, 12) - *ssfr_field_at(far, 16, 12)) > 1e-5);
}

static void holes_stay_and_pull_nothing(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    const ssfr_field *depth = cliff(-2.5, true);
    for (int k = 0; k < 4; k++) {
        test_twin_set(t, "off_axis", "%d", k / 2);
        test_twin_set(t, "cross_term", "%d", k % 2);
        const ssfr_field *smooth = flow(t, depth, 20, 0.5 * bound(t, 2.5));
        for (int i = 0; i < 32 * 24; i++) {
            assert_int_equal(ssfr_is_surface(smooth->data[i]), ssfr_is_surface(depth->data[i]));
            if (ssfr_is_surface(depth->data[i])) assert_true(fabs(smooth->data[i] + 2.5) < 0.011);
        }
    }
}

/* Whatever is no surface. */
static void not_a_number_is_a_hole(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    ssfr_field *empty = draw(t, quadratic_surface), *nan = draw(t, quadratic_surface);
    for (int i = 0; i < 32 * 24; i += 5) empty->data[i] = -SSFR_EMPTY, nan->data[i] = i % 2 ? NAN : -INFINITY;
    for (int k = 0; k < 4; k++) {
        test_twin_set(t, "off_axis", "%d", k / 2);
        test_twin_set(t, "cross_term", "%d", k % 2);
        const ssfr_field *expected = flow(t, empty, 3, 0.5 * bound(t, 2.5)), *got = flow(t, nan, 3, 0.5 * bound(t, 2.5));
        for (int i = 0; i < 32 * 24; i++)
            assert_true(i % 5 == 0 ? !ssfr_is_surface(got->data[i]) : got->data[i] == expected->data[i]);
    }
}

/* Alone among holes there is no difference to smooth. */
static void a_pixel_without_neighbours_stays(void **state)
{
    test_twin *t = begin(state, 9, 7, 0.5, 1);
    ssfr_field *depth = test_field_filled(9, 7, 1, -SSFR_EMPTY);
    *ssfr_field_at(depth, 4, 3) = -2.5;
    for (int k = 0; k < 2; k++) {
        test_twin_set(t, "off_axis", "%d", k);
        assert_true(test_difference(flow(t, depth, 5, 0.9 * bound(t, 2.5)), depth) == 0);
    }
}

/* ---- planes and spheres ------------------------------------------------------------------------------------------ */

static double tilted(test_ray at)
{
    return test_plane(-2.385, 0.6, 0.25, at);
}

/* The largest curvature that the flow sees inside the image, 1/m. */
static double seen_curvature(void **state, surface *z, int w)
{
    test_twin *t = begin(state, w, w, 0.5, 1);
    test_twin_set(t, "off_axis", "1");
    const ssfr_field *depth = draw(t, z), *rate = rates(t, depth);
    double largest = 0;
    for (int y = 1; y < w - 1; y++)
        for (int x = 1; x < w - 1; x++)
            largest = fmax(largest, fabs(*ssfr_field_at(rate, x, y) / *ssfr_field_at(depth, x, y)) / cell_of(t).x);
    return largest;
}

/* The depth of a plane is a rational function of the pixel, so differences err by the square of a pixel. In floats the
 * rounding of z over the square of a pixel takes over at once: there the bound alone is tested. */
static void tilted_plane_is_a_fixed_point_off_the_axis(void **state)
{
    const test_twin *t = begin(state, 16, 16, 0.5, 1);
    double before = seen_curvature(state, tilted, 12);
    assert_true(before < 3e-3);
    if (t->gl) return;
    for (int w = 24; w <= 96; w *= 2) {
        const double error = seen_curvature(state, tilted, w);
        assert_close(test_order(before, error, 2), 2, 0.3, 0);
        before = error;
    }
}

static double tilted_in_x(test_ray at)
{
    return test_plane(-2.385, 0.6, 0, at);
}

/* With s the slope dz/dx in metres, z = z0 / (1 + s u): p = -s z^2 / z0 and r = 2 s^2 z^3 / z0^2, so eq. 2.14 comes to
 *     -H = -C s^2 z^2 / (2 z0^2 (1 + s^2 z^2 / z0^2)^(3/2)):
 * the plane recedes, 0.19 sigma^2 / |z| at most where n dt = sigma^2 / (C |z|). */
static void tilted_plane_recedes_in_the_printed_form(void **state)
{
    const double s = 0.6, z0 = -2.385;
    test_twin *t = begin(state, 48, 48, 0.5, 1);
    const double c = cell_of(t).x;
    const ssfr_field *depth = draw(t, tilted_in_x), *rate = rates(t, depth);
    for (int y = 1; y < 47; y++)
        for (int x = 1; x < 47; x++) {
            const double q = s * *ssfr_field_at(depth, x, y) / z0;
            const double expected = -c * q * q / (2 * pow(1 + q * q, 1.5));
            assert_close(*ssfr_field_at(rate, x, y), expected, rounding(t), 3 * c * c);
        }
}

static const double ball_radius = 2.385;
static const double *ball_centre;

static double ball(test_ray at)
{
    return test_meet(ball_centre, ball_radius, at).front;
}

/* The largest error of the rate against -C |z| / R, relative. */
static double ball_error(void **state, int w)
{
    test_twin *t = begin(state, w, w, 0.1, 1);
    t->scene.camera.tan_x = t->scene.camera.tan_y = 0.1;
    test_twin_set(t, "off_axis", "1");
    const ssfr_field *depth = draw(t, ball), *rate = rates(t, depth);
    double largest = 0;
    for (int y = 1; y < w - 1; y++)
        for (int x = 1; x < w - 1; x++) {
            const double expected = cell_of(t).x * *ssfr_field_at(depth, x, y) / ball_radius;
            largest = fmax(largest, fabs(*ssfr_field_at(rate, x, y) / expected - 1));
        }
    return largest;
}

static void sphere_recedes_by_its_curvature_off_the_axis(void **state)
{
    static const double centres[][3] = {{0, 0, -6}, {0.5, -0.4, -6}};
    const test_twin *t = begin(state, 16, 16, 0.5, 1);
    for (size_t i = 0; i < SSFR_COUNT(centres); i++) {
        ball_centre = centres[i];
        double before = ball_error(state, 16);
        assert_true(before < (t->gl ? 5e-3 : 1e-3));
        for (int w = 32; w <= 64 && !t->gl; w *= 2) {
            const double error = ball_error(state, w);
            assert_close(test_order(before, error, 2), 2, 0.25, 0);
            before = error;
        }
    }
}

/* ---- counting and resolutions ------------------------------------------------------------------------------------ */

static void no_iterations_copy(void **state)
{
    ssfr_node_status status;
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    const ssfr_field *depth = cliff(-4.5, true), *same = flow(t, depth, 0, 0.01);
    assert_true(test_difference(same, depth) < 5 * t->eps && test_count(same) == test_count(depth));
    assert_true(test_same_bits(same, test_twin_run_if_needed(t, "smooth", &status)));
    assert_int_equal(status, SSFR_NEEDLESS);
}

/* Odd and even counts end in the same image. */
static void steps_follow_each_other(void **state)
{
    test_twin *t = begin(state, 32, 24, 0.5, 1);
    const double dt = 0.5 * bound(t, 2.385);
    const ssfr_field *depth = draw(t, quadratic_surface), *one = flow(t, depth, 1, dt), *two = flow(t, one, 1, dt);
    assert_true(test_difference(one, depth) > 1e-4);
    assert_true(test_same_bits(flow(t, depth, 2, dt), two));
    assert_true(test_same_bits(flow(t, depth, 3, dt), flow(t, two, 1, dt)));
}

/* A half-resolution image is that of a camera with half as many pixels. */
static void low_resolution_has_wider_pixels(void **state)
{
    test_twin *full = begin(state, 64, 48, 0.5, 1), *half = begin(state, 32, 24, 0.5, 1);
    const double dt = 0.5 * bound(half, 2.385);
    const ssfr_field *depth = draw(half, quadratic_surface);
    for (int k = 0; k < 2; k++) {
        test_twin_set(full, "off_axis", "%d", k), test_twin_set(half, "off_axis", "%d", k);
        assert_true(test_difference(flow(full, depth, 3, dt), flow(half, depth, 3, dt)) < 16 * full->eps);
    }
}

static void flow_refuses_values_out_of_range(void **state)
{
    test_twin *t = begin(state, 8, 8, 0.5, 1);
    test_twin_refuses(t, "unstable", "yes", "curvature_flow.unstable");
    test_twin_refuses(t, "iterations", "-1", "curvature_flow.iterations");
    test_twin_refuses(t, "iterations", "2.385", "curvature_flow.iterations");
    test_twin_refuses(t, "step", "0", "curvature_flow.step");
    test_twin_refuses(t, "dt", "-1e-3", "curvature_flow.dt");
    test_twin_refuses(t, "depth_falloff", "inf", "curvature_flow.depth_falloff");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(rate_is_eq_2_14),
        TEST_TWINS(off_axis_rate_is_the_mean_curvature),
        TEST_TWINS(cross_term_changes_a_saddle),
        TEST_TWINS(constant_depth_is_a_fixed_point),
        TEST_TWINS(cosines_decay_at_the_discrete_rate),
        TEST_TWINS(bump_spreads_by_n_dt_over_c_z),
        TEST_TWINS(checkerboard_grows_only_beyond_the_bound),
        TEST_TWINS(limit_is_safe_for_every_form_and_pixel),
        TEST_TWINS(limit_is_each_pixels_own),
        TEST_TWINS(pixels_that_step_beyond_their_bound_are_counted),
        TEST_TWINS(a_step_beyond_the_bound_is_cut_into_equal_parts),
        TEST_TWINS(step_is_a_share_of_the_bound_at_a_distance),
        TEST_TWINS(step_without_particles_knows_the_depth_that_is_given),
        TEST_TWINS(a_step_of_the_falloff_is_smoothed),
        TEST_TWINS(nothing_crosses_a_step_beyond_the_falloff),
        TEST_TWINS(holes_stay_and_pull_nothing),
        TEST_TWINS(not_a_number_is_a_hole),
        TEST_TWINS(a_pixel_without_neighbours_stays),
        TEST_TWINS(tilted_plane_is_a_fixed_point_off_the_axis),
        TEST_TWINS(tilted_plane_recedes_in_the_printed_form),
        TEST_TWINS(sphere_recedes_by_its_curvature_off_the_axis),
        TEST_TWINS(no_iterations_copy),
        TEST_TWINS(steps_follow_each_other),
        TEST_TWINS(low_resolution_has_wider_pixels),
        TEST_TWINS(flow_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

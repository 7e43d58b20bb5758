/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_adaptive_flow.c: how many steps each pixel takes and how wide they smooth; all ways to the end are the same. */
#include "passes/curvature_flow.h"
#include "tests/pass_util.h"

enum { W = 36, H = 24 };

static const double radius = 10; /* m, of the one particle, behind the eye: how far the fluid is, the depth tells */

static test_twin *begin_pass(void **state, const char *pass, int w, int h)
{
    static const double behind[1][3] = {{0, 0, 5}};
    test_twin *t = test_twin_create(state, pass, w, h);
    test_twin_place(t, 1, behind, radius, NULL);
    return t;
}

static test_twin *begin(void **state, int w, int h)
{
    return begin_pass(state, "adaptive_flow", w, h);
}

/* Eye-space size of a pixel at unit depth: they are square. */
static double cell(const test_twin *t)
{
    return 2 * t->scene.camera.tan_x / t->scene.camera.w;
}

static double bound(const test_twin *t, double z)
{
    return fabs(z) * cell(t) / 2;
}

/* r_w in metres. */
static void set_radius(test_twin *t, double r_w)
{
    test_twin_set(t, "radius", "%.17g", r_w / radius);
}

static void set_dt(test_twin *t, double dt)
{
    test_twin_set(t, "dt", "%.17g", dt);
}

static void set_iterations(test_twin *t, int iterations)
{
    test_twin_set(t, "iterations", "%d", iterations);
}

static ssfr_field *smooth(test_twin *t, const ssfr_field *depth)
{
    test_twin_give(t, "depth", depth);
    return test_twin_run(t, "smooth");
}

static ssfr_field *rounded(const test_twin *t, ssfr_field *depth)
{
    if (t->gl) ssfr_field_round(depth);
    return depth;
}

static const ssfr_node_report *report(const test_twin *t)
{
    return ssfr_graph_report(t->graph)->nodes;
}

/* r_s of eq. 3.1 as erratum B6 has it. */
static double screen_radius(const test_twin *t, double r_w, double z)
{
    return r_w / (cell(t) * fabs(z));
}

/* Steps 0 to floor(r_s) + 1 run (listing A.12). */
static int paper_steps(const test_twin *t, double r_w, double z)
{
    return (int)floor(screen_radius(t, r_w, z)) + 2;
}

/* Three terraces with a little noise, 9 m and more apart, beyond each other's reach with a falloff of 5 m. */
static const double terraces[3] = {-1.83, -11.9, -40.7};

static ssfr_field *staircase(const test_twin *t, double noise)
{
    ssfr_field *depth = test_field(W, H, 1);
    uint64_t random = 3;
    for (int i = 0; i < W * H; i++) {
        const double z = terraces[i % W / (W / 3)];
        depth->data[i] = z * (1 + test_random(&random, -noise, noise));
    }
    return rounded(t, depth);
}

/* Depths from 1 to 10 m that are noisy by a fifth, and holes. */
static ssfr_field *rough(const test_twin *t)
{
    ssfr_field *depth = test_field(W, H, 1);
    uint64_t random = 7;
    for (int i = 0; i < W * H; i++) {
        const double noise = test_random(&random, -0.1, 0.1), hole = test_random(&random, 0, 1);
        depth->data[i] = -pow(10, (i % W) / (W - 1.0)) * (1 + noise);
        if (hole < 0.05) depth->data[i] = -SSFR_EMPTY;
    }
    return rounded(t, depth);
}

/* What steps of the same rate may differ by where the GPU contracts other products. */
static void assert_same_flow(const test_twin *t, const ssfr_field *a, const ssfr_field *b)
{
    for (int i = 0; i < a->w * a->h; i++)
        assert_close(a->data[i], b->data[i], 0, t->gl ? 64 * t->eps : 0);
}

/* ---- how many steps ---------------------------------------------------------------------------------------------- */

static void each_terrace_takes_the_steps_of_its_distance(void **state)
{
    test_twin *t = begin(state, W, H), *plain = begin_pass(state, "curvature_flow", W, H);
    const double r_w = 1.7, dt = 0.5 * bound(t, 1.8);
    const ssfr_field *depth = staircase(t, 1e-4);
    test_twin *const both[] = {t, plain};
    for (int k = 0; k < 2; k++) set_dt(both[k], dt), test_twin_set(both[k], "depth_falloff", "0.5");
    set_radius(t, r_w);
    const ssfr_field *got = smooth(t, depth);
    for (int k = 0; k < 3; k++) {
        set_iterations(plain, paper_steps(t, r_w, terraces[k]));
        const ssfr_field *expected = smooth(plain, depth);
        for (int i = 0; i < W * H; i++)
            if (i % W / (W / 3) == k) assert_close(got->data[i], expected->data[i], 0, t->gl ? 64 * t->eps : 0);
        assert_true(test_difference(expected, depth) > 1e-5);
    }
    assert_int_equal(paper_steps(t, r_w, terraces[0]), 24);
    assert_int_equal(paper_steps(t, r_w, terraces[1]), 5);
    assert_int_equal(paper_steps(t, r_w, terraces[2]), 3);
}

/* One step of the plain flow after another; a pixel takes it while its distance asks for it. */
static const ssfr_field *by_hand(test_twin *plain, const ssfr_field *first, double r_w, int cap, bool by_first)
{
    const ssfr_field *now = first;
    set_iterations(plain, 1);
    for (int i = 0; i < cap; i++) {
        ssfr_field *next = smooth(plain, now);
        bool moved = false;
        for (int k = 0; k < W * H; k++) {
            const bool takes = i <= screen_radius(plain, r_w, (by_first ? first : now)->data[k]) + 1;
            if (!takes) next->data[k] = now->data[k];
            moved |= takes && ssfr_is_surface(now->data[k]);
        }
        if (!moved) break;
        now = next;
    }
    return now;
}

static void every_pixel_takes_the_steps_of_the_listing(void **state)
{
    test_twin *t = begin(state, W, H), *plain = begin_pass(state, "curvature_flow", W, H);
    const double r_w = 1.1;
    const ssfr_field *depth = rough(t), *results[2];
    set_dt(t, 0.8 * bound(t, 0.9)), set_dt(plain, 0.8 * bound(t, 0.9));
    set_radius(t, r_w);
    for (int first = 0; first < 2; first++) {
        test_twin_set(t, "count", "%s", first ? "first" : "current");
        results[first] = smooth(t, depth);
        assert_same_flow(t, results[first], by_hand(plain, depth, r_w, 256, first));
    }
    assert_true(test_difference(results[0], results[1]) > 1e-3); /* whose depth counts matters */
}

static void the_number_of_steps_is_capped(void **state)
{
    static const int caps[] = {1, 7, 256};
    test_twin *t = begin(state, W, H), *plain = begin_pass(state, "curvature_flow", W, H);
    const ssfr_field *depth = rough(t);
    set_radius(t, 1e4); /* all pixels want more */
    set_dt(t, 0.8 * bound(t, 0.9)), set_dt(plain, 0.8 * bound(t, 0.9));
    for (size_t k = 0; k < SSFR_COUNT(caps); k++) {
        set_iterations(t, caps[k]), set_iterations(plain, caps[k]);
        assert_same_flow(t, smooth(t, depth), smooth(plain, depth));
        assert_true(report(t)->iterations == caps[k]);
    }
}

static void no_radius_or_no_iterations_gives_the_input_on(void **state)
{
    static const char *const keys[] = {"radius", "iterations"};
    ssfr_node_status status;
    for (int k = 0; k < 2; k++)
        for (int stop = 0; stop < 2; stop++) {
            test_twin *t = begin(state, W, H);
            const ssfr_field *depth = rough(t);
            test_twin_set(t, keys[k], "0");
            test_twin_set(t, "stop", "%s", stop ? "none" : "query");
            assert_true(test_same_bits(smooth(t, depth), depth));
            assert_true(report(t)->iterations == 0 && report(t)->taps == 0);
            assert_true(test_same_bits(test_twin_run_if_needed(t, "smooth", &status), depth));
            assert_int_equal(status, SSFR_NEEDLESS);
        }
}

static void nothing_runs_without_fluid(void **state)
{
    ssfr_node_status status;
    test_twin *t = begin(state, W, H);
    assert_int_equal(test_count(test_twin_run_if_needed(t, "smooth", &status)), 0);
    assert_int_equal(status, SSFR_NEEDLESS);
}

/* Eq. 3.1 has the width of the image: where pixels are not square C is that along x (erratum B6). */
static void the_radius_is_measured_along_rows(void **state)
{
    test_twin *t = begin(state, W, H);
    t->scene.camera.tan_x *= 1.7;
    set_radius(t, 1.7);
    smooth(t, rounded(t, test_field_filled(W, H, 1, terraces[0])));
    assert_true(report(t)->iterations == paper_steps(t, 1.7, terraces[0]));
}

/* With `steps` the radius has no meaning, and 0 does not stop it. */
static void steps_are_the_plain_flow(void **state)
{
    test_twin *t = begin(state, W, H), *plain = begin_pass(state, "curvature_flow", W, H);
    const ssfr_field *depth = rough(t);
    ssfr_node_status status;
    test_twin_set(t, "constant", "steps");
    test_twin_set(t, "radius", "0");
    set_iterations(t, 11), set_iterations(plain, 11);
    for (int k = 0; k < 4; k++) {
        test_twin_set(t, "off_axis", "%d", k / 2), test_twin_set(plain, "off_axis", "%d", k / 2);
        test_twin_set(t, "cross_term", "%d", k % 2), test_twin_set(plain, "cross_term", "%d", k % 2);
        assert_same_flow(t, smooth(t, depth), smooth(plain, depth));
    }
    test_twin_run_if_needed(t, "smooth", &status);
    assert_int_equal(status, SSFR_RAN);
}

/* ---- ways to the end --------------------------------------------------------------------------------------------- */

static void all_stops_and_copies_give_the_same_bits(void **state)
{
    static const char *const constants[] = {"paper", "metres", "steps"};
    static const char *const stops[] = {"none", "query", "bound", "tiles"};
    test_twin *t = begin(state, W, H);
    const ssfr_field *depth = rough(t);
    set_radius(t, 0.3);
    set_iterations(t, 60);
    for (int c = 0; c < 3; c++) {
        const ssfr_field *expected = NULL;
        test_twin_set(t, "constant", "%s", constants[c]);
        for (int k = 0; k < 16; k++) {
            test_twin_set(t, "stop", "%s", stops[k % 4]);
            test_twin_set(t, "copy", "%d", k / 4 % 2);
            test_twin_set(t, "query_interval", "%d", k < 8 ? 5 : 1);
            const ssfr_field *got = smooth(t, depth);
            if (!expected) expected = got;
            assert_true(test_same_bits(got, expected));
        }
        assert_true(test_difference(expected, depth) > 1e-2);
    }
}

/* A depth that is given may be nearer than the particles in view: these say how many steps there are, whatever ends
 * them. */
static void no_pixel_takes_more_steps_than_the_nearest_particle(void **state)
{
    static const char *const stops[] = {"none", "query", "bound", "tiles"};
    static const double ahead[1][3] = {{0, 0, -20}}; /* a graph that draws no splats knows its centre */
    test_twin *t = begin(state, W, H), *plain = begin_pass(state, "curvature_flow", W, H);
    const ssfr_field *depth = rough(t);
    test_twin_place(t, 1, ahead, radius, NULL);
    set_radius(t, 10.5 * cell(t) * 20);
    set_dt(t, 0.8 * bound(t, 0.9)), set_dt(plain, 0.8 * bound(t, 0.9));
    set_iterations(plain, 12);
    const ssfr_field *expected = smooth(plain, depth);
    for (size_t k = 0; k < SSFR_COUNT(stops); k++) {
        test_twin_set(t, "stop", "%s", stops[k]);
        assert_same_flow(t, smooth(t, depth), expected);
        assert_true(report(t)->iterations == (k == 0 ? 256 : k == 1 ? 15 : 12));
    }
}

/* On one terrace all pixels take n steps: sweep n is the first that changes nothing. */
static void the_report_says_how_many_sweeps_there_were(void **state)
{
    test_twin *t = begin(state, W, H);
    const double r_w = 1.7;
    ssfr_field *flat = rounded(t, test_field_filled(W, H, 1, terraces[0]));
    const int n = paper_steps(t, r_w, terraces[0]);
    set_radius(t, r_w);
    for (int interval = 1; interval <= 7; interval++) {
        test_twin_set(t, "query_interval", "%d", interval);
        test_twin_set(t, "stop", "query");
        smooth(t, flat);
        const int sweeps = (n + interval) / interval * interval; /* the end of the interval that sweep n is in */
        assert_true(report(t)->iterations == sweeps);
        const int copies = t->gl ? sweeps / interval : 0;
        assert_true(report(t)->taps == 9.0 * sweeps + copies);
    }
    test_twin_set(t, "stop", "bound");
    smooth(t, flat);
    assert_true(report(t)->iterations == n && report(t)->taps == 9.0 * n);
    const double bytes = report(t)->bytes;
    test_twin_set(t, "copy", "1");
    smooth(t, flat);
    assert_true(report(t)->taps == (t->gl ? 10.0 : 9.0) * n);
    assert_close(report(t)->bytes - bytes, t->gl ? n * 2.0 * sizeof(float) * W * H : 0, 0, 1e-12);
    test_twin_set(t, "copy", "0");
    test_twin_set(t, "stop", "none");
    test_twin_set(t, "cross_term", "0");
    smooth(t, flat);
    assert_true(report(t)->iterations == 256 && report(t)->taps == 5.0 * 256);
    assert_close(report(t)->bytes, bytes * 256 / n, 0, 1e-12);
}

/* Tiles that are each at their own distance, some of them empty, some half: beyond each other's reach. */
static ssfr_field *patchwork(const test_twin *t, int tiles_x, int tiles_y)
{
    ssfr_field *depth = test_field(SSFR_TILE * tiles_x - 5, SSFR_TILE * tiles_y - 9, 1);
    uint64_t random = 11;
    for (int i = 0; i < depth->w * depth->h; i++) {
        const int x = i % depth->w, y = i / depth->w, tile = x / SSFR_TILE + tiles_x * (y / SSFR_TILE);
        const double z = -1.83 * pow(1.5, tile * 5 % 9) * (1 + test_random(&random, -1e-3, 1e-3));
        depth->data[i] = tile % 4 == 1 || (tile % 4 == 2 && x % 7 < 3) ? -SSFR_EMPTY : z;
    }
    return rounded(t, depth);
}

static void tiles_that_are_done_are_left_out_and_no_bit_changes(void **state)
{
    static const char *const constants[] = {"paper", "metres", "steps"};
    test_twin *t = begin(state, 3 * SSFR_TILE - 5, 2 * SSFR_TILE - 9);
    const ssfr_field *depth = patchwork(t, 3, 2);
    test_twin_set(t, "depth_falloff", "0.05");
    for (int k = 0; k < 12; k++) {
        test_twin_set(t, "constant", "%s", constants[k % 3]);
        test_twin_set(t, "count", "%s", k / 3 % 2 ? "first" : "current");
        test_twin_set(t, "unstable", "%s", k < 6 ? "substep" : "limit");
        set_radius(t, k % 3 == 1 ? 6 * cell(t) : 0.13);
        set_dt(t, 1.3 * bound(t, 1.83));
        set_iterations(t, k % 3 == 2 ? 9 : 60);
        test_twin_set(t, "stop", "bound");
        const ssfr_field *expected = smooth(t, depth);
        const double tiles = report(t)->tiles, taps = report(t)->taps, bytes = report(t)->bytes;
        assert_true(tiles == 6 * report(t)->iterations);
        test_twin_set(t, "stop", "tiles");
        assert_true(test_same_bits(smooth(t, depth), expected));
        assert_true(report(t)->tiles < 0.9 * tiles && report(t)->tiles > 6);
        assert_close(report(t)->taps / taps, report(t)->tiles / tiles, 0, 1e-12);
        assert_close(report(t)->bytes / bytes, report(t)->tiles / tiles, 0, 1e-12);
    }
}

/* A tile is drawn once for each step, and once more, which finds it done; where there is no surface once in all. */
static void the_report_says_how_many_tiles_were_drawn(void **state)
{
    test_twin *t = begin(state, 4 * SSFR_TILE, SSFR_TILE);
    const double r_w = 1.7;
    ssfr_field *depth = test_field_filled(4 * SSFR_TILE, SSFR_TILE, 1, -SSFR_EMPTY);
    for (int i = 0; i < depth->w * depth->h; i++)
        if (i % depth->w / SSFR_TILE < 3) depth->data[i] = terraces[i % depth->w / SSFR_TILE];
    const int most = paper_steps(t, r_w, terraces[0]);
    set_radius(t, r_w);
    test_twin_set(t, "depth_falloff", "0.5");
    test_twin_set(t, "stop", "tiles");
    smooth(t, rounded(t, depth));
    assert_true(report(t)->iterations == most);
    assert_true(report(t)->tiles == most + paper_steps(t, r_w, terraces[1]) + paper_steps(t, r_w, terraces[2]) + 3);
}

/* What a run is lent grows with the image, and no frame that is like the last allocates. */
static void marks_of_tiles_are_allocated_once(void **state)
{
    test_twin *t = begin(state, W, H);
    test_twin_set(t, "stop", "tiles");
    test_twin_set(t, "unstable", "allow");
    set_radius(t, 0.3);
    for (int size = 1; size <= 3; size += 2) {
        t->scene.camera.w = size * W, t->scene.camera.h = size * H;
        const ssfr_field *depth = rounded(t, test_field_filled(size * W, size * H, 1, -2.385));
        smooth(t, depth);
        assert_true(ssfr_graph_report(t->graph)->allocations > 0);
        smooth(t, depth);
        assert_int_equal(ssfr_graph_report(t->graph)->allocations, 0);
        assert_true(report(t)->tiles >= 2 * size * size);
    }
}

/* ---- widths ------------------------------------------------------------------------------------------------------ */

enum { N = 101, M = N / 2 };

/* The mean square, m^2, of a bump's width along x; it is so low that the flow is linear. */
static double square_width(test_twin *t, double z0)
{
    ssfr_field *depth = test_field_filled(N, N, 1, z0);
    double mass = 0, xx = 0;
    *ssfr_field_at(depth, M, M) += 1e-6 * fabs(z0);
    const ssfr_field *wide = smooth(t, depth);
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            const double d = *ssfr_field_at(wide, x, y) - z0;
            mass += d, xx += d * (x - M) * (x - M);
        }
    assert_close(mass, 1e-6 * fabs(z0), 0, 1e-4);
    return xx / mass * ssfr_square(cell(t) * z0);
}

static const double distances[] = {1.13, 4.27, 17.9};

/* n dt C |z| with n = floor(r_s) + 2, which comes to r_w dt but for what the steps beyond r_s add. */
static void paper_smooths_alike_at_every_distance(void **state)
{
    test_twin *t = begin(state, N, N);
    const double dt = 0.4 * bound(t, distances[0]), r_w = 200.3 * cell(t) * distances[0];
    set_radius(t, r_w), set_dt(t, dt);
    for (size_t i = 0; i < SSFR_COUNT(distances); i++) {
        const int n = paper_steps(t, r_w, distances[i]);
        const double width2 = square_width(t, -distances[i]);
        assert_close(width2, n * dt * cell(t) * distances[i], 0, 1e-4);
        assert_close(width2 / (r_w * dt), 1, 2 / screen_radius(t, r_w, distances[i]), 0);
    }
}

static void a_fixed_number_smooths_by_the_root_of_the_distance(void **state)
{
    test_twin *t = begin_pass(state, "curvature_flow", N, N);
    const double dt = 0.4 * bound(t, distances[0]);
    set_iterations(t, 60), set_dt(t, dt);
    for (size_t i = 0; i < SSFR_COUNT(distances); i++)
        assert_close(square_width(t, -distances[i]), 60 * dt * cell(t) * distances[i], 0, 1e-4);
}

/* Whatever dt is, and although the limit shortens it where the surface is near. */
static void metres_smooth_by_the_radius(void **state)
{
    test_twin *t = begin(state, N, N);
    const double sigma = 6.1 * cell(t) * distances[0];
    test_twin_set(t, "constant", "metres");
    set_radius(t, sigma);
    for (int k = 0; k < 4; k++) {
        test_twin_set(t, "unstable", k == 3 ? "substep" : "limit");
        set_dt(t, k == 0 ? 0.31 * bound(t, distances[0]) : k % 2 ? 0.7 * bound(t, distances[1]) : 1e9);
        for (size_t i = 0; i < SSFR_COUNT(distances); i++)
            assert_close(square_width(t, -distances[i]), sigma * sigma, 0, 1e-4);
    }
}

/* The variant that sec. 3.1 rejects has the same width at every distance with a fixed number of steps. */
static void over_depth_smooths_alike_in_a_fixed_number_of_steps(void **state)
{
    test_twin *t = begin(state, N, N);
    const double dt = 0.8 * bound(t, distances[0]) * distances[0];
    test_twin_set(t, "evolution", "over_depth");
    test_twin_set(t, "constant", "steps");
    set_iterations(t, 60), set_dt(t, dt);
    for (size_t i = 0; i < SSFR_COUNT(distances); i++)
        assert_close(square_width(t, -distances[i]), 60 * dt * cell(t), 0, 1e-4);
}

/* ---- stability --------------------------------------------------------------------------------------------------- */

static ssfr_field *checkerboard(const test_twin *t, double z0, double a)
{
    ssfr_field *depth = test_field(W, H, 1);
    for (int i = 0; i < W * H; i++) depth->data[i] = z0 + ((i % W + i / W) % 2 ? a : -a);
    return rounded(t, depth);
}

static double roughness(const ssfr_field *depth, double z0)
{
    double largest = 0;
    for (int i = 0; i < depth->w * depth->h; i++) largest = fmax(largest, fabs(depth->data[i] - z0));
    return largest;
}

/* At the share s of the bound a checkerboard is multiplied by 1 - 2 s; the bound of -H / |z| is |z|^2 C / 2. */
static void ripples_grow_only_where_that_is_allowed_and_that_is_said(void **state)
{
    const double z0 = -3.3, a = 1e-3;
    for (int over_depth = 0; over_depth < 2; over_depth++) {
        test_twin *t = begin(state, W, H);
        const double stable = bound(t, z0) * (over_depth ? fabs(z0) : 1);
        const ssfr_field *board = checkerboard(t, z0, a);
        test_twin_set(t, "constant", "steps");
        test_twin_set(t, "evolution", "%s", over_depth ? "over_depth" : "curvature");
        set_iterations(t, 12);
        for (int k = 0; k < 4; k++) { /* limit, substep, allow, refuse */
            test_twin_set(t, "unstable", "%s", ssfr_curvature_flow_unstable[k < 2 ? k : 5 - k]);
            set_dt(t, 0.9 * stable);
            assert_true(roughness(smooth(t, board), z0) < 0.2 * a);
            assert_true(report(t)->unstable == 0);
            if (k == 3) break;
            set_dt(t, 1.1 * stable);
            assert_true(k == 2 ? roughness(smooth(t, board), z0) > 5 * a : roughness(smooth(t, board), z0) < 0.2 * a);
            assert_true(report(t)->unstable == (k == 2 ? W * H : 0));
            set_dt(t, 1e9);
            if (k < 2) assert_true(roughness(smooth(t, board), z0) < 0.2 * a);
        }
        set_dt(t, 1.1 * stable);
        test_twin_give(t, "depth", board);
        assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_run(t->graph, &t->scene, NULL),
                     over_depth ? "m^3 is longer than 864 pixels (100 % of the image) bear"
                                : "m^2 is longer than 864 pixels (100 % of the image) bear");
    }
}

/* The steps of each distance, each of them in as many parts as the nearest asks for. */
static void parts_of_steps_add_up(void **state)
{
    test_twin *t = begin(state, W, H), *plain = begin_pass(state, "curvature_flow", W, H);
    const double r_w = 1.7, dt = 3.1 * bound(t, terraces[0]);
    const ssfr_field *depth = staircase(t, 1e-4);
    test_twin_set(t, "depth_falloff", "0.5"), test_twin_set(plain, "depth_falloff", "0.5");
    test_twin_set(t, "unstable", "substep");
    set_radius(t, r_w);
    set_dt(t, dt), set_dt(plain, dt / 4); /* 3.1 / 0.9, rounded up */
    for (int stop = 0; stop < 2; stop++) {
        test_twin_set(t, "stop", "%s", stop ? "tiles" : "query");
        const ssfr_field *got = smooth(t, depth);
        for (int k = 0; k < 3; k++) {
            set_iterations(plain, 4 * paper_steps(t, r_w, terraces[k]));
            const ssfr_field *expected = smooth(plain, depth);
            for (int i = 0; i < W * H; i++)
                if (i % W / (W / 3) == k) assert_close(got->data[i], expected->data[i], 0, t->gl ? 64 * t->eps : 0);
        }
    }
    assert_true(report(t)->iterations == 4 * paper_steps(t, r_w, terraces[0]));
}

/* What counts as far bears a longer step: parts are those of the distance that it counts as. */
static void parts_know_the_threshold(void **state)
{
    test_twin *t = begin(state, W, H);
    const ssfr_field *flat = rounded(t, test_field_filled(W, H, 1, terraces[0]));
    test_twin_set(t, "unstable", "substep");
    set_radius(t, 1.7);
    for (int k = 0; k < 2; k++) {
        test_twin_set(t, "threshold_min", "%d", 5 * k);
        set_dt(t, 3.1 * bound(t, k ? 5 : terraces[0]));
        smooth(t, flat);
        assert_true(report(t)->iterations == 4 * paper_steps(t, 1.7, terraces[0]));
    }
}

static void step_is_a_share_of_the_bound_of_the_evolution(void **state)
{
    test_twin *t = begin(state, W, H);
    const ssfr_field *depth = checkerboard(t, -3.3, 1e-2);
    double nearest = INFINITY;
    for (int i = 0; i < W * H; i++) nearest = fmin(nearest, -depth->data[i]);
    set_radius(t, 1);
    test_twin_set(t, "reference", "nearest");
    for (int over_depth = 0; over_depth < 2; over_depth++) {
        test_twin_set(t, "evolution", "%s", over_depth ? "over_depth" : "curvature");
        test_twin_set(t, "step", "0.37");
        set_dt(t, 0);
        const ssfr_field *by_share = smooth(t, depth);
        set_dt(t, 0.37 * bound(t, nearest) * (over_depth ? nearest : 1));
        assert_true(test_difference(by_share, smooth(t, depth)) < 32 * t->eps);
        assert_true(test_difference(by_share, depth) > 1e-3);
    }
}

/* A checkerboard that counts as twice as far changes half as much; what is beyond does not change by a bit. */
static void threshold_makes_near_surfaces_count_as_far(void **state)
{
    test_twin *t = begin(state, W, H);
    const double dt = 0.2 * bound(t, 1);
    const ssfr_field *near = checkerboard(t, -1, 1e-4), *far = checkerboard(t, -2.5, 1e-4);
    set_radius(t, 1), set_dt(t, dt);
    set_iterations(t, 1);
    const ssfr_field *plain_near = smooth(t, near), *plain_far = smooth(t, far);
    test_twin_set(t, "threshold_min", "2");
    const ssfr_field *capped = smooth(t, near);
    assert_true(test_same_bits(smooth(t, far), plain_far));
    for (int i = 0; i < W * H; i++)
        assert_close(capped->data[i] - near->data[i], (plain_near->data[i] - near->data[i]) / 2, 4 * t->eps, 1e-3);
    set_dt(t, 1e9); /* and its bound is that of the distance it counts as */
    const ssfr_field *limited = smooth(t, near);
    for (int y = 1; y < H - 1; y++)
        for (int x = 1; x < W - 1; x++) {
            const double before = *ssfr_field_at(near, x, y);
            assert_close(*ssfr_field_at(limited, x, y) - before, -1.8 * (before + 1), 8 * t->eps, 1e-3);
        }
    test_twin_set(t, "unstable", "allow");
    set_dt(t, 0.99 * bound(t, 2));
    smooth(t, near);
    assert_true(report(t)->unstable == 0);
    test_twin_set(t, "threshold_min", "0");
    smooth(t, near);
    assert_true(report(t)->unstable == W * H);
}

/* ---- extremes ---------------------------------------------------------------------------------------------------- */

static void a_plane_that_faces_the_eye_stays(void **state)
{
    static const char *const constants[] = {"paper", "metres", "steps"};
    test_twin *t = begin(state, W, H);
    const ssfr_field *flat = rounded(t, test_field_filled(W, H, 1, -2.385));
    set_radius(t, 1);
    for (int k = 0; k < 12; k++) {
        test_twin_set(t, "constant", "%s", constants[k % 3]);
        test_twin_set(t, "evolution", "%s", k / 3 % 2 ? "over_depth" : "curvature");
        test_twin_set(t, "off_axis", "%d", k / 6);
        assert_true(test_same_bits(smooth(t, flat), flat));
    }
}

static void nothing_is_smoothed_with_a_falloff_of_0_and_all_without(void **state)
{
    test_twin *t = begin(state, W, H);
    const ssfr_field *depth = staircase(t, 1e-2);
    set_radius(t, 1);
    test_twin_set(t, "depth_falloff", "0");
    assert_true(test_same_bits(smooth(t, depth), depth));
    test_twin_set(t, "depth_falloff", "0.5");
    const ssfr_field *each = smooth(t, depth);
    test_twin_set(t, "depth_falloff", "1e6");
    const ssfr_field *all = smooth(t, depth);
    for (int x = W / 3 - 1; x < W - 1; x += W / 3) /* at the edges of the terraces */
        assert_true(fabs(*ssfr_field_at(all, x, H / 2) - *ssfr_field_at(each, x, H / 2)) > 1e-3);
    for (int i = 0; i < W * H; i++) assert_true(all->data[i] <= -1.7 && all->data[i] >= -42);
}

static void holes_and_empty_images_stay(void **state)
{
    for (int copy = 0; copy < 2; copy++) {
        test_twin *t = begin(state, W, H);
        const ssfr_field *empty = test_field_filled(W, H, 1, -SSFR_EMPTY), *depth = rough(t);
        test_twin_set(t, "copy", "%d", copy);
        test_twin_set(t, "stop", "query");
        set_radius(t, 1);
        assert_int_equal(test_count(smooth(t, empty)), 0);
        const ssfr_field *got = smooth(t, depth);
        for (int i = 0; i < W * H; i++)
            assert_int_equal(ssfr_is_surface(got->data[i]), ssfr_is_surface(depth->data[i]));
    }
}

/* Beyond 10 km, too, where the paper's empty value lies (erratum B17). The farthest take two steps. */
static void a_metre_to_a_hundred_kilometres_is_smoothed_in_one_image(void **state)
{
    test_twin *t = begin(state, W, H);
    ssfr_field *depth = test_field(W, H, 1);
    uint64_t random = 5;
    for (int i = 0; i < W * H; i++)
        depth->data[i] = -pow(1e5, i % W / (W - 1.0)) * (1 + test_random(&random, -1e-2, 1e-2));
    rounded(t, depth);
    set_radius(t, 1);
    test_twin_set(t, "depth_falloff", "1e6");
    for (int k = 0; k < 6; k++) {
        test_twin_set(t, "constant", "%s", k % 3 == 0 ? "paper" : k % 3 == 1 ? "metres" : "steps");
        test_twin_set(t, "off_axis", "%d", k / 3);
        const ssfr_field *got = smooth(t, depth);
        for (int i = 0; i < W * H; i++) assert_true(got->data[i] <= -0.9 && got->data[i] >= -1.02e5);
    }
    test_twin_set(t, "off_axis", "0");
    test_twin_set(t, "constant", "paper");
    const ssfr_field *all = smooth(t, depth);
    set_iterations(t, 2);
    const ssfr_field *two = smooth(t, depth);
    for (int y = 0; y < H; y++) {
        assert_true(*ssfr_field_at(all, W - 1, y) != *ssfr_field_at(depth, W - 1, y));
        assert_true(*ssfr_field_at(all, W - 1, y) == *ssfr_field_at(two, W - 1, y));
        assert_true(*ssfr_field_at(all, 0, y) != *ssfr_field_at(two, 0, y));
    }
}

/* At the near plane the cap of 256 holds. */
static void at_the_near_plane_the_cap_holds(void **state)
{
    test_twin *t = begin(state, W, H);
    const ssfr_field *board = checkerboard(t, -0.0101, 1e-5);
    set_radius(t, 0.24);
    const ssfr_field *got = smooth(t, board);
    assert_true(report(t)->iterations == 256);
    assert_true(roughness(got, -0.0101) < 1e-6);
}

/* A half-resolution image is that of a camera with half as many pixels, which are twice as wide (erratum B6). */
static void half_the_resolution_takes_half_the_steps(void **state)
{
    test_twin *full = begin(state, 2 * W, 2 * H), *half = begin(state, W, H);
    const ssfr_field *depth = rough(full);
    set_radius(full, 1.1), set_radius(half, 1.1);
    set_dt(full, 0.5 * bound(half, 0.9)), set_dt(half, 0.5 * bound(half, 0.9));
    assert_same_flow(full, smooth(full, depth), smooth(half, depth));
    assert_true(report(full)->iterations == report(half)->iterations);
    assert_true(screen_radius(full, 1.1, 1) == 2 * screen_radius(half, 1.1, 1));
}

static void values_out_of_range_are_refused(void **state)
{
    test_twin *t = begin(state, 8, 8);
    test_twin_refuses(t, "radius", "-1", "adaptive_flow.radius");
    test_twin_refuses(t, "radius", "nan", "adaptive_flow.radius");
    test_twin_refuses(t, "iterations", "-1", "adaptive_flow.iterations");
    test_twin_refuses(t, "query_interval", "0", "adaptive_flow.query_interval");
    test_twin_refuses(t, "threshold_min", "-2.385", "adaptive_flow.threshold_min");
    test_twin_refuses(t, "constant", "metre", "adaptive_flow.constant");
    test_twin_refuses(t, "stop", "tile", "adaptive_flow.stop");
    test_twin_refuses(t, "unstable", "limits", "adaptive_flow.unstable");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(each_terrace_takes_the_steps_of_its_distance),
        TEST_TWINS(every_pixel_takes_the_steps_of_the_listing),
        TEST_TWINS(the_number_of_steps_is_capped),
        TEST_TWINS(no_radius_or_no_iterations_gives_the_input_on),
        TEST_TWINS(nothing_runs_without_fluid),
        TEST_TWINS(the_radius_is_measured_along_rows),
        TEST_TWINS(steps_are_the_plain_flow),
        TEST_TWINS(all_stops_and_copies_give_the_same_bits),
        TEST_TWINS(no_pixel_takes_more_steps_than_the_nearest_particle),
        TEST_TWINS(the_report_says_how_many_sweeps_there_were),
        TEST_TWINS(tiles_that_are_done_are_left_out_and_no_bit_changes),
        TEST_TWINS(the_report_says_how_many_tiles_were_drawn),
        TEST_TWINS(marks_of_tiles_are_allocated_once),
        TEST_CPU(paper_smooths_alike_at_every_distance),
        TEST_CPU(a_fixed_number_smooths_by_the_root_of_the_distance),
        TEST_CPU(metres_smooth_by_the_radius),
        TEST_CPU(over_depth_smooths_alike_in_a_fixed_number_of_steps),
        TEST_TWINS(ripples_grow_only_where_that_is_allowed_and_that_is_said),
        TEST_TWINS(parts_of_steps_add_up),
        TEST_TWINS(parts_know_the_threshold),
        TEST_TWINS(step_is_a_share_of_the_bound_of_the_evolution),
        TEST_TWINS(threshold_makes_near_surfaces_count_as_far),
        TEST_TWINS(a_plane_that_faces_the_eye_stays),
        TEST_TWINS(nothing_is_smoothed_with_a_falloff_of_0_and_all_without),
        TEST_TWINS(holes_and_empty_images_stay),
        TEST_TWINS(a_metre_to_a_hundred_kilometres_is_smoothed_in_one_image),
        TEST_TWINS(at_the_near_plane_the_cap_holds),
        TEST_TWINS(half_the_resolution_takes_half_the_steps),
        TEST_TWINS(values_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

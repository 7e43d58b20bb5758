/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_spray.c: what spray adds to the picture against its formula, what hides it, and that nothing else changes. */
#include "tests/pass_util.h"

enum { W = 64, H = 48, N = W * H, MOST = 1500 };
static const double color[3] = {0.5, 0.25, 0.125}, radius = 0.25, z0 = -2.385;
static const double middle[1][3] = {{0.21, -0.13, -2.385}};

/* A picture of many colours that are floats, and colours of spray whose sums with it are not rounded much. */
static ssfr_field *make_picture(void)
{
    ssfr_field *picture = test_field(W, H, 3);
    uint64_t random = 29;
    for (int i = 0; i < 3 * N; i++) picture->data[i] = (double)(float)test_random(&random, 0, 1);
    return picture;
}

static test_twin *begin(void **state, ssfr_field **picture)
{
    static const char *const names[] = {"color_r", "color_g", "color_b"};
    test_twin *t = test_twin_create(state, "spray", W, H);
    *picture = make_picture();
    test_twin_give(t, "water", *picture);
    for (int k = 0; k < 3; k++) test_twin_set(t, names[k], "%g", color[k]);
    return t;
}

static const ssfr_field *draw(test_twin *t, size_t n, const double (*c)[3], const float (*v)[3])
{
    test_twin_place_moving(t, n, c, radius, NULL, v);
    return test_twin_run(t, "color");
}

/* r^2 on a disc that is parallel to the image. */
static double r2_at(const test_twin *t, const double c[3], int i)
{
    const test_ray ray = test_ray_at(t, i % W, i / W, 1);
    return (ssfr_square(-ray.u * c[2] - c[0]) + ssfr_square(-ray.v * c[2] - c[1])) / (radius * radius);
}

/* How many of these discs are met at each pixel, each with its share of the colour. */
static void assert_sum(const test_twin *t, const ssfr_field *picture, const ssfr_field *seen, double falloff, bool root,
                       double strength)
{
    int n = 0;
    for (int i = 0; i < N; i++) {
        const double r2 = r2_at(t, middle[0], i);
        const double share = r2 < 1 ? strength * exp(-falloff * (root ? sqrt(r2) : r2)) : 0;
        if (fabs(r2 - 1) < 1e-4) continue; /* the rim */
        n += r2 < 1;
        for (int k = 0; k < 3; k++)
            assert_close(seen->data[3 * i + k] - picture->data[3 * i + k], color[k] * share,
                         (falloff + 4) * (1e-6 + 20 * t->eps) * strength, 0);
    }
    assert_true(n > 50);
}

/* ---- how much it adds -------------------------------------------------------------------------------------------- */

static void spray_falls_off_exponentially_from_its_middle(void **state)
{
    static const double falloffs[] = {0, 1, 2.385, 16};
    ssfr_field *picture;
    test_twin *t = begin(state, &picture);
    for (size_t i = 0; i < SSFR_COUNT(falloffs); i++)
        for (int root = 0; root < 2; root++) {
            test_twin_set(t, "falloff", "%g", falloffs[i]);
            test_twin_set(t, "kernel", "%s", root ? "exponential" : "gaussian");
            assert_sum(t, picture, draw(t, 1, middle, NULL), falloffs[i], root, 1);
        }
}

static void strength_multiplies_the_colour(void **state)
{
    static const double strengths[] = {0.375, 2, 100};
    ssfr_field *picture;
    test_twin *t = begin(state, &picture);
    for (size_t i = 0; i < SSFR_COUNT(strengths); i++) {
        test_twin_set(t, "strength", "%g", strengths[i]);
        assert_sum(t, picture, draw(t, 1, middle, NULL), 4, false, strengths[i]);
    }
}

static void spray_adds_up(void **state)
{
    enum { MANY = 64 };
    static double same[MANY][3];
    ssfr_field *picture;
    test_twin *t = begin(state, &picture);
    for (int i = 0; i < MANY; i++) memcpy(same[i], middle[0], sizeof same[i]);
    assert_sum(t, picture, draw(t, MANY, (const double(*)[3])same, NULL), 4, false, MANY);
}

/* Every pixel has the sum of what each particle adds by itself. */
static void spray_that_moves_adds_up_whatever_is_before(void **state)
{
    enum { FEW = 10 };
    double c[FEW][3];
    float v[FEW][3];
    uint64_t seed = 47;
    ssfr_field *picture;
    test_twin *t = begin(state, &picture);
    for (int i = 0; i < FEW; i++)
        for (int k = 0; k < 3; k++) {
            c[i][k] = k == 2 ? test_random(&seed, -3, -2) : test_random(&seed, -0.5, 0.5);
            v[i][k] = (float)test_random(&seed, -3, 3);
        }
    ssfr_field *expected = make_picture();
    int n_different = 0;
    for (int i = 0; i < FEW; i++) {
        const ssfr_field *one = draw(t, 1, (const double(*)[3])c + i, (const float(*)[3])v + i);
        for (int k = 0; k < 3 * N; k++) expected->data[k] += one->data[k] - picture->data[k];
    }
    const ssfr_field *all = draw(t, FEW, (const double(*)[3])c, (const float(*)[3])v);
    for (int k = 0; k < 3 * N; k++) n_different += !(fabs(all->data[k] - expected->data[k]) <= 1e-5);
    assert_true(n_different <= 6); /* at rims: places are floats relative to their packet's middle */
    assert_true(test_difference(all, picture) > 0.5);
}

/* Twice as many pixels, each pair of which adds what one did: e^(-falloff a^2) over the longer axis. */
static void motion_draws_spray_out_and_its_light_with_it(void **state)
{
    static const float across[1][3] = {{0, 3, 0}}, slow[1][3] = {{0, 0.49f, 0}};
    double sums[3] = {0};
    ssfr_field *picture;
    test_twin *t = begin(state, &picture);
    for (int i = 0; i < 3; i++) {
        test_twin_set(t, "orientation", "%s", i == 2 ? "screen" : "velocity");
        const ssfr_field *seen = draw(t, 1, middle, i == 1 ? slow : across);
        for (int k = 0; k < 3 * N; k++) sums[i] += seen->data[k] - picture->data[k];
    }
    assert_close(sums[0], 2 * sums[2], 0, 0.02);
    assert_true(sums[1] == sums[2]);
}

/* ---- what hides it ----------------------------------------------------------------------------------------------- */

/* 1: the left half of the picture, nearer than the spray. */
static ssfr_field *half_before(double before)
{
    ssfr_field *depth = test_field_filled(W, H, 1, -SSFR_EMPTY);
    for (int i = 0; i < N; i++)
        if (i % W < W / 2 + 5) depth->data[i] = before;
    return depth;
}

static int n_changed(const ssfr_field *picture, const ssfr_field *seen, bool left)
{
    int n = 0;
    for (int i = 0; i < N; i++)
        if ((i % W < W / 2 + 5) == left)
            n += memcmp(seen->data + 3 * i, picture->data + 3 * i, 3 * sizeof *seen->data) != 0;
    return n;
}

static void scene_water_and_foam_hide_spray_where_they_are_before_it(void **state)
{
    static const char *const ports[] = {"scene_depth", "depth", "foam_depth"};
    ssfr_field *picture;
    test_twin *t = begin(state, &picture);
    const ssfr_field *open = draw(t, 1, middle, NULL);
    const int n_left = n_changed(picture, open, true), n_right = n_changed(picture, open, false);
    assert_true(n_left > 20 && n_right > 20);
    for (int port = 0; port < 3; port++)
        for (int by_surface = 0; by_surface < 2; by_surface++) {
            const bool hides = port == 0 || by_surface;
            test_twin_set(t, "occlusion", "%s", by_surface ? "surface" : "scene");
            for (int i = 0; i < 3; i++) test_twin_give(t, ports[i], test_field_filled(W, H, 1, -SSFR_EMPTY));
            test_twin_give(t, ports[port], half_before(z0 + radius + 0.01));
            const ssfr_field *seen = draw(t, 1, middle, NULL);
            assert_int_equal(n_changed(picture, seen, true), hides ? 0 : n_left);
            assert_int_equal(n_changed(picture, seen, false), n_right);
            test_twin_give(t, ports[port], half_before(z0 - 0.01));
            assert_true(test_same_bits(draw(t, 1, middle, NULL), open));
            test_twin_give(t, ports[port], half_before(z0 + 0.5 * radius)); /* of its ball the cap is before that */
            const int n_cap = n_changed(picture, draw(t, 1, middle, NULL), true);
            assert_close(n_cap, (hides ? 0.75 : 1) * n_left, 0, hides ? 0.08 : 0);
        }
}

/* Where foam has the very depth of the spray's front it is not before it: that front, of the same particle as foam. */
static void what_is_as_far_as_the_spray_does_not_hide_it(void **state)
{
    static const float across[1][3] = {{0, 3, 0.5f}};
    static const char *const ports[] = {"scene_depth", "depth", "foam_depth"};
    ssfr_field *picture;
    test_twin *t = begin(state, &picture), *foam = test_twin_create(state, "foam_depth", W, H);
    test_twin_set(t, "occlusion", "surface");
    const ssfr_field *open = draw(t, 1, middle, across);
    test_twin_place_moving(foam, 1, middle, radius, NULL, across);
    const ssfr_field *front = test_twin_run(foam, "depth");
    assert_true(n_changed(picture, open, true) + n_changed(picture, open, false) == test_count(front));
    for (size_t i = 0; i < SSFR_COUNT(ports); i++) {
        test_twin_give(t, ports[i], front);
        assert_true(test_same_bits(draw(t, 1, middle, across), open));
    }
}

/* ---- what is left alone ------------------------------------------------------------------------------------------ */

/* Water and foam that do not hide spray are not drawn for it. All particles here are spray: there are none of them. */
static void depths_are_made_only_where_they_hide(void **state)
{
    static const ssfr_pipeline alone = {
        .name = "alone", .source = "test", .help = "test", .result = SSFR_SLOT_color,
        .nodes = {{"sparse"}, {"sphere_depth"}, {"foam_depth"},
                  {"spray", .ports = {{"depth", SSFR_SLOT_fluid_depth}}}}};
    float *density;
    test_twin *t = test_twin_create_for(state, &alone, W, H);
    test_twin_place(t, 1, middle, radius, NULL);
    assert_int_equal(ssfr_alloc(&density, 1, sizeof *density, "densities"), SSFR_OK);
    density[0] = 1; /* kg/m^3 */
    ((ssfr_particles *)t->scene.particles)->density = density; /* which the test made */
    ssfr_graph_want_all(t->graph, false);
    for (int by_surface = 0; by_surface < 2; by_surface++) {
        test_twin_set(t, "spray.occlusion", "%s", by_surface ? "surface" : "scene");
        assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
        const ssfr_node_report *nodes = ssfr_graph_report(t->graph)->nodes;
        for (int i = 1; i < 3; i++)
            assert_int_equal(nodes[i].status, by_surface ? SSFR_NEEDLESS : SSFR_UNWANTED);
        assert_int_equal(nodes[3].status, SSFR_RAN);
    }
}

static void where_there_is_no_spray_no_bit_changes(void **state)
{
    ssfr_field *picture;
    test_twin *t = begin(state, &picture);
    const ssfr_field *seen = draw(t, 1, middle, NULL);
    int n = 0;
    for (int i = 0; i < N; i++) {
        const bool same = memcmp(seen->data + 3 * i, picture->data + 3 * i, 3 * sizeof *seen->data) == 0;
        if (r2_at(t, middle[0], i) > 1.01) assert_true(same);
        n += same;
    }
    assert_true(n > N / 2 && n < N);
}

static void assert_needless(test_twin *t, const ssfr_field *picture)
{
    ssfr_node_status status;
    assert_true(test_same_bits(test_twin_run_if_needed(t, "color", &status), picture));
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_true(test_same_bits(test_twin_run(t, "color"), picture));
}

static void without_spray_the_picture_is_the_one_before(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    ssfr_field *picture;
    test_twin *t = begin(state, &picture);
    test_twin_place(t, 1, middle, radius, NULL);
    assert_needless(t, picture);
    test_twin_place_moving(t, 1, middle, radius, &(const float){0}, NULL);
    assert_needless(t, picture);
    test_twin_place_moving(t, 1, behind, radius, NULL, NULL);
    assert_needless(t, picture);
    test_twin_set(t, "strength", "0");
    test_twin_place_moving(t, 1, middle, radius, NULL, NULL);
    assert_needless(t, picture);
    test_twin_set(t, "strength", "1");
    assert_false(test_same_bits(test_twin_run(t, "color"), picture));
}

/* ---- many -------------------------------------------------------------------------------------------------------- */

static double cloud[MOST][3];
static float velocities[MOST][3];

static void make_cloud(double z_lo, double z_hi, double side)
{
    uint64_t seed = 53;
    for (int i = 0; i < MOST; i++)
        for (int k = 0; k < 3; k++) {
            cloud[i][k] = k == 2 ? test_random(&seed, z_lo, z_hi) : test_random(&seed, -side, side);
            velocities[i][k] = (float)((i % 5 == 1 ? 0.2 : 3) * test_random(&seed, -1, 1));
        }
    velocities[0][0] = NAN, velocities[1][1] = INFINITY, velocities[2][2] = -1e30f;
    memset(velocities[3], 0, sizeof velocities[3]);
}

static void what_is_left_out_changes_no_bit(void **state)
{
    ssfr_field *picture;
    ssfr_node_status status;
    test_twin *t = begin(state, &picture);
    make_cloud(-9, 5, 8);
    const ssfr_field *whole = draw(t, MOST, (const double(*)[3])cloud, (const float(*)[3])velocities);
    const ssfr_field *lean = test_twin_run_if_needed(t, "color", &status);
    assert_int_equal(status, SSFR_RAN);
    assert_true(ssfr_graph_report(t->graph)->n_packets_seen < ssfr_graph_report(t->graph)->n_packets);
    assert_true(test_same_bits(lean, whole));
    assert_false(test_same_bits(whole, picture));
}

static void the_twins_agree_on_a_cloud_of_spray(void **state)
{
    char cpu[] = "cpu";
    void *on_cpu = cpu;
    ssfr_field *picture;
    test_twin *twins[2] = {begin(state, &picture), begin(&on_cpu, &picture)};
    const ssfr_field *seen[2];
    int n_outside = 0;
    make_cloud(-6, 0.2, 3);
    for (int k = 0; k < 2; k++)
        seen[k] = draw(twins[k], MOST, (const double(*)[3])cloud, (const float(*)[3])velocities);
    for (int i = 0; i < 3 * N; i++) {
        assert_true(isfinite(seen[0]->data[i]) && isfinite(seen[1]->data[i]));
        n_outside += !(fabs(seen[0]->data[i] - seen[1]->data[i]) <= 1e-4 + 1e-4 * fabs(seen[1]->data[i]));
    }
    assert_true(n_outside <= 0.004 * 3 * N);
    assert_true(test_difference(seen[1], picture) > 1);
}

static void spray_refuses_values_out_of_range(void **state)
{
    ssfr_field *picture;
    test_twin *t = begin(state, &picture);
    test_twin_refuses(t, "strength", "-0.1", "spray.strength");
    test_twin_refuses(t, "color_g", "-2.385", "spray.color_g");
    test_twin_refuses(t, "falloff", "nan", "spray.falloff");
    test_twin_refuses(t, "kernel", "box", "box");
    test_twin_refuses(t, "occlusion", "fog", "fog");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(spray_falls_off_exponentially_from_its_middle),
        TEST_TWINS(strength_multiplies_the_colour),
        TEST_TWINS(spray_adds_up),
        TEST_TWINS(spray_that_moves_adds_up_whatever_is_before),
        TEST_TWINS(motion_draws_spray_out_and_its_light_with_it),
        TEST_TWINS(scene_water_and_foam_hide_spray_where_they_are_before_it),
        TEST_TWINS(what_is_as_far_as_the_spray_does_not_hide_it),
        TEST_TWINS(depths_are_made_only_where_they_hide),
        TEST_TWINS(where_there_is_no_spray_no_bit_changes),
        TEST_TWINS(without_spray_the_picture_is_the_one_before),
        TEST_TWINS(what_is_left_out_changes_no_bit),
        TEST_GPU(the_twins_agree_on_a_cloud_of_spray),
        TEST_TWINS(spray_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

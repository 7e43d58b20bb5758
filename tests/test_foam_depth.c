/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_foam_depth.c: the nearest front of foam before the scene; test_streak.c has the quads themselves. */
#include "tests/pass_util.h"

enum { W = 64, H = 48, N = 1500 };

static double cloud[N][3];
static float sizes[N], velocities[N][3];

/* A fifth is no foam, a fifth moves too slowly to be turned. */
static void make_cloud(double z_lo, double z_hi, double side)
{
    uint64_t seed = 43;
    for (int i = 0; i < N; i++)
        for (int k = 0; k < 3; k++) {
            cloud[i][k] = k == 2 ? test_random(&seed, z_lo, z_hi) : test_random(&seed, -side, side);
            sizes[i] = i % 5 ? (float)test_random(&seed, 0.1, 1) : 0;
            velocities[i][k] = (float)((i % 5 == 1 ? 0.2 : 3) * test_random(&seed, -1, 1));
        }
}

static const ssfr_field *draw(test_twin *t, size_t n, const double (*c)[3], double radius, const float *size)
{
    test_twin_place_moving(t, n, c, radius, size, (const float(*)[3])velocities);
    return test_twin_run(t, "depth");
}

static void the_nearest_of_all_foam_is_kept(void **state)
{
    enum { FEW = 12 };
    test_twin *t = test_twin_create(state, "foam_depth", W, H);
    make_cloud(-2, -1, 0.4);
    const ssfr_field *all = draw(t, FEW, cloud, 0.3, sizes);
    ssfr_field *nearest = test_field_filled(W, H, 1, -SSFR_EMPTY);
    for (int i = 0; i < FEW; i++) {
        test_twin_place_moving(t, 1, cloud + i, 0.3, sizes + i, (const float(*)[3])velocities + i);
        const ssfr_field *one = test_twin_run(t, "depth");
        for (int k = 0; k < W * H; k++) nearest->data[k] = fmax(nearest->data[k], one->data[k]);
    }
    assert_true(test_count(all) > 200);
    int n_different = 0; /* places are floats relative to their packet's middle: rims move by those */
    for (int k = 0; k < W * H; k++)
        n_different += !(fabs(all->data[k] - nearest->data[k]) <= 1e-5 * fabs(all->data[k]));
    assert_true(n_different <= 3);
}

static void foam_of_half_the_size_is_that_of_half_the_radius(void **state)
{
    static const double c[1][3] = {{0.1, -0.2, -1.3}};
    test_twin *t = test_twin_create(state, "foam_depth", W, H);
    make_cloud(-2, -1, 0.4);
    const ssfr_field *half = draw(t, 1, c, 0.25, &(const float){0.5f});
    assert_true(test_difference(half, draw(t, 1, c, 0.125, NULL)) <= (t->gl ? 1e-6 : 0));
    assert_true(test_count(half) > 20);
}

/* Half of the wall stands before the foam, half cuts it; what is left is bit for bit what is drawn without a wall. */
static void scene_hides_the_foam_behind_it(void **state)
{
    static const double c[1][3] = {{0, 0, -3}};
    test_twin *t = test_twin_create(state, "foam_depth", W, H);
    ssfr_field *wall = test_field(W, H, 1);
    memcpy(velocities[0], (const float[3]){2, 1, 0.5f}, sizeof velocities[0]);
    for (int i = 0; i < W * H; i++) wall->data[i] = i % W < W / 2 ? -2 : -2.65;
    const ssfr_field *open = draw(t, 1, c, 0.5, NULL);
    test_twin_give(t, "scene_depth", wall);
    const ssfr_field *hidden = draw(t, 1, c, 0.5, NULL);
    assert_true(test_count(hidden) > 20 && test_count(hidden) < 0.6 * test_count(open));
    for (int i = 0; i < W * H; i++) {
        const bool shows = ssfr_is_surface(open->data[i]) && open->data[i] > wall->data[i];
        assert_true(hidden->data[i] == (shows ? open->data[i] : (double)(t->gl ? -1e30f : -1e30)));
    }
}

static void assert_needless(test_twin *t)
{
    ssfr_node_status status;
    assert_int_equal(test_count(test_twin_run_if_needed(t, "depth", &status)), 0);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_string_equal(ssfr_graph_report(t->graph)->nodes[0].why, "no foam in view");
    assert_int_equal(test_count(test_twin_run(t, "depth")), 0);
}

/* Without a node that makes foam there is none, as with one that makes none, or only behind the eye. */
/* A scene of the foam's own depth. */
static void foam_exactly_at_the_scene_is_seen(void **state)
{
    test_twin *t = test_twin_create(state, "foam_depth", W, H);
    make_cloud(-2, -1, 0.4);
    const ssfr_field *open = draw(t, N, (const double(*)[3])cloud, 0.1, sizes);
    test_twin_give(t, "scene_depth", open);
    assert_true(test_same_bits(draw(t, N, (const double(*)[3])cloud, 0.1, sizes), open));
    assert_true(test_count(open) > 200);
}

static void without_foam_in_view_it_is_left_out(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    static const float none[3] = {0, 0, 0};
    test_twin *t = test_twin_create(state, "foam_depth", W, H);
    make_cloud(-2, -1, 0.4);
    test_twin_place(t, 3, (const double(*)[3])cloud, 0.1, NULL);
    assert_needless(t);
    test_twin_place_moving(t, 3, (const double(*)[3])cloud, 0.1, none, NULL);
    assert_needless(t);
    test_twin_place_moving(t, 1, behind, 0.1, NULL, NULL);
    assert_needless(t);
    t->scene.particles = NULL;
    assert_needless(t);
}

static void sizes_that_are_not_positive_draw_nothing(void **state)
{
    static const double c[4][3] = {{0, 0, -1}, {0.1, 0, -1}, {0, 0.1, -1}, {0.1, 0.1, -1}};
    static const float not_positive[4] = {0, -1, NAN, -INFINITY};
    test_twin *t = test_twin_create(state, "foam_depth", W + 1, H + 1); /* with a middle pixel */
    const ssfr_field *depth = draw(t, 4, c, 0.1, not_positive);
    for (int i = 0; i < depth->w * depth->h; i++) assert_true(depth->data[i] < -SSFR_SURFACE);
}

/* The tiles that are drawn are those of the water: how far foam would reach does not count. */
static void foam_that_is_not_there_widens_nothing(void **state)
{
    static const ssfr_pipeline both = {.name = "both", .source = "", .help = "", .result = SSFR_SLOT_fluid_depth,
                                       .nodes = {{"sphere_depth"}, {"foam_depth"}}};
    static const char *const stretches[] = {"2", "100"};
    static const double c[1][3] = {{0, 0, -3}};
    test_twin *t = test_twin_create_for(state, &both, 256, 192);
    ssfr_node_status status;
    test_twin_place(t, 1, c, 0.1, NULL);
    for (size_t i = 0; i < SSFR_COUNT(stretches); i++) {
        test_twin_set(t, "foam_depth.stretch", "%s", stretches[i]);
        test_twin_run_if_needed(t, "fluid_depth", &status);
        assert_close(ssfr_graph_report(t->graph)->covered, 4.0 / (8 * 6), 0, 1e-12);
    }
}

/* Packets before and behind the eye, foam that reaches further than its radius. */
static void what_is_left_out_changes_no_bit(void **state)
{
    static const char *const stretches[] = {"1", "2", "20"};
    test_twin *t = test_twin_create(state, "foam_depth", W, H);
    ssfr_node_status status;
    make_cloud(-3, 2, 2.5);
    for (size_t i = 0; i < SSFR_COUNT(stretches); i++) {
        test_twin_set(t, "stretch", "%s", stretches[i]);
        const ssfr_field *whole = draw(t, N, (const double(*)[3])cloud, 0.06, sizes);
        const ssfr_field *lean = test_twin_run_if_needed(t, "depth", &status);
        const ssfr_report *report = ssfr_graph_report(t->graph);
        assert_int_equal(status, SSFR_RAN);
        assert_true(i == 2 || report->n_packets_seen < report->n_packets);
        assert_true(test_same_bits(lean, whole));
        assert_true(test_count(whole) > 100);
    }
}

static void the_twins_agree_on_foam_that_moves(void **state)
{
    static const char *const settings[][2] = {{"plane", "motion"}, {"plane", "view"}, {"orientation", "screen"},
                                              {"facing", "0.9999"}};
    char cpu[] = "cpu";
    void *on_cpu = cpu;
    make_cloud(-3, 0.2, 0.8);
    for (size_t i = 0; i < SSFR_COUNT(settings); i++) {
        test_twin *const twins[2] = {test_twin_create(state, "foam_depth", W, H),
                                     test_twin_create(&on_cpu, "foam_depth", W, H)};
        const ssfr_field *depth[2];
        int n_outside = 0;
        for (int k = 0; k < 2; k++) {
            test_twin_set(twins[k], settings[i][0], "%s", settings[i][1]);
            depth[k] = draw(twins[k], N, (const double(*)[3])cloud, 0.06, sizes);
        }
        for (int k = 0; k < W * H; k++) {
            const double a = depth[0]->data[k], b = depth[1]->data[k];
            n_outside += !(fabs(a - b) <= 1e-5 + 2e-6 * fabs(b));
        }
        assert_true(n_outside <= 0.004 * W * H);
        assert_true(test_count(depth[1]) > 1000);
    }
}

static void foam_depth_refuses_values_out_of_range(void **state)
{
    test_twin *t = test_twin_create(state, "foam_depth", W, H);
    test_twin_refuses(t, "orientation", "gravity", "gravity");
    test_twin_refuses(t, "plane", "floor", "floor");
    test_twin_refuses(t, "motion_threshold", "-0.1", "foam_depth.motion_threshold");
    test_twin_refuses(t, "motion_threshold", "nan", "foam_depth.motion_threshold");
    test_twin_refuses(t, "facing", "1", "foam_depth.facing");
    test_twin_refuses(t, "stretch", "0.9", "foam_depth.stretch");
    test_twin_refuses(t, "radius_scale", "0", "foam_depth.radius_scale");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(the_nearest_of_all_foam_is_kept),
        TEST_TWINS(foam_of_half_the_size_is_that_of_half_the_radius),
        TEST_TWINS(scene_hides_the_foam_behind_it),
        TEST_TWINS(foam_exactly_at_the_scene_is_seen),
        TEST_TWINS(without_foam_in_view_it_is_left_out),
        TEST_TWINS(sizes_that_are_not_positive_draw_nothing),
        TEST_TWINS(foam_that_is_not_there_widens_nothing),
        TEST_TWINS(what_is_left_out_changes_no_bit),
        TEST_GPU(the_twins_agree_on_foam_that_moves),
        TEST_TWINS(foam_depth_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

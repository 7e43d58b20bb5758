/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_shadow_map.c: what the light sees of balls, which solids it looks at, and where its texels stand. */
#include "tests/pass_util.h"

#include "passes/light_view.h"

static const double ball_radius = 0.385;

/* Also straight down and up, level, along an axis, and along the view. */
static const test_light lights[] = {{125, 40}, {0, 90}, {0, -90}, {0, 0}, {90, 0}, {-90, 0}, {180, 0}, {37, -25},
                                    {90, 89.9}};

static ssfr_solid solids[2]; /* of the test that runs */

static void place_ball(test_twin *t, int i, const double centre[3])
{
    solids[i] = (ssfr_solid){.shape = SSFR_SPHERE, .half = {ball_radius}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    memcpy(solids[i].centre, centre, sizeof solids[i].centre);
    t->scene.solids = solids;
    t->scene.n_solids = i + 1;
}

/* Fluid around the point at (0.1, -0.2, -3) in eye space, and a ball that much towards the light from it, m. */
static test_twin *begin(void **state, const test_light *l, double away)
{
    const double at[8][3] = {{-0.4, -0.7, -3.5}, {0.6, -0.7, -3.5}, {-0.4, 0.3, -3.5}, {0.6, 0.3, -3.5},
                             {-0.4, -0.7, -2.5}, {0.6, -0.7, -2.5}, {-0.4, 0.3, -2.5}, {0.6, 0.3, -2.5}};
    double centre[3];
    test_twin *t = test_twin_create(state, "shadow_map", 16, 12);
    test_twin_light(t, l);
    test_twin_place(t, 8, at, 0.05, NULL);
    test_light_towards(l, centre);
    for (int k = 0; k < 3; k++) centre[k] = centre[k] * away + (const double[3]){0.1, -0.2, -3}[k];
    place_ball(t, 0, centre);
    return t;
}

static ssfr_light_view view_of(const test_twin *t, const test_light *l)
{
    ssfr_frame frame = {0};
    ssfr_world world;
    long grew = 0;
    ssfr_world_default(&world);
    world.light.azimuth_deg = l->azimuth, world.light.elevation_deg = l->elevation;
    assert_int_equal(ssfr_frame_prepare(&frame, &t->scene, &world, 0, 0, &grew), SSFR_OK);
    const ssfr_light_view view = ssfr_light_view_of(&frame);
    ssfr_frame_finish(&frame);
    return view;
}

static ssfr_field *run(test_twin *t, int size)
{
    test_twin_set(t, "size", "%d", size);
    return test_twin_run(t, "light_depth");
}

/* ---- what is seen ------------------------------------------------------------------------------------------------ */

/* The largest error of a map of the ball, m; texels that its outline passes within `rim` (m) are left out. */
static double error(const ssfr_field *map, const ssfr_light_view *view, const double centre[3], double rim, int *n)
{
    double largest = 0;
    *n = 0;
    for (int j = 0; j < map->h; j++)
        for (int i = 0; i < map->w; i++) {
            const double x = view->corner[0] + (i + 0.5) / map->w * view->extent - ssfr_dot(centre, view->x);
            const double y = view->corner[1] + (j + 0.5) / map->h * view->extent - ssfr_dot(centre, view->y);
            const double rho = sqrt(x * x + y * y), z = *ssfr_field_at(map, i, j);
            if (fabs(rho - ball_radius) < rim) continue;
            assert_int_equal(ssfr_is_surface(z), rho < ball_radius);
            *n += rho < ball_radius;
            if (rho < ball_radius)
                largest = fmax(largest, fabs(z - ssfr_dot(centre, view->to) -
                                             sqrt(ball_radius * ball_radius - rho * rho)));
        }
    return largest;
}

static void the_light_sees_the_near_half_of_a_ball_from_everywhere(void **state)
{
    for (size_t i = 0; i < SSFR_COUNT(lights); i++) {
        test_twin *t = begin(state, &lights[i], 2.385);
        const ssfr_light_view view = view_of(t, &lights[i]);
        const ssfr_field *map = run(t, 96);
        int n;
        assert_int_equal(map->w, 96);
        assert_int_equal(map->h, 96);
        /* A half circle rises steeply: what rounds by e at its foot is sqrt(2 r e) high. */
        assert_true(error(map, &view, solids[0].centre, 1e-5, &n) < (t->gl ? 2e-3 : 1e-6));
        assert_close(n * ssfr_square(view.extent / 96), acos(-1) * ball_radius * ball_radius, 0, 0.02);
    }
}

static void the_nearer_of_two_balls_hides_the_other(void **state)
{
    const test_light *l = &lights[0];
    test_twin *t = begin(state, l, 2.385);
    const ssfr_field *one = run(t, 64);
    double centre[3];
    for (int k = 0; k < 3; k++) centre[k] = 0.7 * solids[0].centre[k] + 0.3 * (const double[3]){0.1, -0.2, -3}[k];
    place_ball(t, 1, centre);
    assert_true(test_difference(run(t, 64), one) < 4 * t->eps);
}

static void a_million_metres_away_the_light_sees_the_same(void **state)
{
    static const double eye[3] = {1e6, -1e6, 1e6}, target[3] = {1e6, -1e6, 1e6 - 1};
    for (size_t i = 0; i < SSFR_COUNT(lights); i++) {
        test_twin *t = begin(state, &lights[i], 2.385);
        double centre[3];
        const double at[2][3] = {{-0.4, -0.7, -3.5}, {0.6, 0.3, -2.5}};
        int n;
        test_twin_look(t, eye, target);
        test_twin_place(t, 2, at, 0.05, NULL);
        for (int k = 0; k < 3; k++) centre[k] = solids[0].centre[k], solids[0].centre[k] += eye[k];
        const ssfr_light_view view = view_of(t, &lights[i]);
        assert_true(error(run(t, 64), &view, centre, 1e-4, &n) < 2e-3);
        assert_true(n > 100);
    }
}

/* ---- which solids ------------------------------------------------------------------------------------------------ */

static void only_solids_between_fluid_and_light_are_looked_at(void **state)
{
    static const struct {
        double away, aside; /* m, from the fluid's middle towards the light and level across it */
        ssfr_node_status status;
    } cases[] = {{2.385, 0, SSFR_RAN},        {1e5, 0, SSFR_RAN},          {-0.5, 0, SSFR_RAN},
                 {-2.385, 0, SSFR_NEEDLESS},  {2.385, 3, SSFR_NEEDLESS},   {2.385, -3, SSFR_NEEDLESS},
                 {2.385, 0.8, SSFR_RAN}};
    const test_light *l = &lights[0];
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        test_twin *t = begin(state, l, cases[i].away);
        const ssfr_light_view view = view_of(t, l);
        ssfr_node_status status;
        for (int k = 0; k < 3; k++) solids[0].centre[k] += cases[i].aside * view.x[k];
        const ssfr_field *map = test_twin_run_if_needed(t, "light_depth", &status);
        assert_int_equal(status, cases[i].status);
        if (status == SSFR_NEEDLESS) assert_true(map->w == 1 && !ssfr_is_surface(*map->data));
    }
}

static void without_solids_or_fluid_there_is_nothing_to_see(void **state)
{
    test_twin *t = begin(state, &lights[0], 2.385);
    ssfr_node_status status;
    t->scene.n_solids = 0;
    test_twin_run_if_needed(t, "light_depth", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_int_equal(test_count(run(t, 16)), 0);
    t->scene.n_solids = 1;
    test_twin_place(t, 0, NULL, 0, NULL);
    test_twin_run_if_needed(t, "light_depth", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_int_equal(test_count(run(t, 16)), 0);
}

static void a_plane_casts_shadows_only_with_the_light_behind_it(void **state)
{
    for (size_t i = 0; i < SSFR_COUNT(lights); i++) {
        test_twin *t = begin(state, &lights[i], 2.385);
        double to[3];
        test_light_towards(&lights[i], to);
        solids[0] = (ssfr_solid){.shape = SSFR_PLANE, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                 .centre = {7, -2, 1e5}};
        const ssfr_light_view view = view_of(t, &lights[i]);
        assert_int_equal(view.n_casters, 0);
        assert_int_equal(view.night, to[1] < -1e-12);
    }
}

/* ---- where texels stand ------------------------------------------------------------------------------------------ */

static void axes_are_orthonormal_whatever_the_light(void **state)
{
    uint64_t seed = 2385;
    for (int i = 0; i < 100; i++) {
        const test_light l = i < (int)SSFR_COUNT(lights)
                            ? lights[i]
                            : (test_light){test_random(&seed, -360, 360), test_random(&seed, -90, 90)};
        test_twin t = {.scene = {.floor = -INFINITY}};
        double across[3];
        static const double eye[3] = {0, 0, 0}, ahead[3] = {0, 0, -1}, up[3] = {0, 1, 0};
        assert_int_equal(ssfr_camera_look(&t.scene.camera, eye, ahead, up, 1, 8, 8), SSFR_OK);
        const ssfr_light_view v = view_of(&t, &l);
        ssfr_cross(v.x, v.y, across);
        assert_close(ssfr_dot(v.x, v.x), 1, 1e-12, 0);
        assert_close(ssfr_dot(v.y, v.y), 1, 1e-12, 0);
        assert_close(ssfr_dot(across, v.to), 1, 1e-12, 0);
    }
    (void)state;
}

static bool is_whole(double v)
{
    return fabs(v - floor(v + 0.5)) < 1e-6;
}

static void texels_stand_still_while_the_eye_moves(void **state)
{
    (void)state;
    const test_light *l = &lights[0];
    test_twin *t = begin(&(void *){"cpu"}, l, 2.385);
    const ssfr_light_view before = view_of(t, l);
    for (int i = 1; i < 20; i++) {
        t->scene.camera.eye[0] = 0.0137 * i, t->scene.camera.eye[1] = -0.0077 * i, t->scene.camera.eye[2] = 0.0119 * i;
        const ssfr_light_view v = view_of(t, l);
        const double cell = v.extent / 64, *eye = t->scene.camera.eye;
        assert_true(v.extent == before.extent);
        assert_true(is_whole((v.corner[0] - before.corner[0] + ssfr_dot(v.x, eye)) / cell));
        assert_true(is_whole((v.corner[1] - before.corner[1] + ssfr_dot(v.y, eye)) / cell));
    }
    test_clean(NULL);
}

/* Of casters of all sizes: a cell to spare on all sides and towards the light, all fluid within the range, and not many
 * times as large as they are. */
static void the_square_holds_casters_and_fluid(void **state)
{
    enum { N = 200 };
    static const double middle[3] = {0.1, -0.2, -3};
    const test_light *l = &lights[4]; /* along the view: its axes are those of the eye, or their opposites */
    (void)state;
    test_twin *t = begin(&(void *){"cpu"}, l, 2.385);
    for (int i = 0; i < N; i++) {
        const double radius = 0.2 * pow(2.4, i / (N - 1.0)), eps = 1e-9;
        solids[0].half[0] = radius;
        const ssfr_light_view v = view_of(t, l);
        const double cell = v.extent / 64, *axes[2] = {v.x, v.y};
        for (int k = 0; k < 2; k++) {
            const double at = ssfr_dot(axes[k], middle);
            assert_true(v.corner[k] + cell <= at - radius + eps);
            assert_true(v.corner[k] + v.extent - cell >= at + radius - eps);
        }
        assert_true(v.extent <= 2 * radius * 64 / 61 * exp2(0.25) + eps);
        assert_close(v.top, solids[0].centre[2] + radius + cell, eps, 0);
        assert_true(v.top - v.range <= -3.55 + eps && v.range <= (v.top + 3.7) * exp2(0.25));
    }
    test_clean(NULL);
}

/* ---- maps in the graph ------------------------------------------------------------------------------------------- */

static void a_map_is_no_image_of_the_view(void **state)
{
    (void)state;
    static const ssfr_pipeline wrong = {
        .name = "wrong", .result = SSFR_SLOT_normal,
        .nodes = {{"normals", .ports = {{"depth", SSFR_SLOT_light_depth}}}}};
    ssfr_graph *graph;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_create(&graph, &wrong, NULL),
                 "normals: port depth carries images, slot light_depth maps");
}

static void sizes_out_of_range_are_refused(void **state)
{
    test_twin *t = begin(state, &lights[0], 2.385);
    test_twin_refuses(t, "size", "0", "size=0");
    test_twin_refuses(t, "size", "4097", "size=4097");
    assert_int_equal(run(t, 1)->w, 1);
    assert_int_equal(run(t, 33)->h, 33);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(the_light_sees_the_near_half_of_a_ball_from_everywhere),
        TEST_TWINS(the_nearer_of_two_balls_hides_the_other),
        TEST_TWINS(a_million_metres_away_the_light_sees_the_same),
        TEST_TWINS(only_solids_between_fluid_and_light_are_looked_at),
        TEST_TWINS(without_solids_or_fluid_there_is_nothing_to_see),
        TEST_TWINS(a_plane_casts_shadows_only_with_the_light_behind_it),
        cmocka_unit_test(axes_are_orthonormal_whatever_the_light),
        cmocka_unit_test(texels_stand_still_while_the_eye_moves),
        cmocka_unit_test(the_square_holds_casters_and_fluid),
        cmocka_unit_test(a_map_is_no_image_of_the_view),
        TEST_TWINS(sizes_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

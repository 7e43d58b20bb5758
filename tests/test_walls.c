/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_walls.c: distances and free shares at walls, and paths that end at solids, moving solids and sides. */
#include "experiments/scenes/walls.h"
#include "tests/util.h"

#define DT 0.0041 /* s */

static const ssfr_domain room = {.lo = {-1.2, -0.3, -0.7}, .hi = {1.1, 1.4, 0.9}, .open = {[3] = true}};
static const ssfr_domain nowhere = {.lo = {-INFINITY, -INFINITY, -INFINITY}, .hi = {INFINITY, INFINITY, INFINITY}};

static ssfr_solid make_solid(ssfr_shape shape, double x, double y, double z, double half)
{
    return (ssfr_solid){.shape = shape, .centre = {x, y, z}, .axis = {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}},
                        .half = {half, half, half}};
}

static ssfr_obstacle still(ssfr_solid solid, double friction)
{
    return (ssfr_obstacle){solid, solid, friction};
}

static ssfr_walls make_walls(const ssfr_domain *domain, double support, int n, const ssfr_obstacle *obstacles)
{
    ssfr_walls walls;
    assert_int_equal(ssfr_walls_init(&walls, domain, support, DT, n, obstacles), SSFR_OK);
    return walls;
}

static void assert_at(const double at[3], double x, double y, double z)
{
    assert_close(at[0], x, 1e-12, 0);
    assert_close(at[1], y, 1e-12, 0);
    assert_close(at[2], z, 1e-12, 0);
}

static void sides_are_as_far_as_they_stand_and_open_ones_infinitely(void **state)
{
    (void)state;
    const ssfr_walls walls = make_walls(&room, 0.1, 0, NULL);
    const double at[3] = {0.3, 0.2, -0.6}, expected[6] = {1.5, 0.8, 0.5, INFINITY, 0.1, 1.5};
    assert_int_equal(ssfr_walls_count(&walls), 6);
    for (int i = 0; i < 6; i++) {
        double normal[3];
        assert_close(ssfr_walls_distance(&walls, i, at, normal), expected[i], 1e-12, 0);
        assert_true(normal[i / 2] == (i % 2 ? -1 : 1) && ssfr_dot(normal, normal) == 1);
    }
}

static void solids_are_known_within_the_support_and_infinite_beyond(void **state)
{
    (void)state;
    const ssfr_obstacle ball = still(make_solid(SSFR_SPHERE, 0.1, 0.2, 0.3, 0.25), 0);
    const ssfr_walls walls = make_walls(&nowhere, 0.1, 1, &ball);
    double normal[3];
    assert_close(ssfr_walls_distance(&walls, 0, (double[3]){0.1, 0.2, 0.62}, normal), 0.07, 1e-12, 0);
    assert_at(normal, 0, 0, 1);
    assert_close(ssfr_walls_distance(&walls, 0, (double[3]){0.1, 0.2, -0.02}, normal), 0.07, 1e-12, 0);
    assert_at(normal, 0, 0, -1);
    assert_true(isinf(ssfr_walls_distance(&walls, 0, (double[3]){0.1, 0.2, 0.6501}, normal)));
    assert_true(isinf(ssfr_walls_distance(&walls, 0, (double[3]){0.1, 0.2, -0.0501}, normal)));
}

/* Against the volume of a cap from counting. */
static void the_free_share_is_the_ball_without_its_cap(void **state)
{
    (void)state;
    const double h = 0.0954;
    const ssfr_walls walls = make_walls(&room, h, 0, NULL);
    for (double d = 0; d < 1.2 * h; d += 0.13 * h) {
        uint64_t seed = 11;
        int inside = 0, free = 0;
        while (inside < 40000) {
            const double p[3] = {test_random(&seed, -h, h), test_random(&seed, -h, h), test_random(&seed, -h, h)};
            if (ssfr_dot(p, p) >= h * h) continue;
            inside++;
            free += p[1] > -d;
        }
        const double at[3] = {0, -0.3 + d, 0}, share = (double)free / inside;
        assert_close(ssfr_walls_free(&walls, at), share, 4 * sqrt(0.25 / inside), 0);
    }
    assert_close(ssfr_walls_free(&walls, (double[3]){-1.2, -0.3, 0}), 0.25, 1e-12, 0);
    assert_close(ssfr_walls_free(&walls, (double[3]){-1.3, 0.5, 0}), 0.5, 1e-12, 0);
    assert_true(ssfr_walls_free(&walls, (double[3]){0, 1.4, 0}) == 1);
}

static void what_goes_through_a_side_stays_on_it_and_keeps_the_rest_of_its_velocity(void **state)
{
    (void)state;
    const ssfr_walls walls = make_walls(&room, 0.1, 0, NULL);
    double at[3] = {1.3, 1.6, -0.9}, v[3] = {2.385, 3, -1.5};
    ssfr_walls_keep(&walls, (double[3]){1, 1.3, -0.6}, at, v);
    assert_at(at, 1.1, 1.6, -0.7);
    assert_at(v, 0, 3, 0);
    assert_true(ssfr_domain_leaves(&room, at));
    assert_false(ssfr_domain_leaves(&room, (double[3]){1.1, 1.4, -0.7}));
    v[0] = -0.5; /* already on its way back */
    at[0] = 1.2;
    ssfr_walls_keep(&walls, (double[3]){1.2, 1.6, -0.7}, at, v);
    assert_at(v, -0.5, 3, 0);
}

static void a_path_slides_along_the_face_that_it_enters(void **state)
{
    (void)state;
    ssfr_solid floor = make_solid(SSFR_PLANE, 0, 0.5, 0, 1);
    floor.axis[0][0] = 1, floor.axis[0][1] = 0, floor.axis[1][0] = 0, floor.axis[1][1] = 1;
    const ssfr_obstacle obstacle = still(floor, 0.25);
    const ssfr_walls walls = make_walls(&nowhere, 0.1, 1, &obstacle);
    double at[3] = {0.3, 0.41, 0.2}, v[3] = {2, -3, 1};
    ssfr_walls_keep(&walls, (double[3]){0.1, 0.6, 0.1}, at, v);
    assert_at(at, 0.3, 0.5, 0.2);
    assert_at(v, 1.5, 0, 0.75);
}

/* The velocity goes with the face that was met, whatever is nearest in the end. */
static void a_path_that_slides_off_an_edge_is_not_drawn_back(void **state)
{
    (void)state;
    ssfr_solid block = make_solid(SSFR_BOX, 0, 0, 0, 0.1);
    const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    memcpy(block.axis, axes, sizeof axes);
    const ssfr_obstacle obstacle = still(block, 0);
    const ssfr_walls walls = make_walls(&nowhere, 0.05, 1, &obstacle);
    double at[3] = {0.15, 0, 0.01}, v[3] = {2, -3, 0.5};
    ssfr_walls_keep(&walls, (double[3]){0.05, 0.15, 0.01}, at, v);
    assert_at(at, 0.15, 0.1, 0.01);
    assert_at(v, 2, 0, 0.5);
}

static void a_ball_that_is_met_turns_the_velocity_where_it_is_met(void **state)
{
    (void)state;
    const ssfr_obstacle ball = still(make_solid(SSFR_SPHERE, 0, 0, 0, 0.1), 0);
    const ssfr_walls walls = make_walls(&nowhere, 0.05, 1, &ball);
    double at[3] = {0.06, -0.04, 0}, v[3] = {0, -3, 0}, normal[3]; /* down, to the place (0.06, 0.08, 0) */
    ssfr_walls_keep(&walls, (double[3]){0.06, 0.15, 0}, at, v);
    assert_at(v, 3 * 0.8 * 0.6, -3 + 3 * 0.8 * 0.8, 0);
    assert_true(ssfr_walls_distance(&walls, 0, at, normal) >= -1e-12);
}

static void in_a_wedge_what_one_wall_pushes_into_the_other_comes_out_of_both(void **state)
{
    (void)state;
    const double tilt = 80 * M_PI / 180; /* between the planes */
    const double normals[2][3] = {{0, 1, 0}, {sin(tilt), -cos(tilt), 0}};
    ssfr_obstacle planes[2];
    for (int i = 0; i < 2; i++) {
        const double *n = normals[i], axes[3][3] = {{n[1], -n[0], 0}, {n[0], n[1], 0}, {0, 0, 1}};
        ssfr_solid plane = make_solid(SSFR_PLANE, 0, 0, 0, 1);
        memcpy(plane.axis, axes, sizeof axes);
        planes[i] = still(plane, 0);
    }
    const ssfr_walls walls = make_walls(&nowhere, 0.05, 2, planes);
    double at[3] = {-0.01, -0.01, 0}, v[3] = {0}, normal[3];
    ssfr_walls_keep(&walls, (double[3]){-0.01, -0.01, 0}, at, v);
    for (int i = 0; i < 2; i++) assert_true(ssfr_walls_distance(&walls, i, at, normal) >= -1e-7);
}

static void nothing_passes_through_a_plate_thinner_than_its_step(void **state)
{
    (void)state;
    ssfr_solid plate = make_solid(SSFR_BOX, 0, 0, 0, 1);
    plate.half[0] = 0.0005;
    const ssfr_obstacle obstacle = still(plate, 0);
    const ssfr_walls walls = make_walls(&nowhere, 0.05, 1, &obstacle);
    uint64_t seed = 3;
    for (int i = 0; i < 2000; i++) {
        double from[3], at[3], v[3], before[3], after[3];
        const double side = i % 2 ? 1 : -1;
        const double local[3] = {side * test_random(&seed, 0.0006, 0.02), test_random(&seed, -0.5, 0.5),
                                 test_random(&seed, -0.5, 0.5)};
        ssfr_solid_world(&plate, local, from);
        for (int k = 0; k < 3; k++) at[k] = from[k] + test_random(&seed, -0.04, 0.04), v[k] = (at[k] - from[k]) / DT;
        const bool crosses = (ssfr_solid_local(&plate, at, after), side * after[0] < 0.0005);
        memcpy(before, at, sizeof at);
        ssfr_walls_keep(&walls, from, at, v);
        ssfr_solid_local(&plate, at, after);
        assert_true(side * after[0] >= 0.0005 - 1e-12);
        assert_true(side * ssfr_dot(v, plate.axis[0]) >= -1e-9 || !crosses);
        if (!crosses) assert_memory_equal(before, at, sizeof at);
    }
}

static void a_solid_that_comes_takes_along_what_stands_in_its_way(void **state)
{
    (void)state;
    ssfr_obstacle obstacle = still(make_solid(SSFR_BOX, 0, 0, 0, 0.1), 0);
    for (int k = 0; k < 3; k++) obstacle.before.centre[k] -= 3 * 0.1 * obstacle.before.axis[0][k]; /* 0.3 m in a step */
    const ssfr_walls walls = make_walls(&nowhere, 0.05, 1, &obstacle);
    double from[3], at[3], v[3] = {0}, local[3];
    ssfr_solid_world(&obstacle.now, (double[3]){-0.15, 0.03, 0.02}, from);
    memcpy(at, from, sizeof at);
    ssfr_walls_keep(&walls, from, at, v);
    ssfr_solid_local(&obstacle.now, at, local);
    assert_at(local, 0.1, 0.03, 0.02);
    assert_close(ssfr_dot(v, obstacle.now.axis[0]), 0.3 / DT, 1e-9, 0);
    assert_close(ssfr_dot(v, obstacle.now.axis[1]), 0, 1e-9, 0);
}

/* Half a metre in a step, so that nowhere but in between it is near. */
static void a_solid_that_jumps_over_a_particle_takes_it_along(void **state)
{
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        ssfr_obstacle obstacle = still(make_solid(SSFR_SPHERE, 0.25 * sign, 0, 0, 0.1), 0);
        obstacle.before.centre[0] = -0.25 * sign;
        const ssfr_walls walls = make_walls(&nowhere, 0.05, 1, &obstacle);
        double at[3] = {0}, v[3] = {0}, normal[3];
        ssfr_walls_keep(&walls, (double[3]){0}, at, v);
        assert_true(ssfr_walls_distance(&walls, 0, at, normal) >= -1e-12);
        assert_close(at[0], 0.35 * sign, 1e-9, 0);
        assert_close(v[0], 0.5 * sign / DT, 1e-9, 0);
    }
}

static void a_solid_that_goes_away_pulls_nothing(void **state)
{
    (void)state;
    ssfr_obstacle obstacle = still(make_solid(SSFR_SPHERE, 0, 0, 0, 0.1), 1);
    obstacle.before.centre[0] = 0.02;
    const ssfr_walls walls = make_walls(&nowhere, 0.05, 1, &obstacle);
    double at[3] = {0.121, 0, 0}, v[3] = {0.2, 0.1, 0};
    ssfr_walls_keep(&walls, (double[3]){0.1202, -0.0004, 0}, at, v);
    assert_at(at, 0.121, 0, 0);
    assert_at(v, 0.2, 0.1, 0);
}

static void what_is_inside_comes_out_also_between_two_solids(void **state)
{
    (void)state;
    const ssfr_obstacle two[2] = {still(make_solid(SSFR_SPHERE, -0.09, 0, 0, 0.1), 0),
                                  still(make_solid(SSFR_SPHERE, 0.09, 0, 0, 0.1), 0)};
    const ssfr_walls walls = make_walls(&nowhere, 0.05, 2, two);
    double at[3] = {-0.12, 0.01, 0.02}, v[3] = {0}, normal[3];
    const double start[3] = {-0.12, 0.01, 0.02};
    ssfr_walls_keep(&walls, start, at, v);
    for (int i = 0; i < 2; i++) assert_true(ssfr_walls_distance(&walls, i, at, normal) >= -1e-12);
    assert_close(ssfr_walls_distance(&walls, 0, at, normal), 0, 1e-12, 0);
}

static void too_many_obstacles_are_refused(void **state)
{
    (void)state;
    static ssfr_obstacle many[SSFR_MAX_SOLIDS + 1];
    ssfr_walls walls;
    for (int i = 0; i <= SSFR_MAX_SOLIDS; i++) many[i] = still(make_solid(SSFR_SPHERE, i, 0, 0, 0.1), 0);
    assert_int_equal(ssfr_walls_init(&walls, &room, 0.1, DT, SSFR_MAX_SOLIDS, many), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_walls_init(&walls, &room, 0.1, DT, SSFR_MAX_SOLIDS + 1, many), "65 obstacles");
    assert_fails(SSFR_ERR_VALUE, ssfr_walls_init(&walls, &room, 0.1, DT, -1, many), "-1 obstacles");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sides_are_as_far_as_they_stand_and_open_ones_infinitely),
        cmocka_unit_test(solids_are_known_within_the_support_and_infinite_beyond),
        cmocka_unit_test(the_free_share_is_the_ball_without_its_cap),
        cmocka_unit_test(what_goes_through_a_side_stays_on_it_and_keeps_the_rest_of_its_velocity),
        cmocka_unit_test(a_path_slides_along_the_face_that_it_enters),
        cmocka_unit_test(a_path_that_slides_off_an_edge_is_not_drawn_back),
        cmocka_unit_test(a_ball_that_is_met_turns_the_velocity_where_it_is_met),
        cmocka_unit_test(in_a_wedge_what_one_wall_pushes_into_the_other_comes_out_of_both),
        cmocka_unit_test(nothing_passes_through_a_plate_thinner_than_its_step),
        cmocka_unit_test(a_solid_that_comes_takes_along_what_stands_in_its_way),
        cmocka_unit_test(a_solid_that_jumps_over_a_particle_takes_it_along),
        cmocka_unit_test(a_solid_that_goes_away_pulls_nothing),
        cmocka_unit_test(what_is_inside_comes_out_also_between_two_solids),
        cmocka_unit_test(too_many_obstacles_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_surroundings.c: what rays see of floor, solids and sky, against the passes' own environment. */
#include "experiments/truth/surroundings.h"
#include "passes/environment.h"
#include "tests/meshes.h"
#include "tests/util.h"

typedef struct rig {
    ssfr_scene scene;
    ssfr_world world;
    ssfr_solid solids[3];
    double origin[3];
    ssfr_surroundings *around;
} rig;

static ssfr_solid solid(ssfr_shape shape, double x, double y, double z, double size)
{
    return (ssfr_solid){.shape = shape, .centre = {x, y, z}, .half = {size, 0.5 * size, size},
                        .axis = {{2. / 7, 3. / 7, 6. / 7}, {3. / 7, -6. / 7, 2. / 7}, {6. / 7, 2. / 7, -3. / 7}},
                        .colour = {0.385, 0.72, 0.15}};
}

/* The eye over a floor, a box and a ball; all moved by x along all axes. */
static void begin(rig *r, double x)
{
    const double eye[3] = {2.385 + x, 1.785 + x, 3.1 + x}, target[3] = {x, 0.3 + x, x}, up[3] = {0, 1, 0};
    *r = (rig){.origin = {0.31 + x, 0.11 + x, -0.2 + x}};
    r->scene.floor = -0.25 + x;
    r->scene.solids = r->solids;
    r->scene.n_solids = 2;
    r->solids[0] = solid(SSFR_BOX, -0.7 + x, 0.4 + x, 0.2 + x, 0.5);
    r->solids[1] = solid(SSFR_SPHERE, 0.8 + x, 0.1 + x, -0.4 + x, 0.4);
    assert_int_equal(ssfr_camera_look(&r->scene.camera, eye, target, up, 0.8, 64, 48), SSFR_OK);
    ssfr_world_default(&r->world);
}

static void make(rig *r)
{
    ssfr_surroundings_destroy(&r->around);
    assert_int_equal(ssfr_surroundings_create(&r->around, &r->scene, &r->world, r->origin), SSFR_OK);
}

static ssfr_ray random_ray(uint64_t *seed)
{
    ssfr_ray ray;
    for (int k = 0; k < 3; k++) ray.origin[k] = test_random(seed, -2, 2), ray.dir[k] = test_random(seed, -1, 1);
    ray.origin[1] = fabs(ray.origin[1]);
    ssfr_normalize(ray.dir);
    return ray;
}

static double trace(const rig *r, const ssfr_ray *ray, double colour[3])
{
    const double t = r->around->trace(r->around->user, ray, colour);
    assert_true(t > 0);
    for (int k = 0; k < 3; k++) assert_true(colour[k] >= r->around->darkest && colour[k] <= r->around->brightest);
    return t;
}

static void rays_see_what_the_passes_see(void **state)
{
    rig r;
    ssfr_frame frame = {0};
    ssfr_solid_set solids;
    uint64_t seed = 1;
    long grew = 0;
    int n_sky = 0, n_floor = 0, n_solids = 0;
    (void)state;
    begin(&r, 0);
    make(&r);
    assert_int_equal(ssfr_frame_prepare(&frame, &r.scene, &r.world, 1, 0, &grew), SSFR_OK);
    ssfr_frame_all_solids(&frame, solids);
    for (int i = 0; i < 3000; i++) {
        const ssfr_ray ray = random_ray(&seed);
        double from[3], seen[3], expected[3];
        for (int k = 0; k < 3; k++) from[k] = ray.origin[k] + (r.origin[k] - r.scene.camera.eye[k]);
        const double t = trace(&r, &ray, seen), other = ssfr_environment_trace(&frame, solids, from, ray.dir, expected);
        assert_memory_equal(seen, expected, sizeof seen);
        assert_true(other == SSFR_EMPTY ? isinf(t) : t == other);
        r.around->sky(r.around->user, ray.dir, seen);
        ssfr_environment_sky(&frame, ray.dir, expected);
        assert_memory_equal(seen, expected, sizeof seen);
        const bool floor = fabs(ray.origin[1] + t * ray.dir[1] + r.origin[1] + 0.25) < 1e-9;
        n_sky += isinf(t), n_floor += floor, n_solids += isfinite(t) && !floor;
    }
    assert_true(n_sky > 500 && n_floor > 500 && n_solids > 100);
    ssfr_frame_finish(&frame);
    ssfr_surroundings_destroy(&r.around);
}

/* By hand: the ball's nearest point to a ray at its middle, in the place where the scene says it is. */
static void solids_are_where_the_scene_has_them(void **state)
{
    rig r;
    ssfr_ray ray;
    double colour[3];
    (void)state;
    begin(&r, 0);
    make(&r);
    const double from[3] = {2.1, 1.9, -0.1};
    for (int k = 0; k < 3; k++) ray.origin[k] = from[k] - r.origin[k], ray.dir[k] = r.solids[1].centre[k] - from[k];
    const double distance = ssfr_normalize(ray.dir);
    assert_close(trace(&r, &ray, colour), distance - 0.4, 1e-14, 0);
    const double degree = M_PI / 180, level = cos(40 * degree);
    const double light[3] = {level * cos(125 * degree), sin(40 * degree), level * sin(125 * degree)};
    const double shade = 0.45 + 0.55 * fmax(-ssfr_dot(ray.dir, light), 0);
    for (int k = 0; k < 3; k++) assert_close(colour[k], shade * r.solids[1].colour[k], 1e-14, 0);
    ssfr_surroundings_destroy(&r.around);
}

/* Two tiles are the floor's period: 0.8 m, of which 1e6 m are a whole number. */
static void far_from_the_worlds_origin_nothing_changes(void **state)
{
    rig near, far;
    uint64_t seed = 2;
    (void)state;
    begin(&near, 0);
    begin(&far, 1e6);
    make(&near);
    make(&far);
    int n_edges = 0;
    for (int i = 0; i < 3000; i++) {
        const ssfr_ray ray = random_ray(&seed);
        double a[3], b[3];
        const double t = trace(&near, &ray, a), moved = trace(&far, &ray, b);
        const bool same = fabs(a[0] - b[0]) <= 1e-6 && (t == moved || fabs(t - moved) <= 1e-6 * t);
        n_edges += !same; /* a tile's edge, or a solid's, between both */
        if (same)
            for (int k = 1; k < 3; k++) assert_close(b[k], a[k], 1e-6, 0);
    }
    assert_true(n_edges < 3);
    ssfr_surroundings_destroy(&near.around);
    ssfr_surroundings_destroy(&far.around);
}

static double most_seen(const rig *r, double *least)
{
    uint64_t seed = 3;
    double most = -INFINITY, colour[3];
    *least = INFINITY;
    for (int i = 0; i < 20000; i++) {
        const ssfr_ray ray = random_ray(&seed);
        trace(r, &ray, colour);
        for (int k = 0; k < 3; k++) most = fmax(most, colour[k]), *least = fmin(*least, colour[k]);
    }
    return most;
}

/* trace holds each colour to the bounds; here they are met. */
static void bounds_are_those_of_the_brightest_thing(void **state)
{
    rig r;
    double least;
    (void)state;
    begin(&r, 0);
    make(&r);
    assert_close(r.around->brightest, 0.93, 0, 1e-11); /* the horizon */
    assert_true(r.around->darkest == 0 && most_seen(&r, &least) > 0.92);
    r.world.sky = (ssfr_sky){0};
    make(&r);
    assert_close(r.around->brightest, 0.72, 0, 1e-11); /* the solids' green, in full light */
    assert_true(most_seen(&r, &least) > 0.7);
    r.scene.n_solids = 0;
    make(&r);
    assert_close(r.around->brightest, 0.62, 0, 1e-11); /* the floor's light tiles */
    assert_true(most_seen(&r, &least) > 0.45);
    r.world.floor.dark = 0.66;
    make(&r);
    assert_close(r.around->brightest, 0.66, 0, 1e-11); /* the other ones */
    r.world.floor.dark = 0.1;
    r.world.light.intensity = 3;
    make(&r);
    assert_close(r.around->brightest, 0.62 * (0.45 + 0.55 * 3), 0, 1e-11);
    assert_true(most_seen(&r, &least) > 0.62);
    r.scene.floor = -INFINITY;
    make(&r);
    assert_true(r.around->brightest == 0 && most_seen(&r, &least) == 0);
    ssfr_surroundings_destroy(&r.around);
}

static void maps_take_the_skys_place_and_bounds(void **state)
{
    rig r;
    ssfr_field *map = NULL;
    uint64_t seed = 4;
    double least;
    (void)state;
    assert_int_equal(ssfr_field_create(&map, 16, 8, 3), SSFR_OK);
    for (int i = 0; i < 16 * 8 * 3; i++) map->data[i] = test_random(&seed, -0.385, 2.385);
    begin(&r, 0);
    r.scene.environment = map;
    r.scene.floor = -INFINITY;
    make(&r);
    assert_true(r.around->brightest > 2.3 && r.around->brightest < 2.386);
    assert_true(r.around->darkest < -0.36 && r.around->darkest > -0.386);
    assert_true(most_seen(&r, &least) > 2 && least < -0.1);
    map->data[5] = NAN;
    ssfr_surroundings *none = NULL;
    assert_fails(SSFR_ERR_VALUE, ssfr_surroundings_create(&none, &r.scene, &r.world, r.origin), "environment: pixel");
    assert_null(none);
    ssfr_surroundings_destroy(&r.around);
    ssfr_field_destroy(&map);
}

static void meshes_hide_what_is_behind_them(void **state)
{
    rig r;
    (void)state;
    begin(&r, 0);
    test_mesh ball = test_mesh_sphere(2, 0.4);
    ssfr_mesh *mesh = test_mesh_make(&ball);
    r.solids[2] = solid(SSFR_MESH, 0.3, 1.2, 0.1, 1);
    r.solids[2].mesh = mesh;
    r.scene.n_solids = 3;
    make(&r);
    ssfr_ray ray = {.dir = {0, -1, 0}};
    double colour[3];
    for (int k = 0; k < 3; k++) ray.origin[k] = r.solids[2].centre[k] - r.origin[k] + (k == 1 ? 2 : 0);
    const double t = trace(&r, &ray, colour);
    assert_true(t >= 1.6 && t < 1.62);
    ssfr_surroundings_destroy(&r.around);
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&ball);
}

static void a_scene_that_is_wrong_is_refused(void **state)
{
    rig r;
    (void)state;
    begin(&r, 0);
    r.scene.floor = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_surroundings_create(&r.around, &r.scene, &r.world, r.origin), "floor at nan m");
    assert_null(r.around);
    r.scene.floor = 0;
    r.solids[1].half[0] = -2.385;
    assert_fails(SSFR_ERR_VALUE, ssfr_surroundings_create(&r.around, &r.scene, &r.world, r.origin), "solid 1");
    assert_null(r.around);
    ssfr_surroundings_destroy(&r.around);
}

/* The scene's struct and its solids may go, as the header says. */
static void a_scene_need_not_stay(void **state)
{
    rig r;
    ssfr_ray ray = {.dir = {0.6, -0.8, 0}, .origin = {-2, 1.4, 0.1}};
    double before[3], after[3];
    (void)state;
    begin(&r, 0);
    make(&r);
    trace(&r, &ray, before);
    memset(r.solids, 0xff, sizeof r.solids);
    memset(&r.scene, 0xff, sizeof r.scene);
    trace(&r, &ray, after);
    assert_memory_equal(before, after, sizeof before);
    ssfr_surroundings_destroy(&r.around);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_see_what_the_passes_see),
        cmocka_unit_test(solids_are_where_the_scene_has_them),
        cmocka_unit_test(far_from_the_worlds_origin_nothing_changes),
        cmocka_unit_test(bounds_are_those_of_the_brightest_thing),
        cmocka_unit_test(maps_take_the_skys_place_and_bounds),
        cmocka_unit_test(meshes_hide_what_is_behind_them),
        cmocka_unit_test(a_scene_that_is_wrong_is_refused),
        cmocka_unit_test(a_scene_need_not_stay),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

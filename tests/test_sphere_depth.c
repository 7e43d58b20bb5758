/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_sphere_depth.c: splats against the closed form of a ray that meets a sphere. */
#include "gl/gl.h"
#include "tests/pass_util.h"

#include <float.h>

/* How far rounding moves the point where the ray passes the centre: a few units of the distance, and what positions
 * lose that are floats relative to their packet. */
static double moved(const test_twin *t, const double c[3], double radius)
{
    const ssfr_particles *p = t->scene.particles;
    double half = 0;
    for (size_t i = 0; i < p->n_packets; i++)
        for (int k = 0; k < 3; k++) half = fmax(half, (double)p->packets[i].half[k]);
    return 6 * t->eps * (sqrt(ssfr_dot(c, c)) + radius) + half * FLT_EPSILON;
}

/* Near the rim, where the surface turns away from the ray, the depth moves by 1 / sin(angle) times that. */
static double allowed(const test_twin *t, const double c[3], double radius, double miss)
{
    return moved(t, c, radius) * (1 + radius / sqrt((radius - miss) * (radius + miss)));
}

static bool at_rim(const test_twin *t, const double c[3], double radius, double miss)
{
    return fabs(miss - radius) < moved(t, c, radius);
}

/* Every pixel is the nearest of the spheres, cut at the near plane; rims are left out and are few. */
static void assert_spheres(const test_twin *t, const ssfr_field *depth, size_t n, const double (*c)[3], double radius)
{
    const double near = t->scene.camera.near;
    int n_rim = 0;
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++) {
            double expected = -SSFR_EMPTY, tolerance = 0;
            bool rim = false;
            for (size_t i = 0; i < n; i++) {
                const test_hit hit = test_meet(c[i], radius, test_ray_at(t, x, y, 1));
                rim = rim || at_rim(t, c[i], radius, hit.miss);
                if (!(hit.miss < radius) || hit.back > -near || hit.front < expected) continue;
                expected = fmin(hit.front, -near);
                tolerance = allowed(t, c[i], radius, hit.miss);
            }
            n_rim += rim;
            const double rounded = ssfr_is_surface(expected) ? 0 : 1e-7; /* 1e30 as a float */
            if (!rim) assert_close(*ssfr_field_at(depth, x, y), expected, tolerance, rounded);
        }
    assert_true(n_rim * 200 <= depth->w * depth->h);
}

static const ssfr_field *splat(test_twin *t, const char *form, const double c[3], double radius)
{
    const double one[1][3] = {{c[0], c[1], c[2]}};
    test_twin_set(t, "splat", "%s", form);
    test_twin_place(t, 1, one, radius, NULL);
    return test_twin_run(t, "depth");
}

/* ---- exact ------------------------------------------------------------------------------------------------------- */

static const double places[][3] = {{0, 0, -3}, {0.6, -0.45, -2.385}, {-0.9, 0.7, -2.1}, {0.013, 0.002, -1.31}};

static void exact_splats_are_the_closed_form_on_and_off_the_axis(void **state)
{
    test_twin *t = test_twin_create(state, "sphere_depth", 81, 64);
    for (size_t i = 0; i < SSFR_COUNT(places); i++) {
        const ssfr_field *depth = splat(t, "exact", places[i], 0.41);
        assert_true(test_count(depth) > 100);
        assert_spheres(t, depth, 1, &places[i], 0.41);
    }
}

static void exact_splats_know_cameras_that_turn_and_pixels_that_are_not_square(void **state)
{
    static const double eye[3] = {1.5, 2.25, -0.75}, target[3] = {-0.31, 0.2, 4};
    test_twin *t = test_twin_create(state, "sphere_depth", 50, 64);
    t->scene.camera.tan_x = 0.8;
    test_twin_look(t, eye, target);
    for (size_t i = 0; i < SSFR_COUNT(places); i++)
        assert_spheres(t, splat(t, "exact", places[i], 0.41), 1, &places[i], 0.41);
}

/* A double holds a place 1e6 m away to 1.2e-10 m, so that much the sphere itself moves. */
static void exact_splats_are_the_same_a_thousand_kilometres_away(void **state)
{
    static const double eyes[][3] = {{1e6, 0, 0}, {0, -1e6, 0}, {0, 0, 1e6}, {-1e6, 1e6, 1e6}};
    test_twin *t = test_twin_create(state, "sphere_depth", 61, 48);
    const ssfr_field *here = splat(t, "exact", places[1], 0.41);
    for (size_t i = 0; i < SSFR_COUNT(eyes); i++) {
        const double *e = eyes[i], target[3] = {e[0], e[1], e[2] - 1};
        test_twin_look(t, e, target);
        const ssfr_field *there = splat(t, "exact", places[1], 0.41);
        assert_int_equal(test_count(there), test_count(here));
        assert_true(test_difference(there, here) < 1e-8 + 50 * t->eps);
    }
}

/* The tangents from the eye stand asin(R / distance) to both sides of the centre. */
static void exact_outline_is_the_perspective_one(void **state)
{
    test_twin *t = test_twin_create(state, "sphere_depth", 301, 9);
    t->scene.camera.tan_x = 1;
    for (int i = 0; i < 5; i++) {
        const double c[3] = {0.35 * i, 0, -2}, radius = 0.37, distance = sqrt(ssfr_dot(c, c));
        const double middle = atan(c[0] / 2), half = asin(radius / distance);
        const ssfr_field *depth = splat(t, "exact", c, radius);
        int n = 0, expected = 0;
        for (int x = 0; x < 301; x++) {
            const double u = test_ray_at(t, x, 4, 1).u;
            n += ssfr_is_surface(*ssfr_field_at(depth, x, 4));
            expected += u > tan(middle - half) && u < tan(middle + half);
        }
        assert_int_equal(n, expected);
        assert_true(n > 50);
    }
}

static void eye_inside_a_sphere_sees_the_near_plane(void **state)
{
    static const double c[3] = {0.1, 0.05, -0.05};
    test_twin *t = test_twin_create(state, "sphere_depth", 40, 33);
    const ssfr_field *depth = splat(t, "exact", c, 1);
    assert_int_equal(test_count(depth), 40 * 33);
    for (int i = 0; i < 40 * 33; i++) assert_close(depth->data[i], -0.01, 0, t->eps);
    assert_true(test_count(splat(t, "quad", c, 1)) > 0);
}

/* Centre and most of it behind the eye: only what is before the near plane shows, and only where the sphere's outline
 * is exact. */
static void sphere_around_the_eye_with_its_centre_behind_still_shows(void **state)
{
    static const double c[3] = {0, 0, 0.3};
    test_twin *t = test_twin_create(state, "sphere_depth", 40, 33);
    assert_int_equal(test_count(splat(t, "exact", c, 0.4)), 40 * 33);
    assert_int_equal(test_count(splat(t, "quad", c, 0.4)), 0);
    assert_int_equal(test_count(splat(t, "point", c, 0.4)), 0);
}

static void sphere_behind_the_eye_draws_nothing(void **state)
{
    static const double behind[][3] = {{0, 0, 3}, {0.4, -0.2, 0.5}, {0, 0, 0.409}};
    static const char *const forms[] = {"point", "quad", "exact"};
    test_twin *t = test_twin_create(state, "sphere_depth", 40, 33);
    for (size_t i = 0; i < SSFR_COUNT(behind); i++)
        for (size_t f = 0; f < SSFR_COUNT(forms); f++)
            assert_int_equal(test_count(splat(t, forms[f], behind[i], 0.4)), 0);
}

static void sphere_that_straddles_the_near_plane_is_cut_by_it(void **state)
{
    static const double c[][3] = {{0, 0, -1}, {0.3, 0.1, -0.8}, {-0.2, -0.3, -0.6}};
    test_twin *t = test_twin_create(state, "sphere_depth", 61, 48);
    t->scene.camera.near = 0.75;
    for (size_t i = 0; i < SSFR_COUNT(c); i++) assert_spheres(t, splat(t, "exact", c[i], 0.41), 1, &c[i], 0.41);
}

static void sphere_larger_than_the_screen_fills_it(void **state)
{
    static const double c[3] = {0.2, -0.1, -3};
    test_twin *t = test_twin_create(state, "sphere_depth", 61, 48);
    const ssfr_field *depth = splat(t, "exact", c, 2.8);
    assert_int_equal(test_count(depth), 61 * 48);
    assert_spheres(t, depth, 1, &c, 2.8);
    assert_int_equal(test_count(splat(t, "quad", c, 2.8)), 61 * 48);
}

/* Their middle lies less than a radius before the eye plane, whose outline has no tangent ahead. */
static void spheres_beside_the_eye_are_seen_whole(void **state)
{
    static const double beside[][3] = {{0.9, 0.1, -0.3}, {-0.9, 0.1, -0.3}, {0.1, 0.7, -0.2}, {0.1, -0.7, -0.2}};
    test_twin *t = test_twin_create(state, "sphere_depth", 81, 64);
    t->scene.camera.tan_x = t->scene.camera.tan_y = 3;
    for (size_t i = 0; i < SSFR_COUNT(beside); i++) {
        const ssfr_field *depth = splat(t, "exact", beside[i], 0.41);
        assert_true(test_count(depth) > 100);
        assert_spheres(t, depth, 1, &beside[i], 0.41);
    }
}

/* More than one packet, and spheres that hide each other. */
static void plane_of_spheres_keeps_the_nearest_at_each_pixel(void **state)
{
    enum { N = 18 * 16 };
    double c[N][3];
    uint64_t random = 7;
    test_twin *t = test_twin_create(state, "sphere_depth", 70, 60);
    for (int i = 0; i < N; i++) {
        c[i][0] = 0.15 * (i % 18 - 8.5) + test_random(&random, -0.04, 0.04);
        c[i][1] = 0.15 * (i / 18 - 7.5) + test_random(&random, -0.04, 0.04);
        c[i][2] = -2.385 + test_random(&random, -0.1, 0.1);
    }
    test_twin_set(t, "splat", "exact");
    test_twin_place(t, N, c, 0.13, NULL);
    assert_true(t->scene.particles->n_packets > 1);
    const ssfr_field *depth = test_twin_run(t, "depth");
    assert_true(test_count(depth) > 60 * 60);
    assert_spheres(t, depth, N, c, 0.13);
}

static void radius_scale_makes_the_sphere_larger(void **state)
{
    test_twin *t = test_twin_create(state, "sphere_depth", 61, 48);
    test_twin_set(t, "radius_scale", "1.7");
    assert_spheres(t, splat(t, "exact", places[0], 0.3), 1, &places[0], 0.51);
}

/* ---- quads and points -------------------------------------------------------------------------------------------- */

/* z + R sqrt(1 - a^2 - b^2) on the disc of radius R / (C |z|) pixels around the projected centre; with size=distance
 * the distance stands for |z| in the disc's radius. */
static void assert_disc(const test_twin *t, const ssfr_field *depth, const double c[3], double radius, bool by_distance)
{
    const ssfr_camera *camera = &t->scene.camera;
    const double away = by_distance ? sqrt(ssfr_dot(c, c)) : -c[2];
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++) {
            const test_ray ray = test_ray_at(t, x, y, 1);
            const double a = (ray.u + c[0] / c[2]) * away / radius, b = (ray.v + c[1] / c[2]) * away / radius;
            const double r2 = a * a + b * b, z = *ssfr_field_at(depth, x, y);
            const double moved = 4 * t->eps * (away / radius) * (1 + camera->tan_x); /* of a and b */
            if (fabs(r2 - 1) < 2 * moved) continue;
            assert_int_equal(ssfr_is_surface(z), r2 < 1);
            if (r2 < 1) assert_close(z, c[2] + radius * sqrt(1 - r2), radius * moved / sqrt(1 - r2), 2 * t->eps);
        }
}

static void quads_and_points_follow_their_first_order_formula(void **state)
{
    static const char *const forms[] = {"point", "quad"}, *const sizes[] = {"depth", "distance"};
    test_twin *t = test_twin_create(state, "sphere_depth", 81, 64);
    t->scene.camera.tan_x = 0.5;
    for (size_t i = 0; i < SSFR_COUNT(places); i++)
        for (int k = 0; k < 4; k++) {
            test_twin_set(t, "size", "%s", sizes[k / 2]);
            const ssfr_field *depth = splat(t, forms[k % 2], places[i], 0.41);
            assert_true(test_count(depth) > 100);
            assert_disc(t, depth, places[i], 0.41, k / 2 == 1);
        }
}

/* A disc of exactly four pixels' radius around the middle of one: where r^2 is 1 the listing does not discard, nor where
 * the scene is as near. */
static void the_rim_belongs_to_the_disc(void **state)
{
    static const char *const forms[] = {"point", "quad"};
    static const double c[3] = {1.0 / 64, -1.0 / 64, -2};
    test_twin *t = test_twin_create(state, "sphere_depth", 64, 64);
    t->scene.camera.tan_x = t->scene.camera.tan_y = 0.5;
    test_twin_give(t, "scene_depth", test_field_filled(64, 64, 1, -2));
    for (int k = 0; k < 2; k++) {
        const ssfr_field *depth = splat(t, forms[k], c, 0.125);
        for (int side = -4; side <= 4; side += 8) {
            assert_true(*ssfr_field_at(depth, 32 + side, 32) == -2);
            assert_true(*ssfr_field_at(depth, 32, 32 + side) == -2);
        }
        assert_false(ssfr_is_surface(*ssfr_field_at(depth, 37, 32)));
    }
}

/* The largest |quad - exact| / R where the sprite is flatter than 53 degrees. The view narrows with R: always the same
 * pixels. */
static double quad_error(void **state, const double direction[3], double radius)
{
    test_twin *t = test_twin_create(state, "sphere_depth", 41, 41);
    const double c[3] = {3 * direction[0], 3 * direction[1], 3 * direction[2]};
    double largest = 0;
    t->scene.camera.tan_x = t->scene.camera.tan_y = c[0] / 3 + radius / 2;
    const ssfr_field *exact = splat(t, "exact", c, radius), *quad = splat(t, "quad", c, radius);
    for (int y = 0; y < 41; y++)
        for (int x = 0; x < 41; x++) {
            const test_ray ray = test_ray_at(t, x, y, 1);
            const double a = (ray.u + c[0] / c[2]) * 3 / radius, b = (ray.v + c[1] / c[2]) * 3 / radius;
            if (a * a + b * b > 0.64) continue;
            largest = fmax(largest, fabs(*ssfr_field_at(exact, x, y) - *ssfr_field_at(quad, x, y)) / radius);
        }
    return largest;
}

/* The ray through the place a of the sprite meets the sphere a^2 R / |z| radii behind the quad, to first order. */
static void quad_error_falls_as_radius_over_distance_on_the_axis(void **state)
{
    static const double ahead[3] = {0, 0, -1};
    double before = quad_error(state, ahead, 0.4);
    for (double radius = 0.2; radius > 0.04; radius /= 2) {
        const double error = quad_error(state, ahead, radius);
        assert_close(test_order(before, error, 2), 1, 0.07, 0);
        before = error;
    }
    assert_close(before, 0.64 * 0.05 / 3, 0, 0.1);
}

/* The ray to a sphere's middle meets it R / sqrt(1 + U^2) before the centre, the quad stands R before it: off the axis
 * no smaller radius mends that. */
static void quad_error_stays_off_the_axis(void **state)
{
    test_twin *t = test_twin_create(state, "sphere_depth", 201, 3);
    t->scene.camera.tan_x = 1;
    const double u = test_ray_at(t, 150, 1, 1).u, c[3] = {3 * u, 0, -3};
    for (double radius = 0.1; radius > 0.02; radius /= 2) {
        const double exact = *ssfr_field_at(splat(t, "exact", c, radius), 150, 1);
        const double quad = *ssfr_field_at(splat(t, "quad", c, radius), 150, 1);
        assert_close((quad - exact) / radius, 1 - 1 / sqrt(1 + u * u), 20 * t->eps / radius, 0);
    }
}

static void point_sprites_are_cut_at_their_largest_size(void **state)
{
    static const double c[3] = {0, 0, -2};
    test_twin *t = test_twin_create(state, "sphere_depth", 65, 65);
    const ssfr_field *quad = splat(t, "quad", c, 0.6);
    test_twin_set(t, "max_point_px", "21");
    const ssfr_field *point = splat(t, "point", c, 0.6);
    assert_int_equal(test_count(point), 21 * 21);
    for (int y = 22; y < 43; y++)
        for (int x = 22; x < 43; x++)
            assert_close(*ssfr_field_at(point, x, y), *ssfr_field_at(quad, x, y), 0, 4 * t->eps);
}

static void points_vanish_with_their_centre_and_quads_do_not(void **state)
{
    static const double inside[][3] = {{0.99, 0, -2}, {-0.99, 0, -2}, {0, 0.99, -2}, {0, -0.99, -2}};
    test_twin *t = test_twin_create(state, "sphere_depth", 64, 64);
    for (size_t i = 0; i < SSFR_COUNT(inside); i++) {
        const double outside[3] = {1.02 * inside[i][0], 1.02 * inside[i][1], -2};
        assert_true(test_count(splat(t, "point", inside[i], 0.3)) > 100);
        assert_int_equal(test_count(splat(t, "point", outside, 0.3)), 0);
        assert_true(test_count(splat(t, "quad", outside, 0.3)) > 100);
        assert_true(test_count(splat(t, "exact", outside, 0.3)) > 100);
    }
}

/* Most of the sphere is beyond the near plane. A disc stands where its centre is. */
static void points_and_quads_vanish_with_their_centre_before_the_near_plane(void **state)
{
    static const double before[3] = {0, 0, -0.74}, beyond[3] = {0, 0, -0.76};
    test_twin *t = test_twin_create(state, "sphere_depth", 64, 64);
    t->scene.camera.near = 0.75;
    assert_int_equal(test_count(splat(t, "point", before, 0.3)), 0);
    assert_int_equal(test_count(splat(t, "quad", before, 0.3)), 0);
    assert_true(test_count(splat(t, "exact", before, 0.3)) > 100);
    assert_true(test_count(splat(t, "point", beyond, 0.3)) > 100);
    assert_true(test_count(splat(t, "quad", beyond, 0.3)) > 100);
}

/* Points beyond what the GPU draws would be cut without a word. */
static void points_larger_than_the_gpu_draws_are_refused(void **state)
{
    static const double c[1][3] = {{0, 0, -2}};
    test_twin *t = test_twin_create(state, "sphere_depth", 16, 16);
    test_twin_place(t, 1, c, 0.3, NULL);
    test_twin_set(t, "max_point_px", "2048");
    test_twin_set(t, "splat", "quad");
    assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
    test_twin_set(t, "splat", "point");
    if (ssfr_gl_get_limits(t->gl)->point_px >= 2048)
        assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
    else
        assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_run(t->graph, &t->scene, NULL), "max_point_px");
}

/* ---- all forms --------------------------------------------------------------------------------------------------- */

/* A hundredth of a pixel is wide: a pixel's middle is met or not, and nothing is divided by zero. */
static void tiny_spheres_draw_one_pixel_or_none(void **state)
{
    static const char *const forms[] = {"point", "quad", "exact"};
    test_twin *t = test_twin_create(state, "sphere_depth", 64, 64);
    const double pixel = 2.0 / 64, middle = 10.5 * pixel;
    const double on[3] = {middle, -middle, -2}, off[3] = {middle + 0.4 * pixel, -middle, -2};
    for (size_t f = 0; f < SSFR_COUNT(forms); f++) {
        const ssfr_field *depth = splat(t, forms[f], on, 0.005 * pixel);
        assert_int_equal(test_count(depth), 1);
        assert_close(*ssfr_field_at(depth, 42, 42), -2, 0.005 * pixel, 2 * t->eps);
        depth = splat(t, forms[f], off, 0.005 * pixel);
        assert_int_equal(test_count(depth), 0);
        for (int i = 0; i < 64 * 64; i++) assert_close(depth->data[i], -SSFR_EMPTY, 0, 1e-7);
    }
}

/* Half of the wall stands before the sphere, half cuts it; what is left is bit for bit what is drawn without a wall. */
static void scene_hides_what_is_behind_it(void **state)
{
    static const char *const forms[] = {"point", "quad", "exact"};
    static const double c[3] = {0, 0, -3};
    test_twin *t = test_twin_create(state, "sphere_depth", 61, 48);
    ssfr_field *wall = test_field(61, 48, 1);
    for (int i = 0; i < 61 * 48; i++) wall->data[i] = i % 61 < 30 ? -2 : -2.65;
    for (size_t f = 0; f < SSFR_COUNT(forms); f++) {
        test_twin_give(t, "scene_depth", test_field_filled(61, 48, 1, -SSFR_EMPTY));
        const ssfr_field *open = splat(t, forms[f], c, 0.5);
        test_twin_give(t, "scene_depth", wall);
        const ssfr_field *hidden = splat(t, forms[f], c, 0.5);
        assert_true(test_count(hidden) > 20 && test_count(hidden) < test_count(open) / 2);
        for (int i = 0; i < 61 * 48; i++) {
            const bool shows = ssfr_is_surface(open->data[i]) && open->data[i] > wall->data[i];
            assert_true(hidden->data[i] == (shows ? open->data[i] : (double)(t->gl ? -1e30f : -1e30)));
        }
    }
}

/* The same places twice cover the same pixels: what is more is a vertex, or four, and a position for each particle. */
static void the_report_counts_vertices_and_positions(void **state)
{
    static const char *const forms[] = {"point", "quad", "exact"};
    static const double c[4][3] = {{0, 0.1, -2}, {0.3, 0, -2}, {0, 0.1, -2}, {0.3, 0, -2}};
    test_twin *t = test_twin_create(state, "sphere_depth", 16, 16);
    for (int f = 0; f < 3; f++) {
        double vertices[2], bytes[2];
        test_twin_set(t, "splat", "%s", forms[f]);
        for (size_t k = 0; k < 2; k++) {
            test_twin_place(t, 2 + 2 * k, c, 0.3, NULL);
            test_twin_run(t, "depth");
            vertices[k] = ssfr_graph_report(t->graph)->nodes[0].vertices;
            bytes[k] = ssfr_graph_report(t->graph)->nodes[0].bytes;
        }
        assert_true(vertices[0] == (f ? 8 : 2) && vertices[1] == 2 * vertices[0]);
        assert_true(bytes[1] - bytes[0] == 2 * 3 * sizeof(float));
    }
}

static void splats_are_left_out_without_particles_in_view(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    ssfr_node_status status;
    test_twin *t = test_twin_create(state, "sphere_depth", 16, 16);
    test_twin_place(t, 1, behind, 0.3, NULL);
    const ssfr_field *depth = test_twin_run_if_needed(t, "depth", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_int_equal(test_count(depth), 0);
}

static void splats_refuse_values_out_of_range(void **state)
{
    test_twin *t = test_twin_create(state, "sphere_depth", 16, 16);
    test_twin_refuses(t, "radius_scale", "0", "sphere_depth.radius_scale");
    test_twin_refuses(t, "radius_scale", "nan", "sphere_depth.radius_scale");
    test_twin_refuses(t, "max_point_px", "0.5", "sphere_depth.max_point_px");
    test_twin_refuses(t, "splat", "ball", "ball");
    test_twin_refuses(t, "size", "2.385", "2.385");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(exact_splats_are_the_closed_form_on_and_off_the_axis),
        TEST_TWINS(exact_splats_know_cameras_that_turn_and_pixels_that_are_not_square),
        TEST_TWINS(exact_splats_are_the_same_a_thousand_kilometres_away),
        TEST_TWINS(exact_outline_is_the_perspective_one),
        TEST_TWINS(eye_inside_a_sphere_sees_the_near_plane),
        TEST_TWINS(sphere_around_the_eye_with_its_centre_behind_still_shows),
        TEST_TWINS(sphere_behind_the_eye_draws_nothing),
        TEST_TWINS(sphere_that_straddles_the_near_plane_is_cut_by_it),
        TEST_TWINS(sphere_larger_than_the_screen_fills_it),
        TEST_TWINS(spheres_beside_the_eye_are_seen_whole),
        TEST_TWINS(plane_of_spheres_keeps_the_nearest_at_each_pixel),
        TEST_TWINS(radius_scale_makes_the_sphere_larger),
        TEST_TWINS(quads_and_points_follow_their_first_order_formula),
        TEST_TWINS(the_rim_belongs_to_the_disc),
        TEST_TWINS(quad_error_falls_as_radius_over_distance_on_the_axis),
        TEST_TWINS(quad_error_stays_off_the_axis),
        TEST_TWINS(point_sprites_are_cut_at_their_largest_size),
        TEST_TWINS(points_vanish_with_their_centre_and_quads_do_not),
        TEST_TWINS(points_and_quads_vanish_with_their_centre_before_the_near_plane),
        TEST_GPU(points_larger_than_the_gpu_draws_are_refused),
        TEST_TWINS(tiny_spheres_draw_one_pixel_or_none),
        TEST_TWINS(scene_hides_what_is_behind_it),
        TEST_TWINS(the_report_counts_vertices_and_positions),
        TEST_TWINS(splats_are_left_out_without_particles_in_view),
        TEST_TWINS(splats_refuse_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

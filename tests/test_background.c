/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_background.c: floor, boxes and sky against planes and slabs met by hand. */
#include "tests/pass_util.h"

static const double pi = 3.14159265358979323846;

/* The eye 1.5 m over a floor at y = 0.25 m, looking down a little: the horizon lies in the image. */
static test_twin *begin(void **state, int w, int h)
{
    static const double eye[3] = {0.3, 1.75, 0.7}, target[3] = {0.1, 1.5, -1};
    test_twin *t = test_twin_create(state, "background", w, h);
    t->scene.floor = 0.25;
    test_twin_look(t, eye, target);
    return t;
}

typedef struct picture {
    const ssfr_field *color, *depth;
} picture;

static picture run(test_twin *t)
{
    return (picture){test_twin_run(t, "color"), test_twin_run(t, "depth")};
}

/* The ray of a pixel in world axes, with eye-space z of -1. */
static void world_ray(const test_twin *t, int x, int y, double d[3])
{
    const ssfr_camera *c = &t->scene.camera;
    const test_ray at = test_ray_at(t, x, y, 1);
    for (int k = 0; k < 3; k++) d[k] = at.u * c->right[k] + at.v * c->up[k] - c->back[k];
}

/* ---- the floor --------------------------------------------------------------------------------------------------- */

static void floor_is_an_infinite_plane(void **state)
{
    test_twin *t = begin(state, 61, 48);
    const picture p = run(t);
    int n_floor = 0;
    for (int y = 0; y < 48; y++)
        for (int x = 0; x < 61; x++) {
            double d[3];
            world_ray(t, x, y, d);
            const double z = *ssfr_field_at(p.depth, x, y), expected = 1.5 / d[1];
            assert_int_equal(ssfr_is_surface(z), d[1] < 0);
            /* Rounding moves the ray's slope, and by its inverse the distance. */
            if (d[1] < 0) assert_close(z, expected, 0, 16 * t->eps / fmin(-d[1], 1));
            n_floor += d[1] < 0;
        }
    assert_true(n_floor > 61 * 20 && n_floor < 61 * 40);
}

static void without_a_floor_there_is_sky_below_too(void **state)
{
    test_twin *t = begin(state, 61, 48);
    t->scene.floor = -INFINITY;
    const picture p = run(t);
    for (int i = 0; i < 61 * 48; i++) assert_close(p.depth->data[i], -SSFR_EMPTY, 0, t->gl ? 1e-7 : 0);
}

static void floor_over_the_eye_is_a_ceiling(void **state)
{
    test_twin *t = begin(state, 61, 48);
    t->scene.floor = 5;
    const picture p = run(t);
    for (int y = 0; y < 48; y++)
        for (int x = 0; x < 61; x++) {
            double d[3];
            world_ray(t, x, y, d);
            assert_int_equal(ssfr_is_surface(*ssfr_field_at(p.depth, x, y)), d[1] > 0);
        }
}

/* ---- the floor's colour ------------------------------------------------------------------------------------------ */

static double lambert(double cosine)
{
    return 0.45 + 0.55 * fmax(cosine, 0); /* light.ambient */
}

/* Clear air, and an eye so near that the tiles' contrast is whole. The chequer is read off at the floor's points, away
 * from the edges of tiles, where rounding decides. */
static void tiles_alternate(void **state)
{
    test_twin *t = begin(state, 61, 48);
    static const double eye[3] = {0.3, 1.75, 0.7}, target[3] = {0.1, 0, 0.2};
    test_twin_look(t, eye, target);
    test_twin_set(t, "floor.haze", "1e9");
    test_twin_set(t, "floor.tile", "1");
    const picture p = run(t);
    int n_light = 0, n_dark = 0;
    for (int y = 0; y < 48; y++)
        for (int x = 0; x < 61; x++) {
            double d[3];
            world_ray(t, x, y, d);
            const double s = -1.5 / d[1], u = eye[0] + s * d[0], v = eye[2] + s * d[2];
            if (fabs(u - round(u)) < 1e-4 || fabs(v - round(v)) < 1e-4) continue;
            const bool odd = ((int)floor(u) + (int)floor(v)) & 1;
            const double expected = (odd ? 0.34 : 0.62) * lambert(sin(40 * pi / 180));
            for (int k = 0; k < 3; k++) assert_close(ssfr_field_at(p.color, x, y)[k], expected, 1e-8 + 16 * t->eps, 0);
            n_dark += odd, n_light += !odd;
        }
    assert_true(n_light > 500 && n_dark > 500);
}

/* Light and dark alike: what is left is the floor's shade, fading into the sky behind it over 40 m. */
static void haze_fades_the_floor_into_the_sky(void **state)
{
    static const double horizon[3] = {0.78, 0.86, 0.93};
    test_twin *t = begin(state, 61, 48);
    test_twin_set(t, "floor.dark", "0.62");
    const picture p = run(t);
    double least = 1;
    for (int y = 0; y < 48; y++)
        for (int x = 0; x < 61; x++) {
            double d[3];
            world_ray(t, x, y, d);
            if (d[1] > -0.01) continue;
            const double clear = exp(1.5 / d[1] * sqrt(ssfr_dot(d, d)) / 40);
            const double shade = 0.62 * lambert(sin(40 * pi / 180));
            for (int k = 0; k < 3; k++)
                assert_close(ssfr_field_at(p.color, x, y)[k], ssfr_mix(horizon[k], shade, clear), 1e3 * t->eps, 0);
            least = fmin(least, clear);
        }
    assert_true(least < 0.3);
}

/* Far away, where a tile is a pixel or less, the mean of both stands. */
static void far_tiles_have_no_contrast(void **state)
{
    test_twin *t = begin(state, 61, 48);
    test_twin_set(t, "floor.haze", "1e9");
    test_twin_set(t, "floor.tile", "0.01");
    const picture p = run(t);
    for (int i = 0; i < 61 * 48; i++) {
        double d[3];
        world_ray(t, i % 61, i / 61, d);
        if (d[1] < -1e-3) assert_close(p.color->data[3 * i], 0.48 * lambert(sin(40 * pi / 180)), 1e-6, 0);
    }
}

static void move(test_twin *t, double x, double z)
{
    const double eye[3] = {x, 1.75, z}, target[3] = {x - 0.25, 1.5, z - 1.5};
    test_twin_look(t, eye, target);
}

static int n_changed(const ssfr_field *a, const ssfr_field *b)
{
    int n = 0;
    for (int i = 0; i < 3 * a->w * a->h; i++) n += !(fabs(a->data[i] - b->data[i]) < 1e-5);
    return n / 3;
}

/* Two tiles are a period. Tiles of half a metre and whole metres are exact in doubles, a thousand kilometres away too;
 * in floats a place on the other side of zero may round to the other side of a tile's edge. */
static void tiles_stay_put_under_whole_periods(void **state)
{
    static const double by[][2] = {{1, 0}, {-7, 12}, {1e6, 0}, {-1e6, 1e6}};
    test_twin *t = begin(state, 61, 48);
    test_twin_set(t, "floor.tile", "0.5");
    move(t, 0.25, 0.75);
    const picture here = run(t);
    for (size_t i = 0; i < SSFR_COUNT(by); i++) {
        move(t, 0.25 + by[i][0], 0.75 + by[i][1]);
        const picture there = run(t);
        assert_true(test_difference(there.depth, here.depth) == 0);
        assert_true(n_changed(there.color, here.color) <= (t->gl ? 2 : 0));
    }
    move(t, 0.75, 0.75);
    assert_true(n_changed(run(t).color, here.color) > 300);
}

/* ---- the sky ----------------------------------------------------------------------------------------------------- */

static void sky_goes_from_the_horizon_to_the_zenith(void **state)
{
    static const double eye[3] = {0, 0, 0}, up[3] = {0, 1, -1};
    static const double zenith[3] = {0.16, 0.33, 0.68}, horizon[3] = {0.78, 0.86, 0.93};
    test_twin *t = test_twin_create(state, "background", 61, 49);
    test_twin_look(t, eye, up);
    t->scene.camera.tan_y = t->scene.camera.tan_x = 1.2; /* from below the horizon to beyond the zenith */
    const picture p = run(t);
    for (int y = 0; y < 49; y++)
        for (int x = 0; x < 61; x++) {
            double d[3];
            world_ray(t, x, y, d);
            const double s = sqrt(fmax(d[1] / sqrt(ssfr_dot(d, d)), 0));
            assert_close(*ssfr_field_at(p.depth, x, y), -SSFR_EMPTY, 0, 1e-7);
            if (s > 0 && s < 0.05) continue; /* the root is steep there */
            for (int k = 0; k < 3; k++)
                assert_close(ssfr_field_at(p.color, x, y)[k], ssfr_mix(horizon[k], zenith[k], s), 256 * t->eps, 0);
        }
}

/* ---- boxes ------------------------------------------------------------------------------------------------------- */

static ssfr_solid box(double x, double y, double z, double turn)
{
    const double c = cos(turn), s = sin(turn), tilt_c = cos(0.3 * turn), tilt_s = sin(0.3 * turn);
    return (ssfr_solid){.centre = {x, y, z}, .half = {0.4, 0.3, 0.2}, .colour = {0.9, 0.2, 0.1},
                        .axis = {{c, 0, -s}, {s * tilt_s, tilt_c, c * tilt_s}, {s * tilt_c, -tilt_s, c * tilt_c}}};
}

/* Each of the six faces as a rectangle of a plane; the nearest that the ray meets before it. Where it only just does
 * not, *near. */
static double meet_box(const ssfr_solid *b, const double eye[3], const double d[3], double normal[3], bool *near)
{
    double nearest = INFINITY;
    *near = false;
    for (int face = 0; face < 6; face++) {
        const int k = face % 3;
        const double side = face < 3 ? 1 : -1;
        double to[3], slope = 0, inside = INFINITY;
        for (int j = 0; j < 3; j++) to[j] = b->centre[j] + side * b->half[k] * b->axis[k][j] - eye[j];
        slope = ssfr_dot(d, b->axis[k]);
        const double s = ssfr_dot(to, b->axis[k]) / slope;
        for (int j = 0; j < 3; j++) {
            const double p[3] = {s * d[0] - to[0], s * d[1] - to[1], s * d[2] - to[2]};
            if (j != k) inside = fmin(inside, b->half[j] - fabs(ssfr_dot(p, b->axis[j])));
        }
        *near = *near || fabs(inside) < 1e-5;
        if (!(s > 0 && inside > 0 && s < nearest)) continue;
        nearest = s;
        for (int j = 0; j < 3; j++) normal[j] = side * b->axis[k][j];
    }
    return nearest;
}

/* Boxes turned and tilted, before the floor and into it, and one under the floor. */
static void boxes_are_met_at_their_front_faces(void **state)
{
    const ssfr_solid solids[] = {box(0, 1.3, -1, 0), box(0.9, 0.9, -1.4, 0.7), box(-0.9, 0.3, -1.9, -1.1),
                                 box(0, -0.5, -1, 0.2)};
    test_twin *t = begin(state, 97, 72);
    const double a = 125 * pi / 180, e = 40 * pi / 180, light[3] = {cos(e) * cos(a), sin(e), cos(e) * sin(a)};
    t->scene.solids = solids, t->scene.n_solids = 4;
    const picture p = run(t);
    int hits[4] = {0};
    for (int y = 0; y < 72; y++)
        for (int x = 0; x < 97; x++) {
            double d[3], normal[3] = {0}, n[3] = {0};
            world_ray(t, x, y, d);
            double nearest = d[1] < 0 ? -1.5 / d[1] : SSFR_EMPTY;
            int which = -1;
            bool skip_it = false, near;
            for (int i = 0; i < 4; i++) {
                const double s = meet_box(&solids[i], t->scene.camera.eye, d, normal, &near);
                skip_it = skip_it || near;
                if (s >= nearest) continue;
                nearest = s, which = i;
                memcpy(n, normal, sizeof n);
            }
            if (skip_it || (which < 0 && fabs(d[1]) < 0.01)) continue;
            assert_close(*ssfr_field_at(p.depth, x, y), -nearest, which < 0 ? 0 : 64 * t->eps, 1e3 * t->eps);
            if (which < 0) continue;
            hits[which]++;
            const double lit = lambert(ssfr_dot(n, light));
            for (int k = 0; k < 3; k++)
                assert_close(ssfr_field_at(p.color, x, y)[k], solids[which].colour[k] * lit, 16 * t->eps, 0);
        }
    assert_true(hits[0] > 100 && hits[1] > 100 && hits[2] > 30 && hits[3] == 0);
}

static void box_around_the_eye_is_not_seen(void **state)
{
    ssfr_solid solid = box(0.3, 1.75, 0.7, 0.4);
    test_twin *t = begin(state, 61, 48);
    const picture plain = run(t);
    t->scene.solids = &solid, t->scene.n_solids = 1;
    assert_true(test_difference(run(t).depth, plain.depth) == 0);
    for (int k = 0; k < 3; k++) solid.centre[k] += 2 * t->scene.camera.back[k];
    assert_true(test_difference(run(t).depth, plain.depth) == 0); /* nor behind it */
}

/* Eye, floor and boxes moved by a thousand kilometres. */
static void scene_is_the_same_a_thousand_kilometres_away(void **state)
{
    ssfr_solid solid = box(0, 1.25, -1, 0);
    static const double eye[3] = {0.25, 1.75, 0.75}, target[3] = {0, 1.5, -0.75};
    test_twin *t = begin(state, 61, 48);
    test_twin_look(t, eye, target);
    test_twin_set(t, "floor.tile", "0.5");
    t->scene.solids = &solid, t->scene.n_solids = 1;
    const picture here = run(t);
    const double there_eye[3] = {1e6 + 0.25, 1.75 - 1e6, 0.75 + 1e6}, there_target[3] = {1e6, 1.5 - 1e6, 1e6 - 0.75};
    test_twin_look(t, there_eye, there_target);
    solid.centre[0] += 1e6, solid.centre[1] -= 1e6, solid.centre[2] += 1e6;
    t->scene.floor -= 1e6;
    const picture there = run(t);
    int n_moved = 0;
    for (int i = 0; i < 61 * 48; i++) { /* the box's 1.25 m is held to 1e-10 m there */
        const double before = here.depth->data[i], after = there.depth->data[i];
        n_moved += !(fabs(after - before) <= 1e-8 * fabs(before) + 32 * t->eps);
    }
    assert_true(n_moved <= 2);
}

static void colours_are_reflectances(void **state)
{
    const ssfr_solid solids[] = {box(0, 1.3, -1, 0.3), box(0.9, 0.9, -1.4, 0.7)};
    test_twin *t = begin(state, 61, 48);
    t->scene.solids = solids, t->scene.n_solids = 2;
    for (int elevation = -90; elevation <= 90; elevation += 30) {
        test_twin_set(t, "light.elevation_deg", "%d", elevation);
        const ssfr_field *color = run(t).color;
        for (int i = 0; i < 3 * 61 * 48; i++) assert_true(color->data[i] >= 0 && color->data[i] <= 1);
    }
}

static void scene_refuses_values_out_of_range(void **state)
{
    test_twin *t = begin(state, 8, 8);
    test_twin_refuses(t, "floor.tile", "0", "floor.tile");
    test_twin_refuses(t, "floor.light", "1.5", "floor.light");
    test_twin_refuses(t, "light.elevation_deg", "91", "light.elevation_deg");
    t->scene.n_solids = SSFR_MAX_SOLIDS + 1;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(t->graph, &t->scene, NULL), "65 solids");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(floor_is_an_infinite_plane),
        TEST_TWINS(without_a_floor_there_is_sky_below_too),
        TEST_TWINS(floor_over_the_eye_is_a_ceiling),
        TEST_TWINS(tiles_alternate),
        TEST_TWINS(haze_fades_the_floor_into_the_sky),
        TEST_TWINS(far_tiles_have_no_contrast),
        TEST_TWINS(tiles_stay_put_under_whole_periods),
        TEST_TWINS(sky_goes_from_the_horizon_to_the_zenith),
        TEST_TWINS(boxes_are_met_at_their_front_faces),
        TEST_TWINS(box_around_the_eye_is_not_seen),
        TEST_TWINS(scene_is_the_same_a_thousand_kilometres_away),
        TEST_TWINS(colours_are_reflectances),
        TEST_TWINS(scene_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

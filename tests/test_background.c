/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_background.c: floor and boxes against planes and slabs met by hand, solids against their own rays, the sky and
 * its maps. */
#include "scene/solid.h"
#include "tests/meshes.h"
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

/* ---- solids of all shapes ---------------------------------------------------------------------------------------- */

static ssfr_solid shape(ssfr_shape shape, double x, double y, double z, double turn, const ssfr_mesh *mesh)
{
    ssfr_solid s = box(x, y, z, turn);
    s.shape = shape, s.mesh = mesh;
    if (shape == SSFR_CYLINDER) s.half[2] = s.half[0];
    return s;
}

/* Silhouettes apart, every pixel shows the nearest place where its ray enters a solid (test_solid.c knows that these
 * are right), with its normal and its colour; gives how many pixels show each. */
static void check_solids(test_twin *t, const picture *p, int hits[SSFR_MAX_SOLIDS])
{
    const int w = t->scene.camera.w, h = t->scene.camera.h;
    const double a = 125 * pi / 180, e = 40 * pi / 180, light[3] = {cos(e) * cos(a), sin(e), cos(e) * sin(a)};
    int n_other = 0;
    memset(hits, 0, SSFR_MAX_SOLIDS * sizeof *hits);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            double d[3], normal[3], n[3] = {0};
            world_ray(t, x, y, d);
            double nearest = d[1] < 0 && isfinite(t->scene.floor) ? (t->scene.floor - t->scene.camera.eye[1]) / d[1]
                                                                  : SSFR_EMPTY;
            int which = -1;
            for (int i = 0; i < t->scene.n_solids; i++) {
                const double s = ssfr_solid_enter(&t->scene.solids[i], t->scene.camera.eye, d, normal);
                if (!(s > 0 && s < nearest)) continue;
                nearest = s, which = i;
                memcpy(n, normal, sizeof n);
            }
            if (which < 0) {
                n_other += ssfr_is_surface(*ssfr_field_at(p->depth, x, y)) != (nearest < SSFR_SURFACE);
                continue;
            }
            hits[which]++;
            const double z = *ssfr_field_at(p->depth, x, y), lit = lambert(ssfr_dot(n, light));
            bool same = fabs(z + nearest) <= 1e4 * t->eps * nearest;
            for (int k = 0; k < 3; k++)
                same &= fabs(ssfr_field_at(p->color, x, y)[k] - t->scene.solids[which].colour[k] * lit) <= 1e4 * t->eps;
            n_other += !same;
        }
    assert_true(n_other <= (t->gl ? w * h / 250 : 0));
}

static void every_shape_is_met_where_its_ray_enters_it(void **state)
{
    test_mesh m = test_mesh_thorns(2, 0.15, 0.4);
    ssfr_mesh *mesh = test_mesh_make(&m);
    test_twin *t = begin(state, 113, 84);
    ssfr_solid solids[] = {
        shape(SSFR_BOX, 0.2, 1.3, -1, 0.3, NULL), shape(SSFR_CYLINDER, 0.9, 1.1, -1.4, 0.7, NULL),
        shape(SSFR_SPHERE, -0.9, 0.8, -1.9, -1.1, NULL), shape(SSFR_RAMP, 0.9, 2.2, -1.5, 0.5, NULL),
        shape(SSFR_MESH, -0.6, 1.7, -0.8, 0.9, mesh), shape(SSFR_CYLINDER, 0.1, 2.3, -1.6, 2.1, NULL),
        shape(SSFR_MESH, -1.1, 2.4, -1.6, 2.9, mesh),
        {.shape = SSFR_PLANE, .centre = {2, 0, 0}, .colour = {0.3, 0.8, 0.6},
         .axis = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}}, /* a wall to the right */
    };
    int hits[SSFR_MAX_SOLIDS];
    solids[5].inner = 0.3, solids[2].half[1] = solids[2].half[2] = 0; /* which a sphere does not have */
    t->scene.solids = solids, t->scene.n_solids = SSFR_COUNT(solids);
    t->scene.camera.tan_x = 0.9, t->scene.camera.tan_y = 0.7;
    const picture p = run(t);
    check_solids(t, &p, hits);
    for (size_t i = 0; i < SSFR_COUNT(solids); i++) assert_true(hits[i] > 40);
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

/* From within the crowd: solids behind the eye, around it and across the image's edges. */
static void as_many_solids_as_there_may_be_are_drawn(void **state)
{
    test_mesh m = test_mesh_sphere(1, 0.3), other = test_mesh_thorns(1, 0.2, 0.3);
    ssfr_mesh *meshes[2] = {test_mesh_make(&m), test_mesh_make(&other)};
    test_twin *t = begin(state, 150, 110); /* tiles that the image's edges cut */
    static ssfr_solid solids[SSFR_MAX_SOLIDS];
    uint64_t seed = 64;
    int hits[SSFR_MAX_SOLIDS], n_seen = 0;
    t->scene.camera.tan_x = 1.1, t->scene.camera.tan_y = 0.8;
    for (int i = 0; i < SSFR_MAX_SOLIDS; i++) {
        const double x = test_random(&seed, -2, 2), y = test_random(&seed, 0.3, 3), z = test_random(&seed, -3, 2);
        const int kind = i % 5 == 4 ? SSFR_MESH : i % 5;
        solids[i] = shape((ssfr_shape)kind, x, y, z, test_random(&seed, -3, 3), meshes[i / 5 % 2]);
        for (int k = 0; k < 3; k++) solids[i].half[k] *= 0.6, solids[i].colour[k] = test_random(&seed, 0.2, 1);
        if (kind == SSFR_CYLINDER && i % 2) solids[i].inner = 0.7 * solids[i].half[0];
    }
    t->scene.solids = solids, t->scene.n_solids = SSFR_MAX_SOLIDS;
    const picture p = run(t);
    check_solids(t, &p, hits);
    for (int i = 0; i < SSFR_MAX_SOLIDS; i++) n_seen += hits[i] > 0;
    assert_true(n_seen > 20 && hits[32] + hits[60] + hits[61] + hits[62] > 0); /* also in a set's second word */
    for (int i = 0; i < 2; i++) ssfr_mesh_destroy(&meshes[i]);
    test_mesh_finish(&m), test_mesh_finish(&other);
}

/* A box of triangles shows as the box; then other meshes come and go, and each frame shows its own. */
static void each_frame_shows_its_own_meshes(void **state)
{
    test_mesh m[2] = {test_mesh_box(0.4, 0.3, 0.2), test_mesh_box(0.2, 0.3, 0.4)};
    ssfr_mesh *meshes[2] = {test_mesh_make(&m[0]), test_mesh_make(&m[1])};
    test_twin *t = begin(state, 61, 48);
    for (int i = 0; i < 4; i++) {
        ssfr_solid boxes[2] = {box(0.2, 1.3, -1, 0.4), box(-0.5, 1.6, -1.6, 1.2)}, solids[2];
        for (int k = 0; k < 2; k++) {
            const int which = (i + k) % 2;
            solids[k] = boxes[k];
            solids[k].shape = SSFR_MESH, solids[k].mesh = meshes[which];
            for (int j = 0; j < 3; j++) boxes[k].half[j] = which ? (double[3]){0.2, 0.3, 0.4}[j] : boxes[k].half[j];
        }
        t->scene.solids = boxes, t->scene.n_solids = 2 - i / 3;
        const picture expected = run(t);
        t->scene.solids = solids;
        const picture p = run(t);
        int n_other = 0;
        for (int j = 0; j < 61 * 48; j++)
            n_other += !(fabs(p.depth->data[j] - expected.depth->data[j]) <= -64 * t->eps * expected.depth->data[j]);
        assert_true(n_other <= (t->gl ? 4 : 0));
        assert_true(n_changed(p.color, expected.color) <= (t->gl ? 4 : 0));
    }
    t->scene.n_solids = 0;
    assert_true(test_count(run(t).depth) > 0);
    for (int i = 0; i < 2; i++) ssfr_mesh_destroy(&meshes[i]), test_mesh_finish(&m[i]);
}

/* A mesh whose own coordinates are large, seen from near by: they meet the eye in doubles. */
static void a_mesh_far_from_its_own_origin_keeps_its_digits(void **state)
{
    test_mesh m = test_mesh_box(0.4, 0.3, 0.2);
    ssfr_solid solid = box(0.2, 1.3, -1, 0);
    test_twin *t = begin(state, 61, 48);
    t->scene.solids = &solid, t->scene.n_solids = 1;
    const picture expected = run(t);
    for (size_t i = 0; i < 3 * m.n_vertices; i++) m.vertices[i] += 1e6;
    ssfr_mesh *mesh = test_mesh_make(&m);
    solid.shape = SSFR_MESH, solid.mesh = mesh;
    for (int k = 0; k < 3; k++) solid.centre[k] -= 1e6;
    const picture p = run(t);
    int n_other = 0;
    for (int j = 0; j < 61 * 48; j++)
        n_other += !(fabs(p.depth->data[j] - expected.depth->data[j]) <= 1e-8 - 64 * t->eps * expected.depth->data[j]);
    assert_true(n_other <= 2);
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

/* A plane may be given by any of its points. */
static void a_plane_given_by_a_point_far_away_keeps_its_digits(void **state)
{
    ssfr_solid wall = {.shape = SSFR_PLANE, .centre = {0, 0, -1.3}, .colour = {0.3, 0.8, 0.6},
                       .axis = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
    test_twin *t = begin(state, 61, 48);
    t->scene.solids = &wall, t->scene.n_solids = 1;
    const picture here = run(t);
    wall.centre[0] = 1e6, wall.centre[1] = -3e6;
    const picture there = run(t);
    assert_true(test_difference(there.depth, here.depth) <= 64 * t->eps);
    assert_int_equal(n_changed(there.color, here.color), 0);
}

/* ---- maps of the environment ------------------------------------------------------------------------------------- */

static test_twin *begin_with_map(void **state, const ssfr_field *map)
{
    test_twin *t = begin(state, 61, 48);
    t->scene.floor = -INFINITY, t->scene.environment = map;
    t->scene.camera.tan_x = 0.8, t->scene.camera.tan_y = 0.6;
    return t;
}

static void a_map_of_one_value_is_seen_everywhere(void **state)
{
    ssfr_field *map = test_field(16, 8, 3);
    for (int i = 0; i < 16 * 8 * 3; i++) map->data[i] = 0.25 * (i % 3 + 1);
    test_twin *t = begin_with_map(state, map);
    const picture p = run(t);
    for (int i = 0; i < 61 * 48; i++) {
        assert_close(p.depth->data[i], -SSFR_EMPTY, 0, 1e-7);
        for (int k = 0; k < 3; k++) assert_close(p.color->data[3 * i + k], 0.25 * (k + 1), 8 * t->eps, 0);
    }
}

static void look_along(test_twin *t, const double towards[3])
{
    const double eye[3] = {3, 4, 5}, at[3] = {3 + towards[0], 4 + towards[1], 5 + towards[2]};
    const double up[3] = {0, fabs(towards[1]) > 0.9 ? 0 : 1, fabs(towards[1]) > 0.9 ? 1 : 0};
    ssfr_camera *c = &t->scene.camera;
    const ssfr_camera before = *c;
    assert_int_equal(ssfr_camera_look(c, eye, at, up, 1, before.w, before.h), SSFR_OK);
    c->tan_x = before.tan_x, c->tan_y = before.tan_y;
}

/* As OpenEXR says: +z in the middle, +x a quarter from the left, -z at both ends, +y in row 0. Of 64 x 32 texels those
 * four are lit between whose middles the middle of the view looks. */
static void a_bright_texel_is_seen_in_its_direction(void **state)
{
    static const struct {
        double towards[3];
        int x, y; /* the first of the lit ones, 2 x 2 */
    } cases[] = {{{1, 0, 0}, 15, 15}, {{0, 0, 1}, 31, 15}, {{-1, 0, 0}, 47, 15}, {{0, 0, -1}, 63, 15}};
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_field *map = test_field_filled(64, 32, 3, 0.1);
        for (int j = 0; j < 4; j++) ssfr_field_at(map, (cases[i].x + j % 2) % 64, cases[i].y + j / 2)[1] = 9;
        test_twin *t = begin_with_map(state, map);
        look_along(t, cases[i].towards);
        const picture p = run(t);
        double most = 0;
        for (int j = 0; j < 61 * 48; j++) most = fmax(most, p.color->data[3 * j + 1]);
        assert_true(most > 8.5 && ssfr_field_at(p.color, 30, 24)[1] > 8.5);
        assert_close(ssfr_field_at(p.color, 0, 0)[1], 0.1, 1e-5, 0);
        assert_close(ssfr_field_at(p.color, 60, 47)[1], 0.1, 1e-5, 0);
        assert_close(ssfr_field_at(p.color, 30, 24)[0], 0.1, 1e-5, 0);
    }
}

/* Rows 0 and 31 are lit: straight up and down. */
static void the_poles_are_the_first_and_the_last_row(void **state)
{
    ssfr_field *map = test_field_filled(64, 32, 3, 0.1);
    for (int x = 0; x < 64; x++) ssfr_field_at(map, x, 0)[0] = 5, ssfr_field_at(map, x, 31)[2] = 7;
    test_twin *t = begin_with_map(state, map);
    look_along(t, (const double[3]){0, 1, 0});
    picture p = run(t);
    assert_close(ssfr_field_at(p.color, 30, 24)[0], 5, 1e-5, 0);
    assert_close(ssfr_field_at(p.color, 0, 0)[0], 0.1, 1e-5, 0);
    look_along(t, (const double[3]){0, -1, 0});
    p = run(t);
    assert_close(ssfr_field_at(p.color, 30, 24)[2], 7, 1e-5, 0);
    assert_close(ssfr_field_at(p.color, 0, 0)[2], 0.1, 1e-5, 0);
    assert_close(ssfr_field_at(p.color, 30, 24)[0], 0.1, 1e-5, 0);
}

/* Exactly up and down, where there is no longitude; with a floor under all haze, down is the horizon. */
static void straight_up_and_down_have_a_value(void **state)
{
    ssfr_field *map = test_field_filled(64, 32, 3, 0.1);
    for (int x = 0; x < 64; x++) ssfr_field_at(map, x, 0)[0] = 5, ssfr_field_at(map, x, 31)[0] = 7;
    for (int x = 0; x < 128; x++) ssfr_field_at(map, x % 64, 15 + x / 64)[0] = 3;
    test_twin *t = begin_with_map(state, map);
    t->scene.camera.w = t->scene.camera.h = 3;
    look_along(t, (const double[3]){0, 1, 0});
    assert_close(ssfr_field_at(run(t).color, 1, 1)[0], 5, 1e-5, 0);
    look_along(t, (const double[3]){0, -1, 0});
    assert_close(ssfr_field_at(run(t).color, 1, 1)[0], 7, 1e-5, 0);
    t->scene.floor = -1e5;
    assert_close(ssfr_field_at(run(t).color, 1, 1)[0], 3, 1e-5, 0);
}

/* A map that is smooth in direction, in all directions and over the seam: what is shown is as smooth, but for the
 * texels' size. */
static void a_smooth_map_is_smooth_over_seam_and_poles(void **state)
{
    static const double towards[][3] = {{0, 0, -1}, {0, 1, 0}, {0, -1, 0}, {0.3, 0.8, -0.5}, {1, 0.1, 0.1}};
    enum { MW = 256, MH = 128 };
    ssfr_field *map = test_field(MW, MH, 3);
    for (int y = 0; y < MH; y++)
        for (int x = 0; x < MW; x++) {
            const double lon = pi * (1 - 2 * (x + 0.5) / MW), lat = pi * (0.5 - (y + 0.5) / MH);
            const double d[3] = {cos(lat) * sin(lon), sin(lat), cos(lat) * cos(lon)};
            for (int k = 0; k < 3; k++) ssfr_field_at(map, x, y)[k] = 1 + d[k];
        }
    test_twin *t = begin_with_map(state, map);
    for (size_t i = 0; i < SSFR_COUNT(towards); i++) {
        look_along(t, towards[i]);
        const picture p = run(t);
        for (int y = 0; y < 48; y++)
            for (int x = 0; x < 61; x++) {
                double d[3];
                world_ray(t, x, y, d);
                ssfr_normalize(d);
                /* Half a row is missing at a pole; elsewhere linear interpolation is right to second order. */
                const double eps = fabs(d[1]) > cos(2 * pi / MH) ? 1.1 * pi / MH : 2 * ssfr_square(pi / MH);
                for (int k = 0; k < 3; k++) assert_close(ssfr_field_at(p.color, x, y)[k], 1 + d[k], eps, 0);
            }
    }
}

/* Under the floor there is no sky: the floor fades into what the map has at the horizon. */
static void a_floor_fades_into_the_maps_horizon(void **state)
{
    ssfr_field *map = test_field_filled(32, 16, 3, 0.2);
    for (int i = 0; i < 32 * 3; i++) map->data[8 * 32 * 3 + i] = map->data[7 * 32 * 3 + i] = 0.7; /* by the horizon */
    test_twin *t = begin_with_map(state, map);
    t->scene.floor = 0.25;
    test_twin_set(t, "floor.haze", "1e-3");
    const picture p = run(t);
    for (int y = 0; y < 48; y++)
        for (int x = 0; x < 61; x++) {
            double d[3];
            world_ray(t, x, y, d);
            if (d[1] < 0) assert_close(ssfr_field_at(p.color, x, y)[1], 0.7, 1e-5, 0);
        }
}

static void another_map_takes_the_place_of_the_first(void **state)
{
    ssfr_field *a = test_field_filled(32, 16, 3, 0.2), *b = test_field_filled(32, 16, 3, 0.6);
    ssfr_field *c = test_field_filled(8, 4, 3, 0.9);
    test_twin *t = begin_with_map(state, a);
    const ssfr_field *const order[] = {a, b, a, c, b};
    for (size_t i = 0; i < SSFR_COUNT(order); i++) {
        t->scene.environment = order[i];
        assert_close(run(t).color->data[0], order[i]->data[0], 1e-6, 0);
    }
    ssfr_field_fill(b, 0.3); /* the same field, filled anew */
    assert_close(run(t).color->data[0], 0.3, 1e-6, 0);
    t->scene.environment = NULL;
    assert_close(run(t).color->data[2], 0.93, 0.2, 0);
    t->scene.environment = b;
    assert_close(run(t).color->data[0], 0.3, 1e-6, 0);
}

static void maps_and_meshes_are_uploaded_once(void **state)
{
    test_mesh m = test_mesh_box(0.4, 0.3, 0.2);
    ssfr_mesh *mesh = test_mesh_make(&m);
    ssfr_solid solid = shape(SSFR_MESH, 0.2, 1.3, -1, 0.4, mesh);
    test_twin *t = begin_with_map(state, test_field_filled(32, 16, 3, 0.2));
    t->scene.solids = &solid, t->scene.n_solids = 1;
    run(t);
    solid.centre[0] += 0.1; /* how a mesh stands does not matter */
    assert_true(test_count(run(t).depth) > 0);
    assert_int_equal(ssfr_graph_report(t->graph)->allocations, 0);
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

static void maps_out_of_range_are_refused(void **state)
{
    ssfr_field *map = test_field_filled(32, 16, 3, 0.2), *alpha = test_field(4, 2, 4);
    test_twin *t = begin_with_map(state, map);
    *ssfr_field_at(map, 7, 5) = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(t->graph, &t->scene, NULL), "environment: pixel 7,5 is nan");
    *ssfr_field_at(map, 7, 5) = 1e200;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(t->graph, &t->scene, NULL), "environment: pixel 7,5 is 1e+200");
    *ssfr_field_at(map, 7, 5) = 1;
    run(t);
    t->scene.environment = alpha;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(t->graph, &t->scene, NULL), "4 x 2 pixels and 4 channels");
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
        TEST_TWINS(every_shape_is_met_where_its_ray_enters_it),
        TEST_TWINS(as_many_solids_as_there_may_be_are_drawn),
        TEST_TWINS(each_frame_shows_its_own_meshes),
        TEST_TWINS(a_mesh_far_from_its_own_origin_keeps_its_digits),
        TEST_TWINS(a_plane_given_by_a_point_far_away_keeps_its_digits),
        TEST_TWINS(a_map_of_one_value_is_seen_everywhere),
        TEST_TWINS(a_bright_texel_is_seen_in_its_direction),
        TEST_TWINS(the_poles_are_the_first_and_the_last_row),
        TEST_TWINS(straight_up_and_down_have_a_value),
        TEST_TWINS(a_smooth_map_is_smooth_over_seam_and_poles),
        TEST_TWINS(a_floor_fades_into_the_maps_horizon),
        TEST_TWINS(another_map_takes_the_place_of_the_first),
        TEST_TWINS(maps_and_meshes_are_uploaded_once),
        TEST_TWINS(maps_out_of_range_are_refused),
        TEST_TWINS(scene_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_truth.c: the ray-cast image of a stage against closed forms, and what its parameters, samples and files do. */
#include "tests/truths.h"

#include "experiments/truth/estimate.h"
#include "experiments/truth/tiles.h"
#include "experiments/truth/truth_file.h"

#include "base/param.h"

#include <float.h>
#include <gsl/gsl_cdf.h>

enum { W = 64, H = 48 };

static const double ball_centre[3] = {0.1, 0.2, 0}, ball_radius = 0.5, ball_eye[3] = {0.3, 0.4, 2.385};

static ssfr_stage *one_ball(const double eye[3])
{
    static const double target[3] = {0.1, 0.2, 0.05};
    return test_truth_stage(1, ball_centre, ball_radius, eye, target, W, H);
}

static const char *const balls[] = {"truth.kind", "spheres", "truth.parts", "surface,thickness", NULL};

/* The ray through the middle of a pixel, by the camera's definition. */
static double direction(const ssfr_camera *c, int x, int y, double dir[3])
{
    const double u = ((x + 0.5) / c->w * 2 - 1) * c->tan_x, v = (1 - (y + 0.5) / c->h * 2) * c->tan_y;
    for (int k = 0; k < 3; k++) dir[k] = u * c->right[k] + v * c->up[k] - c->back[k];
    return 1 / ssfr_normalize(dir); /* cosine to the axis */
}

/* Where it enters the ball and leaves it; false when it does neither. */
static bool meet_ball(const double eye[3], const double dir[3], double t[2])
{
    const double to[3] = {ball_centre[0] - eye[0], ball_centre[1] - eye[1], ball_centre[2] - eye[2]};
    const double middle = ssfr_dot(to, dir);
    double aside[3];
    for (int k = 0; k < 3; k++) aside[k] = to[k] - middle * dir[k];
    const double left = ball_radius * ball_radius - ssfr_dot(aside, aside);
    t[0] = middle - sqrt(fmax(left, 0)), t[1] = middle + sqrt(fmax(left, 0));
    return left > 0;
}

/* Of the ball at t along the ray, in eye space, towards the eye. */
static void normal_of_ball(const ssfr_camera *c, const double dir[3], double t, double out[3])
{
    double n[3];
    for (int k = 0; k < 3; k++) n[k] = (c->eye[k] + t * dir[k] - ball_centre[k]) / ball_radius;
    const double side = ssfr_dot(n, dir) > 0 ? -1 : 1;
    out[0] = side * ssfr_dot(n, c->right), out[1] = side * ssfr_dot(n, c->up), out[2] = side * ssfr_dot(n, c->back);
}

/* ---- closed forms ------------------------------------------------------------------------------------------------ */

static void assert_pixel_of_ball(const ssfr_truth *truth, const ssfr_camera *c, int x, int y)
{
    double dir[3], t[2], normal[3];
    const double cosine = direction(c, x, y, dir), near = c->near / cosine;
    const bool hit = meet_ball(c->eye, dir, t) && t[1] > near;
    const double surface = t[0] > near ? t[0] : t[1];
    const double z = hit ? -surface * cosine : -SSFR_EMPTY, length = hit ? t[1] - fmax(t[0], near) : 0;
#define AT(channel) (*test_truth_at(truth, SSFR_TRUTH_##channel, x, y))
    assert_close(AT(depth), z, 1e-9, 0);
    assert_true(fabs(AT(depth) - z) <= AT(depth_err) + 1e-15);
    assert_true(AT(depth_err) < 1e-9);
    assert_close(AT(thickness), length, 1e-9, 0);
    assert_close(AT(content), length, 1e-9, 0);
    assert_true(fabs(AT(thickness) - length) <= AT(thickness_err) + 1e-15);
    assert_int_equal(AT(crossings), hit ? (t[0] > near) + 1 : 0);
    if (hit) normal_of_ball(c, dir, surface, normal);
    for (int k = 0; k < 3; k++)
        assert_close(test_truth_at(truth, SSFR_TRUTH_normal, x, y)[k], hit ? normal[k] : 0, 1e-9, 0);
    assert_true(AT(normal_err) < 1e-9);
#undef AT
}

static void assert_ball_seen_from(const double eye[3])
{
    ssfr_stage *stage = one_ball(eye);
    const ssfr_truth_params params = test_truth_params(balls);
    ssfr_truth *truth = test_truth_cast(stage, &params);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) assert_pixel_of_ball(truth, &stage->scene.camera, x, y);
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

static void a_ball_has_its_depth_normals_and_chords(void **state)
{
    (void)state;
    assert_ball_seen_from(ball_eye);
}

static void from_inside_rays_begin_at_the_near_plane_and_normals_face_the_eye(void **state)
{
    (void)state;
    static const double middle[3] = {0.15, 0.25, -0.12}, edge[3] = {0.1, 0.2, 0.495};
    assert_ball_seen_from(middle);
    assert_ball_seen_from(edge); /* the near plane, 1 cm before the eye, is inside here and outside there */
}

static void no_particle_is_no_fluid(void **state)
{
    (void)state;
    ssfr_stage *stage = test_truth_scene("empty", 21, 13);
    for (int kind = 0; ssfr_continuum_names[kind]; kind++) {
        const char *const settings[] = {"truth.kind", ssfr_continuum_names[kind], NULL};
        const ssfr_truth_params params = test_truth_params(settings);
        ssfr_truth *truth = test_truth_cast(stage, &params);
        test_truth_check_finite(truth);
        for (int i = 0; i < 21 * 13; i++) {
            assert_true(truth->channels[SSFR_TRUTH_depth]->data[i] == -SSFR_EMPTY);
            assert_true(truth->channels[SSFR_TRUTH_thickness]->data[i] == 0);
            assert_true(truth->channels[SSFR_TRUTH_colour]->data[3 * i] > 0); /* sky and floor */
        }
        ssfr_truth_destroy(&truth);
    }
    ssfr_stage_destroy(&stage);
}

/* A sheet of balls, one thick, seen from the front and along itself: no ray misses what it meets. */
static void a_sheet_one_particle_thick_has_no_holes(void **state)
{
    (void)state;
    ssfr_stage *stage = test_truth_scene("plane", W, H);
    const ssfr_truth_params params = test_truth_params(balls);
    static const double target[3] = {0, 0, 0}, up[3] = {0, 1, 0}, along[3] = {1, 0, 0};
    const double half = 0.02 * 19, near = stage->scene.camera.eye[2];
    ssfr_truth *front = test_truth_cast(stage, &params);
    for (int i = 0; i < W * H; i++) {
        double dir[3];
        direction(&stage->scene.camera, i % W, i / W, dir);
        const double x = -near * dir[0] / dir[2], y = -near * dir[1] / dir[2]; /* where it passes the sheet */
        if (fabs(x) > half || fabs(y) > half) continue;
        assert_true(front->channels[SSFR_TRUTH_depth]->data[i] > -near - 0.02);
        assert_in_range((unsigned long)(1e6 * front->channels[SSFR_TRUTH_thickness]->data[i]), 20000, 60000);
    }
    assert_int_equal(ssfr_camera_look(&stage->scene.camera, along, target, up, 0.7, W, H), SSFR_OK);
    ssfr_truth *side = test_truth_cast(stage, &params);
    const double *row = test_truth_at(side, SSFR_TRUTH_thickness, W / 2, H / 2);
    assert_true(*row > 0.5); /* most of the sheet's 0.8 m */
    test_truth_check_finite(side);
    ssfr_truth_destroy(&front), ssfr_truth_destroy(&side);
    ssfr_stage_destroy(&stage);
}

static void every_kind_of_fluid_has_finite_numbers(void **state)
{
    (void)state;
    ssfr_stage *stage = test_truth_scene("block", 18, 12);
    for (int kind = 0; ssfr_continuum_names[kind]; kind++) {
        const char *const settings[] = {"truth.kind", ssfr_continuum_names[kind], "truth.judged", "1",
                                        "path.depth", "6", "path.least", "0.01", NULL};
        const ssfr_truth_params params = test_truth_params(settings);
        ssfr_truth *truth = test_truth_cast(stage, &params);
        size_t covered = 0, crossed = 0;
        test_truth_check_finite(truth);
        for (int i = 0; i < 18 * 12; i++) {
            covered += truth->channels[SSFR_TRUTH_depth]->data[i] > -SSFR_SURFACE;
            crossed += truth->channels[SSFR_TRUTH_content]->data[i] > 0;
        }
        assert_in_range(covered, 40, 75);
        assert_int_equal(truth->stats.judged, crossed);
        assert_true(truth->stats.judged_max < 1e-7 && truth->stats.judged_ratio < 100);
        assert_true(truth->stats.bytes > 0 && truth->stats.bytes < 300 * 8000);
        ssfr_truth_destroy(&truth);
    }
    ssfr_stage_destroy(&stage);
}

/* ---- places ------------------------------------------------------------------------------------------------------ */

static ssfr_truth *cast_cloud(const char *kind, double origin)
{
    enum { N = 200 };
    static double positions[3 * N];
    const double eye[3] = {origin + 0.2, origin + 0.3, origin + 2.385}, target[3] = {origin, origin, origin};
    const char *const settings[] = {"truth.kind", kind, "truth.parts", "surface,thickness", NULL};
    const ssfr_truth_params params = test_truth_params(settings);
    uint64_t random = 3;
    /* Multiples of 2^-20 m, which a double holds a million metres away, too. */
    for (int i = 0; i < 3 * N; i++)
        positions[i] = origin + floor(test_random(&random, -0.4, 0.4) * 0x1p20) * 0x1p-20;
    ssfr_stage *stage = test_truth_stage(N, positions, 0.06, eye, target, W / 2, H / 2);
    ssfr_truth *truth = test_truth_cast(stage, &params);
    ssfr_stage_destroy(&stage);
    return truth;
}

static void a_million_metres_away_all_is_the_same(void **state)
{
    (void)state;
    for (int kind = 0; ssfr_continuum_names[kind]; kind++) {
        ssfr_truth *here = cast_cloud(ssfr_continuum_names[kind], 0);
        ssfr_truth *there = cast_cloud(ssfr_continuum_names[kind], 1e6);
        for (int i = 0; i < W * H / 4; i++)
            for (int c = 0; c < SSFR_N_TRUTH_CHANNELS; c++) {
                const bool bound = strstr(ssfr_truth_channels[c].name, "err");
                const bool flat = here->channels[c] && c != SSFR_TRUTH_normal && !bound;
                if (flat) assert_close(there->channels[c]->data[i], here->channels[c]->data[i], 2e-6, 1e-6);
                if (c == SSFR_TRUTH_normal)
                    for (int k = 0; k < 3; k++)
                        assert_close(there->channels[c]->data[3 * i + k], here->channels[c]->data[3 * i + k], 2e-5, 0);
            }
        ssfr_truth_destroy(&here), ssfr_truth_destroy(&there);
    }
}

/* ---- solids, foam, light ----------------------------------------------------------------------------------------- */

/* A block whose front is at z = 0.1, behind half of the ball. */
static void add_wall(ssfr_stage *stage)
{
    stage->solids[0] = (ssfr_solid){.shape = SSFR_BOX, .centre = {0.1, 0.2, -0.9}, .half = {5, 5, 1},
                                    .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .colour = {0.5, 0.4, 0.3}};
    stage->scene.n_solids = 1;
}

static void solids_and_the_floor_hide_fluid(void **state)
{
    (void)state;
    ssfr_stage *stage = one_ball(ball_eye);
    const ssfr_truth_params hidden = test_truth_params(balls); /* as splats are, unless it is switched off */
    ssfr_truth_params seen = hidden;
    const ssfr_camera *c = &stage->scene.camera;
    assert_int_equal(ssfr_truth_set(&seen, "truth.solids", "0"), SSFR_OK);
    add_wall(stage);
    stage->scene.floor = 0.1;
    ssfr_truth *cut = test_truth_cast(stage, &hidden), *whole = test_truth_cast(stage, &seen);
    int n_cut = 0;
    for (int i = 0; i < W * H; i++) {
        double dir[3], t[2];
        direction(c, i % W, i / W, dir);
        const bool hit = meet_ball(c->eye, dir, t);
        const double wall = (0.1 - c->eye[2]) / dir[2], floor = dir[1] < 0 ? (0.1 - c->eye[1]) / dir[1] : INFINITY;
        const double to = fmin(wall, floor), length = hit ? fmax(fmin(t[1], to) - t[0], 0) : 0;
        assert_close(whole->channels[SSFR_TRUTH_thickness]->data[i], hit ? t[1] - t[0] : 0, 1e-9, 0);
        assert_close(cut->channels[SSFR_TRUTH_thickness]->data[i], length, 1e-9, 0);
        assert_int_equal(cut->channels[SSFR_TRUTH_depth]->data[i] > -SSFR_SURFACE, hit && to > t[0]);
        n_cut += hit && to < t[0];
    }
    assert_true(n_cut > 50);
    ssfr_truth_destroy(&cut), ssfr_truth_destroy(&whole);
    ssfr_stage_destroy(&stage);
}

/* A small block beside the ball, none of which is amid anything, and an eye above the floor or below. */
static void a_solid_hides_what_is_behind_it_and_nothing_beside(void **state)
{
    (void)state;
    static const double half[3] = {0.2, 0.15, 0.1}, middle[3] = {0.35, 0.3, 1.1};
    ssfr_stage *stage = one_ball(ball_eye);
    const ssfr_truth_params params = test_truth_params(balls);
    const ssfr_camera *c = &stage->scene.camera;
    int n[2] = {0, 0};
    stage->solids[0] = (ssfr_solid){.shape = SSFR_BOX, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    memcpy(stage->solids[0].centre, middle, sizeof middle), memcpy(stage->solids[0].half, half, sizeof half);
    stage->scene.n_solids = 1;
    ssfr_truth *truth = test_truth_cast(stage, &params);
    for (int i = 0; i < W * H; i++) {
        double dir[3], t[2], from = 0, to = INFINITY;
        direction(c, i % W, i / W, dir);
        for (int k = 0; k < 3; k++) { /* between the block's sides */
            const double a = (middle[k] - half[k] - c->eye[k]) / dir[k], b = (middle[k] + half[k] - c->eye[k]) / dir[k];
            from = fmax(from, fmin(a, b)), to = fmin(to, fmax(a, b));
        }
        const bool ball = meet_ball(c->eye, dir, t), hidden = from < to;
        assert_int_equal(truth->channels[SSFR_TRUTH_depth]->data[i] > -SSFR_SURFACE, ball && !hidden);
        if (ball) n[hidden]++;
    }
    assert_true(n[0] > 50 && n[1] > 50);
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

static void from_below_the_floor_hides_what_is_above(void **state)
{
    (void)state;
    ssfr_stage *stage = one_ball(ball_eye);
    const ssfr_truth_params params = test_truth_params(balls);
    const ssfr_camera *c = &stage->scene.camera;
    stage->scene.floor = ball_eye[1] + 0.01;
    ssfr_truth *truth = test_truth_cast(stage, &params);
    int n[2] = {0, 0};
    for (int i = 0; i < W * H; i++) {
        double dir[3], t[2];
        direction(c, i % W, i / W, dir);
        const bool ball = meet_ball(c->eye, dir, t), hidden = c->eye[1] + t[0] * dir[1] > stage->scene.floor;
        assert_int_equal(truth->channels[SSFR_TRUTH_depth]->data[i] > -SSFR_SURFACE, ball && !hidden);
        if (ball) n[hidden]++;
    }
    assert_true(n[0] > 50 && n[1] > 50);
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

static void foam_is_seen_before_solids_and_not_behind(void **state)
{
    (void)state;
    static const double place[3] = {0.1, 0.2, -0.6}; /* it reaches half a metre */
    static const char *const settings[] = {"truth.parts", "foam", "truth.solids", "0", NULL};
    static uint32_t kind[] = {SSFR_FOAM};
    const ssfr_particles given = {.radius = 0.1, .kind = kind};
    const ssfr_truth_params params = test_truth_params(settings);
    ssfr_stage *stage = one_ball(ball_eye);
    assert_int_equal(ssfr_particles_create(&stage->foam, 1, place, &given), SSFR_OK);
    ssfr_truth *open = test_truth_cast(stage, &params);
    add_wall(stage);
    ssfr_truth *hidden = test_truth_cast(stage, &params);
    double most = 0;
    for (int i = 0; i < W * H; i++) {
        const double *foam = open->channels[SSFR_TRUTH_foam]->data + 4 * i;
        assert_true(foam[3] >= 0 && foam[3] <= 1 && foam[0] >= 0);
        assert_true(hidden->channels[SSFR_TRUTH_foam]->data[4 * i + 3] == 0);
        assert_close(foam[0], 0.95 * foam[3], 1e-15, 1e-12); /* all of it is foam */
        assert_int_equal(open->channels[SSFR_TRUTH_foam_err]->data[i] > 0, foam[3] > 0);
        most = fmax(most, foam[3]);
    }
    assert_true(most > 1e-3);
    assert_null(open->channels[SSFR_TRUTH_depth]);
    test_truth_check_finite(open);
    ssfr_truth_destroy(&open), ssfr_truth_destroy(&hidden);
    ssfr_stage_destroy(&stage);
}

/* Of the air's index and without absorption it changes nothing: the picture is that without it. */
static void fluid_as_clear_as_air_is_not_seen(void **state)
{
    (void)state;
    static const double nowhere[3] = {0, 0, 0}, target[3] = {0.1, 0.2, 0.05};
    static const char *const settings[] = {"truth.kind", "spheres", "truth.parts", "colour", "medium.ior", "1",
                                           "medium.absorption_r", "0", "medium.absorption_g", "0",
                                           "medium.absorption_b", "0", NULL};
    const ssfr_truth_params params = test_truth_params(settings);
    ssfr_stage *stage = one_ball(ball_eye), *empty = test_truth_stage(0, nowhere, ball_radius, ball_eye, target, W, H);
    add_wall(stage), add_wall(empty);
    stage->scene.floor = empty->scene.floor = -0.3;
    ssfr_truth *with = test_truth_cast(stage, &params), *without = test_truth_cast(empty, &params);
    for (int i = 0; i < 3 * W * H; i++)
        assert_close(with->channels[SSFR_TRUTH_colour]->data[i], without->channels[SSFR_TRUTH_colour]->data[i],
                     1e-9, 0);
    ssfr_truth_destroy(&with), ssfr_truth_destroy(&without);
    ssfr_stage_destroy(&stage), ssfr_stage_destroy(&empty);
}

/* The near plane cuts the fluid alone: where it lies behind floor and wall nothing but they, and the sky, are seen. */
static void floor_and_solids_are_seen_before_the_near_plane(void **state)
{
    (void)state;
    static const double nowhere[3] = {0, 0, 0}, target[3] = {0.1, 0.2, 0.05};
    static const char *const both[][7] = {{"truth.kind", "spheres", "truth.parts", "colour", NULL},
                                          {"truth.kind", "spheres", "truth.parts", "colour", "truth.solids", "0", NULL}};
    for (size_t k = 0; k < SSFR_COUNT(both); k++) {
        const ssfr_truth_params params = test_truth_params(both[k]);
        ssfr_stage *stage = one_ball(ball_eye);
        ssfr_stage *empty = test_truth_stage(0, nowhere, ball_radius, ball_eye, target, W, H);
        add_wall(stage), add_wall(empty);
        stage->scene.floor = empty->scene.floor = -0.3;
        stage->scene.camera.near = 100; /* m */
        ssfr_truth *far = test_truth_cast(stage, &params), *without = test_truth_cast(empty, &params);
        for (int i = 0; i < 3 * W * H; i++) {
            const double seen = without->channels[SSFR_TRUTH_colour]->data[i];
            assert_close(far->channels[SSFR_TRUTH_colour]->data[i], seen, 1e-9, 0);
        }
        ssfr_truth_destroy(&far), ssfr_truth_destroy(&without);
        ssfr_stage_destroy(&stage), ssfr_stage_destroy(&empty);
    }
}

static void light_is_finite_from_inside_too(void **state)
{
    (void)state;
    static const double inside[3] = {0.15, 0.25, -0.12};
    static const char *const settings[] = {"truth.kind", "spheres", "path.depth", "8", NULL};
    const ssfr_truth_params params = test_truth_params(settings);
    ssfr_stage *stage = one_ball(inside);
    stage->scene.floor = -1;
    ssfr_truth *truth = test_truth_cast(stage, &params);
    test_truth_check_finite(truth);
    for (int i = 0; i < 3 * W * H; i++) assert_true(truth->channels[SSFR_TRUTH_colour]->data[i] > 0);
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

/* Of the air's index, it only absorbs: what is left of the sky is e^(-a T), T the length beyond the near plane. */
static void light_fades_by_the_thickness(void **state)
{
    (void)state;
    static const double edge[3] = {0.1, 0.2, 0.505}, target[3] = {0.1, 0.2, 0.05}; /* 5 mm before the ball */
    static const char *const settings[] = {"truth.kind", "spheres", "truth.parts", "thickness,colour", "medium.ior",
                                           "1", "medium.absorption_r", "2.385", "medium.color_r", "0", NULL};
    const ssfr_truth_params params = test_truth_params(settings);
    ssfr_stage *stage = one_ball(edge), *empty = test_truth_stage(0, edge, ball_radius, edge, target, W, H);
    ssfr_truth *with = test_truth_cast(stage, &params), *without = test_truth_cast(empty, &params);
    for (int i = 0; i < W * H; i++) {
        const double left = exp(-2.385 * with->channels[SSFR_TRUTH_thickness]->data[i]);
        assert_true(left < 0.5);
        assert_close(with->channels[SSFR_TRUTH_colour]->data[3 * i],
                     left * without->channels[SSFR_TRUTH_colour]->data[3 * i], 1e-12, 1e-9);
    }
    ssfr_truth_destroy(&with), ssfr_truth_destroy(&without);
    ssfr_stage_destroy(&stage), ssfr_stage_destroy(&empty);
}

/* Paths that end at once: their error is what they could have brought. */
static void paths_that_end_are_in_the_error(void **state)
{
    (void)state;
    static const char *const settings[] = {"truth.kind", "spheres", "truth.parts", "colour", "path.depth", "0", NULL};
    const ssfr_truth_params none = test_truth_params(settings);
    ssfr_truth_params all = none;
    ssfr_stage *stage = one_ball(ball_eye);
    assert_int_equal(ssfr_truth_set(&all, "path.depth", "64"), SSFR_OK);
    ssfr_truth *rough = test_truth_cast(stage, &none), *fine = test_truth_cast(stage, &all);
    double most = 0;
    for (int i = 0; i < W * H; i++) {
        const double err = rough->channels[SSFR_TRUTH_colour_err]->data[i], own =
                     fine->channels[SSFR_TRUTH_colour_err]->data[i];
        for (int k = 0; k < 3; k++)
            assert_true(fabs(rough->channels[SSFR_TRUTH_colour]->data[3 * i + k] -
                             fine->channels[SSFR_TRUTH_colour]->data[3 * i + k]) <= err + own + 1e-12);
        most = fmax(most, err);
    }
    assert_true(most > 0.1);
    ssfr_truth_destroy(&rough), ssfr_truth_destroy(&fine);
    ssfr_stage_destroy(&stage);
}

static void a_share_of_the_rays_is_judged(void **state)
{
    (void)state;
    static const char *const settings[] = {"truth.parts", "thickness", "truth.judged", "0.25", NULL};
    const ssfr_truth_params params = test_truth_params(settings);
    ssfr_stage *stage = test_truth_scene("block", W, H);
    ssfr_truth *truth = test_truth_cast(stage, &params);
    double crossed = 0;
    for (int i = 0; i < W * H; i++) crossed += truth->channels[SSFR_TRUTH_content]->data[i] > 0;
    assert_close((double)truth->stats.judged, 0.25 * crossed, 0, 0.05);
    assert_true(truth->stats.judged_ratio > 0 && truth->stats.judged_max > 0);
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

/* ---- integrators ------------------------------------------------------------------------------------------------- */

static void integrators_agree_within_their_own_errors(void **state)
{
    (void)state;
    static const char *const names[] = {"qags", "qagp", "cquad", "gauss", "steps"};
    ssfr_stage *stage = test_truth_scene("block", 15, 9);
    const char *const closed[] = {"truth.parts", "thickness", NULL};
    ssfr_truth_params params = test_truth_params(closed);
    ssfr_truth *truth = test_truth_cast(stage, &params);
    for (size_t r = 0; r < SSFR_COUNT(names); r++) {
        assert_int_equal(ssfr_truth_set(&params, "truth.integrator", names[r]), SSFR_OK);
        ssfr_truth *other = test_truth_cast(stage, &params);
        double largest = 0;
        for (int i = 0; i < 15 * 9; i++) {
            const double difference = fabs(other->channels[SSFR_TRUTH_content]->data[i] -
                                           truth->channels[SSFR_TRUTH_content]->data[i]);
            largest = fmax(largest, difference);
            if (strcmp(names[r], "steps") == 0) /* as renderers do it: no estimate to rely on */
                assert_true(difference <= 10 * other->channels[SSFR_TRUTH_content_err]->data[i] + 1e-4);
        }
        assert_true(largest < (strcmp(names[r], "steps") == 0 ? 1e-3 : 1e-6));
        assert_int_equal(other->stats.judged, 0);
        ssfr_truth_destroy(&other);
    }
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

/* ---- samples ----------------------------------------------------------------------------------------------------- */

static void a_sample_has_the_pixels_of_the_whole(void **state)
{
    (void)state;
    ssfr_stage *stage = one_ball(ball_eye);
    const ssfr_truth_params params = test_truth_params(balls);
    const ssfr_truth_options options = {.every = 5, .seed = 7, .no_cache = true};
    ssfr_truth *whole = test_truth_cast(stage, &params), *some = NULL;
    assert_int_equal(ssfr_truth_create(&some, stage, &params, &options), SSFR_OK);
    size_t n = 0;
    for (int i = 0; i < W * H; i++) {
        const bool cast = some->cast->data[i] == 1;
        n += cast;
        assert_true(cast || some->cast->data[i] == 0);
        assert_true(some->channels[SSFR_TRUTH_depth]->data[i] ==
                    (cast ? whole->channels[SSFR_TRUTH_depth]->data[i] : -SSFR_EMPTY));
        assert_true(some->channels[SSFR_TRUTH_thickness]->data[i] ==
                    (cast ? whole->channels[SSFR_TRUTH_thickness]->data[i] : 0));
    }
    assert_int_equal(n, 13 * 10); /* squares of 5 px in 64 x 48 */
    assert_int_equal(some->stats.rays, n);
    ssfr_truth_destroy(&whole), ssfr_truth_destroy(&some);
    ssfr_stage_destroy(&stage);
}

static ssfr_estimate estimate_of(const ssfr_truth *truth, const char *quantity)
{
    ssfr_estimate all[SSFR_MAX_ESTIMATES], found = {0};
    int n = 0;
    assert_int_equal(ssfr_truth_estimate(truth, all, &n), SSFR_OK);
    for (int i = 0; i < n; i++)
        if (strcmp(all[i].quantity, quantity) == 0) found = all[i];
    assert_non_null(found.quantity);
    return found;
}

static void all_pixels_give_the_mean_itself(void **state)
{
    (void)state;
    ssfr_stage *stage = one_ball(ball_eye);
    const ssfr_truth_params params = test_truth_params(balls);
    ssfr_truth *truth = test_truth_cast(stage, &params);
    double sum = 0, depth = 0, covered = 0;
    for (int i = 0; i < W * H; i++) {
        const double z = truth->channels[SSFR_TRUTH_depth]->data[i];
        sum += truth->channels[SSFR_TRUTH_thickness]->data[i];
        if (z > -SSFR_SURFACE) depth += z, covered++;
    }
    const ssfr_estimate share = estimate_of(truth, "covered"), mean = estimate_of(truth, "depth");
    assert_close(share.value, covered / (W * H), 0, 1e-13);
    assert_close(mean.value, depth / covered, 0, 1e-13);
    assert_close(estimate_of(truth, "thickness").value, sum / (W * H), 0, 1e-13);
    assert_true(mean.low <= mean.value && mean.value <= mean.high && mean.high - mean.low < 1e-9);
    assert_true(mean.high > mean.low); /* the truth's own error */
    assert_int_equal(mean.n, covered);
    assert_int_equal(share.n, W * H);
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

/* Of 100 seeds about 95 must hold the mean; the collapsed strata err on the safe side. */
static void intervals_hold_the_mean_as_often_as_they_say(void **state)
{
    (void)state;
    static const char *const quantities[] = {"covered", "depth", "thickness", "content"};
    static const int sides[] = {3, 6};
    double means[SSFR_COUNT(quantities)];
    ssfr_stage *stage = one_ball(ball_eye);
    const ssfr_truth_params params = test_truth_params(balls);
    ssfr_truth *whole = test_truth_cast(stage, &params);
    for (size_t q = 0; q < SSFR_COUNT(quantities); q++) means[q] = estimate_of(whole, quantities[q]).value;
    for (size_t s = 0; s < SSFR_COUNT(sides); s++) {
        int held[SSFR_COUNT(quantities)] = {0};
        double widths[SSFR_COUNT(quantities)] = {0};
        for (uint64_t seed = 1; seed <= 100; seed++) {
            const ssfr_truth_options options = {.every = sides[s], .seed = seed, .no_cache = true};
            ssfr_truth *some = NULL;
            assert_int_equal(ssfr_truth_create(&some, stage, &params, &options), SSFR_OK);
            for (size_t q = 0; q < SSFR_COUNT(quantities); q++) {
                const double mean = means[q];
                const ssfr_estimate e = estimate_of(some, quantities[q]);
                held[q] += e.low <= mean && mean <= e.high;
                widths[q] += (e.high - e.low) / fabs(mean) / 100;
            }
            ssfr_truth_destroy(&some);
        }
        for (size_t q = 0; q < SSFR_COUNT(quantities); q++) {
            assert_true(held[q] >= 88);
            assert_true(widths[q] < (s == 0 ? 0.2 : 0.6)); /* and they say something */
        }
    }
    ssfr_truth_destroy(&whole);
    ssfr_stage_destroy(&stage);
}

static void one_square_tells_nothing_of_the_others(void **state)
{
    (void)state;
    ssfr_stage *stage = one_ball(ball_eye);
    const ssfr_truth_params params = test_truth_params(balls);
    const ssfr_truth_options options = {.every = 100, .seed = 1, .no_cache = true};
    ssfr_truth *truth = NULL;
    assert_int_equal(ssfr_truth_create(&truth, stage, &params, &options), SSFR_OK);
    assert_int_equal(truth->stats.rays, 1);
    const ssfr_estimate e = estimate_of(truth, "thickness");
    assert_true(e.low == 0 && e.high == INFINITY && isfinite(e.value));
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

static void a_mean_over_nothing_is_none(void **state)
{
    (void)state;
    static const double away[3] = {0, 0, 10}, target[3] = {0, 0, 20};
    const ssfr_truth_params params = test_truth_params(balls);
    ssfr_stage *stage = test_truth_stage(1, ball_centre, ball_radius, away, target, W, H);
    ssfr_truth *truth = test_truth_cast(stage, &params);
    const ssfr_estimate e = estimate_of(truth, "depth");
    assert_true(isnan(e.value) && e.n == 0);
    assert_true(estimate_of(truth, "covered").value == 0);
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

/* A ball whose rim the middle ray just touches, exactly, and perhaps one behind, in the ray's way. */
static ssfr_truth *cast_touch(size_t n, const char *parts)
{
    static const double places[] = {0.5, 0, 0, 0, 0, -2}, eye[] = {0, 0, 2.5}, target[] = {0, 0, 0};
    const char *const settings[] = {"truth.kind", "spheres", "truth.parts", parts, NULL};
    const ssfr_truth_params params = test_truth_params(settings);
    ssfr_stage *stage = test_truth_stage(n, places, 0.5, eye, target, 3, 3);
    ssfr_truth *truth = test_truth_cast(stage, &params);
    ssfr_stage_destroy(&stage);
    return truth;
}

static void a_touch_is_no_crossing_but_in_the_bounds(void **state)
{
    (void)state;
    ssfr_truth *truth = cast_touch(1, "surface,thickness");
#define MIDDLE(channel) (*test_truth_at(truth, SSFR_TRUTH_##channel, 1, 1))
    assert_int_equal(truth->stats.touches, 1);
    assert_true(MIDDLE(depth) == -SSFR_EMPTY && MIDDLE(depth_err) == SSFR_EMPTY);
    assert_true(MIDDLE(thickness) == 0 && MIDDLE(thickness_err) > 1e-9 && MIDDLE(thickness_err) < 1e-6);
    assert_close(MIDDLE(normal_err), acos(-1), 0, 1e-15);
    const ssfr_estimate share = estimate_of(truth, "covered");
    assert_close(share.high, share.value + 1 / 9.0, 0, 1e-12);
    ssfr_truth_destroy(&truth);
    truth = cast_touch(2, "surface,thickness");
    assert_int_equal(truth->stats.touches, 1);
    assert_close(MIDDLE(depth), -4, 0, 1e-14);
    assert_close(MIDDLE(depth_err), 1.5, 0, 1e-6); /* from where it touches */
    assert_close(MIDDLE(normal_err), acos(-1), 0, 1e-15);
    assert_close(MIDDLE(thickness), 1, 0, 1e-14);
    assert_true(MIDDLE(thickness_err) > 1e-9);
#undef MIDDLE
    ssfr_truth_destroy(&truth);
}

static void touches_of_light_are_counted_apart(void **state)
{
    (void)state;
    ssfr_truth *truth = cast_touch(1, "colour");
    assert_true(truth->stats.touches == 0 && truth->stats.light_touches > 0);
    ssfr_truth_destroy(&truth);
    truth = cast_touch(0, "colour");
    assert_int_equal(truth->stats.light_touches, 0);
    ssfr_truth_destroy(&truth);
}

/* ---- the statistics of samples, on images that were made up ------------------------------------------------------ */

static ssfr_truth *made_truth(int w, int h, int every, unsigned parts)
{
    ssfr_truth *truth = NULL;
    assert_int_equal(ssfr_alloc(&truth, 1, sizeof *truth, "a truth"), SSFR_OK);
    truth->w = w, truth->h = h, truth->every = every, truth->parts = parts;
    assert_int_equal(ssfr_field_create(&truth->cast, w, h, 1), SSFR_OK);
    for (int i = 0; i < SSFR_N_TRUTH_CHANNELS; i++) {
        const ssfr_truth_channel_row *row = &ssfr_truth_channels[i];
        if (!(parts & (unsigned)row->part)) continue;
        assert_int_equal(ssfr_field_create(&truth->channels[i], w, h, row->n), SSFR_OK);
        if (i == SSFR_TRUTH_depth) ssfr_field_fill(truth->channels[i], -SSFR_EMPTY);
    }
    return truth;
}

/* One pixel of each square is cast, as ssfr_truth_create chooses them. */
static void draw_pixels(ssfr_truth *truth, uint64_t seed)
{
    const ssfr_tiles tiles = {.w = truth->w, .h = truth->h, .every = truth->every, .seed = seed};
    ssfr_field_fill(truth->cast, 0);
    for (int y = 0; y < truth->h; y += truth->every)
        for (int x = 0; x < truth->w; x += truth->every) {
            int pixel[2];
            ssfr_tiles_choose(&tiles, x, y, pixel);
            *ssfr_field_at(truth->cast, pixel[0], pixel[1]) = 1;
        }
}

static void cast_by_hand(ssfr_truth *truth, int x, int y, double thickness)
{
    *ssfr_field_at(truth->cast, x, y) = 1;
    *ssfr_field_at(truth->channels[SSFR_TRUTH_thickness], x, y) = thickness;
}

/* Squares of four pixels that have the same four values, in any order: what neighbours differ by is noise alone, so
 * that the variance is not overrated and any that is underrated shows. One draw of {0, 1, 2, 5} has one of 3.5. */
static void the_interval_has_the_variance_of_the_estimate(void **state)
{
    (void)state;
    enum { SIDE = 20, N = SIDE * SIDE, DRAWS = 500 };
    static const double values[] = {0, 1, 2, 5};
    const double t = 1.9718962; /* 97.5 % of Student's distribution with 200 degrees of freedom */
    ssfr_truth *truth = made_truth(2 * SIDE, 2 * SIDE, 2, SSFR_TRUTH_THICKNESS);
    double variance = 0, spread = 0;
    uint64_t random = 3;
    int held = 0;
    for (int y = 0; y < 2 * SIDE; y += 2)
        for (int x = 0; x < 2 * SIDE; x += 2)
            for (int i = 0, turn = (int)test_random(&random, 0, 4); i < 4; i++)
                *ssfr_field_at(truth->channels[SSFR_TRUTH_thickness], x + i % 2, y + i / 2) = values[(i + turn) % 4];
    for (uint64_t seed = 1; seed <= DRAWS; seed++) {
        draw_pixels(truth, seed);
        const ssfr_estimate e = estimate_of(truth, "thickness");
        variance += ssfr_square(0.5 * (e.high - e.low) / t) / DRAWS;
        spread += ssfr_square(e.value - 2) / DRAWS;
        held += e.low <= 2 && 2 <= e.high;
    }
    assert_close(variance, 3.5 / N, 0, 0.02);
    assert_close(spread, 3.5 / N, 0, 0.2);
    assert_in_range(held, 0.92 * DRAWS, 0.98 * DRAWS);
    ssfr_truth_destroy(&truth);
}

/* Squares of 4, 4, 2 pixels, and below them of 2, 2, 1. */
static void narrow_squares_at_the_border_count_by_their_pixels(void **state)
{
    (void)state;
    ssfr_truth *truth = made_truth(5, 3, 2, SSFR_TRUTH_THICKNESS);
    cast_by_hand(truth, 1, 0, 1), cast_by_hand(truth, 2, 1, 3), cast_by_hand(truth, 4, 1, 2);
    cast_by_hand(truth, 0, 2, 4), cast_by_hand(truth, 3, 2, 7), cast_by_hand(truth, 4, 2, 6);
    const ssfr_estimate e = estimate_of(truth, "thickness");
    assert_close(e.value, (4 * 1 + 4 * 3 + 2 * 2 + 2 * 4 + 2 * 7 + 6) / 15.0, 0, 1e-14);
    assert_true(e.low == 0 && e.high == INFINITY); /* six pixels tell too little */
    assert_int_equal(e.n, 6);
    ssfr_truth_destroy(&truth);
}

/* Eleven squares in a row: four pairs (1, 2) of variance 1, and (1, 2, 5), of 3 / 2 of the sum of squares: 13. */
static void an_odd_square_joins_the_last_pair(void **state)
{
    (void)state;
    enum { N = 11 };
    const double degrees = 3 * ssfr_square(17) / (4 + ssfr_square(13)) - 2, t = gsl_cdf_tdist_Pinv(0.975, degrees);
    ssfr_truth *truth = made_truth(2 * N, 2, 2, SSFR_TRUTH_THICKNESS);
    for (int i = 0; i < N; i++) cast_by_hand(truth, 2 * i + i % 2, i / 2 % 2, i == N - 1 ? 5 : 1 + i % 2);
    const ssfr_estimate e = estimate_of(truth, "thickness");
    assert_close(e.value, 20.0 / N, 0, 1e-14);
    assert_close(e.high - e.value, t * sqrt(17) / N, 0, 1e-12);
    ssfr_truth_destroy(&truth);
}

static void what_a_sample_did_not_see_may_be_there(void **state)
{
    (void)state;
    ssfr_truth *truth = made_truth(80, 60, 4, SSFR_TRUTH_SURFACE | SSFR_TRUTH_THICKNESS | SSFR_TRUTH_FOAM);
    draw_pixels(truth, 1);
    const ssfr_estimate none = estimate_of(truth, "covered");
    assert_true(none.value == 0 && none.low == 0);
    assert_close(none.high, -log(0.025) / 300, 0, 1e-12); /* of 300 squares */
    assert_close(estimate_of(truth, "foam_opacity").high, none.high, 0, 1e-12);
    assert_true(estimate_of(truth, "thickness").high == 0); /* which nothing limits */
    ssfr_field_fill(truth->channels[SSFR_TRUTH_depth], -2.385);
    const ssfr_estimate all = estimate_of(truth, "covered");
    assert_close(all.value, 1, 0, 1e-13);
    assert_true(all.high == 1);
    assert_close(all.low, 1 + log(0.025) / 300, 0, 1e-11);
    ssfr_truth_destroy(&truth);
}

static void one_covered_pixel_tells_nothing_of_others_but_where_all_are_known(void **state)
{
    (void)state;
    ssfr_truth *some = made_truth(8, 8, 2, SSFR_TRUTH_SURFACE), *all = made_truth(8, 8, 1, SSFR_TRUTH_SURFACE);
    draw_pixels(some, 1), draw_pixels(all, 1);
    *ssfr_field_at(all->channels[SSFR_TRUTH_depth], 5, 3) = -2.385;
    for (int i = 4; i < 6; i++)
        for (int k = 2; k < 4; k++) *ssfr_field_at(some->channels[SSFR_TRUTH_depth], i, k) = -2.385;
    const ssfr_estimate one = estimate_of(some, "depth"), only = estimate_of(all, "depth");
    assert_int_equal(one.n, 1);
    assert_close(one.value, -2.385, 0, 1e-14);
    assert_true(one.low == -INFINITY && one.high == 0);
    assert_close(only.low, -2.385, 0, 1e-13);
    assert_close(only.high, -2.385, 0, 1e-13);
    assert_true(estimate_of(all, "covered").high < 1 / 64.0 + 1e-12);
    ssfr_truth_destroy(&some), ssfr_truth_destroy(&all);
}

static void colours_are_weighed_as_rec_709_says(void **state)
{
    (void)state;
    static const double foam[4] = {0.5, 0.25, 0.125, 0.75}, colour[3] = {0.25, 0.5, 1};
    ssfr_truth *truth = made_truth(4, 4, 1, SSFR_TRUTH_FOAM | SSFR_TRUTH_COLOUR);
    draw_pixels(truth, 1);
    for (int i = 0; i < 16; i++) {
        memcpy(truth->channels[SSFR_TRUTH_foam]->data + 4 * i, foam, sizeof foam);
        memcpy(truth->channels[SSFR_TRUTH_colour]->data + 3 * i, colour, sizeof colour);
    }
    ssfr_field_fill(truth->channels[SSFR_TRUTH_foam_err], 0.01);
    ssfr_field_fill(truth->channels[SSFR_TRUTH_colour_err], 0.02);
    const ssfr_estimate e[] = {estimate_of(truth, "foam_luminance"), estimate_of(truth, "foam_opacity"),
                               estimate_of(truth, "luminance")};
    const double values[] = {0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722 * 0.125, 0.75,
                             0.2126 * 0.25 + 0.7152 * 0.5 + 0.0722};
    for (size_t i = 0; i < SSFR_COUNT(e); i++) {
        assert_close(e[i].value, values[i], 0, 1e-14);
        assert_close(e[i].high - e[i].value, i < 2 ? 0.01 : 0.02, 0, 1e-10);
        assert_close(e[i].value - e[i].low, i < 2 ? 0.01 : 0.02, 0, 1e-10);
    }
    ssfr_truth_destroy(&truth);
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static ssfr_field *load(const char *path, const char *channels)
{
    ssfr_field *field = NULL;
    assert_int_equal(ssfr_exr_load(path, channels, &field), SSFR_OK);
    return field;
}

/* Between vectors of about unit length that are nearly parallel; 0 for none. */
static double angle(const double a[3], const double b[3])
{
    const double cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    const double length2 = ssfr_dot(a, b);
    return length2 > 0 ? sqrt(ssfr_dot(cross, cross)) / length2 : 0;
}

static void bounds_in_a_file_hold_for_its_floats(void **state)
{
    (void)state;
    ssfr_stage *stage = one_ball(ball_eye);
    const ssfr_truth_params params = test_truth_params(balls);
    ssfr_truth *truth = test_truth_cast(stage, &params);
    ssfr_record record = {0};
    const char *path = test_path("truth.exr");
    assert_int_equal(ssfr_truth_record(&record, truth, &params), SSFR_OK);
    assert_int_equal(ssfr_truth_save(path, truth, &record), SSFR_OK);
    for (int c = 0; c + 1 < SSFR_N_TRUTH_CHANNELS; c++) {
        if (!truth->channels[c] || !strstr(ssfr_truth_channels[c + 1].name, "_err")) continue;
        ssfr_field *values = load(path, ssfr_truth_channels[c].exr);
        ssfr_field *bounds = load(path, ssfr_truth_channels[c + 1].exr);
        bool wider = false;
        for (int i = 0; i < W * H * values->c; i++) {
            const double exact = truth->channels[c]->data[i], bound = bounds->data[i / values->c];
            const double own = truth->channels[c + 1]->data[i / values->c];
            if (fabs(exact) > SSFR_SURFACE) assert_true(bound == 0);
            if (fabs(exact) > SSFR_SURFACE) continue;
            assert_true(fabs(values->data[i] - exact) + own * (values->c == 1) <= bound * (1 + 1e-15));
            wider |= bound > own;
        }
        assert_true(wider);
        for (int i = 0; i < W * H && c == SSFR_TRUTH_normal; i++)
            assert_true(angle(truth->channels[c]->data + 3 * i, values->data + 3 * i) <= bounds->data[i]);
        ssfr_field_destroy(&values), ssfr_field_destroy(&bounds);
    }
    double number = 0;
    assert_int_equal(ssfr_exr_number(path, "truth.size", &number), SSFR_OK);
    assert_close(number, 1, 0, 0);
    assert_int_equal(ssfr_exr_number(path, "stats.rays", &number), SSFR_OK);
    assert_close(number, W * H, 0, 0);
    ssfr_record_finish(&record);
    ssfr_truth_destroy(&truth);
    ssfr_stage_destroy(&stage);
}

static void a_preview_fills_the_squares(void **state)
{
    (void)state;
    static const char *const parts[] = {"colour", "surface", "thickness", "foam"};
    ssfr_stage *stage = one_ball(ball_eye);
    stage->scene.floor = -1;
    for (size_t i = 0; i < SSFR_COUNT(parts); i++) {
        const char *const settings[] = {"truth.kind", "spheres", "truth.parts", parts[i], NULL};
        const ssfr_truth_params params = test_truth_params(settings);
        const ssfr_truth_options options = {.every = 4, .no_cache = true};
        const char *path = test_path("truth.png");
        ssfr_truth *truth = NULL;
        ssfr_field *picture = NULL;
        assert_int_equal(ssfr_truth_create(&truth, stage, &params, &options), SSFR_OK);
        assert_int_equal(ssfr_truth_preview(path, truth), SSFR_OK);
        assert_int_equal(ssfr_png_load(path, &picture), SSFR_OK);
        assert_int_equal(picture->w, W);
        const double middle = *ssfr_field_at(picture, W / 2, H / 2), corner = *ssfr_field_at(picture, 0, 0);
        if (i == 1) assert_true(middle > 0.8 && corner < 0.2); /* lit from the eye, before dark grey */
        if (i == 2) assert_true(middle < 0.5 && corner == 1); /* water, before white */
        for (int k = 0; k < W * H; k++)
            assert_memory_equal(picture->data + 3 * k, ssfr_field_at(picture, k % W / 4 * 4, k / W / 4 * 4),
                                3 * sizeof(double));
        ssfr_field_destroy(&picture);
        ssfr_truth_destroy(&truth);
    }
    ssfr_stage_destroy(&stage);
}

/* ---- parameters -------------------------------------------------------------------------------------------------- */

static void every_parameter_can_be_set_by_its_key(void **state)
{
    (void)state;
    ssfr_truth_params params;
    const ssfr_param *row;
    const void *group;
    char key[128], before[256], after[256];
    int n = 0, of_truth = 0;
    ssfr_truth_defaults(&params);
    for (; ssfr_truth_key_at(&params, n, key, &row, &group); n++) {
        const double value = 0.5 * (row->def + (row->max > 2 * row->def ? row->max : row->min));
        char text[256];
        ssfr_param_format(row, group, before, sizeof before);
        if (row->type == SSFR_REAL)
            snprintf(text, sizeof text, "%.17g", value);
        else
            snprintf(text, sizeof text, "%s", before);
        assert_int_equal(ssfr_truth_set(&params, key, text), SSFR_OK);
        ssfr_param_format(row, group, after, sizeof after);
        if (row->type == SSFR_REAL) assert_close(strtod(after, NULL), value, 0, 1e-15);
        else assert_string_equal(after, before);
        of_truth += strncmp(key, "truth.", 6) == 0;
    }
    assert_true(n > 30 && of_truth >= 13);
}

static void keys_are_unique(void **state)
{
    (void)state;
    ssfr_truth_params params;
    const ssfr_param *row;
    const void *group;
    char key[128], other[128];
    ssfr_truth_defaults(&params);
    for (int i = 0; ssfr_truth_key_at(&params, i, key, &row, &group); i++)
        for (int k = 0; k < i && ssfr_truth_key_at(&params, k, other, &row, &group); k++)
            assert_string_not_equal(key, other);
}

static void bad_parameters_are_refused_in_one_line(void **state)
{
    (void)state;
    ssfr_truth_params params;
    ssfr_truth_defaults(&params);
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_truth_set(&params, "truth.kinds", "1"),
                 "truth.kinds: no such parameter; there are kind, ");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_truth_set(&params, "truth.kinds", "1"), "parts, integrator");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_truth_set(&params, "bilateral.sigma", "1"),
                 "its groups are truth, extinction, path, anisotropy, medium, light, sky, floor");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_truth_set(&params, "truth", "1"), "its groups are truth");
    assert_fails(SSFR_ERR_VALUE, ssfr_truth_set(&params, "truth.kind", "water"),
                 "truth.kind=water: expected one of spheres, density");
    assert_fails(SSFR_ERR_VALUE, ssfr_truth_set(&params, "truth.parts", "surface,air"),
                 "surface, thickness, foam, colour");
    assert_fails(SSFR_ERR_VALUE, ssfr_truth_set(&params, "truth.level", "NaN"), "truth.level=NaN");
    assert_fails(SSFR_ERR_VALUE, ssfr_truth_set(&params, "truth.judged", "1.1"), "truth.judged=1.1");
}

static void bad_options_are_refused_in_one_line(void **state)
{
    (void)state;
    ssfr_stage *stage = one_ball(ball_eye);
    ssfr_truth_params params = test_truth_params(balls);
    ssfr_truth_options options = {.every = 0, .no_cache = true};
    ssfr_truth *truth = NULL;
    assert_fails(SSFR_ERR_VALUE, ssfr_truth_create(&truth, stage, &params, &options), "every 0 pixels");
    options.every = 1;
    params.cast.parts = 0;
    assert_fails(SSFR_ERR_VALUE, ssfr_truth_create(&truth, stage, &params, &options), "truth.parts=none");
    params.cast.parts = SSFR_TRUTH_SURFACE;
    stage->particles->radius = 0;
    assert_fails(SSFR_ERR_VALUE, ssfr_truth_create(&truth, stage, &params, &options), "radius");
    stage->particles->radius = ball_radius;
    stage->scene.camera.near = -1;
    assert_fails(SSFR_ERR_VALUE, ssfr_truth_create(&truth, stage, &params, &options), "near -1");
    assert_null(truth);
    ssfr_stage_destroy(&stage);
}

static void a_scene_file_sets_what_truth_has(void **state)
{
    (void)state;
    static const char text[] =
        "title: A\nradius: 0.05\nparticles: 100\nduration: 0.4\nframe_rate: 20\n"
        "domain: {lo: [0, 0, 0], hi: [1, 1, 1]}\n"
        "fluid: {column: {lo: [0, 0, 0], hi: [0.2, 0.2, 0.2]}}\ncameras: {side: {eye: [0, 0, 2], target: [0, 0, 0]}}\n"
        "set: {curvature_flow.iterations: 3}\nmedium: {ior: 1.5}\nlight: {ambient: 0.25}\n";
    ssfr_truth_params params;
    ssfr_description *d = NULL;
    ssfr_truth_defaults(&params);
    assert_int_equal(ssfr_description_parse(&d, "a.yaml", text, SSFR_SCALE_FULL, NULL), SSFR_OK);
    assert_int_equal(ssfr_truth_apply_scene(&params, d), SSFR_OK);
    assert_close(params.world.medium.ior, 1.5, 0, 0);
    assert_close(params.world.light.ambient, 0.25, 0, 0);
    free(d->settings[1].value);
    d->settings[1].value = calloc(2, 1);
    d->settings[1].value[0] = '9';
    assert_fails(SSFR_ERR_VALUE, ssfr_truth_apply_scene(&params, d), "medium.ior=9");
    ssfr_description_destroy(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_has_its_depth_normals_and_chords),
        cmocka_unit_test(from_inside_rays_begin_at_the_near_plane_and_normals_face_the_eye),
        cmocka_unit_test(no_particle_is_no_fluid),
        cmocka_unit_test(a_sheet_one_particle_thick_has_no_holes),
        cmocka_unit_test(every_kind_of_fluid_has_finite_numbers),
        cmocka_unit_test(a_million_metres_away_all_is_the_same),
        cmocka_unit_test(solids_and_the_floor_hide_fluid),
        cmocka_unit_test(a_solid_hides_what_is_behind_it_and_nothing_beside),
        cmocka_unit_test(from_below_the_floor_hides_what_is_above),
        cmocka_unit_test(foam_is_seen_before_solids_and_not_behind),
        cmocka_unit_test(fluid_as_clear_as_air_is_not_seen),
        cmocka_unit_test(floor_and_solids_are_seen_before_the_near_plane),
        cmocka_unit_test(light_is_finite_from_inside_too),
        cmocka_unit_test(light_fades_by_the_thickness),
        cmocka_unit_test(paths_that_end_are_in_the_error),
        cmocka_unit_test(a_share_of_the_rays_is_judged),
        cmocka_unit_test(integrators_agree_within_their_own_errors),
        cmocka_unit_test(a_sample_has_the_pixels_of_the_whole),
        cmocka_unit_test(all_pixels_give_the_mean_itself),
        cmocka_unit_test(intervals_hold_the_mean_as_often_as_they_say),
        cmocka_unit_test(one_square_tells_nothing_of_the_others),
        cmocka_unit_test(a_mean_over_nothing_is_none),
        cmocka_unit_test(a_touch_is_no_crossing_but_in_the_bounds),
        cmocka_unit_test(touches_of_light_are_counted_apart),
        cmocka_unit_test(the_interval_has_the_variance_of_the_estimate),
        cmocka_unit_test(narrow_squares_at_the_border_count_by_their_pixels),
        cmocka_unit_test(an_odd_square_joins_the_last_pair),
        cmocka_unit_test(what_a_sample_did_not_see_may_be_there),
        cmocka_unit_test(one_covered_pixel_tells_nothing_of_others_but_where_all_are_known),
        cmocka_unit_test(colours_are_weighed_as_rec_709_says),
        cmocka_unit_test(bounds_in_a_file_hold_for_its_floats),
        cmocka_unit_test(a_preview_fills_the_squares),
        cmocka_unit_test(every_parameter_can_be_set_by_its_key),
        cmocka_unit_test(keys_are_unique),
        cmocka_unit_test(bad_parameters_are_refused_in_one_line),
        cmocka_unit_test(bad_options_are_refused_in_one_line),
        cmocka_unit_test(a_scene_file_sets_what_truth_has),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

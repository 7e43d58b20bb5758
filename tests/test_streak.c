/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_streak.c: quads along the velocity against listing A.10 and the closed form of a ray that meets a plane. */
#include "passes/streak.h"
#include "tests/pass_util.h"

#include <float.h>

static const double pi = 3.14159265358979323846;

static const ssfr_field *draw(test_twin *t, const double c[3], double radius, const float v[3])
{
    const double centre[1][3] = {{c[0], c[1], c[2]}};
    const float velocity[1][3] = {{v[0], v[1], v[2]}};
    test_twin_place_moving(t, 1, centre, radius, NULL, velocity);
    return test_twin_run(t, "depth");
}

/* ---- the closed form --------------------------------------------------------------------------------------------- */

typedef enum form { SQUARE, MOTION, VIEW } form;
static const char *const forms[] = {"square", "motion", "view"};

static void set_form(test_twin *t, form f)
{
    test_twin_set(t, "orientation", "%s", f == SQUARE ? "screen" : "velocity");
    if (f != SQUARE) test_twin_set(t, "plane", "%s", forms[f]);
}

typedef struct axes {
    double x[3], y[3]; /* half axes, m */
} axes;

/* x and y of the listing; on a plane z = c_z, x is where the eye sees c + motion, less c, made as long. */
static axes axes_of(form f, const double c[3], double radius, double stretch, const float v[3])
{
    axes a = {{radius, 0, 0}, {0, -radius, 0}};
    double motion[3] = {(double)v[0], (double)v[1], (double)v[2]}, view[3] = {-c[0], -c[1], -c[2]};
    if (f == SQUARE) return a;
    ssfr_normalize(motion), ssfr_normalize(view);
    if (f == VIEW) {
        const double tip[3] = {c[0] + 1e-3 * motion[0], c[1] + 1e-3 * motion[1], c[2] + 1e-3 * motion[2]};
        for (int k = 0; k < 2; k++) motion[k] = tip[k] * c[2] / tip[2] - c[k];
        motion[2] = 0;
        ssfr_normalize(motion);
        memcpy(view, (const double[3]){0, 0, 1}, sizeof view);
    }
    ssfr_cross(motion, view, a.y);
    ssfr_normalize(a.y);
    for (int k = 0; k < 3; k++) a.x[k] = stretch * radius * motion[k], a.y[k] *= radius;
    return a;
}

static double determinant(const double a[3], const double b[3], const double c[3])
{
    double bc[3];
    ssfr_cross(b, c, bc);
    return ssfr_dot(a, bc);
}

typedef struct met {
    double a, b, t;
} met;

/* t d = c + a x + b y by Cramer's rule. */
static met meet(const axes *q, const double c[3], test_ray ray)
{
    const double d[3] = {ray.u, ray.v, -1}, below = determinant(d, q->x, q->y);
    return (met){.t = determinant(c, q->x, q->y) / below, .a = -determinant(d, c, q->y) / below,
                 .b = -determinant(d, q->x, c) / below};
}

static double length_of(const double v[3])
{
    return sqrt(ssfr_dot(v, v));
}

/* Rims are left out and are few. slack: of a, b and the depth over R, from places and directions that are floats. */
static void assert_quad(const test_twin *t, const ssfr_field *depth, const axes *q, const double c[3], double radius)
{
    const double near = t->scene.camera.near, slack = 40 * t->eps * (length_of(c) / radius + 10) + 4e-6;
    int n_rim = 0;
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++) {
            const met m = meet(q, c, test_ray_at(t, x, y, 1));
            const double r2 = m.a * m.a + m.b * m.b, z = *ssfr_field_at(depth, x, y);
            const bool rim = fabs(r2 - 1) < slack || fabs(m.t - near) < slack * radius;
            n_rim += rim;
            if (rim) continue;
            assert_int_equal(ssfr_is_surface(z), r2 < 1 && m.t >= near);
            if (!ssfr_is_surface(z)) continue;
            const double rise = radius * sqrt(1 - r2);
            assert_close(z, fmin(-m.t + rise, -near), 3 * slack * radius * (1 + radius / rise), 8 * t->eps);
        }
    assert_true(n_rim * 200 <= depth->w * depth->h);
}

static const double places[][3] = {{0, 0, -3}, {0.6, -0.45, -2.385}, {-0.9, 0.7, -2.1}, {0.013, 0.002, -1.31}};
static const float motions[][3] = {{3, 0, 0}, {0, -2.385f, 0}, {1.5f, 1, 0.75f}, {-0.4f, 0.9f, -0.5f}, {-2, -1, -3}};

static void quads_are_those_of_the_listing(void **state)
{
    test_twin *t = test_twin_create(state, "foam_depth", 81, 64);
    for (int f = 0; f < 3; f++) {
        set_form(t, (form)f);
        for (size_t i = 0; i < SSFR_COUNT(places) * SSFR_COUNT(motions); i++) {
            const double *c = places[i / SSFR_COUNT(motions)];
            const float *v = motions[i % SSFR_COUNT(motions)];
            const ssfr_field *depth = draw(t, c, 0.31, v);
            const axes q = axes_of((form)f, c, 0.31, 2, v);
            assert_true(test_count(depth) > 100);
            assert_quad(t, depth, &q, c, 0.31);
        }
    }
}

static void quads_know_cameras_that_turn_and_pixels_that_are_not_square(void **state)
{
    static const double eye[3] = {1.5, 2.25, -0.75}, target[3] = {-0.31, 0.2, 4};
    test_twin *t = test_twin_create(state, "foam_depth", 50, 64);
    t->scene.camera.tan_x = 0.8;
    test_twin_look(t, eye, target);
    for (int f = 0; f < 3; f++) {
        set_form(t, (form)f);
        for (size_t i = 0; i < SSFR_COUNT(places); i++) {
            const axes q = axes_of((form)f, places[i], 0.31, 2, motions[2]);
            assert_quad(t, draw(t, places[i], 0.31, motions[2]), &q, places[i], 0.31);
        }
    }
}

static void stretch_and_radius_scale_are_the_half_axes(void **state)
{
    test_twin *t = test_twin_create(state, "foam_depth", 81, 64);
    test_twin_set(t, "stretch", "3.5");
    test_twin_set(t, "radius_scale", "1.7");
    for (int f = 0; f < 3; f++) {
        set_form(t, (form)f);
        const axes q = axes_of((form)f, places[0], 0.34, 3.5, motions[2]);
        assert_quad(t, draw(t, places[0], 0.2, motions[2]), &q, places[0], 0.34);
    }
}

/* Of a particle that is not turned: splat=quad of sphere_depth, which is by depth. */
static void squares_on_the_screen_are_the_quads_of_spheres(void **state)
{
    test_twin *t = test_twin_create(state, "foam_depth", 81, 64);
    test_twin *sphere = test_twin_create(state, "sphere_depth", 81, 64);
    test_twin_set(sphere, "splat", "quad");
    set_form(t, SQUARE);
    for (size_t i = 0; i < SSFR_COUNT(places); i++) {
        const ssfr_field *depth = draw(t, places[i], 0.31, motions[2]);
        sphere->scene.particles = t->scene.particles;
        assert_true(test_difference(depth, test_twin_run(sphere, "depth")) < 2000 * t->eps);
        assert_true(test_count(depth) > 100);
    }
}

/* ---- what it looks like ------------------------------------------------------------------------------------------ */

typedef struct shape {
    double n;           /* pixels */
    double x, y;        /* px, of their middle; y upwards */
    double along, ratio; /* rad, of the longer axis; of the variances along it and across */
} shape;

static shape shape_of(const ssfr_field *depth)
{
    shape s = {0};
    double xx = 0, xy = 0, yy = 0;
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++) {
            const double a = x, b = depth->h - 1 - y;
            if (!ssfr_is_surface(*ssfr_field_at(depth, x, y))) continue;
            s.n++, s.x += a, s.y += b, xx += a * a, xy += a * b, yy += b * b;
        }
    s.x /= s.n, s.y /= s.n;
    xx = xx / s.n - s.x * s.x, xy = xy / s.n - s.x * s.y, yy = yy / s.n - s.y * s.y;
    const double root = hypot(0.5 * (xx - yy), xy);
    s.along = 0.5 * atan2(2 * xy, xx - yy);
    s.ratio = (0.5 * (xx + yy) + root) / (0.5 * (xx + yy) - root);
    return s;
}

/* An ellipse of half axes s R and R: its area is pi s R^2, the variances along and across it are as s^2 to 1. */
static void motion_across_the_view_stretches_the_disc_along_it(void **state)
{
    static const double stretches[] = {1, 2, 3};
    const double c[3] = {0.013, 0.008, -3}, radius = 0.4, px = 2 * 3 * 0.5 / 301; /* m, of a pixel at 3 m */
    test_twin *t = test_twin_create(state, "foam_depth", 301, 301);
    for (int f = MOTION; f <= VIEW; f++)
        for (int i = 0; i < 9; i++) {
            const double s = stretches[i / 3], angle = 0.3 + 0.9 * (i % 3);
            const float v[3] = {(float)cos(angle), (float)sin(angle), 0};
            set_form(t, (form)f);
            test_twin_set(t, "stretch", "%g", s);
            const shape seen = shape_of(draw(t, c, radius, v));
            assert_close(seen.n, pi * s * ssfr_square(radius / px), 0, 0.005);
            assert_close(seen.ratio, s * s, 0, 0.01);
            assert_close(seen.x, 150 + c[0] / px, 0.1, 0);
            assert_close(seen.y, 150 + c[1] / px, 0.1, 0);
            if (s > 1) assert_close(remainder(seen.along - angle, pi), 0, 0.01, 0);
        }
}

/* At an angle to the ray, the listing's quads look shorter by its sine: at the default threshold they have 0.31 of their
 * length, and are shorter than the square that is next. */
static void motion_towards_the_eye_foreshortens_quads_of_the_listing_alone(void **state)
{
    const double radius = 0.15, far[3] = {0.001, 0.002, -6}, px = 2 * 6 * 0.1 / 301;
    test_twin *t = test_twin_create(state, "foam_depth", 301, 301);
    t->scene.camera.tan_x = t->scene.camera.tan_y = 0.1;
    for (int i = 0; i < 4; i++) {
        const double cosine = (const double[]){0, 0.5, 0.8, 0.94}[i], sine = sqrt(1 - cosine * cosine);
        const float v[3] = {(float)sine, 0, (float)cosine};
        set_form(t, MOTION);
        assert_close(shape_of(draw(t, far, radius, v)).n, 2 * sine * pi * ssfr_square(radius / px), 0, 0.02);
        set_form(t, VIEW);
        assert_close(shape_of(draw(t, far, radius, v)).n, 2 * pi * ssfr_square(radius / px), 0, 0.005);
    }
}

/* ---- when it is turned ------------------------------------------------------------------------------------------- */

static bool is_turned(test_twin *t, const double c[3], const float v[3])
{
    set_form(t, SQUARE);
    const ssfr_field *square = draw(t, c, 0.3, v);
    set_form(t, MOTION);
    const ssfr_field *depth = draw(t, c, 0.3, v);
    const bool same = test_same_bits(depth, square);
    set_form(t, VIEW);
    assert_int_equal(test_same_bits(draw(t, c, 0.3, v), square), same);
    return !same;
}

static void slow_particles_are_not_turned(void **state)
{
    test_twin *t = test_twin_create(state, "foam_depth", 41, 33);
    assert_false(is_turned(t, places[1], (const float[3]){0, 0, 0}));
    assert_false(is_turned(t, places[1], (const float[3]){0.4999f, 0, 0}));
    assert_true(is_turned(t, places[1], (const float[3]){0.5f, 0, 0}));
    assert_false(is_turned(t, places[1], (const float[3]){-0.3f, 0.39f, 0})); /* 0.492 m/s */
    assert_true(is_turned(t, places[1], (const float[3]){-0.3f, 0.41f, 0}));  /* 0.508 m/s */
    test_twin_set(t, "motion_threshold", "2.385");
    assert_false(is_turned(t, places[1], (const float[3]){0, -2.384f, 0}));
    assert_true(is_turned(t, places[1], (const float[3]){0, -2.386f, 0}));
}

/* Both ways along the ray through the centre, which is not the axis. */
static void particles_that_move_along_the_ray_are_not_turned(void **state)
{
    test_twin *t = test_twin_create(state, "foam_depth", 41, 33);
    double view[3] = {-places[1][0], -places[1][1], -places[1][2]}, side[3];
    ssfr_normalize(view);
    ssfr_cross(view, (const double[3]){0, 1, 0}, side);
    ssfr_normalize(side);
    for (int i = 0; i < 8; i++) {
        const double limit = i & 1 ? 0.95 : 0.6, cosine = i & 2 ? limit - 1e-4 : limit + 1e-4;
        const double sine = sqrt(1 - cosine * cosine);
        float v[3];
        for (int k = 0; k < 3; k++) v[k] = (float)(2 * ((i & 4 ? -cosine : cosine) * view[k] + sine * side[k]));
        test_twin_set(t, "facing", "%g", limit);
        assert_int_equal(is_turned(t, places[1], v), cosine < limit);
    }
    test_twin_set(t, "facing", "0"); /* as far as it, not only less */
    assert_true(is_turned(t, places[0], (const float[3]){2, 0, 0}));
    assert_false(is_turned(t, places[0], (const float[3]){2, 0, 1e-3f}));
}

static void particles_without_velocity_are_not_turned(void **state)
{
    static const double c[1][3] = {{0.6, -0.45, -2.385}};
    test_twin *t = test_twin_create(state, "foam_depth", 41, 33);
    set_form(t, SQUARE);
    test_twin_place_moving(t, 1, c, 0.3, NULL, NULL);
    const ssfr_field *square = test_twin_run(t, "depth");
    set_form(t, MOTION);
    assert_true(test_same_bits(test_twin_run(t, "depth"), square));
    test_twin_set(t, "motion_threshold", "0");
    assert_true(test_same_bits(test_twin_run(t, "depth"), square));
    assert_true(test_count(square) > 50);
}

/* ---- extremes ---------------------------------------------------------------------------------------------------- */

static void assert_bounded(const test_twin *t, const ssfr_field *depth)
{
    for (int i = 0; i < depth->w * depth->h; i++) {
        assert_true(isfinite(depth->data[i]));
        if (ssfr_is_surface(depth->data[i])) assert_true(depth->data[i] <= -t->scene.camera.near * (1 - t->eps));
    }
}

static void velocities_that_are_no_numbers_turn_nothing(void **state)
{
    static const float none[][3] = {{NAN, 1, 1}, {1, NAN, 1},      {1, 1, NAN},       {NAN, NAN, NAN}, {INFINITY, 0, 0},
                                    {0, 1, -INFINITY}, {NAN, INFINITY, 1}, {1e-40f, 0, 0}, {0, 1e-45f, 0}};
    test_twin *t = test_twin_create(state, "foam_depth", 41, 33);
    test_twin_set(t, "motion_threshold", "0");
    for (size_t i = 0; i < SSFR_COUNT(none); i++) assert_false(is_turned(t, places[0], none[i]));
}

/* Only the direction counts, up to the largest floats and down to where a threshold of 0 begins. */
static void enormous_and_tiny_velocities_are_directions_like_others(void **state)
{
    static const float factors[] = {1e30f, 1.1e38f, 1e-15f, 1e-29f};
    test_twin *t = test_twin_create(state, "foam_depth", 41, 33);
    test_twin_set(t, "motion_threshold", "0");
    for (int f = MOTION; f <= VIEW; f++) {
        set_form(t, (form)f);
        const ssfr_field *usual = draw(t, places[1], 0.3, motions[2]);
        for (size_t i = 0; i < SSFR_COUNT(factors); i++) {
            const float v[3] = {factors[i] * motions[2][0], factors[i] * motions[2][1], factors[i] * motions[2][2]};
            const ssfr_field *depth = draw(t, places[1], 0.3, v);
            const axes q = axes_of((form)f, places[1], 0.3, 2, motions[2]);
            assert_quad(t, depth, &q, places[1], 0.3);
            assert_int_equal(test_count(depth), test_count(usual));
        }
    }
}

/* What of the quad's plane is nearer than the near plane is not there, what rises over it is cut. */
static void quads_that_cross_the_near_plane_are_cut_by_it(void **state)
{
    static const double c[][3] = {{0, 0, -0.91}, {0.2, 0.1, -0.8}, {-0.15, -0.25, -0.76}};
    static const float v[][3] = {{0.5f, 0, 1.2f}, {1, 0.2f, -1}, {0.1f, 1, 0.9f}};
    test_twin *t = test_twin_create(state, "foam_depth", 61, 48);
    t->scene.camera.near = 0.75;
    for (int f = MOTION; f <= VIEW; f++)
        for (size_t i = 0; i < 9; i++) {
            set_form(t, (form)f);
            const ssfr_field *depth = draw(t, c[i / 3], 0.31, v[i % 3]);
            const axes q = axes_of((form)f, c[i / 3], 0.31, 2, v[i % 3]);
            assert_true(test_count(depth) > 100);
            assert_bounded(t, depth);
            assert_quad(t, depth, &q, c[i / 3], 0.31);
        }
}

/* A metre long, through the eye's plane. */
static void quads_around_the_eye_stay_bounded(void **state)
{
    static const float v[][3] = {{1, 0, 1}, {-0.3f, 1, 2}, {1, -1, 0.01f}, {0.02f, 0, -1}};
    test_twin *t = test_twin_create(state, "foam_depth", 41, 33);
    test_twin_set(t, "facing", "0.9999");
    for (int f = SQUARE; f <= VIEW; f++)
        for (size_t i = 0; i < SSFR_COUNT(v); i++) {
            set_form(t, (form)f);
            const ssfr_field *depth = draw(t, (const double[3]){0.003, 0.002, -0.0101}, 0.5, v[i]);
            assert_bounded(t, depth);
            assert_true(test_count(depth) > 0);
            assert_int_equal(test_count(draw(t, (const double[3]){0.003, 0.002, -0.0099}, 0.5, v[i])), 0);
            assert_int_equal(test_count(draw(t, (const double[3]){0, 0, 0}, 0.5, v[i])), 0);
        }
}

/* By the ray through its centre the motion leans by no more than facing; by those at its ends it may be along them. */
static void quads_seen_edge_on_are_thin_and_finite(void **state)
{
    test_twin *t = test_twin_create(state, "foam_depth", 61, 48);
    test_twin_set(t, "facing", "0.9999");
    set_form(t, MOTION);
    for (int i = 0; i < 20; i++) {
        const double sine = 0.0142 * (1 + i), c[3] = {0, 0, -1};
        const float v[3] = {(float)sine, 0, (float)sqrt(1 - sine * sine)};
        const ssfr_field *depth = draw(t, c, 0.3, v);
        const axes q = axes_of(MOTION, c, 0.3, 2, v);
        assert_bounded(t, depth);
        assert_quad(t, depth, &q, c, 0.3);
    }
    assert_true(is_turned(t, places[0], (const float[3]){0.0142f, 0, 1}));
    assert_false(is_turned(t, places[0], (const float[3]){0.0141f, 0, 1}));
}

static void the_longest_quads_reach_across_the_image(void **state)
{
    test_twin *t = test_twin_create(state, "foam_depth", 61, 48);
    test_twin_set(t, "stretch", "100");
    for (int f = MOTION; f <= VIEW; f++) {
        static const double c[3] = {30, 0.1, -30};
        static const float v[3] = {1, 0, 0.05f};
        ssfr_node_status status;
        set_form(t, (form)f);
        const ssfr_field *whole = draw(t, c, 2.4, v);
        const axes q = axes_of((form)f, c, 2.4, 100, v);
        assert_quad(t, whole, &q, c, 2.4);
        assert_true(test_count(whole) > 300);
        assert_true(test_same_bits(test_twin_run_if_needed(t, "depth", &status), whole));
        assert_int_equal(status, SSFR_RAN);
    }
}

static void tiny_quads_draw_one_pixel_or_none(void **state)
{
    test_twin *t = test_twin_create(state, "foam_depth", 64, 64);
    const double pixel = 2.0 / 64, middle = 10.5 * pixel;
    const double on[3] = {middle, -middle, -2}, off[3] = {middle + 0.4 * pixel, -middle, -2};
    for (int f = SQUARE; f <= VIEW; f++) {
        set_form(t, (form)f);
        const ssfr_field *depth = draw(t, on, 0.005 * pixel, motions[2]);
        assert_int_equal(test_count(depth), 1);
        assert_close(*ssfr_field_at(depth, 42, 42), -2, 0.02 * pixel, 2 * t->eps);
        assert_int_equal(test_count(draw(t, off, 0.005 * pixel, motions[2])), 0);
    }
}

/* ---- the fragments, which only the CPU tells --------------------------------------------------------------------- */

enum { W = 200, H = 150 };

static struct {
    ssfr_field *field; /* a, b, r2, front, back, chord, area */
    double sum, chords;
    size_t n_others; /* fragments of other particles than the one there is */
} seen;

static void look(const ssfr_run *run, const ssfr_fragment *f, double *pixel)
{
    double *at = ssfr_field_at(seen.field, f->x, f->y);
    const double values[] = {f->a, f->b, f->r2, f->front, f->back, f->chord, f->area};
    (void)run, (void)pixel;
    memcpy(at, values, sizeof values);
#pragma omp critical
    seen.sum += f->chord / f->area, seen.chords += f->chord, seen.n_others += f->particle != 0;
}

static test_twin *see(void **state, form f, const double c[3], double radius, const float v[3])
{
    test_twin *t = test_twin_create(state, "foam_depth", W, H);
    set_form(t, f);
    t->scene.camera.tan_x = t->scene.camera.tan_y * W / H;
    draw(t, c, radius, v);
    seen.field = test_field(W, H, 7);
    seen.sum = seen.chords = 0, seen.n_others = 0;
    ssfr_field_fill(seen.field, NAN);
    ssfr_streak_cpu(ssfr_graph_last_run(t->graph, 0), look);
    assert_int_equal(seen.n_others, 0);
    return t;
}

/* The front and the back of a fragment are the chord apart, the place is that of the closed form, and what is ahead of
 * the particle has a > 0. */
static void fragments_tell_where_on_the_quad_they_are(void **state)
{
    for (int f = SQUARE; f <= VIEW; f++)
        for (size_t i = 0; i < SSFR_COUNT(motions); i++) {
            const double *c = places[1];
            const test_twin *t = see(state, (form)f, c, 0.2, motions[i]);
            const axes q = axes_of((form)f, c, 0.2, 2, motions[i]);
            int n = 0;
            for (int k = 0; k < W * H; k++) {
                const double *s = seen.field->data + 7 * k;
                const met m = meet(&q, c, test_ray_at(t, k % W, k / W, 1));
                if (isnan(s[0])) continue;
                n++;
                assert_close(s[0], m.a, 1e-6, 0);
                assert_close(s[1], m.b, 1e-6, 0);
                assert_close(s[2], s[0] * s[0] + s[1] * s[1], 1e-12, 0);
                assert_close(s[3] - s[4], s[5], 1e-12, 0);
                assert_close(s[5], 0.4 * sqrt(1 - s[2]), 1e-12, 0);
                assert_close(0.5 * (s[3] + s[4]), -m.t, 1e-6, 0);
            }
            assert_true(n > 300);
        }
}

/* The motion's line through the centre looks the same in both planes: it is b = 0. */
static void both_planes_lie_along_the_motion_as_it_is_seen(void **state)
{
    for (int f = MOTION; f <= VIEW; f++)
        for (size_t i = 0; i < SSFR_COUNT(motions); i++) {
            const double *c = places[2], v[3] = {(double)motions[i][0], (double)motions[i][1], (double)motions[i][2]};
            const test_twin *t = see(state, (form)f, c, 0.2, motions[i]);
            double side[3];
            ssfr_cross(c, v, side);
            ssfr_normalize(side);
            for (int k = 0; k < W * H; k++) {
                const test_ray ray = test_ray_at(t, k % W, k / W, 1);
                const double d[3] = {ray.u, ray.v, -1}, beside = ssfr_dot(d, side), b = seen.field->data[7 * k + 1];
                if (!isnan(b) && fabs(beside) > 1e-6) assert_int_equal(b > 0, beside > 0);
            }
        }
}

/* A disc's chords add up to the volume of its sphere, 4/3 pi R^3, those of a quad to `area` times that: B24, for the
 * motions across the view twice as much foam. */
static void chords_over_the_area_add_up_to_the_volume_of_the_sphere(void **state)
{
    const double pixel = 2 * 0.5 / H;
    for (size_t p = 0; p < SSFR_COUNT(places); p++)
        for (size_t i = 0; i < SSFR_COUNT(motions); i++)
            for (int f = SQUARE; f <= VIEW; f++) {
                const double *c = places[p], radius = f == MOTION ? 0.1 : 0.15;
                const double volume = 4 * pi / 3 * radius * radius * radius, at = ssfr_square(pixel * c[2]); /* m^2 */
                see(state, (form)f, c, radius, motions[i]);
                assert_close(seen.sum * at, volume, 0, f == MOTION ? 0.04 : 0.01); /* near ends look larger */
                if (f == SQUARE) assert_close(seen.chords, seen.sum, 0, 1e-12);
                if (f == VIEW) assert_close(seen.chords, 2 * seen.sum, 0, 1e-12);
            }
    see(state, MOTION, places[0], 0.1, motions[0]);
    assert_close(seen.chords, 2 * seen.sum, 0, 1e-6);
}

static void reach_holds_all_that_is_drawn(void **state)
{
    const ssfr_pass *pass = ssfr_pass_find("foam_depth");
    ssfr_streak_params p = {.stretch = 2, .radius_scale = 1.5};
    assert_close(pass->reach(&p), 1.5 * sqrt(5), 0, 1e-15);
    p.orientation = SSFR_STREAK_SCREEN;
    assert_close(pass->reach(&p), 1.5, 0, 1e-15);
    for (size_t i = 0; i < SSFR_COUNT(motions); i++) {
        const test_twin *t = see(state, MOTION, places[1], 0.2, motions[i]);
        for (int k = 0; k < W * H; k++) {
            const test_ray ray = test_ray_at(t, k % W, k / W, 1);
            const double *s = seen.field->data + 7 * k, z = 0.5 * (s[3] + s[4]);
            if (isnan(z)) continue;
            for (int end = 3; end < 5; end++) {
                const double away[3] = {-ray.u * z - places[1][0], -ray.v * z - places[1][1], s[end] - places[1][2]};
                assert_true(sqrt(ssfr_dot(away, away)) <= 0.2 * sqrt(5) + 1e-6);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(quads_are_those_of_the_listing),
        TEST_TWINS(quads_know_cameras_that_turn_and_pixels_that_are_not_square),
        TEST_TWINS(stretch_and_radius_scale_are_the_half_axes),
        TEST_TWINS(squares_on_the_screen_are_the_quads_of_spheres),
        TEST_TWINS(motion_across_the_view_stretches_the_disc_along_it),
        TEST_TWINS(motion_towards_the_eye_foreshortens_quads_of_the_listing_alone),
        TEST_TWINS(slow_particles_are_not_turned),
        TEST_TWINS(particles_that_move_along_the_ray_are_not_turned),
        TEST_TWINS(particles_without_velocity_are_not_turned),
        TEST_TWINS(velocities_that_are_no_numbers_turn_nothing),
        TEST_TWINS(enormous_and_tiny_velocities_are_directions_like_others),
        TEST_TWINS(quads_that_cross_the_near_plane_are_cut_by_it),
        TEST_TWINS(quads_around_the_eye_stay_bounded),
        TEST_TWINS(quads_seen_edge_on_are_thin_and_finite),
        TEST_TWINS(the_longest_quads_reach_across_the_image),
        TEST_TWINS(tiny_quads_draw_one_pixel_or_none),
        TEST_CPU(fragments_tell_where_on_the_quad_they_are),
        TEST_CPU(both_planes_lie_along_the_motion_as_it_is_seen),
        TEST_CPU(chords_over_the_area_add_up_to_the_volume_of_the_sphere),
        TEST_CPU(reach_holds_all_that_is_drawn),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

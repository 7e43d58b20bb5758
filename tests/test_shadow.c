/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_shadow.c: the shadows of balls on sheets of fluid against their ellipses, the series against its closed form,
 * where the fluid is taken to be, and what is left out. */
#include "tests/frames.h"
#include "tests/pass_util.h"

#include "graph/twins.h"
#include "passes/shadow_basis.h"

static const ssfr_pipeline shadows = {
    .name = "shadows", .result = SSFR_SLOT_light, .nodes = {{"shadow_map"}, {"shadow_basis"}, {"shadow"}}};

enum { W = 60, H = 48, MAP = 128 };

static const char *const kinds[] = {"map", "convolution", "ray"};

/* From all around, along the view, straight down and up, and level. */
static const test_light lights[] = {{125, 40}, {90, 0}, {37, 25}, {60, -35}, {0, 90}, {0, -90}, {140, 0}, {90, 89.99}};

/* ---- a ball over a sheet ----------------------------------------------------------------------------------------- */

typedef struct sheet { /* z = z0 + sx x + sy y (m, eye space) */
    double z0, sx, sy;
} sheet;

static const double ball_radius = 0.4;
static ssfr_solid ball; /* of the test that runs */

static ssfr_field *draw(const test_twin *t, const sheet *s, int divisor)
{
    ssfr_field *depth = test_field(W / divisor, H / divisor, 1);
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++)
            *ssfr_field_at(depth, x, y) = test_plane(s->z0, s->sx, s->sy, test_ray_at(t, x, y, divisor));
    return depth;
}

static test_twin *begin(void **state)
{
    test_twin *t = test_twin_create_for(state, &shadows, W, H);
    test_twin_set(t, "shadow.bias", "0"); /* no particle tells a radius */
    test_twin_set(t, "shadow.average", "none");
    test_twin_set(t, "shadow_map.size", "%d", MAP);
    return t;
}

static void place_ball(test_twin *t, const double centre[3])
{
    ball = (ssfr_solid){.shape = SSFR_SPHERE, .half = {ball_radius}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    memcpy(ball.centre, centre, sizeof ball.centre);
    t->scene.solids = &ball;
    t->scene.n_solids = 1;
}

/* A sheet that faces the light as much as the eye, and a ball that far from the place that is seen in the middle. */
static ssfr_field *begin_ball(test_twin *t, const test_light *l, double away, sheet *s)
{
    double to[3], n[3], centre[3];
    test_light_towards(l, to);
    for (int k = 0; k < 3; k++) n[k] = to[k] + (k == 2);
    *s = (sheet){-2.385, -n[0] / n[2], -n[1] / n[2]};
    for (int k = 0; k < 3; k++) centre[k] = away * to[k] + (k == 2 ? s->z0 : 0);
    place_ball(t, centre);
    test_twin_light(t, l);
    ssfr_field *depth = draw(t, s, 1);
    test_twin_give(t, "surface_depth", depth);
    return depth;
}

/* How far the pixel's place is inside the ball's shadow, m, across the light; negative outside. */
static double inside(const test_twin *t, const ssfr_field *depth, const test_light *l, int x, int y)
{
    const test_ray ray = test_ray_at(t, x, y, W / depth->w);
    const double z = *ssfr_field_at(depth, x, y), p[3] = {-ray.u * z, -ray.v * z, z};
    double to[3], d[3];
    test_light_towards(l, to);
    for (int k = 0; k < 3; k++) d[k] = ball.centre[k] - p[k];
    const double along = ssfr_dot(d, to);
    return ball_radius - sqrt(fmax(ssfr_dot(d, d) - along * along, 0));
}

/* A texel of the map, m: no larger than if its square held both the ball and the margins, rounded up. */
static double texel(void)
{
    return 2 * ball_radius * 64 / 61 * 1.19 / MAP;
}

/* How near to its edge a shadow of a kind may be wrong, m, beside rounding: by half the diagonal of a texel, or by that
 * of a box of five with one more that lies between two. */
static double edge(const test_twin *t, int kind)
{
    const double rim[] = {0.75 * texel(), 5 * texel(), 0};
    return rim[kind] + (t->gl ? 1e-5 : 1e-9);
}

static void the_shadow_of_a_ball_is_its_ellipse(void **state)
{
    for (size_t i = 0; i < SSFR_COUNT(lights); i++)
        for (int kind = 0; kind < 3; kind++) {
            test_twin *t = begin(state);
            sheet s;
            const ssfr_field *depth = begin_ball(t, &lights[i], 0.785, &s);
            int n = 0;
            test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
            const ssfr_field *light = test_twin_run(t, "light");
            for (int y = 0; y < H; y++)
                for (int x = 0; x < W; x++) {
                    const double in = inside(t, depth, &lights[i], x, y), v = *ssfr_field_at(light, x, y);
                    assert_true(v >= 0 && v <= 1);
                    if (fabs(in) < edge(t, kind)) continue;
                    n += in > 0;
                    /* Beside a caster nothing is taken; below it, twice what the series swings by, 0.09 (Gibbs). */
                    assert_close(v, in < 0, kind == 1 ? in > 0 ? 0.18 : 1e-6 : 0, 0);
                }
            assert_true(n > 100);
        }
}

/* The edge itself: a convolution's penumbra is as dark as it is light. */
static void a_soft_shadow_is_as_large_as_a_sharp_one(void **state)
{
    double sums[3];
    for (int kind = 0; kind < 3; kind++) {
        test_twin *t = begin(state);
        sheet s;
        begin_ball(t, &lights[0], 0.785, &s);
        test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
        test_twin_set(t, "shadow_basis.terms", "16");
        const ssfr_field *light = test_twin_run(t, "light");
        sums[kind] = 0;
        for (int i = 0; i < W * H; i++) sums[kind] += 1 - light->data[i];
    }
    assert_close(sums[0], sums[2], 0, 0.02);
    assert_close(sums[1], sums[2], 0, 0.03);
}

static void behind_the_fluid_a_ball_casts_no_shadow(void **state)
{
    for (int kind = 0; kind < 3; kind++) {
        test_twin *t = begin(state);
        sheet s;
        begin_ball(t, &lights[0], -0.5, &s);
        test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
        const ssfr_field *light = test_twin_run(t, "light");
        /* The fluid may be anywhere between its nearest and farthest point, so the ball is looked at. */
        for (int i = 0; i < W * H; i++) assert_close(light->data[i], 1, 1e-6, 0);
    }
}

static void a_million_metres_away_shadows_are_the_same(void **state)
{
    static const double eye[3] = {1e6, 1e6, -1e6}, target[3] = {1e6, 1e6, -1e6 - 1};
    for (int kind = 0; kind < 3; kind++) {
        test_twin *t = begin(state);
        sheet s;
        int n = 0;
        const ssfr_field *depth = begin_ball(t, &lights[0], 0.785, &s);
        test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
        test_twin_look(t, eye, target);
        const double centre[3] = {ball.centre[0], ball.centre[1], ball.centre[2]};
        for (int k = 0; k < 3; k++) ball.centre[k] += eye[k];
        const ssfr_field *light = test_twin_run(t, "light");
        memcpy(ball.centre, centre, sizeof centre);
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++) {
                const double in = inside(t, depth, &lights[0], x, y);
                if (fabs(in) < edge(t, kind) + 1e-6) continue;
                assert_close(*ssfr_field_at(light, x, y), in < 0, kind == 1 ? 0.18 : 0, 0);
                n += in > 0;
            }
        assert_true(n > 100);
    }
}

static void at_half_resolution_shadows_are_where_they_were(void **state)
{
    for (int kind = 0; kind < 3; kind++) {
        test_twin *t = begin(state);
        sheet s;
        int n = 0;
        begin_ball(t, &lights[0], 0.785, &s);
        const ssfr_field *depth = draw(t, &s, 2);
        test_twin_give(t, "surface_depth", depth);
        test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
        const ssfr_field *light = test_twin_run(t, "light");
        assert_true(light->w == W / 2 && light->h == H / 2);
        for (int i = 0; i < light->w * light->h; i++) {
            const double in = inside(t, depth, &lights[0], i % light->w, i / light->w);
            if (fabs(in) < edge(t, kind)) continue;
            assert_close(light->data[i], in < 0, kind == 1 ? 0.18 : 0, 0);
            n += in > 0;
        }
        assert_true(n > 25);
    }
}

static void what_stands_above_by_less_than_the_bias_casts_no_shadow(void **state)
{
    const double at[1][3] = {{0, 0, -2.385}};
    for (int kind = 0; kind < 3; kind += 2)
        for (int shaded = 0; shaded < 2; shaded++) {
            test_twin *t = begin(state);
            sheet s;
            int n = 0;
            begin_ball(t, &lights[1], 0, &s); /* half of the ball stands out of the sheet */
            test_twin_place(t, 1, at, 0.1, NULL);
            test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
            test_twin_set(t, "shadow.bias", "%g", (shaded ? 0.9 : 1.1) * ball_radius / 0.1);
            const ssfr_field *light = test_twin_run(t, "light");
            for (int i = 0; i < W * H; i++) n += light->data[i] == 0;
            assert_int_equal(n > 0, shaded);
        }
}

/* ---- the series -------------------------------------------------------------------------------------------------- */

/* Casters at a depth of 0.385 of the light's square, which looks along the view, over fluid that falls away. */
static ssfr_field *step(void **state, int terms, double scale, bool covered)
{
    test_twin *t = begin(state);
    ssfr_field *depth = test_field(W, H, 1);
    for (int i = 0; i < W * H; i++) depth->data[i] = -(i + 0.5) / (W * H);
    test_twin_light(t, &lights[1]);
    test_twin_set(t, "shadow_basis.terms", "%d", terms);
    test_twin_set(t, "shadow.scale", "%.17g", scale);
    test_twin_give(t, "surface_depth", depth);
    test_twin_give(t, "light_depth", test_field_filled(7, 7, 1, covered ? -0.385 : -SSFR_EMPTY));
    return test_twin_run(t, "light");
}

/* By the sum of the first M cosines at odd multiples, sin(2 M pi t) / (2 sin(pi t)), and Simpson's rule. */
static double integrated(int terms, double x)
{
    enum { N = 400 };
    const double pi = acos(-1);
    double sum = 0;
    for (int i = 0; i <= N; i++) {
        const double t = x * i / N, f = i == 0 || t == 0 ? 2 * terms : sin(2 * terms * pi * t) / sin(pi * t);
        sum += f * (i == 0 || i == N ? 1 : i % 2 ? 4 : 2);
    }
    return 0.5 + sum * x / N / 3;
}

static void light_below_a_caster_is_the_series(void **state)
{
    const double eps = strcmp(*state, "gpu") == 0 ? 2e-4 : 1e-6;
    static const int terms[] = {1, 2, 4, 8, 16};
    for (size_t k = 0; k < SSFR_COUNT(terms); k++)
        for (int twice = 0; twice < 2; twice++) {
            const ssfr_field *light = step(state, terms[k], twice ? 2 : 0.5, true);
            const double span = ssfr_shadow_span(ssfr_shadow_images(terms[k]));
            for (int i = 0; i < W * H; i += 7) {
                const double s = integrated(terms[k], (0.385 - (i + 0.5) / (W * H)) * span);
                assert_close(light->data[i], ssfr_clamp((twice ? 2 : 0.5) * s, 0, 1), eps, 0);
            }
        }
}

/* It lifts the fluid, here by 0.1 m of the metre that the series has for its depths. */
static void the_bias_moves_the_step_of_the_series(void **state)
{
    static const double at[1][3] = {{0, 0, -1}};
    const double span = ssfr_shadow_span(ssfr_shadow_images(4));
    test_twin *t = begin(state);
    ssfr_field *depth = test_field(W, H, 1);
    for (int i = 0; i < W * H; i++) depth->data[i] = -(i + 0.5) / (W * H);
    test_twin_light(t, &lights[1]);
    test_twin_place(t, 1, at, 0.1, NULL);
    test_twin_set(t, "shadow.bias", "1");
    test_twin_set(t, "shadow.scale", "0.5");
    test_twin_give(t, "surface_depth", depth);
    test_twin_give(t, "light_depth", test_field_filled(7, 7, 1, -0.385));
    const ssfr_field *light = test_twin_run(t, "light");
    for (int i = 0; i < W * H; i += 7) {
        const double d = fmax((i + 0.5) / (W * H) - 0.1, 0), s = integrated(4, (0.385 - d) * span);
        assert_close(light->data[i], ssfr_clamp(0.5 * s, 0, 1), t->gl ? 2e-4 : 1e-6, 0);
    }
}

/* As 1/M, for the step of the wave is that of one over its highest frequency. */
static void more_terms_make_a_sharper_step(void **state)
{
    double before = INFINITY;
    for (int terms = 1; terms <= 16; terms *= 2) {
        const ssfr_field *light = step(state, terms, 1, true);
        int n = 0;
        for (int i = 0; i < W * H; i++) n += light->data[i] > 0.25 && light->data[i] < 0.75;
        assert_true(n < before);
        if (terms > 2) assert_true(fabs(n / before - 0.5) < 0.1);
        before = n;
    }
}

static void where_no_caster_is_all_light_arrives_to_the_bit(void **state)
{
    for (int terms = 1; terms <= 16; terms *= 4) {
        const ssfr_field *light = step(state, terms, 0.5, false);
        for (int i = 0; i < W * H; i++) assert_true(light->data[i] == 1);
    }
}

/* Images stand one below the other: at the border of the light's square (4 m, without casters) none reads the next. */
static void the_series_is_the_same_to_the_border_of_its_square(void **state)
{
    const double expected = ssfr_clamp(0.5 * integrated(4, -0.615 * ssfr_shadow_span(3)), 0, 1);
    test_twin *t = begin(state);
    int n_beyond = 0;
    test_twin_light(t, &lights[1]);
    test_twin_set(t, "shadow.scale", "0.5");
    test_twin_give(t, "surface_depth", test_field_filled(W, H, 1, -4.3)); /* beyond the range: at its end */
    test_twin_give(t, "light_depth", test_field_filled(7, 7, 1, -0.385));
    const ssfr_field *light = test_twin_run(t, "light");
    for (int i = 0; i < W * H; i++) {
        const test_ray ray = test_ray_at(t, i % W, i / W, 1);
        const bool beyond = 4.3 * fmax(fabs(ray.u), fabs(ray.v)) > 2;
        assert_close(light->data[i], beyond ? 1 : expected, t->gl ? 2e-4 : 1e-6, 0);
        n_beyond += beyond;
    }
    assert_true(n_beyond > W && n_beyond < W * H / 2);
}

/* ---- where the fluid is ------------------------------------------------------------------------------------------ */

/* Casters everywhere 1 m before the eye, and the light along the view: fluid before them is lit. */
static test_twin *begin_cover(void **state)
{
    test_twin *t = begin(state);
    test_twin_light(t, &lights[1]);
    test_twin_set(t, "shadow.kind", "map");
    test_twin_give(t, "light_depth", test_field_filled(1, 1, 1, -1));
    return t;
}

static void fluid_at_the_very_depth_of_the_caster_is_lit(void **state)
{
    static const double depths[] = {-0.999, -1, -1.001};
    for (size_t i = 0; i < SSFR_COUNT(depths); i++) {
        test_twin *t = begin_cover(state);
        test_twin_give(t, "surface_depth", test_field_filled(W, H, 1, depths[i]));
        const ssfr_field *light = test_twin_run(t, "light");
        for (int k = 0; k < W * H; k++) assert_true(light->data[k] == (i < 2));
    }
}

static void the_depth_is_the_mean_of_those_around_it(void **state)
{
    for (int average = 0; average < 2; average++) {
        test_twin *t = begin_cover(state);
        ssfr_field *depth = test_field_filled(W, H, 1, -SSFR_EMPTY);
        *ssfr_field_at(depth, 20, 20) = -0.9;
        *ssfr_field_at(depth, 21, 20) = -1.3;
        test_twin_set(t, "shadow.average", average ? "3x3" : "none");
        test_twin_give(t, "surface_depth", depth);
        const ssfr_field *light = test_twin_run(t, "light");
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++) {
                const bool row = abs(y - 20) <= 1;
                const bool mean = row && x >= 20 && x <= 22, alone = x == 21 && y == 20; /* at 19 there is 0.9 alone */
                assert_true(*ssfr_field_at(light, x, y) == (average ? !mean : !alone));
            }
    }
}

static void the_depth_of_foam_is_a_mean_too(void **state)
{
    for (int average = 0; average < 2; average++) {
        test_twin *t = begin_cover(state);
        ssfr_field *foam = test_field_filled(W, H, 1, -SSFR_EMPTY);
        *ssfr_field_at(foam, 20, 20) = -1.3;
        test_twin_set(t, "shadow.average", average ? "3x3" : "none");
        test_twin_give(t, "foam_depth", foam);
        const ssfr_field *light = test_twin_run(t, "light");
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++) {
                const int away = ssfr_max_int(abs(x - 20), abs(y - 20));
                assert_true(*ssfr_field_at(light, x, y) == (away > average));
            }
    }
}

/* Water stands on the left, before the foam or behind it; the foam alone is in shadow, or it alone is not. */
static void foam_says_where_the_fluid_is_without_water_or_before_it(void **state)
{
    static const char *const foams[] = {"off", "without_water", "front"};
    for (int foam = 0; foam < 3; foam++)
        for (int before = 0; before < 2; before++) {
            test_twin *t = begin_cover(state);
            const double water_z = before ? -1.5 : -0.5, foam_z = before ? -0.5 : -1.5;
            ssfr_field *depth = test_field_filled(W, H, 1, -SSFR_EMPTY), *front = test_field_filled(W, H, 1, foam_z);
            for (int y = 0; y < H; y++)
                for (int x = 0; x < W / 2; x++) *ssfr_field_at(depth, x, y) = water_z;
            test_twin_set(t, "shadow.foam", foams[foam]);
            test_twin_give(t, "surface_depth", depth);
            test_twin_give(t, "foam_depth", front);
            const ssfr_field *light = test_twin_run(t, "light");
            const bool lit_water = !before || foam == 2, lit_foam = before || foam == 0;
            for (int y = 0; y < H; y++)
                for (int x = 0; x < W; x++)
                    assert_true(*ssfr_field_at(light, x, y) == (x < W / 2 ? lit_water : lit_foam));
        }
}

/* What a particle that has nearly turned to foam leaves of its water, deep in shadow, is one pixel. */
static void a_pixel_of_water_behind_foam_cuts_no_hole_into_its_light(void **state)
{
    for (int listing = 0; listing < 2; listing++) {
        test_twin *t = begin_cover(state);
        ssfr_field *depth = test_field_filled(W, H, 1, -SSFR_EMPTY);
        *ssfr_field_at(depth, 20, 20) = -1.5;
        test_twin_set(t, "shadow.average", "3x3");
        if (listing) test_twin_set(t, "shadow.foam", "without_water");
        test_twin_give(t, "surface_depth", depth);
        test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -0.5));
        const ssfr_field *light = test_twin_run(t, "light");
        int n_dark = 0;
        for (int i = 0; i < W * H; i++) n_dark += light->data[i] == 0;
        assert_int_equal(n_dark, listing ? 9 : 0);
    }
}

/* Erratum B35. */
static void without_water_and_foam_all_light_arrives(void **state)
{
    static const double nothing[] = {-SSFR_EMPTY, SSFR_EMPTY, NAN, INFINITY};
    for (size_t i = 0; i < SSFR_COUNT(nothing); i++)
        for (int average = 0; average < 2; average++) {
            test_twin *t = begin_cover(state);
            test_twin_set(t, "shadow.average", average ? "3x3" : "none");
            test_twin_give(t, "surface_depth", test_field_filled(W, H, 1, nothing[i]));
            const ssfr_field *light = test_twin_run(t, "light");
            for (int k = 0; k < W * H; k++) assert_true(light->data[k] == 1);
        }
}

static void depths_that_are_no_numbers_do_not_count(void **state)
{
    test_twin *t = begin_cover(state);
    ssfr_field *depth = test_field_filled(W, H, 1, -1.5);
    for (int i = 0; i < W * H; i += 2) depth->data[i] = i % 3 ? NAN : INFINITY;
    test_twin_set(t, "shadow.average", "3x3");
    test_twin_give(t, "surface_depth", depth);
    const ssfr_field *light = test_twin_run(t, "light");
    for (int k = 0; k < W * H; k++) assert_true(light->data[k] == 0);
}

static void however_far_the_fluid_is_its_light_is_a_share(void **state)
{
    for (int kind = 0; kind < 3; kind++) {
        test_twin *t = begin(state);
        sheet s;
        begin_ball(t, &lights[0], 0.785, &s);
        test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
        ssfr_field *depth = test_field_filled(W, H, 1, -1e15);
        *ssfr_field_at(depth, 0, 0) = -1;
        test_twin_give(t, "surface_depth", depth);
        const ssfr_field *light = test_twin_run(t, "light");
        for (int k = 0; k < W * H; k++) assert_true(light->data[k] >= 0 && light->data[k] <= 1);
    }
}

/* ---- what is left out -------------------------------------------------------------------------------------------- */

static void only_the_maps_of_a_kind_are_made(void **state)
{
    static const ssfr_node_status ran[3][3] = {{SSFR_RAN, SSFR_UNWANTED, SSFR_RAN},
                                               {SSFR_RAN, SSFR_RAN, SSFR_RAN},
                                               {SSFR_UNWANTED, SSFR_UNWANTED, SSFR_RAN}};
    for (int kind = 0; kind < 3; kind++) {
        test_twin *t = begin(state);
        sheet s;
        begin_ball(t, &lights[0], 0.785, &s);
        test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
        assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
        for (int i = 0; i < 3; i++)
            assert_int_equal(ssfr_graph_report(t->graph)->nodes[i].status, ran[kind][i]);
    }
}

/* Depths of water and foam; a texel of the map; four of each of the basis' images, of which four terms have three. */
static void taps_are_those_of_its_kind(void **state)
{
    static const struct {
        const char *average, *foam;
        double depths;
    } ways[] = {{"none", "off", 1}, {"none", "front", 2}, {"3x3", "off", 9}, {"3x3", "without_water", 18}};
    static const double more[] = {1, 12, 0};
    for (int kind = 0; kind < 3; kind++)
        for (size_t i = 0; i < SSFR_COUNT(ways); i++) {
            test_twin *t = begin(state);
            sheet s;
            begin_ball(t, &lights[0], 0.785, &s);
            test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
            test_twin_set(t, "shadow.average", "%s", ways[i].average);
            test_twin_set(t, "shadow.foam", "%s", ways[i].foam);
            assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
            assert_true(ssfr_graph_report(t->graph)->nodes[2].taps == ways[i].depths + more[kind]);
        }
}

static void without_casters_nothing_is_done(void **state)
{
    for (int kind = 0; kind < 3; kind++) {
        test_twin *t = begin(state);
        sheet s;
        begin_ball(t, &lights[0], 0.785, &s);
        t->scene.n_solids = 0;
        test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
        assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
        const ssfr_report *report = ssfr_graph_report(t->graph);
        assert_int_equal(report->nodes[2].status, SSFR_NEEDLESS);
        assert_int_equal(report->nodes[0].status, SSFR_UNWANTED);
        const ssfr_field *light = test_twin_run(t, "light"); /* run all the same */
        for (int k = 0; k < W * H; k++) assert_true(light->data[k] == 1);
    }
}

static void without_its_maps_nothing_is_in_shadow(void **state)
{
    for (int kind = 0; kind < 2; kind++) {
        test_twin *t = begin(state);
        sheet s;
        begin_ball(t, &lights[0], 0.785, &s);
        test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
        assert_int_equal(ssfr_graph_set(t->graph, "shadow_map.off", "1"), SSFR_OK);
        const ssfr_field *light = test_twin_run(t, "light");
        for (int k = 0; k < W * H; k++) assert_true(light->data[k] == 1);
    }
}

static void a_plane_before_the_light_takes_all_of_it(void **state)
{
    for (int kind = 0; kind < 3; kind++) {
        test_twin *t = begin(state);
        sheet s;
        begin_ball(t, &lights[3], 0.785, &s); /* below the horizon */
        ball = (ssfr_solid){.shape = SSFR_PLANE, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .centre = {0, -9, 0}};
        test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
        assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
        assert_int_equal(ssfr_graph_report(t->graph)->nodes[2].status, SSFR_RAN);
        const ssfr_field *light = test_twin_run(t, "light");
        for (int k = 0; k < W * H; k++) assert_true(light->data[k] == 0);
        test_twin_light(t, &lights[0]); /* above it */
        assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
        assert_int_equal(ssfr_graph_report(t->graph)->nodes[2].status, SSFR_NEEDLESS);
    }
}

/* ---- twins ------------------------------------------------------------------------------------------------------- */

static void the_twins_agree_with_solids_of_all_shapes(void **state)
{
    static const struct {
        const char *pass, *setting;
    } cases[] = {{"shadow_map", "size=200"}, {"shadow_basis", "terms=5"},       {"shadow", "kind=map"},
                 {"shadow", "kind=ray"},     {"shadow", "kind=convolution"}};
    static const char *const inputs[] = {"shadow_map.size=200", NULL};
    test_scene s;
    test_scene_create_usual(&s, 90, 60);
    test_scene_add_shapes(&s);
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_twins *twins = NULL;
        ssfr_twins_row row[SSFR_MAX_OUTPUTS] = {0};
        const char *const settings[] = {cases[i].setting, NULL};
        double least = INFINITY, most = -INFINITY;
        int n = 0;
        assert_int_equal(ssfr_twins_create(&twins, ssfr_pass_find(cases[i].pass), &s.scene,
                                           test_twin_create(state, "shadow", 8, 8)->gl, inputs), SSFR_OK);
        assert_int_equal(ssfr_twins_compare(twins, settings, row, &n), SSFR_OK);
        assert_int_equal(n, 1);
        if (!row[0].ok) fail_msg("%s: outside %g of the values", cases[i].setting, row[0].outliers);
        for (int k = 0; k < row[0].reference->w * row[0].reference->h; k++)
            least = fmin(least, row[0].reference->data[k]), most = fmax(most, row[0].reference->data[k]);
        assert_true(least < most);
        ssfr_twins_finish(row, n);
        ssfr_twins_destroy(&twins);
    }
    test_scene_destroy(&s);
}

/* A user's map may have any size, but is a square. */
static void maps_that_are_not_square_are_refused(void **state)
{
    for (int kind = 0; kind < 2; kind++) {
        test_twin *t = begin_cover(state);
        test_twin_set(t, "shadow.kind", "%s", kinds[kind]);
        test_twin_give(t, "surface_depth", test_field_filled(W, H, 1, -2));
        test_twin_give(t, kind ? "light_basis" : "light_depth", test_field_filled(6, 7, kind ? 4 : 1, -1));
        assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(t->graph, &t->scene, &(ssfr_run_options){.keep_all = true}),
                     kind ? "shadow: basis has 6 x 7 pixels" : "shadow: light_depth has 6 x 7 pixels");
        test_twin_give(t, kind ? "light_basis" : "light_depth", test_field_filled(3, kind ? 6 : 3, kind ? 4 : 1, -1));
        test_twin_run(t, "light");
    }
}

static void parameters_out_of_range_are_refused(void **state)
{
    test_twin *t = begin(state);
    test_twin_refuses(t, "shadow.kind", "soft", "shadow.kind=soft");
    test_twin_refuses(t, "shadow.bias", "-1", "shadow.bias=-1");
    test_twin_refuses(t, "shadow.scale", "0", "shadow.scale=0");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(the_shadow_of_a_ball_is_its_ellipse),
        TEST_TWINS(a_soft_shadow_is_as_large_as_a_sharp_one),
        TEST_TWINS(behind_the_fluid_a_ball_casts_no_shadow),
        TEST_TWINS(a_million_metres_away_shadows_are_the_same),
        TEST_TWINS(at_half_resolution_shadows_are_where_they_were),
        TEST_TWINS(what_stands_above_by_less_than_the_bias_casts_no_shadow),
        TEST_TWINS(light_below_a_caster_is_the_series),
        TEST_TWINS(the_bias_moves_the_step_of_the_series),
        TEST_TWINS(more_terms_make_a_sharper_step),
        TEST_TWINS(where_no_caster_is_all_light_arrives_to_the_bit),
        TEST_TWINS(the_series_is_the_same_to_the_border_of_its_square),
        TEST_TWINS(fluid_at_the_very_depth_of_the_caster_is_lit),
        TEST_TWINS(the_depth_is_the_mean_of_those_around_it),
        TEST_TWINS(the_depth_of_foam_is_a_mean_too),
        TEST_TWINS(foam_says_where_the_fluid_is_without_water_or_before_it),
        TEST_TWINS(a_pixel_of_water_behind_foam_cuts_no_hole_into_its_light),
        TEST_TWINS(without_water_and_foam_all_light_arrives),
        TEST_TWINS(depths_that_are_no_numbers_do_not_count),
        TEST_TWINS(however_far_the_fluid_is_its_light_is_a_share),
        TEST_TWINS(only_the_maps_of_a_kind_are_made),
        TEST_TWINS(taps_are_those_of_its_kind),
        TEST_TWINS(without_casters_nothing_is_done),
        TEST_TWINS(without_its_maps_nothing_is_in_shadow),
        TEST_TWINS(a_plane_before_the_light_takes_all_of_it),
        TEST_GPU(the_twins_agree_with_solids_of_all_shapes),
        TEST_TWINS(maps_that_are_not_square_are_refused),
        TEST_TWINS(parameters_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

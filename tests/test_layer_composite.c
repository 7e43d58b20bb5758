/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_layer_composite.c: layers of water and foam by the numbers of their equations. */
#include "tests/pass_util.h"

enum { W = 16, H = 12, N = W * H };
static const double z0 = -3, sky[3] = {0.2, 0.4, 0.8}, scene[3] = {0.9, 0.5, 0.2}, fluid[3] = {0.01, 0.09, 0.13};
static const double c_ff[3] = {0.95, 0.95, 0.95}, c_fb[3] = {0.5, 0.62, 0.7};
static const double ior = 1.333;

/* ---- a surface 3 m away whose normals face the eye --------------------------------------------------------------- */

enum { BACK, FRONT, FOAM, FOAM_FRONT, LIGHT, N_VALUES };

typedef struct pond {
    test_twin *t;
    ssfr_field *scene, *scene_depth, *depth, *normal, *value[N_VALUES];
} pond;

/* Unit, from the surface at this pixel towards the eye. */
static void view_at(const test_twin *t, int i, double v[3])
{
    const test_ray at = test_ray_at(t, i % W, i / W, 1);
    v[0] = -at.u, v[1] = -at.v, v[2] = 1;
    ssfr_normalize(v);
}

/* Every pixel's normal stands at this angle to its own view. */
static void tilt(const pond *p, double angle)
{
    for (int i = 0; i < N; i++) {
        double v[3], a[3];
        view_at(p->t, i, v);
        ssfr_cross(v, (const double[3]){1, 0, 0}, a);
        ssfr_normalize(a);
        for (int k = 0; k < 3; k++) p->normal->data[3 * i + k] = cos(angle) * v[k] + sin(angle) * a[k];
    }
}

static void fill(const ssfr_field *field, const double color[3])
{
    for (int i = 0; i < 3 * N; i++) field->data[i] = color[i % 3];
}

/* A sky of one colour, and neither mirror nor highlight: what is not set here has its default. */
static pond begin(void **state)
{
    static const double c[1][3] = {{0, 0, -3}};
    static const char *const skies[] = {"sky.zenith_r",  "sky.horizon_r", "sky.zenith_g",
                                        "sky.horizon_g", "sky.zenith_b", "sky.horizon_b"};
    pond p = {.t = test_twin_create(state, "layer_composite", W, H), .scene = test_field(W, H, 3),
              .scene_depth = test_field_filled(W, H, 1, -SSFR_EMPTY), .depth = test_field_filled(W, H, 1, z0),
              .normal = test_field(W, H, 3)};
    for (int v = 0; v < N_VALUES; v++) p.value[v] = test_field_filled(W, H, 1, v == LIGHT);
    fill(p.scene, scene);
    tilt(&p, 0);
    test_twin_place(p.t, 1, c, 0.1, NULL);
    test_twin_set(p.t, "fresnel_bias", "0");
    test_twin_set(p.t, "fresnel_scale", "0");
    test_twin_set(p.t, "specular", "0");
    test_twin_set(p.t, "medium.ior", "%g", ior);
    for (int k = 0; k < 6; k++) test_twin_set(p.t, skies[k], "%g", sky[k / 2]);
    return p;
}

static void give(const pond *p)
{
    static const char *const ports[] = {"thickness_back", "thickness_front", "foam_thickness", "foam_front", "light"};
    test_twin_give(p->t, "scene_color", p->scene);
    test_twin_give(p->t, "scene_depth", p->scene_depth);
    test_twin_give(p->t, "depth", p->depth);
    test_twin_give(p->t, "normal", p->normal);
    for (int v = 0; v < N_VALUES; v++) test_twin_give(p->t, ports[v], p->value[v]);
}

static const ssfr_field *run(const pond *p)
{
    give(p);
    return test_twin_run(p->t, "color");
}

static void lay(const pond *p, double back, double foam, double front)
{
    ssfr_field_fill(p->value[BACK], back);
    ssfr_field_fill(p->value[FOAM], foam);
    ssfr_field_fill(p->value[FRONT], front);
}

/* The picture has one colour. */
static void assert_color(const pond *p, const double expected[3])
{
    const ssfr_field *color = run(p);
    for (int i = 0; i < 3 * N; i++) assert_close(color->data[i], expected[i % 3], 32 * p->t->eps, 32 * p->t->eps);
}

/* lerp(medium, behind, e^-t) of the papers, by hand. */
static void cover(double color[3], const double medium[3], double t)
{
    for (int k = 0; k < 3; k++) color[k] = medium[k] * (1 - exp(-t)) + color[k] * exp(-t);
}

static void copy(double to[3], const double from[3])
{
    memcpy(to, from, 3 * sizeof *to);
}

/* One coefficient for all colours, as eqs 3.5 and 3.7 have it. */
static void attenuate_by(const pond *p, double k)
{
    test_twin_set(p->t, "attenuation", "single");
    test_twin_set(p->t, "k", "%.17g", k);
}

/* ---- layers ------------------------------------------------------------------------------------------------------ */

static void layers_cover_each_other_from_back_to_front(void **state)
{
    const pond p = begin(state);
    double color[3];
    attenuate_by(&p, 1.7);
    test_twin_set(p.t, "foam_falloff_scale", "11");
    lay(&p, 0.4, 0.05, 0.3); /* without front of the foam c_foam is c_fb */
    copy(color, scene);
    cover(color, fluid, 1.7 * 0.4);
    cover(color, c_fb, 11 * 0.05);
    cover(color, fluid, 1.7 * 0.3);
    assert_color(&p, color);
    const double by_hand = 0.9 * exp(-0.68) + 0.01 * (1 - exp(-0.68)); /* C_wb in red */
    assert_close(color[0], 0.01 - 0.01 * exp(-0.51) + exp(-0.51) * (0.5 - 0.5 * exp(-0.55) + exp(-0.55) * by_hand),
                 1e-15, 0);
}

static void without_foam_only_the_sum_of_both_waters_counts(void **state)
{
    static const double absorption[3] = {2.2, 0.65, 0.45};
    const pond p = begin(state);
    double color[3];
    for (int k = 0; k < 3; k++) color[k] = fluid[k] + (scene[k] - fluid[k]) * exp(-absorption[k] * 0.7);
    lay(&p, 0.7, 0, 0);
    assert_color(&p, color);
    lay(&p, 0.2, 0, 0.5);
    assert_color(&p, color);
    lay(&p, 0, 0, 0.7);
    assert_color(&p, color);
}

static void opaque_foam_hides_what_is_behind_and_not_the_water_before(void **state)
{
    const pond p = begin(state);
    double color[3];
    attenuate_by(&p, 2);
    lay(&p, 0.4, 100, 0);
    assert_color(&p, c_fb);
    lay(&p, 0, 100, 0.25);
    copy(color, c_fb);
    cover(color, fluid, 0.5);
    assert_color(&p, color);
    lay(&p, 0, 100, 100);
    assert_color(&p, fluid);
}

/* base_color e^(-T falloff) over what e^(-T falloff_w) lets through, in either layer. */
static void falloff_darkens_the_base_color(void **state)
{
    static const double base[3] = {0.1, 0.35, 0.4}, falloff[3] = {2.2, 0.65, 0.45};
    const pond p = begin(state);
    double color[3];
    test_twin_set(p.t, "fluid_color", "falloff");
    test_twin_set(p.t, "falloff_scale", "1.5");
    test_twin_set(p.t, "color_falloff_w", "0.9");
    const double through = exp(-0.4 * 1.5 * 0.9);
    for (int k = 0; k < 3; k++)
        color[k] = base[k] * exp(-0.4 * 1.5 * falloff[k]) * (1 - through) + scene[k] * through;
    lay(&p, 0.4, 0, 0);
    assert_color(&p, color);
    lay(&p, 0, 0, 0.4);
    assert_color(&p, color);
    lay(&p, 1e4, 0, 0);
    assert_color(&p, (const double[3]){0, 0, 0}); /* deep water is black */
}

/* ---- the colour of foam ------------------------------------------------------------------------------------------ */

/* Opaque foam whose front fills this part of delta_foam has this share of c_ff. */
static void assert_share(const pond *p, double part, double share)
{
    double color[3];
    lay(p, 0, 100, 0);
    test_twin_set(p->t, "delta_foam", "0.05");
    ssfr_field_fill(p->value[FOAM_FRONT], part * 0.05);
    for (int k = 0; k < 3; k++) color[k] = c_fb[k] + share * (c_ff[k] - c_fb[k]);
    assert_color(p, color);
}

static void foam_is_coloured_by_eq_3_9(void **state)
{
    const pond p = begin(state);
    assert_share(&p, 0, 0);
    assert_share(&p, 0.4, 1 - exp(-0.4));
    assert_share(&p, 1, 1 - exp(-1));
    assert_share(&p, 3, 1 - exp(-1)); /* overlapping kernels are held to delta_foam */
    test_twin_set(p.t, "foam_pow_scale", "2");
    assert_share(&p, 0.4, 1 - exp(-0.16));
}

static void foam_is_coloured_by_listing_a_20(void **state)
{
    const pond p = begin(state);
    test_twin_set(p.t, "foam_blend", "power");
    assert_share(&p, 0, 0);
    assert_share(&p, 0.4, 0.4);
    assert_share(&p, 3, 1);
    test_twin_set(p.t, "foam_pow_scale", "0.5");
    assert_share(&p, 0.36, 0.6);
}

/* Eq. 3.9 as it is printed makes thin foam c_ff, which the listing does not have. */
static void b10_exchanges_the_colours_of_eq_3_9_alone(void **state)
{
    const pond p = begin(state);
    test_twin_set(p.t, "as_printed", "B10");
    assert_share(&p, 0, 1);
    assert_share(&p, 0.4, exp(-0.4));
    test_twin_set(p.t, "foam_blend", "power");
    assert_share(&p, 0.4, 0.4);
}

static void b26_counts_more_foam_than_delta_foam(void **state)
{
    const pond p = begin(state);
    test_twin_set(p.t, "as_printed", "B26");
    assert_share(&p, 0.4, 1 - exp(-0.4));
    assert_share(&p, 3, 1 - exp(-3));
    test_twin_set(p.t, "foam_blend", "power");
    assert_share(&p, 3, 3);
}

static void foam_in_the_shade_keeps_the_share_ka(void **state)
{
    const double lights[] = {0, 0.25, 1, 2}, lit[] = {0.6, 0.6 * 0.75 + 0.25, 1, 1};
    const pond p = begin(state);
    lay(&p, 0, 100, 0);
    for (size_t i = 0; i < SSFR_COUNT(lights); i++) {
        ssfr_field_fill(p.value[LIGHT], lights[i]);
        assert_color(&p, (const double[3]){c_fb[0] * lit[i], c_fb[1] * lit[i], c_fb[2] * lit[i]});
    }
}

/* ---- what the surface mirrors ------------------------------------------------------------------------------------ */

static void mirror(double color[3], double f)
{
    for (int k = 0; k < 3; k++) color[k] = color[k] * (1 - f) + sky[k] * f;
}

static void fresnels_term_is_bias_scale_and_power(void **state)
{
    static const double angles[] = {0, 0.6, 1.2, 1.5707963267948966, 2};
    const pond p = begin(state);
    test_twin_set(p.t, "fresnel_bias", "0.1");
    test_twin_set(p.t, "fresnel_scale", "0.7");
    test_twin_set(p.t, "fresnel_power", "3");
    for (size_t i = 0; i < SSFR_COUNT(angles); i++) {
        double color[3];
        tilt(&p, angles[i]);
        copy(color, scene);
        mirror(color, 0.1 + 0.7 * pow(1 - fmax(cos(angles[i]), 0), 3));
        assert_color(&p, color);
    }
    test_twin_set(p.t, "fresnel_bias", "0.5"); /* 1.2 at grazing angles counts as 1 */
    tilt(&p, 2);
    assert_color(&p, sky);
}

static void b12_takes_the_cosine_for_its_opposite(void **state)
{
    const pond p = begin(state);
    double color[3];
    test_twin_set(p.t, "as_printed", "B12");
    test_twin_set(p.t, "fresnel_bias", "0.02");
    test_twin_set(p.t, "fresnel_scale", "0.03");
    test_twin_set(p.t, "fresnel_power", "2");
    copy(color, scene);
    mirror(color, 0.02 + 0.03 * 4); /* at normal incidence, where it should be the bias */
    assert_color(&p, color);
    tilt(&p, 2);
    copy(color, scene);
    mirror(color, 0.05);
    assert_color(&p, color);
}

/* Foam before the surface covers what that mirrors; water before the foam mirrors itself. */
static void the_frontmost_water_mirrors(void **state)
{
    const pond p = begin(state);
    double color[3];
    attenuate_by(&p, 1);
    test_twin_set(p.t, "foam_falloff_scale", "20");
    test_twin_set(p.t, "fresnel_bias", "0.3");
    lay(&p, 0.5, 0.05, 0);
    copy(color, scene);
    cover(color, fluid, 0.5);
    mirror(color, 0.3);
    cover(color, c_fb, 1);
    assert_color(&p, color);
    lay(&p, 0.5, 0.05, 0.2);
    copy(color, scene);
    cover(color, fluid, 0.5);
    cover(color, c_fb, 1);
    cover(color, fluid, 0.2);
    mirror(color, 0.3);
    assert_color(&p, color);
}

/* Reflection and highlight times (1 - e^-T_wf + e^-T_f, at most 1) (1 - e^-T_wf), added to what comes through. */
static void b11_adds_what_is_mirrored_as_far_as_water_is_before_foam(void **state)
{
    static const double foams[] = {0, 0.05, 0.2};
    const pond p = begin(state);
    double color[3];
    attenuate_by(&p, 1);
    test_twin_set(p.t, "foam_falloff_scale", "20");
    test_twin_set(p.t, "fresnel_bias", "0.3");
    test_twin_set(p.t, "as_printed", "B11");
    lay(&p, 0.5, 0, 0);
    copy(color, scene);
    cover(color, fluid, 0.5);
    assert_color(&p, color); /* nothing is mirrored */
    for (size_t i = 0; i < SSFR_COUNT(foams); i++) {
        lay(&p, 0, foams[i], 0.2);
        copy(color, scene);
        cover(color, c_fb, 20 * foams[i]);
        cover(color, fluid, 0.2);
        const double clear = exp(-0.2), weight = fmin(1 - clear + exp(-20 * foams[i]), 1) * (1 - clear);
        for (int k = 0; k < 3; k++) color[k] += 0.3 * sky[k] * weight;
        assert_color(&p, color);
    }
}

/* What comes through is then listing A.20's c_fluid_wf.w, whatever medium the scene has. */
static void b11_weighs_by_the_falloff_of_its_colour_model(void **state)
{
    static const double base[3] = {0.1, 0.35, 0.4}, falloff[3] = {2.2, 0.65, 0.45};
    const pond p = begin(state);
    const double clear = exp(-0.2 * 0.9), weight = fmin(1 - clear + exp(-20 * 0.2), 1) * (1 - clear);
    double color[3];
    attenuate_by(&p, 7);
    test_twin_set(p.t, "fluid_color", "falloff");
    test_twin_set(p.t, "color_falloff_w", "0.9");
    test_twin_set(p.t, "foam_falloff_scale", "20");
    test_twin_set(p.t, "fresnel_bias", "0.3");
    test_twin_set(p.t, "as_printed", "B11");
    lay(&p, 0, 0.2, 0.2);
    copy(color, scene);
    cover(color, c_fb, 20 * 0.2);
    for (int k = 0; k < 3; k++)
        color[k] = base[k] * exp(-0.2 * falloff[k]) * (1 - clear) + color[k] * clear + 0.3 * sky[k] * weight;
    assert_color(&p, color);
}

/* ---- what coincides with one layer ------------------------------------------------------------------------------- */

/* The same water by the pass `composite`. */
static const ssfr_field *run_composite(void **state, const pond *p, const char *fresnel)
{
    test_twin *t = test_twin_create(state, "composite", W, H);
    static const char *const keys[] = {"sky.zenith_r", "sky.horizon_g", "medium.ior"};
    static const double values[] = {0.7, 0.1, 1.333};
    t->scene.particles = p->t->scene.particles;
    test_twin_set(t, "fresnel", "%s", fresnel);
    for (size_t k = 0; k < SSFR_COUNT(keys); k++) {
        test_twin_set(t, keys[k], "%g", values[k]);
        test_twin_set(p->t, keys[k], "%g", values[k]);
    }
    for (int k = 0; k < 2; k++) test_twin_set(t, k ? "sky.zenith_b" : "sky.horizon_b", "%g", sky[2]);
    test_twin_set(t, "sky.horizon_r", "%g", sky[0]);
    test_twin_set(t, "sky.zenith_g", "%g", sky[1]);
    test_twin_set(t, "gamma", "0.3");
    test_twin_give(t, "scene_color", p->scene);
    test_twin_give(t, "scene_depth", p->scene_depth);
    test_twin_give(t, "depth", p->depth);
    test_twin_give(t, "normal", p->normal);
    test_twin_give(t, "thickness", p->value[BACK]);
    return test_twin_run(t, "color");
}

static void scatter(const pond *p)
{
    uint64_t random = 17;
    for (int i = 0; i < 3 * N; i++) p->scene->data[i] = (double)(float)test_random(&random, 0, 1);
    for (int i = 0; i < N; i++) {
        double *n = p->normal->data + 3 * i;
        p->value[BACK]->data[i] = (double)(float)test_random(&random, 0, 2);
        p->depth->data[i] = (double)(float)test_random(&random, -5, -2);
        p->scene_depth->data[i] = (double)(float)test_random(&random, -9, -3);
        for (int k = 0; k < 3; k++) n[k] = test_random(&random, k == 2 ? 0.3 : -1, 1);
        ssfr_normalize(n);
    }
}

/* Refraction, rejection, attenuation, mirrored sky, highlight: without foam it is the water of van der Laan 2009. */
static void without_foam_it_is_the_water_of_composite(void **state)
{
    static const char *const fresnels[][2] = {{"schlick", "power"}, {"exact", "exact"}};
    const pond p = begin(state);
    const double r0 = ssfr_square((ior - 1) / (ior + 1));
    test_twin_set(p.t, "fresnel_bias", "%.17g", r0);
    test_twin_set(p.t, "fresnel_scale", "%.17g", 1 - r0);
    test_twin_set(p.t, "gamma", "0.3");
    test_twin_set(p.t, "specular", "0.6");
    scatter(&p);
    for (size_t f = 0; f < SSFR_COUNT(fresnels); f++) {
        const ssfr_field *reference = run_composite(state, &p, fresnels[f][0]);
        test_twin_set(p.t, "fresnel", "%s", fresnels[f][1]);
        assert_true(test_difference(run(&p), reference) < 1e4 * p.t->eps);
        assert_true(test_difference(reference, p.scene) > 0.1);
    }
    /* Images that are not given are neutral: as no thickness, no foam and all the light. */
    ssfr_field_fill(p.value[BACK], 0);
    const ssfr_field *given = run(&p);
    static const char *const ports[] = {"thickness_back", "thickness_front", "foam_thickness", "foam_front", "light"};
    for (int v = 0; v < N_VALUES; v++) test_twin_give(p.t, ports[v], NULL);
    assert_true(test_same_bits(test_twin_run(p.t, "color"), given));
}

/* By eq. 3.8, and by listing A.20 (B11), which shows it where water is before foam alone. */
static void the_highlight_takes_the_light_that_arrives(void **state)
{
    const pond p = begin(state);
    ssfr_field *dark = test_field(W, H, 3), *bright = test_field(W, H, 3);
    attenuate_by(&p, 1);
    test_twin_set(p.t, "specular", "0.5");
    test_twin_set(p.t, "shininess", "2");
    test_twin_set(p.t, "light.azimuth_deg", "90");
    for (int listing = 0; listing < 2; listing++) {
        double color[3];
        test_twin_set(p.t, "as_printed", listing ? "B11" : "none");
        lay(&p, 0, 0, listing ? 0.5 : 0);
        copy(color, scene);
        cover(color, fluid, listing ? 0.5 : 0);
        ssfr_field_fill(p.value[LIGHT], 0);
        assert_color(&p, color);
        memcpy(dark->data, run(&p)->data, sizeof *dark->data * 3 * N);
        ssfr_field_fill(p.value[LIGHT], 1);
        memcpy(bright->data, run(&p)->data, sizeof *bright->data * 3 * N);
        ssfr_field_fill(p.value[LIGHT], 0.25);
        const ssfr_field *some = run(&p);
        for (int i = 0; i < 3 * N; i++) {
            assert_close(some->data[i], ssfr_mix(dark->data[i], bright->data[i], 0.25), 16 * p.t->eps, 0);
            assert_true(bright->data[i] > dark->data[i] + 0.01);
        }
    }
    lay(&p, 0, 100, 0);
    ssfr_field_fill(p.depth, -SSFR_EMPTY); /* no surface, nothing to shine */
    ssfr_field_fill(p.value[LIGHT], 1);
    assert_color(&p, c_fb);
}

/* The sky's image is no light of the sun's. */
static void water_in_the_shade_mirrors_the_sky(void **state)
{
    const pond p = begin(state);
    attenuate_by(&p, 1);
    test_twin_set(p.t, "fresnel_bias", "0.3");
    ssfr_field_fill(p.value[LIGHT], 0);
    for (int before = 0; before < 2; before++) {
        double color[3];
        lay(&p, before ? 0 : 0.5, 0, before ? 0.5 : 0);
        copy(color, scene);
        cover(color, fluid, 0.5);
        mirror(color, 0.3);
        assert_color(&p, color);
    }
}

/* ---- refraction -------------------------------------------------------------------------------------------------- */

/* A scene whose red is the column in pixels, clear water, normals that lean to the right. Columns from 12 on
 * stand before the water. */
static pond begin_places(void **state)
{
    const pond p = begin(state);
    attenuate_by(&p, 0);
    for (int i = 0; i < N; i++) {
        p.scene->data[3 * i] = i % W + 0.5;
        for (int k = 0; k < 3; k++) p.normal->data[3 * i + k] = k == 0 ? 0.6 : k == 2 ? 0.8 : 0;
        p.scene_depth->data[i] = i % W >= 12 ? -1 : -9;
    }
    lay(&p, 0.2, 0, 0.3);
    return p;
}

static void assert_shift(const pond *p, double pixels, bool rejects)
{
    const ssfr_field *color = run(p);
    for (int i = 0; i < N; i++) {
        const int x = i % W;
        const bool straight = rejects && x + 0.5 + pixels >= 12;
        assert_close(color->data[3 * i], straight ? x + 0.5 : fmin(x + 0.5 + pixels, W - 0.5), 64 * W * p->t->eps, 0);
    }
}

static void the_background_is_shifted_by_both_waters(void **state)
{
    const pond p = begin_places(state);
    test_twin_set(p.t, "gamma", "%.17g", 3 / (0.6 * 0.5 * H));
    assert_shift(&p, 3, true);
    test_twin_set(p.t, "reject", "0");
    assert_shift(&p, 3, false);
    test_twin_set(p.t, "reject", "1");
    for (int i = 0; i < N; i++) p.scene_depth->data[i] = z0; /* as far as the water is not before it */
    assert_shift(&p, 3, false);
}

static void b29_shifts_by_pixels_and_rejects_nothing(void **state)
{
    const pond p = begin_places(state);
    test_twin_set(p.t, "as_printed", "B29");
    test_twin_set(p.t, "gamma", "10");
    assert_shift(&p, 3, false);
}

/* ---- where and what ---------------------------------------------------------------------------------------------- */

/* Columns: nothing, foam alone, water behind without a surface, water with a surface. The rest of the scene stays. */
static void foam_is_drawn_beyond_the_water_and_all_else_is_untouched(void **state)
{
    ssfr_node_status status;
    const pond p = begin(state);
    attenuate_by(&p, 1);
    test_twin_set(p.t, "fresnel_bias", "1");
    scatter(&p);
    for (int i = 0; i < N; i++) {
        const int column = i % 4;
        p.depth->data[i] = column == 3 ? z0 : -SSFR_EMPTY;
        p.value[BACK]->data[i] = column == 2 ? 100 : 0;
        p.value[FOAM]->data[i] = column == 1 ? 100 : 0;
        p.value[FOAM_FRONT]->data[i] = column == 0; /* without foam it has no colour */
        p.normal->data[3 * i] = column == 3 ? p.normal->data[3 * i] : NAN;
    }
    give(&p);
    const ssfr_field *color = test_twin_run_if_needed(p.t, "color", &status);
    assert_int_equal(status, SSFR_RAN);
    for (int i = 0; i < 3 * N; i++) {
        const double expected[] = {p.scene->data[i], c_fb[i % 3], fluid[i % 3], sky[i % 3]};
        if (i / 3 % 4 == 0) assert_true(color->data[i] == p.scene->data[i]);
        assert_close(color->data[i], expected[i / 3 % 4], 16 * p.t->eps, 0);
    }
}

/* Thicknesses from nothing to beyond what half and single floats hold, and what is no number, in each layer. */
static void pictures_are_finite_whatever_the_thicknesses_are(void **state)
{
    static const double extremes[] = {0, 1e-38, 1e5, 1e30, INFINITY, -1, NAN};
    static const char *const models[][2] = {
        {"fluid_color", "falloff"}, {"foam_blend", "power"}, {"foam_pow_scale", "4"},
        {"as_printed", "B10,B11,B12,B26,B28,B29"}, {"delta_foam", "1e-6"}, {"k", "0"}, {"gamma", "1000"},
        {"foam_falloff_scale", "0"}};
    const pond p = begin(state);
    attenuate_by(&p, 1);
    test_twin_set(p.t, "fresnel_scale", "1");
    for (size_t m = 0; m < SSFR_COUNT(models); m++) {
        const size_t n = SSFR_COUNT(extremes);
        test_twin_set(p.t, models[m][0], "%s", models[m][1]);
        for (size_t i = 0; i < N; i++) /* all pairs of layers, in turn */
            for (size_t v = 0; v < N_VALUES; v++) p.value[v]->data[i] = extremes[(i * (v + 1) + i / n * v) % n];
        const ssfr_field *color = run(&p);
        for (int i = 0; i < 3 * N; i++) assert_true(isfinite(color->data[i]));
    }
}

static void infinitely_thick_water_has_its_own_colour(void **state)
{
    static const double thick[] = {1e5, 1e30, INFINITY};
    const pond p = begin(state);
    for (size_t i = 0; i < SSFR_COUNT(thick); i++) {
        lay(&p, thick[i], 0, 0);
        assert_color(&p, fluid);
        lay(&p, 0, 0, thick[i]);
        assert_color(&p, fluid);
        lay(&p, thick[i], thick[i], 0);
        assert_color(&p, c_fb);
    }
}

static void without_fluid_the_scene_shows(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    ssfr_node_status status;
    const pond p = begin(state);
    scatter(&p);
    test_twin_place(p.t, 1, behind, 0.1, NULL);
    test_twin_give(p.t, "scene_color", p.scene);
    const ssfr_field *color = test_twin_run_if_needed(p.t, "color", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_true(test_same_bits(color, p.scene));
}

/* ---- images of fluid without particles --------------------------------------------------------------------------- */

static void a_thickness_that_is_given_is_fluid(void **state)
{
    static const struct {
        int value;
        const double *medium;
    } layers[] = {{BACK, fluid}, {FRONT, fluid}, {FOAM, c_fb}, {FOAM_FRONT, NULL}, {LIGHT, NULL}};
    static const char *const ports[] = {"thickness_back", "thickness_front", "foam_thickness", "foam_front", "light"};
    for (size_t i = 0; i < SSFR_COUNT(layers); i++) {
        const pond p = begin(state);
        ssfr_node_status status;
        p.t->scene.particles = NULL;
        test_twin_give(p.t, "scene_color", p.scene);
        ssfr_field_fill(p.value[layers[i].value], 100);
        test_twin_give(p.t, ports[layers[i].value], p.value[layers[i].value]);
        const ssfr_field *color = test_twin_run_if_needed(p.t, "color", &status);
        assert_int_equal(status, layers[i].medium ? SSFR_RAN : SSFR_NEEDLESS);
        for (int k = 0; k < 3 * N; k++)
            assert_close(color->data[k], (layers[i].medium ? layers[i].medium : scene)[k % 3], 16 * p.t->eps, 0);
    }
}

/* Also where no particle is: foam of a host over a whole wide image, and a particle in one corner of it. */
static void foam_that_is_given_is_drawn_everywhere(void **state)
{
    enum { WIDE = 96, HIGH = 64 };
    static const double corner[1][3] = {{-0.7, 0.45, -1}};
    test_twin *t = test_twin_create_for(state, ssfr_pipeline_find("bagar2010"), WIDE, HIGH);
    for (int with = 0; with < 2; with++) {
        if (with) test_twin_place(t, 1, corner, 0.02, NULL);
        test_twin_give(t, "foam_thickness", test_field_filled(WIDE, HIGH, 1, 100));
        const ssfr_field *color = test_twin_run(t, "color");
        for (int i = 0; i < 3 * WIDE * HIGH; i++) assert_close(color->data[i], c_fb[i % 3], 16 * t->eps, 0);
        ssfr_node_status status;
        color = test_twin_run_if_needed(t, "color", &status);
        for (int i = 0; i < 3 * WIDE * HIGH; i++) assert_close(color->data[i], c_fb[i % 3], 16 * t->eps, 0);
    }
}

/* A length of water says nothing of how far it is. */
static void the_nearest_fluid_is_that_of_a_depth(void **state)
{
    const pond p = begin(state);
    p.t->scene.particles = NULL;
    test_twin_set(p.t, "surface", "split");
    ssfr_field_fill(p.value[BACK], 5);
    test_twin_give(p.t, "thickness_back", p.value[BACK]);
    test_twin_give(p.t, "low", p.depth);
    assert_int_equal(ssfr_graph_run(p.t->graph, &p.t->scene, NULL), SSFR_OK);
    assert_true(ssfr_graph_last_run(p.t->graph, 0)->frame->facts.nearest == 3);
    test_twin_give(p.t, "low", NULL);
    assert_int_equal(ssfr_graph_run(p.t->graph, &p.t->scene, NULL), SSFR_OK);
    assert_false(ssfr_graph_last_run(p.t->graph, 0)->frame->facts.fluid);
    assert_true(ssfr_graph_last_run(p.t->graph, 0)->frame->facts.layers);
    test_twin_give(p.t, "thickness_back", NULL);
    assert_int_equal(ssfr_graph_run(p.t->graph, &p.t->scene, &(ssfr_run_options){.keep_all = true}), SSFR_OK);
    assert_false(ssfr_graph_last_run(p.t->graph, 0)->frame->facts.layers);
}

static void layer_composite_refuses_values_out_of_range(void **state)
{
    const pond p = begin(state);
    test_twin_refuses(p.t, "delta_foam", "0", "layer_composite.delta_foam");
    test_twin_refuses(p.t, "foam_falloff_scale", "-1", "layer_composite.foam_falloff_scale");
    test_twin_refuses(p.t, "foam_pow_scale", "0", "layer_composite.foam_pow_scale");
    test_twin_refuses(p.t, "fresnel_power", "0", "layer_composite.fresnel_power");
    test_twin_refuses(p.t, "Ka", "1.2385", "layer_composite.Ka");
    test_twin_refuses(p.t, "fluid_color", "wine", "wine");
    test_twin_refuses(p.t, "as_printed", "B10,B27", "B27");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(layers_cover_each_other_from_back_to_front),
        TEST_TWINS(without_foam_only_the_sum_of_both_waters_counts),
        TEST_TWINS(opaque_foam_hides_what_is_behind_and_not_the_water_before),
        TEST_TWINS(falloff_darkens_the_base_color),
        TEST_TWINS(foam_is_coloured_by_eq_3_9),
        TEST_TWINS(foam_is_coloured_by_listing_a_20),
        TEST_TWINS(b10_exchanges_the_colours_of_eq_3_9_alone),
        TEST_TWINS(b26_counts_more_foam_than_delta_foam),
        TEST_TWINS(foam_in_the_shade_keeps_the_share_ka),
        TEST_TWINS(fresnels_term_is_bias_scale_and_power),
        TEST_TWINS(b12_takes_the_cosine_for_its_opposite),
        TEST_TWINS(the_frontmost_water_mirrors),
        TEST_TWINS(b11_adds_what_is_mirrored_as_far_as_water_is_before_foam),
        TEST_TWINS(b11_weighs_by_the_falloff_of_its_colour_model),
        TEST_TWINS(without_foam_it_is_the_water_of_composite),
        TEST_TWINS(the_highlight_takes_the_light_that_arrives),
        TEST_TWINS(water_in_the_shade_mirrors_the_sky),
        TEST_TWINS(the_background_is_shifted_by_both_waters),
        TEST_TWINS(b29_shifts_by_pixels_and_rejects_nothing),
        TEST_TWINS(foam_is_drawn_beyond_the_water_and_all_else_is_untouched),
        TEST_TWINS(pictures_are_finite_whatever_the_thicknesses_are),
        TEST_TWINS(infinitely_thick_water_has_its_own_colour),
        TEST_TWINS(without_fluid_the_scene_shows),
        TEST_TWINS(a_thickness_that_is_given_is_fluid),
        TEST_TWINS(foam_that_is_given_is_drawn_everywhere),
        {"the_nearest_fluid_is_that_of_a_depth", the_nearest_fluid_is_that_of_a_depth, NULL, test_clean, "cpu"},
        TEST_TWINS(layer_composite_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

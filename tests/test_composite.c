/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_composite.c: Fresnel, absorption, refraction and highlight against their closed forms. */
#include "tests/meshes.h"
#include "tests/pass_util.h"

enum { W = 32, H = 24 };
static const double pi = 3.14159265358979323846, z0 = -3;

/* ---- a surface 3 m away that faces the eye ----------------------------------------------------------------------- */

typedef struct water {
    test_twin *t;
    ssfr_field *scene, *scene_depth, *depth, *normal, *thickness;
} water;

/* Water of index 1, so that nothing is reflected; no highlight; a sky of one colour. */
static water begin(void **state)
{
    static const double c[1][3] = {{0, 0, -3}};
    static const char *const sky[] = {"sky.zenith_r",  "sky.horizon_r", "sky.zenith_g",
                                      "sky.horizon_g", "sky.zenith_b", "sky.horizon_b"};
    const water w = {.t = test_twin_create(state, "composite", W, H), .scene = test_field_filled(W, H, 3, 1),
                     .scene_depth = test_field_filled(W, H, 1, -SSFR_EMPTY), .depth = test_field_filled(W, H, 1, z0),
                     .normal = test_field(W, H, 3), .thickness = test_field(W, H, 1)};
    for (int i = 0; i < W * H; i++) w.normal->data[3 * i + 2] = 1;
    test_twin_place(w.t, 1, c, 0.1, NULL);
    test_twin_set(w.t, "fresnel", "exact");
    test_twin_set(w.t, "medium.ior", "1");
    test_twin_set(w.t, "specular", "0");
    for (int k = 0; k < 6; k++) test_twin_set(w.t, sky[k], "%g", 0.2 * (1 << k / 2));
    return w;
}

static const double sky[3] = {0.2, 0.4, 0.8};

static const ssfr_field *run(const water *w)
{
    test_twin_give(w->t, "scene_color", w->scene);
    test_twin_give(w->t, "scene_depth", w->scene_depth);
    test_twin_give(w->t, "depth", w->depth);
    test_twin_give(w->t, "normal", w->normal);
    test_twin_give(w->t, "thickness", w->thickness);
    return test_twin_run(w->t, "color");
}

/* Unit, from the surface at this pixel towards the eye. */
static void view_at(const test_twin *t, int x, int y, double v[3])
{
    const test_ray at = test_ray_at(t, x, y, 1);
    v[0] = -at.u, v[1] = -at.v, v[2] = 1;
    ssfr_normalize(v);
}

/* Every pixel's normal stands at this angle to its own view, towards a side that turns from pixel to pixel. */
static void tilt(const water *w, double angle)
{
    for (int i = 0; i < W * H; i++) {
        double v[3], a[3], b[3];
        view_at(w->t, i % W, i / W, v);
        ssfr_cross(v, (const double[3]){1, 0, 0}, a);
        ssfr_normalize(a);
        ssfr_cross(v, a, b);
        for (int k = 0; k < 3; k++)
            w->normal->data[3 * i + k] = cos(angle) * v[k] + sin(angle) * (cos(i) * a[k] + sin(i) * b[k]);
    }
}

/* ---- Fresnel ----------------------------------------------------------------------------------------------------- */

/* Without thickness the scene (white) shows with 1 - F and the sky with F: every channel tells F. At grazing angles F
 * changes by up to 5 times the cosine, which rounds. */
static void assert_reflectance(const water *w, double expected)
{
    const ssfr_field *color = run(w);
    for (int i = 0; i < 3 * W * H; i++)
        assert_close((1 - color->data[i]) / (1 - sky[i % 3]), expected, 64 * w->t->eps, 0);
}

static const double angles[] = {0, 30, 53.07, 60, 85, 90};

static void schlick_is_its_formula(void **state)
{
    const water w = begin(state);
    test_twin_set(w.t, "fresnel", "schlick");
    test_twin_set(w.t, "medium.ior", "1.333");
    const double r0 = 0.333 / 2.333 * 0.333 / 2.333;
    for (size_t i = 0; i < SSFR_COUNT(angles); i++) {
        const double angle = angles[i] * pi / 180;
        tilt(&w, angle);
        assert_reflectance(&w, r0 + (1 - r0) * pow(1 - cos(angle), 5));
    }
    tilt(&w, 0);
    assert_reflectance(&w, r0);
    tilt(&w, pi / 2);
    assert_reflectance(&w, 1);
}

/* Fresnel's equations by angles: the mean of (sin(i - t) / sin(i + t))^2 and (tan(i - t) / tan(i + t))^2. */
static double fresnel(double angle, double ior)
{
    const double inside = asin(sin(angle) / ior);
    if (angle == 0) return ssfr_square((ior - 1) / (ior + 1));
    const double across = sin(angle - inside) / sin(angle + inside), along = tan(angle - inside) / tan(angle + inside);
    return 0.5 * (across * across + along * along);
}

static void exact_fresnel_is_a_dielectrics(void **state)
{
    static const double indices[] = {1.333, 2.385};
    const water w = begin(state);
    for (size_t k = 0; k < SSFR_COUNT(indices); k++) {
        test_twin_set(w.t, "medium.ior", "%g", indices[k]);
        for (size_t i = 0; i < SSFR_COUNT(angles); i++) {
            tilt(&w, angles[i] * pi / 180);
            assert_reflectance(&w, fresnel(angles[i] * pi / 180, indices[k]));
        }
    }
}

/* Water of index 1 is not there, at any angle: 0 / 0 lurks at 90 degrees. */
static void index_1_reflects_nothing(void **state)
{
    const water w = begin(state);
    for (double angle = 0; angle <= 180; angle += 30) {
        tilt(&w, angle * pi / 180);
        assert_reflectance(&w, 0);
    }
    for (int i = 0; i < W * H; i++)
        for (int k = 0; k < 3; k++) w.normal->data[3 * i + k] = 0; /* no normal at all */
    assert_reflectance(&w, 0);
}

/* Waves turn some normals away from the eye: they count as grazing. */
static void normals_that_face_away_reflect_all(void **state)
{
    const water w = begin(state);
    test_twin_set(w.t, "medium.ior", "1.333");
    tilt(&w, 100 * pi / 180);
    assert_reflectance(&w, 1);
    test_twin_set(w.t, "fresnel", "schlick");
    assert_reflectance(&w, 1);
}

/* What is reflected and what comes through are all: in a world of one radiance clear water is not seen. */
static void weights_sum_to_one(void **state)
{
    static const char *const forms[] = {"schlick", "exact"};
    const water w = begin(state);
    test_twin_set(w.t, "attenuation", "single");
    test_twin_set(w.t, "k", "0");
    test_twin_set(w.t, "medium.ior", "1.333");
    for (int i = 0; i < 3 * W * H; i++) w.scene->data[i] = sky[i % 3];
    ssfr_field_fill(w.thickness, 1.3);
    for (int f = 0; f < 2; f++)
        for (double angle = 0; angle < 100; angle += 23.85) {
            test_twin_set(w.t, "fresnel", "%s", forms[f]);
            tilt(&w, angle * pi / 180);
            const ssfr_field *color = run(&w);
            for (int i = 0; i < 3 * W * H; i++) assert_close(color->data[i], sky[i % 3], 4 * w.t->eps, 0);
        }
}

static void no_thickness_at_normal_incidence_shows_scene_and_sky(void **state)
{
    const water w = begin(state);
    const double f = fresnel(0, 1.333);
    test_twin_set(w.t, "medium.ior", "1.333");
    tilt(&w, 0);
    for (int i = 0; i < 3 * W * H; i++) w.scene->data[i] = 0.1 + 0.2385 * (i % 3);
    const ssfr_field *color = run(&w);
    for (int i = 0; i < 3 * W * H; i++)
        assert_close(color->data[i], w.scene->data[i] * (1 - f) + sky[i % 3] * f, 16 * w.t->eps, 0);
}

/* ---- attenuation ------------------------------------------------------------------------------------------------- */

static void beer_lambert_holds_for_each_channel(void **state)
{
    static const double absorption[3] = {2.2, 0.65, 0.45}, fluid[3] = {0.01, 0.09, 0.13}, behind[3] = {0.9, 0.5, 0.2};
    const water w = begin(state);
    test_twin_set(w.t, "gamma", "0");
    for (int i = 0; i < 3 * W * H; i++) w.scene->data[i] = behind[i % 3];
    for (int i = 0; i < W * H; i++) w.thickness->data[i] = 0.002385 * i;
    const ssfr_field *color = run(&w);
    for (int i = 0; i < 3 * W * H; i++) {
        const int k = i % 3;
        const double through = exp(-absorption[k] * w.thickness->data[i / 3]);
        assert_close(color->data[i], fluid[k] + (behind[k] - fluid[k]) * through, 16 * w.t->eps, 0);
    }
    test_twin_set(w.t, "attenuation", "single");
    test_twin_set(w.t, "k", "2.385");
    color = run(&w);
    for (int i = 0; i < 3 * W * H; i++) {
        const double through = exp(-2.385 * w.thickness->data[i / 3]);
        assert_close(color->data[i], fluid[i % 3] + (behind[i % 3] - fluid[i % 3]) * through, 16 * w.t->eps, 0);
    }
}

static void thick_water_has_its_own_colour(void **state)
{
    static const double fluid[3] = {0.01, 0.09, 0.13};
    const water w = begin(state);
    ssfr_field_fill(w.thickness, 1e4);
    const ssfr_field *color = run(&w);
    for (int i = 0; i < 3 * W * H; i++) assert_close(color->data[i], fluid[i % 3], 2 * w.t->eps, 0);
}

/* ---- refraction -------------------------------------------------------------------------------------------------- */

/* A scene whose red is the column and whose green is the row, in pixels: the picture tells where it was looked up.
 * Clear water. */
static void show_places(const water *w)
{
    test_twin_set(w->t, "attenuation", "single");
    test_twin_set(w->t, "k", "0");
    for (int i = 0; i < W * H; i++) {
        w->scene->data[3 * i] = i % W + 0.5;
        w->scene->data[3 * i + 1] = i / W + 0.5;
    }
}

static void assert_place(const test_twin *t, const ssfr_field *color, int x, int y, double at_x, double at_y)
{
    assert_close(ssfr_field_at(color, x, y)[0], ssfr_clamp(at_x, 0.5, W - 0.5), 64 * W * t->eps, 0);
    assert_close(ssfr_field_at(color, x, y)[1], ssfr_clamp(at_y, 0.5, H - 0.5), 64 * W * t->eps, 0);
}

/* gamma T n times the image's height, in pixels; a normal that leans up looks further up, in rows with lower numbers.
 * */
static void offset_is_gamma_t_n_image_heights(void **state)
{
    const water w = begin(state);
    const double n[3] = {0.48, 0.36, 0.8}, shift = 0.25 * 0.7 * H;
    show_places(&w);
    test_twin_set(w.t, "gamma", "0.25");
    ssfr_field_fill(w.thickness, 0.7);
    for (int i = 0; i < 3 * W * H; i++) w.normal->data[i] = n[i % 3];
    const ssfr_field *color = run(&w);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) assert_place(w.t, color, x, y, x + 0.5 + shift * n[0], y + 0.5 - shift * n[1]);
}

/* Three pixels and a half: the edge stands three pixels further left, with a pixel of the mean before it. */
static void edge_behind_water_is_displaced(void **state)
{
    const water w = begin(state);
    test_twin_set(w.t, "gamma", "%.17g", 3.5 / (0.6 * 0.5 * H));
    test_twin_set(w.t, "attenuation", "single");
    test_twin_set(w.t, "k", "0");
    ssfr_field_fill(w.thickness, 0.5);
    for (int i = 0; i < W * H; i++) {
        w.normal->data[3 * i] = 0.6, w.normal->data[3 * i + 2] = 0.8;
        for (int k = 0; k < 3; k++) w.scene->data[3 * i + k] = i % W >= 16;
    }
    const ssfr_field *color = run(&w);
    for (int i = 0; i < 3 * W * H; i++) {
        const int x = i / 3 % W;
        assert_close(color->data[i], x < 12 ? 0 : x > 12 ? 1 : 0.5, 64 * W * w.t->eps, 0);
    }
}

/* A slab that faces the eye, seen under angles up to 45 degrees. By Snell the ray goes on under t = asin(sin i / n):
 * after the thickness T it stands T sin t further aside and T cos t further away. */
static void snell_displaces_by_the_refracted_ray(void **state)
{
    const double ior = 1.333, thickness = 0.6;
    const water w = begin(state);
    w.t->scene.camera.tan_x = 1 / (1 - 1.0 / W);
    show_places(&w);
    test_twin_set(w.t, "refraction", "snell");
    test_twin_set(w.t, "medium.ior", "%g", ior);
    for (int k = 0; k < 2; k++) test_twin_set(w.t, k ? "sky.zenith_r" : "sky.horizon_r", "0");
    for (int k = 0; k < 2; k++) test_twin_set(w.t, k ? "sky.zenith_g" : "sky.horizon_g", "0");
    ssfr_field_fill(w.thickness, thickness);
    ssfr_field *color = test_field(W, H, 3);
    memcpy(color->data, run(&w)->data, sizeof *color->data * 3 * W * H);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            const test_ray at = test_ray_at(w.t, x, y, 1);
            const double across = sqrt(at.u * at.u + at.v * at.v), i = atan(across), inside = asin(sin(i) / ior);
            const double further = (across * -z0 + thickness * sin(inside)) / (-z0 + thickness * cos(inside));
            const double at_x = W / 2.0 * (1 + at.u * further / across / w.t->scene.camera.tan_x);
            const double at_y = H / 2.0 * (1 - at.v * further / across / w.t->scene.camera.tan_y);
            for (int k = 0; k < 2; k++) ssfr_field_at(color, x, y)[k] /= 1 - fresnel(i, ior); /* a black sky */
            assert_place(w.t, color, x, y, at_x, at_y);
        }
    assert_close(test_ray_at(w.t, W - 1, 0, 1).u, 1, 1e-12, 0);
}

static void snell_with_index_1_goes_straight_on(void **state)
{
    const water w = begin(state);
    show_places(&w);
    test_twin_set(w.t, "refraction", "snell");
    ssfr_field_fill(w.thickness, 0.6);
    const ssfr_field *color = run(&w);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) assert_place(w.t, color, x, y, x + 0.5, y + 0.5);
}

/* Columns from 20 on stand before the water: looked up there, the scene is taken straight behind instead. */
static void what_stands_before_the_water_is_not_refracted(void **state)
{
    const water w = begin(state);
    const double shift = 4;
    show_places(&w);
    test_twin_set(w.t, "gamma", "%.17g", shift / (0.6 * 0.5 * H));
    ssfr_field_fill(w.thickness, 0.5);
    for (int i = 0; i < W * H; i++) {
        w.normal->data[3 * i] = 0.6, w.normal->data[3 * i + 2] = 0.8;
        w.scene_depth->data[i] = i % W >= 20 ? -1 : -9;
    }
    const ssfr_field *color = run(&w);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < 20; x++) assert_place(w.t, color, x, y, x + 0.5 + (x < 16 ? shift : 0), y + 0.5);
    test_twin_set(w.t, "reject", "0");
    color = run(&w);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < 20; x++) assert_place(w.t, color, x, y, x + 0.5 + shift, y + 0.5);
}

/* ---- reflection and highlight ------------------------------------------------------------------------------------ */

/* Half-way between the eye and the light the highlight is k_s; turned away by an angle it falls like its cosine to the
 * alpha. */
static void highlight_is_a_power_of_the_half_angle(void **state)
{
    const double a = 125 * pi / 180, e = 40 * pi / 180, light[3] = {cos(e) * cos(a), sin(e), cos(e) * sin(a)};
    const water w = begin(state);
    test_twin_set(w.t, "specular", "0.2385");
    test_twin_set(w.t, "shininess", "30");
    test_twin_set(w.t, "light.intensity", "1.5");
    for (double angle = 0; angle < 0.5; angle += 0.2) {
        for (int i = 0; i < W * H; i++) {
            double half[3], side[3];
            view_at(w.t, i % W, i / W, half);
            for (int k = 0; k < 3; k++) half[k] += light[k];
            ssfr_normalize(half);
            ssfr_cross(half, light, side);
            ssfr_normalize(side);
            for (int k = 0; k < 3; k++) w.normal->data[3 * i + k] = cos(angle) * half[k] + sin(angle) * side[k];
        }
        const ssfr_field *color = run(&w);
        for (int i = 0; i < 3 * W * H; i++)
            assert_close(color->data[i] - 1, 1.5 * 0.2385 * pow(cos(angle), 30), 64 * w.t->eps, 0);
    }
}

/* A light behind the surface makes no highlight, however near the half-way direction is. */
static void light_from_behind_makes_no_highlight(void **state)
{
    const water w = begin(state);
    test_twin_set(w.t, "specular", "1");
    test_twin_set(w.t, "shininess", "1");
    test_twin_set(w.t, "light.azimuth_deg", "-90");
    test_twin_set(w.t, "light.elevation_deg", "10");
    const ssfr_field *color = run(&w);
    for (int i = 0; i < 3 * W * H; i++) assert_close(color->data[i], 1, 2 * w.t->eps, 0);
}

/* Straight into the sun there is no half-way direction: no highlight, and no NaN. */
static void light_straight_ahead_makes_no_highlight(void **state)
{
    static const double eye[3] = {0, 0, 0}, c[1][3] = {{0, 0, -3}};
    static const double ahead[3] = {1, 0, 0}; /* as the light of azimuth and elevation 0 */
    test_twin *t = test_twin_create(state, "composite", 33, 25);
    ssfr_field *normal = test_field(33, 25, 3);
    for (int i = 0; i < 33 * 25; i++) normal->data[3 * i + 2] = 1;
    test_twin_look(t, eye, ahead);
    test_twin_place(t, 1, c, 0.1, NULL);
    test_twin_set(t, "light.azimuth_deg", "0");
    test_twin_set(t, "light.elevation_deg", "0");
    test_twin_set(t, "k", "0");
    test_twin_set(t, "attenuation", "single");
    test_twin_set(t, "medium.ior", "1");
    test_twin_give(t, "scene_color", test_field_filled(33, 25, 3, 0.7));
    test_twin_give(t, "depth", test_field_filled(33, 25, 1, z0));
    test_twin_give(t, "normal", normal);
    const ssfr_field *color = test_twin_run(t, "color");
    assert_close(*ssfr_field_at(color, 16, 12), 0.7, 4 * t->eps, 0);
}

/* Every normal half-way between the view and a direction d of the pixel's own: there the view is mirrored to. */
static void mirror_to(const water *w, int i, const double d[3])
{
    double n[3];
    view_at(w->t, i % W, i / W, n);
    for (int k = 0; k < 3; k++) n[k] += d[k];
    ssfr_normalize(n);
    memcpy(w->normal->data + 3 * i, n, sizeof n);
}

static double reflectance_at(const water *w, int i)
{
    double v[3];
    view_at(w->t, i % W, i / W, v);
    return fresnel(acos(ssfr_dot(v, w->normal->data + 3 * i)), 1.333);
}

/* Over a black scene the picture is the sky in the mirrored direction, times F. */
static void sky_is_seen_in_the_mirrored_direction(void **state)
{
    static const double horizon[3] = {0.2, 0.4, 0.8};
    const water w = begin(state);
    test_twin_set(w.t, "medium.ior", "1.333");
    test_twin_set(w.t, "sky.zenith_r", "1");
    test_twin_set(w.t, "sky.zenith_g", "0");
    test_twin_set(w.t, "sky.zenith_b", "0");
    ssfr_field_fill(w.scene, 0);
    for (int i = 0; i < W * H; i++) {
        const double up = 0.1 + 0.8 * i / (W * H), across = sqrt(1 - up * up);
        mirror_to(&w, i, (const double[3]){across * sin(i), up, across * cos(i)});
    }
    const ssfr_field *color = run(&w);
    for (int i = 0; i < 3 * W * H; i++) {
        const double s = sqrt(0.1 + 0.8 * (i / 3) / (W * H));
        const double expected = reflectance_at(&w, i / 3) * ssfr_mix(horizon[i % 3], i % 3 == 0, s);
        assert_close(color->data[i], expected, 64 * w.t->eps, 0);
    }
}

/* A box over the water, and normals that send every view straight up: where the box is overhead the ray meets its
 * lower face, which the light over it leaves in the shade; elsewhere the sky. */
static void scene_reflected_is_what_the_ray_meets(void **state)
{
    const ssfr_solid above = {.centre = {0.4, 4, z0}, .half = {0.5, 0.5, 9}, .colour = {0.9, 0.5, 0.1},
                              .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const water w = begin(state);
    int n_box = 0;
    test_twin_set(w.t, "medium.ior", "1.333");
    for (int i = 0; i < W * H; i++) mirror_to(&w, i, (const double[3]){0, 1, 0});
    const ssfr_field *plain = run(&w);
    test_twin_set(w.t, "reflection", "scene");
    assert_true(test_difference(run(&w), plain) < 4 * w.t->eps);
    w.t->scene.solids = &above, w.t->scene.n_solids = 1;
    const ssfr_field *color = run(&w);
    for (int i = 0; i < 3 * W * H; i++) {
        const bool under = fabs(test_ray_at(w.t, i / 3 % W, 0, 1).u * -z0 - 0.4) < 0.5;
        const double f = reflectance_at(&w, i / 3), mirrored = under ? 0.45 * above.colour[i % 3] : sky[i % 3];
        assert_close(color->data[i], 1 - f + f * mirrored, 64 * w.t->eps, 0);
        n_box += under;
    }
    assert_true(n_box > 3 * 100 && n_box < 3 * W * H / 2);
    test_twin_set(w.t, "reflection", "sky");
    assert_true(test_same_bits(run(&w), plain));
}

/* The same box as a mesh, and a ramp with its slope upwards, whose lower face is the box's. */
static void solids_of_all_shapes_are_reflected(void **state)
{
    ssfr_solid above = {.centre = {0.4, 4, z0}, .half = {0.5, 0.5, 9}, .colour = {0.9, 0.5, 0.1},
                        .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    test_mesh m = test_mesh_box(0.5, 0.5, 9);
    ssfr_mesh *mesh = test_mesh_make(&m);
    const water w = begin(state);
    test_twin_set(w.t, "medium.ior", "1.333");
    for (int i = 0; i < W * H; i++) mirror_to(&w, i, (const double[3]){0, 1, 0});
    test_twin_set(w.t, "reflection", "scene");
    w.t->scene.solids = &above, w.t->scene.n_solids = 1;
    const ssfr_field *box = run(&w);
    above.shape = SSFR_MESH, above.mesh = mesh;
    assert_true(test_difference(run(&w), box) < 4 * w.t->eps);
    above.shape = SSFR_RAMP;
    assert_true(test_difference(run(&w), box) < 4 * w.t->eps);
    w.t->scene.n_solids = 0;
    assert_true(test_difference(run(&w), box) > 0.01);
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

/* A map of one value in the place of the sky, for both kinds of reflection. */
static void the_map_of_the_environment_is_reflected(void **state)
{
    static const char *const kinds[] = {"sky", "scene"};
    const water w = begin(state);
    test_twin_set(w.t, "medium.ior", "1.333");
    for (int i = 0; i < W * H; i++) mirror_to(&w, i, (const double[3]){0, 1, 0});
    w.t->scene.environment = test_field_filled(16, 8, 3, 0.3);
    for (size_t kind = 0; kind < SSFR_COUNT(kinds); kind++) {
        test_twin_set(w.t, "reflection", "%s", kinds[kind]);
        const ssfr_field *color = run(&w);
        for (int i = 0; i < 3 * W * H; i++)
            assert_close(color->data[i], 1 - 0.7 * reflectance_at(&w, i / 3), 64 * w.t->eps, 0);
    }
}

/* ---- the rest ---------------------------------------------------------------------------------------------------- */

static void pixels_without_surface_are_untouched(void **state)
{
    const water w = begin(state);
    uint64_t random = 17;
    test_twin_set(w.t, "medium.ior", "1.333");
    ssfr_field_fill(w.thickness, 0.3);
    for (int i = 0; i < 3 * W * H; i++) w.scene->data[i] = (double)(float)test_random(&random, 0, 1);
    for (int i = 0; i < W * H; i++)
        if (test_random(&random, 0, 1) < 0.5) w.depth->data[i] = -SSFR_EMPTY;
    const ssfr_field *color = run(&w);
    int n_touched = 0;
    for (int i = 0; i < 3 * W * H; i++) {
        const bool same = color->data[i] == w.scene->data[i];
        if (!ssfr_is_surface(w.depth->data[i / 3])) assert_true(same);
        else n_touched += !same;
    }
    assert_true(n_touched > W * H);
}

/* From nothing to beyond what half and single floats hold, and what is no number. */
static void pictures_are_finite_whatever_the_thickness_is(void **state)
{
    static const double extremes[] = {0, 1e-38, 65504, 1e6, 1e30, INFINITY, -1, NAN};
    static const char *const models[][2] = {
        {"gamma", "0"}, {"gamma", "1000"}, {"refraction", "snell"}, {"k", "0"}, {"attenuation", "single"}};
    const water w = begin(state);
    for (int i = 0; i < W * H; i++) w.thickness->data[i] = extremes[i % (int)SSFR_COUNT(extremes)];
    for (size_t m = 0; m < SSFR_COUNT(models); m++) {
        test_twin_set(w.t, models[m][0], "%s", models[m][1]);
        const ssfr_field *color = run(&w);
        for (int i = 0; i < 3 * W * H; i++) assert_true(isfinite(color->data[i]));
    }
}

static void without_fluid_the_scene_shows(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    ssfr_node_status status;
    const water w = begin(state);
    test_twin_place(w.t, 1, behind, 0.1, NULL);
    test_twin_give(w.t, "scene_color", w.scene);
    const ssfr_field *color = test_twin_run_if_needed(w.t, "color", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_true(test_same_bits(color, w.scene));
}

static void composite_refuses_values_out_of_range(void **state)
{
    const water w = begin(state);
    test_twin_refuses(w.t, "k", "-1", "composite.k");
    test_twin_refuses(w.t, "shininess", "0.5", "composite.shininess");
    test_twin_refuses(w.t, "gamma", "2.385e4", "composite.gamma");
    test_twin_refuses(w.t, "fresnel", "cook", "cook");
    test_twin_refuses(w.t, "medium.ior", "0.9", "medium.ior");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(schlick_is_its_formula),
        TEST_TWINS(exact_fresnel_is_a_dielectrics),
        TEST_TWINS(index_1_reflects_nothing),
        TEST_TWINS(normals_that_face_away_reflect_all),
        TEST_TWINS(weights_sum_to_one),
        TEST_TWINS(no_thickness_at_normal_incidence_shows_scene_and_sky),
        TEST_TWINS(beer_lambert_holds_for_each_channel),
        TEST_TWINS(thick_water_has_its_own_colour),
        TEST_TWINS(offset_is_gamma_t_n_image_heights),
        TEST_TWINS(edge_behind_water_is_displaced),
        TEST_TWINS(snell_displaces_by_the_refracted_ray),
        TEST_TWINS(snell_with_index_1_goes_straight_on),
        TEST_TWINS(what_stands_before_the_water_is_not_refracted),
        TEST_TWINS(highlight_is_a_power_of_the_half_angle),
        TEST_TWINS(light_from_behind_makes_no_highlight),
        TEST_TWINS(light_straight_ahead_makes_no_highlight),
        TEST_TWINS(sky_is_seen_in_the_mirrored_direction),
        TEST_TWINS(scene_reflected_is_what_the_ray_meets),
        TEST_TWINS(solids_of_all_shapes_are_reflected),
        TEST_TWINS(the_map_of_the_environment_is_reflected),
        TEST_TWINS(pixels_without_surface_are_untouched),
        TEST_TWINS(pictures_are_finite_whatever_the_thickness_is),
        TEST_TWINS(without_fluid_the_scene_shows),
        TEST_TWINS(composite_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

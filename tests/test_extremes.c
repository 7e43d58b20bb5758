/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_extremes.c: views, scenes and parameters at the edge: every image stays finite, and the backends agree. */
#include "tests/frames.h"

#include "gl/gl.h"

/* ---- scenes and views -------------------------------------------------------------------------------------------- */

static const double place[3] = {0.35, 0.62, 1.25}, aim[3] = {0, 0.2, 0};

static void usual(test_scene *s)
{
    test_scene_create_usual(s, 96, 64);
}

static void no_particle_in_the_frustum(test_scene *s)
{
    usual(s);
    test_scene_look(s, place, (const double[3]){3, 2, 1}, 30, 96, 64);
}

static void all_behind_the_eye(test_scene *s)
{
    usual(s);
    test_scene_look(s, place, (const double[3]){0.7, 1, 3}, 45, 96, 64);
}

static void a_particle_that_contains_the_eye(test_scene *s)
{
    test_scene_create(s, 3, (const double[]){0, 0.5, 0, 0.1, 0.5, -0.9, -0.3, 0.6, -1.5}, 0.2);
    test_scene_look(s, (const double[3]){0.01, 0.52, 0.02}, (const double[3]){0, 0.45, -1}, 60, 96, 64);
}

static void an_eye_deep_in_the_fluid(test_scene *s)
{
    usual(s);
    test_scene_look(s, (const double[3]){0.013, 0.21, 0.007}, (const double[3]){1, 0.3, -0.2}, 90, 96, 64);
    s->scene.camera.near = 1e-3;
}

static void radii_under_a_hundredth_of_a_pixel(test_scene *s)
{
    usual(s);
    s->particles->radius = 0.008 * 2 * tan(acos(-1) / 8) / 64; /* at 1 m */
}

static void radii_over_the_whole_screen(test_scene *s)
{
    usual(s);
    s->particles->radius = 2;
    test_scene_look(s, (const double[3]){0, 1, 6}, (const double[3]){0, 0.2, 0}, 15, 96, 64);
}

static void one_pixel(test_scene *s)
{
    usual(s);
    test_scene_look(s, place, aim, 45, 1, 1);
}

static void one_row(test_scene *s)
{
    usual(s);
    test_scene_look(s, place, aim, 0.5, 4096, 1);
}

static void one_column(test_scene *s)
{
    usual(s);
    test_scene_look(s, place, aim, 120, 1, 4096);
}

static void odd_sizes(test_scene *s)
{
    usual(s);
    test_scene_look(s, place, aim, 45, 37, 23);
}

static void a_view_of_1_degree(test_scene *s)
{
    usual(s);
    test_scene_look(s, (const double[3]){10, 15, 40}, (const double[3]){0, 0.2, 0}, 1, 96, 64);
}

static void a_view_of_170_degrees(test_scene *s)
{
    usual(s);
    test_scene_look(s, (const double[3]){0.1, 0.5, 0.45}, (const double[3]){0, 0.2, 0}, 170, 96, 64);
}

static void a_near_plane_of_a_micrometre(test_scene *s)
{
    usual(s);
    s->scene.camera.near = 1e-6, s->scene.camera.far = 1e12;
}

static void a_near_plane_that_cuts_the_fluid(test_scene *s)
{
    usual(s);
    s->scene.camera.near = 1.2, s->scene.camera.far = 1.2000001;
}

static void an_eye_a_kilometre_away(test_scene *s)
{
    usual(s);
    test_scene_look(s, (const double[3]){350, 620, 1250}, aim, 0.05, 96, 64);
}

static void particles_that_all_stand_at_one_place(test_scene *s)
{
    double positions[3 * 40];
    for (int i = 0; i < 120; i++) positions[i] = 0.2385;
    test_scene_create(s, 40, positions, 0.05);
    test_scene_look(s, place, aim, 45, 96, 64);
}

static void an_eye_inside_a_solid(test_scene *s)
{
    usual(s);
    for (int k = 0; k < 3; k++) s->solids[0].centre[k] = place[k] + 0.01;
}

static void a_view_straight_down(test_scene *s)
{
    usual(s);
    /* Not over a corner of the tiles: there both sides of an edge would fall on the middles of pixels. */
    test_scene_look(s, (const double[3]){0.013, 2, 0.007}, (const double[3]){0.013, 0.2, 0.0069999}, 45, 96, 64);
}

static void a_floor_through_the_eye(test_scene *s)
{
    usual(s);
    s->scene.floor = place[1];
}

static void no_floor(test_scene *s)
{
    usual(s);
    s->scene.floor = -INFINITY;
}

/* ---- water that moves -------------------------------------------------------------------------------------------- */

/* What moves at `speed` along x, of the density at rest; the frame has a time. */
static void set_moving(test_scene *s, double speed)
{
    ssfr_particles *p = s->particles;
    assert_int_equal(ssfr_alloc(&p->velocity, 3 * p->n, sizeof *p->velocity, "velocities"), SSFR_OK);
    assert_int_equal(ssfr_alloc(&p->density, p->n, sizeof *p->density, "densities"), SSFR_OK);
    for (size_t i = 0; i < p->n; i++) {
        p->velocity[3 * i] = (float)speed;
        p->density[i] = (float)SSFR_REST_DENSITY;
    }
    s->scene.timed = true;
}

static void at_rest(test_scene *s)
{
    usual(s);
    set_moving(s, 0);
}

static void at_1_m_a_second(test_scene *s)
{
    usual(s);
    set_moving(s, 1);
}

static void at_1e30_m_a_second(test_scene *s)
{
    usual(s);
    set_moving(s, 1e30);
}

/* Each other particle is foam. */
static void a_thousand_large_particles_at_one_place(test_scene *s)
{
    static const double positions[3 * 1000];
    test_scene_create(s, 1000, positions, 1);
    set_moving(s, 0);
    for (size_t i = 0; i < s->particles->n; i += 2) s->particles->velocity[3 * i] = 2;
    test_scene_look(s, (const double[3]){0, 0, 6}, (const double[3]){0, 0, 0}, 45, 24, 16);
}

/* From 1 m to 100 km, each row at 1.5 of the distance of the one before; the outer ones are foam, some are spray. */
static void from_1_m_to_100_km(test_scene *s)
{
    enum { ROWS = 29, COLUMNS = 16 };
    static double positions[ROWS * COLUMNS][3];
    for (int i = 0; i < ROWS * COLUMNS; i++) {
        const double distance = pow(10, 5.0 * (i / COLUMNS) / (ROWS - 1)), slope = (i % COLUMNS - 7.5) / 12;
        memcpy(positions[i], (double[3]){slope * distance, (0.02 * (i / COLUMNS) - 0.3) * distance, -distance},
               sizeof positions[i]);
    }
    test_scene_create(s, ROWS * COLUMNS, positions[0], 0.25);
    set_moving(s, 0);
    for (size_t i = 0; i < s->particles->n; i++) {
        s->particles->velocity[3 * i] = (float)(i % COLUMNS) / 8;
        if (i % 16 == 5) s->particles->density[i] = 300;
    }
    test_scene_look(s, (const double[3]){0, 0, 0}, (const double[3]){0, 0, -1}, 45, 96, 64);
    s->scene.camera.far = 1e6;
    s->scene.floor = -INFINITY;
}

typedef struct extreme {
    const char *name;
    void (*create)(test_scene *);
    const char *settings[6], *pipeline; /* NULL: vanderlaan2009 */
} extreme;

#define SCENE(name) {#name, name, {NULL}, NULL}
#define PARAMS(...) {#__VA_ARGS__, usual, {__VA_ARGS__, NULL}, NULL}
#define MOVING(name, ...) {#name ": " #__VA_ARGS__, name, {__VA_ARGS__, NULL}, "bagar2010"}

static const extreme views[] = {
    SCENE(no_particle_in_the_frustum), SCENE(all_behind_the_eye), SCENE(a_particle_that_contains_the_eye),
    SCENE(an_eye_deep_in_the_fluid), SCENE(radii_under_a_hundredth_of_a_pixel), SCENE(radii_over_the_whole_screen),
    SCENE(one_pixel), SCENE(one_row), SCENE(one_column), SCENE(odd_sizes), SCENE(a_view_of_1_degree),
    SCENE(a_view_of_170_degrees), SCENE(a_near_plane_of_a_micrometre), SCENE(a_near_plane_that_cuts_the_fluid),
    SCENE(an_eye_a_kilometre_away), SCENE(particles_that_all_stand_at_one_place), SCENE(an_eye_inside_a_solid),
    SCENE(a_view_straight_down), SCENE(a_floor_through_the_eye), SCENE(no_floor),
    {"odd sizes at an eighth", odd_sizes, {"downsample.factor=8", NULL}, NULL},
    {"one pixel at an eighth", one_pixel, {"downsample.factor=8", NULL}, NULL},
};

static const extreme params[] = {
    PARAMS("curvature_flow.iterations=0"),
    PARAMS("curvature_flow.iterations=2000"),
    PARAMS("curvature_flow.step=100"),
    PARAMS("curvature_flow.step=1e-6"),
    PARAMS("curvature_flow.dt=1e12"),
    PARAMS("curvature_flow.depth_falloff=0", "normals.depth_falloff=0", "upsample.depth_falloff=0"),
    PARAMS("curvature_flow.depth_falloff=1e6", "normals.depth_falloff=1e6", "upsample.depth_falloff=1e6"),
    PARAMS("medium.ior=1"),
    PARAMS("medium.ior=1", "composite.fresnel=exact", "composite.refraction=snell"),
    PARAMS("medium.ior=4", "composite.fresnel=exact", "composite.refraction=snell"),
    PARAMS("medium.absorption_r=1e6", "medium.absorption_g=1e6", "medium.absorption_b=1e6"),
    PARAMS("medium.absorption_r=0", "medium.absorption_g=0", "medium.absorption_b=0"),
    PARAMS("composite.attenuation=single", "composite.k=1e6"),
    PARAMS("composite.gamma=0"),
    PARAMS("composite.gamma=1000"),
    PARAMS("composite.shininess=1", "composite.specular=1"),
    PARAMS("composite.shininess=1e5"),
    PARAMS("sphere_depth.radius_scale=0.01", "thickness.radius_scale=0.01"),
    PARAMS("sphere_depth.radius_scale=100", "sphere_depth.splat=quad"),
    PARAMS("thickness.radius_scale=100", "thickness.splat=exact"),
    PARAMS("sphere_depth.splat=point", "sphere_depth.max_point_px=1"),
    PARAMS("thickness.scale=0"),
    PARAMS("thickness.storage=half", "thickness.splat=exact"),
    PARAMS("noise_normals.height=0.3", "surface_noise.frequency=0"),
    PARAMS("noise_normals.height=0.3", "surface_noise.sharpness=64"),
    PARAMS("noise_normals.height=0.3", "surface_noise.depth_falloff=1e6"),
    PARAMS("noise_foam.strength=1", "noise_foam.threshold=0", "noise_foam.softness=0"),
    PARAMS("noise_foam.strength=1", "noise_foam.softness=1e3", "surface_noise.radius_scale=3"),
    PARAMS("noise_foam.strength=1", "noise_foam.blend=over", "surface_noise.sharpness=0"),
    PARAMS("light.elevation_deg=90"),
    PARAMS("light.elevation_deg=-90", "light.intensity=0"),
    PARAMS("floor.tile=1e6"),
    PARAMS("floor.tile=1e-6"),
    PARAMS("floor.haze=1e-6"),
    PARAMS("floor.haze=1e9"),
};

static const extreme moving[] = {
    MOVING(at_rest, NULL),
    MOVING(at_rest, "weber.threshold=0"),
    MOVING(at_rest, "weber.threshold=0", "weber.transition=weber"),
    MOVING(at_rest, "sparse.density_threshold=1e9"),
    MOVING(at_rest, "sphere_depth.off=1", "layer_thickness.off=1", "weber.threshold=0"),
    MOVING(at_1e30_m_a_second, NULL),
    MOVING(at_1e30_m_a_second, "foam_depth.plane=view", "foam_thickness.plane=view"),
    MOVING(at_1e30_m_a_second, "sparse.density_threshold=1e9"),
    MOVING(at_1e30_m_a_second, "weber.threshold=1e308"),
    MOVING(at_1e30_m_a_second, "weber.threshold=1e308", "weber.transition=weber"),
    /* Half of each particle is foam: it is exactly where the water is. */
    MOVING(at_1_m_a_second, "weber.threshold=1000", "weber.transition=weber"),
    MOVING(at_1_m_a_second, "weber.threshold=1000", "weber.transition=weber", "sphere_depth.splat=exact",
           "layer_thickness.layers=fragment", "foam_thickness.front=fragment"),
    MOVING(at_1_m_a_second, "adaptive_flow.depth_falloff=0", "layer_composite.depth_thresh=0"),
    MOVING(at_1_m_a_second, "adaptive_flow.depth_falloff=1e6", "layer_composite.depth_thresh=1e6"),
    MOVING(at_1_m_a_second, "adaptive_flow.step=100"),
    MOVING(at_1_m_a_second, "adaptive_flow.step=100", "adaptive_flow.unstable=substep"),
    MOVING(from_1_m_to_100_km, NULL),
    MOVING(from_1_m_to_100_km, "sphere_depth.splat=exact", "layer_thickness.splat=exact"),
};

static const extreme unstable[] = {
    PARAMS("curvature_flow.unstable=allow", "curvature_flow.step=2", "curvature_flow.iterations=500"),
    PARAMS("curvature_flow.unstable=allow", "curvature_flow.step=100"),
    PARAMS("curvature_flow.unstable=allow", "curvature_flow.step=100", "curvature_flow.off_axis=1"),
    PARAMS("curvature_flow.unstable=allow", "curvature_flow.dt=1e12"),
    PARAMS("noise_normals.height=100", "surface_noise.frequency=64"),
    PARAMS("composite.specular=100", "light.intensity=1000"),
};

/* ---- finite, and the same on both backends ----------------------------------------------------------------------- */

static void assert_finite(const ssfr_graph *graph, const char *name)
{
    for (int i = 0; ssfr_graph_slot_at(graph, i); i++) {
        const char *slot = ssfr_graph_slot_at(graph, i);
        ssfr_field *field = test_graph_read(graph, slot);
        const int n = field->w * field->h * field->c;
        for (int k = 0; k < n; k++)
            if (!isfinite(field->data[k])) fail_msg("%s: value %d of %s is %g", name, k, slot, field->data[k]);
        ssfr_field_destroy(&field);
    }
}

/* The picture of an extreme, with every image made and found finite. */
static ssfr_field *draw(const extreme *e, ssfr_gl *gl, const ssfr_scene *scene, const char *splat)
{
    ssfr_graph *graph = test_graph(ssfr_pipeline_find(e->pipeline ? e->pipeline : "vanderlaan2009"), gl);
    if (splat)
        for (int i = 0; i < 3; i++) {
            static const char *const keys[] = {"sphere_depth.splat", "thickness.splat", "surface_noise.splat"};
            assert_int_equal(ssfr_graph_set(graph, keys[i], splat), SSFR_OK);
        }
    test_graph_set(graph, e->settings);
    ssfr_graph_want_all(graph, true);
    ssfr_field *picture = test_graph_picture(graph, scene, "color", false);
    assert_finite(graph, e->name);
    ssfr_graph_destroy(&graph);
    return picture;
}

static void assert_agree(const extreme *extremes, size_t n, const char *splat, ssfr_gl *gl)
{
    for (size_t i = 0; i < n; i++) {
        test_scene s;
        extremes[i].create(&s);
        ssfr_field *cpu = draw(&extremes[i], NULL, &s.scene, splat), *gpu = draw(&extremes[i], gl, &s.scene, splat);
        const double psnr = test_psnr(gpu, cpu);
        if (!(psnr > 45)) fail_msg("%s, %s: %g dB", extremes[i].name, splat ? splat : "", psnr);
        ssfr_field_destroy(&gpu);
        ssfr_field_destroy(&cpu);
        test_scene_destroy(&s);
    }
}

/* With GL NULL the CPU twins are compared with themselves: this finds what is not finite without a GPU. */
static void extreme_views_are_finite_and_agree(void **state)
{
    ssfr_gl *gl = test_backend(state);
    static const char *const forms[] = {"point", "quad", "exact"};
    for (size_t i = 0; i < SSFR_COUNT(forms); i++) assert_agree(views, SSFR_COUNT(views), forms[i], gl);
}

static void extreme_parameters_are_finite_and_agree(void **state)
{
    assert_agree(params, SSFR_COUNT(params), NULL, test_backend(state));
}

static void extremes_of_what_moves_are_finite_and_agree(void **state)
{
    assert_agree(moving, SSFR_COUNT(moving), NULL, test_backend(state));
}

/* 500 chords of 2 m, a hundredfold: 100 km of water. Halves end at 65504. */
static void a_picture_of_more_thickness_than_halves_hold_is_that_of_floats(void **state)
{
    ssfr_gl *gl = test_backend(state);
    static const char *const storages[] = {"layer_thickness.storage=half", "layer_thickness.storage=float"};
    ssfr_field *pictures[2];
    test_scene s;
    a_thousand_large_particles_at_one_place(&s);
    for (int k = 0; k < 2; k++) {
        ssfr_graph *graph = test_graph(ssfr_pipeline_find("bagar2010"), gl);
        test_graph_set(graph, (const char *[]){storages[k], "layer_thickness.scale=100", NULL});
        pictures[k] = test_graph_picture(graph, &s.scene, "color", false);
        ssfr_field *water = test_graph_read(graph, "thickness_back");
        double most = 0;
        for (int i = 0; i < water->w * water->h; i++) most = fmax(most, water->data[i]);
        assert_true(k == 0 ? most >= 65504 : most > 9e4 && most < 1.01e5);
        ssfr_field_destroy(&water);
        ssfr_graph_destroy(&graph);
    }
    assert_true(test_psnr(pictures[0], pictures[1]) > 50);
    for (int k = 0; k < 2; k++) ssfr_field_destroy(&pictures[k]);
    test_scene_destroy(&s);
}

/* Nothing has changed between two frames of one time: neither does the foam. */
static void a_time_step_of_zero_changes_nothing(void **state)
{
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("bagar2010"), test_backend(state));
    test_scene s, again;
    at_1_m_a_second(&s), at_1_m_a_second(&again);
    test_graph_set(graph, (const char *[]){"weber.threshold=1000", "weber.fade_in_min=0", NULL});
    ssfr_field *first = test_graph_picture(graph, &s.scene, "color", false);
    ssfr_field *second = test_graph_picture(graph, &again.scene, "color", false);
    assert_int_equal(test_graph_node(graph, "weber")->status, SSFR_RAN);
    assert_false(test_graph_node(graph, "weber")->kept);
    assert_int_equal(test_graph_node(graph, "foam_depth")->status, SSFR_RAN);
    assert_int_equal(test_n_different(first, second), 0);
    ssfr_field_destroy(&first), ssfr_field_destroy(&second);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s), test_scene_destroy(&again);
}

static void what_is_beyond_all_bounds_stays_finite(void **state)
{
    ssfr_gl *gl = test_backend(state);
    for (size_t i = 0; i < SSFR_COUNT(unstable); i++) {
        test_scene s;
        unstable[i].create(&s);
        ssfr_field_destroy(&(ssfr_field *){draw(&unstable[i], gl, &s.scene, NULL)});
        test_scene_destroy(&s);
    }
}

/* ---- far from the origin ----------------------------------------------------------------------------------------- */

/* The usual scene moved by whole periods of the floor. */
static void create_far(test_scene *s, const double away[3])
{
    double eye[3], target[3], middle[3];
    for (int k = 0; k < 3; k++)
        eye[k] = away[k] + place[k], target[k] = away[k] + aim[k], middle[k] = away[k] + (double[3]){0, 0.22, 0}[k];
    test_scene_create_block(s, (const int[3]){12, 6, 6}, middle, 0.04);
    test_scene_look(s, eye, target, 45, 96, 64);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) s->solids[i].centre[k] += away[k];
    s->scene.floor = away[1];
}

static void a_thousand_kilometres_from_the_origin_the_picture_is_the_same(void **state)
{
    static const double places[][3] = {{1e6, 0, 0}, {-8e5, 1e6, 4e5}, {1e6, -1e6, 1e6}};
    ssfr_gl *gl = test_backend(state);
    const extreme plain = {"far", usual, {"noise_normals.height=0", NULL}, NULL};
    test_scene s;
    create_far(&s, (const double[3]){0, 0, 0});
    ssfr_field *expected = draw(&plain, gl, &s.scene, NULL);
    test_scene_destroy(&s);
    for (size_t i = 0; i < SSFR_COUNT(places); i++) {
        create_far(&s, places[i]);
        ssfr_field *got = draw(&plain, gl, &s.scene, NULL);
        if (!(test_psnr(got, expected) > 50)) fail_msg("place %zu: %g dB", i, test_psnr(got, expected));
        ssfr_field_destroy(&got);
        test_scene_destroy(&s);
    }
    ssfr_field_destroy(&expected);
}

/* ---- large ------------------------------------------------------------------------------------------------------- */

static void an_image_of_8192_by_8192_pixels_is_finite(void **state)
{
    if (!getenv("SSFR_BIG")) skip();
    ssfr_gl *gl = test_backend(state);
    const extreme large = {"large", usual, {NULL}, NULL};
    test_scene s;
    usual(&s);
    test_scene_look(&s, place, aim, 45, 8192, 8192);
    ssfr_field_destroy(&(ssfr_field *){draw(&large, gl, &s.scene, "quad")});
    test_scene_destroy(&s);
}

static void more_particles_than_shaders_can_read_are_refused(void **state)
{
    (void)state;
    if (!getenv("SSFR_BIG")) skip();
    ssfr_gl *gl = test_shared_gl();
    GLint64 most = 0; /* bytes */
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK);
    if (most > 1 << 28) skip();
    const size_t n = (size_t)most / (3 * sizeof(float)) + 1;
    double *positions = calloc(3 * n, sizeof *positions);
    test_scene s;
    assert_non_null(positions);
    for (size_t i = 0; i < 3 * n; i++) positions[i] = (double)(i % 1009) / 1009;
    test_scene_create(&s, n, positions, 0.01);
    free(positions);
    test_scene_look(&s, place, aim, 45, 64, 48);
    ssfr_graph *graph = test_graph(ssfr_pipeline_at(0), gl);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_run(graph, &s.scene, NULL), "particles: shaders of this GPU read");
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_BOTH(extreme_views_are_finite_and_agree),
        ON_BOTH(extreme_parameters_are_finite_and_agree),
        ON_BOTH(extremes_of_what_moves_are_finite_and_agree),
        ON_BOTH(a_picture_of_more_thickness_than_halves_hold_is_that_of_floats),
        ON_BOTH(a_time_step_of_zero_changes_nothing),
        ON_BOTH(what_is_beyond_all_bounds_stays_finite),
        ON_BOTH(a_thousand_kilometres_from_the_origin_the_picture_is_the_same),
        ON_BOTH(an_image_of_8192_by_8192_pixels_is_finite),
        cmocka_unit_test(more_particles_than_shaders_can_read_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_shared_gl_destroy);
}

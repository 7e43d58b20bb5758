/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_inspect.c: what a frame tells by itself: bounds that can be left, hashes of every bit, lists of what was left
 * out. */
#include "experiments/inspect.h"
#include "tests/frames.h"

enum { W = 64, H = 48 };

static double most = 0.5, added = 0; /* m of fluid, brightness of spray: the same at every pixel */
static ssfr_field lengths = {.w = 1, .h = 1, .c = 1, .data = &most}, spray = {.w = 1, .h = 1, .c = 1, .data = &added};
static const ssfr_bounds bounds = {
    .nearest = -2, .farthest = -5, .brightest = 1.5, .water = &lengths, .foam = &lengths, .spray = &spray};

/* What one value among good ones makes of an image of a slot. */
static ssfr_inspected with(const char *slot, int c, double good, double value)
{
    ssfr_inspected inspected = {.finite = true, .bounded = true};
    ssfr_field *image = NULL;
    assert_int_equal(ssfr_field_create(&image, 5, 4, c), SSFR_OK);
    ssfr_field_fill(image, good);
    image->data[13] = value;
    ssfr_inspect_image(&inspected, slot, image, &bounds);
    ssfr_field_destroy(&image);
    return inspected;
}

static void assert_bounded(const char *slot, int c, double good, double value, bool finite, bool bounded)
{
    const ssfr_inspected inspected = with(slot, c, good, value);
    if (inspected.finite != finite || inspected.bounded != bounded)
        fail_msg("%s with %g: finite %d, bounded %d", slot, value, inspected.finite, inspected.bounded);
}

static void a_surface_is_where_there_are_particles(void **state)
{
    (void)state;
    static const char *const slots[] = {"fluid_depth", "low_depth", "smooth_depth", "surface_depth", "foam_depth"};
    for (size_t i = 0; i < SSFR_COUNT(slots); i++) {
        assert_bounded(slots[i], 1, -3, -2.00001, true, true);
        assert_bounded(slots[i], 1, -3, -1.99, true, false);
        assert_bounded(slots[i], 1, -3, -5.00001, true, true);
        assert_bounded(slots[i], 1, -3, -5.01, true, false);
        assert_bounded(slots[i], 1, -3, -SSFR_EMPTY, true, true);
        assert_bounded(slots[i], 1, -3, (float)-SSFR_EMPTY, true, true);
        assert_bounded(slots[i], 1, -3, NAN, false, false);
    }
    assert_bounded("surface_depth", 1, -3, 1, true, false);
    assert_bounded("surface_depth", 1, -3, -INFINITY, false, true); /* as good as empty, but not finite */
    assert_bounded("scene_depth", 1, -3, -1e4, true, true);
}

static void lengths_of_fluid_are_of_its_particles(void **state)
{
    (void)state;
    static const char *const slots[] = {"thickness", "thickness_back", "thickness_front", "foam_thickness",
                                        "foam_front"};
    for (size_t i = 0; i < SSFR_COUNT(slots); i++) {
        assert_bounded(slots[i], 1, 0.2, 0, true, true);
        assert_bounded(slots[i], 1, 0.2, 0.5, true, true);
        assert_bounded(slots[i], 1, 0.2, 0.501, true, false);
        assert_bounded(slots[i], 1, 0.2, -1e-9, true, false);
        assert_bounded(slots[i], 1, 0.2, NAN, false, false);
        assert_bounded(slots[i], 1, 0.2, INFINITY, false, false);
    }
    most = INFINITY;
    assert_bounded("thickness", 1, 0.2, INFINITY, false, true);
    most = 0.5;
}

static void the_picture_is_within_what_there_is_to_be_seen(void **state)
{
    (void)state;
    assert_bounded("color", 3, 0.5, 1.5, true, true);
    assert_bounded("color", 3, 0.5, 1.51, true, false);
    assert_bounded("color", 3, 0.5, 0, true, true);
    assert_bounded("color", 3, 0.5, -0.001, true, false);
    assert_bounded("color", 3, 0.5, NAN, false, false);
    assert_bounded("color", 3, 0.5, INFINITY, false, false);
    added = 2;
    assert_bounded("color", 3, 0.5, 3.5, true, true);
    assert_bounded("color", 3, 0.5, 3.51, true, false);
    added = 0;
    assert_bounded("normal", 3, 0.5, -1, true, true);
    assert_bounded("normal", 3, 0.5, NAN, false, false);
}

/* Three particles of 0.1 m, the nearest 1.25 m and the farthest 3.5 m before the eye. */
static void create_three(test_scene *s)
{
    static const double places[] = {0, 0, 0, 0.3, 0.1, -1.5, 0, 0.2, 0.75};
    test_scene_create(s, 3, places, 0.1);
    test_scene_look(s, (const double[3]){0, 0, 2}, (const double[3]){0, 0, 0}, 45, W, H);
}

static ssfr_bounds bounds_of(ssfr_graph *graph, const ssfr_scene *scene, const ssfr_field *behind)
{
    ssfr_bounds b;
    assert_int_equal(ssfr_graph_run(graph, scene, NULL), SSFR_OK);
    assert_int_equal(ssfr_inspect_bounds(&b, graph, scene, behind), SSFR_OK);
    return b;
}

static double brightest_of(ssfr_graph *graph, const ssfr_scene *scene, const ssfr_field *behind)
{
    ssfr_bounds b = bounds_of(graph, scene, behind);
    ssfr_bounds_clear(&b);
    assert_null(b.water);
    return b.brightest;
}

static double largest_of(const ssfr_field *field)
{
    double largest = -INFINITY;
    for (int i = 0; i < field->w * field->h; i++) largest = fmax(largest, field->data[i]);
    return largest;
}

static void bounds_are_those_of_particles_parameters_and_scene(void **state)
{
    (void)state;
    test_scene s;
    create_three(&s);
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), NULL);
    test_graph_set(graph, (const char *[]){"noise_foam.color_g=0.5", "composite.specular=0.25", NULL});
    ssfr_field *behind = test_image(2, 2, 3, 0);
    ssfr_bounds b = bounds_of(graph, &s.scene, behind);
    assert_close(b.nearest, -1.25 + 0.1, 1e-6, 0);
    assert_close(b.farthest, -3.5 - 0.1, 1e-6, 0);
    assert_close(b.brightest, 1 + 0.5 + 0.25, 1e-12, 0);
    ssfr_bounds_clear(&b);
    test_graph_set(graph, (const char *[]){"sphere_depth.radius_scale=2", "light.intensity=3", NULL});
    b = bounds_of(graph, &s.scene, behind);
    assert_close(b.nearest, -1.25 + 0.2, 1e-6, 0);
    assert_close(b.brightest, 3 + 3 * (0.5 + 0.25), 1e-12, 0);
    ssfr_bounds_clear(&b);
    test_graph_set(graph, (const char *[]){"sphere_depth.radius_scale=100", NULL}); /* around the eye */
    b = bounds_of(graph, &s.scene, behind);
    assert_true(b.nearest == 0);
    ssfr_bounds_clear(&b);
    test_graph_set(graph, (const char *[]){"sky.zenith_b=7", "medium.color_r=5", NULL});
    assert_close(brightest_of(graph, &s.scene, behind), 7 + 3 * 0.75, 1e-12, 0);
    behind->data[7] = 11;
    assert_close(brightest_of(graph, &s.scene, behind), 11 + 3 * 0.75, 1e-12, 0);
    s.scene.environment = behind;
    assert_close(brightest_of(graph, &s.scene, NULL), 11 + 3 * 0.75, 1e-12, 0);
    ssfr_field_destroy(&behind);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* Each water of 0.2 m, and where halves end before that, of any length. */
static void lengths_are_bounded_by_the_particles_over_a_pixel(void **state)
{
    (void)state;
    test_scene s;
    create_three(&s);
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), NULL);
    ssfr_bounds b = bounds_of(graph, &s.scene, NULL);
    assert_close(largest_of(b.water), 3 * 0.2, 1e-6, 0); /* behind each other, or nearly */
    assert_close(*ssfr_field_at(b.water, 0, 0), 0, 0, 0);
    assert_close(largest_of(b.foam), 0, 0, 0);
    ssfr_bounds_clear(&b);
    test_graph_set(graph, (const char *[]){"thickness.radius_scale=1.5", "thickness.scale=2", NULL});
    b = bounds_of(graph, &s.scene, NULL);
    assert_close(largest_of(b.water), 3 * 0.2 * 2 / (1.5 * 1.5), 1e-6, 0);
    ssfr_bounds_clear(&b);
    s.particles->radius = 400;
    test_graph_set(graph, (const char *[]){"thickness.scale=100", "thickness.storage=half", NULL});
    b = bounds_of(graph, &s.scene, NULL);
    assert_true(isinf(largest_of(b.water)));
    ssfr_bounds_clear(&b);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* Its quads reach nearer than its spheres; spray adds up, where it is. */
static void foam_may_lean_out_of_its_spheres_and_spray_adds_to_the_picture(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    create_three(&s);
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("bagar2010"), gl);
    test_graph_set(graph, (const char *[]){"foam_depth.stretch=4", "spray.color_b=2", "spray.strength=3", NULL});
    ssfr_bounds b = bounds_of(graph, &s.scene, NULL);
    assert_close(b.leaning, 0.1 * (sqrt(17) - 1), 1e-12, 0);
    assert_close(largest_of(b.spray), 0, 0, 0);
    ssfr_inspected inspected = {.finite = true, .bounded = true};
    ssfr_field *image = test_image(1, 1, 1, b.nearest + 0.9 * b.leaning);
    ssfr_inspect_image(&inspected, "foam_depth", image, &b);
    assert_true(inspected.bounded);
    ssfr_inspect_image(&inspected, "fluid_depth", image, &b);
    assert_false(inspected.bounded);
    ssfr_bounds_clear(&b);
    float thin[3] = {300, 300, (float)SSFR_REST_DENSITY};
    s.particles->density = thin;
    s.particles->serial++;
    b = bounds_of(graph, &s.scene, NULL);
    assert_close(largest_of(b.spray), 2 * 3 * 2, 1e-9, 0);
    assert_close(*ssfr_field_at(b.spray, 0, 0), 0, 0, 0);
    ssfr_bounds_clear(&b);
    s.particles->density = NULL;
    ssfr_field_destroy(&image);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void without_particles_no_surface_is_bounded(void **state)
{
    (void)state;
    test_scene s;
    test_scene_create(&s, 0, NULL, 0.1);
    test_scene_look(&s, (const double[3]){0, 0, 2}, (const double[3]){0, 0, 0}, 45, W, H);
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), NULL);
    for (int k = 0; k < 2; k++) {
        ssfr_bounds b = bounds_of(graph, &s.scene, NULL);
        assert_true(b.farthest > b.nearest);
        assert_close(largest_of(b.water), 0, 0, 0);
        ssfr_bounds_clear(&b);
        s.scene.particles = NULL;
    }
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* Steps beyond what is stable leave the splats' depths, but not the space in which there are particles. */
static void smoothing_is_bounded_by_what_it_smooths(void **state)
{
    ssfr_gl *gl = test_backend(state);
    static const char *const steps[] = {"curvature_flow.step=0.9", "curvature_flow.step=100"};
    test_scene s;
    test_scene_create_usual(&s, W, H);
    for (int k = 0; k < 2; k++) {
        ssfr_graph *graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), gl);
        ssfr_inspected inspected;
        test_graph_set(graph, (const char *[]){steps[k], "curvature_flow.unstable=allow", NULL});
        assert_int_equal(ssfr_inspect_frame(&inspected, graph, &s.scene, NULL), SSFR_OK);
        assert_int_equal(inspected.bounded, k == 0);
        ssfr_graph_destroy(&graph);
    }
    test_scene_destroy(&s);
}

/* On both backends, with all pipelines; and what is asked for afterwards is what was asked for before. */
static void usual_frames_are_finite_and_bounded(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, W, H);
    for (int p = 0; ssfr_pipeline_at(p); p++)
        for (int keep_all = 0; keep_all < 2; keep_all++) {
            const ssfr_run_options run = {.keep_all = keep_all};
            ssfr_graph *graph = test_graph(ssfr_pipeline_at(p), gl);
            ssfr_inspected inspected;
            assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
            const ssfr_report *report = ssfr_graph_report(graph);
            char before[256], after[256];
            ssfr_inspect_left_out(report->n_nodes, report->nodes, before, sizeof before);
            assert_int_equal(ssfr_inspect_frame(&inspected, graph, &s.scene, &run), SSFR_OK);
            assert_true(inspected.finite && inspected.bounded);
            assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
            ssfr_inspect_left_out(report->n_nodes, report->nodes, after, sizeof after);
            assert_string_equal(before, after);
            ssfr_graph_destroy(&graph);
        }
    test_scene_destroy(&s);
}

/* All is border, or what bends more than a threshold; a surface of images has none, nor has what knows no border. */
static void the_share_of_borders_is_that_of_the_pixels_with_water(void **state)
{
    static const char *const settings[] = {"layer_composite.border=always", "layer_composite.depth_thresh=0.01",
                                           "layer_composite.depth_thresh=0.1", "layer_composite.surface=image"};
    enum { N = SSFR_COUNT(settings) };
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    ssfr_inspected inspected[N + 1];
    test_scene_create_usual(&s, W, H);
    for (int i = 0; i <= N; i++) {
        ssfr_graph *graph = test_graph(ssfr_pipeline_find(i < N ? "bagar2010" : "vanderlaan2009"), gl);
        if (i < N) test_graph_set(graph, (const char *[]){settings[i], NULL});
        assert_int_equal(ssfr_inspect_frame(&inspected[i], graph, &s.scene, NULL), SSFR_OK);
        ssfr_graph_destroy(&graph);
    }
    assert_true(inspected[0].border_share == 1);
    assert_true(inspected[1].border_share < 1 && inspected[1].border_share > inspected[2].border_share);
    assert_true(inspected[2].border_share > 0);
    assert_true(inspected[3].border_share == 0 && inspected[4].border_share == 0);
    test_scene_destroy(&s);
}

static void a_frame_that_cannot_run_is_an_error(void **state)
{
    (void)state;
    test_scene s;
    ssfr_inspected inspected;
    ssfr_field *image = NULL;
    test_scene_create_usual(&s, W, H);
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), NULL);
    assert_int_equal(ssfr_field_create(&image, 5, 7, 3), SSFR_OK);
    assert_int_equal(ssfr_graph_import(graph, "scene_color", image), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_inspect_frame(&inspected, graph, &s.scene, NULL), "scene_color");
    ssfr_field_destroy(&image);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void every_bit_counts_in_a_hash(void **state)
{
    (void)state;
    ssfr_field *image = NULL;
    char a[17], b[17];
    assert_int_equal(ssfr_field_create(&image, 3, 2, 3), SSFR_OK);
    ssfr_inspect_hash(image, a);
    assert_int_equal(strspn(a, "0123456789abcdef"), 16);
    image->data[17] = -0.0;
    ssfr_inspect_hash(image, b);
    assert_string_not_equal(a, b);
    image->data[17] = 0;
    ssfr_inspect_hash(image, b);
    assert_string_equal(a, b);
    image->data[0] = nextafter(0, 1);
    ssfr_inspect_hash(image, b);
    assert_string_not_equal(a, b);
    ssfr_field_destroy(&image);
}

static void what_was_left_out_is_listed_with_how(void **state)
{
    (void)state;
    static const ssfr_node_report reports[] = {{.node = "depth", .status = SSFR_RAN},
                                               {.node = "noise", .status = SSFR_UNWANTED},
                                               {.node = "foam", .status = SSFR_NEEDLESS},
                                               {.node = "normals", .status = SSFR_OFF},
                                               {.node = "scene", .status = SSFR_GIVEN}};
    char text[64], little[12];
    ssfr_inspect_left_out(5, reports, text, sizeof text);
    assert_string_equal(text, "noise unwanted;foam needless;normals off;scene given");
    ssfr_inspect_left_out(5, reports, little, sizeof little);
    assert_string_equal(little, "noise unwan");
    ssfr_inspect_left_out(1, reports, text, sizeof text);
    assert_string_equal(text, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_surface_is_where_there_are_particles),
        cmocka_unit_test(lengths_of_fluid_are_of_its_particles),
        cmocka_unit_test(the_picture_is_within_what_there_is_to_be_seen),
        cmocka_unit_test(bounds_are_those_of_particles_parameters_and_scene),
        cmocka_unit_test(lengths_are_bounded_by_the_particles_over_a_pixel),
        ON_BOTH(foam_may_lean_out_of_its_spheres_and_spray_adds_to_the_picture),
        cmocka_unit_test(without_particles_no_surface_is_bounded),
        ON_BOTH(smoothing_is_bounded_by_what_it_smooths),
        ON_BOTH(usual_frames_are_finite_and_bounded),
        ON_BOTH(the_share_of_borders_is_that_of_the_pixels_with_water),
        cmocka_unit_test(a_frame_that_cannot_run_is_an_error),
        cmocka_unit_test(every_bit_counts_in_a_hash),
        cmocka_unit_test(what_was_left_out_is_listed_with_how),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_shared_gl_destroy);
}

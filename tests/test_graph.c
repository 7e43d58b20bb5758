/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_graph.c: graphs: lists and keys, what is given, wanted and read, bad pipelines, reports, the same bits twice. */
#include "tests/frames.h"

#include "graph/graph.h"

#include <omp.h>

static const ssfr_pipeline *van_der_laan(void)
{
    return ssfr_pipeline_find("vanderlaan2009");
}

/* ---- lists ------------------------------------------------------------------------------------------------------- */

static void every_pass_and_pipeline_is_found_by_name(void **state)
{
    (void)state;
    int n = 0;
    for (; ssfr_pass_at(n); n++) {
        const ssfr_pass *pass = ssfr_pass_at(n);
        assert_ptr_equal(ssfr_pass_find(ssfr_pass_name(pass)), pass);
        assert_true(strlen(ssfr_pass_help(pass)) > 10 && strlen(ssfr_pass_source(pass)) > 10);
    }
    assert_true(n >= 10);
    assert_null(ssfr_pass_at(n + 1));
    assert_null(ssfr_pass_at(-1));
    assert_null(ssfr_pass_find("bilaterall"));
    for (n = 0; ssfr_pipeline_at(n); n++) {
        const ssfr_pipeline *pipeline = ssfr_pipeline_at(n);
        assert_ptr_equal(ssfr_pipeline_find(ssfr_pipeline_name(pipeline)), pipeline);
        assert_true(strlen(ssfr_pipeline_help(pipeline)) > 10);
    }
    assert_null(ssfr_pipeline_at(n + 1));
    assert_null(ssfr_pipeline_at(-1));
    assert_null(ssfr_pipeline_find(""));
}

static void passes_tell_their_ports(void **state)
{
    (void)state;
    const ssfr_pass *pass = ssfr_pass_find("composite");
    assert_string_equal(ssfr_pass_input(pass, 0), "scene_color");
    assert_string_equal(ssfr_pass_input(pass, 4), "thickness");
    assert_null(ssfr_pass_input(pass, 5));
    assert_null(ssfr_pass_input(pass, -1));
    assert_string_equal(ssfr_pass_output(pass, 0), "color");
    assert_null(ssfr_pass_output(pass, 1));
    assert_null(ssfr_pass_input(ssfr_pass_find("background"), 0));
}

static void slots_tell_channels_and_units(void **state)
{
    (void)state;
    assert_string_equal(ssfr_slot_channels("normal"), "N.X,N.Y,N.Z");
    assert_string_equal(ssfr_slot_unit("fluid_depth"), "m");
    assert_null(ssfr_slot_channels("colour"));
    assert_null(ssfr_slot_unit(""));
    ssfr_graph *graph = test_graph(van_der_laan(), NULL);
    int n = 0;
    for (; ssfr_graph_slot_at(graph, n); n++) {
        const char *names = ssfr_slot_channels(ssfr_graph_slot_at(graph, n));
        int commas = 0;
        for (const char *at = names; *at; at++) commas += *at == ',';
        assert_int_equal(commas + 1, ssfr_slots[ssfr_slot_find(ssfr_graph_slot_at(graph, n))].channels);
    }
    assert_int_equal(n, 11);
    assert_null(ssfr_graph_slot_at(graph, n + 1));
    assert_null(ssfr_graph_slot_at(graph, -1));
    ssfr_graph_destroy(&graph);
    assert_null(graph);
    ssfr_graph_destroy(&graph);
}

/* ---- keys -------------------------------------------------------------------------------------------------------- */

static void every_key_is_got_and_set_to_what_was_got(void **state)
{
    (void)state;
    for (int p = 0; ssfr_pipeline_at(p); p++) {
        ssfr_graph *graph = test_graph(ssfr_pipeline_at(p), NULL);
        bool offs = false;
        int n = 0;
        for (; ssfr_graph_key_at(graph, n); n++) {
            const char *key = ssfr_graph_key_at(graph, n);
            char before[128], after[128];
            assert_non_null(ssfr_graph_row(graph, key));
            assert_int_equal(ssfr_graph_get(graph, key, before, sizeof before), SSFR_OK);
            assert_int_equal(ssfr_graph_set(graph, key, before), SSFR_OK);
            assert_int_equal(ssfr_graph_get(graph, key, after, sizeof after), SSFR_OK);
            assert_string_equal(before, after);
            for (int i = 0; i < n; i++) assert_string_not_equal(key, ssfr_graph_key_at(graph, i));
            const bool off = strcmp(strrchr(key, '.'), ".off") == 0;
            assert_true(off || !offs); /* off switches come last */
            offs |= off;
        }
        assert_true(n > 40 && offs);
        assert_null(ssfr_graph_key_at(graph, -1));
        ssfr_graph_destroy(&graph);
    }
}

static void every_row_says_its_unit_help_and_range(void **state)
{
    (void)state;
    for (int p = 0; ssfr_pipeline_at(p); p++) {
        ssfr_graph *graph = test_graph(ssfr_pipeline_at(p), NULL);
        for (int i = 0; ssfr_graph_key_at(graph, i); i++) {
            const ssfr_param *row = ssfr_graph_row(graph, ssfr_graph_key_at(graph, i));
            assert_true(row->unit && row->unit[0] && row->help && strlen(row->help) > 4);
            assert_int_equal(row->words != NULL, row->type == SSFR_CHOICE || row->type == SSFR_SET);
            if (!row->words) assert_true(row->min <= row->def && row->def <= row->max);
        }
        ssfr_graph_destroy(&graph);
    }
}

static void unknown_keys_are_errors_but_for_row(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "", ".", "composite", "composite.", ".gamma", "gamma", "composite.gama", "composite.gammas", "composit.gamma",
        "compositee.gamma", "medium.iorr", "medium.off", "nothing.off", "composite.off.off", "composite..gamma",
        "curvature_flow.gamma", "COMPOSITE.gamma",
    };
    ssfr_graph *graph = test_graph(van_der_laan(), NULL);
    char text[16] = "untouched";
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) {
        char expected[64];
        snprintf(expected, sizeof expected, "%s: pipeline vanderlaan2009 has no such parameter", bad[i]);
        assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_set(graph, bad[i], "1"), expected);
        assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_get(graph, bad[i], text, sizeof text), expected);
        test_clear_log();
        assert_null(ssfr_graph_row(graph, bad[i]));
        assert_int_equal(test_n_errors(), 0);
    }
    assert_string_equal(text, "untouched");
    ssfr_graph_destroy(&graph);
}

static void assert_value(const ssfr_graph *graph, const char *key, const char *expected)
{
    char text[64];
    assert_int_equal(ssfr_graph_get(graph, key, text, sizeof text), SSFR_OK);
    assert_string_equal(text, expected);
}

/* Two nodes of one pass beside one that has the pass' name. */
static const ssfr_pipeline twice = {
    .name = "twice", .source = "test", .help = "test", .result = SSFR_SLOT_thickness,
    .nodes = {{"front", "sphere_depth", .settings = {"radius_scale=2.385", "splat=exact"}},
              {"back", "sphere_depth", .ports = {{"depth", SSFR_SLOT_surface_depth}}},
              {"thickness"}},
};

static void a_key_names_a_node_a_pass_or_a_group(void **state)
{
    (void)state;
    ssfr_graph *graph = test_graph(&twice, NULL);
    assert_value(graph, "front.radius_scale", "2.385");
    assert_value(graph, "front.splat", "exact");
    assert_value(graph, "back.radius_scale", "1");
    test_graph_set(graph, (const char *[]){"back.radius_scale=0.77", "medium.ior=1.41", NULL});
    assert_value(graph, "front.radius_scale", "2.385");
    assert_value(graph, "back.radius_scale", "0.77");
    assert_value(graph, "medium.ior", "1.41");
    test_graph_set(graph, (const char *[]){"sphere_depth.radius_scale=0.3", "sphere_depth.off=1", NULL});
    assert_value(graph, "front.radius_scale", "0.3");
    assert_value(graph, "back.radius_scale", "0.3");
    assert_value(graph, "front.off", "1");
    assert_value(graph, "back.off", "1");
    assert_value(graph, "thickness.off", "0");
    assert_value(graph, "thickness.radius_scale", "1");
    test_graph_set(graph, (const char *[]){"front.off=no", NULL});
    assert_value(graph, "back.off", "1");
    ssfr_graph_destroy(&graph);
}

static void bad_values_change_no_node(void **state)
{
    (void)state;
    ssfr_graph *graph = test_graph(&twice, NULL);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_set(graph, "sphere_depth.radius_scale", "0"),
                 "sphere_depth.radius_scale=0: out of range [0.01, 100]");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_set(graph, "front.off", "perhaps"), "front.off=perhaps: expected on");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_set(graph, "medium.ior", "nan"), "medium.ior=nan: expected a finite");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_set(graph, "medium.absorption_r", "-1"), "out of range [0, 1e+06] 1/m");
    assert_value(graph, "front.radius_scale", "2.385");
    assert_value(graph, "back.radius_scale", "1");
    assert_value(graph, "medium.ior", "1.333");
    ssfr_graph_destroy(&graph);
}

/* ---- pipelines that make no sense -------------------------------------------------------------------------------- */

static void pipeline_fails(const ssfr_pipeline *pipeline, ssfr_result code, const char *text)
{
    ssfr_graph *graph = (ssfr_graph *)&pipeline;
    assert_fails(code, ssfr_graph_create(&graph, pipeline, NULL), text);
    assert_null(graph);
}

#define HANDMADE(slot, ...) \
    &(ssfr_pipeline){.name = "handmade", .source = "", .help = "", .result = SSFR_SLOT_##slot, .nodes = {__VA_ARGS__}}

static void pipelines_with_bad_nodes_are_refused(void **state)
{
    (void)state;
    pipeline_fails(NULL, SSFR_ERR_UNKNOWN, "no pipeline");
    pipeline_fails(HANDMADE(color, {"bilateral"}), SSFR_ERR_UNKNOWN, "bilateral: no pass bilateral");
    pipeline_fails(HANDMADE(color, {"smooth", "bilateral"}), SSFR_ERR_UNKNOWN, "smooth: no pass bilateral");
    pipeline_fails(HANDMADE(normal, {"a", "normals"}, {"a", "normals"}), SSFR_ERR_VALUE, "two nodes are named a");
    pipeline_fails(HANDMADE(color, {"normals"}), SSFR_ERR_UNKNOWN, "handmade: no node writes its result, color");
    pipeline_fails(HANDMADE(surface_depth, {"normals"}), SSFR_ERR_UNKNOWN, "no node writes its result, surface_depth");
    pipeline_fails(HANDMADE(color), SSFR_ERR_UNKNOWN, "no node writes its result");
}

static void bad_port_bindings_are_refused(void **state)
{
    (void)state;
    pipeline_fails(HANDMADE(normal, {"n", "normals", .ports = {{"dept", SSFR_SLOT_fluid_depth}}}), SSFR_ERR_UNKNOWN,
                   "n: pass normals has no port dept");
    pipeline_fails(HANDMADE(normal, {"n", "normals", .ports = {{"depth", SSFR_SLOT_scene_color}}}), SSFR_ERR_VALUE,
                   "n: port depth takes 1 channels, slot scene_color has 3");
    pipeline_fails(HANDMADE(thickness, {"n", "normals", .ports = {{"normal", SSFR_SLOT_thickness}}}), SSFR_ERR_VALUE,
                   "n: port normal takes 3 channels, slot thickness has 1");
    pipeline_fails(HANDMADE(normal, {"n", "normals", .ports = {{"depth", SSFR_SLOT_thickness}}}), SSFR_ERR_VALUE,
                   "n: port depth is -1e+30 where there is nothing, slot thickness 0");
    pipeline_fails(HANDMADE(normal, {"n", "normals", .ports = {{"depth", SSFR_NO_SLOT}}}), SSFR_ERR_UNKNOWN,
                   "n: port depth is bound to no slot");
}

static void bad_settings_of_nodes_are_refused(void **state)
{
    (void)state;
    pipeline_fails(HANDMADE(normal, {"n", "normals", .settings = {"edges=central"}}), SSFR_ERR_UNKNOWN,
                   "n: pass normals has no parameter edges");
    pipeline_fails(HANDMADE(normal, {"n", "normals", .settings = {"edge=sharp"}}), SSFR_ERR_VALUE,
                   "edge=sharp: expected one of smaller, central");
    pipeline_fails(HANDMADE(normal, {"n", "normals", .settings = {"depth_falloff"}}), SSFR_ERR_VALUE,
                   "depth_falloff=: expected a finite number");
}

static void a_pipeline_may_have_32_nodes_and_no_more_images_than_fit(void **state)
{
    (void)state;
    static char names[32][16];
    ssfr_pipeline full = {.name = "full", .source = "", .help = "", .result = SSFR_SLOT_normal};
    for (int i = 0; i < 32; i++) {
        snprintf(names[i], sizeof names[i], "n%d", i);
        full.nodes[i] = (ssfr_node){.name = names[i], .pass = "normals"};
    }
    ssfr_graph *graph = test_graph(&full, NULL);
    assert_int_equal(ssfr_graph_set(graph, "n31.edge", "central"), SSFR_OK);
    assert_value(graph, "n30.edge", "smaller");
    ssfr_graph_destroy(&graph);
}

/* ---- wanting and reading ----------------------------------------------------------------------------------------- */

static void unknown_images_are_errors(void **state)
{
    ssfr_gl *gl = test_backend(state);
    ssfr_graph *graph = test_graph(van_der_laan(), gl);
    ssfr_field *field = test_image(4, 4, 1, 0), *got = field;
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_want(graph, "colour"), "colour: pipeline vanderlaan2009 has no such");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_import(graph, "", field), "has no such image");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_read(graph, "foam", &got), "foam: pipeline vanderlaan2009 has no such");
    assert_null(got);
    ssfr_field_destroy(&field);
    ssfr_graph_destroy(&graph);
    graph = test_graph(&twice, gl);
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_want(graph, "color"), "color: pipeline twice has no such image");
    ssfr_graph_destroy(&graph);
}

static void nothing_is_read_before_a_frame_has_run(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    ssfr_field *got = NULL;
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_read(graph, "color", &got), "color: no frame has been run");
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    ssfr_field *color = test_graph_read(graph, "color");
    assert_int_equal(color->w, 64);
    assert_int_equal(color->h, 48);
    assert_int_equal(color->c, 3);
    s.scene.camera.near = -1;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(graph, &s.scene, NULL), "camera: near -1");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_read(graph, "color", &got), "color: no frame has been run");
    ssfr_field_destroy(&color);
    test_scene_destroy(&s);
    ssfr_graph_destroy(&graph);
}

static void what_is_wanted_runs_and_what_is_left_out_is_neutral(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_field *noise = test_graph_picture(graph, &s.scene, "noise", false);
    assert_int_equal(test_graph_node(graph, "surface_noise")->status, SSFR_UNWANTED);
    assert_int_equal(noise->w * noise->h * noise->c, 1);
    assert_true(noise->data[0] == 0);
    ssfr_field_destroy(&noise);
    assert_int_equal(ssfr_graph_want(graph, "noise"), SSFR_OK);
    noise = test_graph_picture(graph, &s.scene, "noise", false);
    assert_int_equal(test_graph_node(graph, "surface_noise")->status, SSFR_RAN);
    assert_int_equal(noise->w, 64);
    ssfr_field_destroy(&noise);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void wanting_all_runs_all_that_is_needed(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    test_graph_set(graph, (const char *[]){"downsample.factor=2", "noise_normals.height=0.3",
                                             "noise_foam.strength=1", NULL});
    ssfr_graph_want_all(graph, true);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    const ssfr_report *report = ssfr_graph_report(graph);
    for (int i = 0; i < report->n_nodes; i++) assert_int_equal(report->nodes[i].status, SSFR_RAN);
    for (int i = 0; ssfr_graph_slot_at(graph, i); i++) {
        const char *slot = ssfr_graph_slot_at(graph, i);
        ssfr_field *field = test_graph_read(graph, slot);
        const int divisor = strcmp(slot, "low_depth") == 0 || strcmp(slot, "smooth_depth") == 0 ? 2 : 1;
        assert_int_equal(field->w, 64 / divisor);
        assert_int_equal(field->h, 48 / divisor);
        ssfr_field_destroy(&field);
    }
    ssfr_graph_want_all(graph, false);
    test_graph_set(graph, (const char *[]){"noise_normals.height=0", "noise_foam.strength=0", NULL});
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_int_equal(test_graph_node(graph, "surface_noise")->status, SSFR_UNWANTED);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* ---- what is given ----------------------------------------------------------------------------------------------- */

/* A background that no procedure would draw. */
static ssfr_field *stripes(int w, int h)
{
    ssfr_field *field = test_image(w, h, 3, 0);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            for (int k = 0; k < 3; k++) ssfr_field_at(field, x, y)[k] = (x * (k + 1) + 3 * y) % 7 / 7.0 + 0.0385;
    return field;
}

static void a_background_of_the_user_takes_the_place_of_ours(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    const double eps = *state ? 1e-7 : 0;
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_field *color = stripes(64, 48), *depth = test_image(64, 48, 1, -2.385);
    assert_int_equal(ssfr_graph_import(graph, "scene_color", color), SSFR_OK);
    assert_int_equal(ssfr_graph_import(graph, "scene_depth", depth), SSFR_OK);
    assert_int_equal(ssfr_graph_want(graph, "surface_depth"), SSFR_OK);
    ssfr_field *picture = test_graph_picture(graph, &s.scene, "color", false);
    ssfr_field *surface = test_graph_read(graph, "surface_depth"), *back = test_graph_read(graph, "scene_color");
    assert_int_equal(test_graph_node(graph, "background")->status, SSFR_GIVEN);
    assert_string_equal(test_graph_node(graph, "background")->why, "its outputs are given");
    int n_fluid = 0, n_changed = 0;
    for (int i = 0; i < 64 * 48; i++)
        for (int k = 0; k < 3; k++) {
            const double given = color->data[3 * i + k], shown = picture->data[3 * i + k];
            assert_close(back->data[3 * i + k], given, eps, 0);
            if (!ssfr_is_surface(surface->data[i])) assert_close(shown, given, eps, 0);
            n_fluid += ssfr_is_surface(surface->data[i]);
            n_changed += fabs(shown - given) > 1e-3;
        }
    assert_true(n_fluid > 1000 && n_changed > n_fluid / 2);
    ssfr_field *const all[] = {color, depth, picture, surface, back};
    for (size_t i = 0; i < SSFR_COUNT(all); i++) ssfr_field_destroy(&(ssfr_field *){all[i]});
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void given_depth_hides_the_fluid_behind_it(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_field *wall = test_image(64, 48, 1, -0.3);
    assert_int_equal(ssfr_graph_import(graph, "scene_depth", wall), SSFR_OK);
    ssfr_field *picture = test_graph_picture(graph, &s.scene, "color", false);
    ssfr_field *scene = test_graph_read(graph, "scene_color");
    assert_int_equal(test_graph_node(graph, "background")->status, SSFR_RAN); /* its colour is still read */
    assert_int_equal(test_n_different(picture, scene), 0);
    ssfr_field_destroy(&scene);
    ssfr_field_destroy(&picture);
    ssfr_field_destroy(&wall);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void images_given_later_replace_earlier_ones(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    for (int i = 0; i < 3; i++) {
        const int w = i == 2 ? 37 : 64, h = i == 2 ? 23 : 48;
        ssfr_field *color = test_image(w, h, 3, 0.125 * (i + 1));
        test_scene_look(&s, (const double[3]){0.35, 0.62, 1.25}, (const double[3]){0, 0.2, 0}, 45, w, h);
        assert_int_equal(ssfr_graph_import(graph, "scene_color", color), SSFR_OK);
        ssfr_field *picture = test_graph_picture(graph, &s.scene, "scene_color", false);
        assert_int_equal(test_n_different(picture, color), 0);
        ssfr_field_destroy(&picture);
        ssfr_field_destroy(&color);
    }
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void given_images_of_wrong_shape_are_refused(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    static const struct {
        int w, h;
        const char *text;
    } bad[] = {
        {128, 96, "scene_color: 128 x 96 pixels given, the frame has 64 x 48"},
        {64, 47, "scene_color: 64 x 47 pixels given"},
        {32, 48, "scene_color: 32 x 48 pixels given"},
        {21, 16, "scene_color: 21 x 16 pixels given"},
        {32, 24, "composite: scene_color has 1/2 of the frame's resolution, the pass works at 1/1"},
    };
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_field *grey = test_image(64, 48, 1, 0.5);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_import(graph, "scene_color", grey), "1 channels given, it has 3");
    ssfr_field_destroy(&grey);
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) {
        ssfr_field *color = test_image(bad[i].w, bad[i].h, 3, 0.5);
        assert_int_equal(ssfr_graph_import(graph, "scene_color", color), SSFR_OK);
        assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(graph, &s.scene, NULL), bad[i].text);
        ssfr_field_destroy(&color);
    }
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void given_depths_are_before_the_eye(void **state)
{
    static const char *const slots[] = {"fluid_depth", "low_depth", "smooth_depth", "surface_depth"};
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    ssfr_field *depth = test_image(64, 48, 1, -2.385);
    for (size_t i = 0; i < SSFR_COUNT(slots); i++) {
        *ssfr_field_at(depth, 7, 5) = 0;
        assert_fails(SSFR_ERR_VALUE, ssfr_graph_import(graph, slots[i], depth), "pixel 7,5 is at z = 0 m");
        *ssfr_field_at(depth, 7, 5) = SSFR_EMPTY; /* of a map of the farthest */
        assert_int_equal(ssfr_graph_import(graph, slots[i], depth), SSFR_OK);
        *ssfr_field_at(depth, 63, 47) = 1e-30;
        assert_fails(SSFR_ERR_VALUE, ssfr_graph_import(graph, slots[i], depth), "pixel 63,47 is at z = 1e-30 m");
        *ssfr_field_at(depth, 63, 47) = NAN;
        assert_int_equal(ssfr_graph_import(graph, slots[i], depth), SSFR_OK);
        *ssfr_field_at(depth, 63, 47) = -2.385;
    }
    ssfr_field_destroy(&depth);
    ssfr_graph_destroy(&graph);
}

static void one_pixel_given_serves_the_whole_frame(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_field *pictures[2];
    for (int i = 0; i < 2; i++) {
        ssfr_graph *graph = test_graph(van_der_laan(), gl);
        const int w = i ? 64 : 1, h = i ? 48 : 1;
        ssfr_field *color = test_image(w, h, 3, 0.25), *thick = test_image(w, h, 1, 0.385);
        assert_int_equal(ssfr_graph_import(graph, "scene_color", color), SSFR_OK);
        assert_int_equal(ssfr_graph_import(graph, "thickness", thick), SSFR_OK);
        pictures[i] = test_graph_picture(graph, &s.scene, "color", false);
        assert_int_equal(test_graph_node(graph, "thickness")->status, SSFR_GIVEN);
        ssfr_field_destroy(&color);
        ssfr_field_destroy(&thick);
        ssfr_graph_destroy(&graph);
    }
    assert_int_equal(test_n_different(pictures[0], pictures[1]), 0);
    assert_true(fabs(pictures[0]->data[0] - 0.25) < 1e-12);
    ssfr_field_destroy(&pictures[0]);
    ssfr_field_destroy(&pictures[1]);
    test_scene_destroy(&s);
}

/* A row each for what the report sums up, after any frame: with scratch, a table, what is given and the environment. */
static void memory_is_that_of_the_report(void **state)
{
    ssfr_gl *gl = test_backend(state);
    ssfr_memory m;
    for (int p = 0; ssfr_pipeline_at(p); p++) {
        test_scene s;
        test_scene_create_usual(&s, 64, 48);
        if (p == 1) test_scene_add_shapes(&s);
        ssfr_graph *graph = test_graph(ssfr_pipeline_at(p), gl);
        assert_false(ssfr_graph_memory_at(graph, 0, &m));
        ssfr_field *depth = test_image(64, 48, 1, -SSFR_EMPTY);
        assert_int_equal(ssfr_graph_set(graph, "sphere_depth.root", "ramp"), SSFR_OK);
        for (int given = 0; given < 2; given++) {
            if (given) assert_int_equal(ssfr_graph_import(graph, "scene_depth", depth), SSFR_OK);
            assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
            double sum = 0;
            int n = 0, n_given = 0, n_scratch = 0, n_tables = 0, n_maps = 0;
            for (; ssfr_graph_memory_at(graph, n, &m); n++) {
                sum += m.bytes;
                assert_true(m.w > 0 && m.h > 0 && m.d > 0 && m.c > 0 && m.bytes > 0);
                n_given += strcmp(m.kind, "given") == 0;
                n_scratch += strcmp(m.kind, "scratch") == 0;
                n_tables += strcmp(m.kind, "table") == 0;
                n_maps += strcmp(m.kind, "environment") == 0;
            }
            assert_true(sum == ssfr_graph_report(graph)->image_bytes);
            assert_int_equal(n_given, given);
            assert_int_equal(n_tables, 1);
            assert_true(n_scratch > 0);
            assert_int_equal(n_maps, gl && s.map);
            assert_false(ssfr_graph_memory_at(graph, -1, &m));
        }
        ssfr_field_destroy(&depth);
        ssfr_graph_destroy(&graph);
        test_scene_destroy(&s);
    }
}

static void memory_has_the_format_that_is_stored(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_graph *graph = test_graph(van_der_laan(), gl);
    assert_int_equal(ssfr_graph_set(graph, "thickness.storage", "half"), SSFR_OK);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    ssfr_memory m;
    int n_found = 0;
    for (int i = 0; ssfr_graph_memory_at(graph, i, &m); i++) {
        if (strcmp(m.kind, "image") != 0) continue;
        if (strcmp(m.name, "scene_color") == 0) {
            n_found++;
            assert_string_equal(m.node, "background");
            assert_string_equal(m.format, gl ? "RGBA32F" : "RGB64F");
            assert_true(m.w == 64 && m.h == 48 && m.d == 1 && m.c == 3);
            assert_true(m.bytes == 64 * 48 * (gl ? 16 : 24));
        } else if (strcmp(m.name, "thickness") == 0) {
            n_found++;
            assert_string_equal(m.format, gl ? "R16F" : "R64F");
            assert_true(m.bytes == 64 * 48 * (gl ? 2 : 8));
        }
    }
    assert_int_equal(n_found, 2);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static const char *const known_step[] = {"curvature_flow.dt=2e-4", "downsample.factor=2", NULL};

/* The images that a frame with particles makes, given to a frame without: the picture is the same. */
static void given_fluid_needs_no_particles(void **state)
{
    ssfr_gl *gl = test_backend(state);
    static const char *const slots[] = {"fluid_depth", "thickness"};
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_graph *with = test_graph(van_der_laan(), gl);
    ssfr_graph *without = test_graph(van_der_laan(), gl);
    test_graph_set(with, known_step);
    test_graph_set(without, known_step);
    ssfr_field *expected = test_graph_picture(with, &s.scene, "color", false);
    for (int i = 0; i < 2; i++) {
        ssfr_field *field = test_graph_read(with, slots[i]);
        assert_int_equal(ssfr_graph_import(without, slots[i], field), SSFR_OK);
        ssfr_field_destroy(&field);
    }
    s.scene.particles = &(ssfr_particles){.radius = s.particles->radius};
    for (int keep_all = 0; keep_all < 2; keep_all++) {
        ssfr_field *got = test_graph_picture(without, &s.scene, "color", keep_all);
        assert_int_equal(test_n_different(got, expected), 0);
        assert_true(ssfr_graph_report(without)->covered == 1);
        ssfr_field_destroy(&got);
    }
    ssfr_field_destroy(&expected);
    ssfr_graph_destroy(&with);
    ssfr_graph_destroy(&without);
    test_scene_destroy(&s);
}

/* The step of the curvature flow refers to the distance of what is given, not to the near plane. */
static void given_depth_tells_how_far_the_fluid_is(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_graph *graph = test_graph(van_der_laan(), gl);
    ssfr_field *depth = test_image(64, 48, 1, -SSFR_EMPTY), *smooth[2];
    for (int y = 8; y < 40; y++)
        for (int x = 8; x < 56; x++) *ssfr_field_at(depth, x, y) = -2.385 - 0.02 * ((x + y) % 2);
    assert_int_equal(ssfr_graph_import(graph, "fluid_depth", depth), SSFR_OK);
    assert_int_equal(ssfr_graph_want(graph, "smooth_depth"), SSFR_OK);
    s.scene.particles = &(ssfr_particles){.radius = s.particles->radius};
    for (int i = 0; i < 2; i++) {
        test_graph_set(graph, (const char *[]){i ? "curvature_flow.reference=nearest" : "curvature_flow.reference=mean",
                                               "downsample.factor=1", NULL});
        smooth[i] = test_graph_picture(graph, &s.scene, "smooth_depth", false);
        assert_close(*ssfr_field_at(smooth[i], 30, 24), -2.395, 2e-3, 0);
    }
    for (int i = 0; i < 2; i++) ssfr_field_destroy(&smooth[i]);
    ssfr_field_destroy(&depth);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void depth_given_at_half_resolution_is_scaled_up(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 63, 47);
    ssfr_graph *with = test_graph(van_der_laan(), gl);
    ssfr_graph *given = test_graph(van_der_laan(), gl);
    test_graph_set(with, known_step);
    ssfr_field *expected = test_graph_picture(with, &s.scene, "color", false);
    ssfr_field *smooth = test_graph_read(with, "smooth_depth");
    assert_int_equal(smooth->w, 32);
    assert_int_equal(smooth->h, 24);
    assert_int_equal(ssfr_graph_import(given, "smooth_depth", smooth), SSFR_OK);
    ssfr_field *got = test_graph_picture(given, &s.scene, "color", false);
    assert_int_equal(test_n_different(got, expected), 0);
    assert_int_equal(test_graph_node(given, "curvature_flow")->status, SSFR_GIVEN);
    assert_int_equal(test_graph_node(given, "downsample")->status, SSFR_UNWANTED);
    assert_int_equal(test_graph_node(given, "upsample")->status, SSFR_RAN);
    ssfr_field *const all[] = {got, smooth, expected};
    for (size_t i = 0; i < SSFR_COUNT(all); i++) ssfr_field_destroy(&(ssfr_field *){all[i]});
    ssfr_graph_destroy(&with);
    ssfr_graph_destroy(&given);
    test_scene_destroy(&s);
}

static void low_resolution_without_upsampling_is_refused(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_graph *graph = test_graph(van_der_laan(), gl);
    test_graph_set(graph, (const char *[]){"downsample.factor=4", "upsample.off=1", NULL});
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(graph, &s.scene, NULL),
                 "composite: depth has 1/4 of the frame's resolution, the pass works at 1/1");
    test_graph_set(graph, (const char *[]){"downsample.factor=1", NULL});
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* Half of a frame's width and height, a slope along x; the flow is off, so that only resolutions change. */
static ssfr_field *half_slope(ssfr_graph *graph)
{
    ssfr_field *depth = test_image(64, 48, 1, 0);
    for (int i = 0; i < 64 * 48; i++) depth->data[i] = -2.385 - 0.001 * (i % 64);
    test_graph_set(graph, (const char *[]){"curvature_flow.off=1", "upsample.filter=linear", NULL});
    assert_int_equal(ssfr_graph_import(graph, "fluid_depth", depth), SSFR_OK);
    assert_int_equal(ssfr_graph_want(graph, NULL), SSFR_OK);
    assert_int_equal(ssfr_graph_want(graph, "surface_depth"), SSFR_OK);
    return depth;
}

static void low_resolutions_are_scaled_up_to_the_guides(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 128, 96);
    ssfr_graph *graph = test_graph(van_der_laan(), gl);
    ssfr_field *depth = half_slope(graph);
    ssfr_field *surface = test_graph_picture(graph, &s.scene, "surface_depth", false);
    assert_int_equal(surface->w, 64);
    for (int i = 0; i < 64 * 48; i++)
        if (i % 64 > 1 && i % 64 < 62) assert_close(surface->data[i], depth->data[i], 1e-6, 0);
    assert_int_equal(test_graph_node(graph, "upsample")->status, SSFR_RAN);
    ssfr_field_destroy(&surface);
    ssfr_field_destroy(&depth);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* A guide of half the resolution of what it guides. */
static void images_finer_than_the_guide_are_refused(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 128, 96);
    ssfr_graph *graph = test_graph(van_der_laan(), gl);
    ssfr_field *depth = half_slope(graph), *smooth = test_image(128, 96, 1, -2.385);
    assert_int_equal(ssfr_graph_import(graph, "smooth_depth", smooth), SSFR_OK);
    for (int keep_all = 0; keep_all < 2; keep_all++)
        assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(graph, &s.scene, &(ssfr_run_options){.keep_all = keep_all}),
                     "upsample: depth has 1/1 of the frame's resolution, the pass works at 1/2");
    ssfr_field_destroy(&smooth);
    ssfr_field_destroy(&depth);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* Tiles have 32 pixels: a pass at a lower resolution has no whole pixel in one. */
static void resolutions_below_a_tiles_are_refused(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 128, 96);
    ssfr_graph *graph = test_graph(van_der_laan(), gl);
    ssfr_field *depth = test_image(4, 3, 1, -2.385);
    assert_int_equal(ssfr_graph_import(graph, "fluid_depth", depth), SSFR_OK);
    assert_int_equal(ssfr_graph_want(graph, NULL), SSFR_OK);
    assert_int_equal(ssfr_graph_want(graph, "low_depth"), SSFR_OK);
    test_graph_set(graph, (const char *[]){"downsample.factor=2", NULL});
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(graph, &s.scene, NULL),
                 "downsample: 1/64 of the frame's resolution, the lowest is 1/32");
    test_graph_set(graph, (const char *[]){"downsample.factor=1", NULL});
    ssfr_field *low = test_graph_picture(graph, &s.scene, "low_depth", false);
    assert_int_equal(low->w, 4);
    for (int i = 0; i < 12; i++) assert_close(low->data[i], -2.385, 1e-6, 0);
    ssfr_field_destroy(&low);
    ssfr_field_destroy(&depth);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* Without a radius a depth_falloff in radii would be 0 m, and the flow would smooth nothing without a word. */
static void lengths_in_radii_need_a_radius(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 128, 96);
    ssfr_graph *graph = test_graph(van_der_laan(), gl);
    ssfr_field *depth = half_slope(graph);
    s.scene.particles = NULL;
    test_graph_set(graph, (const char *[]){"curvature_flow.off=0", NULL});
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(graph, &s.scene, NULL),
                 "curvature_flow.depth_falloff=5 is in particle radii, and the scene's particles tell no radius");
    test_graph_set(graph, (const char *[]){"curvature_flow.depth_falloff=0", "upsample.depth_falloff=0", NULL});
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    test_graph_set(graph, (const char *[]){"curvature_flow.depth_falloff=5", "upsample.depth_falloff=5", NULL});
    s.scene.particles = &(ssfr_particles){.radius = 0.02385};
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    ssfr_field_destroy(&depth);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* ---- one pass by itself ------------------------------------------------------------------------------------------ */

static void a_pass_by_itself_answers_to_its_ports(void **state)
{
    ssfr_gl *gl = test_backend(state);
    ssfr_graph *graph = NULL;
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    assert_int_equal(ssfr_graph_create_for_pass(&graph, ssfr_pass_find("normals"), gl), SSFR_OK);
    ssfr_field *depth = test_image(64, 48, 1, -2.385), *got = NULL;
    assert_int_equal(ssfr_graph_import(graph, "depth", depth), SSFR_OK);
    ssfr_field *normal = test_graph_picture(graph, &s.scene, "normal", false);
    for (int i = 0; i < 64 * 48; i++) {
        assert_close(normal->data[3 * i], 0, 1e-6, 0);
        assert_close(normal->data[3 * i + 2], 1, 1e-6, 0);
    }
    assert_int_equal(ssfr_graph_want(graph, "surface_depth"), SSFR_OK);
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_read(graph, "thickness", &got), "thickness: pass normals has no");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_set(graph, "normals.edges", "central"),
                 "normals.edges: pass normals has no such parameter (ssfr passes normals lists them)");
    assert_int_equal(ssfr_graph_set(graph, "normals.edge", "central"), SSFR_OK);
    ssfr_field_destroy(&normal);
    ssfr_field_destroy(&depth);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* ---- the same picture -------------------------------------------------------------------------------------------- */

static void running_twice_gives_the_same_bits(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 96, 64);
    ssfr_field *first = NULL;
    const int threads = omp_get_max_threads();
    for (int i = 0; i < 6; i++) {
        ssfr_graph *graph = test_graph(van_der_laan(), gl);
        omp_set_num_threads(i % 3 + 1);
        test_graph_set(graph, (const char *[]){"noise_normals.height=0.3", "downsample.factor=2", NULL});
        for (int k = 0; k < 2; k++) {
            ssfr_field *picture = test_graph_picture(graph, &s.scene, "color", false);
            if (!first) first = picture;
            assert_int_equal(test_n_different(picture, first), 0);
            if (first != picture) ssfr_field_destroy(&picture);
        }
        ssfr_graph_destroy(&graph);
    }
    omp_set_num_threads(threads);
    ssfr_field_destroy(&first);
    test_scene_destroy(&s);
}

static void other_frames_in_between_leave_no_trace(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s, other;
    test_scene_create_usual(&s, 96, 64);
    test_scene_create_block(&other, (const int[3]){14, 14, 14}, (const double[3]){0, 0.5, 0}, 0.05);
    test_scene_look(&other, (const double[3]){0, 0.9, 0.9}, (const double[3]){0, 0.2, 0}, 70, 131, 77);
    ssfr_graph *graph = test_graph(van_der_laan(), gl);
    ssfr_field *before = test_graph_picture(graph, &s.scene, "color", false);
    test_graph_set(graph, (const char *[]){"noise_normals.height=2", "downsample.factor=8", "medium.ior=1.5", NULL});
    ssfr_field_destroy(&(ssfr_field *){test_graph_picture(graph, &other.scene, "color", true)});
    other.scene.particles = NULL;
    ssfr_field_destroy(&(ssfr_field *){test_graph_picture(graph, &other.scene, "color", false)});
    test_graph_set(graph, (const char *[]){"noise_normals.height=0", "downsample.factor=2", "medium.ior=1.333", NULL});
    ssfr_field *after = test_graph_picture(graph, &s.scene, "color", false);
    assert_int_equal(test_n_different(before, after), 0);
    ssfr_field_destroy(&before);
    ssfr_field_destroy(&after);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
    test_scene_destroy(&other);
}

static void graphs_that_share_a_context_do_not_disturb_each_other(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s, other;
    test_scene_create_usual(&s, 96, 64);
    test_scene_create_block(&other, (const int[3]){5, 5, 5}, (const double[3]){0, 0.3, 0}, 0.05);
    test_scene_look(&other, (const double[3]){0, 0.9, 0.9}, (const double[3]){0, 0.2, 0}, 70, 131, 77);
    ssfr_graph *a = test_graph(van_der_laan(), gl), *b = test_graph(van_der_laan(), gl);
    ssfr_field *alone = test_graph_picture(a, &s.scene, "color", false);
    test_graph_set(b, (const char *[]){"noise_normals.height=2", "sphere_depth.radius_scale=0.5", NULL});
    ssfr_field_destroy(&(ssfr_field *){test_graph_picture(b, &other.scene, "color", false)});
    ssfr_field *between = test_graph_picture(a, &s.scene, "color", false);
    assert_int_equal(test_n_different(between, alone), 0);
    ssfr_graph_destroy(&b);
    ssfr_field *after = test_graph_picture(a, &s.scene, "color", false);
    assert_int_equal(test_n_different(after, alone), 0);
    ssfr_field *const all[] = {alone, between, after};
    for (size_t i = 0; i < SSFR_COUNT(all); i++) ssfr_field_destroy(&(ssfr_field *){all[i]});
    ssfr_graph_destroy(&a);
    test_scene_destroy(&s);
    test_scene_destroy(&other);
}

static void both_backends_draw_the_same_picture(void **state)
{
    (void)state;
    ssfr_gl *gl = test_shared_gl();
    static const char *const variants[][4] = {
        {NULL},
        {"noise_normals.height=0.3", "downsample.factor=1", NULL},
        {"noise_foam.strength=1", NULL},
        {"sphere_depth.splat=exact", "thickness.splat=exact", "composite.refraction=snell", NULL},
        {"composite.reflection=scene", "composite.fresnel=exact", "downsample.factor=4", NULL},
    };
    test_scene s;
    test_scene_create_usual(&s, 160, 120);
    for (size_t i = 0; i < SSFR_COUNT(variants); i++) {
        ssfr_graph *cpu = test_graph(van_der_laan(), NULL), *gpu = test_graph(van_der_laan(), gl);
        test_graph_set(cpu, variants[i]);
        test_graph_set(gpu, variants[i]);
        ssfr_field *a = test_graph_picture(cpu, &s.scene, "color", false);
        ssfr_field *b = test_graph_picture(gpu, &s.scene, "color", false);
        if (!(test_psnr(b, a) > 50)) fail_msg("variant %zu: %g dB", i, test_psnr(b, a));
        ssfr_field_destroy(&a);
        ssfr_field_destroy(&b);
        ssfr_graph_destroy(&cpu);
        ssfr_graph_destroy(&gpu);
    }
    test_scene_destroy(&s);
}

/* ---- the report -------------------------------------------------------------------------------------------------- */

static void assert_node(const ssfr_graph *graph, const char *name, ssfr_node_status status, const char *why)
{
    const ssfr_node_report *node = test_graph_node(graph, name);
    if (node->status != status || strcmp(node->why, why) != 0) fail_msg("%s: %d, %s", name, node->status, node->why);
    assert_true((node->taps + node->bytes > 0) == (status == SSFR_RAN));
    assert_true((node->iterations > 0) == (status == SSFR_RAN));
}

static void the_report_says_what_ran_and_why_not(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_field *thick = test_image(64, 48, 1, 0.2);
    assert_int_equal(ssfr_graph_import(graph, "thickness", thick), SSFR_OK);
    test_graph_set(graph, (const char *[]){"downsample.factor=1", "normals.off=1", NULL});
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_node(graph, "background", SSFR_RAN, "");
    assert_node(graph, "sphere_depth", SSFR_RAN, "");
    assert_node(graph, "downsample", SSFR_NEEDLESS, "full resolution, or no fluid in view");
    assert_node(graph, "curvature_flow", SSFR_RAN, "");
    assert_node(graph, "upsample", SSFR_NEEDLESS, "the guide's resolution already, or no fluid in view");
    assert_node(graph, "normals", SSFR_OFF, "switched off");
    assert_node(graph, "thickness", SSFR_GIVEN, "its outputs are given");
    assert_node(graph, "surface_noise", SSFR_UNWANTED, "nobody reads what it writes");
    assert_node(graph, "noise_normals", SSFR_NEEDLESS, "waves of height 0, or no fluid in view");
    assert_node(graph, "composite", SSFR_RAN, "");
    assert_node(graph, "noise_foam", SSFR_NEEDLESS, "foam of strength 0, or no fluid in view");
    ssfr_field_destroy(&thick);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void the_report_counts_and_times(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    const ssfr_report *report = ssfr_graph_report(graph);
    test_scene s;
    test_scene_create_usual(&s, 96, 64);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_int_equal(report->n_nodes, 11);
    assert_string_equal(report->nodes[0].node, "background");
    assert_string_equal(report->nodes[9].pass, "composite");
    assert_string_equal(report->nodes[10].pass, "noise_foam");
    assert_int_equal(report->n_particles, 432);
    assert_true(report->covered > 0.3 && report->covered <= 1);
    assert_true(report->allocations > 0 && report->image_bytes > 96 * 64 * 4 * 8);
    assert_true(report->wall_ms > 0 && report->cpu_ms > 0 && report->cpu_ms < report->wall_ms);
    for (int i = 0; i < report->n_nodes; i++) assert_true(isnan(report->nodes[i].ms));
    assert_true(test_graph_node(graph, "sphere_depth")->vertices == 432);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, &(ssfr_run_options){.timing = true}), SSFR_OK);
    double sum = 0;
    for (int i = 0; i < report->n_nodes; i++) {
        assert_int_equal(isnan(report->nodes[i].ms), report->nodes[i].status != SSFR_RAN);
        if (report->nodes[i].status == SSFR_RAN) assert_true(report->nodes[i].ms >= 0), sum += report->nodes[i].ms;
    }
    assert_true(sum > 0 && sum < 1.1 * report->wall_ms + 1);
    assert_int_equal(report->allocations, 0);
    const double held = report->image_bytes;
    ssfr_field *depth = test_image(96, 64, 1, -2.385);
    assert_int_equal(ssfr_graph_import(graph, "fluid_depth", depth), SSFR_OK);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_true(report->image_bytes == held + 96 * 64 * (test_backend(state) ? 4 : 8));
    assert_int_equal(ssfr_graph_import(graph, "fluid_depth", NULL), SSFR_OK);
    ssfr_field_destroy(&depth);
    s.scene.particles = NULL;
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_int_equal(report->n_particles, 0);
    assert_true(report->covered == 0);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* Heaps of as many particles as a packet holds, each with a packet of its own. */
static void the_report_counts_the_packets_that_culling_leaves(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    const ssfr_report *report = ssfr_graph_report(graph);
    const double heaps[][3] = {{0.05, 0.3, 0}, {0.2, 0.1, 0}, {-0.2, 0.2, 0.1}, {0, 0.3, 5}, {5, 0.3, 0}, {-5, 4, -1}};
    enum { HEAPS = SSFR_COUNT(heaps), SEEN = 3 };
    double positions[3 * SSFR_PACKET * HEAPS];
    uint64_t seed = 2385;
    for (int i = 0; i < SSFR_PACKET * HEAPS; i++)
        for (int k = 0; k < 3; k++)
            positions[3 * i + k] = heaps[i / SSFR_PACKET][k] + test_random(&seed, -0.01, 0.01);
    test_scene s;
    test_scene_create(&s, SSFR_PACKET * HEAPS, positions, 0.02);
    test_scene_look(&s, (double[3]){0.1, 0.6, 1.4}, (double[3]){0, 0.2, 0}, 45, 64, 48);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_int_equal(report->n_packets, HEAPS);
    assert_int_equal(report->n_packets_seen, SEEN);
    assert_int_equal(report->n_particles, SEEN * SSFR_PACKET);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, &(ssfr_run_options){.keep_all = true}), SSFR_OK);
    assert_int_equal(report->n_packets_seen, HEAPS);
    assert_int_equal(report->n_particles, HEAPS * SSFR_PACKET);
    s.scene.particles = NULL;
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_int_equal(report->n_packets, 0);
    assert_int_equal(report->n_packets_seen, 0);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* ---- a host's things without a host ------------------------------------------------------------------------------ */

static void a_hosts_things_need_a_hosts_context(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    const double origin[3] = {0, 0, 0};
    const char *text = "needs a graph on the host's GL context";
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_import_texture(graph, "scene_color", 1), text);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_export_texture(graph, 1), text);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_import_buffer(graph, 1, 10, 3, 0, origin, 0.02), text);
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_import_texture(graph, "colour", 1), "colour: pipeline");
    ssfr_graph_destroy(&graph);
}

static void nothing_is_wanted_until_something_is_asked_for_again(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    assert_int_equal(ssfr_graph_want(graph, NULL), SSFR_OK);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_int_equal(test_graph_node(graph, "sphere_depth")->status, SSFR_UNWANTED);
    assert_int_equal(ssfr_graph_want(graph, "surface_depth"), SSFR_OK); /* depth only: nothing is shaded */
    ssfr_field *depth = test_graph_picture(graph, &s.scene, "surface_depth", false);
    assert_int_equal(depth->w, 64);
    assert_int_equal(test_graph_node(graph, "sphere_depth")->status, SSFR_RAN);
    assert_int_equal(test_graph_node(graph, "thickness")->status, SSFR_UNWANTED);
    assert_int_equal(test_graph_node(graph, "composite")->status, SSFR_UNWANTED);
    ssfr_field_destroy(&depth);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void what_was_given_can_be_taken_back(void **state)
{
    ssfr_graph *graph = test_graph(van_der_laan(), test_backend(state));
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    ssfr_field *own = test_graph_picture(graph, &s.scene, "color", false), *grey = test_image(64, 48, 3, 0.2385);
    assert_int_equal(ssfr_graph_import(graph, "scene_color", grey), SSFR_OK);
    ssfr_field *given = test_graph_picture(graph, &s.scene, "color", false);
    assert_int_equal(ssfr_graph_import(graph, "scene_color", NULL), SSFR_OK);
    ssfr_field *back = test_graph_picture(graph, &s.scene, "color", false);
    assert_true(test_n_different(given, own) > 0);
    assert_int_equal(test_n_different(back, own), 0);
    ssfr_field_destroy(&own), ssfr_field_destroy(&grey), ssfr_field_destroy(&given), ssfr_field_destroy(&back);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pass_and_pipeline_is_found_by_name),
        cmocka_unit_test(passes_tell_their_ports),
        cmocka_unit_test(slots_tell_channels_and_units),
        cmocka_unit_test(every_key_is_got_and_set_to_what_was_got),
        cmocka_unit_test(every_row_says_its_unit_help_and_range),
        cmocka_unit_test(unknown_keys_are_errors_but_for_row),
        cmocka_unit_test(a_key_names_a_node_a_pass_or_a_group),
        cmocka_unit_test(bad_values_change_no_node),
        cmocka_unit_test(pipelines_with_bad_nodes_are_refused),
        cmocka_unit_test(bad_port_bindings_are_refused),
        cmocka_unit_test(bad_settings_of_nodes_are_refused),
        cmocka_unit_test(a_pipeline_may_have_32_nodes_and_no_more_images_than_fit),
        ON_BOTH(unknown_images_are_errors),
        ON_BOTH(nothing_is_read_before_a_frame_has_run),
        ON_BOTH(what_is_wanted_runs_and_what_is_left_out_is_neutral),
        ON_BOTH(nothing_is_wanted_until_something_is_asked_for_again),
        ON_BOTH(what_was_given_can_be_taken_back),
        ON_BOTH(wanting_all_runs_all_that_is_needed),
        ON_BOTH(a_background_of_the_user_takes_the_place_of_ours),
        ON_BOTH(given_depth_hides_the_fluid_behind_it),
        ON_BOTH(images_given_later_replace_earlier_ones),
        ON_BOTH(given_images_of_wrong_shape_are_refused),
        ON_BOTH(given_depths_are_before_the_eye),
        ON_BOTH(one_pixel_given_serves_the_whole_frame),
        ON_BOTH(given_fluid_needs_no_particles),
        ON_BOTH(memory_is_that_of_the_report),
        ON_BOTH(memory_has_the_format_that_is_stored),
        ON_BOTH(given_depth_tells_how_far_the_fluid_is),
        ON_BOTH(depth_given_at_half_resolution_is_scaled_up),
        ON_BOTH(low_resolution_without_upsampling_is_refused),
        ON_BOTH(low_resolutions_are_scaled_up_to_the_guides),
        ON_BOTH(images_finer_than_the_guide_are_refused),
        ON_BOTH(resolutions_below_a_tiles_are_refused),
        ON_BOTH(lengths_in_radii_need_a_radius),
        ON_BOTH(a_pass_by_itself_answers_to_its_ports),
        ON_BOTH(running_twice_gives_the_same_bits),
        ON_BOTH(other_frames_in_between_leave_no_trace),
        ON_BOTH(graphs_that_share_a_context_do_not_disturb_each_other),
        cmocka_unit_test(both_backends_draw_the_same_picture),
        ON_BOTH(the_report_says_what_ran_and_why_not),
        ON_BOTH(the_report_counts_and_times),
        ON_BOTH(the_report_counts_the_packets_that_culling_leaves),
        ON_BOTH(a_hosts_things_need_a_hosts_context),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_shared_gl_destroy);
}

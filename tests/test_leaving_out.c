/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_leaving_out.c: what a scene does not need is left out, and no picture changes by a bit for it. */
#include "tests/frames.h"

#include "graph/graph.h"

enum { W = 100, H = 66 }; /* px: 4 x 3 tiles, the last ones cut off */

/* ---- scenes ------------------------------------------------------------------------------------------------------ */

static void block(test_scene *s)
{
    test_scene_create_usual(s, W, H);
}

static void one_sphere(test_scene *s)
{
    test_scene_create(s, 1, (const double[3]){0.1, 0.2, 0.05}, 0.15);
    test_scene_look(s, (const double[3]){0.35, 0.62, 1.25}, (const double[3]){0, 0.2, 0}, 45, W, H);
}

static void empty(test_scene *s)
{
    test_scene_create(s, 0, NULL, 0);
    test_scene_look(s, (const double[3]){0.35, 0.62, 1.25}, (const double[3]){0, 0.2, 0}, 45, W, H);
}

static void no_particles(test_scene *s)
{
    empty(s);
    s->scene.particles = NULL;
}

static void all_behind_the_eye(test_scene *s)
{
    test_scene_create_usual(s, W, H);
    test_scene_look(s, (const double[3]){0.35, 0.62, 1.25}, (const double[3]){0.5, 0.7, 3}, 45, W, H);
}

static void a_fifth_of_the_screen(test_scene *s)
{
    test_scene_create_usual(s, W, H);
    test_scene_look(s, (const double[3]){0.35, 0.62, 1.9}, (const double[3]){0.75, 0.2, 0}, 50, W, H);
}

static void eye_inside_the_fluid(test_scene *s)
{
    test_scene_create_usual(s, W, H);
    test_scene_look(s, (const double[3]){0.02, 0.21, 0.01}, (const double[3]){1, 0.3, -0.2}, 80, W, H);
    s->scene.camera.near = 0.001;
}

static void far_strays(test_scene *s)
{
    const double strays[] = {-0.7, 0.1, 0, 0.7, 0.9, 0, -0.7, 0.9, -0.2, 0.6, 0.1, 0.1, 9, 9, 9, 0.35, 0.62, 1.26};
    test_scene_create(s, SSFR_COUNT(strays) / 3, strays, 0.02);
    test_scene_look(s, (const double[3]){0.35, 0.62, 1.25}, (const double[3]){0, 0.2, 0}, 45, W, H);
}

static void hidden_by_a_solid(test_scene *s)
{
    test_scene_create_usual(s, W, H);
    s->solids[0] = (ssfr_solid){.centre = {0.2, 0.4, 0.7}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                .half = {0.5, 0.5, 0.05}, .colour = {0.7, 0.2, 0.1}};
}

static void among_solids_of_all_shapes(test_scene *s)
{
    test_scene_create_usual(s, W, H);
    test_scene_add_shapes(s);
}

/* Some tiles show no solid, some no mesh. */
static void solids_without_a_floor(test_scene *s)
{
    among_solids_of_all_shapes(s);
    s->solids[5] = s->solids[0]; /* in the place of the plane */
    s->solids[5].centre[0] = -0.6;
    s->scene.floor = -INFINITY;
}

/* Some of it turns to foam, some is spray. */
static void block_that_foams(test_scene *s)
{
    test_scene_create_usual(s, W, H);
    ssfr_particles *p = s->particles;
    uint64_t seed = 5;
    assert_int_equal(ssfr_alloc(&p->velocity, 3 * p->n, sizeof *p->velocity, "velocities"), SSFR_OK);
    assert_int_equal(ssfr_alloc(&p->density, p->n, sizeof *p->density, "densities"), SSFR_OK);
    for (size_t i = 0; i < p->n; i++) {
        p->velocity[3 * i] = (float)test_random(&seed, 0, 2);
        p->density[i] = (float)test_random(&seed, 300, 1000);
    }
}

static const struct {
    const char *name;
    void (*create)(test_scene *);
} scenes[] = {
#define X(name) {#name, name}
    X(block), X(one_sphere), X(empty), X(no_particles), X(all_behind_the_eye), X(a_fifth_of_the_screen),
    X(eye_inside_the_fluid), X(far_strays), X(hidden_by_a_solid), X(among_solids_of_all_shapes),
    X(solids_without_a_floor), X(block_that_foams),
#undef X
};

/* ---- every pipeline, scene and variant --------------------------------------------------------------------------- */

static const char *const variants[][5] = {
    {NULL},
    {"downsample.factor=1", NULL},
    {"downsample.factor=1", "curvature_flow.iterations=0", NULL},
    {"curvature_flow.iterations=0", NULL},
    {"curvature_flow.iterations=0", "downsample.factor=4", "upsample.filter=linear", NULL},
    {"curvature_flow.iterations=1", "downsample.factor=8", "upsample.filter=nearest", NULL},
    {"curvature_flow.reference=nearest", "curvature_flow.off_axis=1", "curvature_flow.iterations=7", NULL},
    {"adaptive_flow.radius=0", "downsample.factor=1", NULL},
    {"adaptive_flow.stop=query", "adaptive_flow.copy=1", "adaptive_flow.constant=metres", NULL},
    {"noise_normals.height=0", NULL},
    {"noise_normals.height=0.3", NULL},
    {"noise_normals.height=0.3", "surface_noise.radius_scale=3", "downsample.factor=1", "noise_foam.strength=1", NULL},
    {"noise_normals.height=0.3", "surface_noise.off=1", NULL},
    {"noise_foam.strength=1", NULL},
    {"sphere_depth.splat=quad", "thickness.splat=quad", "sphere_depth.size=distance", NULL},
    {"sphere_depth.splat=exact", "thickness.splat=exact", "sphere_depth.radius_scale=1.7", NULL},
    {"thickness.radius_scale=3", "thickness.kernel=exponential", "thickness.occlusion=clipped", NULL},
    {"sphere_depth.root=ramp", "thickness.root=ramp_printed", NULL},
    {"composite.refraction=snell", "composite.reflection=scene", "composite.reject=0", NULL},
    {"downsample.off=1", "noise_foam.strength=0.5", "noise_foam.blend=over", NULL},
    {"weber.threshold=500", "sparse.by_foam=0", NULL},
    {"sparse.density_threshold=0", NULL},
    {"weber.transition=weber", "sparse.density_threshold=700", NULL},
    {"curvature_flow.off=1", NULL},
    {"thickness.off=1", "noise_normals.off=1", NULL},
    {"thickness.storage=half", NULL},
    {"layer_thickness.splat=exact", "layer_thickness.layers=fragment", "layer_thickness.storage=half", NULL},
    {"layer_thickness.radius_scale=3", "layer_thickness.kernel=exponential", "layer_thickness.occlusion=clipped", NULL},
    {"layer_thickness.splat=quad", "layer_thickness.as_printed=B14,B36", "layer_composite.as_printed=B11", NULL},
    {"layer_composite.surface=image", NULL},
    {"layer_composite.border=always", "downsample.factor=4", "layer_composite.reflection=scene", NULL},
    {"layer_composite.border=never", "downsample.factor=1", "layer_composite.as_printed=B28", NULL},
    {"shadow.kind=map", NULL},
    {"shadow.kind=ray", NULL},
    {"shadow.foam=off", "spray.occlusion=surface", NULL},
    {"shadow.foam=without_water", "foam_thickness.storage=half", "layer_thickness.as_printed=B14", NULL},
    {"shadow_map.off=1", NULL},
    {"shadow.kind=map", "shadow_map.off=1", NULL},
    {"light.elevation_deg=-30", "shadow_basis.terms=16", NULL},
};

/* Pipelines that lack a parameter run without it; whether there are all. */
static bool set_what_there_is(ssfr_graph *graph, const char *const *settings)
{
    bool all = true;
    for (int i = 0; settings[i]; i++) {
        char key[64];
        snprintf(key, sizeof key, "%.*s", (int)strcspn(settings[i], "="), settings[i]);
        if (ssfr_graph_row(graph, key)) test_graph_set(graph, (const char *[]){settings[i], NULL});
        else all = false;
    }
    return all;
}

static void assert_same_picture(ssfr_graph *graph, const char *result, const ssfr_scene *scene, const char *what)
{
    ssfr_field *without = test_graph_picture(graph, scene, result, false);
    ssfr_field *with = test_graph_picture(graph, scene, result, true);
    const size_t different = test_n_different(without, with);
    if (different) fail_msg("%s: %zu values differ", what, different);
    ssfr_field_destroy(&without);
    ssfr_field_destroy(&with);
}

static void pictures_are_the_same_to_the_bit(void **state)
{
    ssfr_gl *gl = test_backend(state);
    for (size_t k = 0; k < SSFR_COUNT(scenes); k++) {
        test_scene s;
        scenes[k].create(&s);
        for (int p = 0; ssfr_pipeline_at(p); p++)
            for (size_t v = 0; v < SSFR_COUNT(variants); v++) {
                const ssfr_pipeline *pipeline = ssfr_pipeline_at(p);
                ssfr_graph *graph = test_graph(pipeline, gl);
                char what[128];
                snprintf(what, sizeof what, "%s of %s, variant %zu", pipeline->name, scenes[k].name, v);
                if (set_what_there_is(graph, variants[v])) /* a variant of other pipelines would be another once more */
                    assert_same_picture(graph, ssfr_slots[pipeline->result].name, &s.scene, what);
                ssfr_graph_destroy(&graph);
            }
        test_scene_destroy(&s);
    }
}

static void pictures_without_any_one_node_are_the_same_to_the_bit(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    block(&s);
    for (int p = 0; ssfr_pipeline_at(p); p++) {
        const ssfr_pipeline *pipeline = ssfr_pipeline_at(p);
        for (int i = 0; pipeline->nodes[i].name; i++)
            for (int iterations = 0; iterations < 10; iterations += 5) {
                ssfr_graph *graph = test_graph(pipeline, gl);
                char off[64], steps[64], adaptive[64];
                snprintf(off, sizeof off, "%s.off=1", pipeline->nodes[i].name);
                snprintf(steps, sizeof steps, "curvature_flow.iterations=%d", iterations);
                snprintf(adaptive, sizeof adaptive, "adaptive_flow.iterations=%d", iterations);
                set_what_there_is(graph, (const char *[]){off, steps, adaptive, "downsample.factor=1",
                                                         "noise_normals.height=0.2", NULL});
                assert_same_picture(graph, ssfr_slots[pipeline->result].name, &s.scene, off);
                assert_int_equal(test_graph_node(graph, pipeline->nodes[i].name)->status, SSFR_OFF);
                ssfr_graph_destroy(&graph);
            }
    }
    test_scene_destroy(&s);
}

/* An image left out reads as one neutral pixel: the image that is not left out is neutral everywhere. */
static void assert_same_image(const ssfr_graph *lean, const ssfr_graph *full, const char *slot, const char *what)
{
    ssfr_field *without = test_graph_read(lean, slot), *with = test_graph_read(full, slot);
    const size_t n = (size_t)with->w * (size_t)with->h * (size_t)with->c;
    if (without->w == 1 && without->h == 1) {
        for (size_t i = 0; i < n; i++)
            if (with->data[i] != without->data[i % (size_t)with->c])
                fail_msg("%s of %s: %zu is %g", slot, what, i, with->data[i]);
    } else if (test_n_different(without, with)) {
        fail_msg("%s of %s differs", slot, what);
    }
    ssfr_field_destroy(&without);
    ssfr_field_destroy(&with);
}

static void every_image_is_the_same_to_the_bit(void **state)
{
    ssfr_gl *gl = test_backend(state);
    for (size_t k = 0; k < SSFR_COUNT(scenes); k++) {
        test_scene s;
        scenes[k].create(&s);
        for (int p = 0; ssfr_pipeline_at(p); p++) {
            ssfr_graph *lean = test_graph(ssfr_pipeline_at(p), gl), *full = test_graph(ssfr_pipeline_at(p), gl);
            set_what_there_is(lean, (const char *[]){"noise_normals.height=0.3", "noise_foam.strength=1", NULL});
            set_what_there_is(full, (const char *[]){"noise_normals.height=0.3", "noise_foam.strength=1", NULL});
            ssfr_graph_want_all(lean, true);
            assert_int_equal(ssfr_graph_run(lean, &s.scene, NULL), SSFR_OK);
            assert_int_equal(ssfr_graph_run(full, &s.scene, &(ssfr_run_options){.keep_all = true}), SSFR_OK);
            for (int i = 0; ssfr_graph_slot_at(lean, i); i++)
                assert_same_image(lean, full, ssfr_graph_slot_at(lean, i), scenes[k].name);
            ssfr_graph_destroy(&lean);
            ssfr_graph_destroy(&full);
        }
        test_scene_destroy(&s);
    }
}

/* What particles need that nobody sees: their packets are drawn, and all tiles; nodes are left out as before. */
static void culling_changes_no_picture_and_nothing_else(void **state)
{
    ssfr_gl *gl = test_backend(state);
    static void (*const partly_out_of_view[])(test_scene *) = {all_behind_the_eye, a_fifth_of_the_screen,
                                                               eye_inside_the_fluid, far_strays};
    for (size_t k = 0; k < SSFR_COUNT(partly_out_of_view); k++) {
        test_scene s;
        partly_out_of_view[k](&s);
        for (int p = 0; ssfr_pipeline_at(p); p++) {
            ssfr_graph *culled = test_graph(ssfr_pipeline_at(p), gl), *all = test_graph(ssfr_pipeline_at(p), gl);
            assert_int_equal(ssfr_graph_run(culled, &s.scene, NULL), SSFR_OK);
            assert_int_equal(ssfr_graph_run(all, &s.scene, &(ssfr_run_options){.no_culling = true}), SSFR_OK);
            const ssfr_report *a = ssfr_graph_report(culled), *b = ssfr_graph_report(all);
            assert_true(b->covered == 1 && b->n_packets_seen == b->n_packets);
            assert_int_equal(b->n_particles, s.scene.particles ? s.scene.particles->n : 0);
            assert_int_equal(a->n_packets, b->n_packets);
            assert_true(a->n_packets_seen <= b->n_packets_seen && a->n_particles <= b->n_particles);
            for (int i = 0; i < a->n_nodes; i++) assert_int_equal(a->nodes[i].status, b->nodes[i].status);
            assert_same_image(culled, all, "color", ssfr_pipeline_name(ssfr_pipeline_at(p)));
            ssfr_graph_destroy(&culled);
            ssfr_graph_destroy(&all);
        }
        test_scene_destroy(&s);
    }
}

static void packets_behind_the_eye_are_not_drawn_unless_asked_for(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    all_behind_the_eye(&s);
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), gl);
    for (int no_culling = 0; no_culling < 2; no_culling++) {
        assert_int_equal(ssfr_graph_run(graph, &s.scene, &(ssfr_run_options){.no_culling = no_culling}), SSFR_OK);
        const ssfr_report *report = ssfr_graph_report(graph);
        assert_int_equal(report->n_packets, 7);
        assert_int_equal(report->n_packets_seen, no_culling ? 7 : 0);
        assert_int_equal(report->n_particles, no_culling ? 432 : 0);
        assert_true(report->covered == no_culling);
        assert_int_not_equal(test_graph_node(graph, "sphere_depth")->status, SSFR_RAN);
    }
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

/* Unless particles have velocity and density, nodes that tell water from foam are as if they were not there. */
static void water_of_which_nothing_is_known_is_drawn_as_without_foam(void **state)
{
    ssfr_gl *gl = test_backend(state);
    for (int foams = 0; foams < 2; foams++) {
        test_scene s;
        ssfr_graph *with = test_graph(ssfr_pipeline_find("bagar2010"), gl);
        ssfr_graph *without = test_graph(ssfr_pipeline_find("bagar2010"), gl);
        test_graph_set(without, (const char *[]){"weber.off=1", "sparse.off=1", NULL});
        if (foams) block_that_foams(&s);
        else block(&s);
        ssfr_field *a = test_graph_picture(with, &s.scene, "color", false);
        ssfr_field *b = test_graph_picture(without, &s.scene, "color", false);
        assert_true((test_n_different(a, b) == 0) == !foams);
        assert_int_equal(test_graph_node(with, "weber")->status, foams ? SSFR_RAN : SSFR_NEEDLESS);
        ssfr_field_destroy(&a), ssfr_field_destroy(&b);
        ssfr_graph_destroy(&with), ssfr_graph_destroy(&without);
        test_scene_destroy(&s);
    }
}

/* ---- what is left out -------------------------------------------------------------------------------------------- */

/* A letter a node: ran, off, unwanted, needless, given. */
static const char *statuses(const ssfr_graph *graph)
{
    static char text[64];
    const ssfr_report *report = ssfr_graph_report(graph);
    for (int i = 0; i < report->n_nodes; i++) text[i] = "ROUNG"[report->nodes[i].status];
    text[report->n_nodes] = '\0';
    return text;
}

static void what_is_left_out_is_what_is_not_needed(void **state)
{
    /* background sphere_depth downsample curvature_flow upsample normals thickness surface_noise noise_normals
     * composite noise_foam */
    static const struct {
        void (*scene)(test_scene *);
        const char *settings[4], *expected;
    } cases[] = {
        {block, {NULL}, "RRRRRRRUNRN"},
        {one_sphere, {NULL}, "RRRRRRRUNRN"},
        {hidden_by_a_solid, {NULL}, "RRRRRRRUNRN"},
        {block, {"downsample.factor=1", NULL}, "RRNRNRRUNRN"},
        {block, {"downsample.factor=1", "curvature_flow.iterations=0", NULL}, "RRNNNRRUNRN"},
        {block, {"curvature_flow.iterations=0", NULL}, "RRRNRRRUNRN"},
        {block, {"noise_normals.height=0.3", NULL}, "RRRRRRRRRRN"},
        {block, {"noise_normals.height=0.3", "surface_noise.off=1", NULL}, "RRRRRRRORRN"},
        {block, {"thickness.off=1", NULL}, "RRRRRROUNRN"},
        {block, {"composite.off=1", NULL}, "RUUUUUUUUON"},
        {block, {"noise_normals.off=1", "noise_normals.height=0.3", NULL}, "RRRRRRRUORN"},
        {block, {"noise_foam.strength=1", NULL}, "RRRRRRRRNRR"},
        {block, {"noise_foam.strength=1", "noise_foam.off=1", NULL}, "RRRRRRRUNRO"},
        {block, {"noise_foam.strength=1", "surface_noise.off=1", NULL}, "RRRRRRRONRR"},
        {block, {"noise_foam.strength=1", "composite.off=1", NULL}, "RRRRRRURNOR"},
        {empty, {"noise_foam.strength=1", NULL}, "RUUUUUUUUNN"},
        {empty, {NULL}, "RUUUUUUUUNN"},
        {no_particles, {NULL}, "RUUUUUUUUNN"},
        {all_behind_the_eye, {"noise_normals.height=0.3", NULL}, "RUUUUUUUUNN"},
    };
    ssfr_gl *gl = test_backend(state);
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        test_scene s;
        ssfr_graph *graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), gl);
        cases[i].scene(&s);
        test_graph_set(graph, cases[i].settings);
        assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
        if (strcmp(statuses(graph), cases[i].expected) != 0)
            fail_msg("case %zu: %s, expected %s", i, statuses(graph), cases[i].expected);
        ssfr_graph_destroy(&graph);
        test_scene_destroy(&s);
    }
}

static void foams_without_solids(test_scene *s)
{
    block_that_foams(s);
    s->scene.n_solids = 0;
}

static void foams_out_of_view(test_scene *s)
{
    block_that_foams(s);
    test_scene_look(s, (const double[3]){0.35, 0.62, 1.25}, (const double[3]){0.5, 0.7, 3}, 45, W, H);
}

/* No foam in view: no foam pass, no layer split, one thickness. No caster of shadows: no shadow map. No spray in view:
 * no spray pass. */
static void layers_are_left_out_by_what_is_in_view(void **state)
{
    static const char *const names[] = {"weber", "sparse", "foam_depth", "layer_thickness", "foam_thickness",
                                        "shadow_map", "shadow_basis", "shadow", "spray"};
    static const struct {
        void (*scene)(test_scene *);
        const char *settings[3], *expected;
        bool split; /* water before the foam has a thickness of its own */
    } cases[] = {
        {block_that_foams, {NULL}, "RRRRRRRRR", true},
        {block_that_foams, {"weber.threshold=1e9", NULL}, "RRNRNRRRR", false},
        {block_that_foams, {"weber.off=1", NULL}, "ORNRNRRRR", false},
        {block_that_foams, {"sparse.density_threshold=0", NULL}, "RRRRRRRRN", true},
        {block_that_foams, {"weber.off=1", "sparse.density_threshold=0", NULL}, "ONNRNRRRN", false},
        {block_that_foams, {"spray.strength=0", NULL}, "RRRRRRRRN", true},
        {block, {NULL}, "NRNRNRRRN", false},
        {foams_without_solids, {NULL}, "RRRRRUUNR", true},
        {foams_out_of_view, {NULL}, "RRUUUUUUN", false},
        {empty, {NULL}, "NRUUUUUUN", false},
    };
    ssfr_gl *gl = test_backend(state);
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        test_scene s;
        char got[SSFR_COUNT(names) + 1] = "";
        ssfr_graph *graph = test_graph(ssfr_pipeline_find("bagar2010"), gl);
        cases[i].scene(&s);
        test_graph_set(graph, cases[i].settings);
        assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
        for (size_t k = 0; k < SSFR_COUNT(names); k++) got[k] = "ROUNG"[test_graph_node(graph, names[k])->status];
        if (strcmp(got, cases[i].expected) != 0)
            fail_msg("case %zu: %s, expected %s", i, got, cases[i].expected);
        ssfr_field *front = test_graph_read(graph, "thickness_front");
        assert_true((front->w > 1) == cases[i].split);
        ssfr_field_destroy(&front);
        ssfr_graph_destroy(&graph);
        test_scene_destroy(&s);
    }
}

static void an_input_that_is_not_read_runs_nothing(void **state)
{
    static const char *const names[] = {"downsample", "adaptive_flow", "upsample", "normals", "layer_composite"};
    static const struct {
        const char *settings[4], *wanted, *expected;
    } cases[] = {
        {{NULL}, "color", "RRUUR"},
        {{NULL}, "border", "RRUUR"},
        {{NULL}, "normal", "RRRRR"},
        {{NULL}, "surface_depth", "RRRUR"},
        {{"layer_composite.surface=image", NULL}, "border", "RRRRR"},
        {{"layer_composite.surface=image", "downsample.factor=1", NULL}, "color", "NRNRR"},
        {{"downsample.factor=1", NULL}, "color", "NRUUR"},
        {{"downsample.factor=1", "adaptive_flow.radius=0", NULL}, "color", "NNUUR"},
        {{"layer_composite.off=1", NULL}, "color", "UUUUO"},
    };
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    block(&s);
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_graph *graph = test_graph(ssfr_pipeline_find("bagar2010"), gl);
        test_graph_set(graph, cases[i].settings);
        assert_int_equal(ssfr_graph_want(graph, cases[i].wanted), SSFR_OK);
        assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
        for (size_t k = 0; k < SSFR_COUNT(names); k++)
            if ("ROUNG"[test_graph_node(graph, names[k])->status] != cases[i].expected[k])
                fail_msg("case %zu: %s is not %c", i, names[k], cases[i].expected[k]);
        ssfr_graph_destroy(&graph);
    }
    test_scene_destroy(&s);
}

/* Spray that the surface does not hide asks for no surface, nor for foam that nobody else asks for. */
static void spray_asks_for_the_surface_where_that_hides_it(void **state)
{
    static const char *const names[] = {"upsample", "foam_depth", "spray"};
    static const struct {
        const char *settings[5], *expected;
    } cases[] = {
        {{NULL}, "URR"},
        {{"spray.occlusion=surface", NULL}, "RRR"},
        {{"layer_composite.off=1", NULL}, "UUR"},
        {{"layer_composite.off=1", "spray.occlusion=surface", NULL}, "RRR"},
    };
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    block_that_foams(&s);
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_graph *graph = test_graph(ssfr_pipeline_find("bagar2010"), gl);
        test_graph_set(graph, cases[i].settings);
        assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
        for (size_t k = 0; k < SSFR_COUNT(names); k++)
            if ("ROUNG"[test_graph_node(graph, names[k])->status] != cases[i].expected[k])
                fail_msg("case %zu: %s is not %c", i, names[k], cases[i].expected[k]);
        ssfr_graph_destroy(&graph);
    }
    test_scene_destroy(&s);
}

/* What is optional is left out of the program, too. */
static void a_picture_is_the_same_whether_its_border_is_wanted(void **state)
{
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("bagar2010"), test_backend(state));
    test_scene s;
    among_solids_of_all_shapes(&s);
    ssfr_field *without = test_graph_picture(graph, &s.scene, "color", false);
    assert_int_equal(ssfr_graph_want(graph, "border"), SSFR_OK);
    ssfr_field *with = test_graph_picture(graph, &s.scene, "color", false);
    ssfr_field *border = test_graph_read(graph, "border");
    size_t n = 0;
    for (size_t i = 0; i < (size_t)W * H; i++) n += border->data[i] == 1;
    assert_true(n > 10 && n < (size_t)W * H / 2);
    assert_int_equal(test_n_different(without, with), 0);
    ssfr_field_destroy(&border);
    ssfr_field_destroy(&with);
    ssfr_field_destroy(&without);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void who_wants_depth_alone_pays_for_no_compositing(void **state)
{
    ssfr_gl *gl = test_backend(state);
    ssfr_pipeline depth_alone = *ssfr_pipeline_find("vanderlaan2009");
    depth_alone.result = SSFR_SLOT_surface_depth;
    test_scene s;
    block(&s);
    ssfr_graph *graph = test_graph(&depth_alone, gl);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_string_equal(statuses(graph), "RRRRRUUUUUU");
    assert_int_equal(ssfr_graph_want(graph, "normal"), SSFR_OK);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_string_equal(statuses(graph), "RRRRRRUUUUU");
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void keeping_all_runs_all_on_every_tile(void **state)
{
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), test_backend(state));
    test_scene s;
    a_fifth_of_the_screen(&s);
    const ssfr_report *report = ssfr_graph_report(graph);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    assert_true(report->covered > 0.05 && report->covered < 0.5);
    assert_int_equal(ssfr_graph_run(graph, &s.scene, &(ssfr_run_options){.keep_all = true}), SSFR_OK);
    assert_string_equal(statuses(graph), "RRRRRRRRRRR");
    assert_true(report->covered == 1);
    assert_int_equal(report->n_particles, 432);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_BOTH(pictures_are_the_same_to_the_bit),
        ON_BOTH(pictures_without_any_one_node_are_the_same_to_the_bit),
        ON_BOTH(every_image_is_the_same_to_the_bit),
        ON_BOTH(culling_changes_no_picture_and_nothing_else),
        ON_BOTH(packets_behind_the_eye_are_not_drawn_unless_asked_for),
        ON_BOTH(water_of_which_nothing_is_known_is_drawn_as_without_foam),
        ON_BOTH(what_is_left_out_is_what_is_not_needed),
        ON_BOTH(layers_are_left_out_by_what_is_in_view),
        ON_BOTH(an_input_that_is_not_read_runs_nothing),
        ON_BOTH(spray_asks_for_the_surface_where_that_hides_it),
        ON_BOTH(a_picture_is_the_same_whether_its_border_is_wanted),
        ON_BOTH(who_wants_depth_alone_pays_for_no_compositing),
        ON_BOTH(keeping_all_runs_all_on_every_tile),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_shared_gl_destroy);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_allocations.c: a frame allocates nothing after the first of its kind, and running out of memory is an error at
 * each allocation. */
#include "tests/counted_memory.h"
#include "tests/frames.h"

#include "graph/graph.h"

static void start_counting(long failing)
{
    n_made = 0;
    fails_at = failing;
    test_clear_log();
}

/* What was allocated since, and no more failing. */
static long stop_counting(void)
{
    fails_at = -1;
    return n_made;
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

static long run_and_count(ssfr_graph *graph, const ssfr_scene *scene, const ssfr_run_options *options)
{
    start_counting(-1);
    assert_int_equal(ssfr_graph_run(graph, scene, options), SSFR_OK);
    return stop_counting();
}

static void a_frame_allocates_nothing_after_the_first(void **state)
{
    static const char *const variants[][4] = {
        {NULL},
        {"downsample.factor=4", "noise_normals.height=0.3", NULL},
        {"noise_foam.strength=1", NULL},
        {"sphere_depth.splat=exact", "thickness.splat=quad", "thickness.storage=half", NULL},
        {"curvature_flow.iterations=3", "composite.refraction=snell", NULL},
    };
    static const ssfr_run_options options[] = {{0}, {.keep_all = true}, {.timing = true}};
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 96, 64);
    test_scene_add_shapes(&s);
    for (size_t v = 0; v < SSFR_COUNT(variants); v++)
        for (size_t o = 0; o < SSFR_COUNT(options); o++) {
            ssfr_graph *graph = test_graph(ssfr_pipeline_at(0), gl);
            test_graph_set(graph, variants[v]);
            const long first = run_and_count(graph, &s.scene, &options[o]);
            assert_true(gl || first > 10); /* on the GPU the driver allocates */
            assert_true(ssfr_graph_report(graph)->allocations > 5);
            for (int i = 0; i < 3; i++) {
                s.scene.camera.eye[0] += 0.01;
                assert_int_equal(run_and_count(graph, &s.scene, &options[o]), 0);
                assert_int_equal(ssfr_graph_report(graph)->allocations, 0);
            }
            ssfr_graph_destroy(&graph);
        }
    test_scene_destroy(&s);
}

static void parameters_of_the_same_sizes_allocate_nothing(void **state)
{
    ssfr_gl *gl = test_backend(state);
    static const char *const keys[] = {"medium.ior=1.5", "curvature_flow.iterations=7", "composite.fresnel=exact",
                                       "sphere_depth.radius_scale=2", "noise_normals.height=0", "light.azimuth_deg=10",
                                       "noise_foam.strength=0"};
    test_scene s;
    test_scene_create_usual(&s, 96, 64);
    ssfr_graph *graph = test_graph(ssfr_pipeline_at(0), gl);
    test_graph_set(graph, (const char *[]){"noise_normals.height=0.3", "noise_foam.strength=1", NULL});
    run_and_count(graph, &s.scene, NULL);
    for (size_t i = 0; i < SSFR_COUNT(keys); i++) {
        test_graph_set(graph, (const char *[]){keys[i], NULL});
        assert_int_equal(run_and_count(graph, &s.scene, NULL), 0);
        assert_int_equal(ssfr_graph_report(graph)->allocations, 0);
    }
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void other_particles_of_the_same_number_cost_one_upload(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s, other;
    test_scene_create_usual(&s, 96, 64);
    test_scene_create_usual(&other, 96, 64);
    ssfr_graph *graph = test_graph(ssfr_pipeline_at(0), gl);
    run_and_count(graph, &s.scene, NULL);
    assert_int_equal(run_and_count(graph, &other.scene, NULL), 0);
    assert_int_equal(ssfr_graph_report(graph)->allocations, *state ? 1 : 0);
    assert_int_equal(run_and_count(graph, &other.scene, NULL), 0);
    assert_int_equal(ssfr_graph_report(graph)->allocations, 0);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
    test_scene_destroy(&other);
}

/* Foam and sizes from densities, in the usual scene; and a table. */
static const ssfr_pipeline foamy = {
    .name = "foamy", .source = "test", .help = "test", .result = SSFR_SLOT_fluid_depth,
    .nodes = {{"weber_foam", .settings = {"threshold=500"}}, {"sparse"}, {"sphere_depth", .settings = {"root=ramp"}}},
};

static void give_quantities(test_scene *s)
{
    ssfr_particles *p = s->particles;
    uint64_t seed = 7;
    assert_int_equal(ssfr_alloc(&p->velocity, 3 * p->n, sizeof *p->velocity, "velocities"), SSFR_OK);
    assert_int_equal(ssfr_alloc(&p->density, p->n, sizeof *p->density, "densities"), SSFR_OK);
    for (size_t i = 0; i < 3 * p->n; i++) p->velocity[i] = (float)test_random(&seed, -1, 1);
    for (size_t i = 0; i < p->n; i++) p->density[i] = (float)test_random(&seed, 100, 1100);
}

static void values_of_particles_allocate_nothing_after_the_first_frame(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene scenes[2];
    for (int i = 0; i < 2; i++) test_scene_create_usual(&scenes[i], 96, 64), give_quantities(&scenes[i]);
    ssfr_graph *graph = test_graph(&foamy, gl);
    run_and_count(graph, &scenes[0].scene, NULL);
    for (int i = 0; i < 4; i++) {
        ssfr_scene *scene = &scenes[i % 2].scene;
        scene->timed = i > 1;
        scene->time = 0.1 * i;
        assert_int_equal(run_and_count(graph, scene, NULL), 0);
        assert_int_equal(ssfr_graph_report(graph)->allocations, *state ? i > 0 : 0); /* positions of other particles */
        assert_int_equal(test_graph_node(graph, "sphere_depth")->status, SSFR_RAN);
    }
    ssfr_graph_destroy(&graph);
    for (int i = 0; i < 2; i++) test_scene_destroy(&scenes[i]);
}

/* ---- running out of memory --------------------------------------------------------------------------------------- */

/* One error line for a failure, none else. */
static void assert_failed_once(ssfr_result result)
{
    assert_int_equal(result, SSFR_ERR_MEMORY);
    test_assert_logged("no memory for", __FILE__, __LINE__);
}

static void run_out_everywhere(const ssfr_pipeline *pipeline, int least_in_create, int least_in_run)
{
    test_scene s;
    test_scene_create_usual(&s, 37, 23);
    test_scene_add_shapes(&s);
    give_quantities(&s);
    const long live = n_live;
    bool failed = true;
    int n_in_create = 0, n_in_run = 0;
    for (int n = 0; failed; n++) {
        ssfr_graph *graph = NULL;
        start_counting(n);
        ssfr_result result = ssfr_graph_create(&graph, pipeline, NULL);
        n_in_create += result != SSFR_OK;
        if (result == SSFR_OK) {
            result = ssfr_graph_run(graph, &s.scene, NULL);
            n_in_run += result != SSFR_OK;
        } else {
            assert_null(graph);
        }
        failed = stop_counting() > n;
        if (failed) assert_failed_once(result);
        if (graph && failed) assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK); /* it can go on */
        ssfr_graph_destroy(&graph);
        assert_int_equal(n_live, live);
    }
    assert_true(n_in_create > least_in_create && n_in_run > least_in_run);
    test_scene_destroy(&s);
}

static void running_out_anywhere_in_making_and_running_a_graph_is_an_error(void **state)
{
    (void)state;
    run_out_everywhere(ssfr_pipeline_at(0), 60, 10);
    run_out_everywhere(&foamy, 30, 12);
}

/* The programs of shaders are kept, so each round comes further than the last. */
static void running_out_on_the_gpu_is_an_error(void **state)
{
    (void)state;
    test_scene s;
    ssfr_field *picture = NULL;
    ssfr_gl *gl = test_gl_or_skip(); /* with no program yet */
    bool failed = true;
    test_scene_create_usual(&s, 37, 23);
    test_scene_add_shapes(&s);
    for (int n = 0; failed && n < 2000; n++) {
        ssfr_graph *graph = NULL;
        start_counting(n);
        ssfr_result result = ssfr_graph_create(&graph, ssfr_pipeline_at(0), gl);
        if (result == SSFR_OK) result = ssfr_graph_run(graph, &s.scene, NULL);
        if (result == SSFR_OK) result = ssfr_graph_read(graph, "color", &picture);
        failed = stop_counting() > n;
        if (failed) assert_failed_once(result);
        if (failed) assert_null(picture);
        ssfr_graph_destroy(&graph);
    }
    assert_false(failed);
    assert_int_equal(picture->w, 37);
    ssfr_field_destroy(&picture);
    ssfr_gl_destroy(&gl);
    test_scene_destroy(&s);
}

static void running_out_while_a_context_is_made_is_an_error(void **state)
{
    (void)state;
    test_shared_gl(); /* or skip */
    bool failed = true;
    for (int n = 0; failed; n++) {
        ssfr_gl *gl = NULL;
        start_counting(n);
        const ssfr_result result = ssfr_gl_create(&gl, SSFR_GL_OWN);
        failed = stop_counting() > n;
        if (failed) assert_failed_once(result), assert_null(gl);
        else assert_int_equal(result, SSFR_OK);
        ssfr_gl_destroy(&gl);
    }
}

static void running_out_in_reading_and_giving_is_an_error(void **state)
{
    ssfr_gl *gl = test_backend(state);
    test_scene s;
    test_scene_create_usual(&s, 37, 23);
    ssfr_graph *graph = test_graph(ssfr_pipeline_at(0), gl);
    ssfr_field *color = test_image(37, 23, 3, 0.5), *read = NULL;
    run_and_count(graph, &s.scene, NULL);
    bool failed = true;
    for (int n = 0; failed; n++) {
        start_counting(n);
        ssfr_result result = ssfr_graph_read(graph, "color", &read);
        if (result == SSFR_OK) result = ssfr_graph_import(graph, "scene_color", color);
        failed = stop_counting() > n;
        if (failed) assert_failed_once(result);
        ssfr_field_destroy(&read);
    }
    assert_int_equal(ssfr_graph_run(graph, &s.scene, NULL), SSFR_OK);
    ssfr_field_destroy(&color);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void running_out_while_particles_are_packed_is_an_error(void **state)
{
    (void)state;
    double positions[3 * 600];
    uint32_t ids[600] = {0};
    uint64_t seed = 3;
    for (int i = 0; i < 3 * 600; i++) positions[i] = test_random(&seed, -1, 1);
    const ssfr_particles given = {.radius = 0.02, .id = ids, .kind = ids};
    const long live = n_live;
    bool failed = true;
    for (int n = 0; failed; n++) {
        ssfr_particles *particles = NULL;
        start_counting(n);
        const ssfr_result result = ssfr_particles_create(&particles, 600, positions, &given);
        failed = stop_counting() > n;
        if (failed) assert_failed_once(result), assert_null(particles);
        ssfr_particles_destroy(&particles);
        assert_int_equal(n_live, live);
    }
}

/* Everything that is computed from particles, and all of it again after a failure. */
static ssfr_result compute_all(ssfr_weber *weber, ssfr_particles *p)
{
    static float foam[600], centre[3 * 600], shape[6 * 600];
    double threshold;
    ssfr_result result = SSFR_OK;
    free(p->density), free(p->neighbours);
    p->density = NULL, p->neighbours = NULL;
    SSFR_TRY(ssfr_particles_complete(p, NULL));
    SSFR_TRY(ssfr_particles_anisotropy(p, NULL, centre, shape));
    SSFR_TRY(ssfr_weber_threshold(p, NULL, 0.1, &threshold));
    SSFR_TRY(ssfr_weber_step(weber, p, 0.1, foam, NULL, NULL));
end:
    return result;
}

static void running_out_while_particles_are_measured_is_an_error(void **state)
{
    (void)state;
    double positions[3 * 600];
    float velocity[3 * 600] = {0};
    uint32_t ids[600];
    uint64_t seed = 3;
    for (int i = 0; i < 3 * 600; i++) positions[i] = test_random(&seed, -0.1, 0.1);
    for (uint32_t i = 0; i < 600; i++) ids[i] = i;
    const ssfr_particles given = {.radius = 0.02, .id = ids, .velocity = velocity};
    ssfr_particles *particles = NULL;
    assert_int_equal(ssfr_particles_create(&particles, 600, positions, &given), SSFR_OK);
    ssfr_weber *first = NULL;
    assert_int_equal(ssfr_weber_create(&first, NULL), SSFR_OK);
    assert_int_equal(compute_all(first, particles), SSFR_OK);
    ssfr_weber_destroy(&first);
    const long live = n_live;
    bool failed = true;
    int n_failed = 0;
    for (int n = 0; failed; n++) {
        ssfr_weber *weber = NULL;
        start_counting(n);
        ssfr_result result = ssfr_weber_create(&weber, NULL);
        if (result == SSFR_OK) result = compute_all(weber, particles);
        else assert_null(weber);
        failed = stop_counting() > n;
        n_failed += failed;
        if (failed) assert_failed_once(result);
        ssfr_weber *again = NULL;
        if (!weber) assert_int_equal(ssfr_weber_create(&again, NULL), SSFR_OK);
        assert_int_equal(compute_all(weber ? weber : again, particles), SSFR_OK);
        ssfr_weber_destroy(&weber);
        ssfr_weber_destroy(&again);
        assert_int_equal(n_live, live);
    }
    assert_true(n_failed > 15);
    ssfr_particles_destroy(&particles);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_BOTH(a_frame_allocates_nothing_after_the_first),
        ON_BOTH(parameters_of_the_same_sizes_allocate_nothing),
        ON_BOTH(other_particles_of_the_same_number_cost_one_upload),
        ON_BOTH(values_of_particles_allocate_nothing_after_the_first_frame),
        cmocka_unit_test(running_out_anywhere_in_making_and_running_a_graph_is_an_error),
        cmocka_unit_test(running_out_on_the_gpu_is_an_error),
        cmocka_unit_test(running_out_while_a_context_is_made_is_an_error),
        ON_BOTH(running_out_in_reading_and_giving_is_an_error),
        cmocka_unit_test(running_out_while_particles_are_packed_is_an_error),
        cmocka_unit_test(running_out_while_particles_are_measured_is_an_error),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_shared_gl_destroy);
}

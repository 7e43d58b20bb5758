/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_particle_values.c: values of particles reach what is drawn, on both twins; what nodes keep between frames. */
#include "tests/pass_util.h"

#include "graph/internal.h"
#include "passes/splat.h"

enum { W = 96, H = 72, MOST = 20000 };

static const ssfr_pipeline sized = {
    .name = "sized", .source = "", .help = "", .result = SSFR_SLOT_fluid_depth,
    .nodes = {{"sparse"}, {"sphere_depth"}, {"thickness"}},
};
static const ssfr_pipeline plain = {
    .name = "plain", .source = "", .help = "", .result = SSFR_SLOT_fluid_depth,
    .nodes = {{"sphere_depth"}, {"thickness"}},
};

/* ---- a particle node of this test's own -------------------------------------------------------------------------- */

static struct {
    float sizes[MOST]; /* by id */
    int n_runs, n_finished, n_seen; /* n_seen: of the state */
    double dt;
    ssfr_result result;
} probe;

static ssfr_result run_probe(const ssfr_run *run)
{
    const ssfr_particles *p = run->frame->particles;
    int *state = run->state;
    probe.n_runs++;
    probe.dt = run->dt;
    if (state) probe.n_seen = ++*state;
    if (probe.result != SSFR_OK) return ssfr_fail(probe.result, "the probe fails");
    for (size_t i = 0; i < p->n; i++) {
        run->values_out[0][i] = probe.sizes[p->id ? p->id[i] : 0];
        run->values_out[1][i] = 0;
    }
    return SSFR_OK;
}

static void finish_probe(void *state)
{
    probe.n_finished += *(int *)state;
}

static ssfr_pass pass; /* in the place of `sparse`, with its ports and parameters */

static void put_probe(test_twin *t)
{
    pass = *ssfr_pass_find("sparse");
    pass.particles_run = run_probe;
    pass.needed = NULL;
    pass.state_size = sizeof(int);
    pass.state_finish = finish_probe;
    memset(&probe, 0, sizeof probe);
    for (size_t i = 0; i < MOST; i++) probe.sizes[i] = 1;
    t->graph->nodes[0].pass = &pass;
    t->graph->nodes[0].state = calloc(1, sizeof(int));
    assert_non_null(t->graph->nodes[0].state);
}

static test_twin *with_probe(void **state)
{
    test_twin *t = test_twin_create_for(state, &sized, W, H);
    put_probe(t);
    return t;
}

static void place(test_twin *t, size_t n, const double (*eye)[3], double radius)
{
    static uint32_t ids[MOST];
    for (size_t i = 0; i < n; i++) ids[i] = (uint32_t)i;
    test_twin_place(t, n, eye, radius, ids);
}

static void place_one(test_twin *t, double radius)
{
    place(t, 1, (const double[][3]){{0.02, -0.03, -1}}, radius);
}

static void give_density(test_twin *t, float density)
{
    ssfr_particles *p = (ssfr_particles *)t->scene.particles; /* which the test made */
    assert_int_equal(ssfr_alloc(&p->density, p->n, sizeof *p->density, "densities"), SSFR_OK);
    for (size_t i = 0; i < p->n; i++) p->density[i] = density;
}

static void place_cloud(test_twin *t, size_t n, double z_lo, double z_hi, double radius)
{
    static double eye[MOST][3];
    uint64_t seed = 41;
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++)
            eye[i][k] = k == 2 ? test_random(&seed, z_lo, z_hi) : test_random(&seed, -0.7, 0.7);
    for (size_t i = 0; i < n; i++) probe.sizes[i] = i % 5 ? (float)test_random(&seed, 0.1, 1.3) : 0;
    place(t, n, eye, radius);
}

static ssfr_node_status status_of(const test_twin *t, int node)
{
    return ssfr_graph_report(t->graph)->nodes[node].status;
}

static ssfr_result run_frame(test_twin *t)
{
    return ssfr_graph_run(t->graph, &t->scene, NULL);
}

/* ---- what is drawn ----------------------------------------------------------------------------------------------- */

static const double places[][3] = {
    {-0.3, 0.2, -1.1}, {0.2, 0.1, -1}, {0, -0.2, -0.9}, {0.3, -0.2, -1.4}, {-0.2, -0.2, -1.2}};
static const float place_sizes[] = {1, 0.5f, 0, 1.75f, 0.25f};

static void depth_is_that_of_spheres_of_their_own_radii(void **state)
{
    test_twin *t = with_probe(state);
    const double radius = 0.11;
    int n_surface = 0;
    for (size_t i = 0; i < SSFR_COUNT(places); i++) probe.sizes[i] = place_sizes[i];
    place(t, SSFR_COUNT(places), places, radius);
    test_twin_set(t, "sphere_depth.splat", "exact");
    const ssfr_field *depth = test_twin_run(t, "fluid_depth");
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            double expected = -SSFR_EMPTY;
            bool edge = false;
            for (size_t i = 0; i < SSFR_COUNT(places); i++) {
                const double r = radius * (double)place_sizes[i];
                const test_hit hit = test_meet(places[i], r, test_ray_at(t, x, y, 1));
                edge |= fabs(hit.miss - r) < 0.01 * radius; /* where rounding of a centre weighs most */
                if (hit.miss < r) expected = fmax(expected, hit.front);
            }
            if (edge) continue;
            assert_close(*ssfr_field_at(depth, x, y), expected, t->gl ? 1e-5 : 1e-6, 1e-6); /* centres are floats */
            n_surface += ssfr_is_surface(expected);
        }
    assert_true(n_surface > 300);
}

static void a_particle_of_half_the_size_is_one_of_half_the_radius(void **state)
{
    static const char *const forms[] = {"point", "quad", "exact"}, *const slots[] = {"fluid_depth", "thickness"};
    for (size_t f = 0; f < SSFR_COUNT(forms); f++) {
        test_twin *half = with_probe(state), *whole = test_twin_create_for(state, &plain, W, H);
        probe.sizes[0] = 0.5f;
        place_one(half, 0.3);
        place_one(whole, 0.15);
        for (size_t s = 0; s < SSFR_COUNT(slots); s++) {
            test_twin_set(half, s ? "thickness.splat" : "sphere_depth.splat", "%s", forms[f]);
            test_twin_set(whole, s ? "thickness.splat" : "sphere_depth.splat", "%s", forms[f]);
            const ssfr_field *a = test_twin_run(half, slots[s]), *b = test_twin_run(whole, slots[s]);
            assert_true(test_difference(a, b) <= (half->gl ? 4e-7 : 0));
            if (s == 0) assert_true(test_count(a) > 200);
        }
    }
}

static void sizes_of_one_change_no_bit(void **state)
{
    static const char *const slots[] = {"fluid_depth", "thickness"};
    test_twin *with = with_probe(state), *without = test_twin_create_for(state, &plain, W, H);
    place_cloud(with, 500, -2, -0.5, 0.03);
    without->scene.particles = with->scene.particles;
    for (size_t i = 0; i < MOST; i++) probe.sizes[i] = 1;
    for (size_t s = 0; s < SSFR_COUNT(slots); s++) {
        const ssfr_field *expected = test_twin_run(without, slots[s]);
        ssfr_node_status status;
        assert_true(test_same_bits(test_twin_run(with, slots[s]), expected));
        assert_true(test_same_bits(test_twin_run_if_needed(with, slots[s], &status), expected));
        assert_int_equal(status, SSFR_RAN);
        test_twin_set(with, "sparse.off", "1");
        assert_true(test_same_bits(test_twin_run(with, slots[s]), expected));
        test_twin_set(with, "sparse.off", "0");
    }
}

static void what_is_left_out_changes_no_bit(void **state)
{
    static const char *const slots[] = {"fluid_depth", "thickness"};
    test_twin *t = with_probe(state);
    ssfr_node_status status;
    place_cloud(t, 3000, -2, 1.5, 0.03); /* packets before and behind the eye */
    for (size_t s = 0; s < SSFR_COUNT(slots); s++) {
        const ssfr_field *lean = test_twin_run_if_needed(t, slots[s], &status);
        const ssfr_report *report = ssfr_graph_report(t->graph);
        assert_true(report->n_packets_seen > 3 && report->n_packets_seen < report->n_packets);
        assert_true(test_same_bits(lean, test_twin_run(t, slots[s])));
    }
}

static void sizes_over_one_reach_into_the_view(void **state)
{
    test_twin *t = with_probe(state);
    ssfr_node_status status;
    place(t, 1, (const double[][3]){{1.4, 0, -1.5}}, 0.1); /* the image ends at x = 1 m there */
    assert_int_equal(test_count(test_twin_run_if_needed(t, "fluid_depth", &status)), 0);
    assert_int_equal(status_of(t, 1), SSFR_NEEDLESS);
    probe.sizes[0] = 6;
    test_twin_set(t, "sphere_depth.splat", "quad");
    test_twin_set(t, "sparse.point_shrink", "0.7"); /* or the node would not run again */
    const ssfr_field *lean = test_twin_run_if_needed(t, "fluid_depth", &status);
    assert_true(test_count(lean) > 50);
    assert_true(test_same_bits(lean, test_twin_run(t, "fluid_depth")));
}

static void particles_of_size_0_need_no_drawing(void **state)
{
    test_twin *t = with_probe(state);
    ssfr_node_status status;
    place_one(t, 0.2);
    probe.sizes[0] = 0;
    assert_int_equal(test_count(test_twin_run_if_needed(t, "fluid_depth", &status)), 0);
    assert_int_equal(status, SSFR_RAN);
    assert_int_equal(status_of(t, 1), SSFR_NEEDLESS);
    assert_int_equal(status_of(t, 2), SSFR_NEEDLESS);
    assert_string_equal(ssfr_graph_report(t->graph)->nodes[1].why, SSFR_SPLAT_NEEDLESS);
    assert_int_equal(test_count(test_twin_run(t, "fluid_depth")), 0);
    assert_int_equal(status_of(t, 1), SSFR_RAN);
}

/* At a pixel's very centre, where a disc without a radius would be 0 / 0. */
static void sizes_that_are_not_positive_draw_nothing(void **state)
{
    static const char *const forms[] = {"point", "quad", "exact"};
    static const float sizes[] = {0, -1, NAN};
    for (size_t k = 0; k < SSFR_COUNT(forms) * SSFR_COUNT(sizes); k++) {
        test_twin *t = test_twin_create_for(state, &sized, W + 1, H + 1); /* with a middle pixel */
        put_probe(t);
        probe.sizes[0] = sizes[k % SSFR_COUNT(sizes)];
        place(t, 1, (const double[][3]){{0, 0, -1}}, 0.05);
        test_twin_set(t, "sphere_depth.splat", "%s", forms[k / SSFR_COUNT(sizes)]);
        test_twin_set(t, "thickness.splat", "%s", forms[k / SSFR_COUNT(sizes)]);
        const ssfr_field *depth = test_twin_run(t, "fluid_depth"), *thickness = test_twin_run(t, "thickness");
        for (int i = 0; i < depth->w * depth->h; i++)
            assert_true(depth->data[i] < -SSFR_SURFACE && thickness->data[i] == 0);
    }
}

static void other_sizes_of_the_same_particles_are_drawn(void **state)
{
    test_twin *t = with_probe(state), *other = test_twin_create_for(state, &plain, W, H);
    place_one(t, 0.1);
    for (int i = 1; i <= 3; i++) {
        probe.sizes[0] = (float)i;
        test_twin_set(t, "sparse.point_shrink", "%g", 0.1 * i); /* or the node would not run again */
        place_one(other, 0.1 * i);
        assert_true(test_difference(test_twin_run(t, "fluid_depth"), test_twin_run(other, "fluid_depth")) < 1e-6);
    }
}

static void the_twins_agree_on_sizes(void **state)
{
    static const char *const forms[] = {"point", "quad", "exact"};
    char cpu[] = "cpu";
    void *on_cpu = cpu;
    for (size_t f = 0; f < SSFR_COUNT(forms); f++) {
        test_twin *a = test_twin_create_for(&on_cpu, &sized, W, H), *b = with_probe(state);
        a->graph->nodes[0].pass = b->graph->nodes[0].pass;
        place_cloud(b, 2000, -3, -0.5, 0.03);
        a->scene.particles = b->scene.particles;
        test_twin_set(a, "sphere_depth.splat", "%s", forms[f]);
        test_twin_set(b, "sphere_depth.splat", "%s", forms[f]);
        const ssfr_field *x = test_twin_run(a, "fluid_depth"), *y = test_twin_run(b, "fluid_depth");
        int outside = 0;
        for (int i = 0; i < W * H; i++) outside += !(fabs(x->data[i] - y->data[i]) <= 1e-5 + 2e-6 * fabs(x->data[i]));
        assert_true(outside <= 0.004 * W * H);
        assert_true(test_count(x) > 1000);
        a->graph->nodes[0].pass = ssfr_pass_find("sparse"); /* it has no state */
    }
}

/* ---- what runs --------------------------------------------------------------------------------------------------- */

static void a_particle_node_is_left_out_when_nobody_reads_it(void **state)
{
    test_twin *t = with_probe(state);
    place_one(t, 0.2);
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(status_of(t, 0), SSFR_RAN);
    const int n = probe.n_runs;
    test_twin_set(t, "sphere_depth.off", "1");
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(status_of(t, 0), SSFR_UNWANTED);
    assert_int_equal(ssfr_graph_want(t->graph, "spray_size"), SSFR_OK);
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(status_of(t, 0), SSFR_RAN);
    test_twin_set(t, "sparse.off", "1");
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(status_of(t, 0), SSFR_OFF);
    test_twin_set(t, "sparse.off", "0");
    t->scene.particles = NULL;
    assert_int_equal(ssfr_graph_run(t->graph, &t->scene, &(ssfr_run_options){.keep_all = true}), SSFR_OK);
    assert_int_equal(status_of(t, 0), SSFR_NEEDLESS);
    assert_int_equal(probe.n_runs, n); /* never for the same particles */
}

static void a_particle_node_that_is_off_may_give_its_input_on(void **state)
{
    test_twin *t = test_twin_create(state, "sparse", W, H);
    const float *values;
    size_t n;
    put_probe(t);
    pass.outputs[0].from = "density";
    place_one(t, 0.2);
    give_density(t, 700);
    test_twin_set(t, "off", "1");
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(ssfr_graph_read_values(t->graph, "water_size", &n, &values), SSFR_OK);
    assert_ptr_equal(values, t->scene.particles->density);
    assert_int_equal(ssfr_graph_read_values(t->graph, "spray_size", &n, &values), SSFR_OK);
    assert_true(n == 1 && *values == 0);
    assert_int_equal(probe.n_runs, 0);
}

static void reports_tell_time_and_bytes_of_a_particle_node(void **state)
{
    test_twin *t = with_probe(state);
    place_cloud(t, 1000, -3, -0.5, 0.03);
    give_density(t, 700);
    assert_int_equal(ssfr_graph_run(t->graph, &t->scene, &(ssfr_run_options){.timing = true}), SSFR_OK);
    const ssfr_node_report *report = ssfr_graph_report(t->graph)->nodes;
    assert_true(report[0].ms >= 0 && report[1].ms >= 0);
    assert_close(report[0].bytes, 4.0 * 1000 * 2, 0, 0); /* density and water_size; spray_size is all 0 */
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_true(isnan(ssfr_graph_report(t->graph)->nodes[0].ms));
}

static void a_node_does_not_run_twice_for_the_same(void **state)
{
    test_twin *t = with_probe(state);
    place_one(t, 0.2);
    for (int i = 0; i < 3; i++) assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(probe.n_runs, 1);
    test_twin_set(t, "sparse.point_shrink", "0.5"); /* which it is */
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(probe.n_runs, 1);
    test_twin_set(t, "sparse.point_shrink", "0.25");
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(probe.n_runs, 2);
    give_density(t, 700); /* of the same particles */
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(probe.n_runs, 3);
    place_one(t, 0.2);
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(probe.n_runs, 4);
    t->scene.timed = true;
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(probe.n_runs, 5);
}

/* ---- from frame to frame ----------------------------------------------------------------------------------------- */

static double dt_at(test_twin *t, double time)
{
    t->scene.timed = !isnan(time);
    t->scene.time = isnan(time) ? 0 : time;
    place_one(t, 0.2);
    assert_int_equal(run_frame(t), SSFR_OK);
    return probe.dt;
}

static void a_node_learns_the_time_since_the_last_frame(void **state)
{
    test_twin *t = with_probe(state);
    assert_true(isnan(dt_at(t, NAN)));
    assert_true(isnan(dt_at(t, NAN)));
    assert_true(isnan(dt_at(t, 1)));
    assert_close(dt_at(t, 1.25), 0.25, 0, 0);
    assert_close(dt_at(t, 1.25), 0, 0, 0); /* other particles at the same time */
    assert_true(isnan(dt_at(t, 1)));       /* back */
    assert_close(dt_at(t, 3), 2, 0, 0);
    assert_true(isnan(dt_at(t, NAN)));
    assert_true(isnan(dt_at(t, 4)));
    test_twin_set(t, "sparse.point_shrink", "0.1");
    assert_true(isnan(dt_at(t, 5)));
    t->scene.particles = NULL;
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_true(isnan(dt_at(t, 6)));
    t->scene.time = NAN;
    assert_fails(SSFR_ERR_VALUE, run_frame(t), "a frame at nan s");
    t->scene.time = INFINITY;
    assert_fails(SSFR_ERR_VALUE, run_frame(t), "a frame at inf s");
    assert_close(dt_at(t, 7), 1, 0, 0);
}

static void what_a_node_keeps_is_zeroed_kept_and_given_back(void **state)
{
    test_twin *t = with_probe(state);
    for (int i = 0; i < 3; i++) {
        dt_at(t, i);
        assert_int_equal(probe.n_seen, i + 1);
    }
    assert_int_equal(probe.n_finished, 0);
    ssfr_graph_destroy(&t->graph);
    assert_int_equal(probe.n_finished, 3);
}

static void a_node_that_fails_stops_the_frame_and_its_history(void **state)
{
    test_twin *t = with_probe(state);
    ssfr_field *field;
    dt_at(t, 1);
    place_one(t, 0.2);
    t->scene.time = 2;
    probe.result = SSFR_ERR_VALUE;
    assert_fails(SSFR_ERR_VALUE, run_frame(t), "the probe fails");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_read(t->graph, "fluid_depth", &field), "no frame has been run");
    probe.result = SSFR_OK;
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_true(isnan(probe.dt));
}

static void a_frame_is_played_without_being_drawn(void **state)
{
    test_twin *t = with_probe(state);
    const float *values;
    ssfr_field *field;
    size_t n;
    dt_at(t, 1);
    place_one(t, 0.2);
    t->scene.time = 1.5;
    assert_int_equal(ssfr_graph_advance(t->graph, &t->scene), SSFR_OK);
    assert_close(probe.dt, 0.5, 0, 0);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_read(t->graph, "fluid_depth", &field), "no frame has been run");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_read_values(t->graph, "water_size", &n, &values), "no frame has been run");
    assert_int_equal(run_frame(t), SSFR_OK); /* the very frame: it was played */
    assert_int_equal(probe.n_runs, 2);
    assert_close(dt_at(t, 1.75), 0.25, 0, 0);
    t->scene.camera.near = -1;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_advance(t->graph, &t->scene), "near -1");
}

/* ---- reading, giving, binding ------------------------------------------------------------------------------------ */

static void values_are_read_in_the_particles_order(void **state)
{
    test_twin *t = with_probe(state);
    const float *values;
    size_t n;
    place_cloud(t, MOST, -3, 1, 0.01);
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(ssfr_graph_read_values(t->graph, "water_size", &n, &values), SSFR_OK);
    assert_int_equal(n, MOST);
    for (size_t i = 0; i < n; i++) assert_true(values[i] == probe.sizes[t->scene.particles->id[i]]);
    assert_int_equal(ssfr_graph_read_values(t->graph, "density", &n, &values), SSFR_OK);
    assert_int_equal(n, 1);
    assert_true(*values == 1000);
    give_density(t, 700);
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_int_equal(ssfr_graph_read_values(t->graph, "density", &n, &values), SSFR_OK);
    assert_ptr_equal(values, t->scene.particles->density);
    assert_int_equal(n, MOST);
}

static void values_are_no_images(void **state)
{
    test_twin *t = test_twin_create_for(state, &sized, W, H), *single = test_twin_create(state, "sparse", W, H);
    ssfr_field *field = test_field(W, H, 1), *read;
    const float *values;
    size_t n;
    place_one(t, 0.2);
    assert_int_equal(run_frame(t), SSFR_OK);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_read(t->graph, "water_size", &read), "water_size: holds values");
    assert_null(read);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_import(t->graph, "density", field), "density: holds values");
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_import_texture(t->graph, "density", 1), "density: holds values");
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_export_texture(single->graph, 1), "export: water_size holds values");
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_read_values(t->graph, "thickness", &n, &values), "holds an image");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_read_values(t->graph, "sizes", &n, &values), "sizes: pipeline sized has");
    for (int i = 0; ssfr_graph_slot_at(t->graph, i); i++)
        assert_int_equal(ssfr_slots[ssfr_slot_find(ssfr_graph_slot_at(t->graph, i))].kind, SSFR_IMAGE);
}

static void ports_of_values_take_no_images(void **state)
{
    static const ssfr_pipeline image = {
        .name = "x", .source = "", .help = "", .result = SSFR_SLOT_fluid_depth,
        .nodes = {{"sphere_depth", .ports = {{"size", SSFR_SLOT_thickness}}}}};
    static const ssfr_pipeline values = {
        .name = "x", .source = "", .help = "", .result = SSFR_SLOT_fluid_depth,
        .nodes = {{"sphere_depth", .ports = {{"scene_depth", SSFR_SLOT_foam}}}}};
    ssfr_graph *graph;
    (void)state;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_create(&graph, &image, NULL),
                 "sphere_depth: port size carries values of particles, slot thickness images");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_create(&graph, &values, NULL),
                 "sphere_depth: port scene_depth carries images, slot foam values of particles");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(depth_is_that_of_spheres_of_their_own_radii),
        TEST_TWINS(a_particle_of_half_the_size_is_one_of_half_the_radius),
        TEST_TWINS(sizes_of_one_change_no_bit),
        TEST_TWINS(what_is_left_out_changes_no_bit),
        TEST_TWINS(sizes_over_one_reach_into_the_view),
        TEST_TWINS(particles_of_size_0_need_no_drawing),
        TEST_TWINS(sizes_that_are_not_positive_draw_nothing),
        TEST_TWINS(other_sizes_of_the_same_particles_are_drawn),
        TEST_GPU(the_twins_agree_on_sizes),
        TEST_TWINS(a_particle_node_is_left_out_when_nobody_reads_it),
        TEST_TWINS(a_particle_node_that_is_off_may_give_its_input_on),
        TEST_TWINS(reports_tell_time_and_bytes_of_a_particle_node),
        TEST_TWINS(a_node_does_not_run_twice_for_the_same),
        TEST_TWINS(a_node_learns_the_time_since_the_last_frame),
        TEST_TWINS(what_a_node_keeps_is_zeroed_kept_and_given_back),
        TEST_TWINS(a_node_that_fails_stops_the_frame_and_its_history),
        TEST_TWINS(a_frame_is_played_without_being_drawn),
        TEST_TWINS(values_are_read_in_the_particles_order),
        TEST_TWINS(values_are_no_images),
        cmocka_unit_test(ports_of_values_take_no_images),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

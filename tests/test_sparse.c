/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_sparse.c: sizes of particles of thin fluid against Bagar's listing A.8, worked out by hand. */
#include "tests/pass_util.h"

enum { W = 32, H = 24, MOST = 8 };

/* n particles of these densities, in this order of ids; NULL: of none that is known. */
static ssfr_particles *make(size_t n, const float *density)
{
    double positions[3 * MOST];
    uint32_t ids[MOST];
    ssfr_particles *particles;
    for (size_t i = 0; i < n; i++) {
        ids[i] = (uint32_t)i;
        for (size_t k = 0; k < 3; k++) positions[3 * i + k] = k == 2 ? -1 : 0.03 * (double)i;
    }
    const ssfr_particles given = {.radius = 0.02, .id = ids, .density = (float *)density};
    assert_int_equal(ssfr_particles_create(&particles, n, positions, &given), SSFR_OK);
    return particles;
}

static void assert_sizes(const test_twin *t, const char *slot, size_t n, const double *expected)
{
    const uint32_t *id = t->scene.particles->id;
    const float *values;
    size_t n_values;
    assert_int_equal(ssfr_graph_read_values(t->graph, slot, &n_values, &values), SSFR_OK);
    assert_int_equal(n_values, n);
    for (size_t i = 0; i < n; i++) assert_close((double)values[i], expected[n == 1 ? 0 : id[i]], 1e-7, 0);
}

static void run(test_twin *t, bool keep_all)
{
    ssfr_graph_want_all(t->graph, true);
    assert_int_equal(ssfr_graph_run(t->graph, &t->scene, &(ssfr_run_options){.keep_all = keep_all}), SSFR_OK);
}

static const float densities[] = {0, 399, 400, 500, 600, 700, 800, 1000};

static void sizes_are_those_of_the_listing(void **state)
{
    /* (density - 400) / 400 is 0, 1/4, 1/2, 3/4, 1: 3 t^2 - 2 t^3 is 0, 5/32, 1/2, 27/32, 1. */
    static const double water[] = {0, 0, 0.5, 0.5 + 5.0 / 64, 0.75, 0.5 + 27.0 / 64, 1, 1};
    static const double shrunk[] = {0, 0, 0.2, 0.2 + 0.8 * 5 / 32, 0.6, 0.2 + 0.8 * 27 / 32, 1, 1};
    static const double spray[] = {1, 1, 0, 0, 0, 0, 0, 0}, culled[] = {0, 0, 1, 1, 1, 1, 1, 1};
    test_twin *t = test_twin_create(state, "sparse", W, H);
    ssfr_particles *p = make(8, densities);
    t->scene.particles = p;
    test_twin_set(t, "density_threshold", "400");
    run(t, false);
    assert_sizes(t, "water_size", 8, water);
    assert_sizes(t, "spray_size", 8, spray);
    test_twin_set(t, "point_shrink", "0.2");
    run(t, false);
    assert_sizes(t, "water_size", 8, shrunk);
    test_twin_set(t, "point_shrink", "1");
    run(t, false);
    assert_sizes(t, "water_size", 8, culled);
    ssfr_particles_destroy(&p);
}

static void a_threshold_of_0_is_needless_and_changes_nothing(void **state)
{
    test_twin *t = test_twin_create(state, "sparse", W, H);
    ssfr_particles *p = make(8, densities);
    t->scene.particles = p;
    test_twin_set(t, "density_threshold", "0");
    for (int keep_all = 0; keep_all < 2; keep_all++) {
        run(t, keep_all);
        assert_int_equal(ssfr_graph_report(t->graph)->nodes[0].status, keep_all ? SSFR_RAN : SSFR_NEEDLESS);
        assert_sizes(t, "water_size", 1, (const double[]){1}); /* neutral */
        assert_sizes(t, "foam_size", 1, (const double[]){0});
        assert_sizes(t, "spray_size", 1, (const double[]){0});
    }
    ssfr_particles_destroy(&p);
}

static void fluid_of_unknown_density_is_at_rest(void **state)
{
    test_twin *t = test_twin_create(state, "sparse", W, H);
    ssfr_particles *p = make(3, NULL);
    static const double half[] = {0.75, 0.75, 0.75}, none[] = {0, 0, 0};
    t->scene.particles = p;
    run(t, false); /* a threshold of 0.4 of the rest density */
    assert_sizes(t, "water_size", 1, (const double[]){1});
    test_twin_set(t, "density_threshold", "%.17g", 1000 / 1.5);
    run(t, false);
    assert_sizes(t, "water_size", 3, half);
    test_twin_set(t, "density_threshold", "1001");
    run(t, false);
    assert_sizes(t, "water_size", 3, none);
    ssfr_particles_destroy(&p);
}

static void no_particles_are_no_sizes(void **state)
{
    test_twin *t = test_twin_create(state, "sparse", W, H);
    ssfr_particles *p = make(0, NULL);
    t->scene.particles = p;
    run(t, true);
    assert_sizes(t, "water_size", 1, (const double[]){1});
    ssfr_particles_destroy(&p);
}

/* Where the fluid is thin enough that nothing of it is left, the rest of the frame is left out. */
static void thin_fluid_is_not_drawn(void **state)
{
    static const ssfr_pipeline pipeline = {.name = "thin", .source = "", .help = "", .result = SSFR_SLOT_fluid_depth,
                                           .nodes = {{"sparse"}, {"sphere_depth"}}};
    static const float thin[] = {100, 200, 300}, mixed[] = {100, 900, 300};
    test_twin *t = test_twin_create_for(state, &pipeline, W, H);
    ssfr_particles *sets[] = {make(3, thin), make(3, mixed)};
    ssfr_node_status status;
    t->scene.particles = sets[0];
    assert_int_equal(test_count(test_twin_run_if_needed(t, "fluid_depth", &status)), 0);
    assert_int_equal(ssfr_graph_report(t->graph)->nodes[1].status, SSFR_NEEDLESS);
    t->scene.particles = sets[1];
    assert_true(test_count(test_twin_run_if_needed(t, "fluid_depth", &status)) > 0);
    for (size_t i = 0; i < SSFR_COUNT(sets); i++) ssfr_particles_destroy(&sets[i]);
}

static void water_shrinks_and_foam_grows_as_one_turns_to_the_other(void **state)
{
    static const ssfr_pipeline pipeline = {.name = "foamy", .source = "", .help = "", .result = SSFR_SLOT_water_size,
                                           .nodes = {{"weber_foam", .settings = {"transition=weber", "threshold=1000"}},
                                                     {"sparse", .settings = {"density_threshold=500"}}}};
    /* Weber numbers 0 to 2000, about 1000 with a band of a half: foam 0, 0, 1/2, 1 */
    static const float density[] = {1000, 500, 1000, 2000};
    static const double shrunk[] = {1, 0.5, 0.5, 0}, unshrunk[] = {1, 0.5, 1, 1};
    static const double grown[] = {0, 0, 0.5, 1}, all[] = {0, 0, 1, 1}, thick[] = {0, 0, 0, 1}, none[] = {0, 0, 0, 0};
    test_twin *t = test_twin_create_for(state, &pipeline, W, H);
    ssfr_particles *p = make(4, density);
    assert_int_equal(ssfr_alloc(&p->velocity, 3 * p->n, sizeof *p->velocity, "velocities"), SSFR_OK);
    for (size_t i = 0; i < p->n; i++) p->velocity[3 * i] = p->id[i] ? 1 : 0;
    t->scene.particles = p;
    run(t, false);
    assert_sizes(t, "water_size", 4, shrunk);
    assert_sizes(t, "foam_size", 4, grown);
    test_twin_set(t, "sparse.by_foam", "0");
    run(t, false);
    assert_sizes(t, "water_size", 4, unshrunk);
    assert_sizes(t, "foam_size", 4, all);
    test_twin_set(t, "sparse.density_threshold", "0"); /* nothing shrinks, and still there is foam */
    run(t, false);
    assert_sizes(t, "water_size", 1, (const double[]){1});
    assert_sizes(t, "foam_size", 4, all);
    test_twin_set(t, "sparse.by_foam", "1");
    test_twin_set(t, "sparse.density_threshold", "1500"); /* spray is no foam */
    run(t, false);
    assert_sizes(t, "foam_size", 4, thick);
    assert_sizes(t, "water_size", 4, none);
    test_twin_set(t, "weber_foam.off", "1");
    run(t, false);
    assert_sizes(t, "foam_size", 1, (const double[]){0});
    ssfr_particles_destroy(&p);
}

static void values_out_of_range_are_refused(void **state)
{
    const float bad[] = {1000, (float)INFINITY, NAN, NAN};
    test_twin *t = test_twin_create(state, "sparse", W, H);
    ssfr_particles *p = make(4, bad);
    char text[64];
    t->scene.particles = p;
    for (size_t i = p->n; i-- > 0;)
        if (isnan(p->density[i])) snprintf(text, sizeof text, "particle %zu (from 0): density nan kg/m^3", i);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(t->graph, &t->scene, NULL), text);
    for (size_t i = 0; i < p->n; i++)
        if (isnan(p->density[i])) p->density[i] = 0;
    run(t, false);
    assert_sizes(t, "water_size", 4, (const double[]){1, 1, 0, 0});
    ssfr_particles_destroy(&p);
    test_twin_refuses(t, "density_threshold", "-1", "density_threshold=-1: out of range [0, 1e+09] kg/m^3");
    test_twin_refuses(t, "density_threshold", "nan", "density_threshold=nan: expected a finite");
    test_twin_refuses(t, "point_shrink", "1.1", "point_shrink=1.1: out of range [0, 1]");
    test_twin_refuses(t, "by_foam", "perhaps", "by_foam=perhaps: expected on");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(sizes_are_those_of_the_listing),
        TEST_TWINS(a_threshold_of_0_is_needless_and_changes_nothing),
        TEST_TWINS(fluid_of_unknown_density_is_at_rest),
        TEST_TWINS(no_particles_are_no_sizes),
        TEST_TWINS(thin_fluid_is_not_drawn),
        TEST_TWINS(water_shrinks_and_foam_grows_as_one_turns_to_the_other),
        TEST_TWINS(values_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

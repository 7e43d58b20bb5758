/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_weber_foam.c: the pass against ssfr_weber itself over sequences, and where its history begins anew. */
#include "tests/pass_util.h"

enum { W = 32, H = 24, N = 300 };

/* The frame's particles: a tenth of the ids differs from frame to frame, and all stand in another order. */
static ssfr_particles *make(int frame, bool with_ids)
{
    static double positions[3 * N];
    static float velocity[3 * N], density[N];
    static uint32_t ids[N];
    uint64_t seed = 100 + (uint64_t)frame;
    ssfr_particles *particles;
    for (size_t i = 0; i < N; i++) {
        ids[i] = (uint32_t)(i + 30 * (size_t)frame);
        density[i] = (float)test_random(&seed, 500, 1100);
        for (size_t k = 0; k < 3; k++) {
            positions[3 * i + k] = test_random(&seed, -0.4, 0.4) - (k == 2);
            velocity[3 * i + k] = (float)test_random(&seed, -2, 2);
        }
    }
    const ssfr_particles given = {.radius = 0.02, .velocity = velocity, .density = density,
                                  .id = with_ids ? ids : NULL};
    assert_int_equal(ssfr_particles_create(&particles, N, positions, &given), SSFR_OK);
    return particles;
}

/* Runs a frame at a time (s; NaN: a lone one) and compares with what the phases of a `weber` of its own are; the number
 * of particles between water and foam. */
static size_t assert_foam(test_twin *t, ssfr_particles *p, double time, ssfr_weber *weber, double dt)
{
    static float expected[N], since[N];
    const float *foam, *lifetime;
    size_t n, n_foam = 0, n_between = 0;
    t->scene.particles = p;
    t->scene.timed = !isnan(time);
    t->scene.time = t->scene.timed ? time : 0;
    assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
    assert_int_equal(ssfr_graph_read_values(t->graph, "foam", &n, &foam), SSFR_OK);
    assert_int_equal(ssfr_graph_read_values(t->graph, "lifetime", &n, &lifetime), SSFR_OK);
    assert_int_equal(ssfr_weber_step(weber, p, dt, expected, since, NULL), SSFR_OK);
    assert_int_equal(n, N);
    assert_memory_equal(foam, expected, sizeof expected);
    assert_memory_equal(lifetime, since, sizeof since);
    for (size_t i = 0; i < n; i++) n_foam += foam[i] > 0, n_between += foam[i] > 0 && foam[i] < 1;
    assert_true(n_foam > N / 10 && n_foam < N);
    return n_between;
}

static ssfr_weber *fresh(double lifetime)
{
    ssfr_weber_params params = ssfr_weber_defaults();
    ssfr_weber *weber;
    params.lifetime = lifetime;
    assert_int_equal(ssfr_weber_create(&weber, &params), SSFR_OK);
    return weber;
}

static void foam_of_a_sequence_is_that_of_its_phases(void **state)
{
    static const double times[] = {0, 0.1, 0.15, 0.4, 2};
    test_twin *t = test_twin_create(state, "weber_foam", W, H);
    ssfr_weber *weber = fresh(1);
    size_t n_between = 0;
    for (int i = 0; i < (int)SSFR_COUNT(times); i++) {
        ssfr_particles *p = make(i, true);
        n_between += assert_foam(t, p, times[i], weber, i ? times[i] - times[i - 1] : 0);
        ssfr_particles_destroy(&p);
    }
    assert_true(n_between > N / 10);
    ssfr_weber_destroy(&weber);
}

/* A turn more would let those that have become foam begin to fade a frame early. */
static void the_same_frame_again_takes_no_turn(void **state)
{
    test_twin *t = test_twin_create(state, "weber_foam", W, H);
    ssfr_weber *weber = fresh(1);
    for (int i = 0; i < 6; i++) {
        ssfr_particles *p = make(i, true);
        assert_foam(t, p, 0.6 * i, weber, i ? 0.6 * i - 0.6 * (i - 1) : 0);
        for (int k = 0; k < 3; k++) assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
        ssfr_particles_destroy(&p);
    }
    ssfr_weber_destroy(&weber);
}

/* Each of these begins as a first frame does. */
static void history_begins_anew(void **state)
{
    test_twin *t = test_twin_create(state, "weber_foam", W, H);
    ssfr_particles *named = make(0, true), *other = make(1, true), *nameless = make(2, false);
    const struct {
        ssfr_particles *particles;
        double time;
        const char *lifetime;
    } frames[] = {
        {named, NAN, "1"}, {other, NAN, "1"},   /* lone frames */
        {named, 2, "1"},                        /* the first with a time */
        {other, 1, "1"},                        /* back */
        {named, 1.5, "2"},                      /* a parameter */
        {nameless, 2, "2"},                     /* no ids */
        {other, 3, "2"},                        /* none in the last */
    };
    for (size_t i = 0; i < SSFR_COUNT(frames); i++) {
        ssfr_weber *weber = fresh(strtod(frames[i].lifetime, NULL));
        test_twin_set(t, "lifetime", "%s", frames[i].lifetime);
        assert_foam(t, frames[i].particles, frames[i].time, weber, 0);
        ssfr_weber_destroy(&weber);
    }
    ssfr_particles_destroy(&named), ssfr_particles_destroy(&other), ssfr_particles_destroy(&nameless);
}

static void frames_that_are_played_count(void **state)
{
    test_twin *t = test_twin_create(state, "weber_foam", W, H);
    ssfr_weber *weber = fresh(1);
    static float foam[N];
    ssfr_particles *p[] = {make(0, true), make(1, true), make(2, true)};
    t->scene.timed = true;
    for (int i = 0; i < 2; i++) {
        t->scene.particles = p[i];
        t->scene.time = 0.2 * i;
        assert_int_equal(ssfr_graph_advance(t->graph, &t->scene), SSFR_OK);
        assert_int_equal(ssfr_weber_step(weber, p[i], 0.2, foam, NULL, NULL), SSFR_OK);
    }
    assert_foam(t, p[2], 0.5, weber, 0.5 - 0.2);
    for (int i = 0; i < 3; i++) ssfr_particles_destroy(&p[i]);
    ssfr_weber_destroy(&weber);
}

/* Fades of 0.5 s and of 1.5 times the lifetime of 1 s. */
static void history_is_asked_for_until_a_frame_was_seen(void **state)
{
    test_twin *t = test_twin_create(state, "weber_foam", W, H);
    ssfr_particles *p = make(0, true), *other = make(1, true);
    t->scene.particles = p;
    t->scene.time = 3;
    assert_true(ssfr_graph_history(t->graph, &t->scene) < 0); /* a lone frame has none */
    t->scene.timed = true;
    assert_close(ssfr_graph_history(t->graph, &t->scene), 2, 1e-15, 0);
    assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
    assert_true(ssfr_graph_history(t->graph, &t->scene) < 0); /* it has run for it */
    t->scene.time = 4;
    assert_close(ssfr_graph_history(t->graph, &t->scene), 2, 1e-15, 0);
    t->scene.time = 3, t->scene.particles = other;
    assert_close(ssfr_graph_history(t->graph, &t->scene), 2, 1e-15, 0);
    t->scene.particles = p;
    ssfr_graph_restart(t->graph);
    assert_close(ssfr_graph_history(t->graph, &t->scene), 2, 1e-15, 0);
    assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
    test_twin_set(t, "lifetime", "2");
    assert_close(ssfr_graph_history(t->graph, &t->scene), 3.5, 1e-15, 0);
    test_twin_set(t, "fade_in_min", "4"); /* the longest, by whatever name */
    test_twin_set(t, "lifetime_share_min", "3");
    assert_close(ssfr_graph_history(t->graph, &t->scene), 10, 1e-15, 0);
    test_twin_set(t, "off", "1");
    assert_true(ssfr_graph_history(t->graph, &t->scene) < 0);
    test_twin_set(t, "off", "0");
    assert_int_equal(ssfr_graph_want(t->graph, NULL), SSFR_OK); /* nobody reads it */
    assert_true(ssfr_graph_history(t->graph, &t->scene) < 0);
    t->scene.particles = NULL;
    assert_int_equal(ssfr_graph_want(t->graph, "foam"), SSFR_OK);
    assert_true(ssfr_graph_history(t->graph, &t->scene) < 0);
    test_twin *plain = test_twin_create(state, "sparse", W, H);
    plain->scene.particles = p, plain->scene.timed = true;
    assert_true(ssfr_graph_history(plain->graph, &plain->scene) < 0); /* it keeps nothing */
    ssfr_particles_destroy(&p), ssfr_particles_destroy(&other);
}

static void after_a_restart_a_frame_is_the_first(void **state)
{
    test_twin *t = test_twin_create(state, "weber_foam", W, H);
    ssfr_particles *p[] = {make(0, true), make(1, true)};
    for (int i = 0; i < 2; i++) {
        ssfr_weber *weber = fresh(1);
        assert_foam(t, p[i], 0.5 * i, weber, 0);
        ssfr_graph_restart(t->graph);
        ssfr_weber_destroy(&weber);
    }
    for (int i = 0; i < 2; i++) ssfr_particles_destroy(&p[i]);
}

static void a_frame_that_is_drawn_again_tells_the_time_of_its_first_run(void **state)
{
    test_twin *t = test_twin_create(state, "weber_foam", W, H);
    ssfr_particles *p = make(0, true);
    double ms = 0;
    t->scene.particles = p;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(ssfr_graph_run(t->graph, &t->scene, &(ssfr_run_options){.timing = i != 1}), SSFR_OK);
        const ssfr_node_report *node = ssfr_graph_report(t->graph)->nodes;
        assert_true(node->status == SSFR_RAN && node->kept == (i > 0));
        if (i == 0) ms = node->ms;
        if (i == 1) assert_true(isnan(node->ms));
        else assert_true(node->ms > 0 && node->ms == ms);
    }
    test_twin_set(t, "threshold", "1000");
    assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
    assert_false(ssfr_graph_report(t->graph)->nodes->kept);
    ssfr_particles_destroy(&p);
}

/* Of the phases themselves, which test_classify.c tries. */
static void lag_and_seed_are_those_of_the_phases(void **state)
{
    test_twin *t = test_twin_create(state, "weber_foam", W, H);
    ssfr_weber_params params = ssfr_weber_defaults();
    ssfr_weber *weber;
    params.lag = 0, params.seed = 5;
    test_twin_set(t, "lag", "0");
    test_twin_set(t, "seed", "5");
    assert_int_equal(ssfr_weber_create(&weber, &params), SSFR_OK);
    for (int i = 0; i < 4; i++) {
        ssfr_particles *p = make(i, true);
        assert_foam(t, p, 0.125 * i, weber, 0.125);
        ssfr_particles_destroy(&p);
    }
    ssfr_weber_destroy(&weber);
}

static void without_velocity_or_density_there_is_no_foam(void **state)
{
    test_twin *t = test_twin_create(state, "weber_foam", W, H);
    for (int missing = 0; missing < 2; missing++) {
        ssfr_particles *p = make(missing, true);
        float **array = missing ? &p->velocity : &p->density;
        free(*array);
        *array = NULL;
        t->scene.particles = p;
        for (int keep_all = 0; keep_all < 2; keep_all++) {
            const float *foam;
            size_t n;
            assert_int_equal(ssfr_graph_run(t->graph, &t->scene, &(ssfr_run_options){.keep_all = keep_all}), SSFR_OK);
            const ssfr_node_report *node = ssfr_graph_report(t->graph)->nodes;
            assert_int_equal(node->status, keep_all ? SSFR_RAN : SSFR_NEEDLESS);
            assert_string_equal(node->why, keep_all ? "" : "the particles have no velocity or no density");
            assert_int_equal(ssfr_graph_read_values(t->graph, "foam", &n, &foam), SSFR_OK);
            assert_int_equal(n, 1);
            assert_true(*foam == 0);
            assert_int_equal(ssfr_graph_read_values(t->graph, "lifetime", &n, &foam), SSFR_OK);
            assert_true(n == 1 && *foam == 0);
        }
        ssfr_particles_destroy(&p);
    }
}

static void bad_particles_and_parameters_are_refused(void **state)
{
    test_twin *t = test_twin_create(state, "weber_foam", W, H);
    ssfr_particles *p = make(0, true), *twice = make(1, true);
    t->scene.particles = p;
    p->velocity[7] = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(t->graph, &t->scene, NULL), "give no Weber number");
    twice->id[3] = twice->id[4];
    t->scene.particles = twice;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(t->graph, &t->scene, NULL), "both have the id");
    test_twin_refuses(t, "threshold", "-1", "threshold=-1");
    test_twin_refuses(t, "lag", "2", "lag=2: out of range [0, 1] frames");
    test_twin_refuses(t, "seed", "-1", "seed=-1: out of range [0, ");
    ssfr_particles_destroy(&p), ssfr_particles_destroy(&twice);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(foam_of_a_sequence_is_that_of_its_phases),
        TEST_TWINS(the_same_frame_again_takes_no_turn),
        TEST_TWINS(history_begins_anew),
        TEST_TWINS(frames_that_are_played_count),
        TEST_TWINS(history_is_asked_for_until_a_frame_was_seen),
        TEST_TWINS(after_a_restart_a_frame_is_the_first),
        TEST_TWINS(a_frame_that_is_drawn_again_tells_the_time_of_its_first_run),
        TEST_TWINS(lag_and_seed_are_those_of_the_phases),
        TEST_TWINS(without_velocity_or_density_there_is_no_foam),
        TEST_TWINS(bad_particles_and_parameters_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

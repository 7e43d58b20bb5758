/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_two_integrators.c: truth by independent integrators agrees within the sum of their errors, on every pixel. */
#include "tests/truths.h"

static const char *const rules[] = {"chords", "qagp", "cquad", "gauss"};

typedef struct truths {
    ssfr_stage *stage;
    ssfr_truth *by[SSFR_COUNT(rules)];
} truths;

static void cast_all(truths *t, const char *parts)
{
    for (size_t i = 0; i < SSFR_COUNT(rules); i++) {
        const char *const settings[] = {"truth.parts", parts, "truth.integrator", rules[i], "truth.judged", "0", NULL};
        const ssfr_truth_params params = test_truth_params(settings);
        t->by[i] = test_truth_cast(t->stage, &params);
        test_truth_check_finite(t->by[i]);
    }
}

static void finish(truths *t)
{
    for (size_t i = 0; i < SSFR_COUNT(rules); i++) ssfr_truth_destroy(&t->by[i]);
    ssfr_stage_destroy(&t->stage);
}

/* Every pair of rules, every pixel. Returns the pixels where there was something to integrate. */
static int assert_agreement(const truths *t, ssfr_truth_channel channel, ssfr_truth_channel err)
{
    const ssfr_truth *first = t->by[0];
    int n_seen = 0;
    for (int y = 0; y < first->h; y++)
        for (int x = 0; x < first->w; x++) {
            for (size_t i = 0; i < SSFR_COUNT(rules); i++)
                for (size_t j = 0; j < i; j++)
                    for (int k = 0; k < ssfr_truth_channels[channel].n; k++) {
                        const double *a = test_truth_at(t->by[i], channel, x, y);
                        const double *b = test_truth_at(t->by[j], channel, x, y);
                        const double err_a = *test_truth_at(t->by[i], err, x, y);
                        const double err_b = *test_truth_at(t->by[j], err, x, y);
                        assert_close(a[k], b[k], err_a + err_b, 0);
                    }
            n_seen += *test_truth_at(first, channel, x, y) != 0;
        }
    return n_seen;
}

/* The largest error that a rule says it has. */
static double largest(const ssfr_truth *truth, ssfr_truth_channel err)
{
    double most = 0;
    for (int y = 0; y < truth->h; y++)
        for (int x = 0; x < truth->w; x++) most = fmax(most, *test_truth_at(truth, err, x, y));
    return most;
}

/* Estimates that hold because they are large would prove little. Content in m, foam between 0 and 1. */
static void assert_sharp(const truths *t, ssfr_truth_channel err)
{
    for (size_t i = 0; i + 1 < SSFR_COUNT(rules); i++) assert_true(largest(t->by[i], err) < 1e-8);
}

static void thickness_of(const char *scene, int w, int h)
{
    truths t = {.stage = test_truth_scene(scene, w, h)};
    cast_all(&t, "thickness");
    assert_true(assert_agreement(&t, SSFR_TRUTH_content, SSFR_TRUTH_content_err) > w * h / 10);
    assert_sharp(&t, SSFR_TRUTH_content_err);
    finish(&t);
}

static void the_thickness_of_a_splash_agrees(void **state)
{
    (void)state;
    thickness_of("splash", 64, 36);
}

static void the_thickness_of_a_block_agrees(void **state)
{
    (void)state;
    thickness_of("block", 24, 16);
}

/* Spray, foam and bubbles of all kinds around the fluid, denser towards its floor. */
static ssfr_particles *scatter_foam(const ssfr_stage *stage)
{
    enum { N = 6000 };
    static double at[3 * N];
    static uint32_t kind[N];
    uint64_t seed = 2385;
    double lo[3], hi[3];
    ssfr_stage_bounds(stage, lo, hi);
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < 3; k++) at[3 * i + k] = test_random(&seed, lo[k], hi[k]);
        at[3 * i + 1] = lo[1] + ssfr_square(at[3 * i + 1] - lo[1]) / (hi[1] - lo[1]);
        kind[i] = (uint32_t)test_random(&seed, 0, 3);
    }
    const ssfr_particles given = {.kind = kind};
    ssfr_particles *foam = NULL;
    assert_int_equal(ssfr_particles_create(&foam, N, at, &given), SSFR_OK);
    return foam;
}

static void foam_of(const char *scene, int w, int h)
{
    truths t = {.stage = test_truth_scene(scene, w, h)};
    assert_null(t.stage->foam);
    t.stage->foam = scatter_foam(t.stage);
    cast_all(&t, "foam");
    assert_true(assert_agreement(&t, SSFR_TRUTH_foam, SSFR_TRUTH_foam_err) > w * h / 10);
    assert_sharp(&t, SSFR_TRUTH_foam_err);
    finish(&t);
}

static void the_foam_around_a_splash_agrees(void **state)
{
    (void)state;
    foam_of("splash", 64, 36);
}

static void the_foam_around_a_block_agrees(void **state)
{
    (void)state;
    foam_of("block", 24, 16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_thickness_of_a_splash_agrees),
        cmocka_unit_test(the_thickness_of_a_block_agrees),
        cmocka_unit_test(the_foam_around_a_splash_agrees),
        cmocka_unit_test(the_foam_around_a_block_agrees),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_bench_truth.c: the water that ground truth is timed on, and what rays through it come upon. The command itself
 * is in test_bench_truth.sh. */
#include "experiments/bench_truth.h"
#include "experiments/interrupt.h"
#include "tests/util.h"

#include "base/param.h"

#include <omp.h>
#include <signal.h>

static ssfr_water water_of(ssfr_waters kind, size_t n)
{
    ssfr_water water;
    assert_int_equal(ssfr_water_create(&water, kind, n), SSFR_OK);
    return water;
}

static ssfr_continuum fluid_of(const ssfr_water *water, ssfr_continuum_kind kind)
{
    ssfr_continuum_params params;
    ssfr_continuum fluid;
    ssfr_params_default(ssfr_continuum_rows, &params);
    params.kind = (int)kind;
    assert_int_equal(ssfr_continuum_init(&fluid, water->particles, &params, NULL), SSFR_OK);
    return fluid;
}

static ssfr_rays_tally cast(const ssfr_water *water, const ssfr_continuum *fluid, int every, uint64_t seed)
{
    ssfr_rays_tally tally;
    assert_int_equal(ssfr_rays_cast(fluid, &water->camera, every, seed, NULL, NULL, &tally), SSFR_OK);
    return tally;
}

static void water_is_about_as_many_particles_as_asked_for(void **state)
{
    (void)state;
    static const size_t counts[] = {1000, 4096, 30000};
    for (int kind = 0; kind < SSFR_N_WATERS; kind++)
        for (size_t i = 0; i < SSFR_COUNT(counts); i++) {
            ssfr_water water = water_of((ssfr_waters)kind, counts[i]);
            assert_close((double)water.particles->n, (double)counts[i], 0, 0.2);
            ssfr_water_finish(&water);
            assert_null(water.particles);
        }
    assert_non_null(ssfr_water_names[SSFR_N_WATERS - 1]);
    assert_null(ssfr_water_names[SSFR_N_WATERS]);
}

/* Particles of rest spacing: half of them at least are amid others. */
static void water_is_at_rest(void **state)
{
    (void)state;
    for (int kind = 0; kind < SSFR_N_WATERS; kind++) {
        ssfr_water water = water_of((ssfr_waters)kind, 20000);
        const ssfr_particles *p = water.particles;
        double lo[3], hi[3], sum = 0;
        size_t n = 0;
        assert_int_equal(ssfr_particles_complete(water.particles, NULL), SSFR_OK);
        for (size_t i = 0; i < p->n; i++)
            if (p->density[i] > 950) sum += (double)p->density[i], n++;
        assert_true(2 * n > p->n);
        assert_close(sum / (double)n, 1000, 0, 0.02);
        ssfr_particles_bounds(p, lo, hi);
        assert_true(lo[1] > 0 && hi[1] > 0.4 && hi[1] < 0.46); /* m */
        ssfr_water_finish(&water);
    }
}

static void water_is_the_same_each_time(void **state)
{
    (void)state;
    ssfr_water one = water_of(SSFR_WATER_FINER, 4096), two = water_of(SSFR_WATER_FINER, 4096);
    assert_int_equal(one.particles->n, two.particles->n);
    assert_memory_equal(one.particles->position, two.particles->position, 3 * one.particles->n * sizeof(float));
    ssfr_water_finish(&one), ssfr_water_finish(&two);
}

/* Eight times as many particles: twice the kernels a ray where they are finer, as many where there is more water. */
static void rays_meet_more_kernels_where_particles_are_finer(void **state)
{
    (void)state;
    for (int kind = 0; kind < SSFR_N_WATERS; kind++) {
        double kernels[2];
        for (int i = 0; i < 2; i++) {
            ssfr_water water = water_of((ssfr_waters)kind, i ? 32768 : 4096);
            ssfr_continuum fluid = fluid_of(&water, SSFR_CONTINUUM_DENSITY);
            const ssfr_rays_tally t = cast(&water, &fluid, 64, 1);
            assert_int_equal(t.rays, 20 * 12); /* squares of 64 px, those at the lower edge cut */
            assert_true(t.covered > t.rays / 2);
            assert_true(t.crossings >= 2 * t.covered); /* in, and out again */
            assert_true(t.evaluations > t.crossings);
            assert_true(t.touches < t.rays / 100);
            kernels[i] = (double)t.kernels / (double)t.covered;
            ssfr_continuum_finish(&fluid);
            ssfr_water_finish(&water);
        }
        assert_close(kernels[1] / kernels[0], kind == SSFR_WATER_FINER ? 2 : 1, 0.2, 0);
    }
}

static void threads_change_no_count(void **state)
{
    (void)state;
    const int threads = omp_get_max_threads();
    ssfr_water water = water_of(SSFR_WATER_FINER, 4096);
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        ssfr_continuum fluid = fluid_of(&water, (ssfr_continuum_kind)kind);
        omp_set_num_threads(1);
        ssfr_rays_tally one = cast(&water, &fluid, 64, 2385);
        omp_set_num_threads(3);
        ssfr_rays_tally three = cast(&water, &fluid, 64, 2385);
        omp_set_num_threads(threads);
        for (int i = 0; i < 3; i++) {
            assert_true(one.seconds[i] > 0 && three.seconds[i] > 0);
            one.seconds[i] = three.seconds[i] = 0;
        }
        assert_true(one.covered > 0);
        assert_memory_equal(&one, &three, sizeof one);
        ssfr_continuum_finish(&fluid);
    }
    ssfr_water_finish(&water);
}

/* Other pixels of the same squares, and shares that say how far it is. */
static void note(void *user, double share)
{
    double *most = user;
    assert_true(share >= 0 && share <= 1);
    *most = fmax(*most, share);
}

static void the_seed_chooses_the_pixels(void **state)
{
    (void)state;
    ssfr_water water = water_of(SSFR_WATER_FINER, 4096);
    ssfr_continuum fluid = fluid_of(&water, SSFR_CONTINUUM_DENSITY);
    ssfr_rays_tally other;
    double most = 0;
    const ssfr_rays_tally one = cast(&water, &fluid, 64, 1);
    assert_int_equal(ssfr_rays_cast(&fluid, &water.camera, 64, 2, note, &most, &other), SSFR_OK);
    assert_int_equal(one.rays, other.rays);
    assert_true(one.kernels != other.kernels);
    assert_true(most > 0.9);
    ssfr_continuum_finish(&fluid);
    ssfr_water_finish(&water);
}

static void casting_stops_when_it_is_asked_to(void **state)
{
    (void)state;
    ssfr_water water = water_of(SSFR_WATER_FINER, 4096);
    ssfr_continuum fluid = fluid_of(&water, SSFR_CONTINUUM_DENSITY);
    ssfr_rays_tally tally;
    ssfr_interrupt_begin();
    raise(SIGTERM);
    assert_fails(SSFR_ERR_IO, ssfr_rays_cast(&fluid, &water.camera, 1, 1, NULL, NULL, &tally), "interrupted");
    ssfr_interrupt_end();
    ssfr_continuum_finish(&fluid);
    ssfr_water_finish(&water);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(water_is_about_as_many_particles_as_asked_for),
        cmocka_unit_test(water_is_at_rest),
        cmocka_unit_test(water_is_the_same_each_time),
        cmocka_unit_test(rays_meet_more_kernels_where_particles_are_finer),
        cmocka_unit_test(threads_change_no_count),
        cmocka_unit_test(the_seed_chooses_the_pixels),
        cmocka_unit_test(casting_stops_when_it_is_asked_to),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

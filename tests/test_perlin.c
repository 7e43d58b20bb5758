/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_perlin.c: gradient noise: its range, mean, continuity and period, and the texture of it. */
#include "passes/perlin.h"
#include "tests/util.h"

enum { N = 20000 };

static void random_place(uint64_t *random, double place[3])
{
    for (int k = 0; k < 3; k++) place[k] = test_random(random, 0, 1);
}

/* ---- three dimensions -------------------------------------------------------------------------------------------- */

/* Each corner's gradient at its best: the sum of the two longer ways from it. */
static double best(const double f[3])
{
    double sum = 0;
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1, ways = 0, shortest = 1;
        for (int k = 0; k < 3; k++) {
            const int side = corner >> k & 1;
            const double t = f[k], fade = t * t * t * (t * (6 * t - 15) + 10);
            weight *= side ? fade : 1 - fade;
            ways += fabs(t - side);
            shortest = fmin(shortest, fabs(t - side));
        }
        sum += weight * (ways - shortest);
    }
    return sum;
}

static void the_largest_sum_of_gradients_is_the_one_that_maps_to_1(void **state)
{
    (void)state;
    enum { STEPS = 60 };
    double largest = 0;
    for (int i = 0; i <= STEPS; i++)
        for (int j = 0; j <= STEPS; j++)
            for (int k = 0; k <= STEPS; k++)
                largest = fmax(largest, best((const double[3]){(double)i / STEPS, (double)j / STEPS,
                                                               (double)k / STEPS}));
    assert_true(largest <= SSFR_PERLIN_LARGEST && largest > SSFR_PERLIN_LARGEST - 1e-3);
    assert_close(best((const double[3]){0.481492209, 0.5, 0.644743304}), SSFR_PERLIN_LARGEST, 1e-10, 0);
}

static void foam_noise_is_in_0_to_1_with_mean_one_half(void **state)
{
    (void)state;
    uint64_t random = 1;
    double sum = 0, squares = 0, lo = 1, hi = 0;
    for (int i = 0; i < N; i++) {
        double place[3];
        random_place(&random, place);
        const double v = ssfr_foam_noise(place, 0);
        sum += v, squares += (v - 0.5) * (v - 0.5), lo = fmin(lo, v), hi = fmax(hi, v);
    }
    assert_true(lo >= 0 && hi <= 1 && lo < 0.2 && hi > 0.8);
    assert_close(sum / N, 0.5, 5 * 0.133 / sqrt(N), 0); /* its standard deviation is 0.133 */
    assert_close(sqrt(squares / N), 0.133, 0.004, 0);
}

/* Each gradient leans as far up on one side of its point as down on the other. */
static void the_mean_over_the_period_is_one_half(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 4; seed++) {
        enum { STEPS = 40 };
        double sum = 0;
        for (int i = 0; i < STEPS * STEPS * STEPS; i++)
            sum += ssfr_foam_noise((const double[3]){(i % STEPS + 0.5) / STEPS, (i / STEPS % STEPS + 0.5) / STEPS,
                                                     (i / (STEPS * STEPS) + 0.5) / STEPS}, seed);
        assert_close(sum / (STEPS * STEPS * STEPS), 0.5, 1e-12, 0);
    }
}

static void foam_noise_is_one_half_at_lattice_points(void **state)
{
    (void)state;
    for (int i = 0; i < 512; i++) {
        const double place[3] = {i % 8 / 8.0, i / 8 % 8 / 8.0, i / 64 / 8.0};
        assert_true(ssfr_foam_noise(place, 2) == 0.5);
    }
}

/* Of period 1, with a tangent that goes on across cells and periods. */
static void foam_noise_is_periodic_and_smooth(void **state)
{
    (void)state;
    const double h = 1e-5;
    uint64_t random = 7;
    for (int i = 0; i < N; i++) {
        double place[3], moved[3];
        random_place(&random, place);
        for (int k = 0; k < 3; k++) moved[k] = place[k] + (int)test_random(&random, -9, 9);
        assert_close(ssfr_foam_noise(moved, 0), ssfr_foam_noise(place, 0), 1e-12, 0);
        const int axis = i % 3;
        if (i % 2) place[axis] = (int)test_random(&random, 0, 9) / 8.0; /* a cell's side, the period's too */
        memcpy(moved, place, sizeof moved);
        moved[axis] += h;
        const double after = ssfr_foam_noise(moved, 0);
        moved[axis] -= 2 * h;
        const double here = ssfr_foam_noise(place, 0), before = ssfr_foam_noise(moved, 0);
        assert_true(fabs(after - here) < h * 64 * SSFR_FOAM_STEP * 1.2);
        assert_close(after - here, here - before, 4e-7, 0); /* h^2 times a second derivative of up to 60 a cell^2 */
    }
}

static void seeds_and_places_have_patterns_of_their_own(void **state)
{
    (void)state;
    double products[3] = {0};
    uint64_t random = 11;
    for (int i = 0; i < N; i++) {
        double place[3];
        random_place(&random, place);
        const double v = ssfr_foam_noise(place, 0) - 0.5;
        products[0] += v * v;
        products[1] += v * (ssfr_foam_noise(place, 1) - 0.5);
        place[2] += 0.5;
        products[2] += v * (ssfr_foam_noise(place, 0) - 0.5);
    }
    assert_true(fabs(products[1]) < 0.1 * products[0] && fabs(products[2]) < 0.1 * products[0]);
}

static void shares_of_seeds_fill_0_to_1(void **state)
{
    (void)state;
    int counts[16] = {0};
    for (uint32_t seed = 0; seed < 16000; seed++) {
        const double share = ssfr_lattice_share(seed);
        assert_true(share >= 0 && share < 1 && share == (double)(float)share);
        counts[(int)(16 * share)]++;
    }
    for (int i = 0; i < 16; i++) assert_close(counts[i], 1000, 150, 0);
}

/* ---- two dimensions ---------------------------------------------------------------------------------------------- */

static void noise_of_two_dimensions_has_mean_0_and_is_0_at_lattice_points(void **state)
{
    (void)state;
    uint64_t random = 5;
    double sum = 0, largest = 0;
    for (int i = 0; i < N; i++) {
        const double v = ssfr_perlin_2d(test_random(&random, -50, 50), test_random(&random, -50, 50), 3);
        sum += v, largest = fmax(largest, fabs(v));
        assert_true(ssfr_perlin_2d(i % 100 - 50, i / 100 - 50, (uint32_t)i) == 0);
    }
    assert_close(sum / N, 0, 0.01, 0);
    assert_true(largest <= sqrt(0.5) && largest > 0.5);
}

/* ---- the texture ------------------------------------------------------------------------------------------------- */

static void the_texture_holds_the_noise_in_8_bits(void **state)
{
    (void)state;
    ssfr_texels t;
    double step = 0, sum = 0;
    assert_int_equal(ssfr_texels_init(&t, &ssfr_foam_perlin), SSFR_OK);
    assert_int_equal(ssfr_lookup_bytes(&ssfr_foam_perlin), 64 * 64 * 64 * 3);
    for (int i = 0; i < 64 * 64 * 64; i++) {
        const int x = i % 64, y = i / 64 % 64, z = i / 4096;
        const double place[3] = {(x + 0.5) / 64, (y + 0.5) / 64, (z + 0.5) / 64}, v = ssfr_texel_at(&t, x, y, z, 0);
        if (i % 61 == 0)
            for (uint32_t c = 0; c < 3; c++)
                assert_close(ssfr_texel_at(&t, x, y, z, (int)c), ssfr_foam_noise(place, c), 0.5 / 255 + 1e-12, 0);
        step = fmax(step, fabs(ssfr_texel_at(&t, (x + 1) % 64, y, z, 0) - v));
        step = fmax(step, fabs(ssfr_texel_at(&t, x, (y + 1) % 64, z, 0) - v));
        step = fmax(step, fabs(ssfr_texel_at(&t, x, y, (z + 1) % 64, 0) - v));
        sum += v;
    }
    assert_true(step < SSFR_FOAM_STEP && step > 0.1);
    assert_close(sum / (64 * 64 * 64), 0.5, 1e-4, 0);
    ssfr_texels_finish(&t);
}

/* 8 bits are off by 0.5/255 at most; linear interpolation by an eighth of the squared texel's bend. */
static void the_texture_is_near_the_noise_between_its_texels_too(void **state)
{
    (void)state;
    ssfr_texels t;
    uint64_t random = 2;
    double largest = 0, squares = 0;
    assert_int_equal(ssfr_texels_init(&t, &ssfr_foam_perlin), SSFR_OK);
    for (int i = 0; i < N; i++) {
        double place[3];
        random_place(&random, place);
        const double e = ssfr_texels_between(&t, place, 0) - ssfr_foam_noise(place, 0);
        largest = fmax(largest, fabs(e)), squares += e * e;
    }
    assert_true(largest < 0.02 && largest > 0.5 / 255);
    assert_close(sqrt(squares / N), 0.0044, 0.0005, 0);
    ssfr_texels_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_largest_sum_of_gradients_is_the_one_that_maps_to_1),
        cmocka_unit_test(foam_noise_is_in_0_to_1_with_mean_one_half),
        cmocka_unit_test(the_mean_over_the_period_is_one_half),
        cmocka_unit_test(foam_noise_is_one_half_at_lattice_points),
        cmocka_unit_test(foam_noise_is_periodic_and_smooth),
        cmocka_unit_test(seeds_and_places_have_patterns_of_their_own),
        cmocka_unit_test(shares_of_seeds_fill_0_to_1),
        cmocka_unit_test(noise_of_two_dimensions_has_mean_0_and_is_0_at_lattice_points),
        cmocka_unit_test(the_texture_holds_the_noise_in_8_bits),
        cmocka_unit_test(the_texture_is_near_the_noise_between_its_texels_too),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_neighbours.c: packed particles' neighbours against all pairs, near the origin, far from it, and with strays. */
#include "scene/neighbours.h"
#include "tests/util.h"

enum { N = 900 };

static const double reach = 0.0954; /* m */

/* A cloud of about 40 neighbours each, around a middle. */
static void make_cloud(double positions[3 * N], const double middle[3])
{
    uint64_t seed = 2385;
    for (size_t i = 0; i < 3 * N; i++) positions[i] = middle[i % 3] + test_random(&seed, -0.2, 0.2);
}

static double square(const double a[3], const double b[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += ssfr_square(a[k] - b[k]);
    return sum;
}

/* Every pair within reach is found, each once, with its difference to within `digits` metres. */
static void check(size_t n, const double *positions, double digits, size_t least_pairs)
{
    ssfr_particles *p = NULL;
    ssfr_neighbours set;
    size_t n_pairs = 0, n_found = 0;
    double (*at)[3] = calloc(n, sizeof *at);
    assert_non_null(at);
    assert_int_equal(ssfr_particles_create(&p, n, positions, NULL), SSFR_OK);
    assert_int_equal(ssfr_neighbours_init(&set, p, reach), SSFR_OK);
    assert_int_equal(set.n, n);
    for (size_t k = 0; k < n; k++) ssfr_particles_position(p, set.order[k], at[k]);
    for (size_t k = 0; k < n; k++) {
        ssfr_grid_range ranges[SSFR_GRID_ROWS];
        const int n_ranges = ssfr_neighbours_near(&set, k, ranges);
        for (size_t j = 0; j < n; j++) n_pairs += square(set.place[k], set.place[j]) < reach * reach;
        for (int r = 0; r < n_ranges; r++)
            for (size_t j = ranges[r].begin; j < ranges[r].end; j++) {
                double d[3];
                n_found += ssfr_neighbours_between(&set, k, j, d) < reach * reach;
                for (int c = 0; c < 3; c++) assert_close(d[c], at[j][c] - at[k][c], digits, 0);
            }
    }
    assert_int_equal(n_found, n_pairs);
    assert_true(n_pairs >= least_pairs);
    ssfr_neighbours_finish(&set);
    assert_null(set.place);
    free(at);
    ssfr_particles_destroy(&p);
}

static void all_pairs_within_reach_are_found(void **state)
{
    (void)state;
    double positions[3 * N];
    make_cloud(positions, (double[3]){0.3, -0.2, 2.385});
    check(N, positions, 1e-15, 20 * N);
}

static void nothing_is_lost_far_from_the_origin(void **state)
{
    (void)state;
    double positions[3 * N];
    make_cloud(positions, (double[3]){1e6, -2e6, 2.385e5});
    check(N, positions, 1e-9, 20 * N); /* what world coordinates hold there */
}

/* The middle of the bounds is then far away as well, and the grid's floats are coarse. */
static void a_stray_far_away_hides_nobody(void **state)
{
    (void)state;
    double positions[3 * N];
    make_cloud(positions, (double[3]){0.3, -0.2, 2.385});
    for (int k = 0; k < 3; k++) positions[3 * N - 3 + k] = k == 1 ? -9e4 : 9e4;
    check(N, positions, 1e-10, 20 * N);
}

/* In a row along an axis, each just nearer to the next than the reach: rounded to floats many are farther. */
static void rounding_hides_nobody(void **state)
{
    (void)state;
    for (size_t axis = 0; axis < 3; axis++) {
        double positions[3 * N];
        for (size_t i = 0; i < 3 * N; i++) positions[i] = i % 3 == axis ? 0.995 * reach * (double)(i / 3) : 0.02385;
        positions[3 * N - 3] = positions[3 * N - 2] = positions[3 * N - 1] = -9e4;
        check(N, positions, 1e-10, 5 * N / 2); /* itself and one on each side, save in the packet of the stray */
    }
}

static void nobody_has_neighbours_among_none(void **state)
{
    (void)state;
    ssfr_particles *p = NULL;
    ssfr_neighbours set;
    assert_int_equal(ssfr_particles_create(&p, 0, NULL, NULL), SSFR_OK);
    assert_int_equal(ssfr_neighbours_init(&set, p, reach), SSFR_OK);
    assert_int_equal(set.n, 0);
    ssfr_neighbours_finish(&set);
    ssfr_particles_destroy(&p);
}

static void particles_too_far_apart_are_refused(void **state)
{
    (void)state;
    ssfr_particles *p = NULL;
    ssfr_neighbours set;
    assert_int_equal(ssfr_particles_create(&p, 2, (double[6]){0, 0, 0, 6e5, 0, 0}, NULL), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_neighbours_init(&set, p, reach), "2^20 cells");
    assert_true(!set.grid && !set.place && set.n == 0);
    ssfr_particles_destroy(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_pairs_within_reach_are_found),
        cmocka_unit_test(nothing_is_lost_far_from_the_origin),
        cmocka_unit_test(a_stray_far_away_hides_nobody),
        cmocka_unit_test(rounding_hides_nobody),
        cmocka_unit_test(nobody_has_neighbours_among_none),
        cmocka_unit_test(particles_too_far_apart_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

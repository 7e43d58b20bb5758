/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_grid.c: the neighbour grid against brute force, at its extremes, and for any number of threads. */
#include "scene/grid.h"
#include "tests/util.h"

#include <omp.h>

enum { N_MAX = 40000 };

static float points[3 * N_MAX];

static void random_points(size_t n, double lo, double hi, uint64_t seed)
{
    for (size_t i = 0; i < 3 * n; i++) points[i] = (float)test_random(&seed, lo, hi);
}

static ssfr_grid *build(size_t n, double cell)
{
    ssfr_grid *grid = NULL;
    assert_int_equal(ssfr_grid_create(&grid), SSFR_OK);
    assert_int_equal(ssfr_grid_build(grid, n, points, cell), SSFR_OK);
    assert_true(ssfr_grid_cell(grid) == cell);
    return grid;
}

static double distance(const float *a, const float *b)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += ssfr_square((double)a[k] - (double)b[k]);
    return sqrt(sum);
}

/* Marks the points in reach of `at` with the number of times that they are listed; returns how many are listed. */
static size_t list(const ssfr_grid *grid, const float at[3], unsigned char *listed, size_t n)
{
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    const int n_ranges = ssfr_grid_near(grid, at, ranges);
    size_t total = 0;
    memset(listed, 0, n);
    assert_in_range(n_ranges, 0, SSFR_GRID_ROWS);
    for (int r = 0; r < n_ranges; r++) {
        assert_true(ranges[r].begin < ranges[r].end && ranges[r].end <= n);
        for (uint32_t i = ranges[r].begin; i < ranges[r].end; i++, total++) listed[ssfr_grid_order(grid)[i]]++;
    }
    return total;
}

/* Every point in reach is listed, none twice, and none that is further than two cells along an axis. */
static void check_near(const ssfr_grid *grid, size_t n, const float at[3])
{
    static unsigned char listed[N_MAX];
    const double cell = ssfr_grid_cell(grid);
    list(grid, at, listed, n);
    for (size_t i = 0; i < n; i++) {
        if (distance(points + 3 * i, at) <= cell) assert_int_equal(listed[i], 1);
        assert_true(listed[i] <= 1);
        for (size_t k = 0; k < 3 && listed[i]; k++)
            assert_true(fabs((double)points[3 * i + k] - (double)at[k]) <= 2.000001 * cell);
    }
}

/* The order is a permutation; cells follow each other without a gap; a cell's points keep their order. */
static void check_cells(const ssfr_grid *grid, size_t n)
{
    static unsigned char seen[N_MAX];
    const uint32_t *order = ssfr_grid_order(grid);
    uint32_t at = 0;
    memset(seen, 0, sizeof seen);
    for (size_t c = 0; c < ssfr_grid_n_cells(grid); c++) {
        const ssfr_grid_range range = ssfr_grid_cell_at(grid, c);
        assert_true(range.begin == at && range.end > at);
        for (; at < range.end; at++) {
            assert_true(order[at] < n && !seen[order[at]]++);
            if (at > range.begin) assert_true(order[at] > order[at - 1]);
        }
    }
    assert_int_equal(at, n);
}

static void check_all(size_t n, double cell, size_t stride)
{
    ssfr_grid *grid = build(n, cell);
    check_cells(grid, n);
    for (size_t i = 0; i < n; i += stride) check_near(grid, n, points + 3 * i);
    ssfr_grid_destroy(&grid);
    assert_null(grid);
}

static void every_point_in_reach_is_listed_once_among_random_points(void **state)
{
    (void)state;
    random_points(2000, -2.385, 1.117, 1);
    check_all(2000, 0.3, 1);
    check_all(2000, 0.02, 7);
    check_all(2000, 23.85, 100); /* all points in a few cells, of negative coordinates too */
}

static void every_point_in_reach_is_listed_once_in_clusters_far_apart(void **state)
{
    (void)state;
    random_points(3000, -0.5, 0.5, 2);
    uint64_t seed = 3;
    float centre[3] = {0};
    for (size_t i = 0; i < 3000; i++) {
        if (i % 100 == 0)
            for (size_t k = 0; k < 3; k++) centre[k] = (float)test_random(&seed, -1e5, 1e5);
        for (size_t k = 0; k < 3; k++) points[3 * i + k] += centre[k];
    }
    check_all(3000, 0.3, 3);
}

static void points_on_the_borders_of_cells_are_listed(void **state)
{
    (void)state;
    const double cell = 0.1; /* not a float: borders fall to either side */
    size_t n = 0;
    for (int z = -4; z <= 4; z++)
        for (int y = -4; y <= 4; y++)
            for (int x = -4; x <= 4; x++, n++) {
                points[3 * n] = (float)(x * cell);
                points[3 * n + 1] = (float)(y * cell);
                points[3 * n + 2] = (float)(z * cell);
            }
    check_all(n, cell, 1);
    check_all(n, (double)0.1f, 1);
}

static void points_a_cell_apart_are_listed_far_from_the_origin(void **state)
{
    (void)state;
    /* Halves and quarters of a cell are whole floats here: distances of exactly one cell occur. */
    for (int i = 0; i < 200; i++)
        for (int k = 0; k < 3; k++) points[3 * i + k] = (k ? -1.0f : 1.0f) * (1048570.0f + 0.25f * (float)(i % 20));
    check_all(200, 1, 1);
}

static void coincident_points_are_all_listed_in_their_order(void **state)
{
    (void)state;
    for (size_t i = 0; i < 900; i++) points[i] = i % 3 == 0 ? 2.385f : -1.117f;
    ssfr_grid *grid = build(300, 0.08);
    assert_int_equal(ssfr_grid_n_cells(grid), 1);
    for (uint32_t i = 0; i < 300; i++) assert_int_equal(ssfr_grid_order(grid)[i], i);
    check_near(grid, 300, points);
    ssfr_grid_destroy(&grid);
}

static void a_single_point_is_found_from_a_cell_away_and_not_from_further(void **state)
{
    (void)state;
    unsigned char listed;
    memcpy(points, (float[3]){2.385f, -1.117f, 0.25f}, 3 * sizeof *points);
    ssfr_grid *grid = build(1, 0.5);
    assert_int_equal(list(grid, points, &listed, 1), 1);
    assert_int_equal(list(grid, (float[3]){2.885f, -1.117f, 0.25f}, &listed, 1), 1);
    assert_int_equal(list(grid, (float[3]){1.885f, -1.617f, 0.75f}, &listed, 1), 1);
    assert_int_equal(list(grid, (float[3]){3.6f, -1.117f, 0.25f}, &listed, 1), 0);
    assert_int_equal(list(grid, (float[3]){NAN, -1.117f, 0.25f}, &listed, 1), 0);
    assert_int_equal(list(grid, (float[3]){1e30f, -1.117f, 0.25f}, &listed, 1), 0);
    ssfr_grid_destroy(&grid);
    points[0] = 1048575.5f; /* in the last cell that there is */
    grid = build(1, 1);
    assert_int_equal(list(grid, (float[3]){1048576.25f, -1.117f, 0.25f}, &listed, 1), 1);
    ssfr_grid_destroy(&grid);
}

static void an_empty_grid_lists_nothing(void **state)
{
    (void)state;
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    ssfr_grid *grid = NULL;
    assert_int_equal(ssfr_grid_create(&grid), SSFR_OK);
    assert_int_equal(ssfr_grid_near(grid, (float[3]){0, 0, 0}, ranges), 0);
    assert_int_equal(ssfr_grid_build(grid, 0, NULL, 0.08), SSFR_OK);
    assert_int_equal(ssfr_grid_near(grid, (float[3]){0, 0, 0}, ranges), 0);
    assert_int_equal(ssfr_grid_n_cells(grid), 0);
    ssfr_grid_destroy(&grid);
    ssfr_grid_destroy(&grid);
}

/* The whole answer of a grid: its order, and the ranges around every 50th point. */
static size_t answer(size_t n, double cell, uint32_t *out)
{
    ssfr_grid *grid = build(n, cell);
    size_t size = n;
    memcpy(out, ssfr_grid_order(grid), n * sizeof *out);
    for (size_t i = 0; i < n; i += 50) {
        ssfr_grid_range ranges[SSFR_GRID_ROWS];
        const int n_ranges = ssfr_grid_near(grid, points + 3 * i, ranges);
        for (int r = 0; r < n_ranges; r++) out[size++] = ranges[r].begin, out[size++] = ranges[r].end;
    }
    ssfr_grid_destroy(&grid);
    return size;
}

static void the_order_is_the_same_for_any_number_of_threads(void **state)
{
    (void)state;
    static uint32_t one[2 * N_MAX], other[2 * N_MAX];
    const int before = omp_get_max_threads();
    random_points(N_MAX, -2.385, 1.117, 4);
    points[3 * 1117] = -23850; /* spray far away: more digits to sort by */
    omp_set_num_threads(1);
    const size_t size = answer(N_MAX, 0.08, one);
    for (int t = 2; t <= 16; t *= 2) {
        omp_set_num_threads(t);
        assert_int_equal(answer(N_MAX, 0.08, other), size);
        assert_memory_equal(one, other, size * sizeof *one);
    }
    omp_set_num_threads(before);
}

static void memory_follows_the_points_and_not_the_space_between_them(void **state)
{
    (void)state;
    random_points(10000, -1, 1, 5);
    ssfr_grid *grid = build(10000, 0.08);
    const size_t bytes = ssfr_grid_bytes(grid);
    points[0] = 8e4f, points[4] = -8e4f;
    assert_int_equal(ssfr_grid_build(grid, 10000, points, 0.08), SSFR_OK);
    check_near(grid, 10000, points);
    assert_int_equal(ssfr_grid_build(grid, 17, points, 0.08), SSFR_OK);
    check_near(grid, 17, points + 3);
    assert_int_equal(ssfr_grid_bytes(grid), bytes);
    assert_int_equal(ssfr_grid_build(grid, 20000, points, 0.08), SSFR_OK); /* the rest stands at the origin */
    assert_true(ssfr_grid_bytes(grid) > bytes);
    ssfr_grid_destroy(&grid);
}

static void points_that_are_not_finite_or_too_far_are_refused_by_their_index(void **state)
{
    (void)state;
    ssfr_grid *grid = NULL;
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    assert_int_equal(ssfr_grid_create(&grid), SSFR_OK);
    random_points(30000, -1, 1, 6);
    const float values[] = {NAN, INFINITY, -INFINITY, 84000.0f, -84000.0f};
    for (size_t v = 0; v < SSFR_COUNT(values); v++) {
        const float kept = points[3 * 21117 + 1];
        points[3 * 21117 + 1] = points[3 * 29999] = values[v];
        assert_fails(SSFR_ERR_VALUE, ssfr_grid_build(grid, 30000, points, 0.08), "point 21117 (from 0)");
        assert_non_null(strstr(test_last_error(), v < 3 ? "is not finite" : "2^20 cells of 0.08 m"));
        assert_int_equal(ssfr_grid_near(grid, points, ranges), 0);
        points[3 * 21117 + 1] = kept;
    }
    points[3 * 29999] = 83886.0f; /* just inside of 2^20 cells */
    assert_int_equal(ssfr_grid_build(grid, 30000, points, 0.08), SSFR_OK);
    check_near(grid, 30000, points + 3 * 29999);
    ssfr_grid_destroy(&grid);
}

static void cells_without_a_size_are_refused(void **state)
{
    (void)state;
    ssfr_grid *grid = NULL;
    assert_int_equal(ssfr_grid_create(&grid), SSFR_OK);
    const double cells[] = {0, -0.08, NAN, INFINITY, 1e-310};
    for (size_t c = 0; c < SSFR_COUNT(cells); c++)
        assert_fails(SSFR_ERR_VALUE, ssfr_grid_build(grid, 3, points, cells[c]), "expected a positive number");
    ssfr_grid_destroy(&grid);
}

static void points_of_particles_are_relative_to_the_middle_of_their_bounds(void **state)
{
    (void)state;
    double positions[3 * 300], origin[3], lo[3], hi[3];
    uint64_t seed = 7;
    for (size_t i = 0; i < 900; i++) positions[i] = (i % 3 == 0 ? 1e6 : -2.385) + test_random(&seed, -0.5, 0.75);
    ssfr_particles *particles = NULL;
    float *local = NULL;
    assert_int_equal(ssfr_particles_create(&particles, 300, positions, NULL), SSFR_OK);
    assert_int_equal(ssfr_grid_points(particles, origin, &local), SSFR_OK);
    ssfr_particles_bounds(particles, lo, hi);
    for (size_t k = 0; k < 3; k++) assert_close(origin[k], 0.5 * (lo[k] + hi[k]), 1e-9, 0);
    for (size_t i = 0; i < 300; i++) {
        double at[3];
        ssfr_particles_position(particles, i, at);
        for (size_t k = 0; k < 3; k++) assert_close(origin[k] + (double)local[3 * i + k], at[k], 1e-7, 0);
    }
    free(local);
    ssfr_particles_destroy(&particles);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_point_in_reach_is_listed_once_among_random_points),
        cmocka_unit_test(every_point_in_reach_is_listed_once_in_clusters_far_apart),
        cmocka_unit_test(points_on_the_borders_of_cells_are_listed),
        cmocka_unit_test(points_a_cell_apart_are_listed_far_from_the_origin),
        cmocka_unit_test(coincident_points_are_all_listed_in_their_order),
        cmocka_unit_test(a_single_point_is_found_from_a_cell_away_and_not_from_further),
        cmocka_unit_test(an_empty_grid_lists_nothing),
        cmocka_unit_test(the_order_is_the_same_for_any_number_of_threads),
        cmocka_unit_test(memory_follows_the_points_and_not_the_space_between_them),
        cmocka_unit_test(points_that_are_not_finite_or_too_far_are_refused_by_their_index),
        cmocka_unit_test(cells_without_a_size_are_refused),
        cmocka_unit_test(points_of_particles_are_relative_to_the_middle_of_their_bounds),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_quantities.c: density and neighbours, against sums over all pairs, exact cases, and a simulator's own. */
#include "tests/util.h"

#include "scene/grid.h"

#include <omp.h>

enum { SIDE = 11, N = SIDE * SIDE * SIDE };

static const double lone_density = 254.6479089470325; /* kg/m^3: 0.1 (8 / pi) 1000 */

static ssfr_particles *create(size_t n, const double *positions, double radius)
{
    ssfr_particles *particles = NULL;
    assert_int_equal(ssfr_particles_create(&particles, n, positions, &(ssfr_particles){.radius = radius}), SSFR_OK);
    return particles;
}

static void complete(ssfr_particles *particles)
{
    unsigned computed = 0;
    assert_int_equal(ssfr_particles_complete(particles, &computed), SSFR_OK);
    assert_int_equal(computed, SSFR_COMPUTED_DENSITY | SSFR_COMPUTED_NEIGHBOURS);
    assert_non_null(particles->density);
    assert_non_null(particles->neighbours);
}

/* A cubic lattice as dense as fluid at rest, each particle moved by up to `noise` of the lattice's edge. */
static ssfr_particles *make_lattice(const double corner[3], double radius, double noise)
{
    static double positions[3 * N];
    const double edge = cbrt(0.8) * 2 * radius;
    uint64_t seed = 2385;
    for (int i = 0; i < N; i++) {
        const int cell[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int k = 0; k < 3; k++)
            positions[3 * i + k] = corner[k] + edge * (cell[k] + test_random(&seed, -noise, noise));
    }
    return create(N, positions, radius);
}

/* m, between two particles of the set: their packets' centres are subtracted first. */
static double distance(const ssfr_particles *p, size_t i, size_t j)
{
    double sum = 0;
    for (size_t k = 0; k < 3; k++)
        sum += ssfr_square((p->packets[i / SSFR_PACKET].centre[k] - p->packets[j / SSFR_PACKET].centre[k]) +
                           (double)p->position[3 * i + k] - (double)p->position[3 * j + k]);
    return sqrt(sum);
}

/* Monaghan's form of the kernel, with h half of where it ends, and the particle's mass in kilograms. */
static double kernel_by_definition(double distance, double radius)
{
    const double h = 2 * radius, q = distance / h, mass = 0.8 * 8 * radius * radius * radius * 1000;
    const double w = q < 1 ? 1 - 1.5 * q * q + 0.75 * q * q * q : q < 2 ? 0.25 * (2 - q) * (2 - q) * (2 - q) : 0;
    return mass * w / (M_PI * h * h * h);
}

static void check_against_all_pairs(const ssfr_particles *p)
{
    for (size_t i = 0; i < p->n; i++) {
        double density = 0;
        uint32_t neighbours = 0;
        for (size_t j = 0; j < p->n; j++) {
            density += kernel_by_definition(distance(p, i, j), p->radius);
            neighbours += i != j && distance(p, i, j) < 4 * p->radius;
        }
        assert_int_equal(p->neighbours[i], neighbours);
        assert_close((double)p->density[i], density, 0, 1e-7);
    }
}

/* ---- exact cases ------------------------------------------------------------------------------------------------- */

static void a_lone_particle_has_its_own_kernels_density(void **state)
{
    (void)state;
    for (double radius = 2.385e-9; radius < 1e9; radius *= 1e3) {
        ssfr_particles *p = create(1, (double[3]){2.385, -1.117, 0.3}, radius);
        complete(p);
        assert_close((double)p->density[0], lone_density, 0, 1e-7);
        assert_int_equal(p->neighbours[0], 0);
        ssfr_particles_destroy(&p);
    }
}

static void fluid_at_rest_has_its_rest_density(void **state)
{
    (void)state;
    ssfr_particles *p = make_lattice((double[3]){0.3, -0.2, 2.385}, 0.02385, 0);
    complete(p);
    double largest = 0;
    uint32_t most = 0;
    for (size_t i = 0; i < N; i++) {
        largest = fmax(largest, (double)p->density[i]);
        if (p->neighbours[i] > most) most = p->neighbours[i];
    }
    assert_close(largest, SSFR_REST_DENSITY, 0, 0.01);
    assert_int_equal(most, 32); /* lattice points within 2.154 edges: 6 + 12 + 8 + 6 */
    ssfr_particles_destroy(&p);
}

static void coincident_particles_are_neighbours(void **state)
{
    (void)state;
    enum { COPIES = 7 };
    double positions[3 * COPIES];
    for (int i = 0; i < 3 * COPIES; i++) positions[i] = 2.385;
    ssfr_particles *p = create(COPIES, positions, 0.01117);
    complete(p);
    for (size_t i = 0; i < COPIES; i++) {
        assert_int_equal(p->neighbours[i], COPIES - 1);
        assert_close((double)p->density[i], COPIES * lone_density, 0, 1e-7);
    }
    ssfr_particles_destroy(&p);
}

static void a_neighbour_is_nearer_than_the_support(void **state)
{
    (void)state;
    const double radius = 0.25, support = 1; /* exact in binary: a tie is a tie */
    const double gaps[] = {support - 0x1p-20, support, support + 0x1p-20};
    for (int axis = 0; axis < 3; axis++)
        for (size_t g = 0; g < SSFR_COUNT(gaps); g++) {
            double positions[6] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5};
            positions[3 + axis] += gaps[g];
            ssfr_particles *p = create(2, positions, radius);
            complete(p);
            for (size_t i = 0; i < 2; i++) assert_int_equal(p->neighbours[i], gaps[g] < support);
            ssfr_particles_destroy(&p);
        }
}

/* ---- clouds ------------------------------------------------------------------------------------------------------ */

static void a_cloud_has_the_sums_over_all_pairs(void **state)
{
    (void)state;
    ssfr_particles *p = make_lattice((double[3]){-0.3, 0.2, 2.385}, 0.02385, 0.7);
    complete(p);
    check_against_all_pairs(p);
    ssfr_particles_destroy(&p);
}

static void it_is_as_exact_a_million_metres_away(void **state)
{
    (void)state;
    ssfr_particles *p = make_lattice((double[3]){1e6, -1e6, 2.385e6}, 0.02385, 0.7);
    complete(p);
    check_against_all_pairs(p);
    ssfr_particles_destroy(&p);
}

/* Floats between particles three thousand metres apart are off by a hundredth of the radius. */
static void a_stray_far_away_costs_no_digits(void **state)
{
    (void)state;
    enum { M = 200 };
    double positions[3 * (M + 1)];
    uint64_t seed = 1117;
    for (int i = 0; i < 3 * M; i++) positions[i] = test_random(&seed, 0, 0.15);
    for (int k = 0; k < 3; k++) positions[3 * M + k] = 3000;
    ssfr_particles *p = create(M + 1, positions, 0.02385);
    complete(p);
    check_against_all_pairs(p);
    ssfr_particles_destroy(&p);
}

static void the_bits_are_the_same_for_any_number_of_threads(void **state)
{
    (void)state;
    const int before = omp_get_max_threads();
    ssfr_particles *sets[3];
    for (int t = 0; t < 3; t++) {
        omp_set_num_threads((const int[]){1, 2, 16}[t]);
        sets[t] = make_lattice((double[3]){-0.3, 0.2, 2.385}, 0.02385, 0.7);
        complete(sets[t]);
    }
    omp_set_num_threads(before);
    for (int t = 1; t < 3; t++) {
        assert_memory_equal(sets[t]->density, sets[0]->density, N * sizeof *sets[0]->density);
        assert_memory_equal(sets[t]->neighbours, sets[0]->neighbours, N * sizeof *sets[0]->neighbours);
    }
    for (int t = 0; t < 3; t++) ssfr_particles_destroy(&sets[t]);
}

/* ---- what is there, and what cannot be --------------------------------------------------------------------------- */

static void arrays_that_are_there_stay(void **state)
{
    (void)state;
    const double positions[6] = {0, 0, 0, 0.05, 0, 0};
    float density[2] = {2.385f, 2.385f};
    uint32_t neighbours[2] = {2385, 2385};
    ssfr_particles *p = NULL;
    unsigned computed = 0;
    assert_int_equal(ssfr_particles_create(&p, 2, positions, &(ssfr_particles){.density = density, .radius = 0.02}),
                     SSFR_OK);
    assert_int_equal(ssfr_particles_complete(p, &computed), SSFR_OK);
    assert_int_equal(computed, SSFR_COMPUTED_NEIGHBOURS);
    assert_true(p->density[0] == 2.385f && p->neighbours[0] == 1);
    assert_int_equal(ssfr_particles_complete(p, &computed), SSFR_OK);
    assert_int_equal(computed, 0);
    ssfr_particles_destroy(&p);
    assert_int_equal(
        ssfr_particles_create(&p, 2, positions, &(ssfr_particles){.neighbours = neighbours, .radius = 0.02}), SSFR_OK);
    assert_int_equal(ssfr_particles_complete(p, &computed), SSFR_OK);
    assert_int_equal(computed, SSFR_COMPUTED_DENSITY);
    assert_true((double)p->density[0] > lone_density && p->neighbours[0] == 2385);
    ssfr_particles_destroy(&p);
}

static void no_particles_have_empty_arrays(void **state)
{
    (void)state;
    ssfr_particles *p = create(0, NULL, 0.02385);
    complete(p);
    ssfr_particles_destroy(&p);
}

static void what_cannot_be_computed_is_refused(void **state)
{
    (void)state;
    const double near[6] = {0, 0, 0, 0.05, 0, 0}, far[6] = {0, 0, 0, 1e6, 0, 0};
    ssfr_particles *p = create(2, near, 0);
    unsigned computed = 3;
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_complete(p, &computed), "radius 0 m");
    assert_int_equal(computed, 0);
    const double radii[] = {-0.02, NAN, INFINITY, 1e-200};
    for (size_t i = 0; i < SSFR_COUNT(radii); i++) {
        p->radius = radii[i];
        assert_fails(SSFR_ERR_VALUE, ssfr_particles_complete(p, NULL), "radius");
    }
    assert_true(!p->density && !p->neighbours);
    ssfr_particles_destroy(&p);
    p = create(2, far, 1e-3);
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_complete(p, NULL), "cells");
    assert_true(!p->density && !p->neighbours);
    ssfr_particles_destroy(&p);
}

/* ---- a simulator's own ------------------------------------------------------------------------------------------- */

/* Whether no wall, obstacle or surface is within reach: elsewhere the simulator's density holds the walls' share, and
 * it is that of the step's begin, before the last motion. */
static bool is_inside(const ssfr_particles *p, size_t i)
{
    double at[3];
    ssfr_particles_position(p, i, at);
    return p->neighbours[i] >= 36 && fabs(at[0]) < 2.3 && fabs(at[2]) < 0.9 && at[1] > 0.1 && at[1] < 3.1 &&
           hypot(at[0], hypot(at[1] - 0.3, at[2] - 0.35)) > 0.4 && hypot(at[0] - 0.15, at[2] + 0.5) > 0.32;
}

static void a_dam_break_has_its_simulators_values(void **state)
{
    (void)state;
    char path[512];
    snprintf(path, sizeof path, "%s/ddb_mid_fluid.ply", test_data_or_skip());
    ssfr_particles *p = NULL;
    assert_int_equal(ssfr_particles_load(&p, path, &(ssfr_load_options){.radius = 0.02}), SSFR_OK);
    float *density = p->density;
    uint32_t *neighbours = p->neighbours;
    size_t n_inside = 0, n_near = 0;
    double worst = 0;
    p->density = NULL, p->neighbours = NULL;
    const double start = ssfr_clock();
    complete(p);
    print_message("%zu particles: %.1f ms on %d threads\n", p->n, 1e3 * (ssfr_clock() - start), omp_get_max_threads());
    assert_memory_equal(p->neighbours, neighbours, p->n * sizeof *neighbours);
    for (size_t i = 0; i < p->n; i++) {
        if (!is_inside(p, i)) continue;
        const double off = fabs((double)p->density[i] / (double)density[i] - 1);
        n_inside++;
        n_near += off < 0.0015;
        worst = fmax(worst, off);
    }
    print_message("density of %zu particles: %zu off by less than 0.15 %%, the worst by %g\n", n_inside, n_near, worst);
    assert_true(n_inside > 50000);
    assert_true((double)n_near > 0.99 * (double)n_inside && worst < 0.005);
    free(density);
    free(neighbours);
    ssfr_particles_destroy(&p);
}

/* ---- the radius -------------------------------------------------------------------------------------------------- */

static double estimate(const ssfr_particles *p)
{
    double radius = NAN;
    assert_int_equal(ssfr_particles_estimate_radius(p, &radius), SSFR_OK);
    return radius;
}

static void the_radius_of_fluid_at_rest_is_found_again(void **state)
{
    (void)state;
    for (double radius = 2.385e-6; radius < 1e6; radius *= 1e3)
        for (double noise = 0; noise < 0.3; noise += 0.12) {
            ssfr_particles *p = make_lattice((double[3]){0.3 * radius, -0.2, 2.385}, radius, noise);
            complete(p);
            assert_close(estimate(p), radius, 0, 0.12); /* half of them lack neighbours beyond the lattice's faces */
            p->radius = estimate(p);
            size_t n_below = 0;
            free(p->density);
            free(p->neighbours);
            p->density = NULL, p->neighbours = NULL;
            complete(p);
            for (size_t i = 0; i < N; i++) n_below += p->density[i] < SSFR_REST_DENSITY;
            assert_close((double)n_below / N, 0.5, 0.05, 0);
            ssfr_particles_destroy(&p);
        }
}

static void sprays_and_few_particles_have_half_their_spacing(void **state)
{
    (void)state;
    enum { SPRAY = 1000 };
    double positions[3 * SPRAY];
    uint64_t seed = 2385;
    for (int k = 0; k < 3 * SPRAY; k++) positions[k] = test_random(&seed, -1, 1);
    ssfr_particles *p = create(SPRAY, positions, 0);
    assert_true(estimate(p) == ssfr_particles_spacing(p));
    ssfr_particles_destroy(&p);
    for (size_t n = 0; n < 4; n++) {
        p = create(n, (double[9]){0, 0, 0, 2.385, 0, 0, 0, 2.385, 0}, 0);
        assert_close(estimate(p), n < 2 ? 0 : 1.1925, 1e-6, 0);
        ssfr_particles_destroy(&p);
    }
    for (int k = 0; k < 3 * SPRAY; k++) positions[k] = k < 3 * SPRAY - 3 ? positions[k] : 1e9; /* m, beyond all grids */
    p = create(SPRAY, positions, 0);
    assert_true(estimate(p) == ssfr_particles_spacing(p));
    ssfr_particles_destroy(&p);
    p = create(3, (double[9]){2.385, 1, 1, 2.385, 1, 1, 2.385, 1, 1}, 0);
    assert_true(estimate(p) == 0);
    ssfr_particles_destroy(&p);
}

static void a_simulators_radius_is_found_again(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double radius; /* m, that of the simulation */
    } cases[] = {{"native_ddb_mid_ParticleData_Fluid_56.vtk", 0.02}, {"ddb_early_fluid.ply", 0.02}};
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        char path[512];
        ssfr_particles *p = NULL;
        snprintf(path, sizeof path, "%s/%s", test_data_or_skip(), cases[i].name);
        assert_int_equal(ssfr_particles_load(&p, path, NULL), SSFR_OK);
        assert_close(estimate(p), cases[i].radius, 0, 0.001);
        ssfr_particles_destroy(&p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lone_particle_has_its_own_kernels_density),
        cmocka_unit_test(fluid_at_rest_has_its_rest_density),
        cmocka_unit_test(coincident_particles_are_neighbours),
        cmocka_unit_test(a_neighbour_is_nearer_than_the_support),
        cmocka_unit_test(a_cloud_has_the_sums_over_all_pairs),
        cmocka_unit_test(it_is_as_exact_a_million_metres_away),
        cmocka_unit_test(a_stray_far_away_costs_no_digits),
        cmocka_unit_test(the_bits_are_the_same_for_any_number_of_threads),
        cmocka_unit_test(arrays_that_are_there_stay),
        cmocka_unit_test(no_particles_have_empty_arrays),
        cmocka_unit_test(what_cannot_be_computed_is_refused),
        cmocka_unit_test(a_dam_break_has_its_simulators_values),
        cmocka_unit_test(the_radius_of_fluid_at_rest_is_found_again),
        cmocka_unit_test(sprays_and_few_particles_have_half_their_spacing),
        cmocka_unit_test(a_simulators_radius_is_found_again),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_continuum.c: what particles are taken for: places, weights, stretched kernels, and the memory that it takes. */
#include "experiments/truth/line.h"
#include "base/param.h"
#include "tests/counted_memory.h"
#include "tests/util.h"

#include <gsl/gsl_linalg.h>
#include <omp.h>

static void start_counting(long failing)
{
    peak_bytes = bytes;
    n_made = 0;
    fails_at = failing;
    test_clear_log();
}

/* ---- particles --------------------------------------------------------------------------------------------------- */

enum { SIDE = 12, N = SIDE * SIDE * SIDE };

static const double radius = 0.02385; /* m */

/* A block of particles at rest, jittered, around a middle. */
static ssfr_particles *block_of(int side, const double middle[3], const ssfr_particles *given)
{
    ssfr_particles *particles = NULL;
    uint64_t seed = 2385;
    const double spacing = 2 * radius * cbrt(SSFR_VOLUME_SHARE);
    const size_t n = (size_t)side * (size_t)side * (size_t)side;
    double *at = malloc(3 * n * sizeof *at);
    assert_non_null(at);
    for (size_t i = 0; i < n; i++) {
        const size_t s = (size_t)side, cell[3] = {i % s, i / s % s, i / s / s};
        for (int k = 0; k < 3; k++)
            at[3 * i + (size_t)k] = middle[k] + spacing * ((double)cell[k] - 0.5 * (side - 1)) +
                                    test_random(&seed, -0.1, 0.1) * radius;
    }
    assert_int_equal(ssfr_particles_create(&particles, n, at, given), SSFR_OK);
    free(at);
    return particles;
}

static const double here[3] = {0.3, -0.2, 2.385}, far_away[3] = {1e6, -3e6, 1e6};

static ssfr_particles *block(void)
{
    return block_of(SIDE, here, &(ssfr_particles){.radius = radius});
}

static ssfr_continuum_params params_of(ssfr_continuum_kind kind)
{
    ssfr_continuum_params params;
    ssfr_params_default(ssfr_continuum_rows, &params);
    params.kind = (int)kind;
    return params;
}

static ssfr_continuum continuum_of(const ssfr_particles *particles, ssfr_continuum_kind kind)
{
    const ssfr_continuum_params params = params_of(kind);
    ssfr_continuum fluid;
    assert_int_equal(ssfr_continuum_init(&fluid, particles, &params, NULL), SSFR_OK);
    assert_int_equal(fluid.kind, kind);
    return fluid;
}

/* The density at a place relative to the fluid's origin: half a metre along a ray. */
static double density_at(const ssfr_continuum *fluid, const double at[3])
{
    ssfr_ray ray = {.dir = {0.6, 0, -0.8}};
    ssfr_line line;
    for (int k = 0; k < 3; k++) ray.origin[k] = at[k] - 0.5 * ray.dir[k];
    ssfr_line_init(&line, fluid);
    assert_int_equal(ssfr_line_cast(&line, &ray, 0, 1), SSFR_OK);
    const double density = ssfr_line_density(&line, 0.5);
    ssfr_line_finish(&line);
    return density;
}

/* ---- tests ------------------------------------------------------------------------------------------------------- */

static void the_defaults_are_those_of_the_papers(void **state)
{
    (void)state;
    const ssfr_continuum_params params = params_of(SSFR_CONTINUUM_DENSITY);
    ssfr_continuum_params defaults;
    ssfr_params_default(ssfr_continuum_rows, &defaults);
    assert_int_equal(defaults.kind, SSFR_CONTINUUM_DENSITY);
    assert_string_equal(ssfr_radial_names[params.kernel], "cubic_spline");
    assert_true(params.level == 0.5 && params.support == 4 && params.size == 1);
    for (int i = 0; i < SSFR_N_CONTINUA; i++) assert_non_null(ssfr_continuum_names[i]);
    assert_null(ssfr_continuum_names[SSFR_N_CONTINUA]);
}

static void places_keep_their_digits_far_away(void **state)
{
    (void)state;
    ssfr_particles *particles = block_of(SIDE, far_away, &(ssfr_particles){.radius = radius});
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        ssfr_continuum fluid = continuum_of(particles, (ssfr_continuum_kind)kind);
        double lo[3], hi[3];
        ssfr_particles_bounds(particles, lo, hi);
        for (int k = 0; k < 3; k++) assert_close(fluid.origin[k], 0.5 * (lo[k] + hi[k]), 1e-9, 0);
        for (size_t i = 0; i < N && kind != SSFR_CONTINUUM_ANISOTROPIC; i++) {
            const double *packet = particles->packets[i / SSFR_PACKET].centre;
            for (size_t k = 0; k < 3; k++) {
                const long double exact = (long double)packet[k] - (long double)fluid.origin[k] +
                                          (long double)particles->position[3 * i + k];
                assert_close(fluid.centre[i][k], (double)exact, 1e-16, 0);
            }
        }
        ssfr_continuum_finish(&fluid);
    }
    ssfr_particles_destroy(&particles);
}

static void densities_are_those_of_the_particles(void **state)
{
    (void)state;
    ssfr_particles *particles = block();
    double least = INFINITY, most = 0;
    assert_int_equal(ssfr_particles_complete(particles, NULL), SSFR_OK);
    for (int kind = SSFR_CONTINUUM_DENSITY; kind <= SSFR_CONTINUUM_ZHU_BRIDSON; kind++) {
        ssfr_continuum fluid = continuum_of(particles, (ssfr_continuum_kind)kind);
        for (size_t i = 0; i < N; i += 7) {
            const double rho = (double)particles->density[i] / SSFR_REST_DENSITY;
            assert_close(density_at(&fluid, fluid.centre[i]), rho, 0, 1e-6);
            least = fmin(least, rho), most = fmax(most, rho);
        }
        ssfr_continuum_finish(&fluid);
    }
    assert_true(least < 0.6 && most > 0.95);
    ssfr_particles_destroy(&particles);
}

static void spheres_are_counted(void **state)
{
    (void)state;
    uint64_t seed = 3;
    ssfr_particles *particles = block();
    ssfr_continuum_params params = params_of(SSFR_CONTINUUM_SPHERES);
    ssfr_continuum fluid;
    params.size = 1.7;
    assert_int_equal(ssfr_continuum_init(&fluid, particles, &params, NULL), SSFR_OK);
    assert_close(fluid.radius, 1.7 * radius, 0, 1e-15);
    assert_true(fluid.support == fluid.radius && fluid.weight == 1 && !fluid.radial);
    for (int i = 0; i < 200; i++) {
        double at[3];
        int n = 0;
        for (int k = 0; k < 3; k++) at[k] = test_random(&seed, -0.2, 0.2);
        for (size_t j = 0; j < N; j++) {
            double d[3];
            for (int k = 0; k < 3; k++) d[k] = at[k] - fluid.centre[j][k];
            n += ssfr_dot(d, d) < ssfr_square(1.7 * radius);
        }
        assert_true(density_at(&fluid, at) == n);
    }
    ssfr_continuum_finish(&fluid);
    ssfr_particles_destroy(&particles);
}

/* |A^-1 d| by LU decomposition, and A's determinant. */
static double stretched_length(const float shape[6], const double d[3], double *det)
{
    double a[9] = {(double)shape[0], (double)shape[1], (double)shape[2], (double)shape[1], (double)shape[3],
                   (double)shape[4], (double)shape[2], (double)shape[4], (double)shape[5]};
    double copy[3] = {d[0], d[1], d[2]}, out[3];
    size_t swaps[3];
    int sign;
    gsl_matrix_view m = gsl_matrix_view_array(a, 3, 3);
    gsl_vector_view b = gsl_vector_view_array(copy, 3), x = gsl_vector_view_array(out, 3);
    gsl_permutation permutation = {3, swaps};
    assert_int_equal(gsl_linalg_LU_decomp(&m.matrix, &permutation, &sign), 0);
    assert_int_equal(gsl_linalg_LU_solve(&m.matrix, &permutation, &b.vector, &x.vector), 0);
    *det = gsl_linalg_LU_det(&m.matrix, sign);
    return sqrt(ssfr_dot(out, out));
}

/* sum m / rho_j W(|A_j^-1 (x - xs_j)| / h) / (h^3 det A_j). */
static void anisotropic_densities_are_those_of_the_paper(void **state)
{
    (void)state;
    const double support = SSFR_SUPPORT * radius, volume = SSFR_VOLUME_SHARE * 8 * radius * radius * radius;
    ssfr_anisotropy_params anisotropy = ssfr_anisotropy_defaults();
    ssfr_particles *particles = block();
    float *centre = malloc(3 * N * sizeof *centre), *shape = malloc(6 * N * sizeof *shape);
    uint64_t seed = 4;
    double most = 0;
    assert_true(centre && shape);
    anisotropy.k_max = 2.385;
    assert_int_equal(ssfr_particles_anisotropy(particles, &anisotropy, centre, shape), SSFR_OK);
    for (int kernel = 0; kernel < SSFR_N_RADIALS; kernel++) {
        ssfr_continuum_params params = params_of(SSFR_CONTINUUM_ANISOTROPIC);
        ssfr_continuum fluid;
        params.kernel = kernel;
        assert_int_equal(ssfr_continuum_init(&fluid, particles, &params, &anisotropy), SSFR_OK);
        assert_null(particles->density); /* the caller's set stays as it was */
        ssfr_particles copy = *particles;
        assert_int_equal(ssfr_particles_complete(&copy, NULL), SSFR_OK);
        for (int i = 0; i < 40; i++) {
            double at[3], sum = 0;
            for (int k = 0; k < 3; k++) at[k] = test_random(&seed, -0.3, 0.3);
            for (size_t j = 0; j < N; j++) {
                double d[3], det;
                for (size_t k = 0; k < 3; k++)
                    d[k] = at[k] - (particles->packets[j / SSFR_PACKET].centre[k] - fluid.origin[k] +
                                    (double)centre[3 * j + k]);
                const double q = stretched_length(shape + 6 * j, d, &det) / support;
                sum += volume * SSFR_REST_DENSITY / (double)copy.density[j] / (support * support * support * det) *
                       ssfr_radial_value(fluid.radial, q);
            }
            assert_close(density_at(&fluid, at), sum, 1e-13, 1e-11);
            most = fmax(most, sum);
        }
        free(copy.density), free(copy.neighbours);
        ssfr_continuum_finish(&fluid);
    }
    assert_true(most > 0.9);
    free(centre), free(shape);
    ssfr_particles_destroy(&particles);
}

static void densities_that_the_particles_have_are_taken(void **state)
{
    (void)state;
    float *density = malloc(N * sizeof *density);
    assert_non_null(density);
    for (size_t i = 0; i < N; i++) density[i] = 238.5F;
    ssfr_particles *bare = block(), *given = block_of(SIDE, here, &(ssfr_particles){.radius = radius,
                                                                                    .density = density});
    ssfr_continuum one = continuum_of(bare, SSFR_CONTINUUM_ANISOTROPIC);
    ssfr_continuum two = continuum_of(given, SSFR_CONTINUUM_ANISOTROPIC);
    assert_int_equal(ssfr_particles_complete(bare, NULL), SSFR_OK);
    for (size_t i = 0; i < N; i++)
        assert_close(two.weights[i], one.weights[i] * (double)bare->density[i] / 238.5, 0, 1e-12);
    ssfr_continuum_finish(&one), ssfr_continuum_finish(&two);
    ssfr_particles_destroy(&bare), ssfr_particles_destroy(&given);
    free(density);
}

static void no_particles_are_a_fluid_that_is_nowhere(void **state)
{
    (void)state;
    ssfr_particles *none = NULL;
    assert_int_equal(ssfr_particles_create(&none, 0, NULL, NULL), SSFR_OK);
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        ssfr_continuum fluid = continuum_of(none, (ssfr_continuum_kind)kind);
        assert_int_equal(fluid.n, 0);
        assert_true(fluid.support > 0 && isfinite(fluid.weight));
        assert_true(density_at(&fluid, (double[3]){0, 0, 0}) == 0);
        assert_int_equal(ssfr_continuum_bytes(&fluid), 0);
        ssfr_continuum_finish(&fluid);
    }
    ssfr_particles_destroy(&none);
}

/* V w(0) / h^3 in its middle: 8 / pi V / h^3. */
static void one_particle_is_a_fluid(void **state)
{
    (void)state;
    ssfr_particles *one = block_of(1, here, &(ssfr_particles){.radius = radius});
    ssfr_continuum spheres = continuum_of(one, SSFR_CONTINUUM_SPHERES);
    ssfr_continuum density = continuum_of(one, SSFR_CONTINUUM_DENSITY);
    ssfr_continuum stretched = continuum_of(one, SSFR_CONTINUUM_ANISOTROPIC);
    const double alone = 8 / M_PI * SSFR_VOLUME_SHARE * 8 / 64;
    assert_true(density_at(&spheres, spheres.centre[0]) == 1);
    assert_close(density_at(&density, density.centre[0]), alone, 0, 1e-12);
    /* Half as large in every direction, and of the volume that its own density gives it. */
    assert_close(density_at(&stretched, stretched.centre[0]), 8, 0, 1e-6);
    ssfr_continuum_finish(&spheres), ssfr_continuum_finish(&density), ssfr_continuum_finish(&stretched);
    ssfr_particles_destroy(&one);
}

static void kernels_of_any_kind_can_be_given(void **state)
{
    (void)state;
    static const double at[2][3] = {{0, 0, 0}, {0.01, 0, 0}}, origin[3] = {5, 6, 7};
    ssfr_continuum fluid;
    assert_int_equal(ssfr_continuum_init_kernels(&fluid, 2, at, origin, &ssfr_radials[2], 0.02, 2.385, 0.3), SSFR_OK);
    assert_true(fluid.level == 0.3 && fluid.origin[1] == 6);
    assert_close(density_at(&fluid, at[0]),
                 2.385 * (ssfr_radial_value(&ssfr_radials[2], 0) + ssfr_radial_value(&ssfr_radials[2], 0.5)), 0, 1e-12);
    ssfr_continuum_finish(&fluid);
    assert_int_equal(ssfr_continuum_init_kernels(&fluid, 0, NULL, origin, &ssfr_radials[2], 0.02, 1, 0.3), SSFR_OK);
    ssfr_continuum_finish(&fluid);
    assert_fails(SSFR_ERR_VALUE, ssfr_continuum_init_kernels(&fluid, 2, at, origin, &ssfr_radials[2], 0, 1, 0.3),
                 "support 0 m");
    assert_fails(SSFR_ERR_VALUE, ssfr_continuum_init_kernels(&fluid, 2, at, origin, &ssfr_radials[2], NAN, 1, 0.3),
                 "support nan m");
    assert_null(fluid.centre);
}

static void what_makes_no_fluid_is_refused(void **state)
{
    (void)state;
    ssfr_particles *particles = block();
    ssfr_continuum_params params = params_of(SSFR_CONTINUUM_DENSITY);
    ssfr_anisotropy_params anisotropy = ssfr_anisotropy_defaults();
    ssfr_continuum fluid;
    params.level = 1.5;
    assert_fails(SSFR_ERR_VALUE, ssfr_continuum_init(&fluid, particles, &params, NULL), "level");
    params = params_of(SSFR_CONTINUUM_ANISOTROPIC);
    anisotropy.k_r = 0;
    assert_fails(SSFR_ERR_VALUE, ssfr_continuum_init(&fluid, particles, &params, &anisotropy), "k_r");
    static const float densities[] = {0, -1000, NAN, INFINITY};
    particles->density = calloc(N, sizeof *particles->density);
    assert_non_null(particles->density);
    for (size_t k = 0; k < SSFR_COUNT(densities); k++) {
        for (size_t i = 0; i < N; i++) particles->density[i] = i == 713 ? densities[k] : 1000;
        assert_fails(SSFR_ERR_VALUE, ssfr_continuum_init(&fluid, particles, &params, NULL), "particle 713 ");
        assert_null(fluid.centre);
    }
    static const double radii[] = {0, -0.01, NAN, INFINITY, 1e-120, 1e110};
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++)
        for (size_t k = 0; k < SSFR_COUNT(radii); k++) {
            params.kind = kind;
            particles->radius = radii[k];
            assert_fails(SSFR_ERR_VALUE, ssfr_continuum_init(&fluid, particles, &params, NULL), "particle radius");
            assert_null(fluid.boxes.boxes);
        }
    ssfr_particles_destroy(&particles);
}

static void a_particle_takes_less_than_300_bytes(void **state)
{
    (void)state;
    const double n = 30 * 30 * 30, most = 300;
    ssfr_particles *particles = block_of(30, here, &(ssfr_particles){.radius = radius});
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        const long before = bytes;
        start_counting(-1);
        ssfr_continuum fluid = continuum_of(particles, (ssfr_continuum_kind)kind);
        assert_true((double)(peak_bytes - before) < most * n);
        assert_true((double)ssfr_continuum_bytes(&fluid) > 24 * n);
        assert_true((double)ssfr_continuum_bytes(&fluid) <= (double)(bytes - before));
        assert_close((double)(bytes - before), (double)ssfr_continuum_bytes(&fluid), 1 << 16, 0);
        ssfr_continuum_finish(&fluid);
        assert_int_equal(bytes, before);
    }
    ssfr_particles_destroy(&particles);
}

static void running_out_of_memory_leaves_nothing_behind(void **state)
{
    (void)state;
    ssfr_particles *particles = block();
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        const ssfr_continuum_params params = params_of((ssfr_continuum_kind)kind);
        const long before = bytes;
        long failing = 0;
        ssfr_result result = SSFR_ERR_MEMORY;
        for (; result != SSFR_OK; failing++) {
            ssfr_continuum fluid;
            start_counting(failing);
            result = ssfr_continuum_init(&fluid, particles, &params, NULL);
            fails_at = -1;
            assert_true(result == SSFR_OK || result == SSFR_ERR_MEMORY);
            assert_int_equal(test_n_errors(), result == SSFR_OK ? 0 : 1);
            ssfr_continuum_finish(&fluid);
            assert_int_equal(bytes, before);
        }
        assert_true(failing > 2);
    }
    ssfr_particles_destroy(&particles);
}

static void threads_change_no_bit_of_a_fluid(void **state)
{
    (void)state;
    const int threads = omp_get_max_threads();
    ssfr_particles *particles = block();
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        omp_set_num_threads(1);
        ssfr_continuum one = continuum_of(particles, (ssfr_continuum_kind)kind);
        omp_set_num_threads(3);
        ssfr_continuum three = continuum_of(particles, (ssfr_continuum_kind)kind);
        omp_set_num_threads(threads);
        assert_memory_equal(one.centre, three.centre, N * sizeof *one.centre);
        assert_memory_equal(one.boxes.boxes, three.boxes.boxes, ssfr_boxes_bytes(&one.boxes));
        if (one.weights) assert_memory_equal(one.weights, three.weights, N * sizeof *one.weights);
        if (one.inverse) assert_memory_equal(one.inverse, three.inverse, N * sizeof *one.inverse);
        ssfr_continuum_finish(&one), ssfr_continuum_finish(&three);
    }
    ssfr_particles_destroy(&particles);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_defaults_are_those_of_the_papers),
        cmocka_unit_test(places_keep_their_digits_far_away),
        cmocka_unit_test(densities_are_those_of_the_particles),
        cmocka_unit_test(spheres_are_counted),
        cmocka_unit_test(anisotropic_densities_are_those_of_the_paper),
        cmocka_unit_test(densities_that_the_particles_have_are_taken),
        cmocka_unit_test(no_particles_are_a_fluid_that_is_nowhere),
        cmocka_unit_test(one_particle_is_a_fluid),
        cmocka_unit_test(kernels_of_any_kind_can_be_given),
        cmocka_unit_test(what_makes_no_fluid_is_refused),
        cmocka_unit_test(a_particle_takes_less_than_300_bytes),
        cmocka_unit_test(running_out_of_memory_leaves_nothing_behind),
        cmocka_unit_test(threads_change_no_bit_of_a_fluid),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_anisotropy.c: ellipsoids of known neighbourhoods, sums by definition, and GSL's eigenvectors. */
#include "tests/util.h"

#include "scene/anisotropy.h"

#include <gsl/gsl_eigen.h>
#include <omp.h>

static const double radius = 0.02385;

typedef struct cloud {
    ssfr_particles *particles;
    float *centre, *shape;
} cloud;

static cloud compute(size_t n, const double *positions, const ssfr_anisotropy_params *params)
{
    cloud c = {0};
    assert_int_equal(ssfr_particles_create(&c.particles, n, positions, &(ssfr_particles){.radius = radius}), SSFR_OK);
    assert_int_equal(ssfr_alloc(&c.centre, n, 3 * sizeof *c.centre, "centres"), SSFR_OK);
    assert_int_equal(ssfr_alloc(&c.shape, n, 6 * sizeof *c.shape, "shapes"), SSFR_OK);
    assert_int_equal(ssfr_particles_anisotropy(c.particles, params, c.centre, c.shape), SSFR_OK);
    return c;
}

static void release(cloud *c)
{
    ssfr_particles_destroy(&c->particles);
    free(c->centre);
    free(c->shape);
}

/* The particle nearest to a place. */
static size_t nearest(const cloud *c, const double place[3])
{
    size_t best = 0;
    double least = INFINITY;
    for (size_t i = 0; i < c->particles->n; i++) {
        double at[3], d[3];
        ssfr_particles_position(c->particles, i, at);
        for (int k = 0; k < 3; k++) d[k] = at[k] - place[k];
        if (ssfr_dot(d, d) < least) least = ssfr_dot(d, d), best = i;
    }
    return best;
}

/* The ellipsoid's centre relative to its particle, m. */
static void moved(const cloud *c, size_t i, double out[3])
{
    for (size_t k = 0; k < 3; k++) out[k] = (double)c->centre[3 * i + k] - (double)c->particles->position[3 * i + k];
}

static void shape_of(const cloud *c, size_t i, double out[6])
{
    for (size_t k = 0; k < 6; k++) out[k] = (double)c->shape[6 * i + k];
}

/* Semi-axes in radii, falling, and their directions. */
static void axes_of(const cloud *c, size_t i, double axes[3], double directions[3][3])
{
    double shape[6];
    shape_of(c, i, shape);
    ssfr_eigen_symmetric(shape, axes, directions);
}

static void matrix_times(const double m[6], const double v[3], double out[3])
{
    out[0] = m[0] * v[0] + m[1] * v[1] + m[2] * v[2];
    out[1] = m[1] * v[0] + m[3] * v[1] + m[4] * v[2];
    out[2] = m[2] * v[0] + m[4] * v[1] + m[5] * v[2];
}

/* ---- eigenvectors ------------------------------------------------------------------------------------------------ */

static void check_eigen(const double matrix[6], double scale)
{
    double values[3], vectors[3][3], image[3];
    const double full[9] = {matrix[0], matrix[1], matrix[2], matrix[1], matrix[3],
                            matrix[4], matrix[2], matrix[4], matrix[5]};
    gsl_matrix *a = gsl_matrix_alloc(3, 3), *oracle_vectors = gsl_matrix_alloc(3, 3);
    gsl_vector *oracle = gsl_vector_alloc(3);
    gsl_eigen_symmv_workspace *workspace = gsl_eigen_symmv_alloc(3);
    memcpy(a->data, full, sizeof full);
    gsl_eigen_symmv(a, oracle, oracle_vectors, workspace);
    gsl_eigen_symmv_sort(oracle, oracle_vectors, GSL_EIGEN_SORT_VAL_DESC);
    ssfr_eigen_symmetric(matrix, values, vectors);
    for (int k = 0; k < 3; k++) {
        assert_close(values[k], gsl_vector_get(oracle, (size_t)k), 1e-14 * scale, 0);
        matrix_times(matrix, vectors[k], image);
        for (int j = 0; j < 3; j++) {
            assert_close(image[j], values[k] * vectors[k][j], 1e-14 * scale, 0);
            assert_close(ssfr_dot(vectors[k], vectors[j]), k == j, 1e-14, 0);
        }
    }
    gsl_eigen_symmv_free(workspace);
    gsl_vector_free(oracle);
    gsl_matrix_free(a);
    gsl_matrix_free(oracle_vectors);
}

static void eigenvectors_are_those_of_gsl(void **state)
{
    (void)state;
    uint64_t seed = 2385;
    for (int n = 0; n < 3000; n++) {
        const double scale = exp(test_random(&seed, -200, 200));
        double matrix[6];
        for (int k = 0; k < 6; k++) matrix[k] = scale * test_random(&seed, -1, 1);
        check_eigen(matrix, 3 * scale);
    }
}

static void special_matrices_have_eigenvectors(void **state)
{
    (void)state;
    const double matrices[][6] = {
        {0, 0, 0, 0, 0, 0},          {2.385, 0, 0, 2.385, 0, 2.385}, {1, 0, 0, 3, 0, 2},
        {0, 1, 0, 0, 0, 0},          {1, 1, 1, 1, 1, 1},             {1, 1e-9, 0, 1, 1e-9, 1},
        {1, 1e-17, 1e-17, 1, 0, 1},  {4, 2, 0, 1, 0, 0},             {1, 0, 1e-160, 1e-300, 0, 1e-320},
        {-1, 0.5, 0.25, -2, 0.1, 3}, {1e-300, 1e-300, 0, 1e-300, 0, 0},
    };
    for (size_t n = 0; n < SSFR_COUNT(matrices); n++) check_eigen(matrices[n], 5);
}

/* 1e-12 beside 1: what Householder's reflections lose. */
static void small_eigenvalues_keep_their_digits(void **state)
{
    (void)state;
    const double graded[6] = {1, 1e-6, 1e-7, 4e-12, 1e-13, 9e-14};
    double values[3], vectors[3][3];
    ssfr_eigen_symmetric(graded, values, vectors);
    const long double a = 1, b = 1e-6L, c = 1e-7L, d = 4e-12L, e = 1e-13L, f = 9e-14L;
    const long double det = a * (d * f - e * e) - b * (b * f - e * c) + c * (b * e - d * c);
    assert_close(values[0] * values[1] * values[2], (double)det, 0, 1e-13);
    assert_true(values[2] > 0);
}

/* ---- known neighbourhoods ---------------------------------------------------------------------------------------- */

enum { SIDE = 15, N_CUBE = SIDE * SIDE * SIDE };

/* A cubic lattice of this edge around a middle, `noise` edges off. */
static void make_lattice(double *positions, const double middle[3], double edge, double noise)
{
    uint64_t seed = 1117;
    for (int i = 0; i < N_CUBE; i++) {
        const int cell[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int k = 0; k < 3; k++)
            positions[3 * i + k] = middle[k] + edge * (cell[k] - SIDE / 2 + test_random(&seed, -noise, noise));
    }
}

static void inside_fluid_at_rest_spheres_stay_spheres(void **state)
{
    (void)state;
    static double positions[3 * N_CUBE];
    const double middle[3] = {0.3, -0.2, 2.385};
    make_lattice(positions, middle, cbrt(0.8) * 2 * radius, 0);
    cloud c = compute(N_CUBE, positions, NULL);
    double axes[3], directions[3][3], offset[3];
    const size_t i = nearest(&c, middle);
    axes_of(&c, i, axes, directions);
    moved(&c, i, offset);
    for (int k = 0; k < 3; k++) {
        assert_close(axes[k], axes[0], 1e-6, 0);
        assert_close(axes[k], 0.93, 0.002, 0); /* the lattice is coarse beside the search radius */
        assert_close(offset[k], 0, 1e-7 * radius, 0);
    }
    release(&c);
}

/* The derivation's integral: as lattices get fine, what they give goes to the radius itself. */
static void evenly_filled_space_keeps_the_volume(void **state)
{
    (void)state;
    static double positions[3 * N_CUBE];
    const double middle[3] = {0.3, -0.2, 2.385};
    ssfr_anisotropy_params params = ssfr_anisotropy_defaults();
    params.k_max = 100;
    make_lattice(positions, middle, 4 * radius / 6.6, 0);
    const double scales[] = {1, 0.5, 2.385};
    for (size_t s = 0; s < SSFR_COUNT(scales); s++) {
        double axes[3], directions[3][3];
        params.k_s = scales[s];
        cloud c = compute(N_CUBE, positions, &params);
        axes_of(&c, nearest(&c, middle), axes, directions);
        for (int k = 0; k < 3; k++) assert_close(axes[k], scales[s], 0, 0.003);
        release(&c);
    }
}

static void rotate(double v[3], const double axis[3], double angle)
{
    double cross[3];
    ssfr_cross(axis, v, cross);
    const double along = ssfr_dot(axis, v) * (1 - cos(angle));
    for (int k = 0; k < 3; k++) v[k] = v[k] * cos(angle) + cross[k] * sin(angle) + axis[k] * along;
}

static const double tilt_axis[3] = {0.6, 0, -0.8};
static const double tilt = 0.7; /* rad */

/* A square sheet in the plane y = 0, turned. */
static size_t make_sheet(double *positions, double edge, int side)
{
    size_t n = 0;
    for (int i = 0; i < side; i++)
        for (int k = 0; k < side; k++, n++) {
            double v[3] = {edge * (i - side / 2), 0, edge * (k - side / 2)};
            rotate(v, tilt_axis, tilt);
            for (size_t j = 0; j < 3; j++) positions[3 * n + j] = 1 + v[j];
        }
    return n;
}

static void a_sheet_gives_flat_ellipsoids_across_its_normal(void **state)
{
    (void)state;
    enum { SHEET = 31 };
    static double positions[3 * SHEET * SHEET];
    double normal[3] = {0, 1, 0}, axes[3], directions[3][3], offset[3];
    const size_t n = make_sheet(positions, 4 * radius / 9.5, SHEET);
    rotate(normal, tilt_axis, tilt);
    cloud c = compute(n, positions, NULL);
    const size_t i = nearest(&c, (double[3]){1, 1, 1});
    axes_of(&c, i, axes, directions);
    moved(&c, i, offset);
    assert_close(axes[0], 25.0 / 21, 0, 0.01);
    assert_close(axes[1], axes[0], 0, 1e-5);
    assert_close(axes[2], axes[0] / 4, 0, 1e-5); /* k_r */
    assert_close(fabs(ssfr_dot(directions[2], normal)), 1, 1e-6, 0);
    assert_close(sqrt(ssfr_dot(offset, offset)), 0, 1e-6 * radius, 0);
    release(&c);
}

static void a_rotated_set_has_rotated_matrices_and_centres(void **state)
{
    (void)state;
    static double positions[3 * N_CUBE], turned[3 * N_CUBE];
    const double middle[3] = {0, 0, 0};
    make_lattice(positions, middle, cbrt(0.8) * 2 * radius, 0.3);
    memcpy(turned, positions, sizeof positions);
    for (int i = 0; i < N_CUBE; i++) rotate(turned + 3 * i, tilt_axis, tilt);
    cloud a = compute(N_CUBE, positions, NULL), b = compute(N_CUBE, turned, NULL);
    for (size_t n = 0; n < N_CUBE; n += 17) {
        double place[3], v[3] = {0.3, -0.5, 0.8}, image_a[3], image_b[3], moved_a[3], moved_b[3], shape[6];
        memcpy(place, turned + 3 * n, sizeof place);
        const size_t i = nearest(&a, positions + 3 * n), k = nearest(&b, place);
        shape_of(&a, i, shape);
        matrix_times(shape, v, image_a);
        rotate(image_a, tilt_axis, tilt);
        rotate(v, tilt_axis, tilt);
        shape_of(&b, k, shape);
        matrix_times(shape, v, image_b);
        moved(&a, i, moved_a);
        moved(&b, k, moved_b);
        rotate(moved_a, tilt_axis, tilt);
        for (int j = 0; j < 3; j++) {
            assert_close(image_b[j], image_a[j], 1e-5, 0);
            assert_close(moved_b[j], moved_a[j], 1e-6 * radius + 1e-8, 0);
        }
    }
    release(&a);
    release(&b);
}

/* A particle's mean and spread in the paper's form: the mean of all first, then the spread about it, m and m^2. */
static size_t define(const ssfr_particles *p, size_t i, double search, double mean[3], double covariance[6])
{
    double at[3], weights = 0;
    size_t n = 0;
    ssfr_particles_position(p, i, at);
    memset(mean, 0, 3 * sizeof *mean);
    memset(covariance, 0, 6 * sizeof *covariance);
    for (int pass = 0; pass < 2; pass++) {
        for (size_t j = 0; j < p->n; j++) {
            double d[3];
            ssfr_particles_position(p, j, d);
            for (int k = 0; k < 3; k++) d[k] -= at[k];
            const double q = sqrt(ssfr_dot(d, d)) / search, w = q < 1 ? 1 - q * q * q : 0;
            if (pass == 0) {
                n += q < 1 && j != i, weights += w;
                for (int k = 0; k < 3; k++) mean[k] += w * d[k];
                continue;
            }
            for (int k = 0; k < 3; k++) d[k] -= mean[k];
            for (int k = 0; k < 3; k++) covariance[k] += w / weights * d[0] * d[k];
            covariance[3] += w / weights * d[1] * d[1];
            covariance[4] += w / weights * d[1] * d[2];
            covariance[5] += w / weights * d[2] * d[2];
        }
        for (int k = 0; k < 3 && pass == 0; k++) mean[k] /= weights;
    }
    return n;
}

static void a_cloud_has_the_sums_by_definition(void **state)
{
    (void)state;
    static double positions[3 * N_CUBE];
    make_lattice(positions, (const double[3]){1e6, -1e6, 2.385e6}, cbrt(0.8) * 2 * radius, 0.6);
    const ssfr_anisotropy_params params = {.search = 5, .lambda = 0.93, .k_r = 3, .k_s = 1.1, .k_n = 0.4, .k_max = 1.3,
                                           .n_eps = 40};
    cloud c = compute(N_CUBE, positions, &params);
    size_t n_few = 0;
    for (size_t i = 0; i < N_CUBE; i += 23) {
        double mean[3], covariance[6], offset[3], shape[6], sigma[3], directions[3][3], image[3];
        const bool few = define(c.particles, i, 5 * radius, mean, covariance) <= 40;
        n_few += few;
        moved(&c, i, offset);
        for (int k = 0; k < 3; k++) assert_close(offset[k], 0.93 * mean[k], 1e-5 * radius, 0);
        shape_of(&c, i, shape);
        ssfr_eigen_symmetric(covariance, sigma, directions);
        for (int k = 0; k < 3; k++) {
            const double scaled = 1.1 * fmax(sigma[k], sigma[0] / 3) / (0.15 * 25 * radius * radius);
            matrix_times(shape, directions[k], image);
            for (int j = 0; j < 3; j++)
                assert_close(image[j], (few ? 0.4 : fmin(scaled, 1.3)) * directions[k][j], 1e-5, 0);
        }
    }
    assert_true(n_few > 5 && n_few < 100);
    release(&c);
}

/* ---- poor neighbourhoods ----------------------------------------------------------------------------------------- */

static void check_finite(const cloud *c)
{
    for (size_t i = 0; i < c->particles->n; i++) {
        double axes[3], directions[3][3];
        for (size_t k = 0; k < 3; k++) assert_true(isfinite(c->centre[3 * i + k]));
        for (size_t k = 0; k < 6; k++) assert_true(isfinite(c->shape[6 * i + k]));
        axes_of(c, i, axes, directions);
        assert_true(axes[2] >= 0.125 - 1e-6 && axes[0] <= 1.2 + 1e-6); /* k_n / k_r and k_max */
    }
}

static void few_neighbours_give_small_spheres(void **state)
{
    (void)state;
    double positions[3 * 27];
    uint64_t seed = 2385;
    for (int i = 0; i < 3 * 27; i++) positions[i] = 2.385 + test_random(&seed, 0, radius);
    for (size_t n = 1; n <= 27; n++) { /* all within reach of each other */
        cloud c = compute(n, positions, NULL);
        const bool sphere = c.shape[0] == 0.5f && c.shape[1] == 0 && c.shape[2] == 0 && c.shape[3] == 0.5f &&
                            c.shape[4] == 0 && c.shape[5] == 0.5f;
        assert_int_equal(sphere, n - 1 <= 25);
        check_finite(&c);
        release(&c);
    }
    cloud c = compute(1, positions, NULL);
    assert_memory_equal(c.centre, c.particles->position, 3 * sizeof *c.centre);
    release(&c);
}

static void nothing_is_longer_than_k_max(void **state)
{
    (void)state;
    static double positions[3 * N_CUBE];
    ssfr_anisotropy_params params = ssfr_anisotropy_defaults();
    params.k_max = 0.1; /* less than k_n / k_r */
    make_lattice(positions, (const double[3]){0.3, -0.2, 2.385}, cbrt(0.8) * 2 * radius, 0.6);
    cloud c = compute(N_CUBE, positions, &params);
    for (size_t i = 0; i < N_CUBE; i++) {
        double axes[3], directions[3][3];
        axes_of(&c, i, axes, directions);
        assert_close(axes[0], 0.1, 1e-7, 0);
        assert_true(axes[2] >= 0.025 - 1e-7);
    }
    release(&c);
}

static void degenerate_neighbourhoods_have_finite_shapes(void **state)
{
    (void)state;
    enum { M = 60 };
    double positions[3 * M], axes[3], directions[3][3];
    for (int i = 0; i < 3 * M; i++) positions[i] = 2.385;
    cloud c = compute(M, positions, NULL); /* in one place */
    check_finite(&c);
    axes_of(&c, 0, axes, directions);
    for (int k = 0; k < 3; k++) assert_close(axes[k], 0.125, 1e-7, 0);
    release(&c);
    for (int i = 0; i < M; i++) positions[3 * i + 1] = 0.2 * radius * i; /* on a line */
    c = compute(M, positions, NULL);
    check_finite(&c);
    axes_of(&c, nearest(&c, positions + 3 * (M / 2)), axes, directions);
    assert_close(axes[0], 1.2, 1e-6, 0); /* k_max; unbounded it is 40 / 27, and the others a fourth of that */
    assert_close(axes[2], 10.0 / 27, 0, 0.03);
    assert_close(fabs(directions[0][1]), 1, 1e-6, 0);
    release(&c);
    positions[0] += 1e-9; /* two places a hair apart, one of them full */
    for (int i = 1; i < M; i++) positions[3 * i + 1] = positions[1];
    c = compute(M, positions, NULL);
    check_finite(&c);
    release(&c);
    c = compute(0, NULL, NULL);
    check_finite(&c);
    release(&c);
}

static void lambda_moves_centres_and_nothing_else(void **state)
{
    (void)state;
    static double positions[3 * N_CUBE];
    make_lattice(positions, (const double[3]){0.3, -0.2, 2.385}, cbrt(0.8) * 2 * radius, 0.3);
    ssfr_anisotropy_params params = ssfr_anisotropy_defaults();
    cloud sets[3];
    for (int k = 0; k < 3; k++) {
        params.lambda = 0.5 * k;
        sets[k] = compute(N_CUBE, positions, &params);
        assert_memory_equal(sets[k].shape, sets[0].shape, 6 * N_CUBE * sizeof(float));
    }
    assert_memory_equal(sets[0].centre, sets[0].particles->position, 3 * N_CUBE * sizeof(float));
    double farthest = 0;
    for (size_t i = 0; i < N_CUBE; i++) {
        double half[3], whole[3];
        moved(&sets[1], i, half);
        moved(&sets[2], i, whole);
        for (int k = 0; k < 3; k++) assert_close(half[k], 0.5 * whole[k], 1e-5 * radius, 0);
        farthest = fmax(farthest, sqrt(ssfr_dot(whole, whole)));
    }
    assert_true(farthest > radius && farthest < 4 * radius); /* at corners */
    for (int k = 0; k < 3; k++) release(&sets[k]);
}

static void the_bits_are_the_same_for_any_number_of_threads(void **state)
{
    (void)state;
    static double positions[3 * N_CUBE];
    const int before = omp_get_max_threads();
    cloud sets[3];
    make_lattice(positions, (const double[3]){0.3, -0.2, 2.385}, cbrt(0.8) * 2 * radius, 0.6);
    for (int t = 0; t < 3; t++) {
        omp_set_num_threads((const int[]){1, 2, 16}[t]);
        sets[t] = compute(N_CUBE, positions, NULL);
    }
    omp_set_num_threads(before);
    for (int t = 1; t < 3; t++) {
        assert_memory_equal(sets[t].centre, sets[0].centre, 3 * N_CUBE * sizeof(float));
        assert_memory_equal(sets[t].shape, sets[0].shape, 6 * N_CUBE * sizeof(float));
    }
    for (int t = 0; t < 3; t++) release(&sets[t]);
}

static void what_cannot_be_computed_is_refused(void **state)
{
    (void)state;
    cloud c = compute(2, (const double[6]){0, 0, 0, 1, 1, 1}, NULL);
    ssfr_anisotropy_params params = ssfr_anisotropy_defaults();
    params.k_r = 0.5;
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_anisotropy(c.particles, &params, c.centre, c.shape),
                 "anisotropy.k_r=0.5");
    params.k_r = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_anisotropy(c.particles, &params, c.centre, c.shape),
                 "anisotropy.k_r=nan");
    const double radii[] = {0, -0.02, NAN, INFINITY, 1e-200};
    for (size_t i = 0; i < SSFR_COUNT(radii); i++) {
        c.particles->radius = radii[i];
        assert_fails(SSFR_ERR_VALUE, ssfr_particles_anisotropy(c.particles, NULL, c.centre, c.shape), "radius");
    }
    c.particles->radius = 1e-9;
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_anisotropy(c.particles, NULL, c.centre, c.shape), "cells");
    release(&c);
}

/* ---- a simulation ------------------------------------------------------------------------------------------------ */

static void a_dam_break_has_flat_ellipsoids_at_its_surface(void **state)
{
    (void)state;
    char path[512];
    ssfr_particles *p = NULL;
    cloud c = {0};
    snprintf(path, sizeof path, "%s/ddb_mid_fluid.ply", test_data_or_skip());
    assert_int_equal(ssfr_particles_load(&p, path, &(ssfr_load_options){.radius = 0.02}), SSFR_OK);
    c.particles = p;
    assert_int_equal(ssfr_alloc(&c.centre, p->n, 3 * sizeof *c.centre, "centres"), SSFR_OK);
    assert_int_equal(ssfr_alloc(&c.shape, p->n, 6 * sizeof *c.shape, "shapes"), SSFR_OK);
    const double start = ssfr_clock();
    assert_int_equal(ssfr_particles_anisotropy(p, NULL, c.centre, c.shape), SSFR_OK);
    const double stop = ssfr_clock();
    check_finite(&c);
    double volume = 0, ratio[2] = {0}; /* of those with 38 neighbours or more, and with 26 to 30 */
    size_t n[2] = {0}, n_few = 0;
    for (size_t i = 0; i < p->n; i++) {
        double axes[3], directions[3][3];
        axes_of(&c, i, axes, directions);
        const int g = p->neighbours[i] >= 38 ? 0 : p->neighbours[i] > 25 && p->neighbours[i] <= 30 ? 1 : -1;
        n_few += p->neighbours[i] <= 25;
        if (g < 0) continue;
        n[g]++;
        ratio[g] += axes[2] / axes[0];
        if (g == 0) volume += axes[0] * axes[1] * axes[2];
    }
    print_message("%zu particles: %.0f ms on %d threads; %.1f %% with few neighbours; inside: volume %.3f, shortest "
                  "axis %.2f of the longest; at surfaces %.2f\n",
                  p->n, 1e3 * (stop - start), omp_get_max_threads(), 100 * (double)n_few / (double)p->n,
                  volume / (double)n[0], ratio[0] / (double)n[0], ratio[1] / (double)n[1]);
    assert_close(volume / (double)n[0], 1, 0.1, 0);
    assert_true(ratio[0] / (double)n[0] > 0.8);
    assert_true(ratio[1] / (double)n[1] < 0.7);
    release(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(eigenvectors_are_those_of_gsl),
        cmocka_unit_test(special_matrices_have_eigenvectors),
        cmocka_unit_test(small_eigenvalues_keep_their_digits),
        cmocka_unit_test(inside_fluid_at_rest_spheres_stay_spheres),
        cmocka_unit_test(evenly_filled_space_keeps_the_volume),
        cmocka_unit_test(a_sheet_gives_flat_ellipsoids_across_its_normal),
        cmocka_unit_test(a_rotated_set_has_rotated_matrices_and_centres),
        cmocka_unit_test(a_cloud_has_the_sums_by_definition),
        cmocka_unit_test(few_neighbours_give_small_spheres),
        cmocka_unit_test(nothing_is_longer_than_k_max),
        cmocka_unit_test(degenerate_neighbourhoods_have_finite_shapes),
        cmocka_unit_test(lambda_moves_centres_and_nothing_else),
        cmocka_unit_test(the_bits_are_the_same_for_any_number_of_threads),
        cmocka_unit_test(what_cannot_be_computed_is_refused),
        cmocka_unit_test(a_dam_break_has_flat_ellipsoids_at_its_surface),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

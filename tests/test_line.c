/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_line.c: the fluid along a ray against sums over all particles and against closed forms. */
#include "experiments/truth/line.h"
#include "tests/truths.h"

#include <float.h>
#include <gsl/gsl_integration.h>

enum { MOST = 1000 };

static const double support = 0.0954; /* m */

static double centre[MOST][3]; /* m */
static double longest = 4;     /* of stretched kernels, over the shortest */

static void scatter(size_t n, double extent, uint64_t seed)
{
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) centre[i][k] = test_random(&seed, -extent, extent);
}

/* Kernels at centre[n], all of the weight 2.385. */
static ssfr_continuum fluid_of(size_t n, const ssfr_radial *radial)
{
    static const double origin[3] = {0, 0, 0};
    ssfr_continuum fluid;
    assert_int_equal(ssfr_continuum_init_kernels(&fluid, n, (const double(*)[3])centre, origin, radial, support, 2.385,
                                                 0.5),
                     SSFR_OK);
    return fluid;
}

/* Particles at centre + offset, taken for a continuum of this kind. */
static ssfr_continuum continuum_of(size_t n, ssfr_continuum_kind kind, int kernel, const double offset[3])
{
    ssfr_anisotropy_params anisotropy = ssfr_anisotropy_defaults();

    ssfr_particles *particles = NULL, given = {.radius = support / 4};
    ssfr_continuum_params params = {.kind = kind, .kernel = kernel, .level = 0.5, .support = 4, .size = 1.3};
    ssfr_continuum fluid;
    double *at = calloc(3 * n, sizeof *at);
    anisotropy.k_r = anisotropy.k_max = longest;
    assert_non_null(at);
    for (size_t i = 0; i < 3 * n; i++) at[i] = centre[i / 3][i % 3] + offset[i % 3];
    assert_int_equal(ssfr_particles_create(&particles, n, at, &given), SSFR_OK);
    assert_int_equal(ssfr_continuum_init(&fluid, particles, &params, &anisotropy), SSFR_OK);
    ssfr_particles_destroy(&particles);
    free(at);
    return fluid;
}

static const double nowhere[3] = {0, 0, 0};

/* What kernel i makes of a difference of places, in supports. */
static void stretch(const ssfr_continuum *fluid, size_t i, const long double d[3], long double out[3])
{
    static const double unit[6] = {1, 0, 0, 1, 0, 1};
    const double *m = fluid->inverse ? fluid->inverse[i] : unit;
    const long double h = (long double)fluid->support;
    out[0] = ((long double)m[0] * d[0] + (long double)m[1] * d[1] + (long double)m[2] * d[2]) / h;
    out[1] = ((long double)m[1] * d[0] + (long double)m[3] * d[1] + (long double)m[4] * d[2]) / h;
    out[2] = ((long double)m[2] * d[0] + (long double)m[4] * d[1] + (long double)m[5] * d[2]) / h;
}

static long double dot(const long double a[3], const long double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Distance of a place from kernel i, in supports. */
static double distance(const ssfr_continuum *fluid, size_t i, const long double at[3])
{
    long double d[3], v[3];
    for (int k = 0; k < 3; k++) d[k] = at[k] - (long double)fluid->centre[i][k];
    stretch(fluid, i, d, v);
    return (double)sqrtl(dot(v, v));
}

static double weight_of(const ssfr_continuum *fluid, size_t i)
{
    return fluid->weights ? fluid->weights[i] : fluid->weight;
}

static double sum_over_all(const ssfr_continuum *fluid, const ssfr_ray *ray, double t)
{
    long double at[3], sum = 0;
    for (int k = 0; k < 3; k++) at[k] = (long double)ray->origin[k] + (long double)t * (long double)ray->dir[k];
    for (size_t i = 0; i < fluid->n; i++) {
        const double q = distance(fluid, i, at);
        sum += (long double)(weight_of(fluid, i) * (fluid->radial ? ssfr_radial_value(fluid->radial, q) : q <= 1));
    }
    return (double)sum;
}

/* The ray in kernel i, in more digits than the line has. */
typedef struct course {
    long double enters, middle, leaves, near2, speed; /* speed: 1/m */
} course;

static bool kernel_along(const ssfr_continuum *fluid, size_t i, const ssfr_ray *ray, course *out)
{
    long double o[3], d[3], p[3], v[3];
    for (int k = 0; k < 3; k++) {
        o[k] = (long double)ray->origin[k] - (long double)fluid->centre[i][k];
        d[k] = (long double)ray->dir[k];
    }
    stretch(fluid, i, o, p);
    stretch(fluid, i, d, v);
    out->middle = -dot(p, v) / dot(v, v);
    for (int k = 0; k < 3; k++) p[k] += out->middle * v[k];
    out->near2 = dot(p, p);
    out->speed = sqrtl(dot(v, v));
    const long double half = sqrtl(fmaxl(1 - out->near2, 0)) / out->speed;
    out->enters = out->middle - half;
    out->leaves = out->middle + half;
    return out->near2 < 1;
}

/* ---- what is gathered -------------------------------------------------------------------------------------------- */

/* Those of all particles that the ray meets for longer than `digits`, and in order. */
static size_t check_gathered(const ssfr_line *line, double digits)
{
    static bool found[MOST];
    const ssfr_continuum *fluid = line->fluid;
    memset(found, 0, sizeof found);
    for (size_t i = 0; i < line->n; i++) {
        const ssfr_line_kernel *k = line->kernels + i, *before = i > 0 ? k - 1 : k;
        assert_true(before->enters < k->enters || (before->enters <= k->enters && before->index <= k->index));
        assert_false(found[k->index]);
        found[k->index] = true;
        assert_true(k->leaves > line->from && k->enters < line->to && k->near2 < 1);
        assert_true(k->leaves - k->enters <= line->longest);
        course exact;
        const bool met = kernel_along(fluid, k->index, &line->ray, &exact);
        assert_true(met || k->leaves - k->enters < digits);
        if (k->leaves - k->enters < digits) continue;
        assert_close(k->enters, (double)exact.enters, 1e-10, 1e-14);
        assert_close(k->leaves, (double)exact.leaves, 1e-10, 1e-14);
        assert_true(k->weight == weight_of(fluid, k->index));
        for (int c = 0; c < 3; c++)
            assert_close(k->aside[c], line->ray.origin[c] + k->middle * line->ray.dir[c] - fluid->centre[k->index][c],
                         1e-14, 1e-14);
    }
    for (size_t i = 0; i < fluid->n; i++) {
        course exact;
        if (found[i] || !kernel_along(fluid, i, &line->ray, &exact)) continue;
        const long double from = fmaxl(exact.enters, (long double)line->from);
        const long double to = fminl(exact.leaves, (long double)line->to);
        assert_true(to - from < (long double)digits);
    }
    return line->n;
}

static void a_line_gathers_what_the_ray_meets(void **state)
{
    (void)state;
    uint64_t seed = 11;
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        scatter(MOST, 0.4, 3);
        ssfr_continuum fluid = continuum_of(MOST, (ssfr_continuum_kind)kind, 0, nowhere);
        ssfr_line line;
        size_t n = 0;
        ssfr_line_init(&line, &fluid);
        for (int i = 0; i < 100; i++) {
            const ssfr_ray ray = test_truth_ray(&seed, 1);
            const double from = test_random(&seed, 0, 0.5), to = from + test_random(&seed, 0, 0.5);
            assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
            n += check_gathered(&line, 1e-6);
            assert_int_equal(ssfr_line_cast(&line, &ray, from, to), SSFR_OK);
            n += check_gathered(&line, 1e-6);
        }
        assert_true(n > 300);
        ssfr_line_finish(&line);
        assert_null(line.kernels);
        ssfr_continuum_finish(&fluid);
    }
}

/* Kernels that are entered at one place stand by their index, be they few or many. */
static void kernels_in_one_place_stand_in_the_order_of_their_index(void **state)
{
    (void)state;
    const ssfr_ray ray = {{-1, 0.01, 0}, {1, 0, 0}};
    ssfr_line line;
    memset(centre, 0, sizeof centre);
    for (size_t i = 500; i < MOST; i++) centre[i][0] = 1e-9 * (double)(i % 7); /* and a few more, and one far away */
    centre[MOST - 1][0] = 50;
    ssfr_continuum fluid = fluid_of(MOST, &ssfr_radials[0]);
    ssfr_line_init(&line, &fluid);
    assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
    assert_int_equal(check_gathered(&line, 1e-6), MOST);
    for (uint32_t i = 0; i < 500; i++) assert_int_equal(line.kernels[i].index, i);
    size_t n_breaks;
    const double *breaks;
    assert_int_equal(ssfr_line_breaks(&line, 0, 2, &n_breaks, &breaks), SSFR_OK);
    assert_int_equal(n_breaks, 2 + 5 * 7); /* seven places */
    for (size_t i = 1; i < n_breaks; i++) assert_true(breaks[i] > breaks[i - 1]);
    assert_close(ssfr_line_density(&line, 1), sum_over_all(&fluid, &ray, 1), 0, 1e-12);
    ssfr_line_finish(&line);
    ssfr_continuum_finish(&fluid);
}

static void a_line_through_nothing_is_empty(void **state)
{
    (void)state;
    const ssfr_ray past = {{-1, 5, 0}, {1, 0, 0}}, through = {{-1, 0, 0}, {1, 0, 0}};
    for (size_t n = 0; n < 2; n++) {
        size_t n_breaks;
        const double *breaks;
        double err = NAN;
        ssfr_line line;
        scatter(n, 0, 1);
        ssfr_continuum fluid = fluid_of(n, &ssfr_radials[0]);
        ssfr_line_init(&line, &fluid);
        assert_int_equal(ssfr_line_cast(&line, n ? &past : &through, 0, INFINITY), SSFR_OK);
        assert_int_equal(line.n, 0);
        assert_true(ssfr_line_density(&line, 1) == 0);
        assert_true(ssfr_line_chords(&line, 0, 2, &err) == 0);
        assert_true(err == 0);
        assert_int_equal(ssfr_line_breaks(&line, 0, 2.385, &n_breaks, &breaks), SSFR_OK);
        assert_int_equal(n_breaks, 2);
        assert_true(breaks[0] == 0 && breaks[1] == 2.385);
        ssfr_line_finish(&line);
        ssfr_continuum_finish(&fluid);
    }
}

/* ---- densities --------------------------------------------------------------------------------------------------- */

static void densities_are_sums_over_all_particles(void **state)
{
    (void)state;
    uint64_t seed = 12;
    scatter(MOST, 0.25, 4);
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++)
        for (int kernel = 0; kernel < SSFR_N_RADIALS; kernel++) {
            ssfr_continuum fluid = continuum_of(MOST, (ssfr_continuum_kind)kind, kernel, nowhere);
            ssfr_line line;
            double most = 0;
            ssfr_line_init(&line, &fluid);
            for (int i = 0; i < 20; i++) {
                const ssfr_ray ray = test_truth_ray(&seed, 0.5);
                assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
                for (int k = 0; k < 20; k++) {
                    const double t = test_random(&seed, 0, 1), density = ssfr_line_density(&line, t);
                    assert_close(density, sum_over_all(&fluid, &ray, t), 1e-13, 1e-12);
                    most = fmax(most, density);
                }
            }
            assert_true(most > 0.2);
            ssfr_line_finish(&line);
            ssfr_continuum_finish(&fluid);
        }
}

/* As far away as satellites are. */
static void a_far_eye_loses_few_digits(void **state)
{
    (void)state;
    const ssfr_ray ray = {{-1e6, 0.013, -0.02}, {1, 0, 0}};
    ssfr_line line;
    scatter(MOST, 0.25, 5);
    ssfr_continuum fluid = fluid_of(MOST, &ssfr_radials[0]);
    ssfr_line_init(&line, &fluid);
    assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
    assert_true(line.n > 20 && line.digits < 1e-8);
    for (double t = 1e6 - 0.25; t < 1e6 + 0.25; t += 0.013)
        assert_close(ssfr_line_density(&line, t), sum_over_all(&fluid, &ray, t), 1e-6, 0);
    ssfr_line_finish(&line);
    ssfr_continuum_finish(&fluid);
}

/* ---- chords ------------------------------------------------------------------------------------------------------ */

/* Muller's poly6: the integral of 315 / (64 pi) (H^2 - s^2)^3 between two places, H^2 = 1 - b^2. */
static long double poly6_between(long double near2, long double a, long double b)
{
    const long double h2 = 1 - near2, norm = 315 / (64 * acosl(-1));
    long double part[2];
    for (int i = 0; i < 2; i++) {
        const long double s = i ? b : a, s2 = s * s;
        part[i] = s * (h2 * h2 * h2 - s2 * (h2 * h2 - s2 * (3 * h2 / 5 - s2 / 7)));
    }
    return norm * (part[1] - part[0]);
}

static void one_kernel_collects_its_chord(void **state)
{
    (void)state;
    const ssfr_ray ray = {{-2, 0.03, 0.02}, {1, 0, 0}};
    const double near2 = (0.03 * 0.03 + 0.02 * 0.02) / (support * support), half = sqrt(1 - near2);
    double err;
    ssfr_line line;
    memset(centre, 0, sizeof centre);
    ssfr_continuum fluid = fluid_of(1, &ssfr_radials[1]);
    ssfr_line_init(&line, &fluid);
    assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
    const double whole = 2.385 * support * 315 / (64 * M_PI) * 32 / 35 * pow(half, 7);
    assert_close(ssfr_line_chords(&line, 0, 10, &err), whole, 0, 1e-13);
    assert_true(err > 0 && err < 1e-11 * whole);
    assert_close(ssfr_line_chords(&line, 0, 2, NULL), whole / 2, 0, 1e-13);
    assert_close(ssfr_line_chords(&line, 2, 10, NULL), whole / 2, 0, 1e-13);
    const double part = 2.385 * support * (double)poly6_between((long double)near2, -0.3L, 0.4L);
    assert_close(ssfr_line_chords(&line, 2 - 0.3 * support, 2 + 0.4 * support, NULL), part, 0, 1e-12);
    assert_true(ssfr_line_chords(&line, 3, 10, &err) == 0 && err == 0);
    assert_true(ssfr_line_chords(&line, 2.01, 2.01, &err) == 0);
    ssfr_line_finish(&line);
    ssfr_continuum_finish(&fluid);
}

/* Poly6 is a polynomial of degree 6 along a line: four points a piece give its integral. What the break points part is
 * smooth, and densities and chords are of one fluid. */
static double integrate_pieces(ssfr_line *line, double a, double b, gsl_integration_glfixed_table *rule, size_t *n)
{
    const double *breaks;
    double sum = 0;
    assert_int_equal(ssfr_line_breaks(line, a, b, n, &breaks), SSFR_OK);
    assert_true(breaks[0] == a && breaks[*n - 1] == b);
    for (size_t i = 1; i < *n; i++) {
        assert_true(breaks[i] > breaks[i - 1]);
        for (size_t k = 0; k < rule->n; k++) {
            double t, weight;
            gsl_integration_glfixed_point(breaks[i - 1], breaks[i], k, &t, &weight, rule);
            sum += weight * ssfr_line_density(line, t);
        }
    }
    return sum;
}

/* The cubic spline is of two pieces that meet half-way; poly6 of one. */
static void breaks_are_where_pieces_begin_and_end(void **state)
{
    (void)state;
    const ssfr_ray through = {{-2, 0, 0}, {1, 0, 0}}, aside = {{-2, 0.7 * support, 0}, {1, 0, 0}};
    const double h = support, edge = sqrt(1 - 0.7 * 0.7) * h;
    const ssfr_ray near[] = {{{-2, 0.199 * support, 0}, {1, 0, 0}}, {{-2, 0.201 * support, 0}, {1, 0, 0}}};
    const double seam[] = {sqrt(0.25 - 0.199 * 0.199) * h, sqrt(0.25 - 0.201 * 0.201) * h};
    const double rim[] = {sqrt(1 - 0.199 * 0.199) * h, sqrt(1 - 0.201 * 0.201) * h};
    const double two[] = {1, 2 - h, 2 - 0.5 * h, 2, 2 + 0.5 * h, 2 + h, 3}, one[] = {1, 2 - h, 2 + h, 3};
    const double sharp[] = {1, 2 - h, 2, 2 + h, 3};
    const double outer[] = {1, 2 - edge, 2 + edge, 3}, part[] = {2, 2 + 0.5 * h, 3};
    const double nearer[] = {1, 2 - rim[0], 2 - seam[0], 2, 2 + seam[0], 2 + rim[0], 3};
    const double farther[] = {1, 2 - rim[1], 2 - seam[1], 2 + seam[1], 2 + rim[1], 3};
    const struct {
        int kernel;
        const ssfr_ray *ray;
        size_t n;
        const double *breaks;
    } cases[] = {{0, &through, 7, two}, {1, &through, 4, one}, {0, &aside, 4, outer}, {0, &through, 3, part},
                 {2, &through, 5, sharp}, {0, &near[0], 7, nearer}, {0, &near[1], 6, farther}};
    memset(centre, 0, sizeof centre);
    for (size_t c = 0; c < SSFR_COUNT(cases); c++) {
        size_t n;
        const double *breaks, b = c == 3 ? 2 + 0.75 * h : 3;
        ssfr_line line;
        ssfr_continuum fluid = fluid_of(1, &ssfr_radials[cases[c].kernel]);
        ssfr_line_init(&line, &fluid);
        assert_int_equal(ssfr_line_cast(&line, cases[c].ray, 0, INFINITY), SSFR_OK);
        assert_int_equal(ssfr_line_breaks(&line, cases[c].breaks[0], b, &n, &breaks), SSFR_OK);
        assert_int_equal(n, cases[c].n);
        for (size_t i = 0; i + 1 < n; i++) assert_close(breaks[i], cases[c].breaks[i], 1e-14, 0);
        assert_true(breaks[n - 1] == b);
        ssfr_line_finish(&line);
        ssfr_continuum_finish(&fluid);
    }
}

static void chords_are_the_integral_of_the_density(void **state)
{
    (void)state;
    uint64_t seed = 13;
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(4);
    assert_non_null(rule);
    scatter(MOST, 0.25, 6);
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        ssfr_continuum fluid = continuum_of(MOST, (ssfr_continuum_kind)kind, 1, nowhere);
        ssfr_line line;
        ssfr_line_init(&line, &fluid);
        size_t n_all = 0;
        for (int i = 0; i < 30; i++) {
            const ssfr_ray ray = test_truth_ray(&seed, 0.5);
            const double a = i % 3 ? test_random(&seed, 0, 0.4) : 0, b = a + test_random(&seed, 0.1, 1);
            size_t n;
            assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
            assert_close(integrate_pieces(&line, a, b, rule, &n), ssfr_line_chords(&line, a, b, NULL), 1e-14, 1e-12);
            const double m = 0.5 * (a + b), first = ssfr_line_chords(&line, a, m, NULL);
            assert_close(first + ssfr_line_chords(&line, m, b, NULL), ssfr_line_chords(&line, a, b, NULL), 1e-14,
                         1e-12);
            n_all += n;
        }
        assert_true(n_all > 500);
        ssfr_line_finish(&line);
        ssfr_continuum_finish(&fluid);
    }
    gsl_integration_glfixed_table_free(rule);
}

/* All of it in long double. */
static long double exact_chords(const ssfr_continuum *fluid, const ssfr_ray *ray, double a, double b)
{
    long double sum = 0;
    for (size_t i = 0; i < fluid->n; i++) {
        course c;
        if (!kernel_along(fluid, i, ray, &c)) continue;
        const long double from = fmaxl(c.enters, (long double)a), to = fminl(c.leaves, (long double)b);
        const long double v = (long double)weight_of(fluid, i), per_m = c.speed;
        if (!(from < to)) continue;
        const long double poly6 = poly6_between(c.near2, (from - c.middle) * per_m, (to - c.middle) * per_m) / per_m;
        sum += fluid->radial ? v * poly6 : to - from;
    }
    return sum;
}

static void chords_lie_within_their_error(void **state)
{
    (void)state;
    static const double far[] = {0.5, 100, 1e5};
    static const ssfr_continuum_kind kinds[] = {SSFR_CONTINUUM_SPHERES, SSFR_CONTINUUM_DENSITY,
                                                SSFR_CONTINUUM_ANISOTROPIC};
    uint64_t seed = 14;
    longest = 100;
    scatter(MOST, 0.25, 7);
    for (size_t kind = 0; kind < SSFR_COUNT(kinds); kind++) {
        ssfr_continuum fluid = continuum_of(MOST, kinds[kind], 1, nowhere);
        for (size_t i = 0; i < 300; i++) {
            ssfr_line line;
            double err;
            ssfr_ray ray;
            for (int k = 0; k < 3; k++) ray.origin[k] = test_random(&seed, -1, 1) * far[i % 3];
            for (int k = 0; k < 3; k++) ray.dir[k] = test_random(&seed, -0.1, 0.1) - ray.origin[k];
            const double away = ssfr_normalize(ray.dir), a = away * test_random(&seed, 0.9, 1);
            ssfr_line_init(&line, &fluid);
            assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
            const double chords = ssfr_line_chords(&line, a, 2 * away, &err);
            assert_close(chords, (double)exact_chords(&fluid, &ray, a, 2 * away), err, 0);
            if (kinds[kind] == SSFR_CONTINUUM_DENSITY) assert_true(err < 1.5e-13 * fmax(1, away));
            ssfr_line_finish(&line);
        }
        ssfr_continuum_finish(&fluid);
    }
    longest = 4;
}

/* A needle, 1000 times as long as it is wide, along the ray: what rounding moves it aside is wide. Or across it, seen
 * from the fluid's origin, where nothing is long but the way to the needle's middle. */
static void check_needle(bool across, double *worst)
{
    uint64_t seed = 21;
    double weights[1] = {2.385}, inverse[1][6] = {{0}};
    memset(centre, 0, sizeof centre);
    for (int i = 0; i < 300; i++) {
        /* A^-1 = 1000 (1 - u u^T) + u u^T */
        double u[3], err;
        for (int k = 0; k < 3; k++) u[k] = test_random(&seed, -1, 1), centre[0][k] = test_random(&seed, -0.3, 0.3);
        ssfr_normalize(u);
        const double unit[6] = {1, 0, 0, 1, 0, 1};
        const double square[6] = {u[0] * u[0], u[0] * u[1], u[0] * u[2], u[1] * u[1], u[1] * u[2], u[2] * u[2]};
        for (int k = 0; k < 6; k++) inverse[0][k] = 1000 * (unit[k] - square[k]) + square[k];
        ssfr_continuum fluid = fluid_of(1, &ssfr_radials[1]);
        fluid.weights = weights, fluid.inverse = inverse;
        ssfr_ray ray = {{0}, {0}};
        if (across) {
            ssfr_cross(u, (const double[3]){0.6, 0, -0.8}, ray.dir);
            ssfr_normalize(ray.dir);
            double side[3];
            ssfr_cross(u, ray.dir, side);
            const double along = test_random(&seed, 0.1, 0.9) * support;
            const double aside = test_random(&seed, -3e-4, 3e-4) * support;
            for (int k = 0; k < 3; k++) fluid.centre[0][k] = along * u[k], ray.origin[k] = aside * side[k];
            ssfr_boxes_finish(&fluid.boxes);
            assert_int_equal(ssfr_boxes_init(&fluid.boxes, 1, (const double(*)[3])fluid.centre, NULL, support),
                             SSFR_OK);
        } else {
            memcpy(ray.dir, u, sizeof u);
            for (int k = 0; k < 3; k++)
                ray.origin[k] = centre[0][k] - 7 * u[k] + test_random(&seed, -3e-4, 3e-4) * support;
        }
        ssfr_line line;
        ssfr_line_init(&line, &fluid);
        assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
        const double chords = ssfr_line_chords(&line, 0, 20, &err);
        const double off = fabs(chords - (double)exact_chords(&fluid, &ray, 0, 20));
        assert_true(off <= err && err < 1e-8);
        if (err > 0) *worst = fmax(*worst, off / err);
        ssfr_line_finish(&line);
        fluid.weights = NULL, fluid.inverse = NULL;
        ssfr_continuum_finish(&fluid);
    }
}

static void chords_of_a_needle_lie_within_their_error(void **state)
{
    (void)state;
    for (int across = 0; across < 2; across++) {
        double worst = 0;
        check_needle(across, &worst);
        assert_true(worst > 1e-3);
    }
}

/* One kernel alone, whose errors no others hide: from afar, past its middle at any distance, whole or cut anywhere. */
static void the_chord_of_one_kernel_lies_within_its_error(void **state)
{
    (void)state;
    uint64_t seed = 22;
    double worst[2] = {0, 0};
    memset(centre, 0, sizeof centre);
    ssfr_continuum fluid = fluid_of(1, &ssfr_radials[1]);
    ssfr_line line;
    ssfr_line_init(&line, &fluid);
    for (int i = 0; i < 3000; i++) {
        const bool cut = i % 2;
        const double away = pow(10, 2 + i % 5), aside = i % 3 ? test_random(&seed, 0, 1) * support : 0;
        double side[3] = {test_random(&seed, -1, 1), test_random(&seed, -1, 1), test_random(&seed, -1, 1)}, err;
        ssfr_ray ray = {{0}, {0}};
        ssfr_cross(side, (const double[3]){0.6, 0, -0.8}, ray.dir);
        ssfr_normalize(ray.dir);
        ssfr_normalize(side);
        for (int k = 0; k < 3; k++) ray.origin[k] = aside * side[k] - away * ray.dir[k];
        assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
        const double a = cut ? away + test_random(&seed, -1, 1) * support : 0;
        const double chord = ssfr_line_chords(&line, a, 2 * away, &err);
        const double off = fabs(chord - (double)exact_chords(&fluid, &ray, a, 2 * away));
        assert_true(off <= err + 1e-300);
        if (line.n > 0) worst[cut] = fmax(worst[cut], off / err);
    }
    assert_true(worst[0] > 0.02 && worst[1] > 0.02);
    ssfr_line_finish(&line);
    ssfr_continuum_finish(&fluid);
}

/* 1.3 radii each; a ray through the middles of two that stand apart, and of two that overlap: chords add up. */
static void spheres_add_up_their_chords(void **state)
{
    (void)state;
    const double r = 1.3 * support / 4;
    for (int i = 0; i < 2; i++) {
        const double apart = i ? 1.5 * r : 5 * r;
        double err;
        ssfr_line line;
        memset(centre, 0, sizeof centre);
        centre[0][2] = 0.5 * apart, centre[1][2] = -0.5 * apart;
        ssfr_continuum fluid = continuum_of(2, SSFR_CONTINUUM_SPHERES, 0, nowhere);
        const ssfr_ray ray = {{0, 0, 2.385}, {0, 0, -1}}, touching = {{r, 0, 2.385}, {0, 0, -1}};
        ssfr_line_init(&line, &fluid);
        assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
        assert_int_equal(line.n, 2);
        assert_close(line.kernels[0].enters, 2.385 - 0.5 * apart - r, 0, 1e-8); /* positions are packed in floats */
        assert_close(ssfr_line_chords(&line, 0, 10, &err), 4 * r, 1e-14, 0);
        assert_true(err < 1e-13);
        assert_true(ssfr_line_density(&line, 2.385) == (i ? 2 : 0));
        assert_true(ssfr_line_density(&line, 2.385 - 0.5 * apart) == 1);
        assert_int_equal(ssfr_line_cast(&line, &touching, 0, INFINITY), SSFR_OK);
        const double grazed = ssfr_line_chords(&line, 0, 10, &err);
        assert_true(grazed <= err && err > 1e-10 && err < 1e-7);
        ssfr_line_finish(&line);
        ssfr_continuum_finish(&fluid);
    }
}

/* ---- elsewhere --------------------------------------------------------------------------------------------------- */

static void a_scene_moved_a_million_metres_is_the_same(void **state)
{
    (void)state;
    const double far[3] = {1e6, -2e6, 1e6};
    uint64_t seed = 15;
    scatter(MOST, 0.25, 8);
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        ssfr_continuum here = continuum_of(MOST, (ssfr_continuum_kind)kind, 0, nowhere);
        ssfr_continuum there = continuum_of(MOST, (ssfr_continuum_kind)kind, 0, far);
        ssfr_line line[2];
        ssfr_line_init(&line[0], &here), ssfr_line_init(&line[1], &there);
        for (int i = 0; i < 50; i++) {
            ssfr_ray ray = test_truth_ray(&seed, 0.5);
            double chords[2];
            for (int k = 0; k < 2; k++) {
                const ssfr_continuum *fluid = k ? &there : &here;
                ssfr_ray own = ray;
                for (int c = 0; c < 3; c++) own.origin[c] = (ray.origin[c] + (k ? far[c] : 0)) - fluid->origin[c];
                assert_int_equal(ssfr_line_cast(&line[k], &own, 0, INFINITY), SSFR_OK);
                chords[k] = ssfr_line_chords(&line[k], 0, 2, NULL);
            }
            assert_close(chords[1], chords[0], 1e-6, 1e-6);
        }
        ssfr_line_finish(&line[0]), ssfr_line_finish(&line[1]);
        ssfr_continuum_finish(&here), ssfr_continuum_finish(&there);
    }
}

static void a_line_used_again_gives_the_same_bits(void **state)
{
    (void)state;
    uint64_t seed = 16;
    scatter(MOST, 0.25, 9);
    ssfr_continuum fluid = continuum_of(MOST, SSFR_CONTINUUM_DENSITY, 0, nowhere);
    ssfr_line used, fresh;
    ssfr_line_init(&used, &fluid);
    for (int i = 0; i < 50; i++) {
        const ssfr_ray ray = test_truth_ray(&seed, 0.5);
        ssfr_line_init(&fresh, &fluid);
        assert_int_equal(ssfr_line_cast(&used, &ray, 0, INFINITY), SSFR_OK);
        assert_int_equal(ssfr_line_cast(&fresh, &ray, 0, INFINITY), SSFR_OK);
        assert_int_equal(used.n, fresh.n);
        if (used.n > 0) assert_memory_equal(used.kernels, fresh.kernels, used.n * sizeof *used.kernels);
        assert_true(ssfr_line_chords(&used, 0, 2, NULL) == ssfr_line_chords(&fresh, 0, 2, NULL));
        ssfr_line_finish(&fresh);
    }
    ssfr_line_finish(&used);
    ssfr_continuum_finish(&fluid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_gathers_what_the_ray_meets),
        cmocka_unit_test(kernels_in_one_place_stand_in_the_order_of_their_index),
        cmocka_unit_test(a_line_through_nothing_is_empty),
        cmocka_unit_test(densities_are_sums_over_all_particles),
        cmocka_unit_test(a_far_eye_loses_few_digits),
        cmocka_unit_test(one_kernel_collects_its_chord),
        cmocka_unit_test(breaks_are_where_pieces_begin_and_end),
        cmocka_unit_test(chords_are_the_integral_of_the_density),
        cmocka_unit_test(chords_lie_within_their_error),
        cmocka_unit_test(chords_of_a_needle_lie_within_their_error),
        cmocka_unit_test(the_chord_of_one_kernel_lies_within_its_error),
        cmocka_unit_test(spheres_add_up_their_chords),
        cmocka_unit_test(a_scene_moved_a_million_metres_is_the_same),
        cmocka_unit_test(a_line_used_again_gives_the_same_bits),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

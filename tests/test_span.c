/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_span.c: bounds of the field along a ray hold every value and slope of it, computed in more digits. */
#include "experiments/truth/span.h"
#include "tests/util.h"

enum { MOST = 60 };

typedef long double real;

static const double support = 0.4; /* m */

static const size_t sizes[] = {1, 2, MOST}; /* of clouds: bounds of few kernels are the tightest */

static double centre[MOST][3], weights[MOST], inverse[MOST][6];

static real dot(const real a[3], const real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A cloud that rays cross here and there; its kernels are stretched twice to twenty times if it is anisotropic. */
static ssfr_continuum make_cloud(ssfr_continuum_kind kind, size_t n, const ssfr_radial *radial, uint64_t *seed)
{
    static const double origin[3] = {0, 0, 0};
    ssfr_continuum fluid;
    for (size_t i = 0; i < n; i++) {
        double u[3];
        const double extent = n > 9 ? 0.6 : 0.1;
        for (int k = 0; k < 3; k++) centre[i][k] = test_random(seed, -extent, extent), u[k] = test_random(seed, -1, 1);
        ssfr_normalize(u);
        const double thin = test_random(seed, 2, 20), wide = 1;
        for (int j = 0, m = 0; j < 3; j++)
            for (int k = j; k < 3; k++, m++)
                inverse[i][m] = thin * u[j] * u[k] + wide * ((j == k) - u[j] * u[k]);
        weights[i] = test_random(seed, 0.5, 2.385);
    }
    assert_int_equal(ssfr_continuum_init_kernels(&fluid, n, (const double(*)[3])centre, origin, radial, support, 0.7,
                                                 0.385), SSFR_OK);
    fluid.kind = kind;
    fluid.radius = 0.385 * support;
    if (kind == SSFR_CONTINUUM_ANISOTROPIC) fluid.weights = weights, fluid.inverse = inverse;
    return fluid;
}

static void finish_cloud(ssfr_continuum *fluid)
{
    fluid->weights = NULL, fluid->inverse = NULL;
    ssfr_continuum_finish(fluid);
}

static real slope_of(const ssfr_radial *radial, real q)
{
    return -(real)ssfr_radial_steepness(radial, (double)q) * q;
}

/* The field as the header has it, and its gradient. */
static real density_field(const ssfr_continuum *fluid, const real at[3], real gradient[3])
{
    static const double unit[6] = {1, 0, 0, 1, 0, 1};
    const real h = (real)fluid->support;
    real sum = -(real)fluid->level;
    for (int k = 0; k < 3; k++) gradient[k] = 0;
    for (size_t i = 0; i < fluid->n; i++) {
        const double *a = fluid->inverse ? fluid->inverse[i] : unit;
        const real weight = (real)(fluid->weights ? fluid->weights[i] : fluid->weight);
        const real m[3][3] = {{(real)a[0], (real)a[1], (real)a[2]}, {(real)a[1], (real)a[3], (real)a[4]},
                              {(real)a[2], (real)a[4], (real)a[5]}};
        real d[3], v[3];
        for (int k = 0; k < 3; k++) d[k] = at[k] - (real)fluid->centre[i][k];
        for (int k = 0; k < 3; k++) v[k] = dot(m[k], d) / h;
        const real q = sqrtl(dot(v, v));
        if (q >= 1 || q <= 0) continue;
        /* Kernels give doubles: the rest by their slope. */
        sum += weight * ((real)ssfr_radial_value(fluid->radial, (double)q) +
                         slope_of(fluid->radial, q) * (q - (real)(double)q));
        for (int k = 0; k < 3; k++) gradient[k] += weight * slope_of(fluid->radial, q) / q * dot(m[k], v) / h;
    }
    return sum;
}

static real mean_field(const ssfr_continuum *fluid, const real at[3], real gradient[3])
{
    const real h2 = (real)fluid->support * (real)fluid->support, r2 = (real)fluid->radius * (real)fluid->radius;
    real weight = 0, s[3] = {0}, slope[3] = {0}, turn[3][3] = {{0}};
    for (size_t i = 0; i < fluid->n; i++) {
        real d[3];
        for (int k = 0; k < 3; k++) d[k] = at[k] - (real)fluid->centre[i][k];
        const real y = 1 - dot(d, d) / h2;
        if (y <= 0) continue;
        weight += y * y * y;
        for (int k = 0; k < 3; k++) {
            s[k] += y * y * y * d[k];
            slope[k] -= 6 * y * y * d[k] / h2;
            turn[k][k] += y * y * y;
            for (int b = 0; b < 3; b++) turn[k][b] -= 6 * y * y * d[b] * d[k] / h2;
        }
    }
    for (int b = 0; b < 3; b++)
        gradient[b] = 2 * r2 * weight * slope[b] - 2 * (s[0] * turn[0][b] + s[1] * turn[1][b] + s[2] * turn[2][b]);
    return r2 * weight * weight - dot(s, s);
}

static real field(const ssfr_span *span, real t, real gradient[3])
{
    const ssfr_ray *ray = &span->line->ray;
    const ssfr_continuum *fluid = span->line->fluid;
    real at[3];
    for (int k = 0; k < 3; k++) at[k] = (real)ray->origin[k] + t * (real)ray->dir[k];
    return fluid->kind == SSFR_CONTINUUM_ZHU_BRIDSON ? mean_field(fluid, at, gradient)
                                                     : density_field(fluid, at, gradient);
}

static real slope_along(const ssfr_span *span, const real gradient[3])
{
    const double *dir = span->line->ray.dir;
    return gradient[0] * (real)dir[0] + gradient[1] * (real)dir[1] + gradient[2] * (real)dir[2];
}

/* ------------------------------------------------------------------------------------------------------------------ */

static void check_bounds(ssfr_span *span, double a, double b)
{
    const ssfr_span_bounds bounds = ssfr_span_bound(span, a, b);
    const int side = ssfr_span_side(span, a, b);
    real gradient[3];
    assert_true(bounds.lo <= bounds.hi && bounds.slope_lo <= bounds.slope_hi && bounds.err >= 0);
    for (int i = 0; i <= 20; i++) {
        const real value = field(span, (real)a + ((real)b - (real)a) * i / 20, gradient);
        const real slope = slope_along(span, gradient);
        assert_true(value >= (real)bounds.lo && value <= (real)bounds.hi);
        assert_true(slope >= (real)bounds.slope_lo && slope <= (real)bounds.slope_hi);
        assert_true(side == 0 || (side > 0) == (value > 0));
    }
}

/* How sure the bound is, of what rounding did: 1 when it is as large. */
static double check_value(ssfr_span *span, double t)
{
    const ssfr_span_value at = ssfr_span_at(span, t);
    const int side = ssfr_span_side_at(span, t);
    real gradient[3];
    const real value = field(span, (real)t, gradient), off = fabsl((real)at.value - value);
    assert_true(off <= (real)at.err);
    assert_true(side == 0 || (side > 0) == (value > 0));
    return (double)(off / (real)at.err);
}

/* All that is within t_err of t has a normal within the bound. */
static void check_normal(const ssfr_span *line_span, double t, double t_err)
{
    ssfr_span *span = (ssfr_span *)line_span;
    double normal[3], err;
    ssfr_span_normal(span, t, t_err, normal, &err);
    for (int i = -2; i <= 2; i++) {
        real gradient[3], cosine = 0, away = 0;
        field(span, (real)t + (real)t_err * i / 2, gradient);
        const real length = sqrtl(dot(gradient, gradient));
        for (int k = 0; k < 3; k++) cosine -= gradient[k] / length * (real)normal[k];
        for (int k = 0; k < 3; k++) {
            const real one = gradient[k] / length + cosine * (real)normal[k];
            away += one * one;
        }
        assert_true(atan2l(sqrtl(away), cosine) <= (real)err * (1 + 1e-15L));
    }
}

/* A ray through the cloud, from so far away; t where it is nearest to the middle. */
static ssfr_ray random_ray(uint64_t *seed, double away)
{
    ssfr_ray ray;
    for (int k = 0; k < 3; k++) ray.dir[k] = test_random(seed, -1, 1);
    ssfr_normalize(ray.dir);
    for (int k = 0; k < 3; k++) ray.origin[k] = test_random(seed, -0.3, 0.3) - away * ray.dir[k];
    return ray;
}

static void check_cloud(ssfr_continuum_kind kind, size_t n, const ssfr_radial *radial, double away, double *sure)
{
    static const double lengths[] = {0.3, 0.05, 1e-3, 1e-6};
    uint64_t seed = 2385 + (uint64_t)kind;
    ssfr_continuum fluid = make_cloud(kind, n, radial, &seed);
    ssfr_line line;
    ssfr_span span;
    ssfr_line_init(&line, &fluid);
    ssfr_span_init(&span);
    for (int i = 0; i < 40; i++) {
        const ssfr_ray ray = random_ray(&seed, away);
        assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
        ssfr_span_begin(&span, &line);
        double a = away - 0.9;
        for (int j = 0; j < 12; j++, a += 0.13) {
            const double length = lengths[(i + j) % 4] * support, b = a + length;
            assert_int_equal(ssfr_span_move(&span, a, b), SSFR_OK);
            check_bounds(&span, a, b);
            *sure = fmax(*sure, check_value(&span, a));
            /* Out of the fluid points the normal of any place, but bounds are those of the surface and inside. */
            if (ssfr_span_side_at(&span, a) > 0) check_normal(&span, a, fmin(length, 1e-3 * support));
        }
    }
    ssfr_span_finish(&span);
    ssfr_line_finish(&line);
    finish_cloud(&fluid);
}

static void bounds_hold_the_field_and_its_slope(void **state)
{
    (void)state;
    for (int kind = SSFR_CONTINUUM_DENSITY; kind < SSFR_N_CONTINUA; kind++)
        for (int kernel = 0; kernel < SSFR_N_RADIALS; kernel++) {
            double sure = 0;
            for (size_t i = 0; i < SSFR_COUNT(sizes); i++)
                check_cloud((ssfr_continuum_kind)kind, sizes[i], &ssfr_radials[kernel], 2, &sure);
        }
}

/* So far away rounding moves the ray by more than all else that it does. */
static void bounds_hold_what_rounding_does(void **state)
{
    (void)state;
    for (int kind = SSFR_CONTINUUM_DENSITY; kind < SSFR_N_CONTINUA; kind++) {
        double sure = 0;
        for (double away = 1e3; away < 1e10; away *= 1e3)
            for (size_t i = 0; i < SSFR_COUNT(sizes); i++)
                check_cloud((ssfr_continuum_kind)kind, sizes[i], &ssfr_radials[1], away, &sure);
        assert_true(sure > 0.01);
    }
}

static void an_empty_span_is_outside(void **state)
{
    (void)state;
    for (int kind = SSFR_CONTINUUM_DENSITY; kind < SSFR_N_CONTINUA; kind++) {
        uint64_t seed = 7;
        ssfr_continuum fluid = make_cloud((ssfr_continuum_kind)kind, MOST, &ssfr_radials[0], &seed);
        const ssfr_ray ray = {{0, 0, -5}, {0, 0, 1}};
        ssfr_line line;
        ssfr_span span;
        ssfr_line_init(&line, &fluid);
        ssfr_span_init(&span);
        assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
        ssfr_span_begin(&span, &line);
        assert_int_equal(ssfr_span_move(&span, 0, 1), SSFR_OK);
        assert_int_equal(span.n, 0);
        assert_int_equal(ssfr_span_side(&span, 0, 1), -1);
        assert_true(ssfr_span_next(&span) == line.kernels[0].enters);
        assert_int_equal(ssfr_span_move(&span, 1, 100), SSFR_OK);
        assert_int_equal(span.n, line.n);
        assert_true(isinf(ssfr_span_next(&span)));
        ssfr_span_finish(&span);
        ssfr_line_finish(&line);
        finish_cloud(&fluid);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_hold_the_field_and_its_slope),
        cmocka_unit_test(bounds_hold_what_rounding_does),
        cmocka_unit_test(an_empty_span_is_outside),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

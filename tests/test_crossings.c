/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_crossings.c: crossings of a ray with the surface against closed forms, and against dense sampling of the fields
 * as their papers write them, in more digits. Errors that are stated are held to be bounds. */
#include "experiments/truth/crossings.h"
#include "tests/counted_memory.h"
#include "tests/truths.h"

#include <float.h>
#include <gsl/gsl_poly.h>

enum { MOST = 2000 };

static const double radius = 0.02385; /* m, of particles */

static double centre[MOST][3]; /* m */

static void scatter(size_t n, double extent, uint64_t *seed)
{
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) centre[i][k] = test_random(seed, -extent, extent);
}

/* Particles at centre + offset, taken for a continuum. */
static ssfr_continuum continuum_of(size_t n, const ssfr_continuum_params *params, const double offset[3])
{
    ssfr_particles *particles = NULL, given = {.radius = radius};
    ssfr_continuum fluid;
    double *at = calloc(3 * n + 1, sizeof *at);
    assert_non_null(at);
    for (size_t i = 0; i < 3 * n; i++) at[i] = centre[i / 3][i % 3] + offset[i % 3];
    assert_int_equal(ssfr_particles_create(&particles, n, at, &given), SSFR_OK);
    assert_int_equal(ssfr_continuum_init(&fluid, particles, params, NULL), SSFR_OK);
    ssfr_particles_destroy(&particles);
    free(at);
    return fluid;
}

static const double nowhere[3] = {0, 0, 0};

static ssfr_continuum fluid_of(size_t n, ssfr_continuum_kind kind, int kernel)
{
    const ssfr_continuum_params params = {.kind = kind, .kernel = kernel, .level = 0.2385, .support = 4, .size = 1.385};
    return continuum_of(n, &params, nowhere);
}

/* Kernels at centre[n]; support 1 m. */
static ssfr_continuum kernels_of(size_t n, const ssfr_radial *radial, double weight, double level)
{
    ssfr_continuum fluid;
    assert_int_equal(
        ssfr_continuum_init_kernels(&fluid, n, (const double(*)[3])centre, nowhere, radial, 1, weight, level), SSFR_OK);
    return fluid;
}

typedef struct caster {
    ssfr_line line;
    ssfr_crossings crossings;
} caster;

static void begin(caster *c, const ssfr_continuum *fluid)
{
    ssfr_line_init(&c->line, fluid);
    assert_int_equal(ssfr_crossings_init(&c->crossings), SSFR_OK);
}

static void finish(caster *c)
{
    ssfr_crossings_finish(&c->crossings);
    ssfr_line_finish(&c->line);
}

static const ssfr_crossings *find(caster *c, const ssfr_ray *ray, double from, double to)
{
    assert_int_equal(ssfr_line_cast(&c->line, ray, from, to), SSFR_OK);
    assert_int_equal(ssfr_crossings_find(&c->crossings, &c->line), SSFR_OK);
    return &c->crossings;
}

static bool find_first(caster *c, const ssfr_ray *ray, double to, bool inside, ssfr_crossing *out)
{
    bool found;
    assert_int_equal(ssfr_crossings_first(&c->crossings, &c->line, ray, to, inside, out, &found), SSFR_OK);
    return found;
}

/* ---- the fields as the papers write them, in more digits --------------------------------------------------------- */

typedef long double real;

static real dot(const real a[3], const real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static const real pi = 3.14159265358979323846264338327950288L;

/* w and -w' / q. */
static real kernel_at(int kernel, real q, real *steepness)
{
    const real u = 2 * q;
    *steepness = 0;
    if (q >= 1) return 0;
    switch (kernel) {
    case 0:
        *steepness = 8 / pi * (u < 1 ? 12 - 9 * u : 1.5L * (2 - u) * (2 - u) / q);
        return 8 / pi * (u < 1 ? 1 - 1.5L * u * u + 0.75L * u * u * u : 0.25L * (2 - u) * (2 - u) * (2 - u));
    case 1:
        *steepness = 315 / (64 * pi) * 6 * (1 - q * q) * (1 - q * q);
        return 315 / (64 * pi) * (1 - q * q) * (1 - q * q) * (1 - q * q);
    default:
        *steepness = 21 / (2 * pi) * 20 * (1 - q) * (1 - q) * (1 - q);
        return 21 / (2 * pi) * (1 - q) * (1 - q) * (1 - q) * (1 - q) * (1 + 4 * q);
    }
}

/* Positive inside; its gradient with respect to the place may be NULL. */
static real density_field(const ssfr_continuum *fluid, const real at[3], real gradient[3])
{
    static const double unit[6] = {1, 0, 0, 1, 0, 1};
    const int kernel = (int)(fluid->radial - ssfr_radials);
    const real h = (real)fluid->support;
    real sum = 0;
    for (int k = 0; gradient && k < 3; k++) gradient[k] = 0;
    for (size_t i = 0; i < fluid->n; i++) {
        const double *m = fluid->inverse ? fluid->inverse[i] : unit;
        const real weight = (real)(fluid->weights ? fluid->weights[i] : fluid->weight);
        real d[3], v[3], g[3], steepness;
        for (int k = 0; k < 3; k++) d[k] = at[k] - (real)fluid->centre[i][k];
        v[0] = ((real)m[0] * d[0] + (real)m[1] * d[1] + (real)m[2] * d[2]) / h;
        v[1] = ((real)m[1] * d[0] + (real)m[3] * d[1] + (real)m[4] * d[2]) / h;
        v[2] = ((real)m[2] * d[0] + (real)m[4] * d[1] + (real)m[5] * d[2]) / h;
        sum += weight * kernel_at(kernel, sqrtl(dot(v, v)), &steepness);
        if (!gradient || steepness <= 0) continue;
        g[0] = ((real)m[0] * v[0] + (real)m[1] * v[1] + (real)m[2] * v[2]) / h;
        g[1] = ((real)m[1] * v[0] + (real)m[3] * v[1] + (real)m[4] * v[2]) / h;
        g[2] = ((real)m[2] * v[0] + (real)m[4] * v[1] + (real)m[5] * v[2]) / h;
        for (int k = 0; k < 3; k++) gradient[k] -= weight * steepness * g[k];
    }
    return sum - (real)fluid->level;
}

/* r - |x - xm|, or -1 where no particle weighs: the textbook's form, with its gradient by the quotient rule. */
static real mean_field(const ssfr_continuum *fluid, const real at[3], real gradient[3])
{
    const real h2 = (real)fluid->support * (real)fluid->support;
    real total = 0, mean[3] = {0}, slope[3] = {0}, turn[3][3] = {{0}};
    for (size_t i = 0; i < fluid->n; i++) {
        real d[3], centre_of[3];
        for (int k = 0; k < 3; k++) centre_of[k] = (real)fluid->centre[i][k], d[k] = at[k] - centre_of[k];
        const real y = 1 - dot(d, d) / h2;
        if (y <= 0) continue;
        total += y * y * y;
        for (int k = 0; k < 3; k++) mean[k] += y * y * y * centre_of[k];
        for (int k = 0; k < 3; k++) slope[k] -= 6 * y * y * d[k] / h2;
        for (int k = 0; k < 3; k++)
            for (int b = 0; b < 3; b++) turn[k][b] -= 6 * y * y * d[b] / h2 * centre_of[k];
    }
    if (total <= 0) return -1;
    real off[3];
    for (int k = 0; k < 3; k++) off[k] = at[k] - mean[k] / total;
    const real length = sqrtl(dot(off, off));
    for (int b = 0; gradient && b < 3; b++) {
        gradient[b] = -off[b] / length;
        for (int k = 0; k < 3; k++)
            gradient[b] += off[k] / length * (turn[k][b] * total - mean[k] * slope[b]) / (total * total);
    }
    return (real)fluid->radius - length;
}

static real sphere_field(const ssfr_continuum *fluid, const real at[3], real gradient[3])
{
    real most = -INFINITY;
    for (size_t i = 0; i < fluid->n; i++) {
        real d[3];
        for (int k = 0; k < 3; k++) d[k] = at[k] - (real)fluid->centre[i][k];
        const real length = sqrtl(dot(d, d)), depth = (real)fluid->support - length;
        if (depth < most) continue;
        most = depth;
        for (int k = 0; gradient && k < 3; k++) gradient[k] = -d[k] / length;
    }
    return most;
}

static real field(const ssfr_continuum *fluid, const ssfr_ray *ray, real t, real gradient[3])
{
    real at[3];
    for (int k = 0; k < 3; k++) at[k] = (real)ray->origin[k] + t * (real)ray->dir[k];
    switch (fluid->kind) {
    case SSFR_CONTINUUM_SPHERES: return sphere_field(fluid, at, gradient);
    case SSFR_CONTINUUM_ZHU_BRIDSON: return mean_field(fluid, at, gradient);
    default: return density_field(fluid, at, gradient);
    }
}

/* ---- what must hold of every answer ------------------------------------------------------------------------------ */

/* The true root lies within the stated error, and the true normal there. */
static void check_crossing(const ssfr_continuum *fluid, const ssfr_ray *ray, const ssfr_crossing *c)
{
    const real sign = c->enters ? 1 : -1;
    real lo = (real)c->t - (real)c->t_err, hi = (real)c->t + (real)c->t_err, gradient[3], cosine = 0, away[3];
    assert_true(c->t_err > 0 && isfinite(c->t_err) && isfinite(c->t) && c->normal_err > 0);
    assert_true(sign * field(fluid, ray, lo, NULL) <= 0);
    assert_true(sign * field(fluid, ray, hi, NULL) >= 0);
    for (int i = 0; i < 80; i++) {
        const real middle = (lo + hi) / 2;
        *(sign * field(fluid, ray, middle, NULL) < 0 ? &lo : &hi) = middle;
    }
    field(fluid, ray, (lo + hi) / 2, gradient);
    const real length = sqrtl(dot(gradient, gradient));
    for (int k = 0; k < 3; k++) cosine -= gradient[k] / length * (real)c->normal[k];
    for (int k = 0; k < 3; k++) away[k] = gradient[k] / length + cosine * (real)c->normal[k];
    const real angle = atan2l(sqrtl(dot(away, away)), cosine);
    assert_true(angle <= (real)c->normal_err);
    assert_close(sqrt(ssfr_dot(c->normal, c->normal)), 1, 4e-16, 0);
}

/* The worst that was stated of many. */
typedef struct worst {
    size_t n;
    double t_err, normal_err;
} worst;

/* Every answer is alternating, and between its crossings every sample has the side that it says. */
static void check_line(const ssfr_continuum *fluid, const ssfr_ray *ray, double from, double to, size_t n_samples,
                       const ssfr_crossings *c, worst *w)
{
    size_t next = 0;
    bool inside = c->begins_inside;
    for (size_t i = 0; i < c->n; i++) {
        assert_true(c->items[i].enters != (i % 2 == 0 ? inside : !inside));
        assert_true(c->items[i].t >= from - c->items[i].t_err && c->items[i].t <= to + c->items[i].t_err);
        if (i > 0) assert_true(c->items[i].t >= c->items[i - 1].t);
        check_crossing(fluid, ray, &c->items[i]);
        w->t_err = fmax(w->t_err, c->items[i].t_err);
        w->normal_err = fmax(w->normal_err, c->items[i].normal_err);
        w->n++;
    }
    for (size_t i = 0; i <= n_samples; i++) {
        const double t = from + (to - from) * (double)i / (double)n_samples;
        while (next < c->n && c->items[next].t < t) inside = c->items[next++].enters;
        bool near = false;
        for (size_t j = next > 0 ? next - 1 : 0; j < c->n && j <= next; j++)
            if (fabs(c->items[j].t - t) <= c->items[j].t_err) near = true;
        if (!near) assert_int_equal(field(fluid, ray, (real)t, NULL) > 0, inside);
    }
}

/* Rays through clouds that are dense, loose, or touch each other here and there. */
static worst check_clouds(ssfr_continuum_kind kind, int kernel, size_t n_rays, size_t n_samples)
{
    static const struct cloud {
        size_t n;
        double extent; /* in particle radii */
    } clouds[] = {{1, 1}, {2, 1.5}, {7, 3}, {40, 4}, {120, 12}, {300, 9}};
    uint64_t seed = 2385 + (uint64_t)kind * 10 + (uint64_t)kernel;
    worst w = {0};
    for (size_t i = 0; i < SSFR_COUNT(clouds); i++) {
        const double extent = clouds[i].extent * radius;
        caster c;
        scatter(clouds[i].n, extent, &seed);
        ssfr_continuum fluid = fluid_of(clouds[i].n, kind, kernel);
        begin(&c, &fluid);
        for (size_t j = 0; j < n_rays; j++) {
            const ssfr_ray ray = test_truth_ray(&seed, extent + 6 * radius);
            const double from = j % 3 == 0 ? test_random(&seed, 0, extent) : 0, to = from + 3 * extent + 10 * radius;
            const ssfr_crossings *found = find(&c, &ray, from, to);
            assert_int_equal(found->n_touches, 0);
            assert_true(isinf(found->touch) && !(found->touched > 0));
            check_line(&fluid, &ray, from, to, n_samples, found, &w);
        }
        finish(&c);
        ssfr_continuum_finish(&fluid);
    }
    return w;
}

/* ---- closed forms ------------------------------------------------------------------------------------------------ */

static ssfr_continuum ball_at(double x, double y, double z)
{
    const ssfr_continuum_params params = {.kind = SSFR_CONTINUUM_SPHERES, .level = 0.5, .support = 4, .size = 1};
    centre[0][0] = x, centre[0][1] = y, centre[0][2] = z;
    return continuum_of(1, &params, nowhere);
}

static void a_sphere_has_the_depth_normal_and_chord_of_the_closed_form(void **state)
{
    (void)state;
    ssfr_continuum fluid = ball_at(0, 0, 0);
    uint64_t seed = 17;
    caster c;
    begin(&c, &fluid);
    for (int i = 0; i < 300; i++) {
        const double share = test_random(&seed, 0, 0.999), b = share * radius, half = sqrt((radius - b) * (radius + b));
        const ssfr_ray ray = {{b, 0.3, 0}, {0, -1, 0}};
        const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
        assert_int_equal(found->n, 2);
        assert_false(found->begins_inside);
        assert_true(found->items[0].enters && !found->items[1].enters);
        assert_close(found->items[0].t, 0.3 - half, 1e-14, 0);
        assert_close(found->items[1].t - found->items[0].t, 2 * half, 2e-14, 0);
        for (int j = 0; j < 2; j++) {
            const ssfr_crossing *x = found->items + j;
            const double y = (j == 0 ? half : -half) / radius;
            assert_close(x->normal[0], share, 1e-13 + x->normal_err, 0);
            assert_close(x->normal[1], y, 1e-13 + x->normal_err, 0);
            assert_close(x->normal[2], 0, 1e-13, 0);
            assert_true(fabs(x->t - (0.3 + (j == 0 ? -half : half))) <= x->t_err + DBL_EPSILON);
            assert_true(x->t_err < 2e-13 && x->normal_err < 1e-11);
        }
    }
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

static void two_disjoint_spheres_give_four_crossings_and_two_lengths(void **state)
{
    (void)state;
    const ssfr_continuum_params params = {.kind = SSFR_CONTINUUM_SPHERES, .level = 0.5, .support = 4, .size = 1};
    memcpy(centre, (double[2][3]){{0, 0, 0}, {0, 0.5 * radius, 5 * radius}}, sizeof(double[2][3]));
    ssfr_continuum fluid = continuum_of(2, &params, nowhere);
    const double y = fluid.centre[0][1], across = fluid.centre[1][1] - y;
    const ssfr_ray ray = {{fluid.centre[0][0], y, -1}, {0, 0, 1}};
    caster c;
    begin(&c, &fluid);
    const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
    assert_int_equal(found->n, 4);
    assert_int_equal(found->n_touches, 0);
    assert_close(found->items[1].t - found->items[0].t, 2 * radius, 1e-14, 0);
    assert_close(found->items[3].t - found->items[2].t, 2 * sqrt(radius * radius - across * across), 1e-14, 0);
    assert_true(found->items[2].enters && !found->items[3].enters);
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

static void spheres_that_overlap_are_one_body_and_those_that_just_touch_are_a_touch(void **state)
{
    (void)state;
    static const struct pair {
        double apart; /* in radii */
        size_t n, n_touches;
    } pairs[] = {{1.9, 2, 0}, {2 - 1e-6, 2, 0}, {2, 2, 1}, {2 + 4 * DBL_EPSILON, 2, 1}, {2 + 1e-6, 4, 0}};
    for (size_t i = 0; i < SSFR_COUNT(pairs); i++) {
        memcpy(centre, (double[2][3]){{0, 0, 0}, {0, 0, pairs[i].apart}}, sizeof(double[2][3]));
        ssfr_continuum fluid = kernels_of(2, NULL, 1, 0.5);
        fluid.kind = SSFR_CONTINUUM_SPHERES;
        caster c;
        begin(&c, &fluid);
        const ssfr_ray ray = {{0, 0, -3}, {0, 0, 1}};
        const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
        assert_int_equal(found->n, pairs[i].n);
        assert_int_equal(found->n_touches, pairs[i].n_touches);
        assert_close(found->items[found->n - 1].t, 4 + pairs[i].apart, 1e-14, 0);
        if (pairs[i].n_touches) {
            assert_true(found->touch < 4 && found->touch + found->touched > 4 && found->touched < 1e-13);
        }
        finish(&c);
        ssfr_continuum_finish(&fluid);
    }
}

/* They touch 2.385 m behind where the ray is asked about, or before. */
static void what_touches_beyond_the_line_is_no_touch(void **state)
{
    (void)state;
    memcpy(centre, (double[3][3]){{0, 0, 0}, {0, 0, 2}, {0, 0, 6}}, sizeof(double[3][3]));
    ssfr_continuum fluid = kernels_of(3, NULL, 1, 0.5);
    fluid.kind = SSFR_CONTINUUM_SPHERES;
    const ssfr_ray ray = {{0, 0, -3}, {0, 0, 1}}, grazing = {{1, 0, -3}, {0, 0, 1}};
    caster c;
    begin(&c, &fluid);
    assert_int_equal(find(&c, &ray, 0, 3.5)->n_touches, 0);
    assert_int_equal(find(&c, &ray, 4.5, 20)->n_touches, 0);
    assert_int_equal(find(&c, &ray, 0, 20)->n_touches, 1);
    /* On rims it may be that the line begins or ends: at 2 and 8 balls are entered, at 10 the last one is left. */
    static const double on_rims[][2] = {{2, 3}, {8, 9}, {10, 20}, {0, 2}, {9, 10}};
    for (size_t i = 0; i < SSFR_COUNT(on_rims); i++)
        assert_true(find(&c, &ray, on_rims[i][0], on_rims[i][1])->n_touches > 0);
    /* All three are only grazed: where the line is, and where on it. */
    const ssfr_crossings *found = find(&c, &grazing, 4, 20);
    assert_int_equal(found->n, 0);
    assert_close(found->touch, 5, 1e-6, 0);
    double err;
    const double chords = ssfr_line_chords(&c.line, 4, 20, &err);
    assert_true(chords <= err && err > 1e-9 && err < 1e-6);
    found = find(&c, &grazing, 6, 8);
    assert_true(found->n_touches == 0 && isinf(found->touch));
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

/* A hundred balls within 1e-12 of each other: which of them is first is not known, but where it is. */
static void balls_in_nearly_one_place_are_entered_where_one_is(void **state)
{
    (void)state;
    enum { N = 100 };
    uint64_t seed = 2385;
    scatter(N, 1e-12, &seed);
    ssfr_continuum fluid = kernels_of(N, NULL, 1, 0.5);
    fluid.kind = SSFR_CONTINUUM_SPHERES;
    caster c;
    begin(&c, &fluid);
    for (int k = 0; k <= 11; k++) {
        const double left = 0.385 * pow(10, -k), half = sqrt(left * (2 - left));
        const ssfr_ray ray = {{1 - left, 0, -1000}, {0, 0, 1}};
        const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
        if (k == 11 && found->n == 0) continue;
        assert_int_equal(found->n, 2);
        assert_true(found->items[0].t_err < 1e-11 / half + 1e-11);
        assert_close(found->items[0].t, 1000 - half, found->items[0].t_err + 2e-12 / half, 0);
        assert_close(found->items[1].t, 1000 + half, found->items[1].t_err + 2e-12 / half, 0);
        worst w = {0};
        if (k < 6) check_line(&fluid, &ray, 999, 1001, 100, found, &w);
    }
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

/* A particle that alone fills its support is a ball whose weight is 0 where the surface is. */
static void a_mean_is_crossed_at_the_rim_of_its_support(void **state)
{
    (void)state;
    memset(centre, 0, sizeof centre[0]);
    ssfr_continuum fluid = kernels_of(1, &ssfr_radials[0], 1, 0.5);
    fluid.kind = SSFR_CONTINUUM_ZHU_BRIDSON;
    fluid.radius = 1.1;
    caster c;
    begin(&c, &fluid);
    uint64_t seed = 9;
    for (int i = 0; i < 200; i++) {
        const int k = i % 18;
        const double left = k == 17 ? 0 : test_random(&seed, 0.1, 0.9) * pow(10, -k), b = 1 - left;
        const ssfr_ray ray = {{b, 0, -20}, {0, 0, 1}};
        const double half = (double)sqrtl((1 - (real)b) * (1 + (real)b));
        const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
        if (found->n == 2) {
            assert_true(fabs(found->items[0].t - (20 - half)) <= found->items[0].t_err + DBL_EPSILON * 20);
            assert_true(fabs(found->items[1].t - (20 + half)) <= found->items[1].t_err + DBL_EPSILON * 20);
        } else {
            assert_int_equal(found->n, 0);
            assert_true(k > 10 && found->touched >= 2 * half && found->touched < 1e-5);
        }
    }
    fluid.radius = 0.5; /* and there is none where the rim is no surface */
    const ssfr_ray along = {{1, 0, -20}, {0, 0, 1}};
    assert_int_equal(find(&c, &along, 0, INFINITY)->n_touches, 0);
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

/* Where a double's step is longer than a support nothing is known, but there is an answer. */
static void an_eye_beyond_all_digits_gets_an_answer(void **state)
{
    (void)state;
    const ssfr_ray ray = {{0, 0, -1e17}, {0, 0, 1}};
    memset(centre, 0, sizeof centre[0]);
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        ssfr_continuum fluid = fluid_of(1, (ssfr_continuum_kind)kind, 0);
        ssfr_crossing first;
        caster c;
        begin(&c, &fluid);
        const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
        for (size_t i = 0; i < found->n; i++) assert_true(isfinite(found->items[i].t) && found->items[i].t_err > 1);
        find_first(&c, &ray, INFINITY, false, &first);
        finish(&c);
        ssfr_continuum_finish(&fluid);
    }
}

/* Both balls are entered and left at once: it is not known whose normal it is. */
static void a_ray_along_the_seam_of_two_spheres_states_no_normal(void **state)
{
    (void)state;
    memcpy(centre, (double[2][3]){{-0.5, 0, 0}, {0.5, 0, 0}}, sizeof(double[2][3]));
    ssfr_continuum fluid = kernels_of(2, NULL, 1, 0.5);
    fluid.kind = SSFR_CONTINUUM_SPHERES;
    const ssfr_ray ray = {{0, 0, -3}, {0, 0, 1}}, beside = {{1e-9, 0, -3}, {0, 0, 1}};
    caster c;
    begin(&c, &fluid);
    const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
    assert_int_equal(found->n, 2);
    for (int i = 0; i < 2; i++) {
        assert_close(found->items[i].t, 3 + (i ? 1 : -1) * sqrt(0.75), found->items[i].t_err, 0);
        assert_true(found->items[i].normal_err > 3);
    }
    found = find(&c, &beside, 0, INFINITY);
    assert_int_equal(found->n, 2);
    for (int i = 0; i < 2; i++) {
        assert_close(found->items[i].normal[0], -0.5, 1e-8, 0);
        assert_true(found->items[i].normal_err < 1e-12);
    }
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

/* Where a cubic spline has this value, in supports: the root of its polynomial there. */
static double spline_radius(double value)
{
    double roots[3];
    const double share = value * M_PI / 8;
    if (share < 0.25) return 1 - cbrt(share / 2);
    const int n = gsl_poly_solve_cubic(-1, 0, (1 - share) / 6, roots, roots + 1, roots + 2);
    for (int i = 0; i < n; i++)
        if (roots[i] > 0 && roots[i] <= 0.5) return roots[i];
    return NAN;
}

static void one_kernel_is_a_ball_of_the_closed_form(void **state)
{
    (void)state;
    uint64_t seed = 12;
    for (int i = 0; i < 200; i++) {
        const double level = test_random(&seed, 0.02, 2.4), r = spline_radius(level);
        const double b = test_random(&seed, 0, 0.99) * r;
        memset(centre, 0, sizeof centre[0]);
        ssfr_continuum fluid = kernels_of(1, &ssfr_radials[0], 1, level);
        const ssfr_ray ray = {{b, 0, 2.385}, {0, 0, -1}};
        const double half = sqrt((r - b) * (r + b));
        caster c;
        begin(&c, &fluid);
        const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
        assert_int_equal(found->n, 2);
        for (int j = 0; j < 2; j++) {
            const ssfr_crossing *x = found->items + j;
            assert_close(x->t, 2.385 + (j == 0 ? -half : half), 3e-13, 0);
            assert_close(x->normal[0], b / r, 1e-12, 0);
            assert_close(x->normal[2], (j == 0 ? half : -half) / r, 1e-12, 0);
            assert_true(x->t_err < 1e-12 && x->normal_err < 1e-10);
        }
        finish(&c);
        ssfr_continuum_finish(&fluid);
    }
}

/* ---- clouds ------------------------------------------------------------------------------------------------------ */

static void no_crossing_of_a_density_is_missed(void **state)
{
    (void)state;
    for (int kernel = 0; kernel < SSFR_N_RADIALS; kernel++) {
        const worst w = check_clouds(SSFR_CONTINUUM_DENSITY, kernel, 16, 150);
        assert_true(w.n > 50);
        assert_true(w.t_err < 1e-10 * 4 * radius && w.normal_err < 1e-7);
    }
}

static void no_crossing_of_spheres_is_missed(void **state)
{
    (void)state;
    const worst w = check_clouds(SSFR_CONTINUUM_SPHERES, 0, 40, 500);
    assert_true(w.n > 100);
    assert_true(w.t_err < 1e-12 && w.normal_err < 1e-9);
}

static void no_crossing_of_zhu_and_bridsons_surface_is_missed(void **state)
{
    (void)state;
    const worst w = check_clouds(SSFR_CONTINUUM_ZHU_BRIDSON, 0, 30, 400);
    assert_true(w.n > 100);
    assert_true(w.t_err < 1e-10);
}

static void no_crossing_of_an_anisotropic_density_is_missed(void **state)
{
    (void)state;
    const worst w = check_clouds(SSFR_CONTINUUM_ANISOTROPIC, 0, 30, 200);
    assert_true(w.n > 100);
    assert_true(w.t_err < 1e-10 * 4 * radius && w.normal_err < 1e-7);
}

/* ---- on the edge ------------------------------------------------------------------------------------------------- */

/* A ray that passes a ball of radius r at r (1 - 10^-k). Where the two crossings are found they and their errors hold
 * the true ones; else there is a touch that is as long as what it hides. */
static void check_grazing(const ssfr_continuum *fluid, double r)
{
    caster c;
    begin(&c, fluid);
    for (int k = 1; k <= 15; k++) {
        const double left = pow(10, -k), b = r * (1 - left);
        const ssfr_ray ray = {{b, 0, -2}, {0, 0, 1}};
        const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
        /* Of the distance as it was rounded. */
        const double half = (double)sqrtl(((real)r - (real)b) * ((real)r + (real)b));
        if (found->n == 2) {
            assert_true(fabs(found->items[0].t - (2 - half)) <= found->items[0].t_err + 1e-15 / half);
            assert_true(fabs(found->items[1].t - (2 + half)) <= found->items[1].t_err + 1e-15 / half);
        } else {
            assert_int_equal(found->n, 0);
            assert_true(k >= 13);
            assert_int_equal(found->n_touches, 1);
            assert_true(found->touched >= 2 * half);
            assert_true(fabs(found->touch - 2) <= found->touched);
            assert_true(found->touched < 1e-5);
        }
        const ssfr_ray past = {{r * (1 + left), 0, -2}, {0, 0, 1}};
        found = find(&c, &past, 0, INFINITY);
        assert_int_equal(found->n, 0);
        assert_true(k >= 13 || found->n_touches == 0);
    }
    finish(&c);
}

/* Rays that pass a ball of radius r at the fluid's origin just so, from ever farther away: rounding moves them by more
 * than they are off. What holds is the errors. */
static void check_far_grazing(const ssfr_continuum *fluid, real r)
{
    uint64_t seed = 4;
    size_t n_crossed = 0, n_touched = 0;
    caster c;
    begin(&c, fluid);
    for (int i = 0; i < 600; i++) {
        const double away = pow(10, i % 8), left = (i % 3 - 0.5) * pow(10, -test_random(&seed, 3, 15));
        double aside[3] = {test_random(&seed, -1, 1), test_random(&seed, -1, 1), test_random(&seed, -1, 1)};
        ssfr_ray ray = {{0}, {0}};
        ssfr_normalize(aside);
        ssfr_cross(aside, (const double[3]){0.6, 0, -0.8}, ray.dir);
        ssfr_normalize(ray.dir);
        for (int k = 0; k < 3; k++) ray.origin[k] = (double)r * (1 - left) * aside[k] - away * ray.dir[k];
        const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
        real o[3], d[3];
        for (int k = 0; k < 3; k++) o[k] = (real)ray.origin[k], d[k] = (real)ray.dir[k];
        const real middle = -dot(o, d) / dot(d, d);
        for (int k = 0; k < 3; k++) o[k] += middle * d[k];
        const real square = r * r - dot(o, o), half = square > 0 ? sqrtl(square / dot(d, d)) : 0;
        assert_true(found->n == 0 || found->n == 2);
        n_crossed += found->n, n_touched += found->n_touches;
        if (found->n == 2 && half > 0) {
            assert_true(fabsl((real)found->items[0].t - (middle - half)) <= (real)found->items[0].t_err);
            assert_true(fabsl((real)found->items[1].t - (middle + half)) <= (real)found->items[1].t_err);
        } else if (found->n == 2) {
            assert_true(found->n_touches > 0);
        } else
            assert_true((real)found->touched >= 2 * half);
    }
    assert_true(n_crossed > 100 && n_touched > 10);
    finish(&c);
}

static void far_grazing_rays_never_err_beyond_what_they_state(void **state)
{
    (void)state;
    memset(centre, 0, sizeof centre[0]);
    ssfr_continuum fluid = kernels_of(1, &ssfr_radials[1], 1, 0.5);
    check_far_grazing(&fluid, sqrtl(1 - cbrtl(0.5L * 64 * pi / 315)));
    fluid.radial = NULL;
    fluid.kind = SSFR_CONTINUUM_SPHERES;
    check_far_grazing(&fluid, 1);
    ssfr_continuum_finish(&fluid);
}

static void grazing_rays_cross_twice_or_touch_and_never_err_beyond_what_they_state(void **state)
{
    (void)state;
    memset(centre, 0, sizeof centre[0]);
    ssfr_continuum fluid = kernels_of(1, &ssfr_radials[0], 1, 8 / M_PI * 0.25);
    check_grazing(&fluid, 0.5);
    ssfr_continuum_finish(&fluid);
    fluid = kernels_of(1, &ssfr_radials[0], 1, 0.5);
    fluid.radial = NULL;
    fluid.kind = SSFR_CONTINUUM_SPHERES;
    check_grazing(&fluid, 1);
    ssfr_continuum_finish(&fluid);
    fluid = kernels_of(1, &ssfr_radials[0], 1, 0.5);
    fluid.kind = SSFR_CONTINUUM_ZHU_BRIDSON;
    fluid.radius = 0.385;
    check_grazing(&fluid, 0.385);
    ssfr_continuum_finish(&fluid);
}

/* Two kernels on the ray: between them the density has a minimum at which it is level (1 +- share). */
static void a_density_that_only_just_reaches_the_level_is_crossed_twice_or_touched(void **state)
{
    (void)state;
    const double apart = 0.5, waist = 2 * ssfr_radial_value(&ssfr_radials[1], apart);
    memcpy(centre, (double[2][3]){{0, 0, -apart}, {0, 0, apart}}, sizeof(double[2][3]));
    const ssfr_ray ray = {{0, 0, -3}, {0, 0, 1}};
    for (int k = 2; k <= 17; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            ssfr_continuum fluid = kernels_of(2, &ssfr_radials[1], 1, waist * (1 + sign * pow(10, -k)));
            caster c;
            worst w = {0};
            begin(&c, &fluid);
            const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
            if (found->n_touches == 0) {
                assert_int_equal(found->n, sign > 0 ? 4 : 2);
                check_line(&fluid, &ray, 0, 6, 100, found, &w);
            } else {
                assert_true(k >= 13);
                assert_int_equal(found->n, 2);
                assert_int_equal(found->n_touches, 1);
                assert_true(found->touch < 3 && found->touch + found->touched > 3);
                assert_true(found->touched < 1e-5);
            }
            assert_true(found->evaluations < 1000);
            finish(&c);
            ssfr_continuum_finish(&fluid);
        }
}

static void a_density_that_is_level_all_along_the_ray_is_not_halved_for_ever(void **state)
{
    (void)state;
    enum { N = 200 };
    for (size_t i = 0; i < N; i++) {
        centre[i][0] = 0.7;
        centre[i][1] = 0;
        centre[i][2] = 0.02 * (double)i;
    }
    /* So dense a row is a cylinder to all digits but few. */
    ssfr_continuum fluid = kernels_of(N, &ssfr_radials[1], 0.1, 0.5);
    caster c;
    begin(&c, &fluid);
    const ssfr_ray ray = {{0, 0, -3}, {0, 0, 1}};
    assert_int_equal(ssfr_line_cast(&c.line, &ray, 0, INFINITY), SSFR_OK);
    fluid.level = ssfr_line_density(&c.line, 3 + 0.02 * N / 2);
    const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
    assert_true(found->n > 0 || found->n_touches > 0);
    assert_true(found->touched < 4);
    for (size_t i = 0; i < found->n; i++) assert_true(found->items[i].t_err > 0 && found->items[i].t_err < 1);
    assert_true(found->evaluations < 200000);
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

/* The mean of places jumps where the first particles begin to weigh: two of them, on either side of the ray and entered
 * at the same time, put it into the middle at once. */
static void a_mean_that_begins_in_the_middle_is_crossed_where_it_begins(void **state)
{
    (void)state;
    memcpy(centre, (double[2][3]){{-0.8, 0, 0}, {0.8, 0, 0}}, sizeof(double[2][3]));
    ssfr_continuum fluid = kernels_of(2, &ssfr_radials[0], 1, 0.5);
    fluid.kind = SSFR_CONTINUUM_ZHU_BRIDSON;
    fluid.radius = 0.25;
    caster c;
    begin(&c, &fluid);
    /* The mean lies in the ray's plane: 0.25 m before it the ray is inside, though it has been in both supports from
     * 0.6 m before it. */
    const ssfr_ray along = {{0, 0, -2}, {0, 0, 1}};
    const ssfr_crossings *found = find(&c, &along, 0, INFINITY);
    assert_int_equal(found->n, 2);
    assert_close(found->items[0].t, 1.75, 1e-13, 0);
    assert_close(found->items[1].t, 2.25, 1e-13, 0);
    fluid.radius = 0.7; /* farther than they weigh: all of their common support is inside, and a little more */
    found = find(&c, &along, 0, INFINITY);
    assert_int_equal(found->n, 2);
    assert_close(found->items[0].t, 1.4, found->items[0].t_err, 0);
    assert_close(found->items[1].t, 2.6, found->items[1].t_err, 0);
    for (int i = 0; i < 2; i++) {
        assert_true(found->items[i].t_err < SSFR_CROSSINGS_EPS);
        assert_close(sqrt(ssfr_dot(found->items[i].normal, found->items[i].normal)), 1, 1e-15, 0);
        assert_true(found->items[i].normal_err > 1);
    }
    assert_true(found->evaluations < 4000);
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

static void a_sheet_one_particle_thick_is_not_missed(void **state)
{
    (void)state;
    enum { SIDE = 21 };
    const double spacing = 1.8 * radius;
    uint64_t seed = 5;
    size_t n = 0;
    for (int x = 0; x < SIDE; x++)
        for (int y = 0; y < SIDE; y++, n++) {
            centre[n][0] = spacing * (x - SIDE / 2);
            centre[n][1] = spacing * (y - SIDE / 2);
            centre[n][2] = 0;
        }
    const ssfr_continuum_params params = {.kind = SSFR_CONTINUUM_DENSITY, .level = 0.25, .support = 4, .size = 1};
    ssfr_continuum fluid = continuum_of(n, &params, nowhere);
    caster c;
    worst w = {0};
    begin(&c, &fluid);
    for (int i = 0; i < 60; i++) {
        const double x = test_random(&seed, -5, 5) * radius, y = test_random(&seed, -5, 5) * radius;
        ssfr_ray ray = {{x, y, -10 * radius}, {0, 0, 1}};
        if (i % 2) ray.dir[0] = test_random(&seed, -0.5, 0.5), ray.dir[1] = test_random(&seed, -0.5, 0.5);
        ssfr_normalize(ray.dir);
        const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
        assert_int_equal(found->n, 2);
        assert_true(found->items[1].t - found->items[0].t < 4 * radius);
        check_line(&fluid, &ray, 0, 20 * radius, 100, found, &w);
    }
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

/* ---- where rays begin -------------------------------------------------------------------------------------------- */

static void a_ray_that_begins_inside_says_so(void **state)
{
    (void)state;
    memset(centre, 0, sizeof centre[0]);
    ssfr_continuum fluid = kernels_of(1, &ssfr_radials[0], 1, 0.4);
    const double r = spline_radius(0.4);
    const ssfr_ray ray = {{0.1, 0, 0}, {1, 0, 0}};
    caster c;
    begin(&c, &fluid);
    const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
    assert_true(found->begins_inside);
    assert_int_equal(found->n, 1);
    assert_close(found->items[0].t, r - 0.1, 1e-13, 0);
    found = find(&c, &ray, 0.2, 0.25);
    assert_true(found->begins_inside);
    assert_int_equal(found->n, 0);
    found = find(&c, &ray, r, 5);
    assert_false(found->begins_inside);
    assert_int_equal(found->n, 0);
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

static void a_place_is_inside_where_the_field_says_so(void **state)
{
    (void)state;
    uint64_t seed = 99;
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        size_t n_inside = 0;
        scatter(60, 4 * radius, &seed);
        ssfr_continuum fluid = fluid_of(60, (ssfr_continuum_kind)kind, 2);
        caster c;
        begin(&c, &fluid);
        for (int i = 0; i < 300; i++) {
            ssfr_ray at = {{0, 0, 0}, {1, 0, 0}};
            bool inside;
            for (int j = 0; j < 3; j++) at.origin[j] = test_random(&seed, -6 * radius, 6 * radius);
            assert_int_equal(ssfr_crossings_inside(&c.crossings, &c.line, at.origin, &inside), SSFR_OK);
            assert_int_equal(inside, field(&fluid, &at, 0, NULL) > 0);
            n_inside += inside;
        }
        assert_in_range(n_inside, 20, 280);
        finish(&c);
        ssfr_continuum_finish(&fluid);
    }
}

/* The first crossing, of those that a line cast through everything has. */
static void the_first_crossing_is_the_first_of_all(void **state)
{
    (void)state;
    uint64_t seed = 41;
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        size_t n_found = 0;
        scatter(400, 14 * radius, &seed);
        ssfr_continuum fluid = fluid_of(400, (ssfr_continuum_kind)kind, 0);
        caster c;
        begin(&c, &fluid);
        for (int i = 0; i < 100; i++) {
            const ssfr_ray ray = test_truth_ray(&seed, i % 2 ? 2000 * radius : 40 * radius);
            ssfr_crossing first = {0};
            const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
            const bool inside = found->begins_inside, any = found->n > 0;
            const ssfr_crossing expected = any ? found->items[0] : (ssfr_crossing){0};
            assert_int_equal(find_first(&c, &ray, INFINITY, inside, &first), any);
            n_found += any;
            if (!any) continue;
            assert_close(first.t, expected.t, first.t_err + expected.t_err, 0);
            assert_int_equal(first.enters, !inside);
            assert_close(ssfr_dot(first.normal, expected.normal), 1, 1e-9, 0);
            assert_false(find_first(&c, &ray, 0.9 * expected.t, inside, &first));
        }
        assert_true(n_found > 20);
        finish(&c);
        ssfr_continuum_finish(&fluid);
    }
}

/* From a crossing on, in any direction: who goes in comes out again elsewhere, who goes out does not come in here. */
static void a_ray_from_the_surface_does_not_find_the_crossing_that_it_comes_from(void **state)
{
    (void)state;
    uint64_t seed = 77;
    size_t n_tried = 0;
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        scatter(300, 9 * radius, &seed);
        ssfr_continuum fluid = fluid_of(300, (ssfr_continuum_kind)kind, 0);
        caster c;
        begin(&c, &fluid);
        for (int i = 0; i < 250; i++) {
            const ssfr_ray ray = test_truth_ray(&seed, 20 * radius);
            ssfr_crossing at, next;
            if (!find_first(&c, &ray, INFINITY, find(&c, &ray, 0, 1e-3 * radius)->begins_inside, &at)) continue;
            ssfr_ray from;
            ssfr_ray_at(&ray, at.t, from.origin);
            for (int j = 0; j < 3; j++) from.dir[j] = test_random(&seed, -1, 1);
            ssfr_normalize(from.dir);
            const double slope = ssfr_dot(from.dir, at.normal);
            if (fabs(slope) < 1e-3) continue;
            const bool inside = slope < 0;
            const bool found = find_first(&c, &from, INFINITY, inside, &next);
            assert_true(found || !inside);
            assert_int_equal(c.crossings.n_touches, 0);
            n_tried++;
            if (!found) continue;
            assert_int_equal(next.enters, !inside);
            assert_true(next.t > 1e-9 * radius);
            check_crossing(&fluid, &from, &next);
            /* All between is on the side that was said. */
            for (int j = 1; j < 20; j++)
                assert_int_equal(field(&fluid, &from, (real)next.t * j / 20, NULL) > 0, inside);
        }
        finish(&c);
        ssfr_continuum_finish(&fluid);
    }
    assert_true(n_tried > 500);
}

/* The ray is said to begin inside, but lies outside from its first digit on, or grazes: an answer that goes on. */
static void a_ray_on_the_other_side_than_said_crosses_at_once(void **state)
{
    (void)state;
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        memset(centre, 0, sizeof centre[0]);
        ssfr_continuum fluid = fluid_of(1, (ssfr_continuum_kind)kind, 1);
        ssfr_crossing first;
        caster c;
        begin(&c, &fluid);
        fluid.level = 0.05;
        const ssfr_ray outside = {{3 * radius, 0, 0}, {-1, 0, 0}}, inside = {{0, 0, 0}, {0, 1, 0}};
        assert_true(find_first(&c, &outside, INFINITY, true, &first));
        assert_false(first.enters);
        assert_true(first.t > 0 && first.t < 1e-5 * radius && first.t_err >= first.t);
        assert_close(ssfr_dot(first.normal, outside.dir), 1, 1e-15, 0);
        assert_true(find_first(&c, &inside, INFINITY, false, &first));
        assert_true(first.enters && first.t < 1e-5 * radius);
        assert_close(ssfr_dot(first.normal, inside.dir), -1, 1e-15, 0);
        finish(&c);
        ssfr_continuum_finish(&fluid);
    }
}

/* Rays from a sphere's surface that are ever more tangent come out where the closed form has it. */
static void tangent_rays_from_the_surface_leave_after_their_chord(void **state)
{
    (void)state;
    memset(centre, 0, sizeof centre[0]);
    ssfr_continuum fluid = kernels_of(1, &ssfr_radials[0], 1, 8 / M_PI * 0.25);
    caster c;
    begin(&c, &fluid);
    for (int k = 0; k <= 16; k++) {
        const double sine = pow(10, -k);
        const ssfr_ray ray = {{0.5, 0, 0}, {-sine, sqrt(1 - sine * sine), 0}};
        ssfr_crossing first;
        const bool found = find_first(&c, &ray, INFINITY, true, &first);
        if (k <= 5) {
            assert_true(found && !first.enters);
            assert_close(first.t, sine, first.t_err + 1e-16, 0);
        } else if (found) {
            assert_true(!first.enters && first.t <= 1e-5);
        }
        const ssfr_ray away = {{0.5, 0, 0}, {sine, sqrt(1 - sine * sine), 0}};
        assert_false(find_first(&c, &away, INFINITY, false, &first));
    }
    finish(&c);
    ssfr_continuum_finish(&fluid);
}

/* ---- everything else --------------------------------------------------------------------------------------------- */

static void moving_all_by_a_thousand_kilometres_changes_nothing(void **state)
{
    (void)state;
    uint64_t seed = 8;
    const double far[3] = {1e6, -1e6, 1e6};
    scatter(200, 8 * radius, &seed);
    /* Places that also exist a thousand kilometres away. */
    for (size_t i = 0; i < 200; i++)
        for (int k = 0; k < 3; k++) centre[i][k] = ldexp(nearbyint(ldexp(centre[i][k], 20)), -20);
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        const ssfr_continuum_params params = {.kind = kind, .level = 0.4, .support = 4, .size = 1.3};
        ssfr_continuum near_fluid = continuum_of(200, &params, nowhere), far_fluid = continuum_of(200, &params, far);
        caster near_by, far_off;
        size_t n = 0;
        begin(&near_by, &near_fluid), begin(&far_off, &far_fluid);
        for (int i = 0; i < 50; i++) {
            ssfr_ray ray = test_truth_ray(&seed, 20 * radius), moved = ray;
            /* The same place in the world, relative to the other fluid's origin. */
            for (int j = 0; j < 3; j++) moved.origin[j] += near_fluid.origin[j] - (far_fluid.origin[j] - far[j]);
            const ssfr_crossings *a = find(&near_by, &ray, 0, INFINITY), *b = find(&far_off, &moved, 0, INFINITY);
            assert_int_equal(a->n, b->n);
            for (size_t j = 0; j < a->n; j++) assert_close(a->items[j].t, b->items[j].t, 1e-8, 0);
            n += a->n;
        }
        assert_true(n > 20);
        finish(&near_by), finish(&far_off);
        ssfr_continuum_finish(&near_fluid), ssfr_continuum_finish(&far_fluid);
    }
}

static void a_fluid_that_is_nowhere_is_never_crossed(void **state)
{
    (void)state;
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        ssfr_continuum fluid = fluid_of(0, (ssfr_continuum_kind)kind, 0);
        const ssfr_ray ray = {{0, 0, 0}, {0, 0, 1}};
        ssfr_crossing first;
        bool inside = true;
        caster c;
        begin(&c, &fluid);
        const ssfr_crossings *found = find(&c, &ray, 0, INFINITY);
        assert_int_equal(found->n, 0);
        assert_int_equal(found->n_touches, 0);
        assert_false(found->begins_inside);
        assert_false(find_first(&c, &ray, INFINITY, false, &first));
        assert_int_equal(ssfr_crossings_inside(&c.crossings, &c.line, ray.origin, &inside), SSFR_OK);
        assert_false(inside);
        finish(&c);
        ssfr_continuum_finish(&fluid);
    }
}

static void what_was_found_before_changes_no_bit(void **state)
{
    (void)state;
    uint64_t seed = 31;
    scatter(300, 9 * radius, &seed);
    ssfr_continuum fluid = fluid_of(300, SSFR_CONTINUUM_DENSITY, 0);
    caster used;
    begin(&used, &fluid);
    for (int i = 0; i < 20; i++) {
        const ssfr_ray ray = test_truth_ray(&seed, 20 * radius);
        caster fresh;
        begin(&fresh, &fluid);
        const ssfr_crossings *a = find(&used, &ray, 0, INFINITY), *b = find(&fresh, &ray, 0, INFINITY);
        assert_int_equal(a->n, b->n);
        assert_int_equal(a->evaluations, b->evaluations);
        for (size_t j = 0; j < a->n; j++) assert_memory_equal(&a->items[j].t, &b->items[j].t, sizeof(double[6]));
        finish(&fresh);
    }
    finish(&used);
    ssfr_continuum_finish(&fluid);
}

static ssfr_result try_all(const ssfr_continuum *fluid, const ssfr_ray *ray)
{
    ssfr_result result = SSFR_OK;
    caster c;
    ssfr_crossing first;
    bool answer;
    ssfr_line_init(&c.line, fluid);
    SSFR_TRY(ssfr_crossings_init(&c.crossings));
    SSFR_TRY(ssfr_line_cast(&c.line, ray, 0, INFINITY));
    SSFR_TRY(ssfr_crossings_find(&c.crossings, &c.line));
    SSFR_TRY(ssfr_crossings_first(&c.crossings, &c.line, ray, INFINITY, false, &first, &answer));
    SSFR_TRY(ssfr_crossings_inside(&c.crossings, &c.line, ray->origin, &answer));
end:
    finish(&c);
    return result;
}

static void ask_all(caster *c, const ssfr_ray *ray)
{
    ssfr_crossing first;
    bool inside;
    assert_true(find(c, ray, 0, INFINITY)->n > 0);
    assert_true(find_first(c, ray, INFINITY, false, &first));
    assert_int_equal(ssfr_crossings_inside(&c->crossings, &c->line, ray->origin, &inside), SSFR_OK);
}

static void running_out_of_memory_anywhere_is_an_error_and_a_warm_line_needs_none(void **state)
{
    (void)state;
    uint64_t seed = 3;
    const ssfr_ray ray = {{0.001, 0.002, -20 * radius}, {0, 0, 1}};
    scatter(200, 6 * radius, &seed);
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        ssfr_continuum fluid = fluid_of(200, (ssfr_continuum_kind)kind, 0);
        n_made = 0;
        assert_int_equal(try_all(&fluid, &ray), SSFR_OK);
        const long all = n_made;
        assert_true(all > 3);
        for (long i = 0; i < all; i++) {
            n_made = 0;
            fails_at = i;
            assert_fails(SSFR_ERR_MEMORY, try_all(&fluid, &ray), "no memory for");
            fails_at = -1;
        }
        caster c;
        begin(&c, &fluid);
        ask_all(&c, &ray);
        n_made = 0;
        ask_all(&c, &ray);
        assert_int_equal(n_made, 0);
        finish(&c);
        ssfr_continuum_finish(&fluid);
    }
}

/* Bounds on slopes take this for granted. */
static void no_kernel_is_curved_more_than_in_its_middle(void **state)
{
    (void)state;
    for (int i = 0; i < SSFR_N_RADIALS; i++) {
        const ssfr_radial *radial = ssfr_radials + i;
        const double most = ssfr_radial_steepness(radial, 0), step = 1e-4;
        for (double q = step; q < 1.1; q += step) {
            const double before = ssfr_radial_steepness(radial, q - step) * (q - step);
            const double behind = ssfr_radial_steepness(radial, q) * q;
            assert_true(fabs(behind - before) <= most * step * (1 + 1e-9));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_has_the_depth_normal_and_chord_of_the_closed_form),
        cmocka_unit_test(two_disjoint_spheres_give_four_crossings_and_two_lengths),
        cmocka_unit_test(spheres_that_overlap_are_one_body_and_those_that_just_touch_are_a_touch),
        cmocka_unit_test(what_touches_beyond_the_line_is_no_touch),
        cmocka_unit_test(balls_in_nearly_one_place_are_entered_where_one_is),
        cmocka_unit_test(a_mean_is_crossed_at_the_rim_of_its_support),
        cmocka_unit_test(an_eye_beyond_all_digits_gets_an_answer),
        cmocka_unit_test(a_ray_along_the_seam_of_two_spheres_states_no_normal),
        cmocka_unit_test(one_kernel_is_a_ball_of_the_closed_form),
        cmocka_unit_test(no_crossing_of_a_density_is_missed),
        cmocka_unit_test(no_crossing_of_spheres_is_missed),
        cmocka_unit_test(no_crossing_of_zhu_and_bridsons_surface_is_missed),
        cmocka_unit_test(no_crossing_of_an_anisotropic_density_is_missed),
        cmocka_unit_test(far_grazing_rays_never_err_beyond_what_they_state),
        cmocka_unit_test(grazing_rays_cross_twice_or_touch_and_never_err_beyond_what_they_state),
        cmocka_unit_test(a_density_that_only_just_reaches_the_level_is_crossed_twice_or_touched),
        cmocka_unit_test(a_density_that_is_level_all_along_the_ray_is_not_halved_for_ever),
        cmocka_unit_test(a_mean_that_begins_in_the_middle_is_crossed_where_it_begins),
        cmocka_unit_test(a_sheet_one_particle_thick_is_not_missed),
        cmocka_unit_test(a_ray_that_begins_inside_says_so),
        cmocka_unit_test(a_place_is_inside_where_the_field_says_so),
        cmocka_unit_test(the_first_crossing_is_the_first_of_all),
        cmocka_unit_test(a_ray_from_the_surface_does_not_find_the_crossing_that_it_comes_from),
        cmocka_unit_test(a_ray_on_the_other_side_than_said_crosses_at_once),
        cmocka_unit_test(tangent_rays_from_the_surface_leave_after_their_chord),
        cmocka_unit_test(moving_all_by_a_thousand_kilometres_changes_nothing),
        cmocka_unit_test(a_fluid_that_is_nowhere_is_never_crossed),
        cmocka_unit_test(what_was_found_before_changes_no_bit),
        cmocka_unit_test(running_out_of_memory_anywhere_is_an_error_and_a_warm_line_needs_none),
        cmocka_unit_test(no_kernel_is_curved_more_than_in_its_middle),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

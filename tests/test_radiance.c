/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_radiance.c: what a ray collects of spray, foam and bubbles, against closed forms and between rules. */
#include "experiments/truth/collocation.h"
#include "experiments/truth/radiance.h"
#include "base/param.h"
#include "tests/counted_memory.h"
#include "tests/util.h"

#include <float.h>

#define R 0.02385 /* m, radius of the fluid's particles */

static const double nowhere[3] = {0};
static const ssfr_integrate_params usual = {.eps_rel = 1e-10, .points = 16, .steps = 4096};

/* ---- a medium, and a ray through it ------------------------------------------------------------------------------ */

typedef struct medium {
    ssfr_extinction extinction;
    ssfr_line line;
    ssfr_integration *work;
} medium;

static ssfr_extinction_params params_of(double radius, double support)
{
    ssfr_extinction_params p;
    ssfr_params_default(ssfr_extinction_rows, &p);
    p.radius = radius, p.support = support;
    return p;
}

static ssfr_particles *pack(size_t n, const double *at, uint32_t *kind)
{
    const ssfr_particles given = {.kind = kind};
    ssfr_particles *particles = NULL;
    assert_int_equal(ssfr_particles_create(&particles, n, at, &given), SSFR_OK);
    return particles;
}

static void fill(medium *m, size_t n, const double *at, uint32_t *kind, const double origin[3],
                 const ssfr_extinction_params *p)
{
    ssfr_particles *particles = pack(n, at, kind);
    *m = (medium){0};
    assert_int_equal(ssfr_extinction_init(&m->extinction, particles, R, origin, p), SSFR_OK);
    ssfr_particles_destroy(&particles);
    assert_int_equal(ssfr_integration_create(&m->work), SSFR_OK);
    ssfr_line_init(&m->line, &m->extinction.kernels);
}

static void drain(medium *m)
{
    ssfr_line_finish(&m->line);
    ssfr_integration_destroy(&m->work);
    ssfr_extinction_finish(&m->extinction);
    assert_null(m->extinction.colour);
}

static void cast(medium *m, const ssfr_ray *ray)
{
    assert_int_equal(ssfr_line_cast(&m->line, ray, 0, INFINITY), SSFR_OK);
}

static ssfr_radiance collect_with(medium *m, ssfr_integrator_id id, const ssfr_integrate_params *p, double a, double b)
{
    ssfr_radiance out;
    assert_int_equal(ssfr_radiance_collect(&m->extinction, &m->line, m->work, id, p, a, b, &out), SSFR_OK);
    for (int k = 0; k < 3; k++) assert_true(isfinite(out.colour[k]));
    assert_true(out.transmittance >= 0 && out.transmittance <= 1);
    assert_true(out.err >= 0 && isfinite(out.err));
    return out;
}

static ssfr_radiance collect(medium *m, ssfr_integrator_id id)
{
    return collect_with(m, id, &usual, 0, INFINITY);
}

enum { CLOUD = 400 };

/* A cloud of all three kinds about a ray along x: a metre of it, a few kernels deep everywhere. */
static const ssfr_ray along_x = {{-0.3, 0.001, -0.002}, {1, 0, 0}};

static void cloud(medium *m, const double origin[3], bool with_kinds)
{
    static double at[3 * CLOUD];
    static uint32_t kind[CLOUD];
    uint64_t seed = 2385;
    for (int i = 0; i < CLOUD; i++) {
        at[3 * i] = origin[0] + test_random(&seed, 0, 1);
        at[3 * i + 1] = origin[1] + test_random(&seed, -0.05, 0.05);
        at[3 * i + 2] = origin[2] + test_random(&seed, -0.05, 0.05);
        kind[i] = (uint32_t)i % 3;
    }
    const ssfr_extinction_params p = params_of(0.385, 2);
    fill(m, CLOUD, at, with_kinds ? kind : NULL, origin, &p);
}

/* ---- closed forms ------------------------------------------------------------------------------------------------ */

/* The cubic spline's integral along a line through its middle is 6 / (pi h^2): an optical depth of 6 Q a^2 / h^2. */
static void a_lone_particle_is_a_closed_form(void **state)
{
    (void)state;
    const double at[3] = {0.7, 0, 0}, depth = 6 * 1.5 * ssfr_square(0.385 / 1.7);
    const ssfr_ray ray = {{0, 0, 0}, {1, 0, 0}};
    ssfr_extinction_params p = params_of(0.385, 1.7);
    p.efficiency = 1.5, p.bubble = 0.7;
    medium m;
    fill(&m, 1, at, (uint32_t[]){SSFR_BUBBLE}, nowhere, &p);
    cast(&m, &ray);
    const ssfr_radiance got = collect(&m, SSFR_INTEGRATOR_chords);
    assert_true(got.closed && got.evaluations == 0);
    assert_close(got.transmittance, exp(-depth), 1e-14, 0);
    for (int k = 0; k < 3; k++) assert_close(got.colour[k], -0.7 * expm1(-depth), 1e-14, 0);
    assert_true(got.err < 1e-12);
    drain(&m);
}

/* Two particles one behind the other that do not touch: c1 (1 - e^-t1) + e^-t1 c2 (1 - e^-t2). */
static void two_colours_behind_one_another_are_a_closed_form(void **state)
{
    (void)state;
    const double at[6] = {0.5, 0, 0, 0.9, 0.25 * 2 * R, 0};
    const ssfr_ray ray = {{0, 0, 0}, {1, 0, 0}};
    const ssfr_extinction_params p = params_of(0.885, 2);
    medium m;
    fill(&m, 2, at, (uint32_t[]){SSFR_FOAM, SSFR_BUBBLE}, nowhere, &p);
    cast(&m, &ray);
    const double near = m.extinction.kernels.centre[1][1] / m.extinction.kernels.support; /* a float is not a quarter */
    const double share = 2 * M_PI * ssfr_square(0.885 / 2);
    const double t1 = 6 * ssfr_square(0.885 / 2), t2 = share * ssfr_radial_chord(&ssfr_radials[0], near, 1);
    const double first = m.extinction.colour[0][0], second = m.extinction.colour[1][0];
    assert_true(first != second);
    const double expected = -first * expm1(-t1) - exp(-t1) * second * expm1(-t2);
    for (int id = 0; id < SSFR_N_INTEGRATORS; id++) {
        const ssfr_radiance got = collect(&m, (ssfr_integrator_id)id);
        const bool chooses = id != SSFR_INTEGRATOR_steps && id != SSFR_INTEGRATOR_gauss;
        const double eps = chooses ? 1e-10 : 1e-5;
        assert_close(got.colour[0], expected, id == SSFR_INTEGRATOR_qags ? eps : fmin(got.err, eps), 0);
        assert_close(got.transmittance, exp(-t1 - t2), id == SSFR_INTEGRATOR_steps ? eps : 1e-13, 0);
    }
    drain(&m);
}

/* Particles on a cubic lattice, `spacing` apart, are as many a cubic metre and so as much extinction as their
 * cross-sections: sigma = Q pi a^2 / spacing^3. */
static void a_slab_lets_e_to_the_minus_sigma_l_through(void **state)
{
    (void)state;
    enum { ACROSS = 23, ALONG = 66, N = ACROSS * ACROSS * ALONG };
    const double spacing = 0.00885, support = 10 * spacing / R, a = 0.1385;
    double *at = malloc(N * 3 * sizeof *at);
    assert_non_null(at);
    for (int i = 0; i < N; i++) {
        at[3 * i] = (i / ACROSS / ACROSS) * spacing;
        at[3 * i + 1] = (i / ACROSS % ACROSS - ACROSS / 2) * spacing;
        at[3 * i + 2] = (i % ACROSS - ACROSS / 2) * spacing;
    }
    const ssfr_extinction_params p = params_of(a, support);
    const ssfr_ray ray = {{-1, 0.21 * spacing, -0.38 * spacing}, {1, 0, 0}};
    medium m;
    fill(&m, N, at, NULL, nowhere, &p);
    free(at);
    cast(&m, &ray);
    const double sigma = M_PI * ssfr_square(a * R) / (spacing * spacing * spacing);
    const double from = 1 + 10.5 * spacing, length = 43.85 * spacing;
    assert_true(sigma * length > 1);
    /* How constant it is depends on how many particles a kernel spans: here to 1e-6. */
    double uneven = 0;
    for (int i = 0; i <= 1000; i++)
        uneven = fmax(uneven, fabs(ssfr_line_density(&m.line, from + length * i / 1000) / sigma - 1));
    assert_true(uneven < 1e-6);
    const ssfr_radiance got = collect_with(&m, SSFR_INTEGRATOR_chords, &usual, from, from + length);
    assert_close(got.transmittance, exp(-sigma * length), 0, uneven * sigma * length);
    assert_close(got.colour[0], -0.95 * expm1(-sigma * length), uneven, 0);
    drain(&m);
}

static void the_transmittance_is_that_of_the_sum_over_all_particles(void **state)
{
    (void)state;
    medium m;
    cloud(&m, nowhere, true);
    const ssfr_ray ray = {{-0.3, 0.001, -0.002}, {cos(0.03), sin(0.03), 0}};
    cast(&m, &ray);
    const ssfr_continuum *fluid = &m.extinction.kernels;
    double depth = 0;
    for (size_t i = 0; i < fluid->n; i++) {
        double to[3];
        for (int k = 0; k < 3; k++) to[k] = fluid->centre[i][k] - ray.origin[k];
        const double middle = ssfr_dot(to, ray.dir);
        const double near = sqrt(fmax(ssfr_dot(to, to) - middle * middle, 0)) / fluid->support;
        if (near < 1) depth += 2 * fluid->weight * fluid->support * ssfr_radial_chord(fluid->radial, near, 1);
    }
    assert_true(depth > 0.5 && m.line.n > 20);
    for (int id = 0; id < SSFR_INTEGRATOR_steps; id++)
        assert_close(collect(&m, (ssfr_integrator_id)id).transmittance, exp(-depth), 1e-12, 0);
    drain(&m);
}

/* ---- rules against each other ------------------------------------------------------------------------------------ */

static void one_colour_is_closed_and_the_rules_agree(void **state)
{
    (void)state;
    medium m;
    cloud(&m, nowhere, false);
    cast(&m, &along_x);
    assert_null(m.extinction.colour);
    const ssfr_radiance closed = collect(&m, SSFR_INTEGRATOR_chords);
    assert_true(closed.closed && closed.evaluations == 0 && closed.err < 1e-10);
    for (int id = SSFR_INTEGRATOR_qagp; id < SSFR_N_INTEGRATORS; id++) {
        const ssfr_radiance got = collect(&m, (ssfr_integrator_id)id);
        assert_true(!got.closed && got.evaluations > 20);
        assert_close(got.colour[0], closed.colour[0], closed.err + got.err, 0);
        if (id != SSFR_INTEGRATOR_steps) assert_close(got.colour[0], closed.colour[0], 1e-9, 0);
    }
    drain(&m);
}

static void mixed_colours_agree_within_the_sum_of_the_errors(void **state)
{
    (void)state;
    medium m;
    uint64_t seed = 7;
    cloud(&m, nowhere, true);
    for (int i = 0; i < 40; i++) {
        ssfr_ray ray = {{-0.3, 0, 0}, {1, test_random(&seed, -0.1, 0.1), test_random(&seed, -0.1, 0.1)}};
        ssfr_normalize(ray.dir);
        cast(&m, &ray);
        const ssfr_radiance chords = collect(&m, SSFR_INTEGRATOR_chords), qagp = collect(&m, SSFR_INTEGRATOR_qagp);
        const ssfr_radiance cquad = collect(&m, SSFR_INTEGRATOR_cquad), gauss = collect(&m, SSFR_INTEGRATOR_gauss);
        assert_close(qagp.colour[0], chords.colour[0], qagp.err + chords.err, 0);
        assert_close(qagp.colour[0], cquad.colour[0], qagp.err + cquad.err, 0);
        assert_close(qagp.colour[0], gauss.colour[0], qagp.err + gauss.err, 0);
        assert_true(chords.err < 1e-9 && qagp.err < 1e-9 && cquad.err < 1e-9);
    }
    drain(&m);
}

/* The middle's extinction for a whole step: its error falls with the square of the step. */
static void steps_converge_with_the_second_order(void **state)
{
    (void)state;
    medium m;
    cloud(&m, nowhere, true);
    cast(&m, &along_x);
    const ssfr_radiance exact = collect(&m, SSFR_INTEGRATOR_chords);
    double first = 0, last = 0;
    for (int steps = 128, i = 0; i < 6; steps *= 2, i++) {
        const ssfr_integrate_params p = {.steps = steps};
        const ssfr_radiance got = collect_with(&m, SSFR_INTEGRATOR_steps, &p, 0, INFINITY);
        assert_int_equal(got.evaluations, steps + steps / 2);
        last = fabs(got.colour[0] - exact.colour[0]);
        if (i == 0) first = last;
        assert_close(got.colour[0], exact.colour[0], exact.err + got.err, 0);
        assert_close(got.transmittance, exact.transmittance, exact.err + got.err, 0);
    }
    /* Five halvings: 4^5 = 1024, give or take what cancels. */
    assert_true(first > 1e-9 && last > 0);
    assert_true(first / last > 300 && first / last < 4000);
    drain(&m);
}

/* From a thousand kilometres away places have few digits: so has what comes through. */
static void a_far_eye_knows_less_of_the_transmittance(void **state)
{
    (void)state;
    const ssfr_ray ray = {{-1e6, 0.001, -0.002}, {1, 0, 0}};
    double depth_err;
    medium m;
    cloud(&m, nowhere, false);
    m.extinction.kernels.weight *= 0.1;
    cast(&m, &ray);
    const ssfr_radiance got = collect_with(&m, SSFR_INTEGRATOR_chords, &usual, 0, INFINITY);
    ssfr_line_chords(&m.line, 0, 2e6, &depth_err);
    assert_true(depth_err > 1e-9 && got.transmittance > 1e-3);
    assert_true(got.err >= got.transmittance * depth_err && got.err < 1e-6);
    drain(&m);
}

/* However few they are: the closed form of the transmittance is at hand. */
static void steps_know_how_wrong_their_transmittance_is(void **state)
{
    (void)state;
    medium m;
    uint64_t seed = 17;
    cloud(&m, nowhere, true);
    for (int i = 0; i < 40; i++) {
        ssfr_ray ray = {{-0.3, 0, 0}, {1, test_random(&seed, -0.1, 0.1), test_random(&seed, -0.1, 0.1)}};
        ssfr_normalize(ray.dir);
        cast(&m, &ray);
        const ssfr_radiance exact = collect(&m, SSFR_INTEGRATOR_chords);
        for (int steps = 2; steps <= 64; steps *= 2) {
            const ssfr_integrate_params p = {.steps = steps};
            const ssfr_radiance got = collect_with(&m, SSFR_INTEGRATOR_steps, &p, 0, INFINITY);
            assert_close(got.transmittance, exact.transmittance, got.err, 1e-12);
        }
    }
    drain(&m);
}

/* What shines as 1 is what does not come through. */
static void light_is_collected_or_comes_through(void **state)
{
    (void)state;
    medium m;
    uint64_t seed = 11;
    cloud(&m, nowhere, true);
    for (int i = 0; i < CLOUD; i++) {
        double *c = m.extinction.colour[i];
        c[0] = 1, c[1] = test_random(&seed, 0, 1), c[2] = 1 - c[1];
    }
    cast(&m, &along_x);
    for (int id = 0; id < SSFR_N_INTEGRATORS; id++) {
        if (id == SSFR_INTEGRATOR_qags) continue; /* knows of no breaks: its estimate is no bound */
        const ssfr_radiance got = collect(&m, (ssfr_integrator_id)id);
        assert_close(got.colour[0] + got.transmittance, 1, 1e-10, 0);
        assert_close(got.colour[1] + got.colour[2], got.colour[0], 1e-10, 0);
        assert_true(got.colour[1] > 0.05 && got.colour[2] > 0.05);
    }
    drain(&m);
}

static void greys_are_integrated_once_for_all_channels(void **state)
{
    (void)state;
    medium m;
    cloud(&m, nowhere, true);
    cast(&m, &along_x);
    const ssfr_radiance grey = collect(&m, SSFR_INTEGRATOR_gauss);
    assert_true(grey.colour[0] == grey.colour[1] && grey.colour[0] == grey.colour[2]);
    for (int i = 0; i < CLOUD; i++) m.extinction.colour[i][2] *= 0.5;
    const ssfr_radiance tinted = collect(&m, SSFR_INTEGRATOR_gauss);
    assert_int_equal(tinted.evaluations, 3 * grey.evaluations);
    assert_true(tinted.colour[0] == grey.colour[0]);
    assert_close(tinted.colour[2], 0.5 * grey.colour[2], 1e-14, 0);
    drain(&m);
}

/* With n points polynomials are integrated exactly: of degree 2 n - 1 over all, of degree n - 1 up to each point. */
static void collocation_is_exact_for_polynomials(void **state)
{
    (void)state;
    ssfr_collocation c;
    for (int n = 1; n <= SSFR_COLLOCATION_MOST; n++) {
        assert_int_equal(ssfr_collocation_init(&c, n), SSFR_OK);
        for (int degree = 0; degree < 2 * n; degree++) {
            double all = 0;
            for (int i = 0; i < n; i++) all += c.weight[i] * pow(c.at[i], degree);
            assert_close(all, 1.0 / (degree + 1), 1e-15, 0);
            for (int i = 0; i < n && degree < n; i++) {
                double part = 0;
                for (int j = 0; j < n; j++) part += c.upto[i][j] * pow(c.at[j], degree);
                assert_close(part, pow(c.at[i], degree + 1) / (degree + 1), 4e-15, 0);
            }
        }
    }
    assert_fails(SSFR_ERR_VALUE, ssfr_collocation_init(&c, 0), "0 points");
    assert_fails(SSFR_ERR_VALUE, ssfr_collocation_init(&c, SSFR_COLLOCATION_MOST + 1), "17 points");
}

/* Three small flecks on a long ray: the points of qags see those at its ends, and none of them the one between. What is
 * collected then lies outside of what colours and depth allow, and as much is known to be wrong. */
static void a_rule_that_misses_a_particle_does_not_claim_to_be_right(void **state)
{
    (void)state;
    const double at[9] = {-0.2, 0.001, -0.002, 0.201, 0.001, -0.002, 0.9, 0.001, -0.002};
    const ssfr_extinction_params p = params_of(0.1, 0.2);
    for (int mixed = 0; mixed < 2; mixed++) {
        medium m;
        fill(&m, 3, at, mixed ? (uint32_t[]){SSFR_SPRAY, SSFR_FOAM, SSFR_SPRAY} : NULL, nowhere, &p);
        cast(&m, &along_x);
        assert_int_equal(m.line.n, 3);
        const ssfr_radiance exact = collect(&m, SSFR_INTEGRATOR_chords), got = collect(&m, SSFR_INTEGRATOR_qags);
        const double off = exact.colour[0] - got.colour[0];
        assert_true(off > 0.1 && exact.err < 1e-10);
        assert_true(got.err >= (mixed ? 0.5 : 1) * off - exact.err && got.err <= off + 0.1);
        drain(&m);
    }
}

/* A cloud of an optical depth of thousands: its far side is not looked at, and yet nothing is missing. */
static void nothing_is_looked_at_in_the_dark(void **state)
{
    (void)state;
    medium m;
    const double *breaks;
    size_t n_breaks;
    cloud(&m, nowhere, true);
    m.extinction.kernels.weight *= 1e3;
    cast(&m, &along_x);
    assert_int_equal(ssfr_line_breaks(&m.line, 0, 9, &n_breaks, &breaks), SSFR_OK);
    const size_t all = (16 + 8) * (n_breaks - 1);
    const ssfr_radiance gauss = collect(&m, SSFR_INTEGRATOR_gauss), chords = collect(&m, SSFR_INTEGRATOR_chords);
    assert_true(gauss.evaluations > 0 && gauss.evaluations < all / 4);
    assert_close(gauss.colour[0], chords.colour[0], gauss.err + chords.err, 0);
    assert_true(chords.transmittance < 1e-100 && chords.colour[0] > 0.8 && chords.err < 1e-9);
    drain(&m);
}

static void no_error_is_larger_than_what_the_colours_leave_open(void **state)
{
    (void)state;
    const ssfr_integrate_params rough = {.eps_rel = 0.1, .points = 1};
    medium m;
    cloud(&m, nowhere, true);
    cast(&m, &along_x);
    for (int k = 0; k < 7; k++) {
        for (int id = 0; id < SSFR_INTEGRATOR_steps; id++) {
            const ssfr_radiance got = collect_with(&m, (ssfr_integrator_id)id, &rough, 0, INFINITY);
            const double opacity = 1 - got.transmittance, value = got.colour[0];
            assert_true(got.err <= fmax(value - 0.8 * opacity, opacity - value) + 1e-14);
        }
        m.extinction.kernels.weight *= 10;
        cast(&m, &along_x);
    }
    drain(&m);
}

/* What is asked for holds for the sum of all pieces. */
static void closed_forms_of_mixed_colours_reach_what_is_asked(void **state)
{
    (void)state;
    medium m;
    cloud(&m, nowhere, true);
    cast(&m, &along_x);
    for (double eps = 1e-2; eps > 1e-10; eps *= 0.1) {
        const ssfr_integrate_params p = {.eps_rel = eps};
        const ssfr_radiance got = collect_with(&m, SSFR_INTEGRATOR_chords, &p, 0, INFINITY);
        assert_true(!got.closed && got.err <= eps * got.colour[0] + 1e-11);
    }
    drain(&m);
}

/* A line that begins within the cloud has nothing before that, whatever is asked for. */
static void a_line_that_begins_later_is_a_cut(void **state)
{
    (void)state;
    medium m;
    cloud(&m, nowhere, true);
    cast(&m, &along_x);
    const ssfr_radiance cut = collect_with(&m, SSFR_INTEGRATOR_chords, &usual, 0.6385, 0.9);
    assert_int_equal(ssfr_line_cast(&m.line, &along_x, 0.6385, 0.9), SSFR_OK);
    for (int i = 0; i < 2; i++) {
        const ssfr_radiance got = collect_with(&m, SSFR_INTEGRATOR_chords, &usual, i ? 0.6385 : 0, i ? 0.9 : 5);
        assert_close(got.colour[0], cut.colour[0], got.err + cut.err, 0);
        assert_close(got.transmittance, cut.transmittance, 1e-12, 0);
    }
    drain(&m);
}

/* ---- work space -------------------------------------------------------------------------------------------------- */

static void cast_about(medium *m, int n)
{
    uint64_t seed = 3;
    for (int i = 0; i < n; i++) {
        ssfr_ray ray = {{-0.3, 0, 0}, {1, test_random(&seed, -0.1, 0.1), test_random(&seed, -0.1, 0.1)}};
        ssfr_normalize(ray.dir);
        cast(m, &ray);
        for (int id = 0; id < SSFR_N_INTEGRATORS; id++) collect(m, (ssfr_integrator_id)id);
    }
}

static void rays_like_those_before_allocate_nothing(void **state)
{
    (void)state;
    medium m;
    cloud(&m, nowhere, true);
    cast_about(&m, 4);
    const long before = n_made;
    cast_about(&m, 4);
    assert_int_equal(n_made, before);
    drain(&m);
}

static void room_that_cannot_grow_is_no_room(void **state)
{
    (void)state;
    ssfr_integration *work;
    double *room;
    assert_int_equal(ssfr_integration_create(&work), SSFR_OK);
    assert_int_equal(ssfr_integration_room(work, 10, sizeof *room, &room), SSFR_OK);
    fails_at = n_made;
    assert_fails(SSFR_ERR_MEMORY, ssfr_integration_room(work, 1000, sizeof *room, &room), "an integrand is made of");
    fails_at = -1;
    assert_int_equal(ssfr_integration_room(work, 10, sizeof *room, &room), SSFR_OK);
    for (int i = 0; i < 10; i++) room[i] = 2.385;
    ssfr_integration_destroy(&work);
}

static void memory_that_runs_out_is_told_and_leaves_all_in_order(void **state)
{
    (void)state;
    static const ssfr_integrator_id ids[] = {SSFR_INTEGRATOR_chords, SSFR_INTEGRATOR_qagp, SSFR_INTEGRATOR_cquad,
                                             SSFR_INTEGRATOR_gauss};
    for (size_t i = 0; i < SSFR_COUNT(ids); i++) {
        medium m;
        ssfr_radiance out, again;
        ssfr_result result = SSFR_ERR_MEMORY;
        int failed = 0;
        cloud(&m, nowhere, true);
        cast(&m, &along_x);
        for (; result != SSFR_OK; failed++) {
            ssfr_integration_destroy(&m.work);
            assert_int_equal(ssfr_integration_create(&m.work), SSFR_OK);
            test_clear_log();
            n_made = 0;
            fails_at = failed;
            result = ssfr_radiance_collect(&m.extinction, &m.line, m.work, ids[i], &usual, 0, 9, &out);
            fails_at = -1;
            if (result == SSFR_OK) break;
            assert_int_equal(result, SSFR_ERR_MEMORY);
            assert_int_equal(test_n_errors(), 1);
            /* The same work space serves when there is memory again. */
            assert_int_equal(ssfr_radiance_collect(&m.extinction, &m.line, m.work, ids[i], &usual, 0, 9, &again),
                             SSFR_OK);
        }
        assert_true(failed >= 1 && failed < 10); /* those within GSL are none of these */
        assert_true(memcmp(out.colour, again.colour, sizeof out.colour) == 0 && out.err == again.err);
        drain(&m);
    }
}

/* ---- ends -------------------------------------------------------------------------------------------------------- */

/* Up to a solid, and from there on: L = L1 + T1 L2. */
static void a_ray_that_is_cut_collects_its_parts(void **state)
{
    (void)state;
    medium m;
    cloud(&m, nowhere, true);
    cast(&m, &along_x);
    const ssfr_radiance whole = collect(&m, SSFR_INTEGRATOR_chords);
    for (double cut = 0.2; cut < 1.6; cut += 0.1385) {
        const ssfr_radiance near = collect_with(&m, SSFR_INTEGRATOR_chords, &usual, 0, cut);
        const ssfr_radiance far = collect_with(&m, SSFR_INTEGRATOR_chords, &usual, cut, INFINITY);
        assert_close(near.transmittance * far.transmittance, whole.transmittance, 1e-12, 0);
        assert_close(near.colour[0] + near.transmittance * far.colour[0], whole.colour[0], 1e-9, 0);
        assert_true(near.colour[0] <= whole.colour[0] + whole.err);
    }
    drain(&m);
}

static void nothing_there_collects_nothing(void **state)
{
    (void)state;
    const ssfr_ray past = {{-0.3, 5, 0}, {1, 0, 0}};
    const double ranges[][2] = {{0, INFINITY}, {0.5, 0.5}, {0.7, 0.2}, {3, 10}, {NAN, 1}, {5, NAN}};
    medium m;
    cloud(&m, nowhere, true);
    for (size_t i = 0; i < SSFR_COUNT(ranges); i++) {
        cast(&m, i == 0 ? &past : &along_x);
        for (int id = 0; id < SSFR_N_INTEGRATORS; id++) {
            const ssfr_radiance got = collect_with(&m, (ssfr_integrator_id)id, &usual, ranges[i][0], ranges[i][1]);
            assert_true(got.transmittance == 1 && got.err == 0 && got.evaluations == 0);
            for (int k = 0; k < 3; k++) assert_true(got.colour[k] == 0);
        }
    }
    drain(&m);
}

static void no_particles_are_no_extinction(void **state)
{
    (void)state;
    const ssfr_extinction_params p = params_of(0.25, 1);
    ssfr_particles none = {0};
    for (int i = 0; i < 2; i++) {
        medium m = {0};
        ssfr_radiance out;
        assert_int_equal(ssfr_extinction_init(&m.extinction, i ? &none : NULL, 0, nowhere, &p), SSFR_OK);
        ssfr_line_init(&m.line, &m.extinction.kernels);
        cast(&m, &along_x);
        const ssfr_integrator_id id = SSFR_INTEGRATOR_chords;
        assert_int_equal(ssfr_radiance_collect(&m.extinction, &m.line, NULL, id, &usual, 0, 9, &out), SSFR_OK);
        assert_true(out.transmittance == 1 && out.colour[0] == 0 && out.err == 0);
        ssfr_line_finish(&m.line);
        ssfr_extinction_finish(&m.extinction);
    }
}

/* From next to none to 1e6 and more a metre; NaN is nowhere, and what is collected stays between the colours. */
static void extinction_may_be_tiny_or_extreme(void **state)
{
    (void)state;
    static const double radius[] = {1e-4, 1e-2, 1, 10}, support[] = {0.01, 0.2385, 10, 100};
    const double at[12] = {0.5, 0, 0, 0.5001, 0.00005, 0, 0.5001, 0, 0, 0.7, 0, 0.0001};
    double most = 0, least = INFINITY;
    for (int i = 0; i < 16; i++) {
        medium m;
        const ssfr_extinction_params p = params_of(radius[i % 4], support[i / 4]);
        fill(&m, 4, at, (uint32_t[]){0, 1, 2, 2}, nowhere, &p);
        cast(&m, &(ssfr_ray){{0, 0, 0}, {1, 0, 0}});
        const double sigma = ssfr_line_density(&m.line, 0.5001);
        most = fmax(most, sigma), least = fmin(least, sigma);
        const ssfr_radiance exact = collect(&m, SSFR_INTEGRATOR_chords);
        assert_true(exact.err < 1e-9 || sigma > 1e4); /* beyond that places have too few digits */
        for (int id = 0; id < SSFR_N_INTEGRATORS; id++) {
            const ssfr_radiance got = collect(&m, (ssfr_integrator_id)id);
            const double opacity = 1 - got.transmittance;
            if (id == SSFR_INTEGRATOR_qags || id == SSFR_INTEGRATOR_steps) continue; /* may miss it all */
            assert_close(got.colour[0], exact.colour[0], got.err + exact.err, 0);
            assert_true(got.colour[0] >= 0.8 * opacity - got.err && got.colour[0] <= opacity + got.err);
        }
        drain(&m);
    }
    assert_true(most > 1e6 && least < 1e-6);
}

/* All of a thousand kilometres away is the same. */
static void far_from_the_worlds_origin_is_the_same(void **state)
{
    (void)state;
    const double far[3] = {1e6, -1e6, 1e6};
    medium here, there;
    cloud(&here, nowhere, true);
    cloud(&there, far, true);
    cast(&here, &along_x);
    cast(&there, &along_x);
    const ssfr_radiance a = collect(&here, SSFR_INTEGRATOR_chords), b = collect(&there, SSFR_INTEGRATOR_chords);
    assert_true(a.colour[0] > 0.3);
    assert_close(a.colour[0], b.colour[0], 0, 1e-6);
    assert_close(a.transmittance, b.transmittance, 0, 1e-6);
    drain(&here);
    drain(&there);
}

/* ---- kinds and refusals ------------------------------------------------------------------------------------------ */

static void kinds_have_their_colours_and_without_all_is_foam(void **state)
{
    (void)state;
    const double at[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
    ssfr_extinction_params p = params_of(0.25, 1);
    p.spray = 0.9, p.foam = 0.6, p.bubble = 0.3;
    const double grey[] = {0.9, 0.6, 0.3};
    uint32_t kind[] = {SSFR_BUBBLE, SSFR_SPRAY, SSFR_FOAM};
    ssfr_particles *particles = pack(3, at, kind);
    ssfr_extinction e;
    assert_int_equal(ssfr_extinction_init(&e, particles, R, nowhere, &p), SSFR_OK);
    for (size_t i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) assert_true(e.colour[i][k] == grey[particles->kind[i]]);
    ssfr_extinction_finish(&e);
    /* All of one kind, or kinds of one colour, need no array. */
    p.spray = p.foam = p.bubble = 0.385;
    assert_int_equal(ssfr_extinction_init(&e, particles, R, nowhere, &p), SSFR_OK);
    assert_null(e.colour);
    assert_true(e.same[0] == 0.385 && e.same[2] == 0.385);
    ssfr_extinction_finish(&e);
    ssfr_particles_destroy(&particles);

    p = params_of(0.25, 1);
    p.foam = 0.6385;
    particles = pack(3, at, NULL);
    assert_int_equal(ssfr_extinction_init(&e, particles, R, nowhere, &p), SSFR_OK);
    assert_null(e.colour);
    for (int k = 0; k < 3; k++) assert_true(e.same[k] == 0.6385);
    ssfr_extinction_finish(&e);
    ssfr_particles_destroy(&particles);
}

static void malformed_media_are_refused(void **state)
{
    (void)state;
    const double at[6] = {0, 0, 0, 1, 0, 0};
    ssfr_extinction_params p = params_of(0.25, 1);
    ssfr_particles *particles = pack(2, at, (uint32_t[]){1, 7});
    ssfr_extinction e;
    assert_fails(SSFR_ERR_VALUE, ssfr_extinction_init(&e, particles, R, nowhere, &p), "kind 7");
    assert_null(e.colour);
    ssfr_particles_destroy(&particles);
    particles = pack(2, at, NULL);
    assert_fails(SSFR_ERR_VALUE, ssfr_extinction_init(&e, particles, 0, nowhere, &p), "radius");
    assert_fails(SSFR_ERR_VALUE, ssfr_extinction_init(&e, particles, NAN, nowhere, &p), "nan");
    p.support = 0;
    assert_fails(SSFR_ERR_VALUE, ssfr_extinction_init(&e, particles, R, nowhere, &p), "extinction.support=0");
    p.support = 1, p.foam = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_extinction_init(&e, particles, R, nowhere, &p), "extinction.foam=nan");
    ssfr_particles_destroy(&particles);
}

static void malformed_rules_are_refused(void **state)
{
    (void)state;
    medium m;
    ssfr_radiance out;
    ssfr_integrate_params p = usual;
    cloud(&m, nowhere, true);
    cast(&m, &along_x);
#define COLLECT(id) ssfr_radiance_collect(&m.extinction, &m.line, m.work, id, &p, 0, 9, &out)
    p.steps = 0;
    assert_fails(SSFR_ERR_VALUE, COLLECT(SSFR_INTEGRATOR_steps), "steps 0");
    p.points = 65;
    assert_fails(SSFR_ERR_VALUE, COLLECT(SSFR_INTEGRATOR_gauss), "points 65");
    p.eps_rel = NAN;
    assert_fails(SSFR_ERR_VALUE, COLLECT(SSFR_INTEGRATOR_qagp), "nan");
    assert_fails(SSFR_ERR_VALUE, COLLECT(SSFR_INTEGRATOR_chords), "nan");
    assert_fails(SSFR_ERR_VALUE, COLLECT(SSFR_N_INTEGRATORS), "no rule");
    drain(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lone_particle_is_a_closed_form),
        cmocka_unit_test(two_colours_behind_one_another_are_a_closed_form),
        cmocka_unit_test(a_slab_lets_e_to_the_minus_sigma_l_through),
        cmocka_unit_test(the_transmittance_is_that_of_the_sum_over_all_particles),
        cmocka_unit_test(one_colour_is_closed_and_the_rules_agree),
        cmocka_unit_test(mixed_colours_agree_within_the_sum_of_the_errors),
        cmocka_unit_test(steps_converge_with_the_second_order),
        cmocka_unit_test(a_far_eye_knows_less_of_the_transmittance),
        cmocka_unit_test(steps_know_how_wrong_their_transmittance_is),
        cmocka_unit_test(light_is_collected_or_comes_through),
        cmocka_unit_test(greys_are_integrated_once_for_all_channels),
        cmocka_unit_test(collocation_is_exact_for_polynomials),
        cmocka_unit_test(a_rule_that_misses_a_particle_does_not_claim_to_be_right),
        cmocka_unit_test(nothing_is_looked_at_in_the_dark),
        cmocka_unit_test(no_error_is_larger_than_what_the_colours_leave_open),
        cmocka_unit_test(closed_forms_of_mixed_colours_reach_what_is_asked),
        cmocka_unit_test(a_line_that_begins_later_is_a_cut),
        cmocka_unit_test(rays_like_those_before_allocate_nothing),
        cmocka_unit_test(room_that_cannot_grow_is_no_room),
        cmocka_unit_test(memory_that_runs_out_is_told_and_leaves_all_in_order),
        cmocka_unit_test(a_ray_that_is_cut_collects_its_parts),
        cmocka_unit_test(nothing_there_collects_nothing),
        cmocka_unit_test(no_particles_are_no_extinction),
        cmocka_unit_test(extinction_may_be_tiny_or_extreme),
        cmocka_unit_test(far_from_the_worlds_origin_is_the_same),
        cmocka_unit_test(kinds_have_their_colours_and_without_all_is_foam),
        cmocka_unit_test(malformed_media_are_refused),
        cmocka_unit_test(malformed_rules_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

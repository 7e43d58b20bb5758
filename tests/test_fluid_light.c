/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_fluid_light.c: light through the continuous fluid itself: one particle against the closed forms of a sphere, and
 * clouds of them against what must hold for any body. */
#include "experiments/truth/fluid_light.h"
#include "base/param.h"
#include "tests/util.h"

enum { MAX_TRACED = 64 };

typedef struct rig {
    ssfr_particles *particles, *floating;
    ssfr_continuum fluid;
    ssfr_extinction extinction;
    ssfr_medium medium;
    ssfr_fluid_light *light;
    ssfr_light_params params;
    ssfr_surroundings around;
    bool white;
    int n_traced;
    ssfr_ray traced[MAX_TRACED];
} rig;

static void sky(void *user, const double dir[3], double colour[3])
{
    const rig *r = user;
    for (int k = 0; k < 3; k++)
        colour[k] = r->white ? 1 : 0.5 + 0.5 * sin(7.3 * dir[0] + 11.7 * dir[1] - 5.1 * dir[2] + 2.385 * k);
}

static double trace(void *user, const ssfr_ray *ray, double colour[3])
{
    rig *r = user;
    if (r->n_traced < MAX_TRACED) r->traced[r->n_traced] = *ray;
    r->n_traced++;
    sky(user, ray->dir, colour);
    return INFINITY;
}

/* Particles of radius 0.385 m at places + moved (m) as a continuum with its defaults, but for the kind; and some that
 * float. */
static void begin(rig *r, ssfr_continuum_kind kind, size_t n, const double (*places)[3], size_t n_floating,
                  const double (*floating)[3], double moved)
{
    ssfr_continuum_params params;
    ssfr_extinction_params extinction;
    double (*at)[3] = NULL;
    const ssfr_particles given = {.radius = 0.385};
    *r = (rig){.medium = {.ior = 1.333}};
    r->around = (ssfr_surroundings){.user = r, .trace = trace, .sky = sky, .brightest = 1};
    ssfr_params_default(ssfr_light_rows, &r->params);
    ssfr_params_default(ssfr_continuum_rows, &params);
    ssfr_params_default(ssfr_extinction_rows, &extinction);
    params.kind = kind, params.size = 1;
    assert_int_equal(ssfr_alloc(&at, n + n_floating, sizeof *at, "places"), SSFR_OK);
    for (size_t i = 0; i < n + n_floating; i++)
        for (int k = 0; k < 3; k++) at[i][k] = (i < n ? places[i][k] : floating[i - n][k]) + moved;
    assert_int_equal(ssfr_particles_create(&r->particles, n, &at[0][0], &given), SSFR_OK);
    assert_int_equal(ssfr_continuum_init(&r->fluid, r->particles, &params, NULL), SSFR_OK);
    if (n_floating) {
        assert_int_equal(ssfr_particles_create(&r->floating, n_floating, &at[n][0], &given), SSFR_OK);
        assert_int_equal(ssfr_extinction_init(&r->extinction, r->floating, 0.385, r->fluid.origin, &extinction),
                         SSFR_OK);
    }
    free(at);
}

static void make(rig *r)
{
    static const ssfr_integrate_params tolerance = {.eps_abs = 1e-10, .eps_rel = 1e-10, .points = 8, .steps = 64};
    ssfr_fluid_light_destroy(&r->light);
    assert_int_equal(ssfr_fluid_light_create(&r->light, &r->fluid, r->floating ? &r->extinction : NULL, &r->medium,
                                             SSFR_INTEGRATOR_chords, &tolerance), SSFR_OK);
}

static void end(rig *r)
{
    ssfr_fluid_light_destroy(&r->light);
    ssfr_extinction_finish(&r->extinction);
    ssfr_continuum_finish(&r->fluid);
    ssfr_particles_destroy(&r->floating);
    ssfr_particles_destroy(&r->particles);
}

static ssfr_lit follow(rig *r, const ssfr_ray *ray, bool inside)
{
    ssfr_lit lit;
    r->n_traced = 0;
    const ssfr_refractor *refractor = ssfr_fluid_light_refractor(r->light);
    assert_int_equal(ssfr_light_follow(refractor, &r->around, &r->params, ray, 0, inside, &lit), SSFR_OK);
    assert_close(lit.escaped + lit.absorbed + lit.ended, 1, 1e-10, 0);
    assert_true(lit.err >= 0 && isfinite(lit.err));
    for (int k = 0; k < 3; k++) assert_true(isfinite(lit.colour[k]));
    return lit;
}

/* From `from` to `to`, m, places as the particles have them. */
static ssfr_ray ray_towards(const rig *r, const double from[3], const double to[3], double moved)
{
    ssfr_ray ray;
    for (int k = 0; k < 3; k++) ray.origin[k] = from[k] + (moved - r->fluid.origin[k]), ray.dir[k] = to[k] - from[k];
    ssfr_normalize(ray.dir);
    return ray;
}

static ssfr_ray random_ray(const rig *r, uint64_t *seed, double size)
{
    double from[3], to[3];
    for (int k = 0; k < 3; k++) from[k] = test_random(seed, -1, 1), to[k] = test_random(seed, -size, size);
    ssfr_normalize(from);
    for (int k = 0; k < 3; k++) from[k] *= 5;
    return ray_towards(r, from, to, 0);
}

/* ---- one ball ---------------------------------------------------------------------------------------------------- */

/* Turned by 2 (i - t) towards the middle; the exit's normal makes the angle i with the ray on the far side of it. */
static void assert_refracted_twice(const rig *r, const ssfr_ray *ray, const double centre[3], double radius)
{
    double to[3], side[3];
    for (int k = 0; k < 3; k++) to[k] = centre[k] - ray->origin[k];
    const double along = ssfr_dot(to, ray->dir);
    for (int k = 0; k < 3; k++) side[k] = to[k] - along * ray->dir[k];
    const double i = asin(ssfr_normalize(side) / radius), t = asin(sin(i) / r->medium.ior), turn = 2 * (i - t);
    const ssfr_ray *out = &r->traced[2];
    assert_int_equal(r->n_traced, 3);
    for (int k = 0; k < 3; k++) {
        const double exit = cos(turn) * ray->dir[k] + sin(turn) * side[k];
        const double across = -sin(turn) * ray->dir[k] + cos(turn) * side[k];
        assert_close(out->dir[k], exit, 1e-9, 0);
        assert_close(out->origin[k], centre[k] + radius * (cos(i) * exit - sin(i) * across), 1e-9, 0);
    }
}

static void a_ray_refracted_twice_by_a_particle_leaves_where_the_closed_form_says(void **state)
{
    static const double place[1][3] = {{0.3, -0.7, 1.1}};
    (void)state;
    for (int far = 0; far < 2; far++) {
        rig r;
        const double moved = far ? 1e6 : 0;
        begin(&r, SSFR_CONTINUUM_SPHERES, 1, place, 0, NULL, moved);
        r.params.reflections = SSFR_REFLECTIONS_BACKGROUND;
        make(&r);
        for (double b = 0.01; b < 0.38; b += 0.0285) {
            double centre[3];
            const double from[3] = {0.3 + b, -5, 1.1}, to[3] = {0.3 + b, 5, 1.1};
            const ssfr_ray ray = ray_towards(&r, from, to, moved);
            ssfr_particles_position(r.particles, 0, centre);
            for (int k = 0; k < 3; k++) centre[k] -= r.fluid.origin[k];
            assert_int_equal(follow(&r, &ray, false).n_crossings, 2);
            assert_refracted_twice(&r, &ray, centre, 0.385);
        }
        end(&r);
    }
}

/* The surface of one kernel is a sphere, too, where w falls to the level; here it has to be searched for. */
static void a_ray_refracted_twice_by_a_searched_surface_leaves_where_the_closed_form_says(void **state)
{
    static const double place[1][3] = {{0.3, -0.7, 1.1}}, origin[3] = {0, 0, 0};
    (void)state;
    for (int kernel = 0; kernel < SSFR_N_RADIALS; kernel++) {
        rig r;
        const double level = 2.385 * ssfr_radial_value(&ssfr_radials[kernel], 0.55);
        begin(&r, SSFR_CONTINUUM_DENSITY, 0, NULL, 0, NULL, 0);
        ssfr_continuum_finish(&r.fluid);
        assert_int_equal(ssfr_continuum_init_kernels(&r.fluid, 1, place, origin, &ssfr_radials[kernel], 0.7, 2.385,
                                                     level), SSFR_OK);
        r.params.reflections = SSFR_REFLECTIONS_BACKGROUND;
        make(&r);
        for (double b = 0.01; b < 0.38; b += 0.0285) {
            const double from[3] = {0.3, -5, 1.1 + b}, to[3] = {0.3, 5, 1.1 + b};
            const ssfr_ray ray = ray_towards(&r, from, to, 0);
            assert_int_equal(follow(&r, &ray, false).n_crossings, 2);
            assert_refracted_twice(&r, &ray, place[0], 0.55 * 0.7);
        }
        end(&r);
    }
}

static void an_eye_in_the_water_sees_out(void **state)
{
    static const double place[1][3] = {{0.3, -0.7, 1.1}};
    rig r;
    bool inside = false;
    (void)state;
    begin(&r, SSFR_CONTINUUM_SPHERES, 1, place, 0, NULL, 0);
    r.medium = (ssfr_medium){1.333, 2.2, 0.65, 0.45, 0.01, 0.09, 0.13};
    r.params.reflections = SSFR_REFLECTIONS_BACKGROUND;
    make(&r);
    /* From 0.1 m off the middle, at a right angle to that: sin t = 0.1 / r at the surface. */
    const double from[3] = {0.4, -0.7, 1.1}, to[3] = {0.4, 5, 1.1};
    const ssfr_ray ray = ray_towards(&r, from, to, 0);
    const ssfr_lit lit = follow(&r, &ray, true);
    ssfr_line line;
    ssfr_crossings crossings;
    ssfr_line_init(&line, &r.fluid);
    assert_int_equal(ssfr_crossings_init(&crossings), SSFR_OK);
    assert_int_equal(ssfr_crossings_inside(&crossings, &line, ray.origin, &inside), SSFR_OK);
    assert_true(inside);
    ssfr_crossings_finish(&crossings);
    ssfr_line_finish(&line);
    const double t = asin(0.1 / 0.385), i = asin(1.333 * sin(t)), way = 0.385 * cos(t);
    const double share = ssfr_fresnel(cos(t), 1 / 1.333);
    const double a[3] = {2.2, 0.65, 0.45}, c[3] = {0.01, 0.09, 0.13};
    /* The normal is turned by t from +y towards +x, the ray goes on at the angle i from it. */
    const double out[3] = {-sin(i - t), cos(i - t), 0}, back[3] = {-sin(2 * t), -cos(2 * t), 0};
    double seen[3], mirrored[3];
    assert_int_equal(r.n_traced, 2);
    for (int k = 0; k < 3; k++) assert_close(r.traced[1].dir[k], out[k], 1e-9, 0);
    sky(&r, out, seen);
    sky(&r, back, mirrored);
    for (int k = 0; k < 3; k++) {
        const double clear = exp(-a[k] * way), behind = share * mirrored[k] + (1 - share) * seen[k];
        assert_close(lit.colour[k], clear * behind + (1 - clear) * c[k], 1e-8, 0);
    }
    assert_close(lit.absorbed, 1 - exp(-0.45 * way), 1e-9, 0);
    end(&r);
}

static void two_balls_refract_four_times(void **state)
{
    static const double places[2][3] = {{0, 0, 0}, {0.05, 0.02, 1.785}};
    rig r;
    (void)state;
    begin(&r, SSFR_CONTINUUM_SPHERES, 2, places, 0, NULL, 0);
    r.params.reflections = SSFR_REFLECTIONS_BACKGROUND;
    make(&r);
    const double from[3] = {0.01, 0.02, -4}, to[3] = {0.03, 0.01, 4};
    const ssfr_ray ray = ray_towards(&r, from, to, 0);
    const ssfr_lit lit = follow(&r, &ray, false);
    assert_int_equal(lit.n_crossings, 4);
    assert_int_equal(lit.n_paths, 5);
    assert_true(lit.ended == 0 && lit.err == 0);
    end(&r);
}

static void without_particles_there_is_the_sky_alone(void **state)
{
    rig r;
    double expected[3];
    (void)state;
    begin(&r, SSFR_CONTINUUM_DENSITY, 0, NULL, 0, NULL, 0);
    make(&r);
    const ssfr_ray ray = {{0.3, 0.2, 0.1}, {0.48, -0.6, 0.64}};
    const ssfr_lit lit = follow(&r, &ray, false);
    sky(&r, ray.dir, expected);
    assert_memory_equal(lit.colour, expected, sizeof expected);
    assert_true(lit.n_crossings == 0 && lit.escaped == 1);
    end(&r);
}

/* ---- clouds ------------------------------------------------------------------------------------------------------ */

enum { SIDE = 5, CLOUD = SIDE * SIDE * SIDE };

/* A lattice, disturbed. */
static void make_cloud(double (*out)[3], double spacing)
{
    uint64_t seed = 1;
    for (int i = 0; i < CLOUD; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int k = 0; k < 3; k++) out[i][k] = spacing * (at[k] - 0.5 * (SIDE - 1)) + test_random(&seed, -0.1, 0.1);
    }
}

static void all_continua_keep_a_white_world_white(void **state)
{
    static double cloud[CLOUD][3];
    (void)state;
    make_cloud(cloud, 0.77);
    for (int kind = 0; kind < SSFR_N_CONTINUA; kind++) {
        rig r;
        uint64_t seed = 2;
        int n_hits = 0;
        begin(&r, (ssfr_continuum_kind)kind, CLOUD, (const double (*)[3])cloud, 0, NULL, 0);
        r.white = true;
        r.params.least = 0.01, r.params.depth = 8;
        make(&r);
        for (int i = 0; i < 40; i++) {
            const ssfr_ray ray = random_ray(&r, &seed, 1.5);
            const ssfr_lit lit = follow(&r, &ray, false);
            for (int k = 0; k < 3; k++) assert_close(lit.colour[k], 1, 1e-10, 0);
            n_hits += lit.n_crossings > 0;
        }
        assert_true(n_hits > 20);
        end(&r);
    }
}

static void what_was_followed_before_changes_no_bit(void **state)
{
    static double cloud[CLOUD][3];
    rig r;
    ssfr_lit first[10];
    (void)state;
    make_cloud(cloud, 0.77);
    begin(&r, SSFR_CONTINUUM_DENSITY, CLOUD, (const double (*)[3])cloud, CLOUD / 4, (const double (*)[3])cloud, 0);
    r.medium.absorption_r = 2.2;
    r.params.least = 0.01;
    make(&r);
    for (int pass = 0; pass < 3; pass++) {
        uint64_t seed = 3;
        if (pass == 2) make(&r);
        for (int i = 0; i < 10; i++) {
            const ssfr_ray ray = random_ray(&r, &seed, 1);
            const ssfr_lit lit = follow(&r, &ray, false);
            if (pass == 0) first[i] = lit;
            assert_memory_equal(lit.colour, first[i].colour, sizeof lit.colour);
            assert_true(lit.err == first[i].err && lit.n_crossings == first[i].n_crossings);
        }
    }
    end(&r);
}

/* ---- what floats ------------------------------------------------------------------------------------------------- */

static void foam_before_the_sky_is_its_own_integral(void **state)
{
    static const double place[1][3] = {{0, 0, 0}}, foam[3][3] = {{2, 0, 0}, {2, 0, 0.2}, {2.1, 0.1, 0.4}};
    rig r;
    ssfr_line line;
    ssfr_radiance radiance;
    double behind[3];
    (void)state;
    begin(&r, SSFR_CONTINUUM_SPHERES, 1, place, 3, foam, 0);
    make(&r);
    const double from[3] = {2, 0.05, -5}, to[3] = {2.02, 0.05, 5};
    const ssfr_ray ray = ray_towards(&r, from, to, 0);
    const ssfr_lit lit = follow(&r, &ray, false);
    ssfr_line_init(&line, &r.extinction.kernels);
    assert_int_equal(ssfr_line_cast(&line, &ray, 0, INFINITY), SSFR_OK);
    const double depth = ssfr_line_chords(&line, 0, 100, NULL);
    assert_true(depth > 0.1);
    radiance.transmittance = exp(-depth);
    sky(&r, ray.dir, behind);
    for (int k = 0; k < 3; k++)
        assert_close(lit.colour[k], 0.95 * (1 - exp(-depth)) + exp(-depth) * behind[k], lit.err + 1e-14, 0);
    assert_close(lit.absorbed, 1 - radiance.transmittance, 1e-12, 0);
    assert_true(lit.err < 1e-12);
    ssfr_line_finish(&line);
    end(&r);
}

/* The same by 4096 steps that take water and foam one after the other: their error falls with the step. */
static void what_floats_in_water_is_within_its_bound(void **state)
{
    enum { STEPS = 4096 };
    static const double place[1][3] = {{0, 0, 0}}, foam[2][3] = {{0, 0, 0.1}, {0.05, 0, -0.1}};
    rig r;
    ssfr_line line;
    (void)state;
    begin(&r, SSFR_CONTINUUM_SPHERES, 1, place, 2, foam, 0);
    r.medium = (ssfr_medium){1, 2.2, 0.65, 0.45, 0.01, 0.09, 0.13};
    make(&r);
    const double from[3] = {0.01, 0.02, -3}, to[3] = {0, 0.03, 3};
    const ssfr_ray ray = ray_towards(&r, from, to, 0);
    const ssfr_lit lit = follow(&r, &ray, false);
    const double begins = r.traced[1].origin[2] - ray.origin[2], all = r.traced[2].origin[2] - ray.origin[2];
    const double a[3] = {2.2, 0.65, 0.45}, c[3] = {0.01, 0.09, 0.13};
    double seen[3], shine[3] = {0, 0, 0}, clear[3] = {1, 1, 1};
    ssfr_line_init(&line, &r.extinction.kernels);
    assert_int_equal(ssfr_line_cast(&line, &ray, 0, 10), SSFR_OK);
    for (int i = 0; i < STEPS; i++) {
        const double scale = (all - begins) / (ray.dir[2] * STEPS), at = begins / ray.dir[2] + i * scale;
        const double foggy = exp(-ssfr_line_chords(&line, at, at + scale, NULL));
        for (int k = 0; k < 3; k++) {
            const double water = exp(-a[k] * scale);
            shine[k] += clear[k] * ((1 - foggy) * 0.95 + foggy * (1 - water) * c[k]);
            clear[k] *= foggy * water;
        }
    }
    /* The balls' kernels reach no further than the water does. */
    sky(&r, ray.dir, seen);
    for (int k = 0; k < 3; k++) assert_close(lit.colour[k], shine[k] + clear[k] * seen[k], lit.err + 1e-4, 0);
    assert_true(lit.err > 0 && lit.err < 0.02);
    ssfr_line_finish(&line);
    end(&r);
}

/* The refractor itself, for whom it may be asked in any order. */
static void what_floats_is_collected_wherever_it_is_asked_for(void **state)
{
    static const double place[1][3] = {{0, 0, 0}}, foam[3][3] = {{2, 0, 0}, {2, 0, 0.2}, {2.1, 0.1, 0.4}};
    rig r, fresh;
    (void)state;
    begin(&r, SSFR_CONTINUUM_SPHERES, 1, place, 3, foam, 0);
    begin(&fresh, SSFR_CONTINUUM_SPHERES, 1, place, 3, foam, 0);
    make(&r);
    const ssfr_refractor *body = ssfr_fluid_light_refractor(r.light);
    assert_true(body->brightest == 0.95);
    const double from[3] = {2, 0.05, -5}, to[3] = {2.02, 0.05, 5};
    const ssfr_ray ray = ray_towards(&r, from, to, 0);
    static const double ends[][2] = {{0, 4.9}, {0, 20}, {4.9, 5.1}, {0, INFINITY}, {5.1, 30}};
    for (size_t i = 0; i < SSFR_COUNT(ends); i++) {
        double seen[3], expected[3], through, clear, err, other_err;
        assert_int_equal(body->between(body->user, &ray, ends[i][0], ends[i][1], seen, &through, &err), SSFR_OK);
        make(&fresh);
        const ssfr_refractor *other = ssfr_fluid_light_refractor(fresh.light);
        assert_int_equal(other->between(other->user, &ray, ends[i][0], ends[i][1], expected, &clear, &other_err),
                         SSFR_OK);
        for (int k = 0; k < 3; k++) assert_close(seen[k], expected[k], 1e-13, 0);
        assert_close(through, clear, 1e-13, 0);
        assert_true(through < 1 && err > 0 && err < 1e-10);
    }
    end(&r), end(&fresh);
}

/* A ray may cross such a place twice or not at all; the surface that it begins on is none. */
static void touches_are_counted_and_beginnings_are_not(void **state)
{
    static const double place[1][3] = {{0, 0, 0}};
    rig r;
    (void)state;
    begin(&r, SSFR_CONTINUUM_SPHERES, 1, place, 0, NULL, 0);
    make(&r);
    const double radius = r.fluid.support, *c = r.fluid.centre[0];
    const ssfr_ray grazing = {{c[0] + radius, c[1], c[2] - 3}, {0, 0, 1}};
    for (size_t i = 1; i < 4; i++) {
        follow(&r, &grazing, false);
        assert_int_equal(ssfr_fluid_light_touches(r.light), i);
    }
    make(&r);
    uint64_t seed = 5;
    for (int i = 0; i < 50; i++) {
        const ssfr_ray ray = random_ray(&r, &seed, 0.2);
        assert_true(follow(&r, &ray, false).n_crossings > 2);
    }
    assert_int_equal(ssfr_fluid_light_touches(r.light), 0);
    end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_refracted_twice_by_a_particle_leaves_where_the_closed_form_says),
        cmocka_unit_test(a_ray_refracted_twice_by_a_searched_surface_leaves_where_the_closed_form_says),
        cmocka_unit_test(an_eye_in_the_water_sees_out),
        cmocka_unit_test(two_balls_refract_four_times),
        cmocka_unit_test(without_particles_there_is_the_sky_alone),
        cmocka_unit_test(all_continua_keep_a_white_world_white),
        cmocka_unit_test(what_was_followed_before_changes_no_bit),
        cmocka_unit_test(foam_before_the_sky_is_its_own_integral),
        cmocka_unit_test(what_floats_in_water_is_within_its_bound),
        cmocka_unit_test(what_floats_is_collected_wherever_it_is_asked_for),
        cmocka_unit_test(touches_are_counted_and_beginnings_are_not),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

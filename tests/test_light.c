/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_light.c: Fresnel and Snell against second formulas, rays through spheres, slabs and cubes against closed forms,
 * and that no light is lost. */
#include "experiments/truth/light.h"
#include "base/param.h"
#include "tests/util.h"

static const double pi = 3.14159265358979323846;

/* ---- bodies with closed forms -------------------------------------------------------------------------------- */

enum { MAX_BALLS = 2, MAX_TRACED = 512 };

typedef struct world { /* one body of balls, or of a box, which may be infinite along some axes */
    int n_balls;
    double centre[MAX_BALLS][3], radius[MAX_BALLS];
    double half[3];            /* of the box around the origin; used without balls */
    double normal_scale;       /* of the normals handed over; else 1 */
    double wall;               /* m, y of a floor that ends rays; -inf for none */
    double sigma, shine[3];    /* 1/m, what floats everywhere, and its colour */
    double (*radiance)(const double dir[3], int k);
    int n_traced;
    ssfr_ray traced[MAX_TRACED]; /* in the order in which they were followed */
} world;

static bool ball_crossing(const world *w, int i, const ssfr_ray *ray, bool inside, ssfr_crossing *out)
{
    double o[3], at[3];
    for (int k = 0; k < 3; k++) o[k] = ray->origin[k] - w->centre[i][k];
    const double b = ssfr_dot(o, ray->dir), c = ssfr_dot(o, o) - w->radius[i] * w->radius[i], square = b * b - c;
    if (square <= 0 || (inside && c > 1e-9 * w->radius[i])) return false; /* inside: of this ball or another */
    out->t = inside ? -b + sqrt(square) : -b - sqrt(square);
    ssfr_ray_at(ray, out->t, at);
    for (int k = 0; k < 3; k++) out->normal[k] = (at[k] - w->centre[i][k]) / w->radius[i];
    return true;
}

static bool box_crossing(const world *w, const ssfr_ray *ray, bool inside, ssfr_crossing *out)
{
    double enter = -INFINITY, leave = INFINITY;
    int axis_in = 0, axis_out = 0;
    for (int k = 0; k < 3; k++) {
        if (ray->dir[k] == 0) {
            if (fabs(ray->origin[k]) > w->half[k]) return false;
            continue;
        }
        const double side = ray->dir[k] > 0 ? w->half[k] : -w->half[k];
        const double near = (-side - ray->origin[k]) / ray->dir[k], far = (side - ray->origin[k]) / ray->dir[k];
        if (near > enter) enter = near, axis_in = k;
        if (far < leave) leave = far, axis_out = k;
    }
    const int axis = inside ? axis_out : axis_in;
    for (int k = 0; k < 3; k++) out->normal[k] = 0;
    out->normal[axis] = (ray->dir[axis] > 0) == inside ? 1 : -1;
    out->t = inside ? leave : enter;
    return enter < leave;
}

static ssfr_result first(void *user, const ssfr_ray *ray, double to, bool inside, ssfr_crossing *out, bool *found)
{
    const world *w = user;
    const double least = 1e-9; /* m, the crossing that the ray comes from lies nearer */
    ssfr_crossing c = {.enters = !inside};
    *found = false;
    for (int i = 0; i < (w->n_balls ? w->n_balls : 1); i++) {
        if (!(w->n_balls ? ball_crossing(w, i, ray, inside, &c) : box_crossing(w, ray, inside, &c))) continue;
        if (!(c.t > least && c.t < to && (!*found || c.t < out->t))) continue;
        *out = c, *found = true;
        for (int k = 0; k < 3; k++) out->normal[k] *= w->normal_scale;
    }
    return SSFR_OK;
}

static ssfr_result between(void *user, const ssfr_ray *ray, double from, double to, double colour[3], double *through,
                           double *err)
{
    const world *w = user;
    (void)ray;
    const double tau = isinf(to) ? 0 : w->sigma * (to - from); /* nothing floats in front of the sky */
    for (int k = 0; k < 3; k++) colour[k] = -w->shine[k] * expm1(-tau);
    *through = exp(-tau), *err = 0;
    return SSFR_OK;
}

static void sky(void *user, const double dir[3], double colour[3])
{
    const world *w = user;
    for (int k = 0; k < 3; k++) colour[k] = w->radiance(dir, k);
}

static double trace(void *user, const ssfr_ray *ray, double colour[3])
{
    world *w = user;
    if (w->n_traced < MAX_TRACED) w->traced[w->n_traced] = *ray;
    w->n_traced++;
    sky(user, ray->dir, colour);
    const double t = (w->wall - ray->origin[1]) / ray->dir[1];
    if (!(t > 0 && isfinite(t))) return INFINITY;
    for (int k = 0; k < 3; k++) colour[k] = 0.25;
    return t;
}

static double white(const double dir[3], int k)
{
    (void)dir, (void)k;
    return 1;
}

/* In [0, 1], and different everywhere. */
static double patterned(const double dir[3], int k)
{
    return 0.5 + 0.5 * sin(7.3 * dir[0] + 11.7 * dir[1] - 5.1 * dir[2] + 2.385 * k);
}

static double light_above(const double dir[3], int k)
{
    (void)k;
    return dir[1] > 0;
}

static double light_below(const double dir[3], int k)
{
    (void)k;
    return dir[1] < 0;
}

typedef struct rig {
    world w;
    ssfr_refractor body;
    ssfr_surroundings around;
    ssfr_light_params params;
} rig;

static void begin(rig *r, double ior)
{
    *r = (rig){.w = {.normal_scale = 1, .wall = -INFINITY, .radiance = patterned}};
    r->body = (ssfr_refractor){.user = &r->w, .first = first, .ior = ior};
    r->around = (ssfr_surroundings){.user = &r->w, .trace = trace, .sky = sky, .brightest = 1};
    ssfr_params_default(ssfr_light_rows, &r->params);
    r->params.depth = SSFR_LIGHT_DEPTH;
}

static void begin_ball(rig *r, double ior)
{
    begin(r, ior);
    r->w.n_balls = 1;
    r->w.radius[0] = 2.385;
    r->w.centre[0][0] = 0.3, r->w.centre[0][1] = -0.7, r->w.centre[0][2] = 1.1;
}

static void begin_two_balls(rig *r, double ior)
{
    begin_ball(r, ior);
    r->w.n_balls = 2;
    r->w.radius[1] = 1.385;
    r->w.centre[1][0] = 0.9, r->w.centre[1][1] = -1.2, r->w.centre[1][2] = 5.3;
}

static void begin_box(rig *r, double ior, double x, double y, double z)
{
    begin(r, ior);
    r->w.half[0] = x, r->w.half[1] = y, r->w.half[2] = z;
}

static ssfr_ray ray_towards(const double from[3], const double to[3])
{
    ssfr_ray ray;
    for (int k = 0; k < 3; k++) ray.origin[k] = from[k], ray.dir[k] = to[k] - from[k];
    ssfr_normalize(ray.dir);
    return ray;
}

static void random_unit(uint64_t *seed, double out[3])
{
    do {
        for (int k = 0; k < 3; k++) out[k] = test_random(seed, -1, 1);
    } while (!(ssfr_dot(out, out) > 0.01 && ssfr_dot(out, out) < 1));
    ssfr_normalize(out);
}

/* From outside towards somewhere in the first ball, or near it. */
static ssfr_ray random_ray(uint64_t *seed, const rig *r)
{
    double from[3], to[3];
    random_unit(seed, from);
    random_unit(seed, to);
    for (int k = 0; k < 3; k++) from[k] = 10 * from[k], to[k] = r->w.centre[0][k] + 2 * to[k];
    return ray_towards(from, to);
}

static ssfr_lit follow(rig *r, const ssfr_ray *ray, bool inside)
{
    ssfr_lit lit;
    r->w.n_traced = 0;
    assert_int_equal(ssfr_light_follow(&r->body, &r->around, &r->params, ray, 0, inside, &lit), SSFR_OK);
    assert_close(lit.escaped + lit.absorbed + lit.ended, 1, 1e-10, 0);
    assert_true(lit.escaped >= 0 && lit.absorbed >= 0 && lit.ended >= 0);
    assert_true(lit.err >= 0 && isfinite(lit.err));
    for (int k = 0; k < 3; k++) assert_true(isfinite(lit.colour[k]));
    return lit;
}

/* ---- Fresnel and Snell ------------------------------------------------------------------------------------------- */

/* By angles (Fresnel 1823): r_s = -sin(i - t) / sin(i + t), r_p = tan(i - t) / tan(i + t). */
static double fresnel_by_angles(double i, double ratio, double *along)
{
    const double t = asin(sin(i) / ratio);
    *along = ssfr_square(tan(i - t) / tan(i + t));
    return 0.5 * (ssfr_square(sin(i - t) / sin(i + t)) + *along);
}

static void fresnel_is_that_of_sines_and_tangents(void **state)
{
    static const double ratios[] = {1.333, 1.0003, 2.385, 1 / 1.333, 1 / 2.385, 0.9997};
    (void)state;
    double along;
    for (size_t j = 0; j < SSFR_COUNT(ratios); j++) {
        const double last = ratios[j] < 1 ? asin(ratios[j]) : 0.5 * pi;
        for (double i = 0.05; i < last - 0.01; i += 0.0385)
            assert_close(ssfr_fresnel(cos(i), ratios[j]), fresnel_by_angles(i, ratios[j], &along), 1e-15, 1e-9);
    }
}

static void fresnel_at_normal_incidence_is_the_square_of_index_differences(void **state)
{
    (void)state;
    for (double ratio = 0.385; ratio < 4; ratio += 0.2385)
        assert_close(ssfr_fresnel(1, ratio), ssfr_square((ratio - 1) / (ratio + 1)), 0, 1e-14);
}

/* There reflected and refracted light stand at right angles, and only what swings across the plane is reflected. */
static void at_brewsters_angle_half_of_the_light_is_not_reflected_at_all(void **state)
{
    (void)state;
    for (double ratio = 0.385; ratio < 4; ratio += 0.2385) {
        const double i = atan(ratio), across = ssfr_square((1 - ratio * ratio) / (1 + ratio * ratio));
        assert_close(ssfr_fresnel(cos(i), ratio), 0.5 * across, 1e-16, 1e-13);
    }
}

/* An index next to 1, met at a small angle: the same in more digits. */
static void fresnel_keeps_its_digits_where_indices_hardly_differ(void **state)
{
    (void)state;
    for (double off = 1e-3; off > 1e-12; off *= 0.1)
        for (double cosine = 1e-6; cosine < 1; cosine *= 7.3) {
            const long double m = 1 + (long double)off, c = (long double)cosine;
            const double ratio = 1 + off;
            const long double n = (long double)ratio, g = sqrtl((n - 1) * (n + 1) + c * c);
            const long double rs = (c - g) / (c + g), rp = (n * n * c - g) / (n * n * c + g);
            assert_true(fabsl(m - n) < 1e-15L);
            assert_close(ssfr_fresnel(cosine, ratio), (double)((rs * rs + rp * rp) / 2), 1e-22, 1e-9);
        }
}

static void grazing_light_is_reflected_whole(void **state)
{
    (void)state;
    for (double ratio = 0.385; ratio < 4; ratio += 0.2385) {
        assert_close(ssfr_fresnel(0, ratio), 1, 0, 1e-15);
        if (ratio > 1) assert_close(ssfr_fresnel(1e-9, ratio), 1, 0, 1e-7);
    }
}

static void beyond_the_critical_angle_light_is_reflected_whole(void **state)
{
    static const double normal[3] = {0, 1, 0};
    (void)state;
    for (double ratio = 0.385; ratio < 1; ratio += 0.0385) {
        const double critical = asin(ratio), beyond = critical + 1e-6, before = critical - 1e-6;
        const double over[3] = {sin(beyond), -cos(beyond), 0}, under[3] = {sin(before), -cos(before), 0};
        double out[3];
        assert_true(ssfr_fresnel(cos(beyond), ratio) == 1);
        assert_true(ssfr_fresnel(cos(before), ratio) < 1 && ssfr_fresnel(cos(before), ratio) > 0.98);
        assert_false(ssfr_refract(over, normal, ratio, out));
        assert_true(ssfr_refract(under, normal, ratio, out));
        assert_close(out[0], sin(before) / ratio, 1e-15, 1e-12);
        assert_true(out[0] > 0.999 && out[1] < 0);
    }
}

static void light_is_reflected_alike_from_both_sides(void **state)
{
    (void)state;
    for (double ratio = 1.01; ratio < 4; ratio += 0.2385)
        for (double i = 0.01; i < 1.57; i += 0.0385)
            assert_close(ssfr_fresnel(cos(i), ratio), ssfr_fresnel(sqrt(1 - ssfr_square(sin(i) / ratio)), 1 / ratio),
                         1e-14, 1e-10);
}

static void refracted_rays_follow_snell_in_the_plane_of_incidence(void **state)
{
    uint64_t seed = 1;
    (void)state;
    for (int i = 0; i < 500; i++) {
        double dir[3], normal[3], out[3], back[3], from_dir[3], from_out[3], reverse[3], other[3];
        random_unit(&seed, dir);
        random_unit(&seed, normal);
        const double ratio = test_random(&seed, 0.4, 3), side = ssfr_dot(dir, normal) > 0 ? -1 : 1;
        for (int k = 0; k < 3; k++) normal[k] *= side;
        if (!ssfr_refract(dir, normal, ratio, out)) continue;
        assert_close(ssfr_dot(out, out), 1, 0, 1e-15);
        ssfr_cross(dir, normal, from_dir);
        ssfr_cross(out, normal, from_out);
        for (int k = 0; k < 3; k++) assert_close(from_out[k] * ratio, from_dir[k], 1e-14, 0);
        assert_true(ssfr_dot(out, normal) < 0);
        for (int k = 0; k < 3; k++) reverse[k] = -out[k], other[k] = -normal[k];
        /* The way back is the same; at grazing angles the root of a difference has half the digits. */
        if (!ssfr_refract(reverse, other, 1 / ratio, back)) continue;
        for (int k = 0; k < 3; k++) assert_close(back[k], -dir[k], 2e-8, 0);
    }
}

static void reflected_rays_keep_what_is_along_the_surface(void **state)
{
    static const double dir[3] = {0.48, -0.6, 0.64}, normal[3] = {0, 1, 0};
    double out[3];
    (void)state;
    ssfr_reflect(dir, normal, out);
    assert_true(out[0] == 0.48 && out[1] == 0.6 && out[2] == 0.64);
}

/* ---- a sphere ---------------------------------------------------------------------------------------------------- */

/* Twice refracted at the angles i outside and t inside, a ray turns by 2 (i - t) towards the middle, in the plane that
 * it makes with the middle. */
static void a_ray_refracted_twice_by_a_sphere_leaves_where_the_closed_form_says(void **state)
{
    uint64_t seed = 2;
    (void)state;
    for (int n = 0; n < 300; n++) {
        rig r;
        begin_ball(&r, n % 2 ? 1.333 : 0.785);
        r.params.reflections = SSFR_REFLECTIONS_BACKGROUND;
        const ssfr_ray ray = random_ray(&seed, &r);
        const double *c = r.w.centre[0], radius = r.w.radius[0];
        double to[3], side[3];
        for (int k = 0; k < 3; k++) to[k] = c[k] - ray.origin[k];
        const double along = ssfr_dot(to, ray.dir);
        for (int k = 0; k < 3; k++) side[k] = to[k] - along * ray.dir[k]; /* towards the middle */
        const double b = ssfr_normalize(side);
        if (b / radius >= fmin(r.body.ior, 1) - 1e-3) continue;
        const double i = asin(b / radius), t = asin(b / radius / r.body.ior), turn = 2 * (i - t);
        follow(&r, &ray, false);
        assert_int_equal(r.w.n_traced, 3);
        const ssfr_ray *out = &r.w.traced[2];
        for (int k = 0; k < 3; k++) {
            assert_close(out->dir[k], cos(turn) * ray.dir[k] + sin(turn) * side[k], 1e-9, 0);
            /* The exit's normal makes the angle i with the exit direction, on the far side. */
            const double exit = cos(turn) * ray.dir[k] + sin(turn) * side[k];
            const double across = -sin(turn) * ray.dir[k] + cos(turn) * side[k];
            assert_close(out->origin[k], c[k] + radius * (cos(i) * exit - sin(i) * across), 1e-9, 0);
        }
    }
}

/* Imai 2016, eqs 6 and 7, with two refractions. */
static void background_reflections_are_the_papers_recursion(void **state)
{
    uint64_t seed = 3;
    (void)state;
    for (int n = 0; n < 100; n++) {
        rig r;
        begin_ball(&r, 1.333);
        r.params.reflections = SSFR_REFLECTIONS_BACKGROUND;
        const ssfr_ray ray = random_ray(&seed, &r);
        for (int k = 0; k < 3; k++) r.body.absorption[k] = 0.1 + 0.2385 * k, r.body.colour[k] = 0.3 - 0.1 * k;
        const ssfr_lit lit = follow(&r, &ray, false);
        if (r.w.n_traced == 1) continue; /* missed */
        assert_int_equal(lit.n_crossings, 2);
        assert_true(lit.err == 0 && lit.ended == 0);
        const ssfr_ray *in = &r.w.traced[1], *out = &r.w.traced[2];
        double n1[3], n2[3], r1[3], r2[3], chord[3];
        for (int k = 0; k < 3; k++) n1[k] = (in->origin[k] - r.w.centre[0][k]) / r.w.radius[0];
        for (int k = 0; k < 3; k++) n2[k] = (r.w.centre[0][k] - out->origin[k]) / r.w.radius[0];
        for (int k = 0; k < 3; k++) chord[k] = out->origin[k] - in->origin[k];
        const double f1 = ssfr_fresnel(-ssfr_dot(ray.dir, n1), 1.333), s = sqrt(ssfr_dot(chord, chord));
        const double f2 = ssfr_fresnel(-ssfr_dot(in->dir, n2), 1 / 1.333);
        ssfr_reflect(ray.dir, n1, r1);
        ssfr_reflect(in->dir, n2, r2);
        for (int k = 0; k < 3; k++) {
            const double inside = f2 * patterned(r2, k) + (1 - f2) * patterned(out->dir, k);
            const double clear = exp(-r.body.absorption[k] * s);
            const double c = f1 * patterned(r1, k) + (1 - f1) * (clear * inside + (1 - clear) * r.body.colour[k]);
            assert_close(lit.colour[k], c, 1e-12, 0);
        }
    }
}

/* Eq. 8: after so many refractions the background comes, whatever else there is. */
static void the_depth_of_background_reflections_is_that_of_the_papers_last_refraction(void **state)
{
    rig r;
    (void)state;
    begin_two_balls(&r, 1.333);
    r.params.reflections = SSFR_REFLECTIONS_BACKGROUND;
    const ssfr_ray ray = ray_towards((const double[3]){0.1, -0.5, -8}, (const double[3]){0.75, -1.1, 5});
    assert_int_equal(follow(&r, &ray, false).n_crossings, 4);
    assert_true(follow(&r, &ray, false).ended == 0);
    r.params.depth = 2;
    const ssfr_lit cut = follow(&r, &ray, false);
    assert_int_equal(cut.n_crossings, 2);
    assert_true(cut.ended > 0.9);
    assert_close(cut.err, cut.ended, 1e-15, 0);
}

/* ---- a slab ------------------------------------------------------------------------------------------------------ */

static void a_slab_moves_a_ray_aside_and_leaves_its_direction(void **state)
{
    (void)state;
    for (double i = 0.05; i < 1.5; i += 0.0785) {
        rig r;
        begin_box(&r, 1.333, INFINITY, 0.5 * 2.385, INFINITY);
        const ssfr_ray ray = {{0.3, 4, -0.2}, {sin(i), -cos(i), 0}};
        follow(&r, &ray, false);
        const ssfr_ray *out = &r.w.traced[2];
        const double t = asin(sin(i) / 1.333), offset = 2.385 * sin(i - t) / cos(t);
        for (int k = 0; k < 3; k++) assert_close(out->dir[k], ray.dir[k], 1e-13, 0);
        const double d[3] = {out->origin[0] - ray.origin[0], out->origin[1] - ray.origin[1], 0};
        assert_close(fabs(d[0] * ray.dir[1] - d[1] * ray.dir[0]), offset, 1e-12, 0);
    }
}

/* Between its faces light goes to and fro, each time weaker by R and by the absorption: geometric series. */
static void a_slab_reflects_and_transmits_by_its_series(void **state)
{
    (void)state;
    for (double i = 0.02; i < 1.5; i += 0.1785)
        for (double a = 0; a < 2; a += 0.785) {
            rig r;
            begin_box(&r, 2.385, INFINITY, 0.5, INFINITY);
            r.params.least = 1e-13;
            const ssfr_ray ray = {{0.3, 4, -0.2}, {0, -cos(i), sin(i)}};
            const double t = asin(sin(i) / 2.385), share = ssfr_fresnel(cos(i), 2.385), lost = exp(-a / cos(t));
            const double transmitted = ssfr_square(1 - share) * lost / (1 - ssfr_square(share * lost));
            const double reflected = share + share * lost * transmitted;
            for (int k = 0; k < 3; k++) r.body.absorption[k] = a;
            r.w.radiance = light_above;
            const ssfr_lit up = follow(&r, &ray, false);
            r.w.radiance = light_below;
            const ssfr_lit down = follow(&r, &ray, false);
            assert_true(up.err < 1e-10);
            assert_close(up.colour[0], reflected, 1e-14 + up.err, 0);
            assert_close(down.colour[0], transmitted, 1e-14 + down.err, 0);
            assert_close(down.absorbed, 1 - reflected - transmitted, 1e-14 + down.err, 0);
            for (int k = 0; k < 3; k++) r.body.colour[k] = 0.385 * k; /* what absorbs shines */
            const ssfr_lit shining = follow(&r, &ray, false);
            assert_close(shining.colour[2], transmitted + 0.77 * shining.absorbed, 1e-14 + shining.err, 0);
        }
}

static void without_an_interface_only_absorption_is_left(void **state)
{
    rig r;
    (void)state;
    begin_box(&r, 1, INFINITY, 0.5, INFINITY);
    const double i = 0.785;
    const ssfr_ray ray = {{0.3, 4, -0.2}, {0, -cos(i), sin(i)}};
    for (int k = 0; k < 3; k++) r.body.absorption[k] = 0.5 + k, r.body.colour[k] = 0.1 * k;
    const ssfr_lit lit = follow(&r, &ray, false);
    assert_int_equal(r.w.n_traced, 3);
    for (int n = 0; n < 3; n++) assert_memory_equal(r.w.traced[n].dir, ray.dir, sizeof ray.dir);
    assert_true(lit.err == 0 && lit.n_paths == 1 && lit.n_crossings == 2);
    for (int k = 0; k < 3; k++) {
        const double clear = exp(-(0.5 + k) / cos(i));
        assert_close(lit.colour[k], clear * patterned(ray.dir, k) + (1 - clear) * 0.1 * k, 1e-14, 0);
    }
}

/* ---- total reflection -------------------------------------------------------------------------------------------- */

static void a_cubes_corner_sends_light_back(void **state)
{
    uint64_t seed = 4;
    (void)state;
    for (int n = 0; n < 100; n++) {
        rig r;
        begin_box(&r, 1.785, 1, 1, 1);
        /* Each face is met at more than 34.1 degrees, the critical angle: components below its cosine, 0.828. */
        const double to[3] = {1, 1, 1};
        double from[3];
        for (int k = 0; k < 3; k++) from[k] = test_random(&seed, 0.25, 0.6);
        const ssfr_ray ray = ray_towards(from, to);
        for (int k = 0; k < 3; k++) r.body.absorption[k] = 0.5;
        ssfr_ray aside = ray;
        for (int k = 0; k < 3; k++) aside.origin[k] -= test_random(&seed, 0, 0.01); /* past the corner itself */
        follow(&r, &aside, true);
        assert_true(r.w.n_traced > 4);
        for (int k = 0; k < 3; k++) assert_true(r.w.traced[3].dir[k] == -ray.dir[k]);
    }
}

/* Past its critical angle on all six faces light never leaves a cube. */
static void light_that_is_caught_in_a_cube_ends_with_the_depth(void **state)
{
    static const int depths[] = {0, 1, 7, SSFR_LIGHT_DEPTH};
    (void)state;
    for (size_t i = 0; i < SSFR_COUNT(depths); i++) {
        rig r;
        begin_box(&r, 1.785, 1, 1, 1);
        r.params.depth = depths[i];
        const ssfr_ray ray = ray_towards((const double[3]){0.3, 0.2, -0.1}, (const double[3]){1.0, 1.1, 0.9});
        const ssfr_lit lit = follow(&r, &ray, true);
        assert_int_equal(lit.n_crossings, depths[i]);
        assert_int_equal(lit.n_paths, 1);
        assert_true(lit.ended == 1 && lit.err == 1);
    }
}

static void light_that_is_reflected_whole_takes_the_sky_without_recursion(void **state)
{
    rig r;
    (void)state;
    begin_box(&r, 1.785, 1, 1, 1);
    r.params.reflections = SSFR_REFLECTIONS_BACKGROUND;
    const ssfr_ray ray = ray_towards((const double[3]){0.3, 0.2, -0.1}, (const double[3]){1.0, 1.1, 0.7});
    const ssfr_lit lit = follow(&r, &ray, true);
    const double mirrored[3] = {ray.dir[0], -ray.dir[1], ray.dir[2]};
    assert_int_equal(lit.n_crossings, 1);
    for (int k = 0; k < 3; k++) assert_close(lit.colour[k], patterned(mirrored, k), 1e-15, 0);
}

/* ---- no light is lost -------------------------------------------------------------------------------------------- */

static void a_white_world_stays_white(void **state)
{
    uint64_t seed = 5;
    (void)state;
    for (int n = 0; n < 400; n++) {
        rig r;
        begin_two_balls(&r, n % 3 ? 1.333 : 0.7);
        r.w.radiance = white;
        r.params.reflections = n % 2;
        r.params.depth = n % 40;
        const ssfr_ray ray = random_ray(&seed, &r);
        const ssfr_lit lit = follow(&r, &ray, false);
        for (int k = 0; k < 3; k++) assert_close(lit.colour[k], 1, 1e-10, 0);
        assert_true(lit.absorbed == 0);
    }
}

/* The sum stands in follow. */
static void what_escapes_is_absorbed_and_ends_is_all(void **state)
{
    uint64_t seed = 6;
    double most_absorbed = 0, most_ended = 0;
    (void)state;
    for (int n = 0; n < 1000; n++) {
        rig r;
        begin_two_balls(&r, test_random(&seed, 0.5, 2.5));
        for (int k = 0; k < 3; k++) r.body.absorption[k] = test_random(&seed, 0, 1), r.body.colour[k] = 0.1;
        r.w.sigma = test_random(&seed, 0, 0.2);
        if (n % 2) r.body.between = between;
        r.params.least = pow(10, -test_random(&seed, 1, 6));
        r.w.wall = n % 3 ? -1.5 : -INFINITY;
        const ssfr_ray ray = random_ray(&seed, &r);
        const ssfr_lit lit = follow(&r, &ray, false);
        most_absorbed = fmax(most_absorbed, lit.absorbed), most_ended = fmax(most_ended, lit.ended);
    }
    assert_true(most_absorbed > 0.5 && most_ended > 0.01);
}

static void the_error_is_a_bound_on_what_more_paths_would_change(void **state)
{
    uint64_t seed = 7;
    double most = 0;
    (void)state;
    for (int n = 0; n < 200; n++) {
        rig r;
        begin_two_balls(&r, n % 3 ? 1.333 : 2.385);
        const ssfr_ray ray = random_ray(&seed, &r);
        for (int k = 0; k < 3; k++) r.body.absorption[k] = n % 2 ? 0 : 0.05 * k, r.body.colour[k] = 1.5 * (n % 5 == 0);
        r.params.least = 1e-7;
        const ssfr_lit fine = follow(&r, &ray, false);
        r.params.least = 0.01;
        r.params.depth = 1 + n % 6;
        const ssfr_lit coarse = follow(&r, &ray, false);
        for (int k = 0; k < 3; k++) {
            assert_close(coarse.colour[k], fine.colour[k], coarse.err + fine.err + 1e-14, 0);
            most = fmax(most, fabs(coarse.colour[k] - fine.colour[k]));
        }
        assert_true(coarse.n_paths <= fine.n_paths);
    }
    assert_true(most > 1e-3);
}

static void no_path_goes_deeper_than_the_depth_or_on_with_less_than_the_least(void **state)
{
    rig r;
    (void)state;
    begin_ball(&r, 2.385);
    const ssfr_ray ray = ray_towards((const double[3]){4, 5, 6}, (const double[3]){1, 0.2, 1.2});
    /* One ball: a chain of inner reflections, each of which leaves one path to the outside. */
    for (int depth = 0; depth <= SSFR_LIGHT_DEPTH; depth++) {
        r.params.least = 1e-15;
        r.params.depth = depth;
        const ssfr_lit lit = follow(&r, &ray, false);
        assert_true(lit.n_crossings <= depth);
        assert_true(depth > 12 || lit.n_crossings == depth);
    }
    double before = 2;
    for (double least = 0.5; least > 1e-12; least *= 0.1) {
        r.params.least = least;
        const ssfr_lit lit = follow(&r, &ray, false);
        assert_true(lit.ended <= before);
        assert_true(lit.ended <= 2 * least * lit.n_crossings + least);
        before = lit.ended;
    }
    assert_true(before < 1e-11);
}

/* ---- surroundings and what floats -------------------------------------------------------------------------------- */

static void a_floor_inside_the_water_ends_a_ray(void **state)
{
    rig r;
    (void)state;
    begin_box(&r, 1.333, INFINITY, 1, INFINITY);
    r.w.wall = -0.385;
    r.params.reflections = SSFR_REFLECTIONS_BACKGROUND;
    const ssfr_ray ray = {{0, 3, 0}, {0, -1, 0}};
    const double up[3] = {0, 1, 0}, share = ssfr_fresnel(1, 1.333);
    for (int k = 0; k < 3; k++) r.body.absorption[k] = 1.5;
    const ssfr_lit lit = follow(&r, &ray, false);
    assert_int_equal(lit.n_crossings, 1);
    for (int k = 0; k < 3; k++)
        assert_close(lit.colour[k], share * patterned(up, k) + (1 - share) * exp(-1.5 * 1.385) * 0.25, 1e-14, 0);
}

/* Outside, what floats has its closed form; in water the two media together have L' = (a C + s c) - (a + s) L. */
static void what_floats_in_water_lies_within_its_bound(void **state)
{
    rig r;
    (void)state;
    begin_box(&r, 1, INFINITY, 0.5 * 2.385, INFINITY);
    r.w.wall = -2; /* ends the ray with 0.25 */
    r.w.sigma = 0.3;
    r.body.between = between;
    for (int k = 0; k < 3; k++) r.w.shine[k] = 0.9, r.body.absorption[k] = 0.4 * k, r.body.colour[k] = 0.1;
    const ssfr_ray ray = {{0, 3, 0}, {0, -1, 0}};
    const double above = 3 - 0.5 * 2.385, below = 2 - 0.5 * 2.385;
    double before = INFINITY;
    for (double least = 0.1; least > 1e-6; least *= 0.1) {
        r.params.least = least;
        const ssfr_lit lit = follow(&r, &ray, false);
        for (int k = 0; k < 3; k++) {
            const double a = 0.4 * k, s = 0.3, all = a + s;
            const double last = 0.9 + (0.25 - 0.9) * exp(-s * below), glow = (a * 0.1 + s * 0.9) / all;
            const double wet = glow + (last - glow) * exp(-all * 2.385);
            assert_close(lit.colour[k], 0.9 + (wet - 0.9) * exp(-s * above), lit.err + 1e-14, 0);
        }
        assert_true(lit.err <= before && lit.absorbed > 0.5);
        before = lit.err;
    }
    assert_true(before < 0.01);
}

static void dark_and_bright_surroundings_bound_what_ends(void **state)
{
    rig r;
    (void)state;
    begin_ball(&r, 1.333);
    r.params.depth = 0;
    r.around.darkest = -0.385, r.around.brightest = 2;
    const ssfr_ray ray = ray_towards((const double[3]){4, 5, 6}, r.w.centre[0]);
    assert_close(follow(&r, &ray, false).err, 2.385, 1e-15, 0);
    r.body.colour[1] = 3;
    assert_close(follow(&r, &ray, false).err, 3.385, 1e-15, 0);
    r.body.brightest = 4;
    assert_close(follow(&r, &ray, false).err, 4.385, 1e-15, 0);
}

/* Things at one end of a piece of water alone, which is taken as a whole: its bound is what both ends leave open. */
static bool things_are_near;
static double things_shine;

static ssfr_result between_at_an_end(void *user, const ssfr_ray *ray, double from, double to, double colour[3],
                                     double *through, double *err)
{
    const world *w = user;
    const bool here = things_are_near ? from == 0 : to >= 2;
    (void)ray;
    for (int k = 0; k < 3; k++) colour[k] = here ? things_shine : 0;
    *through = here ? exp(-w->sigma) : 1, *err = 0;
    return SSFR_OK;
}

static void what_floats_at_either_end_of_the_water_lies_within_its_bound(void **state)
{
    (void)state;
    for (int n = 0; n < 4; n++) {
        const bool near = n % 2;
        const double shine = n < 2 ? 0.9 : 0;
        rig r;
        begin_box(&r, 1, INFINITY, INFINITY, INFINITY);
        r.w.wall = -2; /* ends the ray with 0.25 */
        r.w.sigma = 2.385;
        r.params.least = 0.5;
        things_are_near = near, things_shine = shine;
        r.body.between = between_at_an_end;
        for (int k = 0; k < 3; k++) r.body.absorption[k] = 0.4, r.body.colour[k] = 0.1;
        const ssfr_ray ray = {{0, 0, 0}, {0, -1, 0}};
        const ssfr_lit lit = follow(&r, &ray, true);
        const double wet = exp(-0.8), dry = exp(-2.385), water = 0.1 * (1 - wet);
        const double exact = near ? shine + dry * (water + wet * 0.25) : water + wet * (shine + dry * 0.25);
        for (int k = 0; k < 3; k++) assert_close(lit.colour[k], exact, lit.err + 1e-15, 0);
        assert_close(lit.err, 0.5 * ((1 - wet) * shine + water * (1 - dry)), 1e-15, 0);
    }
}

static ssfr_result unknown(void *user, const ssfr_ray *ray, double from, double to, double colour[3], double *through,
                           double *err)
{
    const ssfr_result result = between(user, ray, from, to, colour, through, err);
    *err = INFINITY;
    return result;
}

static void an_error_that_is_not_known_is_no_nan_where_nothing_is_seen(void **state)
{
    rig r;
    ssfr_lit lit;
    (void)state;
    begin_box(&r, 1, INFINITY, INFINITY, INFINITY);
    r.w.wall = -2;
    r.w.sigma = 0.3;
    r.body.between = unknown;
    for (int k = 0; k < 3; k++) r.w.shine[k] = 0.9, r.body.absorption[k] = 1e300;
    const ssfr_ray ray = {{0, 0, 0}, {0, -1, 0}};
    assert_int_equal(ssfr_light_follow(&r.body, &r.around, &r.params, &ray, 0, true, &lit), SSFR_OK);
    assert_true(isinf(lit.err));
}

static void a_path_that_the_water_takes_ends_at_the_surface(void **state)
{
    rig r;
    (void)state;
    begin_box(&r, 1.333, 1, 1, 1);
    for (int k = 0; k < 3; k++) r.body.absorption[k] = 50;
    const ssfr_ray ray = ray_towards((const double[3]){0.3, 0.2, -0.1}, (const double[3]){0.35, 0.2, 3});
    const ssfr_lit lit = follow(&r, &ray, true);
    assert_true(lit.n_crossings == 0 && lit.n_paths == 1);
    assert_true(lit.ended < 1e-15);
}

/* Planes one behind the other, which only those meet that go up. */
static ssfr_result first_of_many(void *user, const ssfr_ray *ray, double to, bool inside, ssfr_crossing *out,
                                 bool *found)
{
    (void)user, (void)to;
    *out = (ssfr_crossing){.t = 1, .normal = {0, inside ? 1 : -1, 0}, .enters = !inside};
    *found = ray->dir[1] > 0;
    return SSFR_OK;
}

/* Each crossing leaves a path that waits while the next is followed. */
static void as_many_paths_wait_as_the_depth_makes(void **state)
{
    rig r;
    (void)state;
    begin(&r, 1.333);
    r.body.first = first_of_many;
    r.params.least = 1e-15;
    const ssfr_ray ray = {{0, 0, 0}, {0, 1, 0}};
    const ssfr_lit lit = follow(&r, &ray, false);
    assert_int_equal(lit.n_crossings, SSFR_LIGHT_DEPTH);
    assert_int_equal(lit.n_paths, SSFR_LIGHT_DEPTH + 1);
}

/* ---- what is degenerate ------------------------------------------------------------------------------------------ */

/* Finite values and the sum stand in follow. */
static void degenerate_normals_and_rays_give_no_nan(void **state)
{
    static const double scales[] = {1, -1, 0, NAN, INFINITY, 1e300};
    uint64_t seed = 8;
    (void)state;
    for (size_t i = 0; i < SSFR_COUNT(scales); i++)
        for (int n = 0; n < 50; n++) {
            rig r;
            begin_ball(&r, n % 2 ? SSFR_LIGHT_IOR : 1 / SSFR_LIGHT_IOR);
            if (n % 5 == 0) r.body.ior = 1.333;
            r.w.normal_scale = scales[i];
            r.body.absorption[n % 3] = 1e300;
            const ssfr_ray ray = random_ray(&seed, &r);
            follow(&r, &ray, false);
        }
    assert_true(isfinite(ssfr_fresnel(0, 1)) && isfinite(ssfr_fresnel(0, 1 + 1e-16)));
    assert_true(ssfr_fresnel(0, 1) == 0);
}

static void a_normal_turned_away_is_turned_back(void **state)
{
    rig r, turned;
    (void)state;
    begin_ball(&r, 1.333);
    const ssfr_ray ray = ray_towards((const double[3]){4, 5, 6}, (const double[3]){1, 0.2, 1.2});
    const ssfr_lit lit = follow(&r, &ray, false);
    begin_ball(&turned, 1.333);
    turned.w.normal_scale = -1;
    const ssfr_lit other = follow(&turned, &ray, false);
    assert_memory_equal(lit.colour, other.colour, sizeof lit.colour);
}

static void rays_that_graze_a_ball_see_the_sky(void **state)
{
    (void)state;
    for (double off = -1e-3; off >= -1e-15; off *= 0.1) {
        rig r;
        begin_ball(&r, 1.333);
        const double *c = r.w.centre[0];
        const ssfr_ray ray = {{c[0] + r.w.radius[0] * (1 + off), c[1], c[2] - 7}, {0, 0, 1}};
        const ssfr_lit lit = follow(&r, &ray, false);
        /* Nearly all is reflected, by twice the angle to the surface. */
        const double cosine = sqrt(-off * (2 + off));
        for (int k = 0; k < 3; k++) assert_close(lit.colour[k], patterned(ray.dir, k), 40 * cosine + 1e-12, 0);
    }
}

static ssfr_result lost(void *user, const ssfr_ray *ray, double to, bool inside, ssfr_crossing *out, bool *found)
{
    (void)user, (void)ray, (void)to, (void)inside, (void)out;
    *found = false;
    return SSFR_OK;
}

static void a_ray_that_finds_no_way_out_ends(void **state)
{
    rig r;
    (void)state;
    begin_ball(&r, 1.333);
    r.body.first = lost;
    for (int k = 0; k < 3; k++) r.body.absorption[k] = k;
    const ssfr_ray ray = ray_towards((const double[3]){4, 5, 6}, (const double[3]){1, 0.2, 1.2});
    const ssfr_lit lit = follow(&r, &ray, true);
    assert_true(lit.ended == 1 && lit.err == 1);
}

static ssfr_result broken(void *user, const ssfr_ray *ray, double to, bool inside, ssfr_crossing *out, bool *found)
{
    (void)user, (void)ray, (void)to, (void)inside, (void)out, (void)found;
    return ssfr_fail(SSFR_ERR_MEMORY, "no crossing of %d", 2385);
}

static ssfr_result broken_between(void *user, const ssfr_ray *ray, double from, double to, double colour[3],
                                  double *through, double *err)
{
    (void)user, (void)ray, (void)from, (void)to, (void)colour, (void)through, (void)err;
    return ssfr_fail(SSFR_ERR_MEMORY, "nothing floats for %d", 2385);
}

static void what_is_wrong_is_said(void **state)
{
    rig r;
    ssfr_lit lit;
    (void)state;
    begin_ball(&r, 1.333);
    const ssfr_ray ray = ray_towards((const double[3]){4, 5, 6}, (const double[3]){1, 0.2, 1.2});
#define FOLLOW(ray) ssfr_light_follow(&r.body, &r.around, &r.params, (ray), 0, false, &lit)
    static const double iors[] = {0, -1.333, NAN, INFINITY, 1001};
    for (size_t i = 0; i < SSFR_COUNT(iors); i++) {
        r.body.ior = iors[i];
        assert_fails(SSFR_ERR_VALUE, FOLLOW(&ray), "index of refraction");
    }
    r.body.ior = 1.333;
    r.body.absorption[1] = -0.385;
    assert_fails(SSFR_ERR_VALUE, FOLLOW(&ray), "absorption of -0.385 1/m");
    r.body.absorption[1] = NAN;
    assert_fails(SSFR_ERR_VALUE, FOLLOW(&ray), "absorption of");
    r.body.absorption[1] = 0;
    ssfr_ray bad = ray;
    bad.origin[2] = NAN;
    assert_fails(SSFR_ERR_VALUE, FOLLOW(&bad), "a ray from 4,5,");
    bad = ray, bad.dir[0] = 1.385;
    assert_fails(SSFR_ERR_VALUE, FOLLOW(&bad), "a ray along 1.385");
    r.params.depth = 65;
    assert_fails(SSFR_ERR_VALUE, FOLLOW(&ray), "path.depth=65: out of range");
    r.params.depth = 8, r.params.least = 0;
    assert_fails(SSFR_ERR_VALUE, FOLLOW(&ray), "path.least=0: out of range");
    r.params.least = 0.1, r.body.first = broken;
    assert_fails(SSFR_ERR_MEMORY, FOLLOW(&ray), "no crossing of 2385");
    r.body.first = first, r.body.between = broken_between;
    assert_fails(SSFR_ERR_MEMORY, FOLLOW(&ray), "nothing floats for 2385");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fresnel_is_that_of_sines_and_tangents),
        cmocka_unit_test(fresnel_at_normal_incidence_is_the_square_of_index_differences),
        cmocka_unit_test(at_brewsters_angle_half_of_the_light_is_not_reflected_at_all),
        cmocka_unit_test(fresnel_keeps_its_digits_where_indices_hardly_differ),
        cmocka_unit_test(grazing_light_is_reflected_whole),
        cmocka_unit_test(beyond_the_critical_angle_light_is_reflected_whole),
        cmocka_unit_test(light_is_reflected_alike_from_both_sides),
        cmocka_unit_test(refracted_rays_follow_snell_in_the_plane_of_incidence),
        cmocka_unit_test(reflected_rays_keep_what_is_along_the_surface),
        cmocka_unit_test(a_ray_refracted_twice_by_a_sphere_leaves_where_the_closed_form_says),
        cmocka_unit_test(background_reflections_are_the_papers_recursion),
        cmocka_unit_test(the_depth_of_background_reflections_is_that_of_the_papers_last_refraction),
        cmocka_unit_test(a_slab_moves_a_ray_aside_and_leaves_its_direction),
        cmocka_unit_test(a_slab_reflects_and_transmits_by_its_series),
        cmocka_unit_test(without_an_interface_only_absorption_is_left),
        cmocka_unit_test(a_cubes_corner_sends_light_back),
        cmocka_unit_test(light_that_is_caught_in_a_cube_ends_with_the_depth),
        cmocka_unit_test(light_that_is_reflected_whole_takes_the_sky_without_recursion),
        cmocka_unit_test(a_white_world_stays_white),
        cmocka_unit_test(what_escapes_is_absorbed_and_ends_is_all),
        cmocka_unit_test(the_error_is_a_bound_on_what_more_paths_would_change),
        cmocka_unit_test(no_path_goes_deeper_than_the_depth_or_on_with_less_than_the_least),
        cmocka_unit_test(a_floor_inside_the_water_ends_a_ray),
        cmocka_unit_test(what_floats_in_water_lies_within_its_bound),
        cmocka_unit_test(dark_and_bright_surroundings_bound_what_ends),
        cmocka_unit_test(what_floats_at_either_end_of_the_water_lies_within_its_bound),
        cmocka_unit_test(an_error_that_is_not_known_is_no_nan_where_nothing_is_seen),
        cmocka_unit_test(a_path_that_the_water_takes_ends_at_the_surface),
        cmocka_unit_test(as_many_paths_wait_as_the_depth_makes),
        cmocka_unit_test(degenerate_normals_and_rays_give_no_nan),
        cmocka_unit_test(a_normal_turned_away_is_turned_back),
        cmocka_unit_test(rays_that_graze_a_ball_see_the_sky),
        cmocka_unit_test(a_ray_that_finds_no_way_out_ends),
        cmocka_unit_test(what_is_wrong_is_said),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_solid.c: solids against their surfaces searched by brute force, inequalities, central differences and rays
 * walked step by step. */
#include "scene/solid.h"
#include "tests/util.h"

static const double pi = 3.14159265358979323846;

static const ssfr_solid upright = {.axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .half = {0.7, 0.4, 0.3}};

/* Turned about all three axes; the exact ratios of 2, 3 and 6 to 7 make the axes unit vectors. */
static ssfr_solid turned(ssfr_shape shape, double x, double y, double z, double inner)
{
    return (ssfr_solid){.shape = shape, .half = {x, y, z}, .inner = inner, .centre = {0.31, -0.22, 0.17},
                        .axis = {{2. / 7, 3. / 7, 6. / 7}, {3. / 7, -6. / 7, 2. / 7}, {6. / 7, 2. / 7, -3. / 7}}};
}

enum { N_SHAPES = 10 };

static ssfr_solid shape_at(int i)
{
    const ssfr_solid shapes[N_SHAPES] = {
        turned(SSFR_BOX, 0.7, 0.4, 0.3, 0),           turned(SSFR_BOX, 0.5, 0.5, 0.5, 0),
        turned(SSFR_CYLINDER, 0.6, 0.4, 0.6, 0),      turned(SSFR_CYLINDER, 0.2, 0.9, 0.2, 0),
        turned(SSFR_CYLINDER, 0.6, 0.4, 0.6, 0.45),   turned(SSFR_CYLINDER, 0.7, 0.15, 0.7, 0.1),
        turned(SSFR_SPHERE, 0.53, 0, 0, 0),           turned(SSFR_RAMP, 0.8, 0.3, 0.4, 0),
        turned(SSFR_RAMP, 0.3, 0.8, 0.2, 0),          turned(SSFR_PLANE, 0, 0, 0, 0),
    };
    return shapes[i];
}

static bool is_inside(const ssfr_solid *s, const double at[3])
{
    double p[3];
    ssfr_solid_local(s, at, p);
    const double rho = hypot(p[0], p[2]), *h = s->half;
    const bool in_box = fabs(p[0]) < h[0] && fabs(p[1]) < h[1] && fabs(p[2]) < h[2];
    switch (s->shape) {
    case SSFR_BOX: return in_box;
    case SSFR_CYLINDER: return rho < h[0] && fabs(p[1]) < h[1] && (s->inner == 0 || rho > s->inner);
    case SSFR_SPHERE: return hypot(rho, p[1]) < h[0];
    case SSFR_RAMP: return in_box && p[1] / h[1] < p[0] / h[0];
    default: return p[1] < 0;
    }
}

/* ---- the nearest point of the surface, searched ------------------------------------------------------------------ */

/* Patch i of the surface at u, v in [0, 1], in the solid's axes; false past the last patch. */
static bool patch_at(const ssfr_solid *s, int i, double u, double v, double p[3])
{
    const double a = 2 * pi * u, b = 2 * v - 1, c = 2 * u - 1, *h = s->half;
    const double r = s->inner + (h[0] - s->inner) * v, side = i % 2 ? 1 : -1;
    const int k = i / 2, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    switch (s->shape) {
    case SSFR_BOX:
        if (i < 6) p[k] = side * h[k], p[k1] = b * h[k1], p[k2] = c * h[k2];
        return i < 6;
    case SSFR_CYLINDER:
        if (i < 2) p[0] = r * cos(a), p[1] = side * h[1], p[2] = r * sin(a);
        if (i == 2) p[0] = h[0] * cos(a), p[1] = b * h[1], p[2] = h[0] * sin(a);
        if (i == 3) p[0] = s->inner * cos(a), p[1] = b * h[1], p[2] = s->inner * sin(a);
        return i < 3 + (s->inner > 0);
    case SSFR_SPHERE:
        p[0] = h[0] * sin(pi * v) * cos(a), p[1] = h[0] * cos(pi * v), p[2] = h[0] * sin(pi * v) * sin(a);
        return i < 1;
    case SSFR_RAMP: /* two triangles, each a square pulled together at one side, and three rectangles */
        if (i < 2) p[0] = c * h[0], p[1] = h[1] * (v * (c + 1) - 1), p[2] = side * h[2];
        if (i == 2) p[0] = c * h[0], p[1] = -h[1], p[2] = b * h[2];
        if (i == 3) p[0] = h[0], p[1] = c * h[1], p[2] = b * h[2];
        if (i == 4) p[0] = c * h[0], p[1] = c * h[1], p[2] = b * h[2];
        return i < 5;
    default:
        p[0] = 20 * c, p[1] = 0, p[2] = 20 * b;
        return i < 1;
    }
}

static double patch_distance(const ssfr_solid *s, int i, double u, double v, const double at[3])
{
    double p[3] = {0};
    patch_at(s, i, u, v, p);
    return sqrt(ssfr_square(p[0] - at[0]) + ssfr_square(p[1] - at[1]) + ssfr_square(p[2] - at[2]));
}

/* The best of a grid, then of a finer one around it, and so on. */
static double search_patch(const ssfr_solid *s, int i, const double at[3])
{
    enum { GRID = 10, LEVELS = 14 };
    const bool round = s->shape == SSFR_CYLINDER || s->shape == SSFR_SPHERE; /* u goes around */
    double best = INFINITY, bu = 0.5, bv = 0.5, size = 1;
    for (int level = 0; level < LEVELS; level++, size *= 0.4) {
        const double u = bu, v = bv;
        for (int k = 0; k < (GRID + 1) * (GRID + 1); k++) {
            const double from = u + size * (k % (GRID + 1) / (double)GRID - 0.5);
            const double tu = round ? from : ssfr_clamp(from, 0, 1);
            const double tv = ssfr_clamp(v + size * (k / (GRID + 1) / (double)GRID - 0.5), 0, 1);
            const double d = patch_distance(s, i, tu, tv, at);
            if (d < best) best = d, bu = tu, bv = tv;
        }
    }
    return best;
}

static double search(const ssfr_solid *s, const double at[3])
{
    double local[3], p[3], best = INFINITY;
    ssfr_solid_local(s, at, local);
    for (int i = 0; patch_at(s, i, 0, 0, p); i++) best = fmin(best, search_patch(s, i, local));
    return best;
}

static void distance_is_that_of_the_nearest_point_of_the_surface(void **state)
{
    (void)state;
    uint64_t seed = 2385;
    for (int i = 0; i < N_SHAPES; i++) {
        const ssfr_solid s = shape_at(i);
        int n_inside = 0;
        for (int n = 0; n < 100; n++) {
            double at[3], normal[3];
            for (int k = 0; k < 3; k++) at[k] = s.centre[k] + test_random(&seed, -1.2, 1.2);
            const double d = ssfr_solid_distance(&s, at, normal);
            assert_int_equal(d < 0, is_inside(&s, at));
            assert_close(fabs(d), search(&s, at), 1e-7, 0);
            n_inside += d < 0;
        }
        assert_true(n_inside > 0 && n_inside < 97);
    }
}

/* Rounding may put a corner before one of its own sides. */
static void a_ramps_corners_are_on_its_surface(void **state)
{
    (void)state;
    uint64_t seed = 23;
    for (int n = 0; n < 1000; n++) {
        const double a = test_random(&seed, 0.1, 2), b = test_random(&seed, 0.1, 2);
        const double corners[3][3] = {{-a, -b, 0.05}, {a, -b, 0.05}, {a, b, 0.05}};
        const ssfr_solid s = {.shape = SSFR_RAMP, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .half = {a, b, 0.1}};
        for (int i = 0; i < 3; i++) {
            double normal[3];
            assert_close(ssfr_solid_distance(&s, corners[i], normal), 0, 1e-15, 0);
            assert_close(ssfr_dot(normal, normal), 1, 1e-12, 0);
        }
    }
}

/* ---- the gradient ------------------------------------------------------------------------------------------------ */

/* On creases, where two places are equally near, differences see a mean of two gradients: shorter than one. */
static void normal_is_the_gradient(void **state)
{
    (void)state;
    const double h = 1e-6;
    uint64_t seed = 11;
    for (int i = 0; i < N_SHAPES; i++) {
        const ssfr_solid s = shape_at(i);
        int n_smooth = 0;
        for (int n = 0; n < 2000; n++) {
            double at[3], normal[3], gradient[3], other[3];
            for (int k = 0; k < 3; k++) at[k] = s.centre[k] + test_random(&seed, -1.2, 1.2);
            ssfr_solid_distance(&s, at, normal);
            assert_close(ssfr_dot(normal, normal), 1, 1e-12, 0);
            for (int k = 0; k < 3; k++) {
                double to[3] = {at[0], at[1], at[2]}, from[3] = {at[0], at[1], at[2]};
                to[k] += h, from[k] -= h;
                gradient[k] = (ssfr_solid_distance(&s, to, other) - ssfr_solid_distance(&s, from, other)) / (2 * h);
            }
            if (fabs(ssfr_dot(gradient, gradient) - 1) > 1e-6) continue;
            n_smooth++;
            for (int k = 0; k < 3; k++) assert_close(normal[k], gradient[k], 1e-4, 0);
        }
        assert_true(n_smooth > 1990);
    }
}

/* The place on the surface that normal and distance lead to is on it, and as far as they say. */
static void one_step_along_the_normal_leads_to_the_surface(void **state)
{
    (void)state;
    uint64_t seed = 7;
    for (int i = 0; i < N_SHAPES; i++) {
        const ssfr_solid s = shape_at(i);
        for (int n = 0; n < 2000; n++) {
            double at[3], to[3], normal[3], other[3];
            for (int k = 0; k < 3; k++) at[k] = s.centre[k] + test_random(&seed, -1.2, 1.2);
            const double d = ssfr_solid_distance(&s, at, normal);
            for (int k = 0; k < 3; k++) to[k] = at[k] - d * normal[k];
            assert_close(ssfr_solid_distance(&s, to, other), 0, 1e-13, 0);
        }
    }
}

/* ---- known values ------------------------------------------------------------------------------------------------ */

typedef struct known {
    ssfr_shape shape;
    double inner, at[3], d, normal[3]; /* a normal of zeros: any */
} known;

/* Half extents 0.7, 0.4, 0.3; of the cylinder 0.7, 0.4, 0.7. */
static void known_places_have_known_distances(void **state)
{
    (void)state;
    const double r = 1 / sqrt(2), slope = sqrt(0.65);
    const known list[] = {
        {SSFR_BOX, 0, {0, 0, 0}, -0.3, {0}},                            /* the centre, a tie of two faces */
        {SSFR_BOX, 0, {0.7, 0, 0}, 0, {1, 0, 0}},                       /* on a face */
        {SSFR_BOX, 0, {0.7, 0.4, 0.1}, 0, {0}},                         /* on an edge */
        {SSFR_BOX, 0, {-0.7, -0.4, -0.3}, 0, {0}},                      /* on a corner */
        {SSFR_BOX, 0, {1, 0.8, 0.1}, 0.5, {0.6, 0.8, 0}},               /* before an edge */
        {SSFR_BOX, 0, {-1.7, -2.4, 2.3}, 3, {-1. / 3, -2. / 3, 2. / 3}}, /* before a corner */
        {SSFR_BOX, 0, {0.65, 0.38, 0}, -0.02, {0, 1, 0}},
        {SSFR_CYLINDER, 0, {0, 0, 0}, -0.4, {0}},
        {SSFR_CYLINDER, 0, {0, 2.4, 0}, 2, {0, 1, 0}},      /* on the axis */
        {SSFR_CYLINDER, 0, {3, 0.2, 4}, 4.3, {0.6, 0, 0.8}},
        {SSFR_CYLINDER, 0, {-1, 0.8, 0}, 0.5, {-0.6, 0.8, 0}}, /* before the rim */
        {SSFR_CYLINDER, 0, {0, 0.4, 0.7}, 0, {0}},             /* on the rim */
        {SSFR_CYLINDER, 0.5, {0, 0, 0}, 0.5, {0}},             /* on the axis of a tube: every side of the hole */
        {SSFR_CYLINDER, 0.5, {0.2, 0.8, 0}, 0.5, {-0.6, 0.8, 0}},
        {SSFR_CYLINDER, 0.5, {0, 0.1, -0.3}, 0.2, {0, 0, 1}},
        {SSFR_CYLINDER, 0.5, {0.56, 0, 0}, -0.06, {-1, 0, 0}},
        {SSFR_CYLINDER, 0.5, {0, 0, 0.65}, -0.05, {0, 0, 1}},
        {SSFR_SPHERE, 0, {0, 0, 0}, -0.7, {0}},
        {SSFR_SPHERE, 0, {0, 0, -0.7}, 0, {0, 0, -1}},
        {SSFR_SPHERE, 0, {3, 4, 0}, 4.3, {0.6, 0.8, 0}},
        {SSFR_RAMP, 0, {0, 0, 0}, 0, {-0.4 / slope, 0.7 / slope, 0}}, /* in the middle of the slope */
        {SSFR_RAMP, 0, {-0.4, 0.7, 0}, slope, {-0.4 / slope, 0.7 / slope, 0}},
        {SSFR_RAMP, 0, {0, -0.6, 0.1}, 0.2, {0, -1, 0}},
        {SSFR_RAMP, 0, {0.9, 0, 0.1}, 0.2, {1, 0, 0}},
        {SSFR_RAMP, 0, {0.7 + 0.3, 0.4 + 0.4, 0}, 0.5, {0.6, 0.8, 0}}, /* before its crest */
        {SSFR_RAMP, 0, {-0.7 - 0.2, -0.4, 0}, 0.2, {-1, 0, 0}},        /* before its foot */
        {SSFR_RAMP, 0, {0.6, -0.3, 0.28}, -0.02, {0, 0, 1}},
        {SSFR_RAMP, 0, {0.8, 0, -0.4}, 0.1 * sqrt(2), {r, 0, -r}},
        {SSFR_PLANE, 0, {55, 2.385, -7}, 2.385, {0, 1, 0}},
        {SSFR_PLANE, 0, {55, -2.385, -7}, -2.385, {0, 1, 0}},
    };
    for (size_t i = 0; i < SSFR_COUNT(list); i++) {
        ssfr_solid s = upright;
        double normal[3];
        s.shape = list[i].shape, s.inner = list[i].inner;
        if (s.shape == SSFR_CYLINDER) s.half[2] = s.half[0];
        assert_close(ssfr_solid_distance(&s, list[i].at, normal), list[i].d, 1e-15, 1e-15);
        assert_close(ssfr_dot(normal, normal), 1, 1e-14, 0);
        for (int k = 0; k < 3 && ssfr_dot(list[i].normal, list[i].normal) > 0; k++)
            assert_close(normal[k], list[i].normal[k], 1e-13, 0);
    }
}

/* Places that a double cannot tell from an edge. */
static void normals_have_length_one_next_to_edges(void **state)
{
    (void)state;
    static const double by[] = {1e-300, 1e-170, 1e-155, 1e-100, 5e-17};
    for (int i = 0; i < N_SHAPES; i++)
        for (size_t k = 0; k < SSFR_COUNT(by); k++) {
            ssfr_solid s = shape_at(i);
            memcpy(s.axis, upright.axis, sizeof s.axis);
            memset(s.centre, 0, sizeof s.centre);
            const double at[3] = {s.half[0] + by[k], s.half[1] + by[k], by[k]};
            double normal[3];
            assert_true(isfinite(ssfr_solid_distance(&s, at, normal)));
            assert_close(ssfr_dot(normal, normal), 1, 1e-12, 0);
        }
}

/* All numbers are multiples of 2^-20 m: what a thousand kilometres are added to is held exactly. */
static void solids_a_thousand_kilometres_away_lose_no_digits(void **state)
{
    (void)state;
    static const double away[3] = {1e6, -1e6, 2e6}, dir[3] = {0.25, -0.5, 1};
    uint64_t seed = 5;
    for (int i = 0; i < N_SHAPES; i++)
        for (int n = 0; n < 200; n++) {
            ssfr_solid s = shape_at(i), far;
            double at[3], there[3], normal[3], far_normal[3];
            for (int k = 0; k < 3; k++) {
                s.centre[k] = round(s.centre[k] * 1048576) / 1048576;
                at[k] = round(test_random(&seed, -1.5, 1.5) * 1048576) / 1048576;
                there[k] = at[k] + away[k];
            }
            far = s;
            for (int k = 0; k < 3; k++) far.centre[k] += away[k];
            const double d = ssfr_solid_distance(&s, at, normal), e = ssfr_solid_distance(&far, there, far_normal);
            assert_true(d == e);
            assert_memory_equal(normal, far_normal, sizeof normal);
            assert_true(ssfr_solid_enter(&s, at, dir, normal) == ssfr_solid_enter(&far, there, dir, far_normal));
        }
}

/* ---- bounds ------------------------------------------------------------------------------------------------------ */

/* No point of the surface is outside, and each side is touched as closely as samples of the surface come. */
static void bounds_hold_the_solid_and_no_more(void **state)
{
    (void)state;
    enum { GRID = 200 };
    for (int i = 0; i < N_SHAPES - 1; i++) {
        const ssfr_solid s = shape_at(i);
        double lo[3], hi[3], least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
        double p[3], world[3];
        ssfr_solid_bounds(&s, lo, hi);
        for (int patch = 0; patch_at(&s, patch, 0, 0, p); patch++)
            for (int k = 0; k < (GRID + 1) * (GRID + 1); k++) {
                patch_at(&s, patch, k % (GRID + 1) / (double)GRID, k / (GRID + 1) / (double)GRID, p);
                ssfr_solid_world(&s, p, world);
                for (int j = 0; j < 3; j++) least[j] = fmin(least[j], world[j]), most[j] = fmax(most[j], world[j]);
            }
        for (int j = 0; j < 3; j++) {
            assert_true(lo[j] <= least[j] + 1e-12 && hi[j] >= most[j] - 1e-12);
            assert_close(lo[j], least[j], 2e-4, 0);
            assert_close(hi[j], most[j], 2e-4, 0);
        }
    }
}

static void a_plane_has_no_bounds(void **state)
{
    (void)state;
    const ssfr_solid s = shape_at(N_SHAPES - 1);
    double lo[3], hi[3];
    ssfr_solid_bounds(&s, lo, hi);
    for (int k = 0; k < 3; k++) assert_true(lo[k] == -INFINITY && hi[k] == INFINITY);
}

/* ---- rays -------------------------------------------------------------------------------------------------------- */

/* Walks the ray in small steps: the first from outside to inside; a negative number when there is none. */
static double walk(const ssfr_solid *s, const double o[3], const double d[3], double until)
{
    enum { STEPS = 800 };
    bool before = true;
    for (int i = 0; i <= STEPS; i++) {
        double lo = (i - 1) * until / STEPS, hi = i * until / STEPS;
        const double at[3] = {o[0] + hi * d[0], o[1] + hi * d[1], o[2] + hi * d[2]};
        const bool inside = is_inside(s, at);
        if (inside && !before) {
            for (int k = 0; k < 60; k++) {
                const double t = 0.5 * (lo + hi), p[3] = {o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
                if (is_inside(s, p)) hi = t;
                else lo = t;
            }
            return hi;
        }
        before = inside;
    }
    return -1;
}

static void along(const double o[3], const double d[3], double t, double p[3])
{
    for (int k = 0; k < 3; k++) p[k] = o[k] + t * d[k];
}

/* A walk may step over a corner that the ray only cuts; then the ray's own hit must be a place where it comes in. */
static void rays_enter_where_a_walk_along_them_does(void **state)
{
    (void)state;
    uint64_t seed = 2010;
    for (int i = 0; i < N_SHAPES; i++) {
        const ssfr_solid s = shape_at(i);
        int n_hits = 0, n_cut = 0, n_from_inside = 0;
        for (int n = 0; n < 3000; n++) {
            double o[3], d[3], normal[3], p[3], gradient[3];
            for (int k = 0; k < 3; k++) o[k] = s.centre[k] + test_random(&seed, -1.3, 1.3), d[k] = -o[k];
            for (int k = 0; k < 3; k++) d[k] += s.centre[k] + test_random(&seed, -0.8, 0.8);
            const double t = ssfr_solid_enter(&s, o, d, normal), expected = walk(&s, o, d, 4);
            n_from_inside += is_inside(&s, o);
            if (expected >= 0) assert_true(t > 0 && t < expected + 1e-9);
            if (t <= 0 || t > 4) continue;
            n_hits++;
            n_cut += !(fabs(t - expected) < 1e-9);
            along(o, d, t, p);
            assert_close(ssfr_solid_distance(&s, p, gradient), 0, 1e-13, 0);
            assert_close(ssfr_dot(normal, normal), 1, 1e-12, 0);
            assert_true(ssfr_dot(normal, d) < 0);
            along(o, d, t - 1e-7, p);
            assert_false(is_inside(&s, p));
            if (ssfr_solid_distance(&s, p, gradient) < 0.99e-7 * sqrt(ssfr_dot(d, d))) /* not towards an edge */
                assert_close(ssfr_dot(normal, gradient), 1, 1e-6, 0);
        }
        assert_true(n_hits > 300 && n_cut < 30 && n_from_inside > 10);
    }
}

/* A tube of radii 0.5 and 0.7 and half height 0.4. */
static void rays_meet_the_walls_of_a_tube(void **state)
{
    (void)state;
    static const struct {
        double o[3], d[3], t, normal[3];
    } rays[] = {
        {{-2, 0, 0}, {1, 0, 0}, 1.3, {-1, 0, 0}},        /* from outside */
        {{0, 0, 0}, {2, 0, 0}, 0.25, {-1, 0, 0}},        /* from the hole: the inner wall */
        {{0, 2, 0}, {0, -1, 0}, -1, {0}},                /* through the hole along the axis */
        {{0.6, 2, 0}, {0, -1, 0}, 1.6, {0, 1, 0}},       /* onto the top */
        {{0, 1.4, 0}, {0.75, -1.8, 0}, 2. / 3, {-1, 0, 0}}, /* down into the hole, onto the inner wall */
        {{0, 1.4, 0}, {0.75, -3, 0}, -1, {0}},           /* down into the hole and out again at the other end */
        {{-0.6, 0, 0}, {1, 0, 0}, 1.1, {-1, 0, 0}},      /* from within the wall: through the hole to the other side */
        {{0.6, 0, 0}, {1, 0, 0}, -1, {0}},               /* from within the wall and away */
        {{-2, 0, 0}, {-1, 0, 0}, -1, {0}},               /* behind the ray */
        {{-2, 0.5, 0}, {1, 0, 0}, -1, {0}},              /* over it */
        {{0.55, 0, -3}, {0, 0, 1}, 3 - 0.4330127018922193, {0.55 / 0.7, 0, -0.4330127018922193 / 0.7}},
    };
    ssfr_solid s = upright;
    s.shape = SSFR_CYLINDER, s.half[2] = 0.7, s.inner = 0.5;
    for (size_t i = 0; i < SSFR_COUNT(rays); i++) {
        double normal[3];
        const double t = ssfr_solid_enter(&s, rays[i].o, rays[i].d, normal);
        assert_close(t, rays[i].t, 1e-14, 0);
        for (int k = 0; k < 3 && rays[i].t > 0; k++) assert_close(normal[k], rays[i].normal[k], 1e-14, 0);
    }
}

/* From a hundred kilometres a metre is met to within what its place on the ray can be told. */
static void rays_from_far_away_meet_small_solids(void **state)
{
    (void)state;
    for (int i = 0; i < N_SHAPES - 1; i++) {
        const ssfr_solid s = shape_at(i);
        double local[3], p[3], o[3], d[3], normal[3], gradient[3];
        patch_at(&s, 0, 0.37, 0.61, local);
        ssfr_solid_world(&s, local, p);
        ssfr_solid_distance(&s, p, gradient);
        for (int k = 0; k < 3; k++) d[k] = -gradient[k] + 0.1 * (k == 1), o[k] = p[k] - 1e5 * d[k];
        assert_close(ssfr_solid_enter(&s, o, d, normal), 1e5, 1e-8, 0);
    }
}

/* ---- refusals ---------------------------------------------------------------------------------------------------- */

static void malformed_solids_are_refused(void **state)
{
    (void)state;
    static const double wrong[] = {0, -0.1, INFINITY, NAN};
    ssfr_solid s;
    for (int i = 0; i < N_SHAPES; i++) {
        s = shape_at(i);
        assert_int_equal(ssfr_solid_check(&s, "it"), SSFR_OK);
    }
    for (size_t i = 0; i < SSFR_COUNT(wrong); i++) {
        s = shape_at(0), s.half[2] = wrong[i];
        assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "tank.yaml:7"), "tank.yaml:7: half extents");
        s = shape_at(6), s.half[0] = wrong[i];
        assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "half extents");
    }
    s = shape_at(0), s.axis[1][1] = 1.1;
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "orthonormal");
    s = shape_at(0);
    for (int k = 0; k < 3; k++) s.axis[2][k] *= -1; /* left-handed */
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "right-handed");
    s = shape_at(0), s.axis[0][0] = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "orthonormal");
    s = shape_at(0), s.centre[1] = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "centre and colour");
    s = shape_at(0), s.colour[2] = INFINITY;
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "centre and colour");
    s = shape_at(2), s.half[2] = 0.61;
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "0.6 m along x and 0.61 m along z");
    s = shape_at(4), s.inner = 0.6;
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "inner radius 0.6 m");
    s = shape_at(4), s.inner = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "inner radius");
    s = shape_at(4), s.inner = -0.01;
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "inner radius");
    s = shape_at(0), s.shape = (ssfr_shape)(SSFR_MESH + 1);
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "shape 6");
    s = shape_at(0), s.shape = SSFR_MESH;
    assert_fails(SSFR_ERR_VALUE, ssfr_solid_check(&s, "it"), "no mesh");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distance_is_that_of_the_nearest_point_of_the_surface),
        cmocka_unit_test(a_ramps_corners_are_on_its_surface),
        cmocka_unit_test(normal_is_the_gradient),
        cmocka_unit_test(one_step_along_the_normal_leads_to_the_surface),
        cmocka_unit_test(known_places_have_known_distances),
        cmocka_unit_test(normals_have_length_one_next_to_edges),
        cmocka_unit_test(solids_a_thousand_kilometres_away_lose_no_digits),
        cmocka_unit_test(bounds_hold_the_solid_and_no_more),
        cmocka_unit_test(a_plane_has_no_bounds),
        cmocka_unit_test(rays_enter_where_a_walk_along_them_does),
        cmocka_unit_test(rays_meet_the_walls_of_a_tube),
        cmocka_unit_test(rays_from_far_away_meet_small_solids),
        cmocka_unit_test(malformed_solids_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_mesh.c: meshes against spheres and boxes, winding numbers, all triangles one by one, and files of all kinds. */
#include "scene/mesh.h"
#include "scene/solid.h"
#include "tests/meshes.h"

static const double pi = 3.14159265358979323846;

/* ---- truth by brute force ---------------------------------------------------------------------------------------- */

static const double *corner(const test_mesh *m, size_t i, int k)
{
    return m->vertices + 3 * m->triangles[3 * i + (size_t)k];
}

static void subtract(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

/* By the solid angles of all triangles (van Oosterom and Strackee 1983): 1 inside, 0 outside. */
static double winding(const test_mesh *m, const double p[3])
{
    double sum = 0;
    for (size_t i = 0; i < m->n_triangles; i++) {
        double a[3], b[3], c[3], bc[3];
        subtract(corner(m, i, 0), p, a), subtract(corner(m, i, 1), p, b), subtract(corner(m, i, 2), p, c);
        ssfr_cross(b, c, bc);
        const double la = sqrt(ssfr_dot(a, a)), lb = sqrt(ssfr_dot(b, b)), lc = sqrt(ssfr_dot(c, c));
        sum += 2 * atan2(ssfr_dot(a, bc),
                         la * lb * lc + ssfr_dot(a, b) * lc + ssfr_dot(b, c) * la + ssfr_dot(c, a) * lb);
    }
    return sum / (4 * pi);
}

static double to_segment(const double a[3], const double b[3], const double p[3])
{
    double ab[3], ap[3];
    subtract(b, a, ab), subtract(p, a, ap);
    const double t = ssfr_clamp(ssfr_dot(ab, ap) / ssfr_dot(ab, ab), 0, 1);
    for (int k = 0; k < 3; k++) ap[k] -= t * ab[k];
    return sqrt(ssfr_dot(ap, ap));
}

/* The nearest of three sides, or the plane where the place stands over the triangle. */
static double to_triangle(const double a[3], const double b[3], const double c[3], const double p[3])
{
    const double *at[3] = {a, b, c};
    double ab[3], ac[3], ap[3], n[3], nearest = INFINITY;
    bool over = true;
    subtract(b, a, ab), subtract(c, a, ac), subtract(p, a, ap);
    ssfr_cross(ab, ac, n);
    ssfr_normalize(n);
    for (int k = 0; k < 3; k++) {
        double side[3], to[3], inwards[3];
        subtract(at[(k + 1) % 3], at[k], side), subtract(p, at[k], to);
        ssfr_cross(n, side, inwards);
        over = over && ssfr_dot(inwards, to) >= 0;
        nearest = fmin(nearest, to_segment(at[k], at[(k + 1) % 3], p));
    }
    return over ? fabs(ssfr_dot(n, ap)) : nearest;
}

static double to_all(const test_mesh *m, const double p[3])
{
    double nearest = INFINITY;
    for (size_t i = 0; i < m->n_triangles; i++)
        nearest = fmin(nearest, to_triangle(corner(m, i, 0), corner(m, i, 1), corner(m, i, 2), p));
    return nearest;
}

/* The first triangle that a ray meets from its front, by Cramer's rule. */
static double enter_all(const test_mesh *m, const double o[3], const double d[3])
{
    double first = INFINITY;
    for (size_t i = 0; i < m->n_triangles; i++) {
        double e[3], f[3], s[3], df[3], se[3];
        subtract(corner(m, i, 1), corner(m, i, 0), e), subtract(corner(m, i, 2), corner(m, i, 0), f);
        subtract(o, corner(m, i, 0), s);
        ssfr_cross(d, f, df), ssfr_cross(s, e, se);
        const double det = ssfr_dot(e, df), u = ssfr_dot(s, df) / det, v = ssfr_dot(d, se) / det;
        const double t = ssfr_dot(f, se) / det;
        if (det > 0 && u >= 0 && v >= 0 && u + v <= 1 && t > 0) first = fmin(first, t);
    }
    return isinf(first) ? -1 : first;
}

/* ---- distances --------------------------------------------------------------------------------------------------- */

static void random_place(uint64_t *seed, double size, double p[3])
{
    for (int k = 0; k < 3; k++) p[k] = test_random(seed, -size, size);
}

/* The triangles hang inside of the sphere: by their height at most. */
static void a_sphere_of_triangles_is_as_near_as_the_sphere(void **state)
{
    (void)state;
    const double radius = 0.53;
    test_mesh m = test_mesh_sphere(4, radius);
    ssfr_mesh *mesh = test_mesh_make(&m);
    uint64_t seed = 3;
    double sag = 0;
    for (size_t i = 0; i < m.n_triangles; i++) {
        double middle[3];
        for (int k = 0; k < 3; k++)
            middle[k] = (corner(&m, i, 0)[k] + corner(&m, i, 1)[k] + corner(&m, i, 2)[k]) / 3;
        sag = fmax(sag, radius - sqrt(ssfr_dot(middle, middle)));
    }
    assert_true(m.n_triangles == 5120 && sag > 1e-4 && sag < 1e-3);
    for (int i = 0; i < 5000; i++) {
        double p[3], normal[3], out[3];
        random_place(&seed, 0.9, p);
        memcpy(out, p, sizeof out);
        const double r = ssfr_normalize(out), d = ssfr_mesh_distance(mesh, p, normal);
        assert_true(d >= r - radius - 1e-14 && d <= r - radius + 1.1 * sag);
        assert_close(ssfr_dot(normal, normal), 1, 1e-12, 0);
        if (r > 0.2) assert_true(ssfr_dot(normal, out) > cos(0.1));
    }
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

static void a_box_of_triangles_is_the_box(void **state)
{
    (void)state;
    const ssfr_solid box = {.shape = SSFR_BOX, .half = {0.7, 0.4, 0.3}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    test_mesh m = test_mesh_box(0.7, 0.4, 0.3);
    ssfr_mesh *mesh = test_mesh_make(&m);
    uint64_t seed = 4;
    for (int i = 0; i < 5000; i++) {
        double p[3], q[3], d[3], normal[3], expected[3];
        random_place(&seed, 1, p);
        if (i % 4 == 0) p[i / 4 % 3] = i / 12 % 2 ? box.half[i / 4 % 3] : 0; /* on a face's plane, or in the middle */
        const double known = ssfr_solid_distance(&box, p, expected);
        assert_close(ssfr_mesh_distance(mesh, p, normal), known, 1e-14, 0);
        if (known > 1e-12)
            for (int k = 0; k < 3; k++) assert_close(normal[k], expected[k], 1e-12, 0);
        random_place(&seed, 1, q);
        subtract(q, p, d);
        const double t = ssfr_solid_enter(&box, p, d, expected);
        if (i % 4) assert_close(ssfr_mesh_enter(mesh, p, d, normal), t, 1e-13, 1e-13);
        for (int k = 0; k < 3 && t > 0 && i % 4; k++) assert_close(normal[k], expected[k], 1e-14, 0);
    }
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

/* Thorns as sharp as needles, and two bodies apart from each other. */
static test_mesh concave(void)
{
    test_mesh ball = test_mesh_thorns(2, 0.15, 0.9), box = test_mesh_box(0.2, 0.3, 0.1);
    test_mesh both = test_mesh_join(&ball, &box, (const double[3]){1.1, 0.2, -0.3});
    test_mesh_finish(&ball), test_mesh_finish(&box);
    return both;
}

static void distances_to_a_concave_mesh_are_those_to_all_its_triangles(void **state)
{
    (void)state;
    test_mesh m = concave();
    ssfr_mesh *mesh = test_mesh_make(&m);
    uint64_t seed = 5;
    int n_inside = 0, n_smooth = 0;
    for (int i = 0; i < 3000; i++) {
        double p[3], normal[3], to[3], other[3];
        random_place(&seed, 1.3, p);
        const double d = ssfr_mesh_distance(mesh, p, normal), turns = winding(&m, p);
        assert_close(fabs(d), to_all(&m, p), 1e-13, 0);
        assert_close(turns, d < 0, 1e-9, 0);
        n_inside += d < 0;
        for (int k = 0; k < 3; k++) to[k] = p[k] - d * normal[k];
        assert_close(ssfr_mesh_distance(mesh, to, other), 0, 1e-13, 0);
        for (int k = 0; k < 3; k++) to[k] = p[k] + 1e-6 * normal[k];
        n_smooth += fabs(ssfr_mesh_distance(mesh, to, other) - d - 1e-6) < 1e-9;
    }
    assert_true(n_inside > 100 && n_inside < 2900 && n_smooth > 2950);
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

/* Just beside each vertex, each edge and each face: there the naive sign, by any nearest triangle, is wrong. */
static void signs_are_right_at_every_thorn(void **state)
{
    (void)state;
    test_mesh m = concave();
    ssfr_mesh *mesh = test_mesh_make(&m);
    uint64_t seed = 6;
    int n_inside = 0;
    for (size_t i = 0; i < 12 * m.n_triangles; i++) {
        const double *a = corner(&m, i % m.n_triangles, 0), *b = corner(&m, i % m.n_triangles, 1);
        const double *c = corner(&m, i % m.n_triangles, 2), share = i / m.n_triangles % 3 == 0 ? 0 : 0.3;
        const double other = i / m.n_triangles % 3 == 2 ? 0.3 : 0;
        double p[3], normal[3];
        for (int k = 0; k < 3; k++)
            p[k] = a[k] + share * (b[k] - a[k]) + other * (c[k] - a[k]) + test_random(&seed, -1e-3, 1e-3);
        const double d = ssfr_mesh_distance(mesh, p, normal);
        assert_close(winding(&m, p), d < 0, 1e-6, 0);
        n_inside += d < 0;
    }
    assert_true(n_inside > 500);
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

static void vertices_are_at_no_distance_and_have_unit_normals(void **state)
{
    (void)state;
    test_mesh m = concave();
    ssfr_mesh *mesh = test_mesh_make(&m);
    for (size_t i = 0; i < m.n_vertices; i++) {
        double normal[3];
        assert_close(ssfr_mesh_distance(mesh, m.vertices + 3 * i, normal), 0, 1e-15, 0);
        assert_close(ssfr_dot(normal, normal), 1, 1e-12, 0);
    }
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

/* Boxes in one place, which no plane can part, and boxes each half as large as the one before, which planes part one by
 * one: both need halving by number. */
static void trees_of_equal_and_of_ever_smaller_triangles_are_searched(void **state)
{
    (void)state;
    enum { N_EQUAL = 9, N_SMALLER = 60 };
    test_mesh m = test_mesh_box(0.2, 0.2, 0.2);
    uint64_t seed = 16;
    for (int i = 1; i < N_EQUAL + N_SMALLER; i++) {
        const double half = i < N_EQUAL ? 0.2 : 0.2 * pow(0.5, i - N_EQUAL), x = i < N_EQUAL ? 0 : 4 * half;
        test_mesh one = test_mesh_box(half, half, half), more = test_mesh_join(&m, &one, (const double[3]){x, 0, 0});
        test_mesh_finish(&m), test_mesh_finish(&one);
        m = more;
    }
    ssfr_mesh *mesh = test_mesh_make(&m);
    for (int i = 0; i < 500; i++) {
        double p[3], q[3], d[3], normal[3];
        random_place(&seed, i % 2 ? 1.2 : 0.4, p), random_place(&seed, 0.4, q);
        assert_close(fabs(ssfr_mesh_distance(mesh, p, normal)), to_all(&m, p), 1e-12, 0);
        subtract(q, p, d);
        const double t = ssfr_mesh_enter(mesh, p, d, normal);
        assert_close(t, enter_all(&m, p, d), 1e-11, 1e-11);
    }
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

/* ---- rays -------------------------------------------------------------------------------------------------------- */

static void rays_enter_where_the_first_of_all_triangles_is(void **state)
{
    (void)state;
    test_mesh m = concave();
    ssfr_mesh *mesh = test_mesh_make(&m);
    uint64_t seed = 8;
    int n_hits = 0, n_misses = 0;
    for (int i = 0; i < 10000; i++) {
        double o[3], q[3], d[3], normal[3];
        random_place(&seed, 1.5, o), random_place(&seed, 1, q);
        subtract(q, o, d);
        const double expected = enter_all(&m, o, d), t = ssfr_mesh_enter(mesh, o, d, normal);
        assert_close(t, expected, 1e-11, 1e-11);
        if (t > 0) assert_true(ssfr_dot(normal, d) < 0 && fabs(ssfr_dot(normal, normal) - 1) < 1e-12);
        n_hits += t > 0, n_misses += t < 0;
    }
    assert_true(n_hits > 1000 && n_misses > 1000);
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

/* Aimed at vertices and at places on edges, where a ray could slip between triangles; along the axes too. */
static void no_ray_slips_through_edges_or_corners(void **state)
{
    (void)state;
    test_mesh m = test_mesh_sphere(3, 0.53);
    ssfr_mesh *mesh = test_mesh_make(&m);
    uint64_t seed = 9;
    for (size_t i = 0; i < 4 * m.n_triangles; i++) {
        const double *a = corner(&m, i % m.n_triangles, 0), *b = corner(&m, i % m.n_triangles, 1);
        const double share = i < m.n_triangles ? 0 : test_random(&seed, 0, 1);
        double o[3], at[3], d[3], normal[3];
        random_place(&seed, 0.4, o);
        for (int k = 0; k < 3; k++) at[k] = a[k] + share * (b[k] - a[k]), o[k] += 3 * at[k];
        const size_t axis = i / 5 % 3;
        if (i % 5 == 0 && fabs(at[axis]) > 0.2) { /* straight down an axis, and not along the surface */
            memcpy(o, at, sizeof o);
            o[axis] = at[axis] < 0 ? -2 : 2;
        }
        subtract(at, o, d);
        assert_close(ssfr_mesh_enter(mesh, o, d, normal), 1, 0.2, 0);
    }
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

static void rays_from_inside_do_not_enter_a_convex_mesh(void **state)
{
    (void)state;
    test_mesh m = test_mesh_sphere(2, 0.53);
    ssfr_mesh *mesh = test_mesh_make(&m);
    uint64_t seed = 10;
    for (int i = 0; i < 1000; i++) {
        double o[3], d[3], normal[3];
        random_place(&seed, 0.25, o), random_place(&seed, 1, d);
        assert_true(ssfr_mesh_enter(mesh, o, d, normal) < 0);
    }
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

/* ---- as a solid -------------------------------------------------------------------------------------------------- */

static void a_solid_of_a_mesh_is_turned_and_moved(void **state)
{
    (void)state;
    test_mesh m = test_mesh_box(0.7, 0.4, 0.3);
    ssfr_mesh *mesh = test_mesh_make(&m);
    ssfr_solid box = {.shape = SSFR_BOX, .half = {0.7, 0.4, 0.3}, .centre = {1e6, -1e6, 3},
                      .axis = {{2. / 7, 3. / 7, 6. / 7}, {3. / 7, -6. / 7, 2. / 7}, {6. / 7, 2. / 7, -3. / 7}}};
    ssfr_solid solid = box;
    solid.shape = SSFR_MESH, solid.mesh = mesh;
    assert_int_equal(ssfr_solid_check(&solid, "it"), SSFR_OK);
    uint64_t seed = 12;
    double lo[3], hi[3], box_lo[3], box_hi[3];
    ssfr_solid_bounds(&solid, lo, hi);
    ssfr_solid_bounds(&box, box_lo, box_hi);
    for (int k = 0; k < 3; k++) assert_close(lo[k], box_lo[k], 1e-9, 0), assert_close(hi[k], box_hi[k], 1e-9, 0);
    for (int i = 0; i < 1000; i++) {
        double p[3], d[3], normal[3], expected[3];
        random_place(&seed, 1, p), random_place(&seed, 1, d);
        for (int k = 0; k < 3; k++) p[k] += box.centre[k];
        assert_close(ssfr_solid_distance(&solid, p, normal), ssfr_solid_distance(&box, p, expected), 1e-13, 0);
        assert_close(ssfr_solid_enter(&solid, p, d, normal), ssfr_solid_enter(&box, p, d, expected), 1e-12, 1e-12);
    }
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

static void serials_differ(void **state)
{
    (void)state;
    test_mesh m = test_mesh_box(0.7, 0.4, 0.3);
    ssfr_mesh *a = test_mesh_make(&m), *b = test_mesh_make(&m);
    assert_true(a->serial && b->serial && a->serial != b->serial);
    ssfr_mesh_destroy(&a), ssfr_mesh_destroy(&b);
    assert_null(a);
    ssfr_mesh_destroy(&a); /* nothing there */
    test_mesh_finish(&m);
}

/* ---- what is no closed surface ----------------------------------------------------------------------------------- */

static void refuse(const test_mesh *m, ssfr_result code, const char *text)
{
    ssfr_mesh *mesh = (ssfr_mesh *)m;
    assert_fails(code, ssfr_mesh_create(&mesh, m->n_vertices, m->vertices, m->n_triangles, m->triangles), text);
    assert_null(mesh);
}

static void surfaces_with_faults_are_refused_with_their_counts(void **state)
{
    (void)state;
    test_mesh m = test_mesh_box(0.7, 0.4, 0.3), two;
    m.n_triangles = 11;
    refuse(&m, SSFR_ERR_VALUE, "mesh: 3 open edges: a closed surface is needed");
    m.n_triangles = 12;
    memcpy(m.triangles + 33, m.triangles, 3 * sizeof *m.triangles); /* one twice, one missing: 3 open, 3 crowded */
    refuse(&m, SSFR_ERR_VALUE, "3 open edges, 3 edges of more than two triangles");
    test_mesh_finish(&m);
    m = test_mesh_box(0.7, 0.4, 0.3);
    m.triangles[34] = 5, m.triangles[35] = 7; /* turned over */
    refuse(&m, SSFR_ERR_VALUE, "3 edges between triangles that face opposite ways: a");
    test_mesh_finish(&m);
    m = test_mesh_box(0.7, 0.4, 0.3);
    m.triangles[1] = m.triangles[0];
    refuse(&m, SSFR_ERR_VALUE, "1 degenerate triangle");
    test_mesh_finish(&m);
    m = test_mesh_sphere(0, 1);
    for (int k = 0; k < 3; k++) /* a vertex in the middle between two others of a triangle */
        m.vertices[3 * m.triangles[0] + (uint32_t)k] =
            0.5 * (m.vertices[3 * m.triangles[1] + (uint32_t)k] + m.vertices[3 * m.triangles[2] + (uint32_t)k]);
    refuse(&m, SSFR_ERR_VALUE, "mesh: 1 degenerate triangle: a closed surface is needed");
    m.triangles[7] = 12;
    refuse(&m, SSFR_ERR_VALUE, "triangle 2 (from 0) has a corner at vertex 12 of 12");
    m.triangles[7] = UINT32_MAX;
    refuse(&m, SSFR_ERR_VALUE, "4294967295 of 12");
    m.vertices[4] = NAN;
    refuse(&m, SSFR_ERR_VALUE, "vertex 1 (from 0) has the coordinate nan");
    m.vertices[4] = 2e9;
    refuse(&m, SSFR_ERR_VALUE, "coordinate 2e+09 m");
    m.n_triangles = 0;
    refuse(&m, SSFR_ERR_VALUE, "no triangles");
    m.n_triangles = 20;
    test_mesh_finish(&m);
    const uint32_t back_to_back[] = {0, 1, 2, 0, 2, 1};
    double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    two = (test_mesh){.n_vertices = 3, .vertices = corners, .n_triangles = 2, .triangles = (uint32_t *)back_to_back};
    refuse(&two, SSFR_ERR_VALUE, "encloses no volume");
}

static void a_surface_inside_out_is_turned(void **state)
{
    (void)state;
    test_mesh m = test_mesh_sphere(2, 0.53);
    for (size_t i = 0; i < m.n_triangles; i++) {
        const uint32_t first = m.triangles[3 * i];
        m.triangles[3 * i] = m.triangles[3 * i + 1], m.triangles[3 * i + 1] = first;
    }
    ssfr_mesh *mesh = test_mesh_make(&m);
    double normal[3];
    assert_close(ssfr_mesh_distance(mesh, (const double[3]){0, 0, 0}, normal), -0.53, 0.02, 0);
    assert_close(ssfr_mesh_distance(mesh, (const double[3]){0, 0, 2}, normal), 1.47, 0.02, 0);
    assert_true(normal[2] > 0.9);
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static const char *const endings[] = {".obj", ".stl", ".txt.stl", ".ply", ".txt.ply"};

static ssfr_mesh *load(const char *path)
{
    ssfr_mesh *mesh;
    assert_int_equal(ssfr_mesh_load(&mesh, path), SSFR_OK);
    return mesh;
}

/* STL holds floats, and a vertex as often as it is used. */
static void every_format_holds_the_same_mesh(void **state)
{
    (void)state;
    test_mesh m = concave();
    ssfr_mesh *mesh = test_mesh_make(&m);
    for (size_t e = 0; e < SSFR_COUNT(endings); e++) {
        ssfr_mesh *loaded = load(test_mesh_write(&m, endings[e]));
        const bool floats = strstr(endings[e], "stl");
        uint64_t seed = 13;
        assert_int_equal(loaded->n_triangles, m.n_triangles);
        for (int i = 0; i < 200; i++) {
            double p[3], normal[3];
            random_place(&seed, 1.3, p);
            const double d = ssfr_mesh_distance(mesh, p, normal);
            assert_close(ssfr_mesh_distance(loaded, p, normal), d, floats ? 1e-7 : 0, 0);
        }
        ssfr_mesh_destroy(&loaded);
    }
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&m);
}

static const char *text_file(const char *ending, const char *text)
{
    char name[64];
    static int n;
    snprintf(name, sizeof name, "text%d%s", n++, ending);
    const char *path = test_path(name);
    test_write_file(path, text, strlen(text));
    return path;
}

/* An L, 1 m deep: its caps are concave hexagons, whose fans from the first corner would fold over. */
#define L_VERTICES                                                                            \
    "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nv 0 0 0\n"                                  \
    "v 2 0 -1\nv 2 1 -1\nv 1 1 -1\nv 1 3 -1\nv 0 3 -1\nv 0 0 -1\n"
#define L_SIDES "f 1 7 8 2\nf 2 8 9 3\nf 3 9 10 4\nf 4 10 11 5\nf 5 11 12 6\nf 6 12 7 1\n"

static void concave_polygons_are_cut_within_them(void **state)
{
    (void)state;
    static const char *const caps[] = {"f 1 2 3 4 5 6\nf 12 11 10 9 8 7\n", "f 4 5 6 1 2 3\nf 8 7 12 11 10 9\n",
                                       "f 5 6 1 2 3 4\nf -1 -2 -3 -4 -5 -6\n"};
    for (size_t i = 0; i < SSFR_COUNT(caps); i++) {
        char text[1024];
        snprintf(text, sizeof text, L_VERTICES L_SIDES "%s", caps[i]);
        ssfr_mesh *mesh = load(text_file(".obj", text));
        double normal[3];
        uint64_t seed = 14;
        assert_int_equal(mesh->n_triangles, 20);
        for (int k = 0; k < 500; k++) {
            const double p[3] = {test_random(&seed, -1, 3), test_random(&seed, -1, 4), test_random(&seed, -2, 1)};
            const bool low = p[0] < 2 && p[1] < 1, high = p[0] < 1 && p[1] < 3;
            const bool inside = (low || high) && p[0] > 0 && p[1] > 0 && p[2] > -1 && p[2] < 0;
            assert_int_equal(ssfr_mesh_distance(mesh, p, normal) < 0, inside);
        }
        ssfr_mesh_destroy(&mesh);
    }
}

static void loading_says_what_is_wrong_with_a_surface(void **state)
{
    (void)state;
    ssfr_mesh *mesh;
    const char *open = text_file(".obj", L_VERTICES L_SIDES "f 1 2 3 4 5 6\n");
    assert_fails(SSFR_ERR_VALUE, ssfr_mesh_load(&mesh, open), ".obj: 6 open edges: a closed surface is needed");
    assert_null(mesh);
    assert_fails(SSFR_ERR_VALUE, ssfr_mesh_load(&mesh, text_file(".obj", "v 0 0 0\n")), "no triangles");
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_mesh_load(&mesh, "ship.blend"), "ship.blend: the names of meshes end in");
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_mesh_load(&mesh, "ship"), "end in .obj .stl .ply");
    assert_fails(SSFR_ERR_IO, ssfr_mesh_load(&mesh, "/nowhere/ship.obj"), "/nowhere/ship.obj");
}

#define PLY_HEAD(vertices, faces)                                                                                     \
    "ply\nformat ascii 1.0\nelement vertex " vertices "\nproperty float x\nproperty float y\nproperty float z\n"      \
    "element face " faces "\nproperty list uchar int vertex_indices\nend_header\n"

static void malformed_files_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *ending, *text;
        ssfr_result code;
        const char *says;
    } cases[] = {
        {".obj", "v 1 2\n", SSFR_ERR_FORMAT, ":1: expected three coordinates, the line ends"},
        {".obj", "v 1 2 x\n", SSFR_ERR_FORMAT, "found \"x\""},
        {".obj", "v 1 2 3\nv 1 2 nan\n", SSFR_ERR_VALUE, "vertex 1 (from 0) has the coordinate nan"},
        {".obj", "v 1 2 inf\n", SSFR_ERR_VALUE, "coordinate inf"},
        {".obj", "v 1 2 1e300\nv 1 2 3\nv 2 3 1\nf 1 2 3\n", SSFR_ERR_VALUE, "coordinate 1e+300 m"},
        {".obj", "\nv 1 2 3\nf 1 2 3\n", SSFR_ERR_FORMAT, ":3: vertex 2 of the 1 that there are so far"},
        {".obj", "v 1 2 3\nf 0 1 1\n", SSFR_ERR_FORMAT, "vertex 0 of"},
        {".obj", "v 1 2 3\nf -2 1 1\n", SSFR_ERR_FORMAT, "vertex -2 of"},
        {".obj", "v 1 2 3\nf 99999999999999999999 1 1\n", SSFR_ERR_FORMAT, "vertex 9223372036854775807 of"},
        {".obj", "v 1 2 3\nf 1 one 1\n", SSFR_ERR_FORMAT, "expected a vertex's index, found \"one\""},
        {".obj", "v 1 2 3\nf 1 1\n", SSFR_ERR_FORMAT, "expected at least three corners, the line ends"},
        {".obj", "v 1 2 3\nf\n", SSFR_ERR_FORMAT, "at least three corners"},
        {".obj", "cstype bezier\n", SSFR_ERR_UNSUPPORTED, ":1: cstype: only polygons"},
        {".obj", "", SSFR_ERR_VALUE, "no triangles"},
        {".stl", "", SSFR_ERR_FORMAT, "neither solid nor a header of 80 bytes"},
        {".stl", "solid x\nfacet normal 0 0\n", SSFR_ERR_FORMAT, ":3: expected normal and three numbers, the"},
        {".stl", "solid x\nfacet normal 0 0 1\nvertex 1 2 3\n", SSFR_ERR_FORMAT,
         ":3: expected outer loop, found \"vertex\""},
        {".stl", "solid x\nfacet normal 0 0 1 outer loop\nvertex 1 2\n", SSFR_ERR_FORMAT, "vertex and three numbers"},
        {".stl", "solid x\nfacet normal 0 0 1 outer loop vertex 1 2 3 vertex 1 2 3 vertex 1 2 3 vertex 1 2 3\n",
         SSFR_ERR_FORMAT, "facets have three corners"},
        {".stl", "solid x\nfacet normal 0 0 1 outer loop vertex 1 2 3 vertex 1 2 3 vertex 1 2 3 endloop\n",
         SSFR_ERR_FORMAT, "expected endfacet, the file ends"},
        {".stl", "solid x\nface\n", SSFR_ERR_FORMAT, ":2: expected facet or endsolid, found \"face\""},
        {".stl", "solid x\nendsolid x\nmore\n", SSFR_ERR_FORMAT, ":3: expected solid, found \"more\""},
        {".stl", "solid x\nendsolid x\n", SSFR_ERR_VALUE, "no triangles"},
        {".stl", "a header of eighty bytes that goes on for so long that there is room for a count of triangles....\n",
         SSFR_ERR_FORMAT, "triangles of 50 bytes are announced, but"},
        {".ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n",
         SSFR_ERR_FORMAT, "expected one x, y and z"},
        {".ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
                 "end_header\n", SSFR_ERR_FORMAT, "no face element"},
        {".ply", "ply\nformat ascii 1.0\nelement face 1\nproperty uchar red\nend_header\n1\n", SSFR_ERR_FORMAT,
         "the faces lack a list"},
        {".ply", PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", SSFR_ERR_FORMAT,
         "face 0 (from 0): vertex 3 of 3"},
        {".ply", PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", SSFR_ERR_FORMAT, "vertex -1 of 3"},
        {".ply", PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n", SSFR_ERR_FORMAT, "vertex 1.5 of 3"},
        {".ply", PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n2 0 1\n", SSFR_ERR_FORMAT, "face 0 (from 0): 2 corners"},
        {".ply", PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", SSFR_ERR_VALUE, "coordinate nan"},
        {".ply", PLY_HEAD("1", "1") "0 0 0\n4097 0 0\n", SSFR_ERR_UNSUPPORTED, "4097 corners, at most 4096"},
        {".ply", PLY_HEAD("3", "2") "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", SSFR_ERR_FORMAT, "face 1 (from 0)"},
        {".ply", PLY_HEAD("999999999999", "1") "0 0 0\n", SSFR_ERR_FORMAT, "999999999999 vertices of at least"},
        {".ply", PLY_HEAD("1", "999999999999") "0 0 0\n", SSFR_ERR_FORMAT, "999999999999 faces of at least"},
        {".ply", PLY_HEAD("1", "1") "0 0 0\n4000 0 0\n", SSFR_ERR_FORMAT, "the list is longer than what follows"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_mesh *mesh;
        assert_fails(cases[i].code, ssfr_mesh_load(&mesh, text_file(cases[i].ending, cases[i].text)), cases[i].says);
        assert_null(mesh);
    }
}

static void a_polygon_of_very_many_corners_is_refused(void **state)
{
    (void)state;
    enum { N = 5000 };
    char *text = calloc(N, 4);
    ssfr_mesh *mesh;
    assert_non_null(text);
    strcpy(text, "v 1 2 3\nf");
    for (size_t i = 0, at = strlen(text); i < N; i++, at += 2) memcpy(text + at, " 1", 2);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_mesh_load(&mesh, text_file(".obj", text)), "more than 4096 corners");
    free(text);
}

/* A count that no memory holds, in a file of a hundred bytes. */
static void absurd_counts_allocate_nothing(void **state)
{
    (void)state;
    char bytes[134] = "a header";
    ssfr_mesh *mesh;
    const char *path = test_path("absurd.stl");
    memset(bytes + 80, 0xff, 4);
    test_write_file(path, bytes, sizeof bytes);
    assert_fails(SSFR_ERR_FORMAT, ssfr_mesh_load(&mesh, path), "4294967295 triangles of 50 bytes are announced");
}

/* Cut at many places, every file is an error in one line, or a mesh where only blanks are gone. */
static void truncated_files_are_refused(void **state)
{
    (void)state;
    test_mesh m = test_mesh_box(0.7, 0.4, 0.3);
    for (size_t e = 0; e < SSFR_COUNT(endings); e++) {
        const char *path = test_mesh_write(&m, endings[e]), *cut = test_mesh_write(&m, endings[e]);
        char *bytes;
        size_t size;
        assert_int_equal(ssfr_read_file(path, 1 << 20, &bytes, &size), SSFR_OK);
        for (size_t n = 0; n < size; n += n < 200 ? 1 : 7) {
            ssfr_mesh *mesh;
            test_write_file(cut, bytes, n);
            test_clear_log();
            const ssfr_result result = ssfr_mesh_load(&mesh, cut);
            assert_int_equal(result != SSFR_OK, mesh == NULL);
            assert_int_equal(test_n_errors(), result != SSFR_OK);
            assert_true(result != SSFR_OK || size - n < 40);
            ssfr_mesh_destroy(&mesh);
        }
        free(bytes);
    }
    test_mesh_finish(&m);
}

/* One byte wrong: anything but a crash. */
static void damaged_files_are_refused_or_read(void **state)
{
    (void)state;
    test_mesh m = test_mesh_box(0.7, 0.4, 0.3);
    uint64_t seed = 15;
    for (size_t e = 0; e < SSFR_COUNT(endings); e++) {
        const char *path = test_mesh_write(&m, endings[e]), *bad = test_mesh_write(&m, endings[e]);
        char *bytes;
        size_t size;
        assert_int_equal(ssfr_read_file(path, 1 << 20, &bytes, &size), SSFR_OK);
        for (int i = 0; i < 300; i++) {
            ssfr_mesh *mesh;
            const size_t at = (size_t)test_random(&seed, 0, (double)size);
            const char before = bytes[at];
            bytes[at] = (char)test_random(&seed, -128, 128);
            test_write_file(bad, bytes, size);
            test_clear_log();
            const ssfr_result result = ssfr_mesh_load(&mesh, bad);
            assert_int_equal(result != SSFR_OK, mesh == NULL);
            assert_int_equal(test_n_errors(), result != SSFR_OK);
            ssfr_mesh_destroy(&mesh);
            bytes[at] = before;
        }
        free(bytes);
    }
    test_mesh_finish(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_of_triangles_is_as_near_as_the_sphere),
        cmocka_unit_test(a_box_of_triangles_is_the_box),
        cmocka_unit_test(distances_to_a_concave_mesh_are_those_to_all_its_triangles),
        cmocka_unit_test(signs_are_right_at_every_thorn),
        cmocka_unit_test(vertices_are_at_no_distance_and_have_unit_normals),
        cmocka_unit_test(trees_of_equal_and_of_ever_smaller_triangles_are_searched),
        cmocka_unit_test(rays_enter_where_the_first_of_all_triangles_is),
        cmocka_unit_test(no_ray_slips_through_edges_or_corners),
        cmocka_unit_test(rays_from_inside_do_not_enter_a_convex_mesh),
        cmocka_unit_test(a_solid_of_a_mesh_is_turned_and_moved),
        cmocka_unit_test(serials_differ),
        cmocka_unit_test(surfaces_with_faults_are_refused_with_their_counts),
        cmocka_unit_test(a_surface_inside_out_is_turned),
        cmocka_unit_test(every_format_holds_the_same_mesh),
        cmocka_unit_test(concave_polygons_are_cut_within_them),
        cmocka_unit_test(loading_says_what_is_wrong_with_a_surface),
        cmocka_unit_test(malformed_files_are_refused),
        cmocka_unit_test(a_polygon_of_very_many_corners_is_refused),
        cmocka_unit_test(absurd_counts_allocate_nothing),
        cmocka_unit_test(truncated_files_are_refused),
        cmocka_unit_test(damaged_files_are_refused_or_read),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

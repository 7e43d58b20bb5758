/* SPDX-License-Identifier: GPL-3.0-or-later */
/* meshes.c: meshes that tests make, and files of them. */
#include "tests/meshes.h"

static test_mesh allocate(size_t n_vertices, size_t n_triangles)
{
    test_mesh m = {.n_vertices = n_vertices, .n_triangles = n_triangles};
    m.vertices = calloc(3 * n_vertices, sizeof *m.vertices);
    m.triangles = calloc(3 * n_triangles, sizeof *m.triangles);
    assert_true(m.vertices && m.triangles);
    return m;
}

void test_mesh_finish(test_mesh *mesh)
{
    free(mesh->vertices), free(mesh->triangles);
    *mesh = (test_mesh){0};
}

/* ---- spheres ----------------------------------------------------------------------------------------------------- */

static test_mesh icosahedron(void)
{
    static const unsigned char faces[20][3] = {
        {0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6},
        {7, 1, 8},  {3, 9, 4}, {3, 4, 2}, {3, 2, 6},  {3, 6, 8},   {3, 8, 9}, {4, 9, 5},  {2, 4, 11},  {6, 2, 10},
        {8, 6, 7},  {9, 8, 1}};
    const double golden = (1 + sqrt(5)) / 2;
    test_mesh m = allocate(12, 20);
    for (int i = 0; i < 12; i++) {
        const int k = i / 4;
        const double one = i % 2 ? 1 : -1, two = i / 2 % 2 ? -golden : golden;
        m.vertices[3 * i + k] = one, m.vertices[3 * i + (k + 1) % 3] = two;
    }
    for (int i = 0; i < 60; i++) m.triangles[i] = faces[i / 3][i % 3];
    return m;
}

/* The vertex between two others; each edge is cut once. */
static uint32_t middle(test_mesh *m, uint32_t a, uint32_t b, size_t before)
{
    double at[3];
    for (int k = 0; k < 3; k++) at[k] = m->vertices[3 * a + (uint32_t)k] + m->vertices[3 * b + (uint32_t)k];
    ssfr_normalize(at);
    for (size_t i = before; i < m->n_vertices; i++)
        if (memcmp(m->vertices + 3 * i, at, sizeof at) == 0) return (uint32_t)i;
    memcpy(m->vertices + 3 * m->n_vertices, at, sizeof at);
    return (uint32_t)m->n_vertices++;
}

static test_mesh subdivide(const test_mesh *from)
{
    const size_t n = from->n_vertices;
    test_mesh m = allocate(n + 3 * from->n_triangles / 2, 4 * from->n_triangles);
    memcpy(m.vertices, from->vertices, 3 * n * sizeof *m.vertices);
    m.n_vertices = n;
    for (size_t i = 0; i < from->n_triangles; i++) {
        const uint32_t *t = from->triangles + 3 * i;
        uint32_t *to = m.triangles + 12 * i, half[3];
        for (int k = 0; k < 3; k++) half[k] = middle(&m, t[k], t[(k + 1) % 3], n);
        const uint32_t cut[12] = {t[0], half[0], half[2], half[0], t[1], half[1], half[2], half[1], t[2],
                                  half[0], half[1], half[2]};
        memcpy(to, cut, sizeof cut);
    }
    return m;
}

test_mesh test_mesh_sphere(int level, double radius)
{
    test_mesh m = icosahedron();
    for (size_t i = 0; i < m.n_vertices; i++) ssfr_normalize(m.vertices + 3 * i);
    for (; level > 0; level--) {
        test_mesh finer = subdivide(&m);
        test_mesh_finish(&m);
        m = finer;
    }
    for (size_t i = 0; i < 3 * m.n_vertices; i++) m.vertices[i] *= radius;
    return m;
}

test_mesh test_mesh_thorns(int level, double least, double most)
{
    test_mesh m = test_mesh_sphere(level, 1);
    uint64_t seed = 42;
    for (size_t i = 0; i < m.n_vertices; i++) {
        const double r = test_random(&seed, least, most);
        for (int k = 0; k < 3; k++) m.vertices[3 * i + (size_t)k] *= r;
    }
    return m;
}

test_mesh test_mesh_box(double x, double y, double z)
{
    static const unsigned char faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                               {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    test_mesh m = allocate(8, 12);
    for (int i = 0; i < 8; i++) {
        m.vertices[3 * i] = i & 1 ? x : -x;
        m.vertices[3 * i + 1] = i & 2 ? y : -y;
        m.vertices[3 * i + 2] = i & 4 ? z : -z;
    }
    for (int i = 0; i < 36; i++) m.triangles[i] = faces[i / 3][i % 3];
    return m;
}

test_mesh test_mesh_join(const test_mesh *a, const test_mesh *b, const double by[3])
{
    test_mesh m = allocate(a->n_vertices + b->n_vertices, a->n_triangles + b->n_triangles);
    memcpy(m.vertices, a->vertices, 3 * a->n_vertices * sizeof *m.vertices);
    memcpy(m.triangles, a->triangles, 3 * a->n_triangles * sizeof *m.triangles);
    for (size_t i = 0; i < 3 * b->n_vertices; i++) m.vertices[3 * a->n_vertices + i] = b->vertices[i] + by[i % 3];
    for (size_t i = 0; i < 3 * b->n_triangles; i++)
        m.triangles[3 * a->n_triangles + i] = b->triangles[i] + (uint32_t)a->n_vertices;
    return m;
}

ssfr_mesh *test_mesh_make(const test_mesh *m)
{
    ssfr_mesh *mesh;
    assert_int_equal(ssfr_mesh_create(&mesh, m->n_vertices, m->vertices, m->n_triangles, m->triangles), SSFR_OK);
    return mesh;
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static void put(FILE *file, const void *bytes, size_t size)
{
    assert_int_equal(fwrite(bytes, 1, size, file), size);
}

static void write_obj(const test_mesh *m, FILE *file)
{
    fprintf(file, "# a comment\nmtllib none.mtl\no thing\n");
    for (size_t i = 0; i < m->n_vertices; i++)
        fprintf(file, "v %.17g %.17g %.17g\n", m->vertices[3 * i], m->vertices[3 * i + 1], m->vertices[3 * i + 2]);
    fprintf(file, "vt 0 0\nvn 0 0 1\n");
    for (size_t i = 0; i < m->n_triangles; i++) {
        const uint32_t *t = m->triangles + 3 * i;
        fprintf(file, i % 2 ? "f %u/1/1 %u/1/1 %u/1/1\n" : "f %u//1 %u %u/1 # so\r\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
}

static void write_stl(const test_mesh *m, FILE *file)
{
    char header[80] = "solid in name only";
    const uint32_t n = (uint32_t)m->n_triangles;
    put(file, header, sizeof header);
    put(file, &n, sizeof n);
    for (size_t i = 0; i < m->n_triangles; i++) {
        float values[12] = {0};
        for (size_t k = 0; k < 9; k++)
            values[3 + k] = (float)m->vertices[3 * m->triangles[3 * i + k / 3] + (uint32_t)k % 3];
        put(file, values, sizeof values);
        put(file, "\0", 2);
    }
}

static void write_text_stl(const test_mesh *m, FILE *file)
{
    fprintf(file, "solid a thing\n");
    for (size_t i = 0; i < m->n_triangles; i++) {
        fprintf(file, "  facet normal 0 0 0\n    outer loop\n");
        for (size_t k = 0; k < 3; k++) {
            const double *at = m->vertices + 3 * m->triangles[3 * i + k];
            fprintf(file, "      vertex %.9g %.9g %.9g\n", at[0], at[1], at[2]);
        }
        fprintf(file, "    endloop\n  endfacet\n");
    }
    fprintf(file, "endsolid a thing\n");
}

static void write_ply(const test_mesh *m, FILE *file, bool text)
{
    fprintf(file, "ply\nformat %s 1.0\nelement vertex %zu\nproperty double x\nproperty double y\nproperty double z\n"
                  "property uchar red\nelement face %zu\nproperty list uchar uint vertex_indices\nend_header\n",
            text ? "ascii" : "binary_little_endian", m->n_vertices, m->n_triangles);
    for (size_t i = 0; i < m->n_vertices; i++) {
        const double *at = m->vertices + 3 * i;
        if (text) fprintf(file, "%.17g %.17g %.17g 7\n", at[0], at[1], at[2]);
        else put(file, at, 3 * sizeof *at), put(file, "\7", 1);
    }
    for (size_t i = 0; i < m->n_triangles; i++) {
        const uint32_t *t = m->triangles + 3 * i;
        if (text) fprintf(file, "3 %u %u %u\n", t[0], t[1], t[2]);
        else put(file, "\3", 1), put(file, t, 3 * sizeof *t);
    }
}

const char *test_mesh_write(const test_mesh *m, const char *ending)
{
    char name[64];
    static int n;
    snprintf(name, sizeof name, "mesh%d%s", n++, ending);
    const char *path = test_path(name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    if (strcmp(ending, ".obj") == 0) write_obj(m, file);
    if (strcmp(ending, ".stl") == 0) write_stl(m, file);
    if (strcmp(ending, ".txt.stl") == 0) write_text_stl(m, file);
    if (strcmp(ending, ".ply") == 0) write_ply(m, file, false);
    if (strcmp(ending, ".txt.ply") == 0) write_ply(m, file, true);
    assert_int_equal(fclose(file), 0);
    return path;
}

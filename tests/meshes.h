/* SPDX-License-Identifier: GPL-3.0-or-later */
/* meshes.h: meshes that tests make: spheres of triangles, boxes, thorny balls. */
#ifndef SSFR_TESTS_MESHES_H
#define SSFR_TESTS_MESHES_H

#include "tests/util.h"

typedef struct test_mesh {
    size_t n_vertices, n_triangles;
    double *vertices;
    uint32_t *triangles;
} test_mesh;

/* An icosahedron, each triangle cut into 4 `level` times: 20 4^level triangles with corners on the sphere. */
test_mesh test_mesh_sphere(int level, double radius);
/* Twelve triangles. */
test_mesh test_mesh_box(double x, double y, double z);
/* A sphere whose vertices are drawn in and out by chance, between two radii: star-shaped, and concave all over. */
test_mesh test_mesh_thorns(int level, double least, double most);
void test_mesh_finish(test_mesh *mesh);

/* All of them as one; the second is moved by `by`. */
test_mesh test_mesh_join(const test_mesh *a, const test_mesh *b, const double by[3]);

ssfr_mesh *test_mesh_make(const test_mesh *mesh);
/* A file in the tests' folder: ".obj", ".stl" (binary), ".txt.stl" (ascii), ".ply" (binary), ".txt.ply" (ascii). */
const char *test_mesh_write(const test_mesh *mesh, const char *ending);

#endif

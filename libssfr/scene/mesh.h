/* SPDX-License-Identifier: MIT */
/* mesh.h: closed surfaces of triangles: distances to them and rays into them, by a tree of boxes.
 *
 * The tree's nodes stand depth first, in one array without pointers:
 *
 *      0 --- 1 --- 2 leaf            the first child of node i is i + 1, the second is nodes[i + 1].skip;
 *       \     \--- 3 leaf            who has no business in node i goes on at nodes[i].skip, n_nodes at the end
 *        \-- 4 leaf
 */
#ifndef SSFR_MESH_H
#define SSFR_MESH_H

#include "base/base.h"

enum { SSFR_MESH_LEAF = 4 /* triangles, at most; fits a node's three bits */ };
#define SSFR_MESH_REACH 1e9 /* m, the largest coordinate: floats hold squares of areas in it */

/* As shaders read it too (shaders/environment.glsl). */
typedef struct ssfr_mesh_node {
    float lo[3];   /* m, relative to the mesh's middle: the box is a little larger than what is in it */
    uint32_t skip;
    float hi[3];
    uint32_t leaf; /* first triangle and their number n, 8 first + n; 0 where there are children */
} ssfr_mesh_node;

typedef struct ssfr_mesh_triangle {
    double corner[3][3]; /* m */
    double normal[3];    /* unit, outwards */
} ssfr_mesh_triangle;

/* Unit normals of a triangle's edges (from corner k to k + 1) and of its corners, where they are weighted by the angles
 * of the triangles there. With the triangle's own they tell inside from outside wherever a place is nearest to. */
typedef struct ssfr_mesh_normals {
    double edge[3][3], corner[3][3];
} ssfr_mesh_normals;

struct ssfr_mesh {
    size_t n_triangles, n_nodes;
    ssfr_mesh_triangle *triangles; /* in the order of the leaves */
    ssfr_mesh_normals *normals;    /* of each triangle */
    ssfr_mesh_node *nodes;
    double lo[3], hi[3], middle[3]; /* m, the box around it */
    uint64_t serial;                /* differs between any two meshes of a process: a key for caches */
};

/* ssfr_mesh_create with a name for the error lines; turns a surface inside out that is. */
SSFR_MUST ssfr_result ssfr_mesh_make(ssfr_mesh **out, const char *what, size_t n_vertices, const double *vertices,
                                     size_t n_triangles, const uint32_t *triangles);

/* Makes a mesh that nobody has drawn yet larger, or smaller; factor > 0. */
void ssfr_mesh_scale(ssfr_mesh *mesh, double factor);

/* Sorts the mesh's triangles into a new tree. */
SSFR_MUST ssfr_result ssfr_mesh_grow_tree(ssfr_mesh *mesh);

/* Signed distance, m, negative inside, and the unit gradient; as ssfr_solid_distance, in the mesh's axes. */
double ssfr_mesh_distance(const ssfr_mesh *mesh, const double at[3], double normal[3]);

/* Where a ray enters the surface from outside; as ssfr_solid_enter, in the mesh's axes. */
double ssfr_mesh_enter(const ssfr_mesh *mesh, const double origin[3], const double dir[3], double normal[3]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* frames.h: what tests of whole frames share: small scenes, graphs on both backends, pictures and their comparison. */
#ifndef SSFR_TESTS_FRAMES_H
#define SSFR_TESTS_FRAMES_H

#include "tests/gl_host.h"

typedef struct test_scene { /* not to be copied: scene points into it */
    ssfr_particles *particles;
    ssfr_solid solids[7];
    ssfr_mesh *mesh; /* NULL, but where it has solids of all shapes */
    ssfr_field *map;
    ssfr_scene scene;
} test_scene;

/* Floor at y = 0, two boxes, and these particles, with ids. The camera is still to be set. */
void test_scene_create(test_scene *s, size_t n, const double *positions, double radius);
/* n[0] n[1] n[2] particles near the points of a lattice of 1.7 radii around `middle` (m). */
void test_scene_create_block(test_scene *s, const int n[3], const double middle[3], double radius);
void test_scene_look(test_scene *s, const double eye[3], const double target[3], double fov_deg, int w, int h);
/* A block of 432 particles on the floor that fills about half of an image of w x h px. */
void test_scene_create_usual(test_scene *s, int w, int h);
/* Puts solids of the other shapes beside the two boxes, and a map in the place of the sky. */
void test_scene_add_shapes(test_scene *s);
void test_scene_destroy(test_scene *s);

/* One GL context for all tests of a file, made when first asked for; skips like test_gl_or_skip. */
ssfr_gl *test_shared_gl(void);
int test_shared_gl_destroy(void **state); /* group teardown */

/* A test's entries for the CPU and the GPU; test_backend gives NULL in the first and the shared GL in the second. */
#define ON_BOTH(test)                                  \
    {#test "_on_the_cpu", test, NULL, NULL, NULL},     \
    {#test "_on_the_gpu", test, NULL, NULL, test_on_gpu}
extern char test_on_gpu[];
ssfr_gl *test_backend(void **state);

/* Its shadow maps are small: 64 px. */
ssfr_graph *test_graph(const ssfr_pipeline *pipeline, ssfr_gl *gl);
/* Sets a NULL-terminated list of "key=value". */
void test_graph_set(ssfr_graph *graph, const char *const *settings);
ssfr_field *test_graph_read(const ssfr_graph *graph, const char *slot);
/* Runs a frame and reads a slot of it. */
ssfr_field *test_graph_picture(ssfr_graph *graph, const ssfr_scene *scene, const char *slot, bool keep_all);
const ssfr_node_report *test_graph_node(const ssfr_graph *graph, const char *node);

/* Number of values whose bits differ; the sizes must not. */
size_t test_n_different(const ssfr_field *a, const ssfr_field *b);
/* dB for a peak of 1; infinite for equal fields, NaN when either holds a NaN. */
double test_psnr(const ssfr_field *a, const ssfr_field *b);

#endif

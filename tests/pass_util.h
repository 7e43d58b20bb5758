/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pass_util.h: one pass by itself on given images and particles, on either twin. */
#ifndef SSFR_TESTS_PASS_UTIL_H
#define SSFR_TESTS_PASS_UTIL_H

#include "graph/graph.h"
#include "tests/gl_host.h"

/* A test that runs on both twins; its state says which. Without GL the second is skipped. */
#define TEST_TWINS(test)                                 \
    {#test "_on_the_cpu", test, NULL, test_clean, "cpu"}, \
    {#test "_on_the_gpu", test, NULL, test_clean, "gpu"}
#define TEST_CPU(test) {#test, test, NULL, test_clean, "cpu"}
#define TEST_GPU(test) {#test, test, NULL, test_clean, "gpu"}

/* Teardown of a test that uses what stands below: frees all that it made. */
int test_clean(void **state);
/* Teardown of the group. */
int test_end_gl(void **state);

typedef struct test_twin {
    const char *pass;  /* or the pipeline */
    ssfr_gl *gl;       /* NULL: the CPU twin */
    ssfr_graph *graph; /* of one node */
    ssfr_scene scene;  /* the eye at the origin, looking down -z, half a metre high at unit distance; near at 0.01 m */
    double eps;        /* what one rounding may change, relative: of double or of float */
} test_twin;

/* Everything that these return lives until the test ends. */
test_twin *test_twin_create(void **state, const char *pass, int w, int h);
test_twin *test_twin_create_for(void **state, const ssfr_pipeline *pipeline, int w, int h);
ssfr_field *test_field(int w, int h, int c);
ssfr_field *test_field_filled(int w, int h, int c, double value);

/* The pass's own parameter, or "group.param". */
__attribute__((format(printf, 3, 4))) void test_twin_set(test_twin *t, const char *key, const char *format, ...);
/* The pass refuses the value with one line that holds `text`. */
void test_twin_refuses(test_twin *t, const char *key, const char *value, const char *text);
void test_twin_give(test_twin *t, const char *port, const ssfr_field *field);
/* Particles at places in eye space, m; id may be NULL. */
void test_twin_place(test_twin *t, size_t n, const double (*eye)[3], double radius, const uint32_t *id);
/* Particles of these sizes (NULL: all 1) and velocities in eye space, m/s (NULL: not known), on the ports `size` and
 * `velocity` of a pass that draws such, until the next are placed. n is at most 4096. */
void test_twin_place_moving(test_twin *t, size_t n, const double (*eye)[3], double radius, const float *size,
                            const float (*velocity)[3]);
/* Stands the eye elsewhere and turns it. */
void test_twin_look(test_twin *t, const double eye[3], const double target[3]);
typedef struct test_light {
    double azimuth, elevation; /* deg */
} test_light;
void test_twin_light(test_twin *t, const test_light *light);
/* Unit vector of the world. */
void test_light_towards(const test_light *light, double out[3]);
/* Runs the pass whatever its `needed` says, and gives an output. */
ssfr_field *test_twin_run(test_twin *t, const char *output);
/* Runs the pass when it is needed; *status says whether it was. */
ssfr_field *test_twin_run_if_needed(test_twin *t, const char *output, ssfr_node_status *status);

/* Eye-space x and y at unit distance of the middle of a pixel; y upwards. */
typedef struct test_ray {
    double u, v;
} test_ray;
test_ray test_ray_at(const test_twin *t, int x, int y, int divisor);

/* z of the plane z = z0 + sx x + sy y (m, eye space) along a ray. */
static inline double test_plane(double z0, double sx, double sy, test_ray ray)
{
    return z0 / (1 + sx * ray.u + sy * ray.v);
}

/* Where a ray meets a sphere, by the quadratic formula. */
typedef struct test_hit {
    double front, back; /* m, eye-space z */
    double miss;        /* m, from the ray to the centre; over the radius there is no hit and the rest is NaN */
} test_hit;
test_hit test_meet(const double centre[3], double radius, test_ray ray);

/* What rounding may change in the chord of a ray that passes the centre at `miss`, m. It moves the ray's nearest point
 * to the centre by a few units of the distance, and the chord sqrt(R^2 - d^2) by R / sqrt(R^2 - d^2) times that; at the
 * rim itself, where the chord is steep, by the root of it. */
double test_chord_rounding(double eps, const double centre[3], double radius, double miss);

/* Pixels that are surfaces. */
int test_count(const ssfr_field *depth);
/* The largest |a - b| over all values; infinite where only one is a surface, NaN where one is NaN. */
double test_difference(const ssfr_field *a, const ssfr_field *b);
bool test_same_bits(const ssfr_field *a, const ssfr_field *b);
/* The power of h by which an error falls that goes from `coarse` to `fine` when h is divided by `ratio`. */
static inline double test_order(double coarse, double fine, double ratio) { return log(coarse / fine) / log(ratio); }

#endif

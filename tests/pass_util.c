/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pass_util.c: one pass by itself on given images and particles, on either twin. */
#include "tests/pass_util.h"

#include "graph/internal.h"

#include <float.h>

/* ---- what a test owns -------------------------------------------------------------------------------------------- */

enum { MAX_TWINS = 64, MAX_FIELDS = 1024, MAX_SETS = 256, MAX_MOVING = 4096 };

static test_twin twins[MAX_TWINS];
static ssfr_field *fields[MAX_FIELDS];
static ssfr_particles *sets[MAX_SETS];
static int n_twins, n_fields, n_sets;
static ssfr_gl *gl; /* one for all tests of a group: making a context takes longer than most of them */

int test_clean(void **state)
{
    (void)state;
    while (n_twins) ssfr_graph_destroy(&twins[--n_twins].graph);
    while (n_fields) ssfr_field_destroy(&fields[--n_fields]);
    while (n_sets) ssfr_particles_destroy(&sets[--n_sets]);
    return 0;
}

int test_end_gl(void **state)
{
    (void)state;
    ssfr_gl_destroy(&gl);
    return 0;
}

static ssfr_field *own(ssfr_field *field)
{
    assert_true(n_fields < MAX_FIELDS);
    return fields[n_fields++] = field;
}

ssfr_field *test_field(int w, int h, int c)
{
    ssfr_field *field;
    assert_int_equal(ssfr_field_create(&field, w, h, c), SSFR_OK);
    return own(field);
}

ssfr_field *test_field_filled(int w, int h, int c, double value)
{
    ssfr_field *field = test_field(w, h, c);
    ssfr_field_fill(field, value);
    return field;
}

/* ---- a pass on one twin ------------------------------------------------------------------------------------------ */

static test_twin *start(void **state, int w, int h)
{
    static const double eye[3] = {0, 0, 0}, target[3] = {0, 0, -1}, up[3] = {0, 1, 0};
    const bool on_gpu = strcmp(*state, "gpu") == 0;
    if (on_gpu && !gl) gl = test_gl_or_skip();
    assert_true(n_twins < MAX_TWINS);
    test_twin *t = &twins[n_twins++];
    *t = (test_twin){.gl = on_gpu ? gl : NULL, .eps = on_gpu ? FLT_EPSILON : DBL_EPSILON};
    assert_int_equal(ssfr_camera_look(&t->scene.camera, eye, target, up, 2 * atan(0.5), w, h), SSFR_OK);
    t->scene.floor = -INFINITY;
    return t;
}

test_twin *test_twin_create(void **state, const char *pass, int w, int h)
{
    test_twin *t = start(state, w, h);
    assert_non_null(ssfr_pass_find(pass));
    t->pass = pass;
    assert_int_equal(ssfr_graph_create_for_pass(&t->graph, ssfr_pass_find(pass), t->gl), SSFR_OK);
    return t;
}

test_twin *test_twin_create_for(void **state, const ssfr_pipeline *pipeline, int w, int h)
{
    test_twin *t = start(state, w, h);
    assert_int_equal(ssfr_graph_create(&t->graph, pipeline, t->gl), SSFR_OK);
    t->pass = ssfr_pipeline_name(pipeline);
    return t;
}

static const char *full_key(const test_twin *t, const char *key, char full[128])
{
    snprintf(full, 128, "%s.%s", t->pass, key);
    return strchr(key, '.') ? key : full;
}

void test_twin_set(test_twin *t, const char *key, const char *format, ...)
{
    char full[128], value[128];
    va_list args;
    va_start(args, format);
    vsnprintf(value, sizeof value, format, args);
    va_end(args);
    assert_int_equal(ssfr_graph_set(t->graph, full_key(t, key, full), value), SSFR_OK);
}

void test_twin_refuses(test_twin *t, const char *key, const char *value, const char *text)
{
    char full[128];
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_set(t->graph, full_key(t, key, full), value), text);
}

void test_light_towards(const test_light *l, double out[3])
{
    const double degree = acos(-1) / 180, a = l->azimuth * degree, e = l->elevation * degree;
    out[0] = cos(e) * cos(a), out[1] = sin(e), out[2] = cos(e) * sin(a);
}

void test_twin_light(test_twin *t, const test_light *l)
{
    test_twin_set(t, "light.azimuth_deg", "%.17g", l->azimuth);
    test_twin_set(t, "light.elevation_deg", "%.17g", l->elevation);
}

void test_twin_give(test_twin *t, const char *port, const ssfr_field *field)
{
    assert_int_equal(ssfr_graph_import(t->graph, port, field), SSFR_OK);
}

void test_twin_look(test_twin *t, const double eye[3], const double target[3])
{
    static const double up[3] = {0, 1, 0};
    ssfr_camera *c = &t->scene.camera;
    const ssfr_camera before = *c;
    assert_int_equal(ssfr_camera_look(c, eye, target, up, 2 * atan(before.tan_y), before.w, before.h), SSFR_OK);
    c->tan_x = before.tan_x, c->tan_y = before.tan_y, c->near = before.near;
}

void test_twin_place(test_twin *t, size_t n, const double (*eye)[3], double radius, const uint32_t *id)
{
    const ssfr_camera *c = &t->scene.camera;
    double *world = calloc(3 * n + 1, sizeof *world);
    uint32_t *ids = calloc(n + 1, sizeof *ids);
    const ssfr_particles given = {.radius = radius, .id = id ? ids : NULL};
    assert_non_null(world);
    assert_non_null(ids);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++)
            world[3 * i + k] = c->eye[k] + (eye[i][0] * c->right[k] + eye[i][1] * c->up[k] + eye[i][2] * c->back[k]);
    for (size_t i = 0; i < n && id; i++) ids[i] = id[i];
    assert_true(n_sets < MAX_SETS);
    assert_int_equal(ssfr_particles_create(&sets[n_sets], n, world, &given), SSFR_OK);
    t->scene.particles = sets[n_sets++];
    free(world), free(ids);
}

static void lend(const test_twin *t, const char *port, const float *values)
{
    const int k = ssfr_port_find(t->graph->nodes[0].pass->inputs, port);
    assert_true(k >= 0);
    ssfr_values_lend(t->graph, t->graph->nodes[0].in[k], values);
}

void test_twin_place_moving(test_twin *t, size_t n, const double (*eye)[3], double radius, const float *size,
                            const float (*velocity)[3])
{
    static float sizes[MAX_MOVING], velocities[MAX_MOVING][3];
    static uint32_t ids[MAX_MOVING];
    const ssfr_camera *c = &t->scene.camera;
    assert_true(n <= MAX_MOVING);
    for (size_t i = 0; i < n; i++) ids[i] = (uint32_t)i;
    test_twin_place(t, n, eye, radius, ids);
    for (size_t i = 0; i < n; i++) {
        const uint32_t id = t->scene.particles->id[i];
        double v[3] = {0};
        for (int k = 0; k < 3 && velocity; k++) v[k] = (double)velocity[id][k];
        for (int k = 0; k < 3; k++)
            velocities[i][k] = (float)(v[0] * c->right[k] + v[1] * c->up[k] + v[2] * c->back[k]);
        sizes[i] = size ? size[id] : 1;
    }
    lend(t, "size", sizes);
    lend(t, "velocity", velocity ? velocities[0] : NULL);
}

static ssfr_field *run(test_twin *t, const char *output, bool keep_all)
{
    ssfr_field *field;
    ssfr_graph_want_all(t->graph, true);
    assert_int_equal(ssfr_graph_run(t->graph, &t->scene, &(ssfr_run_options){.keep_all = keep_all}), SSFR_OK);
    assert_int_equal(ssfr_graph_read(t->graph, output, &field), SSFR_OK);
    return own(field);
}

ssfr_field *test_twin_run(test_twin *t, const char *output)
{
    return run(t, output, true);
}

ssfr_field *test_twin_run_if_needed(test_twin *t, const char *output, ssfr_node_status *status)
{
    ssfr_field *field = run(t, output, false);
    *status = ssfr_graph_report(t->graph)->nodes[0].status;
    return field;
}

/* ---- geometry ---------------------------------------------------------------------------------------------------- */

test_ray test_ray_at(const test_twin *t, int x, int y, int divisor)
{
    const ssfr_camera *c = &t->scene.camera;
    return (test_ray){(2 * (x + 0.5) * divisor / c->w - 1) * c->tan_x, (1 - 2 * (y + 0.5) * divisor / c->h) * c->tan_y};
}

/* In long double, because the discriminant cancels for far spheres. */
test_hit test_meet(const double centre[3], double radius, test_ray ray)
{
    const long double d[3] = {ray.u, ray.v, -1}, r = radius;
    const long double dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const long double dc = d[0] * centre[0] + d[1] * centre[1] + d[2] * centre[2];
    long double cc = 0, cross = 0;
    for (int k = 0; k < 3; k++) {
        const long double a = centre[k], b = centre[(k + 1) % 3], side = a * d[(k + 1) % 3] - b * d[k];
        cc += a * a, cross += side * side;
    }
    const long double root = sqrtl(dc * dc - dd * (cc - r * r));
    return (test_hit){(double)(-(dc - root) / dd), (double)(-(dc + root) / dd), (double)sqrtl(cross / dd)};
}

double test_chord_rounding(double eps, const double centre[3], double radius, double miss)
{
    const double moved = 8 * eps * (sqrt(ssfr_dot(centre, centre)) + radius);
    return fmin(moved * (1 + 2 * radius / sqrt(fmax(radius * radius - miss * miss, 0))), 4 * sqrt(radius * moved));
}

/* ---- images ------------------------------------------------------------------------------------------------------ */

static size_t n_values(const ssfr_field *f)
{
    return (size_t)f->w * (size_t)f->h * (size_t)f->c;
}

int test_count(const ssfr_field *depth)
{
    int n = 0;
    for (size_t i = 0; i < n_values(depth); i++) n += ssfr_is_surface(depth->data[i]);
    return n;
}

double test_difference(const ssfr_field *a, const ssfr_field *b)
{
    double largest = 0;
    assert_int_equal(a->w, b->w);
    assert_int_equal(a->h, b->h);
    assert_int_equal(a->c, b->c);
    for (size_t i = 0; i < n_values(a); i++) {
        const double d = fabs(a->data[i] - b->data[i]);
        const bool one = ssfr_is_surface(a->data[i]) != ssfr_is_surface(b->data[i]);
        if (isnan(d)) return d;
        if (one || ssfr_is_surface(a->data[i])) largest = fmax(largest, one ? INFINITY : d);
    }
    return largest;
}

bool test_same_bits(const ssfr_field *a, const ssfr_field *b)
{
    return a->w == b->w && a->h == b->h && a->c == b->c && memcmp(a->data, b->data, n_values(a) * sizeof *a->data) == 0;
}

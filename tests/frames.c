/* SPDX-License-Identifier: GPL-3.0-or-later */
/* frames.c: what tests of whole frames share: small scenes, graphs on both backends, pictures and their comparison. */
#include "tests/frames.h"

#include "tests/meshes.h"

/* ---- scenes ------------------------------------------------------------------------------------------------------ */

static void add_solids(test_scene *s)
{
    s->solids[0] = (ssfr_solid){.centre = {0.9, 0.25, -0.7}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                .half = {0.1, 0.25, 0.1}, .colour = {0.7, 0.2, 0.1}};
    s->solids[1] = (ssfr_solid){.centre = {-0.1, 0.1, 0.5}, .axis = {{0.8, 0, 0.6}, {0, 1, 0}, {-0.6, 0, 0.8}},
                                .half = {0.06, 0.1, 0.04}, .colour = {0.1, 0.5, 0.2}};
    s->scene.solids = s->solids;
    s->scene.n_solids = 2;
}

void test_scene_create(test_scene *s, size_t n, const double *positions, double radius)
{
    uint32_t *ids = calloc(n ? n : 1, sizeof *ids);
    assert_non_null(ids);
    for (size_t i = 0; i < n; i++) ids[i] = (uint32_t)(7 * i + 3);
    *s = (test_scene){0};
    assert_int_equal(ssfr_particles_create(&s->particles, n, positions, &(ssfr_particles){.radius = radius, .id = ids}),
                     SSFR_OK);
    free(ids);
    s->scene.particles = s->particles;
    add_solids(s);
}

void test_scene_create_block(test_scene *s, const int n[3], const double middle[3], double radius)
{
    const double spacing = 1.7 * radius;
    const size_t count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    uint64_t seed = 2385;
    double *positions = calloc(3 * count, sizeof *positions), *at = positions;
    assert_non_null(positions);
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) {
                const int cell[3] = {x, y, z};
                for (int k = 0; k < 3; k++)
                    *at++ = middle[k] + spacing * (cell[k] - 0.5 * (n[k] - 1) + test_random(&seed, -0.2, 0.2));
            }
    test_scene_create(s, count, positions, radius);
    free(positions);
}

void test_scene_look(test_scene *s, const double eye[3], const double target[3], double fov_deg, int w, int h)
{
    static const double up[3] = {0, 1, 0};
    assert_int_equal(ssfr_camera_look(&s->scene.camera, eye, target, up, fov_deg * acos(-1) / 180, w, h), SSFR_OK);
}

void test_scene_create_usual(test_scene *s, int w, int h)
{
    test_scene_create_block(s, (const int[3]){12, 6, 6}, (const double[3]){0, 0.22, 0}, 0.04);
    test_scene_look(s, (const double[3]){0.35, 0.62, 1.25}, (const double[3]){0, 0.2, 0}, 45, w, h);
}

static ssfr_field *make_map(void)
{
    ssfr_field *map = test_image(16, 8, 3, 0);
    uint64_t seed = 16;
    for (int i = 0; i < 16 * 8 * 3; i++) map->data[i] = test_random(&seed, 0.1, 1);
    return map;
}

void test_scene_add_shapes(test_scene *s)
{
    static const struct {
        ssfr_shape shape;
        double centre[3], half[3], inner;
    } list[] = {{SSFR_CYLINDER, {-0.3, 0.3, -0.5}, {0.15, 0.2, 0.15}, 0.1}, {SSFR_SPHERE, {0.5, 0.4, 0}, {0.1}, 0},
                {SSFR_RAMP, {0.2, 0.06, 0.5}, {0.12, 0.06, 0.08}, 0},       {SSFR_PLANE, {0, 0, -1.5}, {0}, 0},
                {SSFR_MESH, {-0.4, 0.5, 0.1}, {0}, 0}};
    test_mesh thorns = test_mesh_thorns(1, 0.05, 0.14);
    s->mesh = test_mesh_make(&thorns);
    s->map = make_map();
    for (size_t i = 0; i < SSFR_COUNT(list); i++) {
        ssfr_solid *to = &s->solids[2 + i];
        *to = (ssfr_solid){.shape = list[i].shape, .axis = {{0.8, 0, 0.6}, {-0.6, 0, 0.8}, {0, -1, 0}},
                           .inner = list[i].inner, .mesh = s->mesh, .colour = {0.2 * (double)i, 0.5, 0.3}};
        memcpy(to->centre, list[i].centre, sizeof to->centre);
        memcpy(to->half, list[i].half, sizeof to->half);
    }
    s->scene.n_solids = 2 + (int)SSFR_COUNT(list);
    s->scene.environment = s->map;
    test_mesh_finish(&thorns);
}

void test_scene_destroy(test_scene *s)
{
    ssfr_mesh_destroy(&s->mesh);
    ssfr_field_destroy(&s->map);
    ssfr_particles_destroy(&s->particles);
}

/* ---- backends ---------------------------------------------------------------------------------------------------- */

static ssfr_gl *shared;

ssfr_gl *test_shared_gl(void)
{
    if (!shared) shared = test_gl_or_skip();
    return shared;
}

int test_shared_gl_destroy(void **state)
{
    (void)state;
    ssfr_gl_destroy(&shared);
    return 0;
}

char test_on_gpu[] = "gpu";

ssfr_gl *test_backend(void **state)
{
    return *state ? test_shared_gl() : NULL;
}

/* ---- graphs ------------------------------------------------------------------------------------------------------ */

ssfr_graph *test_graph(const ssfr_pipeline *pipeline, ssfr_gl *gl)
{
    ssfr_graph *graph = NULL;
    assert_int_equal(ssfr_graph_create(&graph, pipeline, gl), SSFR_OK);
    if (ssfr_graph_row(graph, "shadow_map.size"))
        assert_int_equal(ssfr_graph_set(graph, "shadow_map.size", "64"), SSFR_OK);
    return graph;
}

void test_graph_set(ssfr_graph *graph, const char *const *settings)
{
    for (int i = 0; settings && settings[i]; i++) {
        char key[128];
        const size_t length = strcspn(settings[i], "=");
        assert_true(length < sizeof key && settings[i][length]);
        snprintf(key, sizeof key, "%.*s", (int)length, settings[i]);
        if (ssfr_graph_set(graph, key, settings[i] + length + 1) != SSFR_OK)
            fail_msg("%s: %s", settings[i], test_last_error());
    }
}

ssfr_field *test_graph_read(const ssfr_graph *graph, const char *slot)
{
    ssfr_field *field = NULL;
    assert_int_equal(ssfr_graph_read(graph, slot, &field), SSFR_OK);
    return field;
}

ssfr_field *test_graph_picture(ssfr_graph *graph, const ssfr_scene *scene, const char *slot, bool keep_all)
{
    const ssfr_run_options options = {.keep_all = keep_all};
    if (ssfr_graph_run(graph, scene, &options) != SSFR_OK) fail_msg("%s", test_last_error());
    return test_graph_read(graph, slot);
}

const ssfr_node_report *test_graph_node(const ssfr_graph *graph, const char *node)
{
    const ssfr_report *report = ssfr_graph_report(graph);
    const ssfr_node_report *found = NULL;
    for (int i = 0; i < report->n_nodes && !found; i++)
        if (strcmp(report->nodes[i].node, node) == 0) found = &report->nodes[i];
    assert_non_null(found);
    return found;
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

static size_t n_values(const ssfr_field *a, const ssfr_field *b)
{
    assert_int_equal(a->w, b->w);
    assert_int_equal(a->h, b->h);
    assert_int_equal(a->c, b->c);
    return (size_t)a->w * (size_t)a->h * (size_t)a->c;
}

size_t test_n_different(const ssfr_field *a, const ssfr_field *b)
{
    const size_t n = n_values(a, b);
    size_t different = 0;
    for (size_t i = 0; i < n; i++) different += memcmp(&a->data[i], &b->data[i], sizeof *a->data) != 0;
    return different;
}

double test_psnr(const ssfr_field *a, const ssfr_field *b)
{
    const size_t n = n_values(a, b);
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += ssfr_square(a->data[i] - b->data[i]);
    return -10 * log10(sum / (double)n);
}

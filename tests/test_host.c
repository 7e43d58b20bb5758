/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_host.c: whole frames inside a host program's GL context, into its textures, from its textures and buffers. */
#include "tests/frames.h"
#include "tests/meshes.h"

#include "graph/graph.h"

#include <float.h>

enum { W = 96, H = 64 };

typedef struct rig { /* a host, and ssfr in it */
    test_host host;
    ssfr_gl *gl;
    ssfr_graph *graph;
    test_scene s;
} rig;

/* The host has its own things bound, and draws blended lines into a corner. */
static void bind_something(void)
{
    GLuint texture, framebuffer, vertex_array, buffers[3], sampler;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, GL_RGBA8, 32, 32);
    glCreateFramebuffers(1, &framebuffer);
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, texture, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glCreateVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    glCreateBuffers(3, buffers);
    for (int i = 0; i < 3; i++) glNamedBufferStorage(buffers[i], 4096, NULL, 0);
    glVertexArrayElementBuffer(vertex_array, buffers[0]);
    for (GLuint i = 0; i < 4; i++) glBindBufferRange(GL_SHADER_STORAGE_BUFFER, i, buffers[1], 256 * (i + 1), 512);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, buffers[2]);
    glCreateSamplers(1, &sampler);
    for (GLuint i = 0; i < 5; i++) glBindTextureUnit(i, texture), glBindSampler(i, sampler);
    glActiveTexture(GL_TEXTURE0 + 3);
    glEnable(GL_BLEND);
    glBlendFunc(GL_DST_COLOR, GL_ZERO);
    glBlendEquation(GL_FUNC_SUBTRACT);
    glEnable(GL_SCISSOR_TEST);
    glScissor(1, 2, 3, 4);
    glViewport(1, 2, 3, 4);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);
    glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    glPixelStorei(GL_PACK_ROW_LENGTH, 77);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
}

static void set_up(rig *r)
{
    *r = (rig){0};
    test_clear_log();
    test_host_create(&r->host, NULL);
    bind_something();
    assert_int_equal(ssfr_gl_create(&r->gl, SSFR_GL_CURRENT), SSFR_OK);
    r->graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), r->gl);
    test_scene_create_usual(&r->s, W, H);
}

static void tear_down(rig *r)
{
    test_scene_destroy(&r->s);
    ssfr_graph_destroy(&r->graph);
    ssfr_gl_destroy(&r->gl);
    assert_int_equal(glGetError(), GL_NO_ERROR);
    test_host_destroy(&r->host);
}

static GLuint make_texture(GLenum format, int w, int h)
{
    GLuint texture;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, format, w, h);
    return texture;
}

/* The first c of four channels of a texture, as the host sees them. */
static ssfr_field *look_at(GLuint texture, int w, int h, int c)
{
    ssfr_field *field = test_image(w, h, c, 0);
    float *values = calloc((size_t)w * (size_t)h * 4, sizeof *values);
    assert_non_null(values);
    glPixelStorei(GL_PACK_ROW_LENGTH, 0);
    glGetTextureImage(texture, 0, GL_RGBA, GL_FLOAT, (GLsizei)((size_t)w * (size_t)h * 4 * sizeof *values), values);
    glPixelStorei(GL_PACK_ROW_LENGTH, 77);
    for (int i = 0; i < w * h; i++)
        for (int k = 0; k < c; k++) field->data[c * i + k] = (double)values[4 * i + k];
    free(values);
    return field;
}

/* Values that a half float holds, and so any format. */
static ssfr_field *pattern(int w, int h, int c, double scale, double start)
{
    ssfr_field *field = test_image(w, h, c, 0);
    for (int i = 0; i < w * h * c; i++) field->data[i] = start + scale * (i % 37) / 64;
    return field;
}

/* A texture made the old way, whose default filter asks for mipmaps that are not there. */
static GLuint upload(const ssfr_field *field, GLint format)
{
    GLuint texture;
    GLint bound;
    float *values = calloc((size_t)field->w * (size_t)field->h * 4, sizeof *values);
    assert_non_null(values);
    for (int i = 0; i < field->w * field->h; i++)
        for (int k = 0; k < field->c; k++) values[4 * i + k] = (float)field->data[field->c * i + k];
    glGenTextures(1, &texture);
    glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, format, field->w, field->h, 0, GL_RGBA, GL_FLOAT, values);
    glBindTexture(GL_TEXTURE_2D, (GLuint)bound);
    free(values);
    return texture;
}

/* ---- the host's state -------------------------------------------------------------------------------------------- */

static void assert_state(const char *before, const char *after_what)
{
    char *after = test_host_snapshot();
    if (strcmp(before, after) != 0) print_error("%s:\n", after_what);
    test_host_assert_same(before, after);
    free(after);
    assert_int_equal(glGetError(), GL_NO_ERROR);
}

static void every_call_leaves_the_hosts_state_as_found(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    char *before = test_host_snapshot();
    ssfr_gl *gl = NULL;
    test_mesh box = test_mesh_box(0.2, 0.1, 0.3);
    ssfr_mesh *mesh = test_mesh_make(&box);
    ssfr_field *color = pattern(W, H, 3, 1, 0), *read = NULL;
    const GLuint target = make_texture(GL_RGBA32F, W, H), scene = make_texture(GL_RGBA16F, W, H);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), gl);
    assert_state(before, "created");
    assert_int_equal(ssfr_graph_run(graph, &r.s.scene, NULL), SSFR_OK);
    assert_state(before, "run");
    r.s.scene.environment = color;
    r.s.solids[1].shape = SSFR_MESH, r.s.solids[1].mesh = mesh;
    assert_int_equal(ssfr_graph_set(graph, "composite.reflection", "scene"), SSFR_OK);
    assert_int_equal(ssfr_graph_run(graph, &r.s.scene, NULL), SSFR_OK);
    assert_state(before, "run with a mesh and a map of the environment");
    assert_int_equal(ssfr_graph_read(graph, "color", &read), SSFR_OK);
    assert_state(before, "read");
    assert_int_equal(ssfr_graph_import(graph, "scene_color", color), SSFR_OK);
    assert_state(before, "imported");
    assert_int_equal(ssfr_graph_import_texture(graph, "scene_color", scene), SSFR_OK);
    assert_int_equal(ssfr_graph_export_texture(graph, target), SSFR_OK);
    assert_state(before, "textures given");
    assert_int_equal(ssfr_graph_run(graph, &r.s.scene, &(ssfr_run_options){.keep_all = true, .timing = true}), SSFR_OK);
    assert_state(before, "run with all kept and timed");
    r.s.scene.camera.near = -1;
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(graph, &r.s.scene, NULL), "near -1");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_export_texture(graph, 4711), "4711 is not a texture");
    assert_state(before, "failed");
    ssfr_graph_destroy(&graph);
    ssfr_gl_destroy(&gl);
    assert_state(before, "destroyed");
    ssfr_field_destroy(&read);
    ssfr_field_destroy(&color);
    ssfr_mesh_destroy(&mesh);
    test_mesh_finish(&box);
    free(before);
    tear_down(&r);
}

static void the_picture_is_that_of_a_context_of_our_own(void **state)
{
    (void)state;
    rig r;
    ssfr_gl *own_gl = test_gl_or_skip();
    set_up(&r);
    ssfr_graph *own = test_graph(ssfr_pipeline_find("vanderlaan2009"), own_gl);
    for (int i = 0; i < 2; i++) { /* in turns, the host's context current in between */
        ssfr_field *expected = test_graph_picture(own, &r.s.scene, "color", false);
        ssfr_field *got = test_graph_picture(r.graph, &r.s.scene, "color", false);
        assert_int_equal(test_n_different(got, expected), 0);
        ssfr_field_destroy(&expected);
        ssfr_field_destroy(&got);
    }
    ssfr_graph_destroy(&own);
    ssfr_gl_destroy(&own_gl);
    tear_down(&r);
}

/* ---- into the host's texture ------------------------------------------------------------------------------------- */

static void the_picture_is_drawn_into_the_hosts_texture(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    const GLuint target = make_texture(GL_RGBA32F, W, H);
    ssfr_field *expected = test_graph_picture(r.graph, &r.s.scene, "color", false);
    assert_int_equal(ssfr_graph_export_texture(r.graph, target), SSFR_OK);
    const double held = ssfr_graph_report(r.graph)->image_bytes;
    for (int keep_all = 0; keep_all < 2; keep_all++) {
        ssfr_field *read = test_graph_picture(r.graph, &r.s.scene, "color", keep_all), *seen = look_at(target, W, H, 3);
        if (!keep_all) assert_true(ssfr_graph_report(r.graph)->image_bytes == held - 16 * W * H);
        assert_int_equal(test_n_different(seen, expected), 0);
        assert_int_equal(test_n_different(read, expected), 0);
        ssfr_field_destroy(&read);
        ssfr_field_destroy(&seen);
    }
    ssfr_field_destroy(&expected);
    assert_int_equal(ssfr_graph_export_texture(r.graph, target), SSFR_OK);
    ssfr_graph_destroy(&r.graph);
    assert_true(glIsTexture(target)); /* it is the host's */
    tear_down(&r);
}

/* Foam makes a second version of the picture: the last one that is drawn is the host's, and only that one. */
static void foam_switched_on_and_off_ends_in_the_hosts_texture(void **state)
{
    (void)state;
    static const char *const settings[] = {"noise_foam.strength=0", "noise_foam.strength=1", "noise_foam.strength=0",
                                           "composite.off=1", "noise_foam.strength=1"};
    rig r;
    set_up(&r);
    const GLuint target = make_texture(GL_RGBA32F, W, H);
    ssfr_graph *own = test_graph(ssfr_pipeline_find("vanderlaan2009"), r.gl);
    assert_int_equal(ssfr_graph_export_texture(r.graph, target), SSFR_OK);
    for (size_t i = 0; i < SSFR_COUNT(settings); i++) {
        test_graph_set(own, (const char *[]){settings[i], NULL});
        test_graph_set(r.graph, (const char *[]){settings[i], NULL});
        ssfr_field *expected = test_graph_picture(own, &r.s.scene, "color", false);
        ssfr_field *read = test_graph_picture(r.graph, &r.s.scene, "color", false), *seen = look_at(target, W, H, 3);
        assert_int_equal(test_n_different(seen, expected), 0);
        assert_int_equal(test_n_different(read, expected), 0);
        ssfr_field *const all[] = {expected, read, seen};
        for (size_t k = 0; k < SSFR_COUNT(all); k++) ssfr_field_destroy(&(ssfr_field *){all[k]});
    }
    ssfr_graph_destroy(&own);
    tear_down(&r);
}

/* Sums of halves are not made in the host's image of floats, but copied into it. */
static void halves_arrive_in_the_hosts_texture_as_they_are(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    const GLuint target = make_texture(GL_R32F, W, H);
    ssfr_graph *graph = NULL;
    assert_int_equal(ssfr_graph_create_for_pass(&graph, ssfr_pass_find("thickness"), r.gl), SSFR_OK);
    test_graph_set(graph, (const char *[]){"thickness.storage=half", NULL});
    ssfr_field *expected = test_graph_picture(graph, &r.s.scene, "thickness", false);
    assert_int_equal(ssfr_graph_export_texture(graph, target), SSFR_OK);
    for (int half = 0; half < 2; half++) {
        test_graph_set(graph, (const char *[]){half ? "thickness.storage=half" : "thickness.storage=float", NULL});
        ssfr_field *read = test_graph_picture(graph, &r.s.scene, "thickness", false), *seen = look_at(target, W, H, 1);
        assert_int_equal(test_n_different(seen, read), 0);
        assert_true((test_n_different(read, expected) == 0) == half);
        ssfr_field_destroy(&read);
        ssfr_field_destroy(&seen);
    }
    ssfr_field_destroy(&expected);
    ssfr_graph_destroy(&graph);
    tear_down(&r);
}

static void the_hosts_texture_is_filled_when_no_pass_draws_into_it(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    const GLuint target = make_texture(GL_RGBA32F, W, H);
    assert_int_equal(ssfr_graph_export_texture(r.graph, target), SSFR_OK);
    r.s.scene.particles = NULL;
    ssfr_field *expected = test_graph_picture(r.graph, &r.s.scene, "scene_color", false);
    ssfr_field *seen = look_at(target, W, H, 3);
    assert_int_equal(test_n_different(seen, expected), 0);
    ssfr_field_destroy(&expected);
    ssfr_field_destroy(&seen);
    tear_down(&r);
}

static void targets_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    rig r;
    GLuint cube, empty, many;
    set_up(&r);
    glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &cube);
    glCreateTextures(GL_TEXTURE_2D, 1, &empty);
    glCreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 1, &many);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_export_texture(r.graph, 4711), "export: 4711 is not a texture");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_export_texture(r.graph, cube), "is not GL_TEXTURE_2D");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_export_texture(r.graph, many), "is not GL_TEXTURE_2D");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_export_texture(r.graph, empty), "has no storage");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_export_texture(r.graph, make_texture(GL_RGBA16F, W, H)),
                 "is not GL_RGBA32F");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_export_texture(r.graph, make_texture(GL_RGBA32UI, W, H)),
                 "has not 3 channels of floats");
    const GLuint small = make_texture(GL_RGBA32F, W - 1, H), right = make_texture(GL_RGBA32F, W, H);
    assert_int_equal(ssfr_graph_export_texture(r.graph, small), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(r.graph, &r.s.scene, NULL),
                 "image of 96 x 64 pixels for a texture of 95 x 64");
    assert_int_equal(ssfr_graph_export_texture(r.graph, right), SSFR_OK);
    assert_int_equal(ssfr_graph_run(r.graph, &r.s.scene, NULL), SSFR_OK);
    tear_down(&r);
}

/* After the host took its texture back nothing is drawn into it any more. */
static void a_texture_replaced_is_not_touched_again(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    const GLuint first = make_texture(GL_RGBA32F, W, H), second = make_texture(GL_RGBA32F, W, H);
    const GLuint small = make_texture(GL_RGBA32F, 8, 8);
    assert_int_equal(ssfr_graph_export_texture(r.graph, first), SSFR_OK);
    assert_int_equal(ssfr_graph_run(r.graph, &r.s.scene, NULL), SSFR_OK);
    glClearTexImage(first, 0, GL_RGBA, GL_FLOAT, (const float[4]){0.25f, 0.25f, 0.25f, 0.25f});
    assert_int_equal(ssfr_graph_export_texture(r.graph, second), SSFR_OK);
    ssfr_field *expected = test_graph_picture(r.graph, &r.s.scene, "color", false), *seen = look_at(second, W, H, 3);
    assert_int_equal(test_n_different(seen, expected), 0);
    ssfr_field_destroy(&seen);
    assert_int_equal(ssfr_graph_export_texture(r.graph, small), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(r.graph, &r.s.scene, NULL), "for a texture of 8 x 8");
    seen = look_at(first, W, H, 3);
    for (int i = 0; i < W * H * 3; i++) assert_true(seen->data[i] == 0.25);
    ssfr_field_destroy(&seen);
    ssfr_field_destroy(&expected);
    tear_down(&r);
}

/* ---- from the host's textures ------------------------------------------------------------------------------------ */

static void the_hosts_scene_is_composited_over_in_any_format(void **state)
{
    (void)state;
    static const GLint formats[] = {GL_RGBA32F, GL_RGBA16F, GL_RGB16F, GL_RGB32F};
    rig r;
    set_up(&r);
    ssfr_field *color = pattern(W, H, 3, 1, 0), *depth = pattern(W, H, 1, -0.25, -1.25);
    ssfr_graph *fields = test_graph(ssfr_pipeline_find("vanderlaan2009"), r.gl);
    assert_int_equal(ssfr_graph_import(fields, "scene_color", color), SSFR_OK);
    assert_int_equal(ssfr_graph_import(fields, "scene_depth", depth), SSFR_OK);
    ssfr_field *expected = test_graph_picture(fields, &r.s.scene, "color", false);
    assert_int_equal(ssfr_graph_import_texture(r.graph, "scene_depth", upload(depth, GL_R32F)), SSFR_OK);
    for (size_t i = 0; i < SSFR_COUNT(formats); i++) {
        assert_int_equal(ssfr_graph_import_texture(r.graph, "scene_color", upload(color, formats[i])), SSFR_OK);
        ssfr_field *got = test_graph_picture(r.graph, &r.s.scene, "color", false);
        assert_int_equal(test_graph_node(r.graph, "background")->status, SSFR_GIVEN);
        assert_int_equal(test_n_different(got, expected), 0);
        ssfr_field_destroy(&got);
    }
    ssfr_field *const all[] = {color, depth, expected};
    for (size_t i = 0; i < SSFR_COUNT(all); i++) ssfr_field_destroy(&(ssfr_field *){all[i]});
    ssfr_graph_destroy(&fields);
    tear_down(&r);
}

static void a_host_may_have_its_scene_drawn_over_in_place(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    ssfr_field *color = pattern(W, H, 3, 1, 0);
    for (int fluid = 1; fluid >= 0; fluid--) {
        const GLuint picture = upload(color, GL_RGBA32F);
        ssfr_graph *fields = test_graph(ssfr_pipeline_find("vanderlaan2009"), r.gl);
        if (!fluid) r.s.scene.particles = NULL;
        assert_int_equal(ssfr_graph_import(fields, "scene_color", color), SSFR_OK);
        ssfr_field *expected = test_graph_picture(fields, &r.s.scene, "color", false);
        assert_int_equal(ssfr_graph_import_texture(r.graph, "scene_color", picture), SSFR_OK);
        assert_int_equal(ssfr_graph_export_texture(r.graph, picture), SSFR_OK);
        assert_int_equal(ssfr_graph_run(r.graph, &r.s.scene, NULL), SSFR_OK);
        ssfr_field *seen = look_at(picture, W, H, 3);
        assert_int_equal(test_n_different(seen, expected), 0);
        ssfr_field_destroy(&seen);
        ssfr_field_destroy(&expected);
        ssfr_graph_destroy(&fields);
    }
    ssfr_field_destroy(&color);
    tear_down(&r);
}

static void textures_and_fields_replace_each_other(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    ssfr_field *a = pattern(W, H, 3, 1, 0), *b = pattern(W, H, 3, 0.5, 0.25);
    const GLuint texture = upload(a, GL_RGBA32F);
    for (int i = 0; i < 4; i++) {
        if (i % 2) assert_int_equal(ssfr_graph_import(r.graph, "scene_color", b), SSFR_OK);
        else assert_int_equal(ssfr_graph_import_texture(r.graph, "scene_color", texture), SSFR_OK);
        ssfr_field *got = test_graph_picture(r.graph, &r.s.scene, "scene_color", false);
        assert_int_equal(test_n_different(got, i % 2 ? b : a), 0);
        ssfr_field_destroy(&got);
    }
    ssfr_field *seen = look_at(texture, W, H, 3);
    assert_int_equal(test_n_different(seen, a), 0); /* the host's texture was never written */
    ssfr_field_destroy(&seen);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    tear_down(&r);
}

/* Shaders would read another level than the one that is drawn into, copied and read back. */
static void textures_that_begin_at_another_level_are_refused(void **state)
{
    (void)state;
    GLuint texture;
    rig r;
    set_up(&r);
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 2, GL_RGBA32F, 2 * W, 2 * H);
    glTextureParameteri(texture, GL_TEXTURE_BASE_LEVEL, 1);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_import_texture(r.graph, "scene_color", texture),
                 "begins at level 1, not 0");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_export_texture(r.graph, texture), "begins at level 1, not 0");
    glTextureParameteri(texture, GL_TEXTURE_BASE_LEVEL, 0);
    assert_int_equal(ssfr_graph_export_texture(r.graph, texture), SSFR_OK);
    tear_down(&r);
}

static void sources_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_import_texture(r.graph, "scene_color", 4711), "4711 is not a texture");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_graph_import_texture(r.graph, "sky", 1), "sky: pipeline vanderlaan2009");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_import_texture(r.graph, "scene_color", make_texture(GL_RG32F, W, H)),
                 "has not 3 channels of floats or fractions");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_import_texture(r.graph, "scene_color", make_texture(GL_RGBA8I, W, H)),
                 "has not 3 channels of floats or fractions");
    assert_fails(SSFR_ERR_VALUE,
                 ssfr_graph_import_texture(r.graph, "scene_depth", make_texture(GL_DEPTH_COMPONENT32F, W, H)),
                 "scene_depth: texture");
    const GLuint odd = make_texture(GL_RGBA32F, W + 1, H);
    assert_int_equal(ssfr_graph_import_texture(r.graph, "scene_color", odd), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(r.graph, &r.s.scene, NULL),
                 "scene_color: 97 x 64 pixels given, the frame has 96 x 64");
    tear_down(&r);
}

/* ---- from the host's buffer -------------------------------------------------------------------------------------- */

enum { STRIDE = 7, FIRST = 2 };

/* The particles as a host's simulation holds them: shuffled, relative to an origin, between other things. */
static GLuint simulate(const ssfr_particles *p, const double origin[3])
{
    GLuint buffer;
    const size_t n = p->n, size = (FIRST + STRIDE * n) * sizeof(float);
    float *values = calloc(1, size);
    assert_non_null(values);
    for (size_t i = 0; i < FIRST + STRIDE * n; i++) values[i] = FLT_MAX;
    for (size_t i = 0; i < n; i++) {
        double at[3];
        ssfr_particles_position(p, i * 101 % n, at); /* n is no multiple of 101 */
        for (int k = 0; k < 3; k++) values[FIRST + STRIDE * i + (size_t)k] = (float)(at[k] - origin[k]);
    }
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, (GLsizeiptr)size, values, 0);
    free(values);
    return buffer;
}

static void the_hosts_particles_are_drawn_as_ours_are(void **state)
{
    (void)state;
    static const char *const forms[] = {"sphere_depth.splat=point", "sphere_depth.splat=quad",
                                        "sphere_depth.splat=exact"};
    const double origin[3] = {0.7, -0.3, 0.2};
    for (int i = 0; i < 4; i++) {
        rig r;
        set_up(&r);
        /* The mean distance of the host's particles is estimated: the flow's step is exact only where it is given. */
        test_graph_set(r.graph, (const char *[]){forms[i % 3], i < 3 ? "curvature_flow.dt=2e-4" : NULL, NULL});
        ssfr_field *expected = test_graph_picture(r.graph, &r.s.scene, "color", false);
        const GLuint buffer = simulate(r.s.particles, origin);
        assert_int_equal(ssfr_graph_import_buffer(r.graph, buffer, r.s.particles->n, STRIDE, FIRST, origin,
                                                  r.s.particles->radius), SSFR_OK);
        r.s.scene.particles = NULL;
        ssfr_field *got = test_graph_picture(r.graph, &r.s.scene, "color", false);
        if (!(test_psnr(got, expected) > (i < 3 ? 60 : 50))) fail_msg("case %d: %g dB", i, test_psnr(got, expected));
        assert_int_equal(ssfr_graph_report(r.graph)->n_particles, 432);
        assert_int_equal(ssfr_graph_report(r.graph)->n_packets_seen, (432 + SSFR_PACKET - 1) / SSFR_PACKET);
        ssfr_field *again = test_graph_picture(r.graph, &r.s.scene, "color", true);
        assert_int_equal(test_n_different(got, again), 0);
        assert_int_equal(ssfr_graph_run(r.graph, &r.s.scene, NULL), SSFR_OK);
        assert_int_equal(ssfr_graph_report(r.graph)->allocations, 0);
        ssfr_field *const all[] = {expected, got, again};
        for (size_t k = 0; k < SSFR_COUNT(all); k++) ssfr_field_destroy(&(ssfr_field *){all[k]});
        tear_down(&r);
    }
}

static void the_hosts_particles_may_be_far_from_the_worlds_origin(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    const double away[3] = {1e6, -2e5, 7e5}, origin[3] = {0, 0, 0};
    test_graph_set(r.graph, (const char *[]){"background.off=1", NULL});
    const GLuint buffer = simulate(r.s.particles, origin);
    ssfr_field *pictures[2];
    r.s.scene.particles = NULL;
    for (int i = 0; i < 2; i++) {
        assert_int_equal(ssfr_graph_import_buffer(r.graph, buffer, r.s.particles->n, STRIDE, FIRST, i ? away : origin,
                                                  r.s.particles->radius), SSFR_OK);
        for (int k = 0; k < 3 && i; k++) r.s.scene.camera.eye[k] += away[k];
        pictures[i] = test_graph_picture(r.graph, &r.s.scene, "color", false);
    }
    assert_true(test_psnr(pictures[1], pictures[0]) > 60);
    ssfr_field_destroy(&pictures[0]);
    ssfr_field_destroy(&pictures[1]);
    tear_down(&r);
}

static void no_particles_of_the_host_show_the_scene(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    const double origin[3] = {0, 0, 0};
    const GLuint buffer = simulate(r.s.particles, origin);
    assert_int_equal(ssfr_graph_import_buffer(r.graph, buffer, 0, 3, 0, origin, 0.04), SSFR_OK);
    r.s.scene.particles = NULL;
    ssfr_field *picture = test_graph_picture(r.graph, &r.s.scene, "color", false);
    ssfr_field *scene = test_graph_read(r.graph, "scene_color");
    assert_int_equal(test_n_different(picture, scene), 0);
    ssfr_field_destroy(&picture);
    ssfr_field_destroy(&scene);
    tear_down(&r);
}

static void buffers_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    const double origin[3] = {0, 0, 0}, nowhere[3] = {0, (double)NAN, 0};
    GLuint b;
    glCreateBuffers(1, &b);
    glNamedBufferStorage(b, 400, NULL, 0); /* 100 floats */
#define GIVE(buffer, n, stride, first, origin, radius) \
    ssfr_graph_import_buffer(r.graph, buffer, n, stride, first, origin, radius)
    assert_int_equal(GIVE(b, 14, 7, 6, origin, 0.02), SSFR_OK);
    assert_int_equal(GIVE(b, 1, 7, 97, origin, 0.02), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, GIVE(b, 14, 7, 7, origin, 0.02), "14 of stride 7 from float 7 do not fit buffer");
    assert_fails(SSFR_ERR_VALUE, GIVE(b, 34, 3, 0, origin, 0.02), "34 of stride 3 from float 0 do not fit buffer");
    assert_fails(SSFR_ERR_VALUE, GIVE(b, 1, 3, 98, origin, 0.02), ", 400 bytes");
    assert_fails(SSFR_ERR_VALUE, GIVE(b, INT32_MAX / 8, INT32_MAX, 0, origin, 0.02), "do not fit buffer");
    assert_fails(SSFR_ERR_VALUE, GIVE(b, SIZE_MAX, 3, 0, origin, 0.02), "particles: 18446744073709551615 of stride 3");
    assert_fails(SSFR_ERR_VALUE, GIVE(b, 1, SIZE_MAX, 0, origin, 0.02), "of stride 18446744073709551615");
    assert_fails(SSFR_ERR_VALUE, GIVE(b, 1, 3, SIZE_MAX, origin, 0.02), "from float 18446744073709551615");
    assert_fails(SSFR_ERR_VALUE, GIVE(b, 1, 2, 0, origin, 0.02), "1 of stride 2 floats");
    assert_fails(SSFR_ERR_VALUE, GIVE(b, 1, 3, 0, origin, 0), "radius 0 m");
    assert_fails(SSFR_ERR_VALUE, GIVE(b, 1, 3, 0, origin, (double)NAN), "radius nan m");
    assert_fails(SSFR_ERR_VALUE, GIVE(b, 1, 3, 0, nowhere, 0.02), "origin 0,nan,0 is not finite");
    assert_fails(SSFR_ERR_VALUE, GIVE(4711, 1, 3, 0, origin, 0.02), "4711 is not a buffer");
#undef GIVE
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(r.graph, &r.s.scene, NULL), "both the scene's and a buffer's");
    tear_down(&r);
}

static void buffers_beyond_what_shaders_read_are_refused(void **state)
{
    (void)state;
    rig r;
    set_up(&r);
    const double origin[3] = {0, 0, 0};
    GLint64 most = 0; /* bytes */
    GLuint b;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    const size_t n = (size_t)most / (3 * sizeof(float));
    if (most < 1 << 28) {
        glCreateBuffers(1, &b);
        glNamedBufferStorage(b, most + 1200, NULL, 0);
        assert_int_equal(ssfr_graph_import_buffer(r.graph, b, n, 3, 0, origin, 0.02), SSFR_OK);
        assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_graph_import_buffer(r.graph, b, n + 1, 3, 0, origin, 0.02),
                     "particles: shaders of this GPU read");
    }
    tear_down(&r);
    if (most >= 1 << 28) skip(); /* no test makes so large a buffer */
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

static void without_its_context_a_graph_only_fails(void **state)
{
    (void)state;
    rig r;
    ssfr_graph *graph = NULL;
    ssfr_field *read = NULL;
    set_up(&r);
    assert_int_equal(ssfr_graph_run(r.graph, &r.s.scene, NULL), SSFR_OK);
    test_host_destroy(&r.host);
    assert_fails(SSFR_ERR_GL, ssfr_graph_create(&graph, ssfr_pipeline_at(0), r.gl), "no GL context is current");
    assert_fails(SSFR_ERR_GL, ssfr_graph_read(r.graph, "color", &read), "no GL context is current");
    assert_fails(SSFR_ERR_GL, ssfr_graph_run(r.graph, &r.s.scene, NULL), "no GL context is current");
    assert_fails(SSFR_ERR_GL, ssfr_graph_export_texture(r.graph, 1), "no GL context is current");
    assert_null(read);
    test_clear_log();
    ssfr_graph_destroy(&r.graph);
    assert_int_equal(test_n_errors(), 1); /* says that it could not delete */
    ssfr_gl_destroy(&r.gl);
    test_scene_destroy(&r.s);
}

static void what_the_host_gave_can_be_taken_back(void **state)
{
    (void)state;
    static const double origin[3] = {0, 0, 0};
    rig r;
    set_up(&r);
    const GLuint target = make_texture(GL_RGBA32F, W, H), scene = make_texture(GL_RGBA32F, W, H);
    const float red[4] = {1, 0, 0, 0};
    GLuint buffer;
    ssfr_field *own = test_graph_picture(r.graph, &r.s.scene, "color", false);
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, 48, NULL, 0);
    assert_int_equal(ssfr_graph_export_texture(r.graph, target), SSFR_OK);
    assert_int_equal(ssfr_graph_import_texture(r.graph, "scene_color", scene), SSFR_OK);
    assert_int_equal(ssfr_graph_import_buffer(r.graph, buffer, 2, 3, 0, origin, 0.02385), SSFR_OK);
    assert_int_equal(ssfr_graph_export_texture(r.graph, 0), SSFR_OK);
    assert_int_equal(ssfr_graph_import_texture(r.graph, "scene_color", 0), SSFR_OK);
    assert_int_equal(ssfr_graph_import_buffer(r.graph, 0, 0, 0, 0, NULL, 0), SSFR_OK);
    glClearTexImage(target, 0, GL_RGBA, GL_FLOAT, red);
    ssfr_field *back = test_graph_picture(r.graph, &r.s.scene, "color", false), *seen = look_at(target, W, H, 3);
    assert_int_equal(test_n_different(back, own), 0);
    for (int i = 0; i < W * H; i++) assert_true(seen->data[3 * i] == 1 && seen->data[3 * i + 1] == 0);
    ssfr_field_destroy(&own), ssfr_field_destroy(&back), ssfr_field_destroy(&seen);
    tear_down(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_call_leaves_the_hosts_state_as_found),
        cmocka_unit_test(the_picture_is_that_of_a_context_of_our_own),
        cmocka_unit_test(the_picture_is_drawn_into_the_hosts_texture),
        cmocka_unit_test(foam_switched_on_and_off_ends_in_the_hosts_texture),
        cmocka_unit_test(halves_arrive_in_the_hosts_texture_as_they_are),
        cmocka_unit_test(the_hosts_texture_is_filled_when_no_pass_draws_into_it),
        cmocka_unit_test(targets_that_do_not_fit_are_refused),
        cmocka_unit_test(a_texture_replaced_is_not_touched_again),
        cmocka_unit_test(the_hosts_scene_is_composited_over_in_any_format),
        cmocka_unit_test(a_host_may_have_its_scene_drawn_over_in_place),
        cmocka_unit_test(textures_and_fields_replace_each_other),
        cmocka_unit_test(textures_that_begin_at_another_level_are_refused),
        cmocka_unit_test(sources_that_do_not_fit_are_refused),
        cmocka_unit_test(the_hosts_particles_are_drawn_as_ours_are),
        cmocka_unit_test(the_hosts_particles_may_be_far_from_the_worlds_origin),
        cmocka_unit_test(no_particles_of_the_host_show_the_scene),
        cmocka_unit_test(buffers_that_do_not_fit_are_refused),
        cmocka_unit_test(what_the_host_gave_can_be_taken_back),
        cmocka_unit_test(buffers_beyond_what_shaders_read_are_refused),
        cmocka_unit_test(without_its_context_a_graph_only_fails),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

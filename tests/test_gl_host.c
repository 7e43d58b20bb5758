/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_gl_host.c: inside a host program's GL context: its state is left as found, and its errors stay its own. */
#include "gl/gl.h"
#include "tests/gl_host.h"

static const EGLint debug_context[] = {EGL_CONTEXT_OPENGL_DEBUG, EGL_TRUE, EGL_NONE};

/* What a host owns and binds. */
typedef struct objects {
    GLuint program, vertex_array, framebuffers[2], target, textures[16], cube, volumes[2], array;
    GLuint samplers[16], buffers[12];
} objects;

static GLuint compile(GLenum stage, const char *text)
{
    const GLuint shader = glCreateShader(stage);
    GLint ok;
    glShaderSource(shader, 1, &text, NULL);
    glCompileShader(shader);
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    assert_true(ok);
    return shader;
}

static GLuint host_program(void)
{
    const GLuint vert = compile(GL_VERTEX_SHADER, "#version 450 core\nout vec4 v_place;\nvoid main() {\n"
                                                  "v_place = vec4(gl_VertexID); gl_Position = v_place; }\n");
    const GLuint frag = compile(GL_FRAGMENT_SHADER, "#version 450 core\nout vec4 o_colour;\n"
                                                    "void main() { o_colour = vec4(2.385); }\n");
    const GLuint program = glCreateProgram();
    const char *captured = "v_place";
    glAttachShader(program, vert);
    glAttachShader(program, frag);
    glTransformFeedbackVaryings(program, 1, &captured, GL_INTERLEAVED_ATTRIBS);
    glLinkProgram(program);
    glDeleteShader(vert);
    glDeleteShader(frag);
    return program;
}

static void create_objects(objects *o)
{
    o->program = host_program();
    glCreateVertexArrays(1, &o->vertex_array);
    glCreateTextures(GL_TEXTURE_2D, 1, &o->target);
    glTextureStorage2D(o->target, 1, GL_RGBA8, 64, 48);
    glCreateFramebuffers(2, o->framebuffers);
    for (int i = 0; i < 2; i++) glNamedFramebufferTexture(o->framebuffers[i], GL_COLOR_ATTACHMENT0, o->target, 0);
    glCreateTextures(GL_TEXTURE_2D, 16, o->textures);
    for (int i = 0; i < 16; i++) glTextureStorage2D(o->textures[i], 1, GL_R8, 4, 4);
    glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &o->cube);
    glCreateTextures(GL_TEXTURE_3D, 2, o->volumes);
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &o->array);
    glCreateSamplers(16, o->samplers);
    glCreateBuffers(12, o->buffers);
    for (int i = 0; i < 12; i++) glNamedBufferStorage(o->buffers[i], 4096, NULL, 0);
}

static const GLenum buffer_targets[] = {
    GL_ARRAY_BUFFER, GL_DRAW_INDIRECT_BUFFER,  GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER,
    GL_QUERY_BUFFER, GL_SHADER_STORAGE_BUFFER, GL_UNIFORM_BUFFER,
};

static void bind_objects(const objects *o)
{
    glUseProgram(o->program);
    glBindVertexArray(o->vertex_array);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, o->framebuffers[0]);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, o->framebuffers[1]);
    for (GLuint i = 0; i < 16; i++) {
        glBindTextureUnit(i, o->textures[i]);
        glBindTextureUnit(i, o->cube);
        glBindTextureUnit(i, o->volumes[0]);
        glBindTextureUnit(i, o->array);
        glBindSampler(i, o->samplers[i]);
    }
    glActiveTexture(GL_TEXTURE0 + 21);
    for (GLuint i = 0; i < 3; i++) glBindBufferRange(GL_SHADER_STORAGE_BUFFER, i, o->buffers[i], 256 * (i + 1), 512);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, o->buffers[3]);
    glBindBufferRange(GL_UNIFORM_BUFFER, 0, o->buffers[4], 1024, 256);
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, o->buffers[5]);
    for (size_t i = 0; i < SSFR_COUNT(buffer_targets); i++) glBindBuffer(buffer_targets[i], o->buffers[5 + i]);
}

static const struct pixel_store {
    GLenum name;
    GLint host, pass;
} pixel_stores[] = {
    {GL_PACK_SWAP_BYTES, 1, 0},    {GL_PACK_LSB_FIRST, 1, 0},    {GL_PACK_ROW_LENGTH, 33, 99},
    {GL_PACK_IMAGE_HEIGHT, 17, 5}, {GL_PACK_SKIP_ROWS, 2, 1},    {GL_PACK_SKIP_PIXELS, 3, 4},
    {GL_PACK_SKIP_IMAGES, 1, 2},   {GL_PACK_ALIGNMENT, 8, 2},    {GL_UNPACK_SWAP_BYTES, 1, 0},
    {GL_UNPACK_LSB_FIRST, 1, 0},   {GL_UNPACK_ROW_LENGTH, 35, 99}, {GL_UNPACK_IMAGE_HEIGHT, 19, 5},
    {GL_UNPACK_SKIP_ROWS, 4, 1},   {GL_UNPACK_SKIP_PIXELS, 5, 4}, {GL_UNPACK_SKIP_IMAGES, 1, 2},
    {GL_UNPACK_ALIGNMENT, 1, 2},
};

static const GLenum capabilities[] = {
    GL_DEPTH_TEST,         GL_CULL_FACE,      GL_STENCIL_TEST,        GL_FRAMEBUFFER_SRGB,
    GL_DITHER,             GL_PROGRAM_POINT_SIZE, GL_PRIMITIVE_RESTART, GL_PRIMITIVE_RESTART_FIXED_INDEX,
    GL_RASTERIZER_DISCARD, GL_COLOR_LOGIC_OP, GL_DEPTH_CLAMP,         GL_POLYGON_SMOOTH,
    GL_POLYGON_OFFSET_FILL, GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE1,     GL_CLIP_DISTANCE2,
    GL_CLIP_DISTANCE3,     GL_CLIP_DISTANCE4, GL_CLIP_DISTANCE5,      GL_CLIP_DISTANCE6,
    GL_CLIP_DISTANCE7,
};

static void toggle(GLenum capability)
{
    (glIsEnabled(capability) ? glDisable : glEnable)(capability);
}

static void set_indexed(void)
{
    for (GLuint i = 0; i < 8; i++) {
        glEnablei(GL_BLEND, i);
        glColorMaski(i, i & 1, i & 2 ? GL_TRUE : GL_FALSE, i & 4 ? GL_TRUE : GL_FALSE, i == 7 ? GL_FALSE : GL_TRUE);
        glBlendFuncSeparatei(i, GL_DST_COLOR, GL_SRC_ALPHA, GL_DST_ALPHA, GL_SRC_COLOR + i % 2);
        glBlendEquationSeparatei(i, i & 1 ? GL_MAX : GL_FUNC_SUBTRACT, GL_MIN);
    }
    for (GLuint i = 0; i < 16; i++) {
        const GLfloat shift = (GLfloat)i + 2.385f;
        glViewportIndexedf(i, shift, 2 * shift, 10 + shift, 20 + shift);
        glDepthRangeIndexed(i, 0.125 + 0.01 * i, 0.75 - 0.01 * i);
        glScissorIndexed(i, (GLint)i + 1, 2, 11 + (GLint)i, 23);
        glEnablei(GL_SCISSOR_TEST, i);
    }
}

static int n_heard;
static GLuint heard_id;

static void APIENTRY hear(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length, const GLchar *text,
                          const void *user)
{
    (void)source, (void)type, (void)severity, (void)length, (void)text, (void)user;
    n_heard++;
    heard_id = id;
}

/* No piece of state keeps its initial value. */
static void set_everything(objects *o)
{
    create_objects(o);
    for (size_t i = 0; i < SSFR_COUNT(capabilities); i++) toggle(capabilities[i]);
    for (size_t i = 0; i < SSFR_COUNT(pixel_stores); i++) glPixelStorei(pixel_stores[i].name, pixel_stores[i].host);
    toggle(GL_DEBUG_OUTPUT);
    toggle(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    set_indexed();
    glDepthMask(GL_FALSE);
    glDepthFunc(GL_NOTEQUAL);
    glCullFace(GL_FRONT_AND_BACK);
    glFrontFace(GL_CW);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    glPointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, GL_LOWER_LEFT);
    glClearColor(0.1f, 0.2f, 0.3f, 2.385f);
    glDebugMessageCallback(hear, &heard_id);
    bind_objects(o);
    assert_int_equal(glGetError(), GL_NO_ERROR);
}

static void fill(ssfr_gl *gl, const ssfr_texture *target, const float colour[4])
{
    unsigned program;
    const ssfr_texture *const targets[] = {target};
    assert_int_equal(ssfr_program_get(gl, &program, "fill.vert", "fill.frag", NULL), SSFR_OK);
    assert_int_equal(ssfr_gl_target(gl, 1, targets), SSFR_OK);
    glUseProgram(program);
    glUniform4fv(glGetUniformLocation(program, "u_colour"), 1, colour);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

/* What careless passes may leave behind: everything other than in the baseline and than in the host. */
static void make_a_mess(const objects *o, const ssfr_texture *texture)
{
    for (size_t i = 0; i < SSFR_COUNT(pixel_stores); i++) glPixelStorei(pixel_stores[i].name, pixel_stores[i].pass);
    for (size_t i = 0; i < SSFR_COUNT(buffer_targets); i++) glBindBuffer(buffer_targets[i], o->buffers[0]);
    for (GLuint i = 0; i < SSFR_GL_STORAGE; i++) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, o->buffers[11]);
    for (GLuint i = 0; i < SSFR_GL_UNIFORMS; i++) glBindBufferBase(GL_UNIFORM_BUFFER, i, o->buffers[10]);
    for (GLuint i = 0; i < SSFR_GL_UNITS; i++) {
        glBindTextureUnit(i, texture->name);
        glBindTextureUnit(i, o->volumes[1]);
        glBindSampler(i, o->samplers[15 - i]);
    }
    glActiveTexture(GL_TEXTURE0 + 3);
    glBindVertexArray(0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_ZERO, GL_ZERO, GL_ONE, GL_ONE);
    glBlendEquation(GL_MAX);
    glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    glEnable(GL_SCISSOR_TEST);
    glScissor(1, 1, 2, 2);
    glViewport(1, 1, 2, 2);
    glDepthRange(1, 0);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);
    glCullFace(GL_FRONT);
    glFrontFace(GL_CCW);
    glPolygonMode(GL_FRONT_AND_BACK, GL_POINT);
    glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glPointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, GL_UPPER_LEFT);
    glClearColor(1, 1, 1, 1);
}

/* A frame as the graph runs it: passes that draw, write, read back and leave a mess. */
static void run_a_frame(ssfr_gl *gl, const objects *o)
{
    static const float colour[4] = {2.385f, -1e30f, 0.25f, -7};
    ssfr_texture texture;
    ssfr_field *drawn = NULL, *written = NULL;
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    ssfr_gl_push(gl, "first");
    assert_int_equal(ssfr_texture_create(gl, &texture, 37, 23, 4, SSFR_STORE_FLOAT), SSFR_OK);
    for (size_t i = 0; i < SSFR_COUNT(capabilities); i++) toggle(capabilities[i]);
    make_a_mess(o, &texture);
    ssfr_gl_pop(gl);
    ssfr_gl_baseline(gl);
    fill(gl, &texture, colour);
    assert_int_equal(ssfr_texture_read(&texture, &drawn), SSFR_OK);
    for (int i = 0; i < 37 * 23 * 4; i++) assert_true(drawn->data[i] == (double)colour[i % 4]);
    drawn->data[2385] = 0.5;
    assert_int_equal(ssfr_texture_write(&texture, drawn), SSFR_OK);
    assert_int_equal(ssfr_texture_read(&texture, &written), SSFR_OK);
    assert_memory_equal(written->data, drawn->data, 37 * 23 * 4 * sizeof *drawn->data);
    make_a_mess(o, &texture);
    ssfr_texture_finish(&texture);
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK);
    ssfr_field_destroy(&drawn);
    ssfr_field_destroy(&written);
}

static void check_state_is_left(const EGLint *flags)
{
    test_host host;
    objects o;
    ssfr_gl *gl = NULL;
    test_host_create(&host, flags);
    char *initial = test_host_snapshot();
    set_everything(&o);
    char *before = test_host_snapshot();
    test_host_assert_differs(initial, before);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    char *created = test_host_snapshot();
    test_host_assert_same(before, created);
    run_a_frame(gl, &o);
    char *after = test_host_snapshot();
    test_host_assert_same(before, after);
    ssfr_gl_destroy(&gl);
    char *destroyed = test_host_snapshot();
    test_host_assert_same(before, destroyed);
    assert_int_equal(glGetError(), GL_NO_ERROR);
    free(initial), free(before), free(created), free(after), free(destroyed);
    test_host_destroy(&host);
}

static void host_state_is_left_as_found_in_a_debug_context(void **state)
{
    (void)state;
    check_state_is_left(debug_context);
}

static void host_state_is_left_as_found_in_a_plain_context(void **state)
{
    (void)state;
    check_state_is_left(NULL);
}

static void check_initial_and_half_set_state_is_left(const EGLint *flags)
{
    test_host host;
    objects o;
    ssfr_gl *gl = NULL;
    test_host_create(&host, flags);
    create_objects(&o);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    char *before = test_host_snapshot();
    run_a_frame(gl, &o);
    char *after = test_host_snapshot();
    test_host_assert_same(before, after);
    for (GLuint i = 0; i < 16; i += 3) glEnablei(GL_SCISSOR_TEST, i);
    for (GLuint i = 1; i < 8; i += 2) glEnablei(GL_BLEND, i);
    char *half_before = test_host_snapshot();
    run_a_frame(gl, &o);
    char *half_after = test_host_snapshot();
    test_host_assert_same(half_before, half_after);
    free(before), free(after), free(half_before), free(half_after);
    ssfr_gl_destroy(&gl);
    test_host_destroy(&host);
}

static void initial_and_half_set_host_state_is_left_as_found(void **state)
{
    (void)state;
    check_initial_and_half_set_state_is_left(NULL);
    check_initial_and_half_set_state_is_left(debug_context);
}

static void baseline_undoes_what_passes_do(void **state)
{
    (void)state;
    test_host host;
    objects o;
    ssfr_gl *gl = NULL;
    test_host_create(&host, debug_context);
    set_everything(&o);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    static const GLenum off[] = {GL_BLEND,  GL_DEPTH_TEST, GL_CULL_FACE, GL_SCISSOR_TEST, GL_STENCIL_TEST,
                                 GL_DITHER, GL_FRAMEBUFFER_SRGB};
    for (size_t i = 0; i < SSFR_COUNT(off); i++) assert_false(glIsEnabled(off[i]));
    assert_true(glIsEnabled(GL_PROGRAM_POINT_SIZE));
    GLint v, alignment, sampler;
    glGetIntegerv(GL_CLIP_ORIGIN, &v);
    assert_int_equal(v, GL_UPPER_LEFT);
    glGetIntegerv(GL_CLIP_DEPTH_MODE, &v);
    assert_int_equal(v, GL_NEGATIVE_ONE_TO_ONE);
    glGetIntegerv(GL_POINT_SPRITE_COORD_ORIGIN, &v);
    assert_int_equal(v, GL_UPPER_LEFT);
    glGetIntegerv(GL_PACK_ALIGNMENT, &alignment);
    assert_int_equal(alignment, 4);
    glGetIntegerv(GL_SAMPLER_BINDING, &sampler);
    assert_int_equal(sampler, 0);
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK);
    ssfr_gl_destroy(&gl);
    test_host_destroy(&host);
}

/* ---- errors -----------------------------------------------------------------------------------------------------*/

static int n_warnings;
static char last_warning[256];

static void keep_warning(void *user, ssfr_level level, const char *where, const char *text)
{
    (void)user, (void)where;
    if (level != SSFR_WARNING) return;
    n_warnings++;
    snprintf(last_warning, sizeof last_warning, "%s", text);
}

static void host_errors_from_before_are_logged_and_not_ours(void **state)
{
    test_host host;
    ssfr_gl *gl = NULL;
    test_host_create(&host, NULL);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    glEnable(GL_TEXTURE_BUFFER);
    n_warnings = 0;
    ssfr_log_to(keep_warning, NULL);
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    test_capture_log(state);
    assert_int_equal(n_warnings, 1);
    assert_non_null(strstr(last_warning, "GL_INVALID_ENUM"));
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK);
    assert_int_equal(glGetError(), GL_NO_ERROR);
    ssfr_gl_destroy(&gl);
    test_host_destroy(&host);
}

static void check_error_is_reported(const EGLint *flags)
{
    test_host host;
    ssfr_gl *gl = NULL;
    test_host_create(&host, flags);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    ssfr_gl_push(gl, "narrow_range");
    glEnable(GL_TEXTURE_BUFFER);
    ssfr_gl_pop(gl);
    assert_fails(SSFR_ERR_GL, ssfr_gl_end(gl, SSFR_OK), "narrow_range: GL_INVALID_ENUM");
    assert_int_equal(glGetError(), GL_NO_ERROR);
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK);
    ssfr_gl_destroy(&gl);
    test_host_destroy(&host);
}

static void gl_errors_name_their_pass_with_and_without_debug_context(void **state)
{
    (void)state;
    check_error_is_reported(debug_context);
    check_error_is_reported(NULL);
}

static void host_callback_hears_the_host_alone(void **state)
{
    (void)state;
    test_host host;
    ssfr_gl *gl = NULL;
    test_host_create(&host, debug_context);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    glDebugMessageCallback(hear, &heard_id);
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, NULL, GL_FALSE);
    glDebugMessageControl(GL_DEBUG_SOURCE_APPLICATION, GL_DEBUG_TYPE_MARKER, GL_DONT_CARE, 0, NULL, GL_TRUE);
    n_heard = 0;
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    ssfr_gl_push(gl, "bilateral");
    glDebugMessageInsert(GL_DEBUG_SOURCE_APPLICATION, GL_DEBUG_TYPE_ERROR, 42, GL_DEBUG_SEVERITY_HIGH, -1,
                         "two\nlines\n");
    ssfr_gl_pop(gl);
    assert_fails(SSFR_ERR_GL, ssfr_gl_end(gl, SSFR_OK), "bilateral: two lines");
    assert_int_equal(n_heard, 0);
    /* The host's filters are its own again: an error is kept from it as before, a marker comes through. */
    glDebugMessageInsert(GL_DEBUG_SOURCE_APPLICATION, GL_DEBUG_TYPE_ERROR, 43, GL_DEBUG_SEVERITY_HIGH, -1, "no");
    assert_int_equal(n_heard, 0);
    glDebugMessageInsert(GL_DEBUG_SOURCE_APPLICATION, GL_DEBUG_TYPE_MARKER, 44, GL_DEBUG_SEVERITY_LOW, -1, "yes");
    assert_int_equal(n_heard, 1);
    assert_int_equal(heard_id, 44);
    ssfr_gl_destroy(&gl);
    test_host_destroy(&host);
}

static void groups_left_open_are_closed_by_end(void **state)
{
    (void)state;
    test_host host;
    ssfr_gl *gl = NULL;
    GLint before, after;
    test_host_create(&host, debug_context);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    glGetIntegerv(GL_DEBUG_GROUP_STACK_DEPTH, &before);
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    for (int i = 0; i < 13; i++) ssfr_gl_push(gl, "deep");
    assert_int_equal(ssfr_gl_end(gl, SSFR_ERR_VALUE), SSFR_ERR_VALUE);
    glGetIntegerv(GL_DEBUG_GROUP_STACK_DEPTH, &after);
    assert_int_equal(after, before);
    ssfr_gl_destroy(&gl);
    test_host_destroy(&host);
}

/* ---- contexts that do not serve --------------------------------------------------------------------------------- */

static void create_without_a_current_context_fails(void **state)
{
    (void)state;
    test_host host;
    ssfr_gl *gl = NULL;
    test_host_create(&host, NULL);
    test_host_destroy(&host);
    assert_fails(SSFR_ERR_GL, ssfr_gl_create(&gl, SSFR_GL_CURRENT), "no GL context is current");
    assert_null(gl);
}

static void contexts_of_gles_or_without_core_profile_are_refused(void **state)
{
    (void)state;
    static const EGLint compatibility[] = {EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                           EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT,
                                           EGL_NONE};
    test_host host;
    ssfr_gl *gl = NULL;
    if (test_host_try(&host, EGL_OPENGL_ES_API, 3, 1, NULL))
        assert_fails(SSFR_ERR_GL, ssfr_gl_create(&gl, SSFR_GL_CURRENT), "needs GL 4.5 core");
    test_host_destroy(&host);
    if (test_host_try(&host, EGL_OPENGL_API, 4, 5, compatibility))
        assert_fails(SSFR_ERR_GL, ssfr_gl_create(&gl, SSFR_GL_CURRENT), "no core profile");
    test_host_destroy(&host);
    assert_null(gl);
}

static void begin_in_another_context_fails(void **state)
{
    (void)state;
    test_host host, other;
    ssfr_gl *gl = NULL;
    test_host_create(&host, NULL);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    test_host_create(&other, NULL);
    assert_fails(SSFR_ERR_GL, ssfr_gl_begin(gl), "not the one that ssfr was created in");
    assert_int_equal(ssfr_gl_end(gl, SSFR_ERR_GL), SSFR_ERR_GL);
    test_host_destroy(&other);
    assert_fails(SSFR_ERR_GL, ssfr_gl_begin(gl), "no GL context is current");
    test_host_make_current(&host);
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK);
    ssfr_gl_destroy(&gl);
    test_host_destroy(&host);
}

static void destroy_after_the_host_context_is_gone_only_logs(void **state)
{
    (void)state;
    test_host host;
    ssfr_gl *gl = NULL;
    unsigned program;
    test_host_create(&host, NULL);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    assert_int_equal(ssfr_program_get(gl, &program, "fill.vert", "fill.frag", NULL), SSFR_OK);
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK);
    test_host_destroy(&host);
    test_clear_log();
    ssfr_gl_destroy(&gl);
    assert_null(gl);
    test_assert_logged("no GL context is current", __FILE__, __LINE__);
}

static void state_that_could_not_be_put_back_is_refused(void **state)
{
    (void)state;
    test_host host;
    objects o;
    ssfr_gl *gl = NULL;
    test_host_create(&host, NULL);
    create_objects(&o);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_CURRENT), SSFR_OK);
    glUseProgram(o.program);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, o.buffers[0]);
    glBeginTransformFeedback(GL_POINTS);
    assert_int_equal(glGetError(), GL_NO_ERROR);
    assert_fails(SSFR_ERR_GL, ssfr_gl_begin(gl), "transform feedback");
    glPauseTransformFeedback();
    run_a_frame(gl, &o);
    glResumeTransformFeedback();
    glEndTransformFeedback();
    glDeleteProgram(o.program);
    assert_fails(SSFR_ERR_GL, ssfr_gl_begin(gl), "is deleted");
    glUseProgram(0);
    run_a_frame(gl, &o);
    assert_int_equal(glGetError(), GL_NO_ERROR);
    ssfr_gl_destroy(&gl);
    test_host_destroy(&host);
}

static void own_context_gives_the_host_its_context_back(void **state)
{
    (void)state;
    test_host host;
    ssfr_gl *gl = NULL;
    test_host_create(&host, NULL);
    assert_int_equal(ssfr_gl_create(&gl, SSFR_GL_OWN), SSFR_OK);
    assert_ptr_equal(eglGetCurrentContext(), host.context);
    eglBindAPI(EGL_OPENGL_ES_API);
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    assert_ptr_not_equal(eglGetCurrentContext(), host.context);
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK);
    assert_int_equal(eglQueryAPI(), EGL_OPENGL_ES_API);
    eglBindAPI(EGL_OPENGL_API);
    assert_ptr_equal(eglGetCurrentContext(), host.context);
    ssfr_gl_destroy(&gl);
    assert_ptr_equal(eglGetCurrentContext(), host.context);
    assert_int_equal(glGetError(), GL_NO_ERROR);
    test_host_destroy(&host);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(host_state_is_left_as_found_in_a_debug_context),
        cmocka_unit_test(host_state_is_left_as_found_in_a_plain_context),
        cmocka_unit_test(initial_and_half_set_host_state_is_left_as_found),
        cmocka_unit_test(baseline_undoes_what_passes_do),
        cmocka_unit_test(host_errors_from_before_are_logged_and_not_ours),
        cmocka_unit_test(gl_errors_name_their_pass_with_and_without_debug_context),
        cmocka_unit_test(host_callback_hears_the_host_alone),
        cmocka_unit_test(groups_left_open_are_closed_by_end),
        cmocka_unit_test(create_without_a_current_context_fails),
        cmocka_unit_test(contexts_of_gles_or_without_core_profile_are_refused),
        cmocka_unit_test(begin_in_another_context_fails),
        cmocka_unit_test(destroy_after_the_host_context_is_gone_only_logs),
        cmocka_unit_test(state_that_could_not_be_put_back_is_refused),
        cmocka_unit_test(own_context_gives_the_host_its_context_back),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

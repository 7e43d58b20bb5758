/* SPDX-License-Identifier: MIT */
/* state.c: the baseline state of GL, and a host's state saved and put back: one table of rows serves all three. */
#include "gl/internal.h"

#include <limits.h>

enum { KEEP = INT_MIN, MAX_DRAWS = 8, MAX_VIEWPORTS = 16, N_BUFFERS = SSFR_GL_STORAGE + SSFR_GL_UNIFORMS };

/* ---- single values ----------------------------------------------------------------------------------------------- */

static void set_program(GLint v) { glUseProgram((GLuint)v); }
static void set_vertex_array(GLint v) { glBindVertexArray((GLuint)v); }
static void set_draw_framebuffer(GLint v) { glBindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)v); }
static void set_read_framebuffer(GLint v) { glBindFramebuffer(GL_READ_FRAMEBUFFER, (GLuint)v); }
static void set_depth_mask(GLint v) { glDepthMask((GLboolean)v); }
static void set_depth_func(GLint v) { glDepthFunc((GLenum)v); }
static void set_cull_face(GLint v) { glCullFace((GLenum)v); }
static void set_front_face(GLint v) { glFrontFace((GLenum)v); }
static void set_polygon_mode(GLint v) { glPolygonMode(GL_FRONT_AND_BACK, (GLenum)v); }
static void set_provoking_vertex(GLint v) { glProvokingVertex((GLenum)v); }
static void set_sprite_origin(GLint v) { glPointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, v); }
static void set_active_texture(GLint v) { glActiveTexture((GLenum)v); }

typedef enum kind { CAPABILITY, STORE, BUFFER, CALL } kind;

/* A value that glIsEnabled or glGetIntegerv(get) tells, and its value in the baseline. */
typedef struct row {
    kind kind;
    GLenum get, target; /* target: of a BUFFER */
    GLint baseline;     /* KEEP: ssfr_gl_baseline does not set it from here */
    void (*set)(GLint); /* of a CALL */
} row;

#define CAP(name, on) {CAPABILITY, name, 0, on, NULL}
#define PIXELS(name, v) {STORE, name, 0, v, NULL}
#define BINDING(target) {BUFFER, target##_BINDING, target, 0, NULL}

static const row rows[] = {
    CAP(GL_DEPTH_TEST, 0),
    CAP(GL_CULL_FACE, 0),
    CAP(GL_STENCIL_TEST, 0),
    CAP(GL_FRAMEBUFFER_SRGB, 0),
    CAP(GL_DITHER, 0),
    CAP(GL_PROGRAM_POINT_SIZE, 1),
    CAP(GL_PRIMITIVE_RESTART, 0),
    CAP(GL_PRIMITIVE_RESTART_FIXED_INDEX, 0),
    CAP(GL_RASTERIZER_DISCARD, 0),
    CAP(GL_COLOR_LOGIC_OP, 0),
    CAP(GL_DEPTH_CLAMP, 0),
    CAP(GL_POLYGON_SMOOTH, 0),
    CAP(GL_POLYGON_OFFSET_FILL, 0),
    CAP(GL_CLIP_DISTANCE0, 0),
    CAP(GL_CLIP_DISTANCE1, 0),
    CAP(GL_CLIP_DISTANCE2, 0),
    CAP(GL_CLIP_DISTANCE3, 0),
    CAP(GL_CLIP_DISTANCE4, 0),
    CAP(GL_CLIP_DISTANCE5, 0),
    CAP(GL_CLIP_DISTANCE6, 0),
    CAP(GL_CLIP_DISTANCE7, 0),
    PIXELS(GL_PACK_SWAP_BYTES, 0),
    PIXELS(GL_PACK_LSB_FIRST, 0),
    PIXELS(GL_PACK_ROW_LENGTH, 0),
    PIXELS(GL_PACK_IMAGE_HEIGHT, 0),
    PIXELS(GL_PACK_SKIP_ROWS, 0),
    PIXELS(GL_PACK_SKIP_PIXELS, 0),
    PIXELS(GL_PACK_SKIP_IMAGES, 0),
    PIXELS(GL_PACK_ALIGNMENT, 4),
    PIXELS(GL_UNPACK_SWAP_BYTES, 0),
    PIXELS(GL_UNPACK_LSB_FIRST, 0),
    PIXELS(GL_UNPACK_ROW_LENGTH, 0),
    PIXELS(GL_UNPACK_IMAGE_HEIGHT, 0),
    PIXELS(GL_UNPACK_SKIP_ROWS, 0),
    PIXELS(GL_UNPACK_SKIP_PIXELS, 0),
    PIXELS(GL_UNPACK_SKIP_IMAGES, 0),
    PIXELS(GL_UNPACK_ALIGNMENT, 4),
    BINDING(GL_ARRAY_BUFFER),
    BINDING(GL_DRAW_INDIRECT_BUFFER),
    BINDING(GL_PIXEL_PACK_BUFFER),
    BINDING(GL_PIXEL_UNPACK_BUFFER),
    BINDING(GL_QUERY_BUFFER), /* would take the results of ssfr's timers */
    {BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER, KEEP, NULL},
    {BUFFER, GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER, KEEP, NULL},
    {CALL, GL_CURRENT_PROGRAM, 0, 0, set_program},
    {CALL, GL_VERTEX_ARRAY_BINDING, 0, KEEP, set_vertex_array},
    {CALL, GL_DRAW_FRAMEBUFFER_BINDING, 0, KEEP, set_draw_framebuffer},
    {CALL, GL_READ_FRAMEBUFFER_BINDING, 0, KEEP, set_read_framebuffer},
    {CALL, GL_DEPTH_WRITEMASK, 0, GL_TRUE, set_depth_mask},
    {CALL, GL_DEPTH_FUNC, 0, GL_LESS, set_depth_func},
    {CALL, GL_CULL_FACE_MODE, 0, GL_BACK, set_cull_face},
    {CALL, GL_FRONT_FACE, 0, GL_CCW, set_front_face},
    {CALL, GL_POLYGON_MODE, 0, GL_FILL, set_polygon_mode},
    {CALL, GL_PROVOKING_VERTEX, 0, GL_LAST_VERTEX_CONVENTION, set_provoking_vertex},
    {CALL, GL_POINT_SPRITE_COORD_ORIGIN, 0, GL_UPPER_LEFT, set_sprite_origin},
    {CALL, GL_ACTIVE_TEXTURE, 0, GL_TEXTURE0, set_active_texture},
};

static void apply(const row *row, GLint value)
{
    switch (row->kind) {
    case CAPABILITY: (value ? glEnable : glDisable)(row->get); break;
    case STORE: glPixelStorei(row->get, value); break;
    case BUFFER: glBindBuffer(row->target, (GLuint)value); break;
    case CALL: row->set(value); break;
    }
}

static GLint read_row(const row *row)
{
    GLint v[4] = {0}; /* some drivers tell two polygon modes */
    if (row->kind == CAPABILITY)
        v[0] = glIsEnabled(row->get);
    else
        glGetIntegerv(row->get, v);
    return v[0];
}

/* ---- values by index --------------------------------------------------------------------------------------------- */

typedef struct draw_state { /* a draw buffer's */
    GLboolean blend, mask[4];
    GLint func[4], equation[2];
} draw_state;

typedef struct viewports_state {
    GLfloat box[MAX_VIEWPORTS][4];
    GLdouble range[MAX_VIEWPORTS][2];
    GLint scissor[MAX_VIEWPORTS][4];
    GLboolean scissor_test[MAX_VIEWPORTS];
} viewports_state;

typedef struct buffer_range {
    GLint name;
    GLint64 start, size; /* bytes; both 0: the whole buffer */
} buffer_range;

struct ssfr_gl_host {
    GLint n_draws, n_viewports;
    GLint values[SSFR_COUNT(rows)];
    draw_state draws[MAX_DRAWS];
    viewports_state viewports;
    GLint textures[SSFR_GL_UNITS], volumes[SSFR_GL_UNITS], samplers[SSFR_GL_UNITS];
    buffer_range buffers[N_BUFFERS];
    GLint clip_origin, clip_depth;
    GLfloat clear_colour[4];
    GLboolean debug, debug_synchronous;
    void *debug_callback, *debug_user;
};

static void save_draw(draw_state *s, GLuint i)
{
    static const GLenum funcs[] = {GL_BLEND_SRC_RGB, GL_BLEND_DST_RGB, GL_BLEND_SRC_ALPHA, GL_BLEND_DST_ALPHA};
    s->blend = glIsEnabledi(GL_BLEND, i);
    glGetBooleani_v(GL_COLOR_WRITEMASK, i, s->mask);
    for (int k = 0; k < 4; k++) glGetIntegeri_v(funcs[k], i, &s->func[k]);
    glGetIntegeri_v(GL_BLEND_EQUATION_RGB, i, &s->equation[0]);
    glGetIntegeri_v(GL_BLEND_EQUATION_ALPHA, i, &s->equation[1]);
}

static void restore_draw(const draw_state *s, GLuint i)
{
    const GLint *f = s->func;
    (s->blend ? glEnablei : glDisablei)(GL_BLEND, i);
    glColorMaski(i, s->mask[0], s->mask[1], s->mask[2], s->mask[3]);
    glBlendFuncSeparatei(i, (GLenum)f[0], (GLenum)f[1], (GLenum)f[2], (GLenum)f[3]);
    glBlendEquationSeparatei(i, (GLenum)s->equation[0], (GLenum)s->equation[1]);
}

static void save_viewports(viewports_state *s, GLint n)
{
    for (GLuint i = 0; i < (GLuint)n; i++) {
        glGetFloati_v(GL_VIEWPORT, i, s->box[i]);
        glGetDoublei_v(GL_DEPTH_RANGE, i, s->range[i]);
        glGetIntegeri_v(GL_SCISSOR_BOX, i, s->scissor[i]);
        s->scissor_test[i] = glIsEnabledi(GL_SCISSOR_TEST, i);
    }
}

static void restore_viewports(const viewports_state *s, GLint n)
{
    glViewportArrayv(0, n, s->box[0]);
    glDepthRangeArrayv(0, n, s->range[0]);
    glScissorArrayv(0, n, s->scissor[0]);
    for (GLuint i = 0; i < (GLuint)n; i++) (s->scissor_test[i] ? glEnablei : glDisablei)(GL_SCISSOR_TEST, i);
}

/* Only the 2D and 3D targets: a host's other textures on ssfr's units stay bound. */
static void save_units(ssfr_gl_host *host)
{
    for (GLenum i = 0; i < SSFR_GL_UNITS; i++) {
        glActiveTexture(GL_TEXTURE0 + i);
        glGetIntegerv(GL_TEXTURE_BINDING_2D, &host->textures[i]);
        glGetIntegerv(GL_TEXTURE_BINDING_3D, &host->volumes[i]);
        glGetIntegerv(GL_SAMPLER_BINDING, &host->samplers[i]);
    }
}

static void restore_units(const ssfr_gl_host *host)
{
    for (GLuint i = 0; i < SSFR_GL_UNITS; i++) {
        glActiveTexture(GL_TEXTURE0 + i);
        glBindTexture(GL_TEXTURE_2D, (GLuint)host->textures[i]);
        glBindTexture(GL_TEXTURE_3D, (GLuint)host->volumes[i]);
        glBindSampler(i, (GLuint)host->samplers[i]);
    }
}

static GLenum buffer_target(int i, GLuint *index)
{
    *index = (GLuint)(i < SSFR_GL_STORAGE ? i : i - SSFR_GL_STORAGE);
    return i < SSFR_GL_STORAGE ? GL_SHADER_STORAGE_BUFFER : GL_UNIFORM_BUFFER;
}

static void save_buffers(ssfr_gl_host *host)
{
    for (int i = 0; i < N_BUFFERS; i++) {
        GLuint index;
        const bool storage = buffer_target(i, &index) == GL_SHADER_STORAGE_BUFFER;
        buffer_range *range = &host->buffers[i];
        glGetIntegeri_v(storage ? GL_SHADER_STORAGE_BUFFER_BINDING : GL_UNIFORM_BUFFER_BINDING, index, &range->name);
        glGetInteger64i_v(storage ? GL_SHADER_STORAGE_BUFFER_START : GL_UNIFORM_BUFFER_START, index, &range->start);
        glGetInteger64i_v(storage ? GL_SHADER_STORAGE_BUFFER_SIZE : GL_UNIFORM_BUFFER_SIZE, index, &range->size);
    }
}

/* Sets the generic bindings too, so it comes before the rows. */
static void restore_buffers(const ssfr_gl_host *host)
{
    for (int i = 0; i < N_BUFFERS; i++) {
        GLuint index;
        const GLenum target = buffer_target(i, &index);
        const buffer_range *range = &host->buffers[i];
        if (range->name && range->size)
            glBindBufferRange(target, index, (GLuint)range->name, (GLintptr)range->start, (GLsizeiptr)range->size);
        else
            glBindBufferBase(target, index, (GLuint)range->name);
    }
}

static void save_debug(ssfr_gl_host *host)
{
    host->debug = glIsEnabled(GL_DEBUG_OUTPUT);
    host->debug_synchronous = glIsEnabled(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glGetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &host->debug_callback);
    glGetPointerv(GL_DEBUG_CALLBACK_USER_PARAM, &host->debug_user);
}

void ssfr_gl_host_restore_debug(ssfr_gl *gl)
{
    const ssfr_gl_host *host = gl->host;
    GLDEBUGPROC callback;
    memcpy(&callback, &host->debug_callback, sizeof callback); /* C has no cast from void * to a function */
    glDebugMessageCallback(callback, host->debug_user);
    (host->debug ? glEnable : glDisable)(GL_DEBUG_OUTPUT);
    (host->debug_synchronous ? glEnable : glDisable)(GL_DEBUG_OUTPUT_SYNCHRONOUS);
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_gl_host_create(ssfr_gl *gl)
{
    const ssfr_result result = ssfr_alloc(&gl->host, 1, sizeof *gl->host, "the host's GL state");
    if (result != SSFR_OK) return result;
    glGetIntegerv(GL_MAX_DRAW_BUFFERS, &gl->host->n_draws);
    glGetIntegerv(GL_MAX_VIEWPORTS, &gl->host->n_viewports);
    gl->host->n_draws = ssfr_min_int(gl->host->n_draws, MAX_DRAWS);
    gl->host->n_viewports = ssfr_min_int(gl->host->n_viewports, MAX_VIEWPORTS);
    return SSFR_OK;
}

void ssfr_gl_host_save(ssfr_gl *gl)
{
    ssfr_gl_host *host = gl->host;
    for (size_t i = 0; i < SSFR_COUNT(rows); i++) host->values[i] = read_row(&rows[i]);
    for (GLuint i = 0; i < (GLuint)host->n_draws; i++) save_draw(&host->draws[i], i);
    save_viewports(&host->viewports, host->n_viewports);
    save_units(host);
    save_buffers(host);
    glGetIntegerv(GL_CLIP_ORIGIN, &host->clip_origin);
    glGetIntegerv(GL_CLIP_DEPTH_MODE, &host->clip_depth);
    glGetFloatv(GL_COLOR_CLEAR_VALUE, host->clear_colour);
    save_debug(host);
}

void ssfr_gl_host_restore(ssfr_gl *gl)
{
    const ssfr_gl_host *host = gl->host;
    for (GLuint i = 0; i < (GLuint)host->n_draws; i++) restore_draw(&host->draws[i], i);
    restore_viewports(&host->viewports, host->n_viewports);
    restore_units(host);
    restore_buffers(host);
    glClipControl((GLenum)host->clip_origin, (GLenum)host->clip_depth);
    glClearColor(host->clear_colour[0], host->clear_colour[1], host->clear_colour[2], host->clear_colour[3]);
    for (size_t i = 0; i < SSFR_COUNT(rows); i++) apply(&rows[i], host->values[i]);
}

void ssfr_gl_baseline(ssfr_gl *gl)
{
    for (size_t i = 0; i < SSFR_COUNT(rows); i++)
        if (rows[i].baseline != KEEP) apply(&rows[i], rows[i].baseline);
    glBindVertexArray(gl->vertex_array);
    glBindFramebuffer(GL_FRAMEBUFFER, gl->framebuffer);
    glDisable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ZERO);
    glBlendEquation(GL_FUNC_ADD);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDisable(GL_SCISSOR_TEST);
    glDepthRange(0, 1);
    glClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glClearColor(0, 0, 0, 0);
    glBindSamplers(0, SSFR_GL_UNITS, NULL);
}

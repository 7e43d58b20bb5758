/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gl_host.c: a host program's GL context, what its state is, and GL for tests that need it. */
#include "tests/gl_host.h"

static void skip_or_fail(void)
{
    const char *gl = getenv("GL");
    if (gl && strcmp(gl, "required") == 0) fail_msg("GL is required, and there is none: %s", test_last_error());
    skip();
}

ssfr_gl *test_gl_or_skip(void)
{
    ssfr_gl *gl = NULL;
    test_clear_log();
    if (ssfr_gl_create(&gl, SSFR_GL_OWN) != SSFR_OK) skip_or_fail();
    return gl;
}

/* ---- the context ------------------------------------------------------------------------------------------------ */

static bool is_up(EGLDisplay display)
{
    return display != EGL_NO_DISPLAY && eglInitialize(display, NULL, NULL);
}

static EGLDisplay any_display(void)
{
    const PFNEGLGETPLATFORMDISPLAYEXTPROC get =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    const PFNEGLQUERYDEVICESEXTPROC query = (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
    EGLDeviceEXT devices[8];
    EGLint n = 0;
    EGLDisplay display = EGL_NO_DISPLAY;
    if (query && get && query(8, devices, &n))
        for (EGLint i = 0; i < n && !is_up(display); i++) display = get(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL);
    if (!is_up(display) && get) display = get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    return is_up(display) ? display : EGL_NO_DISPLAY;
}

bool test_host_try(test_host *host, EGLenum api, int major, int minor, const EGLint *flags)
{
    EGLint attributes[16] = {EGL_CONTEXT_MAJOR_VERSION, major, EGL_CONTEXT_MINOR_VERSION, minor, EGL_NONE};
    int n = 4;
    for (const EGLint *flag = flags; flag && *flag != EGL_NONE && n < 15; flag++) attributes[n++] = *flag;
    attributes[n] = EGL_NONE;
    *host = (test_host){.display = any_display()};
    if (host->display == EGL_NO_DISPLAY || !eglBindAPI(api)) return false;
    host->context = eglCreateContext(host->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (!host->context) return false;
    test_host_make_current(host);
    return true;
}

void test_host_create(test_host *host, const EGLint *flags)
{
    test_clear_log();
    if (!test_host_try(host, EGL_OPENGL_API, 4, 5, flags)) skip_or_fail();
}

void test_host_make_current(const test_host *host)
{
    assert_true(eglMakeCurrent(host->display, EGL_NO_SURFACE, EGL_NO_SURFACE, host->context));
}

void test_host_destroy(test_host *host)
{
    if (!host->context) return;
    eglMakeCurrent(host->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(host->display, host->context);
    eglBindAPI(EGL_OPENGL_API); /* which is EGL_OPENGL_ES_API at first, and after a context of that kind */
    *host = (test_host){0};
}

/* ---- the state -------------------------------------------------------------------------------------------------- */

#define NAME(x) {#x, x}

typedef struct name {
    const char *text;
    GLenum name;
} name;

static const name enables[] = {
    NAME(GL_DEPTH_TEST), NAME(GL_CULL_FACE), NAME(GL_STENCIL_TEST), NAME(GL_FRAMEBUFFER_SRGB), NAME(GL_DITHER),
    NAME(GL_PROGRAM_POINT_SIZE), NAME(GL_PRIMITIVE_RESTART), NAME(GL_PRIMITIVE_RESTART_FIXED_INDEX),
    NAME(GL_RASTERIZER_DISCARD), NAME(GL_COLOR_LOGIC_OP), NAME(GL_DEPTH_CLAMP), NAME(GL_POLYGON_SMOOTH),
    NAME(GL_POLYGON_OFFSET_FILL), NAME(GL_CLIP_DISTANCE0), NAME(GL_CLIP_DISTANCE1), NAME(GL_CLIP_DISTANCE2),
    NAME(GL_CLIP_DISTANCE3), NAME(GL_CLIP_DISTANCE4), NAME(GL_CLIP_DISTANCE5), NAME(GL_CLIP_DISTANCE6),
    NAME(GL_CLIP_DISTANCE7), NAME(GL_DEBUG_OUTPUT), NAME(GL_DEBUG_OUTPUT_SYNCHRONOUS),
};

static const name integers[] = {
    NAME(GL_CURRENT_PROGRAM), NAME(GL_VERTEX_ARRAY_BINDING), NAME(GL_DRAW_FRAMEBUFFER_BINDING),
    NAME(GL_READ_FRAMEBUFFER_BINDING), NAME(GL_DEPTH_WRITEMASK), NAME(GL_DEPTH_FUNC), NAME(GL_CULL_FACE_MODE),
    NAME(GL_FRONT_FACE), NAME(GL_PROVOKING_VERTEX), NAME(GL_POLYGON_MODE), NAME(GL_CLIP_ORIGIN),
    NAME(GL_CLIP_DEPTH_MODE), NAME(GL_POINT_SPRITE_COORD_ORIGIN), NAME(GL_ACTIVE_TEXTURE),
    NAME(GL_ARRAY_BUFFER_BINDING),
    NAME(GL_DRAW_INDIRECT_BUFFER_BINDING), NAME(GL_PIXEL_PACK_BUFFER_BINDING), NAME(GL_PIXEL_UNPACK_BUFFER_BINDING),
    NAME(GL_QUERY_BUFFER_BINDING), NAME(GL_SHADER_STORAGE_BUFFER_BINDING), NAME(GL_UNIFORM_BUFFER_BINDING),
    NAME(GL_PACK_SWAP_BYTES), NAME(GL_PACK_LSB_FIRST), NAME(GL_PACK_ROW_LENGTH), NAME(GL_PACK_IMAGE_HEIGHT),
    NAME(GL_PACK_SKIP_ROWS), NAME(GL_PACK_SKIP_PIXELS), NAME(GL_PACK_SKIP_IMAGES), NAME(GL_PACK_ALIGNMENT),
    NAME(GL_UNPACK_SWAP_BYTES), NAME(GL_UNPACK_LSB_FIRST), NAME(GL_UNPACK_ROW_LENGTH), NAME(GL_UNPACK_IMAGE_HEIGHT),
    NAME(GL_UNPACK_SKIP_ROWS), NAME(GL_UNPACK_SKIP_PIXELS), NAME(GL_UNPACK_SKIP_IMAGES), NAME(GL_UNPACK_ALIGNMENT),
};

static const name draw_integers[] = {
    NAME(GL_BLEND_SRC_RGB), NAME(GL_BLEND_DST_RGB), NAME(GL_BLEND_SRC_ALPHA), NAME(GL_BLEND_DST_ALPHA),
    NAME(GL_BLEND_EQUATION_RGB), NAME(GL_BLEND_EQUATION_ALPHA),
};

static const name unit_integers[] = {
    NAME(GL_TEXTURE_BINDING_2D), NAME(GL_TEXTURE_BINDING_CUBE_MAP), NAME(GL_TEXTURE_BINDING_3D),
    NAME(GL_TEXTURE_BINDING_2D_ARRAY), NAME(GL_SAMPLER_BINDING),
};

static void write_draws(FILE *out)
{
    for (GLuint i = 0; i < 8; i++) {
        GLboolean mask[4];
        GLint v;
        fprintf(out, "GL_BLEND[%u] %d\n", i, glIsEnabledi(GL_BLEND, i));
        glGetBooleani_v(GL_COLOR_WRITEMASK, i, mask);
        fprintf(out, "GL_COLOR_WRITEMASK[%u] %d %d %d %d\n", i, mask[0], mask[1], mask[2], mask[3]);
        for (size_t k = 0; k < SSFR_COUNT(draw_integers); k++) {
            glGetIntegeri_v(draw_integers[k].name, i, &v);
            fprintf(out, "%s[%u] 0x%x\n", draw_integers[k].text, i, (unsigned)v);
        }
    }
}

static void write_viewports(FILE *out)
{
    for (GLuint i = 0; i < 16; i++) {
        GLfloat box[4];
        GLdouble range[2];
        GLint scissor[4];
        glGetFloati_v(GL_VIEWPORT, i, box);
        glGetDoublei_v(GL_DEPTH_RANGE, i, range);
        glGetIntegeri_v(GL_SCISSOR_BOX, i, scissor);
        fprintf(out, "GL_VIEWPORT[%u] %a %a %a %a\n", i, (double)box[0], (double)box[1], (double)box[2],
                (double)box[3]);
        fprintf(out, "GL_DEPTH_RANGE[%u] %a %a\n", i, range[0], range[1]);
        fprintf(out, "GL_SCISSOR_BOX[%u] %d %d %d %d\n", i, scissor[0], scissor[1], scissor[2], scissor[3]);
        fprintf(out, "GL_SCISSOR_TEST[%u] %d\n", i, glIsEnabledi(GL_SCISSOR_TEST, i));
    }
}

static void write_units(FILE *out)
{
    GLint active, v;
    glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (GLuint i = 0; i < 16; i++) {
        glActiveTexture(GL_TEXTURE0 + i);
        for (size_t k = 0; k < SSFR_COUNT(unit_integers); k++) {
            glGetIntegerv(unit_integers[k].name, &v);
            fprintf(out, "%s[%u] %d\n", unit_integers[k].text, i, v);
        }
    }
    glActiveTexture((GLenum)active);
}

static void write_buffers(FILE *out, const char *text, GLenum binding, GLenum start, GLenum size, GLuint n)
{
    for (GLuint i = 0; i < n; i++) {
        GLint buffer;
        GLint64 from, length;
        glGetIntegeri_v(binding, i, &buffer);
        glGetInteger64i_v(start, i, &from);
        glGetInteger64i_v(size, i, &length);
        fprintf(out, "%s[%u] %d from %lld, %lld bytes\n", text, i, buffer, (long long)from, (long long)length);
    }
}

static void write_debug(FILE *out)
{
    void *callback, *user;
    glGetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &callback);
    glGetPointerv(GL_DEBUG_CALLBACK_USER_PARAM, &user);
    fprintf(out, "GL_DEBUG_CALLBACK_FUNCTION %p\nGL_DEBUG_CALLBACK_USER_PARAM %p\n", callback, user);
}

char *test_host_snapshot(void)
{
    char *text = NULL;
    size_t size;
    GLint v[4];
    GLfloat clear[4];
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    for (size_t i = 0; i < SSFR_COUNT(enables); i++)
        fprintf(out, "%s %d\n", enables[i].text, glIsEnabled(enables[i].name));
    for (size_t i = 0; i < SSFR_COUNT(integers); i++) {
        glGetIntegerv(integers[i].name, v);
        fprintf(out, "%s %d\n", integers[i].text, v[0]);
    }
    glGetFloatv(GL_COLOR_CLEAR_VALUE, clear);
    fprintf(out, "GL_COLOR_CLEAR_VALUE %a %a %a %a\n", (double)clear[0], (double)clear[1], (double)clear[2],
            (double)clear[3]);
    write_draws(out);
    write_viewports(out);
    write_units(out);
    write_buffers(out, "STORAGE", GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START,
                  GL_SHADER_STORAGE_BUFFER_SIZE, 4);
    write_buffers(out, "UNIFORM", GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, 2);
    write_debug(out);
    assert_int_equal(fclose(out), 0);
    return text;
}

/* Walks both texts line by line and counts the lines that are equal (or differ), printing each. */
static int count_lines(const char *a, const char *b, bool equal)
{
    int n = 0;
    while (*a && *b) {
        const size_t length_a = strcspn(a, "\n"), length_b = strcspn(b, "\n");
        const bool same = length_a == length_b && memcmp(a, b, length_a) == 0;
        if (same == equal) print_error("%.*s | %.*s\n", (int)length_a, a, (int)length_b, b), n++;
        a += length_a + 1;
        b += length_b + 1;
    }
    return *a || *b ? -1 : n;
}

void test_host_assert_differs(const char *before, const char *after)
{
    assert_int_equal(count_lines(before, after, true), 0);
}

void test_host_assert_same(const char *before, const char *after)
{
    assert_int_equal(count_lines(before, after, false), 0);
}

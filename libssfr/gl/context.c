/* SPDX-License-Identifier: MIT */
/* context.c: a GL 4.5 context of ssfr's own through EGL, or the host's; made current, and left as it was found. */
#include "gl/internal.h"

#include <assert.h>

enum { MAX_DEVICES = 16, GL_MIN_VERSION = 45 };

/* ---- EGL --------------------------------------------------------------------------------------------------------- */

static const char *egl_error_name(void)
{
    static const char *const names[] = {
        "EGL_SUCCESS",           "EGL_NOT_INITIALIZED",     "EGL_BAD_ACCESS",      "EGL_BAD_ALLOC",
        "EGL_BAD_ATTRIBUTE",     "EGL_BAD_CONFIG",          "EGL_BAD_CONTEXT",     "EGL_BAD_CURRENT_SURFACE",
        "EGL_BAD_DISPLAY",       "EGL_BAD_MATCH",           "EGL_BAD_NATIVE_PIXMAP", "EGL_BAD_NATIVE_WINDOW",
        "EGL_BAD_PARAMETER",     "EGL_BAD_SURFACE",         "EGL_CONTEXT_LOST",
    };
    const EGLint code = eglGetError() - EGL_SUCCESS;
    return code >= 0 && (size_t)code < SSFR_COUNT(names) ? names[code] : "an unknown EGL error";
}

static bool has_word(const char *list, const char *word)
{
    const size_t length = strlen(word);
    bool found = false;
    for (const char *at = list; at && *at && !found; at += strcspn(at, " "), at += strspn(at, " "))
        found = strcspn(at, " ") == length && memcmp(at, word, length) == 0;
    return found;
}

/* A way to a display. */
typedef struct route {
    const char *name;
    EGLenum platform; /* 0: the default display */
    EGLDeviceEXT native;
    bool hardware;    /* known to be: a device that does not call itself software */
} route;

typedef struct routes {
    int n;
    route list[MAX_DEVICES + 2];
} routes;

static EGLDisplay display_of(const route *route)
{
    /* Asked of EGL itself: epoxy would stop the program where it believes that an extension is missing. */
    const PFNEGLGETPLATFORMDISPLAYEXTPROC get =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    if (!route->platform) return eglGetDisplay(EGL_DEFAULT_DISPLAY);
    return get ? get(route->platform, route->native, NULL) : EGL_NO_DISPLAY;
}

/* Devices, hardware or software ones, to the end of the list. */
static void add_devices(routes *to, bool hardware)
{
    const PFNEGLQUERYDEVICESEXTPROC query = (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
    const PFNEGLQUERYDEVICESTRINGEXTPROC tell =
        (PFNEGLQUERYDEVICESTRINGEXTPROC)eglGetProcAddress("eglQueryDeviceStringEXT");
    EGLDeviceEXT devices[MAX_DEVICES];
    EGLint n = 0;
    if (!query || !tell || !query(MAX_DEVICES, devices, &n)) n = 0;
    for (EGLint i = 0; i < n; i++)
        if (has_word(tell(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software") != hardware)
            to->list[to->n++] = (route){hardware ? "device" : "software device", EGL_PLATFORM_DEVICE_EXT, devices[i],
                                        hardware};
}

/* Where to look for a context, in order; `forced` is the value of SSFR_GL. */
static ssfr_result find_routes(routes *out, const char *forced)
{
    const bool any = !forced || !forced[0], software = !any && strcmp(forced, "software") == 0;
    const char *offered = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    *out = (routes){0};
    if (!any && !software && strcmp(forced, "device") != 0)
        return ssfr_fail(SSFR_ERR_VALUE, "SSFR_GL=%s: expected software or device", forced);
    if (has_word(offered, "EGL_EXT_platform_device")) add_devices(out, !software);
    if (!any && !software) return SSFR_OK;
    if (has_word(offered, "EGL_MESA_platform_surfaceless"))
        out->list[out->n++] = (route){"surfaceless", EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, false};
    out->list[out->n++] = (route){"default display", 0, NULL, false};
    return SSFR_OK;
}

/* A debug context tells errors in the driver's words, and on hardware costs time: there only when asked for. */
static bool wants_debug(const route *route)
{
    const char *asked = getenv("SSFR_GL_DEBUG");
    return !route->hardware || (asked && asked[0]);
}

static bool create_context(ssfr_gl *gl, const route *route, char *why, size_t size)
{
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, GL_MIN_VERSION / 10,
                                 EGL_CONTEXT_MINOR_VERSION, GL_MIN_VERSION % 10,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG, wants_debug(route),
                                 EGL_NONE};
    static const char *const needed[] = {"EGL_KHR_no_config_context", "EGL_KHR_surfaceless_context"};
    EGLint major = 0, minor = 0;
    gl->display = display_of(route);
    if (gl->display == EGL_NO_DISPLAY || !eglInitialize(gl->display, &major, &minor)) {
        snprintf(why, size, "%s: no display, %s", route->name, egl_error_name());
        return false;
    }
    if (10 * major + minor < 15) {
        snprintf(why, size, "%s: EGL %d.%d, needs 1.5", route->name, major, minor);
        return false;
    }
    for (size_t i = 0; i < SSFR_COUNT(needed); i++)
        if (!has_word(eglQueryString(gl->display, EGL_EXTENSIONS), needed[i])) {
            snprintf(why, size, "%s: no %s", route->name, needed[i]);
            return false;
        }
    if (eglBindAPI(EGL_OPENGL_API))
        gl->context = eglCreateContext(gl->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (gl->context == EGL_NO_CONTEXT) snprintf(why, size, "%s: no context, %s", route->name, egl_error_name());
    return gl->context != EGL_NO_CONTEXT;
}

static ssfr_gl_current current(void)
{
    return (ssfr_gl_current){eglQueryAPI(), eglGetCurrentDisplay(), eglGetCurrentSurface(EGL_DRAW),
                             eglGetCurrentSurface(EGL_READ), eglGetCurrentContext()};
}

/* EGL refuses while a context of another window system (GLX) is current in this thread. */
static bool make_current(ssfr_gl *gl)
{
    gl->previous = current();
    return eglBindAPI(EGL_OPENGL_API) && eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, gl->context);
}

static bool make_previous_current(const ssfr_gl *gl)
{
    const ssfr_gl_current *to = &gl->previous;
    const bool ok = to->context
                        ? eglMakeCurrent(to->display, to->draw, to->read, to->context)
                        : eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    return eglBindAPI(to->api) && ok;
}

/* ---- what the context is ----------------------------------------------------------------------------------------- */

static void copy_string(char *to, size_t size, GLenum name)
{
    const char *text = (const char *)glGetString(name);
    snprintf(to, size, "%s", text ? text : "unknown");
}

static void read_limits(ssfr_gl *gl)
{
    GLint texture = 0, viewport[2] = {0};
    GLfloat points[2] = {0};
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    glGetFloatv(GL_POINT_SIZE_RANGE, points);
    /* Every image may be drawn into. */
    gl->limits.texture_px = ssfr_min_int(texture, ssfr_min_int(viewport[0], viewport[1]));
    gl->limits.point_px = (double)points[1];
}

static void read_context(ssfr_gl *gl)
{
    static const char *const software[] = {"llvmpipe", "softpipe", "swrast"};
    GLint flags = 0;
    copy_string(gl->renderer, sizeof gl->renderer, GL_RENDERER);
    copy_string(gl->vendor, sizeof gl->vendor, GL_VENDOR);
    copy_string(gl->version, sizeof gl->version, GL_VERSION);
    gl->software = false;
    for (size_t i = 0; i < SSFR_COUNT(software); i++) gl->software |= strstr(gl->renderer, software[i]) != NULL;
    glGetIntegerv(GL_CONTEXT_FLAGS, &flags);
    gl->listens = flags & GL_CONTEXT_FLAG_DEBUG_BIT;
    read_limits(gl);
    glCreateVertexArrays(1, &gl->vertex_array);
    glCreateFramebuffers(1, &gl->framebuffer);
    glCreateQueries(GL_ANY_SAMPLES_PASSED, 1, &gl->query);
}

static void destroy_context(ssfr_gl *gl)
{
    if (gl->context != EGL_NO_CONTEXT) eglDestroyContext(gl->display, gl->context);
    gl->context = EGL_NO_CONTEXT;
    gl->vertex_array = gl->framebuffer = gl->query = 0; /* gone with it */
}

/* Takes the route when it gives a context of the wanted kind; some devices turn out to be drawn in software. */
static bool take_route(ssfr_gl *gl, const route *route, bool software, char *why, size_t size)
{
    bool ok = false;
    if (!create_context(gl, route, why, size)) return false;
    if (!make_current(gl)) {
        snprintf(why, size, "%s: context not made current, %s", route->name, egl_error_name());
        eglBindAPI(gl->previous.api);
    } else {
        read_context(gl);
        ok = software ? gl->software : !(route->hardware && gl->software);
        if (!ok) snprintf(why, size, "%s: not wanted, %.80s", route->name, gl->renderer);
        ok = make_previous_current(gl) && ok;
    }
    if (!ok) destroy_context(gl);
    return ok;
}

static ssfr_result create_own(ssfr_gl *gl)
{
    routes routes;
    char tried[768] = "";
    const char *forced = getenv("SSFR_GL");
    const bool software = forced && strcmp(forced, "software") == 0;
    const EGLenum api = eglQueryAPI();
    const ssfr_result result = find_routes(&routes, forced);
    if (result != SSFR_OK) return result;
    bool found = false;
    for (int i = 0; i < routes.n && !found; i++) {
        const size_t used = strlen(tried);
        char why[160] = "";
        found = take_route(gl, &routes.list[i], software, why, sizeof why);
        if (!found) snprintf(tried + used, sizeof tried - used, "%s%s", used ? "; " : "", why);
    }
    eglBindAPI(api);
    if (found && gl->software && routes.list[0].hardware)
        ssfr_log(SSFR_WARNING, "no GPU can be used, going on with %s: %s", gl->renderer, tried);
    if (found) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_GL, "no GL 4.5 core context%s%s: %s", forced && forced[0] ? " with SSFR_GL=" : "",
                     forced ? forced : "", tried[0] ? tried : "EGL knows no device");
}

static ssfr_result check_host_context(void)
{
    GLint profile = 0;
    const char *version = (const char *)glGetString(GL_VERSION);
    if (!version) return ssfr_fail(SSFR_ERR_GL, "no GL context is current in this thread");
    if (!epoxy_is_desktop_gl() || epoxy_gl_version() < GL_MIN_VERSION)
        return ssfr_fail(SSFR_ERR_GL, "the current context is \"%.80s\", needs GL 4.5 core", version);
    glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    if (!(profile & GL_CONTEXT_CORE_PROFILE_BIT))
        return ssfr_fail(SSFR_ERR_GL, "the current context \"%.80s\" has no core profile", version);
    return SSFR_OK;
}

static ssfr_result adopt_host(ssfr_gl *gl)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(check_host_context());
    SSFR_TRY(ssfr_gl_host_create(gl));
    gl->context = eglGetCurrentContext();
    read_context(gl);
end:
    return result;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_gl_create(ssfr_gl **out, ssfr_gl_source source)
{
    ssfr_result result = SSFR_OK;
    ssfr_gl *gl = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&gl, 1, sizeof *gl, "a GL context"));
    gl->source = source;
    SSFR_TRY(source == SSFR_GL_OWN ? create_own(gl) : adopt_host(gl));
    ssfr_log(SSFR_INFO, "GL: %s, %s", gl->renderer, gl->version);
    *out = gl;
    gl = NULL;
end:
    ssfr_gl_destroy(&gl);
    return result;
}

/* When begin fails only memory is freed: without the right context the names may mean something else. */
static void delete_objects(ssfr_gl *gl)
{
    const bool current = ssfr_gl_begin(gl) == SSFR_OK;
    ssfr_gl_programs_finish(gl, current);
    if (!current) return;
    glDeleteVertexArrays(1, &gl->vertex_array);
    glDeleteFramebuffers(1, &gl->framebuffer);
    glDeleteQueries(1, &gl->query);
    gl->vertex_array = gl->framebuffer = gl->query = 0;
    const ssfr_result result = ssfr_gl_end(gl, SSFR_OK);
    (void)result; /* logged, and there is nobody to give it to */
}

void ssfr_gl_destroy(ssfr_gl **gl)
{
    if (!*gl) return;
    assert(!(*gl)->begun);
    if ((*gl)->vertex_array) delete_objects(*gl);
    if ((*gl)->source == SSFR_GL_OWN) destroy_context(*gl);
    free((*gl)->host);
    free(*gl);
    *gl = NULL;
}

const char *ssfr_gl_renderer(const ssfr_gl *gl)
{
    return gl->renderer;
}

const char *ssfr_gl_vendor(const ssfr_gl *gl)
{
    return gl->vendor;
}

const char *ssfr_gl_version(const ssfr_gl *gl)
{
    return gl->version;
}

bool ssfr_gl_is_software(const ssfr_gl *gl)
{
    return gl->software;
}

bool ssfr_gl_is_host(const ssfr_gl *gl)
{
    return gl->source == SSFR_GL_CURRENT;
}

const ssfr_gl_limits *ssfr_gl_get_limits(const ssfr_gl *gl)
{
    return &gl->limits;
}

long ssfr_gl_allocations(const ssfr_gl *gl)
{
    return gl->allocations;
}

/* ---- begin and end ----------------------------------------------------------------------------------------------- */

static ssfr_result enter_own(ssfr_gl *gl)
{
    if (make_current(gl)) return SSFR_OK;
    const ssfr_result result = ssfr_fail(SSFR_ERR_GL, "ssfr's GL context cannot be made current: %s", egl_error_name());
    eglBindAPI(gl->previous.api);
    return result;
}

/* The host's errors from before are not ssfr's, and glGetError has no way to put a flag back: they are logged. */
static void log_pending_errors(void)
{
    GLenum code = glGetError();
    for (int i = 0; code != GL_NO_ERROR && i < SSFR_GL_ERROR_FLAGS; i++, code = glGetError())
        ssfr_log(SSFR_WARNING, "the host program left a GL error behind, now cleared: %s", ssfr_gl_error_name(code));
}

static ssfr_result enter_host(ssfr_gl *gl)
{
    GLint program = 0, deleted = GL_FALSE, active = GL_FALSE, paused = GL_FALSE;
    if (!glGetString(GL_VERSION)) return ssfr_fail(SSFR_ERR_GL, "no GL context is current in this thread");
    log_pending_errors();
    /* Vertex arrays, framebuffers and queries are not shared between contexts. */
    if (eglGetCurrentContext() != gl->context || !glIsVertexArray(gl->vertex_array) ||
        !glIsFramebuffer(gl->framebuffer))
        return ssfr_fail(SSFR_ERR_GL, "the current GL context is not the one that ssfr was created in");
    glGetIntegerv(GL_CURRENT_PROGRAM, &program);
    if (program) glGetProgramiv((GLuint)program, GL_DELETE_STATUS, &deleted);
    if (deleted)
        return ssfr_fail(SSFR_ERR_GL, "the host's current program %d is deleted: it could not be put back", program);
    glGetIntegerv(GL_TRANSFORM_FEEDBACK_ACTIVE, &active);
    glGetIntegerv(GL_TRANSFORM_FEEDBACK_PAUSED, &paused);
    if (active && !paused)
        return ssfr_fail(SSFR_ERR_GL, "the host's transform feedback is active: end or pause it first");
    ssfr_gl_host_save(gl);
    return SSFR_OK;
}

ssfr_result ssfr_gl_begin(ssfr_gl *gl)
{
    assert(!gl->begun);
    const ssfr_result result = gl->source == SSFR_GL_OWN ? enter_own(gl) : enter_host(gl);
    if (result != SSFR_OK) return result;
    gl->begun = true;
    gl->error[0] = '\0';
    gl->n_groups = 0;
    ssfr_gl_listen(gl);
    ssfr_gl_baseline(gl);
    return SSFR_OK;
}

/* After a begin that failed there is nothing to end. */
ssfr_result ssfr_gl_end(ssfr_gl *gl, ssfr_result so_far)
{
    ssfr_result result = so_far;
    if (!gl->begun) return so_far;
    ssfr_gl_note_errors(gl);
    while (gl->n_groups > 0) ssfr_gl_pop(gl);
    ssfr_gl_detach(gl);
    if (gl->host) ssfr_gl_host_restore(gl);
    ssfr_gl_note_errors(gl);
    glPopDebugGroup();
    if (gl->host) ssfr_gl_host_restore_debug(gl);
    if (gl->error[0]) result = ssfr_fail(SSFR_ERR_GL, "OpenGL: %s", gl->error);
    if (gl->source == SSFR_GL_OWN && !make_previous_current(gl))
        result = ssfr_fail(SSFR_ERR_GL, "the GL context from before cannot be made current: %s", egl_error_name());
    gl->begun = false;
    return result;
}

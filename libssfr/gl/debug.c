/* SPDX-License-Identifier: MIT */
/* debug.c: errors of GL: debug callback, flags of glGetError, and the groups that tell which pass raised them. */
#include "gl/internal.h"

const char *ssfr_gl_error_name(GLenum code)
{
    static const struct {
        GLenum code;
        const char *name;
    } names[] = {
        {GL_INVALID_ENUM, "GL_INVALID_ENUM"},
        {GL_INVALID_VALUE, "GL_INVALID_VALUE"},
        {GL_INVALID_OPERATION, "GL_INVALID_OPERATION"},
        {GL_INVALID_FRAMEBUFFER_OPERATION, "GL_INVALID_FRAMEBUFFER_OPERATION"},
        {GL_OUT_OF_MEMORY, "GL_OUT_OF_MEMORY"},
        {GL_STACK_OVERFLOW, "GL_STACK_OVERFLOW"},
        {GL_STACK_UNDERFLOW, "GL_STACK_UNDERFLOW"},
        {GL_CONTEXT_LOST, "GL_CONTEXT_LOST"},
    };
    const char *name = "an unknown GL error";
    for (size_t i = 0; i < SSFR_COUNT(names); i++)
        if (names[i].code == code) name = names[i].name;
    return name;
}

/* Keeps the first error, on one line and with the innermost group that it came from. */
static void note(ssfr_gl *gl, const char *text, size_t length)
{
    const int group = ssfr_min_int(gl->n_groups, SSFR_GL_GROUPS) - 1;
    if (gl->error[0]) return;
    while (length > 0 && strchr(" \t\r\n", text[length - 1])) length--;
    snprintf(gl->error, sizeof gl->error, "%s%s%.*s", group >= 0 ? gl->groups[group] : "", group >= 0 ? ": " : "",
             ssfr_min_int((int)length, 400), text);
    for (char *at = gl->error; *at; at++)
        if (*at == '\n' || *at == '\r') *at = ' ';
}

void ssfr_gl_note_errors(ssfr_gl *gl)
{
    GLenum code = glGetError();
    /* Bounded, because a lost context reports GL_CONTEXT_LOST for ever. */
    for (int i = 0; code != GL_NO_ERROR && i < SSFR_GL_ERROR_FLAGS; i++, code = glGetError()) {
        const char *name = ssfr_gl_error_name(code);
        note(gl, name, strlen(name));
    }
}

static void APIENTRY hear(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length, const GLchar *text,
                          const void *user)
{
    ssfr_gl *gl;
    (void)id;
    memcpy(&gl, &user, sizeof gl); /* the pointer given to glDebugMessageCallback, to const only by its signature */
    /* Whether a shader compiled and linked is asked, and said, by program.c. */
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
    if (type == GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_HIGH)
        note(gl, text, length < 0 ? strlen(text) : (size_t)length);
}

void ssfr_gl_listen(ssfr_gl *gl)
{
    /* Outside of a debug context messages cost frames on some drivers, and may come from another thread: there the
     * flags of glGetError are read after each group instead, and a host's callback is spared ssfr's messages. */
    if (!gl->listens) {
        glDisable(GL_DEBUG_OUTPUT);
    } else {
        glDebugMessageCallback(hear, gl);
        glEnable(GL_DEBUG_OUTPUT);
        glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    }
    /* The filters belong to the group, so that ssfr_gl_end puts a host's back by closing it. */
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, "ssfr");
    glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, NULL, GL_FALSE);
    glDebugMessageControl(GL_DONT_CARE, GL_DEBUG_TYPE_ERROR, GL_DONT_CARE, 0, NULL, GL_TRUE);
    glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DEBUG_SEVERITY_HIGH, 0, NULL, GL_TRUE);
}

void ssfr_gl_push(ssfr_gl *gl, const char *name)
{
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, name);
    if (gl->n_groups < SSFR_GL_GROUPS) gl->groups[gl->n_groups] = name;
    gl->n_groups++;
}

void ssfr_gl_pop(ssfr_gl *gl)
{
    if (!gl->listens) ssfr_gl_note_errors(gl);
    glPopDebugGroup();
    gl->n_groups--;
}

/* SPDX-License-Identifier: MIT */
/* internal.h: what ssfr_gl holds, and what its files call of each other. */
#ifndef SSFR_GL_INTERNAL_H
#define SSFR_GL_INTERNAL_H

#include "gl/gl.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

enum { SSFR_GL_GROUPS = 8, SSFR_GL_TARGETS = 4, SSFR_GL_ERROR_FLAGS = 16 };

typedef struct ssfr_gl_host ssfr_gl_host;
typedef struct ssfr_gl_program ssfr_gl_program;

/* What EGL has current in this thread. */
typedef struct ssfr_gl_current {
    EGLenum api;
    EGLDisplay display;
    EGLSurface draw, read;
    EGLContext context;
} ssfr_gl_current;

struct ssfr_gl {
    ssfr_gl_source source;
    EGLDisplay display;       /* OWN: never terminated, for a host may use the same one */
    EGLContext context;       /* OWN: to be destroyed; CURRENT: EGL's handle of the host's, none when it is GLX's */
    ssfr_gl_current previous; /* OWN: to be put back by ssfr_gl_end */
    ssfr_gl_host *host;       /* CURRENT: the state to be put back by ssfr_gl_end */
    bool begun;
    bool listens;             /* a debug context: errors come by callback, with the driver's text */

    char renderer[256], vendor[256], version[256];
    bool software;
    ssfr_gl_limits limits;

    unsigned vertex_array, framebuffer, query;
    int n_attached; /* colour attachments of framebuffer */
    ssfr_gl_program *programs;
    long allocations;

    const char *groups[SSFR_GL_GROUPS];
    int n_groups;    /* may exceed SSFR_GL_GROUPS; names beyond are not kept */
    char error[512]; /* the first error since begin, "" for none */
};

/* state.c */
SSFR_MUST ssfr_result ssfr_gl_host_create(ssfr_gl *gl);
void ssfr_gl_host_save(ssfr_gl *gl);
/* In two steps, so that errors of the first are still heard by ssfr's callback and not by the host's. */
void ssfr_gl_host_restore(ssfr_gl *gl);
void ssfr_gl_host_restore_debug(ssfr_gl *gl);

/* debug.c */
const char *ssfr_gl_error_name(GLenum code);
/* Takes the flags of glGetError; the first becomes the error of ssfr_gl_end unless there is one. */
void ssfr_gl_note_errors(ssfr_gl *gl);
void ssfr_gl_listen(ssfr_gl *gl);

/* texture.c: lets go of the textures of the last ssfr_gl_target: while attached, their memory outlives them. */
void ssfr_gl_detach(ssfr_gl *gl);

/* program.c */
/* What the first error in a compiler's log says, up to its line's end; *line is 0 when it names no place. */
const char *ssfr_gl_parse_log(const char *log, long *line);
/* Frees the cache, and its programs when their context is current. */
void ssfr_gl_programs_finish(ssfr_gl *gl, bool current);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gl_host.h: a host program's GL context, what its state is, and GL for tests that need it. */
#ifndef SSFR_TESTS_GL_HOST_H
#define SSFR_TESTS_GL_HOST_H

#include "tests/util.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

typedef struct test_host {
    EGLDisplay display;
    EGLContext context;
} test_host;

/* A context of ssfr's own. Without GL the test is skipped, or fails when the environment says GL=required. */
ssfr_gl *test_gl_or_skip(void);

/* A current GL 4.5 context, or a skip like test_gl_or_skip. flags: EGL_CONTEXT_OPENGL_DEBUG and the like, ended by
 * EGL_NONE, or NULL. */
void test_host_create(test_host *host, const EGLint *flags);
/* A current context of another kind; false when the driver refuses it. */
bool test_host_try(test_host *host, EGLenum api, int major, int minor, const EGLint *flags);
void test_host_make_current(const test_host *host);
void test_host_destroy(test_host *host);

/* Every piece of the current context's state that ssfr promises to leave as found, one "NAME[index] values" a line,
 * to free(). Written without knowledge of how the library saves it. */
char *test_host_snapshot(void);

/* Every line differs, or every line is the same; each that is not so is printed. */
void test_host_assert_differs(const char *before, const char *after);
void test_host_assert_same(const char *before, const char *after);

#endif

/* SPDX-License-Identifier: MIT */
/* query.c: whether anything was drawn: an occlusion query, and the wait for its answer. */
#include "gl/internal.h"

void ssfr_gl_watch_begin(ssfr_gl *gl)
{
    glBeginQuery(GL_ANY_SAMPLES_PASSED, gl->query);
}

bool ssfr_gl_watch_end(ssfr_gl *gl)
{
    GLuint any = 0;
    glEndQuery(GL_ANY_SAMPLES_PASSED);
    glGetQueryObjectuiv(gl->query, GL_QUERY_RESULT, &any);
    return any != 0;
}

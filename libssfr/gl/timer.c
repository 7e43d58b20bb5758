/* SPDX-License-Identifier: MIT */
/* timer.c: GPU timestamps around pieces of work. */
#include "gl/internal.h"

ssfr_result ssfr_timers_create(ssfr_timers *timers, int n)
{
    ssfr_result result = SSFR_OK;
    *timers = (ssfr_timers){0};
    if (n < 0) return ssfr_fail(SSFR_ERR_VALUE, "%d timers: expected 0 or more", n);
    SSFR_TRY(ssfr_alloc(&timers->queries, 2 * (size_t)n, sizeof *timers->queries, "timers"));
    glCreateQueries(GL_TIMESTAMP, 2 * n, timers->queries);
    timers->n = n;
end:
    return result;
}

void ssfr_timers_finish(ssfr_timers *timers)
{
    if (timers->n) glDeleteQueries(2 * timers->n, timers->queries);
    free(timers->queries);
    *timers = (ssfr_timers){0};
}

void ssfr_timers_start(ssfr_timers *timers, int i)
{
    glQueryCounter(timers->queries[2 * i], GL_TIMESTAMP);
}

void ssfr_timers_stop(ssfr_timers *timers, int i)
{
    glQueryCounter(timers->queries[2 * i + 1], GL_TIMESTAMP);
}

double ssfr_timers_ms(const ssfr_timers *timers, int i)
{
    GLuint64 start = 0, stop = 0; /* ns */
    glGetQueryObjectui64v(timers->queries[2 * i], GL_QUERY_RESULT, &start);
    glGetQueryObjectui64v(timers->queries[2 * i + 1], GL_QUERY_RESULT, &stop);
    return 1e-6 * (double)(int64_t)(stop - start);
}

/* SPDX-License-Identifier: MIT */
/* pos.c: reads and writes .pos particles: uint32 count, float radius, then x y z as floats, all little-endian. */
#include "scene/writer.h"

static ssfr_result read_all(ssfr_reading *reading, ssfr_stream *stream)
{
    enum { HEADER = 8, PARTICLE = 12 }; /* bytes */
    ssfr_result result = SSFR_OK;
    const size_t size = (size_t)(stream->end - stream->at);
    double n = 0;
    if (!ssfr_stream_next(stream, SSFR_UINT32, &n) || !ssfr_stream_next(stream, SSFR_FLOAT32, &reading->given.radius))
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: %zu bytes: too short for a count and a radius", reading->path, size);
    if (size != HEADER + PARTICLE * (size_t)n)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: %zu bytes, but a count of %.0f makes %.0f", reading->path, size, n,
                         HEADER + PARTICLE * n);
    SSFR_TRY(ssfr_reading_begin(reading, (size_t)n));
    const ssfr_target positions = ssfr_target_positions(reading);
    SSFR_TRY(ssfr_stream_fill(stream, SSFR_FLOAT32, reading, &positions));
end:
    return result;
}

ssfr_result ssfr_pos_read(ssfr_reading *reading)
{
    char *file = NULL;
    ssfr_stream stream;
    ssfr_result result = ssfr_stream_open(&stream, reading->path, &file);
    if (result == SSFR_OK) result = read_all(reading, &stream);
    free(file);
    return result;
}

ssfr_result ssfr_pos_write(const ssfr_particles *set, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_sink sink;
    SSFR_TRY(ssfr_sink_begin(&sink, path, SSFR_LITTLE_ENDIAN));
    ssfr_sink_bits32(&sink, (uint32_t)set->n);
    ssfr_sink_float(&sink, (float)set->radius);
    for (size_t i = 0; i < set->n; i++) ssfr_sink_position(&sink, set, i, false);
end:
    return ssfr_sink_end(&sink, result);
}

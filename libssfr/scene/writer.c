/* SPDX-License-Identifier: MIT */
/* writer.c: what the particle writers share: a file written aside through one buffer, numbers in either byte order. */
#include "scene/writer.h"

#include <errno.h>
#include <stdarg.h>

ssfr_result ssfr_sink_begin(ssfr_sink *sink, const char *path, ssfr_encoding encoding)
{
    ssfr_result result = SSFR_OK;
    const bool host_is_big = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
    sink->file = NULL;
    sink->error = 0;
    sink->n = 0;
    sink->swap = (encoding == SSFR_BIG_ENDIAN) != host_is_big;
    SSFR_TRY(ssfr_aside_begin(&sink->aside, path));
    sink->file = fopen(sink->aside.temporary, "wb");
    if (!sink->file) result = ssfr_fail(SSFR_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
end:
    return result;
}

ssfr_result ssfr_sink_end(ssfr_sink *sink, ssfr_result so_far)
{
    ssfr_result result = so_far;
    if (sink->file) {
        ssfr_sink_flush(sink);
        if (fclose(sink->file) != 0 && !sink->error) sink->error = errno;
        if (result == SSFR_OK && sink->error)
            result = ssfr_fail(SSFR_ERR_IO, "%s: cannot be written: %s", sink->aside.path, strerror(sink->error));
    }
    sink->file = NULL;
    return ssfr_aside_end(&sink->aside, result);
}

void ssfr_sink_flush(ssfr_sink *sink)
{
    if (!sink->error && fwrite(sink->buffer, 1, sink->n, sink->file) != sink->n) sink->error = errno ? errno : EIO;
    sink->n = 0;
}

void ssfr_sink_bytes(ssfr_sink *sink, const void *bytes, size_t n)
{
    const unsigned char *at = bytes;
    while (n > 0) {
        const size_t part = n < SSFR_SINK_ROOM ? n : SSFR_SINK_ROOM;
        memcpy(ssfr_sink_reserve(sink, part), at, part);
        at += part;
        n -= part;
    }
}

void ssfr_sink_text(ssfr_sink *sink, const char *format, ...)
{
    char text[1024];
    va_list args;
    va_start(args, format);
    const int length = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (length > 0) ssfr_sink_bytes(sink, text, (size_t)length < sizeof text ? (size_t)length : sizeof text - 1);
}

enum { FLOAT_DIGITS = 9, DOUBLE_DIGITS = 17 }; /* that tell any two apart */

static void put_number(ssfr_sink *sink, double value, int digits)
{
    char *const at = (char *)ssfr_sink_reserve(sink, SSFR_NUMBER_TEXT);
    sink->n -= SSFR_NUMBER_TEXT - (size_t)snprintf(at, SSFR_NUMBER_TEXT, "%.*g", digits, value);
}

void ssfr_sink_float_text(ssfr_sink *sink, float value)
{
    put_number(sink, (double)value, FLOAT_DIGITS);
}

void ssfr_sink_whole_text(ssfr_sink *sink, uint32_t value)
{
    char text[SSFR_NUMBER_TEXT], *at = text + sizeof text;
    do
        *--at = (char)('0' + value % 10);
    while ((value /= 10) > 0);
    ssfr_sink_bytes(sink, at, (size_t)(text + sizeof text - at));
}

void ssfr_sink_position_text(ssfr_sink *sink, const ssfr_particles *particles, size_t i, char separator)
{
    double at[3];
    ssfr_particles_position(particles, i, at);
    for (int k = 0; k < 3; k++) {
        if (k > 0) ssfr_sink_bytes(sink, &separator, 1);
        put_number(sink, at[k], DOUBLE_DIGITS);
    }
}

void ssfr_sink_position(ssfr_sink *sink, const ssfr_particles *particles, size_t i, bool as_double)
{
    double at[3];
    ssfr_particles_position(particles, i, at);
    for (int k = 0; k < 3; k++)
        if (as_double)
            ssfr_sink_double(sink, at[k]);
        else
            ssfr_sink_float(sink, (float)at[k]);
}

void ssfr_sink_values(ssfr_sink *sink, const ssfr_particles *particles, const ssfr_array *array, size_t i)
{
    const char *values = ssfr_array_get(particles, array);
    for (size_t k = 0; k < array->count; k++) {
        uint32_t bits;
        memcpy(&bits, values + (array->count * i + k) * SSFR_ARRAY_VALUE, sizeof bits);
        ssfr_sink_bits32(sink, bits);
    }
}

bool ssfr_floats_suffice(const ssfr_particles *set)
{
    bool same = true;
    for (size_t i = 0; i < set->n && same; i++) {
        double at[3];
        const ssfr_packet *packet = set->packets + i / SSFR_PACKET;
        ssfr_particles_position(set, i, at);
        for (size_t k = 0; k < 3; k++)
            same = same && (float)((double)(float)at[k] - packet->centre[k]) == set->position[3 * i + k];
    }
    return same;
}

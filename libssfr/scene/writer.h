/* SPDX-License-Identifier: MIT */
/* writer.h: what the particle writers share: a file written aside through one buffer, numbers in either byte order.
 *
 * Nothing that is put fails: the sink remembers the first error, and ssfr_sink_end tells it. */
#ifndef SSFR_WRITER_H
#define SSFR_WRITER_H

#include "scene/reader.h"

enum { SSFR_SINK_ROOM = 1 << 16 /* bytes */ };

typedef struct ssfr_sink {
    ssfr_aside aside;
    FILE *file;
    bool swap;  /* numbers' bytes: the file's order is not this machine's */
    int error;  /* errno of the first write that failed; nothing is written after it */
    size_t n;   /* bytes that wait in the buffer */
    unsigned char buffer[SSFR_SINK_ROOM];
} ssfr_sink;

/* Opens the file aside; binary numbers will have the encoding's byte order. */
SSFR_MUST ssfr_result ssfr_sink_begin(ssfr_sink *sink, const char *path, ssfr_encoding encoding);
/* Gives the file its name when so_far and all writing are well, else removes it; also after a begin that failed. */
SSFR_MUST ssfr_result ssfr_sink_end(ssfr_sink *sink, ssfr_result so_far);

void ssfr_sink_flush(ssfr_sink *sink);
void ssfr_sink_bytes(ssfr_sink *sink, const void *bytes, size_t n);
__attribute__((format(printf, 2, 3))) void ssfr_sink_text(ssfr_sink *sink, const char *format, ...); /* < 1024 bytes */

enum { SSFR_NUMBER_TEXT = 32 /* bytes: "-2.2250738585072014e-308" with room to spare */ };

/* The text of a number that reads back as the same. */
void ssfr_sink_float_text(ssfr_sink *sink, float value);
void ssfr_sink_whole_text(ssfr_sink *sink, uint32_t value);
/* World position of particle i, m, with a separator between coordinates. */
void ssfr_sink_position_text(ssfr_sink *sink, const ssfr_particles *particles, size_t i, char separator);

/* World position of particle i, m, as three doubles or floats; values of its array, 4 bytes each. */
void ssfr_sink_position(ssfr_sink *sink, const ssfr_particles *particles, size_t i, bool as_double);
void ssfr_sink_values(ssfr_sink *sink, const ssfr_particles *particles, const ssfr_array *array, size_t i);

/* Whether world positions rounded to float come back as the same positions in their packets. */
bool ssfr_floats_suffice(const ssfr_particles *particles);

static inline unsigned char *ssfr_sink_reserve(ssfr_sink *sink, size_t n)
{
    if (sink->n + n > SSFR_SINK_ROOM) ssfr_sink_flush(sink);
    unsigned char *const at = sink->buffer + sink->n;
    sink->n += n;
    return at;
}

static inline void ssfr_sink_bits32(ssfr_sink *sink, uint32_t bits)
{
    if (sink->swap) bits = __builtin_bswap32(bits);
    memcpy(ssfr_sink_reserve(sink, sizeof bits), &bits, sizeof bits);
}

static inline void ssfr_sink_float(ssfr_sink *sink, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    ssfr_sink_bits32(sink, bits);
}

static inline void ssfr_sink_double(ssfr_sink *sink, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    if (sink->swap) bits = __builtin_bswap64(bits);
    memcpy(ssfr_sink_reserve(sink, sizeof bits), &bits, sizeof bits);
}

#endif

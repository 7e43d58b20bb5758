/* SPDX-License-Identifier: MIT */
/* reader.h: what a particle reader fills, and what the readers share: arrays by name, streams of numbers.
 *
 * A reader takes a path and gets n particles, in file order, into an ssfr_reading. Whether they are finite, their
 * radius and their packing are the same for all formats: ssfr_particles_load looks after them. In error lines particles
 * are counted from 0. */
#ifndef SSFR_READER_H
#define SSFR_READER_H

#include "base/base.h"

/* A line of SSFR_ATTRIBUTES as data. Values have 4 bytes in every array: floats, or whole numbers as uint32_t. */
typedef struct ssfr_array {
    const char *name, *unit;
    size_t offset; /* of the array's pointer in ssfr_particles */
    size_t count;  /* values a particle */
    bool real;     /* float, else uint32_t */
} ssfr_array;

#define X(name, type, count, unit) +1
enum { SSFR_N_ARRAYS = 0 SSFR_ATTRIBUTES(X), SSFR_ARRAY_VALUE = 4 /* bytes */ };
#undef X

extern const ssfr_array ssfr_arrays[SSFR_N_ARRAYS];

/* The array that a file's word names, in any case and with the usual other names ("rho", "neighbors"), or NULL. */
const ssfr_array *ssfr_array_find(const char *word);

/* Through memcpy, because a float * may not be read as a void *. */
static inline void *ssfr_array_get(const ssfr_particles *particles, const ssfr_array *array)
{
    void *values;
    memcpy(&values, (const char *)particles + array->offset, sizeof values);
    return values;
}

static inline void ssfr_array_set(ssfr_particles *particles, const ssfr_array *array, void *values)
{
    memcpy((char *)particles + array->offset, &values, sizeof values);
}

/* ---- what a reader fills ----------------------------------------------------------------------------------------- */

typedef struct ssfr_reading {
    const char *path;     /* set by the caller */
    const char *map;      /* set by the caller: where an HDF5 file has its arrays; NULL: as ssfr has them */
    double *positions;    /* m, 3 n */
    ssfr_particles given; /* n, radius (m; 0 when the file has none) and the arrays that the file has */
    double radii[2];      /* m, the least and the largest where each particle has its own */
    char skipped[256];    /* names of what the file has beside, as far as there is room */
} ssfr_reading;

typedef ssfr_result ssfr_reader(ssfr_reading *reading);
typedef ssfr_result ssfr_writer(const ssfr_particles *particles, const char *path);

/* What written files hold beside positions as floats. */
enum {
    SSFR_HOLDS_DOUBLES = 1, /* positions that floats would change as doubles */
    SSFR_HOLDS_RADIUS = 2,
    SSFR_HOLDS_ARRAYS = 4, /* all of SSFR_ATTRIBUTES */
    SSFR_HOLDS_UINT32 = 8, /* whole numbers above INT32_MAX, which else are refused */
    SSFR_HOLDS_ALL = 15,
};

#define X(ending, reader, writer, holds, help) ssfr_reader reader;
#include "scene/formats.def"
#undef X
ssfr_writer ssfr_hdf5_write, ssfr_ply_write, ssfr_vtk_write, ssfr_pos_write, ssfr_csv_write, ssfr_xyz_write,
            ssfr_bgeo_write, ssfr_vtp_write;

enum { SSFR_READ_MAX_GIB = 8 };
#define SSFR_READ_MAX ((size_t)SSFR_READ_MAX_GIB << 30) /* bytes, the largest file that is read whole */
enum { SSFR_DEFLATE_MOST = 1032 /* times: no deflated byte makes more */ };

/* Room for n particles' positions. The caller has held n against the file's size. */
SSFR_MUST ssfr_result ssfr_reading_begin(ssfr_reading *reading, size_t n);
/* Takes note of something of the particles that is not read. */
void ssfr_reading_skip(ssfr_reading *reading, const char *name);
/* When n particles were read, which may be fewer. Their own radius is the reading's if all have the same and the file
 * says no other. */
void ssfr_reading_end(ssfr_reading *reading, size_t n);
void ssfr_reading_finish(ssfr_reading *reading);

/* Where values go: exactly one pointer is set. */
typedef struct ssfr_target {
    double *positions;
    float *reals;
    uint32_t *wholes;
    double *radii; /* of the reading: values are held against these two */
    const char *name;
    size_t count; /* values a particle */
} ssfr_target;

ssfr_target ssfr_target_positions(const ssfr_reading *reading);
ssfr_target ssfr_target_radii(ssfr_reading *reading);
/* Makes the array, which the reading must not have yet, and points at it. */
SSFR_MUST ssfr_result ssfr_target_array(ssfr_reading *reading, const ssfr_array *array, ssfr_target *out);

/* The error line for a value that target's whole numbers cannot hold. */
ssfr_result ssfr_target_refuse(const ssfr_reading *reading, const ssfr_target *target, size_t i, double value);
ssfr_result ssfr_target_put_radius(const ssfr_reading *reading, const ssfr_target *target, size_t i, double value);

/* Stores value k of the array, that is component k % count of particle k / count. */
static inline ssfr_result ssfr_target_put(const ssfr_reading *reading, const ssfr_target *target, size_t k,
                                          double value)
{
    ssfr_result result = SSFR_OK;
    if (target->positions)
        target->positions[k] = value;
    else if (target->reals)
        target->reals[k] = (float)value;
    else if (target->radii)
        result = ssfr_target_put_radius(reading, target, k, value);
    else if (value >= 0 && value <= UINT32_MAX && (double)(uint32_t)value == value)
        target->wholes[k] = (uint32_t)value;
    else
        result = ssfr_target_refuse(reading, target, k / target->count, value);
    return result;
}

/* ---- streams of numbers ------------------------------------------------------------------------------------------ */

typedef enum ssfr_scalar {
    SSFR_INT8, SSFR_UINT8, SSFR_INT16, SSFR_UINT16, SSFR_INT32, SSFR_UINT32, SSFR_INT64, SSFR_UINT64,
    SSFR_FLOAT32, SSFR_FLOAT64,
} ssfr_scalar;

typedef enum ssfr_encoding { SSFR_ASCII, SSFR_LITTLE_ENDIAN, SSFR_BIG_ENDIAN } ssfr_encoding;

/* The rest of a file in memory. A zero byte stands at end. */
typedef struct ssfr_stream {
    const char *at, *end;
    ssfr_encoding encoding;
    const char *blanks; /* what may stand before a number in ascii; without \n, numbers end with the line */
} ssfr_stream;

/* Reads the whole file, to be freed by the caller, into a stream of little-endian numbers. */
SSFR_MUST ssfr_result ssfr_stream_open(ssfr_stream *out, const char *path, char **file);

size_t ssfr_scalar_size(ssfr_scalar type); /* bytes */

/* False when the stream ends or something else than a number stands there; then it does not move. */
bool ssfr_stream_next(ssfr_stream *stream, ssfr_scalar type, double *value);
bool ssfr_stream_skip(ssfr_stream *stream, ssfr_scalar type, size_t n);

/* The fewest bytes that a number takes: in ascii a digit and a blank. */
size_t ssfr_stream_value_size(const ssfr_stream *stream, ssfr_scalar type);
/* Whether n things of at least `size` bytes each may follow: the check before anything is allocated for them. */
bool ssfr_stream_holds(const ssfr_stream *stream, size_t n, size_t size);

/* Reads all 3 n or count n values of a target. */
SSFR_MUST ssfr_result ssfr_stream_fill(ssfr_stream *stream, ssfr_scalar type, const ssfr_reading *reading,
                                       const ssfr_target *target);

/* What stands at the stream's place, for an error line: "the file ends" or "found ..." with a printable word. */
enum { SSFR_FOUND = 48 };
const char *ssfr_stream_found(const ssfr_stream *stream, char text[SSFR_FOUND]);
/* A file's word for an error line: its start, with what is not printable replaced. */
const char *ssfr_printable(const char *word, char text[SSFR_FOUND]);

/* True when the whole word is a count that size_t holds: digits only. */
bool ssfr_parse_count(const char *word, size_t *out);

#endif

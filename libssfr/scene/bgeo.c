/* SPDX-License-Identifier: MIT */
/* bgeo.c: reads particles in Houdini's classic .bgeo, plain or gzipped, and writes them gzipped, as Partio does.
 *
 *   "BgeoV"    int32 5, then counts: points, primitives, groups of points and of primitives, attributes of points, of
 *              vertices, of primitives and of the whole
 *   attribute  uint16 length and a name, uint16 size, int32 type, size defaults; for words their int32 count instead,
 *              and each with its uint16 length
 *   point      x y z w, then its attributes one after the other: 4 bytes a number, or a word's index
 *
 * All is big-endian. What follows the points is not looked at. The attribute pscale is a particle's radius. */
#include "scene/reader.h"

#include <errno.h>
#include <limits.h>
#include <zlib.h>

enum { VERSION = 5, MAX_ATTRIBUTES = 256, MAX_WORDS = 1 << 20, BLOCK = 1 << 16 /* bytes */ };
enum { WAITING = 64 /* bytes, more than zlib holds back */ };
enum { PLACE = 4 /* numbers: x y z w */, NUMBER = 4 /* bytes */, NAME = 64 /* bytes; ours are shorter */ };

typedef enum type { FLOAT = 0, INT = 1, WORD = 4, VECTOR = 5 } type;

static const char magic[] = "BgeoV", newer_magic[] = "\x7fNSJ", radius_name[] = "pscale";

/* ---- bytes, inflated where they must be -------------------------------------------------------------------------- */

typedef struct input {
    const char *path;
    ssfr_stream file; /* what was not yet read or handed to zlib */
    bool packed;
    z_stream z;
    size_t left;      /* bytes that may still be inflated */
    char *buffer;     /* the last ones that were */
    size_t room;
} input;

/* Starts to inflate where the file is gzipped. */
static ssfr_result begin_input(input *in)
{
    static const unsigned char gzip[] = {0x1f, 0x8b};
    enum { GZIP = 16 }; /* what zlib adds to the size of the window */
    const size_t size = (size_t)(in->file.end - in->file.at);
    in->packed = size >= sizeof gzip && memcmp(in->file.at, gzip, sizeof gzip) == 0;
    in->left = SSFR_READ_MAX;
    if (in->packed && inflateInit2(&in->z, GZIP + MAX_WBITS) != Z_OK) {
        in->packed = false;
        return ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory to inflate it", in->path);
    }
    return SSFR_OK;
}

static void end_input(input *in)
{
    if (in->packed) inflateEnd(&in->z);
    free(in->buffer);
}

static void feed(input *in)
{
    const size_t left = (size_t)(in->file.end - in->file.at), part = left < INT_MAX ? left : INT_MAX;
    if (in->z.avail_in > 0) return;
    in->z.next_in = (Bytef *)(uintptr_t)in->file.at;
    in->z.avail_in = (uInt)part;
    in->file.at += part;
}

/* Inflates up to n bytes and returns how many there were: fewer where the data end or are damaged. A file may be
 * several gzipped ones, one after the other. */
static size_t inflate_some(input *in, char *out, size_t n, bool *ended)
{
    int status = Z_OK;
    in->z.next_out = (Bytef *)out;
    in->z.avail_out = (uInt)n;
    while (in->z.avail_out > 0 && status == Z_OK) {
        feed(in);
        status = inflate(&in->z, Z_NO_FLUSH);
        if (status == Z_STREAM_END) feed(in);
        if (status == Z_STREAM_END && in->z.avail_in > 0 && *in->z.next_in == 0x1f) status = inflateReset(&in->z);
    }
    *ended = status == Z_STREAM_END;
    return n - in->z.avail_out;
}

static ssfr_result fail_input(const input *in, const char *what)
{
    if (in->packed && in->z.msg)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: expected %s, but the gzipped data are damaged: %s", in->path, what,
                         in->z.msg);
    return ssfr_fail(SSFR_ERR_FORMAT, "%s: expected %s, the file ends", in->path, what);
}

static ssfr_result make_room(input *in, size_t n)
{
    ssfr_result result = SSFR_OK;
    if (n > in->left)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: inflated, it has more than %d GiB", in->path, SSFR_READ_MAX_GIB);
    if (n > in->room || !in->buffer) {
        free(in->buffer);
        in->room = 0;
        SSFR_TRY(ssfr_alloc(&in->buffer, n, 1, "inflated bytes"));
        in->room = n;
    }
    in->left -= n;
end:
    return result;
}

/* The next n bytes, valid until the next call; n is no larger than an int, and was held against the file's size. */
static ssfr_result take(input *in, size_t n, const char *what, const char **out)
{
    ssfr_result result = SSFR_OK;
    bool ended;
    *out = in->file.at;
    if (in->packed) {
        SSFR_TRY(make_room(in, n));
        *out = in->buffer;
        if (inflate_some(in, in->buffer, n, &ended) < n) result = fail_input(in, what);
    } else if ((size_t)(in->file.end - in->file.at) < n) {
        result = fail_input(in, what);
    } else {
        in->file.at += n;
    }
end:
    return result;
}

/* Inflates the rest, whose end has the check sum of all. */
static ssfr_result check_rest(input *in)
{
    ssfr_result result = SSFR_OK;
    bool ended = false;
    while (in->packed && !ended) {
        SSFR_TRY(make_room(in, BLOCK));
        if (inflate_some(in, in->buffer, BLOCK, &ended) < BLOCK && !ended) return fail_input(in, "the end");
    }
end:
    return result;
}

/* The most bytes that may follow. */
static size_t most_left(const input *in)
{
    const size_t left = (size_t)(in->file.end - in->file.at) + in->z.avail_in;
    const size_t most = (left + WAITING) * SSFR_DEFLATE_MOST;
    return !in->packed ? left : most < in->left ? most : in->left;
}

static ssfr_result take_number(input *in, ssfr_scalar type, const char *what, size_t *out)
{
    ssfr_result result = SSFR_OK;
    const size_t size = ssfr_scalar_size(type);
    ssfr_stream s = {.encoding = SSFR_BIG_ENDIAN};
    double value = 0;
    SSFR_TRY(take(in, size, what, &s.at));
    s.end = s.at + size;
    ssfr_stream_next(&s, type, &value);
    *out = (size_t)value;
end:
    return result;
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

/* An attribute of ours: where its numbers stand in a point's bytes. */
typedef struct column {
    size_t offset; /* bytes */
    ssfr_scalar type;
    ssfr_target target;
} column;

typedef struct bgeo {
    ssfr_reading *reading;
    input in;
    size_t n_attributes;
    size_t record; /* bytes a point */
    int n_columns;
    column columns[SSFR_N_ARRAYS + 1];
    const ssfr_array *arrays[SSFR_N_ARRAYS + 1]; /* of the columns; NULL for the radius */
} bgeo;

static ssfr_result read_header(bgeo *b)
{
    ssfr_result result = SSFR_OK;
    const char *path = b->reading->path, *start = NULL;
    char found[SSFR_FOUND];
    size_t version = 0, unused = 0;
    SSFR_TRY(take(&b->in, sizeof magic - 1, magic, &start));
    if (memcmp(start, newer_magic, sizeof newer_magic - 1) == 0) {
        result = ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: of Houdini's newer format: save it as .bhclassic", path);
        goto end;
    }
    if (memcmp(start, magic, sizeof magic - 1) != 0) {
        char word[sizeof magic] = {0};
        memcpy(word, start, sizeof magic - 1);
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: expected %s, found \"%s\"", path, magic, ssfr_printable(word, found));
        goto end;
    }
    SSFR_TRY(take_number(&b->in, SSFR_UINT32, "the version", &version));
    if (version != VERSION) {
        result = ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: version %zu: only %d is read", path, version, VERSION);
        goto end;
    }
    SSFR_TRY(take_number(&b->in, SSFR_UINT32, "the count of points", &b->reading->given.n));
    for (int i = 0; i < 3; i++) SSFR_TRY(take_number(&b->in, SSFR_UINT32, "counts", &unused));
    SSFR_TRY(take_number(&b->in, SSFR_UINT32, "the count of attributes", &b->n_attributes));
    for (int i = 0; i < 3; i++) SSFR_TRY(take_number(&b->in, SSFR_UINT32, "counts", &unused));
    if (b->n_attributes > MAX_ATTRIBUTES)
        result = ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: %zu attributes: at most %d are read", path, b->n_attributes,
                           MAX_ATTRIBUTES);
end:
    return result;
}

/* A length and so many letters; what is longer than NAME is cut. */
static ssfr_result read_word(bgeo *b, char name[NAME])
{
    ssfr_result result = SSFR_OK;
    size_t length = 0;
    const char *letters = NULL;
    SSFR_TRY(take_number(&b->in, SSFR_UINT16, "the length of a name", &length));
    SSFR_TRY(take(&b->in, length, "a name", &letters));
    snprintf(name, NAME, "%.*s", (int)length, letters);
end:
    return result;
}

/* What stands for a point without a value of its own: never used. */
static ssfr_result skip_defaults(bgeo *b, size_t type, size_t size)
{
    ssfr_result result = SSFR_OK;
    const char *unused = NULL;
    char word[NAME];
    size_t n_words = 0;
    if (type == WORD) {
        SSFR_TRY(take_number(&b->in, SSFR_UINT32, "a count of words", &n_words));
        if (n_words > MAX_WORDS)
            return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: %zu words of an attribute: at most %d are read",
                             b->reading->path, n_words, MAX_WORDS);
        for (size_t i = 0; i < n_words; i++) SSFR_TRY(read_word(b, word));
    } else {
        SSFR_TRY(take(&b->in, size * NUMBER, "default values", &unused));
    }
end:
    return result;
}

static bool has_column(const bgeo *b, const ssfr_array *array)
{
    bool found = false;
    for (int i = 0; i < b->n_columns; i++) found = found || b->arrays[i] == array;
    return found;
}

static void add_column(bgeo *b, const ssfr_array *array, ssfr_scalar type)
{
    b->arrays[b->n_columns] = array;
    b->columns[b->n_columns++] = (column){.offset = b->record, .type = type};
}

/* Keeps an attribute when it is one of ours. */
static void keep_attribute(bgeo *b, const char *name, size_t type, size_t size)
{
    const ssfr_array *array = ssfr_array_find(name);
    const bool radius = strcmp(name, radius_name) == 0 && type == FLOAT && size == 1 && !has_column(b, NULL);
    if (radius)
        add_column(b, NULL, SSFR_FLOAT32);
    else if (array && type != WORD && size == array->count && !has_column(b, array))
        add_column(b, array, type == INT ? SSFR_INT32 : SSFR_FLOAT32);
    else if (array)
        ssfr_log(SSFR_WARNING, "%s: %s skipped: expected one attribute of %zu numbers, found type %zu of %zu",
                 b->reading->path, array->name, array->count, type, size);
    else
        ssfr_reading_skip(b->reading, name);
    b->record += size * NUMBER;
}

static ssfr_result read_attributes(bgeo *b)
{
    ssfr_result result = SSFR_OK;
    b->record = PLACE * NUMBER;
    for (size_t i = 0; i < b->n_attributes; i++) {
        char name[NAME], text[SSFR_FOUND];
        size_t type = 0, size = 0;
        SSFR_TRY(read_word(b, name));
        SSFR_TRY(take_number(&b->in, SSFR_UINT16, "the size of an attribute", &size));
        SSFR_TRY(take_number(&b->in, SSFR_UINT32, "the type of an attribute", &type));
        if (type != FLOAT && type != INT && type != WORD && type != VECTOR) {
            result = ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: attribute %s of type %zu: only %d, %d, %d and %d are read",
                               b->reading->path, ssfr_printable(name, text), type, FLOAT, INT, WORD, VECTOR);
            goto end;
        }
        SSFR_TRY(skip_defaults(b, type, size));
        keep_attribute(b, name, type, size);
    }
end:
    return result;
}

static ssfr_result make_targets(bgeo *b)
{
    ssfr_result result = SSFR_OK;
    const size_t n = b->reading->given.n, most = most_left(&b->in);
    if (n > most / b->record)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: %zu points of %zu bytes are announced, but at most %zu bytes follow",
                         b->reading->path, n, b->record, most);
    SSFR_TRY(ssfr_reading_begin(b->reading, n));
    for (int i = 0; i < b->n_columns; i++) {
        b->columns[i].target = ssfr_target_radii(b->reading);
        if (b->arrays[i]) SSFR_TRY(ssfr_target_array(b->reading, b->arrays[i], &b->columns[i].target));
    }
end:
    return result;
}

/* Reads `count` numbers at `at` into the target's particle i. */
static ssfr_result read_values(const bgeo *b, const char *at, ssfr_scalar type, const ssfr_target *target, size_t i)
{
    ssfr_result result = SSFR_OK;
    ssfr_stream s = {.at = at, .end = at + target->count * NUMBER, .encoding = SSFR_BIG_ENDIAN};
    for (size_t k = 0; k < target->count; k++) {
        double value = 0;
        ssfr_stream_next(&s, type, &value);
        SSFR_TRY(ssfr_target_put(b->reading, target, target->count * i + k, value));
    }
end:
    return result;
}

static ssfr_result read_points(bgeo *b)
{
    ssfr_result result = SSFR_OK;
    const ssfr_target positions = ssfr_target_positions(b->reading);
    const size_t n = b->reading->given.n, most = b->record < BLOCK ? BLOCK / b->record : 1;
    for (size_t first = 0, part; first < n; first += part) {
        const char *record = NULL;
        part = n - first < most ? n - first : most;
        SSFR_TRY(take(&b->in, part * b->record, "points", &record));
        for (size_t i = first; i < first + part; i++, record += b->record) {
            SSFR_TRY(read_values(b, record, SSFR_FLOAT32, &positions, i)); /* w is a weight for curves */
            for (const column *c = b->columns; c < b->columns + b->n_columns; c++)
                SSFR_TRY(read_values(b, record + c->offset, c->type, &c->target, i));
        }
    }
    SSFR_TRY(check_rest(&b->in));
end:
    return result;
}

ssfr_result ssfr_bgeo_read(ssfr_reading *reading)
{
    ssfr_result result = SSFR_OK;
    char *file = NULL;
    bgeo b = {.reading = reading, .in = {.path = reading->path}};
    SSFR_TRY(ssfr_stream_open(&b.in.file, reading->path, &file));
    SSFR_TRY(begin_input(&b.in));
    SSFR_TRY(read_header(&b));
    SSFR_TRY(read_attributes(&b));
    SSFR_TRY(make_targets(&b));
    SSFR_TRY(read_points(&b));
    ssfr_reading_end(reading, reading->given.n);
end:
    end_input(&b.in);
    free(file);
    return result;
}

/* ---- writing: zlib remembers the first error --------------------------------------------------------------------- */

static void put16(gzFile file, size_t value)
{
    const unsigned char bytes[2] = {(unsigned char)(value >> 8), (unsigned char)value};
    gzwrite(file, bytes, sizeof bytes);
}

static void put32(gzFile file, uint32_t bits)
{
    put16(file, bits >> 16);
    put16(file, bits & 0xffff);
}

static void put_float(gzFile file, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put32(file, bits);
}

static void put_attribute(gzFile file, const char *name, size_t size, type type)
{
    put16(file, strlen(name));
    gzwrite(file, name, (unsigned)strlen(name));
    put16(file, size);
    put32(file, type);
    for (size_t k = 0; k < size; k++) put32(file, 0);
}

static void write_header(gzFile file, const ssfr_particles *set)
{
    uint32_t n_attributes = set->radius > 0;
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++) n_attributes += ssfr_array_get(set, ssfr_arrays + a) != NULL;
    const uint32_t counts[] = {VERSION, (uint32_t)set->n, 0, 0, 0, n_attributes, 0, 0, 0};
    gzwrite(file, magic, sizeof magic - 1);
    for (size_t i = 0; i < SSFR_COUNT(counts); i++) put32(file, counts[i]);
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++)
        if (ssfr_array_get(set, a))
            put_attribute(file, a->name, a->count, !a->real ? INT : a->count > 1 ? VECTOR : FLOAT);
    if (set->radius > 0) put_attribute(file, radius_name, 1, FLOAT);
}

static void write_point(gzFile file, const ssfr_particles *set, size_t i)
{
    double at[3];
    ssfr_particles_position(set, i, at);
    for (int k = 0; k < 3; k++) put_float(file, (float)at[k]);
    put_float(file, 1);
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++) {
        const char *values = ssfr_array_get(set, a);
        for (size_t k = 0; values && k < a->count; k++) {
            uint32_t bits;
            memcpy(&bits, values + (a->count * i + k) * SSFR_ARRAY_VALUE, sizeof bits);
            put32(file, bits);
        }
    }
    if (set->radius > 0) put_float(file, (float)set->radius);
}

/* The format has no unsigned numbers. */
static ssfr_result check_wholes(const ssfr_particles *set, const char *path)
{
    if (set->n > INT32_MAX)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: %zu particles: at most %d can be written", path, set->n, INT32_MAX);
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++) {
        const uint32_t *values = a->real ? NULL : ssfr_array_get(set, a);
        for (size_t k = 0; values && k < set->n * a->count; k++)
            if (values[k] > INT32_MAX)
                return ssfr_fail(SSFR_ERR_VALUE, "%s: particle %zu (from 0): %s is %u, at most %d can be written", path,
                                 k / a->count, a->name, values[k], INT32_MAX);
    }
    return SSFR_OK;
}

static ssfr_result write_file(const ssfr_particles *set, const char *path, const char *temporary)
{
    int error = Z_OK;
    errno = 0;
    gzFile file = gzopen(temporary, "wb");
    bool ok = file != NULL;
    if (file) {
        static const unsigned char nothing_follows[] = {0x00, 0xff};
        gzbuffer(file, BLOCK);
        write_header(file, set);
        for (size_t i = 0; i < set->n; i++) write_point(file, set, i);
        gzwrite(file, nothing_follows, sizeof nothing_follows);
        gzerror(file, &error);
        ok = gzclose(file) == Z_OK && error == Z_OK;
    }
    return ok ? SSFR_OK : ssfr_fail(SSFR_ERR_IO, "%s: cannot be written: %s", path, strerror(errno ? errno : EIO));
}

ssfr_result ssfr_bgeo_write(const ssfr_particles *set, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_aside aside = {0};
    SSFR_TRY(check_wholes(set, path));
    SSFR_TRY(ssfr_aside_begin(&aside, path));
    SSFR_TRY(write_file(set, path, aside.temporary));
end:
    return ssfr_aside_end(&aside, result);
}

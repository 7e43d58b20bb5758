/* SPDX-License-Identifier: MIT */
/* vtk.c: reads particles from legacy VTK files (the points of POLYDATA or UNSTRUCTURED_GRID and their POINT_DATA) and
 * writes them as binary POLYDATA. */
#include "scene/writer.h"

#include <ctype.h>
#include <strings.h>

enum { MAX_WORDS = 5, MAX_LINE = 1024 /* bytes */ };

/* What arrays belong to: those of the points are read, and of the file the radius; others are skipped. */
typedef enum owner { OF_FILE, OF_CELLS, OF_POINTS } owner;

typedef struct vtk {
    ssfr_reading *reading;
    ssfr_stream stream;
    const char *start, *place; /* of the file, of the line */
    size_t version;    /* the major one */
    bool has_points;
    owner owner;
    size_t n;       /* tuples of an array, from POINT_DATA or CELL_DATA */
    char line[MAX_LINE];
    char *words[MAX_WORDS]; /* of the line; missing ones are empty */
} vtk;

/* Binary data has no lines, so a place is the byte where the last line of text starts. */
#define FAIL(v, code, format, ...)                                                                                \
    ssfr_fail((code), "%s: byte %zu: " format, (v)->reading->path, (size_t)((v)->place - (v)->start), __VA_ARGS__)

static ssfr_result expected(const vtk *v, const char *what, const char *word)
{
    char text[SSFR_FOUND];
    return FAIL(v, SSFR_ERR_FORMAT, "expected %s, found \"%s\"", what, ssfr_printable(word, text));
}

/* ---- lines and types --------------------------------------------------------------------------------------------- */

/* The line here, without its end, which is passed. */
static ssfr_result next_line(vtk *v)
{
    ssfr_stream *s = &v->stream;
    const char *end = memchr(s->at, '\n', (size_t)(s->end - s->at));
    const size_t length = (size_t)((end ? end : s->end) - s->at);
    v->place = s->at;
    if (length >= MAX_LINE || memchr(s->at, '\0', length)) return expected(v, "a line of text", s->at);
    memcpy(v->line, s->at, length);
    v->line[length] = '\0';
    s->at += length + (end != NULL);
    return SSFR_OK;
}

/* The words of the next line that is not blank; words[0] is empty where the file ends. */
static ssfr_result next_words(vtk *v)
{
    ssfr_result result = SSFR_OK;
    char *rest = NULL, *const nothing = v->line + MAX_LINE - 1;
    while (v->stream.at < v->stream.end && isspace((unsigned char)*v->stream.at)) v->stream.at++;
    SSFR_TRY(next_line(v));
    *nothing = '\0';
    for (int i = 0; i < MAX_WORDS; i++) {
        v->words[i] = strtok_r(i ? NULL : v->line, " \t\r", &rest);
        if (!v->words[i]) v->words[i] = nothing;
    }
end:
    return result;
}

static ssfr_result read_count(const vtk *v, const char *word, size_t *out)
{
    return ssfr_parse_count(word, out) ? SSFR_OK : expected(v, "a count", word);
}

typedef struct scalar {
    const char *name;
    ssfr_scalar type;
    bool bits; /* packed, eight a byte, when binary */
} scalar;

static ssfr_result read_type(const vtk *v, const char *word, const scalar **out)
{
    /* A long has the size it has on the usual 64-bit machine; a vtkIdType is written as an int. */
    static const scalar types[] = {
        {"bit", SSFR_UINT8, true},
        {"char", SSFR_INT8, false},
        {"signed_char", SSFR_INT8, false},
        {"unsigned_char", SSFR_UINT8, false},
        {"short", SSFR_INT16, false},
        {"unsigned_short", SSFR_UINT16, false},
        {"int", SSFR_INT32, false},
        {"unsigned_int", SSFR_UINT32, false},
        {"long", SSFR_INT64, false},
        {"unsigned_long", SSFR_UINT64, false},
        {"vtktypeint64", SSFR_INT64, false},
        {"vtktypeuint64", SSFR_UINT64, false},
        {"vtkidtype", SSFR_INT32, false},
        {"float", SSFR_FLOAT32, false},
        {"double", SSFR_FLOAT64, false},
    };
    *out = NULL;
    for (size_t i = 0; i < SSFR_COUNT(types); i++)
        if (strcasecmp(types[i].name, word) == 0) *out = types + i;
    return *out ? SSFR_OK : expected(v, "a scalar type", word);
}

/* ---- arrays ------------------------------------------------------------------------------------------------------ */

/* a b, refused when the file cannot hold so many values. */
static ssfr_result check_size(const vtk *v, const scalar *type, size_t a, size_t b, size_t *n)
{
    const bool packed = type->bits && v->stream.encoding != SSFR_ASCII;
    const size_t size = ssfr_stream_value_size(&v->stream, type->type), left = (size_t)(v->stream.end - v->stream.at);
    const size_t most = packed ? 8 * left : (left + (v->stream.encoding == SSFR_ASCII)) / size;
    if (b > 0 && a > most / b)
        return FAIL(v, SSFR_ERR_FORMAT, "%zu x %zu values of type %s, but %zu bytes follow", a, b, type->name, left);
    *n = a * b;
    return SSFR_OK;
}

static ssfr_result skip(vtk *v, const scalar *type, size_t tuples, size_t components)
{
    ssfr_result result = SSFR_OK;
    char found[SSFR_FOUND];
    size_t n = 0;
    SSFR_TRY(check_size(v, type, tuples, components, &n));
    if (type->bits && v->stream.encoding != SSFR_ASCII) n = (n + 7) / 8;
    if (!ssfr_stream_skip(&v->stream, type->type, n))
        result = FAIL(v, SSFR_ERR_FORMAT, "expected %zu values of type %s, %s", n, type->name,
                      ssfr_stream_found(&v->stream, found));
end:
    return result;
}

/* Bits come from the highest of a byte down. That they are there is checked. */
static ssfr_result fill_from_bits(vtk *v, const ssfr_target *target)
{
    ssfr_result result = SSFR_OK;
    const size_t n = v->reading->given.n * target->count;
    for (size_t k = 0; k < n; k++)
        SSFR_TRY(ssfr_target_put(v->reading, target, k, (unsigned char)v->stream.at[k / 8] >> (7 - k % 8) & 1));
    v->stream.at += (n + 7) / 8;
end:
    return result;
}

/* One number of the file's own, m. */
static ssfr_result read_radius(vtk *v, const scalar *type)
{
    char found[SSFR_FOUND];
    if (!ssfr_stream_next(&v->stream, type->type, &v->reading->given.radius))
        return FAIL(v, SSFR_ERR_FORMAT, "expected a radius, %s", ssfr_stream_found(&v->stream, found));
    return SSFR_OK;
}

static void tell_skipped(vtk *v, const char *name)
{
    if (v->owner == OF_POINTS) ssfr_reading_skip(v->reading, name);
}

/* The values of an array of the points that go to target. */
static ssfr_result fill(vtk *v, const scalar *type, const ssfr_target *target)
{
    ssfr_result result = SSFR_OK;
    size_t n;
    SSFR_TRY(check_size(v, type, v->reading->given.n, target->count, &n));
    SSFR_TRY(type->bits && v->stream.encoding != SSFR_ASCII
                 ? fill_from_bits(v, target)
                 : ssfr_stream_fill(&v->stream, type->type, v->reading, target));
end:
    return result;
}

/* An array of the points that is one of ours. */
static ssfr_result read_known(vtk *v, const ssfr_array *array, const scalar *type, size_t tuples, size_t components)
{
    ssfr_result result = SSFR_OK;
    const ssfr_particles *given = &v->reading->given;
    ssfr_target target;
    if (tuples != given->n || components != array->count || ssfr_array_get(given, array)) {
        ssfr_log(SSFR_WARNING, "%s: %s skipped: expected one array of %zu x %zu values, found %zu x %zu",
                 v->reading->path, array->name, given->n, array->count, tuples, components);
        return skip(v, type, tuples, components);
    }
    SSFR_TRY(ssfr_target_array(v->reading, array, &target));
    SSFR_TRY(fill(v, type, &target));
end:
    return result;
}

/* Reads the array when it is one of ours, else skips it. */
static ssfr_result read_array(vtk *v, const char *name, const scalar *type, size_t tuples, size_t components)
{
    const ssfr_array *array = v->owner == OF_POINTS ? ssfr_array_find(name) : NULL;
    const bool radius = strcasecmp(name, "radius") == 0 && components == 1 && !type->bits;
    if (array) return read_known(v, array, type, tuples, components);
    if (radius && v->owner == OF_FILE && tuples == 1) return read_radius(v, type);
    if (radius && v->owner == OF_POINTS && tuples == v->reading->given.n) {
        const ssfr_target target = ssfr_target_radii(v->reading);
        return fill(v, type, &target);
    }
    tell_skipped(v, name);
    return skip(v, type, tuples, components);
}

/* ---- sections: each reads from the words of its first line ------------------------------------------------------- */

static ssfr_result read_dataset(vtk *v, size_t unused)
{
    char text[SSFR_FOUND];
    (void)unused;
    if (strcasecmp(v->words[1], "POLYDATA") == 0 || strcasecmp(v->words[1], "UNSTRUCTURED_GRID") == 0) return SSFR_OK;
    return FAIL(v, SSFR_ERR_UNSUPPORTED, "expected POLYDATA or UNSTRUCTURED_GRID, found \"%s\"",
                ssfr_printable(v->words[1], text));
}

/* POINTS n type */
static ssfr_result read_points(vtk *v, size_t unused)
{
    ssfr_result result = SSFR_OK;
    const scalar *type = NULL;
    size_t n = 0, n_values = 0;
    (void)unused;
    if (v->has_points) return FAIL(v, SSFR_ERR_FORMAT, "a second %s", "POINTS");
    SSFR_TRY(read_count(v, v->words[1], &n));
    SSFR_TRY(read_type(v, v->words[2], &type));
    if (type->bits) return expected(v, "a type of coordinates", v->words[2]);
    SSFR_TRY(check_size(v, type, n, 3, &n_values));
    SSFR_TRY(ssfr_reading_begin(v->reading, n));
    v->has_points = true;
    const ssfr_target positions = ssfr_target_positions(v->reading);
    SSFR_TRY(ssfr_stream_fill(&v->stream, type->type, v->reading, &positions));
end:
    return result;
}

/* OFFSETS type or CONNECTIVITY type, and n values. */
static ssfr_result skip_cell_array(vtk *v, const char *name, size_t n)
{
    ssfr_result result = SSFR_OK;
    const scalar *type = NULL;
    SSFR_TRY(next_words(v));
    if (strcasecmp(v->words[0], name) != 0) return expected(v, name, v->words[0]);
    SSFR_TRY(read_type(v, v->words[1], &type));
    SSFR_TRY(skip(v, type, n, 1));
end:
    return result;
}

/* CELLS n size and size ints; since version 5 CELLS n_offsets n_connectivity and two arrays. */
static ssfr_result skip_cells(vtk *v, size_t unused)
{
    ssfr_result result = SSFR_OK;
    const scalar *type = NULL;
    size_t a = 0, b = 0;
    (void)unused;
    SSFR_TRY(read_count(v, v->words[1], &a));
    SSFR_TRY(read_count(v, v->words[2], &b));
    if (v->version < 5) {
        SSFR_TRY(read_type(v, "int", &type));
        SSFR_TRY(skip(v, type, b, 1));
    } else if (a > 0) {
        SSFR_TRY(skip_cell_array(v, "OFFSETS", a));
        SSFR_TRY(skip_cell_array(v, "CONNECTIVITY", b));
    }
end:
    return result;
}

/* CELL_TYPES n */
static ssfr_result skip_cell_types(vtk *v, size_t unused)
{
    ssfr_result result = SSFR_OK;
    const scalar *type = NULL;
    size_t n = 0;
    (void)unused;
    SSFR_TRY(read_count(v, v->words[1], &n));
    SSFR_TRY(read_type(v, "int", &type));
    SSFR_TRY(skip(v, type, n, 1));
end:
    return result;
}

/* POINT_DATA n or CELL_DATA n */
static ssfr_result begin_data(vtk *v, size_t owner_of_arrays)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(read_count(v, v->words[1], &v->n));
    v->owner = (owner)owner_of_arrays;
    if (v->owner == OF_POINTS && (!v->has_points || v->n != v->reading->given.n))
        result = FAIL(v, SSFR_ERR_FORMAT, "POINT_DATA of %zu points, but there are %zu", v->n, v->reading->given.n);
end:
    return result;
}

/* VECTORS name type, and the like; their number of components is the keyword's. */
static ssfr_result read_tuples(vtk *v, size_t components)
{
    ssfr_result result = SSFR_OK;
    const scalar *type = NULL;
    SSFR_TRY(read_type(v, v->words[2], &type));
    SSFR_TRY(read_array(v, v->words[1], type, v->n, components));
end:
    return result;
}

/* TEXTURE_COORDINATES name components type */
static ssfr_result skip_coordinates(vtk *v, size_t unused)
{
    ssfr_result result = SSFR_OK;
    const scalar *type = NULL;
    size_t components = 0;
    (void)unused;
    tell_skipped(v, v->words[1]);
    SSFR_TRY(read_count(v, v->words[2], &components));
    SSFR_TRY(read_type(v, v->words[3], &type));
    SSFR_TRY(skip(v, type, v->n, components));
end:
    return result;
}

/* SCALARS name type [components], then a line LOOKUP_TABLE name */
static ssfr_result read_scalars(vtk *v, size_t components)
{
    static const char table[] = "LOOKUP_TABLE";
    ssfr_result result = SSFR_OK;
    const scalar *type = NULL;
    ssfr_stream *s = &v->stream;
    SSFR_TRY(read_type(v, v->words[2], &type));
    if (v->words[3][0]) SSFR_TRY(read_count(v, v->words[3], &components));
    if (strncasecmp(s->at, table, sizeof table - 1) == 0) {
        const char *end = memchr(s->at, '\n', (size_t)(s->end - s->at));
        s->at = end ? end + 1 : s->end;
    }
    SSFR_TRY(read_array(v, v->words[1], type, v->n, components));
end:
    return result;
}

/* COLOR_SCALARS name components, a tuple a point; LOOKUP_TABLE name n, four a colour. Bytes; in ascii, fractions. */
static ssfr_result skip_colours(vtk *v, size_t components)
{
    ssfr_result result = SSFR_OK;
    const scalar *type = NULL;
    size_t n = 0;
    if (components == 0) tell_skipped(v, v->words[1]);
    SSFR_TRY(read_type(v, "unsigned_char", &type));
    SSFR_TRY(read_count(v, v->words[2], &n));
    SSFR_TRY(skip(v, type, n, components ? components : v->n));
end:
    return result;
}

/* Up to the next blank line. */
static ssfr_result skip_metadata(vtk *v, size_t unused)
{
    ssfr_result result = SSFR_OK;
    (void)unused;
    do
        SSFR_TRY(next_line(v));
    while (v->line[strspn(v->line, " \t\r")] != '\0');
end:
    return result;
}

/* FIELD name n, then n times: name components tuples type, and the values. */
static ssfr_result read_field(vtk *v, size_t unused)
{
    ssfr_result result = SSFR_OK;
    const scalar *type = NULL;
    size_t n = 0, components = 0, tuples = 0;
    SSFR_TRY(read_count(v, v->words[2], &n));
    for (size_t i = 0; i < n; i++) {
        SSFR_TRY(next_words(v));
        while (strcasecmp(v->words[0], "METADATA") == 0) {
            SSFR_TRY(skip_metadata(v, unused));
            SSFR_TRY(next_words(v));
        }
        if (!v->words[0][0]) return expected(v, "an array of the field", "");
        if (strcmp(v->words[0], "NULL_ARRAY") == 0) continue;
        SSFR_TRY(read_count(v, v->words[1], &components));
        SSFR_TRY(read_count(v, v->words[2], &tuples));
        SSFR_TRY(read_type(v, v->words[3], &type));
        SSFR_TRY(read_array(v, v->words[0], type, tuples, components));
    }
end:
    return result;
}

/* ---- the file ---------------------------------------------------------------------------------------------------- */

static const struct {
    const char *keyword;
    ssfr_result (*read)(vtk *v, size_t argument);
    size_t argument;
} sections[] = {
    {"DATASET", read_dataset, 0},
    {"POINTS", read_points, 0},
    {"VERTICES", skip_cells, 0},
    {"LINES", skip_cells, 0},
    {"POLYGONS", skip_cells, 0},
    {"TRIANGLE_STRIPS", skip_cells, 0},
    {"CELLS", skip_cells, 0},
    {"CELL_TYPES", skip_cell_types, 0},
    {"POINT_DATA", begin_data, OF_POINTS},
    {"CELL_DATA", begin_data, OF_CELLS},
    {"FIELD", read_field, 0},
    {"SCALARS", read_scalars, 1},
    {"VECTORS", read_tuples, 3},
    {"NORMALS", read_tuples, 3},
    {"TENSORS", read_tuples, 9},
    {"TENSORS6", read_tuples, 6},
    {"GLOBAL_IDS", read_tuples, 1},
    {"PEDIGREE_IDS", read_tuples, 1},
    {"EDGE_FLAGS", read_tuples, 1},
    {"TEXTURE_COORDINATES", skip_coordinates, 0},
    {"COLOR_SCALARS", skip_colours, 0},
    {"LOOKUP_TABLE", skip_colours, 4},
    {"METADATA", skip_metadata, 0},
};

/* "# vtk DataFile Version 4.1", a title, ASCII or BINARY */
static ssfr_result read_header(vtk *v)
{
    static const char magic[] = "# vtk DataFile Version ";
    ssfr_result result = SSFR_OK;
    SSFR_TRY(next_line(v));
    if (strncasecmp(v->line, magic, sizeof magic - 1) != 0)
        return expected(v, "a line # vtk DataFile Version", v->line);
    char *version = v->line + sizeof magic - 1;
    version[strspn(version, "0123456789")] = '\0';
    SSFR_TRY(read_count(v, version, &v->version));
    if (v->version > 5) return FAIL(v, SSFR_ERR_UNSUPPORTED, "version %zu: at most 5 is read", v->version);
    SSFR_TRY(next_line(v));
    SSFR_TRY(next_words(v));
    if (strcasecmp(v->words[0], "ASCII") == 0)
        v->stream.encoding = SSFR_ASCII;
    else if (strcasecmp(v->words[0], "BINARY") == 0)
        v->stream.encoding = SSFR_BIG_ENDIAN;
    else
        result = expected(v, "ASCII or BINARY", v->words[0]);
end:
    return result;
}

static ssfr_result read_sections(vtk *v)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(next_words(v));
    while (v->words[0][0]) {
        size_t i = 0;
        while (i < SSFR_COUNT(sections) && strcasecmp(sections[i].keyword, v->words[0]) != 0) i++;
        if (i == SSFR_COUNT(sections)) return expected(v, "a keyword", v->words[0]);
        SSFR_TRY(sections[i].read(v, sections[i].argument));
        SSFR_TRY(next_words(v));
    }
    if (!v->has_points) result = ssfr_fail(SSFR_ERR_FORMAT, "%s: there are no POINTS", v->reading->path);
end:
    return result;
}

ssfr_result ssfr_vtk_read(ssfr_reading *reading)
{
    ssfr_result result = SSFR_OK;
    char *file = NULL;
    vtk v = {.reading = reading};
    SSFR_TRY(ssfr_stream_open(&v.stream, reading->path, &file));
    v.start = file;
    SSFR_TRY(read_header(&v));
    SSFR_TRY(read_sections(&v));
    ssfr_reading_end(reading, reading->given.n);
end:
    free(file);
    return result;
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

static void write_points(ssfr_sink *sink, const ssfr_particles *set)
{
    const bool as_double = !ssfr_floats_suffice(set); /* floats would lose digits */
    ssfr_sink_text(sink, "POINTS %zu %s\n", set->n, as_double ? "double" : "float");
    for (size_t i = 0; i < set->n; i++) ssfr_sink_position(sink, set, i, as_double);
    /* A cell for each point: without cells nothing is drawn, and those of single points can be picked one by one. */
    ssfr_sink_text(sink, "\nVERTICES %zu %zu\n", set->n, 2 * set->n);
    for (size_t i = 0; i < set->n; i++) {
        ssfr_sink_bits32(sink, 1);
        ssfr_sink_bits32(sink, (uint32_t)i);
    }
}

static void write_arrays(ssfr_sink *sink, const ssfr_particles *set)
{
    size_t n_arrays = 0;
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++) n_arrays += ssfr_array_get(set, ssfr_arrays + a) != NULL;
    if (n_arrays == 0) return;
    ssfr_sink_text(sink, "\nPOINT_DATA %zu\nFIELD FieldData %zu\n", set->n, n_arrays);
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++) {
        if (!ssfr_array_get(set, a)) continue;
        ssfr_sink_text(sink, "%s %zu %zu %s\n", a->name, a->count, set->n, a->real ? "float" : "unsigned_int");
        for (size_t i = 0; i < set->n; i++) ssfr_sink_values(sink, set, a, i);
        ssfr_sink_text(sink, "\n");
    }
}

ssfr_result ssfr_vtk_write(const ssfr_particles *set, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_sink sink;
    if (set->n > INT32_MAX)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: %zu particles: a cell of legacy VTK counts points up to %d", path,
                         set->n, INT32_MAX);
    SSFR_TRY(ssfr_sink_begin(&sink, path, SSFR_BIG_ENDIAN));
    ssfr_sink_text(&sink, "# vtk DataFile Version 3.0\nparticles: metres, seconds, kilograms\nBINARY\n");
    ssfr_sink_text(&sink, "DATASET POLYDATA\n");
    if (set->radius > 0) {
        ssfr_sink_text(&sink, "FIELD FieldData 1\nradius 1 1 double\n");
        ssfr_sink_double(&sink, set->radius);
        ssfr_sink_text(&sink, "\n");
    }
    write_points(&sink, set);
    write_arrays(&sink, set);
end:
    return ssfr_sink_end(&sink, result);
}

/* SPDX-License-Identifier: MIT */
/* ply.c: reads PLY particles (the vertex element, properties by name, ascii and binary of both byte orders) and writes
 * them as binary little-endian ones. */
#include "scene/table.h"
#include "scene/writer.h"

enum { MAX_ELEMENTS = 32, MAX_PROPERTIES = 256, MAX_WORDS = 6 };

typedef struct property {
    const char *name;
    ssfr_scalar type;
    bool list;
    ssfr_scalar count_type; /* of a list */
    ssfr_column column;
} property;

typedef struct element {
    const char *name;
    size_t n;
    int first, n_properties;
} element;

typedef struct ply {
    ssfr_reading *reading;
    ssfr_table table;
    ssfr_stream stream;
    int line;
    bool has_format;
    int n_elements, n_properties;
    element elements[MAX_ELEMENTS];
    property properties[MAX_PROPERTIES];
} ply;

/* ---- the header -------------------------------------------------------------------------------------------------- */

#define FAIL(p, code, format, ...) ssfr_fail((code), "%s:%d: " format, (p)->reading->path, (p)->line, __VA_ARGS__)

static ssfr_result expected(const ply *p, const char *what, const char *word)
{
    char text[SSFR_FOUND];
    return FAIL(p, SSFR_ERR_FORMAT, "expected %s, found \"%s\"", what, ssfr_printable(word, text));
}

static ssfr_result read_format(ply *p, char *words[])
{
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    size_t i = 0;
    while (i < SSFR_COUNT(names) && strcmp(names[i], words[1]) != 0) i++;
    if (i == SSFR_COUNT(names)) return expected(p, "ascii, binary_little_endian or binary_big_endian", words[1]);
    if (strcmp(words[2], "1.0") != 0) return expected(p, "version 1.0", words[2]);
    p->stream.encoding = (ssfr_encoding)i;
    p->has_format = true;
    return SSFR_OK;
}

/* "particle radius 0.02 m" is a convention; a text of another form, or in another unit, is a mere comment. */
static ssfr_result read_comment(ply *p, char *words[])
{
    double radius;
    const bool metres = !words[4][0] || strcmp(words[4], "m") == 0 || strcmp(words[4], "m,") == 0;
    if (strcmp(words[1], "particle") == 0 && strcmp(words[2], "radius") == 0 && metres &&
        ssfr_parse_number(words[3], &radius))
        p->reading->given.radius = radius;
    return SSFR_OK;
}

static ssfr_result read_info(ply *p, char *words[])
{
    (void)p, (void)words;
    return SSFR_OK;
}

static ssfr_result read_element(ply *p, char *words[])
{
    if (p->n_elements == MAX_ELEMENTS) return FAIL(p, SSFR_ERR_UNSUPPORTED, "more than %d elements", MAX_ELEMENTS);
    element *e = p->elements + p->n_elements++;
    *e = (element){.name = words[1], .first = p->n_properties};
    if (!ssfr_parse_count(words[2], &e->n)) return expected(p, "an element's count", words[2]);
    return words[3][0] ? expected(p, "the line's end", words[3]) : SSFR_OK;
}

static ssfr_result read_type(const ply *p, const char *word, ssfr_scalar *out)
{
    static const char *const names[][2] = {
        {"char", "int8"},   {"uchar", "uint8"}, {"short", "int16"},  {"ushort", "uint16"}, {"int", "int32"},
        {"uint", "uint32"}, {"long", "int64"},  {"ulong", "uint64"}, {"float", "float32"}, {"double", "float64"},
    };
    size_t i = 0;
    while (i < SSFR_COUNT(names) && strcmp(names[i][0], word) != 0 && strcmp(names[i][1], word) != 0) i++;
    if (i == SSFR_COUNT(names)) return expected(p, "a scalar type", word);
    *out = (ssfr_scalar)i;
    return SSFR_OK;
}

/* "property TYPE NAME" or "property list COUNT_TYPE TYPE NAME". */
static ssfr_result read_property(ply *p, char *words[])
{
    ssfr_result result = SSFR_OK;
    if (p->n_elements == 0) return FAIL(p, SSFR_ERR_FORMAT, "expected an element before %s", "the first property");
    if (p->n_properties == MAX_PROPERTIES)
        return FAIL(p, SSFR_ERR_UNSUPPORTED, "more than %d properties", MAX_PROPERTIES);
    property *q = p->properties + p->n_properties++;
    *q = (property){.list = strcmp(words[1], "list") == 0};
    char **rest = words + (q->list ? 3 : 1);
    p->elements[p->n_elements - 1].n_properties++;
    if (q->list) SSFR_TRY(read_type(p, words[2], &q->count_type));
    if (q->list && q->count_type >= SSFR_FLOAT32) return expected(p, "a whole type for a list's length", words[2]);
    SSFR_TRY(read_type(p, rest[0], &q->type));
    if (!rest[1][0]) return expected(p, "a property's name", rest[1]);
    if (rest[2][0]) return expected(p, "the line's end", rest[2]);
    q->name = rest[1];
    q->column = q->list ? (ssfr_column){SSFR_PLACE_NONE, 0} : ssfr_column_find(q->name);
end:
    return result;
}

static ssfr_result read_line(ply *p, char *line)
{
    static const struct {
        const char *keyword;
        ssfr_result (*read)(ply *p, char *words[]);
    } lines[] = {{"format", read_format},   {"comment", read_comment},   {"obj_info", read_info},
                 {"element", read_element}, {"property", read_property}};
    char *words[MAX_WORDS], *rest = NULL, *const nothing = line + strlen(line);
    for (int i = 0; i < MAX_WORDS; i++) {
        words[i] = strtok_r(i ? NULL : line, " \t", &rest);
        if (!words[i]) words[i] = nothing;
    }
    size_t i = 0;
    while (i < SSFR_COUNT(lines) && strcmp(lines[i].keyword, words[0]) != 0) i++;
    return i < SSFR_COUNT(lines) ? lines[i].read(p, words) : expected(p, "a header line", words[0]);
}

/* The next line of the header, its end replaced by a zero byte; NULL when the file ends first. */
static char *next_line(ply *p)
{
    char *line = (char *)p->stream.at;
    char *end = memchr(line, '\n', (size_t)(p->stream.end - p->stream.at));
    p->line++;
    if (!end) return NULL;
    *end = '\0';
    if (end > line && end[-1] == '\r') end[-1] = '\0';
    p->stream.at = end + 1;
    return line;
}

static ssfr_result read_header(ply *p)
{
    ssfr_result result = SSFR_OK;
    char *line = next_line(p);
    if (!line || strcmp(line, "ply") != 0) return expected(p, "ply", line ? line : p->stream.at);
    for (line = next_line(p); line && strcmp(line, "end_header") != 0; line = next_line(p))
        SSFR_TRY(read_line(p, line));
    if (!line) return FAIL(p, SSFR_ERR_FORMAT, "the file ends before %s", "end_header");
    if (!p->has_format) return FAIL(p, SSFR_ERR_FORMAT, "the header lacks a %s line", "format");
end:
    return result;
}

/* ---- the body ---------------------------------------------------------------------------------------------------- */

/* Makes the arrays that the vertex has. */
static ssfr_result make_table(ply *p, const element *vertex)
{
    ssfr_result result = SSFR_OK;
    for (const property *q = p->properties + vertex->first; q < p->properties + vertex->first + vertex->n_properties; q++)
        SSFR_TRY(ssfr_table_add(&p->table, p->reading->path, q->name, q->column));
    SSFR_TRY(ssfr_table_begin(&p->table, p->reading->path, vertex->n));
end:
    return result;
}

static ssfr_result fail_body(const ply *p, const element *e, size_t i, const char *where, const char *what)
{
    const char *kind = strcmp(e->name, "vertex") == 0 ? "particle" : e->name;
    return ssfr_fail(SSFR_ERR_FORMAT, "%s: %s %zu (from 0): %s: %s", p->reading->path, kind, i, where, what);
}

/* Of a list, only the length is looked at. */
static ssfr_result read_list(ply *p, const element *e, size_t i, const property *q)
{
    char found[SSFR_FOUND];
    double length = 0;
    if (!ssfr_stream_next(&p->stream, q->count_type, &length))
        return fail_body(p, e, i, q->name, ssfr_stream_found(&p->stream, found));
    if (!(length >= 0 && length < 1e18 && length == floor(length)))
        return fail_body(p, e, i, q->name, "the list's length is no count");
    if (!ssfr_stream_skip(&p->stream, q->type, (size_t)length))
        return fail_body(p, e, i, q->name, "the list is longer than what follows");
    return SSFR_OK;
}

static ssfr_result read_value(ply *p, const element *e, size_t i, const property *q, bool store)
{
    char found[SSFR_FOUND];
    double value;
    if (!ssfr_stream_next(&p->stream, q->type, &value))
        return fail_body(p, e, i, q->name, ssfr_stream_found(&p->stream, found));
    return store ? ssfr_table_put(&p->table, q->column, i, value) : SSFR_OK;
}

/* All of an element's instances; in ascii each stands on a line of its own. */
static ssfr_result read_instances(ply *p, const element *e, bool store)
{
    ssfr_result result = SSFR_OK;
    ssfr_stream *s = &p->stream;
    const bool ascii = s->encoding == SSFR_ASCII;
    char found[SSFR_FOUND];
    for (size_t i = 0; i < e->n && e->n_properties > 0; i++) {
        if (ascii) s->at += strspn(s->at, " \t\r\n");
        for (const property *q = p->properties + e->first; q < p->properties + e->first + e->n_properties; q++)
            SSFR_TRY(q->list ? read_list(p, e, i, q) : read_value(p, e, i, q, store));
        if (ascii) s->at += strspn(s->at, s->blanks);
        if (ascii && s->at != s->end && *s->at != '\n')
            return fail_body(p, e, i, "after its last property", ssfr_stream_found(s, found));
    }
end:
    return result;
}

static ssfr_result check_size(const ply *p, const element *vertex)
{
    size_t least = 0; /* bytes a particle */
    for (int i = vertex->first; i < vertex->first + vertex->n_properties; i++) {
        const property *q = p->properties + i;
        least += ssfr_stream_value_size(&p->stream, q->list ? q->count_type : q->type);
    }
    if (!ssfr_stream_holds(&p->stream, vertex->n, least ? least : 1))
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: %zu particles of at least %zu bytes are announced, but %zu bytes follow",
                         p->reading->path, vertex->n, least, (size_t)(p->stream.end - p->stream.at));
    return SSFR_OK;
}

/* Elements before the vertices are skipped, those after them are not looked at. */
static ssfr_result read_body(ply *p)
{
    ssfr_result result = SSFR_OK;
    const element *vertex = p->elements, *const end_of_elements = p->elements + p->n_elements;
    if (p->stream.encoding == SSFR_ASCII) p->stream.blanks = " \t\r"; /* a missing value shows where its line ends */
    for (; vertex < end_of_elements && strcmp(vertex->name, "vertex") != 0; vertex++)
        SSFR_TRY(read_instances(p, vertex, false));
    if (vertex == end_of_elements)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: the header has no vertex element", p->reading->path);
    SSFR_TRY(check_size(p, vertex));
    SSFR_TRY(make_table(p, vertex));
    SSFR_TRY(read_instances(p, vertex, true));
    ssfr_table_end(&p->table, vertex->n);
    if (p->stream.encoding == SSFR_ASCII) p->stream.at += strspn(p->stream.at, " \t\r\n");
    if (vertex + 1 == end_of_elements && p->stream.at != p->stream.end)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: %zu bytes follow the last particle", p->reading->path,
                         (size_t)(p->stream.end - p->stream.at));
end:
    return result;
}

ssfr_result ssfr_ply_read(ssfr_reading *reading)
{
    ssfr_result result = SSFR_OK;
    char *file = NULL;
    ply p = {.reading = reading, .table = {.reading = reading}};
    SSFR_TRY(ssfr_stream_open(&p.stream, reading->path, &file));
    SSFR_TRY(read_header(&p));
    SSFR_TRY(read_body(&p));
end:
    free(file);
    return result;
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

/* Scalars keep the array's name, which other programs show as it is; vectors have a property a component, vx vy vz. */
static void write_properties(ssfr_sink *sink, const ssfr_array *array)
{
    const char *type = array->real ? "float" : "uint";
    if (array->count == 1) ssfr_sink_text(sink, "property %s %s\n", type, array->name);
    for (size_t k = 0; k < array->count && array->count > 1; k++)
        ssfr_sink_text(sink, "property %s %c%c\n", type, array->name[0], "xyz"[k]);
}

/* Doubles where floats would lose digits: far from the origin, or where particles lie very close together. */
ssfr_result ssfr_ply_write(const ssfr_particles *set, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_sink sink;
    const bool as_double = !ssfr_floats_suffice(set);
    SSFR_TRY(ssfr_sink_begin(&sink, path, SSFR_LITTLE_ENDIAN));
    ssfr_sink_text(&sink, "ply\nformat binary_little_endian 1.0\ncomment metres, seconds, kilograms\n");
    if (set->radius > 0) ssfr_sink_text(&sink, "comment particle radius %.17g m\n", set->radius);
    ssfr_sink_text(&sink, "element vertex %zu\n", set->n);
    for (int k = 0; k < 3; k++) ssfr_sink_text(&sink, "property %s %c\n", as_double ? "double" : "float", "xyz"[k]);
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++)
        if (ssfr_array_get(set, a)) write_properties(&sink, a);
    ssfr_sink_text(&sink, "end_header\n");
    for (size_t i = 0; i < set->n; i++) {
        ssfr_sink_position(&sink, set, i, as_double);
        for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++)
            if (ssfr_array_get(set, a)) ssfr_sink_values(&sink, set, a, i);
    }
end:
    return ssfr_sink_end(&sink, result);
}

/* SPDX-License-Identifier: MIT */
/* ply_file.c: the header of PLY files and the instances of their elements, ascii and binary of both byte orders. */
#include "scene/ply_file.h"

/* ---- the header -------------------------------------------------------------------------------------------------- */

#define FAIL(p, code, format, ...) ssfr_fail((code), "%s:%d: " format, (p)->path, (p)->line, __VA_ARGS__)

static ssfr_result expected(const ssfr_ply *p, const char *what, const char *word)
{
    char text[SSFR_FOUND];
    return FAIL(p, SSFR_ERR_FORMAT, "expected %s, found \"%s\"", what, ssfr_printable(word, text));
}

static ssfr_result read_format(ssfr_ply *p, char *words[])
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

static ssfr_result read_comment(ssfr_ply *p, char *words[])
{
    if (p->comment) p->comment(p->user, words);
    return SSFR_OK;
}

static ssfr_result read_info(ssfr_ply *p, char *words[])
{
    (void)p, (void)words;
    return SSFR_OK;
}

static ssfr_result read_element(ssfr_ply *p, char *words[])
{
    if (p->n_elements == SSFR_PLY_ELEMENTS)
        return FAIL(p, SSFR_ERR_UNSUPPORTED, "more than %d elements", SSFR_PLY_ELEMENTS);
    ssfr_ply_element *e = p->elements + p->n_elements++;
    *e = (ssfr_ply_element){.name = words[1], .first = p->n_properties};
    if (!ssfr_parse_count(words[2], &e->n)) return expected(p, "an element's count", words[2]);
    return words[3][0] ? expected(p, "the line's end", words[3]) : SSFR_OK;
}

static ssfr_result read_type(const ssfr_ply *p, const char *word, ssfr_scalar *out)
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
static ssfr_result read_property(ssfr_ply *p, char *words[])
{
    ssfr_result result = SSFR_OK;
    if (p->n_elements == 0) return FAIL(p, SSFR_ERR_FORMAT, "expected an element before %s", "the first property");
    if (p->n_properties == SSFR_PLY_PROPERTIES)
        return FAIL(p, SSFR_ERR_UNSUPPORTED, "more than %d properties", SSFR_PLY_PROPERTIES);
    ssfr_ply_property *q = p->properties + p->n_properties++;
    *q = (ssfr_ply_property){.list = strcmp(words[1], "list") == 0};
    char **rest = words + (q->list ? 3 : 1);
    p->elements[p->n_elements - 1].n_properties++;
    if (q->list) SSFR_TRY(read_type(p, words[2], &q->count_type));
    if (q->list && q->count_type >= SSFR_FLOAT32) return expected(p, "a whole type for a list's length", words[2]);
    SSFR_TRY(read_type(p, rest[0], &q->type));
    if (!rest[1][0]) return expected(p, "a property's name", rest[1]);
    if (rest[2][0]) return expected(p, "the line's end", rest[2]);
    q->name = rest[1];
end:
    return result;
}

static ssfr_result read_line(ssfr_ply *p, char *line)
{
    static const struct {
        const char *keyword;
        ssfr_result (*read)(ssfr_ply *p, char *words[]);
    } lines[] = {{"format", read_format},   {"comment", read_comment},   {"obj_info", read_info},
                 {"element", read_element}, {"property", read_property}};
    char *words[SSFR_PLY_WORDS], *rest = NULL, *const nothing = line + strlen(line);
    for (int i = 0; i < SSFR_PLY_WORDS; i++) {
        words[i] = strtok_r(i ? NULL : line, " \t", &rest);
        if (!words[i]) words[i] = nothing;
    }
    size_t i = 0;
    while (i < SSFR_COUNT(lines) && strcmp(lines[i].keyword, words[0]) != 0) i++;
    return i < SSFR_COUNT(lines) ? lines[i].read(p, words) : expected(p, "a header line", words[0]);
}

/* The next line of the header, its end replaced by a zero byte; NULL when the file ends first. */
static char *next_line(ssfr_ply *p)
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

static ssfr_result read_header(ssfr_ply *p)
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

static ssfr_result fail_body(const ssfr_ply *p, const ssfr_ply_element *e, size_t i, const char *where,
                             const char *what)
{
    const char *kind = strcmp(e->name, "vertex") == 0 ? p->vertex : e->name;
    return ssfr_fail(SSFR_ERR_FORMAT, "%s: %s %zu (from 0): %s: %s", p->path, kind, i, where, what);
}

static ssfr_result read_list(ssfr_ply *p, const ssfr_ply_element *e, size_t i, const ssfr_ply_property *q,
                             ssfr_ply_put *put, void *user)
{
    ssfr_result result = SSFR_OK;
    char found[SSFR_FOUND];
    double length = 0;
    if (!ssfr_stream_next(&p->stream, q->count_type, &length))
        return fail_body(p, e, i, q->name, ssfr_stream_found(&p->stream, found));
    if (!(length >= 0 && length < 1e18 && length == floor(length)))
        return fail_body(p, e, i, q->name, "the list's length is no count");
    const size_t n = (size_t)length;
    bool ok = put || ssfr_stream_skip(&p->stream, q->type, n);
    for (size_t k = 0; k < n && put && ok; k++) {
        double value;
        ok = ssfr_stream_next(&p->stream, q->type, &value);
        if (ok) SSFR_TRY(put(user, q, i, k, n, value));
    }
    if (!ok) result = fail_body(p, e, i, q->name, "the list is longer than what follows");
end:
    return result;
}

static ssfr_result read_value(ssfr_ply *p, const ssfr_ply_element *e, size_t i, const ssfr_ply_property *q,
                              ssfr_ply_put *put, void *user)
{
    char found[SSFR_FOUND];
    double value;
    if (!ssfr_stream_next(&p->stream, q->type, &value))
        return fail_body(p, e, i, q->name, ssfr_stream_found(&p->stream, found));
    return put ? put(user, q, i, 0, 1, value) : SSFR_OK;
}

/* In ascii each instance stands on a line of its own. */
ssfr_result ssfr_ply_read_instances(ssfr_ply *p, const ssfr_ply_element *e, ssfr_ply_put *put, void *user)
{
    ssfr_result result = SSFR_OK;
    ssfr_stream *s = &p->stream;
    const ssfr_ply_property *first = p->properties + e->first;
    const bool ascii = s->encoding == SSFR_ASCII;
    char found[SSFR_FOUND];
    for (size_t i = 0; i < e->n && e->n_properties > 0; i++) {
        if (ascii) s->at += strspn(s->at, " \t\r\n");
        for (const ssfr_ply_property *q = first; q < first + e->n_properties; q++)
            SSFR_TRY(q->list ? read_list(p, e, i, q, put, user) : read_value(p, e, i, q, put, user));
        if (ascii) s->at += strspn(s->at, s->blanks);
        if (ascii && s->at != s->end && *s->at != '\n')
            return fail_body(p, e, i, "after its last property", ssfr_stream_found(s, found));
    }
end:
    return result;
}

ssfr_result ssfr_ply_check_size(const ssfr_ply *p, const ssfr_ply_element *e, const char *kinds)
{
    size_t least = 0; /* bytes an instance */
    for (int i = e->first; i < e->first + e->n_properties; i++) {
        const ssfr_ply_property *q = p->properties + i;
        least += ssfr_stream_value_size(&p->stream, q->list ? q->count_type : q->type);
    }
    if (!ssfr_stream_holds(&p->stream, e->n, least ? least : 1))
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: %zu %s of at least %zu bytes are announced, but %zu bytes follow",
                         p->path, e->n, kinds, least, (size_t)(p->stream.end - p->stream.at));
    return SSFR_OK;
}

ssfr_result ssfr_ply_check_end(ssfr_ply *p)
{
    ssfr_stream *s = &p->stream;
    const char *last = p->elements[p->n_elements - 1].name;
    if (s->encoding == SSFR_ASCII) s->at += strspn(s->at, " \t\r\n");
    if (s->at == s->end) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_FORMAT, "%s: %zu bytes follow the last %s", p->path, (size_t)(s->end - s->at),
                     strcmp(last, "vertex") == 0 ? p->vertex : last);
}

/* In ascii a missing value shows where its line ends. */
ssfr_result ssfr_ply_open(ssfr_ply *p, char **file)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_stream_open(&p->stream, p->path, file));
    SSFR_TRY(read_header(p));
    if (p->stream.encoding == SSFR_ASCII) p->stream.blanks = " \t\r";
end:
    return result;
}

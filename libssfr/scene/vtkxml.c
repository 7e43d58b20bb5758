/* SPDX-License-Identifier: MIT */
/* vtkxml.c: reads particles from VTK's XML files (.vtp and .vtu: points and their data) and writes .vtp.
 *
 * An array's values stand in its element, as text or in base64, or after all elements in AppendedData, raw or in
 * base64, where they are no XML. The text is taken from the file as it stands; expat says where. Binary values follow a
 * header: their size in bytes, or, where they are deflated in blocks, how many blocks there are, the size of one, that
 * of the last unless it is full, and what each is deflated to. */
#include "scene/writer.h"

#include <ctype.h>
#include <expat.h>
#include <strings.h>
#include <zlib.h>

enum { PARSED = 1 << 28 /* bytes, at once */ };

typedef enum format { TEXT, INLINE, APPENDED } format;

enum { OWN_RADIUS = SSFR_N_ARRAYS }; /* the place behind our arrays, of radii that each point has */

/* A DataArray: where its values are. */
typedef struct values {
    const char *name; /* NULL: there is no such array */
    size_t line;
    ssfr_scalar type;
    format format;
    const char *begin, *end; /* of what stands in the element */
    size_t offset;           /* into what is appended */
} values;

typedef struct piece {
    size_t n;
    values points, arrays[OWN_RADIUS + 1];
} piece;

typedef enum section { OTHER, POINTS, POINT_DATA, FIELD_DATA } section;

typedef struct vtkxml {
    ssfr_reading *reading;
    const char *file, *file_end;
    XML_Parser parser;
    ssfr_result result; /* what stopped the parser, unless that was `appended` */
    int depth;          /* of the element here; the outermost is 1 */
    section section;
    values *open;       /* the array whose element is open */
    int open_depth;
    const char *dataset; /* the element that holds the pieces */
    ssfr_scalar header;
    ssfr_encoding byte_order;
    bool deflated, appended_base64;
    const char *appended; /* where what is appended begins; NULL until then */
    size_t n_pieces, room;
    piece *pieces;
    values radius;
} vtkxml;

#define FAIL(x, line, code, format, ...) \
    ssfr_fail((code), "%s:%zu: " format, (x)->reading->path, (size_t)(line), __VA_ARGS__)

/* ---- elements ---------------------------------------------------------------------------------------------------- */

static size_t line_of(const vtkxml *x)
{
    return XML_GetCurrentLineNumber(x->parser);
}

/* The first byte after the tag here. */
static const char *after_tag(const vtkxml *x)
{
    return x->file + XML_GetCurrentByteIndex(x->parser) + XML_GetCurrentByteCount(x->parser);
}

/* An element's attribute, "" when it has none of this name. */
static const char *find(const char **attributes, const char *name)
{
    while (attributes[0] && strcmp(attributes[0], name) != 0) attributes += 2;
    return attributes[0] ? attributes[1] : "";
}

static ssfr_result expected(const vtkxml *x, const char *what, const char *word)
{
    char text[SSFR_FOUND];
    return FAIL(x, line_of(x), SSFR_ERR_FORMAT, "expected %s, found \"%s\"", what, ssfr_printable(word, text));
}

/* <VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="..."> */
static ssfr_result read_root(vtkxml *x, const char *name, const char **attributes)
{
    static const char *const datasets[] = {"PolyData", "UnstructuredGrid"};
    const char *type = find(attributes, "type"), *order = find(attributes, "byte_order");
    const char *header = find(attributes, "header_type"), *compressor = find(attributes, "compressor");
    char text[SSFR_FOUND];
    if (strcmp(name, "VTKFile") != 0) return expected(x, "VTKFile", name);
    for (size_t i = 0; i < SSFR_COUNT(datasets); i++)
        if (strcmp(datasets[i], type) == 0) x->dataset = datasets[i];
    if (!x->dataset)
        return FAIL(x, line_of(x), SSFR_ERR_UNSUPPORTED, "type %s: only PolyData and UnstructuredGrid are read",
                    ssfr_printable(type, text));
    if (*order && strcmp(order, "LittleEndian") != 0 && strcmp(order, "BigEndian") != 0)
        return expected(x, "LittleEndian or BigEndian", order);
    if (*header && strcmp(header, "UInt32") != 0 && strcmp(header, "UInt64") != 0)
        return expected(x, "UInt32 or UInt64", header);
    if (*compressor && strcmp(compressor, "vtkZLibDataCompressor") != 0)
        return FAIL(x, line_of(x), SSFR_ERR_UNSUPPORTED, "compressor %s: only vtkZLibDataCompressor is read",
                    ssfr_printable(compressor, text));
    x->byte_order = strcmp(order, "BigEndian") == 0 ? SSFR_BIG_ENDIAN : SSFR_LITTLE_ENDIAN;
    x->header = strcmp(header, "UInt64") == 0 ? SSFR_UINT64 : SSFR_UINT32;
    x->deflated = *compressor != '\0';
    return SSFR_OK;
}

/* <AppendedData encoding="raw">, blanks, an underscore, and the data: no XML any more. */
static ssfr_result read_appended(vtkxml *x, const char **attributes)
{
    const char *encoding = find(attributes, "encoding"), *at = after_tag(x);
    if (*encoding && strcmp(encoding, "raw") != 0 && strcmp(encoding, "base64") != 0)
        return expected(x, "raw or base64", encoding);
    x->appended_base64 = strcmp(encoding, "raw") != 0;
    while (at < x->file_end && isspace((unsigned char)*at)) at++;
    if (at == x->file_end || *at != '_') return expected(x, "an underscore before the appended data", at);
    x->appended = at + 1;
    XML_StopParser(x->parser, XML_FALSE);
    return SSFR_OK;
}

/* <Piece NumberOfPoints="3"> */
static ssfr_result read_piece(vtkxml *x, const char **attributes)
{
    const char *count = find(attributes, "NumberOfPoints");
    if (x->n_pieces == x->room) {
        const size_t room = x->room ? 2 * x->room : 4;
        piece *more = realloc(x->pieces, room * sizeof *more);
        if (!more) return ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for %zu pieces", x->reading->path, room);
        x->pieces = more;
        x->room = room;
    }
    piece *p = x->pieces + x->n_pieces;
    *p = (piece){0};
    if (!ssfr_parse_count(count, &p->n)) return expected(x, "NumberOfPoints", count);
    x->n_pieces++;
    return SSFR_OK;
}

static bool read_type(const char *word, ssfr_scalar *out)
{
    static const char *const names[] = {"Int8",  "UInt8",  "Int16", "UInt16",  "Int32",
                                        "UInt32", "Int64", "UInt64", "Float32", "Float64"};
    size_t i = 0;
    while (i < SSFR_COUNT(names) && strcmp(names[i], word) != 0) i++;
    if (i < SSFR_COUNT(names)) *out = (ssfr_scalar)i;
    return i < SSFR_COUNT(names);
}

static ssfr_result open_array(vtkxml *x, values *v, const char *name, const char **attributes)
{
    static const char *const formats[] = {"ascii", "binary", "appended"};
    const char *word = find(attributes, "format"), *offset = find(attributes, "offset");
    size_t f = 0;
    while (*word && f < SSFR_COUNT(formats) && strcmp(formats[f], word) != 0) f++;
    if (f == SSFR_COUNT(formats)) return expected(x, "ascii, binary or appended", word);
    v->format = (format)f;
    if (v->format == APPENDED && !ssfr_parse_count(offset, &v->offset)) return expected(x, "an offset", offset);
    v->name = name;
    v->line = line_of(x);
    v->begin = after_tag(x);
    x->open = v;
    x->open_depth = x->depth;
    return SSFR_OK;
}

/* Where the values of an array of this name are told; NULL when they are not read. */
static values *find_values(vtkxml *x, const ssfr_array *array, const char *name)
{
    piece *p = x->n_pieces > 0 ? x->pieces + x->n_pieces - 1 : NULL;
    const bool radius = strcasecmp(name, "radius") == 0;
    if (x->section == FIELD_DATA && radius) return &x->radius;
    if (x->section == POINTS && p) return &p->points;
    if (x->section == POINT_DATA && p && radius) return p->arrays + OWN_RADIUS;
    return x->section == POINT_DATA && p && array ? p->arrays + (array - ssfr_arrays) : NULL;
}

/* <DataArray type="Float32" Name="velocity" NumberOfComponents="3" format="appended" offset="0"> */
static ssfr_result read_array(vtkxml *x, const char **attributes)
{
    const char *name = find(attributes, "Name"), *components = find(attributes, "NumberOfComponents");
    const char *type = find(attributes, "type");
    const ssfr_array *array = x->section == POINT_DATA ? ssfr_array_find(name) : NULL;
    values *v = find_values(x, array, name);
    size_t n = 1;
    if (!v && x->section == POINT_DATA && x->n_pieces == 1) ssfr_reading_skip(x->reading, name);
    if (!v) return SSFR_OK;
    const size_t count = array ? array->count : x->section == POINTS ? 3 : 1;
    if (*components && !ssfr_parse_count(components, &n)) return expected(x, "NumberOfComponents", components);
    const char *known = array ? array->name : x->section == POINTS ? "Points" : "radius";
    if (n == count && !v->name && read_type(type, &v->type)) return open_array(x, v, known, attributes);
    if (x->section == POINTS)
        return FAIL(x, line_of(x), SSFR_ERR_FORMAT, "expected one array %s of numbers, %zu a point", known, count);
    ssfr_log(SSFR_WARNING, "%s:%zu: %s skipped: expected one array of numbers, %zu a point", x->reading->path,
             line_of(x), known, count);
    return SSFR_OK;
}

/* The section that an element begins, OTHER when it begins none. */
static section section_of(const char *name)
{
    static const struct {
        const char *name;
        section section;
    } sections[] = {{"Points", POINTS}, {"PointData", POINT_DATA}, {"FieldData", FIELD_DATA}};
    section found = OTHER;
    for (size_t i = 0; i < SSFR_COUNT(sections); i++)
        if (strcmp(sections[i].name, name) == 0) found = sections[i].section;
    return found;
}

static ssfr_result read_element(vtkxml *x, const char *name, const char **attributes)
{
    if (x->depth == 1) return read_root(x, name, attributes);
    if (x->depth == 2 && strcmp(name, "AppendedData") == 0) return read_appended(x, attributes);
    if (x->depth == 2 && strcmp(name, x->dataset) != 0) return expected(x, x->dataset, name);
    if (x->depth == 3 && strcmp(name, "Piece") == 0) return read_piece(x, attributes);
    if (x->depth > 3 && strcmp(name, "DataArray") == 0) return read_array(x, attributes);
    if (section_of(name) != OTHER) x->section = section_of(name);
    return SSFR_OK;
}

/* ---- what expat calls -------------------------------------------------------------------------------------------- */

static void stop(vtkxml *x, ssfr_result result)
{
    x->result = result;
    if (result != SSFR_OK) XML_StopParser(x->parser, XML_FALSE);
}

static bool is_blank(const char *begin, const char *end)
{
    while (begin < end && isspace((unsigned char)*begin)) begin++;
    return begin >= end;
}

/* Before the tag here: the end of an array's text, unless that was only the space before an element in it. */
static void close_text(vtkxml *x)
{
    values *v = x->open;
    const char *here = x->file + XML_GetCurrentByteIndex(x->parser);
    if (!v->end && !is_blank(v->begin, here)) v->end = here;
}

static void XMLCALL on_start(void *user, const char *name, const char **attributes)
{
    vtkxml *x = user;
    if (x->result != SSFR_OK || x->appended) return;
    x->depth++;
    if (x->open)
        close_text(x);
    else
        stop(x, read_element(x, name, attributes));
}

static void XMLCALL on_end(void *user, const char *name)
{
    vtkxml *x = user;
    if (x->result != SSFR_OK || x->appended) return;
    if (x->open && x->depth > x->open_depth) {
        if (!x->open->end) x->open->begin = after_tag(x);
    } else if (x->open) {
        close_text(x);
        if (!x->open->end) x->open->end = x->open->begin;
        x->open = NULL;
    } else if (section_of(name) != OTHER) {
        x->section = OTHER;
    }
    x->depth--;
}

/* Entities could make much out of little. */
static void XMLCALL on_doctype(void *user, const char *name, const char *system, const char *public, int internal)
{
    vtkxml *x = user;
    (void)name, (void)system, (void)public, (void)internal;
    stop(x, FAIL(x, line_of(x), SSFR_ERR_UNSUPPORTED, "%s", "a document type"));
}

static ssfr_result parse(vtkxml *x)
{
    enum XML_Status status = XML_STATUS_OK;
    x->parser = XML_ParserCreate(NULL);
    if (!x->parser) return ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory to parse it", x->reading->path);
    XML_SetUserData(x->parser, x);
    XML_SetElementHandler(x->parser, on_start, on_end);
    XML_SetStartDoctypeDeclHandler(x->parser, on_doctype);
    const char *at = x->file;
    for (bool last = false; !last && status == XML_STATUS_OK;) {
        const size_t left = (size_t)(x->file_end - at), part = left < PARSED ? left : PARSED;
        last = part == left;
        status = XML_Parse(x->parser, at, (int)part, last);
        at += part;
    }
    if (x->result != SSFR_OK || x->appended || status == XML_STATUS_OK) return x->result;
    const enum XML_Error error = XML_GetErrorCode(x->parser);
    return FAIL(x, line_of(x), error == XML_ERROR_NO_MEMORY ? SSFR_ERR_MEMORY : SSFR_ERR_FORMAT, "%s",
                XML_ErrorString(error));
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

/* Bytes, raw or in base64, of which groups padded with '=' may stand one after the other. */
typedef struct source {
    const char *at, *end;
    bool base64;
    unsigned char held[3];
    int n_held, next; /* of them, and the one to give */
} source;

static int digit(char c)
{
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* The next four letters of base64, which make one to three bytes. */
static bool take_group(source *s)
{
    uint32_t bits = 0;
    int n = 0, padding = 0;
    for (; n < 4 && s->at < s->end; s->at++) {
        if (isspace((unsigned char)*s->at)) continue;
        const int d = *s->at == '=' && n >= 2 ? 0 : digit(*s->at);
        if (d < 0 || (padding > 0 && *s->at != '=')) return false;
        padding += *s->at == '=';
        bits = bits << 6 | (uint32_t)d;
        n++;
    }
    for (int k = 0; k < 3; k++) s->held[k] = (unsigned char)(bits >> (16 - 8 * k));
    s->n_held = 3 - padding;
    s->next = 0;
    return n == 4;
}

static bool take(source *s, void *out, size_t n)
{
    unsigned char *bytes = out;
    if (!s->base64) {
        if ((size_t)(s->end - s->at) < n) return false;
        memcpy(bytes, s->at, n);
        s->at += n;
        return true;
    }
    for (size_t i = 0; i < n; i++) {
        if (s->next == s->n_held && !take_group(s)) return false;
        bytes[i] = s->held[s->next++];
    }
    return true;
}

/* The most bytes that may follow. */
static size_t most_left(const source *s)
{
    const size_t left = (size_t)(s->end - s->at);
    return s->base64 ? left / 4 * 3 + 3 : left;
}

/* A number of the header. */
static bool take_count(const vtkxml *x, source *s, size_t *out)
{
    char bytes[8];
    const size_t size = ssfr_scalar_size(x->header);
    const bool ok = take(s, bytes, size);
    uint64_t count = 0;
    for (size_t i = 0; i < size; i++) {
        const size_t k = x->byte_order == SSFR_BIG_ENDIAN ? i : size - 1 - i;
        count = count << 8 | (unsigned char)bytes[k];
    }
    *out = ok ? (size_t)count : 0;
    return ok;
}

static ssfr_result fail_values(const vtkxml *x, const values *v, size_t n, const char *why)
{
    return FAIL(x, v->line, SSFR_ERR_FORMAT, "%s: expected %zu values: %s", v->name, n, why);
}

/* How deflated values are cut: n blocks of `size` bytes, but for the last; each has been deflated to sizes[i]. */
typedef struct blocks {
    size_t n, size, last; /* last: 0 when it is full */
    size_t most;          /* of the sizes */
    size_t *sizes;
} blocks;

/* Reads the header and holds it against the `total` bytes wanted, and against what the file has. */
static ssfr_result read_blocks(const vtkxml *x, source *s, const values *v, size_t n, size_t total, blocks *b)
{
    ssfr_result result = SSFR_OK;
    size_t sum = 0;
    if (!take_count(x, s, &b->n) || !take_count(x, s, &b->size) || !take_count(x, s, &b->last))
        return fail_values(x, v, n, "the data end");
    const size_t full = b->n - (b->last > 0 && b->n > 0), rest = total - (b->last < total ? b->last : total);
    if (b->n == 0 || b->n > most_left(s) / ssfr_scalar_size(x->header) || (full > 0 && b->size > rest / full) ||
        full * b->size + b->last != total)
        return fail_values(x, v, n, "the deflated blocks have another size");
    SSFR_TRY(ssfr_alloc(&b->sizes, b->n, sizeof *b->sizes, "sizes of blocks"));
    for (size_t i = 0; i < b->n; i++) {
        if (!take_count(x, s, b->sizes + i) || b->sizes[i] > most_left(s) - sum)
            return fail_values(x, v, n, "the data end");
        sum += b->sizes[i];
        if (b->sizes[i] > b->most) b->most = b->sizes[i];
    }
    if (total / SSFR_DEFLATE_MOST > sum) result = fail_values(x, v, n, "no deflated data make so many");
end:
    return result;
}

static ssfr_result inflate_blocks(const vtkxml *x, source *s, const values *v, size_t n, const blocks *b, char *out)
{
    ssfr_result result = SSFR_OK;
    char *deflated = NULL;
    SSFR_TRY(ssfr_alloc(&deflated, b->most, 1, "deflated values"));
    for (size_t i = 0; i < b->n; i++) {
        const size_t wanted = b->last > 0 && i + 1 == b->n ? b->last : b->size;
        uLongf size = wanted;
        if (!take(s, deflated, b->sizes[i])) {
            result = fail_values(x, v, n, "the data end");
            goto end;
        }
        if (uncompress((Bytef *)out, &size, (const Bytef *)deflated, b->sizes[i]) != Z_OK || size != wanted) {
            result = fail_values(x, v, n, "the deflated data are damaged");
            goto end;
        }
        out += wanted;
    }
end:
    free(deflated);
    return result;
}

/* The bytes of n binary values, to free(). */
static ssfr_result read_bytes(const vtkxml *x, source *s, const values *v, size_t n, char **out)
{
    ssfr_result result = SSFR_OK;
    blocks b = {0};
    const size_t total = n * ssfr_scalar_size(v->type);
    size_t size = 0;
    *out = NULL;
    if (x->deflated) {
        SSFR_TRY(read_blocks(x, s, v, n, total, &b));
    } else {
        const bool ended = !take_count(x, s, &size) || (size == total && total > most_left(s));
        if (ended || size != total) {
            result = fail_values(x, v, n, ended ? "the data end" : "there is another number of bytes");
            goto end;
        }
    }
    SSFR_TRY(ssfr_alloc(out, total, 1, v->name));
    if (x->deflated)
        SSFR_TRY(inflate_blocks(x, s, v, n, &b, *out));
    else if (!take(s, *out, total))
        result = fail_values(x, v, n, "the data end");
end:
    free(b.sizes);
    return result;
}

/* A stream of an array's n values; the bytes behind it are to free(). */
static ssfr_result open_values(const vtkxml *x, const values *v, size_t n, ssfr_stream *out, char **bytes)
{
    ssfr_result result = SSFR_OK;
    const bool appended = v->format == APPENDED;
    const char *begin = appended ? x->appended : v->begin;
    source s = {.at = begin, .end = appended ? x->file_end : v->end, .base64 = !appended || x->appended_base64};
    *out = (ssfr_stream){v->begin, v->end, SSFR_ASCII, " \t\r\n\v\f"};
    *bytes = NULL;
    if (v->format == TEXT) return SSFR_OK;
    if (appended && (!begin || v->offset > (size_t)(s.end - begin)))
        return fail_values(x, v, n, "its offset is beyond the appended data");
    s.at += v->offset;
    SSFR_TRY(read_bytes(x, &s, v, n, bytes));
    *out = (ssfr_stream){*bytes, *bytes + n * ssfr_scalar_size(v->type), x->byte_order, ""};
end:
    return result;
}

/* ---- the file's pieces, one after the other ---------------------------------------------------------------------- */

/* Puts the values of the piece whose particles begin at `first`. */
static ssfr_result put_values(const vtkxml *x, const values *v, const ssfr_target *target, size_t first, size_t n)
{
    ssfr_result result = SSFR_OK;
    ssfr_stream s;
    char *bytes = NULL, found[SSFR_FOUND];
    const size_t count = n * target->count;
    SSFR_TRY(open_values(x, v, count, &s, &bytes));
    for (size_t k = 0; k < count; k++) {
        double value = 0;
        if (!ssfr_stream_next(&s, v->type, &value)) {
            result = FAIL(x, v->line, SSFR_ERR_FORMAT, "%s: expected %zu values, there are %zu, then %s", v->name,
                          count, k, is_blank(s.at, s.end) ? "none" : ssfr_stream_found(&s, found));
            goto end;
        }
        SSFR_TRY(ssfr_target_put(x->reading, target, target->count * first + k, value));
    }
end:
    free(bytes);
    return result;
}

static ssfr_result put_points(const vtkxml *x)
{
    ssfr_result result = SSFR_OK;
    const ssfr_target positions = ssfr_target_positions(x->reading);
    size_t first = 0;
    for (const piece *p = x->pieces; p < x->pieces + x->n_pieces; first += p->n, p++) {
        if (p->n > 0 && !p->points.name) {
            result = ssfr_fail(SSFR_ERR_FORMAT, "%s: a Piece of %zu points has no Points", x->reading->path, p->n);
            goto end;
        }
        if (p->n > 0) SSFR_TRY(put_values(x, &p->points, &positions, first, p->n));
    }
end:
    return result;
}

/* An array must be in each piece that has points. */
static ssfr_result put_array(const vtkxml *x, size_t a)
{
    ssfr_result result = SSFR_OK;
    ssfr_target target;
    size_t first = 0, n_with = 0, n_without = 0;
    for (const piece *p = x->pieces; p < x->pieces + x->n_pieces; p++)
        if (p->arrays[a].name)
            n_with++;
        else
            n_without += p->n > 0;
    if (n_with == 0) return SSFR_OK;
    if (n_without > 0) {
        ssfr_log(SSFR_WARNING, "%s: %s skipped: not every Piece has it", x->reading->path,
                 a == OWN_RADIUS ? "radius" : ssfr_arrays[a].name);
        return SSFR_OK;
    }
    if (a == OWN_RADIUS)
        target = ssfr_target_radii(x->reading);
    else
        SSFR_TRY(ssfr_target_array(x->reading, ssfr_arrays + a, &target));
    for (const piece *p = x->pieces; p < x->pieces + x->n_pieces; first += p->n, p++)
        if (p->n > 0) SSFR_TRY(put_values(x, p->arrays + a, &target, first, p->n));
end:
    return result;
}

static ssfr_result put_radius(const vtkxml *x)
{
    ssfr_result result = SSFR_OK;
    ssfr_stream s;
    char *bytes = NULL;
    if (!x->radius.name) return SSFR_OK;
    SSFR_TRY(open_values(x, &x->radius, 1, &s, &bytes));
    if (!ssfr_stream_next(&s, x->radius.type, &x->reading->given.radius))
        result = fail_values(x, &x->radius, 1, "there is none");
end:
    free(bytes);
    return result;
}

/* Room for the points of all pieces. A coordinate has at least a byte, or is deflated. */
static ssfr_result begin_reading(const vtkxml *x)
{
    const size_t size = (size_t)(x->file_end - x->file), most = size * (x->deflated ? SSFR_DEFLATE_MOST : 1) / 3;
    size_t n = 0;
    if (x->n_pieces == 0) return ssfr_fail(SSFR_ERR_FORMAT, "%s: there is no Piece", x->reading->path);
    for (const piece *p = x->pieces; p < x->pieces + x->n_pieces; n += p->n, p++)
        if (p->n > most - n)
            return ssfr_fail(SSFR_ERR_FORMAT, "%s: Pieces of %zu points and more do not fit into a file of %zu bytes",
                             x->reading->path, p->n, size);
    return ssfr_reading_begin(x->reading, n);
}

ssfr_result ssfr_vtkxml_read(ssfr_reading *reading)
{
    ssfr_result result = SSFR_OK;
    ssfr_stream stream;
    char *file = NULL;
    vtkxml x = {.reading = reading};
    SSFR_TRY(ssfr_stream_open(&stream, reading->path, &file));
    x.file = stream.at;
    x.file_end = stream.end;
    SSFR_TRY(parse(&x));
    SSFR_TRY(begin_reading(&x));
    SSFR_TRY(put_points(&x));
    SSFR_TRY(put_radius(&x));
    for (size_t a = 0; a <= OWN_RADIUS; a++) SSFR_TRY(put_array(&x, a));
    ssfr_reading_end(reading, reading->given.n);
end:
    if (x.parser) XML_ParserFree(x.parser);
    free(x.pieces);
    free(file);
    return result;
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

/* An array's element; *offset goes on by what is appended: a header and so many bytes. */
static void write_element(ssfr_sink *sink, const char *type, const char *name, size_t count, size_t bytes,
                          size_t *offset)
{
    ssfr_sink_text(sink, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%zu\" format=\"appended\" "
                         "offset=\"%zu\"/>\n", type, name, count, *offset);
    *offset += sizeof(uint64_t) + bytes;
}

/* Eight bytes of the file's order, which is little-endian. */
static void write_whole(ssfr_sink *sink, uint64_t value)
{
    ssfr_sink_bits32(sink, (uint32_t)value);
    ssfr_sink_bits32(sink, (uint32_t)(value >> 32));
}

/* A vertex for each point: without them nothing is drawn. */
static void write_elements(ssfr_sink *sink, const ssfr_particles *set, bool as_double)
{
    size_t offset = 0;
    ssfr_sink_text(sink, "<Points>\n");
    write_element(sink, as_double ? "Float64" : "Float32", "Points", 3, set->n * (as_double ? 24 : 12), &offset);
    ssfr_sink_text(sink, "</Points>\n<Verts>\n");
    write_element(sink, "Int64", "connectivity", 1, set->n * sizeof(int64_t), &offset);
    write_element(sink, "Int64", "offsets", 1, set->n * sizeof(int64_t), &offset);
    ssfr_sink_text(sink, "</Verts>\n<PointData>\n");
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++)
        if (ssfr_array_get(set, a))
            write_element(sink, a->real ? "Float32" : "UInt32", a->name, a->count, set->n * a->count * SSFR_ARRAY_VALUE,
                          &offset);
    ssfr_sink_text(sink, "</PointData>\n");
}

/* In the order of the elements. */
static void write_appended(ssfr_sink *sink, const ssfr_particles *set, bool as_double)
{
    write_whole(sink, set->n * (as_double ? 24 : 12));
    for (size_t i = 0; i < set->n; i++) ssfr_sink_position(sink, set, i, as_double);
    for (uint64_t first = 0; first < 2; first++) {
        write_whole(sink, set->n * sizeof(int64_t));
        for (uint64_t i = 0; i < set->n; i++) write_whole(sink, first + i);
    }
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++) {
        if (!ssfr_array_get(set, a)) continue;
        write_whole(sink, set->n * a->count * SSFR_ARRAY_VALUE);
        for (size_t i = 0; i < set->n; i++) ssfr_sink_values(sink, set, a, i);
    }
}

ssfr_result ssfr_vtp_write(const ssfr_particles *set, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_sink sink;
    const bool as_double = !ssfr_floats_suffice(set); /* floats would lose digits */
    SSFR_TRY(ssfr_sink_begin(&sink, path, SSFR_LITTLE_ENDIAN));
    ssfr_sink_text(&sink, "<?xml version=\"1.0\"?>\n<!-- particles: metres, seconds, kilograms -->\n"
                          "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                          "header_type=\"UInt64\">\n<PolyData>\n");
    if (set->radius > 0)
        ssfr_sink_text(&sink, "<FieldData>\n<DataArray type=\"Float64\" Name=\"radius\" NumberOfTuples=\"1\" "
                              "format=\"ascii\">%.17g</DataArray>\n</FieldData>\n", set->radius);
    ssfr_sink_text(&sink, "<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\" NumberOfLines=\"0\" "
                          "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n", set->n, set->n);
    write_elements(&sink, set, as_double);
    ssfr_sink_text(&sink, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
    write_appended(&sink, set, as_double);
    ssfr_sink_text(&sink, "\n</AppendedData>\n</VTKFile>\n");
end:
    return ssfr_sink_end(&sink, result);
}

/* SPDX-License-Identifier: MIT */
/* obj.c: reads the polygons of Wavefront OBJ files: the lines v and f; texture, normals, groups and materials are not
 * looked at. */
#include "scene/soup.h"

typedef struct obj {
    ssfr_soup *soup;
    ssfr_stream stream;
    size_t line; /* from 1 */
    uint32_t corners[SSFR_SOUP_CORNERS];
} obj;

static ssfr_result fail(const obj *o, const char *expected)
{
    char found[SSFR_FOUND];
    return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: expected %s, %s", o->soup->path, o->line, expected,
                     ssfr_stream_found(&o->stream, found));
}

/* x y z, and perhaps a weight or a colour after them. */
static ssfr_result read_vertex(obj *o)
{
    double at[3];
    for (int k = 0; k < 3; k++)
        if (!ssfr_stream_next(&o->stream, SSFR_FLOAT64, &at[k])) return fail(o, "three coordinates");
    if (o->soup->n_vertices == UINT32_MAX)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s:%zu: more than %u vertices", o->soup->path, o->line, UINT32_MAX);
    return ssfr_soup_vertex(o->soup, at);
}

/* "7", "7/1", "7//3" or "7/1/3", counted from 1, or from the last vertex as -1. */
static ssfr_result read_corner(obj *o, uint32_t *out)
{
    char *end = NULL;
    const long long n = (long long)o->soup->n_vertices, index = strtoll(o->stream.at, &end, 10);
    if (end == o->stream.at || !strchr("/ \t\r\n", *end)) return fail(o, "a vertex's index");
    if (index == 0 || index > n || index < -n)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: vertex %lld of the %lld that there are so far", o->soup->path,
                         o->line, index, n);
    *out = (uint32_t)(index > 0 ? index - 1 : n + index);
    o->stream.at = end + strcspn(end, " \t\r\n");
    return SSFR_OK;
}

static ssfr_result read_face(obj *o)
{
    ssfr_result result = SSFR_OK;
    int n = 0;
    for (;;) {
        o->stream.at += strspn(o->stream.at, o->stream.blanks);
        if (o->stream.at == o->stream.end || *o->stream.at == '\n' || *o->stream.at == '#') break;
        if (n == SSFR_SOUP_CORNERS)
            return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s:%zu: a polygon of more than %d corners", o->soup->path, o->line,
                             SSFR_SOUP_CORNERS);
        SSFR_TRY(read_corner(o, &o->corners[n++]));
    }
    if (n < 3) return fail(o, "at least three corners");
    SSFR_TRY(ssfr_soup_polygon(o->soup, n, o->corners));
end:
    return result;
}

/* Lines of other words hold no polygons, but for those of curved surfaces. */
static ssfr_result read_line(obj *o)
{
    static const char *const curved[] = {"cstype", "curv", "curv2", "surf"};
    const char *word = o->stream.at += strspn(o->stream.at, o->stream.blanks);
    const size_t length = strcspn(word, " \t\r\n");
    for (size_t i = 0; i < SSFR_COUNT(curved); i++)
        if (strlen(curved[i]) == length && memcmp(word, curved[i], length) == 0)
            return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s:%zu: %s: only polygons are read", o->soup->path, o->line,
                             curved[i]);
    o->stream.at += length;
    if (length == 1 && *word == 'v') return read_vertex(o);
    if (length == 1 && *word == 'f') return read_face(o);
    return SSFR_OK;
}

ssfr_result ssfr_obj_read(ssfr_soup *soup)
{
    ssfr_result result = SSFR_OK;
    char *file = NULL;
    obj *o = NULL;
    SSFR_TRY(ssfr_alloc(&o, 1, sizeof *o, "a reader"));
    o->soup = soup;
    SSFR_TRY(ssfr_stream_open(&o->stream, soup->path, &file));
    o->stream.encoding = SSFR_ASCII, o->stream.blanks = " \t\r";
    for (; o->stream.at < o->stream.end; o->stream.at += o->stream.at < o->stream.end) {
        o->line++;
        SSFR_TRY(read_line(o));
        const char *end = memchr(o->stream.at, '\n', (size_t)(o->stream.end - o->stream.at));
        o->stream.at = end ? end : o->stream.end;
    }
end:
    free(file), free(o);
    return result;
}

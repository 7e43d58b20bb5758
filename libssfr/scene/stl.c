/* SPDX-License-Identifier: MIT */
/* stl.c: reads the triangles of STL files, ascii and binary. */
#include "scene/soup.h"

enum { HEADER = 80, TRIANGLE = 50 }; /* bytes; a triangle has a normal, three corners and two spare bytes */

static ssfr_result put_corner(ssfr_soup *soup, const double at[3])
{
    ssfr_result result = SSFR_OK;
    const size_t n = soup->n_vertices + 1;
    if (n > UINT32_MAX) return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: too many triangles", soup->path);
    SSFR_TRY(ssfr_soup_vertex(soup, at));
    if (n % 3 == 0) {
        const uint32_t corners[3] = {(uint32_t)n - 3, (uint32_t)n - 2, (uint32_t)n - 1};
        SSFR_TRY(ssfr_soup_polygon(soup, 3, corners));
    }
end:
    return result;
}

/* ---- binary ------------------------------------------------------------------------------------------------------ */

/* The count that a binary file of this size would announce. */
static bool is_binary(const ssfr_stream *stream, size_t *n)
{
    ssfr_stream s = *stream;
    double count = 0;
    const size_t size = (size_t)(s.end - s.at);
    if (size < HEADER) return false;
    s.at += HEADER;
    if (!ssfr_stream_next(&s, SSFR_UINT32, &count)) return false;
    *n = (size_t)count;
    return size == HEADER + 4 + *n * TRIANGLE;
}

/* The corners' order tells the side; the normals, which many programs leave out, are not looked at. */
static ssfr_result read_binary(ssfr_soup *soup, ssfr_stream *s, size_t n)
{
    ssfr_result result = SSFR_OK;
    s->at += HEADER + 4;
    for (size_t i = 0; i < n; i++, s->at += 2) {
        double values[12] = {0};
        for (int k = 0; k < 12; k++)
            if (!ssfr_stream_next(s, SSFR_FLOAT32, &values[k]))
                return ssfr_fail(SSFR_ERR_FORMAT, "%s: triangle %zu (from 0): the file ends", soup->path, i);
        for (int k = 1; k < 4; k++) SSFR_TRY(put_corner(soup, values + 3 * k));
    }
end:
    return result;
}

/* ---- ascii ------------------------------------------------------------------------------------------------------- */

static size_t line_of(const char *file, const char *at)
{
    size_t line = 1;
    for (const char *p = file; p < at; p++) line += *p == '\n';
    return line;
}

static ssfr_result fail(const ssfr_soup *soup, const ssfr_stream *s, const char *file, const char *expected)
{
    char found[SSFR_FOUND];
    return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: expected %s, %s", soup->path,
                     line_of(file, s->at + strspn(s->at, s->blanks)), expected, ssfr_stream_found(s, found));
}

/* Takes the words, which a blank parts, when they come next. */
static bool take(ssfr_stream *s, const char *words)
{
    const char *at = s->at;
    for (const char *word = words; *word; word += strspn(word, " ")) {
        const size_t length = strcspn(word, " ");
        at += strspn(at, s->blanks);
        if (strncmp(at, word, length) != 0 || !strchr(" \t\r\n\v\f", at[length])) return false;
        at += length, word += length;
    }
    s->at = at;
    return true;
}

static bool take_numbers(ssfr_stream *s, double v[3])
{
    bool ok = true;
    for (int k = 0; k < 3 && ok; k++) ok = ssfr_stream_next(s, SSFR_FLOAT32, &v[k]);
    return ok;
}

static ssfr_result read_facet(ssfr_soup *soup, ssfr_stream *s, const char *file)
{
    ssfr_result result = SSFR_OK;
    double v[3];
    if (!take(s, "normal") || !take_numbers(s, v)) return fail(soup, s, file, "normal and three numbers");
    if (!take(s, "outer loop")) return fail(soup, s, file, "outer loop");
    for (int k = 0; k < 3; k++) {
        if (!take(s, "vertex") || !take_numbers(s, v)) return fail(soup, s, file, "vertex and three numbers");
        SSFR_TRY(put_corner(soup, v));
    }
    if (!take(s, "endloop")) return fail(soup, s, file, "endloop: facets have three corners");
    if (!take(s, "endfacet")) return fail(soup, s, file, "endfacet");
end:
    return result;
}

/* "solid NAME", facets, "endsolid NAME"; there may be several. */
static ssfr_result read_ascii(ssfr_soup *soup, ssfr_stream *s, const char *file)
{
    ssfr_result result = SSFR_OK;
    s->encoding = SSFR_ASCII;
    while (take(s, "solid")) {
        s->at += strcspn(s->at, "\n");
        while (take(s, "facet")) SSFR_TRY(read_facet(soup, s, file));
        if (!take(s, "endsolid")) return fail(soup, s, file, "facet or endsolid");
        s->at += strcspn(s->at, "\n");
    }
    s->at += strspn(s->at, s->blanks);
    if (s->at != s->end) return fail(soup, s, file, "solid");
end:
    return result;
}

ssfr_result ssfr_stl_read(ssfr_soup *soup)
{
    ssfr_result result = SSFR_OK;
    char *file = NULL;
    ssfr_stream s;
    size_t n = 0;
    SSFR_TRY(ssfr_stream_open(&s, soup->path, &file));
    if (is_binary(&s, &n)) /* also where the header begins with "solid" */
        result = read_binary(soup, &s, n);
    else if (strncmp(s.at, "solid", 5) == 0)
        result = read_ascii(soup, &s, file);
    else if (s.end - s.at >= HEADER + 4)
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: %zu triangles of %d bytes are announced, but %zu bytes follow",
                           soup->path, n, TRIANGLE, (size_t)(s.end - s.at) - HEADER - 4);
    else
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: neither solid nor a header of %d bytes", soup->path, HEADER);
end:
    free(file);
    return result;
}

/* SPDX-License-Identifier: MIT */
/* xyz.c: reads and writes .xyz particles: a line of x y z each.
 *
 * Read are bare lines, after lines of # or //, and the form of chemistry: a count, a comment, then lines of a word and
 * x y z, or of the columns that Properties=species:S:1:pos:R:3:velo:R:3 in the comment says. Other columns are skipped.
 * Written are bare lines, which MeshLab, CloudCompare and Open3D read; no particles at all are a count of 0. */
#include "scene/sheet.h"
#include "scene/writer.h"

#include <ctype.h>

typedef struct xyz {
    ssfr_rows rows;
    ssfr_sheet sheet;
    bool counted;
    size_t n; /* that were announced, or that the file can hold */
} xyz;

static bool is_comment(const char *line)
{
    return line[0] == '#' || (line[0] == '/' && line[1] == '/');
}

/* A line with one whole number on it is a count. */
static bool read_count(xyz *x)
{
    const char *at = x->rows.at;
    char digits[24];
    const size_t n = strspn(at, "0123456789");
    if (n == 0 || n >= sizeof digits) return false;
    memcpy(digits, at, n);
    digits[n] = '\0';
    ssfr_rows after = {.at = at + n, .end = x->rows.end, .separator = ' '};
    ssfr_rows_skip_blanks(&after);
    return ssfr_rows_at_line_end(&after) && ssfr_parse_count(digits, &x->n);
}

/* One name:type:count of Properties. Types S and L are no numbers. */
static ssfr_result add_property(xyz *x, const char *name, const char *type, const char *count)
{
    ssfr_result result = SSFR_OK;
    size_t n = 0;
    char text[SSFR_FOUND];
    if (!type || !count || !type[0] || !strchr("RISL", type[0]) || type[1] || !ssfr_parse_count(count, &n))
        return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: Properties: expected name:type:count, found \"%s\"", x->rows.path,
                         x->rows.line - 1, ssfr_printable(name, text));
    const int place = ssfr_place_find(name);
    const bool number = strchr("RI", type[0]), whole = place != SSFR_PLACE_NONE && ssfr_place_count(place) == n;
    for (size_t k = 0; k < n; k++) {
        ssfr_sheet_column column = whole ? (ssfr_sheet_column){place, k} : ssfr_sheet_column_find(n == 1 ? name : "");
        if (!number) column.place = SSFR_PLACE_NONE;
        SSFR_TRY(ssfr_sheet_add(&x->sheet, x->rows.path, name, column));
        SSFR_TRY(ssfr_rows_add(&x->rows, column, name));
    }
end:
    return result;
}

/* The comment's Properties, if it has them. Their text is taken apart in its place, so the line is passed first. */
static ssfr_result read_comment(xyz *x)
{
    static const char key[] = "Properties=";
    ssfr_result result = SSFR_OK;
    char *at = (char *)x->rows.at, *rest = NULL;
    ssfr_rows_skip_line(&x->rows);
    const char *end = x->rows.at;
    while (at + sizeof key <= end && memcmp(at, key, sizeof key - 1) != 0) at++;
    if (at + sizeof key > end) return SSFR_OK;
    at += sizeof key - 1;
    at += *at == '"';
    at[strcspn(at, "\" \t\r\n")] = '\0';
    for (char *name = strtok_r(at, ":", &rest); name; name = strtok_r(NULL, ":", &rest)) {
        const char *type = strtok_r(NULL, ":", &rest), *count = type ? strtok_r(NULL, ":", &rest) : NULL;
        SSFR_TRY(add_property(x, name, type, count));
    }
end:
    return result;
}

static size_t count_cells(const ssfr_rows *rows)
{
    ssfr_rows ahead = {.at = rows->at, .end = rows->end, .separator = ' '};
    size_t n = 0;
    for (ssfr_rows_skip_blanks(&ahead); !ssfr_rows_at_line_end(&ahead); ssfr_rows_skip_blanks(&ahead), n++)
        ssfr_rows_skip_cell(&ahead);
    return n;
}

/* The columns of the line here: x y z first, or after a word, which after a count may be a number too. */
static ssfr_result guess_columns(xyz *x)
{
    ssfr_result result = SSFR_OK;
    ssfr_rows *r = &x->rows;
    char *end = NULL;
    const size_t n = r->at < r->end ? count_cells(r) : 3;
    const bool number = r->at == r->end || (strtod(r->at, &end), end != r->at && isspace((unsigned char)*end));
    const size_t first = !number || (x->counted && n > 3);
    for (size_t k = 0; k < n; k++) {
        const bool known = k >= first && k < first + 3;
        char name[32];
        snprintf(name, sizeof name, "column_%zu", k + 1);
        const ssfr_sheet_column column = {known ? SSFR_PLACE_POSITION : SSFR_PLACE_NONE, known ? k - first : 0};
        SSFR_TRY(ssfr_sheet_add(&x->sheet, r->path, name, column));
        SSFR_TRY(ssfr_rows_add(r, column, known ? "position" : ""));
    }
end:
    return result;
}

/* All up to the first particle. */
static ssfr_result read_head(xyz *x)
{
    ssfr_result result = SSFR_OK;
    ssfr_rows *r = &x->rows;
    while (ssfr_rows_more(r) && is_comment(r->at)) ssfr_rows_skip_line(r);
    if (r->at == r->end) return ssfr_fail(SSFR_ERR_FORMAT, "%s: there are no particles, nor a count of 0", r->path);
    x->counted = read_count(x);
    if (x->counted) {
        ssfr_rows_skip_line(r);
        SSFR_TRY(read_comment(x));
        ssfr_rows_more(r);
    }
    if (r->n_columns == 0) SSFR_TRY(guess_columns(x));
    if (!x->counted) x->n = ssfr_rows_most(r);
    if (x->n > ssfr_rows_most(r))
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: %zu particles are announced, but %zu bytes follow", r->path, x->n,
                         (size_t)(r->end - r->at));
    SSFR_TRY(ssfr_sheet_begin(&x->sheet, r->path, x->n));
end:
    return result;
}

ssfr_result ssfr_xyz_read(ssfr_reading *reading)
{
    ssfr_result result = SSFR_OK;
    char *file = NULL;
    size_t n = 0;
    ssfr_stream stream;
    xyz x = {.rows = {.path = reading->path, .line = 1, .separator = ' '}, .sheet = {.reading = reading}};
    SSFR_TRY(ssfr_stream_open(&stream, reading->path, &file));
    x.rows.at = stream.at;
    x.rows.end = stream.end;
    SSFR_TRY(read_head(&x));
    for (; ssfr_rows_more(&x.rows) && n < x.n; n++) SSFR_TRY(ssfr_rows_read(&x.rows, &x.sheet, n));
    if (x.counted && n < x.n)
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: the file ends after %zu of %zu particles", reading->path,
                           x.rows.line, n, x.n);
    else if (x.rows.at < x.rows.end)
        result = ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s:%zu: the file goes on after its %zu particles: one frame a file",
                           reading->path, x.rows.line, x.n);
    ssfr_reading_end(reading, n);
end:
    free(file);
    return result;
}

ssfr_result ssfr_xyz_write(const ssfr_particles *set, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_sink sink;
    SSFR_TRY(ssfr_sink_begin(&sink, path, SSFR_ASCII));
    if (set->n == 0) ssfr_sink_text(&sink, "0\n\n");
    for (size_t i = 0; i < set->n; i++) {
        ssfr_sink_position_text(&sink, set, i, ' ');
        ssfr_sink_bytes(&sink, "\n", 1);
    }
end:
    return ssfr_sink_end(&sink, result);
}

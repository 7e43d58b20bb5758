/* SPDX-License-Identifier: MIT */
/* csv.c: reads and writes particles as tables of text: a line of names, then a line a particle, after RFC 4180.
 *
 * A name may carry its unit, "x [m]", which must be ours. Cells are parted by commas, semicolons, tabs or blanks: by
 * whichever is most frequent in the line of names. */
#include "scene/sheet.h"
#include "scene/writer.h"

#include <ctype.h>

/* ---- reading ----------------------------------------------------------------------------------------------------- */

/* What parts the names, outside quotes. */
static char find_separator(const ssfr_rows *r)
{
    static const char separators[] = {',', ';', '\t', ' '};
    size_t counts[SSFR_COUNT(separators)] = {0}, best = SSFR_COUNT(separators) - 1;
    bool quoted = false;
    for (const char *at = r->at; at < r->end && *at != '\n'; at++) {
        quoted ^= *at == '"';
        for (size_t i = 0; i + 1 < SSFR_COUNT(separators); i++) counts[i] += !quoted && *at == separators[i];
    }
    for (size_t i = 0; i + 1 < SSFR_COUNT(separators); i++)
        if (counts[i] > counts[best]) best = i;
    return separators[best];
}

/* The text of a cell from start to end, in its place: without quotes and the blanks around it. */
static char *cut_text(char *start, char *end)
{
    const bool quoted = *start == '"';
    char *to = start;
    if (quoted) end--;
    for (char *from = start + quoted; from < end; from++) {
        if (quoted && *from == '"') from++; /* the first of two, which are one */
        *to++ = *from;
    }
    while (to > start && isspace((unsigned char)to[-1])) to--;
    *to = '\0';
    return start + strspn(start, " \t");
}

/* The unit at the name's end, "m" in "x [m]", cut off; "" where there is none, and for "velocity[0]". */
static const char *cut_unit(char *name)
{
    char *const open = strrchr(name, '['), *const close = strrchr(name, ']');
    if (!open || !close || close < open || close[1] || open == name || open[-1] != ' ') return "";
    *close = '\0';
    *open = '\0';
    for (char *end = open; end > name && end[-1] == ' '; end--) end[-1] = '\0';
    return open + 1;
}

static ssfr_result add_column(ssfr_rows *r, ssfr_sheet *sheet, size_t line, char *name)
{
    ssfr_result result = SSFR_OK;
    char text[SSFR_FOUND], found[SSFR_FOUND];
    const char *unit = cut_unit(name);
    const ssfr_sheet_column column = ssfr_sheet_column_find(name);
    const char *expected = column.place == SSFR_PLACE_NONE ? unit : ssfr_place_unit(column.place);
    if (unit[0] && strcmp(unit, expected) != 0)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: %s: expected units \"%s\", found \"%s\"", r->path, line,
                         ssfr_printable(name, text), expected, ssfr_printable(unit, found));
    SSFR_TRY(ssfr_sheet_add(sheet, r->path, name, column));
    SSFR_TRY(ssfr_rows_add(r, column, name));
end:
    return result;
}

/* The name here; *more tells whether another follows it on the line. */
static ssfr_result next_name(ssfr_rows *r, char **name, bool *more)
{
    ssfr_rows_skip_blanks(r);
    char *const start = (char *)r->at; /* in the reader's own copy of the file */
    if (!ssfr_rows_skip_cell(r))
        return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: the quotes of a name do not close", r->path, r->line);
    char *const end = (char *)r->at;
    ssfr_rows_skip_blanks(r);
    *more = !ssfr_rows_at_line_end(r);
    if (!*more)
        ssfr_rows_skip_line(r);
    else if (*r->at == r->separator)
        r->at++;
    else if (r->separator != ' ')
        return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: a name goes on after its quotes", r->path, r->line);
    *name = cut_text(start, end);
    return SSFR_OK;
}

/* The line of names, which may begin with # as NumPy writes it, and the file with a mark of UTF-8. */
static ssfr_result read_names(ssfr_rows *r, ssfr_sheet *sheet)
{
    static const char mark[] = "\xef\xbb\xbf";
    ssfr_result result = SSFR_OK;
    char *name = NULL;
    if (strncmp(r->at, mark, sizeof mark - 1) == 0) r->at += sizeof mark - 1;
    bool more = ssfr_rows_more(r);
    if (more && *r->at == '#') r->at++;
    r->separator = find_separator(r);
    const size_t line = r->line;
    while (more) {
        SSFR_TRY(next_name(r, &name, &more));
        SSFR_TRY(add_column(r, sheet, line, name));
    }
end:
    return result;
}

ssfr_result ssfr_csv_read(ssfr_reading *reading)
{
    ssfr_result result = SSFR_OK;
    char *file = NULL;
    size_t n = 0;
    ssfr_stream stream;
    ssfr_sheet sheet = {.reading = reading};
    ssfr_rows rows = {.path = reading->path, .line = 1, .separator = ','};
    SSFR_TRY(ssfr_stream_open(&stream, reading->path, &file));
    rows.at = stream.at;
    rows.end = stream.end;
    SSFR_TRY(read_names(&rows, &sheet));
    SSFR_TRY(ssfr_sheet_begin(&sheet, reading->path, ssfr_rows_most(&rows)));
    while (ssfr_rows_more(&rows)) SSFR_TRY(ssfr_rows_read(&rows, &sheet, n++));
    ssfr_reading_end(reading, n);
end:
    free(file);
    return result;
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

static void write_names(ssfr_sink *sink, const ssfr_particles *set)
{
    ssfr_sink_text(sink, "x [m],y [m],z [m]");
    if (set->radius > 0) ssfr_sink_text(sink, ",radius [m]");
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++)
        for (size_t k = 0; ssfr_array_get(set, a) && k < a->count; k++) {
            ssfr_sink_text(sink, ",%s", a->name);
            if (a->count > 1) ssfr_sink_text(sink, "_%c", "xyz"[k]);
            if (strcmp(a->unit, "1") != 0) ssfr_sink_text(sink, " [%s]", a->unit);
        }
    ssfr_sink_text(sink, "\n");
}

static void write_values(ssfr_sink *sink, const ssfr_particles *set, const ssfr_array *array, size_t i)
{
    const void *values = ssfr_array_get(set, array);
    const float *const reals = array->real ? values : NULL;
    const uint32_t *const wholes = array->real ? NULL : values;
    for (size_t k = array->count * i; values && k < array->count * (i + 1); k++) {
        ssfr_sink_bytes(sink, ",", 1);
        if (reals)
            ssfr_sink_float_text(sink, reals[k]);
        else
            ssfr_sink_whole_text(sink, wholes[k]);
    }
}

/* The radius is a column of one value, because a table has no other place for it. */
ssfr_result ssfr_csv_write(const ssfr_particles *set, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_sink sink;
    char radius[SSFR_NUMBER_TEXT] = "";
    const int n_radius = set->radius > 0 ? snprintf(radius, sizeof radius, ",%.17g", set->radius) : 0;
    SSFR_TRY(ssfr_sink_begin(&sink, path, SSFR_ASCII));
    write_names(&sink, set);
    for (size_t i = 0; i < set->n; i++) {
        ssfr_sink_position_text(&sink, set, i, ',');
        ssfr_sink_bytes(&sink, radius, (size_t)n_radius);
        for (size_t a = 0; a < SSFR_N_ARRAYS; a++) write_values(&sink, set, ssfr_arrays + a, i);
        ssfr_sink_bytes(&sink, "\n", 1);
    }
end:
    return ssfr_sink_end(&sink, result);
}

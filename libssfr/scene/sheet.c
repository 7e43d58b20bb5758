/* SPDX-License-Identifier: MIT */
/* sheet.c: particle files that are tables, a particle a row: which column is which number, and rows of text. */
#include "scene/sheet.h"

#include <ctype.h>
#include <strings.h>

/* ---- columns ----------------------------------------------------------------------------------------------------- */

int ssfr_place_find(const char *name)
{
    static const char *const positions[] = {"position", "positions", "pos",        "point",
                                            "points",   "coord",     "coordinate", "coordinates"};
    const ssfr_array *array = ssfr_array_find(name);
    int place = array ? (int)(array - ssfr_arrays) + 1 : SSFR_PLACE_NONE;
    if (strcasecmp(name, "radius") == 0) place = SSFR_PLACE_RADIUS;
    for (size_t i = 0; i < SSFR_COUNT(positions); i++)
        if (strcasecmp(name, positions[i]) == 0) place = SSFR_PLACE_POSITION;
    return place;
}

size_t ssfr_place_count(int place)
{
    return place == SSFR_PLACE_POSITION ? 3 : place == SSFR_PLACE_RADIUS ? 1 : ssfr_arrays[place - 1].count;
}

const char *ssfr_place_name(int place)
{
    if (place == SSFR_PLACE_POSITION) return "position";
    return place == SSFR_PLACE_RADIUS ? "radius" : ssfr_arrays[place - 1].name;
}

const char *ssfr_place_unit(int place)
{
    return place == SSFR_PLACE_POSITION || place == SSFR_PLACE_RADIUS ? "m" : ssfr_arrays[place - 1].unit;
}

/* A vector's name and its component: "x", "vx", and with something between them "position_x", "Points:0", "v[2]". */
static ssfr_sheet_column find_component(const char *name)
{
    static const char components[] = "xyz012";
    ssfr_sheet_column column = {SSFR_PLACE_NONE, 0};
    char base[32];
    size_t n = strlen(name);
    if (n == 0 || n >= sizeof base) return column;
    memcpy(base, name, n + 1);
    if (n > 2 && base[n - 1] == ']' && base[n - 3] == '[') n--;
    const char *component = strchr(components, tolower((unsigned char)base[--n]));
    const bool parted = n > 1 && strchr(":_.-[ ", base[n - 1]);
    base[n - parted] = '\0';
    if (!component || (component >= components + 3 && !parted)) return column;
    const int place = n == 0 ? SSFR_PLACE_POSITION : ssfr_place_find(base);
    if (place != SSFR_PLACE_NONE && ssfr_place_count(place) == 3)
        column = (ssfr_sheet_column){place, (size_t)(component - components) % 3};
    return column;
}

ssfr_sheet_column ssfr_sheet_column_find(const char *name)
{
    const int place = ssfr_place_find(name);
    if (place != SSFR_PLACE_NONE && ssfr_place_count(place) == 1) return (ssfr_sheet_column){place, 0};
    return find_component(name);
}

ssfr_result ssfr_sheet_add(ssfr_sheet *t, const char *where, const char *name, ssfr_sheet_column column)
{
    if (column.place == SSFR_PLACE_NONE) {
        ssfr_reading_skip(t->reading, name);
        return SSFR_OK;
    }
    if (t->components[column.place] >> column.component & 1u)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: two columns for what %s says", where, name);
    t->components[column.place] |= 1u << column.component;
    return SSFR_OK;
}

ssfr_result ssfr_sheet_begin(ssfr_sheet *t, const char *where, size_t n)
{
    ssfr_result result = SSFR_OK;
    if (t->components[SSFR_PLACE_POSITION] != 7)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: the particles lack x, y or z", where);
    SSFR_TRY(ssfr_reading_begin(t->reading, n));
    t->targets[SSFR_PLACE_POSITION] = ssfr_target_positions(t->reading);
    if (t->components[SSFR_PLACE_RADIUS]) t->targets[SSFR_PLACE_RADIUS] = ssfr_target_radii(t->reading);
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++) {
        const unsigned components = t->components[a + 1], all = (1u << ssfr_arrays[a].count) - 1;
        if (components && components != all)
            return ssfr_fail(SSFR_ERR_FORMAT, "%s: the particles lack a component of %s", where, ssfr_arrays[a].name);
        if (components) SSFR_TRY(ssfr_target_array(t->reading, ssfr_arrays + a, t->targets + a + 1));
    }
end:
    return result;
}

/* ---- rows of text ------------------------------------------------------------------------------------------------ */

ssfr_result ssfr_rows_add(ssfr_rows *r, ssfr_sheet_column column, const char *name)
{
    if (r->n_columns == SSFR_MAX_COLUMNS)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: more than %d columns", r->path, SSFR_MAX_COLUMNS);
    r->columns[r->n_columns] = column;
    r->names[r->n_columns++] = name;
    return SSFR_OK;
}

static bool ends_line(const ssfr_rows *r, const char *at)
{
    return at == r->end || *at == '\n' || (*at == '\r' && (at + 1 == r->end || at[1] == '\n'));
}

static bool is_blank(const ssfr_rows *r, char c)
{
    return c == ' ' || (c == '\t' && r->separator != '\t');
}

static bool ends_cell(const ssfr_rows *r, const char *at)
{
    return ends_line(r, at) || *at == r->separator || is_blank(r, *at);
}

bool ssfr_rows_at_line_end(const ssfr_rows *r)
{
    return ends_line(r, r->at);
}

void ssfr_rows_skip_blanks(ssfr_rows *r)
{
    while (is_blank(r, *r->at)) r->at++;
}

static void pass_line_end(ssfr_rows *r)
{
    if (r->at < r->end && *r->at == '\r') r->at++;
    if (r->at == r->end) return;
    r->at++;
    r->line++;
}

void ssfr_rows_skip_line(ssfr_rows *r)
{
    while (!ssfr_rows_at_line_end(r)) r->at++;
    pass_line_end(r);
}

bool ssfr_rows_more(ssfr_rows *r)
{
    ssfr_rows_skip_blanks(r);
    while (r->at < r->end && ssfr_rows_at_line_end(r)) {
        pass_line_end(r);
        ssfr_rows_skip_blanks(r);
    }
    return r->at < r->end;
}

/* Two quotes within quotes are one of the text; line ends within them are text. */
static bool skip_quoted(ssfr_rows *r)
{
    for (r->at++; r->at < r->end; r->at++) {
        r->line += *r->at == '\n';
        if (*r->at != '"') continue;
        if (r->at[1] != '"') break;
        r->at++;
    }
    const bool closed = r->at < r->end;
    r->at += closed;
    return closed;
}

bool ssfr_rows_skip_cell(ssfr_rows *r)
{
    if (*r->at == '"') return skip_quoted(r);
    while (!ends_line(r, r->at) && *r->at != r->separator && !(r->separator == ' ' && *r->at == '\t')) r->at++;
    return true;
}

size_t ssfr_rows_most(const ssfr_rows *r)
{
    enum { LEAST = 6 /* bytes of a row: "0,0,0" and its end */ };
    size_t n_lines = 1;
    for (const char *at = r->at; (at = memchr(at, '\n', (size_t)(r->end - at))) != NULL; at++) n_lines++;
    const size_t fit = (size_t)(r->end - r->at) / LEAST + 1;
    return n_lines < fit ? n_lines : fit;
}

static ssfr_result fail_cell(const ssfr_rows *r, size_t column, const char *expected)
{
    char cell[SSFR_FOUND], text[SSFR_FOUND], name[SSFR_FOUND];
    size_t n = 0;
    for (const char *at = r->at; n + 1 < sizeof cell && !ends_cell(r, at); at++) cell[n++] = *at;
    cell[n] = '\0';
    return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: column %zu (%s): expected %s, found \"%s\"", r->path, r->line,
                     column + 1, ssfr_printable(r->names[column], name), expected, ssfr_printable(cell, text));
}

/* A number, in quotes or not, with nothing but blanks up to the cell's end. */
static bool read_number(ssfr_rows *r, double *value)
{
    const bool quoted = *r->at == '"';
    const char *start = r->at + quoted;
    char *end = NULL;
    if (isspace((unsigned char)*start)) return false; /* which strtod would skip, line ends too */
    *value = strtod(start, &end);
    if (end == start || (quoted && *end++ != '"')) return false;
    if (!ends_cell(r, end)) return false;
    r->at = end;
    return true;
}

/* Between two cells, or behind the last. */
static ssfr_result pass_separator(ssfr_rows *r, size_t column)
{
    ssfr_rows_skip_blanks(r);
    const bool last = column + 1 == r->n_columns, ends = ssfr_rows_at_line_end(r);
    if (ends && !last)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: the line ends after column %zu of %zu", r->path, r->line, column + 1,
                         r->n_columns);
    if (!ends && last)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: the line goes on after its %zu columns", r->path, r->line,
                         r->n_columns);
    if (ends)
        pass_line_end(r);
    else if (*r->at == r->separator)
        r->at++;
    else if (r->separator != ' ')
        return fail_cell(r, column, "a separator after it");
    return SSFR_OK;
}

ssfr_result ssfr_rows_read(ssfr_rows *r, ssfr_sheet *sheet, size_t i)
{
    ssfr_result result = SSFR_OK;
    for (size_t k = 0; k < r->n_columns; k++) {
        double value = 0;
        ssfr_rows_skip_blanks(r);
        if (r->columns[k].place == SSFR_PLACE_NONE) {
            if (!ssfr_rows_skip_cell(r)) return fail_cell(r, k, "a quote at the text's end");
        } else if (read_number(r, &value)) {
            SSFR_TRY(ssfr_sheet_put(sheet, r->columns[k], i, value));
        } else {
            return fail_cell(r, k, "a number");
        }
        SSFR_TRY(pass_separator(r, k));
    }
end:
    return result;
}

/* SPDX-License-Identifier: MIT */
/* sheet.h: particle files that are tables, a particle a row: which column is which number, and rows of text. */
#ifndef SSFR_SHEET_H
#define SSFR_SHEET_H

#include "scene/reader.h"

/* ---- columns ----------------------------------------------------------------------------------------------------- */

/* Places of a particle's numbers: 0 is the position, a + 1 is array a of ssfr_arrays, the last is the radius. */
enum {
    SSFR_PLACE_NONE = -1, /* the column is skipped */
    SSFR_PLACE_POSITION = 0,
    SSFR_PLACE_RADIUS = SSFR_N_ARRAYS + 1,
    SSFR_N_PLACES
};

typedef struct ssfr_sheet_column {
    int place;
    size_t component;
} ssfr_sheet_column;

/* The column of a name, in any case: "x", "Points:0", "position_y", "vx", "Velocity[2]", "rho", "radius" and so on. */
ssfr_sheet_column ssfr_sheet_column_find(const char *name);
/* The place of a whole vector or number ("pos", "velocity", "id", "radius"), or SSFR_PLACE_NONE. */
int ssfr_place_find(const char *name);
size_t ssfr_place_count(int place);     /* values a particle */
const char *ssfr_place_name(int place); /* "velocity" */
const char *ssfr_place_unit(int place); /* "m" */

typedef struct ssfr_sheet {
    ssfr_reading *reading;
    unsigned components[SSFR_N_PLACES]; /* that have a column, bit k is component k */
    ssfr_target targets[SSFR_N_PLACES];
} ssfr_sheet;

/* Takes note of a column, which must be the only one for its number, or is skipped. `where` starts the error
 * lines: a file, a line. */
SSFR_MUST ssfr_result ssfr_sheet_add(ssfr_sheet *sheet, const char *where, const char *name, ssfr_sheet_column column);
/* Makes room for n particles when all columns were added: a position must be whole, and so must other vectors. */
SSFR_MUST ssfr_result ssfr_sheet_begin(ssfr_sheet *sheet, const char *where, size_t n);

/* Stores a column's value of particle i. */
static inline ssfr_result ssfr_sheet_put(ssfr_sheet *t, ssfr_sheet_column column, size_t i, double value)
{
    if (column.place == SSFR_PLACE_NONE) return SSFR_OK;
    const ssfr_target *target = t->targets + column.place;
    return ssfr_target_put(t->reading, target, target->count * i + column.component, value);
}

/* ---- rows of text ------------------------------------------------------------------------------------------------ */

enum { SSFR_MAX_COLUMNS = 1024 };

typedef struct ssfr_rows {
    const char *path;
    const char *at, *end; /* a zero byte stands at end */
    size_t line;          /* of at, from 1 */
    char separator;       /* ',', ';', a tab, or ' ' for any number of blanks and tabs */
    size_t n_columns;
    ssfr_sheet_column columns[SSFR_MAX_COLUMNS];
    const char *names[SSFR_MAX_COLUMNS]; /* for error lines */
} ssfr_rows;

SSFR_MUST ssfr_result ssfr_rows_add(ssfr_rows *rows, ssfr_sheet_column column, const char *name);
/* Goes to the next line that is not blank; false when there is none. */
bool ssfr_rows_more(ssfr_rows *rows);
void ssfr_rows_skip_blanks(ssfr_rows *rows);
bool ssfr_rows_at_line_end(const ssfr_rows *rows);
/* Passes the cell here, quoted or not; false when its quotes do not close. */
bool ssfr_rows_skip_cell(ssfr_rows *rows);
void ssfr_rows_skip_line(ssfr_rows *rows);
/* At least the number of rows that follow, and not much more than the file's size. */
size_t ssfr_rows_most(const ssfr_rows *rows);
/* Reads particle i from the line here, which must have as many cells as there are columns. */
SSFR_MUST ssfr_result ssfr_rows_read(ssfr_rows *rows, ssfr_sheet *sheet, size_t i);

#endif

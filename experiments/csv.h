/* SPDX-License-Identifier: GPL-3.0-or-later */
/* csv.h: tables after RFC 4180, appended row by row so that a killed run loses at most the row in progress.
 *
 * One header line, no comments, lines end in LF (CRLF is read too). A column's name may carry its unit: "dt [m^2]". */
#ifndef SSFR_CSV_H
#define SSFR_CSV_H

#include "base/base.h"

/* ---- reading ----------------------------------------------------------------------------------------------------- */

typedef struct ssfr_csv_table {
    int n_columns;
    size_t n_rows; /* without the header */
    char **cells;  /* (1 + n_rows) n_columns, the header first; they point into text */
    char *text;
    size_t whole; /* bytes up to the end of the last complete line; what follows was torn off */
} ssfr_csv_table;

/* Reads the complete lines of a file. A file without one gives 0 columns. */
SSFR_MUST ssfr_result ssfr_csv_load(ssfr_csv_table **out, const char *path);
/* The same from a text; path is what errors call it. */
SSFR_MUST ssfr_result ssfr_csv_parse(ssfr_csv_table **out, const char *path, const char *text, size_t size);
void ssfr_csv_table_destroy(ssfr_csv_table **table);

/* The cell of a row (0 is the first below the header) and a column. */
const char *ssfr_csv_cell(const ssfr_csv_table *table, size_t row, int column);
/* Two rows have the same first n cells. */
bool ssfr_csv_same_cells(const ssfr_csv_table *table, size_t a, size_t b, int n);
/* A cell as a number, NaN when it is none. */
double ssfr_csv_cell_number(const ssfr_csv_table *table, size_t row, int column);
/* A column's header is that name, with or without a unit. */
bool ssfr_csv_is_column(const char *header, const char *name);
/* The column of that name, with or without its unit; -1 when there is none. */
int ssfr_csv_column(const ssfr_csv_table *table, const char *name);

/* ---- writing ----------------------------------------------------------------------------------------------------- */

typedef struct ssfr_csv ssfr_csv;

/* Starts a table at path (NULL: standard output). The first n_keys columns tell one row from another. With `resume` the
 * rows that the file already holds stay: its header must be the same, a torn last line is cut off. */
SSFR_MUST ssfr_result ssfr_csv_create(ssfr_csv **out, const char *path, int n_columns, const char *const *columns,
                                      int n_keys, bool resume);
void ssfr_csv_destroy(ssfr_csv **csv);

/* True when the file that was resumed holds a row of this key. */
bool ssfr_csv_has(ssfr_csv *csv, const char *const *key);

/* How many rows the file held that was resumed. */
size_t ssfr_csv_resumed(const ssfr_csv *csv);

/* The next cell. Numbers have up to 9 significant digits, or are NaN, inf, -inf. */
SSFR_MUST ssfr_result ssfr_csv_text(ssfr_csv *csv, const char *text);
SSFR_MUST ssfr_result ssfr_csv_number(ssfr_csv *csv, double value);
/* Writes the row, in one piece. Where the last wait for the disk was a second ago, it waits until all rows are on it;
 * ssfr_csv_destroy does for the last ones. */
SSFR_MUST ssfr_result ssfr_csv_end_row(ssfr_csv *csv);

#endif

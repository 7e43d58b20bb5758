/* SPDX-License-Identifier: GPL-3.0-or-later */
/* console.h: what the program says: the log as one line on stderr, progress, tables on stdout. */
#ifndef SSFR_CONSOLE_H
#define SSFR_CONSOLE_H

#include "base/base.h"

/* From here on the log goes to stderr as "ssfr <command>: <text>"; command NULL leaves it at "ssfr: ". */
void ssfr_console_open(const char *command);

/* Lines above this level are not shown; SSFR_WARNING at first. */
void ssfr_console_level(ssfr_level level);
ssfr_level ssfr_console_shown(void);

/* A progress bar with the time left while stderr is a terminal and not -q, else nothing. `done` of `total`, which may
 * be called as often as is convenient; done == total removes the bar. */
void ssfr_console_progress(const char *what, size_t done, size_t total);
/* When the work of that name was first told of, s, where `now` is the time now: it may be part of other work, which
 * began before. done == total ends it. */
double ssfr_console_begun(const char *what, size_t done, size_t total, double now);

/* Rows of cells printed with aligned columns on a terminal and separated by tabs into a pipe. Cells are copied. */
typedef struct ssfr_table {
    int n_columns;
    size_t n_cells, capacity;
    char **cells; /* row by row */
} ssfr_table;

void ssfr_table_init(ssfr_table *table, int n_columns);
/* Adds the next cell of the table in reading order. */
__attribute__((format(printf, 2, 3))) SSFR_MUST ssfr_result ssfr_table_add(ssfr_table *table, const char *format, ...);
/* A row of texts, as many as there are columns. */
SSFR_MUST ssfr_result ssfr_table_row(ssfr_table *table, const char *const *texts);
void ssfr_table_print(const ssfr_table *table, FILE *file);
void ssfr_table_finish(ssfr_table *table);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shown.h: a table's rows for people: some of its columns, in shorter words and units that suit them; and as a chart. */
#ifndef SSFR_SHOWN_H
#define SSFR_SHOWN_H

#include "experiments/chart.h"
#include "experiments/ledger.h"

typedef struct ssfr_shown {
    const char *column, *title;
    const char *format; /* of a number; NULL for text */
    double factor;      /* that it is multiplied by */
} ssfr_shown;

/* Tells which rows are shown. */
typedef bool ssfr_shown_chooser(const ssfr_csv_table *table, size_t row);

/* Prints the title, then the rows that are chosen, all where `chosen` is NULL; numbers that are not finite as "-". */
SSFR_MUST ssfr_result ssfr_shown_print(const ssfr_ledger *from, const char *title, ssfr_shown_chooser *chosen,
                                       const ssfr_shown *columns, int n_columns);

/* Draws the chart beside the table's file. */
SSFR_MUST ssfr_result ssfr_shown_draw(const ssfr_ledger *from, const char *csv, const char *title, int n_panels,
                                      const ssfr_panel *panels);

#endif

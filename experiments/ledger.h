/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ledger.h: a table that grows row by row: kept for printing and drawing, and written to a CSV that can be gone on
 * with.
 *
 * Its columns are keys, which tell one row from another, then "status", then numbers. */
#ifndef SSFR_LEDGER_H
#define SSFR_LEDGER_H

#include "experiments/columns.h"
#include "experiments/console.h"
#include "experiments/csv.h"

enum { SSFR_LEDGER_COLUMNS = 32 };

typedef struct ssfr_ledger {
    int n_columns, n_keys;
    ssfr_table cells; /* the header, then the rows */
    ssfr_csv *csv;    /* NULL for none */
    ssfr_aside aside; /* of a table that is not gone on with */
} ssfr_ledger;

/* path NULL: no file. With `resume` the rows that the file holds are taken over; *resumed: it had some. */
SSFR_MUST ssfr_result ssfr_ledger_begin(ssfr_ledger *ledger, const char *path, int n_columns,
                                          const ssfr_column *columns, int n_keys, bool resume, bool *resumed);
/* The same for one that nothing goes on with: what stands at path stays until ssfr_ledger_end. */
SSFR_MUST ssfr_result ssfr_ledger_begin_aside(ssfr_ledger *ledger, const char *path, int n_columns,
                                              const ssfr_column *columns, int n_keys);
void ssfr_ledger_finish(ssfr_ledger *ledger);
/* Finishes; a table begun aside is put in its place when so_far is SSFR_OK, else it is gone. */
SSFR_MUST ssfr_result ssfr_ledger_end(ssfr_ledger *ledger, ssfr_result so_far);

bool ssfr_ledger_has(const ssfr_ledger *ledger, const char *const *keys);
/* Adds a row of n_keys keys, the status, and a number for each of the other columns, NaN where numbers is NULL; not
 * when there is one of these keys. */
SSFR_MUST ssfr_result ssfr_ledger_add(ssfr_ledger *ledger, const char *const *keys, const char *status,
                                      const double *numbers);
/* Fails: tells that measuring was interrupted, and of a file how it goes on. */
SSFR_MUST ssfr_result ssfr_ledger_interrupted(const ssfr_ledger *ledger);

/* As if read from the file; valid until the next row. */
ssfr_csv_table ssfr_ledger_view(const ssfr_ledger *ledger);

#endif

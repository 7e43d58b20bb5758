/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ledger.c: a table in memory and, row for row the same, in a file. */
#include "experiments/ledger.h"

#include <assert.h>

static ssfr_result take_over(ssfr_ledger *ledger, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_csv_table *before = NULL;
    SSFR_TRY(ssfr_csv_load(&before, path));
    for (size_t row = 0; row < before->n_rows; row++)
        for (int i = 0; i < ledger->n_columns; i++)
            SSFR_TRY(ssfr_table_add(&ledger->cells, "%s", ssfr_csv_cell(before, row, i)));
end:
    ssfr_csv_table_destroy(&before);
    return result;
}

ssfr_result ssfr_ledger_begin(ssfr_ledger *ledger, const char *path, int n_columns, const ssfr_column *columns,
                              int n_keys, bool resume, bool *resumed)
{
    ssfr_result result = SSFR_OK;
    char headers[SSFR_LEDGER_COLUMNS][128];
    const char *names[SSFR_LEDGER_COLUMNS];
    assert(n_columns <= SSFR_LEDGER_COLUMNS);
    *ledger = (ssfr_ledger){.n_columns = n_columns, .n_keys = n_keys};
    *resumed = false;
    ssfr_table_init(&ledger->cells, n_columns);
    for (int i = 0; i < n_columns; i++) {
        ssfr_column_header(columns[i].name, columns[i].unit, headers[i], sizeof headers[i]);
        names[i] = headers[i];
        SSFR_TRY(ssfr_table_add(&ledger->cells, "%s", headers[i]));
    }
    if (!path) goto end;
    SSFR_TRY(ssfr_csv_create(&ledger->csv, path, n_columns, names, n_keys, resume));
    *resumed = ssfr_csv_resumed(ledger->csv);
    if (*resumed) SSFR_TRY(take_over(ledger, path));
end:
    return result;
}

ssfr_result ssfr_ledger_begin_aside(ssfr_ledger *ledger, const char *path, int n_columns, const ssfr_column *columns,
                                    int n_keys)
{
    ssfr_result result = SSFR_OK;
    ssfr_aside aside = {0};
    bool resumed;
    *ledger = (ssfr_ledger){0};
    if (path) SSFR_TRY(ssfr_aside_begin(&aside, path));
    result = ssfr_ledger_begin(ledger, aside.temporary, n_columns, columns, n_keys, false, &resumed);
end:
    ledger->aside = aside;
    return result;
}

void ssfr_ledger_finish(ssfr_ledger *ledger)
{
    ssfr_csv_destroy(&ledger->csv);
    ssfr_table_finish(&ledger->cells);
}

ssfr_result ssfr_ledger_end(ssfr_ledger *ledger, ssfr_result so_far)
{
    ssfr_ledger_finish(ledger);
    return ssfr_aside_end(&ledger->aside, so_far);
}

bool ssfr_ledger_has(const ssfr_ledger *ledger, const char *const *keys)
{
    const ssfr_csv_table view = ssfr_ledger_view(ledger);
    bool found = false;
    for (size_t row = 0; row < view.n_rows && !found; row++) {
        found = true;
        for (int k = 0; k < ledger->n_keys && found; k++) found = strcmp(ssfr_csv_cell(&view, row, k), keys[k]) == 0;
    }
    return found;
}

static ssfr_result add_cell(ssfr_ledger *ledger, const char *text)
{
    const ssfr_result result = ssfr_table_add(&ledger->cells, "%s", text);
    return result == SSFR_OK && ledger->csv ? ssfr_csv_text(ledger->csv, text) : result;
}

ssfr_result ssfr_ledger_add(ssfr_ledger *ledger, const char *const *keys, const char *status, const double *numbers)
{
    ssfr_result result = SSFR_OK;
    const int n_numbers = ledger->n_columns - ledger->n_keys - 1;
    if (ssfr_ledger_has(ledger, keys)) goto end;
    for (int k = 0; k < ledger->n_keys; k++) SSFR_TRY(add_cell(ledger, keys[k]));
    SSFR_TRY(add_cell(ledger, status));
    for (int i = 0; i < n_numbers; i++) {
        const double number = numbers ? numbers[i] : NAN;
        char text[32];
        snprintf(text, sizeof text, "%.9g", number);
        SSFR_TRY(add_cell(ledger, isnan(number) ? "NaN" : text));
    }
    if (ledger->csv) SSFR_TRY(ssfr_csv_end_row(ledger->csv));
end:
    return result;
}

ssfr_result ssfr_ledger_interrupted(const ssfr_ledger *ledger)
{
    return ssfr_fail(SSFR_ERR_IO, "interrupted%s",
                     ledger->csv ? ": whole rows stay, the same command with --resume goes on from there" : "");
}

ssfr_csv_table ssfr_ledger_view(const ssfr_ledger *ledger)
{
    return (ssfr_csv_table){.n_columns = ledger->n_columns,
                            .n_rows = ledger->cells.n_cells / (size_t)ledger->n_columns - 1,
                            .cells = ledger->cells.cells};
}

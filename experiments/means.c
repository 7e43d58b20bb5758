/* SPDX-License-Identifier: GPL-3.0-or-later */
/* means.c: rows that differ in one key alone, made one. */
#include "experiments/means.h"
#include "experiments/csv.h"
#include "experiments/meta.h"

typedef struct means {
    const ssfr_csv_table *table;
    int n_keys, status; /* columns of the table: its keys stand before the status */
    int over;
    int n, *columns; /* that are averaged */
} means;

static bool is_same(const means *m, size_t a, size_t b)
{
    bool same = true;
    for (int c = 0; c < m->n_keys && same; c++)
        same = c == m->over || strcmp(ssfr_csv_cell(m->table, a, c), ssfr_csv_cell(m->table, b, c)) == 0;
    return same;
}

static bool is_first(const means *m, size_t row)
{
    bool first = true;
    for (size_t i = 0; i < row && first; i++) first = !is_same(m, i, row);
    return first;
}

static bool is_ok(const means *m, size_t row)
{
    return strcmp(ssfr_csv_cell(m->table, row, m->status), "ok") == 0;
}

static double mean_of(const means *m, size_t first, int column)
{
    double sum = 0, n = 0;
    for (size_t i = first; i < m->table->n_rows; i++) {
        const double value = ssfr_csv_cell_number(m->table, i, column);
        if (!is_same(m, first, i) || !is_ok(m, i) || !isfinite(value)) continue;
        sum += value, n += 1;
    }
    return n > 0 ? sum / n : NAN;
}

static ssfr_result write_row(const means *m, size_t first, ssfr_csv *csv)
{
    ssfr_result result = SSFR_OK;
    size_t n_ok = 0;
    for (size_t i = first; i < m->table->n_rows; i++) n_ok += is_same(m, first, i) && is_ok(m, i);
    for (int c = 0; c < m->n_keys; c++)
        if (c != m->over) SSFR_TRY(ssfr_csv_text(csv, ssfr_csv_cell(m->table, first, c)));
    SSFR_TRY(ssfr_csv_text(csv, n_ok ? "ok" : "no row is ok"));
    SSFR_TRY(ssfr_csv_number(csv, (double)n_ok));
    for (int i = 0; i < m->n; i++) SSFR_TRY(ssfr_csv_number(csv, mean_of(m, first, m->columns[i])));
    SSFR_TRY(ssfr_csv_end_row(csv));
end:
    return result;
}

static ssfr_result save(const means *m, const char *path)
{
    ssfr_result result = SSFR_OK;
    const char **header = NULL;
    ssfr_csv *csv = NULL;
    int n = 0;
    SSFR_TRY(ssfr_alloc(&header, (size_t)(m->n_keys + 2 + m->n), sizeof *header, "a header"));
    for (int c = 0; c < m->n_keys; c++)
        if (c != m->over) header[n++] = m->table->cells[c];
    header[n++] = "status", header[n++] = "rows";
    for (int i = 0; i < m->n; i++) header[n++] = m->table->cells[m->columns[i]];
    SSFR_TRY(ssfr_csv_create(&csv, path, n, header, m->n_keys - 1, false));
    for (size_t i = 0; i < m->table->n_rows; i++)
        if (is_first(m, i)) SSFR_TRY(write_row(m, i, csv));
end:
    ssfr_csv_destroy(&csv);
    free(header);
    return result;
}

static ssfr_result find(means *m, const char *path, const char *name, int *column)
{
    *column = ssfr_csv_column(m->table, name);
    return *column >= 0 ? SSFR_OK : ssfr_fail(SSFR_ERR_UNKNOWN, "%s: has no column %s", path, name);
}

ssfr_result ssfr_means_save(const char *table, const char *over, int n, const char *const *columns)
{
    ssfr_result result = SSFR_OK;
    ssfr_csv_table *read = NULL;
    char *path = NULL;
    means m = {.n = n};
    SSFR_TRY(ssfr_meta_path(&path, table, "_mean.csv"));
    SSFR_TRY(ssfr_csv_load(&read, table));
    m.table = read;
    SSFR_TRY(ssfr_alloc(&m.columns, (size_t)n + 1, sizeof *m.columns, "columns"));
    SSFR_TRY(find(&m, table, "status", &m.status));
    SSFR_TRY(find(&m, table, over, &m.over));
    m.n_keys = m.status;
    for (int i = 0; i < n; i++) SSFR_TRY(find(&m, table, columns[i], &m.columns[i]));
    if (m.over >= m.n_keys) SSFR_TRY(ssfr_fail(SSFR_ERR_UNKNOWN, "%s: %s is no key of it", table, over));
    SSFR_TRY(save(&m, path));
end:
    ssfr_csv_table_destroy(&read);
    free(m.columns);
    free(path);
    return result;
}

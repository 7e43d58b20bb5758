/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shown.c: rows of a ledger as a table on stdout, and as a chart. */
#include "experiments/shown.h"
#include "experiments/meta.h"

static ssfr_result add_shown(ssfr_table *out, const ssfr_csv_table *table, size_t row, const ssfr_shown *s)
{
    const int column = ssfr_csv_column(table, s->column);
    char text[64];
    if (!s->format) return ssfr_table_add(out, "%s", ssfr_csv_cell(table, row, column));
    const double value = s->factor * ssfr_csv_cell_number(table, row, column);
    if (!isfinite(value)) return ssfr_table_add(out, "-");
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    snprintf(text, sizeof text, s->format, value);
#pragma GCC diagnostic pop
    return ssfr_table_add(out, "%s", text);
}

ssfr_result ssfr_shown_print(const ssfr_ledger *from, const char *title, ssfr_shown_chooser *chosen,
                             const ssfr_shown *columns, int n_columns)
{
    ssfr_result result = SSFR_OK;
    const ssfr_csv_table view = ssfr_ledger_view(from);
    ssfr_table out;
    ssfr_table_init(&out, n_columns);
    for (int i = 0; i < n_columns; i++) SSFR_TRY(ssfr_table_add(&out, "%s", columns[i].title));
    for (size_t row = 0; row < view.n_rows; row++)
        for (int i = 0; i < n_columns && (!chosen || chosen(&view, row)); i++)
            SSFR_TRY(add_shown(&out, &view, row, &columns[i]));
    printf("%s\n", title);
    ssfr_table_print(&out, stdout);
    printf("\n");
end:
    ssfr_table_finish(&out);
    return result;
}

ssfr_result ssfr_shown_draw(const ssfr_ledger *from, const char *csv, const char *title, int n_panels,
                            const ssfr_panel *panels)
{
    ssfr_result result = SSFR_OK;
    const ssfr_csv_table view = ssfr_ledger_view(from);
    char *svg = NULL;
    SSFR_TRY(ssfr_meta_path(&svg, csv, ".svg"));
    SSFR_TRY(ssfr_chart_save(svg, &view, title, n_panels, panels));
end:
    free(svg);
    return result;
}

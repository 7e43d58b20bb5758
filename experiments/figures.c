/* SPDX-License-Identifier: GPL-3.0-or-later */
/* figures.c: from the figures that a sweep asks for to plots and charts. */
#include "experiments/figures.h"
#include "experiments/chart.h"
#include "experiments/columns.h"
#include "experiments/meta.h"
#include "experiments/plot.h"

_Static_assert((int)SSFR_MAX_LINES <= (int)SSFR_CHART_KEYS, "the columns that name a line of a panel");
_Static_assert((int)SSFR_MAX_ONLY <= (int)SSFR_CHART_ONLY, "the columns that choose a panel's rows");

static ssfr_result draw_plot(const char *path, const ssfr_csv_table *table, const ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    ssfr_plot_spec plot = spec->plot;
    char *svg = NULL;
    if (!plot.title) plot.title = spec->title;
    SSFR_TRY(ssfr_meta_path(&svg, path, ".svg"));
    SSFR_TRY(ssfr_plot_save(svg, table, &plot));
end:
    free(svg);
    return result;
}

typedef struct texts { /* of one panel */
    char x[256], y[256], before[SSFR_MAX_LINES][128];
} texts;

static void put_label(const ssfr_csv_table *table, const char *column, const char *label, char *text, size_t size)
{
    const int at = ssfr_csv_column(table, column);
    if (label)
        snprintf(text, size, "%s", label);
    else
        ssfr_column_label(ssfr_column_find(column), at >= 0 ? table->cells[at] : column, text, size);
}

static void fill_panel(const ssfr_csv_table *table, const ssfr_plot_spec *spec, texts *t, ssfr_panel *panel)
{
    put_label(table, spec->x, spec->x_label, t->x, sizeof t->x);
    put_label(table, spec->y, spec->y_label, t->y, sizeof t->y);
    *panel = (ssfr_panel){
        .title = spec->title ? spec->title : "", .x = spec->x, .y = spec->y, .x_label = t->x, .y_label = t->y,
        .log_x = spec->log[0], .log_y = spec->log[1]};
    for (int i = 0; i < spec->n_lines; i++) {
        const char *word = ssfr_column_word(spec->lines[i]);
        snprintf(t->before[i], sizeof t->before[i], "%s%s", word, word[0] ? " " : "");
        panel->keys[i].column = spec->lines[i];
        panel->keys[i].before = t->before[i];
    }
    for (int i = 0; i < spec->n_only; i++) {
        panel->only[i].column = spec->only[i].column;
        panel->only[i].cell = spec->only[i].cell;
    }
}

static ssfr_result draw_curves(const char *path, const ssfr_csv_table *table, const ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    ssfr_panel panels[SSFR_MAX_PANELS];
    texts t[SSFR_MAX_PANELS];
    char *svg = NULL;
    for (int i = 0; i < spec->n_curves; i++) fill_panel(table, &spec->curves[i], &t[i], &panels[i]);
    SSFR_TRY(ssfr_meta_path(&svg, path, "_curves.svg"));
    SSFR_TRY(ssfr_chart_save(svg, table, spec->title ? spec->title : "", spec->n_curves, panels));
end:
    free(svg);
    return result;
}

ssfr_result ssfr_figures_draw(const char *path, const ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    ssfr_csv_table *table = NULL;
    if (!spec->plot.x && spec->n_curves == 0) return SSFR_OK;
    SSFR_TRY(ssfr_csv_load(&table, path));
    if (spec->plot.x) SSFR_TRY(draw_plot(path, table, spec));
    if (spec->n_curves > 0) SSFR_TRY(draw_curves(path, table, spec));
end:
    ssfr_csv_table_destroy(&table);
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chart.h: a table's columns as curves, in one panel or several, as SVG by gnuplot. */
#ifndef SSFR_CHART_H
#define SSFR_CHART_H

#include "experiments/csv.h"

enum { SSFR_CHART_KEYS = 4, SSFR_CHART_ONLY = 12, SSFR_CHART_LEVELS = 2, SSFR_CHART_CURVES = 24 };

typedef struct ssfr_panel {
    const char *title, *x, *y;    /* columns, with or without their units */
    const char *x_label, *y_label;
    double y_factor;              /* what a cell is multiplied by before it is drawn: 100 for percent; 0 is 1 */
    bool log_x, log_y;            /* then only what is positive is drawn */
    struct {
        const char *column, *before; /* "threads", "threads ": the cell with that before it */
    } keys[SSFR_CHART_KEYS];      /* together they name a curve; up to the first without a column */
    struct {
        const char *column, *cell; /* several cells of one column: any of them */
    } only[SSFR_CHART_ONLY];      /* the rows that are drawn; none: all */
    double levels[SSFR_CHART_LEVELS]; /* dashed lines across, as drawn; 0 for none */
    const char *level_text;       /* what they mean */
    double mark[2];               /* x and y of a star, as drawn; 0 for none */
    const char *mark_text;
} ssfr_panel;

/* Gives every `only` without a cell this one, which must stay: for what is known at run time alone. */
void ssfr_panels_fill(int n_panels, ssfr_panel *panels, const char *cell);

/* Curves join the rows' points in their order. Rows whose column status is not ok, and cells that are no finite number,
 * are left out. A panel without any point, like a missing gnuplot, is a warning: then no file is written. */
SSFR_MUST ssfr_result ssfr_chart_save(const char *svg, const ssfr_csv_table *table, const char *title, int n_panels,
                                      const ssfr_panel *panels);

#endif

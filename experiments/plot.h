/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plot.h: work-precision plots: what each method costs for the error that it reaches, as SVG by gnuplot. */
#ifndef SSFR_PLOT_H
#define SSFR_PLOT_H

#include "experiments/csv.h"
#include "experiments/sweep_spec.h"

typedef struct ssfr_point {
    double x, y; /* less is better in both */
    size_t line; /* the method that it belongs to */
    bool front;  /* out: no other point is at least as good in both and better in one */
} ssfr_point;

/* Sorts the points by x, then y, and marks those on the Pareto front. */
void ssfr_plot_front(ssfr_point *points, size_t n);

/* Plots the rows of status ok. A missing gnuplot, or no row to draw, is a warning: then no file is written. */
SSFR_MUST ssfr_result ssfr_plot_save(const char *svg, const ssfr_csv_table *table, const ssfr_plot_spec *spec);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* figures.h: what a sweep draws of its table: the plot of work and precision, and curves in panels. */
#ifndef SSFR_FIGURES_H
#define SSFR_FIGURES_H

#include "experiments/sweep_spec.h"

/* Draws <name>.svg and <name>_curves.svg beside the table <name>.csv, those that the spec asks for. */
SSFR_MUST ssfr_result ssfr_figures_draw(const char *table, const ssfr_sweep_spec *spec);

#endif

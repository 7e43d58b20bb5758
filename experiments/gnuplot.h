/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gnuplot.h: what all drawings by gnuplot share: running it, its strings, colours and tics. */
#ifndef SSFR_GNUPLOT_H
#define SSFR_GNUPLOT_H

#include "base/base.h"

/* Writes a script that draws into `output`. */
typedef ssfr_result ssfr_gnuplot_script(void *user, FILE *script, const char *output);

/* Draws an SVG, aside and renamed when complete. A missing gnuplot is a warning: then no file is written. */
SSFR_MUST ssfr_result ssfr_gnuplot_draw(const char *svg, ssfr_gnuplot_script *put, void *user);

/* The terminal, w x h px, and the output. */
void ssfr_gnuplot_begin(FILE *script, int w, int h, const char *output);
/* A string: within single quotes nothing is special but the quote itself. */
void ssfr_gnuplot_text(FILE *script, const char *text);
/* Tics of the axis x or y from lo to hi at 1, 2 and 5 of each decade; evenly spaced within a narrow range, at decades
 * over a wide one. */
void ssfr_gnuplot_log_tics(FILE *script, char name, double lo, double hi);

/* Of the i-th line: a colour that the colour-blind tell apart from the others, and a sign (a point type). */
const char *ssfr_gnuplot_colour(size_t i);
int ssfr_gnuplot_sign(size_t i);

#endif

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

/* The text as a string of as many lines as it needs to be at most `width` px wide in a font of that size, px; broken at
 * spaces. Gives their number. Without a script (NULL) they are counted alone. */
int ssfr_gnuplot_lines(FILE *script, const char *text, int width, int font);

/* The key below a plot: rows of names, under each other in columns. */
typedef struct ssfr_gnuplot_key {
    size_t rows;
    int height; /* px */
} ssfr_gnuplot_key;

/* Of n names, the longest of so many characters, where `width` px are free; without names it needs no room. */
ssfr_gnuplot_key ssfr_gnuplot_key_fit(size_t n, size_t longest, int width);
/* Places it with its upper left corner there, as shares of the drawing from its lower left. */
void ssfr_gnuplot_key_put(FILE *script, const ssfr_gnuplot_key *key, double x, double y);

/* Of the i-th line: a colour that the colour-blind tell apart from the others, and a sign (a point type). */
enum { SSFR_GNUPLOT_COLOURS = 7 };
const char *ssfr_gnuplot_colour(size_t i);
int ssfr_gnuplot_sign(size_t i);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* columns.h: the measured columns of a sweep; columns.def is the one list of them. */
#ifndef SSFR_COLUMNS_H
#define SSFR_COLUMNS_H

#include "base/base.h"

typedef enum ssfr_column_id {
#define X(name, unit, better, help) SSFR_COLUMN_##name,
#include "experiments/columns.def"
#undef X
    SSFR_N_COLUMNS
} ssfr_column_id;

typedef enum ssfr_column_text_id {
#define X(name, unit, better, help)
#define T(name, help) SSFR_COLUMN_TEXT_##name,
#include "experiments/columns.def"
#undef X
    SSFR_N_COLUMN_TEXTS
} ssfr_column_text_id;

enum { SSFR_COLUMN_TEXT = 1024 /* bytes of a text */ };

typedef struct ssfr_column {
    const char *name, *unit;
    int better; /* -1: less is better, +1: more, 0: neither */
    const char *help;
} ssfr_column;

/* The numbers, then the texts. */
extern const ssfr_column ssfr_columns[SSFR_N_COLUMNS + SSFR_N_COLUMN_TEXTS];
const ssfr_column *ssfr_column_find(const char *name); /* NULL when there is none */

/* "name [unit]", or the name alone where it carries its unit or has none. Written to text[size]. */
void ssfr_column_header(const char *name, const char *unit, char *text, size_t size);
/* What stands before a cell that names a line, "splat point", "view 2": of a parameter the last word, of others their
 * name; "" where cells are clear by themselves. */
const char *ssfr_column_word(const char *name);
/* For the axis of a figure: what a measured column means, with its unit; of others (NULL) the header itself. */
void ssfr_column_label(const ssfr_column *column, const char *header, char *text, size_t size);

#endif

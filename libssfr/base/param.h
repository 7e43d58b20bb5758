/* SPDX-License-Identifier: MIT */
/* param.h: what parameter rows do. The struct is plain memory; rows say where a value stands in it. */
#ifndef SSFR_PARAM_H
#define SSFR_PARAM_H

#include "base/base.h"

/* Rows for a struct `type`, member `name`; help says what the value means. Ranges are closed. */
#define SSFR_PARAM_REAL(type, name, unit, def, min, max, help) \
    {#name, SSFR_REAL, unit, help, offsetof(type, name), def, min, max, NULL}
#define SSFR_PARAM_INT(type, name, unit, def, min, max, help) \
    {#name, SSFR_INT, unit, help, offsetof(type, name), def, min, max, NULL}
#define SSFR_PARAM_FLAG(type, name, def, help) {#name, SSFR_FLAG, "1", help, offsetof(type, name), def, 0, 1, NULL}
#define SSFR_PARAM_CHOICE(type, name, words, def, help) \
    {#name, SSFR_CHOICE, "1", help, offsetof(type, name), def, 0, 0, words}
#define SSFR_PARAM_SET(type, name, words, def, help) \
    {#name, SSFR_SET, "1", help, offsetof(type, name), def, 0, 0, words}
#define SSFR_PARAM_END {NULL, SSFR_REAL, NULL, NULL, 0, 0, 0, 0, NULL}

void ssfr_params_default(const ssfr_param *rows, void *params);
const ssfr_param *ssfr_param_find(const ssfr_param *rows, const char *name);

/* Parses text by the row's type and range; `key` is what the user called it, for the error line. */
SSFR_MUST ssfr_result ssfr_param_set(const ssfr_param *row, void *params, const char *key, const char *text);

/* Whether a struct that was not filled by ssfr_param_set holds to its rows' ranges; what: its name in error lines. */
SSFR_MUST ssfr_result ssfr_params_check(const ssfr_param *rows, const void *params, const char *what);

/* The value as text that ssfr_param_set reads back exactly. */
void ssfr_param_format(const ssfr_param *row, const void *params, char *text, size_t size);

/* The value as a number (a set as its bits). */
double ssfr_param_number(const ssfr_param *row, const void *params);

int ssfr_param_n_words(const ssfr_param *row);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json.h: writing JSON: nesting, commas, escapes; numbers that are not finite become null. */
#ifndef SSFR_JSON_H
#define SSFR_JSON_H

#include "base/base.h"

enum { SSFR_JSON_DEPTH = 32 };

typedef struct ssfr_json {
    FILE *file;
    int depth;                    /* open objects and arrays */
    char close[SSFR_JSON_DEPTH];  /* what closes each */
    bool filled[SSFR_JSON_DEPTH + 1]; /* a value was written at this depth: the next needs a comma */
} ssfr_json;

/* Values go to `file`, which the caller opens, checks for errors and closes. */
void ssfr_json_init(ssfr_json *json, FILE *file);

/* The key is NULL inside arrays and for the outermost value. */
void ssfr_json_object(ssfr_json *json, const char *key);
void ssfr_json_array(ssfr_json *json, const char *key);
void ssfr_json_close(ssfr_json *json); /* the innermost open object or array; a newline after the last */
void ssfr_json_text(ssfr_json *json, const char *key, const char *text); /* NULL becomes null */
void ssfr_json_number(ssfr_json *json, const char *key, double value);
void ssfr_json_integer(ssfr_json *json, const char *key, long long value);
void ssfr_json_flag(ssfr_json *json, const char *key, bool value);

#endif

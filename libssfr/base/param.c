/* SPDX-License-Identifier: MIT */
/* param.c: parameter rows: defaults, parsing with range checks, printing. */
#include "base/param.h"

static void store(const ssfr_param *row, void *params, double value)
{
    char *at = (char *)params + row->offset;
    if (row->type == SSFR_REAL) {
        memcpy(at, &value, sizeof value);
    } else if (row->type == SSFR_SET) {
        const unsigned bits = (unsigned)value;
        memcpy(at, &bits, sizeof bits);
    } else {
        const int number = (int)value;
        memcpy(at, &number, sizeof number);
    }
}

double ssfr_param_number(const ssfr_param *row, const void *params)
{
    const char *at = (const char *)params + row->offset;
    double real;
    int number;
    unsigned bits;
    switch (row->type) {
    case SSFR_REAL: memcpy(&real, at, sizeof real); return real;
    case SSFR_SET: memcpy(&bits, at, sizeof bits); return bits;
    default: memcpy(&number, at, sizeof number); return number;
    }
}

void ssfr_params_default(const ssfr_param *rows, void *params)
{
    for (const ssfr_param *row = rows; row && row->name; row++) store(row, params, row->def);
}

const ssfr_param *ssfr_param_find(const ssfr_param *rows, const char *name)
{
    const ssfr_param *found = NULL;
    for (const ssfr_param *row = rows; row && row->name && !found; row++)
        if (strcmp(row->name, name) == 0) found = row;
    return found;
}

int ssfr_param_n_words(const ssfr_param *row)
{
    int n = 0;
    while (row->words && row->words[n]) n++;
    return n;
}

static int find_word(const ssfr_param *row, const char *text, size_t length)
{
    int found = -1;
    for (int i = 0; row->words[i] && found < 0; i++)
        if (strlen(row->words[i]) == length && memcmp(row->words[i], text, length) == 0) found = i;
    return found;
}

static void list_words(const ssfr_param *row, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; row->words[i] && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", i ? ", " : "", row->words[i]);
}

static ssfr_result fail_words(const ssfr_param *row, const char *key, const char *text)
{
    char words[512];
    list_words(row, words, sizeof words);
    return ssfr_fail(SSFR_ERR_VALUE, "%s=%s: expected %s%s", key, text,
                     row->type == SSFR_SET ? "none or a comma-separated list of " : "one of ", words);
}

static ssfr_result parse_set(const ssfr_param *row, const char *key, const char *text, double *value)
{
    unsigned bits = 0;
    const char *at = strcmp(text, "none") == 0 ? NULL : text;
    while (at) {
        const size_t length = strcspn(at, ",");
        const int word = find_word(row, at, length);
        if (word < 0) return fail_words(row, key, text);
        if (bits >> word & 1u)
            return ssfr_fail(SSFR_ERR_VALUE, "%s=%s: %s stands in it twice", key, text, row->words[word]);
        bits |= 1u << word;
        at = at[length] ? at + length + 1 : NULL;
    }
    *value = bits;
    return SSFR_OK;
}

static ssfr_result parse_flag(const char *key, const char *text, double *value)
{
    static const char *const words[] = {"0", "1", "off", "on", "false", "true", "no", "yes"};
    for (size_t i = 0; i < SSFR_COUNT(words); i++)
        if (strcmp(words[i], text) == 0) {
            *value = (double)(i % 2);
            return SSFR_OK;
        }
    return ssfr_fail(SSFR_ERR_VALUE, "%s=%s: expected on or off", key, text);
}

static ssfr_result parse_number(const ssfr_param *row, const char *key, const char *text, double *value)
{
    if (!ssfr_parse_number(text, value))
        return ssfr_fail(SSFR_ERR_VALUE, "%s=%s: expected a finite number", key, text);
    if (row->type == SSFR_INT && *value != floor(*value))
        return ssfr_fail(SSFR_ERR_VALUE, "%s=%s: expected a whole number", key, text);
    if (*value < row->min || *value > row->max)
        return ssfr_fail(SSFR_ERR_VALUE, "%s=%s: out of range [%g, %g]%s%s", key, text, row->min, row->max,
                         strcmp(row->unit, "1") ? " " : "", strcmp(row->unit, "1") ? row->unit : "");
    return SSFR_OK;
}

ssfr_result ssfr_param_set(const ssfr_param *row, void *params, const char *key, const char *text)
{
    ssfr_result result = SSFR_OK;
    double value = 0;
    ssfr_plain plain = ssfr_plain_begin();
    switch (row->type) {
    case SSFR_FLAG: result = parse_flag(key, text, &value); break;
    case SSFR_SET: result = parse_set(row, key, text, &value); break;
    case SSFR_CHOICE:
        value = find_word(row, text, strlen(text));
        if (value < 0) result = fail_words(row, key, text);
        break;
    default: result = parse_number(row, key, text, &value); break;
    }
    ssfr_plain_end(&plain);
    if (result == SSFR_OK) store(row, params, value);
    return result;
}

/* The largest value that a row allows, as a number; the least of words and flags is 0. */
static double largest(const ssfr_param *row)
{
    switch (row->type) {
    case SSFR_FLAG: return 1;
    case SSFR_CHOICE: return ssfr_param_n_words(row) - 1;
    case SSFR_SET: return ldexp(1, ssfr_param_n_words(row)) - 1;
    default: return row->max;
    }
}

ssfr_result ssfr_params_check(const ssfr_param *rows, const void *params, const char *what)
{
    for (const ssfr_param *row = rows; row && row->name; row++) {
        const double value = ssfr_param_number(row, params), max = largest(row);
        const double min = row->type == SSFR_REAL || row->type == SSFR_INT ? row->min : 0;
        if (!(value >= min && value <= max))
            return ssfr_fail(SSFR_ERR_VALUE, "%s.%s=%g: out of range [%g, %g]", what, row->name, value, min, max);
    }
    return SSFR_OK;
}

/* The shortest decimal that reads back as the same double. */
static void format_real(double value, char *text, size_t size)
{
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, size, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
}

void ssfr_param_format(const ssfr_param *row, const void *params, char *text, size_t size)
{
    const double value = ssfr_param_number(row, params);
    size_t used = 0;
    ssfr_plain plain = ssfr_plain_begin();
    switch (row->type) {
    case SSFR_REAL: format_real(value, text, size); break;
    case SSFR_CHOICE: snprintf(text, size, "%s", row->words[(int)value]); break;
    case SSFR_SET:
        snprintf(text, size, "none");
        for (int i = 0; row->words[i] && used < size; i++)
            if ((unsigned)value >> i & 1u)
                used += (size_t)snprintf(text + used, size - used, "%s%s", used ? "," : "", row->words[i]);
        break;
    default: snprintf(text, size, "%d", (int)value); break;
    }
    ssfr_plain_end(&plain);
}

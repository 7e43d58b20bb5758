/* SPDX-License-Identifier: GPL-3.0-or-later */
/* corners.c: enumerating settings from parameter rows. */
#include "experiments/corners.h"

#include "base/param.h"

static bool choice_at(const ssfr_param *row, int k, char *text, size_t size)
{
    const int word = k < (int)row->def ? k : k + 1; /* the default is left out */
    if (word >= ssfr_param_n_words(row)) return false;
    snprintf(text, size, "%s=%s", row->name, row->words[word]);
    return true;
}

static bool set_at(const ssfr_param *row, int k, char *text, size_t size)
{
    const int n = ssfr_param_n_words(row);
    if (k > n) return false;
    size_t used = (size_t)snprintf(text, size, "%s=", row->name);
    for (int i = 0; i < n && used < size; i++)
        if (k == n || i == k)
            used += (size_t)snprintf(text + used, size - used, "%s%s", k == n && i ? "," : "", row->words[i]);
    return true;
}

static bool number_at(const ssfr_param *row, int k, char *text, size_t size)
{
    const double factors[] = {0.5, 2};
    double values[2];
    int n = 0;
    for (int i = 0; i < 2; i++) {
        double value = ssfr_clamp(factors[i] * row->def, row->min, row->max);
        if (row->type == SSFR_INT) value = floor(value);
        if (value != row->def) values[n++] = value;
    }
    if (k >= n) return false;
    snprintf(text, size, "%s=%.9g", row->name, values[k]);
    return true;
}

/* The k-th corner of one row. */
static bool row_at(const ssfr_param *row, int k, char *text, size_t size)
{
    switch (row->type) {
    case SSFR_CHOICE: return choice_at(row, k, text, size);
    case SSFR_SET: return set_at(row, k, text, size);
    case SSFR_FLAG:
        snprintf(text, size, "%s=%s", row->name, row->def != 0 ? "off" : "on");
        return k == 0;
    default: return number_at(row, k, text, size);
    }
}

bool ssfr_corner_at(const ssfr_pass *pass, int i, char *text, size_t size)
{
    bool found = i == 0;
    int left = i - 1;
    for (const ssfr_param *row = ssfr_pass_params(pass); row && row->name && !found; row++)
        for (int k = 0; !found && row_at(row, k, text, size); k++) found = left-- == 0;
    if (i == 0 || !found) text[0] = '\0';
    return found;
}

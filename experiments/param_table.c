/* SPDX-License-Identifier: GPL-3.0-or-later */
/* param_table.c: what a parameter row says, in cells. */
#include "experiments/param_table.h"

#include "base/param.h"

ssfr_result ssfr_param_table_begin(ssfr_table *table)
{
    static const char *const heads[] = {"PARAMETER", "UNIT", "VALUE", "RANGE", "HELP"};
    ssfr_table_init(table, SSFR_COUNT(heads));
    return ssfr_table_row(table, heads);
}

/* The row's default as the text that sets it. */
static void format_default(const ssfr_param *row, char *text, size_t size)
{
    ssfr_param alone[] = {*row, SSFR_PARAM_END};
    double storage = 0; /* as large and as aligned as any of a parameter's C types */
    alone[0].offset = 0;
    ssfr_params_default(alone, &storage);
    ssfr_param_format(alone, &storage, text, size);
}

static void format_range(const ssfr_param *row, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    if (row->type == SSFR_REAL || row->type == SSFR_INT) {
        snprintf(text, size, "[%.10g, %.10g]", row->min, row->max);
    } else if (row->type == SSFR_FLAG) {
        snprintf(text, size, "0|1");
    } else {
        const char *separator = row->type == SSFR_SET ? "," : "|";
        for (int i = 0; row->words[i] && used < size; i++)
            used += (size_t)snprintf(text + used, size - used, "%s%s", i ? separator : "", row->words[i]);
    }
}

ssfr_result ssfr_param_table_add(ssfr_table *table, const char *key, const ssfr_param *row, const char *value)
{
    char own[256], range[512];
    format_default(row, own, sizeof own);
    format_range(row, range, sizeof range);
    return ssfr_table_row(table, (const char *[]){key, row->unit, value ? value : own, range, row->help});
}

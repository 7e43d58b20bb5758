/* SPDX-License-Identifier: GPL-3.0-or-later */
/* columns.c: the measured columns by name, and headers with units. */
#include "experiments/columns.h"

const ssfr_column ssfr_columns[SSFR_N_COLUMNS + SSFR_N_COLUMN_TEXTS] = {
#define X(name, unit, better, help) {#name, unit, better, help},
#define T(name, help) {#name, "1", 0, help},
#include "experiments/columns.def"
#undef X
};

const ssfr_column *ssfr_column_find(const char *name)
{
    const ssfr_column *found = NULL;
    for (size_t i = 0; i < SSFR_COUNT(ssfr_columns) && !found; i++)
        if (strcmp(ssfr_columns[i].name, name) == 0) found = &ssfr_columns[i];
    return found;
}

/* "ms_median" and "angle_deg" carry their unit. */
static bool carries_unit(const char *name, const char *unit)
{
    const size_t n = strlen(name), u = strlen(unit);
    if (n <= u) return false;
    return (strncmp(name, unit, u) == 0 && name[u] == '_') ||
           (strcmp(name + n - u, unit) == 0 && name[n - u - 1] == '_');
}

void ssfr_column_header(const char *name, const char *unit, char *text, size_t size)
{
    const bool bare = strcmp(unit, "1") == 0 || carries_unit(name, unit);
    snprintf(text, size, bare ? "%s" : "%s [%s]", name, unit);
}

const char *ssfr_column_word(const char *name)
{
    static const char *const clear[] = {"pipeline", "variant", "scene", "camera", "backend"};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; i < SSFR_COUNT(clear); i++)
        if (strcmp(name, clear[i]) == 0) return "";
    return dot ? dot + 1 : name;
}

void ssfr_column_label(const ssfr_column *column, const char *header, char *text, size_t size)
{
    if (!column)
        snprintf(text, size, "%s", header);
    else if (strcmp(column->unit, "1") == 0)
        snprintf(text, size, "%s", column->help);
    else
        snprintf(text, size, "%s [%s]", column->help, column->unit);
}

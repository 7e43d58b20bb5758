/* SPDX-License-Identifier: GPL-3.0-or-later */
/* param_table.h: parameter rows as a table for people: key, unit, value, range, help. */
#ifndef SSFR_PARAM_TABLE_H
#define SSFR_PARAM_TABLE_H

#include "experiments/console.h"

/* The table's heading. */
SSFR_MUST ssfr_result ssfr_param_table_begin(ssfr_table *table);
/* One row; value NULL stands for the row's default. */
SSFR_MUST ssfr_result ssfr_param_table_add(ssfr_table *table, const char *key, const ssfr_param *row,
                                           const char *value);

#endif

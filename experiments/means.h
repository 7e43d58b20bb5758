/* SPDX-License-Identifier: GPL-3.0-or-later */
/* means.h: a table's means over one of its keys: "an average for a default camera movement". */
#ifndef SSFR_MEANS_H
#define SSFR_MEANS_H

#include "base/base.h"

/* Reads "dir/name.csv" and writes "dir/name_mean.csv": of all rows that differ in the key `over` alone one, with the
 * other keys, a status, a column `rows` that says how many were ok, and of each of these columns the mean over those;
 * what is no finite number does not count, and NaN stands where none is. */
SSFR_MUST ssfr_result ssfr_means_save(const char *table, const char *over, int n, const char *const *columns);

#endif

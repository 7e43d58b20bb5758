/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cache.h: what commands keep on disk from call to call: where it is, and that one process at a time writes it. */
#ifndef SSFR_CACHE_H
#define SSFR_CACHE_H

#include "base/base.h"

/* The folder of that kind: `given`, or when that is NULL ssfr/<kind> in $XDG_CACHE_HOME or ~/.cache. To free(). */
SSFR_MUST ssfr_result ssfr_cache_find(char **out, const char *given, const char *kind);

/* Makes the folder and those around it, where they are missing. */
SSFR_MUST ssfr_result ssfr_cache_make_folders(const char *path);

/* Opens the file at path, makes it when it is missing, and holds it until *fd is closed; fd is -1 unless SSFR_OK. Who
 * comes second waits, a signal that ssfr_interrupt_begin notes ends the wait; `what`: what the first makes. */
SSFR_MUST ssfr_result ssfr_cache_hold(const char *path, const char *what, int *fd);

#endif

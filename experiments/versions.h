/* SPDX-License-Identifier: GPL-3.0-or-later */
/* versions.h: the libraries that run, by name and version. */
#ifndef SSFR_VERSIONS_H
#define SSFR_VERSIONS_H

#include "base/base.h"

typedef struct ssfr_library {
    const char *name; /* NULL past the end */
    char version[32];
} ssfr_library;

ssfr_library ssfr_library_at(int i);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* embedded.h: the files of experiments/scenes inside the binary, so that `ssfr` needs none where it is installed. */
#ifndef SSFR_EMBEDDED_H
#define SSFR_EMBEDDED_H

#include "base/base.h"

typedef struct ssfr_embedded {
    const char *name;        /* the path in experiments/scenes: "bagar2010/waterfall.yaml" */
    const char *begin, *end; /* its bytes, and a zero byte at end: a text file is a string */
} ssfr_embedded;

/* In the order of their names; NULL past the end. */
const ssfr_embedded *ssfr_embedded_at(int i);
const ssfr_embedded *ssfr_embedded_find(const char *name); /* NULL when there is none */

SSFR_MUST ssfr_result ssfr_embedded_particles(ssfr_particles **out, const char *name);
SSFR_MUST ssfr_result ssfr_embedded_mesh(ssfr_mesh **out, const char *name); /* also as an ssfr_mesh_loader */

#endif

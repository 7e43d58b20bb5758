/* SPDX-License-Identifier: MIT */
/* sparse.h: how large particles of thin fluid are drawn; see sparse.c. */
#ifndef SSFR_SPARSE_H
#define SSFR_SPARSE_H

#include "graph/pass.h"

typedef struct ssfr_sparse_params {
    double density_threshold; /* kg/m^3 */
    double point_shrink;
    int by_foam;
} ssfr_sparse_params;

ssfr_result ssfr_sparse_run(const ssfr_run *run);

#endif

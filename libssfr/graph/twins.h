/* SPDX-License-Identifier: MIT */
/* twins.h: both twins of a pass on the same input. */
#ifndef SSFR_TWINS_H
#define SSFR_TWINS_H

#include "graph/graph.h"

typedef struct ssfr_twins_row { /* one output */
    const char *output;         /* port */
    double max_abs;             /* largest |gl - cpu| where both are surfaces or plain values */
    double outliers;            /* share of values outside the tolerance, [0, 1] */
    long n_nan;                 /* values of either twin that are not finite */
    ssfr_tolerance tolerance;
    bool ok;                    /* no NaN, and no more outliers than the tolerance allows */
    ssfr_field *reference, *measured; /* the CPU twin's and the GPU twin's output, owned by the row */
} ssfr_twins_row;

typedef struct ssfr_twins ssfr_twins;

/* Makes what the pass reads once, for any number of comparisons: the first pipeline with this pass does, of the scene,
 * on the CPU. inputs: "node.param=value" of that pipeline, NULL-terminated, or NULL. The scene and gl must outlive it. */
SSFR_MUST ssfr_result ssfr_twins_create(ssfr_twins **out, const ssfr_pass *pass, const ssfr_scene *scene, ssfr_gl *gl,
                                        const char *const *inputs);
void ssfr_twins_destroy(ssfr_twins **twins);

/* Runs the pass on the CPU and the GPU, both on these inputs, rounded as the GPU holds them. settings: "param=value" of
 * the pass, NULL-terminated, or NULL. Fills n_rows rows, one an output; free them with ssfr_twins_finish, also after an
 * error. */
SSFR_MUST ssfr_result ssfr_twins_compare(const ssfr_twins *twins, const char *const *settings,
                                         ssfr_twins_row rows[SSFR_MAX_OUTPUTS], int *n_rows);
/* How far the twins of a pass may part, after a run with its parameters and coefficients. */
ssfr_tolerance ssfr_twins_tolerance(const ssfr_pass *pass, const ssfr_run *run);

void ssfr_twins_finish(ssfr_twins_row rows[SSFR_MAX_OUTPUTS], int n_rows);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shot.h: a shot is what stays of a frame to be compared: colour, depth, normal and thickness. */
#ifndef SSFR_SHOT_H
#define SSFR_SHOT_H

#include "experiments/columns.h"

typedef enum ssfr_shot_part {
    SSFR_SHOT_COLOUR,
    SSFR_SHOT_DEPTH,
    SSFR_SHOT_NORMAL,
    SSFR_SHOT_THICKNESS,
    SSFR_SHOT_PARTS
} ssfr_shot_part;

typedef struct ssfr_shot {
    ssfr_field *parts[SSFR_SHOT_PARTS]; /* NULL where the pipeline has no such image, and the truth was not cast */
} ssfr_shot;

/* Wants the result, and with `all` depth, normal and thickness beside it, and nothing else. */
SSFR_MUST ssfr_result ssfr_shot_want(ssfr_graph *graph, const ssfr_pipeline *pipeline, bool all);
/* Reads the graph's last frame, w x h px. */
SSFR_MUST ssfr_result ssfr_shot_take(ssfr_shot *shot, const ssfr_graph *graph, const ssfr_pipeline *pipeline, int w,
                                     int h);
void ssfr_shot_finish(ssfr_shot *shot);

/* Fill the columns nan_count, twin_*, method_* and ref_* of values; radius: of the particles, m, 0 for none. */
SSFR_MUST ssfr_result ssfr_shot_count_nan(const ssfr_shot *shot, double values[SSFR_N_COLUMNS]);
SSFR_MUST ssfr_result ssfr_shot_compare_twin(const ssfr_shot *shot, const ssfr_shot *twin,
                                             double values[SSFR_N_COLUMNS]);
SSFR_MUST ssfr_result ssfr_shot_compare_method(const ssfr_shot *twin, const ssfr_shot *reference,
                                               double values[SSFR_N_COLUMNS]);
SSFR_MUST ssfr_result ssfr_shot_compare_reference(const ssfr_shot *shot, const ssfr_shot *reference, double radius,
                                                  double values[SSFR_N_COLUMNS]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rig_truth.h: ground truth as the reference of a sweep: its parameters in a run, and its images as a shot. */
#ifndef SSFR_RIG_TRUTH_H
#define SSFR_RIG_TRUTH_H

#include "experiments/shot.h"
#include "experiments/sweep_spec.h"
#include "experiments/truth/truth.h"

/* The row of a parameter of truth, "truth.level" or "medium.ior"; NULL when there is none. */
const ssfr_param *ssfr_rig_truth_row(const char *key);

/* The defaults, but that colour and foam are not cast, which cost more than all else. Then what the scene, the spec and
 * the variant set; scene and variant may be NULL. */
SSFR_MUST ssfr_result ssfr_rig_truth_params(ssfr_truth_params *out, const ssfr_sweep_spec *spec,
                                            const ssfr_variant *variant, const ssfr_description *scene);
/* Sets what the axes say of truth in a run. */
SSFR_MUST ssfr_result ssfr_rig_truth_vary(ssfr_truth_params *params, const ssfr_sweep_spec *spec,
                                          const size_t index[SSFR_MAX_AXES]);

/* A shot of the truth; fills the columns truth_* of values. */
SSFR_MUST ssfr_result ssfr_rig_truth_cast(ssfr_shot *out, double values[SSFR_N_COLUMNS], const ssfr_stage *stage,
                                          const ssfr_truth_params *params, const ssfr_truth_options *options);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truth_file.h: ground truth as files: an EXR with its errors, and a picture to look at. */
#ifndef SSFR_TRUTH_FILE_H
#define SSFR_TRUTH_FILE_H

#include "experiments/record.h"
#include "experiments/truth/truth.h"

/* Every parameter, what casting took, and the version. */
SSFR_MUST ssfr_result ssfr_truth_record(ssfr_record *record, const ssfr_truth *truth, const ssfr_truth_params *params);

/* All channels as 32-bit floats; the bounds grow by what that changes, so that they hold for the file. */
SSFR_MUST ssfr_result ssfr_truth_save(const char *path, const ssfr_truth *truth, const ssfr_record *record);

/* A PNG of the first of these that is there: the colour, the normals as a lamp beside the eye lights them, the
 * thickness, the foam. A pixel that was not cast shows that of its square. */
SSFR_MUST ssfr_result ssfr_truth_preview(const char *path, const ssfr_truth *truth);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truths.h: what tests of ground truth share: stages of a few particles, and casting them. */
#ifndef SSFR_TESTS_TRUTHS_H
#define SSFR_TESTS_TRUTHS_H

#include "experiments/truth/truth.h"
#include "tests/util.h"

/* Particles at positions[3 n] (m) seen from eye towards target, fov 40 degrees; no solids, no floor. */
ssfr_stage *test_truth_stage(size_t n, const double *positions, double radius, const double eye[3],
                             const double target[3], int w, int h);
/* A scene by name, w x h px. */
ssfr_stage *test_truth_scene(const char *name, int w, int h);

/* The defaults, then a NULL-terminated list of key, value. */
ssfr_truth_params test_truth_params(const char *const *settings);

/* Casts all pixels without a cache. */
ssfr_truth *test_truth_cast(const ssfr_stage *stage, const ssfr_truth_params *params);

/* A channel of a pixel. */
const double *test_truth_at(const ssfr_truth *truth, ssfr_truth_channel channel, int x, int y);

/* From a place in a box towards another. */
ssfr_ray test_truth_ray(uint64_t *seed, double extent);

/* All channels have the same bits. */
bool test_truth_same(const ssfr_truth *a, const ssfr_truth *b);
/* No value is NaN or infinite, no bound negative. */
void test_truth_check_finite(const ssfr_truth *truth);

#endif

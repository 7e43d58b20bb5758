/* SPDX-License-Identifier: GPL-3.0-or-later */
/* corners.h: the settings of a pass that its twins are compared at, one parameter away from the defaults each. */
#ifndef SSFR_CORNERS_H
#define SSFR_CORNERS_H

#include "base/base.h"

/* The i-th corner as "param=value", in text[size]: 0 is "", all defaults; then each other word of a choice, each word
 * of a set and all of them, the other state of a flag, half and twice a number within its range. False past the end. */
bool ssfr_corner_at(const ssfr_pass *pass, int i, char *text, size_t size);

#endif

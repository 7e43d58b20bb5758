/* SPDX-License-Identifier: MIT */
/* foam_depth.h: the frontmost foam; see foam_depth.c. */
#ifndef SSFR_FOAM_DEPTH_H
#define SSFR_FOAM_DEPTH_H

#include "passes/streak.h"

void ssfr_foam_depth_cpu(const ssfr_run *run);

#endif

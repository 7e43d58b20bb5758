/* SPDX-License-Identifier: MIT */
/* background.h: the scene without the fluid; see background.c. */
#ifndef SSFR_BACKGROUND_H
#define SSFR_BACKGROUND_H

#include "graph/pass.h"

void ssfr_background_cpu(const ssfr_run *run);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* embedded.h: the particle files of experiments/scenes/data inside the binary. */
#ifndef SSFR_EMBEDDED_H
#define SSFR_EMBEDDED_H

#include "base/base.h"

/* Loads a file by its name in experiments/scenes/data. */
SSFR_MUST ssfr_result ssfr_embedded_load(ssfr_particles **out, const char *name);

#endif

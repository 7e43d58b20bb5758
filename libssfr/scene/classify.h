/* SPDX-License-Identifier: MIT */
/* classify.h: what the ways of telling foam, spray and splashes from water share. */
#ifndef SSFR_CLASSIFY_H
#define SSFR_CLASSIFY_H

#include "base/param.h"

/* Fails where there are particles but no such array; why: what it is needed for. */
SSFR_MUST ssfr_result ssfr_particles_need(const ssfr_particles *particles, const char *array, const char *why);

extern const ssfr_param ssfr_weber_rows[];

/* As after ssfr_weber_create, with parameters that hold to their rows, but for the memory, which is kept. */
void ssfr_weber_restart(ssfr_weber *weber, const ssfr_weber_params *params);

#endif

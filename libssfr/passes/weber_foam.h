/* SPDX-License-Identifier: MIT */
/* weber_foam.h: how much of a particle is foam; see weber_foam.c. */
#ifndef SSFR_WEBER_FOAM_H
#define SSFR_WEBER_FOAM_H

#include "graph/pass.h"

typedef struct ssfr_weber_foam_state { /* from frame to frame */
    ssfr_weber *weber;
    bool named; /* the last frame's particles had ids */
} ssfr_weber_foam_state;

ssfr_result ssfr_weber_foam_run(const ssfr_run *run);

#endif

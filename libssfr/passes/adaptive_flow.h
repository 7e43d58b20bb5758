/* SPDX-License-Identifier: MIT */
/* adaptive_flow.h: curvature flow whose number of steps follows from the distance; see adaptive_flow.c. */
#ifndef SSFR_ADAPTIVE_FLOW_H
#define SSFR_ADAPTIVE_FLOW_H

#include "passes/curvature_flow.h"

/* What is the same at every distance. shaders/adaptive_flow.frag repeats them. */
enum { SSFR_ADAPTIVE_FLOW_PAPER, SSFR_ADAPTIVE_FLOW_METRES, SSFR_ADAPTIVE_FLOW_STEPS };
/* How the end is found. */
enum { SSFR_ADAPTIVE_FLOW_NONE, SSFR_ADAPTIVE_FLOW_QUERY, SSFR_ADAPTIVE_FLOW_BOUND,
       SSFR_ADAPTIVE_FLOW_TILES };

typedef struct ssfr_adaptive_flow_done { /* by the last run, for its report */
    int sweeps, copies;
} ssfr_adaptive_flow_done;

typedef struct ssfr_adaptive_flow_coeffs {
    ssfr_curvature_flow_coeffs flow; /* its iterations: the most steps that any pixel takes */
    double need; /* of a surface at 1 m: r_s (PAPER), or the sum of its dt (METRES) */
    int constant, by_first, stop, copy;
    int interval;     /* sweeps from one query to the next */
    int sweeps;       /* at most */
    ssfr_adaptive_flow_done done, *at; /* at: done, which a run may write */
} ssfr_adaptive_flow_coeffs;

/* Whether the run asks after sweep i whether it changed anything. */
static inline bool ssfr_adaptive_flow_asks(const ssfr_adaptive_flow_coeffs *c, int i)
{
    return c->stop == SSFR_ADAPTIVE_FLOW_QUERY && i % c->interval == c->interval - 1;
}

/* How many steps a pixel takes that keeps the depth which it has before the first. */
int ssfr_adaptive_flow_steps(const ssfr_run *run, int x, int y);

void ssfr_adaptive_flow_cpu(const ssfr_run *run);

#endif

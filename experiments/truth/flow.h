/* SPDX-License-Identifier: GPL-3.0-or-later */
/* flow.h: the curvature flow without steps: the pixels of a depth image as one system of ordinary differential
 * equations, z' = the rate of the pass curvature_flow, solved by gsl_odeiv2 to a tolerance.
 *
 * The pass itself takes Euler steps; what they do beyond the flow is their error.
 *
 * The rate jumps where a step between two pixels passes the falloff. No solver's order survives that, so the cuts of a
 * pixel stay as they are during a step, and a step ends where one of them would change: the crossing is located to the
 * tolerance, then the next step starts with the new cuts. Where both rates lead back to the crossing there is no smooth
 * way on: then the pixel's cuts change only at multiples of a 1024th of the whole time (msbdf: a 64th), and err says
 * what that costs. So do all cuts once half of the steps that a run may take are used up. A cut that comes and goes
 * within one step is not seen. */
#ifndef SSFR_TRUTH_FLOW_H
#define SSFR_TRUTH_FLOW_H

#include "graph/pass.h"

typedef enum ssfr_flow_method {
    SSFR_FLOW_RK8PD, /* explicit Prince-Dormand 8(9); up to SSFR_FLOW_RK8PD_SIDE^2 pixels */
    SSFR_FLOW_MSBDF, /* implicit multistep BDF with the Jacobian, whose matrix is dense; up to SSFR_FLOW_MSBDF_SIDE^2 */
    SSFR_N_FLOWS
} ssfr_flow_method;

extern const char *const ssfr_flow_names[]; /* NULL-terminated */

enum { SSFR_FLOW_RK8PD_SIDE = 128, SSFR_FLOW_MSBDF_SIDE = 24 };
#define SSFR_FLOW_TOLERANCE 1e-10

typedef struct ssfr_flow_report {
    double time;        /* m^2, the end time: iterations times dt of the pass */
    double reached;     /* m^2, where it ended: before `time` when the steps that a run may take were used up */
    size_t unknowns;    /* pixels with a surface */
    size_t steps, failed, evaluations, jacobians;
    size_t crossings;   /* steps that ended because a cut came or went */
    size_t flickers;    /* of them those whose crossing was not located, because it had been there a moment ago */
    double err;         /* m, estimate: the largest difference to the same at ten times the tolerance (and flicker) */
} ssfr_flow_report;

/* Smooths the depth of run->in[0] into run->out[0] as the pass would with infinitely many, infinitely small steps of
 * the same sum. The run is one of that pass: its coefficients say how edges are treated. tolerance: relative and, times
 * the nearest depth, absolute; 1e-10. Where the per-pixel limit of dt binds, the flow is that of each pixel's own time.
 * Fails for more pixels with a surface than the method takes. When the steps are used up, err is infinite. The work is
 * bounded: the largest images of nothing but cliffs take rk8pd two minutes of one core, msbdf 20 s. A progress bar is
 * shown. */
SSFR_MUST ssfr_result ssfr_flow_run(const ssfr_run *run, ssfr_flow_method method, double tolerance,
                                    ssfr_flow_report *report);

/* The derivatives of the rates (m a step of the pass) of all pixels with a surface, in the order of rows, by their
 * depths: an n x n matrix, rows after each other, to be freed. */
SSFR_MUST ssfr_result ssfr_flow_jacobian(const ssfr_run *run, size_t *n, double **out);

#endif

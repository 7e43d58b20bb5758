/* SPDX-License-Identifier: GPL-3.0-or-later */
/* flow.h: the curvature flow without steps: the pixels of a depth image as one system of ordinary differential equations,
 * z' = the rate of the pass curvature_flow, solved by gsl_odeiv2 to a tolerance.
 *
 * The pass itself takes Euler steps; what they do beyond the flow is their error. */
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

typedef struct ssfr_flow_report {
    double time;        /* m^2, the end time: iterations times dt of the pass */
    size_t unknowns;    /* pixels with a surface */
    size_t steps, failed, evaluations, jacobians;
    double err;         /* m, estimate: the largest difference to the same at ten times the tolerance */
} ssfr_flow_report;

/* Smooths the depth of run->in[0] into run->out[0] as the pass would with infinitely many, infinitely small steps of the
 * same sum. The run is one of that pass: its coefficients say how edges are treated. tolerance: relative and, times
 * the nearest depth, absolute; 1e-10. Where the per-pixel limit of dt binds, the flow is that of each pixel's own time. */
SSFR_MUST ssfr_result ssfr_flow_run(const ssfr_run *run, ssfr_flow_method method, double tolerance,
                                    ssfr_flow_report *report);

#endif

/* SPDX-License-Identifier: MIT */
/* run.h: the metrics' functions, as metrics.def names them. */
#ifndef SSFR_METRICS_RUN_H
#define SSFR_METRICS_RUN_H

#include "metrics/tally.h"

#define X(name, kind, form, visit, unit, help) \
    void ssfr_visit_##visit(const ssfr_pair *pair, int x, int y, ssfr_tally *tally);
#define W(name, kind, unit, help) ssfr_result ssfr_metric_run_##name(const ssfr_pair *pair, double *out);
#include "metrics/metrics.def"
#undef X
#undef W

#endif

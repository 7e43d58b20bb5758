/* SPDX-License-Identifier: MIT */
/* run.h: the metrics' functions, one a line of metrics.def. */
#ifndef SSFR_METRICS_RUN_H
#define SSFR_METRICS_RUN_H

#include "metrics/metrics.h"

#define X(name, kind, unit, help) ssfr_result ssfr_metric_run_##name(const ssfr_pair *pair, double *out);
#include "metrics/metrics.def"
#undef X

#endif

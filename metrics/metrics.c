/* SPDX-License-Identifier: MIT */
/* metrics.c: the list of metrics, and the checks before one is measured. */
#include "metrics/metrics.h"

#include "base/base.h"
#include "metrics/run.h"
#include "metrics/tally.h"

static const ssfr_metric metrics[] = {
#define X(name, kind, unit, help) {#name, unit, help, SSFR_METRIC_##kind, ssfr_metric_run_##name},
#include "metrics/metrics.def"
#undef X
};

const ssfr_metric *ssfr_metric_at(int i)
{
    return i >= 0 && (size_t)i < SSFR_COUNT(metrics) ? &metrics[i] : NULL;
}

const ssfr_metric *ssfr_metric_find(const char *name)
{
    const ssfr_metric *found = NULL;
    for (size_t i = 0; i < SSFR_COUNT(metrics) && !found; i++)
        if (strcmp(metrics[i].name, name) == 0) found = &metrics[i];
    return found;
}

const char *ssfr_metric_kind_name(ssfr_metric_kind kind)
{
    static const char *const names[] = {[SSFR_METRIC_ANY] = "any", [SSFR_METRIC_DEPTH] = "depth",
                                        [SSFR_METRIC_NORMAL] = "normal", [SSFR_METRIC_COLOUR] = "colour"};
    return names[kind];
}

ssfr_result ssfr_metric_measure(const ssfr_metric *metric, const ssfr_field *a, const ssfr_field *b,
                                const ssfr_field *mask, double *out)
{
    const ssfr_pair pair = {a, b, mask};
    const ssfr_result result = ssfr_pair_check(&pair, metric->name, metric->kind);
    if (result != SSFR_OK) return result;
    return metric->run(&pair, out);
}

/* SPDX-License-Identifier: MIT */
/* metrics.c: the list of metrics, and the checks before one is measured. */
#include "metrics/metrics.h"

#include "base/base.h"
#include "metrics/run.h"

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

static bool channels_fit(ssfr_metric_kind kind, int c)
{
    switch (kind) {
    case SSFR_METRIC_DEPTH: return c == 1;
    case SSFR_METRIC_NORMAL: return c == 3;
    case SSFR_METRIC_COLOUR: return c == 1 || c == 3;
    default: return true;
    }
}

ssfr_result ssfr_metric_measure(const ssfr_metric *metric, const ssfr_field *a, const ssfr_field *b,
                                const ssfr_field *mask, double *out)
{
    const ssfr_pair pair = {a, b, mask};
    if (a->w != b->w || a->h != b->h || a->c != b->c)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %d x %d pixels of %d channels against %d x %d of %d", metric->name, a->w,
                         a->h, a->c, b->w, b->h, b->c);
    if (!channels_fit(metric->kind, a->c))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %d channels do not make a %s image", metric->name, a->c,
                         ssfr_metric_kind_name(metric->kind));
    if (mask && (mask->w != a->w || mask->h != a->h || mask->c != 1))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: a mask of %d x %d pixels and %d channels for %d x %d pixels",
                         metric->name, mask->w, mask->h, mask->c, a->w, a->h);
    return metric->run(&pair, out);
}

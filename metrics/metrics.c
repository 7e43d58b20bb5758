/* SPDX-License-Identifier: MIT */
/* metrics.c: the list of metrics, and the checks before one is measured. */
#include "metrics/metrics.h"

#include "base/base.h"
#include "metrics/run.h"
#include "metrics/tally.h"

static const ssfr_metric metrics[] = {
#define X(name, kind, form, visit, unit, help) \
    {#name, unit, help, SSFR_METRIC_##kind, SSFR_FORM_##form, ssfr_visit_##visit, NULL},
#define W(name, kind, unit, help) \
    {#name, unit, help, SSFR_METRIC_##kind, SSFR_FORM_WHOLE, NULL, ssfr_metric_run_##name},
#include "metrics/metrics.def"
#undef X
#undef W
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

double ssfr_metric_of_mean(const ssfr_metric *metric, double mean)
{
    switch (metric->form) {
    case SSFR_FORM_RMS: return sqrt(mean);
    case SSFR_FORM_PSNR: return -10 * log10(mean);
    default: return mean;
    }
}

ssfr_result ssfr_metric_measure_pair(const ssfr_metric *metric, const ssfr_pair *pair, double *out)
{
    ssfr_result result = SSFR_OK;
    ssfr_tally tally;
    SSFR_TRY(ssfr_pair_check(pair, metric->name, metric->kind));
    if (metric->form == SSFR_FORM_WHOLE) return metric->run(pair, out);
    SSFR_TRY(ssfr_tally_pixels(pair, metric->visit, &tally));
    switch (metric->form) {
    case SSFR_FORM_MAX: *out = tally.n ? tally.max : (double)NAN; break;
    case SSFR_FORM_COUNT: *out = (double)tally.n; break;
    default: *out = ssfr_metric_of_mean(metric, ssfr_tally_mean(&tally, metric->form)); break;
    }
end:
    return result;
}

ssfr_result ssfr_metric_measure(const ssfr_metric *metric, const ssfr_field *a, const ssfr_field *b,
                                const ssfr_field *mask, double *out)
{
    return ssfr_metric_measure_pair(metric, &(ssfr_pair){.a = a, .b = b, .mask = mask}, out);
}

/* ---- samples ----------------------------------------------------------------------------------------------------- */

bool ssfr_metric_is_mean(const ssfr_metric *metric)
{
    return metric->form < SSFR_FORM_MAX;
}

void ssfr_metric_at_pixel(const ssfr_metric *metric, const ssfr_pair *pair, int x, int y, double *sum, double *n)
{
    ssfr_tally tally = {0};
    if (ssfr_pair_counts(pair, x, y)) metric->visit(pair, x, y, &tally);
    *n = (double)tally.n;
    *sum = tally.n ? ssfr_tally_mean(&tally, metric->form) * *n : 0;
}

bool ssfr_metric_counts(ssfr_metric_kind kind, const ssfr_pair *pair, int x, int y)
{
    ssfr_tally tally = {.n = 1};
    if (kind == SSFR_METRIC_DEPTH || kind == SSFR_METRIC_NORMAL) tally.n = 0;
    if (kind == SSFR_METRIC_DEPTH) ssfr_visit_depth(pair, x, y, &tally);
    if (kind == SSFR_METRIC_NORMAL) ssfr_visit_normal(pair, x, y, &tally);
    return tally.n > 0;
}

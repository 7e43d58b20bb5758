/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spline.c: curves of several channels by GSL's natural cubic splines. */
#include "experiments/scenes/spline.h"

#include <gsl/gsl_spline.h>

struct ssfr_curve {
    size_t n_channels;
    double first, last; /* s */
    gsl_spline **channels;
};

ssfr_result ssfr_curve_create(ssfr_curve **out, size_t n_channels, size_t n, const double *times,
                              const double *values)
{
    ssfr_result result = SSFR_OK;
    ssfr_curve *c = NULL;
    double *channel = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&c, 1, sizeof *c, "a curve"));
    SSFR_TRY(ssfr_alloc(&c->channels, n_channels, sizeof(gsl_spline *), "a curve"));
    SSFR_TRY(ssfr_alloc(&channel, n, sizeof *channel, "a curve"));
    c->n_channels = n_channels;
    c->first = times[0];
    c->last = times[n - 1];
    for (size_t k = 0; k < n_channels; k++) {
        c->channels[k] = gsl_spline_alloc(n < 3 ? gsl_interp_linear : gsl_interp_cspline, n);
        if (!c->channels[k]) {
            result = ssfr_fail(SSFR_ERR_MEMORY, "no memory for a curve through %zu points", n);
            goto end;
        }
        for (size_t i = 0; i < n; i++) channel[i] = values[i * n_channels + k];
        gsl_spline_init(c->channels[k], times, channel, n);
    }
    *out = c;
    c = NULL;
end:
    free(channel);
    ssfr_curve_destroy(&c);
    return result;
}

void ssfr_curve_destroy(ssfr_curve **curve)
{
    ssfr_curve *c = *curve;
    if (!c) return;
    for (size_t k = 0; k < c->n_channels; k++)
        if (c->channels[k]) gsl_spline_free(c->channels[k]);
    free(c->channels);
    free(c);
    *curve = NULL;
}

void ssfr_curve_at(const ssfr_curve *curve, double time, double *values)
{
    const double t = ssfr_clamp(time, curve->first, curve->last);
    for (size_t k = 0; k < curve->n_channels; k++) values[k] = gsl_spline_eval(curve->channels[k], t, NULL);
}

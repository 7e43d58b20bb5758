/* SPDX-License-Identifier: MIT */
/* upsample_cpu.c: a weighted mean of the low-resolution depths that belong to the pixel's own surface, in double. */
#include "passes/upsample.h"

/* Weights along one axis for a place t in [0, 1) after the second of four neighbours (cubic) or the first of two. */
static void weigh(int filter, double t, double w[4])
{
    if (filter == 2) { /* uniform cubic B-spline */
        w[0] = (1 - t) * (1 - t) * (1 - t) / 6;
        w[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
        w[2] = (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6;
        w[3] = t * t * t / 6;
    } else {
        w[0] = 1 - t, w[1] = t;
    }
}

/* Relative to the guide, so that a constant depth comes back to the last bit. */
static double interpolate(const ssfr_field *low, double guide, double x, double y, const ssfr_upsample_coeffs *c)
{
    const int n = c->filter == 2 ? 4 : 2, before = c->filter == 2 ? 1 : 0;
    const int x0 = (int)floor(x), y0 = (int)floor(y);
    double wx[4], wy[4], sum = 0, weight = 0;
    weigh(c->filter, x - x0, wx), weigh(c->filter, y - y0, wy);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            const double z = *ssfr_field_fetch(low, x0 - before + i, y0 - before + j);
            if (!ssfr_is_surface(z) || fabs(z - guide) > c->falloff) continue;
            sum += wx[i] * wy[j] * (z - guide);
            weight += wx[i] * wy[j];
        }
    return weight > 0 ? guide + sum / weight : guide;
}

void ssfr_upsample_cpu(const ssfr_run *run)
{
    const ssfr_upsample_coeffs *c = run->coeffs;
    const double n = c->factor;
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) {
            const double guide = *ssfr_field_fetch(run->in[1], x, y);
            double z = guide;
            if (!ssfr_is_surface(guide)) continue;
            if (c->filter == 0) z = *ssfr_field_fetch(run->in[0], x / c->factor, y / c->factor);
            else z = interpolate(run->in[0], guide, (x + 0.5) / n - 0.5, (y + 0.5) / n - 0.5, c);
            *ssfr_field_at(run->out[0], x, y) = ssfr_is_surface(z) ? z : guide;
        }
}

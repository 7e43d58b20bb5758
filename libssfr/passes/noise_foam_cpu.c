/* SPDX-License-Identifier: MIT */
/* noise_foam_cpu.c: foam by the magnitude of the surface noise, in double. */
#include "passes/environment.h"
#include "passes/noise_foam.h"

/* Smoothstep from the threshold on; softness 0 is a step. Noise that is not a number makes no foam. */
static double coverage(const ssfr_noise_foam_coeffs *c, double noise)
{
    const double above = fabs(noise) - c->threshold;
    if (!(above > 0)) return 0;
    const double s = above < c->softness ? above / c->softness : 1;
    return c->strength * s * s * (3 - 2 * s);
}

/* Where there is no foam no bit changes. */
static void pixel(const ssfr_run *run, int x, int y, double color[3])
{
    const ssfr_noise_foam_coeffs *c = run->coeffs;
    const double weight = coverage(c, *ssfr_field_fetch(run->in[1], x, y));
    double normal[3];
    if (!ssfr_is_surface(*ssfr_field_fetch(run->in[2], x, y)) || weight == 0) return;
    ssfr_world_from_eye(&run->frame->block, ssfr_field_fetch(run->in[3], x, y), normal);
    const double light = ssfr_environment_lambert(&run->frame->block, normal);
    const double left = c->blend == SSFR_FOAM_OVER ? 1 - weight : 1;
    for (int k = 0; k < 3; k++) color[k] = left * color[k] + weight * light * c->color[k];
}

void ssfr_noise_foam_cpu(const ssfr_run *run)
{
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) pixel(run, x, y, ssfr_field_at(run->out[0], x, y));
}

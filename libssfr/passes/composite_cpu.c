/* SPDX-License-Identifier: MIT */
/* composite_cpu.c: refraction, attenuation, reflection and highlight of one surface, in double. */
#include "passes/composite.h"

static double fresnel(const ssfr_surface *s, const ssfr_composite_coeffs *c)
{
    const double one = 1 - s->cosine;
    if (c->fresnel == SSFR_FRESNEL_SCHLICK) return c->r0 + (1 - c->r0) * one * one * one * one * one;
    return ssfr_surface_fresnel(s);
}

/* Where the light from behind the fluid comes from, as a shift in pixels. */
static void shift(const ssfr_surface *s, const ssfr_composite_coeffs *c, double thickness, double d[2])
{
    const double *image = s->block->image, eta = 1 / s->block->absorption[3];
    if (c->refraction == SSFR_REFRACTION_OFFSET) {
        const double beta = c->optics.gamma * thickness * image[1];
        d[0] = beta * s->n[0], d[1] = -beta * s->n[1];
    } else {
        const double bend = eta * s->cosine - sqrt(1 - eta * eta * (1 - s->cosine * s->cosine));
        double q[3];
        for (int k = 0; k < 3; k++) q[k] = s->position[k] + thickness * (bend * s->n[k] - eta * s->view[k]);
        q[2] = fmin(q[2], -s->run->frame->near);
        d[0] = (q[0] / -q[2] - s->position[0] / -s->z) / image[2];
        d[1] = -(q[1] / -q[2] - s->position[1] / -s->z) / image[3];
    }
}

static void pixel(const ssfr_run *run, int x, int y, double out[3])
{
    const ssfr_composite_coeffs *c = run->coeffs;
    const ssfr_surface s = ssfr_surface_at(run, x, y);
    const double thickness = ssfr_optics_value(run->in[SSFR_OPTICS_INPUTS], x, y, SSFR_THICKEST);
    double d[2], behind[3], through[3], mirrored[3];
    if (!ssfr_is_surface(s.z)) return; /* the scene shows */
    const double f = fresnel(&s, c), shine = ssfr_surface_highlight(&s);
    shift(&s, c, thickness, d);
    ssfr_surface_refracted(&s, d, behind);
    ssfr_surface_through(&s, thickness, through);
    ssfr_surface_reflected(&s, mirrored);
    for (int k = 0; k < 3; k++)
        out[k] = ssfr_mix(ssfr_mix(s.block->fluid[k], behind[k], through[k]), mirrored[k], f) + shine;
}

void ssfr_composite_cpu(const ssfr_run *run)
{
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) pixel(run, x, y, ssfr_field_at(run->out[0], x, y));
}

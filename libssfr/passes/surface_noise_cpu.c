/* SPDX-License-Identifier: MIT */
/* surface_noise_cpu.c: gradient noise on each particle's sprite, summed, in double. */
#include "passes/perlin.h"
#include "passes/surface_noise.h"

static void add(const ssfr_run *run, const ssfr_fragment *f, double *pixel)
{
    const ssfr_surface_noise_coeffs *c = run->coeffs;
    const ssfr_particles *p = run->frame->particles;
    const double surface = *ssfr_field_fetch(run->in[0], f->x, f->y);
    const uint32_t seed = p->id ? p->id[f->particle] : (uint32_t)f->particle;
    if (!ssfr_is_surface(surface)) return;
    const double below = fmax(surface - f->front, 0);
    const double weight = exp(-c->sharpness * f->r2 - c->falloff * below);
    *pixel += weight * ssfr_perlin_2d(c->frequency * f->a, c->frequency * f->b, seed);
}

void ssfr_surface_noise_cpu(const ssfr_run *run)
{
    ssfr_splat_cpu(run, add);
}

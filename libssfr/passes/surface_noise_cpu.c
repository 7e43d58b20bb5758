/* SPDX-License-Identifier: MIT */
/* surface_noise_cpu.c: gradient noise on each particle's sprite, summed, in double. */
#include "passes/surface_noise.h"

/* An integer hash that both twins compute alike: multiply and fold, with odd constants. */
static uint32_t hash(uint32_t x, uint32_t y, uint32_t seed)
{
    uint32_t h = x * 0x9e3779b1u + y * 0x85ebca77u + seed * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

/* One of eight unit gradients at a lattice point, times the way from it. */
static double lean(int x, int y, uint32_t seed, double dx, double dy)
{
    static const double h = 0.70710678118654752440;
    static const double gradients[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {h, h}, {-h, h}, {h, -h}, {-h, -h}};
    const double *g = gradients[hash((uint32_t)x, (uint32_t)y, seed) & 7u];
    return g[0] * dx + g[1] * dy;
}

static double fade(double t)
{
    return t * t * t * (t * (6 * t - 15) + 10);
}

static double perlin(double x, double y, uint32_t seed)
{
    const int ix = (int)floor(x), iy = (int)floor(y);
    const double fx = x - ix, fy = y - iy, wx = fade(fx), wy = fade(fy);
    const double above = ssfr_mix(lean(ix, iy, seed, fx, fy), lean(ix + 1, iy, seed, fx - 1, fy), wx);
    const double below = ssfr_mix(lean(ix, iy + 1, seed, fx, fy - 1), lean(ix + 1, iy + 1, seed, fx - 1, fy - 1), wx);
    return ssfr_mix(above, below, wy);
}

static void add(const ssfr_run *run, const ssfr_fragment *f, double *pixel)
{
    const ssfr_surface_noise_coeffs *c = run->coeffs;
    const ssfr_particles *p = run->frame->particles;
    const double surface = *ssfr_field_fetch(run->in[0], f->x, f->y);
    const uint32_t seed = p->id ? p->id[f->particle] : (uint32_t)f->particle;
    if (!ssfr_is_surface(surface)) return;
    const double below = fmax(surface - f->front, 0);
    const double weight = exp(-c->sharpness * f->r2 - c->falloff * below);
    *pixel += weight * perlin(c->frequency * f->a, c->frequency * f->b, seed);
}

void ssfr_surface_noise_cpu(const ssfr_run *run)
{
    ssfr_splat_cpu(run, add);
}

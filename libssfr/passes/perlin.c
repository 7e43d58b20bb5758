/* SPDX-License-Identifier: MIT */
/* perlin.c: gradient noise in double, and the texture of it. */
#include "passes/perlin.h"

static double fade(double t)
{
    return t * t * t * (t * (6 * t - 15) + 10);
}

/* ---- two dimensions ---------------------------------------------------------------------------------------------- */

/* One of eight unit gradients at a lattice point, times the way from it. */
static double lean_2d(int x, int y, uint32_t seed, double dx, double dy)
{
    static const double h = 0.70710678118654752440;
    static const double gradients[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {h, h}, {-h, h}, {h, -h}, {-h, -h}};
    const double *g = gradients[ssfr_lattice_hash(x, y, 0, seed) & 7u];
    return g[0] * dx + g[1] * dy;
}

double ssfr_perlin_2d(double x, double y, uint32_t seed)
{
    const int ix = (int)floor(x), iy = (int)floor(y);
    const double fx = x - ix, fy = y - iy, wx = fade(fx), wy = fade(fy);
    const double above = ssfr_mix(lean_2d(ix, iy, seed, fx, fy), lean_2d(ix + 1, iy, seed, fx - 1, fy), wx);
    const double below =
        ssfr_mix(lean_2d(ix, iy + 1, seed, fx, fy - 1), lean_2d(ix + 1, iy + 1, seed, fx - 1, fy - 1), wx);
    return ssfr_mix(above, below, wy);
}

/* ---- three dimensions -------------------------------------------------------------------------------------------- */

/* One of the twelve gradients (+-1, +-1, 0) in all orders, four of them twice, times the way from it. */
static double lean(const int i[3], uint32_t seed, const double d[3])
{
    const uint32_t h = ssfr_lattice_hash(i[0], i[1], i[2], seed) & 15u;
    const double u = h < 8 ? d[0] : d[1], v = h < 4 ? d[1] : h == 12 || h == 14 ? d[0] : d[2];
    return (h & 1u ? -u : u) + (h & 2u ? -v : v);
}

/* Of one corner of the cell that begins at lattice point i; f: the place in the cell. */
static double corner(const int i[3], const double f[3], int which, uint32_t seed)
{
    int at[3];
    double d[3];
    for (int k = 0; k < 3; k++) {
        const int side = which >> k & 1;
        at[k] = (i[k] + side) % SSFR_FOAM_CELLS;
        d[k] = f[k] - side;
    }
    return lean(at, seed, d);
}

double ssfr_foam_noise(const double place[3], uint32_t seed)
{
    int i[3];
    double f[3], along[4], w[3];
    for (int k = 0; k < 3; k++) {
        const double p = SSFR_FOAM_CELLS * (place[k] - floor(place[k])), cell = floor(p);
        i[k] = (int)cell, f[k] = p - cell, w[k] = fade(f[k]);
    }
    for (int k = 0; k < 4; k++) along[k] = ssfr_mix(corner(i, f, 2 * k, seed), corner(i, f, 2 * k + 1, seed), w[0]);
    const double sum = ssfr_mix(ssfr_mix(along[0], along[1], w[1]), ssfr_mix(along[2], along[3], w[1]), w[2]);
    return 0.5 + sum / (2 * SSFR_PERLIN_LARGEST);
}

/* ---- the texture ------------------------------------------------------------------------------------------------- */

static void fill(int x, int y, int z, double *texel)
{
    const double n = SSFR_FOAM_TEXELS, place[3] = {(x + 0.5) / n, (y + 0.5) / n, (z + 0.5) / n};
    for (uint32_t seed = 0; seed < 3; seed++) texel[seed] = ssfr_foam_noise(place, seed);
}

const ssfr_lookup ssfr_foam_perlin = {
    .name = "foam_perlin", .w = SSFR_FOAM_TEXELS, .h = SSFR_FOAM_TEXELS, .d = SSFR_FOAM_TEXELS, .c = 3,
    .store = SSFR_LOOKUP_UNORM8, .repeats = true, .fill = fill,
};

double ssfr_foam_perlin_rounding(void)
{
    return ssfr_lookup_rounding(&ssfr_foam_perlin, SSFR_FOAM_STEP);
}

/* SPDX-License-Identifier: MIT */
/* perlin.h: gradient noise of two and three dimensions, computed, or from a texture. The twin of shaders/perlin.glsl:
 * both hash lattice points in integers, so that the same gradients stand in the same places. */
#ifndef SSFR_PERLIN_H
#define SSFR_PERLIN_H

#include "base/lookup.h"

/* An integer hash of a lattice point: multiply and fold, with odd constants. */
static inline uint32_t ssfr_lattice_hash(int x, int y, int z, uint32_t seed)
{
    uint32_t h = (uint32_t)x * 0x9e3779b1u + (uint32_t)y * 0x85ebca77u + (uint32_t)z * 0x27d4eb2fu + seed * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

/* A number in [0, 1) for a seed: 24 bits, which float holds too. The hash of nothing but zeros would be 0. */
static inline double ssfr_lattice_share(uint32_t seed)
{
    return (ssfr_lattice_hash(1, 0, 0, seed) >> 8) / 16777216.0;
}

/* In lattice cells, with one of eight unit gradients at each point; mean 0, within 0.71. */
double ssfr_perlin_2d(double x, double y, uint32_t seed);

/* Noise of foam (Bagar 2010, secs 3.2.2 and 4.1, tab. 4.2, foamPerlinNoise), in [0, 1] with mean 1/2: its octave of
 * SSFR_FOAM_CELLS lattice cells along each axis has a period of 1, as the texture has. Neither the octave nor the depth
 * of the texture is told; eight texels a cell are what linear interpolation leaves no corners of. Gradients are those
 * of Perlin 2002: to the middles of a cube's edges. */
enum { SSFR_FOAM_CELLS = 8, SSFR_FOAM_TEXELS = 64 };
#define SSFR_FOAM_STEP 0.18 /* more than neighbouring texels differ by */
/* The largest sum of three dimensions, at (0.4815, 0.5, 0.6447) of a cell with each gradient at its best. */
#define SSFR_PERLIN_LARGEST 1.0363538113

double ssfr_foam_noise(const double place[3], uint32_t seed);

/* The same in a texture of 8 bits, which holds three patterns (seeds 0, 1, 2); listing A.16 reads the first. */
extern const ssfr_lookup ssfr_foam_perlin;

/* What a GPU's interpolation between its texels may change. */
double ssfr_foam_perlin_rounding(void);

#endif

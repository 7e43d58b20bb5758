/* SPDX-License-Identifier: MIT */
/* lookup.h: constant textures of up to three dimensions: what stands in them, and how both twins read between texels.
 *
 * The CPU interpolates in double between the values that are stored. GPUs interpolate between the same values with
 * weights of 8 bits: half a part in 256 of a step between texels is theirs; rasterisers in software may round what
 * comes out to the format's own steps. Tolerances that tables widen allow for it (ssfr_lookup_rounding). */
#ifndef SSFR_LOOKUP_H
#define SSFR_LOOKUP_H

#include "base/base.h"

typedef enum ssfr_lookup_store {
    SSFR_LOOKUP_FLOAT, /* 32 bits */
    SSFR_LOOKUP_UNORM8 /* 8 bits for [0, 1]; what is beyond is cut off */
} ssfr_lookup_store;

typedef struct ssfr_lookup {
    const char *name; /* the shaders' sampler is t_<name>: sampler2D, and with a depth over 1 sampler3D */
    int w, h, d, c;   /* texels; channels, 1 to 4 */
    ssfr_lookup_store store;
    bool repeats;     /* beyond the edges it begins anew; else the edges go on */
    void (*fill)(int x, int y, int z, double *texel);
} ssfr_lookup;

/* A table as it is stored. */
typedef struct ssfr_texels {
    const ssfr_lookup *table;
    void *data; /* w h d texels of c bytes or floats */
} ssfr_texels;

SSFR_MUST ssfr_result ssfr_texels_init(ssfr_texels *out, const ssfr_lookup *table);
void ssfr_texels_finish(ssfr_texels *texels);

/* bytes that it holds */
size_t ssfr_lookup_bytes(const ssfr_lookup *table);

/* A stored value. */
double ssfr_texel_at(const ssfr_texels *texels, int x, int y, int z, int channel);

/* Interpolated at a place in texture coordinates, where the table is [0, 1] along each axis; texel i is at
 * (i + 1/2) / w. A coordinate that is not finite counts as 0. */
double ssfr_texels_between(const ssfr_texels *texels, const double place[3], int channel);

/* What a GPU's interpolation may differ from the CPU's, where neighbouring texels differ by `step` at most. */
double ssfr_lookup_rounding(const ssfr_lookup *table, double step);

#endif

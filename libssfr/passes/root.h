/* SPDX-License-Identifier: MIT */
/* root.h: the square root of [0, 1], by itself or looked up in a ramp of 128 texels (Bagar 2010, sec. 4.1, tab. 4.2).
 * The twin of shaders/root.glsl.
 *
 * exact         sqrt(u)
 * ramp          between the texels sqrt(i / 127), in float, at (127 u + 1/2) / 128: off by 1 / (4 sqrt(127)) = 0.0222
 *               at most, where u = 1/508
 * ramp_printed  the same texels in 8 bits, which drivers chose for GL_LUMINANCE, looked up at u as listing A.9 has it,
 *               half a texel beside them: off by 1/16 at most, where u = 1/256 is still the first texel's */
#ifndef SSFR_ROOT_H
#define SSFR_ROOT_H

#include "base/lookup.h"

typedef enum ssfr_root { SSFR_ROOT_EXACT, SSFR_ROOT_RAMP, SSFR_ROOT_RAMP_PRINTED } ssfr_root;
enum { SSFR_ROOT_TEXELS = 128 };

extern const char *const ssfr_roots[]; /* words */
extern const ssfr_lookup ssfr_root_ramp, ssfr_root_ramp_printed;
/* The first two of the `tables` of a pass whose params have this choice of ssfr_roots. */
#define SSFR_ROOT_TABLES(params, choice)                         \
    {&ssfr_root_ramp, offsetof(params, choice), SSFR_ROOT_RAMP}, \
        {&ssfr_root_ramp_printed, offsetof(params, choice), SSFR_ROOT_RAMP_PRINTED}

/* The root of u in [0, 1]; ramps: run->tables. */
double ssfr_root_of(int root, const ssfr_texels *const ramps[2], double u);

/* The line that shaders/root.glsl is compiled with. */
const char *ssfr_root_define(int root);

/* What a GPU's interpolation may change of it. */
double ssfr_root_rounding(int root);

#endif

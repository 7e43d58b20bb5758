/* SPDX-License-Identifier: MIT */
/* root.c: the square-root ramps, and looking roots up in them. */
#include "passes/root.h"

const char *const ssfr_roots[] = {"exact", "ramp", "ramp_printed", NULL};

static void fill(int x, int y, int z, double *texel)
{
    (void)y, (void)z;
    *texel = sqrt(x / (SSFR_ROOT_TEXELS - 1.0));
}

#define RAMP(texels, in) {.name = #texels, .w = SSFR_ROOT_TEXELS, .h = 1, .d = 1, .c = 1, .store = in, .fill = fill}
const ssfr_lookup ssfr_root_ramp = RAMP(root_ramp, SSFR_LOOKUP_FLOAT);
const ssfr_lookup ssfr_root_ramp_printed = RAMP(root_ramp_printed, SSFR_LOOKUP_UNORM8);

double ssfr_root_of(int root, const ssfr_texels *const ramps[2], double u)
{
    const double n = SSFR_ROOT_TEXELS;
    switch (root) {
    case SSFR_ROOT_RAMP: return ssfr_texels_between(ramps[0], (const double[3]){((n - 1) * u + 0.5) / n}, 0);
    case SSFR_ROOT_RAMP_PRINTED: return ssfr_texels_between(ramps[1], (const double[3]){u}, 0);
    default: return sqrt(u);
    }
}

const char *ssfr_root_define(int root)
{
    static const char *const lines[] = {"", "#define RAMP\n", "#define RAMP_PRINTED\n"};
    return lines[root];
}

/* The first step is the largest. */
double ssfr_root_rounding(int root)
{
    const double step = sqrt(1 / (SSFR_ROOT_TEXELS - 1.0));
    switch (root) {
    case SSFR_ROOT_RAMP: return ssfr_lookup_rounding(&ssfr_root_ramp, step);
    case SSFR_ROOT_RAMP_PRINTED: return ssfr_lookup_rounding(&ssfr_root_ramp_printed, step);
    default: return 0;
    }
}

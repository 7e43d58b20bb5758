/* SPDX-License-Identifier: MIT */
/* split.h: a surface read straight from the smoothed depth, at the resolution of the smoothing; the twin of
 * shaders/split.glsl. */
#ifndef SSFR_SPLIT_H
#define SSFR_SPLIT_H

#include "passes/optics.h"

typedef struct ssfr_split {
    double low[3];  /* pixels of the frame a pixel of the depth; m, what bends more is a border; m, where more lies to
                     * the nearest of its neighbours a sample stands alone */
    int off_axis;   /* inside: the surface's own normal, else listing A.18's */
    int half_shift; /* B28 as printed */
} ssfr_split;

#define SSFR_SPLIT_UNIFORMS(type, member)                                \
    {"u_low", offsetof(type, member) + offsetof(ssfr_split, low), 3},     \
    {"u_off_axis", offsetof(type, member) + offsetof(ssfr_split, off_axis), 0}, \
    {"u_half_shift", offsetof(type, member) + offsetof(ssfr_split, half_shift), 0}

typedef struct ssfr_split_pixel { /* of the frame */
    const ssfr_run *run;
    const ssfr_split *split;
    const ssfr_field *low;
    int x, y;
    bool border;        /* the colours of four pixels of the depth are blended, else it has one surface */
    int i, j;           /* of the first of the four */
    double f[2];        /* how far it is from there to the last, [0, 1) */
    ssfr_surface inner; /* has no meaning at a border */
} ssfr_split_pixel;

ssfr_split_pixel ssfr_split_at(const ssfr_run *run, const ssfr_split *split, const ssfr_field *low, int x, int y);

/* Of a pixel at a border, the k-th of four: its share of the colour, and the surface that gives it. */
double ssfr_split_weight(const ssfr_split_pixel *at, int k);
ssfr_surface ssfr_split_sample(const ssfr_split_pixel *at, int k);

#endif

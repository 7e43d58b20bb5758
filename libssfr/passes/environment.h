/* SPDX-License-Identifier: MIT */
/* environment.h: sky, chequered floor and boxes, for any ray: the twin of shaders/environment.glsl. */
#ifndef SSFR_ENVIRONMENT_H
#define SSFR_ENVIRONMENT_H

#include "graph/frame.h"

/* Radiance of the sky in a unit world direction. */
void ssfr_environment_sky(const ssfr_block *block, const double dir[3], double color[3]);

/* Radiance along origin + t dir (relative to the eye, world axes); gives t of the hit, SSFR_EMPTY for the sky. */
double ssfr_environment_trace(const ssfr_block *block, const double origin[3], const double dir[3], double color[3]);

static inline void ssfr_world_from_eye(const ssfr_block *b, const double v[3], double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = v[0] * b->right[k] + v[1] * b->up[k] + v[2] * b->back[k];
}

/* Eye-space x and y at unit distance of a place in the full-resolution image, px. */
static inline void ssfr_slope_at(const ssfr_block *b, double x, double y, double out[2])
{
    out[0] = (x - 0.5 * b->image[0]) * b->image[2];
    out[1] = (0.5 * b->image[1] - y) * b->image[3];
}

#endif

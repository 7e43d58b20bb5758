/* SPDX-License-Identifier: MIT */
/* environment.h: sky or a map of it, chequered floor and solids, for any ray: the twin of shaders/environment.glsl. */
#ifndef SSFR_ENVIRONMENT_H
#define SSFR_ENVIRONMENT_H

#include "graph/pass.h"

/* Radiance of the sky, or of its map, in a unit world direction. */
void ssfr_environment_sky(const ssfr_frame *frame, const double dir[3], double color[3]);

/* The first of these solids that the ray origin + dir * [0, t] enters, -1 for none; where, and the unit normal there. */
int ssfr_environment_meet(const ssfr_frame *frame, const ssfr_solid_set solids, const double origin[3],
                          const double dir[3], double *t, double normal[3]);

/* Radiance along origin + t dir (relative to the eye, world axes) of the floor, these of the solids, and the sky; gives
 * t of the hit, SSFR_EMPTY for the sky. */
double ssfr_environment_trace(const ssfr_frame *frame, const ssfr_solid_set solids, const double origin[3],
                              const double dir[3], double color[3]);

/* Light that a matte face of a unit world normal sends back, of a reflectance of 1. */
double ssfr_environment_lambert(const ssfr_block *b, const double normal[3]);

/* The lines before shaders/environment.glsl for a frame: which shapes, and whether a map. */
void ssfr_environment_defines(const ssfr_frame *frame, bool solids, bool meshes, char text[SSFR_DEFINES]);

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

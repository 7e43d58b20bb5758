/* SPDX-License-Identifier: MIT */
/* solid.h: the shapes of solids: how far a place is from one, and where a ray meets it. All in double, world axes. */
#ifndef SSFR_SOLID_H
#define SSFR_SOLID_H

#include "base/base.h"

/* Unit vectors at right angles, as exact as a caller's floats can make them. */
bool ssfr_axes_are_orthonormal(const double x[3], const double y[3], const double z[3]);

/* Malformed solids are refused in one line that begins with `what`. */
SSFR_MUST ssfr_result ssfr_solid_check(const ssfr_solid *solid, const char *what);

/* Signed distance from the solid's surface, m, negative inside; the unit gradient, pointing outwards, goes to normal.
 * Exact outside and, but for edges shared by no face in reach, inside; at ties (a box's centre) one of the nearest. */
double ssfr_solid_distance(const ssfr_solid *solid, const double at[3], double normal[3]);

/* The box around it, m, world; infinite for a plane, a little too large for a turned mesh. */
void ssfr_solid_bounds(const ssfr_solid *solid, double lo[3], double hi[3]);

/* Where the ray origin + t dir (dir of any length) enters the solid from outside: t > 0, and the unit normal there; a
 * negative number when it does not. */
double ssfr_solid_enter(const ssfr_solid *solid, const double origin[3], const double dir[3], double normal[3]);

/* Between a place in the world and in the solid's axes, relative to its centre, m. */
static inline void ssfr_solid_local(const ssfr_solid *solid, const double world[3], double local[3])
{
    const double d[3] = {world[0] - solid->centre[0], world[1] - solid->centre[1], world[2] - solid->centre[2]};
    for (int k = 0; k < 3; k++) local[k] = ssfr_dot(solid->axis[k], d);
}

static inline void ssfr_solid_world(const ssfr_solid *solid, const double local[3], double world[3])
{
    for (int k = 0; k < 3; k++)
        world[k] = solid->centre[k] + local[0] * solid->axis[0][k] + local[1] * solid->axis[1][k] +
                   local[2] * solid->axis[2][k];
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pile.h: how many particles can be over each pixel at most: a bound on what they add up to, without drawing any. */
#ifndef SSFR_PILE_H
#define SSFR_PILE_H

#include "ssfr.h"

typedef struct ssfr_pile_options {
    const float *sizes; /* of each particle, a factor on its reach; one of size 0 is nowhere. NULL: all 1 */
    double reach;       /* m, how far from its place a particle of size 1 may be drawn */
    bool by_size;       /* a particle counts by its size, rounded up to 1/256, not as one */
} ssfr_pile_options;

/* One channel, of the camera's size. For the sphere that a particle may be drawn in stands a rectangle around it, and
 * a pixel more on each side; the image, where it reaches behind the eye. particles NULL: none. */
SSFR_MUST ssfr_result ssfr_pile(ssfr_field **out, const ssfr_particles *particles, const ssfr_camera *camera,
                                const ssfr_pile_options *options);

#endif

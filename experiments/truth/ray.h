/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ray.h: rays through the fluid, and where they cross its surface. */
#ifndef SSFR_TRUTH_RAY_H
#define SSFR_TRUTH_RAY_H

#include "base/base.h"

typedef struct ssfr_ray {
    double origin[3]; /* m, world axes, relative to the fluid's origin */
    double dir[3];    /* unit */
} ssfr_ray;

/* Of every crossing the error estimates are meant as bounds: the true value lies within them. */
typedef struct ssfr_crossing {
    double t, t_err;      /* m along the ray */
    double normal[3];     /* unit, out of the fluid */
    double normal_err;    /* rad */
    bool enters;          /* the fluid, for who goes along the ray */
} ssfr_crossing;

static inline void ssfr_ray_at(const ssfr_ray *ray, double t, double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = ray->origin[k] + t * ray->dir[k];
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* walls.h: what keeps loose particles in: solids, which may move, and the closed sides of a domain. */
#ifndef SSFR_WALLS_H
#define SSFR_WALLS_H

#include "experiments/scenes/fluid.h"

/* Sides are counted -x +x -y +y -z +z. */
typedef struct ssfr_domain {
    double lo[3], hi[3]; /* m, world */
    bool open[6];        /* no wall on that side */
} ssfr_domain;

enum { SSFR_DOMAIN_SIDES = 6 };

typedef struct ssfr_walls_box {
    double lo[3], hi[3]; /* m, world */
} ssfr_walls_box;

/* A view: obstacles and domain live longer. */
typedef struct ssfr_walls {
    int n;
    const ssfr_obstacle *obstacles;
    ssfr_walls_box reach[SSFR_MAX_SOLIDS]; /* around each obstacle in the whole step, and the support more */
    const ssfr_domain *domain;
    double support; /* m, how far a wall is felt */
    double dt;      /* s, of the step, positive */
} ssfr_walls;

/* Fails for more than SSFR_MAX_SOLIDS obstacles. */
SSFR_MUST ssfr_result ssfr_walls_init(ssfr_walls *walls, const ssfr_domain *domain, double support, double dt, int n,
                                      const ssfr_obstacle *obstacles);

/* Walls are counted: obstacles first, then the domain's sides. */
static inline int ssfr_walls_count(const ssfr_walls *walls)
{
    return walls->n + SSFR_DOMAIN_SIDES;
}

/* Signed distance of wall i as it is at the step's end, m, positive where particles may be, and its unit normal towards
 * them; infinite where it is certainly farther than the support, and for an open side. */
double ssfr_walls_distance(const ssfr_walls *walls, int i, const double at[3], double normal[3]);

/* The share of the support's ball around a place that is not behind a wall, as if each were flat, (0, 1]. */
double ssfr_walls_free(const ssfr_walls *walls, const double at[3]);

/* Ends a step's path from one place to another before walls: it slides along those that it meets, and what is inside is
 * pushed to the nearest place outside. The velocity v loses what points into the wall. */
void ssfr_walls_keep(const ssfr_walls *walls, const double from[3], double at[3], double v[3]);

/* Whether a place is beyond a side, open or closed. */
bool ssfr_domain_leaves(const ssfr_domain *domain, const double at[3]);

#endif

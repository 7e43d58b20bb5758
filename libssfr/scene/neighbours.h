/* SPDX-License-Identifier: MIT */
/* neighbours.h: packed particles in cells, ready to be walked through, each with those within a distance of it.
 *
 *      for (size_t k = 0; k < set.n; k++) {             the particle set.order[k] at set.place[k]
 *          const int n_ranges = ssfr_neighbours_near(&set, k, ranges);
 *          for each range, for (j = begin; j < end; j++)  candidates at set.place[j], itself among them
 *
 * Who comes in which order depends on the places alone: sums over neighbours have the same bits for any number of
 * threads. */
#ifndef SSFR_NEIGHBOURS_H
#define SSFR_NEIGHBOURS_H

#include "scene/grid.h"

typedef struct ssfr_neighbours {
    size_t n;
    double origin[3];      /* m, world */
    double (*place)[3];    /* m, relative to origin, cell by cell */
    const uint32_t *order; /* which particle it is that stands there; the grid's */
    ssfr_grid *grid;
} ssfr_neighbours;

/* reach: m, positive. The particles need not stay. */
SSFR_MUST ssfr_result ssfr_neighbours_init(ssfr_neighbours *out, const ssfr_particles *particles, double reach);
void ssfr_neighbours_finish(ssfr_neighbours *set);

/* Ranges that hold every particle within the reach of the k-th. */
static inline int ssfr_neighbours_near(const ssfr_neighbours *set, size_t k, ssfr_grid_range ranges[SSFR_GRID_ROWS])
{
    const double *p = set->place[k];
    return ssfr_grid_near(set->grid, (const float[3]){(float)p[0], (float)p[1], (float)p[2]}, ranges);
}

/* From the k-th to the j-th, m; the squared length, m^2. */
static inline double ssfr_neighbours_between(const ssfr_neighbours *set, size_t k, size_t j, double d[3])
{
    for (int c = 0; c < 3; c++) d[c] = set->place[j][c] - set->place[k][c];
    return ssfr_dot(d, d);
}

#endif

/* SPDX-License-Identifier: MIT */
/* grid.h: cells over points, to find who is within a distance of a place.
 *
 * Points are floats relative to an origin of the caller's choice: the grid finds candidates, whoever needs more
 * digits measures them again in double. Empty cells cost nothing, however far apart the points are. */
#ifndef SSFR_GRID_H
#define SSFR_GRID_H

#include "base/base.h"

typedef struct ssfr_grid ssfr_grid;

/* order[begin .. end) of the grid: points whose cells lie side by side. */
typedef struct ssfr_grid_range {
    uint32_t begin, end;
} ssfr_grid_range;

enum { SSFR_GRID_ROWS = 9 }; /* ranges that cover the 27 cells around a place */

/* An empty grid. Memory grows with the most points that were ever built. */
SSFR_MUST ssfr_result ssfr_grid_create(ssfr_grid **out);
void ssfr_grid_destroy(ssfr_grid **grid);

/* Sorts n points (points[3 n], m, finite) into cells of edge `cell` (m, positive). Points of a cell keep their order;
 * the result is the same for any number of threads. The points need not stay. Fails with SSFR_ERR_VALUE where a point
 * is not finite or stands 2^20 cells or more from the origin, naming it; the grid is then empty. */
SSFR_MUST ssfr_result ssfr_grid_build(ssfr_grid *grid, size_t n, const float *points, double cell);

/* The points' indices, cell by cell; n of them. */
const uint32_t *ssfr_grid_order(const ssfr_grid *grid);
double ssfr_grid_cell(const ssfr_grid *grid); /* m */
size_t ssfr_grid_bytes(const ssfr_grid *grid); /* memory held */

/* The cells that hold points, in their order, and the points of one. */
size_t ssfr_grid_n_cells(const ssfr_grid *grid);
ssfr_grid_range ssfr_grid_cell_at(const ssfr_grid *grid, size_t cell);

/* The caller has put its points into the grid's order: from now on point i is the order's i-th. */
void ssfr_grid_settle(ssfr_grid *grid);

/* Ranges, each not empty, that hold every point within one cell's edge of `at`; returns how many. Ranges come in an
 * order that depends on the place alone. */
int ssfr_grid_near(const ssfr_grid *grid, const float at[3], ssfr_grid_range ranges[SSFR_GRID_ROWS]);

/* The positions of packed particles relative to the middle of their bounds, which goes to origin: points for a grid.
 * To free(). */
SSFR_MUST ssfr_result ssfr_grid_points(const ssfr_particles *particles, double origin[3], float **points);

#endif

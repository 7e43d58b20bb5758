/* SPDX-License-Identifier: MIT */
/* neighbours.c: packed particles in cells, their places in double. */
#include "scene/neighbours.h"

#include <float.h>

/* The grid rounds places to floats: an edge longer by what two of them may be off keeps all within the reach. */
static double cell_edge(size_t n, const float *points, double reach)
{
    float farthest = 0;
    for (size_t i = 0; i < 3 * n; i++) farthest = fmaxf(farthest, fabsf(points[i]));
    return reach * (1 + 1e-6) + 4 * (double)FLT_EPSILON * (double)farthest;
}

static void place(ssfr_neighbours *set, const ssfr_particles *particles, size_t k)
{
    const size_t i = set->order[k];
    const double *centre = particles->packets[i / SSFR_PACKET].centre;
    /* The difference of two large numbers first: it is exact, or nearly. */
    for (size_t c = 0; c < 3; c++)
        set->place[k][c] = (centre[c] - set->origin[c]) + (double)particles->position[3 * i + c];
}

ssfr_result ssfr_neighbours_init(ssfr_neighbours *out, const ssfr_particles *particles, double reach)
{
    ssfr_result result = SSFR_OK;
    float *points = NULL;
    *out = (ssfr_neighbours){.n = particles->n};
    SSFR_TRY(ssfr_grid_points(particles, out->origin, &points));
    SSFR_TRY(ssfr_grid_create(&out->grid));
    SSFR_TRY(ssfr_grid_build(out->grid, out->n, points, cell_edge(out->n, points, reach)));
    SSFR_TRY(ssfr_alloc(&out->place, out->n, sizeof *out->place, "particles' places"));
    out->order = ssfr_grid_order(out->grid);
    for (size_t k = 0; k < out->n; k++) place(out, particles, k);
end:
    free(points);
    if (result != SSFR_OK) ssfr_neighbours_finish(out);
    return result;
}

void ssfr_neighbours_finish(ssfr_neighbours *set)
{
    free(set->place);
    ssfr_grid_destroy(&set->grid);
    *set = (ssfr_neighbours){0};
}

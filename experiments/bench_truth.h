/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_truth.h: `ssfr bench truth`: what a ray costs, against what it crosses and how many particles there are.
 *
 *      bench_truth.c         the command: visiting all that is measured, printing, saving
 *      bench_truth_rays.c    the water that is looked at, and casting its rays */
#ifndef SSFR_BENCH_TRUTH_H
#define SSFR_BENCH_TRUTH_H

#include "experiments/measure.h"
#include "experiments/truth/continuum.h"

/* argv[0] is "bench", argv[1] "truth"; gives the exit status. */
int ssfr_bench_truth(int argc, char **argv);

/* ---- shared by its files ----------------------------------------------------------------------------------------- */

/* Water with waves on it, its particles at rest, scattered a little about their lattice.
 *
 *      finer    1 m x 0.4 m x 0.5 m, seen as a whole: more particles are smaller ones, and a ray crosses more of them
 *      wider    0.4 m deep, a part seen from above: more particles are more water, and a ray crosses as many of them */
typedef enum ssfr_waters { SSFR_WATER_FINER, SSFR_WATER_WIDER, SSFR_N_WATERS } ssfr_waters;

extern const char *const ssfr_water_names[]; /* NULL-terminated */
extern const char *const ssfr_water_help[];

typedef struct ssfr_water {
    ssfr_particles *particles;
    ssfr_camera camera; /* 1280x720 */
} ssfr_water;

/* About n particles, at least 1000: the waves cut the lattice. The same ones each time. */
SSFR_MUST ssfr_result ssfr_water_create(ssfr_water *out, ssfr_waters kind, size_t n);
void ssfr_water_finish(ssfr_water *water);

/* Sums over the rays that were cast. Counts are the same for any number of threads. */
typedef struct ssfr_rays_tally {
    uint64_t rays, touches;
    uint64_t covered; /* rays with a crossing or more; what follows is of these alone */
    uint64_t kernels, crossings, evaluations;
    double seconds[3]; /* of all threads together: gathering kernels, finding crossings, chords */
} ssfr_rays_tally;

extern const char *const ssfr_rays_stages[3];

/* Casts the rays of one pixel in each square of `every` pixels: first and all crossings, and the density's integral.
 * Tile by tile with all threads, as the image is. Fails, too, when it is interrupted. tick may be NULL; it is called
 * now and then with the share that is done, by one thread. */
typedef void ssfr_rays_tick(void *user, double share);
SSFR_MUST ssfr_result ssfr_rays_cast(const ssfr_continuum *fluid, const ssfr_camera *camera, int every, uint64_t seed,
                                     ssfr_rays_tick *tick, void *user, ssfr_rays_tally *tally);

#endif

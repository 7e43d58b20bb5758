/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tank.h: water in a tank, to measure the solver by: a pool at rest, a dam break, a drop in free fall.
 *
 *      pool        1 m long, 0.5 m wide, 0.5 m deep
 *      dam break   the same water, piled up 1 m high in one half of the same tank
 *      drop        0.125 m^3 that fall without touching anything */
#ifndef SSFR_TANK_H
#define SSFR_TANK_H

#include "experiments/scenes/solver.h"

typedef enum ssfr_tank_kind { SSFR_TANK_POOL, SSFR_TANK_DAM_BREAK, SSFR_TANK_DROP } ssfr_tank_kind;

extern const char *const ssfr_tank_words[]; /* "pool", "dam_break", "drop", NULL */
extern const char *const ssfr_tank_help[];  /* what each is, in one line */

typedef struct ssfr_tank {
    ssfr_tank_kind kind;
    size_t n;         /* particles */
    double radius, spacing; /* m; the spacing is that of rest */
    double gravity;   /* m/s^2, downwards */
    double floor[2];  /* m, its lengths */
    double time;      /* s, simulated */
    long steps;
    ssfr_solver *solver;
} ssfr_tank;

/* With `layers` particles across the width: 2 layers^3 of them; a drop has half as many. params NULL: the defaults. */
SSFR_MUST ssfr_result ssfr_tank_create(ssfr_tank **out, ssfr_tank_kind kind, int layers,
                                       const ssfr_solver_params *params);
void ssfr_tank_destroy(ssfr_tank **tank);

/* One step towards `end` (s, may be infinite): as long as the solver allows, or so much shorter that the last one is as
 * long as the others. */
SSFR_MUST ssfr_result ssfr_tank_step(ssfr_tank *tank, double end);

/* What can be said of the water at a moment. Interior particles are farther than the kernels' support from walls and
 * from every particle whose neighbours lie to one side. Deviations are those of their densities from that of rest,
 * relative to it; NaN where there is no interior. Compressions are the deviations above 0. */
typedef struct ssfr_tank_state {
    double volume;       /* m^3, the sum of m / rho over all particles */
    double surface;      /* m, over the floor: the median over vertical columns of their highest particle's top */
    double centre;       /* m, height of the centre of mass over the floor */
    double speed_rms, speed_max;            /* m/s */
    double energy;       /* J, kinetic, and potential over the floor */
    size_t interior;     /* particles */
    double density_mean, density_rms, density_max; /* 1; the last two of their sizes */
    double compression_rms, compression_max;       /* 1 */
} ssfr_tank_state;

SSFR_MUST ssfr_result ssfr_tank_measure(const ssfr_tank *tank, ssfr_tank_state *out);

#endif

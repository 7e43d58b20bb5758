/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scenes.h: the built-in scenes; the one list of them is in builtin.c. */
#ifndef SSFR_SCENES_H
#define SSFR_SCENES_H

#include "base/base.h"

typedef struct ssfr_builtin {
    const char *name, *help;
    /* Makes the particles; the same seed gives the same bits. */
    ssfr_result (*make)(ssfr_particles **out, uint64_t seed);
    double from[3]; /* world direction from the middle towards the eye; zero: the default of a bare file */
    double top;     /* m, world y: the default view frames what is below it; 0: everything */
    double floor;   /* m, world y; NaN: just below the particles; -inf: none */
    int n_solids;
    const ssfr_solid *solids;
} ssfr_builtin;

const ssfr_builtin *ssfr_builtin_find(const char *name); /* NULL when there is none */
const ssfr_builtin *ssfr_builtin_at(int i);              /* NULL past the end */

#endif

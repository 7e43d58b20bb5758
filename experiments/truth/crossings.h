/* SPDX-License-Identifier: GPL-3.0-or-later */
/* crossings.h: where a line crosses the fluid's surface, none missed.
 *
 * On an interval of the line the field lies within bounds that follow from bounds on its slope there. An interval whose
 * bounds exclude the surface has no crossing; one where the slope has one sign has one crossing at most, which Brent's
 * method (gsl_root_fsolver_brent) finds in the bracket of its ends; any other is halved. An interval that is as short
 * as rounding allows and still undecided is a touch: the ray grazes the surface, and crosses it twice or not at all. */
#ifndef SSFR_TRUTH_CROSSINGS_H
#define SSFR_TRUTH_CROSSINGS_H

#include "experiments/truth/line.h"

#define SSFR_CROSSINGS_EPS 1e-10 /* of a root, relative to the fluid's support */

typedef struct ssfr_crossings {
    size_t n, capacity;
    ssfr_crossing *items;    /* rising; enters alternates */
    bool begins_inside;      /* at the line's from */
    size_t n_touches;
    double touch;            /* m, the first; infinite when there is none */
    double touched;          /* m, all of them together: what the length inside may be wrong by because of them */
    size_t evaluations;      /* of bounds and values, for the tables */
    void *solver;            /* GSL's */
    void *work;              /* scratch */
} ssfr_crossings;

/* One thread's. */
SSFR_MUST ssfr_result ssfr_crossings_init(ssfr_crossings *crossings);
void ssfr_crossings_finish(ssfr_crossings *crossings);

/* All crossings of a line that was cast, within its from and to. */
SSFR_MUST ssfr_result ssfr_crossings_find(ssfr_crossings *crossings, const ssfr_line *line);

/* The first crossing of a ray at t in (0, to), for a ray that begins inside or outside as said, be it on the surface
 * itself: what it finds there of the crossing that it comes from does not count. Casts the line piece by piece and so
 * pays only for the way to the crossing. */
SSFR_MUST ssfr_result ssfr_crossings_first(ssfr_crossings *crossings, ssfr_line *line, const ssfr_ray *ray, double to,
                                           bool inside, ssfr_crossing *out, bool *found);

/* Whether a place (m, relative to the fluid's origin) is in the fluid. */
SSFR_MUST ssfr_result ssfr_crossings_inside(ssfr_crossings *crossings, ssfr_line *line, const double at[3],
                                            bool *inside);

#endif

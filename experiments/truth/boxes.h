/* SPDX-License-Identifier: GPL-3.0-or-later */
/* boxes.h: a tree of boxes over balls that stand along a space-filling curve, to find those that a ray meets.
 *
 *      leaves    [0..7] [8..15] [16..23] ...      SSFR_BOXES_LEAF balls each, in the order given
 *      nodes     pairs of leaves, pairs of pairs, up to one: nothing is sorted and no node has a pointer
 *
 * Packed particles lie along such a curve already. Cells of a grid would have to be as large as the largest ball and
 * are visited also where they are empty; boxes fit what is in them, however sparse it is. */
#ifndef SSFR_TRUTH_BOXES_H
#define SSFR_TRUTH_BOXES_H

#include "experiments/truth/ray.h"

enum { SSFR_BOXES_LEAF = 8 };

typedef struct ssfr_box { /* m; a float's step larger than what is in it */
    float lo[3], hi[3];
} ssfr_box;

typedef struct ssfr_boxes {
    size_t n;       /* balls */
    int n_levels;   /* 0 when there are no balls */
    size_t first[64], count[64]; /* of each level's boxes; level 0 are the leaves */
    ssfr_box *boxes;
} ssfr_boxes;

/* Balls at centre[n] (m), of reach[i] or, where reach is NULL, all of `same` (m). They need not stay. */
SSFR_MUST ssfr_result ssfr_boxes_init(ssfr_boxes *out, size_t n, const double (*centre)[3], const double *reach,
                                      double same);
void ssfr_boxes_finish(ssfr_boxes *boxes);
size_t ssfr_boxes_bytes(const ssfr_boxes *boxes);

/* Balls begin .. end - 1 may meet the ray. False stops. */
typedef bool ssfr_boxes_visit(void *user, uint32_t begin, uint32_t end);

/* Calls visit for each leaf whose box meets the ray between from and to, in the order of the balls. */
void ssfr_boxes_along(const ssfr_boxes *boxes, const ssfr_ray *ray, double from, double to, ssfr_boxes_visit *visit,
                      void *user);
/* The part of the ray within the box around everything; false when there is none. */
bool ssfr_boxes_clip(const ssfr_boxes *boxes, const ssfr_ray *ray, double *from, double *to);

#endif

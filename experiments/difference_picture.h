/* SPDX-License-Identifier: GPL-3.0-or-later */
/* difference_picture.h: where two depth images differ and by how much, as a picture with a colour bar. */
#ifndef SSFR_DIFFERENCE_PICTURE_H
#define SSFR_DIFFERENCE_PICTURE_H

#include "base/base.h"

typedef struct ssfr_difference_picture {
    const char *title;
    double radius; /* m, of the particles: what the bar counts in; 0: it counts in metres */
    double range;  /* of the bar to both sides, in what it counts in; 0: 95 of 100 pixels lie within it */
    const ssfr_field *mask; /* pixels where it is 0 are not drawn; NULL: all are */
} ssfr_difference_picture;

/* Draws a - b of two depth images of one size as a PNG by gnuplot: red where a is nearer to the eye, blue where it is
 * farther, with two more colours where only one of them has a surface. A missing gnuplot is a warning: then no file is
 * written. */
SSFR_MUST ssfr_result ssfr_difference_picture_save(const char *png, const ssfr_field *a, const ssfr_field *b,
                                                   const ssfr_difference_picture *picture);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* slot_picture.h: an image of one channel in false colours: an intermediate one of a frame, or another. */
#ifndef SSFR_SLOT_PICTURE_H
#define SSFR_SLOT_PICTURE_H

#include "base/base.h"

typedef struct ssfr_slot_picture {
    const char *slot;
    double lo, hi; /* of the colours, in the slot's unit; NaN: 2 of 100 pixels lie below, and above */
} ssfr_slot_picture;

/* Writes an image of one channel as a PNG: from dark blue over green to yellow, grey where it has the slot's neutral
 * value or none. What lies beyond the range has the colour of its end. Says the range. */
SSFR_MUST ssfr_result ssfr_slot_picture_save(const char *png, const ssfr_field *field,
                                             const ssfr_slot_picture *picture);

typedef struct ssfr_false_colours {
    const char *name, *unit;
    double neutral; /* grey, as NaN is */
    double lo, hi;
} ssfr_false_colours;

/* The same of an image that no slot holds. */
SSFR_MUST ssfr_result ssfr_false_colours_save(const char *png, const ssfr_field *field,
                                              const ssfr_false_colours *colours);

#endif

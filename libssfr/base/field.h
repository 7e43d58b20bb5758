/* SPDX-License-Identifier: MIT */
/* field.h: reading fields as shaders read textures. */
#ifndef SSFR_FIELD_H
#define SSFR_FIELD_H

#include "base/base.h"

/* The pixel nearest to (x, y) inside the field: a 1x1 field of a neutral value serves any size. */
static inline const double *ssfr_field_fetch(const ssfr_field *f, int x, int y)
{
    return ssfr_field_at(f, ssfr_clamp_int(x, 0, f->w - 1), ssfr_clamp_int(y, 0, f->h - 1));
}

static inline bool ssfr_is_surface(double z)
{
    return fabs(z) < SSFR_SURFACE;
}

/* A depth image's value; outside the image there is no surface. */
static inline double ssfr_depth_at(const ssfr_field *f, int x, int y)
{
    return x >= 0 && y >= 0 && x < f->w && y < f->h ? *ssfr_field_at(f, x, y) : -SSFR_EMPTY;
}

/* Rounds every value to float, as a GPU texture holds it. */
void ssfr_field_round(ssfr_field *field);

SSFR_MUST ssfr_result ssfr_field_copy(ssfr_field **out, const ssfr_field *from);

#endif

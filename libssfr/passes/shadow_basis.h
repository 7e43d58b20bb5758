/* SPDX-License-Identifier: MIT */
/* shadow_basis.h: a shadow map as images that can be filtered; see shadow_basis.c. */
#ifndef SSFR_SHADOW_BASIS_H
#define SSFR_SHADOW_BASIS_H

#include "passes/light_view.h"

enum { SSFR_SHADOW_TERMS = 16 }; /* at most */

typedef struct ssfr_shadow_basis_coeffs {
    ssfr_light_view view;
    double per_metre; /* normalised depth, 1/m */
    double damping;   /* alpha / M^2 */
    int terms;        /* M */
    int radius;       /* px, of the box */
} ssfr_shadow_basis_coeffs;

/* The images stand one below the other, four channels each: value 0 is the share of a texel that has a caster, values
 * 2 k - 1 and 2 k the cosine and the sine of term k, from 1. */
static inline int ssfr_shadow_images(int terms)
{
    return (2 * terms + 4) / 4;
}

/* All casters and all fluid have normalised depths in [0, span]. The wave has a period of 2, and would turn back where
 * two depths are 1 apart: so far from that it is as far as it goes, with the fewest terms that make so many images (1,
 * 2, 4, 8, 16). */
static inline double ssfr_shadow_span(int n_images)
{
    return 1 - 0.5 / ssfr_max_int(2 * n_images - 2, 1);
}

void ssfr_shadow_basis_cpu(const ssfr_run *run);

#endif

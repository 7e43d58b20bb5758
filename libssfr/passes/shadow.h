/* SPDX-License-Identifier: MIT */
/* shadow.h: the share of the light that arrives at the fluid; see shadow.c. */
#ifndef SSFR_SHADOW_H
#define SSFR_SHADOW_H

#include "passes/light_view.h"

enum { SSFR_SHADOW_MAP, SSFR_SHADOW_CONVOLUTION, SSFR_SHADOW_RAY };
enum { SSFR_SHADOW_NO_FOAM, SSFR_SHADOW_FOAM_WITHOUT_WATER, SSFR_SHADOW_FOAM_FRONT };
enum { SSFR_SHADOW_DEPTH, SSFR_SHADOW_FOAM_DEPTH, SSFR_SHADOW_LIGHT_DEPTH, SSFR_SHADOW_BASIS }; /* inputs */

typedef struct ssfr_shadow_coeffs {
    ssfr_light_view view;
    double bias;  /* m */
    double scale;
    int kind;
    double divisor; /* full-resolution pixels a pixel */
    int around;   /* px, of the mean: 1 for 3x3 */
    int foam;     /* SSFR_SHADOW_* */
} ssfr_shadow_coeffs;

void ssfr_shadow_cpu(const ssfr_run *run);

#endif

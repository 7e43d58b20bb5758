/* SPDX-License-Identifier: MIT */
/* composite.h: the fluid's surface shaded over the scene; see composite.c. */
#ifndef SSFR_COMPOSITE_H
#define SSFR_COMPOSITE_H

#include "passes/optics.h"

enum { SSFR_FRESNEL_SCHLICK, SSFR_FRESNEL_EXACT };
enum { SSFR_REFRACTION_OFFSET, SSFR_REFRACTION_SNELL };

typedef struct ssfr_composite_coeffs {
    ssfr_optics optics; /* first */
    double r0;          /* Fresnel reflectance at normal incidence */
    int fresnel, refraction;
} ssfr_composite_coeffs;

void ssfr_composite_cpu(const ssfr_run *run);

#endif

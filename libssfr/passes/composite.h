/* SPDX-License-Identifier: MIT */
/* composite.h: the fluid's surface shaded over the scene; see composite.c. */
#ifndef SSFR_COMPOSITE_H
#define SSFR_COMPOSITE_H

#include "graph/pass.h"

enum { SSFR_FRESNEL_SCHLICK, SSFR_FRESNEL_EXACT };
enum { SSFR_REFRACTION_OFFSET, SSFR_REFRACTION_SNELL };
enum { SSFR_REFLECTION_SKY, SSFR_REFLECTION_SCENE };
enum { SSFR_ATTENUATION_BEER, SSFR_ATTENUATION_SINGLE };

typedef struct ssfr_composite_coeffs {
    double gamma;       /* image heights a metre of thickness */
    double attenuation; /* 1/m, of the single-coefficient form */
    double specular, shininess;
    double r0;          /* Fresnel reflectance at normal incidence */
    int fresnel, refraction, reject, reflection, single;
} ssfr_composite_coeffs;

void ssfr_composite_cpu(const ssfr_run *run);

#endif

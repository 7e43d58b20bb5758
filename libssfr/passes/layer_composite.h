/* SPDX-License-Identifier: MIT */
/* layer_composite.h: layers of water and foam over the scene; see layer_composite.c. */
#ifndef SSFR_LAYER_COMPOSITE_H
#define SSFR_LAYER_COMPOSITE_H

#include "passes/split.h"

enum { SSFR_LAYER_FRESNEL_POWER, SSFR_LAYER_FRESNEL_EXACT };
enum { SSFR_FLUID_CONSTANT, SSFR_FLUID_FALLOFF };
enum { SSFR_FOAM_EXPONENTIAL, SSFR_FOAM_POWER };
enum { SSFR_LAYER_IMAGE, SSFR_LAYER_SPLIT };
enum { SSFR_BORDER_SPLIT, SSFR_BORDER_NEVER, SSFR_BORDER_ALWAYS };
enum {
    SSFR_PRINTED_B10 = 1, SSFR_PRINTED_B11 = 2, SSFR_PRINTED_B12 = 4, SSFR_PRINTED_B26 = 8, SSFR_PRINTED_B28 = 16,
    SSFR_PRINTED_B29 = 32,
};

/* Inputs beyond those of optics.h. */
enum {
    SSFR_LAYER_BACK = SSFR_OPTICS_INPUTS, SSFR_LAYER_FRONT, SSFR_LAYER_FOAM, SSFR_LAYER_FOAM_FRONT, SSFR_LAYER_LIGHT,
    SSFR_LAYER_LOW,
};

typedef struct ssfr_layer_composite_coeffs {
    ssfr_optics optics;     /* first */
    double shift;           /* px a metre of water */
    double fresnel[3];      /* bias, scale, power */
    double base[3];         /* baseColor */
    double falloff[4];      /* 1/m, of its colours and of what comes through */
    double c_ff[3], c_fb[3];
    double foam[4];         /* attenuation 1/m, 1/delta_foam 1/m, most of T_ff / delta_foam, its exponent */
    double ambient;
    int exact_fresnel, falloff_model, power_blend;
    int foam_swapped;       /* B10 as printed */
    int front_weight;       /* B11 as printed */
    int cosine_added;       /* B12 as printed */
    int is_split;           /* else the surface is that of the images depth and normal */
    ssfr_split split;
} ssfr_layer_composite_coeffs;

void ssfr_layer_composite_cpu(const ssfr_run *run);

#endif

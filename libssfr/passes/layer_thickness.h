/* SPDX-License-Identifier: MIT */
/* layer_thickness.h: water before and behind the front of the foam; see layer_thickness.c. */
#ifndef SSFR_LAYER_THICKNESS_H
#define SSFR_LAYER_THICKNESS_H

#include "passes/thickness.h"

enum { SSFR_LAYERS_CENTRE, SSFR_LAYERS_FRAGMENT };

enum { SSFR_LAYER_FOAM_DEPTH = 1, SSFR_LAYER_FOAM_SHARE = 3 }; /* inputs; the latter: of each particle */
enum { SSFR_LAYER_BEHIND, SSFR_LAYER_BEFORE, SSFR_N_LAYERS }; /* the outputs */

typedef struct ssfr_layer_thickness_coeffs {
    ssfr_thickness_coeffs thickness; /* first */
    double open; /* share of the water that is before the foam where there is none */
    int by_centre;
} ssfr_layer_thickness_coeffs;

void ssfr_layer_thickness_cpu(const ssfr_run *run);

#endif

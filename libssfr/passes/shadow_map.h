/* SPDX-License-Identifier: MIT */
/* shadow_map.h: where the light meets solids first; see shadow_map.c. */
#ifndef SSFR_SHADOW_MAP_H
#define SSFR_SHADOW_MAP_H

#include "passes/light_view.h"

typedef struct ssfr_shadow_map_coeffs {
    ssfr_light_view view;
    double texel; /* m */
} ssfr_shadow_map_coeffs;

void ssfr_shadow_map_cpu(const ssfr_run *run);

#endif

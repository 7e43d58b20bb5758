/* SPDX-License-Identifier: MIT */
/* bagar2010.c: water smoothed alike at every distance, in layers, and spray; what is foam is taken from the water, but
 * not drawn. */
#include "graph/pass.h"

const ssfr_pipeline ssfr_pipeline_bagar2010 = {
    .name = "bagar2010",
    .source = "Bagar 2010, secs 3.1, 3.2.1, 3.2.3, 4.2, 4.6, 4.7, 4.9.4 and 4.9.5",
    .help = "screen-space fluid rendering with adaptive curvature flow, in layers; the foam is to come",
    .result = SSFR_SLOT_color,
    .nodes = {
        {"weber", "weber_foam"},
        {"sparse"},
        {"background"},
        {"sphere_depth"},
        {"foam_depth"},
        {"downsample"},
        {"adaptive_flow"},
        {"upsample"},
        {"normals"},
        {"layer_thickness"},
        {"foam_thickness"},
        {"shadow_map"},
        {"shadow_basis"},
        {"shadow"},
        {"layer_composite"},
        {"spray"},
    },
};

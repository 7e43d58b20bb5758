/* SPDX-License-Identifier: MIT */
/* bagar2010.c: water smoothed alike at every distance, and foam, in layers, and spray. */
#include "graph/pass.h"

const ssfr_pipeline ssfr_pipeline_bagar2010 = {
    .name = "bagar2010",
    .source = "Bagar 2010, secs 3.1, 3.2, 4.2 and 4.6 to 4.9, without shadows",
    .help = "screen-space fluid rendering with adaptive curvature flow, foam between two layers of water, and spray",
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
        {"layer_composite"},
        {"spray"},
    },
};

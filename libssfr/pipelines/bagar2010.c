/* SPDX-License-Identifier: MIT */
/* bagar2010.c: water without foam, smoothed alike at every distance. */
#include "graph/pass.h"

const ssfr_pipeline ssfr_pipeline_bagar2010 = {
    .name = "bagar2010",
    .source = "Bagar 2010, secs 3.1 and 4.7, without the layers of foam",
    .help = "screen-space fluid rendering with adaptive curvature flow: depth, smoothing, normals, thickness, shading",
    .result = SSFR_SLOT_color,
    .nodes = {
        {"background"},
        {"sphere_depth"},
        {"downsample"},
        {"adaptive_flow"},
        {"upsample"},
        {"normals"},
        {"thickness"},
        {"composite", .ports = {{"normal", SSFR_SLOT_normal}}},
    },
};

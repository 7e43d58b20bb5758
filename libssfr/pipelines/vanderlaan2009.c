/* SPDX-License-Identifier: MIT */
/* vanderlaan2009.c: screen-space fluid rendering with curvature flow. */
#include "graph/pass.h"

const ssfr_pipeline ssfr_pipeline_vanderlaan2009 = {
    .name = "vanderlaan2009",
    .source = "van der Laan, Green, Sainz 2009, as Bagar 2010 describes it in sec. 2.5.3",
    .help = "screen-space fluid rendering with curvature flow: depth, smoothing, normals, thickness, noise, foam",
    .result = SSFR_SLOT_color,
    .nodes = {
        {"background"},
        {"sphere_depth"},
        {"downsample"},
        {"curvature_flow"},
        {"upsample"},
        {"normals"},
        {"thickness"},
        {"surface_noise"},
        {"noise_normals"},
        {"composite"},
        {"noise_foam", .settings = {"strength=0"}}, /* off until asked for: the papers time and show both */
    },
};

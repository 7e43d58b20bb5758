/* SPDX-License-Identifier: MIT */
/* vanderlaan2009.c: screen-space fluid rendering with curvature flow. */
#include "graph/pass.h"

/* The stages that Bagar 2010 divides his frame into (sec. 5.2). */
#define DEPTH "depth_passes"
#define THICKNESS "thickness_passes"
#define FLOW "curvature_flow"
#define COMPOSITE "composite_and_update"

const ssfr_pipeline ssfr_pipeline_vanderlaan2009 = {
    .name = "vanderlaan2009",
    .source = "van der Laan, Green, Sainz 2009, as Bagar 2010 describes it in sec. 2.5.3",
    .help = "screen-space fluid rendering with curvature flow: depth, smoothing, normals, thickness, noise, foam",
    .result = SSFR_SLOT_color,
    .nodes = {
        {"background"},
        {"sphere_depth", .stage = DEPTH},
        {"downsample", .stage = FLOW},
        {"curvature_flow", .stage = FLOW},
        {"upsample", .stage = FLOW},
        {"normals", .stage = COMPOSITE},
        {"thickness", .stage = THICKNESS},
        {"surface_noise", .stage = THICKNESS},
        {"noise_normals", .stage = COMPOSITE},
        {"composite", .stage = COMPOSITE},
        /* off until asked for: the papers time and show both */
        {"noise_foam", .stage = COMPOSITE, .settings = {"strength=0"}},
    },
};

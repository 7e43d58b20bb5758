/* SPDX-License-Identifier: MIT */
/* bagar2010.c: water smoothed alike at every distance, and foam, in layers, and spray. The compositing reads the
 * smoothed depth; with surface=image upsample and normals are between them. */
#include "graph/pass.h"

/* The stages of sec. 5.2; "update of data structures" belongs to the composition. Drawing the scene is none of them. */
#define DEPTH "depth_passes"
#define THICKNESS "thickness_passes"
#define FLOW "adaptive_curvature_flow"
#define COMPOSITE "composite_and_update"

const ssfr_pipeline ssfr_pipeline_bagar2010 = {
    .name = "bagar2010",
    .source = "Bagar 2010, chapters 3 and 4",
    .help = "screen-space fluid rendering with adaptive curvature flow: layers of water and foam, and spray",
    .result = SSFR_SLOT_color,
    .nodes = {
        {"weber", "weber_foam", .stage = COMPOSITE},
        {"sparse", .stage = COMPOSITE},
        {"background"},
        {"sphere_depth", .stage = DEPTH},
        {"foam_depth", .stage = DEPTH},
        {"downsample", .stage = FLOW},
        {"adaptive_flow", .stage = FLOW},
        {"upsample", .stage = FLOW},
        {"normals", .stage = COMPOSITE},
        {"layer_thickness", .stage = THICKNESS},
        {"foam_thickness", .stage = THICKNESS},
        {"shadow_map", .stage = COMPOSITE},
        {"shadow_basis", .stage = COMPOSITE},
        /* The smoothed depth is of a lower resolution; it lies within a radius of this one, and so does the bias. */
        {"shadow", .stage = COMPOSITE, .ports = {{"depth", SSFR_SLOT_fluid_depth}}},
        {"layer_composite", .stage = COMPOSITE, .settings = {"surface=split"}},
        {"spray", .stage = COMPOSITE},
    },
};

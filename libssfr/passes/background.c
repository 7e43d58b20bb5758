/* SPDX-License-Identifier: MIT */
/* background.c: the scene without the fluid: floor, boxes, sky. */
#include "passes/background.h"

const ssfr_pass ssfr_background = {
    .name = "background",
    .source = "Bagar 2010, sec. 4.4 (the main scene's colour and depth; the scene itself is ours)",
    .help = "the scene behind the fluid: chequered floor, boxes and a procedural sky, or images of your own",
    .outputs = {{"color", SSFR_SLOT_scene_color}, {"depth", SSFR_SLOT_scene_depth}},
    .whole_screen = true,
    .cpu_run = ssfr_background_cpu,
    .programs = {{"tiles.vert", "background.frag", NULL}},
    .tolerance = {.abs = 2e-4, .rel = 2e-4, .outliers = 0.002},
};

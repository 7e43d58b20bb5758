/* SPDX-License-Identifier: MIT */
/* foam_depth.c: the frontmost foam, as eye-space depth: water before it and behind it are layers of their own. */
#include "passes/foam_depth.h"

static const ssfr_param rows[] = {SSFR_STREAK_ROWS, SSFR_PARAM_END};
static const ssfr_uniform uniforms[] = {SSFR_STREAK_UNIFORMS, {NULL, 0, 0}};

static void widen(const ssfr_run *run, ssfr_tolerance *tolerance)
{
    const ssfr_streak *streak = run->coeffs;
    tolerance->abs += ssfr_root_rounding(streak->root) * streak->radius;
}

const ssfr_pass ssfr_foam_depth = {
    .name = "foam_depth",
    .source = "Bagar 2010, sec. 4.6.2 and listing A.10 (erratum B24)",
    .help = "draws every foam particle as a quad along its velocity and keeps the nearest eye-space depth",
    .inputs = {{"scene_depth", SSFR_SLOT_scene_depth}, SSFR_STREAK_PORTS(SSFR_SLOT_foam_size)},
    .outputs = {{"depth", SSFR_SLOT_foam_depth}},
    .tables = {SSFR_STREAK_TABLES},
    .params = rows,
    .params_size = sizeof(ssfr_streak_params),
    .coeffs_size = sizeof(ssfr_streak),
    .derive = ssfr_streak_derive,
    .needed = ssfr_streak_needed,
    .needless = "no foam in view",
    .reach = ssfr_streak_reach,
    .cpu_run = ssfr_foam_depth_cpu,
    .programs = SSFR_STREAK_PROGRAMS("foam_depth.frag", NULL),
    .defines = ssfr_streak_defines,
    .uniforms = uniforms,
    .gl_run = ssfr_streak_gl_nearest,
    .work = ssfr_streak_work,
    .tolerance = {.abs = 1e-5, .rel = 2e-6, .outliers = 0.004},
    .widen = widen,
};

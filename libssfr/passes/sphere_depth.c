/* SPDX-License-Identifier: MIT */
/* sphere_depth.c: the frontmost surface of the particles' spheres, as eye-space depth. */
#include "passes/sphere_depth.h"

static const ssfr_param rows[] = {SSFR_SPLAT_ROWS, SSFR_PARAM_END};
static const ssfr_uniform uniforms[] = {SSFR_SPLAT_UNIFORMS, {NULL, 0, 0}};

static void widen(const ssfr_run *run, ssfr_tolerance *tolerance)
{
    const ssfr_splat *splat = run->coeffs;
    tolerance->abs += ssfr_root_rounding(splat->root) * splat->radius;
}

const ssfr_pass ssfr_sphere_depth = {
    .name = "sphere_depth",
    .source = "van der Laan 2009, after Bagar 2010, sec. 2.5.3 and listings A.8, A.9",
    .help = "splats every particle as a sphere and keeps the nearest eye-space depth",
    .inputs = {{"scene_depth", SSFR_SLOT_scene_depth}, SSFR_SPLAT_SIZE_PORT},
    .outputs = {{"depth", SSFR_SLOT_fluid_depth}},
    .tables = SSFR_SPLAT_TABLES,
    .params = rows,
    .params_size = sizeof(ssfr_splat_params),
    .coeffs_size = sizeof(ssfr_splat),
    .derive = ssfr_splat_derive,
    .needed = ssfr_splat_needed,
    .needless = SSFR_SPLAT_NEEDLESS,
    .reach = ssfr_splat_reach,
    .cpu_run = ssfr_sphere_depth_cpu,
    .programs = SSFR_SPLAT_PROGRAMS("sphere_depth.frag", ""),
    .defines = ssfr_splat_defines,
    .uniforms = uniforms,
    .gl_run = ssfr_splat_gl_nearest,
    .work = ssfr_splat_work,
    .tolerance = {.abs = 1e-5, .rel = 2e-6, .outliers = 0.004},
    .widen = widen,
};

/* SPDX-License-Identifier: MIT */
/* thickness.c: length of fluid along the view ray: each particle adds its chord. */
#include "passes/thickness.h"

const char *const ssfr_thickness_kernels[] = {"chord", "exponential", NULL};
const char *const ssfr_thickness_occlusions[] = {"front", "clipped", NULL};

static const ssfr_param rows[] = {SSFR_THICKNESS_ROWS, SSFR_PARAM_END};
static const ssfr_uniform uniforms[] = {SSFR_THICKNESS_UNIFORMS, {NULL, 0, 0}};

void ssfr_thickness_derive(const ssfr_run *run, void *coeffs)
{
    const ssfr_thickness_params *p = run->params;
    ssfr_thickness_coeffs *c = coeffs;
    ssfr_splat_derive(run, &c->splat);
    /* A wider splat spreads the volume of the particle: its own sphere has it at radius_scale 1. */
    const double s = p->splat.radius_scale;
    c->sum = (ssfr_thickness_sum){p->scale / (s * s * s), p->kernel == 1, p->occlusion == 1,
                                  p->storage == SSFR_STORE_HALF};
}

ssfr_storage ssfr_thickness_storage(const void *params)
{
    return (ssfr_storage)((const ssfr_thickness_params *)params)->storage;
}

/* Of n chords 2 R h, whose mean height h is 2/3. */
void ssfr_thickness_widen(const ssfr_run *run, ssfr_tolerance *tolerance)
{
    const ssfr_thickness_coeffs *c = run->coeffs;
    tolerance->abs += 2 * c->splat.radius * c->sum.scale * ssfr_root_rounding(c->splat.root);
    tolerance->rel += 1.5 * ssfr_root_rounding(c->splat.root);
}

const ssfr_pass ssfr_thickness = {
    .name = "thickness",
    .source = "van der Laan 2009, after Bagar 2010, eqs 2.17 and 3.4, listing A.15",
    .help = "adds up each particle's thickness along the view ray",
    .inputs = {{"scene_depth", SSFR_SLOT_scene_depth}, SSFR_SPLAT_SIZE_PORT},
    .outputs = {{"thickness", SSFR_SLOT_thickness}},
    .tables = SSFR_SPLAT_TABLES,
    .params = rows,
    .params_size = sizeof(ssfr_thickness_params),
    .coeffs_size = sizeof(ssfr_thickness_coeffs),
    .derive = ssfr_thickness_derive,
    .needed = ssfr_splat_needed,
    .needless = SSFR_SPLAT_NEEDLESS,
    .reach = ssfr_splat_reach,
    .storage = ssfr_thickness_storage,
    .cpu_run = ssfr_thickness_cpu,
    .programs = SSFR_SPLAT_PROGRAMS("thickness.frag", ""),
    .defines = ssfr_splat_defines,
    .uniforms = uniforms,
    .gl_run = ssfr_splat_gl_add,
    .work = ssfr_splat_work,
    .tolerance = SSFR_THICKNESS_TOLERANCE,
    .half_tolerance = SSFR_THICKNESS_HALF_TOLERANCE,
    .widen = ssfr_thickness_widen,
};

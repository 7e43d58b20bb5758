/* SPDX-License-Identifier: MIT */
/* thickness.c: length of fluid along the view ray: each particle adds its chord. */
#include "passes/thickness.h"

typedef struct thickness_params {
    ssfr_splat_params splat;
    int kernel, occlusion;
    double scale;
} thickness_params;

static const char *const kernels[] = {"chord", "exponential", NULL};
static const char *const occlusions[] = {"front", "clipped", NULL};

static const ssfr_param rows[] = {
    SSFR_SPLAT_ROWS,
    SSFR_PARAM_CHOICE(thickness_params, kernel, kernels, 0,
                      "chord of the sphere, or the chord times e^(-2 r^2), which leaves no edges but 51 % of the "
                      "volume"),
    SSFR_PARAM_CHOICE(thickness_params, occlusion, occlusions, 0,
                      "a particle whose front is before the scene counts whole, or with its part before the scene"),
    SSFR_PARAM_REAL(thickness_params, scale, "1", 1, 0, 100, "multiplies the sum: spheres do not fill space"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    SSFR_SPLAT_UNIFORMS,
    {"u_scale", offsetof(ssfr_thickness_coeffs, scale), 1},
    {"u_exponential", offsetof(ssfr_thickness_coeffs, exponential), 0},
    {"u_clipped", offsetof(ssfr_thickness_coeffs, clipped), 0},
    {NULL, 0, 0},
};

static void derive(const ssfr_run *run, void *coeffs)
{
    const thickness_params *p = run->params;
    ssfr_thickness_coeffs *c = coeffs;
    ssfr_splat_derive(run, &c->splat);
    /* A wider splat spreads the volume of the particle: its own sphere has it at radius_scale 1. */
    c->scale = p->scale / (p->splat.radius_scale * p->splat.radius_scale * p->splat.radius_scale);
    c->exponential = p->kernel == 1;
    c->clipped = p->occlusion == 1;
}

const ssfr_pass ssfr_thickness = {
    .name = "thickness",
    .source = "van der Laan 2009, after Bagar 2010, eqs 2.17 and 3.4, listing A.15",
    .help = "adds up each particle's thickness along the view ray",
    .inputs = {{"scene_depth", SSFR_SLOT_scene_depth}, SSFR_SPLAT_SIZE_PORT},
    .outputs = {{"thickness", SSFR_SLOT_thickness}},
    .params = rows,
    .params_size = sizeof(thickness_params),
    .coeffs_size = sizeof(ssfr_thickness_coeffs),
    .derive = derive,
    .needed = ssfr_splat_needed,
    .needless = SSFR_SPLAT_NEEDLESS,
    .reach = ssfr_splat_reach,
    .cpu_run = ssfr_thickness_cpu,
    .programs = SSFR_SPLAT_PROGRAMS("thickness.frag", ""),
    .defines = ssfr_splat_defines,
    .uniforms = uniforms,
    .gl_run = ssfr_splat_gl_add,
    .work = ssfr_splat_work,
    .tolerance = {.abs = 2e-4, .rel = 1e-4, .outliers = 0.02},
};

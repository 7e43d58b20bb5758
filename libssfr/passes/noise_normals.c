/* SPDX-License-Identifier: MIT */
/* noise_normals.c: adds the surface noise's slope to the normals (Bagar 2010, sec. 2.5.3). */
#include "passes/noise_normals.h"

typedef struct noise_normals_params {
    double height;
} noise_normals_params;

static const ssfr_param rows[] = {
    SSFR_PARAM_REAL(noise_normals_params, height, "radii", 0, 0, 100, "height of waves of noise 1, in particle radii"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    {"u_height", offsetof(ssfr_noise_normals_coeffs, height), 1},
    {"u_c", offsetof(ssfr_noise_normals_coeffs, c), 2},
    {NULL, 0, 0},
};

static void derive(const ssfr_run *run, void *coeffs)
{
    const noise_normals_params *p = run->params;
    ssfr_noise_normals_coeffs *c = coeffs;
    c->height = p->height * run->frame->radius;
    for (int k = 0; k < 2; k++) c->c[k] = run->frame->block.image[2 + k] * run->divisor;
}

static bool needed(const ssfr_run *run)
{
    return ((const noise_normals_params *)run->params)->height > 0 && run->frame->facts.fluid;
}

const ssfr_pass ssfr_noise_normals = {
    .name = "noise_normals",
    .source = "van der Laan 2009, after Bagar 2010, sec. 2.5.3 (Fig. 2.10)",
    .help = "disturbs the normals by the slope of the surface noise",
    .inputs = {{"normal", SSFR_SLOT_normal}, {"noise", SSFR_SLOT_noise}, {"depth", SSFR_SLOT_surface_depth}},
    .outputs = {{"shading_normal", SSFR_SLOT_shading_normal, .like = "normal", .from = "normal"}},
    .params = rows,
    .params_size = sizeof(noise_normals_params),
    .coeffs_size = sizeof(ssfr_noise_normals_coeffs),
    .taps = 10,
    .derive = derive,
    .needed = needed,
    .needless = "waves of height 0, or no fluid in view",
    .cpu_run = ssfr_noise_normals_cpu,
    .programs = {{"tiles.vert", "noise_normals.frag", NULL}},
    .uniforms = uniforms,
    .tolerance = {.abs = 2e-3, .rel = 0, .outliers = 0.01},
};

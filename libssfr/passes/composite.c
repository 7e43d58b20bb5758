/* SPDX-License-Identifier: MIT */
/* composite.c: the fluid's surface shaded over the scene (Bagar 2010, eqs 2.18 and 2.19):
 *
 *     a = c_fluid + (S(x + beta n_x, y + beta n_y) - c_fluid) e^-T,   beta = gamma T,
 *     C = a (1 - F) + b F + k_s (n . h)^alpha. */
#include "passes/composite.h"

typedef struct composite_params {
    ssfr_optics optics; /* first */
    int fresnel, refraction;
} composite_params;

static const char *const fresnels[] = {"schlick", "exact", NULL};
static const char *const refractions[] = {"offset", "snell", NULL};

static const ssfr_param rows[] = {
    SSFR_PARAM_CHOICE(composite_params, fresnel, fresnels, SSFR_FRESNEL_SCHLICK,
                      "Schlick's approximation, or Fresnel's equations for a dielectric"),
    SSFR_PARAM_CHOICE(composite_params, refraction, refractions, SSFR_REFRACTION_OFFSET,
                      "shift the background by gamma T n (eq. 2.18), or follow the refracted ray through the "
                      "thickness"),
    SSFR_OPTICS_SHIFT_ROW,
    SSFR_OPTICS_SCENE_ROWS,
    SSFR_OPTICS_WATER_ROWS,
    SSFR_OPTICS_HIGHLIGHT_ROWS,
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    SSFR_OPTICS_UNIFORMS,
    {"u_gamma", offsetof(ssfr_composite_coeffs, optics.gamma), 1},
    {"u_r0", offsetof(ssfr_composite_coeffs, r0), 1},
    {"u_fresnel", offsetof(ssfr_composite_coeffs, fresnel), 0},
    {"u_refraction", offsetof(ssfr_composite_coeffs, refraction), 0},
    {NULL, 0, 0},
};

static void derive(const ssfr_run *run, void *coeffs)
{
    const composite_params *p = run->params;
    const double ior = run->frame->block.absorption[3];
    *(ssfr_composite_coeffs *)coeffs = (ssfr_composite_coeffs){
        .optics = p->optics, .r0 = ssfr_square((ior - 1) / (ior + 1)), .fresnel = p->fresnel,
        .refraction = p->refraction};
}

const ssfr_pass ssfr_composite = {
    .name = "composite",
    .source = "van der Laan 2009, after Bagar 2010, sec. 2.5.3 (eqs 2.18, 2.19)",
    .help = "shades the surface over the scene: refraction, attenuation, reflection, highlight",
    .inputs = {{"scene_color", SSFR_SLOT_scene_color}, {"scene_depth", SSFR_SLOT_scene_depth},
               {"depth", SSFR_SLOT_surface_depth}, {"normal", SSFR_SLOT_shading_normal},
               {"thickness", SSFR_SLOT_thickness}},
    .outputs = {{"color", SSFR_SLOT_color, .from = "scene_color", .over = "scene_color"}},
    .params = rows,
    .params_size = sizeof(composite_params),
    .coeffs_size = sizeof(ssfr_composite_coeffs),
    .taps = 9, /* the scene's colour 4, and 1 to begin as it; its depth; depth, normal and thickness */
    .derive = derive,
    .needed = ssfr_needs_fluid,
    .needless = SSFR_NO_FLUID ": the picture is the scene",
    .cpu_run = ssfr_composite_cpu,
    .programs = {{"tiles.vert", "composite.frag", NULL}},
    .defines = ssfr_optics_defines,
    .uniforms = uniforms,
    .tolerance = {.abs = 1e-3, .rel = 1e-3, .outliers = 0.01},
};

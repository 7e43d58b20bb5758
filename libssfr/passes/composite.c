/* SPDX-License-Identifier: MIT */
/* composite.c: the fluid's surface shaded over the scene (Bagar 2010, eqs 2.18 and 2.19):
 *
 *     a = c_fluid + (S(x + beta n_x, y + beta n_y) - c_fluid) e^-T,   beta = gamma T,
 *     C = a (1 - F) + b F + k_s (n . h)^alpha. */
#include "passes/composite.h"
#include "passes/environment.h"

typedef struct composite_params {
    int fresnel, refraction, reject, reflection, attenuation_form;
    double gamma, attenuation, specular, shininess;
} composite_params;

static const char *const fresnels[] = {"schlick", "exact", NULL};
static const char *const refractions[] = {"offset", "snell", NULL};
static const char *const reflections[] = {"sky", "scene", NULL};
static const char *const attenuations[] = {"beer_lambert", "single", NULL};

static const ssfr_param rows[] = {
    SSFR_PARAM_CHOICE(composite_params, fresnel, fresnels, SSFR_FRESNEL_SCHLICK,
                      "Schlick's approximation, or Fresnel's equations for a dielectric"),
    SSFR_PARAM_CHOICE(composite_params, refraction, refractions, SSFR_REFRACTION_OFFSET,
                      "shift the background by gamma T n (eq. 2.18), or follow the refracted ray through the "
                      "thickness"),
    SSFR_PARAM_REAL(composite_params, gamma, "1/m", 0.1, 0, 1e3, "shift in image heights a metre of thickness"),
    SSFR_PARAM_FLAG(composite_params, reject, 1, "do not refract what stands before the water"),
    SSFR_PARAM_CHOICE(composite_params, reflection, reflections, SSFR_REFLECTION_SKY,
                      "reflect the sky alone, as an environment map does, or floor and solids too"),
    {"attenuation", SSFR_CHOICE, "1",
     "Beer-Lambert by colour with medium.absorption, or e^(-k T) with one k (eq. 2.18)",
     offsetof(composite_params, attenuation_form), SSFR_ATTENUATION_BEER, 0, 0, attenuations},
    {"k", SSFR_REAL, "1/m", "the single attenuation coefficient", offsetof(composite_params, attenuation), 1, 0, 1e6,
     NULL},
    SSFR_PARAM_REAL(composite_params, specular, "1", 0.6, 0, 100, "k_s of the highlight"),
    SSFR_PARAM_REAL(composite_params, shininess, "1", 250, 1, 1e5, "alpha of the highlight"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    {"u_gamma", offsetof(ssfr_composite_coeffs, gamma), 1},
    {"u_attenuation", offsetof(ssfr_composite_coeffs, attenuation), 1},
    {"u_specular", offsetof(ssfr_composite_coeffs, specular), 1},
    {"u_shininess", offsetof(ssfr_composite_coeffs, shininess), 1},
    {"u_r0", offsetof(ssfr_composite_coeffs, r0), 1},
    {"u_fresnel", offsetof(ssfr_composite_coeffs, fresnel), 0},
    {"u_refraction", offsetof(ssfr_composite_coeffs, refraction), 0},
    {"u_reject", offsetof(ssfr_composite_coeffs, reject), 0},
    {"u_reflection", offsetof(ssfr_composite_coeffs, reflection), 0},
    {"u_single", offsetof(ssfr_composite_coeffs, single), 0},
    {NULL, 0, 0},
};

static void derive(const ssfr_run *run, void *coeffs)
{
    const composite_params *p = run->params;
    const double ior = run->frame->block.absorption[3];
    *(ssfr_composite_coeffs *)coeffs = (ssfr_composite_coeffs){
        .gamma = p->gamma, .attenuation = p->attenuation, .specular = p->specular, .shininess = p->shininess,
        .r0 = ssfr_square((ior - 1) / (ior + 1)), .fresnel = p->fresnel, .refraction = p->refraction,
        .reject = p->reject, .reflection = p->reflection, .single = p->attenuation_form == SSFR_ATTENUATION_SINGLE};
}

/* Without solids where none is reflected. */
static bool defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    const ssfr_composite_coeffs *c = run->coeffs;
    const bool solids = c->reflection == SSFR_REFLECTION_SCENE;
    (void)i;
    ssfr_environment_defines(run->frame, solids, solids, text);
    return true;
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
    .defines = defines,
    .uniforms = uniforms,
    .tolerance = {.abs = 1e-3, .rel = 1e-3, .outliers = 0.01},
};

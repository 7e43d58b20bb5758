/* SPDX-License-Identifier: MIT */
/* noise_foam.c: foam on the surface, "by adding a grayish color depending on the magnitude of the noise" (Bagar 2010,
 * sec. 2.5.3):
 *
 *     C' = C + w L c,   w = strength smoothstep(threshold, threshold + softness, |noise|).
 *
 * The text says no more. Here the grey c is lit as floor and solids are, by L = ambient + (1 - ambient) n . l, and
 * `over` has foam hide what it covers: C' = (1 - w) C + w L c. */
#include "passes/noise_foam.h"

typedef struct noise_foam_params {
    double strength, threshold, softness, color_r, color_g, color_b;
    int blend;
} noise_foam_params;

static const char *const blends[] = {"add", "over", NULL};

static const ssfr_param rows[] = {
    SSFR_PARAM_REAL(noise_foam_params, strength, "1", 1, 0, 1, "share of the colour where foam is full; 0: none"),
    SSFR_PARAM_REAL(noise_foam_params, threshold, "1", 0.15, 0, 1e3, "magnitude of the noise where foam begins"),
    SSFR_PARAM_REAL(noise_foam_params, softness, "1", 0.2, 0, 1e3, "by how much more it is where foam is full"),
    SSFR_PARAM_REAL(noise_foam_params, color_r, "1", 0.4, 0, 1, "reflectance of the foam, linear, red"),
    SSFR_PARAM_REAL(noise_foam_params, color_g, "1", 0.42, 0, 1, "reflectance of the foam, linear, green"),
    SSFR_PARAM_REAL(noise_foam_params, color_b, "1", 0.44, 0, 1, "reflectance of the foam, linear, blue"),
    SSFR_PARAM_CHOICE(noise_foam_params, blend, blends, SSFR_FOAM_ADD,
                      "add the foam's light to the water's, or have it cover the water"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    {"u_strength", offsetof(ssfr_noise_foam_coeffs, strength), 1},
    {"u_threshold", offsetof(ssfr_noise_foam_coeffs, threshold), 1},
    {"u_softness", offsetof(ssfr_noise_foam_coeffs, softness), 1},
    {"u_color", offsetof(ssfr_noise_foam_coeffs, color), 3},
    {"u_blend", offsetof(ssfr_noise_foam_coeffs, blend), 0},
    {NULL, 0, 0},
};

static void derive(const ssfr_run *run, void *coeffs)
{
    const noise_foam_params *p = run->params;
    *(ssfr_noise_foam_coeffs *)coeffs = (ssfr_noise_foam_coeffs){
        .strength = p->strength, .threshold = p->threshold, .softness = p->softness,
        .color = {p->color_r, p->color_g, p->color_b}, .blend = p->blend};
}

static bool needed(const ssfr_run *run)
{
    return ((const noise_foam_params *)run->params)->strength > 0 && run->frame->facts.fluid;
}

const ssfr_pass ssfr_noise_foam = {
    .name = "noise_foam",
    .source = "van der Laan 2009, after Bagar 2010, sec. 2.5.3 (Fig. 1.1)",
    .help = "draws greyish foam over the picture where the surface noise is strong",
    /* `water` is the version of the picture before this pass. */
    .inputs = {{"water", SSFR_SLOT_color}, {"noise", SSFR_SLOT_noise}, {"depth", SSFR_SLOT_surface_depth},
               {"normal", SSFR_SLOT_shading_normal}},
    .outputs = {{"color", SSFR_SLOT_color, .from = "water", .over = "water"}},
    .params = rows,
    .params_size = sizeof(noise_foam_params),
    .coeffs_size = sizeof(ssfr_noise_foam_coeffs),
    .taps = 5, /* the inputs, and the water's colour once more to begin as it */
    .derive = derive,
    .needed = needed,
    .needless = "foam of strength 0, or no fluid in view",
    .cpu_run = ssfr_noise_foam_cpu,
    .programs = {{"tiles.vert", "noise_foam.frag", NULL}},
    .uniforms = uniforms,
    .tolerance = {.abs = 1e-4, .rel = 1e-4, .outliers = 0.01},
};

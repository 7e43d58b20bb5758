/* SPDX-License-Identifier: MIT */
/* shadow_map.c: where the light meets solids first (Williams 1978), one ray a texel. */
#include "passes/shadow_map.h"

#include "passes/environment.h"

typedef struct shadow_map_params {
    int size;
} shadow_map_params;

static const ssfr_param rows[] = {
    SSFR_PARAM_INT(shadow_map_params, size, "px", 512, 1, 4096, "side of the light's square"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    SSFR_LIGHT_VIEW_UNIFORMS(ssfr_shadow_map_coeffs),
    {"u_texel", offsetof(ssfr_shadow_map_coeffs, texel), 1},
    {NULL, 0, 0},
};

static void size(const void *params, const int in[2], int out[2])
{
    (void)in;
    out[0] = out[1] = ((const shadow_map_params *)params)->size;
}

static void derive(const ssfr_run *run, void *coeffs)
{
    ssfr_shadow_map_coeffs *c = coeffs;
    *c = (ssfr_shadow_map_coeffs){.view = ssfr_light_view_of(run->frame)};
    c->texel = c->view.extent / run->w;
}

static bool defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    const bool casters = ((const ssfr_shadow_map_coeffs *)run->coeffs)->view.n_casters > 0;
    (void)i;
    ssfr_environment_defines(run->frame, casters, casters, text);
    return true;
}

const ssfr_pass ssfr_shadow_map = {
    .name = "shadow_map",
    .source = "Williams 1978; Bagar 2010, sec. 4.9.4 (shadow mapping of any kind)",
    .help = "what the light sees of the solids that stand between it and the fluid in view",
    .outputs = {{"light_depth", SSFR_SLOT_light_depth}},
    .params = rows,
    .params_size = sizeof(shadow_map_params),
    .coeffs_size = sizeof(ssfr_shadow_map_coeffs),
    .whole_screen = true,
    .size = size,
    .derive = derive,
    .needed = ssfr_light_view_has_casters,
    .needless = SSFR_NO_CASTER,
    .cpu_run = ssfr_shadow_map_cpu,
    .programs = {{"tiles.vert", "shadow_map.frag", NULL}},
    .defines = defines,
    .uniforms = uniforms,
    .tolerance = {.abs = 1e-4, .rel = 1e-4, .outliers = 0.01},
};

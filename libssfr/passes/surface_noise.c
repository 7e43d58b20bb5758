/* SPDX-License-Identifier: MIT */
/* surface_noise.c: one octave of Perlin noise a particle, which moves with the fluid (Bagar 2010, sec. 2.5.3). */
#include "passes/surface_noise.h"

typedef struct surface_noise_params {
    ssfr_splat_params splat;
    double frequency, sharpness, depth_falloff;
} surface_noise_params;

static const ssfr_param rows[] = {
    SSFR_SPLAT_ROWS,
    SSFR_PARAM_REAL(surface_noise_params, frequency, "1", 2, 0, 64, "noise cells a splat radius"),
    SSFR_PARAM_REAL(surface_noise_params, sharpness, "1", 2, 0, 64, "of the Gaussian kernel e^(-sharpness r^2)"),
    SSFR_PARAM_REAL(surface_noise_params, depth_falloff, "1/radius", 1, 0, 1e6,
                    "a particle's noise falls by e for each 1/depth_falloff particle radii below the surface"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    SSFR_SPLAT_UNIFORMS,
    {"u_frequency", offsetof(ssfr_surface_noise_coeffs, frequency), 1},
    {"u_sharpness", offsetof(ssfr_surface_noise_coeffs, sharpness), 1},
    {"u_falloff", offsetof(ssfr_surface_noise_coeffs, falloff), 1},
    {"u_has_ids", offsetof(ssfr_surface_noise_coeffs, has_ids), 0},
    {NULL, 0, 0},
};

static void derive(const ssfr_run *run, void *coeffs)
{
    const surface_noise_params *p = run->params;
    ssfr_surface_noise_coeffs *c = coeffs;
    ssfr_splat_derive(run, &c->splat);
    c->frequency = p->frequency;
    c->sharpness = p->sharpness;
    c->falloff = run->frame->radius > 0 ? p->depth_falloff / run->frame->radius : 0;
    c->has_ids = run->frame->particles && run->frame->particles->id;
}

static bool defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    return ssfr_splat_define(run, i, "#define PARTICLE\n", text);
}

/* Heights decide how deep below the surface a fragment is; noise is below 1, and few particles are near the surface. */
static void widen(const ssfr_run *run, ssfr_tolerance *tolerance)
{
    const ssfr_surface_noise_coeffs *c = run->coeffs;
    tolerance->abs += 2 * c->falloff * c->splat.radius * ssfr_root_rounding(c->splat.root);
}

const ssfr_pass ssfr_surface_noise = {
    .name = "surface_noise",
    .source = "van der Laan 2009, after Bagar 2010, sec. 2.5.3 (Fig. 2.10)",
    .help = "noise that is advected with the particles, fading with the depth below the surface",
    .inputs = {{"depth", SSFR_SLOT_fluid_depth}},
    .outputs = {{"noise", SSFR_SLOT_noise}},
    .tables = SSFR_SPLAT_TABLES,
    .params = rows,
    .params_size = sizeof(surface_noise_params),
    .coeffs_size = sizeof(ssfr_surface_noise_coeffs),
    .uses_ids = true,
    .derive = derive,
    .needed = ssfr_splat_needed,
    .needless = SSFR_SPLAT_NEEDLESS,
    .reach = ssfr_splat_reach,
    .cpu_run = ssfr_surface_noise_cpu,
    .programs = SSFR_SPLAT_PROGRAMS("surface_noise.frag", "#define PARTICLE\n"),
    .defines = defines,
    .uniforms = uniforms,
    .gl_run = ssfr_splat_gl_add,
    .work = ssfr_splat_work,
    .tolerance = {.abs = 1e-3, .rel = 1e-3, .outliers = 0.02},
    .widen = widen,
};

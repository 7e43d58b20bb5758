/* SPDX-License-Identifier: MIT */
/* spray.c: spray over the finished picture (Bagar 2010, sec. 4.9.5): each particle adds
 *
 *     strength color e^(-falloff r^2),
 *
 * drawn along its velocity as foam is. The text speaks of an "exponential-based falloff" and no more: `kernel` has its
 * two readings, in r^2 as the thickness falls off (listing A.15), and in r as eq. 3.4 prints that. It tells of no test
 * of depth but the hardware's, against the scene: spray under water shines through, unless `occlusion` says no. */
#include "passes/spray.h"

typedef struct spray_params {
    ssfr_streak_params streak;
    double strength, color_r, color_g, color_b, falloff;
    int kernel, occlusion;
} spray_params;

static const char *const kernels[] = {"gaussian", "exponential", NULL};
static const char *const occlusions[] = {"scene", "surface", NULL};

static const ssfr_param rows[] = {
    SSFR_STREAK_ROWS,
    SSFR_PARAM_REAL(spray_params, strength, "1", 1, 0, 1e3, "multiplies the colour; 0: no spray"),
    SSFR_PARAM_REAL(spray_params, color_r, "1", 0.25, 0, 1e3, "what the middle of a particle adds, linear, red"),
    SSFR_PARAM_REAL(spray_params, color_g, "1", 0.265, 0, 1e3, "what the middle of a particle adds, linear, green"),
    SSFR_PARAM_REAL(spray_params, color_b, "1", 0.28, 0, 1e3, "what the middle of a particle adds, linear, blue"),
    SSFR_PARAM_REAL(spray_params, falloff, "1", 4, 0, 1e3, "how much less the outside of a particle adds: e^-falloff"),
    SSFR_PARAM_CHOICE(spray_params, kernel, kernels, SSFR_SPRAY_GAUSSIAN,
                      "falls off as e^(-falloff r^2), or as e^(-falloff r)"),
    SSFR_PARAM_CHOICE(spray_params, occlusion, occlusions, SSFR_SPRAY_BEHIND_SCENE,
                      "hidden by the scene alone, as in the paper, or by water and foam before it too"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    SSFR_STREAK_UNIFORMS,
    {"u_color", offsetof(ssfr_spray_coeffs, color), 3},
    {"u_falloff", offsetof(ssfr_spray_coeffs, falloff), 1},
    {"u_exponential", offsetof(ssfr_spray_coeffs, exponential), 0},
    {"u_by_surface", offsetof(ssfr_spray_coeffs, by_surface), 0},
    {NULL, 0, 0},
};

static bool reads(const void *params, int port)
{
    const bool by_surface = ((const spray_params *)params)->occlusion == SSFR_SPRAY_BEHIND_SURFACE;
    return by_surface || (port != SSFR_SPRAY_DEPTH && port != SSFR_SPRAY_FOAM_DEPTH);
}

static void derive(const ssfr_run *run, void *coeffs)
{
    const spray_params *p = run->params;
    ssfr_spray_coeffs *c = coeffs;
    ssfr_streak_derive(run, &c->streak);
    c->color[0] = p->strength * p->color_r, c->color[1] = p->strength * p->color_g;
    c->color[2] = p->strength * p->color_b;
    c->falloff = p->falloff;
    c->exponential = p->kernel == SSFR_SPRAY_EXPONENTIAL;
    c->by_surface = p->occlusion == SSFR_SPRAY_BEHIND_SURFACE;
}

static bool needed(const ssfr_run *run)
{
    return ((const spray_params *)run->params)->strength > 0 && ssfr_streak_needed(run);
}

const ssfr_pass ssfr_spray = {
    .name = "spray",
    .source = "Bagar 2010, sec. 4.9.5",
    .help = "adds spray particles to the picture, each along its velocity",
    /* `water` is the version of the picture before this pass. */
    .inputs = {{"water", SSFR_SLOT_color}, {"scene_depth", SSFR_SLOT_scene_depth}, {"depth", SSFR_SLOT_surface_depth},
               {"foam_depth", SSFR_SLOT_foam_depth}, SSFR_STREAK_PORTS(SSFR_SLOT_spray_size)},
    .outputs = {{"color", SSFR_SLOT_color, .from = "water", .over = "water"}},
    .tables = {SSFR_STREAK_TABLES},
    .params = rows,
    .params_size = sizeof(spray_params),
    .coeffs_size = sizeof(ssfr_spray_coeffs),
    .reads = reads,
    .derive = derive,
    .needed = needed,
    .needless = "spray of strength 0, or none in view",
    .reach = ssfr_streak_reach,
    .cpu_run = ssfr_spray_cpu,
    .programs = SSFR_STREAK_PROGRAMS("spray.frag", NULL),
    .defines = ssfr_streak_defines,
    .uniforms = uniforms,
    .gl_run = ssfr_streak_gl_add,
    .work = ssfr_streak_work,
    .tolerance = {.abs = 1e-4, .rel = 1e-4, .outliers = 0.004},
};

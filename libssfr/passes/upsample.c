/* SPDX-License-Identifier: MIT */
/* upsample.c: the smoothed depth back at full resolution, inside the outline of the unsmoothed one. */
#include "passes/upsample.h"

typedef struct upsample_params {
    int filter;
    double depth_falloff;
} upsample_params;

static const char *const filters[] = {"nearest", "linear", "cubic", NULL};

static const ssfr_param rows[] = {
    SSFR_PARAM_CHOICE(upsample_params, filter, filters, 2,
                      "nearest (what a paper's GL_NEAREST does), linear, or cubic B-spline, whose normals have no "
                      "facets"),
    SSFR_PARAM_REAL(upsample_params, depth_falloff, "radii", 5, 0, 1e6,
                    "low-resolution depths further than this from the pixel's own are another surface; in particle "
                    "radii"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    {"u_falloff", offsetof(ssfr_upsample_coeffs, falloff), 1},
    {"u_factor", offsetof(ssfr_upsample_coeffs, factor), 0},
    {"u_filter", offsetof(ssfr_upsample_coeffs, filter), 0},
    {NULL, 0, 0},
};

/* Pixels of the guide a pixel of the depth, along each axis. */
static int factor_of(const ssfr_run *run)
{
    return ssfr_max_int(run->divisor_in[0] / run->divisor, 1);
}

static void derive(const ssfr_run *run, void *coeffs)
{
    const upsample_params *p = run->params;
    const int factor = factor_of(run), filter = factor == 1 ? 0 : p->filter; /* nothing is between pixels at 1 */
    *(ssfr_upsample_coeffs *)coeffs = (ssfr_upsample_coeffs){
        .falloff = p->depth_falloff * run->frame->radius, .factor = factor, .filter = filter};
}

static bool needed(const ssfr_run *run)
{
    return factor_of(run) > 1 && run->frame->facts.fluid;
}

static void work(const ssfr_run *run, ssfr_node_report *report)
{
    static const double taps[] = {2, 5, 17};
    report->taps = taps[((const ssfr_upsample_coeffs *)run->coeffs)->filter];
}

const ssfr_pass ssfr_upsample = {
    .name = "upsample",
    .source = "Bagar 2010, sec. 4.9 (the smoothed depth is read at full resolution)",
    .help = "smoothed depth at full resolution, inside the outline of the unsmoothed depth",
    .inputs = {{"depth", SSFR_SLOT_smooth_depth, .any_size = true}, {"guide", SSFR_SLOT_fluid_depth}},
    .outputs = {{"surface", SSFR_SLOT_surface_depth, .like = "guide", .from = "depth"}},
    .params = rows,
    .params_size = sizeof(upsample_params),
    .coeffs_size = sizeof(ssfr_upsample_coeffs),
    .derive = derive,
    .needed = needed,
    .needless = "the guide's resolution already, or no fluid in view",
    .cpu_run = ssfr_upsample_cpu,
    .programs = {{"tiles.vert", "upsample.frag", NULL}},
    .uniforms = uniforms,
    .work = work,
    .tolerance = {.abs = 1e-5, .rel = 2e-6, .outliers = 0.002},
};

/* SPDX-License-Identifier: MIT */
/* downsample.c: depth at a lower resolution, because smoothing costs less there. */
#include "passes/downsample.h"

typedef struct downsample_params {
    int factor, rule;
} downsample_params;

static const char *const factors[] = {"1", "2", "4", "8", NULL};
static const char *const rules[] = {"nearest", "nearest_to_eye", "mean", NULL};

static const ssfr_param rows[] = {
    SSFR_PARAM_CHOICE(downsample_params, factor, factors, 1, "full, half, quarter or eighth resolution"),
    SSFR_PARAM_CHOICE(downsample_params, rule, rules, SSFR_DOWNSAMPLE_MEAN,
                      "the pixel right and below of the block's middle, the block's pixel nearest to the eye, or the "
                      "mean of the block's surface pixels"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    {"u_factor", offsetof(ssfr_downsample_coeffs, factor), 0},
    {"u_rule", offsetof(ssfr_downsample_coeffs, rule), 0},
    {NULL, 0, 0},
};

static int shrink(const void *params)
{
    return 1 << ((const downsample_params *)params)->factor;
}

static void derive(const ssfr_run *run, void *coeffs)
{
    const downsample_params *p = run->params;
    *(ssfr_downsample_coeffs *)coeffs = (ssfr_downsample_coeffs){.factor = shrink(p), .rule = p->rule};
}

static bool needed(const ssfr_run *run)
{
    return shrink(run->params) > 1 && run->frame->facts.fluid;
}

static void work(const ssfr_run *run, ssfr_node_report *report)
{
    const ssfr_downsample_coeffs *c = run->coeffs;
    report->taps = c->rule == SSFR_DOWNSAMPLE_NEAREST ? 1 : c->factor * c->factor;
}

const ssfr_pass ssfr_downsample = {
    .name = "downsample",
    .source = "Bagar 2010, sec. 4.7 (how the depth is scaled down is not said: erratum B34)",
    .help = "depth at half, quarter or eighth resolution",
    .inputs = {{"depth", SSFR_SLOT_fluid_depth, .any_size = true}},
    .outputs = {{"low", SSFR_SLOT_low_depth, .like = "depth", .from = "depth"}},
    .params = rows,
    .params_size = sizeof(downsample_params),
    .coeffs_size = sizeof(ssfr_downsample_coeffs),
    .derive = derive,
    .needed = needed,
    .needless = "full resolution, or no fluid in view",
    .shrink = shrink,
    .cpu_run = ssfr_downsample_cpu,
    .programs = {{"tiles.vert", "downsample.frag", NULL}},
    .uniforms = uniforms,
    .work = work,
    .tolerance = {.abs = 0, .rel = 1e-6, .outliers = 0},
};

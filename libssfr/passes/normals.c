/* SPDX-License-Identifier: MIT */
/* normals.c: unit normals of a depth image by finite differences (Bagar 2010, eq. 2.10). */
#include "passes/normals.h"

typedef struct normals_params {
    int edge, off_axis;
    double depth_falloff;
} normals_params;

static const char *const edges[] = {"smaller", "central", NULL};

static const ssfr_param rows[] = {
    SSFR_PARAM_CHOICE(normals_params, edge, edges, SSFR_NORMALS_SMALLER,
                      "at a silhouette take the smaller one-sided difference, or central differences everywhere"),
    SSFR_PARAM_REAL(normals_params, depth_falloff, "radii", 5, 0, 1e6,
                    "a depth step beyond this is a silhouette; in particle radii"),
    SSFR_PARAM_FLAG(normals_params, off_axis, 1,
                    "the normal of the surface itself; off: eq. 2.10, which is exact on the view axis alone"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    {"u_c", offsetof(ssfr_normals_coeffs, c), 2},
    {"u_falloff", offsetof(ssfr_normals_coeffs, falloff), 1},
    {"u_divisor", offsetof(ssfr_normals_coeffs, divisor), 1},
    {"u_edge", offsetof(ssfr_normals_coeffs, edge), 0},
    {"u_off_axis", offsetof(ssfr_normals_coeffs, off_axis), 0},
    {NULL, 0, 0},
};

static void derive(const ssfr_run *run, void *coeffs)
{
    const normals_params *p = run->params;
    ssfr_normals_coeffs *c = coeffs;
    for (int k = 0; k < 2; k++) c->c[k] = run->frame->block.image[2 + k] * run->divisor;
    c->falloff = p->depth_falloff * run->frame->radius;
    c->divisor = run->divisor;
    c->edge = p->edge;
    c->off_axis = p->off_axis;
}

const ssfr_pass ssfr_normals = {
    .name = "normals",
    .source = "van der Laan 2009, after Bagar 2010, sec. 2.5.3 (eq. 2.10, errata B3, B21)",
    .help = "unit normals in eye space by finite differences of the depth",
    .inputs = {{"depth", SSFR_SLOT_surface_depth}},
    .outputs = {{"normal", SSFR_SLOT_normal, .like = "depth"}},
    .params = rows,
    .params_size = sizeof(normals_params),
    .coeffs_size = sizeof(ssfr_normals_coeffs),
    .taps = 5,
    .derive = derive,
    .needed = ssfr_needs_fluid,
    .needless = SSFR_NO_FLUID,
    .cpu_run = ssfr_normals_cpu,
    .programs = {{"tiles.vert", "normals.frag", NULL}},
    .uniforms = uniforms,
    .tolerance = {.abs = 2e-3, .rel = 0, .outliers = 0.01},
};

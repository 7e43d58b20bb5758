/* SPDX-License-Identifier: MIT */
/* layer_thickness.c: water before and behind the front of the foam (Bagar 2010, secs 3.2.2 and 4.8.1):
 *
 *     T_wf = sum of s t,   T_wb = sum of (1 - s) t
 *
 * over the particles, with t what `thickness` adds up and s the share of it that is before the foam: 1 or 0 as the
 * particle's centre is (`centre`), or as much of the ray inside the particle as is (`fragment`, exact). */
#include "passes/layer_thickness.h"

typedef struct layer_thickness_params {
    ssfr_thickness_params thickness; /* first */
    int layers;
    unsigned as_printed;
} layer_thickness_params;

enum { PRINTED_B14 = 1, PRINTED_B36 = 2 };

static const char *const layers[] = {"centre", "fragment", NULL};
static const char *const printed[] = {"B14", "B36", NULL}; /* PRINTED_* */

static const ssfr_param rows[] = {
    SSFR_THICKNESS_ROWS,
    SSFR_PARAM_CHOICE(layer_thickness_params, layers, layers, SSFR_LAYERS_CENTRE,
                      "a particle is before the foam or behind it as its centre is, seen at the nearest pixel of the "
                      "image (listing A.14), or each ray is cut at the foam"),
    SSFR_PARAM_SET(layer_thickness_params, as_printed, printed, 0,
                   "B14: particles with any foam are no water; B36: where there is no foam all water is before it, not "
                   "behind"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    SSFR_THICKNESS_UNIFORMS,
    {"u_open", offsetof(ssfr_layer_thickness_coeffs, open), 1},
    {NULL, 0, 0},
};

static void derive(const ssfr_run *run, void *coeffs)
{
    const layer_thickness_params *p = run->params;
    ssfr_layer_thickness_coeffs *c = coeffs;
    ssfr_thickness_derive(run, &c->thickness);
    c->thickness.splat.spares_foam = (p->as_printed & PRINTED_B14) != 0;
    c->open = p->as_printed & PRINTED_B36 ? 1 : 0;
    c->by_centre = p->layers == SSFR_LAYERS_CENTRE;
}

/* Without foam in view one layer has it all. */
static int n_needed(const ssfr_run *run)
{
    const layer_thickness_params *p = run->params;
    return run->is_neutral[SSFR_LAYER_FOAM_DEPTH] && !(p->as_printed & PRINTED_B36) ? 1 : SSFR_N_LAYERS;
}

/* What is foam matters alone to what leaves it out. */
static bool reads(const void *params, int port)
{
    return port != SSFR_LAYER_FOAM_SHARE || ((const layer_thickness_params *)params)->as_printed & PRINTED_B14;
}

static bool defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    const layer_thickness_params *p = run->params;
    const bool divided = run->n_out == SSFR_N_LAYERS, foam = p->as_printed & PRINTED_B14 && !run->values[1]->same;
    char more[SSFR_DEFINES];
    snprintf(more, sizeof more, "%s%s%s", foam ? "#define SPARE_FOAM\n" : "", divided ? "#define LAYERS\n" : "",
             divided && p->layers == SSFR_LAYERS_CENTRE ? "#define CENTRE\n" : "");
    return ssfr_splat_define(run, i, more, text);
}

/* With one layer the foam's depth is not read. */
static void work(const ssfr_run *run, ssfr_node_report *report)
{
    ssfr_splat_work(run, report);
    if (run->n_out == SSFR_N_LAYERS) return;
    report->taps--;
    report->bytes -= (double)sizeof(float) * run->w * run->h * run->frame->facts.covered;
}

const ssfr_pass ssfr_layer_thickness = {
    .name = "layer_thickness",
    .source = "Bagar 2010, secs 3.2.2 and 4.8.1 (eqs 3.3 and 3.4, listings A.14 and A.15)",
    .help = "adds up each particle's thickness along the view ray, before and behind the front of the foam",
    .inputs = {{"scene_depth", SSFR_SLOT_scene_depth}, {"foam_depth", SSFR_SLOT_foam_depth}, SSFR_SPLAT_SIZE_PORT,
               {"foam", SSFR_SLOT_foam}},
    .outputs = {{"thickness_back", SSFR_SLOT_thickness_back}, {"thickness_front", SSFR_SLOT_thickness_front}},
    .tables = SSFR_SPLAT_TABLES,
    .params = rows,
    .params_size = sizeof(layer_thickness_params),
    .coeffs_size = sizeof(ssfr_layer_thickness_coeffs),
    .reads = reads,
    .derive = derive,
    .needed = ssfr_splat_needed,
    .needless = SSFR_SPLAT_NEEDLESS,
    .n_needed = n_needed,
    .reach = ssfr_splat_reach,
    .storage = ssfr_thickness_storage,
    .cpu_run = ssfr_layer_thickness_cpu,
    .programs = SSFR_SPLAT_PROGRAMS("layer_thickness.frag", ""),
    .defines = defines,
    .uniforms = uniforms,
    .gl_run = ssfr_splat_gl_add,
    .work = work,
    .tolerance = SSFR_THICKNESS_TOLERANCE,
    .half_tolerance = SSFR_THICKNESS_HALF_TOLERANCE,
    .widen = ssfr_thickness_widen,
};

/* SPDX-License-Identifier: MIT */
/* shadow_basis.c: a shadow map as images that can be filtered (Annen, Mertens, Bekaert, Seidel and Kautz 2007). Light
 * arrives at depth d behind a caster at depth z when z > d; this step is written as a square wave,
 *
 *     s(d, z) = 1/2 + 2 sum_{k=1..M} e^(-alpha (k/M)^2) / c_k [cos(c_k d) sin(c_k z) - sin(c_k d) cos(c_k z)],
 *
 * c_k = pi (2 k - 1), so that its mean over texels is that of the cosines and sines of z. Texels without a caster are
 * counted apart: there is light whatever d is, which no finite sum says. */
#include "passes/shadow_basis.h"

#include "graph/draw.h"

typedef struct shadow_basis_params {
    int terms, radius;
    double alpha;
} shadow_basis_params;

static const ssfr_param rows[] = {
    SSFR_PARAM_INT(shadow_basis_params, terms, "1", 4, 1, SSFR_SHADOW_TERMS,
                   "M, of the series; 1, 2, 4, 8 and 16 use their images best"),
    SSFR_PARAM_INT(shadow_basis_params, radius, "px", 2, 0, 64,
                   "of the box that is filtered with, which is 2 radius + 1 texels wide; 0: not filtered"),
    SSFR_PARAM_REAL(shadow_basis_params, alpha, "1", 0, 0, 100,
                    "damps the series' ringing, and widens its step: e^(-alpha (k/M)^2)"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    SSFR_LIGHT_VIEW_UNIFORMS(ssfr_shadow_basis_coeffs),
    {"u_per_metre", offsetof(ssfr_shadow_basis_coeffs, per_metre), 1},
    {"u_damping", offsetof(ssfr_shadow_basis_coeffs, damping), 1},
    {"u_terms", offsetof(ssfr_shadow_basis_coeffs, terms), 0},
    {"u_radius", offsetof(ssfr_shadow_basis_coeffs, radius), 0},
    {NULL, 0, 0},
};

static void size(const void *params, const int in[2], int out[2])
{
    out[0] = in[0];
    out[1] = in[1] * ssfr_shadow_images(((const shadow_basis_params *)params)->terms);
}

static void derive(const ssfr_run *run, void *coeffs)
{
    const shadow_basis_params *p = run->params;
    ssfr_shadow_basis_coeffs *c = coeffs;
    *c = (ssfr_shadow_basis_coeffs){.view = ssfr_light_view_of(run->frame), .terms = p->terms, .radius = p->radius,
                                    .damping = p->alpha / ssfr_square(p->terms)};
    c->per_metre = ssfr_shadow_span(ssfr_shadow_images(p->terms)) / c->view.range;
}

/* Along rows into the scratch image and back along columns. */
static ssfr_result gl_run(const ssfr_run *run)
{
    ssfr_result result = SSFR_OK;
    const ssfr_draw *draw = run->draw;
    SSFR_TRY(ssfr_draw_screen(run, draw->programs[0], 1, draw->out));
    if (((const ssfr_shadow_basis_coeffs *)run->coeffs)->radius > 0) {
        ssfr_draw_bind(draw, 0, draw->out[0]);
        SSFR_TRY(ssfr_draw_screen(run, draw->programs[1], 1, draw->scratch));
        ssfr_draw_bind(draw, 0, draw->scratch[0]);
        SSFR_TRY(ssfr_draw_screen(run, draw->programs[2], 1, draw->out));
    }
end:
    return result;
}

static void work(const ssfr_run *run, ssfr_node_report *report)
{
    const int radius = ((const ssfr_shadow_basis_coeffs *)run->coeffs)->radius;
    const double px = (double)run->w * (double)run->h;
    report->taps = 1 + (radius > 0 ? 2 * (2 * radius + 1) : 0);
    if (radius == 0) return;
    report->iterations = 3; /* two more sweeps, of four channels */
    report->bytes += 2 * 2 * 4 * sizeof(float) * px;
}

const ssfr_pass ssfr_shadow_basis = {
    .name = "shadow_basis",
    .source = "Annen, Mertens, Bekaert, Seidel and Kautz 2007 (convolution shadow maps, which Bagar 2010, sec. 4.9.4, "
              "uses)",
    .help = "cosines and sines of a shadow map's depths, filtered with a box",
    .inputs = {{"light_depth", SSFR_SLOT_light_depth}},
    .outputs = {{"basis", SSFR_SLOT_light_basis}},
    .params = rows,
    .params_size = sizeof(shadow_basis_params),
    .coeffs_size = sizeof(ssfr_shadow_basis_coeffs),
    .n_scratch = 1,
    .whole_screen = true,
    .size = size,
    .derive = derive,
    .needed = ssfr_light_view_has_casters,
    .needless = SSFR_NO_CASTER,
    .cpu_run = ssfr_shadow_basis_cpu,
    .programs = {{"tiles.vert", "shadow_basis.frag", NULL},
                 {"tiles.vert", "shadow_basis.frag", "#define BOX ivec2(1, 0)\n"},
                 {"tiles.vert", "shadow_basis.frag", "#define BOX ivec2(0, 1)\n"}},
    .uniforms = uniforms,
    .gl_run = gl_run,
    .work = work,
    .tolerance = {.abs = 2e-4, .rel = 0, .outliers = 0},
};

/* SPDX-License-Identifier: MIT */
/* curvature_flow.c: explicit Euler steps of z_t = -H, H the depth image's mean curvature (Bagar 2010, eqs 2.8 to 2.16).
 *
 * With p = z_x / C_x, q = z_y / C_y the slopes per unit of tangent, r, s, t the second slopes z_xx / C_x^2,
 * z_yy / C_y^2, z_xy / (C_x C_y) and S = p^2 + q^2 + z^2, H = (C_y E_x + C_x E_y) / (2 D^(3/2)) (eq. 2.14, B1) is
 *
 *     H = (C_x (p (p r + q t + z p) - r S) + C_y (q (p t + q s + z q) - s S)) / (2 S^(3/2)),
 *
 * which has no factor as small as C^6 in it. On flat water that faces the eye,
 * -H = (z_xx / C_x + z_yy / C_y) / (2 |z|). */
#include "passes/curvature_flow.h"

#include "graph/draw.h"

typedef struct curvature_flow_params {
    ssfr_curvature_flow_params flow;
    int iterations;
} curvature_flow_params;

const char *const ssfr_curvature_flow_references[] = {"mean", "nearest", NULL};

static const ssfr_param rows[] = {
    SSFR_PARAM_INT(curvature_flow_params, iterations, "1", 40, 0, 100000, "Euler steps"),
    SSFR_CURVATURE_FLOW_ROWS,
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {SSFR_CURVATURE_FLOW_UNIFORMS, {NULL, 0, 0}};

/* The largest step, at |z| = 1, under which no ripple grows on a surface that faces the eye: checkerboards are the
 * first to. */
static double stability_bound(const double c[2], bool off_axis)
{
    const double product = c[0] * c[1];
    return off_axis ? product * sqrt(product) / (c[0] * c[0] + c[1] * c[1]) : product / (c[0] + c[1]);
}

/* Off the axis a pixel covers less of the surface across the ray: the bound falls by (1 + u^2 + v^2)^(3/2) at most. */
double ssfr_curvature_flow_corner(const ssfr_run *run, int off_axis)
{
    const ssfr_block *b = &run->frame->block;
    const double u = 0.5 * b->image[0] * b->image[2], v = 0.5 * b->image[1] * b->image[3];
    return off_axis ? pow(1 + u * u + v * v, 1.5) : 1;
}

double ssfr_curvature_flow_distance(const ssfr_run *run, const ssfr_curvature_flow_params *p)
{
    const ssfr_facts *facts = &run->frame->facts;
    return p->reference == SSFR_REFERENCE_NEAREST ? facts->nearest : facts->mean;
}

void ssfr_curvature_flow_derive(const ssfr_run *run, const ssfr_curvature_flow_params *p, ssfr_curvature_flow_coeffs *c)
{
    const ssfr_block *b = &run->frame->block;
    *c = (ssfr_curvature_flow_coeffs){.c = {b->image[2] * run->divisor, b->image[3] * run->divisor}};
    const double bound = stability_bound(c->c, p->off_axis);
    c->dt = p->dt;
    if (p->dt == 0)
        c->dt = p->step * bound * ssfr_curvature_flow_distance(run, p) / ssfr_curvature_flow_corner(run, p->off_axis);
    c->limit = p->limit ? SSFR_CURVATURE_FLOW_SAFE * bound : SSFR_EMPTY;
    c->threshold = SSFR_EMPTY;
    c->falloff = p->depth_falloff * run->frame->radius;
    c->divisor = run->divisor;
    c->cross_term = p->cross_term;
    c->off_axis = p->off_axis;
}

unsigned ssfr_curvature_flow_program(const ssfr_run *run)
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    return run->draw->programs[c->cross_term + 2 * c->off_axis];
}

double ssfr_curvature_flow_taps(const ssfr_curvature_flow_coeffs *c)
{
    return c->cross_term ? 9 : 5;
}

static void derive(const ssfr_run *run, void *coeffs)
{
    const curvature_flow_params *p = run->params;
    ssfr_curvature_flow_coeffs *c = coeffs;
    ssfr_curvature_flow_derive(run, &p->flow, c);
    c->iterations = p->iterations;
}

static bool needed(const ssfr_run *run)
{
    return ((const curvature_flow_params *)run->params)->iterations > 0 && run->frame->facts.fluid;
}

/* Steps go to and fro between the output and a scratch image, so that the last ends in the output. */
static ssfr_result gl_run(const ssfr_run *run)
{
    ssfr_result result = SSFR_OK;
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    const ssfr_draw *draw = run->draw;
    const unsigned program = ssfr_curvature_flow_program(run);
    if (c->iterations == 0) return ssfr_draw_copy(draw, draw->in[0], draw->out[0]);
    for (int i = 0; i < c->iterations; i++) {
        const bool to_output = (c->iterations - i) % 2 == 1;
        const ssfr_texture *target = to_output ? draw->out[0] : draw->scratch[0];
        if (i) ssfr_draw_bind(draw, 0, to_output ? draw->scratch[0] : draw->out[0]);
        SSFR_TRY(ssfr_draw_screen(run, program, 1, &target));
    }
end:
    return result;
}

static void work(const ssfr_run *run, ssfr_node_report *report)
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    report->iterations = c->iterations;
    report->taps = ssfr_curvature_flow_taps(c) * c->iterations;
    report->bytes *= fmax(c->iterations, 1);
}

const ssfr_pass ssfr_curvature_flow = {
    .name = "curvature_flow",
    .source = "van der Laan 2009, after Bagar 2010, sec. 2.5.3 (eqs 2.8 to 2.16, errata B1 to B4, B21) and "
              "listing A.13",
    .help = "smooths the depth by mean curvature: explicit Euler steps, a fixed number of them",
    .inputs = {{"depth", SSFR_SLOT_low_depth}},
    .outputs = {{"smooth", SSFR_SLOT_smooth_depth, .like = "depth", .from = "depth"}},
    .params = rows,
    .params_size = sizeof(curvature_flow_params),
    .coeffs_size = sizeof(ssfr_curvature_flow_coeffs),
    .n_scratch = 1,
    .derive = derive,
    .needed = needed,
    .needless = "no iterations, or no fluid in view",
    .cpu_run = ssfr_curvature_flow_cpu,
    .programs = SSFR_CURVATURE_FLOW_PROGRAMS("curvature_flow.frag"),
    .uniforms = uniforms,
    .gl_run = gl_run,
    .work = work,
    .tolerance = {.abs = 2e-5, .rel = 5e-6, .outliers = 0.002},
};

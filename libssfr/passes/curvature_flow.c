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

#include <epoxy/gl.h>

typedef struct curvature_flow_params {
    ssfr_curvature_flow_params flow;
    int iterations;
} curvature_flow_params;

const char *const ssfr_curvature_flow_references[] = {"mean", "nearest", NULL};
const char *const ssfr_curvature_flow_unstable[] = {"limit", "substep", "refuse", "allow", NULL};

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
    c->bound = bound;
    c->counts = p->unstable == SSFR_UNSTABLE_REFUSE || p->unstable == SSFR_UNSTABLE_ALLOW;
    c->limit = c->counts ? SSFR_EMPTY : SSFR_CURVATURE_FLOW_SAFE * bound;
    c->parts = 1;
    c->threshold = SSFR_EMPTY;
    c->falloff = p->depth_falloff * run->frame->radius;
    c->divisor = run->divisor;
    c->cross_term = p->cross_term;
    c->off_axis = p->off_axis;
}

void ssfr_curvature_flow_worst(const ssfr_run *run, const ssfr_curvature_flow_coeffs *c, double *dt, double *bound)
{
    const double z = fmax(run->frame->facts.nearest, -c->threshold);
    *dt = c->over_depth ? c->dt / z : c->dt;
    *bound = c->bound * z / ssfr_curvature_flow_corner(run, c->off_axis);
}

/* Beyond so many parts the limit shortens them, and that is said. */
void ssfr_curvature_flow_cut(const ssfr_run *run, const ssfr_curvature_flow_params *p, ssfr_curvature_flow_coeffs *c)
{
    double dt, bound;
    if (p->unstable != SSFR_UNSTABLE_SUBSTEP) return;
    ssfr_curvature_flow_worst(run, c, &dt, &bound);
    const double parts = ceil(dt / (SSFR_CURVATURE_FLOW_SAFE * bound));
    if (parts > SSFR_CURVATURE_FLOW_PARTS)
        ssfr_log(SSFR_WARNING, "curvature flow: a step of %.3g m^2 would need %.0f parts %.3g m away: cut into %d, "
                 "near surfaces are smoothed less", dt, parts, run->frame->facts.nearest, SSFR_CURVATURE_FLOW_PARTS);
    c->parts = (int)ssfr_clamp(parts, 1, SSFR_CURVATURE_FLOW_PARTS);
    c->dt /= c->parts;
    c->iterations *= c->parts;
}

bool ssfr_curvature_flow_defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    (void)i;
    snprintf(text, SSFR_DEFINES, "#define CROSS_TERM %d\n#define OFF_AXIS %d\n#define COUNTS %d\n%s", c->cross_term,
             c->off_axis, c->counts, c->live_tiles ? "#define LIVE_TILES\n" : "");
    return true;
}

size_t ssfr_curvature_flow_words(const ssfr_run *run)
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    const ssfr_facts *facts = &run->frame->facts;
    const size_t n_tiles = c->live_tiles ? (size_t)facts->tiles_x * (size_t)facts->tiles_y : 0;
    return c->counts || c->live_tiles ? SSFR_COUNTS + n_tiles : 0;
}

double ssfr_curvature_flow_n_unstable(const ssfr_run *run)
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    return c->counts ? run->words[SSFR_CURVATURE_FLOW_N_UNSTABLE] : 0;
}

ssfr_result ssfr_curvature_flow_check(const ssfr_run *run, const char *pass)
{
    const ssfr_curvature_flow_params *p = run->params;
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    const double n = ssfr_curvature_flow_n_unstable(run);
    if (n == 0 || p->unstable != SSFR_UNSTABLE_REFUSE) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: a step of %.3g %s is longer than %.0f pixels (%.3g %% of the image) "
                     "bear", pass, c->dt, c->over_depth ? "m^3" : "m^2", n, 100 * n / ((double)run->w * run->h));
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
    ssfr_curvature_flow_cut(run, &p->flow, c);
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
    const unsigned program = draw->programs[0];
    if (c->iterations == 0) return ssfr_draw_copy(draw, draw->in[0], draw->out[0]);
    for (int i = 0; i < c->iterations; i++) {
        const bool to_output = (c->iterations - i) % 2 == 1;
        const ssfr_texture *target = to_output ? draw->out[0] : draw->scratch[0];
        if (i) ssfr_draw_bind(draw, 0, to_output ? draw->scratch[0] : draw->out[0]);
        glProgramUniform2i(program, SSFR_CURVATURE_FLOW_AT_STEP, i, 0);
        SSFR_TRY(ssfr_draw_screen(run, program, 1, &target));
    }
end:
    return result;
}

static void work(const ssfr_run *run, ssfr_node_report *report)
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    report->iterations = c->iterations;
    report->unstable = ssfr_curvature_flow_n_unstable(run);
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
    .n_words = ssfr_curvature_flow_words,
    .derive = derive,
    .needed = needed,
    .needless = "no iterations, or no fluid in view",
    .cpu_run = ssfr_curvature_flow_cpu,
    .programs = SSFR_CURVATURE_FLOW_PROGRAMS("curvature_flow.frag"),
    .defines = ssfr_curvature_flow_defines,
    .uniforms = uniforms,
    .gl_run = gl_run,
    .check = ssfr_curvature_flow_check,
    .work = work,
    .tolerance = {.abs = 2e-5, .rel = 5e-6, .outliers = 0.002},
};

/* SPDX-License-Identifier: MIT */
/* adaptive_flow.c: curvature flow (see curvature_flow.c) in fewer steps where the surface is farther (Bagar 2010).
 *
 * n steps of dt smooth by sqrt(n dt C |z|) metres: with n the same everywhere that grows with the distance.
 *
 *     paper    r_s = r_w / (C |z|), steps 0 to floor(r_s) + 1: a width of sqrt(r_w dt), the same at every distance
 *     metres   n dt = sigma^2 / (C |z|), the last step in part: a width of sigma, also where the limit shortens dt
 *     steps    n as it is: what sec. 3.1 improves, and, with z_t = -H / |z|, what it rejects: a width of sqrt(n dt C)
 *
 * No pixel takes more steps than the nearest particle in view needs, so that their number is known before the first.
 *
 * A pixel whose step is past its own number never changes again, and neither does a tile of such pixels: with
 * stop=tiles the fragments that take step i mark their tile with i + 1 in a storage buffer, and the vertex shader of
 * the next step collapses the tiles without that mark. The CPU asks for nothing and waits for nothing; a step costs a
 * memory barrier, a dropped tile six vertices. Indirect draws of a list of tiles, gathered after each step by a compute
 * shader, would spare these vertices, which are few beside a tile's 1024 pixels, for a dispatch and a second barrier a
 * step. It is the default because it was the fastest of the four (results/bagar2010/stop.csv), if not everywhere. */
#include "passes/adaptive_flow.h"

#include "graph/draw.h"

#include <epoxy/gl.h>

typedef struct adaptive_flow_params {
    ssfr_curvature_flow_params flow;
    double radius, threshold_min;
    int iterations, constant, count, evolution, stop, query_interval, copy;
} adaptive_flow_params;

static const char *const constants[] = {"paper", "metres", "steps", NULL};
static const char *const counts[] = {"current", "first", NULL};
static const char *const evolutions[] = {"curvature", "over_depth", NULL};
static const char *const stops[] = {"none", "query", "bound", "tiles", NULL};

/* The default radius: for the nearest and the farthest hundredth of the pixels, the iterations that the paper tells of
 * figures 5.1, 5.2 and 5.5 ask for 10, 7 and 15 particle radii in these scenes as they are rebuilt here (at half of
 * 1280 x 720 and 45 degrees, so C = 0.0023); with 10 such pixels take 14 to 53. */
static const ssfr_param rows[] = {
    SSFR_PARAM_REAL(adaptive_flow_params, radius, "radii", 10, 0, 1e6,
                    "r_w, the radius in metres over which depths are smoothed; in particle radii"),
    SSFR_PARAM_INT(adaptive_flow_params, iterations, "1", 256, 0, 100000, "Euler steps, at most"),
    SSFR_PARAM_CHOICE(adaptive_flow_params, constant, constants, SSFR_ADAPTIVE_FLOW_PAPER,
                      "what is the same at every distance: paper: steps times |z|, r_w / C (eq. 3.1, erratum B6); "
                      "metres: the width of the smoothing, which is r_w; steps: their number, `iterations`"),
    SSFR_PARAM_CHOICE(adaptive_flow_params, count, counts, 0,
                      "whose |z| that is: the depth before each step, as listing A.12 has it, or before the first"),
    SSFR_PARAM_CHOICE(adaptive_flow_params, evolution, evolutions, 0,
                      "z_t = -H, or -H / |z|, which sec. 3.1 rejects; dt is then in m^3"),
    SSFR_CURVATURE_FLOW_ROWS,
    SSFR_PARAM_REAL(adaptive_flow_params, threshold_min, "m", 0, 0, 1e12,
                    "nearer surfaces count as this far in H, min(z, thresholdMin) of listing A.13; 0: off"),
    SSFR_PARAM_CHOICE(adaptive_flow_params, stop, stops, SSFR_ADAPTIVE_FLOW_TILES,
                      "none: all `iterations` are drawn; query: until an occlusion query finds nothing changed, as "
                      "printed; bound: as many as the nearest particle in view needs; tiles: as many, each over the "
                      "tiles alone in which the last one changed something; the depths are the same"),
    SSFR_PARAM_INT(adaptive_flow_params, query_interval, "1", 5, 1, 100000, "steps from one query to the next"),
    SSFR_PARAM_FLAG(adaptive_flow_params, copy, 0,
                    "copy the image for each step and discard what it leaves, as listing A.11; off: write that too"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    SSFR_CURVATURE_FLOW_UNIFORMS,
    {"u_threshold", offsetof(ssfr_adaptive_flow_coeffs, flow.threshold), 1},
    {"u_over_depth", offsetof(ssfr_adaptive_flow_coeffs, flow.over_depth), 0},
    {"u_most", offsetof(ssfr_adaptive_flow_coeffs, flow.iterations), 0},
    {"u_parts", offsetof(ssfr_adaptive_flow_coeffs, flow.parts), 0},
    {"u_need", offsetof(ssfr_adaptive_flow_coeffs, need), 1},
    {"u_constant", offsetof(ssfr_adaptive_flow_coeffs, constant), 0},
    {"u_by_first", offsetof(ssfr_adaptive_flow_coeffs, by_first), 0},
    {NULL, 0, 0},
};

/* ---- how many steps ---------------------------------------------------------------------------------------------- */

static bool takes_steps(const adaptive_flow_params *p)
{
    return p->iterations > 0 && (p->radius > 0 || p->constant == SSFR_ADAPTIVE_FLOW_STEPS);
}

/* The shortest dt, m^2, of a pixel as near as the nearest particle in view. */
static double shortest_dt(const ssfr_run *run, const ssfr_curvature_flow_coeffs *c)
{
    double dt, bound;
    ssfr_curvature_flow_worst(run, c, &dt, &bound);
    return fmin(dt, c->limit * bound / c->bound);
}

/* How many steps, those of parts, the nearest particle in view needs, at most `cap`. Where a float would round up to one
 * more than in double, this cuts it off. */
static int most_steps(const ssfr_run *run, const ssfr_adaptive_flow_coeffs *c, int cap)
{
    double steps = c->need / run->frame->facts.nearest;
    if (!takes_steps(run->params)) return 0;
    if (c->constant == SSFR_ADAPTIVE_FLOW_STEPS) return cap;
    const bool metres = c->constant == SSFR_ADAPTIVE_FLOW_METRES;
    if (metres) steps /= shortest_dt(run, &c->flow);
    return (int)fmin(cap, (floor(steps) + 2) * (metres ? 1 : c->flow.parts));
}

static void derive(const ssfr_run *run, void *coeffs)
{
    const adaptive_flow_params *p = run->params;
    ssfr_adaptive_flow_coeffs *c = coeffs;
    const double r_w = p->radius * run->frame->radius;
    *c = (ssfr_adaptive_flow_coeffs){.constant = p->constant, .by_first = p->count, .stop = p->stop, .copy = p->copy,
                                     .interval = p->query_interval, .at = &c->done};
    ssfr_curvature_flow_derive(run, &p->flow, &c->flow);
    c->flow.over_depth = p->evolution;
    if (p->evolution && p->flow.dt == 0) c->flow.dt *= ssfr_curvature_flow_distance(run, &p->flow);
    if (p->threshold_min > 0) c->flow.threshold = -p->threshold_min;
    c->need = (c->constant == SSFR_ADAPTIVE_FLOW_METRES ? r_w * r_w : r_w) / c->flow.c[0];
    c->flow.live_tiles = p->stop == SSFR_ADAPTIVE_FLOW_TILES;
    c->flow.iterations = p->iterations;
    ssfr_curvature_flow_cut(run, &p->flow, &c->flow);
    const int cap = c->flow.iterations;
    const bool known = p->stop == SSFR_ADAPTIVE_FLOW_BOUND || c->flow.live_tiles || !takes_steps(p);
    c->flow.iterations = most_steps(run, c, cap);
    c->sweeps = known ? c->flow.iterations : cap;
}

static bool needed(const ssfr_run *run)
{
    return takes_steps(run->params) && run->frame->facts.fluid;
}

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

/* Draws step i. A step that discards what it leaves goes over a copy. *over: it was asked, and found nothing to do. */
static ssfr_result draw_step(const ssfr_run *run, int i, const ssfr_texture *from, const ssfr_texture *to, bool *over)
{
    ssfr_result result = SSFR_OK;
    const ssfr_adaptive_flow_coeffs *c = run->coeffs;
    const unsigned program = run->draw->programs[0];
    const bool asks = ssfr_adaptive_flow_asks(c, i), copies = c->copy || asks;
    if (copies) SSFR_TRY(ssfr_draw_copy(run->draw, from, to));
    ssfr_draw_bind(run->draw, 0, from);
    glProgramUniform2i(program, SSFR_CURVATURE_FLOW_AT_STEP, i, copies);
    if (c->flow.live_tiles) glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    if (asks) ssfr_gl_watch_begin(run->draw->gl);
    result = ssfr_draw_screen(run, program, 1, &to);
    if (asks) *over = !ssfr_gl_watch_end(run->draw->gl);
    c->at->sweeps++, c->at->copies += copies;
end:
    return result;
}

/* Steps go to and fro between the output and a scratch image, so that the last of all would end in the output. */
static ssfr_result gl_run(const ssfr_run *run)
{
    ssfr_result result = SSFR_OK;
    const ssfr_adaptive_flow_coeffs *c = run->coeffs;
    const ssfr_draw *draw = run->draw;
    const ssfr_texture *from = draw->in[0];
    bool over = false;
    *c->at = (ssfr_adaptive_flow_done){0};
    ssfr_draw_bind(draw, 1, draw->in[0]);
    for (int i = 0; i < c->sweeps && !over; i++) {
        const ssfr_texture *to = (c->sweeps - i) % 2 == 1 ? draw->out[0] : draw->scratch[0];
        SSFR_TRY(draw_step(run, i, from, to, &over));
        from = to;
    }
    if (from != draw->out[0]) SSFR_TRY(ssfr_draw_copy(draw, from, draw->out[0]));
end:
    return result;
}

static void work(const ssfr_run *run, ssfr_node_report *report)
{
    const ssfr_adaptive_flow_coeffs *c = run->coeffs;
    const ssfr_adaptive_flow_done *done = c->at;
    const double tiles = run->frame->facts.n_tiles, all = done->sweeps * tiles;
    report->iterations = done->sweeps;
    report->unstable = ssfr_curvature_flow_n_unstable(run);
    /* The first sweep draws all tiles, each later one those that the one before it marked. */
    report->tiles = c->flow.live_tiles && all > 0 ? tiles + run->words[SSFR_CURVATURE_FLOW_N_LIVE] : all;
    const double sweeps = tiles > 0 ? report->tiles / tiles : 0; /* over all tiles */
    report->taps = (ssfr_curvature_flow_taps(&c->flow) + c->by_first) * sweeps + done->copies;
    report->bytes *= fmax(sweeps, 1);
    report->bytes += 2.0 * sizeof(float) * run->w * run->h * done->copies; /* of whole images */
}

const ssfr_pass ssfr_adaptive_flow = {
    .name = "adaptive_flow",
    .source = "Bagar 2010, secs 3.1 and 4.7 (eq. 3.1, errata B4 to B7, B17, B19 to B21) and listings A.11 to A.13",
    .help = "smooths the depth by mean curvature: more Euler steps where the surface is nearer",
    .inputs = {{"depth", SSFR_SLOT_low_depth}},
    .outputs = {{"smooth", SSFR_SLOT_smooth_depth, .like = "depth", .from = "depth"}},
    .params = rows,
    .params_size = sizeof(adaptive_flow_params),
    .coeffs_size = sizeof(ssfr_adaptive_flow_coeffs),
    .n_scratch = 1,
    .n_words = ssfr_curvature_flow_words,
    .derive = derive,
    .needed = needed,
    .needless = "a radius of 0, no iterations, or no fluid in view",
    .cpu_run = ssfr_adaptive_flow_cpu,
    .programs = SSFR_CURVATURE_FLOW_PROGRAMS("adaptive_flow.frag"),
    .defines = ssfr_curvature_flow_defines,
    .uniforms = uniforms,
    .gl_run = gl_run,
    .check = ssfr_curvature_flow_check,
    .work = work,
    .tolerance = {.abs = 2e-5, .rel = 5e-6, .outliers = 0.002},
};

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_flow_plane.c: bumps of every wavelength on a plane that faces the eye, before and after a flow. */
#include "experiments/bench_flow.h"

#include "graph/graph.h"

const char *const ssfr_bumps_flows[] = {"fixed", "paper", "metres", "over_depth", NULL};
const double ssfr_bumps_periods[SSFR_BUMPS_PERIODS] = {1, 1.5, 2, 3, 4, 6, 8, 11, 15, 20};

/* A pixel of half of 1280 x 720 px at 45 degrees; r_w as the adaptive flow has it by default. */
const ssfr_bumps_setup ssfr_bumps_defaults = {
    .radius = 0.02, .cell = 0.0023, .nearest = 0.5, .iterations = 40, .paper = 10, .metres = 0.5};

enum {
    W = 640, H = 2, /* px; the bumps lie along x, and the image's border mirrors them */
    MOST_STEPS = 256,
    SHORTEST = 4, /* px, the shortest wavelength */
};
static const double share = 0.8;  /* of the stability bound: the limit of the nearest crests does not bind */
static const double slope = 0.05; /* of the bumps, at most: then the flow is linear but for 0.3 % */

double ssfr_bumps_distance(const ssfr_bumps_setup *s, int i)
{
    static const double multiples[SSFR_BUMPS_DISTANCES] = {1, 1.4, 2, 2.8, 4, 5.6, 8, 11.2, 16, 22.4};
    return s->nearest * multiples[i];
}

/* ---- what is expected -------------------------------------------------------------------------------------------- */

/* dt as the pass gets it, m^2, or m^3 of over_depth. */
static double given_dt(const ssfr_bumps_setup *s, ssfr_bumps_flow flow)
{
    const double dt = share * s->cell * s->nearest / 2;
    return flow == SSFR_BUMPS_OVER_DEPTH ? dt * s->nearest : dt;
}

static double dt_at(const ssfr_bumps_setup *s, ssfr_bumps_flow flow, double distance)
{
    return given_dt(s, flow) / (flow == SSFR_BUMPS_OVER_DEPTH ? distance : 1);
}

static double steps_of(const ssfr_bumps_setup *s, ssfr_bumps_flow flow, double distance)
{
    const double metres = s->metres * s->radius;
    switch (flow) {
    case SSFR_BUMPS_PAPER: return fmin(MOST_STEPS, floor(s->paper * s->radius / (s->cell * distance)) + 2);
    case SSFR_BUMPS_METRES: return fmin(MOST_STEPS, metres * metres / (s->cell * distance * dt_at(s, flow, distance)));
    default: return (double)s->iterations;
    }
}

/* What n steps leave of a cosine of k radians a pixel; of the last of them the part that n has. */
static double damping(const ssfr_bumps_setup *s, ssfr_bumps_flow flow, double distance, double k)
{
    const double n = steps_of(s, flow, distance), lost = dt_at(s, flow, distance) * (1 - cos(k)) / (s->cell * distance);
    return pow(1 - lost, floor(n)) * (1 - (n - floor(n)) * lost);
}

static double rule(const ssfr_bumps_setup *s, ssfr_bumps_flow flow, double by_steps)
{
    switch (flow) {
    case SSFR_BUMPS_PAPER: return sqrt(s->paper * s->radius * given_dt(s, flow));
    case SSFR_BUMPS_METRES: return s->metres * s->radius;
    case SSFR_BUMPS_OVER_DEPTH: return sqrt((double)s->iterations * given_dt(s, flow) * s->cell);
    default: return by_steps;
    }
}

/* ---- what is ----------------------------------------------------------------------------------------------------- */

static ssfr_result set_number(ssfr_graph *graph, const char *pass, const char *param, double value)
{
    char key[64], text[32];
    snprintf(key, sizeof key, "%s.%s", pass, param);
    snprintf(text, sizeof text, "%.17g", value);
    return ssfr_graph_set(graph, key, text);
}

static ssfr_result make_graph(ssfr_graph **out, const ssfr_bumps_setup *s, ssfr_bumps_flow flow)
{
    ssfr_result result = SSFR_OK;
    const bool adapts = flow != SSFR_BUMPS_FIXED, counted = flow == SSFR_BUMPS_FIXED || flow == SSFR_BUMPS_OVER_DEPTH;
    const char *name = adapts ? "adaptive_flow" : "curvature_flow";
    SSFR_TRY(ssfr_graph_create_for_pass(out, ssfr_pass_find(name), NULL));
    SSFR_TRY(set_number(*out, name, "dt", given_dt(s, flow)));
    SSFR_TRY(set_number(*out, name, "iterations", counted ? (double)s->iterations : MOST_STEPS));
    if (!adapts) goto end;
    SSFR_TRY(set_number(*out, name, "radius", flow == SSFR_BUMPS_METRES ? s->metres : s->paper));
    SSFR_TRY(ssfr_graph_set(*out, "adaptive_flow.constant", counted ? "steps" : ssfr_bumps_flows[flow]));
    if (counted) SSFR_TRY(ssfr_graph_set(*out, "adaptive_flow.evolution", "over_depth"));
end:
    return result;
}

static ssfr_camera camera_of(const ssfr_bumps_setup *s)
{
    return (ssfr_camera){.right = {1, 0, 0}, .up = {0, 1, 0}, .back = {0, 0, 1}, .tan_x = s->cell * W / 2,
                         .tan_y = s->cell * H / 2, .near = 0.01, .far = 1000, .w = W, .h = H};
}

/* The amplitude of the cosine of k radians a pixel in a depth image around -distance. */
static double amplitude(const ssfr_field *depth, double distance, double k)
{
    double sum = 0;
    for (int x = 0; x < W; x++) sum += (*ssfr_field_at(depth, x, 0) + distance) * cos(k * (x + 0.5));
    return 2 * sum / W;
}

/* A cosine that the border mirrors is one of the whole image: mode half waves fit in it. */
static ssfr_result measure_period(ssfr_graph *graph, const ssfr_scene *scene, double distance, int mode,
                                  ssfr_field *depth, ssfr_bumps_period *out)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *smooth = NULL;
    const double k = M_PI * mode / W, a = slope * out->wavelength / (2 * M_PI);
    for (int i = 0; i < W * H; i++) depth->data[i] = a * cos(k * (i % W + 0.5)) - distance;
    SSFR_TRY(ssfr_graph_import(graph, "depth", depth));
    SSFR_TRY(ssfr_graph_run(graph, scene, NULL));
    SSFR_TRY(ssfr_graph_read(graph, "smooth", &smooth));
    out->height = 2 * a;
    out->residual = 2 * amplitude(smooth, distance, k);
    out->gain = out->residual / out->height;
end:
    ssfr_field_destroy(&smooth);
    return result;
}

/* -ln gain = (width^2 / 2) q^2 + c q^4 + ..., q = 2 pi / wavelength: a line through (-ln gain) / q^2 against q^2, where
 * something is left and something was taken. */
static double fit_width(const ssfr_bumps_period *periods)
{
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (int i = 0; i < SSFR_BUMPS_PERIODS; i++) {
        const double q2 = ssfr_square(2 * M_PI / periods[i].wavelength), value = -log(periods[i].gain) / q2;
        if (!(periods[i].gain > 0.3 && periods[i].gain < 1 - 1e-6)) continue;
        n++, x += q2, y += value, xx += q2 * q2, xy += q2 * value;
    }
    const double c = n > 1 ? (n * xy - x * y) / (n * xx - x * x) : 0;
    return n > 0 ? sqrt(2 * (y - c * x) / n) : NAN;
}

static ssfr_result measure_periods(const ssfr_bumps_setup *s, ssfr_bumps_flow flow, double distance, ssfr_graph *graph,
                                   const ssfr_scene *scene, ssfr_field *depth, ssfr_bumps *out)
{
    ssfr_result result = SSFR_OK;
    const double px = s->cell * distance;
    for (int i = 0; i < SSFR_BUMPS_PERIODS && result == SSFR_OK; i++) {
        ssfr_bumps_period *p = &out->periods[i];
        const int mode = (int)fmax(round(2 * W * px / (ssfr_bumps_periods[i] * s->radius)), 1);
        *p = (ssfr_bumps_period){NAN, NAN, NAN, NAN, NAN};
        if (2 * W < SHORTEST * mode) continue;
        p->wavelength = 2 * W * px / mode;
        p->predicted = damping(s, flow, distance, M_PI * mode / W);
        result = measure_period(graph, scene, distance, mode, depth, p);
    }
    return result;
}

ssfr_result ssfr_bumps_measure(const ssfr_bumps_setup *s, ssfr_bumps_flow flow, double distance, ssfr_bumps *out)
{
    ssfr_result result = SSFR_OK;
    ssfr_graph *graph = NULL;
    ssfr_particles *none = NULL; /* which tell the radius */
    ssfr_field *depth = NULL;
    const ssfr_particles given = {.radius = s->radius};
    SSFR_TRY(ssfr_particles_create(&none, 0, NULL, &given));
    const ssfr_scene scene = {.particles = none, .camera = camera_of(s), .floor = -INFINITY};
    SSFR_TRY(ssfr_field_create(&depth, W, H, 1));
    SSFR_TRY(make_graph(&graph, s, flow));
    SSFR_TRY(measure_periods(s, flow, distance, graph, &scene, depth, out));
    out->steps = steps_of(s, flow, distance);
    out->width = fit_width(out->periods);
    out->by_steps = sqrt(out->steps * dt_at(s, flow, distance) * s->cell * distance);
    out->by_rule = rule(s, flow, out->by_steps);
    out->reach = out->steps * s->cell * distance;
end:
    ssfr_graph_destroy(&graph);
    ssfr_field_destroy(&depth);
    ssfr_particles_destroy(&none);
    return result;
}

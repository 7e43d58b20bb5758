/* SPDX-License-Identifier: MIT */
/* curvature_flow.h: smoothing by mean curvature, and its rate and step for the passes that take other numbers of steps;
 * see curvature_flow.c. */
#ifndef SSFR_CURVATURE_FLOW_H
#define SSFR_CURVATURE_FLOW_H

#include "graph/pass.h"

typedef struct ssfr_curvature_flow_params { /* the first member of the params of a pass that takes such steps */
    int reference, unstable, cross_term, off_axis;
    double step, dt, depth_falloff;
} ssfr_curvature_flow_params;

typedef struct ssfr_curvature_flow_coeffs { /* the first member of its coefficients */
    double dt;         /* m^2 */
    double c[2];       /* eye-space size of a pixel of the filtered image at unit depth */
    double falloff;    /* m */
    double bound;      /* the longest stable dt, m^2, at |z| = 1 on the axis; it grows with |z| */
    double limit;      /* dt is at most this times |z| (over the off-axis factor) at every pixel; SSFR_EMPTY for none */
    double threshold;  /* m, the greatest z that enters H and the limit; SSFR_EMPTY for none */
    double divisor;    /* full-resolution pixels a pixel */
    int iterations, cross_term, off_axis;
    int parts;         /* that each step was cut into; dt is that of a part, and iterations counts parts */
    int counts;        /* the pixels whose dt is beyond their bound are counted */
    int live_tiles;    /* only tiles in which something may change are drawn */
    int over_depth;    /* z_t = -H / |z|, and dt in m^3 */
} ssfr_curvature_flow_coeffs;

/* The share of the stability bound that the per-pixel limit allows: at the bound itself checkerboards flip undamped. */
#define SSFR_CURVATURE_FLOW_SAFE 0.9

/* What becomes of a step that is longer than a pixel bears. */
enum { SSFR_UNSTABLE_LIMIT, SSFR_UNSTABLE_SUBSTEP, SSFR_UNSTABLE_REFUSE, SSFR_UNSTABLE_ALLOW };
extern const char *const ssfr_curvature_flow_unstable[];
enum { SSFR_CURVATURE_FLOW_PARTS = 64 }; /* at most, which a step is cut into */

/* The first of the words that a run is lent; shaders/curvature_flow.glsl has the same. */
enum { SSFR_CURVATURE_FLOW_N_UNSTABLE, SSFR_CURVATURE_FLOW_N_LIVE };
_Static_assert((int)SSFR_CURVATURE_FLOW_N_LIVE < (int)SSFR_COUNTS, "the GPU gives them back");

enum { SSFR_REFERENCE_MEAN, SSFR_REFERENCE_NEAREST };
extern const char *const ssfr_curvature_flow_references[];

#define SSFR_CURVATURE_FLOW_ROWS                                                                                       \
    SSFR_PARAM_REAL(ssfr_curvature_flow_params, step, "1", 0.9, 1e-6, 100,                                             \
                    "the step as a share of the stability bound at the reference distance, which without off_axis is " \
                    "|z| C_x C_y / (C_x + C_y)"),                                                                      \
    SSFR_PARAM_CHOICE(ssfr_curvature_flow_params, reference, ssfr_curvature_flow_references, SSFR_REFERENCE_MEAN,      \
                      "where the bound is taken: the mean distance of the particles in view, or the nearest of them"), \
    SSFR_PARAM_REAL(ssfr_curvature_flow_params, dt, "m^2", 0, 0, 1e12, "the step itself; 0: by the share above"),      \
    SSFR_PARAM_CHOICE(ssfr_curvature_flow_params, unstable, ssfr_curvature_flow_unstable, SSFR_UNSTABLE_LIMIT,         \
                      "a step beyond a pixel's stability bound: limit: shortened there to 0.9 of it; substep: all "    \
                      "steps are cut into equal parts, up to 64, that the nearest particle in view bears; refuse: "    \
                      "the frame fails; allow: taken, as printed. The last two count such pixels"),                    \
    SSFR_PARAM_REAL(ssfr_curvature_flow_params, depth_falloff, "radii", 5, 0, 1e6,                                     \
                    "a depth step beyond this is a silhouette: no smoothing across it; in particle radii"),            \
    SSFR_PARAM_FLAG(ssfr_curvature_flow_params, cross_term, 1,                                                         \
                    "z_xy by central differences; off: 0, as listing A.13 has it"),                                    \
    SSFR_PARAM_FLAG(ssfr_curvature_flow_params, off_axis, 0,                                                           \
                    "the curvature of the surface itself, exact off the view axis; off: eq. 2.10, where tilted "       \
                    "planes drift")

#define SSFR_CURVATURE_FLOW_UNIFORMS                              \
    {"u_dt", offsetof(ssfr_curvature_flow_coeffs, dt), 1},           \
    {"u_c", offsetof(ssfr_curvature_flow_coeffs, c), 2},             \
    {"u_falloff", offsetof(ssfr_curvature_flow_coeffs, falloff), 1}, \
    {"u_bound", offsetof(ssfr_curvature_flow_coeffs, bound), 1},     \
    {"u_limit", offsetof(ssfr_curvature_flow_coeffs, limit), 1},     \
    {"u_divisor", offsetof(ssfr_curvature_flow_coeffs, divisor), 1}

/* The program of a pass that takes such steps, and its lines. */
#define SSFR_CURVATURE_FLOW_PROGRAMS(frag)                                                      \
    {                                                                                           \
        {"tiles.vert", frag, "#define CROSS_TERM 1\n#define OFF_AXIS 0\n#define COUNTS 0\n"},   \
    }
enum { SSFR_CURVATURE_FLOW_AT_STEP = 1 }; /* location of u_step, as curvature_flow.glsl has it */
bool ssfr_curvature_flow_defines(const ssfr_run *run, int i, char text[SSFR_DEFINES]);

/* The words that a run needs: the counts where it counts, and one a tile where only those are drawn that are live. */
size_t ssfr_curvature_flow_words(const ssfr_run *run);
/* Fails where a step was longer than some pixels bear and that is refused. */
SSFR_MUST ssfr_result ssfr_curvature_flow_check(const ssfr_run *run, const char *pass);
double ssfr_curvature_flow_n_unstable(const ssfr_run *run);

/* All coefficients, without a threshold, for z_t = -H and no iterations. */
void ssfr_curvature_flow_derive(const ssfr_run *run, const ssfr_curvature_flow_params *params,
                                ssfr_curvature_flow_coeffs *coeffs);
/* Cuts the step into parts that the nearest particle in view bears, where that is asked: dt and iterations are of parts
 * from then on. All else must stand. */
void ssfr_curvature_flow_cut(const ssfr_run *run, const ssfr_curvature_flow_params *params,
                             ssfr_curvature_flow_coeffs *coeffs);
/* dt and the stability bound, m^2, of a pixel in the corner that is as near as the nearest particle in view. */
void ssfr_curvature_flow_worst(const ssfr_run *run, const ssfr_curvature_flow_coeffs *coeffs, double *dt,
                               double *bound);
/* The reference distance, m. */
double ssfr_curvature_flow_distance(const ssfr_run *run, const ssfr_curvature_flow_params *params);
/* By how much less than on the axis the limit is in the image's corner: 1 without off_axis. */
double ssfr_curvature_flow_corner(const ssfr_run *run, int off_axis);
/* Samples that a step takes of the depth. */
double ssfr_curvature_flow_taps(const ssfr_curvature_flow_coeffs *coeffs);

/* The derivatives of a pixel that are zero, as bits: a step beyond the falloff, or a hole, lies in their way. */
enum { SSFR_CURVATURE_FLOW_CUT_X = 1, SSFR_CURVATURE_FLOW_CUT_Y = 2, SSFR_CURVATURE_FLOW_CUT_XY = 4 };

/* The largest step, m, to a neighbour that one of these derivatives needs; NaN where a neighbour is NaN. */
double ssfr_curvature_flow_jump(const ssfr_field *depth, int x, int y, unsigned cut);
/* All cuts of a pixel. That of z_xy is set only where neither of the others is: with them there is no z_xy. */
unsigned ssfr_curvature_flow_cuts(const ssfr_run *run, const ssfr_field *depth, int x, int y);
/* dt of a pixel at depth z, m^2, or its limit there. */
double ssfr_curvature_flow_dt(const ssfr_run *run, double z, int x, int y);
/* What an Euler step adds to the depth of a pixel with a surface, m: -H times this dt. */
double ssfr_curvature_flow_rate(const ssfr_run *run, const ssfr_field *depth, int x, int y, unsigned cuts);

/* Counts the pixels of the first input whose dt is beyond their bound, where that is asked. */
void ssfr_curvature_flow_count(const ssfr_run *run);

void ssfr_curvature_flow_cpu(const ssfr_run *run);

#endif

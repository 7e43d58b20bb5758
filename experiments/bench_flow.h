/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_flow.h: `ssfr bench flow`: how wide the curvature flows smooth, at each distance (Bagar 2010, fig. 3.2) and in
 * the pixels of a view (figs 4.7 and 4.11).
 *
 *      bench_flow.c          the command: tables, printing, saving
 *      bench_flow_plane.c    bumps on a plane that faces the eye
 *      bench_flow_view.c     steps and curvatures of a view's pixels */
#ifndef SSFR_BENCH_FLOW_H
#define SSFR_BENCH_FLOW_H

#include "base/base.h"

/* argv[0] is "bench", argv[1] "flow"; gives the exit status. */
int ssfr_bench_flow(int argc, char **argv);

/* ---- bumps on a plane -------------------------------------------------------------------------------------------- */

/* What is the same at every distance. */
typedef enum ssfr_bumps_flow {
    SSFR_BUMPS_FIXED,      /* the number of steps: curvature_flow */
    SSFR_BUMPS_PAPER,      /* steps times distance: adaptive_flow, as printed */
    SSFR_BUMPS_METRES,     /* the width itself: constant=metres */
    SSFR_BUMPS_OVER_DEPTH, /* the number of steps of -H / |z|, which sec. 3.1 rejects */
    SSFR_N_BUMPS_FLOWS
} ssfr_bumps_flow;

extern const char *const ssfr_bumps_flows[]; /* NULL-terminated */

typedef struct ssfr_bumps_setup {
    double radius;   /* m, of a particle */
    double cell;     /* eye-space size of a pixel at unit depth */
    double nearest;  /* m: there the step is 0.8 of the stability bound; it is the same everywhere */
    long iterations; /* of a fixed number */
    double paper;    /* r_w, in particle radii */
    double metres;   /* the width, in particle radii */
} ssfr_bumps_setup;

extern const ssfr_bumps_setup ssfr_bumps_defaults;

enum { SSFR_BUMPS_PERIODS = 10, SSFR_BUMPS_DISTANCES = 10 };
extern const double ssfr_bumps_periods[SSFR_BUMPS_PERIODS]; /* particle radii */
/* The i-th distance, m: the nearest, and then each about 1.4 times as far. */
double ssfr_bumps_distance(const ssfr_bumps_setup *setup, int i);

typedef struct ssfr_bumps_period {
    double wavelength;      /* m, of the image's cosine next to the period; NaN: less than four pixels */
    double height;          /* m, from trough to crest */
    double residual;        /* m, what is left of it */
    double gain, predicted; /* residual over height; by the steps' own damping */
} ssfr_bumps_period;

typedef struct ssfr_bumps { /* all at one distance */
    ssfr_bumps_period periods[SSFR_BUMPS_PERIODS];
    double steps; /* parts count as such */
    double width; /* m, the kernel's standard deviation, from how the periods are damped; NaN: too few of them are */
    double by_steps;  /* m: sqrt(n dt C |z|), n the steps */
    double by_rule;   /* m: what the rule comes to: sqrt(r_w dt), r_w, sqrt(n dt C); as by_steps for a fixed number */
    double reach;     /* m: n pixels, what the paper takes for the radius */
} ssfr_bumps;

/* On the CPU, in double. */
SSFR_MUST ssfr_result ssfr_bumps_measure(const ssfr_bumps_setup *setup, ssfr_bumps_flow flow, double distance,
                                         ssfr_bumps *out);

/* ---- the pixels of a view ---------------------------------------------------------------------------------------- */

typedef struct ssfr_flow_curvatures {
    size_t n;       /* pixels without a silhouette in their way */
    double *values; /* magnitudes of the mean curvature there, 1/m, rising */
    ssfr_field *image; /* the same where they are; NaN elsewhere */
} ssfr_flow_curvatures;

typedef struct ssfr_flow_pixels {
    size_t n;       /* pixels with a surface */
    int most;       /* steps that any of them may take; parts count as such */
    size_t *counts; /* [most + 1]: that take so many, by their depth before the first */
    ssfr_field *steps; /* of each pixel; NaN where no surface is */
    ssfr_flow_curvatures before, after;
} ssfr_flow_pixels;

/* What the curvature flow of this pipeline did to the last frame, on the CPU; fails where none ran. */
SSFR_MUST ssfr_result ssfr_flow_look(const ssfr_graph *graph, ssfr_flow_pixels *out);
void ssfr_flow_pixels_finish(ssfr_flow_pixels *pixels);

#endif

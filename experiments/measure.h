/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure.h: how long a frame takes: repeated runs, medians, and the bandwidth that they are held against. */
#ifndef SSFR_MEASURE_H
#define SSFR_MEASURE_H

#include "base/base.h"

typedef struct ssfr_timing {
    size_t n;
    double min, median, mad; /* ms; mad is the median of the absolute deviations from the median; all NaN for n = 0 */
    size_t outliers;         /* samples whose modified z-score exceeds 3.5; they stay in */
} ssfr_timing;

/* Of n samples that stand `stride` apart; work holds 2 n values. */
ssfr_timing ssfr_timing_of(const double *samples, size_t stride, size_t n, double *work);

typedef struct ssfr_measure_options {
    size_t min_runs;
    double min_seconds; /* of timed runs */
    double max_seconds; /* caps warm-up and timed runs, but at least one run is timed; 0: no cap */
    bool nodes;         /* time each node too, which holds the frame up */
} ssfr_measure_options;

/* 10 runs and 1 s; quick: 3 runs and 0.2 s. */
ssfr_measure_options ssfr_measure_defaults(bool quick);

typedef struct ssfr_measured {
    ssfr_timing frame; /* wall clock around finished frames */
    int n_nodes;
    ssfr_node_report *reports; /* of the last run; their texts are the graph's until it runs again */
    ssfr_timing *nodes;        /* beside each report; n = 0 where the node did not run or was not timed */
    double taps, iterations, vertices, bytes, tiles, unstable; /* sums over the nodes */
} ssfr_measured;

/* Runs the graph once untimed (shaders compile), then to warm up, then timed. */
SSFR_MUST ssfr_result ssfr_measure_graph(ssfr_measured **out, ssfr_graph *graph, const ssfr_scene *scene,
                                         const ssfr_measure_options *options);
void ssfr_measured_destroy(ssfr_measured **measured);

typedef struct ssfr_subject {
    ssfr_graph *graph;
    ssfr_run_options run; /* `timing` is what the measurement says */
} ssfr_subject;

/* What two subjects' times differ by, run by run; NaN for one subject. */
typedef struct ssfr_paired {
    double saved;            /* ms, median of the second's time less the first's */
    double ratio, ratio_mad; /* the first's time over the second's: median, and median absolute deviation from it */
} ssfr_paired;

enum { SSFR_MAX_SUBJECTS = 2 };

/* Measures n subjects, one or two, of one scene: two by turns, each first every other time, so that what else the
 * machine does meets both alike. min_seconds and max_seconds are of both together. out[k] is of subjects[k]. */
SSFR_MUST ssfr_result ssfr_measure_subjects(ssfr_measured **out, ssfr_paired *paired, int n,
                                            const ssfr_subject *subjects, const ssfr_scene *scene,
                                            const ssfr_measure_options *options);

/* Bytes read and written a second by a large copy, the best of several: between textures of a GPU, else (gl NULL, or a
 * software rasteriser) in memory by all threads. max_seconds caps the copies, but one is always timed; 0: no cap. NaN
 * when it cannot be measured, which is logged. */
double ssfr_measure_copy_bandwidth(ssfr_gl *gl, double max_seconds);

/* Time over the least that moving `bytes` can take. */
double ssfr_measure_roofline(double ms, double bytes, double bandwidth);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rig.h: a rig makes the runs of a sweep: it keeps the scene, the graphs, the last frames and the last reference. */
#ifndef SSFR_RIG_H
#define SSFR_RIG_H

#include "experiments/measure.h"
#include "experiments/rig_truth.h"

typedef struct ssfr_rig ssfr_rig;

typedef struct ssfr_rig_options {
    const ssfr_sweep_spec *spec; /* complete and checked: see ssfr_rig_check */
    ssfr_gl *gl; /* NULL when no run is on the GPU */
    ssfr_stage_options stage; /* but for the size, and for what an axis says */
    ssfr_measure_options measure;
    double bandwidth_gl, bandwidth_cpu; /* bytes/s */
    bool no_twin; /* leave the columns twin_* and, of gl, method_* NaN, and save the twin's time */
} ssfr_rig_options;

/* Every key and value of the spec is one that its pipelines take, cameras and their paths are there, and what is held
 * against each other can be. Loads no particles. */
SSFR_MUST ssfr_result ssfr_rig_check(const ssfr_sweep_spec *spec, const ssfr_stage_options *stage);

/* The options must outlive the rig. */
SSFR_MUST ssfr_result ssfr_rig_create(ssfr_rig **out, const ssfr_rig_options *options);
void ssfr_rig_destroy(ssfr_rig **rig);

/* The scene of a run, ready to render; the rig's until the next call. */
SSFR_MUST ssfr_result ssfr_rig_stage(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], const ssfr_stage **out);
/* A graph with the settings of every run and of the last run's variant, and the axes as that run left them; NULL before
 * the first stage. */
const ssfr_graph *ssfr_rig_graph(const ssfr_rig *rig);
/* Truth with the settings of every run and of the last run's scene; NULL when it is not the reference. */
const ssfr_truth_params *ssfr_rig_truth(const ssfr_rig *rig);

typedef struct ssfr_rig_row { /* what is not known is NaN or "" */
    double values[SSFR_N_COLUMNS];
    char texts[SSFR_N_COLUMN_TEXTS][SSFR_COLUMN_TEXT];
    double added[SSFR_MAX_ADDED]; /* the columns of the spec's `added`, less those of the row it is held against */
} ssfr_rig_row;

/* Makes one run. What is not known when it fails is left out. Runs that differ in truth's own parameters alone have one
 * frame: it is measured once for those that follow each other. */
SSFR_MUST ssfr_result ssfr_rig_run(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], ssfr_rig_row *row);

/* The axis has to do with how a graph makes frames, not only with what they are compared with. */
bool ssfr_rig_makes_frames(const ssfr_graph *graph, const ssfr_axis *axis);
/* "640x360" as two numbers. */
bool ssfr_rig_size(const char *text, int size[2]);
/* "true" or "false". */
bool ssfr_rig_flag(const char *text, bool *flag);

#endif

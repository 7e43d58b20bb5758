/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rig.h: a rig makes the runs of a sweep: it keeps the scene, the graphs, the last CPU twin and the reference. */
#ifndef SSFR_RIG_H
#define SSFR_RIG_H

#include "experiments/columns.h"
#include "experiments/measure.h"
#include "experiments/stage.h"
#include "experiments/sweep_spec.h"

typedef struct ssfr_rig ssfr_rig;

typedef struct ssfr_rig_options {
    const ssfr_sweep_spec *spec; /* complete and checked: see ssfr_rig_check */
    const ssfr_pipeline *pipeline;
    ssfr_gl *gl; /* NULL when no run is on the GPU */
    ssfr_stage_options stage; /* but for the size */
    ssfr_measure_options measure;
    double bandwidth_gl, bandwidth_cpu; /* bytes/s */
    bool no_twin; /* leave the twin_* columns NaN, and save the twin's time */
} ssfr_rig_options;

/* Every key and value of the spec is one that the pipeline takes. Loads no scene. */
SSFR_MUST ssfr_result ssfr_rig_check(const ssfr_sweep_spec *spec, const ssfr_pipeline *pipeline);

/* The options must outlive the rig. */
SSFR_MUST ssfr_result ssfr_rig_create(ssfr_rig **out, const ssfr_rig_options *options);
void ssfr_rig_destroy(ssfr_rig **rig);

/* The scene of a run, ready to render; the rig's until the next call. */
SSFR_MUST ssfr_result ssfr_rig_stage(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], const ssfr_stage **out);
/* A graph with the settings of every run and the axes as the last run left them. */
const ssfr_graph *ssfr_rig_graph(const ssfr_rig *rig);

/* Makes one run. What is not known when it fails stays NaN. */
SSFR_MUST ssfr_result ssfr_rig_run(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], double values[SSFR_N_COLUMNS]);

/* The value of an axis in a run. */
const char *ssfr_rig_value(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES], const char *key);
/* "640x360" as two numbers. */
bool ssfr_rig_size(const char *text, int size[2]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel.h: what the ray through one pixel tells. */
#ifndef SSFR_TRUTH_PIXEL_H
#define SSFR_TRUTH_PIXEL_H

#include "experiments/truth/fluid_light.h"
#include "experiments/truth/surroundings.h"
#include "experiments/truth/tiles.h"

/* What all rays have in common: constant while they are cast. */
typedef struct ssfr_truth_scene {
    const ssfr_truth_params *params;
    const ssfr_tiles *tiles;
    const ssfr_scene *scene;
    ssfr_continuum fluid;
    ssfr_extinction foam;
    ssfr_surroundings *around;
    bool hides;    /* solids and the floor hide any of what is cast */
    double eye[3]; /* m, relative to the fluid's origin */
} ssfr_truth_scene;

SSFR_MUST ssfr_result ssfr_truth_scene_init(ssfr_truth_scene *out, const ssfr_stage *stage,
                                            const ssfr_truth_params *params, const ssfr_tiles *tiles);
void ssfr_truth_scene_finish(ssfr_truth_scene *scene);

/* One thread's work space. */
typedef struct ssfr_truth_worker {
    const ssfr_truth_scene *scene;
    ssfr_line fluid, foam;
    ssfr_crossings crossings;
    ssfr_integration *integration;
    ssfr_fluid_light *light; /* NULL when the colour is not asked for */
} ssfr_truth_worker;

SSFR_MUST ssfr_result ssfr_truth_worker_init(ssfr_truth_worker *out, const ssfr_truth_scene *scene);
void ssfr_truth_worker_finish(ssfr_truth_worker *worker);

/* The numbers of a pixel, as the scene's tiles have them; adds what the ray came upon to the tally. */
SSFR_MUST ssfr_result ssfr_truth_pixel(ssfr_truth_worker *worker, int x, int y, double *values,
                                       ssfr_truth_tally *tally);

#endif

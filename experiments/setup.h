/* SPDX-License-Identifier: GPL-3.0-or-later */
/* setup.h: a graph from the options that say what runs: --pipeline, --backend, --set. */
#ifndef SSFR_SETUP_H
#define SSFR_SETUP_H

#include "experiments/options.h"
#include "experiments/scenes/description.h"

enum { SSFR_BACKEND_GL, SSFR_BACKEND_CPU }; /* the words of --backend, in their order */

typedef struct ssfr_setup_options {
    const char *pipeline;
    int backend;
    ssfr_list settings; /* "key=value" */
} ssfr_setup_options;

/* The first row is --pipeline: a command without it starts at the second. */
extern const ssfr_option ssfr_setup_rows[];
void ssfr_setup_defaults(ssfr_setup_options *options);

typedef struct ssfr_setup {
    const ssfr_pipeline *pipeline;
    ssfr_gl *gl; /* NULL for the CPU */
    ssfr_graph *graph;
} ssfr_setup;

/* The pipeline of that name, or an error that lists those there are. */
SSFR_MUST ssfr_result ssfr_setup_find_pipeline(const ssfr_pipeline **out, const char *name);
SSFR_MUST ssfr_result ssfr_setup_find_pass(const ssfr_pass **out, const char *name);

/* "KEY=VALUE" of --set: its key to key[256], its value stays where it is. */
SSFR_MUST ssfr_result ssfr_setup_split(const char *setting, char key[256], const char **value);

/* The settings of a scene file; those of passes that this graph has not are left alone. */
SSFR_MUST ssfr_result ssfr_setup_apply_scene(ssfr_graph *graph, const ssfr_description *description);

/* pass NULL: the pipeline that the options name; else that pass by itself. */
SSFR_MUST ssfr_result ssfr_setup_init(ssfr_setup *setup, const ssfr_setup_options *options, const ssfr_pass *pass);
/* The settings of the scene, and then again those of the options, which count for more. description may be NULL. */
SSFR_MUST ssfr_result ssfr_setup_scene(ssfr_setup *setup, const ssfr_setup_options *options,
                                       const ssfr_description *description);
/* Puts an EXR with R,G,B and Z of the camera's size in the place of what the pipeline draws of the scene. path NULL:
 * nothing. */
SSFR_MUST ssfr_result ssfr_setup_background(ssfr_graph *graph, const char *path, const ssfr_camera *camera);
void ssfr_setup_finish(ssfr_setup *setup);

#endif

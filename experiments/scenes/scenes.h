/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scenes.h: what a SCENE on the command line may be: a built-in shape, a scene file inside the binary or on disk, a
 * file of particles, or a sequence of such files. The list of shapes is in builtin.c; that of scenes is the folder. */
#ifndef SSFR_SCENES_H
#define SSFR_SCENES_H

#include "experiments/scenes/description.h"

typedef struct ssfr_builtin {
    const char *name, *help;
    /* Makes the particles; the same seed gives the same bits. */
    ssfr_result (*make)(ssfr_particles **out, uint64_t seed);
    int n_frames;   /* which are all of the same time; 0: one picture, of none */
    double from[3]; /* world direction from the middle towards the eye; zero: the default of a bare file */
    double top;     /* m, world y: the default view frames what is below it; 0: everything */
    double floor;   /* m, world y; NaN: just below the particles; -inf: none */
    int n_solids;
    const ssfr_solid *solids;
    int n_views;            /* cameras beside the default view */
    const ssfr_view *views;
} ssfr_builtin;

const ssfr_builtin *ssfr_builtin_find(const char *name); /* NULL when there is none */
const ssfr_builtin *ssfr_builtin_at(int i);              /* NULL past the end */

typedef enum ssfr_scene_kind {
    SSFR_SCENE_BUILTIN,   /* made by code */
    SSFR_SCENE_DESCRIBED, /* simulated from a scene file */
    SSFR_SCENE_PARTICLES, /* a file */
    SSFR_SCENE_SEQUENCE,  /* files, as a pattern with one %d */
} ssfr_scene_kind;

typedef struct ssfr_scene_source {
    ssfr_scene_kind kind;
    const ssfr_builtin *builtin;           /* of the first kind */
    const struct ssfr_embedded *embedded;  /* of the second; NULL for a file on disk */
    char name[1024]; /* "bagar2010/waterfall", or the path */
} ssfr_scene_source;

/* What a word means: a name, also the last part of one where no other ends in it, or a path. */
SSFR_MUST ssfr_result ssfr_scene_find(const char *word, ssfr_scene_source *out);

/* The i-th scene inside the binary, by name; false past the end. */
bool ssfr_scene_at(int i, ssfr_scene_source *out);

/* Reads the scene file of a described scene. */
SSFR_MUST ssfr_result ssfr_scene_describe(const ssfr_scene_source *source, ssfr_scale scale, ssfr_description **out);

#endif

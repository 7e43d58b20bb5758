/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stage.h: a stage is a scene made ready to render: particles, camera, solids and floor, owned together. */
#ifndef SSFR_STAGE_H
#define SSFR_STAGE_H

#include "experiments/options.h"

typedef struct ssfr_stage_options {
    double radius;  /* m; 0: the file's or the scene's own */
    double eye[3], target[3], up[3]; /* m, world; NaN: a view that frames the particles */
    double fov_deg; /* full vertical angle */
    int size[2];    /* px */
    bool drop_nonfinite;
    uint64_t seed;  /* of the scenes that are made by code */
} ssfr_stage_options;

/* The rows of a command that takes a SCENE, for its values in an ssfr_stage_options that starts from the defaults. */
extern const ssfr_option ssfr_stage_rows[];
void ssfr_stage_defaults(ssfr_stage_options *options);

typedef struct ssfr_stage {
    char *name;       /* as the user called the scene */
    ssfr_scene scene; /* points into the stage */
    ssfr_particles *particles;
    const struct ssfr_builtin *builtin; /* NULL for a file */
    ssfr_solid solids[SSFR_MAX_SOLIDS];
    size_t n_dropped; /* particles with a value that is not finite */
} ssfr_stage;

/* scene is a built-in name or the path of a particle file. */
SSFR_MUST ssfr_result ssfr_stage_create(ssfr_stage **out, const char *scene, const ssfr_stage_options *options);
void ssfr_stage_destroy(ssfr_stage **stage);

/* Sets the camera anew, for another size or view of the same particles. */
SSFR_MUST ssfr_result ssfr_stage_aim(ssfr_stage *stage, const ssfr_stage_options *options);

/* Bounds of the particles as balls, m, world: those of their centres and a radius around. */
void ssfr_stage_bounds(const ssfr_stage *stage, double lo[3], double hi[3]);

/* The part of them that the default view frames, m: all below the built-in scene's top; a unit box when there are no
 * particles. */
void ssfr_stage_view_box(const ssfr_stage *stage, double lo[3], double hi[3]);

#endif

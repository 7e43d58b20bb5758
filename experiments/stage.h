/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stage.h: a stage is a scene made ready to render: particles, camera, solids and floor, owned together. */
#ifndef SSFR_STAGE_H
#define SSFR_STAGE_H

#include "experiments/options.h"
#include "experiments/scenes/scenes.h"
#include "experiments/sequence.h"

typedef struct ssfr_stage_options {
    double radius;    /* m; 0: the file's or the scene's own */
    double unit;      /* m, a file's unit of length */
    int up_axis;      /* of a file: the words x, y, z */
    const char *map;  /* where an HDF5 file has its arrays; NULL: as ssfr's own */
    bool drop_nonfinite;
    int scale;           /* ssfr_scale */
    long frame;          /* -1: at `time`, or else the one two thirds of the way */
    double time;         /* s; NaN: not said */
    const char *camera;  /* a view by name; NULL: the first */
    double camera_time;  /* s, where it is on its path; NaN: where it is at the frame's time */
    const char *cache;   /* folder of simulated frames; NULL: the user's */
    double eye[3], target[3], up[3]; /* m, world; NaN: the scene's, else a view that frames the particles */
    double fov_deg; /* full vertical angle; NaN: the scene's, else 45 */
    int size[2];    /* px */
    uint64_t seed;  /* of the scenes that are made by code or simulated */
    const char *play; /* how many frames before a drawn one are played, see play.h; NULL: as many as matter */
} ssfr_stage_options;

/* The rows of a command that takes a SCENE, for its values in an ssfr_stage_options that starts from the defaults. */
extern const ssfr_option ssfr_scene_rows[]; /* which scene and frame */
extern const ssfr_option ssfr_file_rows[];  /* how files are to be read */
extern const ssfr_option ssfr_view_rows[];  /* from where it is seen */
#define SSFR_STAGE_SETS(options)                                                         \
    {"scene", ssfr_scene_rows, (options)}, {"particle files", ssfr_file_rows, (options)}, \
        {"view", ssfr_view_rows, (options)}
void ssfr_stage_defaults(ssfr_stage_options *options);
/* What ssfr_particles_load gets of them. */
ssfr_load_options ssfr_stage_load_options(const ssfr_stage_options *options);

typedef struct ssfr_stage {
    char *name;       /* as the user called the scene */
    ssfr_scene scene; /* points into the stage */
    ssfr_scene_source source;
    ssfr_description *description; /* NULL when there is none */
    char *folder;             /* of a described scene's frames, else NULL */
    size_t n_frames;
    long *frames;             /* the numbers of those there are, or can be made, rising; n_frames 0: only one picture */
    long frame;               /* shown now; -1 when there is only one */
    double time;              /* s; NaN where its frames have none */
    double simulation_ms;     /* wall time that the simulation of the frame took; NaN: not known */
    ssfr_particles *particles;
    ssfr_particles *foam;     /* diffuse particles of the frame; NULL for none */
    ssfr_solid solids[SSFR_MAX_SOLIDS];
    ssfr_field *environment;  /* NULL for none */
    bool is_held;             /* the view frames the box below, whatever the frame */
    double held_lo[3], held_hi[3]; /* m */
    size_t n_dropped; /* particles with a value that is not finite */
    double estimate;  /* m, the radius where no file tells it: from the first frame shown, for all; else 0 */
} ssfr_stage;

/* A scene by name or path (see scenes.h), with the frame that the options name, which is made when it is missing. */
SSFR_MUST ssfr_result ssfr_stage_create(ssfr_stage **out, const char *scene, const ssfr_stage_options *options);
/* The same without a frame yet: the scene's particles are NULL. */
SSFR_MUST ssfr_result ssfr_stage_open(ssfr_stage **out, const char *scene, const ssfr_stage_options *options);
void ssfr_stage_destroy(ssfr_stage **stage);

/* The frame that the options name, or the one two thirds of the way; -1 for a scene of one picture. One that is not in
 * `frames` is refused. */
SSFR_MUST ssfr_result ssfr_stage_find_frame(const ssfr_stage *stage, const ssfr_stage_options *options, long *frame);

/* Shows another frame, of those in `frames`; -1: that which the options name. */
SSFR_MUST ssfr_result ssfr_stage_show(ssfr_stage *stage, const ssfr_stage_options *options, long frame);

/* The fluid of a frame before the one shown of a scene whose frames have a time; that stays the one shown. */
SSFR_MUST ssfr_result ssfr_stage_read(const ssfr_stage *stage, const ssfr_stage_options *options, long frame,
                                      ssfr_particles **fluid);
/* When a frame of a described scene is, s, or of a shape that has some; NaN of others. */
double ssfr_stage_time(const ssfr_stage *stage, long frame);

/* The frames of a range; fails for a scene of one picture. To free(). */
SSFR_MUST ssfr_result ssfr_stage_choose(const ssfr_stage *stage, const ssfr_frame_range *range, size_t *n,
                                        long **frames);

/* From here on the view stands still where it is not the scene's own: it frames the first, the middle and the last of
 * these frames. Makes all that are missing. */
SSFR_MUST ssfr_result ssfr_stage_hold(ssfr_stage *stage, const ssfr_stage_options *options, size_t n,
                                      const long *frames);

/* Shows what the options say: the particles are loaded only where their frame is not the one shown. */
SSFR_MUST ssfr_result ssfr_stage_turn(ssfr_stage *stage, const ssfr_stage_options *options);

/* Sets the camera anew, for another size or view of the same particles. */
SSFR_MUST ssfr_result ssfr_stage_aim(ssfr_stage *stage, const ssfr_stage_options *options);

/* The camera that the options name, or the scene's first; NULL where a scene has none. */
SSFR_MUST ssfr_result ssfr_stage_find_view(const ssfr_stage *stage, const ssfr_stage_options *options,
                                           const ssfr_view **out);

/* The same, which must have a path; follow: with a frame for each of its moments. */
SSFR_MUST ssfr_result ssfr_stage_find_path(const ssfr_stage *stage, const ssfr_stage_options *options, bool follow,
                                           const ssfr_view **out);
/* When the camera is in the i-th of n views of its path, s: evenly spaced from its first key to its last. */
double ssfr_stage_view_time(const ssfr_view *path, size_t i, size_t n);

/* Bounds of the particles as balls, m, world: those of their centres and a radius around. */
void ssfr_stage_bounds(const ssfr_stage *stage, double lo[3], double hi[3]);

/* The part of them that the default view frames, m: all below the built-in scene's top; a unit box when there are no
 * particles. */
void ssfr_stage_view_box(const ssfr_stage *stage, double lo[3], double hi[3]);

#endif

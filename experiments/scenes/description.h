/* SPDX-License-Identifier: GPL-3.0-or-later */
/* description.h: what a scene file says: fluid, solids and their motions, emitters, cameras, light. docs/scenes.md has
 * every key. Read once, then constant. */
#ifndef SSFR_DESCRIPTION_H
#define SSFR_DESCRIPTION_H

#include "experiments/scenes/foam.h"
#include "experiments/scenes/solver.h"
#include "experiments/scenes/spline.h"

typedef enum ssfr_scale { SSFR_SCALE_QUICK, SSFR_SCALE_FULL } ssfr_scale; /* the words of --scale, in their order */
/* What quick has fewer particles by; its radius is the cube root of that larger. */
#define SSFR_QUICK_SHARE 16

/* Where a body is at a time: turned about an axis through its pivot, then moved. */
typedef struct ssfr_pose_key {
    double time;     /* s */
    double move[3];  /* m */
    double turn_deg;
} ssfr_pose_key;

typedef enum ssfr_easing { SSFR_EASE_SMOOTH, SSFR_EASE_LINEAR } ssfr_easing; /* cubic with rest at each key, or not */

typedef struct ssfr_motion {
    char *name;
    double pivot[3], axis[3]; /* m, world, at time 0; unit vector */
    double period;            /* s, after which it begins again; 0: stays at the last key */
    ssfr_easing easing;
    int n_keys;
    ssfr_pose_key *keys;      /* by rising time */
} ssfr_motion;

typedef struct ssfr_body {
    char *name;
    ssfr_solid solid;   /* before its motion */
    ssfr_mesh *mesh;    /* of the solid, owned; NULL for none */
    char *file;         /* path of the mesh; NULL for none */
    int motion;         /* index; -1 for none */
    double friction;
    bool hidden;        /* met by the fluid, but not drawn */
} ssfr_body;

/* A box full of fluid from the start, filled from below until `count` particles are there (0: as many as fit). What
 * lies in a solid stays free. */
typedef struct ssfr_pool {
    char *name;
    double lo[3], hi[3]; /* m, world */
    double velocity[3];  /* m/s */
    size_t count;        /* at this scale */
} ssfr_pool;

/* Fluid that streams out of a disc or rectangle. */
typedef struct ssfr_emitter {
    double centre[3];    /* m, world */
    double direction[3]; /* unit */
    double up[3];        /* unit, at right angles to direction: the rectangle's second side */
    double half[2];      /* m; a disc has its radius twice */
    bool disc;
    double speed;        /* m/s */
    double start, stop;  /* s */
    int motion;          /* index of what it is fixed to; -1 for none */
} ssfr_emitter;

typedef struct ssfr_view_key {
    double time;              /* s; one key alone is a camera that stands still */
    double eye[3], target[3]; /* m, world */
    double fov_deg;           /* full vertical */
} ssfr_view_key;

typedef struct ssfr_view { /* a camera, or a path through its keys: a cubic spline over time */
    char *name;
    double up[3];
    int n_keys;
    ssfr_view_key *keys; /* by rising time */
    ssfr_curve *curve;   /* through the keys: eye, target, fov_deg; NULL for one key */
} ssfr_view;

typedef struct ssfr_scene_setting { /* "medium.ior" = "1.33": of the graph */
    char *key, *value, *where; /* where: "file:line:column", for messages */
} ssfr_scene_setting;

typedef struct ssfr_description {
    char *name;      /* "bagar2010/waterfall", or the path of the file */
    char *title;     /* one line */
    char *text;      /* the file's, for the key of the cache */
    ssfr_scale scale;
    ssfr_solver_setup solver; /* radius, domain, gravity, limits: at this scale */
    double rest_time;         /* s, simulated before frame 0 */
    double frame_rate;        /* 1/s */
    int n_frames;
    double floor;             /* m, what is drawn as the ground; -inf for none */
    int n_motions, n_bodies, n_pools, n_emitters, n_sinks, n_views, n_settings;
    ssfr_motion *motions;
    ssfr_body *bodies;
    ssfr_pool *pools;
    ssfr_emitter *emitters;
    ssfr_solid *sinks;
    ssfr_view *views;
    ssfr_scene_setting *settings; /* light, medium, sky, floor and passes */
    bool has_foam;
    ssfr_foam_params foam;
    char *environment;            /* path of a latitude-longitude EXR; NULL: the procedural sky */
    char *background;             /* path of an EXR with R,G,B and Z, as render --background; NULL */
} ssfr_description;

/* Loads a mesh, as ssfr_mesh_load does from a file. */
typedef ssfr_result ssfr_mesh_loader(ssfr_mesh **out, const char *path);

/* Reads and checks a scene file; every error names file, line and column. Paths in it are relative to its folder. */
SSFR_MUST ssfr_result ssfr_description_load(ssfr_description **out, const char *path, ssfr_scale scale);
/* The same from text, as if it were a file of that name; for the scenes inside the binary. load_mesh gets the paths of
 * meshes with the folder of `name` before them: "akinci2013/ship.obj" for ship.obj of "akinci2013/wake". NULL:
 * ssfr_mesh_load. */
SSFR_MUST ssfr_result ssfr_description_parse(ssfr_description **out, const char *name, const char *text,
                                             ssfr_scale scale, ssfr_mesh_loader *load_mesh);
void ssfr_description_destroy(ssfr_description **description);

/* The pools' particles at the start, as the solver takes them, max_particles at most: cubic lattices as wide as
 * particles at rest, half of that off the pools' sides and a radius off solids. To free(). */
SSFR_MUST ssfr_result ssfr_description_fill(const ssfr_description *description, size_t *n, double **positions,
                                            float **velocities);

/* A body's solid at a time (s). Before time 0 motions stand as they do then. */
ssfr_solid ssfr_body_at(const ssfr_description *description, const ssfr_body *body, double time);
/* An emitter's place and direction at a time. */
ssfr_emitter ssfr_emitter_at(const ssfr_description *description, const ssfr_emitter *emitter, double time);

/* A view by name, or an error that lists those there are. */
SSFR_MUST ssfr_result ssfr_view_find(int n, const ssfr_view *views, const char *scene, const char *name,
                                     const ssfr_view **out);
/* The same of a description; name NULL: the first, NULL when there is none. */
SSFR_MUST ssfr_result ssfr_description_view(const ssfr_description *description, const char *name,
                                            const ssfr_view **out);
/* The key of a view at a time: from the spline through its keys; before the first and after the last it stands. */
ssfr_view_key ssfr_view_at(const ssfr_view *view, double time);

#endif

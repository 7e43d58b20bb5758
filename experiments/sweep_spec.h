/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweep_spec.h: what a sweep runs: axes, fixed settings, a reference, figures; from YAML or from the command line.
 *
 *      title: what the sweep asks                      # all keys but vary may be missing
 *      pipeline: vanderlaan2009                        # one value, or a list: then it is an axis
 *      scene: splash
 *      size: 640x360
 *      backend: [gl, cpu]
 *      set: {sphere_depth.splat: quad}                 # settings of every run
 *      vary:                                           # axes; the last runs fastest
 *        curvature_flow.iterations: 0:80:10
 *        curvature_flow.step: [0.3, 0.6, 0.9]
 *      reference: {curvature_flow.iterations: 60}      # settings of the frame that all are compared with
 *      plot: {x: ref_normal_mean_deg, y: ms_median, lines: [sphere_depth.splat, backend]}
 *      curves:                                         # panels of one more figure
 *        - {x: curvature_flow.iterations, y: ref_normal_mean_deg, lines: [sphere_depth.splat], only: {backend: cpu}}
 *      published: {file: tab1.csv, on: [scene, kernel], column: ms}   # the paper's numbers, see published.h
 *      quick: {title: the same, smaller, size: 320x180, set: {}, vary: {}} # what `reproduce --scale quick` replaces
 *
 * Further axes, each one value or a list: camera, frame, leave_out and cull (true, false); and
 *
 *      variants:                                       # an axis of names, each for what its runs have of their own
 *        base: {}
 *        coarse: {pipeline: bagar2010, scene: block, camera: top, frame: 3, size: 320x180, set: {downsample.factor: 4}}
 *      path: {camera: zoom, views: 12, frames: follow} # an axis `view`: moments of a camera's path
 *      against: {variant: base}                        # the row that all with else equal keys are held against
 *      added: [ref_flip]                               # columns whose difference to that row is shown
 *
 * `reference: truth` compares with what rays meet (truth/truth.h). Then truth.*, extinction.*, path.* and anisotropy.*
 * may be set and varied, too; truth.kind is an axis always, so that every row names its truth. */
#ifndef SSFR_SWEEP_SPEC_H
#define SSFR_SWEEP_SPEC_H

#include "base/base.h"

enum {
    SSFR_MAX_AXES = 16,
    SSFR_MAX_VALUES = 10000, /* of an axis */
    SSFR_MAX_SETTINGS = 256,
    SSFR_MAX_LINES = 4,  /* columns that together name a line of a figure */
    SSFR_MAX_PANELS = 8, /* of the curves */
    SSFR_MAX_ONLY = 12,  /* cells that choose the rows of a figure */
    SSFR_MAX_ON = 4,     /* columns by which published numbers are joined */
    SSFR_MAX_VARIANTS = 64,
    SSFR_MAX_ADDED = 16, /* columns that are compared with the row that this is held against */
};

/* What runs where nothing is said. */
#define SSFR_SWEEP_PIPELINE "vanderlaan2009"

/* One dimension of the table. A key is a parameter's, or "scene", "size", .. */
typedef struct ssfr_axis {
    char *key;
    size_t n;
    char **values; /* what is set and what stands in the table, to the letter */
    char *where;   /* "spec.yaml:7:3" or the option, for messages */
} ssfr_axis;

/* The key of an axis is a parameter's ("node.param"), not "scene", "size", .. */
bool ssfr_axis_is_parameter(const char *key);

typedef struct ssfr_setting {
    char *key, *value, *where;
} ssfr_setting;

typedef struct ssfr_settings {
    int n;
    ssfr_setting items[SSFR_MAX_SETTINGS];
} ssfr_settings;

typedef struct ssfr_variant {
    char *name, *where;
    ssfr_settings own;      /* pipeline, scene, camera, frame, size in the place of those of all runs */
    ssfr_settings settings; /* beside those of all runs, for which these count more */
} ssfr_variant;

typedef struct ssfr_path_spec { /* views 0: none */
    size_t views; /* evenly spaced in time from the camera's first key to its last */
    int frames;   /* ssfr_path_frames */
} ssfr_path_spec;

typedef enum ssfr_path_frames {
    SSFR_PATH_STAND,  /* every view shows the same frame */
    SSFR_PATH_FOLLOW, /* that at the camera's time */
} ssfr_path_frames;

typedef struct ssfr_against_spec { /* no cells: none */
    ssfr_settings cells; /* axes, and their values in the row that all with else equal keys are held against */
    int n_added;
    char *added[SSFR_MAX_ADDED]; /* columns */
    char *where;                 /* for messages */
} ssfr_against_spec;

typedef struct ssfr_plot_spec { /* columns by name; x NULL: no plot */
    char *title, *x, *y, *x_label, *y_label; /* labels NULL: what the column means */
    char *where; /* for messages */
    bool log[2]; /* x and y of curves are logarithmic; those of the plot are by what they mean */
    int n_lines, n_only;
    char *lines[SSFR_MAX_LINES];
    struct {
        char *column, *cell;
    } only[SSFR_MAX_ONLY]; /* rows with these cells alone; several of one column: any of them; none: all */
} ssfr_plot_spec;

/* What the errors are measured against. */
typedef enum ssfr_reference_kind {
    SSFR_REFERENCE_NONE,
    SSFR_REFERENCE_FRAME, /* a frame of the double twins with settings of its own */
    SSFR_REFERENCE_TRUTH, /* ray-cast */
} ssfr_reference_kind;

typedef struct ssfr_published_spec { /* file NULL: none */
    char *file, *column; /* in the folder published beside the sweep's; the column of it that is shown */
    int n_on;
    char *on[SSFR_MAX_ON], *with[SSFR_MAX_ON]; /* columns that rows are joined by: of that table, of the sweep's */
    char *where;           /* for messages */
} ssfr_published_spec;

typedef struct ssfr_sweep_spec ssfr_sweep_spec;
struct ssfr_sweep_spec {
    char *title; /* NULL when not given */
    int n_axes;
    ssfr_axis axes[SSFR_MAX_AXES];
    int n_variants;
    ssfr_variant *variants[SSFR_MAX_VARIANTS]; /* those that the axis `variant` names, and perhaps more */
    ssfr_path_spec path;
    ssfr_settings settings, reference; /* of every run; of the frame that they are compared with */
    ssfr_reference_kind compared_with;
    ssfr_against_spec against;
    ssfr_plot_spec plot;
    int n_curves;
    ssfr_plot_spec curves[SSFR_MAX_PANELS];
    ssfr_published_spec published;
    ssfr_sweep_spec *quick; /* title, axes, variants, path and settings that replace those above at quick scale; NULL */
};

SSFR_MUST ssfr_result ssfr_sweep_spec_create(ssfr_sweep_spec **out);
/* Reads a YAML file; "-" is standard input. */
SSFR_MUST ssfr_result ssfr_sweep_spec_load(ssfr_sweep_spec **out, const char *path);
/* The same from a text; path is what errors call it. */
SSFR_MUST ssfr_result ssfr_sweep_spec_parse(ssfr_sweep_spec **out, const char *path, const char *text, size_t size);
void ssfr_sweep_spec_destroy(ssfr_sweep_spec **spec);

/* Adds an axis from "a,b,c", "lo:hi:step" (hi included when hit within 1e-9 steps) or "lo:hi:N log"; one of the same
 * key is replaced, in its place. */
SSFR_MUST ssfr_result ssfr_sweep_spec_vary(ssfr_sweep_spec *spec, const char *where, const char *key,
                                           const char *values);
/* The same from "key=values". */
SSFR_MUST ssfr_result ssfr_sweep_spec_vary_text(ssfr_sweep_spec *spec, const char *where, const char *text);
/* Adds "key=value" to the settings of every run. */
SSFR_MUST ssfr_result ssfr_sweep_spec_set_text(ssfr_sweep_spec *spec, const char *where, const char *text);

/* "truth", or the same for the frame that is the reference then; what a file sets of a frame yields to "truth". */
SSFR_MUST ssfr_result ssfr_sweep_spec_reference_text(ssfr_sweep_spec *spec, const char *where, const char *text);
/* Adds the axes that every sweep has and this one lacks: one pipeline, one scene, one size, one kind of truth where
 * that is the reference, one backend; the backend comes last. */
SSFR_MUST ssfr_result ssfr_sweep_spec_complete(ssfr_sweep_spec *spec);

/* Makes a complete spec what it is at quick scale: what its `quick` says; half the width and height unless that says a
 * size, and at most twelve views of a path unless that says another path. */
SSFR_MUST ssfr_result ssfr_sweep_spec_quicken(ssfr_sweep_spec *spec);

/* The axis of that key, NULL when there is none. */
const ssfr_axis *ssfr_sweep_spec_axis(const ssfr_sweep_spec *spec, const char *key);

/* The variant of that name, NULL when there is none. */
const ssfr_variant *ssfr_sweep_spec_variant(const ssfr_sweep_spec *spec, const char *name);
/* The variant of a run, NULL when there are none. */
const ssfr_variant *ssfr_sweep_spec_variant_of(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES]);
/* What a variant (NULL: nothing) has of its own, NULL when it says nothing of this. */
const ssfr_setting *ssfr_variant_own(const ssfr_variant *variant, const char *key);
/* What a run has of an axis: its variant's own, else the axis' value; NULL where there is neither. */
const char *ssfr_sweep_spec_value(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES], const char *key);

/* Where that is said. */
const char *ssfr_sweep_spec_where(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES], const char *key);
/* Goes on to the next of the product of these axes alone, the last key the fastest; false after the last. Keys that are
 * no axes have one value. */
bool ssfr_sweep_spec_next(const ssfr_sweep_spec *spec, size_t n, const char *const *keys, size_t index[SSFR_MAX_AXES]);

/* The number of runs of the full product; an error when there are more than ten million. */
SSFR_MUST ssfr_result ssfr_sweep_spec_count(const ssfr_sweep_spec *spec, size_t *out);
/* The index into each axis' values in run i; the last axis is the fastest. */
void ssfr_sweep_spec_run(const ssfr_sweep_spec *spec, size_t i, size_t index[SSFR_MAX_AXES]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truth.h: the ray-cast image of a stage: the reference that says how wrong a screen-space method is, and how wrong it
 * is itself, pixel by pixel. */
#ifndef SSFR_TRUTH_H
#define SSFR_TRUTH_H

#include "experiments/stage.h"
#include "experiments/truth/crossings.h"
#include "experiments/truth/light.h"
#include "experiments/truth/radiance.h"
#include "graph/frame.h"

/* Must be raised when any pixel's bits change: cached truth is of one version. */
enum { SSFR_TRUTH_VERSION = 4 };

/* What a pixel gets: X(id, channels, EXR names, part, unit, help). All is met by the ray through the pixel's middle.
 * Depth, normal and thickness are as slots of pipelines have them: axes, signs and empty values are the same. */
typedef enum ssfr_truth_channel {
#define X(id, n, names, part, unit, help) SSFR_TRUTH_##id,
#include "experiments/truth/channels.def"
#undef X
    SSFR_N_TRUTH_CHANNELS
} ssfr_truth_channel;

/* Parts that may be left out, as bits: colour is a tree of rays and costs more than all the others. */
enum {
    SSFR_TRUTH_SURFACE = 1,   /* depth, normal */
    SSFR_TRUTH_THICKNESS = 2,
    SSFR_TRUTH_FOAM = 4,
    SSFR_TRUTH_COLOUR = 8,
    SSFR_TRUTH_ALL = 15,
};

typedef struct ssfr_truth_channel_row {
    const char *name, *exr;
    int n, part;
    const char *unit, *help;
} ssfr_truth_channel_row;

extern const ssfr_truth_channel_row ssfr_truth_channels[SSFR_N_TRUTH_CHANNELS];

/* ---- parameters: truth.*, extinction.*, path.*, anisotropy.*, and the scene's medium.*, light.*, sky.*, floor.* -- */

typedef struct ssfr_truth_cast_params { /* truth.*, beside those of ssfr_continuum_rows */
    unsigned parts;   /* what is cast, bits of the enum above; words surface, thickness, foam, colour */
    int integrator;   /* ssfr_integrator_id */
    double eps_abs, eps_rel;
    int points, steps;
    double judged;    /* share of the rays that GSL's qagp judges when the integrator is `chords`, [0, 1] */
    int solids;       /* flag: solids and the floor hide what is behind them from depth, normal and thickness, too, as
                       * they do from splats. Foam and colour always have solids */
} ssfr_truth_cast_params;

typedef struct ssfr_truth_params {
    ssfr_continuum_params fluid;
    ssfr_truth_cast_params cast;
    ssfr_extinction_params extinction;
    ssfr_light_params path;
    ssfr_anisotropy_params anisotropy;
    ssfr_world world;
} ssfr_truth_params;

void ssfr_truth_defaults(ssfr_truth_params *params);
/* key: "truth.level", "extinction.radius", "path.depth", "anisotropy.k_r", "medium.ior" and so on. */
SSFR_MUST ssfr_result ssfr_truth_set(ssfr_truth_params *params, const char *key, const char *value);
/* Row and struct behind the i-th key, which is written to key[128]; false past the end. */
bool ssfr_truth_key_at(const ssfr_truth_params *params, int i, char key[128], const ssfr_param **row,
                       const void **group);
/* A scene file's settings of groups that truth has; those of passes are left alone. */
SSFR_MUST ssfr_result ssfr_truth_apply_scene(ssfr_truth_params *params, const ssfr_description *description);

/* ---- casting ----------------------------------------------------------------------------------------------------- */

typedef struct ssfr_truth_options {
    int every;          /* N: one pixel of each square of N x N, chosen by the seed; 1: all */
    uint64_t seed;
    const char *cache;  /* folder; NULL: the user's */
    bool no_cache;      /* neither read nor written */
    bool anew;          /* not read */
    bool progress;
} ssfr_truth_options;

typedef struct ssfr_truth_stats {
    size_t rays, crossings, touches, judged; /* of view rays, */
    size_t light_touches; /* and of those that light takes, each of which may have split or not */
    double judged_max;    /* m, the largest disagreement of the closed form with GSL's integral */
    double judged_ratio;  /* the same over the sum of both estimates: GSL's is no bound, but far above 1 one is wrong */
    double seconds;       /* of one core, for casting all of it, also what was cast before */
    double bytes;         /* of the fluid's and the foam's arrays; 0 when nothing had to be cast */
    bool cached;          /* nothing had to be cast */
} ssfr_truth_stats;

typedef struct ssfr_truth {
    int w, h;
    unsigned parts;
    int every;
    ssfr_field *channels[SSFR_N_TRUTH_CHANNELS]; /* NULL for parts that were not asked for */
    ssfr_field *cast; /* 1 where a pixel was cast, 0 elsewhere, where all channels hold their empty values */
    ssfr_truth_stats stats;
} ssfr_truth;

/* What no stage can be cast with: for who wants to know before there is one. */
SSFR_MUST ssfr_result ssfr_truth_check(const ssfr_truth_params *params, const ssfr_truth_options *options);
/* Casts tile by tile with all threads; the bits are the same for any number of them. Tiles that are done stand in the
 * cache: who was interrupted (SIGINT or SIGTERM: it then fails) goes on there. */
SSFR_MUST ssfr_result ssfr_truth_create(ssfr_truth **out, const ssfr_stage *stage, const ssfr_truth_params *params,
                                        const ssfr_truth_options *options);
void ssfr_truth_destroy(ssfr_truth **truth);

/* What the truth of a stage depends on, and nothing else. */
uint64_t ssfr_truth_key(const ssfr_stage *stage, const ssfr_truth_params *params, const ssfr_truth_options *options);

#endif

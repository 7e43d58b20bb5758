/* SPDX-License-Identifier: GPL-3.0-or-later */
/* make.h: simulating a scene into frames on disk, once: the cache, resuming, progress.
 *
 *      $XDG_CACHE_HOME/ssfr/scenes/bagar2010-waterfall-quick-0f3a.../fluid_0000.h5, foam_0000.h5, time_0000.ms, ...,
 *      state.bin */
#ifndef SSFR_MAKE_H
#define SSFR_MAKE_H

#include "experiments/scenes/description.h"

extern const char *const ssfr_scale_words[]; /* "quick", "full", NULL */

/* Tells the frames of a description from those of any other: a hash of its text, its meshes, the scale, the seed and
 * SSFR_SOLVER_VERSION. */
uint64_t ssfr_make_key(const ssfr_description *description, uint64_t seed);

/* The folder of a description's frames: of its name, scale and key. cache NULL: $XDG_CACHE_HOME or ~/.cache. To
 * free(). */
SSFR_MUST ssfr_result ssfr_make_folder(const ssfr_description *description, const char *cache, uint64_t seed,
                                       char **out);

typedef struct ssfr_make_options {
    const char *cache;  /* NULL: the user's */
    uint64_t seed;
    int last;           /* make frames 0 .. last; -1: all */
    bool anew;          /* make all again */
} ssfr_make_options;

/* Simulates the frames that are not there yet, going on from the state that an earlier call left. Waits while another
 * process makes the same. After SIGINT or SIGTERM the frame in progress is given up, all before it stay, and it fails.
 * When a value becomes non-finite it fails, naming frame and particle; all frames before stay. */
SSFR_MUST ssfr_result ssfr_make(const ssfr_description *description, const ssfr_make_options *options);

/* The path of a frame's file in the folder; foam: of the diffuse particles. To free(). */
SSFR_MUST ssfr_result ssfr_make_path(const char *folder, int frame, bool foam, char **out);
/* The wall time that the simulation of a frame took, ms; NaN where that was not kept. */
double ssfr_make_time(const char *folder, int frame);
/* How many frames, counted from 0 without a gap, are there. */
int ssfr_make_count(const char *folder);

#endif

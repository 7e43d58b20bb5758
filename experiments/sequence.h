/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sequence.h: files that are numbered, one a frame: dir/frame_%04d.ply, and which of them are meant. */
#ifndef SSFR_SEQUENCE_H
#define SSFR_SEQUENCE_H

#include "base/base.h"

enum { SSFR_MAX_FRAME = 999999999 };

/* True when the name has a '%': then it is to be a pattern, good or bad. */
bool ssfr_sequence_is(const char *name);

/* A pattern has one '%' in all, in the file's own name and not in its folder's: as %d, or as %01d to %09d, which fill
 * up with zeros. Anything else is refused. */
SSFR_MUST ssfr_result ssfr_sequence_check(const char *pattern);

/* The name of a frame in [0, SSFR_MAX_FRAME], to be read or to be written. To free(). */
SSFR_MUST ssfr_result ssfr_sequence_path(const char *pattern, long frame, char **out);

/* The numbers whose files are there, rising, perhaps with gaps, perhaps none. A number counts where its name is just
 * what ssfr_sequence_path makes of it. To free(). */
SSFR_MUST ssfr_result ssfr_sequence_find(const char *pattern, size_t *n, long **frames);

/* first, first + step, ..., up to last. An end that is not said is as far as there are frames. */
typedef struct ssfr_frame_range {
    long first, last; /* [0, SSFR_MAX_FRAME], first <= last */
    long step;        /* [1, SSFR_MAX_FRAME] */
    bool from_start, to_end; /* the end was not said: first or last is then as far as numbers go */
} ssfr_frame_range;

/* All frames. */
extern const ssfr_frame_range ssfr_frame_range_all;

/* "A" (one frame), "A:B", "A:B:STEP"; A and B may be empty: ":" is all, "10:" all from 10, "::5" every fifth. */
SSFR_MUST ssfr_result ssfr_frame_range_parse(ssfr_frame_range *out, const char *text);

/* The frames of the range, rising, out of the n numbers `there` (rising). Between ends that were both said each must be
 * there; with an open end those that are missing are left out. Steps count from A, or from the first there. Fails when
 * a frame is missing, naming it, or when none is left; `what` begins the error line. To free(). */
SSFR_MUST ssfr_result ssfr_frame_range_choose(const ssfr_frame_range *range, const char *what, size_t n,
                                              const long *there, size_t *n_frames, long **frames);

/* The same out of the files that are there. */
SSFR_MUST ssfr_result ssfr_sequence_frames(const char *pattern, const ssfr_frame_range *range, size_t *n_frames,
                                           long **frames);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tiles.h: the image in tiles: which of its pixels are cast, and what a pixel's numbers are. */
#ifndef SSFR_TRUTH_TILES_H
#define SSFR_TRUTH_TILES_H

#include "experiments/truth/truth.h"

enum { SSFR_TRUTH_TILE = 32, SSFR_TRUTH_TILE_PIXELS = SSFR_TRUTH_TILE * SSFR_TRUTH_TILE,
       SSFR_TRUTH_VALUES = 32 /* no pixel has more */ };

/* What the rays of a tile came upon. */
typedef struct ssfr_truth_tally {
    uint64_t rays, crossings, touches, light_touches, judged;
    double judged_max, judged_ratio; /* as in ssfr_truth_stats */
    double seconds;
} ssfr_truth_tally;

typedef struct ssfr_tiles {
    int w, h;               /* px */
    int every;              /* side of the squares of which one pixel each is cast, px */
    uint64_t seed;
    int n_values;           /* doubles of a pixel: the channels of all parts that are cast, in their order */
    int at[SSFR_N_TRUTH_CHANNELS]; /* where a channel stands in them; -1 for none */
    double empty[SSFR_TRUTH_VALUES]; /* of pixels that are not cast, or see nothing */
    int tiles_x, n;         /* tiles in a row, and in all */
    size_t *first;          /* n + 1: pixels cast in all tiles before */
} ssfr_tiles;

SSFR_MUST ssfr_result ssfr_tiles_init(ssfr_tiles *out, int w, int h, unsigned parts, int every, uint64_t seed);
void ssfr_tiles_finish(ssfr_tiles *tiles);

/* The pixels of a tile that are cast, in an order that does not change; how many. */
int ssfr_tiles_pixels(const ssfr_tiles *tiles, int tile, int pixels[SSFR_TRUTH_TILE_PIXELS][2]);

/* The pixel that stands for the square whose corner is at x, y: each of those inside the image has the same chance. */
void ssfr_tiles_choose(const ssfr_tiles *tiles, int x, int y, int pixel[2]);

#endif

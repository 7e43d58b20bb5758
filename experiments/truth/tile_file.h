/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tile_file.h: the tiles that were cast, in a file, so that nobody casts them again.
 *
 *      $XDG_CACHE_HOME/ssfr/truth/0f3a....tiles
 *      head | tile 0: head, pixels | tile 1: head, pixels | ...      every tile at a place of its own, in any order
 *
 * Each tile has a checksum: one that is missing, torn or damaged is as if it had not been cast. */
#ifndef SSFR_TRUTH_TILE_FILE_H
#define SSFR_TRUTH_TILE_FILE_H

#include "experiments/truth/tiles.h"

typedef struct ssfr_tile_file {
    char *path; /* NULL: nothing is kept */
    int fd;
    uint64_t key;
    const ssfr_tiles *tiles;
} ssfr_tile_file;

/* Opens the file of that key in `folder`/truth (NULL: the user's), alone: waits while another process has it. */
SSFR_MUST ssfr_result ssfr_tile_file_open(ssfr_tile_file *out, const ssfr_tiles *tiles, uint64_t key,
                                            const char *folder, bool anew);
void ssfr_tile_file_close(ssfr_tile_file *file);

/* True when the tile is there, whole: then values, n_values of each of its pixels, and tally are filled. */
bool ssfr_tile_file_read(const ssfr_tile_file *file, int tile, double *values, ssfr_truth_tally *tally);
/* From any thread. */
SSFR_MUST ssfr_result ssfr_tile_file_write(const ssfr_tile_file *file, int tile, const double *values,
                                             const ssfr_truth_tally *tally);

#endif

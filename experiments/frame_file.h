/* SPDX-License-Identifier: GPL-3.0-or-later */
/* frame_file.h: writing a frame: the picture, an EXR with its depth and normals, a folder with everything. */
#ifndef SSFR_FRAME_FILE_H
#define SSFR_FRAME_FILE_H

#include "experiments/record.h"

/* Whether the pipeline writes it; of thickness also whether it does in layers, which then are wanted and added up. */
bool ssfr_frame_has(const ssfr_graph *graph, const char *slot);
SSFR_MUST ssfr_result ssfr_frame_want_slot(ssfr_graph *graph, const char *slot);

/* A slot of the last frame as a new field of w x h px. One that was left out, and so is one neutral pixel, is repeated:
 * it compares with any other. */
SSFR_MUST ssfr_result ssfr_frame_read(ssfr_field **out, const ssfr_graph *graph, const char *slot, int w, int h);

/* Wants what an EXR of a frame holds beside the result: depth, normal, thickness, where the pipeline has them. */
SSFR_MUST ssfr_result ssfr_frame_want(const ssfr_setup *setup);

/* R,G,B, Z, N.X,N.Y,N.Z, T, w x h px, with the record in the header. */
SSFR_MUST ssfr_result ssfr_frame_save_exr(const char *path, const ssfr_setup *setup, int w, int h,
                                          const ssfr_record *record);
SSFR_MUST ssfr_result ssfr_frame_save_png(const char *path, const ssfr_setup *setup, int w, int h);

/* Every slot as DIR/<slot>.exr, and DIR/graph.json: what ran, what was left out and why, ms, bytes. */
SSFR_MUST ssfr_result ssfr_frame_dump(const char *folder, const ssfr_setup *setup, int w, int h,
                                      const ssfr_record *record);

/* "ran", "off", .. */
const char *ssfr_status_text(ssfr_node_status status);

/* One SSFR_INFO line a node. */
void ssfr_frame_say(const ssfr_graph *graph);

#endif

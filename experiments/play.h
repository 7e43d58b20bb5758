/* SPDX-License-Identifier: GPL-3.0-or-later */
/* play.h: playing the frames before the one that is drawn, for nodes that keep something from frame to frame. */
#ifndef SSFR_PLAY_H
#define SSFR_PLAY_H

#include "experiments/stage.h"

/* The row --play of a command that draws, for its value in an ssfr_stage_options. */
extern const ssfr_option ssfr_play_rows[];
#define SSFR_PLAY_SET(options) {"history", ssfr_play_rows, (options)}

/* Whether --play says what it should. */
SSFR_MUST ssfr_result ssfr_play_check(const ssfr_stage_options *options);

/* Plays what the graph should have seen before it draws the frame that the stage shows: nothing where no node of it
 * keeps anything, where the scene's frames have no time, or where it has run for this frame already. since: the frame
 * of this stage that it drew last, whose history goes on where it is not too long ago; -1: none, it begins anew. */
SSFR_MUST ssfr_result ssfr_play(ssfr_graph *graph, const ssfr_stage *stage, const ssfr_stage_options *options,
                                long since);

#endif

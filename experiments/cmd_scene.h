/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_scene.h: the parts of `ssfr scene` that have a file of their own; argv[0] is "scene info" and so on. */
#ifndef SSFR_CMD_SCENE_H
#define SSFR_CMD_SCENE_H

#include "experiments/command.h"

SSFR_MUST ssfr_result ssfr_scene_info(int argc, char **argv);
SSFR_MUST ssfr_result ssfr_scene_import(int argc, char **argv);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* channels.h: comma-separated lists of EXR channel names. */
#ifndef SSFR_CHANNELS_H
#define SSFR_CHANNELS_H

#include "base/base.h"

/* Every name of `names` is in `list`. */
bool ssfr_channels_include(const char *list, const char *names);

#endif

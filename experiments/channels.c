/* SPDX-License-Identifier: GPL-3.0-or-later */
/* channels.c: comma-separated lists of EXR channel names. */
#include "experiments/channels.h"

/* The entry after the one at `at`, NULL after the last. */
static const char *next(const char *at)
{
    const char *comma = strchr(at, ',');
    return comma ? comma + 1 : NULL;
}

static bool has(const char *list, const char *name, size_t length)
{
    bool found = false;
    for (const char *at = list; at && !found; at = next(at))
        found = strcspn(at, ",") == length && memcmp(at, name, length) == 0;
    return found;
}

bool ssfr_channels_include(const char *list, const char *names)
{
    bool all = true;
    for (const char *at = names; at && all; at = next(at)) all = has(list, at, strcspn(at, ","));
    return all;
}

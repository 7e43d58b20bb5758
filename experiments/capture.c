/* SPDX-License-Identifier: GPL-3.0-or-later */
/* capture.c: a log that keeps the first error. */
#include "experiments/capture.h"
#include "experiments/console.h"

static const char *console;
static char first[SSFR_CAPTURE_SIZE];

static void keep(void *user, ssfr_level level, const char *where, const char *text)
{
    (void)user, (void)where;
    if (level == SSFR_ERROR) {
        if (!first[0]) snprintf(first, sizeof first, "%s", text);
        return;
    }
    ssfr_console_open(console);
    ssfr_log(level, "%s", text);
    ssfr_log_to(keep, NULL);
}

void ssfr_capture_begin(const char *command)
{
    console = command;
    first[0] = '\0';
    ssfr_log_to(keep, NULL);
}

void ssfr_capture_end(char error[SSFR_CAPTURE_SIZE])
{
    ssfr_console_open(console);
    memcpy(error, first, sizeof first);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* capture.h: keeping the error of a run that may fail, which then is a result and not a message. */
#ifndef SSFR_CAPTURE_H
#define SSFR_CAPTURE_H

#include "base/base.h"

enum { SSFR_CAPTURE_SIZE = 512 };

/* From here on errors are kept; the rest of the log goes to the console of the command. */
void ssfr_capture_begin(const char *command);
/* Sends all of the log to the console again. The first error since begin, "" when there was none. */
void ssfr_capture_end(char error[SSFR_CAPTURE_SIZE]);

#endif

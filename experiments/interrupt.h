/* SPDX-License-Identifier: GPL-3.0-or-later */
/* interrupt.h: SIGINT and SIGTERM during long work that has something to finish. */
#ifndef SSFR_INTERRUPT_H
#define SSFR_INTERRUPT_H

#include <stdbool.h>

/* From here on the first signal is only noted; the second ends the process. One that was ignored stays ignored. Such
 * work may be part of such work. */
void ssfr_interrupt_begin(void);
/* What a signal did before. */
void ssfr_interrupt_end(void);

/* A signal came since the outermost begin, whose end was not yet. */
bool ssfr_interrupt_came(void);

#endif

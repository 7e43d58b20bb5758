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

/* How to go on with what `ssfr reproduce` began, for the end of a message: with --anew the same words would begin
 * again. */
const char *ssfr_interrupt_advice(bool anew);

/* A signal came since the outermost begin, whose end was not yet. */
bool ssfr_interrupt_came(void);

#endif

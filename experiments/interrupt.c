/* SPDX-License-Identifier: GPL-3.0-or-later */
/* interrupt.c: noting the first signal. */
#include "experiments/interrupt.h"

#include <signal.h>
#include <stddef.h>

static volatile sig_atomic_t came;
static int depth;
static struct sigaction before_int, before_term;

static void note(int number)
{
    (void)number;
    came = 1;
}

void ssfr_interrupt_begin(void)
{
    struct sigaction action = {.sa_handler = note, .sa_flags = (int)(SA_RESETHAND | SA_RESTART)};
    if (depth++ > 0) return;
    sigemptyset(&action.sa_mask);
    came = 0;
    sigaction(SIGINT, &action, &before_int);
    sigaction(SIGTERM, &action, &before_term);
}

void ssfr_interrupt_end(void)
{
    if (--depth > 0) return;
    sigaction(SIGINT, &before_int, NULL);
    sigaction(SIGTERM, &before_term, NULL);
}

bool ssfr_interrupt_came(void)
{
    return depth > 0 && came;
}

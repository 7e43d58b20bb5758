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

/* What is ignored stays so: under nohup, and in the background of a script, it is meant for others. */
static void listen_to(int number, struct sigaction *before)
{
    struct sigaction action = {.sa_handler = note, .sa_flags = (int)(SA_RESETHAND | SA_RESTART)};
    sigemptyset(&action.sa_mask);
    sigaction(number, NULL, before);
    if ((before->sa_flags & SA_SIGINFO) || before->sa_handler != SIG_IGN) sigaction(number, &action, NULL);
}

void ssfr_interrupt_begin(void)
{
    if (depth++ > 0) return;
    came = 0;
    listen_to(SIGINT, &before_int);
    listen_to(SIGTERM, &before_term);
}

void ssfr_interrupt_end(void)
{
    if (--depth > 0) return;
    sigaction(SIGINT, &before_int, NULL);
    sigaction(SIGTERM, &before_term, NULL);
}

const char *ssfr_interrupt_advice(bool anew)
{
    return anew ? "the same command without --anew goes on from there" : "the same command goes on from there";
}

bool ssfr_interrupt_came(void)
{
    return depth > 0 && came;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* command.h: what a command of `ssfr` is; the one list of them is commands.def. */
#ifndef SSFR_COMMAND_H
#define SSFR_COMMAND_H

#include "base/base.h"

/* Exit status of the program. */
enum {
    SSFR_EXIT_OK = 0,
    SSFR_EXIT_FAILED = 1, /* a comparison or check did not hold */
    SSFR_EXIT_BAD = 2,    /* bad usage or bad input: every ssfr_result but SSFR_OK */
};

typedef struct ssfr_command {
    const char *name, *help;
    int (*run)(int argc, char **argv); /* argv[0] is the command's name; gives the exit status */
} ssfr_command;

#define X(name, help) int ssfr_cmd_##name(int argc, char **argv);
#include "experiments/commands.def"
#undef X

enum {
#define X(name, help) SSFR_COMMAND_##name,
#include "experiments/commands.def"
#undef X
    SSFR_N_COMMANDS
};

extern const ssfr_command ssfr_commands[SSFR_N_COMMANDS];
const ssfr_command *ssfr_command_find(const char *name); /* NULL when there is none */

static inline int ssfr_exit_status(ssfr_result result)
{
    return result == SSFR_OK ? SSFR_EXIT_OK : SSFR_EXIT_BAD;
}

#endif

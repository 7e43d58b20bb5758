/* SPDX-License-Identifier: GPL-3.0-or-later */
/* commands.c: the commands by name. */
#include "experiments/command.h"

const ssfr_command ssfr_commands[SSFR_N_COMMANDS] = {
#define X(name, help) {#name, help, ssfr_cmd_##name},
#include "experiments/commands.def"
#undef X
};

const ssfr_command *ssfr_command_find(const char *name)
{
    const ssfr_command *found = NULL;
    for (size_t i = 0; i < SSFR_N_COMMANDS && !found; i++)
        if (strcmp(ssfr_commands[i].name, name) == 0) found = &ssfr_commands[i];
    return found;
}

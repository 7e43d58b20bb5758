/* SPDX-License-Identifier: GPL-3.0-or-later */
/* main.c: finds the command and runs it. */
#include "experiments/command.h"
#include "experiments/console.h"

static void print_help(FILE *file)
{
    fprintf(file, "usage: ssfr COMMAND [options]\n\nScreen-space fluid rendering, and what each of its approximations "
                  "costs in milliseconds and in error.\n\n");
    for (size_t i = 0; i < SSFR_N_COMMANDS; i++)
        fprintf(file, "  %-12s%s\n", ssfr_commands[i].name, ssfr_commands[i].help);
    fprintf(file, "\n'ssfr COMMAND --help', or 'ssfr help COMMAND', lists a command's options.\n"
                  "Exit status: 0, 1 (a comparison or check failed), 2 (bad usage or bad input).\n");
}

/* What was printed must have arrived: a full disk behind stdout is a failure too. */
static int close_stdout(int status)
{
    const bool failed = ferror(stdout) != 0;
    if (fclose(stdout) == 0 && !failed) return status;
    return ssfr_exit_status(ssfr_fail(SSFR_ERR_IO, "cannot write to standard output"));
}

static int fail_unknown(const char *word)
{
    return ssfr_exit_status(ssfr_fail(SSFR_ERR_UNKNOWN, "unknown command %s (ssfr --help lists them)", word));
}

/* "ssfr help COMMAND" is "ssfr COMMAND --help". */
static int help_of(char *word)
{
    char option[] = "--help", *argv[] = {word, option, NULL};
    const ssfr_command *command = ssfr_command_find(word);
    return command ? close_stdout(command->run(2, argv)) : fail_unknown(word);
}

int main(int argc, char **argv)
{
    const char *word = argc > 1 ? argv[1] : "";
    const ssfr_command *command = ssfr_command_find(word);
    ssfr_console_open(command ? command->name : NULL);
    if (command) return close_stdout(command->run(argc - 1, argv + 1));
    if (strcmp(word, "help") == 0 && argc > 2) return help_of(argv[2]);
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0 || strcmp(word, "help") == 0) {
        print_help(stdout);
        return close_stdout(SSFR_EXIT_OK);
    }
    if (strcmp(word, "--version") == 0) {
        printf("ssfr %s\n", ssfr_version());
        return close_stdout(SSFR_EXIT_OK);
    }
    if (argc > 1) return fail_unknown(word);
    print_help(stderr);
    return SSFR_EXIT_BAD;
}

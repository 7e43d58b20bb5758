/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options.h: the command line as rows: one row an option serves parsing, range checks and --help. */
#ifndef SSFR_OPTIONS_H
#define SSFR_OPTIONS_H

#include "base/base.h"

/* The C type behind a row's offset. A value that is not given leaves the struct as it was: its defaults. */
typedef enum ssfr_option_kind {
    SSFR_OPTION_FLAG,    /* bool; takes no value */
    SSFR_OPTION_TEXT,    /* const char * */
    SSFR_OPTION_NUMBER,  /* double, finite */
    SSFR_OPTION_INTEGER, /* long */
    SSFR_OPTION_VECTOR,  /* double[3], written X,Y,Z */
    SSFR_OPTION_SIZE,    /* int[2], px, written WxH, each in [1, SSFR_MAX_SIZE] */
    SSFR_OPTION_WORD,    /* int, the index of a word of the row's `value`: "gl|cpu" */
    SSFR_OPTION_LIST,    /* ssfr_list; each repetition adds an entry */
} ssfr_option_kind;

enum { SSFR_MAX_LIST = 256 };

typedef struct ssfr_list { /* strings of argv, not owned */
    int n;
    const char *items[SSFR_MAX_LIST];
} ssfr_list;

/* A list of rows ends with a NULL name: SSFR_OPTION_END. */
typedef struct ssfr_option {
    const char *name; /* without the dashes */
    char letter;      /* its short form, 0 for none */
    ssfr_option_kind kind;
    const char *value; /* what stands for the value in --help, NULL for a flag */
    const char *help;
    size_t offset;
    double min, max; /* of numbers, closed; both 0: any */
} ssfr_option;

/* A row for the member of a struct; the range as two numbers, 0, 0 for any. */
#define SSFR_OPTION(type, member, name, letter, kind, value, help, min, max) \
    {name, letter, SSFR_OPTION_##kind, value, help, offsetof(type, member), min, max}
#define SSFR_OPTION_END {NULL, 0, SSFR_OPTION_FLAG, NULL, NULL, 0, 0, 0}

typedef struct ssfr_option_set { /* rows and the struct that they fill; a list ends with NULL rows */
    const char *title; /* its heading in --help */
    const ssfr_option *rows;
    void *values;
} ssfr_option_set;

typedef struct ssfr_usage {
    const char *command;   /* "render" */
    const char *arguments; /* "SCENE", as the usage line shows them */
    const char *help;      /* what the command does: the line of commands.def, or more */
    int min_arguments, max_arguments;
    const ssfr_option_set *sets; /* NULL for a command without options of its own */
} ssfr_usage;

/* What every command has. */
typedef struct ssfr_command_line {
    ssfr_list arguments; /* what is no option, in order */
    long threads;        /* 0: as many as there are cores */
    long seed;           /* of everything that draws random numbers; 1 unless given */
    bool quiet, verbose;
    bool help; /* --help was asked for and is printed: leave with status 0 */
} ssfr_command_line;

/* Reads argv[1..]; argv[0] is the command's own name. Options stand before, between and after the arguments, as
 * --name value, --name=value, -o value or -ovalue; "--" ends them. --threads, -q and --verbose are put into effect: for
 * the whole process, so that a command that calls another one must take back what that was told. */
SSFR_MUST ssfr_result ssfr_options_parse(ssfr_command_line *out, const ssfr_usage *usage, int argc, char **argv);

typedef struct ssfr_manner { /* what these have set */
    int threads;
    char rasteriser[24]; /* its number of threads, which the environment holds; "" when it does not */
    ssfr_level level;
} ssfr_manner;

ssfr_manner ssfr_options_manner(void);
void ssfr_options_resume(const ssfr_manner *manner);

/* The text of --help. */
void ssfr_options_print(FILE *file, const ssfr_usage *usage);

/* The k-th word of a row's "gl|cpu", copied to text[size]; false past the end. */
bool ssfr_option_word(const ssfr_option *row, int k, char *text, size_t size);

#endif

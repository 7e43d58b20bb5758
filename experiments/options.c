/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options.c: parsing a command line by rows, and printing the rows as --help. */
#include "experiments/options.h"
#include "experiments/console.h"

#include <ctype.h>
#include <errno.h>
#include <omp.h>

enum { HELP_WIDTH = 100, HELP_COLUMN = 28 }; /* characters */

#define ROW(...) SSFR_OPTION(ssfr_command_line, __VA_ARGS__)
static const ssfr_option common_rows[] = {
    ROW(threads, "threads", 0, INTEGER, "N", "threads to use (default: one a core)", 1, 1024),
    ROW(seed, "seed", 0, INTEGER, "N", "seed of all random numbers (default 1)", 0, 2147483647),
    ROW(quiet, "quiet", 'q', FLAG, NULL, "say errors only", 0, 0),
    ROW(verbose, "verbose", 0, FLAG, NULL, "say what is done, pass by pass", 0, 0),
    ROW(help, "help", 'h', FLAG, NULL, "print this and leave", 0, 0),
    SSFR_OPTION_END,
};

bool ssfr_option_word(const ssfr_option *row, int k, char *text, size_t size)
{
    const char *at = row->value;
    for (int i = 0; i < k && at; i++) {
        at = strchr(at, '|');
        if (at) at++;
    }
    if (at) snprintf(text, size, "%.*s", (int)strcspn(at, "|"), at);
    return at != NULL;
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

static ssfr_result check_range(const ssfr_option *row, const char *option, const char *text, double value)
{
    const bool any = row->min == 0 && row->max == 0;
    if (any || (value >= row->min && value <= row->max)) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_VALUE, "%s %s: out of range [%.10g, %.10g]", option, text, row->min, row->max);
}

static ssfr_result parse_number(const ssfr_option *row, const char *option, const char *text, double *out)
{
    double value;
    if (!ssfr_parse_number(text, &value))
        return ssfr_fail(SSFR_ERR_VALUE, "%s %s: expected a finite number", option, text);
    *out = value;
    return check_range(row, option, text, value);
}

static ssfr_result parse_integer(const ssfr_option *row, const char *option, const char *text, long *out)
{
    char *end = NULL;
    errno = 0;
    const long value = strtol(text, &end, 10);
    if (end == text || *end || errno)
        return ssfr_fail(SSFR_ERR_VALUE, "%s %s: expected a whole number", option, text);
    *out = value;
    return check_range(row, option, text, (double)value);
}

/* The number between *at and the next `until` (or the end), after which *at stands; NULL after the last. */
static bool next_number(const char **at, char until, double *out)
{
    char item[64];
    const size_t length = *at ? strcspn(*at, (const char[]){until, '\0'}) : sizeof item;
    if (length >= sizeof item) return false;
    snprintf(item, sizeof item, "%.*s", (int)length, *at);
    *at = (*at)[length] ? *at + length + 1 : NULL;
    return ssfr_parse_number(item, out);
}

static ssfr_result parse_vector(const char *option, const char *text, double out[3])
{
    const char *at = text;
    double v[3];
    for (int k = 0; k < 3; k++)
        if (!next_number(&at, ',', &v[k]))
            return ssfr_fail(SSFR_ERR_VALUE, "%s %s: expected three numbers X,Y,Z", option, text);
    if (at) return ssfr_fail(SSFR_ERR_VALUE, "%s %s: more than three numbers", option, text);
    memcpy(out, v, sizeof v);
    return SSFR_OK;
}

static ssfr_result parse_size(const char *option, const char *text, int out[2])
{
    const char *at = text;
    double v[2];
    for (int k = 0; k < 2; k++)
        if (!next_number(&at, 'x', &v[k]) || v[k] != floor(v[k]))
            return ssfr_fail(SSFR_ERR_VALUE, "%s %s: expected a size in pixels, such as 1280x720", option, text);
    if (at) return ssfr_fail(SSFR_ERR_VALUE, "%s %s: expected a size in pixels, such as 1280x720", option, text);
    for (int k = 0; k < 2; k++)
        if (v[k] < 1 || v[k] > SSFR_MAX_SIZE)
            return ssfr_fail(SSFR_ERR_VALUE, "%s %s: sides go from 1 to %d pixels", option, text, SSFR_MAX_SIZE);
    for (int k = 0; k < 2; k++) out[k] = (int)v[k];
    return SSFR_OK;
}

static ssfr_result parse_word(const ssfr_option *row, const char *option, const char *text, int *out)
{
    char word[64];
    for (int k = 0; ssfr_option_word(row, k, word, sizeof word); k++)
        if (strcmp(word, text) == 0) {
            *out = k;
            return SSFR_OK;
        }
    return ssfr_fail(SSFR_ERR_VALUE, "%s %s: expected %s", option, text, row->value);
}

static ssfr_result append(const char *option, const char *text, ssfr_list *list)
{
    if (list->n == SSFR_MAX_LIST)
        return ssfr_fail(SSFR_ERR_VALUE, "%s %s: more than %d of them", option, text, SSFR_MAX_LIST);
    list->items[list->n++] = text;
    return SSFR_OK;
}

static ssfr_result store(const ssfr_option *row, void *values, const char *option, const char *text)
{
    void *at = (char *)values + row->offset;
    switch (row->kind) {
    case SSFR_OPTION_FLAG: *(bool *)at = true; return SSFR_OK;
    case SSFR_OPTION_TEXT: *(const char **)at = text; return SSFR_OK;
    case SSFR_OPTION_NUMBER: return parse_number(row, option, text, at);
    case SSFR_OPTION_INTEGER: return parse_integer(row, option, text, at);
    case SSFR_OPTION_VECTOR: return parse_vector(option, text, at);
    case SSFR_OPTION_SIZE: return parse_size(option, text, at);
    case SSFR_OPTION_WORD: return parse_word(row, option, text, at);
    default: return append(option, text, at);
    }
}

/* ---- finding rows ------------------------------------------------------------------------------------------------ */

static const ssfr_option *find_in(const ssfr_option *rows, const char *name, size_t length, char letter)
{
    const ssfr_option *found = NULL;
    for (const ssfr_option *row = rows; row->name && !found; row++)
        if (name ? strlen(row->name) == length && memcmp(row->name, name, length) == 0 : row->letter == letter)
            found = row;
    return found;
}

/* By name, or by letter where name is NULL. */
static const ssfr_option *find(const ssfr_usage *usage, ssfr_command_line *line, const char *name, size_t length,
                               char letter, void **values)
{
    const ssfr_option *row = NULL;
    for (const ssfr_option_set *set = usage->sets; set && set->rows && !row; set++) {
        row = find_in(set->rows, name, length, letter);
        *values = set->values;
    }
    if (row) return row;
    *values = line;
    return find_in(common_rows, name, length, letter);
}

/* ---- parsing ----------------------------------------------------------------------------------------------------- */

typedef struct parser {
    const ssfr_usage *usage;
    ssfr_command_line *line;
    int argc, at;
    char **argv;
} parser;

/* Stores the value that stands in the same word, or else is the next word. */
static ssfr_result take_value(parser *p, const ssfr_option *row, void *values, const char *option, const char *value)
{
    if (row->kind == SSFR_OPTION_FLAG && value)
        return ssfr_fail(SSFR_ERR_VALUE, "%s takes no value, got %s", option, value);
    if (row->kind != SSFR_OPTION_FLAG && !value) {
        if (p->at + 1 >= p->argc) return ssfr_fail(SSFR_ERR_VALUE, "%s needs a value: %s", option, row->value);
        value = p->argv[++p->at];
    }
    return store(row, values, option, value);
}

static ssfr_result parse_long(parser *p, const char *word)
{
    char option[64];
    void *values = NULL;
    const size_t length = strcspn(word + 2, "=");
    const char *value = word[2 + length] ? word + 2 + length + 1 : NULL;
    const ssfr_option *row = find(p->usage, p->line, word + 2, length, 0, &values);
    if (!row)
        return ssfr_fail(SSFR_ERR_UNKNOWN, "unknown option %s (ssfr %s --help lists them)", word, p->usage->command);
    snprintf(option, sizeof option, "--%s", row->name);
    return take_value(p, row, values, option, value);
}

static ssfr_result parse_short(parser *p, const char *word)
{
    const char option[] = {'-', word[1], '\0'};
    void *values = NULL;
    const ssfr_option *row = find(p->usage, p->line, NULL, 0, word[1], &values);
    if (!row)
        return ssfr_fail(SSFR_ERR_UNKNOWN, "unknown option %s (ssfr %s --help lists them)", word, p->usage->command);
    return take_value(p, row, values, option, word[2] ? word + 2 : NULL);
}

static ssfr_result parse_words(parser *p)
{
    ssfr_result result = SSFR_OK;
    bool options_end = false;
    for (p->at = 1; p->at < p->argc && result == SSFR_OK; p->at++) {
        const char *word = p->argv[p->at];
        if (options_end || word[0] != '-' || !word[1])
            result = append("argument", word, &p->line->arguments);
        else if (strcmp(word, "--") == 0)
            options_end = true;
        else
            result = word[1] == '-' ? parse_long(p, word) : parse_short(p, word);
    }
    return result;
}

static ssfr_result check_arguments(const ssfr_usage *usage, const ssfr_list *arguments)
{
    if (arguments->n < usage->min_arguments)
        return ssfr_fail(SSFR_ERR_VALUE, "too few arguments: usage: ssfr %s %s", usage->command, usage->arguments);
    if (arguments->n > usage->max_arguments)
        return ssfr_fail(SSFR_ERR_VALUE, "one argument too many: %s (usage: ssfr %s %s)",
                         arguments->items[usage->max_arguments], usage->command, usage->arguments);
    return SSFR_OK;
}

static const char rasteriser[] = "LP_NUM_THREADS"; /* Mesa's in software reads it when a context is made */

/* What is not said stays: as it was at first, or as it is in the command that calls this one. */
static void apply(const ssfr_command_line *line)
{
    char text[24];
    if (line->quiet || line->verbose) ssfr_console_level(line->quiet ? SSFR_ERROR : SSFR_INFO);
    if (line->threads == 0) return;
    snprintf(text, sizeof text, "%ld", line->threads);
    omp_set_num_threads((int)line->threads);
    setenv(rasteriser, text, 1);
}

ssfr_manner ssfr_options_manner(void)
{
    const char *text = getenv(rasteriser);
    ssfr_manner manner = {.threads = omp_get_max_threads(), .level = ssfr_console_shown()};
    snprintf(manner.rasteriser, sizeof manner.rasteriser, "%s", text ? text : "");
    return manner;
}

void ssfr_options_resume(const ssfr_manner *manner)
{
    omp_set_num_threads(manner->threads);
    ssfr_console_level(manner->level);
    if (manner->rasteriser[0])
        setenv(rasteriser, manner->rasteriser, 1);
    else
        unsetenv(rasteriser);
}

ssfr_result ssfr_options_parse(ssfr_command_line *out, const ssfr_usage *usage, int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    parser p = {.usage = usage, .line = out, .argc = argc, .argv = argv};
    *out = (ssfr_command_line){.seed = 1};
    SSFR_TRY(parse_words(&p));
    if (out->help)
        ssfr_options_print(stdout, usage);
    else
        SSFR_TRY(check_arguments(usage, &out->arguments));
    apply(out);
end:
    return result;
}

/* ---- help -------------------------------------------------------------------------------------------------------- */

/* Text from `column` on, broken between words before HELP_WIDTH; further lines are indented by `indent`. */
static void print_wrapped(FILE *file, const char *text, int column, int indent)
{
    while (*text) {
        const size_t length = strcspn(text, " ");
        if (column > indent && column + 1 + (int)length > HELP_WIDTH) {
            fprintf(file, "\n%*s", indent, "");
            column = indent;
        } else if (column > indent) {
            fputc(' ', file);
            column++;
        }
        fwrite(text, 1, length, file);
        column += (int)length;
        text += length + strspn(text + length, " ");
    }
    fputc('\n', file);
}

static void print_row(FILE *file, const ssfr_option *row)
{
    char head[128];
    const char letter[] = {'-', row->letter, ',', ' ', '\0'};
    const int length = snprintf(head, sizeof head, "  %s--%s%s%s", row->letter ? letter : "", row->name,
                                row->value ? " " : "", row->value ? row->value : "");
    fputs(head, file);
    if (length + 2 > HELP_COLUMN)
        fprintf(file, "\n%*s", HELP_COLUMN, "");
    else
        fprintf(file, "%*s", HELP_COLUMN - length, "");
    print_wrapped(file, row->help, HELP_COLUMN, HELP_COLUMN);
}

static void print_set(FILE *file, const char *title, const ssfr_option *rows)
{
    fprintf(file, "\n%s:\n", title);
    for (const ssfr_option *row = rows; row->name; row++) print_row(file, row);
}

void ssfr_options_print(FILE *file, const ssfr_usage *usage)
{
    const bool some = usage->arguments && usage->arguments[0];
    fprintf(file, "usage: ssfr %s%s%s [options]\n\n", usage->command, some ? " " : "", some ? usage->arguments : "");
    print_wrapped(file, usage->help, 0, 0);
    for (const ssfr_option_set *set = usage->sets; set && set->rows; set++) print_set(file, set->title, set->rows);
    print_set(file, "all commands", common_rows);
}

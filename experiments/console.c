/* SPDX-License-Identifier: GPL-3.0-or-later */
/* console.c: the log on stderr, a progress bar, tables on stdout. */
#include "experiments/console.h"

#include <stdarg.h>
#include <unistd.h>

enum { BAR_CELLS = 30 /* characters */, MOST_WORKS = 4 };
static const double bar_period = 0.1; /* s between two drawings */

static ssfr_level shown = SSFR_WARNING;
static bool bar_drawn;

/* A log line must not be written into the middle of the bar. */
static void remove_bar(void)
{
    if (bar_drawn) fputs("\r\033[K", stderr);
    bar_drawn = false;
}

static void print_line(void *user, ssfr_level level, const char *where, const char *text)
{
    const char *command = user;
    (void)where;
    if (level > shown) return;
    remove_bar();
    fprintf(stderr, "ssfr%s%s: %s%s\n", command ? " " : "", command ? command : "",
            level == SSFR_WARNING ? "warning: " : "", text);
}

void ssfr_console_open(const char *command)
{
    union { const char *text; void *user; } name = {.text = command};
    ssfr_log_to(print_line, name.user);
}

void ssfr_console_level(ssfr_level level)
{
    shown = level;
}

ssfr_level ssfr_console_shown(void)
{
    return shown;
}

double ssfr_console_begun(const char *what, size_t done, size_t total, double now)
{
    static struct {
        char what[64];
        double begun;
    } works[MOST_WORKS]; /* each part of the one before */
    static int n;
    int i = 0;
    while (i < n && strncmp(works[i].what, what, sizeof works[i].what - 1) != 0) i++;
    if (i == n) {
        i = ssfr_min_int(n, MOST_WORKS - 1);
        snprintf(works[i].what, sizeof works[i].what, "%s", what);
        works[i].begun = now;
    }
    n = done < total ? i + 1 : i; /* what is told of has no part that still goes on */
    return works[i].begun;
}

void ssfr_console_progress(const char *what, size_t done, size_t total)
{
    static double drawn;
    const double now = ssfr_clock();
    if (shown < SSFR_WARNING || !isatty(STDERR_FILENO)) return;
    const double begun = ssfr_console_begun(what, done, total, now);
    if (done >= total) {
        remove_bar();
    } else if (now - drawn >= bar_period) {
        const int filled = (int)((double)BAR_CELLS * (double)done / (double)total);
        const double left = done ? (now - begun) / (double)done * (double)(total - done) : NAN;
        drawn = now;
        fprintf(stderr, "\r\033[K%s [%.*s%*s] %zu/%zu", what, filled, "##############################",
                BAR_CELLS - filled, "", done, total);
        if (isfinite(left)) fprintf(stderr, ", %d:%02d left", (int)left / 60, (int)left % 60);
        bar_drawn = true;
    }
}

/* ---- tables ------------------------------------------------------------------------------------------------------ */

void ssfr_table_init(ssfr_table *table, int n_columns)
{
    *table = (ssfr_table){.n_columns = n_columns};
}

static ssfr_result grow(ssfr_table *table)
{
    const size_t capacity = table->capacity ? 2 * table->capacity : 64;
    char **cells = realloc(table->cells, capacity * sizeof *cells);
    if (!cells) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for a table of %zu cells", capacity);
    table->cells = cells;
    table->capacity = capacity;
    return SSFR_OK;
}

ssfr_result ssfr_table_add(ssfr_table *table, const char *format, ...)
{
    ssfr_result result = SSFR_OK;
    va_list args;
    if (table->n_cells == table->capacity) SSFR_TRY(grow(table));
    va_start(args, format);
    result = ssfr_text_print_va(&table->cells[table->n_cells], "a table's cell", format, args);
    va_end(args);
    if (result == SSFR_OK) table->n_cells++;
end:
    return result;
}

ssfr_result ssfr_table_row(ssfr_table *table, const char *const *texts)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < table->n_columns && result == SSFR_OK; i++) result = ssfr_table_add(table, "%s", texts[i]);
    return result;
}

static int column_width(const ssfr_table *table, size_t column)
{
    size_t width = 0;
    for (size_t i = column; i < table->n_cells; i += (size_t)table->n_columns) {
        const size_t length = strlen(table->cells[i]);
        if (length > width) width = length;
    }
    return (int)width;
}

void ssfr_table_print(const ssfr_table *table, FILE *file)
{
    const bool aligned = isatty(fileno(file));
    for (size_t i = 0; i < table->n_cells; i++) {
        const size_t column = i % (size_t)table->n_columns;
        const bool last = column + 1 == (size_t)table->n_columns;
        const int width = aligned && !last ? column_width(table, column) : 0;
        fprintf(file, "%-*s%s", width, table->cells[i], last ? "\n" : aligned ? "  " : "\t");
    }
}

void ssfr_table_finish(ssfr_table *table)
{
    for (size_t i = 0; i < table->n_cells; i++) free(table->cells[i]);
    free(table->cells);
    *table = (ssfr_table){0};
}

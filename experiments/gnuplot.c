/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gnuplot.c: starting gnuplot on a script, and writing the parts that scripts share. */
#include "experiments/gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* ---- parts of scripts -------------------------------------------------------------------------------------------- */

void ssfr_gnuplot_begin(FILE *script, int w, int h, const char *output)
{
    fprintf(script, "set terminal svg size %d,%d dynamic noenhanced font 'sans-serif,15' background 'white'\n", w, h);
    fputs("set output ", script);
    ssfr_gnuplot_text(script, output);
    fputs("\nset grid lt 1 lw 0.5 lc rgb '#dddddd'\nset tics nomirror\n", script);
}

static void put_string(FILE *script, const char *begin, const char *end)
{
    fputc('\'', script);
    for (const char *at = begin; at < end; at++)
        if (*at == '\'')
            fputs("''", script);
        else
            fputc((unsigned char)*at < 0x20 ? ' ' : *at, script);
    fputc('\'', script);
}

void ssfr_gnuplot_text(FILE *script, const char *text)
{
    put_string(script, text, text + strlen(text));
}

/* Widths of letters are known to the viewer alone: what most texts in sans-serif fonts need, as a share of the size. */
static const double letter = 0.56;

static int width_of(size_t letters, int font)
{
    return (int)ceil(letter * font * (double)letters);
}

/* The next place where a line may end: a space that is not within a unit, "[particle radii]", or the end. */
static const char *word_end(const char *text)
{
    bool unit = false;
    for (; *text && (unit || *text != ' '); text++) unit = *text == '[' || (unit && *text != ']');
    return text;
}

/* Where the line that begins at `text` ends: at the last such place before it is too long, or at the first. */
static const char *line_end(const char *text, int width, int font)
{
    const char *end = word_end(text);
    for (const char *next = end; *next;) {
        next = word_end(next + 1);
        if (width_of((size_t)(next - text), font) > width) break;
        end = next;
    }
    return end;
}

int ssfr_gnuplot_lines(FILE *script, const char *text, int width, int font)
{
    int n = 0;
    do {
        const char *end = line_end(text, width, font);
        if (script && n > 0) fputs(" . \"\\n\" . ", script);
        if (script) put_string(script, text, end);
        text = *end ? end + 1 : end;
        n++;
    } while (*text);
    return n;
}

enum { KEY_FONT = 13, KEY_LINE = 20, KEY_SAMPLE = 50, KEY_MARGIN = 20 }; /* px */

ssfr_gnuplot_key ssfr_gnuplot_key_fit(size_t n, size_t longest, int width)
{
    static const double key_letter = 9.3; /* px, what gnuplot reserves for a letter in all columns but the last */
    const double pitch = KEY_SAMPLE + key_letter * (double)longest, last = KEY_SAMPLE + width_of(longest, KEY_FONT);
    const size_t columns = last < width ? 1 + (size_t)((width - last) / pitch) : 1;
    const size_t rows = (n + columns - 1) / columns;
    return (ssfr_gnuplot_key){rows, n ? (int)rows * KEY_LINE + KEY_MARGIN : 0};
}

void ssfr_gnuplot_key_put(FILE *script, const ssfr_gnuplot_key *key, double x, double y)
{
    if (key->rows == 0)
        fputs("unset key\n", script);
    else
        fprintf(script,
                "set key at screen %.6f,%.6f left top vertical maxrows %zu Left reverse samplen 2 font ',%d'\n", x, y,
                key->rows, KEY_FONT);
}

void ssfr_gnuplot_log_tics(FILE *script, char name, double lo, double hi)
{
    static const double most_decades = 8; /* that have a number each, side by side */
    static const double steps[] = {1, 2, 5};
    const bool crowded = hi / lo > 2e3 || (name == 'x' && hi >= 1e5 && hi / lo > 50); /* long numbers side by side */
    const size_t n_steps = crowded ? 1 : SSFR_COUNT(steps);
    fprintf(script, "set %ctics ()\n", name);
    if (hi / lo < 10) {
        const double unit = pow(10, floor(log10((hi - lo) / 4))), ratio = (hi - lo) / 4 / unit;
        const double step = unit * (ratio > 5 ? 5 : ratio > 2 ? 2 : 1);
        const double apart = name == 'x' ? 0.11 : 0.05; /* of the axis, which numbers beside each other need */
        double last = 0;
        for (double tic = step * ceil(lo / step); tic <= hi; tic += step) {
            if (last > 0 && log(tic / last) < apart * log(hi / lo)) continue;
            fprintf(script, "set %ctics add (%.9g)\n", name, tic);
            last = tic;
        }
        return;
    }
    const double decades = log10(hi / lo), stride = name == 'x' ? ceil(decades / most_decades) : 1;
    for (double decade = stride * floor(log10(lo) / stride); decade <= ceil(log10(hi)); decade += stride)
        for (size_t i = 0; i < n_steps; i++) {
            const double tic = steps[i] * pow(10, decade);
            if (tic >= lo && tic <= hi) fprintf(script, "set %ctics add ('%.7g' %.9g)\n", name, tic, tic);
        }
}

const char *ssfr_gnuplot_colour(size_t i)
{
    /* Okabe and Ito's */
    static const char *const colours[SSFR_GNUPLOT_COLOURS] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                              "#e69f00", "#56b4e9", "#000000"};
    return colours[i % SSFR_GNUPLOT_COLOURS];
}

int ssfr_gnuplot_sign(size_t i)
{
    static const int signs[] = {7, 5, 9, 11, 13, 4, 8, 10, 12};
    return signs[i % SSFR_COUNT(signs)];
}

/* ---- running ----------------------------------------------------------------------------------------------------- */

/* Runs gnuplot on a script that stands in a file without a name; its own complaints are not shown. */
static int run(FILE *script, int *status)
{
    char *const argv[] = {"gnuplot", "--default-settings", "-", NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int code = posix_spawn_file_actions_init(&actions);
    if (code != 0) return code;
    posix_spawn_file_actions_adddup2(&actions, fileno(script), STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    code = posix_spawnp(&child, argv[0], &actions, NULL, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    while (code == 0 && waitpid(child, status, 0) < 0)
        if (errno != EINTR) code = errno;
    return code;
}

/* SSFR_ERR_UNSUPPORTED, with a warning only, when there is no gnuplot. */
static ssfr_result draw(FILE *script, const char *svg, ssfr_gnuplot_script *put, void *user)
{
    ssfr_result result = SSFR_OK;
    ssfr_aside aside = {0};
    int status = 0;
    SSFR_TRY(ssfr_aside_begin(&aside, svg));
    SSFR_TRY(put(user, script, aside.temporary));
    if (fflush(script) != 0 || fseek(script, 0, SEEK_SET) != 0) {
        result = ssfr_fail(SSFR_ERR_IO, "%s: cannot write the script of the plot: %s", svg, strerror(errno));
        goto end;
    }
    const int code = run(script, &status);
    if (code == ENOENT || (WIFEXITED(status) && WEXITSTATUS(status) == 127)) {
        ssfr_log(SSFR_WARNING, "%s: not drawn, gnuplot is not installed", svg);
        result = SSFR_ERR_UNSUPPORTED;
        goto end;
    }
    if (code != 0)
        result = ssfr_fail(SSFR_ERR_IO, "%s: cannot start gnuplot: %s", svg, strerror(code));
    else if (status != 0 || access(aside.temporary, R_OK) != 0)
        result = ssfr_fail(SSFR_ERR_IO, "%s: gnuplot failed with status %d", svg, WEXITSTATUS(status));
end:
    return ssfr_aside_end(&aside, result);
}

ssfr_result ssfr_gnuplot_draw(const char *svg, ssfr_gnuplot_script *put, void *user)
{
    FILE *script = tmpfile();
    if (!script) return ssfr_fail(SSFR_ERR_IO, "%s: no temporary file: %s", svg, strerror(errno));
    const ssfr_result result = draw(script, svg, put, user);
    fclose(script);
    return result == SSFR_ERR_UNSUPPORTED ? SSFR_OK : result;
}

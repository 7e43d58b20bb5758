/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plot.c: points, fronts and a gnuplot script from the rows of a sweep. */
#include "experiments/plot.h"
#include "experiments/columns.h"
#include "experiments/gnuplot.h"

enum {
    MAX_LINES = 64, NAME_SIZE = 192,
    WIDTH = 1000, FRAME_HEIGHT = 480, /* px, of the drawing and between its x axes */
    ABOVE = 75, BELOW = 80, LEFT = 70, /* px, for the title, for the x axis and before the key */
    LABEL = 15,                        /* px, size of the font */
};
static const char front_name[] = "Pareto front";

/* ---- points ------------------------------------------------------------------------------------------------------ */

static int by_x_then_y(const void *a, const void *b)
{
    const ssfr_point *p = a, *q = b;
    if (p->x != q->x) return p->x < q->x ? -1 : 1;
    if (p->y != q->y) return p->y < q->y ? -1 : 1;
    return p->line < q->line ? -1 : p->line > q->line;
}

void ssfr_plot_front(ssfr_point *points, size_t n)
{
    double best = INFINITY;
    qsort(points, n, sizeof *points, by_x_then_y);
    for (size_t i = 0; i < n; i++) {
        const bool same = i > 0 && points[i].x == points[i - 1].x && points[i].y == points[i - 1].y;
        points[i].front = same ? points[i - 1].front : points[i].y < best;
        best = fmin(best, points[i].y);
    }
}

typedef struct axis {
    int column;
    const ssfr_column *meaning; /* NULL for a column that is no measurement */
    bool log;                   /* decibels and shares are drawn as they are */
    double sign;                /* -1 where more is better: points hold what is to be small */
    double lo, hi;              /* of the points */
    char label[256];
} axis;

typedef struct plot {
    const ssfr_csv_table *table;
    const ssfr_plot_spec *spec;
    axis x, y;
    int lines[SSFR_MAX_LINES], only[SSFR_MAX_ONLY]; /* columns */
    ssfr_point *points;
    size_t n_points, n_left_out;
    char names[MAX_LINES][NAME_SIZE];
    size_t n_names;
} plot;

static ssfr_result find_column(const plot *p, const char *name, int *out)
{
    *out = ssfr_csv_column(p->table, name);
    return *out >= 0 ? SSFR_OK : ssfr_fail(SSFR_ERR_UNKNOWN, "plot: the table has no column %s", name);
}

static ssfr_result init_axis(const plot *p, axis *a, const char *name, const char *label)
{
    ssfr_result result = SSFR_OK;
    *a = (axis){.meaning = ssfr_column_find(name), .sign = 1, .log = true, .lo = INFINITY, .hi = -INFINITY};
    SSFR_TRY(find_column(p, name, &a->column));
    if (a->meaning && a->meaning->better > 0) a->sign = -1, a->log = false;
    if (label)
        snprintf(a->label, sizeof a->label, "%s", label);
    else
        ssfr_column_label(a->meaning, p->table->cells[a->column], a->label, sizeof a->label);
end:
    return result;
}

static double axis_value(const plot *p, const axis *a, size_t row)
{
    const double value = ssfr_csv_cell_number(p->table, row, a->column);
    return isfinite(value) && (value > 0 || !a->log) ? a->sign * value : NAN;
}

/* Several cells of one column: any of them. */
static bool is_chosen(const plot *p, size_t row)
{
    bool chosen = true;
    for (int i = 0; i < p->spec->n_only && chosen; i++) {
        chosen = false;
        for (int k = 0; k < p->spec->n_only; k++)
            chosen |= p->only[k] == p->only[i] &&
                      strcmp(ssfr_csv_cell(p->table, row, p->only[k]), p->spec->only[k].cell) == 0;
    }
    return chosen;
}

/* "splat point, gl" */
static void name_row(const plot *p, size_t row, char name[NAME_SIZE])
{
    size_t used = 0;
    name[0] = '\0';
    for (int i = 0; i < p->spec->n_lines && used < NAME_SIZE; i++) {
        const char *word = ssfr_column_word(p->spec->lines[i]);
        used += (size_t)snprintf(name + used, NAME_SIZE - used, "%s%s%s%s", i ? ", " : "", word, word[0] ? " " : "",
                                 ssfr_csv_cell(p->table, row, p->lines[i]));
    }
}

static ssfr_result find_name(plot *p, size_t row, size_t *out)
{
    char name[NAME_SIZE];
    size_t i = 0;
    name_row(p, row, name);
    while (i < p->n_names && strcmp(p->names[i], name) != 0) i++;
    if (i == MAX_LINES) return ssfr_fail(SSFR_ERR_VALUE, "plot: more than %d lines, the next is %s", MAX_LINES, name);
    if (i == p->n_names) strcpy(p->names[p->n_names++], name);
    *out = i;
    return SSFR_OK;
}

static void widen(axis *a, double value)
{
    a->lo = fmin(a->lo, a->sign * value);
    a->hi = fmax(a->hi, a->sign * value);
}

static ssfr_result collect(plot *p)
{
    ssfr_result result = SSFR_OK;
    const int status = ssfr_csv_column(p->table, "status");
    SSFR_TRY(ssfr_alloc(&p->points, p->table->n_rows, sizeof *p->points, "a plot's points"));
    for (size_t row = 0; row < p->table->n_rows; row++) {
        ssfr_point point = {.x = axis_value(p, &p->x, row), .y = axis_value(p, &p->y, row)};
        const bool ran = status < 0 || strcmp(ssfr_csv_cell(p->table, row, status), "ok") == 0;
        if (!is_chosen(p, row)) continue;
        if (!ran || isnan(point.x) || isnan(point.y)) {
            p->n_left_out++;
            continue;
        }
        SSFR_TRY(find_name(p, row, &point.line));
        p->points[p->n_points++] = point;
        widen(&p->x, point.x);
        widen(&p->y, point.y);
    }
end:
    return result;
}

/* ---- the script -------------------------------------------------------------------------------------------------- */

static void put_axis(FILE *file, char name, const axis *a)
{
    const double factor = pow(fmax(a->hi / a->lo, 1.5), 0.06);
    const double margin = a->hi > a->lo ? 0.06 * (a->hi - a->lo) : fmax(0.05 * fabs(a->hi), 0.5);
    const double lo = a->log ? a->lo / factor : a->lo - margin, hi = a->log ? a->hi * factor : a->hi + margin;
    fprintf(file, "set %clabel ", name);
    ssfr_gnuplot_lines(file, a->label, name == 'x' ? WIDTH - 2 * LEFT : FRAME_HEIGHT, LABEL);
    fprintf(file, "\nset %crange [%.9g:%.9g]\n", name, a->sign < 0 ? hi : lo, a->sign < 0 ? lo : hi);
    if (!a->log) return;
    fprintf(file, "set logscale %c\n", name);
    ssfr_gnuplot_log_tics(file, name, lo, hi);
}

/* The points that p holds now, as the data block $<name><line>. */
static void put_points(const plot *p, FILE *file, const char *name, size_t line, bool only_front)
{
    fprintf(file, "$%s%zu << EOD\n", name, line);
    for (size_t i = 0; i < p->n_points; i++) {
        const ssfr_point *point = &p->points[i];
        if (!only_front || point->front)
            fprintf(file, "%.9g %.9g\n", p->x.sign * point->x, p->y.sign * point->y);
    }
    fputs("EOD\n", file);
}

/* The data of each line: all its points, and its own front; then the front of all. */
static ssfr_result put_data(plot *p, FILE *file)
{
    ssfr_result result = SSFR_OK;
    ssfr_point *own = NULL, *const all = p->points;
    const size_t n_all = p->n_points;
    SSFR_TRY(ssfr_alloc(&own, n_all, sizeof *own, "a line's points"));
    for (size_t line = 0; line < p->n_names; line++) {
        p->points = own;
        p->n_points = 0;
        for (size_t i = 0; i < n_all; i++)
            if (all[i].line == line) own[p->n_points++] = all[i];
        ssfr_plot_front(own, p->n_points);
        put_points(p, file, "all", line, false);
        put_points(p, file, "best", line, true);
    }
    p->points = all;
    p->n_points = n_all;
    ssfr_plot_front(all, n_all);
    put_points(p, file, "front", p->n_names, true);
end:
    free(own);
    return result;
}

static void put_lines(const plot *p, FILE *file)
{
    fputs("plot ", file);
    for (size_t i = 0; i < p->n_names; i++) {
        const char *colour = ssfr_gnuplot_colour(i);
        const int sign = ssfr_gnuplot_sign(i);
        fprintf(file, "$all%zu using 1:2 with points pt %d ps 0.35 lc rgb '%s' notitle, ", i, sign, colour);
        fprintf(file, "$best%zu using 1:2 with linespoints pt %d ps 0.8 lw 1.5 lc rgb '%s' title ", i, sign, colour);
        ssfr_gnuplot_text(file, p->names[i]);
        fputs(", ", file);
    }
    fprintf(file, "$front%zu using 1:2 with points pt 6 ps 1.7 lw 1.5 lc rgb 'black' title '%s'\n",
            p->n_names, front_name);
}

static ssfr_gnuplot_key fit_key(const plot *p)
{
    size_t longest = strlen(front_name);
    for (size_t i = 0; i < p->n_names; i++)
        if (strlen(p->names[i]) > longest) longest = strlen(p->names[i]);
    return ssfr_gnuplot_key_fit(p->n_names + 1, longest, WIDTH - LEFT);
}

static void put_title(const plot *p, FILE *file)
{
    char note[256];
    const int length =
        snprintf(note, sizeof note, "lines join the best of each method, small signs are its other runs");
    if (p->n_left_out > 0)
        snprintf(note + length, sizeof note - (size_t)length, "; %zu of %zu runs failed or have no value to draw",
                 p->n_left_out, p->n_left_out + p->n_points);
    fputs("set title ", file);
    ssfr_gnuplot_text(file, p->spec->title ? p->spec->title : "work and precision");
    fputs(" . \"\\n\" . ", file);
    ssfr_gnuplot_text(file, note);
    fputc('\n', file);
}

static ssfr_result put_script(void *user, FILE *file, const char *output)
{
    plot *p = user;
    const ssfr_gnuplot_key key = fit_key(p);
    const int below = ABOVE + FRAME_HEIGHT + BELOW;
    const double height = below + key.height;
    ssfr_gnuplot_begin(file, WIDTH, below + key.height, output);
    put_title(p, file);
    fprintf(file, "set tmargin at screen %.6f\nset bmargin at screen %.6f\n", 1 - ABOVE / height,
            1 - (ABOVE + FRAME_HEIGHT) / height);
    ssfr_gnuplot_key_put(file, &key, (double)LEFT / WIDTH, 1 - below / height);
    put_axis(file, 'x', &p->x);
    put_axis(file, 'y', &p->y);
    const ssfr_result result = put_data(p, file);
    put_lines(p, file);
    fputs("set output\n", file);
    return result;
}

ssfr_result ssfr_plot_save(const char *svg, const ssfr_csv_table *table, const ssfr_plot_spec *spec)
{
    ssfr_result result = SSFR_OK;
    plot *p = NULL;
    SSFR_TRY(ssfr_alloc(&p, 1, sizeof *p, "a plot"));
    p->table = table;
    p->spec = spec;
    SSFR_TRY(init_axis(p, &p->x, spec->x, spec->x_label));
    SSFR_TRY(init_axis(p, &p->y, spec->y, spec->y_label));
    for (int i = 0; i < spec->n_lines; i++) SSFR_TRY(find_column(p, spec->lines[i], &p->lines[i]));
    for (int i = 0; i < spec->n_only; i++) SSFR_TRY(find_column(p, spec->only[i].column, &p->only[i]));
    SSFR_TRY(collect(p));
    if (p->n_points == 0) {
        ssfr_log(SSFR_WARNING, "%s: not drawn, none of its runs has a value for both %s and %s", svg, spec->x, spec->y);
        goto end;
    }
    SSFR_TRY(ssfr_gnuplot_draw(svg, put_script, p));
end:
    if (p) free(p->points);
    free(p);
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chart.c: curves from the rows of a table, and the gnuplot script that draws them. */
#include "experiments/chart.h"
#include "experiments/gnuplot.h"

enum {
    NAME_SIZE = 128,
    PANEL_WIDTH = 620,           /* px */
    FRAME_HEIGHT = 310,          /* px, between the x axes */
    LABEL_HEIGHT = 360,          /* px, of the y label, which may reach a little beyond */
    TITLE = 18, LABEL = 15,      /* px, sizes of fonts */
    TITLE_LINE = 24, LINE = 20,  /* px, heights of a line of these */
    ABOVE = 14, BELOW = 44,      /* px beside the lines of a panel's title, and of its x label */
    LEFT = 60, MARGIN = 16,      /* px, before the key, and at the edges */
    FRAME_WIDTH = 520,           /* px, what is left by numbers and a label of two lines */
    DENSE = 40,                  /* points: a curve of more has no signs */
    MOST_TICS = 12,              /* side by side, of whole numbers */
};

typedef struct curves {
    int x, y;                          /* columns */
    int keys[SSFR_CHART_KEYS];
    size_t n_keys, n;
    char names[SSFR_CHART_CURVES][NAME_SIZE];
    size_t n_points[SSFR_CHART_CURVES];
    size_t *curve;                     /* of each row; SIZE_MAX: not drawn */
    size_t first[SSFR_CHART_CURVES];   /* row of each curve */
    double lo[2], hi[2];               /* of what is drawn: x, y */
    bool whole[2];                     /* all of these are whole numbers */
    ssfr_gnuplot_key key;
    int top, bottom, below;            /* px from the drawing's top: of the frame, and of the key */
} curves;

typedef struct chart {
    const ssfr_csv_table *table;
    const char *title;
    int n_panels;
    const ssfr_panel *panels;
    curves *curves; /* of each panel */
    int across, height; /* panels beside each other; px */
} chart;

/* ---- which row belongs to which curve ---------------------------------------------------------------------------- */

static ssfr_result find_column(const ssfr_csv_table *table, const char *name, int *out)
{
    *out = ssfr_csv_column(table, name);
    return *out >= 0 ? SSFR_OK : ssfr_fail(SSFR_ERR_UNKNOWN, "chart: the table has no column %s", name);
}

static ssfr_result find_columns(const ssfr_csv_table *table, const ssfr_panel *panel, curves *c)
{
    ssfr_result result = SSFR_OK;
    int unused;
    SSFR_TRY(find_column(table, panel->x, &c->x));
    SSFR_TRY(find_column(table, panel->y, &c->y));
    for (; c->n_keys < SSFR_CHART_KEYS && panel->keys[c->n_keys].column; c->n_keys++)
        SSFR_TRY(find_column(table, panel->keys[c->n_keys].column, &c->keys[c->n_keys]));
    for (size_t i = 0; i < SSFR_CHART_ONLY && panel->only[i].column; i++)
        SSFR_TRY(find_column(table, panel->only[i].column, &unused));
end:
    return result;
}

static void find_point(const ssfr_csv_table *table, const ssfr_panel *panel, const curves *c, size_t row,
                       double point[2])
{
    point[0] = ssfr_csv_cell_number(table, row, c->x);
    point[1] = ssfr_csv_cell_number(table, row, c->y) * (panel->y_factor != 0 ? panel->y_factor : 1);
}

static bool is_drawn(const ssfr_csv_table *table, const ssfr_panel *panel, size_t row, const double point[2])
{
    const int status = ssfr_csv_column(table, "status");
    if (status >= 0 && strcmp(ssfr_csv_cell(table, row, status), "ok") != 0) return false;
    for (size_t i = 0; i < SSFR_CHART_ONLY && panel->only[i].column; i++) {
        bool wanted = false;
        for (size_t k = 0; k < SSFR_CHART_ONLY && panel->only[k].column; k++)
            wanted |= strcmp(panel->only[k].column, panel->only[i].column) == 0 &&
                      strcmp(ssfr_csv_cell(table, row, ssfr_csv_column(table, panel->only[i].column)),
                             panel->only[k].cell) == 0;
        if (!wanted) return false;
    }
    return isfinite(point[0]) && isfinite(point[1]) && (point[0] > 0 || !panel->log_x) &&
           (point[1] > 0 || !panel->log_y);
}

static ssfr_result find_curve(const ssfr_csv_table *table, const ssfr_panel *panel, curves *c, size_t row)
{
    char name[NAME_SIZE] = "";
    size_t used = 0, i = 0;
    for (size_t k = 0; k < c->n_keys && used < NAME_SIZE; k++)
        used += (size_t)snprintf(name + used, NAME_SIZE - used, "%s%s%s", k ? ", " : "",
                                 panel->keys[k].before ? panel->keys[k].before : "",
                                 ssfr_csv_cell(table, row, c->keys[k]));
    while (i < c->n && strcmp(c->names[i], name) != 0) i++;
    if (i == SSFR_CHART_CURVES)
        return ssfr_fail(SSFR_ERR_VALUE, "chart: more than %d curves, the next is %s", SSFR_CHART_CURVES, name);
    if (i == c->n) {
        strcpy(c->names[c->n++], name);
        c->first[i] = row;
    }
    c->curve[row] = i;
    c->n_points[i]++;
    return SSFR_OK;
}

static void widen(curves *c, const double point[2])
{
    for (int k = 0; k < 2; k++) {
        c->lo[k] = fmin(c->lo[k], point[k]);
        c->hi[k] = fmax(c->hi[k], point[k]);
        c->whole[k] &= point[k] == floor(point[k]);
    }
}

static ssfr_result collect(const ssfr_csv_table *table, const ssfr_panel *panel, curves *c)
{
    ssfr_result result = SSFR_OK;
    *c = (curves){.lo = {INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY}, .whole = {true, true}};
    SSFR_TRY(find_columns(table, panel, c));
    SSFR_TRY(ssfr_alloc(&c->curve, table->n_rows, sizeof *c->curve, "a chart's rows"));
    for (size_t row = 0; row < table->n_rows; row++) {
        double point[2];
        find_point(table, panel, c, row, point);
        c->curve[row] = SIZE_MAX;
        if (!is_drawn(table, panel, row, point)) continue;
        SSFR_TRY(find_curve(table, panel, c, row));
        widen(c, point);
    }
    if (panel->mark[0] > 0) widen(c, panel->mark);
    for (int i = 0; i < SSFR_CHART_LEVELS; i++)
        if (panel->levels[i] != 0) widen(c, (double[2]){c->lo[0], panel->levels[i]});
end:
    return result;
}

/* ---- the script -------------------------------------------------------------------------------------------------- */

static void put_axis(FILE *script, char name, const char *label, bool log, const curves *c)
{
    const int i = name == 'y';
    double lo = c->lo[i], hi = c->hi[i];
    const bool counts = c->whole[i] && hi > lo && hi - lo < MOST_TICS;
    const double factor = pow(fmax(hi / lo, 1.5), 0.06), margin = hi > lo ? 0.06 * (hi - lo) : 0.5 + 0.05 * fabs(hi);
    lo = log ? lo / factor : lo - margin;
    hi = log ? hi * factor : hi + margin;
    fprintf(script, "set %clabel ", name);
    ssfr_gnuplot_lines(script, label, i ? LABEL_HEIGHT : FRAME_WIDTH, LABEL);
    fprintf(script, "\nset %crange [%.9g:%.9g]\nunset logscale %c\nset %ctics %s\n", name, lo, hi, name, name,
            counts ? "1" : "autofreq");
    if (!log) return;
    fprintf(script, "set logscale %c\n", name);
    ssfr_gnuplot_log_tics(script, name, lo, hi);
}

static void put_points(const chart *ch, int p, FILE *script)
{
    const curves *c = &ch->curves[p];
    for (size_t i = 0; i < c->n; i++) {
        fprintf(script, "$curve%d_%zu << EOD\n", p, i);
        for (size_t row = 0; row < ch->table->n_rows; row++) {
            double point[2];
            if (c->curve[row] != i) continue;
            find_point(ch->table, &ch->panels[p], c, row, point);
            fprintf(script, "%.9g %.9g\n", point[0], point[1]);
        }
        fputs("EOD\n", script);
    }
}

/* The first curve whose name begins as that of this one does. */
static size_t first_alike(const chart *ch, const curves *c, size_t i)
{
    size_t k = 0;
    while (strcmp(ssfr_csv_cell(ch->table, c->first[k], c->keys[0]), ssfr_csv_cell(ch->table, c->first[i], c->keys[0])))
        k++;
    return k;
}

/* Where there are more curves than colours, those whose names begin alike share one, and differ by their dashes. */
static void put_style(const chart *ch, const curves *c, size_t i, FILE *script)
{
    const bool dense = c->n_points[i] > DENSE, shared = c->n > SSFR_GNUPLOT_COLOURS && c->n_keys > 1;
    size_t colour = shared ? 0 : i, dashes = 1;
    for (size_t k = 0; shared && k < i; k++) {
        colour += first_alike(ch, c, k) == k && k < first_alike(ch, c, i);
        dashes += first_alike(ch, c, k) == first_alike(ch, c, i);
    }
    fprintf(script, "with %s lw 1.6 dt %zu lc rgb '%s'", dense ? "lines" : "linespoints", dashes,
            ssfr_gnuplot_colour(colour));
    if (!dense) fprintf(script, " pt %d ps 0.9", ssfr_gnuplot_sign(i));
}

static void put_curves(const chart *ch, int p, FILE *script)
{
    const curves *c = &ch->curves[p];
    const ssfr_panel *panel = &ch->panels[p];
    const char *joint = "plot ";
    for (size_t i = 0; i < c->n; i++, joint = ", ") {
        fprintf(script, "%s$curve%d_%zu using 1:2 ", joint, p, i);
        put_style(ch, c, i, script);
        fputs(" title ", script);
        ssfr_gnuplot_text(script, c->names[i]);
    }
    for (int i = 0; i < SSFR_CHART_LEVELS; i++) {
        if (panel->levels[i] == 0) continue;
        fprintf(script, "%s%.9g with lines dt 2 lw 1.2 lc rgb 'black' title ", joint, panel->levels[i]);
        ssfr_gnuplot_text(script, i == 0 && panel->level_text ? panel->level_text : "");
    }
    if (panel->mark[0] > 0) {
        fprintf(script, "%s'+' using (%.9g):(%.9g) every ::0::0 with points pt 3 ps 2 lw 2 lc rgb 'black' title ",
                joint, panel->mark[0], panel->mark[1]);
        ssfr_gnuplot_text(script, panel->mark_text);
    }
    fputc('\n', script);
}

/* ---- where panels stand ------------------------------------------------------------------------------------------ */

static ssfr_gnuplot_key fit_key(const ssfr_panel *panel, const curves *c)
{
    const char *more[] = {panel->levels[0] != 0 ? panel->level_text : NULL,
                          panel->mark[0] > 0 ? panel->mark_text : NULL};
    size_t n = 0, longest = 0;
    for (size_t i = 0; i < c->n + SSFR_COUNT(more); i++) {
        const char *name = i < c->n ? c->names[i] : more[i - c->n];
        n += name && name[0];
        if (name && strlen(name) > longest) longest = strlen(name);
    }
    return ssfr_gnuplot_key_fit(n, longest, PANEL_WIDTH - LEFT - MARGIN);
}

/* Panels beside each other have frames of the same height, and the one that needs most gives the room for labels and
 * keys. Gives the drawing's height, px. */
static int place_panels(chart *ch)
{
    int y = 2 * MARGIN + TITLE_LINE * ssfr_gnuplot_lines(NULL, ch->title, ch->across * PANEL_WIDTH, TITLE);
    for (int begin = 0; begin < ch->n_panels; begin += ch->across) {
        const int end = ssfr_min_int(begin + ch->across, ch->n_panels);
        int above = 0, below = 0, key = 0;
        for (int p = begin; p < end; p++) {
            const ssfr_panel *panel = &ch->panels[p];
            above = ssfr_max_int(above, ABOVE + LINE * ssfr_gnuplot_lines(NULL, panel->title, PANEL_WIDTH, LABEL));
            below = ssfr_max_int(below, BELOW + LINE * ssfr_gnuplot_lines(NULL, panel->x_label, FRAME_WIDTH, LABEL));
            ch->curves[p].key = fit_key(panel, &ch->curves[p]);
            key = ssfr_max_int(key, ch->curves[p].key.height);
        }
        for (int p = begin; p < end; p++) {
            ch->curves[p].top = y + above;
            ch->curves[p].bottom = y + above + FRAME_HEIGHT;
            ch->curves[p].below = ch->curves[p].bottom + below;
        }
        y += above + FRAME_HEIGHT + below + key;
    }
    return y;
}

static void put_place(const chart *ch, int p, FILE *script)
{
    const curves *c = &ch->curves[p];
    const double across = ch->across, column = p % ch->across, height = ch->height;
    fprintf(script, "set origin %.6f,0\nset size %.6f,1\n", column / across, 1 / across);
    fprintf(script, "set tmargin at screen %.6f\nset bmargin at screen %.6f\n", 1 - c->top / height,
            1 - c->bottom / height);
    ssfr_gnuplot_key_put(script, &c->key, (column + (double)LEFT / PANEL_WIDTH) / across, 1 - c->below / height);
}

static void put_panel(const chart *ch, int p, FILE *script)
{
    const ssfr_panel *panel = &ch->panels[p];
    const curves *c = &ch->curves[p];
    put_place(ch, p, script);
    put_points(ch, p, script);
    fputs("set title ", script);
    ssfr_gnuplot_lines(script, panel->title, PANEL_WIDTH, LABEL);
    fputc('\n', script);
    put_axis(script, 'x', panel->x_label, panel->log_x, c);
    put_axis(script, 'y', panel->y_label, panel->log_y, c);
    put_curves(ch, p, script);
}

static ssfr_result put_script(void *user, FILE *script, const char *output)
{
    chart *ch = user;
    ch->across = ch->n_panels > 1 ? 2 : 1;
    ch->height = place_panels(ch);
    ssfr_gnuplot_begin(script, PANEL_WIDTH * ch->across, ch->height, output);
    fputs("set samples 2\nset rmargin 3\nset xlabel offset 0,0.5\nset multiplot title ", script);
    ssfr_gnuplot_lines(script, ch->title, PANEL_WIDTH * ch->across, TITLE);
    fprintf(script, " font ',%d'\n", TITLE);
    for (int p = 0; p < ch->n_panels; p++) put_panel(ch, p, script);
    fputs("unset multiplot\nset output\n", script);
    return SSFR_OK;
}

void ssfr_panels_fill(int n_panels, ssfr_panel *panels, const char *cell)
{
    for (int p = 0; p < n_panels; p++)
        for (int i = 0; i < SSFR_CHART_ONLY && panels[p].only[i].column; i++)
            if (!panels[p].only[i].cell) panels[p].only[i].cell = cell;
}

ssfr_result ssfr_chart_save(const char *svg, const ssfr_csv_table *table, const char *title, int n_panels,
                            const ssfr_panel *panels)
{
    ssfr_result result = SSFR_OK;
    chart ch = {.table = table, .title = title, .n_panels = n_panels, .panels = panels};
    SSFR_TRY(ssfr_alloc(&ch.curves, (size_t)n_panels, sizeof *ch.curves, "a chart"));
    for (int p = 0; p < n_panels; p++) {
        SSFR_TRY(collect(table, &panels[p], &ch.curves[p]));
        if (ch.curves[p].n > 0) continue;
        ssfr_log(SSFR_WARNING, "%s: not drawn, no row has a value for both %s and %s", svg, panels[p].x, panels[p].y);
        goto end;
    }
    SSFR_TRY(ssfr_gnuplot_draw(svg, put_script, &ch));
end:
    for (int p = 0; ch.curves && p < n_panels; p++) free(ch.curves[p].curve);
    free(ch.curves);
    return result;
}

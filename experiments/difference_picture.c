/* SPDX-License-Identifier: GPL-3.0-or-later */
/* difference_picture.c: from two depth images to gnuplot's image with a diverging palette. */
#include "experiments/difference_picture.h"
#include "experiments/gnuplot.h"

enum { MARGIN = 20, TOP = 64, BAR = 150, LEAST_WIDTH = 640 }; /* px */

/* What a cell of gnuplot's matrix holds where there is no difference to show. */
enum { ONLY_A = 1000000, ONLY_B = -1000000 };

typedef struct drawing {
    const ssfr_field *a, *b;
    const ssfr_difference_picture *picture;
    double unit, range; /* m; of the bar */
    size_t n_both, n_only_a, n_only_b, n_beyond;
} drawing;

/* ---- values ------------------------------------------------------------------------------------------------------ */

static double cell_of(const drawing *d, size_t i)
{
    const double a = d->a->data[i], b = d->b->data[i];
    const ssfr_field *mask = d->picture->mask;
    if (mask && mask->data[i] == 0) return NAN;
    const bool has_a = fabs(a) < SSFR_SURFACE, has_b = fabs(b) < SSFR_SURFACE;
    return has_a && has_b ? (a - b) / d->unit : has_a ? ONLY_A : has_b ? ONLY_B : NAN;
}

/* The next of 1, 2, 5 times a power of ten. */
static double round_up(double value)
{
    const double decade = pow(10, floor(log10(value)));
    for (int i = 0; i < 3; i++)
        if (value <= (double[]){1, 2, 5}[i] * decade * (1 + 1e-9)) return (double[]){1, 2, 5}[i] * decade;
    return 10 * decade;
}

/* Counts, and finds a range that most pixels lie in. */
static ssfr_result survey(drawing *d)
{
    ssfr_result result = SSFR_OK;
    const size_t n = (size_t)d->a->w * (size_t)d->a->h;
    double *sizes = NULL;
    SSFR_TRY(ssfr_alloc(&sizes, n, sizeof *sizes, "differences"));
    for (size_t i = 0; i < n; i++) {
        const double cell = cell_of(d, i);
        const bool a_alone = cell == ONLY_A, b_alone = cell == ONLY_B;
        d->n_only_a += a_alone;
        d->n_only_b += b_alone;
        if (!a_alone && !b_alone && isfinite(cell)) sizes[d->n_both++] = fabs(cell);
    }
    qsort(sizes, d->n_both, sizeof *sizes, ssfr_by_value);
    const double most = d->n_both > 0 ? sizes[(d->n_both * 95 + 99) / 100 - 1] : 0;
    d->range = d->picture->range > 0 ? d->picture->range : most > 0 ? round_up(most) : 1;
    for (size_t i = 0; i < d->n_both; i++) d->n_beyond += sizes[i] > d->range;
end:
    free(sizes);
    return result;
}

/* ---- the script -------------------------------------------------------------------------------------------------- */

static void put_matrix(const drawing *d, FILE *script)
{
    fputs("$m << EOD\n", script);
    for (int y = 0; y < d->a->h; y++)
        for (int x = 0; x < d->a->w; x++) {
            const double cell = cell_of(d, (size_t)y * (size_t)d->a->w + (size_t)x);
            const char *after = x + 1 < d->a->w ? " " : "\n";
            if (isnan(cell))
                fprintf(script, "NaN%s", after);
            else
                fprintf(script, "%.7g%s", cell, after);
        }
    fputs("EOD\n", script);
}

/* A small image is enlarged by a whole number. */
static int scale_of(const drawing *d)
{
    return d->a->w < LEAST_WIDTH ? (LEAST_WIDTH + d->a->w - 1) / d->a->w : 1;
}

static void find_size(const drawing *d, int *width, int *height)
{
    *width = scale_of(d) * d->a->w + MARGIN + BAR;
    *height = scale_of(d) * d->a->h + MARGIN + TOP;
}

/* Screen coordinates, so that a pixel of the image is a whole number of pixels of the picture. */
static void put_frame(const drawing *d, FILE *script, const char *output)
{
    const int w = d->a->w, h = d->a->h, scale = scale_of(d);
    int width, height;
    find_size(d, &width, &height);
    fprintf(script, "set terminal pngcairo size %d,%d noenhanced font 'sans-serif,11' background 'white'\nset output ",
            width, height);
    ssfr_gnuplot_text(script, output);
    fprintf(script, "\nset lmargin at screen %.9f\nset rmargin at screen %.9f\n", (double)MARGIN / width,
            (double)(MARGIN + scale * w) / width);
    fprintf(script, "set bmargin at screen %.9f\nset tmargin at screen %.9f\n", (double)MARGIN / height,
            (double)(MARGIN + scale * h) / height);
    fprintf(script, "set xrange [-0.5:%d.5]\nset yrange [%d.5:-0.5]\nunset xtics\nunset ytics\n", w - 1, h - 1);
    fprintf(script, "set colorbox user origin screen %.9f,%.9f size screen %.9f,%.9f\n",
            (double)(2 * MARGIN + scale * w) / width, (double)MARGIN / height, (double)MARGIN / width,
            (double)(scale * h) / height);
}

/* A line of text above the image. */
static void put_line(const drawing *d, FILE *script, const char *text, int from_top)
{
    int width, height;
    find_size(d, &width, &height);
    fputs("set label ", script);
    ssfr_gnuplot_text(script, text);
    fprintf(script, " at screen %.9f,%.9f left\n", (double)MARGIN / width, 1 - (double)from_top / height);
}

static void put_texts(const drawing *d, FILE *script)
{
    const double n = fmax(1, (double)(d->n_both + d->n_only_a + d->n_only_b));
    char text[256];
    snprintf(text, sizeof text,
             "grey: no surface%s; orange: only in A (%.1f %%); green: only in B (%.1f %%); beyond the bar: %.1f %%",
             d->picture->mask ? " or not counted" : "",
             100 * (double)d->n_only_a / n, 100 * (double)d->n_only_b / n, 100 * (double)d->n_beyond / n);
    put_line(d, script, d->picture->title, TOP / 3);
    put_line(d, script, text, TOP * 2 / 3);
    fputs("set cblabel ", script);
    ssfr_gnuplot_text(script, d->picture->radius > 0 ? "A nearer (+) or farther (-) than B, particle radii"
                                                     : "A nearer (+) or farther (-) than B, m");
    fputc('\n', script);
}

static ssfr_result put_script(void *user, FILE *script, const char *output)
{
    const drawing *d = user;
    put_frame(d, script, output);
    put_texts(d, script);
    put_matrix(d, script);
    fprintf(script, "set cbrange [%.9g:%.9g]\n", -d->range, d->range);
    /* Even steps of lightness to both sides of white, told apart by the colour-blind. */
    fputs("set palette defined (0 '#053061', 1 '#2166ac', 2 '#4393c3', 3 '#92c5de', 4 '#d1e5f0', 5 '#ffffff', "
          "6 '#fddbc7', 7 '#f4a582', 8 '#d6604d', 9 '#b2182b', 10 '#67001f')\n"
          "set object 1 rectangle from graph 0,0 to graph 1,1 fillcolor rgb '#bbbbbb' fillstyle solid noborder "
          "behind\n",
          script);
    fprintf(script, "plot $m matrix using 1:2:(abs($3) < %d ? $3 : NaN) with image pixels notitle, ", ONLY_A);
    fprintf(script,
            "$m matrix using 1:2:($3 > 0 ? 230 : 0):($3 > 0 ? 159 : 158):($3 > 0 ? 0 : 115):(abs($3) == %d ? 255 : 0) "
            "with rgbalpha notitle\nset output\n",
            ONLY_A);
    return SSFR_OK;
}

ssfr_result ssfr_difference_picture_save(const char *png, const ssfr_field *a, const ssfr_field *b,
                                         const ssfr_difference_picture *picture)
{
    ssfr_result result = SSFR_OK;
    drawing d = {.a = a, .b = b, .picture = picture, .unit = picture->radius > 0 ? picture->radius : 1};
    if (a->w != b->w || a->h != b->h || a->c != 1 || b->c != 1)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: depth images of %dx%d and %dx%d pixels, of %d and %d channels", png,
                         a->w, a->h, b->w, b->h, a->c, b->c);
    SSFR_TRY(survey(&d));
    SSFR_TRY(ssfr_gnuplot_draw(png, put_script, &d));
end:
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* course.c: the kernels of diffuse particles along a ray, in the order in which it enters them. */
#include "experiments/truth/course.h"

#define DEEP 40.0 /* optical depth from which on nothing changes a double of the size 1: e^-40 = 4e-18 */

/* ---- the ray's flecks -------------------------------------------------------------------------------------------- */

static const double *colour_of(const ssfr_extinction *extinction, uint32_t index)
{
    return extinction->colour ? extinction->colour[index] : extinction->same;
}

static void add_fleck(ssfr_course *c, const ssfr_extinction *extinction, const ssfr_line_kernel *kernel)
{
    const double begins = fmax(kernel->enters, c->from), ends = fmin(kernel->leaves, c->to);
    if (!(begins < ends)) return;
    ssfr_fleck *f = &c->flecks[c->n];
    *f = (ssfr_fleck){.begins = begins, .ends = ends, .middle = kernel->middle, .near2 = kernel->near2,
                      .near = sqrt(kernel->near2), .scale = sqrt(kernel->stretch), .weight = kernel->weight,
                      .colour = colour_of(extinction, kernel->index)};
    f->start = ssfr_radial_chord(c->radial, f->near, f->scale * (begins - f->middle));
    const double end = ssfr_radial_chord(c->radial, f->near, f->scale * (ends - f->middle));
    f->whole = f->weight / f->scale * (end - f->start);
    if (c->n > 0) f->before = f[-1].before + f[-1].whole;
    c->longest = fmax(c->longest, ends - begins);
    c->n++;
}

ssfr_result ssfr_course_init(ssfr_course *c, const ssfr_extinction *extinction, const ssfr_line *line,
                             ssfr_integration *work, double a, double b)
{
    ssfr_result result = SSFR_OK;
    *c = (ssfr_course){.radial = extinction->kernels.radial, .from = INFINITY, .to = -INFINITY};
    for (size_t i = 0; i < line->n; i++) {
        c->from = fmin(c->from, line->kernels[i].enters);
        c->to = fmax(c->to, line->kernels[i].leaves);
    }
    c->from = fmax(c->from, fmax(a, line->from));
    c->to = fmin(c->to, fmin(b, line->to));
    if (!(a < b && c->from < c->to)) return SSFR_OK;

    SSFR_TRY(ssfr_integration_room(work, line->n, sizeof *c->flecks, &c->flecks));
    for (size_t i = 0; i < line->n; i++) add_fleck(c, extinction, &line->kernels[i]);
    c->depth = ssfr_line_chords(line, c->from, c->to, &c->depth_err);
end:
    return result;
}

/* ---- as functions of t ------------------------------------------------------------------------------------------- */

/* Optical depth of a fleck from its begin to t. */
static double depth_in(const ssfr_course *c, const ssfr_fleck *f, double t)
{
    if (t >= f->ends) return f->whole;
    const double chord = ssfr_radial_chord(c->radial, f->near, f->scale * (t - f->middle)) - f->start;
    return f->weight / f->scale * chord;
}

size_t ssfr_course_first(const ssfr_course *c, double t)
{
    size_t lo = 0, hi = c->n;
    while (lo < hi) {
        const size_t mid = lo + (hi - lo) / 2;
        if (c->flecks[mid].begins < t - c->longest) lo = mid + 1;
        else hi = mid;
    }
    return lo;
}

double ssfr_course_depth(const ssfr_course *c, double t)
{
    size_t i = ssfr_course_first(c, t);
    double depth = i < c->n ? c->flecks[i].before : c->depth;
    for (; i < c->n && c->flecks[i].begins < t; i++) depth += depth_in(c, &c->flecks[i], t);
    return depth;
}

/* sigma_j(t) of one fleck, 1/m. */
static double extinction_of(const ssfr_course *c, const ssfr_fleck *f, double t)
{
    return f->weight * ssfr_radial_value(c->radial, sqrt(f->near2 + ssfr_square(f->scale * (t - f->middle))));
}

double ssfr_course_sample(const ssfr_course *c, size_t first, double t, double glow[3])
{
    double sigma = 0;
    for (int k = 0; k < 3; k++) glow[k] = 0;
    for (size_t i = first; i < c->n && c->flecks[i].begins < t; i++) {
        const ssfr_fleck *f = &c->flecks[i];
        if (t >= f->ends) continue;
        const double own = extinction_of(c, f, t);
        sigma += own;
        for (int k = 0; k < 3; k++) glow[k] += own * f->colour[k];
    }
    return sigma;
}

double ssfr_course_shine(double t, void *user)
{
    const ssfr_course *c = user;
    size_t i = ssfr_course_first(c, t);
    double glow = 0, depth = i < c->n ? c->flecks[i].before : c->depth;
    for (; i < c->n && c->flecks[i].begins < t; i++) {
        const ssfr_fleck *f = &c->flecks[i];
        depth += depth_in(c, f, t);
        if (t < f->ends) glow += f->colour[c->channel] * extinction_of(c, f, t);
    }
    return glow > 0 ? glow * exp(-depth) : 0;
}

/* ---- colours, and what is seen ----------------------------------------------------------------------------------- */

const double ssfr_course_mixed[3] = {0};

bool ssfr_same_colour(const double a[3], const double b[3])
{
    return a == b || (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]);
}

const double *ssfr_course_colour(const ssfr_course *c, double t)
{
    const double *colour = NULL;
    for (size_t i = ssfr_course_first(c, t); i < c->n && c->flecks[i].begins < t; i++) {
        const ssfr_fleck *f = &c->flecks[i];
        if (t >= f->ends) continue;
        if (colour && !ssfr_same_colour(colour, f->colour)) return ssfr_course_mixed;
        colour = f->colour;
    }
    return colour;
}

/* What it leaves is in e^-(depth there). */
double ssfr_course_end_in_the_dark(ssfr_course *c)
{
    if (c->depth <= DEEP) return c->depth;
    double lo = c->from, hi = c->to;
    for (int k = 0; k < 64; k++) { /* to a double's digits */
        const double mid = 0.5 * (lo + hi);
        if (ssfr_course_depth(c, mid) > DEEP) hi = mid;
        else lo = mid;
    }
    c->to = hi;
    return DEEP;
}

/* Of a fleck both its light and its shade, by no more than comes through to its begin. Of all flecks it is about the
 * same. */
double ssfr_course_doubt(const ssfr_course *c)
{
    double sum = 0;
    for (size_t i = 0; i < c->n; i++) sum += exp(-c->flecks[ssfr_course_first(c, c->flecks[i].begins)].before);
    return fmin(1, 2 * c->depth_err / (double)c->n * sum);
}

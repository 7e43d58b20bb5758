/* SPDX-License-Identifier: GPL-3.0-or-later */
/* line.c: the kernels along a ray, in the order in which it enters them. */
#include "experiments/truth/line.h"

#include "experiments/truth/sum.h"

#include <float.h>
#include <gsl/gsl_heapsort.h>

/* What a place along the ray that is measured from its origin may be off by, relative to the longest of what it is made
 * of: three products and their sum, the place itself, and the kernel's own place. */
static const double place_error = 4 * DBL_EPSILON;
/* Distance to a kernel's middle, in radii of its inner piece, below which its odd powers nearly have a kink there: 16
 * points of Gauss and Legendre are then wrong by up to 2e-5 of a cubic spline, with a break there by 1e-10. */
static const double sharp = 0.4;

void ssfr_line_init(ssfr_line *line, const ssfr_continuum *fluid)
{
    *line = (ssfr_line){.fluid = fluid};
}

void ssfr_line_finish(ssfr_line *line)
{
    free(line->kernels);
    free(line->spare);
    free(line->keys);
    free(line->begins);
    free(line->breaks);
    *line = (ssfr_line){0};
}

/* ---- gathering --------------------------------------------------------------------------------------------------- */

typedef struct ssfr_line_key {
    double at; /* m */
    uint32_t index, slot;
} key;

/* Room for `more` kernels beside those that are there. */
static ssfr_result reserve(ssfr_line *line, size_t more)
{
    ssfr_result result = SSFR_OK;
    const size_t wanted = 2 * (line->n + more);
    ssfr_line_kernel *kernels = NULL, *spare = NULL;
    key *keys = NULL;
    uint32_t *begins = NULL;
    if (line->n + more <= line->capacity) return SSFR_OK;
    SSFR_TRY(ssfr_alloc(&kernels, wanted, sizeof *kernels, "kernels along a ray"));
    SSFR_TRY(ssfr_alloc(&spare, wanted, sizeof *spare, "kernels along a ray"));
    SSFR_TRY(ssfr_alloc(&keys, 2 * wanted, sizeof *keys, "kernels along a ray"));
    SSFR_TRY(ssfr_alloc(&begins, wanted + 1, sizeof *begins, "kernels along a ray"));
    if (line->n > 0) memcpy(kernels, line->kernels, line->n * sizeof *kernels);
    free(line->kernels), free(line->spare), free(line->keys), free(line->begins);
    line->kernels = kernels, line->spare = spare, line->keys = keys, line->begins = begins;
    line->capacity = wanted;
    kernels = spare = NULL, keys = NULL, begins = NULL;
end:
    free(kernels), free(spare), free(keys), free(begins);
    return result;
}

/* Where the ray is nearest to the kernel as that measures distances, and how fast it is there. Measured from the place
 * that is nearest in metres: stretching then magnifies no rounding. No direction is stretched by more than Frobenius'
 * norm. */
static void measure_stretched(const double inverse[6], double support, const double dir[3], ssfr_line_kernel *k)
{
    const double *m = inverse, *o = k->aside;
    const double p[3] = {m[0] * o[0] + m[1] * o[1] + m[2] * o[2], m[1] * o[0] + m[3] * o[1] + m[4] * o[2],
                         m[2] * o[0] + m[4] * o[1] + m[5] * o[2]};
    const double v[3] = {m[0] * dir[0] + m[1] * dir[1] + m[2] * dir[2], m[1] * dir[0] + m[3] * dir[1] + m[4] * dir[2],
                         m[2] * dir[0] + m[4] * dir[1] + m[5] * dir[2]};
    const double speed2 = ssfr_dot(v, v), further = -ssfr_dot(p, v) / speed2;
    const double nearest[3] = {p[0] + further * v[0], p[1] + further * v[1], p[2] + further * v[2]};
    k->near2 = ssfr_dot(nearest, nearest) / (support * support);
    k->stretch = speed2 / (support * support);
    k->steep = sqrt(m[0] * m[0] + m[3] * m[3] + m[5] * m[5] + 2 * (m[1] * m[1] + m[2] * m[2] + m[4] * m[4])) / support;
    k->middle += further;
    for (int c = 0; c < 3; c++) k->aside[c] += further * dir[c];
}

typedef struct gathering {
    ssfr_line *line;
    ssfr_result result;
    double farthest; /* m from the ray's origin to where it is nearest to a kernel */
    double widest2;  /* m^2, from there to the kernel's middle */
} gathering;

static double from_origin(const ssfr_ray *ray)
{
    return fabs(ray->origin[0]) + fabs(ray->origin[1]) + fabs(ray->origin[2]);
}

/* What a squared distance in supports may be off by when places are by `off` supports. */
static double doubt_of(double off)
{
    return (2 + off) * off + 4 * DBL_EPSILON;
}

/* Of spheres, and of zhu_bridson where a particle alone fills its support: one that does not weighs nothing at its rim,
 * as any density does. */
static bool has_rims(const ssfr_continuum *fluid)
{
    return fluid->kind == SSFR_CONTINUUM_SPHERES ||
           (fluid->kind == SSFR_CONTINUUM_ZHU_BRIDSON && fluid->radius >= (1 - 1e-6) * fluid->support);
}

/* A kernel that is not among the line's. Rounding may hide that it is met after all, just so: where the surface is its
 * rim that counts. */
static void note_hidden(ssfr_line *line, const ssfr_line_kernel *k)
{
    const double support = line->fluid->support;
    const double off = place_error * (from_origin(&line->ray) + fabs(k->middle) + support) / support;
    const double left = 1 - k->near2 + doubt_of(off);
    if (left <= 0) return;
    const double half = (sqrt(left) + off) * support;
    const double enters = fmax(k->middle - half, line->from), leaves = fmin(k->middle + half, line->to);
    if (enters >= leaves) return;
    line->hidden += leaves - enters;
    line->hidden_at = fmin(line->hidden_at, enters);
}

/* What of the ray lies in the kernel, and whether that is a part of the line. */
static bool meet(const ssfr_line *line, ssfr_line_kernel *k)
{
    if (!(k->near2 < 1)) return false;
    const double half = sqrt((1 - k->near2) / k->stretch);
    k->enters = k->middle - half;
    k->leaves = k->middle + half;
    return k->leaves > line->from && k->enters < line->to;
}

static bool gather(void *user, uint32_t begin, uint32_t end)
{
    gathering *g = user;
    ssfr_line *line = g->line;
    const ssfr_continuum *fluid = line->fluid;
    const ssfr_ray ray = line->ray;
    const double support = fluid->support, per_support2 = 1 / (support * support);
    const bool rims = has_rims(fluid);
    double farthest = g->farthest, longest = line->longest, widest2 = g->widest2;
    g->result = reserve(line, end - begin);
    if (g->result != SSFR_OK) return false;
    ssfr_line_kernel *next = line->kernels + line->n;
    for (uint32_t i = begin; i < end; i++) {
        const double *centre = fluid->centre[i];
        const double to[3] = {ray.origin[0] - centre[0], ray.origin[1] - centre[1], ray.origin[2] - centre[2]};
        const double middle = -ssfr_dot(to, ray.dir), far = fabs(middle);
        ssfr_line_kernel k = {.middle = middle, .stretch = per_support2, .steep = 1 / support,
                              .weight = fluid->weight, .index = i};
        for (int c = 0; c < 3; c++) k.aside[c] = to[c] + middle * ray.dir[c];
        k.near2 = ssfr_dot(k.aside, k.aside) * per_support2;
        if (fluid->inverse) {
            k.weight = fluid->weights[i];
            measure_stretched(fluid->inverse[i], support, ray.dir, &k);
        }
        if (!meet(line, &k)) {
            if (rims) note_hidden(line, &k);
            continue;
        }
        const double wide2 = ssfr_dot(k.aside, k.aside);
        farthest = far > farthest ? far : farthest;
        widest2 = wide2 > widest2 ? wide2 : widest2;
        longest = k.leaves - k.enters > longest ? k.leaves - k.enters : longest;
        *next++ = k;
    }
    line->n = (size_t)(next - line->kernels);
    line->longest = longest;
    g->farthest = farthest, g->widest2 = widest2;
    return true;
}

/* ---- sorting ----------------------------------------------------------------------------------------------------- */

static bool is_before(const key *a, const key *b)
{
    return a->at < b->at || (a->at == b->at && a->index < b->index);
}

static int compare(const void *a, const void *b)
{
    return is_before(a, b) ? -1 : is_before(b, a);
}

static void insert_each(key *keys, size_t n)
{
    for (size_t i = 1; i < n; i++) {
        const key one = keys[i];
        size_t at = i;
        for (; at > 0 && is_before(&one, &keys[at - 1]); at--) keys[at] = keys[at - 1];
        keys[at] = one;
    }
}

/* Sorts keys[n] by way of spare[n]: into as many equal stretches of the line as there are keys, as places along a ray
 * lie there evenly enough, then each stretch. `begins` has n + 1 places. */
static void sort(key *keys, key *spare, uint32_t *begins, size_t n)
{
    enum { FEW = 24 }; /* below that inserting beats a heap, which unlike qsort takes no memory */
    double lo = INFINITY, hi = -INFINITY;
    for (size_t i = 0; i < n; i++) lo = keys[i].at < lo ? keys[i].at : lo, hi = keys[i].at > hi ? keys[i].at : hi;
    const double per_m = hi - lo > DBL_MIN * (double)n ? (double)n / (hi - lo) : 0;
    memset(begins, 0, (n + 1) * sizeof *begins);
#define STRETCH(k) ((size_t)ssfr_clamp(((k).at - lo) * per_m, 0, (double)(n - 1)))
    for (size_t i = 0; i < n; i++) begins[STRETCH(keys[i]) + 1]++;
    for (size_t i = 0; i < n; i++) begins[i + 1] += begins[i];
    for (size_t i = 0; i < n; i++) spare[begins[STRETCH(keys[i])]++] = keys[i];
#undef STRETCH
    /* Each begin has moved to its stretch's end. */
    for (size_t i = 0, begin = 0; i < n; begin = begins[i++]) {
        const size_t count = begins[i] - begin;
        if (count > FEW)
            gsl_heapsort(spare + begin, count, sizeof *spare, compare);
        else
            insert_each(spare + begin, count);
    }
}

/* Puts the kernels into the order of their enters. */
static void put_in_order(ssfr_line *line)
{
    key *keys = line->keys, *sorted = keys + line->capacity;
    ssfr_line_kernel *kernels = line->spare;
    if (line->n < 2) return;
    for (size_t i = 0; i < line->n; i++) keys[i] = (key){line->kernels[i].enters, line->kernels[i].index, (uint32_t)i};
    sort(keys, sorted, line->begins, line->n);
    for (size_t i = 0; i < line->n; i++) kernels[i] = line->kernels[sorted[i].slot];
    line->spare = line->kernels;
    line->kernels = kernels;
}

/* The most that any kernel's enters and leaves are off by. */
static double find_margin(const ssfr_line *line)
{
    const size_t n = line->fluid->inverse || line->n == 0 ? line->n : 1; /* else all are alike */
    double most = 0;
    for (size_t i = 0; i < n; i++) {
        const double off = line->digits * line->kernels[i].steep;
        most = fmax(most, (sqrt(doubt_of(off)) + off) / sqrt(line->kernels[i].stretch));
    }
    return most + line->digits;
}

ssfr_result ssfr_line_cast(ssfr_line *line, const ssfr_ray *ray, double from, double to)
{
    gathering g = {.line = line};
    line->ray = *ray;
    line->from = from;
    line->to = to;
    line->n = 0;
    line->longest = line->hidden = 0;
    line->hidden_at = INFINITY;
    ssfr_boxes_along(&line->fluid->boxes, ray, from, to, gather, &g);
    if (g.result != SSFR_OK) {
        line->n = 0;
        return g.result;
    }
    line->digits = place_error * (from_origin(ray) + g.farthest + line->longest + sqrt(g.widest2));
    line->margin = find_margin(line);
    put_in_order(line);
    return SSFR_OK;
}

/* ---- the fluid along the line ------------------------------------------------------------------------------------ */

/* The first kernel that may reach t: all before it have left. */
static size_t first_at(const ssfr_line *line, double t)
{
    /* What leaves - enters was rounded by. */
    const double least = t - line->longest - 2 * DBL_EPSILON * (fabs(t) + line->longest);
    size_t begin = 0, end = line->n;
    while (begin < end) {
        const size_t middle = begin + (end - begin) / 2;
        if (line->kernels[middle].enters < least)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

double ssfr_line_density(const ssfr_line *line, double t)
{
    const ssfr_radial *radial = line->fluid->radial;
    double sum = 0;
    for (size_t i = first_at(line, t); i < line->n && line->kernels[i].enters <= t; i++) {
        const ssfr_line_kernel *k = line->kernels + i;
        if (t > k->leaves) continue;
        const double along = t - k->middle;
        sum += k->weight * (radial ? ssfr_radial_value(radial, sqrt(k->near2 + k->stretch * along * along)) : 1);
    }
    return sum;
}

/* Half of what the ray has in a kernel is sqrt(1 - near2): steep where the ray grazes it. */
double ssfr_line_rim_err(const ssfr_line *line, const ssfr_line_kernel *k, bool *grazes)
{
    const double off = line->digits * k->steep, doubt = doubt_of(off), speed = sqrt(k->stretch);
    const double left = 1 - k->near2, half = sqrt(left), most = sqrt(left + doubt);
    const double least = left > doubt ? sqrt(left - doubt) : 0;
    *grazes = left <= doubt;
    return (fmax(most - half, half - least) + off) / speed + 2 * DBL_EPSILON * (fabs(k->middle) + half / speed);
}

/* What the line collects of one kernel between two places in its support, m times its weight's unit. */
static double chord_of(const ssfr_radial *radial, const ssfr_line_kernel *k, double a, double b)
{
    const double speed = sqrt(k->stretch), aside = sqrt(k->near2);
    if (a <= k->enters && b >= k->leaves) return k->weight * 2 * ssfr_radial_chord(radial, aside, 1) / speed;
    const double before = a <= k->enters ? -1 : (a - k->middle) * speed;
    const double after = b >= k->leaves ? 1 : (b - k->middle) * speed;
    return k->weight * (ssfr_radial_chord(radial, aside, after) - ssfr_radial_chord(radial, aside, before)) / speed;
}

/* How much a kernel's chord may change when the kernel is moved by `off`, in supports and of weight 1. Along the ray:
 * what stands at the ends that cut it. Aside: the chord's slope is -aside int steepness ds over the way through the
 * kernel, and steepness falls with q. */
static double kernel_slack(const ssfr_radial *radial, const ssfr_line_kernel *k, double off, bool is_cut)
{
    const double aside = sqrt(k->near2), least = fmax(aside - off, 0);
    const double way = 2 - least * least; /* 2 sqrt(1 - least^2) is no more */
    const double slope = (aside + off) * ssfr_radial_steepness(radial, least) * way;
    return off * (slope + (is_cut ? 2 * ssfr_radial_value(radial, 0) : 0));
}

static double kernel_chords(const ssfr_line *line, size_t begin, double a, double b, double *err)
{
    const ssfr_radial *radial = line->fluid->radial;
    /* A chord is the difference of two; its factors round it three times more. */
    const double own = 2 * radial->chord_err + 4 * DBL_EPSILON * ssfr_radial_chord(radial, 0, 1);
    ssfr_sum sum = {0};
    for (size_t i = begin; i < line->n && line->kernels[i].enters < b; i++) {
        const ssfr_line_kernel *k = line->kernels + i;
        const bool is_cut = a > k->enters - line->margin || b < k->leaves + line->margin;
        if (k->leaves <= a) continue;
        ssfr_sum_add(&sum, chord_of(radial, k, a, b));
        *err += k->weight / sqrt(k->stretch) * (own + kernel_slack(radial, k, line->digits * k->steep, is_cut));
    }
    return ssfr_sum_total(&sum);
}

/* Spheres just before a, or behind b, may by their error reach into what is asked for. */
static double sphere_chords(const ssfr_line *line, size_t begin, double a, double b, double *err)
{
    ssfr_sum sum = {0};
    for (size_t i = begin; i < line->n && line->kernels[i].enters < b + line->margin; i++) {
        const ssfr_line_kernel *k = line->kernels + i;
        bool grazes;
        if (k->leaves <= a - line->margin) continue;
        ssfr_sum_add(&sum, k->weight * fmax(fmin(b, k->leaves) - fmax(a, k->enters), 0));
        *err += 2 * k->weight * ssfr_line_rim_err(line, k, &grazes);
    }
    *err += line->hidden;
    return ssfr_sum_total(&sum);
}

double ssfr_line_chords(const ssfr_line *line, double a, double b, double *err)
{
    double doubt = 0, total = 0;
    if (a < b) {
        const size_t begin = first_at(line, a - line->margin);
        total = (line->fluid->radial ? kernel_chords : sphere_chords)(line, begin, a, b, &doubt);
    }
    if (err) *err = doubt + DBL_EPSILON * fabs(total);
    return total;
}

/* ---- breaks ------------------------------------------------------------------------------------------------------ */

static ssfr_result reserve_breaks(ssfr_line *line, size_t n)
{
    ssfr_result result = SSFR_OK;
    double *breaks = NULL;
    if (n <= line->breaks_capacity) return SSFR_OK;
    SSFR_TRY(ssfr_alloc(&breaks, 2 * n, sizeof *breaks, "break points"));
    free(line->breaks);
    line->breaks = breaks;
    line->breaks_capacity = 2 * n;
end:
    return result;
}

/* Appends what of a kernel lies in (a, b): its begin and end, where the pieces that it is made of meet, and its middle
 * where the density nearly has a kink. */
static size_t add_breaks(const ssfr_line *line, const ssfr_line_kernel *k, double a, double b, double *all, size_t n)
{
    const double seam = line->fluid->radial ? line->fluid->radial->seam : 1;
    const double within = seam < 1 && k->near2 < seam * seam ? sqrt((seam * seam - k->near2) / k->stretch) : 0;
    const bool is_sharp = line->fluid->radial && !line->fluid->radial->even && k->near2 < ssfr_square(sharp * seam);
    const double places[] = {k->enters, k->leaves, is_sharp ? k->middle : a, k->middle - within, k->middle + within};
    for (int i = 0; i < (within > 0 ? 5 : 3); i++)
        if (places[i] > a && places[i] < b) all[n++] = places[i];
    return n;
}

ssfr_result ssfr_line_breaks(ssfr_line *line, double a, double b, size_t *n, const double **breaks)
{
    ssfr_result result = SSFR_OK;
    size_t found = 0, kept = 1;
    *n = 0;
    *breaks = NULL;
    SSFR_TRY(reserve_breaks(line, 5 * line->n + 2));
    double *all = line->breaks;
    all[found++] = a;
    for (size_t i = 0; i < line->n; i++) found = add_breaks(line, line->kernels + i, a, b, all, found);
    all[found++] = b;
    gsl_heapsort(all, found, sizeof *all, ssfr_by_value);
    for (size_t i = 1; i < found; i++)
        if (all[i] > all[kept - 1]) all[kept++] = all[i];
    *n = kept;
    *breaks = all;
end:
    return result;
}

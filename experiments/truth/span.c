/* SPDX-License-Identifier: GPL-3.0-or-later */
/* span.c: bounds of the field and its slope by intervals, kernel by kernel.
 *
 * Rounding. Each kernel's place is off by the line's `digits` at most, in any direction, and its q by a few units in
 * the last place. Both change its value by no more than its own slope there tells; sums of n terms add n units. */
#include "experiments/truth/span.h"

#include <float.h>

struct ssfr_span_kernel {
    double leaves, middle, near2, stretch, weight; /* as the line has them */
    double steep;     /* 1/m: q changes by no more than this with a place, in any direction */
    double doubt;     /* what rounding may have done to q */
    double across[2]; /* m, from the kernel's middle to the ray; zhu_bridson */
    uint32_t index;   /* of the line's kernels */
};
typedef struct ssfr_span_kernel kernel;

/* Units in the last place by which a term of a sum may be off, and its sum for each of n terms. */
static const double term_error = 8 * DBL_EPSILON, sum_error = 0.5 * DBL_EPSILON;

void ssfr_span_init(ssfr_span *span)
{
    *span = (ssfr_span){0};
}

void ssfr_span_finish(ssfr_span *span)
{
    free(span->kernels);
    *span = (ssfr_span){0};
}

/* ---- which kernels ----------------------------------------------------------------------------------------------- */

static bool is_mean(const ssfr_span *span)
{
    return span->line->fluid->kind == SSFR_CONTINUUM_ZHU_BRIDSON;
}

void ssfr_span_begin(ssfr_span *span, const ssfr_line *line)
{
    const double *dir = line->ray.dir;
    double axis[3] = {0};
    int least = 0;
    for (int c = 1; c < 3; c++)
        if (fabs(dir[c]) < fabs(dir[least])) least = c;
    axis[least] = 1;
    span->line = line;
    span->n = span->next = 0;
    ssfr_cross(dir, axis, span->across[0]);
    ssfr_normalize(span->across[0]);
    ssfr_cross(dir, span->across[0], span->across[1]);
}

double ssfr_span_next(const ssfr_span *span)
{
    return span->next < span->line->n ? span->line->kernels[span->next].enters : INFINITY;
}

static ssfr_result reserve(ssfr_span *span)
{
    ssfr_result result = SSFR_OK;
    kernel *kernels = NULL;
    if (span->n < span->capacity) return SSFR_OK;
    const size_t wanted = 2 * span->n + 256;
    SSFR_TRY(ssfr_alloc(&kernels, wanted, sizeof *kernels, "kernels along a piece of a ray"));
    if (span->n > 0) memcpy(kernels, span->kernels, span->n * sizeof *kernels);
    free(span->kernels);
    span->kernels = kernels;
    span->capacity = wanted;
end:
    return result;
}

static void take(ssfr_span *span, size_t i)
{
    const ssfr_line_kernel *k = span->line->kernels + i;
    span->kernels[span->n++] = (kernel){
        .leaves = k->leaves, .middle = k->middle, .near2 = k->near2, .stretch = k->stretch, .weight = k->weight,
        .steep = k->steep, .doubt = k->steep * span->line->digits + 2 * DBL_EPSILON,
        .across = {ssfr_dot(k->aside, span->across[0]), ssfr_dot(k->aside, span->across[1])}, .index = (uint32_t)i};
}

/* No kernel is curved more than in its middle, where it is by m(0): so much its slope changes with q, and so much more
 * than its slope tells its value changes. */
static void find_slack(ssfr_span *span)
{
    const double most = ssfr_radial_steepness(span->line->fluid->radial, 0);
    double slope = 0, value = 0;
    for (size_t i = 0; i < span->n; i++) {
        const kernel *k = span->kernels + i;
        slope += k->weight * k->steep * (k->doubt + term_error + (double)span->n * sum_error);
        value += k->weight * k->doubt * k->doubt;
    }
    span->slope_slack = slope * most;
    span->value_slack = value * most;
}

ssfr_result ssfr_span_move(ssfr_span *span, double a, double b)
{
    ssfr_result result = SSFR_OK;
    const ssfr_line *line = span->line;
    const double margin = line->margin;
    size_t kept = 0;
    span->known[0] = span->known[1] = NAN;
    for (size_t i = 0; i < span->n; i++)
        if (span->kernels[i].leaves > a - margin) span->kernels[kept++] = span->kernels[i];
    span->n = kept;
    for (; span->next < line->n && line->kernels[span->next].enters < b + margin; span->next++) {
        if (line->kernels[span->next].leaves <= a - margin) continue;
        SSFR_TRY(reserve(span));
        take(span, span->next);
    }
    if (!is_mean(span)) find_slack(span);
end:
    return result;
}

/* ---- one kernel between two places ------------------------------------------------------------------------------- */

/* How far along the ray a kernel's middle is: from lo to hi; the least and the greatest distance; m. */
typedef struct along {
    double lo, hi, near, far;
} along;

static inline along along_of(const kernel *k, double a, double b)
{
    const double lo = a - k->middle, hi = b - k->middle;
    const double before = fabs(lo), behind = fabs(hi);
    return (along){lo, hi, lo > 0 ? lo : hi < 0 ? behind : 0, before > behind ? before : behind};
}

static inline double q2_at(const kernel *k, double distance)
{
    return k->near2 + k->stretch * distance * distance;
}

typedef struct range {
    double lo, hi;
} range;

/* Of (t - middle) m, m from least to most, neither negative. */
static inline range product(const along *t, double least, double most)
{
    return (range){t->lo * (t->lo < 0 ? most : least), t->hi * (t->hi > 0 ? most : least)};
}

static inline double greater(double a, double b)
{
    return a > b ? a : b;
}

static inline double less(double a, double b)
{
    return a < b ? a : b;
}

/* ---- density: f = sum weight w - level --------------------------------------------------------------------------- */

static int density_side(const ssfr_span *span, double a, double b)
{
    const ssfr_radial *radial = span->line->fluid->radial;
    const double level = span->line->fluid->level, steepest = ssfr_radial_steepness(radial, 0);
    double lo = 0, hi = 0, doubt = 0;
    for (size_t i = 0; i < span->n; i++) {
        const kernel *k = span->kernels + i;
        const along t = along_of(k, a, b);
        const double nearest2 = q2_at(k, t.near), farthest2 = q2_at(k, t.far);
        if (farthest2 < 1) lo += k->weight * ssfr_radial_value(radial, sqrt(farthest2));
        if (nearest2 < 1) hi += k->weight * ssfr_radial_value(radial, sqrt(nearest2));
        doubt += k->weight * k->doubt;
    }
    /* No slope of w is steeper than m(0). */
    const double err = doubt * steepest + ((double)span->n * sum_error + term_error) * (hi + level);
    return lo - level > err ? 1 : hi - level < -err ? -1 : 0;
}

static ssfr_span_value density_at(const ssfr_span *span, double at)
{
    const ssfr_radial *radial = span->line->fluid->radial;
    const double level = span->line->fluid->level;
    double sum = 0, slope = 0, doubt = 0;
    for (size_t i = 0; i < span->n; i++) {
        const kernel *k = span->kernels + i;
        const double t = at - k->middle, q2 = q2_at(k, t);
        if (!(q2 < 1)) continue;
        const double q = sqrt(q2);
        double m;
        sum += k->weight * ssfr_radial_both(radial, q, &m);
        slope -= k->weight * k->stretch * t * m;
        doubt += k->weight * m * q * k->doubt;
    }
    const double rounding = ((double)span->n * sum_error + term_error) * (sum + level);
    return (ssfr_span_value){sum - level, slope, doubt + span->value_slack + rounding};
}

static ssfr_span_bounds density_bound(const ssfr_span *span, double a, double b)
{
    const ssfr_radial *radial = span->line->fluid->radial;
    const double level = span->line->fluid->level, middle = a + 0.5 * (b - a);
    double lo = 0, hi = 0, rise_lo = 0, rise_hi = 0, doubt = 0;
    for (size_t i = 0; i < span->n; i++) {
        const kernel *k = span->kernels + i;
        const along t = along_of(k, a, b);
        const double nearest2 = q2_at(k, t.near), farthest2 = q2_at(k, t.far);
        double least = 0, most;
        if (!(nearest2 < 1)) continue;
        hi += k->weight * ssfr_radial_both(radial, sqrt(nearest2), &most);
        if (farthest2 < 1) lo += k->weight * ssfr_radial_both(radial, sqrt(farthest2), &least);
        const range slope = product(&t, least, most);
        rise_lo -= k->weight * k->stretch * slope.hi;
        rise_hi -= k->weight * k->stretch * slope.lo;
        doubt += k->weight * most * less(sqrt(farthest2), 1) * k->doubt;
    }
    const ssfr_span_value centre = density_at(span, middle);
    const double err = doubt + span->value_slack + ((double)span->n * sum_error + term_error) * (hi + level);
    const double slack = span->slope_slack;
    const double change = (greater(middle - a, b - middle)) * greater(slack - rise_lo, rise_hi + slack);
    return (ssfr_span_bounds){.lo = greater(lo - level - err, centre.value - centre.err - change),
                              .hi = less(hi - level + err, centre.value + centre.err + change),
                              .slope_lo = rise_lo - slack, .slope_hi = rise_hi + slack, .err = err};
}

/* m, from the kernel's middle to the ray's place. */
static void offset_of(const ssfr_span *span, const kernel *k, double t, double out[3])
{
    const double *aside = span->line->kernels[k->index].aside;
    for (int c = 0; c < 3; c++) out[c] = aside[c] + (t - k->middle) * span->line->ray.dir[c];
}

static void multiply(const double m[6], double v[3])
{
    const double x = v[0], y = v[1], z = v[2];
    v[0] = m[0] * x + m[1] * y + m[2] * z;
    v[1] = m[1] * x + m[3] * y + m[4] * z;
    v[2] = m[2] * x + m[4] * y + m[5] * z;
}

/* The angle by which a vector that is `wrong` by so much may be off. */
static double angle_of(double wrong, double length)
{
    return wrong < length ? asin(wrong / length) + 2 * DBL_EPSILON : M_PI;
}

/* The gradient's direction: sum weight m A^-2 (x - x_i). Along a way of `off` it changes by no more than what the
 * kernels are curved, which is most in their middles. */
static void density_normal(const ssfr_span *span, double at, double off, double normal[3], double *err)
{
    const ssfr_continuum *fluid = span->line->fluid;
    const double support2 = fluid->support * fluid->support, most = ssfr_radial_steepness(fluid->radial, 0);
    double total = 0, curved = 0, sum[3] = {0};
    for (size_t i = 0; i < span->n; i++) {
        const kernel *k = span->kernels + i;
        const double q = sqrt(q2_at(k, at - k->middle)), steep2 = k->steep * k->steep;
        double e[3];
        if (!(q - k->steep * off < 1)) continue;
        offset_of(span, k, at, e);
        const double share = k->weight * ssfr_radial_steepness(fluid->radial, q), length = sqrt(ssfr_dot(e, e));
        if (fluid->inverse) {
            const double *m = fluid->inverse[span->line->kernels[k->index].index];
            multiply(m, e), multiply(m, e);
        }
        for (int c = 0; c < 3; c++) sum[c] += share / support2 * e[c];
        curved += k->weight * steep2 * most;
        total += share * steep2 * length;
    }
    const double wrong = curved * off + total * (4 * term_error + (double)span->n * sum_error);
    *err = angle_of(wrong, ssfr_normalize(sum));
    memcpy(normal, sum, sizeof sum);
}

/* ---- zhu_bridson: f = r^2 K^2 - |S|^2 ---------------------------------------------------------------------------- */

/* K and the three parts of S: along the ray and across. */
enum { PARTS = 4 };

/* Of k = y^3, y = 1 - q^2, with q from nearest to farthest; k is -stretch (t - middle) m along the ray, m = 6 y^2. */
typedef struct weighing {
    range k, m;
} weighing;

static inline weighing weigh(const kernel *k, const along *t)
{
    const double nearest2 = q2_at(k, t->near), farthest2 = q2_at(k, t->far);
    const double most = greater(1 - nearest2, 0), least = greater(1 - farthest2, 0);
    return (weighing){{least * least * least, most * most * most}, {6 * least * least, 6 * most * most}};
}

typedef struct mean_sums {
    range part[PARTS], slope[PARTS]; /* slopes are those along the ray */
    double k_doubt, slope_doubt;     /* of K and of its slope; times the support, of S */
    double slopes;                   /* 1/m, all terms of the slope of K together */
} mean_sums;

/* m, by which rounding may have moved a place in a kernel. */
static double blur_of(const ssfr_span *span)
{
    return span->line->digits + term_error * span->line->fluid->support;
}

static inline void extend(range *sum, double factor, range term)
{
    sum->lo += factor * (factor < 0 ? term.hi : term.lo);
    sum->hi += factor * (factor < 0 ? term.lo : term.hi);
}

static void mean_add(mean_sums *s, const kernel *k, double a, double b, double blur)
{
    const along t = along_of(k, a, b);
    /* What rounding may have hidden of a kernel that just begins. */
    const double off = 2 * k->doubt + DBL_EPSILON, y = greater(1 - q2_at(k, t.near) + off, 0);
    if (!(y > 0)) return; /* it begins elsewhere */
    const weighing w = weigh(k, &t);
    const range turn = product(&t, w.m.lo, w.m.hi), slope = {-k->stretch * turn.hi, -k->stretch * turn.lo};
    extend(&s->part[0], 1, w.k);
    s->part[1].lo += t.lo * (t.lo < 0 ? w.k.hi : w.k.lo);
    s->part[1].hi += t.hi < 0 ? t.hi * w.k.lo : t.hi * w.k.hi;
    extend(&s->part[2], k->across[0], w.k);
    extend(&s->part[3], k->across[1], w.k);
    extend(&s->slope[0], 1, slope);
    extend(&s->slope[1], 1, (range){w.k.lo - k->stretch * t.far * t.far * w.m.hi,
                                    w.k.hi - k->stretch * t.near * t.near * w.m.lo});
    extend(&s->slope[2], k->across[0], slope);
    extend(&s->slope[3], k->across[1], slope);
    s->k_doubt += 3 * y * y * off;
    s->slope_doubt += k->stretch * (6 * y + 24) * y * blur;
    s->slopes += k->stretch * t.far * w.m.hi;
}

/* Bounds of f and its slope from those of its parts. */
static ssfr_span_bounds mean_join(const ssfr_span *span, const mean_sums *s)
{
    const ssfr_continuum *fluid = span->line->fluid;
    const double r2 = fluid->radius * fluid->radius, support = fluid->support, digits = span->line->digits;
    const double rounding = (double)span->n * sum_error + term_error, k_most = s->part[0].hi;
    const double k_err = s->k_doubt + rounding * k_most, s_err = support * k_err + digits * k_most;
    const double rise_err = s->slope_doubt + rounding * s->slopes;
    const double turn_err = k_err + support * rise_err + digits * s->slopes;
    range f = {0, 0}, slope = {0, 0};
    double err = 0, slope_err = 0;
    for (int p = 0; p < PARTS; p++) {
        const range v = s->part[p], d = s->slope[p];
        const double factor = p == 0 ? r2 : -1;
        const double most = greater(-v.lo, v.hi), fast = greater(-d.lo, d.hi);
        const double least = v.lo > 0 ? v.lo : v.hi < 0 ? -v.hi : 0;
        const double corners[4] = {v.lo * d.lo, v.lo * d.hi, v.hi * d.lo, v.hi * d.hi};
        const double v_err = p == 0 ? k_err : s_err, d_err = p == 0 ? rise_err : turn_err;
        extend(&f, factor, (range){least * least, most * most});
        extend(&slope, 2 * factor, (range){less(less(corners[0], corners[1]), less(corners[2], corners[3])),
                                           greater(greater(corners[0], corners[1]), greater(corners[2], corners[3]))});
        err += fabs(factor) * ((2 * most + v_err) * v_err + term_error * most * most);
        slope_err += 2 * fabs(factor) * ((most + v_err) * d_err + fast * v_err + term_error * most * fast);
    }
    return (ssfr_span_bounds){f.lo - err, f.hi + err, slope.lo - slope_err, slope.hi + slope_err, err};
}

/* Whether all kernels that count from a to b have their middles farther than r behind a plane that moves with the ray's
 * place: so has any mean of them, be the weights ever so small. */
static bool mean_is_far(const ssfr_span *span, const double towards[3], double a, double b)
{
    const double length = sqrt(ssfr_dot(towards, towards));
    const ssfr_continuum *fluid = span->line->fluid;
    const double r = fluid->radius + term_error * (fluid->radius + fluid->support) + 2 * span->line->digits;
    for (size_t i = 0; i < span->n; i++) {
        const kernel *k = span->kernels + i;
        const along t = along_of(k, a, b);
        if (q2_at(k, t.near) > 1 + 4 * k->doubt) continue;
        const double least = towards[0] > 0 ? t.lo : t.hi;
        if (!(towards[0] * least + towards[1] * k->across[0] + towards[2] * k->across[1] > r * length)) return false;
    }
    return true;
}

/* From the kernels' mean to the ray's place, or where none weighs from their middles'. */
static void mean_direction(const ssfr_span *span, double at, double out[3])
{
    double weighed[3] = {0}, plain[3] = {0};
    for (size_t i = 0; i < span->n; i++) {
        const kernel *k = span->kernels + i;
        const double t = at - k->middle, y = greater(1 - q2_at(k, t), 0), e[3] = {t, k->across[0], k->across[1]};
        for (int c = 0; c < 3; c++) weighed[c] += y * y * y * e[c], plain[c] += e[c];
    }
    memcpy(out, ssfr_dot(weighed, weighed) > 0 ? weighed : plain, sizeof weighed);
}

/* At one place: the same numbers for a third of the work. */
static void mean_add_at(double part[PARTS], double slope[PARTS], mean_sums *s, const kernel *k, double at, double blur)
{
    const double t = at - k->middle, q2 = q2_at(k, t), far = fabs(t);
    const double off = 2 * k->doubt + DBL_EPSILON, y = greater(1 - q2 + off, 0), exact = greater(1 - q2, 0);
    const double w = exact * exact * exact, m = 6 * exact * exact, rise = -k->stretch * (t * m);
    if (!(y > 0)) return;
    part[0] += w;
    part[1] += t * w;
    part[2] += k->across[0] * w;
    part[3] += k->across[1] * w;
    slope[0] += rise;
    slope[1] += w - k->stretch * far * far * m;
    slope[2] += k->across[0] * rise;
    slope[3] += k->across[1] * rise;
    s->k_doubt += 3 * y * y * off;
    s->slope_doubt += k->stretch * (6 * y + 24) * y * blur;
    s->slopes += k->stretch * far * m;
}

static mean_sums mean_sum_at(const ssfr_span *span, double at)
{
    const double blur = blur_of(span);
    double part[PARTS] = {0}, slope[PARTS] = {0};
    mean_sums s = {0};
    for (size_t i = 0; i < span->n; i++) mean_add_at(part, slope, &s, span->kernels + i, at, blur);
    for (int p = 0; p < PARTS; p++) s.part[p] = (range){part[p], part[p]}, s.slope[p] = (range){slope[p], slope[p]};
    return s;
}

static mean_sums mean_sum(const ssfr_span *span, double a, double b)
{
    const double blur = blur_of(span);
    mean_sums s = {0};
    if (!(a < b)) return mean_sum_at(span, a);
    for (size_t i = 0; i < span->n; i++) mean_add(&s, span->kernels + i, a, b, blur);
    return s;
}

static ssfr_span_bounds find_mean_bound(const ssfr_span *span, double a, double b)
{
    const double middle = a + 0.5 * (b - a), half = greater(middle - a, b - middle);
    mean_sums s = mean_sum(span, a, b), centre = a < b ? mean_sum(span, middle, middle) : s;
    for (int p = 0; a < b && p < PARTS; p++) {
        const double change = half * greater(-s.slope[p].lo, s.slope[p].hi);
        s.part[p].lo = greater(s.part[p].lo, centre.part[p].lo - change);
        s.part[p].hi = less(s.part[p].hi, centre.part[p].hi + change);
    }
    ssfr_span_bounds out = mean_join(span, &s);
    const ssfr_span_bounds at = mean_join(span, &centre);
    const double change = half * greater(-out.slope_lo, out.slope_hi);
    out.lo = greater(out.lo, at.lo - change);
    out.hi = less(out.hi, at.hi + change);
    return out;
}

/* Who asks for a side and does not learn it asks for the bounds next. */
static ssfr_span_bounds mean_bound(ssfr_span *span, double a, double b)
{
    if (!(span->known[0] == a && span->known[1] == b)) span->bounds = find_mean_bound(span, a, b);
    span->known[0] = a, span->known[1] = b;
    return span->bounds;
}

static int mean_side(ssfr_span *span, double a, double b)
{
    double towards[3];
    mean_direction(span, a + 0.5 * (b - a), towards);
    if (mean_is_far(span, towards, a, b)) return -1;
    const ssfr_span_bounds bounds = mean_bound(span, a, b);
    return bounds.lo > 0 ? 1 : bounds.hi < 0 ? -1 : 0;
}

static ssfr_span_value mean_at(ssfr_span *span, double t)
{
    const ssfr_span_bounds bounds = mean_bound(span, t, t);
    return (ssfr_span_value){0.5 * (bounds.lo + bounds.hi), 0.5 * (bounds.slope_lo + bounds.slope_hi), bounds.err};
}

/* From the mean to the ray's place, m; gives K. */
static double mean_offset(const ssfr_span *span, double at, double out[3])
{
    double weight = 0, e[3];
    memset(out, 0, sizeof e);
    for (size_t i = 0; i < span->n; i++) {
        const kernel *k = span->kernels + i;
        const double y = greater(1 - q2_at(k, at - k->middle), 0);
        offset_of(span, k, at, e);
        weight += y * y * y;
        for (int c = 0; c < 3; c++) out[c] += y * y * y * e[c];
    }
    for (int c = 0; c < 3 && weight > 0; c++) out[c] /= weight;
    return weight;
}

/* Out of the fluid points what grad |x - xm| is on the surface,
 *
 *      -grad f / (2 K) = K s - sum (r^2 - s . (x - x_i)) grad k_i,   s = x - xm.
 *
 * Its error takes bounds on the derivatives of K and S: the sums of |k|, |grad k| and |grad grad k| close by. */
static void mean_normal(const ssfr_span *span, double at, double off, double normal[3], double *err)
{
    const ssfr_continuum *fluid = span->line->fluid;
    const double h = fluid->support, r2 = fluid->radius * fluid->radius;
    double s[3], e[3], sum[3], most = 0, steep = 0, curved = 0;
    const double weight = mean_offset(span, at, s), r = sqrt(ssfr_dot(s, s));
    for (int c = 0; c < 3; c++) sum[c] = weight * s[c];
    for (size_t i = 0; i < span->n; i++) {
        const kernel *k = span->kernels + i;
        const double left = 1 - q2_at(k, at - k->middle), y = greater(left, 0);
        const double close = greater(left + 2 * k->steep * off + 4 * k->doubt, 0);
        offset_of(span, k, at, e);
        const double share = 6 * y * y / (h * h) * (r2 - ssfr_dot(s, e));
        for (int c = 0; c < 3; c++) sum[c] += share * e[c];
        most += close * close * close;
        steep += 6 * close * close / h;
        curved += (6 * close + 24) * close / (h * h);
    }
    const double bent = r2 * (steep * steep + most * curved) + ssfr_square(most + h * steep) +
                        most * r * (2 * steep + h * curved);
    const double rounded = (r2 * steep + most * r + h * r * steep) * (4 * term_error + 2 * (double)span->n * sum_error);
    *err = weight > 0 ? angle_of(bent / weight * off + rounded, ssfr_normalize(sum)) : M_PI;
    memcpy(normal, sum, sizeof sum);
}

/* ---- either ------------------------------------------------------------------------------------------------------ */

int ssfr_span_side(ssfr_span *span, double a, double b)
{
    span->evaluations++;
    return is_mean(span) ? mean_side(span, a, b) : density_side(span, a, b);
}

ssfr_span_bounds ssfr_span_bound(ssfr_span *span, double a, double b)
{
    span->evaluations++;
    return is_mean(span) ? mean_bound(span, a, b) : density_bound(span, a, b);
}

ssfr_span_value ssfr_span_at(ssfr_span *span, double t)
{
    span->evaluations++;
    return is_mean(span) ? mean_at(span, t) : density_at(span, t);
}

int ssfr_span_side_at(ssfr_span *span, double t)
{
    span->evaluations++;
    if (is_mean(span)) return mean_side(span, t, t);
    const ssfr_span_value at = density_at(span, t);
    return at.value > at.err ? 1 : at.value < -at.err ? -1 : 0;
}

void ssfr_span_normal(ssfr_span *span, double t, double t_err, double normal[3], double *err)
{
    const double off = t_err + span->line->digits;
    if (is_mean(span))
        mean_normal(span, t, off, normal, err);
    else
        density_normal(span, t, off, normal, err);
}

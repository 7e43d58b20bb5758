/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sampled.c: the ratio estimate of a stratified sample with one pixel a stratum, and its interval. */
#include "experiments/sampled.h"

#include "base/field.h"

#include <gsl/gsl_cdf.h>

static const double level = 0.95;
enum { MIN_COUNTED = 10 }; /* pixels: fewer of skewed values held in 82 instead of 95 of 100 samples */

/* ---- the sample -------------------------------------------------------------------------------------------------- */

typedef struct stratum { /* the pixel known of a square */
    double share;   /* W_h, of the image's pixels */
    double sum, n;  /* s_h, n_h */
    bool known;     /* the square has no other pixel */
} stratum;

static bool is_cast(const ssfr_field *cast, int x, int y)
{
    return *ssfr_field_at(cast, x, y) != 0;
}

/* How many pixels of a square are cast, and one of them. */
static int find_cast(const ssfr_field *cast, int every, int square_x, int square_y, int *x, int *y)
{
    const int x0 = square_x * every, y0 = square_y * every;
    int n = 0;
    for (int j = y0; j < ssfr_min_int(y0 + every, cast->h); j++)
        for (int i = x0; i < ssfr_min_int(x0 + every, cast->w); i++)
            if (is_cast(cast, i, j)) *x = i, *y = j, n++;
    return n;
}

static int squares(int px, int every)
{
    return (px + every - 1) / every;
}

static bool is_sample(const ssfr_field *cast, int every)
{
    bool is = true;
    int x, y;
    for (int j = 0; j < squares(cast->h, every) && is; j++)
        for (int i = 0; i < squares(cast->w, every) && is; i++) is = find_cast(cast, every, i, j, &x, &y) == 1;
    return is;
}

ssfr_result ssfr_sampled_find(const ssfr_field *cast, const char *path, int *every)
{
    const int largest = ssfr_max_int(cast->w, cast->h);
    size_t n = 0;
    for (int y = 0; y < cast->h; y++)
        for (int x = 0; x < cast->w; x++) n += is_cast(cast, x, y);
    for (*every = 1; *every <= largest; (*every)++)
        if ((size_t)squares(cast->w, *every) * (size_t)squares(cast->h, *every) == n && is_sample(cast, *every))
            return SSFR_OK;
    return ssfr_fail(SSFR_ERR_VALUE, "%s: cast is not 0 at %zu of %dx%d pixels, which are not one of each square", path,
                     n, cast->w, cast->h);
}

/* All squares, row by row, every second row backwards: who comes next is next. */
static void list_strata(const ssfr_field *cast, int every, ssfr_sampled_fn *value, const void *user, stratum *out)
{
    const size_t many = 10000; /* fewer are done before threads have begun */
    const int across = squares(cast->w, every), down = squares(cast->h, every);
#pragma omp parallel for schedule(static) if ((size_t)across * (size_t)down > many)
    for (int j = 0; j < down; j++)
        for (int i = 0; i < across; i++) {
            stratum *s = &out[(size_t)j * (size_t)across + (size_t)(j % 2 ? across - 1 - i : i)];
            const int w = ssfr_min_int(every, cast->w - i * every), h = ssfr_min_int(every, cast->h - j * every);
            int x = 0, y = 0;
            find_cast(cast, every, i, j, &x, &y);
            s->share = (double)w * h / ((double)cast->w * cast->h);
            s->known = w * h == 1;
            value(user, x, y, &s->sum, &s->n);
        }
}

/* ---- the interval ------------------------------------------------------------------------------------------------ */

typedef struct spread { /* of groups of strata */
    double variance, squares; /* the sum of theirs, and of their squares */
    size_t groups;            /* that know anything */
} spread;

/* Takes n strata for one, n of 2 or 3; d is what each adds to the mean's deviation. */
static void collapse(size_t n, const stratum *strata, const double *d, spread *out)
{
    double mean = 0, variance = 0;
    bool known = true, counts = false;
    for (size_t i = 0; i < n; i++) {
        mean += d[i] / (double)n;
        known &= strata[i].known;
        counts |= strata[i].n > 0;
    }
    if (known || !counts) return;
    for (size_t i = 0; i < n; i++) variance += ssfr_square(d[i] - mean) * (double)n / (double)(n - 1);
    out->variance += variance;
    out->squares += ssfr_square(variance);
    out->groups++;
}

/* A pair's variance is known with one degree of freedom, so that its square is thrice too large in the mean. */
static double degrees_of(const spread *s)
{
    const double degrees = s->squares > 0 ? 3 * ssfr_square(s->variance) / s->squares - 2 : (double)s->groups;
    return ssfr_clamp(degrees, 1, (double)s->groups);
}

/* Half the interval's width. */
static double half_width(size_t n, const stratum *strata, const double *d)
{
    spread s = {0};
    for (size_t i = 0; i + 1 < n;) {
        const size_t group = n - i == 3 ? 3 : 2; /* an odd one joins the last pair */
        collapse(group, strata + i, d + i, &s);
        i += group;
    }
    if (s.groups == 0) return INFINITY;
    return gsl_cdf_tdist_Pinv(0.5 + level / 2, degrees_of(&s)) * sqrt(s.variance);
}

/* Of n strata. What the sample may have missed, whatever it is worth, within the range of values. */
static ssfr_result estimate(size_t n, const stratum *strata, ssfr_sampled_range range, ssfr_sampled *out)
{
    ssfr_result result = SSFR_OK;
    double *d = NULL;
    double sum = 0, base = 0, largest = 0; /* of squares that are not known */
    size_t counted = 0;
    bool known = true;
    SSFR_TRY(ssfr_alloc(&d, n, sizeof *d, "a sample"));
    for (size_t i = 0; i < n; i++) {
        sum += strata[i].share * strata[i].sum;
        base += strata[i].share * strata[i].n;
        known &= strata[i].known;
        if (!strata[i].known) largest = fmax(largest, strata[i].share);
        counted += strata[i].n > 0;
    }
    out->value = base > 0 ? sum / base : (double)NAN;
    for (size_t i = 0; i < n; i++) d[i] = strata[i].share * (strata[i].sum - out->value * strata[i].n) / base;
    const double half = known ? 0 : counted < MIN_COUNTED ? (double)INFINITY : half_width(n, strata, d);
    const double unseen = range.most > range.least ? -log(0.5 - level / 2) * largest / base : 0; /* share */
    out->low = out->value - fmax(half, unseen * (out->value - range.least));
    out->high = out->value + fmax(half, unseen * (range.most - out->value));
end:
    free(d);
    return result;
}

ssfr_result ssfr_sampled_mean(const ssfr_field *cast, int every, ssfr_sampled_fn *value, const void *user,
                              ssfr_sampled_range range, ssfr_sampled *out)
{
    ssfr_result result = SSFR_OK;
    stratum *strata = NULL;
    const size_t n = (size_t)squares(cast->w, every) * (size_t)squares(cast->h, every);
    SSFR_TRY(ssfr_alloc(&strata, n, sizeof *strata, "a sample"));
    list_strata(cast, every, value, user, strata);
    SSFR_TRY(estimate(n, strata, range, out));
end:
    free(strata);
    return result;
}

/* ---- metrics ----------------------------------------------------------------------------------------------------- */

typedef struct measured {
    const ssfr_metric *metric;
    const ssfr_pair *pair;
} measured;

static void at_pixel(const void *user, int x, int y, double *sum, double *n)
{
    const measured *m = user;
    ssfr_metric_at_pixel(m->metric, m->pair, x, y, sum, n);
}

/* m, between the nearest and the farthest surface in both: no pixel's depths differ by more, as far as is known. */
static double span_of(const ssfr_pair *pair)
{
    const size_t n = (size_t)pair->a->w * (size_t)pair->a->h;
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < 2 * n; i++) {
        const double z = i < n ? pair->a->data[i] : pair->b->data[i - n];
        if (ssfr_is_surface(z)) least = fmin(least, z), most = fmax(most, z);
    }
    return most > least ? most - least : 0;
}

/* Of what the metric is the mean of. Depths are far apart in few pixels, at outlines, which make most of the mean of
 * squares and some of the mean. Angles and colours have no such tails. */
static ssfr_sampled_range range_of(const ssfr_metric *metric, const ssfr_pair *pair)
{
    const double span = metric->kind == SSFR_METRIC_DEPTH ? span_of(pair) : 0;
    switch (metric->form) {
    case SSFR_FORM_SHARE: return (ssfr_sampled_range){0, 1};
    case SSFR_FORM_MEAN: return (ssfr_sampled_range){-span, span};
    default: return (ssfr_sampled_range){0, ssfr_square(span)};
    }
}

/* No mean of squares or shares is below 0, no share above 1. */
ssfr_result ssfr_sampled_metric(const ssfr_metric *metric, const ssfr_pair *pair, const ssfr_field *cast, int every,
                                ssfr_sampled *out)
{
    ssfr_result result = SSFR_OK;
    const measured m = {metric, pair};
    const bool share = metric->form == SSFR_FORM_SHARE;
    ssfr_sampled mean;
    SSFR_TRY(ssfr_sampled_mean(cast, every, at_pixel, &m, range_of(metric, pair), &mean));
    if (metric->form != SSFR_FORM_MEAN && mean.low < 0) mean.low = 0;
    if (share && mean.high > 1) mean.high = 1;
    const double low = ssfr_metric_of_mean(metric, mean.low), high = ssfr_metric_of_mean(metric, mean.high);
    *out = (ssfr_sampled){ssfr_metric_of_mean(metric, mean.value), low < high ? low : high, low < high ? high : low};
end:
    return result;
}

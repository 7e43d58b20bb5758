/* SPDX-License-Identifier: GPL-3.0-or-later */
/* estimate.c: the mean of a stratified sample with one pixel a stratum, and its interval from collapsed strata.
 *
 * Square h has n_h pixels of N; one of them, drawn with equal chances, has the value y_h. The mean is estimated by
 * sum W_h y_h, W_h = n_h / N, without bias. One pixel tells nothing of the variance in its square, so neighbours are
 * taken together in pairs (Cochran 1977, Sampling Techniques, sec. 5A.12): E (W_a y_a - W_b y_b)^2 is the variance of
 * the two, plus the square of what their means differ by. One draw of n_h has the variance of the n_h values itself, so
 * that there is no correction for how few they are, but that a square of one pixel has no variance. A mean over the
 * covered pixels is a ratio of two such means, whose variance is that of the residuals y_h - R x_h, over the covered
 * share (ibid., ch. 6). */
#include "experiments/truth/estimate.h"

#include <float.h>
#include <gsl/gsl_cdf.h>

/* A pixel of a square. */
typedef struct sample {
    int x, y;     /* px */
    double share; /* W_h */
    bool known;   /* the square has no other */
    bool counts;  /* in the mean that is now taken, */
    double d;     /* and what it adds to that mean's deviation: W_h (y_h - R x_h) over the mean of x */
} sample;

/* What a mean is of: counts says whether the pixel does, err bounds the value's error. */
typedef double value_fn(const ssfr_truth *truth, int x, int y, double *counts, double *err);

static double at(const ssfr_truth *truth, ssfr_truth_channel channel, int x, int y)
{
    return *ssfr_field_at(truth->channels[channel], x, y);
}

static bool is_covered(const ssfr_truth *truth, int x, int y)
{
    return fabs(at(truth, SSFR_TRUTH_depth, x, y)) < SSFR_SURFACE;
}

/* A pixel in which nothing but a touch was found may be covered, or not. */
static double covered(const ssfr_truth *truth, int x, int y, double *counts, double *err)
{
    *counts = 1;
    *err = !is_covered(truth, x, y) && at(truth, SSFR_TRUTH_depth_err, x, y) > 0;
    return is_covered(truth, x, y);
}

static double depth(const ssfr_truth *truth, int x, int y, double *counts, double *err)
{
    *counts = is_covered(truth, x, y);
    *err = *counts > 0 ? at(truth, SSFR_TRUTH_depth_err, x, y) : 0;
    return *counts > 0 ? at(truth, SSFR_TRUTH_depth, x, y) : 0;
}

static double thickness(const ssfr_truth *truth, int x, int y, double *counts, double *err)
{
    *counts = 1;
    *err = at(truth, SSFR_TRUTH_thickness_err, x, y);
    return at(truth, SSFR_TRUTH_thickness, x, y);
}

static double content(const ssfr_truth *truth, int x, int y, double *counts, double *err)
{
    *counts = 1;
    *err = at(truth, SSFR_TRUTH_content_err, x, y);
    return at(truth, SSFR_TRUTH_content, x, y);
}

/* Of linear Rec. 709 colours. */
static double luminance_of(const double colour[3])
{
    return 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
}

static double foam(const ssfr_truth *truth, int x, int y, double *counts, double *err)
{
    *counts = 1;
    *err = at(truth, SSFR_TRUTH_foam_err, x, y);
    return luminance_of(ssfr_field_at(truth->channels[SSFR_TRUTH_foam], x, y));
}

static double foam_opacity(const ssfr_truth *truth, int x, int y, double *counts, double *err)
{
    *counts = 1;
    *err = at(truth, SSFR_TRUTH_foam_err, x, y);
    return ssfr_field_at(truth->channels[SSFR_TRUTH_foam], x, y)[3];
}

static double luminance(const ssfr_truth *truth, int x, int y, double *counts, double *err)
{
    *counts = 1;
    *err = at(truth, SSFR_TRUTH_colour_err, x, y);
    return luminance_of(ssfr_field_at(truth->channels[SSFR_TRUTH_colour], x, y));
}

/* least, most: no mean is below or above. A share is of pixels that either are something or are not, or of light. */
static const struct quantity {
    const char *name, *unit;
    unsigned part;
    double least, most;
    bool share;
    value_fn *value;
} quantities[] = {
    {"covered", "1", SSFR_TRUTH_SURFACE, 0, 1, true, covered},
    {"depth", "m", SSFR_TRUTH_SURFACE, -INFINITY, 0, false, depth},
    {"thickness", "m", SSFR_TRUTH_THICKNESS, 0, INFINITY, false, thickness},
    {"content", "m", SSFR_TRUTH_THICKNESS, 0, INFINITY, false, content},
    {"foam_luminance", "1", SSFR_TRUTH_FOAM, 0, INFINITY, false, foam},
    {"foam_opacity", "1", SSFR_TRUTH_FOAM, 0, 1, true, foam_opacity},
    {"luminance", "1", SSFR_TRUTH_COLOUR, -INFINITY, INFINITY, false, luminance},
};

/* ---- the sample -------------------------------------------------------------------------------------------------- */

/* The pixel that was cast of the square at x, y. */
static sample find_sample(const ssfr_truth *truth, int x, int y)
{
    const int w = ssfr_min_int(truth->every, truth->w - x), h = ssfr_min_int(truth->every, truth->h - y);
    sample out = {.x = x, .y = y, .share = (double)w * h / ((double)truth->w * truth->h), .known = w * h == 1};
    for (int i = 0; i < w * h; i++)
        if (*ssfr_field_at(truth->cast, x + i % w, y + i / w) > 0) out.x = x + i % w, out.y = y + i / w;
    return out;
}

/* All squares, row by row, every second row backwards: who comes next is next. */
static void list_samples(const ssfr_truth *truth, int squares_x, size_t n, sample *samples)
{
    for (size_t i = 0; i < n; i++) {
        const int row = (int)(i / (size_t)squares_x), k = (int)(i % (size_t)squares_x);
        const int column = row % 2 ? squares_x - 1 - k : k;
        samples[i] = find_sample(truth, column * truth->every, row * truth->every);
    }
}

/* ---- the interval ------------------------------------------------------------------------------------------------ */

typedef struct spread {
    double variance; /* of the sum of the d */
    size_t degrees;  /* of freedom, that it is known with */
    bool known;      /* there is none: the sample is all there is */
} spread;

/* Takes n strata for one, n >= 2. */
static void collapse(size_t n, const sample *samples, spread *out)
{
    double mean = 0, sum = 0;
    bool known = true, counts = false;
    for (size_t i = 0; i < n; i++) {
        mean += samples[i].d / (double)n;
        known = known && samples[i].known;
        counts = counts || samples[i].counts;
    }
    if (known) return;
    for (size_t i = 0; i < n; i++) sum += ssfr_square(samples[i].d - mean);
    out->variance += sum * (double)n / (double)(n - 1);
    out->degrees += counts ? n - 1 : 0;
    out->known = false;
}

/* Of n pixels of which n_counting count. A ratio takes a degree of freedom for itself. */
static spread spread_of(size_t n, const sample *samples, size_t n_counting)
{
    spread out = {.known = n > 1 || samples[0].known};
    for (size_t i = 0; i + 1 < n;) {
        const size_t group = n - i == 3 ? 3 : 2; /* an odd one joins the last pair */
        collapse(group, samples + i, &out);
        i += group;
    }
    if (out.degrees > 0 && n_counting < n) out.degrees--;
    return out;
}

/* Half the width of the 95 % interval of sum d. */
static double half_width(const spread *s)
{
    if (s->known) return 0;
    return s->degrees > 0 ? gsl_cdf_tdist_Pinv(0.975, (double)s->degrees) * sqrt(s->variance) : INFINITY;
}

/* A share p of the pixels that is like nothing in the sample: not to see any of it has a chance of prod (1 - p_h) <=
 * exp(-p / W), where W is the largest W_h. This p has one of 2.5 %. */
static double unseen_share(size_t n, const sample *samples)
{
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        if (!samples[i].known) largest = fmax(largest, samples[i].share);
    return -log(0.025) * largest;
}

/* ---- the estimate ------------------------------------------------------------------------------------------------ */

static void set_interval(const struct quantity *q, double half, ssfr_estimate *out)
{
    out->low = out->value - half;
    out->high = out->value + half;
    if (out->low < q->least) out->low = q->least;
    if (out->high > q->most) out->high = q->most;
}

static void estimate(const ssfr_truth *truth, const struct quantity *q, size_t n, sample *samples, ssfr_estimate *out)
{
    double sum = 0, base = 0, wrong = 0, counts, err;
    *out = (ssfr_estimate){.quantity = q->name, .unit = q->unit};
    for (size_t i = 0; i < n; i++) {
        sample *s = &samples[i];
        s->d = s->share * q->value(truth, s->x, s->y, &counts, &err);
        s->counts = counts > 0;
        sum += s->d;
        base += s->share * counts;
        wrong += s->share * err;
        out->n += s->counts;
    }
    out->value = sum / base;
    for (size_t i = 0; i < n; i++)
        samples[i].d = (samples[i].d - (samples[i].counts ? samples[i].share * out->value : 0)) / base;
    const spread spread = spread_of(n, samples, out->n);
    const double seen = half_width(&spread), half = q->share ? fmax(seen, unseen_share(n, samples)) : seen;
    set_interval(q, half + wrong / base + (double)n * DBL_EPSILON * fabs(out->value), out);
}

ssfr_result ssfr_truth_estimate(const ssfr_truth *truth, ssfr_estimate out[SSFR_MAX_ESTIMATES], int *n)
{
    ssfr_result result = SSFR_OK;
    const int squares_x = (truth->w + truth->every - 1) / truth->every;
    const size_t n_samples = (size_t)squares_x * (size_t)((truth->h + truth->every - 1) / truth->every);
    sample *samples = NULL;
    *n = 0;
    SSFR_TRY(ssfr_alloc(&samples, n_samples, sizeof *samples, "a sample of pixels"));
    list_samples(truth, squares_x, n_samples, samples);
    for (size_t i = 0; i < SSFR_COUNT(quantities); i++)
        if (truth->parts & quantities[i].part) estimate(truth, &quantities[i], n_samples, samples, &out[(*n)++]);
end:
    free(samples);
    return result;
}

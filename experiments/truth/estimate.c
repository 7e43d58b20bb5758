/* SPDX-License-Identifier: GPL-3.0-or-later */
/* estimate.c: the mean of a stratified sample with one pixel a stratum, and its interval from collapsed strata.
 *
 * Square h has n_h pixels of N; one of them, drawn with equal chances, has the value y_h. The mean is estimated by
 * sum W_h y_h, W_h = n_h / N, without bias. One pixel tells nothing of the variance in its square, so neighbours are
 * taken together in pairs (Cochran 1977, Sampling Techniques, sec. 5A.12): (W_a y_a - W_b y_b)^2 is, in the mean, no
 * less than the variance of the two. A mean over the covered pixels is a ratio of two such means, whose variance is
 * that of the residuals y_h - R x_h, over the covered share (ibid., ch. 6). */
#include "experiments/truth/estimate.h"

#include <float.h>
#include <gsl/gsl_cdf.h>

/* A pixel of a square. */
typedef struct sample {
    int x, y;        /* px */
    double share;    /* W_h */
    double kept;     /* 1 - 1 / n_h: the share of the square that is not known */
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

static const struct quantity {
    const char *name, *unit;
    unsigned part;
    value_fn *value;
} quantities[] = {
    {"covered", "1", SSFR_TRUTH_SURFACE, covered},
    {"depth", "m", SSFR_TRUTH_SURFACE, depth},
    {"thickness", "m", SSFR_TRUTH_THICKNESS, thickness},
    {"content", "m", SSFR_TRUTH_THICKNESS, content},
    {"foam_luminance", "1", SSFR_TRUTH_FOAM, foam},
    {"foam_opacity", "1", SSFR_TRUTH_FOAM, foam_opacity},
    {"luminance", "1", SSFR_TRUTH_COLOUR, luminance},
};

/* ---- the sample -------------------------------------------------------------------------------------------------- */

/* The pixel that was cast of the square at x, y. */
static sample find_sample(const ssfr_truth *truth, int x, int y)
{
    const int w = ssfr_min_int(truth->every, truth->w - x), h = ssfr_min_int(truth->every, truth->h - y);
    const double n = (double)w * h;
    sample out = {.x = x, .y = y, .share = n / ((double)truth->w * truth->h), .kept = 1 - 1 / n};
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

/* ---- the estimate ------------------------------------------------------------------------------------------------ */

/* The variance of the sum of d over these strata, if they were one; n >= 2. */
static double collapse(size_t n, const double *d, const sample *samples)
{
    double mean = 0, sum = 0, kept = 0;
    for (size_t i = 0; i < n; i++) mean += d[i] / (double)n, kept = fmax(kept, samples[i].kept);
    for (size_t i = 0; i < n; i++) sum += ssfr_square(d[i] - mean);
    return kept * sum * (double)n / (double)(n - 1);
}

/* Half the width of the 95 % interval of sum d. */
static double half_width(size_t n, const double *d, const sample *samples)
{
    double variance = 0;
    size_t degrees = 0;
    if (n == 1) return samples[0].kept > 0 ? INFINITY : 0;
    for (size_t i = 0; i + 1 < n;) {
        const size_t group = n - i == 3 ? 3 : 2; /* an odd one joins the last pair */
        variance += collapse(group, d + i, samples + i);
        degrees += group - 1;
        i += group;
    }
    return gsl_cdf_tdist_Pinv(0.975, (double)degrees) * sqrt(variance);
}

static void estimate(const ssfr_truth *truth, const struct quantity *q, size_t n, const sample *samples, double *d,
                     ssfr_estimate *out)
{
    double sum = 0, base = 0, wrong = 0, counts, err;
    *out = (ssfr_estimate){.quantity = q->name, .unit = q->unit};
    for (size_t i = 0; i < n; i++) {
        sum += samples[i].share * q->value(truth, samples[i].x, samples[i].y, &counts, &err);
        base += samples[i].share * counts;
        wrong += samples[i].share * err;
        out->n += counts > 0;
    }
    out->value = sum / base;
    for (size_t i = 0; i < n; i++) {
        const double y = q->value(truth, samples[i].x, samples[i].y, &counts, &err);
        d[i] = samples[i].share * (y - out->value * counts) / base;
    }
    const double half = half_width(n, d, samples) + wrong / base + (double)n * DBL_EPSILON * fabs(out->value);
    out->low = out->value - half;
    out->high = out->value + half;
}

ssfr_result ssfr_truth_estimate(const ssfr_truth *truth, ssfr_estimate out[SSFR_MAX_ESTIMATES], int *n)
{
    ssfr_result result = SSFR_OK;
    const int squares_x = (truth->w + truth->every - 1) / truth->every;
    const size_t n_samples = (size_t)squares_x * (size_t)((truth->h + truth->every - 1) / truth->every);
    sample *samples = NULL;
    double *d = NULL;
    *n = 0;
    SSFR_TRY(ssfr_alloc(&samples, n_samples, sizeof *samples, "a sample of pixels"));
    SSFR_TRY(ssfr_alloc(&d, n_samples, sizeof *d, "a sample of pixels"));
    list_samples(truth, squares_x, n_samples, samples);
    for (size_t i = 0; i < SSFR_COUNT(quantities); i++)
        if (truth->parts & quantities[i].part) estimate(truth, &quantities[i], n_samples, samples, d, &out[(*n)++]);
end:
    free(samples);
    free(d);
    return result;
}

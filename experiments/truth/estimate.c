/* SPDX-License-Identifier: GPL-3.0-or-later */
/* estimate.c: what means are taken of an image of truth; sampled.h has their intervals. */
#include "experiments/truth/estimate.h"
#include "experiments/sampled.h"

#include "image/srgb.h"

#include <float.h>

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

static double foam(const ssfr_truth *truth, int x, int y, double *counts, double *err)
{
    *counts = 1;
    *err = at(truth, SSFR_TRUTH_foam_err, x, y);
    return ssfr_srgb_luminance(ssfr_field_at(truth->channels[SSFR_TRUTH_foam], x, y));
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
    return ssfr_srgb_luminance(ssfr_field_at(truth->channels[SSFR_TRUTH_colour], x, y));
}

/* least, most: no mean is below or above. A share is of values in [0, 1]. */
struct quantity {
    const char *name, *unit;
    unsigned part;
    double least, most;
    bool share;
    value_fn *value;
};

static const struct quantity quantities[] = {
    {"covered", "1", SSFR_TRUTH_SURFACE, 0, 1, true, covered},
    {"depth", "m", SSFR_TRUTH_SURFACE, -INFINITY, 0, false, depth},
    {"thickness", "m", SSFR_TRUTH_THICKNESS, 0, INFINITY, false, thickness},
    {"content", "m", SSFR_TRUTH_THICKNESS, 0, INFINITY, false, content},
    {"foam_luminance", "1", SSFR_TRUTH_FOAM, 0, INFINITY, false, foam},
    {"foam_opacity", "1", SSFR_TRUTH_FOAM, 0, 1, true, foam_opacity},
    {"luminance", "1", SSFR_TRUTH_COLOUR, -INFINITY, INFINITY, false, luminance},
};

/* ---- the estimate ------------------------------------------------------------------------------------------------ */

typedef struct asked {
    const ssfr_truth *truth;
    const struct quantity *quantity;
} asked;

static void value_at(const void *user, int x, int y, double *sum, double *n)
{
    const asked *a = user;
    double err;
    *sum = a->quantity->value(a->truth, x, y, n, &err);
}

static void err_at(const void *user, int x, int y, double *sum, double *n)
{
    const asked *a = user;
    a->quantity->value(a->truth, x, y, n, sum);
}

/* Pixels cast that count. */
static size_t count_pixels(const asked *a)
{
    const ssfr_field *cast = a->truth->cast;
    size_t n = 0;
    for (int y = 0; y < cast->h; y++)
        for (int x = 0; x < cast->w; x++) {
            double counts = 0, err;
            if (*ssfr_field_at(cast, x, y) > 0) a->quantity->value(a->truth, x, y, &counts, &err);
            n += counts > 0;
        }
    return n;
}

/* The sample's interval, wider by the mean of the pixels' own errors and by what adding them up does. */
static ssfr_result estimate(const asked *a, ssfr_estimate *out)
{
    ssfr_result result = SSFR_OK;
    const struct quantity *q = a->quantity;
    const ssfr_truth *t = a->truth;
    ssfr_sampled value, err;
    SSFR_TRY(ssfr_sampled_mean(t->cast, t->every, value_at, a, (ssfr_sampled_range){0, q->share}, &value));
    SSFR_TRY(ssfr_sampled_mean(t->cast, t->every, err_at, a, (ssfr_sampled_range){0, 0}, &err));
    *out = (ssfr_estimate){.quantity = q->name, .unit = q->unit, .value = value.value, .n = count_pixels(a)};
    const double wrong = err.value + (double)t->w * t->h * DBL_EPSILON * fabs(value.value);
    out->low = value.low - wrong;
    out->high = value.high + wrong;
    if (out->low < q->least) out->low = q->least;
    if (out->high > q->most) out->high = q->most;
end:
    return result;
}

ssfr_result ssfr_truth_estimate(const ssfr_truth *truth, ssfr_estimate out[SSFR_MAX_ESTIMATES], int *n)
{
    ssfr_result result = SSFR_OK;
    *n = 0;
    for (size_t i = 0; i < SSFR_COUNT(quantities); i++)
        if (truth->parts & quantities[i].part) SSFR_TRY(estimate(&(asked){truth, &quantities[i]}, &out[(*n)++]));
end:
    return result;
}

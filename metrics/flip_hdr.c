/* SPDX-License-Identifier: MIT */
/* flip_hdr.c: HDR-FLIP (Andersson et al. 2021): the largest LDR-FLIP of tone-mapped images over exposures. */
#include "metrics/flip.h"
#include "metrics/run.h"
#include "metrics/tally.h"

#include "image/srgb.h"

#include <float.h>

static const double shown = 0.85; /* what the brightest and the median pixel are mapped to */

/* (k0 x^2 + k1 x + k2) / (k3 x^2 + k4 x + k5). ACES as fitted by Narkowicz 2015 without its exposure of 0.6; Hable 2010
 * with his exposure of 2 and white at 11.2. Reinhard's x / (1 + x) is of luminance, the others of each channel. */
static const double coefficients[][6] = {
    [SSFR_FLIP_ACES] = {0.36 * 2.51, 0.6 * 0.03, 0, 0.36 * 2.43, 0.6 * 0.59, 0.14},
    [SSFR_FLIP_HABLE] = {0.231683, 0.013791, 0, 0.18, 0.3, 0.018},
    [SSFR_FLIP_REINHARD] = {0, 1, 0, 0, 1, 1},
};

static const double white = 1e6; /* far beyond where each channel is clamped to 1; larger values are taken for it */

/* ---- exposures --------------------------------------------------------------------------------------------------- */

static double luminance(const ssfr_field *image, const double *value)
{
    double linear[3];
    for (int k = 0; k < 3; k++) linear[k] = fmax(value[image->c == 1 ? 0 : k], 0);
    return ssfr_srgb_luminance(linear);
}

/* What is mapped to y: the larger root. */
static double inverse(const double k[6], double y)
{
    const double a = k[0] - y * k[3], b = k[1] - y * k[4], c = k[2] - y * k[5];
    return a == 0 ? -c / b : (-b + sqrt(b * b - 4 * a * c)) / (2 * a);
}

static bool is_finite(const ssfr_field *image, const double *value)
{
    bool finite = true;
    for (int k = 0; k < image->c; k++) finite = finite && isfinite(value[k]);
    return finite;
}

/* Luminances of counted pixels; *n is 0 when one is not finite. */
static void collect(const ssfr_pair *pair, double *out, size_t *n)
{
    bool finite = true;
    *n = 0;
    for (int y = 0; y < pair->b->h; y++)
        for (int x = 0; x < pair->b->w; x++) {
            const double *value = ssfr_field_at(pair->b, x, y);
            if (!ssfr_pair_counts(pair, x, y)) continue;
            finite = finite && is_finite(pair->b, value);
            out[(*n)++] = luminance(pair->b, value);
        }
    if (!finite) *n = 0;
}

ssfr_result ssfr_flip_expose(const ssfr_pair *pair, ssfr_flip_tone tone, ssfr_flip_exposures *out)
{
    ssfr_result result = SSFR_OK;
    double *luminances = NULL;
    size_t n = 0;
    *out = (ssfr_flip_exposures){0};
    SSFR_TRY(ssfr_pair_check(pair, "flip_hdr", SSFR_METRIC_COLOUR));
    SSFR_TRY(ssfr_alloc(&luminances, (size_t)pair->b->w * (size_t)pair->b->h, sizeof *luminances, "luminances"));
    collect(pair, luminances, &n);
    if (n == 0) goto end;
    qsort(luminances, n, sizeof *luminances, ssfr_by_value);
    if (luminances[n - 1] > FLT_EPSILON) {
        const double x = inverse(coefficients[tone], shown);
        out->start = log2(x / luminances[n - 1]);
        out->stop = log2(x / fmax(luminances[n / 2], FLT_EPSILON)); /* the upper median, as the authors' tool */
    }
    out->n = (int)fmax(2, ceil(out->stop - out->start));
end:
    free(luminances);
    return result;
}

/* ---- maps -------------------------------------------------------------------------------------------------------- */

static double map_tone(const double k[6], double x)
{
    return ((k[0] * x + k[1]) * x + k[2]) / ((k[3] * x + k[4]) * x + k[5]);
}

/* The image as a display shows it at an exposure; ssfr_flip_map clamps it. NaN stays NaN. */
static void develop(const ssfr_field *image, ssfr_flip_tone tone, double exposure, ssfr_field *out)
{
    const double gain = exp2(exposure), *k = coefficients[tone];
#pragma omp parallel for schedule(static)
    for (int y = 0; y < image->h; y++)
        for (int x = 0; x < image->w; x++) {
            const double *from = ssfr_field_at(image, x, y);
            double *to = ssfr_field_at(out, x, y);
            for (int c = 0; c < image->c; c++) to[c] = ssfr_clamp(gain * from[c], 0, white);
            const double light = luminance(out, to);
            for (int c = 0; c < image->c; c++)
                to[c] = tone == SSFR_FLIP_REINHARD ? to[c] / (1 + light) : map_tone(k, to[c]);
        }
}

static void keep_larger(const ssfr_field *map, ssfr_field *out)
{
    const size_t n = (size_t)map->w * (size_t)map->h;
    for (size_t i = 0; i < n; i++) out->data[i] = ssfr_tally_larger(out->data[i], map->data[i]);
}

ssfr_result ssfr_flip_hdr_map(const ssfr_pair *pair, double ppd, ssfr_flip_tone tone,
                              const ssfr_flip_exposures *exposures, ssfr_field **out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_flip_exposures *e = exposures;
    ssfr_field *a = NULL, *b = NULL, *map = NULL, *largest = NULL;
    *out = NULL;
    if (!(e->n >= 1 && isfinite(e->start) && isfinite(e->stop)))
        return ssfr_fail(SSFR_ERR_VALUE, "flip_hdr: %d exposures from %g to %g", e->n, e->start, e->stop);
    SSFR_TRY(ssfr_pair_check(pair, "flip_hdr", SSFR_METRIC_COLOUR));
    SSFR_TRY(ssfr_field_create(&a, pair->a->w, pair->a->h, pair->a->c));
    SSFR_TRY(ssfr_field_create(&b, pair->b->w, pair->b->h, pair->b->c));
    SSFR_TRY(ssfr_field_create(&largest, pair->b->w, pair->b->h, 1));
    for (int i = 0; i < e->n; i++) {
        const double exposure = ssfr_mix(e->start, e->stop, (double)i / ssfr_max_int(e->n - 1, 1));
        develop(pair->a, tone, exposure, a);
        develop(pair->b, tone, exposure, b);
        SSFR_TRY(ssfr_flip_map(&(ssfr_pair){.a = a, .b = b}, ppd, &map));
        keep_larger(map, largest);
        ssfr_field_destroy(&map);
    }
    *out = largest;
    largest = NULL;
end:
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&map);
    ssfr_field_destroy(&largest);
    return result;
}

ssfr_result ssfr_metric_run_flip_hdr(const ssfr_pair *pair, double *out)
{
    ssfr_result result = SSFR_OK;
    ssfr_flip_exposures exposures;
    ssfr_field *map = NULL;
    SSFR_TRY(ssfr_flip_expose(pair, SSFR_FLIP_ACES, &exposures));
    if (exposures.n == 0) *out = (double)NAN;
    if (exposures.n == 0) goto end;
    SSFR_TRY(ssfr_flip_hdr_map(pair, SSFR_FLIP_PPD, SSFR_FLIP_ACES, &exposures, &map));
    SSFR_TRY(ssfr_tally_map(map, pair->mask, out));
end:
    ssfr_field_destroy(&map);
    return result;
}

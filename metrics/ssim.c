/* SPDX-License-Identifier: MIT */
/* ssim.c: structural similarity (Wang et al. 2004) of display values, by OpenCV, a band of one channel at a time. */
#include "metrics/metrics_opencv.h"
#include "metrics/run.h"
#include "metrics/tally.h"

#include "image/srgb.h"

enum {
    BAND = 256, /* px, rows measured at once: OpenCV holds about fifteen copies of what it compares */
    HALO = 5,   /* px, half the window: rows read on each side of a band, so that bands leave no seams */
};

typedef struct planes { /* of one channel, rows top to bottom of the image */
    double *a, *b, *map;
} planes;

/* The constants of SSIM are meant for values up to 255. */
static void fill_plane(const ssfr_field *field, int channel, int top, int bottom, double *plane)
{
    for (int y = top; y < bottom; y++)
        for (int x = 0; x < field->w; x++) *plane++ = 255 * ssfr_srgb_encode(ssfr_field_at(field, x, y)[channel]);
}

static ssfr_result measure_band(const ssfr_pair *pair, int channel, int y0, const planes *p, ssfr_tally *tally)
{
    ssfr_result result = SSFR_OK;
    char message[256] = "";
    const int w = pair->a->w, h = pair->a->h, y1 = ssfr_min_int(y0 + BAND, h);
    const int top = ssfr_max_int(y0 - HALO, 0), bottom = ssfr_min_int(y1 + HALO, h);
    fill_plane(pair->a, channel, top, bottom, p->a);
    fill_plane(pair->b, channel, top, bottom, p->b);
    result = ssfr_opencv_ssim(p->b, p->a, w, bottom - top, p->map, message, sizeof message);
    if (result != SSFR_OK) return ssfr_fail(result, "ssim: %s", message);
    for (int y = y0; y < y1; y++)
        for (int x = 0; x < w; x++)
            if (ssfr_pair_counts(pair, x, y)) ssfr_tally_add(tally, p->map[(size_t)(y - top) * (size_t)w + (size_t)x]);
    return result;
}

/* All channels count the same pixels, so that the mean of all values is the mean of the channels' means. */
ssfr_result ssfr_metric_run_ssim(const ssfr_pair *pair, double *out)
{
    ssfr_result result = SSFR_OK;
    planes p = {0};
    ssfr_tally tally = {0};
    const size_t n = (size_t)pair->a->w * (size_t)ssfr_min_int(BAND + 2 * HALO, pair->a->h);
    SSFR_TRY(ssfr_alloc(&p.a, n, sizeof *p.a, "a band of an image"));
    SSFR_TRY(ssfr_alloc(&p.b, n, sizeof *p.b, "a band of an image"));
    SSFR_TRY(ssfr_alloc(&p.map, n, sizeof *p.map, "a band of an image"));
    for (int channel = 0; channel < pair->a->c; channel++)
        for (int y = 0; y < pair->a->h; y += BAND) SSFR_TRY(measure_band(pair, channel, y, &p, &tally));
    *out = tally.n ? tally.sum / (double)tally.n : (double)NAN;
end:
    free(p.a);
    free(p.b);
    free(p.map);
    return result;
}

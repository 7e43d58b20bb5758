/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truth_file.c: what is written of ground truth. */
#include "experiments/truth/truth_file.h"

#include "base/param.h"

/* ---- what stands in the header ----------------------------------------------------------------------------------- */

static ssfr_result record_parameters(ssfr_record *record, const ssfr_truth_params *params)
{
    ssfr_result result = SSFR_OK;
    char key[128], text[256];
    const ssfr_param *row;
    const void *group;
    for (int i = 0; ssfr_truth_key_at(params, i, key, &row, &group); i++) {
        ssfr_param_format(row, group, text, sizeof text);
        if (row->type == SSFR_CHOICE || row->type == SSFR_SET)
            SSFR_TRY(ssfr_record_text(record, key, text));
        else
            SSFR_TRY(ssfr_record_number(record, key, ssfr_param_number(row, group)));
    }
end:
    return result;
}

ssfr_result ssfr_truth_record(ssfr_record *record, const ssfr_truth *truth, const ssfr_truth_params *params)
{
    ssfr_result result = SSFR_OK;
    const ssfr_truth_stats *s = &truth->stats;
    const struct { const char *name; double value; } numbers[] = {
        {"truth.version", SSFR_TRUTH_VERSION}, {"truth.every", truth->every},
        {"stats.rays", (double)s->rays},       {"stats.crossings", (double)s->crossings},
        {"stats.touches", (double)s->touches}, {"stats.judged", (double)s->judged},
        {"stats.light_touches", (double)s->light_touches}, {"stats.judged_max", s->judged_max},
        {"stats.judged_ratio", s->judged_ratio}, {"stats.seconds", s->seconds},
    };
    for (size_t i = 0; i < SSFR_COUNT(numbers); i++)
        SSFR_TRY(ssfr_record_number(record, numbers[i].name, numbers[i].value));
    SSFR_TRY(record_parameters(record, params));
end:
    return result;
}

/* ---- floats ------------------------------------------------------------------------------------------------------ */

/* The largest change of a pixel's n numbers when they become floats. Empty values are exact by agreement. */
static double rounding_of(const double *values, int n)
{
    double most = 0;
    for (int k = 0; k < n; k++)
        if (fabs(values[k]) < SSFR_SURFACE) most = fmax(most, fabs(values[k] - (double)(float)values[k]));
    return most;
}

/* A float no less than the bound. */
static double round_up(double bound)
{
    const float rounded = (float)bound;
    return (double)rounded >= bound ? (double)rounded : (double)nextafterf(rounded, INFINITY);
}

/* The bounds for what stands in the file. A normal's angle grows by at most the length of its change, over its own. */
static ssfr_result widen(ssfr_field **out, const ssfr_field *values, const ssfr_field *bounds, double factor)
{
    const size_t n = (size_t)bounds->w * (size_t)bounds->h;
    const ssfr_result result = ssfr_field_create(out, bounds->w, bounds->h, 1);
    for (size_t i = 0; i < n && result == SSFR_OK; i++)
        (*out)->data[i] = round_up(bounds->data[i] +
                                   factor * rounding_of(values->data + i * (size_t)values->c, values->c));
    return result;
}

/* Channels are followed by their bounds, but for the number of crossings, which is a whole number. */
static bool is_bound(int channel)
{
    const char *name = ssfr_truth_channels[channel].name;
    const size_t length = strlen(name);
    return length > 4 && strcmp(name + length - 4, "_err") == 0;
}

ssfr_result ssfr_truth_save(const char *path, const ssfr_truth *truth, const ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    ssfr_layer layers[SSFR_N_TRUTH_CHANNELS + 1];
    ssfr_field *widened[SSFR_N_TRUTH_CHANNELS] = {NULL};
    int n = 0;
    for (int i = 0; i < SSFR_N_TRUTH_CHANNELS; i++) {
        if (!truth->channels[i]) continue;
        const double factor = i == SSFR_TRUTH_normal_err ? 2 : 1; /* sqrt(3), and the change of its length */
        if (is_bound(i)) SSFR_TRY(widen(&widened[i], truth->channels[i - 1], truth->channels[i], factor));
        layers[n++] = (ssfr_layer){ssfr_truth_channels[i].exr, is_bound(i) ? widened[i] : truth->channels[i]};
    }
    layers[n++] = (ssfr_layer){"cast", truth->cast};
    SSFR_TRY(ssfr_exr_save(path, n, layers, record->n, record->items));
end:
    for (int i = 0; i < SSFR_N_TRUTH_CHANNELS; i++) ssfr_field_destroy(&widened[i]);
    return result;
}

/* ---- a picture --------------------------------------------------------------------------------------------------- */

static void show(const ssfr_truth *truth, int x, int y, double colour[3])
{
    const double gap = 0.02; /* grey where there is no fluid */
    if (truth->parts & SSFR_TRUTH_COLOUR) {
        memcpy(colour, ssfr_field_at(truth->channels[SSFR_TRUTH_colour], x, y), 3 * sizeof *colour);
    } else if (truth->parts & SSFR_TRUTH_SURFACE) {
        const double *normal = ssfr_field_at(truth->channels[SSFR_TRUTH_normal], x, y);
        colour[0] = colour[1] = colour[2] = fmax(normal[2], gap);
    } else if (truth->parts & SSFR_TRUTH_THICKNESS) {
        const double thickness = *ssfr_field_at(truth->channels[SSFR_TRUTH_thickness], x, y);
        for (int k = 0; k < 3; k++) colour[k] = exp(-thickness * (double[]){2.2, 0.65, 0.45}[k]); /* water's defaults */
    } else {
        memcpy(colour, ssfr_field_at(truth->channels[SSFR_TRUTH_foam], x, y), 3 * sizeof *colour);
    }
}

static void show_square(const ssfr_truth *truth, ssfr_field *picture, int x0, int y0)
{
    const int x1 = ssfr_min_int(x0 + truth->every, truth->w), y1 = ssfr_min_int(y0 + truth->every, truth->h);
    double colour[3] = {0, 0, 0};
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            if (*ssfr_field_at(truth->cast, x, y) > 0) show(truth, x, y, colour);
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) memcpy(ssfr_field_at(picture, x, y), colour, sizeof colour);
}

ssfr_result ssfr_truth_preview(const char *path, const ssfr_truth *truth)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *picture = NULL;
    SSFR_TRY(ssfr_field_create(&picture, truth->w, truth->h, 3));
    for (int y = 0; y < truth->h; y += truth->every)
        for (int x = 0; x < truth->w; x += truth->every) show_square(truth, picture, x, y);
    SSFR_TRY(ssfr_png_save(path, picture));
end:
    ssfr_field_destroy(&picture);
    return result;
}

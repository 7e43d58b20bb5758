/* SPDX-License-Identifier: GPL-3.0-or-later */
/* slot_picture.c: from the values of an image to colours whose lightness rises evenly. */
#include "experiments/slot_picture.h"

#include "graph/pass.h"
#include "image/srgb.h"

/* Viridis (Smith and van der Walt 2015) at every eighth of its way, sRGB. */
static const double palette[][3] = {
    {0.267, 0.005, 0.329}, {0.279, 0.175, 0.483}, {0.230, 0.322, 0.546}, {0.173, 0.449, 0.558}, {0.128, 0.567, 0.551},
    {0.158, 0.684, 0.502}, {0.369, 0.789, 0.383}, {0.678, 0.864, 0.190}, {0.993, 0.906, 0.144}};
enum { STEPS = SSFR_COUNT(palette) - 1 };
static const double nothing = 0.6; /* grey, sRGB */
static const double left_out = 0.02; /* share of the pixels beyond each end of a range that nobody gave */

/* As the floats that a GPU stores. */
static bool is_there(double value, double neutral) { return isfinite(value) && (float)value != (float)neutral; }

/* lo = hi where all is the same; 0, 1 where there is nothing. */
static ssfr_result find_range(const ssfr_field *field, double neutral, double *lo, double *hi)
{
    ssfr_result result = SSFR_OK;
    const size_t n = (size_t)field->w * (size_t)field->h;
    size_t there = 0;
    double *values = NULL;
    SSFR_TRY(ssfr_alloc(&values, n, sizeof *values, "values of a slot"));
    for (size_t i = 0; i < n; i++)
        if (is_there(field->data[i], neutral)) values[there++] = field->data[i];
    qsort(values, there, sizeof *values, ssfr_by_value);
    const size_t beyond = (size_t)(left_out * (double)there);
    if (isnan(*lo)) *lo = there ? values[beyond] : 0;
    if (isnan(*hi)) *hi = there ? values[there - 1 - beyond] : 1;
end:
    free(values);
    return result;
}

/* t in [0, 1]; linear, as ssfr_png_save takes them. */
static void colour_of(double t, double colour[3])
{
    const double at = t * STEPS;
    const int i = ssfr_min_int((int)at, STEPS - 1);
    for (int k = 0; k < 3; k++)
        colour[k] = ssfr_srgb_decode(palette[i][k] + (at - i) * (palette[i + 1][k] - palette[i][k]));
}

static void paint(ssfr_field *out, const ssfr_field *field, double neutral, double lo, double hi)
{
    for (size_t i = 0; i < (size_t)field->w * (size_t)field->h; i++) {
        const double value = field->data[i], t = hi > lo ? (value - lo) / (hi - lo) : 1;
        double *colour = out->data + 3 * i;
        if (is_there(value, neutral)) colour_of(fmin(fmax(t, 0), 1), colour);
        else colour[0] = colour[1] = colour[2] = ssfr_srgb_decode(nothing);
    }
}

ssfr_result ssfr_false_colours_save(const char *png, const ssfr_field *field, const ssfr_false_colours *colours)
{
    ssfr_result result = SSFR_OK;
    double lo = colours->lo, hi = colours->hi;
    ssfr_field *painted = NULL;
    if (field->c != 1)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %s has %d channels, false colours are of one", png, colours->name,
                         field->c);
    SSFR_TRY(ssfr_field_create(&painted, field->w, field->h, 3));
    SSFR_TRY(find_range(field, colours->neutral, &lo, &hi));
    paint(painted, field, colours->neutral, lo, hi);
    SSFR_TRY(ssfr_png_save(png, painted));
    ssfr_log(SSFR_INFO, "%s: %s from %g to %g %s", png, colours->name, lo, hi, colours->unit);
end:
    ssfr_field_destroy(&painted);
    return result;
}

ssfr_result ssfr_slot_picture_save(const char *png, const ssfr_field *field, const ssfr_slot_picture *picture)
{
    const ssfr_slot *slot = &ssfr_slots[ssfr_slot_find(picture->slot)];
    const ssfr_false_colours colours = {slot->name, slot->unit, slot->neutral, picture->lo, picture->hi};
    return ssfr_false_colours_save(png, field, &colours);
}

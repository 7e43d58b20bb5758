/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pile.c: rectangles around particles, summed by their corners. */
#include "experiments/pile.h"

#include "base/base.h"
#include "base/field.h"

/* The pixels that a sphere may be seen in, along one axis: from lo to before hi. middle: across the view, m; near and
 * far: the least and the most distance along it, m; scale: pixels a unit of slope, from the middle of `size` pixels. */
static void find_pixels(double middle, double radius, const double depth[2], double scale, int size, int range[2])
{
    const double ends[2] = {middle - radius, middle + radius};
    for (int k = 0; k < 2; k++) {
        const double slope = ends[k] / depth[(k == 0) == (ends[k] < 0) ? 0 : 1];
        const double pixel = 0.5 * size + scale * slope + (k == 0 ? -1 : 2); /* a pixel more on each side */
        range[k] = (int)fmin(fmax(pixel, 0), size);
    }
}

/* False where it is all behind the eye. */
static bool find_rectangle(const ssfr_camera *c, const double place[3], double radius, int x[2], int y[2])
{
    const double from[3] = {place[0] - c->eye[0], place[1] - c->eye[1], place[2] - c->eye[2]};
    const double distance = -ssfr_dot(c->back, from), depth[2] = {distance - radius, distance + radius};
    x[0] = y[0] = 0, x[1] = c->w, y[1] = c->h;
    if (!(depth[1] > 0)) return false;
    if (!(depth[0] > 0)) return true; /* around the eye: anywhere */
    find_pixels(ssfr_dot(c->right, from), radius, depth, 0.5 * c->w / c->tan_x, c->w, x);
    find_pixels(-ssfr_dot(c->up, from), radius, depth, 0.5 * c->h / c->tan_y, c->h, y);
    return x[0] < x[1] && y[0] < y[1];
}

/* Corners add up to rectangles: along x, then along y. */
static void sum_up(const ssfr_field *corners, ssfr_field *out)
{
    for (int y = 0; y < out->h; y++) {
        double along = 0;
        for (int x = 0; x < out->w; x++) {
            along += *ssfr_field_fetch(corners, x, y);
            *ssfr_field_at(out, x, y) = along + (y ? *ssfr_field_fetch(out, x, y - 1) : 0);
        }
    }
}

/* In parts of 1/256, whose sums are exact: what is added at one corner vanishes at the next. */
static double weigh(const ssfr_pile_options *options, double size)
{
    return options->by_size ? ceil(256 * size) / 256 : 1;
}

ssfr_result ssfr_pile(ssfr_field **out, const ssfr_particles *particles, const ssfr_camera *camera,
                      const ssfr_pile_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *corners = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_field_create(&corners, camera->w + 1, camera->h + 1, 1));
    SSFR_TRY(ssfr_field_create(out, camera->w, camera->h, 1));
    for (size_t i = 0; particles && i < particles->n; i++) {
        const double size = options->sizes ? (double)options->sizes[i] : 1, weight = weigh(options, size);
        double place[3];
        int x[2], y[2];
        ssfr_particles_position(particles, i, place);
        if (!(size > 0) || !find_rectangle(camera, place, size * options->reach, x, y)) continue;
        for (int k = 0; k < 4; k++) *ssfr_field_at(corners, x[k % 2], y[k / 2]) += k % 3 ? -weight : weight;
    }
    sum_up(corners, *out);
end:
    ssfr_field_destroy(&corners);
    return result;
}

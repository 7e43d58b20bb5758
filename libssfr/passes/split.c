/* SPDX-License-Identifier: MIT */
/* split.c: a surface read straight from the smoothed depth, in double (Bagar 2010, sec. 4.9.3, listings A.17 to A.25).
 *
 * A place in the depth image has slopes along rows and columns, each by three pixels of a line (A.18). Where no line
 * bends, the surface is smooth, and the slopes of the lines to both sides are interpolated (A.25). Elsewhere is a
 * border: what lies to its sides must not be mixed but as a colour, so the four pixels around are shaded each by the
 * lesser of its differences (A.24), and the colours are interpolated (A.23). */
#include "passes/split.h"

#include "passes/environment.h"

/* One value for all that is no surface, so that lines of it do not bend, and lines that are partly of it do. */
static double depth_in(const ssfr_field *low, int i, int j)
{
    const double z = ssfr_depth_at(low, i, j);
    return ssfr_is_surface(z) ? z : -SSFR_EMPTY;
}

/* ---- inside ------------------------------------------------------------------------------------------------------ */

typedef struct line { /* three pixels, read between the middles of its two steps; all in m */
    double step;   /* depth a pixel */
    double z;
    double middle; /* depth of the pixel in the middle */
    double bend;   /* magnitude of the second difference */
} line;

/* Listing A.18. f goes from the middle of the first step to that of the second. */
static line line_at(const ssfr_field *low, int i, int j, int di, int dj, double f)
{
    const double before = depth_in(low, i - di, j - dj), z = depth_in(low, i, j), after = depth_in(low, i + di, j + dj);
    return (line){.step = ssfr_mix(z - before, after - z, f),
                  .z = ssfr_mix(0.5 * (z + before), 0.5 * (after + z), f),
                  .middle = z,
                  .bend = fabs(before - 2 * z + after)};
}

static line mix_lines(const line lines[2], double f)
{
    return (line){.step = ssfr_mix(lines[0].step, lines[1].step, f),
                  .z = ssfr_mix(lines[0].z, lines[1].z, f),
                  .middle = ssfr_mix(lines[0].middle, lines[1].middle, f),
                  .bend = fmax(lines[0].bend, lines[1].bend)};
}

/* Listing A.25. The normal is that of normals.c over -z, so that it is finite wherever the depths are. */
static ssfr_surface inner(const ssfr_split_pixel *at, const line *row, const line *column)
{
    const double *image = at->run->frame->block.image, z = 0.5 * (row->z + column->z);
    const double p = row->step / (image[2] * at->split->low[0]), q = -column->step / (image[3] * at->split->low[0]);
    double position[3], n[3];
    ssfr_slope_at(&at->run->frame->block, at->x + 0.5, at->y + 0.5, position);
    if (at->split->off_axis) n[0] = p / z, n[1] = q / z, n[2] = 1 + (position[0] * p + position[1] * q) / z;
    else n[0] = p / row->middle, n[1] = q / column->middle, n[2] = 1;
    ssfr_normalize(n);
    for (int k = 0; k < 2; k++) position[k] *= -z;
    position[2] = z;
    return ssfr_surface_make(at->run, at->x, at->y, position, n);
}

/* Where a place stands on a line: between the middles of the steps around the pixel that it is in. Between two lines:
 * between the middles of the pixels, which stand at halves. */
ssfr_split_pixel ssfr_split_at(const ssfr_run *run, const ssfr_split *split, const ssfr_field *low, int x, int y)
{
    const double px = (x + 0.5) / split->low[0], py = (y + 0.5) / split->low[0], half = split->half_shift ? 0 : 0.5;
    const int ci = (int)floor(px), cj = (int)floor(py), i = (int)floor(px - half), j = (int)floor(py - half);
    ssfr_split_pixel at = {.run = run, .split = split, .low = low, .x = x, .y = y, .i = i, .j = j,
                           .f = {px - half - i, py - half - j}};
    const line rows[2] = {line_at(low, ci, j, 1, 0, px - ci), line_at(low, ci, j + 1, 1, 0, px - ci)};
    const line columns[2] = {line_at(low, i, cj, 0, 1, py - cj), line_at(low, i + 1, cj, 0, 1, py - cj)};
    const line row = mix_lines(rows, at.f[1]), column = mix_lines(columns, at.f[0]);
    at.border = fmax(row.bend, column.bend) > split->low[1];
    at.inner = inner(&at, &row, &column);
    return at;
}

/* ---- at a border ------------------------------------------------------------------------------------------------- */

/* Listing A.17: eye space, m. */
static void place(const ssfr_split_pixel *at, int i, int j, double z, double out[3])
{
    const double factor = at->split->low[0];
    ssfr_slope_at(&at->run->frame->block, (i + 0.5) * factor, (j + 0.5) * factor, out);
    for (int k = 0; k < 2; k++) out[k] *= -z;
    out[2] = z;
}

/* Listing A.24: to the neighbour ahead or from that behind, whichever differs less in depth; flat where neither is of
 * the same surface. */
static void least_step(const ssfr_split_pixel *at, int i, int j, int di, int dj, const double eye[3], double out[3])
{
    const double ahead = depth_in(at->low, i + di, j + dj), behind = depth_in(at->low, i - di, j - dj);
    const int side = fabs(eye[2] - behind) < fabs(ahead - eye[2]) ? -1 : 1;
    const double z = side < 0 ? behind : ahead;
    place(at, i + side * di, j + side * dj, fabs(z - eye[2]) <= at->split->low[2] ? z : eye[2], out);
    for (int k = 0; k < 3; k++) out[k] = side * (out[k] - eye[k]) / -eye[2];
}

double ssfr_split_weight(const ssfr_split_pixel *at, int k)
{
    return (k % 2 ? at->f[0] : 1 - at->f[0]) * (k / 2 ? at->f[1] : 1 - at->f[1]);
}

ssfr_surface ssfr_split_sample(const ssfr_split_pixel *at, int k)
{
    const int i = ssfr_clamp_int(at->i + k % 2, 0, at->low->w - 1);
    const int j = ssfr_clamp_int(at->j + k / 2, 0, at->low->h - 1);
    double eye[3], dx[3], dy[3], n[3];
    place(at, i, j, depth_in(at->low, i, j), eye);
    least_step(at, i, j, 1, 0, eye, dx);
    least_step(at, i, j, 0, -1, eye, dy); /* upwards */
    ssfr_cross(dx, dy, n);
    ssfr_normalize(n);
    return ssfr_surface_make(at->run, at->x, at->y, eye, n);
}

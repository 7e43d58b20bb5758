/* SPDX-License-Identifier: MIT */
/* normals_cpu.c: unit normals by finite differences, in double. */
#include "passes/normals.h"

/* The depth's slope along one axis; `before` and `after` are the neighbours' depths. */
static double slope(double before, double z, double after, const ssfr_normals_coeffs *c)
{
    const bool has_before = ssfr_is_surface(before), has_after = ssfr_is_surface(after);
    const double left = z - before, right = after - z;
    if (c->edge == SSFR_NORMALS_CENTRAL && has_before && has_after) return (left + right) / 2;
    if (has_before && has_after && fabs(left) <= c->falloff && fabs(right) <= c->falloff) return (left + right) / 2;
    if (has_before && (!has_after || fabs(left) < fabs(right))) return left;
    return has_after ? right : 0;
}

static void normal_at(const ssfr_run *run, int x, int y, double z, double n[3])
{
    const ssfr_normals_coeffs *c = run->coeffs;
    const ssfr_field *f = run->in[0];
    const double *image = run->frame->block.image;
    const double u = ((x + 0.5) * c->divisor - 0.5 * image[0]) * image[2];
    const double v = (0.5 * image[1] - (y + 0.5) * c->divisor) * image[3];
    /* Not ssfr_field_fetch: a pixel repeated outside the image would halve the slope at its border. */
    const double p = slope(ssfr_depth_at(f, x - 1, y), z, ssfr_depth_at(f, x + 1, y), c) / c->c[0];
    const double q = slope(ssfr_depth_at(f, x, y + 1), z, ssfr_depth_at(f, x, y - 1), c) / c->c[1]; /* upwards */
    n[0] = -p, n[1] = -q;
    n[2] = -(z + (c->off_axis ? u * p + v * q : 0));
    ssfr_normalize(n);
}

void ssfr_normals_cpu(const ssfr_run *run)
{
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) {
            const double z = *ssfr_field_fetch(run->in[0], x, y);
            if (ssfr_is_surface(z)) normal_at(run, x, y, z, ssfr_field_at(run->out[0], x, y));
        }
}

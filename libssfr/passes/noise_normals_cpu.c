/* SPDX-License-Identifier: MIT */
/* noise_normals_cpu.c: normals leaning with the noise's slope on a surface that faces the eye, in double. */
#include "passes/noise_normals.h"

/* The noise's change a pixel along (dx, dy), one-sided where a neighbour has no surface and so no noise. Noise that is
 * not a number has no slope. */
static double slope(const ssfr_run *run, int x, int y, int dx, int dy)
{
    const ssfr_field *noise = run->in[1];
    const int before = ssfr_is_surface(ssfr_depth_at(run->in[2], x - dx, y - dy));
    const int after = ssfr_is_surface(ssfr_depth_at(run->in[2], x + dx, y + dy));
    const double change = *ssfr_field_fetch(noise, x + after * dx, y + after * dy) -
                          *ssfr_field_fetch(noise, x - before * dx, y - before * dy);
    return ssfr_is_surface(change) ? change / ssfr_max_int(before + after, 1) : 0;
}

static void disturb(const ssfr_run *run, int x, int y, const double *normal, double z, double *out)
{
    const ssfr_noise_normals_coeffs *c = run->coeffs;
    out[0] = normal[0] - c->height * slope(run, x, y, 1, 0) / (c->c[0] * fabs(z));
    out[1] = normal[1] - c->height * slope(run, x, y, 0, -1) / (c->c[1] * fabs(z)); /* rows go down, y up */
    out[2] = normal[2];
    if (c->height > 0) ssfr_normalize(out); /* height 0 is the identity to the last bit */
}

void ssfr_noise_normals_cpu(const ssfr_run *run)
{
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) {
            const double z = *ssfr_field_fetch(run->in[2], x, y);
            if (ssfr_is_surface(z))
                disturb(run, x, y, ssfr_field_fetch(run->in[0], x, y), z, ssfr_field_at(run->out[0], x, y));
        }
}

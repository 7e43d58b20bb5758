/* SPDX-License-Identifier: MIT */
/* downsample_cpu.c: one pixel from a block of factor x factor, in double. Block (x, y) starts at factor (x, y); at the
 * right and bottom border it may reach over the image, where there is no surface; its middle is brought back into the
 * image. */
#include "passes/downsample.h"

static double from_block(const ssfr_field *depth, int x, int y, int n, int rule)
{
    double nearest = -SSFR_EMPTY, sum = 0;
    int count = 0;
    if (rule == SSFR_DOWNSAMPLE_NEAREST) return *ssfr_field_fetch(depth, x * n + n / 2, y * n + n / 2);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            const double z = ssfr_depth_at(depth, x * n + i, y * n + j);
            if (!ssfr_is_surface(z)) continue;
            nearest = fmax(nearest, z);
            sum += z;
            count++;
        }
    if (rule == SSFR_DOWNSAMPLE_MEAN && count) return sum / count;
    return nearest;
}

void ssfr_downsample_cpu(const ssfr_run *run)
{
    const ssfr_downsample_coeffs *c = run->coeffs;
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++)
            *ssfr_field_at(run->out[0], x, y) = from_block(run->in[0], x, y, c->factor, c->rule);
}

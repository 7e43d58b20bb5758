/* SPDX-License-Identifier: MIT */
/* noise_normals_cpu.c: normals leaning with the noise's central differences, per metre on a surface that faces the eye, in double. */
#include "passes/noise_normals.h"

static void disturb(const ssfr_run *run, int x, int y, const double *normal, double z, double *out)
{
    const ssfr_noise_normals_coeffs *c = run->coeffs;
    const ssfr_field *noise = run->in[1];
    const double dx = *ssfr_field_fetch(noise, x + 1, y) - *ssfr_field_fetch(noise, x - 1, y);
    const double dy = *ssfr_field_fetch(noise, x, y - 1) - *ssfr_field_fetch(noise, x, y + 1); /* upwards */
    out[0] = normal[0] - c->height * dx / (2 * c->c[0] * fabs(z));
    out[1] = normal[1] - c->height * dy / (2 * c->c[1] * fabs(z));
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

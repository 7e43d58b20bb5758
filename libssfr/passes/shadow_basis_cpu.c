/* SPDX-License-Identifier: MIT */
/* shadow_basis_cpu.c: cosines and sines of a shadow map's depths, filtered along rows and columns, in double. */
#include "passes/shadow_basis.h"

/* Value i of a texel with its caster at normalised depth z. */
static double value(const ssfr_shadow_basis_coeffs *c, int i, double z)
{
    const int k = (i + 1) / 2;
    const double angular = M_PI * (2 * k - 1), weight = 2 * exp(-c->damping * k * k) / angular;
    if (i == 0) return 1;
    if (k > c->terms) return 0;
    return weight * (i % 2 ? cos(angular * z) : sin(angular * z));
}

static void write_values(const ssfr_run *run)
{
    const ssfr_shadow_basis_coeffs *c = run->coeffs;
    const int side = run->h / ssfr_shadow_images(c->terms);
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) {
            const double depth = *ssfr_field_fetch(run->in[0], x, y % side);
            const double z = fmax((c->view.top - depth) * c->per_metre, 0);
            double *out = ssfr_field_at(run->out[0], x, y);
            for (int k = 0; k < 4; k++)
                out[k] = ssfr_is_surface(depth) ? value(c, y / side * 4 + k, fmin(z, 1)) : 0;
        }
}

/* Means along one axis inside each image: texels beyond its border are those of the border. */
static void filter(const ssfr_run *run, const ssfr_field *from, ssfr_field *to, const int step[2])
{
    const ssfr_shadow_basis_coeffs *c = run->coeffs;
    const int side = run->h / ssfr_shadow_images(c->terms);
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) {
            const int first = y - y % side;
            double sum[4] = {0};
            for (int i = -c->radius; i <= c->radius; i++) {
                const int v = ssfr_clamp_int(y + i * step[1], first, first + side - 1);
                const double *at = ssfr_field_fetch(from, x + i * step[0], v);
                for (int k = 0; k < 4; k++) sum[k] += at[k];
            }
            for (int k = 0; k < 4; k++) ssfr_field_at(to, x, y)[k] = sum[k] / (2 * c->radius + 1);
        }
}

void ssfr_shadow_basis_cpu(const ssfr_run *run)
{
    static const int along_rows[2] = {1, 0}, along_columns[2] = {0, 1};
    write_values(run);
    if (((const ssfr_shadow_basis_coeffs *)run->coeffs)->radius == 0) return;
    filter(run, run->out[0], run->scratch[0], along_rows);
    filter(run, run->scratch[0], run->out[0], along_columns);
}

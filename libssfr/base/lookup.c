/* SPDX-License-Identifier: MIT */
/* lookup.c: constant textures made, stored as a GPU stores them, and read between their texels in double. */
#include "base/lookup.h"

static size_t texel_bytes(const ssfr_lookup *t)
{
    return (size_t)t->c * (t->store == SSFR_LOOKUP_UNORM8 ? sizeof(unsigned char) : sizeof(float));
}

size_t ssfr_lookup_bytes(const ssfr_lookup *t)
{
    return (size_t)t->w * (size_t)t->h * (size_t)t->d * texel_bytes(t);
}

static void store_texel(const ssfr_texels *texels, size_t i, const double *texel)
{
    const ssfr_lookup *t = texels->table;
    for (size_t k = 0; k < (size_t)t->c; k++) {
        const size_t at = i * (size_t)t->c + k;
        if (t->store == SSFR_LOOKUP_UNORM8)
            ((unsigned char *)texels->data)[at] = (unsigned char)lrint(255 * ssfr_clamp(texel[k], 0, 1));
        else
            ((float *)texels->data)[at] = (float)texel[k];
    }
}

ssfr_result ssfr_texels_init(ssfr_texels *out, const ssfr_lookup *table)
{
    ssfr_result result = SSFR_OK;
    *out = (ssfr_texels){.table = table};
    SSFR_TRY(ssfr_alloc(&out->data, ssfr_lookup_bytes(table), 1, table->name));
    size_t i = 0;
    for (int z = 0; z < table->d; z++)
        for (int y = 0; y < table->h; y++)
            for (int x = 0; x < table->w; x++) {
                double texel[4] = {0};
                table->fill(x, y, z, texel);
                store_texel(out, i++, texel);
            }
end:
    return result;
}

void ssfr_texels_finish(ssfr_texels *texels)
{
    free(texels->data);
    *texels = (ssfr_texels){0};
}

double ssfr_texel_at(const ssfr_texels *texels, int x, int y, int z, int channel)
{
    const ssfr_lookup *t = texels->table;
    const size_t row = (size_t)z * (size_t)t->h + (size_t)y;
    const size_t at = (row * (size_t)t->w + (size_t)x) * (size_t)t->c + (size_t)channel;
    return t->store == SSFR_LOOKUP_UNORM8 ? ((const unsigned char *)texels->data)[at] / 255.0
                                         : (double)((const float *)texels->data)[at];
}

/* The texels on both sides of a place along one axis, and the share of the second. */
static double neighbours(double place, int n, bool repeats, int pair[2])
{
    double p = isfinite(place) ? place : 0;
    if (repeats) p -= floor(p);
    p = ssfr_clamp(p, 0, 1) * n - 0.5;
    const int i = (int)floor(p);
    for (int k = 0; k < 2; k++) pair[k] = repeats ? (i + k + n) % n : ssfr_clamp_int(i + k, 0, n - 1);
    return p - i;
}

double ssfr_texels_between(const ssfr_texels *texels, const double place[3], int channel)
{
    const ssfr_lookup *t = texels->table;
    const int sizes[3] = {t->w, t->h, t->d};
    int pair[3][2];
    double share[3], sum = 0;
    for (int k = 0; k < 3; k++) share[k] = neighbours(place[k], sizes[k], t->repeats, pair[k]);
    for (int corner = 0; corner < 8; corner++) {
        const int side[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
        double weight = 1;
        for (int k = 0; k < 3; k++) weight *= side[k] ? share[k] : 1 - share[k];
        if (weight > 0)
            sum += weight * ssfr_texel_at(texels, pair[0][side[0]], pair[1][side[1]], pair[2][side[2]], channel);
    }
    return sum;
}

double ssfr_lookup_rounding(const ssfr_lookup *table, double step)
{
    const int axes = (table->w > 1) + (table->h > 1) + (table->d > 1);
    return axes * step / 512 + (table->store == SSFR_LOOKUP_UNORM8 ? 1 / 255.0 : 0);
}

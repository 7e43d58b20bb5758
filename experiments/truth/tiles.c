/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tiles.c: tiles of an image, and one pixel of each square. */
#include "experiments/truth/tiles.h"

const ssfr_truth_channel_row ssfr_truth_channels[SSFR_N_TRUTH_CHANNELS] = {
#define X(id, n, names, part, unit, help) {#id, names, n, SSFR_TRUTH_##part, unit, help},
#include "experiments/truth/channels.def"
#undef X
};

static void lay_out(ssfr_tiles *tiles, unsigned parts)
{
    for (int i = 0; i < SSFR_N_TRUTH_CHANNELS; i++) {
        const ssfr_truth_channel_row *row = &ssfr_truth_channels[i];
        tiles->at[i] = row->part & (int)parts ? tiles->n_values : -1;
        if (tiles->at[i] >= 0) tiles->n_values += row->n;
    }
    if (tiles->at[SSFR_TRUTH_depth] >= 0) tiles->empty[tiles->at[SSFR_TRUTH_depth]] = -SSFR_EMPTY;
}

ssfr_result ssfr_tiles_init(ssfr_tiles *out, int w, int h, unsigned parts, int every, uint64_t seed)
{
    const int tiles_x = (w + SSFR_TRUTH_TILE - 1) / SSFR_TRUTH_TILE;
    const int tiles_y = (h + SSFR_TRUTH_TILE - 1) / SSFR_TRUTH_TILE;
    int pixels[SSFR_TRUTH_TILE_PIXELS][2];
    *out = (ssfr_tiles){.w = w, .h = h, .every = every, .seed = seed, .tiles_x = tiles_x, .n = tiles_x * tiles_y};
    lay_out(out, parts);
    const ssfr_result result = ssfr_alloc(&out->first, (size_t)out->n + 1, sizeof *out->first, "tiles");
    for (int i = 0; i < out->n && result == SSFR_OK; i++)
        out->first[i + 1] = out->first[i] + (size_t)ssfr_tiles_pixels(out, i, pixels);
    return result;
}

void ssfr_tiles_finish(ssfr_tiles *tiles)
{
    free(tiles->first);
    *tiles = (ssfr_tiles){0};
}

void ssfr_tiles_choose(const ssfr_tiles *tiles, int x, int y, int pixel[2])
{
    const int w = ssfr_min_int(tiles->every, tiles->w - x), h = ssfr_min_int(tiles->every, tiles->h - y);
    const uint64_t square = (uint64_t)y << 32 | (uint64_t)x;
    const uint64_t bits = ssfr_mix_bits(ssfr_mix_bits(tiles->seed + UINT64_C(0x9e3779b97f4a7c15)) ^ square);
    const int k = (int)((double)w * h * (double)(bits >> 11) * 0x1p-53);
    pixel[0] = x + k % w;
    pixel[1] = y + k / w;
}

int ssfr_tiles_pixels(const ssfr_tiles *tiles, int tile, int pixels[SSFR_TRUTH_TILE_PIXELS][2])
{
    const int every = tiles->every;
    const int x0 = tile % tiles->tiles_x * SSFR_TRUTH_TILE, x1 = ssfr_min_int(x0 + SSFR_TRUTH_TILE, tiles->w);
    const int y0 = tile / tiles->tiles_x * SSFR_TRUTH_TILE, y1 = ssfr_min_int(y0 + SSFR_TRUTH_TILE, tiles->h);
    int n = 0;
    for (int y = y0 / every * every; y < y1; y += every)
        for (int x = x0 / every * every; x < x1; x += every) {
            int pixel[2];
            ssfr_tiles_choose(tiles, x, y, pixel);
            if (pixel[0] < x0 || pixel[0] >= x1 || pixel[1] < y0 || pixel[1] >= y1) continue;
            memcpy(pixels[n++], pixel, sizeof pixel);
        }
    return n;
}

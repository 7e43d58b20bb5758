/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tile_file.c: tiles in a file, each at its own place. */
#include "experiments/truth/tile_file.h"
#include "experiments/cache.h"
#include "experiments/hash.h"

#include <errno.h>
#include <inttypes.h>
#include <unistd.h>

typedef struct head { /* of a tile; as it stands in memory: the cache is this machine's own */
    uint64_t check;   /* hash of key, tile, the rest of the head, and of the pixels */
    uint64_t empty;   /* 1: all pixels hold their empty values, and are not there */
    ssfr_truth_tally tally;
} head;

static uint64_t sum_up(const ssfr_tile_file *file, int tile, const head *h, const double *values, size_t size)
{
    const uint64_t of[] = {file->key, (uint64_t)tile, h->empty};
    uint64_t hash = ssfr_hash_bytes(SSFR_HASH, of, sizeof of);
    hash = ssfr_hash_bytes(hash, &h->tally, sizeof h->tally);
    return ssfr_hash_bytes(hash, values, size);
}

static size_t pixel_size(const ssfr_tile_file *file)
{
    return (size_t)file->tiles->n_values * sizeof(double);
}

/* Bytes of the tile's pixels. */
static size_t tile_size(const ssfr_tile_file *file, int tile)
{
    return (file->tiles->first[tile + 1] - file->tiles->first[tile]) * pixel_size(file);
}

static off_t place_of(const ssfr_tile_file *file, int tile)
{
    return (off_t)((size_t)tile * sizeof(head) + file->tiles->first[tile] * pixel_size(file));
}

static bool is_empty(const ssfr_tile_file *file, int tile, const double *values)
{
    const size_t n = file->tiles->first[tile + 1] - file->tiles->first[tile];
    bool empty = true;
    for (size_t i = 0; i < n && empty; i++)
        empty = memcmp(values + i * (size_t)file->tiles->n_values, file->tiles->empty, pixel_size(file)) == 0;
    return empty;
}

/* ---- the file ---------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_tile_file_open(ssfr_tile_file *out, const ssfr_tiles *tiles, uint64_t key, const char *folder,
                                  bool anew)
{
    ssfr_result result = SSFR_OK;
    char *root = NULL;
    *out = (ssfr_tile_file){.fd = -1, .key = key, .tiles = tiles};
    SSFR_TRY(ssfr_cache_find(&root, folder, "truth"));
    const size_t size = strlen(root) + 64;
    SSFR_TRY(ssfr_alloc(&out->path, size, 1, "a path"));
    snprintf(out->path, size, "%s%s", root, folder ? "/truth" : "");
    SSFR_TRY(ssfr_cache_make_folders(out->path));
    snprintf(out->path + strlen(out->path), size - strlen(out->path), "/%016" PRIx64 ".tiles", key);
    SSFR_TRY(ssfr_cache_hold(out->path, out->path, &out->fd));
    if (anew && ftruncate(out->fd, 0) != 0) result = ssfr_fail(SSFR_ERR_IO, "%s: %s", out->path, strerror(errno));
end:
    free(root);
    if (result != SSFR_OK) ssfr_tile_file_close(out);
    return result;
}

void ssfr_tile_file_close(ssfr_tile_file *file)
{
    if (file->path && file->fd >= 0) close(file->fd);
    free(file->path);
    *file = (ssfr_tile_file){.fd = -1};
}

/* What is not there is not read. */
static bool read_at(int fd, void *data, size_t size, off_t at)
{
    size_t done = 0;
    while (done < size) {
        const ssize_t n = pread(fd, (char *)data + done, size - done, at + (off_t)done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        done += (size_t)n;
    }
    return done == size;
}

static bool write_at(int fd, const void *data, size_t size, off_t at)
{
    size_t done = 0;
    while (done < size) {
        const ssize_t n = pwrite(fd, (const char *)data + done, size - done, at + (off_t)done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        done += (size_t)n;
    }
    return done == size;
}

bool ssfr_tile_file_read(const ssfr_tile_file *file, int tile, double *values, ssfr_truth_tally *tally)
{
    if (!file->path) return false;
    const off_t at = place_of(file, tile);
    const size_t size = tile_size(file, tile);
    head h;
    if (!read_at(file->fd, &h, sizeof h, at)) return false;
    if (h.empty)
        for (size_t i = 0; i < size; i += pixel_size(file))
            memcpy((char *)values + i, file->tiles->empty, pixel_size(file));
    else if (!read_at(file->fd, values, size, at + (off_t)sizeof h))
        return false;
    *tally = h.tally;
    return h.check == sum_up(file, tile, &h, values, size);
}

/* The pixels come before the head that vouches for them. */
ssfr_result ssfr_tile_file_write(const ssfr_tile_file *file, int tile, const double *values,
                                   const ssfr_truth_tally *tally)
{
    if (!file->path) return SSFR_OK;
    const off_t at = place_of(file, tile);
    const size_t size = tile_size(file, tile);
    head h = {.empty = is_empty(file, tile, values), .tally = *tally};
    h.check = sum_up(file, tile, &h, values, size);
    errno = 0;
    if ((h.empty || write_at(file->fd, values, size, at + (off_t)sizeof h)) && write_at(file->fd, &h, sizeof h, at))
        return SSFR_OK;
    return ssfr_fail(SSFR_ERR_IO, "%s: %s", file->path, errno ? strerror(errno) : "cannot be written");
}

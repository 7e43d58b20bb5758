/* SPDX-License-Identifier: MIT */
/* grid.c: points sorted by cells; a hash of the rows of cells along x finds the 27 cells around a place.
 *
 *      key of a cell:   z | y | x      bits of its whole coordinates, counted from the least that occurs
 *      sorted points:   aaa b cc | dd e | f ...        letters are cells, | is between rows (same z and y)
 *      begins:          ^   ^ ^    ^  ^   ^            where each cell begins
 *      rows:            ^          ^      ^            the first cell of each row
 *      table:           hash(z, y) -> row              at most half full */
#include "scene/grid.h"

#include <limits.h>

enum {
    REACH = 1 << 20,             /* cell coordinates lie in [-REACH, REACH) */
    DIGIT_BITS = 11,             /* of the radix sort: its counts fit the first cache */
    N_DIGITS = 1 << DIGIT_BITS,
    N_CHUNKS = 16,               /* parts that are sorted in parallel; their number changes no result */
    MIN_CHUNK = 2048,            /* points, below which a part is not worth a thread */
};

struct ssfr_grid {
    double cell, per_cell;       /* m, 1/m */
    int lo[3], hi[3];            /* cells that occur */
    int bits[3];                 /* of a coordinate from lo */
    size_t n, capacity;          /* points */
    uint64_t *keys, *spare_keys; /* of the sorted points; in spare_keys, after sorting, of the cells */
    uint32_t *order, *spare_order;
    size_t n_cells, n_rows;
    uint32_t *begins;            /* n_cells + 1, into order */
    uint32_t *rows;              /* n_rows + 1, into begins */
    uint32_t *table;             /* row + 1; 0: free */
    size_t table_mask, table_capacity;
    uint32_t (*counts)[N_DIGITS]; /* N_CHUNKS of them */
};

ssfr_result ssfr_grid_create(ssfr_grid **out)
{
    ssfr_result result = SSFR_OK;
    ssfr_grid *grid = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&grid, 1, sizeof *grid, "a grid"));
    grid->cell = grid->per_cell = 1;
    SSFR_TRY(ssfr_alloc(&grid->counts, N_CHUNKS, sizeof *grid->counts, "a grid"));
    *out = grid;
    grid = NULL;
end:
    ssfr_grid_destroy(&grid);
    return result;
}

static void free_points(ssfr_grid *grid)
{
    free(grid->keys), free(grid->spare_keys);
    free(grid->order), free(grid->spare_order);
    free(grid->begins), free(grid->rows), free(grid->table);
    grid->keys = grid->spare_keys = NULL;
    grid->order = grid->spare_order = grid->begins = grid->rows = grid->table = NULL;
    grid->n = grid->n_cells = grid->n_rows = grid->capacity = grid->table_capacity = 0;
}

void ssfr_grid_destroy(ssfr_grid **grid)
{
    if (*grid) {
        free_points(*grid);
        free((*grid)->counts);
    }
    free(*grid);
    *grid = NULL;
}

/* Room for n points, with some to spare, so that a growing set does not come here each time. */
static ssfr_result reserve(ssfr_grid *grid, size_t n)
{
    ssfr_result result = SSFR_OK;
    if (n <= grid->capacity && grid->keys) return SSFR_OK;
    const size_t wanted = n + n / 4;
    size_t table = 2;
    while (table < 2 * wanted) table *= 2;
    free_points(grid);
    SSFR_TRY(ssfr_alloc(&grid->keys, wanted, sizeof *grid->keys, "cells of points"));
    SSFR_TRY(ssfr_alloc(&grid->spare_keys, wanted, sizeof *grid->keys, "cells of points"));
    SSFR_TRY(ssfr_alloc(&grid->order, wanted, sizeof *grid->order, "cells of points"));
    SSFR_TRY(ssfr_alloc(&grid->spare_order, wanted, sizeof *grid->order, "cells of points"));
    SSFR_TRY(ssfr_alloc(&grid->begins, wanted + 1, sizeof *grid->begins, "cells of points"));
    SSFR_TRY(ssfr_alloc(&grid->rows, wanted + 1, sizeof *grid->rows, "cells of points"));
    SSFR_TRY(ssfr_alloc(&grid->table, table, sizeof *grid->table, "cells of points"));
    grid->capacity = wanted;
    grid->table_capacity = table;
end:
    if (result != SSFR_OK) free_points(grid);
    return result;
}

/* ---- keys -------------------------------------------------------------------------------------------------------- */

/* Whole coordinates of the cell that holds `at`; false where they lie outside [-reach, reach) or `at` is not finite. */
static bool find_cell(const ssfr_grid *grid, double reach, const float at[3], int cell[3])
{
    bool inside = true;
    for (int k = 0; k < 3; k++) {
        const double c = floor((double)at[k] * grid->per_cell);
        inside = inside && c >= -reach && c < reach; /* false for NaN */
        cell[k] = inside ? (int)c : 0;
    }
    return inside;
}

static uint64_t make_key(const ssfr_grid *grid, const int cell[3])
{
    const uint64_t x = (uint64_t)(cell[0] - grid->lo[0]), y = (uint64_t)(cell[1] - grid->lo[1]),
                   z = (uint64_t)(cell[2] - grid->lo[2]);
    return (z << grid->bits[1] | y) << grid->bits[0] | x;
}

static ssfr_result refuse(const ssfr_grid *grid, size_t i, const float at[3])
{
    if (isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]))
        return ssfr_fail(SSFR_ERR_VALUE, "point %zu (from 0): (%g, %g, %g) is 2^20 cells of %g m or more away", i,
                         (double)at[0], (double)at[1], (double)at[2], grid->cell);
    return ssfr_fail(SSFR_ERR_VALUE, "point %zu (from 0): (%g, %g, %g) is not finite", i, (double)at[0],
                     (double)at[1], (double)at[2]);
}

/* The box of cells that occur; refuses points without a cell. */
static ssfr_result find_bounds(ssfr_grid *grid, size_t n, const float *points)
{
    int x0 = INT_MAX, y0 = INT_MAX, z0 = INT_MAX, x1 = INT_MIN, y1 = INT_MIN, z1 = INT_MIN;
    size_t bad = n;
#pragma omp parallel for schedule(static) reduction(min : x0, y0, z0, bad) reduction(max : x1, y1, z1) \
    if (n > MIN_CHUNK)
    for (size_t i = 0; i < n; i++) {
        int c[3];
        if (!find_cell(grid, REACH, points + 3 * i, c)) {
            bad = i < bad ? i : bad;
            continue;
        }
        x0 = ssfr_min_int(x0, c[0]), y0 = ssfr_min_int(y0, c[1]), z0 = ssfr_min_int(z0, c[2]);
        x1 = ssfr_max_int(x1, c[0]), y1 = ssfr_max_int(y1, c[1]), z1 = ssfr_max_int(z1, c[2]);
    }
    if (bad < n) return refuse(grid, bad, points + 3 * bad);
    const int lo[3] = {x0, y0, z0}, hi[3] = {x1, y1, z1};
    for (int k = 0; k < 3; k++) {
        grid->lo[k] = n ? lo[k] : 0;
        grid->hi[k] = n ? hi[k] : 0;
        grid->bits[k] = 0;
        while ((grid->hi[k] - grid->lo[k]) >> grid->bits[k]) grid->bits[k]++;
    }
    return SSFR_OK;
}

/* ---- sorting: stable, hence the same for any number of chunks and threads ---------------------------------------- */

static void sort_by_digit(ssfr_grid *grid, int n_chunks, int shift, int digit_bits)
{
    const uint64_t mask = ((uint64_t)1 << digit_bits) - 1;
    const size_t n = grid->n, n_digits = (size_t)1 << digit_bits;
#pragma omp parallel for schedule(static) if (n_chunks > 1)
    for (int c = 0; c < n_chunks; c++) {
        const size_t first = n * (size_t)c / (size_t)n_chunks, last = n * (size_t)(c + 1) / (size_t)n_chunks;
        memset(grid->counts[c], 0, n_digits * sizeof **grid->counts);
        for (size_t i = first; i < last; i++) grid->counts[c][grid->keys[i] >> shift & mask]++;
    }
    uint32_t start = 0;
    for (size_t d = 0; d < n_digits; d++)
        for (int c = 0; c < n_chunks; c++) {
            const uint32_t count = grid->counts[c][d];
            grid->counts[c][d] = start;
            start += count;
        }
#pragma omp parallel for schedule(static) if (n_chunks > 1)
    for (int c = 0; c < n_chunks; c++) {
        const size_t first = n * (size_t)c / (size_t)n_chunks, last = n * (size_t)(c + 1) / (size_t)n_chunks;
        for (size_t i = first; i < last; i++) {
            const uint32_t to = grid->counts[c][grid->keys[i] >> shift & mask]++;
            grid->spare_keys[to] = grid->keys[i];
            grid->spare_order[to] = grid->order[i];
        }
    }
}

static void sort(ssfr_grid *grid)
{
    const int bits = grid->bits[0] + grid->bits[1] + grid->bits[2];
    const int n_passes = (bits + DIGIT_BITS - 1) / DIGIT_BITS;
    const int digit_bits = n_passes ? (bits + n_passes - 1) / n_passes : 0;
    const int n_chunks = (int)(grid->n / MIN_CHUNK) + 1;
    for (int p = 0; p < n_passes; p++) {
        sort_by_digit(grid, ssfr_min_int(n_chunks, N_CHUNKS), p * digit_bits, digit_bits);
        uint64_t *const keys = grid->keys;
        uint32_t *const order = grid->order;
        grid->keys = grid->spare_keys, grid->spare_keys = keys;
        grid->order = grid->spare_order, grid->spare_order = order;
    }
}

/* ---- cells and rows ---------------------------------------------------------------------------------------------- */

/* Where the search for a row begins. The multiplier is 2^64 over the golden ratio (Knuth, volume 3, section 6.4). */
static size_t hash_row(const ssfr_grid *grid, uint64_t row)
{
    return (size_t)(row * 0x9e3779b97f4a7c15u >> 32) & grid->table_mask;
}

static uint64_t row_key(const ssfr_grid *grid, size_t row)
{
    return grid->spare_keys[grid->rows[row]] >> grid->bits[0];
}

/* Lists the cells, with their keys in spare_keys, and the rows. */
static void find_cells(ssfr_grid *grid)
{
    size_t n_cells = 0, n_rows = 0;
    for (size_t i = 0; i < grid->n; i++) {
        const uint64_t key = grid->keys[i];
        if (n_cells && grid->spare_keys[n_cells - 1] == key) continue;
        if (!n_cells || grid->spare_keys[n_cells - 1] >> grid->bits[0] != key >> grid->bits[0])
            grid->rows[n_rows++] = (uint32_t)n_cells;
        grid->spare_keys[n_cells] = key;
        grid->begins[n_cells++] = (uint32_t)i;
    }
    grid->begins[n_cells] = (uint32_t)grid->n;
    grid->rows[n_rows] = (uint32_t)n_cells;
    grid->n_cells = n_cells;
    grid->n_rows = n_rows;
}

static void hash_rows(ssfr_grid *grid)
{
    size_t size = 2;
    while (size < 2 * grid->n_rows) size *= 2;
    grid->table_mask = size - 1;
    memset(grid->table, 0, size * sizeof *grid->table);
    for (size_t row = 0; row < grid->n_rows; row++) {
        size_t at = hash_row(grid, row_key(grid, row));
        while (grid->table[at]) at = (at + 1) & grid->table_mask;
        grid->table[at] = (uint32_t)row + 1;
    }
}

ssfr_result ssfr_grid_build(ssfr_grid *grid, size_t n, const float *points, double cell)
{
    ssfr_result result = SSFR_OK;
    grid->n = grid->n_cells = grid->n_rows = 0;
    if (!(cell > 0 && isfinite(cell) && isfinite(1 / cell)))
        return ssfr_fail(SSFR_ERR_VALUE, "cells of %g m: expected a positive number", cell);
    if (n >= UINT32_MAX) return ssfr_fail(SSFR_ERR_VALUE, "%zu points: fewer than %u can be sorted", n, UINT32_MAX);
    grid->cell = cell;
    /* A little wider than asked for: points a cell's edge apart stay in cells side by side after all rounding. */
    grid->per_cell = (1 - 0x1p-30) / cell;
    SSFR_TRY(reserve(grid, n));
    SSFR_TRY(find_bounds(grid, n, points));
    grid->n = n;
#pragma omp parallel for schedule(static) if (n > MIN_CHUNK)
    for (size_t i = 0; i < n; i++) {
        int c[3];
        find_cell(grid, REACH, points + 3 * i, c);
        grid->keys[i] = make_key(grid, c);
        grid->order[i] = (uint32_t)i;
    }
    sort(grid);
    find_cells(grid);
    hash_rows(grid);
end:
    return result;
}

/* ---- looking up -------------------------------------------------------------------------------------------------- */

const uint32_t *ssfr_grid_order(const ssfr_grid *grid)
{
    return grid->order;
}

double ssfr_grid_cell(const ssfr_grid *grid)
{
    return grid->cell;
}

size_t ssfr_grid_n_cells(const ssfr_grid *grid)
{
    return grid->n_cells;
}

ssfr_grid_range ssfr_grid_cell_at(const ssfr_grid *grid, size_t cell)
{
    return (ssfr_grid_range){grid->begins[cell], grid->begins[cell + 1]};
}

void ssfr_grid_settle(ssfr_grid *grid)
{
    for (size_t i = 0; i < grid->n; i++) grid->order[i] = (uint32_t)i;
}

size_t ssfr_grid_bytes(const ssfr_grid *grid)
{
    return sizeof *grid + N_CHUNKS * sizeof *grid->counts + grid->table_capacity * sizeof *grid->table +
           grid->capacity * (2 * sizeof *grid->keys + 4 * sizeof *grid->order);
}

/* The points of the cells first .. last (keys) of a row; empty where there are none. */
static ssfr_grid_range find_range(const ssfr_grid *grid, size_t row, uint64_t first, uint64_t last)
{
    size_t low = grid->rows[row], high = grid->rows[row + 1];
    const size_t end = high;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (grid->spare_keys[middle] < first)
            low = middle + 1;
        else
            high = middle;
    }
    while (high < end && grid->spare_keys[high] <= last) high++; /* three at most */
    return (ssfr_grid_range){grid->begins[low], grid->begins[high]};
}

int ssfr_grid_near(const ssfr_grid *grid, const float at[3], ssfr_grid_range ranges[SSFR_GRID_ROWS])
{
    int n = 0, c[3];
    if (!grid->n || !find_cell(grid, REACH + 1, at, c)) return 0;
    const int x0 = ssfr_max_int(c[0] - 1, grid->lo[0]), x1 = ssfr_min_int(c[0] + 1, grid->hi[0]);
    const int y0 = ssfr_max_int(c[1] - 1, grid->lo[1]), y1 = ssfr_min_int(c[1] + 1, grid->hi[1]);
    const int z0 = ssfr_max_int(c[2] - 1, grid->lo[2]), z1 = ssfr_min_int(c[2] + 1, grid->hi[2]);
    for (int z = z0; z <= z1 && x0 <= x1; z++)
        for (int y = y0; y <= y1; y++) {
            const uint64_t first = make_key(grid, (int[3]){x0, y, z}), last = make_key(grid, (int[3]){x1, y, z});
            const uint64_t key = first >> grid->bits[0];
            size_t slot = hash_row(grid, key);
            while (grid->table[slot] && row_key(grid, grid->table[slot] - 1) != key)
                slot = (slot + 1) & grid->table_mask;
            if (!grid->table[slot]) continue;
            ranges[n] = find_range(grid, grid->table[slot] - 1, first, last);
            n += ranges[n].begin < ranges[n].end;
        }
    return n;
}

ssfr_result ssfr_grid_points(const ssfr_particles *particles, double origin[3], float **points)
{
    ssfr_result result = SSFR_OK;
    double lo[3], hi[3];
    *points = NULL;
    ssfr_particles_bounds(particles, lo, hi);
    for (int k = 0; k < 3; k++) origin[k] = 0.5 * lo[k] + 0.5 * hi[k];
    SSFR_TRY(ssfr_alloc(points, particles->n, 3 * sizeof **points, "points"));
    for (size_t i = 0; i < particles->n; i++) {
        double at[3];
        ssfr_particles_position(particles, i, at);
        for (size_t k = 0; k < 3; k++) (*points)[3 * i + k] = (float)(at[k] - origin[k]);
    }
end:
    return result;
}

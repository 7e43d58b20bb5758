/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truth.c: casting an image tile by tile, with what was cast before. */
#include "experiments/truth/truth.h"
#include "experiments/console.h"
#include "experiments/interrupt.h"
#include "experiments/truth/pixel.h"
#include "experiments/truth/tile_file.h"

#include "base/field.h"
#include "base/param.h"

#include <omp.h>
#include <time.h>

/* One call. */
typedef struct casting {
    const ssfr_truth_options *options;
    ssfr_truth *truth;
    ssfr_tiles tiles;
    ssfr_tile_file file;
    unsigned char *done;  /* of each tile */
    size_t n_done, n_recalled;
    ssfr_result failed;   /* the first thing that did */
    ssfr_truth_scene scene;
    int n_workers;
    ssfr_truth_worker *workers;
} casting;

/* ---- the image --------------------------------------------------------------------------------------------------- */

static ssfr_result make_fields(casting *c)
{
    ssfr_result result = SSFR_OK;
    ssfr_truth *truth = c->truth;
    for (int i = 0; i < SSFR_N_TRUTH_CHANNELS; i++) {
        if (c->tiles.at[i] < 0) continue;
        SSFR_TRY(ssfr_field_create(&truth->channels[i], truth->w, truth->h, ssfr_truth_channels[i].n));
        if (i == SSFR_TRUTH_depth) ssfr_field_fill(truth->channels[i], -SSFR_EMPTY);
    }
    SSFR_TRY(ssfr_field_create(&truth->cast, truth->w, truth->h, 1));
end:
    return result;
}

static void store_tile(casting *c, int tile, const double *values)
{
    int pixels[SSFR_TRUTH_TILE_PIXELS][2];
    const int n = ssfr_tiles_pixels(&c->tiles, tile, pixels);
    for (int p = 0; p < n; p++, values += c->tiles.n_values) {
        const int x = pixels[p][0], y = pixels[p][1];
        *ssfr_field_at(c->truth->cast, x, y) = 1;
        for (int i = 0; i < SSFR_N_TRUTH_CHANNELS; i++)
            if (c->tiles.at[i] >= 0)
                memcpy(ssfr_field_at(c->truth->channels[i], x, y), values + c->tiles.at[i],
                       (size_t)ssfr_truth_channels[i].n * sizeof *values);
    }
    c->done[tile] = 1;
}

/* Each tile's tally is taken once, in whatever order. Only the seconds are a sum of fractions, and no result. */
static void count_tile(casting *c, const ssfr_truth_tally *tally)
{
    ssfr_truth_stats *stats = &c->truth->stats;
    stats->rays += tally->rays;
    stats->crossings += tally->crossings;
    stats->touches += tally->touches;
    stats->light_touches += tally->light_touches;
    stats->judged += tally->judged;
    stats->judged_max = fmax(stats->judged_max, tally->judged_max);
    stats->judged_ratio = fmax(stats->judged_ratio, tally->judged_ratio);
    stats->seconds += tally->seconds;
    c->n_done++;
}

static ssfr_result recall_tiles(casting *c)
{
    ssfr_result result = SSFR_OK;
    double *values = NULL;
    SSFR_TRY(ssfr_alloc(&values, (size_t)(SSFR_TRUTH_TILE_PIXELS * c->tiles.n_values), sizeof *values, "a tile"));
    for (int i = 0; i < c->tiles.n; i++) {
        ssfr_truth_tally tally;
        if (!ssfr_tile_file_read(&c->file, i, values, &tally)) continue;
        store_tile(c, i, values);
        count_tile(c, &tally);
    }
end:
    free(values);
    return result;
}

/* ---- casting ----------------------------------------------------------------------------------------------------- */

static ssfr_result make_workers(casting *c)
{
    ssfr_result result = SSFR_OK;
    const int n = ssfr_min_int(omp_get_max_threads(), c->tiles.n);
    SSFR_TRY(ssfr_alloc(&c->workers, (size_t)n, sizeof *c->workers, "threads"));
    for (; c->n_workers < n; c->n_workers++)
        SSFR_TRY(ssfr_truth_worker_init(&c->workers[c->n_workers], &c->scene));
end:
    return result;
}

/* s, of the thread that asks: others that the machine runs meanwhile do not count. */
static double thread_seconds(void)
{
    struct timespec now = {0};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static ssfr_result cast_pixels(ssfr_truth_worker *worker, const ssfr_tiles *tiles, int tile, double *values,
                               ssfr_truth_tally *tally)
{
    ssfr_result result = SSFR_OK;
    int pixels[SSFR_TRUTH_TILE_PIXELS][2];
    const int n = ssfr_tiles_pixels(tiles, tile, pixels);
    const double begun = thread_seconds();
    for (int p = 0; p < n && result == SSFR_OK; p++)
        result = ssfr_truth_pixel(worker, pixels[p][0], pixels[p][1], values + p * tiles->n_values, tally);
    tally->seconds = thread_seconds() - begun;
    return result;
}

/* Of the tiles that were missing. */
static void show_progress(const casting *c)
{
    if (c->options->progress)
        ssfr_console_progress("truth", c->n_done - c->n_recalled, (size_t)c->tiles.n - c->n_recalled);
}

/* Into the file and the image. */
static ssfr_result keep_tile(casting *c, int tile, const double *values, const ssfr_truth_tally *tally)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_tile_file_write(&c->file, tile, values, tally));
    store_tile(c, tile, values);
    count_tile(c, tally);
    show_progress(c);
end:
    return result;
}

/* Other threads cast others. They are kept one by one: of a disk that is full only the first of them tells. */
static void cast_tile(casting *c, int tile)
{
    ssfr_result result = SSFR_OK;
    ssfr_truth_tally tally = {0};
    double *values = NULL;
    SSFR_TRY(ssfr_alloc(&values, (size_t)(SSFR_TRUTH_TILE_PIXELS * c->tiles.n_values), sizeof *values, "a tile"));
    SSFR_TRY(cast_pixels(&c->workers[omp_get_thread_num()], &c->tiles, tile, values, &tally));
end:
#pragma omp critical(ssfr_truth)
    if (c->failed == SSFR_OK) {
        if (result == SSFR_OK) result = keep_tile(c, tile, values, &tally);
#pragma omp atomic write
        c->failed = result;
    }
    free(values);
}

/* The first thing that goes wrong ends the work of all. */
static ssfr_result cast_tiles(casting *c)
{
    show_progress(c);
#pragma omp parallel for schedule(dynamic) num_threads(c->n_workers)
    for (int i = 0; i < c->tiles.n; i++) {
        ssfr_result failed;
#pragma omp atomic read
        failed = c->failed;
        if (!c->done[i] && failed == SSFR_OK && !ssfr_interrupt_came()) cast_tile(c, i);
    }
    if (c->options->progress) ssfr_console_progress("truth", 1, 1);
    if (c->failed == SSFR_OK && c->n_done < (size_t)c->tiles.n)
        c->failed = ssfr_fail(SSFR_ERR_IO, "interrupted after %zu of %d tiles%s", c->n_done, c->tiles.n,
                              c->file.path ? ": the same command goes on from there" : ", which nothing keeps");
    return c->failed;
}

static double bytes_of(const ssfr_truth_scene *scene)
{
    return (double)ssfr_continuum_bytes(&scene->fluid) + (double)ssfr_continuum_bytes(&scene->foam.kernels);
}

static ssfr_result cast_missing(casting *c, const ssfr_stage *stage, const ssfr_truth_params *params)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_truth_scene_init(&c->scene, stage, params, &c->tiles));
    SSFR_TRY(make_workers(c));
    c->truth->stats.bytes = bytes_of(&c->scene);
    SSFR_TRY(cast_tiles(c));
end:
    return result;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_truth_check(const ssfr_truth_params *params, const ssfr_truth_options *options)
{
    if (params->cast.parts == 0) return ssfr_fail(SSFR_ERR_VALUE, "truth.parts=none: there is nothing to cast");
    if (options->every < 1 || options->every > SSFR_MAX_SIZE)
        return ssfr_fail(SSFR_ERR_VALUE, "every %d pixels: expected 1 to %d", options->every, SSFR_MAX_SIZE);
    return SSFR_OK;
}

static ssfr_result run(casting *c, const ssfr_stage *stage, const ssfr_truth_params *params)
{
    ssfr_result result = SSFR_OK;
    const ssfr_truth_options *o = c->options;
    const uint64_t key = o->no_cache ? 0 : ssfr_truth_key(stage, params, o);
    SSFR_TRY(ssfr_tiles_init(&c->tiles, c->truth->w, c->truth->h, c->truth->parts, o->every, o->seed));
    SSFR_TRY(ssfr_alloc(&c->done, (size_t)c->tiles.n, 1, "tiles"));
    SSFR_TRY(make_fields(c));
    if (!o->no_cache) SSFR_TRY(ssfr_tile_file_open(&c->file, &c->tiles, key, o->cache, o->anew));
    SSFR_TRY(recall_tiles(c));
    c->n_recalled = c->n_done;
    c->truth->stats.cached = c->n_done == (size_t)c->tiles.n;
    if (!c->truth->stats.cached) SSFR_TRY(cast_missing(c, stage, params));
end:
    return result;
}

static void finish(casting *c)
{
    for (int i = 0; i < c->n_workers; i++) ssfr_truth_worker_finish(&c->workers[i]);
    free(c->workers);
    ssfr_truth_scene_finish(&c->scene);
    ssfr_tile_file_close(&c->file);
    ssfr_tiles_finish(&c->tiles);
    free(c->done);
}

ssfr_result ssfr_truth_create(ssfr_truth **out, const ssfr_stage *stage, const ssfr_truth_params *params,
                              const ssfr_truth_options *options)
{
    ssfr_result result = SSFR_OK;
    const ssfr_camera *camera = &stage->scene.camera;
    casting c = {.options = options};
    *out = NULL;
    SSFR_TRY(ssfr_truth_check(params, options));
    SSFR_TRY(ssfr_alloc(&c.truth, 1, sizeof *c.truth, "ground truth"));
    c.truth->w = camera->w, c.truth->h = camera->h;
    c.truth->parts = params->cast.parts, c.truth->every = options->every;
    ssfr_interrupt_begin();
    result = run(&c, stage, params);
    ssfr_interrupt_end();
    if (result != SSFR_OK) goto end;
    *out = c.truth;
    c.truth = NULL;
end:
    ssfr_truth_destroy(&c.truth);
    finish(&c);
    return result;
}

void ssfr_truth_destroy(ssfr_truth **truth)
{
    if (*truth) {
        for (int i = 0; i < SSFR_N_TRUTH_CHANNELS; i++) ssfr_field_destroy(&(*truth)->channels[i]);
        ssfr_field_destroy(&(*truth)->cast);
    }
    free(*truth);
    *truth = NULL;
}

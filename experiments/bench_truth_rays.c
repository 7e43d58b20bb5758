/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_truth_rays.c: waves of particles at rest, and the rays that are cast at them. */
#include "experiments/bench_truth.h"
#include "experiments/interrupt.h"
#include "experiments/truth/crossings.h"
#include "experiments/truth/tiles.h"

/* ---- water ------------------------------------------------------------------------------------------------------- */

const char *const ssfr_water_names[] = {"finer", "wider", NULL};
const char *const ssfr_water_help[] = {
    "1 m x 0.4 m x 0.5 m of water with waves, seen as a whole: more particles are smaller, a ray crosses more of them",
    "water with waves, 0.4 m deep, a part of it seen from above: more particles reach farther, a ray crosses as many"};
const char *const ssfr_rays_stages[3] = {"gather", "crossings", "chords"};

static const double depth = 0.4; /* m, on average */

typedef struct basin {
    double spacing;   /* m, of particles at rest */
    double half[2];   /* m, along x and z */
    double amplitude; /* m, of the waves */
} basin;

static basin basin_of(ssfr_waters kind, size_t n)
{
    enum { LAYERS = 16 }; /* of wider: 4096 particles fill a cube */
    const double length = 1, width = 0.5, side = depth / LAYERS * sqrt((double)n / LAYERS); /* m */
    if (kind == SSFR_WATER_WIDER) return (basin){depth / LAYERS, {0.5 * side, 0.5 * side}, 0.03};
    return (basin){cbrt(length * width * depth / (double)n), {0.5 * length, 0.5 * width}, 0.04};
}

/* m; 0.31 m and 0.23 m are lengths of waves that no spacing is a multiple of. */
static double surface_at(const basin *b, double x, double z)
{
    return depth + b->amplitude * (sin(2 * M_PI * x / 0.31 + 1) + sin(2 * M_PI * (z + 0.4 * x) / 0.23)) / 2;
}

/* In [-1, 1), of a particle's axis. */
static double chance(size_t i, int axis)
{
    return ldexp((double)(ssfr_mix_bits(3 * (uint64_t)i + (uint64_t)axis + 1) >> 11), -52) - 1;
}

/* Where positions is NULL it counts. */
static size_t fill(const basin *b, double *positions)
{
    const double s = b->spacing, scatter = 0.1 * s;
    const size_t nx = (size_t)lround(2 * b->half[0] / s), nz = (size_t)lround(2 * b->half[1] / s);
    const size_t ny = (size_t)ceil((depth + b->amplitude) / s);
    size_t n = 0;
    for (size_t y = 0; y < ny; y++)
        for (size_t z = 0; z < nz; z++)
            for (size_t x = 0; x < nx; x++) {
                const double at[3] = {((double)x + 0.5 - 0.5 * (double)nx) * s, ((double)y + 0.5) * s,
                                      ((double)z + 0.5 - 0.5 * (double)nz) * s};
                if (at[1] > surface_at(b, at[0], at[2])) continue;
                for (int k = 0; k < 3 && positions; k++)
                    positions[3 * n + (size_t)k] = at[k] + scatter * chance(n, k);
                n++;
            }
    return n;
}

static ssfr_result look_at(ssfr_water *water, ssfr_waters kind)
{
    static const double up[3] = {0, 1, 0};
    static const double whole_eye[3] = {1.4, 1.5, 2}, whole[3] = {0, 0.17, 0}; /* m */
    static const double part_eye[3] = {0.05, 1.4, 0.1}, part[3] = {0, depth, 0};
    const bool wide = kind == SSFR_WATER_WIDER;
    const double fov_y = wide ? 0.15 : 0.2; /* rad: the part is 0.15 m high; the whole fills most of the image */
    return ssfr_camera_look(&water->camera, wide ? part_eye : whole_eye, wide ? part : whole, up, fov_y, 1280, 720);
}

ssfr_result ssfr_water_create(ssfr_water *out, ssfr_waters kind, size_t n)
{
    ssfr_result result = SSFR_OK;
    const basin b = basin_of(kind, n);
    const ssfr_particles given = {.radius = 0.5 * b.spacing / cbrt(SSFR_VOLUME_SHARE)};
    double *positions = NULL;
    *out = (ssfr_water){0};
    SSFR_TRY(look_at(out, kind));
    const size_t count = fill(&b, NULL);
    SSFR_TRY(ssfr_alloc(&positions, count, 3 * sizeof *positions, "particles"));
    fill(&b, positions);
    SSFR_TRY(ssfr_particles_create(&out->particles, count, positions, &given));
end:
    free(positions);
    return result;
}

void ssfr_water_finish(ssfr_water *water)
{
    ssfr_particles_destroy(&water->particles);
}

/* ---- rays -------------------------------------------------------------------------------------------------------- */

typedef struct casting {
    const ssfr_continuum *fluid;
    const ssfr_camera *camera;
    ssfr_tiles tiles;
    ssfr_rays_tally tally;
    ssfr_result result; /* the first that failed, for all threads */
} casting;

static ssfr_ray ray_through(const casting *c, const int pixel[2])
{
    const ssfr_camera *camera = c->camera;
    const double u = ((2 * pixel[0] + 1.0) / camera->w - 1) * camera->tan_x;
    const double v = (1 - (2 * pixel[1] + 1.0) / camera->h) * camera->tan_y;
    ssfr_ray ray;
    for (int k = 0; k < 3; k++) {
        ray.origin[k] = camera->eye[k] - c->fluid->origin[k];
        ray.dir[k] = u * camera->right[k] + v * camera->up[k] - camera->back[k];
    }
    ssfr_normalize(ray.dir);
    return ray;
}

static void add(ssfr_rays_tally *sum, const ssfr_rays_tally *one)
{
    sum->rays += one->rays;
    sum->covered += one->covered;
    sum->kernels += one->kernels;
    sum->crossings += one->crossings;
    sum->touches += one->touches;
    sum->evaluations += one->evaluations;
    for (int i = 0; i < 3; i++) sum->seconds[i] += one->seconds[i];
}

static ssfr_result cast_ray(const casting *c, const int pixel[2], ssfr_line *line, ssfr_crossings *crossings,
                            ssfr_rays_tally *tally)
{
    ssfr_result result = SSFR_OK;
    const ssfr_ray ray = ray_through(c, pixel);
    const double begun = ssfr_clock(), near = c->camera->near, far = c->camera->far;
    double err;
    SSFR_TRY(ssfr_line_cast(line, &ray, near, far));
    const double gathered = ssfr_clock();
    SSFR_TRY(ssfr_crossings_find(crossings, line));
    const double found = ssfr_clock();
    const double content = ssfr_line_chords(line, near, far, &err);
    const double done = ssfr_clock();
    tally->rays++;
    tally->touches += crossings->n_touches;
    if (crossings->n > 0)
        add(tally, &(ssfr_rays_tally){.covered = 1,
                                      .kernels = line->n,
                                      .crossings = crossings->n,
                                      .evaluations = crossings->evaluations,
                                      .seconds = {gathered - begun, found - gathered, done - found}});
    if (!isfinite(content))
        SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "pixel %d,%d: the density's integral is %g", pixel[0], pixel[1], content));
end:
    return result;
}

static ssfr_result cast_tile(const casting *c, int tile, ssfr_line *line, ssfr_crossings *crossings,
                             ssfr_rays_tally *tally)
{
    ssfr_result result = SSFR_OK;
    int pixels[SSFR_TRUTH_TILE_PIXELS][2];
    const int n = ssfr_tiles_pixels(&c->tiles, tile, pixels);
    for (int i = 0; i < n; i++) SSFR_TRY(cast_ray(c, pixels[i], line, crossings, tally));
end:
    return result;
}

/* All tiles, with the threads of the team that calls it. */
static void cast_tiles(casting *c, ssfr_rays_tick *tick, void *user)
{
    ssfr_line line;
    ssfr_crossings crossings;
    ssfr_rays_tally tally = {0};
    ssfr_line_init(&line, c->fluid);
    ssfr_result result = ssfr_crossings_init(&crossings);
#pragma omp for schedule(dynamic, 1)
    for (int tile = 0; tile < c->tiles.n; tile++) {
        ssfr_result others;
#pragma omp atomic read
        others = c->result;
        if (others != SSFR_OK || result != SSFR_OK || ssfr_interrupt_came()) continue;
        result = cast_tile(c, tile, &line, &crossings, &tally);
        if (result != SSFR_OK) {
#pragma omp atomic write
            c->result = result;
        }
#pragma omp critical(ssfr_rays)
        if (tick) tick(user, (double)tile / c->tiles.n);
    }
#pragma omp critical(ssfr_rays)
    {
        add(&c->tally, &tally);
        if (result != SSFR_OK) c->result = result;
    }
    ssfr_crossings_finish(&crossings);
    ssfr_line_finish(&line);
}

ssfr_result ssfr_rays_cast(const ssfr_continuum *fluid, const ssfr_camera *camera, int every, uint64_t seed,
                           ssfr_rays_tick *tick, void *user, ssfr_rays_tally *tally)
{
    ssfr_result result = SSFR_OK;
    casting c = {.fluid = fluid, .camera = camera};
    SSFR_TRY(ssfr_tiles_init(&c.tiles, camera->w, camera->h, SSFR_TRUTH_SURFACE, every, seed));
#pragma omp parallel
    cast_tiles(&c, tick, user);
    if (c.result == SSFR_OK && ssfr_interrupt_came()) SSFR_TRY(ssfr_fail(SSFR_ERR_IO, "interrupted"));
    result = c.result;
    *tally = c.tally;
end:
    ssfr_tiles_finish(&c.tiles);
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* builtin.c: the built-in scenes: one frame of a simulation, and shapes whose right picture is known. */
#include "experiments/scenes/scenes.h"
#include "experiments/scenes/embedded.h"

#include <gsl/gsl_rng.h>

static const double ball_radius = 0.5;    /* m, of the one particle of `sphere` */
static const double radius = 0.02;        /* m, of the particles of plane and block */
static const double far_away = 1e6;       /* m, where `far` stands on each axis */
static const double jitter = 0.25;        /* of the spacing, how far the block's particles stray on each axis */

enum { PLANE_SIDE = 40, BLOCK_SIDE = 20 }; /* particles */

static ssfr_result make_empty(ssfr_particles **out, uint64_t seed)
{
    const ssfr_particles given = {.radius = radius};
    (void)seed;
    return ssfr_particles_create(out, 0, NULL, &given);
}

static ssfr_result make_sphere(ssfr_particles **out, uint64_t seed)
{
    const double origin[3] = {0, 0, 0};
    const ssfr_particles given = {.radius = ball_radius};
    (void)seed;
    return ssfr_particles_create(out, 1, origin, &given);
}

/* Upright, facing the viewer: neighbours overlap by half, so the surface is closed. */
static ssfr_result make_plane(ssfr_particles **out, uint64_t seed)
{
    static double positions[PLANE_SIDE * PLANE_SIDE][3];
    const ssfr_particles given = {.radius = radius};
    (void)seed;
    for (int i = 0; i < PLANE_SIDE * PLANE_SIDE; i++) {
        positions[i][0] = radius * (i % PLANE_SIDE - 0.5 * (PLANE_SIDE - 1));
        positions[i][1] = radius * (i / PLANE_SIDE - 0.5 * (PLANE_SIDE - 1));
        positions[i][2] = 0;
    }
    return ssfr_particles_create(out, SSFR_COUNT(positions), positions[0], &given);
}

static ssfr_result make_block_at(ssfr_particles **out, uint64_t seed, double origin)
{
    enum { N = BLOCK_SIDE * BLOCK_SIDE * BLOCK_SIDE };
    const double spacing = 2 * radius;
    const ssfr_particles given = {.radius = radius};
    ssfr_result result = SSFR_OK;
    double *positions = NULL;
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    if (!rng) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for a random number generator");
    gsl_rng_set(rng, (unsigned long)seed);
    SSFR_TRY(ssfr_alloc(&positions, 3 * N, sizeof *positions, "positions"));
    for (int i = 0; i < N; i++) {
        const int cell[3] = {i % BLOCK_SIDE, i / BLOCK_SIDE % BLOCK_SIDE, i / (BLOCK_SIDE * BLOCK_SIDE)};
        for (int k = 0; k < 3; k++) {
            const double stray = jitter * (2 * gsl_rng_uniform(rng) - 1);
            positions[3 * i + k] = origin + spacing * (cell[k] - 0.5 * (BLOCK_SIDE - 1) + stray);
        }
    }
    result = ssfr_particles_create(out, N, positions, &given);
end:
    free(positions);
    gsl_rng_free(rng);
    return result;
}

static ssfr_result make_block(ssfr_particles **out, uint64_t seed)
{
    return make_block_at(out, seed, 0);
}

static ssfr_result make_far(ssfr_particles **out, uint64_t seed)
{
    return make_block_at(out, seed, far_away);
}

static ssfr_result make_splash(ssfr_particles **out, uint64_t seed)
{
    (void)seed;
    return ssfr_embedded_particles(out, "data/splash.h5");
}

/* What stood around the water: the tank's far wall, and a wall where the frame was cut. */
static const ssfr_solid tank[] = {
    {.centre = {1.35, 0.35, -1.05}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .half = {1.05, 0.35, 0.05},
     .colour = {0.55, 0.42, 0.28}},
    {.centre = {0.35, 0.35, 0}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .half = {0.05, 0.35, 1},
     .colour = {0.55, 0.42, 0.28}},
};

static const ssfr_builtin builtins[] = {
    {.name = "splash", .help = "one frame of a simulated double dam break, cut to a box",
     .make = make_splash, .from = {0.75, 0.42, 1}, .top = 1.6, .floor = 0,
     .n_solids = SSFR_COUNT(tank), .solids = tank},
    {.name = "sphere", .help = "one particle of radius 0.5 m", .make = make_sphere, .from = {0, 0, 1}, .floor = NAN},
    {.name = "plane", .help = "a flat upright grid of 40 x 40 overlapping particles", .make = make_plane,
     .from = {0, 0, 1}, .floor = NAN},
    {.name = "block", .help = "a cube of 20 x 20 x 20 jittered particles", .make = make_block, .from = {0.6, 0.5, 1},
     .floor = NAN},
    {.name = "far", .help = "the block a million metres from the origin", .make = make_far, .from = {0.6, 0.5, 1},
     .floor = NAN},
    {.name = "empty", .help = "no particle", .make = make_empty, .floor = NAN},
};

const ssfr_builtin *ssfr_builtin_find(const char *name)
{
    const ssfr_builtin *found = NULL;
    for (size_t i = 0; i < SSFR_COUNT(builtins) && !found; i++)
        if (strcmp(builtins[i].name, name) == 0) found = &builtins[i];
    return found;
}

const ssfr_builtin *ssfr_builtin_at(int i)
{
    return i >= 0 && (size_t)i < SSFR_COUNT(builtins) ? &builtins[i] : NULL;
}

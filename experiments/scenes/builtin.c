/* SPDX-License-Identifier: GPL-3.0-or-later */
/* builtin.c: the built-in scenes: one frame of a simulation, and shapes whose right picture is known. */
#include "experiments/scenes/scenes.h"
#include "experiments/scenes/embedded.h"

#include <gsl/gsl_rng.h>

static const double ball_radius = 0.5;    /* m, of the one particle of `sphere` */
static const double radius = 0.02;        /* m, of the particles of plane and block */
static const double far_away = 1e6;       /* m, where `far` stands on each axis */
static const double jitter = 0.25;        /* of the spacing, how far the block's particles stray on each axis */

enum { PLANE_SIDE = 40, BLOCK_SIDE = 20, N_BLOCK = BLOCK_SIDE * BLOCK_SIDE * BLOCK_SIDE }; /* particles */

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
static void place_plane(double positions[PLANE_SIDE * PLANE_SIDE][3])
{
    for (int i = 0; i < PLANE_SIDE * PLANE_SIDE; i++) {
        positions[i][0] = radius * (i % PLANE_SIDE - 0.5 * (PLANE_SIDE - 1));
        positions[i][1] = radius * (i / PLANE_SIDE - 0.5 * (PLANE_SIDE - 1));
        positions[i][2] = 0;
    }
}

static ssfr_result make_plane(ssfr_particles **out, uint64_t seed)
{
    double positions[PLANE_SIDE * PLANE_SIDE][3];
    const ssfr_particles given = {.radius = radius};
    (void)seed;
    place_plane(positions);
    return ssfr_particles_create(out, SSFR_COUNT(positions), positions[0], &given);
}

static ssfr_result place_block(double **out, uint64_t seed, double origin)
{
    const double spacing = 2 * radius;
    ssfr_result result = SSFR_OK;
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    if (!rng) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for a random number generator");
    gsl_rng_set(rng, (unsigned long)seed);
    SSFR_TRY(ssfr_alloc(out, 3 * N_BLOCK, sizeof **out, "positions"));
    for (int i = 0; i < N_BLOCK; i++) {
        const int cell[3] = {i % BLOCK_SIDE, i / BLOCK_SIDE % BLOCK_SIDE, i / (BLOCK_SIDE * BLOCK_SIDE)};
        for (int k = 0; k < 3; k++) {
            const double stray = jitter * (2 * gsl_rng_uniform(rng) - 1);
            (*out)[3 * i + k] = origin + spacing * (cell[k] - 0.5 * (BLOCK_SIDE - 1) + stray);
        }
    }
end:
    gsl_rng_free(rng);
    return result;
}

static ssfr_result make_block_at(ssfr_particles **out, uint64_t seed, double origin)
{
    const ssfr_particles given = {.radius = radius};
    ssfr_result result = SSFR_OK;
    double *positions = NULL;
    SSFR_TRY(place_block(&positions, seed, origin));
    result = ssfr_particles_create(out, N_BLOCK, positions, &given);
end:
    free(positions);
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

/* ---- extremes of what moves -------------------------------------------------------------------------------------- */

enum { HEAP = 800, HORIZON_ROWS = 120, HORIZON_COLUMNS = 64 }; /* particles */
static const double thin = 300;                   /* kg/m^3, of a particle that is spray */
static const double fast = 2;                     /* m/s, Weber number 4000 with a length of 1 m and 1 N/m: foam */
static const double beyond_squares = 1e30;        /* m/s, a speed whose square no float holds */
static const double heap_radius = 1;              /* m */
static const double horizon_radius = 0.25;        /* m */
static const double horizon_near = 1;             /* m, from the camera `along` to the first row, */
static const double horizon_decades = 5;          /* and how far it is to the last */
static const double horizon_wide = 0.7;           /* half the width of a row, as a slope from that camera */
static const double horizon_low = -0.4, horizon_high = 0.3; /* slopes of the first row and of the last */

/* What a particle of a scene does: its velocity (m/s), and its density (kg/m^3), which is that at rest before. */
typedef void motion(size_t i, size_t n, const double place[3], float velocity[3], float *density);

/* The particles again, with ids, velocity and density. */
static ssfr_result move(ssfr_particles **out, size_t n, const double *positions, double size, motion *how)
{
    ssfr_result result = SSFR_OK;
    ssfr_particles given = {.radius = size};
    SSFR_TRY(ssfr_alloc(&given.velocity, 3 * n, sizeof *given.velocity, "velocities"));
    SSFR_TRY(ssfr_alloc(&given.density, n, sizeof *given.density, "densities"));
    SSFR_TRY(ssfr_alloc(&given.id, n, sizeof *given.id, "ids"));
    for (size_t i = 0; i < n; i++) {
        given.density[i] = (float)SSFR_REST_DENSITY;
        given.id[i] = (uint32_t)i;
        how(i, n, positions + 3 * i, given.velocity + 3 * i, &given.density[i]);
    }
    result = ssfr_particles_create(out, n, positions, &given);
end:
    free(given.velocity);
    free(given.density);
    free(given.id);
    return result;
}

static void stand(size_t i, size_t n, const double place[3], float velocity[3], float *density)
{
    (void)i, (void)n, (void)place, (void)density;
    for (int k = 0; k < 3; k++) velocity[k] = 0;
}

/* Away from the middle, as fast as there is a number for. */
static void burst(size_t i, size_t n, const double place[3], float velocity[3], float *density)
{
    double away[3] = {place[0], place[1], place[2]};
    (void)i, (void)n, (void)density;
    ssfr_normalize(away);
    for (int k = 0; k < 3; k++) velocity[k] = (float)(beyond_squares * away[k]);
}

static void drift(size_t i, size_t n, const double place[3], float velocity[3], float *density)
{
    (void)i, (void)n, (void)place, (void)density;
    velocity[0] = 1, velocity[1] = velocity[2] = 0;
}

/* Each other particle is foam. */
static void stir(size_t i, size_t n, const double place[3], float velocity[3], float *density)
{
    (void)n, (void)place, (void)density;
    velocity[0] = i % 2 ? (float)fast : 0, velocity[1] = velocity[2] = 0;
}

/* From rest on the left to what is foam on the right, and a little spray. */
static void shear(size_t i, size_t n, const double place[3], float velocity[3], float *density)
{
    (void)n, (void)place;
    velocity[0] = (float)(fast * (double)(i % HORIZON_COLUMNS) / (HORIZON_COLUMNS - 1));
    velocity[1] = velocity[2] = 0;
    if (i % 16 == 5) *density = (float)thin;
}

static ssfr_result move_block(ssfr_particles **out, uint64_t seed, motion *how)
{
    ssfr_result result = SSFR_OK;
    double *positions = NULL;
    SSFR_TRY(place_block(&positions, seed, 0));
    SSFR_TRY(move(out, N_BLOCK, positions, radius, how));
end:
    free(positions);
    return result;
}

static ssfr_result make_still(ssfr_particles **out, uint64_t seed)
{
    return move_block(out, seed, stand);
}

static ssfr_result make_burst(ssfr_particles **out, uint64_t seed)
{
    return move_block(out, seed, burst);
}

static ssfr_result make_drift(ssfr_particles **out, uint64_t seed)
{
    double positions[PLANE_SIDE * PLANE_SIDE][3];
    (void)seed;
    place_plane(positions);
    return move(out, SSFR_COUNT(positions), positions[0], radius, drift);
}

static ssfr_result make_heap(ssfr_particles **out, uint64_t seed)
{
    static const double positions[HEAP][3];
    (void)seed;
    return move(out, HEAP, positions[0], heap_radius, stir);
}

/* A ramp that rises and widens so that all its rows are seen from the origin, along -z. */
static ssfr_result make_horizon(ssfr_particles **out, uint64_t seed)
{
    static double positions[HORIZON_ROWS * HORIZON_COLUMNS][3];
    (void)seed;
    for (int i = 0; i < HORIZON_ROWS * HORIZON_COLUMNS; i++) {
        const double row = (double)(i / HORIZON_COLUMNS) / (HORIZON_ROWS - 1);
        const double column = 2.0 * (i % HORIZON_COLUMNS) / (HORIZON_COLUMNS - 1) - 1;
        const double distance = horizon_near * pow(10, horizon_decades * row);
        positions[i][0] = distance * horizon_wide * column;
        positions[i][1] = distance * ssfr_mix(horizon_low, horizon_high, row);
        positions[i][2] = -distance;
    }
    return move(out, SSFR_COUNT(positions), positions[0], horizon_radius, shear);
}

/* ---- the list ---------------------------------------------------------------------------------------------------- */

/* What stood around the water: the tank's far wall, and a wall where the frame was cut. */
static const ssfr_solid tank[] = {
    {.centre = {1.35, 0.35, -1.05}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .half = {1.05, 0.35, 0.05},
     .colour = {0.55, 0.42, 0.28}},
    {.centre = {0.35, 0.35, 0}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .half = {0.05, 0.35, 1},
     .colour = {0.55, 0.42, 0.28}},
};

#define VIEW(called, ...) \
    {.name = called, .up = {0, 1, 0}, .n_keys = 1, .keys = &(ssfr_view_key){.fov_deg = 45, __VA_ARGS__}}
/* Over the water's surface by a tenth of a metre and less, and along it. */
static const ssfr_view splash_views[] = {
    VIEW("close", .eye = {1.25, 0.2, 0.35}, .target = {0.8, 0.05, -0.3}),
    VIEW("grazing", .eye = {3, 0.25, 1.2}, .target = {0.6, 0.15, -0.6}),
    VIEW("away", .eye = {3, 0.5, 1.2}, .target = {6, 0.5, 3}),
    VIEW("aside", .eye = {4, 2, 2.6}, .target = {4, 1.2, -1.9}),
};
static const ssfr_view horizon_views[] = {VIEW("along", .eye = {0, 0, 0}, .target = {0, 0, -1})};
#undef VIEW

static const ssfr_builtin builtins[] = {
    {.name = "splash", .help = "one frame of a simulated double dam break, cut to a box",
     .make = make_splash, .from = {0.75, 0.42, 1}, .top = 1.6, .floor = 0,
     .n_solids = SSFR_COUNT(tank), .solids = tank, .n_views = SSFR_COUNT(splash_views), .views = splash_views},
    {.name = "sphere", .help = "one particle of radius 0.5 m", .make = make_sphere, .from = {0, 0, 1}, .floor = NAN},
    {.name = "plane", .help = "a flat upright grid of 40 x 40 overlapping particles", .make = make_plane,
     .from = {0, 0, 1}, .floor = NAN},
    {.name = "block", .help = "a cube of 20 x 20 x 20 jittered particles", .make = make_block, .from = {0.6, 0.5, 1},
     .floor = NAN},
    {.name = "far", .help = "the block a million metres from the origin", .make = make_far, .from = {0.6, 0.5, 1},
     .floor = NAN},
    {.name = "empty", .help = "no particle", .make = make_empty, .floor = NAN},
    {.name = "still", .help = "the block at rest", .make = make_still, .from = {0.6, 0.5, 1}, .floor = NAN},
    {.name = "burst", .help = "the block, every particle at 1e30 m/s", .make = make_burst, .from = {0.6, 0.5, 1},
     .floor = NAN},
    {.name = "drift", .help = "the plane, every particle at 1 m/s", .make = make_drift, .from = {0, 0, 1},
     .floor = NAN},
    {.name = "pause", .help = "two frames of drift with no time between them", .make = make_drift, .n_frames = 2,
     .from = {0, 0, 1}, .floor = NAN},
    {.name = "heap", .help = "800 particles of radius 1 m at one place, each other of them foam", .make = make_heap,
     .from = {0, 0, 1}, .floor = NAN},
    {.name = "horizon", .help = "water, foam and spray from 1 m to 100 km before the camera `along`",
     .make = make_horizon, .from = {0, 0, 1}, .floor = -INFINITY, .n_views = SSFR_COUNT(horizon_views),
     .views = horizon_views},
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

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* surroundings.c: floor, solids and sky of a scene as what light comes from that has left the fluid. */
#include "experiments/truth/surroundings.h"

#include "passes/environment.h"

typedef struct surroundings {
    ssfr_surroundings shown; /* first: its address is this struct's */
    ssfr_scene scene;
    ssfr_frame frame;
    ssfr_solid_set solids;   /* all of them */
    double shift[3];         /* m, from the eye to the rays' origin */
} surroundings;

static double trace(void *user, const ssfr_ray *ray, double colour[3])
{
    const surroundings *s = user;
    double from[3];
    for (int k = 0; k < 3; k++) from[k] = ray->origin[k] + s->shift[k];
    const double t = ssfr_environment_trace(&s->frame, s->solids, from, ray->dir, colour);
    return t < SSFR_SURFACE ? t : INFINITY;
}

static void sky(void *user, const double dir[3], double colour[3])
{
    const surroundings *s = user;
    ssfr_environment_sky(&s->frame, dir, colour);
}

/* All colours lie between those of the sky and the most that floor and solids send back of the light; haze and maps mix
 * them, with weights that sum to 1 but for rounding. */
static void find_bounds(surroundings *s)
{
    static const double rounding = 1 + 1e-12;
    const ssfr_block *b = &s->frame.block;
    const ssfr_field *map = s->scene.environment;
    const double ambient = b->fluid[3], lit = fmax(ambient + (1 - ambient) * b->light[3], ambient);
    double most = isfinite(s->scene.floor) ? lit * fmax(b->floor[1], b->floor[2]) : 0, least = 0;
    for (size_t i = 0; map && i < (size_t)map->w * (size_t)map->h * 3; i++)
        most = fmax(most, map->data[i]), least = fmin(least, map->data[i]);
    for (int k = 0; k < 3; k++) {
        if (!map) most = fmax(most, fmax(b->zenith[k], b->horizon[k]));
        for (int i = 0; i < s->frame.n_solids; i++) most = fmax(most, lit * b->solid[i][4][k]);
    }
    s->shown.brightest = most * rounding, s->shown.darkest = least * rounding;
}

ssfr_result ssfr_surroundings_create(ssfr_surroundings **out, const ssfr_scene *scene, const ssfr_world *world,
                                     const double origin[3])
{
    ssfr_result result = SSFR_OK;
    surroundings *s = NULL;
    long grew = 0;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&s, 1, sizeof *s, "surroundings"));
    s->shown = (ssfr_surroundings){.user = s, .trace = trace, .sky = sky};
    s->scene = *scene;
    s->scene.particles = NULL;
    SSFR_TRY(ssfr_frame_prepare(&s->frame, &s->scene, world, 1, 0, &grew));
    s->scene.solids = NULL; /* the frame has its own */
    ssfr_frame_all_solids(&s->frame, s->solids);
    for (int k = 0; k < 3; k++) s->shift[k] = origin[k] - scene->camera.eye[k];
    find_bounds(s);
    *out = &s->shown;
    s = NULL;
end:
    if (s) {
        ssfr_surroundings *failed = &s->shown;
        ssfr_surroundings_destroy(&failed);
    }
    return result;
}

void ssfr_surroundings_destroy(ssfr_surroundings **around)
{
    surroundings *s = (surroundings *)*around;
    if (s) ssfr_frame_finish(&s->frame);
    free(s);
    *around = NULL;
}

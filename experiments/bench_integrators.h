/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_integrators.h: `ssfr bench integrators`: what each rule of integration costs along rays of each kind, and how
 * wrong it is.
 *
 *      bench_integrators.c           the command: visiting all that is measured, printing, saving
 *      bench_integrators_spec.c      the file that says what to measure
 *      bench_integrators_rays.c      choosing rays
 *      bench_integrators_measure.c   references, errors, times */
#ifndef SSFR_BENCH_INTEGRATORS_H
#define SSFR_BENCH_INTEGRATORS_H

#include "experiments/measure.h"
#include "experiments/stage.h"
#include "experiments/truth/radiance.h"

/* argv[0] is "bench", argv[1] "integrators"; gives the exit status. */
int ssfr_bench_integrators(int argc, char **argv);

/* ---- what to measure --------------------------------------------------------------------------------------------- */

typedef enum ssfr_study_integral {
    SSFR_STUDY_DENSITY,  /* rho / rho_0 along the ray, in particle diameters */
    SSFR_STUDY_RADIANCE, /* of spray, foam and bubbles, light = 1 */
    SSFR_N_STUDY_INTEGRALS
} ssfr_study_integral;

extern const char *const ssfr_study_integrals[]; /* names, NULL-terminated */

enum {
    SSFR_STUDY_SCENES = 8,
    SSFR_STUDY_KINDS = 4,     /* of an integral: a panel of the chart each */
    SSFR_STUDY_NUMBERS = 32,  /* of a list */
    SSFR_STUDY_RAYS = 256,    /* of a kind */
};

typedef struct ssfr_ray_kind {
    char *name;
    size_t count;
    double content[2]; /* least and most, in diameters or optical depths */
    double regions[2];
    int most;          /* flag: those with the most kernels */
} ssfr_ray_kind;

typedef struct ssfr_study_numbers {
    size_t n;
    double values[SSFR_STUDY_NUMBERS];
} ssfr_study_numbers;

typedef struct ssfr_study {
    char *title;
    size_t n_scenes;
    char *scenes[SSFR_STUDY_SCENES];
    double size[2]; /* px */
    ssfr_continuum_params fluid;
    ssfr_extinction_params extinction;
    size_t candidates;
    size_t n_kinds[SSFR_N_STUDY_INTEGRALS];
    ssfr_ray_kind kinds[SSFR_N_STUDY_INTEGRALS][SSFR_STUDY_KINDS];
    bool integrators[SSFR_N_INTEGRATORS];
    ssfr_study_numbers tolerances, points, steps;
} ssfr_study;

/* Reads YAML text; path is what errors call it. */
SSFR_MUST ssfr_result ssfr_study_read(ssfr_study *out, const char *path, const char *text, size_t size);
/* path NULL: the built-in study. *text is what was read, to free(). */
SSFR_MUST ssfr_result ssfr_study_load(ssfr_study *out, const char *path, char **text);
void ssfr_study_finish(ssfr_study *study);

/* The settings of an integrator, in the order of the table: tolerances, points or steps; one NaN where it has none. */
ssfr_study_numbers ssfr_study_settings(const ssfr_study *study, ssfr_study_integral integral, ssfr_integrator_id id);

/* ---- rays -------------------------------------------------------------------------------------------------------- */

typedef struct ssfr_study_scene {
    ssfr_stage *stage;
    ssfr_continuum fluid;
    ssfr_extinction foam;
    ssfr_line lines[SSFR_N_STUDY_INTEGRALS];
    ssfr_integration *work;
} ssfr_study_scene;

SSFR_MUST ssfr_result ssfr_study_scene_init(ssfr_study_scene *out, const ssfr_study *study, const char *scene,
                                            uint64_t seed);
void ssfr_study_scene_finish(ssfr_study_scene *scene);

/* What an integral along rays is measured in: a particle's diameter, m, or 1. */
double ssfr_study_unit(const ssfr_study_scene *scene, ssfr_study_integral integral);
/* The part of the integral's line that its kernels reach; false where there are none. */
bool ssfr_study_clip(const ssfr_line *line, double *a, double *b);

typedef struct ssfr_study_ray {
    ssfr_ray ray;
    size_t n_kernels;
    double content, regions; /* see ssfr_ray_kind */
    double reference[3], reference_err; /* of the integral in its unit: ssfr_study_refer */
} ssfr_study_ray;

/* All candidates for the integral, to free(). */
SSFR_MUST ssfr_result ssfr_study_survey(ssfr_study_scene *scene, const ssfr_study *study,
                                        ssfr_study_integral integral, uint64_t seed, size_t *n,
                                        ssfr_study_ray **candidates);
/* Copies those of a kind to rays[kind->count]; fails when there is none. */
SSFR_MUST ssfr_result ssfr_study_choose(const ssfr_ray_kind *kind, size_t n, const ssfr_study_ray *candidates,
                                        size_t *n_chosen, ssfr_study_ray *rays);

/* ---- measuring --------------------------------------------------------------------------------------------------- */

/* The integral of a ray in two ways, whose difference is the reference's own error: of the density the closed form,
 * held against GSL's integral of each kernel by itself; of the radiance qagp, held against cquad, which has no points
 * in common with it, both as exact as they can be. */
SSFR_MUST ssfr_result ssfr_study_refer(ssfr_study_scene *scene, ssfr_study_integral integral, ssfr_study_ray *ray);

typedef struct ssfr_study_row { /* errors are in the integral's unit, times in microseconds */
    size_t rays, runs;
    double kernels;
    ssfr_timing time;
    double gathering;        /* median over the rays, not part of time */
    double evaluations;      /* mean */
    double error_max, error_median;     /* at least the reference's own error and DBL_EPSILON */
    double claimed_max, claimed_median;
    double exceeded;         /* share of the rays whose error is above what is claimed and the reference's error */
    double reference_err;    /* largest */
    double value;            /* mean */
} ssfr_study_row;

SSFR_MUST ssfr_result ssfr_study_measure(ssfr_study_scene *scene, ssfr_study_integral integral, size_t n,
                                         const ssfr_study_ray *rays, ssfr_integrator_id id, double setting,
                                         ssfr_study_row *out);

#endif

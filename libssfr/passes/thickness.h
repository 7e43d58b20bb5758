/* SPDX-License-Identifier: MIT */
/* thickness.h: length of fluid along the view ray, for all passes that add it up; the twin of shaders/thickness.glsl.
 * Their inputs begin with scene_depth; parameters and coefficients of those that draw spheres with those below. */
#ifndef SSFR_THICKNESS_H
#define SSFR_THICKNESS_H

#include "passes/splat.h"

typedef struct ssfr_thickness_params {
    ssfr_splat_params splat; /* first */
    int kernel, occlusion, storage;
    double scale;
} ssfr_thickness_params;

typedef struct ssfr_thickness_sum { /* what makes a fragment's share of a sum of its chord */
    double scale;
    int exponential, clipped, half;
} ssfr_thickness_sum;

typedef struct ssfr_thickness_coeffs {
    ssfr_splat splat; /* first */
    ssfr_thickness_sum sum;
} ssfr_thickness_coeffs;

extern const char *const ssfr_thickness_kernels[], *const ssfr_thickness_occlusions[];

/* Of any sum of chords, in parameters with these members. */
#define SSFR_THICKNESS_KERNEL_ROWS(type)                                                                           \
    SSFR_PARAM_CHOICE(type, kernel, ssfr_thickness_kernels, 0,                                                     \
                      "chord of the sphere, or the chord times e^(-2 r^2), which leaves no edges but 51 % of the " \
                      "volume"),                                                                                   \
    SSFR_PARAM_CHOICE(type, occlusion, ssfr_thickness_occlusions, 0,                                               \
                      "a particle whose front is before the scene counts whole, or with its part before the scene")
#define SSFR_THICKNESS_STORAGE_ROW(type)                                            \
    SSFR_PARAM_CHOICE(type, storage, ssfr_storages, SSFR_STORE_FLOAT,               \
                      "sums in 32 bits, or in 16 as the paper has them (tab. 4.1): each sum is rounded to 11 bits")
#define SSFR_THICKNESS_SUM_UNIFORMS(type, sum)             \
    {"u_scale", offsetof(type, sum.scale), 1},             \
    {"u_exponential", offsetof(type, sum.exponential), 0}, \
    {"u_clipped", offsetof(type, sum.clipped), 0}

#define SSFR_THICKNESS_ROWS                                           \
    SSFR_SPLAT_ROWS,                                                  \
    SSFR_THICKNESS_KERNEL_ROWS(ssfr_thickness_params),                \
    SSFR_PARAM_REAL(ssfr_thickness_params, scale, "1", 1, 0, 100,     \
                    "multiplies the sum: spheres do not fill space"), \
    SSFR_THICKNESS_STORAGE_ROW(ssfr_thickness_params)
#define SSFR_THICKNESS_UNIFORMS SSFR_SPLAT_UNIFORMS, SSFR_THICKNESS_SUM_UNIFORMS(ssfr_thickness_coeffs, sum)

#define SSFR_THICKNESS_TOLERANCE {.abs = 2e-4, .rel = 1e-4, .outliers = 0.02}
/* GL does not say how a half is rounded. The twin takes the nearest, llvmpipe cuts off: they part by up to a step for
 * each particle, 2^-10 of the sum. Meant for 16 of them behind one another. */
#define SSFR_THICKNESS_HALF_TOLERANCE {.abs = 2e-4, .rel = 16 * 0x1p-10, .outliers = 0.02}

void ssfr_thickness_derive(const ssfr_run *run, void *coeffs);
ssfr_storage ssfr_thickness_storage(const void *params);
void ssfr_thickness_widen(const ssfr_run *run, ssfr_tolerance *tolerance);

/* What a particle adds at a pixel, m, spread over f->area; 0 where it is behind the scene. f->back is then where that
 * ends. */
double ssfr_thickness_of(const ssfr_run *run, const ssfr_thickness_sum *sum, ssfr_fragment *f);

/* Adds to a sum, of halves or not. */
static inline void ssfr_thickness_add(bool half, double thickness, double *sum)
{
    *sum += thickness;
    if (half) *sum = ssfr_half_round(*sum);
}

void ssfr_thickness_cpu(const ssfr_run *run);

#endif

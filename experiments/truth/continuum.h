/* SPDX-License-Identifier: GPL-3.0-or-later */
/* continuum.h: what the particles are taken for: a continuous fluid with a surface and a density. Truth is a choice.
 *
 *      spheres      the union of the particles' balls: what splatting depicts. Its density is the number of balls
 *                   around a place, so that the density's integral is the sum of all chords
 *      density      inside where rho / rho_0 = sum V W(|x - x_j|) >= level (Muller et al. 2003)
 *      zhu_bridson  inside where |x - xm| <= r, xm the mean of the particles weighted by (1 - (d / h)^2)^3 (Zhu and
 *                   Bridson 2005); where no particle weighs, outside. Its density is that of `density`
 *      anisotropic  inside where sum V_j W_j(x - xs_j) >= level: kernels stretched after each particle's neighbours at
 *                   smoothed centres, V_j = m / rho_j (Yu and Turk 2013), as ssfr_particles_anisotropy has them
 *
 * V = SSFR_VOLUME_SHARE (2 r)^3 is a particle's volume, h the support of the kernel W. */
#ifndef SSFR_TRUTH_CONTINUUM_H
#define SSFR_TRUTH_CONTINUUM_H

#include "experiments/truth/boxes.h"
#include "experiments/truth/radial.h"

typedef enum ssfr_continuum_kind {
    SSFR_CONTINUUM_SPHERES,
    SSFR_CONTINUUM_DENSITY,
    SSFR_CONTINUUM_ZHU_BRIDSON,
    SSFR_CONTINUUM_ANISOTROPIC,
    SSFR_N_CONTINUA
} ssfr_continuum_kind;

extern const char *const ssfr_continuum_names[]; /* NULL-terminated */

typedef struct ssfr_continuum_params {
    int kind, kernel;
    double level;   /* of density and anisotropic, (0, 1): rho / rho_0 at the surface */
    double support; /* of the kernels, in particle radii */
    double size;    /* of spheres and of zhu_bridson's r, in particle radii */
} ssfr_continuum_params;

extern const ssfr_param ssfr_continuum_rows[];

typedef struct ssfr_continuum {
    ssfr_continuum_kind kind;
    size_t n;
    double origin[3];     /* m, world: all places are relative to it */
    double (*centre)[3];  /* m, in the order of the packed particles */
    double support;       /* m: of kernels before they are stretched; of spheres their radius */
    double weight;        /* V / support^3; of spheres 1 */
    double level;
    double radius;        /* m, of spheres and of zhu_bridson */
    const ssfr_radial *radial; /* NULL for spheres */
    double *weights;      /* anisotropic: V_j / (support^3 det A_j); else NULL: all have `weight` */
    double (*inverse)[6]; /* anisotropic: of A_j, as xx, xy, xz, yy, yz, zz; else NULL */
    ssfr_boxes boxes;
} ssfr_continuum;

/* The particles need not stay. anisotropy NULL: its defaults. Fails where there are particles without a radius. No
 * particles: a fluid that is nowhere. Takes less than 300 bytes a particle, also while it is made. */
SSFR_MUST ssfr_result ssfr_continuum_init(ssfr_continuum *out, const ssfr_particles *particles,
                                      const ssfr_continuum_params *params, const ssfr_anisotropy_params *anisotropy);
/* Kernels of the same weight and support (m) around n places (m, relative to origin) that nothing else is known of: for
 * extinctions, and for tests. The density is sum weight w(|x - x_j| / support). */
SSFR_MUST ssfr_result ssfr_continuum_init_kernels(ssfr_continuum *out, size_t n, const double (*centre)[3],
                                              const double origin[3], const ssfr_radial *radial, double support,
                                              double weight, double level);
void ssfr_continuum_finish(ssfr_continuum *fluid);
size_t ssfr_continuum_bytes(const ssfr_continuum *fluid);

#endif

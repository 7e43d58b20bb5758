/* SPDX-License-Identifier: GPL-3.0-or-later */
/* continuum.c: particles made a continuous fluid: places in double around an origin of the fluid's own, and kernels. */
#include "experiments/truth/continuum.h"

#include "base/param.h"
#include "scene/anisotropy.h"

const char *const ssfr_continuum_names[] = {"spheres", "density", "zhu_bridson", "anisotropic", NULL};

#define REAL(name, def, min, max, help) SSFR_PARAM_REAL(ssfr_continuum_params, name, "1", def, min, max, help)

const ssfr_param ssfr_continuum_rows[] = {
    SSFR_PARAM_CHOICE(ssfr_continuum_params, kind, ssfr_continuum_names, SSFR_CONTINUUM_DENSITY,
                      "what the particles are taken for: their balls; or inside where density (Muller et al. 2003), "
                      "the distance to the particles' weighted mean (Zhu and Bridson 2005) or the density of stretched "
                      "kernels (Yu and Turk 2013) says so"),
    SSFR_PARAM_CHOICE(ssfr_continuum_params, kernel, ssfr_radial_names, 0, "of densities"),
    REAL(level, 0.5, 1e-3, 0.999, "of density and anisotropic: density at the surface, over that of rest"),
    REAL(support, SSFR_SUPPORT, 1, 64, "where the kernels end, in particle radii"),
    REAL(size, 1, 0.01, 100, "of spheres: the radius; of zhu_bridson: from the mean to the surface; in particle radii"),
    SSFR_PARAM_END,
};

#undef REAL

/* ---- stretched kernels ------------------------------------------------------------------------------------------- */

/* Of a symmetric matrix, all as xx, xy, xz, yy, yz, zz. */
static double determinant(const double m[6])
{
    return m[0] * (m[3] * m[5] - m[4] * m[4]) - m[1] * (m[1] * m[5] - m[4] * m[2]) + m[2] * (m[1] * m[4] - m[3] * m[2]);
}

static void invert(const double m[6], double det, double out[6])
{
    out[0] = (m[3] * m[5] - m[4] * m[4]) / det;
    out[1] = (m[2] * m[4] - m[1] * m[5]) / det;
    out[2] = (m[1] * m[4] - m[2] * m[3]) / det;
    out[3] = (m[0] * m[5] - m[2] * m[2]) / det;
    out[4] = (m[1] * m[2] - m[0] * m[4]) / det;
    out[5] = (m[0] * m[3] - m[1] * m[1]) / det;
}

/* What is computed for all particles and then becomes kernels. */
typedef struct stretched {
    float *centre, *shape; /* of ssfr_particles_anisotropy */
    const float *density;  /* kg/m^3 */
    float *own;            /* the same, where the particles had none */
    double *reach;         /* m */
} stretched;

static void stretched_finish(stretched *s)
{
    free(s->centre), free(s->shape), free(s->own), free(s->reach);
}

/* Densities as ssfr_particles_complete has them; the caller's set stays as it is. */
static ssfr_result find_density(stretched *s, const ssfr_particles *particles)
{
    ssfr_result result = SSFR_OK;
    ssfr_particles copy = *particles;
    if (!particles->density) {
        SSFR_TRY(ssfr_particles_complete(&copy, NULL));
        s->own = copy.density;
        if (!particles->neighbours) free(copy.neighbours);
    }
    s->density = copy.density;
end:
    return result;
}

static ssfr_result stretch(ssfr_continuum *fluid, stretched *s, double volume)
{
    ssfr_result result = SSFR_OK;
    const double support3 = fluid->support * fluid->support * fluid->support;
    size_t bad = fluid->n;
#pragma omp parallel for schedule(static) reduction(min : bad)
    for (size_t i = 0; i < fluid->n; i++) {
        double shape[6], values[3], vectors[3][3];
        for (size_t k = 0; k < 6; k++) shape[k] = (double)s->shape[6 * i + k];
        const double det = determinant(shape), share = SSFR_REST_DENSITY / (double)s->density[i];
        ssfr_eigen_symmetric(shape, values, vectors);
        if (!(values[2] > 0 && det > 0 && share > 0 && isfinite(share)) && i < bad) bad = i;
        invert(shape, det, fluid->inverse[i]);
        fluid->weights[i] = volume * share / (support3 * det);
        s->reach[i] = fluid->support * values[0];
    }
    if (bad < fluid->n)
        SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "particle %zu (from 0): density %g kg/m^3: its volume is its mass over that",
                           bad, (double)s->density[bad]));
end:
    return result;
}

/* Kernels, boxes and smoothed centres. */
static ssfr_result make_stretched(ssfr_continuum *fluid, const ssfr_particles *particles,
                                  const ssfr_anisotropy_params *anisotropy, double volume)
{
    ssfr_result result = SSFR_OK;
    stretched s = {0};
    if (fluid->n == 0) return ssfr_boxes_init(&fluid->boxes, 0, NULL, NULL, 0);
    SSFR_TRY(find_density(&s, particles));
    SSFR_TRY(ssfr_alloc(&s.centre, fluid->n, 3 * sizeof *s.centre, "smoothed centres"));
    SSFR_TRY(ssfr_alloc(&s.shape, fluid->n, 6 * sizeof *s.shape, "ellipsoids"));
    SSFR_TRY(ssfr_particles_anisotropy(particles, anisotropy, s.centre, s.shape));
    SSFR_TRY(ssfr_alloc(&s.reach, fluid->n, sizeof *s.reach, "ellipsoids"));
    SSFR_TRY(ssfr_alloc(&fluid->weights, fluid->n, sizeof *fluid->weights, "ellipsoids"));
    SSFR_TRY(ssfr_alloc(&fluid->inverse, fluid->n, sizeof *fluid->inverse, "ellipsoids"));
    SSFR_TRY(stretch(fluid, &s, volume));
    for (size_t i = 0; i < fluid->n; i++)
        for (size_t k = 0; k < 3; k++)
            fluid->centre[i][k] = (particles->packets[i / SSFR_PACKET].centre[k] - fluid->origin[k]) +
                                  (double)s.centre[3 * i + k];
    SSFR_TRY(ssfr_boxes_init(&fluid->boxes, fluid->n, (const double(*)[3])fluid->centre, s.reach, 0));
end:
    stretched_finish(&s);
    return result;
}

/* ---- all kinds --------------------------------------------------------------------------------------------------- */

static ssfr_result place_all(ssfr_continuum *fluid, const ssfr_particles *particles)
{
    ssfr_result result = SSFR_OK;
    double lo[3], hi[3];
    ssfr_particles_bounds(particles, lo, hi);
    for (int k = 0; k < 3; k++) fluid->origin[k] = lo[k] + 0.5 * (hi[k] - lo[k]);
    SSFR_TRY(ssfr_alloc(&fluid->centre, fluid->n, sizeof *fluid->centre, "particles' places"));
    for (size_t i = 0; i < fluid->n; i++)
        /* The difference of two large numbers first: it is exact, or nearly. */
        for (size_t k = 0; k < 3; k++)
            fluid->centre[i][k] = (particles->packets[i / SSFR_PACKET].centre[k] - fluid->origin[k]) +
                                  (double)particles->position[3 * i + k];
end:
    return result;
}

ssfr_result ssfr_continuum_init(ssfr_continuum *out, const ssfr_particles *particles,
                                const ssfr_continuum_params *params, const ssfr_anisotropy_params *anisotropy)
{
    ssfr_result result = SSFR_OK;
    *out = (ssfr_continuum){.n = particles->n};
    SSFR_TRY(ssfr_params_check(ssfr_continuum_rows, params, "the continuum"));
    const bool balls = params->kind == SSFR_CONTINUUM_SPHERES;
    const double radius = particles->n > 0 ? particles->radius : 1; /* m; nothing is taken for anything, but finite */
    const double support = (balls ? params->size : params->support) * radius, cube = support * support * support;
    const double volume = SSFR_VOLUME_SHARE * 8 * radius * radius * radius;
    if (!(radius > 0 && isnormal(cube) && isnormal(volume)))
        SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "particle radius %g m: a continuous fluid needs a positive, finite one",
                           radius));
    out->kind = (ssfr_continuum_kind)params->kind;
    out->support = support;
    out->weight = balls ? 1 : volume / cube;
    out->level = params->level;
    out->radius = params->size * radius;
    out->radial = balls ? NULL : &ssfr_radials[params->kernel];
    SSFR_TRY(place_all(out, particles));
    if (out->kind == SSFR_CONTINUUM_ANISOTROPIC)
        SSFR_TRY(make_stretched(out, particles, anisotropy, volume));
    else
        SSFR_TRY(ssfr_boxes_init(&out->boxes, out->n, (const double(*)[3])out->centre, NULL, support));
end:
    if (result != SSFR_OK) ssfr_continuum_finish(out);
    return result;
}

ssfr_result ssfr_continuum_init_kernels(ssfr_continuum *out, size_t n, const double (*centre)[3],
                                        const double origin[3], const ssfr_radial *radial, double support,
                                        double weight, double level)
{
    ssfr_result result = SSFR_OK;
    *out = (ssfr_continuum){.kind = SSFR_CONTINUUM_DENSITY, .n = n, .support = support, .weight = weight,
                            .level = level, .radius = support, .radial = radial};
    memcpy(out->origin, origin, sizeof out->origin);
    if (!(support > 0 && isnormal(support * support)))
        SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "support %g m: kernels need a positive, finite one", support));
    SSFR_TRY(ssfr_alloc(&out->centre, n, sizeof *out->centre, "kernels"));
    if (n > 0) memcpy(out->centre, centre, n * sizeof *out->centre);
    SSFR_TRY(ssfr_boxes_init(&out->boxes, n, (const double(*)[3])out->centre, NULL, support));
end:
    if (result != SSFR_OK) ssfr_continuum_finish(out);
    return result;
}

void ssfr_continuum_finish(ssfr_continuum *fluid)
{
    free(fluid->centre);
    free(fluid->weights);
    free(fluid->inverse);
    ssfr_boxes_finish(&fluid->boxes);
    *fluid = (ssfr_continuum){0};
}

size_t ssfr_continuum_bytes(const ssfr_continuum *fluid)
{
    const size_t places = fluid->n * sizeof *fluid->centre;
    const size_t weights = fluid->weights ? fluid->n * sizeof *fluid->weights : 0;
    const size_t inverse = fluid->inverse ? fluid->n * sizeof *fluid->inverse : 0;
    return places + weights + inverse + ssfr_boxes_bytes(&fluid->boxes);
}

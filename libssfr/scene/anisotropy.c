/* SPDX-License-Identifier: MIT */
/* anisotropy.c: ellipsoids after the spread of a particle's neighbours (Yu and Turk 2013).
 *
 * Neighbours within the search radius s weigh w = 1 - (distance / s)^3, the particle itself 1. Their weighted
 * covariance has the eigenvalues sigma_1 >= sigma_2 >= sigma_3, m^2, and the ellipsoid has semi-axes in proportion to
 * max(sigma_k, sigma_1 / k_r) along its eigenvectors.
 *
 * The paper multiplies sigma by k_s = 1400, in 1/m^2 and for its own scenes, so that amid fluid the product is about 1.
 * Here the scale follows from the search radius: where neighbours fill space evenly each eigenvalue is
 *      sigma = (1/3) int_0^s r^4 w dr / int_0^s r^2 w dr = (3/20) s^2,
 * and the semi-axes are k_s sigma / ((3/20) s^2) particle radii: k_s = 1 keeps the volume amid fluid in every scene.
 * (1400 is that of s = 0.069 m.) An evenly filled plane then gives 25/21 = 1.19 radii along it, a line 40/27 = 1.48;
 * Imai 2016, sec. 4.2, bounds sizes by 1.2. */
#include "scene/anisotropy.h"
#include "scene/neighbours.h"

#include <float.h>

#define REAL(name, unit, def, min, max, help) SSFR_PARAM_REAL(ssfr_anisotropy_params, name, unit, def, min, max, help)

const ssfr_param ssfr_anisotropy_rows[] = {
    REAL(search, "1", SSFR_SUPPORT, 1, 64, "how far neighbours count, in particle radii: the support"),
    REAL(lambda, "1", 0.9, 0, 1, "how far centres move towards their neighbours' weighted mean; 0: they stay"),
    REAL(k_r, "1", 4, 1, 100, "the longest semi-axis over the shortest, at most"),
    REAL(k_s, "1", 1, 0.01, 100, "size; 1 keeps the volume amid fluid"),
    REAL(k_n, "1", 0.5, 0.01, 100, "semi-axes of particles with few neighbours, in particle radii"),
    REAL(k_max, "1", 1.2, 0.01, 100, "the longest semi-axis, in particle radii (Imai 2016, sec. 4.2)"),
    SSFR_PARAM_INT(ssfr_anisotropy_params, n_eps, "1", 25, 0, 1000000, "up to so many neighbours are few"),
    SSFR_PARAM_END,
};

#undef REAL

ssfr_anisotropy_params ssfr_anisotropy_defaults(void)
{
    ssfr_anisotropy_params params;
    ssfr_params_default(ssfr_anisotropy_rows, &params);
    return params;
}

/* ---- eigenvectors ------------------------------------------------------------------------------------------------ */

/* Turns axes p and q so that a[p][q] vanishes; r is the third. */
static void rotate(double a[3][3], double vectors[3][3], int p, int q, int r)
{
    const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    const double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
    const double rp = a[r][p], rq = a[r][q];
    a[p][p] -= t * a[p][q];
    a[q][q] += t * a[p][q];
    a[p][q] = a[q][p] = 0;
    a[r][p] = a[p][r] = c * rp - s * rq;
    a[r][q] = a[q][r] = s * rp + c * rq;
    for (int k = 0; k < 3; k++) {
        const double vp = vectors[p][k], vq = vectors[q][k];
        vectors[p][k] = c * vp - s * vq;
        vectors[q][k] = s * vp + c * vq;
    }
}

void ssfr_eigen_symmetric(const double matrix[6], double values[3], double vectors[3][3])
{
    enum { MAX_SWEEPS = 32 }; /* they converge quadratically: five or six are the rule */
    const double *m = matrix;
    double a[3][3] = {{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
    double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    int order[3] = {0, 1, 2};
    bool done = false;
    for (int sweep = 0; sweep < MAX_SWEEPS && !done; sweep++) {
        done = true;
        for (int r = 2; r >= 0; r--) {
            const int p = (r + 1) % 3, q = (r + 2) % 3;
            if (fabs(a[p][q]) <= 0.25 * DBL_EPSILON * sqrt(fabs(a[p][p])) * sqrt(fabs(a[q][q]))) continue;
            rotate(a, axes, p, q, r);
            done = false;
        }
    }
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2 - i; k++)
            if (a[order[k]][order[k]] < a[order[k + 1]][order[k + 1]]) {
                const int swap = order[k];
                order[k] = order[k + 1];
                order[k + 1] = swap;
            }
    for (int k = 0; k < 3; k++) {
        values[k] = a[order[k]][order[k]];
        memcpy(vectors[k], axes[order[k]], sizeof vectors[k]);
    }
}

/* ---- a particle's neighbours ------------------------------------------------------------------------------------- */

typedef struct spread {
    double mean[3];       /* from the particle to the weighted mean, in search radii */
    double covariance[6]; /* in squared search radii */
    size_t n;             /* others within the search radius */
} spread;

static spread measure(const ssfr_neighbours *set, size_t k, double search)
{
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    const int n_ranges = ssfr_neighbours_near(set, k, ranges);
    double weights = 0, first[3] = {0}, second[6] = {0};
    spread s = {.n = 0};
    for (int r = 0; r < n_ranges; r++)
        for (size_t j = ranges[r].begin; j < ranges[r].end; j++) {
            double d[3];
            const double square = ssfr_neighbours_between(set, k, j, d);
            if (square >= search * search) continue;
            const double q = sqrt(square) / search, w = 1 - q * q * q;
            s.n += j != k;
            weights += w;
            for (int c = 0; c < 3; c++) d[c] /= search, first[c] += w * d[c];
            second[0] += w * d[0] * d[0], second[1] += w * d[0] * d[1], second[2] += w * d[0] * d[2];
            second[3] += w * d[1] * d[1], second[4] += w * d[1] * d[2], second[5] += w * d[2] * d[2];
        }
    for (int c = 0; c < 3; c++) s.mean[c] = first[c] / weights;
    const double *m = s.mean;
    const double squares[6] = {m[0] * m[0], m[0] * m[1], m[0] * m[2], m[1] * m[1], m[1] * m[2], m[2] * m[2]};
    for (int c = 0; c < 6; c++) s.covariance[c] = second[c] / weights - squares[c];
    return s;
}

/* The sum over the eigenvectors of semi-axis times v v^T. */
static void compose(const double axes[3], const double vectors[3][3], float shape[6])
{
    static const int rows[6] = {0, 0, 0, 1, 1, 2}, columns[6] = {0, 1, 2, 1, 2, 2};
    for (int c = 0; c < 6; c++) {
        double sum = 0;
        for (int k = 0; k < 3; k++) sum += axes[k] * vectors[k][rows[c]] * vectors[k][columns[c]];
        shape[c] = (float)sum;
    }
}

static void shape_of(const ssfr_anisotropy_params *p, const spread *s, float shape[6])
{
    static const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double even = 3.0 / 20; /* an eigenvalue amid fluid, in squared search radii */
    const double few = fmin(p->k_n, p->k_max), least = few / p->k_r; /* clusters shrink to no point */
    double values[3], vectors[3][3], axes[3] = {few, few, few};
    if (s->n <= (size_t)p->n_eps) {
        compose(axes, unit, shape);
        return;
    }
    ssfr_eigen_symmetric(s->covariance, values, vectors);
    for (int k = 0; k < 3; k++)
        axes[k] = ssfr_clamp(p->k_s * fmax(values[k], values[0] / p->k_r) / even, least, p->k_max);
    compose(axes, (const double(*)[3])vectors, shape);
}

ssfr_result ssfr_particles_anisotropy(const ssfr_particles *particles, const ssfr_anisotropy_params *params,
                                      float *centre, float *shape)
{
    ssfr_result result = SSFR_OK;
    const ssfr_anisotropy_params p = params ? *params : ssfr_anisotropy_defaults();
    const double search = p.search * particles->radius;
    ssfr_neighbours set = {0};
    SSFR_TRY(ssfr_params_check(ssfr_anisotropy_rows, &p, "anisotropy"));
    if (!(particles->radius > 0 && isnormal(search * search)))
        SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "particle radius %g m: ellipsoids need a positive, finite one",
                           particles->radius));
    SSFR_TRY(ssfr_neighbours_init(&set, particles, search));
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t k = 0; k < set.n; k++) {
        const size_t i = set.order[k];
        const spread s = measure(&set, k, search);
        for (size_t c = 0; c < 3; c++)
            centre[3 * i + c] = (float)((double)particles->position[3 * i + c] + p.lambda * search * s.mean[c]);
        shape_of(&p, &s, shape + 6 * i);
    }
end:
    ssfr_neighbours_finish(&set);
    return result;
}

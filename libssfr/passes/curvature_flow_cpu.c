/* SPDX-License-Identifier: MIT */
/* curvature_flow_cpu.c: Euler steps of the curvature flow, in double; the formula stands in curvature_flow.c. */
#include "passes/curvature_flow.h"

typedef struct patch { /* a pixel's depth, and by how much its neighbours' differ from it, m */
    double z, left, right, above, below, mm, pm, mp, pp;
} patch;

typedef struct slopes { /* per unit of tangent: z_x / C_x and so on; v grows downwards like rows */
    double z, p, q, r, s, t;
} slopes;

static inline patch look(const ssfr_field *f, int x, int y)
{
    const size_t left = (size_t)ssfr_max_int(x - 1, 0), right = (size_t)ssfr_min_int(x + 1, f->w - 1);
    const double *row = ssfr_field_at(f, 0, y), *up = ssfr_field_at(f, 0, ssfr_max_int(y - 1, 0));
    const double *down = ssfr_field_at(f, 0, ssfr_min_int(y + 1, f->h - 1)), z = row[x];
    return (patch){z, row[left] - z, row[right] - z, up[x] - z, down[x] - z,
                   up[left] - z, up[right] - z, down[left] - z, down[right] - z};
}

/* The larger magnitude, or NaN when either is. */
static inline double larger(double a, double b)
{
    return isnan(b) || fabs(b) > fabs(a) ? fabs(b) : fabs(a);
}

static inline unsigned find_cuts(const patch *d, const ssfr_curvature_flow_coeffs *c)
{
    unsigned cuts = 0;
    if (!(larger(d->left, d->right) <= c->falloff)) cuts |= SSFR_CURVATURE_FLOW_CUT_X;
    if (!(larger(d->above, d->below) <= c->falloff)) cuts |= SSFR_CURVATURE_FLOW_CUT_Y;
    if (c->cross_term && !cuts && !(larger(larger(d->mm, d->pm), larger(d->mp, d->pp)) <= c->falloff))
        cuts = SSFR_CURVATURE_FLOW_CUT_XY;
    return cuts;
}

/* At a silhouette all derivatives along that axis are zero, so nothing is smoothed across it. */
static inline slopes measure(const patch *d, const ssfr_curvature_flow_coeffs *c, unsigned cuts)
{
    slopes k = {.z = fmin(d->z, c->threshold)};
    if (!(cuts & SSFR_CURVATURE_FLOW_CUT_X))
        k.p = (d->right - d->left) / (2 * c->c[0]), k.r = (d->left + d->right) / (c->c[0] * c->c[0]);
    if (!(cuts & SSFR_CURVATURE_FLOW_CUT_Y))
        k.q = (d->below - d->above) / (2 * c->c[1]), k.s = (d->above + d->below) / (c->c[1] * c->c[1]);
    if (c->cross_term && !cuts) k.t = (d->pp - d->pm - d->mp + d->mm) / (4 * c->c[0] * c->c[1]);
    return k;
}

/* -H of eqs 2.11 to 2.16. */
static double printed_rate(const slopes *k, const double c[2])
{
    const double z = k->z, p = k->p, q = k->q, r = k->r, s = k->s, t = k->t, S = p * p + q * q + z * z;
    const double x = p * (p * r + q * t + z * p) - r * S, y = q * (p * t + q * s + z * q) - s * S;
    return -(c[0] * x + c[1] * y) / (2 * S * sqrt(S));
}

/* The mean curvature (E N - 2 F M + G L) / (2 (E G - F^2)) of the surface P = (-z u, -z v, z), times sqrt(C_x C_y) |z|,
 * which makes it equal to the printed rate on the axis where pixels are square. With w = z + u p + v q and
 * l = |(p, q, w)|: L = -(r z - 2 p^2) / l, M = -(t z - 2 p q) / l, N = -(s z - 2 q^2) / l, E G - F^2 = z^2 l^2; below,
 * L, M and N are without their -1 / l. */
static double exact_rate(const slopes *k, const double c[2], double u, double v)
{
    const double z = k->z, p = k->p, q = k->q, w = z + u * p + v * q, l2 = p * p + q * q + w * w;
    const double E = (p * u + z) * (p * u + z) + p * p * (v * v + 1);
    const double F = (p * u + z) * q * u + p * v * (q * v + z) + p * q;
    const double G = (q * v + z) * (q * v + z) + q * q * (u * u + 1);
    const double L = k->r * z - 2 * p * p, M = k->t * z - 2 * p * q, N = k->s * z - 2 * q * q;
    const double twice = -(E * N - 2 * F * M + G * L) / (z * z * l2 * sqrt(l2));
    return sqrt(c[0] * c[1]) * fabs(z) * twice / 2;
}

/* dt of a pixel at depth z, m^2, before any limit. */
static inline double free_dt(const ssfr_curvature_flow_coeffs *c, double z)
{
    return c->over_depth ? c->dt / fabs(z) : c->dt;
}

/* By what a limit or a bound at |z| = 1 on the axis is multiplied, m. */
static inline double reach(const ssfr_curvature_flow_coeffs *c, double z, const double ray[2])
{
    const double away = 1 + ray[0] * ray[0] + ray[1] * ray[1];
    return c->off_axis ? fabs(z) / (away * sqrt(away)) : fabs(z);
}

/* dt of a pixel at depth z, m^2. */
static inline double dt_at(const ssfr_curvature_flow_coeffs *c, double z, const double ray[2])
{
    return fmin(free_dt(c, z), c->limit * reach(c, z, ray));
}

/* Eye-space x and y at unit distance, y downwards like rows. */
static inline void ray_of(const ssfr_run *run, int x, int y, double ray[2])
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    const double *image = run->frame->block.image;
    ray[0] = ((x + 0.5) * c->divisor - 0.5 * image[0]) * image[2];
    ray[1] = ((y + 0.5) * c->divisor - 0.5 * image[1]) * image[3];
}

static inline double rate(const ssfr_run *run, const patch *d, int x, int y, unsigned cuts)
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    const slopes k = measure(d, c, cuts);
    double ray[2];
    ray_of(run, x, y, ray);
    return dt_at(c, k.z, ray) * (c->off_axis ? exact_rate(&k, c->c, ray[0], ray[1]) : printed_rate(&k, c->c));
}

static double step(const ssfr_run *run, const ssfr_field *from, int x, int y)
{
    const patch d = look(from, x, y);
    return d.z + rate(run, &d, x, y, find_cuts(&d, run->coeffs));
}

static void sweep(const ssfr_run *run, const ssfr_field *from, ssfr_field *to)
{
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) {
            const double z = *ssfr_field_fetch(from, x, y);
            *ssfr_field_at(to, x, y) = ssfr_is_surface(z) ? step(run, from, x, y) : z;
        }
}

static bool is_unstable(const ssfr_run *run, int x, int y)
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    const double depth = *ssfr_field_fetch(run->in[0], x, y), z = fmin(depth, c->threshold);
    double ray[2];
    ray_of(run, x, y, ray);
    return ssfr_is_surface(depth) && free_dt(c, z) > c->bound * reach(c, z, ray);
}

void ssfr_curvature_flow_count(const ssfr_run *run)
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    uint32_t n = 0;
    if (!c->counts || c->iterations == 0) return;
#pragma omp parallel for schedule(static) reduction(+ : n)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) n += is_unstable(run, x, y);
    run->words[SSFR_CURVATURE_FLOW_N_UNSTABLE] = n;
}

void ssfr_curvature_flow_cpu(const ssfr_run *run)
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    const ssfr_field *from = run->in[0];
    ssfr_curvature_flow_count(run);
    for (int i = 0; i < c->iterations; i++) {
        ssfr_field *to = (c->iterations - i) % 2 == 1 ? run->out[0] : run->scratch[0];
        sweep(run, from, to);
        from = to;
    }
    if (c->iterations == 0)
        memcpy(run->out[0]->data, from->data, (size_t)from->w * (size_t)from->h * sizeof *from->data);
}

/* ---- the same for who takes other steps -------------------------------------------------------------------------- */

double ssfr_curvature_flow_jump(const ssfr_field *depth, int x, int y, unsigned cut)
{
    const patch d = look(depth, x, y);
    if (cut == SSFR_CURVATURE_FLOW_CUT_X) return larger(d.left, d.right);
    if (cut == SSFR_CURVATURE_FLOW_CUT_Y) return larger(d.above, d.below);
    return larger(larger(d.mm, d.pm), larger(d.mp, d.pp));
}

unsigned ssfr_curvature_flow_cuts(const ssfr_run *run, const ssfr_field *depth, int x, int y)
{
    const patch d = look(depth, x, y);
    return find_cuts(&d, run->coeffs);
}

double ssfr_curvature_flow_dt(const ssfr_run *run, double z, int x, int y)
{
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    double ray[2];
    ray_of(run, x, y, ray);
    return dt_at(c, fmin(z, c->threshold), ray);
}

double ssfr_curvature_flow_rate(const ssfr_run *run, const ssfr_field *depth, int x, int y, unsigned cuts)
{
    const patch d = look(depth, x, y);
    return rate(run, &d, x, y, cuts);
}

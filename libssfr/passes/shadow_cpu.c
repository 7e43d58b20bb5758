/* SPDX-License-Identifier: MIT */
/* shadow_cpu.c: the share of the light that arrives at the fluid, in double. */
#include "passes/shadow.h"

#include "passes/environment.h"
#include "passes/shadow_basis.h"

/* ---- where the fluid is ------------------------------------------------------------------------------------------ */

/* The mean of the depths around a pixel that are a surface; empty where none is. */
static double mean_depth(const ssfr_field *depth, int x, int y, int around)
{
    double sum = 0;
    int n = 0;
    for (int j = -around; j <= around; j++)
        for (int i = -around; i <= around; i++) {
            const double z = ssfr_depth_at(depth, x + i, y + j);
            if (!ssfr_is_surface(z)) continue;
            sum += z;
            n++;
        }
    return n ? sum / n : -SSFR_EMPTY;
}

static double fluid_depth(const ssfr_run *run, int x, int y)
{
    const ssfr_shadow_coeffs *c = run->coeffs;
    const double z = mean_depth(run->in[SSFR_SHADOW_DEPTH], x, y, c->around);
    const bool alone = ssfr_is_surface(z) && c->foam != SSFR_SHADOW_FOAM_FRONT;
    if (alone || c->foam == SSFR_SHADOW_NO_FOAM) return z;
    return fmax(z, mean_depth(run->in[SSFR_SHADOW_FOAM_DEPTH], x, y, c->around));
}

/* A place in the light's view: m along its axes, the third from the eye towards the light. */
static void place_in_light(const ssfr_run *run, int x, int y, double z, double out[3])
{
    const ssfr_shadow_coeffs *c = run->coeffs;
    double eye[3] = {0, 0, z}, world[3];
    ssfr_slope_at(&run->frame->block, (x + 0.5) * c->divisor, (y + 0.5) * c->divisor, eye);
    for (int k = 0; k < 2; k++) eye[k] *= -z;
    ssfr_world_from_eye(&run->frame->block, eye, world);
    out[0] = ssfr_dot(world, c->view.x), out[1] = ssfr_dot(world, c->view.y);
    out[2] = ssfr_dot(world, c->view.to) + c->bias;
}

/* ---- what the light meets ---------------------------------------------------------------------------------------- */

/* A place in the light's view, in texels of a square of this side. False beyond its border: no fluid is there, or no
 * caster. */
static bool texel_of(const ssfr_light_view *view, const double at[2], int side, double out[2])
{
    bool within = true;
    for (int k = 0; k < 2; k++) {
        const double share = (at[k] - view->corner[k]) / view->extent;
        within &= share >= 0 && share <= 1;
        out[k] = share * side;
    }
    return within;
}

static double nearest_caster(const ssfr_run *run, const double at[2])
{
    const ssfr_field *map = run->in[SSFR_SHADOW_LIGHT_DEPTH];
    double q[2];
    if (!texel_of(&((const ssfr_shadow_coeffs *)run->coeffs)->view, at, map->w, q)) return -SSFR_EMPTY;
    return *ssfr_field_fetch(map, (int)floor(q[0]), (int)floor(q[1]));
}

/* Image i of the basis, between its four texels around q. */
static void basis_at(const ssfr_field *basis, int i, const double q[2], double out[4])
{
    const double u = floor(q[0] - 0.5), v = floor(q[1] - 0.5), a = q[0] - 0.5 - u, b = q[1] - 0.5 - v;
    const int x = (int)u, top = i * basis->w, y0 = top + ssfr_clamp_int((int)v, 0, basis->w - 1);
    const int y1 = top + ssfr_clamp_int((int)v + 1, 0, basis->w - 1);
    for (int k = 0; k < 4; k++)
        out[k] = ssfr_mix(ssfr_mix(ssfr_field_fetch(basis, x, y0)[k], ssfr_field_fetch(basis, x + 1, y0)[k], a),
                          ssfr_mix(ssfr_field_fetch(basis, x, y1)[k], ssfr_field_fetch(basis, x + 1, y1)[k], a), b);
}

/* The series at the fluid's depth, for the share of texels that have casters; the others are lit. */
static double convolved(const ssfr_run *run, const double at[3])
{
    const ssfr_shadow_coeffs *c = run->coeffs;
    const ssfr_field *basis = run->in[SSFR_SHADOW_BASIS];
    const int n_images = ssfr_max_int(basis->h / basis->w, 1);
    const double d = ssfr_clamp((c->view.top - at[2]) / c->view.range, 0, 1) * ssfr_shadow_span(n_images);
    double q[2], share = 0, sum = 0;
    if (!texel_of(&c->view, at, basis->w, q)) return 1;
    for (int i = 0; i < n_images; i++) {
        double v[4];
        basis_at(basis, i, q, v);
        for (int k = 0; k < 4; k++) {
            const int value = 4 * i + k;
            const double angle = M_PI * (2 * ((value + 1) / 2) - 1) * d;
            if (value == 0) share = v[k];
            else sum += value % 2 ? -sin(angle) * v[k] : cos(angle) * v[k];
        }
    }
    return 1 - share + ssfr_clamp(c->scale * (0.5 * share + sum), 0, share);
}

static double light_at(const ssfr_run *run, const double at[3])
{
    const ssfr_shadow_coeffs *c = run->coeffs;
    if (c->view.night) return 0;
    if (c->kind == SSFR_SHADOW_CONVOLUTION) return convolved(run, at);
    const double caster = c->kind == SSFR_SHADOW_MAP ? nearest_caster(run, at)
                                                     : ssfr_light_view_first(run->frame, &c->view, at[0], at[1]);
    return caster > at[2] ? 0 : 1;
}

void ssfr_shadow_cpu(const ssfr_run *run)
{
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) {
            const double z = fluid_depth(run, x, y);
            double at[3];
            if (!ssfr_is_surface(z)) continue;
            place_in_light(run, x, y, z, at);
            *ssfr_field_at(run->out[0], x, y) = light_at(run, at);
        }
}

/* SPDX-License-Identifier: MIT */
/* foam_thickness_cpu.c: the sum of the foam particles' chords times noise at each pixel, in double. */
#include "passes/foam_thickness.h"
#include "passes/perlin.h"
#include "passes/thickness.h"

static double place_in_time(const ssfr_run *run, size_t particle)
{
    const ssfr_foam_thickness_coeffs *c = run->coeffs;
    const ssfr_particles *p = run->frame->particles;
    const double lifetime = (double)*ssfr_values_at(run->values[2], particle);
    const double periods = (lifetime > 0 ? fmin(lifetime, SSFR_FOAM_OLDEST) : 0) * c->noise_rate;
    const double share = c->by_id ? ssfr_lattice_share(p->id ? p->id[particle] : (uint32_t)particle) : 0;
    return periods - floor(periods) + share;
}

static double noise_at(const ssfr_run *run, const ssfr_fragment *f)
{
    const ssfr_foam_thickness_coeffs *c = run->coeffs;
    if (c->noise == SSFR_FOAM_NOISE_CONSTANT) return 0.5;
    const double place[3] = {0.5 + 0.5 * f->a, 0.5 + 0.5 * f->b, place_in_time(run, f->particle)};
    return c->noise == SSFR_FOAM_NOISE_TEXTURE ? ssfr_texels_between(run->tables[SSFR_FOAM_PERLIN], place, 0)
                                               : ssfr_foam_noise(place, 0);
}

/* The foam's front is told from the particle's centre, or from its own front at each pixel. */
static bool is_in_front(const ssfr_run *run, const ssfr_fragment *f)
{
    const ssfr_foam_thickness_coeffs *c = run->coeffs;
    const ssfr_field *foam = run->in[1];
    if (c->by_centre) return f->centre[2] >= ssfr_splat_seen(run, foam, f->centre) - c->delta_foam;
    return f->front >= *ssfr_field_fetch(foam, f->x, f->y) - c->delta_foam;
}

static void add(const ssfr_run *run, const ssfr_fragment *f, double *pixel)
{
    const ssfr_foam_thickness_coeffs *c = run->coeffs;
    const double scene = *ssfr_field_fetch(run->in[0], f->x, f->y);
    double t = f->chord * c->scale;
    if (f->front < scene) return;
    if (c->exponential) t *= exp(-2 * f->r2);
    if (c->kept) t /= f->area;
    if (c->clipped) t *= (f->front - fmax(f->back, scene)) / fmax(f->front - f->back, 1e-20);
    t *= noise_at(run, f);
    ssfr_thickness_add(c->half, t, pixel);
    if (is_in_front(run, f)) ssfr_thickness_add(c->half, t, ssfr_field_at(run->out[1], f->x, f->y));
}

void ssfr_foam_thickness_cpu(const ssfr_run *run)
{
    ssfr_streak_cpu(run, add);
}

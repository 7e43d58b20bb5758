/* SPDX-License-Identifier: MIT */
/* foam_thickness_cpu.c: the sum of the foam particles' chords times noise at each pixel, in double. */
#include "passes/foam_thickness.h"
#include "passes/perlin.h"

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

static void add(const ssfr_run *run, const ssfr_fragment *hit, double *pixel)
{
    const ssfr_foam_thickness_coeffs *c = run->coeffs;
    ssfr_fragment f = *hit;
    if (!c->kept) f.area = 1;
    double t = ssfr_thickness_of(run, &c->sum, &f);
    if (t == 0) return;
    t *= noise_at(run, &f);
    ssfr_thickness_add(c->sum.half, t, pixel);
    if (is_in_front(run, &f)) ssfr_thickness_add(c->sum.half, t, ssfr_field_at(run->out[1], f.x, f.y));
}

void ssfr_foam_thickness_cpu(const ssfr_run *run)
{
    ssfr_streak_cpu(run, add);
}

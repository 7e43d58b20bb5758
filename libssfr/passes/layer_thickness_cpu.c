/* SPDX-License-Identifier: MIT */
/* layer_thickness_cpu.c: water before and behind the front of the foam at each pixel, in double. */
#include "passes/layer_thickness.h"

/* The share of what the particle adds that is before the foam. */
static double share_before(const ssfr_run *run, const ssfr_fragment *f)
{
    const ssfr_layer_thickness_coeffs *c = run->coeffs;
    const ssfr_field *depth = run->in[SSFR_LAYER_FOAM_DEPTH];
    const double foam = c->by_centre ? ssfr_splat_seen(run, depth, f->centre) : *ssfr_field_fetch(depth, f->x, f->y);
    if (!ssfr_is_surface(foam)) return c->open;
    if (c->by_centre) return f->centre[2] >= foam;
    return (f->front - ssfr_clamp(foam, f->back, f->front)) / fmax(f->front - f->back, 1e-20);
}

static void add(const ssfr_run *run, const ssfr_fragment *hit, double *behind)
{
    const ssfr_thickness_sum *sum = &((const ssfr_thickness_coeffs *)run->coeffs)->sum;
    ssfr_fragment f = *hit;
    ssfr_field *before = run->out[SSFR_LAYER_BEFORE];
    const double t = ssfr_thickness_of(run, sum, &f), share = before ? share_before(run, &f) : 0;
    ssfr_thickness_add(sum->half, (1 - share) * t, behind);
    if (before) ssfr_thickness_add(sum->half, share * t, ssfr_field_at(before, f.x, f.y));
}

void ssfr_layer_thickness_cpu(const ssfr_run *run)
{
    ssfr_splat_cpu(run, add);
}

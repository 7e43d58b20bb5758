/* SPDX-License-Identifier: MIT */
/* layer_thickness_cpu.c: water before and behind the front of the foam at each pixel, in double. */
#include "passes/layer_thickness.h"

/* The foam where the centre is seen, or at the nearest pixel of the image; a centre before the near plane is seen as if
 * in it. */
static double foam_at_centre(const ssfr_run *run, const double c[3])
{
    const double *image = run->frame->block.image, away = fmax(-c[2], run->frame->near);
    const double x = 0.5 * image[0] + c[0] / away / image[2], y = 0.5 * image[1] - c[1] / away / image[3];
    return *ssfr_field_fetch(run->in[SSFR_LAYER_FOAM_DEPTH], (int)ssfr_clamp(x, 0, run->w),
                             (int)ssfr_clamp(y, 0, run->h));
}

/* The share of what the particle adds that is before the foam. */
static double share_before(const ssfr_run *run, const ssfr_fragment *f)
{
    const ssfr_layer_thickness_coeffs *c = run->coeffs;
    const double foam = c->by_centre ? foam_at_centre(run, f->centre)
                                     : *ssfr_field_fetch(run->in[SSFR_LAYER_FOAM_DEPTH], f->x, f->y);
    if (!ssfr_is_surface(foam)) return c->open;
    if (c->by_centre) return f->centre[2] >= foam;
    return (f->front - ssfr_clamp(foam, f->back, f->front)) / fmax(f->front - f->back, 1e-20);
}

static void add(const ssfr_run *run, const ssfr_fragment *hit, double *behind)
{
    ssfr_fragment f = *hit;
    ssfr_field *before = run->out[SSFR_LAYER_BEFORE];
    const double t = ssfr_thickness_of(run, &f), share = before ? share_before(run, &f) : 0;
    ssfr_thickness_add(run, (1 - share) * t, behind);
    if (before) ssfr_thickness_add(run, share * t, ssfr_field_at(before, f.x, f.y));
}

void ssfr_layer_thickness_cpu(const ssfr_run *run)
{
    ssfr_splat_cpu(run, add);
}

/* SPDX-License-Identifier: MIT */
/* layer_composite_cpu.c: layers of water and foam over the scene, from back to front, in double. */
#include "passes/layer_composite.h"

typedef struct layers { /* of one pixel */
    const ssfr_layer_composite_coeffs *c;
    ssfr_surface s;
    double back, front, foam, foam_front; /* m */
    double light;                         /* [0, 1] */
} layers;

/* Water over a colour, eqs 3.5 and 3.7; gives what comes through. */
static void cover_with_water(const layers *l, double thickness, double color[3], double through[3])
{
    const ssfr_layer_composite_coeffs *c = l->c;
    ssfr_surface_through(&l->s, thickness, through);
    for (int k = 0; k < 3; k++) {
        const double darkened = c->base[k] * exp(-thickness * c->falloff[k]);
        if (c->falloff_model) through[k] = exp(-thickness * c->falloff[3]);
        color[k] = ssfr_mix(c->falloff_model ? darkened : l->s.block->fluid[k], color[k], through[k]);
    }
}

/* Foam over a colour, eqs 3.6 and 3.9; gives what comes through. */
static double cover_with_foam(const layers *l, double color[3])
{
    const ssfr_layer_composite_coeffs *c = l->c;
    const double t = pow(fmin(l->foam_front * c->foam[1], c->foam[2]), c->foam[3]);
    const double share = c->power_blend ? t : c->foam_swapped ? exp(-t) : 1 - exp(-t); /* of c_ff */
    const double through = exp(-l->foam * c->foam[0]), lit = ssfr_mix(c->ambient, 1, l->light);
    for (int k = 0; k < 3; k++)
        color[k] = ssfr_mix(ssfr_mix(c->c_fb[k], c->c_ff[k], share) * lit, color[k], through);
    return through;
}

static double fresnel(const layers *l)
{
    const ssfr_layer_composite_coeffs *c = l->c;
    if (c->exact_fresnel) return ssfr_surface_fresnel(&l->s);
    if (c->cosine_added) return c->fresnel[0] + c->fresnel[1] * pow(1 + l->s.cosine, c->fresnel[2]);
    return fmin(c->fresnel[0] + c->fresnel[1] * pow(1 - l->s.cosine, c->fresnel[2]), 1);
}

/* Eq. 3.8. */
static void illuminate(const layers *l, double color[3])
{
    double mirrored[3];
    const double f = fresnel(l), shine = l->light * ssfr_surface_highlight(&l->s);
    ssfr_surface_reflected(&l->s, mirrored);
    for (int k = 0; k < 3; k++) color[k] = ssfr_mix(color[k], mirrored[k], f) + shine;
}

/* In its place, listing A.20: added as far as water is before the foam. */
static void add_weighted(const layers *l, const double through[3], double through_foam, double color[3])
{
    double mirrored[3];
    const double f = fresnel(l), shine = l->light * ssfr_surface_highlight(&l->s);
    ssfr_surface_reflected(&l->s, mirrored);
    for (int k = 0; k < 3; k++)
        color[k] += (mirrored[k] * f + shine) * fmin(1 - through[k] + through_foam, 1) * (1 - through[k]);
}

static void compose(const layers *l, double color[3])
{
    const bool water = ssfr_is_surface(l->s.z), illuminated = water && !l->c->front_weight;
    const double beta = l->c->shift * (l->back + l->front);
    const double d[2] = {water ? beta * l->s.n[0] : 0, water ? -beta * l->s.n[1] : 0};
    double through[3];
    ssfr_surface_refracted(&l->s, d, color);
    cover_with_water(l, l->back, color, through);
    if (illuminated && !(l->front > 0)) illuminate(l, color);
    const double through_foam = cover_with_foam(l, color);
    cover_with_water(l, l->front, color, through);
    if (illuminated && l->front > 0) illuminate(l, color);
    if (water && l->c->front_weight) add_weighted(l, through, through_foam, color);
}

/* Listing A.23. */
static void compose_border(layers *l, const ssfr_split_pixel *at, double color[3])
{
    double sum[3] = {0};
    for (int k = 0; k < 4; k++) {
        const double weight = ssfr_split_weight(at, k);
        if (!(weight > 0)) continue;
        l->s = ssfr_split_sample(at, k);
        compose(l, color);
        for (int j = 0; j < 3; j++) sum[j] += weight * color[j];
    }
    memcpy(color, sum, sizeof sum);
}

/* Depths of low resolution reach over the water's outline: its thickness says where it ends. */
static bool compose_split(const ssfr_run *run, int x, int y, layers *l, double color[3])
{
    const bool water = l->back > 0 || l->front > 0;
    const ssfr_split_pixel at = ssfr_split_at(run, &l->c->split, run->in[SSFR_LAYER_LOW], x, y);
    l->s = at.inner;
    if (!water) l->s.z = -SSFR_EMPTY;
    if (water && at.border) compose_border(l, &at, color);
    else compose(l, color);
    return water && at.border;
}

static void pixel(const ssfr_run *run, int x, int y)
{
    const ssfr_layer_composite_coeffs *c = run->coeffs;
    layers l = {.c = c,
                .back = ssfr_optics_value(run->in[SSFR_LAYER_BACK], x, y, SSFR_THICKEST),
                .front = ssfr_optics_value(run->in[SSFR_LAYER_FRONT], x, y, SSFR_THICKEST),
                .foam = ssfr_optics_value(run->in[SSFR_LAYER_FOAM], x, y, SSFR_THICKEST),
                .foam_front = ssfr_optics_value(run->in[SSFR_LAYER_FOAM_FRONT], x, y, SSFR_THICKEST),
                .light = ssfr_optics_value(run->in[SSFR_LAYER_LIGHT], x, y, 1)};
    double *color = ssfr_field_at(run->out[0], x, y);
    bool border = false;
    if (!c->is_split) l.s = ssfr_surface_at(run, x, y);
    if (!(l.back > 0 || l.front > 0 || l.foam > 0) && (c->is_split || !ssfr_is_surface(l.s.z))) return; /* the scene */
    if (c->is_split) border = compose_split(run, x, y, &l, color);
    else compose(&l, color);
    if (run->n_out > 1) *ssfr_field_at(run->out[1], x, y) = border;
}

void ssfr_layer_composite_cpu(const ssfr_run *run)
{
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) pixel(run, x, y);
}

/* SPDX-License-Identifier: MIT */
/* composite_cpu.c: refraction, attenuation, reflection and highlight of one surface, in double. */
#include "passes/composite.h"
#include "passes/environment.h"

typedef struct shading { /* of one pixel */
    const ssfr_run *run;
    const ssfr_composite_coeffs *c;
    const ssfr_block *block;
    int x, y;
    double z, thickness, n[3];
    double position[3]; /* m, eye space */
    double view[3];     /* unit, towards the eye */
    double cosine;      /* between normal and view, [0, 1] */
} shading;

static double fresnel(const shading *s)
{
    const double ior = s->block->absorption[3], cosine = s->cosine, one = 1 - cosine;
    if (s->c->fresnel == SSFR_FRESNEL_SCHLICK) return s->c->r0 + (1 - s->c->r0) * one * one * one * one * one;
    const double inside = sqrt(ior * ior - 1 + cosine * cosine); /* ior times the cosine inside the fluid */
    const double across = (cosine - inside) / fmax(cosine + inside, 1e-20); /* 0 / 0 for index 1 at grazing angles */
    const double along = (ior * ior * cosine - inside) / fmax(ior * ior * cosine + inside, 1e-20);
    return 0.5 * (across * across + along * along);
}

/* Where the light from behind the fluid comes from, as a shift in pixels. */
static void shift(const shading *s, double d[2])
{
    const double *image = s->block->image, eta = 1 / s->block->absorption[3];
    if (s->c->refraction == SSFR_REFRACTION_OFFSET) {
        const double beta = s->c->gamma * s->thickness * image[1];
        d[0] = beta * s->n[0], d[1] = -beta * s->n[1];
    } else {
        const double bend = eta * s->cosine - sqrt(1 - eta * eta * (1 - s->cosine * s->cosine));
        double q[3];
        for (int k = 0; k < 3; k++) q[k] = s->position[k] + s->thickness * (bend * s->n[k] - eta * s->view[k]);
        q[2] = fmin(q[2], -s->run->frame->near);
        d[0] = (q[0] / -q[2] - s->position[0] / -s->z) / image[2];
        d[1] = -(q[1] / -q[2] - s->position[1] / -s->z) / image[3];
    }
}

/* Between the four pixels around (x, y), px; centres stand at halves. */
static void fetch_linear(const ssfr_field *f, double x, double y, double out[3])
{
    const double fx = floor(x - 0.5), fy = floor(y - 0.5), ax = x - 0.5 - fx, ay = y - 0.5 - fy;
    const int i = (int)fx, j = (int)fy;
    for (int k = 0; k < 3; k++)
        out[k] = ssfr_mix(ssfr_mix(ssfr_field_fetch(f, i, j)[k], ssfr_field_fetch(f, i + 1, j)[k], ax),
                          ssfr_mix(ssfr_field_fetch(f, i, j + 1)[k], ssfr_field_fetch(f, i + 1, j + 1)[k], ax), ay);
}

static void refracted(const shading *s, double out[3])
{
    double d[2], x = s->x + 0.5, y = s->y + 0.5;
    shift(s, d);
    const double px = ssfr_clamp(x + d[0], 0, s->run->w), py = ssfr_clamp(y + d[1], 0, s->run->h);
    const double behind = *ssfr_field_fetch(s->run->in[1], (int)floor(px), (int)floor(py));
    if (!(s->c->reject && behind > s->z)) x = px, y = py;
    fetch_linear(s->run->in[0], x, y, out);
}

static void attenuate(const shading *s, double color[3])
{
    for (int k = 0; k < 3; k++) {
        const double a = s->c->single ? s->c->attenuation : s->block->absorption[k];
        color[k] = ssfr_mix(s->block->fluid[k], color[k], exp(-a * s->thickness));
    }
}

static void reflected(const shading *s, double out[3])
{
    double mirror[3], dir[3], origin[3];
    ssfr_solid_set solids;
    const double turn = 2 * ssfr_dot(s->n, s->view);
    for (int k = 0; k < 3; k++) mirror[k] = turn * s->n[k] - s->view[k];
    ssfr_world_from_eye(s->block, mirror, dir);
    ssfr_world_from_eye(s->block, s->position, origin);
    ssfr_normalize(dir);
    ssfr_frame_all_solids(s->run->frame, solids);
    if (s->c->reflection == SSFR_REFLECTION_SKY) ssfr_environment_sky(s->run->frame, dir, out);
    else ssfr_environment_trace(s->run->frame, solids, origin, dir, out);
}

static double highlight(const shading *s)
{
    double n[3], half[3];
    ssfr_world_from_eye(s->block, s->n, n);
    ssfr_world_from_eye(s->block, s->view, half);
    for (int k = 0; k < 3; k++) half[k] += s->block->light[k];
    ssfr_normalize(half);
    const double lit = ssfr_dot(n, s->block->light) > 0 ? s->block->light[3] : 0;
    return lit * s->c->specular * pow(fmax(ssfr_dot(n, half), 0), s->c->shininess);
}

static void shade(const shading *s, double out[3])
{
    double behind[3], mirrored[3];
    const double f = fresnel(s), shine = highlight(s);
    refracted(s, behind);
    attenuate(s, behind);
    reflected(s, mirrored);
    for (int k = 0; k < 3; k++) out[k] = ssfr_mix(behind[k], mirrored[k], f) + shine;
}

static void pixel(const ssfr_run *run, int x, int y, double out[3])
{
    shading s = {.run = run, .c = run->coeffs, .block = &run->frame->block, .x = x, .y = y};
    const double *n = ssfr_field_fetch(run->in[3], x, y);
    s.z = *ssfr_field_fetch(run->in[2], x, y);
    s.thickness = *ssfr_field_fetch(run->in[4], x, y);
    for (int k = 0; k < 3; k++) s.n[k] = n[k];
    if (!ssfr_is_surface(s.z)) return;
    ssfr_slope_at(s.block, x + 0.5, y + 0.5, s.position);
    for (int k = 0; k < 2; k++) s.position[k] *= -s.z;
    s.position[2] = s.z;
    for (int k = 0; k < 3; k++) s.view[k] = -s.position[k];
    ssfr_normalize(s.view);
    s.cosine = ssfr_clamp(ssfr_dot(s.n, s.view), 0, 1);
    shade(&s, out);
}

void ssfr_composite_cpu(const ssfr_run *run)
{
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) pixel(run, x, y, ssfr_field_at(run->out[0], x, y));
}

/* SPDX-License-Identifier: MIT */
/* splat_cpu.c: particles into pixels, in double: the twin of shaders/splat.vert and shaders/splat.glsl. */
#include "passes/environment.h"
#include "passes/splat.h"

typedef struct footprint { /* of one particle */
    double centre[3];  /* m, eye space */
    double px[2], r[2]; /* centre and radius of the disc, px (points and quads) */
    double half;        /* px, half the side of a point's square, infinite for the others */
    double lo[2], hi[2]; /* px, box that holds it */
} footprint;

static bool place_disc(const ssfr_run *run, const ssfr_splat *splat, footprint *f)
{
    const ssfr_block *b = &run->frame->block;
    const double *c = f->centre;
    if (c[2] > -run->frame->near) return false;
    const double distance = splat->by_distance ? sqrt(ssfr_dot(c, c)) : -c[2];
    for (int k = 0; k < 2; k++) {
        const double side = k ? -c[1] : c[0];
        f->px[k] = 0.5 * b->image[k] - side / c[2] / b->image[2 + k];
        f->r[k] = splat->radius / (b->image[2 + k] * distance);
    }
    f->half = INFINITY;
    if (splat->form == SSFR_SPLAT_POINT) {
        if (f->px[0] < 0 || f->px[1] < 0 || f->px[0] > b->image[0] || f->px[1] > b->image[1]) return false;
        f->half = 0.5 * fmin(2 * fmax(f->r[0], f->r[1]) + 2, splat->max_point_px);
    }
    for (int k = 0; k < 2; k++) f->lo[k] = f->px[k] - f->r[k] - 1, f->hi[k] = f->px[k] + f->r[k] + 1;
    return true;
}

/* Tangents from the eye to the sphere's circle in the plane of one image axis, px; the whole image when it has none. */
static void bound_outline(double c, double d, double radius, double per_pixel, double size, double *lo, double *hi)
{
    const double power = c * c + d * d - radius * radius;
    *lo = 0, *hi = size;
    if (d > radius && power > 0) {
        const double root = radius * sqrt(power), below = (d * d - radius * radius) * per_pixel;
        *lo = 0.5 * size + (c * d - root) / below - 1;
        *hi = 0.5 * size + (c * d + root) / below + 1;
    }
}

static bool place_outline(const ssfr_run *run, const ssfr_splat *splat, footprint *f)
{
    const ssfr_block *b = &run->frame->block;
    const double *c = f->centre;
    if (-c[2] + splat->radius < run->frame->near) return false; /* all of it behind the near plane */
    bound_outline(c[0], -c[2], splat->radius, b->image[2], b->image[0], &f->lo[0], &f->hi[0]);
    bound_outline(-c[1], -c[2], splat->radius, b->image[3], b->image[1], &f->lo[1], &f->hi[1]);
    return true;
}

static bool hit_disc(const ssfr_run *run, const ssfr_splat *splat, const footprint *f, ssfr_fragment *frag)
{
    const double dx = frag->x + 0.5 - f->px[0], dy = frag->y + 0.5 - f->px[1];
    frag->a = dx / f->r[0], frag->b = dy / f->r[1];
    frag->r2 = frag->a * frag->a + frag->b * frag->b;
    if (frag->r2 > 1 || fabs(dx) > f->half || fabs(dy) > f->half) return false;
    const double rise = splat->radius * ssfr_root_of(splat->root, run->tables, 1 - frag->r2);
    frag->front = f->centre[2] + rise, frag->back = f->centre[2] - rise;
    frag->chord = 2 * rise;
    return true;
}

/* The point of the ray nearest to the centre, not the quadratic formula: its discriminant cancels for far spheres. */
static bool hit_sphere(const ssfr_run *run, const ssfr_splat *splat, const footprint *f, ssfr_fragment *frag)
{
    double d[3] = {0, 0, -1}, p[3];
    ssfr_slope_at(&run->frame->block, frag->x + 0.5, frag->y + 0.5, d);
    const double dd = ssfr_dot(d, d), t = ssfr_dot(d, f->centre) / dd;
    for (int k = 0; k < 3; k++) p[k] = t * d[k] - f->centre[k];
    const double radius = splat->radius, r = sqrt(ssfr_dot(p, p));
    if (r > radius) return false;
    const double rise = sqrt((radius - r) * (radius + r) / dd);
    frag->a = p[0] / radius, frag->b = -p[1] / radius;
    frag->r2 = r / radius * (r / radius);
    frag->front = -(t - rise), frag->back = -(t + rise);
    frag->chord = 2 * rise * sqrt(dd);
    return true;
}

/* The eye is inside the sphere: what the ray sees of it begins at the near plane. */
static void cut_front(ssfr_fragment *frag, double near)
{
    frag->chord *= (near - frag->back) / (frag->front - frag->back);
    frag->front = near;
}

void ssfr_splat_emit(const ssfr_run *run, ssfr_fragment *f, ssfr_splat_shade *shade)
{
    const double near = -run->frame->near;
    if (f->back > near) return;
    if (f->front > near) cut_front(f, near);
    shade(run, f, ssfr_field_at(run->out[0], f->x, f->y));
}

void ssfr_splat_keep_nearest(const ssfr_run *run, const ssfr_fragment *f, double *pixel)
{
    if (f->front >= *ssfr_field_fetch(run->in[0], f->x, f->y)) *pixel = fmax(*pixel, f->front);
}

ssfr_box ssfr_splat_box(const ssfr_run *run, const double lo[2], const double hi[2], int y0, int y1)
{
    return (ssfr_box){(int)floor(ssfr_clamp(lo[0], 0, run->w)), (int)ceil(ssfr_clamp(hi[0], 0, run->w)),
                      (int)floor(ssfr_clamp(lo[1], y0, y1)), (int)ceil(ssfr_clamp(hi[1], y0, y1))};
}

/* What all particles share, for one of its own size; false where it is not drawn. */
static bool size_splat(const ssfr_run *run, size_t i, ssfr_splat *splat)
{
    const double size = run->values[0] ? (double)*ssfr_values_at(run->values[0], i) : 1;
    *splat = *(const ssfr_splat *)run->coeffs;
    splat->radius *= size;
    return size > 0 && !(splat->spares_foam && *ssfr_values_at(run->values[1], i) > 0);
}

static void draw_particle(const ssfr_run *run, size_t i, int y0, int y1, ssfr_splat_shade *shade)
{
    ssfr_splat sized, *const splat = &sized;
    footprint f;
    ssfr_fragment frag = {.particle = i, .centre = f.centre, .area = 1};
    if (!size_splat(run, i, splat)) return;
    const bool exact = splat->form == SSFR_SPLAT_EXACT;
    ssfr_frame_eye(run->frame, i, f.centre);
    if (!(exact ? place_outline(run, splat, &f) : place_disc(run, splat, &f))) return;
    const ssfr_box box = ssfr_splat_box(run, f.lo, f.hi, y0, y1);
    for (frag.y = box.y0; frag.y < box.y1; frag.y++)
        for (frag.x = box.x0; frag.x < box.x1; frag.x++)
            if (exact ? hit_sphere(run, splat, &f, &frag) : hit_disc(run, splat, &f, &frag))
                ssfr_splat_emit(run, &frag, shade);
}

void ssfr_splat_each(const ssfr_run *run, ssfr_splat_draw *draw, ssfr_splat_shade *shade)
{
    enum { BAND = 32 }; /* rows; a band belongs to one thread, so each pixel sees the particles in order */
    const ssfr_facts *facts = &run->frame->facts;
#pragma omp parallel for schedule(dynamic)
    for (int y = 0; y < run->h; y += BAND)
        for (int k = 0; k < facts->n_ranges; k++)
            for (int i = facts->first[k]; i < facts->first[k] + facts->count[k]; i++)
                draw(run, (size_t)i, y, ssfr_min_int(y + BAND, run->h), shade);
}

void ssfr_splat_cpu(const ssfr_run *run, ssfr_splat_shade *shade)
{
    ssfr_splat_each(run, draw_particle, shade);
}

double ssfr_splat_seen(const ssfr_run *run, const ssfr_field *image, const double c[3])
{
    const double *px = run->frame->block.image, away = fmax(-c[2], run->frame->near);
    const double x = 0.5 * px[0] + c[0] / away / px[2], y = 0.5 * px[1] - c[1] / away / px[3];
    return *ssfr_field_fetch(image, (int)ssfr_clamp(x, 0, run->w), (int)ssfr_clamp(y, 0, run->h));
}

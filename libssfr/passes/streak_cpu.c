/* SPDX-License-Identifier: MIT */
/* streak_cpu.c: particles along their velocity into pixels, in double: the twin of shaders/streak.vert and
 * shaders/streak.glsl. */
#include "passes/environment.h"
#include "passes/streak.h"

#include <float.h>

typedef struct quad { /* of one particle, eye space */
    double centre[3];           /* m */
    double along[3], across[3]; /* unit vectors */
    double normal[3];
    double radius, half[2];     /* m; half axes along and across */
    double height;              /* m, of the eye over its plane, with the sign of the normal */
    double area;                /* in the image, in that of its square */
    double lo[2], hi[2];        /* px, box that holds it */
} quad;

/* Unit vector of the motion; false when the particle is slower than the threshold, or where to cannot be told. By its
 * largest component: squares of what a float holds may be more than it holds. */
static bool find_motion(const ssfr_run *run, const ssfr_streak *streak, size_t i, double motion[3])
{
    const float *v = ssfr_values_at(run->values[1], i);
    double largest = 0, scaled[3];
    for (int k = 0; k < 3; k++) {
        if (!(fabsf(v[k]) <= FLT_MAX)) return false;
        largest = fmax(largest, (double)fabsf(v[k]));
    }
    if (largest < 1e-30) return false; /* m/s, which a GPU may take for 0 */
    for (int k = 0; k < 3; k++) scaled[k] = (double)v[k] / largest;
    for (int k = 0; k < 3; k++) motion[k] = ssfr_dot(run->frame->rotation[k], scaled);
    return largest * ssfr_normalize(motion) >= streak->motion_threshold;
}

/* The quad's axes along the motion; false, and those of a square, when it is not turned. */
static bool turn(const ssfr_run *run, const ssfr_streak *streak, size_t i, quad *q)
{
    double motion[3], view[3] = {-q->centre[0], -q->centre[1], -q->centre[2]};
    memcpy(q->along, (const double[3]){1, 0, 0}, sizeof q->along);
    memcpy(q->across, (const double[3]){0, -1, 0}, sizeof q->across);
    if (!streak->turned || !find_motion(run, streak, i, motion)) return false;
    ssfr_normalize(view);
    if (fabs(ssfr_dot(motion, view)) > streak->facing) return false;
    if (streak->in_view) { /* the motion as seen from the eye on the plane z = c_z */
        for (int k = 0; k < 2; k++) q->along[k] = motion[2] * q->centre[k] - motion[k] * q->centre[2];
        ssfr_normalize(q->along);
        q->across[0] = q->along[1], q->across[1] = -q->along[0];
    } else {
        memcpy(q->along, motion, sizeof q->along);
        ssfr_cross(motion, view, q->across);
        ssfr_normalize(q->across);
    }
    return true;
}

/* Box around the corners; the whole image where one of them is not before the near plane. */
static void bound(const ssfr_run *run, quad *q)
{
    const ssfr_block *b = &run->frame->block;
    for (int k = 0; k < 2; k++) q->lo[k] = INFINITY, q->hi[k] = -INFINITY;
    for (int corner = 0; corner < 4; corner++) {
        const double s = corner & 1 ? q->half[0] : -q->half[0], t = corner & 2 ? q->half[1] : -q->half[1];
        double p[3];
        for (int k = 0; k < 3; k++) p[k] = q->centre[k] + s * q->along[k] + t * q->across[k];
        for (int k = 0; k < 2; k++) {
            const bool before = p[2] <= -run->frame->near;
            const double px = 0.5 * b->image[k] + (k ? -p[1] : p[0]) / -p[2] / b->image[2 + k];
            q->lo[k] = fmin(q->lo[k], before ? px - 1 : 0);
            q->hi[k] = fmax(q->hi[k], before ? px + 1 : b->image[k]);
        }
    }
}

/* A quad stands where its centre is: none without that before the near plane. */
static bool place(const ssfr_run *run, const ssfr_streak *streak, size_t i, quad *q)
{
    const double size = (double)*ssfr_values_at(run->values[0], i);
    ssfr_frame_eye(run->frame, i, q->centre);
    if (!(size > 0) || q->centre[2] > -run->frame->near) return false;
    const bool turned = turn(run, streak, i, q);
    q->radius = streak->radius * size;
    q->half[0] = turned ? streak->stretch * q->radius : q->radius;
    q->half[1] = q->radius;
    ssfr_cross(q->along, q->across, q->normal);
    q->height = ssfr_dot(q->normal, q->centre);
    q->area = q->half[0] / q->half[1] * fabs(q->height / q->centre[2]);
    bound(run, q);
    return true;
}

/* Where the pixel's ray meets the plane. Of planes along the ray nothing is met: comparisons with NaN fail. */
static bool meet(const ssfr_run *run, const quad *q, ssfr_fragment *f)
{
    double d[3] = {0, 0, -1}, p[3];
    ssfr_slope_at(&run->frame->block, f->x + 0.5, f->y + 0.5, d);
    const double t = q->height / ssfr_dot(q->normal, d);
    for (int k = 0; k < 3; k++) p[k] = t * d[k] - q->centre[k];
    f->a = ssfr_dot(p, q->along) / q->half[0], f->b = ssfr_dot(p, q->across) / q->half[1];
    f->r2 = f->a * f->a + f->b * f->b;
    if (!(t >= run->frame->near && f->r2 <= 1)) return false;
    const double root = ssfr_root_of(((const ssfr_streak *)run->coeffs)->root, run->tables, 1 - f->r2);
    const double rise = q->radius * root;
    f->front = -t + rise, f->back = -t - rise;
    f->chord = 2 * rise;
    f->area = q->area;
    return true;
}

static void draw_streak(const ssfr_run *run, size_t i, int y0, int y1, ssfr_splat_shade *shade)
{
    quad q;
    ssfr_fragment f = {.particle = i, .centre = q.centre};
    if (!place(run, run->coeffs, i, &q)) return;
    const ssfr_box box = ssfr_splat_box(run, q.lo, q.hi, y0, y1);
    for (f.y = box.y0; f.y < box.y1; f.y++)
        for (f.x = box.x0; f.x < box.x1; f.x++)
            if (meet(run, &q, &f)) ssfr_splat_emit(run, &f, shade);
}

void ssfr_streak_cpu(const ssfr_run *run, ssfr_splat_shade *shade)
{
    ssfr_splat_each(run, draw_streak, shade);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* boxes.c: the tree of boxes, built level by level from the leaves, walked without a stack. */
#include "experiments/truth/boxes.h"

#include <float.h>

/* Each of what a slab's distance is made of (a difference, an inverse and a product) is off by at most DBL_EPSILON / 2
 * of itself: twice as much for all three is wide enough. */
static const double slab_margin = 2 * 1.5 * DBL_EPSILON;

/* ---- building ---------------------------------------------------------------------------------------------------- */

/* A float below v, or above: by a step where v itself is one. */
static float below(double v)
{
    return nextafterf((float)v, -INFINITY);
}

static float above(double v)
{
    return nextafterf((float)v, INFINITY);
}

static void grow_box(ssfr_box *box, const ssfr_box *other)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = other->lo[k] < box->lo[k] ? other->lo[k] : box->lo[k];
        box->hi[k] = other->hi[k] > box->hi[k] ? other->hi[k] : box->hi[k];
    }
}

static ssfr_box box_of(const double centre[3], double reach)
{
    ssfr_box box;
    for (int k = 0; k < 3; k++) {
        /* Where centre and reach cancel the sum's step says nothing of how far they were rounded. */
        const double margin = reach + 2 * DBL_EPSILON * (fabs(centre[k]) + reach);
        box.lo[k] = below(centre[k] - margin);
        box.hi[k] = above(centre[k] + margin);
    }
    return box;
}

static void build_leaves(ssfr_boxes *boxes, const double (*centre)[3], const double *reach, double same)
{
#pragma omp parallel for schedule(static)
    for (size_t leaf = 0; leaf < boxes->count[0]; leaf++) {
        const size_t begin = leaf * SSFR_BOXES_LEAF;
        const size_t end = boxes->n < begin + SSFR_BOXES_LEAF ? boxes->n : begin + SSFR_BOXES_LEAF;
        ssfr_box box = box_of(centre[begin], reach ? reach[begin] : same);
        for (size_t i = begin + 1; i < end; i++) {
            const ssfr_box one = box_of(centre[i], reach ? reach[i] : same);
            grow_box(&box, &one);
        }
        boxes->boxes[leaf] = box;
    }
}

static void build_level(ssfr_boxes *boxes, int level)
{
    const ssfr_box *children = boxes->boxes + boxes->first[level - 1];
    ssfr_box *parents = boxes->boxes + boxes->first[level];
    const size_t n_children = boxes->count[level - 1];
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < boxes->count[level]; i++) {
        ssfr_box box = children[2 * i];
        if (2 * i + 1 < n_children) grow_box(&box, &children[2 * i + 1]);
        parents[i] = box;
    }
}

ssfr_result ssfr_boxes_init(ssfr_boxes *out, size_t n, const double (*centre)[3], const double *reach, double same)
{
    ssfr_result result = SSFR_OK;
    size_t total = 0;
    *out = (ssfr_boxes){.n = n};
    if (n > UINT32_MAX - SSFR_BOXES_LEAF)
        SSFR_TRY(ssfr_fail(SSFR_ERR_UNSUPPORTED, "%zu balls: a tree holds less than 2^32", n));
    for (size_t count = (n + SSFR_BOXES_LEAF - 1) / SSFR_BOXES_LEAF; count > 0; count = (count + 1) / 2) {
        out->first[out->n_levels] = total;
        out->count[out->n_levels++] = count;
        total += count;
        if (count == 1) break;
    }
    SSFR_TRY(ssfr_alloc(&out->boxes, total, sizeof *out->boxes, "boxes"));
    build_leaves(out, centre, reach, same);
    for (int level = 1; level < out->n_levels; level++) build_level(out, level);
end:
    if (result != SSFR_OK) ssfr_boxes_finish(out);
    return result;
}

void ssfr_boxes_finish(ssfr_boxes *boxes)
{
    free(boxes->boxes);
    *boxes = (ssfr_boxes){0};
}

size_t ssfr_boxes_bytes(const ssfr_boxes *boxes)
{
    const int top = boxes->n_levels - 1;
    return boxes->n_levels ? (boxes->first[top] + boxes->count[top]) * sizeof *boxes->boxes : 0;
}

/* ---- walking ----------------------------------------------------------------------------------------------------- */

/* A ray ready for slabs. `near` and `far` tell which of a box's six numbers the ray meets first and last on each axis,
 * from where it is measured to them, and how fast. */
typedef struct slabs {
    int near[3], far[3];
    double from_near[3], from_far[3], inverse[3];
    double from, to;
} slabs;

static slabs slabs_of(const ssfr_ray *ray, double from, double to)
{
    slabs s = {.from = from, .to = to};
    for (int k = 0; k < 3; k++) {
        /* Below that a component moves the ray by nothing in any scene, and its inverse stays finite: no slab's
         * distance is 0 times infinity. */
        const double least = 1e-30, dir = fabs(ray->dir[k]) > least ? ray->dir[k] : least;
        /* The origin is off by its rounding, and so are places along the ray that are computed from it. */
        const double margin = 4 * DBL_EPSILON * fabs(ray->origin[k]);
        const bool forwards = dir > 0;
        s.near[k] = forwards ? k : k + 3;
        s.far[k] = forwards ? k + 3 : k;
        s.from_near[k] = ray->origin[k] + (forwards ? margin : -margin);
        s.from_far[k] = ray->origin[k] - (forwards ? margin : -margin);
        s.inverse[k] = 1 / dir;
    }
    return s;
}

/* Where the ray enters and leaves the box's slabs; negative where it lies behind. */
static inline void meet(const slabs *s, const ssfr_box *box, double *enter, double *leave)
{
    const float *sides = (const float *)box; /* lo, hi: see below */
    double near[3], far[3];
    for (int k = 0; k < 3; k++) {
        near[k] = ((double)sides[s->near[k]] - s->from_near[k]) * s->inverse[k];
        far[k] = ((double)sides[s->far[k]] - s->from_far[k]) * s->inverse[k];
    }
    const double n = near[0] > near[1] ? near[0] : near[1], f = far[0] < far[1] ? far[0] : far[1];
    const double last = n > near[2] ? n : near[2], first = f < far[2] ? f : far[2];
    *enter = last - slab_margin * fabs(last);
    *leave = first + slab_margin * fabs(first);
}

_Static_assert(sizeof(ssfr_box) == 6 * sizeof(float), "a box is six floats in a row");

static inline bool meets(const slabs *s, const ssfr_box *box)
{
    double enter, leave;
    meet(s, box, &enter, &leave);
    return (enter > s->from ? enter : s->from) <= (leave < s->to ? leave : s->to);
}

void ssfr_boxes_along(const ssfr_boxes *boxes, const ssfr_ray *ray, double from, double to, ssfr_boxes_visit *visit,
                      void *user)
{
    const slabs s = slabs_of(ray, from, to);
    int level = boxes->n_levels - 1;
    size_t at = 0; /* of its level */
    while (level >= 0 && level < boxes->n_levels) {
        const bool met = meets(&s, &boxes->boxes[boxes->first[level] + at]);
        if (met && level > 0) {
            level--;
            at *= 2;
            continue;
        }
        if (met) {
            const size_t begin = at * SSFR_BOXES_LEAF, end = begin + SSFR_BOXES_LEAF;
            if (!visit(user, (uint32_t)begin, (uint32_t)(end < boxes->n ? end : boxes->n))) return;
        }
        /* To what comes next: the sibling on the right, or that of the lowest ancestor which has one. */
        while (level < boxes->n_levels && (at % 2 == 1 || at + 1 == boxes->count[level])) {
            at /= 2;
            level++;
        }
        at++;
    }
}

bool ssfr_boxes_clip(const ssfr_boxes *boxes, const ssfr_ray *ray, double *from, double *to)
{
    const slabs s = slabs_of(ray, *from, *to);
    double enter, leave;
    if (boxes->n_levels == 0) return false;
    meet(&s, &boxes->boxes[boxes->first[boxes->n_levels - 1]], &enter, &leave);
    enter = enter > *from ? enter : *from;
    leave = leave < *to ? leave : *to;
    if (!(enter <= leave)) return false;
    *from = enter;
    *to = leave;
    return true;
}

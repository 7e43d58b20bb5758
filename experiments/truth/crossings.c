/* SPDX-License-Identifier: GPL-3.0-or-later */
/* crossings.c: walks along a line in spans that bounds decide, and finds the root in each that has one. */
#include "experiments/truth/crossings.h"
#include "experiments/truth/span.h"

#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

/* In supports. The lengths change the cost, not the result. */
static const double step_length = 0.3;   /* of a first try */
static const double piece_length = 3;    /* of a line that is cast piece by piece; each further one is twice as long */
/* A ray that begins on the surface may for so long be on the wrong side of it, by its origin's rounding. */
static const double start_length = 1e-6;
enum { EVALUATIONS = 128 }; /* in one step; each time so many are through, shorter lengths are given up */

ssfr_result ssfr_crossings_init(ssfr_crossings *crossings)
{
    ssfr_result result = SSFR_OK;
    ssfr_span *span = NULL;
    *crossings = (ssfr_crossings){.touch = INFINITY};
    gsl_set_error_handler_off();
    SSFR_TRY(ssfr_alloc(&span, 1, sizeof *span, "root finding"));
    ssfr_span_init(span);
    crossings->work = span;
    crossings->solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    if (!crossings->solver) SSFR_TRY(ssfr_fail(SSFR_ERR_MEMORY, "no memory for GSL's root finder"));
end:
    if (result != SSFR_OK) ssfr_crossings_finish(crossings);
    return result;
}

void ssfr_crossings_finish(ssfr_crossings *crossings)
{
    if (crossings->solver) gsl_root_fsolver_free(crossings->solver);
    if (crossings->work) ssfr_span_finish(crossings->work);
    free(crossings->work);
    free(crossings->items);
    *crossings = (ssfr_crossings){0};
}

static void forget(ssfr_crossings *crossings)
{
    crossings->n = crossings->n_touches = crossings->evaluations = 0;
    crossings->begins_inside = false;
    crossings->touch = INFINITY;
    crossings->touched = 0;
}

static ssfr_result append(ssfr_crossings *crossings, ssfr_crossing **out)
{
    ssfr_result result = SSFR_OK;
    ssfr_crossing *items = NULL;
    if (crossings->n == crossings->capacity) {
        const size_t wanted = 2 * crossings->n + 16;
        SSFR_TRY(ssfr_alloc(&items, wanted, sizeof *items, "crossings"));
        if (crossings->n > 0) memcpy(items, crossings->items, crossings->n * sizeof *items);
        free(crossings->items);
        crossings->items = items;
        crossings->capacity = wanted;
    }
    *out = crossings->items + crossings->n++;
end:
    return result;
}

static void touch(ssfr_crossings *crossings, double at, double length)
{
    crossings->n_touches++;
    crossings->touch = fmin(crossings->touch, at);
    crossings->touched += length;
}

/* ---- the way along the line -------------------------------------------------------------------------------------- */

/* Up to `at` all is decided, but for a zone in front of it where rounding hides on which side of the surface it is. */
typedef struct walk {
    ssfr_crossings *out;
    ssfr_span *span;   /* not for spheres */
    const ssfr_line *line;
    double at;         /* m */
    int side;          /* 1: inside; -1: outside; 0: in a zone */
    int before;        /* the side before the zone; 0 at the very beginning */
    double zone;       /* m, where the zone begins */
    size_t wanted;     /* crossings after which the walk ends */
} walk;

static bool is_done(const walk *w)
{
    return w->out->n >= w->wanted;
}

/* Where nothing is known of the normal it is against the ray, or along it. */
static void guess_normal(ssfr_crossing *item, const ssfr_ray *ray)
{
    for (int c = 0; c < 3; c++) item->normal[c] = item->enters ? -ray->dir[c] : ray->dir[c];
    item->normal_err = M_PI;
}

/* Behind the crossing is `side`. */
static ssfr_result cross(walk *w, double t, double t_err, int side)
{
    ssfr_result result = SSFR_OK;
    ssfr_crossing *item = NULL;
    SSFR_TRY(append(w->out, &item));
    *item = (ssfr_crossing){.t = t, .t_err = t_err, .enters = side > 0};
    ssfr_span_normal(w->span, t, t_err, item->normal, &item->normal_err);
    if (!(ssfr_dot(item->normal, item->normal) > 0)) guess_normal(item, &w->line->ray);
end:
    return result;
}

/* From `at` on the side is known: ends the zone, if there is one. A zone between two sides holds a crossing; one with
 * the same side before it and behind is a touch. */
static ssfr_result settle(walk *w, int side, double at)
{
    ssfr_result result = SSFR_OK;
    const double begin = w->side == 0 ? w->zone : at;
    if (w->side == side) return SSFR_OK;
    const int before = w->side == 0 ? w->before : w->side;
    w->side = side;
    if (before == 0) w->out->begins_inside = side > 0;
    if (before == 0 || before == side) {
        if (at > begin) touch(w->out, begin, at - begin);
    } else
        SSFR_TRY(cross(w, begin + 0.5 * (at - begin), 0.5 * (at - begin) + w->line->digits, side));
end:
    return result;
}

static void lose_side(walk *w)
{
    if (w->side == 0) return;
    w->before = w->side;
    w->zone = w->at;
    w->side = 0;
}

/* ---- one root ---------------------------------------------------------------------------------------------------- */

static double field_at(double t, void *span)
{
    return ssfr_span_at(span, t).value;
}

/* How far from the root the field certainly has its two sides, as it has them at the ends a and b: that bounds the
 * root's error. */
static double verify(ssfr_span *span, double a, double b, double root, int side)
{
    const ssfr_span_value at = ssfr_span_at(span, root);
    const double least = 2 * DBL_EPSILON * fabs(root) + DBL_MIN;
    double off = (fabs(at.value) + 1.5 * at.err) / fabs(at.slope) + least;
    if (!(off < b - a)) off = b - a;
    for (;; off *= 2) {
        const double before = fmax(root - off, a), behind = fmin(root + off, b);
        if (before > a && ssfr_span_side_at(span, before) != -side) continue;
        if (behind < b && ssfr_span_side_at(span, behind) != side) continue;
        return fmax(root - before, behind - root);
    }
}

/* The one root between a and b, where the sides are certain, by Brent's method; then as near as doubles come. Behind it
 * is `side`. */
static ssfr_result find_root(walk *w, double a, double b, int side)
{
    enum { LIMIT = 200, POLISH = 2 };
    ssfr_result result = SSFR_OK;
    gsl_root_fsolver *solver = w->out->solver;
    gsl_function f = {.function = field_at, .params = w->span};
    if (gsl_root_fsolver_set(solver, &f, a, b) != GSL_SUCCESS)
        return cross(w, a + 0.5 * (b - a), 0.5 * (b - a), side); /* it is in there all the same */
    for (int i = 0; i < LIMIT; i++) {
        if (gsl_root_fsolver_iterate(solver) != GSL_SUCCESS) break;
        const double lo = gsl_root_fsolver_x_lower(solver), hi = gsl_root_fsolver_x_upper(solver);
        if (gsl_root_test_interval(lo, hi, SSFR_CROSSINGS_EPS * w->line->fluid->support, 0) == GSL_SUCCESS) break;
    }
    double root = gsl_root_fsolver_root(solver);
    for (int i = 0; i < POLISH; i++) {
        const ssfr_span_value at = ssfr_span_at(w->span, root);
        const double next = root - at.value / at.slope;
        if (next > a && next < b) root = next;
    }
    SSFR_TRY(cross(w, root, verify(w->span, a, b, root, side), side));
end:
    return result;
}

/* ---- a step ------------------------------------------------------------------------------------------------------ */

/* From where on the side of a monotone piece is known, when it is not at its beginning. */
static double end_of_doubt(const walk *w, const ssfr_span_bounds *bounds, double end, int side)
{
    const bool rises = bounds->slope_lo > 0;
    if (rises != (side > 0)) return w->at;
    const ssfr_span_value at = ssfr_span_at(w->span, w->at);
    const double least = rises ? bounds->slope_lo : -bounds->slope_hi;
    return fmin(end, w->at + (fabs(at.value) + at.err) / least);
}

/* The field is monotone up to `end`, and its side there is known. */
static ssfr_result pass_monotone(walk *w, const ssfr_span_bounds *bounds, double end, int side)
{
    ssfr_result result = SSFR_OK;
    if (w->side == 0) {
        const int here = ssfr_span_side_at(w->span, w->at);
        if (here == 0) return settle(w, side, end_of_doubt(w, bounds, end, side));
        SSFR_TRY(settle(w, here, w->at));
    }
    if (w->side == side) return SSFR_OK;
    SSFR_TRY(find_root(w, w->at, end, side));
    w->side = side;
end:
    return result;
}

/* Tries to decide all up to `end`; *decided says whether it could. `shortest`: lengths below that are given up. */
static ssfr_result try_piece(walk *w, double end, double shortest, bool *decided)
{
    ssfr_result result = SSFR_OK;
    int side = ssfr_span_side(w->span, w->at, end);
    *decided = true;
    if (side == 0) {
        const ssfr_span_bounds bounds = ssfr_span_bound(w->span, w->at, end);
        const bool flat = bounds.lo > -4 * bounds.err && bounds.hi < 4 * bounds.err; /* halving tells no more */
        side = bounds.lo > 0 ? 1 : bounds.hi < 0 ? -1 : 0;
        if (side == 0 && (bounds.slope_lo > 0 || bounds.slope_hi < 0)) {
            const int behind = ssfr_span_side_at(w->span, end);
            if (behind != 0) return pass_monotone(w, &bounds, end, behind);
        }
        if (side == 0) {
            *decided = flat || end - w->at <= shortest;
            if (*decided) lose_side(w);
            return SSFR_OK;
        }
    }
    SSFR_TRY(settle(w, side, w->at));
end:
    return result;
}

/* A step within which the kernels stay the same. */
static ssfr_result step(walk *w, double end)
{
    ssfr_result result = SSFR_OK;
    const size_t begun = w->span->evaluations;
    const double least = w->line->digits + 4 * DBL_EPSILON * end;
    double length = end - w->at;
    while (w->at < end && !is_done(w)) {
        const double shortest = ldexp(least, (int)((w->span->evaluations - begun) / EVALUATIONS));
        const double to = w->at + length < end ? w->at + length : end;
        bool decided;
        SSFR_TRY(try_piece(w, to, shortest, &decided));
        if (decided) {
            w->at = to;
            length *= 2;
        } else /* no half: the next end is to be another place, where the field is not 0 again */
            length = fmax(0.4 * (to - w->at), 0.5 * shortest);
    }
end:
    return result;
}

/* From `at` to `to`, m. */
static ssfr_result walk_span(walk *w, double to)
{
    ssfr_result result = SSFR_OK;
    const double length = fmax(step_length * w->line->fluid->support, w->line->digits); /* or t would stay as it is */
    ssfr_span_begin(w->span, w->line);
    while (w->at < to && !is_done(w)) {
        double end = fmin(to, w->at + length);
        SSFR_TRY(ssfr_span_move(w->span, w->at, end));
        if (w->span->n == 0) { /* nothing is here */
            end = fmin(to, fmax(end, ssfr_span_next(w->span) - w->line->margin));
            SSFR_TRY(settle(w, -1, w->at));
            w->at = end;
        } else
            SSFR_TRY(step(w, end));
    }
end:
    return result;
}

/* ---- spheres: the union of chords -------------------------------------------------------------------------------- */

/* Where the union of balls is entered or left: between lo and hi. */
typedef struct rim {
    const ssfr_line_kernel *ball; /* NULL: none yet */
    double t, lo, hi;             /* m */
    bool shared;                  /* with another ball, but for rounding: whose normal it is is not known */
} rim;

static rim rim_of(const ssfr_line_kernel *ball, double t, double err)
{
    return (rim){ball, t, t - err, t + err, false};
}

static ssfr_result cross_rim(walk *w, const rim *at, bool enters)
{
    ssfr_result result = SSFR_OK;
    ssfr_crossing *item = NULL;
    const double err = fmax(at->t - at->lo, at->hi - at->t), support = w->line->fluid->support;
    const double off = (err + w->line->digits) / support + 8 * DBL_EPSILON;
    SSFR_TRY(append(w->out, &item));
    *item = (ssfr_crossing){.t = at->t, .t_err = err, .enters = enters,
                            .normal_err = off < 1 && !at->shared ? asin(off) : M_PI};
    for (int c = 0; c < 3; c++) item->normal[c] = at->ball->aside[c] + (at->t - at->ball->middle) * w->line->ray.dir[c];
    ssfr_normalize(item->normal);
    w->side = enters ? 1 : -1;
end:
    return result;
}

/* A place where balls only touch each other or the ray, if it is on the way to `to`. */
static void touch_between(walk *w, double lo, double hi, double to)
{
    lo = fmax(lo, w->at), hi = fmin(hi, to);
    if (lo < hi) touch(w->out, lo, hi - lo);
}

/* Balls that hang together along the line, from where the first is entered to where the last is left. */
typedef struct chain {
    rim first, last;
} chain;

/* What lies of the chain between the walk's place and `to`. */
static ssfr_result pass_chain(walk *w, const chain *c, double to)
{
    ssfr_result result = SSFR_OK;
    const rim *rims[2] = {&c->first, &c->last};
    if (!c->first.ball) return SSFR_OK;
    for (int i = 0; w->side == 0 && i < 2; i++)
        if (rims[i]->lo <= w->at) touch_between(w, w->at, rims[i]->hi, to);
    if (w->side == 0) w->side = c->first.t <= w->at ? 1 : -1, w->out->begins_inside = w->side > 0;
    if (c->first.t < to && w->side < 0) SSFR_TRY(cross_rim(w, &c->first, true));
    if (c->last.t < to && w->side > 0) SSFR_TRY(cross_rim(w, &c->last, false));
    for (int i = 0; i < 2; i++)
        if (rims[i]->t >= to) touch_between(w, rims[i]->lo, rims[i]->hi, to);
end:
    return result;
}

/* The chain is entered where the first of its balls is, and left where the last of them is. A ball that may not be
 * there at all, as the ray grazes it, can only make it longer. */
static void extend(chain *c, const rim *enters, const rim *leaves, bool grazes)
{
    rim *first = &c->first, *last = &c->last;
    const rim before = *last;
    first->shared |= enters->lo <= first->hi;
    first->lo = fmin(first->lo, enters->lo);
    if (!grazes) first->hi = fmin(first->hi, enters->hi);
    if (!grazes && leaves->t > before.t) *last = *leaves;
    last->shared = (leaves->lo <= before.hi && leaves->hi >= before.lo) || (last->ball == before.ball && before.shared);
    last->lo = grazes ? before.lo : fmax(before.lo, leaves->lo);
    last->hi = fmax(before.hi, leaves->hi);
}

/* Takes the next ball into the chain; where it does not belong there the chain is passed and begins anew. */
static ssfr_result add_ball(walk *w, chain *c, const ssfr_line_kernel *k, double to)
{
    ssfr_result result = SSFR_OK;
    bool grazes;
    const double err = ssfr_line_rim_err(w->line, k, &grazes);
    const rim enters = rim_of(k, k->enters, err), leaves = rim_of(k, k->leaves, err);
    const bool apart = !c->last.ball || enters.lo > c->last.hi, within = c->last.ball && enters.hi < c->last.lo;
    if (grazes && !within) {
        touch_between(w, enters.lo, leaves.hi, to);
        return SSFR_OK;
    }
    if (apart) {
        SSFR_TRY(pass_chain(w, c, to));
        *c = (chain){enters, leaves};
        return SSFR_OK;
    }
    if (!within) touch_between(w, enters.lo, c->last.hi, to);
    extend(c, &enters, &leaves, grazes);
end:
    return result;
}

static ssfr_result walk_spheres(walk *w, double to)
{
    ssfr_result result = SSFR_OK;
    chain c = {0};
    for (size_t i = 0; i < w->line->n; i++) SSFR_TRY(add_ball(w, &c, w->line->kernels + i, to));
    SSFR_TRY(pass_chain(w, &c, to));
    if (w->side == 0) w->side = -1;
    w->at = to;
end:
    return result;
}

/* ---- what is asked ----------------------------------------------------------------------------------------------- */

static ssfr_result walk_on(walk *w, double to)
{
    if (w->line->hidden > 0) touch(w->out, w->line->hidden_at, w->line->hidden); /* from there on, somewhere */
    return w->line->fluid->kind == SSFR_CONTINUUM_SPHERES ? walk_spheres(w, to) : walk_span(w, to);
}

/* The last kernel's end, or `to` before that: behind it is nothing. */
static double end_of(const ssfr_line *line)
{
    double end = line->from;
    for (size_t i = 0; i < line->n; i++) end = fmax(end, line->kernels[i].leaves);
    return fmin(line->to, end + 2 * line->margin);
}

ssfr_result ssfr_crossings_find(ssfr_crossings *crossings, const ssfr_line *line)
{
    ssfr_result result = SSFR_OK;
    ssfr_span *span = crossings->work;
    walk w = {.out = crossings, .span = span, .line = line, .at = line->from, .zone = line->from, .wanted = SIZE_MAX};
    const size_t begun = span->evaluations;
    forget(crossings);
    SSFR_TRY(walk_on(&w, end_of(line)));
    if (w.side == 0 && w.at < line->to) SSFR_TRY(settle(&w, -1, w.at)); /* nothing is behind */
    if (w.side == 0 && w.at > w.zone) touch(crossings, w.zone, w.at - w.zone);
end:
    crossings->evaluations = span->evaluations - begun;
    return result;
}

/* Walks the very beginning. A ray that is through with it on another side than it was said to begin on has crossed the
 * surface there: *out is where. That it touches the surface that it begins on says nothing. */
static ssfr_result begin(walk *w, double to, bool inside, ssfr_crossing *out, bool *found)
{
    ssfr_result result = SSFR_OK;
    ssfr_crossings *crossings = w->out;
    const int said = inside ? 1 : -1;
    SSFR_TRY(walk_on(w, to));
    if (w->side == 0) w->before = said; /* still along the surface */
    *found = w->side == -said;
    if (*found && crossings->n > 0) {
        *out = crossings->items[crossings->n - 1];
    } else if (*found) { /* it never was on that side: no surface is there to be normal to */
        *out = (ssfr_crossing){.t = 0.5 * to, .t_err = 0.5 * to, .enters = !inside};
        guess_normal(out, &w->line->ray);
    }
    forget(crossings);
end:
    return result;
}

ssfr_result ssfr_crossings_first(ssfr_crossings *crossings, ssfr_line *line, const ssfr_ray *ray, double to,
                                 bool inside, ssfr_crossing *out, bool *found)
{
    ssfr_result result = SSFR_OK;
    ssfr_span *span = crossings->work;
    walk w = {.out = crossings, .span = span, .line = line, .wanted = SIZE_MAX};
    const size_t begun = span->evaluations;
    const double start = fmin(start_length * line->fluid->support, to);
    double length = piece_length * line->fluid->support, from = 0, end = to;
    *found = false;
    forget(crossings);
    SSFR_TRY(ssfr_line_cast(line, ray, 0, start));
    SSFR_TRY(begin(&w, start, inside, out, found));
    if (*found || !ssfr_boxes_clip(&line->fluid->boxes, ray, &from, &end)) goto end;
    w.wanted = 1;
    for (w.at = fmax(w.at, from); w.at < end && !*found; length *= 2) {
        const double next = fmin(w.at + length, end);
        SSFR_TRY(ssfr_line_cast(line, ray, w.at, next));
        SSFR_TRY(walk_on(&w, next));
        *found = crossings->n > 0;
    }
    if (*found) *out = crossings->items[0];
end:
    crossings->evaluations = span->evaluations - begun;
    return result;
}

ssfr_result ssfr_crossings_inside(ssfr_crossings *crossings, ssfr_line *line, const double at[3], bool *inside)
{
    ssfr_result result = SSFR_OK;
    ssfr_span *span = crossings->work;
    const ssfr_ray ray = {{at[0], at[1], at[2]}, {1, 0, 0}};
    *inside = false;
    SSFR_TRY(ssfr_line_cast(line, &ray, 0, start_length * line->fluid->support));
    if (line->fluid->kind == SSFR_CONTINUUM_SPHERES) {
        *inside = ssfr_line_density(line, 0) > 0;
    } else {
        ssfr_span_begin(span, line);
        SSFR_TRY(ssfr_span_move(span, 0, 0));
        *inside = ssfr_span_at(span, 0).value > 0;
    }
end:
    return result;
}

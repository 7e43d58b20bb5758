/* SPDX-License-Identifier: MIT */
/* light_view.c: fitting the light's square to fluid in view and to the solids before it, and rays along the light. */
#include "passes/light_view.h"

#include "passes/environment.h"

/* Along the light's axes, m from the eye. */
typedef struct box {
    double lo[3], hi[3];
} box;

/* ---- who casts --------------------------------------------------------------------------------------------------- */

static box solid_box(const ssfr_frame *frame, int i)
{
    const double(*solid)[4] = frame->block.solid[i];
    box b;
    for (int k = 0; k < 3; k++) {
        const double *axis = frame->light_axis[k], middle = ssfr_dot(axis, solid[0]);
        double half = 0;
        for (int j = 0; j < 3; j++) half += fabs(ssfr_dot(axis, solid[1 + j])) * solid[1 + j][3];
        b.lo[k] = middle - half, b.hi[k] = middle + half;
    }
    return b;
}

/* The part of a solid's box that is before the fluid. */
static bool covers(const ssfr_facts *facts, box *solid)
{
    for (int k = 0; k < 2; k++) {
        solid->lo[k] = fmax(solid->lo[k], facts->lit_lo[k]);
        solid->hi[k] = fmin(solid->hi[k], facts->lit_hi[k]);
    }
    return solid->lo[0] < solid->hi[0] && solid->lo[1] < solid->hi[1] && solid->hi[2] > facts->lit_lo[2];
}

/* A plane casts nothing on what is before it, but when the light is behind it: then on all. */
static void add_caster(ssfr_light_view *view, const ssfr_frame *frame, int i, box *all)
{
    const ssfr_solid *solid = &frame->solids[i];
    box b = solid_box(frame, i);
    if (solid->shape == SSFR_PLANE) {
        view->night |= ssfr_dot(solid->axis[1], view->to) < 0;
    } else if (covers(&frame->facts, &b)) {
        view->casters[i / 32] |= (int)(1u << i % 32);
        view->n_casters++;
        for (int k = 0; k < 3; k++) all->lo[k] = fmin(all->lo[k], b.lo[k]), all->hi[k] = fmax(all->hi[k], b.hi[k]);
    }
}

/* ---- the square -------------------------------------------------------------------------------------------------- */

/* The corner stands on a lattice of cells in the world, and a power of two of texels is a cell: texels stay where they
 * are while the view moves, as long as they are as large. The margin is a cell on both sides, and one for rounding. */
enum { CELLS = 64, MARGIN = 3 };

/* Up to a quarter of a power of two: sizes seldom change. */
static double round_up(double size)
{
    return exp2(ceil(4 * log2(fmax(size, 1e-9))) / 4);
}

static void fit(ssfr_light_view *view, const ssfr_frame *frame, const box *all)
{
    const double side = fmax(all->hi[0] - all->lo[0], all->hi[1] - all->lo[1]);
    view->extent = round_up(side * CELLS / (CELLS - MARGIN));
    const double cell = view->extent / CELLS;
    for (int k = 0; k < 2; k++) {
        const double eye = ssfr_dot(frame->light_axis[k], frame->scene->camera.eye);
        view->corner[k] = cell * floor((all->lo[k] + eye) / cell - 1) - eye;
    }
    view->top = all->hi[2] + cell; /* rays begin outside */
    view->range = round_up(view->top - frame->facts.lit_lo[2]);
}

ssfr_light_view ssfr_light_view_of(const ssfr_frame *frame)
{
    ssfr_light_view view = {.corner = {-2, -2}, .extent = 4, .range = 1}; /* m, without casters: any */
    box all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    memcpy(view.x, frame->light_axis[0], sizeof view.x);
    memcpy(view.y, frame->light_axis[1], sizeof view.y);
    memcpy(view.to, frame->light_axis[2], sizeof view.to);
    for (int i = 0; i < frame->n_solids; i++) add_caster(&view, frame, i, &all);
    if (view.n_casters) fit(&view, frame, &all);
    return view;
}

bool ssfr_light_view_has_casters(const ssfr_run *run)
{
    return run->frame->facts.fluid && ssfr_light_view_of(run->frame).n_casters > 0;
}

bool ssfr_light_view_has_shadow(const ssfr_run *run)
{
    const ssfr_light_view view = ssfr_light_view_of(run->frame);
    return run->frame->facts.fluid && (view.n_casters > 0 || view.night);
}

/* ---- rays -------------------------------------------------------------------------------------------------------- */

double ssfr_light_view_first(const ssfr_frame *frame, const ssfr_light_view *view, double x, double y)
{
    double origin[3], away[3], normal[3], t = SSFR_EMPTY;
    ssfr_solid_set casters;
    for (int k = 0; k < 3; k++) {
        origin[k] = x * view->x[k] + y * view->y[k] + view->top * view->to[k];
        away[k] = -view->to[k];
    }
    memcpy(casters, view->casters, sizeof casters);
    return ssfr_environment_meet(frame, casters, origin, away, &t, normal) >= 0 ? view->top - t : -SSFR_EMPTY;
}

/* SPDX-License-Identifier: MIT */
/* streak.c: parameters that all passes share which draw particles along their velocity, and their work. */
#include "passes/streak.h"

#include "graph/draw.h"

const char *const ssfr_streak_orientations[] = {"velocity", "screen", NULL};
const char *const ssfr_streak_planes[] = {"motion", "view", NULL};

void ssfr_streak_derive(const ssfr_run *run, void *coeffs)
{
    ssfr_streak *streak = coeffs;
    const ssfr_streak_params *p = run->params;
    *streak = (ssfr_streak){.radius = run->frame->radius * p->radius_scale, .motion_threshold = p->motion_threshold,
                            .facing = p->facing, .stretch = p->stretch,
                            .turned = p->orientation == SSFR_STREAK_VELOCITY,
                            .in_view = p->plane == SSFR_STREAK_IN_VIEW, .root = p->root};
}

bool ssfr_streak_defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    snprintf(text, SSFR_DEFINES, "%s", ssfr_root_define(((const ssfr_streak_params *)run->params)->root));
    return i == 0;
}

/* The front of a quad's middle is a radius before it, and of a quad that leans so is that of its end. */
double ssfr_streak_reach(const void *params)
{
    const ssfr_streak_params *p = params;
    return p->radius_scale * (p->orientation == SSFR_STREAK_VELOCITY ? hypot(p->stretch, 1) : 1);
}

bool ssfr_streak_needed(const ssfr_run *run)
{
    return run->frame->facts.n_particles > 0 && run->n_valued[0] > 0;
}

void ssfr_streak_work(const ssfr_run *run, ssfr_node_report *report)
{
    const double n = (double)run->frame->facts.n_particles;
    report->vertices = 4 * n;
    report->bytes += n * 3 * sizeof(float);
}

ssfr_result ssfr_streak_gl_nearest(const ssfr_run *run)
{
    return ssfr_draw_splats(run, run->draw->programs[0], SSFR_QUADS, SSFR_BLEND_NEAREST);
}

ssfr_result ssfr_streak_gl_add(const ssfr_run *run)
{
    return ssfr_draw_splats(run, run->draw->programs[0], SSFR_QUADS, SSFR_BLEND_ADD);
}

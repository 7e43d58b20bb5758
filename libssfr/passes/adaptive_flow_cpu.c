/* SPDX-License-Identifier: MIT */
/* adaptive_flow_cpu.c: Euler steps where the surface's distance asks for them, in double. */
#include "passes/adaptive_flow.h"

/* The share of step i that a surface at z takes: all or nothing by the paper's count, which is that of listing A.12;
 * the last in part by the exact one. */
static double share(const ssfr_adaptive_flow_coeffs *c, int i, double z, double dt)
{
    if (i >= c->flow.iterations) return 0;
    switch (c->constant) {
    case SSFR_ADAPTIVE_FLOW_PAPER: return i / c->flow.parts <= c->need / fabs(z) + 1;
    case SSFR_ADAPTIVE_FLOW_METRES: return ssfr_clamp(c->need / (fabs(z) * dt) - i, 0, 1);
    default: return 1;
    }
}

/* The pixel's depth after step i; *moved becomes true where it takes it. */
static double step(const ssfr_run *run, int i, const ssfr_field *from, int x, int y, bool *moved)
{
    const ssfr_adaptive_flow_coeffs *c = run->coeffs;
    const double z = *ssfr_field_fetch(from, x, y), judged = c->by_first ? *ssfr_field_fetch(run->in[0], x, y) : z;
    if (!ssfr_is_surface(z)) return z;
    const double part = share(c, i, judged, ssfr_curvature_flow_dt(run, z, x, y));
    if (!(part > 0)) return z;
    *moved = true;
    return z + part * ssfr_curvature_flow_rate(run, from, x, y, ssfr_curvature_flow_cuts(run, from, x, y));
}

int ssfr_adaptive_flow_steps(const ssfr_run *run, int x, int y)
{
    const ssfr_adaptive_flow_coeffs *c = run->coeffs;
    const double z = *ssfr_field_fetch(run->in[0], x, y), dt = ssfr_curvature_flow_dt(run, z, x, y);
    int n = 0;
    while (ssfr_is_surface(z) && n < c->flow.iterations && share(c, n, z, dt) > 0) n++;
    return n;
}

/* Where a tile's mark stands among the words: one more than the last step that changed something in it. */
static uint32_t *mark_of(const ssfr_run *run, int tile_x, int tile_y)
{
    const ssfr_adaptive_flow_coeffs *c = run->coeffs;
    return c->flow.live_tiles ? run->words + SSFR_COUNTS + tile_y * run->frame->facts.tiles_x + tile_x : NULL;
}

/* Takes step i in a tile; gives whether any pixel took it. The first two are taken everywhere, for both images. */
static bool step_tile(const ssfr_run *run, int i, const ssfr_field *from, ssfr_field *to, int tile_x, int tile_y)
{
    const int side = SSFR_TILE / run->divisor, x0 = tile_x * side, y0 = tile_y * side;
    const int x1 = ssfr_min_int(x0 + side, run->w), y1 = ssfr_min_int(y0 + side, run->h);
    uint32_t *mark = mark_of(run, tile_x, tile_y);
    bool moved = false;
    if (mark && i > 1 && *mark != (uint32_t)i) return false;
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) *ssfr_field_at(to, x, y) = step(run, i, from, x, y, &moved);
    if (mark && moved) *mark = (uint32_t)i + 1;
    return moved;
}

/* Gives the number of tiles in which step i changed something. */
static uint32_t sweep(const ssfr_run *run, int i, const ssfr_field *from, ssfr_field *to)
{
    const ssfr_facts *facts = &run->frame->facts;
    uint32_t n_moved = 0;
#pragma omp parallel for collapse(2) schedule(static) reduction(+ : n_moved)
    for (int y = 0; y < facts->tiles_y; y++)
        for (int x = 0; x < facts->tiles_x; x++) n_moved += step_tile(run, i, from, to, x, y);
    return n_moved;
}

void ssfr_adaptive_flow_cpu(const ssfr_run *run)
{
    const ssfr_adaptive_flow_coeffs *c = run->coeffs;
    const ssfr_field *from = run->in[0];
    bool over = false;
    *c->at = (ssfr_adaptive_flow_done){0};
    ssfr_curvature_flow_count(run);
    for (int i = 0; i < c->sweeps && !over; i++) {
        ssfr_field *to = (c->sweeps - i) % 2 == 1 ? run->out[0] : run->scratch[0];
        const uint32_t n_moved = sweep(run, i, from, to);
        if (c->flow.live_tiles && i + 1 < c->sweeps) run->words[SSFR_CURVATURE_FLOW_N_LIVE] += n_moved;
        over = ssfr_adaptive_flow_asks(c, i) && n_moved == 0;
        from = to;
        c->at->sweeps++;
    }
    if (from != run->out[0])
        memcpy(run->out[0]->data, from->data, (size_t)from->w * (size_t)from->h * sizeof *from->data);
}

/* SPDX-License-Identifier: MIT */
/* adaptive_flow_cpu.c: Euler steps where the surface's distance asks for them, in double. */
#include "passes/adaptive_flow.h"

/* The share of step i that a surface at z takes: all or nothing by the paper's count, which is that of listing A.12;
 * the last in part by the exact one. */
static double share(const ssfr_adaptive_flow_coeffs *c, int i, double z, double dt)
{
    if (i >= c->flow.iterations) return 0;
    switch (c->constant) {
    case SSFR_ADAPTIVE_FLOW_PAPER: return i <= c->need / fabs(z) + 1;
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

static bool sweep(const ssfr_run *run, int i, const ssfr_field *from, ssfr_field *to)
{
    bool moved = false;
#pragma omp parallel for schedule(static) reduction(|| : moved)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) *ssfr_field_at(to, x, y) = step(run, i, from, x, y, &moved);
    return moved;
}

void ssfr_adaptive_flow_cpu(const ssfr_run *run)
{
    const ssfr_adaptive_flow_coeffs *c = run->coeffs;
    const ssfr_field *from = run->in[0];
    bool over = false;
    *c->at = (ssfr_adaptive_flow_done){0};
    for (int i = 0; i < c->sweeps && !over; i++) {
        ssfr_field *to = (c->sweeps - i) % 2 == 1 ? run->out[0] : run->scratch[0];
        const bool moved = sweep(run, i, from, to);
        over = ssfr_adaptive_flow_asks(c, i) && !moved;
        from = to;
        c->at->sweeps++;
    }
    if (from != run->out[0])
        memcpy(run->out[0]->data, from->data, (size_t)from->w * (size_t)from->h * sizeof *from->data);
}

/* SPDX-License-Identifier: MIT */
/* shadow_map_cpu.c: one ray a texel along the light, in double. */
#include "passes/shadow_map.h"

void ssfr_shadow_map_cpu(const ssfr_run *run)
{
    const ssfr_shadow_map_coeffs *c = run->coeffs;
    const ssfr_light_view *view = &c->view;
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++)
            *ssfr_field_at(run->out[0], x, y) =
                ssfr_light_view_first(run->frame, view, view->corner[0] + (x + 0.5) * c->texel,
                                      view->corner[1] + (y + 0.5) * c->texel);
}

/* SPDX-License-Identifier: MIT */
/* background_cpu.c: one ray a pixel into floor, solids and sky, in double. */
#include "passes/background.h"
#include "passes/environment.h"

void ssfr_background_cpu(const ssfr_run *run)
{
    static const double eye[3] = {0, 0, 0};
    const ssfr_frame *frame = run->frame;
    const ssfr_block *block = &frame->block;
#pragma omp parallel for schedule(static)
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) {
            double ray[3] = {0, 0, -1}, dir[3];
            ssfr_slope_at(block, x + 0.5, y + 0.5, ray);
            ssfr_world_from_eye(block, ray, dir);
            const uint32_t *solids = frame->facts.solids[y / SSFR_TILE * frame->facts.tiles_x + x / SSFR_TILE];
            *ssfr_field_at(run->out[1], x, y) =
                -ssfr_environment_trace(frame, solids, eye, dir, ssfr_field_at(run->out[0], x, y));
        }
}

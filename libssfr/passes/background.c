/* SPDX-License-Identifier: MIT */
/* background.c: the scene without the fluid: floor, solids, sky. */
#include "passes/background.h"

#include "graph/draw.h"
#include "passes/environment.h"

/* Program k is for tiles of kind k. */
static bool defines(const ssfr_run *run, int k, char text[SSFR_DEFINES])
{
    ssfr_environment_defines(run->frame, k > SSFR_TILE_PLAIN, k == SSFR_TILE_MESHES, text);
    return run->frame->facts.n_by_solids[k] > 0;
}

static ssfr_result draw(const ssfr_run *run)
{
    ssfr_result result = SSFR_OK;
    const ssfr_draw *d = run->draw;
    const int *n = run->frame->facts.n_by_solids;
    if (run->frame->n_solids == 0) return ssfr_draw_screen(run, d->programs[0], d->n_out, d->out);
    for (int k = 0, first = 0; k < SSFR_N_TILE_KINDS; first += n[k++])
        SSFR_TRY(ssfr_draw_by_solids(run, d->programs[k], first, n[k]));
end:
    return result;
}

const ssfr_pass ssfr_background = {
    .name = "background",
    .source = "Bagar 2010, sec. 4.4 (the main scene's colour and depth; the scene itself is ours)",
    .help = "the scene behind the fluid: chequered floor, solids and a sky, or images of your own",
    .outputs = {{"color", SSFR_SLOT_scene_color}, {"depth", SSFR_SLOT_scene_depth}},
    .whole_screen = true,
    .cpu_run = ssfr_background_cpu,
    .programs = {{"tiles.vert", "background.frag", NULL}, {"tiles.vert", "background.frag", NULL},
                 {"tiles.vert", "background.frag", NULL}},
    .defines = defines,
    .gl_run = draw,
    .tolerance = {.abs = 2e-4, .rel = 2e-4, .outliers = 0.002},
};

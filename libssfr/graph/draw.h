/* SPDX-License-Identifier: MIT */
/* draw.h: what GPU twins call. Before gl_run the graph has set the baseline state, bound input k to texture unit k as
 * t_<port>, the coefficients to their uniforms, the frame's block, and cleared outputs that are not written whole. */
#ifndef SSFR_DRAW_H
#define SSFR_DRAW_H

#include "gl/gl.h"
#include "graph/pass.h"

/* Storage buffer bindings; shaders/particles.glsl, splat.vert, streak.vert, surface_noise.frag, tiles.vert,
 * environment.glsl and curvature_flow.glsl repeat them. */
enum {
    SSFR_BIND_POSITION, SSFR_BIND_OFFSET, SSFR_BIND_TILES, SSFR_BIND_ID, SSFR_BIND_SOLID_TILES, SSFR_BIND_NODES,
    SSFR_BIND_TRIANGLES,
    /* Of passes that draw particles, which trace nothing: the values that a pass reads, in the order of its ports. GL
     * promises 8 bindings in all. */
    SSFR_BIND_VALUES = SSFR_BIND_SOLID_TILES,
    SSFR_BIND_WORDS = 7, /* lent to a run */
};
enum { SSFR_UNIT_TABLES = SSFR_MAX_PORTS, SSFR_UNIT_ENVIRONMENT = 15 }; /* beyond the units of a pass's inputs */
_Static_assert(SSFR_UNIT_TABLES + SSFR_MAX_TABLES <= SSFR_UNIT_ENVIRONMENT, "a unit for each table");

typedef struct ssfr_draw {
    ssfr_gl *gl;
    const ssfr_texture *in[SSFR_MAX_PORTS];
    const ssfr_texture *out[SSFR_MAX_OUTPUTS];
    const ssfr_texture *scratch[SSFR_MAX_SCRATCH];
    int n_out;
    const unsigned *programs;
    bool whole_screen;    /* all pixels, not only tiles with fluid */
    int stride, first;    /* of the position buffer, in floats */
    unsigned tiles_by_solids; /* buffer: facts.by_solids */
    unsigned quads;       /* index buffer: two triangles for each of SSFR_QUAD_BATCH quads */
    unsigned copy;        /* program */
    unsigned sampler;     /* for images of the host */
} ssfr_draw;

/* Runs a program over the pixels of the targets that may hold fluid, or all of them for a whole-screen pass. */
SSFR_MUST ssfr_result ssfr_draw_screen(const ssfr_run *run, unsigned program, int n,
                                       const ssfr_texture *const *targets);

/* Runs a program over the tiles of facts.by_solids from `first` on. */
SSFR_MUST ssfr_result ssfr_draw_by_solids(const ssfr_run *run, unsigned program, int first, int count);

enum { SSFR_QUAD_BATCH = 16384 }; /* quads a draw: their vertices are numbered in 16 bits */

typedef enum ssfr_splat_primitive { SSFR_POINTS, SSFR_QUADS } ssfr_splat_primitive;
typedef enum ssfr_splat_blend { SSFR_BLEND_NEAREST, SSFR_BLEND_ADD } ssfr_splat_blend;

/* Draws the visible particles into the outputs; the vertex shader fetches particle gl_VertexID (points) or
 * gl_VertexID / 4. */
SSFR_MUST ssfr_result ssfr_draw_splats(const ssfr_run *run, unsigned program, ssfr_splat_primitive primitive,
                                       ssfr_splat_blend blend);

/* Copies one image onto another of the same size; an image of one pixel fills the other. */
SSFR_MUST ssfr_result ssfr_draw_copy(const ssfr_draw *draw, const ssfr_texture *from, const ssfr_texture *to);

/* Binds another texture in place of input k. */
void ssfr_draw_bind(const ssfr_draw *draw, int k, const ssfr_texture *texture);

#endif

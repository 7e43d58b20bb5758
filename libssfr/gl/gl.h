/* SPDX-License-Identifier: MIT */
/* gl.h: the little of OpenGL 4.5 that the graph needs. Include epoxy yourself where you call gl*.
 *
 * Between ssfr_gl_begin and ssfr_gl_end the context is current and in the baseline state:
 * no blending, depth test, cull, scissor, stencil, sRGB or dither; all colour channels written; clip control
 * GL_UPPER_LEFT with GL_NEGATIVE_ONE_TO_ONE (row 0 of every image is its top row, gl_FragCoord.y grows downwards);
 * GL_PROGRAM_POINT_SIZE on, GL_POINT_SPRITE_COORD_ORIGIN upper left; pack and unpack alignment 4, no row length or
 * skip; the empty vertex array of ssfr bound (shaders pull their vertices from buffers); no sampler objects on ssfr's
 * units. */
#ifndef SSFR_GL_H
#define SSFR_GL_H

#include "base/base.h"
#include "base/half.h"
#include "base/lookup.h"

enum { SSFR_GL_UNITS = 16, SSFR_GL_STORAGE = 8, SSFR_GL_UNIFORMS = 2 };

typedef struct ssfr_texture {
    unsigned name;
    int w, h, c;   /* px, px, channels that mean something (3 are stored as 4) */
    ssfr_storage storage;
    bool borrowed; /* the host's: never deleted */
} ssfr_texture;

typedef struct ssfr_gl_limits {
    int texture_px;  /* largest side of a 2D texture */
    double point_px; /* largest point sprite */
} ssfr_gl_limits;

const ssfr_gl_limits *ssfr_gl_get_limits(const ssfr_gl *gl);
bool ssfr_gl_is_host(const ssfr_gl *gl); /* the host's context, whose objects ssfr can use */

/* Makes the context current; a host's state is saved. Calls do not nest. */
SSFR_MUST ssfr_result ssfr_gl_begin(ssfr_gl *gl);
/* Puts a host's state back. Gives SSFR_ERR_GL when the debug output or glGetError reported an error since begin (logged
 * once, with the driver's text and the innermost group's name); else so_far. */
SSFR_MUST ssfr_result ssfr_gl_end(ssfr_gl *gl, ssfr_result so_far);
/* Sets the baseline state again; called before each pass, so that no pass leaks state into the next. */
void ssfr_gl_baseline(ssfr_gl *gl);

/* A debug group named after the pass, for traces and error texts. The name lives until the pop. */
void ssfr_gl_push(ssfr_gl *gl, const char *name);
void ssfr_gl_pop(ssfr_gl *gl);

/* 2D textures of floats: R, RG, RGBA by channels; nearest, clamped to the edge, one level. */
SSFR_MUST ssfr_result ssfr_texture_create(ssfr_gl *gl, ssfr_texture *out, int w, int h, int c, ssfr_storage storage);
void ssfr_texture_finish(ssfr_texture *texture);
void ssfr_texture_clear(const ssfr_texture *texture, const float value[4]);
SSFR_MUST ssfr_result ssfr_texture_write(const ssfr_texture *texture, const ssfr_field *field);
SSFR_MUST ssfr_result ssfr_texture_read(const ssfr_texture *texture, ssfr_field **out);

/* A constant table as a texture of two or three dimensions, read with linear interpolation. */
SSFR_MUST ssfr_result ssfr_lookup_upload(ssfr_gl *gl, unsigned *out, const ssfr_texels *texels);
void ssfr_lookup_destroy(unsigned *texture);

/* Binds up to 4 textures as colour attachments of ssfr's framebuffer and sets the viewport to their size. */
SSFR_MUST ssfr_result ssfr_gl_target(ssfr_gl *gl, int n, const ssfr_texture *const *textures);

/* An immutable-size buffer; data may be NULL. dynamic: written again by glNamedBufferSubData. */
SSFR_MUST ssfr_result ssfr_buffer_create(ssfr_gl *gl, unsigned *out, size_t size, const void *data, bool dynamic);
void ssfr_buffer_destroy(unsigned *buffer);

/* Compiles shaders/<vert> and shaders/<frag>, from the folder that SSFR_SHADER_DIR names where it has the file, else
 * from the binary. A line `#include "name.glsl"` is replaced by that file, once a program stage; an error names the
 * file and its line. defines: lines put after #version, or NULL. Results are cached in gl by (vert, frag, defines);
 * ssfr_gl_destroy frees them. */
SSFR_MUST ssfr_result ssfr_program_get(ssfr_gl *gl, unsigned *out, const char *vert, const char *frag,
                                       const char *defines);

/* Images, buffers and programs made since the context was created: a frame that allocates nothing adds none. */
long ssfr_gl_allocations(const ssfr_gl *gl);

/* Whether anything was drawn between begin and end, which waits for the GPU. They do not nest. */
void ssfr_gl_watch_begin(ssfr_gl *gl);
bool ssfr_gl_watch_end(ssfr_gl *gl);

/* GPU timestamps: n pairs. Reading waits for the GPU. */
typedef struct ssfr_timers {
    int n;
    unsigned *queries; /* 2 n */
} ssfr_timers;

SSFR_MUST ssfr_result ssfr_timers_create(ssfr_timers *timers, int n);
void ssfr_timers_finish(ssfr_timers *timers);
void ssfr_timers_start(ssfr_timers *timers, int i);
void ssfr_timers_stop(ssfr_timers *timers, int i);
double ssfr_timers_ms(const ssfr_timers *timers, int i);

#endif

/* SPDX-License-Identifier: MIT */
/* splat.h: how a particle becomes pixels, shared by all passes that draw particles. The twin of shaders/splat.glsl.
 *
 * point, quad  the particle's orthographic disc, scaled by its distance: a sphere's outline and depth to first order.
 *              Points are what GPUs draw fastest, and are limited: their size is capped, and a point whose centre
 *              leaves the image vanishes whole. Quads have neither limit.
 * exact        the sphere's perspective outline, and its depth along the pixel's own ray. */
#ifndef SSFR_SPLAT_H
#define SSFR_SPLAT_H

#include "graph/pass.h"
#include "passes/root.h"

enum { SSFR_SPLAT_POINT, SSFR_SPLAT_QUAD, SSFR_SPLAT_EXACT };
enum { SSFR_SIZE_DEPTH, SSFR_SIZE_DISTANCE };

typedef struct ssfr_splat_params { /* the first member of the params of a pass that splats */
    int form, size, root;
    double radius_scale, max_point_px;
} ssfr_splat_params;

typedef struct ssfr_splat { /* the first member of its coefficients */
    double radius;       /* m */
    double max_point_px;
    int form, by_distance, root;
    int spares_foam;     /* particles that are foam at all are not drawn; the second port of values is then foam */
} ssfr_splat;

extern const char *const ssfr_splat_forms[], *const ssfr_splat_sizes[];

#define SSFR_SPLAT_ROW(name, member, type, unit, def, min, max, words, help) \
    {name, type, unit, help, offsetof(ssfr_splat_params, member), def, min, max, words}
#define SSFR_SPLAT_ROWS                                                                                    \
    SSFR_SPLAT_ROW("splat", form, SSFR_CHOICE, "1", SSFR_SPLAT_POINT, 0, 0, ssfr_splat_forms,              \
                   "point sprite, quad, or the sphere's exact perspective outline and depth"),             \
    SSFR_SPLAT_ROW("size", size, SSFR_CHOICE, "1", SSFR_SIZE_DEPTH, 0, 0, ssfr_splat_sizes,                \
                   "what shrinks points and quads: depth along the view axis, or distance (Bagar's A.8)"), \
    SSFR_SPLAT_ROW("root", root, SSFR_CHOICE, "1", SSFR_ROOT_EXACT, 0, 0, ssfr_roots,                      \
                   "height of points and quads, sqrt(1 - r^2): computed, or looked up in 128 texels; that of "     \
                   "exact splats is computed"),                                                            \
    SSFR_SPLAT_ROW("radius_scale", radius_scale, SSFR_REAL, "1", 1, 0.01, 100, NULL,                       \
                   "splat radius in particle radii"),                                                      \
    SSFR_SPLAT_ROW("max_point_px", max_point_px, SSFR_REAL, "px", 255, 1, 2048, NULL, "largest point sprite")

#define SSFR_SPLAT_UNIFORMS                                          \
    {"u_radius", offsetof(ssfr_splat, radius), 1},                   \
    {"u_max_point_px", offsetof(ssfr_splat, max_point_px), 1},       \
    {"u_by_distance", offsetof(ssfr_splat, by_distance), 0}

/* The port of a pass that draws particles each at its own size: the first that carries values. */
#define SSFR_SPLAT_SIZE_PORT {"size", SSFR_SLOT_water_size, .widens = true}
/* `defines` of a pass that splats, whose programs have no further ones: no sizes are read where there are none, no ramp
 * where roots are computed. */
bool ssfr_splat_defines(const ssfr_run *run, int i, char text[SSFR_DEFINES]);
/* The same with these lines more. */
bool ssfr_splat_define(const ssfr_run *run, int i, const char *more, char text[SSFR_DEFINES]);
#define SSFR_SPLAT_TABLES {SSFR_ROOT_TABLES(ssfr_splat_params, root)}

/* The three programs of a pass that splats: its fragment shader under each form; more: further defines. */
#define SSFR_SPLAT_PROGRAMS(frag, more)                                                                               \
    {                                                                                                                 \
        {"splat.vert", frag, "#define POINT\n" more}, {"splat.vert", frag, "#define QUAD\n" more},                   \
            {"splat.vert", frag, "#define EXACT\n" more},                                                             \
    }

void ssfr_splat_derive(const ssfr_run *run, void *coeffs);
double ssfr_splat_reach(const void *params);
bool ssfr_splat_needed(const ssfr_run *run);
#define SSFR_SPLAT_NEEDLESS "no particle to draw in view"
void ssfr_splat_work(const ssfr_run *run, ssfr_node_report *report);

/* gl_run of passes that keep the nearest fragment, and of those that add all up. */
ssfr_result ssfr_splat_gl_nearest(const ssfr_run *run);
ssfr_result ssfr_splat_gl_add(const ssfr_run *run);

typedef struct ssfr_fragment { /* where a pixel's ray meets a particle's sphere */
    size_t particle;
    const double *centre; /* m, eye space */
    int x, y;
    double a, b;   /* place on the sprite, right and down, in radii */
    double r2;     /* a^2 + b^2, <= 1 */
    double front;  /* m, eye-space z of the nearest point, not behind the near plane */
    double back;   /* m, of the farthest */
    double chord;  /* m, length of the ray inside the sphere, from the near plane on */
    double area;   /* in the image, of a streak (streak.h) in that of its disc; 1 for spheres */
} ssfr_fragment;

/* Calls shade for every pixel of every particle in view, in the particles' order at each pixel. */
typedef void ssfr_splat_shade(const ssfr_run *run, const ssfr_fragment *fragment, double *pixel);
void ssfr_splat_cpu(const ssfr_run *run, ssfr_splat_shade *shade);

/* Keeps the nearest front before the scene, which is the first input. */
ssfr_splat_shade ssfr_splat_keep_nearest;

/* What that is made of. draw: particle i into rows y0 to y1 - 1. */
typedef void ssfr_splat_draw(const ssfr_run *run, size_t i, int y0, int y1, ssfr_splat_shade *shade);
void ssfr_splat_each(const ssfr_run *run, ssfr_splat_draw *draw, ssfr_splat_shade *shade);

typedef struct ssfr_box { /* px; without x1 and y1 */
    int x0, x1, y0, y1;
} ssfr_box;
/* The image's pixels in rows y0 to y1 - 1 between lo and hi (px). */
ssfr_box ssfr_splat_box(const ssfr_run *run, const double lo[2], const double hi[2], int y0, int y1);
/* An image where a centre (m, eye space) is seen, or at its nearest pixel; a centre before the near plane is seen as if
 * in it. */
double ssfr_splat_seen(const ssfr_run *run, const ssfr_field *image, const double centre[3]);
/* Shades a fragment with what of it is before the near plane. */
void ssfr_splat_emit(const ssfr_run *run, ssfr_fragment *f, ssfr_splat_shade *shade);

#endif

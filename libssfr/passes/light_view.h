/* SPDX-License-Identifier: MIT */
/* light_view.h: what the light sees: a square across it over the fluid in view and the solids that can cast a shadow on
 * that, for the passes that make shadows. The twin of shaders/light_view.glsl. */
#ifndef SSFR_LIGHT_VIEW_H
#define SSFR_LIGHT_VIEW_H

#include "graph/pass.h"

typedef struct ssfr_light_view {
    double x[3], y[3], to[3]; /* unit, world: along rows and columns of the light's images, and towards the light */
    double corner[2];  /* m, from the eye along x and y: of the first texel */
    double extent;     /* m, the square's side */
    double top, range; /* m, from the eye along `to`: over all casters; below it all fluid is within the range */
    int casters[SSFR_SOLID_WORDS]; /* ssfr_solid_set, as uniforms have it */
    int n_casters;
    int night;         /* a plane has the light behind it: all is in its shadow */
} ssfr_light_view;

#define SSFR_LIGHT_VIEW_UNIFORMS(type)                        \
    {"u_light_x", offsetof(type, view.x), 3},                 \
    {"u_light_y", offsetof(type, view.y), 3},                 \
    {"u_corner", offsetof(type, view.corner), 2},             \
    {"u_extent", offsetof(type, view.extent), 1},             \
    {"u_top", offsetof(type, view.top), 1},                   \
    {"u_range", offsetof(type, view.range), 1},               \
    {"u_casters_0", offsetof(type, view.casters[0]), 0},      \
    {"u_casters_1", offsetof(type, view.casters[1]), 0}

ssfr_light_view ssfr_light_view_of(const ssfr_frame *frame);

/* `needed` of the passes that make maps of the casters, and of the one that reads them. */
bool ssfr_light_view_has_casters(const ssfr_run *run);
bool ssfr_light_view_has_shadow(const ssfr_run *run);
#define SSFR_NO_CASTER "no fluid in view, or no solid between it and the light"

/* The first caster that the light meets at (x, y), m from the eye along the view's axes: how far towards the light from
 * the eye, m; -SSFR_EMPTY for none. */
double ssfr_light_view_first(const ssfr_frame *frame, const ssfr_light_view *view, double x, double y);

#endif

/* SPDX-License-Identifier: MIT */
/* optics.h: what a surface of water does to light, for all passes that shade one; the twin of shaders/optics.glsl.
 * The parameters and coefficients of such a pass begin with ssfr_optics, its inputs are in the order of the enum. */
#ifndef SSFR_OPTICS_H
#define SSFR_OPTICS_H

#include "graph/pass.h"

enum { SSFR_OPTICS_SCENE_COLOR, SSFR_OPTICS_SCENE_DEPTH, SSFR_OPTICS_DEPTH, SSFR_OPTICS_NORMAL, SSFR_OPTICS_INPUTS };

typedef struct ssfr_optics {
    double gamma;       /* shift of the background, image heights a metre of thickness */
    double attenuation; /* 1/m, where one coefficient serves all colours */
    double specular, shininess;
    int reject;         /* do not refract what stands before the water */
    int reflection;     /* 0: sky, 1: scene */
    int single;         /* one coefficient, else medium.absorption */
} ssfr_optics;

extern const char *const ssfr_optics_reflections[], *const ssfr_optics_attenuations[];

#define SSFR_OPTICS_SHIFT_ROW \
    SSFR_PARAM_REAL(ssfr_optics, gamma, "1/m", 0.1, 0, 1e3, "shift in image heights a metre of thickness")
#define SSFR_OPTICS_SCENE_ROWS                                                                         \
    SSFR_PARAM_FLAG(ssfr_optics, reject, 1, "do not refract what stands before the water"),            \
    SSFR_PARAM_CHOICE(ssfr_optics, reflection, ssfr_optics_reflections, 0,                             \
                      "reflect the sky alone, as an environment map does, or floor and solids too")
#define SSFR_OPTICS_WATER_ROWS                                                                         \
    {"attenuation", SSFR_CHOICE, "1",                                                                  \
     "Beer-Lambert by colour with medium.absorption, or e^(-k T) with one k (eq. 2.18)",               \
     offsetof(ssfr_optics, single), 0, 0, 0, ssfr_optics_attenuations},                                \
    {"k", SSFR_REAL, "1/m", "the single attenuation coefficient", offsetof(ssfr_optics, attenuation), 1, 0, 1e6, NULL}
#define SSFR_OPTICS_HIGHLIGHT_ROWS                                                                     \
    SSFR_PARAM_REAL(ssfr_optics, specular, "1", 0.6, 0, 100, "k_s of the highlight"),                  \
    SSFR_PARAM_REAL(ssfr_optics, shininess, "1", 250, 1, 1e5, "alpha of the highlight")

#define SSFR_OPTICS_UNIFORMS                                   \
    {"u_attenuation", offsetof(ssfr_optics, attenuation), 1},  \
    {"u_specular", offsetof(ssfr_optics, specular), 1},        \
    {"u_shininess", offsetof(ssfr_optics, shininess), 1},      \
    {"u_reject", offsetof(ssfr_optics, reject), 0},            \
    {"u_reflection", offsetof(ssfr_optics, reflection), 0},    \
    {"u_single", offsetof(ssfr_optics, single), 0}

/* The lines before shaders/optics.glsl: no solids where none is reflected. */
bool ssfr_optics_defines(const ssfr_run *run, int i, char text[SSFR_DEFINES]);

/* m, more than any water: thicker is as thick, for sums of halves may be infinite. The same number bounds
 * T_ff / delta_foam where that is not held to 1. Its products are finite in float, so that nothing is 0 times
 * infinity. */
#define SSFR_THICKEST 1e6

/* A pixel's value, from 0 to the most; what is not a number is 0. */
double ssfr_optics_value(const ssfr_field *field, int x, int y, double most);

typedef struct ssfr_surface { /* of the water at one pixel */
    const ssfr_run *run;
    const ssfr_optics *optics;
    const ssfr_block *block;
    int x, y;
    double z, n[3];     /* m, eye space; without water z is empty, and the rest has no meaning */
    double position[3]; /* m, eye space */
    double view[3];     /* unit, towards the eye */
    double cosine;      /* between normal and view, [0, 1] */
} ssfr_surface;

/* That of the inputs. */
ssfr_surface ssfr_surface_at(const ssfr_run *run, int x, int y);
/* One at a position of its own (m, eye space) with a unit normal. */
ssfr_surface ssfr_surface_make(const ssfr_run *run, int x, int y, const double position[3], const double n[3]);

/* The scene d pixels aside, or straight behind where what stands there is rejected. */
void ssfr_surface_refracted(const ssfr_surface *s, const double d[2], double out[3]);

/* The share of the light behind a thickness of water (m) that comes through, by colour. */
void ssfr_surface_through(const ssfr_surface *s, double thickness, double out[3]);

/* Fresnel's equations for a dielectric: the share that is mirrored. */
double ssfr_surface_fresnel(const ssfr_surface *s);

/* Radiance from the mirrored direction. */
void ssfr_surface_reflected(const ssfr_surface *s, double out[3]);

/* k_s (n . h)^alpha of the light. */
double ssfr_surface_highlight(const ssfr_surface *s);

#endif

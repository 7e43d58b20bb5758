/* SPDX-License-Identifier: MIT */
/* streak.h: a particle as a quad along its velocity (Bagar 2010, sec. 4.6.2 and listing A.10), shared by all passes
 * that draw foam or spray so. The twin of shaders/streak.glsl.
 *
 *       _______________________
 *      |    .-'"""""""""""'-.    |     half axes: stretch R along the motion, R across it;
 *      |  (         +--------->) |     what is drawn is the ellipse in the quad.
 *      |____'-.___________.-'____|
 *
 * Where the particle is slow, or moves along the ray to the eye, the quad is a square of half side R, parallel to the
 * image.
 *
 * plane=motion  the quad holds the direction of the motion in space (the listing): seen foreshortened.
 * plane=view    it is parallel to the image, along the motion as projected there (the text).
 * orientation=screen never turns it: then it is the quad of splat.h.
 *
 * Each pixel takes the point where its own ray meets the quad's plane. The papers give no fragment shader of foam; as
 * those of its thickness are told to differ from that of water (listings A.9, A.16) by no more than what they print,
 * depth and chord here are those of A.9: R sqrt(1 - r^2) before the quad and behind it. That is an ellipsoid of half
 * axes stretch R, R and R to first order, and only where the quad faces the eye. */
#ifndef SSFR_STREAK_H
#define SSFR_STREAK_H

#include "passes/splat.h"

enum { SSFR_STREAK_VELOCITY, SSFR_STREAK_SCREEN };
enum { SSFR_STREAK_IN_MOTION, SSFR_STREAK_IN_VIEW };

typedef struct ssfr_streak_params { /* the first member of the params of a pass that draws streaks */
    int orientation, plane, root;
    double motion_threshold, facing, stretch, radius_scale;
} ssfr_streak_params;

typedef struct ssfr_streak { /* the first member of its coefficients */
    double radius;           /* m */
    double motion_threshold; /* m/s, slower particles are not turned */
    double facing;           /* |cosine| between motion and ray above which they are not either */
    double stretch;
    int turned, in_view, root;
} ssfr_streak;

extern const char *const ssfr_streak_orientations[], *const ssfr_streak_planes[];

#define SSFR_STREAK_ROW(name, type, unit, def, min, max, words, help) \
    {#name, type, unit, help, offsetof(ssfr_streak_params, name), def, min, max, words}
#define SSFR_STREAK_REAL(name, unit, def, min, max, help) \
    SSFR_STREAK_ROW(name, SSFR_REAL, unit, def, min, max, NULL, help)
#define SSFR_STREAK_ROWS                                                                                         \
    SSFR_STREAK_ROW(orientation, SSFR_CHOICE, "1", SSFR_STREAK_VELOCITY, 0, 0, ssfr_streak_orientations,         \
                    "quads along the velocity, or squares on the screen"),                                       \
    SSFR_STREAK_ROW(plane, SSFR_CHOICE, "1", SSFR_STREAK_IN_MOTION, 0, 0, ssfr_streak_planes,                    \
                    "turned quads hold the motion's direction in space (listing A.10), or lie parallel to the "  \
                    "image (the text)"),                                                                         \
    SSFR_STREAK_ROW(root, SSFR_CHOICE, "1", SSFR_ROOT_EXACT, 0, 0, ssfr_roots,                                   \
                    "height of quads, sqrt(1 - r^2): computed, or looked up in 128 texels"),                     \
    SSFR_STREAK_REAL(motion_threshold, "m/s", 0.5, 0, 1e9, "slower particles are not turned"),                   \
    SSFR_STREAK_REAL(facing, "1", 0.95, 0, 0.9999, "|cosine| between motion and ray above which none is turned"), \
    SSFR_STREAK_REAL(stretch, "1", 2, 1, 100, "half length of a turned quad in radii of the splat"),             \
    SSFR_STREAK_REAL(radius_scale, "1", 1, 0.01, 100, "splat radius in particle radii")

#define SSFR_STREAK_UNIFORMS                                           \
    {"u_radius", offsetof(ssfr_streak, radius), 1},                    \
    {"u_motion_threshold", offsetof(ssfr_streak, motion_threshold), 1}, \
    {"u_facing", offsetof(ssfr_streak, facing), 1},                    \
    {"u_stretch", offsetof(ssfr_streak, stretch), 1},                  \
    {"u_turned", offsetof(ssfr_streak, turned), 0},                    \
    {"u_in_view", offsetof(ssfr_streak, in_view), 0}

/* The first ports of such a pass that carry values; it may have others after them. */
#define SSFR_STREAK_PORTS(size_slot) {"size", size_slot, .widens = true}, {"velocity", SSFR_SLOT_velocity}
#define SSFR_STREAK_PROGRAMS(frag, more) {{"streak.vert", frag, more}}
/* The first of its `tables`, and its `defines`. */
#define SSFR_STREAK_TABLES SSFR_ROOT_TABLES(ssfr_streak_params, root)
bool ssfr_streak_defines(const ssfr_run *run, int i, char text[SSFR_DEFINES]);

void ssfr_streak_derive(const ssfr_run *run, void *coeffs);
double ssfr_streak_reach(const void *params);
bool ssfr_streak_needed(const ssfr_run *run); /* a particle in view has a size */
void ssfr_streak_work(const ssfr_run *run, ssfr_node_report *report);

/* gl_run of passes that keep the nearest fragment, and of those that add all up. */
ssfr_result ssfr_streak_gl_nearest(const ssfr_run *run);
ssfr_result ssfr_streak_gl_add(const ssfr_run *run);

/* Calls shade for every pixel of every particle in view, in the particles' order at each pixel. A fragment's a and b
 * are its place on the quad, along and across, in half axes; on a square, right and down. */
void ssfr_streak_cpu(const ssfr_run *run, ssfr_splat_shade *shade);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* light.h: light through clear bodies: a ray that splits at every surface it meets, until what is left is too little.
 *
 * At a crossing Snell's law and the exact Fresnel equations for unpolarised light split the ray, or reflect it whole.
 * Inside, light fades by Beer and Lambert's law towards the colour of infinitely thick fluid:
 * L = e^(-a s) L_behind + (1 - e^(-a s)) colour. Solids and the world around end a ray. Radiance is taken as it is
 * carried along a ray, without the factor n^2 that it has inside and loses again on its way out. */
#ifndef SSFR_TRUTH_LIGHT_H
#define SSFR_TRUTH_LIGHT_H

#include "experiments/truth/ray.h"

/* Where reflected rays go. */
enum {
    SSFR_REFLECTIONS_RECURSIVE,  /* on, as refracted ones do */
    SSFR_REFLECTIONS_BACKGROUND, /* into the sky, at once (Imai 2016, eqs 6 to 8); see light.c */
};

enum { SSFR_LIGHT_DEPTH = 64 }; /* the largest depth */
#define SSFR_LIGHT_IOR 1e3 /* the largest ratio of two indices, and the inverse of the smallest */

typedef struct ssfr_light_params {
    int depth;         /* the most crossings on one path, [0, SSFR_LIGHT_DEPTH] */
    double least;      /* a path whose weight (the largest of its channels) is below it ends, (0, 1) */
    int reflections;
} ssfr_light_params;

extern const ssfr_param ssfr_light_rows[];

/* The body that the light goes through. */
typedef struct ssfr_refractor {
    void *user; /* one thread's */
    /* The first crossing at t in (0, to), of a ray that begins inside or outside as said, perhaps on the surface. */
    ssfr_result (*first)(void *user, const ssfr_ray *ray, double to, bool inside, ssfr_crossing *out, bool *found);
    /* What floats between from and to (m, `to` may be infinite) adds and which share it lets through, as if it were in
     * a void, and a bound on the error of both; NULL: nothing floats. */
    ssfr_result (*between)(void *user, const ssfr_ray *ray, double from, double to, double colour[3],
                           double *transmittance, double *err);
    double ior;           /* [1 / SSFR_LIGHT_IOR, SSFR_LIGHT_IOR], inside over outside */
    double absorption[3]; /* 1/m, [0, inf) */
    double colour[3];     /* of infinitely thick fluid, [0, inf) */
    double brightest;     /* no radiance of what floats is above it */
} ssfr_refractor;

/* All else. All threads' at once. */
typedef struct ssfr_surroundings {
    void *user;
    /* The radiance along the ray; gives t of what it hits (m, infinite for the sky). */
    double (*trace)(void *user, const ssfr_ray *ray, double colour[3]);
    /* The radiance of the sky in a unit direction, whatever stands before it. */
    void (*sky)(void *user, const double dir[3], double colour[3]);
    double darkest, brightest; /* no radiance is below or above: for the error of paths that ended. darkest: <= 0 */
} ssfr_surroundings;

typedef struct ssfr_lit {
    double colour[3];   /* radiance */
    double err;         /* of any channel, a bound: what paths that ended early could have brought instead of the sky,
                         * and what the radiance of things that float is wrong by. That crossings lie elsewhere by
                         * their own errors is not in it, nor is rounding */
    /* Where the light went, of 1 that came, for the channel with the least absorption: sums to 1. */
    double escaped;     /* into the surroundings */
    double absorbed;    /* in the body, and by what floats */
    double ended;       /* on paths that ended early */
    int n_paths, n_crossings;
} ssfr_lit;

/* Follows the ray. The body and what floats begin at t = begins (m, [0, inf)), inside the body or outside; floor and
 * solids are met before, too. No recursion: what waits stands on a stack as high as the params' depth. */
SSFR_MUST ssfr_result ssfr_light_follow(const ssfr_refractor *refractor, const ssfr_surroundings *around,
                                        const ssfr_light_params *params, const ssfr_ray *ray, double begins,
                                        bool inside, ssfr_lit *out);

/* ---- at one crossing --------------------------------------------------------------------------------------------- */

/* Share of unpolarised light that is reflected; cosine of the angle of incidence in [0, 1]; ratio: the index of
 * refraction on the far side over that on the near one. 1 when all of it is. */
double ssfr_fresnel(double cosine, double ratio);
/* The unit directions in which light from dir (unit) goes on; normal: unit, against dir. False: nothing is refracted.
 * With a ratio of 1 the direction stays as it is, bit for bit. */
bool ssfr_refract(const double dir[3], const double normal[3], double ratio, double out[3]);
void ssfr_reflect(const double dir[3], const double normal[3], double out[3]);

#endif

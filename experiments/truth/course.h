/* SPDX-License-Identifier: GPL-3.0-or-later */
/* course.h: the medium along one ray: extinction, optical depth and colours as functions of one variable, t (m). */
#ifndef SSFR_TRUTH_COURSE_H
#define SSFR_TRUTH_COURSE_H

#include "experiments/truth/extinction.h"
#include "experiments/truth/integrate.h"
#include "experiments/truth/line.h"

/* What the ray crosses of one kernel. */
typedef struct ssfr_fleck {
    double begins, ends;     /* m, within the course */
    double middle, near2;    /* as in ssfr_line_kernel */
    double near, scale;      /* supports; supports a metre of ray */
    double weight;           /* 1/m */
    double start;            /* of its chord, at `begins` */
    double before, whole;    /* optical depth of all that began before it; of itself */
    const double *colour;
} ssfr_fleck;

/* Flecks stand in the order in which they begin. None is longer than `longest`: so those that reach t began within that
 * before it, and of all earlier ones the whole optical depth counts, which is a prefix sum. */
typedef struct ssfr_course {
    const ssfr_radial *radial;
    size_t n;
    ssfr_fleck *flecks;
    double from, to;   /* m */
    double longest;    /* m */
    double depth;      /* optical, of all, by closed-form chords, and what rounding may do to it */
    double depth_err;
    int channel;       /* that ssfr_course_shine gives */
} ssfr_course;

/* Of a line that was cast through extinction->kernels, between a and b (m). n is 0 where there is nothing. The flecks
 * are in the work space's room: the course is over when that is asked for again. */
SSFR_MUST ssfr_result ssfr_course_init(ssfr_course *out, const ssfr_extinction *extinction, const ssfr_line *line,
                                       ssfr_integration *work, double a, double b);

/* Optical depth from the course's begin to t. */
double ssfr_course_depth(const ssfr_course *course, double t);
/* The first fleck that may reach t, or any place behind it; n when all are over. */
size_t ssfr_course_first(const ssfr_course *course, double t);
/* sigma (1/m) and sigma c at t; first: of t or a place before it. */
double ssfr_course_sample(const ssfr_course *course, size_t first, double t, double glow[3]);
/* The integrand sigma c e^(-tau) of one channel: for ssfr_integrand. */
double ssfr_course_shine(double t, void *course);

/* The colour of all that the ray crosses at t; NULL where there is nothing, ssfr_course_mixed (its address, not its
 * values) where there is more than one. */
const double *ssfr_course_colour(const ssfr_course *course, double t);
extern const double ssfr_course_mixed[3];
bool ssfr_same_colour(const double a[3], const double b[3]);

/* Ends the course where nothing behind it can be seen any more, and returns the optical depth there. */
double ssfr_course_end_in_the_dark(ssfr_course *course);
/* What rounding of the depth does to what is collected, per colour. */
double ssfr_course_doubt(const ssfr_course *course);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* radiance.c: the emission-absorption integral along a ray, by closed forms, by rules and by steps. */
#include "experiments/truth/radiance.h"

#include <float.h>

enum { FINE = 12, COARSE = 8 }; /* points of a piece */

/* One job: a ray's radiance, channel by channel, and what it may be wrong by. */
typedef struct sum {
    ssfr_course c;
    ssfr_line *line;
    ssfr_integration *work;
    const ssfr_integrate_params *params;
    double opacity;      /* of the whole course */
    double lo[3], hi[3]; /* the least and the largest colour on it */
    bool grey;           /* all channels are alike */
    double value[3], err[3];
    size_t evaluations;
} sum;

static void survey(sum *s)
{
    s->grey = true;
    for (int k = 0; k < 3; k++) s->lo[k] = INFINITY, s->hi[k] = -INFINITY;
    for (size_t i = 0; i < s->c.n; i++) {
        const double *colour = s->c.flecks[i].colour;
        s->grey = s->grey && colour[0] == colour[1] && colour[0] == colour[2];
        for (int k = 0; k < 3; k++) {
            s->lo[k] = fmin(s->lo[k], colour[k]);
            s->hi[k] = fmax(s->hi[k], colour[k]);
        }
    }
}

/* The share of light that is stopped between two optical depths. */
static double stopped(double depth, double deeper)
{
    return -exp(-depth) * expm1(depth - deeper);
}

static void add_closed(sum *s, const double colour[3], double share)
{
    for (int k = 0; k < 3; k++) {
        s->value[k] += colour[k] * share;
        s->err[k] += fabs(colour[k]) * share * 4 * DBL_EPSILON;
    }
}

static ssfr_result add_integral(sum *s, ssfr_integrator_id id, const ssfr_integrate_params *params, size_t n_breaks,
                                const double *breaks)
{
    ssfr_result result = SSFR_OK;
    const ssfr_integrand integrand = {ssfr_course_shine, &s->c, n_breaks, breaks};
    ssfr_integral integral = {0};
    for (int k = 0; k < 3; k++) {
        if (k == 0 || !s->grey) {
            s->c.channel = k;
            SSFR_TRY(ssfr_integrate(s->work, id, &integrand, params, &integral));
            s->evaluations += integral.evaluations;
        }
        s->value[k] += integral.value;
        s->err[k] += integral.err;
    }
end:
    return result;
}

/* What a piece between breaks adds that begins at the optical depth `depth`, with a polynomial for the extinction
 * within it. Of the depth the closed form is known: how far the polynomial is from that is returned. */
static double collocate(const ssfr_course *c, const ssfr_collocation *rule, const double piece[2], double depth,
                        double deeper, double value[3])
{
    const double a = piece[0], length = piece[1] - a;
    const size_t first = ssfr_course_first(c, a);
    double sigma[SSFR_COLLOCATION_MOST], glow[SSFR_COLLOCATION_MOST][3], all = 0;
    for (int i = 0; i < rule->n; i++) {
        sigma[i] = ssfr_course_sample(c, first, a + rule->at[i] * length, glow[i]);
        all += rule->weight[i] * length * sigma[i];
    }
    for (int k = 0; k < 3; k++) value[k] = 0;
    for (int i = 0; i < rule->n; i++) {
        double within = 0;
        for (int j = 0; j < rule->n; j++) within += rule->upto[i][j] * sigma[j];
        const double share = rule->weight[i] * length * exp(-depth - within * length);
        for (int k = 0; k < 3; k++) value[k] += share * glow[i][k];
    }
    return fabs(all - (deeper - depth));
}

/* A piece in which colours mix. Two polynomials that agree with each other and with the closed-form depth will do, as
 * they mostly do without the cost of a chord; where they do not, GSL's rule takes over. */
static ssfr_result add_mixed(sum *s, const ssfr_integrate_params *part, const double piece[2], double depth,
                             double deeper)
{
    ssfr_result result = SSFR_OK;
    const ssfr_collocation *many, *few;
    double fine[3], coarse[3], err[3];
    bool enough = true;
    SSFR_TRY(ssfr_integration_collocation(s->work, FINE, &many));
    SSFR_TRY(ssfr_integration_collocation(s->work, COARSE, &few));
    const double off = collocate(&s->c, many, piece, depth, deeper, fine);
    const double rough = collocate(&s->c, few, piece, depth, deeper, coarse);
    for (int k = 0; k < 3; k++) {
        err[k] = fabs(fine[k] - coarse[k]) + fmax(fabs(s->lo[k]), fabs(s->hi[k])) * exp(-depth) * fmax(off, rough);
        enough = enough && err[k] <= fmax(part->eps_abs, part->eps_rel * fabs(fine[k]));
    }
    s->evaluations += (size_t)(many->n + few->n);
    if (!enough) SSFR_TRY(add_integral(s, SSFR_INTEGRATOR_qags, part, 2, piece));
    for (int k = 0; k < 3 && enough; k++) {
        s->value[k] += fine[k];
        s->err[k] += err[k];
    }
end:
    return result;
}

/* Between breaks there is a closed form where all that is there has one colour: only the other pieces need a rule. What
 * may be missed is shared out evenly; what is collected is at least the darkest colour times the opacity. */
static ssfr_result add_pieces(sum *s, size_t n_breaks, const double *breaks)
{
    ssfr_result result = SSFR_OK;
    const ssfr_course *c = &s->c;
    const double darkest = fmax(0, fmin(s->lo[0], fmin(s->lo[1], s->lo[2])));
    ssfr_integrate_params part = *s->params;
    part.eps_abs = fmax(part.eps_abs, part.eps_rel * darkest * s->opacity) / (double)n_breaks;
    double depth = ssfr_course_depth(c, breaks[0]), begun = depth; /* of the closed forms that are taken together */
    const double *colour = NULL;
    for (size_t i = 0; i + 1 < n_breaks; i++) {
        const double *next = ssfr_course_colour(c, 0.5 * (breaks[i] + breaks[i + 1]));
        if (colour && next && (next == ssfr_course_mixed || !ssfr_same_colour(colour, next))) {
            add_closed(s, colour, stopped(begun, depth));
            colour = NULL, begun = depth;
        }
        const double before = depth;
        depth = ssfr_course_depth(c, breaks[i + 1]);
        if (next == ssfr_course_mixed) {
            SSFR_TRY(add_mixed(s, &part, breaks + i, before, depth));
            begun = depth;
        } else if (next) {
            colour = next;
        }
    }
    if (colour) add_closed(s, colour, stopped(begun, depth));
end:
    return result;
}

/* What is left in the dark, what a depth that is a little off does, and sums of so many pieces. Whatever a rule says,
 * what is collected lies between the least and the largest colour times the opacity: what it is outside of them is
 * wrong, and no more can be than to the farther of them. */
static void bound(sum *s, int channel, double left, size_t n_pieces)
{
    const double lo = s->lo[channel], hi = s->hi[channel], brightest = fmax(fabs(lo), fabs(hi));
    const double low = lo * s->opacity, high = hi * s->opacity;
    double *value = &s->value[channel], *err = &s->err[channel];
    *err += brightest * left;
    *err += (double)n_pieces * DBL_EPSILON * fabs(*value);
    if (!isfinite(*value)) *value = 0.5 * (low + high);
    *err = fmax(*err, fmax(low - *value, *value - high));
    *err = fmin(*err, fmax(*value - low, high - *value) + brightest * 8 * DBL_EPSILON);
}

static ssfr_result add_all(sum *s, ssfr_integrator_id id)
{
    ssfr_result result = SSFR_OK;
    size_t n_breaks = 0;
    const double *breaks = NULL;
    const double doubt = ssfr_course_doubt(&s->c), reached = ssfr_course_end_in_the_dark(&s->c);
    SSFR_TRY(ssfr_line_breaks(s->line, s->c.from, s->c.to, &n_breaks, &breaks));
    if (id == SSFR_INTEGRATOR_chords) SSFR_TRY(add_pieces(s, n_breaks, breaks));
    else SSFR_TRY(add_integral(s, id, s->params, n_breaks, breaks));
    for (int k = 0; k < 3; k++) bound(s, k, stopped(reached, s->c.depth) + doubt, n_breaks);
end:
    return result;
}

/* Equal steps from front to back, as renderers take them: each is as if the middle's extinction and colour filled it
 * (Max 1995, "Optical models for direct volume rendering"). Returns the transmittance that comes of it. */
static double march(const ssfr_course *c, int n, double collected[3])
{
    const double step = (c->to - c->from) / n;
    double transmittance = 1, glow[3];
    for (int k = 0; k < 3; k++) collected[k] = 0;
    for (int i = 0; i < n; i++) {
        const double t = c->from + (i + 0.5) * step, sigma = ssfr_course_sample(c, ssfr_course_first(c, t), t, glow);
        if (!(sigma > 0)) continue;
        const double share = -transmittance * expm1(-sigma * step);
        for (int k = 0; k < 3; k++) collected[k] += share * glow[k] / sigma;
        transmittance *= exp(-sigma * step);
    }
    return transmittance;
}

/* The error is told by half as many steps, and by the closed form of the transmittance. */
static ssfr_result add_steps(sum *s, ssfr_radiance *out)
{
    const int n = s->params->steps, half = n / 2;
    double rough[3];
    if (n < 1) return ssfr_fail(SSFR_ERR_VALUE, "steps %d: there is at least one", n);
    out->transmittance = march(&s->c, n, s->value);
    const double rough_transmittance = march(&s->c, half, rough);
    const double through = out->transmittance;
    const double off = fmax(fabs(through - exp(-s->c.depth)), fabs(through - rough_transmittance));
    for (int k = 0; k < 3; k++) s->err[k] = fmax(off, fabs(s->value[k] - rough[k])) + n * DBL_EPSILON;
    s->evaluations += (size_t)n + (size_t)half;
    return SSFR_OK;
}

ssfr_result ssfr_radiance_collect(const ssfr_extinction *extinction, ssfr_line *line, ssfr_integration *work,
                                  ssfr_integrator_id id, const ssfr_integrate_params *params, double a, double b,
                                  ssfr_radiance *out)
{
    ssfr_result result = SSFR_OK;
    sum s = {.line = line, .work = work, .params = params};
    *out = (ssfr_radiance){.transmittance = 1, .closed = true};
    SSFR_TRY(ssfr_course_init(&s.c, extinction, line, work, a, b));
    if (s.c.n == 0) goto end;
    s.opacity = -expm1(-s.c.depth);
    out->transmittance = exp(-s.c.depth);
    survey(&s);
    out->closed = id == SSFR_INTEGRATOR_chords && ssfr_same_colour(s.lo, s.hi);
    if (id == SSFR_INTEGRATOR_steps) SSFR_TRY(add_steps(&s, out));
    else if (out->closed) add_closed(&s, s.lo, s.opacity);
    else SSFR_TRY(add_all(&s, id));

    for (int k = 0; k < 3; k++) {
        out->colour[k] = s.value[k];
        out->err = fmax(out->err, s.err[k]);
    }
    out->err = fmax(out->err, out->transmittance * fmin(s.c.depth_err, 1) + DBL_EPSILON);
    out->evaluations = s.evaluations;
end:
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* radiance.c: extinction of diffuse particles, and the emission-absorption integral along a ray. */
#include "experiments/truth/radiance.h"
#include "base/param.h"
#include "experiments/truth/collocation.h"

#include <float.h>

#define DEEP 40.0 /* optical depth from which on nothing changes a double of the size 1: e^-40 = 4e-18 */

enum { FINE = 12, COARSE = 8 }; /* points of a piece */

/* ---- the medium -------------------------------------------------------------------------------------------------- */

#define REAL(name, unit, def, min, max, help) SSFR_PARAM_REAL(ssfr_extinction_params, name, unit, def, min, max, help)
/* Ihmsen et al. 2012 render by absorption and emission along equal steps, without scattering (so Akinci et al. 2013,
 * sec. 1, who print no coefficients). The defaults follow from optics and from what is to be seen:
 *
 *      efficiency   a ball that is large against the wavelength takes what meets its cross-section: Q = 1. It is 2 with
 *                   the light that it diffracts (van de Hulst 1957), but that goes straight on
 *      radius       half of the rays through the foam of a double dam break (182 398 diffuse particles, the fluid's of
 *                   0.02 m, seen from the side) then have an optical depth below 0.6, a quarter above 1.7, 1 % above
 *                   7.6: sheets and clouds that the water shows through, opaque where they are dense. With 0.25 half
 *                   is above 1.6, and all of it is one white shape. Akinci et al. 2013, sec. 2.1 draw balls of r to
 *                   r / 5, 0.54 r in the root mean square
 *      support      a particle stands for a fleck, not for one ball: half the fluid's spacing, so that a lone one is
 *                   a soft dot (the optical depth through its middle is 6 Q a^2 / h^2 = 0.135) and many are a cloud
 *      colours      what fully opaque foam looks like, light = 1. Foam reflects nearly all light, as do drops; bubbles
 *                   are under water and meant to be less visible (Akinci et al. halve their radius, sec. 2.1) */
const ssfr_param ssfr_extinction_rows[] = {
    REAL(radius, "radii", 0.15, 1e-4, 10, "a, of a diffuse particle as a ball that takes light"),
    REAL(support, "radii", 1, 0.01, 100, "of the cubic spline kernel that its cross-section is spread with"),
    REAL(efficiency, "1", 1, 0, 4, "Q, extinction over cross-section: 1 of large balls, 2 with what they diffract"),
    REAL(spray, "1", 1, 0, 1, "grey, what spray shines with where it is opaque, light = 1"),
    REAL(foam, "1", 0.95, 0, 1, "the same of foam"),
    REAL(bubble, "1", 0.8, 0, 1, "the same of bubbles, which are under water"),
    SSFR_PARAM_END,
};

static ssfr_result check(const ssfr_particles *particles, double radius, const ssfr_extinction_params *params)
{
    const ssfr_result result = ssfr_params_check(ssfr_extinction_rows, params, "extinction");
    if (result != SSFR_OK) return result;
    if (!(radius > 0 && isfinite(radius)))
        return ssfr_fail(SSFR_ERR_VALUE, "diffuse particles need the fluid's radius, which is %g m", radius);
    for (size_t i = 0; particles->kind && i < particles->n; i++)
        if (particles->kind[i] > SSFR_BUBBLE)
            return ssfr_fail(SSFR_ERR_VALUE, "diffuse particle %zu: kind %u is none of 0 spray, 1 foam, 2 bubble", i,
                             (unsigned)particles->kind[i]);
    return SSFR_OK;
}

/* Greys by kind; foam where kinds are not known. One colour for all needs no array. */
static ssfr_result colour_kinds(ssfr_extinction *out, const ssfr_particles *particles,
                                const ssfr_extinction_params *params)
{
    const double grey[] = {[SSFR_SPRAY] = params->spray, [SSFR_FOAM] = params->foam, [SSFR_BUBBLE] = params->bubble};
    const uint32_t *kind = particles->kind;
    const double first = grey[kind ? kind[0] : (uint32_t)SSFR_FOAM];
    for (int k = 0; k < 3; k++) out->same[k] = first;
    size_t n_same = 0;
    while (n_same < particles->n && (!kind || grey[kind[n_same]] == first)) n_same++;
    if (n_same == particles->n) return SSFR_OK;

    const ssfr_result result = ssfr_alloc(&out->colour, particles->n, sizeof *out->colour, "colours of foam");
    if (result != SSFR_OK) return result;
    for (size_t i = 0; i < particles->n; i++)
        for (int k = 0; k < 3; k++) out->colour[i][k] = grey[kind[i]];
    return SSFR_OK;
}

/* Relative to the origin before anything is rounded: packets' centres may be far away. */
static void place(const ssfr_particles *particles, const double origin[3], double (*centre)[3])
{
    for (size_t i = 0; i < particles->n; i++)
        for (size_t k = 0; k < 3; k++)
            centre[i][k] = particles->packets[i / SSFR_PACKET].centre[k] - origin[k] +
                           (double)particles->position[3 * i + k];
}

ssfr_result ssfr_extinction_init(ssfr_extinction *out, const ssfr_particles *particles, double radius,
                                 const double origin[3], const ssfr_extinction_params *params)
{
    ssfr_result result = SSFR_OK;
    double (*centre)[3] = NULL;
    const size_t n = particles ? particles->n : 0;
    *out = (ssfr_extinction){0};
    if (n > 0) {
        SSFR_TRY(check(particles, radius, params));
        SSFR_TRY(colour_kinds(out, particles, params));
    }
    SSFR_TRY(ssfr_alloc(&centre, n, sizeof *centre, "places of foam"));
    if (n > 0) place(particles, origin, centre);

    const double support = n > 0 ? params->support * radius : 1, a = n > 0 ? params->radius * radius : 0;
    const double weight = params->efficiency * M_PI * a * a / (support * support * support);
    SSFR_TRY(ssfr_continuum_init_kernels(&out->kernels, n, (const double (*)[3])centre, origin, &ssfr_radials[0],
                                         support, weight, 0.5));
end:
    free(centre);
    if (result != SSFR_OK) ssfr_extinction_finish(out);
    return result;
}

void ssfr_extinction_finish(ssfr_extinction *extinction)
{
    ssfr_continuum_finish(&extinction->kernels);
    free(extinction->colour);
    *extinction = (ssfr_extinction){0};
}

static const double *colour_of(const ssfr_extinction *extinction, uint32_t index)
{
    return extinction->colour ? extinction->colour[index] : extinction->same;
}

/* ---- the medium along a ray -------------------------------------------------------------------------------------- */

/* What the ray crosses of one kernel. */
typedef struct fleck {
    double begins, ends;     /* m, within the course */
    double middle, near2;    /* as in ssfr_line_kernel */
    double near, scale;      /* supports; supports a metre of ray */
    double weight;           /* 1/m */
    double start;            /* of its chord, at `begins` */
    double before, whole;    /* optical depth of all that began before it; of itself */
    const double *colour;
} fleck;

/* In the order in which they begin. None is longer than `longest`: so those that reach t began within that before it,
 * and of all earlier ones the whole optical depth counts, which is a prefix sum. */
typedef struct course {
    const ssfr_radial *radial;
    size_t n;
    fleck *flecks;
    double from, to;   /* m */
    double longest;    /* m */
    double depth;      /* optical, of all, by closed-form chords, and what rounding may do to it */
    double depth_err;
    int channel;       /* that `shine` gives */
} course;

/* Optical depth of a fleck from its begin to t. */
static double depth_in(const course *c, const fleck *f, double t)
{
    if (t >= f->ends) return f->whole;
    const double chord = ssfr_radial_chord(c->radial, f->near, f->scale * (t - f->middle)) - f->start;
    return f->weight / f->scale * chord;
}

static void add_fleck(course *c, const ssfr_extinction *extinction, const ssfr_line_kernel *kernel)
{
    const double begins = fmax(kernel->enters, c->from), ends = fmin(kernel->leaves, c->to);
    if (!(begins < ends)) return;
    fleck *f = &c->flecks[c->n];
    *f = (fleck){.begins = begins, .ends = ends, .middle = kernel->middle, .near2 = kernel->near2,
                 .near = sqrt(kernel->near2), .scale = sqrt(kernel->stretch), .weight = kernel->weight,
                 .colour = colour_of(extinction, kernel->index)};
    f->start = ssfr_radial_chord(c->radial, f->near, f->scale * (begins - f->middle));
    const double end = ssfr_radial_chord(c->radial, f->near, f->scale * (ends - f->middle));
    f->whole = f->weight / f->scale * (end - f->start);
    if (c->n > 0) f->before = f[-1].before + f[-1].whole;
    c->longest = fmax(c->longest, ends - begins);
    c->n++;
}

/* The first fleck that may reach t; c->n when all are over. */
static size_t first_at(const course *c, double t)
{
    size_t lo = 0, hi = c->n;
    while (lo < hi) {
        const size_t mid = lo + (hi - lo) / 2;
        if (c->flecks[mid].begins < t - c->longest) lo = mid + 1;
        else hi = mid;
    }
    return lo;
}

static double depth_at(const course *c, double t)
{
    size_t i = first_at(c, t);
    double depth = i < c->n ? c->flecks[i].before : c->depth;
    for (; i < c->n && c->flecks[i].begins < t; i++) depth += depth_in(c, &c->flecks[i], t);
    return depth;
}

/* sigma_j(t) of one fleck, 1/m. */
static double extinction_of(const course *c, const fleck *f, double t)
{
    return f->weight * ssfr_radial_value(c->radial, sqrt(f->near2 + ssfr_square(f->scale * (t - f->middle))));
}

/* sigma (1/m) and sigma c there. */
static double sample(const course *c, size_t first, double t, double glow[3])
{
    double sigma = 0;
    for (int k = 0; k < 3; k++) glow[k] = 0;
    for (size_t i = first; i < c->n && c->flecks[i].begins < t; i++) {
        const fleck *f = &c->flecks[i];
        if (t >= f->ends) continue;
        const double own = extinction_of(c, f, t);
        sigma += own;
        for (int k = 0; k < 3; k++) glow[k] += own * f->colour[k];
    }
    return sigma;
}

/* The integrand sigma c e^(-tau) of one channel. */
static double shine(double t, void *user)
{
    const course *c = user;
    size_t i = first_at(c, t);
    double glow = 0, depth = i < c->n ? c->flecks[i].before : c->depth;
    for (; i < c->n && c->flecks[i].begins < t; i++) {
        const fleck *f = &c->flecks[i];
        depth += depth_in(c, f, t);
        if (t < f->ends) glow += f->colour[c->channel] * extinction_of(c, f, t);
    }
    return glow > 0 ? glow * exp(-depth) : 0;
}

/* Ends the course where nothing behind can be seen any more. What it leaves is in e^-(depth there). */
static double end_in_the_dark(course *c)
{
    if (c->depth <= DEEP) return c->depth;
    double lo = c->from, hi = c->to;
    for (int k = 0; k < 64; k++) { /* to a double's digits */
        const double mid = 0.5 * (lo + hi);
        if (depth_at(c, mid) > DEEP) hi = mid;
        else lo = mid;
    }
    c->to = hi;
    return DEEP;
}

/* What rounding of the depth does to what is collected, per colour: of a fleck both its light and its shade, by no more
 * than comes through to its begin. Of all flecks it is about the same. */
static double depth_doubt(const course *c)
{
    double sum = 0;
    for (size_t i = 0; i < c->n; i++) sum += exp(-c->flecks[first_at(c, c->flecks[i].begins)].before);
    return fmin(1, 2 * c->depth_err / (double)c->n * sum);
}

static ssfr_result course_init(course *c, const ssfr_extinction *extinction, const ssfr_line *line, double a, double b)
{
    *c = (course){.radial = extinction->kernels.radial, .from = INFINITY, .to = -INFINITY};
    for (size_t i = 0; i < line->n; i++) {
        c->from = fmin(c->from, line->kernels[i].enters);
        c->to = fmax(c->to, line->kernels[i].leaves);
    }
    c->from = fmax(c->from, fmax(a, line->from));
    c->to = fmin(c->to, fmin(b, line->to));
    if (!(a < b && c->from < c->to)) return SSFR_OK;

    const ssfr_result result = ssfr_alloc(&c->flecks, line->n, sizeof *c->flecks, "foam along a ray");
    if (result != SSFR_OK) return result;
    for (size_t i = 0; i < line->n; i++) add_fleck(c, extinction, &line->kernels[i]);
    c->depth = ssfr_line_chords(line, c->from, c->to, &c->depth_err);
    return SSFR_OK;
}

/* ---- what is collected ------------------------------------------------------------------------------------------- */

static bool same_colour(const double a[3], const double b[3])
{
    return a == b || (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]);
}

static const double mixed[3]; /* its address says: more than one colour */

/* The colour of all that the ray crosses at t; NULL where there is nothing. */
static const double *colour_at(const course *c, double t)
{
    const double *colour = NULL;
    for (size_t i = first_at(c, t); i < c->n && c->flecks[i].begins < t; i++) {
        const fleck *f = &c->flecks[i];
        if (t >= f->ends) continue;
        if (colour && !same_colour(colour, f->colour)) return mixed;
        colour = f->colour;
    }
    return colour;
}

/* One job: a ray's radiance, channel by channel, and what it may be wrong by. */
typedef struct sum {
    course c;
    ssfr_line *line;
    ssfr_integration *work;
    const ssfr_integrate_params *params;
    double opacity;      /* of the whole course */
    double lo[3], hi[3]; /* the least and the largest colour on it */
    bool grey;           /* all channels are alike */
    double value[3], err[3];
    ssfr_collocation fine, coarse;
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
    const ssfr_integrand integrand = {shine, &s->c, n_breaks, breaks};
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
static double collocate(const course *c, const ssfr_collocation *rule, double a, double b, double depth, double deeper,
                        double value[3])
{
    const double length = b - a;
    const size_t first = first_at(c, a);
    double sigma[SSFR_COLLOCATION_MOST], glow[SSFR_COLLOCATION_MOST][3], all = 0;
    for (int i = 0; i < rule->n; i++) {
        sigma[i] = sample(c, first, a + rule->at[i] * length, glow[i]);
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
    double fine[3], coarse[3], err[3];
    const double off = collocate(&s->c, &s->fine, piece[0], piece[1], depth, deeper, fine);
    const double rough = collocate(&s->c, &s->coarse, piece[0], piece[1], depth, deeper, coarse);
    bool enough = true;
    for (int k = 0; k < 3; k++) {
        err[k] = fabs(fine[k] - coarse[k]) + fmax(fabs(s->lo[k]), fabs(s->hi[k])) * exp(-depth) * fmax(off, rough);
        enough = enough && err[k] <= fmax(part->eps_abs, part->eps_rel * fabs(fine[k]));
    }
    s->evaluations += (size_t)(s->fine.n + s->coarse.n);
    if (!enough) return add_integral(s, SSFR_INTEGRATOR_qags, part, 2, piece);
    for (int k = 0; k < 3; k++) {
        s->value[k] += fine[k];
        s->err[k] += err[k];
    }
    return SSFR_OK;
}

/* Between breaks there is a closed form where all that is there has one colour: only the other pieces need a rule. What
 * may be missed is shared out evenly; what is collected is at least the darkest colour times the opacity. */
static ssfr_result add_pieces(sum *s, size_t n_breaks, const double *breaks)
{
    ssfr_result result = SSFR_OK;
    const course *c = &s->c;
    const double darkest = fmax(0, fmin(s->lo[0], fmin(s->lo[1], s->lo[2])));
    ssfr_integrate_params part = *s->params;
    part.eps_abs = fmax(part.eps_abs, part.eps_rel * darkest * s->opacity) / (double)n_breaks;
    double depth = depth_at(c, breaks[0]), begun = depth; /* of the closed forms that are taken together */
    const double *colour = NULL;
    SSFR_TRY(ssfr_collocation_init(&s->fine, FINE));
    SSFR_TRY(ssfr_collocation_init(&s->coarse, COARSE));
    for (size_t i = 0; i + 1 < n_breaks; i++) {
        const double *next = colour_at(c, 0.5 * (breaks[i] + breaks[i + 1]));
        if (colour && next && (next == mixed || !same_colour(colour, next))) {
            add_closed(s, colour, stopped(begun, depth));
            colour = NULL, begun = depth;
        }
        const double before = depth;
        depth = depth_at(c, breaks[i + 1]);
        if (next == mixed) {
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

static ssfr_result add_all(sum *s, ssfr_integrator_id id)
{
    ssfr_result result = SSFR_OK;
    size_t n_breaks = 0;
    const double *breaks = NULL;
    const double doubt = depth_doubt(&s->c), reached = end_in_the_dark(&s->c);
    SSFR_TRY(ssfr_line_breaks(s->line, s->c.from, s->c.to, &n_breaks, &breaks));
    if (id == SSFR_INTEGRATOR_chords) SSFR_TRY(add_pieces(s, n_breaks, breaks));
    else SSFR_TRY(add_integral(s, id, s->params, n_breaks, breaks));

    for (int k = 0; k < 3; k++) {
        /* What is left in the dark, what a depth that is a little off does, and sums of so many pieces. */
        const double brightest = fmax(fabs(s->lo[k]), fabs(s->hi[k]));
        s->err[k] += brightest * (stopped(reached, s->c.depth) + doubt);
        s->err[k] += (double)n_breaks * DBL_EPSILON * fabs(s->value[k]);
        /* Whatever a rule says, what is collected lies between the least and the largest colour times the opacity. */
        const double low = s->lo[k] * s->opacity, high = s->hi[k] * s->opacity;
        if (!isfinite(s->value[k])) s->value[k] = 0.5 * (low + high);
        s->err[k] = fmin(s->err[k], fmax(s->value[k] - low, high - s->value[k]) + brightest * 8 * DBL_EPSILON);
    }
end:
    return result;
}

/* Equal steps from front to back, as renderers take them: each is as if the middle's extinction and colour filled it
 * (Max 1995, "Optical models for direct volume rendering"). Returns the transmittance that comes of it. */
static double march(const course *c, int n, double collected[3])
{
    const double step = (c->to - c->from) / n;
    double transmittance = 1, glow[3];
    for (int k = 0; k < 3; k++) collected[k] = 0;
    for (int i = 0; i < n; i++) {
        const double t = c->from + (i + 0.5) * step, sigma = sample(c, first_at(c, t), t, glow);
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
    SSFR_TRY(course_init(&s.c, extinction, line, a, b));
    if (s.c.n == 0) goto end;
    s.opacity = -expm1(-s.c.depth);
    out->transmittance = exp(-s.c.depth);
    survey(&s);
    out->closed = id == SSFR_INTEGRATOR_chords && same_colour(s.lo, s.hi);
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
    free(s.c.flecks);
    return result;
}

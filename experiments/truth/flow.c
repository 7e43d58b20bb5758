/* SPDX-License-Identifier: GPL-3.0-or-later */
/* flow.c: the curvature flow by gsl_odeiv2, with crossings of the falloff located between smooth pieces.
 *
 * Time is counted in steps of the pass, so that the rate is what one of them adds, m. */
#include "experiments/truth/flow.h"
#include "experiments/console.h"

#include "passes/curvature_flow.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

enum {
    MAX_TRIES = 10000, /* steps of a run, those that were taken back included */
    MAX_EXACT = MAX_TRIES / 2, /* of them until crossings are located; then all cuts flicker, so that it ends */
    MAX_LOCATING = 48, /* tries for one crossing: the secant takes 2 to 5 */
    FLICKER = 4,       /* changes of a pixel's cuts, each soon after the last: from then on they flicker */
};

static const double first_try = 1e-2; /* steps of the pass; the control finds the right size from there */
static const double nudge = 1e-4;     /* of the depth at which the rate's third derivatives count, see find_jacobian */

const char *const ssfr_flow_names[] = {[SSFR_FLOW_RK8PD] = "rk8pd", [SSFR_FLOW_MSBDF] = "msbdf", [SSFR_N_FLOWS] = NULL};
static const int sides[] = {[SSFR_FLOW_RK8PD] = SSFR_FLOW_RK8PD_SIDE, [SSFR_FLOW_MSBDF] = SSFR_FLOW_MSBDF_SIDE};
/* Of the whole time: how often cuts that come and go may change. After each change msbdf begins anew at order 1. */
static const int flickers[] = {[SSFR_FLOW_RK8PD] = 1024, [SSFR_FLOW_MSBDF] = 64};

typedef struct flow {
    const ssfr_run *run;
    size_t n;            /* unknowns: pixels with a surface, in the order of rows */
    int *pixel;          /* of each unknown, x + w y */
    int *unknown;        /* of each pixel, -1 for holes */
    unsigned char *cuts; /* of each unknown, while a step is tried */
    unsigned char *quick; /* how many changes of its cuts came soon after the last, up to FLICKER */
    double *due;         /* when they changed last; of those that flicker, when they may again */
    ssfr_field *start;   /* depths at the start of a step, with all holes */
    ssfr_field *depth;   /* what the rate is taken of */
    double *input;       /* of each unknown, m */
    double *work;        /* 3 n */
    size_t evaluations, jacobians;
} flow;

/* ---- the system -------------------------------------------------------------------------------------------------- */

static void place(const flow *f, const double *y, ssfr_field *depth)
{
    for (size_t i = 0; i < f->n; i++) depth->data[f->pixel[i]] = y[i];
}

static unsigned char cuts_of(const flow *f, const ssfr_field *depth, size_t i)
{
    return (unsigned char)ssfr_curvature_flow_cuts(f->run, depth, f->pixel[i] % depth->w, f->pixel[i] / depth->w);
}

/* The rates of f->depth; whether all are finite. */
static bool find_rates(const flow *f, double *rates)
{
    const ssfr_field *depth = f->depth;
    bool finite = true;
#pragma omp parallel for schedule(static) reduction(&& : finite) if (f->n > 4096)
    for (size_t i = 0; i < f->n; i++) {
        const int x = f->pixel[i] % depth->w, y = f->pixel[i] / depth->w;
        rates[i] = ssfr_curvature_flow_rate(f->run, depth, x, y, f->cuts[i]);
        finite = finite && isfinite(rates[i]);
    }
    return finite;
}

/* Any code but those of gsl_odeiv2 for users makes it try a shorter step. */
static int rate(double t, const double y[], double dydt[], void *user)
{
    flow *f = user;
    (void)t;
    place(f, y, f->depth);
    f->evaluations++;
    return find_rates(f, dydt) ? GSL_SUCCESS : GSL_EDOM;
}

/* What the rates of the pixels around (x, y) say of that pixel's depth, which was moved by +h and -h. */
static void read_column(const flow *f, size_t j, const double *plus, const double *minus, double h, double *matrix)
{
    const int w = f->depth->w, x = f->pixel[j] % w, y = f->pixel[j] / w;
    for (int v = ssfr_max_int(y - 1, 0); v <= ssfr_min_int(y + 1, f->depth->h - 1); v++)
        for (int u = ssfr_max_int(x - 1, 0); u <= ssfr_min_int(x + 1, w - 1); u++) {
            const int i = f->unknown[u + w * v];
            if (i >= 0) matrix[(size_t)i * f->n + j] = (plus[i] - minus[i]) / (2 * h);
        }
}

/* Central differences. A rate depends on 3x3 pixels, so that of each such square one pixel can be moved at once: 18
 * evaluations, however many unknowns. Rates bend where slopes change by 1, that is depths by C |z|. */
static bool find_jacobian(const flow *f, const double *y, double *matrix)
{
    const ssfr_curvature_flow_coeffs *c = f->run->coeffs;
    const double relative = nudge * fmin(c->c[0], c->c[1]);
    double *moved = f->work, *rates[2] = {f->work + f->n, f->work + 2 * f->n};
    const int w = f->depth->w;
    bool finite = true;
    memset(matrix, 0, f->n * f->n * sizeof *matrix);
    for (int colour = 0; colour < 9; colour++) {
        for (int side = 0; side < 2; side++) {
            for (size_t j = 0; j < f->n; j++) {
                const bool is = f->pixel[j] % w % 3 == colour % 3 && f->pixel[j] / w % 3 == colour / 3;
                moved[j] = y[j] * (is ? 1 + (side ? -relative : relative) : 1);
            }
            place(f, moved, f->depth);
            finite &= find_rates(f, rates[side]);
        }
        for (size_t j = 0; j < f->n; j++)
            if (f->pixel[j] % w % 3 == colour % 3 && f->pixel[j] / w % 3 == colour / 3)
                read_column(f, j, rates[0], rates[1], relative * y[j], matrix);
    }
    return finite;
}

static int jacobian(double t, const double y[], double *dfdy, double dfdt[], void *user)
{
    flow *f = user;
    (void)t;
    memset(dfdt, 0, f->n * sizeof *dfdt);
    f->jacobians++;
    return find_jacobian(f, y, dfdy) ? GSL_SUCCESS : GSL_EDOM;
}

/* ---- crossings of the falloff ------------------------------------------------------------------------------------ */

typedef struct watch { /* of one run: the state of the control that GSL asks whether a step may stay */
    flow *f;
    const gsl_odeiv2_control *control; /* of the error */
    double t;        /* start of the step */
    double eps;      /* m, how far beyond the falloff a step may end */
    double flicker;  /* of time: cuts that come and go change at multiples of it */
    bool again;      /* the second run, which tells the error of the first */
    bool hurry;      /* half of the tries are used up: crossings are no longer located, and cuts change */
    double next;     /* no sooner than this */
    int tries;       /* to locate the crossing in this step */
    double resume;   /* the step that the error would have allowed; 0: no crossing in this step */
    size_t located;  /* tries that were taken back for a crossing */
    size_t crossings, flickers;
} watch;

/* The share of a step after which a cut of unknown i changes, by the secant, and a touch more, to get beyond it; 1 when
 * none does. */
static double share_of(const watch *w, size_t i, double step)
{
    static const unsigned bits[] = {SSFR_CURVATURE_FLOW_CUT_X, SSFR_CURVATURE_FLOW_CUT_Y, SSFR_CURVATURE_FLOW_CUT_XY};
    const flow *f = w->f;
    const ssfr_curvature_flow_coeffs *c = f->run->coeffs;
    const int x = f->pixel[i] % f->depth->w, y = f->pixel[i] / f->depth->w;
    const unsigned changed = f->cuts[i] ^ cuts_of(f, f->depth, i);
    double share = 1;
    for (size_t k = 0; k < SSFR_COUNT(bits); k++) {
        if (!(changed & bits[k])) continue;
        const double before = ssfr_curvature_flow_jump(f->start, x, y, bits[k]) - c->falloff;
        const double after = ssfr_curvature_flow_jump(f->depth, x, y, bits[k]) - c->falloff;
        /* z_xy goes and comes with the other two: their crossing is the one to find. */
        if ((before > 0) != (after > 0) && fabs(after) > w->eps)
            share = fmin(share, (fabs(before) + 0.5 * w->eps) / (fabs(before) + fabs(after)));
    }
    return fmax(share, (f->due[i] - w->t) / step);
}

static bool all_finite(size_t n, const double *v)
{
    bool finite = true;
    for (size_t i = 0; i < n; i++) finite &= isfinite(v[i]);
    return finite;
}

/* A step stays when its error is small and it ends no further than eps beyond the first crossing. */
static int adjust(void *state, size_t n, unsigned order, const double y[], const double yerr[], const double yp[],
                  double *h)
{
    watch *w = state;
    const double step = *h;
    double share = 1;
    if (!all_finite(n, y) || !all_finite(n, yerr)) { /* GSL's own would take NaN for no error */
        *h = step / 5;
        return GSL_ODEIV_HADJ_DEC;
    }
    const int verdict = w->control->type->hadjust(w->control->state, n, order, y, yerr, yp, h);
    if (verdict == GSL_ODEIV_HADJ_DEC || w->hurry || w->tries >= MAX_LOCATING) return verdict;
    place(w->f, y, w->f->depth);
    for (size_t i = 0; i < n; i++)
        if (w->f->cuts[i] != cuts_of(w->f, w->f->depth, i)) share = fmin(share, share_of(w, i, step));
    if (share >= 1) return verdict;
    if (w->resume == 0) w->resume = step;
    w->located++;
    w->tries++;
    *h = share * step;
    return GSL_ODEIV_HADJ_DEC;
}

static const gsl_odeiv2_control_type watching = {.name = "crossings", .hadjust = adjust};

/* Takes y for the start of the next step; whether any cut has changed. */
static bool settle(watch *w, const double *y)
{
    flow *f = w->f;
    bool changed = false, flickered = false;
    place(f, y, f->start);
    if (w->hurry && w->t < w->next) return false;
    for (size_t i = 0; i < f->n; i++) {
        const unsigned char cuts = cuts_of(f, f->start, i);
        if (cuts == f->cuts[i] || w->t < f->due[i]) continue;
        changed = true;
        const bool soon = w->t - f->due[i] < w->flicker;
        f->quick[i] = soon ? (unsigned char)ssfr_min_int(f->quick[i] + 1, FLICKER) : 0;
        f->due[i] = f->quick[i] < FLICKER ? w->t : (floor(w->t / w->flicker) + 2) * w->flicker;
        flickered |= w->hurry || f->quick[i] == FLICKER;
        f->cuts[i] = cuts;
    }
    if (changed) w->next = (floor(w->t / w->flicker) + 1) * w->flicker;
    w->crossings += changed;
    w->flickers += flickered;
    return changed;
}

/* ---- a run ------------------------------------------------------------------------------------------------------- */

static void begin(watch *w, const double *y)
{
    flow *f = w->f;
    place(f, y, f->start);
    for (size_t i = 0; i < f->n; i++) f->cuts[i] = cuts_of(f, f->start, i), f->due[i] = -INFINITY, f->quick[i] = 0;
}

/* Of the two runs; a run ends at its end of time or of tries, whichever comes first. */
static void tell(const watch *w, double end, size_t tries)
{
    const double share = fmax(w->t / end, (double)tries / MAX_TRIES);
    ssfr_console_progress("flow", (size_t)(50 * ((w->again ? 1 : 0) + share)), 100);
}

/* From y at time 0 to y at `end`, or to where the tries were used up. */
static void advance(watch *w, gsl_odeiv2_driver *driver, double end, double *y, ssfr_flow_report *report)
{
    flow *f = w->f;
    gsl_odeiv2_control control = {&watching, w};
    double h = fmin(first_try, end);
    size_t taken_back = 0, tries = 0;
    int status = GSL_SUCCESS;
    begin(w, y);
    while (w->t < end && tries < MAX_TRIES) {
        double t = w->t;
        w->hurry = tries >= MAX_EXACT, w->tries = 0, w->resume = 0;
        status = gsl_odeiv2_evolve_apply(driver->e, &control, driver->s, driver->sys, &t, end, &h, y);
        if (status != GSL_SUCCESS) break; /* no step is short enough */
        w->t = t;
        tries = ++report->steps + taken_back + driver->e->failed_steps;
        tell(w, end, tries);
        if (!settle(w, y)) continue;
        taken_back += driver->e->failed_steps;
        gsl_odeiv2_driver_reset(driver); /* forgets them, too */
        if (driver->s->type == gsl_odeiv2_step_rk8pd) h = fmax(h, w->resume); /* no history: as before the crossing */
    }
    for (size_t i = 0; i < f->n; i++) y[i] = f->start->data[f->pixel[i]];
    report->failed = taken_back + driver->e->failed_steps - w->located;
    report->crossings = w->crossings;
    report->flickers = w->flickers;
    report->reached = w->t;
}

/* Times of the report are in steps of the pass. coarse: of the tolerance and of how soon cuts may flicker. */
static ssfr_result solve(flow *f, ssfr_flow_method method, double tolerance, double coarse, double *y,
                         ssfr_flow_report *report)
{
    const gsl_odeiv2_step_type *const types[] = {gsl_odeiv2_step_rk8pd, gsl_odeiv2_step_msbdf};
    const ssfr_curvature_flow_coeffs *c = f->run->coeffs;
    const gsl_odeiv2_system system = {rate, jacobian, f->n, f};
    double nearest = INFINITY;
    *report = (ssfr_flow_report){.unknowns = f->n, .time = c->iterations};
    for (size_t i = 0; i < f->n; i++) y[i] = f->input[i], nearest = fmin(nearest, fabs(y[i]));
    if (f->n == 0 || c->iterations == 0) {
        report->reached = report->time;
        return SSFR_OK;
    }
    const double absolute = coarse * tolerance * nearest;
    gsl_odeiv2_driver *driver =
        gsl_odeiv2_driver_alloc_y_new(&system, types[method], first_try, absolute, coarse * tolerance);
    if (!driver) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %s of %zu unknowns", ssfr_flow_names[method], f->n);
    watch w = {.f = f, .control = driver->c, .eps = absolute, .again = coarse > 1,
               .flicker = coarse * report->time / flickers[method]};
    f->evaluations = f->jacobians = 0;
    advance(&w, driver, report->time, y, report);
    report->evaluations = f->evaluations;
    report->jacobians = f->jacobians;
    gsl_odeiv2_driver_free(driver);
    return SSFR_OK;
}

/* ---- the unknowns ------------------------------------------------------------------------------------------------ */

static void flow_finish(flow *f)
{
    free(f->pixel), free(f->unknown), free(f->cuts), free(f->due), free(f->quick), free(f->input), free(f->work);
    ssfr_field_destroy(&f->start);
    ssfr_field_destroy(&f->depth);
}

/* An image of the run's size: one pixel may stand for all. */
static void copy_depth(const ssfr_run *run, ssfr_field *depth)
{
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++) *ssfr_field_at(depth, x, y) = *ssfr_field_fetch(run->in[0], x, y);
}

static ssfr_result flow_init(flow *f, const ssfr_run *run)
{
    ssfr_result result = SSFR_OK;
    const size_t n_pixels = (size_t)run->w * (size_t)run->h;
    *f = (flow){.run = run};
    SSFR_TRY(ssfr_field_create(&f->depth, run->w, run->h, 1));
    SSFR_TRY(ssfr_field_create(&f->start, run->w, run->h, 1));
    copy_depth(run, f->depth);
    copy_depth(run, f->start);
    SSFR_TRY(ssfr_alloc(&f->unknown, n_pixels, sizeof *f->unknown, "the unknowns of a flow"));
    SSFR_TRY(ssfr_alloc(&f->pixel, n_pixels, sizeof *f->pixel, "the unknowns of a flow"));
    for (size_t i = 0; i < n_pixels; i++) {
        const bool is = ssfr_is_surface(f->depth->data[i]);
        f->unknown[i] = is ? (int)f->n : -1;
        if (is) f->pixel[f->n++] = (int)i;
    }
    SSFR_TRY(ssfr_alloc(&f->cuts, f->n, sizeof *f->cuts, "the unknowns of a flow"));
    SSFR_TRY(ssfr_alloc(&f->due, f->n, sizeof *f->due, "the unknowns of a flow"));
    SSFR_TRY(ssfr_alloc(&f->quick, f->n, sizeof *f->quick, "the unknowns of a flow"));
    SSFR_TRY(ssfr_alloc(&f->input, f->n, sizeof *f->input, "the unknowns of a flow"));
    SSFR_TRY(ssfr_alloc(&f->work, 3 * f->n, sizeof *f->work, "the unknowns of a flow"));
    for (size_t i = 0; i < f->n; i++) f->input[i] = f->depth->data[f->pixel[i]];
end:
    return result;
}

/* ---- the interface ----------------------------------------------------------------------------------------------- */

static ssfr_result check_size(const flow *f, ssfr_flow_method method)
{
    const int side = sides[method];
    if (f->n > (size_t)side * (size_t)side)
        return ssfr_fail(SSFR_ERR_VALUE, "%dx%d pixels, %zu with a surface: %s takes up to %dx%d", f->run->w, f->run->h,
                         f->n, ssfr_flow_names[method], side, side);
    return SSFR_OK;
}

static double difference(size_t n, const double *a, const double *b)
{
    double largest = 0;
    for (size_t i = 0; i < n; i++) largest = fmax(largest, fabs(a[i] - b[i]));
    return largest;
}

ssfr_result ssfr_flow_run(const ssfr_run *run, ssfr_flow_method method, double tolerance, ssfr_flow_report *report)
{
    ssfr_result result = SSFR_OK;
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    flow f = {0};
    double *y = NULL;
    ssfr_flow_report again;
    gsl_set_error_handler_off();
    SSFR_TRY(flow_init(&f, run));
    SSFR_TRY(check_size(&f, method));
    SSFR_TRY(ssfr_alloc(&y, 2 * f.n, sizeof *y, "the unknowns of a flow"));
    SSFR_TRY(solve(&f, method, tolerance, 1, y, report));
    SSFR_TRY(solve(&f, method, tolerance, 10, y + f.n, &again));
    ssfr_console_progress("flow", 1, 1);
    report->err = report->reached < report->time || again.reached < again.time ? (double)INFINITY
                                                                               : difference(f.n, y, y + f.n);
    report->time *= c->dt;
    report->reached *= c->dt;
    copy_depth(run, run->out[0]);
    place(&f, y, run->out[0]);
end:
    free(y);
    flow_finish(&f);
    return result;
}

ssfr_result ssfr_flow_jacobian(const ssfr_run *run, size_t *n, double **out)
{
    ssfr_result result = SSFR_OK;
    flow f = {0};
    *out = NULL;
    SSFR_TRY(flow_init(&f, run));
    SSFR_TRY(check_size(&f, SSFR_FLOW_MSBDF));
    SSFR_TRY(ssfr_alloc(out, f.n * f.n, sizeof **out, "a matrix of a flow"));
    for (size_t i = 0; i < f.n; i++) f.cuts[i] = cuts_of(&f, f.start, i);
    find_jacobian(&f, f.input, *out);
    *n = f.n;
end:
    flow_finish(&f);
    return result;
}

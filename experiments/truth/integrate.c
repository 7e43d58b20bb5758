/* SPDX-License-Identifier: GPL-3.0-or-later */
/* integrate.c: GSL's rules behind one call, with error estimates that include what rounding of their sums may do. */
#include "experiments/truth/integrate.h"

#include "experiments/truth/sum.h"

#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>
#include <pthread.h>

enum {
    MAX_POINTS = 64,        /* of gauss, a piece */
    MAX_STEPS = 1 << 24,
    ADAPTIVE_LIMIT = 2000,  /* pieces that qags and qagp may make, at least */
    PIECES_PER_BREAK = 3,   /* and for each break point: every piece may be halved, and some again */
    CQUAD_LIMIT = 2000,     /* pieces that cquad keeps; beyond that it gives up the best of them */
};

const ssfr_integrator ssfr_integrators[SSFR_N_INTEGRATORS] = {
#define X(name, help) {#name, help},
#include "experiments/truth/integrators.def"
#undef X
};

const char *const ssfr_integrator_names[] = {
#define X(name, help) #name,
#include "experiments/truth/integrators.def"
#undef X
    NULL};

struct ssfr_integration {
    gsl_integration_workspace *adaptive; /* these are made when they are first needed */
    size_t adaptive_capacity;            /* pieces */
    gsl_integration_cquad_workspace *cquad;
    gsl_integration_glfixed_table *gauss[MAX_POINTS + 1];
    ssfr_collocation *collocation[SSFR_COLLOCATION_MOST + 1];
    double *breaks; /* qagp wants to write to them */
    size_t breaks_capacity;
    void *room;
    size_t room_size; /* bytes */
};

/* ---- the function, counted and kept finite ----------------------------------------------------------------------- */

typedef struct counted {
    const ssfr_integrand *integrand;
    size_t n;
    bool finite;
} counted;

/* GSL's rules have no answer to NaN, some would look for it for ever: they see 0, and the caller learns of it. */
static double counted_value(double t, void *user)
{
    counted *f = user;
    const double value = f->integrand->value(t, f->integrand->user);
    f->n++;
    if (isfinite(value)) return value;
    f->finite = false;
    return 0;
}

/* ---- the rules --------------------------------------------------------------------------------------------------- */

/* Without any tolerance GSL refuses; this is the least that it takes. */
static double least_rel(const ssfr_integrate_params *params)
{
    return params->eps_abs > 0 ? params->eps_rel : fmax(params->eps_rel, 51 * DBL_EPSILON);
}

/* Room for as many pieces as the integrand's own break points allow. Where others before it took more, GSL must not
 * know: in what order it cuts depends on the work space's limit, too. */
static ssfr_result prepare_adaptive(ssfr_integration *work, const counted *f)
{
    ssfr_result result = SSFR_OK;
    const size_t limit = ADAPTIVE_LIMIT + PIECES_PER_BREAK * f->integrand->n_breaks;
    if (!work->adaptive || work->adaptive_capacity < limit) {
        gsl_integration_workspace_free(work->adaptive);
        work->adaptive = gsl_integration_workspace_alloc(2 * limit);
        work->adaptive_capacity = 2 * limit;
        if (!work->adaptive)
            SSFR_TRY(ssfr_fail(SSFR_ERR_MEMORY, "no memory to integrate over %zu pieces", 2 * limit));
    }
    work->adaptive->limit = limit;
end:
    return result;
}

/* What adding up the pieces, one after the other, may have rounded away. */
static double adaptive_rounding(const gsl_integration_workspace *adaptive)
{
    double size = 0;
    for (size_t i = 0; i < adaptive->size; i++) size += fabs(adaptive->rlist[i]);
    return 0.5 * DBL_EPSILON * (double)adaptive->size * size;
}

static ssfr_result run_qags(ssfr_integration *work, counted *f, const ssfr_integrate_params *params,
                            ssfr_integral *out)
{
    gsl_function function = {counted_value, f};
    const double *breaks = f->integrand->breaks;
    const size_t last = f->integrand->n_breaks - 1;
    ssfr_result result = SSFR_OK;
    SSFR_TRY(prepare_adaptive(work, f));
    /* Whatever code it ends with, the estimate of the error is what it got to. */
    gsl_integration_qags(&function, breaks[0], breaks[last], params->eps_abs, least_rel(params),
                         work->adaptive->limit, work->adaptive, &out->value, &out->err);
    out->err += adaptive_rounding(work->adaptive);
end:
    return result;
}

/* Each piece by itself. GSL's rule for many takes differences between pieces of unlike size for rounding and gives up;
 * the smaller error counts. */
static void run_each(ssfr_integration *work, counted *f, const ssfr_integrate_params *params, ssfr_integral *out)
{
    gsl_function function = {counted_value, f};
    const double *breaks = f->integrand->breaks;
    const size_t n = f->integrand->n_breaks - 1;
    const double eps_abs = fmax(params->eps_abs, params->eps_rel * fabs(out->value)) / (double)n;
    ssfr_sum total = {0};
    double err = 0;
    for (size_t i = 0; i < n; i++) {
        double value = 0, off = INFINITY;
        gsl_integration_qags(&function, breaks[i], breaks[i + 1], eps_abs, least_rel(params), work->adaptive->limit,
                             work->adaptive, &value, &off);
        err += off + adaptive_rounding(work->adaptive);
        ssfr_sum_add(&total, value);
    }
    if (!(err < out->err)) return;
    out->value = ssfr_sum_total(&total);
    out->err = err;
}

static ssfr_result run_qagp(ssfr_integration *work, counted *f, const ssfr_integrate_params *params,
                            ssfr_integral *out)
{
    gsl_function function = {counted_value, f};
    const size_t n = f->integrand->n_breaks;
    ssfr_result result = SSFR_OK;
    SSFR_TRY(prepare_adaptive(work, f));
    if (n > work->breaks_capacity) {
        free(work->breaks);
        work->breaks = NULL, work->breaks_capacity = 0;
        SSFR_TRY(ssfr_alloc(&work->breaks, 2 * n, sizeof *work->breaks, "break points"));
        work->breaks_capacity = 2 * n;
    }
    memcpy(work->breaks, f->integrand->breaks, n * sizeof *work->breaks);
    gsl_integration_qagp(&function, work->breaks, n, params->eps_abs, least_rel(params), work->adaptive->limit,
                         work->adaptive, &out->value, &out->err);
    out->err += adaptive_rounding(work->adaptive);
    if (!(out->err <= fmax(params->eps_abs, params->eps_rel * fabs(out->value)))) run_each(work, f, params, out);
end:
    return result;
}

/* Its success means nothing: it is also what it ends with when it missed the tolerance. Its estimate tells. What
 * stands between its points it does not see, and its estimate stays small: so it goes from break to break. */
static ssfr_result run_cquad(ssfr_integration *work, counted *f, const ssfr_integrate_params *params,
                             ssfr_integral *out)
{
    enum { POINTS = 16 }; /* fewest of a piece */
    gsl_function function = {counted_value, f};
    const double *breaks = f->integrand->breaks;
    ssfr_result result = SSFR_OK;
    if (!work->cquad) work->cquad = gsl_integration_cquad_workspace_alloc(CQUAD_LIMIT);
    if (!work->cquad) SSFR_TRY(ssfr_fail(SSFR_ERR_MEMORY, "no memory to integrate over %d pieces", CQUAD_LIMIT));
    const size_t n = f->integrand->n_breaks - 1;
    ssfr_sum total = {0};
    for (size_t i = 0; i < n; i++) {
        double value = 0, off = INFINITY;
        gsl_integration_cquad(&function, breaks[i], breaks[i + 1], params->eps_abs / (double)n, least_rel(params),
                              work->cquad, &value, &off, NULL);
        out->err += off;
        ssfr_sum_add(&total, value);
    }
    out->value = ssfr_sum_total(&total);
    out->err += DBL_EPSILON * (1 + (double)(f->n / POINTS)) * total.size;
end:
    return result;
}

static ssfr_result prepare_gauss(ssfr_integration *work, int points)
{
    if (work->gauss[points]) return SSFR_OK;
    work->gauss[points] = gsl_integration_glfixed_table_alloc((size_t)points);
    return work->gauss[points] ? SSFR_OK
                               : ssfr_fail(SSFR_ERR_MEMORY, "no memory for %d points of Gauss and Legendre", points);
}

/* What rounding may change: the sum by the digits of its terms, and of its places, which count as the function
 * varies. */
typedef struct samples {
    ssfr_sum terms;
    double last, variation;
    bool any;
} samples;

static void samples_add(samples *s, double value, double weight)
{
    s->variation += s->any ? fabs(value - s->last) : 0;
    s->last = value, s->any = true;
    ssfr_sum_add(&s->terms, weight * value);
}

static double samples_end(const samples *s, double a, double b, double *rounding)
{
    *rounding += DBL_EPSILON * (2 * s->terms.size + fmax(fabs(a), fabs(b)) * s->variation);
    return ssfr_sum_total(&s->terms);
}

static double gauss_piece(const gsl_integration_glfixed_table *table, counted *f, double a, double b, double *rounding)
{
    samples s = {0};
    for (size_t i = 0; i < table->n; i++) {
        double t, weight;
        gsl_integration_glfixed_point(a, b, i, &t, &weight, table);
        samples_add(&s, counted_value(t, f), weight);
    }
    return samples_end(&s, a, b, rounding);
}

static ssfr_result run_gauss(ssfr_integration *work, counted *f, const ssfr_integrate_params *params,
                             ssfr_integral *out)
{
    const int points = params->points, other = points > 1 ? points / 2 : 2; /* one point has no half */
    const double *breaks = f->integrand->breaks;
    ssfr_sum total = {0};
    double rounding = 0;
    ssfr_result result = SSFR_OK;
    SSFR_TRY(prepare_gauss(work, points));
    SSFR_TRY(prepare_gauss(work, other));
    for (size_t i = 0; i + 1 < f->integrand->n_breaks; i++) {
        const double fine = gauss_piece(work->gauss[points], f, breaks[i], breaks[i + 1], &rounding);
        const double coarse = gauss_piece(work->gauss[other], f, breaks[i], breaks[i + 1], &rounding);
        ssfr_sum_add(&total, fine);
        out->err += fabs(fine - coarse);
    }
    out->value = ssfr_sum_total(&total);
    out->err += rounding + 2 * DBL_EPSILON * fabs(out->value);
end:
    return result;
}

static double midpoints(counted *f, double a, double b, int n, double *rounding)
{
    const double step = (b - a) / n;
    samples s = {0};
    for (int i = 0; i < n; i++) samples_add(&s, counted_value(a + (i + 0.5) * step, f), step);
    return samples_end(&s, a, b, rounding);
}

static ssfr_result run_steps(ssfr_integration *work, counted *f, const ssfr_integrate_params *params,
                             ssfr_integral *out)
{
    (void)work;
    const int n = params->steps;
    const double a = f->integrand->breaks[0], b = f->integrand->breaks[f->integrand->n_breaks - 1];
    double rounding = 0;
    out->value = midpoints(f, a, b, n, &rounding);
    out->err = fabs(out->value - midpoints(f, a, b, n > 1 ? n / 2 : 2, &rounding)) + rounding;
    return SSFR_OK;
}

/* ------------------------------------------------------------------------------------------------------------------ */

typedef ssfr_result rule(ssfr_integration *work, counted *f, const ssfr_integrate_params *params, ssfr_integral *out);

static rule *const rules[SSFR_N_INTEGRATORS] = {
    [SSFR_INTEGRATOR_qags] = run_qags,   [SSFR_INTEGRATOR_qagp] = run_qagp,   [SSFR_INTEGRATOR_cquad] = run_cquad,
    [SSFR_INTEGRATOR_gauss] = run_gauss, [SSFR_INTEGRATOR_steps] = run_steps,
};

static ssfr_result check(ssfr_integrator_id id, const ssfr_integrand *integrand, const ssfr_integrate_params *params)
{
    if (id >= SSFR_N_INTEGRATORS || !rules[id])
        return ssfr_fail(SSFR_ERR_VALUE, "%s is no rule for functions",
                         id < SSFR_N_INTEGRATORS ? ssfr_integrators[id].name : "this");
    if (!(params->eps_abs >= 0 && params->eps_rel >= 0 && isfinite(params->eps_abs + params->eps_rel)))
        return ssfr_fail(SSFR_ERR_VALUE, "eps_abs %g and eps_rel %g: tolerances are not negative", params->eps_abs,
                         params->eps_rel);
    if (id == SSFR_INTEGRATOR_gauss && (params->points < 1 || params->points > MAX_POINTS))
        return ssfr_fail(SSFR_ERR_VALUE, "points %d: gauss has 1 to %d", params->points, MAX_POINTS);
    if (id == SSFR_INTEGRATOR_steps && (params->steps < 1 || params->steps > MAX_STEPS))
        return ssfr_fail(SSFR_ERR_VALUE, "steps %d: there are 1 to %d", params->steps, MAX_STEPS);
    if (integrand->n_breaks < 2)
        return ssfr_fail(SSFR_ERR_VALUE, "%zu break points: an integral has two ends", integrand->n_breaks);
    for (size_t i = 0; i + 1 < integrand->n_breaks; i++)
        if (!(integrand->breaks[i] <= integrand->breaks[i + 1] && isfinite(integrand->breaks[i]) &&
              isfinite(integrand->breaks[i + 1])))
            return ssfr_fail(SSFR_ERR_VALUE, "break points %zu and %zu are %g and %g: they rise and are finite", i,
                             i + 1, integrand->breaks[i], integrand->breaks[i + 1]);
    return SSFR_OK;
}

ssfr_result ssfr_integrate(ssfr_integration *work, ssfr_integrator_id id, const ssfr_integrand *integrand,
                           const ssfr_integrate_params *params, ssfr_integral *out)
{
    counted f = {integrand, 0, true};
    *out = (ssfr_integral){0};
    ssfr_result result = check(id, integrand, params);
    if (result != SSFR_OK) return result;
    if (integrand->breaks[0] < integrand->breaks[integrand->n_breaks - 1]) SSFR_TRY(rules[id](work, &f, params, out));
    out->evaluations = f.n;
    if (!isfinite(out->value)) out->value = 0, f.finite = false;
    if (!f.finite || !isfinite(out->err)) out->err = INFINITY;
    const double asked = fmax(params->eps_abs, params->eps_rel * fabs(out->value));
    out->converged = params->eps_abs + params->eps_rel > 0 && out->err <= asked;
end:
    return result;
}

/* ------------------------------------------------------------------------------------------------------------------ */

static void keep_gsl_from_aborting(void)
{
    gsl_set_error_handler_off();
}

ssfr_result ssfr_integration_create(ssfr_integration **out)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, keep_gsl_from_aborting);
    *out = NULL;
    return ssfr_alloc(out, 1, sizeof **out, "work space for integrals");
}

ssfr_result ssfr_integration_room(ssfr_integration *work, size_t n, size_t size, void *out)
{
    ssfr_result result = SSFR_OK;
    if (n > work->room_size / size) {
        free(work->room);
        work->room = NULL, work->room_size = 0;
        SSFR_TRY(ssfr_alloc(&work->room, 2 * n, size, "what an integrand is made of"));
        work->room_size = 2 * n * size;
    }
    memcpy(out, &work->room, sizeof work->room);
end:
    return result;
}

ssfr_result ssfr_integration_collocation(ssfr_integration *work, int n, const ssfr_collocation **out)
{
    ssfr_result result = SSFR_OK;
    ssfr_collocation *made = NULL;
    if (n < 1 || n > SSFR_COLLOCATION_MOST || !work->collocation[n]) {
        SSFR_TRY(ssfr_alloc(&made, 1, sizeof *made, "points of collocation"));
        SSFR_TRY(ssfr_collocation_init(made, n));
        work->collocation[n] = made;
        made = NULL;
    }
    *out = work->collocation[n];
end:
    free(made);
    return result;
}

void ssfr_integration_destroy(ssfr_integration **work)
{
    if (!*work) return;
    gsl_integration_workspace_free((*work)->adaptive);
    gsl_integration_cquad_workspace_free((*work)->cquad);
    for (int i = 0; i <= MAX_POINTS; i++)
        if ((*work)->gauss[i]) gsl_integration_glfixed_table_free((*work)->gauss[i]);
    for (int i = 0; i <= SSFR_COLLOCATION_MOST; i++) free((*work)->collocation[i]);
    free((*work)->room);
    free((*work)->breaks);
    free(*work);
    *work = NULL;
}

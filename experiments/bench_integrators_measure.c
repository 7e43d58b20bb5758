/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_integrators_measure.c: the integral along one ray by one rule: how wrong it is, how long it takes. */
#include "experiments/bench_integrators.h"

#include "experiments/truth/sum.h"

#include <float.h>

static const double batch = 2e-5;     /* s, the least that is timed at once: far above what reading the clock takes */
static const double ray_time = 2e-3;  /* s, timed of each ray, unless MIN_SAMPLES take longer */
static const double finest = 1e-14;   /* relative tolerance of references */
enum { MIN_SAMPLES = 5, MAX_SAMPLES = 25 };

/* ---- one integral ------------------------------------------------------------------------------------------------ */

/* A ray that was cast, and the rule for it. */
typedef struct job {
    ssfr_study_scene *scene;
    ssfr_study_integral integral;
    ssfr_line *line;
    double a, b; /* m */
    bool empty;  /* no kernel is met */
    ssfr_integrator_id id;
    ssfr_integrate_params params;
} job;

typedef struct outcome { /* in the integral's unit */
    double value[3], err;
    size_t evaluations;
} outcome;

static double density_at(double t, void *line)
{
    return ssfr_line_density(line, t);
}

static ssfr_result integrate_density(const job *j, outcome *out)
{
    ssfr_result result = SSFR_OK;
    const double unit = ssfr_study_unit(j->scene, j->integral), ends[] = {j->a, j->b};
    const bool between_breaks = j->id != SSFR_INTEGRATOR_qags && j->id != SSFR_INTEGRATOR_steps;
    ssfr_integrand integrand = {density_at, j->line, 2, ends};
    ssfr_integral integral = {0};
    if (j->id == SSFR_INTEGRATOR_chords) {
        integral.value = ssfr_line_chords(j->line, j->a, j->b, &integral.err);
    } else {
        if (between_breaks) SSFR_TRY(ssfr_line_breaks(j->line, j->a, j->b, &integrand.n_breaks, &integrand.breaks));
        SSFR_TRY(ssfr_integrate(j->scene->work, j->id, &integrand, &j->params, &integral));
    }
    *out = (outcome){{integral.value / unit}, integral.err / unit, integral.evaluations};
end:
    return result;
}

static ssfr_result integrate(const job *j, outcome *out)
{
    ssfr_result result = SSFR_OK;
    ssfr_radiance radiance;
    *out = (outcome){0};
    if (j->empty) return SSFR_OK;
    if (j->integral == SSFR_STUDY_DENSITY) return integrate_density(j, out);
    SSFR_TRY(ssfr_radiance_collect(&j->scene->foam, j->line, j->scene->work, j->id, &j->params, j->a, j->b, &radiance));
    *out = (outcome){.err = radiance.err, .evaluations = radiance.evaluations};
    memcpy(out->value, radiance.colour, sizeof out->value);
end:
    return result;
}

/* The setting is a tolerance, a number of points or of steps, as the rule has it. */
static ssfr_result job_init(job *j, ssfr_study_scene *scene, ssfr_study_integral integral, const ssfr_study_ray *ray,
                            ssfr_integrator_id id, double setting)
{
    ssfr_result result = SSFR_OK;
    const bool counts = id == SSFR_INTEGRATOR_gauss || id == SSFR_INTEGRATOR_steps;
    *j = (job){.scene = scene, .integral = integral, .line = &scene->lines[integral], .id = id};
    j->params = (ssfr_integrate_params){.eps_rel = counts || isnan(setting) ? 0 : setting,
                                        .points = id == SSFR_INTEGRATOR_gauss ? (int)setting : 1,
                                        .steps = id == SSFR_INTEGRATOR_steps ? (int)setting : 1};
    SSFR_TRY(ssfr_line_cast(j->line, &ray->ray, 0, INFINITY));
    j->empty = !ssfr_study_clip(j->line, &j->a, &j->b);
end:
    return result;
}

static double difference(const double a[3], const double b[3])
{
    return fmax(fabs(a[0] - b[0]), fmax(fabs(a[1] - b[1]), fabs(a[2] - b[2])));
}

/* ---- references -------------------------------------------------------------------------------------------------- */

typedef struct single {
    const ssfr_radial *radial; /* NULL for spheres */
    const ssfr_line_kernel *kernel;
} single;

static double single_at(double t, void *user)
{
    const single *s = user;
    const double along = t - s->kernel->middle;
    const double q = sqrt(s->kernel->near2 + s->kernel->stretch * along * along);
    return s->kernel->weight * (s->radial ? ssfr_radial_value(s->radial, q) : 1);
}

/* A kernel by itself, between the places where its pieces begin and where the ray is nearest to its middle. */
static ssfr_result integrate_single(ssfr_integration *work, const single *s, double *out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_line_kernel *k = s->kernel;
    const double half = k->near2 < 0.25 ? sqrt((0.25 - k->near2) / k->stretch) : 0; /* to q = 1/2 */
    const double breaks[] = {k->enters, k->middle - half, k->middle, k->middle + half, k->leaves};
    const ssfr_integrand integrand = {single_at, (void *)s, SSFR_COUNT(breaks), breaks};
    ssfr_integral integral;
    SSFR_TRY(ssfr_integrate(work, SSFR_INTEGRATOR_qagp, &integrand, &(ssfr_integrate_params){.eps_rel = finest},
                            &integral));
    *out = integral.value;
end:
    return result;
}

static ssfr_result refer_density(const job *j, ssfr_study_ray *ray)
{
    ssfr_result result = SSFR_OK;
    double one;
    ssfr_sum sum = {0};
    outcome closed;
    SSFR_TRY(integrate(j, &closed));
    for (size_t i = 0; i < j->line->n; i++) {
        SSFR_TRY(integrate_single(j->scene->work, &(single){j->scene->fluid.radial, &j->line->kernels[i]}, &one));
        ssfr_sum_add(&sum, one); /* as the closed form does */
    }
    memcpy(ray->reference, closed.value, sizeof ray->reference);
    ray->reference_err = fabs(ssfr_sum_total(&sum) / ssfr_study_unit(j->scene, j->integral) - closed.value[0]);
end:
    return result;
}

static ssfr_result refer_radiance(job *j, ssfr_study_ray *ray)
{
    ssfr_result result = SSFR_OK;
    outcome by_qagp, by_cquad;
    SSFR_TRY(integrate(j, &by_qagp));
    j->id = SSFR_INTEGRATOR_cquad;
    SSFR_TRY(integrate(j, &by_cquad));
    memcpy(ray->reference, by_qagp.value, sizeof ray->reference);
    ray->reference_err = difference(by_qagp.value, by_cquad.value);
end:
    return result;
}

ssfr_result ssfr_study_refer(ssfr_study_scene *scene, ssfr_study_integral integral, ssfr_study_ray *ray)
{
    ssfr_result result = SSFR_OK;
    const bool density = integral == SSFR_STUDY_DENSITY;
    job j;
    SSFR_TRY(job_init(&j, scene, integral, ray, density ? SSFR_INTEGRATOR_chords : SSFR_INTEGRATOR_qagp, finest));
    result = density ? refer_density(&j, ray) : refer_radiance(&j, ray);
end:
    return result;
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

typedef struct timed { /* us */
    double median, gathering;
    size_t runs;
} timed;

/* Medians of repeated runs; short ones are timed by the batch. */
static ssfr_result time_ray(const job *j, const ssfr_study_ray *ray, timed *out)
{
    ssfr_result result = SSFR_OK;
    double samples[MAX_SAMPLES], work[2 * MAX_SAMPLES];
    outcome unused;
    const double begun = ssfr_clock();
    SSFR_TRY(ssfr_line_cast(j->line, &ray->ray, 0, INFINITY));
    const double cast = ssfr_clock();
    SSFR_TRY(integrate(j, &unused));
    const double once = ssfr_clock() - cast;
    const size_t runs = (size_t)ssfr_clamp(ceil(batch / fmax(once, 1e-8)), 1, 1e4);
    size_t n = 0;
    for (double spent = 0; n < MAX_SAMPLES && (n < MIN_SAMPLES || spent < ray_time); n++) {
        const double from = ssfr_clock();
        for (size_t i = 0; i < runs; i++) SSFR_TRY(integrate(j, &unused));
        const double took = ssfr_clock() - from;
        samples[n] = 1e6 * took / (double)runs;
        spent += took;
    }
    *out = (timed){ssfr_timing_of(samples, 1, n, work).median, 1e6 * (cast - begun), n * runs};
end:
    return result;
}

/* What of each ray makes up a row. */
typedef struct columns {
    double time[SSFR_STUDY_RAYS], gathering[SSFR_STUDY_RAYS], error[SSFR_STUDY_RAYS], claimed[SSFR_STUDY_RAYS];
} columns;

static ssfr_result measure_ray(const job *j, const ssfr_study_ray *ray, size_t i, columns *c, ssfr_study_row *row)
{
    ssfr_result result = SSFR_OK;
    outcome got;
    timed time;
    SSFR_TRY(integrate(j, &got));
    SSFR_TRY(time_ray(j, ray, &time));
    const double off = difference(got.value, ray->reference);
    /* The closed form of the density is its own reference: what that may be off by is all that is known of it. */
    const bool itself = j->integral == SSFR_STUDY_DENSITY && j->id == SSFR_INTEGRATOR_chords;
    c->time[i] = time.median;
    c->gathering[i] = time.gathering;
    c->error[i] = fmax(off, fmax(ray->reference_err, DBL_EPSILON));
    c->claimed[i] = got.err;
    row->exceeded += itself ? ray->reference_err > got.err : off > got.err + ray->reference_err;
    row->runs += time.runs;
    row->evaluations += (double)got.evaluations;
    row->kernels += (double)ray->n_kernels;
    row->value += got.value[0];
    row->reference_err = fmax(row->reference_err, ray->reference_err);
end:
    return result;
}

static double largest(const double *v, size_t n)
{
    double most = v[0];
    for (size_t i = 1; i < n; i++) most = fmax(most, v[i]);
    return most;
}

static void finish_row(ssfr_study_row *row, const columns *c, size_t n, double *work)
{
    row->rays = n;
    row->time = ssfr_timing_of(c->time, 1, n, work);
    row->gathering = ssfr_timing_of(c->gathering, 1, n, work).median;
    row->error_max = largest(c->error, n);
    row->error_median = ssfr_timing_of(c->error, 1, n, work).median;
    row->claimed_max = largest(c->claimed, n);
    row->claimed_median = ssfr_timing_of(c->claimed, 1, n, work).median;
    row->exceeded /= (double)n;
    row->evaluations /= (double)n;
    row->kernels /= (double)n;
    row->value /= (double)n;
}

ssfr_result ssfr_study_measure(ssfr_study_scene *scene, ssfr_study_integral integral, size_t n,
                               const ssfr_study_ray *rays, ssfr_integrator_id id, double setting,
                               ssfr_study_row *out)
{
    ssfr_result result = SSFR_OK;
    columns c = {0};
    double work[2 * SSFR_STUDY_RAYS];
    *out = (ssfr_study_row){0};
    for (size_t i = 0; i < n; i++) {
        job j;
        SSFR_TRY(job_init(&j, scene, integral, &rays[i], id, setting));
        SSFR_TRY(measure_ray(&j, &rays[i], i, &c, out));
    }
    finish_row(out, &c, n, work);
end:
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure.c: timing a graph with robust statistics, and the copy bandwidth of the machine it runs on. */
#include "experiments/measure.h"
#include "gl/gl.h"

#include <epoxy/gl.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <omp.h>

enum { MAX_RUNS = 100000 };
static const double warm_up = 0.1;       /* of min_seconds */
static const double outlier_score = 3.5; /* Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993 */

/* ---- statistics -------------------------------------------------------------------------------------------------- */

/* The scale of the modified z-score: from the MAD, or where more than half of the samples are equal from the mean
 * absolute deviation, each made consistent with a normal distribution's standard deviation. */
static double robust_scale(const double *sorted, size_t n, double median, double mad)
{
    return mad > 0 ? mad / 0.6745 : 1.253314 * gsl_stats_absdev_m(sorted, 1, n, median);
}

ssfr_timing ssfr_timing_of(const double *samples, size_t stride, size_t n, double *work)
{
    ssfr_timing t = {.n = n, .min = NAN, .median = NAN, .mad = NAN};
    double *sorted = work;
    if (n == 0) return t;
    for (size_t i = 0; i < n; i++) sorted[i] = samples[i * stride];
    gsl_sort(sorted, 1, n);
    t.min = sorted[0];
    t.median = gsl_stats_median_from_sorted_data(sorted, 1, n);
    t.mad = gsl_stats_mad0(sorted, 1, n, work + n);
    const double scale = robust_scale(sorted, n, t.median, t.mad);
    for (size_t i = 0; i < n; i++) t.outliers += fabs(sorted[i] - t.median) > outlier_score * scale;
    return t;
}

double ssfr_measure_roofline(double ms, double bytes, double bandwidth)
{
    return bytes > 0 ? 1e-3 * ms / (bytes / bandwidth) : NAN;
}

/* ---- a graph ----------------------------------------------------------------------------------------------------- */

ssfr_measure_options ssfr_measure_defaults(bool quick)
{
    return quick ? (ssfr_measure_options){.min_runs = 3, .min_seconds = 0.2}
                 : (ssfr_measure_options){.min_runs = 10, .min_seconds = 1};
}

typedef struct samples { /* rows of one run: the frame, then its nodes, ms */
    size_t stride, n, capacity;
    double *values;
} samples;

static ssfr_result add_run(samples *s, const ssfr_report *report)
{
    if (s->n == s->capacity) {
        const size_t capacity = s->capacity ? 2 * s->capacity : 16;
        double *values = realloc(s->values, capacity * s->stride * sizeof *values);
        if (!values) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for the times of %zu runs", capacity);
        s->values = values;
        s->capacity = capacity;
    }
    double *row = s->values + s->n++ * s->stride;
    row[0] = report->wall_ms;
    for (size_t i = 1; i < s->stride; i++) row[i] = report->nodes[i - 1].ms;
    return SSFR_OK;
}

typedef struct trial { /* subjects that are measured together */
    int n;
    const ssfr_subject *subjects;
    const ssfr_scene *scene;
    const ssfr_measure_options *options;
    samples samples[SSFR_MAX_SUBJECTS];
} trial;

static ssfr_result run_subject(const trial *t, int k)
{
    ssfr_run_options run = t->subjects[k].run;
    run.timing = t->options->nodes;
    return ssfr_graph_run(t->subjects[k].graph, t->scene, &run);
}

/* All subjects once; in odd rounds the last is first. */
static ssfr_result run_round(trial *t, size_t round, bool timed)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < t->n; i++) {
        const int k = round % 2 ? t->n - 1 - i : i;
        SSFR_TRY(run_subject(t, k));
        if (timed) SSFR_TRY(add_run(&t->samples[k], ssfr_graph_report(t->subjects[k].graph)));
    }
end:
    return result;
}

static ssfr_result run_timed(trial *t)
{
    ssfr_result result = SSFR_OK;
    const ssfr_measure_options *o = t->options;
    const double cap = o->max_seconds > 0 ? o->max_seconds : INFINITY;
    const double begun = ssfr_clock();
    double now = begun;
    size_t n = 0;
    do {
        SSFR_TRY(run_round(t, 0, false));
        now = ssfr_clock();
    } while (now - begun < fmin(warm_up * o->min_seconds, cap));
    const double timed = now;
    do {
        SSFR_TRY(run_round(t, n++, true));
        now = ssfr_clock();
    } while (n < MAX_RUNS && now - begun < cap && (n < o->min_runs || now - timed < o->min_seconds));
end:
    return result;
}

static ssfr_result summarise(ssfr_measured *m, const samples *s, const ssfr_report *report)
{
    ssfr_result result = SSFR_OK;
    double *work = NULL;
    SSFR_TRY(ssfr_alloc(&work, 2 * s->n, sizeof *work, "sorted times"));
    SSFR_TRY(ssfr_alloc(&m->reports, (size_t)report->n_nodes, sizeof *m->reports, "node reports"));
    SSFR_TRY(ssfr_alloc(&m->nodes, (size_t)report->n_nodes, sizeof *m->nodes, "node times"));
    m->n_nodes = report->n_nodes;
    m->frame = ssfr_timing_of(s->values, s->stride, s->n, work);
    for (int i = 0; i < m->n_nodes; i++) {
        const ssfr_node_report *node = &report->nodes[i];
        const bool timed = node->status == SSFR_RAN && isfinite(node->ms);
        m->reports[i] = *node;
        m->nodes[i] = ssfr_timing_of(s->values + 1 + i, s->stride, !timed ? 0 : node->kept ? 1 : s->n, work);
        if (node->status != SSFR_RAN || node->kept) continue;
        m->taps += node->taps;
        m->iterations += node->iterations;
        m->vertices += node->vertices;
        m->bytes += node->bytes;
        m->tiles += node->tiles;
        m->unstable += node->unstable;
    }
end:
    free(work);
    return result;
}

/* Of the frames' times alone. */
static ssfr_result compare_pairs(const samples *first, const samples *second, ssfr_paired *out)
{
    ssfr_result result = SSFR_OK;
    const size_t n = first->n;
    double *work = NULL;
    SSFR_TRY(ssfr_alloc(&work, 4 * n, sizeof *work, "differences of times"));
    double *const saved = work, *const ratios = work + n;
    for (size_t i = 0; i < n; i++) {
        const double a = first->values[i * first->stride], b = second->values[i * second->stride];
        saved[i] = b - a;
        ratios[i] = a / b;
    }
    const ssfr_timing ratio = ssfr_timing_of(ratios, 1, n, work + 2 * n);
    *out = (ssfr_paired){ssfr_timing_of(saved, 1, n, work + 2 * n).median, ratio.median, ratio.mad};
end:
    free(work);
    return result;
}

ssfr_result ssfr_measure_subjects(ssfr_measured **out, ssfr_paired *paired, int n, const ssfr_subject *subjects,
                                  const ssfr_scene *scene, const ssfr_measure_options *options)
{
    ssfr_result result = SSFR_OK;
    trial t = {.n = n, .subjects = subjects, .scene = scene, .options = options};
    for (int k = 0; k < n; k++) out[k] = NULL;
    *paired = (ssfr_paired){NAN, NAN, NAN};
    for (int k = 0; k < n; k++) {
        SSFR_TRY(run_subject(&t, k));
        t.samples[k].stride = 1 + (size_t)ssfr_graph_report(subjects[k].graph)->n_nodes;
    }
    SSFR_TRY(run_timed(&t));
    for (int k = 0; k < n; k++) {
        SSFR_TRY(ssfr_alloc(&out[k], 1, sizeof **out, "a measurement"));
        SSFR_TRY(summarise(out[k], &t.samples[k], ssfr_graph_report(subjects[k].graph)));
    }
    if (n == 2) SSFR_TRY(compare_pairs(&t.samples[0], &t.samples[1], paired));
end:
    for (int k = 0; k < n; k++) {
        free(t.samples[k].values);
        if (result != SSFR_OK) ssfr_measured_destroy(&out[k]);
    }
    return result;
}

ssfr_result ssfr_measure_graph(ssfr_measured **out, ssfr_graph *graph, const ssfr_scene *scene,
                               const ssfr_measure_options *options)
{
    ssfr_paired none;
    return ssfr_measure_subjects(out, &none, 1, &(ssfr_subject){.graph = graph}, scene, options);
}

void ssfr_measured_destroy(ssfr_measured **measured)
{
    if (*measured) {
        free((*measured)->reports);
        free((*measured)->nodes);
    }
    free(*measured);
    *measured = NULL;
}

/* ---- copy bandwidth ---------------------------------------------------------------------------------------------- */

enum { COPY_REPEATS = 8, COPY_BATCH = 8, COPY_SIDE = 4096 /* px */ };
static const size_t copy_size = (size_t)128 << 20; /* bytes; larger than caches */

/* Each thread copies its own part, which it also touched first. */
static double copy_memory(char *to, const char *from)
{
    const double begun = ssfr_clock();
#pragma omp parallel
    {
        const size_t n = (size_t)omp_get_num_threads(), i = (size_t)omp_get_thread_num();
        const size_t first = copy_size / n * i, last = i + 1 == n ? copy_size : copy_size / n * (i + 1);
        memcpy(to + first, from + first, last - first);
    }
    return 2.0 * (double)copy_size / (ssfr_clock() - begun);
}

/* One is always timed. */
static bool may_repeat(int i, double begun, double max_seconds)
{
    return i < COPY_REPEATS && (i == 0 || max_seconds == 0 || ssfr_clock() - begun < max_seconds);
}

static double memory_bandwidth(double max_seconds)
{
    double best = NAN;
    char *from = NULL, *to = NULL;
    if (ssfr_alloc(&from, copy_size, 1, "a copy") == SSFR_OK && ssfr_alloc(&to, copy_size, 1, "a copy") == SSFR_OK) {
        copy_memory(from, to); /* touches the pages */
        const double begun = ssfr_clock();
        for (int i = 0; may_repeat(i, begun, max_seconds); i++) best = fmax(best, copy_memory(to, from));
    }
    free(from);
    free(to);
    return best;
}

/* Several copies between two waits, so that the cost of waiting does not count. */
static double copy_texture(const ssfr_texture *to, const ssfr_texture *from)
{
    glFinish();
    const double begun = ssfr_clock();
    for (int i = 0; i < COPY_BATCH; i++)
        glCopyImageSubData(from->name, GL_TEXTURE_2D, 0, 0, 0, 0, to->name, GL_TEXTURE_2D, 0, 0, 0, 0, from->w, from->h,
                           1);
    glFinish();
    const double bytes = (double)from->w * from->h * from->c * sizeof(float);
    return 2.0 * COPY_BATCH * bytes / (ssfr_clock() - begun);
}

static double texture_bandwidth(ssfr_gl *gl, double max_seconds)
{
    ssfr_result result = SSFR_OK;
    ssfr_texture from = {0}, to = {0};
    const float grey[4] = {0.5f, 0.5f, 0.5f, 0.5f};
    double best = NAN;
    if (ssfr_gl_begin(gl) != SSFR_OK) return NAN;
    const int side = ssfr_min_int(COPY_SIDE, ssfr_gl_get_limits(gl)->texture_px);
    SSFR_TRY(ssfr_texture_create(gl, &from, side, side, 4, SSFR_STORE_FLOAT));
    SSFR_TRY(ssfr_texture_create(gl, &to, side, side, 4, SSFR_STORE_FLOAT));
    ssfr_texture_clear(&from, grey);
    copy_texture(&to, &from);
    const double begun = ssfr_clock();
    for (int i = 0; may_repeat(i, begun, max_seconds); i++) best = fmax(best, copy_texture(&to, &from));
end:
    ssfr_texture_finish(&from);
    ssfr_texture_finish(&to);
    return ssfr_gl_end(gl, result) == SSFR_OK ? best : NAN;
}

double ssfr_measure_copy_bandwidth(ssfr_gl *gl, double max_seconds)
{
    return gl && !ssfr_gl_is_software(gl) ? texture_bandwidth(gl, max_seconds) : memory_bandwidth(max_seconds);
}

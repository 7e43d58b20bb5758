/* SPDX-License-Identifier: MIT */
/* flip.c: LDR-FLIP (Andersson et al. 2020): filters of contrast sensitivity, colour distances, edges and points. */
#include "metrics/flip.h"
#include "metrics/run.h"
#include "metrics/tally.h"

#include <omp.h>

enum { MAX_PPD = 1000, MAX_RADIUS = 136 }; /* px, filters reach 0.135 ppd */

/* The exponents q_c and q_f of colour and feature differences; p_c of the largest colour difference goes to p_t. */
static const double q_c = 0.7, q_f = 0.5, p_c = 0.4, p_t = 0.95;
static const double feature_width = 0.082; /* deg, w: from peak to trough of the edge detector */

/* ---- filters: products of one down and one across --------------------------------------------------------------- */

typedef enum kernel_id { ACHROMATIC, RED_GREEN, BLUE_YELLOW, BLUE_YELLOW_2, SMOOTH, EDGE, POINT, N_KERNELS } kernel_id;

typedef struct kernel {
    int radius;                    /* px */
    double sign;                   /* -1 for an odd kernel */
    double weight[MAX_RADIUS + 1]; /* at 0, 1, ... px; sign times that to the other side */
} kernel;

/* Johnson and Fairchild 2003, made low-pass: the sensitivity a exp(-b f^2) to f cycles per degree, in space
 * a sqrt(pi / b) exp(-pi^2 x^2 / b). That to blue and yellow is a sum of two. */
typedef struct sensitivity {
    double a, b; /* 1, deg^2 */
} sensitivity;

static const sensitivity sensitivities[] = {
    [ACHROMATIC] = {1, 0.0047}, [RED_GREEN] = {1, 0.0053},
    [BLUE_YELLOW] = {34.1, 0.04}, [BLUE_YELLOW_2] = {13.5, 0.025},
};

/* The weights' square is the sensitivity in the plane, but for a factor. */
static void set_sensitivity(kernel *k, const sensitivity *s, double ppd)
{
    const double widest = sensitivities[BLUE_YELLOW].b;
    k->sign = 1;
    k->radius = (int)ceil(3 * sqrt(widest / 2) / M_PI * ppd);
    for (int i = 0; i <= k->radius; i++)
        k->weight[i] = sqrt(s->a * sqrt(M_PI / s->b)) * exp(-ssfr_square(M_PI * i / ppd) / s->b);
}

/* The sum over the plane of the sum of n even kernels' squares becomes 1. */
static void normalize(kernel *k, int n)
{
    double total = 0;
    for (int j = 0; j < n; j++) {
        double sum = k[j].weight[0];
        for (int i = 1; i <= k[j].radius; i++) sum += 2 * k[j].weight[i];
        total += sum * sum;
    }
    for (int j = 0; j < n; j++)
        for (int i = 0; i <= k[j].radius; i++) k[j].weight[i] /= sqrt(total);
}

/* A Gaussian, its first and its second derivative; positive weights of these sum to 1, negative ones to -1. */
static void set_features(kernel *k, double ppd)
{
    const double sd = feature_width / 2 * ppd;
    const int radius = (int)ceil(3 * sd);
    double rising = 0, positive = 0, negative = 0;
    k[SMOOTH] = (kernel){.radius = radius, .sign = 1};
    k[EDGE] = (kernel){.radius = radius, .sign = -1};
    k[POINT] = (kernel){.radius = radius, .sign = 1};
    for (int i = 0; i <= radius; i++) {
        const double u = i / sd, g = exp(-u * u / 2), point = (u * u - 1) * g;
        k[SMOOTH].weight[i] = g;
        rising += k[EDGE].weight[i] = u * g;
        k[POINT].weight[i] = point;
        *(point > 0 ? &positive : &negative) += (i ? 2 : 1) * fabs(point);
    }
    for (int i = 0; i <= radius; i++) {
        k[EDGE].weight[i] /= rising;
        k[POINT].weight[i] /= k[POINT].weight[i] > 0 ? positive : negative;
    }
}

static void set_kernels(kernel *k, double ppd)
{
    for (int id = ACHROMATIC; id <= BLUE_YELLOW_2; id++) set_sensitivity(&k[id], &sensitivities[id], ppd);
    set_features(k, ppd);
    normalize(&k[ACHROMATIC], 1);
    normalize(&k[RED_GREEN], 1);
    normalize(&k[BLUE_YELLOW], 2);
    normalize(&k[SMOOTH], 1);
}

/* ---- colours ----------------------------------------------------------------------------------------------------- */

typedef struct observer {
    kernel kernels[N_KERNELS];
    double rgb_from_xyz[3][3];
    double farthest; /* colour difference of green and blue, the largest there is */
} observer;

/* Linear sRGB to XYZ over that of white: the primaries of IEC 61966-2-1, white at x = 0.31271, y = 0.32902, which the
 * authors' matrix stands for. */
static const double xyz_from_rgb[3][3] = {
    {10135552 / 23359437.0, 8788810 / 23359437.0, 4435075 / 23359437.0},
    {2613072 / 12288897.0, 8788810 / 12288897.0, 887015 / 12288897.0},
    {1425312 / 80288307.0, 8788810 / 80288307.0, 70074185 / 80288307.0},
};

static void transform(const double m[3][3], const double v[3], double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = ssfr_dot(m[i], v);
}

static void invert(const double m[3][3], double out[3][3])
{
    for (int j = 0; j < 3; j++) {
        double column[3];
        ssfr_cross(m[(j + 1) % 3], m[(j + 2) % 3], column);
        for (int i = 0; i < 3; i++) out[i][j] = column[i] / ssfr_dot(m[j], column);
    }
}

/* YCxCz: as CIELAB, but linear, so that it may be filtered. */
static void opponent_from_rgb(const double rgb[3], double out[3])
{
    double xyz[3];
    transform(xyz_from_rgb, rgb, xyz);
    out[0] = 116 * xyz[1] - 16;
    out[1] = 500 * (xyz[0] - xyz[1]);
    out[2] = 200 * (xyz[1] - xyz[2]);
}

/* Out of gamut is clamped. */
static void rgb_from_opponent(const observer *o, const double opponent[3], double out[3])
{
    const double y = (opponent[0] + 16) / 116;
    const double xyz[3] = {y + opponent[1] / 500, y, y - opponent[2] / 200};
    transform(o->rgb_from_xyz, xyz, out);
    for (int i = 0; i < 3; i++) out[i] = ssfr_clamp(out[i], 0, 1);
}

static double cie_root(double t)
{
    const double delta = 6.0 / 29;
    return t > delta * delta * delta ? cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
}

/* CIELAB with Hunt's effect: the darker, the less colourful. */
static void hunt_lab_from_rgb(const double rgb[3], double out[3])
{
    double xyz[3];
    transform(xyz_from_rgb, rgb, xyz);
    for (int i = 0; i < 3; i++) xyz[i] = cie_root(xyz[i]);
    out[0] = 116 * xyz[1] - 16;
    out[1] = 0.01 * out[0] * 500 * (xyz[0] - xyz[1]);
    out[2] = 0.01 * out[0] * 200 * (xyz[1] - xyz[2]);
}

/* HyAB (Abasi et al. 2020), a distance that holds for colours far apart, to the power q_c. */
static double colour_difference(const double rgb_a[3], const double rgb_b[3])
{
    double a[3], b[3];
    hunt_lab_from_rgb(rgb_a, a);
    hunt_lab_from_rgb(rgb_b, b);
    return pow(fabs(a[0] - b[0]) + sqrt(ssfr_square(a[1] - b[1]) + ssfr_square(a[2] - b[2])), q_c);
}

/* To [0, 1], most of it for differences up to p_c of the largest. */
static double redistribute(double difference, double farthest)
{
    const double knee = p_c * farthest;
    return difference < knee ? difference * p_t / knee
                             : p_t + (difference - knee) / (farthest - knee) * (1 - p_t);
}

static void set_observer(observer *o, double ppd)
{
    static const double green[] = {0, 1, 0}, blue[] = {0, 0, 1};
    set_kernels(o->kernels, ppd);
    invert(xyz_from_rgb, o->rgb_from_xyz);
    o->farthest = colour_difference(green, blue);
}

/* ---- a row at a time --------------------------------------------------------------------------------------------- */

/* What is filtered out of YCxCz, each by a kernel down and one across. */
enum { LIGHT, REDNESS, YELLOWNESS, YELLOWNESS_2, EDGE_ACROSS, EDGE_DOWN, POINT_ACROSS, POINT_DOWN, N_RESPONSES };

static const struct {
    int channel;
    kernel_id down, across;
} responses[N_RESPONSES] = {
    [LIGHT] = {0, ACHROMATIC, ACHROMATIC},         [REDNESS] = {1, RED_GREEN, RED_GREEN},
    [YELLOWNESS] = {2, BLUE_YELLOW, BLUE_YELLOW},  [YELLOWNESS_2] = {2, BLUE_YELLOW_2, BLUE_YELLOW_2},
    [EDGE_ACROSS] = {0, SMOOTH, EDGE},             [EDGE_DOWN] = {0, EDGE, SMOOTH},
    [POINT_ACROSS] = {0, SMOOTH, POINT},           [POINT_DOWN] = {0, POINT, SMOOTH},
};

typedef struct work {
    observer observer;
    int w, h;
    double *planes[2]; /* of a and of b: Y, Cx, Cz */
    double *scratch;
    size_t stride; /* doubles of scratch a thread */
} work;

static void start(double weight, const double *centre, int n, double *out)
{
#pragma omp simd
    for (int x = 0; x < n; x++) out[x] = weight * centre[x];
}

static void add(double weight, double sign, const double *before, const double *after, int n, double *out)
{
#pragma omp simd
    for (int x = 0; x < n; x++) out[x] += weight * (after[x] + sign * before[x]);
}

/* The image's border is repeated outside it. */
static void filter_down(const kernel *k, const double *plane, int w, int h, int y, double *out)
{
    const size_t row = (size_t)w;
    start(k->weight[0], plane + (size_t)y * row, w, out);
    for (int i = 1; i <= k->radius; i++)
        add(k->weight[i], k->sign, plane + (size_t)ssfr_max_int(y - i, 0) * row,
            plane + (size_t)ssfr_min_int(y + i, h - 1) * row, w, out);
}

/* `middle` has room for the kernel's radius on both sides. */
static void filter_across(const kernel *k, double *middle, int w, double *out)
{
    for (int i = 1; i <= k->radius; i++) middle[-i] = middle[0], middle[w - 1 + i] = middle[w - 1];
    start(k->weight[0], middle, w, out);
    for (int i = 1; i <= k->radius; i++) add(k->weight[i], k->sign, middle - i, middle + i, w, out);
}

/* Responses of one row, each w values. */
static void respond(const work *job, const double *planes, int y, double *middle, double *out)
{
    const size_t w = (size_t)job->w, n = w * (size_t)job->h;
    for (int i = 0; i < N_RESPONSES; i++) {
        const kernel *down = &job->observer.kernels[responses[i].down];
        filter_down(down, planes + (size_t)responses[i].channel * n, job->w, job->h, y, middle);
        filter_across(&job->observer.kernels[responses[i].across], middle, job->w, out + (size_t)i * w);
    }
}

/* Of light in [0, 1], which Y is 116 times of. */
static double feature(double across, double down)
{
    return sqrt(across * across + down * down) / 116;
}

static double error_of(const observer *o, const double *a, const double *b)
{
    const double opponent_a[] = {a[LIGHT], a[REDNESS], a[YELLOWNESS] + a[YELLOWNESS_2]};
    const double opponent_b[] = {b[LIGHT], b[REDNESS], b[YELLOWNESS] + b[YELLOWNESS_2]};
    const double edge = feature(a[EDGE_ACROSS], a[EDGE_DOWN]) - feature(b[EDGE_ACROSS], b[EDGE_DOWN]);
    const double point = feature(a[POINT_ACROSS], a[POINT_DOWN]) - feature(b[POINT_ACROSS], b[POINT_DOWN]);
    const double features = pow(ssfr_tally_larger(fabs(edge), fabs(point)) / M_SQRT2, q_f);
    double rgb_a[3], rgb_b[3];
    rgb_from_opponent(o, opponent_a, rgb_a);
    rgb_from_opponent(o, opponent_b, rgb_b);
    return pow(redistribute(colour_difference(rgb_a, rgb_b), o->farthest), 1 - features);
}

static void measure_row(const work *job, int y, double *scratch, double *out)
{
    const size_t w = (size_t)job->w;
    double *rows[2] = {scratch, scratch + N_RESPONSES * w}, *middle = scratch + 2 * N_RESPONSES * w + MAX_RADIUS;
    for (int i = 0; i < 2; i++) respond(job, job->planes[i], y, middle, rows[i]);
    for (size_t x = 0; x < w; x++) {
        double a[N_RESPONSES], b[N_RESPONSES];
        for (size_t i = 0; i < N_RESPONSES; i++) a[i] = rows[0][i * w + x], b[i] = rows[1][i * w + x];
        out[x] = error_of(&job->observer, a, b);
    }
}

/* ---- maps -------------------------------------------------------------------------------------------------------- */

static void fill_planes(const ssfr_field *image, double *planes)
{
    const size_t n = (size_t)image->w * (size_t)image->h;
#pragma omp parallel for schedule(static)
    for (int y = 0; y < image->h; y++)
        for (int x = 0; x < image->w; x++) {
            const double *value = ssfr_field_at(image, x, y);
            double rgb[3], opponent[3];
            for (int k = 0; k < 3; k++) rgb[k] = ssfr_clamp(value[image->c == 1 ? 0 : k], 0, 1);
            opponent_from_rgb(rgb, opponent);
            for (size_t k = 0; k < 3; k++) planes[k * n + (size_t)y * (size_t)image->w + (size_t)x] = opponent[k];
        }
}

ssfr_result ssfr_flip_map(const ssfr_pair *pair, double ppd, ssfr_field **out)
{
    ssfr_result result = SSFR_OK;
    work *job = NULL;
    ssfr_field *map = NULL;
    const int w = pair->b->w, h = pair->b->h, n_threads = ssfr_min_int(omp_get_max_threads(), h);
    *out = NULL;
    if (!(ppd >= 1 && ppd <= MAX_PPD))
        return ssfr_fail(SSFR_ERR_VALUE, "flip: %g pixels per degree, 1 to %d are measured", ppd, MAX_PPD);
    SSFR_TRY(ssfr_pair_check(pair, "flip", SSFR_METRIC_COLOUR));
    SSFR_TRY(ssfr_field_create(&map, w, h, 1));
    SSFR_TRY(ssfr_alloc(&job, 1, sizeof *job, "FLIP"));
    *job = (work){.w = w, .h = h, .stride = 2 * (N_RESPONSES * (size_t)w + MAX_RADIUS) + (size_t)w};
    for (int i = 0; i < 2; i++)
        SSFR_TRY(ssfr_alloc(&job->planes[i], 3 * (size_t)w * (size_t)h, sizeof *job->planes[i], "opponent colours"));
    SSFR_TRY(ssfr_alloc(&job->scratch, (size_t)n_threads * job->stride, sizeof *job->scratch, "filtered rows"));
    set_observer(&job->observer, ppd);
    fill_planes(pair->a, job->planes[0]);
    fill_planes(pair->b, job->planes[1]);
#pragma omp parallel for schedule(static) num_threads(n_threads)
    for (int y = 0; y < h; y++)
        measure_row(job, y, job->scratch + (size_t)omp_get_thread_num() * job->stride, ssfr_field_at(map, 0, y));
    *out = map;
    map = NULL;
end:
    if (job) {
        for (int i = 0; i < 2; i++) free(job->planes[i]);
        free(job->scratch);
    }
    free(job);
    ssfr_field_destroy(&map);
    return result;
}

ssfr_result ssfr_metric_run_flip(const ssfr_pair *pair, double *out)
{
    ssfr_field *map = NULL;
    ssfr_result result = ssfr_flip_map(pair, SSFR_FLIP_PPD, &map);
    if (result == SSFR_OK) result = ssfr_tally_map(map, pair->mask, out);
    ssfr_field_destroy(&map);
    return result;
}

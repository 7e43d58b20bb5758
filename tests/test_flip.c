/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_flip.c: FLIP against values of its authors' tool, against its definition written down plainly, and by hand. */
#include "tests/util.h"

#include "image/srgb.h"
#include "metrics/flip.h"
#include "metrics/metrics.h"

#include <float.h>
#include <omp.h>

static ssfr_field *make_colour(int w, int h, const double rgb[3])
{
    ssfr_field *field = test_image(w, h, 3, 0);
    for (int i = 0; i < w * h * 3; i++) field->data[i] = rgb[i % 3];
    return field;
}

static ssfr_field *make_random(int w, int h, int c, uint64_t seed)
{
    ssfr_field *field = test_image(w, h, c, 0);
    for (int i = 0; i < w * h * c; i++) field->data[i] = test_random(&seed, 0, 1);
    return field;
}

static double measure_masked(const char *name, const ssfr_field *a, const ssfr_field *b, const ssfr_field *mask)
{
    double value = -2.385;
    assert_int_equal(ssfr_metric_measure(ssfr_metric_find(name), a, b, mask, &value), SSFR_OK);
    return value;
}

static double measure(const char *name, const ssfr_field *a, const ssfr_field *b)
{
    return measure_masked(name, a, b, NULL);
}

static ssfr_field *map_of(const ssfr_field *a, const ssfr_field *b, double ppd)
{
    ssfr_field *map = NULL;
    assert_int_equal(ssfr_flip_map(&(ssfr_pair){.a = a, .b = b}, ppd, &map), SSFR_OK);
    assert_true(map->w == a->w && map->h == a->h && map->c == 1);
    return map;
}

static ssfr_field *hdr_map_of(const ssfr_field *a, const ssfr_field *b, ssfr_flip_tone tone,
                              ssfr_flip_exposures exposures)
{
    ssfr_field *map = NULL;
    const ssfr_pair pair = {.a = a, .b = b};
    assert_int_equal(ssfr_flip_hdr_map(&pair, SSFR_FLIP_PPD, tone, &exposures, &map), SSFR_OK);
    return map;
}

static ssfr_flip_exposures exposures_of(const ssfr_field *b, const ssfr_field *mask, ssfr_flip_tone tone)
{
    ssfr_flip_exposures exposures;
    assert_int_equal(ssfr_flip_expose(&(ssfr_pair){.a = b, .b = b, .mask = mask}, tone, &exposures), SSFR_OK);
    return exposures;
}

/* ---- the authors' tool ------------------------------------------------------------------------------------------- */

static ssfr_field *load(const char *folder, const char *name)
{
    char path[1024];
    ssfr_field *field = NULL;
    snprintf(path, sizeof path, "%s/flip/%s", folder, name);
    if (strstr(name, ".exr")) assert_int_equal(ssfr_exr_load(path, "R,G,B", &field), SSFR_OK);
    else assert_int_equal(ssfr_png_load(path, &field), SSFR_OK);
    return field;
}

/* What the tool says of a map. It adds in float, row by row: a mean of 64000 values then has four digits, but added in
 * the same way maps that are right give all six that it prints. */
typedef struct said {
    double mean, weighted_median, q1, q3, min, max;
} said;

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The value below which lies this share of the sum of the sorted values. */
static double weighted_quantile(const float *sorted, int n, float share, float sum)
{
    float so_far = 0;
    for (int i = 0; i < n; i++)
        if ((so_far += sorted[i]) > share * sum) return (double)sorted[i];
    return 0;
}

static said say(const ssfr_field *map)
{
    const int n = map->w * map->h;
    float sum = 0, *values = malloc((size_t)n * sizeof *values);
    assert_non_null(values);
    for (int i = 0; i < n; i++) sum += values[i] = (float)map->data[i];
    qsort(values, (size_t)n, sizeof *values, compare_floats);
    const said s = {(double)(sum / (float)n), weighted_quantile(values, n, 0.5F, sum),
                    weighted_quantile(values, n, 0.25F, sum), weighted_quantile(values, n, 0.75F, sum),
                    (double)values[0], (double)values[n - 1]};
    free(values);
    return s;
}

static double mean_of(const ssfr_field *map)
{
    double sum = 0;
    for (int i = 0; i < map->w * map->h; i++) sum += map->data[i];
    return sum / (map->w * map->h);
}

static void assert_said(const char *test, const ssfr_field *map, const said *expected)
{
    const said s = say(map);
    const double got[] = {s.mean, s.weighted_median, s.q1, s.q3, s.min, s.max};
    const double want[] = {expected->mean, expected->weighted_median, expected->q1,
                           expected->q3,   expected->min,             expected->max};
    static const double eps[] = {1e-6, 5e-6, 5e-6, 5e-6, 5e-6, 5e-6}; /* of single pixels, which are floats there */
    for (int i = 0; i < 6; i++)
        if (!(fabs(got[i] - want[i]) <= eps[i])) fail_msg("%s: number %d is %.7f, not %.6f", test, i, got[i], want[i]);
    assert_close(mean_of(map), expected->mean, 2e-5, 0);
}

/* The tool's own map, a PNG of 255 times the error. */
static void assert_map(const char *folder, const char *name, const ssfr_field *map)
{
    ssfr_field *expected = load(folder, name);
    int n_off = 0;
    for (int i = 0; i < map->w * map->h; i++) {
        const long is = lround(255 * map->data[i]), should = lround(255 * ssfr_srgb_encode(expected->data[3 * i]));
        if (labs(is - should) > 1) fail_msg("%s: pixel %d is %ld / 255, not %ld", name, i, is, should);
        n_off += is != should;
    }
    assert_true(n_off < map->w * map->h / 1000); /* those between two steps */
    ssfr_field_destroy(&expected);
}

static void check_row(const char *folder, const char *line)
{
    char reference[64], test[64], kind[8], map_name[64] = "";
    double ppd;
    said s;
    const int n = sscanf(line, "%63[^,],%63[^,],%7[^,],%lf,%lf,%lf,%lf,%lf,%lf,%lf,%63s", reference, test, kind, &ppd,
                         &s.mean, &s.weighted_median, &s.q1, &s.q3, &s.min, &s.max, map_name);
    assert_true(n == 10 || n == 11);
    assert_close(ppd, SSFR_FLIP_PPD, 0.5, 0); /* the tool prints no digits of it */
    ssfr_field *a = load(folder, test), *b = load(folder, reference);
    const bool hdr = strcmp(kind, "HDR") == 0;
    ssfr_field *map = hdr ? hdr_map_of(a, b, SSFR_FLIP_ACES, exposures_of(b, NULL, SSFR_FLIP_ACES))
                          : map_of(a, b, SSFR_FLIP_PPD);
    assert_said(test, map, &s);
    assert_close(measure(hdr ? "flip_hdr" : "flip", a, b), mean_of(map), 0, 1e-12);
    if (n == 11) assert_map(folder, map_name, map);
    ssfr_field_destroy(&map);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

static void values_are_those_of_the_authors_tool(void **state)
{
    (void)state;
    const char *folder = test_data_or_skip();
    char path[1024], *text = NULL;
    size_t size = 0;
    int n = 0;
    snprintf(path, sizeof path, "%s/flip/expected.csv", folder);
    assert_int_equal(ssfr_read_file(path, 1 << 20, &text, &size), SSFR_OK);
    char *line = strtok(text, "\n");
    for (assert_non_null(strstr(line, "weighted_median,q1,q3,min,max,map")); (line = strtok(NULL, "\n")); n++)
        check_row(folder, line);
    assert_int_equal(n, 6);
    free(text);
}

static void exposures_are_those_of_the_authors_tool(void **state)
{
    (void)state;
    ssfr_field *b = load(test_data_or_skip(), "hdr_ref.exr");
    const ssfr_flip_exposures e = exposures_of(b, NULL, SSFR_FLIP_ACES);
    assert_close(e.start, -3.8191, 5e-5, 0);
    assert_close(e.stop, 3.0951, 5e-5, 0);
    assert_int_equal(e.n, 7);
    ssfr_field_destroy(&b);
}

/* ---- the definition, written down plainly: kernels in the plane, colours from chromaticities --------------------- */

static double determinant(const double a[3], const double b[3], const double c[3])
{
    double cross[3];
    ssfr_cross(b, c, cross);
    return ssfr_dot(a, cross);
}

/* The factors of three vectors that add up to v. */
static void solve(const double m[3][3], const double v[3], double out[3])
{
    const double d = determinant(m[0], m[1], m[2]);
    out[0] = determinant(v, m[1], m[2]) / d;
    out[1] = determinant(m[0], v, m[2]) / d;
    out[2] = determinant(m[0], m[1], v) / d;
}

static void from_chromaticity(double x, double y, double out[3])
{
    out[0] = x / y, out[1] = 1, out[2] = (1 - x - y) / y;
}

typedef struct plain { /* XYZ of the primaries and of white, and the largest colour difference */
    double primaries[3][3], white[3], farthest;
} plain;

static void plain_lab(const plain *p, const double rgb[3], double out[3])
{
    double f[3];
    for (int i = 0; i < 3; i++) {
        double t = 0;
        for (int j = 0; j < 3; j++) t += p->primaries[j][i] * rgb[j] / p->white[i];
        f[i] = t > 216.0 / 24389 ? pow(t, 1.0 / 3) : (24389.0 / 27 * t + 16) / 116;
    }
    out[0] = 116 * f[1] - 16;
    out[1] = out[0] / 100 * 500 * (f[0] - f[1]);
    out[2] = out[0] / 100 * 200 * (f[1] - f[2]);
}

static double plain_distance(const plain *p, const double rgb_a[3], const double rgb_b[3])
{
    double a[3], b[3];
    plain_lab(p, rgb_a, a);
    plain_lab(p, rgb_b, b);
    return pow(fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]), 0.7);
}

static plain plain_begin(void)
{
    static const double xy[4][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.31271, 0.32902}};
    static const double green[] = {0, 1, 0}, blue[] = {0, 0, 1};
    plain p;
    double share[3];
    for (int i = 0; i < 3; i++) from_chromaticity(xy[i][0], xy[i][1], p.primaries[i]);
    from_chromaticity(xy[3][0], xy[3][1], p.white);
    solve(p.primaries, p.white, share);
    for (int i = 0; i < 9; i++) p.primaries[i / 3][i % 3] *= share[i / 3];
    p.farthest = plain_distance(&p, green, blue);
    return p;
}

static void plain_opponent(const plain *p, const double *rgb, double out[3])
{
    double xyz[3];
    for (int i = 0; i < 3; i++) {
        xyz[i] = 0;
        for (int j = 0; j < 3; j++) xyz[i] += p->primaries[j][i] * rgb[j] / p->white[i];
    }
    out[0] = 116 * xyz[1] - 16, out[1] = 500 * (xyz[0] - xyz[1]), out[2] = 200 * (xyz[1] - xyz[2]);
}

/* The weight at (i, j) pixels, not yet normalised. */
typedef double plain_kernel(double ppd, int i, int j);

static double sensitivity(double a, double b, double ppd, int i, int j)
{
    return a * sqrt(M_PI / b) * exp(-M_PI * M_PI * (i * i + j * j) / (ppd * ppd) / b);
}

static double achromatic(double ppd, int i, int j) { return sensitivity(1, 0.0047, ppd, i, j); }
static double red_green(double ppd, int i, int j) { return sensitivity(1, 0.0053, ppd, i, j); }

static double blue_yellow(double ppd, int i, int j)
{
    return sensitivity(34.1, 0.04, ppd, i, j) + sensitivity(13.5, 0.025, ppd, i, j);
}

static double edge_x(double ppd, int i, int j)
{
    const double sd = 0.041 * ppd;
    return -i * exp(-(i * i + j * j) / (2 * sd * sd));
}

static double point_x(double ppd, int i, int j)
{
    const double sd = 0.041 * ppd;
    return (i * i / (sd * sd) - 1) * exp(-(i * i + j * j) / (2 * sd * sd));
}

static double edge_y(double ppd, int i, int j) { return edge_x(ppd, j, i); }
static double point_y(double ppd, int i, int j) { return point_x(ppd, j, i); }

/* Positive weights sum to 1, negative ones to -1. */
static double filtered(const plain *p, const ssfr_field *f, int x, int y, int channel, plain_kernel *k, double ppd,
                       int radius)
{
    double sum[2] = {0, 0}, total[2] = {0, 0};
    for (int j = -radius; j <= radius; j++)
        for (int i = -radius; i <= radius; i++) {
            const double weight = k(ppd, i, j);
            const int px = ssfr_clamp_int(x + i, 0, f->w - 1), py = ssfr_clamp_int(y + j, 0, f->h - 1);
            double opponent[3];
            plain_opponent(p, ssfr_field_at(f, px, py), opponent);
            sum[weight < 0] += weight * opponent[channel];
            total[weight < 0] += fabs(weight);
        }
    return sum[0] / total[0] + (total[1] > 0 ? sum[1] / total[1] : 0);
}

static void plain_colour(const plain *p, const ssfr_field *f, int x, int y, double ppd, double rgb[3])
{
    static plain_kernel *const kernels[] = {achromatic, red_green, blue_yellow};
    const int radius = (int)ceil(3 * sqrt(0.04 / (2 * M_PI * M_PI)) * ppd);
    double o[3];
    for (int k = 0; k < 3; k++) o[k] = filtered(p, f, x, y, k, kernels[k], ppd, radius);
    const double light = (o[0] + 16) / 116;
    const double xyz[3] = {p->white[0] * (light + o[1] / 500), light, p->white[2] * (light - o[2] / 200)};
    solve(p->primaries, xyz, rgb);
    for (int k = 0; k < 3; k++) rgb[k] = ssfr_clamp(rgb[k], 0, 1);
}

static double plain_feature(const plain *p, const ssfr_field *f, int x, int y, double ppd, plain_kernel *across,
                            plain_kernel *down)
{
    const int radius = (int)ceil(3 * 0.041 * ppd);
    return hypot(filtered(p, f, x, y, 0, across, ppd, radius), filtered(p, f, x, y, 0, down, ppd, radius)) / 116;
}

static double plain_flip(const plain *p, const ssfr_field *a, const ssfr_field *b, int x, int y, double ppd)
{
    double rgb_a[3], rgb_b[3];
    plain_colour(p, a, x, y, ppd, rgb_a);
    plain_colour(p, b, x, y, ppd, rgb_b);
    const double d = plain_distance(p, rgb_a, rgb_b) / p->farthest;
    const double colour = d < 0.4 ? 0.95 * d / 0.4 : 0.95 + 0.05 * (d - 0.4) / 0.6;
    double features[2] = {0, 0};
    for (int side = -1; side <= 1; side += 2) {
        features[0] += side * plain_feature(p, side < 0 ? a : b, x, y, ppd, edge_x, edge_y);
        features[1] += side * plain_feature(p, side < 0 ? a : b, x, y, ppd, point_x, point_y);
    }
    return pow(colour, 1 - sqrt(fmax(fabs(features[0]), fabs(features[1])) / sqrt(2)));
}

/* Images smaller than the filters, and others; far and near eyes. The root of features makes 1e-16 to 1e-8. */
static void maps_agree_with_the_definition(void **state)
{
    (void)state;
    static const struct {
        int w, h;
        double ppd;
    } cases[] = {{23, 17, SSFR_FLIP_PPD}, {3, 2, 67}, {1, 1, 40}, {31, 5, 23.85}, {9, 11, 1}};
    const plain p = plain_begin();
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_field *a = make_random(cases[i].w, cases[i].h, 3, 1), *b = make_random(cases[i].w, cases[i].h, 3, 2);
        ssfr_field *map = map_of(a, b, cases[i].ppd);
        for (int y = 0; y < map->h; y++)
            for (int x = 0; x < map->w; x++)
                assert_close(*ssfr_field_at(map, x, y), plain_flip(&p, a, b, x, y, cases[i].ppd), 1e-7, 0);
        ssfr_field_destroy(&map);
        ssfr_field_destroy(&a);
        ssfr_field_destroy(&b);
    }
}

/* ---- by hand ----------------------------------------------------------------------------------------------------- */

static double lightness(double linear)
{
    return 116 * cbrt(linear) - 16; /* above 0.9 % */
}

/* Filters leave constant images as they are, and there are no features. The largest difference is that of green and
 * blue: L 87.7362 and 32.2982, with Hunt's effect a -75.6099 and 25.5781, b 72.9812 and -34.8364. */
static double of_greys(double difference)
{
    const double farthest = pow(87.7362 - 32.2982 + hypot(75.6099 + 25.5781, 72.9812 + 34.8364), 0.7);
    const double d = pow(difference, 0.7) / farthest;
    return d < 0.4 ? 0.95 * d / 0.4 : 0.95 + 0.05 * (d - 0.4) / 0.6;
}

static void constant_greys_differ_by_their_lightness(void **state)
{
    (void)state;
    static const double pairs[][2] = {{0, 1}, {0.5, 0.52385}, {0.2385, 0.01}, {0.9, 0.1}, {0.3, 0.3001}};
    for (size_t i = 0; i < SSFR_COUNT(pairs); i++) {
        ssfr_field *a = test_image(15, 12, 3, pairs[i][0]), *b = test_image(15, 12, 3, pairs[i][1]);
        ssfr_field *grey_a = test_image(15, 12, 1, pairs[i][0]), *grey_b = test_image(15, 12, 1, pairs[i][1]);
        const double from = pairs[i][0] > 0 ? lightness(pairs[i][0]) : 0;
        const double flip = measure("flip", a, b);
        assert_close(flip, of_greys(fabs(lightness(pairs[i][1]) - from)), 0, 3e-6);
        assert_close(measure("flip", grey_a, grey_b), flip, 0, 1e-12);
        ssfr_field_destroy(&grey_a);
        ssfr_field_destroy(&grey_b);
        ssfr_field_destroy(&a);
        ssfr_field_destroy(&b);
    }
}

static void green_and_blue_are_the_farthest_apart(void **state)
{
    (void)state;
    static const double green[] = {0, 1, 0}, blue[] = {0, 0, 1}, black[] = {0, 0, 0}, white[] = {1, 1, 1};
    ssfr_field *a = make_colour(12, 12, green), *b = make_colour(12, 12, blue);
    ssfr_field *dark = make_colour(12, 12, black), *bright = make_colour(12, 12, white);
    assert_close(measure("flip", a, b), 1, 0, 1e-12);
    assert_close(measure("flip", dark, bright), 0.9673, 1e-4, 0);
    assert_true(measure("flip", a, dark) < 1 && measure("flip", b, bright) < 1);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&dark);
    ssfr_field_destroy(&bright);
}

/* ---- properties of both ------------------------------------------------------------------------------------------ */

static const char *const names[] = {"flip", "flip_hdr"};

static void an_image_does_not_differ_from_itself(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++)
        for (int c = 1; c <= 3; c += 2) {
            ssfr_field *a = make_random(37, 29, c, 3);
            assert_true(measure(names[i], a, a) == 0);
            ssfr_field_destroy(&a);
        }
}

static void images_may_be_exchanged_and_turned(void **state)
{
    (void)state;
    ssfr_field *a = make_random(21, 34, 3, 4), *b = make_random(21, 34, 3, 5);
    ssfr_field *turned_a = test_image(34, 21, 3, 0), *turned_b = test_image(34, 21, 3, 0);
    for (int y = 0; y < 34; y++)
        for (int x = 0; x < 21; x++)
            for (int k = 0; k < 3; k++) {
                ssfr_field_at(turned_a, y, x)[k] = ssfr_field_at(a, x, y)[k];
                ssfr_field_at(turned_b, y, x)[k] = ssfr_field_at(b, x, y)[k];
            }
    assert_true(measure("flip", a, b) == measure("flip", b, a));
    assert_close(measure("flip", turned_a, turned_b), measure("flip", a, b), 0, 1e-12);
    assert_close(measure("flip_hdr", turned_a, turned_b), measure("flip_hdr", a, b), 0, 1e-12);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&turned_a);
    ssfr_field_destroy(&turned_b);
}

/* A pattern fades into its mean: the weaker, the nearer to it. */
static void more_contrast_is_more_error(void **state)
{
    (void)state;
    ssfr_field *flat = test_image(40, 30, 3, 0.4), *a = test_image(40, 30, 3, 0);
    for (int i = 0; i < 2; i++) {
        double last = 0;
        for (double contrast = 0.01; contrast < 1; contrast *= 1.5) {
            for (int y = 0; y < 30; y++)
                for (int x = 0; x < 40; x++)
                    for (int k = 0; k < 3; k++)
                        ssfr_field_at(a, x, y)[k] = 0.4 + 0.4 * contrast * (x / 8 % 2 ? 1 : -1);
            const double value = measure(names[i], a, flat);
            assert_true(value > last && value < 1);
            last = value;
        }
        assert_true(last > 0.3);
    }
    ssfr_field_destroy(&flat);
    ssfr_field_destroy(&a);
}

/* Finer than the eye resolves: the nearer the eye, the more is seen of a pattern of pixels. */
static void what_is_too_fine_is_not_seen(void **state)
{
    (void)state;
    ssfr_field *a = test_image(40, 40, 3, 0), *b = test_image(40, 40, 3, 0);
    for (int y = 0; y < 40; y++)
        for (int x = 0; x < 40; x++)
            for (int k = 0; k < 3; k++) {
                ssfr_field_at(a, x, y)[k] = (x + y) % 2 ? 0.2385 : 0.5;
                ssfr_field_at(b, x, y)[k] = (x + y) % 2 ? 0.5 : 0.2385;
            }
    double last = 0.5;
    for (double ppd = 10; ppd < 100; ppd *= 2) { /* beyond, the image ends within the filters */
        ssfr_field *map = map_of(a, b, ppd);
        const double centre = *ssfr_field_at(map, 20, 20);
        assert_true(centre <= last);
        last = centre;
        ssfr_field_destroy(&map);
    }
    assert_true(last < 1e-4);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

static void values_beyond_white_and_black_are_clamped(void **state)
{
    (void)state;
    ssfr_field *a = make_random(20, 20, 3, 6), *b = make_random(20, 20, 3, 7), *c = test_image(20, 20, 3, 0);
    for (int i = 0; i < 20 * 20 * 3; i++) {
        c->data[i] = a->data[i];
        if (i % 5 == 0) a->data[i] = 1, c->data[i] = i % 2 ? 2.385 : (double)INFINITY;
        if (i % 7 == 0) a->data[i] = 0, c->data[i] = i % 2 ? -2.385 : -(double)INFINITY;
    }
    assert_true(measure("flip", a, b) == measure("flip", c, b));
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&c);
}

/* 10 pixels, the radius of the widest filter. */
static void nan_reaches_as_far_as_the_filters(void **state)
{
    (void)state;
    ssfr_field *a = make_random(50, 40, 3, 8), *b = make_random(50, 40, 3, 9);
    const ssfr_flip_exposures e = exposures_of(b, NULL, SSFR_FLIP_ACES);
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < 3; k++) {
            double *value = &ssfr_field_at(side ? b : a, 25, 13)[k], was = *value;
            *value = (double)NAN;
            ssfr_field *maps[] = {map_of(a, b, SSFR_FLIP_PPD), hdr_map_of(a, b, SSFR_FLIP_ACES, e),
                                  hdr_map_of(a, b, SSFR_FLIP_REINHARD, e)};
            for (int y = 0; y < 40; y++)
                for (int x = 0; x < 50; x++)
                    for (int i = 0; i < 3; i++)
                        assert_true(!isnan(*ssfr_field_at(maps[i], x, y)) == (abs(x - 25) > 10 || abs(y - 13) > 10));
            for (int i = 0; i < 3; i++) ssfr_field_destroy(&maps[i]);
            *value = was;
        }
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

static void threads_change_no_bit_of_a_map(void **state)
{
    (void)state;
    const int before = omp_get_max_threads();
    ssfr_field *a = make_random(61, 13, 3, 10), *b = make_random(61, 13, 3, 11);
    omp_set_num_threads(1);
    ssfr_field *one = map_of(a, b, SSFR_FLIP_PPD);
    for (int n = 2; n <= 16; n *= 2) { /* at last more than there are rows */
        omp_set_num_threads(n);
        ssfr_field *map = map_of(a, b, SSFR_FLIP_PPD);
        assert_memory_equal(map->data, one->data, 61 * 13 * sizeof *map->data);
        ssfr_field_destroy(&map);
    }
    omp_set_num_threads(before);
    ssfr_field_destroy(&one);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

/* ---- exposures --------------------------------------------------------------------------------------------------- */

/* Of greys: 9 pixels, 17.43 the brightest, 0.2385 the median. */
static ssfr_field *make_exposed(void)
{
    static const double values[] = {0.2385, 17.43, 0.01, 0.02, 0.3, 0.05, 2.5, 0, 0.7};
    ssfr_field *b = test_image(3, 3, 1, 0);
    memcpy(b->data, values, sizeof values);
    return b;
}

/* The brightest and the median pixel come out as 0.85 by each tone mapper, given here as their authors wrote them. */
static double aces(double x)
{
    x *= 0.6;
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

static double hable_curve(double x)
{
    return (x * (0.15 * x + 0.10 * 0.50) + 0.20 * 0.02) / (x * (0.15 * x + 0.50) + 0.20 * 0.30) - 0.02 / 0.30;
}

static double hable(double x)
{
    return hable_curve(2 * x) / hable_curve(11.2);
}

static double reinhard(double x)
{
    return x / (1 + x);
}

static void the_brightest_and_the_median_are_shown_at_085(void **state)
{
    (void)state;
    static double (*const tones[])(double) = {
        [SSFR_FLIP_ACES] = aces, [SSFR_FLIP_HABLE] = hable, [SSFR_FLIP_REINHARD] = reinhard};
    ssfr_field *b = make_exposed();
    for (int tone = SSFR_FLIP_ACES; tone <= SSFR_FLIP_REINHARD; tone++) {
        const ssfr_flip_exposures e = exposures_of(b, NULL, (ssfr_flip_tone)tone);
        assert_close(tones[tone](17.43 * exp2(e.start)), 0.85, 1e-5, 0);
        assert_close(tones[tone](0.2385 * exp2(e.stop)), 0.85, 1e-5, 0);
        assert_int_equal(e.n, (int)ceil(log2(17.43 / 0.2385)));
    }
    ssfr_field_destroy(&b);
}

/* At one exposure HDR-FLIP is LDR-FLIP of the tone-mapped images; at several it is the largest. */
static void each_exposure_is_flip_of_tone_mapped_images(void **state)
{
    (void)state;
    static double (*const tones[])(double) = {
        [SSFR_FLIP_ACES] = aces, [SSFR_FLIP_HABLE] = hable, [SSFR_FLIP_REINHARD] = reinhard};
    ssfr_field *a = make_random(24, 18, 1, 12), *b = make_random(24, 18, 1, 13), *shown[2];
    a->data[0] = 1e9, a->data[1] = -2.385; /* white and black at any exposure */
    for (int tone = SSFR_FLIP_ACES; tone <= SSFR_FLIP_REINHARD; tone++) {
        ssfr_field *all = hdr_map_of(a, b, (ssfr_flip_tone)tone, (ssfr_flip_exposures){-2, 1.5, 3});
        ssfr_field *largest = test_image(24, 18, 1, 0);
        for (double exposure = -2; exposure <= 1.5; exposure += 1.75) {
            for (int i = 0; i < 2; i++) shown[i] = test_image(24, 18, 1, 0);
            for (int i = 0; i < 24 * 18; i++) {
                shown[0]->data[i] = tones[tone](fmax(a->data[i], 0) * exp2(exposure));
                shown[1]->data[i] = tones[tone](b->data[i] * exp2(exposure));
            }
            ssfr_field *map = map_of(shown[0], shown[1], SSFR_FLIP_PPD);
            for (int i = 0; i < 24 * 18; i++) largest->data[i] = fmax(largest->data[i], map->data[i]);
            ssfr_field_destroy(&map);
            for (int i = 0; i < 2; i++) ssfr_field_destroy(&shown[i]);
        }
        for (int i = 0; i < 24 * 18; i++) assert_close(all->data[i], largest->data[i], 1e-5, 0);
        ssfr_field_destroy(&all);
        ssfr_field_destroy(&largest);
    }
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

/* Reinhard's keeps colours: each channel is divided by 1 + luminance. */
static void reinhard_is_of_luminance(void **state)
{
    (void)state;
    static const double from[] = {0.2385, 1.743, 0.5}, grey[] = {0.3, 0.3, 0.3};
    const double light = 0.2126 * from[0] + 0.7152 * from[1] + 0.0722 * from[2];
    const double to[] = {from[0] / (1 + light), from[1] / (1 + light), from[2] / (1 + light)};
    ssfr_field *a = make_colour(4, 4, from), *b = make_colour(4, 4, grey), *shown = make_colour(4, 4, to);
    ssfr_field *dimmed = test_image(4, 4, 3, 0.3 / 1.3);
    ssfr_field *map = hdr_map_of(a, b, SSFR_FLIP_REINHARD, (ssfr_flip_exposures){0, 0, 1});
    ssfr_field *plainly = map_of(shown, dimmed, SSFR_FLIP_PPD);
    assert_close(map->data[0], plainly->data[0], 0, 1e-12);
    ssfr_field_destroy(&map);
    ssfr_field_destroy(&plainly);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&shown);
    ssfr_field_destroy(&dimmed);
}

static void exposures_follow_the_light(void **state)
{
    (void)state;
    ssfr_field *a = make_random(30, 20, 3, 14), *b = make_random(30, 20, 3, 15);
    const double before = measure("flip_hdr", a, b);
    assert_true(before > measure("flip", a, b) / 2);
    for (int i = 0; i < 30 * 20 * 3; i++) a->data[i] *= 1000, b->data[i] *= 1000;
    assert_close(measure("flip_hdr", a, b), before, 0, 1e-9);
    assert_true(measure("flip", a, b) < 0.1); /* nearly all is white */
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

static void black_is_exposed_as_it_is(void **state)
{
    (void)state;
    ssfr_field *b = test_image(6, 5, 3, 0), *a = test_image(6, 5, 3, 0.2385), *few = test_image(6, 5, 1, 0);
    ssfr_flip_exposures e = exposures_of(b, NULL, SSFR_FLIP_ACES);
    assert_true(e.start == 0 && e.stop == 0 && e.n == 2);
    assert_true(measure("flip_hdr", b, b) == 0 && measure("flip_hdr", a, b) > 0.5);
    few->data[3] = 2.385; /* one bright pixel on black: the median has no exposure of its own */
    e = exposures_of(few, NULL, SSFR_FLIP_REINHARD);
    assert_close(e.start, log2(0.85 / 0.15 / 2.385), 1e-12, 0);
    assert_close(e.stop, log2(0.85 / 0.15 / (double)FLT_EPSILON), 1e-12, 0);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&few);
}

static void only_counted_pixels_are_exposed_for(void **state)
{
    (void)state;
    ssfr_field *b = make_exposed(), *mask = test_image(3, 3, 1, 1);
    mask->data[1] = 0;
    assert_close(exposures_of(b, mask, SSFR_FLIP_REINHARD).start, log2(0.85 / 0.15 / 2.5), 1e-12, 0);
    b->data[1] = (double)NAN;
    assert_int_equal(exposures_of(b, mask, SSFR_FLIP_REINHARD).n, 4);
    assert_int_equal(exposures_of(b, NULL, SSFR_FLIP_REINHARD).n, 0);
    b->data[1] = INFINITY;
    assert_int_equal(exposures_of(b, NULL, SSFR_FLIP_REINHARD).n, 0);
    assert_true(isnan(measure("flip_hdr", b, b)));
    ssfr_field_fill(mask, 0);
    assert_int_equal(exposures_of(b, mask, SSFR_FLIP_REINHARD).n, 0);
    assert_true(isnan(measure_masked("flip_hdr", b, b, mask)));
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&mask);
}

/* ---- errors ------------------------------------------------------------------------------------------------------ */

static void what_cannot_be_seen_is_refused(void **state)
{
    (void)state;
    static const double ppds[] = {0, -67, 0.999, 1000.5, INFINITY, (double)NAN};
    ssfr_field *a = test_image(4, 3, 3, 0.5), *b = test_image(4, 4, 3, 0.5), *two = test_image(4, 3, 2, 0.5), *map = a;
    for (size_t i = 0; i < SSFR_COUNT(ppds); i++) {
        assert_fails(SSFR_ERR_VALUE, ssfr_flip_map(&(ssfr_pair){.a = a, .b = a}, ppds[i], &map), "pixels per degree");
        assert_null(map);
    }
    assert_fails(SSFR_ERR_VALUE, ssfr_flip_map(&(ssfr_pair){.a = a, .b = b}, 67, &map), "flip: 4 x 3 pixels");
    assert_fails(SSFR_ERR_VALUE, ssfr_flip_map(&(ssfr_pair){.a = two, .b = two}, 67, &map), "2 channels do not make");
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&two);
}

static void exposures_that_are_none_are_refused(void **state)
{
    (void)state;
    static const ssfr_flip_exposures bad[] = {{0, 1, 0}, {0, 1, -2}, {(double)NAN, 1, 2}, {0, INFINITY, 2}};
    const ssfr_flip_exposures good = {0, 1, 2};
    ssfr_field *a = test_image(4, 3, 3, 0.5), *b = test_image(4, 4, 3, 0.5), *map = a;
    const ssfr_pair same = {.a = a, .b = a}, different = {.a = a, .b = b};
    ssfr_flip_exposures e;
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) {
        assert_fails(SSFR_ERR_VALUE, ssfr_flip_hdr_map(&same, 67, SSFR_FLIP_ACES, &bad[i], &map), "exposures from");
        assert_null(map);
    }
    assert_fails(SSFR_ERR_VALUE, ssfr_flip_hdr_map(&different, 67, SSFR_FLIP_ACES, &good, &map), "4 x 3 pixels");
    assert_fails(SSFR_ERR_VALUE, ssfr_flip_hdr_map(&same, 0, SSFR_FLIP_ACES, &good, &map), "0 pixels per degree");
    assert_fails(SSFR_ERR_VALUE, ssfr_flip_expose(&different, SSFR_FLIP_ACES, &e), "flip_hdr: 4 x 3 pixels");
    assert_int_equal(e.n, 0);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_those_of_the_authors_tool),
        cmocka_unit_test(exposures_are_those_of_the_authors_tool),
        cmocka_unit_test(maps_agree_with_the_definition),
        cmocka_unit_test(constant_greys_differ_by_their_lightness),
        cmocka_unit_test(green_and_blue_are_the_farthest_apart),
        cmocka_unit_test(an_image_does_not_differ_from_itself),
        cmocka_unit_test(images_may_be_exchanged_and_turned),
        cmocka_unit_test(more_contrast_is_more_error),
        cmocka_unit_test(what_is_too_fine_is_not_seen),
        cmocka_unit_test(values_beyond_white_and_black_are_clamped),
        cmocka_unit_test(nan_reaches_as_far_as_the_filters),
        cmocka_unit_test(threads_change_no_bit_of_a_map),
        cmocka_unit_test(the_brightest_and_the_median_are_shown_at_085),
        cmocka_unit_test(each_exposure_is_flip_of_tone_mapped_images),
        cmocka_unit_test(reinhard_is_of_luminance),
        cmocka_unit_test(exposures_follow_the_light),
        cmocka_unit_test(black_is_exposed_as_it_is),
        cmocka_unit_test(only_counted_pixels_are_exposed_for),
        cmocka_unit_test(what_cannot_be_seen_is_refused),
        cmocka_unit_test(exposures_that_are_none_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_metrics.c: metrics against analytic answers, against their definition, and on input that is not finite. */
#include "tests/util.h"

#include "image/srgb.h"
#include "metrics/metrics.h"
#include "metrics/metrics_opencv.h"

#include <omp.h>

static double measure_masked(const char *name, const ssfr_field *a, const ssfr_field *b, const ssfr_field *mask)
{
    double value = -2.385;
    const ssfr_metric *metric = ssfr_metric_find(name);
    assert_non_null(metric);
    assert_int_equal(ssfr_metric_measure(metric, a, b, mask, &value), SSFR_OK);
    return value;
}

static double measure(const char *name, const ssfr_field *a, const ssfr_field *b)
{
    return measure_masked(name, a, b, NULL);
}

static void fill_rectangle(ssfr_field *field, int x0, int y0, int x1, int y1, double value)
{
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            for (int k = 0; k < field->c; k++) ssfr_field_at(field, x, y)[k] = value;
}

/* What a metric of this kind takes: depths around -2 m, unit vectors, colours in [0, 1). */
static ssfr_field *make_kind(ssfr_metric_kind kind, int w, int h, uint64_t seed)
{
    ssfr_field *field = test_image(w, h, kind == SSFR_METRIC_DEPTH ? 1 : 3, 0);
    for (int i = 0; i < w * h * field->c; i++) field->data[i] = test_random(&seed, 0, 1);
    for (int i = 0; i < w * h; i++) {
        if (kind == SSFR_METRIC_DEPTH) field->data[i] -= 2.385;
        if (kind == SSFR_METRIC_NORMAL) ssfr_normalize(field->data + 3 * i);
    }
    return field;
}

/* ---- the list --------------------------------------------------------------------------------------------------- */

static void every_metric_is_found_by_its_name(void **state)
{
    (void)state;
    int n = 0;
    for (const ssfr_metric *m = ssfr_metric_at(0); m; m = ssfr_metric_at(++n)) {
        assert_ptr_equal(ssfr_metric_find(m->name), m);
        assert_true(strlen(m->help) > 10 && strlen(m->unit) > 0 && strlen(ssfr_metric_kind_name(m->kind)) > 0);
    }
    assert_int_equal(n, 23);
    assert_null(ssfr_metric_find("depth"));
    assert_null(ssfr_metric_at(-1));
}

/* ---- depth ------------------------------------------------------------------------------------------------------ */

static void a_constant_offset_is_rms_max_and_mean(void **state)
{
    (void)state;
    ssfr_field *a = make_kind(SSFR_METRIC_DEPTH, 64, 48, 1), *b = test_image(64, 48, 1, 0);
    for (int i = 0; i < 64 * 48; i++) b->data[i] = a->data[i] + 2.385e-3;
    fill_rectangle(a, 3, 4, 20, 11, -SSFR_EMPTY);
    fill_rectangle(b, 5, 6, 30, 9, SSFR_EMPTY);
    fill_rectangle(b, 40, 40, 42, 42, INFINITY); /* as half floats hold the farthest */
    assert_close(measure("depth_rms", a, b), 2.385e-3, 0, 1e-12);
    assert_close(measure("depth_max", a, b), 2.385e-3, 0, 1e-12);
    assert_close(measure("depth_mean", a, b), -2.385e-3, 0, 1e-12);
    assert_close(measure("depth_rms_interior", a, b), 2.385e-3, 0, 1e-12);
    assert_close(measure("depth_rms_edge", a, b), 2.385e-3, 0, 1e-12);
    assert_true(measure("depth_max", a, a) == 0);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

static void rms_mean_and_max_differ_where_they_should(void **state)
{
    (void)state;
    ssfr_field *a = test_image(2, 2, 1, -1), *b = test_image(2, 2, 1, -1);
    const double differences[] = {0.003, -0.004, 0, 0};
    for (int i = 0; i < 4; i++) a->data[i] += differences[i];
    assert_close(measure("depth_rms", a, b), 0.0025, 0, 1e-12);
    assert_close(measure("depth_max", a, b), 0.004, 0, 1e-12);
    assert_close(measure("depth_mean", a, b), -0.00025, 0, 1e-11);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

/* A surface of 30 x 20 pixels with one hole: its rim, the hole and the hole's neighbours are edges. */
static void interior_and_edge_share_out_the_surface(void **state)
{
    (void)state;
    ssfr_field *a = test_image(40, 30, 1, -SSFR_EMPTY), *b = test_image(40, 30, 1, -SSFR_EMPTY);
    fill_rectangle(b, 5, 5, 35, 25, -1.5);
    fill_rectangle(a, 5, 5, 35, 25, -1.5 + 0.1743);
    fill_rectangle(a, 6, 6, 34, 24, -1.5 + 2.385e-3);
    fill_rectangle(a, 19, 14, 22, 17, -1.5 + 0.1743);
    *ssfr_field_at(a, 20, 15) = -SSFR_EMPTY;
    assert_close(measure("depth_rms_interior", a, b), 2.385e-3, 0, 1e-12);
    assert_close(measure("depth_rms_edge", a, b), 0.1743, 0, 1e-12);
    *ssfr_field_at(a, 20, 15) = -1.5;
    assert_true(measure("depth_rms_interior", a, b) > 0.01);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

static void the_border_of_the_image_is_edge(void **state)
{
    (void)state;
    ssfr_field *a = test_image(9, 7, 1, -1 + 0.1743), *b = test_image(9, 7, 1, -1);
    fill_rectangle(a, 1, 1, 8, 6, -1 + 2.385e-3);
    assert_close(measure("depth_rms_interior", a, b), 2.385e-3, 0, 1e-12);
    assert_close(measure("depth_rms_edge", a, b), 0.1743, 0, 1e-12);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

static void iou_of_rectangles_is_their_overlap(void **state)
{
    (void)state;
    ssfr_field *a = test_image(64, 48, 1, -SSFR_EMPTY), *b = test_image(64, 48, 1, SSFR_EMPTY);
    assert_true(isnan(measure("silhouette_iou", a, b)));
    assert_true(isnan(measure("depth_rms", a, b)));
    fill_rectangle(a, 10, 5, 30, 25, -1); /* 400 px */
    assert_true(measure("silhouette_iou", a, b) == 0);
    fill_rectangle(b, 17, 9, 40, 30, -2); /* 483 px, 13 x 16 of them common */
    assert_close(measure("silhouette_iou", a, b), 208.0 / (400 + 483 - 208), 0, 1e-15);
    assert_true(measure("silhouette_iou", a, a) == 1);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

/* ---- normals ---------------------------------------------------------------------------------------------------- */

static const double angles[] = {1e-12, 1e-9, 2.385e-8, 1e-6, 1e-3, 0.2385, 1.5, M_PI / 2, 2.385, M_PI};

static void rotated_normals_give_their_angle(void **state)
{
    (void)state;
    ssfr_field *a = test_image(5, 4, 3, 0), *b = test_image(5, 4, 3, 0);
    for (size_t i = 0; i < SSFR_COUNT(angles); i++) {
        for (int p = 0; p < 20; p++) {
            a->data[3 * p + 2] = 1;
            b->data[3 * p + p % 2] = sin(angles[i]);
            b->data[3 * p + 2] = cos(angles[i]);
        }
        assert_close(measure("normal_mean_deg", a, b) * M_PI / 180, angles[i], 0, 1e-14);
        assert_close(measure("normal_rms_deg", a, b) * M_PI / 180, angles[i], 0, 1e-14);
        assert_close(measure("normal_max_deg", a, b) * M_PI / 180, angles[i], 0, 1e-14);
    }
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

/* Here the rounding of the vectors themselves, some 1e-16, is all that is allowed. */
static void oblique_normals_keep_tiny_angles(void **state)
{
    (void)state;
    ssfr_field *a = make_kind(SSFR_METRIC_NORMAL, 8, 6, 3), *b = test_image(8, 6, 3, 0);
    for (size_t i = 0; i < SSFR_COUNT(angles); i++) {
        for (int p = 0; p < 48; p++) {
            const double *n = a->data + 3 * p;
            double side[3] = {n[1], -n[0], 0};
            ssfr_normalize(side);
            for (int k = 0; k < 3; k++) b->data[3 * p + k] = n[k] * cos(angles[i]) + side[k] * sin(angles[i]);
        }
        assert_close(measure("normal_max_deg", a, b) * M_PI / 180, angles[i], 4e-16, 1e-14);
    }
    assert_true(measure("normal_max_deg", a, a) == 0);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

/* Two normals that differ in the last digits of one number: the angle is of the numbers, not of rounded products. */
static void the_last_digits_of_a_normal_count(void **state)
{
    (void)state;
    ssfr_field *a = test_image(1, 1, 3, 0), *b = test_image(1, 1, 3, 0);
    a->data[0] = 0.6, a->data[1] = 0.8;
    b->data[0] = 0.6 + 0x1p-47, b->data[1] = 0.8;
    assert_close(measure("normal_max_deg", a, b) * M_PI / 180, 0.8 * (b->data[0] - 0.6), 0, 1e-13);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

static void a_zero_vector_is_no_surface(void **state)
{
    (void)state;
    ssfr_field *a = test_image(3, 1, 3, 0), *b = test_image(3, 1, 3, 0);
    assert_true(isnan(measure("normal_mean_deg", a, b)));
    ssfr_field_at(a, 0, 0)[2] = 1;
    assert_true(isnan(measure("normal_max_deg", a, b)));
    ssfr_field_at(a, 1, 0)[2] = 1;
    ssfr_field_at(b, 1, 0)[1] = 1;
    ssfr_field_at(b, 2, 0)[0] = 1;
    assert_close(measure("normal_mean_deg", a, b), 90, 0, 1e-15);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

/* ---- colour ----------------------------------------------------------------------------------------------------- */

static void psnr_follows_from_the_display_difference(void **state)
{
    (void)state;
    for (int c = 1; c <= 3; c += 2) {
        ssfr_field *a = test_image(32, 20, c, ssfr_srgb_decode(0.5));
        ssfr_field *b = test_image(32, 20, c, ssfr_srgb_decode(0.52385));
        assert_close(measure("psnr", a, b), -20 * log10(0.02385), 0, 1e-12);
        assert_true(measure("psnr", a, a) == INFINITY);
        fill_rectangle(a, 0, 0, 32, 20, 2.385); /* beyond white on both sides: the same display value */
        fill_rectangle(b, 0, 0, 32, 20, 17.43);
        assert_true(measure("psnr", a, b) == INFINITY);
        ssfr_field_destroy(&a);
        ssfr_field_destroy(&b);
    }
}

static void squares_and_largest_are_of_linear_values(void **state)
{
    (void)state;
    ssfr_field *a = test_image(31, 17, 3, 0.3), *b = test_image(31, 17, 3, 0.5);
    assert_close(measure("mse", a, b), 0.04, 0, 1e-12);
    assert_close(measure("relmse", a, b), 0.04 / 0.26, 0, 1e-12);
    assert_close(measure("max_abs", a, b), 0.2, 0, 1e-12);
    ssfr_field_at(a, 30, 16)[2] = 2.885;
    assert_close(measure("max_abs", a, b), 2.385, 0, 1e-12);
    fill_rectangle(b, 0, 0, 31, 17, 0); /* black references do not divide by zero */
    fill_rectangle(a, 0, 0, 31, 17, 0.3);
    assert_close(measure("relmse", a, b), 9, 0, 1e-12);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

/* ---- SSIM: its definition, written down plainly ----------------------------------------------------------------- */

static int mirrored(int i, int n)
{
    while (n > 1 && (i < 0 || i >= n)) i = i < 0 ? -i : 2 * (n - 1) - i;
    return n > 1 ? i : 0;
}

/* Weighted means over the window around (x, y) of a, b, a^2, b^2, a b, for display values times `scale`. */
static void window_means(const ssfr_field *a, const ssfr_field *b, int x, int y, int k, double scale, double mean[5])
{
    double total = 0;
    for (int i = 0; i < 5; i++) mean[i] = 0;
    for (int j = -5; j <= 5; j++)
        for (int i = -5; i <= 5; i++) {
            const int px = mirrored(x + i, a->w), py = mirrored(y + j, a->h);
            const double weight = exp(-(i * i + j * j) / (2 * 1.5 * 1.5));
            const double va = scale * ssfr_srgb_encode(ssfr_field_at(a, px, py)[k]);
            const double vb = scale * ssfr_srgb_encode(ssfr_field_at(b, px, py)[k]);
            const double terms[] = {va, vb, va * va, vb * vb, va * vb};
            for (int t = 0; t < 5; t++) mean[t] += weight * terms[t];
            total += weight;
        }
    for (int t = 0; t < 5; t++) mean[t] /= total;
}

/* With the constants (0.01 * 255)^2 and (0.03 * 255)^2 whatever the scale. */
static double plain_ssim(const ssfr_field *a, const ssfr_field *b, double scale)
{
    const double c1 = 6.5025, c2 = 58.5225;
    double sum = 0, m[5];
    for (int y = 0; y < a->h; y++)
        for (int x = 0; x < a->w; x++)
            for (int k = 0; k < a->c; k++) {
                window_means(a, b, x, y, k, scale, m);
                sum += (2 * m[0] * m[1] + c1) * (2 * (m[4] - m[0] * m[1]) + c2) /
                       ((m[0] * m[0] + m[1] * m[1] + c1) * (m[2] - m[0] * m[0] + m[3] - m[1] * m[1] + c2));
            }
    return sum / (a->w * a->h * a->c);
}

static ssfr_field *make_noisy(const ssfr_field *from, double amplitude)
{
    ssfr_field *field = test_image(from->w, from->h, from->c, 0);
    uint64_t seed = 23;
    for (int i = 0; i < from->w * from->h * from->c; i++)
        field->data[i] = from->data[i] + amplitude * test_random(&seed, -1, 1);
    return field;
}

static ssfr_field *make_gradient(int w, int h, int c)
{
    ssfr_field *field = test_image(w, h, c, 0);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            for (int k = 0; k < c; k++)
                ssfr_field_at(field, x, y)[k] = 0.5 + 0.4 * sin(0.13 * x + 0.7 * k) * cos(0.17 * y);
    return field;
}

static void ssim_is_one_only_for_equal_images(void **state)
{
    (void)state;
    ssfr_field *a = make_gradient(64, 48, 3);
    double last = 1;
    assert_close(measure("ssim", a, a), 1, 1e-12, 0);
    for (double amplitude = 0.01; amplitude < 1; amplitude *= 3) {
        ssfr_field *b = make_noisy(a, amplitude);
        const double value = measure("ssim", b, a);
        assert_true(value > 0 && value < last);
        last = value;
        ssfr_field_destroy(&b);
    }
    assert_true(last < 0.5);
    ssfr_field_destroy(&a);
}

/* Sizes below the window, and one that is measured in several bands. */
static void ssim_agrees_with_its_definition_on_0_to_255(void **state)
{
    (void)state;
    static const int sizes[][3] = {{1, 1, 1}, {3, 2, 3}, {40, 30, 3}, {13, 530, 1}};
    for (size_t i = 0; i < SSFR_COUNT(sizes); i++) {
        ssfr_field *a = make_gradient(sizes[i][0], sizes[i][1], sizes[i][2]), *b = make_noisy(a, 0.05);
        const double value = measure("ssim", b, a);
        assert_close(value, plain_ssim(b, a, 255), 1e-10, 0);
        if (i == 2) assert_true(plain_ssim(b, a, 1) - value > 0.05); /* what [0, 1] would have given: far too good */
        ssfr_field_destroy(&a);
        ssfr_field_destroy(&b);
    }
}

static void ssim_under_a_mask_is_the_mean_over_it(void **state)
{
    (void)state;
    ssfr_field *a = make_gradient(60, 40, 3), *b = make_gradient(60, 40, 3), *mask = test_image(60, 40, 1, 1);
    fill_rectangle(b, 0, 0, 20, 40, 0.2385);
    assert_true(measure("ssim", b, a) < 0.9);
    fill_rectangle(mask, 0, 0, 25, 40, 0); /* further than the window reaches */
    assert_close(measure_masked("ssim", b, a, mask), 1, 1e-12, 0);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&mask);
}

static void what_opencv_throws_comes_back_as_one_line(void **state)
{
    (void)state;
    char message[256] = "";
    double value = 0.2385;
    assert_int_equal(ssfr_opencv_ssim(&value, &value, 0, 0, &value, message, sizeof message), SSFR_ERR_VALUE);
    assert_non_null(strstr(message, "OpenCV: "));
    assert_null(strchr(message, '\n'));
    assert_true(strlen(message) > 10);
}

/* Interior 0.01 and one of 0.03, the rest 0.5 behind. */
static void biases_and_maxima_of_the_interior_stand_apart(void **state)
{
    (void)state;
    ssfr_field *a = test_image(40, 30, 1, -SSFR_EMPTY), *b = test_image(40, 30, 1, -SSFR_EMPTY);
    fill_rectangle(b, 5, 5, 35, 25, -1.5);
    fill_rectangle(a, 5, 5, 35, 25, -2);
    fill_rectangle(a, 6, 6, 34, 24, -1.51);
    *ssfr_field_at(a, 10, 10) = -1.53;
    assert_close(measure("depth_mean_interior", a, b), -0.01 - 0.02 / (28 * 18), 0, 1e-12);
    assert_close(measure("depth_max_interior", a, b), 0.03, 0, 1e-12);
    assert_close(measure("depth_median_interior", a, b), -0.01, 0, 1e-12);
    assert_close(measure("depth_max", a, b), 0.5, 0, 1e-12);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

/* Interior pixels of -0.04, -0.01, 0.02 and, hidden at first, 0.5; the rim, which does not count, is far off. */
static void the_median_is_the_middle_of_the_interior(void **state)
{
    (void)state;
    static const double differences[] = {0.02, -0.04, 0.5, -0.01};
    ssfr_field *a = test_image(6, 3, 1, -9), *b = test_image(6, 3, 1, -1), *mask = test_image(6, 3, 1, 1);
    for (int i = 0; i < 4; i++) *ssfr_field_at(a, i + 1, 1) = -1 + differences[i];
    *ssfr_field_at(mask, 3, 1) = 0;
    assert_close(measure_masked("depth_median_interior", a, b, mask), -0.01, 0, 1e-12);
    assert_close(measure("depth_median_interior", a, b), (-0.01 + 0.02) / 2, 0, 1e-12);
    *ssfr_field_at(mask, 1, 1) = *ssfr_field_at(mask, 2, 1) = 0;
    assert_close(measure_masked("depth_median_interior", a, b, mask), -0.01, 0, 1e-12);
    *ssfr_field_at(mask, 4, 1) = 0;
    assert_true(isnan(measure_masked("depth_median_interior", a, b, mask)));
    assert_close(measure("mean_difference", a, b), (-8.0 * 14 + 0.47) / 18, 0, 1e-12);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&mask);
}

/* Of a sampled reference only single pixels are known: then a alone says what is interior. */
static void a_sampled_reference_leaves_neighbours_to_the_measured_image(void **state)
{
    (void)state;
    ssfr_field *a = test_image(40, 30, 1, -1.5), *b = test_image(40, 30, 1, -SSFR_EMPTY);
    ssfr_field *mask = test_image(40, 30, 1, 0);
    const ssfr_pair pair = {.a = a, .b = b, .mask = mask, .sampled = true};
    double interior = 0, edge = 0;
    *ssfr_field_at(a, 20, 20) = -SSFR_EMPTY;
    *ssfr_field_at(b, 10, 10) = -1.52, *ssfr_field_at(b, 21, 21) = -1.57;
    *ssfr_field_at(mask, 10, 10) = *ssfr_field_at(mask, 21, 21) = 1;
    const ssfr_metric *within = ssfr_metric_find("depth_rms_interior"), *at = ssfr_metric_find("depth_rms_edge");
    assert_int_equal(ssfr_metric_measure_pair(within, &pair, &interior), SSFR_OK);
    assert_int_equal(ssfr_metric_measure_pair(at, &pair, &edge), SSFR_OK);
    assert_close(interior, 0.02, 0, 1e-12);
    assert_close(edge, 0.07, 0, 1e-12);
    assert_true(isnan(measure_masked("depth_rms_interior", a, b, mask)));
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&mask);
}

static void sampled_normals_are_interior_by_the_measured_image_too(void **state)
{
    (void)state;
    ssfr_field *a = test_image(20, 15, 3, 0), *b = test_image(20, 15, 3, 0), *mask = test_image(20, 15, 1, 0);
    const ssfr_pair pair = {.a = a, .b = b, .mask = mask, .sampled = true};
    double interior = 0, edge = 0;
    for (int i = 0; i < 20 * 15; i++) a->data[3 * i + 2] = i == 8 * 20 + 12 ? 0 : 1; /* a hole at (12, 8) */
    ssfr_field_at(b, 5, 6)[2] = cos(0.2), ssfr_field_at(b, 5, 6)[0] = sin(0.2);
    ssfr_field_at(b, 11, 7)[2] = cos(0.7), ssfr_field_at(b, 11, 7)[0] = sin(0.7);
    *ssfr_field_at(mask, 5, 6) = *ssfr_field_at(mask, 11, 7) = 1;
    const ssfr_metric *within = ssfr_metric_find("normal_mean_interior_deg");
    assert_int_equal(ssfr_metric_measure_pair(within, &pair, &interior), SSFR_OK);
    assert_int_equal(ssfr_metric_measure_pair(ssfr_metric_find("normal_mean_edge_deg"), &pair, &edge), SSFR_OK);
    assert_close(interior * M_PI / 180, 0.2, 0, 1e-12);
    assert_close(edge * M_PI / 180, 0.7, 0, 1e-12);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&mask);
}

/* The mean over pixels of what each adds is the metric itself. */
static void pixels_add_up_to_the_metric(void **state)
{
    (void)state;
    for (int i = 0; ssfr_metric_at(i); i++) {
        const ssfr_metric *m = ssfr_metric_at(i);
        if (!ssfr_metric_is_mean(m)) continue;
        ssfr_field *b = make_kind(m->kind, 23, 17, 5), *a = make_noisy(b, 0.01), *mask = test_image(23, 17, 1, 1);
        const ssfr_pair pair = {.a = a, .b = b, .mask = mask};
        double sum = 0, n = 0;
        fill_rectangle(mask, 0, 0, 10, 9, 0);
        for (int k = 0; k < 23 * 17; k++) {
            double value, counts;
            ssfr_metric_at_pixel(m, &pair, k % 23, k / 23, &value, &counts);
            sum += value, n += counts;
        }
        assert_close(ssfr_metric_of_mean(m, sum / n), measure_masked(m->name, a, b, mask), 0, 1e-12);
        ssfr_field_destroy(&a);
        ssfr_field_destroy(&b);
        ssfr_field_destroy(&mask);
    }
}

static void normals_of_interior_and_edge_share_out_the_surface(void **state)
{
    (void)state;
    ssfr_field *a = test_image(20, 15, 3, 0), *b = test_image(20, 15, 3, 0);
    for (int y = 3; y < 12; y++)
        for (int x = 4; x < 16; x++) {
            const bool edge = x == 4 || x == 15 || y == 3 || y == 11;
            ssfr_field_at(b, x, y)[2] = 1;
            ssfr_field_at(a, x, y)[0] = sin(edge ? 0.5 : 0.1), ssfr_field_at(a, x, y)[2] = cos(edge ? 0.5 : 0.1);
        }
    assert_close(measure("normal_mean_interior_deg", a, b) * M_PI / 180, 0.1, 0, 1e-12);
    assert_close(measure("normal_mean_edge_deg", a, b) * M_PI / 180, 0.5, 0, 1e-12);
    assert_close(measure("normal_mean_deg", a, b) * M_PI / 180, (70 * 0.1 + 38 * 0.5) / 108, 0, 1e-12);
    assert_true(ssfr_metric_counts(SSFR_METRIC_NORMAL, &(ssfr_pair){.a = a, .b = b}, 4, 3));
    assert_false(ssfr_metric_counts(SSFR_METRIC_NORMAL, &(ssfr_pair){.a = a, .b = b}, 3, 3));
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
}

/* ---- all of them ------------------------------------------------------------------------------------------------ */

static void masks_leave_out_what_they_hide(void **state)
{
    (void)state;
    for (int i = 0; ssfr_metric_at(i); i++) {
        const ssfr_metric *m = ssfr_metric_at(i);
        ssfr_field *b = make_kind(m->kind, 40, 30, 5), *a = make_noisy(b, 0.01), *mask = test_image(40, 30, 1, 2.385);
        const double whole = measure(m->name, a, b);
        assert_true(measure_masked(m->name, a, b, mask) == whole);
        fill_rectangle(mask, 0, 0, 20, 30, 0);
        const double half = measure_masked(m->name, a, b, mask);
        fill_rectangle(a, 0, 0, 10, 30, (double)NAN); /* hidden, and further than SSIM's window from what counts */
        assert_true(measure_masked(m->name, a, b, mask) == half);
        fill_rectangle(mask, 0, 0, 40, 30, 0);
        const double none = measure_masked(m->name, a, b, mask);
        assert_true(strcmp(m->name, "nan_count") == 0 ? none == 0 : isnan(none));
        ssfr_field_destroy(&a);
        ssfr_field_destroy(&b);
        ssfr_field_destroy(&mask);
    }
}

/* At the border, where a pixel is an edge, and amid the picture, where it is interior. */
static void nan_on_either_side_makes_nan(void **state)
{
    (void)state;
    for (int i = 0; ssfr_metric_at(i); i++)
        for (int x = 0; x <= 9; x += 9) {
            const ssfr_metric *m = ssfr_metric_at(i);
            const bool counts = strcmp(m->name, "nan_count") == 0;
            ssfr_field *a = make_kind(m->kind, 20, 12, 1), *b = make_kind(m->kind, 20, 12, 2);
            assert_true(isfinite(measure(m->name, a, b)));
            ssfr_field_at(a, x, 5)[a->c - 1] = (double)NAN;
            const double nan_a = measure(m->name, a, b), nan_b = measure(m->name, b, a);
            if (!counts && !(isnan(nan_a) && isnan(nan_b))) print_error("%s: %g and %g\n", m->name, nan_a, nan_b);
            assert_true(counts ? nan_a == 1 && nan_b == 0 : isnan(nan_a) && isnan(nan_b));
            ssfr_field_destroy(&a);
            ssfr_field_destroy(&b);
        }
}

static void infinities_are_counted_and_do_not_crash(void **state)
{
    (void)state;
    for (int i = 0; ssfr_metric_at(i); i++) {
        const ssfr_metric *m = ssfr_metric_at(i);
        ssfr_field *a = make_kind(m->kind, 20, 12, 1), *b = make_kind(m->kind, 20, 12, 2);
        double value = 0;
        ssfr_field_at(a, 7, 5)[0] = INFINITY, ssfr_field_at(a, 9, 5)[0] = -INFINITY;
        assert_int_equal(ssfr_metric_measure(m, a, b, NULL, &value), SSFR_OK);
        if (strcmp(m->name, "nan_count") == 0) assert_true(value == 2);
        if (strcmp(m->name, "max_abs") == 0) assert_true(value == INFINITY);
        if (m->kind == SSFR_METRIC_DEPTH) assert_true(isfinite(value)); /* an infinite depth is an empty pixel */
        ssfr_field_destroy(&a);
        ssfr_field_destroy(&b);
    }
}

static void one_pixel_is_enough(void **state)
{
    (void)state;
    for (int i = 0; ssfr_metric_at(i); i++) {
        const ssfr_metric *m = ssfr_metric_at(i);
        ssfr_field *a = make_kind(m->kind, 1, 1, 1), *b = make_kind(m->kind, 1, 1, 2);
        const bool empty = strstr(m->name, "interior") != NULL; /* no pixel there has neighbours */
        assert_true(empty ? isnan(measure(m->name, a, b)) : isfinite(measure(m->name, a, b)));
        ssfr_field_destroy(&a);
        ssfr_field_destroy(&b);
    }
}

static void threads_do_not_change_a_bit(void **state)
{
    (void)state;
    const int n_threads = omp_get_max_threads();
    for (int i = 0; ssfr_metric_at(i); i++) {
        const ssfr_metric *m = ssfr_metric_at(i);
        ssfr_field *a = make_kind(m->kind, 97, 61, 1), *b = make_kind(m->kind, 97, 61, 2);
        omp_set_num_threads(1);
        const double one = measure(m->name, a, b);
        for (int n = 2; n <= 5; n++) {
            omp_set_num_threads(n);
            assert_true(measure(m->name, a, b) == one);
        }
        ssfr_field_destroy(&a);
        ssfr_field_destroy(&b);
    }
    omp_set_num_threads(n_threads);
}

static void images_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    double value = 2.385;
    for (int i = 0; ssfr_metric_at(i); i++) {
        const ssfr_metric *m = ssfr_metric_at(i);
        ssfr_field *a = make_kind(m->kind, 20, 12, 1), *b = make_kind(m->kind, 20, 13, 2);
        ssfr_field *two = test_image(20, 12, 2, 0.5), *mask = test_image(19, 12, 1, 1);
        assert_fails(SSFR_ERR_VALUE, ssfr_metric_measure(m, a, b, NULL, &value), "20 x 12 pixels");
        assert_non_null(strstr(test_last_error(), "against 20 x 13"));
        assert_fails(SSFR_ERR_VALUE, ssfr_metric_measure(m, a, two, NULL, &value), "against 20 x 12 of 2");
        assert_fails(SSFR_ERR_VALUE, ssfr_metric_measure(m, a, a, mask, &value), "a mask of 19 x 12 pixels and 1 ch");
        assert_fails(SSFR_ERR_VALUE, ssfr_metric_measure(m, a, a, two, &value), "a mask of 20 x 12 pixels and 2 ch");
        if (m->kind != SSFR_METRIC_ANY)
            assert_fails(SSFR_ERR_VALUE, ssfr_metric_measure(m, two, two, NULL, &value), "2 channels do not make a");
        assert_true(value == 2.385);
        ssfr_field_destroy(&mask);
        ssfr_field_destroy(&two);
        ssfr_field_destroy(&b);
        ssfr_field_destroy(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_metric_is_found_by_its_name),
        cmocka_unit_test(a_constant_offset_is_rms_max_and_mean),
        cmocka_unit_test(rms_mean_and_max_differ_where_they_should),
        cmocka_unit_test(interior_and_edge_share_out_the_surface),
        cmocka_unit_test(the_border_of_the_image_is_edge),
        cmocka_unit_test(iou_of_rectangles_is_their_overlap),
        cmocka_unit_test(rotated_normals_give_their_angle),
        cmocka_unit_test(oblique_normals_keep_tiny_angles),
        cmocka_unit_test(the_last_digits_of_a_normal_count),
        cmocka_unit_test(a_zero_vector_is_no_surface),
        cmocka_unit_test(psnr_follows_from_the_display_difference),
        cmocka_unit_test(squares_and_largest_are_of_linear_values),
        cmocka_unit_test(ssim_is_one_only_for_equal_images),
        cmocka_unit_test(ssim_agrees_with_its_definition_on_0_to_255),
        cmocka_unit_test(ssim_under_a_mask_is_the_mean_over_it),
        cmocka_unit_test(what_opencv_throws_comes_back_as_one_line),
        cmocka_unit_test(biases_and_maxima_of_the_interior_stand_apart),
        cmocka_unit_test(the_median_is_the_middle_of_the_interior),
        cmocka_unit_test(normals_of_interior_and_edge_share_out_the_surface),
        cmocka_unit_test(a_sampled_reference_leaves_neighbours_to_the_measured_image),
        cmocka_unit_test(sampled_normals_are_interior_by_the_measured_image_too),
        cmocka_unit_test(pixels_add_up_to_the_metric),
        cmocka_unit_test(masks_leave_out_what_they_hide),
        cmocka_unit_test(nan_on_either_side_makes_nan),
        cmocka_unit_test(infinities_are_counted_and_do_not_crash),
        cmocka_unit_test(one_pixel_is_enough),
        cmocka_unit_test(threads_do_not_change_a_bit),
        cmocka_unit_test(images_that_do_not_fit_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

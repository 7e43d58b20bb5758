/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_sampled.c: samples of one pixel a square: found, without bias, and their intervals hold in 95 of 100 samples. */
#include "experiments/sampled.h"
#include "tests/util.h"

#include <gsl/gsl_cdf.h>

/* One pixel of each square of N x N. */
static ssfr_field *draw_cast(int w, int h, int every, uint64_t seed)
{
    ssfr_field *cast = test_image(w, h, 1, 0);
    for (int y = 0; y < h; y += every)
        for (int x = 0; x < w; x += every) {
            const double across = test_random(&seed, 0, ssfr_min_int(every, w - x));
            const double down = test_random(&seed, 0, ssfr_min_int(every, h - y));
            *ssfr_field_at(cast, x + (int)across, y + (int)down) = 1;
        }
    return cast;
}

/* ---- what is a sample -------------------------------------------------------------------------------------------- */

static void the_size_of_squares_is_found(void **state)
{
    (void)state;
    static const int sizes[][2] = {{64, 48}, {61, 47}, {5, 90}, {1, 1}};
    for (size_t i = 0; i < SSFR_COUNT(sizes); i++)
        for (int every = 1; every <= 9; every++) {
            const int w = sizes[i][0], h = sizes[i][1], largest = ssfr_max_int(w, h);
            ssfr_field *cast = draw_cast(w, h, every, 7 + (uint64_t)every);
            int found = 0;
            assert_int_equal(ssfr_sampled_find(cast, "t.exr", &found), SSFR_OK);
            assert_true(found == every || every > largest);
            ssfr_field_destroy(&cast);
        }
}

static void what_is_no_sample_is_refused(void **state)
{
    (void)state;
    ssfr_field *cast = draw_cast(64, 48, 4, 3), *none = test_image(64, 48, 1, 0);
    int every;
    assert_fails(SSFR_ERR_VALUE, ssfr_sampled_find(none, "t.exr", &every), "t.exr: cast is not 0 at 0 of 64x48");
    for (int i = 0; i < 64 * 48; i++)
        if (cast->data[i] != 0) {
            cast->data[i] = 0;
            break;
        }
    assert_fails(SSFR_ERR_VALUE, ssfr_sampled_find(cast, "t.exr", &every), "at 191 of 64x48 pixels");
    *ssfr_field_at(cast, 63, 47) = *ssfr_field_at(cast, 62, 47) = 1; /* as many, but two in one square */
    assert_fails(SSFR_ERR_VALUE, ssfr_sampled_find(cast, "t.exr", &every), "not one of each square");
    ssfr_field_destroy(&cast);
    ssfr_field_destroy(&none);
}

/* ---- the estimate ------------------------------------------------------------------------------------------------ */

/* Of the square's pixels all are equally likely, so that where squares are cut theirs count for less. */
static void pixels_are_weighted_by_their_squares(void **state)
{
    (void)state;
    ssfr_field *a = test_image(5, 4, 1, -1), *b = test_image(5, 4, 1, -1), *cast = test_image(5, 4, 1, 0);
    ssfr_sampled s;
    const ssfr_pair pair = {.a = a, .b = b, .mask = cast, .sampled = true};
    *ssfr_field_at(cast, 1, 2) = *ssfr_field_at(cast, 4, 1) = 1; /* squares of 16 and of 4 pixels */
    *ssfr_field_at(a, 1, 2) += 0.01;
    *ssfr_field_at(a, 4, 1) -= 0.02;
    assert_int_equal(ssfr_sampled_metric(ssfr_metric_find("depth_mean"), &pair, cast, 4, &s), SSFR_OK);
    assert_close(s.value, 0.8 * 0.01 - 0.2 * 0.02, 0, 1e-12);
    assert_true(s.low == -INFINITY && s.high == INFINITY); /* two pixels tell nothing */
    assert_int_equal(ssfr_sampled_metric(ssfr_metric_find("depth_rms"), &pair, cast, 4, &s), SSFR_OK);
    assert_close(s.value, sqrt(0.8 * 1e-4 + 0.2 * 4e-4), 0, 1e-12);
    assert_true(s.low == 0 && s.high == INFINITY);
    assert_int_equal(ssfr_sampled_metric(ssfr_metric_find("silhouette_iou"), &pair, cast, 4, &s), SSFR_OK);
    assert_true(s.value == 1 && s.low == 0 && s.high == 1);
    a->data[4 + 5] = (double)NAN;
    assert_int_equal(ssfr_sampled_metric(ssfr_metric_find("depth_rms"), &pair, cast, 4, &s), SSFR_OK);
    assert_true(isnan(s.value) && isnan(s.high));
    ssfr_field_destroy(&a), ssfr_field_destroy(&b), ssfr_field_destroy(&cast);
}

/* A pair of squares (d_1, d_2) has the variance (d_1 - d_2)^2: here all pairs have the same, so that there are as many
 * degrees of freedom as pairs. */
static void the_interval_of_alternating_values_is_known(void **state)
{
    (void)state;
    enum { PAIRS = 20 };
    ssfr_field *a = test_image(4 * PAIRS, 2, 1, 0), *b = test_image(4 * PAIRS, 2, 1, 0);
    ssfr_field *cast = test_image(4 * PAIRS, 2, 1, 0);
    const ssfr_pair pair = {.a = a, .b = b, .mask = cast, .sampled = true};
    ssfr_sampled s;
    for (int i = 0; i < 2 * PAIRS; i++) *ssfr_field_at(cast, 2 * i, 1) = 1, *ssfr_field_at(a, 2 * i, 1) = 3 + i % 2;
    for (int i = 0; i < 8 * PAIRS; i++) a->data[i] = sqrt(a->data[i]); /* mse squares it */
    assert_int_equal(ssfr_sampled_metric(ssfr_metric_find("mse"), &pair, cast, 2, &s), SSFR_OK);
    assert_close(s.value, 3.5, 0, 1e-12);
    const double half = 2.0859634472658 * sqrt(PAIRS) / (2 * PAIRS); /* Student's with 20 degrees, from tables */
    assert_close(s.high - s.value, half, 0, 1e-9);
    assert_close(s.value - s.low, half, 0, 1e-9);
    ssfr_field_destroy(&a), ssfr_field_destroy(&b), ssfr_field_destroy(&cast);
}

/* Where all that was cast agrees, a share that was not seen may still differ. */
static void a_share_of_one_has_an_interval(void **state)
{
    (void)state;
    ssfr_field *a = test_image(60, 60, 1, -1), *cast = draw_cast(60, 60, 6, 3);
    const ssfr_pair pair = {.a = a, .b = a, .mask = cast, .sampled = true};
    ssfr_sampled s;
    assert_int_equal(ssfr_sampled_metric(ssfr_metric_find("silhouette_iou"), &pair, cast, 6, &s), SSFR_OK);
    assert_true(s.value == 1 && s.high == 1);
    assert_close(s.low, 1 + log(0.025) / 100, 0, 1e-12); /* of 100 squares */
    ssfr_field_destroy(&a), ssfr_field_destroy(&cast);
}

enum { W = 93, H = 71 }; /* squares are cut on both sides */

typedef struct scene { /* two images of a blob on the ground; the blob of b is a little larger */
    ssfr_field *depth[2], *normal[2], *colour[2];
} scene;

static scene make_scene(void)
{
    scene s;
    uint64_t seed = 5;
    for (int k = 0; k < 2; k++) {
        s.depth[k] = test_image(W, H, 1, -SSFR_EMPTY), s.normal[k] = test_image(W, H, 3, 0),
        s.colour[k] = test_image(W, H, 3, 0.2);
        for (int i = 0; i < W * H; i++) {
            const double u = (i % W - 0.45 * W) / (0.35 * W), v = (i / W - 0.5 * H) / (0.4 * H), r2 = u * u + v * v;
            const double noise = test_random(&seed, -0.02, 0.02) * k;
            if (r2 > (k ? 1.1 : 1)) continue;
            s.depth[k]->data[i] = -2.385 + 0.3 * (1.2 - r2) * (k ? 1 : 1.1) + noise;
            double *normal = s.normal[k]->data + 3 * i;
            normal[0] = u + noise, normal[1] = v - 0.1 * k, normal[2] = 1;
            ssfr_normalize(normal);
            for (int c = 0; c < 3; c++)
                s.colour[k]->data[3 * i + c] = 0.3 + 0.2 * u * (c + 1) / 3 * (k ? 1 : 0.9) + noise;
        }
    }
    return s;
}

static void finish(scene *s)
{
    for (int k = 0; k < 2; k++)
        ssfr_field_destroy(&s->depth[k]), ssfr_field_destroy(&s->normal[k]), ssfr_field_destroy(&s->colour[k]);
}

/* As the file of a truth holds it: nothing where nothing was cast. */
static ssfr_field *hide(const ssfr_field *of, const ssfr_field *cast, double empty)
{
    ssfr_field *field = test_image(of->w, of->h, of->c, empty);
    for (int i = 0; i < of->w * of->h; i++)
        if (cast->data[i] != 0)
            for (int c = 0; c < of->c; c++) field->data[i * of->c + c] = of->data[i * of->c + c];
    return field;
}

typedef struct coverage {
    int n, held;
    double sum, width; /* of estimates and of intervals */
} coverage;

static void try_sample(const char *name, const ssfr_field *a, const ssfr_field *b, double empty, uint64_t seed,
                       double whole, coverage *out)
{
    ssfr_field *cast = draw_cast(W, H, 6, seed), *seen = hide(b, cast, empty);
    const ssfr_pair pair = {.a = a, .b = seen, .mask = cast, .sampled = true};
    ssfr_sampled s;
    assert_int_equal(ssfr_sampled_metric(ssfr_metric_find(name), &pair, cast, 6, &s), SSFR_OK);
    assert_true(s.low <= s.value && s.value <= s.high);
    out->n++;
    out->held += s.low <= whole && whole <= s.high;
    out->sum += s.value;
    out->width += fmin(s.high - s.low, 100); /* psnr has no upper end where no error is not excluded */
    ssfr_field_destroy(&seen);
    ssfr_field_destroy(&cast);
}

/* Pairs of neighbours differ by what the picture does between them, so that intervals are rather too wide. That the
 * interior is asked of a alone changes nothing where a's surface is the smaller one. */
static void intervals_hold_in_95_of_100_samples(void **state)
{
    (void)state;
    static const char *const names[] = {"depth_mean", "depth_rms", "depth_mean_interior", "silhouette_iou",
                                        "normal_mean_deg", "normal_mean_interior_deg", "psnr", "mse"};
    enum { SAMPLES = 250 };
    scene s = make_scene();
    for (size_t i = 0; i < SSFR_COUNT(names); i++) {
        const ssfr_metric *metric = ssfr_metric_find(names[i]);
        const bool normal = metric->kind == SSFR_METRIC_NORMAL, depth = metric->kind == SSFR_METRIC_DEPTH;
        ssfr_field *const *images = normal ? s.normal : depth ? s.depth : s.colour;
        coverage c = {0};
        double whole = NAN;
        assert_int_equal(ssfr_metric_measure(metric, images[0], images[1], NULL, &whole), SSFR_OK);
        for (uint64_t seed = 1; seed <= SAMPLES; seed++)
            try_sample(names[i], images[0], images[1], depth ? -SSFR_EMPTY : 0, 977 * seed, whole, &c);
        assert_true(c.held >= SAMPLES * 92 / 100);
        assert_close(c.sum / c.n, whole, 0.2 * c.width / c.n, 0); /* no bias to speak of */
    }
    finish(&s);
}

/* Five pixels 2 m off make nearly all of the mean of squares, and four of five samples have none of them: the interval
 * still holds, and its upper end is what as many pixels as may escape a sample can come to. */
static void few_pixels_that_are_far_off_do_not_escape(void **state)
{
    (void)state;
    enum { SAMPLES = 100 };
    static const char *const names[] = {"depth_rms", "depth_rms_interior", "depth_mean_interior"};
    scene s = make_scene();
    coverage c;
    double whole = NAN;
    for (int i = 0; i < 5; i++) *ssfr_field_at(s.depth[0], 35 + 2 * i, 32 + i) += 2;
    for (size_t i = 0; i < SSFR_COUNT(names); i++) {
        c = (coverage){0};
        const ssfr_metric *metric = ssfr_metric_find(names[i]);
        assert_int_equal(ssfr_metric_measure(metric, s.depth[0], s.depth[1], NULL, &whole), SSFR_OK);
        for (uint64_t seed = 1; seed <= SAMPLES; seed++)
            try_sample(names[i], s.depth[0], s.depth[1], -SSFR_EMPTY, 977 * seed, whole, &c);
        assert_true(c.held >= SAMPLES * 95 / 100);
        assert_true(c.width / SAMPLES < 1); /* still worth something: a pixel can be off by 2.4 m */
    }
    finish(&s);
}

static const ssfr_sampled_range none;

static void flat(const void *user, int x, int y, double *sum, double *n)
{
    (void)x, (void)y;
    *n = 1;
    *sum = *(const double *)user;
}

/* Not to see a share p in any of n squares has a chance of e^(-n p): 2.5 % for p = -log(0.025) / n. */
static void what_may_escape_widens_by_what_it_may_be_worth(void **state)
{
    (void)state;
    ssfr_field *cast = draw_cast(60, 60, 6, 3);
    const ssfr_sampled_range wide = {-3, 17};
    const double value = 2.385, escapes = -log(0.025) / 100;
    ssfr_sampled s;
    assert_int_equal(ssfr_sampled_mean(cast, 6, flat, &value, none, &s), SSFR_OK);
    assert_true(s.low == s.value && s.high == s.value);
    assert_close(s.value, value, 0, 1e-12);
    assert_int_equal(ssfr_sampled_mean(cast, 6, flat, &value, wide, &s), SSFR_OK);
    assert_close(s.low, value - (value + 3) * escapes, 0, 1e-12);
    assert_close(s.high, value + (17 - value) * escapes, 0, 1e-12);
    ssfr_field_destroy(&cast);
    cast = test_image(60, 60, 1, 1);
    assert_int_equal(ssfr_sampled_mean(cast, 1, flat, &value, wide, &s), SSFR_OK); /* nothing escapes */
    assert_true(s.low == s.value && s.high == s.value);
    ssfr_field_destroy(&cast);
}

/* In the order of the pairs, to and fro: pair j has 10 j and 1 more, but the fourth has 4 more. */
static void in_pairs(const void *user, int x, int y, double *sum, double *n)
{
    const int across = *(const int *)user, row = y / 6, column = x / 6;
    const int at = row * across + (row % 2 ? across - 1 - column : column);
    *n = 1;
    *sum = 10 * (at / 2) + (at % 2) * (at / 2 == 3 ? 4 : 1);
}

/* Of ten pairs nine have the variance 1 and one 16: by Satterthwaite 3 (9 + 16)^2 / (9 + 16^2) - 2 degrees, because a
 * pair's variance squared is thrice too large. */
static void a_pair_that_holds_most_leaves_few_degrees(void **state)
{
    (void)state;
    enum { ACROSS = 5, DOWN = 4 };
    ssfr_field *cast = draw_cast(6 * ACROSS, 6 * DOWN, 6, 3);
    const int across = ACROSS;
    const double half = gsl_cdf_tdist_Pinv(0.975, 3 * 625 / 265.0 - 2) * 5 / (ACROSS * DOWN);
    ssfr_sampled s;
    assert_int_equal(ssfr_sampled_mean(cast, 6, in_pairs, &across, none, &s), SSFR_OK);
    assert_close(s.high - s.value, half, 0, 1e-9);
    assert_close(s.value - s.low, half, 0, 1e-9);
    ssfr_field_destroy(&cast);
}

/* Depths span what both images have: here the farthest is in the reference, the nearest in the frame. */
static void depths_may_be_as_far_apart_as_both_images_reach(void **state)
{
    (void)state;
    ssfr_field *a = test_image(60, 60, 1, -2), *b = test_image(60, 60, 1, -2), *cast = draw_cast(60, 60, 6, 3);
    const ssfr_pair pair = {.a = a, .b = b, .mask = cast, .sampled = true};
    const double escapes = -log(0.025) / 100;
    ssfr_sampled s;
    int hidden = 0;
    while (cast->data[hidden] != 0) hidden++;
    a->data[hidden] = -1, b->data[hidden] = -4.385;
    assert_int_equal(ssfr_sampled_metric(ssfr_metric_find("depth_mean"), &pair, cast, 6, &s), SSFR_OK);
    assert_close(s.high, 3.385 * escapes, 0, 1e-12);
    assert_close(s.low, -3.385 * escapes, 0, 1e-12);
    assert_int_equal(ssfr_sampled_metric(ssfr_metric_find("depth_rms"), &pair, cast, 6, &s), SSFR_OK);
    assert_close(s.high, 3.385 * sqrt(escapes), 0, 1e-12);
    assert_true(s.low == 0);
    ssfr_field_destroy(&a), ssfr_field_destroy(&b), ssfr_field_destroy(&cast);
}

/* Only the first row of squares counts. */
static void first_row(const void *user, int x, int y, double *sum, double *n)
{
    (void)user;
    *n = y < 6;
    *sum = *n * (x / 6 % 2);
}

/* 10 pairs with the same variance: as many degrees, however many pairs there are of which nothing counts. */
static void pairs_without_a_pixel_that_counts_tell_nothing(void **state)
{
    (void)state;
    ssfr_field *cast = draw_cast(120, 60, 6, 3);
    const double half = gsl_cdf_tdist_Pinv(0.975, 10) * sqrt(10) / 20;
    ssfr_sampled s;
    assert_int_equal(ssfr_sampled_mean(cast, 6, first_row, NULL, none, &s), SSFR_OK);
    assert_close(s.value, 0.5, 0, 1e-12);
    assert_close(s.high - s.value, half, 0, 1e-9);
    ssfr_field_destroy(&cast);
}

typedef struct some { /* the first n pixels that are asked for count */
    const ssfr_field *cast;
    int n;
} some;

static void in_order(const void *user, int x, int y, double *sum, double *n)
{
    const some *s = user;
    int before = 0;
    for (int i = 0; i < y * s->cast->w + x; i++) before += s->cast->data[i] != 0;
    *n = before < s->n;
    *sum = *n > 0 ? before % 3 : 0;
}

static void ten_pixels_are_the_fewest_that_have_an_interval(void **state)
{
    (void)state;
    ssfr_field *cast = draw_cast(60, 60, 6, 3);
    ssfr_sampled s;
    assert_int_equal(ssfr_sampled_mean(cast, 6, in_order, &(some){cast, 9}, none, &s), SSFR_OK);
    assert_true(s.value == 1 && s.low == -INFINITY && s.high == INFINITY);
    assert_int_equal(ssfr_sampled_mean(cast, 6, in_order, &(some){cast, 10}, none, &s), SSFR_OK);
    assert_close(s.value, 0.9, 0, 1e-12);
    assert_true(s.low > 0 && s.low < 0.9 && s.high > 0.9 && s.high < 2);
    assert_int_equal(ssfr_sampled_mean(cast, 6, in_order, &(some){cast, 0}, none, &s), SSFR_OK);
    assert_true(isnan(s.value) && isnan(s.low) && isnan(s.high));
    ssfr_field_destroy(&cast);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_size_of_squares_is_found),
        cmocka_unit_test(what_is_no_sample_is_refused),
        cmocka_unit_test(pixels_are_weighted_by_their_squares),
        cmocka_unit_test(the_interval_of_alternating_values_is_known),
        cmocka_unit_test(a_share_of_one_has_an_interval),
        cmocka_unit_test(intervals_hold_in_95_of_100_samples),
        cmocka_unit_test(few_pixels_that_are_far_off_do_not_escape),
        cmocka_unit_test(what_may_escape_widens_by_what_it_may_be_worth),
        cmocka_unit_test(a_pair_that_holds_most_leaves_few_degrees),
        cmocka_unit_test(depths_may_be_as_far_apart_as_both_images_reach),
        cmocka_unit_test(pairs_without_a_pixel_that_counts_tell_nothing),
        cmocka_unit_test(ten_pixels_are_the_fewest_that_have_an_interval),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

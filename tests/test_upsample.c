/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_upsample.c: what each filter reproduces, and what it keeps apart. */
#include "tests/pass_util.h"

enum { W = 48, H = 32 };

static const char *const filters[] = {"nearest", "linear", "cubic"};
static const int factors[] = {2, 4, 8};

/* A guide of one depth, and a radius of 0.1 m: by default depths 0.5 m away are another surface. */
static test_twin *begin(void **state, double guide)
{
    static const double c[1][3] = {{0, 0, -2.385}};
    test_twin *t = test_twin_create(state, "upsample", W, H);
    test_twin_place(t, 1, c, 0.1, NULL);
    test_twin_give(t, "guide", test_field_filled(W, H, 1, guide));
    return t;
}

static const ssfr_field *run(test_twin *t, const char *filter, const ssfr_field *low)
{
    test_twin_set(t, "filter", "%s", filter);
    test_twin_give(t, "depth", low);
    const ssfr_field *surface = test_twin_run(t, "surface");
    assert_int_equal(surface->w, W);
    assert_int_equal(surface->h, H);
    return surface;
}

/* 2.385 rounded to float, so that both twins begin with the same number. */
#define DEPTH (-(double)2.385f)

static void constant_depth_comes_back_to_the_last_bit(void **state)
{
    test_twin *t = begin(state, DEPTH);
    for (size_t f = 0; f < SSFR_COUNT(filters); f++)
        for (size_t n = 0; n < SSFR_COUNT(factors); n++) {
            const ssfr_field *low = test_field_filled(W / factors[n], H / factors[n], 1, DEPTH);
            const ssfr_field *surface = run(t, filters[f], low);
            for (int i = 0; i < W * H; i++) assert_true(surface->data[i] == DEPTH);
        }
}

/* A function of the place in low-resolution pixels, whose middles stand at integers. */
typedef double function(double x, double y);

static double slope(double x, double y) { return -2.4 + 0.011 * x - 0.0173 * y; }
static double bowl(double x, double y) { return -2.4 + 0.00031 * x * x + 0.00017 * y * y; }

static const ssfr_field *sample(function *f, int n)
{
    ssfr_field *low = test_field(W / n, H / n, 1);
    for (int y = 0; y < low->h; y++)
        for (int x = 0; x < low->w; x++) *ssfr_field_at(low, x, y) = f(x, y);
    return low;
}

/* Pixels whose 4 x 4 low neighbours are all inside the image. */
static bool inside(int x, int y, int n)
{
    const double u = (x + 0.5) / n - 0.5, v = (y + 0.5) / n - 0.5;
    return u >= 1 && v >= 1 && u < W / n - 2 && v < H / n - 2;
}

/* Weights that sum to one, and whose mean place is the pixel's own. */
static void linear_and_cubic_reproduce_a_slope(void **state)
{
    test_twin *t = begin(state, -2.4);
    for (size_t f = 1; f < SSFR_COUNT(filters); f++)
        for (size_t k = 0; k < SSFR_COUNT(factors); k++) {
            const int n = factors[k];
            const ssfr_field *surface = run(t, filters[f], sample(slope, n));
            for (int y = 0; y < H; y++)
                for (int x = 0; x < W; x++) {
                    const double expected = slope((x + 0.5) / n - 0.5, (y + 0.5) / n - 0.5);
                    if (inside(x, y, n)) assert_close(*ssfr_field_at(surface, x, y), expected, 0, 8 * t->eps);
                }
        }
}

/* Between samples a fraction s apart from the left one, linear weights have the variance s (1 - s); B-splines 1/3
 * everywhere. */
static void filters_add_their_variance_to_a_parabola(void **state)
{
    test_twin *t = begin(state, -2.4);
    for (size_t k = 0; k < SSFR_COUNT(factors); k++) {
        const int n = factors[k];
        const ssfr_field *linear = run(t, "linear", sample(bowl, n)), *cubic = run(t, "cubic", sample(bowl, n));
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++) {
                const double u = (x + 0.5) / n - 0.5, v = (y + 0.5) / n - 0.5, s = u - floor(u), r = v - floor(v);
                if (!inside(x, y, n)) continue;
                const double added = 0.00031 * s * (1 - s) + 0.00017 * r * (1 - r);
                assert_close(*ssfr_field_at(linear, x, y), bowl(u, v) + added, 0, 8 * t->eps);
                assert_close(*ssfr_field_at(cubic, x, y), bowl(u, v) + (0.00031 + 0.00017) / 3, 0, 8 * t->eps);
            }
    }
}

static void nearest_repeats_each_low_pixel(void **state)
{
    test_twin *t = begin(state, -2.4);
    for (size_t k = 0; k < SSFR_COUNT(factors); k++) {
        const int n = factors[k];
        const ssfr_field *low = sample(bowl, n), *surface = run(t, "nearest", low);
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++)
                assert_close(*ssfr_field_at(surface, x, y), *ssfr_field_at(low, x / n, y / n), 0, t->eps);
    }
}

/* The guide steps in the middle of a low pixel, which belongs to the near side: the far side takes its depth from
 * further off. */
static void nothing_bleeds_across_a_step(void **state)
{
    test_twin *t = begin(state, -2.5);
    ssfr_field *guide = test_field(W, H, 1), *low = test_field(W / 4, H / 4, 1);
    for (int i = 0; i < W * H; i++) guide->data[i] = i % W < 22 ? -2 : -2.75;
    for (int i = 0; i < low->w * low->h; i++) low->data[i] = i % low->w < 6 ? -2.125 : -2.875;
    test_twin_give(t, "guide", guide);
    for (size_t f = 1; f < SSFR_COUNT(filters); f++) {
        const ssfr_field *surface = run(t, filters[f], low);
        for (int i = 0; i < W * H; i++) assert_close(surface->data[i], i % W < 22 ? -2.125 : -2.875, 0, t->eps);
    }
    test_twin_set(t, "depth_falloff", "20"); /* 2 m: now it is one surface */
    assert_true(*ssfr_field_at(run(t, "cubic", low), 22, 9) > -2.7);
}

/* Where no low neighbour is the pixel's own surface, it stays as it was. */
static void strays_keep_their_own_depth(void **state)
{
    test_twin *t = begin(state, -2.5);
    ssfr_field *guide = test_field_filled(W, H, 1, -2.5);
    *ssfr_field_at(guide, 17, 13) = -9.25;
    test_twin_give(t, "guide", guide);
    for (size_t f = 1; f < SSFR_COUNT(filters); f++) {
        const ssfr_field *surface = run(t, filters[f], test_field_filled(W / 2, H / 2, 1, -2.625));
        assert_true(*ssfr_field_at(surface, 17, 13) == -9.25);
        assert_close(*ssfr_field_at(surface, 18, 13), -2.625, 0, t->eps);
    }
}

/* However little it weighs: of eighth resolution and a cubic filter the corner of 4 x 4, (1/16)^6 / 36 of the whole. What
 * is as far as the falloff belongs to the surface, too. */
static void the_last_pixel_of_its_surface_tells_the_depth(void **state)
{
    test_twin *t = begin(state, -2.5);
    for (int k = 0; k < 2; k++) {
        ssfr_field *low = test_field_filled(W / 8, H / 8, 1, -9.25);
        *ssfr_field_at(low, 3, 3) = k ? -3 : -2.625;
        const ssfr_field *cubic = run(t, "cubic", low), *linear = run(t, "linear", low);
        assert_close(*ssfr_field_at(cubic, 12, 12), *ssfr_field_at(low, 3, 3), 0, t->eps);
        assert_true(*ssfr_field_at(cubic, 11, 12) == -2.5);
        assert_close(*ssfr_field_at(linear, 20, 20), *ssfr_field_at(low, 3, 3), 0, t->eps);
        assert_true(*ssfr_field_at(linear, 19, 20) == -2.5);
    }
    ssfr_field *low = test_field_filled(W / 8, H / 8, 1, -3.0625); /* beyond the falloff of 0.5 m */
    assert_true(test_difference(run(t, "cubic", low), test_field_filled(W, H, 1, -2.5)) == 0);
}

/* Holes of the low image do not pull, holes of the guide stay, and a low image of holes leaves the guide. */
static void nothing_bleeds_into_or_from_empty_pixels(void **state)
{
    test_twin *t = begin(state, -2.5);
    ssfr_field *guide = test_field(W, H, 1), *low = test_field(W / 4, H / 4, 1);
    uint64_t random = 3;
    for (int i = 0; i < W * H; i++) guide->data[i] = test_random(&random, 0, 1) < 0.7 ? -2.5 : -SSFR_EMPTY;
    for (int i = 0; i < low->w * low->h; i++) low->data[i] = test_random(&random, 0, 1) < 0.6 ? -2.625 : -SSFR_EMPTY;
    test_twin_give(t, "guide", guide);
    for (size_t f = 0; f < SSFR_COUNT(filters); f++) {
        const ssfr_field *surface = run(t, filters[f], low);
        int n_smooth = 0;
        for (int i = 0; i < W * H; i++) {
            const double z = surface->data[i];
            assert_int_equal(ssfr_is_surface(z), ssfr_is_surface(guide->data[i]));
            assert_true(!ssfr_is_surface(z) || z == -2.5 || fabs(z + 2.625) < 4 * t->eps);
            n_smooth += ssfr_is_surface(z) && z < -2.6;
        }
        assert_true(n_smooth > W * H / 3);
        surface = run(t, filters[f], test_field_filled(W / 4, H / 4, 1, -SSFR_EMPTY));
        assert_true(test_difference(surface, guide) == 0);
    }
}

/* ---- from downsampling on: odd sizes ----------------------------------------------------------------------------- */

static const ssfr_pipeline there_and_back = {
    .name = "there_and_back", .result = SSFR_SLOT_surface_depth,
    .nodes = {{"downsample"}, {"upsample", .ports = {{"depth", SSFR_SLOT_low_depth}}}},
};

static test_twin *begin_both(void **state, int factor, const char *filter, const ssfr_field *depth)
{
    static const double c[1][3] = {{0, 0, -2.385}};
    test_twin *t = test_twin_create_for(state, &there_and_back, depth->w, depth->h);
    test_twin_place(t, 1, c, 0.1, NULL);
    test_twin_set(t, "downsample.factor", "%d", factor);
    test_twin_set(t, "upsample.filter", "%s", filter);
    test_twin_give(t, "fluid_depth", depth);
    return t;
}

static void constant_depth_of_odd_size_comes_back_to_the_border(void **state)
{
    for (size_t f = 0; f < SSFR_COUNT(filters); f++)
        for (size_t n = 0; n < SSFR_COUNT(factors); n++) {
            const ssfr_field *depth = test_field_filled(37, 19, 1, -2.5);
            test_twin *t = begin_both(state, factors[n], filters[f], depth);
            assert_true(test_difference(test_twin_run(t, "surface_depth"), depth) == 0);
        }
}

/* A block's mean is the slope's value in the block's middle, where upsampling takes it to be. */
static void slope_of_odd_size_comes_back_inside(void **state)
{
    ssfr_field *depth = test_field(45, 37, 1);
    for (int i = 0; i < 45 * 37; i++) depth->data[i] = slope(i % 45, i / 45);
    for (size_t f = 1; f < SSFR_COUNT(filters); f++)
        for (size_t n = 0; n < 2; n++) {
            test_twin *t = begin_both(state, factors[n], filters[f], depth);
            const ssfr_field *surface = test_twin_run(t, "surface_depth");
            for (int y = 8; y < 25; y++)
                for (int x = 8; x < 33; x++)
                    assert_close(*ssfr_field_at(surface, x, y), *ssfr_field_at(depth, x, y), 0, 16 * t->eps);
        }
}

static void full_resolution_needs_no_pass(void **state)
{
    ssfr_node_status status;
    test_twin *t = begin(state, -2.5);
    const ssfr_field *low = sample(bowl, 1);
    for (size_t f = 0; f < SSFR_COUNT(filters); f++) {
        const ssfr_field *surface = run(t, filters[f], low);
        assert_true(test_same_bits(surface, test_twin_run_if_needed(t, "surface", &status)));
        assert_int_equal(status, SSFR_NEEDLESS);
    }
}

static void nothing_runs_without_fluid(void **state)
{
    static const double behind[1][3] = {{0, 0, 5}};
    ssfr_node_status status;
    test_twin *t = test_twin_create_for(state, &there_and_back, W, H);
    test_twin_place(t, 1, behind, 0.1, NULL);
    assert_int_equal(test_count(test_twin_run_if_needed(t, "surface_depth", &status)), 0);
    for (int i = 0; i < 2; i++) assert_int_equal(ssfr_graph_report(t->graph)->nodes[i].status, SSFR_NEEDLESS);
}

/* Samples a pixel: the guide, and 1, 2 x 2 or 4 x 4 of the depth. */
static void the_report_counts_the_samples_of_a_filter(void **state)
{
    static const double taps[] = {2, 5, 17};
    test_twin *t = begin(state, -2.5);
    for (size_t f = 0; f < SSFR_COUNT(filters); f++) {
        run(t, filters[f], sample(bowl, 2));
        assert_true(ssfr_graph_report(t->graph)->nodes[0].taps == taps[f]);
    }
}

static void upsample_refuses_values_out_of_range(void **state)
{
    test_twin *t = begin(state, -2.5);
    test_twin_refuses(t, "filter", "quintic", "quintic");
    test_twin_refuses(t, "depth_falloff", "-0.1", "upsample.depth_falloff");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(constant_depth_comes_back_to_the_last_bit),
        TEST_TWINS(linear_and_cubic_reproduce_a_slope),
        TEST_TWINS(filters_add_their_variance_to_a_parabola),
        TEST_TWINS(nearest_repeats_each_low_pixel),
        TEST_TWINS(nothing_bleeds_across_a_step),
        TEST_TWINS(strays_keep_their_own_depth),
        TEST_TWINS(the_last_pixel_of_its_surface_tells_the_depth),
        TEST_TWINS(nothing_bleeds_into_or_from_empty_pixels),
        TEST_TWINS(constant_depth_of_odd_size_comes_back_to_the_border),
        TEST_TWINS(slope_of_odd_size_comes_back_inside),
        TEST_TWINS(full_resolution_needs_no_pass),
        TEST_TWINS(nothing_runs_without_fluid),
        TEST_TWINS(the_report_counts_the_samples_of_a_filter),
        TEST_TWINS(upsample_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

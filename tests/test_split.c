/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_split.c: the surface that layers are composited with, straight from a depth of low resolution. */
#include "tests/pass_util.h"

enum { W = 32, H = 24, N = W * H };

/* ---- clear water over a scene that tells its places -------------------------------------------------------------- */

typedef struct pool {
    test_twin *t;
    int factor;
    ssfr_field *low, *scene, *scene_depth, *back;
} pool;

/* The scene's red and green are its places in pixels, and the water's normal shifts them by so many, times n_x, -n_y. */
static const double beta = 1;

static pool begin_sized(void **state, int w, int h, int factor)
{
    static const char *const clear[] = {"fresnel_bias", "fresnel_scale", "specular", "k"};
    const pool p = {.t = test_twin_create(state, "layer_composite", w, h), .factor = factor,
                    .low = test_field_filled((w + factor - 1) / factor, (h + factor - 1) / factor, 1, -3),
                    .scene = test_field(w, h, 3), .scene_depth = test_field_filled(w, h, 1, -9),
                    .back = test_field_filled(w, h, 1, 0.5)};
    for (int i = 0; i < w * h; i++) p.scene->data[3 * i] = i % w + 0.5, p.scene->data[3 * i + 1] = i / w + 0.5;
    test_twin_set(p.t, "surface", "split");
    test_twin_set(p.t, "attenuation", "single");
    test_twin_set(p.t, "gamma", "%.17g", beta / (0.5 * h));
    for (size_t k = 0; k < SSFR_COUNT(clear); k++) test_twin_set(p.t, clear[k], "0");
    return p;
}

static pool begin(void **state, int factor)
{
    return begin_sized(state, W, H, factor);
}

static void give(const pool *p)
{
    test_twin_give(p->t, "low", p->low);
    test_twin_give(p->t, "scene_color", p->scene);
    test_twin_give(p->t, "scene_depth", p->scene_depth);
    test_twin_give(p->t, "thickness_back", p->back);
}

static const ssfr_field *run(const pool *p, const char *output)
{
    give(p);
    return test_twin_run(p->t, output);
}

/* Where places of the scene are read to both sides: a ramp ends at the image's border. */
static bool is_amid(int x, int y)
{
    return x > 0 && x < W - 1 && y > 0 && y < H - 1;
}

static void normal_of(const ssfr_field *color, int x, int y, double n[2])
{
    const double *at = ssfr_field_at(color, x, y);
    n[0] = (at[0] - (x + 0.5)) / beta, n[1] = -(at[1] - (y + 0.5)) / beta;
}

static void assert_normal(const ssfr_field *color, int x, int y, const double n[3], double eps)
{
    double found[2];
    normal_of(color, x, y, found);
    for (int k = 0; k < 2; k++) assert_close(found[k], n[k], eps, 0);
}

static double rounding(const pool *p)
{
    return 16 * W * p->t->eps;
}

/* ---- inside ------------------------------------------------------------------------------------------------------ */

static const double first = -3, across = 0.041, down = -0.037; /* m, and m a pixel of the frame */

/* Its place in pixels of the frame. */
static double ramp_at(double x, double y)
{
    return first + across * x + down * y;
}

static void lay_ramp(const pool *p)
{
    for (int j = 0; j < p->low->h; j++)
        for (int i = 0; i < p->low->w; i++)
            *ssfr_field_at(p->low, i, j) = ramp_at((i + 0.5) * p->factor, (j + 0.5) * p->factor);
}

/* Its slope by eye-space x and y at unit distance. */
static void ramp_slope(const pool *p, double out[2])
{
    const ssfr_camera *c = &p->t->scene.camera;
    out[0] = across / (2 * c->tan_x / W), out[1] = -down / (2 * c->tan_y / H);
}

/* By its derivatives at the place of the pixel itself. */
static void ramp_normal(const pool *p, int x, int y, double n[3])
{
    const test_ray at = test_ray_at(p->t, x, y, 1);
    double slope[2];
    ramp_slope(p, slope);
    n[0] = -slope[0], n[1] = -slope[1], n[2] = -(ramp_at(x + 0.5, y + 0.5) + at.u * slope[0] + at.v * slope[1]);
    ssfr_normalize(n);
}

/* Listing A.18: over the depth of the pixel in the middle of a line, in the place's row or column. */
static void listing_normal(const pool *p, int x, int y, double n[3])
{
    const int factor = p->factor;
    double slope[2];
    ramp_slope(p, slope);
    n[0] = slope[0] / ramp_at((x / factor + 0.5) * factor, y + 0.5);
    n[1] = slope[1] / ramp_at(x + 0.5, (y / factor + 0.5) * factor);
    n[2] = 1;
    ssfr_normalize(n);
}

/* Depths that are linear in pixels come back as they are, and so do their slopes. */
static void inside_depth_and_slope_are_those_of_the_pixel(void **state)
{
    for (int factor = 1; factor <= 8; factor *= 2) {
        const pool p = begin(state, factor);
        lay_ramp(&p);
        test_twin_set(p.t, "border", "never");
        const ssfr_field *border = run(&p, "border"), *color = run(&p, "color");
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++) {
                const bool edge = x < factor || x >= W - factor || y < factor || y >= H - factor;
                double n[3];
                ramp_normal(&p, x, y, n);
                assert_true(*ssfr_field_at(border, x, y) == edge);
                if (!edge) assert_normal(color, x, y, n, rounding(&p));
            }
    }
}

/* Listing A.18 drops what the derivative of the ray gives: exact on the axis alone. */
static void without_off_axis_the_slope_counts_as_if_on_the_axis(void **state)
{
    const pool p = begin(state, 2);
    double largest = 0;
    lay_ramp(&p);
    test_twin_set(p.t, "off_axis", "0");
    const ssfr_field *color = run(&p, "color");
    for (int y = 2; y < H - 2; y++)
        for (int x = 2; x < W - 2; x++) {
            double n[3], own[3];
            listing_normal(&p, x, y, n);
            ramp_normal(&p, x, y, own);
            assert_normal(color, x, y, n, rounding(&p));
            largest = fmax(largest, acos(ssfr_clamp(ssfr_dot(n, own), -1, 1)));
        }
    assert_true(largest > 0.05); /* rad */
}

/* The scene before this depth is not refracted: so the depth is found. */
static void assert_depth(const pool *p, double z, int x0, int y0, double eps)
{
    for (int side = -1; side <= 1; side += 2) {
        ssfr_field_fill(p->scene_depth, -SSFR_EMPTY);
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++)
                *ssfr_field_at(p->scene_depth, x, y) = (double)(float)(ramp_at(x + 0.5, y + 0.5) + z + side * eps);
        const ssfr_field *color = run(p, "color");
        for (int y = y0; y < H - y0; y++)
            for (int x = x0; x < W - x0; x++) {
                double n[2];
                normal_of(color, x, y, n);
                assert_int_equal(fabs(n[0]) + fabs(n[1]) < 1e-3, side > 0); /* straight behind where it is rejected */
            }
    }
}

static void inside_depth_is_that_of_the_pixel(void **state)
{
    for (int factor = 1; factor <= 8; factor *= 2) {
        const pool p = begin(state, factor);
        lay_ramp(&p);
        test_twin_set(p.t, "gamma", "%.17g", 0.2 / (0.5 * H)); /* less than a pixel: its own scene depth is asked */
        assert_depth(&p, 0, factor, factor, 1e-5);
    }
}

/* The lines are read where the pixel is, but mixed half a pixel of the depth aside. */
static void b28_shifts_the_depth_by_a_quarter_of_a_pixel_of_it(void **state)
{
    const pool p = begin(state, 4);
    lay_ramp(&p);
    test_twin_set(p.t, "as_printed", "B28");
    test_twin_set(p.t, "gamma", "%.17g", 0.2 / (0.5 * H));
    assert_depth(&p, 0.25 * 4 * (across + down), 4, 4, 1e-5);
}

static void lay_plane(const pool *p, double z0, const double s[2])
{
    for (int j = 0; j < p->low->h; j++)
        for (int i = 0; i < p->low->w; i++)
            *ssfr_field_at(p->low, i, j) = test_plane(z0, s[0], s[1], test_ray_at(p->t, i, j, p->factor));
}

static double plane_error(void **state, int w, int h)
{
    static const double s[2] = {0.3, -0.2};
    const pool p = begin_sized(state, w, h, 2);
    double n[3] = {-s[0], -s[1], 1}, largest = 0;
    ssfr_normalize(n);
    lay_plane(&p, -3, s);
    const ssfr_field *color = run(&p, "color");
    for (int y = 2; y < h - 2; y++)
        for (int x = 2; x < w - 2; x++) {
            double found[2];
            normal_of(color, x, y, found);
            for (int k = 0; k < 2; k++) largest = fmax(largest, fabs(found[k] - n[k]));
        }
    return largest;
}

/* Its depths are not linear in pixels. */
static void inside_the_normal_of_a_plane_is_right_to_second_order(void **state)
{
    if (strcmp(*state, "gpu") == 0) {
        assert_true(plane_error(state, 64, 48) < 1e-4);
        return;
    }
    const double coarse = plane_error(state, 32, 24), fine = plane_error(state, 64, 48);
    assert_true(coarse < 1e-3);
    assert_close(test_order(coarse, fine, 2), 2, 0.2, 0);
}

/* ---- borders ----------------------------------------------------------------------------------------------------- */

/* Differences of places on a plane lie in it, wherever that is: also at the image's border, where one side lacks. */
static void at_borders_the_normal_of_a_plane_is_its_own(void **state)
{
    static const double s[2] = {0.3, -0.2};
    for (int factor = 1; factor <= 8; factor *= 2) {
        const pool p = begin(state, factor);
        double n[3] = {-s[0], -s[1], 1};
        ssfr_normalize(n);
        test_twin_set(p.t, "border", "always");
        test_twin_set(p.t, "lone_thresh", "0");
        lay_plane(&p, -3, s);
        const ssfr_field *color = run(&p, "color");
        for (int i = 0; i < N; i++)
            if (is_amid(i % W, i / W)) assert_normal(color, i % W, i / W, n, 4 * rounding(&p));
        const ssfr_field *border = run(&p, "border");
        for (int i = 0; i < N; i++) assert_true(border->data[i] == 1);
    }
}

/* Two walls that face the eye, one this much behind the other from column 4 of 8 on. */
static pool begin_step(void **state, double height)
{
    const pool p = begin(state, 4);
    for (int j = 0; j < p.low->h; j++)
        for (int i = 4; i < p.low->w; i++) *ssfr_field_at(p.low, i, j) -= height;
    return p;
}

static bool is_frame(int x, int y)
{
    return x < 4 || x >= W - 4 || y < 4 || y >= H - 4;
}

static void a_step_is_a_border_of_a_pixel_to_both_sides(void **state)
{
    for (int k = 0; k < 3; k++) {
        const double heights[] = {0.099, 0.101, -0.101};
        const pool p = begin_step(state, heights[k]);
        const ssfr_field *border = run(&p, "border");
        int n = 0;
        for (int i = 0; i < N; i++) {
            const int x = i % W;
            const bool expected = is_frame(x, i / W) || (k > 0 && x >= 12 && x < 20);
            assert_true(border->data[i] == expected);
            n += border->data[i] == 1;
        }
        assert_int_equal(n, N - (W - 8) * (H - 8) + (k > 0 ? 8 * (H - 8) : 0));
    }
}

static void the_threshold_is_depth_thresh(void **state)
{
    const pool p = begin_step(state, 0.3), flat = begin(state, 4);
    test_twin_set(flat.t, "depth_thresh", "0"); /* what does not bend at all does not bend more */
    assert_true(*ssfr_field_at(run(&flat, "border"), 15, 10) == 0);
    test_twin_set(p.t, "depth_thresh", "0.301");
    assert_true(*ssfr_field_at(run(&p, "border"), 15, 10) == 0);
    test_twin_set(p.t, "depth_thresh", "0.299");
    assert_true(*ssfr_field_at(run(&p, "border"), 15, 10) == 1);
    test_twin_set(p.t, "border", "never");
    assert_true(*ssfr_field_at(run(&p, "border"), 15, 10) == 0);
    assert_true(*ssfr_field_at(run(&p, "border"), 1, 1) == 1); /* nothing is there to be interpolated */
}

/* The lesser difference is that on a wall's own side: it faces the eye. As inside, the step would be a slope. */
static void at_a_step_normals_are_those_of_its_sides(void **state)
{
    static const double facing[3] = {0, 0, 1};
    const pool p = begin_step(state, 0.5);
    const ssfr_field *color = run(&p, "color");
    for (int i = 0; i < N; i++)
        if (is_amid(i % W, i / W)) assert_normal(color, i % W, i / W, facing, rounding(&p));
    test_twin_set(p.t, "border", "never");
    double n[2];
    normal_of(run(&p, "color"), 16, 10, n);
    assert_true(n[0] > 0.5);
}

static void scatter(const pool *p, uint64_t random, double bumps)
{
    const int n = p->low->w * p->low->h;
    for (int i = 0; i < n; i++) p->low->data[i] = (double)(float)(-3 + bumps * test_random(&random, -1, 1));
}

/* Between the middles of four pixels, which stand at multiples of 8 and a half, normals are bilinear; they meet there. */
static void colours_of_four_pixels_are_interpolated(void **state)
{
    const pool p = begin(state, 8);
    double n[4][2], found[2], largest = 0;
    test_twin_set(p.t, "border", "always");
    scatter(&p, 13, 0.3);
    const ssfr_field *color = run(&p, "color");
    for (int k = 0; k < 4; k++) normal_of(color, k % 2 ? 19 : 12, k / 2 ? 11 : 4, n[k]);
    for (int y = 4; y < 12; y++)
        for (int x = 12; x < 20; x++) {
            const double a = (x - 12) / 7.0, b = (y - 4) / 7.0;
            normal_of(color, x, y, found);
            for (int k = 0; k < 2; k++)
                assert_close(found[k], ssfr_mix(ssfr_mix(n[0][k], n[1][k], a), ssfr_mix(n[2][k], n[3][k], a), b),
                             rounding(&p), 0);
        }
    for (int k = 0; k < 4; k++) normal_of(color, 10 + k, 12, n[k]);
    for (int k = 0; k < 2; k++) {
        assert_close(1.5 * n[1][k] - 0.5 * n[0][k], 1.5 * n[2][k] - 0.5 * n[3][k], 4 * rounding(&p), 0);
        largest = fmax(largest, fabs(n[1][k] - n[0][k] - n[3][k] + n[2][k]));
    }
    assert_true(largest > 1e-3); /* not a line all along */
}

/* At half resolution half a pixel of the depth is one of the frame. */
static void b28_shifts_colours_by_half_a_pixel_of_the_depth(void **state)
{
    const pool p = begin(state, 2);
    test_twin_set(p.t, "border", "always");
    scatter(&p, 5, 0.1);
    const ssfr_field *color = run(&p, "color");
    test_twin_set(p.t, "as_printed", "B28");
    const ssfr_field *printed = run(&p, "color");
    double largest = 0;
    for (int y = 1; y < H - 2; y++)
        for (int x = 1; x < W - 2; x++) {
            double a[2], b[2], here[2];
            normal_of(printed, x, y, a);
            normal_of(color, x + 1, y + 1, b);
            normal_of(color, x, y, here);
            for (int k = 0; k < 2; k++) assert_close(a[k], b[k], rounding(&p), 0);
            largest = fmax(largest, fabs(a[0] - here[0]));
        }
    assert_true(largest > 0.1);
}

/* At full resolution there is nothing between pixels: the pixel's own sample is its colour. As printed it is the mean
 * of four. */
static void at_full_resolution_a_border_has_its_own_colour(void **state)
{
    const pool p = begin(state, 1);
    test_twin_set(p.t, "border", "always");
    test_twin_set(p.t, "lone_thresh", "0");
    *ssfr_field_at(p.low, 10, 10) = -2;
    double n[2];
    const ssfr_field *color = run(&p, "color");
    normal_of(color, 9, 10, n);
    assert_close(n[0], 0, rounding(&p), 0); /* its lesser difference is the other one */
    normal_of(color, 10, 10, n);
    assert_true(n[0] > 0.3 && n[1] > 0.3); /* of two differences as large that ahead: to the right, and upwards */
    test_twin_set(p.t, "as_printed", "B28");
    double printed[2];
    normal_of(run(&p, "color"), 9, 9, printed);
    for (int k = 0; k < 2; k++) assert_close(printed[k], n[k] / 4, rounding(&p), 0);
}

/* Places of depths as far as a float has are products of them, normals are not. */
static void at_borders_distant_water_has_its_normals(void **state)
{
    static const double far[] = {-1e10, -1e20, -1e28}, s[2] = {0.3, -0.2};
    for (size_t k = 0; k < SSFR_COUNT(far); k++) {
        const pool p = begin(state, 2);
        double n[3] = {-s[0], -s[1], 1};
        ssfr_normalize(n);
        test_twin_set(p.t, "border", "always");
        test_twin_set(p.t, "lone_thresh", "0");
        ssfr_field_fill(p.scene_depth, -SSFR_EMPTY);
        lay_plane(&p, far[k], s);
        const ssfr_field *color = run(&p, "color");
        for (int i = 0; i < N; i++)
            if (is_amid(i % W, i / W)) assert_normal(color, i % W, i / W, n, 4 * rounding(&p));
    }
}

/* What is nearer than all about it is no slope. */
static void a_pixel_that_stands_alone_faces_the_eye(void **state)
{
    static const double facing[3] = {0, 0, 1};
    static const struct {
        const char *thresh;
        double height;
        bool alone;
    } cases[] = {{"0.1", 0.101, true}, {"0.1", 0.099, false}, {"0.1", -5, true}, {"2", 1.9, false}, {"0", 5, false}};
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        const pool p = begin(state, 1);
        test_twin_set(p.t, "border", "always");
        test_twin_set(p.t, "lone_thresh", "%s", cases[i].thresh);
        *ssfr_field_at(p.low, 10, 10) += cases[i].height / 2;
        for (int k = -1; k <= 1; k++)
            for (int j = -1; j <= 1; j++)
                if (j || k) *ssfr_field_at(p.low, 10 + j, 10 + k) -= cases[i].height / 2;
        const ssfr_field *color = run(&p, "color");
        double n[2];
        normal_of(color, 10, 10, n);
        if (cases[i].alone) assert_normal(color, 10, 10, facing, rounding(&p));
        else assert_true(fabs(n[0]) > 0.1 && fabs(n[1]) > 0.1);
    }
}

/* ---- where depths lack ------------------------------------------------------------------------------------------- */

static bool has_hole(const pool *p, int i, int j)
{
    return !ssfr_is_surface(ssfr_depth_at(p->low, i, j));
}

/* What one pixel reads: three columns in two rows, and three rows in two columns, in the 3 x 3 about its own. */
static int count_holes(const pool *p, int x, int y, int *n)
{
    const int ci = x / p->factor, cj = y / p->factor;
    const int i = (int)floor((x + 0.5) / p->factor - 0.5), j = (int)floor((y + 0.5) / p->factor - 0.5);
    int holes = 0;
    *n = 0;
    for (int b = cj - 1; b <= cj + 1; b++)
        for (int a = ci - 1; a <= ci + 1; a++) {
            const bool reads = b == j || b == j + 1 || a == i || a == i + 1;
            *n += reads;
            holes += reads && has_hole(p, a, b);
        }
    return holes;
}

static void what_is_no_surface_makes_a_border_and_no_number_that_is_none(void **state)
{
    static const double holes[] = {-SSFR_EMPTY, SSFR_EMPTY, NAN, INFINITY, -INFINITY};
    static const char *const modes[] = {"split", "never", "always"};
    for (size_t m = 0; m < SSFR_COUNT(modes); m++)
        for (int factor = 1; factor <= 4; factor *= 4) {
            const pool p = begin(state, factor);
            uint64_t random = 7;
            scatter(&p, 3, 0.01);
            for (int i = 0; i < p.low->w * p.low->h; i++)
                if (test_random(&random, 0, 1) < 0.3)
                    p.low->data[i] = holes[(int)test_random(&random, 0, SSFR_COUNT(holes))];
            for (int j = 0; j < p.low->h; j++) /* and one all over */
                for (int i = 0; i < p.low->w / 2; i++) *ssfr_field_at(p.low, i, j) = NAN;
            test_twin_set(p.t, "border", "%s", modes[m]);
            test_twin_set(p.t, "fresnel_bias", "0.5");
            test_twin_set(p.t, "specular", "1");
            const ssfr_field *color = run(&p, "color"), *border = run(&p, "border");
            for (int i = 0; i < N; i++) {
                int n;
                const int lacking = count_holes(&p, i % W, i / W, &n);
                assert_true(border->data[i] == (m == 2 || (lacking > 0 && lacking < n)));
                for (int k = 0; k < 3; k++) assert_true(isfinite(color->data[3 * i + k]));
            }
        }
}

/* Nothing mirrors, shines or bends light; the water still colours. */
static void water_without_a_depth_only_attenuates(void **state)
{
    static const double fluid[3] = {0.01, 0.09, 0.13};
    const pool p = begin(state, 2);
    ssfr_field_fill(p.low, -SSFR_EMPTY);
    test_twin_set(p.t, "fresnel_bias", "1");
    test_twin_set(p.t, "k", "1");
    for (int always = 0; always < 2; always++) {
        test_twin_set(p.t, "border", always ? "always" : "split");
        const ssfr_field *color = run(&p, "color");
        for (int i = 0; i < 3 * N; i++) {
            const double expected = fluid[i % 3] + (p.scene->data[i] - fluid[i % 3]) * exp(-0.5);
            assert_close(color->data[i], expected, rounding(&p), 0);
        }
    }
}

/* A depth that nobody gives is none. */
static void without_a_depth_it_is_as_with_an_empty_one(void **state)
{
    const pool p = begin(state, 1);
    ssfr_field_fill(p.low, -SSFR_EMPTY);
    const ssfr_field *empty = run(&p, "color");
    test_twin_give(p.t, "low", NULL);
    assert_true(test_same_bits(test_twin_run(p.t, "color"), empty));
}

static void alone_a_pixel_faces_the_eye(void **state)
{
    for (int n = 1; n <= 32; n *= 32) {
        const pool p = begin_sized(state, n, n, n);
        const ssfr_field *color = run(&p, "color"), *border = run(&p, "border");
        assert_int_equal(p.low->w * p.low->h, 1);
        for (int i = 0; i < n * n; i++) {
            assert_true(border->data[i] == 1);
            for (int k = 0; k < 2; k++) assert_close(color->data[3 * i + k], p.scene->data[3 * i + k], 64 * p.t->eps, 0);
        }
    }
}

/* ---- where it ends ----------------------------------------------------------------------------------------------- */

/* Depths of low resolution reach beyond the water: its thickness says where that is. */
static void beyond_the_water_the_scene_shows(void **state)
{
    const pool p = begin(state, 4);
    test_twin_set(p.t, "fresnel_bias", "1");
    for (int i = 0; i < N; i++) p.back->data[i] = i % 3 == 0 ? 0.5 : i % 3 == 1 ? 0 : -1;
    for (int always = 0; always < 2; always++) {
        test_twin_set(p.t, "border", always ? "always" : "split");
        const ssfr_field *color = run(&p, "color"), *border = run(&p, "border");
        for (int i = 0; i < N; i++) {
            const bool same = memcmp(color->data + 3 * i, p.scene->data + 3 * i, 3 * sizeof(double)) == 0;
            assert_int_equal(same, i % 3 != 0);
            if (i % 3) assert_true(border->data[i] == 0);
        }
    }
}

/* Thin foam over the depth of water that ends before it: what is behind is seen straight, and nothing mirrors. */
static void foam_beyond_the_water_neither_bends_light_nor_mirrors(void **state)
{
    static const double c_fb[3] = {0.5, 0.62, 0.7};
    for (int image = 0; image < 2; image++) {
        const pool p = begin(state, 4);
        ssfr_field *foam = test_field_filled(W, H, 1, 0.02), *depth = test_field_filled(W, H, 1, -SSFR_EMPTY);
        ssfr_field *normal = test_field_filled(W, H, 3, 0.5);
        lay_ramp(&p);
        ssfr_field_fill(p.back, 0);
        test_twin_set(p.t, "surface", image ? "image" : "split");
        test_twin_set(p.t, "gamma", "1000");
        test_twin_set(p.t, "fresnel_bias", "1");
        test_twin_set(p.t, "specular", "100");
        test_twin_set(p.t, "shininess", "1");
        test_twin_set(p.t, "foam_falloff_scale", "30");
        test_twin_give(p.t, "foam_thickness", foam);
        test_twin_give(p.t, "depth", depth);
        test_twin_give(p.t, "normal", normal);
        const ssfr_field *color = run(&p, "color");
        for (int i = 0; i < 3 * N; i++) {
            const double expected = c_fb[i % 3] + (p.scene->data[i] - c_fb[i % 3]) * exp(-0.6);
            assert_close(color->data[i], expected, rounding(&p), 0);
        }
    }
}

/* ---- what is read and written ------------------------------------------------------------------------------------ */

static const ssfr_field *run_alone(const pool *p, const char *output, size_t *bytes)
{
    ssfr_field *field;
    ssfr_graph_want_all(p->t->graph, false);
    assert_int_equal(ssfr_graph_run(p->t->graph, &p->t->scene, NULL), SSFR_OK);
    assert_int_equal(ssfr_graph_read(p->t->graph, output, &field), SSFR_OK);
    *bytes = (size_t)ssfr_graph_report(p->t->graph)->nodes[0].bytes;
    return field;
}

/* What is not read may hold anything, of any resolution. */
static void only_the_surface_that_is_asked_for_is_read(void **state)
{
    const pool p = begin(state, 2);
    ssfr_field *quarter = test_field_filled(W / 4, H / 4, 1, NAN), *normal = test_field_filled(W, H, 3, 0);
    scatter(&p, 9, 0.1);
    const ssfr_field *color = run(&p, "color");
    test_twin_give(p.t, "depth", quarter);
    test_twin_give(p.t, "normal", test_field_filled(W / 4, H / 4, 3, NAN));
    assert_true(test_same_bits(run(&p, "color"), color));
    test_twin_set(p.t, "surface", "image");
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(p.t->graph, &p.t->scene, NULL), "depth has 1/4 of the frame's");
    test_twin_give(p.t, "depth", test_field_filled(W, H, 1, -3));
    test_twin_give(p.t, "normal", normal);
    const ssfr_field *image = run(&p, "color");
    test_twin_give(p.t, "low", quarter);
    assert_true(test_same_bits(test_twin_run(p.t, "color"), image));
    test_twin_give(p.t, "low", NULL);
    assert_true(test_same_bits(test_twin_run(p.t, "color"), image));
}

/* Each pixel is written once; the depth of half resolution is a quarter of an image. */
static void a_border_that_nobody_wants_is_not_written(void **state)
{
    const pool p = begin(state, 2);
    const size_t images = 3 + 1 + 1 + 1 + 1 + 1 + 1; /* scene colour and depth, 4 thicknesses, light */
    const size_t without = 4 * N * (images + 3) + N;  /* and colour, and the depth */
    size_t bytes;
    scatter(&p, 11, 0.1);
    give(&p);
    ssfr_field *color = (ssfr_field *)run_alone(&p, "color", &bytes), *border;
    assert_int_equal(bytes, without);
    assert_int_equal(ssfr_graph_read(p.t->graph, "border", &border), SSFR_OK);
    assert_int_equal(border->w * border->h, 1);
    assert_true(border->data[0] == 0);
    ssfr_field_destroy(&border);
    assert_int_equal(ssfr_graph_want(p.t->graph, "border"), SSFR_OK);
    border = (ssfr_field *)run_alone(&p, "border", &bytes);
    assert_int_equal(bytes, without + 4 * N);
    assert_int_equal(border->w * border->h, N);
    assert_true(border->data[0] == 1);
    ssfr_field_destroy(&border);
    border = (ssfr_field *)run_alone(&p, "color", &bytes);
    assert_true(test_same_bits(color, border));
    ssfr_field_destroy(&border);
    ssfr_field_destroy(&color);
}

/* Of the surface that is asked for: depth and normal, or twelve depths. The other's images count for nothing. */
static void work_is_that_of_its_surface(void **state)
{
    const pool p = begin(state, 2);
    test_twin_give(p.t, "depth", test_field_filled(W, H, 1, -3));
    test_twin_give(p.t, "normal", test_field_filled(W, H, 3, 0.5));
    for (int image = 0; image < 2; image++) {
        size_t bytes, less;
        test_twin_set(p.t, "surface", image ? "image" : "split");
        give(&p);
        ssfr_field *color = (ssfr_field *)run_alone(&p, "color", &bytes);
        ssfr_field_destroy(&color);
        assert_true(ssfr_graph_report(p.t->graph)->nodes[0].taps == (image ? 13 : 23));
        test_twin_give(p.t, image ? "low" : "depth", NULL);
        color = (ssfr_field *)run_alone(&p, "color", &less);
        ssfr_field_destroy(&color);
        assert_int_equal(less, bytes);
        test_twin_give(p.t, "depth", test_field_filled(W, H, 1, -3));
    }
}

static void with_images_there_is_no_border(void **state)
{
    const pool p = begin(state, 2);
    test_twin_set(p.t, "surface", "image");
    test_twin_set(p.t, "border", "always");
    const ssfr_field *border = run(&p, "border");
    for (int i = 0; i < N; i++) assert_true(border->data[i] == 0);
}

/* ---- twins ------------------------------------------------------------------------------------------------------- */

/* The same noise on both, with holes; depths of two walls, whose steps are far from the threshold. */
static pool begin_noise(void *backend, int factor, const char *const *settings)
{
    const pool p = begin(&backend, factor);
    uint64_t random = 23;
    scatter(&p, 19, 0.02);
    for (int i = 0; i < p.low->w * p.low->h; i++) {
        const double roll = test_random(&random, 0, 1);
        p.low->data[i] = roll < 0.1 ? -SSFR_EMPTY : roll < 0.3 ? p.low->data[i] - 1 : p.low->data[i];
    }
    for (int i = 0; i < N; i++) p.back->data[i] = (double)(float)fmax(test_random(&random, -0.2, 1), 0);
    for (int i = 0; i < N; i++) p.scene->data[3 * i + 2] = (double)(float)test_random(&random, 0, 1);
    test_twin_set(p.t, "fresnel_bias", "0.1");
    test_twin_set(p.t, "specular", "0.5");
    test_twin_set(p.t, "shininess", "20");
    test_twin_set(p.t, "k", "1");
    for (int i = 0; settings[i]; i++)
        assert_int_equal(ssfr_graph_set(p.t->graph, settings[i], strchr(settings[i], '\0') + 1), SSFR_OK);
    return p;
}

#define SET(key, value) "layer_composite." key "\0" value

static void twins_agree_on_noise(void **state)
{
    static const char *const variants[][5] = {
        {NULL}, {SET("border", "always"), NULL}, {SET("border", "never"), NULL}, {SET("off_axis", "0"), NULL},
        {SET("as_printed", "B28"), NULL}, {SET("as_printed", "B28,B29,B11,B12"), SET("border", "always"), NULL},
        {SET("as_printed", "B28"), SET("off_axis", "0"), SET("border", "never"), SET("reflection", "scene"), NULL},
        {SET("depth_thresh", "0"), SET("fresnel", "exact"), NULL}, {SET("depth_thresh", "1e6"), NULL},
        {SET("lone_thresh", "0"), NULL}, {SET("lone_thresh", "0.01"), SET("border", "always"), NULL},
    };
    const bool on_gpu = strcmp(*state, "gpu") == 0;
    for (size_t v = 0; v < SSFR_COUNT(variants); v++)
        for (int factor = 1; factor <= 4; factor *= 2) {
            const pool a = begin_noise(*state, factor, variants[v]), b = begin_noise("cpu", factor, variants[v]);
            const ssfr_field *color = run(&a, "color"), *reference = run(&b, "color");
            assert_true(test_same_bits(run(&a, "border"), run(&b, "border")));
            int n = 0;
            for (int i = 0; i < 3 * N; i++)
                n += !(fabs(color->data[i] - reference->data[i]) <= 1e-3 + 1e-3 * fabs(reference->data[i]));
            assert_true(n <= (on_gpu ? 3 * N / 100 : 0));
            test_clean(state);
        }
}

static void split_refuses_values_out_of_range(void **state)
{
    const pool p = begin(state, 1);
    test_twin_refuses(p.t, "depth_thresh", "-0.1", "layer_composite.depth_thresh");
    test_twin_refuses(p.t, "lone_thresh", "-0.1", "layer_composite.lone_thresh");
    test_twin_refuses(p.t, "border", "often", "often");
    test_twin_refuses(p.t, "surface", "mesh", "mesh");
    test_twin_give(p.t, "low", test_field_filled(5, 5, 1, -3));
    assert_fails(SSFR_ERR_VALUE, ssfr_graph_run(p.t->graph, &p.t->scene, NULL), "smooth_depth: 5 x 5 pixels given");
}

/* Water alone, all behind the foam or all before it: clear, it refracts alike. */
static void water_that_is_all_before_the_foam_has_its_surface(void **state)
{
    const pool p = begin(state, 2);
    for (int j = 0; j < p.low->h; j++)
        for (int i = 0; i < p.low->w; i++) *ssfr_field_at(p.low, i, j) = -3 + 0.02 * i - 0.013 * j;
    ssfr_field *behind = test_field(W, H, 3);
    memcpy(behind->data, run(&p, "color")->data, 3 * sizeof *behind->data * W * H);
    assert_true(test_difference(behind, p.scene) > 1000 * p.t->eps);
    test_twin_give(p.t, "thickness_back", NULL);
    test_twin_give(p.t, "thickness_front", p.back);
    const ssfr_field *before = test_twin_run(p.t, "color");
    assert_true(test_difference(before, behind) <= 16 * W * p.t->eps);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(inside_depth_and_slope_are_those_of_the_pixel),
        TEST_TWINS(without_off_axis_the_slope_counts_as_if_on_the_axis),
        TEST_TWINS(inside_depth_is_that_of_the_pixel),
        TEST_TWINS(b28_shifts_the_depth_by_a_quarter_of_a_pixel_of_it),
        TEST_TWINS(inside_the_normal_of_a_plane_is_right_to_second_order),
        TEST_TWINS(at_borders_the_normal_of_a_plane_is_its_own),
        TEST_TWINS(a_step_is_a_border_of_a_pixel_to_both_sides),
        TEST_TWINS(the_threshold_is_depth_thresh),
        TEST_TWINS(at_a_step_normals_are_those_of_its_sides),
        TEST_TWINS(colours_of_four_pixels_are_interpolated),
        TEST_TWINS(b28_shifts_colours_by_half_a_pixel_of_the_depth),
        TEST_TWINS(at_full_resolution_a_border_has_its_own_colour),
        TEST_TWINS(water_that_is_all_before_the_foam_has_its_surface),
        TEST_TWINS(at_borders_distant_water_has_its_normals),
        TEST_TWINS(a_pixel_that_stands_alone_faces_the_eye),
        TEST_TWINS(what_is_no_surface_makes_a_border_and_no_number_that_is_none),
        TEST_TWINS(water_without_a_depth_only_attenuates),
        TEST_TWINS(without_a_depth_it_is_as_with_an_empty_one),
        TEST_TWINS(alone_a_pixel_faces_the_eye),
        TEST_TWINS(beyond_the_water_the_scene_shows),
        TEST_TWINS(foam_beyond_the_water_neither_bends_light_nor_mirrors),
        TEST_TWINS(only_the_surface_that_is_asked_for_is_read),
        TEST_TWINS(a_border_that_nobody_wants_is_not_written),
        TEST_TWINS(work_is_that_of_its_surface),
        TEST_TWINS(with_images_there_is_no_border),
        TEST_GPU(twins_agree_on_noise),
        TEST_TWINS(split_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_surface_noise.c: noise that belongs to a particle and moves with it, its kernel, its fading, its mean. */
#include "tests/pass_util.h"

enum { W = 61, H = 48 };
static const double pi = 3.14159265358979323846;

/* A surface at 2.385 m, nearer than every particle used here unless it says otherwise; kernel and fading off. */
static test_twin *begin(void **state)
{
    test_twin *t = test_twin_create(state, "surface_noise", W, H);
    test_twin_give(t, "depth", test_field_filled(W, H, 1, -2.385));
    test_twin_set(t, "splat", "exact");
    test_twin_set(t, "sharpness", "0");
    test_twin_set(t, "depth_falloff", "0");
    return t;
}

static const ssfr_field *one(test_twin *t, const double c[3], double radius, uint32_t id)
{
    const double place[1][3] = {{c[0], c[1], c[2]}};
    test_twin_place(t, 1, place, radius, &id);
    return test_twin_run(t, "noise");
}

static double largest(const ssfr_field *f)
{
    double value = 0;
    for (int i = 0; i < f->w * f->h; i++) value = fmax(value, fabs(f->data[i]));
    return value;
}

/* What rounding does: the place on the sprite, in radii, moves by a few units of the distance, and the noise is as
 * steep as `frequency` cells a radius. */
static double rounding(const test_twin *t, double distance, double radius)
{
    return 64 * t->eps * distance / radius;
}

static const double middle[3] = {0.05, -0.02, -3};

/* ---- whose noise it is ------------------------------------------------------------------------------------------- */

static void every_id_has_noise_of_its_own(void **state)
{
    test_twin *t = begin(state);
    const ssfr_field *seven = one(t, middle, 0.8, 7), *eight = one(t, middle, 0.8, 8), *again = one(t, middle, 0.8, 7);
    assert_true(largest(seven) > 0.2 && largest(seven) < 1);
    assert_true(test_difference(seven, eight) > 0.2);
    assert_true(test_same_bits(seven, again));
}

/* From far away a sphere's outline is a disc: its noise lies on it as on the sprite, the same way up. */
static void all_splats_have_the_noise_the_same_way_up(void **state)
{
    static const double far[3] = {0.1, -0.05, -300};
    static const char *const forms[] = {"point", "quad"};
    test_twin *t = begin(state);
    t->scene.camera.tan_x = 0.003, t->scene.camera.tan_y = 0.003 * H / W;
    test_twin_give(t, "depth", test_field_filled(W, H, 1, -299));
    const ssfr_field *exact = one(t, far, 0.8, 7);
    assert_true(largest(exact) > 0.2);
    for (int k = 0; k < 2; k++) {
        test_twin_set(t, "splat", "%s", forms[k]);
        assert_true(test_difference(one(t, far, 0.8, 7), exact) < 0.02);
    }
}

/* Particles are sorted in space: one more of them on the left moves the other in memory. Its noise is its id's, so it
 * stays; the places of two are floats relative to their packet. */
static void noise_goes_by_id_and_not_by_place_in_memory(void **state)
{
    static const double two[2][3] = {{-1.1, -0.6, -3}, {0.6, 0.2, -3}};
    static const uint32_t ids[2] = {901, 17};
    test_twin *t = begin(state);
    const ssfr_field *alone = one(t, two[1], 0.5, 17), *other = one(t, two[1], 0.5, 18);
    test_twin_place(t, 2, two, 0.5, ids);
    assert_int_equal(t->scene.particles->id[1], 17);
    const ssfr_field *both = test_twin_run(t, "noise");
    double moved = 0, changed = 0, left = 0;
    for (int i = 0; i < W * H; i++) {
        const test_hit hit = test_meet(two[1], 0.5, test_ray_at(t, i % W, i / W, 1));
        if (hit.miss < 0.499) moved = fmax(moved, fabs(both->data[i] - alone->data[i]));
        if (hit.miss < 0.499) changed = fmax(changed, fabs(both->data[i] - other->data[i]));
        if (i % W < 20) left = fmax(left, fabs(both->data[i]));
    }
    assert_true(moved < 1e-5 && changed > 0.1 && left > 0.1);
}

static void without_ids_the_place_in_memory_is_the_id(void **state)
{
    test_twin *t = begin(state);
    const double place[1][3] = {{middle[0], middle[1], middle[2]}};
    const ssfr_field *zero = one(t, middle, 0.8, 0);
    test_twin_place(t, 1, place, 0.8, NULL);
    assert_true(test_same_bits(test_twin_run(t, "noise"), zero));
}

static void noise_of_many_adds_up_in_any_order(void **state)
{
    enum { N = 300 };
    double c[N][3], back[N][3];
    uint32_t id[N], back_id[N];
    uint64_t random = 3;
    test_twin *t = begin(state);
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < 3; k++) c[i][k] = test_random(&random, -0.7, 0.7) - (k == 2 ? 3.5 : 0);
        id[i] = (uint32_t)(5 * i + 2);
    }
    for (int i = 0; i < N; i++) memcpy(back[i], c[N - 1 - i], sizeof back[i]), back_id[i] = id[N - 1 - i];
    test_twin_place(t, N, c, 0.2, id);
    const ssfr_field *forwards = test_twin_run(t, "noise");
    test_twin_place(t, N, back, 0.2, back_id);
    assert_true(largest(forwards) > 0.2);
    assert_true(test_difference(test_twin_run(t, "noise"), forwards) < 64 * t->eps);
}

/* ---- how it moves ------------------------------------------------------------------------------------------------ */

/* Eye and particle go together, by steps that a double and a float hold without rounding. */
static void noise_is_carried_along(void **state)
{
    static const double eye[3] = {12.5, -3.25, 7.75}, target[3] = {12.5, -3.25, 6.75};
    static const double c[3] = {0.0625, -0.03125, -3};
    test_twin *t = begin(state);
    const ssfr_field *here = one(t, c, 0.8, 7);
    test_twin_look(t, eye, target);
    assert_true(test_same_bits(one(t, c, 0.8, 7), here));
}

/* A quad that moves by five and by three pixels takes its waves along. */
static void noise_moves_with_its_particle(void **state)
{
    test_twin *t = begin(state);
    const double pixel = 3.0 / H, moved[3] = {middle[0] + 5 * pixel, middle[1] - 3 * pixel, middle[2]};
    test_twin_set(t, "splat", "quad");
    const ssfr_field *here = one(t, middle, 0.4, 7), *there = one(t, moved, 0.4, 7);
    double difference = 0;
    for (int y = 6; y < H - 6; y++)
        for (int x = 6; x < W - 6; x++)
            difference = fmax(difference, fabs(*ssfr_field_at(there, x + 5, y + 3) - *ssfr_field_at(here, x, y)));
    assert_true(largest(here) > 0.1);
    assert_true(difference < rounding(t, 3, 0.4));
}

/* ---- its kernel -------------------------------------------------------------------------------------------------- */

/* The noise by itself, of one quad before the surface: no Gaussian, no fading. */
static test_twin *create_bare(void **state, const char *frequency)
{
    test_twin *t = test_twin_create(state, "surface_noise", 65, 65);
    test_twin_give(t, "depth", test_field_filled(65, 65, 1, -2.385));
    test_twin_set(t, "splat", "quad");
    test_twin_set(t, "sharpness", "0");
    test_twin_set(t, "depth_falloff", "0");
    test_twin_set(t, "frequency", frequency);
    return t;
}

/* Gradient noise vanishes where lattice lines cross: with n cells a radius, at multiples of 1 / n radii. */
static void noise_vanishes_at_the_corners_of_its_cells(void **state)
{
    test_twin *t = create_bare(state, "4");
    static const double c[3] = {0, 0, -4};
    /* 24 px and a cell of 6 px: lattice points in pixels' middles. */
    const ssfr_field *noise = one(t, c, 24 * 4.0 / 65, 7);
    double at_corners = 0, between = 0;
    for (int y = -18; y <= 18; y++)
        for (int x = -15; x <= 15; x++) {
            const double value = fabs(*ssfr_field_at(noise, 32 + x, 32 + y));
            if (x % 6 == 0 && y % 6 == 0) at_corners = fmax(at_corners, value);
            else between = fmax(between, value);
        }
    assert_true(at_corners < rounding(t, 4, 1));
    assert_true(between > 0.3);
}

/* Gradients are unit vectors and fade into each other: with a cell of 24 pixels, two neighbours differ by little,
 * across the edges of cells too, and the noise comes from both sides of zero. */
static void noise_is_continuous_across_cells(void **state)
{
    test_twin *t = create_bare(state, "1");
    static const double c[3] = {0, 0, -4};
    for (uint32_t id = 0; id < 8; id++) {
        const ssfr_field *noise = one(t, c, 24 * 4.0 / 65, id);
        double steepest = 0, lo = 0, hi = 0;
        for (int y = 32 - 16; y < 32 + 16; y++)
            for (int x = 32 - 16; x < 32 + 16; x++) {
                const double here = *ssfr_field_at(noise, x, y);
                steepest = fmax(steepest, fabs(*ssfr_field_at(noise, x + 1, y) - here));
                steepest = fmax(steepest, fabs(*ssfr_field_at(noise, x, y + 1) - here));
                lo = fmin(lo, here), hi = fmax(hi, here);
            }
        assert_true(steepest < 2.2 / 24 && steepest > 0.5 / 24);
        assert_true(lo < -0.1 && hi > 0.1);
    }
}

/* At a corner of cells the noise is as steep as the gradient there: a unit vector in one of eight directions, each of
 * which some particle has. A pixel is 1/24 of a cell: differences err by under 4 %. */
static void gradients_have_eight_directions(void **state)
{
    test_twin *t = test_twin_create(state, "surface_noise", 65, 65);
    static const double c[3] = {0, 0, -4};
    int n_seen[8] = {0};
    test_twin_give(t, "depth", test_field_filled(65, 65, 1, -2.385));
    test_twin_set(t, "splat", "quad");
    test_twin_set(t, "sharpness", "0");
    test_twin_set(t, "depth_falloff", "0");
    test_twin_set(t, "frequency", "1");
    for (uint32_t id = 0; id < 64; id++) {
        const ssfr_field *noise = one(t, c, 24 * 4.0 / 65, id);
        const double x = 12 * (*ssfr_field_at(noise, 33, 32) - *ssfr_field_at(noise, 31, 32));
        const double y = 12 * (*ssfr_field_at(noise, 32, 33) - *ssfr_field_at(noise, 32, 31));
        const double turns = atan2(y, x) / pi * 4;
        assert_close(x * x + y * y, 1, 0.04, 0);
        assert_close(turns, round(turns), 0.04, 0);
        n_seen[(int)round(turns) & 7]++;
    }
    for (int i = 0; i < 8; i++) assert_true(n_seen[i] > 0);
}

static void frequency_0_is_silence(void **state)
{
    test_twin *t = begin(state);
    test_twin_set(t, "frequency", "0");
    assert_true(largest(one(t, middle, 0.8, 7)) == 0);
}

static void kernel_is_a_gaussian_of_the_sprite(void **state)
{
    static const char *const forms[] = {"point", "quad", "exact"};
    test_twin *t = begin(state);
    for (size_t f = 0; f < SSFR_COUNT(forms); f++) {
        test_twin_set(t, "splat", "%s", forms[f]);
        test_twin_set(t, "sharpness", "0");
        const ssfr_field *plain = one(t, middle, 0.8, 7);
        test_twin_set(t, "sharpness", "2.385");
        const ssfr_field *sharp = one(t, middle, 0.8, 7);
        for (int i = 0; i < W * H; i++) {
            const test_ray at = test_ray_at(t, i % W, i / W, 1);
            const double a = 3 * at.u - middle[0], b = 3 * at.v - middle[1];
            const double miss = f < 2 ? sqrt(a * a + b * b) : test_meet(middle, 0.8, at).miss;
            const double expected = plain->data[i] * exp(-2.385 * miss * miss / 0.64);
            assert_close(sharp->data[i], expected, rounding(t, 3, 0.8), 0);
        }
        assert_true(largest(sharp) > 0.1);
    }
}

/* The same particle under a surface 1 / depth_falloff radii further before it. */
static void noise_falls_by_e_below_the_surface(void **state)
{
    test_twin *t = begin(state);
    test_twin_set(t, "splat", "quad");
    test_twin_set(t, "depth_falloff", "1.6");
    const ssfr_field *before = one(t, middle, 0.4, 7);
    test_twin_give(t, "depth", test_field_filled(W, H, 1, -2.385 + 0.4 / 1.6));
    const ssfr_field *after = one(t, middle, 0.4, 7);
    for (int i = 0; i < W * H; i++) assert_close(after->data[i], before->data[i] * exp(-1), 2 * t->eps, 32 * t->eps);
    assert_true(largest(before) > 0.01);
}

/* Of two particles one behind the other, a radius apart and the surface on the first, the second has 1/e. */
static void hidden_particle_has_a_share_of_1_over_e(void **state)
{
    static const double behind[3] = {0.05, -0.02, -3.4};
    test_twin *t = begin(state);
    test_twin_set(t, "depth_falloff", "1");
    test_twin_set(t, "splat", "quad");
    ssfr_field *surface = test_field_filled(W, H, 1, -SSFR_EMPTY);
    for (int i = 0; i < W * H; i++) {
        const test_ray at = test_ray_at(t, i % W, i / W, 1);
        const double a = (3.4 * at.u - behind[0]) / 0.4, b = (3.4 * at.v - behind[1]) / 0.4, r2 = a * a + b * b;
        if (r2 < 1) surface->data[i] = -3 + 0.4 * sqrt(1 - r2); /* behind's own front, 0.4 m nearer */
    }
    test_twin_give(t, "depth", surface);
    const ssfr_field *hidden = one(t, behind, 0.4, 7);
    test_twin_set(t, "depth_falloff", "0");
    const ssfr_field *plain = one(t, behind, 0.4, 7);
    for (int i = 0; i < W * H; i++)
        assert_close(hidden->data[i], plain->data[i] * exp(-1), 2 * t->eps, 1e3 * t->eps);
    assert_true(largest(plain) > 0.1);
}

static void particle_before_the_surface_counts_whole(void **state)
{
    test_twin *t = begin(state);
    test_twin_give(t, "depth", test_field_filled(W, H, 1, -5));
    const ssfr_field *plain = one(t, middle, 0.4, 7);
    test_twin_set(t, "depth_falloff", "3");
    assert_true(test_same_bits(one(t, middle, 0.4, 7), plain));
}

static void there_is_no_noise_without_a_surface(void **state)
{
    test_twin *t = begin(state);
    ssfr_field *depth = test_field(W, H, 1);
    for (int i = 0; i < W * H; i++) depth->data[i] = i % 2 ? -2.385 : -SSFR_EMPTY;
    test_twin_give(t, "depth", depth);
    const ssfr_field *noise = one(t, middle, 0.8, 7);
    for (int i = 0; i < W * H; i += 2) assert_true(noise->data[i] == 0);
    assert_true(largest(noise) > 0.1);
}

/* 8000 particles on the same spot: gradients have no direction of their own, so each pixel's mean is zero to what
 * chance leaves of 8000 values (five deviations; gradient noise deviates by under 0.3), and the noises are not all
 * alike. */
static void noise_of_many_particles_has_mean_zero(void **state)
{
    enum { N = 8000 };
    static double c[N][3];
    static uint32_t id[N];
    test_twin *t = test_twin_create(state, "surface_noise", 16, 16);
    test_twin_give(t, "depth", test_field_filled(16, 16, 1, -2.385));
    test_twin_set(t, "sharpness", "0");
    test_twin_set(t, "depth_falloff", "0");
    for (int i = 0; i < N; i++) c[i][0] = c[i][1] = 0, c[i][2] = -4, id[i] = (uint32_t)i;
    test_twin_place(t, N, c, 1.9, id);
    const ssfr_field *sum = test_twin_run(t, "noise");
    assert_true(largest(sum) / N < 5 * 0.3 / sqrt(N));
    assert_true(largest(sum) / N > 0.3 * 0.2 / sqrt(N));
}

static void noise_refuses_values_out_of_range(void **state)
{
    test_twin *t = begin(state);
    test_twin_refuses(t, "frequency", "65", "surface_noise.frequency");
    test_twin_refuses(t, "sharpness", "-1", "surface_noise.sharpness");
    test_twin_refuses(t, "depth_falloff", "1e7", "surface_noise.depth_falloff");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(every_id_has_noise_of_its_own),
        TEST_TWINS(all_splats_have_the_noise_the_same_way_up),
        TEST_TWINS(noise_goes_by_id_and_not_by_place_in_memory),
        TEST_TWINS(without_ids_the_place_in_memory_is_the_id),
        TEST_TWINS(noise_of_many_adds_up_in_any_order),
        TEST_TWINS(noise_is_carried_along),
        TEST_TWINS(noise_moves_with_its_particle),
        TEST_TWINS(noise_vanishes_at_the_corners_of_its_cells),
        TEST_TWINS(noise_is_continuous_across_cells),
        TEST_TWINS(gradients_have_eight_directions),
        TEST_TWINS(frequency_0_is_silence),
        TEST_TWINS(kernel_is_a_gaussian_of_the_sprite),
        TEST_TWINS(noise_falls_by_e_below_the_surface),
        TEST_TWINS(hidden_particle_has_a_share_of_1_over_e),
        TEST_TWINS(particle_before_the_surface_counts_whole),
        TEST_TWINS(there_is_no_noise_without_a_surface),
        TEST_TWINS(noise_of_many_particles_has_mean_zero),
        TEST_TWINS(noise_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_foam_thickness.c: foam along the ray against closed forms: mass, noise, what is near the front. */
#include "experiments/corners.h"
#include "passes/foam_thickness.h"
#include "passes/perlin.h"
#include "tests/pass_util.h"

#include "graph/internal.h"
#include "graph/twins.h"

static const double pi = 3.14159265358979323846;

enum { W = 160, H = 120, MOST = 256 };

static float lifetimes[MOST]; /* s, by id */

/* Particles with these lifetimes; packed in their order, or not. */
static void place(test_twin *t, size_t n, const double (*eye)[3], double radius, const float *size,
                  const float (*velocity)[3])
{
    static float packed[MOST];
    test_twin_place_moving(t, n, eye, radius, size, velocity);
    for (size_t i = 0; i < n; i++) packed[i] = lifetimes[t->scene.particles->id[i]];
    const int k = ssfr_port_find(t->graph->nodes[0].pass->inputs, "lifetime");
    ssfr_values_lend(t->graph, t->graph->nodes[0].in[k], packed);
}

static const double c[1][3] = {{0.11, -0.07, -2}};
static const float sideways[1][3] = {{3, 0, 0}};

static test_twin *with_one(void **state, float lifetime, const float (*velocity)[3])
{
    test_twin *t = test_twin_create(state, "foam_thickness", W, H);
    lifetimes[0] = lifetime;
    place(t, 1, c, 0.4, NULL, velocity);
    return t;
}

/* ---- one particle ------------------------------------------------------------------------------------------------ */

static double time_of(double lifetime, double rate, uint32_t id)
{
    return lifetime * rate - floor(lifetime * rate) + ssfr_lattice_share(id);
}

/* What a quad parallel to the image adds at a pixel: chord, kernel and noise. rim: how near u = 0 it is. */
static double closed_form(const test_twin *t, int x, int y, double lifetime, bool exponential, double *u)
{
    const test_ray ray = test_ray_at(t, x, y, 1);
    const double a = (-ray.u * c[0][2] - c[0][0]) / 0.4, b = -(-ray.v * c[0][2] - c[0][1]) / 0.4;
    const double place[3] = {0.5 + 0.5 * a, 0.5 + 0.5 * b, time_of(lifetime, 0.25, 0)};
    *u = 1 - a * a - b * b;
    return *u <= 0 ? 0 : 0.8 * sqrt(*u) * (exponential ? exp(-2 * (1 - *u)) : 1) * ssfr_foam_noise(place, 0);
}

static void a_quad_has_chord_kernel_and_noise_at_each_pixel(void **state)
{
    static const char *const kernels[] = {"chord", "exponential"};
    test_twin *t = with_one(state, 2.385f, NULL);
    for (int k = 0; k < 2; k++) {
        test_twin_set(t, "kernel", "%s", kernels[k]);
        const ssfr_field *foam = test_twin_run(t, "foam_thickness");
        int n = 0;
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++) {
                double u;
                const double expected = closed_form(t, x, y, (double)lifetimes[0], k == 1, &u);
                if (fabs(u) < 1e-4) continue;
                assert_close(*ssfr_field_at(foam, x, y), expected, 1e-12 + 100 * t->eps, 0);
                n += expected > 0;
            }
        assert_true(n > 1500);
    }
}

/* Its integral over the plane z = c_z, m^3. */
static double mass(const test_twin *t, const ssfr_field *foam)
{
    const double px = 4 * t->scene.camera.tan_x * t->scene.camera.tan_y * c[0][2] * c[0][2] / (W * H);
    double sum = 0;
    for (int i = 0; i < W * H; i++) sum += foam->data[i];
    return sum * px;
}

/* With noise of 1/2. Stretched quads have as much more as they are larger, unless the mass is kept. */
static void the_mass_of_a_quad_is_its_integral(void **state)
{
    const double half = 0.5 * 4 * pi / 3 * 0.4 * 0.4 * 0.4;
    for (int moving = 0; moving < 2; moving++) {
        test_twin *t = with_one(state, 1, moving ? sideways : NULL);
        test_twin_set(t, "noise", "constant");
        test_twin_set(t, "plane", "view");
        assert_close(mass(t, test_twin_run(t, "foam_thickness")), half, 0, 2e-3);
        test_twin_set(t, "mass", "printed");
        assert_close(mass(t, test_twin_run(t, "foam_thickness")), half * (moving ? 2 : 1), 0, 2e-3);
        test_twin_set(t, "stretch", "3.1");
        assert_close(mass(t, test_twin_run(t, "foam_thickness")), half * (moving ? 3.1 : 1), 0, 2e-3);
        test_twin_set(t, "mass", "kept");
        test_twin_set(t, "kernel", "exponential");
        assert_close(mass(t, test_twin_run(t, "foam_thickness")), 0.512 * half, 0, 4e-3);
        test_twin_set(t, "radius_scale", "0.7");
        assert_close(mass(t, test_twin_run(t, "foam_thickness")), 0.512 * half, 0, 6e-3);
        test_twin_set(t, "scale", "2.385");
        assert_close(mass(t, test_twin_run(t, "foam_thickness")), 2.385 * 0.512 * half, 0, 6e-3);
    }
}

/* Half of a quad's foam is what noise leaves on average: of patterns in a row, by their lifetimes. */
static void noise_leaves_half_of_the_foam_on_average(void **state)
{
    test_twin *t = with_one(state, 0, NULL);
    double sum = 0;
    for (int i = 0; i < 16; i++) { /* one period */
        lifetimes[0] = (float)i / 4;
        place(t, 1, c, 0.4, NULL, NULL);
        sum += mass(t, test_twin_run(t, "foam_thickness"));
    }
    assert_close(sum / 16, 0.5 * 4 * pi / 3 * 0.4 * 0.4 * 0.4, 0, 0.01);
}

static void wall_takes_what_is_behind_it(void **state)
{
    test_twin *t = with_one(state, 1, NULL);
    test_twin_set(t, "noise", "constant");
    const double all = mass(t, test_twin_run(t, "foam_thickness"));
    test_twin_give(t, "scene_depth", test_field_filled(W, H, 1, -2));
    test_twin_set(t, "occlusion", "clipped");
    assert_close(mass(t, test_twin_run(t, "foam_thickness")), 0.5 * all, 0, 1e-5);
    test_twin_set(t, "occlusion", "front");
    assert_close(mass(t, test_twin_run(t, "foam_thickness")), all, 0, 1e-5);
    test_twin_give(t, "scene_depth", test_field_filled(W, H, 1, -1.5));
    assert_true(mass(t, test_twin_run(t, "foam_thickness")) == 0);
}

/* ---- 16 bits ----------------------------------------------------------------------------------------------------- */

/* Each particle by itself, all and what is near the front alike. GL does not say how it rounds: it may cut off. */
static void sums_of_halves_are_rounded_one_by_one(void **state)
{
    enum { FEW = 12 };
    static const char *const images[] = {"foam_thickness", "foam_front"};
    double at[FEW][3];
    for (int i = 0; i < FEW; i++)
        for (int k = 0; k < 3; k++) at[i][k] = c[0][k] + 0.03 * i * (k - 1);
    for (int image = 0; image < 2; image++) {
        static double sum[W * H];
        test_twin *t = with_one(state, 1, NULL);
        int n = 0;
        memset(sum, 0, sizeof sum);
        test_twin_set(t, "noise", "constant");
        for (int i = 0; i < FEW; i++) {
            place(t, 1, (const double(*)[3])at + i, 0.4, NULL, NULL);
            const ssfr_field *one = test_twin_run(t, images[image]);
            for (int k = 0; k < W * H; k++) sum[k] = ssfr_half_round(sum[k] + one->data[k]);
        }
        place(t, FEW, (const double(*)[3])at, 0.4, NULL, NULL);
        test_twin_set(t, "storage", "half");
        const ssfr_field *halves = test_twin_run(t, images[image]);
        for (int k = 0; k < W * H; k++) {
            assert_true(halves->data[k] == ssfr_half_round(halves->data[k]));
            assert_close(halves->data[k], sum[k], t->gl ? 0x1p-24 : 0, t->gl ? 2 * FEW * 0x1p-11 : 0);
            n += halves->data[k] > 1;
        }
        assert_true(n > 100);
    }
}

static void foam_of_halves_takes_half_the_bytes(void **state)
{
    test_twin *t = with_one(state, 1, sideways);
    const ssfr_report *r = ssfr_graph_report(t->graph);
    test_twin_run(t, "foam_thickness");
    const double moved = r->nodes[0].bytes, held = r->image_bytes;
    test_twin_set(t, "storage", "half");
    test_twin_run(t, "foam_thickness");
    assert_true(r->nodes[0].bytes == moved - 2 * 2.0 * W * H); /* two images that are written, 2 bytes less each */
    assert_true(r->image_bytes == (t->gl ? held - 2 * 2.0 * W * H : held));
}

/* ---- noise ------------------------------------------------------------------------------------------------------- */

static ssfr_field *at_lifetime(test_twin *t, float lifetime)
{
    lifetimes[0] = lifetime;
    place(t, 1, c, 0.4, NULL, NULL);
    return test_twin_run(t, "foam_thickness");
}

static void the_texture_is_near_the_noise_and_constant_its_mean(void **state)
{
    test_twin *t = with_one(state, 2.385f, NULL);
    const ssfr_field *exact = test_twin_run(t, "foam_thickness");
    test_twin_set(t, "noise", "texture");
    const double texture = test_difference(test_twin_run(t, "foam_thickness"), exact);
    assert_true(texture < 0.8 * 0.025 && texture > 1e-4); /* of a chord; test_perlin.c says why */
    test_twin_set(t, "noise", "constant");
    const ssfr_field *constant = test_twin_run(t, "foam_thickness");
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            double u;
            closed_form(t, x, y, 0, false, &u);
            if (u > 1e-4) assert_close(*ssfr_field_at(constant, x, y), 0.4 * sqrt(u), 1e-12 + 40 * t->eps, 0);
        }
    assert_true(test_difference(constant, exact) > 0.05);
}

/* A cell is half a second; noise rises by less than 2.5 a cell. */
static void patterns_change_continuously_with_the_lifetime(void **state)
{
    static const char *const noises[] = {"exact", "texture"};
    for (int k = 0; k < 2; k++) {
        test_twin *t = with_one(state, 0, NULL);
        test_twin_set(t, "noise", "%s", noises[k]);
        const ssfr_field *before = at_lifetime(t, 0.3f);
        for (int i = 1; i <= 8; i++) {
            const ssfr_field *after = at_lifetime(t, 0.3f + 0.02f * (float)i);
            const double change = test_difference(after, before);
            assert_true(change > 1e-4 && change < 0.8 * 2.5 * 0.02 / 0.5);
            before = after;
        }
        assert_true(test_difference(at_lifetime(t, 1.3f), at_lifetime(t, 0.3f)) > 0.1);
        const double texel = k ? 0.8 * ssfr_foam_perlin_rounding() : 0;
        assert_true(test_difference(at_lifetime(t, 0.5f + 4), at_lifetime(t, 0.5f)) <= 1e-12 + 1e3 * t->eps + texel);
        test_twin_set(t, "noise_rate", "0");
        assert_true(test_difference(at_lifetime(t, 1.7f), at_lifetime(t, 0.5f)) == 0);
    }
}

/* Two particles at places where they look alike, of the same lifetime. */
static void particles_have_patterns_by_their_ids_or_by_their_lifetimes_alone(void **state)
{
    static const double two[2][3] = {{-0.45, 0, -2}, {0.45, 0, -2}};
    test_twin *t = test_twin_create(state, "foam_thickness", 320, 80);
    const int apart = (int)rint(0.9 / 2 / t->scene.camera.tan_x * 160);
    assert_close(apart, 0.9 / 2 / t->scene.camera.tan_x * 160, 1e-6, 0); /* whole pixels */
    lifetimes[0] = lifetimes[1] = 0.7f;
    place(t, 2, two, 0.2, NULL, NULL);
    for (int by_lifetime = 0; by_lifetime < 2; by_lifetime++) {
        test_twin_set(t, "pattern", by_lifetime ? "lifetime" : "id");
        const ssfr_field *foam = test_twin_run(t, "foam_thickness");
        double largest = 0, most = 0;
        for (int y = 0; y < 80; y++)
            for (int x = 160 - apart; x < 160; x++) {
                const double one = *ssfr_field_at(foam, x, y), other = *ssfr_field_at(foam, x + apart, y);
                largest = fmax(largest, fabs(one - other)), most = fmax(most, one);
            }
        assert_true(most > 0.1);
        assert_true(by_lifetime ? largest < 1e-5 /* of their places, which are floats */ : largest > 0.02);
    }
}

/* ---- the front of the foam --------------------------------------------------------------------------------------- */

/* Behind a front at -2 m. By its centre all of a particle is near it or nothing; at each pixel, where its own front
 * is. */
static void what_is_within_delta_foam_is_the_front(void **state)
{
    const double radius = 0.05;
    test_twin *t = test_twin_create(state, "foam_thickness", W, H);
    test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -2));
    test_twin_set(t, "noise", "constant");
    test_twin_set(t, "delta_foam", "0.08");
    for (int i = 0; i < 16; i++) {
        const double z = i < 14 ? -1.9 - 0.0213 * i : i == 14 ? -2.0799 : -2.0801, one[1][3] = {{0.02, 0.01, z}};
        place(t, 1, one, radius, NULL, NULL);
        test_twin_set(t, "front", "centre");
        const ssfr_field *all = test_twin_run(t, "foam_thickness"), *front = test_twin_run(t, "foam_front");
        assert_true(z >= -2.08 ? test_same_bits(front, all) : test_difference(front, test_field(W, H, 1)) == 0);
        test_twin_set(t, "front", "fragment");
        front = test_twin_run(t, "foam_front");
        for (int k = 0; k < W * H; k++) {
            const double own = z + 0.5 * all->data[k] * 2; /* half a chord before the centre, of which half is noise */
            if (fabs(own + 2.08) < 1e-5) continue;
            assert_true(front->data[k] == (own > -2.08 ? all->data[k] : 0));
        }
    }
}

static void cloud(test_twin *t, double radius)
{
    static double eye[MOST][3];
    static float size[MOST], velocity[MOST][3];
    uint64_t random = 17;
    for (size_t i = 0; i < MOST; i++) {
        for (int k = 0; k < 3; k++) {
            eye[i][k] = k == 2 ? test_random(&random, -2.5, -1.5) : test_random(&random, -0.6, 0.6);
            velocity[i][k] = (float)test_random(&random, -2, 2);
        }
        size[i] = i % 4 ? (float)test_random(&random, 0.2, 1) : 0;
        lifetimes[i] = (float)test_random(&random, 0, 20);
    }
    place(t, MOST, (const double(*)[3])eye, radius, size, (const float(*)[3])velocity);
}

static void the_front_is_a_part_of_all(void **state)
{
    static const char *const fronts[] = {"fragment", "centre"};
    test_twin *t = test_twin_create(state, "foam_thickness", W, H), *d = test_twin_create(state, "foam_depth", W, H);
    cloud(t, 0.06);
    d->scene = t->scene;
    for (int j = 0; j < 2; j++) /* size and velocity */
        ssfr_values_lend(d->graph, d->graph->nodes[0].in[1 + j],
                         t->graph->resources[t->graph->nodes[0].in[2 + j]].values.lent);
    const ssfr_field *depth = test_twin_run(d, "depth");
    test_twin_give(t, "foam_depth", depth);
    const ssfr_field *before = NULL;
    for (int f = 0; f < 2; f++, before = NULL)
        for (double delta = 0; delta < 2; delta = 4 * delta + 0.02) {
            int n = 0, some = 0;
            test_twin_set(t, "front", "%s", fronts[f]);
            test_twin_set(t, "delta_foam", "%g", delta);
            const ssfr_field *all = test_twin_run(t, "foam_thickness"), *front = test_twin_run(t, "foam_front");
            for (int i = 0; i < W * H; i++) {
                assert_true(front->data[i] >= 0 && front->data[i] <= all->data[i] * (1 + 1e-6));
                if (before) assert_true(front->data[i] >= before->data[i] * (1 - 1e-6));
                n += all->data[i] > 0, some += front->data[i] > 0;
                assert_int_equal(all->data[i] > 0, ssfr_is_surface(depth->data[i]));
            }
            assert_true(n > W * H / 10);
            if (f == 0) assert_true(some >= n * 0.99); /* whoever is in front is within any delta */
            if (delta > 1.3) assert_true(test_difference(front, all) < 1e-6);
            before = front;
        }
}

/* It stands in two passes, of which one divides by it what the other adds up. */
static void delta_foam_is_that_of_the_composite(void **state)
{
    ssfr_graph *graph = NULL;
    (void)state;
    assert_int_equal(ssfr_graph_create(&graph, ssfr_pipeline_find("bagar2010"), NULL), SSFR_OK);
    assert_true(ssfr_graph_row(graph, "foam_thickness.delta_foam")->def ==
                ssfr_graph_row(graph, "layer_composite.delta_foam")->def);
    ssfr_graph_destroy(&graph);
}

/* ---- extremes ---------------------------------------------------------------------------------------------------- */

static void lifetimes_of_any_kind_have_a_pattern(void **state)
{
    static const float wild[] = {NAN, INFINITY, -INFINITY, 1e9f, 3e38f, -5, 1e-40f, 86400};
    static const char *const noises[] = {"exact", "texture"};
    test_twin *t = with_one(state, 0, NULL);
    const ssfr_field *newest = at_lifetime(t, 0);
    assert_true(test_difference(at_lifetime(t, NAN), newest) == 0); /* ages that are none count as 0 */
    assert_true(test_difference(at_lifetime(t, -5), newest) == 0);
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < SSFR_COUNT(wild); i++) {
            test_twin_set(t, "noise", "%s", noises[k]);
            const ssfr_field *foam = at_lifetime(t, wild[i]);
            double largest = 0;
            for (int j = 0; j < W * H; j++) {
                assert_true(foam->data[j] >= 0 && foam->data[j] <= 0.8);
                largest = fmax(largest, foam->data[j]);
            }
            assert_true(largest > 0.2);
        }
}

static void particles_without_a_size_are_not_drawn(void **state)
{
    static const double two[2][3] = {{-0.3, 0, -2}, {0.3, 0, -2}};
    static const float sizes[][2] = {{0, 0}, {-1, 0}, {NAN, -0.0f}};
    test_twin *t = test_twin_create(state, "foam_thickness", W, H);
    for (size_t i = 0; i < SSFR_COUNT(sizes); i++) {
        place(t, 2, two, 0.2, sizes[i], NULL);
        assert_true(test_difference(test_twin_run(t, "foam_thickness"), test_field(W, H, 1)) == 0);
        assert_true(test_difference(test_twin_run(t, "foam_front"), test_field(W, H, 1)) == 0);
    }
}

static void foam_thickness_is_not_needed_without_foam(void **state)
{
    static const float none[1] = {0};
    ssfr_node_status status;
    test_twin *t = with_one(state, 1, NULL);
    test_twin_run_if_needed(t, "foam_thickness", &status);
    assert_int_equal(status, SSFR_RAN);
    place(t, 1, c, 0.4, none, NULL);
    const ssfr_field *foam = test_twin_run_if_needed(t, "foam_front", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_true(foam->w == 1 && foam->data[0] == 0);
}

static void foam_thickness_refuses_values_out_of_range(void **state)
{
    test_twin *t = test_twin_create(state, "foam_thickness", 16, 16);
    test_twin_refuses(t, "noise", "white", "foam_thickness.noise");
    test_twin_refuses(t, "delta_foam", "-0.1", "foam_thickness.delta_foam");
    test_twin_refuses(t, "noise_rate", "nan", "foam_thickness.noise_rate");
    test_twin_refuses(t, "mass", "lost", "foam_thickness.mass");
}

/* ---- twins ------------------------------------------------------------------------------------------------------- */

/* Where streaks move, at every corner of the parameters. */
static void twins_agree_at_every_corner(void **state)
{
    (void)state;
    void *cpu = "cpu", *gpu = "gpu";
    test_twin *twins[2] = {test_twin_create(&cpu, "foam_thickness", W, H), NULL};
    twins[1] = test_twin_create(&gpu, "foam_thickness", W, H);
    const ssfr_pass *pass = ssfr_pass_find("foam_thickness");
    char corner[256];
    int n = 0;
    for (; ssfr_corner_at(pass, n, corner, sizeof corner); n++) {
        const ssfr_field *out[2][2];
        for (int k = 0; k < 2; k++) {
            test_twin *t = twins[k];
            char key[64], before[64];
            snprintf(key, sizeof key, "foam_thickness.%.*s", (int)strcspn(corner, "="), corner);
            if (n > 0) assert_int_equal(ssfr_graph_get(t->graph, key, before, sizeof before), SSFR_OK);
            if (n > 0) assert_int_equal(ssfr_graph_set(t->graph, key, strchr(corner, '=') + 1), SSFR_OK);
            cloud(t, 0.06);
            test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -1.7));
            test_twin_give(t, "scene_depth", test_field_filled(W, H, 1, -2.2));
            out[k][0] = test_twin_run(t, "foam_thickness"), out[k][1] = test_twin_run(t, "foam_front");
            if (n > 0) assert_int_equal(ssfr_graph_set(t->graph, key, before), SSFR_OK);
        }
        const ssfr_tolerance allowed = ssfr_twins_tolerance(pass, &twins[0]->graph->nodes[0].run);
        for (int j = 0; j < 2; j++) {
            int outside = 0;
            double sum = 0;
            for (int i = 0; i < W * H; i++) {
                const double expected = out[0][j]->data[i], d = fabs(out[1][j]->data[i] - expected);
                outside += !(d <= allowed.abs + allowed.rel * fabs(expected));
                sum += expected;
            }
            if (outside > allowed.outliers * W * H)
                fail_msg("\"%s\", output %d: %d values outside", corner, j, outside);
            assert_true(sum > 1);
        }
    }
    assert_true(n > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(a_quad_has_chord_kernel_and_noise_at_each_pixel),
        TEST_TWINS(the_mass_of_a_quad_is_its_integral),
        TEST_TWINS(noise_leaves_half_of_the_foam_on_average),
        TEST_TWINS(wall_takes_what_is_behind_it),
        TEST_TWINS(sums_of_halves_are_rounded_one_by_one),
        TEST_TWINS(foam_of_halves_takes_half_the_bytes),
        TEST_TWINS(the_texture_is_near_the_noise_and_constant_its_mean),
        TEST_TWINS(patterns_change_continuously_with_the_lifetime),
        TEST_TWINS(particles_have_patterns_by_their_ids_or_by_their_lifetimes_alone),
        TEST_TWINS(what_is_within_delta_foam_is_the_front),
        TEST_TWINS(the_front_is_a_part_of_all),
        cmocka_unit_test(delta_foam_is_that_of_the_composite),
        TEST_TWINS(lifetimes_of_any_kind_have_a_pattern),
        TEST_TWINS(particles_without_a_size_are_not_drawn),
        TEST_TWINS(foam_thickness_is_not_needed_without_foam),
        TEST_TWINS(foam_thickness_refuses_values_out_of_range),
        TEST_GPU(twins_agree_at_every_corner),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

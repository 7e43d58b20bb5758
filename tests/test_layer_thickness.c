/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_layer_thickness.c: water before and behind the foam, and sums that are stored in 16 bits. */
#include "graph/twins.h"
#include "tests/pass_util.h"

#include "experiments/corners.h"

enum { W = 61, H = 48 };

static double sum_of(const ssfr_field *field)
{
    double sum = 0;
    for (int i = 0; i < field->w * field->h; i++) sum += field->data[i];
    return sum;
}

typedef struct layers {
    const ssfr_field *back, *front;
} layers;

static layers run(test_twin *t)
{
    const ssfr_field *back = test_twin_run(t, "thickness_back");
    return (layers){back, test_twin_run(t, "thickness_front")};
}

static const char *const forms[] = {"point", "quad", "exact"}, *const rules[] = {"centre", "fragment"};

static test_twin *begin(void **state)
{
    return test_twin_create(state, "layer_thickness", W, H);
}

static void place_one(test_twin *t, const double c[3], double radius)
{
    test_twin_place(t, 1, (const double[][3]){{c[0], c[1], c[2]}}, radius, NULL);
}

/* The pass `thickness` in the same world. */
static test_twin *whole_of(void **state, const test_twin *t)
{
    test_twin *whole = test_twin_create(state, "thickness", t->scene.camera.w, t->scene.camera.h);
    whole->scene = t->scene;
    return whole;
}

static const double place[3] = {0.1, -0.07, -3};
static const double radius = 0.41; /* m */

/* ---- one sphere -------------------------------------------------------------------------------------------------- */

static void a_sphere_before_the_foam_is_all_front_and_one_behind_it_all_back(void **state)
{
    test_twin *t = begin(state), *whole = whole_of(state, t);
    place_one(t, place, radius);
    whole->scene = t->scene;
    const ssfr_field *none = test_field(W, H, 1);
    for (size_t k = 0; k < 2 * SSFR_COUNT(forms); k++) {
        test_twin_set(t, "layers", "%s", rules[k % 2]);
        test_twin_set(t, "splat", "%s", forms[k / 2]);
        test_twin_set(whole, "splat", "%s", forms[k / 2]);
        const ssfr_field *thickness = test_twin_run(whole, "thickness");
        test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -3.42));
        const layers before = run(t);
        assert_true(test_same_bits(before.front, thickness) && test_same_bits(before.back, none));
        test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -2.58));
        const layers behind = run(t);
        assert_true(test_same_bits(behind.back, thickness) && test_same_bits(behind.front, none));
    }
}

/* Exactly: what of the ray inside the sphere is before the foam. */
static void rays_are_cut_at_the_foam(void **state)
{
    static const double foams[] = {-2.7, -2.95, -3, -3.3};
    test_twin *t = begin(state);
    test_twin_set(t, "layers", "fragment");
    test_twin_set(t, "splat", "exact");
    place_one(t, place, radius);
    for (size_t k = 0; k < SSFR_COUNT(foams); k++) {
        int n_cut = 0;
        test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, foams[k]));
        const layers l = run(t);
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++) {
                const test_ray ray = test_ray_at(t, x, y, 1);
                const test_hit hit = test_meet(place, radius, ray);
                const double slant = sqrt(1 + ray.u * ray.u + ray.v * ray.v); /* length over depth */
                const double rounding = 2 * test_chord_rounding(t->eps, place, radius, hit.miss);
                const bool meets = hit.miss < radius;
                const double foam = meets ? ssfr_clamp(foams[k], hit.back, hit.front) : 0;
                assert_close(*ssfr_field_at(l.front, x, y), meets ? (hit.front - foam) * slant : 0, rounding, 0);
                assert_close(*ssfr_field_at(l.back, x, y), meets ? (foam - hit.back) * slant : 0, rounding, 0);
                n_cut += meets && foam > hit.back && foam < hit.front;
            }
        assert_true(n_cut > 50);
    }
}

/* Discs are cut as their own depth is; the kernel takes part in both halves. */
static void a_disc_with_foam_through_its_middle_is_halved(void **state)
{
    static const char *const kernels[] = {"chord", "exponential"};
    test_twin *t = begin(state), *whole = whole_of(state, t);
    test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -3));
    test_twin_set(t, "layers", "fragment");
    place_one(t, (const double[]){0, 0, -3}, radius);
    whole->scene = t->scene;
    for (int k = 0; k < 4; k++) {
        test_twin_set(t, "kernel", "%s", kernels[k / 2]);
        test_twin_set(t, "splat", "%s", forms[k % 2]);
        test_twin_set(whole, "kernel", "%s", kernels[k / 2]);
        test_twin_set(whole, "splat", "%s", forms[k % 2]);
        const ssfr_field *thickness = test_twin_run(whole, "thickness");
        const layers l = run(t);
        for (int i = 0; i < W * H; i++) {
            /* The rise over the centre is what is left of z + rise. */
            const double rounding = 4 * t->eps * (3 + radius);
            assert_close(l.front->data[i], thickness->data[i] / 2, rounding, 0);
            assert_close(l.back->data[i], thickness->data[i] / 2, rounding, 0);
        }
        assert_true(*ssfr_field_at(l.front, W / 2, H / 2) > 0.4 * radius);
    }
}

/* By its centre a sphere is before foam that is at the centre, and behind foam that is a millimetre nearer. */
static void a_centre_is_before_foam_that_is_as_far(void **state)
{
    static const struct {
        double foam;
        bool before;
    } cases[] = {{-3, true}, {-3.001, true}, {-2.999, false}, {-2.7, false}};
    test_twin *t = begin(state), *whole = whole_of(state, t);
    place_one(t, place, radius);
    whole->scene = t->scene;
    for (size_t k = 0; k < SSFR_COUNT(forms); k++) {
        test_twin_set(t, "splat", "%s", forms[k]);
        test_twin_set(whole, "splat", "%s", forms[k]);
        const ssfr_field *thickness = test_twin_run(whole, "thickness");
        for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
            test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, cases[i].foam));
            const layers l = run(t);
            assert_true(test_same_bits(cases[i].before ? l.front : l.back, thickness));
            assert_true(test_difference(cases[i].before ? l.back : l.front, test_field(W, H, 1)) == 0);
        }
    }
}

/* Foam as the sphere's own front and back: nothing is before the one, and all before the other. */
static void foam_at_the_surface_leaves_nothing_before_it(void **state)
{
    test_twin *t = begin(state);
    ssfr_field *front = test_field_filled(W, H, 1, -SSFR_EMPTY), *back = test_field_filled(W, H, 1, -SSFR_EMPTY);
    for (int i = 0; i < W * H; i++) {
        const test_hit hit = test_meet(place, radius, test_ray_at(t, i % W, i / W, 1));
        if (hit.miss < radius) front->data[i] = hit.front, back->data[i] = hit.back;
    }
    place_one(t, place, radius);
    test_twin_set(t, "layers", "fragment");
    test_twin_set(t, "splat", "exact");
    for (int k = 0; k < 2; k++) {
        test_twin_give(t, "foam_depth", k ? back : front);
        const layers l = run(t);
        double sum = 0;
        for (int i = 0; i < W * H; i++) {
            const double miss = test_meet(place, radius, test_ray_at(t, i % W, i / W, 1)).miss;
            const double rounding = 4 * test_chord_rounding(t->eps, place, radius, miss);
            assert_close((k ? l.back : l.front)->data[i], 0, rounding, 0);
            sum += (k ? l.front : l.back)->data[i];
        }
        assert_true(sum > 50);
    }
}

/* So far away that its front and its back are one number: its shares of that are numbers. */
static void a_sphere_without_depth_is_before_the_foam_or_behind_it(void **state)
{
    enum { ODD = 47 };
    static const double foams[] = {-1e14, -2e14, -5e13, -SSFR_EMPTY};
    static const char *const occlusions[] = {"front", "clipped"};
    test_twin *t = test_twin_create(state, "layer_thickness", ODD, ODD);
    place_one(t, (const double[]){0, 0, -1e14}, 1e-3);
    test_twin_set(t, "layers", "fragment");
    for (size_t k = 0; k < SSFR_COUNT(forms) * SSFR_COUNT(foams) * 2; k++) {
        test_twin_set(t, "splat", "%s", forms[k / 8]);
        test_twin_set(t, "occlusion", "%s", occlusions[k / 4 % 2]);
        test_twin_give(t, "foam_depth", test_field_filled(ODD, ODD, 1, foams[k % 4]));
        const layers l = run(t);
        for (int i = 0; i < ODD * ODD; i++) {
            const double back = l.back->data[i], front = l.front->data[i];
            assert_true(back >= 0 && front >= 0 && back + front <= 2.001e-3);
        }
    }
}

/* ---- where the centre is looked up ------------------------------------------------------------------------------- */

/* One pixel is nearer than the sphere: the one where its centre is seen decides for all of it. */
static void the_pixel_at_the_centre_decides_for_the_whole_splat(void **state)
{
    test_twin *t = begin(state);
    const int cx = (int)(0.5 * W - place[0] / place[2] * H), cy = (int)(0.5 * H + place[1] / place[2] * H);
    place_one(t, place, radius);
    for (size_t k = 0; k < SSFR_COUNT(forms); k++)
        for (int aside = 0; aside < 2; aside++) {
            ssfr_field *foam = test_field_filled(W, H, 1, -4);
            *ssfr_field_at(foam, cx + aside, cy) = -1;
            test_twin_set(t, "splat", "%s", forms[k]);
            test_twin_give(t, "foam_depth", foam);
            const layers l = run(t);
            assert_true(test_difference(aside ? l.back : l.front, test_field(W, H, 1)) == 0);
            assert_true(*ssfr_field_at(aside ? l.front : l.back, cx, cy) > radius);
        }
}

/* Only columns 0 and W - 1, rows 0 and H - 1 have foam before the spheres. */
static void a_centre_outside_the_image_takes_the_nearest_pixel(void **state)
{
    static const double outside[][3] = {
        {-2.2, 0, -3}, {2.3, 0.2, -3}, {0.3, 1.8, -3}, {-0.2, -1.9, -3}, {2.1, 1.7, -3}};
    test_twin *t = begin(state);
    ssfr_field *frame = test_field_filled(W, H, 1, -4), *inside = test_field_filled(W, H, 1, -1);
    for (int i = 0; i < W * H; i++) {
        const int x = i % W, y = i / W;
        if (x > 0 && x < W - 1 && y > 0 && y < H - 1) continue;
        frame->data[i] = -1, inside->data[i] = -4;
    }
    for (size_t i = 0; i < 2 * SSFR_COUNT(outside); i++) {
        test_twin_set(t, "splat", "%s", forms[1 + i % 2]); /* a point without its centre is not drawn */
        place_one(t, outside[i / 2], 0.6);
        for (int k = 0; k < 2; k++) {
            test_twin_give(t, "foam_depth", k ? inside : frame);
            const layers l = run(t);
            const double back = sum_of(l.back), front = sum_of(l.front);
            assert_true((k ? front : back) > 0.1 && (k ? back : front) == 0);
        }
    }
}

/* Its centre is nearer than any foam can be, but without foam there is nothing to be before. */
static void a_sphere_around_the_eye_is_before_all_foam(void **state)
{
    static const double centres[][3] = {{0.1, 0.05, 0.2}, {0.1, 0.05, 0}, {-0.05, 0.1, -0.2}};
    test_twin *t = begin(state);
    test_twin_set(t, "splat", "exact");
    for (size_t i = 0; i < SSFR_COUNT(centres); i++) {
        place_one(t, centres[i], 1);
        test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -0.5));
        const layers with = run(t);
        test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -SSFR_EMPTY));
        const layers without = run(t);
        assert_true(test_same_bits(with.front, without.back));
        for (int k = 0; k < W * H; k++)
            assert_true(with.back->data[k] == 0 && without.front->data[k] == 0 && with.front->data[k] > 0.5);
    }
}

/* Where its centre is seen cannot be told, but which side it is on: the upper right corner decides. */
static void a_centre_at_or_behind_the_eye_is_seen_as_if_before_it(void **state)
{
    static const double centres[][3] = {{0.1, 0.05, 0.2}, {0.1, 0.05, 0}};
    test_twin *t = begin(state);
    test_twin_set(t, "splat", "exact");
    for (size_t i = 0; i < 2 * SSFR_COUNT(centres); i++) {
        ssfr_field *foam = test_field_filled(W, H, 1, i % 2 ? -0.5 : -SSFR_EMPTY);
        *ssfr_field_at(foam, W - 1, 0) = i % 2 ? -SSFR_EMPTY : -0.5;
        place_one(t, centres[i / 2], 1);
        test_twin_give(t, "foam_depth", foam);
        const layers l = run(t);
        for (int k = 0; k < W * H; k++) assert_true((i % 2 ? l.front : l.back)->data[k] == 0);
        assert_true(sum_of(i % 2 ? l.back : l.front) > 1000);
    }
}

/* A centre between the eye and the near plane, of which one pixel decides: the one where it is seen if on that plane. */
static void a_centre_before_the_near_plane_is_seen_as_if_in_it(void **state)
{
    static const double centre[] = {0.1, 0.05, -0.2};
    test_twin *t = begin(state);
    t->scene.camera.near = 0.5;
    const int x = (int)(0.5 * W + centre[0] / 0.5 * H), y = (int)(0.5 * H - centre[1] / 0.5 * H);
    test_twin_set(t, "splat", "exact");
    place_one(t, centre, 1);
    for (int aside = 0; aside < 2; aside++) {
        ssfr_field *foam = test_field_filled(W, H, 1, -SSFR_EMPTY);
        *ssfr_field_at(foam, x + aside, y) = -0.6;
        test_twin_give(t, "foam_depth", foam);
        const layers l = run(t);
        assert_true(sum_of(aside ? l.back : l.front) > 1000 && sum_of(aside ? l.front : l.back) == 0);
    }
}

/* ---- many -------------------------------------------------------------------------------------------------------- */

enum { MANY = 60 };

static void place_many(test_twin *t)
{
    double eye[MANY][3];
    uint64_t random = 23;
    for (int i = 0; i < MANY; i++)
        for (int k = 0; k < 3; k++) /* dyadic: nothing is rounded on the way into packets */
            eye[i][k] = floor(64 * test_random(&random, k == 2 ? -3.5 : -1, k == 2 ? -2 : 1)) / 64;
    test_twin_place(t, MANY, eye, 0.25, NULL);
}

/* A leaning plane with holes, of which some are not a number. */
static ssfr_field *torn_foam(const test_twin *t)
{
    ssfr_field *foam = test_field(W, H, 1);
    for (int i = 0; i < W * H; i++) {
        const int x = i % W, y = i / W;
        const double z = (double)(float)test_plane(-2.7, 0.6, -0.3, test_ray_at(t, x, y, 1));
        foam->data[i] = x / 7 % 3 == 1 && y / 5 % 2 == 0 ? (x % 2 ? NAN : -SSFR_EMPTY) : z;
    }
    return foam;
}

static void the_layers_add_up_to_the_whole_thickness(void **state)
{
    static const char *const kernels[] = {"chord", "exponential"}, *const occlusions[] = {"front", "clipped"};
    test_twin *t = begin(state);
    place_many(t);
    test_twin *whole = whole_of(state, t), *const both[] = {t, whole};
    test_twin_give(t, "foam_depth", torn_foam(t));
    ssfr_field *wall = test_field(W, H, 1);
    for (int i = 0; i < W * H; i++) wall->data[i] = test_plane(-2.9, -0.5, 0.1, test_ray_at(t, i % W, i / W, 1));
    for (int b = 0; b < 2; b++) test_twin_give(both[b], "scene_depth", wall);
    for (int k = 0; k < 24; k++) {
        test_twin_set(t, "layers", "%s", rules[k / 12]);
        for (int b = 0; b < 2; b++) {
            test_twin_set(both[b], "splat", "%s", forms[k % 3]);
            test_twin_set(both[b], "kernel", "%s", kernels[k / 3 % 2]);
            test_twin_set(both[b], "occlusion", "%s", occlusions[k / 6 % 2]);
        }
        const ssfr_field *thickness = test_twin_run(whole, "thickness");
        const layers l = run(t);
        for (int i = 0; i < W * H; i++) {
            assert_true(l.back->data[i] >= 0 && l.front->data[i] >= 0);
            assert_close(l.back->data[i] + l.front->data[i], thickness->data[i], 1e-30, MANY * t->eps);
        }
        assert_true(sum_of(l.back) > 50 && sum_of(l.front) > 50);
    }
}

/* What is before the scene and before the foam: the nearer of them cuts. */
static void clipped_layers_end_at_the_scene(void **state)
{
    static const double walls[] = {-2.8, -3.2};
    test_twin *t = begin(state);
    place_one(t, (const double[]){0, 0, -3}, 0.5);
    test_twin_set(t, "splat", "quad");
    test_twin_set(t, "layers", "fragment");
    test_twin_set(t, "occlusion", "clipped");
    test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -3));
    t->scene.camera.w = W; /* odd: a pixel's middle is on the axis */
    for (int k = 0; k < 2; k++) {
        test_twin_give(t, "scene_depth", test_field_filled(W, H, 1, walls[k]));
        const layers l = run(t);
        const test_ray ray = test_ray_at(t, W / 2, H / 2, 1);
        const double rise = sqrt(0.25 - 9 * (ray.u * ray.u + ray.v * ray.v));
        assert_close(*ssfr_field_at(l.front, W / 2, H / 2), rise - (k ? 0 : 0.2), 64 * t->eps, 0);
        assert_close(*ssfr_field_at(l.back, W / 2, H / 2), k ? 0.2 : 0, 64 * t->eps, 0);
    }
}

/* ---- without foam ------------------------------------------------------------------------------------------------ */

static void where_there_is_no_foam_all_is_back(void **state)
{
    static const double none[] = {-SSFR_EMPTY, SSFR_EMPTY, NAN, -INFINITY};
    test_twin *t = begin(state);
    place_many(t);
    test_twin *whole = whole_of(state, t);
    const ssfr_field *thickness = test_twin_run(whole, "thickness");
    for (size_t i = 0; i < 2 * SSFR_COUNT(none); i++) {
        test_twin_set(t, "layers", "%s", rules[i % 2]);
        test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, none[i / 2]));
        const layers l = run(t);
        assert_true(test_same_bits(l.back, thickness) && test_same_bits(l.front, test_field(W, H, 1)));
        test_twin_set(t, "as_printed", "B36");
        const layers printed = run(t);
        assert_true(test_same_bits(printed.front, thickness) && test_same_bits(printed.back, test_field(W, H, 1)));
        test_twin_set(t, "as_printed", "none");
    }
}

/* Nobody draws foam: one image is made, of the bits and the work of `thickness`, and the other is one pixel. */
static void without_foam_in_view_it_is_the_pass_thickness(void **state)
{
    static const char *const defaults[] = {"radius_scale=1", "kernel=exponential", "occlusion=clipped", "storage=half",
                                           "splat=exact"};
    ssfr_node_status status;
    test_twin *t = begin(state);
    place_many(t);
    test_twin *whole = whole_of(state, t), *const both[] = {t, whole};
    for (size_t i = 0; i < SSFR_COUNT(defaults); i++) {
        const char *value = strchr(defaults[i], '=') + 1;
        char key[32];
        snprintf(key, sizeof key, "%.*s", (int)(value - 1 - defaults[i]), defaults[i]);
        for (int b = 0; b < 2; b++) test_twin_set(both[b], key, "%s", value);
        const ssfr_field *thickness = test_twin_run_if_needed(whole, "thickness", &status);
        const ssfr_field *back = test_twin_run_if_needed(t, "thickness_back", &status);
        const ssfr_field *front = test_twin_run_if_needed(t, "thickness_front", &status);
        const ssfr_report *r = ssfr_graph_report(t->graph), *plain = ssfr_graph_report(whole->graph);
        assert_int_equal(status, SSFR_RAN);
        assert_true(test_same_bits(back, thickness));
        assert_true(front->w == 1 && front->h == 1 && front->data[0] == 0);
        assert_true(r->nodes[0].bytes == plain->nodes[0].bytes && r->nodes[0].taps == plain->nodes[0].taps);
        assert_true(r->image_bytes == plain->image_bytes);
    }
    test_twin_run(t, "thickness_back"); /* nothing left out */
    assert_true(ssfr_graph_report(t->graph)->image_bytes > ssfr_graph_report(whole->graph)->image_bytes);
}

/* As printed both images are made: without foam all is in the front one. */
static void b36_needs_both_layers_without_foam_in_view(void **state)
{
    ssfr_node_status status;
    test_twin *t = begin(state);
    place_many(t);
    const ssfr_field *back = test_twin_run_if_needed(t, "thickness_back", &status);
    test_twin_set(t, "as_printed", "B36");
    assert_true(test_same_bits(test_twin_run_if_needed(t, "thickness_front", &status), back));
    assert_true(test_same_bits(test_twin_run_if_needed(t, "thickness_back", &status), test_field(W, H, 1)));
}

/* Foam that comes and goes: the image that is no longer made is not read either. */
static void the_front_layer_comes_and_goes_with_the_foam(void **state)
{
    ssfr_node_status status;
    test_twin *t = begin(state);
    place_many(t);
    for (int i = 0; i < 3; i++) {
        test_twin_give(t, "foam_depth", i % 2 ? NULL : test_field_filled(W, H, 1, -2.6));
        const ssfr_field *front = test_twin_run_if_needed(t, "thickness_front", &status);
        assert_true(i % 2 ? front->w == 1 && front->data[0] == 0 : front->w == W && sum_of(front) > 10);
    }
}

static void there_are_no_layers_without_particles_in_view(void **state)
{
    ssfr_node_status status;
    test_twin *t = begin(state);
    test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -2));
    place_one(t, (const double[]){0, 0, 5}, 0.3);
    const ssfr_field *front = test_twin_run_if_needed(t, "thickness_front", &status);
    assert_int_equal(status, SSFR_NEEDLESS);
    assert_true(front->w == 1 && front->data[0] == 0);
    assert_true(test_difference(run(t).back, test_field(W, H, 1)) == 0);
}

/* ---- particles that are foam ------------------------------------------------------------------------------------- */

/* Of three particles side by side the second is half foam and the third all: rho v^2 is 0, 1000 and 2000. */
static const ssfr_pipeline foamy = {
    .name = "foamy", .source = "test", .help = "test", .result = SSFR_SLOT_thickness_back,
    .nodes = {{"weber_foam", .settings = {"transition=weber", "threshold=1000", "length=1", "tension=1", "band=1"}},
              {"sparse", .settings = {"density_threshold=0"}},
              {"layer_thickness", .settings = {"layers=fragment"}}},
};

static void place_three(test_twin *t)
{
    static const double eye[3][3] = {{-1, 0, -3}, {0, 0, -3}, {1, 0, -3}};
    float *velocity, *density;
    test_twin_place(t, 3, eye, radius, (const uint32_t[]){0, 1, 2});
    ssfr_particles *p = (ssfr_particles *)t->scene.particles; /* which the test made */
    assert_int_equal(ssfr_alloc(&velocity, 9, sizeof *velocity, "velocities"), SSFR_OK);
    assert_int_equal(ssfr_alloc(&density, 3, sizeof *density, "densities"), SSFR_OK);
    for (size_t i = 0; i < 3; i++) velocity[3 * i] = p->id[i] == 0 ? 0 : p->id[i] == 1 ? 1 : 1.5f, density[i] = 1000;
    p->velocity = velocity, p->density = density;
}

/* In the middle of the i-th, both layers. */
static double at_particle(const layers *l, int i)
{
    const int x = W / 2 + (i - 1) * H / 3, y = H / 2;
    return *ssfr_field_at(l->back, x, y) + *ssfr_field_at(l->front, x, y);
}

/* It is uploaded, and counted, where a particle that has any is left out, and nowhere else. */
static void foam_of_particles_is_read_where_it_leaves_them_out(void **state)
{
    double bytes[2];
    test_twin *t = test_twin_create_for(state, &foamy, W, H);
    place_three(t);
    test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -2.9));
    for (int b14 = 0; b14 < 2; b14++) {
        test_twin_set(t, "layer_thickness.as_printed", b14 ? "B14" : "none");
        run(t);
        bytes[b14] = ssfr_graph_report(t->graph)->nodes[2].bytes;
    }
    assert_true(bytes[1] == bytes[0] + 3 * sizeof(float));
}

static void water_that_turns_to_foam_is_as_thick_as_its_size(void **state)
{
    static const double sizes[] = {1, 0.5, 0}, printed[] = {1, 0, 0};
    test_twin *t = test_twin_create_for(state, &foamy, W, H);
    place_three(t);
    test_twin_give(t, "foam_depth", test_field_filled(W, H, 1, -2.9));
    for (size_t k = 0; k < 4 * SSFR_COUNT(forms); k++) {
        const bool b14 = k % 2, by_size = k / 2 % 2;
        test_twin_set(t, "layer_thickness.splat", "%s", forms[k / 4]);
        test_twin_set(t, "layer_thickness.as_printed", b14 ? "B14" : "none");
        test_twin_set(t, "sparse.by_foam", by_size ? "1" : "0");
        const layers l = run(t);
        for (int i = 0; i < 3; i++) {
            const double size = b14 ? printed[i] : by_size ? sizes[i] : 1, most = 2 * radius * size;
            if (size == 0) assert_true(at_particle(&l, i) == 0);
            else assert_close(at_particle(&l, i), most, 0, 0.05); /* near its middle */
        }
    }
}

/* ---- 16 bits ----------------------------------------------------------------------------------------------------- */

/* The half next to v, towards zero; of the numbers that halves hold in full. */
static double half_below(double v)
{
    const double half = ssfr_half_round(v);
    return half <= v ? half : ssfr_half_round(nextafter(half - 0x1p-11 * half, 0));
}

/* Each particle by itself, in the order in which they are drawn. */
static void sums_are_rounded_one_by_one(void **state)
{
    test_twin *t = test_twin_create(state, "thickness", W, H);
    static double nearest[W * H], lowest[W * H];
    memset(nearest, 0, sizeof nearest), memset(lowest, 0, sizeof lowest);
    test_twin_set(t, "splat", "quad");
    place_many(t);
    const ssfr_particles *all = t->scene.particles;
    for (size_t i = 0; i < MANY; i++) {
        double at[3];
        ssfr_particles_position(all, i, at);
        place_one(t, at, 0.25);
        const ssfr_field *one = test_twin_run(t, "thickness");
        for (int k = 0; k < W * H; k++) {
            nearest[k] = ssfr_half_round(nearest[k] + one->data[k]);
            lowest[k] = half_below(lowest[k] + half_below(one->data[k]));
        }
    }
    t->scene.particles = all;
    test_twin_set(t, "storage", "half");
    const ssfr_field *sum = test_twin_run(t, "thickness");
    int n = 0;
    for (int k = 0; k < W * H; k++) {
        const double v = sum->data[k];
        assert_true(v == ssfr_half_round(v));
        if (!t->gl) assert_true(v == nearest[k]);
        /* GL does not say how it rounds; where a float decides otherwise, by a step. */
        else assert_true(v >= lowest[k] * (1 - 0x1p-9) - 0x1p-24 && v <= nearest[k] * (1 + 0x1p-9) + 0x1p-24);
        n += v > 0.5;
    }
    assert_true(n > 100);
}

static void layers_of_halves_take_half_the_bytes(void **state)
{
    test_twin *t = begin(state);
    place_many(t);
    test_twin_give(t, "foam_depth", torn_foam(t));
    const layers single = run(t);
    const ssfr_report *r = ssfr_graph_report(t->graph);
    const double moved = r->nodes[0].bytes, held = r->image_bytes;
    for (int i = 0; i < 2; i++) {
        test_twin_set(t, "storage", "half");
        const layers half = run(t);
        assert_true(r->nodes[0].bytes == moved - 2 * 2.0 * W * H); /* two images that are written, 2 bytes less each */
        assert_true(r->image_bytes == (t->gl ? held - 2 * 2.0 * W * H : held));
        for (int k = 0; k < W * H; k++) {
            assert_true(half.back->data[k] == ssfr_half_round(half.back->data[k]));
            assert_true(half.front->data[k] == ssfr_half_round(half.front->data[k]));
            assert_close(half.front->data[k], single.front->data[k], 1e-7, MANY * 0x1p-10);
        }
        test_twin_set(t, "storage", "float");
        assert_true(test_same_bits(run(t).front, single.front));
        assert_true(r->image_bytes == held);
    }
}

/* 100 times a chord of 800 m is more than a half holds: infinite, or the largest. Pictures are none the worse. */
static void pictures_are_finite_when_halves_overflow(void **state)
{
    static const char *const passes[][2] = {{"vanderlaan2009", "thickness"}, {"bagar2010", "layer_thickness"}};
    for (size_t i = 0; i < SSFR_COUNT(passes); i++) {
        char key[64];
        ssfr_field *pictures[2];
        test_twin *t = test_twin_create_for(state, ssfr_pipeline_find(passes[i][0]), W, H);
        place_one(t, (const double[]){20, 10, -1000}, 400);
        snprintf(key, sizeof key, "%s.scale", passes[i][1]);
        test_twin_set(t, key, "100");
        for (int half = 0; half < 2; half++) {
            snprintf(key, sizeof key, "%s.storage", passes[i][1]);
            test_twin_set(t, key, half ? "half" : "float");
            pictures[half] = test_twin_run(t, "color");
            const ssfr_field *thickness = test_twin_run(t, i ? "thickness_back" : "thickness");
            double most = 0;
            for (int k = 0; k < W * H; k++) most = fmax(most, thickness->data[k]);
            assert_true(half ? most == 65504 || isinf(most) : most > 7e4);
        }
        for (int k = 0; k < 3 * W * H; k++) assert_true(isfinite(pictures[1]->data[k]));
        assert_true(test_difference(pictures[0], pictures[1]) < 1e-6); /* nothing comes through in either */
    }
}

/* ---- twins ------------------------------------------------------------------------------------------------------- */

/* Of what is in the corner "param=value". */
static void compare_at(test_twin *cpu, test_twin *gpu, const char *corner, int *n_failed)
{
    const ssfr_pass *pass = ssfr_pass_find("layer_thickness");
    const layers reference = run(cpu), measured = run(gpu);
    const ssfr_tolerance tolerance = ssfr_twins_tolerance(pass, ssfr_graph_last_run(cpu->graph, 0));
    const ssfr_field *const a[] = {measured.back, measured.front}, *const b[] = {reference.back, reference.front};
    int n_outside = 0;
    for (int k = 0; k < 2 * W * H; k++) {
        const double v = a[k % 2]->data[k / 2], r = b[k % 2]->data[k / 2];
        n_outside += !(fabs(v - r) <= tolerance.abs + tolerance.rel * fabs(r));
    }
    if (n_outside <= tolerance.outliers * 2 * W * H) return;
    print_error("at \"%s\" %d of %d values differ\n", corner, n_outside, 2 * W * H);
    ++*n_failed;
}

static void the_twins_agree_with_foam_in_view_at_every_corner(void **state)
{
    char corner[128];
    int n_failed = 0;
    static char on_cpu[] = "cpu";
    void *first = on_cpu;
    for (int i = 0; ssfr_corner_at(ssfr_pass_find("layer_thickness"), i, corner, sizeof corner); i++) {
        if (strncmp(corner, "max_point_px", 12) == 0) continue; /* GPUs have their own limits */
        test_twin *const both[] = {begin(&first), begin(state)};
        const ssfr_field *foam = torn_foam(both[0]);
        const char *value = strchr(corner, '=');
        char key[128];
        snprintf(key, sizeof key, "%.*s", (int)strcspn(corner, "="), corner);
        for (int b = 0; b < 2; b++) {
            if (value) test_twin_set(both[b], key, "%s", value + 1);
            place_many(both[b]);
            test_twin_give(both[b], "foam_depth", foam);
        }
        compare_at(both[0], both[1], corner, &n_failed);
        test_clean(NULL);
    }
    assert_int_equal(n_failed, 0);
}

static void layer_thickness_refuses_values_out_of_range(void **state)
{
    test_twin *t = begin(state);
    test_twin_refuses(t, "layers", "both", "both");
    test_twin_refuses(t, "storage", "double", "double");
    test_twin_refuses(t, "scale", "-1", "layer_thickness.scale");
    test_twin_refuses(t, "as_printed", "B14,B15", "B15");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST_TWINS(a_sphere_before_the_foam_is_all_front_and_one_behind_it_all_back),
        TEST_TWINS(rays_are_cut_at_the_foam),
        TEST_TWINS(a_disc_with_foam_through_its_middle_is_halved),
        TEST_TWINS(a_centre_is_before_foam_that_is_as_far),
        TEST_TWINS(foam_at_the_surface_leaves_nothing_before_it),
        TEST_TWINS(a_sphere_without_depth_is_before_the_foam_or_behind_it),
        TEST_TWINS(the_pixel_at_the_centre_decides_for_the_whole_splat),
        TEST_TWINS(a_centre_outside_the_image_takes_the_nearest_pixel),
        TEST_TWINS(a_sphere_around_the_eye_is_before_all_foam),
        TEST_TWINS(a_centre_at_or_behind_the_eye_is_seen_as_if_before_it),
        TEST_TWINS(a_centre_before_the_near_plane_is_seen_as_if_in_it),
        TEST_TWINS(the_layers_add_up_to_the_whole_thickness),
        TEST_TWINS(clipped_layers_end_at_the_scene),
        TEST_TWINS(where_there_is_no_foam_all_is_back),
        TEST_TWINS(without_foam_in_view_it_is_the_pass_thickness),
        TEST_TWINS(b36_needs_both_layers_without_foam_in_view),
        TEST_TWINS(the_front_layer_comes_and_goes_with_the_foam),
        TEST_TWINS(there_are_no_layers_without_particles_in_view),
        TEST_TWINS(water_that_turns_to_foam_is_as_thick_as_its_size),
        TEST_TWINS(foam_of_particles_is_read_where_it_leaves_them_out),
        TEST_TWINS(sums_are_rounded_one_by_one),
        TEST_TWINS(layers_of_halves_take_half_the_bytes),
        TEST_TWINS(pictures_are_finite_when_halves_overflow),
        TEST_GPU(the_twins_agree_with_foam_in_view_at_every_corner),
        TEST_TWINS(layer_thickness_refuses_values_out_of_range),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

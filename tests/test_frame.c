/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_frame.c: what a frame knows before it is drawn: particles in view, tiles, the nearest fluid, eye space. */
#include "tests/frames.h"

#include "graph/graph.h"
#include "passes/environment.h"
#include "scene/solid.h"

static ssfr_world world;

static int set_up(void **state)
{
    ssfr_world_default(&world);
    return test_capture_log(state);
}

static void prepare(ssfr_frame *frame, const ssfr_scene *scene, double reach, bool keep_all)
{
    const unsigned keep = keep_all ? SSFR_KEEP_ALL : 0;
    long grew = 0;
    if (ssfr_frame_prepare(frame, scene, &world, reach, keep, &grew) != SSFR_OK) fail_msg("%s", test_last_error());
}

/* A packet of particles of 2 cm within 20 cm of a place; the camera stands at the origin and looks along -z. */
static void create_heap(test_scene *s, double x, double y, double z)
{
    double positions[3 * SSFR_PACKET];
    uint64_t seed = 11;
    for (int i = 0; i < 3 * SSFR_PACKET; i++)
        positions[i] = (double[3]){x, y, z}[i % 3] + test_random(&seed, -0.2, 0.2);
    test_scene_create(s, SSFR_PACKET, positions, 0.02);
    test_scene_look(s, (const double[3]){0, 0, 0}, (const double[3]){0, 0, -1}, 60, 320, 200);
}

/* ---- culling ----------------------------------------------------------------------------------------------------- */

static void particles_out_of_view_are_culled(void **state)
{
    (void)state;
    static const struct {
        double at[3];
        bool visible;
    } cases[] = {
        {{0, 0, -3}, true},     {{0, 0, 3}, false},  {{6, 0, -3}, false},  {{-6, 0, -3}, false},
        {{0, 4, -3}, false},    {{0, -4, -3}, false}, {{0, 0, 0.1}, true}, {{2.8, 0, -3}, true},
        {{0, 1.8, -3}, true},   {{6, 6, 0.1}, true}, {{0, 0, 0.2301}, false}, {{0, 0, -1e5}, true},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        test_scene s;
        ssfr_frame frame = {0};
        create_heap(&s, cases[i].at[0], cases[i].at[1], cases[i].at[2]);
        prepare(&frame, &s.scene, 1, false);
        if ((frame.facts.n_particles > 0) != cases[i].visible) fail_msg("case %zu", i);
        assert_int_equal(frame.facts.n_particles, cases[i].visible ? SSFR_PACKET : 0);
        assert_int_equal(frame.facts.n_ranges, cases[i].visible);
        assert_true((frame.facts.n_tiles > 0) == cases[i].visible);
        prepare(&frame, &s.scene, 1, true);
        assert_int_equal(frame.facts.n_particles, SSFR_PACKET);
        assert_int_equal(frame.facts.n_tiles, 10 * 7);
        ssfr_frame_finish(&frame);
        test_scene_destroy(&s);
    }
}

static void what_is_before_the_near_plane_is_culled(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    create_heap(&s, 0, 0, -3);
    s.scene.camera.near = 3.5;
    prepare(&frame, &s.scene, 1, false);
    assert_int_equal(frame.facts.n_particles, 0);
    s.scene.camera.near = 3;
    prepare(&frame, &s.scene, 1, false);
    assert_int_equal(frame.facts.n_particles, SSFR_PACKET);
    assert_true(frame.facts.nearest == 3);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void a_wider_reach_brings_particles_into_view(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    create_heap(&s, 0, 2.2, -3);
    prepare(&frame, &s.scene, 1, false);
    assert_int_equal(frame.facts.n_particles, 0);
    assert_false(frame.facts.fluid);
    prepare(&frame, &s.scene, 30, false);
    assert_int_equal(frame.facts.n_particles, SSFR_PACKET);
    assert_true(frame.facts.fluid && frame.facts.mean == frame.facts.nearest);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

/* Its centre is half a radius over the image's upper edge. */
static void a_sphere_that_reaches_into_view_counts_in_the_mean(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    test_scene_create(&s, 1, (const double[3]){0, 3 / sqrt(3) + 0.1, -3}, 0.2);
    test_scene_look(&s, (const double[3]){0, 0, 0}, (const double[3]){0, 0, -1}, 60, 320, 200);
    prepare(&frame, &s.scene, 1, false);
    assert_close(frame.facts.mean, 3, 0, 1e-15);
    assert_close(frame.facts.nearest, 2.8, 0, 1e-15);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void no_particles_make_no_facts(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    test_scene_create(&s, 0, NULL, 0);
    test_scene_look(&s, (const double[3]){0, 1, 2}, (const double[3]){0, 0, 0}, 45, 37, 23);
    for (int i = 0; i < 2; i++) {
        prepare(&frame, &s.scene, 1, false);
        assert_int_equal(frame.facts.n_particles, 0);
        assert_int_equal(frame.facts.n_ranges, 0);
        assert_int_equal(frame.facts.n_tiles, 0);
        assert_true(frame.facts.covered == 0);
        s.scene.particles = NULL;
    }
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void the_mean_distance_weighs_packets_by_particles(void **state)
{
    (void)state;
    static double positions[3 * (SSFR_PACKET + SSFR_PACKET / 2)];
    test_scene s;
    ssfr_frame frame = {0};
    for (int i = 0; i < SSFR_PACKET * 3 / 2; i++) positions[3 * i + 2] = i < SSFR_PACKET ? -8 : -2;
    test_scene_create(&s, SSFR_PACKET * 3 / 2, positions, 0.02);
    test_scene_look(&s, (const double[3]){0, 0, 0}, (const double[3]){0, 0, -1}, 60, 320, 200);
    prepare(&frame, &s.scene, 1, false);
    assert_close(frame.facts.mean, 6, 0, 1e-15);
    assert_close(frame.facts.nearest, 1.98, 0, 1e-15);
    prepare(&frame, &s.scene, 50, false);
    assert_close(frame.facts.mean, 6, 0, 1e-15); /* it has nothing to do with how far splats reach */
    assert_close(frame.facts.nearest, 1, 0, 1e-15);
    s.scene.camera.near = 7;
    prepare(&frame, &s.scene, 1, false);
    assert_close(frame.facts.mean, 8, 0, 1e-15);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void neighbouring_packets_make_one_range(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    test_scene_create_block(&s, (const int[3]){20, 10, 10}, (const double[3]){0, 0, -3}, 0.02);
    test_scene_look(&s, (const double[3]){0, 0, 0}, (const double[3]){0, 0, -1}, 60, 320, 200);
    prepare(&frame, &s.scene, 1, false);
    assert_int_equal(frame.n_packets, (2000 + SSFR_PACKET - 1) / SSFR_PACKET);
    assert_int_equal(frame.facts.n_ranges, 1);
    assert_int_equal(frame.facts.first[0], 0);
    assert_int_equal(frame.facts.count[0], 2000);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

/* ---- tiles, against every pixel that a splat touches ------------------------------------------------------------- */

static const char *const splats[][3] = {
    {"sphere_depth.splat=point", NULL},
    {"sphere_depth.splat=quad", NULL},
    {"sphere_depth.splat=quad", "sphere_depth.size=distance", NULL},
    {"sphere_depth.splat=exact", NULL},
};

/* A view of the block from near or far, or from inside; wide or narrow; in odd sizes. */
static void look_somewhere(test_scene *s, uint64_t *seed)
{
    double eye[3], target[3];
    const double away = pow(10, test_random(seed, -1.5, 1.2));
    for (int k = 0; k < 3; k++) eye[k] = away * test_random(seed, -1, 1), target[k] = 0.4 * test_random(seed, -1, 1);
    const double fov = test_random(seed, 0, 1) < 0.2 ? test_random(seed, 120, 175) : test_random(seed, 5, 90);
    test_scene_look(s, eye, target, fov, (int)test_random(seed, 1, 300), (int)test_random(seed, 1, 200));
    s->scene.camera.near = pow(10, test_random(seed, -4, 0));
    s->scene.camera.far = 100;
}

static void assert_facts_hold(const ssfr_frame *frame, const ssfr_field *depth, int camera)
{
    const ssfr_facts *facts = &frame->facts;
    int n_tiles = 0;
    for (int i = 0; i < facts->tiles_x * facts->tiles_y; i++) n_tiles += facts->mask[i];
    assert_int_equal(n_tiles, facts->n_tiles);
    for (int i = 0; i < facts->n_tiles; i++)
        assert_true(facts->mask[(facts->tiles[i] >> 16) * (unsigned)facts->tiles_x + (facts->tiles[i] & 0xffffu)]);
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++) {
            const double z = *ssfr_field_at(depth, x, y);
            if (!ssfr_is_surface(z)) continue;
            if (!facts->mask[y / SSFR_TILE * facts->tiles_x + x / SSFR_TILE])
                fail_msg("camera %d: pixel %d,%d of %dx%d is outside the tiles", camera, x, y, depth->w, depth->h);
            if (-z < facts->nearest * (1 - 1e-6))
                fail_msg("camera %d: pixel %d,%d is at %g m, nearest is %g m", camera, x, y, -z, facts->nearest);
        }
}

static void tiles_hold_every_pixel_and_nearest_is_a_bound(void **state)
{
    ssfr_gl *gl = test_backend(state);
    const char *const scales[] = {"1", "3", "0.3"};
    uint64_t seed = 77;
    int n_covered = 0;
    test_scene s;
    ssfr_frame frame = {0};
    ssfr_graph *graph = NULL;
    test_scene_create_block(&s, (const int[3]){12, 8, 8}, (const double[3]){0, 0, 0}, 0.03);
    assert_int_equal(ssfr_graph_create_for_pass(&graph, ssfr_pass_find("sphere_depth"), gl), SSFR_OK);
    for (int camera = 0; camera < 200; camera++) {
        const char *scale = scales[camera / 4 % 3];
        look_somewhere(&s, &seed);
        test_graph_set(graph, (const char *[]){"sphere_depth.size=depth", NULL});
        test_graph_set(graph, splats[camera % 4]);
        assert_int_equal(ssfr_graph_set(graph, "sphere_depth.radius_scale", scale), SSFR_OK);
        ssfr_field *depth = test_graph_picture(graph, &s.scene, "fluid_depth", true);
        prepare(&frame, &s.scene, atof(scale), false);
        assert_facts_hold(&frame, depth, camera);
        for (int i = 0; i < depth->w * depth->h; i++) n_covered += ssfr_is_surface(depth->data[i]);
        ssfr_field_destroy(&depth);
    }
    assert_true(n_covered > 100000); /* the cameras did see something */
    ssfr_graph_destroy(&graph);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void stray_particles_do_not_cover_the_screen(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    const double strays[] = {-1.4, -0.8, -3, 1.4, 0.8, -3, -1.4, 0.8, -3};
    test_scene_create(&s, 3, strays, 0.02);
    test_scene_look(&s, (const double[3]){0, 0, 0}, (const double[3]){0, 0, -1}, 45, 1280, 720);
    prepare(&frame, &s.scene, 1, false);
    assert_int_equal(frame.facts.n_particles, 3);
    assert_true(frame.facts.covered < 0.05);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

/* ---- eye space --------------------------------------------------------------------------------------------------- */

/* The eye-space position of each id of the usual block, moved to `origin`. */
static void eye_positions(const double origin[3], double (*out)[3])
{
    test_scene s;
    ssfr_frame frame = {0};
    double eye[3], target[3];
    for (int k = 0; k < 3; k++) eye[k] = origin[k] + (double[3]){0.5, 0.75, 2}[k], target[k] = origin[k];
    test_scene_create_block(&s, (const int[3]){12, 10, 10}, origin, 0.03);
    test_scene_look(&s, eye, target, 45, 320, 200);
    prepare(&frame, &s.scene, 1, false);
    for (size_t i = 0; i < s.particles->n; i++) ssfr_frame_eye(&frame, i, out[(s.particles->id[i] - 3) / 7]);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void a_scene_far_from_the_origin_is_as_exact(void **state)
{
    (void)state;
    static double near[1200][3], far[1200][3];
    static const double origins[][3] = {{1e6, 0, 0}, {-1e6, 3e5, 1e6}, {1e6, 1e6, -1e6}};
    eye_positions((const double[3]){0, 0, 0}, near);
    for (size_t o = 0; o < SSFR_COUNT(origins); o++) {
        eye_positions(origins[o], far);
        for (int i = 0; i < 1200; i++) {
            const double distance = sqrt(ssfr_dot(near[i], near[i]));
            for (int k = 0; k < 3; k++) assert_close(far[i][k], near[i][k], 1e-6 * distance, 0);
        }
    }
}

static void eye_space_is_what_the_camera_says(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    test_scene_create_usual(&s, 64, 48);
    prepare(&frame, &s.scene, 1, false);
    for (size_t i = 0; i < s.particles->n; i++) {
        const ssfr_camera *c = &s.scene.camera;
        const double *axes[3] = {c->right, c->up, c->back};
        double world_at[3], eye[3];
        ssfr_particles_position(s.particles, i, world_at);
        ssfr_frame_eye(&frame, i, eye);
        for (int k = 0; k < 3; k++) world_at[k] -= c->eye[k];
        for (int k = 0; k < 3; k++) assert_close(eye[k], ssfr_dot(axes[k], world_at), 1e-14, 0);
    }
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void the_block_for_shaders_is_relative_to_the_eye(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    create_heap(&s, 1e6, 0, -3);
    s.scene.camera.eye[0] = 1e6, s.scene.camera.eye[1] = 2.385, s.scene.camera.eye[2] = -1e6;
    s.scene.floor = 0.5;
    s.solids[0].centre[0] = 1e6 + 1;
    prepare(&frame, &s.scene, 1, false);
    const ssfr_block *b = &frame.block;
    assert_true(b->image[0] == 320 && b->image[1] == 200);
    assert_close(b->image[2], 2 * tan(acos(-1) / 6) / 200, 0, 1e-14);
    assert_close(b->image[3], b->image[2], 0, 1e-14);
    assert_close(b->right[3], 0.5 - 2.385, 0, 1e-15);
    assert_true(fabs(b->up[3]) < 0.8 && fabs(b->back[3]) < 0.8); /* two tiles of 0.4 m */
    assert_close(b->solid[0][0][0], 1, 1e-9, 0);
    assert_close(b->solid[0][0][1], s.solids[0].centre[1] - 2.385, 0, 1e-15);
    s.scene.floor = -INFINITY;
    prepare(&frame, &s.scene, 1, false);
    assert_true(b->right[3] == -SSFR_EMPTY);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

/* ---- memory, the host's buffer, errors --------------------------------------------------------------------------- */

static void memory_grows_only_with_the_scene(void **state)
{
    (void)state;
    test_scene small, large;
    ssfr_frame frame = {0};
    long grew = 0;
    test_scene_create_usual(&small, 64, 48);
    test_scene_create_block(&large, (const int[3]){20, 10, 10}, (const double[3]){0, 0, 0}, 0.02);
    large.scene.camera = small.scene.camera;
    assert_int_equal(ssfr_frame_prepare(&frame, &small.scene, &world, 1, 0, &grew), SSFR_OK);
    assert_int_equal(grew, 2);
    assert_int_equal(ssfr_frame_prepare(&frame, &small.scene, &world, 1, SSFR_KEEP_ALL, &grew), SSFR_OK);
    assert_int_equal(grew, 2);
    assert_int_equal(ssfr_frame_prepare(&frame, &large.scene, &world, 1, 0, &grew), SSFR_OK);
    assert_int_equal(grew, 3);
    large.scene.camera.w = 65;
    assert_int_equal(ssfr_frame_prepare(&frame, &large.scene, &world, 1, 0, &grew), SSFR_OK);
    assert_int_equal(grew, 4);
    assert_int_equal(ssfr_frame_prepare(&frame, &small.scene, &world, 1, 0, &grew), SSFR_OK);
    assert_int_equal(grew, 4);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&small);
    test_scene_destroy(&large);
}

/* The solids that the rays of a tile's pixels enter. */
static void solids_in_tile(const ssfr_frame *frame, int tile, ssfr_solid_set out)
{
    static const double eye[3] = {0, 0, 0};
    const int x0 = tile % frame->facts.tiles_x * SSFR_TILE, y0 = tile / frame->facts.tiles_x * SSFR_TILE;
    memset(out, 0, sizeof(ssfr_solid_set));
    for (int y = y0; y < ssfr_min_int(y0 + SSFR_TILE, frame->h); y++)
        for (int x = x0; x < ssfr_min_int(x0 + SSFR_TILE, frame->w); x++) {
            double ray[3] = {0, 0, -1}, dir[3], normal[3];
            ssfr_slope_at(&frame->block, x + 0.5, y + 0.5, ray);
            ssfr_world_from_eye(&frame->block, ray, dir);
            for (int i = 0; i < frame->n_solids; i++)
                if (ssfr_solid_enter(&frame->solids[i], eye, dir, normal) > 0) out[i / 32] |= 1u << i % 32;
        }
}

/* Each tile stands in the list once, behind those of lesser kinds. */
static void assert_sorted_by_solids(const ssfr_frame *frame)
{
    const ssfr_facts *f = &frame->facts;
    unsigned char *seen = calloc((size_t)(f->tiles_x * f->tiles_y), 1);
    int at = 0;
    assert_non_null(seen);
    for (int kind = 0; kind < SSFR_N_TILE_KINDS; kind++)
        for (int i = 0; i < f->n_by_solids[kind]; i++, at++) {
            const int tile = (int)(f->by_solids[at] >> 16) * f->tiles_x + (int)(f->by_solids[at] & 0xffff);
            const bool mesh = f->solids[tile][0] >> 6 & 1; /* test_scene_add_shapes puts it there */
            assert_int_equal(kind, mesh ? SSFR_TILE_MESHES : f->solids[tile][0] ? SSFR_TILE_SOLIDS : SSFR_TILE_PLAIN);
            assert_int_equal(seen[tile]++, 0);
        }
    assert_int_equal(at, f->tiles_x * f->tiles_y);
    free(seen);
}

static void tiles_know_what_solids_they_may_show(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    test_scene_create_usual(&s, 150, 100);
    test_scene_add_shapes(&s);
    for (int round = 0; round < 3; round++) { /* with a plane, without one, and leaving nothing out */
        if (round == 1) s.solids[5] = s.solids[0];
        prepare(&frame, &s.scene, 3, round == 2);
        assert_sorted_by_solids(&frame);
        const ssfr_facts *f = &frame.facts;
        for (int tile = 0; tile < f->tiles_x * f->tiles_y; tile++) {
            ssfr_solid_set shown;
            solids_in_tile(&frame, tile, shown);
            assert_int_equal(shown[0] & ~f->solids[tile][0], 0);
            assert_int_equal(f->solids[tile][1], 0);
            if (round == 0) assert_true(f->solids[tile][0] >> 5 & 1);
            if (round == 2) assert_int_equal(f->solids[tile][0], 127);
        }
        assert_true(round == 1 ? f->n_by_solids[SSFR_TILE_PLAIN] > 2 : f->n_by_solids[SSFR_TILE_PLAIN] == 0);
        assert_true(round == 2 || (f->n_by_solids[SSFR_TILE_SOLIDS] > 3 && f->n_by_solids[SSFR_TILE_MESHES] > 0));
    }
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void of_a_hosts_buffer_nothing_is_known(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    long grew = 0;
    const double origin[3] = {1e6, 2, 3};
    create_heap(&s, 0, 0, 3);
    s.scene.particles = NULL;
    assert_int_equal(ssfr_frame_prepare_host(&frame, &s.scene, &world, 600, origin, 0.02, 0, &grew), SSFR_OK);
    assert_int_equal(frame.n_packets, (600 + SSFR_PACKET - 1) / SSFR_PACKET);
    assert_int_equal(frame.facts.n_particles, 600);
    assert_int_equal(frame.facts.n_ranges, 1);
    assert_int_equal(frame.facts.count[0], 600);
    assert_int_equal(frame.facts.n_tiles, 10 * 7);
    assert_true(frame.facts.nearest == s.scene.camera.near);
    for (size_t i = 0; i < frame.n_packets; i++) assert_close(frame.offset[i][0], 1e6, 0, 1e-15);
    assert_int_equal(ssfr_frame_prepare_host(&frame, &s.scene, &world, 0, origin, 0.02, 0, &grew), SSFR_OK);
    assert_int_equal(frame.facts.n_ranges, 0);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void samples_of_the_host_tell_its_mean_distance(void **state)
{
    (void)state;
    /* Relative to an origin 1 m to the right: two in view at 2 and 5 m, one beside, one behind. */
    static const float positions[4][3] = {{-1, 0, -2}, {-1, 0.5f, -5}, {5, 0, -2}, {-1, 0, 7}};
    const double origin[3] = {1, 0, 0};
    test_scene s;
    ssfr_frame frame = {0};
    long grew = 0;
    create_heap(&s, 0, 0, 3);
    s.scene.particles = NULL;
    assert_int_equal(ssfr_frame_prepare_host(&frame, &s.scene, &world, 600, origin, 0.02, 0, &grew), SSFR_OK);
    ssfr_frame_sample_host(&frame, 4, positions);
    assert_close(frame.facts.mean, 3.5, 0, 1e-14);
    ssfr_frame_sample_host(&frame, 2, &positions[2]);
    assert_true(frame.facts.mean == s.scene.camera.near);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void fluid_that_is_given_may_be_anywhere(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    create_heap(&s, 0, 0, 3);
    prepare(&frame, &s.scene, 1, false);
    assert_false(frame.facts.fluid);
    assert_true(frame.facts.mean == s.scene.camera.near);
    ssfr_frame_assume_fluid(&frame, 2.385, 4, 5);
    ssfr_frame_assume_fluid(&frame, 1, 1, 1);
    assert_true(frame.facts.fluid && frame.facts.nearest == 2.385 && frame.facts.mean == 4);
    assert_int_equal(frame.facts.n_tiles, 10 * 7);
    assert_true(frame.facts.covered == 1);
    assert_int_equal(frame.facts.n_particles, 0);
    prepare(&frame, &s.scene, 1, false);
    ssfr_frame_assume_fluid(&frame, 0, 0, 0);
    assert_true(frame.facts.nearest == s.scene.camera.near && frame.facts.mean == s.scene.camera.near);
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

/* ---- the light --------------------------------------------------------------------------------------------------- */

/* How far the particles' spheres reach beyond the fluid's bounds along the light's axes, m. */
static double beyond(const ssfr_frame *frame, double radius)
{
    const ssfr_facts *f = &frame->facts;
    double most = -INFINITY;
    for (size_t i = 0; i < frame->n_particles; i++) {
        double eye[3], world_at[3];
        ssfr_frame_eye(frame, i, eye);
        for (int k = 0; k < 3; k++)
            world_at[k] = eye[0] * frame->rotation[0][k] + eye[1] * frame->rotation[1][k] +
                          eye[2] * frame->rotation[2][k];
        for (int k = 0; k < 3; k++) {
            const double at = ssfr_dot(frame->light_axis[k], world_at);
            most = fmax(most, fmax(at + radius - f->lit_hi[k], f->lit_lo[k] - at + radius));
        }
    }
    return most;
}

static void the_lights_bounds_hold_the_fluid_in_view(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0}, all = {0};
    create_heap(&s, 0.1, 0.3, -3);
    test_scene_look(&s, (const double[3]){0.2, 1, 0}, (const double[3]){0, 0, -3}, 60, 320, 200);
    prepare(&frame, &s.scene, 2.5, false);
    assert_true(beyond(&frame, 2.5 * 0.02) < 1e-9);
    for (int k = 0; k < 3; k++) /* the heap's box is 0.4 m wide, seen from a corner sqrt(3) times that */
        assert_true(frame.facts.lit_hi[k] - frame.facts.lit_lo[k] < sqrt(3) * 0.4 + 2 * SSFR_SUPPORT * 0.02);
    ssfr_frame_assume_fluid(&frame, 1, 9, 9); /* the particles say where it is */
    prepare(&all, &s.scene, 2.5, true);
    assert_memory_equal(all.facts.lit_lo, frame.facts.lit_lo, sizeof all.facts.lit_lo);
    assert_memory_equal(all.facts.lit_hi, frame.facts.lit_hi, sizeof all.facts.lit_hi);
    s.scene.n_solids = 0;
    prepare(&frame, &s.scene, 2.5, false);
    assert_true(frame.facts.lit_lo[0] > frame.facts.lit_hi[0]);
    ssfr_frame_finish(&frame), ssfr_frame_finish(&all);
    test_scene_destroy(&s);
}

static void fluid_out_of_view_is_not_in_the_lights_bounds(void **state)
{
    (void)state;
    test_scene s;
    ssfr_frame frame = {0};
    create_heap(&s, 0, 0, 3);
    prepare(&frame, &s.scene, 1, true);
    assert_true(frame.facts.lit_lo[0] > frame.facts.lit_hi[0]);
    ssfr_frame_assume_fluid(&frame, 2, 2, 2); /* then it is where the view is */
    const double x = 2 * s.scene.camera.tan_x, y = 2 * s.scene.camera.tan_y;
    for (int k = 0; k < 3; k++) {
        const double *axis = frame.light_axis[k], half = fabs(axis[0]) * x + fabs(axis[1]) * y;
        assert_close(frame.facts.lit_lo[k], -2 * axis[2] - half, 1e-12, 0);
        assert_close(frame.facts.lit_hi[k], -2 * axis[2] + half, 1e-12, 0);
    }
    ssfr_frame_finish(&frame);
    test_scene_destroy(&s);
}

static void scene_fails(const ssfr_scene *scene, const char *text)
{
    ssfr_frame frame = {0};
    long grew = 0;
    assert_fails(SSFR_ERR_VALUE, ssfr_frame_prepare(&frame, scene, &world, 1, 0, &grew), text);
    assert_int_equal(grew, 0);
    ssfr_frame_finish(&frame);
}

static void cameras_without_an_image_are_refused(void **state)
{
    (void)state;
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    const ssfr_camera good = s.scene.camera;
    ssfr_camera *c = &s.scene.camera;
#define BAD(change, text) *c = good, change, scene_fails(&s.scene, text)
    BAD(c->w = 0, "image of 0 x 48 pixels");
    BAD(c->h = SSFR_MAX_SIZE + 1, "image of 64 x 16385 pixels");
    BAD(c->tan_x = 0, "half widths at unit distance are 0 and");
    BAD(c->tan_y = (double)NAN, "half widths at unit distance");
    BAD(c->tan_y = INFINITY, "half widths at unit distance");
    BAD(c->near = 0, "camera: near 0 and far 1000");
    BAD(c->near = -2.385, "camera: near -2.385");
    BAD(c->near = (double)NAN, "0 < near < far is needed");
    BAD(c->far = c->near, "camera: near 0.01 and far 0.01");
    BAD(c->far = (double)NAN, "0 < near < far is needed");
    BAD(c->eye[1] = (double)NAN, "camera: eye");
    BAD(c->eye[2] = -INFINITY, "camera: eye");
    BAD(c->up[1] = 0, "camera: right, up and back");
    BAD(c->right[0] *= 2, "camera: right, up and back");
    BAD(c->back[2] = (double)NAN, "camera: right, up and back");
    BAD(memcpy(c->up, c->right, sizeof c->up), "camera: right, up and back");
#undef BAD
    test_scene_destroy(&s);
}

static void solids_and_particles_out_of_range_are_refused(void **state)
{
    (void)state;
    test_scene s;
    test_scene_create_usual(&s, 64, 48);
    s.scene.n_solids = SSFR_MAX_SOLIDS + 1;
    scene_fails(&s.scene, "65 solids, at most 64");
    s.scene.n_solids = -1;
    scene_fails(&s.scene, "-1 solids");
    s.scene.n_solids = 2;
    s.solids[1].half[2] = 0;
    scene_fails(&s.scene, "solid 1 (from 0): half extents");
    s.solids[1].half[2] = 0.1, s.solids[1].centre[0] = (double)NAN;
    scene_fails(&s.scene, "solid 1 (from 0)");
    s.solids[1].centre[0] = 0, s.solids[1].axis[1][1] = 2.385;
    scene_fails(&s.scene, "solid 1 (from 0): its axes");
    s.scene.n_solids = 1;
    s.particles->radius = 0;
    scene_fails(&s.scene, "particle radius 0 m");
    s.particles->radius = INFINITY;
    scene_fails(&s.scene, "particle radius inf m");
    s.scene.particles = &(ssfr_particles){.n = INT32_MAX / 8 + 1, .radius = 0.02};
    scene_fails(&s.scene, "268435456 particles, at most 268435455");
    s.scene.particles = s.particles;
    s.particles->radius = 0.02;
    s.scene.floor = (double)NAN;
    scene_fails(&s.scene, "floor at nan m");
    test_scene_destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(particles_out_of_view_are_culled),
        cmocka_unit_test(what_is_before_the_near_plane_is_culled),
        cmocka_unit_test(a_wider_reach_brings_particles_into_view),
        cmocka_unit_test(a_sphere_that_reaches_into_view_counts_in_the_mean),
        cmocka_unit_test(no_particles_make_no_facts),
        cmocka_unit_test(the_mean_distance_weighs_packets_by_particles),
        cmocka_unit_test(neighbouring_packets_make_one_range),
        ON_BOTH(tiles_hold_every_pixel_and_nearest_is_a_bound),
        cmocka_unit_test(stray_particles_do_not_cover_the_screen),
        cmocka_unit_test(a_scene_far_from_the_origin_is_as_exact),
        cmocka_unit_test(eye_space_is_what_the_camera_says),
        cmocka_unit_test(the_block_for_shaders_is_relative_to_the_eye),
        cmocka_unit_test(memory_grows_only_with_the_scene),
        cmocka_unit_test(tiles_know_what_solids_they_may_show),
        cmocka_unit_test(of_a_hosts_buffer_nothing_is_known),
        cmocka_unit_test(samples_of_the_host_tell_its_mean_distance),
        cmocka_unit_test(fluid_that_is_given_may_be_anywhere),
        cmocka_unit_test(the_lights_bounds_hold_the_fluid_in_view),
        cmocka_unit_test(fluid_out_of_view_is_not_in_the_lights_bounds),
        cmocka_unit_test(cameras_without_an_image_are_refused),
        cmocka_unit_test(solids_and_particles_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, test_shared_gl_destroy);
}

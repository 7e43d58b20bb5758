/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_stage.c: scenes by name and by file, and the view that frames them. */
#include "tests/util.h"

#include "experiments/stage.h"

static ssfr_stage_options defaults(void)
{
    ssfr_stage_options options;
    ssfr_stage_defaults(&options);
    return options;
}

static ssfr_stage *make(const char *scene, const ssfr_stage_options *options)
{
    ssfr_stage *stage = NULL;
    assert_int_equal(ssfr_stage_create(&stage, scene, options), SSFR_OK);
    assert_non_null(stage);
    return stage;
}

/* The largest |x| or |y| of the corners of the particles' bounds in the image, 1 at its edge. */
static double widest_corner(const ssfr_stage *stage)
{
    const ssfr_camera *camera = &stage->scene.camera;
    double lo[3], hi[3], widest = 0;
    ssfr_stage_view_box(stage, lo, hi);
    for (int i = 0; i < 8; i++) {
        double p[3];
        for (int k = 0; k < 3; k++) p[k] = (i >> k & 1 ? hi[k] : lo[k]) - camera->eye[k];
        const double depth = -ssfr_dot(camera->back, p);
        assert_true(depth > camera->near && depth < camera->far);
        widest = fmax(widest, fabs(ssfr_dot(camera->right, p)) / (depth * camera->tan_x));
        widest = fmax(widest, fabs(ssfr_dot(camera->up, p)) / (depth * camera->tan_y));
    }
    return widest;
}

static void every_built_in_scene_fills_every_image_up_to_the_margin(void **state)
{
    (void)state;
    static const int sizes[][2] = {{1280, 720}, {333, 1024}, {64, 64}, {2000, 50}};
    for (int i = 0; ssfr_builtin_at(i); i++) {
        ssfr_stage_options options = defaults();
        ssfr_stage *stage = make(ssfr_builtin_at(i)->name, &options);
        for (size_t k = 0; k < SSFR_COUNT(sizes) && stage->particles->n; k++) {
            memcpy(options.size, sizes[k], sizeof sizes[k]);
            options.fov_deg = 23.85 + 20 * (double)k;
            assert_int_equal(ssfr_stage_aim(stage, &options), SSFR_OK);
            assert_close(widest_corner(stage), 0.95, 1e-7, 0); /* positions a million metres away have 1e-10 m */
            assert_int_equal(stage->scene.camera.w, sizes[k][0]);
            assert_int_equal(stage->scene.camera.h, sizes[k][1]);
        }
        ssfr_stage_destroy(&stage);
        assert_null(stage);
    }
}

static const char *write_pos(const char *name, uint32_t n, float radius, const float *xyz)
{
    char bytes[256];
    const char *path = test_path(name);
    memcpy(bytes, &n, 4);
    memcpy(bytes + 4, &radius, 4);
    memcpy(bytes + 8, xyz, 12 * (size_t)n);
    test_write_file(path, bytes, 8 + 12 * (size_t)n);
    return path;
}

static void a_file_is_seen_from_its_long_side_slightly_above(void **state)
{
    (void)state;
    const float along_x[] = {-2, 1, 0, 3, 1.5f, 0.25f}, along_z[] = {0, 1, -2, 0.25f, 1.5f, 3};
    const ssfr_stage_options options = defaults();
    ssfr_stage *stage = make(write_pos("x.pos", 2, 0.125f, along_x), &options);
    assert_close(stage->scene.camera.back[0], 0, 1e-12, 0);
    assert_close(stage->scene.camera.back[1], sin(25 * acos(-1) / 180), 1e-12, 0);
    assert_true(stage->scene.camera.back[2] > 0);
    assert_close(widest_corner(stage), 0.95, 1e-12, 0);
    assert_close(stage->scene.floor, 0.875, 1e-12, 0);
    ssfr_stage_destroy(&stage);
    stage = make(write_pos("z.pos", 2, 0.125f, along_z), &options);
    assert_true(stage->scene.camera.back[0] > 0);
    assert_close(stage->scene.camera.back[2], 0, 1e-12, 0);
    assert_close(widest_corner(stage), 0.95, 1e-12, 0);
    ssfr_stage_destroy(&stage);
}

static void the_users_camera_is_taken_as_it_is(void **state)
{
    (void)state;
    ssfr_stage_options options = defaults();
    const double eye[3] = {2.385, 1.5, -4}, target[3] = {0.25, 0.125, 0};
    memcpy(options.eye, eye, sizeof eye);
    memcpy(options.target, target, sizeof target);
    options.fov_deg = 60;
    ssfr_stage *stage = make("block", &options);
    const ssfr_camera *camera = &stage->scene.camera;
    for (int k = 0; k < 3; k++) assert_close(camera->eye[k], eye[k], 0, 0);
    double back[3] = {eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]};
    ssfr_normalize(back);
    for (int k = 0; k < 3; k++) assert_close(camera->back[k], back[k], 1e-14, 0);
    assert_close(camera->tan_y, tan(acos(-1) / 6), 1e-14, 0);
    assert_close(camera->tan_x, camera->tan_y * 1280 / 720, 1e-14, 0);
    assert_false(stage->scene.timed); /* one picture */
    ssfr_stage_destroy(&stage);
}

static void a_target_alone_moves_the_framed_view(void **state)
{
    (void)state;
    ssfr_stage_options options = defaults();
    const double target[3] = {0.1, 0.2, -0.1};
    memcpy(options.target, target, sizeof target);
    ssfr_stage *stage = make("block", &options);
    const ssfr_camera *camera = &stage->scene.camera;
    double to[3];
    for (int k = 0; k < 3; k++) to[k] = target[k] - camera->eye[k];
    assert_close(ssfr_dot(to, camera->right), 0, 1e-14, 0);
    assert_close(ssfr_dot(to, camera->up), 0, 1e-14, 0);
    assert_close(widest_corner(stage), 0.95, 1e-12, 0);
    ssfr_stage_destroy(&stage);
}

static void straight_down_has_an_up_of_its_own(void **state)
{
    (void)state;
    ssfr_stage_options options = defaults();
    const double eye[3] = {0, 5, 0}, zero[3] = {0, 0, 0};
    memcpy(options.eye, eye, sizeof eye);
    memcpy(options.target, zero, sizeof zero);
    ssfr_stage *stage = make("sphere", &options);
    assert_close(stage->scene.camera.up[2], -1, 1e-14, 0);
    assert_close(stage->scene.camera.near, (5 - 0.5 - 1) / 1.01, 1e-12, 0);
    ssfr_stage_destroy(&stage);
}

static void an_eye_inside_the_particles_keeps_a_valid_range(void **state)
{
    (void)state;
    ssfr_stage_options options = defaults();
    const double inside[3] = {0.01, 0, 0}, ahead[3] = {0, 0, -1};
    memcpy(options.eye, inside, sizeof inside);
    memcpy(options.target, ahead, sizeof ahead);
    ssfr_stage *stage = make("block", &options);
    assert_true(stage->scene.camera.near > 0 && stage->scene.camera.near < stage->scene.camera.far);
    options.eye[2] = -50, options.target[2] = -51; /* all behind the eye */
    assert_int_equal(ssfr_stage_aim(stage, &options), SSFR_OK);
    assert_true(stage->scene.camera.near > 0 && stage->scene.camera.near < stage->scene.camera.far);
    ssfr_stage_destroy(&stage);
}

static void an_eye_at_its_target_is_refused(void **state)
{
    (void)state;
    ssfr_stage_options options = defaults();
    ssfr_stage *stage = NULL;
    for (int k = 0; k < 3; k++) options.eye[k] = options.target[k] = 2.385;
    test_clear_log();
    assert_int_equal(ssfr_stage_create(&stage, "block", &options), SSFR_ERR_VALUE);
    assert_int_equal(test_n_errors(), 1);
    assert_null(stage);
}

static void the_block_is_the_same_for_the_same_seed_only(void **state)
{
    (void)state;
    ssfr_stage_options options = defaults();
    ssfr_stage *a = make("block", &options), *b = make("block", &options);
    options.seed = 2385;
    ssfr_stage *c = make("block", &options);
    const size_t size = 3 * a->particles->n * sizeof *a->particles->position;
    assert_int_equal(a->particles->n, 8000);
    assert_memory_equal(a->particles->position, b->particles->position, size);
    assert_int_not_equal(memcmp(a->particles->position, c->particles->position, size), 0);
    ssfr_stage_destroy(&a), ssfr_stage_destroy(&b), ssfr_stage_destroy(&c);
}

static void the_far_block_is_the_block_moved(void **state)
{
    (void)state;
    const ssfr_stage_options options = defaults();
    ssfr_stage *near = make("block", &options), *far = make("far", &options);
    assert_int_equal(far->particles->n, near->particles->n);
    for (int k = 0; k < 3; k++)
        assert_close(far->scene.camera.eye[k] - 1e6, near->scene.camera.eye[k], 1e-8, 0);
    double lo[3], hi[3];
    ssfr_stage_bounds(far, lo, hi);
    assert_close(far->scene.floor, lo[1], 0, 0);
    assert_close(hi[0] - lo[0], 0.8, 0.03, 0); /* 19 spacings of 0.04, jitter 0.02 at most, two radii of 0.02 */
    ssfr_stage_destroy(&near), ssfr_stage_destroy(&far);
}

static void the_splash_stands_on_its_floor(void **state)
{
    (void)state;
    const ssfr_stage_options options = defaults();
    ssfr_stage *stage = make("splash", &options);
    double lo[3], hi[3];
    ssfr_stage_bounds(stage, lo, hi);
    assert_true(stage->particles->n > 1000);
    assert_close(stage->particles->radius, 0.02, 0, 1e-6);
    assert_true(lo[1] >= stage->scene.floor && lo[1] < stage->scene.floor + 0.05);
    assert_non_null(stage->particles->velocity);
    ssfr_stage_destroy(&stage);
}

static void an_empty_scene_has_a_default_view(void **state)
{
    (void)state;
    const ssfr_stage_options options = defaults();
    ssfr_stage *stage = make("empty", &options);
    assert_int_equal(stage->particles->n, 0);
    assert_true(isfinite(stage->scene.camera.eye[2]) && stage->scene.camera.eye[2] > 0);
    assert_true(stage->scene.camera.near > 0 && stage->scene.camera.near < stage->scene.camera.far);
    assert_close(stage->scene.floor, 0, 0, 0);
    ssfr_stage_destroy(&stage);
}

static void a_given_radius_replaces_the_scenes_own(void **state)
{
    (void)state;
    const float two[] = {0, 0, 0, 1, 0, 0};
    ssfr_stage_options options = defaults();
    options.radius = 0.2385;
    ssfr_stage *stage = make("plane", &options);
    assert_close(stage->particles->radius, 0.2385, 0, 0);
    ssfr_stage_destroy(&stage);
    stage = make(write_pos("two.pos", 2, 0.5f, two), &options);
    assert_close(stage->particles->radius, 0.2385, 0, 0);
    ssfr_stage_destroy(&stage);
}

static void nonfinite_particles_are_refused_or_dropped(void **state)
{
    (void)state;
    const float xyz[] = {0, 0, 0, NAN, 0, 0, 1, 0, 0};
    const char *path = write_pos("nan.pos", 3, 0.5f, xyz);
    ssfr_stage_options options = defaults();
    ssfr_stage *stage = NULL;
    assert_fails(SSFR_ERR_VALUE, ssfr_stage_create(&stage, path, &options), "nan.pos");
    assert_null(stage);
    options.drop_nonfinite = true;
    stage = make(path, &options);
    assert_int_equal(stage->n_dropped, 1);
    assert_int_equal(stage->particles->n, 2);
    ssfr_stage_destroy(&stage);
}

static void cameras_of_built_in_scenes_are_taken_by_name(void **state)
{
    (void)state;
    ssfr_stage_options options = defaults();
    options.camera = "along";
    ssfr_stage *stage = make("horizon", &options);
    const ssfr_camera *camera = &stage->scene.camera;
    assert_close(ssfr_dot(camera->eye, camera->eye), 0, 0, 0);
    assert_close(camera->back[2], 1, 1e-12, 0);
    assert_true(camera->near < 0.75 && camera->far > 1e5); /* the first spheres begin at 0.75 m */
    ssfr_stage_destroy(&stage);
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_stage_create(&stage, "splash", &options),
                 "splash: no camera along: there are close, grazing, away, aside");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_stage_create(&stage, "block", &options),
                 "--camera along: block has no cameras");
}

static void a_name_that_is_nothing_is_refused_with_the_names_there_are(void **state)
{
    (void)state;
    const ssfr_stage_options options = defaults();
    ssfr_stage *stage = NULL;
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_stage_create(&stage, "dam_braek", &options),
                 "dam_braek: no such file, and not a built-in scene (splash, sphere, plane, block, "
                 "far, empty");
    assert_null(stage);
}

/* ---- scenes of many frames --------------------------------------------------------------------------------------- */

static const char walls[] =
    "title: A drop beside a wall that moves\n"
    "radius: 0.05\nparticles: 100\nduration: 0.1\nframe_rate: 20\n"
    "domain: {lo: [-1, 0, -1], hi: [1, 1, 1]}\n"
    "motions: {push: {easing: linear, keys: [{time: 0}, {time: 0.1, move: [0.2, 0, 0]}]}}\n"
    "solids:\n"
    "  wall: {shape: box, centre: [-0.9, 0.5, 0], size: [0.1, 1, 1], motion: push}\n"
    "  unseen: {shape: sphere, centre: [0.5, 0.5, 0.5], radius: 0.1, hidden: true}\n"
    "fluid: {drop: {lo: [0, 0, 0], hi: [0.3, 0.3, 0.3]}}\n"
    "cameras:\n"
    "  still: {eye: [0, 1, 3], target: [0, 0.25, 0], fov_deg: 30}\n"
    "  path: {target: [0, 0, 0], keys: [{time: 0, eye: [0, 1, 3]}, {time: 0.1, eye: [1, 1, 3]}]}\n"
    "floor_height: -0.125\n";

static const char *scene_file(void)
{
    const char *path = test_path("walls.yaml");
    test_write_file(path, walls, sizeof walls - 1);
    return path;
}

/* The options of the scene above, whose three frames are made once for all tests. */
static ssfr_stage_options scene_options(void)
{
    static const char *cache;
    ssfr_stage_options options = defaults();
    if (!cache) cache = test_path("frames");
    options.cache = cache;
    options.scale = SSFR_SCALE_FULL;
    return options;
}

static int remove_frames(void **state)
{
    (void)state;
    const ssfr_stage_options options = scene_options();
    char command[256];
    snprintf(command, sizeof command, "rm -rf '%s'", options.cache);
    return system(command);
}

static void a_frame_has_its_particles_solids_and_time(void **state)
{
    (void)state;
    ssfr_stage_options options = scene_options();
    options.frame = 1;
    ssfr_stage *stage = make(scene_file(), &options);
    assert_int_equal(stage->n_frames, 3);
    assert_int_equal(stage->frame, 1);
    assert_close(stage->time, 0.05, 1e-15, 0);
    assert_int_equal(stage->particles->n, 27);
    assert_null(stage->foam);
    assert_int_equal(stage->scene.n_solids, 1); /* the other is hidden */
    assert_close(stage->solids[0].centre[0], -0.8, 1e-12, 0);
    assert_close(stage->scene.floor, -0.125, 0, 0);
    assert_int_equal(ssfr_stage_show(stage, &options, 2), SSFR_OK);
    assert_close(stage->solids[0].centre[0], -0.7, 1e-12, 0);
    assert_close(stage->time, 0.1, 1e-15, 0);
    assert_true(stage->scene.timed && stage->scene.time == stage->time);
    ssfr_stage_destroy(&stage);
}

static void the_default_frame_is_two_thirds_of_the_way(void **state)
{
    (void)state;
    const ssfr_stage_options options = scene_options();
    ssfr_stage *stage = make(scene_file(), &options);
    assert_int_equal(stage->frame, 2);
    ssfr_stage_destroy(&stage);
}

static void a_time_is_the_nearest_frame(void **state)
{
    (void)state;
    ssfr_stage_options options = scene_options();
    ssfr_stage *stage = NULL;
    options.time = 0.07;
    stage = make(scene_file(), &options);
    assert_int_equal(stage->frame, 1);
    ssfr_stage_destroy(&stage);
    options.time = 0.13;
    assert_fails(SSFR_ERR_VALUE, ssfr_stage_create(&stage, scene_file(), &options), "no frame 3: they go from 0 to 2");
    options.frame = 1;
    assert_fails(SSFR_ERR_VALUE, ssfr_stage_create(&stage, scene_file(), &options), "--frame and --time both");
    options.frame = -1;
    assert_fails(SSFR_ERR_VALUE, ssfr_stage_create(&stage, "block", &options), "block: has no frames");
    assert_null(stage);
}

static void a_scenes_camera_is_that_of_its_time(void **state)
{
    (void)state;
    ssfr_stage_options options = scene_options();
    options.frame = 1;
    ssfr_stage *stage = make(scene_file(), &options);
    assert_close(stage->scene.camera.eye[2], 3, 0, 0);
    assert_close(stage->scene.camera.tan_y, tan(15 * acos(-1) / 180), 1e-14, 0);
    options.camera = "path";
    assert_int_equal(ssfr_stage_aim(stage, &options), SSFR_OK);
    assert_close(stage->scene.camera.eye[0], 0.5, 1e-12, 0); /* half way on a straight line */
    assert_int_equal(ssfr_stage_show(stage, &options, 2), SSFR_OK);
    assert_close(stage->scene.camera.eye[0], 1, 1e-12, 0);
    options.fov_deg = 60;
    options.eye[0] = 2.385, options.eye[1] = 1, options.eye[2] = 1;
    assert_int_equal(ssfr_stage_aim(stage, &options), SSFR_OK); /* what the user says, and the rest of the scene's */
    assert_close(stage->scene.camera.eye[0], 2.385, 0, 0);
    assert_close(stage->scene.camera.back[0] / stage->scene.camera.back[2], 2.385, 0, 1e-12);
    assert_close(stage->scene.camera.tan_y, tan(30 * acos(-1) / 180), 1e-14, 0);
    options.camera = "top";
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_stage_aim(stage, &options), "top");
    ssfr_stage_destroy(&stage);
    options.frame = -1;
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_stage_create(&stage, "block", &options), "--camera top: block has no cameras");
}

static void a_sequence_is_seen_from_one_place(void **state)
{
    (void)state;
    static const float places[3][6] = {{0, 0, 0, 1, 0, 0}, {0, -0.5f, 0, 2, 0, 0}, {0.25f, 0, 0, 5, 1, 0}};
    const ssfr_frame_range all = ssfr_frame_range_all;
    const ssfr_stage_options options = defaults();
    ssfr_stage *stage = NULL;
    long *frames = NULL;
    size_t n = 0;
    for (int i = 0; i < 3; i++) {
        char name[16];
        snprintf(name, sizeof name, "seq_%d.pos", 5 + 2 * i);
        write_pos(name, 2, 0.125f, places[i]);
    }
    assert_int_equal(ssfr_stage_open(&stage, test_path("seq_%d.pos"), &options), SSFR_OK);
    assert_int_equal(ssfr_stage_choose(stage, &all, &n, &frames), SSFR_OK);
    assert_int_equal(n, 3);
    assert_int_equal(frames[2], 9);
    assert_int_equal(ssfr_stage_show(stage, &options, -1), SSFR_OK);
    assert_int_equal(stage->frame, 9); /* two thirds of the way */
    assert_int_equal(ssfr_stage_show(stage, &options, 5), SSFR_OK);
    const ssfr_camera first = stage->scene.camera;
    assert_int_equal(ssfr_stage_hold(stage, &options, n, frames), SSFR_OK);
    for (size_t i = 0; i < n; i++) {
        double lo[3], hi[3];
        assert_int_equal(ssfr_stage_show(stage, &options, frames[i]), SSFR_OK);
        ssfr_stage_view_box(stage, lo, hi);
        assert_close(lo[0], -0.125, 0, 0), assert_close(hi[0], 5.125, 0, 0);
        assert_close(lo[1], -0.625, 0, 0), assert_close(hi[1], 1.125, 0, 0);
        assert_close(stage->scene.floor, -0.625, 0, 0);
        assert_close(stage->scene.camera.eye[0], 2.5, 1e-12, 0);
        assert_close(widest_corner(stage), 0.95, 1e-12, 0);
        assert_true(stage->scene.camera.eye[2] > 2 * first.eye[2]);
    }
    free(frames);
    ssfr_stage_destroy(&stage);
}

static void a_file_may_have_its_own_unit_and_axes(void **state)
{
    (void)state;
    const float xyz[] = {100, 200, 300, 150, 200, 350};
    ssfr_stage_options options = defaults();
    options.unit = 0.01;
    options.up_axis = 2;
    double lo[3], hi[3];
    ssfr_stage *stage = make(write_pos("cm.pos", 2, 5, xyz), &options);
    ssfr_stage_bounds(stage, lo, hi);
    assert_close(stage->particles->radius, 0.05, 0, 1e-6);
    assert_close(lo[1], 2.95, 0, 1e-6);
    assert_close(hi[1], 3.55, 0, 1e-6);
    ssfr_stage_destroy(&stage);
}

static void frames_that_cannot_be_made_are_an_error(void **state)
{
    (void)state;
    ssfr_stage_options options = scene_options();
    ssfr_stage *stage = NULL;
    char inner[200];
    snprintf(inner, sizeof inner, "%s/x", scene_file());
    options.cache = inner; /* in a file */
    assert_fails(SSFR_ERR_IO, ssfr_stage_create(&stage, scene_file(), &options), "the folder cannot be made");
    assert_null(stage);
}

static void scenes_inside_the_program_are_found_by_their_last_part(void **state)
{
    (void)state;
    ssfr_scene_source s;
    int n = 0;
    for (; ssfr_scene_at(n, &s); n++) {
        ssfr_scene_source found;
        assert_int_equal(ssfr_scene_find(s.name, &found), SSFR_OK);
        assert_int_equal(found.kind, SSFR_SCENE_DESCRIBED);
        assert_string_equal(found.name, s.name);
        assert_ptr_equal(found.embedded, s.embedded);
    }
    assert_true(n >= 10);
    assert_int_equal(ssfr_scene_find("waterfall", &s), SSFR_OK);
    assert_string_equal(s.name, "bagar2010/waterfall");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_scene_find("wave", &s), "wave: there are akinci2013/wave and imai2016/wave");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_scene_find("fall", &s), "fall: no such file");
    assert_fails(SSFR_ERR_VALUE, ssfr_scene_find("a%d_%d.ply", &s), "a%d_%d.ply: expected one number");
}

static void every_scene_inside_the_program_is_sound_at_both_scales(void **state)
{
    (void)state;
    ssfr_scene_source s;
    for (int i = 0; ssfr_scene_at(i, &s); i++) {
        ssfr_description *quick = NULL, *full = NULL;
        assert_int_equal(ssfr_scene_describe(&s, SSFR_SCALE_QUICK, &quick), SSFR_OK);
        assert_int_equal(ssfr_scene_describe(&s, SSFR_SCALE_FULL, &full), SSFR_OK);
        assert_int_equal(quick->n_frames, full->n_frames);
        assert_close((double)full->solver.max_particles / (double)quick->solver.max_particles, 16, 0, 0.01);
        assert_true(quick->n_views > 0);
        ssfr_description_destroy(&quick);
        ssfr_description_destroy(&full);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_built_in_scene_fills_every_image_up_to_the_margin),
        cmocka_unit_test(a_file_is_seen_from_its_long_side_slightly_above),
        cmocka_unit_test(the_users_camera_is_taken_as_it_is),
        cmocka_unit_test(a_target_alone_moves_the_framed_view),
        cmocka_unit_test(straight_down_has_an_up_of_its_own),
        cmocka_unit_test(an_eye_inside_the_particles_keeps_a_valid_range),
        cmocka_unit_test(an_eye_at_its_target_is_refused),
        cmocka_unit_test(the_block_is_the_same_for_the_same_seed_only),
        cmocka_unit_test(the_far_block_is_the_block_moved),
        cmocka_unit_test(the_splash_stands_on_its_floor),
        cmocka_unit_test(an_empty_scene_has_a_default_view),
        cmocka_unit_test(a_given_radius_replaces_the_scenes_own),
        cmocka_unit_test(nonfinite_particles_are_refused_or_dropped),
        cmocka_unit_test(cameras_of_built_in_scenes_are_taken_by_name),
        cmocka_unit_test(a_name_that_is_nothing_is_refused_with_the_names_there_are),
        cmocka_unit_test(a_frame_has_its_particles_solids_and_time),
        cmocka_unit_test(the_default_frame_is_two_thirds_of_the_way),
        cmocka_unit_test(a_time_is_the_nearest_frame),
        cmocka_unit_test(a_scenes_camera_is_that_of_its_time),
        cmocka_unit_test(a_sequence_is_seen_from_one_place),
        cmocka_unit_test(a_file_may_have_its_own_unit_and_axes),
        cmocka_unit_test(frames_that_cannot_be_made_are_an_error),
        cmocka_unit_test(scenes_inside_the_program_are_found_by_their_last_part),
        cmocka_unit_test(every_scene_inside_the_program_is_sound_at_both_scales),
    };
    return cmocka_run_group_tests(tests, test_capture_log, remove_frames);
}

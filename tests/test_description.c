/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_description.c: scene files are read, checked, moved and filled as docs/scenes.md says. */
#include "experiments/scenes/description.h"
#include "tests/util.h"

#include <omp.h>

static const double third = 1.0 / 3;

static const char whole[] =
    "title: A stream fills a basin\n"
    "radius: 0.02\n"
    "particles: 64000\n"
    "domain: {lo: [-1, 0, -0.5], hi: [1, 1.5, 0.5], open: [+x, +y]}\n"
    "gravity: [0, -9.5, 0.5]\n"
    "duration: 4\n"
    "frame_rate: 25\n"
    "rest_time: 0.5\n"
    "solver: {iterations: 6, viscosity: 0.02}\n"
    "foam: {trapped_air_rate: 2385}\n"
    "solids:\n"
    "  pillar: {shape: cylinder, centre: [0.5, 0.5, 0], radius: 0.1, height: 1, friction: 0.1}\n"
    "  chute: {shape: box, centre: [-0.5, 0.5, 0], size: [0.6, 0.05, 0.4], turn_deg: [0, 0, -20], motion: tip}\n"
    "  guard: {shape: box, centre: [-0.9, 0.3, 0.3], size: [0.05, 0.6, 0.1], colour: [0.6, 0.5, 0.4], hidden: true}\n"
    "motions:\n"
    "  still: {keys: [{time: 0}]}\n"
    "  tip: {pivot: [-0.5, 0.5, 0], axis: [0, 0, 2], period: 4,\n"
    "        keys: [{time: 0}, {time: 1, turn_deg: -30}, {time: 2}]}\n"
    "fluid:\n"
    "  basin: {lo: [-0.8, 0, -0.5], hi: [0.9, 0.2, 0.5], velocity: [0.5, 0, -1], count: 5000}\n"
    "emitters:\n"
    "  spout: {centre: [-0.8, 1, 0], direction: [2, 0, 0], radius: 0.1, speed: 2.385, start: 0.5, stop: 3.5}\n"
    "  slot: {centre: [0, 1.2, 0], direction: [0, -1, 0], size: [0.2, 0.1], speed: 1, motion: tip}\n"
    "sinks:\n"
    "  drain: {lo: [0.9, 0, -0.5], hi: [1, 0.1, 0.5]}\n"
    "cameras:\n"
    "  default: {eye: [0, 1, 3], target: [0, 0.4, 0]}\n"
    "  zoom:\n"
    "    target: [0, 0.4, 0]\n"
    "    keys: [{time: 0, eye: [0, 1, 3]}, {time: 2, eye: [1, 1, 2]}, {time: 4, eye: [2, 1, 1], fov_deg: 30}]\n"
    "light: {elevation_deg: 30}\n"
    "medium: {ior: 1.4}\n"
    "set: {curvature_flow.iterations: 60}\n"
    "floor_height: -0.25\n";

static ssfr_description *describe(const char *text, ssfr_scale scale)
{
    ssfr_description *d = NULL;
    assert_int_equal(ssfr_description_parse(&d, "a/b.yaml", text, scale, NULL), SSFR_OK);
    return d;
}

/* A tank, and what is added to it. */
#define TANK "title: t\nradius: 0.05\nparticles: 100000\nduration: 1\ndomain: {lo: [-4, -4, -4], hi: [4, 4, 4]}\n"
#define POOL "fluid: {pool: {lo: [-1, -1, -1], hi: [0, 0, 0]}}\n"

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static void assert_vector(const double v[3], double x, double y, double z)
{
    assert_close(v[0], x, 1e-12, 0);
    assert_close(v[1], y, 1e-12, 0);
    assert_close(v[2], z, 1e-12, 0);
}

static void a_whole_scene_is_read(void **state)
{
    (void)state;
    ssfr_description *d = describe(whole, SSFR_SCALE_FULL);
    assert_string_equal(d->name, "a/b.yaml");
    assert_string_equal(d->title, "A stream fills a basin");
    assert_string_equal(d->text, whole);
    assert_int_equal(d->scale, SSFR_SCALE_FULL);
    assert_close(d->solver.radius, 0.02, 0, 0);
    assert_int_equal(d->solver.max_particles, 64000);
    assert_vector(d->solver.lo, -1, 0, -0.5);
    assert_vector(d->solver.hi, 1, 1.5, 0.5);
    const bool open[6] = {false, true, false, true, false, false};
    assert_memory_equal(d->solver.open, open, sizeof open);
    assert_vector(d->solver.gravity, 0, -9.5, 0.5);
    assert_int_equal(d->solver.params.iterations, 6);
    assert_close(d->solver.params.viscosity, 0.02, 0, 0);
    assert_int_equal(d->n_frames, 101);
    assert_close(d->frame_rate, 25, 0, 0);
    assert_close(d->rest_time, 0.5, 0, 0);
    assert_close(d->floor, -0.25, 0, 0);
    assert_true(d->has_foam);
    assert_close(d->foam.trapped_air_rate, 2385, 0, 0);
    assert_int_equal(d->n_motions, 2);
    assert_string_equal(d->motions[1].name, "tip");
    assert_vector(d->motions[1].axis, 0, 0, 1);
    assert_int_equal(d->motions[1].n_keys, 3);
    assert_int_equal(d->motions[1].easing, SSFR_EASE_SMOOTH);
    assert_null(d->environment);
    ssfr_description_destroy(&d);
    assert_null(d);
    ssfr_description_destroy(&d);
}

static void its_parts_are_read(void **state)
{
    (void)state;
    ssfr_description *d = describe(whole, SSFR_SCALE_FULL);
    assert_int_equal(d->n_bodies, 3);
    assert_string_equal(d->bodies[0].name, "pillar");
    assert_int_equal(d->bodies[0].motion, -1);
    assert_close(d->bodies[0].friction, 0.1, 0, 0);
    assert_false(d->bodies[0].hidden);
    assert_vector(d->bodies[0].solid.colour, 0.5, 0.5, 0.5);
    assert_int_equal(d->bodies[1].motion, 1);
    assert_true(d->bodies[2].hidden);
    assert_vector(d->bodies[2].solid.colour, 0.6, 0.5, 0.4);
    assert_int_equal(d->n_pools, 1);
    assert_int_equal(d->pools[0].count, 5000);
    assert_vector(d->pools[0].velocity, 0.5, 0, -1);
    assert_int_equal(d->n_emitters, 2);
    const ssfr_emitter *spout = &d->emitters[0], *slot = &d->emitters[1];
    assert_true(spout->disc && !slot->disc);
    assert_vector(spout->direction, 1, 0, 0);
    assert_vector(spout->up, 0, 1, 0);
    assert_close(spout->half[0], 0.1, 0, 0);
    assert_close(spout->half[1], 0.1, 0, 0);
    assert_close(spout->speed, 2.385, 0, 0);
    assert_close(spout->start, 0.5, 0, 0);
    assert_close(spout->stop, 3.5, 0, 0);
    assert_vector(slot->up, 0, 0, -1);
    assert_close(slot->half[0], 0.1, 0, 0);
    assert_close(slot->half[1], 0.05, 0, 0);
    assert_true(isinf(slot->stop));
    assert_int_equal(slot->motion, 1);
    assert_int_equal(d->n_sinks, 1);
    assert_vector(d->sinks[0].centre, 0.95, 0.05, 0);
    assert_vector(d->sinks[0].half, 0.05, 0.05, 0.5);
    assert_int_equal(d->n_settings, 3);
    ssfr_description_destroy(&d);
}

static void settings_of_groups_and_passes_keep_their_place(void **state)
{
    (void)state;
    static const char *const expected[][3] = {{"light.elevation_deg", "30", "a/b.yaml:31:9"},
                                              {"medium.ior", "1.4", "a/b.yaml:32:10"},
                                              {"curvature_flow.iterations", "60", "a/b.yaml:33:7"}};
    ssfr_description *d = describe(whole, SSFR_SCALE_FULL);
    for (int i = 0; i < d->n_settings; i++) {
        assert_string_equal(d->settings[i].key, expected[i][0]);
        assert_string_equal(d->settings[i].value, expected[i][1]);
        assert_string_equal(d->settings[i].where, expected[i][2]);
    }
    ssfr_description_destroy(&d);
}

static void quick_has_fewer_and_larger_particles(void **state)
{
    (void)state;
    ssfr_description *d = describe(whole, SSFR_SCALE_QUICK);
    assert_close(d->solver.radius, 0.02 * cbrt(16), 1e-15, 0);
    assert_int_equal(d->solver.max_particles, 4000);
    assert_close(d->foam.trapped_air_min, 5 * cbrt(16), 0, 1e-15);
    assert_close(d->foam.trapped_air_max, 20 * cbrt(16), 0, 1e-15);
    assert_int_equal(d->pools[0].count, 313);
    assert_close(d->emitters[0].half[0], 0.1, 0, 0);
    assert_int_equal(d->n_frames, 101);
    ssfr_description_destroy(&d);
    d = describe("title: t\nradius: 0.05\nparticles: 25\nduration: 0\ndomain: {lo: [-4, -4, -4], hi: [4, 4, 4]}\n"
                 "fluid: {a: {lo: [0, 0, 0], hi: [1, 1, 1], count: 3}, b: {lo: [1, 0, 0], hi: [2, 1, 1], count: 22}}\n"
                 "foam: {max_particles: 100}\n",
                 SSFR_SCALE_QUICK);
    assert_int_equal(d->solver.max_particles, 2); /* 1.56 */
    assert_int_equal(d->pools[0].count, 1);       /* 0.19, but not none */
    assert_int_equal(d->pools[1].count, 1);       /* 1.38 */
    assert_int_equal(d->foam.max_particles, 6);
    ssfr_description_destroy(&d);
}

static void what_is_not_said_has_the_documented_default(void **state)
{
    (void)state;
    const ssfr_view *view;
    ssfr_description *d = describe(TANK POOL, SSFR_SCALE_FULL);
    assert_vector(d->solver.gravity, 0, -9.81, 0);
    assert_close(d->frame_rate, 30, 0, 0);
    assert_int_equal(d->n_frames, 31);
    assert_close(d->rest_time, 0, 0, 0);
    assert_close(d->floor, -4, 0, 0);
    assert_false(d->has_foam);
    for (int i = 0; i < 6; i++) assert_false(d->solver.open[i]);
    assert_int_equal(d->solver.params.iterations, ssfr_solver_rows[2].def);
    assert_int_equal(ssfr_description_view(d, NULL, &view), SSFR_OK);
    assert_null(view);
    ssfr_description_destroy(&d);
}

static void the_ground_is_the_domains_bottom_unless_that_is_open(void **state)
{
    (void)state;
    static const struct {
        const char *open, *more;
        double floor;
    } cases[] = {{"+y", "", -0.5}, {"-y", "", -INFINITY}, {"-y", "floor_height: -0.75\n", -0.75},
                 {"+x", "floor_height: none\n", -INFINITY}};
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        char text[400];
        snprintf(text, sizeof text,
                 "title: t\nradius: 0.05\nparticles: 9\nduration: 1\nfluid: {a: {lo: [0, 0, 0], hi: [1, 1, 1]}}\n"
                 "domain: {lo: [0, -0.5, 0], hi: [1, 1, 1], open: [%s]}\n%s", cases[i].open, cases[i].more);
        ssfr_description *d = describe(text, SSFR_SCALE_FULL);
        assert_close(d->floor, cases[i].floor, 0, 0);
        ssfr_description_destroy(&d);
    }
}

static void frames_are_counted_up_to_the_duration(void **state)
{
    (void)state;
    static const struct {
        const char *more;
        int n_frames;
    } cases[] = {{"duration: 0\n", 1}, {"duration: 0.1\nframe_rate: 30\n", 4}, {"duration: 0.9\nframe_rate: 10\n", 10},
                 {"duration: 0.89\nframe_rate: 10\n", 9}, {"duration: 2.385\nframe_rate: 1000\n", 2386}};
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        char text[400];
        snprintf(text, sizeof text, "title: t\nradius: 0.05\nparticles: 9\ndomain: {lo: [-4, -4, -4], hi: [4, 4, 4]}\n"
                 POOL "%s", cases[i].more);
        ssfr_description *d = describe(text, SSFR_SCALE_FULL);
        assert_int_equal(d->n_frames, cases[i].n_frames);
        ssfr_description_destroy(&d);
    }
}

static void assert_documented(const char *text)
{
    for (int scale = 0; scale < 2; scale++) {
        ssfr_description *d = describe(text, (ssfr_scale)scale);
        size_t n = 0;
        double *positions;
        float *velocities;
        assert_int_equal(ssfr_description_fill(d, &n, &positions, &velocities), SSFR_OK);
        assert_true(n > 0 && n <= d->solver.max_particles);
        free(positions);
        free(velocities);
        ssfr_description_destroy(&d);
    }
}

static void the_documented_scenes_are_scenes(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size = 0;
    int n = 0;
    assert_int_equal(ssfr_read_file("docs/scenes.md", 1 << 20, &text, &size), SSFR_OK);
    for (char *at = strstr(text, "```yaml\n"), *end; at; at = strstr(end + 1, "```yaml\n"), n++) {
        at += strlen("```yaml\n");
        end = strstr(at, "```");
        assert_non_null(end);
        *end = '\0';
        assert_documented(at);
    }
    assert_int_equal(n, 2);
    free(text);
}

/* Each key that an error lists stands in the document, as code. */
static void assert_keys_documented(const char *document, const char *scene)
{
    char list[1024];
    ssfr_description *d = NULL;
    assert_fails(SSFR_ERR_FORMAT, ssfr_description_parse(&d, "s.yaml", scene, SSFR_SCALE_FULL, NULL), "no key nothing");
    snprintf(list, sizeof list, "%s", strstr(test_last_error(), " has ") + strlen(" has "));
    for (char *name = strtok(list, ", "); name; name = strtok(NULL, ", ")) {
        char code[64];
        snprintf(code, sizeof code, "`%s`", name);
        if (!strstr(document, code)) print_error("docs/scenes.md lacks %s\n", code);
        assert_non_null(strstr(document, code));
    }
}

static void every_key_is_documented(void **state)
{
    (void)state;
    static const char *const shapes[] = {"box", "ramp", "cylinder", "tube", "sphere", "plane", "mesh"};
    static const char *const parts[] = {
        "nothing: 1\n",
        "title: t\nradius: 1\nparticles: 1\nduration: 1\ndomain: {nothing: 1}\n",
        TANK "fluid: {p: {nothing: 1}}\n",
        TANK "emitters: {e: {nothing: 1}}\n",
        TANK "sinks: {s: {nothing: 1}}\n",
        TANK "motions: {m: {nothing: 1}}\n",
        TANK "motions: {m: {keys: [{nothing: 1}]}}\n",
        TANK "cameras: {c: {nothing: 1}}\n",
        TANK "cameras: {c: {keys: [{nothing: 1}]}}\n",
    };
    char *document = NULL;
    size_t size = 0;
    assert_int_equal(ssfr_read_file("docs/scenes.md", 1 << 20, &document, &size), SSFR_OK);
    for (size_t i = 0; i < SSFR_COUNT(parts); i++) assert_keys_documented(document, parts[i]);
    for (size_t i = 0; i < SSFR_COUNT(shapes); i++) {
        char text[300];
        snprintf(text, sizeof text, TANK "solids: {s: {shape: %s, nothing: 1}}\n", shapes[i]);
        assert_keys_documented(document, text);
    }
    free(document);
}

/* ---- motions ----------------------------------------------------------------------------------------------------- */

#define WITH_MOTION(motion) TANK POOL "motions: {m: " motion "}\n" \
    "solids: {s: {shape: box, centre: [2, 0.5, 0], size: [0.2, 0.4, 0.6], motion: m}}\n"

/* Where the box's centre is. */
static double place_at(const ssfr_description *d, double time, int k)
{
    return ssfr_body_at(d, &d->bodies[0], time).centre[k];
}

static void a_smooth_motion_is_at_its_keys_and_half_way_between_at_half_time(void **state)
{
    (void)state;
    ssfr_description *d = describe(WITH_MOTION("{keys: [{time: 0.5, move: [0.25, 0, 0]},"
                                               " {time: 1.5, move: [1.25, -2, 0]},"
                                               " {time: 4, move: [0.5, 1, 0]}]}"),
                                   SSFR_SCALE_FULL);
    assert_close(place_at(d, 0.5, 0), 2.25, 1e-15, 0);
    assert_close(place_at(d, 1.5, 0), 3.25, 1e-15, 0);
    assert_close(place_at(d, 1.5, 1), -1.5, 1e-15, 0);
    assert_close(place_at(d, 1, 0), 2.75, 1e-15, 0);
    assert_close(place_at(d, 2.75, 1), 0, 1e-15, 0);
    assert_close(place_at(d, 0.75, 0), 2.25 + 0.15625, 1e-15, 0); /* 3/16 - 2/64 */
    const double before[] = {-1, 0, 0.5}, after[] = {4, 4.5, 1e6};
    for (int i = 0; i < 3; i++) {
        assert_close(place_at(d, before[i], 0), 2.25, 1e-15, 0);
        assert_close(place_at(d, after[i], 0), 2.5, 1e-15, 0);
    }
    ssfr_description_destroy(&d);
}

static void a_smooth_motion_rests_at_its_keys(void **state)
{
    (void)state;
    const double h = 1e-5;
    ssfr_description *d = describe(WITH_MOTION("{keys: [{time: 0}, {time: 1, move: [1, 0, 0]},"
                                               " {time: 3, move: [4, 0, 0]}]}"),
                                   SSFR_SCALE_FULL);
    for (int key = 0; key < 3; key++) {
        const double t = d->motions[0].keys[key].time;
        assert_close((place_at(d, t + h, 0) - place_at(d, t, 0)) / h, 0, 4 * h, 0); /* 3 |move| h / T^2 */
        assert_close((place_at(d, t, 0) - place_at(d, t - h, 0)) / h, 0, 4 * h, 0);
    }
    assert_close((place_at(d, 0.5 + h, 0) - place_at(d, 0.5 - h, 0)) / (2 * h), 1.5, 1e-6, 0);
    ssfr_description_destroy(&d);
}

static void a_linear_motion_has_one_speed_and_a_period_repeats_it(void **state)
{
    (void)state;
    ssfr_description *d = describe(WITH_MOTION("{axis: [0, 0, 1], easing: linear, period: 2,"
                                               " keys: [{time: 0}, {time: 2, turn_deg: 360}]}"),
                                   SSFR_SCALE_FULL);
    for (double t = 0; t < 7; t += 0.2385) {
        const double a = acos(-1) * t;
        const ssfr_solid s = ssfr_body_at(d, &d->bodies[0], t);
        assert_vector(s.centre, 2 * cos(a) - 0.5 * sin(a), 2 * sin(a) + 0.5 * cos(a), 0);
        assert_vector(s.axis[0], cos(a), sin(a), 0);
        assert_vector(s.axis[1], -sin(a), cos(a), 0);
        assert_vector(s.axis[2], 0, 0, 1);
    }
    assert_vector(ssfr_body_at(d, &d->bodies[0], -0.5).centre, 2, 0.5, 0);
    ssfr_description_destroy(&d);
}

static void a_motion_that_waits_for_its_period_stands_in_between(void **state)
{
    (void)state;
    ssfr_description *d = describe(WITH_MOTION("{period: 5, keys: [{time: 1}, {time: 2, move: [1, 0, 0]}, {time: 3}]}"),
                                   SSFR_SCALE_FULL);
    const double times[] = {0.5, 2, 4, 5.5, 7, 9, 11.5}, places[] = {2, 3, 2, 2, 3, 2, 2.5};
    for (size_t i = 0; i < SSFR_COUNT(times); i++) assert_close(place_at(d, times[i], 0), places[i], 1e-12, 0);
    ssfr_description_destroy(&d);
}

static void a_body_turns_about_the_axis_through_its_pivot_and_then_moves(void **state)
{
    (void)state;
    ssfr_description *d = describe(WITH_MOTION("{pivot: [1, 0.5, 1], axis: [0, 3, 0],"
                                               " keys: [{time: 0}, {time: 1, turn_deg: 90, move: [0, 0.25, 1]}]}"),
                                   SSFR_SCALE_FULL);
    const ssfr_solid s = ssfr_body_at(d, &d->bodies[0], 1);
    assert_vector(s.centre, 0, 0.75, 1); /* (1, 0, -1) from the pivot becomes (-1, 0, -1) */
    assert_vector(s.axis[0], 0, 0, -1);
    assert_vector(s.axis[1], 0, 1, 0);
    assert_vector(s.axis[2], 1, 0, 0);
    assert_vector(s.half, 0.1, 0.2, 0.3);
    ssfr_description_destroy(&d);
}

static void turns_about_any_axis_keep_lengths_and_angles(void **state)
{
    (void)state;
    ssfr_description *d = describe(WITH_MOTION("{pivot: [0.3, -1, 2], axis: [1, 2, -0.5],"
                                               " keys: [{time: 0}, {time: 3, turn_deg: 2385}]}"),
                                   SSFR_SCALE_FULL);
    const double axis_length = sqrt(1 + 4 + 0.25), axis[3] = {1 / axis_length, 2 / axis_length, -0.5 / axis_length};
    for (double t = 0; t <= 3; t += 0.25) {
        const ssfr_solid s = ssfr_body_at(d, &d->bodies[0], t);
        double along = 0;
        for (int i = 0; i < 3; i++) {
            along += axis[i] * (s.centre[i] - d->bodies[0].solid.centre[i]);
            for (int k = 0; k < 3; k++) assert_close(ssfr_dot(s.axis[i], s.axis[k]), i == k, 1e-14, 0);
        }
        assert_close(along, 0, 1e-13, 0);
    }
    ssfr_description_destroy(&d);
}

static void an_emitter_goes_with_its_motion(void **state)
{
    (void)state;
    ssfr_description *d = describe(TANK "motions: {m: {axis: [0, 0, 1], keys: [{time: 0}, {time: 2, turn_deg: 90}]}}\n"
                                        "emitters:\n"
                                        "  a: {centre: [1, 0, 0], direction: [1, 0, 0], radius: 0.2, speed: 1,\n"
                                        "      motion: m}\n"
                                        "  b: {centre: [1, 0, 0], direction: [1, 0, 0], radius: 0.2, speed: 1}\n",
                                   SSFR_SCALE_FULL);
    const ssfr_emitter a = ssfr_emitter_at(d, &d->emitters[0], 2), b = ssfr_emitter_at(d, &d->emitters[1], 2);
    assert_vector(a.centre, 0, 1, 0);
    assert_vector(a.direction, 0, 1, 0);
    assert_vector(a.up, -1, 0, 0);
    assert_vector(b.centre, 1, 0, 0);
    assert_vector(ssfr_emitter_at(d, &d->emitters[0], 1).direction, sqrt(0.5), sqrt(0.5), 0);
    ssfr_description_destroy(&d);
}

/* ---- cameras ----------------------------------------------------------------------------------------------------- */

#define WITH_CAMERA(camera) TANK POOL "cameras: {c: " camera "}\n"

static void a_camera_of_one_key_stands(void **state)
{
    (void)state;
    ssfr_description *d = describe(WITH_CAMERA("{eye: [0, 1, 3], target: [0.5, 0, 0], up: [0, 0, 2], fov_deg: 23.85}"),
                                   SSFR_SCALE_FULL);
    for (double t = -1; t < 3; t += 0.7) {
        const ssfr_view_key key = ssfr_view_at(&d->views[0], t);
        assert_vector(key.eye, 0, 1, 3);
        assert_vector(key.target, 0.5, 0, 0);
        assert_close(key.fov_deg, 23.85, 0, 0);
    }
    assert_vector(d->views[0].up, 0, 0, 1);
    ssfr_description_destroy(&d);
}

static void a_camera_of_two_keys_goes_straight(void **state)
{
    (void)state;
    ssfr_description *d = describe(WITH_CAMERA("{target: [0, 0, 0], fov_deg: 40, keys: [{time: 1, eye: [0, 1, 3]},"
                                               " {time: 3, eye: [1, 1, 5], fov_deg: 20}]}"),
                                   SSFR_SCALE_FULL);
    const ssfr_view_key key = ssfr_view_at(&d->views[0], 1.5);
    assert_vector(key.eye, 0.25, 1, 3.5);
    assert_vector(key.target, 0, 0, 0);
    assert_close(key.fov_deg, 35, 1e-12, 0);
    assert_vector(ssfr_view_at(&d->views[0], 0).eye, 0, 1, 3);
    assert_vector(ssfr_view_at(&d->views[0], 9).eye, 1, 1, 5);
    ssfr_description_destroy(&d);
}

/* Through 0, 1 and 0 at equal steps the natural cubic spline is (3 u - u^3) / 2 on its first span. */
static void a_path_is_the_natural_cubic_spline_through_its_keys(void **state)
{
    (void)state;
    ssfr_description *d = describe(WITH_CAMERA("{target: [0, 0, -9], keys: [{time: 0, eye: [0, 1, 3]},"
                                               " {time: 2, eye: [2.385, 1, 3]}, {time: 4, eye: [0, 1, 3]}]}"),
                                   SSFR_SCALE_FULL);
    for (double t = 0; t <= 2; t += 0.125) {
        const double u = t / 2;
        assert_close(ssfr_view_at(&d->views[0], t).eye[0], 2.385 * (3 * u - u * u * u) / 2, 1e-14, 0);
        assert_close(ssfr_view_at(&d->views[0], 4 - t).eye[0], 2.385 * (3 * u - u * u * u) / 2, 1e-14, 0);
    }
    ssfr_description_destroy(&d);
}

static void a_path_goes_through_its_keys_without_a_jump_in_speed_or_acceleration(void **state)
{
    (void)state;
    const double h = 1e-3;
    ssfr_description *d = describe(WITH_CAMERA("{target: [0, 0, -9], keys: [{time: 0, eye: [0, 1, 3]},"
                                               " {time: 0.4, eye: [1, 2, 3]}, {time: 1.7, eye: [0, 2, 5]},"
                                               " {time: 2, eye: [0.3, 1, 5]}, {time: 3.1, eye: [3, 1, 4]}]}"),
                                   SSFR_SCALE_FULL);
    const ssfr_view *v = &d->views[0];
    for (int i = 0; i < v->n_keys; i++) {
        const double *eye = v->keys[i].eye;
        assert_vector(ssfr_view_at(v, v->keys[i].time).eye, eye[0], eye[1], eye[2]);
    }
    for (int key = 1; key < v->n_keys - 1; key++) {
        const double t = v->keys[key].time;
        for (int k = 0; k < 3; k++) {
            double p[7]; /* one-sided differences of a cubic, exact to h^3 and rounding */
            for (int i = 0; i < 7; i++) p[i] = ssfr_view_at(v, t + (i - 3) * h).eye[k];
            const double before = (11 * p[3] - 18 * p[2] + 9 * p[1] - 2 * p[0]) / (6 * h);
            const double after = -(11 * p[3] - 18 * p[4] + 9 * p[5] - 2 * p[6]) / (6 * h);
            const double bend_before = (2 * p[3] - 5 * p[2] + 4 * p[1] - p[0]) / (h * h);
            const double bend_after = (2 * p[3] - 5 * p[4] + 4 * p[5] - p[6]) / (h * h);
            assert_close(before, after, 1e-9, 1e-9);
            assert_close(bend_before, bend_after, 1e-6, 1e-6);
        }
    }
    ssfr_description_destroy(&d);
}

static void a_camera_is_found_by_name(void **state)
{
    (void)state;
    const ssfr_view *view = NULL;
    ssfr_description *d = describe(whole, SSFR_SCALE_FULL);
    assert_int_equal(ssfr_description_view(d, NULL, &view), SSFR_OK);
    assert_string_equal(view->name, "default");
    assert_int_equal(ssfr_description_view(d, "zoom", &view), SSFR_OK);
    assert_int_equal(view->n_keys, 3);
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_description_view(d, "zomm", &view),
                 "a/b.yaml: no camera zomm: there are default, zoom");
    assert_null(view);
    ssfr_description_destroy(&d);
}

/* ---- solids ------------------------------------------------------------------------------------------------------ */

/* A cube of the edge 2 m around the origin. */
static const char cube[] = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
                           "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

static void solids_are_where_they_are_put(void **state)
{
    (void)state;
    const char *obj = test_path("cube.obj");
    test_write_file(obj, cube, sizeof cube - 1);
    const struct {
        const char *solid;
        double at[3], distance;
    } cases[] = {
        {"{shape: box, centre: [1, 0.5, 0], size: [2, 1, 0.5]}", {1, 0.5, 0.5}, 0.25},
        {"{shape: box, centre: [1, 0.5, 0], size: [2, 1, 0.5]}", {3, 0.5, 0}, 1},
        {"{shape: box, centre: [0, 0, 0], size: [2, 1, 0.5], turn_deg: [0, 0, 90]}", {0, 2, 0}, 1},
        {"{shape: box, centre: [0, 0, 0], size: [2, 1, 0.5], turn_deg: [90, 0, 0]}", {0, 0, 2}, 1.5},
        {"{shape: box, centre: [0, 0, 0], size: [2, 1, 0.5], turn_deg: [90, 0, 90]}", {0, 2, 0}, 1},
        {"{shape: ramp, centre: [0, 0, 0], size: [2, 2, 2]}", {1, -1, 0.25}, 0},
        {"{shape: ramp, centre: [0, 0, 0], size: [2, 2, 2]}", {-0.5, 0.5, 0}, 0.70710678118654757},
        {"{shape: cylinder, centre: [0, 1, 0], radius: 0.5, height: 4}", {0, 3.5, 0}, 0.5},
        {"{shape: cylinder, centre: [0, 1, 0], radius: 0.5, height: 4}", {1, 2, 0}, 0.5},
        {"{shape: cylinder, centre: [0, 0, 0], radius: 0.5, height: 4, axis: [3, 0, 0]}", {2.5, 0, 0}, 0.5},
        {"{shape: cylinder, centre: [0, 0, 0], radius: 0.5, height: 4, axis: [0, 0, -1]}", {0, 1, 1}, 0.5},
        {"{shape: tube, centre: [0, 0, 0], radius: 0.5, inner: 0.25, height: 4}", {0, 0, 0}, 0.25},
        {"{shape: sphere, centre: [1, 2, 3], radius: 0.5}", {1, 2, 0}, 2.5},
        {"{shape: plane, centre: [0, -1, 0]}", {3, 2, 1}, 3},
        {"{shape: plane, centre: [0, -1, 0], normal: [0, 0, 2]}", {3, 2, -1}, -1},
        {"{shape: mesh, file: cube.obj}", {3, 0, 0}, 2},
        {"{shape: mesh, file: cube.obj, scale: 0.5, centre: [0, 1, 0]}", {0, 3, 0}, 1.5},
        {"{shape: mesh, file: cube.obj, scale: 1.5, centre: [0, 1, 0]}", {0, 1, 0}, -1.5},
        {"{shape: mesh, file: cube.obj, turn_deg: [0, 45, 0]}", {0, 0, 3}, 1.5857864376269049},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_description *d = NULL;
        char text[700];
        double normal[3];
        snprintf(text, sizeof text,
                 TANK "emitters: {e: {centre: [-4, 4, 4], direction: [1, 0, 0], radius: 1, speed: 1}}\n"
                      "solids: {s: %s}\n", cases[i].solid);
        const char *path = test_path("scene.yaml");
        test_write_file(path, text, strlen(text));
        assert_int_equal(ssfr_description_load(&d, path, SSFR_SCALE_FULL), SSFR_OK);
        assert_close(ssfr_solid_distance(&d->bodies[0].solid, cases[i].at, normal), cases[i].distance, 1e-12, 0);
        ssfr_description_destroy(&d);
    }
}

static const char *asked_for;

static ssfr_result keep_path(ssfr_mesh **out, const char *path)
{
    static char kept[100];
    snprintf(kept, sizeof kept, "%s", path);
    asked_for = kept;
    return ssfr_mesh_load(out, test_path("ship.obj"));
}

static void meshes_of_built_in_scenes_come_from_their_loader(void **state)
{
    (void)state;
    ssfr_description *d = NULL;
    test_write_file(test_path("ship.obj"), cube, sizeof cube - 1);
    assert_int_equal(ssfr_description_parse(&d, "akinci2013/wake",
                                            TANK POOL "solids: {s: {shape: mesh, file: ship.obj, centre: [2, 2, 2]}}\n",
                                            SSFR_SCALE_FULL, keep_path),
                     SSFR_OK);
    assert_string_equal(asked_for, "akinci2013/ship.obj");
    assert_string_equal(d->bodies[0].file, "akinci2013/ship.obj");
    assert_non_null(d->bodies[0].mesh);
    ssfr_description_destroy(&d);
}

static void as_many_solids_are_taken_as_can_be_drawn_hidden_or_not(void **state)
{
    (void)state;
    for (int n = SSFR_MAX_SOLIDS; n <= SSFR_MAX_SOLIDS + 1; n++) {
        char text[20000] = TANK POOL "solids:\n";
        ssfr_description *d = NULL;
        for (int i = 0; i < n; i++)
            snprintf(text + strlen(text), sizeof text - strlen(text),
                     "  s%d: {shape: sphere, centre: [3, 3, 3], radius: 0.5, hidden: %s}\n", i,
                     i < 20 ? "true" : "false");
        if (n == SSFR_MAX_SOLIDS) {
            d = describe(text, SSFR_SCALE_FULL);
            assert_int_equal(d->n_bodies, SSFR_MAX_SOLIDS);
        } else {
            assert_fails(SSFR_ERR_VALUE, ssfr_description_parse(&d, "s.yaml", text, SSFR_SCALE_FULL, NULL),
                         "s.yaml:72:3: s64: more than 64 solids");
        }
        ssfr_description_destroy(&d);
    }
}

/* ---- pools ------------------------------------------------------------------------------------------------------- */

typedef struct filled {
    ssfr_description *d;
    size_t n;
    double *positions;
    float *velocities;
} filled;

static filled fill(const char *text, ssfr_scale scale)
{
    filled f = {.d = describe(text, scale)};
    assert_int_equal(ssfr_description_fill(f.d, &f.n, &f.positions, &f.velocities), SSFR_OK);
    return f;
}

static void finish(filled *f)
{
    free(f->positions);
    free(f->velocities);
    ssfr_description_destroy(&f->d);
}

static void a_full_pool_has_the_density_of_rest(void **state)
{
    (void)state;
    filled f = fill("title: t\nradius: 0.05\nparticles: 100000\nduration: 1\ndomain: {lo: [0, 0, 0], hi: [4, 4, 4]}\n"
                    "fluid: {a: {lo: [0.5, 0, 1], hi: [2.5, 1, 2.4], velocity: [0.5, -1, 0.25]}}\n",
                    SSFR_SCALE_FULL);
    const double spacing = cbrt(0.8) * 0.1; /* 0.0928 m: 21.5, 10.8 and 15.1 in the pool */
    const int places[3] = {21, 10, 15};
    assert_int_equal(f.n, 21 * 10 * 15);
    assert_close(ssfr_particle_mass(0.05) / (spacing * spacing * spacing), SSFR_REST_DENSITY, 1e-9, 0);
    double lo[3] = {9, 9, 9}, hi[3] = {0, 0, 0};
    for (size_t i = 0; i < 3 * f.n; i++) {
        lo[i % 3] = fmin(lo[i % 3], f.positions[i]);
        hi[i % 3] = fmax(hi[i % 3], f.positions[i]);
        assert_close(f.velocities[i], i % 3 == 0 ? 0.5 : i % 3 == 1 ? -1 : 0.25, 0, 0);
    }
    for (int k = 0; k < 3; k++) assert_close(hi[k] - lo[k], (places[k] - 1) * spacing, 1e-12, 0);
    assert_close(lo[0] + hi[0], 3, 1e-12, 0); /* in the middle */
    assert_close(lo[2] + hi[2], 3.4, 1e-12, 0);
    assert_close(lo[1], spacing / 2, 1e-12, 0);
    finish(&f);
}

static void a_pool_that_fits_to_the_last_digit_is_full(void **state)
{
    (void)state;
    char text[400];
    const double side = 7 * cbrt(0.8) * 0.1;
    snprintf(text, sizeof text, TANK "fluid: {a: {lo: [0, 0, 0], hi: [%.12g, %.12g, %.12g]}}\n", side, side, side);
    filled f = fill(text, SSFR_SCALE_FULL);
    assert_int_equal(f.n, 343);
    finish(&f);
}

static void a_count_fills_from_below(void **state)
{
    (void)state;
    filled f = fill("title: t\nradius: 0.05\nparticles: 1000\nduration: 1\ndomain: {lo: [0, 0, 0], hi: [4, 4, 4]}\n"
                    "fluid: {a: {lo: [0, 1, 0], hi: [1, 3, 1], count: 250}}\n",
                    SSFR_SCALE_FULL);
    const double spacing = cbrt(0.8) * 0.1;
    size_t layers[3] = {0};
    assert_int_equal(f.n, 250);
    for (size_t i = 0; i < f.n; i++) layers[(int)((f.positions[3 * i + 1] - 1) / spacing)]++;
    assert_int_equal(layers[0], 100);
    assert_int_equal(layers[1], 100);
    assert_int_equal(layers[2], 50);
    finish(&f);
    f = fill("title: t\nradius: 0.05\nparticles: 1000\nduration: 1\ndomain: {lo: [0, 0, 0], hi: [4, 4, 4]}\n"
             "fluid: {a: {lo: [0, 1, 0], hi: [1, 3, 1], count: 250}}\n",
             SSFR_SCALE_QUICK);
    assert_int_equal(f.n, 16); /* 15.6 */
    finish(&f);
}

static void solids_keep_their_room_at_time_0(void **state)
{
    (void)state;
    filled f = fill(TANK "fluid: {a: {lo: [-1, -1, -1], hi: [1, 1, 1]}}\n"
                         "motions: {m: {keys: [{time: 0, move: [0, 0.5, 0]}, {time: 1}]}}\n"
                         "solids:\n  ball: {shape: sphere, centre: [0, -0.5, 0], radius: 0.5, motion: m}\n"
                         "  tube: {shape: tube, centre: [0, 0, 0], radius: 0.95, inner: 0.8, height: 3}\n"
                         "  lid: {shape: plane, centre: [0, 0.75, 0], normal: [0, -1, 0]}\n",
                    SSFR_SCALE_FULL);
    const double spacing = cbrt(0.8) * 0.1;
    size_t expected = 0;
    for (size_t i = 0; i < f.n; i++) {
        const double *p = f.positions + 3 * i, across = hypot(p[0], p[2]);
        assert_true(sqrt(ssfr_dot(p, p)) >= 0.55 - 1e-9);
        assert_true(p[1] <= 0.7 + 1e-9);
        assert_true(across <= 0.75 + 1e-9 || across >= 1 - 1e-9);
    }
    for (int i = 0; i < 21 * 21 * 21; i++) {
        const double at[3] = {(i % 21 - 10) * spacing, -1 + (i / 21 % 21 + 0.5) * spacing, (i / 441 - 10) * spacing};
        const double across = hypot(at[0], at[2]);
        expected += sqrt(ssfr_dot(at, at)) >= 0.55 && at[1] <= 0.7 && (across <= 0.75 || across >= 1);
    }
    assert_int_equal(f.n, expected);
    assert_true(f.n > 1000);
    finish(&f);
}

static void pools_are_filled_in_their_order_up_to_the_scenes_particles(void **state)
{
    (void)state;
    filled f = fill("title: t\nradius: 0.05\nparticles: 1200\nduration: 1\ndomain: {lo: [0, 0, 0], hi: [4, 4, 4]}\n"
                    "fluid:\n  a: {lo: [0, 0, 0], hi: [1, 1, 1]}\n"
                    "  b: {lo: [1, 0, 0], hi: [2, 1, 1], velocity: [1, 0, 0]}\n"
                    "  c: {lo: [2, 0, 0], hi: [3, 1, 1]}\n",
                    SSFR_SCALE_FULL);
    assert_int_equal(f.n, 1200); /* a holds 1000, b the rest */
    assert_close(f.velocities[3 * 999], 0, 0, 0);
    assert_close(f.velocities[3 * 1000], 1, 0, 0);
    assert_true(f.positions[3 * 1199] > 1 && f.positions[3 * 1199] < 2);
    finish(&f);
}

static void filling_gives_the_same_bits_for_any_number_of_threads(void **state)
{
    (void)state;
    const int most = omp_get_max_threads();
    omp_set_num_threads(1);
    filled one = fill(whole, SSFR_SCALE_FULL);
    omp_set_num_threads(3);
    filled three = fill(whole, SSFR_SCALE_FULL);
    omp_set_num_threads(most);
    assert_int_equal(one.n, three.n);
    assert_memory_equal(one.positions, three.positions, 3 * one.n * sizeof(double));
    assert_memory_equal(one.velocities, three.velocities, 3 * one.n * sizeof(float));
    finish(&one);
    finish(&three);
}

static void a_scene_of_emitters_alone_is_empty_at_first(void **state)
{
    (void)state;
    filled f = fill(TANK "emitters: {e: {centre: [0, 0, 0], direction: [1, 1, 1], radius: 1, speed: 1}}\n",
                    SSFR_SCALE_FULL);
    assert_int_equal(f.n, 0);
    for (int k = 0; k < 3; k++) assert_close(f.d->emitters[0].direction[k], sqrt(third), 1e-15, 0);
    assert_close(ssfr_dot(f.d->emitters[0].direction, f.d->emitters[0].up), 0, 1e-15, 0);
    assert_close(f.d->emitters[0].up[1], sqrt(2 * third), 1e-15, 0);
    finish(&f);
}

/* ---- what is wrong ----------------------------------------------------------------------------------------------- */

#define EMITTER(keys) TANK "emitters:\n  e: {" keys "}\n"
#define SOLID(keys) TANK POOL "solids:\n  s: {" keys "}\n"
#define MOTION(keys) TANK POOL "motions:\n  m: {" keys "}\n"
#define CAMERA(keys) TANK POOL "cameras:\n  c: {" keys "}\n"
#define FLUID(keys) TANK "fluid:\n  p: {" keys "}\n"

static const struct {
    ssfr_result code;
    const char *text, *message;
} wrong[] = {
    {SSFR_ERR_FORMAT, "", "s.yaml:1:1: an empty file"},
    {SSFR_ERR_FORMAT, "- 1\n", "s.yaml:1:1: the scene: expected a map"},
    {SSFR_ERR_FORMAT, TANK POOL "solid: {}\n",
     "s.yaml:7:1: no key solid: a scene has title, radius, particles, domain"},
    {SSFR_ERR_FORMAT, TANK POOL "title: u\n", "s.yaml:7:1: title stands twice"},
    {SSFR_ERR_FORMAT, "radius: 1\n", "s.yaml:1:1: the scene: title must be given"},
    {SSFR_ERR_FORMAT, "title: t\nradius: 1\n", "s.yaml:1:1: the scene: particles must be given"},
    {SSFR_ERR_VALUE, "title: \"a\\nb\"\n", "s.yaml:1:8: title: expected one line"},
    {SSFR_ERR_VALUE, "title:\n", "title: expected one line"},
    {SSFR_ERR_VALUE, "radius: 0\n", "s.yaml:1:9: radius: 0 is out of range [1e-06, 1000] m"},
    {SSFR_ERR_VALUE, "radius: -0.02\n", "radius: -0.02 is out of range"},
    {SSFR_ERR_FORMAT, "radius: .nan\n", "s.yaml:1:9: radius: \".nan\" is not a finite number"},
    {SSFR_ERR_VALUE, "particles: 0\n", "particles: 0 is out of range [1, 3.35544e+07]"},
    {SSFR_ERR_VALUE, "particles: 1e12\n", "particles: 1e12 is out of range"},
    {SSFR_ERR_VALUE, "particles: 10.5\n", "particles: 10.5 is not a whole number"},
    {SSFR_ERR_VALUE, "duration: -1\n", "duration: -1 is out of range [0, 100000] s"},
    {SSFR_ERR_VALUE, TANK POOL "frame_rate: 0\n", "s.yaml:7:13: frame_rate: 0 is out of range"},
    {SSFR_ERR_VALUE, "title: t\nradius: 1\nparticles: 1\nduration: 1e5\nframe_rate: 1e4\ndomain: {}\n",
     "s.yaml:4:11: duration: 100000 s make 1000000001 frames, at most 100000"},
    {SSFR_ERR_VALUE, TANK POOL "frame_rate: 1e4\nrest_time: 1e5\n",
     "s.yaml:8:12: rest_time: 100000 s make 1000000000 frames, at most 100000"},
    {SSFR_ERR_FORMAT, TANK POOL "gravity: 9.81\n", "s.yaml:7:10: gravity: expected a list of 3 numbers"},
    {SSFR_ERR_FORMAT, TANK POOL "gravity: [0, -.inf, 0]\n", "s.yaml:7:14: gravity: \"-.inf\" is not a finite number"},
    {SSFR_ERR_FORMAT, TANK POOL "solver: {iteration: 3}\n", "s.yaml:7:10: solver: no key iteration: it has max_step"},
    {SSFR_ERR_VALUE, TANK POOL "solver: {iterations: -3}\n", "s.yaml:7:22: solver.iterations=-3: out of range"},
    {SSFR_ERR_FORMAT, TANK POOL "foam:\n", "foam: expected a map of key: value"},
    {SSFR_ERR_VALUE, TANK POOL "foam: {drag: fast}\n", "s.yaml:7:14: foam.drag=fast: expected a finite number"},
    {SSFR_ERR_VALUE, TANK POOL "foam: {energy_min: 1, energy_max: 0.5}\n", "s.yaml:7:7: "},
    {SSFR_ERR_FORMAT, TANK, "s.yaml:5:1: the scene has neither fluid nor emitters"},
    {SSFR_ERR_FORMAT, TANK "fluid: {}\n", "s.yaml:5:1: the scene has neither fluid nor emitters"},
    /* the domain */
    {SSFR_ERR_FORMAT, "title: t\nradius: 1\nparticles: 1\nduration: 1\ndomain: {lo: [0, 0, 0]}\n",
     "s.yaml:5:1: domain: hi must be given"},
    {SSFR_ERR_VALUE, "title: t\nradius: 1\nparticles: 1\nduration: 1\ndomain: {lo: [0, 0, 0], hi: [9, 9, -9]}\n",
     "s.yaml:5:1: domain: -9 m wide along z, a particle 2 m"},
    {SSFR_ERR_VALUE, "title: t\nradius: 1\nparticles: 1\nduration: 1\ndomain: {lo: [0, 0, 0], hi: [9, 1, 9]}\n",
     "s.yaml:5:1: domain: 1 m wide along y, a particle 2 m"},
    {SSFR_ERR_VALUE, "title: t\nradius: 1e-3\nparticles: 1\nduration: 1\ndomain: {lo: [0, 0, 0], hi: [1e4, 9, 9]}\n",
     "s.yaml:5:1: domain: 10000 m wide along x, at most 4194.3 m for a radius of 0.001 m"},
    {SSFR_ERR_VALUE, "domain: 1\nradius: 1e9\n", "s.yaml:2:9: radius: 1e9 is out of range"},
    {SSFR_ERR_VALUE,
     "title: t\nradius: 1\nparticles: 1\nduration: 1\ndomain: {lo: [0, 0, 0], hi: [9, 9, 9], open: [x]}\n",
     "s.yaml:5:47: open: \"x\" is none of -x, +x, -y, +y, -z, +z"},
    {SSFR_ERR_FORMAT,
     "title: t\nradius: 1\nparticles: 1\nduration: 1\ndomain: {lo: [0, 0, 0], hi: [9, 9, 9], open: [+x, -z, +x]}\n",
     "s.yaml:5:55: open: +x stands twice"},
    {SSFR_ERR_VALUE,
     EMITTER("centre: [0, 0, 0], direction: [1, 0, 0], radius: 1, speed: 1")
     "solids: {rock: {shape: box, centre: [0, 0, 0], size: [9, 9, 9]}}\n",
     "s.yaml:5:1: domain: the solids leave no room in it"},
    /* pools */
    {SSFR_ERR_FORMAT, TANK "fluid: [1]\n", "s.yaml:6:8: fluid: expected a map of key: value"},
    {SSFR_ERR_FORMAT, TANK "fluid: {p: 1}\n", "s.yaml:6:12: p: expected a map of key: value"},
    {SSFR_ERR_FORMAT, FLUID("lo: [0, 0, 0]"), "s.yaml:7:3: p: hi must be given"},
    {SSFR_ERR_FORMAT, FLUID("lo: [0, 0], hi: [1, 1, 1]"), "s.yaml:7:11: lo: expected a list of 3 numbers"},
    {SSFR_ERR_FORMAT, FLUID("lo: [0, 0, 0], hi: [1, 1, 1], heigth: 2"),
     "s.yaml:7:37: p: no key heigth: it has lo, hi, velocity, count"},
    {SSFR_ERR_VALUE, FLUID("lo: [0, 1, 0], hi: [1, 1, 1]"), "s.yaml:7:3: p: lo 1 m is not below hi 1 m along y"},
    {SSFR_ERR_VALUE, FLUID("lo: [0, 0, 0], hi: [1, 5, 1]"),
     "s.yaml:7:3: p: from 0 to 5 m along y, the domain goes from -4 to 4 m"},
    {SSFR_ERR_VALUE, FLUID("lo: [0, 0, 0], hi: [1, 1, 1], count: 0"), "s.yaml:7:44: count: 0 is out of range"},
    {SSFR_ERR_VALUE, FLUID("lo: [0, 0, 0], hi: [1, 1, 1], count: 1e9"), "count: 1e9 is out of range"},
    {SSFR_ERR_VALUE, FLUID("lo: [0, 0, 0], hi: [1, 1, 1], count: 1001"),
     "s.yaml:7:3: p: count: 1001, but there is room for 1000 at full scale"},
    {SSFR_ERR_VALUE, FLUID("lo: [0, 0, 0], hi: [4, 4, 4], count: 60000")
     "  q: {lo: [-4, 0, 0], hi: [0, 4, 4], count: 40001}\n",
     "s.yaml:8:3: q: pools of 100001 particles, the scene has 100000"},
    {SSFR_ERR_VALUE, FLUID("lo: [0, 0, 0], hi: [1, 0.09, 1]"),
     "s.yaml:7:3: p: no room for a particle of radius 0.05 m"},
    {SSFR_ERR_VALUE, FLUID("lo: [0, 0, 0], hi: [1, 1, 1]")
     "solids: {rock: {shape: sphere, centre: [0, 0, 0], radius: 2}}\n",
     "s.yaml:7:3: p: no room for a particle of radius 0.05 m"},
    {SSFR_ERR_VALUE, FLUID("lo: [0, 0, 0], hi: [1, 1, 1]") "  q: {lo: [0.9, 0, 0], hi: [2, 1, 1]}\n",
     "s.yaml:8:3: q: overlaps p"},
    {SSFR_ERR_VALUE,
     "title: t\nradius: 1e-3\nparticles: 10\nduration: 1\ndomain: {lo: [-4, -4, -4], hi: [4, 4, 4]}\n" POOL,
     "s.yaml:6:9: pool: room for 1.557e+08 particles of radius 0.001 m, at most 33554432"},
    /* emitters and sinks */
    {SSFR_ERR_FORMAT, EMITTER("direction: [1, 0, 0], radius: 1, speed: 1"), "s.yaml:7:3: e: centre must be given"},
    {SSFR_ERR_VALUE, EMITTER("centre: [0, 0, 0], direction: [1, 0, 0], radius: 1e7, speed: 1"),
     "s.yaml:7:3: e: room for 4.642e+16 particles"},
    {SSFR_ERR_VALUE, EMITTER("centre: [0, 0, 0], direction: [1, 0, 0], size: [1e7, 1e-6], speed: 1"),
     "s.yaml:7:3: e: room for 1.077e+08 particles"},
    {SSFR_ERR_FORMAT, EMITTER("centre: [0, 0, 0], direction: [1, 0, 0], speed: 1"),
     "s.yaml:7:3: e: either radius or size must be given"},
    {SSFR_ERR_FORMAT, EMITTER("centre: [0, 0, 0], direction: [1, 0, 0], speed: 1, radius: 1, size: [1, 1]"),
     "s.yaml:7:3: e: either radius or size must be given"},
    {SSFR_ERR_FORMAT, EMITTER("centre: [0, 0, 0], direction: [1, 0, 0], speed: 1, size: [1, 1, 1]"),
     "s.yaml:7:64: size: expected a list of 2 numbers"},
    {SSFR_ERR_VALUE, EMITTER("centre: [0, 0, 0], direction: [0, 0, 0], speed: 1, radius: 1"),
     "s.yaml:7:37: direction: a direction must not be 0"},
    {SSFR_ERR_VALUE, EMITTER("centre: [0, 0, 0], direction: [0, 1, 0], up: [0, 2, 0], speed: 1, radius: 1"),
     "s.yaml:7:3: e: up is along the direction"},
    {SSFR_ERR_VALUE, EMITTER("centre: [0, 0, 0], direction: [1, 0, 0], speed: 0, radius: 1"),
     "s.yaml:7:55: speed: 0 is out of range [0.001, 10000] m/s"},
    {SSFR_ERR_VALUE, EMITTER("centre: [0, 0, 0], direction: [1, 0, 0], speed: 1, radius: -1"),
     "radius: -1 is out of range"},
    {SSFR_ERR_VALUE, EMITTER("centre: [0, 0, 0], direction: [1, 0, 0], speed: 1, radius: 1, start: 2, stop: 2"),
     "s.yaml:7:3: e: stops at 2 s, starts at 2 s"},
    {SSFR_ERR_VALUE, EMITTER("centre: [0, 9, 0], direction: [1, 0, 0], speed: 1, radius: 1"),
     "s.yaml:7:3: e: starts at 9 m along y, the domain goes from -4 to 4 m"},
    {SSFR_ERR_UNKNOWN, EMITTER("centre: [0, 0, 0], direction: [1, 0, 0], speed: 1, radius: 1, motion: m"),
     "s.yaml:7:77: no motion m: there are none"},
    {SSFR_ERR_VALUE, TANK POOL "sinks: {d: {lo: [0, 0, 1], hi: [1, 1, 0]}}\n",
     "s.yaml:7:9: d: lo 1 m is not below hi 0 m along z"},
    {SSFR_ERR_FORMAT, TANK POOL "sinks: {d: {lo: [0, 0, 1]}}\n", "s.yaml:7:9: d: hi must be given"},
    /* solids */
    {SSFR_ERR_FORMAT, SOLID("centre: [0, 0, 0]"), "s.yaml:8:3: s: shape must be given"},
    {SSFR_ERR_FORMAT, SOLID("shape: [box]"), "s.yaml:8:14: shape: expected one value"},
    {SSFR_ERR_FORMAT, TANK POOL "solids: {s: box}\n", "s.yaml:7:13: s: expected a map of key: value"},
    {SSFR_ERR_UNKNOWN, SOLID("shape: cone"),
     "s.yaml:8:14: no shape cone: there are box, ramp, cylinder, tube, sphere, plane, mesh"},
    {SSFR_ERR_FORMAT, SOLID("shape: box, centre: [0, 0, 0]"), "s.yaml:8:3: s: size must be given"},
    {SSFR_ERR_FORMAT, SOLID("shape: box, centre: [0, 0, 0], radius: 1"),
     "s.yaml:8:38: s: no key radius: it has shape, motion, colour, friction, hidden, centre, size, turn_deg"},
    {SSFR_ERR_FORMAT, SOLID("shape: sphere, centre: [0, 0, 0], axis: [0, 1, 0]"), "s.yaml:8:41: s: no key axis"},
    {SSFR_ERR_VALUE, SOLID("shape: sphere, centre: [0, 0, 0], radius: 0"), "s.yaml:8:49: radius: 0 is out of range"},
    {SSFR_ERR_VALUE, SOLID("shape: box, centre: [0, 0, 0], size: [1, -1, 1]"), "s.yaml:8:48: size: -1 is out of range"},
    {SSFR_ERR_VALUE, SOLID("shape: cylinder, centre: [0, 0, 0], radius: 1, height: 1, axis: [0, 0, 0]"),
     "s.yaml:8:71: axis: a direction must not be 0"},
    {SSFR_ERR_VALUE, SOLID("shape: tube, centre: [2, 2, 2], radius: 0.1, inner: 0.1, height: 1"),
     "s.yaml:8:3: s: inner radius 0.1 m"},
    {SSFR_ERR_VALUE, SOLID("shape: sphere, centre: [2, 2, 2], radius: 1, friction: 1.1"),
     "s.yaml:8:62: friction: 1.1 is out of range [0, 1]"},
    {SSFR_ERR_VALUE, SOLID("shape: sphere, centre: [2, 2, 2], radius: 1, colour: [1, 2, 1]"),
     "colour: 2 is out of range"},
    {SSFR_ERR_FORMAT, SOLID("shape: sphere, centre: [2, 2, 2], radius: 1, hidden: 1"),
     "s.yaml:8:60: hidden: \"1\" is neither true nor false"},
    {SSFR_ERR_UNKNOWN, "motions: {wave: {keys: [{time: 0}]}, tip: {keys: [{time: 0}]}}\n"
     SOLID("shape: sphere, centre: [2, 2, 2], radius: 1, motion: tipp"),
     "s.yaml:9:60: no motion tipp: there are wave, tip"},
    {SSFR_ERR_IO, SOLID("shape: mesh, file: absent.obj"), "s.yaml:8:26: folder/absent.obj: No such file"},
    {SSFR_ERR_FORMAT, SOLID("shape: mesh"), "s.yaml:8:3: s: file must be given"},
    {SSFR_ERR_FORMAT, SOLID("shape: sphere, centre: [2, 2, 2], radius: 1}\n  s: {shape: box"),
     "s.yaml:9:3: s stands twice"},
    /* motions */
    {SSFR_ERR_FORMAT, MOTION("axis: [0, 1, 0]"), "s.yaml:8:3: m: keys must be given"},
    {SSFR_ERR_FORMAT, MOTION("keys: {time: 0}"), "s.yaml:8:13: keys: expected a list"},
    {SSFR_ERR_VALUE, MOTION("keys: []"), "s.yaml:8:13: keys: 0 of them, expected 1 to 1000"},
    {SSFR_ERR_FORMAT, MOTION("keys: [{turn_deg: 3}]"), "s.yaml:8:14: keys: time must be given"},
    {SSFR_ERR_VALUE, MOTION("keys: [{time: -1}]"), "s.yaml:8:21: time: -1 is out of range"},
    {SSFR_ERR_FORMAT, MOTION("keys: [{time: 0, turn: 3}]"),
     "s.yaml:8:24: keys: no key turn: it has time, move, turn_deg"},
    {SSFR_ERR_VALUE, MOTION("keys: [{time: 0}, {time: 2}, {time: 2}]"),
     "s.yaml:8:36: keys: 2 s does not come after 2 s"},
    {SSFR_ERR_VALUE, MOTION("period: 1.5, keys: [{time: 0}, {time: 2}]"),
     "s.yaml:8:3: m: a period of 1.5 s, the last key is at 2 s"},
    {SSFR_ERR_VALUE, MOTION("period: 3, keys: [{time: 0}, {time: 2, turn_deg: 350}]"),
     "s.yaml:8:3: m: its last key differs from the first, where it begins again"},
    {SSFR_ERR_VALUE, MOTION("period: 3, keys: [{time: 0, move: [0, 0, 1]}, {time: 2}]"),
     "s.yaml:8:3: m: its last key differs from the first"},
    {SSFR_ERR_VALUE, MOTION("period: 0, keys: [{time: 0}]"), "s.yaml:8:15: period: 0 is out of range"},
    {SSFR_ERR_VALUE, MOTION("easing: wobbly, keys: [{time: 0}]"),
     "s.yaml:8:15: easing: \"wobbly\" is none of smooth, linear"},
    {SSFR_ERR_VALUE, MOTION("axis: [0, 0, 0], keys: [{time: 0}]"), "s.yaml:8:13: axis: a direction must not be 0"},
    /* cameras */
    {SSFR_ERR_FORMAT, CAMERA("eye: [0, 0, 1]"), "s.yaml:8:3: c: eye and target must be given"},
    {SSFR_ERR_FORMAT, CAMERA("target: [0, 0, 1], keys: [{time: 0, eye: [1, 2, 3]}, {time: 1}]"),
     "s.yaml:8:60: keys: eye and target must be given, here or for all"},
    {SSFR_ERR_VALUE, CAMERA("eye: [1, 2, 3], target: [1, 2, 3]"), "s.yaml:8:3: c: at 0 s the eye is at its target"},
    {SSFR_ERR_VALUE, CAMERA("eye: [1, 2, 3], target: [1, 0, 3]"), "s.yaml:8:3: c: at 0 s the view is along up"},
    {SSFR_ERR_VALUE, CAMERA("eye: [1, 2, 3], target: [0, 0, 0], fov_deg: 180"),
     "fov_deg: 180 is out of range [0.001, 179] deg"},
    {SSFR_ERR_VALUE, CAMERA("target: [0, 0, 0], keys: []"), "s.yaml:8:32: keys: 0 of them, expected 1 to 1000"},
    {SSFR_ERR_VALUE, CAMERA("target: [0, 0, 0], eye: [0, 0, 3], keys: [{time: 1}, {time: 0.5}]"),
     "s.yaml:8:60: keys: 0.5 s does not come after 1 s"},
    {SSFR_ERR_VALUE, CAMERA("target: [0, 0, 0], keys: [{time: 0, eye: [0, 0, 3]}, {time: 2, eye: [0, 0, 0]}]"),
     "s.yaml:8:3: c: at 2 s the eye is at its target"},
    {SSFR_ERR_VALUE, CAMERA("target: [0, 0, 0], keys: [{time: 0, eye: [0, 0, 3]}, {time: 1, eye: [0, 0, -3]}]"),
     "s.yaml:8:3: c: at 0.5 s the eye is at its target"},
    {SSFR_ERR_VALUE, CAMERA("target: [0, 0, 0], eye: [0, 0, 3], keys: [{time: 0, fov_deg: 2}, {time: 0.5, fov_deg: 2},"
                            " {time: 0.6, fov_deg: 170}, {time: 2, fov_deg: 2}]"),
     "the field of view has no sensible angle"},
    /* how it looks */
    {SSFR_ERR_FORMAT, TANK POOL "light: {elevation: 3}\n", "s.yaml:7:9: light: no key elevation: it has azimuth_deg"},
    {SSFR_ERR_VALUE, TANK POOL "light: {elevation_deg: 91}\n",
     "s.yaml:7:24: light.elevation_deg=91: out of range [-90, 90]"},
    {SSFR_ERR_FORMAT, TANK POOL "set: {iterations: 3}\n",
     "s.yaml:7:7: iterations: expected a parameter such as pass.param"},
    {SSFR_ERR_FORMAT, TANK POOL "set: {curvature_flow.iterations: [3]}\n",
     "s.yaml:7:34: curvature_flow.iterations: expected one value"},
    {SSFR_ERR_VALUE, TANK POOL "set: {curvature_flow.iterations: -3}\n",
     "s.yaml:7:34: curvature_flow.iterations=-3: out of range"},
    {SSFR_ERR_UNKNOWN, TANK POOL "set: {curvature_flow.iteration: 3}\n",
     "s.yaml:7:7: curvature_flow.iteration: no pass has this parameter"},
    {SSFR_ERR_UNKNOWN, TANK POOL "set: {waves.height: 3}\n", "s.yaml:7:7: waves.height: no pass has this parameter"},
    {SSFR_ERR_VALUE, TANK POOL "set: {medium.ior: 0.1}\n", "s.yaml:7:19: medium.ior=0.1: out of range"},
    {SSFR_ERR_FORMAT, TANK POOL "floor_height: nowhere\n",
     "s.yaml:7:15: floor_height: \"nowhere\" is not a finite number"},
    {SSFR_ERR_IO, TANK POOL "environment: absent.exr\n", "s.yaml:7:14: environment: folder/absent.exr: No such file"},
    {SSFR_ERR_IO, TANK POOL "background: /tmp\n", "s.yaml:7:13: background: /tmp: not a regular file"},
    {SSFR_ERR_FORMAT, TANK POOL "solids: &s {a: *s}\n", "a: shape must be given"},
    {SSFR_ERR_FORMAT, TANK POOL "solids: {a: *s}\n", "s.yaml:7:13: found undefined alias *s"},
};

static void what_is_wrong_is_told_with_its_place(void **state)
{
    (void)state;
    for (size_t i = 0; i < SSFR_COUNT(wrong); i++) {
        ssfr_description *d = NULL;
        assert_fails(wrong[i].code, ssfr_description_parse(&d, "folder/s.yaml", wrong[i].text, SSFR_SCALE_FULL, NULL),
                     wrong[i].message);
        assert_int_equal(strncmp(test_last_error(), "folder/s.yaml:", 14), 0);
        assert_null(d);
    }
}

static void malformed_meshes_and_files_are_refused(void **state)
{
    (void)state;
    static const char open[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char tip[] = "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nv 0 0 1000\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    static const char scene[] = SOLID("shape: mesh, file: open.obj");
    static const char huge[] = SOLID("shape: mesh, file: huge.obj, scale: 1e5");
    static const char binary[] = "title: t\0\nradius: 1\n";
    ssfr_description *d = NULL;
    char *big = NULL;
    const char *path = test_path("wrong.yaml");
    test_write_file(test_path("open.obj"), open, sizeof open - 1);
    test_write_file(test_path("huge.obj"), tip, sizeof tip - 1);
    test_write_file(path, scene, sizeof scene - 1);
    test_clear_log();
    assert_int_not_equal(ssfr_description_load(&d, path, SSFR_SCALE_FULL), SSFR_OK);
    test_assert_logged("wrong.yaml:8:26: ", __FILE__, __LINE__);
    test_assert_logged("open.obj", __FILE__, __LINE__);
    test_write_file(path, huge, sizeof huge - 1);
    assert_fails(SSFR_ERR_VALUE, ssfr_description_load(&d, path, SSFR_SCALE_FULL), "wrong.yaml:8:26: ");
    test_write_file(path, binary, sizeof binary - 1);
    assert_fails(SSFR_ERR_FORMAT, ssfr_description_load(&d, path, SSFR_SCALE_FULL),
                 "wrong.yaml:1:9: byte 8: control characters");
    assert_int_equal(ssfr_alloc(&big, 1 << 21, 1, "a text"), SSFR_OK);
    memset(big, '#', 1 << 21);
    test_write_file(path, big, 1 << 21);
    free(big);
    assert_fails(SSFR_ERR_VALUE, ssfr_description_load(&d, path, SSFR_SCALE_FULL), "2097152 bytes, at most 1048576");
    assert_fails(SSFR_ERR_IO, ssfr_description_load(&d, test_path("absent.yaml"), SSFR_SCALE_FULL), "absent.yaml");
    assert_fails(SSFR_ERR_IO, ssfr_description_load(&d, "/tmp", SSFR_SCALE_FULL), "/tmp: not a regular file");
    assert_null(d);
}

/* Parses what may be anything: it gives a scene, or one line; that it was a scene. */
static bool survives(const char *text)
{
    ssfr_description *d = NULL;
    test_clear_log();
    const ssfr_result result = ssfr_description_parse(&d, "s.yaml", text, SSFR_SCALE_QUICK, NULL);
    assert_int_equal(result == SSFR_OK, d != NULL);
    assert_int_equal(test_n_errors(), result == SSFR_OK ? 0 : 1);
    for (int i = 0; d && i < d->n_bodies; i++) assert_true(isfinite(ssfr_body_at(d, &d->bodies[i], 0.7).axis[0][0]));
    const bool read = d != NULL;
    ssfr_description_destroy(&d);
    return read;
}

static void a_scene_cut_at_any_byte_gives_a_scene_or_an_error(void **state)
{
    (void)state;
    char text[sizeof whole];
    int n_read = 0;
    for (size_t n = 0; n < sizeof whole; n++) {
        memcpy(text, whole, n);
        text[n] = '\0';
        n_read += survives(text);
    }
    assert_true(n_read > 10 && n_read < (int)sizeof whole / 2);
}

/* A byte of any place becomes an odd one, or a digit another. */
static void change(char *text, uint64_t *random)
{
    static const char odd[] = "0123456789.-+e:,[]{}&*!|>'\"#%@`?~ \n\t\\abz\x80\xc3\xff";
    const bool digits = test_random(random, 0, 1) < 0.5;
    size_t at = (size_t)test_random(random, 0, sizeof whole - 1);
    while (digits && !(text[at] >= '0' && text[at] <= '9')) at = (at + 1) % (sizeof whole - 1);
    text[at] = odd[(size_t)test_random(random, 0, digits ? 10 : sizeof odd - 1)];
}

static void a_scene_with_any_bytes_changed_gives_a_scene_or_an_error(void **state)
{
    (void)state;
    enum { TRIES = 1500 };
    uint64_t random = 2385;
    int n_read = 0;
    for (int i = 0; i < TRIES; i++) {
        char text[sizeof whole];
        memcpy(text, whole, sizeof whole);
        for (int n = 1 + (int)test_random(&random, 0, 3); n > 0; n--) change(text, &random);
        n_read += survives(text);
    }
    assert_true(n_read > TRIES / 20 && n_read < TRIES);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_whole_scene_is_read),
        cmocka_unit_test(its_parts_are_read),
        cmocka_unit_test(settings_of_groups_and_passes_keep_their_place),
        cmocka_unit_test(quick_has_fewer_and_larger_particles),
        cmocka_unit_test(what_is_not_said_has_the_documented_default),
        cmocka_unit_test(the_ground_is_the_domains_bottom_unless_that_is_open),
        cmocka_unit_test(frames_are_counted_up_to_the_duration),
        cmocka_unit_test(the_documented_scenes_are_scenes),
        cmocka_unit_test(every_key_is_documented),
        cmocka_unit_test(a_smooth_motion_is_at_its_keys_and_half_way_between_at_half_time),
        cmocka_unit_test(a_smooth_motion_rests_at_its_keys),
        cmocka_unit_test(a_linear_motion_has_one_speed_and_a_period_repeats_it),
        cmocka_unit_test(a_motion_that_waits_for_its_period_stands_in_between),
        cmocka_unit_test(a_body_turns_about_the_axis_through_its_pivot_and_then_moves),
        cmocka_unit_test(turns_about_any_axis_keep_lengths_and_angles),
        cmocka_unit_test(an_emitter_goes_with_its_motion),
        cmocka_unit_test(a_camera_of_one_key_stands),
        cmocka_unit_test(a_camera_of_two_keys_goes_straight),
        cmocka_unit_test(a_path_is_the_natural_cubic_spline_through_its_keys),
        cmocka_unit_test(a_path_goes_through_its_keys_without_a_jump_in_speed_or_acceleration),
        cmocka_unit_test(a_camera_is_found_by_name),
        cmocka_unit_test(solids_are_where_they_are_put),
        cmocka_unit_test(meshes_of_built_in_scenes_come_from_their_loader),
        cmocka_unit_test(as_many_solids_are_taken_as_can_be_drawn_hidden_or_not),
        cmocka_unit_test(a_full_pool_has_the_density_of_rest),
        cmocka_unit_test(a_pool_that_fits_to_the_last_digit_is_full),
        cmocka_unit_test(a_count_fills_from_below),
        cmocka_unit_test(solids_keep_their_room_at_time_0),
        cmocka_unit_test(pools_are_filled_in_their_order_up_to_the_scenes_particles),
        cmocka_unit_test(filling_gives_the_same_bits_for_any_number_of_threads),
        cmocka_unit_test(a_scene_of_emitters_alone_is_empty_at_first),
        cmocka_unit_test(what_is_wrong_is_told_with_its_place),
        cmocka_unit_test(malformed_meshes_and_files_are_refused),
        cmocka_unit_test(a_scene_cut_at_any_byte_gives_a_scene_or_an_error),
        cmocka_unit_test(a_scene_with_any_bytes_changed_gives_a_scene_or_an_error),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_play.c: which frames are played before a drawn one, and that it then has the bits of a run over them all. */
#include "tests/util.h"

#include "experiments/play.h"
#include "experiments/rig.h"
#include "experiments/scenes/make.h"
#include "experiments/setup.h"

enum { DRAWN = 8, MOST = 200 };

/* It turns to foam as it falls and fades when it has come to rest. */
static const char drop[] =
    "title: A drop falls\nradius: 0.05\nparticles: 100\nduration: 0.5\nframe_rate: 20\n"
    "domain: {lo: [0, 0, 0], hi: [1, 1, 1]}\nfluid: {drop: {lo: [0.3, 0.3, 0.3], hi: [0.6, 0.6, 0.6]}}\n"
    "set: {weber_foam.threshold: 300, weber_foam.fade_in_min: 0.02, weber_foam.fade_in_max: 0.1,\n"
    "      weber_foam.lifetime: 0.1, weber_foam.lifetime_share_max: 1}\n";
/* Of these fades: 0.2 s at 20 frames a second, and one frame for the lag. */
enum { BY_DEFAULT = 5 };

static ssfr_stage_options options_of(const char *play)
{
    static const char *cache;
    ssfr_stage_options options;
    ssfr_stage_defaults(&options);
    if (!cache) cache = test_path("frames");
    options.cache = cache;
    options.scale = SSFR_SCALE_FULL;
    options.frame = DRAWN;
    options.size[0] = options.size[1] = 32;
    options.play = play;
    return options;
}

static const char *scene_file(void)
{
    const char *path = test_path("drop.yaml");
    test_write_file(path, drop, sizeof drop - 1);
    return path;
}

static int remove_frames(void **state)
{
    (void)state;
    char command[256];
    snprintf(command, sizeof command, "rm -rf '%s'", options_of(NULL).cache);
    return system(command);
}

/* ---- a frame's foam ---------------------------------------------------------------------------------------------- */

typedef struct foam {
    size_t n;
    float foam[MOST], lifetime[MOST];
} foam;

typedef struct fixture {
    ssfr_stage *stage;
    ssfr_graph *graph;
} fixture;

static fixture begin(const char *pipeline)
{
    const ssfr_stage_options options = options_of(NULL);
    fixture f;
    assert_int_equal(ssfr_stage_create(&f.stage, scene_file(), &options), SSFR_OK);
    assert_int_equal(ssfr_graph_create(&f.graph, ssfr_pipeline_find(pipeline), NULL), SSFR_OK);
    assert_int_equal(ssfr_setup_apply_scene(f.graph, f.stage->description), SSFR_OK);
    return f;
}

static void end(fixture *f)
{
    ssfr_graph_destroy(&f->graph);
    ssfr_stage_destroy(&f->stage);
}

static void show(fixture *f, long frame)
{
    const ssfr_stage_options options = options_of(NULL);
    assert_int_equal(ssfr_stage_show(f->stage, &options, frame), SSFR_OK);
}

static foam read(const ssfr_graph *graph)
{
    foam out = {0};
    const float *foam, *lifetime;
    size_t n;
    assert_int_equal(ssfr_graph_read_values(graph, "foam", &out.n, &foam), SSFR_OK);
    assert_int_equal(ssfr_graph_read_values(graph, "lifetime", &n, &lifetime), SSFR_OK);
    assert_true(out.n <= MOST && n <= MOST);
    for (size_t i = 0; i < out.n; i++) out.foam[i] = foam[i];
    for (size_t i = 0; i < n; i++) out.lifetime[i] = lifetime[i];
    return out;
}

static foam draw(fixture *f)
{
    assert_int_equal(ssfr_graph_run(f->graph, &f->stage->scene, NULL), SSFR_OK);
    return read(f->graph);
}

/* The foam of the frame DRAWN when all from `first` on are drawn, every `step`. */
static foam drawn_from(long first, long step)
{
    fixture f = begin("bagar2010");
    foam out = {0};
    for (long frame = first; frame <= DRAWN; frame += step) {
        show(&f, frame);
        out = draw(&f);
    }
    end(&f);
    return out;
}

static void play(fixture *f, const char *play, long since)
{
    const ssfr_stage_options options = options_of(play);
    const ssfr_particles *shown = f->stage->particles;
    assert_int_equal(ssfr_play(f->graph, f->stage, &options, since), SSFR_OK);
    assert_ptr_equal(f->stage->particles, shown);
}

static bool is_same(const foam *a, const foam *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/* ---- no time ----------------------------------------------------------------------------------------------------- */

/* Fades do not go on in it. */
static void frames_of_one_time_are_played_too(void **state)
{
    (void)state;
    ssfr_stage_options options = options_of(NULL);
    ssfr_stage *stage = NULL;
    ssfr_graph *graph = NULL;
    foam of[2];
    options.frame = -1;
    assert_int_equal(ssfr_stage_create(&stage, "pause", &options), SSFR_OK);
    assert_true(stage->n_frames == 2 && stage->frame == 1 && stage->time == 0 && stage->scene.timed);
    assert_int_equal(ssfr_graph_create(&graph, ssfr_pipeline_find("bagar2010"), NULL), SSFR_OK);
    for (int k = 0; k < 2; k++) {
        assert_int_equal(ssfr_graph_set(graph, "weber.lag", "0"), SSFR_OK);
        assert_int_equal(ssfr_graph_set(graph, "weber.start", "water"), SSFR_OK);
        assert_int_equal(ssfr_graph_set(graph, "weber.threshold", "1000"), SSFR_OK);
        assert_int_equal(ssfr_graph_set(graph, "weber.fade_in_min", k ? "0.25" : "0"), SSFR_OK);
        assert_int_equal(ssfr_graph_set(graph, "weber.fade_in_max", k ? "0.5" : "0"), SSFR_OK);
        assert_int_equal(ssfr_play(graph, stage, &options, -1), SSFR_OK);
        assert_int_equal(ssfr_graph_run(graph, &stage->scene, NULL), SSFR_OK);
        const float *foam;
        size_t n;
        assert_int_equal(ssfr_graph_read_values(graph, "foam", &n, &foam), SSFR_OK);
        of[k] = (struct foam){.n = n, .foam = {foam[0]}};
    }
    assert_true(of[0].n == 1600 && of[0].foam[0] == 1); /* a fade of no time is over in no time */
    assert_true(of[1].foam[0] == 0);
    ssfr_graph_destroy(&graph);
    ssfr_stage_destroy(&stage);
}

/* ---- what is played ---------------------------------------------------------------------------------------------- */

static void a_frame_after_playing_has_the_bits_of_a_run_over_them_all(void **state)
{
    (void)state;
    static const struct {
        const char *play;
        long first;
    } cases[] = {{"all", 0},       {"none", DRAWN}, {"0", DRAWN},       {"1", DRAWN - 1}, {"3", DRAWN - 3},
                 {"8", 0},         {"100", 0},      {"999999999", 0},   {NULL, DRAWN - BY_DEFAULT}};
    foam of[DRAWN + 1];
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        fixture f = begin("bagar2010");
        play(&f, cases[i].play, -1);
        const foam alone = draw(&f), expected = of[cases[i].first] = drawn_from(cases[i].first, 1);
        assert_true(is_same(&alone, &expected));
        end(&f);
    }
    assert_false(is_same(&of[0], &of[DRAWN])); /* or it would not matter */
    assert_false(is_same(&of[DRAWN - 1], &of[DRAWN - 3]));
}

static void history_goes_on_from_the_frame_drawn_before(void **state)
{
    (void)state;
    static const struct {
        const char *play;
        long since, first, step; /* the run that it is like */
    } cases[] = {{"all", 4, 0, 1},  {"all", 7, 0, 1},  {NULL, 4, 0, 1},
                 {"3", 4, 0, 1},                 /* whose first follows frame 4 */
                 {"2", 4, DRAWN - 2, 1},         /* whose first does not */
                 {"none", 4, 0, 4}};             /* drawn frames alone */
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        fixture f = begin("bagar2010");
        for (long frame = 0; frame <= cases[i].since; frame += cases[i].step) {
            show(&f, frame);
            play(&f, cases[i].play, frame - cases[i].step < 0 ? -1 : frame - cases[i].step);
            draw(&f);
        }
        show(&f, DRAWN);
        play(&f, cases[i].play, cases[i].since);
        const foam went_on = draw(&f), expected = drawn_from(cases[i].first, cases[i].step);
        assert_true(is_same(&went_on, &expected));
        end(&f);
    }
}

static char *fluid_file(const fixture *f, int frame)
{
    char *path;
    assert_int_equal(ssfr_make_path(f->stage->folder, frame, false, &path), SSFR_OK);
    return path;
}

/* It would fail where it read the frame that is not there. */
static void what_has_been_seen_or_has_no_history_is_not_played(void **state)
{
    (void)state;
    const ssfr_stage_options all = options_of("all");
    fixture f = begin("bagar2010"), plain = begin("vanderlaan2009");
    char *path = fluid_file(&f, 2), *aside = fluid_file(&f, 99);
    play(&f, "all", -1);
    const foam first = draw(&f);
    assert_int_equal(rename(path, aside), 0);
    play(&f, "all", -1);
    const foam again = draw(&f);
    assert_true(is_same(&first, &again));
    play(&plain, "all", -1);
    ssfr_graph_restart(f.graph);
    assert_fails(SSFR_ERR_IO, ssfr_play(f.graph, f.stage, &all, -1), "fluid_0002.h5");
    assert_int_equal(ssfr_graph_set(f.graph, "weber.off", "1"), SSFR_OK);
    play(&f, "all", -1);
    assert_int_equal(rename(aside, path), 0);
    free(path), free(aside);
    end(&f), end(&plain);
}

static void a_scene_of_one_picture_has_nothing_to_play(void **state)
{
    (void)state;
    ssfr_stage_options options;
    ssfr_stage *stage;
    ssfr_graph *graph;
    ssfr_stage_defaults(&options);
    options.play = "all";
    assert_int_equal(ssfr_stage_create(&stage, "splash", &options), SSFR_OK);
    assert_int_equal(ssfr_graph_create(&graph, ssfr_pipeline_find("bagar2010"), NULL), SSFR_OK);
    assert_int_equal(ssfr_play(graph, stage, &options, -1), SSFR_OK);
    assert_true(isnan(ssfr_stage_time(stage, 3)));
    ssfr_graph_destroy(&graph);
    ssfr_stage_destroy(&stage);
}

static void a_radius_that_is_given_holds_for_what_is_played(void **state)
{
    (void)state;
    ssfr_stage_options options = options_of("all");
    fixture f = begin("bagar2010");
    ssfr_particles *fluid;
    options.radius = 0.04;
    assert_int_equal(ssfr_stage_read(f.stage, &options, 3, &fluid), SSFR_OK);
    assert_close(fluid->radius, 0.04, 0, 0);
    assert_close(f.stage->particles->radius, 0.05, 0, 1e-6);
    ssfr_particles_destroy(&fluid);
    end(&f);
}

static void what_play_says_is_checked(void **state)
{
    (void)state;
    static const char *const good[] = {NULL, "all", "none", "0", "24"};
    static const char *const bad[] = {"", "-1", "1.5", "some", "all ", "1000000000", "99999999999999999999", "+3"};
    for (size_t i = 0; i < SSFR_COUNT(good); i++) {
        const ssfr_stage_options options = options_of(good[i]);
        assert_int_equal(ssfr_play_check(&options), SSFR_OK);
    }
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) {
        const ssfr_stage_options options = options_of(bad[i]);
        fixture f = begin("bagar2010");
        assert_fails(SSFR_ERR_VALUE, ssfr_play_check(&options), "expected a number of frames, all or none");
        assert_fails(SSFR_ERR_VALUE, ssfr_play(f.graph, f.stage, &options, -1), "expected a number of frames");
        end(&f);
    }
}

/* ---- sweeps ------------------------------------------------------------------------------------------------------ */

static foam of_a_run(ssfr_rig *rig, const ssfr_sweep_spec *spec, size_t i, double *flip)
{
    size_t index[SSFR_MAX_AXES];
    ssfr_rig_row row;
    ssfr_sweep_spec_run(spec, i, index);
    assert_int_equal(ssfr_rig_run(rig, index, &row), SSFR_OK);
    *flip = row.values[SSFR_COLUMN_ref_flip];
    return read(ssfr_rig_graph(rig));
}

/* Settings of other passes play nothing anew; those of the foam do. */
static void the_runs_of_a_sweep_are_of_a_frame_after_playing(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec;
    ssfr_rig *rig;
    assert_int_equal(ssfr_sweep_spec_create(&spec), SSFR_OK);
    char scene[160];
    snprintf(scene, sizeof scene, "scene=%s", scene_file());
    const char *const axes[] = {"pipeline=bagar2010", scene, "size=32x32", "backend=cpu", "weber.threshold=300,600",
                                "sparse.by_foam=1,0"};
    for (size_t i = 0; i < SSFR_COUNT(axes); i++)
        assert_int_equal(ssfr_sweep_spec_vary_text(spec, "--vary", axes[i]), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_reference_text(spec, "", "sparse.by_foam=1"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    const ssfr_rig_options options = {.spec = spec, .stage = options_of("all"), .measure = {.min_runs = 2},
                                      .bandwidth_gl = NAN, .bandwidth_cpu = NAN};
    assert_int_equal(ssfr_rig_create(&rig, &options), SSFR_OK);
    const foam expected = drawn_from(0, 1);
    for (size_t i = 0; i < 4; i++) {
        double flip;
        const foam run = of_a_run(rig, spec, i, &flip);
        assert_true(is_same(&run, &expected) == (i < 2));
        assert_true((flip == 0) == (i == 0)); /* the reference is played too */
    }
    ssfr_rig_destroy(&rig);
    ssfr_sweep_spec_destroy(&spec);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_of_one_time_are_played_too),
        cmocka_unit_test(a_frame_after_playing_has_the_bits_of_a_run_over_them_all),
        cmocka_unit_test(history_goes_on_from_the_frame_drawn_before),
        cmocka_unit_test(what_has_been_seen_or_has_no_history_is_not_played),
        cmocka_unit_test(a_scene_of_one_picture_has_nothing_to_play),
        cmocka_unit_test(a_radius_that_is_given_holds_for_what_is_played),
        cmocka_unit_test(what_play_says_is_checked),
        cmocka_unit_test(the_runs_of_a_sweep_are_of_a_frame_after_playing),
    };
    return cmocka_run_group_tests(tests, test_capture_log, remove_frames);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_bench_integrators.c: studies of integrators: what their files may hold, and which rays are chosen. What is
 * measured is in test_bench_integrators.sh. */
#include "experiments/bench_integrators.h"
#include "tests/util.h"

#define HEAD "title: A\nscenes: [block]\n"
#define TAIL "integrators: [gauss]\npoints: [4]\ndensity: {deep: {}}\n"

static ssfr_result read_text(ssfr_study *study, const char *text)
{
    return ssfr_study_read(study, "s.yaml", text, strlen(text));
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static void the_built_in_study_has_every_integrator(void **state)
{
    (void)state;
    ssfr_study study;
    char *text;
    assert_int_equal(ssfr_study_load(&study, NULL, &text), SSFR_OK);
    assert_non_null(strstr(text, study.title));
    assert_string_equal(study.scenes[0], "splash");
    for (int id = 0; id < SSFR_N_INTEGRATORS; id++) assert_true(study.integrators[id]);
    for (int k = 0; k < SSFR_N_STUDY_INTEGRALS; k++) {
        assert_int_equal(study.n_kinds[k], 4);
        assert_string_equal(study.kinds[k][0].name, "smooth");
        assert_string_equal(study.kinds[k][2].name, "dense");
        assert_true(study.kinds[k][2].most);
    }
    assert_close(study.steps.values[0], 16, 0, 0);
    assert_close(study.steps.values[study.steps.n - 1], 4096, 0, 0);
    for (size_t i = 1; i < study.steps.n; i++) assert_close(study.steps.values[i], 2 * study.steps.values[i - 1], 0, 0);
    free(text);
    ssfr_study_finish(&study);
}

static void a_study_has_what_its_file_says(void **state)
{
    (void)state;
    ssfr_study study;
    assert_int_equal(read_text(&study, HEAD "size: [320, 180]\nfluid: {kind: spheres, size: 2.385}\n"
                                            "extinction: {support: 3}\ncandidates: 77\ntolerances: [0.1, 1e-9]\n"
                                            "integrators: [gauss, chords]\npoints: [3, 5]\n"
                                            "density: {rim: {count: 3, content: [0.1, 2.385]}}\n"
                                            "radiance: {most: {order: most, regions: [1, 2]}}\n"), SSFR_OK);
    assert_close(study.size[1], 180, 0, 0);
    assert_int_equal(study.fluid.kind, SSFR_CONTINUUM_SPHERES);
    assert_close(study.fluid.size, 2.385, 0, 0);
    assert_close(study.extinction.support, 3, 0, 0);
    assert_int_equal(study.candidates, 77);
    assert_false(study.integrators[SSFR_INTEGRATOR_qagp]);
    const ssfr_ray_kind *rim = &study.kinds[SSFR_STUDY_DENSITY][0], *most = &study.kinds[SSFR_STUDY_RADIANCE][0];
    assert_true(rim->count == 3 && !rim->most && rim->content[1] == 2.385 && isinf(rim->regions[1]));
    assert_true(most->most && most->count == 16 && most->regions[0] == 1 && most->regions[1] == 2);

    const ssfr_study_numbers points = ssfr_study_settings(&study, SSFR_STUDY_DENSITY, SSFR_INTEGRATOR_gauss);
    assert_true(points.n == 2 && points.values[1] == 5);
    const ssfr_study_numbers none = ssfr_study_settings(&study, SSFR_STUDY_DENSITY, SSFR_INTEGRATOR_chords);
    assert_true(none.n == 1 && isnan(none.values[0])); /* a closed form is asked for nothing */
    assert_int_equal(ssfr_study_settings(&study, SSFR_STUDY_RADIANCE, SSFR_INTEGRATOR_chords).n, 2);
    ssfr_study_finish(&study);
}

static const struct {
    const char *text, *error;
} bad[] = {
    {"", "s.yaml"},
    {"scenes: [block]\n" TAIL, "title must be given"},
    {"title: A\n" TAIL, "scenes must be given"},
    {HEAD "points: [4]\ndensity: {deep: {}}\n", "integrators must be given"},
    {HEAD "integrators: [gauss]\npoints: [4]\n", "s.yaml:1:1: density or radiance must be given"},
    {HEAD "integrators: [steps]\ndensity: {deep: {}}\n", "s.yaml:3:14: steps needs steps"},
    {HEAD "integrators: [gauss]\ndensity: {deep: {}}\n", "gauss needs points"},
    {HEAD "integrators: [qags]\ndensity: {deep: {}}\n", "qags needs tolerances"},
    {HEAD "integrators: [chords]\nradiance: {deep: {}}\n", "chords needs tolerances"},
    {HEAD "integrators: [simpson]\n", "s.yaml:3:15: integrators: \"simpson\" is none of chords, qags"},
    {HEAD "integrators: [gauss, gauss]\n", "gauss stands twice"},
    {"title: A\nscenes: []\n", "scenes: 0 values, there are 1 to 8"},
    {"title: A\nscenes: [a, b, c, d, e, f, g, h, i]\n", "scenes: 9 values"},
    {"title: A\nscenes: splash\n", "s.yaml:2:9: scenes"},
    {HEAD "size: [0, 5]\n", "s.yaml:3:8: size: 0 is out of range"},
    {HEAD "size: 5\n", "size: expected a list of 2 numbers"},
    {HEAD "points: [3.5]\n", "points: 3.5 is not a whole number"},
    {HEAD "points: [65]\n", "points: 65 is out of range [1, 64]"},
    {HEAD "points: [four]\n", "\"four\" is not a finite number"},
    {HEAD "steps: []\n", "steps: 0 values"},
    {HEAD "tolerances: [0]\n", "tolerances: 0 is out of range"},
    {HEAD "candidates: 0\n", "candidates: 0 is out of range"},
    {HEAD "fluid: {kind: solid}\n", "s.yaml:3:15: fluid.kind=solid"},
    {HEAD "extinction: {depth: 3}\n", "extinction: no key depth"},
    {HEAD "density: 5\n", "s.yaml:3:10: density"},
    {HEAD "density: {a: {}, b: {}, c: {}, d: {}, e: {}}\n", "s.yaml:3:39: density: more than 4 kinds of rays"},
    {HEAD "density: {a: {}, a: {}}\n", "s.yaml:3:18"},
    {HEAD "density: {a: {count: 0}}\n", "count: 0 is out of range [1, 256]"},
    {HEAD "density: {a: {content: [3, 2.385]}}\n", "s.yaml:3:24: content: from 3 to 2.385 there is nothing"},
    {HEAD "density: {a: {order: few}}\n", "order: \"few\" is none of random, most"},
    {HEAD "density: {a: {colour: red}}\n", "a: no key colour: it has count, content"},
    {HEAD "radiance: {a: [1]}\n", "s.yaml:3:15: a"},
    {HEAD "depth: 3\n", "no key depth: a study has title, scenes"},
};

static void bad_studies_are_refused_in_one_line_with_their_place(void **state)
{
    (void)state;
    ssfr_study study;
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) {
        test_clear_log();
        assert_int_not_equal(read_text(&study, bad[i].text), SSFR_OK);
        test_assert_logged(bad[i].error, __FILE__, __LINE__);
    }
    char *text;
    assert_fails(SSFR_ERR_IO, ssfr_study_load(&study, test_path("absent.yaml"), &text), "absent.yaml");
    ssfr_study_finish(&study);
    free(text);
}

static void a_study_that_is_cut_off_anywhere_is_read_or_refused(void **state)
{
    (void)state;
    ssfr_study study;
    char *text;
    assert_int_equal(ssfr_study_load(&study, NULL, &text), SSFR_OK);
    ssfr_study_finish(&study);
    const size_t size = strlen(text);
    size_t refused = 0;
    for (size_t n = 0; n < size; n += 7) {
        test_clear_log();
        const ssfr_result result = ssfr_study_read(&study, "s.yaml", text, n);
        if (result == SSFR_OK) ssfr_study_finish(&study);
        else test_assert_logged("s.yaml", __FILE__, __LINE__);
        refused += result != SSFR_OK;
    }
    assert_true(refused > size / 14);
    free(text);
}

/* ---- rays -------------------------------------------------------------------------------------------------------- */

static const ssfr_study_ray candidates[] = {
    {.n_kernels = 5, .content = 1, .regions = 1}, {.n_kernels = 9, .content = 3, .regions = 1},
    {.n_kernels = 9, .content = 2, .regions = 2}, {.n_kernels = 0, .content = 0, .regions = 0},
    {.n_kernels = 7, .content = 2.385, .regions = 1},
};

static size_t choose(const ssfr_ray_kind *kind, ssfr_study_ray *rays)
{
    size_t n;
    assert_int_equal(ssfr_study_choose(kind, SSFR_COUNT(candidates), candidates, &n, rays), SSFR_OK);
    return n;
}

static void rays_are_chosen_by_what_they_cross(void **state)
{
    (void)state;
    ssfr_study_ray rays[8];
    char name[] = "deep";
    ssfr_ray_kind kind = {name, 2, {1, 3}, {0, INFINITY}, 0};
    assert_int_equal(choose(&kind, rays), 2); /* the first that fit */
    assert_true(rays[0].content == 1 && rays[1].content == 3);
    kind.most = 1;
    assert_int_equal(choose(&kind, rays), 2); /* ties in their order */
    assert_true(rays[0].content == 3 && rays[1].content == 2);
    kind.count = 8;
    assert_int_equal(choose(&kind, rays), 4);
    assert_true(rays[2].n_kernels == 7 && rays[3].n_kernels == 5);
    kind.regions[1] = 1;
    assert_int_equal(choose(&kind, rays), 3);
    kind.content[0] = kind.content[1] = 0;
    assert_int_equal(choose(&kind, rays), 1); /* a ray that meets nothing is one, too */
    assert_int_equal(rays[0].n_kernels, 0);
    kind.content[0] = 4, kind.content[1] = 5;
    size_t n;
    assert_fails(SSFR_ERR_VALUE, ssfr_study_choose(&kind, SSFR_COUNT(candidates), candidates, &n, rays),
                 "none of 5 rays that meet the particles is deep");
    assert_int_equal(n, 0);
}

/* The single particle of the scene: a ray's content is one kernel's chord. */
static size_t check_content(const ssfr_study_scene *scene, ssfr_study_integral integral, size_t n,
                            const ssfr_study_ray *rays)
{
    size_t empty = 0;
    const ssfr_continuum *fluid = scene->lines[integral].fluid;
    for (size_t i = 0; i < n; i++) {
        const double *o = rays[i].ray.origin, *d = rays[i].ray.dir, along = -ssfr_dot(o, d);
        const double aside = sqrt(fmax(ssfr_dot(o, o) - along * along, 0)) / fluid->support;
        const double chord = fluid->weight * fluid->support * 2 * ssfr_radial_chord(fluid->radial, aside, 1);
        assert_close(rays[i].content, chord / ssfr_study_unit(scene, integral), 1e-9, 1e-9);
        assert_int_equal(rays[i].n_kernels, aside < 1);
        assert_close(rays[i].regions, aside < 1, 0, 0);
        empty += aside >= 1;
    }
    return empty;
}

static void candidates_know_what_they_cross(void **state)
{
    (void)state;
    ssfr_study study;
    ssfr_study_scene scene;
    ssfr_study_ray *rays;
    size_t n;
    assert_int_equal(read_text(&study, "title: A\nscenes: [sphere]\nsize: [64, 64]\ncandidates: 300\n" TAIL), SSFR_OK);
    assert_int_equal(ssfr_study_scene_init(&scene, &study, study.scenes[0], 1), SSFR_OK);
    assert_int_equal(ssfr_study_survey(&scene, &study, SSFR_STUDY_DENSITY, 1, &n, &rays), SSFR_OK);
    assert_true(n > 100);
    check_content(&scene, SSFR_STUDY_DENSITY, n, rays);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(ssfr_study_refer(&scene, SSFR_STUDY_DENSITY, &rays[i]), SSFR_OK);
        assert_close(rays[i].reference[0], rays[i].content, 0, 0);
        assert_true(rays[i].reference_err < 1e-14);
    }
    free(rays);
    assert_int_equal(ssfr_study_survey(&scene, &study, SSFR_STUDY_RADIANCE, 1, &n, &rays), SSFR_OK);
    const size_t empty = check_content(&scene, SSFR_STUDY_RADIANCE, n, rays);
    assert_true(empty > 0 && empty < n); /* corners of the box */
    free(rays);
    ssfr_study_scene_finish(&scene);
    ssfr_study_finish(&study);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_built_in_study_has_every_integrator),
        cmocka_unit_test(a_study_has_what_its_file_says),
        cmocka_unit_test(bad_studies_are_refused_in_one_line_with_their_place),
        cmocka_unit_test(a_study_that_is_cut_off_anywhere_is_read_or_refused),
        cmocka_unit_test(rays_are_chosen_by_what_they_cross),
        cmocka_unit_test(candidates_know_what_they_cross),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

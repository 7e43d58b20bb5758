/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_meta.c: what stands beside a table, and that rows of another kind are not mixed with it. */
#include "experiments/meta.h"
#include "tests/util.h"

#include <sys/stat.h>
#include <unistd.h>

/* Values of the reference implementation of FNV-1a, 64 bit. */
static void the_hash_is_fnv_1a(void **state)
{
    (void)state;
    assert_true(ssfr_hash_bytes(SSFR_HASH, "", 0) == UINT64_C(0xcbf29ce484222325));
    assert_true(ssfr_hash_bytes(SSFR_HASH, "a", 1) == UINT64_C(0xaf63dc4c8601ec8c));
    assert_true(ssfr_hash_bytes(SSFR_HASH, "foobar", 6) == UINT64_C(0x85944171f73967e8));
    assert_true(ssfr_hash_text(ssfr_hash_text(SSFR_HASH, "ab"), "c") !=
                ssfr_hash_text(ssfr_hash_text(SSFR_HASH, "a"), "bc"));
}

static uint64_t hash_of(size_t n, const double *positions)
{
    const ssfr_particles given = {.radius = 0.02};
    ssfr_particles *particles = NULL;
    assert_int_equal(ssfr_particles_create(&particles, n, positions, &given), SSFR_OK);
    const uint64_t hash = ssfr_hash_particles(particles);
    ssfr_particles_destroy(&particles);
    return hash;
}

static void particles_that_differ_in_a_position_differ_in_their_hash(void **state)
{
    (void)state;
    double positions[] = {0, 0, 0, 1, 2.385, 3, -4, 5, 6};
    const uint64_t hash = hash_of(3, positions);
    assert_true(hash_of(3, positions) == hash);
    assert_true(hash_of(2, positions) != hash);
    positions[4] += 1e-6;
    assert_true(hash_of(3, positions) != hash);
    assert_true(hash_of(0, positions) == SSFR_HASH);
}

static void assert_path(const char *table, const char *ending, const char *expected)
{
    char *path = NULL;
    assert_int_equal(ssfr_meta_path(&path, table, ending), SSFR_OK);
    assert_string_equal(path, expected);
    free(path);
}

static void a_path_takes_the_name_of_its_table(void **state)
{
    (void)state;
    assert_path("results/flow.csv", ".meta.json", "results/flow.meta.json");
    assert_path("flow", ".svg", "flow.svg");
    assert_path(".csv", ".svg", ".csv.svg");
    assert_path("a.csv.d/flow.table", ".svg", "a.csv.d/flow.table.svg");
}

typedef struct fixture {
    ssfr_stage *stage;
    ssfr_graph *graph;
    ssfr_record scene;
    ssfr_sweep_spec *spec;
    ssfr_meta meta;
} fixture;

static void begin(fixture *f)
{
    static char sweep[] = "sweep", word[] = "it's \"odd\"\n", *argv[] = {sweep, word};
    ssfr_stage_options options;
    *f = (fixture){0};
    ssfr_stage_defaults(&options);
    assert_int_equal(ssfr_stage_create(&f->stage, "sphere", &options), SSFR_OK);
    assert_int_equal(ssfr_graph_create(&f->graph, ssfr_pipeline_find("vanderlaan2009"), NULL), SSFR_OK);
    assert_int_equal(ssfr_meta_record_scene(&f->scene, f->stage), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_create(&f->spec), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_vary_text(f->spec, "", "curvature_flow.iterations=17,34"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_reference_text(f->spec, "", "curvature_flow.step=0.2385"), SSFR_OK);
    f->meta = (ssfr_meta){.argc = 2, .argv = argv, .seed = 2385, .identity = 0x2385, .pipeline = "vanderlaan2009",
                          .graph = f->graph, .spec = f->spec, .n_columns = SSFR_N_COLUMNS, .columns = ssfr_columns,
                          .n_scenes = 1, .scenes = &f->scene, .bandwidth_gl = NAN, .bandwidth_cpu = 2.385e9};
}

static void end(fixture *f)
{
    ssfr_sweep_spec_destroy(&f->spec);
    ssfr_record_finish(&f->scene);
    ssfr_graph_destroy(&f->graph);
    ssfr_stage_destroy(&f->stage);
}

static void everything_that_numbers_depend_on_is_written_down(void **state)
{
    (void)state;
    static const char *const parts[] = {
        "\"ssfr\": \"" SSFR_VERSION "\"", "\"commit\": ", "\"dirty\": ", "\"date\": \"2", "\"it's \\\"odd\\\"\\n\"",
        "\"seed\": 2385", "\"processor\": \"", "\"cores\": ", "\"memory_bytes\": ", "\"copy_bytes_per_s\": 2.385e+09",
        "\"kernel\": \"", "\"compiler\": \"gcc ", "\"OpenEXR\": \"", "\"HDF5\": \"", "\"GSL\": \"", "\"OpenCV\": \"",
        "\"scene\": \"sphere\"", "\"scene.particles\": 1", "\"scene.radius\": 0.5", "\"scene.hash\": \"",
        "\"pipeline\": \"vanderlaan2009\"", "\"curvature_flow.step\": 0.9", "\"sphere_depth.splat\": \"",
        "\"medium.ior\": 1.333", "\"17\"", "\"curvature_flow.step\": \"0.2385\"", "\"identity\": \"0000000000002385\"",
        "\"ms_median\": \"median time of a frame\"", "\"ref_depth_rms [m]\": \"depth: RMS"};
    const char *table = test_path("all.csv");
    char *text = NULL;
    size_t size;
    fixture f;
    begin(&f);
    assert_int_equal(ssfr_meta_save(table, &f.meta), SSFR_OK);
    assert_int_equal(ssfr_read_file(test_path("all.meta.json"), 1 << 20, &text, &size), SSFR_OK);
    for (size_t i = 0; i < SSFR_COUNT(parts); i++)
        if (!strstr(text, parts[i])) fail_msg("the metadata lack %s", parts[i]);
    assert_null(strstr(text, "\"curvature_flow.iterations\": 40")); /* varied: it stands under axes alone */
    assert_non_null(strstr(text, "\"curvature_flow.iterations\": ["));
    free(text);
    end(&f);
}

/* JSON is YAML as far as libyaml is concerned, which is a reader that ssfr did not write. */
static void the_file_is_well_formed(void **state)
{
    (void)state;
    const char *table = test_path("form.csv");
    ssfr_sweep_spec *spec = NULL;
    fixture f;
    begin(&f);
    assert_int_equal(ssfr_meta_save(table, &f.meta), SSFR_OK);
    assert_fails(SSFR_ERR_FORMAT, ssfr_sweep_spec_load(&spec, test_path("form.meta.json")), ":2:3: no key ssfr");
    end(&f);
}

static void rows_of_another_identity_are_not_gone_on_with(void **state)
{
    (void)state;
    const char *table = test_path("same.csv");
    fixture f;
    begin(&f);
    assert_int_equal(ssfr_meta_save(table, &f.meta), SSFR_OK);
    assert_int_equal(ssfr_meta_check(table, 0x2385), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_meta_check(table, 0x2386), "same.csv: was measured with other settings");
    f.meta.identity = 0;
    assert_int_equal(ssfr_meta_save(table, &f.meta), SSFR_OK);
    assert_fails(SSFR_ERR_FORMAT, ssfr_meta_check(table, 0x2385), "same.meta.json: has no identity");
    end(&f);
}

static void without_metadata_there_is_a_warning_only(void **state)
{
    (void)state;
    test_clear_log();
    assert_int_equal(ssfr_meta_check(test_path("none.csv"), 0x2385), SSFR_OK);
    assert_int_equal(test_n_errors(), 0);
}

static void a_place_that_cannot_be_written_keeps_nothing(void **state)
{
    (void)state;
    const char *folder = test_path("taken.meta.json");
    fixture f;
    begin(&f);
    assert_fails(SSFR_ERR_IO, ssfr_meta_save(test_path("absent/x.csv"), &f.meta), "absent/x.meta.json");
    assert_int_equal(mkdir(folder, 0777), 0);
    assert_fails(SSFR_ERR_IO, ssfr_meta_save(test_path("taken.csv"), &f.meta), "taken.meta.json");
    assert_int_equal(rmdir(folder), 0);
    end(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_hash_is_fnv_1a),
        cmocka_unit_test(particles_that_differ_in_a_position_differ_in_their_hash),
        cmocka_unit_test(a_path_takes_the_name_of_its_table),
        cmocka_unit_test(everything_that_numbers_depend_on_is_written_down),
        cmocka_unit_test(the_file_is_well_formed),
        cmocka_unit_test(rows_of_another_identity_are_not_gone_on_with),
        cmocka_unit_test(without_metadata_there_is_a_warning_only),
        cmocka_unit_test(a_place_that_cannot_be_written_keeps_nothing),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

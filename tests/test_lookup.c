/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_lookup.c: constant tables: what is stored, what stands between, who makes them and how often. */
#include "tests/pass_util.h"

#include "graph/internal.h"
#include "passes/root.h"

static int n_filled; /* texels so far */

/* Linear along each axis, with all their products. */
static double ramp(double x, double y, double z)
{
    return 0.2 + 0.03 * x - 0.011 * y + 0.023 * z + 0.002 * x * y - 0.001 * x * y * z;
}

static void fill(int x, int y, int z, double *texel)
{
    n_filled++;
    texel[0] = ramp(x, y, z);
    texel[1] = x - 2.385;
}

static const ssfr_lookup floats = {.name = "floats", .w = 7, .h = 5, .d = 3, .c = 2, .fill = fill};
static const ssfr_lookup bytes = {
    .name = "bytes", .w = 7, .h = 5, .d = 3, .c = 2, .store = SSFR_LOOKUP_UNORM8, .repeats = true, .fill = fill};

static ssfr_texels make(const ssfr_lookup *table)
{
    ssfr_texels t;
    assert_int_equal(ssfr_texels_init(&t, table), SSFR_OK);
    return t;
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

static void each_texel_is_filled_once_and_stored_as_float(void **state)
{
    (void)state;
    n_filled = 0;
    ssfr_texels t = make(&floats);
    assert_int_equal(n_filled, 7 * 5 * 3);
    assert_int_equal(ssfr_lookup_bytes(&floats), 7 * 5 * 3 * 2 * sizeof(float));
    for (int z = 0; z < 3; z++)
        for (int y = 0; y < 5; y++)
            for (int x = 0; x < 7; x++) {
                assert_true(ssfr_texel_at(&t, x, y, z, 0) == (double)(float)ramp(x, y, z));
                assert_true(ssfr_texel_at(&t, x, y, z, 1) == (double)(float)(x - 2.385));
            }
    ssfr_texels_finish(&t);
    assert_null(t.data);
}

static void eight_bits_round_to_steps_of_1_in_255_and_cut_off_the_rest(void **state)
{
    (void)state;
    ssfr_texels t = make(&bytes);
    assert_int_equal(ssfr_lookup_bytes(&bytes), 7 * 5 * 3 * 2);
    for (int z = 0; z < 3; z++)
        for (int y = 0; y < 5; y++)
            for (int x = 0; x < 7; x++) {
                const double stored = ssfr_texel_at(&t, x, y, z, 0);
                assert_close(stored, ramp(x, y, z), 0.5 / 255 + 1e-15, 0);
                assert_true(255 * stored == rint(255 * stored));
                assert_true(ssfr_texel_at(&t, x, y, z, 1) == (x < 3 ? 0 : x > 3 ? 1 : rint(255 * 0.615) / 255));
            }
    ssfr_texels_finish(&t);
}

static double at(const ssfr_texels *t, double x, double y, double z)
{
    return ssfr_texels_between(t, (const double[3]){(x + 0.5) / 7, (y + 0.5) / 5, (z + 0.5) / 3}, 0);
}

static void what_stands_between_texels_is_linear_along_each_axis(void **state)
{
    (void)state;
    ssfr_texels t = make(&floats);
    uint64_t random = 3;
    for (int i = 0; i < 1000; i++) {
        const double x = test_random(&random, 0, 6), y = test_random(&random, 0, 4), z = test_random(&random, 0, 2);
        assert_close(at(&t, x, y, z), ramp(x, y, z), 1e-7, 0); /* of the floats */
    }
    assert_close(at(&t, 3, 2, 1), ramp(3, 2, 1), 1e-7, 0);
    ssfr_texels_finish(&t);
}

static void beyond_its_edges_a_table_goes_on_or_begins_anew(void **state)
{
    (void)state;
    ssfr_texels held = make(&floats), again = make(&bytes);
    assert_true(at(&held, -0.4, 2, 1) == at(&held, 0, 2, 1));
    assert_true(at(&held, -238.5, 2, 1) == at(&held, 0, 2, 1));
    assert_true(at(&held, 6, 1e300, 1) == at(&held, 6, 4, 1));
    uint64_t random = 5;
    for (int i = 0; i < 300; i++) {
        const double x = test_random(&random, 0, 7), y = test_random(&random, 0, 5), z = test_random(&random, 0, 3);
        assert_close(at(&again, x - 7, y + 10, z - 30), at(&again, x, y, z), 1e-12, 0);
    }
    /* Half way from the last texel to the first. */
    const double ends[2] = {ssfr_texel_at(&again, 6, 2, 1, 0), ssfr_texel_at(&again, 0, 2, 1, 0)};
    assert_close(at(&again, 6.5, 2, 1), 0.5 * (ends[0] + ends[1]), 1e-12, 0);
    assert_close(at(&again, -0.25, 2, 1), 0.25 * ends[0] + 0.75 * ends[1], 1e-12, 0);
    ssfr_texels_finish(&held), ssfr_texels_finish(&again);
}

static void coordinates_that_are_not_finite_count_as_0(void **state)
{
    (void)state;
    static const double wild[] = {NAN, INFINITY, -INFINITY};
    ssfr_texels tables[2] = {make(&floats), make(&bytes)};
    for (int i = 0; i < 2; i++) {
        for (size_t k = 0; k < SSFR_COUNT(wild); k++) {
            const double place[3] = {wild[k], 0.3, wild[k]}, zero[3] = {0, 0.3, 0};
            assert_true(ssfr_texels_between(&tables[i], place, 0) == ssfr_texels_between(&tables[i], zero, 0));
        }
        for (double large = 1e9; large < 1e300; large *= 1e50)
            assert_true(isfinite(ssfr_texels_between(&tables[i], (const double[3]){large, -large, 0.5}, 0)));
        ssfr_texels_finish(&tables[i]);
    }
}

static void gpus_round_weights_to_8_bits_and_what_has_8_bits(void **state)
{
    (void)state;
    assert_close(ssfr_lookup_rounding(&floats, 0.1), 3 * 0.1 / 512, 1e-15, 0);
    assert_close(ssfr_lookup_rounding(&bytes, 0.1), 3 * 0.1 / 512 + 1.0 / 255, 1e-15, 0);
    assert_close(ssfr_lookup_rounding(&ssfr_root_ramp, 0.1), 0.1 / 512, 1e-15, 0);
}

/* ---- in a graph -------------------------------------------------------------------------------------------------- */

static const ssfr_pipeline three = {
    .name = "three", .source = "", .help = "", .result = SSFR_SLOT_noise,
    .nodes = {{"sphere_depth"}, {"thickness"}, {"surface_noise"}},
};

static test_twin *with_a_particle(void **state)
{
    static const double centre[1][3] = {{0.02, -0.03, -1}};
    test_twin *t = test_twin_create_for(state, &three, 40, 30);
    test_twin_place(t, 1, centre, 0.2, NULL);
    return t;
}

static long run_once(test_twin *t)
{
    ssfr_graph_want_all(t->graph, true);
    assert_int_equal(ssfr_graph_run(t->graph, &t->scene, NULL), SSFR_OK);
    return ssfr_graph_report(t->graph)->allocations;
}

static void a_table_is_made_when_a_node_first_reads_it_and_once(void **state)
{
    test_twin *t = with_a_particle(state);
    run_once(t);
    assert_int_equal(t->graph->n_tables, 0);
    assert_int_equal(run_once(t), 0);
    test_twin_set(t, "thickness.root", "ramp");
    assert_int_equal(run_once(t), 1);
    assert_int_equal(t->graph->n_tables, 1);
    assert_ptr_equal(t->graph->tables[0].texels.table, &ssfr_root_ramp);
    assert_true(t->gl ? t->graph->tables[0].texture > 0 && !t->graph->tables[0].texels.data
                      : t->graph->tables[0].texels.data != NULL);
    assert_int_equal(run_once(t), 0);
    test_twin_set(t, "thickness.root", "exact");
    test_twin_set(t, "thickness.root", "ramp");
    assert_int_equal(run_once(t), 0);
    assert_int_equal(t->graph->n_tables, 1);
}

static void nodes_that_name_the_same_table_share_it(void **state)
{
    test_twin *t = with_a_particle(state);
    test_twin_set(t, "sphere_depth.root", "ramp");
    test_twin_set(t, "thickness.root", "ramp");
    test_twin_set(t, "surface_noise.root", "ramp_printed");
    run_once(t);
    assert_int_equal(t->graph->n_tables, 2);
    assert_ptr_equal(t->graph->nodes[0].run.tables[0], t->graph->nodes[1].run.tables[0]);
    assert_null(t->graph->nodes[0].run.tables[1]);
    assert_null(t->graph->nodes[2].run.tables[0]);
    assert_ptr_equal(t->graph->nodes[2].run.tables[1]->table, &ssfr_root_ramp_printed);
}

static void no_table_is_made_for_a_node_that_is_left_out(void **state)
{
    test_twin *t = with_a_particle(state);
    test_twin_set(t, "thickness.root", "ramp");
    test_twin_set(t, "thickness.off", "1");
    run_once(t);
    assert_int_equal(t->graph->n_tables, 0);
}

static void tables_count_in_what_a_graph_holds_and_a_node_moves(void **state)
{
    test_twin *t = with_a_particle(state);
    run_once(t);
    const double before = ssfr_graph_report(t->graph)->image_bytes;
    const double moved = ssfr_graph_report(t->graph)->nodes[1].bytes;
    test_twin_set(t, "thickness.root", "ramp");
    run_once(t);
    assert_true(ssfr_graph_report(t->graph)->image_bytes == before + 128 * sizeof(float));
    assert_true(ssfr_graph_report(t->graph)->nodes[1].bytes == moved + 128 * sizeof(float));
    test_twin_set(t, "thickness.root", "ramp_printed");
    run_once(t);
    assert_true(ssfr_graph_report(t->graph)->image_bytes == before + 128 * sizeof(float) + 128);
    assert_true(ssfr_graph_report(t->graph)->nodes[1].bytes == moved + 128);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_texel_is_filled_once_and_stored_as_float),
        cmocka_unit_test(eight_bits_round_to_steps_of_1_in_255_and_cut_off_the_rest),
        cmocka_unit_test(what_stands_between_texels_is_linear_along_each_axis),
        cmocka_unit_test(beyond_its_edges_a_table_goes_on_or_begins_anew),
        cmocka_unit_test(coordinates_that_are_not_finite_count_as_0),
        cmocka_unit_test(gpus_round_weights_to_8_bits_and_what_has_8_bits),
        TEST_TWINS(a_table_is_made_when_a_node_first_reads_it_and_once),
        TEST_TWINS(nodes_that_name_the_same_table_share_it),
        TEST_TWINS(no_table_is_made_for_a_node_that_is_left_out),
        TEST_TWINS(tables_count_in_what_a_graph_holds_and_a_node_moves),
    };
    return cmocka_run_group_tests(tests, test_capture_log, test_end_gl);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_tank.c: tanks hold the water that they should, and what is measured of it is known where it can be. */
#include "base/param.h"
#include "experiments/scenes/tank.h"
#include "tests/util.h"

static ssfr_tank *made(ssfr_tank_kind kind, int layers)
{
    ssfr_tank *tank = NULL;
    assert_int_equal(ssfr_tank_create(&tank, kind, layers, NULL), SSFR_OK);
    return tank;
}

static ssfr_tank_state state_of(const ssfr_tank *tank)
{
    ssfr_tank_state state;
    assert_int_equal(ssfr_tank_measure(tank, &state), SSFR_OK);
    return state;
}

static void tanks_hold_all_their_water(void **state)
{
    (void)state;
    static const double volumes[] = {0.25, 0.25, 0.125}; /* m^3 */
    for (int kind = 0; ssfr_tank_words[kind]; kind++) {
        ssfr_tank *tank = made((ssfr_tank_kind)kind, 7);
        assert_int_equal(tank->n, kind == SSFR_TANK_DROP ? 343 : 686);
        assert_int_equal(ssfr_solver_fluid(tank->solver).n, tank->n);
        assert_close((double)tank->n * ssfr_particle_mass(tank->radius), volumes[kind] * SSFR_REST_DENSITY, 0, 1e-12);
        assert_non_null(ssfr_tank_help[kind]);
        ssfr_tank_destroy(&tank);
        assert_null(tank);
    }
}

/* Before anything has moved: a cubic lattice. */
static void heights_and_energy_of_a_lattice_are_exact(void **state)
{
    (void)state;
    static const double heights[] = {0.5, 1}; /* m */
    for (int kind = SSFR_TANK_POOL; kind <= SSFR_TANK_DAM_BREAK; kind++) {
        ssfr_tank *tank = made((ssfr_tank_kind)kind, 12);
        const ssfr_tank_state s = state_of(tank);
        assert_close(s.centre, 0.5 * heights[kind], 1e-6, 0);
        assert_close(s.energy, 250 * 9.81 * 0.5 * heights[kind], 0, 1e-5);
        assert_close(s.speed_max, 0, 0, 0);
        assert_close(s.speed_rms, 0, 0, 0);
        if (kind == SSFR_TANK_POOL) assert_close(s.surface, 0.5, 1e-6, 0);
        ssfr_tank_destroy(&tank);
    }
}

/* Only what is farther than the support, 2.15 spacings, from walls and from marked particles is interior. The layer
 * below the topmost may be marked or not. */
static void the_interior_lacks_walls_and_surface(void **state)
{
    (void)state;
    enum { LAYERS = 14 };
    ssfr_tank *tank = made(SSFR_TANK_POOL, LAYERS);
    const ssfr_tank_state s = state_of(tank);
    const size_t across = LAYERS - 4, along = 2 * LAYERS - 4; /* two layers at each wall */
    assert_true(s.interior == across * along * (LAYERS - 5) || s.interior == across * along * (LAYERS - 6));
    assert_close(s.density_rms, fabs(s.density_mean), 1e-5, 0); /* all alike */
    assert_close(s.density_max, s.density_rms, 1e-5, 0);
    assert_true(s.compression_max <= s.density_max && s.compression_rms <= s.density_rms);
    ssfr_tank_destroy(&tank);
}

static void water_without_an_interior_has_no_density(void **state)
{
    (void)state;
    ssfr_tank *tank = made(SSFR_TANK_POOL, 3);
    const ssfr_tank_state s = state_of(tank);
    assert_int_equal(s.interior, 0);
    assert_true(isnan(s.density_mean) && isnan(s.density_rms) && isnan(s.density_max) && isnan(s.compression_max));
    assert_true(isfinite(s.volume) && isfinite(s.surface));
    ssfr_tank_destroy(&tank);
}

static void steps_end_where_they_are_asked_to(void **state)
{
    (void)state;
    ssfr_tank *tank = made(SSFR_TANK_DAM_BREAK, 6);
    while (tank->time < 0.2385) assert_int_equal(ssfr_tank_step(tank, 0.2385), SSFR_OK);
    assert_close(tank->time, 0.2385, 0, 0);
    const long steps = tank->steps;
    const double limit = ssfr_solver_limit(tank->solver);
    assert_int_equal(ssfr_tank_step(tank, INFINITY), SSFR_OK);
    assert_close(tank->time, 0.2385 + limit, 0, 1e-12);
    assert_int_equal(tank->steps, steps + 1);
    ssfr_tank_destroy(&tank);
}

/* Water in motion goes down and forwards, and gains no energy. */
static void a_dam_break_falls(void **state)
{
    (void)state;
    ssfr_tank *tank = made(SSFR_TANK_DAM_BREAK, 8);
    const ssfr_tank_state before = state_of(tank);
    while (tank->time < 0.3) assert_int_equal(ssfr_tank_step(tank, 0.3), SSFR_OK);
    const ssfr_tank_state after = state_of(tank);
    assert_true(after.centre < before.centre - 0.1);
    assert_true(after.energy < before.energy * 1.001);
    assert_true(after.speed_max > 1 && after.speed_max < sqrt(2 * 9.81 * 2));
    assert_true(after.speed_rms > 0.5 && after.speed_rms < after.speed_max);
    ssfr_tank_destroy(&tank);
}

/* Steps of dt add up to a fall that is too far by g t dt / 2: the scheme is of the first order. */
static void a_drop_falls_to_first_order(void **state)
{
    (void)state;
    double errors[2];
    for (int i = 0; i < 2; i++) {
        ssfr_solver_params params;
        ssfr_tank *tank = NULL;
        ssfr_params_default(ssfr_solver_rows, &params);
        params.cfl = 100;
        params.max_step = i ? 0.01 : 0.02;
        assert_int_equal(ssfr_tank_create(&tank, SSFR_TANK_DROP, 3, &params), SSFR_OK);
        const ssfr_tank_state before = state_of(tank);
        while (tank->time < 0.5) assert_int_equal(ssfr_tank_step(tank, 0.5), SSFR_OK);
        const ssfr_tank_state after = state_of(tank);
        assert_int_equal(tank->steps, i ? 50 : 25);
        errors[i] = before.centre - after.centre - 0.5 * 9.81 * 0.25;
        ssfr_tank_destroy(&tank);
    }
    assert_close(errors[0], 9.81 * 0.5 * 0.02 / 2, 1e-4, 0);
    assert_close(errors[0] / errors[1], 2, 0.01, 0);
}

static void parameters_out_of_range_are_refused(void **state)
{
    (void)state;
    ssfr_solver_params params;
    ssfr_tank *tank = NULL;
    ssfr_params_default(ssfr_solver_rows, &params);
    params.iterations = 0;
    assert_fails(SSFR_ERR_VALUE, ssfr_tank_create(&tank, SSFR_TANK_POOL, 5, &params), "iterations=0");
    assert_null(tank);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tanks_hold_all_their_water),
        cmocka_unit_test(heights_and_energy_of_a_lattice_are_exact),
        cmocka_unit_test(the_interior_lacks_walls_and_surface),
        cmocka_unit_test(water_without_an_interior_has_no_density),
        cmocka_unit_test(steps_end_where_they_are_asked_to),
        cmocka_unit_test(a_dam_break_falls),
        cmocka_unit_test(a_drop_falls_to_first_order),
        cmocka_unit_test(parameters_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

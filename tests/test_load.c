/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_load.c: what loading does alike for all formats: the unit of length, the axis up, dropping, endings. */
#include "tests/particle_files.h"

#include <float.h>

/* Three particles with velocities, and ids that tell them apart. */
static const double places[9] = {0.5, 0, 0, 2.385, -1.75, 23.85, 0.1, 0.2, 0.3};
static const float velocities[9] = {1, 0, 0, -2.5f, 4, 0.0625f, 0, 0, -3};
enum { N = 3 };

static const char *make_ply(const char *name, const double *positions, const float *velocity)
{
    bytes b = {0};
    put_text(&b, "ply\nformat binary_little_endian 1.0\ncomment particle radius 0.25 m\nelement vertex %d\n", N);
    put_text(&b, "property double x\nproperty double y\nproperty double z\nproperty float vx\nproperty float vy\n");
    put_text(&b, "property float vz\nproperty uint id\nend_header\n");
    for (size_t i = 0; i < N; i++) {
        for (size_t k = 0; k < 3; k++) put_number(&b, SSFR_FLOAT64, false, positions[3 * i + k]);
        for (size_t k = 0; k < 3; k++) put_number(&b, SSFR_FLOAT32, false, (double)velocity[3 * i + k]);
        put_number(&b, SSFR_UINT32, false, (double)i);
    }
    return particle_file(name, b.data, b.n);
}

static ssfr_particles *load_with(const char *path, ssfr_load_options options)
{
    ssfr_particles *p = NULL;
    test_clear_log();
    if (ssfr_particles_load(&p, path, &options) != SSFR_OK) fail_msg("%s", test_last_error());
    return p;
}

/* The same bits as a set that is packed from these. */
static void assert_packed(const ssfr_particles *p, const double *positions, const float *velocity, double radius)
{
    float copy[3 * N];
    uint32_t id[N] = {0, 1, 2};
    memcpy(copy, velocity, sizeof copy);
    const ssfr_particles given = {.velocity = copy, .id = id, .radius = radius};
    ssfr_particles *expected = NULL;
    assert_int_equal(ssfr_particles_create(&expected, N, positions, &given), SSFR_OK);
    assert_int_equal(p->n, N);
    assert_true(p->radius == radius);
    assert_memory_equal(p->packets, expected->packets, sizeof *p->packets);
    assert_memory_equal(p->position, expected->position, 3 * N * sizeof *p->position);
    assert_memory_equal(p->id, expected->id, sizeof id);
    for (size_t k = 0; k < 3 * N; k++) assert_true(p->velocity[k] == expected->velocity[k]);
    ssfr_particles_destroy(&expected);
}

static void without_options_a_file_is_in_metres_and_y_is_up(void **state)
{
    (void)state;
    const char *path = make_ply("plain.ply", places, velocities);
    const ssfr_load_options same[] = {{0}, {.unit = 1}, {.up = 'y'}, {.unit = 1, .up = 'y', .drop_nonfinite = true}};
    ssfr_particles *p = load(path);
    assert_packed(p, places, velocities, 0.25);
    ssfr_particles_destroy(&p);
    for (size_t i = 0; i < SSFR_COUNT(same); i++) {
        p = load_with(path, same[i]);
        assert_packed(p, places, velocities, 0.25);
        ssfr_particles_destroy(&p);
    }
}

static void the_unit_scales_positions_velocities_and_the_files_radius(void **state)
{
    (void)state;
    const double units[] = {0.01, 2.385, 1000, 3.0856775814913673e19};
    const char *path = make_ply("unit.ply", places, velocities);
    for (size_t u = 0; u < SSFR_COUNT(units); u++) {
        double scaled[9];
        float velocity[9];
        for (size_t k = 0; k < 9; k++) {
            scaled[k] = places[k] * units[u];
            velocity[k] = (float)(units[u] * (double)velocities[k]);
        }
        ssfr_particles *p = load_with(path, (ssfr_load_options){.unit = units[u]});
        assert_packed(p, scaled, velocity, 0.25 * units[u]);
        ssfr_particles_destroy(&p);
    }
}

static void a_radius_of_the_caller_is_in_metres_whatever_the_unit(void **state)
{
    (void)state;
    const char *path = make_ply("radius.ply", places, velocities);
    ssfr_particles *p = load_with(path, (ssfr_load_options){.unit = 0.01, .radius = 0.02385});
    assert_true(p->radius == 0.02385);
    ssfr_particles_destroy(&p);
}

static void an_estimated_radius_is_in_metres_too(void **state)
{
    (void)state;
    static const char text[] = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                               "property float z\nend_header\n0 0 0\n0 0 2\n";
    ssfr_particles *p = load_with(text_file("estimate.ply", text), (ssfr_load_options){.unit = 0.125, .up = 'z'});
    assert_close(p->radius, 0.125, 1e-9, 0);
    ssfr_particles_destroy(&p);
}

static void the_axis_up_is_turned_to_y(void **state)
{
    (void)state;
    const struct {
        char up;
        int from[3]; /* the axis of the file, counted from 1, negative where it is turned round */
    } cases[] = {{'z', {1, 3, -2}}, {'x', {-2, 1, 3}}};
    const char *path = make_ply("up.ply", places, velocities);
    for (size_t c = 0; c < SSFR_COUNT(cases); c++) {
        double turned[9];
        float velocity[9];
        for (size_t i = 0; i < 9; i++) {
            const int from = cases[c].from[i % 3];
            const size_t at = i - i % 3 + (size_t)abs(from) - 1;
            turned[i] = 0.5 * (from < 0 ? -places[at] : places[at]);
            velocity[i] = 0.5f * (from < 0 ? -velocities[at] : velocities[at]);
        }
        ssfr_particles *p = load_with(path, (ssfr_load_options){.unit = 0.5, .up = cases[c].up});
        assert_packed(p, turned, velocity, 0.125);
        ssfr_particles_destroy(&p);
    }
}

/* Particles at the ends of the three axes: their triple product keeps its sign. */
static void turning_mirrors_nothing(void **state)
{
    (void)state;
    const double axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const char *path = make_ply("axes.ply", axes, velocities);
    for (const char *up = "xyz"; *up; up++) {
        ssfr_particles *p = load_with(path, (ssfr_load_options){.up = *up});
        double at[3][3], cross[3];
        for (size_t i = 0; i < 3; i++) ssfr_particles_position(p, i, at[p->id[i]]);
        ssfr_cross(at[0], at[1], cross);
        assert_close(ssfr_dot(cross, at[2]), 1, 1e-6, 0);
        assert_close(at[*up - 'x'][1], 1, 1e-6, 0);
        ssfr_particles_destroy(&p);
    }
}

static void options_out_of_range_are_refused(void **state)
{
    (void)state;
    const char *path = make_ply("range.ply", places, velocities);
    const struct {
        ssfr_load_options options;
        ssfr_result code;
        const char *says;
    } cases[] = {
        {{.unit = -2.385}, SSFR_ERR_VALUE, "range.ply: unit of length -2.385 m: expected a finite number above 0"},
        {{.unit = NAN}, SSFR_ERR_VALUE, "unit of length nan m"},
        {{.unit = INFINITY}, SSFR_ERR_VALUE, "unit of length inf m"},
        {{.radius = -2.385}, SSFR_ERR_VALUE, "range.ply: particle radius -2.385 m: expected a finite number above 0"},
        {{.radius = NAN}, SSFR_ERR_VALUE, "particle radius nan m"},
        {{.up = 'w'}, SSFR_ERR_VALUE, "range.ply: the axis up is 'w': expected x, y or z"},
        {{.up = 'Z'}, SSFR_ERR_VALUE, "the axis up is 'Z'"},
        {{.up = '\n'}, SSFR_ERR_VALUE, "the axis up is '?'"},
        {{.map = "position=x"}, SSFR_ERR_UNSUPPORTED, "range.ply: a map of arrays is for HDF5, not for .ply files"},
        {{.unit = DBL_MAX}, SSFR_ERR_VALUE, "particle 0 (from 0): velocity is inf"},
        {{.unit = 1e39}, SSFR_ERR_VALUE, "velocity is inf"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_load_options options = cases[i].options;
        ssfr_particles *p = NULL;
        assert_fails(cases[i].code, ssfr_particles_load(&p, path, &options), cases[i].says);
        assert_null(p);
    }
}

static void a_radius_that_the_unit_makes_infinite_is_refused(void **state)
{
    (void)state;
    bytes b = {0};
    ssfr_load_options options = {.unit = DBL_MAX};
    ssfr_particles *p = NULL;
    put_number(&b, SSFR_UINT32, false, 0);
    put_number(&b, SSFR_FLOAT32, false, 2.5);
    assert_fails(SSFR_ERR_FORMAT, ssfr_particles_load(&p, particle_file("huge.pos", b.data, b.n), &options),
                 "huge.pos: the particle radius is inf m");
    assert_null(p);
}

static void particles_that_are_not_finite_are_dropped_on_demand(void **state)
{
    (void)state;
    double positions[9];
    float velocity[9];
    memcpy(positions, places, sizeof positions);
    memcpy(velocity, velocities, sizeof velocity);
    positions[1] = NAN;
    velocity[8] = -INFINITY;
    const char *path = make_ply("drop.ply", positions, velocity);
    ssfr_load_options options = {.n_dropped = 7};
    ssfr_particles *p = NULL;
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_load(&p, path, &options), "particle 0 (from 0): position is nan");
    assert_int_equal(options.n_dropped, 0);
    options.drop_nonfinite = true;
    options.up = 'z';
    assert_int_equal(ssfr_particles_load(&p, path, &options), SSFR_OK);
    assert_int_equal(options.n_dropped, 2);
    assert_int_equal(p->n, 1);
    assert_int_equal(p->id[find_particle(p, 2.385, 23.85, 1.75)], 1);
    assert_true(p->velocity[0] == -2.5f && p->velocity[1] == 0.0625f && p->velocity[2] == -4);
    ssfr_particles_destroy(&p);
    positions[3] = INFINITY;
    assert_int_equal(ssfr_particles_load(&p, make_ply("drop.ply", positions, velocity), &options), SSFR_OK);
    assert_int_equal(options.n_dropped, 3);
    assert_int_equal(p->n, 0);
    ssfr_particles_destroy(&p);
}

static void the_names_end_tells_the_format_in_any_case(void **state)
{
    (void)state;
    static const char *const bad[] = {"a.txt", "a.ply.txt", "aply", "ply", "a.", "a.pl", ""};
    ssfr_particles *p = load(make_ply("end.PLY", places, velocities));
    ssfr_particles_destroy(&p);
    p = load(make_ply("more.h5.Ply", places, velocities));
    ssfr_particles_destroy(&p);
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) {
        assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_particles_load(&p, bad[i], NULL), "names of particle files end in");
        assert_non_null(strstr(test_last_error(), " .h5 "));
        assert_null(p);
    }
}

static void every_format_is_listed_with_what_it_is(void **state)
{
    (void)state;
    const char *list = ssfr_particle_formats();
#define X(ending, reader, writer, holds, help) assert_non_null(strstr(list, ending " (" help ")\n"));
#include "scene/formats.def"
#undef X
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_options_a_file_is_in_metres_and_y_is_up),
        cmocka_unit_test(the_unit_scales_positions_velocities_and_the_files_radius),
        cmocka_unit_test(a_radius_of_the_caller_is_in_metres_whatever_the_unit),
        cmocka_unit_test(an_estimated_radius_is_in_metres_too),
        cmocka_unit_test(the_axis_up_is_turned_to_y),
        cmocka_unit_test(turning_mirrors_nothing),
        cmocka_unit_test(options_out_of_range_are_refused),
        cmocka_unit_test(a_radius_that_the_unit_makes_infinite_is_refused),
        cmocka_unit_test(particles_that_are_not_finite_are_dropped_on_demand),
        cmocka_unit_test(the_names_end_tells_the_format_in_any_case),
        cmocka_unit_test(every_format_is_listed_with_what_it_is),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

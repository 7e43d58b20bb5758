/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_pos.c: .pos particles: a count, a radius, positions. */
#include "tests/particle_files.h"

static bytes make_file(double n, double radius, int n_written, double first)
{
    bytes b = {0};
    put_number(&b, SSFR_UINT32, false, n);
    put_number(&b, SSFR_FLOAT32, false, radius);
    for (int k = 0; k < 3 * n_written; k++) put_number(&b, SSFR_FLOAT32, false, k ? 0.25 * k : first);
    return b;
}

static void positions_and_radius_are_read(void **state)
{
    (void)state;
    const bytes b = make_file(3, 2.385, 3, -0.5);
    ssfr_particles *p = load(particle_file("three.pos", b.data, b.n));
    assert_int_equal(p->n, 3);
    assert_close(p->radius, 2.385, 0, 1e-7);
    find_particle(p, -0.5, 0.25, 0.5);
    find_particle(p, 0.75, 1, 1.25);
    find_particle(p, 1.5, 1.75, 2);
    assert_null(p->velocity);
    ssfr_particles_destroy(&p);
}

static void zero_particles_and_one_particle_are_files(void **state)
{
    (void)state;
    const bytes none = make_file(0, 0.02385, 0, 0), one = make_file(1, 0.02385, 1, 2.385);
    ssfr_particles *p = load(particle_file("none.pos", none.data, none.n));
    assert_int_equal(p->n, 0);
    ssfr_particles_destroy(&p);
    p = load(particle_file("one.pos", one.data, one.n));
    find_particle(p, (double)2.385f, 0.25, 0.5);
    ssfr_particles_destroy(&p);
}

static void assert_refused(bytes b, ssfr_result code, const char *text)
{
    check_refused(particle_file("bad.pos", b.data, b.n), code, text);
}

static void a_count_that_is_not_the_files_is_refused(void **state)
{
    (void)state;
    assert_refused(make_file(2, 0.1, 3, 0), SSFR_ERR_FORMAT, "44 bytes, but a count of 2 makes 32");
    assert_refused(make_file(4, 0.1, 3, 0), SSFR_ERR_FORMAT, "44 bytes, but a count of 4 makes 56");
    assert_refused(make_file(4294967295.0, 0.1, 3, 0), SSFR_ERR_FORMAT, "a count of 4294967295 makes 51539607548");
    bytes b = make_file(3, 0.1, 3, 0);
    b.n = 7;
    assert_refused(b, SSFR_ERR_FORMAT, "7 bytes: too short");
}

static void a_bad_radius_is_refused_and_none_is_estimated(void **state)
{
    (void)state;
    const bytes b = make_file(2, 0, 2, 0);
    assert_refused(make_file(3, -2, 3, 0), SSFR_ERR_FORMAT, "radius is -2 m");
    assert_refused(make_file(3, NAN, 3, 0), SSFR_ERR_FORMAT, "nan m");
    assert_refused(make_file(1, 0, 1, 0), SSFR_ERR_VALUE, "say the radius");
    ssfr_particles *p = load(particle_file("two.pos", b.data, b.n));
    assert_close(p->radius, 0.5 * sqrt(3 * 0.75 * 0.75), 0, 1e-6);
    ssfr_particles_destroy(&p);
}

static void positions_that_are_not_finite_are_refused_or_dropped(void **state)
{
    (void)state;
    const bytes b = make_file(3, 0.1, 3, -INFINITY);
    ssfr_load_options options = {.drop_nonfinite = true};
    ssfr_particles *p = NULL;
    assert_refused(b, SSFR_ERR_VALUE, "particle 0 (from 0): position is -inf");
    assert_int_equal(ssfr_particles_load(&p, particle_file("inf.pos", b.data, b.n), &options), SSFR_OK);
    assert_int_equal(options.n_dropped, 1);
    assert_int_equal(p->n, 2);
    find_particle(p, 0.75, 1, 1.25);
    ssfr_particles_destroy(&p);
}

static void a_file_cut_anywhere_or_damaged_never_harms(void **state)
{
    (void)state;
    const bytes b = make_file(3, 0.1, 3, 2.385);
    check_truncations("cut.pos", b.data, b.n);
    check_damage("damaged.pos", b.data, b.n);
}

static ssfr_particles *make_two(double x, double radius)
{
    const double positions[] = {x, 0.25, -0.5, x + 0.75, 2, 1.5};
    ssfr_particles *p = NULL;
    assert_int_equal(ssfr_particles_create(&p, 2, positions, &(ssfr_particles){.radius = radius}), SSFR_OK);
    return p;
}

static void what_is_written_is_count_radius_and_positions(void **state)
{
    (void)state;
    const double numbers[] = {0.125, 0.25, -0.5, 0.875, 2, 1.5};
    bytes expected = {0};
    ssfr_particles *p = make_two(0.125, 2.385);
    char *file = NULL;
    size_t n = 0;
    put_number(&expected, SSFR_UINT32, false, 2);
    put_number(&expected, SSFR_FLOAT32, false, 2.385);
    for (size_t k = 0; k < SSFR_COUNT(numbers); k++) put_number(&expected, SSFR_FLOAT32, false, numbers[k]);
    assert_int_equal(ssfr_particles_save(p, test_path("two_written.pos")), SSFR_OK);
    assert_int_equal(ssfr_read_file(test_path("two_written.pos"), SSFR_READ_MAX, &file, &n), SSFR_OK);
    assert_int_equal(n, expected.n);
    assert_memory_equal(file, expected.data, n);
    free(file);
    ssfr_particles_destroy(&p);
}

static void a_radius_that_was_not_known_stays_unknown(void **state)
{
    (void)state;
    ssfr_particles *p = make_two(0.125, 0), *loaded = NULL;
    assert_int_equal(ssfr_particles_save(p, test_path("unknown.pos")), SSFR_OK);
    loaded = load(test_path("unknown.pos"));
    assert_close(loaded->radius, 0.5 * sqrt(0.75 * 0.75 + 1.75 * 1.75 + 4), 0, 1e-6); /* from the spacing */
    ssfr_particles_destroy(&p);
    ssfr_particles_destroy(&loaded);
}

static void what_is_no_file_is_refused(void **state)
{
    (void)state;
    check_no_files(".pos");
}

static void the_sphere_drop_is_read(void **state)
{
    (void)state;
    char path[512];
    double lo[3], hi[3];
    snprintf(path, sizeof path, "%s/sphere_drop_100.pos", test_data_or_skip());
    ssfr_particles *p = load(path);
    assert_int_equal(p->n, 64830);
    assert_close(p->radius, 0.00625, 0, 1e-7);
    ssfr_particles_bounds(p, lo, hi);
    assert_close(lo[0], 0.012, 5e-4, 0);
    assert_close(hi[1], 0.347, 5e-4, 0);
    assert_close(hi[2], 0.988, 5e-4, 0);
    ssfr_particles_destroy(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(positions_and_radius_are_read),
        cmocka_unit_test(zero_particles_and_one_particle_are_files),
        cmocka_unit_test(a_count_that_is_not_the_files_is_refused),
        cmocka_unit_test(a_bad_radius_is_refused_and_none_is_estimated),
        cmocka_unit_test(positions_that_are_not_finite_are_refused_or_dropped),
        cmocka_unit_test(a_file_cut_anywhere_or_damaged_never_harms),
        cmocka_unit_test(what_is_written_is_count_radius_and_positions),
        cmocka_unit_test(a_radius_that_was_not_known_stays_unknown),
        cmocka_unit_test(what_is_no_file_is_refused),
        cmocka_unit_test(the_sphere_drop_is_read),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

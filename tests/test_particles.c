/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_particles.c: packing, bounds and spacing of particles; loading and saving as far as all formats share it. */
#include "tests/particle_files.h"

#include <float.h>
#include <locale.h>

enum { N = 2000 };

/* N particles in a box, with every array, whose values tell which particle they belong to. */
typedef struct cloud {
    double positions[3 * N];
    float velocity[3 * N], density[N], lifetime[N];
    uint32_t neighbours[N], id[N], kind[N];
    ssfr_particles given;
} cloud;

static cloud *make_cloud(const double centre[3])
{
    cloud *c = calloc(1, sizeof *c);
    uint64_t seed = 2385;
    assert_non_null(c);
    for (uint32_t i = 0; i < N; i++) {
        for (size_t k = 0; k < 3; k++) c->positions[3 * i + k] = centre[k] + test_random(&seed, -2.385, 1.117);
        for (size_t k = 0; k < 3; k++) c->velocity[3 * i + k] = (float)i + 0.25f * (float)k;
        c->density[i] = 1000.5f + (float)i;
        c->lifetime[i] = 0.125f * (float)i;
        c->neighbours[i] = i % 47;
        c->id[i] = i;
        c->kind[i] = i % 3;
    }
    c->given = (ssfr_particles){.velocity = c->velocity, .density = c->density, .lifetime = c->lifetime,
                                .neighbours = c->neighbours, .id = c->id, .kind = c->kind, .radius = 0.02385};
    return c;
}

static ssfr_particles *create(size_t n, const double *positions, const ssfr_particles *given)
{
    ssfr_particles *particles = NULL;
    assert_int_equal(ssfr_particles_create(&particles, n, positions, given), SSFR_OK);
    assert_non_null(particles);
    return particles;
}

/* Every given particle is there once, with its own values, within float rounding of its packet's extent. */
static void check_cloud(const cloud *c)
{
    ssfr_particles *p = create(N, c->positions, &c->given);
    unsigned char seen[N] = {0};
    assert_int_equal(p->n, N);
    assert_int_equal(p->n_packets, (N + SSFR_PACKET - 1) / SSFR_PACKET);
    for (size_t i = 0; i < N; i++) {
        const uint32_t id = p->id[i];
        double at[3];
        assert_true(id < N && !seen[id]);
        seen[id] = 1;
        ssfr_particles_position(p, i, at);
        for (size_t k = 0; k < 3; k++) {
            const double half = (double)p->packets[i / SSFR_PACKET].half[k];
            const double ulp = DBL_EPSILON * fabs(at[k]); /* of the sum of centre and relative position */
            assert_close(at[k], c->positions[3 * id + k], half * (double)FLT_EPSILON / 2 + ulp, 0);
            assert_true((double)fabsf(p->position[3 * i + k]) <= half);
            assert_true(p->velocity[3 * i + k] == c->velocity[3 * id + k]);
        }
        assert_true(p->density[i] == c->density[id] && p->lifetime[i] == c->lifetime[id]);
        assert_int_equal(p->neighbours[i], c->neighbours[id]);
        assert_int_equal(p->kind[i], c->kind[id]);
    }
    assert_true(p->radius == 0.02385);
    ssfr_particles_destroy(&p);
    assert_null(p);
}

static void packing_keeps_every_particle_and_its_values(void **state)
{
    (void)state;
    cloud *c = make_cloud((double[3]){0.3, -0.2, 2.385});
    check_cloud(c);
    free(c);
}

static void packing_is_as_exact_a_million_metres_away(void **state)
{
    (void)state;
    cloud *c = make_cloud((double[3]){1e6, -1e6, 2.385e6});
    check_cloud(c);
    free(c);
}

static void packing_the_same_particles_gives_the_same_order(void **state)
{
    (void)state;
    cloud *c = make_cloud((double[3]){0, 0, 0});
    ssfr_particles *a = create(N, c->positions, &c->given), *b = create(N, c->positions, &c->given);
    assert_memory_equal(a->id, b->id, N * sizeof *a->id);
    assert_memory_equal(a->position, b->position, 3 * N * sizeof *a->position);
    assert_true(b->serial > a->serial);
    ssfr_particles_destroy(&a);
    ssfr_particles_destroy(&b);
    free(c);
}

static void particles_at_one_place_keep_their_order(void **state)
{
    (void)state;
    double positions[3 * 700];
    uint32_t id[700];
    for (uint32_t i = 0; i < 700; i++) {
        id[i] = i;
        for (size_t k = 0; k < 3; k++) positions[3 * i + k] = i % 2 ? 2.385 : 1.117;
    }
    ssfr_particles *p = create(700, positions, &(ssfr_particles){.id = id});
    for (uint32_t i = 0; i < 700; i++) assert_int_equal(p->id[i], i < 350 ? 2 * i : 2 * (i - 350) + 1);
    assert_int_equal(p->n_packets, (700 + SSFR_PACKET - 1) / SSFR_PACKET);
    for (size_t i = 0; i < p->n_packets; i++) /* one packet holds particles of both places */
        assert_true(i == 350 / SSFR_PACKET ? p->packets[i].half[1] > 0.6f : p->packets[i].half[1] == 0.0f);
    assert_close(ssfr_particles_spacing(p), 0, 0, 0);
    ssfr_particles_destroy(&p);
}

/* side^3 points, `step` m apart, in an order that has nothing to do with space. */
static double *make_lattice(int side, double step)
{
    const size_t n = (size_t)(side * side * side);
    double *positions = calloc(n, 3 * sizeof *positions);
    assert_non_null(positions);
    for (size_t i = 0; i < n; i++) {
        const int cell = (int)(i * 2385 % n); /* odd, and n a power of two: every cell once */
        positions[3 * i] = 0.7 + step * (cell % side);
        positions[3 * i + 1] = -3.1 + step * (cell / side % side);
        positions[3 * i + 2] = step * (cell / side / side);
    }
    return positions;
}

static void packets_of_a_lattice_are_its_blocks(void **state)
{
    (void)state;
    double *positions = make_lattice(32, 0.125);
    ssfr_particles *p = create(32 * 32 * 32, positions, NULL);
    double lo[3], hi[3];
    assert_int_equal(p->n_packets, 32 * 32 * 32 / SSFR_PACKET);
    for (size_t i = 0; i < p->n_packets; i++) /* 4 x 4 x 4 particles */
        for (int k = 0; k < 3; k++) assert_close((double)p->packets[i].half[k], 1.5 * 0.125, 0, 1e-5);
    ssfr_particles_bounds(p, lo, hi);
    assert_close(lo[0], 0.7, 1e-7, 0);
    assert_close(hi[1], -3.1 + 31 * 0.125, 1e-7, 0);
    assert_close(hi[2], 31 * 0.125, 1e-7, 0);
    assert_close(ssfr_particles_spacing(p), 0.0625, 1e-7, 0);
    assert_null(p->velocity);
    assert_true(p->radius == 0);
    ssfr_particles_destroy(&p);
    free(positions);
}

static void spacing_is_half_the_median_distance_to_the_nearest(void **state)
{
    (void)state;
    enum { SOME = 400 }; /* few enough that all are samples, more than a packet */
    cloud *c = make_cloud((double[3]){2.385e5, 0, -17});
    double distances[SOME];
    for (size_t i = 0; i < SOME; i++) {
        distances[i] = INFINITY;
        for (size_t j = 0; j < SOME; j++) {
            const double *a = c->positions + 3 * i, *b = c->positions + 3 * j;
            const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
            if (i != j) distances[i] = fmin(distances[i], sqrt(ssfr_dot(d, d)));
        }
    }
    qsort(distances, SOME, sizeof *distances, ssfr_by_value);
    ssfr_particles *p = create(SOME, c->positions, NULL);
    assert_close(ssfr_particles_spacing(p), 0.25 * (distances[SOME / 2 - 1] + distances[SOME / 2]), 0, 1e-6);
    ssfr_particles_destroy(&p);
    free(c);
}

static void no_particles_and_one_particle_are_sets(void **state)
{
    (void)state;
    const double position[3] = {2.385, -1e6, 0.1};
    double lo[3], hi[3];
    ssfr_particles *none = create(0, NULL, NULL), *one = create(1, position, NULL);
    assert_int_equal(none->n_packets, 0);
    assert_true(ssfr_particles_spacing(none) == 0 && ssfr_particles_spacing(one) == 0);
    ssfr_particles_bounds(none, lo, hi);
    for (int k = 0; k < 3; k++) assert_true(lo[k] == 0 && hi[k] == 0);
    ssfr_particles_bounds(one, lo, hi);
    for (int k = 0; k < 3; k++) assert_true(lo[k] == position[k] && hi[k] == position[k]);
    ssfr_particles_destroy(&none);
    ssfr_particles_destroy(&one);
    ssfr_particles_destroy(&one);
    assert_null(one);
}

static void packing_refuses_what_is_not_finite_or_too_far_apart(void **state)
{
    (void)state;
    ssfr_particles *p = NULL;
    double positions[6] = {0, 0, 0, 1, NAN, 1};
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_create(&p, 2, positions, NULL), "1 (from 0): position (1, nan, 1)");
    positions[4] = -INFINITY;
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_create(&p, 2, positions, NULL), "-inf");
    positions[4] = 1e300;
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_create(&p, 2, positions, NULL), "from 0 to 1e+300 m along y");
    positions[4] = 1e30;
    const ssfr_particles odd = {.radius = -2.385}, odder = {.radius = NAN};
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_create(&p, 2, positions, &odd), "radius -2.385 m");
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_create(&p, 2, positions, &odder), "radius nan m");
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_create(&p, (size_t)UINT32_MAX + 1, positions, NULL), "4294967296");
    assert_null(p);
    p = create(2, positions, NULL);
    assert_close((double)p->packets[0].half[1], 5e29, 0, 1e-5);
    ssfr_particles_destroy(&p);
}

/* ---- what all formats share -------------------------------------------------------------------------------------- */

/* An ascii PLY file of n particles, a line of x, y and z each. */
static const char *ply_file(const char *name, int n, const char *lines)
{
    bytes b = {0};
    put_text(&b, "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n", n);
    put_text(&b, "end_header\n%s", lines);
    return particle_file(name, b.data, b.n);
}

static const char two[] = "0 0 0\n0 2.385 0\n";

static void the_format_is_told_by_the_ending_in_any_case(void **state)
{
    (void)state;
    ssfr_particles *p = load(ply_file("two.PLY", 2, two));
    assert_int_equal(p->n, 2);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_particles_save(p, test_path("two.obj")), ".h5 .hdf5 .ply .vtk .pos");
    ssfr_particles_destroy(&p);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_particles_load(&p, "a.ply/two.obj", NULL), ".h5 .hdf5 .ply .vtk .pos");
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_particles_load(&p, "ply", NULL), "ply: the names");
}

static void the_formats_are_listed_a_line_each(void **state)
{
    (void)state;
#define X(ending, reader, writer, holds, help) ending,
    static const char *const endings[] = {
#include "scene/formats.def"
    };
#undef X
    int n_lines = 0;
    for (const char *c = ssfr_particle_formats(); *c; c++) n_lines += *c == '\n';
    assert_int_equal(n_lines, SSFR_COUNT(endings));
    for (size_t i = 0; i < SSFR_COUNT(endings); i++) assert_non_null(strstr(ssfr_particle_formats(), endings[i]));
}

static void a_missing_radius_is_estimated_and_told(void **state)
{
    ssfr_particles *p = load_and_listen(state, ply_file("two.ply", 2, two));
    assert_close(p->radius, 1.1925, 1e-6, 0);
    assert_non_null(strstr(told, "1.1925 m"));
    ssfr_particles_destroy(&p);
}

static void a_radius_from_the_caller_wins(void **state)
{
    (void)state;
    ssfr_particles *p = NULL;
    ssfr_load_options options = {.radius = 0.5};
    const char *path = ply_file("two.ply", 2, two);
    assert_int_equal(ssfr_particles_load(&p, path, &options), SSFR_OK);
    assert_true(p->radius == 0.5);
    ssfr_particles_destroy(&p);
    options.radius = -0.5;
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_load(&p, path, &options), "radius -0.5 m");
    options.radius = INFINITY;
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_load(&p, path, &options), "radius inf m");
}

static void a_radius_is_asked_for_where_there_is_no_spacing(void **state)
{
    (void)state;
    ssfr_particles *p = NULL;
    const char *same = ply_file("same.ply", 2, "2.385 0 0\n2.385 0 0\n"), *one = ply_file("one.ply", 1, "0 2.385 0\n");
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_load(&p, same, NULL), "none, and its 2 particles give none");
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_load(&p, one, NULL), "none, and its 1 particle");
    ssfr_load_options options = {.radius = 2.385};
    assert_int_equal(ssfr_particles_load(&p, one, &options), SSFR_OK);
    assert_int_equal(p->n, 1);
    ssfr_particles_destroy(&p);
}

static void numbers_have_decimal_points_in_every_locale(void **state)
{
    (void)state;
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8")) skip();
    ssfr_particles *p = load(ply_file("two.ply", 2, two));
    setlocale(LC_NUMERIC, "C");
    find_particle(p, 0, 2.385, 0);
    ssfr_particles_destroy(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packing_keeps_every_particle_and_its_values),
        cmocka_unit_test(packing_is_as_exact_a_million_metres_away),
        cmocka_unit_test(packing_the_same_particles_gives_the_same_order),
        cmocka_unit_test(particles_at_one_place_keep_their_order),
        cmocka_unit_test(packets_of_a_lattice_are_its_blocks),
        cmocka_unit_test(spacing_is_half_the_median_distance_to_the_nearest),
        cmocka_unit_test(no_particles_and_one_particle_are_sets),
        cmocka_unit_test(packing_refuses_what_is_not_finite_or_too_far_apart),
        cmocka_unit_test(the_format_is_told_by_the_ending_in_any_case),
        cmocka_unit_test(the_formats_are_listed_a_line_each),
        cmocka_unit_test(a_missing_radius_is_estimated_and_told),
        cmocka_unit_test(a_radius_from_the_caller_wins),
        cmocka_unit_test(a_radius_is_asked_for_where_there_is_no_spacing),
        cmocka_unit_test(numbers_have_decimal_points_in_every_locale),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

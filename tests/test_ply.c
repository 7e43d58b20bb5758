/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_ply.c: PLY particles in all encodings and types, what must be refused, and a simulator's own files. */
#include "tests/particle_files.h"

static const char *const type_names[] = {"char", "uchar",  "short",  "ushort",  "int",
                                         "uint", "int64", "uint64", "float32", "double"};

static const double places[3][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, -9}};

/* Three particles with every property known, one unknown and a list, all numbers of one type but for the positions. */
static bytes make_file(ssfr_encoding encoding, ssfr_scalar type)
{
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    static const char *const names[] = {"vx", "vy", "vz", "density", "lifetime", "neighbors", "id", "type"};
    bytes b = {0};
    put_text(&b, "ply\r\nformat %s 1.0\ncomment particle radius 0.02385 m, and more\n", formats[encoding]);
    put_text(&b, "obj_info none\nelement camera 2\nproperty float focus\nproperty list uchar short bends\n");
    put_text(&b, "element vertex 3\nproperty list uchar int around\nproperty double z\nproperty float colour\n");
    put_text(&b, "property double x\nproperty float y\n");
    for (size_t k = 0; k < SSFR_COUNT(names); k++) put_text(&b, "property %s %s\n", type_names[type], names[k]);
    put_text(&b, "element face 1\nproperty list uchar int vertex_indices\nend_header\n");
    const bool big = encoding == SSFR_BIG_ENDIAN, ascii = encoding == SSFR_ASCII;
    if (ascii) put_text(&b, "35 2 -1 7\n\n50 0\n");
    for (int i = 0; i < 2 && !ascii; i++) {
        put_number(&b, SSFR_FLOAT32, big, 35);
        put_number(&b, SSFR_UINT8, big, 2 * i);
        for (int k = 0; k < 2 * i; k++) put_number(&b, SSFR_INT16, big, -7);
    }
    for (int i = 0; i < 3; i++) {
        const double *p = places[i];
        if (ascii) put_text(&b, "%d%s %g 0.5 %g \t%g", i, i == 2 ? " 17 18" : i == 1 ? " 17" : "", p[2], p[0], p[1]);
        for (int k = 0; k < 8 && ascii; k++) put_text(&b, " %d", 10 * k + i);
        if (ascii) put_text(&b, " \n");
        if (ascii) continue;
        put_number(&b, SSFR_UINT8, big, i);
        for (int k = 0; k < i; k++) put_number(&b, SSFR_INT32, big, -17);
        put_number(&b, SSFR_FLOAT64, big, p[2]);
        put_number(&b, SSFR_FLOAT32, big, 0.5);
        put_number(&b, SSFR_FLOAT64, big, p[0]);
        put_number(&b, SSFR_FLOAT32, big, p[1]);
        for (int k = 0; k < 8; k++) put_number(&b, type, big, 10 * k + i);
    }
    if (ascii) put_text(&b, "3 0 1 2\n");
    if (!ascii) put_number(&b, SSFR_UINT8, big, 0);
    return b;
}

static void every_encoding_and_type_gives_the_same_particles(void **state)
{
    (void)state;
    for (int encoding = SSFR_ASCII; encoding <= SSFR_BIG_ENDIAN; encoding++)
        for (int type = SSFR_INT8; type <= SSFR_FLOAT64; type++) {
            const bytes b = make_file((ssfr_encoding)encoding, (ssfr_scalar)type);
            ssfr_particles *p = load(particle_file("all.ply", b.data, b.n));
            assert_int_equal(p->n, 3);
            assert_true(p->radius == 0.02385);
            for (uint32_t i = 0; i < 3; i++) {
                const size_t at = find_particle(p, places[i][0], places[i][1], places[i][2]);
                for (uint32_t k = 0; k < 3; k++) assert_true(p->velocity[3 * at + k] == (float)(10 * k + i));
                assert_true(p->density[at] == (float)(30 + i) && p->lifetime[at] == (float)(40 + i));
                assert_int_equal(p->neighbours[at], 50 + i);
                assert_int_equal(p->id[at], 60 + i);
                assert_int_equal(p->kind[at], 70 + i);
            }
            ssfr_particles_destroy(&p);
        }
}

static void numbers_of_every_type_keep_their_sign_and_size(void **state)
{
    (void)state;
    static const double values[] = {-128, 255, -32768, 65535, -2147483648.0, 4294967295.0, -9007199254740992.0,
                                    9007199254740992.0, 2.385f, 2.385};
    for (int type = SSFR_INT8; type <= SSFR_FLOAT64; type++)
        for (int big = 0; big < 2; big++) {
            bytes b = {0};
            put_text(&b, "ply\nformat binary_%s_endian 1.0\nelement vertex 1\n", big ? "big" : "little");
            for (int k = 0; k < 3; k++) put_text(&b, "property %s %c\n", type_names[type], "xyz"[k]);
            put_text(&b, "comment particle radius 1.5\nend_header\n");
            for (int k = 0; k < 3; k++) put_number(&b, (ssfr_scalar)type, big, k == 1 ? values[type] : 1);
            ssfr_particles *p = load(particle_file("types.ply", b.data, b.n));
            double at[3];
            ssfr_particles_position(p, 0, at);
            assert_true(at[0] == 1 && at[1] == values[type] && at[2] == 1);
            ssfr_particles_destroy(&p);
        }
}

/* An ascii file of a header between format and end_header, and a body. */
static const char *ascii(const char *header, const char *body)
{
    bytes b = {0};
    put_text(&b, "ply\nformat ascii 1.0\n%send_header\n%s", header, body);
    return particle_file("ascii.ply", b.data, b.n);
}

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define ONE "comment particle radius 0.1 m\nelement vertex 1\n" XYZ

static void zero_particles_are_a_file(void **state)
{
    (void)state;
    ssfr_particles *p = load(ascii("element vertex 0\n" XYZ "property int id\n", ""));
    assert_int_equal(p->n, 0);
    assert_true(p->radius == 0);
    ssfr_particles_destroy(&p);
}

static void a_radius_stands_in_metres_in_a_comment(void **state)
{
    (void)state;
    static const char *const comments[] = {"particle radius 0.25 m", "particle radius 2.5e-1 m, support 1 m",
                                           "particle radius 0.25"};
    static const char *const others[] = {"particle radius 250 mm", "the particle radius 0.25 m",
                                         "particle radius is 2"};
    char header[256];
    ssfr_particles *p = NULL;
    for (size_t i = 0; i < SSFR_COUNT(comments); i++) {
        snprintf(header, sizeof header, "comment %s\nelement vertex 2\n" XYZ, comments[i]);
        p = load(ascii(header, "0 0 0\n2.385 0 0\n"));
        assert_true(p->radius == 0.25);
        ssfr_particles_destroy(&p);
        snprintf(header, sizeof header, "comment %s\nelement vertex 2\n" XYZ, others[i]);
        p = load(ascii(header, "0 0 0\n2.385 0 0\n"));
        assert_close(p->radius, 1.1925, 1e-6, 0);
        ssfr_particles_destroy(&p);
    }
    check_refused(ascii("comment particle radius -2.385 m\nelement vertex 1\n" XYZ, "0 0 0\n"), SSFR_ERR_FORMAT,
                  "radius is -2.385 m");
}

static void a_bad_header_is_refused_with_its_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
        ssfr_result code;
    } cases[] = {
        {"plx\n", ":1: expected ply, found \"plx\"", SSFR_ERR_FORMAT},
        {"ply", ":1: expected ply, found \"ply\"", SSFR_ERR_FORMAT},
        {"ply\nend_header\n", ":2: the header lacks a format line", SSFR_ERR_FORMAT},
        {"ply\nformat ascii 1.0\n", ":3: the file ends before end_header", SSFR_ERR_FORMAT},
        {"ply\nformat text 1.0\n", ":2: expected ascii, binary_little_endian", SSFR_ERR_FORMAT},
        {"ply\nformat ascii 2.385\n", ":2: expected version 1.0, found \"2.385\"", SSFR_ERR_FORMAT},
        {"ply\n\001\377bad\n", ":2: expected a header line, found \"\?\?bad\"", SSFR_ERR_FORMAT},
        {"ply\n\n", ":2: expected a header line, found \"\"", SSFR_ERR_FORMAT},
        {"ply\nproperty float x\n", ":2: expected an element before", SSFR_ERR_FORMAT},
        {"ply\nelement vertex -5\n", ":2: expected an element's count, found \"-5\"", SSFR_ERR_FORMAT},
        {"ply\nelement vertex 2.385\n", "found \"2.385\"", SSFR_ERR_FORMAT},
        {"ply\nelement vertex 99999999999999999999\n", "found \"99999999999999999999\"", SSFR_ERR_FORMAT},
        {"ply\nelement vertex\n", "expected an element's count, found \"\"", SSFR_ERR_FORMAT},
        {"ply\nelement vertex 1 2\n", "expected the line's end, found \"2\"", SSFR_ERR_FORMAT},
        {"ply\nelement vertex 1\nproperty half x\n", ":3: expected a scalar type, found \"half\"", SSFR_ERR_FORMAT},
        {"ply\nelement vertex 1\nproperty float\n", ":3: expected a property's name", SSFR_ERR_FORMAT},
        {"ply\nelement vertex 1\nproperty float x y\n", "expected the line's end, found \"y\"", SSFR_ERR_FORMAT},
        {"ply\nelement vertex 1\nproperty list float int x\n", "expected a whole type", SSFR_ERR_FORMAT},
        {"ply\nelement vertex 1\nproperty list int half x\n", "found \"half\"", SSFR_ERR_FORMAT},
        {"ply\nformat ascii 1.0\nend_header\n", "no vertex element", SSFR_ERR_FORMAT},
        {"ply\nformat ascii 1.0\nelement vertex 0\nend_header\n", "lack x, y or z", SSFR_ERR_FORMAT},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        check_refused(text_file("header.ply", cases[i].text), cases[i].code, cases[i].says);
}

static void more_elements_or_properties_than_supported_are_refused(void **state)
{
    (void)state;
    bytes b = {0};
    for (int i = 0; i < 33; i++) put_text(&b, "element e%d 0\n", i);
    check_refused(ascii(b.data, ""), SSFR_ERR_UNSUPPORTED, "more than 32 elements");
    b = (bytes){0};
    put_text(&b, "element vertex 0\n");
    for (int i = 0; i < 257; i++) put_text(&b, "property int p%d\n", i);
    check_refused(ascii(b.data, ""), SSFR_ERR_UNSUPPORTED, "more than 256 properties");
}

static void vertices_without_whole_vectors_are_refused(void **state)
{
    (void)state;
    check_refused(ascii("element vertex 1\nproperty float x\nproperty float z\n", "1 2\n"), SSFR_ERR_FORMAT,
                  "lack x, y or z");
    check_refused(ascii("element vertex 1\nproperty list int int x\nproperty float y\nproperty float z\n", "0 1 2\n"),
                  SSFR_ERR_FORMAT, "lack x, y or z");
    check_refused(ascii(ONE "property float vx\n", "1 2 3 4\n"), SSFR_ERR_FORMAT, "lack a component of velocity");
    check_refused(ascii(ONE "property float x\n", "1 2 3 4\n"), SSFR_ERR_FORMAT, "two columns for what x");
    check_refused(ascii(ONE "property int neighbors\nproperty int neighbours\n", "1 2 3 4 5\n"), SSFR_ERR_FORMAT,
                  "what neighbours says");
}

static void counts_that_the_file_cannot_hold_are_refused(void **state)
{
    (void)state;
    bytes b = {0};
    put_text(&b, "ply\nformat binary_little_endian 1.0\nelement vertex 9999999999999999999\n" XYZ "end_header\n");
    put_text(&b, "only these bytes");
    check_refused(particle_file("absurd.ply", b.data, b.n), SSFR_ERR_FORMAT,
                  "9999999999999999999 particles of at least 12 bytes are announced, but 16 bytes follow");
    check_refused(ascii("element vertex 3\n" XYZ, "1 2 3\n4 5 6\n"), SSFR_ERR_FORMAT, "3 particles of at least 6");
    check_refused(ascii("element vertex 9999999999999999999\n", ""), SSFR_ERR_FORMAT, "9999999999999999999 particles");
    check_refused(ascii("element bend 9999999999999999999\nelement vertex 1\n" XYZ, "1 2\n"), SSFR_ERR_FORMAT,
                  "1 particles of at least 6 bytes");
}

static void a_bad_body_is_refused_with_the_particle(void **state)
{
    (void)state;
    static const char three[] = "element vertex 3\n" XYZ, listed[] = ONE "property list char int around\n";
    check_refused(ascii(three, "1 2 3\n4 5\n7 8 9 10\n"), SSFR_ERR_FORMAT, "particle 1 (from 0): z: the line ends");
    check_refused(ascii(three, "1 2 3\n4 5 6 7\n8 9 10\n"), SSFR_ERR_FORMAT, "after its last property: found \"7\"");
    check_refused(ascii(three, "1 2 3\n4 five 6\n7 8 9\n"), SSFR_ERR_FORMAT, "y: found \"five\"");
    check_refused(ascii(three, "1 2 3\n4 5m 6\n7 8 9\n"), SSFR_ERR_FORMAT, "y: found \"5m\"");
    check_refused(ascii(three, "11 22 33\n44 55 66\n"), SSFR_ERR_FORMAT, "particle 2 (from 0): x: the file ends");
    check_refused(ascii(three, "1 2 3\n4 5 6\n7 8 9\n9\n"), SSFR_ERR_FORMAT, "2 bytes follow the last particle");
    check_refused(ascii(listed, "1 2 3 -1\n"), SSFR_ERR_FORMAT, "around: the list's length is no count");
    check_refused(ascii(listed, "1 2 3 2 1\n"), SSFR_ERR_FORMAT, "around: the list is longer");
    check_refused(ascii(listed, "1 2 3 99999999\n"), SSFR_ERR_FORMAT, "around: the list is longer");
    check_refused(ascii(listed, "1 2 3 \n     "), SSFR_ERR_FORMAT, "around: the line ends");
    check_refused(ascii(ONE "property float id\n", "1 2 3 2.5\n"), SSFR_ERR_FORMAT, "id is 2.5, expected a whole");
    check_refused(ascii(ONE "property int kind\n", "1 2 3 -1\n"), SSFR_ERR_FORMAT, "kind is -1, expected");
    check_refused(ascii(ONE "property double id\n", "1 2 3 4294967296\n"), SSFR_ERR_FORMAT, "id is 4294967296,");
    check_refused(ascii("element bend 1\nproperty float x\nelement vertex 1\n" XYZ, "a\n1 2 3\n"), SSFR_ERR_FORMAT,
                  "bend 0 (from 0): x: found \"a\"");
}

static void values_that_are_not_finite_are_refused_or_dropped(void **state)
{
    (void)state;
    static const char *const bodies[] = {"0 0 0 1 1 1 9 0\n1 nan 0 1 1 1 9 1\n2 0 0 1 1 1 9 2\n",
                                         "0 0 0 1 1 1 9 0\n1 0 0 1 -inf 1 9 1\n2 0 0 1 1 1 9 2\n",
                                         "0 0 0 1 1 1 9 0\n1 0 0 1 1 1 1e39 1\n2 0 0 1 1 1 9 2\n"};
    static const char *const says[] = {"particle 1 (from 0): position is nan", "particle 1 (from 0): velocity is -inf",
                                       "particle 1 (from 0): density is inf"};
    static const char header[] = "element vertex 3\n" XYZ "property float vx\nproperty float vy\nproperty float vz\n"
                                 "property double density\nproperty int id\n";
    for (size_t i = 0; i < SSFR_COUNT(bodies); i++) {
        ssfr_load_options options = {.drop_nonfinite = true, .n_dropped = 99};
        ssfr_particles *p = NULL;
        const char *path = ascii(header, bodies[i]);
        check_refused(path, SSFR_ERR_VALUE, says[i]);
        assert_int_equal(ssfr_particles_load(&p, path, &options), SSFR_OK);
        assert_int_equal(options.n_dropped, 1);
        assert_int_equal(p->n, 2);
        assert_int_equal(p->id[find_particle(p, 0, 0, 0)], 0);
        assert_int_equal(p->id[find_particle(p, 2, 0, 0)], 2);
        assert_close(p->radius, 1, 1e-7, 0);
        ssfr_particles_destroy(&p);
    }
}

static void a_file_cut_anywhere_or_damaged_never_harms(void **state)
{
    (void)state;
    for (int encoding = SSFR_ASCII; encoding <= SSFR_BIG_ENDIAN; encoding++) {
        const bytes b = make_file((ssfr_encoding)encoding, SSFR_FLOAT32);
        check_truncations("cut.ply", b.data, b.n);
        check_damage("damaged.ply", b.data, b.n);
    }
}

static void a_radius_may_be_a_property_of_one_value(void **state)
{
    (void)state;
    static const char two[] = "element vertex 2\n" XYZ "property double Radius\n";
    char header[256];
    ssfr_particles *p = load(ascii(two, "0 0 0 0.25\n2.385 0 0 0.25\n"));
    assert_true(p->radius == 0.25);
    ssfr_particles_destroy(&p);
    p = load(ascii(two, "0 0 0 0.25\n2.385 0 0 0.5\n"));
    assert_close(p->radius, 1.1925, 1e-6, 0); /* from the spacing */
    ssfr_particles_destroy(&p);
    snprintf(header, sizeof header, "comment particle radius 0.5 m\n%s", two);
    p = load(ascii(header, "0 0 0 0.25\n2.385 0 0 0.25\n"));
    assert_true(p->radius == 0.5);
    ssfr_particles_destroy(&p);
    check_refused(ascii(two, "0 0 0 0.25\n2.385 0 0 inf\n"), SSFR_ERR_FORMAT, "particle 1 (from 0): radius is inf m");
}

/* The two particles stay in the order given. */
static void check_written(double x, const char *type, ssfr_scalar scalar)
{
    const double positions[] = {x, -0.5, 0.25, x, -0.5, 0.25};
    float velocity[] = {1, -2.385f, 0.5f, 4, 5, -0.0f}, density[] = {998.5f, 1001.25f};
    uint32_t kind[] = {0, 4294967295u};
    ssfr_particles *p = NULL;
    char *file = NULL;
    size_t n = 0;
    bytes b = {0};
    const ssfr_particles given = {.velocity = velocity, .density = density, .kind = kind, .radius = 0.1};
    put_text(&b, "ply\nformat binary_little_endian 1.0\ncomment metres, seconds, kilograms\n");
    put_text(&b, "comment particle radius 0.10000000000000001 m\nelement vertex 2\n");
    for (int k = 0; k < 3; k++) put_text(&b, "property %s %c\n", type, "xyz"[k]);
    put_text(&b, "property float vx\nproperty float vy\nproperty float vz\nproperty float density\n");
    put_text(&b, "property uint kind\nend_header\n");
    for (size_t i = 0; i < 2; i++) {
        for (size_t k = 0; k < 3; k++) put_number(&b, scalar, false, positions[3 * i + k]);
        for (size_t k = 0; k < 3; k++) put_number(&b, SSFR_FLOAT32, false, (double)velocity[3 * i + k]);
        put_number(&b, SSFR_FLOAT32, false, (double)density[i]);
        put_number(&b, SSFR_UINT32, false, kind[i]);
    }
    assert_int_equal(ssfr_particles_create(&p, 2, positions, &given), SSFR_OK);
    assert_int_equal(ssfr_particles_save(p, test_path("written.ply")), SSFR_OK);
    assert_int_equal(ssfr_read_file(test_path("written.ply"), SSFR_READ_MAX, &file, &n), SSFR_OK);
    assert_int_equal(n, b.n);
    assert_memory_equal(file, b.data, n);
    free(file);
    ssfr_particles_destroy(&p);
}

static void positions_are_written_as_doubles_only_where_floats_would_lose(void **state)
{
    (void)state;
    check_written(0.375, "float", SSFR_FLOAT32);
    check_written(1e6 + 0.0625, "float", SSFR_FLOAT32);
    check_written(2.385, "double", SSFR_FLOAT64);
    check_written(1e6 + 0.03125, "double", SSFR_FLOAT64);
}

static void what_is_no_file_is_refused(void **state)
{
    (void)state;
    check_no_files(".ply");
}

static void a_simulators_foam_has_kinds_and_lifetimes(void **state)
{
    (void)state;
    char path[512];
    size_t kinds[3] = {0};
    double shortest = INFINITY, longest = 0;
    ssfr_load_options options = {.radius = 0.01};
    ssfr_particles *p = NULL;
    snprintf(path, sizeof path, "%s/ddb_early_foam.ply", test_data_or_skip());
    assert_int_equal(ssfr_particles_load(&p, path, &options), SSFR_OK);
    assert_int_equal(p->n, 154204);
    for (size_t i = 0; i < p->n; i++) {
        assert_in_range(p->kind[i], 0, 2);
        kinds[p->kind[i]]++;
        shortest = fmin(shortest, (double)p->lifetime[i]);
        longest = fmax(longest, (double)p->lifetime[i]);
    }
    assert_int_equal(kinds[0], 1300);
    assert_int_equal(kinds[1], 23536);
    assert_int_equal(kinds[2], 129368);
    assert_close(shortest, 1.73196, 1e-5, 0);
    assert_close(longest, 4.1362, 1e-5, 0);
    assert_null(p->density);
    ssfr_particles_destroy(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_encoding_and_type_gives_the_same_particles),
        cmocka_unit_test(numbers_of_every_type_keep_their_sign_and_size),
        cmocka_unit_test(zero_particles_are_a_file),
        cmocka_unit_test(a_radius_stands_in_metres_in_a_comment),
        cmocka_unit_test(a_bad_header_is_refused_with_its_line),
        cmocka_unit_test(more_elements_or_properties_than_supported_are_refused),
        cmocka_unit_test(vertices_without_whole_vectors_are_refused),
        cmocka_unit_test(counts_that_the_file_cannot_hold_are_refused),
        cmocka_unit_test(a_bad_body_is_refused_with_the_particle),
        cmocka_unit_test(values_that_are_not_finite_are_refused_or_dropped),
        cmocka_unit_test(a_file_cut_anywhere_or_damaged_never_harms),
        cmocka_unit_test(a_radius_may_be_a_property_of_one_value),
        cmocka_unit_test(positions_are_written_as_doubles_only_where_floats_would_lose),
        cmocka_unit_test(what_is_no_file_is_refused),
        cmocka_unit_test(a_simulators_foam_has_kinds_and_lifetimes),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

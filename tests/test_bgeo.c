/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_bgeo.c: particles in Houdini's classic format: read plain and gzipped, written, what must be refused, and a
 * simulator's own file. */
#include "tests/particle_files.h"

#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

enum { N = 3, FLOAT = 0, INT = 1, STRING = 2, WORD = 4, VECTOR = 5 };

/* ---- files in the making ----------------------------------------------------------------------------------------- */

static void put16(bytes *b, double value)
{
    put_number(b, SSFR_UINT16, true, value);
}

static void put32(bytes *b, double value)
{
    put_number(b, SSFR_UINT32, true, value);
}

static void put_header(bytes *b, double version, double n_points, double n_attributes)
{
    const double counts[] = {version, n_points, 7, 0, 0, n_attributes, 0, 0, 0}; /* 7 primitives that are not read */
    put_text(b, "BgeoV");
    for (size_t i = 0; i < SSFR_COUNT(counts); i++) put32(b, counts[i]);
}

static void put_attribute(bytes *b, const char *name, int size, int type)
{
    put16(b, (double)strlen(name));
    put_text(b, "%s", name);
    put16(b, size);
    put32(b, type);
    for (int k = 0; k < size && type != WORD; k++) put_number(b, SSFR_FLOAT32, true, 23.85);
    if (type != WORD) return;
    put32(b, 2);
    for (int k = 1; k <= 2; k++) {
        put16(b, k);
        put_text(b, "%.*s", k, "no");
    }
}

static const struct attribute {
    const char *name;
    int size, type;
} attributes[] = {
    {"colour", 3, FLOAT},    {"ID", 1, INT},    {"material", 1, WORD}, {"v", 3, VECTOR},     {"uv", 2, VECTOR},
    {"Neighbors", 1, FLOAT}, {"rho", 1, FLOAT}, {"pscale", 1, FLOAT},  {"lifetime", 1, INT}, {"many", 5, INT},
};

/* Value k of an attribute of particle i; whole, so that it can be of any type. */
static double value_of(size_t a, size_t i, int k)
{
    return strcmp(attributes[a].name, "pscale") == 0 ? 2 : 100 * (double)a + 10 * (double)i + k;
}

/* Three particles at (0, 1, 2), (3, 4, 5), (6, 7, 8.25). */
static bytes make_file(void)
{
    bytes b = {0};
    put_header(&b, 5, N, SSFR_COUNT(attributes));
    for (size_t a = 0; a < SSFR_COUNT(attributes); a++)
        put_attribute(&b, attributes[a].name, attributes[a].size, attributes[a].type);
    for (size_t i = 0; i < N; i++) {
        for (size_t k = 0; k < 3; k++)
            put_number(&b, SSFR_FLOAT32, true, i == 2 && k == 2 ? 8.25 : (double)(3 * i + k));
        put_number(&b, SSFR_FLOAT32, true, 1);
        for (size_t a = 0; a < SSFR_COUNT(attributes); a++)
            for (int k = 0; k < attributes[a].size; k++)
                put_number(&b, attributes[a].type == FLOAT || attributes[a].type == VECTOR ? SSFR_FLOAT32 : SSFR_INT32,
                           true, value_of(a, i, k));
    }
    put_text(&b, "what follows is not read");
    return b;
}

/* The bytes from `first` to before `last`, gzipped, at the end of `out`. */
static void put_gzipped(bytes *out, const bytes *b, size_t first, size_t last)
{
    z_stream z = {.next_in = (Bytef *)(uintptr_t)(b->data + first), .avail_in = (uInt)(last - first)};
    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
    z.next_out = (Bytef *)out->data + out->n;
    z.avail_out = (uInt)(sizeof out->data - out->n);
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    out->n += z.total_out;
    deflateEnd(&z);
}

static bytes gzipped(const bytes *b)
{
    bytes out = {0};
    put_gzipped(&out, b, 0, b->n);
    return out;
}

static void assert_refused(const bytes *b, ssfr_result code, const char *text)
{
    check_refused(particle_file("bad.bgeo", b->data, b->n), code, text);
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static void check_file(const char *name, const bytes *b)
{
    ssfr_particles *p = load(particle_file(name, b->data, b->n));
    assert_int_equal(p->n, N);
    assert_true(p->radius == 2);
    assert_true(!p->kind && !p->age && !p->initial_lifetime);
    for (size_t i = 0; i < N; i++) {
        const double x = 3 * (double)i;
        const size_t at = find_particle(p, x, x + 1, i == 2 ? 8.25 : x + 2);
        assert_int_equal(p->id[at], 100 + 10 * i);
        assert_int_equal(p->neighbours[at], 500 + 10 * i);
        assert_true(p->density[at] == (float)(600 + 10 * i) && p->lifetime[at] == (float)(800 + 10 * i));
        for (size_t k = 0; k < 3; k++) assert_true(p->velocity[3 * at + k] == (float)(300 + 10 * i + k));
    }
    ssfr_particles_destroy(&p);
}

static void attributes_are_found_by_name_among_others(void **state)
{
    (void)state;
    const bytes b = make_file();
    check_file("plain.bgeo", &b);
    check_file("plain.BGEO", &b);
    check_file("plain.bhclassic", &b);
}

static void gzipped_files_are_told_by_their_first_bytes(void **state)
{
    (void)state;
    const bytes b = make_file(), z = gzipped(&b);
    bytes parts = {0};
    check_file("packed.bgeo", &z);
    check_file("packed.bgeo.gz", &z);
    check_file("plain.bgeo.gz", &b);
    for (size_t at = 0; at <= b.n; at += 50) put_gzipped(&parts, &b, at, at + 50 < b.n ? at + 50 : b.n);
    check_file("parts.bgeo", &parts);
}

static void files_without_attributes_or_points_are_files(void **state)
{
    (void)state;
    bytes b = {0}, none = {0};
    put_header(&none, 5, 0, 0);
    ssfr_particles *p = load(particle_file("none.bgeo", none.data, none.n));
    assert_int_equal(p->n, 0);
    ssfr_particles_destroy(&p);
    put_header(&b, 5, 2, 0);
    for (int k = 0; k < 8; k++) put_number(&b, SSFR_FLOAT32, true, k == 4 ? 2.5 : 0);
    p = load(particle_file("bare.bgeo", b.data, b.n));
    assert_int_equal(p->n, 2);
    assert_close(p->radius, 1.25, 1e-9, 0);
    assert_true(!p->velocity && !p->id);
    ssfr_particles_destroy(&p);
}

/* Two particles with one attribute besides `velocity`, all of whose numbers are `value` in the second one. */
static bytes make_two(const char *name, int size, int type, double value)
{
    bytes b = {0};
    put_header(&b, 5, 2, 2);
    put_attribute(&b, "velocity", 3, VECTOR);
    put_attribute(&b, name, size, type);
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 7; k++) put_number(&b, SSFR_FLOAT32, true, 5 * i);
        for (int k = 0; k < size; k++)
            put_number(&b, type == INT || type == WORD ? SSFR_INT32 : SSFR_FLOAT32, true, i ? value : 0);
    }
    return b;
}

static void attributes_of_another_shape_are_skipped_with_a_warning(void **state)
{
    static const struct {
        const char *name;
        int size, type;
        const char *says;
    } cases[] = {
        {"density", 3, VECTOR, "density skipped: expected one attribute of 1 numbers, found type 5 of 3"},
        {"kind", 1, WORD, "kind skipped: expected one attribute of 1 numbers, found type 4 of 1"},
        {"vel", 3, FLOAT, "velocity skipped: expected one attribute of 3 numbers, found type 0 of 3"},
        {"pscale", 1, FLOAT, "the particles have radii from 0 to 1 m, none for all"},
        {"Temperature", 1, FLOAT, "two.bgeo: not read: \"Temperature\""},
        {"pscale", 1, INT, "two.bgeo: not read: \"pscale\""},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        const bytes b = make_two(cases[i].name, cases[i].size, cases[i].type, 1);
        ssfr_particles *p = load_and_listen(state, particle_file("two.bgeo", b.data, b.n));
        assert_non_null(strstr(told, cases[i].says));
        assert_true(p->velocity[3 * find_particle(p, 5, 5, 5)] == 5 && !p->density && !p->kind);
        assert_close(p->radius, 2.5 * sqrt(3), 1e-6, 0);
        ssfr_particles_destroy(&p);
    }
}

static void values_that_cannot_be_are_refused(void **state)
{
    (void)state;
    bytes b = make_two("id", 1, INT, -1);
    assert_refused(&b, SSFR_ERR_FORMAT, "bad.bgeo: particle 1 (from 0): id is -1, expected a whole number");
    b = make_two("id", 1, FLOAT, 2.5);
    assert_refused(&b, SSFR_ERR_FORMAT, "particle 1 (from 0): id is 2.5, expected a whole number");
    b = make_two("density", 1, FLOAT, INFINITY);
    assert_refused(&b, SSFR_ERR_VALUE, "particle 1 (from 0): density is inf");
}

static void headers_of_another_form_are_refused(void **state)
{
    (void)state;
    bytes b = {0};
    put_text(&b, "\x7fNSJb more of the newer format");
    assert_refused(&b, SSFR_ERR_UNSUPPORTED, "bad.bgeo: of Houdini's newer format: save it as .bhclassic");
    b.n = 0;
    put_text(&b, "PGEOMETRY V5");
    assert_refused(&b, SSFR_ERR_FORMAT, "bad.bgeo: expected BgeoV, found \"PGEOM\"");
    b.n = 0;
    put_header(&b, 6, 0, 0);
    assert_refused(&b, SSFR_ERR_UNSUPPORTED, "bad.bgeo: version 6: only 5 is read");
    b.n = 0;
    put_header(&b, 5, 1, 257);
    assert_refused(&b, SSFR_ERR_UNSUPPORTED, "bad.bgeo: 257 attributes: at most 256 are read");
    b = make_two("name", 1, STRING, 0);
    assert_refused(&b, SSFR_ERR_UNSUPPORTED, "bad.bgeo: attribute name of type 2: only 0, 1, 4 and 5 are read");
    b.n = 0;
    put_header(&b, 5, 1, 1);
    put16(&b, 0);
    put16(&b, 1);
    put32(&b, WORD);
    put32(&b, 1048577);
    assert_refused(&b, SSFR_ERR_UNSUPPORTED, "bad.bgeo: 1048577 words of an attribute: at most 1048576 are read");
}

static void files_that_end_too_early_say_what_is_missing(void **state)
{
    (void)state;
    static const struct {
        size_t n;
        const char *says;
    } cases[] = {
        {3, "bad.bgeo: expected BgeoV, the file ends"},
        {7, "bad.bgeo: expected the version, the file ends"},
        {10, "bad.bgeo: expected the count of points, the file ends"},
        {20, "bad.bgeo: expected counts, the file ends"},
        {27, "bad.bgeo: expected the count of attributes, the file ends"},
        {42, "bad.bgeo: expected the length of a name, the file ends"},
        {47, "bad.bgeo: expected a name, the file ends"},
        {52, "bad.bgeo: expected the size of an attribute, the file ends"},
        {55, "bad.bgeo: expected the type of an attribute, the file ends"},
        {65, "bad.bgeo: expected default values, the file ends"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        bytes b = make_two("id", 1, INT, 1);
        b.n = cases[i].n;
        assert_refused(&b, SSFR_ERR_FORMAT, cases[i].says);
        const bytes z = gzipped(&b);
        assert_refused(&z, SSFR_ERR_FORMAT, cases[i].says);
    }
}

/* Counts are held against the file's size before there is memory for them: gzipped, a thousand times of it. */
static void counts_that_the_file_cannot_hold_are_refused(void **state)
{
    (void)state;
    bytes b = {0};
    put_header(&b, 5, 4294967295.0, 0);
    for (int k = 0; k < 8; k++) put32(&b, 0);
    assert_refused(&b, SSFR_ERR_FORMAT,
                   "bad.bgeo: 4294967295 points of 16 bytes are announced, but at most 32 bytes follow");
    const bytes z = gzipped(&b);
    assert_refused(&z, SSFR_ERR_FORMAT, "bad.bgeo: 4294967295 points of 16 bytes are announced, but at most");
    bytes few = {0};
    put_header(&few, 5, 3, 0);
    for (int k = 0; k < 8; k++) put32(&few, 0);
    assert_refused(&few, SSFR_ERR_FORMAT, "3 points of 16 bytes are announced, but at most 32 bytes follow");
    const bytes packed = gzipped(&few);
    assert_refused(&packed, SSFR_ERR_FORMAT, "bad.bgeo: expected points, the file ends");
}

static void damaged_gzipped_data_are_refused(void **state)
{
    (void)state;
    const bytes b = make_file();
    bytes z = gzipped(&b);
    z.data[z.n - 6] = (char)(z.data[z.n - 6] ^ 1);
    assert_refused(&z, SSFR_ERR_FORMAT, "expected the end, but the gzipped data are damaged: incorrect data check");
    z = gzipped(&b);
    z.data[10] = (char)0xff;
    assert_refused(&z, SSFR_ERR_FORMAT, "expected BgeoV, but the gzipped data are damaged: invalid block type");
    z = gzipped(&b);
    z.n -= 5;
    assert_refused(&z, SSFR_ERR_FORMAT, "bad.bgeo: expected the end, the file ends");
}

static void a_file_cut_anywhere_or_damaged_never_harms(void **state)
{
    (void)state;
    const bytes b = make_file();
    const bytes z = gzipped(&b);
    check_damage("damaged.bgeo", b.data, b.n);
    check_damage("damaged.bgeo", z.data, z.n);
    check_truncations("cut.bgeo", b.data, b.n);
    check_truncations("cut.bgeo", z.data, z.n);
}

static void what_is_no_file_is_refused(void **state)
{
    (void)state;
    check_no_files(".bgeo");
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

enum { MANY = 1500 };

/* Particles whose positions and radius are floats; with all arrays, or with none. */
static ssfr_particles *make_particles(size_t n, bool arrays)
{
    static double positions[3 * MANY];
    ssfr_particles given = {.radius = (double)0.02385f}, *p = NULL;
    uint64_t seed = 23;
    for (size_t k = 0; k < 3 * n; k++) positions[k] = (double)(float)test_random(&seed, -2.385, 2.385);
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS && arrays; a++) {
        float *reals = calloc(n * a->count + 1, SSFR_ARRAY_VALUE);
        assert_non_null(reals);
        for (size_t k = 0; k < n * a->count; k++) {
            const uint32_t whole = (uint32_t)test_random(&seed, 0, 2147483648.0);
            reals[k] = (float)test_random(&seed, -1e6, 1e6);
            if (!a->real) memcpy(reals + k, &whole, sizeof whole);
        }
        ssfr_array_set(&given, a, reals);
    }
    assert_int_equal(ssfr_particles_create(&p, n, positions, &given), SSFR_OK);
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++) free(ssfr_array_get(&given, ssfr_arrays + a));
    return p;
}

static void assert_same(const ssfr_particles *a, const ssfr_particles *b)
{
    assert_int_equal(a->n, b->n);
    assert_true(a->radius == b->radius || a->n == 0); /* each particle has it, so that without any there is none */
    for (size_t i = 0; i < a->n; i++) {
        double at[3], other[3];
        ssfr_particles_position(a, i, at);
        ssfr_particles_position(b, i, other);
        for (int k = 0; k < 3; k++) assert_true((float)at[k] == (float)other[k]);
    }
    for (const ssfr_array *k = ssfr_arrays; k < ssfr_arrays + SSFR_N_ARRAYS; k++) {
        const void *values = ssfr_array_get(a, k), *others = ssfr_array_get(b, k);
        assert_int_equal(values != NULL, others != NULL);
        if (values) assert_memory_equal(values, others, a->n * k->count * SSFR_ARRAY_VALUE);
    }
}

static void what_is_saved_is_loaded(void **state)
{
    (void)state;
    const size_t counts[] = {0, 1, 64, 65, MANY};
    for (size_t i = 0; i < SSFR_COUNT(counts); i++)
        for (int arrays = 0; arrays < 2; arrays++) {
            ssfr_particles *saved = make_particles(counts[i], arrays);
            const char *path = test_path(arrays ? "all.bgeo" : "few.bgeo.gz");
            save(saved, path);
            ssfr_particles *loaded = load(path);
            assert_same(loaded, saved);
            ssfr_particles_destroy(&saved);
            ssfr_particles_destroy(&loaded);
        }
}

static void written_files_are_gzipped_and_hold_no_time(void **state)
{
    (void)state;
    char *a = NULL;
    size_t size = 0;
    const char *path = test_path("time.bgeo");
    ssfr_particles *p = make_particles(10, true);
    save(p, path);
    assert_int_equal(ssfr_read_file(path, 1u << 20, &a, &size), SSFR_OK);
    assert_memory_equal(a, "\x1f\x8b\x08\0\0\0\0\0", 8); /* magic, deflate, no flags, no time */
    free(a);
    ssfr_particles_destroy(&p);
}

static void numbers_beyond_the_formats_are_refused(void **state)
{
    (void)state;
    const double positions[] = {0, 0, 0, 1, 2, 2.385};
    uint32_t id[] = {7, 2147483648u};
    const ssfr_particles given = {.id = id, .radius = 0.5};
    ssfr_particles *p = NULL;
    assert_int_equal(ssfr_particles_create(&p, 2, positions, &given), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_particles_save(p, test_path("ids.bgeo")),
                 "(from 0): id is 2147483648, at most 2147483647 can be written");
    assert_true(access(test_path("ids.bgeo"), F_OK) != 0);
    ssfr_particles_destroy(&p);
}

static void saving_to_a_full_disk_or_nowhere_fails_and_leaves_the_old_file(void **state)
{
    (void)state;
    const char *path = test_path("full.bgeo");
    struct rlimit limit, small;
    ssfr_particles *old = make_particles(10, true), *particles = make_particles(MANY, true), *loaded = NULL;
    assert_fails(SSFR_ERR_IO, ssfr_particles_save(old, test_path("missing/a.bgeo")),
                 "a.bgeo: cannot be written: No such file");
    save(old, path);
    getrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_IGN);
    for (rlim_t size = 0; size < 70000; size += 16000) {
        small = (struct rlimit){size, limit.rlim_max};
        setrlimit(RLIMIT_FSIZE, &small);
        assert_fails(SSFR_ERR_IO, ssfr_particles_save(particles, path), "full.bgeo: cannot be written: File too large");
        setrlimit(RLIMIT_FSIZE, &limit);
        loaded = load(path);
        assert_same(loaded, old);
        ssfr_particles_destroy(&loaded);
    }
    ssfr_particles_destroy(&old);
    ssfr_particles_destroy(&particles);
}

/* ---- a simulator's file ------------------------------------------------------------------------------------------ */

static ssfr_particles *load_data(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", test_data_or_skip(), name);
    return load(path);
}

static void a_simulators_own_file_equals_its_conversion_to_ply_and_survives_writing(void **state)
{
    (void)state;
    ssfr_particles *bgeo = load_data("native_ddb_mid_ParticleData_Fluid_56.bgeo");
    ssfr_particles *ply = load_data("ddb_mid_fluid.ply"), *again = NULL;
    size_t *place = calloc(ply->n, sizeof *place);
    assert_non_null(place);
    assert_int_equal(bgeo->n, 104400);
    assert_int_equal(ply->n, bgeo->n);
    for (size_t i = 0; i < ply->n; i++) place[ply->id[i]] = i;
    for (size_t i = 0; i < bgeo->n; i++) {
        double a[3], b[3];
        assert_in_range(bgeo->id[i], 0, ply->n - 1);
        const size_t j = place[bgeo->id[i]];
        ssfr_particles_position(bgeo, i, a);
        ssfr_particles_position(ply, j, b);
        assert_memory_equal(a, b, sizeof a);
        assert_memory_equal(bgeo->velocity + 3 * i, ply->velocity + 3 * j, 3 * sizeof *ply->velocity);
        assert_memory_equal(bgeo->density + i, ply->density + j, sizeof *ply->density);
    }
    bgeo->radius = (double)(float)bgeo->radius;
    save(bgeo, test_path("again.bgeo"));
    again = load(test_path("again.bgeo"));
    assert_same(again, bgeo);
    free(place);
    ssfr_particles_destroy(&bgeo);
    ssfr_particles_destroy(&ply);
    ssfr_particles_destroy(&again);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(attributes_are_found_by_name_among_others),
        cmocka_unit_test(gzipped_files_are_told_by_their_first_bytes),
        cmocka_unit_test(files_without_attributes_or_points_are_files),
        cmocka_unit_test(attributes_of_another_shape_are_skipped_with_a_warning),
        cmocka_unit_test(values_that_cannot_be_are_refused),
        cmocka_unit_test(headers_of_another_form_are_refused),
        cmocka_unit_test(files_that_end_too_early_say_what_is_missing),
        cmocka_unit_test(counts_that_the_file_cannot_hold_are_refused),
        cmocka_unit_test(damaged_gzipped_data_are_refused),
        cmocka_unit_test(a_file_cut_anywhere_or_damaged_never_harms),
        cmocka_unit_test(what_is_no_file_is_refused),
        cmocka_unit_test(what_is_saved_is_loaded),
        cmocka_unit_test(written_files_are_gzipped_and_hold_no_time),
        cmocka_unit_test(numbers_beyond_the_formats_are_refused),
        cmocka_unit_test(saving_to_a_full_disk_or_nowhere_fails_and_leaves_the_old_file),
        cmocka_unit_test(a_simulators_own_file_equals_its_conversion_to_ply_and_survives_writing),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

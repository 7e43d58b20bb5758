/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_round_trip.c: what is written in any of the formats is read back as it was, as far as the format can hold it. */
#include "tests/particle_files.h"

#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <locale.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static const struct {
    const char *ending;
    ssfr_reader *read;
    ssfr_writer *write;
    unsigned holds;
    const char *help;
} formats[] = {
#define X(ending, reader, writer, holds, help) {ending, reader, writer, holds, help},
#include "scene/formats.def"
#undef X
};

/* A path of this format, always the same. */
static const char *path_of(size_t format)
{
    static const char *paths[SSFR_COUNT(formats)];
    char name[64];
    snprintf(name, sizeof name, "set%s", formats[format].ending);
    if (!paths[format]) paths[format] = test_path(name);
    return paths[format];
}

/* ---- sets of particles ------------------------------------------------------------------------------------------- */

enum { MOST = 1037, N_CASES = 6 };

typedef enum place {
    NEAR,      /* random floats about the origin */
    FAR_FINE,  /* 1000 km away, a hundredth of a millimetre and less apart: beyond floats */
    FAR_WHOLE, /* 1000 km away, on multiples of 1/16 m, which floats hold */
    TINY,      /* denormal floats */
    HUGE_BOX,  /* as large as a box may be */
    ONE_PLACE, /* all at the same */
} place;

static const char *const place_names[N_CASES] = {"near", "far and fine", "far and whole", "tiny", "huge", "one place"};

static double coordinate(place place, uint64_t *seed)
{
    switch (place) {
    case NEAR: return (double)(float)test_random(seed, -1.117, 2.385);
    case FAR_FINE: return 1e6 + test_random(seed, 0, 1e-5);
    case FAR_WHOLE: return 1e6 + rint(test_random(seed, -1000, 1000)) / 16;
    case TINY: return rint(test_random(seed, -4000, 4000)) * (double)FLT_TRUE_MIN;
    case HUGE_BOX: return (double)(float)test_random(seed, -0.24 * (double)FLT_MAX, 0.24 * (double)FLT_MAX);
    default: return 2.385;
    }
}

/* What floats and whole numbers may be at their limits, among others; -0 keeps its sign. */
static uint32_t value_bits(bool real, uint32_t largest, size_t i, uint64_t *seed)
{
    static const float reals[] = {-0.0f, FLT_TRUE_MIN, -FLT_TRUE_MIN, FLT_MIN, FLT_MAX, -FLT_MAX, 0.1f, 16777217.0f};
    static const uint32_t wholes[] = {0, 1, 2147483647u, 2147483648u, 4294967295u, 4294967294u};
    const float random = (float)test_random(seed, -2385, 2385), value = i % 9 < 8 ? reals[i % 9] : random;
    uint32_t bits = i % 7 < 6 ? wholes[i % 7] : (uint32_t)test_random(seed, 0, 4294967295.0);
    if (!real && bits > largest) bits = largest;
    if (real) memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* A set that the format holds, as far as it holds anything of the kind. */
static ssfr_particles *make_set(size_t format, size_t n, place place, bool with_arrays, double radius)
{
    static double positions[3 * MOST];
    static uint32_t values[SSFR_N_ARRAYS][3 * MOST];
    const uint32_t largest = formats[format].holds & SSFR_HOLDS_UINT32 ? UINT32_MAX : INT32_MAX;
    ssfr_particles given = {.radius = radius}, *set = NULL;
    uint64_t seed = 2385 + n;
    assert_true(n <= MOST);
    for (size_t k = 0; k < 3 * n; k++) positions[k] = coordinate(place, &seed);
    for (size_t a = 0; a < SSFR_N_ARRAYS && with_arrays; a++) {
        for (size_t k = 0; k < ssfr_arrays[a].count * n; k++)
            values[a][k] = value_bits(ssfr_arrays[a].real, largest, k, &seed);
        ssfr_array_set(&given, ssfr_arrays + a, values[a]);
    }
    assert_int_equal(ssfr_particles_create(&set, n, positions, &given), SSFR_OK);
    return set;
}

static void save_anew(const ssfr_particles *set, const char *path)
{
    remove(path); /* some file systems wait for the disk when a file is written over */
    save(set, path);
}

/* ---- what was read against what was written ---------------------------------------------------------------------- */

static bool same_bits(const void *a, const void *b, size_t size)
{
    return memcmp(a, b, size) == 0;
}

/* Doubles are the same, or, where floats were written because they suffice, the same floats in the packet. */
static bool same_coordinate(const ssfr_particles *set, size_t i, size_t k, double read, bool holds_doubles)
{
    double at[3];
    ssfr_particles_position(set, i, at);
    const double rounded = (double)(float)at[k];
    const float relative = (float)(read - set->packets[i / SSFR_PACKET].centre[k]);
    if (!holds_doubles) return same_bits(&read, &rounded, sizeof read);
    return same_bits(&read, at + k, sizeof read) ||
           (same_bits(&read, &rounded, sizeof read) && relative == set->position[3 * i + k]);
}

static bool same_arrays(const ssfr_particles *set, const ssfr_particles *read, bool holds_arrays)
{
    bool same = true;
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS && same; a++) {
        const void *values = holds_arrays ? ssfr_array_get(set, a) : NULL, *others = ssfr_array_get(read, a);
        same = !values == !others && (!values || same_bits(values, others, set->n * a->count * SSFR_ARRAY_VALUE));
        if (!same) print_error("array %s differs\n", a->name);
    }
    return same;
}

/* The reader gives what it finds in the file's order, which is the set's. */
static bool reads_back(size_t format, const ssfr_particles *set)
{
    const unsigned holds = formats[format].holds;
    ssfr_reading r = {.path = path_of(format)};
    test_clear_log();
    if (formats[format].read(&r) != SSFR_OK) fail_msg("%s", test_last_error());
    const double radius = holds & SSFR_HOLDS_DOUBLES ? set->radius : (double)(float)set->radius;
    bool same = r.given.n == set->n;
    /* A table without rows has no cell for the radius. */
    if (set->n > 0) same = same && r.given.radius == (holds & SSFR_HOLDS_RADIUS ? radius : 0);
    for (size_t k = 0; k < 3 * set->n && same; k++)
        same = same_coordinate(set, k / 3, k % 3, r.positions[k], holds & SSFR_HOLDS_DOUBLES);
    same = same && same_arrays(set, &r.given, holds & SSFR_HOLDS_ARRAYS);
    ssfr_reading_finish(&r);
    return same;
}

static void every_format_holds_what_it_says(void **state)
{
    (void)state;
    static const size_t counts[] = {0, 1, 64, 65, MOST};
    for (size_t f = 0; f < SSFR_COUNT(formats); f++)
        for (int choice = 0; choice < 2 * N_CASES * (int)SSFR_COUNT(counts) && formats[f].write; choice++) {
            const size_t n = counts[(size_t)choice / (2 * N_CASES)];
            const place place = choice / 2 % N_CASES;
            ssfr_particles *set = make_set(f, n, place, choice % 2, 0.02385);
            save_anew(set, path_of(f));
            if (!reads_back(f, set))
                fail_msg("%s: %zu particles, %s, %s arrays: read as others", formats[f].ending, n, place_names[place],
                         choice % 2 ? "all" : "no");
            ssfr_particles_destroy(&set);
        }
}

static void every_format_holds_any_radius(void **state)
{
    (void)state;
    const double radii[] = {0, 0.1, 1 + DBL_EPSILON, (double)FLT_MIN, (double)FLT_MAX};
    for (size_t f = 0; f < SSFR_COUNT(formats); f++)
        for (size_t i = 0; i < SSFR_COUNT(radii) && formats[f].write; i++) {
            ssfr_particles *set = make_set(f, 3, NEAR, false, radii[i]);
            save_anew(set, path_of(f));
            if (!reads_back(f, set)) fail_msg("%s: the radius %g is read as another", formats[f].ending, radii[i]);
            ssfr_particles_destroy(&set);
        }
}

/* Positions that packets hold exactly come back in the same packets. */
static void loading_what_was_saved_gives_the_same_packets(void **state)
{
    (void)state;
    for (size_t f = 0; f < SSFR_COUNT(formats); f++) {
        if (!formats[f].write) continue;
        ssfr_particles *set = make_set(f, MOST, FAR_WHOLE, true, 0.25), *loaded = NULL;
        ssfr_load_options options = {.radius = 0.25};
        save_anew(set, path_of(f));
        assert_int_equal(ssfr_particles_load(&loaded, path_of(f), &options), SSFR_OK);
        assert_int_equal(loaded->n, MOST);
        assert_true(loaded->radius == 0.25 && loaded->serial != set->serial);
        assert_memory_equal(loaded->packets, set->packets, set->n_packets * sizeof *set->packets);
        assert_memory_equal(loaded->position, set->position, 3 * MOST * sizeof *set->position);
        assert_true(same_arrays(set, loaded, formats[f].holds & SSFR_HOLDS_ARRAYS));
        ssfr_particles_destroy(&set);
        ssfr_particles_destroy(&loaded);
    }
}

/* The radius stands where it is not a value a particle. */
static void no_particles_keep_a_radius_in_a_header(void **state)
{
    (void)state;
    static const char *const endings[] = {".h5", ".ply", ".vtk", ".pos"};
    for (size_t i = 0; i < SSFR_COUNT(endings); i++) {
        char name[32];
        ssfr_particles *set = make_set(0, 0, NEAR, false, 0.25), *loaded = NULL;
        snprintf(name, sizeof name, "none%s", endings[i]);
        save_anew(set, test_path(name));
        loaded = load(test_path(name));
        assert_int_equal(loaded->n, 0);
        assert_true(loaded->radius == 0.25);
        ssfr_particles_destroy(&set);
        ssfr_particles_destroy(&loaded);
    }
}

static void a_simulators_foam_is_kept_by_every_format(void **state)
{
    (void)state;
    char path[512];
    ssfr_load_options options = {.radius = 0.02};
    ssfr_particles *foam = NULL;
    snprintf(path, sizeof path, "%s/ddb_early_foam.ply", test_data_or_skip());
    assert_int_equal(ssfr_particles_load(&foam, path, &options), SSFR_OK);
    for (size_t f = 0; f < SSFR_COUNT(formats); f++) {
        if (!formats[f].write || (f > 0 && formats[f].write == formats[f - 1].write)) continue;
        save_anew(foam, path_of(f));
        assert_true(reads_back(f, foam));
        remove(path_of(f));
    }
    ssfr_particles_destroy(&foam);
}

static void every_frame_of_the_simulators_is_read(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t n;
        double lo, hi; /* m, of y */
    } frames[] = {
        {"ddb_early_fluid.ply", 104400, 0.02741, 2.27218},   {"ddb_early_foam.ply", 154204, 0.02367, 2.21496},
        {"ddb_mid_fluid.ply", 104400, 0.02711, 3.18299},     {"ddb_mid_foam.ply", 182398, -0.01187, 3.31828},
        {"ddb_1m_fluid.ply", 951420, 0.01321, 2.48647},      {"flip_foam.ply", 1065589, 0.05078, 1.94862},
        {"sphere_drop_100.pos", 64830, 0.012, 0.347},
        {"native_ddb_mid_ParticleData_Fluid_56.vtk", 104400, 0.02711, 3.18299},
        {"native_ddb_mid_ParticleData_Fluid_56.bgeo", 104400, 0.02711, 3.18299},
    };
    for (size_t i = 0; i < SSFR_COUNT(frames); i++) {
        char path[512];
        double lo[3], hi[3];
        snprintf(path, sizeof path, "%s/%s", test_data_or_skip(), frames[i].name);
        ssfr_particles *p = load(path);
        ssfr_particles_bounds(p, lo, hi);
        assert_int_equal(p->n, frames[i].n);
        assert_close(lo[1], frames[i].lo, i == 6 ? 5e-4 : 5e-6, 0); /* as many digits as were written down */
        assert_close(hi[1], frames[i].hi, i == 6 ? 5e-4 : 5e-6, 0);
        ssfr_particles_destroy(&p);
    }
}

static void the_same_particles_give_the_same_bytes(void **state)
{
    (void)state;
    for (size_t f = 0; f < SSFR_COUNT(formats); f++) {
        if (!formats[f].write) continue;
        ssfr_particles *set = make_set(f, MOST, NEAR, true, 0.02385);
        char *first = NULL, *second = NULL;
        size_t n_first = 0, n_second = 0;
        save_anew(set, path_of(f));
        assert_int_equal(ssfr_read_file(path_of(f), SSFR_READ_MAX, &first, &n_first), SSFR_OK);
        save_anew(set, path_of(f));
        assert_int_equal(ssfr_read_file(path_of(f), SSFR_READ_MAX, &second, &n_second), SSFR_OK);
        assert_int_equal(n_first, n_second);
        assert_memory_equal(first, second, n_first);
        free(first);
        free(second);
        ssfr_particles_destroy(&set);
    }
}

static void numbers_have_decimal_points_in_every_locale(void **state)
{
    (void)state;
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8")) skip();
    for (size_t f = 0; f < SSFR_COUNT(formats); f++) {
        if (!formats[f].write) continue;
        ssfr_particles *set = make_set(f, 65, NEAR, true, 0.02385), *loaded = NULL;
        save_anew(set, path_of(f));
        loaded = load(path_of(f));
        assert_true(same_arrays(set, loaded, formats[f].holds & SSFR_HOLDS_ARRAYS));
        ssfr_particles_destroy(&set);
        ssfr_particles_destroy(&loaded);
    }
    setlocale(LC_NUMERIC, "C");
}

/* ---- what formats cannot hold ------------------------------------------------------------------------------------ */

static char warned[512];

static void keep_warning(void *user, ssfr_level level, const char *where, const char *text)
{
    (void)user, (void)where;
    const size_t used = strlen(warned);
    if (level == SSFR_WARNING) snprintf(warned + used, sizeof warned - used, "%s\n", text);
}

static void what_is_not_held_is_told(void **state)
{
    for (size_t f = 0; f < SSFR_COUNT(formats); f++)
        for (int far = 0; far < 2 && formats[f].write; far++) {
            ssfr_particles *set = make_set(f, 65, far ? FAR_FINE : NEAR, true, 0.02385);
            warned[0] = '\0';
            ssfr_log_to(keep_warning, NULL);
            assert_int_equal(ssfr_particles_save(set, path_of(f)), SSFR_OK);
            test_capture_log(state);
            assert_int_equal(strstr(warned, " velocity") == NULL, (formats[f].holds & SSFR_HOLDS_ARRAYS) != 0);
            assert_int_equal(strstr(warned, " age") == NULL, (formats[f].holds & SSFR_HOLDS_ARRAYS) != 0);
            assert_int_equal(strstr(warned, " radius") == NULL, (formats[f].holds & SSFR_HOLDS_RADIUS) != 0);
            const bool moved = far && !(formats[f].holds & SSFR_HOLDS_DOUBLES);
            assert_int_equal(strstr(warned, "written as floats,") != NULL, moved);
            ssfr_particles_destroy(&set);
        }
}

/* Between 2^19 and 2^20 m floats are 2^-4 m apart. */
static void floats_move_particles_far_away_by_a_thirty_second_of_a_metre_at_most(void **state)
{
    size_t n_formats = 0;
    for (size_t f = 0; f < SSFR_COUNT(formats); f++) {
        if (!formats[f].write || formats[f].holds & SSFR_HOLDS_DOUBLES) continue;
        const double positions[] = {1e6, 1e6 + 1.0 / 32, 1e6 + 0.023};
        double moved = 0;
        ssfr_particles *set = NULL;
        assert_int_equal(ssfr_particles_create(&set, 1, positions, &(ssfr_particles){.radius = 0.02385}), SSFR_OK);
        warned[0] = '\0';
        ssfr_log_to(keep_warning, NULL);
        assert_int_equal(ssfr_particles_save(set, path_of(f)), SSFR_OK);
        test_capture_log(state);
        assert_non_null(strstr(warned, "by up to 0.0312 m an axis"));
        ssfr_particles *loaded = load(path_of(f));
        for (size_t k = 0; k < 3; k++) {
            double at[3];
            ssfr_particles_position(loaded, 0, at);
            moved = fmax(moved, fabs(at[k] - positions[k]));
        }
        assert_true(moved == 1.0 / 32);
        ssfr_particles_destroy(&set);
        ssfr_particles_destroy(&loaded);
        n_formats++;
    }
    assert_true(n_formats > 0);
}

static void floats_refuse_what_is_too_large_or_too_small_for_them(void **state)
{
    (void)state;
    const double far[] = {0, 2.0 * (double)FLT_MAX, 0}, near[] = {0, 2.385, 0};
    const ssfr_particles thin = {.radius = 1e-50}, thick = {.radius = 1e39}, usual = {.radius = 0.02385};
    for (size_t f = 0; f < SSFR_COUNT(formats); f++) {
        ssfr_particles *sets[3] = {NULL};
        assert_int_equal(ssfr_particles_create(sets, 1, far, &usual), SSFR_OK);
        assert_int_equal(ssfr_particles_create(sets + 1, 1, near, &thin), SSFR_OK);
        assert_int_equal(ssfr_particles_create(sets + 2, 1, near, &thick), SSFR_OK);
        for (size_t i = 0; i < 3 && formats[f].write; i++) {
            if (!(formats[f].holds & SSFR_HOLDS_DOUBLES)) {
                assert_fails(SSFR_ERR_VALUE, ssfr_particles_save(sets[i], path_of(f)), "does not fit a float");
            } else {
                save_anew(sets[i], path_of(f));
                assert_true(reads_back(f, sets[i]));
            }
        }
        for (size_t i = 0; i < 3; i++) ssfr_particles_destroy(sets + i);
    }
}

static void the_list_says_what_is_read_and_written(void **state)
{
    (void)state;
    for (size_t f = 0; f < SSFR_COUNT(formats); f++) {
        char line[512];
        snprintf(line, sizeof line, "%s (%s)\n", formats[f].ending, formats[f].help);
        assert_non_null(strstr(ssfr_particle_formats(), line));
        assert_non_null(strstr(formats[f].help, "read"));
        assert_non_null(strstr(formats[f].help, "written"));
        assert_int_equal(strstr(formats[f].help, "not written") == NULL, formats[f].write != NULL);
    }
}

static void whole_numbers_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    const double at[3] = {0, 2.385, 0};
    uint32_t ids[] = {2147483648u};
    ssfr_particles *set = NULL;
    assert_int_equal(ssfr_particles_create(&set, 1, at, &(ssfr_particles){.radius = 0.02385, .id = ids}), SSFR_OK);
    for (size_t f = 0; f < SSFR_COUNT(formats); f++)
        if (formats[f].write && formats[f].holds & SSFR_HOLDS_ARRAYS && !(formats[f].holds & SSFR_HOLDS_UINT32))
            assert_fails(SSFR_ERR_VALUE, ssfr_particles_save(set, path_of(f)), "id is 2147483648");
    ssfr_particles_destroy(&set);
}

static void formats_without_a_writer_are_refused(void **state)
{
    (void)state;
    ssfr_particles *set = make_set(0, 2, NEAR, false, 0.02385);
    for (size_t f = 0; f < SSFR_COUNT(formats); f++)
        if (!formats[f].write)
            assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_particles_save(set, path_of(f)), "are read but not written");
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_particles_save(set, "set.obj"), "set.obj: the names of particle files end");
    ssfr_particles_destroy(&set);
}

/* ---- writing that fails ------------------------------------------------------------------------------------------ */

static void writing_into_what_is_no_folder_fails(void **state)
{
    (void)state;
    for (size_t f = 0; f < SSFR_COUNT(formats); f++) {
        char path[256];
        ssfr_particles *set = make_set(f, 2, NEAR, false, 0.02385);
        if (formats[f].write) {
            snprintf(path, sizeof path, "%s/missing/a%s", path_of(f), formats[f].ending);
            assert_fails(SSFR_ERR_IO, ssfr_particles_save(set, path), "cannot be written: ");
            snprintf(path, sizeof path, "%s", test_path("folder"));
            snprintf(path + strlen(path), sizeof path - strlen(path), "%s", formats[f].ending);
            assert_int_equal(mkdir(path, 0700), 0);
            assert_fails(SSFR_ERR_IO, ssfr_particles_save(set, path), "Is a directory");
            assert_int_equal(rmdir(path), 0);
        }
        ssfr_particles_destroy(&set);
    }
}

static void a_full_disk_is_an_error_and_leaves_the_old_file(void **state)
{
    (void)state;
    struct rlimit limit;
    getrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_IGN);
    for (size_t f = 0; f < SSFR_COUNT(formats); f++) {
        ssfr_particles *old = make_set(f, 3, NEAR, true, 0.02385), *set = make_set(f, MOST, NEAR, true, 0.02385);
        struct stat info = {0};
        if (formats[f].write) {
            save_anew(set, path_of(f));
            assert_int_equal(stat(path_of(f), &info), 0);
            save_anew(old, path_of(f));
        }
        for (rlim_t size = 0; size < (rlim_t)info.st_size; size += (rlim_t)info.st_size / 3) {
            const struct rlimit small = {size, limit.rlim_max};
            setrlimit(RLIMIT_FSIZE, &small);
            assert_fails(SSFR_ERR_IO, ssfr_particles_save(set, path_of(f)), "cannot be written: File too large");
            setrlimit(RLIMIT_FSIZE, &limit);
            assert_true(reads_back(f, old));
        }
        ssfr_particles_destroy(&old);
        ssfr_particles_destroy(&set);
    }
}

/* ---- damage ------------------------------------------------------------------------------------------------------ */

static void what_was_written_and_cut_or_damaged_never_harms(void **state)
{
    (void)state;
    for (size_t f = 0; f < SSFR_COUNT(formats); f++) {
        char name[32], *file = NULL;
        size_t n = 0;
        ssfr_particles *set = make_set(f, 3, NEAR, true, 0.02385);
        if (formats[f].write && formats[f].write != ssfr_hdf5_write) { /* has a test of its own, for what HDF5 allows */
            save_anew(set, path_of(f));
            assert_int_equal(ssfr_read_file(path_of(f), SSFR_READ_MAX, &file, &n), SSFR_OK);
            snprintf(name, sizeof name, "cut%s", formats[f].ending);
            check_truncations(name, file, n);
        }
        free(file);
        ssfr_particles_destroy(&set);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_holds_what_it_says),
        cmocka_unit_test(every_format_holds_any_radius),
        cmocka_unit_test(loading_what_was_saved_gives_the_same_packets),
        cmocka_unit_test(no_particles_keep_a_radius_in_a_header),
        cmocka_unit_test(a_simulators_foam_is_kept_by_every_format),
        cmocka_unit_test(every_frame_of_the_simulators_is_read),
        cmocka_unit_test(the_same_particles_give_the_same_bytes),
        cmocka_unit_test(numbers_have_decimal_points_in_every_locale),
        cmocka_unit_test(what_is_not_held_is_told),
        cmocka_unit_test(floats_move_particles_far_away_by_a_thirty_second_of_a_metre_at_most),
        cmocka_unit_test(floats_refuse_what_is_too_large_or_too_small_for_them),
        cmocka_unit_test(the_list_says_what_is_read_and_written),
        cmocka_unit_test(whole_numbers_that_do_not_fit_are_refused),
        cmocka_unit_test(formats_without_a_writer_are_refused),
        cmocka_unit_test(writing_into_what_is_no_folder_fails),
        cmocka_unit_test(a_full_disk_is_an_error_and_leaves_the_old_file),
        cmocka_unit_test(what_was_written_and_cut_or_damaged_never_harms),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

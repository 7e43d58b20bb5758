/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_hdf5.c: ssfr's own particle files: what is saved is loaded, and what other programs may have put into them. */
#include "tests/particle_files.h"

#include <float.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { N = 700 };

/* N particles with every array; positions are whole floats when `fine` is 0. */
static ssfr_particles *make_particles(size_t n, double centre, double fine)
{
    static double positions[3 * N];
    static float velocity[3 * N], density[N], lifetime[N], initial_lifetime[N], age[N];
    static uint32_t neighbours[N], id[N], kind[N];
    const ssfr_particles given = {.velocity = velocity, .density = density, .lifetime = lifetime,
                                  .initial_lifetime = initial_lifetime, .age = age, .neighbours = neighbours, .id = id,
                                  .kind = kind, .radius = 0.02385};
    ssfr_particles *particles = NULL;
    uint64_t seed = 17;
    for (uint32_t i = 0; i < n; i++) {
        for (size_t k = 0; k < 3; k++) {
            positions[3 * i + k] = (double)(float)test_random(&seed, centre + 1, centre + 2.385) + fine * (double)k;
            velocity[3 * i + k] = (float)test_random(&seed, -10, 10);
        }
        density[i] = (float)test_random(&seed, 900, 1100);
        lifetime[i] = (float)test_random(&seed, 0, 5);
        initial_lifetime[i] = (float)test_random(&seed, 5, 6);
        age[i] = (float)test_random(&seed, 0, 23.85);
        neighbours[i] = i % 47;
        id[i] = 4294967295u - i;
        kind[i] = i % 3;
    }
    assert_int_equal(ssfr_particles_create(&particles, n, positions, &given), SSFR_OK);
    return particles;
}

static size_t find_id(const ssfr_particles *p, uint32_t id)
{
    size_t i = 0;
    while (i < p->n && p->id[i] != id) i++;
    assert_true(i < p->n);
    return i;
}

/* The same particles, in an order that rounding may have changed where they lie close together. */
static void assert_same(const ssfr_particles *a, const ssfr_particles *b)
{
    assert_int_equal(a->n, b->n);
    assert_true(a->radius == b->radius);
    for (size_t i = 0; i < a->n; i++) {
        const size_t j = find_id(b, a->id[i]);
        double at[3], other[3];
        ssfr_particles_position(a, i, at);
        ssfr_particles_position(b, j, other);
        for (size_t k = 0; k < 3; k++)
            assert_close(at[k], other[k], (double)(a->packets[i / SSFR_PACKET].half[k] * FLT_EPSILON), 0);
        for (size_t k = 0; k < SSFR_N_ARRAYS; k++) {
            const size_t size = ssfr_arrays[k].count * SSFR_ARRAY_VALUE;
            const char *values = ssfr_array_get(a, ssfr_arrays + k), *others = ssfr_array_get(b, ssfr_arrays + k);
            assert_true(values && others && memcmp(values + i * size, others + j * size, size) == 0);
        }
    }
}

/* Bytes of a position's coordinate in the file. */
static size_t coordinate_size(const char *path)
{
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t dataset = H5Dopen2(file, "particles/position", H5P_DEFAULT), type = H5Dget_type(dataset);
    const size_t size = H5Tget_size(type);
    H5Tclose(type);
    H5Dclose(dataset);
    H5Fclose(file);
    return size;
}

static void what_is_saved_is_loaded(void **state)
{
    (void)state;
    const size_t counts[] = {0, 1, 255, 256, 257, N};
    for (size_t i = 0; i < SSFR_COUNT(counts); i++)
        for (int large = 0; large < 2; large++) {
            ssfr_particles *saved = make_particles(counts[i], large ? 1e6 : 0, 1e-9), *loaded = NULL;
            save(saved, test_path(large ? "large.HDF5" : "small.h5"));
            loaded = load(test_path(large ? "large.HDF5" : "small.h5"));
            assert_same(loaded, saved);
            ssfr_particles_destroy(&saved);
            ssfr_particles_destroy(&loaded);
        }
}

static void only_what_is_there_is_saved(void **state)
{
    (void)state;
    const double positions[] = {0, 0, 0, 2.385, 0, 0};
    uint32_t kind[] = {2, 1};
    const ssfr_particles given = {.kind = kind};
    ssfr_particles *saved = NULL, *loaded = NULL;
    assert_int_equal(ssfr_particles_create(&saved, 2, positions, &given), SSFR_OK);
    save(saved, test_path("bare.h5"));
    loaded = load(test_path("bare.h5"));
    assert_int_equal(loaded->kind[find_particle(loaded, 2.385, 0, 0)], kind[1]);
    assert_true(!loaded->velocity && !loaded->density && !loaded->lifetime && !loaded->neighbours && !loaded->id);
    assert_close(loaded->radius, 1.1925, 1e-6, 0);
    ssfr_particles_destroy(&saved);
    ssfr_particles_destroy(&loaded);
}

static void positions_take_four_bytes_only_when_that_loses_nothing(void **state)
{
    (void)state;
    const struct {
        double centre, fine;
        size_t size;
    } cases[] = {{0, 0, 4}, {1e6, 0, 4}, {0, 2.385e-9, 8}, {1e6, 0.01, 8}};
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_particles *saved = make_particles(N, cases[i].centre, cases[i].fine), *loaded = NULL;
        const char *path = test_path("size.h5");
        save(saved, path);
        assert_int_equal(coordinate_size(path), cases[i].size);
        loaded = load(path);
        assert_same(loaded, saved);
        if (cases[i].size == 4) assert_memory_equal(loaded->position, saved->position, 3 * N * sizeof(float));
        ssfr_particles_destroy(&saved);
        ssfr_particles_destroy(&loaded);
    }
}

static void the_same_particles_give_the_same_bytes(void **state)
{
    (void)state;
    char *a = NULL, *b = NULL;
    size_t size_a = 0, size_b = 0;
    ssfr_particles *particles = make_particles(N, 0, 0);
    save(particles, test_path("first.h5"));
    sleep(1); /* a file that holds a time would differ now */
    save(particles, test_path("second.h5"));
    assert_int_equal(ssfr_read_file(test_path("first.h5"), 1u << 20, &a, &size_a), SSFR_OK);
    assert_int_equal(ssfr_read_file(test_path("second.h5"), 1u << 20, &b, &size_b), SSFR_OK);
    assert_int_equal(size_a, size_b);
    assert_memory_equal(a, b, size_a);
    free(a);
    free(b);
    ssfr_particles_destroy(&particles);
}

/* ---- saving that fails ------------------------------------------------------------------------------------------- */

static void saving_into_a_missing_folder_fails(void **state)
{
    (void)state;
    ssfr_particles *particles = make_particles(2, 0, 0);
    assert_fails(SSFR_ERR_IO, ssfr_particles_save(particles, test_path("missing/a.h5")), "a.h5: cannot be written");
    assert_non_null(strstr(test_last_error(), "No such file"));
    ssfr_particles_destroy(&particles);
}

static void saving_to_a_full_disk_fails_and_leaves_the_old_file(void **state)
{
    (void)state;
    const char *path = test_path("full.h5");
    struct rlimit limit, small;
    ssfr_particles *old = make_particles(10, 0, 0), *particles = make_particles(N, 0, 0), *loaded = NULL;
    save(old, path);
    getrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_IGN);
    for (rlim_t size = 0; size < 36000; size += 1500) {
        small = (struct rlimit){size, limit.rlim_max};
        setrlimit(RLIMIT_FSIZE, &small);
        assert_fails(SSFR_ERR_IO, ssfr_particles_save(particles, path), "full.h5: cannot");
        setrlimit(RLIMIT_FSIZE, &limit);
        loaded = load(path);
        assert_same(loaded, old);
        ssfr_particles_destroy(&loaded);
    }
    save(particles, path);
    loaded = load(path);
    assert_same(loaded, particles);
    ssfr_particles_destroy(&loaded);
    ssfr_particles_destroy(&old);
    ssfr_particles_destroy(&particles);
}

/* ---- files by other hands ---------------------------------------------------------------------------------------- */

/* A dataset to put into a file: numbers come from `values` and are stored as `type`. */
typedef struct dataset {
    const char *name;
    hid_t type;
    int rank;
    hsize_t dims[3];
    const double *values; /* NULL: nothing is written, and what the file says is there takes no room in it */
    const char *units;    /* NULL: none */
} dataset;

static void put_attribute(hid_t object, const char *name, hid_t type, hsize_t n, const void *values)
{
    const hid_t space = H5Screate_simple(1, &n, NULL);
    const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(attribute > 0 && H5Awrite(attribute, type, values) >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
}

static void put_units(hid_t object, const char *units)
{
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(units));
    put_attribute(object, "units", type, 1, units);
    H5Tclose(type);
}

static void put_dataset(hid_t group, const dataset *d)
{
    const hid_t space = H5Screate_simple(d->rank, d->dims, NULL);
    const hid_t id = H5Dcreate2(group, d->name, d->type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(id > 0);
    if (d->values) assert_true(H5Dwrite(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, d->values) >= 0);
    if (d->units) put_units(id, d->units);
    H5Dclose(id);
    H5Sclose(space);
}

/* A file with the datasets in its group; radius NULL: none. */
static const char *make_file(const char *group_name, const double *radius, int n, const dataset *datasets)
{
    const char *path = particle_file("made.h5", "", 0);
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t group = H5Gcreate2(file, group_name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(group > 0);
    if (radius) put_attribute(group, "radius", H5T_NATIVE_DOUBLE, 1, radius);
    for (int i = 0; i < n; i++) put_dataset(group, datasets + i);
    H5Gclose(group);
    assert_true(H5Fclose(file) >= 0);
    return path;
}

static const double values[] = {0, 1, 2, 2.385, 4, 5, 6, 7, 8};
static const double radius = 0.2385;

static void other_types_without_units_are_read(void **state)
{
    (void)state;
    const dataset datasets[] = {{"position", H5T_IEEE_F32BE, 2, {3, 3}, values, NULL},
                                {"density", H5T_IEEE_F64BE, 1, {3}, values, "kg/m^3"},
                                {"id", H5T_STD_U8LE, 1, {3}, values, "1"},
                                {"unknown", H5T_STD_I64LE, 3, {1, 3, 3}, values, "furlong"}};
    ssfr_particles *p = load(make_file("particles", &radius, SSFR_COUNT(datasets), datasets));
    assert_int_equal(p->n, 3);
    assert_true(p->radius == radius);
    const size_t at = find_particle(p, (double)2.385f, 4, 5);
    assert_true(p->density[at] == 1 && p->id[at] == 1);
    ssfr_particles_destroy(&p);
}

static void datasets_of_another_kind_are_refused(void **state)
{
    (void)state;
    const dataset position = {"position", H5T_IEEE_F64LE, 2, {3, 3}, values, "m"};
    const struct {
        dataset dataset;
        const char *says;
    } cases[] = {
        {{"velocity", H5T_IEEE_F32LE, 1, {9}, values, NULL}, "velocity: expected an array of n x 3 values"},
        {{"velocity", H5T_IEEE_F32LE, 2, {1, 9}, values, NULL},
         "velocity: expected an array of n x 3 values, found 1 x 9"},
        {{"velocity", H5T_IEEE_F32LE, 3, {3, 3, 1}, values, NULL}, "velocity: expected an array of n x 3 values"},
        {{"velocity", H5T_STD_I32LE, 2, {3, 3}, values, NULL}, "velocity: expected values of type float"},
        {{"velocity", H5T_IEEE_F32LE, 2, {2, 3}, values, NULL}, "velocity of 2 particles, but 3 positions"},
        {{"velocity", H5T_IEEE_F32LE, 2, {3, 3}, values, "km/h"}, "velocity: expected units \"m/s\", found \"km/h\""},
        {{"density", H5T_IEEE_F32LE, 2, {3, 1}, values, NULL},
         "density: expected an array of n x 1 values, found 3 x 1"},
        {{"density", H5T_IEEE_F32LE, 1, {3}, values, "more than thirty-two letters long"}, "density: units: expected"},
        {{"id", H5T_STD_I32LE, 1, {3}, values, NULL}, "id: expected values of type uint32"},
        {{"id", H5T_STD_U64LE, 1, {3}, values, NULL}, "id: expected values of type uint32"},
        {{"id", H5T_IEEE_F32LE, 1, {3}, values, NULL}, "id: expected values of type uint32"},
        {{"kind", H5T_STD_U32LE, 1, {4}, values, NULL}, "kind of 4 particles, but 3 positions"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        const dataset datasets[] = {position, cases[i].dataset};
        check_refused(make_file("particles", &radius, 2, datasets), SSFR_ERR_FORMAT, cases[i].says);
    }
}

/* HDF5 reads all of an attribute, however many strings it has. */
static void units_are_one_string(void **state)
{
    (void)state;
    static const char many[64][31] = {"m"};
    const dataset position = {"position", H5T_IEEE_F64LE, 2, {3, 3}, values, NULL};
    const char *path = make_file("particles", &radius, 1, &position);
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), id = H5Dopen2(file, "particles/position", H5P_DEFAULT);
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, sizeof many[0]);
    put_attribute(id, "units", type, SSFR_COUNT(many), many);
    H5Tclose(type);
    H5Dclose(id);
    H5Fclose(file);
    check_refused(path, SSFR_ERR_FORMAT, "made.h5: position: units: expected one short string of fixed length");
}

static void files_without_particles_are_refused(void **state)
{
    (void)state;
    const dataset density = {"density", H5T_IEEE_F32LE, 1, {3}, values, NULL};
    check_refused(text_file("text.h5", "x y z\n0 0 2.385\n"), SSFR_ERR_FORMAT, "text.h5: no HDF5 file: ");
    check_refused(make_file("particulates", NULL, 0, NULL), SSFR_ERR_FORMAT, "made.h5: no group particles: ");
    check_refused(make_file("particles", NULL, 1, &density), SSFR_ERR_FORMAT, "made.h5: position: ");
}

static void counts_that_the_file_cannot_hold_are_refused(void **state)
{
    (void)state;
    const dataset large = {"position", H5T_IEEE_F32LE, 2, {1000000000, 3}, NULL, NULL};
    const dataset larger = {"position", H5T_IEEE_F32LE, 2, {1ull << 59, 3}, NULL, NULL};
    check_refused(make_file("particles", &radius, 1, &large), SSFR_ERR_FORMAT, "1000000000 particles do not fit");
    check_refused(make_file("particles", &radius, 1, &larger), SSFR_ERR_FORMAT, "576460752303423488 particles do");
}

static void deflated_chunks_larger_than_the_dataset_are_refused(void **state)
{
    (void)state;
    const char *path = make_file("particles", &radius, 0, NULL);
    const hsize_t dims[2] = {3, 3}, most[2] = {H5S_UNLIMITED, 3}, chunk[2] = {4, 3};
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), list = H5Pcreate(H5P_DATASET_CREATE);
    const hid_t space = H5Screate_simple(2, dims, most);
    H5Pset_chunk(list, 2, chunk);
    H5Pset_deflate(list, 1);
    const hid_t id =
        H5Dcreate2(file, "particles/position", H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
    assert_true(H5Dwrite(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Dclose(id);
    H5Sclose(space);
    H5Pclose(list);
    H5Fclose(file);
    check_refused(path, SSFR_ERR_FORMAT, "or their chunks larger than the dataset");
}

/* A file whose positions are one chunk of these bytes, said to have passed no filter whose bit is in `skipped`. */
static const char *make_chunk(bool filtered, uint32_t skipped, const void *data, size_t size)
{
    const char *path = make_file("particles", &radius, 0, NULL);
    const hsize_t dims[2] = {3, 3}, origin[2] = {0, 0};
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), list = H5Pcreate(H5P_DATASET_CREATE);
    const hid_t space = H5Screate_simple(2, dims, NULL);
    H5Pset_chunk(list, 2, dims);
    if (filtered) H5Pset_deflate(list, 1);
    const hid_t id = H5Dcreate2(file, "particles/position", H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
    assert_true(H5Dwrite_chunk(id, H5P_DEFAULT, skipped, origin, size, data) >= 0);
    H5Dclose(id);
    H5Sclose(space);
    H5Pclose(list);
    H5Fclose(file);
    return path;
}

static void chunks_that_do_not_fill_their_room_are_refused(void **state)
{
    (void)state;
    static const char says[] = "position: the deflated values are damaged";
    Bytef packed[256];
    for (size_t size = 8; size <= sizeof values; size += 8) {
        uLongf n = sizeof packed;
        assert_int_equal(compress(packed, &n, (const Bytef *)values, size), Z_OK);
        if (size < sizeof values) {
            check_refused(make_chunk(true, 0, packed, n), SSFR_ERR_FORMAT, says);
            check_refused(make_chunk(true, 1, values, size), SSFR_ERR_FORMAT, says);
            check_refused(make_chunk(false, 0, values, size), SSFR_ERR_FORMAT, says);
            continue;
        }
        check_refused(make_chunk(true, 0, packed, n - 1), SSFR_ERR_FORMAT, says);
        for (int i = 0; i < 3; i++) {
            const bool deflated = i == 0;
            ssfr_particles *p = load(make_chunk(i < 2, i == 1, deflated ? (const void *)packed : values,
                                                deflated ? n : size));
            find_particle(p, 2.385, 4, 5);
            ssfr_particles_destroy(&p);
        }
    }
}

static void a_radius_is_one_number_above_zero(void **state)
{
    (void)state;
    const dataset position = {"position", H5T_IEEE_F64LE, 2, {3, 3}, values, "m"};
    const double bad[] = {-2.385, NAN}, two[] = {1, 2};
    check_refused(make_file("particles", bad, 1, &position), SSFR_ERR_FORMAT, "radius is -2.385 m");
    check_refused(make_file("particles", bad + 1, 1, &position), SSFR_ERR_FORMAT, "radius is nan m");
    const char *path = make_file("particles", NULL, 1, &position);
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), group = H5Gopen2(file, "particles", H5P_DEFAULT);
    put_attribute(group, "radius", H5T_NATIVE_DOUBLE, 2, two);
    H5Gclose(group);
    H5Fclose(file);
    check_refused(path, SSFR_ERR_FORMAT, "radius: expected one number");
}

static void values_that_are_not_finite_are_refused_or_dropped(void **state)
{
    (void)state;
    const double bad[] = {0, 1, 2, 3, INFINITY, 5, 6, 7, 8}, large[] = {1e300, 1, 2};
    const dataset datasets[] = {{"position", H5T_IEEE_F64LE, 2, {3, 3}, bad, "m"},
                                {"density", H5T_IEEE_F64LE, 1, {3}, large, NULL}};
    const char *path = make_file("particles", &radius, 1, datasets);
    ssfr_load_options options = {.drop_nonfinite = true};
    ssfr_particles *p = NULL;
    check_refused(path, SSFR_ERR_VALUE, "particle 1 (from 0): position is inf");
    path = make_file("particles", &radius, 2, datasets);
    check_refused(path, SSFR_ERR_VALUE, "particle 0 (from 0): density is inf");
    assert_int_equal(ssfr_particles_load(&p, path, &options), SSFR_OK);
    assert_int_equal(options.n_dropped, 2);
    assert_int_equal(p->n, 1);
    assert_true(p->density[find_particle(p, 6, 7, 8)] == 2);
    ssfr_particles_destroy(&p);
}

static void a_file_cut_anywhere_never_harms(void **state)
{
    (void)state;
    char *data = NULL;
    size_t size = 0;
    ssfr_particles *particles = make_particles(3, 0, 0);
    save(particles, test_path("whole.h5"));
    assert_int_equal(ssfr_read_file(test_path("whole.h5"), 1u << 20, &data, &size), SSFR_OK);
    check_truncations("cut.h5", data, size);
    free(data);
    ssfr_particles_destroy(&particles);
}

static void damaged_values_are_refused(void **state)
{
    (void)state;
    char *data = NULL;
    size_t size = 0, n_streams = 0;
    ssfr_particles *particles = make_particles(100, 0, 0);
    save(particles, test_path("whole.h5"));
    assert_int_equal(ssfr_read_file(test_path("whole.h5"), 1u << 20, &data, &size), SSFR_OK);
    for (size_t i = 0; i + 4 < size; i++) {
        const unsigned char kept = (unsigned char)data[i + 2];
        const unsigned header = (unsigned)(unsigned char)data[i] << 8 | (unsigned char)data[i + 1];
        if (header != 0x785e && header != 0x789c) continue; /* of a deflated stream */
        data[i + 2] = (char)0xff; /* no kind of block */
        check_refused(particle_file("damaged.h5", data, size), SSFR_ERR_FORMAT, ": the deflated values are damaged");
        n_streams++;
        data[i + 2] = (char)kept;
    }
    assert_int_equal(n_streams, 1 + SSFR_N_ARRAYS);
    free(data);
    ssfr_particles_destroy(&particles);
}

static void what_is_no_file_is_refused(void **state)
{
    (void)state;
    check_no_files(".h5");
}

/* ---- manners ----------------------------------------------------------------------------------------------------- */

static int n_prints;

static herr_t count_prints(hid_t stack, void *user)
{
    (void)stack, (void)user;
    n_prints++;
    return 0;
}

static void errors_are_not_printed_and_the_hosts_printer_stays(void **state)
{
    (void)state;
    H5E_auto2_t print = NULL, found = NULL;
    void *user = NULL, *found_user = NULL;
    H5Eget_auto2(H5E_DEFAULT, &print, &user);
    H5Eset_auto2(H5E_DEFAULT, count_prints, &n_prints);
    check_refused(text_file("text.h5", "x y z\n0 0 2.385\n"), SSFR_ERR_FORMAT, "no HDF5 file");
    assert_int_equal(n_prints, 0);
    H5Eget_auto2(H5E_DEFAULT, &found, &found_user);
    assert_true(found == count_prints && found_user == &n_prints);
    H5Eset_auto2(H5E_DEFAULT, print, user);
}

static void threads_may_load_and_save_at_once(void **state)
{
    (void)state;
    ssfr_particles *particles = make_particles(N, 0, 0);
    const char *path = test_path("shared.h5");
    int n_good = 0;
    save(particles, path);
#pragma omp parallel for num_threads(4) reduction(+ : n_good)
    for (int i = 0; i < 32; i++) {
        ssfr_particles *loaded = NULL;
        n_good += i % 8 == 0 && ssfr_particles_save(particles, path) == SSFR_OK;
        n_good += ssfr_particles_load(&loaded, path, NULL) == SSFR_OK && loaded->n == N;
        ssfr_particles_destroy(&loaded);
    }
    assert_int_equal(n_good, 36);
    ssfr_particles_destroy(&particles);
}

/* ---- by a map ---------------------------------------------------------------------------------------------------- */

static ssfr_result load_mapped(ssfr_particles **out, const char *path, const char *map)
{
    ssfr_load_options options = {.map = map, .radius = map && strstr(map, "radius") ? 0 : 0.5};
    return ssfr_particles_load(out, path, &options);
}

static void a_map_tells_where_a_foreign_file_has_its_arrays(void **state)
{
    (void)state;
    const double whole[] = {7, 6, 5, 4, 3, 2, 1, 0, 9};
    const dataset datasets[] = {{"Coordinates", H5T_IEEE_F64BE, 2, {3, 3}, values, "kpc"},
                                {"Velocities", H5T_STD_I16BE, 2, {3, 3}, whole, "furlong"},
                                {"Density", H5T_STD_U64LE, 2, {3, 1}, whole, NULL},
                                {"ParticleIDs", H5T_STD_I64LE, 1, {3}, whole, NULL},
                                {"Type", H5T_IEEE_F32LE, 2, {3, 1}, whole, NULL}};
    ssfr_particles *p = NULL;
    const char *path = make_file("PartType0", &radius, SSFR_COUNT(datasets), datasets);
    assert_int_equal(load_mapped(&p, path, "position=/PartType0/Coordinates,velocity=PartType0/Velocities,"
                                           "rho=/PartType0/Density,ids=/PartType0/ParticleIDs,KIND=/PartType0/Type,"
                                           "radius=/PartType0/radius"), SSFR_OK);
    assert_int_equal(p->n, 3);
    assert_true(p->radius == radius && p->velocity && p->density && p->id && p->kind && !p->lifetime && !p->neighbours);
    const size_t at = find_particle(p, 2.385, 4, 5);
    assert_true(p->velocity[3 * at] == 4 && p->velocity[3 * at + 2] == 2);
    assert_true(p->density[at] == 6 && p->id[at] == 6 && p->kind[at] == 6);
    ssfr_particles_destroy(&p);
    assert_int_equal(load_mapped(&p, path, "position=PartType0/Coordinates"), SSFR_OK);
    assert_true(p->n == 3 && p->radius == 0.5 && !p->velocity && !p->id);
    ssfr_particles_destroy(&p);
}

static void a_mapped_radius_is_a_dataset_or_an_attribute(void **state)
{
    (void)state;
    const dataset position = {"x", H5T_IEEE_F32LE, 2, {3, 3}, values, NULL};
    const char *path = make_file("fluid", &radius, 1, &position);
    const double small = 0.125, other = 0.25;
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), space = H5Screate(H5S_SCALAR);
    const hid_t id = H5Dcreate2(file, "scalar", H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const dataset one = {"one", H5T_IEEE_F32LE, 1, {1}, &small, NULL};
    assert_true(H5Dwrite(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values + 1) >= 0);
    put_attribute(file, "h", H5T_NATIVE_DOUBLE, 1, &other);
    put_attribute(id, "h", H5T_NATIVE_DOUBLE, 1, &small);
    put_dataset(file, &one);
    H5Dclose(id);
    H5Sclose(space);
    H5Fclose(file);
    const struct {
        const char *map;
        double radius;
    } cases[] = {{"position=fluid/x,radius=/fluid/radius", radius}, {"position=/fluid/x,radius=fluid/radius", radius},
                 {"position=fluid/x,radius=/scalar", 1}, {"position=fluid/x,radius=one", small},
                 {"position=fluid/x,radius=/h", other}, {"position=fluid/x,radius=h", other},
                 {"position=fluid/x,radius=scalar/h", small}};
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_particles *p = NULL;
        assert_int_equal(load_mapped(&p, path, cases[i].map), SSFR_OK);
        assert_true(p->radius == cases[i].radius);
        ssfr_particles_destroy(&p);
    }
}

static void a_map_may_tell_the_parts_of_vectors(void **state)
{
    (void)state;
    static const double x[] = {0, 2.5, -1}, y[] = {1, 2, 3}, z[] = {7, 8, 9.25}, few[] = {1, 2};
    const dataset datasets[] = {
        {"x", H5T_IEEE_F64LE, 1, {3}, x, NULL}, {"y", H5T_IEEE_F32BE, 2, {3, 1}, y, NULL},
        {"z", H5T_IEEE_F64LE, 1, {3}, z, NULL}, {"all", H5T_IEEE_F32LE, 2, {3, 3}, values, NULL},
        {"u", H5T_STD_I32LE, 1, {3}, y, NULL},  {"few", H5T_IEEE_F64LE, 1, {2}, few, NULL},
    };
    const char *path = make_file("Step#0", NULL, SSFR_COUNT(datasets), datasets);
    ssfr_particles *p = NULL;
    assert_int_equal(load_mapped(&p, path, "vx=Step#0/z,velocity_y=Step#0/u,VZ=Step#0/x,"
                                           "y=/Step#0/y,position_x=/Step#0/x,z=/Step#0/z,id=Step#0/u"), SSFR_OK);
    assert_int_equal(p->n, 3);
    for (size_t i = 0; i < 3; i++) {
        const size_t at = find_particle(p, x[i], y[i], z[i]);
        assert_true(p->velocity[3 * at] == (float)z[i] && p->velocity[3 * at + 1] == (float)y[i]);
        assert_true(p->velocity[3 * at + 2] == (float)x[i] && p->id[at] == (uint32_t)y[i]);
    }
    ssfr_particles_destroy(&p);
    assert_int_equal(load_mapped(&p, path, "position=Step#0/all,vx=Step#0/x,vy=Step#0/y,vz=Step#0/z"), SSFR_OK);
    assert_true(p->velocity[3 * find_particle(p, 2.385, 4, 5)] == 2.5f);
    ssfr_particles_destroy(&p);
    assert_fails(SSFR_ERR_FORMAT, load_mapped(&p, path, "x=Step#0/x,y=Step#0/few,z=Step#0/z"),
                 "made.h5: Step#0/few of 2 particles, but 3 positions");
    assert_fails(SSFR_ERR_FORMAT, load_mapped(&p, path, "x=Step#0/x,y=Step#0/all,z=Step#0/z"),
                 "Step#0/all: expected an array of n x 1 values, found 3 x 3");
    assert_fails(SSFR_ERR_FORMAT, load_mapped(&p, path, "x=Step#0/x,y=Step#0/none,z=Step#0/z"), "Step#0/none: ");
    assert_null(p);
}

static void maps_of_another_form_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *map, *says;
        ssfr_result code;
    } cases[] = {
        {"", "map '': expected name=path, found ''", SSFR_ERR_VALUE},
        {"position", "expected name=path, found 'position'", SSFR_ERR_VALUE},
        {"position=", "expected name=path, found 'position'", SSFR_ERR_VALUE},
        {"position=x,", "map 'position=x,': expected name=path, found ''", SSFR_ERR_VALUE},
        {"position=x,,id=i", "expected name=path, found ''", SSFR_ERR_VALUE},
        {"=x", "there is no array ''", SSFR_ERR_UNKNOWN},
        {"position=x,colour=c", "map 'position=x,colour=c': there is no array 'colour'", SSFR_ERR_UNKNOWN},
        {"position=x,position=y", "a second 'position'", SSFR_ERR_VALUE},
        {"position=x,id=y,ids=z", "a second 'ids'", SSFR_ERR_VALUE},
        {"id=i", "map 'id=i': position is missing", SSFR_ERR_VALUE},
        {"x=a,z=c", "map 'x=a,z=c': expected one position or its x, y and z", SSFR_ERR_VALUE},
        {"pos=p,x=a,y=b,z=c", "expected one position or its x, y and z", SSFR_ERR_VALUE},
        {"position=p,vy=v", "expected one velocity or its x, y and z", SSFR_ERR_VALUE},
        {"x=a,y=b,z=c,X=d", "a second 'X'", SSFR_ERR_VALUE},
        {"vx=a,vy=b,vz=c", "position is missing", SSFR_ERR_VALUE},
    };
    const dataset position = {"x", H5T_IEEE_F32LE, 2, {3, 3}, values, NULL};
    const char *path = make_file("fluid", &radius, 1, &position);
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_particles *p = NULL;
        assert_fails(cases[i].code, load_mapped(&p, path, cases[i].map), cases[i].says);
        assert_null(p);
    }
}

static void mapped_datasets_that_do_not_fit_are_refused_with_their_shape(void **state)
{
    (void)state;
    static const struct {
        const char *map, *says;
    } cases[] = {
        {"position=f/y", "made.h5: f/y: object 'y' doesn't exist"},
        {"position=g/x", "made.h5: g/x: "},
        {"position=f", "made.h5: f: "},
        {"position=f/flat", "made.h5: f/flat: expected an array of n x 3 values, found 9"},
        {"position=f/thick", "f/thick: expected an array of n x 3 values, found 3 x 3 x 1"},
        {"position=f/pairs", "f/pairs: expected an array of n x 3 values, found 4 x 2"},
        {"position=f/x,density=f/pairs", "f/pairs: expected an array of n x 1 values, found 4 x 2"},
        {"position=f/x,density=f/flat", "f/flat of 9 particles, but 3 positions"},
        {"position=f/x,density=f/thick", "f/thick: expected an array of n x 1 values, found 3 x 3 x 1"},
        {"position=f/x,id=f/halves", "particle 1 (from 0): id is 2.385, expected a whole number"},
        {"position=f/x,id=f/large", "particle 2 (from 0): id is 4294967296, expected a whole number"},
        {"position=f/x,id=f/negative", "particle 0 (from 0): id is -1, expected a whole number"},
        {"position=f/x,radius=f/flat", "made.h5: f/flat: expected one number"},
        {"position=f/x,radius=f/y", "made.h5: f/y: "},
        {"position=f/x,radius=y", "made.h5: y: "},
        {"position=f/x,radius=f", "made.h5: f: "},
    };
    static const double halves[] = {0, 2.385, 1}, large[] = {0, 1, 4294967296.0}, negative[] = {-1, 1, 2};
    const dataset datasets[] = {
        {"x", H5T_IEEE_F32LE, 2, {3, 3}, values, NULL},       {"flat", H5T_IEEE_F32LE, 1, {9}, values, NULL},
        {"thick", H5T_IEEE_F32LE, 3, {3, 3, 1}, values, NULL}, {"pairs", H5T_IEEE_F32LE, 2, {4, 2}, values, NULL},
        {"halves", H5T_IEEE_F64LE, 1, {3}, halves, NULL},      {"large", H5T_STD_U64LE, 1, {3}, large, NULL},
        {"negative", H5T_STD_I32LE, 1, {3}, negative, NULL},
    };
    const char *path = make_file("f", NULL, SSFR_COUNT(datasets), datasets);
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_particles *p = NULL;
        assert_fails(SSFR_ERR_FORMAT, load_mapped(&p, path, cases[i].map), cases[i].says);
        assert_null(p);
    }
}

static void mapped_values_that_are_no_numbers_are_refused(void **state)
{
    (void)state;
    const char *path = make_file("f", NULL, 0, NULL);
    const hsize_t dims[2] = {3, 3};
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), type = H5Tcopy(H5T_C_S1);
    const hid_t space = H5Screate_simple(2, dims, NULL);
    const hid_t id = H5Dcreate2(file, "f/words", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    ssfr_particles *p = NULL;
    assert_true(id > 0);
    H5Dclose(id);
    H5Sclose(space);
    H5Tclose(type);
    H5Fclose(file);
    assert_fails(SSFR_ERR_FORMAT, load_mapped(&p, path, "position=f/words"),
                 "made.h5: f/words: expected values of type integer or float");
    assert_fails(SSFR_ERR_FORMAT, load_mapped(&p, path, "position=f/words,radius=f/words"),
                 "made.h5: f/words: expected one number");
    assert_fails(SSFR_ERR_FORMAT, load_mapped(&p, text_file("text.h5", "x y z\n"), "position=f/words"),
                 "text.h5: no HDF5 file");
}

/* ---- the shipped frame ------------------------------------------------------------------------------------------- */

static const char shipped[] = "experiments/scenes/data/splash.h5";

static void the_shipped_frame_is_what_its_readme_says(void **state)
{
    (void)state;
    double lo[3], hi[3];
    struct stat info;
    ssfr_particles *p = load(shipped);
    assert_int_equal(stat(shipped, &info), 0);
    assert_true(info.st_size <= 1000000);
    assert_int_equal(coordinate_size(shipped), 4);
    assert_int_equal(p->n, 41646);
    assert_true(p->radius == 0.02 && p->velocity && p->density && p->neighbours && p->id);
    ssfr_particles_bounds(p, lo, hi);
    assert_close(lo[0], 0.40001, 1e-5, 0);
    assert_close(hi[1], 3.18151, 1e-5, 0);
    assert_close(lo[2], -0.96715, 1e-5, 0);
    ssfr_particles_destroy(&p);
}

static void the_shipped_frame_is_part_of_the_simulators(void **state)
{
    (void)state;
    char path[512];
    const char *data = test_data_or_skip();
    snprintf(path, sizeof path, "%s/ddb_mid_fluid.ply", data);
    ssfr_particles *whole = load(path), *part = load(shipped);
    size_t *place = calloc(whole->n, sizeof *place);
    assert_non_null(place);
    for (size_t i = 0; i < whole->n; i++) place[whole->id[i]] = i;
    assert_true(part->radius == 0.02);
    for (size_t i = 0; i < part->n; i++) {
        double a[3], b[3];
        const size_t j = place[part->id[i]];
        ssfr_particles_position(part, i, a);
        ssfr_particles_position(whole, j, b);
        for (int k = 0; k < 3; k++) assert_close(a[k], b[k], 1e-7, 0);
        assert_memory_equal(part->velocity + 3 * i, whole->velocity + 3 * j, 3 * sizeof *part->velocity);
        assert_true(part->density[i] == whole->density[j]);
        assert_int_equal(part->neighbours[i], whole->neighbours[j]);
    }
    free(place);
    ssfr_particles_destroy(&whole);
    ssfr_particles_destroy(&part);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_saved_is_loaded),
        cmocka_unit_test(only_what_is_there_is_saved),
        cmocka_unit_test(positions_take_four_bytes_only_when_that_loses_nothing),
        cmocka_unit_test(the_same_particles_give_the_same_bytes),
        cmocka_unit_test(saving_into_a_missing_folder_fails),
        cmocka_unit_test(saving_to_a_full_disk_fails_and_leaves_the_old_file),
        cmocka_unit_test(other_types_without_units_are_read),
        cmocka_unit_test(datasets_of_another_kind_are_refused),
        cmocka_unit_test(units_are_one_string),
        cmocka_unit_test(files_without_particles_are_refused),
        cmocka_unit_test(counts_that_the_file_cannot_hold_are_refused),
        cmocka_unit_test(deflated_chunks_larger_than_the_dataset_are_refused),
        cmocka_unit_test(chunks_that_do_not_fill_their_room_are_refused),
        cmocka_unit_test(a_radius_is_one_number_above_zero),
        cmocka_unit_test(values_that_are_not_finite_are_refused_or_dropped),
        cmocka_unit_test(a_file_cut_anywhere_never_harms),
        cmocka_unit_test(damaged_values_are_refused),
        cmocka_unit_test(what_is_no_file_is_refused),
        cmocka_unit_test(errors_are_not_printed_and_the_hosts_printer_stays),
        cmocka_unit_test(threads_may_load_and_save_at_once),
        cmocka_unit_test(a_map_tells_where_a_foreign_file_has_its_arrays),
        cmocka_unit_test(a_mapped_radius_is_a_dataset_or_an_attribute),
        cmocka_unit_test(a_map_may_tell_the_parts_of_vectors),
        cmocka_unit_test(maps_of_another_form_are_refused),
        cmocka_unit_test(mapped_datasets_that_do_not_fit_are_refused_with_their_shape),
        cmocka_unit_test(mapped_values_that_are_no_numbers_are_refused),
        cmocka_unit_test(the_shipped_frame_is_what_its_readme_says),
        cmocka_unit_test(the_shipped_frame_is_part_of_the_simulators),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

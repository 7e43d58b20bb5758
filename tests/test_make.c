/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_make.c: simulating scenes into frames on disk: the same bits always, resuming, and what stays after failures. */
#include "tests/disk.h"
#include "tests/util.h"

#include "experiments/scenes/make.h"

#include <dirent.h>
#include <errno.h>
#include <omp.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LAST = 5 }; /* frame of all scenes below */

/* A column beside a turning paddle under a spout, with a drain and foam: about 800 particles in the end. */
static const char everything[] =
    "title: A bit of everything\n"
    "radius: 0.03\n"
    "particles: 1500\n"
    "duration: 0.17\n"
    "frame_rate: 30\n"
    "rest_time: 0.02\n"
    "domain: {lo: [0, 0, 0], hi: [1, 0.8, 0.4]}\n"
    "foam: {energy_min: 0, energy_max: 0.01, trapped_air_min: 0.1, trapped_air_max: 1, trapped_air_rate: 100}\n"
    "motions:\n"
    "  swing: {pivot: [0.7, 0, 0.2], axis: [0, 0, 1], keys: [{time: 0}, {time: 0.2, turn_deg: 40}]}\n"
    "solids:\n"
    "  paddle: {shape: box, centre: [0.7, 0.2, 0.2], size: [0.1, 0.4, 0.3], motion: swing}\n"
    "fluid:\n"
    "  column: {lo: [0, 0, 0], hi: [0.4, 0.5, 0.4], velocity: [1.5, 0, 0]}\n"
    "emitters:\n"
    "  spout: {centre: [0.1, 0.7, 0.2], direction: [1, 0, 0], radius: 0.08, speed: 2.385, motion: swing}\n"
    "sinks:\n"
    "  drain: {lo: [0.3, 0, 0], hi: [0.4, 0.1, 0.1]}\n"
    "cameras:\n"
    "  front: {eye: [0.5, 0.5, 2], target: [0.5, 0.3, 0.2]}\n";

static ssfr_description *parse(const char *text)
{
    ssfr_description *d = NULL;
    assert_int_equal(ssfr_description_parse(&d, "a/b c.yaml", text, SSFR_SCALE_FULL, ssfr_mesh_load), SSFR_OK);
    return d;
}

/* ---- folders of frames ------------------------------------------------------------------------------------------- */

static void remove_all(const char *path)
{
    DIR *dir = opendir(path);
    for (struct dirent *entry = dir ? readdir(dir) : NULL; entry; entry = readdir(dir)) {
        char inner[512];
        snprintf(inner, sizeof inner, "%.200s/%.255s", path, entry->d_name);
        if (entry->d_name[0] != '.') remove_all(inner);
    }
    if (dir) closedir(dir);
    assert_int_equal(remove(path), 0);
}

static char *folder_of(const ssfr_description *d, const char *cache, uint64_t seed)
{
    char *folder = NULL;
    assert_int_equal(ssfr_make_folder(d, cache, seed, &folder), SSFR_OK);
    return folder;
}

static ssfr_result make(const ssfr_description *d, const char *cache, int last)
{
    const ssfr_make_options options = {.cache = cache, .seed = 1, .last = last};
    return ssfr_make(d, &options);
}

static char *read_frame(const char *folder, int frame, bool foam, size_t *size)
{
    char *path = NULL, *bytes = NULL;
    assert_int_equal(ssfr_make_path(folder, frame, foam, &path), SSFR_OK);
    assert_int_equal(ssfr_read_file(path, 1 << 24, &bytes, size), SSFR_OK);
    free(path);
    return bytes;
}

/* Every file of every frame, byte by byte. */
static void assert_same_frames(const ssfr_description *d, const char *a, const char *b)
{
    char *folder_a = folder_of(d, a, 1), *folder_b = folder_of(d, b, 1);
    assert_int_equal(ssfr_make_count(folder_a), d->n_frames);
    assert_int_equal(ssfr_make_count(folder_b), d->n_frames);
    for (int i = 0; i < d->n_frames; i++)
        for (int foam = 0; foam < (d->has_foam ? 2 : 1); foam++) {
            size_t size_a, size_b;
            char *bytes_a = read_frame(folder_a, i, foam, &size_a), *bytes_b = read_frame(folder_b, i, foam, &size_b);
            assert_int_equal(size_a, size_b);
            assert_memory_equal(bytes_a, bytes_b, size_a);
            free(bytes_a), free(bytes_b);
        }
    free(folder_a), free(folder_b);
}

static ssfr_particles *load(const ssfr_description *d, const char *cache, int frame, bool foam)
{
    char *folder = folder_of(d, cache, 1), *path = NULL;
    ssfr_particles *particles = NULL;
    assert_int_equal(ssfr_make_path(folder, frame, foam, &path), SSFR_OK);
    assert_int_equal(ssfr_particles_load(&particles, path, NULL), SSFR_OK);
    free(path), free(folder);
    return particles;
}

/* Frames made at once, for others to be held against; made when first asked for. */
static const char *reference_cache(const ssfr_description *d)
{
    static const char *cache;
    if (!cache) {
        cache = test_new_path("cache");
        assert_int_equal(make(d, cache, -1), SSFR_OK);
    }
    return cache;
}

static char reference_folder[128];

static int remove_reference(void **state)
{
    (void)state;
    if (reference_folder[0]) remove_all(reference_folder);
    return 0;
}

/* ---- where ------------------------------------------------------------------------------------------------------- */

static void frames_are_told_apart_by_all_that_they_depend_on(void **state)
{
    (void)state;
    char other[sizeof everything];
    memcpy(other, everything, sizeof other);
    *strstr(other, "2.385") = '3';
    ssfr_description *d = parse(everything), *e = parse(other), *quick = NULL;
    assert_int_equal(ssfr_description_parse(&quick, "b", everything, SSFR_SCALE_QUICK, ssfr_mesh_load), SSFR_OK);
    const uint64_t key = ssfr_make_key(d, 1);
    assert_int_equal(key, ssfr_make_key(d, 1));
    assert_true(key != ssfr_make_key(e, 1));
    assert_true(key != ssfr_make_key(d, 2));
    assert_true(key != ssfr_make_key(quick, 1));
    char *folder = folder_of(d, "/x", 1), wanted[64];
    snprintf(wanted, sizeof wanted, "/x/b_c-full-%016llx", (unsigned long long)key);
    assert_string_equal(folder, wanted);
    free(folder);
    ssfr_description_destroy(&d), ssfr_description_destroy(&e), ssfr_description_destroy(&quick);
}

static void meshes_are_part_of_the_key(void **state)
{
    (void)state;
    static const char with_mesh[] =
        "title: A wedge\nradius: 0.03\nparticles: 10\nduration: 0\ndomain: {lo: [0, 0, 0], hi: [1, 1, 1]}\n"
        "solids: {wedge: {shape: mesh, file: wedge.obj, centre: [0.5, 0.5, 0.5]}}\n"
        "fluid: {drop: {lo: [0, 0, 0], hi: [0.1, 0.1, 0.1]}}\n";
    static const char mesh[] = "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nv 0 0 0.2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    const char *path = test_path("wedge.yaml"), *obj = test_path("wedge.obj");
    ssfr_description *d = NULL, *e = NULL;
    char other[sizeof mesh];
    memcpy(other, mesh, sizeof other);
    *strstr(other, "0.2 0 0") = '1';
    test_write_file(path, with_mesh, sizeof with_mesh - 1);
    test_write_file(obj, mesh, sizeof mesh - 1);
    assert_int_equal(ssfr_description_load(&d, path, SSFR_SCALE_FULL), SSFR_OK);
    test_write_file(obj, other, sizeof other - 1);
    assert_int_equal(ssfr_description_load(&e, path, SSFR_SCALE_FULL), SSFR_OK);
    assert_true(ssfr_make_key(d, 1) != ssfr_make_key(e, 1));
    ssfr_description_destroy(&d), ssfr_description_destroy(&e);
}

static void the_users_cache_is_where_the_environment_says(void **state)
{
    (void)state;
    ssfr_description *d = parse(everything);
    char *folder = NULL;
    assert_int_equal(setenv("XDG_CACHE_HOME", "/xdg", 1), 0);
    assert_int_equal(setenv("HOME", "/home/me", 1), 0);
    folder = folder_of(d, NULL, 1);
    assert_memory_equal(folder, "/xdg/ssfr/scenes/b_c-full-", 26);
    free(folder);
    assert_int_equal(setenv("XDG_CACHE_HOME", "relative", 1), 0);
    folder = folder_of(d, NULL, 1);
    assert_memory_equal(folder, "/home/me/.cache/ssfr/scenes/b_c-", 32);
    free(folder);
    assert_int_equal(unsetenv("XDG_CACHE_HOME"), 0);
    assert_int_equal(unsetenv("HOME"), 0);
    assert_fails(SSFR_ERR_IO, ssfr_make_folder(d, NULL, 1, &folder), "neither XDG_CACHE_HOME nor HOME");
    assert_null(folder);
    assert_fails(SSFR_ERR_VALUE, ssfr_make_folder(d, "", 1, &folder), "a name of 0 bytes");
    ssfr_description_destroy(&d);
}

/* ---- the same bits ----------------------------------------------------------------------------------------------- */

static void frames_have_the_same_bits_for_any_number_of_threads(void **state)
{
    (void)state;
    const int before = omp_get_max_threads();
    ssfr_description *d = parse(everything);
    const char *one = test_new_path("cache");
    omp_set_num_threads(2);
    snprintf(reference_folder, sizeof reference_folder, "%s", reference_cache(d));
    omp_set_num_threads(1);
    assert_int_equal(make(d, one, -1), SSFR_OK);
    omp_set_num_threads(before);
    assert_int_equal(d->n_frames, LAST + 1);
    assert_same_frames(d, one, reference_cache(d));
    remove_all(one);
    ssfr_description_destroy(&d);
}

static void frames_made_one_by_one_are_those_made_at_once(void **state)
{
    (void)state;
    ssfr_description *d = parse(everything);
    const char *cache = test_new_path("cache");
    char *folder = folder_of(d, cache, 1);
    for (int i = 0; i <= LAST; i++) {
        assert_int_equal(make(d, cache, i), SSFR_OK);
        assert_int_equal(ssfr_make_count(folder), i + 1);
    }
    assert_same_frames(d, cache, reference_cache(d));
    free(folder);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

static void what_is_there_is_not_made_again(void **state)
{
    (void)state;
    ssfr_description *d = parse(everything);
    const char *cache = test_new_path("cache");
    char *folder = folder_of(d, cache, 1), *path = NULL;
    assert_int_equal(make(d, cache, 1), SSFR_OK);
    assert_int_equal(ssfr_make_path(folder, 1, false, &path), SSFR_OK);
    test_write_file(path, "mine", 4); /* would be replaced */
    assert_int_equal(make(d, cache, 1), SSFR_OK);
    size_t size;
    char *bytes = read_frame(folder, 1, false, &size);
    assert_int_equal(size, 4);
    free(bytes);
    const ssfr_make_options anew = {.cache = cache, .seed = 1, .last = -1, .anew = true};
    assert_int_equal(ssfr_make(d, &anew), SSFR_OK);
    assert_same_frames(d, cache, reference_cache(d));
    free(path), free(folder);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

static void a_frame_that_was_removed_is_made_again(void **state)
{
    (void)state;
    ssfr_description *d = parse(everything);
    const char *cache = test_new_path("cache");
    char *folder = folder_of(d, cache, 1), *path = NULL;
    assert_int_equal(make(d, cache, 3), SSFR_OK);
    assert_int_equal(ssfr_make_path(folder, 1, false, &path), SSFR_OK);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(ssfr_make_count(folder), 1);
    assert_int_equal(make(d, cache, -1), SSFR_OK);
    assert_same_frames(d, cache, reference_cache(d));
    free(path), free(folder);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

/* Cut short anywhere, or with a bit changed, the state is not gone on from: the frames stay right. */
static void a_damaged_state_costs_time_and_nothing_else(void **state)
{
    (void)state;
    ssfr_description *d = parse(everything);
    const char *cache = test_new_path("cache");
    char *folder = folder_of(d, cache, 1), path[256], *bytes = NULL;
    size_t size;
    assert_int_equal(make(d, cache, 1), SSFR_OK);
    snprintf(path, sizeof path, "%s/state.bin", folder);
    assert_int_equal(ssfr_read_file(path, 1 << 24, &bytes, &size), SSFR_OK);
    const size_t cuts[] = {0, 1, 39, 40, 41, 47, size / 3, size / 2, size - 1};
    for (size_t i = 0; i < SSFR_COUNT(cuts); i++) {
        test_write_file(path, bytes, cuts[i]);
        assert_int_equal(make(d, cache, 2), SSFR_OK);
        free(bytes);
        assert_int_equal(ssfr_read_file(path, 1 << 24, &bytes, &size), SSFR_OK); /* whole again */
        char *frame = NULL;
        assert_int_equal(ssfr_make_path(folder, 2, false, &frame), SSFR_OK);
        assert_int_equal(unlink(frame), 0);
        free(frame);
    }
    bytes[size / 2] ^= 4;
    test_write_file(path, bytes, size);
    assert_int_equal(make(d, cache, -1), SSFR_OK);
    assert_same_frames(d, cache, reference_cache(d));
    free(bytes), free(folder);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

/* ---- what is in the frames --------------------------------------------------------------------------------------- */

/* Beside the frames, whose bytes do not tell it; those made before it was kept have none. */
static void each_frame_has_the_time_that_it_took(void **state)
{
    (void)state;
    ssfr_description *d = parse(everything);
    const char *cache = test_new_path("cache");
    char *folder = folder_of(d, cache, 1), path[512];
    assert_int_equal(make(d, cache, 1), SSFR_OK);
    for (int i = 0; i < 2; i++) assert_true(ssfr_make_time(folder, i) > 0);
    assert_true(isnan(ssfr_make_time(folder, 2)));
    snprintf(path, sizeof path, "%.400s/time_0000.ms", folder);
    FILE *file = fopen(path, "w");
    assert_true(file && fputs("not a number", file) >= 0 && fclose(file) == 0);
    assert_true(isnan(ssfr_make_time(folder, 0)));
    assert_int_equal(remove(path), 0);
    assert_true(isnan(ssfr_make_time(folder, 0)));
    assert_int_equal(make(d, cache, 1), SSFR_OK); /* no reason to make the frame again */
    assert_true(isnan(ssfr_make_time(folder, 0)));
    const ssfr_make_options anew = {.cache = cache, .seed = 1, .last = 0, .anew = true};
    assert_int_equal(ssfr_make(d, &anew), SSFR_OK);
    assert_true(ssfr_make_time(folder, 0) > 0);
    assert_true(isnan(ssfr_make_time(folder, 1))); /* gone with its frame */
    free(folder);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

static void a_frame_holds_what_a_simulation_knows(void **state)
{
    (void)state;
    ssfr_description *d = parse(everything);
    ssfr_particles *fluid = load(d, reference_cache(d), LAST, false), *foam = load(d, reference_cache(d), LAST, true);
    double lo[3], hi[3];
    assert_true(fluid->n > 300 && foam->n > 10);
    assert_close(fluid->radius, 0.03, 0, 1e-6);
    assert_true(foam->radius > 0 && foam->radius < fluid->radius);
    assert_non_null(fluid->velocity), assert_non_null(fluid->density), assert_non_null(fluid->neighbours);
    assert_non_null(fluid->id), assert_non_null(fluid->age);
    assert_non_null(foam->kind), assert_non_null(foam->lifetime), assert_non_null(foam->initial_lifetime);
    ssfr_particles_bounds(fluid, lo, hi);
    for (int k = 0; k < 3; k++) assert_true(lo[k] >= d->solver.lo[k] && hi[k] <= d->solver.hi[k]);
    ssfr_particles_destroy(&fluid), ssfr_particles_destroy(&foam);
    ssfr_description_destroy(&d);
}

/* Nothing falls and nothing meets: what left the mouth goes on as it left. */
static const char jet[] =
    "title: A jet\nradius: 0.01\nparticles: 20000\nduration: 0.1\nframe_rate: 50\ngravity: [0, 0, 0]\n"
    "domain: {lo: [-1, -1, -1], hi: [1, 1, 1]}\n"
    "emitters: {mouth: {centre: [-0.5, 0.1, 0.2], direction: [1, 0, 0], "
    "size: [0.15, 0.1], speed: 2.385, start: 0.02}}\n";

static void an_emitter_streams_at_the_density_of_rest(void **state)
{
    (void)state;
    const double speed = 2.385, spacing = 2 * 0.01 * cbrt(0.8), time = 0.1 - 0.02;
    ssfr_description *d = parse(jet);
    const char *cache = test_new_path("cache");
    assert_int_equal(make(d, cache, -1), SSFR_OK);
    ssfr_particles *none = load(d, cache, 1, false), *fluid = load(d, cache, LAST, false);
    const double layer = floor(0.15 / spacing) * floor(0.1 / spacing); /* the lattice has whole places */
    double lo[3], hi[3], speeds = 0;
    assert_int_equal(none->n, 0);
    assert_close((double)fluid->n / layer, speed * time / spacing, 1, 0); /* the last may not be there yet */
    ssfr_particles_bounds(fluid, lo, hi);
    assert_close(hi[0], -0.5 + speed * time, spacing, 0);
    assert_close(hi[1] - lo[1], 0.1, 1.5 * spacing, 0); /* along up, the height */
    assert_close(hi[2] - lo[2], 0.15, 1.5 * spacing, 0);
    assert_close(0.5 * (hi[1] + lo[1]), 0.1, 0.2 * spacing, 0);
    assert_close(0.5 * (hi[2] + lo[2]), 0.2, 0.2 * spacing, 0);
    for (size_t i = 0; i < fluid->n; i++) speeds += (double)fluid->velocity[3 * i];
    assert_close(speeds / (double)fluid->n, speed, 0, 0.02);
    ssfr_particles_destroy(&none), ssfr_particles_destroy(&fluid);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

static void there_are_never_more_particles_than_allowed(void **state)
{
    (void)state;
    char text[sizeof jet];
    memcpy(text, jet, sizeof text);
    memcpy(strstr(text, "20000"), "217  ", 5);
    ssfr_description *d = parse(text);
    const char *cache = test_new_path("cache");
    assert_int_equal(make(d, cache, -1), SSFR_OK);
    ssfr_particles *fluid = load(d, cache, LAST, false);
    assert_int_equal(fluid->n, 217);
    ssfr_particles_destroy(&fluid);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

/* The jet's mouth is half closed by a board: the layers that leave it are half as large. */
static void nothing_is_emitted_into_a_solid(void **state)
{
    (void)state;
    static const char board[] = "solids: {board: {shape: box, centre: [-0.5, -0.405, 0.2], size: [1, 1, 1]}}\n";
    char text[sizeof jet + sizeof board];
    snprintf(text, sizeof text, "%s%s", jet, board);
    ssfr_description *open = parse(jet), *half = parse(text);
    const char *cache = test_new_path("cache");
    assert_int_equal(make(open, cache, -1), SSFR_OK);
    assert_int_equal(make(half, cache, -1), SSFR_OK);
    ssfr_particles *all = load(open, cache, LAST, false), *some = load(half, cache, LAST, false);
    double lo[3], hi[3];
    assert_close((double)some->n / (double)all->n, 3.0 / 5, 0.05, 0); /* of five rows three are above it */
    ssfr_particles_bounds(some, lo, hi);
    assert_true(lo[1] >= 0.095);
    ssfr_particles_destroy(&all), ssfr_particles_destroy(&some);
    remove_all(cache);
    ssfr_description_destroy(&open), ssfr_description_destroy(&half);
}

/* A mouth on its side in water that stands: without room nothing comes out, and nothing bursts. */
static void a_mouth_that_is_full_emits_nothing(void **state)
{
    (void)state;
    static const char full[] =
        "title: A spout under water\nradius: 0.03\nparticles: 3000\nduration: 0.1\nframe_rate: 50\n"
        "gravity: [0, 0, 0]\ndomain: {lo: [0, 0, 0], hi: [0.4, 0.4, 0.4]}\n"
        "fluid: {tank: {lo: [0, 0, 0], hi: [0.4, 0.4, 0.4]}}\n"
        "emitters: {mouth: {centre: [0.2, 0.2, 0.2], direction: [0, 1, 0], radius: 0.05, speed: 0.05}}\n";
    ssfr_description *d = parse(full);
    const char *cache = test_new_path("cache");
    assert_int_equal(make(d, cache, -1), SSFR_OK);
    ssfr_particles *first = load(d, cache, 0, false), *last = load(d, cache, LAST, false);
    assert_in_range(last->n, first->n, first->n + 12);
    for (size_t i = 0; i < 3 * last->n; i++) assert_true(fabsf(last->velocity[i]) < 2);
    ssfr_particles_destroy(&first), ssfr_particles_destroy(&last);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

static void a_sink_leaves_nothing_in_it(void **state)
{
    (void)state;
    static const char drained[] =
        "title: A tank with a drain\nradius: 0.03\nparticles: 3000\nduration: 0.1\nframe_rate: 50\n"
        "domain: {lo: [0, 0, 0], hi: [0.4, 0.4, 0.4]}\nfluid: {tank: {lo: [0, 0, 0], hi: [0.4, 0.3, 0.4]}}\n"
        "sinks: {all: {lo: [-1, -1, -1], hi: [0.2, 1, 1]}}\n";
    ssfr_description *d = parse(drained);
    const char *cache = test_new_path("cache");
    assert_int_equal(make(d, cache, -1), SSFR_OK);
    ssfr_particles *first = load(d, cache, 0, false), *last = load(d, cache, LAST, false);
    assert_true(last->n < first->n / 2 + first->n / 10 && last->n > 0);
    ssfr_particles_destroy(&first), ssfr_particles_destroy(&last);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

/* ---- what fails -------------------------------------------------------------------------------------------------- */

static void a_frame_beyond_the_last_is_refused(void **state)
{
    (void)state;
    ssfr_description *d = parse(everything);
    assert_fails(SSFR_ERR_VALUE, make(d, reference_cache(d), LAST + 1), "frame 6: there are frames 0 to 5");
    ssfr_description_destroy(&d);
}

static void a_cache_that_cannot_be_made_is_one_line(void **state)
{
    (void)state;
    ssfr_description *d = parse(everything);
    const char *file = test_path("file");
    char inner[160];
    test_write_file(file, "", 0);
    snprintf(inner, sizeof inner, "%s/cache", file);
    assert_fails(SSFR_ERR_IO, make(d, inner, 0), "the folder cannot be made: Not a directory");
    ssfr_description_destroy(&d);
}

static void a_full_disk_leaves_the_frames_before(void **state)
{
    (void)state;
    ssfr_description *d = parse(jet); /* its frames grow */
    const char *cache = test_new_path("cache");
    char *folder = folder_of(d, cache, 1);
    test_limit_file_size(20000);
    assert_fails(SSFR_ERR_IO, make(d, cache, -1), "b c.yaml, frame ");
    test_limit_file_size(SIZE_MAX);
    const int n = ssfr_make_count(folder);
    assert_in_range(n, 1, LAST);
    char path[256];
    snprintf(path, sizeof path, "%s/x", folder);
    assert_int_equal(test_count_files(path, ".part"), 0);
    for (int i = 0; i < n; i++) {
        ssfr_particles *particles = load(d, cache, i, false);
        ssfr_particles_destroy(&particles);
    }
    assert_int_equal(make(d, cache, -1), SSFR_OK); /* now there is room */
    assert_int_equal(ssfr_make_count(folder), LAST + 1);
    free(folder);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

/* A step of the fastest particle takes 1 ns. */
static void what_blows_up_names_frame_and_particle_and_leaves_the_frames_before(void **state)
{
    (void)state;
    static const char fast[] =
        "title: Too fast\nradius: 0.001\nparticles: 100\nduration: 0.1\nframe_rate: 50\nsolver: {cfl: 0.01}\n"
        "domain: {lo: [0, 0, 0], hi: [0.4, 0.4, 0.4]}\n"
        "fluid: {bullet: {lo: [0, 0, 0], hi: [0.002, 0.002, 0.002], velocity: [10000, 0, 0]}}\n";
    ssfr_description *d = parse(fast);
    const char *cache = test_new_path("cache");
    char *folder = folder_of(d, cache, 1);
    for (int i = 0; i < 2; i++) { /* once more from the state that was left */
        assert_fails(SSFR_ERR_VALUE, make(d, cache, -1), 
                     "a/b c.yaml, frame 1: particle 0 has a velocity of (10000, 0, 0) m/s: steps of 1e-09 s");
        assert_int_equal(ssfr_make_count(folder), 1);
    }
    free(folder);
    remove_all(cache);
    ssfr_description_destroy(&d);
}

static void emitters_and_solids_that_are_too_fast_are_found_out(void **state)
{
    (void)state;
    static const char gun[] =
        "title: Too fast\nradius: 0.001\nparticles: 100\nduration: 0.1\nframe_rate: 50\nsolver: {cfl: 0.01}\n"
        "domain: {lo: [0, 0, 0], hi: [0.4, 0.4, 0.4]}\n"
        "emitters: {gun: {centre: [0.1, 0.1, 0.1], direction: [1, 0, 0], radius: 0.001, speed: 10000, start: 0.03}}\n";
    static const char racket[] =
        "title: Too fast\nradius: 0.001\nparticles: 100\nduration: 0.1\nframe_rate: 50\nsolver: {cfl: 0.01}\n"
        "domain: {lo: [0, 0, 0], hi: [0.4, 0.4, 0.4]}\n"
        "motions: {hit: {keys: [{time: 0.03}, {time: 0.05, move: [0, 100, 0]}]}}\n"
        "solids: {board: {shape: box, centre: [0.2, 0.3, 0.2], size: [0.1, 0.1, 0.1], motion: hit}}\n"
        "fluid: {drop: {lo: [0, 0, 0], hi: [0.002, 0.002, 0.002]}}\n";
    const char *const texts[] = {gun, racket};
    const char *cache = test_new_path("cache");
    for (size_t i = 0; i < SSFR_COUNT(texts); i++) {
        ssfr_description *d = parse(texts[i]);
        char *folder = folder_of(d, cache, 1);
        assert_fails(SSFR_ERR_VALUE, make(d, cache, -1), "a/b c.yaml, frame 2: an emitter or a solid is so fast");
        assert_int_equal(ssfr_make_count(folder), 2);
        free(folder);
        ssfr_description_destroy(&d);
    }
    remove_all(cache);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_told_apart_by_all_that_they_depend_on),
        cmocka_unit_test(meshes_are_part_of_the_key),
        cmocka_unit_test(the_users_cache_is_where_the_environment_says),
        cmocka_unit_test(frames_have_the_same_bits_for_any_number_of_threads),
        cmocka_unit_test(frames_made_one_by_one_are_those_made_at_once),
        cmocka_unit_test(what_is_there_is_not_made_again),
        cmocka_unit_test(a_frame_that_was_removed_is_made_again),
        cmocka_unit_test(a_damaged_state_costs_time_and_nothing_else),
        cmocka_unit_test(each_frame_has_the_time_that_it_took),
        cmocka_unit_test(a_frame_holds_what_a_simulation_knows),
        cmocka_unit_test(an_emitter_streams_at_the_density_of_rest),
        cmocka_unit_test(there_are_never_more_particles_than_allowed),
        cmocka_unit_test(nothing_is_emitted_into_a_solid),
        cmocka_unit_test(a_mouth_that_is_full_emits_nothing),
        cmocka_unit_test(a_sink_leaves_nothing_in_it),
        cmocka_unit_test(a_frame_beyond_the_last_is_refused),
        cmocka_unit_test(a_cache_that_cannot_be_made_is_one_line),
        cmocka_unit_test(a_full_disk_leaves_the_frames_before),
        cmocka_unit_test(what_blows_up_names_frame_and_particle_and_leaves_the_frames_before),
        cmocka_unit_test(emitters_and_solids_that_are_too_fast_are_found_out),
    };
    return cmocka_run_group_tests(tests, test_capture_log, remove_reference);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_truth_cache.c: tiles, and their file: nothing that happens to it changes a bit of the truth. */
#include "tests/disk.h"
#include "tests/truths.h"

#include "experiments/interrupt.h"
#include "experiments/truth/tiles.h"

#include "base/param.h"
#include "scene/mesh.h"

#include <inttypes.h>
#include <omp.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char *const plain[] = {"truth.parts", "surface,thickness", "truth.kind", "spheres", NULL};

/* 70 x 41 pixels: six tiles, of which the first is whole. */
enum { W = 70, H = 41, N_TILES = 6 };

static ssfr_stage *some_balls(void)
{
    static const double positions[] = {0, 0, 0, 0.31, 0.1, -0.2, -0.4, -0.23, 0.1}, eye[] = {0.2, 0.3, 2.385},
                        target[] = {0, 0, 0};
    return test_truth_stage(3, positions, 0.25, eye, target, W, H);
}

static const char *file_of(const char *cache, const ssfr_stage *stage, const ssfr_truth_params *params,
                           const ssfr_truth_options *options)
{
    static char path[1200];
    snprintf(path, sizeof path, "%s/truth/%016" PRIx64 ".tiles", cache, ssfr_truth_key(stage, params, options));
    return path;
}

static void remove_cache(const char *cache, const char *file)
{
    char folder[1100];
    snprintf(folder, sizeof folder, "%s/truth", cache);
    assert_int_equal(remove(file), 0);
    assert_int_equal(rmdir(folder), 0);
    assert_int_equal(rmdir(cache), 0);
}

/* ---- tiles ------------------------------------------------------------------------------------------------------- */

/* How often each pixel is listed. */
static void count_pixels(const ssfr_tiles *tiles, int *counts)
{
    for (int i = 0; i < tiles->n; i++) {
        int pixels[SSFR_TRUTH_TILE_PIXELS][2];
        const int n = ssfr_tiles_pixels(tiles, i, pixels);
        assert_int_equal(n, tiles->first[i + 1] - tiles->first[i]);
        for (int p = 0; p < n; p++) {
            assert_int_equal(pixels[p][1] / SSFR_TRUTH_TILE * tiles->tiles_x + pixels[p][0] / SSFR_TRUTH_TILE, i);
            counts[pixels[p][1] * tiles->w + pixels[p][0]]++;
        }
    }
}

static void every_pixel_is_in_one_tile_once(void **state)
{
    (void)state;
    static int counts[W * H];
    ssfr_tiles tiles;
    memset(counts, 0, sizeof counts);
    assert_int_equal(ssfr_tiles_init(&tiles, W, H, SSFR_TRUTH_ALL, 1, 1), SSFR_OK);
    assert_int_equal(tiles.n, N_TILES);
    count_pixels(&tiles, counts);
    for (int i = 0; i < W * H; i++) assert_int_equal(counts[i], 1);
    ssfr_tiles_finish(&tiles);
}

static void one_pixel_of_each_square_is_cast_whatever_the_squares_are(void **state)
{
    (void)state;
    static const int sides[] = {2, 7, 31, 32, 33, 50, 64, 100};
    static int counts[W * H];
    for (size_t s = 0; s < SSFR_COUNT(sides); s++) {
        ssfr_tiles tiles;
        memset(counts, 0, sizeof counts);
        assert_int_equal(ssfr_tiles_init(&tiles, W, H, SSFR_TRUTH_ALL, sides[s], 5), SSFR_OK);
        count_pixels(&tiles, counts);
        for (int y = 0; y < H; y += sides[s])
            for (int x = 0; x < W; x += sides[s]) {
                int n = 0;
                for (int j = y; j < ssfr_min_int(y + sides[s], H); j++)
                    for (int i = x; i < ssfr_min_int(x + sides[s], W); i++) n += counts[j * W + i];
                assert_int_equal(n, 1);
            }
        ssfr_tiles_finish(&tiles);
    }
}

/* Chi square over the nine pixels of a square: 8 degrees of freedom exceed 26.1 once in a thousand. */
static void all_pixels_of_a_square_have_the_same_chance(void **state)
{
    (void)state;
    enum { SIDE = 3, DRAWS = 9000 };
    int counts[SIDE * SIDE] = {0};
    double chi2 = 0;
    for (int seed = 0; seed < DRAWS; seed++) {
        const ssfr_tiles tiles = {.w = W, .h = H, .every = SIDE, .seed = (uint64_t)seed};
        int pixel[2];
        ssfr_tiles_choose(&tiles, 6, 9, pixel);
        counts[(pixel[1] - 9) * SIDE + pixel[0] - 6]++;
    }
    for (int i = 0; i < SIDE * SIDE; i++) chi2 += ssfr_square(counts[i] - DRAWS / 9.0) / (DRAWS / 9.0);
    assert_true(chi2 < 26.1);
}

/* ---- the file ---------------------------------------------------------------------------------------------------- */

typedef struct fixture {
    ssfr_stage *stage;
    ssfr_truth_params params;
    ssfr_truth *truth; /* cast without a cache */
    const char *cache, *file;
    ssfr_truth_options options;
} fixture;

static void begin(fixture *f)
{
    *f = (fixture){.stage = some_balls(), .params = test_truth_params(plain), .cache = test_new_path("cache")};
    f->options = (ssfr_truth_options){.every = 1, .cache = f->cache};
    f->truth = test_truth_cast(f->stage, &f->params);
    f->file = file_of(f->cache, f->stage, &f->params, &f->options);
}

static void end(fixture *f)
{
    remove_cache(f->cache, f->file);
    ssfr_truth_destroy(&f->truth);
    ssfr_stage_destroy(&f->stage);
}

/* Casts, with what the cache has, and finds the same bits and the same counts. */
static void assert_same(const fixture *f, bool cached)
{
    ssfr_truth *truth = NULL;
    assert_int_equal(ssfr_truth_create(&truth, f->stage, &f->params, &f->options), SSFR_OK);
    assert_true(test_truth_same(truth, f->truth));
    assert_int_equal(truth->stats.cached, cached);
    assert_int_equal(truth->stats.rays, W * H);
    assert_int_equal(truth->stats.crossings, f->truth->stats.crossings);
    assert_true(truth->stats.judged_max == f->truth->stats.judged_max);
    ssfr_truth_destroy(&truth);
}

static void what_was_cast_is_not_cast_again(void **state)
{
    (void)state;
    fixture f;
    begin(&f);
    assert_same(&f, false);
    assert_same(&f, true);
    f.options.anew = true;
    assert_same(&f, false);
    end(&f);
}

static void a_file_that_is_cut_at_any_byte_gives_the_same_bits(void **state)
{
    (void)state;
    fixture f;
    struct stat info;
    begin(&f);
    assert_same(&f, false);
    assert_int_equal(stat(f.file, &info), 0);
    for (off_t size = 0; size < info.st_size; size += size < 200 ? 13 : 4099) {
        assert_int_equal(truncate(f.file, size), 0);
        assert_same(&f, false);
        assert_same(&f, true);
    }
    end(&f);
}

static void invert_byte(const char *path, long at)
{
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, at, SEEK_SET), 0);
    const int byte = getc(file);
    assert_int_equal(fseek(file, at, SEEK_SET), 0);
    assert_int_equal(putc(byte ^ 0xff, file), byte ^ 0xff);
    assert_int_equal(fclose(file), 0);
}

/* One tile is empty: most of its bytes stand for nothing, so only those of the first are looked at. */
static void damage_is_found_and_mended(void **state)
{
    (void)state;
    fixture f;
    begin(&f);
    assert_same(&f, false);
    for (long at = 0; at < 60000; at += at < 80 ? 3 : 1999) {
        invert_byte(f.file, at);
        assert_same(&f, false);
        assert_same(&f, true);
    }
    end(&f);
}

static void a_file_of_rubbish_is_as_good_as_none(void **state)
{
    (void)state;
    fixture f;
    uint64_t random = 7;
    static unsigned char bytes[100000];
    begin(&f);
    assert_same(&f, false);
    for (size_t i = 0; i < sizeof bytes; i++) bytes[i] = (unsigned char)test_random(&random, 0, 256);
    test_write_file(f.file, bytes, sizeof bytes);
    assert_same(&f, false);
    assert_same(&f, true);
    end(&f);
}

static void threads_and_tiles_change_no_bit(void **state)
{
    (void)state;
    fixture f;
    const int before = omp_get_max_threads();
    begin(&f);
    for (int n = 1; n <= 3; n++) {
        ssfr_truth *truth = NULL;
        omp_set_num_threads(n);
        truth = test_truth_cast(f.stage, &f.params);
        assert_true(test_truth_same(truth, f.truth));
        ssfr_truth_destroy(&truth);
    }
    omp_set_num_threads(before);
    assert_same(&f, false);
    end(&f);
}

/* ---- what is in the file is of this key and of its place --------------------------------------------------------- */

static size_t load_file(const char *path, unsigned char *bytes, size_t size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t n = fread(bytes, 1, size, file);
    assert_int_equal(fclose(file), 0);
    return n;
}

static void tiles_of_another_truth_are_not_taken(void **state)
{
    (void)state;
    static unsigned char bytes[400000];
    fixture f;
    begin(&f);
    ssfr_truth *other = NULL;
    ssfr_truth_params larger = f.params;
    assert_int_equal(ssfr_truth_set(&larger, "truth.size", "1.1"), SSFR_OK);
    assert_int_equal(ssfr_truth_create(&other, f.stage, &larger, &f.options), SSFR_OK);
    ssfr_truth_destroy(&other);
    const char *path = file_of(f.cache, f.stage, &larger, &f.options);
    const size_t size = load_file(path, bytes, sizeof bytes);
    assert_in_range(size, 100000, sizeof bytes - 1);
    assert_int_equal(remove(path), 0);
    f.file = file_of(f.cache, f.stage, &f.params, &f.options);
    test_write_file(f.file, bytes, size);
    assert_same(&f, false);
    end(&f);
}

/* The first two tiles of the upper row have as many pixels. */
static void tiles_in_each_others_place_are_not_taken(void **state)
{
    (void)state;
    enum { VALUES = 11 }; /* of surface and thickness */
    const size_t head = 2 * sizeof(uint64_t) + sizeof(ssfr_truth_tally);
    const size_t tile = head + SSFR_TRUTH_TILE_PIXELS * VALUES * sizeof(double);
    static unsigned char bytes[400000], swapped[400000];
    fixture f;
    begin(&f);
    assert_same(&f, false);
    const size_t size = load_file(f.file, bytes, sizeof bytes);
    assert_true(size > 2 * tile);
    memcpy(swapped, bytes, size);
    memcpy(swapped, bytes + tile, tile), memcpy(swapped + tile, bytes, tile);
    assert_memory_not_equal(swapped, bytes, tile);
    test_write_file(f.file, swapped, size);
    assert_same(&f, false);
    assert_same(&f, true);
    end(&f);
}

/* ---- interrupted, and two at once -------------------------------------------------------------------------------- */

static void a_signal_ends_the_work_and_says_how_to_go_on(void **state)
{
    (void)state;
    fixture f;
    ssfr_truth *truth = NULL;
    begin(&f);
    ssfr_interrupt_begin();
    raise(SIGTERM);
    assert_fails(SSFR_ERR_IO, ssfr_truth_create(&truth, f.stage, &f.params, &f.options),
                 "interrupted after 0 of 6 tiles: the same command goes on from there");
    f.options.no_cache = true;
    assert_fails(SSFR_ERR_IO, ssfr_truth_create(&truth, f.stage, &f.params, &f.options), "which nothing keeps");
    ssfr_interrupt_end();
    assert_null(truth);
    f.options.no_cache = false;
    assert_same(&f, false);
    ssfr_interrupt_begin();
    raise(SIGINT);
    assert_same(&f, true); /* there is nothing left to stop */
    ssfr_interrupt_end();
    end(&f);
}

/* In a process of its own; leaves with 0 when the bits are right. */
static pid_t cast_aside(const fixture *f)
{
    const pid_t pid = fork();
    if (pid != 0) return pid;
    ssfr_truth *truth = NULL;
    ssfr_log_to(NULL, NULL);
    omp_set_num_threads(1);
    const bool right = ssfr_truth_create(&truth, f->stage, &f->params, &f->options) == SSFR_OK &&
                       test_truth_same(truth, f->truth);
    _exit(right ? 0 : 1);
}

static void two_processes_at_once_get_the_same(void **state)
{
    (void)state;
    fixture f;
    begin(&f);
    const pid_t pids[] = {cast_aside(&f), cast_aside(&f)};
    for (size_t i = 0; i < SSFR_COUNT(pids); i++) {
        int status;
        assert_true(waitpid(pids[i], &status, 0) == pids[i]);
        assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    assert_same(&f, true);
    end(&f);
}

static void a_killed_process_leaves_what_it_did(void **state)
{
    const struct timespec pause = {.tv_nsec = 2000000}; /* ns */
    (void)state;
    fixture f;
    int status;
    begin(&f);
    const pid_t pid = cast_aside(&f);
    nanosleep(&pause, NULL);
    kill(pid, SIGKILL);
    assert_true(waitpid(pid, &status, 0) == pid);
    ssfr_truth *truth = NULL;
    assert_int_equal(ssfr_truth_create(&truth, f.stage, &f.params, &f.options), SSFR_OK);
    assert_true(test_truth_same(truth, f.truth));
    ssfr_truth_destroy(&truth);
    assert_same(&f, true);
    end(&f);
}

/* ---- errors ------------------------------------------------------------------------------------------------------ */

static void a_cache_that_cannot_be_written_is_refused_in_one_line(void **state)
{
    (void)state;
    fixture f;
    ssfr_truth *truth = NULL;
    const char *file = test_path("a file");
    begin(&f);
    test_write_file(file, "", 0);
    ssfr_truth_options options = {.every = 1, .cache = file};
    assert_fails(SSFR_ERR_IO, ssfr_truth_create(&truth, f.stage, &f.params, &options), "a file/truth");
    options.cache = "";
    assert_fails(SSFR_ERR_VALUE, ssfr_truth_create(&truth, f.stage, &f.params, &options), "0 bytes");
    assert_same(&f, false);
    end(&f);
}

static void a_full_disk_is_one_line_and_what_was_done_stays(void **state)
{
    (void)state;
    fixture f;
    ssfr_truth *truth = NULL;
    const int before = omp_get_max_threads();
    begin(&f);
    omp_set_num_threads(3); /* several fail, one tells */
    test_clear_log();
    test_limit_file_size(70000); /* a whole tile has 57 kB */
    const ssfr_result result = ssfr_truth_create(&truth, f.stage, &f.params, &f.options);
    test_limit_file_size(SIZE_MAX);
    omp_set_num_threads(before);
    assert_int_equal(result, SSFR_ERR_IO);
    assert_null(truth);
    test_assert_logged(".tiles: ", __FILE__, __LINE__);
    assert_same(&f, false);
    end(&f);
}

/* ---- the key ----------------------------------------------------------------------------------------------------- */

static uint64_t key_of(const ssfr_stage *stage, const ssfr_truth_params *params)
{
    const ssfr_truth_options options = {.every = 1, .seed = 1};
    return ssfr_truth_key(stage, params, &options);
}

/* The balls with foam around, a floor and a solid: every parameter has something to act on. */
static ssfr_stage *all_there_is(int w, int h)
{
    static const double foam[] = {0.1, 0.2, 0.4, -0.1, -0.2, 0.35, 0.2, -0.1, 0.3};
    static uint32_t kinds[] = {SSFR_SPRAY, SSFR_FOAM, SSFR_BUBBLE};
    const ssfr_particles given = {.radius = 0.05, .kind = kinds};
    ssfr_stage *stage = some_balls();
    assert_int_equal(ssfr_particles_create(&stage->foam, 3, foam, &given), SSFR_OK);
    stage->solids[0] = (ssfr_solid){.shape = SSFR_BOX, .centre = {0.3, 0.1, -0.5}, .half = {0.2, 0.3, 0.1},
                                    .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .colour = {0.5, 0.4, 0.3}};
    stage->scene.n_solids = 1;
    stage->scene.floor = -0.6;
    stage->scene.camera.w = w, stage->scene.camera.h = h;
    return stage;
}

/* Another value within the row's range. */
static void another_value(const ssfr_param *row, const void *group, char *text, size_t size)
{
    const double value = ssfr_param_number(row, group), less = 0.75 * value + 0.25 * row->min;
    if (row->type == SSFR_REAL)
        snprintf(text, size, "%.17g", value > row->min ? less : value + 0.25 * fmin(row->max - value, 1));
    else if (row->type == SSFR_CHOICE)
        snprintf(text, size, "%s", row->words[value == 0]);
    else
        snprintf(text, size, "%.0f", row->type == SSFR_INT ? floor(0.5 * value) : value == 0);
}

static const char *const parts_of_truth[] = {"surface", "thickness", "foam", "colour"};

/* What the key has of each part: groups of parameters, by their names' beginnings. */
static bool belongs(const char *key, const char *part)
{
    static const char *const integrals[] = {"integrator", "eps_abs", "eps_rel", "points", "steps", "judged"};
    const bool foam = strcmp(part, "foam") == 0, colour = strcmp(part, "colour") == 0;
    bool integral = false;
    for (size_t i = 0; i < SSFR_COUNT(integrals); i++) integral |= strcmp(key + 6, integrals[i]) == 0;
    if (strncmp(key, "truth.", 6) == 0) return !integral || strcmp(part, "surface") != 0;
    if (strncmp(key, "extinction.", 11) == 0) return foam || colour;
    if (strncmp(key, "anisotropy.", 11) == 0) return false; /* the kind is another */
    return colour;
}

/* And where another value gives other bits, for certain, it gives another key. */
static void the_key_has_the_parameters_that_a_part_depends_on_and_no_others(void **state)
{
    (void)state;
    ssfr_stage *stage = all_there_is(9, 6);
    const ssfr_param *row;
    const void *group;
    char key[128], text[256];
    int n_changed = 0;
    for (size_t p = 0; p < SSFR_COUNT(parts_of_truth); p++) {
        const char *const settings[] = {"truth.parts", parts_of_truth[p], "path.depth", "6", NULL};
        const ssfr_truth_params before = test_truth_params(settings);
        ssfr_truth *as_before = test_truth_cast(stage, &before);
        for (int i = 0; ssfr_truth_key_at(&before, i, key, &row, &group); i++) {
            if (row->type == SSFR_SET) continue;
            ssfr_truth_params after = before;
            another_value(row, group, text, sizeof text);
            assert_int_equal(ssfr_truth_set(&after, key, text), SSFR_OK);
            ssfr_truth *other = test_truth_cast(stage, &after);
            assert_int_equal(key_of(stage, &after) != key_of(stage, &before), belongs(key, parts_of_truth[p]));
            if (!belongs(key, parts_of_truth[p])) assert_true(test_truth_same(other, as_before));
            n_changed += !test_truth_same(other, as_before);
            ssfr_truth_destroy(&other);
        }
        ssfr_truth_destroy(&as_before);
    }
    assert_true(n_changed > 30);
    ssfr_stage_destroy(&stage);
}

static void the_key_has_kernels_where_they_are_stretched(void **state)
{
    (void)state;
    ssfr_stage *stage = some_balls();
    const char *const before[] = {"truth.parts", "surface", "truth.kind", "anisotropic", NULL};
    ssfr_truth_params params = test_truth_params(before);
    const uint64_t key = key_of(stage, &params);
    assert_int_equal(ssfr_truth_set(&params, "anisotropy.k_r", "2"), SSFR_OK);
    assert_true(key_of(stage, &params) != key);
    ssfr_stage_destroy(&stage);
}

/* Whether the key of this part changes while *number is another. */
static bool changes(const ssfr_stage *stage, const char *part, bool solids, double *number)
{
    const char *const settings[] = {"truth.parts", part, "truth.solids", solids ? "1" : "0", NULL};
    const ssfr_truth_params params = test_truth_params(settings);
    const uint64_t key = key_of(stage, &params);
    const double before = *number;
    *number += 1e-9;
    const bool other = key_of(stage, &params) != key;
    *number = before;
    assert_true(key_of(stage, &params) == key);
    return other;
}

static void the_key_knows_the_scene(void **state)
{
    (void)state;
    ssfr_stage *stage = all_there_is(W, H);
    ssfr_camera *c = &stage->scene.camera;
    ssfr_solid *solid = &stage->solids[0];
    double *of_view[] = {&c->eye[0], &c->right[1], &c->up[2], &c->back[0], &c->tan_x, &c->tan_y, &c->near,
                         &stage->particles->radius};
    double *of_solids[] = {&stage->scene.floor, &solid->centre[0], &solid->axis[1][1], &solid->half[2],
                           &solid->inner};
    for (size_t p = 0; p < SSFR_COUNT(parts_of_truth); p++) {
        const char *part = parts_of_truth[p];
        for (size_t i = 0; i < SSFR_COUNT(of_view); i++) assert_true(changes(stage, part, false, of_view[i]));
        for (size_t i = 0; i < SSFR_COUNT(of_solids); i++) {
            assert_int_equal(changes(stage, part, false, of_solids[i]), p >= 2);
            assert_true(changes(stage, part, true, of_solids[i]));
        }
        assert_int_equal(changes(stage, part, true, &solid->colour[1]), p == 3);
        assert_false(changes(stage, part, true, &c->far));
        assert_false(changes(stage, part, true, &stage->time));
    }
    ssfr_stage_destroy(&stage);
}

static void the_key_knows_foam_size_and_surroundings_where_they_are_seen(void **state)
{
    (void)state;
    ssfr_stage *stage = all_there_is(W, H);
    ssfr_field *sky = NULL;
    assert_int_equal(ssfr_field_create(&sky, 4, 2, 3), SSFR_OK);
    for (size_t p = 0; p < SSFR_COUNT(parts_of_truth); p++) {
        const char *const settings[] = {"truth.parts", parts_of_truth[p], "truth.solids", "0", NULL};
        const ssfr_truth_params params = test_truth_params(settings);
        const uint64_t key = key_of(stage, &params);
#define CHANGED (key_of(stage, &params) != key)
        const float place = stage->foam->position[1];
        const uint32_t kind = stage->foam->kind[2];
        stage->foam->position[1] = nextafterf(place, 1);
        assert_int_equal(CHANGED, p >= 2);
        stage->foam->position[1] = place;
        stage->foam->kind[2] = (kind + 1) % 3;
        assert_int_equal(CHANGED, p >= 2);
        stage->foam->kind[2] = kind;
        stage->scene.environment = sky;
        assert_int_equal(CHANGED, p == 3);
        const uint64_t dark = key_of(stage, &params);
        sky->data[5] = 1;
        assert_int_equal(key_of(stage, &params) != dark, p == 3);
        sky->data[5] = 0;
        stage->scene.environment = NULL;
        stage->scene.camera.w++;
        assert_true(CHANGED);
        stage->scene.camera.w--, stage->scene.camera.h++;
        assert_true(CHANGED);
        stage->scene.camera.h--, stage->scene.n_solids = 0;
        assert_int_equal(CHANGED, p >= 2);
        stage->scene.n_solids = 1;
        assert_false(CHANGED);
#undef CHANGED
    }
    ssfr_field_destroy(&sky);
    ssfr_stage_destroy(&stage);
}

static void the_key_knows_a_mesh_by_its_triangles(void **state)
{
    (void)state;
    ssfr_stage *stage = all_there_is(W, H);
    ssfr_mesh_triangle triangles[] = {{.corner = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    ssfr_mesh mesh = {.n_triangles = 1, .triangles = triangles};
    stage->solids[0].mesh = &mesh;
    assert_true(changes(stage, "foam", false, &triangles[0].corner[2][1]));
    assert_false(changes(stage, "surface", false, &triangles[0].corner[2][1]));
    stage->solids[0].mesh = NULL;
    ssfr_stage_destroy(&stage);
}

/* The order in a file, names, velocities and the like are nothing that a ray meets. */
static void the_key_knows_nothing_of_how_particles_came(void **state)
{
    (void)state;
    static const double there[] = {0.3, 0.1, -0.2, 0, 0, 0, -0.4, -0.2, 0.1},
                        back[] = {-0.4, -0.2, 0.1, 0.3, 0.1, -0.2, 0, 0, 0};
    static float velocity[9] = {1, 2, 3};
    static uint32_t id[] = {7, 5, 6};
    const ssfr_particles plain_ones = {.radius = 0.2}, rich_ones = {.radius = 0.2, .velocity = velocity, .id = id};
    const ssfr_truth_params params = test_truth_params(plain);
    ssfr_stage *stage = some_balls();
    ssfr_particles *one = NULL, *other = NULL;
    assert_int_equal(ssfr_particles_create(&one, 3, there, &plain_ones), SSFR_OK);
    assert_int_equal(ssfr_particles_create(&other, 3, back, &rich_ones), SSFR_OK);
    stage->scene.particles = one;
    const uint64_t key = key_of(stage, &params);
    stage->scene.particles = other;
    assert_true(key_of(stage, &params) == key);
    other->position[3] = nextafterf(other->position[3], 1);
    assert_true(key_of(stage, &params) != key);
    other->n--;
    assert_true(key_of(stage, &params) != key);
    other->n++;
    ssfr_particles_destroy(&one), ssfr_particles_destroy(&other);
    ssfr_stage_destroy(&stage);
}

static void the_key_knows_the_sample(void **state)
{
    (void)state;
    ssfr_stage *stage = some_balls();
    const ssfr_truth_params params = test_truth_params(plain);
    ssfr_truth_options options = {.every = 1, .seed = 1};
    const uint64_t key = ssfr_truth_key(stage, &params, &options);
    options.seed = 2; /* counts for samples only */
    assert_true(ssfr_truth_key(stage, &params, &options) == key);
    options.cache = "elsewhere", options.anew = options.progress = true;
    assert_true(ssfr_truth_key(stage, &params, &options) == key);
    options.every = 2;
    const uint64_t second = ssfr_truth_key(stage, &params, &options);
    assert_true(second != key);
    options.every = 3;
    assert_true(ssfr_truth_key(stage, &params, &options) != second);
    options.every = 2, options.seed = 3;
    assert_true(ssfr_truth_key(stage, &params, &options) != second);
    ssfr_stage_destroy(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pixel_is_in_one_tile_once),
        cmocka_unit_test(one_pixel_of_each_square_is_cast_whatever_the_squares_are),
        cmocka_unit_test(all_pixels_of_a_square_have_the_same_chance),
        cmocka_unit_test(what_was_cast_is_not_cast_again),
        cmocka_unit_test(a_file_that_is_cut_at_any_byte_gives_the_same_bits),
        cmocka_unit_test(damage_is_found_and_mended),
        cmocka_unit_test(a_file_of_rubbish_is_as_good_as_none),
        cmocka_unit_test(tiles_of_another_truth_are_not_taken),
        cmocka_unit_test(tiles_in_each_others_place_are_not_taken),
        cmocka_unit_test(two_processes_at_once_get_the_same),
        cmocka_unit_test(a_killed_process_leaves_what_it_did),
        cmocka_unit_test(threads_and_tiles_change_no_bit),
        cmocka_unit_test(a_signal_ends_the_work_and_says_how_to_go_on),
        cmocka_unit_test(a_cache_that_cannot_be_written_is_refused_in_one_line),
        cmocka_unit_test(a_full_disk_is_one_line_and_what_was_done_stays),
        cmocka_unit_test(the_key_has_the_parameters_that_a_part_depends_on_and_no_others),
        cmocka_unit_test(the_key_has_kernels_where_they_are_stretched),
        cmocka_unit_test(the_key_knows_the_scene),
        cmocka_unit_test(the_key_knows_foam_size_and_surroundings_where_they_are_seen),
        cmocka_unit_test(the_key_knows_a_mesh_by_its_triangles),
        cmocka_unit_test(the_key_knows_nothing_of_how_particles_came),
        cmocka_unit_test(the_key_knows_the_sample),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_exr.c: EXR files hold what was saved to the bit, files of other programs are read, bad ones are refused. */
#include "tests/disk.h"
#include "tests/util.h"

#include <openexr.h>
#include <sys/stat.h>
#include <unistd.h>

static ssfr_field *make_field(int w, int h, int c, uint64_t seed)
{
    ssfr_field *field = NULL;
    assert_int_equal(ssfr_field_create(&field, w, h, c), SSFR_OK);
    for (int i = 0; i < w * h * c; i++) field->data[i] = (double)(float)test_random(&seed, -2.385, 17.43);
    return field;
}

static void assert_same_field(const ssfr_field *a, const ssfr_field *b)
{
    assert_int_equal(a->w, b->w);
    assert_int_equal(a->h, b->h);
    assert_int_equal(a->c, b->c);
    assert_memory_equal(a->data, b->data, (size_t)(a->w * a->h * a->c) * sizeof *a->data);
}

static void assert_loads(const char *path, const char *channels, const ssfr_field *expected)
{
    ssfr_field *field = NULL;
    assert_int_equal(ssfr_exr_load(path, channels, &field), SSFR_OK);
    assert_same_field(field, expected);
    ssfr_field_destroy(&field);
}

static void save_one(const char *path, const char *channels, ssfr_field *field)
{
    const ssfr_layer layer = {channels, field};
    assert_int_equal(ssfr_exr_save(path, 1, &layer, 0, NULL), SSFR_OK);
}

/* ---- what ssfr writes ------------------------------------------------------------------------------------------- */

static void round_trip_is_bit_exact_in_float(void **state)
{
    (void)state;
    static const int sizes[][2] = {{1, 1}, {1, 40}, {53, 1}, {16, 16}, {37, 33}, {640, 47}};
    const char *path = test_path("round.exr");
    for (size_t i = 0; i < SSFR_COUNT(sizes); i++) {
        ssfr_field *field = make_field(sizes[i][0], sizes[i][1], 3, i);
        save_one(path, "R,G,B", field);
        assert_loads(path, "R,G,B", field);
        ssfr_field_destroy(&field);
    }
}

static void extreme_values_survive(void **state)
{
    (void)state;
    const double values[] = {-SSFR_EMPTY, SSFR_EMPTY, (double)NAN, INFINITY, -INFINITY, -0.0, 0.0, 2.385,
                             1.401298464324817e-45, -1.1754942106924411e-38, 3.4028234663852886e38, -SSFR_SURFACE};
    const int n = (int)SSFR_COUNT(values);
    const char *path = test_path("extreme.exr");
    ssfr_field *field = NULL, *rounded = NULL;
    assert_int_equal(ssfr_field_create(&field, n, 1, 1), SSFR_OK);
    assert_int_equal(ssfr_field_create(&rounded, n, 1, 1), SSFR_OK);
    memcpy(field->data, values, sizeof values);
    for (int i = 0; i < n; i++) rounded->data[i] = (double)(float)values[i];
    save_one(path, "Z", field);
    assert_loads(path, "Z", rounded);
    ssfr_field_destroy(&rounded);
    ssfr_field_destroy(&field);
}

static void doubles_are_rounded_to_the_nearest_float(void **state)
{
    (void)state;
    const char *path = test_path("rounded.exr");
    ssfr_field *field = NULL, *back = NULL;
    assert_int_equal(ssfr_field_create(&field, 3, 1, 1), SSFR_OK);
    field->data[0] = 2.385, field->data[1] = 1 + 0x1.8p-24, field->data[2] = 1e300;
    save_one(path, "Z", field);
    assert_int_equal(ssfr_exr_load(path, "Z", &back), SSFR_OK);
    assert_true(back->data[0] == (double)2.385f);
    assert_true(back->data[1] == 1 + 0x1p-23);
    assert_true(back->data[2] == INFINITY);
    ssfr_field_destroy(&back);
    ssfr_field_destroy(&field);
}

static void channels_are_sorted_and_read_back_in_any_order(void **state)
{
    (void)state;
    const char *path = test_path("layers.exr");
    ssfr_field *colour = make_field(21, 19, 3, 1), *normal = make_field(21, 19, 3, 2);
    ssfr_field *depth = make_field(21, 19, 1, 3);
    const ssfr_layer layers[] = {{"R,G,B", colour}, {"Z", depth}, {"N.X,N.Y,N.Z", normal}};
    ssfr_field *mixed = NULL;
    char *names = NULL;
    assert_int_equal(ssfr_exr_save(path, 3, layers, 0, NULL), SSFR_OK);
    assert_int_equal(ssfr_exr_channels(path, &names), SSFR_OK);
    assert_string_equal(names, "B,G,N.X,N.Y,N.Z,R,Z");
    assert_loads(path, "R,G,B", colour);
    assert_loads(path, "N.X,N.Y,N.Z", normal);
    assert_loads(path, "Z", depth);
    assert_int_equal(ssfr_exr_load(path, "Z,B,N.Y", &mixed), SSFR_OK);
    for (int y = 0; y < 19; y++)
        for (int x = 0; x < 21; x++) {
            assert_true(ssfr_field_at(mixed, x, y)[0] == *ssfr_field_at(depth, x, y));
            assert_true(ssfr_field_at(mixed, x, y)[1] == ssfr_field_at(colour, x, y)[2]);
            assert_true(ssfr_field_at(mixed, x, y)[2] == ssfr_field_at(normal, x, y)[1]);
        }
    free(names);
    ssfr_field_destroy(&mixed);
    ssfr_field_destroy(&depth);
    ssfr_field_destroy(&normal);
    ssfr_field_destroy(&colour);
}

/* More channels than the library keeps without allocating, and more than a field holds. */
static void a_file_of_forty_channels_is_written_and_read(void **state)
{
    (void)state;
    const char *path = test_path("forty.exr");
    char lists[10][64];
    ssfr_layer layers[10];
    for (int i = 0; i < 10; i++) {
        snprintf(lists[i], sizeof lists[i], "s%d.a,s%d.b,s%d.c,s%d.d", i, i, i, i);
        layers[i] = (ssfr_layer){lists[i], make_field(9, 35, 4, (uint64_t)i)};
    }
    assert_int_equal(ssfr_exr_save(path, 10, layers, 0, NULL), SSFR_OK);
    for (int i = 0; i < 10; i++) {
        assert_loads(path, lists[i], layers[i].field);
        ssfr_field_destroy(&layers[i].field);
    }
}

static void attributes_are_kept_exactly(void **state)
{
    (void)state;
    const char *path = test_path("attributes.exr"), *copy = test_path("attributes2.exr");
    const char *long_name = "curvature_flow.a_parameter_with_quite_a_long_name";
    const ssfr_attribute attributes[] = {
        {"camera.eye.x", NULL, 1.0 / 3}, {"camera.far", NULL, INFINITY}, {"scene", "ddb_mid, frame 17", 0},
        {"dt", NULL, -2.385e-300}, {long_name, NULL, 17.43}};
    ssfr_field *field = make_field(4, 3, 1, 5);
    const ssfr_layer layer = {"Z", field};
    double value = 0;
    assert_int_equal(ssfr_exr_save(path, 1, &layer, 4, attributes), SSFR_OK);
    assert_int_equal(ssfr_exr_number(path, "camera.eye.x", &value), SSFR_OK);
    assert_true(value == 1.0 / 3);
    assert_int_equal(ssfr_exr_number(path, "camera.far", &value), SSFR_OK);
    assert_true(value == INFINITY);
    assert_int_equal(ssfr_exr_number(path, "dt", &value), SSFR_OK);
    assert_true(value == -2.385e-300);
    assert_int_equal(ssfr_exr_number(path, "pixelAspectRatio", &value), SSFR_OK); /* a float of every file */
    assert_true(value == 1);
    assert_int_equal(ssfr_exr_save(copy, 1, &layer, 5, attributes), SSFR_OK);
    assert_int_equal(ssfr_exr_number(copy, long_name, &value), SSFR_OK);
    assert_true(value == 17.43);
    ssfr_field_destroy(&field);
}

static void strings_are_written_as_string_attributes(void **state)
{
    (void)state;
    const char *path = test_path("strings.exr"), *text = NULL;
    const ssfr_attribute attribute = {"scene", "ddb_mid, frame 17", 0};
    ssfr_field *field = make_field(4, 3, 1, 5);
    const ssfr_layer layer = {"Z", field};
    exr_context_t context = NULL;
    int32_t length = 0;
    assert_int_equal(ssfr_exr_save(path, 1, &layer, 1, &attribute), SSFR_OK);
    assert_int_equal(exr_start_read(&context, path, NULL), EXR_ERR_SUCCESS);
    assert_int_equal(exr_attr_get_string(context, 0, "scene", &length, &text), EXR_ERR_SUCCESS);
    assert_int_equal(length, 17);
    assert_string_equal(text, "ddb_mid, frame 17");
    exr_finish(&context);
    ssfr_field_destroy(&field);
}

static void two_saves_give_the_same_bytes(void **state)
{
    (void)state;
    const char *paths[] = {test_path("same1.exr"), test_path("same2.exr")};
    ssfr_field *field = make_field(37, 41, 3, 6);
    char *data[2];
    size_t size[2];
    for (int i = 0; i < 2; i++) {
        save_one(paths[i], "R,G,B", field);
        assert_int_equal(ssfr_read_file(paths[i], 1 << 20, &data[i], &size[i]), SSFR_OK);
    }
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(data[0], data[1], size[0]);
    free(data[0]);
    free(data[1]);
    ssfr_field_destroy(&field);
}

/* The most that compression gives stays within what the reader believes of a file. */
static void a_large_constant_image_is_small_and_read(void **state)
{
    (void)state;
    const char *path = test_path("constant.exr");
    struct stat info;
    ssfr_field *field = NULL;
    assert_int_equal(ssfr_field_create(&field, 4096, 2048, 1), SSFR_OK);
    save_one(path, "Z", field);
    assert_int_equal(stat(path, &info), 0);
    assert_in_range(info.st_size, 1, 4096 * 2048 * 4 / 500);
    assert_loads(path, "Z", field);
    ssfr_field_destroy(&field);
}

static void saving_refuses_layers_that_do_not_fit(void **state)
{
    (void)state;
    const char *path = test_path("refused.exr");
    char name[300] = "";
    memset(name, 'n', sizeof name - 1);
    ssfr_field *a = make_field(7, 5, 1, 1), *b = make_field(7, 6, 1, 1), *rgb = make_field(7, 5, 3, 1);
    const ssfr_layer sizes[] = {{"Z", a}, {"T", b}}, count = {"R,G", rgb}, twice[] = {{"Z", a}, {"Z", a}},
                     empty = {"R,,B", rgb}, nameless = {"", a}, too_long = {name, a}, good = {"Z", a};
    const ssfr_attribute taken = {"compression", NULL, 2.385}, unnamed = {"", NULL, 2.385};
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_save(path, 2, sizes, 0, NULL), "layer T is 7 x 6 pixels, the first 7 x 5");
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_save(path, 1, &count, 0, NULL), "names 2 channels, its field has 3");
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_save(path, 2, twice, 0, NULL), "channel Z is named twice");
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_save(path, 1, &empty, 0, NULL), "\"R,,B\" has an empty name");
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_save(path, 1, &nameless, 0, NULL), "\"\" has an empty name");
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_save(path, 1, &too_long, 0, NULL), "name of 299 bytes");
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_save(path, 0, NULL, 0, NULL), "no layer");
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_save(path, 1, &good, 1, &taken), "attribute \"compression\"");
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_save(path, 1, &good, 1, &unnamed), "attribute \"\"");
    assert_int_equal(test_count_files(path, "refused.exr"), 0);
    ssfr_field_destroy(&a);
    ssfr_field_destroy(&b);
    ssfr_field_destroy(&rgb);
}

static void saving_where_nothing_can_be_written_fails(void **state)
{
    (void)state;
    char inside[256];
    const char *file = test_path("a_file"), *folder = test_path("a_folder");
    ssfr_field *field = make_field(7, 5, 1, 1);
    const ssfr_layer layer = {"Z", field};
    test_write_file(file, "x", 1);
    snprintf(inside, sizeof inside, "%s/z.exr", file);
    assert_fails(SSFR_ERR_IO, ssfr_exr_save(inside, 1, &layer, 0, NULL), inside);
    assert_fails(SSFR_ERR_IO, ssfr_exr_save("/nowhere/z.exr", 1, &layer, 0, NULL), "/nowhere/z.exr: ");
    assert_fails(SSFR_ERR_IO, ssfr_exr_save("/proc/z.exr", 1, &layer, 0, NULL), "/proc/z.exr: ");
    assert_int_equal(mkdir(folder, 0755), 0);
    assert_fails(SSFR_ERR_IO, ssfr_exr_save(folder, 1, &layer, 0, NULL), folder);
    assert_int_equal(rmdir(folder), 0);
    assert_int_equal(test_count_files(file, ".part"), 0);
    ssfr_field_destroy(&field);
}

static void a_failed_save_keeps_the_old_file(void **state)
{
    (void)state;
    const char *path = test_path("kept.exr");
    ssfr_field *old = make_field(7, 5, 1, 1), *new = make_field(200, 150, 1, 2);
    const ssfr_layer layer = {"Z", new};
    save_one(path, "Z", old);
    static const size_t limits[] = {0, 100, 1000, 60000};
    for (size_t i = 0; i < SSFR_COUNT(limits); i++) {
        test_limit_file_size(limits[i]);
        test_clear_log();
        const ssfr_result result = ssfr_exr_save(path, 1, &layer, 0, NULL);
        test_limit_file_size(SIZE_MAX);
        assert_int_equal(result, SSFR_ERR_IO);
        test_assert_logged(path, __FILE__, __LINE__);
        assert_loads(path, "Z", old);
        assert_int_equal(test_count_files(path, ".part"), 0);
    }
    save_one(path, "Z", new);
    assert_loads(path, "Z", new);
    ssfr_field_destroy(&new);
    ssfr_field_destroy(&old);
}

/* ---- what other programs write ---------------------------------------------------------------------------------- */

/* A file with channels A (half), B (float) and C (uint). */
typedef struct variant {
    exr_storage_t storage;
    exr_compression_t compression;
    int left, top, w, h, tile_w, tile_h;
    int sampling; /* of all channels */
    int levels;   /* exr_tile_level_mode_t */
    int n_parts;
} variant;

/* Constant over blocks of 4 x 4, which keeps every compression exact; B44 is lossy on halves otherwise. */
static float half_at(int x, int y)
{
    return (float)(x / 4 - 3 * (y / 4)) * 0.25f;
}

/* A half's bits: the writer takes no other type for half channels. Exact for the values above. */
static uint16_t half_bits(float v)
{
    int exponent = 0;
    const double fraction = frexp(fabs((double)v), &exponent);
    const int bits = fraction > 0 ? (exponent + 14) * 1024 + (int)(fraction * 2048) - 1024 : 0;
    return (uint16_t)(v < 0 ? bits + 32768 : bits);
}

static float float_at(int x, int y)
{
    return (float)(x * 3 - y * 7) * 0.375f;
}

static uint32_t uint_at(int x, int y)
{
    return 4294967295u - (uint32_t)(x * 70001 + y * 13);
}

/* One plane for each channel, of its own type. */
static void fill_planes(exr_encode_pipeline_t *encoder, int x0, int y0, char *planes)
{
    for (int k = 0; k < 3; k++) {
        exr_coding_channel_info_t *channel = &encoder->channels[k];
        const int w = channel->width, h = channel->height;
        const size_t size = (size_t)channel->bytes_per_element;
        channel->user_pixel_stride = (int)size;
        channel->user_line_stride = (int)size * w;
        channel->encode_from_ptr = (const uint8_t *)planes;
        for (int i = 0; i < w * h; i++, planes += size) {
            const int x = x0 + i % w, y = y0 + i / w;
            const uint16_t half = half_bits(half_at(x, y));
            const float real = float_at(x, y);
            const uint32_t number = uint_at(x, y);
            memcpy(planes, k == 0 ? (const void *)&half : k == 1 ? (const void *)&real : (const void *)&number, size);
        }
    }
}

static void write_chunk(exr_context_t context, int part, const exr_chunk_info_t *chunk, int x, int y)
{
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    char *planes = calloc((size_t)chunk->width * (size_t)chunk->height, 4 + 4 + 2);
    assert_non_null(planes);
    assert_int_equal(exr_encoding_initialize(context, part, chunk, &encoder), EXR_ERR_SUCCESS);
    fill_planes(&encoder, x, y, planes);
    assert_int_equal(exr_encoding_choose_default_routines(context, part, &encoder), EXR_ERR_SUCCESS);
    assert_int_equal(exr_encoding_run(context, part, &encoder), EXR_ERR_SUCCESS);
    exr_encoding_destroy(context, &encoder);
    free(planes);
}

static void write_part_header(exr_context_t context, int part, const variant *v)
{
    static const exr_pixel_type_t types[] = {EXR_PIXEL_HALF, EXR_PIXEL_FLOAT, EXR_PIXEL_UINT};
    static const char *const names[] = {"A", "B", "C"};
    const exr_attr_box2i_t window = {.min.x = v->left, .min.y = v->top, .max.x = v->left + v->w - 1,
                                     .max.y = v->top + v->h - 1};
    const exr_attr_box2i_t display = {.max.x = 9, .max.y = 9};
    const exr_attr_v2f_t centre = {.x = 0, .y = 0};
    char name[16];
    int index = 0;
    snprintf(name, sizeof name, "part%d", part);
    assert_int_equal(exr_add_part(context, v->n_parts > 1 ? name : NULL, v->storage, &index), EXR_ERR_SUCCESS);
    assert_int_equal(exr_initialize_required_attr(context, part, &display, &window, 1, &centre, 1,
                                                  v->storage == EXR_STORAGE_TILED ? EXR_LINEORDER_RANDOM_Y
                                                                                  : EXR_LINEORDER_INCREASING_Y,
                                                  v->compression),
                     EXR_ERR_SUCCESS);
    if (v->storage == EXR_STORAGE_TILED)
        assert_int_equal(exr_set_tile_descriptor(context, part, (uint32_t)v->tile_w, (uint32_t)v->tile_h,
                                                 (exr_tile_level_mode_t)v->levels, EXR_TILE_ROUND_DOWN),
                         EXR_ERR_SUCCESS);
    for (int k = 0; k < 3; k++)
        assert_int_equal(exr_add_channel(context, part, names[k], types[k], EXR_PERCEPTUALLY_LOGARITHMIC, v->sampling,
                                         v->sampling),
                         EXR_ERR_SUCCESS);
}

static void write_scanlines(exr_context_t context, int part, const variant *v)
{
    exr_chunk_info_t chunk;
    int32_t lines = 1;
    assert_int_equal(exr_get_scanlines_per_chunk(context, part, &lines), EXR_ERR_SUCCESS);
    for (int y = 0; y < v->h; y += lines) {
        assert_int_equal(exr_write_scanline_chunk_info(context, part, v->top + y, &chunk), EXR_ERR_SUCCESS);
        write_chunk(context, part, &chunk, 0, y);
    }
}

static void write_tiles(exr_context_t context, int part, const variant *v)
{
    exr_chunk_info_t chunk;
    int32_t n_levels = 1, n_levels_y = 1, level_w = 0, level_h = 0;
    assert_int_equal(exr_get_tile_levels(context, part, &n_levels, &n_levels_y), EXR_ERR_SUCCESS);
    for (int level = 0; level < n_levels; level++) {
        assert_int_equal(exr_get_level_sizes(context, part, level, level, &level_w, &level_h), EXR_ERR_SUCCESS);
        for (int y = 0; y < level_h; y += v->tile_h)
            for (int x = 0; x < level_w; x += v->tile_w) {
                assert_int_equal(exr_write_tile_chunk_info(context, part, x / v->tile_w, y / v->tile_h, level, level,
                                                           &chunk), EXR_ERR_SUCCESS);
                write_chunk(context, part, &chunk, level * 1000 + x, y); /* levels differ: only the first is read */
            }
    }
}

/* Raw chunks: of no samples when the part is deep, of bytes that decode to nothing when it is not. */
static void write_raw_chunks(exr_context_t context, int part, const variant *v)
{
    static const char zeros[256];
    int32_t lines = 1;
    assert_int_equal(exr_get_scanlines_per_chunk(context, part, &lines), EXR_ERR_SUCCESS);
    for (int y = v->top; y < v->top + v->h; y += lines) {
        const exr_result_t code =
            v->storage == EXR_STORAGE_DEEP_SCANLINE
                ? exr_write_deep_scanline_chunk(context, part, y, zeros, 0, 0, zeros, (uint64_t)v->w * 4)
                : exr_write_scanline_chunk(context, part, y, zeros, sizeof zeros);
        assert_int_equal(code, EXR_ERR_SUCCESS);
    }
}

static void write_variant(const char *path, const variant *v)
{
    exr_context_t context = NULL;
    assert_int_equal(exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, NULL), EXR_ERR_SUCCESS);
    for (int part = 0; part < v->n_parts; part++) write_part_header(context, part, v);
    assert_int_equal(exr_write_header(context), EXR_ERR_SUCCESS);
    for (int part = 0; part < v->n_parts; part++) {
        const bool raw = v->storage == EXR_STORAGE_DEEP_SCANLINE || v->compression == EXR_COMPRESSION_DWAA;
        if (raw) write_raw_chunks(context, part, v);
        else if (v->storage == EXR_STORAGE_TILED) write_tiles(context, part, v);
        else write_scanlines(context, part, v);
    }
    assert_int_equal(exr_finish(&context), EXR_ERR_SUCCESS);
}

static void assert_variant_reads(const char *path, const variant *v)
{
    ssfr_field *all = NULL, *one = NULL;
    assert_int_equal(ssfr_exr_load(path, "C,A,B", &all), SSFR_OK);
    assert_int_equal(ssfr_exr_load(path, "A", &one), SSFR_OK);
    assert_int_equal(all->w, v->w);
    assert_int_equal(all->h, v->h);
    for (int y = 0; y < v->h; y++)
        for (int x = 0; x < v->w; x++) {
            const double *pixel = ssfr_field_at(all, x, y);
            const bool good = pixel[0] == uint_at(x, y) && pixel[1] == (double)half_at(x, y) &&
                              pixel[2] == (double)float_at(x, y) && *ssfr_field_at(one, x, y) == pixel[1];
            if (!good) print_error("storage %d compression %d pixel %d %d\n", v->storage, v->compression, x, y);
            assert_true(good);
        }
    ssfr_field_destroy(&one);
    ssfr_field_destroy(&all);
}

static const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE,   EXR_COMPRESSION_ZIPS,
                                                 EXR_COMPRESSION_ZIP,  EXR_COMPRESSION_PIZ,   EXR_COMPRESSION_PXR24,
                                                 EXR_COMPRESSION_B44,  EXR_COMPRESSION_B44A};

static void every_compression_of_scanlines_is_read(void **state)
{
    (void)state;
    const char *path = test_path("scanlines.exr");
    for (size_t i = 0; i < SSFR_COUNT(compressions); i++) {
        const variant v = {.storage = EXR_STORAGE_SCANLINE, .compression = compressions[i], .left = -5, .top = 17,
                           .w = 45, .h = 39, .sampling = 1, .n_parts = 1};
        write_variant(path, &v);
        assert_variant_reads(path, &v);
    }
}

static void every_compression_of_tiles_is_read(void **state)
{
    (void)state;
    const char *path = test_path("tiles.exr");
    for (size_t i = 0; i < SSFR_COUNT(compressions); i++) {
        const variant v = {.storage = EXR_STORAGE_TILED, .compression = compressions[i], .left = 3, .top = -1000,
                           .w = 45, .h = 39, .tile_w = 16, .tile_h = 12, .sampling = 1, .n_parts = 1};
        write_variant(path, &v);
        assert_variant_reads(path, &v);
    }
}

static void a_tile_may_be_larger_than_the_image(void **state)
{
    (void)state;
    const char *path = test_path("large_tile.exr");
    const variant v = {.storage = EXR_STORAGE_TILED, .compression = EXR_COMPRESSION_ZIP, .w = 5, .h = 9, .tile_w = 64,
                       .tile_h = 32, .sampling = 1, .n_parts = 1};
    write_variant(path, &v);
    assert_variant_reads(path, &v);
}

static void the_first_level_of_a_mipmap_is_read(void **state)
{
    (void)state;
    const char *path = test_path("mipmap.exr");
    const variant v = {.storage = EXR_STORAGE_TILED, .compression = EXR_COMPRESSION_ZIP, .w = 45, .h = 39, .tile_w = 16,
                       .tile_h = 16, .sampling = 1, .levels = EXR_TILE_MIPMAP_LEVELS, .n_parts = 1};
    write_variant(path, &v);
    assert_variant_reads(path, &v);
}

static void what_is_not_read_is_said(void **state)
{
    (void)state;
    const char *path = test_path("unsupported.exr");
    ssfr_field *field = NULL;
    int major = 0, minor = 0;
    variant v = {.storage = EXR_STORAGE_SCANLINE, .compression = EXR_COMPRESSION_ZIP, .w = 20, .h = 18, .tile_w = 16,
                 .tile_h = 16, .sampling = 1, .n_parts = 2};
    write_variant(path, &v);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_exr_load(path, "A", &field), "2 parts, only single-part files are read");
    v.n_parts = 1, v.sampling = 2;
    write_variant(path, &v);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_exr_load(path, "B", &field), "channel B is subsampled 2 x 2");
    v.sampling = 1, v.compression = EXR_COMPRESSION_DWAA;
    exr_get_library_version(&major, &minor, NULL, NULL);
    write_variant(path, &v);
    if (major == 3 && minor == 1) /* later libraries decode it */
        assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_exr_load(path, "B", &field), "not yet implemented");
    v.storage = EXR_STORAGE_DEEP_SCANLINE, v.compression = EXR_COMPRESSION_NONE;
    write_variant(path, &v);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_exr_load(path, "B", &field), "deep data, only flat images are read");
    assert_null(field);
}

/* The chunks are such as a flat image makes; that they decode to nothing is found later than their length. */
static void a_flat_image_in_dwa_may_be_much_larger_than_its_file(void **state)
{
    (void)state;
    const char *path = test_path("dwa.exr");
    ssfr_field *field = NULL;
    const variant v = {.storage = EXR_STORAGE_SCANLINE, .compression = EXR_COMPRESSION_DWAA, .w = 3000, .h = 2000,
                       .sampling = 1, .n_parts = 1};
    write_variant(path, &v);
    test_clear_log();
    assert_int_not_equal(ssfr_exr_load(path, "B", &field), SSFR_OK);
    assert_null(strstr(test_last_error(), "cannot hold"));
    assert_null(field);
}

/* ---- bad requests and bad files --------------------------------------------------------------------------------- */

static void what_is_missing_is_named(void **state)
{
    (void)state;
    const char *path = test_path("missing.exr");
    const ssfr_attribute attribute = {"scene", "ddb_mid", 0};
    ssfr_field *rgb = make_field(7, 5, 3, 1), *field = NULL;
    const ssfr_layer layer = {"R,G,B", rgb};
    double value = 2.385;
    assert_int_equal(ssfr_exr_save(path, 1, &layer, 1, &attribute), SSFR_OK);
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_exr_load(path, "R,Z", &field), "no channel Z, the file has B, G, R");
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_load(path, "R,R", &field), "channel R is named twice");
    assert_fails(SSFR_ERR_VALUE, ssfr_exr_load(path, "R,", &field), "\"R,\" has an empty name");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_exr_number(path, "dt", &value), "no attribute \"dt\"");
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_exr_number(path, "scene", &value), "\"scene\" is a string, not a number");
    assert_null(field);
    assert_true(value == 2.385);
    ssfr_field_destroy(&rgb);
}

static void what_is_no_file_is_refused(void **state)
{
    (void)state;
    const char *path = test_path("no.exr"), *text = test_path("text.exr"), *empty = test_path("empty.exr");
    ssfr_field *field = NULL;
    char *names = NULL;
    double value = 0;
    test_write_file(text, "ply\nformat ascii 1.0\n", 21);
    test_write_file(empty, "", 0);
    assert_fails(SSFR_ERR_IO, ssfr_exr_load(path, "R", &field), "no.exr: No such file");
    assert_fails(SSFR_ERR_IO, ssfr_exr_load("/tmp", "R", &field), "/tmp: not a regular file");
    assert_fails(SSFR_ERR_IO, ssfr_exr_channels(path, &names), "no.exr: No such file");
    assert_fails(SSFR_ERR_IO, ssfr_exr_number(path, "dt", &value), "no.exr: No such file");
    assert_fails(SSFR_ERR_FORMAT, ssfr_exr_load(text, "R", &field), "text.exr: ");
    assert_fails(SSFR_ERR_FORMAT, ssfr_exr_channels(text, &names), "text.exr: ");
    assert_fails(SSFR_ERR_FORMAT, ssfr_exr_load(empty, "R", &field), "empty.exr: ");
    assert_null(field);
    assert_null(names);
}

/* Finds the data window's four numbers in a header. */
static unsigned char *find_window(char *data, size_t size)
{
    static const char mark[] = "dataWindow\0box2i\0\x10\0\0";
    unsigned char *found = NULL;
    for (size_t i = 0; i + sizeof mark + 16 < size && !found; i++)
        if (memcmp(data + i, mark, sizeof mark) == 0) found = (unsigned char *)data + i + sizeof mark;
    assert_non_null(found);
    return found;
}

static void declared_sizes_are_not_believed(void **state)
{
    (void)state;
    const char *path = test_path("declared.exr");
    static const struct {
        int32_t right, bottom;
        ssfr_result code;
        const char *text;
    } cases[] = {{16383, 16383, SSFR_ERR_FORMAT, "cannot hold 16384 x 16384 pixels"},
                 {16384, 4, SSFR_ERR_VALUE, "16385 x 5 pixels: sides go from 1 to 16384"},
                 {2147483646, 2147483646, SSFR_ERR_FORMAT, "2147483646"},
                 {6, 30000, SSFR_ERR_VALUE, "7 x 30001 pixels"},
                 {-1, 4, SSFR_ERR_FORMAT, ""},
                 {6, 15, SSFR_ERR_FORMAT, ""}};
    ssfr_field *field = make_field(7, 5, 1, 1), *back = NULL;
    char *data = NULL;
    size_t size = 0;
    save_one(path, "Z", field);
    assert_int_equal(ssfr_read_file(path, 1 << 20, &data, &size), SSFR_OK);
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        memcpy(find_window(data, size) + 8, &cases[i].right, 4);
        memcpy(find_window(data, size) + 12, &cases[i].bottom, 4);
        test_write_file(path, data, size);
        assert_fails(cases[i].code, ssfr_exr_load(path, "Z", &back), cases[i].text);
        assert_null(back);
    }
    free(data);
    ssfr_field_destroy(&field);
}

/* Loads a damaged file: one error line, or a result of the right size. */
static void assert_survives(const char *path, const char *channels, const void *data, size_t size)
{
    ssfr_field *field = NULL;
    test_write_file(path, data, size);
    test_clear_log();
    const ssfr_result result = ssfr_exr_load(path, channels, &field);
    assert_int_equal(test_n_errors(), result == SSFR_OK ? 0 : 1);
    assert_int_equal(field != NULL, result == SSFR_OK);
    ssfr_field_destroy(&field);
}

static void a_file_cut_at_any_byte_is_refused(void **state)
{
    (void)state;
    const char *whole = test_path("whole.exr"), *cut = test_path("cut.exr");
    ssfr_field *field = make_field(23, 37, 3, 8), *back = NULL;
    char *data = NULL;
    size_t size = 0;
    save_one(whole, "R,G,B", field);
    assert_int_equal(ssfr_read_file(whole, 1 << 20, &data, &size), SSFR_OK);
    for (size_t n = 0; n < size; n++) {
        test_write_file(cut, data, n);
        assert_fails(SSFR_ERR_FORMAT, ssfr_exr_load(cut, "R,G,B", &back), cut);
        assert_null(back);
    }
    free(data);
    ssfr_field_destroy(&field);
}

static void a_byte_changed_anywhere_does_no_harm(void **state)
{
    (void)state;
    const char *whole = test_path("whole2.exr"), *changed = test_path("changed.exr");
    static const char masks[] = {1, 0x40, (char)0x80, (char)0xff};
    ssfr_field *field = make_field(11, 19, 3, 9);
    char *data = NULL;
    size_t size = 0;
    save_one(whole, "R,G,B", field);
    assert_int_equal(ssfr_read_file(whole, 1 << 20, &data, &size), SSFR_OK);
    for (size_t i = 0; i < size; i++)
        for (size_t k = 0; k < SSFR_COUNT(masks); k++) {
            data[i] = (char)(data[i] ^ masks[k]);
            assert_survives(changed, "R,G,B", data, size);
            data[i] = (char)(data[i] ^ masks[k]);
        }
    free(data);
    ssfr_field_destroy(&field);
}

/* Seeded damage to files of every layout; the seed makes a failure repeatable. */
static void damaged_files_of_other_programs_do_no_harm(void **state)
{
    (void)state;
    const char *whole = test_path("layout.exr"), *changed = test_path("changed2.exr");
    uint64_t seed = 17;
    for (size_t i = 0; i < 2 * SSFR_COUNT(compressions); i++) {
        const variant v = {.storage = i % 2 ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE,
                           .compression = compressions[i / 2], .w = 45, .h = 39, .tile_w = 16, .tile_h = 12,
                           .sampling = 1, .n_parts = 1};
        char *data = NULL;
        size_t size = 0;
        write_variant(whole, &v);
        assert_int_equal(ssfr_read_file(whole, 1 << 20, &data, &size), SSFR_OK);
        for (int trial = 0; trial < 150; trial++) {
            const size_t at = (size_t)test_random(&seed, 0, (double)size);
            const char old = data[at];
            data[at] = (char)test_random(&seed, -128, 128);
            assert_survives(changed, "B,C,A", data, size);
            data[at] = old;
            assert_survives(changed, "B,C,A", data, at);
        }
        free(data);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(round_trip_is_bit_exact_in_float),
        cmocka_unit_test(extreme_values_survive),
        cmocka_unit_test(doubles_are_rounded_to_the_nearest_float),
        cmocka_unit_test(channels_are_sorted_and_read_back_in_any_order),
        cmocka_unit_test(a_file_of_forty_channels_is_written_and_read),
        cmocka_unit_test(attributes_are_kept_exactly),
        cmocka_unit_test(strings_are_written_as_string_attributes),
        cmocka_unit_test(two_saves_give_the_same_bytes),
        cmocka_unit_test(a_large_constant_image_is_small_and_read),
        cmocka_unit_test(saving_refuses_layers_that_do_not_fit),
        cmocka_unit_test(saving_where_nothing_can_be_written_fails),
        cmocka_unit_test(a_failed_save_keeps_the_old_file),
        cmocka_unit_test(every_compression_of_scanlines_is_read),
        cmocka_unit_test(every_compression_of_tiles_is_read),
        cmocka_unit_test(a_tile_may_be_larger_than_the_image),
        cmocka_unit_test(the_first_level_of_a_mipmap_is_read),
        cmocka_unit_test(what_is_not_read_is_said),
        cmocka_unit_test(a_flat_image_in_dwa_may_be_much_larger_than_its_file),
        cmocka_unit_test(what_is_missing_is_named),
        cmocka_unit_test(what_is_no_file_is_refused),
        cmocka_unit_test(declared_sizes_are_not_believed),
        cmocka_unit_test(a_file_cut_at_any_byte_is_refused),
        cmocka_unit_test(a_byte_changed_anywhere_does_no_harm),
        cmocka_unit_test(damaged_files_of_other_programs_do_no_harm),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

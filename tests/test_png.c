/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_png.c: PNG files are sRGB to the last level, those of other programs are read, bad ones are refused. */
#include "tests/disk.h"
#include "tests/util.h"

#include "image/srgb.h"

#include <png.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

static ssfr_field *make_field(int w, int h, int c)
{
    ssfr_field *field = NULL;
    uint64_t seed = 17;
    assert_int_equal(ssfr_field_create(&field, w, h, c), SSFR_OK);
    for (int i = 0; i < w * h * c; i++) field->data[i] = test_random(&seed, 0, 1);
    return field;
}

static void save_and_load(const char *path, const ssfr_field *field, ssfr_field **back)
{
    assert_int_equal(ssfr_png_save(path, field), SSFR_OK);
    assert_int_equal(ssfr_png_load(path, back), SSFR_OK);
    assert_int_equal((*back)->w, field->w);
    assert_int_equal((*back)->h, field->h);
    assert_int_equal((*back)->c, 3);
}

/* ---- what ssfr writes ------------------------------------------------------------------------------------------- */

static void the_transfer_function_is_that_of_the_standard(void **state)
{
    (void)state;
    assert_close(ssfr_srgb_encode(0.18), 0.46135612950044164, 1e-15, 0);
    assert_close(ssfr_srgb_encode(0.5), 0.7353569830524495, 1e-15, 0);
    assert_close(ssfr_srgb_decode(0.5), 0.21404114048223255, 1e-15, 0);
    assert_close(ssfr_srgb_encode(0.002385), 0.0308142, 1e-15, 0);
    assert_true(ssfr_srgb_encode(-2.385) == 0);
    assert_close(ssfr_srgb_encode(2.385), 1, 1e-15, 0);
    assert_true(isnan(ssfr_srgb_encode((double)NAN)));
    for (int i = 0; i <= 1000; i++) assert_close(ssfr_srgb_encode(ssfr_srgb_decode(i / 1000.0)), i / 1000.0, 2e-8, 0);
}

static void all_levels_come_back_exactly(void **state)
{
    (void)state;
    const char *path = test_path("levels.png");
    for (int c = 1; c <= 3; c += 2) {
        ssfr_field *field = NULL, *back = NULL;
        assert_int_equal(ssfr_field_create(&field, 16, 16, c), SSFR_OK);
        for (int i = 0; i < 256; i++)
            for (int k = 0; k < c; k++) field->data[i * c + k] = ssfr_srgb_decode(((i + 85 * k) % 256) / 255.0);
        save_and_load(path, field, &back);
        for (int i = 0; i < 256; i++)
            for (int k = 0; k < 3; k++) assert_true(back->data[i * 3 + k] == field->data[i * c + (c == 3 ? k : 0)]);
        ssfr_field_destroy(&back);
        ssfr_field_destroy(&field);
    }
}

static void levels_are_rounded_to_the_nearest(void **state)
{
    (void)state;
    const char *path = test_path("rounded.png");
    ssfr_field *field = NULL, *back = NULL;
    assert_int_equal(ssfr_field_create(&field, 255, 2, 1), SSFR_OK);
    for (int i = 0; i < 255; i++) {
        *ssfr_field_at(field, i, 0) = ssfr_srgb_decode((i + 0.499) / 255);
        *ssfr_field_at(field, i, 1) = ssfr_srgb_decode((i + 0.501) / 255);
    }
    save_and_load(path, field, &back);
    for (int i = 0; i < 255; i++) {
        assert_true(*ssfr_field_at(back, i, 0) == ssfr_srgb_decode(i / 255.0));
        assert_true(*ssfr_field_at(back, i, 1) == ssfr_srgb_decode((i + 1) / 255.0));
    }
    ssfr_field_destroy(&back);
    ssfr_field_destroy(&field);
}

static void rows_and_channels_keep_their_places(void **state)
{
    (void)state;
    static const int sizes[][2] = {{1, 1}, {1, 33}, {57, 1}, {61, 43}};
    const char *path = test_path("places.png");
    for (size_t i = 0; i < SSFR_COUNT(sizes); i++) {
        ssfr_field *field = make_field(sizes[i][0], sizes[i][1], 3), *back = NULL;
        save_and_load(path, field, &back);
        for (int k = 0; k < field->w * field->h * 3; k++)
            assert_close(ssfr_srgb_encode(back->data[k]), ssfr_srgb_encode(field->data[k]), 0.5001 / 255, 0);
        ssfr_field_destroy(&back);
        ssfr_field_destroy(&field);
    }
}

static int n_warnings;
static char warning[256];

static void keep_warning(void *user, ssfr_level level, const char *where, const char *text)
{
    (void)user, (void)where;
    n_warnings += level == SSFR_WARNING ? 1 : 0;
    snprintf(warning, sizeof warning, "%s", text);
}

static void values_outside_are_clamped_and_those_not_finite_counted(void **state)
{
    const double values[] = {-2.385, 2.385, (double)NAN, INFINITY, -INFINITY, (double)NAN};
    const double expected[] = {0, 1, 0, 1, 0, 0};
    const char *path = test_path("clamped.png");
    ssfr_field *field = NULL, *back = NULL;
    assert_int_equal(ssfr_field_create(&field, 3, 2, 1), SSFR_OK);
    memcpy(field->data, values, sizeof values);
    n_warnings = 0;
    ssfr_log_to(keep_warning, NULL);
    save_and_load(path, field, &back);
    test_capture_log(state);
    assert_int_equal(n_warnings, 1);
    assert_non_null(strstr(warning, "clamped.png: 4 values are not finite"));
    for (int i = 0; i < 6; i++) assert_true(back->data[3 * i] == expected[i]);
    ssfr_field_destroy(&back);
    ssfr_field_destroy(&field);
}

/* ---- what other programs write ---------------------------------------------------------------------------------- */

typedef struct kind {
    int type, bits;
    bool interlaced, transparent; /* transparent: a tRNS chunk */
    double gamma;                 /* of a gAMA chunk, 0 for none */
} kind;

enum { W = 37, H = 21 };

/* Sample k of a pixel, of the kind's bits. */
static unsigned sample_at(const kind *f, int x, int y, int k)
{
    return (unsigned)(x * 2385 + y * 77 + k * 40503) & ((1u << f->bits) - 1);
}

static int n_samples(const kind *f)
{
    static const int counts[] = {[PNG_COLOR_TYPE_GRAY] = 1, [PNG_COLOR_TYPE_GRAY_ALPHA] = 2, [PNG_COLOR_TYPE_RGB] = 3,
                                 [PNG_COLOR_TYPE_RGB_ALPHA] = 4, [PNG_COLOR_TYPE_PALETTE] = 1};
    return counts[f->type];
}

static png_color palette_at(unsigned i)
{
    return (png_color){(png_byte)(i * 7), (png_byte)(255 - i * 5), (png_byte)(i * i)};
}

static void fill_row(const kind *f, int y, png_byte *row)
{
    const int n = n_samples(f);
    for (int i = 0; i < W * n; i++) {
        const unsigned v = sample_at(f, i / n, y, i % n);
        if (f->bits == 16) {
            row[2 * i] = (png_byte)(v >> 8), row[2 * i + 1] = (png_byte)v;
        } else {
            const int bit = i * f->bits;
            row[bit / 8] = (png_byte)(row[bit / 8] | v << (8 - f->bits - bit % 8));
        }
    }
}

static void set_extras(png_structp png, png_infop info, const kind *f)
{
    png_color palette[256];
    png_byte alphas[2] = {0, 128};
    png_color_16 key = {.gray = 1, .red = 1, .green = 1, .blue = 1};
    const int n_colours = 1 << f->bits;
    for (int i = 0; i < 256; i++) palette[i] = palette_at((unsigned)i);
    if (f->type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, n_colours < 256 ? n_colours : 256);
    if (f->transparent) png_set_tRNS(png, info, alphas, 2, f->type == PNG_COLOR_TYPE_PALETTE ? NULL : &key);
    if (f->gamma > 0) png_set_gAMA(png, info, f->gamma);
}

static void write_png(const char *path, const kind *f)
{
    static png_byte pixels[H][W * 8];
    png_bytep rows[H];
    FILE *file = fopen(path, "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    assert_non_null(file);
    memset(pixels, 0, sizeof pixels);
    for (int y = 0; y < H; y++) {
        rows[y] = pixels[y];
        fill_row(f, y, rows[y]);
    }
    png_init_io(png, file);
    png_set_IHDR(png, info, W, H, f->bits, f->type, f->interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    set_extras(png, info, f);
    png_write_info(png, info);
    png_write_image(png, rows);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    assert_int_equal(fclose(file), 0);
}

static double expected_at(const kind *f, int x, int y, int k)
{
    const png_color colour = palette_at(sample_at(f, x, y, 0));
    const int bytes[] = {colour.red, colour.green, colour.blue};
    const bool gray = f->type == PNG_COLOR_TYPE_GRAY || f->type == PNG_COLOR_TYPE_GRAY_ALPHA;
    const double sample = sample_at(f, x, y, gray ? 0 : k) / (double)((1u << f->bits) - 1);
    const double v = f->type == PNG_COLOR_TYPE_PALETTE ? bytes[k] / 255.0 : sample;
    return f->gamma > 0 ? pow(v, 1 / f->gamma) : ssfr_srgb_decode(v);
}

static void assert_kind_reads(const char *path, const kind *f)
{
    ssfr_field *field = NULL;
    write_png(path, f);
    assert_int_equal(ssfr_png_load(path, &field), SSFR_OK);
    assert_int_equal(field->w, W);
    assert_int_equal(field->h, H);
    assert_int_equal(field->c, 3);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            for (int k = 0; k < 3; k++) {
                const double expected = expected_at(f, x, y, k);
                if (fabs(ssfr_field_at(field, x, y)[k] - expected) > 1e-15)
                    print_error("type %d bits %d pixel %d %d channel %d\n", f->type, f->bits, x, y, k);
                assert_close(ssfr_field_at(field, x, y)[k], expected, 1e-15, 0);
            }
    ssfr_field_destroy(&field);
}

static const kind kinds[] = {
    {.type = PNG_COLOR_TYPE_GRAY, .bits = 1},        {.type = PNG_COLOR_TYPE_GRAY, .bits = 2},
    {.type = PNG_COLOR_TYPE_GRAY, .bits = 4},        {.type = PNG_COLOR_TYPE_GRAY, .bits = 8},
    {.type = PNG_COLOR_TYPE_GRAY, .bits = 16},       {.type = PNG_COLOR_TYPE_GRAY_ALPHA, .bits = 8},
    {.type = PNG_COLOR_TYPE_GRAY_ALPHA, .bits = 16}, {.type = PNG_COLOR_TYPE_RGB, .bits = 8},
    {.type = PNG_COLOR_TYPE_RGB, .bits = 16},        {.type = PNG_COLOR_TYPE_RGB_ALPHA, .bits = 8},
    {.type = PNG_COLOR_TYPE_RGB_ALPHA, .bits = 16},  {.type = PNG_COLOR_TYPE_PALETTE, .bits = 1},
    {.type = PNG_COLOR_TYPE_PALETTE, .bits = 4},     {.type = PNG_COLOR_TYPE_PALETTE, .bits = 8},
};

static void every_kind_of_png_is_read(void **state)
{
    (void)state;
    const char *path = test_path("kind.png");
    for (size_t i = 0; i < SSFR_COUNT(kinds); i++) {
        kind f = kinds[i];
        assert_kind_reads(path, &f);
        f.interlaced = true;
        assert_kind_reads(path, &f);
        f.transparent = !(f.type & PNG_COLOR_MASK_ALPHA);
        assert_kind_reads(path, &f);
    }
}

static void a_gamma_chunk_replaces_the_curve_unless_it_says_the_same(void **state)
{
    (void)state;
    const char *path = test_path("gamma.png");
    const kind linear = {.type = PNG_COLOR_TYPE_RGB, .bits = 16, .gamma = 1},
               mac = {.type = PNG_COLOR_TYPE_GRAY, .bits = 8, .gamma = 1 / 1.8};
    kind same = {.type = PNG_COLOR_TYPE_RGB, .bits = 8, .gamma = 0.45455};
    ssfr_field *field = NULL;
    assert_kind_reads(path, &linear);
    write_png(path, &mac); /* the chunk holds five digits of the exponent */
    assert_int_equal(ssfr_png_load(path, &field), SSFR_OK);
    for (int x = 0; x < W; x++) assert_close(*ssfr_field_at(field, x, 3), expected_at(&mac, x, 3, 0), 1e-5, 0);
    ssfr_field_destroy(&field);
    write_png(path, &same);
    same.gamma = 0; /* what is expected: the curve */
    assert_int_equal(ssfr_png_load(path, &field), SSFR_OK);
    for (int x = 0; x < W; x++) assert_close(*ssfr_field_at(field, x, 3), expected_at(&same, x, 3, 0), 1e-15, 0);
    ssfr_field_destroy(&field);
}

/* ---- what fails ------------------------------------------------------------------------------------------------- */

static void saving_where_nothing_can_be_written_fails(void **state)
{
    (void)state;
    char inside[256];
    const char *file = test_path("a_file"), *folder = test_path("a_folder");
    ssfr_field *field = make_field(7, 5, 3), *two = make_field(7, 5, 2);
    test_write_file(file, "x", 1);
    snprintf(inside, sizeof inside, "%s/c.png", file);
    assert_fails(SSFR_ERR_VALUE, ssfr_png_save(file, two), "2 channels, a PNG is written from 1 or 3");
    assert_fails(SSFR_ERR_IO, ssfr_png_save(inside, field), inside);
    assert_fails(SSFR_ERR_IO, ssfr_png_save("/nowhere/c.png", field), "/nowhere/c.png: No such file");
    assert_fails(SSFR_ERR_IO, ssfr_png_save("/proc/c.png", field), "/proc/c.png: ");
    assert_int_equal(mkdir(folder, 0755), 0);
    assert_fails(SSFR_ERR_IO, ssfr_png_save(folder, field), folder);
    assert_int_equal(rmdir(folder), 0);
    assert_int_equal(test_count_files(file, ".part"), 0);
    ssfr_field_destroy(&two);
    ssfr_field_destroy(&field);
}

static void a_failed_save_keeps_the_old_file(void **state)
{
    (void)state;
    const char *path = test_path("kept.png");
    ssfr_field *old = make_field(7, 5, 3), *large = make_field(200, 150, 3), *small = make_field(3, 2, 3), *back = NULL;
    static const size_t limits[] = {0, 50, 60000};
    assert_int_equal(ssfr_png_save(path, old), SSFR_OK);
    for (size_t i = 0; i < SSFR_COUNT(limits); i++)
        for (int k = 0; k < 2 && !(k == 1 && limits[i] > 50); k++) { /* the small one fails when the file is closed */
            test_limit_file_size(limits[i]);
            test_clear_log();
            const ssfr_result result = ssfr_png_save(path, k ? small : large);
            test_limit_file_size(SIZE_MAX);
            assert_int_equal(result, SSFR_ERR_IO);
            test_assert_logged("kept.png: File too large", __FILE__, __LINE__);
            assert_int_equal(ssfr_png_load(path, &back), SSFR_OK);
            assert_int_equal(back->w, 7);
            assert_int_equal(test_count_files(path, ".part"), 0);
            ssfr_field_destroy(&back);
        }
    ssfr_field_destroy(&small);
    ssfr_field_destroy(&large);
    ssfr_field_destroy(&old);
}

static void what_is_no_png_is_refused(void **state)
{
    (void)state;
    const char *text = test_path("text.png"), *empty = test_path("empty.png");
    ssfr_field *field = NULL;
    test_write_file(text, "ply\nformat ascii 1.0\n", 21);
    test_write_file(empty, "", 0);
    assert_fails(SSFR_ERR_IO, ssfr_png_load(test_path("no.png"), &field), "no.png: No such file");
    assert_fails(SSFR_ERR_IO, ssfr_png_load("/tmp", &field), "/tmp: not a regular file");
    assert_fails(SSFR_ERR_FORMAT, ssfr_png_load(text, &field), "text.png: Not a PNG file");
    assert_fails(SSFR_ERR_FORMAT, ssfr_png_load(empty, &field), "empty.png: the file ends too early");
    assert_null(field);
}

static void put_big_endian(unsigned char *at, uint32_t value)
{
    for (int i = 0; i < 4; i++) at[i] = (unsigned char)(value >> (24 - 8 * i));
}

static void declared_sizes_are_not_believed(void **state)
{
    (void)state;
    const char *path = test_path("declared.png");
    static const struct {
        uint32_t w, h;
        ssfr_result code;
        const char *text;
    } cases[] = {{16384, 16384, SSFR_ERR_FORMAT, "cannot hold 16384 x 16384 pixels"},
                 {16385, 5, SSFR_ERR_VALUE, "16385 x 5 pixels: sides go from 1 to 16384"},
                 {7, 2000000000, SSFR_ERR_VALUE, "7 x 2000000000 pixels"},
                 {7, 50, SSFR_ERR_FORMAT, "declared.png: "},
                 {0, 5, SSFR_ERR_FORMAT, "declared.png: "}};
    ssfr_field *field = make_field(7, 5, 3), *back = NULL;
    char *data = NULL;
    size_t size = 0;
    assert_int_equal(ssfr_png_save(path, field), SSFR_OK);
    assert_int_equal(ssfr_read_file(path, 1 << 20, &data, &size), SSFR_OK);
    unsigned char *header = (unsigned char *)data + 8 + 4; /* after the signature and the chunk's length */
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        put_big_endian(header + 4, cases[i].w);
        put_big_endian(header + 8, cases[i].h);
        put_big_endian(header + 17, (uint32_t)crc32(0, header, 17));
        test_write_file(path, data, size);
        assert_fails(cases[i].code, ssfr_png_load(path, &back), cases[i].text);
        assert_null(back);
    }
    free(data);
    ssfr_field_destroy(&field);
}

/* The bytes of a valid file, to free(). */
static char *make_bytes(const kind *f, size_t *size)
{
    const char *path = test_path("whole.png");
    char *data = NULL;
    write_png(path, f);
    assert_int_equal(ssfr_read_file(path, 1 << 20, &data, size), SSFR_OK);
    return data;
}

static void a_file_cut_at_any_byte_is_refused(void **state)
{
    (void)state;
    const char *cut = test_path("cut.png");
    for (size_t i = 0; i < SSFR_COUNT(kinds); i += 4) {
        ssfr_field *back = NULL;
        size_t size = 0;
        char *data = make_bytes(&kinds[i], &size);
        for (size_t n = 0; n < size; n++) {
            test_write_file(cut, data, n);
            assert_fails(SSFR_ERR_FORMAT, ssfr_png_load(cut, &back), "cut.png: ");
            assert_null(back);
        }
        free(data);
    }
}

static void a_byte_changed_anywhere_does_no_harm(void **state)
{
    (void)state;
    const char *changed = test_path("changed.png");
    for (size_t i = 0; i < SSFR_COUNT(kinds); i += 4) {
        ssfr_field *back = NULL;
        size_t size = 0;
        char *data = make_bytes(&kinds[i], &size);
        for (size_t n = 0; n < size; n++) {
            data[n] = (char)(data[n] ^ 0x55);
            test_write_file(changed, data, size);
            data[n] = (char)(data[n] ^ 0x55);
            test_clear_log();
            const ssfr_result result = ssfr_png_load(changed, &back);
            assert_int_equal(test_n_errors(), result == SSFR_OK ? 0 : 1);
            assert_int_equal(back != NULL, result == SSFR_OK);
            ssfr_field_destroy(&back);
        }
        free(data);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_transfer_function_is_that_of_the_standard),
        cmocka_unit_test(all_levels_come_back_exactly),
        cmocka_unit_test(levels_are_rounded_to_the_nearest),
        cmocka_unit_test(rows_and_channels_keep_their_places),
        cmocka_unit_test(values_outside_are_clamped_and_those_not_finite_counted),
        cmocka_unit_test(every_kind_of_png_is_read),
        cmocka_unit_test(a_gamma_chunk_replaces_the_curve_unless_it_says_the_same),
        cmocka_unit_test(saving_where_nothing_can_be_written_fails),
        cmocka_unit_test(a_failed_save_keeps_the_old_file),
        cmocka_unit_test(what_is_no_png_is_refused),
        cmocka_unit_test(declared_sizes_are_not_believed),
        cmocka_unit_test(a_file_cut_at_any_byte_is_refused),
        cmocka_unit_test(a_byte_changed_anywhere_does_no_harm),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

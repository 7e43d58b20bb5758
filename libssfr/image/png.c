/* SPDX-License-Identifier: MIT */
/* png.c: PNG files: linear fields out as 8-bit sRGB, and any PNG in as three linear channels. */
#include "image/srgb.h"

#include <errno.h>
#include <png.h>

enum { DEFLATE_RATIO = 1032 }; /* bytes that one byte of a deflate stream can at most stand for */

/* What libpng's callbacks and the long jumps out of it need. `data` is the file being read. */
typedef struct codec {
    const char *path;
    png_structp png;
    png_infop info;
    const png_byte *data;
    size_t size, used; /* bytes of data */
    char message[200];
} codec;

static void on_error(png_structp png, png_const_charp text)
{
    codec *c = png_get_error_ptr(png);
    snprintf(c->message, sizeof c->message, "%s", text);
    png_longjmp(png, 1);
}

/* libpng warns of oddities in chunks that do not change the pixels read here. */
static void on_warning(png_structp png, png_const_charp text)
{
    (void)png, (void)text;
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

static void write_bytes(png_structp png, png_bytep data, size_t size)
{
    if (fwrite(data, 1, size, png_get_io_ptr(png)) != size) png_error(png, strerror(errno));
}

/* Closing the file flushes it, and can report what fails then. */
static void flush_nothing(png_structp png)
{
    (void)png;
}

/* Byte of a linear value; NaN and infinities are counted. */
static png_byte quantise(double v, size_t *n_nonfinite)
{
    *n_nonfinite += isfinite(v) ? 0 : 1;
    return isnan(v) ? 0 : (png_byte)lround(255 * ssfr_srgb_encode(v));
}

/* The rows are quantised one by one, as libpng takes them. A jump out of libpng lands here. */
static ssfr_result write_image(codec *c, const ssfr_field *field, FILE *file, png_byte *row, size_t *n_nonfinite)
{
    if (setjmp(png_jmpbuf(c->png))) return ssfr_fail(SSFR_ERR_IO, "%s: %s", c->path, c->message);
    png_set_write_fn(c->png, file, write_bytes, flush_nothing);
    png_set_IHDR(c->png, c->info, (png_uint_32)field->w, (png_uint_32)field->h, 8,
                 field->c == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB_gAMA_and_cHRM(c->png, c->info, PNG_sRGB_INTENT_RELATIVE);
    png_write_info(c->png, c->info);
    for (int y = 0; y < field->h; y++) {
        const double *values = ssfr_field_at(field, 0, y);
        for (int i = 0; i < field->w * field->c; i++) row[i] = quantise(values[i], n_nonfinite);
        png_write_row(c->png, row);
    }
    png_write_end(c->png, NULL);
    return SSFR_OK;
}

static ssfr_result write_file(const char *path, const char *temporary, const ssfr_field *field, size_t *n_nonfinite)
{
    ssfr_result result = SSFR_OK;
    codec c = {.path = path};
    png_byte *row = NULL;
    FILE *file = fopen(temporary, "wb");
    if (!file) {
        result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
        goto end;
    }
    SSFR_TRY(ssfr_alloc(&row, (size_t)field->w * (size_t)field->c, 1, "a row of pixels"));
    c.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &c, on_error, on_warning);
    c.info = c.png ? png_create_info_struct(c.png) : NULL;
    if (!c.info) {
        result = ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for libpng", path);
        goto end;
    }
    SSFR_TRY(write_image(&c, field, file, row, n_nonfinite));
end:
    png_destroy_write_struct(&c.png, &c.info);
    free(row);
    if (file && fclose(file) != 0 && result == SSFR_OK)
        result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
    return result;
}

ssfr_result ssfr_png_save(const char *path, const ssfr_field *field)
{
    ssfr_result result = SSFR_OK;
    ssfr_aside aside = {0};
    size_t n_nonfinite = 0;
    if (field->c != 1 && field->c != 3) {
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: %d channels, a PNG is written from 1 or 3", path, field->c);
        goto end;
    }
    SSFR_TRY(ssfr_aside_begin(&aside, path));
    SSFR_TRY(write_file(path, aside.temporary, field, &n_nonfinite));
end:
    result = ssfr_aside_end(&aside, result);
    if (result == SSFR_OK && n_nonfinite)
        ssfr_log(SSFR_WARNING, "%s: %zu values are not finite: NaN is written as 0, infinity clamped", path,
                 n_nonfinite);
    return result;
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

static void read_bytes(png_structp png, png_bytep out, size_t size)
{
    codec *c = png_get_io_ptr(png);
    if (size > c->size - c->used) png_error(png, "the file ends too early");
    memcpy(out, c->data + c->used, size);
    c->used += size;
}

static ssfr_result read_header(codec *c)
{
    if (setjmp(png_jmpbuf(c->png))) return ssfr_fail(SSFR_ERR_FORMAT, "%s: %s", c->path, c->message);
    png_set_read_fn(c->png, c, read_bytes);
    png_set_user_limits(c->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); /* check_size says it in one line */
    png_read_info(c->png, c->info);
    return SSFR_OK;
}

static ssfr_result check_size(const codec *c)
{
    const png_uint_32 w = png_get_image_width(c->png, c->info), h = png_get_image_height(c->png, c->info);
    if (w < 1 || h < 1 || w > SSFR_MAX_SIZE || h > SSFR_MAX_SIZE)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %u x %u pixels: sides go from 1 to %d", c->path, w, h, SSFR_MAX_SIZE);
    if (png_get_rowbytes(c->png, c->info) * h / DEFLATE_RATIO > c->size)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: %zu bytes cannot hold %u x %u pixels", c->path, c->size, w, h);
    return SSFR_OK;
}

/* Asks libpng for three channels of 8 or 16 bits whatever the file holds. */
static ssfr_result read_pixels(codec *c, png_bytep *rows, size_t row_size)
{
    if (setjmp(png_jmpbuf(c->png))) return ssfr_fail(SSFR_ERR_FORMAT, "%s: %s", c->path, c->message);
    png_set_expand(c->png);
    png_set_gray_to_rgb(c->png);
    png_set_strip_alpha(c->png);
    png_set_interlace_handling(c->png);
    png_read_update_info(c->png, c->info);
    if (png_get_rowbytes(c->png, c->info) != row_size) png_error(c->png, "unexpected pixel layout");
    png_read_image(c->png, rows);
    png_read_end(c->png, NULL);
    return SSFR_OK;
}

/* The exponent that a file asks for instead of the sRGB curve, or 0. libpng gives 0.45455 for files marked sRGB. */
static double exponent(const codec *c)
{
    double gamma = 0;
    const bool given = png_get_gAMA(c->png, c->info, &gamma) == PNG_INFO_gAMA;
    return given && gamma > 0 && fabs(gamma - 1 / 2.2) > 0.01 ? 1 / gamma : 0;
}

static void decode_row(const png_byte *row, int n, int bits, double power, double *out)
{
    for (int i = 0; i < n; i++) {
        const double v = bits == 16 ? (row[2 * i] * 256 + row[2 * i + 1]) / 65535.0 : row[i] / 255.0;
        out[i] = power > 0 ? pow(v, power) : ssfr_srgb_decode(v);
    }
}

static ssfr_result read_image(codec *c, ssfr_field **out)
{
    ssfr_result result = SSFR_OK;
    png_byte *pixels = NULL;
    png_bytep *rows = NULL;
    const int w = (int)png_get_image_width(c->png, c->info), h = (int)png_get_image_height(c->png, c->info);
    const int bits = png_get_bit_depth(c->png, c->info) == 16 ? 16 : 8;
    const size_t row_size = (size_t)w * 3 * (size_t)bits / 8;
    SSFR_TRY(ssfr_alloc(&pixels, row_size, (size_t)h, "pixels"));
    SSFR_TRY(ssfr_alloc(&rows, (size_t)h, sizeof *rows, "rows"));
    for (int y = 0; y < h; y++) rows[y] = pixels + (size_t)y * row_size;
    SSFR_TRY(read_pixels(c, rows, row_size));
    SSFR_TRY(ssfr_field_create(out, w, h, 3));
    for (int y = 0; y < h; y++) decode_row(rows[y], 3 * w, bits, exponent(c), ssfr_field_at(*out, 0, y));
end:
    free(rows);
    free(pixels);
    return result;
}

ssfr_result ssfr_png_load(const char *path, ssfr_field **out)
{
    ssfr_result result = SSFR_OK;
    codec c = {.path = path};
    char *data = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_read_file(path, SIZE_MAX - 1, &data, &c.size));
    c.data = (const png_byte *)data;
    c.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &c, on_error, on_warning);
    c.info = c.png ? png_create_info_struct(c.png) : NULL;
    if (!c.info) {
        result = ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for libpng", path);
        goto end;
    }
    SSFR_TRY(read_header(&c));
    SSFR_TRY(check_size(&c));
    SSFR_TRY(read_image(&c, out));
end:
    png_destroy_read_struct(&c.png, &c.info, NULL);
    free(data);
    return result;
}

/* SPDX-License-Identifier: MIT */
/* exr.c: OpenEXR files: named float channels with attributes out, channels of single-part images of any layout in. */
#include "base/base.h"

#include <errno.h>
#include <openexr.h>
#include <sys/stat.h>

enum {
    SHORT_NAME = 31, /* bytes of a name that every reader takes; longer ones set a flag in the header */
    LONG_NAME = 255, /* bytes of a name at most */
    /* Image bytes that one byte of a file can at most stand for, rounded up: deflate reaches 1032, and PXR24 packs
     * floats into three bytes before it; those before DWA stay below. DWA deflates four bytes a block of 64 values. */
    MAX_RATIO = 2048,
    DWA_RATIO = 1 << 17,
};

/* The library says first what is wrong and then what that spoilt. The first line since begin_quietly() is kept here,
 * as its error handler is given nothing of the caller's. */
static _Thread_local char said[256];

static void keep_first(exr_const_context_t context, exr_result_t code, const char *text)
{
    (void)context, (void)code;
    if (!said[0]) snprintf(said, sizeof said, "%.*s", (int)strcspn(text, "\n"), text);
}

static exr_context_initializer_t begin_quietly(void)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    said[0] = '\0';
    init.error_handler_fn = keep_first;
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION; /* a cut file is an error, not a guess */
    return init;
}

/* A read that comes back short means a file that is cut: malformed, not unreadable. */
static ssfr_result fail_exr(const char *path, exr_result_t code)
{
    ssfr_result result = SSFR_ERR_FORMAT;
    switch (code) {
    case EXR_ERR_OUT_OF_MEMORY: result = SSFR_ERR_MEMORY; break;
    case EXR_ERR_FILE_ACCESS:
    case EXR_ERR_WRITE_IO: result = SSFR_ERR_IO; break;
    case EXR_ERR_FEATURE_NOT_IMPLEMENTED: result = SSFR_ERR_UNSUPPORTED; break;
    default: break;
    }
    return ssfr_fail(result, "%s: %s", path, said[0] ? said : exr_get_default_error_message(code));
}

#define EXR_TRY(path, call)                        \
    do {                                           \
        const exr_result_t exr_code = (call);      \
        if (exr_code != EXR_ERR_SUCCESS) {         \
            result = fail_exr((path), exr_code);   \
            goto end;                              \
        }                                          \
    } while (0)

/* ---- lists of channel names ------------------------------------------------------------------------------------- */

typedef struct names {
    char *text; /* the list, its commas replaced by ends */
    const char **at;
    int n;
} names;

static void names_finish(names *list)
{
    free(list->text);
    free(list->at);
    *list = (names){0};
}

static ssfr_result names_init(names *list, const char *path, const char *text)
{
    ssfr_result result = SSFR_OK;
    size_t n = 1;
    *list = (names){0};
    for (const char *c = text; *c; c++) n += *c == ',' ? 1 : 0;
    SSFR_TRY(ssfr_text_print(&list->text, "channel names", "%s", text));
    SSFR_TRY(ssfr_alloc(&list->at, n, sizeof *list->at, "channel names"));
    for (char *at = list->text; at; list->n++) {
        char *comma = strchr(at, ',');
        list->at[list->n] = at;
        if (comma) *comma = '\0';
        if (!at[0]) {
            result = ssfr_fail(SSFR_ERR_VALUE, "%s: channel list \"%s\" has an empty name", path, text);
            goto end;
        }
        at = comma ? comma + 1 : NULL;
    }
end:
    if (result != SSFR_OK) names_finish(list);
    return result;
}

static ssfr_result check_distinct(const char *path, const char *const *at, int n)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            if (strcmp(at[i], at[j]) == 0)
                return ssfr_fail(SSFR_ERR_VALUE, "%s: channel %s is named twice", path, at[i]);
    return SSFR_OK;
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

/* What a file is made of: one name, field and channel within it for each EXR channel. */
typedef struct sheet {
    const char *path; /* for messages */
    int w, h;         /* px */
    int n;            /* channels */
    names *lists;     /* one a layer: owns the names */
    const char **name;
    const ssfr_field **field;
    int *channel;
    int n_attributes;
    const ssfr_attribute *attributes;
} sheet;

static void sheet_finish(sheet *s, int n_layers)
{
    for (int i = 0; s->lists && i < n_layers; i++) names_finish(&s->lists[i]);
    free(s->lists);
    free(s->name);
    free(s->field);
    free(s->channel);
}

static ssfr_result check_layer(const sheet *s, const ssfr_layer *layer, int n_names)
{
    if (layer->field->w != s->w || layer->field->h != s->h)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: layer %s is %d x %d pixels, the first %d x %d", s->path, layer->channels,
                         layer->field->w, layer->field->h, s->w, s->h);
    if (layer->field->c != n_names)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: layer %s names %d channels, its field has %d", s->path, layer->channels,
                         n_names, layer->field->c);
    return SSFR_OK;
}

static ssfr_result sheet_init(sheet *s, int n_layers, const ssfr_layer *layers)
{
    ssfr_result result = SSFR_OK;
    size_t n = 0;
    if (n_layers < 1) return ssfr_fail(SSFR_ERR_VALUE, "%s: no layer to write", s->path);
    s->w = layers[0].field->w, s->h = layers[0].field->h;
    SSFR_TRY(ssfr_alloc(&s->lists, (size_t)n_layers, sizeof *s->lists, "layers"));
    for (int i = 0; i < n_layers; i++) {
        SSFR_TRY(names_init(&s->lists[i], s->path, layers[i].channels));
        SSFR_TRY(check_layer(s, &layers[i], s->lists[i].n));
        n += (size_t)s->lists[i].n;
    }
    SSFR_TRY(ssfr_alloc(&s->name, n, sizeof *s->name, "channels"));
    SSFR_TRY(ssfr_alloc(&s->field, n, sizeof *s->field, "channels"));
    SSFR_TRY(ssfr_alloc(&s->channel, n, sizeof *s->channel, "channels"));
    for (int i = 0; i < n_layers; i++)
        for (int k = 0; k < s->lists[i].n; k++, s->n++) {
            s->name[s->n] = s->lists[i].at[k];
            s->field[s->n] = layers[i].field;
            s->channel[s->n] = k;
        }
    SSFR_TRY(check_distinct(s->path, s->name, s->n));
end:
    return result;
}

static const char *name_at(const sheet *s, int i)
{
    return i < s->n ? s->name[i] : s->attributes[i - s->n].name;
}

/* Allows long names only where one is used, as old readers refuse files that say so. */
static ssfr_result allow_names(const sheet *s, exr_context_t context)
{
    ssfr_result result = SSFR_OK;
    size_t longest = 0;
    for (int i = 0; i < s->n + s->n_attributes; i++) {
        const size_t length = strlen(name_at(s, i));
        if (length > LONG_NAME)
            return ssfr_fail(SSFR_ERR_VALUE, "%s: name of %zu bytes, at most %d are written: %.40s...", s->path, length,
                             LONG_NAME, name_at(s, i));
        if (length > longest) longest = length;
    }
    if (longest > SHORT_NAME) EXR_TRY(s->path, exr_set_longname_support(context, 1));
end:
    return result;
}

static ssfr_result write_attribute(const sheet *s, exr_context_t context, const ssfr_attribute *attribute)
{
    const exr_result_t code = attribute->text
                                  ? exr_attr_set_string(context, 0, attribute->name, attribute->text)
                                  : exr_attr_set_double(context, 0, attribute->name, attribute->number);
    if (code == EXR_ERR_SUCCESS) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_VALUE, "%s: attribute \"%s\": %s", s->path, attribute->name,
                     said[0] ? said : exr_get_default_error_message(code));
}

static ssfr_result write_header(const sheet *s, exr_context_t context)
{
    ssfr_result result = SSFR_OK;
    int part = 0;
    SSFR_TRY(allow_names(s, context));
    EXR_TRY(s->path, exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part));
    EXR_TRY(s->path, exr_initialize_required_attr_simple(context, part, s->w, s->h, EXR_COMPRESSION_ZIP));
    for (int i = 0; i < s->n; i++)
        EXR_TRY(s->path,
                exr_add_channel(context, part, s->name[i], EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    for (int i = 0; i < s->n_attributes; i++) SSFR_TRY(write_attribute(s, context, &s->attributes[i]));
    EXR_TRY(s->path, exr_write_header(context));
end:
    return result;
}

/* Points the encoder's channels, which are in the file's order, at planes of w x lines floats in `planes`. */
static void fill_chunk(const sheet *s, exr_encode_pipeline_t *encoder, int y, float *planes)
{
    const size_t plane_size = (size_t)s->w * (size_t)encoder->chunk.height;
    for (int k = 0; k < encoder->channel_count; k++) {
        exr_coding_channel_info_t *channel = &encoder->channels[k];
        float *plane = planes + (size_t)k * plane_size;
        int from = 0;
        while (strcmp(s->name[from], channel->channel_name) != 0) from++;
        for (size_t i = 0; i < plane_size; i++) {
            const int px = (int)(i % (size_t)s->w), line = (int)(i / (size_t)s->w);
            plane[i] = (float)ssfr_field_at(s->field[from], px, y + line)[s->channel[from]];
        }
        channel->user_pixel_stride = (int32_t)sizeof(float);
        channel->user_line_stride = (int32_t)sizeof(float) * s->w;
        channel->encode_from_ptr = (const uint8_t *)plane;
    }
}

static ssfr_result write_pixels(const sheet *s, exr_context_t context)
{
    ssfr_result result = SSFR_OK;
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_chunk_info_t chunk;
    int32_t lines = 1;
    float *planes = NULL;
    EXR_TRY(s->path, exr_get_scanlines_per_chunk(context, 0, &lines));
    SSFR_TRY(ssfr_alloc(&planes, (size_t)lines * (size_t)s->w * (size_t)s->n, sizeof *planes, "EXR lines"));
    for (int y = 0; y < s->h; y += lines) {
        EXR_TRY(s->path, exr_write_scanline_chunk_info(context, 0, y, &chunk));
        if (y == 0) EXR_TRY(s->path, exr_encoding_initialize(context, 0, &chunk, &encoder));
        else EXR_TRY(s->path, exr_encoding_update(context, 0, &chunk, &encoder));
        fill_chunk(s, &encoder, y, planes);
        if (y == 0) EXR_TRY(s->path, exr_encoding_choose_default_routines(context, 0, &encoder));
        EXR_TRY(s->path, exr_encoding_run(context, 0, &encoder));
    }
end:
    exr_encoding_destroy(context, &encoder);
    free(planes);
    return result;
}

static ssfr_result write_file(const sheet *s, const char *temporary)
{
    ssfr_result result = SSFR_OK;
    exr_context_t context = NULL;
    const exr_context_initializer_t init = begin_quietly();
    EXR_TRY(s->path, exr_start_write(&context, temporary, EXR_WRITE_FILE_DIRECTLY, &init));
    SSFR_TRY(write_header(s, context));
    SSFR_TRY(write_pixels(s, context));
    EXR_TRY(s->path, exr_finish(&context));
end:
    if (context) exr_finish(&context);
    return result;
}

ssfr_result ssfr_exr_save(const char *path, int n_layers, const ssfr_layer *layers, int n_attributes,
                          const ssfr_attribute *attributes)
{
    ssfr_result result = SSFR_OK;
    ssfr_aside aside = {0};
    sheet s = {.path = path, .n_attributes = n_attributes, .attributes = attributes};
    SSFR_TRY(sheet_init(&s, n_layers, layers));
    SSFR_TRY(ssfr_aside_begin(&aside, path));
    SSFR_TRY(write_file(&s, aside.temporary));
end:
    sheet_finish(&s, n_layers);
    return ssfr_aside_end(&aside, result);
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

typedef struct source {
    const char *path;
    exr_context_t context;
    uint64_t size; /* bytes of the file */
    exr_storage_t storage;
    const exr_attr_chlist_t *channels;
    int left, top, w, h;  /* px, the data window */
    int chunk_w, chunk_h; /* px, of a tile or a group of lines */
} source;

static ssfr_result check_file(source *s)
{
    struct stat info;
    if (stat(s->path, &info) != 0) return ssfr_fail(SSFR_ERR_IO, "%s: %s", s->path, strerror(errno));
    if (!S_ISREG(info.st_mode)) return ssfr_fail(SSFR_ERR_IO, "%s: not a regular file", s->path);
    s->size = (uint64_t)info.st_size;
    return SSFR_OK;
}

/* Opens and reads the header. The caller closes with exr_finish whatever comes back. */
static ssfr_result open_source(source *s, const char *path)
{
    ssfr_result result = SSFR_OK;
    const exr_context_initializer_t init = begin_quietly();
    int n_parts = 0;
    *s = (source){.path = path};
    SSFR_TRY(check_file(s));
    EXR_TRY(path, exr_start_read(&s->context, path, &init));
    EXR_TRY(path, exr_get_count(s->context, &n_parts));
    if (n_parts != 1) {
        result = ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: %d parts, only single-part files are read", path, n_parts);
        goto end;
    }
    EXR_TRY(path, exr_get_storage(s->context, 0, &s->storage));
    if (s->storage != EXR_STORAGE_SCANLINE && s->storage != EXR_STORAGE_TILED) {
        result = ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: deep data, only flat images are read", path);
        goto end;
    }
    EXR_TRY(path, exr_get_channels(s->context, 0, &s->channels));
end:
    return result;
}

static void close_source(source *s)
{
    if (s->context) exr_finish(&s->context);
}

/* "R, G, B" in the file's order. */
static void list_channels(const exr_attr_chlist_t *channels, const char *separator, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < channels->num_channels && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", i ? separator : "", channels->entries[i].name.str);
}

static const exr_attr_chlist_entry_t *find_channel(const source *s, const char *name)
{
    const exr_attr_chlist_entry_t *found = NULL;
    for (int i = 0; i < s->channels->num_channels && !found; i++)
        if (strcmp(s->channels->entries[i].name.str, name) == 0) found = &s->channels->entries[i];
    return found;
}

static ssfr_result check_channels(const source *s, const names *wanted)
{
    for (int i = 0; i < wanted->n; i++) {
        const exr_attr_chlist_entry_t *channel = find_channel(s, wanted->at[i]);
        char list[512];
        list_channels(s->channels, ", ", list, sizeof list);
        if (!channel)
            return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no channel %s, the file has %s", s->path, wanted->at[i], list);
        if (channel->x_sampling != 1 || channel->y_sampling != 1)
            return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: channel %s is subsampled %d x %d", s->path, wanted->at[i],
                             channel->x_sampling, channel->y_sampling);
    }
    return check_distinct(s->path, wanted->at, wanted->n);
}

/* Bytes of one pixel over all channels of the file. */
static uint64_t pixel_size(const source *s)
{
    uint64_t size = 0;
    for (int i = 0; i < s->channels->num_channels; i++)
        size += s->channels->entries[i].pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    return size;
}

/* Refuses sizes that no file of this length can hold, before anything is allocated by them. */
static ssfr_result check_window(source *s)
{
    ssfr_result result = SSFR_OK;
    exr_attr_box2i_t window;
    exr_compression_t compression;
    EXR_TRY(s->path, exr_get_data_window(s->context, 0, &window));
    EXR_TRY(s->path, exr_get_compression(s->context, 0, &compression));
    const uint64_t ratio = compression < EXR_COMPRESSION_DWAA ? MAX_RATIO : DWA_RATIO;
    const int64_t w = (int64_t)window.max.x - window.min.x + 1, h = (int64_t)window.max.y - window.min.y + 1;
    if (w < 1 || h < 1 || w > SSFR_MAX_SIZE || h > SSFR_MAX_SIZE)
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: %lld x %lld pixels: sides go from 1 to %d", s->path, (long long)w,
                           (long long)h, SSFR_MAX_SIZE);
    else if ((uint64_t)(w * h) * pixel_size(s) / ratio > s->size)
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: %llu bytes cannot hold %lld x %lld pixels", s->path,
                           (unsigned long long)s->size, (long long)w, (long long)h);
    s->left = window.min.x, s->top = window.min.y, s->w = (int)w, s->h = (int)h;
end:
    return result;
}

static ssfr_result find_chunk_size(source *s)
{
    ssfr_result result = SSFR_OK;
    if (s->storage == EXR_STORAGE_TILED) {
        EXR_TRY(s->path, exr_get_tile_sizes(s->context, 0, 0, 0, &s->chunk_w, &s->chunk_h));
    } else {
        s->chunk_w = s->w;
        EXR_TRY(s->path, exr_get_scanlines_per_chunk(s->context, 0, &s->chunk_h));
    }
    if (s->chunk_w < 1 || s->chunk_h < 1)
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: chunks of %d x %d pixels", s->path, s->chunk_w, s->chunk_h);
end:
    return result;
}

/* Value of a half's bits: 1 sign, 5 exponent, 10 fraction. */
static double half_value(uint16_t bits)
{
    const int exponent = bits >> 10 & 31, fraction = bits & 1023;
    const double magnitude = exponent == 31 ? (fraction ? (double)NAN : INFINITY)
                             : exponent     ? ldexp(1024 + fraction, exponent - 25)
                                            : ldexp(fraction, -24);
    return bits >> 15 ? -magnitude : magnitude;
}

static double value_at(const unsigned char *plane, size_t i, exr_pixel_type_t type)
{
    uint16_t half = 0;
    uint32_t number = 0;
    float real = 0;
    switch (type) {
    case EXR_PIXEL_HALF: memcpy(&half, plane + i * sizeof half, sizeof half); return half_value(half);
    case EXR_PIXEL_UINT: memcpy(&number, plane + i * sizeof number, sizeof number); return number;
    default: memcpy(&real, plane + i * sizeof real, sizeof real); return (double)real;
    }
}

/* Every channel of the file is decoded as it is, into a plane of its own: where the decoder is to convert some channels
 * and skip others, OpenEXR 3.1 takes a short cut that writes to the skipped ones' NULL. */
static void aim_decoder(exr_decode_pipeline_t *decoder, unsigned char *planes, size_t plane_size)
{
    for (int k = 0; k < decoder->channel_count; k++) {
        exr_coding_channel_info_t *channel = &decoder->channels[k];
        channel->decode_to_ptr = planes + (size_t)k * plane_size;
        channel->user_pixel_stride = channel->bytes_per_element;
        channel->user_line_stride = channel->bytes_per_element * channel->width;
    }
}

static void copy_chunk(const exr_decode_pipeline_t *decoder, const names *wanted, int x, int y, ssfr_field *out)
{
    const int w = decoder->chunk.width, h = decoder->chunk.height;
    for (int k = 0; k < wanted->n; k++) {
        const exr_coding_channel_info_t *channel = decoder->channels;
        while (strcmp(channel->channel_name, wanted->at[k]) != 0) channel++;
        for (int i = 0; i < w * h; i++)
            ssfr_field_at(out, x + i % w, y + i / w)[k] =
                value_at(channel->decode_to_ptr, (size_t)i, channel->data_type);
    }
}

/* Decodes the chunk whose first pixel is (x, y) of the window. The decoder keeps its buffers between chunks. */
static ssfr_result load_chunk(const source *s, const names *wanted, int x, int y, exr_decode_pipeline_t *decoder,
                              unsigned char *planes, size_t plane_size, ssfr_field *out)
{
    ssfr_result result = SSFR_OK;
    const bool first = x == 0 && y == 0;
    exr_chunk_info_t chunk = {0};
    if (s->storage == EXR_STORAGE_TILED)
        EXR_TRY(s->path, exr_read_tile_chunk_info(s->context, 0, x / s->chunk_w, y / s->chunk_h, 0, 0, &chunk));
    else
        EXR_TRY(s->path, exr_read_scanline_chunk_info(s->context, 0, s->top + y, &chunk));
    if (chunk.width != ssfr_min_int(s->chunk_w, s->w - x) || chunk.height != ssfr_min_int(s->chunk_h, s->h - y)) {
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: the chunk at pixel (%d, %d) has %d x %d pixels", s->path, x, y,
                           chunk.width, chunk.height);
        goto end;
    }
    if (first) EXR_TRY(s->path, exr_decoding_initialize(s->context, 0, &chunk, decoder));
    else EXR_TRY(s->path, exr_decoding_update(s->context, 0, &chunk, decoder));
    aim_decoder(decoder, planes, plane_size);
    if (first) EXR_TRY(s->path, exr_decoding_choose_default_routines(s->context, 0, decoder));
    EXR_TRY(s->path, exr_decoding_run(s->context, 0, decoder));
    copy_chunk(decoder, wanted, x, y, out);
end:
    return result;
}

static ssfr_result load_pixels(const source *s, const names *wanted, ssfr_field *out)
{
    ssfr_result result = SSFR_OK;
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    unsigned char *planes = NULL;
    const size_t plane_size = (size_t)ssfr_min_int(s->chunk_w, s->w) * (size_t)ssfr_min_int(s->chunk_h, s->h) * 4;
    SSFR_TRY(ssfr_alloc(&planes, (size_t)s->channels->num_channels, plane_size, "EXR pixels"));
    for (int y = 0; y < s->h; y += s->chunk_h)
        for (int x = 0; x < s->w; x += s->chunk_w)
            SSFR_TRY(load_chunk(s, wanted, x, y, &decoder, planes, plane_size, out));
end:
    exr_decoding_destroy(s->context, &decoder);
    free(planes);
    return result;
}

ssfr_result ssfr_exr_load(const char *path, const char *channels, ssfr_field **out)
{
    ssfr_result result = SSFR_OK;
    source s = {0};
    names wanted = {0};
    *out = NULL;
    SSFR_TRY(names_init(&wanted, path, channels));
    SSFR_TRY(open_source(&s, path));
    SSFR_TRY(check_channels(&s, &wanted));
    SSFR_TRY(check_window(&s));
    SSFR_TRY(find_chunk_size(&s));
    SSFR_TRY(ssfr_field_create(out, s.w, s.h, wanted.n));
    SSFR_TRY(load_pixels(&s, &wanted, *out));
end:
    if (result != SSFR_OK) ssfr_field_destroy(out);
    close_source(&s);
    names_finish(&wanted);
    return result;
}

ssfr_result ssfr_exr_channels(const char *path, char **out)
{
    ssfr_result result = SSFR_OK;
    source s = {0};
    size_t size = 1;
    *out = NULL;
    SSFR_TRY(open_source(&s, path));
    for (int i = 0; i < s.channels->num_channels; i++) size += strlen(s.channels->entries[i].name.str) + 1;
    SSFR_TRY(ssfr_alloc(out, size, 1, "channel names"));
    list_channels(s.channels, ",", *out, size);
end:
    close_source(&s);
    return result;
}

ssfr_result ssfr_exr_number(const char *path, const char *name, double *out)
{
    ssfr_result result = SSFR_OK;
    source s = {0};
    const exr_attribute_t *attribute = NULL;
    SSFR_TRY(open_source(&s, path));
    if (exr_get_attribute_by_name(s.context, 0, name, &attribute) != EXR_ERR_SUCCESS)
        result = ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no attribute \"%s\"", path, name);
    else if (attribute->type == EXR_ATTR_DOUBLE)
        *out = attribute->d;
    else if (attribute->type == EXR_ATTR_FLOAT)
        *out = (double)attribute->f;
    else
        result = ssfr_fail(SSFR_ERR_UNKNOWN, "%s: attribute \"%s\" is a %s, not a number", path, name,
                           attribute->type_name);
end:
    close_source(&s);
    return result;
}

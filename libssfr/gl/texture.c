/* SPDX-License-Identifier: MIT */
/* texture.c: images of floats, the framebuffer that draws into them, and buffers. */
#include "gl/internal.h"

enum { BAND_BYTES = 4 << 20 }; /* what a transfer between double and float holds at a time */

typedef struct texture_format {
    GLenum internal[2], format; /* the first by storage */
    int stored; /* channels */
} texture_format;

/* Three channels are stored as four, because three cannot be drawn into. */
static const texture_format *format_of(int c)
{
    static const texture_format formats[] = {
        {{GL_R32F, GL_R16F}, GL_RED, 1}, {{GL_RG32F, GL_RG16F}, GL_RG, 2},
        {{GL_RGBA32F, GL_RGBA16F}, GL_RGBA, 4}, {{GL_RGBA32F, GL_RGBA16F}, GL_RGBA, 4}};
    return &formats[c - 1];
}

/* Before an allocation: tells whether ssfr_gl_end has no error to report yet. */
static bool no_error_yet(ssfr_gl *gl)
{
    ssfr_gl_note_errors(gl);
    return !gl->error[0];
}

/* Takes the driver's answer to an allocation. Its error is told here, and is not that of ssfr_gl_end. */
static ssfr_result check_memory(ssfr_gl *gl, bool clean_before, const char *what)
{
    const GLenum code = glGetError();
    if (code == GL_NO_ERROR) return SSFR_OK;
    ssfr_gl_note_errors(gl);
    if (clean_before) gl->error[0] = '\0';
    return ssfr_fail(code == GL_OUT_OF_MEMORY ? SSFR_ERR_MEMORY : SSFR_ERR_GL, "%s: %s", what,
                     ssfr_gl_error_name(code));
}

ssfr_result ssfr_texture_create(ssfr_gl *gl, ssfr_texture *out, int w, int h, int c, ssfr_storage storage)
{
    ssfr_result result = SSFR_OK;
    char what[64];
    const int most = ssfr_min_int(gl->limits.texture_px, SSFR_MAX_SIZE);
    *out = (ssfr_texture){0};
    if (w < 1 || h < 1 || w > most || h > most || c < 1 || c > 4)
        return ssfr_fail(SSFR_ERR_VALUE, "GPU image of %d x %d pixels and %d channels: sides to %d, channels to 4", w,
                         h, c, most);
    const texture_format *format = format_of(c);
    ssfr_texture texture = {.w = w, .h = h, .c = c, .storage = storage};
    const bool clean = no_error_yet(gl);
    glCreateTextures(GL_TEXTURE_2D, 1, &texture.name);
    glTextureStorage2D(texture.name, 1, format->internal[storage], w, h);
    snprintf(what, sizeof what, "GPU image of %d x %d pixels and %d channels", w, h, c);
    SSFR_TRY(check_memory(gl, clean, what));
    glTextureParameteri(texture.name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(texture.name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTextureParameteri(texture.name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture.name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl->allocations++;
    *out = texture;
    texture = (ssfr_texture){0};
end:
    ssfr_texture_finish(&texture);
    return result;
}

void ssfr_texture_finish(ssfr_texture *texture)
{
    if (texture->name && !texture->borrowed) glDeleteTextures(1, &texture->name);
    *texture = (ssfr_texture){0};
}

void ssfr_texture_clear(const ssfr_texture *texture, const float value[4])
{
    glClearTexImage(texture->name, 0, format_of(texture->c)->format, GL_FLOAT, value);
}

/* Rows of an image that a band of floats holds. */
static int band_rows(const ssfr_texture *texture, int stored)
{
    const int row_bytes = texture->w * stored * (int)sizeof(float);
    return ssfr_clamp_int(BAND_BYTES / row_bytes, 1, texture->h);
}

static ssfr_result band_create(float **out, const ssfr_texture *texture, int rows, int stored)
{
    return ssfr_alloc(out, (size_t)rows * (size_t)texture->w * (size_t)stored, sizeof **out, "a band of an image");
}

/* Channels are converted here and not by the driver, which then only copies what is stored in 32 bits: -1e30 and
 * NaN pass as they are. */
static void pack(float *to, int stored, const double *from, int c, size_t n)
{
    for (size_t i = 0; i < n; i++, to += stored, from += c) {
        for (int k = 0; k < c; k++) to[k] = (float)from[k];
        if (stored > c) to[c] = 1; /* alpha of an image that has none */
    }
}

static void unpack(double *to, int c, const float *from, int stored, size_t n)
{
    for (size_t i = 0; i < n; i++, to += c, from += stored)
        for (int k = 0; k < c; k++) to[k] = (double)from[k];
}

ssfr_result ssfr_texture_write(const ssfr_texture *texture, const ssfr_field *field)
{
    ssfr_result result = SSFR_OK;
    const texture_format *format = format_of(texture->c);
    const int rows = band_rows(texture, format->stored);
    float *band = NULL;
    if (field->w != texture->w || field->h != texture->h || field->c != texture->c)
        return ssfr_fail(SSFR_ERR_VALUE, "a field of %d x %d x %d does not fit a GPU image of %d x %d x %d", field->w,
                         field->h, field->c, texture->w, texture->h, texture->c);
    SSFR_TRY(band_create(&band, texture, rows, format->stored));
    for (int y = 0; y < texture->h; y += rows) {
        const int n = ssfr_min_int(rows, texture->h - y);
        pack(band, format->stored, ssfr_field_at(field, 0, y), texture->c, (size_t)n * (size_t)texture->w);
        glTextureSubImage2D(texture->name, 0, 0, y, texture->w, n, format->format, GL_FLOAT, band);
    }
end:
    free(band);
    return result;
}

ssfr_result ssfr_texture_read(const ssfr_texture *texture, ssfr_field **out)
{
    ssfr_result result = SSFR_OK;
    const texture_format *format = format_of(texture->c);
    const int rows = band_rows(texture, format->stored);
    const size_t row_bytes = (size_t)texture->w * (size_t)format->stored * sizeof(float);
    ssfr_field *field = NULL;
    float *band = NULL;
    *out = NULL;
    SSFR_TRY(band_create(&band, texture, rows, format->stored));
    SSFR_TRY(ssfr_field_create(&field, texture->w, texture->h, texture->c));
    for (int y = 0; y < texture->h; y += rows) {
        const int n = ssfr_min_int(rows, texture->h - y);
        glGetTextureSubImage(texture->name, 0, 0, y, 0, texture->w, n, 1, format->format, GL_FLOAT,
                             (GLsizei)(row_bytes * (size_t)n), band);
        unpack(ssfr_field_at(field, 0, y), texture->c, band, format->stored, (size_t)n * (size_t)texture->w);
    }
    *out = field;
end:
    free(band);
    return result;
}

/* ---- constant tables --------------------------------------------------------------------------------------------- */

static void set_table_filter(unsigned texture, bool repeats)
{
    const GLint wrap = repeats ? GL_REPEAT : GL_CLAMP_TO_EDGE;
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, wrap);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, wrap);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_R, wrap);
}

static void write_table(unsigned texture, const ssfr_texels *texels)
{
    static const GLenum formats[] = {GL_RED, GL_RG, GL_RGB, GL_RGBA};
    const ssfr_lookup *t = texels->table;
    const GLenum format = formats[t->c - 1], type = t->store == SSFR_LOOKUP_UNORM8 ? GL_UNSIGNED_BYTE : GL_FLOAT;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (t->d == 1) glTextureSubImage2D(texture, 0, 0, 0, t->w, t->h, format, type, texels->data);
    else glTextureSubImage3D(texture, 0, 0, 0, 0, t->w, t->h, t->d, format, type, texels->data);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4); /* the baseline */
}

ssfr_result ssfr_lookup_upload(ssfr_gl *gl, unsigned *out, const ssfr_texels *texels)
{
    static const GLenum stored[2][4] = {[SSFR_LOOKUP_FLOAT] = {GL_R32F, GL_RG32F, GL_RGB32F, GL_RGBA32F},
                                        [SSFR_LOOKUP_UNORM8] = {GL_R8, GL_RG8, GL_RGB8, GL_RGBA8}};
    ssfr_result result = SSFR_OK;
    const ssfr_lookup *t = texels->table;
    const GLenum internal = stored[t->store][t->c - 1];
    unsigned texture = 0;
    *out = 0;
    const bool clean = no_error_yet(gl);
    glCreateTextures(t->d == 1 ? GL_TEXTURE_2D : GL_TEXTURE_3D, 1, &texture);
    if (t->d == 1) glTextureStorage2D(texture, 1, internal, t->w, t->h);
    else glTextureStorage3D(texture, 1, internal, t->w, t->h, t->d);
    SSFR_TRY(check_memory(gl, clean, t->name));
    set_table_filter(texture, t->repeats);
    write_table(texture, texels);
    gl->allocations++;
    *out = texture;
    texture = 0;
end:
    ssfr_lookup_destroy(&texture);
    return result;
}

void ssfr_lookup_destroy(unsigned *texture)
{
    if (*texture) glDeleteTextures(1, texture);
    *texture = 0;
}

/* ---- the framebuffer --------------------------------------------------------------------------------------------- */

/* Attaches the first n of textures, and lets go of what was attached beyond. */
static void attach(ssfr_gl *gl, int n, const ssfr_texture *const *textures)
{
    GLenum buffers[SSFR_GL_TARGETS] = {0};
    for (int i = 0; i < ssfr_max_int(n, gl->n_attached); i++) {
        const GLenum attachment = GL_COLOR_ATTACHMENT0 + (GLenum)i;
        glNamedFramebufferTexture(gl->framebuffer, attachment, i < n ? textures[i]->name : 0, 0);
        if (i < n) buffers[i] = attachment;
    }
    if (n > 0 && n != gl->n_attached) glNamedFramebufferDrawBuffers(gl->framebuffer, n, buffers);
    gl->n_attached = n;
}

void ssfr_gl_detach(ssfr_gl *gl)
{
    attach(gl, 0, NULL);
}

ssfr_result ssfr_gl_target(ssfr_gl *gl, int n, const ssfr_texture *const *textures)
{
    if (n < 1 || n > SSFR_GL_TARGETS)
        return ssfr_fail(SSFR_ERR_VALUE, "%d images to draw into: expected 1 to %d", n, SSFR_GL_TARGETS);
    const int w = textures[0]->w, h = textures[0]->h;
    for (int i = 1; i < n; i++)
        if (textures[i]->w != w || textures[i]->h != h)
            return ssfr_fail(SSFR_ERR_VALUE, "image %d to draw into has %d x %d pixels, the first %d x %d", i,
                             textures[i]->w, textures[i]->h, w, h);
    attach(gl, n, textures);
    const GLenum status = glCheckNamedFramebufferStatus(gl->framebuffer, GL_DRAW_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        return ssfr_fail(SSFR_ERR_GL, "the driver cannot draw into %d images of %d x %d pixels: status 0x%x", n, w, h,
                         status);
    glBindFramebuffer(GL_FRAMEBUFFER, gl->framebuffer);
    glViewport(0, 0, w, h);
    return SSFR_OK;
}

/* ---- buffers ----------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_buffer_create(ssfr_gl *gl, unsigned *out, size_t size, const void *data, bool dynamic)
{
    ssfr_result result = SSFR_OK;
    static const uint32_t nothing; /* an empty set has a buffer too, of the least size that GL knows */
    char what[64];
    unsigned buffer = 0;
    *out = 0;
    if (size > PTRDIFF_MAX) return ssfr_fail(SSFR_ERR_VALUE, "GPU buffer of %zu bytes", size);
    const bool clean = no_error_yet(gl);
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, (GLsizeiptr)(size ? size : sizeof nothing), size ? data : &nothing,
                         dynamic ? GL_DYNAMIC_STORAGE_BIT : 0);
    snprintf(what, sizeof what, "GPU buffer of %zu bytes", size);
    SSFR_TRY(check_memory(gl, clean, what));
    gl->allocations++;
    *out = buffer;
    buffer = 0;
end:
    ssfr_buffer_destroy(&buffer);
    return result;
}

void ssfr_buffer_destroy(unsigned *buffer)
{
    if (*buffer) glDeleteBuffers(1, buffer);
    *buffer = 0;
}

/* SPDX-License-Identifier: MIT */
/* exchange.c: what a graph is asked for, what it is given from outside, and what it gives back. */
#include "graph/internal.h"

#include <epoxy/gl.h>

/* ---- finding an image by name ------------------------------------------------------------------------------------ */

static int port_resource(const node *n, const char *name)
{
    int found = -1;
    for (int k = 0; k < n->n_in; k++)
        if (strcmp(n->pass->inputs[k].name, name) == 0) found = n->in[k];
    for (int k = 0; k < n->n_out; k++)
        if (strcmp(n->pass->outputs[k].name, name) == 0) found = n->out[k];
    return found;
}

bool ssfr_graph_has_slot(const ssfr_graph *graph, ssfr_slot_id slot)
{
    return graph->last[slot] >= 0;
}

static ssfr_result find_resource(const ssfr_graph *graph, const char *name, int *out)
{
    const ssfr_slot_id slot = ssfr_slot_find(name);
    *out = slot ? graph->last[slot] : -1;
    if (*out < 0 && graph->single) *out = port_resource(&graph->nodes[0], name);
    if (*out < 0)
        return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: %s %s has no such image", name, graph->single ? "pass" : "pipeline",
                         graph->pipeline->name);
    return SSFR_OK;
}

static ssfr_result find_image(const ssfr_graph *graph, const char *name, int *out)
{
    const ssfr_result result = find_resource(graph, name, out);
    if (result == SSFR_OK && ssfr_slot_is_particles(graph->resources[*out].slot))
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: holds values of particles, not an image", name);
    return result;
}

/* ---- asked for --------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_graph_want(ssfr_graph *graph, const char *slot)
{
    int index;
    for (int i = 0; !slot && i < graph->n_resources; i++) graph->resources[i].asked = false;
    if (!slot) return SSFR_OK;
    const ssfr_result result = find_resource(graph, slot, &index);
    if (result == SSFR_OK) graph->resources[index].asked = true;
    return result;
}

void ssfr_graph_want_all(ssfr_graph *graph, bool all)
{
    graph->want_all = all;
}

/* ---- fields given ------------------------------------------------------------------------------------------------ */

/* What is filled with zeros is no depth image: in the eye plane a surface has neither curvature nor normal. */
static ssfr_result check_depth(const char *slot, const ssfr_field *field)
{
    for (int y = 0; y < field->h; y++)
        for (int x = 0; x < field->w; x++) {
            const double z = *ssfr_field_at(field, x, y);
            if (ssfr_is_surface(z) && z >= 0)
                return ssfr_fail(SSFR_ERR_VALUE, "%s: pixel %d,%d is at z = %g m; a surface before the eye has z < 0",
                                 slot, x, y, z);
        }
    return SSFR_OK;
}

/* How far the surface of a depth image stands from the eye plane; zeros when there is none. */
static void measure_depth(resource *r, const ssfr_field *field)
{
    const size_t n = (size_t)field->w * (size_t)field->h;
    double nearest = INFINITY, farthest = 0, sum = 0;
    size_t n_surface = 0;
    for (size_t i = 0; i < n; i++)
        if (ssfr_is_surface(field->data[i])) {
            nearest = fmin(nearest, -field->data[i]);
            farthest = fmax(farthest, -field->data[i]);
            sum -= field->data[i];
            n_surface++;
        }
    r->nearest = n_surface ? nearest : 0;
    r->farthest = farthest;
    r->mean = n_surface ? sum / (double)n_surface : 0;
}

static ssfr_result give_texture(ssfr_graph *graph, resource *r, const ssfr_field *field)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_gl_begin(graph->gl));
    if (r->given.texture.borrowed) ssfr_image_finish(&r->given);
    result = ssfr_image_ensure(graph, &r->given, field->w, field->h, field->c, SSFR_STORE_FLOAT);
    if (result == SSFR_OK) result = ssfr_texture_write(&r->given.texture, field);
    result = ssfr_gl_end(graph->gl, result);
end:
    return result;
}

static ssfr_result give_field(ssfr_graph *graph, resource *r, const ssfr_field *field)
{
    ssfr_result result = SSFR_OK;
    const size_t n = (size_t)field->w * (size_t)field->h * (size_t)field->c;
    SSFR_TRY(ssfr_image_ensure(graph, &r->given, field->w, field->h, field->c, SSFR_STORE_FLOAT));
    memcpy(r->given.field->data, field->data, n * sizeof *field->data);
end:
    return result;
}

ssfr_result ssfr_graph_import(ssfr_graph *graph, const char *slot, const ssfr_field *field)
{
    ssfr_result result = SSFR_OK;
    int index;
    SSFR_TRY(find_image(graph, slot, &index));
    resource *r = &graph->resources[index];
    if (!field) {
        r->is_given = false;
        goto end;
    }
    if (field->c != ssfr_slots[r->slot].channels)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %d channels given, it has %d", slot, field->c,
                         ssfr_slots[r->slot].channels);
    if (ssfr_slot_is_fluid(r->slot)) SSFR_TRY(check_depth(slot, field));
    r->is_given = false; /* until all of it is there */
    SSFR_TRY(graph->gl ? give_texture(graph, r, field) : give_field(graph, r, field));
    if (ssfr_slot_is_fluid(r->slot)) measure_depth(r, field);
    r->is_given = true;
end:
    return result;
}

/* ---- the host's textures and buffers ----------------------------------------------------------------------------- */

static ssfr_result begin_host(const ssfr_graph *graph, const char *what)
{
    if (!graph->gl || !ssfr_gl_is_host(graph->gl))
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: needs a graph on the host's GL context (SSFR_GL_CURRENT)", what);
    return ssfr_gl_begin(graph->gl);
}

/* Whether shaders read floats from the first `c` channels. */
static bool has_channels(unsigned texture, int c)
{
    static const GLenum types[] = {GL_TEXTURE_RED_TYPE, GL_TEXTURE_GREEN_TYPE, GL_TEXTURE_BLUE_TYPE,
                                   GL_TEXTURE_ALPHA_TYPE};
    bool ok = true;
    for (int k = 0; k < c; k++) {
        GLint type = GL_NONE;
        glGetTextureLevelParameteriv(texture, 0, types[k], &type);
        ok &= type == GL_FLOAT || type == GL_UNSIGNED_NORMALIZED || type == GL_SIGNED_NORMALIZED;
    }
    return ok;
}

/* The host's texture as ssfr sees it. */
static ssfr_result borrow(const char *what, unsigned name, int channels, ssfr_texture *out)
{
    GLint target = 0, level = 0, w = 0, h = 0;
    if (!glIsTexture(name)) return ssfr_fail(SSFR_ERR_VALUE, "%s: %u is not a texture", what, name);
    glGetTextureParameteriv(name, GL_TEXTURE_TARGET, &target);
    if (target != GL_TEXTURE_2D) return ssfr_fail(SSFR_ERR_VALUE, "%s: texture %u is not GL_TEXTURE_2D", what, name);
    glGetTextureParameteriv(name, GL_TEXTURE_BASE_LEVEL, &level); /* which shaders read, and nothing else does */
    if (level) return ssfr_fail(SSFR_ERR_VALUE, "%s: texture %u begins at level %d, not 0", what, name, level);
    glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_WIDTH, &w);
    glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_HEIGHT, &h);
    if (w < 1 || h < 1) return ssfr_fail(SSFR_ERR_VALUE, "%s: texture %u has no storage", what, name);
    if (!has_channels(name, channels))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: texture %u has not %d channels of floats or fractions", what, name,
                         channels);
    *out = (ssfr_texture){.name = name, .w = w, .h = h, .c = channels, .borrowed = true};
    return SSFR_OK;
}

ssfr_result ssfr_graph_import_texture(ssfr_graph *graph, const char *slot, unsigned texture)
{
    ssfr_result result = SSFR_OK;
    int index;
    ssfr_texture host;
    SSFR_TRY(find_image(graph, slot, &index));
    SSFR_TRY(begin_host(graph, slot));
    resource *r = &graph->resources[index];
    if (texture) result = borrow(slot, texture, ssfr_slots[r->slot].channels, &host);
    if (!texture) {
        r->is_given = false;
    } else if (result == SSFR_OK) {
        ssfr_image_finish(&r->given);
        r->given = (image){.w = host.w, .h = host.h, .c = host.c, .texture = host};
        r->nearest = r->mean = r->farthest = 0;
        r->is_given = true;
    }
    result = ssfr_gl_end(graph->gl, result);
end:
    return result;
}

static ssfr_result borrow_target(const char *what, unsigned name, int channels, ssfr_texture *out)
{
    ssfr_result result = SSFR_OK;
    GLint format = 0;
    SSFR_TRY(borrow(what, name, channels, out));
    glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_INTERNAL_FORMAT, &format);
    if (format != (channels == 1 ? GL_R32F : GL_RGBA32F))
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: texture %u is not %s", what, name,
                           channels == 1 ? "GL_R32F" : "GL_RGBA32F");
end:
    return result;
}

ssfr_result ssfr_graph_export_texture(ssfr_graph *graph, unsigned texture)
{
    ssfr_result result = SSFR_OK;
    ssfr_texture host = {0};
    if (ssfr_slot_is_particles(graph->pipeline->result))
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "export: %s holds values of particles, not an image",
                         ssfr_slots[graph->pipeline->result].name);
    SSFR_TRY(begin_host(graph, "export"));
    if (texture) result = borrow_target("export", texture, ssfr_slots[graph->pipeline->result].channels, &host);
    if (result == SSFR_OK) graph->exported = host;
    result = ssfr_gl_end(graph->gl, result);
end:
    return result;
}

/* Whether n positions, `stride` floats apart from `first` on, lie inside the buffer. */
static ssfr_result check_buffer(unsigned buffer, const host_buffer *h)
{
    GLint64 bytes = 0, most = 0;
    if (!glIsBuffer(buffer)) return ssfr_fail(SSFR_ERR_VALUE, "particles: %u is not a buffer", buffer);
    glGetNamedBufferParameteri64v(buffer, GL_BUFFER_SIZE, &bytes);
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    /* Nothing overflows: stride and first fit an int, n an eighth of one. Shaders count floats in an int. */
    const size_t floats = (size_t)bytes / sizeof(float), end = h->n ? h->first + (h->n - 1) * h->stride + 3 : 0;
    if (end > floats || end > INT32_MAX)
        return ssfr_fail(SSFR_ERR_VALUE, "particles: %zu of stride %zu from float %zu do not fit buffer %u, %lld bytes",
                         h->n, h->stride, h->first, buffer, (long long)bytes);
    if (end > (size_t)most / sizeof(float))
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "particles: shaders of this GPU read %lld bytes of buffer %u, not %zu",
                         (long long)most, buffer, end * sizeof(float));
    return SSFR_OK;
}

ssfr_result ssfr_graph_import_buffer(ssfr_graph *graph, unsigned buffer, size_t n, size_t stride, size_t first,
                                     const double origin[3], double radius)
{
    ssfr_result result = SSFR_OK;
    host_buffer host = {.buffer = buffer, .n = n, .stride = stride, .first = first, .radius = radius};
    if (buffer) memcpy(host.origin, origin, sizeof host.origin);
    SSFR_TRY(begin_host(graph, "particles"));
    if (!buffer) host = (host_buffer){0};
    else if (stride < 3 || stride > INT32_MAX || first > INT32_MAX || n > INT32_MAX / 8)
        result = ssfr_fail(SSFR_ERR_VALUE, "particles: %zu of stride %zu floats from float %zu", n, stride, first);
    else if (!(radius > 0 && isfinite(radius)))
        result = ssfr_fail(SSFR_ERR_VALUE, "particles: radius %g m: it must be positive", radius);
    else if (!isfinite(origin[0]) || !isfinite(origin[1]) || !isfinite(origin[2]))
        result = ssfr_fail(SSFR_ERR_VALUE, "particles: origin %g,%g,%g is not finite", origin[0], origin[1], origin[2]);
    else
        result = check_buffer(buffer, &host);
    if (result == SSFR_OK) graph->host = host;
    result = ssfr_gl_end(graph->gl, result);
end:
    return result;
}

/* ---- given back -------------------------------------------------------------------------------------------------- */

const char *ssfr_graph_slot_at(const ssfr_graph *graph, int i)
{
    const char *found = NULL;
    for (int slot = 1; slot < SSFR_N_SLOTS && !found; slot++) {
        const int last = graph->last[slot];
        if (last < 0 || graph->resources[last].writer < 0 || ssfr_slot_is_particles((ssfr_slot_id)slot)) continue;
        if (i-- == 0) found = ssfr_slots[slot].name;
    }
    return found;
}

ssfr_result ssfr_graph_read(const ssfr_graph *graph, const char *slot, ssfr_field **out)
{
    ssfr_result result = SSFR_OK;
    int index;
    *out = NULL;
    SSFR_TRY(find_image(graph, slot, &index));
    if (!graph->ran) return ssfr_fail(SSFR_ERR_VALUE, "%s: no frame has been run", slot);
    const image *im = graph->resources[index].image;
    if (!graph->gl) {
        SSFR_TRY(ssfr_field_copy(out, im->field));
    } else {
        SSFR_TRY(ssfr_gl_begin(graph->gl));
        result = ssfr_texture_read(&im->texture, out);
        result = ssfr_gl_end(graph->gl, result);
        if (result != SSFR_OK) ssfr_field_destroy(out);
    }
end:
    return result;
}

ssfr_result ssfr_graph_read_values(const ssfr_graph *graph, const char *slot, size_t *n, const float **values)
{
    ssfr_result result = SSFR_OK;
    int index;
    *n = 0;
    *values = NULL;
    SSFR_TRY(find_resource(graph, slot, &index));
    const resource *r = &graph->resources[index];
    if (!ssfr_slot_is_particles(r->slot))
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: holds an image, not values of particles", slot);
    if (!graph->ran) return ssfr_fail(SSFR_ERR_VALUE, "%s: no frame has been run", slot);
    *n = r->values.now.n;
    *values = r->values.now.data;
end:
    return result;
}

const ssfr_report *ssfr_graph_report(const ssfr_graph *graph)
{
    return &graph->report;
}

const ssfr_run *ssfr_graph_last_run(const ssfr_graph *graph, int i)
{
    const bool ran = graph->ran && !graph->gl && i >= 0 && i < graph->n_nodes && graph->reports[i].status == SSFR_RAN;
    return ran ? &graph->nodes[i].run : NULL;
}

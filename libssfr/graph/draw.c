/* SPDX-License-Identifier: MIT */
/* draw.c: the two ways a pass draws: over the screen's tiles, and a splat for each particle. */
#include "graph/draw.h"

#include <epoxy/gl.h>

/* Locations of the uniforms that drawing itself sets, as tiles.vert and particles.glsl have them. */
enum { SSFR_AT_TILE = 0, SSFR_AT_LAYOUT = 0 };

void ssfr_draw_bind(const ssfr_draw *draw, int k, const ssfr_texture *texture)
{
    glBindTextureUnit((GLuint)k, texture->name);
    /* A host's filter may ask for mipmaps that are not there, and then nothing is read. */
    glBindSampler((GLuint)k, texture->borrowed ? draw->sampler : 0);
}

ssfr_result ssfr_draw_screen(const ssfr_run *run, unsigned program, int n, const ssfr_texture *const *targets)
{
    ssfr_result result = SSFR_OK;
    const ssfr_draw *draw = run->draw;
    SSFR_TRY(ssfr_gl_target(draw->gl, n, targets));
    glUseProgram(program);
    if (draw->whole_screen) {
        glUniform4i(SSFR_AT_TILE, 0, 0, targets[0]->w, targets[0]->h);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    } else {
        glUniform4i(SSFR_AT_TILE, SSFR_TILE / run->divisor, 1, targets[0]->w, targets[0]->h);
        glDrawArrays(GL_TRIANGLES, 0, 6 * run->frame->facts.n_tiles);
    }
end:
    return result;
}

ssfr_result ssfr_draw_by_solids(const ssfr_run *run, unsigned program, int first, int count)
{
    ssfr_result result = SSFR_OK;
    const ssfr_draw *draw = run->draw;
    if (count == 0) return SSFR_OK;
    SSFR_TRY(ssfr_gl_target(draw->gl, draw->n_out, draw->out));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SSFR_BIND_TILES, draw->tiles_by_solids);
    glUseProgram(program);
    glUniform4i(SSFR_AT_TILE, SSFR_TILE / run->divisor, 1, draw->out[0]->w, draw->out[0]->h);
    glDrawArrays(GL_TRIANGLES, 6 * first, 6 * count);
end:
    return result;
}

static void set_blend(ssfr_splat_blend blend)
{
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE); /* MAX ignores it */
    glBlendEquation(blend == SSFR_BLEND_NEAREST ? GL_MAX : GL_FUNC_ADD);
}

static void draw_quads(int first, int count)
{
    for (int done = 0; done < count; done += SSFR_QUAD_BATCH)
        glDrawElementsBaseVertex(GL_TRIANGLES, 6 * ssfr_min_int(count - done, SSFR_QUAD_BATCH), GL_UNSIGNED_SHORT, NULL,
                                 4 * (first + done));
}

ssfr_result ssfr_draw_splats(const ssfr_run *run, unsigned program, ssfr_splat_primitive primitive,
                             ssfr_splat_blend blend)
{
    ssfr_result result = SSFR_OK;
    const ssfr_draw *draw = run->draw;
    const ssfr_facts *facts = &run->frame->facts;
    SSFR_TRY(ssfr_gl_target(draw->gl, draw->n_out, draw->out));
    set_blend(blend);
    glUseProgram(program);
    glUniform2i(SSFR_AT_LAYOUT, draw->stride, draw->first);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, draw->quads);
    for (int i = 0; i < facts->n_ranges; i++) {
        if (primitive == SSFR_POINTS) glDrawArrays(GL_POINTS, facts->first[i], facts->count[i]);
        else draw_quads(facts->first[i], facts->count[i]);
    }
end:
    return result;
}

/* A host's image may have another format, as halves have, and one pixel is not a whole image: these are drawn. */
ssfr_result ssfr_draw_copy(const ssfr_draw *draw, const ssfr_texture *from, const ssfr_texture *to)
{
    ssfr_result result = SSFR_OK;
    const bool same_size = from->w == to->w && from->h == to->h;
    if (!same_size && (from->w != 1 || from->h != 1))
        return ssfr_fail(SSFR_ERR_VALUE, "image of %d x %d pixels for a texture of %d x %d", from->w, from->h, to->w,
                         to->h);
    if (same_size && from->storage == to->storage && !from->borrowed && !to->borrowed) {
        glCopyImageSubData(from->name, GL_TEXTURE_2D, 0, 0, 0, 0, to->name, GL_TEXTURE_2D, 0, 0, 0, 0, to->w, to->h, 1);
    } else {
        SSFR_TRY(ssfr_gl_target(draw->gl, 1, &to));
        ssfr_draw_bind(draw, 0, from);
        glUseProgram(draw->copy);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
end:
    return result;
}

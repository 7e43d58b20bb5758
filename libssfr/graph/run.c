/* SPDX-License-Identifier: MIT */
/* run.c: one frame: facts, plan, images, then each node that is left in, on the CPU or the GPU. */
#include "graph/internal.h"
#include "scene/mesh.h"

#include <assert.h>
#include <epoxy/gl.h>

/* ---- what the GPU needs once a frame ----------------------------------------------------------------------------- */

static ssfr_result refill(ssfr_graph *graph, unsigned *buffer, size_t n, size_t entry, const void *data,
                          const char *what)
{
    const size_t size = n * entry;
    GLint64 most = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    if (size > (size_t)most)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%zu %s: shaders of this GPU read %lld of %zu bytes", n, what,
                         (long long)most, size);
    ssfr_buffer_destroy(buffer);
    graph->grew++;
    return ssfr_buffer_create(graph->gl, buffer, size ? size : 4, size ? data : NULL, false);
}

/* Particles are uploaded once: until others come. */
static ssfr_result upload_particles(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    const ssfr_particles *p = graph->frame.particles;
    if (!p || p->serial == graph->serial) return SSFR_OK;
    graph->serial = 0;
    SSFR_TRY(refill(graph, &graph->position, p->n, 3 * sizeof(float), p->position, "particles"));
    graph->serial = p->serial;
end:
    return result;
}

static ssfr_result upload_ids(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    const ssfr_particles *p = graph->frame.particles;
    if (!p || !p->id || p->serial == graph->id_serial) return SSFR_OK;
    graph->id_serial = 0;
    SSFR_TRY(refill(graph, &graph->ids, p->n, sizeof *p->id, p->id, "particles"));
    graph->id_serial = p->serial;
end:
    return result;
}

/* ---- solids and environment -------------------------------------------------------------------------------------- */

enum { MAX_NODES = 1 << 24 }; /* a float in the frame's block says where a mesh begins */

typedef float mesh_triangle[3][4]; /* corners relative to the mesh's middle; w: the normal */

/* All meshes, one after the other: their indices begin anew with each, and are made to count from the first. */
static void join_meshes(const ssfr_frame *f, ssfr_mesh_node *nodes, mesh_triangle *triangles)
{
    uint32_t first_triangle = 0;
    for (int m = 0; m < f->n_meshes; m++) {
        const ssfr_mesh *mesh = f->meshes[m];
        const uint32_t first_node = (uint32_t)f->first_node[m];
        for (size_t i = 0; i < mesh->n_nodes; i++) {
            ssfr_mesh_node *node = nodes + first_node + i;
            *node = mesh->nodes[i];
            node->skip += first_node;
            if (node->leaf) node->leaf += 8 * first_triangle;
        }
        for (size_t i = 0; i < mesh->n_triangles; i++)
            for (int k = 0; k < 3; k++) {
                float *to = triangles[first_triangle + i][k];
                for (int j = 0; j < 3; j++) to[j] = (float)(mesh->triangles[i].corner[k][j] - mesh->middle[j]);
                to[3] = (float)mesh->triangles[i].normal[k];
            }
        first_triangle += (uint32_t)mesh->n_triangles;
    }
}

static bool has_meshes(const ssfr_graph *graph)
{
    bool same = graph->n_meshes == graph->frame.n_meshes;
    for (int m = 0; m < graph->frame.n_meshes && same; m++)
        same = graph->mesh_serials[m] == graph->frame.meshes[m]->serial;
    return same;
}

/* Meshes are uploaded once: until others come. How they stand does not matter. */
static ssfr_result upload_meshes(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    const ssfr_frame *f = &graph->frame;
    ssfr_mesh_node *nodes = NULL;
    mesh_triangle *triangles = NULL;
    if (has_meshes(graph) || f->n_meshes == 0) return SSFR_OK;
    if (f->n_nodes > MAX_NODES)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%zu nodes of meshes: at most %d", f->n_nodes, MAX_NODES);
    graph->n_meshes = 0;
    SSFR_TRY(ssfr_alloc(&nodes, f->n_nodes, sizeof *nodes, "meshes"));
    SSFR_TRY(ssfr_alloc(&triangles, f->n_triangles, sizeof *triangles, "meshes"));
    join_meshes(f, nodes, triangles);
    SSFR_TRY(refill(graph, &graph->nodes_of_meshes, f->n_nodes, sizeof *nodes, nodes, "nodes of meshes"));
    SSFR_TRY(refill(graph, &graph->triangles, f->n_triangles, sizeof *triangles, triangles, "triangles"));
    graph->n_meshes = f->n_meshes;
    for (int m = 0; m < f->n_meshes; m++) graph->mesh_serials[m] = f->meshes[m]->serial;
end:
    free(nodes), free(triangles);
    return result;
}

static ssfr_result upload_environment(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    const ssfr_field *map = graph->frame.scene->environment;
    ssfr_texture *to = &graph->environment;
    if (!map || graph->environment_key == graph->frame.environment_key) return SSFR_OK;
    graph->environment_key = 0;
    if (to->w != map->w || to->h != map->h) {
        ssfr_texture_finish(to);
        SSFR_TRY(ssfr_texture_create(graph->gl, to, map->w, map->h, 3, SSFR_STORE_FLOAT));
        graph->grew++;
    }
    SSFR_TRY(ssfr_texture_write(to, map));
    graph->environment_key = graph->frame.environment_key;
end:
    return result;
}

/* ---- the frame's buffers ----------------------------------------------------------------------------------------- */

static ssfr_result grow(ssfr_graph *graph, unsigned *buffer, size_t *cap, size_t n, size_t entry)
{
    ssfr_result result = SSFR_OK;
    if (*buffer && n <= *cap) return SSFR_OK;
    ssfr_buffer_destroy(buffer);
    *cap = 0;
    SSFR_TRY(ssfr_buffer_create(graph->gl, buffer, (n ? n : 1) * entry, NULL, true));
    *cap = n;
    graph->grew++;
end:
    return result;
}

/* A block of doubles as the floats that shaders read, written in stretches. */
static void write_floats(unsigned buffer, size_t n, size_t from_width, size_t to_width, const double *data)
{
    float stretch[1024];
    const size_t entries = SSFR_COUNT(stretch) / to_width;
    for (size_t start = 0; start < n; start += entries) {
        const size_t count = n - start < entries ? n - start : entries;
        for (size_t i = 0; i < count; i++)
            for (size_t k = 0; k < to_width; k++)
                stretch[i * to_width + k] = k < from_width ? (float)data[(start + i) * from_width + k] : 0;
        glNamedBufferSubData(buffer, (GLintptr)(start * to_width * sizeof(float)),
                             (GLsizeiptr)(count * to_width * sizeof(float)), stretch);
    }
}

/* Gathered on the GPU first, so that one transfer is waited for. */
static ssfr_result sample_host(ssfr_graph *graph)
{
    enum { N_SAMPLES = 256 };
    ssfr_result result = SSFR_OK;
    const host_buffer *h = &graph->host;
    float positions[N_SAMPLES][3];
    const size_t n = h->n < N_SAMPLES ? h->n : N_SAMPLES, size = sizeof positions[0];
    if (!h->buffer || n == 0) return SSFR_OK;
    if (!graph->samples) {
        SSFR_TRY(ssfr_buffer_create(graph->gl, &graph->samples, sizeof positions, NULL, true));
        graph->grew++;
    }
    for (size_t i = 0; i < n; i++) {
        const size_t from = h->first + h->stride * (i * h->n / n);
        glCopyNamedBufferSubData(h->buffer, graph->samples, (GLintptr)(from * sizeof(float)), (GLintptr)(i * size),
                                 (GLsizeiptr)size);
    }
    glGetNamedBufferSubData(graph->samples, 0, (GLsizeiptr)(n * size), positions);
    ssfr_frame_sample_host(&graph->frame, n, (const float(*)[3])positions);
end:
    return result;
}

static ssfr_result upload_frame(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    const ssfr_frame *f = &graph->frame;
    const size_t n_tiles = (size_t)f->facts.tiles_x * (size_t)f->facts.tiles_y;
    SSFR_TRY(sample_host(graph));
    SSFR_TRY(upload_particles(graph));
    SSFR_TRY(upload_meshes(graph));
    SSFR_TRY(upload_environment(graph));
    SSFR_TRY(grow(graph, &graph->offsets, &graph->cap_offsets, f->n_packets, 4 * sizeof(float)));
    SSFR_TRY(grow(graph, &graph->tiles, &graph->cap_tiles, n_tiles, sizeof *f->facts.tiles));
    SSFR_TRY(grow(graph, &graph->solid_tiles, &graph->cap_solid_tiles, n_tiles, sizeof *f->facts.solids));
    SSFR_TRY(grow(graph, &graph->tiles_by_solids, &graph->cap_by_solids, n_tiles, sizeof *f->facts.by_solids));
    write_floats(graph->block, sizeof f->block / sizeof(double), 1, 1, (const double *)&f->block);
    write_floats(graph->offsets, f->n_packets, 3, 4, (const double *)f->offset);
    if (f->facts.n_tiles)
        glNamedBufferSubData(graph->tiles, 0, (GLsizeiptr)((size_t)f->facts.n_tiles * sizeof *f->facts.tiles),
                             f->facts.tiles);
    if (f->n_solids) {
        glNamedBufferSubData(graph->solid_tiles, 0, (GLsizeiptr)(n_tiles * sizeof *f->facts.solids), f->facts.solids);
        glNamedBufferSubData(graph->tiles_by_solids, 0, (GLsizeiptr)(n_tiles * sizeof *f->facts.by_solids),
                             f->facts.by_solids);
    }
end:
    return result;
}

/* ---- images ------------------------------------------------------------------------------------------------------ */

static const image *input_image(const ssfr_graph *graph, const node *n, int k)
{
    const resource *r = &graph->resources[n->in[k]];
    return ssfr_node_reads(n, k) ? r->image : &graph->neutral[r->slot];
}

/* Whether a node can draw right into the host's texture: when what it writes is the result, be it that the nodes that
 * would draw over it are left out; but not when it reads it, nor when it is of another size or stored otherwise. */
static bool is_export(const ssfr_graph *graph, const node *n, int index, int w, int h)
{
    const ssfr_texture *to = &graph->exported;
    const ssfr_slot_id slot = graph->pipeline->result;
    const resource *r = &graph->resources[index], *shown = &graph->resources[graph->last[slot]];
    bool ok = to->name && r->slot == slot && shown->image == &r->own && to->w == w && to->h == h;
    ok &= ssfr_node_storage(n) == SSFR_STORE_FLOAT;
    for (int k = 0; k < n->n_in; k++) ok &= input_image(graph, n, k)->texture.name != to->name;
    return ok;
}

static ssfr_result ensure_output(ssfr_graph *graph, const node *n, int k)
{
    resource *r = &graph->resources[n->out[k]];
    const int c = ssfr_slots[r->slot].channels, d = n->divisor_out[k];
    const int w = d ? (graph->frame.w + d - 1) / d : n->run.w;
    const int h = d ? (graph->frame.h + d - 1) / d : n->run.h;
    const bool exported = graph->gl && is_export(graph, n, n->out[k], w, h);
    if (r->own.texture.borrowed || exported) ssfr_image_finish(&r->own);
    if (!exported) return ssfr_image_ensure(graph, &r->own, w, h, c, ssfr_node_storage(n));
    r->own = (image){.w = w, .h = h, .c = c, .texture = graph->exported};
    return SSFR_OK;
}

static ssfr_result ensure_images(ssfr_graph *graph, node *n)
{
    ssfr_result result = SSFR_OK;
    for (int k = 0; k < n->run.n_out; k++) SSFR_TRY(ensure_output(graph, n, k));
    for (int k = 0; k < n->pass->n_scratch; k++)
        SSFR_TRY(ssfr_image_ensure(graph, &n->scratch[k], n->run.w, n->run.h,
                                   ssfr_slots[graph->resources[n->out[0]].slot].channels, ssfr_node_storage(n)));
end:
    return result;
}

/* ---- running a node ---------------------------------------------------------------------------------------------- */

/* What an output begins as, where the pass does not write all of it: an input to be drawn over, or the neutral
 * value. */
static const image *begins_as(const ssfr_graph *graph, const node *n, int k)
{
    const int over = ssfr_port_find(n->pass->inputs, n->pass->outputs[k].over);
    return over >= 0 ? graph->resources[n->in[over]].image : &graph->neutral[graph->resources[n->out[k]].slot];
}

static void begin_field(ssfr_field *field, const ssfr_field *as)
{
    if (as->w == field->w && as->h == field->h) {
        memcpy(field->data, as->data, (size_t)field->w * (size_t)field->h * (size_t)field->c * sizeof *field->data);
        return;
    }
#pragma omp parallel for schedule(static)
    for (int y = 0; y < field->h; y++)
        for (int x = 0; x < field->w; x++)
            memcpy(ssfr_field_at(field, x, y), ssfr_field_fetch(as, x, y), (size_t)field->c * sizeof *field->data);
}

/* Words for this run, all zero: in memory for both, for the counts that the GPU gives back. */
static ssfr_result lend_words(ssfr_graph *graph, node *n)
{
    ssfr_result result = SSFR_OK;
    const size_t n_words = n->pass->n_words ? n->pass->n_words(&n->run) : 0;
    n->run.words = NULL;
    if (n_words == 0) return SSFR_OK;
    assert(n_words >= SSFR_COUNTS && ssfr_port_of_values(n->pass->inputs, SSFR_BIND_WORDS - SSFR_BIND_VALUES) < 0);
    if (n_words > n->cap_words) {
        free(n->words);
        n->cap_words = 0;
        SSFR_TRY(ssfr_alloc(&n->words, n_words, sizeof *n->words, "words of a run"));
        n->cap_words = n_words;
        graph->grew++;
    }
    memset(n->words, 0, n_words * sizeof *n->words);
    n->run.words = n->words;
    if (graph->gl) {
        SSFR_TRY(grow(graph, &n->word_buffer, &n->cap_word_buffer, n_words, sizeof *n->words));
        glClearNamedBufferData(n->word_buffer, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SSFR_BIND_WORDS, n->word_buffer);
    }
end:
    return result;
}

static ssfr_result run_on_cpu(ssfr_graph *graph, node *n)
{
    ssfr_result result = SSFR_OK;
    ssfr_run *run = &n->run;
    SSFR_TRY(ssfr_tables_ready(graph, n));
    for (int k = 0; k < n->n_in; k++) run->in[k] = input_image(graph, n, k)->field;
    for (int k = 0; k < n->n_out; k++) {
        run->out[k] = k < run->n_out ? graph->resources[n->out[k]].own.field : NULL;
        if (run->out[k] && !n->pass->whole_screen) begin_field(run->out[k], begins_as(graph, n, k)->field);
    }
    for (int k = 0; k < n->pass->n_scratch; k++) {
        run->scratch[k] = n->scratch[k].field;
        if (!n->pass->whole_screen) begin_field(run->scratch[k], begins_as(graph, n, 0)->field);
    }
    SSFR_TRY(lend_words(graph, n));
    n->pass->cpu_run(run);
end:
    return result;
}

static ssfr_result begin_texture(const ssfr_graph *graph, const node *n, int k, const ssfr_texture *texture)
{
    const ssfr_slot_id slot = graph->resources[n->out[k]].slot;
    const image *as = begins_as(graph, n, k);
    const float v = (float)ssfr_slots[slot].neutral;
    if (n->pass->whole_screen) return SSFR_OK;
    if (as != &graph->neutral[slot]) return ssfr_draw_copy(&n->draw, &as->texture, texture);
    ssfr_texture_clear(texture, (const float[4]){v, v, v, v});
    return SSFR_OK;
}

static void set_uniforms(const node *n, int program)
{
    const ssfr_uniform *u = n->pass->uniforms;
    for (int k = 0; u && u[k].name; k++) {
        const char *at = (const char *)n->coeffs + u[k].offset;
        const int location = n->locations[program][k];
        float v[4] = {0};
        int whole = 0;
        double reals[4] = {0};
        memcpy(u[k].n ? (void *)reals : (void *)&whole, at, u[k].n ? (size_t)u[k].n * sizeof(double) : sizeof whole);
        for (int i = 0; i < 4; i++) v[i] = (float)reals[i];
        switch (u[k].n) {
        case 0: glProgramUniform1i(n->programs[program], location, whole); break;
        case 1: glProgramUniform1f(n->programs[program], location, v[0]); break;
        case 2: glProgramUniform2fv(n->programs[program], location, 1, v); break;
        case 3: glProgramUniform3fv(n->programs[program], location, 1, v); break;
        default: glProgramUniform4fv(n->programs[program], location, 1, v); break;
        }
    }
}

static void bind_shared(const ssfr_graph *graph)
{
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, graph->block);
    const unsigned position = graph->host.buffer ? graph->host.buffer : graph->position;
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SSFR_BIND_POSITION, position);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SSFR_BIND_OFFSET, graph->offsets);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SSFR_BIND_TILES, graph->tiles);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SSFR_BIND_ID, graph->ids ? graph->ids : graph->offsets);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SSFR_BIND_SOLID_TILES, graph->solid_tiles);
    const bool meshes = graph->n_meshes > 0;
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SSFR_BIND_NODES, meshes ? graph->nodes_of_meshes : graph->offsets);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SSFR_BIND_TRIANGLES, meshes ? graph->triangles : graph->offsets);
    if (graph->environment_key) glBindTextureUnit(SSFR_UNIT_ENVIRONMENT, graph->environment.name);
    glBindSampler(SSFR_UNIT_ENVIRONMENT, 0);
}

static ssfr_result fill_draw(ssfr_graph *graph, node *n)
{
    ssfr_result result = SSFR_OK;
    ssfr_draw *draw = &n->draw;
    *draw = (ssfr_draw){.gl = graph->gl, .n_out = n->run.n_out, .programs = n->programs,
                        .whole_screen = n->pass->whole_screen, .stride = 3, .quads = graph->quads,
                        .copy = graph->copy, .sampler = graph->sampler, .tiles_by_solids = graph->tiles_by_solids};
    if (graph->host.buffer) draw->stride = (int)graph->host.stride, draw->first = (int)graph->host.first;
    for (int k = 0; k < draw->n_out; k++) {
        draw->out[k] = &graph->resources[n->out[k]].own.texture;
        SSFR_TRY(begin_texture(graph, n, k, draw->out[k]));
    }
    for (int k = 0; k < n->pass->n_scratch; k++) {
        draw->scratch[k] = &n->scratch[k].texture;
        SSFR_TRY(begin_texture(graph, n, 0, draw->scratch[k]));
    }
    for (int k = 0; k < n->n_in; k++) {
        if (ssfr_slot_is_particles(n->pass->inputs[k].slot)) continue;
        draw->in[k] = &input_image(graph, n, k)->texture;
        ssfr_draw_bind(draw, k, draw->in[k]);
    }
    n->run.draw = draw;
end:
    return result;
}

/* Values of particles are uploaded when a node that reads them draws, once. */
static ssfr_result bind_values(ssfr_graph *graph, const node *n)
{
    ssfr_result result = SSFR_OK;
    for (int j = 0, k; (k = ssfr_port_of_values(n->pass->inputs, j)) >= 0; j++) {
        resource *r = &graph->resources[n->in[k]];
        particle_values *v = &r->values;
        const size_t size = v->now.n * (size_t)v->now.c;
        const bool neutral = v->now.same || !ssfr_node_reads(n, k);
        if (!neutral && v->buffer_key != v->key) {
            v->buffer_key = 0;
            SSFR_TRY(grow(graph, &v->buffer, &v->cap_buffer, size, sizeof(float)));
            if (size) glNamedBufferSubData(v->buffer, 0, (GLsizeiptr)(size * sizeof(float)), v->now.data);
            v->buffer_key = v->key;
        }
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, (GLuint)(SSFR_BIND_VALUES + j),
                         neutral ? graph->neutral_buffers[r->slot] : v->buffer);
    }
end:
    return result;
}

static ssfr_result fit_programs(ssfr_graph *graph, node *n)
{
    ssfr_result result = SSFR_OK;
    char text[SSFR_DEFINES];
    for (int i = 0; n->pass->programs[i].vert && n->pass->defines; i++)
        if (n->pass->defines(&n->run, i, text)) SSFR_TRY(ssfr_node_program(graph, n, i, text));
end:
    return result;
}

static ssfr_result run_on_gpu(ssfr_graph *graph, node *n)
{
    ssfr_result result = SSFR_OK;
    ssfr_gl_baseline(graph->gl);
    ssfr_gl_push(graph->gl, n->pass->name);
    if (n->pass->uses_ids) SSFR_TRY(upload_ids(graph));
    bind_shared(graph);
    SSFR_TRY(bind_values(graph, n));
    SSFR_TRY(lend_words(graph, n));
    SSFR_TRY(ssfr_tables_ready(graph, n));
    SSFR_TRY(fill_draw(graph, n));
    SSFR_TRY(fit_programs(graph, n));
    for (int i = 0; n->pass->programs[i].vert; i++) set_uniforms(n, i);
    if (n->pass->gl_run) SSFR_TRY(n->pass->gl_run(&n->run));
    else SSFR_TRY(ssfr_draw_screen(&n->run, n->programs[0], n->draw.n_out, n->draw.out));
end:
    ssfr_gl_pop(graph->gl);
    return result;
}

static double covered_px(const ssfr_graph *graph, const node *n)
{
    const double px = (double)n->run.w * (double)n->run.h;
    return n->pass->whole_screen ? px : px * graph->frame.facts.covered;
}

static int drawn_tiles(const ssfr_graph *graph, const node *n)
{
    const ssfr_facts *facts = &graph->frame.facts;
    return n->pass->whole_screen ? facts->tiles_x * facts->tiles_y : facts->n_tiles;
}

/* The neutral value is no more than a uniform. */
static double values_bytes(const particle_values *v)
{
    return v->now.same ? 0 : (double)sizeof(float) * v->now.c * (double)v->now.n;
}

/* Pixels of an input that a sweep over px of the outputs reads: all of a map. */
static double read_px(const node *n, const resource *r, double px)
{
    const bool map = ssfr_slot_is_map(r->slot);
    return map ? (double)r->w * (double)r->h : px * ssfr_square((double)n->run.divisor / r->divisor);
}

/* One sweep that reads each input and writes each output once; the pass knows better where that is wrong. */
static void count_work(const ssfr_graph *graph, const node *n, ssfr_node_report *report)
{
    const double px = covered_px(graph, n);
    report->iterations = 1;
    report->taps = n->pass->taps;
    for (int k = 0; k < n->n_in; k++) {
        const resource *r = &graph->resources[n->in[k]];
        const bool values = ssfr_slot_is_particles(r->slot);
        if (!ssfr_node_reads(n, k)) continue;
        if (values) report->bytes += values_bytes(&r->values);
        if (values) continue;
        if (n->pass->taps == 0) report->taps++;
        report->bytes += ssfr_channel_bytes(r->image->storage) * ssfr_slots[r->slot].channels * read_px(n, r, px);
    }
    for (int k = 0; n->pass->tables[k].table; k++)
        if (n->run.tables[k]) report->bytes += (double)ssfr_lookup_bytes(n->pass->tables[k].table);
    const double bytes = ssfr_channel_bytes(ssfr_node_storage(n));
    for (int k = 0; k < n->run.n_out; k++)
        report->bytes += bytes * ssfr_slots[graph->resources[n->out[k]].slot].channels * px;
    if (n->pass->work) n->pass->work(&n->run, report);
    if (report->tiles == 0) report->tiles = report->iterations * drawn_tiles(graph, n);
}

static ssfr_result run_node(ssfr_graph *graph, int i, bool timing)
{
    ssfr_result result = SSFR_OK;
    node *n = &graph->nodes[i];
    ssfr_node_report *report = &graph->reports[i];
    /* A software rasteriser stamps what shares a target at one time, unless it is flushed in between. */
    const bool flush = timing && graph->gl && ssfr_gl_is_software(graph->gl);
    SSFR_TRY(ensure_images(graph, n));
    if (n->pass->derive) n->pass->derive(&n->run, n->coeffs);
    if (graph->gl) {
        if (timing) ssfr_timers_start(&graph->timers, i);
        if (flush) glFlush();
        result = run_on_gpu(graph, n);
        if (flush) glFinish();
        if (timing) ssfr_timers_stop(&graph->timers, i);
    } else {
        const double start = ssfr_clock();
        SSFR_TRY(run_on_cpu(graph, n));
        if (timing) report->ms = 1e3 * (ssfr_clock() - start);
    }
end:
    return result;
}

/* What is known of a node when all that was drawn is there. */
static ssfr_result finish_node(ssfr_graph *graph, int i, bool timing)
{
    node *n = &graph->nodes[i];
    ssfr_node_report *report = &graph->reports[i];
    if (graph->gl && timing) report->ms = ssfr_timers_ms(&graph->timers, i);
    if (graph->gl && n->run.words) {
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetNamedBufferSubData(n->word_buffer, 0, SSFR_COUNTS * sizeof *n->words, n->words);
    }
    count_work(graph, n, report);
    return n->pass->check ? n->pass->check(&n->run, n->pass->name) : SSFR_OK;
}

/* ---- the frame --------------------------------------------------------------------------------------------------- */

/* The particles need not tell of fluid whose depth is given. How far that of a host's texture is, is not known. */
static void note_given_fluid(ssfr_graph *graph)
{
    for (int i = 0; i < graph->n_resources; i++) {
        const resource *r = &graph->resources[i];
        if (r->is_given && ssfr_slot_is_fluid(r->slot))
            ssfr_frame_assume_fluid(&graph->frame, r->nearest, r->mean, r->farthest);
        if (r->is_given && ssfr_slot_is_layer(r->slot)) ssfr_frame_assume_layers(&graph->frame);
    }
}

static ssfr_result prepare_frame(ssfr_graph *graph, const ssfr_scene *scene, double reach, unsigned keep)
{
    const host_buffer *h = &graph->host;
    if (h->buffer && scene->particles)
        return ssfr_fail(SSFR_ERR_VALUE, "particles: both the scene's and a buffer's (%u) are given", h->buffer);
    if (h->buffer)
        return ssfr_frame_prepare_host(&graph->frame, scene, &graph->world, h->n, h->origin, h->radius, keep,
                                       &graph->grew);
    return ssfr_frame_prepare(&graph->frame, scene, &graph->world, reach, keep, &graph->grew);
}

/* Values may widen splats: only then what is in view is found a second time. */
static ssfr_result prepare(ssfr_graph *graph, const ssfr_scene *scene, const ssfr_run_options *options)
{
    ssfr_result result = SSFR_OK;
    const double reach = ssfr_graph_reach(graph, false);
    const unsigned keep = options->keep_all ? SSFR_KEEP_ALL : options->no_culling ? SSFR_KEEP_PARTICLES : 0;
    SSFR_TRY(prepare_frame(graph, scene, reach, keep));
    SSFR_TRY(ssfr_values_run(graph, options->keep_all));
    const double wide = ssfr_graph_reach(graph, true);
    if (wide > reach) SSFR_TRY(prepare_frame(graph, scene, wide, keep));
    ssfr_values_count(graph);
    note_given_fluid(graph);
end:
    return result;
}

/* The export when no node drew into it: the result is another image. */
static ssfr_result copy_export(const ssfr_graph *graph)
{
    const ssfr_draw draw = {.gl = graph->gl, .copy = graph->copy, .sampler = graph->sampler};
    const ssfr_texture *from = &graph->resources[graph->last[graph->pipeline->result]].image->texture;
    const ssfr_texture *to = &graph->exported;
    if (!to->name || from->name == to->name) return SSFR_OK;
    ssfr_gl_baseline(graph->gl);
    return ssfr_draw_copy(&draw, from, to);
}

/* Runs, or finishes, every node that the plan left in. */
static ssfr_result each_node(ssfr_graph *graph, bool timing, ssfr_result (*what)(ssfr_graph *, int, bool))
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < graph->n_nodes; i++)
        if (graph->reports[i].status == SSFR_RAN && !graph->nodes[i].pass->particles_run)
            SSFR_TRY(what(graph, i, timing));
end:
    return result;
}

static ssfr_result run_frame_on_gpu(ssfr_graph *graph, bool timing)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_gl_begin(graph->gl));
    result = upload_frame(graph);
    if (result == SSFR_OK) result = each_node(graph, timing, run_node);
    if (result == SSFR_OK) result = copy_export(graph);
    glFinish();
    if (result == SSFR_OK) result = each_node(graph, timing, finish_node);
    result = ssfr_gl_end(graph->gl, result);
end:
    return result;
}

/* Particle nodes have run before the plan made the reports. */
static void report_values(ssfr_graph *graph, bool timing)
{
    for (int i = 0; i < graph->n_nodes; i++) {
        const node *n = &graph->nodes[i];
        ssfr_node_report *report = &graph->reports[i];
        if (!n->pass->particles_run || report->status != SSFR_RAN) continue;
        if (timing) report->ms = n->ms;
        report->kept = n->kept;
        report->iterations = 1;
        for (int k = 0; k < n->n_in; k++) report->bytes += values_bytes(&graph->resources[n->in[k]].values);
        for (int k = 0; k < n->n_out; k++) report->bytes += values_bytes(&graph->resources[n->out[k]].values);
    }
}

ssfr_result ssfr_graph_advance(ssfr_graph *graph, const ssfr_scene *scene)
{
    static const ssfr_run_options plain = {0};
    graph->ran = false;
    graph->grew = 0;
    return prepare(graph, scene, &plain);
}

ssfr_result ssfr_graph_run(ssfr_graph *graph, const ssfr_scene *scene, const ssfr_run_options *options)
{
    static const ssfr_run_options plain = {0};
    ssfr_result result = SSFR_OK;
    const ssfr_run_options *o = options ? options : &plain;
    const double start = ssfr_clock();
    const long before = graph->gl ? ssfr_gl_allocations(graph->gl) : 0;
    graph->ran = false;
    graph->grew = 0;
    SSFR_TRY(prepare(graph, scene, o));
    SSFR_TRY(ssfr_plan(graph, o->keep_all));
    report_values(graph, o->timing);
    graph->report.cpu_ms = 1e3 * (ssfr_clock() - start);
    if (graph->gl) {
        SSFR_TRY(run_frame_on_gpu(graph, o->timing));
    } else {
        SSFR_TRY(each_node(graph, o->timing, run_node));
        SSFR_TRY(each_node(graph, o->timing, finish_node));
    }
    graph->ran = true;
end:
    graph->report.n_nodes = graph->n_nodes;
    graph->report.wall_ms = 1e3 * (ssfr_clock() - start);
    graph->report.allocations = graph->grew > 0 || !graph->gl ? graph->grew : ssfr_gl_allocations(graph->gl) - before;
    graph->report.n_particles = (int)graph->frame.facts.n_particles;
    graph->report.n_packets = (int)graph->frame.n_packets;
    graph->report.n_packets_seen = (int)graph->frame.facts.n_packets;
    graph->report.covered = graph->frame.facts.covered;
    graph->report.image_bytes = ssfr_memory_bytes(graph);
    return result;
}

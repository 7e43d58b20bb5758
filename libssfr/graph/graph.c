/* SPDX-License-Identifier: MIT */
/* graph.c: what a graph is: nodes and resources from a pipeline, and its parameters. */
#include "graph/internal.h"

#include <assert.h>
#include <epoxy/gl.h>

static const ssfr_param off_row = SSFR_PARAM_FLAG(node, off, 0, "leave this node out");

/* ---- images ------------------------------------------------------------------------------------------------------ */

ssfr_result ssfr_image_ensure(ssfr_graph *graph, image *im, int w, int h, int c, ssfr_storage storage)
{
    ssfr_result result = SSFR_OK;
    if (im->w == w && im->h == h && im->c == c && im->storage == storage) return SSFR_OK;
    ssfr_image_finish(im);
    if (graph->gl) SSFR_TRY(ssfr_texture_create(graph->gl, &im->texture, w, h, c, storage));
    else SSFR_TRY(ssfr_field_create(&im->field, w, h, c));
    im->w = w, im->h = h, im->c = c, im->storage = storage;
    graph->grew++;
end:
    return result;
}

void ssfr_image_finish(image *im)
{
    ssfr_field_destroy(&im->field);
    ssfr_texture_finish(&im->texture);
    *im = (image){0};
}

/* ---- nodes and resources ----------------------------------------------------------------------------------------- */

static ssfr_result add_resource(ssfr_graph *graph, ssfr_slot_id slot, int writer, int *out)
{
    if (graph->n_resources == SSFR_MAX_RESOURCES)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: more than %d images", graph->pipeline->name, SSFR_MAX_RESOURCES);
    *out = graph->n_resources++;
    graph->resources[*out] = (resource){.slot = slot, .writer = writer, .from = -1};
    graph->last[slot] = *out;
    return SSFR_OK;
}

static ssfr_slot_id bound_slot(const ssfr_node *def, const ssfr_port *port)
{
    ssfr_slot_id slot = port->slot;
    for (const ssfr_binding *b = def->ports; b->port; b++)
        if (strcmp(b->port, port->name) == 0) slot = b->slot;
    return slot;
}

static ssfr_result check_port(const node *n, const ssfr_port *port, ssfr_slot_id id)
{
    static const char *const kinds[] = {[SSFR_IMAGE] = "images", [SSFR_MAP] = "maps",
                                          [SSFR_PARTICLES] = "values of particles"};
    const ssfr_slot *slot = &ssfr_slots[id], *own = &ssfr_slots[port->slot];
    if (id == SSFR_NO_SLOT)
        return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: port %s is bound to no slot", n->name, port->name);
    if (slot->kind != own->kind)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: port %s carries %s, slot %s %s", n->name, port->name, kinds[own->kind],
                         slot->name, kinds[slot->kind]);
    if (slot->channels != own->channels)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: port %s takes %d channels, slot %s has %d", n->name, port->name,
                         own->channels, slot->name, slot->channels);
    if (slot->neutral != own->neutral)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: port %s is %g where there is nothing, slot %s %g", n->name, port->name,
                         own->neutral, slot->name, slot->neutral);
    return SSFR_OK;
}

static ssfr_result check_bindings(const node *n)
{
    for (const ssfr_binding *b = n->def->ports; b->port; b++)
        if (ssfr_port_find(n->pass->inputs, b->port) < 0 && ssfr_port_find(n->pass->outputs, b->port) < 0)
            return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: pass %s has no port %s", n->name, n->pass->name, b->port);
    return SSFR_OK;
}

/* Inputs read the last version written so far; outputs make a new one. */
static ssfr_result connect(ssfr_graph *graph, node *n, int index)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(check_bindings(n));
    for (const ssfr_port *port = n->pass->inputs; port->name; port++) {
        const ssfr_slot_id slot = bound_slot(n->def, port);
        SSFR_TRY(check_port(n, port, slot));
        if (graph->last[slot] < 0) SSFR_TRY(add_resource(graph, slot, -1, &graph->last[slot]));
        n->in[n->n_in++] = graph->last[slot];
    }
    for (const ssfr_port *port = n->pass->outputs; port->name; port++) {
        const ssfr_slot_id slot = bound_slot(n->def, port);
        SSFR_TRY(check_port(n, port, slot));
        SSFR_TRY(add_resource(graph, slot, index, &n->out[n->n_out++]));
    }
end:
    return result;
}

static ssfr_result apply_setting(node *n, const char *setting)
{
    char name[64];
    const size_t length = strcspn(setting, "=");
    snprintf(name, sizeof name, "%.*s", (int)length, setting);
    const ssfr_param *row = ssfr_param_find(n->pass->params, name);
    if (!row) return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: pass %s has no parameter %s", n->name, n->pass->name, name);
    return ssfr_param_set(row, n->params, name, setting + length + (setting[length] == '='));
}

/* What a pass may declare. */
static void check_ports(const ssfr_pass *pass)
{
    assert(ssfr_port_of_values(pass->inputs, SSFR_MAX_VALUES) < 0);
    for (const ssfr_port *in = pass->inputs; in->name; in++)
        assert(!pass->particles_run || ssfr_slot_is_particles(in->slot));
    for (const ssfr_port *out = pass->outputs; out->name; out++) {
        assert(ssfr_slot_is_particles(out->slot) == (pass->particles_run != NULL));
        assert(out > pass->outputs ? out->optional || !out[-1].optional : !out->optional);
        assert(ssfr_slot_is_map(out->slot) == (pass->size && pass->whole_screen));
    }
}

static ssfr_result add_node(ssfr_graph *graph, const ssfr_node *def)
{
    ssfr_result result = SSFR_OK;
    const int index = graph->n_nodes;
    node *n = &graph->nodes[index];
    const ssfr_pass *pass = ssfr_pass_find(def->pass ? def->pass : def->name);
    if (!pass) return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no pass %s", def->name, def->pass ? def->pass : def->name);
    for (int i = 0; i < index; i++)
        if (strcmp(graph->nodes[i].name, def->name) == 0)
            return ssfr_fail(SSFR_ERR_VALUE, "%s: two nodes are named %s", graph->pipeline->name, def->name);
    check_ports(pass);
    *n = (node){.def = def, .pass = pass};
    graph->n_nodes++;
    snprintf(n->name, sizeof n->name, "%s", def->name);
    SSFR_TRY(ssfr_alloc(&n->params, 1, pass->params_size, "parameters"));
    SSFR_TRY(ssfr_alloc(&n->coeffs, 1, pass->coeffs_size, "coefficients"));
    if (pass->state_size) SSFR_TRY(ssfr_alloc(&n->state, 1, pass->state_size, "what a pass keeps"));
    ssfr_params_default(pass->params, n->params);
    for (const char *const *setting = def->settings; *setting; setting++) SSFR_TRY(apply_setting(n, *setting));
    SSFR_TRY(connect(graph, n, index));
end:
    return result;
}

static void set_sampler(unsigned program, const char *port, int unit)
{
    char name[64];
    snprintf(name, sizeof name, "t_%s", port);
    const int location = glGetUniformLocation(program, name);
    if (location >= 0) glProgramUniform1i(program, location, unit);
}

ssfr_result ssfr_node_program(ssfr_graph *graph, node *n, int i, const char *defines)
{
    ssfr_result result = SSFR_OK;
    const ssfr_program_row *row = &n->pass->programs[i];
    if (n->programs[i] && strcmp(n->defines[i], defines) == 0) return SSFR_OK;
    SSFR_TRY(ssfr_program_get(graph->gl, &n->programs[i], row->vert, row->frag, defines[0] ? defines : row->defines));
    snprintf(n->defines[i], sizeof n->defines[i], "%s", defines);
    for (int k = 0; k < n->n_in; k++) set_sampler(n->programs[i], n->pass->inputs[k].name, k);
    for (int k = 0; n->pass->tables[k].table; k++)
        set_sampler(n->programs[i], n->pass->tables[k].table->name, SSFR_UNIT_TABLES + k);
    for (int k = 0; n->pass->uniforms && n->pass->uniforms[k].name; k++) {
        assert(k < SSFR_MAX_UNIFORMS);
        n->locations[i][k] = glGetUniformLocation(n->programs[i], n->pass->uniforms[k].name);
    }
end:
    return result;
}

static ssfr_result get_programs(ssfr_graph *graph, node *n)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; n->pass->programs[i].vert; i++) SSFR_TRY(ssfr_node_program(graph, n, i, ""));
end:
    return result;
}

static ssfr_result make_neutral_values(ssfr_graph *graph, ssfr_slot_id id)
{
    const ssfr_slot *slot = &ssfr_slots[id];
    for (int k = 0; k < slot->channels; k++) graph->neutral_values[id][k] = (float)slot->neutral;
    if (!graph->gl || graph->neutral_buffers[id]) return SSFR_OK;
    return ssfr_buffer_create(graph->gl, &graph->neutral_buffers[id], (size_t)slot->channels * sizeof(float),
                              graph->neutral_values[id], false);
}

static ssfr_result make_neutrals(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < graph->n_resources; i++) {
        const ssfr_slot_id id = graph->resources[i].slot;
        const ssfr_slot *slot = &ssfr_slots[id];
        image *im = &graph->neutral[id];
        if (slot->kind == SSFR_PARTICLES) SSFR_TRY(make_neutral_values(graph, id));
        if (slot->kind == SSFR_PARTICLES || im->w) continue;
        SSFR_TRY(ssfr_image_ensure(graph, im, 1, 1, slot->channels, SSFR_STORE_FLOAT));
        const float value = (float)slot->neutral;
        if (graph->gl) ssfr_texture_clear(&im->texture, (const float[4]){value, value, value, value});
        else ssfr_field_fill(im->field, slot->neutral);
    }
end:
    return result;
}

static ssfr_result make_quads(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    uint16_t *indices = NULL;
    static const int corners[6] = {0, 1, 2, 2, 1, 3};
    SSFR_TRY(ssfr_alloc(&indices, 6 * SSFR_QUAD_BATCH, sizeof *indices, "quad indices"));
    for (int i = 0; i < 6 * SSFR_QUAD_BATCH; i++) indices[i] = (uint16_t)(4 * (i / 6) + corners[i % 6]);
    SSFR_TRY(ssfr_buffer_create(graph->gl, &graph->quads, 6 * SSFR_QUAD_BATCH * sizeof *indices, indices, false));
end:
    free(indices);
    return result;
}

static void make_sampler(ssfr_graph *graph)
{
    glCreateSamplers(1, &graph->sampler);
    glSamplerParameteri(graph->sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glSamplerParameteri(graph->sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

static ssfr_result make_objects(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    const size_t block = sizeof(ssfr_block) / sizeof(double) * sizeof(float);
    for (int i = 0; i < graph->n_nodes; i++) SSFR_TRY(get_programs(graph, &graph->nodes[i]));
    SSFR_TRY(ssfr_program_get(graph->gl, &graph->copy, "fill.vert", "copy.frag", NULL));
    SSFR_TRY(make_neutrals(graph));
    SSFR_TRY(make_quads(graph));
    SSFR_TRY(ssfr_timers_create(&graph->timers, SSFR_MAX_NODES));
    SSFR_TRY(ssfr_buffer_create(graph->gl, &graph->block, block, NULL, true));
    make_sampler(graph);
end:
    return result;
}

static ssfr_result make_gl(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_gl_begin(graph->gl));
    graph->has_objects = true;
    result = ssfr_gl_end(graph->gl, make_objects(graph));
end:
    return result;
}

/* ---- keys: "node.param", "group.param", "node.off" --------------------------------------------------------------- */

static ssfr_result add_key(ssfr_graph *graph, int capacity, const char *head, const char *name)
{
    ssfr_result result = SSFR_OK;
    if (graph->n_keys < capacity) {
        const size_t size = strlen(head) + strlen(name) + 2;
        SSFR_TRY(ssfr_alloc(&graph->keys[graph->n_keys], 1, size, "a key"));
        snprintf(graph->keys[graph->n_keys], size, "%s.%s", head, name);
    }
    graph->n_keys++;
end:
    return result;
}

static ssfr_result add_keys(ssfr_graph *graph, int capacity)
{
    ssfr_result result = SSFR_OK;
    const ssfr_param *rows = NULL;
    const char *group = NULL;
    graph->n_keys = 0;
    for (int i = 0; i < graph->n_nodes; i++)
        for (const ssfr_param *row = graph->nodes[i].pass->params; row && row->name; row++)
            SSFR_TRY(add_key(graph, capacity, graph->nodes[i].name, row->name));
    for (int i = 0; (group = ssfr_group_at(i, &rows)); i++)
        for (const ssfr_param *row = rows; row->name; row++) SSFR_TRY(add_key(graph, capacity, group, row->name));
    for (int i = 0; i < graph->n_nodes; i++) SSFR_TRY(add_key(graph, capacity, graph->nodes[i].name, "off"));
end:
    return result;
}

static ssfr_result list_keys(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(add_keys(graph, 0)); /* counts */
    SSFR_TRY(ssfr_alloc(&graph->keys, (size_t)graph->n_keys + 1, sizeof *graph->keys, "keys"));
    SSFR_TRY(add_keys(graph, graph->n_keys));
end:
    return result;
}

const char *ssfr_graph_key_at(const ssfr_graph *graph, int i)
{
    return i >= 0 && i < graph->n_keys ? graph->keys[i] : NULL;
}

/* The target-th place that a key means: a node's parameter (of several nodes when it names their pass) or a group's. */
static const ssfr_param *resolve(const ssfr_graph *graph, const char *key, int target, void **params)
{
    const char *dot = strrchr(key, '.');
    const ssfr_param *found = NULL, *rows = NULL;
    const size_t head = dot ? (size_t)(dot - key) : 0;
    size_t offset = 0;
    bool by_name = false;
    if (!dot) return NULL;
    for (int i = 0; i < graph->n_nodes; i++)
        by_name |= strlen(graph->nodes[i].name) == head && memcmp(graph->nodes[i].name, key, head) == 0;
    for (int i = 0; i < graph->n_nodes && !found; i++) {
        const node *n = &graph->nodes[i];
        const char *name = by_name ? n->name : n->pass->name;
        if (strlen(name) != head || memcmp(name, key, head) != 0 || target-- > 0) continue;
        const bool off = strcmp(dot + 1, off_row.name) == 0;
        found = off ? &off_row : ssfr_param_find(n->pass->params, dot + 1);
        *params = off ? (void *)n : n->params;
    }
    for (int i = 0; !found && target == 0; i++) {
        const char *group = ssfr_world_group(i, &rows, &offset);
        if (!group) break;
        if (strlen(group) != head || memcmp(group, key, head) != 0) continue;
        found = ssfr_param_find(rows, dot + 1);
        *params = (char *)&graph->world + offset;
    }
    return found;
}

const ssfr_param *ssfr_graph_row(const ssfr_graph *graph, const char *key)
{
    void *params;
    return resolve(graph, key, 0, &params);
}

static ssfr_result fail_key(const ssfr_graph *graph, const char *key)
{
    const char *kind = graph->single ? "pass" : "pipeline", *list = graph->single ? "passes" : "pipelines";
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: %s %s has no such parameter (ssfr %s %s lists them)", key, kind,
                     graph->pipeline->name, list, graph->pipeline->name);
}

ssfr_result ssfr_graph_set(ssfr_graph *graph, const char *key, const char *value)
{
    ssfr_result result = SSFR_OK;
    void *params = NULL;
    const ssfr_param *row = resolve(graph, key, 0, &params);
    if (!row) return fail_key(graph, key);
    for (int i = 0; row && result == SSFR_OK; row = resolve(graph, key, ++i, &params)) {
        const double before = ssfr_param_number(row, params);
        result = ssfr_param_set(row, params, key, value);
        if (ssfr_param_number(row, params) != before) ssfr_values_forget(graph, params);
    }
    return result;
}

ssfr_result ssfr_graph_get(const ssfr_graph *graph, const char *key, char *text, size_t size)
{
    void *params = NULL;
    const ssfr_param *row = resolve(graph, key, 0, &params);
    if (!row) return fail_key(graph, key);
    ssfr_param_format(row, params, text, size);
    return SSFR_OK;
}

/* ---- creating and destroying ------------------------------------------------------------------------------------- */

static ssfr_result add_nodes(ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    const ssfr_pipeline *pipeline = graph->pipeline;
    for (int i = 0; i < SSFR_MAX_NODES && pipeline->nodes[i].name; i++) SSFR_TRY(add_node(graph, &pipeline->nodes[i]));
    const int last = graph->last[pipeline->result];
    if (last >= 0 && graph->resources[last].writer >= 0) graph->resources[last].asked = true;
    else result = ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no node writes its result, %s", pipeline->name,
                            ssfr_slots[pipeline->result].name);
end:
    return result;
}

ssfr_result ssfr_graph_create(ssfr_graph **out, const ssfr_pipeline *pipeline, ssfr_gl *gl)
{
    ssfr_result result = SSFR_OK;
    ssfr_graph *graph = NULL;
    *out = NULL;
    if (!pipeline) return ssfr_fail(SSFR_ERR_UNKNOWN, "no pipeline to make a graph of");
    SSFR_TRY(ssfr_alloc(&graph, 1, sizeof *graph, "a graph"));
    graph->pipeline = pipeline;
    graph->gl = gl;
    ssfr_world_default(&graph->world);
    for (int i = 0; i < SSFR_N_SLOTS; i++) graph->last[i] = -1;
    SSFR_TRY(add_nodes(graph));
    SSFR_TRY(list_keys(graph));
    if (gl) SSFR_TRY(make_gl(graph));
    else SSFR_TRY(make_neutrals(graph));
    graph->report.nodes = graph->reports;
    *out = graph;
    graph = NULL;
end:
    ssfr_graph_destroy(&graph);
    return result;
}

ssfr_result ssfr_graph_create_for_pass(ssfr_graph **out, const ssfr_pass *pass, ssfr_gl *gl)
{
    ssfr_result result = SSFR_OK;
    ssfr_pipeline *single = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&single, 1, sizeof *single, "a pipeline"));
    *single = (ssfr_pipeline){.name = pass->name, .source = pass->source, .help = pass->help,
                              .result = pass->outputs[0].slot, .nodes = {{.name = pass->name}}};
    SSFR_TRY(ssfr_graph_create(out, single, gl));
    (*out)->single = single;
    single = NULL;
end:
    free(single);
    return result;
}

static void destroy_gl(ssfr_graph *graph)
{
    unsigned *const buffers[] = {&graph->position,    &graph->ids,             &graph->offsets,   &graph->tiles,
                                 &graph->solid_tiles, &graph->nodes_of_meshes, &graph->triangles, &graph->block,
                                 &graph->quads,       &graph->samples,         &graph->tiles_by_solids};
    for (size_t i = 0; i < SSFR_COUNT(buffers); i++) ssfr_buffer_destroy(buffers[i]);
    for (int i = 0; i < SSFR_N_SLOTS; i++) ssfr_buffer_destroy(&graph->neutral_buffers[i]);
    for (int i = 0; i < graph->n_resources; i++) ssfr_buffer_destroy(&graph->resources[i].values.buffer);
    for (int i = 0; i < graph->n_nodes; i++) ssfr_buffer_destroy(&graph->nodes[i].word_buffer);
    ssfr_texture_finish(&graph->environment);
    if (graph->sampler) glDeleteSamplers(1, &graph->sampler);
    ssfr_timers_finish(&graph->timers);
}

static void destroy_images(ssfr_graph *graph)
{
    for (int i = 0; i < graph->n_resources; i++) {
        ssfr_image_finish(&graph->resources[i].own);
        ssfr_image_finish(&graph->resources[i].given);
    }
    for (int i = 0; i < graph->n_nodes; i++)
        for (int k = 0; k < SSFR_MAX_SCRATCH; k++) ssfr_image_finish(&graph->nodes[i].scratch[k]);
    for (int i = 0; i < SSFR_N_SLOTS; i++) ssfr_image_finish(&graph->neutral[i]);
}

void ssfr_graph_destroy(ssfr_graph **graph)
{
    ssfr_graph *g = *graph;
    if (!g) return;
    if (!g->gl) {
        destroy_images(g);
        ssfr_tables_finish(g);
    } else if (g->has_objects && ssfr_gl_begin(g->gl) == SSFR_OK) {
        destroy_images(g);
        destroy_gl(g);
        ssfr_tables_finish(g);
        const ssfr_result ended = ssfr_gl_end(g->gl, SSFR_OK);
        (void)ended; /* logged; there is nobody to tell */
    }
    ssfr_values_finish(g);
    free(g->timers.queries); /* still there when the context is gone */
    for (int i = 0; i < g->n_nodes; i++) free(g->nodes[i].params), free(g->nodes[i].coeffs), free(g->nodes[i].words);
    for (int i = 0; i < g->n_keys && g->keys; i++) free(g->keys[i]);
    free(g->keys);
    ssfr_frame_finish(&g->frame);
    free(g->single);
    free(g);
    *graph = NULL;
}

/* How much the values of particles widen a node's splats; not by_values: were they neutral, which may be 0. */
static double widening(ssfr_graph *graph, const node *n, bool by_values)
{
    double widening = 1;
    for (int k = 0; k < n->n_in; k++) {
        const double neutral = ssfr_slots[graph->resources[n->in[k]].slot].neutral;
        if (!n->pass->inputs[k].widens || !ssfr_node_reads(n, k)) continue;
        widening *= by_values ? fmax(ssfr_values_largest(&graph->resources[n->in[k]]), neutral) : neutral;
    }
    return widening;
}

double ssfr_graph_reach(ssfr_graph *graph, bool by_values)
{
    double reach = 0;
    for (int i = 0; i < graph->n_nodes; i++) {
        const node *n = &graph->nodes[i];
        if (!n->pass->reach || n->off) continue;
        reach = fmax(reach, n->pass->reach(n->params) * widening(graph, n, by_values));
    }
    return reach;
}

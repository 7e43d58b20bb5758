/* SPDX-License-Identifier: MIT */
/* tables.c: the constant tables of a graph: each made when a node first reads it, and shared. */
#include "graph/internal.h"

#include <assert.h>
#include <epoxy/gl.h>

static stored_table *find(ssfr_graph *graph, const ssfr_lookup *table)
{
    stored_table *found = NULL;
    for (int i = 0; i < graph->n_tables && !found; i++)
        if (graph->tables[i].texels.table == table) found = &graph->tables[i];
    return found;
}

/* The GPU's texture holds all that there is to it: the values themselves are given back. */
static ssfr_result make(ssfr_graph *graph, const ssfr_lookup *table, stored_table **out)
{
    ssfr_result result = SSFR_OK;
    stored_table made = {0};
    assert(graph->n_tables < SSFR_MAX_GRAPH_TABLES);
    SSFR_TRY(ssfr_texels_init(&made.texels, table));
    if (graph->gl) {
        SSFR_TRY(ssfr_lookup_upload(graph->gl, &made.texture, &made.texels));
        free(made.texels.data);
        made.texels.data = NULL;
    }
    graph->tables[graph->n_tables] = made;
    *out = &graph->tables[graph->n_tables++];
    made = (stored_table){0};
    graph->grew++;
end:
    ssfr_texels_finish(&made.texels);
    return result;
}

static bool is_read(const ssfr_lookup_use *use, const void *params)
{
    int word;
    memcpy(&word, (const char *)params + use->choice, sizeof word);
    return word == use->word;
}

ssfr_result ssfr_tables_ready(ssfr_graph *graph, node *n)
{
    ssfr_result result = SSFR_OK;
    for (int k = 0; n->pass->tables[k].table; k++) {
        const ssfr_lookup_use *use = &n->pass->tables[k];
        stored_table *t = find(graph, use->table);
        n->run.tables[k] = NULL;
        if (!is_read(use, n->params)) continue;
        if (!t) SSFR_TRY(make(graph, use->table, &t));
        n->run.tables[k] = &t->texels;
        if (graph->gl) glBindTextureUnit((GLuint)(SSFR_UNIT_TABLES + k), t->texture);
    }
end:
    return result;
}

void ssfr_tables_finish(ssfr_graph *graph)
{
    for (int i = 0; i < graph->n_tables; i++) {
        ssfr_texels_finish(&graph->tables[i].texels);
        if (graph->gl) ssfr_lookup_destroy(&graph->tables[i].texture);
    }
    graph->n_tables = 0;
}

/* SPDX-License-Identifier: MIT */
/* memory.c: the images and tables that a graph holds: what they are, and how much memory they take. */
#include "graph/internal.h"

typedef struct search { /* of the i-th that is there */
    int left;
    ssfr_memory *out;
    double bytes; /* of all that were passed */
    bool found;
} search;

static void note(search *s, const ssfr_memory *m)
{
    if (s->found || m->bytes == 0) return;
    s->bytes += m->bytes;
    if (s->left-- != 0) return;
    *s->out = *m;
    s->found = true;
}

/* The CPU has doubles, and three channels as three; the GPU four. */
static const char *format_of(const image *im)
{
    static const char *const doubles[] = {"R64F", "RG64F", "RGB64F", "RGBA64F"};
    static const char *const stored[2][4] = {[SSFR_STORE_FLOAT] = {"R32F", "RG32F", "RGBA32F", "RGBA32F"},
                                             [SSFR_STORE_HALF] = {"R16F", "RG16F", "RGBA16F", "RGBA16F"}};
    return im->field ? doubles[im->c - 1] : stored[im->storage][im->c - 1];
}

/* The host's own images are not held by the graph. */
static double bytes_of(const image *im)
{
    if (im->field) return (double)sizeof(double) * im->w * im->h * im->c;
    if (!im->texture.name || im->texture.borrowed) return 0;
    return ssfr_channel_bytes(im->storage) * im->w * im->h * (im->c == 3 ? 4 : im->c);
}

static void note_image(search *s, const image *im, const char *name, const char *node, const char *kind)
{
    const double bytes = bytes_of(im);
    if (bytes > 0)
        note(s, &(ssfr_memory){.name = name, .node = node, .kind = kind, .w = im->w, .h = im->h, .d = 1, .c = im->c,
                               .format = format_of(im), .bytes = bytes});
}

static void note_node(search *s, const ssfr_graph *graph, const node *n)
{
    for (int k = 0; k < n->n_out; k++) {
        const resource *r = &graph->resources[n->out[k]];
        note_image(s, &r->own, ssfr_slots[r->slot].name, n->name, "image");
    }
    for (int k = 0; k < n->pass->n_scratch; k++)
        note_image(s, &n->scratch[k], ssfr_slots[graph->resources[n->out[0]].slot].name, n->name, "scratch");
}

static void note_table(search *s, const ssfr_lookup *t)
{
    static const char *const stored[2][4] = {[SSFR_LOOKUP_FLOAT] = {"R32F", "RG32F", "RGB32F", "RGBA32F"},
                                             [SSFR_LOOKUP_UNORM8] = {"R8", "RG8", "RGB8", "RGBA8"}};
    note(s, &(ssfr_memory){.name = t->name, .node = "", .kind = "table", .w = t->w, .h = t->h, .d = t->d, .c = t->c,
                           .format = stored[t->store][t->c - 1], .bytes = (double)ssfr_lookup_bytes(t)});
}

static void visit(search *s, const ssfr_graph *graph)
{
    const image environment = {.w = graph->environment.w, .h = graph->environment.h, .c = 3,
                               .texture = graph->environment};
    for (int i = 0; i < graph->n_nodes; i++) note_node(s, graph, &graph->nodes[i]);
    for (int i = 0; i < graph->n_resources; i++) {
        const resource *r = &graph->resources[i];
        note_image(s, &r->given, ssfr_slots[r->slot].name, "", "given");
    }
    for (int i = 0; i < graph->n_tables; i++) note_table(s, graph->tables[i].texels.table);
    note_image(s, &environment, "environment", "", "environment");
}

bool ssfr_graph_memory_at(const ssfr_graph *graph, int i, ssfr_memory *out)
{
    search s = {.left = i, .out = out};
    visit(&s, graph);
    return s.found;
}

double ssfr_memory_bytes(const ssfr_graph *graph)
{
    search s = {.left = -1};
    visit(&s, graph);
    return s.bytes;
}

/* SPDX-License-Identifier: MIT */
/* internal.h: the graph's own structures, shared by graph.c (what it is), exchange.c (what it is given and asked for),
 * values.c (values of particles), tables.c (constant tables), memory.c (what is allocated), plan.c (what to leave out)
 * and run.c (doing it).
 *
 *      nodes    in execution order, each with its pass, parameters and the resources it reads and writes
 *      resource one version of a slot: written by one node, or from outside
 *      image    the memory behind a resource: a field (CPU) or a texture (GPU) */
#ifndef SSFR_GRAPH_INTERNAL_H
#define SSFR_GRAPH_INTERNAL_H

#include "gl/gl.h"
#include "graph/draw.h"
#include "graph/graph.h"

enum { SSFR_MAX_NODES = 32, SSFR_MAX_RESOURCES = 96, SSFR_MAX_UNIFORMS = 24, SSFR_MAX_GRAPH_TABLES = 8 };

typedef struct image {
    int w, h, c;
    ssfr_storage storage; /* of the texture; a field holds doubles, rounded to it */
    ssfr_field *field;
    ssfr_texture texture;
} image;

typedef struct particle_values { /* of a particle slot */
    float *memory;       /* what its node wrote */
    size_t capacity;     /* floats */
    uint64_t written;    /* which contents that is; 0: all neutral */
    size_t n_written;
    /* of the frame being run */
    ssfr_values now;
    uint64_t key;        /* which contents; 0: the neutral value */
    double largest;
    uint64_t largest_key; /* whose largest value that is */
    bool is_counted;
    size_t n_seen;       /* particles in view with a value that is not 0 */
    /* ssfr_values_lend */
    const float *lent;
    uint64_t lent_key;
    /* GL */
    unsigned buffer;
    size_t cap_buffer;   /* floats */
    uint64_t buffer_key; /* which contents the buffer holds */
} particle_values;

typedef struct stored_table {
    ssfr_texels texels; /* on the GPU without data */
    unsigned texture;
} stored_table;

typedef struct resource {
    ssfr_slot_id slot;
    int writer;     /* node, -1: nobody in this pipeline */
    bool asked;     /* the caller wants it */
    bool is_given;  /* the caller brings it */
    image own, given;
    particle_values values;
    double nearest, mean, farthest; /* m, of a given depth's surface; 0: not known */
    /* of the frame being run */
    bool wanted;
    int divisor;    /* of the frame's resolution, 0: a map */
    int w, h;       /* px, of a map; else 1 */
    int from;       /* the resource that stands in for it, -1: none */
    bool is_spared; /* its node runs and does not make it */
    const image *image;
} resource;

typedef struct played { /* what a particle node ran for last */
    bool is, timed;
    double time; /* s */
    uint64_t serial, in[SSFR_MAX_VALUES];
} played;

typedef struct node {
    const ssfr_node *def;
    const ssfr_pass *pass;
    char name[64];
    void *params, *coeffs, *state;
    int off;
    int n_in, n_out;
    int in[SSFR_MAX_PORTS], out[SSFR_MAX_OUTPUTS]; /* resources */
    int divisor_out[SSFR_MAX_OUTPUTS];             /* of what the node itself writes */
    image scratch[SSFR_MAX_SCRATCH];
    uint32_t *words;      /* lent to its run */
    unsigned word_buffer; /* GL */
    size_t cap_words, cap_word_buffer;
    unsigned programs[SSFR_MAX_PROGRAMS];
    char defines[SSFR_MAX_PROGRAMS][SSFR_DEFINES]; /* that they were made with, beside those of their rows */
    int locations[SSFR_MAX_PROGRAMS][SSFR_MAX_UNIFORMS];
    ssfr_run run;
    ssfr_draw draw;
    /* of a particle node */
    bool read;               /* somebody may want what it writes */
    played played;
    bool kept;               /* it ran for this frame before */
    ssfr_node_status status; /* in the frame being run */
    const char *why;
    double ms;               /* when it ran last */
} node;

typedef struct host_buffer { /* positions in the host's memory */
    unsigned buffer;
    size_t n, stride, first;
    double origin[3], radius;
} host_buffer;

struct ssfr_graph {
    const ssfr_pipeline *pipeline;
    ssfr_pipeline *single; /* of a one-node graph, owned */
    ssfr_gl *gl;           /* NULL: CPU twins */
    ssfr_world world;
    int n_nodes, n_resources, n_keys;
    node nodes[SSFR_MAX_NODES];
    resource resources[SSFR_MAX_RESOURCES];
    int last[SSFR_N_SLOTS]; /* the last version of each slot, -1: not in this pipeline */
    image neutral[SSFR_N_SLOTS];
    float neutral_values[SSFR_N_SLOTS][4];
    unsigned neutral_buffers[SSFR_N_SLOTS];
    bool want_all;
    char **keys;
    ssfr_frame frame;
    host_buffer host;
    ssfr_texture exported;
    bool has_objects; /* of GL */
    /* GL buffers */
    unsigned position, ids, offsets, tiles, block, quads, samples;
    unsigned solid_tiles, tiles_by_solids, nodes_of_meshes, triangles;
    ssfr_texture environment;
    int n_tables;
    stored_table tables[SSFR_MAX_GRAPH_TABLES];
    unsigned copy;    /* program */
    unsigned sampler; /* for images of the host, whatever their own filters are */
    size_t cap_offsets, cap_tiles, cap_solid_tiles, cap_by_solids; /* entries */
    uint64_t serial, id_serial;    /* of the particles that the buffers hold */
    int n_meshes;
    uint64_t mesh_serials[SSFR_MAX_SOLIDS]; /* of the meshes that the buffers hold */
    uint64_t environment_key;      /* of the map that the texture holds */
    uint64_t n_written;            /* contents of particle slots so far */
    ssfr_timers timers;
    long grew;                     /* allocations of the run in progress */
    bool ran;
    ssfr_report report;
    ssfr_node_report reports[SSFR_MAX_NODES];
};

/* Decides what runs: sets each node's status and each resource's image source. The frame's facts must stand. Fails when
 * what is given does not fit the frame, or when a pass would read an image of another resolution than it works at. */
SSFR_MUST ssfr_result ssfr_plan(ssfr_graph *graph, bool keep_all);

/* Before the plan: runs the particle nodes that somebody may read, and gives all nodes their values. The frame must
 * stand, for its particles. */
SSFR_MUST ssfr_result ssfr_values_run(ssfr_graph *graph, bool keep_all);
/* Counts the particles in view that have a value, once the frame's facts are final. */
void ssfr_values_count(ssfr_graph *graph);
/* What a resource of values that no node writes holds in the frames that follow, of each of their particles in the
 * packed order. They stay the caller's. NULL: what the scene brings, or the neutral value. */
void ssfr_values_lend(ssfr_graph *graph, int index, const float *data);
/* The largest value of a slot, all particles counted. */
double ssfr_values_largest(resource *r);
/* The node's history ends: a parameter has changed. */
void ssfr_values_forget(ssfr_graph *graph, const void *params);
void ssfr_values_finish(ssfr_graph *graph);
static inline bool ssfr_slot_is_particles(ssfr_slot_id slot) { return ssfr_slots[slot].kind == SSFR_PARTICLES; }
static inline bool ssfr_slot_is_map(ssfr_slot_id slot) { return ssfr_slots[slot].kind == SSFR_MAP; }
/* The index of the j-th port of `ports` that carries values of particles, -1 past the last. */
int ssfr_port_of_values(const ssfr_port *ports, int j);

/* An image of this size and kind; remade only when it differs. */
SSFR_MUST ssfr_result ssfr_image_ensure(ssfr_graph *graph, image *im, int w, int h, int c, ssfr_storage storage);
void ssfr_image_finish(image *im);

/* What the GPU stores a node's outputs in. */
static inline ssfr_storage ssfr_node_storage(const node *n)
{
    return n->pass->storage ? n->pass->storage(n->params) : SSFR_STORE_FLOAT;
}

/* Bytes of a channel of a pixel on the GPU. */
static inline double ssfr_channel_bytes(ssfr_storage storage)
{
    return storage == SSFR_STORE_HALF ? 2 : sizeof(float);
}
/* What all memory of ssfr_graph_memory_at holds. */
double ssfr_memory_bytes(const ssfr_graph *graph);

/* Makes what tables the node reads are not there yet, and gives them to it; the GPU's are bound. */
SSFR_MUST ssfr_result ssfr_tables_ready(ssfr_graph *graph, node *n);
void ssfr_tables_finish(ssfr_graph *graph);

/* Makes program i of a node with these lines after #version, or those of its row where they are empty. */
SSFR_MUST ssfr_result ssfr_node_program(ssfr_graph *graph, node *n, int i, const char *defines);

/* Whether a node reads its k-th input. */
static inline bool ssfr_node_reads(const node *n, int k)
{
    return !n->pass->reads || n->pass->reads(n->params, k);
}
/* Marks those as wanted. */
void ssfr_node_want_inputs(ssfr_graph *graph, const node *n);

/* The index of a port, -1 when there is none of that name or the name is NULL. */
int ssfr_port_find(const ssfr_port *ports, const char *name);

/* How far the splats of any node that is not off reach, in particle radii; 0 without one. by_values: with the largest
 * of the frame's values that widen them, where these are over the neutral ones. */
double ssfr_graph_reach(ssfr_graph *graph, bool by_values);

#endif

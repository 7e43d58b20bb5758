/* SPDX-License-Identifier: MIT */
/* internal.h: the graph's own structures, shared by graph.c (what it is), exchange.c (what it is given and asked for),
 * plan.c (what to leave out) and run.c (doing it).
 *
 *      nodes    in execution order, each with its pass, parameters and the resources it reads and writes
 *      resource one version of a slot: written by one node, or from outside
 *      image    the memory behind a resource: a field (CPU) or a texture (GPU) */
#ifndef SSFR_GRAPH_INTERNAL_H
#define SSFR_GRAPH_INTERNAL_H

#include "gl/gl.h"
#include "graph/draw.h"
#include "graph/graph.h"

enum { SSFR_MAX_NODES = 32, SSFR_MAX_RESOURCES = 96, SSFR_MAX_UNIFORMS = 24 };

typedef struct image {
    int w, h, c;
    ssfr_field *field;
    ssfr_texture texture;
} image;

typedef struct resource {
    ssfr_slot_id slot;
    int writer;     /* node, -1: nobody in this pipeline */
    bool asked;     /* the caller wants it */
    bool is_given;  /* the caller brings it */
    image own, given;
    double nearest, mean; /* m, of a given depth's surface; 0: not known */
    /* of the frame being run */
    bool wanted;
    int divisor;    /* of the frame's resolution */
    int from;       /* the resource that stands in for it, -1: none */
    const image *image;
} resource;

typedef struct node {
    const ssfr_node *def;
    const ssfr_pass *pass;
    char name[64];
    void *params, *coeffs;
    int off;
    int n_in, n_out;
    int in[SSFR_MAX_PORTS], out[SSFR_MAX_OUTPUTS]; /* resources */
    int divisor_out[SSFR_MAX_OUTPUTS];             /* of what the node itself writes */
    image scratch[SSFR_MAX_SCRATCH];
    unsigned programs[SSFR_MAX_PROGRAMS];
    char defines[SSFR_MAX_PROGRAMS][SSFR_DEFINES]; /* that they were made with, beside those of their rows */
    int locations[SSFR_MAX_PROGRAMS][SSFR_MAX_UNIFORMS];
    ssfr_run run;
    ssfr_draw draw;
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
    unsigned copy;    /* program */
    unsigned sampler; /* for images of the host, whatever their own filters are */
    size_t cap_offsets, cap_tiles, cap_solid_tiles, cap_by_solids; /* entries */
    uint64_t serial, id_serial;    /* of the particles that the buffers hold */
    int n_meshes;
    uint64_t mesh_serials[SSFR_MAX_SOLIDS]; /* of the meshes that the buffers hold */
    uint64_t environment_key;      /* of the map that the texture holds */
    ssfr_timers timers;
    long grew;                     /* allocations of the run in progress */
    bool ran;
    ssfr_report report;
    ssfr_node_report reports[SSFR_MAX_NODES];
};

/* Decides what runs: sets each node's status and each resource's image source. The frame's facts must stand. Fails when
 * what is given does not fit the frame, or when a pass would read an image of another resolution than it works at. */
SSFR_MUST ssfr_result ssfr_plan(ssfr_graph *graph, bool keep_all);

/* An image of this size and kind; remade only when it differs. */
SSFR_MUST ssfr_result ssfr_image_ensure(ssfr_graph *graph, image *im, int w, int h, int c);
void ssfr_image_finish(image *im);

/* Makes program i of a node with these lines after #version, or those of its row where they are empty. */
SSFR_MUST ssfr_result ssfr_node_program(ssfr_graph *graph, node *n, int i, const char *defines);

/* The index of a port, -1 when there is none of that name or the name is NULL. */
int ssfr_port_find(const ssfr_port *ports, const char *name);

/* How far the splats of any node that is not off reach, in particle radii; 0 without one. */
double ssfr_graph_reach(const ssfr_graph *graph);

#endif

/* SPDX-License-Identifier: MIT */
/* graph.h: the graph from inside the library: one-node graphs, and the ports of a pass. */
#ifndef SSFR_GRAPH_H
#define SSFR_GRAPH_H

#include "graph/pass.h"

/* A graph of one node, the pass by itself. Its slots answer to the names of the pass's ports as well. */
SSFR_MUST ssfr_result ssfr_graph_create_for_pass(ssfr_graph **out, const ssfr_pass *pass, ssfr_gl *gl);

/* What the CPU twin of the i-th node had in the last frame: parameters, coefficients, inputs, outputs; the graph's
 * until it runs again. NULL for a node that was left out, past the end and on the GPU. */
const ssfr_run *ssfr_graph_last_run(const ssfr_graph *graph, int i);

/* Whether the graph has the slot, of an image or of values of particles, from a node or from outside. */
bool ssfr_graph_has_slot(const ssfr_graph *graph, ssfr_slot_id slot);

/* The name of the i-th input or output port of a pass, NULL past the end. */
const char *ssfr_pass_input(const ssfr_pass *pass, int i);
const char *ssfr_pass_output(const ssfr_pass *pass, int i);

#endif

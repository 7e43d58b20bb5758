/* SPDX-License-Identifier: MIT */
/* graph.h: the graph from inside the library: one-node graphs, and node access for tools that look at passes. */
#ifndef SSFR_GRAPH_H
#define SSFR_GRAPH_H

#include "graph/pass.h"

/* A graph of one node, the pass by itself. Its slots answer to the names of the pass's ports as well. */
SSFR_MUST ssfr_result ssfr_graph_create_for_pass(ssfr_graph **out, const ssfr_pass *pass, ssfr_gl *gl);

/* The i-th input or output port of a pass, NULL past the end, and its slot's name. */
const char *ssfr_pass_input(const ssfr_pass *pass, int i);
const char *ssfr_pass_output(const ssfr_pass *pass, int i);

#endif

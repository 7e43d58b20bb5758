/* SPDX-License-Identifier: MIT */
/* plan.c: one walk forward for resolutions, one backward for what is wanted. */
#include "graph/internal.h"

int ssfr_port_find(const ssfr_port *ports, const char *name)
{
    int found = -1;
    for (int i = 0; name && ports[i].name && found < 0; i++)
        if (strcmp(ports[i].name, name) == 0) found = i;
    return found;
}

static void set_divisors(ssfr_graph *graph, node *n)
{
    const ssfr_pass *pass = n->pass;
    n->run.params = n->params, n->run.coeffs = n->coeffs, n->run.frame = &graph->frame;
    n->run.divisor_in = n->n_in ? graph->resources[n->in[0]].divisor : 1;
    for (int k = 0; k < n->n_out; k++) {
        const int like = ssfr_port_find(pass->inputs, pass->outputs[k].like), from = ssfr_port_find(pass->inputs, pass->outputs[k].from);
        int divisor = like >= 0 ? graph->resources[n->in[like]].divisor : 1;
        if (n->off) divisor = from >= 0 ? graph->resources[n->in[from]].divisor : 1;
        else if (pass->shrink) divisor *= pass->shrink(n->params);
        if (!graph->resources[n->out[k]].is_given) graph->resources[n->out[k]].divisor = divisor;
    }
    n->run.divisor = n->n_out ? graph->resources[n->out[0]].divisor : 1;
    n->run.w = (graph->frame.w + n->run.divisor - 1) / n->run.divisor;
    n->run.h = (graph->frame.h + n->run.divisor - 1) / n->run.divisor;
}

/* The outputs of a node that does not run: what it read, or the neutral value. */
static void stand_in(ssfr_graph *graph, const node *n)
{
    for (int k = 0; k < n->n_out; k++) {
        resource *out = &graph->resources[n->out[k]];
        const int from = ssfr_port_find(n->pass->inputs, n->pass->outputs[k].from);
        if (from < 0) continue;
        out->from = n->in[from];
        if (out->wanted && !out->is_given) graph->resources[out->from].wanted = true;
    }
}

static ssfr_node_status decide(const ssfr_graph *graph, const node *n, bool keep_all, const char **why)
{
    int n_wanted = 0, n_given = 0;
    for (int k = 0; k < n->n_out; k++) {
        const resource *out = &graph->resources[n->out[k]];
        n_given += out->is_given;
        n_wanted += out->wanted && !out->is_given;
    }
    *why = "";
    if (n->off) return *why = "switched off", SSFR_OFF;
    if (n_given == n->n_out) return *why = "its outputs are given", SSFR_GIVEN;
    if (keep_all) return SSFR_RAN;
    if (!n_wanted) return *why = "nobody reads what it writes", SSFR_UNWANTED;
    if (n->pass->needed && !n->pass->needed(&n->run)) return *why = n->pass->needless, SSFR_NEEDLESS;
    return SSFR_RAN;
}

static const image *source(const ssfr_graph *graph, int index)
{
    const resource *r = &graph->resources[index];
    while (!r->is_given && r->from >= 0) r = &graph->resources[r->from];
    if (r->is_given) return &r->given;
    if (r->writer >= 0 && graph->reports[r->writer].status == SSFR_RAN) return &r->own;
    return &graph->neutral[r->slot];
}

/* A given image may be of low resolution. */
static int given_divisor(const ssfr_graph *graph, const resource *r)
{
    return r->is_given && r->given.w < graph->frame.w ? (graph->frame.w + r->given.w - 1) / r->given.w : 1;
}

void ssfr_plan(ssfr_graph *graph, bool keep_all)
{
    for (int i = 0; i < graph->n_resources; i++) {
        resource *r = &graph->resources[i];
        r->wanted = r->asked || graph->want_all;
        r->from = -1;
        r->divisor = given_divisor(graph, r);
    }
    for (int i = 0; i < graph->n_nodes; i++) set_divisors(graph, &graph->nodes[i]);
    for (int i = graph->n_nodes - 1; i >= 0; i--) {
        const node *n = &graph->nodes[i];
        ssfr_node_report *report = &graph->reports[i];
        *report = (ssfr_node_report){.node = n->name, .pass = n->pass->name, .ms = NAN};
        report->status = decide(graph, n, keep_all, &report->why);
        if (report->status == SSFR_RAN) {
            for (int k = 0; k < n->n_in; k++) graph->resources[n->in[k]].wanted = true;
        } else {
            stand_in(graph, n);
        }
    }
    for (int i = 0; i < graph->n_resources; i++) graph->resources[i].image = source(graph, i);
}

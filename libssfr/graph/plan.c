/* SPDX-License-Identifier: MIT */
/* plan.c: one walk forward for resolutions, one backward for what is wanted, one forward for what fits. */
#include "graph/internal.h"

int ssfr_port_find(const ssfr_port *ports, const char *name)
{
    int found = -1;
    for (int i = 0; name && ports[i].name && found < 0; i++)
        if (strcmp(ports[i].name, name) == 0) found = i;
    return found;
}

/* ---- resolutions ------------------------------------------------------------------------------------------------- */

static bool is_one_pixel(const image *im)
{
    return im->w == 1 && im->h == 1;
}

/* A given image may be of low resolution, by a power of two that divides the tiles. One pixel serves the whole frame,
 * but not as the fluid's depth, which may be the image that is scaled. 0: it does not fit. */
static int given_divisor(const ssfr_graph *graph, const resource *r)
{
    const int w = graph->frame.w, h = graph->frame.h;
    int divisor = 0;
    if (is_one_pixel(&r->given) && !ssfr_slot_is_fluid(r->slot)) return 1;
    for (int d = SSFR_TILE; d >= 1; d /= 2)
        if (r->given.w == (w + d - 1) / d && r->given.h == (h + d - 1) / d) divisor = d;
    return divisor;
}

static ssfr_result start(ssfr_graph *graph, resource *r)
{
    const bool is_map = ssfr_slot_is_map(r->slot);
    r->wanted = r->asked || graph->want_all;
    r->from = -1;
    r->is_spared = false;
    r->w = is_map && r->is_given ? r->given.w : 1, r->h = is_map && r->is_given ? r->given.h : 1;
    r->divisor = is_map ? 0 : r->is_given ? given_divisor(graph, r) : 1;
    if (!r->divisor && !is_map)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %d x %d pixels given, the frame has %d x %d", ssfr_slots[r->slot].name,
                         r->given.w, r->given.h, graph->frame.w, graph->frame.h);
    return SSFR_OK;
}

static int divisor_of_input(const ssfr_graph *graph, const node *n, const char *port)
{
    const int k = ssfr_port_find(n->pass->inputs, port);
    return k >= 0 ? graph->resources[n->in[k]].divisor : 1;
}

/* Off, a map is one neutral pixel. */
static void set_size(ssfr_graph *graph, node *n)
{
    const resource *first = n->n_in ? &graph->resources[n->in[0]] : NULL;
    const int in[2] = {first ? first->w : 1, first ? first->h : 1};
    int size[2] = {1, 1};
    if (!n->off) n->pass->size(n->params, in, size);
    n->run.divisor = 1;
    n->run.w = size[0], n->run.h = size[1];
    for (int k = 0; k < n->n_out; k++) {
        resource *out = &graph->resources[n->out[k]];
        if (!out->is_given) out->w = size[0], out->h = size[1];
    }
}

static void set_divisors(ssfr_graph *graph, node *n)
{
    const ssfr_pass *pass = n->pass;
    n->run.params = n->params, n->run.coeffs = n->coeffs, n->run.frame = &graph->frame;
    for (int k = 0; k < n->n_in; k++) n->run.divisor_in[k] = graph->resources[n->in[k]].divisor;
    if (pass->size) {
        set_size(graph, n);
        return;
    }
    for (int k = 0; k < n->n_out; k++) {
        resource *out = &graph->resources[n->out[k]];
        n->divisor_out[k] = divisor_of_input(graph, n, n->off ? pass->outputs[k].from : pass->outputs[k].like);
        if (pass->shrink && !n->off) n->divisor_out[k] *= pass->shrink(n->params);
        if (!out->is_given) out->divisor = n->divisor_out[k];
    }
    n->run.divisor = n->n_out ? n->divisor_out[0] : 1;
    n->run.w = (graph->frame.w + n->run.divisor - 1) / n->run.divisor;
    n->run.h = (graph->frame.h + n->run.divisor - 1) / n->run.divisor;
}

/* ---- what runs --------------------------------------------------------------------------------------------------- */

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
    int n_wanted = 0, n_open = 0;
    if (n->pass->particles_run) return *why = n->why, n->status;
    for (int k = 0; k < n->n_out; k++) {
        const resource *out = &graph->resources[n->out[k]];
        n_open += !out->is_given && (out->wanted || !n->pass->outputs[k].optional);
        n_wanted += out->wanted && !out->is_given;
    }
    *why = "";
    if (n->off) return *why = "switched off", SSFR_OFF;
    if (!n_open) return *why = "its outputs are given", SSFR_GIVEN;
    if (keep_all) return SSFR_RAN;
    if (!n_wanted) return *why = "nobody reads what it writes", SSFR_UNWANTED;
    if (n->pass->needed && !n->pass->needed(&n->run)) return *why = n->pass->needless, SSFR_NEEDLESS;
    return SSFR_RAN;
}

void ssfr_node_want_inputs(ssfr_graph *graph, const node *n)
{
    for (int k = 0; k < n->n_in; k++)
        if (ssfr_node_reads(n, k)) graph->resources[n->in[k]].wanted = true;
}

/* Optional outputs stand last: those after the last that is wanted are left out. */
static void leave_out_outputs(ssfr_graph *graph, node *n, bool keep_all)
{
    n->run.n_out = 0;
    for (int k = 0; k < n->n_out; k++) {
        const resource *out = &graph->resources[n->out[k]];
        if (!n->pass->outputs[k].optional || (out->wanted && !out->is_given) || keep_all) n->run.n_out = k + 1;
    }
    for (int k = 0; k < n->n_out; k++) graph->resources[n->out[k]].is_spared = k >= n->run.n_out;
}

/* Last node first, so that each is decided when all its readers are. */
static void decide_all(ssfr_graph *graph, bool keep_all)
{
    for (int i = graph->n_nodes - 1; i >= 0; i--) {
        node *n = &graph->nodes[i];
        ssfr_node_report *report = &graph->reports[i];
        *report = (ssfr_node_report){.node = n->name, .pass = n->pass->name, .ms = NAN,
                                     .stage = n->def->stage ? n->def->stage : ""};
        report->status = decide(graph, n, keep_all, &report->why);
        if (report->status == SSFR_RAN) {
            ssfr_node_want_inputs(graph, n);
            leave_out_outputs(graph, n, keep_all);
        } else {
            stand_in(graph, n);
        }
    }
}

/* ---- what is read ------------------------------------------------------------------------------------------------ */

/* The image of a resource; *divisor is its resolution, 0 for one pixel that serves all and for maps. */
static const image *source(const ssfr_graph *graph, int index, int *divisor)
{
    const resource *r = &graph->resources[index];
    while (!r->is_given && r->from >= 0) r = &graph->resources[r->from];
    const bool ran = r->writer >= 0 && graph->reports[r->writer].status == SSFR_RAN && !r->is_spared;
    const image *im = r->is_given ? &r->given : ran ? &r->own : &graph->neutral[r->slot];
    *divisor = ran && !r->is_given ? r->divisor : is_one_pixel(im) ? 0 : r->divisor;
    return im;
}

/* First node first, for what is read decides what is written. */
static void spare_outputs(ssfr_graph *graph, node *n, bool keep_all)
{
    for (int k = 0; k < n->n_in; k++) {
        int divisor;
        const resource *r = &graph->resources[n->in[k]];
        n->run.is_neutral[k] = !ssfr_node_reads(n, k) ||
                               source(graph, n->in[k], &divisor) == &graph->neutral[r->slot];
    }
    if (n->pass->n_needed && !keep_all)
        n->run.n_out = ssfr_min_int(n->run.n_out, n->pass->n_needed(&n->run));
    for (int k = n->run.n_out; k < n->n_out; k++) graph->resources[n->out[k]].is_spared = true;
}

/* The resolution of what a node reads; 0 fits all, as does what nobody made because this node is needless. */
static int divisor_read(const ssfr_graph *graph, int index)
{
    const resource *r = &graph->resources[index];
    int divisor;
    source(graph, index, &divisor);
    const bool unwanted = r->writer >= 0 && graph->reports[r->writer].status == SSFR_UNWANTED && !r->is_given;
    return unwanted ? 0 : divisor;
}

/* A pass reads its inputs pixel by pixel: they have its own resolution, unless it says that it scales. */
static ssfr_result check_inputs(const ssfr_graph *graph, const node *n)
{
    for (int k = 0; k < n->n_in; k++) {
        const ssfr_port *in = &n->pass->inputs[k];
        if (ssfr_slot_is_particles(in->slot) || !ssfr_node_reads(n, k)) continue;
        const int divisor = divisor_read(graph, n->in[k]);
        const bool scales = in->any_size && (n->pass->shrink || divisor > n->run.divisor);
        if (divisor && divisor != n->run.divisor && !scales)
            return ssfr_fail(SSFR_ERR_VALUE, "%s: %s has 1/%d of the frame's resolution, the pass works at 1/%d",
                             n->name, in->name, divisor, n->run.divisor);
    }
    return SSFR_OK;
}

/* Screen passes draw tiles: at a lower resolution a tile has no whole pixel. */
static ssfr_result check_resolution(const node *n)
{
    if (n->run.divisor > SSFR_TILE)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: 1/%d of the frame's resolution, the lowest is 1/%d", n->name,
                         n->run.divisor, SSFR_TILE);
    return SSFR_OK;
}

/* What is given in particle radii would be 0 m without one: a flow would smooth nothing and not say so. */
static ssfr_result check_radius(const ssfr_graph *graph, const node *n)
{
    if (graph->frame.radius > 0 || !graph->frame.facts.fluid) return SSFR_OK;
    for (const ssfr_param *row = n->pass->params; row && row->name; row++)
        if (strcmp(row->unit, "radii") == 0 && ssfr_param_number(row, n->params) != 0)
            return ssfr_fail(SSFR_ERR_VALUE, "%s.%s=%g is in particle radii, and the scene's particles tell no radius",
                             n->name, row->name, ssfr_param_number(row, n->params));
    return SSFR_OK;
}

static ssfr_result check_node(const ssfr_graph *graph, int i)
{
    ssfr_result result = SSFR_OK;
    const node *n = &graph->nodes[i];
    const ssfr_node_status status = graph->reports[i].status;
    if (status != SSFR_RAN && status != SSFR_NEEDLESS) return SSFR_OK;
    SSFR_TRY(check_inputs(graph, n));
    SSFR_TRY(check_resolution(n));
    if (status == SSFR_RAN) SSFR_TRY(check_radius(graph, n));
end:
    return result;
}

ssfr_result ssfr_plan(ssfr_graph *graph, bool keep_all)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < graph->n_resources; i++) SSFR_TRY(start(graph, &graph->resources[i]));
    for (int i = 0; i < graph->n_nodes; i++) set_divisors(graph, &graph->nodes[i]);
    decide_all(graph, keep_all);
    for (int i = 0; i < graph->n_nodes; i++) spare_outputs(graph, &graph->nodes[i], keep_all);
    for (int i = 0; i < graph->n_resources; i++) {
        int divisor;
        graph->resources[i].image = source(graph, i, &divisor);
    }
    for (int i = 0; i < graph->n_nodes; i++) SSFR_TRY(check_node(graph, i));
end:
    return result;
}

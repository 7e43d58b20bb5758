/* SPDX-License-Identifier: MIT */
/* values.c: values of particles: the nodes that compute them, before the plan, and what these keep between frames. */
#include "graph/internal.h"

int ssfr_port_of_values(const ssfr_port *ports, int j)
{
    int found = -1;
    for (int k = 0; ports[k].name && found < 0; k++)
        if (ssfr_slot_is_particles(ports[k].slot) && j-- == 0) found = k;
    return found;
}

/* ---- who is read ------------------------------------------------------------------------------------------------- */

static void want_inputs(ssfr_graph *graph, const node *n)
{
    for (int k = 0; k < n->n_in; k++) graph->resources[n->in[k]].wanted = true;
}

/* What stands in for the outputs of a node that is off. */
static void want_stand_ins(ssfr_graph *graph, const node *n)
{
    for (int k = 0; k < n->n_out; k++) {
        const int from = ssfr_port_find(n->pass->inputs, n->pass->outputs[k].from);
        if (from >= 0 && graph->resources[n->out[k]].wanted) graph->resources[n->in[from]].wanted = true;
    }
}

/* The walk of the plan, but that every node may be needed: what decides it are the values that are not there yet. */
static void find_readers(ssfr_graph *graph, bool keep_all)
{
    for (int i = 0; i < graph->n_resources; i++)
        graph->resources[i].wanted = graph->resources[i].asked || graph->want_all;
    for (int i = graph->n_nodes - 1; i >= 0; i--) {
        node *n = &graph->nodes[i];
        bool read = false, open = false;
        for (int k = 0; k < n->n_out; k++) {
            const resource *out = &graph->resources[n->out[k]];
            read |= out->wanted && !out->is_given;
            open |= !out->is_given;
        }
        n->read = read || (keep_all && open);
        if (n->off) want_stand_ins(graph, n);
        else if (n->read) want_inputs(graph, n);
    }
}

/* ---- what a slot holds ------------------------------------------------------------------------------------------- */

/* Of contents that there have not been: no serial of particles gets that far. */
static uint64_t new_key(ssfr_graph *graph)
{
    return UINT64_C(1) << 63 | ++graph->n_written;
}

static void hold_neutral(const ssfr_graph *graph, resource *r)
{
    const ssfr_slot *slot = &ssfr_slots[r->slot];
    r->values.now = (ssfr_values){1, slot->channels, true, graph->neutral_values[r->slot]};
    r->values.key = 0;
}

/* An array of the scene's particles, NULL when there is none. */
static const float *find_brought(const ssfr_particles *particles, ssfr_slot_id slot)
{
    switch (slot) {
    case SSFR_SLOT_velocity: return particles->velocity;
    case SSFR_SLOT_density: return particles->density;
    default: return NULL;
    }
}

static void hold_brought(const ssfr_graph *graph, resource *r)
{
    const ssfr_particles *p = graph->frame.particles;
    particle_values *v = &r->values;
    const float *data = !p ? NULL : v->lent ? v->lent : find_brought(p, r->slot);
    if (!data) return;
    v->now = (ssfr_values){p->n, ssfr_slots[r->slot].channels, false, data};
    v->key = v->lent ? v->lent_key : p->serial;
}

void ssfr_values_lend(ssfr_graph *graph, int index, const float *data)
{
    particle_values *v = &graph->resources[index].values;
    v->lent = data;
    v->lent_key = new_key(graph);
}

static void hold_written(const ssfr_graph *graph, resource *r)
{
    particle_values *v = &r->values;
    hold_neutral(graph, r);
    if (!v->written) return;
    v->now = (ssfr_values){v->n_written, ssfr_slots[r->slot].channels, false, v->memory};
    v->key = v->written;
}

/* Of a node that did not run: what it read, or the neutral value. */
static void hold_stand_in(ssfr_graph *graph, const node *n, int k)
{
    resource *out = &graph->resources[n->out[k]];
    const int from = ssfr_port_find(n->pass->inputs, n->pass->outputs[k].from);
    hold_neutral(graph, out);
    if (from < 0) return;
    const particle_values *in = &graph->resources[n->in[from]].values;
    out->values.now = in->now, out->values.key = in->key;
}

double ssfr_values_largest(resource *r)
{
    particle_values *v = &r->values;
    const size_t n = v->now.n * (size_t)v->now.c;
    const float *data = v->now.data;
    double largest = -INFINITY;
    if (v->now.same) return ssfr_slots[r->slot].neutral;
    if (v->largest_key == v->key) return v->largest;
#pragma omp parallel for schedule(static) reduction(max : largest)
    for (size_t i = 0; i < n; i++) largest = fmax(largest, (double)data[i]);
    v->largest_key = v->key;
    return v->largest = largest;
}

static size_t count_seen(const ssfr_frame *frame, const ssfr_values *values)
{
    size_t n = 0;
    for (int k = 0; k < frame->facts.n_ranges; k++) {
        const size_t first = (size_t)frame->facts.first[k], end = first + (size_t)frame->facts.count[k];
#pragma omp parallel for schedule(static) reduction(+ : n)
        for (size_t i = first; i < end; i++) {
            const float *at = ssfr_values_at(values, i);
            bool any = false;
            for (int c = 0; c < values->c; c++) any |= at[c] != 0;
            n += any;
        }
    }
    return n;
}

static void count_resource(const ssfr_graph *graph, resource *r)
{
    const ssfr_slot *slot = &ssfr_slots[r->slot];
    r->values.is_counted = true;
    if (!r->values.now.same) r->values.n_seen = count_seen(&graph->frame, &r->values.now);
    else r->values.n_seen = slot->neutral != 0 ? graph->frame.facts.n_particles : 0;
}

void ssfr_values_count(ssfr_graph *graph)
{
    for (int i = 0; i < graph->n_resources; i++) graph->resources[i].values.is_counted = false;
    for (int i = 0; i < graph->n_nodes; i++) {
        node *n = &graph->nodes[i];
        if (!n->read || n->pass->particles_run) continue;
        for (int j = 0, k; (k = ssfr_port_of_values(n->pass->inputs, j)) >= 0; j++) {
            resource *r = &graph->resources[n->in[k]];
            if (!r->values.is_counted) count_resource(graph, r);
            n->run.n_valued[j] = r->values.n_seen;
        }
    }
}

/* ---- running a particle node ------------------------------------------------------------------------------------- */

static void give_ports(ssfr_graph *graph, node *n)
{
    n->run.frame = &graph->frame;
    n->run.params = n->params, n->run.coeffs = n->coeffs, n->run.state = n->state;
    for (int j = 0, k; (k = ssfr_port_of_values(n->pass->inputs, j)) >= 0; j++)
        n->run.values[j] = &graph->resources[n->in[k]].values.now;
}

static played what_plays(const ssfr_graph *graph, const node *n)
{
    const ssfr_scene *scene = graph->frame.scene;
    played now = {.is = true, .timed = scene->timed, .time = scene->timed ? scene->time : 0,
                  .serial = graph->frame.particles->serial};
    for (int k = 0; k < n->n_in; k++) now.in[k] = graph->resources[n->in[k]].values.key;
    return now;
}

static bool is_same(const played *a, const played *b)
{
    bool same = a->is == b->is && a->timed == b->timed && a->time == b->time && a->serial == b->serial;
    for (int k = 0; k < SSFR_MAX_VALUES; k++) same &= a->in[k] == b->in[k];
    return same;
}

static double time_since(const played *last, const played *now)
{
    const bool goes_on = last->is && last->timed && now->timed && now->time >= last->time;
    return goes_on ? now->time - last->time : NAN;
}

static ssfr_result reserve(ssfr_graph *graph, resource *r, size_t n)
{
    ssfr_result result = SSFR_OK;
    particle_values *v = &r->values;
    const size_t needed = n * (size_t)ssfr_slots[r->slot].channels;
    v->written = 0;
    v->n_written = n;
    if (v->memory && needed <= v->capacity) return SSFR_OK;
    free(v->memory);
    v->memory = NULL, v->capacity = 0;
    SSFR_TRY(ssfr_alloc(&v->memory, needed, sizeof *v->memory, "values of particles"));
    v->capacity = needed;
    graph->grew++;
end:
    return result;
}

/* Values that are all neutral count as not there: then what is drawn with them has the very bits of what is drawn
 * without. */
static void note_written(ssfr_graph *graph, resource *r)
{
    particle_values *v = &r->values;
    const size_t n = v->n_written * (size_t)ssfr_slots[r->slot].channels;
    const float neutral = (float)ssfr_slots[r->slot].neutral;
    size_t different = 0;
#pragma omp parallel for schedule(static) reduction(+ : different)
    for (size_t i = 0; i < n; i++) different += v->memory[i] != neutral;
    v->written = different ? new_key(graph) : 0;
}

static ssfr_result run_pass(ssfr_graph *graph, node *n)
{
    ssfr_result result = SSFR_OK;
    const double start = ssfr_clock();
    const played now = what_plays(graph, n);
    n->kept = is_same(&n->played, &now);
    if (n->kept) return SSFR_OK;
    n->run.dt = time_since(&n->played, &now);
    n->played.is = false; /* until it has run */
    for (int k = 0; k < n->n_out; k++) {
        SSFR_TRY(reserve(graph, &graph->resources[n->out[k]], graph->frame.particles->n));
        n->run.values_out[k] = graph->resources[n->out[k]].values.memory;
    }
    SSFR_TRY(n->pass->particles_run(&n->run));
    for (int k = 0; k < n->n_out; k++) note_written(graph, &graph->resources[n->out[k]]);
    n->played = now;
    n->ms = 1e3 * (ssfr_clock() - start);
end:
    return result;
}

static ssfr_node_status decide(const ssfr_graph *graph, const node *n, bool keep_all, const char **why)
{
    *why = "";
    if (n->off) return *why = "switched off", SSFR_OFF;
    if (!n->read) return *why = "nobody reads what it writes", SSFR_UNWANTED;
    if (!graph->frame.particles) return *why = "the scene has no particles to compute from", SSFR_NEEDLESS;
    if (!keep_all && n->pass->needed && !n->pass->needed(&n->run)) return *why = n->pass->needless, SSFR_NEEDLESS;
    return SSFR_RAN;
}

static ssfr_result run_node(ssfr_graph *graph, node *n, bool keep_all)
{
    ssfr_result result = SSFR_OK;
    give_ports(graph, n);
    if (!n->pass->particles_run) return SSFR_OK;
    if (n->pass->derive) n->pass->derive(&n->run, n->coeffs);
    n->status = decide(graph, n, keep_all, &n->why);
    if (n->status == SSFR_RAN) SSFR_TRY(run_pass(graph, n));
    if (!graph->frame.particles) n->played.is = false;
    for (int k = 0; k < n->n_out; k++)
        if (n->status == SSFR_RAN) hold_written(graph, &graph->resources[n->out[k]]);
        else hold_stand_in(graph, n, k);
end:
    return result;
}

ssfr_result ssfr_values_run(ssfr_graph *graph, bool keep_all)
{
    ssfr_result result = SSFR_OK;
    find_readers(graph, keep_all);
    for (int i = 0; i < graph->n_resources; i++) {
        resource *r = &graph->resources[i];
        if (!ssfr_slot_is_particles(r->slot)) continue;
        hold_neutral(graph, r);
        if (r->writer < 0) hold_brought(graph, r);
    }
    for (int i = 0; i < graph->n_nodes; i++) SSFR_TRY(run_node(graph, &graph->nodes[i], keep_all));
end:
    return result;
}

/* ---- history ----------------------------------------------------------------------------------------------------- */

static bool has_seen(const node *n, const ssfr_scene *scene)
{
    const played *p = &n->played;
    return p->is && p->timed && p->time == scene->time && p->serial == scene->particles->serial;
}

double ssfr_graph_history(ssfr_graph *graph, const ssfr_scene *scene)
{
    double longest = -1;
    if (!scene->timed || !scene->particles) return longest;
    find_readers(graph, false);
    for (int i = 0; i < graph->n_nodes; i++) {
        const node *n = &graph->nodes[i];
        if (n->read && !n->off && n->pass->history && !has_seen(n, scene))
            longest = fmax(longest, n->pass->history(n->params));
    }
    return longest;
}

void ssfr_graph_restart(ssfr_graph *graph)
{
    for (int i = 0; i < graph->n_nodes; i++) graph->nodes[i].played.is = false;
}

void ssfr_values_forget(ssfr_graph *graph, const void *params)
{
    for (int i = 0; i < graph->n_nodes; i++)
        if (graph->nodes[i].params == params) graph->nodes[i].played.is = false;
}

void ssfr_values_finish(ssfr_graph *graph)
{
    for (int i = 0; i < graph->n_resources; i++) free(graph->resources[i].values.memory);
    for (int i = 0; i < graph->n_nodes; i++) {
        node *n = &graph->nodes[i];
        if (n->state && n->pass->state_finish) n->pass->state_finish(n->state);
        free(n->state);
    }
}

/* SPDX-License-Identifier: MIT */
/* twins.c: both twins of a pass on the same input. */
#include "graph/twins.h"

#include "graph/internal.h"

struct ssfr_twins {
    const ssfr_pass *pass;
    const ssfr_scene *scene;
    ssfr_gl *gl;
    ssfr_graph *source; /* the pipeline that has made the inputs */
    const node *at;     /* the pass in it */
};

/* ---- the inputs that a pipeline makes ---------------------------------------------------------------------------- */

static const node *find_node(const ssfr_graph *graph, const ssfr_pass *pass)
{
    const node *found = NULL;
    for (int i = 0; i < graph->n_nodes && !found; i++)
        if (graph->nodes[i].pass == pass) found = &graph->nodes[i];
    return found;
}

static bool has_pass(const ssfr_pipeline *pipeline, const ssfr_pass *pass)
{
    bool has = false;
    for (int i = 0; i < SSFR_MAX_NODES && pipeline->nodes[i].name; i++) {
        const ssfr_node *n = &pipeline->nodes[i];
        has |= strcmp(n->pass ? n->pass : n->name, pass->name) == 0;
    }
    return has;
}

/* settings: "param=value" of `node`, or "node.param=value" where that is NULL. */
static ssfr_result apply(ssfr_graph *graph, const char *node, const char *const *settings)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; settings && settings[i] && result == SSFR_OK; i++) {
        char key[128];
        const size_t length = strcspn(settings[i], "=");
        snprintf(key, sizeof key, "%s%s%.*s", node ? node : "", node ? "." : "", (int)length, settings[i]);
        result = ssfr_graph_set(graph, key, settings[i] + length + (settings[i][length] == '='));
    }
    return result;
}

static ssfr_result make_inputs(ssfr_twins *t, const char *const *settings)
{
    ssfr_result result = SSFR_OK;
    const ssfr_pipeline *pipeline = NULL;
    for (int i = 0; ssfr_pipeline_at(i) && !pipeline; i++)
        if (has_pass(ssfr_pipeline_at(i), t->pass)) pipeline = ssfr_pipeline_at(i);
    if (!pipeline) return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no pipeline has this pass", t->pass->name);
    SSFR_TRY(ssfr_graph_create(&t->source, pipeline, NULL));
    SSFR_TRY(apply(t->source, NULL, settings));
    t->at = find_node(t->source, t->pass);
    for (int i = 0; i < t->source->n_resources; i++) t->source->resources[i].asked = false;
    for (int k = 0; k < t->at->n_in; k++) t->source->resources[t->at->in[k]].asked = true;
    SSFR_TRY(ssfr_graph_run(t->source, t->scene, NULL));
end:
    return result;
}

ssfr_result ssfr_twins_create(ssfr_twins **out, const ssfr_pass *pass, const ssfr_scene *scene, ssfr_gl *gl,
                              const char *const *inputs)
{
    ssfr_result result = SSFR_OK;
    ssfr_twins *t = NULL;
    *out = NULL;
    if (pass->particles_run)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: works on particles: it has no twin", pass->name);
    SSFR_TRY(ssfr_alloc(&t, 1, sizeof *t, "twins"));
    *t = (ssfr_twins){.pass = pass, .scene = scene, .gl = gl};
    SSFR_TRY(make_inputs(t, inputs));
    *out = t;
    t = NULL;
end:
    ssfr_twins_destroy(&t);
    return result;
}

void ssfr_twins_destroy(ssfr_twins **twins)
{
    if (*twins) ssfr_graph_destroy(&(*twins)->source);
    free(*twins);
    *twins = NULL;
}

/* ---- one twin by itself ------------------------------------------------------------------------------------------ */

static ssfr_result import_rounded(ssfr_graph *single, const char *port, const ssfr_field *field)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *rounded = NULL;
    SSFR_TRY(ssfr_field_copy(&rounded, field));
    ssfr_field_round(rounded);
    SSFR_TRY(ssfr_graph_import(single, port, rounded));
end:
    ssfr_field_destroy(&rounded);
    return result;
}

static bool is_neutral(const ssfr_graph *graph, const image *im)
{
    bool neutral = false;
    for (int i = 0; i < SSFR_N_SLOTS; i++) neutral |= im == &graph->neutral[i];
    return neutral;
}

/* What port k had, unless that is neutral: which is what a port has that is not given. */
static ssfr_result give_input(ssfr_graph *single, const ssfr_graph *source, const node *at, int k)
{
    const resource *r = &source->resources[at->in[k]];
    const bool values = ssfr_slot_is_particles(r->slot);
    if (values && !r->values.now.same) ssfr_values_lend(single, single->nodes[0].in[k], r->values.now.data);
    if (values || is_neutral(source, r->image)) return SSFR_OK;
    return import_rounded(single, at->pass->inputs[k].name, r->image->field);
}

ssfr_tolerance ssfr_twins_tolerance(const ssfr_pass *pass, const ssfr_run *run)
{
    const bool halves = pass->storage && pass->storage(run->params) == SSFR_STORE_HALF;
    ssfr_tolerance tolerance = halves ? pass->half_tolerance : pass->tolerance;
    if (pass->widen) pass->widen(run, &tolerance);
    return tolerance;
}

/* Runs the pass alone, whatever its `needed` says, and gives its outputs and how far they may part. */
static ssfr_result run_twin(const ssfr_twins *t, ssfr_gl *gl, const char *const *settings, ssfr_field **outputs,
                            ssfr_tolerance *tolerance)
{
    ssfr_result result = SSFR_OK;
    ssfr_graph *single = NULL;
    SSFR_TRY(ssfr_graph_create_for_pass(&single, t->pass, gl));
    SSFR_TRY(apply(single, single->nodes[0].name, settings));
    for (int k = 0; k < t->at->n_in; k++) SSFR_TRY(give_input(single, t->source, t->at, k));
    ssfr_graph_want_all(single, true);
    SSFR_TRY(ssfr_graph_run(single, t->scene, &(ssfr_run_options){.keep_all = true}));
    for (int k = 0; k < t->at->n_out; k++) SSFR_TRY(ssfr_graph_read(single, t->pass->outputs[k].name, &outputs[k]));
    *tolerance = ssfr_twins_tolerance(t->pass, &single->nodes[0].run);
end:
    ssfr_graph_destroy(&single);
    return result;
}

/* ---- comparing --------------------------------------------------------------------------------------------------- */

static void compare(ssfr_twins_row *row)
{
    const ssfr_field *a = row->measured, *b = row->reference;
    const size_t n = (size_t)b->w * (size_t)b->h * (size_t)b->c;
    size_t outside = 0;
    for (size_t i = 0; i < n; i++) {
        const double difference = fabs(a->data[i] - b->data[i]);
        const bool bad = !isfinite(a->data[i]) || !isfinite(b->data[i]);
        row->n_nan += bad;
        if (!bad && ssfr_is_surface(a->data[i]) && ssfr_is_surface(b->data[i]))
            row->max_abs = fmax(row->max_abs, difference);
        outside += !(difference <= row->tolerance.abs + row->tolerance.rel * fabs(b->data[i]));
    }
    row->outliers = (double)outside / (double)n;
    row->ok = row->n_nan == 0 && row->outliers <= row->tolerance.outliers;
}

ssfr_result ssfr_twins_compare(const ssfr_twins *twins, const char *const *settings,
                               ssfr_twins_row rows[SSFR_MAX_OUTPUTS], int *n_rows)
{
    ssfr_result result = SSFR_OK;
    ssfr_tolerance tolerance;
    ssfr_field *cpu[SSFR_MAX_OUTPUTS] = {0}, *gpu[SSFR_MAX_OUTPUTS] = {0};
    *n_rows = 0;
    SSFR_TRY(run_twin(twins, NULL, settings, cpu, &tolerance));
    SSFR_TRY(run_twin(twins, twins->gl, settings, gpu, &tolerance));
    for (int k = 0; k < twins->at->n_out; k++) {
        rows[k] = (ssfr_twins_row){.output = twins->pass->outputs[k].name, .tolerance = tolerance,
                                   .reference = cpu[k], .measured = gpu[k]};
        cpu[k] = gpu[k] = NULL;
        compare(&rows[k]);
        ++*n_rows;
    }
end:
    for (int k = 0; k < SSFR_MAX_OUTPUTS; k++) ssfr_field_destroy(&cpu[k]), ssfr_field_destroy(&gpu[k]);
    return result;
}

void ssfr_twins_finish(ssfr_twins_row rows[SSFR_MAX_OUTPUTS], int n_rows)
{
    for (int k = 0; k < n_rows; k++) ssfr_field_destroy(&rows[k].reference), ssfr_field_destroy(&rows[k].measured);
}

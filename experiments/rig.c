/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rig.c: one run of a sweep: set, measure, compare with the twin and with the reference. */
#include "experiments/rig.h"
#include "experiments/play.h"
#include "experiments/setup.h"
#include "experiments/shot.h"

#include <assert.h>
#include <errno.h>
#include <unistd.h>

typedef struct cached { /* a shot and the run that it belongs to */
    bool valid;
    size_t index[SSFR_MAX_AXES];
    ssfr_shot shot;
    ssfr_measured *measured; /* NULL when it was run only once, to be looked at */
} cached;

struct ssfr_rig {
    const ssfr_rig_options *o;
    ssfr_graph *gl, *cpu, *reference; /* NULL where not needed */
    ssfr_truth_params truth; /* with the settings of every run and of the scene */
    ssfr_stage *stage;
    size_t scene; /* value that the stage shows */
    bool staged;
    bool dressed; /* the graphs have settings or a background of a scene */
    cached frame, twin, of_reference; /* of OpenGL, of the CPU, of whatever is the reference */
    double truth_values[SSFR_N_COLUMNS]; /* the columns truth_* that go with it */
};

/* ---- values of axes ---------------------------------------------------------------------------------------------- */

const char *ssfr_rig_value(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES], const char *key)
{
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, key);
    assert(axis);
    return axis->values[index[axis - spec->axes]];
}

bool ssfr_rig_size(const char *text, int size[2])
{
    char *end = NULL;
    const long w = strtol(text, &end, 10);
    const bool digits = text[strspn(text, "0123456789x")] == '\0' && end != text && *end == 'x' && end[1] != '\0';
    const long h = digits ? strtol(end + 1, &end, 10) : 0;
    const bool ok = digits && *end == '\0' && w >= 1 && w <= SSFR_MAX_SIZE && h >= 1 && h <= SSFR_MAX_SIZE;
    if (ok) size[0] = (int)w, size[1] = (int)h;
    return ok;
}

/* ---- checks ------------------------------------------------------------------------------------------------------ */

typedef struct target { /* what takes parameters */
    ssfr_graph *graph;
    const ssfr_pipeline *pipeline;
    ssfr_truth_params *truth; /* NULL when nothing is compared with it */
} target;

/* "truth.hind" is meant for truth, though it has none. */
static bool is_for_truth(const char *key)
{
    static const char *const groups[] = {"truth.", "extinction.", "path.", "anisotropy."};
    bool found = false;
    for (size_t i = 0; i < SSFR_COUNT(groups); i++) found |= strncmp(key, groups[i], strlen(groups[i])) == 0;
    return found;
}

/* The water's and the light's parameters are set in both. */
static ssfr_result check_parameter(const target *t, const char *where, const char *key, const char *value)
{
    ssfr_result result = SSFR_OK;
    const bool has = ssfr_graph_row(t->graph, key);
    const bool for_truth = ssfr_rig_truth_row(key) || (!has && is_for_truth(key));
    if (!has && for_truth && !t->truth)
        return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: %s: only a sweep with `reference: truth` has it", where, key);
    if (!has && !for_truth)
        return ssfr_fail(SSFR_ERR_UNKNOWN,
                         "%s: %s: pipeline %s has no such parameter (ssfr pipelines %s lists them)", where, key,
                         ssfr_pipeline_name(t->pipeline), ssfr_pipeline_name(t->pipeline));
    ssfr_log_about(where);
    if (has) SSFR_TRY(ssfr_graph_set(t->graph, key, value));
    if (for_truth && t->truth) SSFR_TRY(ssfr_truth_set(t->truth, key, value));
end:
    ssfr_log_about(NULL);
    return result;
}

static ssfr_result check_settings(const target *t, const ssfr_settings *settings)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < settings->n && result == SSFR_OK; i++)
        result = check_parameter(t, settings->items[i].where, settings->items[i].key, settings->items[i].value);
    return result;
}

static ssfr_result check_scene(const char *where, const char *name)
{
    ssfr_scene_source source;
    ssfr_log_about(where);
    ssfr_result result = ssfr_scene_find(name, &source);
    if (result == SSFR_OK && source.kind == SSFR_SCENE_PARTICLES && access(name, R_OK) != 0)
        result = ssfr_fail(SSFR_ERR_IO, "%s: %s", name, strerror(errno));
    ssfr_log_about(NULL);
    return result;
}

static ssfr_result check_own(const ssfr_axis *axis, const char *value)
{
    int size[2];
    if (strcmp(axis->key, "scene") == 0) return check_scene(axis->where, value);
    if (strcmp(axis->key, "size") == 0 && !ssfr_rig_size(value, size))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: size %s: expected WxH, sides from 1 to %d px", axis->where, value,
                         SSFR_MAX_SIZE);
    if (strcmp(axis->key, "backend") == 0 && strcmp(value, "gl") != 0 && strcmp(value, "cpu") != 0)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: backend %s: expected gl or cpu", axis->where, value);
    return SSFR_OK;
}

static ssfr_result check_axis(const target *t, const ssfr_axis *axis)
{
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < axis->n && result == SSFR_OK; i++)
        result = ssfr_axis_is_parameter(axis->key) ? check_parameter(t, axis->where, axis->key, axis->values[i])
                                                   : check_own(axis, axis->values[i]);
    return result;
}

ssfr_result ssfr_rig_check(const ssfr_sweep_spec *spec, const ssfr_pipeline *pipeline)
{
    ssfr_result result = SSFR_OK;
    ssfr_truth_params truth;
    target t = {.pipeline = pipeline, .truth = spec->compared_with == SSFR_REFERENCE_TRUTH ? &truth : NULL};
    ssfr_truth_defaults(&truth);
    SSFR_TRY(ssfr_graph_create(&t.graph, pipeline, NULL));
    SSFR_TRY(check_settings(&t, &spec->settings));
    for (int i = 0; i < spec->n_axes; i++) SSFR_TRY(check_axis(&t, &spec->axes[i]));
    SSFR_TRY(check_settings(&t, &spec->reference));
end:
    ssfr_graph_destroy(&t.graph);
    return result;
}

/* ---- the rig ----------------------------------------------------------------------------------------------------- */

/* Those that are not the graph's are truth's: ssfr_rig_check found them well. */
static ssfr_result apply(ssfr_graph *graph, const ssfr_settings *settings)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < settings->n && result == SSFR_OK; i++)
        if (ssfr_graph_row(graph, settings->items[i].key))
            result = ssfr_graph_set(graph, settings->items[i].key, settings->items[i].value);
    return result;
}

/* What the scene says first, so that the spec counts for more. */
static ssfr_result new_graph(ssfr_graph **out, const ssfr_rig_options *o, ssfr_gl *gl, const ssfr_description *scene)
{
    ssfr_result result = SSFR_OK;
    ssfr_graph_destroy(out);
    SSFR_TRY(ssfr_graph_create(out, o->pipeline, gl));
    SSFR_TRY(ssfr_shot_want(*out, o->pipeline, true));
    if (scene) SSFR_TRY(ssfr_setup_apply_scene(*out, scene));
    SSFR_TRY(apply(*out, &o->spec->settings));
end:
    return result;
}

static ssfr_result new_graphs(ssfr_rig *rig, const ssfr_description *scene)
{
    ssfr_result result = SSFR_OK;
    const ssfr_rig_options *o = rig->o;
    if (o->gl) SSFR_TRY(new_graph(&rig->gl, o, o->gl, scene));
    SSFR_TRY(new_graph(&rig->cpu, o, NULL, scene));
    if (o->spec->compared_with == SSFR_REFERENCE_FRAME) {
        SSFR_TRY(new_graph(&rig->reference, o, NULL, scene));
        SSFR_TRY(apply(rig->reference, &o->spec->reference));
    }
end:
    return result;
}

ssfr_result ssfr_rig_create(ssfr_rig **out, const ssfr_rig_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_rig *rig = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&rig, 1, sizeof *rig, "a rig"));
    rig->o = options;
    SSFR_TRY(new_graphs(rig, NULL));
    SSFR_TRY(ssfr_rig_truth_params(&rig->truth, options->spec, NULL));
    *out = rig;
    rig = NULL;
end:
    ssfr_rig_destroy(&rig);
    return result;
}

static void forget(cached *c)
{
    ssfr_shot_finish(&c->shot);
    ssfr_measured_destroy(&c->measured);
    c->valid = false;
}

void ssfr_rig_destroy(ssfr_rig **rig)
{
    ssfr_rig *r = *rig;
    if (!r) return;
    forget(&r->frame);
    forget(&r->twin);
    forget(&r->of_reference);
    ssfr_graph_destroy(&r->gl);
    ssfr_graph_destroy(&r->cpu);
    ssfr_graph_destroy(&r->reference);
    ssfr_stage_destroy(&r->stage);
    free(r);
    *rig = NULL;
}

const ssfr_graph *ssfr_rig_graph(const ssfr_rig *rig)
{
    return rig->cpu;
}

const ssfr_truth_params *ssfr_rig_truth(const ssfr_rig *rig)
{
    return rig->o->spec->compared_with == SSFR_REFERENCE_TRUTH ? &rig->truth : NULL;
}

/* ---- one run ----------------------------------------------------------------------------------------------------- */

/* What one scene has set must not stay for the next. */
static ssfr_result dress(ssfr_rig *rig)
{
    ssfr_result result = SSFR_OK;
    const ssfr_description *scene = rig->stage->description;
    const char *background = scene ? scene->background : NULL;
    const bool has = background || (scene && scene->n_settings > 0);
    if (!has && !rig->dressed) return SSFR_OK;
    rig->dressed = true;
    SSFR_TRY(new_graphs(rig, scene));
    ssfr_graph *const graphs[] = {rig->gl, rig->cpu, rig->reference};
    for (size_t i = 0; i < SSFR_COUNT(graphs); i++)
        if (graphs[i]) SSFR_TRY(ssfr_setup_background(graphs[i], background, &rig->stage->scene.camera));
    rig->dressed = has;
end:
    return result;
}

static ssfr_result set_stage(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    const ssfr_axis *axis = ssfr_sweep_spec_axis(rig->o->spec, "scene");
    const size_t scene = index[axis - rig->o->spec->axes];
    ssfr_stage_options options = rig->o->stage;
    ssfr_rig_size(ssfr_rig_value(rig->o->spec, index, "size"), options.size);
    if (rig->staged && rig->scene == scene) return ssfr_stage_aim(rig->stage, &options);
    rig->staged = false;
    ssfr_stage_destroy(&rig->stage);
    SSFR_TRY(ssfr_stage_create(&rig->stage, axis->values[scene], &options));
    SSFR_TRY(dress(rig));
    SSFR_TRY(ssfr_rig_truth_params(&rig->truth, rig->o->spec, rig->stage->description));
    rig->scene = scene;
    rig->staged = true;
end:
    return result;
}

ssfr_result ssfr_rig_stage(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], const ssfr_stage **out)
{
    const ssfr_result result = set_stage(rig, index);
    *out = result == SSFR_OK ? rig->stage : NULL;
    return result;
}

static ssfr_result set_parameters(const ssfr_rig *rig, ssfr_graph *graph, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    const ssfr_sweep_spec *spec = rig->o->spec;
    for (int i = 0; i < spec->n_axes && result == SSFR_OK; i++)
        if (ssfr_axis_is_parameter(spec->axes[i].key) && ssfr_graph_row(graph, spec->axes[i].key))
            result = ssfr_graph_set(graph, spec->axes[i].key, spec->axes[i].values[index[i]]);
    return result;
}

static ssfr_result take(const ssfr_rig *rig, ssfr_shot *shot, const ssfr_graph *graph)
{
    const ssfr_camera *camera = &rig->stage->scene.camera;
    return ssfr_shot_take(shot, graph, rig->o->pipeline, camera->w, camera->h);
}

bool ssfr_rig_makes_frames(const ssfr_graph *graph, const ssfr_axis *axis)
{
    return !ssfr_axis_is_parameter(axis->key) || ssfr_graph_row(graph, axis->key);
}

/* A reference frame depends on scene and size alone, truth on its own parameters, too. */
static bool makes_references(const ssfr_rig *rig, const ssfr_axis *axis)
{
    const bool truth = rig->o->spec->compared_with == SSFR_REFERENCE_TRUTH;
    return !ssfr_axis_is_parameter(axis->key) || (truth && ssfr_rig_truth_row(axis->key));
}

/* Whether what is kept of one run is what another needs. */
static bool holds(const cached *c, const ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    const ssfr_sweep_spec *spec = rig->o->spec;
    bool same = c->valid;
    for (int i = 0; i < spec->n_axes; i++) {
        const ssfr_axis *axis = &spec->axes[i];
        const bool matters =
            c == &rig->of_reference ? makes_references(rig, axis) : ssfr_rig_makes_frames(rig->cpu, axis);
        if (matters && strcmp(axis->key, "backend") != 0) same &= c->index[i] == index[i];
    }
    return same;
}

static void hold(cached *c, const size_t index[SSFR_MAX_AXES])
{
    memcpy(c->index, index, sizeof c->index);
    c->valid = true;
}

static ssfr_result cast_truth(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    const ssfr_stage_options *stage = &rig->o->stage;
    const ssfr_truth_options options = {.every = 1, .seed = stage->seed, .cache = stage->cache, .progress = true};
    ssfr_truth_params params = rig->truth;
    SSFR_TRY(ssfr_rig_truth_vary(&params, rig->o->spec, index));
    SSFR_TRY(ssfr_rig_truth_cast(&rig->of_reference.shot, rig->truth_values, rig->stage, &params, &options));
end:
    return result;
}

static ssfr_result ensure_reference(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    cached *c = &rig->of_reference;
    if (holds(c, rig, index)) return SSFR_OK;
    forget(c);
    for (int i = 0; i < SSFR_N_COLUMNS; i++) rig->truth_values[i] = NAN;
    if (rig->o->spec->compared_with == SSFR_REFERENCE_TRUTH) {
        SSFR_TRY(cast_truth(rig, index));
    } else {
        SSFR_TRY(ssfr_play(rig->reference, rig->stage, &rig->o->stage, -1));
        SSFR_TRY(ssfr_graph_run(rig->reference, &rig->stage->scene, NULL));
        SSFR_TRY(take(rig, &c->shot, rig->reference));
    }
    hold(c, index);
end:
    return result;
}

/* What is compared but goes into no picture is not to be paid for: the shot's frame is another than those timed. */
static ssfr_result measure(ssfr_rig *rig, cached *c, ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_shot_want(graph, rig->o->pipeline, false));
    SSFR_TRY(ssfr_measure_graph(&c->measured, graph, &rig->stage->scene, &rig->o->measure));
    SSFR_TRY(ssfr_shot_want(graph, rig->o->pipeline, true));
end:
    return result;
}

/* The frame of a run by one of the graphs, measured when asked for. */
static ssfr_result ensure_frame(ssfr_rig *rig, cached *c, ssfr_graph *graph, const size_t index[SSFR_MAX_AXES],
                                bool measured)
{
    ssfr_result result = SSFR_OK;
    if (holds(c, rig, index) && (c->measured || !measured)) return SSFR_OK;
    forget(c);
    SSFR_TRY(set_parameters(rig, graph, index));
    SSFR_TRY(ssfr_play(graph, rig->stage, &rig->o->stage, -1));
    if (measured) SSFR_TRY(measure(rig, c, graph));
    SSFR_TRY(ssfr_graph_run(graph, &rig->stage->scene, NULL));
    SSFR_TRY(take(rig, &c->shot, graph));
    hold(c, index);
end:
    return result;
}

static void put_times(const ssfr_measured *m, double bandwidth, double values[SSFR_N_COLUMNS])
{
    values[SSFR_COLUMN_ms_min] = m->frame.min;
    values[SSFR_COLUMN_ms_median] = m->frame.median;
    values[SSFR_COLUMN_ms_mad] = m->frame.mad;
    values[SSFR_COLUMN_runs] = (double)m->frame.n;
    values[SSFR_COLUMN_outliers] = (double)m->frame.outliers;
    values[SSFR_COLUMN_taps] = m->taps;
    values[SSFR_COLUMN_iterations] = m->iterations;
    values[SSFR_COLUMN_bytes] = m->bytes;
    values[SSFR_COLUMN_tiles] = m->tiles;
    values[SSFR_COLUMN_unstable] = m->unstable;
    values[SSFR_COLUMN_roofline] = ssfr_measure_roofline(m->frame.median, m->bytes, bandwidth);
}

/* The next run is the same on the CPU: then the twin is measured now and serves both. */
static bool cpu_is_next(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES])
{
    const int last = spec->n_axes - 1;
    const ssfr_axis *axis = &spec->axes[last];
    return strcmp(axis->key, "backend") == 0 && index[last] + 1 < axis->n &&
           strcmp(axis->values[index[last] + 1], "cpu") == 0;
}

/* Against the reference: the frame itself, and its twin (NULL: there is none). */
static ssfr_result compare(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], const ssfr_shot *frame,
                           const ssfr_shot *twin, double values[SSFR_N_COLUMNS])
{
    ssfr_result result = SSFR_OK;
    const double radius = rig->stage->particles->radius;
    if (rig->o->spec->compared_with == SSFR_REFERENCE_NONE) return SSFR_OK;
    SSFR_TRY(ensure_reference(rig, index));
    for (int i = SSFR_COLUMN_truth_depth_err_mean; i <= SSFR_COLUMN_truth_thickness_err_mean; i++)
        values[i] = rig->truth_values[i];
    SSFR_TRY(ssfr_shot_compare_reference(frame, &rig->of_reference.shot, radius, values));
    if (twin) SSFR_TRY(ssfr_shot_compare_method(twin, &rig->of_reference.shot, values));
end:
    return result;
}

static ssfr_result run_gl(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], double values[SSFR_N_COLUMNS])
{
    ssfr_result result = SSFR_OK;
    const ssfr_rig_options *o = rig->o;
    const ssfr_shot *frame = &rig->frame.shot, *twin = o->no_twin ? NULL : &rig->twin.shot;
    SSFR_TRY(ensure_frame(rig, &rig->frame, rig->gl, index, true));
    put_times(rig->frame.measured, o->bandwidth_gl, values);
    SSFR_TRY(ssfr_shot_count_nan(frame, values));
    if (twin) {
        SSFR_TRY(ensure_frame(rig, &rig->twin, rig->cpu, index, cpu_is_next(o->spec, index)));
        SSFR_TRY(ssfr_shot_compare_twin(frame, twin, values));
    }
    SSFR_TRY(compare(rig, index, frame, twin, values));
end:
    return result;
}

static ssfr_result run_cpu(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], double values[SSFR_N_COLUMNS])
{
    ssfr_result result = SSFR_OK;
    const ssfr_shot *twin = &rig->twin.shot;
    SSFR_TRY(ensure_frame(rig, &rig->twin, rig->cpu, index, true));
    put_times(rig->twin.measured, rig->o->bandwidth_cpu, values);
    SSFR_TRY(ssfr_shot_count_nan(twin, values));
    SSFR_TRY(compare(rig, index, twin, twin, values));
end:
    return result;
}

ssfr_result ssfr_rig_run(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], double values[SSFR_N_COLUMNS])
{
    ssfr_result result = SSFR_OK;
    const bool on_gpu = strcmp(ssfr_rig_value(rig->o->spec, index, "backend"), "gl") == 0;
    for (int i = 0; i < SSFR_N_COLUMNS; i++) values[i] = NAN;
    SSFR_TRY(set_stage(rig, index));
    SSFR_TRY(on_gpu ? run_gl(rig, index, values) : run_cpu(rig, index, values));
end:
    return result;
}

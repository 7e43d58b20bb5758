/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rig.c: one run of a sweep: set, measure, compare with the twin, with the reference and with another row. */
#include "experiments/rig.h"
#include "experiments/inspect.h"
#include "experiments/play.h"
#include "experiments/setup.h"
#include "experiments/shot.h"

#include <assert.h>

typedef struct cached { /* a shot and the run that it belongs to */
    bool valid;
    size_t index[SSFR_MAX_AXES];
    ssfr_shot shot;
    ssfr_measured *measured; /* NULL when it was run only once, to be looked at */
    ssfr_paired paired;      /* with the frame that it is held against */
    double same_picture;     /* as that frame's: 1, else 0; NaN where there is none */
    ssfr_inspected inspected;
    ssfr_report report;      /* its numbers: `nodes` is not kept */
    double foam_share, spray_share;
    char left_out[SSFR_COLUMN_TEXT];
} cached;

typedef struct outfit { /* what graphs are made for: what one has set must not stay for another */
    const ssfr_pipeline *pipeline; /* NULL: for nothing yet */
    const ssfr_variant *variant;   /* NULL when there are none */
    const char *scene;
} outfit;

typedef struct seat { /* graphs of one outfit, and the last frame of each */
    outfit outfit;
    ssfr_graph *gl, *cpu; /* gl NULL where not needed */
    cached frame, twin;   /* of OpenGL, of the CPU */
} seat;

struct ssfr_rig {
    const ssfr_rig_options *o;
    ssfr_stage *stage;
    const char *scene; /* that the stage shows; NULL: none */
    double camera_time; /* s; NaN without a path */
    seat own, base;    /* of the run, and of that which it is held against */
    ssfr_truth_params truth; /* with the settings of every run, of the scene and of the variant */
    ssfr_graph *reference;   /* NULL where not needed */
    outfit of_reference_graph;
    cached of_reference;     /* of whatever is the reference */
    double truth_values[SSFR_N_COLUMNS]; /* the columns truth_* that go with it */
    bool has_base_row;
    size_t base_index[SSFR_MAX_AXES];
    ssfr_rig_row base_row;
};

/* ---- values of axes ---------------------------------------------------------------------------------------------- */

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

bool ssfr_rig_flag(const char *text, bool *flag)
{
    *flag = strcmp(text, "true") == 0;
    return *flag || strcmp(text, "false") == 0;
}

static const char *value_of(const ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], const char *key)
{
    return ssfr_sweep_spec_value(rig->o->spec, index, key);
}

static bool is_false(const ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], const char *key)
{
    const char *text = value_of(rig, index, key);
    return text && strcmp(text, "false") == 0;
}

static ssfr_run_options how_to_run(const ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    return (ssfr_run_options){.keep_all = is_false(rig, index, "leave_out"),
                              .no_culling = is_false(rig, index, "cull")};
}

/* ---- graphs ------------------------------------------------------------------------------------------------------ */

/* Those that are not the graph's are truth's: ssfr_rig_check found them well. */
static ssfr_result apply(ssfr_graph *graph, const ssfr_settings *settings)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < settings->n && result == SSFR_OK; i++)
        if (ssfr_graph_row(graph, settings->items[i].key))
            result = ssfr_graph_set(graph, settings->items[i].key, settings->items[i].value);
    return result;
}

/* What the scene says first, so that the spec counts for more, and the variant (NULL: nothing) for most. */
static ssfr_result new_graph(ssfr_graph **out, const ssfr_rig *rig, const outfit *outfit, ssfr_gl *gl)
{
    ssfr_result result = SSFR_OK;
    const ssfr_description *scene = rig->stage->description;
    ssfr_graph_destroy(out);
    SSFR_TRY(ssfr_graph_create(out, outfit->pipeline, gl));
    SSFR_TRY(ssfr_shot_want(*out, outfit->pipeline, true));
    if (scene) SSFR_TRY(ssfr_setup_apply_scene(*out, scene));
    SSFR_TRY(apply(*out, &rig->o->spec->settings));
    if (outfit->variant) SSFR_TRY(apply(*out, &outfit->variant->settings));
    if (scene) SSFR_TRY(ssfr_setup_background(*out, scene->background, &rig->stage->scene.camera));
end:
    return result;
}

static bool same_outfit(const outfit *a, const outfit *b)
{
    return a->pipeline == b->pipeline && a->variant == b->variant && a->scene && strcmp(a->scene, b->scene) == 0;
}

static outfit outfit_of(const ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    return (outfit){ssfr_pipeline_find(value_of(rig, index, "pipeline")),
                    ssfr_sweep_spec_variant_of(rig->o->spec, index), rig->scene};
}

/* The graphs of a run, in a seat; programs stay compiled. */
static ssfr_result sit(ssfr_rig *rig, seat *s, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    const outfit o = outfit_of(rig, index);
    if (same_outfit(&s->outfit, &o)) return SSFR_OK;
    s->outfit = (outfit){NULL, NULL, NULL};
    if (rig->o->gl) SSFR_TRY(new_graph(&s->gl, rig, &o, rig->o->gl));
    SSFR_TRY(new_graph(&s->cpu, rig, &o, NULL));
    s->outfit = o;
end:
    return result;
}

/* A frame that is the reference has the settings of every run and its own, whatever the variant. */
static ssfr_result sit_reference(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    outfit o = outfit_of(rig, index);
    o.variant = NULL;
    if (same_outfit(&rig->of_reference_graph, &o)) return SSFR_OK;
    rig->of_reference_graph = (outfit){NULL, NULL, NULL};
    SSFR_TRY(new_graph(&rig->reference, rig, &o, NULL));
    SSFR_TRY(apply(rig->reference, &rig->o->spec->reference));
    rig->of_reference_graph = o;
end:
    return result;
}

/* ---- the rig ----------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_rig_create(ssfr_rig **out, const ssfr_rig_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_rig *rig = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&rig, 1, sizeof *rig, "a rig"));
    rig->o = options;
    SSFR_TRY(ssfr_rig_truth_params(&rig->truth, options->spec, NULL, NULL));
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

static void leave(seat *s)
{
    forget(&s->frame);
    forget(&s->twin);
    ssfr_graph_destroy(&s->gl);
    ssfr_graph_destroy(&s->cpu);
}

void ssfr_rig_destroy(ssfr_rig **rig)
{
    ssfr_rig *r = *rig;
    if (!r) return;
    leave(&r->own);
    leave(&r->base);
    forget(&r->of_reference);
    ssfr_graph_destroy(&r->reference);
    ssfr_stage_destroy(&r->stage);
    free(r);
    *rig = NULL;
}

const ssfr_graph *ssfr_rig_graph(const ssfr_rig *rig)
{
    return rig->own.cpu;
}

const ssfr_truth_params *ssfr_rig_truth(const ssfr_rig *rig)
{
    return rig->o->spec->compared_with == SSFR_REFERENCE_TRUTH ? &rig->truth : NULL;
}

/* ---- the stage of a run ------------------------------------------------------------------------------------------ */

/* What the axes say of it; the scene must be open. */
static ssfr_result find_options(const ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], ssfr_stage_options *out)
{
    ssfr_result result = SSFR_OK;
    const char *camera = value_of(rig, index, "camera"), *frame = value_of(rig, index, "frame"),
               *view = value_of(rig, index, "view");
    const ssfr_path_spec *spec = &rig->o->spec->path;
    const bool follow = spec->frames == SSFR_PATH_FOLLOW;
    const ssfr_view *path;
    *out = rig->o->stage;
    ssfr_rig_size(value_of(rig, index, "size"), out->size);
    if (camera) out->camera = camera;
    if (frame) out->frame = strtol(frame, NULL, 10);
    if (!view) goto end;
    SSFR_TRY(ssfr_stage_find_path(rig->stage, out, follow, &path));
    out->camera_time = ssfr_stage_view_time(path, (size_t)strtod(view, NULL), spec->views);
    if (follow) out->time = out->camera_time;
end:
    return result;
}

static ssfr_result open_scene(ssfr_rig *rig, const char *scene)
{
    ssfr_result result = SSFR_OK;
    if (rig->scene && strcmp(rig->scene, scene) == 0) return SSFR_OK;
    rig->scene = NULL;
    ssfr_stage_destroy(&rig->stage);
    SSFR_TRY(ssfr_stage_open(&rig->stage, scene, &rig->o->stage));
    rig->scene = scene;
end:
    return result;
}

static ssfr_result set_stage(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    ssfr_stage_options options;
    rig->camera_time = NAN;
    SSFR_TRY(open_scene(rig, value_of(rig, index, "scene")));
    SSFR_TRY(find_options(rig, index, &options));
    SSFR_TRY(ssfr_stage_turn(rig->stage, &options));
    rig->camera_time = options.camera_time;
    SSFR_TRY(sit(rig, &rig->own, index));
    SSFR_TRY(ssfr_rig_truth_params(&rig->truth, rig->o->spec, rig->own.outfit.variant, rig->stage->description));
end:
    return result;
}

ssfr_result ssfr_rig_stage(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], const ssfr_stage **out)
{
    const ssfr_result result = set_stage(rig, index);
    *out = result == SSFR_OK ? rig->stage : NULL;
    return result;
}

/* ---- what is kept from run to run -------------------------------------------------------------------------------- */

bool ssfr_rig_makes_frames(const ssfr_graph *graph, const ssfr_axis *axis)
{
    return !ssfr_axis_is_parameter(axis->key) || ssfr_graph_row(graph, axis->key);
}

static bool same_value(const ssfr_rig *rig, const cached *c, const size_t index[SSFR_MAX_AXES], const char *key)
{
    const char *a = value_of(rig, c->index, key), *b = value_of(rig, index, key);
    return a == b || (a && b && strcmp(a, b) == 0);
}

/* Variants may set what truth depends on; what else they have stands in the stage. */
static bool varies_truth(const ssfr_sweep_spec *spec)
{
    bool found = false;
    for (int i = 0; i < spec->n_variants; i++)
        for (int k = 0; k < spec->variants[i]->settings.n; k++)
            found |= ssfr_rig_truth_row(spec->variants[i]->settings.items[k].key) != NULL;
    return found;
}

/* A reference frame depends on the stage and the pipeline alone, truth on the stage and its own parameters. */
static bool holds_reference(const ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    static const char *const keys[] = {"scene", "camera", "frame", "view", "size"};
    const ssfr_sweep_spec *spec = rig->o->spec;
    const cached *c = &rig->of_reference;
    const bool truth = spec->compared_with == SSFR_REFERENCE_TRUTH;
    bool same = c->valid;
    for (size_t i = 0; i < SSFR_COUNT(keys) && same; i++) same = same_value(rig, c, index, keys[i]);
    if (same && !truth) same = same_value(rig, c, index, "pipeline");
    if (same && truth && varies_truth(spec)) same = same_value(rig, c, index, "variant");
    for (int i = 0; i < spec->n_axes && same && truth; i++)
        if (ssfr_rig_truth_row(spec->axes[i].key)) same = c->index[i] == index[i];
    return same;
}

/* Whether the frame that is kept of one run is what another needs. */
static bool holds(const cached *c, const ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    const ssfr_sweep_spec *spec = rig->o->spec;
    bool same = c->valid;
    for (int i = 0; i < spec->n_axes && same; i++) {
        const ssfr_axis *axis = &spec->axes[i];
        if (ssfr_rig_makes_frames(rig->own.cpu, axis) && strcmp(axis->key, "backend") != 0)
            same = c->index[i] == index[i];
    }
    return same;
}

static void hold(cached *c, const size_t index[SSFR_MAX_AXES])
{
    memcpy(c->index, index, sizeof c->index);
    c->valid = true;
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

static ssfr_result set_parameters(const ssfr_rig *rig, ssfr_graph *graph, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    const ssfr_sweep_spec *spec = rig->o->spec;
    for (int i = 0; i < spec->n_axes && result == SSFR_OK; i++)
        if (ssfr_axis_is_parameter(spec->axes[i].key) && ssfr_graph_row(graph, spec->axes[i].key))
            result = ssfr_graph_set(graph, spec->axes[i].key, spec->axes[i].values[index[i]]);
    return result;
}

static ssfr_result take(const ssfr_rig *rig, ssfr_shot *shot, const ssfr_graph *graph, const ssfr_pipeline *pipeline)
{
    const ssfr_camera *camera = &rig->stage->scene.camera;
    return ssfr_shot_take(shot, graph, pipeline, camera->w, camera->h);
}

/* The run that one is held against. */
static void find_base(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES], size_t base[SSFR_MAX_AXES])
{
    memcpy(base, index, SSFR_MAX_AXES * sizeof *base);
    for (int i = 0; i < spec->against.cells.n; i++) {
        const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, spec->against.cells.items[i].key);
        size_t *at = &base[axis - spec->axes];
        for (*at = 0; strcmp(axis->values[*at], spec->against.cells.items[i].value) != 0;) ++*at;
    }
}

static ssfr_result hash_picture(const ssfr_graph *graph, char text[17])
{
    ssfr_field *picture = NULL;
    const ssfr_result result = ssfr_graph_read(graph, "color", &picture);
    if (result == SSFR_OK) ssfr_inspect_hash(picture, text);
    ssfr_field_destroy(&picture);
    return result;
}

/* Of the last frames of a run's graph and of that which it is held against. */
static ssfr_result compare_pictures(cached *c, const ssfr_subject subjects[SSFR_MAX_SUBJECTS])
{
    ssfr_result result = SSFR_OK;
    char own[17], base[17];
    SSFR_TRY(hash_picture(subjects[0].graph, own));
    SSFR_TRY(hash_picture(subjects[1].graph, base));
    c->same_picture = strcmp(own, base) == 0;
end:
    return result;
}

/* By turns with the frame that it is held against, where there is one. What is compared but goes into no picture is not
 * to be paid for: only results are wanted while they are timed. */
static ssfr_result measure(ssfr_rig *rig, cached *c, ssfr_graph *graph, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    const bool pair = rig->o->spec->against.cells.n > 0;
    ssfr_measured *measured[SSFR_MAX_SUBJECTS] = {NULL, NULL};
    ssfr_subject subjects[SSFR_MAX_SUBJECTS] = {{graph, how_to_run(rig, index)}, {0}};
    const ssfr_pipeline *pipeline = rig->own.outfit.pipeline;
    size_t base[SSFR_MAX_AXES];
    SSFR_TRY(ssfr_shot_want(graph, pipeline, false));
    if (pair) {
        find_base(rig->o->spec, index, base);
        SSFR_TRY(sit(rig, &rig->base, base));
        subjects[1] = (ssfr_subject){graph == rig->own.gl ? rig->base.gl : rig->base.cpu, how_to_run(rig, base)};
        SSFR_TRY(set_parameters(rig, subjects[1].graph, base));
        SSFR_TRY(ssfr_shot_want(subjects[1].graph, rig->base.outfit.pipeline, false));
        SSFR_TRY(ssfr_play(subjects[1].graph, rig->stage, &rig->o->stage, -1));
    }
    SSFR_TRY(ssfr_measure_subjects(measured, &c->paired, pair ? 2 : 1, subjects, &rig->stage->scene,
                                   &rig->o->measure));
    c->same_picture = NAN;
    if (pair) SSFR_TRY(compare_pictures(c, subjects));
    c->measured = measured[0];
    measured[0] = NULL;
    SSFR_TRY(ssfr_shot_want(graph, pipeline, true));
    if (pair) SSFR_TRY(ssfr_shot_want(subjects[1].graph, rig->base.outfit.pipeline, true));
end:
    ssfr_measured_destroy(&measured[0]);
    ssfr_measured_destroy(&measured[1]);
    return result;
}

/* After the shot is taken: the frame more, with all images, is another. */
static ssfr_result inspect(const ssfr_rig *rig, cached *c, ssfr_graph *graph, const ssfr_run_options *run)
{
    ssfr_result result = SSFR_OK;
    c->report = *ssfr_graph_report(graph);
    ssfr_inspect_left_out(c->measured->n_nodes, c->measured->reports, c->left_out, sizeof c->left_out);
    SSFR_TRY(ssfr_inspect_frame(&c->inspected, graph, &rig->stage->scene, run));
    SSFR_TRY(ssfr_inspect_foam(&c->foam_share, &c->spray_share, graph));
end:
    return result;
}

/* The frame of a run by one of a seat's graphs, measured when asked for. */
static ssfr_result ensure_frame(ssfr_rig *rig, seat *s, bool on_gpu, const size_t index[SSFR_MAX_AXES], bool measured)
{
    ssfr_result result = SSFR_OK;
    cached *c = on_gpu ? &s->frame : &s->twin;
    ssfr_graph *graph = on_gpu ? s->gl : s->cpu;
    const ssfr_run_options run = how_to_run(rig, index);
    if (holds(c, rig, index) && (c->measured || !measured)) return SSFR_OK;
    forget(c);
    SSFR_TRY(set_parameters(rig, graph, index));
    SSFR_TRY(ssfr_play(graph, rig->stage, &rig->o->stage, -1));
    if (measured) SSFR_TRY(measure(rig, c, graph, index));
    SSFR_TRY(ssfr_graph_run(graph, &rig->stage->scene, &run));
    SSFR_TRY(take(rig, &c->shot, graph, s->outfit.pipeline));
    if (measured) SSFR_TRY(inspect(rig, c, graph, &run));
    hold(c, index);
end:
    return result;
}

static ssfr_result cast_truth(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    const ssfr_stage_options *stage = &rig->o->stage;
    const ssfr_truth_options options = {.every = 1, .seed = stage->seed, .cache = stage->cache, .progress = true};
    const ssfr_variant *variant = ssfr_sweep_spec_variant_of(rig->o->spec, index);
    ssfr_truth_params params;
    SSFR_TRY(ssfr_rig_truth_params(&params, rig->o->spec, variant, rig->stage->description));
    SSFR_TRY(ssfr_rig_truth_vary(&params, rig->o->spec, index));
    SSFR_TRY(ssfr_rig_truth_cast(&rig->of_reference.shot, rig->truth_values, rig->stage, &params, &options));
end:
    return result;
}

static ssfr_result ensure_reference(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    cached *c = &rig->of_reference;
    if (holds_reference(rig, index)) return SSFR_OK;
    forget(c);
    for (int i = 0; i < SSFR_N_COLUMNS; i++) rig->truth_values[i] = NAN;
    if (rig->o->spec->compared_with == SSFR_REFERENCE_TRUTH) {
        SSFR_TRY(cast_truth(rig, index));
    } else {
        SSFR_TRY(sit_reference(rig, index));
        SSFR_TRY(ssfr_play(rig->reference, rig->stage, &rig->o->stage, -1));
        SSFR_TRY(ssfr_graph_run(rig->reference, &rig->stage->scene, NULL));
        SSFR_TRY(take(rig, &c->shot, rig->reference, rig->of_reference_graph.pipeline));
    }
    hold(c, index);
end:
    return result;
}

/* ---- one run ----------------------------------------------------------------------------------------------------- */

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

/* What the frame tells by itself. */
static ssfr_result put_frame(const ssfr_rig *rig, const cached *c, double bandwidth, ssfr_rig_row *row)
{
    const ssfr_field *picture = c->shot.parts[SSFR_SHOT_COLOUR];
    if (c->measured) {
        put_times(c->measured, bandwidth, row->values);
        row->values[SSFR_COLUMN_ms_saved] = c->paired.saved;
        row->values[SSFR_COLUMN_ms_ratio] = c->paired.ratio;
        row->values[SSFR_COLUMN_ms_ratio_mad] = c->paired.ratio_mad;
        row->values[SSFR_COLUMN_same_picture] = c->same_picture;
        row->values[SSFR_COLUMN_covered] = c->report.covered;
        row->values[SSFR_COLUMN_packets] = c->report.n_packets;
        row->values[SSFR_COLUMN_packets_seen] = c->report.n_packets_seen;
        row->values[SSFR_COLUMN_particles_seen] = c->report.n_particles;
        row->values[SSFR_COLUMN_foam_share] = c->foam_share;
        row->values[SSFR_COLUMN_spray_share] = c->spray_share;
        row->values[SSFR_COLUMN_border_share] = c->inspected.border_share;
        row->values[SSFR_COLUMN_finite] = c->inspected.finite;
        row->values[SSFR_COLUMN_bounded] = c->inspected.bounded;
        memcpy(row->texts[SSFR_COLUMN_TEXT_left_out], c->left_out, sizeof c->left_out);
    }
    row->values[SSFR_COLUMN_camera_time] = rig->camera_time;
    row->values[SSFR_COLUMN_simulation_ms] = rig->stage->simulation_ms;
    if (picture) ssfr_inspect_hash(picture, row->texts[SSFR_COLUMN_TEXT_color_hash]);
    return ssfr_shot_count_nan(&c->shot, row->values);
}

/* The next run is the same on the CPU: then the twin is measured now and serves both. */
static bool cpu_is_next(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES])
{
    int last = spec->n_axes - 1;
    while (last > 0 && spec->axes[last].n == 1) last--; /* what is not varied stands anywhere */
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

static ssfr_result run_gl(ssfr_rig *rig, seat *s, const size_t index[SSFR_MAX_AXES], bool measured, ssfr_rig_row *row)
{
    ssfr_result result = SSFR_OK;
    const ssfr_rig_options *o = rig->o;
    const ssfr_shot *frame = &s->frame.shot, *twin = o->no_twin ? NULL : &s->twin.shot;
    SSFR_TRY(ensure_frame(rig, s, true, index, measured));
    SSFR_TRY(put_frame(rig, &s->frame, o->bandwidth_gl, row));
    if (twin) {
        SSFR_TRY(ensure_frame(rig, s, false, index, measured && cpu_is_next(o->spec, index)));
        SSFR_TRY(ssfr_shot_compare_twin(frame, twin, row->values));
    }
    SSFR_TRY(compare(rig, index, frame, twin, row->values));
end:
    return result;
}

static ssfr_result run_cpu(ssfr_rig *rig, seat *s, const size_t index[SSFR_MAX_AXES], bool measured, ssfr_rig_row *row)
{
    ssfr_result result = SSFR_OK;
    const ssfr_shot *twin = &s->twin.shot;
    SSFR_TRY(ensure_frame(rig, s, false, index, measured));
    SSFR_TRY(put_frame(rig, &s->twin, rig->o->bandwidth_cpu, row));
    SSFR_TRY(compare(rig, index, twin, twin, row->values));
end:
    return result;
}

static void clear(ssfr_rig_row *row)
{
    for (int i = 0; i < SSFR_N_COLUMNS; i++) row->values[i] = NAN;
    for (int i = 0; i < SSFR_N_COLUMN_TEXTS; i++) row->texts[i][0] = '\0';
    for (int i = 0; i < SSFR_MAX_ADDED; i++) row->added[i] = NAN;
}

static ssfr_result run_in(ssfr_rig *rig, seat *s, const size_t index[SSFR_MAX_AXES], bool measured, ssfr_rig_row *row)
{
    ssfr_result result = SSFR_OK;
    const bool on_gpu = strcmp(value_of(rig, index, "backend"), "gl") == 0;
    SSFR_TRY(sit(rig, s, index));
    SSFR_TRY(on_gpu ? run_gl(rig, s, index, measured, row) : run_cpu(rig, s, index, measured, row));
end:
    return result;
}

/* The row that this one is held against, of which times are not asked: kept for all that follow each other. */
static ssfr_result ensure_base_row(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    size_t base[SSFR_MAX_AXES];
    find_base(rig->o->spec, index, base);
    if (rig->has_base_row && memcmp(base, rig->base_index, sizeof base) == 0) return SSFR_OK;
    rig->has_base_row = false;
    clear(&rig->base_row);
    SSFR_TRY(run_in(rig, &rig->base, base, false, &rig->base_row));
    memcpy(rig->base_index, base, sizeof base);
    rig->has_base_row = true;
end:
    return result;
}

static ssfr_result subtract(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], ssfr_rig_row *row)
{
    ssfr_result result = SSFR_OK;
    const ssfr_against_spec *against = &rig->o->spec->against;
    if (against->n_added > 0) SSFR_TRY(ensure_base_row(rig, index));
    for (int i = 0; i < against->n_added; i++) {
        const ssfr_column *column = ssfr_column_find(against->added[i]);
        row->added[i] = row->values[column - ssfr_columns] - rig->base_row.values[column - ssfr_columns];
    }
end:
    return result;
}

ssfr_result ssfr_rig_run(ssfr_rig *rig, const size_t index[SSFR_MAX_AXES], ssfr_rig_row *row)
{
    ssfr_result result = SSFR_OK;
    clear(row);
    SSFR_TRY(set_stage(rig, index));
    SSFR_TRY(run_in(rig, &rig->own, index, true, row));
    SSFR_TRY(subtract(rig, index, row));
end:
    return result;
}

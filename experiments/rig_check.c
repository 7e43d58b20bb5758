/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rig_check.c: whether a sweep can run: every key, value, variant, camera and comparison, before the first frame. */
#include "experiments/rig.h"
#include "experiments/setup.h"

#include <errno.h>
#include <unistd.h>

/* ---- parameters -------------------------------------------------------------------------------------------------- */

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

static ssfr_result check_axis(const target *t, const ssfr_axis *axis)
{
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < axis->n && ssfr_axis_is_parameter(axis->key) && result == SSFR_OK; i++)
        result = check_parameter(t, axis->where, axis->key, axis->values[i]);
    return result;
}

/* All that is set and varied, by what one pipeline takes. */
static ssfr_result check_pipeline(const ssfr_sweep_spec *spec, const ssfr_variant *variant, const char *where,
                                  const char *name)
{
    ssfr_result result = SSFR_OK;
    ssfr_truth_params truth;
    target t = {.truth = spec->compared_with == SSFR_REFERENCE_TRUTH ? &truth : NULL};
    ssfr_truth_defaults(&truth);
    ssfr_log_about(where);
    result = ssfr_setup_find_pipeline(&t.pipeline, name);
    ssfr_log_about(NULL);
    if (result != SSFR_OK) goto end;
    SSFR_TRY(ssfr_graph_create(&t.graph, t.pipeline, NULL));
    SSFR_TRY(check_settings(&t, &spec->settings));
    for (int i = 0; i < spec->n_axes; i++) SSFR_TRY(check_axis(&t, &spec->axes[i]));
    if (variant) SSFR_TRY(check_settings(&t, &variant->settings));
    SSFR_TRY(check_settings(&t, &spec->reference));
end:
    ssfr_graph_destroy(&t.graph);
    return result;
}

/* Those that a variant (NULL: there are none) runs with. */
static ssfr_result check_pipelines(const ssfr_sweep_spec *spec, const ssfr_variant *variant)
{
    ssfr_result result = SSFR_OK;
    const ssfr_setting *own = ssfr_variant_own(variant, "pipeline");
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, "pipeline");
    if (own) return check_pipeline(spec, variant, own->where, own->value);
    if (!axis) return check_pipeline(spec, variant, "default", SSFR_SWEEP_PIPELINE);
    for (size_t i = 0; i < axis->n && result == SSFR_OK; i++)
        result = check_pipeline(spec, variant, axis->where, axis->values[i]);
    return result;
}

/* ---- values of what is no parameter ------------------------------------------------------------------------------ */

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

static ssfr_result check_variant_name(const ssfr_sweep_spec *spec, const char *where, const char *name)
{
    char list[600] = "none";
    size_t used = 0;
    if (ssfr_sweep_spec_variant(spec, name)) return SSFR_OK;
    for (int i = 0; i < spec->n_variants; i++) ssfr_list_name(list, sizeof list, &used, spec->variants[i]->name);
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: %s: no such variant; there are %s", where, name, list);
}

/* A whole number from 0 that is less than `end`. */
static bool is_index(const char *text, long end)
{
    double number;
    return ssfr_parse_number(text, &number) && number >= 0 && number < (double)end && number == floor(number);
}

static ssfr_result check_value(const ssfr_sweep_spec *spec, const char *where, const char *key, const char *value)
{
    int size[2];
    bool flag;
    if (strcmp(key, "scene") == 0) return check_scene(where, value);
    if (strcmp(key, "variant") == 0) return check_variant_name(spec, where, value);
    if (strcmp(key, "size") == 0 && !ssfr_rig_size(value, size))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: size %s: expected WxH, sides from 1 to %d px", where, value,
                         SSFR_MAX_SIZE);
    if (strcmp(key, "backend") == 0 && strcmp(value, "gl") != 0 && strcmp(value, "cpu") != 0)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: backend %s: expected gl or cpu", where, value);
    if ((strcmp(key, "leave_out") == 0 || strcmp(key, "cull") == 0) && !ssfr_rig_flag(value, &flag))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %s %s: expected true or false", where, key, value);
    if (strcmp(key, "frame") == 0 && !is_index(value, SSFR_MAX_FRAME + 1))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: frame %s: expected a whole number from 0", where, value);
    if (strcmp(key, "view") == 0 && !is_index(value, (long)spec->path.views))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: view %s: the path has %zu, from 0", where, value, spec->path.views);
    return SSFR_OK;
}

static ssfr_result check_values(const ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < spec->n_axes; i++) {
        const ssfr_axis *axis = &spec->axes[i];
        for (size_t k = 0; k < axis->n && !ssfr_axis_is_parameter(axis->key); k++)
            SSFR_TRY(check_value(spec, axis->where, axis->key, axis->values[k]));
    }
end:
    return result;
}

/* Of several values a run would have one, and its variant another. */
static ssfr_result check_own(const ssfr_sweep_spec *spec, const ssfr_variant *variant)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < variant->own.n; i++) {
        const ssfr_setting *own = &variant->own.items[i];
        const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, own->key);
        if (axis && axis->n > 1)
            return ssfr_fail(SSFR_ERR_VALUE, "%s: variant %s has a %s of its own, and %s has several", own->where,
                             variant->name, own->key, axis->where);
        SSFR_TRY(check_value(spec, own->where, own->key, own->value));
    }
end:
    return result;
}

static ssfr_result check_variants(const ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, "variant");
    if (!axis) return check_pipelines(spec, NULL);
    for (size_t i = 0; i < axis->n; i++) {
        const ssfr_variant *variant = ssfr_sweep_spec_variant(spec, axis->values[i]);
        SSFR_TRY(check_own(spec, variant));
        SSFR_TRY(check_pipelines(spec, variant));
    }
end:
    return result;
}

/* ---- cameras and their paths ------------------------------------------------------------------------------------- */

static ssfr_result check_view(const ssfr_sweep_spec *spec, const ssfr_stage_options *stage_options,
                              const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    ssfr_stage_options options = *stage_options;
    const char *camera = ssfr_sweep_spec_value(spec, index, "camera");
    const ssfr_axis *views = ssfr_sweep_spec_axis(spec, "view");
    ssfr_stage *stage = NULL;
    const ssfr_view *view;
    if (camera) options.camera = camera;
    if (!camera && !views) return SSFR_OK;
    ssfr_log_about(views ? views->where : ssfr_sweep_spec_where(spec, index, "camera"));
    SSFR_TRY(ssfr_stage_open(&stage, ssfr_sweep_spec_value(spec, index, "scene"), &options));
    SSFR_TRY(views ? ssfr_stage_find_path(stage, &options, spec->path.frames == SSFR_PATH_FOLLOW, &view)
                   : ssfr_stage_find_view(stage, &options, &view));
end:
    ssfr_log_about(NULL);
    ssfr_stage_destroy(&stage);
    return result;
}

/* What says which frame, or where the camera is on its path, says it alone. */
static ssfr_result check_times(const ssfr_sweep_spec *spec, const ssfr_stage_options *stage)
{
    const ssfr_axis *views = ssfr_sweep_spec_axis(spec, "view"), *frame = ssfr_sweep_spec_axis(spec, "frame");
    const bool follow = views && spec->path.frames == SSFR_PATH_FOLLOW;
    if (views && !isnan(stage->camera_time))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: path: --camera-time says where the camera is, too", views->where);
    if (follow && (frame || stage->frame >= 0 || !isnan(stage->time)))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: path: the frames follow the camera: %s says which, too", views->where,
                         frame ? frame->where : "--frame or --time");
    if (frame && !isnan(stage->time))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: frame: --time says which, too", frame->where);
    return SSFR_OK;
}

static ssfr_result check_views(const ssfr_sweep_spec *spec, const ssfr_stage_options *stage)
{
    static const char *const keys[] = {"variant", "scene", "camera"};
    ssfr_result result = check_times(spec, stage);
    size_t index[SSFR_MAX_AXES] = {0};
    bool more = true;
    while (more && result == SSFR_OK) {
        result = check_view(spec, stage, index);
        more = ssfr_sweep_spec_next(spec, SSFR_COUNT(keys), keys, index);
    }
    return result;
}

/* ---- what rows are held against ---------------------------------------------------------------------------------- */

/* Both rows are of one stage, on one backend: nothing else can be measured by turns. */
static ssfr_result check_cell(const ssfr_sweep_spec *spec, const ssfr_setting *cell)
{
    static const char *const keys[] = {"pipeline", "variant", "leave_out", "cull"};
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, cell->key);
    bool fits = ssfr_axis_is_parameter(cell->key) && !is_for_truth(cell->key), found = false;
    for (size_t i = 0; i < SSFR_COUNT(keys); i++) fits |= strcmp(keys[i], cell->key) == 0;
    if (!axis) return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: against: %s is no axis of the sweep", cell->where, cell->key);
    if (!fits)
        return ssfr_fail(SSFR_ERR_VALUE,
                         "%s: against: %s: only pipeline, variant, leave_out, cull and parameters of passes can be "
                         "held against each other",
                         cell->where, cell->key);
    for (size_t i = 0; i < axis->n; i++) found |= strcmp(axis->values[i], cell->value) == 0;
    return found ? SSFR_OK
                 : ssfr_fail(SSFR_ERR_VALUE, "%s: against: %s has no value %s", cell->where, cell->key, cell->value);
}

static ssfr_result check_same_stage(const ssfr_sweep_spec *spec, const ssfr_setting *cell)
{
    static const char *const keys[] = {"scene", "camera", "frame", "size"};
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, "variant");
    const ssfr_variant *base = ssfr_sweep_spec_variant(spec, cell->value);
    for (size_t i = 0; i < axis->n; i++)
        for (size_t k = 0; k < SSFR_COUNT(keys); k++) {
            const ssfr_variant *variant = ssfr_sweep_spec_variant(spec, axis->values[i]);
            const ssfr_setting *a = ssfr_variant_own(variant, keys[k]), *b = ssfr_variant_own(base, keys[k]);
            if (!a != !b || (a && strcmp(a->value, b->value) != 0))
                return ssfr_fail(SSFR_ERR_VALUE, "%s: against: variants %s and %s differ in their %s", cell->where,
                                 variant->name, base->name, keys[k]);
        }
    return SSFR_OK;
}

/* Columns of errors: those of times have their own. */
static ssfr_result check_added(const ssfr_sweep_spec *spec)
{
    const ssfr_against_spec *against = &spec->against;
    for (int i = 0; i < against->n_added; i++) {
        const ssfr_column *column = ssfr_column_find(against->added[i]);
        const bool fits = column && column >= &ssfr_columns[SSFR_COLUMN_nan_count] &&
                          column < &ssfr_columns[SSFR_N_COLUMNS];
        if (!fits)
            return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: added: %s is no column of errors", against->where,
                             against->added[i]);
        for (int k = 0; k < i; k++)
            if (strcmp(against->added[k], against->added[i]) == 0)
                return ssfr_fail(SSFR_ERR_VALUE, "%s: added: %s stands twice", against->where, against->added[i]);
    }
    if (against->n_added && !against->cells.n)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: added: to what? there is no against", against->where);
    return SSFR_OK;
}

static ssfr_result check_against(const ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < spec->against.cells.n; i++) {
        const ssfr_setting *cell = &spec->against.cells.items[i];
        SSFR_TRY(check_cell(spec, cell));
        if (strcmp(cell->key, "variant") == 0) SSFR_TRY(check_same_stage(spec, cell));
    }
    SSFR_TRY(check_added(spec));
end:
    return result;
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_rig_check(const ssfr_sweep_spec *spec, const ssfr_stage_options *stage)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(check_values(spec));
    SSFR_TRY(check_variants(spec));
    SSFR_TRY(check_against(spec));
    SSFR_TRY(check_views(spec, stage));
end:
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* setup.c: finding pipelines and passes by name, and a graph with the user's settings. */
#include "experiments/setup.h"

#include "base/param.h"
#include "graph/graph.h"

#define ROW(...) SSFR_OPTION(ssfr_setup_options, __VA_ARGS__)
const ssfr_option ssfr_setup_rows[] = {
    ROW(pipeline, "pipeline", 'p', TEXT, "NAME", "what to render with (default vanderlaan2009; see ssfr pipelines)", 0,
        0),
    ROW(backend, "backend", 0, WORD, "gl|cpu", "OpenGL (default), or the double-precision twins on the CPU", 0, 0),
    ROW(settings, "set", 's', LIST, "KEY=VALUE",
        "set node.param, pass.param, medium|light|sky|floor.param or node.off; can be repeated", 0, 0),
    SSFR_OPTION_END,
};

void ssfr_setup_defaults(ssfr_setup_options *options)
{
    *options = (ssfr_setup_options){.pipeline = "vanderlaan2009", .backend = SSFR_BACKEND_GL};
}

/* Logs that `name` is none of the names that at(i) gives. */
static ssfr_result fail_unknown(const char *what, const char *name, const char *(*at)(int i))
{
    char names[768] = "";
    size_t used = 0;
    for (int i = 0; at(i); i++) ssfr_list_name(names, sizeof names, &used, at(i));
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no such %s; there are %s", name, what, names);
}

static const char *pipeline_name_at(int i)
{
    return ssfr_pipeline_at(i) ? ssfr_pipeline_name(ssfr_pipeline_at(i)) : NULL;
}

static const char *pass_name_at(int i)
{
    return ssfr_pass_at(i) ? ssfr_pass_name(ssfr_pass_at(i)) : NULL;
}

ssfr_result ssfr_setup_find_pipeline(const ssfr_pipeline **out, const char *name)
{
    *out = ssfr_pipeline_find(name);
    return *out ? SSFR_OK : fail_unknown("pipeline", name, pipeline_name_at);
}

ssfr_result ssfr_setup_find_pass(const ssfr_pass **out, const char *name)
{
    *out = ssfr_pass_find(name);
    return *out ? SSFR_OK : fail_unknown("pass", name, pass_name_at);
}

ssfr_result ssfr_setup_split(const char *setting, char key[256], const char **value)
{
    const size_t length = strcspn(setting, "=");
    if (!setting[length] || length == 0 || length >= 256)
        return ssfr_fail(SSFR_ERR_VALUE, "--set %s: expected KEY=VALUE", setting);
    snprintf(key, 256, "%.*s", (int)length, setting);
    *value = setting + length + 1;
    return SSFR_OK;
}

static ssfr_result apply_one(ssfr_graph *graph, const char *setting)
{
    char key[256];
    const char *value;
    const ssfr_result result = ssfr_setup_split(setting, key, &value);
    return result == SSFR_OK ? ssfr_graph_set(graph, key, value) : result;
}

/* Sets each "key=value" of the list. */
static ssfr_result apply(ssfr_graph *graph, const ssfr_list *settings)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < settings->n && result == SSFR_OK; i++) result = apply_one(graph, settings->items[i]);
    return result;
}

ssfr_result ssfr_setup_init(ssfr_setup *setup, const ssfr_setup_options *options, const ssfr_pass *pass)
{
    ssfr_result result = SSFR_OK;
    *setup = (ssfr_setup){0};
    if (!pass) SSFR_TRY(ssfr_setup_find_pipeline(&setup->pipeline, options->pipeline));
    if (options->backend == SSFR_BACKEND_GL) SSFR_TRY(ssfr_gl_create(&setup->gl, SSFR_GL_OWN));
    if (pass)
        SSFR_TRY(ssfr_graph_create_for_pass(&setup->graph, pass, setup->gl));
    else
        SSFR_TRY(ssfr_graph_create(&setup->graph, setup->pipeline, setup->gl));
    SSFR_TRY(apply(setup->graph, &options->settings));
end:
    if (result != SSFR_OK) ssfr_setup_finish(setup);
    return result;
}

/* "bilateral.sigma" is of a pass, which the pipeline need not have; "medium.ior" is of all. */
static bool is_of_another_pass(const ssfr_graph *graph, const char *key)
{
    char name[64];
    const size_t head = strcspn(key, ".");
    snprintf(name, sizeof name, "%.*s", (int)head, key);
    const ssfr_pass *pass = key[head] ? ssfr_pass_find(name) : NULL;
    return !ssfr_graph_row(graph, key) && pass && ssfr_param_find(ssfr_pass_params(pass), key + head + 1);
}

ssfr_result ssfr_setup_apply_scene(ssfr_graph *graph, const ssfr_description *description)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < description->n_settings && result == SSFR_OK; i++) {
        const ssfr_scene_setting *s = &description->settings[i];
        ssfr_log_about(s->where);
        if (!is_of_another_pass(graph, s->key)) result = ssfr_graph_set(graph, s->key, s->value);
        ssfr_log_about(NULL);
    }
    return result;
}

ssfr_result ssfr_setup_scene(ssfr_setup *setup, const ssfr_setup_options *options,
                             const ssfr_description *description)
{
    ssfr_result result = SSFR_OK;
    if (!description) return SSFR_OK;
    SSFR_TRY(ssfr_setup_apply_scene(setup->graph, description));
    SSFR_TRY(apply(setup->graph, &options->settings));
end:
    return result;
}

/* The user's image of the scene takes the place of the pipeline's own. */
static ssfr_result import(ssfr_graph *graph, const char *path, const char *slot, const ssfr_camera *camera)
{
    ssfr_field *field = NULL;
    ssfr_result result = ssfr_exr_load(path, ssfr_slot_channels(slot), &field);
    if (result == SSFR_OK && (field->w != camera->w || field->h != camera->h))
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: %dx%d pixels, the image has %dx%d: add --size %dx%d", path, field->w,
                           field->h, camera->w, camera->h, field->w, field->h);
    if (result == SSFR_OK) result = ssfr_graph_import(graph, slot, field);
    ssfr_field_destroy(&field);
    return result;
}

ssfr_result ssfr_setup_background(ssfr_graph *graph, const char *path, const ssfr_camera *camera)
{
    ssfr_result result = SSFR_OK;
    if (!path) return SSFR_OK;
    SSFR_TRY(import(graph, path, "scene_color", camera));
    SSFR_TRY(import(graph, path, "scene_depth", camera));
end:
    return result;
}

void ssfr_setup_finish(ssfr_setup *setup)
{
    ssfr_graph_destroy(&setup->graph);
    ssfr_gl_destroy(&setup->gl);
    *setup = (ssfr_setup){0};
}

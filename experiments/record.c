/* SPDX-License-Identifier: GPL-3.0-or-later */
/* record.c: collecting what reproduces a frame. */
#include "experiments/record.h"
#include "experiments/scenes/make.h"

#include "base/param.h"

static ssfr_result copy_text(const char **out, const char *text)
{
    char *copy = NULL;
    const ssfr_result result = ssfr_text_print(&copy, "a record", "%s", text);
    *out = copy;
    return result;
}

static ssfr_result add(ssfr_record *record, const char *name, const char *text, double number)
{
    ssfr_result result = SSFR_OK;
    if ((size_t)record->n == record->capacity) {
        const size_t capacity = record->capacity ? 2 * record->capacity : 64;
        ssfr_attribute *items = realloc(record->items, capacity * sizeof *items);
        if (!items) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for a record of %zu items", capacity);
        record->items = items;
        record->capacity = capacity;
    }
    ssfr_attribute *item = &record->items[record->n++];
    *item = (ssfr_attribute){.number = number};
    SSFR_TRY(copy_text(&item->name, name));
    if (text) SSFR_TRY(copy_text(&item->text, text));
end:
    return result;
}

ssfr_result ssfr_record_text(ssfr_record *record, const char *name, const char *text)
{
    return add(record, name, text, 0);
}

ssfr_result ssfr_record_number(ssfr_record *record, const char *name, double number)
{
    return add(record, name, NULL, number);
}

ssfr_result ssfr_record_params(ssfr_record *record, const char *prefix, const ssfr_param *rows, const void *from)
{
    ssfr_result result = SSFR_OK;
    for (const ssfr_param *row = rows; row->name && result == SSFR_OK; row++) {
        char name[64], text[64];
        snprintf(name, sizeof name, "%s.%s", prefix, row->name);
        ssfr_param_format(row, from, text, sizeof text);
        result = row->words ? ssfr_record_text(record, name, text)
                            : ssfr_record_number(record, name, ssfr_param_number(row, from));
    }
    return result;
}

void ssfr_record_finish(ssfr_record *record)
{
    for (int i = 0; i < record->n; i++) {
        free((char *)record->items[i].name);
        free((char *)record->items[i].text);
    }
    free(record->items);
    *record = (ssfr_record){0};
}

/* ---- the command line -------------------------------------------------------------------------------------------- */

/* A word in single quotes where the shell would take it apart; text NULL counts only. Returns the length. */
static size_t quote(const char *word, char *text)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
    const bool quoted = !word[0] || word[strspn(word, plain)];
    size_t n = 0;
#define PUT(c) (text ? (void)(text[n] = (c)) : (void)0, n++)
    if (quoted) PUT('\'');
    for (; *word; word++) {
        if (*word == '\'') PUT('\''), PUT('\\'), PUT('\'');
        PUT(*word);
    }
    if (quoted) PUT('\'');
#undef PUT
    return n;
}

static ssfr_result add_command(ssfr_record *record, int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    char *text = NULL;
    size_t length = sizeof "ssfr";
    for (int i = 0; i < argc; i++) length += quote(argv[i], NULL) + 1;
    SSFR_TRY(ssfr_alloc(&text, length, 1, "the command line"));
    char *at = text + sprintf(text, "ssfr");
    for (int i = 0; i < argc; i++) {
        *at++ = ' ';
        at += quote(argv[i], at);
    }
    SSFR_TRY(ssfr_record_text(record, "command", text));
end:
    free(text);
    return result;
}

ssfr_result ssfr_record_program(ssfr_record *record, const ssfr_setup *setup, const ssfr_command_line *line, int argc,
                                char **argv)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_record_text(record, "ssfr", ssfr_version()));
    SSFR_TRY(add_command(record, argc, argv));
    SSFR_TRY(ssfr_record_number(record, "seed", (double)line->seed));
    if (setup->pipeline) SSFR_TRY(ssfr_record_text(record, "pipeline", ssfr_pipeline_name(setup->pipeline)));
    SSFR_TRY(ssfr_record_text(record, "backend", setup->gl ? "gl" : "cpu"));
    if (setup->gl) SSFR_TRY(ssfr_record_text(record, "gl.renderer", ssfr_gl_renderer(setup->gl)));
    if (setup->gl) SSFR_TRY(ssfr_record_text(record, "gl.version", ssfr_gl_version(setup->gl)));
end:
    return result;
}

/* ---- scene and parameters ---------------------------------------------------------------------------------------- */

static ssfr_result add_vector(ssfr_record *record, const char *name, const double v[3])
{
    ssfr_result result = SSFR_OK;
    for (int k = 0; k < 3 && result == SSFR_OK; k++) {
        char full[64];
        snprintf(full, sizeof full, "%s.%c", name, "xyz"[k]);
        result = ssfr_record_number(record, full, v[k]);
    }
    return result;
}

/* Which frame of which simulation, and what the scene sets by itself. */
static ssfr_result add_frame(ssfr_record *record, const ssfr_stage *stage)
{
    ssfr_result result = SSFR_OK;
    const ssfr_description *d = stage->description;
    if (stage->frame >= 0) SSFR_TRY(ssfr_record_number(record, "scene.frame", (double)stage->frame));
    if (!d) goto end;
    SSFR_TRY(ssfr_record_number(record, "scene.time", stage->time));
    SSFR_TRY(ssfr_record_text(record, "scene.scale", ssfr_scale_words[d->scale]));
    SSFR_TRY(ssfr_record_text(record, "scene.key", strrchr(stage->folder, '-') + 1));
    for (int i = 0; i < d->n_settings; i++) {
        char name[128];
        snprintf(name, sizeof name, "scene.set.%.100s", d->settings[i].key);
        SSFR_TRY(ssfr_record_text(record, name, d->settings[i].value));
    }
end:
    return result;
}

ssfr_result ssfr_record_stage(ssfr_record *record, const ssfr_stage *stage)
{
    ssfr_result result = SSFR_OK;
    const ssfr_camera *camera = &stage->scene.camera;
    SSFR_TRY(ssfr_record_text(record, "scene", stage->name));
    SSFR_TRY(add_frame(record, stage));
    SSFR_TRY(ssfr_record_number(record, "scene.particles", (double)stage->particles->n));
    SSFR_TRY(ssfr_record_number(record, "scene.radius", stage->particles->radius));
    SSFR_TRY(ssfr_record_number(record, "scene.floor", stage->scene.floor));
    SSFR_TRY(add_vector(record, "camera.eye", camera->eye));
    SSFR_TRY(add_vector(record, "camera.right", camera->right));
    SSFR_TRY(add_vector(record, "camera.up", camera->up));
    SSFR_TRY(add_vector(record, "camera.back", camera->back));
    SSFR_TRY(ssfr_record_number(record, "camera.fov_deg", 2 * atan(camera->tan_y) * 180 / acos(-1)));
    SSFR_TRY(ssfr_record_number(record, "camera.tan_x", camera->tan_x));
    SSFR_TRY(ssfr_record_number(record, "camera.tan_y", camera->tan_y));
    SSFR_TRY(ssfr_record_number(record, "camera.near", camera->near));
    SSFR_TRY(ssfr_record_number(record, "camera.far", camera->far));
end:
    return result;
}

ssfr_result ssfr_record_graph(ssfr_record *record, const ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; ssfr_graph_key_at(graph, i); i++) {
        const char *key = ssfr_graph_key_at(graph, i);
        const ssfr_param *row = ssfr_graph_row(graph, key);
        char text[256];
        double number;
        SSFR_TRY(ssfr_graph_get(graph, key, text, sizeof text));
        if (row && row->type != SSFR_CHOICE && row->type != SSFR_SET && ssfr_parse_number(text, &number))
            SSFR_TRY(ssfr_record_number(record, key, number));
        else
            SSFR_TRY(ssfr_record_text(record, key, text));
    }
end:
    return result;
}

void ssfr_record_item_json(const ssfr_attribute *item, ssfr_json *json)
{
    if (item->text)
        ssfr_json_text(json, item->name, item->text);
    else
        ssfr_json_number(json, item->name, item->number);
}

void ssfr_record_json(const ssfr_record *record, ssfr_json *json)
{
    for (int i = 0; i < record->n; i++) ssfr_record_item_json(&record->items[i], json);
}

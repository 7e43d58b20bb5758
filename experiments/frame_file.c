/* SPDX-License-Identifier: GPL-3.0-or-later */
/* frame_file.c: a frame's slots as files. */
#include "experiments/frame_file.h"
#include "experiments/output.h"

#include "graph/graph.h"

#include <errno.h>

/* What an EXR of a frame holds beside the pipeline's result. */
static const char *const companions[] = {"surface_depth", "normal", "thickness"};

enum { MAX_LAYERS = 1 + SSFR_COUNT(companions) };

static bool has_slot(const ssfr_graph *graph, const char *slot)
{
    bool found = false;
    for (int i = 0; ssfr_graph_slot_at(graph, i) && !found; i++)
        found = strcmp(ssfr_graph_slot_at(graph, i), slot) == 0;
    return found;
}

/* What a slot is the sum of, where a pipeline has it in layers. */
static const char *const whole = "thickness", *const layers[] = {"thickness_back", "thickness_front"};

static bool is_layered(const ssfr_graph *graph, const char *slot)
{
    return strcmp(slot, whole) == 0 && !has_slot(graph, whole) && has_slot(graph, layers[0]);
}

bool ssfr_frame_has(const ssfr_graph *graph, const char *slot)
{
    return has_slot(graph, slot) || is_layered(graph, slot);
}

ssfr_result ssfr_frame_want_slot(ssfr_graph *graph, const char *slot)
{
    ssfr_result result = SSFR_OK;
    if (!is_layered(graph, slot)) return ssfr_graph_want(graph, slot);
    for (size_t i = 0; i < SSFR_COUNT(layers); i++) SSFR_TRY(ssfr_graph_want(graph, layers[i]));
end:
    return result;
}

static const char *result_slot(const ssfr_setup *setup)
{
    return ssfr_slots[setup->pipeline->result].name;
}

ssfr_result ssfr_frame_want(const ssfr_setup *setup)
{
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < SSFR_COUNT(companions) && result == SSFR_OK; i++)
        if (ssfr_frame_has(setup->graph, companions[i])) result = ssfr_frame_want_slot(setup->graph, companions[i]);
    return result;
}

static ssfr_result read_image(ssfr_field **out, const ssfr_graph *graph, const char *slot, int w, int h)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *small = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_graph_read(graph, slot, out));
    if ((*out)->w != 1 || (*out)->h != 1 || (w == 1 && h == 1)) goto end;
    small = *out;
    *out = NULL;
    SSFR_TRY(ssfr_field_create(out, w, h, small->c));
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            memcpy(ssfr_field_at(*out, x, y), small->data, (size_t)small->c * sizeof *small->data);
end:
    ssfr_field_destroy(&small);
    return result;
}

ssfr_result ssfr_frame_read(ssfr_field **out, const ssfr_graph *graph, const char *slot, int w, int h)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *front = NULL;
    if (!is_layered(graph, slot)) return read_image(out, graph, slot, w, h);
    SSFR_TRY(read_image(out, graph, layers[0], w, h));
    SSFR_TRY(read_image(&front, graph, layers[1], w, h));
    for (int i = 0; i < w * h; i++) (*out)->data[i] += front->data[i];
end:
    if (result != SSFR_OK) ssfr_field_destroy(out);
    ssfr_field_destroy(&front);
    return result;
}

ssfr_result ssfr_frame_save_exr(const char *path, const ssfr_setup *setup, int w, int h, const ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    ssfr_layer layers[MAX_LAYERS] = {0};
    const char *slots[MAX_LAYERS] = {result_slot(setup)};
    int n = 1;
    for (size_t i = 0; i < SSFR_COUNT(companions); i++)
        if (ssfr_frame_has(setup->graph, companions[i])) slots[n++] = companions[i];
    for (int i = 0; i < n; i++) {
        layers[i].channels = ssfr_slot_channels(slots[i]);
        SSFR_TRY(ssfr_frame_read(&layers[i].field, setup->graph, slots[i], w, h));
    }
    SSFR_TRY(ssfr_exr_save(path, n, layers, record->n, record->items));
end:
    for (int i = 0; i < n; i++) ssfr_field_destroy(&layers[i].field);
    return result;
}

ssfr_result ssfr_frame_save_png(const char *path, const ssfr_setup *setup, int w, int h)
{
    ssfr_field *field = NULL;
    ssfr_result result = ssfr_frame_read(&field, setup->graph, result_slot(setup), w, h);
    if (result == SSFR_OK) result = ssfr_png_save(path, field);
    ssfr_field_destroy(&field);
    return result;
}

/* ---- what ran ---------------------------------------------------------------------------------------------------- */

const char *ssfr_status_text(ssfr_node_status status)
{
    static const char *const texts[] = {[SSFR_RAN] = "ran", [SSFR_OFF] = "off", [SSFR_UNWANTED] = "unwanted",
                                        [SSFR_NEEDLESS] = "needless", [SSFR_GIVEN] = "given"};
    return texts[status];
}

void ssfr_frame_say(const ssfr_graph *graph)
{
    const ssfr_report *report = ssfr_graph_report(graph);
    for (int i = 0; i < report->n_nodes; i++) {
        const ssfr_node_report *node = &report->nodes[i];
        if (node->unstable > 0)
            ssfr_log(SSFR_WARNING, "%s: its step is longer than %.0f pixels bear, where ripples may grow", node->node,
                     node->unstable);
        if (node->status == SSFR_RAN)
            ssfr_log(SSFR_INFO, "%-16s %9.3f ms  %8.1f MB  %8.1f taps/px", node->node, node->ms, 1e-6 * node->bytes,
                     node->taps);
        else
            ssfr_log(SSFR_INFO, "%-16s left out (%s): %s", node->node, ssfr_status_text(node->status), node->why);
    }
    ssfr_log(SSFR_INFO, "frame %.3f ms, of which planning %.3f ms; %d particles in view, %.0f %% of the tiles",
             report->wall_ms, report->cpu_ms, report->n_particles, 100 * report->covered);
}

static void write_node(ssfr_json *json, const ssfr_node_report *node)
{
    const bool ran = node->status == SSFR_RAN;
    ssfr_json_object(json, NULL);
    ssfr_json_text(json, "node", node->node);
    ssfr_json_text(json, "pass", node->pass);
    ssfr_json_text(json, "status", ssfr_status_text(node->status));
    if (!ran) ssfr_json_text(json, "why", node->why);
    if (ran) {
        ssfr_json_number(json, "ms", node->ms);
        ssfr_json_number(json, "bytes", node->bytes);
        ssfr_json_number(json, "taps_per_pixel", node->taps);
        ssfr_json_number(json, "iterations", node->iterations);
        ssfr_json_number(json, "vertices", node->vertices);
        ssfr_json_number(json, "tiles", node->tiles);
        ssfr_json_number(json, "unstable", node->unstable);
    }
    ssfr_json_close(json);
}

static void write_slots(ssfr_json *json, const ssfr_graph *graph)
{
    ssfr_json_array(json, "slots");
    for (int i = 0; ssfr_graph_slot_at(graph, i); i++) {
        const char *slot = ssfr_graph_slot_at(graph, i);
        ssfr_json_object(json, NULL);
        ssfr_json_text(json, "slot", slot);
        ssfr_json_text(json, "channels", ssfr_slot_channels(slot));
        ssfr_json_text(json, "unit", ssfr_slot_unit(slot));
        ssfr_json_close(json);
    }
    ssfr_json_close(json);
}

static void write_graph(FILE *file, const ssfr_graph *graph, const ssfr_record *record)
{
    const ssfr_report *report = ssfr_graph_report(graph);
    ssfr_json json;
    ssfr_json_init(&json, file);
    ssfr_json_object(&json, NULL);
    ssfr_json_array(&json, "nodes");
    for (int i = 0; i < report->n_nodes; i++) write_node(&json, &report->nodes[i]);
    ssfr_json_close(&json);
    write_slots(&json, graph);
    ssfr_json_number(&json, "wall_ms", report->wall_ms);
    ssfr_json_number(&json, "planning_ms", report->cpu_ms);
    ssfr_json_number(&json, "image_bytes", report->image_bytes);
    ssfr_json_integer(&json, "allocations", report->allocations);
    ssfr_json_integer(&json, "particles_in_view", report->n_particles);
    ssfr_json_integer(&json, "packets", report->n_packets);
    ssfr_json_integer(&json, "packets_in_view", report->n_packets_seen);
    ssfr_json_number(&json, "covered", report->covered);
    ssfr_json_object(&json, "frame");
    ssfr_record_json(record, &json);
    ssfr_json_close(&json);
    ssfr_json_close(&json);
}

static ssfr_result save_graph(const char *path, const ssfr_graph *graph, const ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    ssfr_aside aside = {0};
    FILE *file = NULL;
    SSFR_TRY(ssfr_aside_begin(&aside, path));
    file = fopen(aside.temporary, "w");
    if (!file) {
        result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
        goto end;
    }
    write_graph(file, graph, record);
    const bool failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed) result = ssfr_fail(SSFR_ERR_IO, "%s: write error", path);
end:
    return ssfr_aside_end(&aside, result);
}

static ssfr_result dump_slot(const char *path, const ssfr_graph *graph, const char *slot, int w, int h,
                             const ssfr_record *record)
{
    ssfr_layer layer = {.channels = ssfr_slot_channels(slot)};
    ssfr_result result = ssfr_frame_read(&layer.field, graph, slot, w, h);
    if (result == SSFR_OK) result = ssfr_exr_save(path, 1, &layer, record->n, record->items);
    ssfr_field_destroy(&layer.field);
    return result;
}

ssfr_result ssfr_frame_dump(const char *folder, const ssfr_setup *setup, int w, int h, const ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    const size_t size = strlen(folder) + 128;
    char *path = NULL;
    SSFR_TRY(ssfr_output_make_folder(folder));
    SSFR_TRY(ssfr_alloc(&path, size, 1, "a path"));
    for (int i = 0; ssfr_graph_slot_at(setup->graph, i); i++) {
        const char *slot = ssfr_graph_slot_at(setup->graph, i);
        snprintf(path, size, "%s/%s.exr", folder, slot);
        SSFR_TRY(dump_slot(path, setup->graph, slot, w, h, record));
    }
    snprintf(path, size, "%s/graph.json", folder);
    SSFR_TRY(save_graph(path, setup->graph, record));
end:
    free(path);
    return result;
}

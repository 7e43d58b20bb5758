/* SPDX-License-Identifier: MIT */
/* lists.c: the lists of slots, passes and pipelines, and finding by name. */
#include "graph/graph.h"

const ssfr_slot ssfr_slots[SSFR_N_SLOTS] = {
#define X(kind, name, channels, exr, unit, neutral, help) \
    [SSFR_SLOT_##name] = {kind, #name, channels, exr, unit, neutral, help},
#include "graph/slots.def"
#undef X
};

ssfr_slot_id ssfr_slot_find(const char *name)
{
    ssfr_slot_id found = SSFR_NO_SLOT;
    for (int i = 1; i < SSFR_N_SLOTS && !found; i++)
        if (strcmp(ssfr_slots[i].name, name) == 0) found = (ssfr_slot_id)i;
    return found;
}

bool ssfr_slot_is_fluid(ssfr_slot_id slot)
{
    const ssfr_slot *s = &ssfr_slots[slot];
    const bool other = slot == SSFR_SLOT_scene_depth || slot == SSFR_SLOT_foam_depth;
    return s->kind == SSFR_IMAGE && fabs(s->neutral) == SSFR_EMPTY && !other;
}

bool ssfr_slot_is_layer(ssfr_slot_id slot)
{
    switch (slot) {
    case SSFR_SLOT_foam_depth:
    case SSFR_SLOT_thickness:
    case SSFR_SLOT_thickness_back:
    case SSFR_SLOT_thickness_front:
    case SSFR_SLOT_foam_thickness: return true;
    default: return false;
    }
}

const char *ssfr_slot_channels(const char *slot)
{
    const ssfr_slot_id id = ssfr_slot_find(slot);
    return id ? ssfr_slots[id].exr : NULL;
}

const char *ssfr_slot_unit(const char *slot)
{
    const ssfr_slot_id id = ssfr_slot_find(slot);
    return id ? ssfr_slots[id].unit : NULL;
}

#define X(name) extern const ssfr_pass ssfr_##name;
#include "passes/passes.def"
#undef X

static const ssfr_pass *const passes[] = {
#define X(name) &ssfr_##name,
#include "passes/passes.def"
#undef X
};

const ssfr_pass *ssfr_pass_at(int i)
{
    return i >= 0 && (size_t)i < SSFR_COUNT(passes) ? passes[i] : NULL;
}

const ssfr_pass *ssfr_pass_find(const char *name)
{
    const ssfr_pass *found = NULL;
    for (size_t i = 0; i < SSFR_COUNT(passes) && !found; i++)
        if (strcmp(passes[i]->name, name) == 0) found = passes[i];
    return found;
}

const char *ssfr_pass_name(const ssfr_pass *pass) { return pass->name; }
const char *ssfr_pass_help(const ssfr_pass *pass) { return pass->help; }
const char *ssfr_pass_source(const ssfr_pass *pass) { return pass->source; }
const ssfr_param *ssfr_pass_params(const ssfr_pass *pass) { return pass->params; }

static int n_ports(const ssfr_port *ports)
{
    int n = 0;
    while (ports[n].name) n++;
    return n;
}

const char *ssfr_pass_input(const ssfr_pass *pass, int i)
{
    return i >= 0 && i < n_ports(pass->inputs) ? pass->inputs[i].name : NULL;
}

const char *ssfr_pass_output(const ssfr_pass *pass, int i)
{
    return i >= 0 && i < n_ports(pass->outputs) ? pass->outputs[i].name : NULL;
}

#define X(name) extern const ssfr_pipeline ssfr_pipeline_##name;
#include "pipelines/pipelines.def"
#undef X

static const ssfr_pipeline *const pipelines[] = {
#define X(name) &ssfr_pipeline_##name,
#include "pipelines/pipelines.def"
#undef X
};

const ssfr_pipeline *ssfr_pipeline_at(int i)
{
    return i >= 0 && (size_t)i < SSFR_COUNT(pipelines) ? pipelines[i] : NULL;
}

const ssfr_pipeline *ssfr_pipeline_find(const char *name)
{
    const ssfr_pipeline *found = NULL;
    for (size_t i = 0; i < SSFR_COUNT(pipelines) && !found; i++)
        if (strcmp(pipelines[i]->name, name) == 0) found = pipelines[i];
    return found;
}

const char *ssfr_pipeline_name(const ssfr_pipeline *pipeline) { return pipeline->name; }
const char *ssfr_pipeline_help(const ssfr_pipeline *pipeline) { return pipeline->help; }

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* params.c: the parameters of ground truth, one table of all their rows. */
#include "experiments/truth/truth.h"

#include "base/param.h"
#include "scene/anisotropy.h"

static const char *const part_names[] = {"surface", "thickness", "foam", "colour", NULL};

#define ROW(kind, ...) SSFR_PARAM_##kind(ssfr_truth_cast_params, __VA_ARGS__)
static const ssfr_param cast_rows[] = {
    ROW(SET, parts, part_names, SSFR_TRUTH_ALL, "what is cast: depth and normal; lengths; foam; the picture"),
    ROW(CHOICE, integrator, ssfr_integrator_names, SSFR_INTEGRATOR_chords, "how integrals along a ray are found"),
    ROW(REAL, eps_abs, "1", 0, 0, 1, "absolute error asked of adaptive rules, in the integral's unit"),
    ROW(REAL, eps_rel, "1", 1e-10, 1e-14, 1, "relative error asked of them"),
    ROW(INT, points, "1", 8, 1, 64, "of the rule gauss, on each piece"),
    ROW(INT, steps, "1", 256, 1, 1 << 24, "of the rule steps"),
    ROW(REAL, judged, "1", 0.01, 0, 1, "share of the rays whose closed form GSL's qagp judges"),
    ROW(FLAG, solids, 1, "solids and the floor hide the fluid behind them in depth, normal and thickness, too"),
    SSFR_PARAM_END,
};

/* Of one prefix there may be several structs. */
static const struct group {
    const char *prefix;
    const ssfr_param *rows;
    size_t offset;
} own_groups[] = {
    {"truth", ssfr_continuum_rows, offsetof(ssfr_truth_params, fluid)},
    {"truth", cast_rows, offsetof(ssfr_truth_params, cast)},
    {"extinction", ssfr_extinction_rows, offsetof(ssfr_truth_params, extinction)},
    {"path", ssfr_light_rows, offsetof(ssfr_truth_params, path)},
    {"anisotropy", ssfr_anisotropy_rows, offsetof(ssfr_truth_params, anisotropy)},
};

/* The scene's groups follow; false past the end. */
static bool group_at(int i, struct group *out)
{
    const int n = (int)SSFR_COUNT(own_groups);
    if (i < n) {
        *out = own_groups[i];
    } else {
        out->prefix = ssfr_world_group(i - n, &out->rows, &out->offset);
        out->offset += offsetof(ssfr_truth_params, world);
    }
    return out->prefix;
}

void ssfr_truth_defaults(ssfr_truth_params *params)
{
    struct group group;
    *params = (ssfr_truth_params){0};
    for (int i = 0; group_at(i, &group); i++) ssfr_params_default(group.rows, (char *)params + group.offset);
}

bool ssfr_truth_key_at(const ssfr_truth_params *params, int i, char key[128], const ssfr_param **row,
                       const void **group)
{
    struct group g;
    for (int k = 0; group_at(k, &g); k++) {
        int n = 0;
        while (g.rows[n].name) n++;
        if (i < n) {
            snprintf(key, 128, "%s.%s", g.prefix, g.rows[i].name);
            *row = &g.rows[i];
            *group = (const char *)params + g.offset;
            return true;
        }
        i -= n;
    }
    return false;
}

static bool has_prefix(const struct group *group, const char *key)
{
    const size_t length = strlen(group->prefix);
    return strncmp(key, group->prefix, length) == 0 && key[length] == '.';
}

/* Lists the parameters of the key's group, or else the groups. */
static ssfr_result fail_key(const char *key)
{
    char names[768] = "";
    size_t used = 0;
    struct group group;
    for (int i = 0; group_at(i, &group); i++)
        for (const ssfr_param *row = group.rows; has_prefix(&group, key) && row->name; row++)
            ssfr_list_name(names, sizeof names, &used, row->name);
    if (used) return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no such parameter; there are %s", key, names);
    const char *before = "";
    for (int i = 0; group_at(i, &group); before = group.prefix, i++)
        if (strcmp(before, group.prefix) != 0) ssfr_list_name(names, sizeof names, &used, group.prefix);
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: truth has no such parameter; its groups are %s", key, names);
}

ssfr_result ssfr_truth_set(ssfr_truth_params *params, const char *key, const char *value)
{
    struct group group;
    for (int i = 0; group_at(i, &group); i++) {
        const ssfr_param *row =
            has_prefix(&group, key) ? ssfr_param_find(group.rows, key + strlen(group.prefix) + 1) : NULL;
        if (row) return ssfr_param_set(row, (char *)params + group.offset, key, value);
    }
    return fail_key(key);
}

ssfr_result ssfr_truth_apply_scene(ssfr_truth_params *params, const ssfr_description *description)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < description->n_settings && result == SSFR_OK; i++) {
        const ssfr_scene_setting *s = &description->settings[i];
        struct group group;
        bool ours = false;
        for (int k = 0; !ours && group_at(k, &group); k++) ours = has_prefix(&group, s->key);
        if (!ours) continue;
        ssfr_log_about(s->where);
        result = ssfr_truth_set(params, s->key, s->value);
        ssfr_log_about(NULL);
    }
    return result;
}

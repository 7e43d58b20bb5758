/* SPDX-License-Identifier: GPL-3.0-or-later */
/* description_views.c: reading cameras and their paths, and where they are at a time. */
#include "experiments/scenes/description_read.h"

static const double default_fov_deg = 45;
static const double nearest = 1e-6;  /* m, that an eye must keep from its target */
static const double steepest = 1e-6; /* the sine of the least angle between the view and up */

enum { N_CHANNELS = 7 }; /* eye, target, fov_deg */

#define MIN_FOV_DEG 0.001
#define MAX_FOV_DEG 179
#define FOV .unit = "deg", .min = MIN_FOV_DEG, .max = MAX_FOV_DEG

ssfr_view_key ssfr_view_at(const ssfr_view *view, double time)
{
    double v[N_CHANNELS];
    if (!view->curve) return view->keys[0];
    ssfr_curve_at(view->curve, time, v);
    return (ssfr_view_key){
        .time = time, .eye = {v[0], v[1], v[2]}, .target = {v[3], v[4], v[5]}, .fov_deg = v[6]};
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

typedef struct entry { /* a camera as it is written: what its keys do not say, it says for all of them */
    ssfr_view_key key;
    double up[3];
    const ssfr_yaml_node *keys;
} entry;

static ssfr_result read_key(const ssfr_yaml_node *node, ssfr_view_key *key)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("time", ssfr_yaml_read_real, ssfr_view_key, time, .needed = true, SSFR_RANGE_TIME),
        SSFR_YAML_ROW("eye", ssfr_yaml_read_real3, ssfr_view_key, eye, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("target", ssfr_yaml_read_real3, ssfr_view_key, target, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("fov_deg", ssfr_yaml_read_real, ssfr_view_key, fov_deg, FOV),
        SSFR_YAML_ROW_END,
    };
    return ssfr_yaml_read_map(node, rows, key);
}

static ssfr_result read_keys(const ssfr_yaml_node *node, const ssfr_view_key *base, ssfr_view *view)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_reading_make(node, SSFR_YAML_LIST, sizeof *view->keys, &view->keys, &view->n_keys));
    for (size_t i = 0; i < node->n; i++) {
        view->keys[i] = *base;
        SSFR_TRY(read_key(node->values[i], &view->keys[i]));
        if (isnan(view->keys[i].eye[0]) || isnan(view->keys[i].target[0]))
            return ssfr_yaml_fail(node->values[i], SSFR_ERR_FORMAT,
                                  "keys: eye and target must be given, here or for all");
        if (i > 0 && !(view->keys[i].time > view->keys[i - 1].time))
            return ssfr_yaml_fail(node->values[i], SSFR_ERR_VALUE, "keys: %g s does not come after %g s",
                                  view->keys[i].time, view->keys[i - 1].time);
    }
end:
    return result;
}

static ssfr_result make_curve(ssfr_view *view)
{
    ssfr_result result = SSFR_OK;
    const size_t n = (size_t)view->n_keys;
    double *times = NULL, *values = NULL;
    SSFR_TRY(ssfr_alloc(&times, n, sizeof *times, "a camera's path"));
    SSFR_TRY(ssfr_alloc(&values, n, N_CHANNELS * sizeof *values, "a camera's path"));
    for (size_t i = 0; i < n; i++) {
        const ssfr_view_key *key = &view->keys[i];
        double *v = values + N_CHANNELS * i;
        times[i] = key->time;
        for (int k = 0; k < 3; k++) v[k] = key->eye[k], v[3 + k] = key->target[k];
        v[6] = key->fov_deg;
    }
    SSFR_TRY(ssfr_curve_create(&view->curve, N_CHANNELS, n, times, values));
end:
    free(times);
    free(values);
    return result;
}

/* ---- checking ---------------------------------------------------------------------------------------------------- */

/* What is wrong with a view at a time, NULL for nothing. */
static const char *find_fault(const ssfr_view *view, const ssfr_view_key *key)
{
    double along[3], across[3];
    for (int k = 0; k < 3; k++) along[k] = key->target[k] - key->eye[k];
    if (!(ssfr_normalize(along) > nearest)) return "the eye is at its target";
    ssfr_cross(along, view->up, across);
    if (!(ssfr_dot(across, across) > ssfr_square(steepest))) return "the view is along up";
    if (!(key->fov_deg >= MIN_FOV_DEG && key->fov_deg <= MAX_FOV_DEG)) return "the field of view has no sensible angle";
    return NULL;
}

/* At every key, and at every frame between them. */
static ssfr_result check_view(const ssfr_reading *r, const ssfr_yaml_node *node, const ssfr_view *view)
{
    const char *fault = NULL;
    double time = 0;
    for (int i = 0; i < view->n_keys && !fault; i++) {
        time = view->keys[i].time;
        fault = find_fault(view, &view->keys[i]);
    }
    for (int i = 0; i < r->d.n_frames && view->n_keys > 1 && !fault; i++) {
        time = i / r->d.frame_rate;
        const ssfr_view_key key = ssfr_view_at(view, time);
        fault = find_fault(view, &key);
    }
    return fault ? ssfr_yaml_fail(node->key, SSFR_ERR_VALUE, "%.80s: at %g s %s", node->name, time, fault) : SSFR_OK;
}

static ssfr_result read_view(const ssfr_reading *r, const ssfr_yaml_node *node, ssfr_view *view)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("eye", ssfr_yaml_read_real3, entry, key.eye, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("target", ssfr_yaml_read_real3, entry, key.target, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("up", ssfr_reading_direction, entry, up),
        SSFR_YAML_ROW("fov_deg", ssfr_yaml_read_real, entry, key.fov_deg, FOV),
        SSFR_YAML_ROW("keys", ssfr_yaml_read_node, entry, keys),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    entry e = {.key = {.eye = {NAN}, .target = {NAN}, .fov_deg = default_fov_deg}, .up = {0, 1, 0}};
    SSFR_TRY(ssfr_yaml_copy(&view->name, "", node->name));
    SSFR_TRY(ssfr_yaml_read_map(node, rows, &e));
    memcpy(view->up, e.up, sizeof view->up);
    if (e.keys) {
        SSFR_TRY(read_keys(e.keys, &e.key, view));
    } else {
        if (isnan(e.key.eye[0]) || isnan(e.key.target[0]))
            return ssfr_yaml_fail(node->key, SSFR_ERR_FORMAT, "%.80s: eye and target must be given", node->name);
        SSFR_TRY(ssfr_alloc(&view->keys, 1, sizeof *view->keys, "a camera"));
        view->n_keys = 1;
        view->keys[0] = e.key;
    }
    if (view->n_keys > 1) SSFR_TRY(make_curve(view));
    SSFR_TRY(check_view(r, node, view));
end:
    return result;
}

ssfr_result ssfr_reading_views(ssfr_reading *r)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_reading_make(r->cameras, SSFR_YAML_MAP, sizeof *r->d.views, &r->d.views, &r->d.n_views));
    for (int i = 0; i < r->d.n_views; i++) SSFR_TRY(read_view(r, r->cameras->values[i], &r->d.views[i]));
end:
    return result;
}

ssfr_result ssfr_view_find(int n, const ssfr_view *views, const char *scene, const char *name, const ssfr_view **out)
{
    char list[400] = "none";
    size_t used = 0;
    *out = NULL;
    for (int i = 0; i < n && !*out; i++) {
        if (strcmp(views[i].name, name) == 0) *out = &views[i];
        ssfr_list_name(list, sizeof list, &used, views[i].name);
    }
    return *out ? SSFR_OK : ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no camera %s: there are %s", scene, name, list);
}

ssfr_result ssfr_description_view(const ssfr_description *d, const char *name, const ssfr_view **out)
{
    *out = !name && d->n_views > 0 ? &d->views[0] : NULL;
    return name ? ssfr_view_find(d->n_views, d->views, d->name, name, out) : SSFR_OK;
}

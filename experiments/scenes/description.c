/* SPDX-License-Identifier: GPL-3.0-or-later */
/* description.c: scene files: what they hold as a whole, and the parts that are read by themselves. */
#include "experiments/scenes/description_read.h"
#include "base/param.h"

#include <errno.h>
#include <sys/stat.h>

static const double default_rate = 30;   /* 1/s */
static const double frame_slack = 1e-9;  /* frames that duration and rate may miss by rounding */

enum { MAX_FRAMES = 100000, MAX_GROUPS = 16 };

/* ---- what all parts use ------------------------------------------------------------------------------------------ */

ssfr_result ssfr_reading_make(const ssfr_yaml_node *node, ssfr_yaml_kind kind, size_t size, void *out, int *n)
{
    ssfr_result result = SSFR_OK;
    *n = 0;
    if (node) SSFR_TRY(ssfr_yaml_expect(node, kind));
    if (node && (node->n > SSFR_MAX_PARTS || (kind == SSFR_YAML_LIST && node->n == 0)))
        return ssfr_yaml_fail(node, SSFR_ERR_VALUE, "%s: %zu of them, expected 1 to %d", node->name, node->n,
                              SSFR_MAX_PARTS);
    SSFR_TRY(ssfr_alloc(out, node ? node->n : 0, size, "parts of a scene"));
    *n = node ? (int)node->n : 0;
end:
    return result;
}

ssfr_result ssfr_reading_direction(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    const ssfr_yaml_row finite = {.name = row->name, .min = -SSFR_MAX_LENGTH, .max = SSFR_MAX_LENGTH};
    ssfr_result result = SSFR_OK;
    double v[3];
    SSFR_TRY(ssfr_yaml_read_real3(node, &finite, v));
    if (!(ssfr_normalize(v) > SSFR_MIN_LENGTH))
        return ssfr_yaml_fail(node, SSFR_ERR_VALUE, "%s: a direction must not be 0", node->name);
    memcpy(to, v, sizeof v);
end:
    return result;
}

double ssfr_description_spacing(const ssfr_description *description)
{
    return 2 * description->solver.radius * cbrt(SSFR_VOLUME_SHARE);
}

/* ---- drawing: groups of parameters, settings, files -------------------------------------------------------------- */

static ssfr_result add_setting(ssfr_reading *r, const char *group, const ssfr_yaml_node *key,
                               const ssfr_yaml_node *value)
{
    ssfr_result result = SSFR_OK;
    char where[SSFR_YAML_PLACE], full[128];
    ssfr_description *d = &r->d;
    ssfr_scene_setting *bigger = realloc(d->settings, (size_t)(d->n_settings + 1) * sizeof *bigger);
    if (!bigger) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %d settings", d->n_settings + 1);
    d->settings = bigger;
    d->settings[d->n_settings++] = (ssfr_scene_setting){0};
    bigger += d->n_settings - 1;
    if (snprintf(full, sizeof full, "%s%s", group, key->text) >= (int)sizeof full)
        return ssfr_yaml_fail(key, SSFR_ERR_VALUE, "%.80s: the key is too long", key->text);
    SSFR_TRY(ssfr_yaml_copy(&bigger->key, "", full));
    SSFR_TRY(ssfr_yaml_copy(&bigger->value, "", value->text));
    SSFR_TRY(ssfr_yaml_copy(&bigger->where, "", ssfr_yaml_place(key, where)));
end:
    return result;
}

/* Room for a struct of parameters, as far as these rows reach. */
static ssfr_result make_params(void *out, const ssfr_param *rows)
{
    size_t size = sizeof(double);
    for (const ssfr_param *row = rows; row->name; row++)
        if (row->offset + sizeof(double) > size) size = row->offset + sizeof(double);
    return ssfr_alloc(out, 1, size, "parameters");
}

/* The parameters of a group, "light: {elevation_deg: 30}": checked here, set when a graph is there. */
static ssfr_result read_group(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    char group[64];
    void *checked = NULL;
    SSFR_TRY(make_params(&checked, row->params));
    SSFR_TRY(ssfr_yaml_read_params(node, row, checked));
    snprintf(group, sizeof group, "%s.", row->name);
    for (size_t i = 0; i < node->n; i++) SSFR_TRY(add_setting(to, group, node->keys[i], node->values[i]));
end:
    free(checked);
    return result;
}

/* The rows of a pass, or of a group that all pipelines share; NULL when there is none of that name. */
static const ssfr_param *find_rows(const char *name)
{
    const ssfr_pass *pass = ssfr_pass_find(name);
    const ssfr_param *rows = NULL, *found = pass ? ssfr_pass_params(pass) : NULL;
    for (int i = 0; !found && ssfr_group_at(i, &rows); i++)
        if (strcmp(ssfr_group_at(i, &rows), name) == 0) found = rows;
    return found;
}

/* A simulation of hours must not end in a setting that no pipeline has. */
static ssfr_result check_setting(const ssfr_yaml_node *key, const ssfr_yaml_node *value)
{
    ssfr_result result = SSFR_OK;
    const char *dot = strchr(key->text, '.');
    char name[64];
    void *checked = NULL;
    snprintf(name, sizeof name, "%.*s", (int)(dot - key->text), key->text);
    const ssfr_param *rows = find_rows(name), *param = rows ? ssfr_param_find(rows, dot + 1) : NULL;
    if (!param)
        return ssfr_yaml_fail(key, SSFR_ERR_UNKNOWN, "%.80s: no pass has this parameter ('ssfr passes' lists them)",
                              key->text);
    SSFR_TRY(make_params(&checked, rows));
    result = ssfr_yaml_read_param(value, key->text, param, checked);
end:
    free(checked);
    return result;
}

/* "set: {curvature_flow.iterations: 20}": of passes that the pipeline need not have. */
static ssfr_result read_settings(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    (void)row;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_MAP));
    for (size_t i = 0; i < node->n; i++) {
        if (!strchr(node->keys[i]->text, '.'))
            return ssfr_yaml_fail(node->keys[i], SSFR_ERR_FORMAT, "%.80s: expected a parameter such as pass.param",
                                  node->keys[i]->text);
        SSFR_TRY(check_setting(node->keys[i], node->values[i]));
        SSFR_TRY(add_setting(to, "", node->keys[i], node->values[i]));
    }
end:
    return result;
}

static ssfr_result read_floor(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    const bool none = node->kind == SSFR_YAML_TEXT && strcmp(node->text, "none") == 0;
    if (none) *(double *)to = -INFINITY;
    return none ? SSFR_OK : ssfr_yaml_read_real(node, row, to);
}

static ssfr_result read_title(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_yaml_read_text(node, row, to));
    if (node->text[0] == '\0' || strpbrk(node->text, "\r\n"))
        result = ssfr_yaml_fail(node, SSFR_ERR_VALUE, "%s: expected one line", node->name);
end:
    return result;
}

/* An image: found now, so that a simulation of hours does not end in a missing file. */
static ssfr_result read_image(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_reading *r = to;
    char **path = strcmp(row->name, "environment") == 0 ? &r->d.environment : &r->d.background;
    struct stat info;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_TEXT));
    SSFR_TRY(ssfr_yaml_copy(path, node->text[0] == '/' ? "" : r->folder, node->text));
    errno = 0;
    if (stat(*path, &info) != 0 || !S_ISREG(info.st_mode))
        result = ssfr_yaml_fail(node, SSFR_ERR_IO, "%s: %.300s: %s", node->name, *path,
                                errno ? strerror(errno) : "not a regular file");
end:
    return result;
}

/* Parameters may each be in range and yet not fit together: foam says so, and this says where. */
static ssfr_result read_foam(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_reading *r = to;
    ssfr_foam *foam = NULL;
    char place[SSFR_YAML_PLACE];
    SSFR_TRY(ssfr_yaml_read_params(node, row, &r->d.foam));
    ssfr_log_about(ssfr_yaml_place(node, place));
    result = ssfr_foam_create(&foam, &r->d.foam, r->d.solver.gravity, 0);
    ssfr_log_about(NULL);
    r->d.has_foam = true;
end:
    ssfr_foam_destroy(&foam);
    return result;
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

#define ROW(key, reader, member, ...) SSFR_YAML_ROW(key, reader, ssfr_reading, member, __VA_ARGS__)
#define REAL(key, member, u, lo, hi, ...) \
    ROW(key, ssfr_yaml_read_real, member, .unit = u, .min = lo, .max = hi, __VA_ARGS__)
#define NODE(key, member, ...) ROW(key, ssfr_yaml_read_node, member, __VA_ARGS__)

static const ssfr_yaml_row scene_rows[] = {
    ROW("title", read_title, d.title, .needed = true),
    REAL("radius", d.solver.radius, "m", SSFR_MIN_LENGTH, 1e3, .needed = true),
    ROW("particles", ssfr_yaml_read_count, particles, .needed = true, .min = 1, .max = SSFR_MAX_FLUID),
    NODE("domain", domain, .needed = true),
    ROW("gravity", ssfr_yaml_read_real3, d.solver.gravity, .unit = "m/s^2", .min = -SSFR_MAX_SPEED,
        .max = SSFR_MAX_SPEED),
    REAL("duration", duration, "s", 0, SSFR_MAX_TIME, .needed = true),
    REAL("frame_rate", d.frame_rate, "1/s", 1e-3, 1e5),
    REAL("rest_time", d.rest_time, "s", 0, SSFR_MAX_TIME),
    ROW("solver", ssfr_yaml_read_params, d.solver.params, .params = ssfr_solver_rows),
    SSFR_YAML_ROW_ALL("foam", read_foam, .params = ssfr_foam_rows),
    NODE("motions", motions),
    NODE("solids", solids),
    NODE("fluid", pools),
    NODE("emitters", emitters),
    NODE("sinks", sinks),
    NODE("cameras", cameras),
    SSFR_YAML_ROW_ALL("set", read_settings),
    ROW("floor_height", read_floor, d.floor, .unit = "m", .min = -SSFR_MAX_LENGTH, .max = SSFR_MAX_LENGTH),
    SSFR_YAML_ROW_ALL("environment", read_image),
    SSFR_YAML_ROW_ALL("background", read_image),
};

/* The rows above, and one for each of the groups that all pipelines share. */
static void list_rows(ssfr_yaml_row rows[SSFR_COUNT(scene_rows) + MAX_GROUPS + 1])
{
    const ssfr_param *params;
    size_t n = SSFR_COUNT(scene_rows);
    memcpy(rows, scene_rows, sizeof scene_rows);
    for (int i = 0; i < MAX_GROUPS && ssfr_group_at(i, &params); i++)
        rows[n++] = (ssfr_yaml_row)SSFR_YAML_ROW_ALL(ssfr_group_at(i, &params), read_group, .params = params);
    rows[n] = (ssfr_yaml_row)SSFR_YAML_ROW_END;
}

static ssfr_result check_frames(const ssfr_yaml_node *root, const char *key, double time, double n)
{
    if (n <= MAX_FRAMES) return SSFR_OK;
    return ssfr_yaml_fail(ssfr_yaml_find(root, key), SSFR_ERR_VALUE, "%s: %g s make %.0f frames, at most %d", key, time,
                          n, MAX_FRAMES);
}

static ssfr_result count_frames(ssfr_reading *r, const ssfr_yaml_node *root)
{
    ssfr_result result = SSFR_OK;
    const double n = floor(r->duration * r->d.frame_rate + frame_slack) + 1;
    SSFR_TRY(check_frames(root, "duration", r->duration, n));
    SSFR_TRY(check_frames(root, "rest_time", r->d.rest_time, r->d.rest_time * r->d.frame_rate));
    r->d.n_frames = (int)n;
end:
    return result;
}

static void apply_scale(ssfr_reading *r)
{
    const bool quick = r->d.scale == SSFR_SCALE_QUICK;
    const double larger = quick ? cbrt(SSFR_QUICK_SHARE) : 1;
    r->spacing = ssfr_description_spacing(&r->d);
    r->d.solver.radius *= larger;
    ssfr_foam_params_coarsen(&r->d.foam, larger);
    r->d.solver.max_particles = quick ? (r->particles + SSFR_QUICK_SHARE / 2) / SSFR_QUICK_SHARE : r->particles;
    if (r->d.solver.max_particles == 0) r->d.solver.max_particles = 1;
    if (quick && r->d.foam.max_particles > 0) /* 0 means no limit */
        r->d.foam.max_particles = ssfr_max_int(r->d.foam.max_particles / SSFR_QUICK_SHARE, 1);
}

static void set_defaults(ssfr_reading *r)
{
    r->d.solver.gravity[1] = -9.81;
    r->d.frame_rate = default_rate;
    r->d.floor = NAN; /* until the domain is known */
    ssfr_params_default(ssfr_solver_rows, &r->d.solver.params);
    ssfr_params_default(ssfr_foam_rows, &r->d.foam);
}

static ssfr_result read_scene(ssfr_reading *r, const ssfr_yaml_node *root)
{
    ssfr_result result = SSFR_OK;
    ssfr_yaml_row rows[SSFR_COUNT(scene_rows) + MAX_GROUPS + 1];
    list_rows(rows);
    set_defaults(r);
    SSFR_TRY(ssfr_yaml_read_map(root, rows, r));
    SSFR_TRY(count_frames(r, root));
    apply_scale(r);
    SSFR_TRY(ssfr_reading_domain(r));
    SSFR_TRY(ssfr_reading_motions(r));
    SSFR_TRY(ssfr_reading_solids(r));
    SSFR_TRY(ssfr_reading_pools(r));
    SSFR_TRY(ssfr_reading_emitters(r));
    SSFR_TRY(ssfr_reading_sinks(r));
    SSFR_TRY(ssfr_reading_views(r));
    SSFR_TRY(ssfr_reading_check_room(r));
    if (isnan(r->d.floor)) r->d.floor = r->d.solver.open[2] ? -INFINITY : r->d.solver.lo[1];
end:
    return result;
}

/* ---- the object -------------------------------------------------------------------------------------------------- */

static void finish(ssfr_description *d)
{
    for (int i = 0; i < d->n_motions; i++) free(d->motions[i].name), free(d->motions[i].keys);
    for (int i = 0; i < d->n_bodies; i++) {
        free(d->bodies[i].name);
        free(d->bodies[i].file);
        ssfr_mesh_destroy(&d->bodies[i].mesh);
    }
    for (int i = 0; i < d->n_pools; i++) free(d->pools[i].name);
    for (int i = 0; i < d->n_views; i++) {
        free(d->views[i].name);
        free(d->views[i].keys);
        ssfr_curve_destroy(&d->views[i].curve);
    }
    for (int i = 0; i < d->n_settings; i++) {
        free(d->settings[i].key);
        free(d->settings[i].value);
        free(d->settings[i].where);
    }
    void *const all[] = {d->name,  d->title, d->text,  d->motions,  d->bodies,      d->pools,
                         d->emitters, d->sinks, d->views, d->settings, d->environment, d->background};
    for (size_t i = 0; i < SSFR_COUNT(all); i++) free(all[i]);
    *d = (ssfr_description){0};
}

void ssfr_description_destroy(ssfr_description **description)
{
    if (*description) finish(*description);
    free(*description);
    *description = NULL;
}

/* "a/b.yaml" gives "a/". */
static ssfr_result find_folder(char **out, const char *path)
{
    const char *slash = strrchr(path, '/');
    const ssfr_result result = ssfr_yaml_copy(out, "", path);
    if (result == SSFR_OK) (*out)[slash ? slash - path + 1 : 0] = '\0';
    return result;
}

static ssfr_result parse(ssfr_description **out, const char *name, const char *text, size_t size, ssfr_scale scale,
                         ssfr_mesh_loader *load_mesh)
{
    ssfr_result result = SSFR_OK;
    ssfr_reading r = {.d.scale = scale, .load_mesh = load_mesh ? load_mesh : ssfr_mesh_load};
    ssfr_yaml *tree = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_yaml_parse(&tree, name, "scene", text, size));
    SSFR_TRY(ssfr_yaml_copy(&r.d.name, "", name));
    SSFR_TRY(ssfr_yaml_copy(&r.d.text, "", text));
    SSFR_TRY(find_folder(&r.folder, name));
    SSFR_TRY(read_scene(&r, ssfr_yaml_root(tree)));
    SSFR_TRY(ssfr_alloc(out, 1, sizeof **out, "a scene"));
    **out = r.d;
    r.d = (ssfr_description){0};
end:
    finish(&r.d);
    free(r.folder);
    ssfr_yaml_destroy(&tree);
    return result;
}

ssfr_result ssfr_description_parse(ssfr_description **out, const char *name, const char *text, ssfr_scale scale,
                                   ssfr_mesh_loader *load_mesh)
{
    return parse(out, name, text, strlen(text), scale, load_mesh);
}

ssfr_result ssfr_description_load(ssfr_description **out, const char *path, ssfr_scale scale)
{
    ssfr_result result = SSFR_OK;
    char *text = NULL;
    size_t size = 0;
    *out = NULL;
    SSFR_TRY(ssfr_read_file(path, SSFR_YAML_FILE, &text, &size));
    SSFR_TRY(parse(out, path, text, size, scale, ssfr_mesh_load));
end:
    free(text);
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweep_spec_yaml.c: reading what a sweep runs, with file, line and column in every error. */
#include "experiments/sweep_spec_internal.h"

#include <errno.h>

static ssfr_result read_sequence(ssfr_sweep_spec *spec, const ssfr_yaml_node *node, const char *where)
{
    ssfr_result result = SSFR_OK;
    ssfr_axis axis = {0};
    if (node->n == 0) return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%s: an empty list", node->name);
    SSFR_TRY(ssfr_axis_check_key(where, node->name));
    SSFR_TRY(ssfr_axis_init(&axis, where, node->name, node->n));
    for (size_t i = 0; i < node->n; i++) {
        SSFR_TRY(ssfr_yaml_expect(node->values[i], SSFR_YAML_TEXT));
        SSFR_TRY(ssfr_axis_add(&axis, node->values[i]->text, strlen(node->values[i]->text)));
    }
    SSFR_TRY(ssfr_sweep_spec_put(spec, &axis));
end:
    ssfr_axis_finish(&axis);
    return result;
}

/* An axis: a range or a list in one text, or a sequence of values that are taken as they stand. */
static ssfr_result read_axis(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_sweep_spec *spec = to;
    char where[SSFR_YAML_PLACE];
    (void)row;
    ssfr_yaml_place(node->key, where);
    if (ssfr_sweep_spec_axis(spec, node->name))
        return ssfr_yaml_fail(node->key, SSFR_ERR_FORMAT, "%s is varied twice", node->name);
    if (node->kind == SSFR_YAML_LIST) return read_sequence(spec, node, where);
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_TEXT));
    result = ssfr_sweep_spec_vary(spec, where, node->name, node->text);
end:
    return result;
}

static ssfr_result read_vary(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_MAP));
    for (size_t i = 0; i < node->n; i++) SSFR_TRY(read_axis(node->values[i], row, to));
end:
    return result;
}

static ssfr_result read_settings(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    (void)row;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_MAP));
    for (size_t i = 0; i < node->n; i++) {
        char where[SSFR_YAML_PLACE];
        SSFR_TRY(ssfr_yaml_expect(node->values[i], SSFR_YAML_TEXT));
        ssfr_yaml_place(node->keys[i], where);
        SSFR_TRY(ssfr_settings_add(to, where, node->keys[i]->text, node->values[i]->text));
    }
end:
    return result;
}

static ssfr_result read_reference(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_sweep_spec *spec = to;
    const bool is_truth = node->kind == SSFR_YAML_TEXT && strcmp(node->text, "truth") == 0;
    if (!is_truth && node->kind != SSFR_YAML_MAP)
        return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%s: expected truth, or a map of a frame's settings", node->name);
    spec->compared_with = is_truth ? SSFR_REFERENCE_TRUTH : SSFR_REFERENCE_FRAME;
    return is_truth ? SSFR_OK : read_settings(node, row, &spec->reference);
}

/* ---- variants ---------------------------------------------------------------------------------------------------- */

/* "pipeline", "scene", ..: one value, which this variant has in the place of that of all runs. */
static ssfr_result read_own(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_variant *variant = to;
    char where[SSFR_YAML_PLACE];
    (void)row;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_TEXT));
    SSFR_TRY(ssfr_settings_add(&variant->own, ssfr_yaml_place(node->key, where), node->name, node->text));
end:
    return result;
}

static ssfr_result read_variant(const ssfr_yaml_node *node, ssfr_variant *variant)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW_ALL("pipeline", read_own),
        SSFR_YAML_ROW_ALL("scene", read_own),
        SSFR_YAML_ROW_ALL("camera", read_own),
        SSFR_YAML_ROW_ALL("frame", read_own),
        SSFR_YAML_ROW_ALL("size", read_own),
        SSFR_YAML_ROW("set", read_settings, ssfr_variant, settings),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    char where[SSFR_YAML_PLACE];
    SSFR_TRY(ssfr_yaml_copy(&variant->name, "", node->name));
    SSFR_TRY(ssfr_yaml_copy(&variant->where, "", ssfr_yaml_place(node->key, where)));
    SSFR_TRY(ssfr_yaml_read_map(node, rows, variant));
end:
    return result;
}

static ssfr_result read_variants(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_sweep_spec *spec = to;
    ssfr_axis axis = {0};
    char where[SSFR_YAML_PLACE];
    (void)row;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_MAP));
    if (node->n == 0 || node->n > SSFR_MAX_VARIANTS)
        return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%s: expected 1 to %d variants", node->name, SSFR_MAX_VARIANTS);
    SSFR_TRY(ssfr_axis_init(&axis, ssfr_yaml_place(node->key, where), "variant", node->n));
    for (size_t i = 0; i < node->n; i++) {
        ssfr_variant **variant = &spec->variants[spec->n_variants];
        SSFR_TRY(ssfr_alloc(variant, 1, sizeof **variant, "a variant"));
        spec->n_variants++;
        SSFR_TRY(read_variant(node->values[i], *variant));
        SSFR_TRY(ssfr_axis_add(&axis, (*variant)->name, strlen((*variant)->name)));
    }
    SSFR_TRY(ssfr_sweep_spec_put(spec, &axis));
end:
    ssfr_axis_finish(&axis);
    return result;
}

/* ---- a camera's path --------------------------------------------------------------------------------------------- */

typedef struct path_entry {
    const ssfr_yaml_node *camera; /* an axis */
    ssfr_path_spec path;
} path_entry;

static ssfr_result read_path(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    static const char *const words[] = {"stand", "follow", NULL}; /* the frames */
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("camera", ssfr_yaml_read_node, path_entry, camera),
        SSFR_YAML_ROW("views", ssfr_yaml_read_count, path_entry, path.views, .needed = true, .min = 1,
                      .max = SSFR_MAX_VALUES),
        SSFR_YAML_ROW("frames", ssfr_yaml_read_word, path_entry, path.frames, .words = words),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    ssfr_sweep_spec *spec = to;
    path_entry e = {0};
    char where[SSFR_YAML_PLACE];
    SSFR_TRY(ssfr_yaml_read_map(node, rows, &e));
    if (e.camera) SSFR_TRY(read_axis(e.camera, row, spec));
    spec->path = e.path;
    SSFR_TRY(ssfr_sweep_spec_put_views(spec, ssfr_yaml_place(ssfr_yaml_head(node), where)));
end:
    return result;
}

/* ---- what rows are held against ---------------------------------------------------------------------------------- */

static ssfr_result read_against(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_against_spec *against = to;
    char where[SSFR_YAML_PLACE];
    SSFR_TRY(read_settings(node, row, &against->cells));
    if (node->n == 0) return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%s: expected a map of axes to cells", node->name);
    if (!against->where) SSFR_TRY(ssfr_yaml_copy(&against->where, "", ssfr_yaml_place(node->key, where)));
end:
    return result;
}

static ssfr_result read_added(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_against_spec *against = to;
    char where[SSFR_YAML_PLACE];
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_LIST));
    if (!against->where) SSFR_TRY(ssfr_yaml_copy(&against->where, "", ssfr_yaml_place(node->key, where)));
    for (size_t i = 0; i < node->n; i++) {
        if (against->n_added == SSFR_MAX_ADDED)
            return ssfr_yaml_fail(node->values[i], SSFR_ERR_FORMAT, "%s: more than %d columns", node->name,
                                  SSFR_MAX_ADDED);
        SSFR_TRY(ssfr_yaml_read_text(node->values[i], row, &against->added[against->n_added]));
        against->n_added++;
    }
end:
    return result;
}

/* ---- figures ----------------------------------------------------------------------------------------------------- */

static ssfr_result read_lines(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_plot_spec *plot = to;
    if (node->kind != SSFR_YAML_LIST)
        return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%s: expected a list of columns", node->name);
    for (size_t i = 0; i < node->n; i++) {
        if (plot->n_lines == SSFR_MAX_LINES)
            return ssfr_yaml_fail(node->values[i], SSFR_ERR_FORMAT, "%s: more than %d columns", node->name,
                                  SSFR_MAX_LINES);
        SSFR_TRY(ssfr_yaml_read_text(node->values[i], row, &plot->lines[plot->n_lines]));
        plot->n_lines++;
    }
end:
    return result;
}

static ssfr_result add_only(ssfr_plot_spec *plot, const ssfr_yaml_node *column, const ssfr_yaml_node *cell)
{
    ssfr_result result = SSFR_OK;
    if (plot->n_only == SSFR_MAX_ONLY)
        return ssfr_yaml_fail(cell, SSFR_ERR_FORMAT, "only: more than %d cells", SSFR_MAX_ONLY);
    plot->n_only++; /* counted even when it is refused, so that it is freed */
    SSFR_TRY(ssfr_yaml_read_text(column, NULL, &plot->only[plot->n_only - 1].column));
    SSFR_TRY(ssfr_yaml_read_text(cell, NULL, &plot->only[plot->n_only - 1].cell));
end:
    return result;
}

/* The axes of curves that are logarithmic. */
static ssfr_result read_log(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_plot_spec *plot = to;
    (void)row;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_LIST));
    for (size_t i = 0; i < node->n; i++) {
        const ssfr_yaml_node *axis = node->values[i];
        SSFR_TRY(ssfr_yaml_expect(axis, SSFR_YAML_TEXT));
        if (strcmp(axis->text, "x") != 0 && strcmp(axis->text, "y") != 0)
            return ssfr_yaml_fail(axis, SSFR_ERR_VALUE, "%s: %.40s: expected x or y", node->name, axis->text);
        plot->log[axis->text[0] == 'y'] = true;
    }
end:
    return result;
}

/* A cell a column, or a list of them. */
static ssfr_result read_only(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    (void)row;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_MAP));
    for (size_t i = 0; i < node->n; i++) {
        const ssfr_yaml_node *value = node->values[i];
        const bool list = value->kind == SSFR_YAML_LIST;
        for (size_t k = 0; k < (list ? value->n : 1); k++)
            SSFR_TRY(add_only(to, node->keys[i], list ? value->values[k] : value));
    }
end:
    return result;
}

static ssfr_result read_plot(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("title", ssfr_yaml_read_text, ssfr_plot_spec, title),
        SSFR_YAML_ROW("x", ssfr_yaml_read_text, ssfr_plot_spec, x),
        SSFR_YAML_ROW("y", ssfr_yaml_read_text, ssfr_plot_spec, y),
        SSFR_YAML_ROW("x_label", ssfr_yaml_read_text, ssfr_plot_spec, x_label),
        SSFR_YAML_ROW("y_label", ssfr_yaml_read_text, ssfr_plot_spec, y_label),
        SSFR_YAML_ROW_ALL("log", read_log),
        SSFR_YAML_ROW_ALL("lines", read_lines),
        SSFR_YAML_ROW_ALL("only", read_only),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    ssfr_plot_spec *plot = to;
    char where[SSFR_YAML_PLACE];
    SSFR_TRY(ssfr_yaml_copy(&plot->where, "", ssfr_yaml_place(ssfr_yaml_head(node), where)));
    SSFR_TRY(ssfr_yaml_read_map(node, rows, to));
    if (strcmp(row->name, "plot") == 0 && ssfr_yaml_find(node, "log"))
        return ssfr_yaml_fail(ssfr_yaml_find(node, "log")->key, SSFR_ERR_FORMAT,
                              "log: is of curves; what a plot's columns mean says how they are drawn");
    if (!plot->x || !plot->y)
        result = ssfr_yaml_fail(ssfr_yaml_head(node), SSFR_ERR_FORMAT, "%s: x and y must be given", node->name);
end:
    return result;
}

/* A panel, or a list of them. */
static ssfr_result read_curves(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_sweep_spec *spec = to;
    const size_t n = node->kind == SSFR_YAML_LIST ? node->n : 1;
    for (size_t i = 0; i < n; i++) {
        const ssfr_yaml_node *panel = node->kind == SSFR_YAML_LIST ? node->values[i] : node;
        if (i == SSFR_MAX_PANELS)
            return ssfr_yaml_fail(panel, SSFR_ERR_FORMAT, "%s: more than %d panels", node->name, SSFR_MAX_PANELS);
        SSFR_TRY(read_plot(panel, row, &spec->curves[spec->n_curves++]));
    }
end:
    return result;
}

/* Of both tables the same name, or of each its own. */
static ssfr_result add_on(ssfr_published_spec *published, const ssfr_yaml_node *on, const ssfr_yaml_node *with)
{
    ssfr_result result = SSFR_OK;
    const int i = published->n_on;
    if (i == SSFR_MAX_ON) return ssfr_yaml_fail(on, SSFR_ERR_FORMAT, "on: more than %d columns", SSFR_MAX_ON);
    published->n_on++; /* counted even when it is refused, so that it is freed */
    SSFR_TRY(ssfr_yaml_read_text(on, NULL, &published->on[i]));
    SSFR_TRY(ssfr_yaml_read_text(with, NULL, &published->with[i]));
end:
    return result;
}

static ssfr_result read_on(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    (void)row;
    if (node->kind == SSFR_YAML_TEXT || node->n == 0)
        return ssfr_yaml_fail(node, SSFR_ERR_FORMAT,
                              "on: expected a list of columns, or a map of the paper's to the sweep's");
    for (size_t i = 0; i < node->n; i++)
        SSFR_TRY(add_on(to, node->kind == SSFR_YAML_MAP ? node->keys[i] : node->values[i], node->values[i]));
end:
    return result;
}

ssfr_result ssfr_published_spec_read(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("file", ssfr_yaml_read_text, ssfr_published_spec, file, .needed = true),
        SSFR_YAML_ROW_ALL("on", read_on, .needed = true),
        SSFR_YAML_ROW("column", ssfr_yaml_read_text, ssfr_published_spec, column, .needed = true),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    ssfr_published_spec *published = to;
    char where[SSFR_YAML_PLACE];
    (void)row;
    SSFR_TRY(ssfr_yaml_read_map(node, rows, to));
    SSFR_TRY(ssfr_yaml_copy(&published->where, "", ssfr_yaml_place(ssfr_yaml_head(node), where)));
end:
    return result;
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

static ssfr_result read_quick(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("title", ssfr_yaml_read_text, ssfr_sweep_spec, title),
        SSFR_YAML_ROW_ALL("variants", read_variants),
        SSFR_YAML_ROW_ALL("scene", read_axis),
        SSFR_YAML_ROW_ALL("frame", read_axis),
        SSFR_YAML_ROW_ALL("path", read_path),
        SSFR_YAML_ROW_ALL("size", read_axis),
        SSFR_YAML_ROW("set", read_settings, ssfr_sweep_spec, settings),
        SSFR_YAML_ROW_ALL("vary", read_vary),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    ssfr_sweep_spec *spec = to;
    (void)row;
    SSFR_TRY(ssfr_sweep_spec_create(&spec->quick));
    SSFR_TRY(ssfr_yaml_read_map(node, rows, spec->quick));
end:
    return result;
}

static ssfr_result read_yaml(ssfr_sweep_spec *spec, const char *path, const char *text, size_t size)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("title", ssfr_yaml_read_text, ssfr_sweep_spec, title),
        SSFR_YAML_ROW_ALL("pipeline", read_axis),
        SSFR_YAML_ROW_ALL("variants", read_variants),
        SSFR_YAML_ROW_ALL("scene", read_axis),
        SSFR_YAML_ROW_ALL("camera", read_axis),
        SSFR_YAML_ROW_ALL("frame", read_axis),
        SSFR_YAML_ROW_ALL("path", read_path),
        SSFR_YAML_ROW_ALL("size", read_axis),
        SSFR_YAML_ROW_ALL("leave_out", read_axis),
        SSFR_YAML_ROW_ALL("cull", read_axis),
        SSFR_YAML_ROW_ALL("backend", read_axis),
        SSFR_YAML_ROW("set", read_settings, ssfr_sweep_spec, settings),
        SSFR_YAML_ROW_ALL("vary", read_vary),
        SSFR_YAML_ROW_ALL("reference", read_reference),
        SSFR_YAML_ROW("against", read_against, ssfr_sweep_spec, against),
        SSFR_YAML_ROW("added", read_added, ssfr_sweep_spec, against),
        SSFR_YAML_ROW("plot", read_plot, ssfr_sweep_spec, plot),
        SSFR_YAML_ROW_ALL("curves", read_curves),
        SSFR_YAML_ROW("published", ssfr_published_spec_read, ssfr_sweep_spec, published),
        SSFR_YAML_ROW_ALL("quick", read_quick),
        SSFR_YAML_ROW_END,
    };
    ssfr_yaml *tree;
    ssfr_result result = ssfr_yaml_parse(&tree, path, "sweep", text, size);
    if (result == SSFR_OK) result = ssfr_yaml_read_map(ssfr_yaml_root(tree), rows, spec);
    ssfr_yaml_destroy(&tree);
    return result;
}

static ssfr_result read_standard_input(char **out, size_t *size)
{
    ssfr_result result = ssfr_alloc(out, SSFR_YAML_FILE + 1, 1, "standard input");
    if (result != SSFR_OK) return result;
    *size = fread(*out, 1, SSFR_YAML_FILE, stdin);
    if (ferror(stdin)) result = ssfr_fail(SSFR_ERR_IO, "standard input: %s", strerror(errno));
    if (*size == SSFR_YAML_FILE)
        result = ssfr_fail(SSFR_ERR_VALUE, "standard input: a sweep has less than %d bytes", SSFR_YAML_FILE);
    return result;
}

ssfr_result ssfr_sweep_spec_parse(ssfr_sweep_spec **out, const char *path, const char *text, size_t size)
{
    ssfr_result result = SSFR_OK;
    ssfr_sweep_spec *spec = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_sweep_spec_create(&spec));
    SSFR_TRY(read_yaml(spec, path, text, size));
    *out = spec;
    spec = NULL;
end:
    ssfr_sweep_spec_destroy(&spec);
    return result;
}

ssfr_result ssfr_sweep_spec_load(ssfr_sweep_spec **out, const char *path)
{
    ssfr_result result = SSFR_OK;
    char *text = NULL;
    size_t size = 0;
    const bool from_stdin = strcmp(path, "-") == 0;
    *out = NULL;
    if (from_stdin)
        SSFR_TRY(read_standard_input(&text, &size));
    else
        SSFR_TRY(ssfr_read_file(path, SSFR_YAML_FILE, &text, &size));
    SSFR_TRY(ssfr_sweep_spec_parse(out, from_stdin ? "standard input" : path, text, size));
end:
    free(text);
    return result;
}

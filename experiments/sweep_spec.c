/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweep_spec.c: reading what a sweep runs, with file, line and column in every error. */
#include "experiments/sweep_spec.h"
#include "experiments/truth/continuum.h"
#include "experiments/yaml_tree.h"

#include "base/param.h"

#include <errno.h>

enum { MAX_RUNS = 10000000 };
static const double hit = 1e-9; /* steps by which hi may be missed and still be included, or 0 and still be 0 */
static const char truth[] = "truth", truth_kind[] = "truth.kind";

static ssfr_result copy_text(char **out, const char *text, size_t length)
{
    const ssfr_result result = ssfr_alloc(out, length + 1, 1, "a text");
    if (result == SSFR_OK) memcpy(*out, text, length);
    return result;
}

/* ---- axes -------------------------------------------------------------------------------------------------------- */

static void finish_axis(ssfr_axis *axis)
{
    for (size_t i = 0; i < axis->n; i++) free(axis->values[i]);
    free(axis->values);
    free(axis->key);
    free(axis->where);
    *axis = (ssfr_axis){0};
}

static ssfr_result init_axis(ssfr_axis *axis, const char *where, const char *key, size_t n)
{
    ssfr_result result = SSFR_OK;
    *axis = (ssfr_axis){0};
    if (n > SSFR_MAX_VALUES)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %s has %zu values, at most %d", where, key, n, SSFR_MAX_VALUES);
    SSFR_TRY(copy_text(&axis->key, key, strlen(key)));
    SSFR_TRY(copy_text(&axis->where, where, strlen(where)));
    SSFR_TRY(ssfr_alloc(&axis->values, n, sizeof *axis->values, "an axis' values"));
end:
    return result;
}

static ssfr_result add_value(ssfr_axis *axis, const char *text, size_t length)
{
    ssfr_result result = SSFR_OK;
    if (length == 0)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %s: value %zu is empty", axis->where, axis->key, axis->n + 1);
    SSFR_TRY(copy_text(&axis->values[axis->n], text, length));
    for (size_t i = 0; i < axis->n; i++)
        if (strcmp(axis->values[i], axis->values[axis->n]) == 0) {
            result = ssfr_fail(SSFR_ERR_VALUE, "%s: %s: %s stands twice", axis->where, axis->key, axis->values[i]);
            break;
        }
    axis->n++; /* counted even when it is refused, so that it is freed */
end:
    return result;
}

/* Nine digits, so that 0:1:0.1 gives 0.3 and the table says to the letter what was run. */
static ssfr_result add_number(ssfr_axis *axis, double value)
{
    char text[32];
    return add_value(axis, text, (size_t)snprintf(text, sizeof text, "%.9g", value));
}

typedef struct range {
    double lo, hi, step; /* step: the number of values when log */
    bool log;
} range;

/* Splits "lo:hi:step" or "lo:hi:N log". */
static bool parse_range(const char *text, range *out)
{
    char part[3][64];
    const char *at = text;
    const size_t length = strlen(text),
                 all = length > 4 && strcmp(text + length - 4, " log") == 0 ? length - 4 : length;
    double *const to[3] = {&out->lo, &out->hi, &out->step};
    out->log = all < length;
    for (int k = 0; k < 3; k++) {
        const size_t left = (size_t)(text + all - at), colon = strcspn(at, ":"), n = colon < left ? colon : left;
        if (n >= sizeof part[k] || (k < 2) != (colon < left)) return false;
        snprintf(part[k], sizeof part[k], "%.*s", (int)n, at);
        if (!ssfr_parse_number(part[k], to[k])) return false;
        at += n + 1;
    }
    return true;
}

static ssfr_result count_range(const range *r, const char *where, const char *key, const char *text, double *n)
{
    const char *wrong = NULL;
    if (r->log && (r->lo <= 0 || r->hi <= 0))
        wrong = "both ends of a logarithmic range must be positive";
    else if (r->log && (r->step < 2 || r->step != floor(r->step)))
        wrong = "a logarithmic range needs a whole number of values, at least 2";
    else if (!r->log && (r->step == 0 || (r->hi - r->lo) / r->step < 0))
        wrong = "the step never reaches the end";
    if (wrong) return ssfr_fail(SSFR_ERR_VALUE, "%s: %s=%s: %s", where, key, text, wrong);
    *n = r->log ? r->step : floor((r->hi - r->lo) / r->step + hit) + 1;
    if (!(*n <= SSFR_MAX_VALUES))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %s=%s: %.0f values, at most %d", where, key, text, *n, SSFR_MAX_VALUES);
    return SSFR_OK;
}

static ssfr_result init_range(ssfr_axis *axis, const char *where, const char *key, const char *text)
{
    ssfr_result result = SSFR_OK;
    range r = {0};
    double n = 0;
    if (!parse_range(text, &r))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %s=%s: expected lo:hi:step or lo:hi:N log", where, key, text);
    SSFR_TRY(count_range(&r, where, key, text, &n));
    SSFR_TRY(init_axis(axis, where, key, (size_t)n));
    for (double i = 0; i < n; i++) {
        double value = r.log ? exp(ssfr_mix(log(r.lo), log(r.hi), i / (n - 1))) : r.lo + i * r.step;
        if (!r.log && fabs(value) < hit * fabs(r.step)) value = 0; /* in doubles -0.3 + 3 * 0.1 is not 0 */
        SSFR_TRY(add_number(axis, value));
    }
end:
    return result;
}

static ssfr_result init_list(ssfr_axis *axis, const char *where, const char *key, const char *text)
{
    ssfr_result result = SSFR_OK;
    size_t n = 1;
    for (const char *at = text; *at; at++) n += *at == ',';
    SSFR_TRY(init_axis(axis, where, key, n));
    for (const char *at = text; n > 0; n--) {
        at += strspn(at, " ");
        const size_t item = strcspn(at, ",");
        size_t length = item;
        while (length > 0 && at[length - 1] == ' ') length--;
        SSFR_TRY(add_value(axis, at, length));
        at += item + 1;
    }
end:
    return result;
}

bool ssfr_axis_is_parameter(const char *key)
{
    return strchr(key, '.') != NULL;
}

/* Takes over the axis, also when it fails. */
static ssfr_result put_axis(ssfr_sweep_spec *spec, ssfr_axis *axis)
{
    int at = 0;
    while (at < spec->n_axes && strcmp(spec->axes[at].key, axis->key) != 0) at++;
    if (at == SSFR_MAX_AXES) {
        const ssfr_result result =
            ssfr_fail(SSFR_ERR_VALUE, "%s: %s: more than %d axes", axis->where, axis->key, SSFR_MAX_AXES);
        finish_axis(axis);
        return result;
    }
    if (at == spec->n_axes)
        spec->n_axes++;
    else
        finish_axis(&spec->axes[at]);
    spec->axes[at] = *axis;
    *axis = (ssfr_axis){0};
    return SSFR_OK;
}

static ssfr_result check_axis_key(const char *where, const char *key)
{
    static const char *const own[] = {"scene", "size", "backend"};
    bool known = ssfr_axis_is_parameter(key);
    for (size_t i = 0; i < SSFR_COUNT(own); i++) known |= strcmp(key, own[i]) == 0;
    if (known) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_UNKNOWN,
                     "%s: no axis %s: it is a parameter such as pass.param, or scene, size or backend", where, key);
}

ssfr_result ssfr_sweep_spec_vary(ssfr_sweep_spec *spec, const char *where, const char *key, const char *values)
{
    ssfr_result result = SSFR_OK;
    ssfr_axis axis = {0};
    SSFR_TRY(check_axis_key(where, key));
    if (ssfr_axis_is_parameter(key) && strchr(values, ':')) /* names of scenes may hold colons */
        SSFR_TRY(init_range(&axis, where, key, values));
    else
        SSFR_TRY(init_list(&axis, where, key, values));
    SSFR_TRY(put_axis(spec, &axis));
end:
    finish_axis(&axis);
    return result;
}

/* ---- texts of the form key=value --------------------------------------------------------------------------------- */

static ssfr_result split(const char *where, const char *text, char **key, const char **value)
{
    const size_t length = strcspn(text, "=");
    *key = NULL;
    if (length == 0 || text[length] != '=')
        return ssfr_fail(SSFR_ERR_VALUE, "%s %s: expected key=value", where, text);
    *value = text + length + 1;
    return copy_text(key, text, length);
}

ssfr_result ssfr_sweep_spec_vary_text(ssfr_sweep_spec *spec, const char *where, const char *text)
{
    char *key;
    const char *values;
    ssfr_result result = split(where, text, &key, &values);
    if (result == SSFR_OK) result = ssfr_sweep_spec_vary(spec, where, key, values);
    free(key);
    return result;
}

static void finish_setting(ssfr_setting *setting)
{
    free(setting->key);
    free(setting->value);
    free(setting->where);
    *setting = (ssfr_setting){0};
}

static ssfr_result add_setting(ssfr_settings *settings, const char *where, const char *key, const char *value)
{
    ssfr_result result = SSFR_OK;
    if (settings->n == SSFR_MAX_SETTINGS)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: %s: more than %d settings", where, key, SSFR_MAX_SETTINGS);
    ssfr_setting *setting = &settings->items[settings->n++];
    SSFR_TRY(copy_text(&setting->key, key, strlen(key)));
    SSFR_TRY(copy_text(&setting->value, value, strlen(value)));
    SSFR_TRY(copy_text(&setting->where, where, strlen(where)));
end:
    return result;
}

static ssfr_result add_setting_text(ssfr_settings *settings, const char *where, const char *text)
{
    char *key;
    const char *value;
    ssfr_result result = split(where, text, &key, &value);
    if (result == SSFR_OK) result = add_setting(settings, where, key, value);
    free(key);
    return result;
}

ssfr_result ssfr_sweep_spec_set_text(ssfr_sweep_spec *spec, const char *where, const char *text)
{
    return add_setting_text(&spec->settings, where, text);
}

static void finish_settings(ssfr_settings *settings)
{
    for (int i = 0; i < settings->n; i++) finish_setting(&settings->items[i]);
    settings->n = 0;
}

/* Settings of a frame from elsewhere yield; beside one of the same place it is not clear what is meant. */
static ssfr_result compare_with_truth(ssfr_sweep_spec *spec, const char *where)
{
    const ssfr_settings *frame = &spec->reference;
    for (int i = 0; i < frame->n; i++)
        if (strcmp(frame->items[i].where, where) == 0)
            return ssfr_fail(SSFR_ERR_VALUE, "%s truth: beside %s=%s: the reference is the truth or a frame", where,
                             frame->items[i].key, frame->items[i].value);
    finish_settings(&spec->reference);
    spec->compared_with = SSFR_REFERENCE_TRUTH;
    return SSFR_OK;
}

ssfr_result ssfr_sweep_spec_reference_text(ssfr_sweep_spec *spec, const char *where, const char *text)
{
    if (strcmp(text, truth) == 0) return compare_with_truth(spec, where);
    if (spec->compared_with == SSFR_REFERENCE_TRUTH)
        return ssfr_fail(SSFR_ERR_VALUE, "%s %s: the reference is the truth, which has no settings of a frame", where,
                         text);
    spec->compared_with = SSFR_REFERENCE_FRAME;
    return add_setting_text(&spec->reference, where, text);
}

/* ---- what every sweep has ---------------------------------------------------------------------------------------- */

/* The kind that all runs are set to, or the default, so that it stands in the table. */
static const char *kind_of_truth(const ssfr_sweep_spec *spec)
{
    const ssfr_param *row = ssfr_param_find(ssfr_continuum_rows, "kind");
    const char *kind = row->words[(int)row->def];
    for (int i = 0; i < spec->settings.n; i++)
        if (strcmp(spec->settings.items[i].key, truth_kind) == 0) kind = spec->settings.items[i].value;
    return kind;
}

ssfr_result ssfr_sweep_spec_complete(ssfr_sweep_spec *spec)
{
    const struct {
        const char *key, *value; /* NULL: not needed */
    } axes[] = {{"scene", "splash"},
                {"size", "1280x720"},
                {truth_kind, spec->compared_with == SSFR_REFERENCE_TRUTH ? kind_of_truth(spec) : NULL},
                {"backend", "gl"}};
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < SSFR_COUNT(axes) && result == SSFR_OK; i++)
        if (axes[i].value && !ssfr_sweep_spec_axis(spec, axes[i].key))
            result = ssfr_sweep_spec_vary(spec, "default", axes[i].key, axes[i].value);
    return result;
}

static ssfr_result replace_text(char **to, const char *text)
{
    free(*to);
    *to = NULL;
    return copy_text(to, text, strlen(text));
}

ssfr_result ssfr_sweep_spec_pipeline(ssfr_sweep_spec *spec, const char *name)
{
    return replace_text(&spec->pipeline, name);
}

/* ---- scales ------------------------------------------------------------------------------------------------------ */

/* "640x360" to "320x180"; what is no size is left to those who check sizes. */
static void halve(const char *size, char *text, size_t n)
{
    char *end = NULL;
    const long width = strtol(size, &end, 10), height = *end == 'x' ? strtol(end + 1, &end, 10) : 0;
    if (width > 0 && height > 0 && *end == '\0')
        snprintf(text, n, "%ldx%ld", width > 1 ? width / 2 : 1, height > 1 ? height / 2 : 1);
    else
        snprintf(text, n, "%s", size);
}

static ssfr_result halve_sizes(ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    const ssfr_axis *from = ssfr_sweep_spec_axis(spec, "size");
    ssfr_axis axis = {0};
    SSFR_TRY(init_axis(&axis, from->where, from->key, from->n));
    for (size_t i = 0; i < from->n; i++) {
        char text[64];
        halve(from->values[i], text, sizeof text);
        SSFR_TRY(add_value(&axis, text, strlen(text)));
    }
    SSFR_TRY(put_axis(spec, &axis));
end:
    finish_axis(&axis);
    return result;
}

ssfr_result ssfr_sweep_spec_quicken(ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    ssfr_sweep_spec *quick = spec->quick;
    if (!quick || !ssfr_sweep_spec_axis(quick, "size")) SSFR_TRY(halve_sizes(spec));
    if (!quick) goto end;
    if (quick->title) SSFR_TRY(replace_text(&spec->title, quick->title));
    for (int i = 0; i < quick->n_axes; i++) SSFR_TRY(put_axis(spec, &quick->axes[i]));
    for (int i = 0; i < quick->settings.n; i++) {
        const ssfr_setting *s = &quick->settings.items[i];
        SSFR_TRY(add_setting(&spec->settings, s->where, s->key, s->value));
    }
end:
    return result;
}

/* ---- the object -------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_sweep_spec_create(ssfr_sweep_spec **out)
{
    *out = NULL;
    return ssfr_alloc(out, 1, sizeof **out, "a sweep");
}

static void finish_plot(ssfr_plot_spec *plot)
{
    for (int i = 0; i < plot->n_lines; i++) free(plot->lines[i]);
    for (int i = 0; i < plot->n_only; i++) free(plot->only[i].column), free(plot->only[i].cell);
    free(plot->title);
    free(plot->x);
    free(plot->y);
    free(plot->x_label);
    free(plot->y_label);
    free(plot->where);
}

static void finish_published(ssfr_published_spec *published)
{
    for (int i = 0; i < published->n_on; i++) free(published->on[i]), free(published->with[i]);
    free(published->file);
    free(published->column);
    free(published->where);
}

void ssfr_sweep_spec_destroy(ssfr_sweep_spec **spec)
{
    ssfr_sweep_spec *s = *spec;
    if (!s) return;
    for (int i = 0; i < s->n_axes; i++) finish_axis(&s->axes[i]);
    finish_settings(&s->settings);
    finish_settings(&s->reference);
    finish_plot(&s->plot);
    for (int i = 0; i < s->n_curves; i++) finish_plot(&s->curves[i]);
    finish_published(&s->published);
    ssfr_sweep_spec_destroy(&s->quick);
    free(s->title);
    free(s->pipeline);
    free(s);
    *spec = NULL;
}

const ssfr_axis *ssfr_sweep_spec_axis(const ssfr_sweep_spec *spec, const char *key)
{
    const ssfr_axis *found = NULL;
    for (int i = 0; i < spec->n_axes && !found; i++)
        if (strcmp(spec->axes[i].key, key) == 0) found = &spec->axes[i];
    return found;
}

ssfr_result ssfr_sweep_spec_count(const ssfr_sweep_spec *spec, size_t *out)
{
    size_t n = 1;
    for (int i = 0; i < spec->n_axes; i++) {
        n *= spec->axes[i].n; /* at most 1e7 times 1e4 */
        if (n > MAX_RUNS)
            return ssfr_fail(SSFR_ERR_VALUE, "%s: with %s the sweep has more than %d runs", spec->axes[i].where,
                             spec->axes[i].key, MAX_RUNS);
    }
    *out = n;
    return SSFR_OK;
}

void ssfr_sweep_spec_run(const ssfr_sweep_spec *spec, size_t i, size_t index[SSFR_MAX_AXES])
{
    for (int k = spec->n_axes - 1; k >= 0; k--) {
        index[k] = i % spec->axes[k].n;
        i /= spec->axes[k].n;
    }
}

/* ---- YAML -------------------------------------------------------------------------------------------------------- */

static ssfr_result read_sequence(ssfr_sweep_spec *spec, const ssfr_yaml_node *node, const char *where)
{
    ssfr_result result = SSFR_OK;
    ssfr_axis axis = {0};
    if (node->n == 0) return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%s: an empty list", node->name);
    SSFR_TRY(check_axis_key(where, node->name));
    SSFR_TRY(init_axis(&axis, where, node->name, node->n));
    for (size_t i = 0; i < node->n; i++) {
        SSFR_TRY(ssfr_yaml_expect(node->values[i], SSFR_YAML_TEXT));
        SSFR_TRY(add_value(&axis, node->values[i]->text, strlen(node->values[i]->text)));
    }
    SSFR_TRY(put_axis(spec, &axis));
end:
    finish_axis(&axis);
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
        SSFR_TRY(add_setting(to, ssfr_yaml_place(node->keys[i], where), node->keys[i]->text, node->values[i]->text));
    }
end:
    return result;
}

static ssfr_result read_reference(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_sweep_spec *spec = to;
    const bool is_truth = node->kind == SSFR_YAML_TEXT && strcmp(node->text, truth) == 0;
    if (!is_truth && node->kind != SSFR_YAML_MAP)
        return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%s: expected truth, or a map of a frame's settings", node->name);
    spec->compared_with = is_truth ? SSFR_REFERENCE_TRUTH : SSFR_REFERENCE_FRAME;
    return is_truth ? SSFR_OK : read_settings(node, row, &spec->reference);
}

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
        SSFR_YAML_ROW_ALL("lines", read_lines),
        SSFR_YAML_ROW_ALL("only", read_only),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    ssfr_plot_spec *plot = to;
    char where[SSFR_YAML_PLACE];
    (void)row;
    SSFR_TRY(ssfr_yaml_copy(&plot->where, "", ssfr_yaml_place(ssfr_yaml_head(node), where)));
    SSFR_TRY(ssfr_yaml_read_map(node, rows, to));
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

static ssfr_result read_published(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
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

static ssfr_result read_quick(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("title", ssfr_yaml_read_text, ssfr_sweep_spec, title),
        SSFR_YAML_ROW_ALL("scene", read_axis),
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
        SSFR_YAML_ROW("pipeline", ssfr_yaml_read_text, ssfr_sweep_spec, pipeline),
        SSFR_YAML_ROW_ALL("scene", read_axis),
        SSFR_YAML_ROW_ALL("size", read_axis),
        SSFR_YAML_ROW_ALL("backend", read_axis),
        SSFR_YAML_ROW("set", read_settings, ssfr_sweep_spec, settings),
        SSFR_YAML_ROW_ALL("vary", read_vary),
        SSFR_YAML_ROW_ALL("reference", read_reference),
        SSFR_YAML_ROW("plot", read_plot, ssfr_sweep_spec, plot),
        SSFR_YAML_ROW_ALL("curves", read_curves),
        SSFR_YAML_ROW("published", read_published, ssfr_sweep_spec, published),
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

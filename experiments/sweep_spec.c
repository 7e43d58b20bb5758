/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweep_spec.c: reading what a sweep runs, with file, line and column in every error. */
#include "experiments/sweep_spec.h"

#include <errno.h>
#include <stdarg.h>
#include <yaml.h>

enum { MAX_FILE = 1 << 20, MAX_RUNS = 10000000 };
static const double hit = 1e-9; /* steps by which hi may be missed and still be included, or 0 and still be 0 */

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

ssfr_result ssfr_sweep_spec_reference_text(ssfr_sweep_spec *spec, const char *where, const char *text)
{
    spec->has_reference = true;
    return add_setting_text(&spec->reference, where, text);
}

ssfr_result ssfr_sweep_spec_complete(ssfr_sweep_spec *spec)
{
    static const char *const axes[][2] = {{"scene", "splash"}, {"size", "1280x720"}, {"backend", "gl"}};
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < SSFR_COUNT(axes) && result == SSFR_OK; i++)
        if (!ssfr_sweep_spec_axis(spec, axes[i][0]))
            result = ssfr_sweep_spec_vary(spec, "default", axes[i][0], axes[i][1]);
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

/* ---- the object -------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_sweep_spec_create(ssfr_sweep_spec **out)
{
    *out = NULL;
    return ssfr_alloc(out, 1, sizeof **out, "a sweep");
}

static void finish_settings(ssfr_settings *settings)
{
    for (int i = 0; i < settings->n; i++) finish_setting(&settings->items[i]);
}

void ssfr_sweep_spec_destroy(ssfr_sweep_spec **spec)
{
    ssfr_sweep_spec *s = *spec;
    if (!s) return;
    for (int i = 0; i < s->n_axes; i++) finish_axis(&s->axes[i]);
    finish_settings(&s->settings);
    finish_settings(&s->reference);
    for (int i = 0; i < s->plot.n_lines; i++) free(s->plot.lines[i]);
    free(s->plot.title);
    free(s->plot.x);
    free(s->plot.y);
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

typedef struct reader {
    const char *path;
    yaml_document_t *document;
    ssfr_sweep_spec *spec;
} reader;

static void place(const reader *r, const yaml_node_t *node, char text[512])
{
    snprintf(text, 512, "%.400s:%zu:%zu", r->path, node->start_mark.line + 1, node->start_mark.column + 1);
}

/* Fails at a node: "spec.yaml:7:3: backend: expected a text". */
__attribute__((format(printf, 3, 4))) static ssfr_result fail_at(const reader *r, const yaml_node_t *node,
                                                                const char *format, ...)
{
    char where[512], text[384];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    place(r, node, where);
    return ssfr_fail(SSFR_ERR_FORMAT, "%s: %s", where, text);
}

static yaml_node_t *node_at(const reader *r, yaml_node_item_t item)
{
    return yaml_document_get_node(r->document, item);
}

static ssfr_result scalar(const reader *r, const yaml_node_t *node, const char *name, const char **out)
{
    *out = NULL;
    if (node->type != YAML_SCALAR_NODE) return fail_at(r, node, "%s: expected one value", name);
    *out = (const char *)node->data.scalar.value;
    if (strlen(*out) != node->data.scalar.length) return fail_at(r, node, "%s: a zero byte in the value", name);
    return SSFR_OK;
}

/* Calls visit for each pair of a map; keys are texts and stand once. */
typedef ssfr_result visit_fn(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value);

static ssfr_result check_once(const reader *r, const yaml_node_t *map, const yaml_node_pair_t *pair, const char *key)
{
    for (const yaml_node_pair_t *before = map->data.mapping.pairs.start; before < pair; before++) {
        const yaml_node_t *node = node_at(r, before->key);
        if (strcmp((const char *)node->data.scalar.value, key) == 0)
            return fail_at(r, node_at(r, pair->key), "%s stands twice", key);
    }
    return SSFR_OK;
}

static ssfr_result visit_map(reader *r, const yaml_node_t *map, const char *name, visit_fn *visit)
{
    ssfr_result result = SSFR_OK;
    if (map->type != YAML_MAPPING_NODE) return fail_at(r, map, "%s: expected a map of key: value", name);
    for (const yaml_node_pair_t *pair = map->data.mapping.pairs.start; pair < map->data.mapping.pairs.top; pair++) {
        const yaml_node_t *key_node = node_at(r, pair->key);
        const char *key;
        SSFR_TRY(scalar(r, key_node, name, &key));
        SSFR_TRY(check_once(r, map, pair, key));
        SSFR_TRY(visit(r, key_node, key, node_at(r, pair->value)));
    }
end:
    return result;
}

static ssfr_result read_sequence(reader *r, const yaml_node_t *node, const char *where, const char *key)
{
    ssfr_result result = SSFR_OK;
    ssfr_axis axis = {0};
    const yaml_node_item_t *start = node->data.sequence.items.start, *top = node->data.sequence.items.top;
    if (start == top) return fail_at(r, node, "%s: an empty list", key);
    SSFR_TRY(check_axis_key(where, key));
    SSFR_TRY(init_axis(&axis, where, key, (size_t)(top - start)));
    for (const yaml_node_item_t *item = start; item < top; item++) {
        const char *value;
        SSFR_TRY(scalar(r, node_at(r, *item), key, &value));
        SSFR_TRY(add_value(&axis, value, strlen(value)));
    }
    SSFR_TRY(put_axis(r->spec, &axis));
end:
    finish_axis(&axis);
    return result;
}

/* An axis: a range or a list in one text, or a sequence of values that are taken as they stand. */
static ssfr_result read_axis(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    ssfr_result result = SSFR_OK;
    char where[512];
    const char *text;
    if (ssfr_sweep_spec_axis(r->spec, key)) return fail_at(r, key_node, "%s is varied twice", key);
    place(r, key_node, where);
    if (value->type == YAML_SEQUENCE_NODE) return read_sequence(r, value, where, key);
    SSFR_TRY(scalar(r, value, key, &text));
    result = ssfr_sweep_spec_vary(r->spec, where, key, text);
end:
    return result;
}

static ssfr_result read_setting(reader *r, ssfr_settings *to, const yaml_node_t *key_node, const char *key,
                                const yaml_node_t *value)
{
    ssfr_result result = SSFR_OK;
    char where[512];
    const char *text;
    place(r, key_node, where);
    SSFR_TRY(scalar(r, value, key, &text));
    result = add_setting(to, where, key, text);
end:
    return result;
}

static ssfr_result read_one_setting(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    return read_setting(r, &r->spec->settings, key_node, key, value);
}

static ssfr_result read_one_reference(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    return read_setting(r, &r->spec->reference, key_node, key, value);
}

static ssfr_result read_text(reader *r, const yaml_node_t *value, const char *key, char **to)
{
    const char *text;
    const ssfr_result result = scalar(r, value, key, &text);
    return result == SSFR_OK ? replace_text(to, text) : result;
}

static ssfr_result read_lines(reader *r, const yaml_node_t *value)
{
    ssfr_result result = SSFR_OK;
    ssfr_plot_spec *plot = &r->spec->plot;
    if (value->type != YAML_SEQUENCE_NODE) return fail_at(r, value, "lines: expected a list of columns");
    for (yaml_node_item_t *item = value->data.sequence.items.start; item < value->data.sequence.items.top; item++) {
        if (plot->n_lines == SSFR_MAX_LINES)
            return fail_at(r, node_at(r, *item), "lines: more than %d columns", SSFR_MAX_LINES);
        SSFR_TRY(read_text(r, node_at(r, *item), "lines", &plot->lines[plot->n_lines]));
        plot->n_lines++;
    }
end:
    return result;
}

static ssfr_result read_plot_key(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    ssfr_plot_spec *plot = &r->spec->plot;
    if (strcmp(key, "title") == 0) return read_text(r, value, key, &plot->title);
    if (strcmp(key, "x") == 0) return read_text(r, value, key, &plot->x);
    if (strcmp(key, "y") == 0) return read_text(r, value, key, &plot->y);
    if (strcmp(key, "lines") == 0) return read_lines(r, value);
    return fail_at(r, key_node, "plot: no key %s: it has title, x, y and lines", key);
}

static ssfr_result read_plot(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(visit_map(r, value, key, read_plot_key));
    if (!r->spec->plot.x || !r->spec->plot.y) result = fail_at(r, key_node, "plot: x and y must be given");
end:
    return result;
}

static ssfr_result read_settings(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    (void)key_node;
    return visit_map(r, value, key, read_one_setting);
}

static ssfr_result read_reference(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    (void)key_node;
    r->spec->has_reference = true;
    return visit_map(r, value, key, read_one_reference);
}

static ssfr_result read_vary(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    (void)key_node;
    return visit_map(r, value, key, read_axis);
}

static ssfr_result read_title(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    (void)key_node;
    return read_text(r, value, key, &r->spec->title);
}

static ssfr_result read_pipeline(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    (void)key_node;
    return read_text(r, value, key, &r->spec->pipeline);
}

static const struct {
    const char *name;
    visit_fn *read;
} keys[] = {
    {"title", read_title}, {"pipeline", read_pipeline},   {"scene", read_axis},
    {"size", read_axis},   {"backend", read_axis},        {"set", read_settings},
    {"vary", read_vary},   {"reference", read_reference}, {"plot", read_plot},
};

static ssfr_result read_key(reader *r, const yaml_node_t *key_node, const char *key, const yaml_node_t *value)
{
    char list[256] = "";
    size_t used = 0;
    for (size_t i = 0; i < SSFR_COUNT(keys); i++) {
        if (strcmp(keys[i].name, key) == 0) return keys[i].read(r, key_node, key, value);
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", keys[i].name);
    }
    return fail_at(r, key_node, "no key %s: a sweep has %s", key, list);
}

static ssfr_result read_document(reader *r)
{
    yaml_node_t *root = yaml_document_get_root_node(r->document);
    if (!root) return ssfr_fail(SSFR_ERR_FORMAT, "%s:1:1: an empty file, expected a map of key: value", r->path);
    return visit_map(r, root, "the sweep", read_key);
}

static ssfr_result fail_yaml(const char *path, const yaml_parser_t *parser)
{
    const char *problem = parser->problem ? parser->problem : "malformed YAML";
    if (parser->error == YAML_MEMORY_ERROR) return ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for its YAML", path);
    if (parser->error == YAML_READER_ERROR)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: byte %zu: %s", path, parser->problem_offset, problem);
    return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu:%zu: %s", path, parser->problem_mark.line + 1,
                     parser->problem_mark.column + 1, problem);
}

/* A second document would be ignored: it is an error. */
static ssfr_result check_end(const char *path, yaml_parser_t *parser)
{
    yaml_document_t document;
    if (!yaml_parser_load(parser, &document)) return fail_yaml(path, parser);
    const yaml_node_t *root = yaml_document_get_root_node(&document);
    const size_t line = root ? root->start_mark.line + 1 : 0;
    yaml_document_delete(&document);
    return root ? ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu:1: a second document, a sweep has one", path, line) : SSFR_OK;
}

static ssfr_result read_yaml(ssfr_sweep_spec *spec, const char *path, const char *text, size_t size)
{
    ssfr_result result = SSFR_OK;
    yaml_parser_t parser;
    yaml_document_t document;
    if (!yaml_parser_initialize(&parser)) return ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for a YAML parser", path);
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, size);
    if (yaml_parser_load(&parser, &document)) {
        result = read_document(&(reader){.path = path, .document = &document, .spec = spec});
        yaml_document_delete(&document);
        if (result == SSFR_OK) result = check_end(path, &parser);
    } else {
        result = fail_yaml(path, &parser);
    }
    yaml_parser_delete(&parser);
    return result;
}

static ssfr_result read_standard_input(char **out, size_t *size)
{
    ssfr_result result = ssfr_alloc(out, MAX_FILE + 1, 1, "standard input");
    if (result != SSFR_OK) return result;
    *size = fread(*out, 1, MAX_FILE, stdin);
    if (ferror(stdin)) result = ssfr_fail(SSFR_ERR_IO, "standard input: %s", strerror(errno));
    if (*size == MAX_FILE)
        result = ssfr_fail(SSFR_ERR_VALUE, "standard input: a sweep has less than %d bytes", MAX_FILE);
    return result;
}

ssfr_result ssfr_sweep_spec_load(ssfr_sweep_spec **out, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_sweep_spec *spec = NULL;
    char *text = NULL;
    size_t size = 0;
    const bool from_stdin = strcmp(path, "-") == 0;
    *out = NULL;
    SSFR_TRY(ssfr_sweep_spec_create(&spec));
    if (from_stdin)
        SSFR_TRY(read_standard_input(&text, &size));
    else
        SSFR_TRY(ssfr_read_file(path, MAX_FILE, &text, &size));
    SSFR_TRY(read_yaml(spec, from_stdin ? "standard input" : path, text, size));
    *out = spec;
    spec = NULL;
end:
    free(text);
    ssfr_sweep_spec_destroy(&spec);
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweep_spec.c: what a sweep runs, put together from axes, variants, settings and defaults. */
#include "experiments/sweep_spec_internal.h"
#include "experiments/truth/continuum.h"

#include "base/param.h"

enum { MAX_RUNS = 10000000, QUICK_VIEWS = 12 };
static const double hit = 1e-9; /* steps by which hi may be missed and still be included, or 0 and still be 0 */
static const char truth[] = "truth", truth_kind[] = "truth.kind";

static ssfr_result copy_text(char **out, const char *text, size_t length)
{
    return ssfr_text_print(out, "a text", "%.*s", (int)length, text);
}

/* ---- axes -------------------------------------------------------------------------------------------------------- */

void ssfr_axis_finish(ssfr_axis *axis)
{
    for (size_t i = 0; i < axis->n; i++) free(axis->values[i]);
    free(axis->values);
    free(axis->key);
    free(axis->where);
    *axis = (ssfr_axis){0};
}

ssfr_result ssfr_axis_init(ssfr_axis *axis, const char *where, const char *key, size_t n)
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

ssfr_result ssfr_axis_add(ssfr_axis *axis, const char *text, size_t length)
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
    return ssfr_axis_add(axis, text, (size_t)snprintf(text, sizeof text, "%.9g", value));
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
    SSFR_TRY(ssfr_axis_init(axis, where, key, (size_t)n));
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
    SSFR_TRY(ssfr_axis_init(axis, where, key, n));
    for (const char *at = text; n > 0; n--) {
        at += strspn(at, " ");
        const size_t item = strcspn(at, ",");
        size_t length = item;
        while (length > 0 && at[length - 1] == ' ') length--;
        SSFR_TRY(ssfr_axis_add(axis, at, length));
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
ssfr_result ssfr_sweep_spec_put(ssfr_sweep_spec *spec, ssfr_axis *axis)
{
    int at = 0;
    while (at < spec->n_axes && strcmp(spec->axes[at].key, axis->key) != 0) at++;
    if (at == SSFR_MAX_AXES) {
        const ssfr_result result =
            ssfr_fail(SSFR_ERR_VALUE, "%s: %s: more than %d axes", axis->where, axis->key, SSFR_MAX_AXES);
        ssfr_axis_finish(axis);
        return result;
    }
    if (at == spec->n_axes)
        spec->n_axes++;
    else
        ssfr_axis_finish(&spec->axes[at]);
    spec->axes[at] = *axis;
    *axis = (ssfr_axis){0};
    return SSFR_OK;
}

ssfr_result ssfr_axis_check_key(const char *where, const char *key)
{
    static const char *const own[] = {"pipeline", "variant", "scene", "camera", "view", "frame", "size", "leave_out",
                                      "cull", "backend"};
    bool known = ssfr_axis_is_parameter(key);
    char list[200] = "";
    size_t used = 0;
    for (size_t i = 0; i < SSFR_COUNT(own); i++) {
        known |= strcmp(key, own[i]) == 0;
        ssfr_list_name(list, sizeof list, &used, own[i]);
    }
    if (known) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no axis %s: it is a parameter such as pass.param, or one of %s", where, key,
                     list);
}

ssfr_result ssfr_sweep_spec_vary(ssfr_sweep_spec *spec, const char *where, const char *key, const char *values)
{
    ssfr_result result = SSFR_OK;
    ssfr_axis axis = {0};
    SSFR_TRY(ssfr_axis_check_key(where, key));
    if (ssfr_axis_is_parameter(key) && strchr(values, ':')) /* names of scenes may hold colons */
        SSFR_TRY(init_range(&axis, where, key, values));
    else
        SSFR_TRY(init_list(&axis, where, key, values));
    SSFR_TRY(ssfr_sweep_spec_put(spec, &axis));
end:
    ssfr_axis_finish(&axis);
    return result;
}

ssfr_result ssfr_sweep_spec_put_views(ssfr_sweep_spec *spec, const char *where)
{
    ssfr_result result = SSFR_OK;
    ssfr_axis axis = {0};
    SSFR_TRY(ssfr_axis_init(&axis, where, "view", spec->path.views));
    for (size_t i = 0; i < spec->path.views; i++) SSFR_TRY(add_number(&axis, (double)i));
    SSFR_TRY(ssfr_sweep_spec_put(spec, &axis));
end:
    ssfr_axis_finish(&axis);
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

ssfr_result ssfr_settings_add(ssfr_settings *settings, const char *where, const char *key, const char *value)
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
    if (result == SSFR_OK) result = ssfr_settings_add(settings, where, key, value);
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
    } axes[] = {{"pipeline", SSFR_SWEEP_PIPELINE},
                {"scene", "splash"},
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

static ssfr_result halve_axis(ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    const ssfr_axis *from = ssfr_sweep_spec_axis(spec, "size");
    ssfr_axis axis = {0};
    SSFR_TRY(ssfr_axis_init(&axis, from->where, from->key, from->n));
    for (size_t i = 0; i < from->n; i++) {
        char text[64];
        halve(from->values[i], text, sizeof text);
        SSFR_TRY(ssfr_axis_add(&axis, text, strlen(text)));
    }
    SSFR_TRY(ssfr_sweep_spec_put(spec, &axis));
end:
    ssfr_axis_finish(&axis);
    return result;
}

/* Those of variants are halved unless `quick` has variants of its own. */
static ssfr_result halve_variants(ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < spec->n_variants; i++) {
        ssfr_settings *own = &spec->variants[i]->own;
        for (int k = 0; k < own->n; k++) {
            char text[64];
            if (strcmp(own->items[k].key, "size") != 0) continue;
            halve(own->items[k].value, text, sizeof text);
            SSFR_TRY(replace_text(&own->items[k].value, text));
        }
    }
end:
    return result;
}

static ssfr_result shorten_path(ssfr_sweep_spec *spec)
{
    const ssfr_axis *views = ssfr_sweep_spec_axis(spec, "view");
    if (!views || spec->path.views <= QUICK_VIEWS) return SSFR_OK;
    spec->path.views = QUICK_VIEWS;
    return ssfr_sweep_spec_put_views(spec, views->where);
}

/* Changes hands, so that both are freed. */
static void replace_variants(ssfr_sweep_spec *spec, ssfr_sweep_spec *quick)
{
    const int n = spec->n_variants;
    if (quick->n_variants == 0) return;
    for (int i = 0; i < SSFR_MAX_VARIANTS; i++) {
        ssfr_variant *of_all = spec->variants[i];
        spec->variants[i] = quick->variants[i];
        quick->variants[i] = of_all;
    }
    spec->n_variants = quick->n_variants;
    quick->n_variants = n;
}

ssfr_result ssfr_sweep_spec_quicken(ssfr_sweep_spec *spec)
{
    ssfr_result result = SSFR_OK;
    ssfr_sweep_spec *quick = spec->quick;
    if (!quick || !ssfr_sweep_spec_axis(quick, "size")) SSFR_TRY(halve_axis(spec));
    if (!quick || quick->n_variants == 0) SSFR_TRY(halve_variants(spec));
    if (!quick || quick->path.views == 0) SSFR_TRY(shorten_path(spec));
    if (!quick) goto end;
    if (quick->path.views > 0) spec->path = quick->path;
    replace_variants(spec, quick);
    if (quick->title) SSFR_TRY(replace_text(&spec->title, quick->title));
    for (int i = 0; i < quick->n_axes; i++) SSFR_TRY(ssfr_sweep_spec_put(spec, &quick->axes[i]));
    for (int i = 0; i < quick->settings.n; i++) {
        const ssfr_setting *s = &quick->settings.items[i];
        SSFR_TRY(ssfr_settings_add(&spec->settings, s->where, s->key, s->value));
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

void ssfr_published_spec_finish(ssfr_published_spec *published)
{
    for (int i = 0; i < published->n_on; i++) free(published->on[i]), free(published->with[i]);
    free(published->file);
    free(published->column);
    free(published->where);
}

static void finish_against(ssfr_against_spec *against)
{
    finish_settings(&against->cells);
    for (int i = 0; i < against->n_added; i++) free(against->added[i]);
    free(against->where);
}

static void destroy_variant(ssfr_variant **variant)
{
    ssfr_variant *v = *variant;
    if (!v) return;
    finish_settings(&v->own);
    finish_settings(&v->settings);
    free(v->name);
    free(v->where);
    free(v);
    *variant = NULL;
}

void ssfr_sweep_spec_destroy(ssfr_sweep_spec **spec)
{
    ssfr_sweep_spec *s = *spec;
    if (!s) return;
    for (int i = 0; i < s->n_variants; i++) destroy_variant(&s->variants[i]);
    finish_against(&s->against);
    for (int i = 0; i < s->n_axes; i++) ssfr_axis_finish(&s->axes[i]);
    finish_settings(&s->settings);
    finish_settings(&s->reference);
    finish_plot(&s->plot);
    for (int i = 0; i < s->n_curves; i++) finish_plot(&s->curves[i]);
    ssfr_published_spec_finish(&s->published);
    ssfr_sweep_spec_destroy(&s->quick);
    free(s->title);
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

const ssfr_variant *ssfr_sweep_spec_variant(const ssfr_sweep_spec *spec, const char *name)
{
    const ssfr_variant *found = NULL;
    for (int i = 0; i < spec->n_variants && !found; i++)
        if (strcmp(spec->variants[i]->name, name) == 0) found = spec->variants[i];
    return found;
}

const ssfr_variant *ssfr_sweep_spec_variant_of(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES])
{
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, "variant");
    return axis ? ssfr_sweep_spec_variant(spec, axis->values[index[axis - spec->axes]]) : NULL;
}

const ssfr_setting *ssfr_variant_own(const ssfr_variant *variant, const char *key)
{
    const ssfr_setting *found = NULL;
    for (int i = 0; variant && i < variant->own.n && !found; i++)
        if (strcmp(variant->own.items[i].key, key) == 0) found = &variant->own.items[i];
    return found;
}

const char *ssfr_sweep_spec_where(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES], const char *key)
{
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, key);
    const ssfr_setting *own = ssfr_variant_own(ssfr_sweep_spec_variant_of(spec, index), key);
    return own ? own->where : axis ? axis->where : "default";
}

bool ssfr_sweep_spec_next(const ssfr_sweep_spec *spec, size_t n, const char *const *keys, size_t index[SSFR_MAX_AXES])
{
    bool more = false;
    for (size_t k = n; k-- > 0 && !more;) {
        const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, keys[k]);
        if (!axis) continue;
        size_t *i = &index[axis - spec->axes];
        more = *i + 1 < axis->n;
        *i = more ? *i + 1 : 0;
    }
    return more;
}

const char *ssfr_sweep_spec_value(const ssfr_sweep_spec *spec, const size_t index[SSFR_MAX_AXES], const char *key)
{
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, key);
    const ssfr_setting *own = ssfr_variant_own(ssfr_sweep_spec_variant_of(spec, index), key);
    return own ? own->value : axis ? axis->values[index[axis - spec->axes]] : NULL;
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

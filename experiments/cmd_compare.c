/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_compare.c: `ssfr compare`: every metric that fits two images, and whether they are good enough. */
#include "experiments/capture.h"
#include "experiments/channels.h"
#include "experiments/command.h"
#include "experiments/csv.h"
#include "experiments/difference_picture.h"
#include "experiments/options.h"
#include "experiments/output.h"
#include "experiments/sampled.h"

#include "base/field.h"
#include "metrics/metrics.h"

typedef struct compare_options {
    ssfr_list channels, requirements;
    const char *mask, *diff, *picture;
    double range, radius;
} compare_options;

#define ROW(...) SSFR_OPTION(compare_options, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(channels, "channel", 'c', LIST, "NAMES",
        "compare these channels, by commas: R,G,B as colour, Z as depth, N.X,N.Y,N.Z as normals, others as numbers; "
        "can be repeated (default: of R,G,B, Z, N and T what both files have)",
        0, 0),
    ROW(mask, "mask", 0, TEXT, "FILE.exr[:NAME]",
        "count only pixels where this image, or its first channel, is not 0", 0, 0),
    ROW(diff, "diff", 0, TEXT, "FILE.exr", "write A - B", 0, 0),
    ROW(picture, "picture", 0, TEXT, "FILE.png",
        "draw where the depth of A is nearer or farther than that of B, in particle radii where a file tells them", 0,
        0),
    ROW(range, "range", 0, NUMBER, "X",
        "of the picture's colour bar to both sides (default: 95 % of the pixels lie in it)", 1e-9, 1e9),
    ROW(radius, "radius", 0, NUMBER, "M",
        "particle radius, for the rows in radii (default: what B says of itself, else A)", 1e-9, 1e9),
    ROW(requirements, "require", 0, LIST, "METRIC>=X",
        "exit with 1 unless this holds: >=, <=, >, < or ==; can be repeated", 0, 0),
    SSFR_OPTION_END,
};

enum { MAX_GROUPS = 16 };

typedef struct group { /* channels that belong together */
    const char *channels;
    char label[64]; /* stands before the metrics of any numbers, "" for the picture itself */
    ssfr_metric_kind kind;
    bool metres; /* the numbers are lengths */
    ssfr_field *a, *b;
    const char *err_channel, *err_unit; /* where a reference has its own error */
    double err_scale;                   /* to that unit */
    ssfr_field *err;                    /* NULL: it has none */
} group;

static const group usual[] = {
    {.channels = "R,G,B", .label = "", .kind = SSFR_METRIC_COLOUR, .err_channel = "C.err", .err_unit = "1",
     .err_scale = 1},
    {.channels = "Z", .label = "Z.", .kind = SSFR_METRIC_DEPTH, .err_channel = "Z.err", .err_unit = "m",
     .err_scale = 1},
    {.channels = "N.X,N.Y,N.Z", .label = "N.", .kind = SSFR_METRIC_NORMAL, .err_channel = "N.err", .err_unit = "deg",
     .err_scale = 180 / M_PI},
    {.channels = "T", .label = "T.", .kind = SSFR_METRIC_ANY, .metres = true, .err_channel = "T.err", .err_unit = "m",
     .err_scale = 1},
};

/* ---- requirements ------------------------------------------------------------------------------------------------ */

typedef struct requirement {
    const char *text;
    size_t name; /* length of the metric's name */
    char relation[3];
    double value;
    bool announced, met; /* there is such a row; it holds */
} requirement;

static ssfr_result parse_requirement(const char *text, requirement *out)
{
    static const char *const relations[] = {">=", "<=", ">", "<", "=="};
    bool known = false;
    char *end = NULL;
    *out = (requirement){.text = text, .name = strcspn(text, "<>=")};
    const size_t n = strspn(text + out->name, "<>=");
    const char *number = text + out->name + n;
    snprintf(out->relation, sizeof out->relation, "%.*s", (int)n, text + out->name);
    out->value = strtod(number, &end); /* inf is a fair demand on psnr */
    for (size_t i = 0; i < SSFR_COUNT(relations); i++) known |= strcmp(relations[i], out->relation) == 0;
    if (out->name == 0 || n > 2 || !known || end == number || *end || isnan(out->value))
        return ssfr_fail(SSFR_ERR_VALUE, "--require %s: expected a metric, one of >= <= > < ==, and a number", text);
    return SSFR_OK;
}

/* NaN holds nothing. */
static bool holds(const requirement *r, double value)
{
    const bool less = value < r->value, greater = value > r->value, equal = value == r->value;
    if (r->relation[0] == '=') return equal;
    return (r->relation[0] == '>' ? greater : less) || (r->relation[1] == '=' && equal);
}

static bool is_about(const requirement *r, const char *metric)
{
    return strlen(metric) == r->name && memcmp(metric, r->text, r->name) == 0;
}

static void judge(requirement *list, int n, const char *metric, const char *unit, double value)
{
    for (int i = 0; i < n; i++) {
        requirement *r = &list[i];
        if (!is_about(r, metric)) continue;
        r->met = holds(r, value);
        if (!r->met)
            ssfr_log(SSFR_ERROR, "%s does not hold: %s is %.9g%s%s", r->text, metric, value,
                     strcmp(unit, "1") ? " " : "", strcmp(unit, "1") ? unit : "");
    }
}

static void announce(requirement *list, int n, const char *metric)
{
    for (int i = 0; i < n; i++) list[i].announced |= is_about(&list[i], metric);
}

static ssfr_result check_announced(const requirement *list, int n)
{
    for (int i = 0; i < n; i++)
        if (!list[i].announced)
            return ssfr_fail(SSFR_ERR_UNKNOWN, "--require %s: %.*s is not among what was measured", list[i].text,
                             (int)list[i].name, list[i].text);
    return SSFR_OK;
}

/* ---- groups of channels ------------------------------------------------------------------------------------------ */

static ssfr_result channels_of(const char *path, char **out)
{
    *out = NULL;
    if (ssfr_output_kind_of(path) != SSFR_OUTPUT_PNG) return ssfr_exr_channels(path, out);
    return ssfr_text_print(out, "channel names", "R,G,B");
}

static group group_of(const char *channels)
{
    group g = {.channels = channels, .kind = SSFR_METRIC_ANY};
    for (size_t i = 0; i < SSFR_COUNT(usual); i++)
        if (strcmp(usual[i].channels, channels) == 0) return usual[i];
    snprintf(g.label, sizeof g.label, "%s.", channels);
    for (char *c = g.label; *c; c++)
        if (*c == ',') *c = '+';
    return g;
}

/* What the user names, else what both files have of the usual channels, else what both files have alike. The groups
 * point into `has`, the channels of each file. */
static ssfr_result find_groups(const char *const paths[2], const ssfr_list *channels, char *has[2], group *groups,
                               int *n)
{
    ssfr_result result = SSFR_OK;
    *n = 0;
    if (channels->n > MAX_GROUPS)
        return ssfr_fail(SSFR_ERR_VALUE, "--channel %s: more than %d of them", channels->items[MAX_GROUPS], MAX_GROUPS);
    for (int i = 0; i < channels->n; i++) groups[(*n)++] = group_of(channels->items[i]);
    for (int i = 0; i < 2; i++) SSFR_TRY(channels_of(paths[i], &has[i]));
    if (*n) goto end;
    for (size_t i = 0; i < SSFR_COUNT(usual); i++)
        if (ssfr_channels_include(has[0], usual[i].channels) && ssfr_channels_include(has[1], usual[i].channels))
            groups[(*n)++] = usual[i];
    if (*n == 0 && strcmp(has[0], has[1]) == 0) groups[(*n)++] = group_of(has[0]);
    if (*n == 0)
        result = ssfr_fail(SSFR_ERR_VALUE, "%s has channels %s, %s has %s: say which with --channel", paths[0], has[0],
                           paths[1], has[1]);
end:
    return result;
}

static ssfr_result load(const char *path, const char *channels, ssfr_field **out)
{
    *out = NULL;
    if (ssfr_output_kind_of(path) != SSFR_OUTPUT_PNG) return ssfr_exr_load(path, channels, out);
    if (strcmp(channels, "R,G,B") != 0)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: --channel %s: a PNG has only R,G,B", path, channels);
    return ssfr_png_load(path, out);
}

static ssfr_result load_mask(const char *argument, ssfr_field **out)
{
    ssfr_result result = SSFR_OK;
    const char *slash = strrchr(argument, '/'), *colon = strrchr(slash ? slash : argument, ':');
    char *path = NULL, *all = NULL;
    SSFR_TRY(ssfr_alloc(&path, strlen(argument) + 1, 1, "a path"));
    memcpy(path, argument, colon ? (size_t)(colon - argument) : strlen(argument));
    if (!colon) SSFR_TRY(ssfr_exr_channels(path, &all));
    if (all) all[strcspn(all, ",")] = '\0';
    SSFR_TRY(ssfr_exr_load(path, colon ? colon + 1 : all, out));
end:
    free(path);
    free(all);
    return result;
}

/* ---- measuring --------------------------------------------------------------------------------------------------- */

typedef struct comparison {
    const char *const *paths; /* A, B */
    group groups[MAX_GROUPS];
    int n;
    ssfr_field *mask; /* what the user counts, of a sample what was cast of it; NULL: all pixels */
    ssfr_field *cast; /* NULL: all of B is known */
    int every;        /* px, of the squares of which one pixel was cast each */
    double radius;    /* m; 0: not known */
    ssfr_csv *csv;    /* NULL while rows are only announced */
    requirement *requirements;
    int n_requirements;
} comparison;

static ssfr_result add_bound(ssfr_csv *csv, double value)
{
    return isnan(value) ? ssfr_csv_text(csv, "") : ssfr_csv_number(csv, value);
}

static ssfr_result add_row(const comparison *c, const char *name, const char *unit, const ssfr_sampled *value)
{
    ssfr_result result = SSFR_OK;
    if (!c->csv) {
        announce(c->requirements, c->n_requirements, name);
        goto end;
    }
    SSFR_TRY(ssfr_csv_text(c->csv, name));
    SSFR_TRY(ssfr_csv_text(c->csv, unit));
    SSFR_TRY(ssfr_csv_number(c->csv, value->value));
    SSFR_TRY(add_bound(c->csv, value->low));
    SSFR_TRY(add_bound(c->csv, value->high));
    SSFR_TRY(ssfr_csv_end_row(c->csv));
    judge(c->requirements, c->n_requirements, name, unit, value->value);
end:
    return result;
}

/* Lengths in particle radii, too. */
static ssfr_result add_rows(const comparison *c, const char *name, const char *unit, const ssfr_sampled *value)
{
    ssfr_result result = SSFR_OK;
    char in_radii[160];
    const double r = c->radius;
    SSFR_TRY(add_row(c, name, unit, value));
    if (strcmp(unit, "m") != 0 || r == 0) goto end;
    snprintf(in_radii, sizeof in_radii, "%s_radii", name);
    SSFR_TRY(add_row(c, in_radii, "radii", &(ssfr_sampled){value->value / r, value->low / r, value->high / r}));
end:
    return result;
}

static ssfr_pair pair_of(const comparison *c, const group *g)
{
    return (ssfr_pair){.a = g->a, .b = g->b, .mask = c->mask, .sampled = c->cast != NULL};
}

/* Of numbers in general it is known only here. */
static const char *unit_of(const group *g, const ssfr_metric *metric)
{
    if (!g->metres || metric->form == SSFR_FORM_COUNT) return metric->unit;
    return metric->form == SSFR_FORM_MEAN_SQUARE ? "m^2" : "m";
}

/* Largest values and counts of a sample are those of the pixels cast, and have no interval. */
static ssfr_result measure_metric(const comparison *c, const group *g, const ssfr_metric *metric)
{
    ssfr_result result = SSFR_OK;
    const ssfr_pair pair = pair_of(c, g);
    ssfr_sampled value = {NAN, NAN, NAN};
    char name[128];
    snprintf(name, sizeof name, "%s%s", metric->kind == SSFR_METRIC_ANY ? g->label : "", metric->name);
    if (c->csv) SSFR_TRY(ssfr_metric_measure_pair(metric, &pair, &value.value));
    if (c->csv && c->cast && ssfr_metric_is_mean(metric))
        SSFR_TRY(ssfr_sampled_metric(metric, &pair, c->cast, c->every, &value));
    SSFR_TRY(add_rows(c, name, unit_of(g, metric), &value));
end:
    return result;
}

typedef struct errors { /* of the reference itself */
    const comparison *c;
    const group *g;
    ssfr_pair pair;
} errors;

static void error_at(const void *user, int x, int y, double *sum, double *n)
{
    const errors *e = user;
    const bool masked = e->c->mask && *ssfr_field_at(e->c->mask, x, y) == 0;
    const bool counts = !masked && ssfr_metric_counts(e->g->kind, &e->pair, x, y);
    *n = counts;
    *sum = counts ? *ssfr_field_at(e->g->err, x, y) * e->g->err_scale : 0;
}

/* What the reference says of its own error, over the pixels that the metrics count: no number without it. */
static ssfr_result measure_errors(const comparison *c, const group *g)
{
    ssfr_result result = SSFR_OK;
    const errors e = {c, g, pair_of(c, g)};
    const char *ending = strcmp(g->err_unit, "deg") == 0 ? "_deg" : "";
    double sum = 0, n = 0, largest = 0;
    char name[64];
    for (int y = 0; y < g->err->h; y++)
        for (int x = 0; x < g->err->w; x++) {
            double value, counts;
            error_at(&e, x, y, &value, &counts);
            sum += value, n += counts;
            largest = isnan(value) || value > largest ? value : largest;
        }
    ssfr_sampled mean = {sum / n, NAN, NAN}, max = {n > 0 ? largest : (double)NAN, NAN, NAN};
    if (c->cast) SSFR_TRY(ssfr_sampled_mean(c->cast, c->every, error_at, &e, (ssfr_sampled_range){0, 0}, &mean));
    snprintf(name, sizeof name, "%s_mean%s", g->err_channel, ending);
    SSFR_TRY(add_rows(c, name, g->err_unit, &mean));
    snprintf(name, sizeof name, "%s_max%s", g->err_channel, ending);
    SSFR_TRY(add_rows(c, name, g->err_unit, &max));
end:
    return result;
}

/* Of depths and normals what stands for no surface is no number to take means of, but may be the same to the bit. */
static bool fits(const comparison *c, const group *g, const ssfr_metric *metric)
{
    const bool numbers = g->kind == SSFR_METRIC_ANY || g->kind == SSFR_METRIC_COLOUR;
    if (c->cast && metric->form == SSFR_FORM_WHOLE) return false;
    return metric->kind == g->kind || (metric->kind == SSFR_METRIC_ANY && (numbers || !ssfr_metric_is_mean(metric)));
}

static ssfr_result measure(const comparison *c, const group *g)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; ssfr_metric_at(i); i++)
        if (fits(c, g, ssfr_metric_at(i))) SSFR_TRY(measure_metric(c, g, ssfr_metric_at(i)));
    if (g->err) SSFR_TRY(measure_errors(c, g));
end:
    return result;
}

/* m; 0 where neither file says how large the particles are. */
static double radius_of(const char *const paths[2], const compare_options *options)
{
    static const char *const names[] = {"radius", "scene.radius"};
    char error[SSFR_CAPTURE_SIZE];
    double radius = options->radius;
    ssfr_capture_begin("compare");
    for (int i = 0; i < 4 && !(radius > 0); i++) { /* the reference first */
        const char *path = paths[1 - i / 2];
        if (ssfr_output_kind_of(path) != SSFR_OUTPUT_EXR || ssfr_exr_number(path, names[i % 2], &radius)) radius = 0;
    }
    ssfr_capture_end(error);
    return isfinite(radius) ? radius : 0;
}

static ssfr_result check_picture(const char *path)
{
    if (ssfr_output_kind_of(path) != SSFR_OUTPUT_PNG)
        return ssfr_fail(SSFR_ERR_VALUE, "--picture %s: expected a name that ends in .png", path);
    return ssfr_output_check_file(path);
}

/* NULL when depth is not compared. */
static const group *find_depth(const comparison *c)
{
    const group *found = NULL;
    for (int i = 0; i < c->n && !found; i++)
        if (c->groups[i].kind == SSFR_METRIC_DEPTH) found = &c->groups[i];
    return found;
}

static ssfr_result draw_difference(const comparison *c, const compare_options *options)
{
    char title[512];
    const ssfr_difference_picture picture = {
        .title = title, .radius = c->radius, .range = options->range, .mask = c->mask};
    const group *g = find_depth(c);
    snprintf(title, sizeof title, "depth: A = %.200s, B = %.200s", c->paths[0], c->paths[1]);
    return ssfr_difference_picture_save(options->picture, g->a, g->b, &picture);
}

/* A - B, in A's place. */
static ssfr_result save_difference(const char *path, group *groups, int n)
{
    ssfr_layer layers[MAX_GROUPS];
    for (int i = 0; i < n; i++) {
        ssfr_field *a = groups[i].a;
        const size_t count = (size_t)a->w * (size_t)a->h * (size_t)a->c;
        for (size_t k = 0; k < count; k++) a->data[k] -= groups[i].b->data[k];
        layers[i] = (ssfr_layer){.channels = groups[i].channels, .field = a};
    }
    return ssfr_exr_save(path, n, layers, 0, NULL);
}

/* ---- loading ----------------------------------------------------------------------------------------------------- */

static ssfr_result check_sizes(const comparison *c, const char *mask)
{
    const ssfr_field *a = c->groups[0].a, *b = c->groups[0].b, *m = c->mask;
    if (a->w != b->w || a->h != b->h)
        return ssfr_fail(SSFR_ERR_VALUE, "%s is %dx%d pixels, %s is %dx%d", c->paths[0], a->w, a->h, c->paths[1], b->w,
                         b->h);
    if (m && (m->w != a->w || m->h != a->h || m->c != 1))
        return ssfr_fail(SSFR_ERR_VALUE, "--mask %s: %dx%d pixels of %d channels, not %dx%d of one", mask, m->w, m->h,
                         m->c, a->w, a->h);
    return SSFR_OK;
}

/* has: the channels of B. A cast of all pixels is no sample. */
static ssfr_result load_cast(comparison *c, const char *has)
{
    ssfr_result result = SSFR_OK;
    if (!ssfr_channels_include(has, "cast")) return SSFR_OK;
    SSFR_TRY(ssfr_exr_load(c->paths[1], "cast", &c->cast));
    SSFR_TRY(ssfr_sampled_find(c->cast, c->paths[1], &c->every));
    if (c->every == 1) {
        ssfr_field_destroy(&c->cast);
    } else if (!c->mask) {
        SSFR_TRY(ssfr_field_copy(&c->mask, c->cast));
    } else {
        for (int i = 0; i < c->cast->w * c->cast->h; i++)
            if (c->cast->data[i] == 0) c->mask->data[i] = 0;
    }
end:
    return result;
}

static ssfr_result load_all(comparison *c, const compare_options *options, const char *has)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < c->n; i++) SSFR_TRY(load(c->paths[0], c->groups[i].channels, &c->groups[i].a));
    for (int i = 0; i < c->n; i++) SSFR_TRY(load(c->paths[1], c->groups[i].channels, &c->groups[i].b));
    for (int i = 0; i < c->n; i++) {
        group *g = &c->groups[i];
        if (g->err_channel && ssfr_channels_include(has, g->err_channel))
            SSFR_TRY(ssfr_exr_load(c->paths[1], g->err_channel, &g->err));
    }
    if (options->mask) SSFR_TRY(load_mask(options->mask, &c->mask));
    SSFR_TRY(check_sizes(c, options->mask));
    SSFR_TRY(load_cast(c, has));
    c->radius = radius_of(c->paths, options);
end:
    return result;
}

static void finish(comparison *c)
{
    for (int i = 0; i < c->n; i++) {
        group *g = &c->groups[i];
        ssfr_field_destroy(&g->a), ssfr_field_destroy(&g->b), ssfr_field_destroy(&g->err);
    }
    ssfr_field_destroy(&c->mask);
    ssfr_field_destroy(&c->cast);
    ssfr_csv_destroy(&c->csv);
}

static ssfr_result compare(const char *const paths[2], const compare_options *options, requirement *requirements)
{
    static const char *const columns[] = {"metric", "unit", "value", "low", "high"};
    ssfr_result result = SSFR_OK;
    comparison c = {.paths = paths, .requirements = requirements, .n_requirements = options->requirements.n};
    char *has[2] = {NULL, NULL};
    SSFR_TRY(find_groups(paths, &options->channels, has, c.groups, &c.n));
    if (options->picture && !find_depth(&c)) {
        result = ssfr_fail(SSFR_ERR_VALUE, "--picture %s: draws depth, and Z is not compared", options->picture);
        goto end;
    }
    SSFR_TRY(load_all(&c, options, has[1]));
    for (int i = 0; i < c.n; i++) SSFR_TRY(measure(&c, &c.groups[i]));
    SSFR_TRY(check_announced(requirements, options->requirements.n));
    SSFR_TRY(ssfr_csv_create(&c.csv, NULL, SSFR_COUNT(columns), columns, 1, false));
    for (int i = 0; i < c.n; i++) SSFR_TRY(measure(&c, &c.groups[i]));
    if (options->picture) SSFR_TRY(draw_difference(&c, options));
    if (options->diff) SSFR_TRY(save_difference(options->diff, c.groups, c.n));
end:
    finish(&c);
    free(has[0]);
    free(has[1]);
    return result;
}

int ssfr_cmd_compare(int argc, char **argv)
{
    static requirement requirements[SSFR_MAX_LIST];
    ssfr_result result = SSFR_OK;
    compare_options options = {0};
    ssfr_command_line line;
    bool all_met = true;
    const ssfr_option_set sets[] = {{"compare", rows, &options}, {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0], .arguments = "A B", .min_arguments = 2, .max_arguments = 2, .sets = sets,
        .help = "Measures how A lies from the reference B, each an EXR or a PNG, and prints "
                "metric,unit,value,low,high as CSV. Lengths come in particle radii, too, where the radius is "
                "known. Where B tells its own error (Z.err, N.err, T.err, C.err), its mean and maximum over the "
                "pixels counted stand in rows of these names. Where B has a channel cast that is 0 somewhere, as "
                "of 'ssfr truth --every N', only the pixels cast count. Means and what is made of them are then "
                "estimates for the whole image, each pixel weighted by the size of its square, and low to high is "
                "a 95 % interval: one pixel a square is a stratified sample, its variance that of pairs of "
                "neighbouring squares (collapsed strata), with Student's quantile. That of depths, which may be far "
                "off in few pixels, reaches as far as those too few to be seen could move it. Largest values and "
                "counts are those of the pixels cast, without an interval; whether a pixel is interior or at an edge "
                "is then asked of its neighbours in A alone; the median, ssim and flip are left out. Elsewhere low "
                "and high are empty."};
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    for (int i = 0; i < options.requirements.n; i++)
        SSFR_TRY(parse_requirement(options.requirements.items[i], &requirements[i]));
    if (options.diff) SSFR_TRY(ssfr_output_check_image(options.diff, false));
    if (options.picture) SSFR_TRY(check_picture(options.picture));
    SSFR_TRY(compare(line.arguments.items, &options, requirements));
    for (int i = 0; i < options.requirements.n; i++) all_met &= requirements[i].met;
end:
    return result == SSFR_OK && !all_met ? SSFR_EXIT_FAILED : ssfr_exit_status(result);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_compare.c: `ssfr compare`: every metric that fits two images, and whether they are good enough. */
#include "experiments/capture.h"
#include "experiments/channels.h"
#include "experiments/command.h"
#include "experiments/csv.h"
#include "experiments/difference_picture.h"
#include "experiments/options.h"
#include "experiments/output.h"

#include "metrics/metrics.h"

typedef struct compare_options {
    ssfr_list channels, requirements;
    const char *mask, *diff, *picture;
    double range;
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
    ROW(requirements, "require", 0, LIST, "METRIC>=X",
        "exit with 1 unless this holds: >=, <=, >, < or ==; can be repeated", 0, 0),
    SSFR_OPTION_END,
};

enum { MAX_GROUPS = 16 };

typedef struct group { /* channels that belong together */
    const char *channels;
    char label[64]; /* stands before the metrics of any numbers, "" for the picture itself */
    ssfr_metric_kind kind;
    ssfr_field *a, *b;
} group;

static const group usual[] = {
    {.channels = "R,G,B", .label = "", .kind = SSFR_METRIC_COLOUR},
    {.channels = "Z", .label = "Z.", .kind = SSFR_METRIC_DEPTH},
    {.channels = "N.X,N.Y,N.Z", .label = "N.", .kind = SSFR_METRIC_NORMAL},
    {.channels = "T", .label = "T.", .kind = SSFR_METRIC_ANY},
};

/* ---- requirements ------------------------------------------------------------------------------------------------ */

typedef struct requirement {
    const char *text;
    size_t name; /* length of the metric's name */
    char relation[3];
    double value;
    bool met, measured;
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

static void judge(requirement *list, int n, const char *metric, const char *unit, double value)
{
    for (int i = 0; i < n; i++) {
        requirement *r = &list[i];
        if (strlen(metric) != r->name || memcmp(metric, r->text, r->name) != 0) continue;
        r->measured = true;
        r->met = holds(r, value);
        if (!r->met)
            ssfr_log(SSFR_ERROR, "%s does not hold: %s is %.9g%s%s", r->text, metric, value,
                     strcmp(unit, "1") ? " " : "", strcmp(unit, "1") ? unit : "");
    }
}

static ssfr_result check_measured(const requirement *list, int n)
{
    for (int i = 0; i < n; i++)
        if (!list[i].measured)
            return ssfr_fail(SSFR_ERR_UNKNOWN, "--require %s: %.*s is not among what was measured", list[i].text,
                             (int)list[i].name, list[i].text);
    return SSFR_OK;
}

/* ---- groups of channels ------------------------------------------------------------------------------------------ */

static ssfr_result channels_of(const char *path, char **out)
{
    ssfr_result result = SSFR_OK;
    *out = NULL;
    if (ssfr_output_kind_of(path) != SSFR_OUTPUT_PNG) return ssfr_exr_channels(path, out);
    SSFR_TRY(ssfr_alloc(out, sizeof "R,G,B", 1, "channel names"));
    strcpy(*out, "R,G,B");
end:
    return result;
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
    if (*n) goto end;
    for (int i = 0; i < 2; i++) SSFR_TRY(channels_of(paths[i], &has[i]));
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

static ssfr_result add_row(ssfr_csv *csv, const char *metric, const char *unit, double value)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_csv_text(csv, metric));
    SSFR_TRY(ssfr_csv_text(csv, unit));
    SSFR_TRY(ssfr_csv_number(csv, value));
    SSFR_TRY(ssfr_csv_end_row(csv));
end:
    return result;
}

static ssfr_result measure(ssfr_csv *csv, const group *g, const ssfr_field *mask, requirement *requirements, int n)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; ssfr_metric_at(i); i++) {
        const ssfr_metric *metric = ssfr_metric_at(i);
        char name[128];
        double value = NAN;
        if (metric->kind != g->kind && metric->kind != SSFR_METRIC_ANY) continue;
        snprintf(name, sizeof name, "%s%s", metric->kind == SSFR_METRIC_ANY ? g->label : "", metric->name);
        SSFR_TRY(ssfr_metric_measure(metric, g->a, g->b, mask, &value));
        SSFR_TRY(add_row(csv, name, metric->unit, value));
        judge(requirements, n, name, metric->unit, value);
    }
end:
    return result;
}

/* m; 0 where neither file says how large the particles are. */
static double radius_of(const char *const paths[2])
{
    char error[SSFR_CAPTURE_SIZE];
    double radius = 0;
    ssfr_capture_begin("compare");
    for (int i = 0; i < 2 && radius == 0; i++)
        if (ssfr_output_kind_of(paths[i]) != SSFR_OUTPUT_EXR || ssfr_exr_number(paths[i], "scene.radius", &radius))
            radius = 0;
    ssfr_capture_end(error);
    return radius;
}

static ssfr_result check_picture(const char *path)
{
    if (ssfr_output_kind_of(path) != SSFR_OUTPUT_PNG)
        return ssfr_fail(SSFR_ERR_VALUE, "--picture %s: expected a name that ends in .png", path);
    return ssfr_output_check_file(path);
}

static ssfr_result draw_difference(const char *const paths[2], const compare_options *options, const group *groups,
                                   int n)
{
    char title[512];
    const ssfr_difference_picture picture = {
        .title = title, .radius = radius_of(paths), .range = options->range};
    snprintf(title, sizeof title, "depth: A = %.200s, B = %.200s", paths[0], paths[1]);
    for (int i = 0; i < n; i++)
        if (groups[i].kind == SSFR_METRIC_DEPTH)
            return ssfr_difference_picture_save(options->picture, groups[i].a, groups[i].b, &picture);
    return ssfr_fail(SSFR_ERR_VALUE, "--picture %s: draws depth, and Z is not compared", options->picture);
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

static ssfr_result compare(const char *const paths[2], const compare_options *options, requirement *requirements)
{
    static const char *const columns[] = {"metric", "unit", "value"};
    ssfr_result result = SSFR_OK;
    group groups[MAX_GROUPS] = {0};
    char *has[2] = {NULL, NULL};
    int n = 0;
    ssfr_field *mask = NULL;
    ssfr_csv *csv = NULL;
    SSFR_TRY(find_groups(paths, &options->channels, has, groups, &n));
    if (options->mask) SSFR_TRY(load_mask(options->mask, &mask));
    for (int i = 0; i < n; i++) SSFR_TRY(load(paths[0], groups[i].channels, &groups[i].a));
    for (int i = 0; i < n; i++) SSFR_TRY(load(paths[1], groups[i].channels, &groups[i].b));
    if (groups[0].a->w != groups[0].b->w || groups[0].a->h != groups[0].b->h) {
        result = ssfr_fail(SSFR_ERR_VALUE, "%s is %dx%d pixels, %s is %dx%d", paths[0], groups[0].a->w, groups[0].a->h,
                           paths[1], groups[0].b->w, groups[0].b->h);
        goto end;
    }
    if (options->picture) SSFR_TRY(draw_difference(paths, options, groups, n));
    SSFR_TRY(ssfr_csv_create(&csv, NULL, SSFR_COUNT(columns), columns, 1, false));
    for (int i = 0; i < n; i++) SSFR_TRY(measure(csv, &groups[i], mask, requirements, options->requirements.n));
    SSFR_TRY(check_measured(requirements, options->requirements.n));
    if (options->diff) SSFR_TRY(save_difference(options->diff, groups, n));
end:
    for (int i = 0; i < n; i++) ssfr_field_destroy(&groups[i].a), ssfr_field_destroy(&groups[i].b);
    free(has[0]);
    free(has[1]);
    ssfr_field_destroy(&mask);
    ssfr_csv_destroy(&csv);
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
        .help = "Measures how A lies from the reference B, each an EXR or a PNG, and prints metric,unit,value as CSV."};
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

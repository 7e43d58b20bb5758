/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_scene_info.c: `ssfr scene info`: what is in a scene, in a frame of it, or in a file of particles. */
#include "experiments/cmd_scene.h"
#include "experiments/console.h"
#include "experiments/scenes/make.h"
#include "experiments/stage.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <sys/stat.h>

/* A line of the table: what, unit, then its value or values. */
static ssfr_result add_line(ssfr_table *table, const char *what, const char *unit, const char *value)
{
    return ssfr_table_row(table, (const char *[]){what, unit, value});
}

static ssfr_result add_number(ssfr_table *table, const char *what, const char *unit, double number)
{
    char value[32];
    snprintf(value, sizeof value, "%.9g", number);
    return add_line(table, what, unit, value);
}

static ssfr_result add_vector(ssfr_table *table, const char *what, const char *unit, const double v[3])
{
    char value[96];
    snprintf(value, sizeof value, "%.9g,%.9g,%.9g", v[0], v[1], v[2]);
    return add_line(table, what, unit, value);
}

static ssfr_result add_statistics(ssfr_table *table, const char *what, const char *unit, double *values, size_t n)
{
    char text[160];
    const double mean = gsl_stats_mean(values, 1, n);
    gsl_sort(values, 1, n);
    snprintf(text, sizeof text, "min %.6g, median %.6g, mean %.6g, max %.6g", values[0],
             gsl_stats_median_from_sorted_data(values, 1, n), mean, values[n - 1]);
    return add_line(table, what, unit, text);
}

/* By number of kind: of a file's own kinds nothing is known, diffuse particles have those of ssfr_kind. */
static const char *const unnamed[] = {NULL}, *const diffuse[] = {"spray", "foam", "bubbles", NULL};

/* How many particles have each kind: numbers of the file, few of them. names: of the first kinds; a list ends with
 * NULL. */
static ssfr_result add_kinds(ssfr_table *table, const uint32_t *kind, size_t n, const char *const *names)
{
    enum { MAX_KINDS = 16 };
    ssfr_result result = SSFR_OK;
    size_t counts[MAX_KINDS] = {0}, others = 0;
    for (size_t i = 0; i < n; i++) *(kind[i] < MAX_KINDS ? &counts[kind[i]] : &others) += 1;
    for (int k = 0; k < MAX_KINDS; k++) {
        char what[24];
        if (*names)
            snprintf(what, sizeof what, "%s", *names++);
        else
            snprintf(what, sizeof what, "kind %d", k);
        if (counts[k]) SSFR_TRY(add_number(table, what, "particles", (double)counts[k]));
    }
    if (others) SSFR_TRY(add_number(table, "other kinds", "particles", (double)others));
end:
    return result;
}

static ssfr_result add_arrays(ssfr_table *table, const ssfr_particles *p)
{
    ssfr_result result = SSFR_OK;
    double *values = NULL;
    SSFR_TRY(ssfr_alloc(&values, p->n, sizeof *values, "statistics"));
    for (size_t i = 0; p->velocity && i < p->n; i++) {
        const double v[3] = {p->velocity[3 * i], p->velocity[3 * i + 1], p->velocity[3 * i + 2]};
        values[i] = sqrt(ssfr_dot(v, v));
    }
    if (p->velocity) SSFR_TRY(add_statistics(table, "speed", "m/s", values, p->n));
    for (size_t i = 0; p->density && i < p->n; i++) values[i] = p->density[i];
    if (p->density) SSFR_TRY(add_statistics(table, "density", "kg/m^3", values, p->n));
    for (size_t i = 0; p->lifetime && i < p->n; i++) values[i] = p->lifetime[i];
    if (p->lifetime) SSFR_TRY(add_statistics(table, "lifetime", "s", values, p->n));
    for (size_t i = 0; p->neighbours && i < p->n; i++) values[i] = p->neighbours[i];
    if (p->neighbours) SSFR_TRY(add_statistics(table, "neighbours", "1", values, p->n));
    for (size_t i = 0; p->id && i < p->n; i++) values[i] = p->id[i];
    if (p->id) SSFR_TRY(add_statistics(table, "id", "1", values, p->n));
    if (p->kind) SSFR_TRY(add_kinds(table, p->kind, p->n, unnamed));
end:
    free(values);
    return result;
}

/* ---- the particles ----------------------------------------------------------------------------------------------- */

/* Density and neighbours where the file has none: without a radius they cannot be known. */
static ssfr_result add_completed(ssfr_table *table, ssfr_particles *p)
{
    ssfr_result result = SSFR_OK;
    unsigned computed = 0;
    if (p->n == 0 || !(p->radius > 0)) return SSFR_OK;
    SSFR_TRY(ssfr_particles_complete(p, &computed));
    if (computed & SSFR_COMPUTED_DENSITY) SSFR_TRY(add_line(table, "density is", "", "computed"));
    if (computed & SSFR_COMPUTED_NEIGHBOURS) SSFR_TRY(add_line(table, "neighbours are", "", "computed"));
end:
    return result;
}

static ssfr_result add_share(ssfr_table *table, const char *what, double n, double of)
{
    char value[32];
    snprintf(value, sizeof value, "%.3g", 100 * n / of);
    return add_line(table, what, "%", value);
}

/* What the papers take particles for, at the thresholds of the library and the figures. */
static ssfr_result add_classes(ssfr_table *table, const ssfr_particles *p)
{
    static const double splash_density = 0.5 * SSFR_REST_DENSITY;
    static const int t_stray = 2, t_foam = 10; /* neighbours; Neto 2015, Fig. 6b */
    char what[48];
    ssfr_result result = SSFR_OK;
    size_t counts[SSFR_N_CLASSES];
    unsigned char *classes = NULL;
    float *foam = NULL;
    ssfr_weber *weber = NULL;
    double sum = 0;
    SSFR_TRY(ssfr_alloc(&classes, p->n, sizeof *classes, "classes"));
    SSFR_TRY(ssfr_alloc(&foam, p->n, sizeof *foam, "foam values"));
    SSFR_TRY(ssfr_classify_by_density(p, splash_density, classes, counts));
    SSFR_TRY(add_share(table, "splashes below half the rest density", (double)counts[SSFR_CLASS_SPLASH], (double)p->n));
    SSFR_TRY(ssfr_classify_by_neighbours(p, t_stray, t_foam, classes, counts));
    snprintf(what, sizeof what, "strays up to %d neighbours", t_stray);
    SSFR_TRY(add_share(table, what, (double)counts[SSFR_CLASS_STRAY], (double)p->n));
    snprintf(what, sizeof what, "foam up to %d neighbours", t_foam);
    SSFR_TRY(add_share(table, what, (double)counts[SSFR_CLASS_FOAM], (double)p->n));
    if (!p->velocity) goto end;
    SSFR_TRY(ssfr_weber_create(&weber, NULL));
    SSFR_TRY(ssfr_weber_step(weber, p, 0, foam, NULL, NULL));
    for (size_t i = 0; i < p->n; i++) sum += (double)foam[i];
    SSFR_TRY(add_share(table, "foam by Weber number", sum, (double)p->n));
end:
    ssfr_weber_destroy(&weber);
    free(foam);
    free(classes);
    return result;
}

static ssfr_result add_particles(ssfr_table *table, const ssfr_stage *stage)
{
    ssfr_result result = SSFR_OK;
    ssfr_particles *p = stage->particles;
    double lo[3], hi[3];
    ssfr_particles_bounds(p, lo, hi);
    if (stage->frame >= 0) SSFR_TRY(add_number(table, "frame", "1", (double)stage->frame));
    if (stage->description) SSFR_TRY(add_number(table, "time", "s", stage->time));
    SSFR_TRY(add_number(table, "particles", "1", (double)p->n));
    if (stage->foam) SSFR_TRY(add_number(table, "diffuse particles", "1", (double)stage->foam->n));
    if (stage->foam && stage->foam->kind) SSFR_TRY(add_kinds(table, stage->foam->kind, stage->foam->n, diffuse));
    if (stage->n_dropped) SSFR_TRY(add_number(table, "dropped", "1", (double)stage->n_dropped));
    SSFR_TRY(add_number(table, "packets", "1", (double)p->n_packets));
    SSFR_TRY(add_number(table, "radius", "m", p->radius));
    if (stage->estimate > 0) SSFR_TRY(add_line(table, "radius is", "", "estimated"));
    SSFR_TRY(add_number(table, "half spacing", "m", ssfr_particles_spacing(p)));
    SSFR_TRY(add_vector(table, "lowest", "m", lo));
    SSFR_TRY(add_vector(table, "highest", "m", hi));
    SSFR_TRY(add_number(table, "floor", "m", stage->scene.floor));
    SSFR_TRY(add_number(table, "solids", "1", stage->scene.n_solids));
    SSFR_TRY(add_vector(table, "eye", "m", stage->scene.camera.eye));
    SSFR_TRY(add_completed(table, p));
    if (p->n) SSFR_TRY(add_arrays(table, p));
    if (p->n && p->density && p->neighbours) SSFR_TRY(add_classes(table, p));
end:
    return result;
}

/* ---- a simulated scene ------------------------------------------------------------------------------------------- */

/* Bytes of the frames 0 .. n - 1. */
static double count_bytes(const char *folder, int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        for (int foam = 0; foam < 2; foam++) {
            struct stat info;
            char *path = NULL;
            if (ssfr_make_path(folder, i, foam == 1, &path) == SSFR_OK && stat(path, &info) == 0)
                sum += (double)info.st_size;
            free(path);
        }
    return sum;
}

static ssfr_result add_description(ssfr_table *table, const ssfr_stage *stage, int n_made)
{
    ssfr_result result = SSFR_OK;
    const ssfr_description *d = stage->description;
    SSFR_TRY(add_line(table, "title", "", d->title));
    SSFR_TRY(add_line(table, "scale", "", ssfr_scale_words[d->scale]));
    SSFR_TRY(add_number(table, "most particles", "1", (double)d->solver.max_particles));
    SSFR_TRY(add_number(table, "frames", "1", d->n_frames));
    SSFR_TRY(add_number(table, "frame rate", "1/s", d->frame_rate));
    SSFR_TRY(add_vector(table, "domain from", "m", d->solver.lo));
    SSFR_TRY(add_vector(table, "domain to", "m", d->solver.hi));
    for (int i = 0; i < d->n_views; i++) SSFR_TRY(add_line(table, "camera", "", d->views[i].name));
    for (int i = 0; i < d->n_settings; i++) SSFR_TRY(add_line(table, d->settings[i].key, "set", d->settings[i].value));
    SSFR_TRY(add_number(table, "frames made", "1", n_made));
    SSFR_TRY(add_line(table, "folder", "", stage->folder));
    SSFR_TRY(add_number(table, "on disk", "bytes", count_bytes(stage->folder, n_made)));
end:
    return result;
}

/* The frame to look at: information makes none. */
static ssfr_result choose_made(const ssfr_stage *stage, const ssfr_stage_options *options, int n_made, long *frame)
{
    ssfr_result result = SSFR_OK;
    const bool asked = options->frame >= 0 || !isnan(options->time);
    *frame = n_made - 1;
    if (asked) SSFR_TRY(ssfr_stage_find_frame(stage, options, frame));
    if (asked && *frame >= n_made)
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: frame %ld is not made: %d of %d frames are", stage->name, *frame,
                           n_made, stage->description->n_frames);
end:
    return result;
}

static ssfr_result describe(const char *scene, const ssfr_stage_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_stage *stage = NULL;
    ssfr_table table;
    long frame = -1;
    ssfr_table_init(&table, 3);
    SSFR_TRY(ssfr_stage_open(&stage, scene, options));
    const int n_made = stage->folder ? ssfr_make_count(stage->folder) : 0;
    SSFR_TRY(add_line(&table, "scene", "", stage->source.name));
    if (stage->description) SSFR_TRY(add_description(&table, stage, n_made));
    if (stage->description) SSFR_TRY(choose_made(stage, options, n_made, &frame));
    if (stage->source.kind == SSFR_SCENE_SEQUENCE) SSFR_TRY(add_number(&table, "frames", "1", (double)stage->n_frames));
    if (!stage->description || n_made > 0) {
        SSFR_TRY(ssfr_stage_show(stage, options, frame));
        SSFR_TRY(add_particles(&table, stage));
    }
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    ssfr_stage_destroy(&stage);
    return result;
}

ssfr_result ssfr_scene_info(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    ssfr_stage_options options;
    ssfr_command_line line;
    const ssfr_option_set sets[] = {SSFR_STAGE_SETS(&options), {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0], .arguments = "SCENE", .min_arguments = 1, .max_arguments = 1, .sets = sets,
        .help = "Says what is in a scene, a file of particles, or a frame of a sequence; of a simulated scene, which "
                "frames there are and what is in the last, or in that of --frame."};
    ssfr_stage_defaults(&options);
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    options.seed = (uint64_t)line.seed;
    SSFR_TRY(describe(line.arguments.items[0], &options));
end:
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_scene.c: `ssfr scene`: the built-in scenes, and what is in a scene or a particle file. */
#include "experiments/command.h"
#include "experiments/console.h"
#include "experiments/scenes/scenes.h"
#include "experiments/stage.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>

static ssfr_result list(void)
{
    ssfr_result result = SSFR_OK;
    ssfr_table table;
    ssfr_table_init(&table, 2);
    SSFR_TRY(ssfr_table_add(&table, "SCENE"));
    SSFR_TRY(ssfr_table_add(&table, "HELP"));
    for (int i = 0; ssfr_builtin_at(i); i++) {
        SSFR_TRY(ssfr_table_add(&table, "%s", ssfr_builtin_at(i)->name));
        SSFR_TRY(ssfr_table_add(&table, "%s", ssfr_builtin_at(i)->help));
    }
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    return result;
}

/* ---- what is in a scene ------------------------------------------------------------------------------------------ */

/* A line of the table: what, unit, then its value or values. */
static ssfr_result add_line(ssfr_table *table, const char *what, const char *unit, const char *value)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_table_add(table, "%s", what));
    SSFR_TRY(ssfr_table_add(table, "%s", unit));
    SSFR_TRY(ssfr_table_add(table, "%s", value));
end:
    return result;
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

/* How many particles have each kind: numbers of the file, few of them. */
static ssfr_result add_kinds(ssfr_table *table, const uint32_t *kind, size_t n)
{
    enum { MAX_KINDS = 16 };
    ssfr_result result = SSFR_OK;
    size_t counts[MAX_KINDS] = {0}, others = 0;
    for (size_t i = 0; i < n; i++) *(kind[i] < MAX_KINDS ? &counts[kind[i]] : &others) += 1;
    for (int k = 0; k < MAX_KINDS; k++) {
        char what[24];
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
    if (p->kind) SSFR_TRY(add_kinds(table, p->kind, p->n));
end:
    free(values);
    return result;
}

static ssfr_result describe(const char *scene, const ssfr_stage_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_stage *stage = NULL;
    ssfr_table table;
    double lo[3], hi[3];
    ssfr_table_init(&table, 3);
    SSFR_TRY(ssfr_stage_create(&stage, scene, options));
    const ssfr_particles *p = stage->particles;
    ssfr_particles_bounds(p, lo, hi);
    SSFR_TRY(add_line(&table, "scene", "", stage->name));
    SSFR_TRY(add_number(&table, "particles", "1", (double)p->n));
    if (stage->n_dropped) SSFR_TRY(add_number(&table, "dropped", "1", (double)stage->n_dropped));
    SSFR_TRY(add_number(&table, "packets", "1", (double)p->n_packets));
    SSFR_TRY(add_number(&table, "radius", "m", p->radius));
    SSFR_TRY(add_number(&table, "half spacing", "m", ssfr_particles_spacing(p)));
    SSFR_TRY(add_vector(&table, "lowest", "m", lo));
    SSFR_TRY(add_vector(&table, "highest", "m", hi));
    SSFR_TRY(add_number(&table, "floor", "m", stage->scene.floor));
    SSFR_TRY(add_number(&table, "solids", "1", stage->scene.n_solids));
    SSFR_TRY(add_vector(&table, "eye", "m", stage->scene.camera.eye));
    if (p->n) SSFR_TRY(add_arrays(&table, p));
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    ssfr_stage_destroy(&stage);
    return result;
}

static ssfr_result run(const ssfr_list *arguments, const ssfr_stage_options *options)
{
    const char *what = arguments->items[0];
    if (strcmp(what, "list") == 0 && arguments->n == 1) return list();
    if (strcmp(what, "info") == 0 && arguments->n == 2) return describe(arguments->items[1], options);
    return ssfr_fail(SSFR_ERR_VALUE, "%s: expected 'list', or 'info SCENE'", what);
}

int ssfr_cmd_scene(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    ssfr_stage_options options;
    ssfr_command_line line;
    const ssfr_option_set sets[] = {{"info", ssfr_stage_rows, &options}, {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0], .arguments = "list|info SCENE", .min_arguments = 1, .max_arguments = 2, .sets = sets,
        .help = "Lists the built-in scenes, or says what is in a scene or a particle file."};
    ssfr_stage_defaults(&options);
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    options.seed = (uint64_t)line.seed;
    SSFR_TRY(run(&line.arguments, &options));
end:
    return ssfr_exit_status(result);
}

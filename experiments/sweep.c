/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweep.c: the product of the axes, row by row into a CSV that can be gone on with. */
#include "experiments/sweep.h"
#include "experiments/capture.h"
#include "experiments/console.h"
#include "experiments/csv.h"
#include "experiments/figures.h"
#include "experiments/interrupt.h"
#include "experiments/means.h"
#include "experiments/meta.h"
#include "experiments/output.h"
#include "experiments/rig.h"
#include "experiments/scenes/make.h"

#include "base/param.h"

#include <omp.h>

/* Columns behind the parameters, of what is an axis. What a variant has of its own does not tell rows apart, the
 * variant does: it stands behind the status. */
static const struct {
    const char *name, *axis;
} own_columns[] = {{"variant", "variant"},   {"leave_out", "leave_out"}, {"cull", "cull"},
                   {"camera", "camera"},     {"view", "view"},           {"frame", "frame"},
                   {"scene", "scene"},       {"pipeline", "pipeline"},
                   {"backend", "backend"},   {"width", "size"},          {"height", "size"}};

enum {
    N_OWN = SSFR_COUNT(own_columns),
    MAX_KEYS = SSFR_MAX_AXES + N_OWN,
    N_SAID = SSFR_N_COLUMNS + SSFR_N_COLUMN_TEXTS, /* columns of every table */
    MAX_COLUMNS = MAX_KEYS + 2 + N_SAID + SSFR_MAX_ADDED,
};

typedef struct sweep {
    const ssfr_sweep_spec *spec;
    const ssfr_sweep_options *o;
    ssfr_graph *graph; /* knows which parameters there are: those that are varied are the same in all pipelines */
    ssfr_gl *gl;
    ssfr_rig_options rig_options;
    ssfr_rig *rig;
    ssfr_csv *csv;
    size_t n_runs, group; /* consecutive runs that stay in one shard */
    int n_keys, n_told, n_columns; /* n_told stand behind the status */
    char headers[MAX_COLUMNS][256];
    const char *columns[MAX_COLUMNS];
    struct {
        char name[64], help[256];
    } added[SSFR_MAX_ADDED];
    ssfr_column meanings[N_SAID + SSFR_MAX_ADDED]; /* of the columns behind the status */
    int on[SSFR_MAX_ON]; /* keys that published numbers are joined by */
    size_t n_failed, n_there; /* runs that failed; that the table had before */
} sweep;

static const char *pipeline_of_first(const sweep *s)
{
    static const size_t first[SSFR_MAX_AXES];
    return ssfr_sweep_spec_value(s->spec, first, "pipeline");
}

/* ---- the runs ---------------------------------------------------------------------------------------------------- */

/* Runs that follow each other with the same twin: a shard takes them together. */
static size_t count_group(const sweep *s)
{
    const ssfr_sweep_spec *spec = s->spec;
    size_t n = 1;
    for (int i = spec->n_axes - 1; i >= 0; i--) {
        const ssfr_axis *axis = &spec->axes[i];
        if (axis->n > 1 && strcmp(axis->key, "backend") != 0 && ssfr_rig_makes_frames(s->graph, axis)) break;
        n *= axis->n;
    }
    return n;
}

static bool in_shard(const sweep *s, size_t run)
{
    return run / s->group % s->o->shards == s->o->shard - 1;
}

typedef struct key {
    const char *cells[MAX_KEYS]; /* n_keys, then n_told */
    char size[2][16];
} key;

/* Some variant has one of its own. */
static bool is_told(const sweep *s, const char *axis)
{
    bool found = false;
    for (int i = 0; i < s->spec->n_variants; i++) found |= ssfr_variant_own(s->spec->variants[i], axis) != NULL;
    return found;
}

static bool is_key(const sweep *s, const char *axis)
{
    return ssfr_sweep_spec_axis(s->spec, axis) && !is_told(s, axis);
}

static const char *own_cell(const sweep *s, const size_t index[SSFR_MAX_AXES], size_t column, key *k)
{
    const char *name = own_columns[column].name;
    const char *value = ssfr_sweep_spec_value(s->spec, index, own_columns[column].axis);
    const bool height = strcmp(name, "height") == 0;
    int size[2] = {0, 0};
    if (!height && strcmp(name, "width") != 0) return value ? value : "";
    ssfr_rig_size(value, size);
    snprintf(k->size[height], sizeof k->size[height], "%d", size[height]);
    return k->size[height];
}

static void fill_key(const sweep *s, const size_t index[SSFR_MAX_AXES], key *k)
{
    int n = 0;
    for (int i = 0; i < s->spec->n_axes; i++)
        if (ssfr_axis_is_parameter(s->spec->axes[i].key)) k->cells[n++] = s->spec->axes[i].values[index[i]];
    for (size_t i = 0; i < N_OWN; i++)
        if (is_key(s, own_columns[i].axis)) k->cells[n++] = own_cell(s, index, i, k);
    for (size_t i = 0; i < N_OWN; i++)
        if (is_told(s, own_columns[i].axis)) k->cells[n++] = own_cell(s, index, i, k);
}

/* ---- columns ----------------------------------------------------------------------------------------------------- */

static void add_column(sweep *s, const char *name, const char *unit)
{
    ssfr_column_header(name, unit, s->headers[s->n_columns], sizeof s->headers[0]);
    s->columns[s->n_columns] = s->headers[s->n_columns];
    s->n_columns++;
}

/* Of the graph or of the truth. */
static const char *unit_of(const sweep *s, const char *parameter)
{
    const ssfr_param *row = ssfr_graph_row(s->graph, parameter);
    return (row ? row : ssfr_rig_truth_row(parameter))->unit;
}

/* Columns behind the status, but for a published one. */
static int n_said(const sweep *s)
{
    return N_SAID + s->spec->against.n_added;
}

static void find_meanings(sweep *s)
{
    memcpy(s->meanings, ssfr_columns, sizeof ssfr_columns);
    for (int i = 0; i < s->spec->against.n_added; i++) {
        const ssfr_column *of = ssfr_column_find(s->spec->against.added[i]);
        snprintf(s->added[i].name, sizeof s->added[i].name, "%s_added", of->name);
        snprintf(s->added[i].help, sizeof s->added[i].help, "%s, less that of the row that this is held against",
                 of->help);
        s->meanings[N_SAID + i] = (ssfr_column){s->added[i].name, of->unit, of->better, s->added[i].help};
    }
}

static void name_columns(sweep *s)
{
    find_meanings(s);
    for (int i = 0; i < s->spec->n_axes; i++) {
        const char *name = s->spec->axes[i].key;
        if (ssfr_axis_is_parameter(name)) add_column(s, name, unit_of(s, name));
    }
    for (size_t i = 0; i < N_OWN; i++)
        if (is_key(s, own_columns[i].axis)) add_column(s, own_columns[i].name, "1");
    s->n_keys = s->n_columns;
    add_column(s, "status", "1");
    for (size_t i = 0; i < N_OWN; i++)
        if (is_told(s, own_columns[i].axis)) add_column(s, own_columns[i].name, "1");
    s->n_told = s->n_columns - s->n_keys - 1;
    for (int i = 0; i < n_said(s); i++) add_column(s, s->meanings[i].name, s->meanings[i].unit);
    if (s->o->published) add_column(s, s->o->published->header, "1");
}

/* Published numbers are joined by cells that are known before a run. */
static ssfr_result find_joined(sweep *s)
{
    for (int i = 0; s->o->published && i < s->spec->published.n_on; i++) {
        const char *name = s->spec->published.with[i];
        for (s->on[i] = 0; s->on[i] < s->n_keys && !ssfr_csv_is_column(s->columns[s->on[i]], name);) s->on[i]++;
        if (s->on[i] == s->n_keys)
            return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: published: no key %s tells the rows of the sweep apart",
                             s->spec->published.where, name);
    }
    return SSFR_OK;
}

static bool has_column(const sweep *s, const char *name)
{
    bool found = ssfr_sweep_spec_axis(s->spec, name) != NULL;
    for (int i = 0; i < n_said(s); i++) found |= strcmp(s->meanings[i].name, name) == 0;
    for (size_t i = 0; i < N_OWN; i++)
        found |= strcmp(own_columns[i].name, name) == 0 &&
                 (is_key(s, own_columns[i].axis) || is_told(s, own_columns[i].axis));
    return found && strcmp(name, "size") != 0;
}

static ssfr_result check_plot(const sweep *s, const ssfr_plot_spec *p)
{
    const char *names[2 + SSFR_MAX_LINES + SSFR_MAX_ONLY] = {p->x, p->y};
    int n = 2;
    for (int i = 0; i < p->n_lines; i++) names[n++] = p->lines[i];
    for (int i = 0; i < p->n_only; i++) names[n++] = p->only[i].column;
    for (int i = 0; p->x && i < n; i++)
        if (!has_column(s, names[i]))
            return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: plot: the table will have no column %s", p->where, names[i]);
    return SSFR_OK;
}

/* A figure that cannot be drawn must not be found out after the last run. */
static ssfr_result check_figures(const sweep *s)
{
    ssfr_result result = check_plot(s, &s->spec->plot);
    for (int i = 0; i < s->spec->n_curves && result == SSFR_OK; i++) result = check_plot(s, &s->spec->curves[i]);
    return result;
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

static const char *find_published(const sweep *s, const key *k)
{
    const char *cells[SSFR_MAX_ON] = {NULL};
    for (int i = 0; i < s->spec->published.n_on; i++) cells[i] = k->cells[s->on[i]];
    return ssfr_published_find(s->o->published, cells);
}

static ssfr_result write_row(sweep *s, const key *k, const char *status, const ssfr_rig_row *row)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < s->n_keys; i++) SSFR_TRY(ssfr_csv_text(s->csv, k->cells[i]));
    SSFR_TRY(ssfr_csv_text(s->csv, status));
    for (int i = 0; i < s->n_told; i++) SSFR_TRY(ssfr_csv_text(s->csv, k->cells[s->n_keys + i]));
    for (int i = 0; i < SSFR_N_COLUMNS; i++) SSFR_TRY(ssfr_csv_number(s->csv, row->values[i]));
    for (int i = 0; i < SSFR_N_COLUMN_TEXTS; i++) SSFR_TRY(ssfr_csv_text(s->csv, row->texts[i]));
    for (int i = 0; i < s->spec->against.n_added; i++) SSFR_TRY(ssfr_csv_number(s->csv, row->added[i]));
    if (s->o->published) SSFR_TRY(ssfr_csv_text(s->csv, find_published(s, k)));
    SSFR_TRY(ssfr_csv_end_row(s->csv));
end:
    return result;
}

/* A run that fails is a row that says why; one that was asked to stop is none: it is made again. */
static ssfr_result make_row(sweep *s, const size_t index[SSFR_MAX_AXES], const key *k, bool *made)
{
    ssfr_rig_row row;
    char error[SSFR_CAPTURE_SIZE];
    ssfr_capture_begin(s->o->argc ? s->o->argv[0] : "sweep");
    const ssfr_result ran = ssfr_rig_run(s->rig, index, &row);
    ssfr_capture_end(error);
    *made = ran == SSFR_OK || !ssfr_interrupt_came();
    if (!*made) return SSFR_OK;
    s->n_failed += ran != SSFR_OK;
    return write_row(s, k, ran == SSFR_OK ? "ok" : error[0] ? error : ssfr_result_text(ran), &row);
}

/* Makes the runs of this shard that the table lacks, until a signal comes; or counts them all. */
static ssfr_result visit_runs(sweep *s, bool count_only, size_t *n)
{
    ssfr_result result = SSFR_OK;
    const size_t total = *n;
    size_t done = 0;
    for (size_t i = 0; i < s->n_runs && (count_only || !ssfr_interrupt_came()); i++) {
        size_t index[SSFR_MAX_AXES];
        key k;
        if (!in_shard(s, i)) continue;
        ssfr_sweep_spec_run(s->spec, i, index);
        fill_key(s, index, &k);
        if (ssfr_csv_has(s->csv, k.cells)) {
            s->n_there += count_only;
            continue;
        }
        bool made = true;
        if (!count_only) {
            ssfr_console_progress(s->o->what ? s->o->what : "sweep", done, total);
            SSFR_TRY(make_row(s, index, &k, &made));
        }
        done += made;
    }
end:
    if (!count_only) ssfr_console_progress(s->o->what ? s->o->what : "sweep", total, total);
    *n = done;
    return result;
}

/* ---- what a table's rows have in common -------------------------------------------------------------------------- */

static uint64_t hash_settings(uint64_t hash, const ssfr_settings *settings)
{
    for (int i = 0; i < settings->n; i++)
        hash = ssfr_hash_text(ssfr_hash_text(hash, settings->items[i].key), settings->items[i].value);
    return ssfr_hash_text(hash, "");
}

/* Rows tell of a variant and of a view by name and number alone, and of the row that they are held against nothing. */
static uint64_t hash_meanings(uint64_t hash, const ssfr_sweep_spec *spec)
{
    for (int i = 0; i < spec->n_variants; i++) {
        const ssfr_variant *variant = spec->variants[i];
        hash = ssfr_hash_text(hash, variant->name);
        hash = hash_settings(hash_settings(hash, &variant->own), &variant->settings);
    }
    const double path[] = {(double)spec->path.views, spec->path.frames};
    hash = ssfr_hash_bytes(hash, path, sizeof path);
    hash = hash_settings(hash, &spec->against.cells);
    return hash;
}

static uint64_t hash_truth(uint64_t hash, const sweep *s)
{
    const ssfr_truth_params *truth = ssfr_rig_truth(s->rig);
    char name[128], text[256];
    const ssfr_param *row;
    const void *group;
    for (int i = 0; truth && ssfr_truth_key_at(truth, i, name, &row, &group); i++) {
        if (ssfr_sweep_spec_axis(s->spec, name)) continue; /* stands in the rows */
        ssfr_param_format(row, group, text, sizeof text);
        hash = ssfr_hash_text(ssfr_hash_text(hash, name), text);
    }
    return hash;
}

/* Rows measured with other settings, another view, by another build or on other hardware must not stand in one table:
 * its metadata would say of all of them what is true of the last alone. */
static uint64_t identity_of(const sweep *s)
{
    const ssfr_stage_options *v = &s->o->stage;
    const double view[] = {v->radius,    v->unit,      v->time,      v->camera_time, (double)v->frame, v->scale,
                           v->up_axis,   v->fov_deg,   v->eye[0],    v->eye[1],      v->eye[2],        v->target[0],
                           v->target[1], v->target[2], v->up[0],     v->up[1],       v->up[2]};
    char text[128];
    uint64_t hash = hash_settings(hash_settings(ssfr_meta_hash(), &s->spec->settings), &s->spec->reference);
    hash = hash_meanings(hash, s->spec);
    snprintf(text, sizeof text, "%d %d %d %ld %d %d %d", omp_get_max_threads(), s->spec->compared_with,
             SSFR_TRUTH_VERSION, s->o->seed, v->drop_nonfinite, s->o->quick, s->o->no_twin);
    hash = hash_truth(ssfr_hash_text(hash, text), s);
    hash = ssfr_hash_bytes(hash, view, sizeof view);
    if (s->o->published) hash = ssfr_published_hash(s->o->published, hash);
    hash = ssfr_hash_text(ssfr_hash_text(hash, v->camera ? v->camera : ""), v->map ? v->map : "");
    hash = ssfr_hash_text(hash, v->play ? v->play : "");
    return s->gl ? ssfr_hash_text(ssfr_hash_text(hash, ssfr_gl_renderer(s->gl)), ssfr_gl_version(s->gl)) : hash;
}

typedef struct scenes { /* that a sweep shows: of each the first run and a record */
    size_t n;
    size_t (*index)[SSFR_MAX_AXES];
    ssfr_record *records;
} scenes;

static bool is_new_scene(const sweep *s, const scenes *list, const size_t index[SSFR_MAX_AXES])
{
    const char *name = ssfr_sweep_spec_value(s->spec, index, "scene");
    bool found = false;
    for (size_t i = 0; i < list->n && !found; i++)
        found = strcmp(ssfr_sweep_spec_value(s->spec, list->index[i], "scene"), name) == 0;
    return !found;
}

static ssfr_result list_scenes(const sweep *s, scenes *list)
{
    static const char *const keys[] = {"variant", "scene"};
    ssfr_result result = SSFR_OK;
    const ssfr_axis *variants = ssfr_sweep_spec_axis(s->spec, "variant");
    const size_t most = ssfr_sweep_spec_axis(s->spec, "scene")->n * (variants ? variants->n : 1);
    size_t index[SSFR_MAX_AXES] = {0};
    SSFR_TRY(ssfr_alloc(&list->index, most, sizeof *list->index, "the runs of scenes"));
    SSFR_TRY(ssfr_alloc(&list->records, most, sizeof *list->records, "records of scenes"));
    do {
        if (is_new_scene(s, list, index)) memcpy(list->index[list->n++], index, sizeof index);
    } while (ssfr_sweep_spec_next(s->spec, SSFR_COUNT(keys), keys, index));
end:
    return result;
}

static void finish_scenes(scenes *list)
{
    for (size_t i = 0; i < list->n; i++) ssfr_record_finish(&list->records[i]);
    free(list->index);
    free(list->records);
}

/* Loads each scene once before the first run: a file that is malformed is found out, and its content recorded. */
static ssfr_result record_scenes(sweep *s, scenes *list, uint64_t *identity)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(list_scenes(s, list));
    for (size_t i = list->n; i-- > 0 && result == SSFR_OK;) { /* the first is the last: it is the first to be run */
        const ssfr_stage *stage;
        SSFR_TRY(ssfr_rig_stage(s->rig, list->index[i], &stage));
        const uint64_t hash = ssfr_hash_particles(stage->particles);
        *identity = ssfr_hash_bytes(*identity, &hash, sizeof hash);
        SSFR_TRY(ssfr_meta_record_scene(&list->records[i], stage));
    }
end:
    return result;
}

/* What the times of all rows are held against. */
static void measure_copies(sweep *s)
{
    ssfr_rig_options *r = &s->rig_options;
    r->bandwidth_cpu = ssfr_measure_copy_bandwidth(NULL, r->measure.max_seconds);
    if (!s->gl) return;
    r->bandwidth_gl = ssfr_gl_is_software(s->gl) ? r->bandwidth_cpu
                                                 : ssfr_measure_copy_bandwidth(s->gl, r->measure.max_seconds);
}

static ssfr_result save_meta(const sweep *s, const scenes *list, uint64_t identity)
{
    const ssfr_meta meta = {.argc = s->o->argc,
                            .argv = s->o->argv,
                            .seed = s->o->seed,
                            .identity = identity,
                            .gl = s->gl,
                            .pipeline = pipeline_of_first(s),
                            .graph = ssfr_rig_graph(s->rig),
                            .truth = ssfr_rig_truth(s->rig),
                            .spec = s->spec,
                            .scale = ssfr_scale_words[s->o->stage.scale],
                            .n_columns = n_said(s),
                            .columns = s->meanings,
                            .n_scenes = (int)list->n,
                            .scenes = list->records,
                            .bandwidth_gl = s->rig_options.bandwidth_gl,
                            .bandwidth_cpu = s->rig_options.bandwidth_cpu};
    return ssfr_meta_save(s->o->output, &meta);
}

/* An item whose axes have lost values since leaves rows behind, which its claims do not expect. */
static void warn_of_others(const sweep *s)
{
    const size_t n = ssfr_csv_resumed(s->csv);
    if (s->o->what && n > s->n_there)
        ssfr_log(SSFR_WARNING, "%s: rows of runs that its item has no more: %zu; claims count them, --anew leaves them "
                 "out", s->o->output, n - s->n_there);
}

/* *todo is the number of runs to be made: a table that has all stays as it is, with what stands beside it. */
static ssfr_result begin_table(sweep *s, size_t *todo)
{
    ssfr_result result = SSFR_OK;
    scenes list = {0};
    uint64_t identity = identity_of(s);
    SSFR_TRY(record_scenes(s, &list, &identity));
    SSFR_TRY(ssfr_csv_create(&s->csv, s->o->output, s->n_columns, s->columns, s->n_keys, s->o->resume));
    if (s->o->output && ssfr_csv_resumed(s->csv)) SSFR_TRY(ssfr_meta_check(s->o->output, identity));
    SSFR_TRY(visit_runs(s, true, todo));
    warn_of_others(s);
    if (*todo == 0 && ssfr_csv_resumed(s->csv)) goto end;
    measure_copies(s);
    if (s->o->output) SSFR_TRY(save_meta(s, &list, identity));
end:
    finish_scenes(&list);
    return result;
}

/* As papers average over a camera's movement. */
static ssfr_result save_means(const sweep *s)
{
    const char *columns[N_SAID + SSFR_MAX_ADDED + 1];
    int n = 0;
    if (!ssfr_sweep_spec_axis(s->spec, "view")) return SSFR_OK;
    for (int i = 0; i < n_said(s); i++)
        if (i < SSFR_N_COLUMNS || i >= N_SAID) columns[n++] = s->meanings[i].name;
    if (s->o->published) columns[n++] = s->o->published->header;
    return ssfr_means_save(s->o->output, "view", n, columns);
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

static ssfr_result dry_run(sweep *s)
{
    ssfr_result result = SSFR_OK;
    const char *columns[MAX_KEYS]; /* all but the status */
    const int n = s->n_keys + s->n_told;
    for (int i = 0; i < n; i++) columns[i] = s->columns[i < s->n_keys ? i : i + 1];
    SSFR_TRY(ssfr_csv_create(&s->csv, NULL, n, columns, n, false));
    for (size_t i = 0; i < s->n_runs; i++) {
        size_t index[SSFR_MAX_AXES];
        key k;
        if (!in_shard(s, i)) continue;
        ssfr_sweep_spec_run(s->spec, i, index);
        fill_key(s, index, &k);
        for (int c = 0; c < n; c++) SSFR_TRY(ssfr_csv_text(s->csv, k.cells[c]));
        SSFR_TRY(ssfr_csv_end_row(s->csv));
    }
end:
    return result;
}

static bool uses_backend(const ssfr_sweep_spec *spec, const char *name)
{
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, "backend");
    bool found = false;
    for (size_t i = 0; i < axis->n; i++) found |= strcmp(axis->values[i], name) == 0;
    return found;
}

static ssfr_result make_rig(sweep *s)
{
    ssfr_result result = SSFR_OK;
    const bool on_gpu = uses_backend(s->spec, "gl");
    ssfr_rig_options *r = &s->rig_options;
    if (on_gpu) SSFR_TRY(ssfr_gl_create(&s->gl, SSFR_GL_OWN));
    *r = (ssfr_rig_options){.spec = s->spec,
                            .gl = s->gl,
                            .stage = s->o->stage,
                            .measure = ssfr_measure_defaults(s->o->quick),
                            .bandwidth_gl = NAN,
                            .no_twin = s->o->no_twin};
    r->measure.max_seconds = s->o->max_time;
    SSFR_TRY(ssfr_rig_create(&s->rig, r));
end:
    return result;
}

static ssfr_result run(sweep *s)
{
    ssfr_result result = SSFR_OK;
    size_t todo = 0;
    const double begun = ssfr_clock();
    if (s->o->output) SSFR_TRY(ssfr_output_check_file(s->o->output)); /* before scenes are simulated */
    SSFR_TRY(make_rig(s));
    SSFR_TRY(begin_table(s, &todo));
    size_t n = todo;
    ssfr_interrupt_begin(); /* the row in progress is finished, but for a truth that is being cast */
    result = visit_runs(s, false, &n);
    ssfr_interrupt_end();
    if (result != SSFR_OK) goto end;
    ssfr_log(SSFR_INFO, "%zu of %zu runs in %.1f s", n, todo, ssfr_clock() - begun);
    if (s->n_failed) ssfr_log(SSFR_WARNING, "%zu of %zu runs failed: their column status says why", s->n_failed, n);
    if (n < todo)
        result = ssfr_fail(SSFR_ERR_IO, "%s%sinterrupted after %zu of %zu runs%s%s", s->o->what ? s->o->what : "",
                           s->o->what ? ": " : "", n, todo, s->o->output ? "; " : "",
                           s->o->what     ? ssfr_interrupt_advice(!s->o->resume)
                           : s->o->output ? "the same command with --resume goes on from there"
                                          : "");
    if (result == SSFR_OK && s->o->output) SSFR_TRY(save_means(s));
    if (result == SSFR_OK && s->o->output && !s->o->no_plot) SSFR_TRY(ssfr_figures_draw(s->o->output, s->spec));
end:
    return result;
}

/* Everything that can be found out without a scene. */
static ssfr_result prepare(sweep *s)
{
    ssfr_result result = SSFR_OK;
    const ssfr_sweep_spec *spec = s->spec;
    SSFR_TRY(ssfr_rig_check(spec, &s->o->stage));
    SSFR_TRY(ssfr_graph_create(&s->graph, ssfr_pipeline_find(pipeline_of_first(s)), NULL));
    s->group = count_group(s);
    SSFR_TRY(ssfr_sweep_spec_count(spec, &s->n_runs));
    name_columns(s);
    SSFR_TRY(find_joined(s));
    SSFR_TRY(check_figures(s));
end:
    return result;
}

static ssfr_result create(sweep **out, const ssfr_sweep_spec *spec, const ssfr_sweep_options *options)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_alloc(out, 1, sizeof **out, "a sweep"));
    (*out)->spec = spec;
    (*out)->o = options;
    SSFR_TRY(prepare(*out));
end:
    return result;
}

static void destroy(sweep *s)
{
    if (s) {
        ssfr_csv_destroy(&s->csv);
        ssfr_rig_destroy(&s->rig);
        ssfr_gl_destroy(&s->gl);
        ssfr_graph_destroy(&s->graph);
    }
    free(s);
}

ssfr_result ssfr_sweep_check(const ssfr_sweep_spec *spec, const ssfr_sweep_options *options)
{
    sweep *s = NULL;
    const ssfr_result result = create(&s, spec, options);
    destroy(s);
    return result;
}

ssfr_result ssfr_sweep_run(const ssfr_sweep_spec *spec, const ssfr_sweep_options *options)
{
    ssfr_result result = SSFR_OK;
    sweep *s = NULL;
    SSFR_TRY(create(&s, spec, options));
    SSFR_TRY(options->dry_run ? dry_run(s) : run(s));
end:
    destroy(s);
    return result;
}

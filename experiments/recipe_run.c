/* SPDX-License-Identifier: GPL-3.0-or-later */
/* recipe_run.c: running the commands of an item, each once, and keeping a record of what was made. */
#include "experiments/command.h"
#include "experiments/console.h"
#include "experiments/hash.h"
#include "experiments/interrupt.h"
#include "experiments/meta.h"
#include "experiments/options.h"
#include "experiments/output.h"
#include "experiments/recipe.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <omp.h>
#include <unistd.h>

enum { MOST_PATH = 4096, MOST_RECORD = 1 << 20 /* bytes */, MOST_ARGUMENTS = 300 };

typedef struct making {
    const ssfr_recipe *recipe;
    const ssfr_recipe_options *o;
    uint64_t identity;
    char record[MOST_PATH]; /* the path of <item>.made.txt */
    char *made;             /* its text; "" when there is none */
} making;

/* ---- the record: a line of what all has in common, then a line a step, "name: the command" ----------------------- */

static uint64_t identity_of(const ssfr_recipe *recipe, const ssfr_recipe_options *o)
{
    char threads[16];
    snprintf(threads, sizeof threads, "%d", omp_get_max_threads());
    uint64_t hash = ssfr_hash_text(ssfr_hash_text(ssfr_meta_hash(), threads), o->scale);
    for (size_t i = 0; i < recipe->steps.n; i++) {
        const ssfr_step *step = &recipe->steps.items[i];
        hash = ssfr_hash_text(hash, step->name);
        for (int k = 0; k < step->n; k++) hash = ssfr_hash_text(hash, step->words[k]);
    }
    return o->published ? ssfr_published_hash(o->published, hash) : hash;
}

static ssfr_result add_line(const making *m, const char *line)
{
    FILE *file = fopen(m->record, "a");
    if (!file) return ssfr_fail(SSFR_ERR_IO, "%s: %s", m->record, strerror(errno));
    const bool written = fprintf(file, "%s\n", line) > 0;
    if (fclose(file) == 0 && written) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_IO, "%s: %s", m->record, strerror(errno));
}

static ssfr_result begin_record(making *m)
{
    char line[512], processor[256];
    ssfr_meta_processor(processor, sizeof processor);
    snprintf(line, sizeof line, "%016" PRIx64 " ssfr %s, commit %s, %s, %d threads of %s", m->identity, ssfr_version(),
             ssfr_meta_commit(), m->o->scale, omp_get_max_threads(), processor);
    return add_line(m, line);
}

/* A step came to its end: there is a line behind the first. */
static bool holds_steps(const char *made)
{
    const char *first_end = strchr(made, '\n');
    return first_end && first_end[1];
}

/* A record of nothing, of commands that could not run, is begun again. */
static ssfr_result read_record(making *m)
{
    ssfr_result result = SSFR_OK;
    size_t size;
    if (access(m->record, F_OK) == 0)
        SSFR_TRY(ssfr_read_file(m->record, MOST_RECORD, &m->made, &size));
    else
        SSFR_TRY(ssfr_alloc(&m->made, 1, 1, "a record"));
    if (!holds_steps(m->made)) {
        remove(m->record);
        SSFR_TRY(begin_record(m));
    } else if (strtoull(m->made, NULL, 16) != m->identity) {
        result = ssfr_fail(SSFR_ERR_VALUE,
                           "%s: was made by other commands, hardware or another build, at another scale or beside other "
                           "published numbers: nothing to go on with; --anew makes it again",
                           m->record);
    }
end:
    return result;
}

/* A step's line begins with its name. */
static bool is_made(const making *m, const ssfr_step *step, const char *path)
{
    char begin[300];
    snprintf(begin, sizeof begin, "\n%s: ", step->name);
    return strstr(m->made, begin) && access(path, F_OK) == 0;
}

static ssfr_result note(const making *m, const ssfr_step *step)
{
    char line[MOST_PATH];
    size_t used = (size_t)snprintf(line, sizeof line, "%s: ssfr", step->name);
    for (int i = 0; i < step->n && used < sizeof line; i++)
        used += (size_t)snprintf(line + used, sizeof line - used, " %s", step->words[i]);
    return add_line(m, line);
}

/* ---- one step ---------------------------------------------------------------------------------------------------- */

/* What a command prints is for those who call it by itself. Gives the old standard output. */
static int silence(void)
{
    fflush(stdout);
    const int kept = dup(STDOUT_FILENO), nowhere = open("/dev/null", O_WRONLY);
    if (nowhere >= 0) {
        dup2(nowhere, STDOUT_FILENO);
        close(nowhere);
    }
    return kept;
}

static void speak(int kept)
{
    fflush(stdout);
    if (kept < 0) return;
    dup2(kept, STDOUT_FILENO);
    close(kept);
}

/* A command has said itself why it failed, but for one that holds things to what they should be. */
static ssfr_result run_command(const ssfr_step *step, char *output)
{
    char *argv[MOST_ARGUMENTS] = {NULL}, flag[] = "-o";
    int argc = 0;
    const ssfr_manner manner = ssfr_options_manner();
    const int kept = silence();
    for (; argc < step->n; argc++) argv[argc] = step->words[argc];
    argv[argc++] = flag;
    argv[argc++] = output;
    const int status = ssfr_command_find(step->words[0])->run(argc, argv);
    ssfr_options_resume(&manner);
    speak(kept);
    if (status == SSFR_EXIT_FAILED)
        return ssfr_fail(SSFR_ERR_VALUE, "ssfr %s: what it checks does not hold", step->words[0]);
    return status == SSFR_EXIT_OK ? SSFR_OK : SSFR_ERR_VALUE;
}

/* ---- the paper's numbers beside ---------------------------------------------------------------------------------- */

static ssfr_result find_columns(const ssfr_published *p, const ssfr_csv_table *table, const char *path, int *on)
{
    for (int i = 0; i < p->spec->n_on; i++) {
        on[i] = ssfr_csv_column(table, p->spec->with[i]);
        if (on[i] < 0)
            return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: published: %s has no column %s", p->spec->where, path,
                             p->spec->with[i]);
    }
    return SSFR_OK;
}

static ssfr_result write_rows(ssfr_csv *csv, const ssfr_csv_table *table, const ssfr_published *p, const int *on)
{
    ssfr_result result = SSFR_OK;
    for (size_t row = 0; row < table->n_rows; row++) {
        const char *cells[SSFR_MAX_ON];
        for (int i = 0; i < p->spec->n_on; i++) cells[i] = ssfr_csv_cell(table, row, on[i]);
        for (int i = 0; i < table->n_columns; i++) SSFR_TRY(ssfr_csv_text(csv, ssfr_csv_cell(table, row, i)));
        SSFR_TRY(ssfr_csv_text(csv, ssfr_published_find(p, cells)));
        SSFR_TRY(ssfr_csv_end_row(csv));
    }
end:
    return result;
}

/* As the last column of the table that the command left. */
static ssfr_result add_published(const char *path, const ssfr_published *p)
{
    ssfr_result result = SSFR_OK;
    ssfr_csv_table *table = NULL;
    ssfr_csv *csv = NULL;
    ssfr_aside aside = {0};
    const char **columns = NULL;
    int on[SSFR_MAX_ON];
    SSFR_TRY(ssfr_csv_load(&table, path));
    SSFR_TRY(find_columns(p, table, path, on));
    SSFR_TRY(ssfr_alloc(&columns, (size_t)table->n_columns + 1, sizeof *columns, "columns"));
    for (int i = 0; i < table->n_columns; i++) columns[i] = table->cells[i];
    columns[table->n_columns] = p->header;
    SSFR_TRY(ssfr_aside_begin(&aside, path));
    SSFR_TRY(ssfr_csv_create(&csv, aside.temporary, table->n_columns + 1, columns, 1, false));
    SSFR_TRY(write_rows(csv, table, p, on));
end:
    ssfr_csv_destroy(&csv);
    result = ssfr_aside_end(&aside, result);
    ssfr_csv_table_destroy(&table);
    free(columns);
    return result;
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

static void name_output(const making *m, const ssfr_step *step, char path[MOST_PATH])
{
    snprintf(path, MOST_PATH, m->recipe->pictures ? "%s/%s.png" : "%s%s.csv", m->o->item, step->name);
}

static ssfr_result run_step(const making *m, const ssfr_step *step)
{
    ssfr_result result = SSFR_OK;
    char path[MOST_PATH];
    name_output(m, step, path);
    if (is_made(m, step, path)) return SSFR_OK;
    SSFR_TRY(run_command(step, path));
    if (access(path, F_OK) != 0)
        return ssfr_fail(SSFR_ERR_VALUE, "ssfr %s: left no %s", step->words[0], path);
    if (m->o->published) SSFR_TRY(add_published(path, m->o->published));
    SSFR_TRY(note(m, step));
end:
    return result;
}

/* So that a command that goes on with its table begins anew, too. */
static void forget(const making *m)
{
    char path[MOST_PATH];
    remove(m->record);
    for (size_t i = 0; i < m->recipe->steps.n; i++) {
        name_output(m, &m->recipe->steps.items[i], path);
        remove(path);
    }
}

static ssfr_result run_steps(const making *m)
{
    ssfr_result result = SSFR_OK;
    const size_t n = m->recipe->steps.n;
    size_t done = 0;
    for (; done < n && !ssfr_interrupt_came(); done++) {
        ssfr_console_progress(m->o->what, done, n);
        SSFR_TRY(run_step(m, &m->recipe->steps.items[done]));
    }
    if (done < n)
        result = ssfr_fail(SSFR_ERR_IO, "%s: interrupted after %zu of %zu; %s", m->o->what, done, n,
                           ssfr_interrupt_advice(m->o->anew));
end:
    ssfr_console_progress(m->o->what, n, n);
    return result;
}

ssfr_result ssfr_recipe_run(const ssfr_recipe *recipe, const ssfr_recipe_options *options)
{
    ssfr_result result = SSFR_OK;
    making m = {.recipe = recipe, .o = options, .identity = identity_of(recipe, options)};
    snprintf(m.record, sizeof m.record, "%s.made.txt", options->item);
    if (options->anew) forget(&m);
    SSFR_TRY(read_record(&m));
    if (recipe->pictures) SSFR_TRY(ssfr_output_make_folder(options->item));
    SSFR_TRY(run_steps(&m));
end:
    free(m.made);
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_reproduce.c: `ssfr reproduce`: the tables of papers, with their own numbers beside, and what they claim. */
#include "experiments/claims.h"
#include "experiments/command.h"
#include "experiments/console.h"
#include "experiments/figures.h"
#include "experiments/interrupt.h"
#include "experiments/options.h"
#include "experiments/output.h"
#include "experiments/papers.h"
#include "experiments/recipe.h"
#include "experiments/scenes/make.h"
#include "experiments/sweep.h"

#include <unistd.h>

enum { MOST_PATH = 4096 };

typedef struct reproduce_words {
    const char *output;
    int scale; /* ssfr_scale */
    double max_time;
    bool list, claims, figures, anew;
} reproduce_words;

#define ROW(...) SSFR_OPTION(reproduce_words, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(scale, "scale", 0, WORD, "quick|full",
        "quick (default): a sixteenth of the particles of described scenes, half the width and height, 3 runs a row", 0,
        0),
    ROW(output, "output", 'o', TEXT, "DIR",
        "where tables go (default results): DIR/PAPER/ITEM.csv, .meta.json and .svg, pictures to DIR/PAPER/ITEM/, and "
        "DIR/claims.csv", 0, 0),
    ROW(anew, "anew", 0, FLAG, NULL, "measure anew: rows that are there do not stay", 0, 0),
    ROW(claims, "claims", 0, FLAG, NULL, "measure nothing: hold the tables that are there to the claims", 0, 0),
    ROW(figures, "figures", 0, FLAG, NULL, "measure nothing: draw the figures of the sweeps that are there again", 0,
        0),
    ROW(list, "list", 0, FLAG, NULL, "list papers, items, titles and numbers of runs, and leave", 0, 0),
    ROW(max_time, "max-time", 0, NUMBER, "S", "cap the timed frames of a row, s; one is always timed", 1e-3, 1e6),
    SSFR_OPTION_END,
};

typedef struct item { /* one that was chosen, read and checked */
    const ssfr_paper *paper;
    char *name; /* "paper/item" */
    const char *item;
    ssfr_sweep_spec *spec; /* of a sweep, */
    ssfr_recipe *recipe;   /* or of other commands; the other is NULL */
    ssfr_published *published; /* NULL for none */
} item;

typedef struct reproduction {
    const reproduce_words *words;
    ssfr_papers *papers;
    size_t n_items;
    item *items;          /* those of a paper follow each other */
    ssfr_claims **claims; /* of each paper; NULL where it was not chosen */
    ssfr_sweep_options options;
} reproduction;

/* ---- reading: everything that was chosen, before anything is run ------------------------------------------------- */

static ssfr_result read_published(reproduction *r, item *it)
{
    ssfr_result result = SSFR_OK;
    const ssfr_published_spec *spec = it->spec ? &it->spec->published : &it->recipe->published;
    char path[SSFR_PAPER_PATH], name[SSFR_PAPER_PATH], *text = NULL;
    size_t size;
    if (!spec->file) return SSFR_OK;
    snprintf(name, sizeof name, "published/%s", spec->file);
    ssfr_papers_path(r->papers, it->paper->name, name, path);
    SSFR_TRY(ssfr_papers_read(r->papers, it->paper->name, name, &text, &size));
    SSFR_TRY(ssfr_published_parse(&it->published, spec, path, text, size));
end:
    free(text);
    return result;
}

/* As rules name its table. */
static ssfr_result check_name(const item *it, const char *path)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
    if (it->item[strspn(it->item, letters)] == '\0' && !strchr("0123456789", it->item[0])) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_VALUE, "%s: an item's name is letters, digits and _, and begins with no digit", path);
}

static ssfr_result name_item(item *it)
{
    return ssfr_text_print(&it->name, "a name", "%s/%s", it->paper->name, it->item);
}

static ssfr_result read_sweep(const reproduction *r, item *it, const char *path, const char *text, size_t size)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_sweep_spec_parse(&it->spec, path, text, size));
    SSFR_TRY(ssfr_sweep_spec_complete(it->spec));
    if (r->words->scale == SSFR_SCALE_QUICK) SSFR_TRY(ssfr_sweep_spec_quicken(it->spec));
end:
    return result;
}

static ssfr_result read_item(reproduction *r, item *it)
{
    ssfr_result result = SSFR_OK;
    char path[SSFR_PAPER_PATH], name[SSFR_PAPER_PATH], *text = NULL;
    size_t size;
    SSFR_TRY(name_item(it));
    snprintf(name, sizeof name, "%s.yaml", it->item);
    ssfr_papers_path(r->papers, it->paper->name, name, path);
    SSFR_TRY(check_name(it, path));
    SSFR_TRY(ssfr_papers_read(r->papers, it->paper->name, name, &text, &size));
    SSFR_TRY(ssfr_recipe_parse(&it->recipe, path, text, size));
    if (!it->recipe) SSFR_TRY(read_sweep(r, it, path, text, size));
    if (it->recipe && r->words->scale == SSFR_SCALE_QUICK) ssfr_recipe_quicken(it->recipe);
    SSFR_TRY(read_published(r, it));
end:
    free(text);
    return result;
}

static ssfr_result read_claims(reproduction *r, size_t paper)
{
    ssfr_result result = SSFR_OK;
    const char *name = r->papers->papers[paper].name;
    char path[SSFR_PAPER_PATH], *text = NULL;
    size_t size;
    ssfr_papers_path(r->papers, name, "claims.yaml", path);
    SSFR_TRY(ssfr_papers_read(r->papers, name, "claims.yaml", &text, &size));
    SSFR_TRY(ssfr_claims_parse(&r->claims[paper], name, path, text, size));
end:
    free(text);
    return result;
}

static ssfr_result check_item(const reproduction *r, const item *it)
{
    ssfr_sweep_options options = r->options;
    options.published = it->published;
    return it->spec ? ssfr_sweep_check(it->spec, &options) : SSFR_OK;
}

/* ---- choosing ---------------------------------------------------------------------------------------------------- */

static bool names_paper(const char *argument, const ssfr_paper *paper)
{
    const size_t length = strcspn(argument, "/");
    return strlen(paper->name) == length && strncmp(argument, paper->name, length) == 0;
}

/* "paper" chooses all its items. */
static bool chooses(const char *argument, const ssfr_paper *paper, const char *item)
{
    const size_t length = strcspn(argument, "/");
    return names_paper(argument, paper) && (!argument[length] || strcmp(argument + length + 1, item) == 0);
}

static bool is_chosen(const ssfr_list *arguments, const ssfr_paper *paper, const char *item)
{
    bool chosen = arguments->n == 0;
    for (int i = 0; i < arguments->n && !chosen; i++)
        chosen = item ? chooses(arguments->items[i], paper, item) : names_paper(arguments->items[i], paper);
    return chosen;
}

static ssfr_result check_argument(const ssfr_papers *papers, const char *argument)
{
    char list[600] = "";
    size_t used = 0;
    const ssfr_paper *paper = NULL;
    for (size_t i = 0; i < papers->n; i++) {
        if (names_paper(argument, &papers->papers[i])) paper = &papers->papers[i];
        ssfr_list_name(list, sizeof list, &used, papers->papers[i].name);
    }
    if (!paper) return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no such paper; there are %s", argument, list);
    if (!strchr(argument, '/')) return SSFR_OK;
    list[0] = '\0', used = 0;
    for (size_t i = 0; i < paper->n_items; i++) {
        if (chooses(argument, paper, paper->items[i])) return SSFR_OK;
        ssfr_list_name(list, sizeof list, &used, paper->items[i]);
    }
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no such item; %s has %s", argument, paper->name, used ? list : "none");
}

static ssfr_result read_paper(reproduction *r, const ssfr_list *arguments, size_t index)
{
    ssfr_result result = SSFR_OK;
    const ssfr_paper *paper = &r->papers->papers[index];
    SSFR_TRY(read_claims(r, index));
    for (size_t i = 0; i < paper->n_items; i++) {
        if (!is_chosen(arguments, paper, paper->items[i])) continue;
        item *it = &r->items[r->n_items++];
        it->paper = paper, it->item = paper->items[i];
        SSFR_TRY(read_item(r, it));
        SSFR_TRY(check_item(r, it));
    }
end:
    return result;
}

static ssfr_result choose(reproduction *r, const ssfr_list *arguments)
{
    ssfr_result result = SSFR_OK;
    size_t n = 0;
    for (int i = 0; i < arguments->n; i++) SSFR_TRY(check_argument(r->papers, arguments->items[i]));
    for (size_t i = 0; i < r->papers->n; i++) n += r->papers->papers[i].n_items;
    SSFR_TRY(ssfr_alloc(&r->items, n, sizeof *r->items, "items"));
    SSFR_TRY(ssfr_alloc(&r->claims, r->papers->n, sizeof(ssfr_claims *), "claims"));
    for (size_t i = 0; i < r->papers->n; i++)
        if (is_chosen(arguments, &r->papers->papers[i], NULL)) SSFR_TRY(read_paper(r, arguments, i));
end:
    return result;
}

/* ---- running ----------------------------------------------------------------------------------------------------- */

static ssfr_result make_folders(const reproduction *r, const char *paper)
{
    ssfr_result result = SSFR_OK;
    char path[MOST_PATH];
    SSFR_TRY(ssfr_output_make_folder(r->words->output));
    snprintf(path, sizeof path, "%s/%s", r->words->output, paper);
    SSFR_TRY(ssfr_output_make_folder(path));
end:
    return result;
}

static ssfr_result run_sweep(const reproduction *r, const item *it, const char *base, const char *what)
{
    char path[MOST_PATH];
    ssfr_sweep_options options = r->options;
    snprintf(path, sizeof path, "%s.csv", base);
    options.output = path, options.what = what, options.published = it->published;
    return ssfr_sweep_run(it->spec, &options);
}

static ssfr_result run_recipe(const reproduction *r, const item *it, const char *base, const char *what)
{
    const ssfr_recipe_options options = {.item = base,
                                         .what = what,
                                         .scale = ssfr_scale_words[r->words->scale],
                                         .published = it->published,
                                         .anew = r->words->anew};
    return ssfr_recipe_run(it->recipe, &options);
}

/* Those of a sweep whose table is there; other commands draw theirs when they make the table. */
static ssfr_result draw_item(const reproduction *r, const item *it)
{
    char path[MOST_PATH];
    snprintf(path, sizeof path, "%s/%s.csv", r->words->output, it->name);
    return it->spec && access(path, F_OK) == 0 ? ssfr_figures_draw(path, it->spec) : SSFR_OK;
}

static ssfr_result run_item(const reproduction *r, size_t i)
{
    ssfr_result result = SSFR_OK;
    const item *it = &r->items[i];
    char base[MOST_PATH - 16], what[256];
    snprintf(base, sizeof base, "%s/%s", r->words->output, it->name);
    snprintf(what, sizeof what, "%s, %zu of %zu", it->name, i + 1, r->n_items);
    SSFR_TRY(make_folders(r, it->paper->name));
    SSFR_TRY(it->spec ? run_sweep(r, it, base, what) : run_recipe(r, it, base, what));
    if (ssfr_interrupt_came() && i + 1 < r->n_items)
        result = ssfr_fail(SSFR_ERR_IO, "interrupted after %zu of %zu items; %s", i + 1, r->n_items,
                           ssfr_interrupt_advice(r->words->anew));
end:
    return result;
}

static ssfr_result add_claims(ssfr_table *table, const ssfr_claims *claims)
{
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < claims->n; i++) {
        const ssfr_claim *c = &claims->claims[i];
        const bool measured = c->verdict.measured;
        char value[32] = "-";
        if (measured) snprintf(value, sizeof value, "%.4g", c->verdict.left);
        SSFR_TRY(ssfr_table_row(table, (const char *[]){claims->paper, c->id, c->published ? c->published : "-", value,
                                                        ssfr_claim_holds(c), measured ? c->rule : c->verdict.why}));
    }
end:
    return result;
}

/* Once all items of a paper are run, so that what was done of others stays when a later one cannot run. */
static ssfr_result judge(const reproduction *r, size_t paper, ssfr_table *table)
{
    ssfr_result result = SSFR_OK;
    ssfr_claims *claims = r->claims[paper];
    if (!claims) return SSFR_OK;
    SSFR_TRY(ssfr_claims_judge(claims, r->words->output));
    SSFR_TRY(ssfr_output_make_folder(r->words->output));
    SSFR_TRY(ssfr_claims_save(claims, r->words->output));
    SSFR_TRY(add_claims(table, claims));
end:
    return result;
}

static ssfr_result run_papers(const reproduction *r, ssfr_table *table)
{
    ssfr_result result = SSFR_OK;
    size_t i = 0;
    for (size_t paper = 0; paper < r->papers->n; paper++) {
        for (; i < r->n_items && r->items[i].paper == &r->papers->papers[paper]; i++)
            if (r->words->figures)
                SSFR_TRY(draw_item(r, &r->items[i]));
            else if (!r->words->claims)
                SSFR_TRY(run_item(r, i));
        SSFR_TRY(judge(r, paper, table));
    }
end:
    return result;
}

static ssfr_result run(const reproduction *r)
{
    static const char *const head[] = {"paper", "claim", "published", "measured", "holds", "rule"};
    ssfr_result result = SSFR_OK;
    ssfr_table table;
    ssfr_table_init(&table, SSFR_COUNT(head));
    SSFR_TRY(ssfr_table_row(&table, head));
    ssfr_interrupt_begin();
    result = run_papers(r, &table);
    ssfr_interrupt_end();
    if (result == SSFR_OK) ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    return result;
}

static ssfr_result list(const reproduction *r)
{
    static const char *const head[] = {"paper", "item", "title", "runs"};
    ssfr_result result = SSFR_OK;
    ssfr_table table;
    ssfr_table_init(&table, SSFR_COUNT(head));
    SSFR_TRY(ssfr_table_row(&table, head));
    for (size_t i = 0; i < r->n_items; i++) {
        const item *it = &r->items[i];
        const char *title = it->spec ? it->spec->title : it->recipe->title;
        size_t n = 0;
        if (it->spec)
            SSFR_TRY(ssfr_sweep_spec_count(it->spec, &n));
        else
            n = it->recipe->steps.n;
        SSFR_TRY(ssfr_table_add(&table, "%s", it->paper->name));
        SSFR_TRY(ssfr_table_add(&table, "%s", it->item));
        SSFR_TRY(ssfr_table_add(&table, "%s", title ? title : ""));
        SSFR_TRY(ssfr_table_add(&table, "%zu", n));
    }
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    return result;
}

/* ---- the command ------------------------------------------------------------------------------------------------- */

static void finish(reproduction *r)
{
    for (size_t i = 0; i < r->n_items; i++) {
        ssfr_published_destroy(&r->items[i].published);
        ssfr_sweep_spec_destroy(&r->items[i].spec);
        ssfr_recipe_destroy(&r->items[i].recipe);
        free(r->items[i].name);
    }
    for (size_t i = 0; r->claims && i < r->papers->n; i++) ssfr_claims_destroy(&r->claims[i]);
    free(r->items);
    free(r->claims);
    ssfr_papers_destroy(&r->papers);
}

static void set_options(reproduction *r, const ssfr_command_line *line, int argc, char **argv)
{
    ssfr_sweep_options *o = &r->options;
    *o = (ssfr_sweep_options){.resume = !r->words->anew,
                              .quick = r->words->scale == SSFR_SCALE_QUICK,
                              .max_time = r->words->max_time,
                              .shard = 1,
                              .shards = 1,
                              .argc = argc,
                              .argv = argv,
                              .seed = line->seed};
    ssfr_stage_defaults(&o->stage);
    o->stage.scale = r->words->scale;
    o->stage.seed = (uint64_t)line->seed;
}

int ssfr_cmd_reproduce(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    reproduce_words words = {.output = "results", .scale = SSFR_SCALE_QUICK};
    reproduction r = {.words = &words};
    ssfr_command_line line;
    const ssfr_option_set sets[] = {{"reproduce", rows, &words}, {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0],
        .arguments = "[PAPER[/ITEM] ...]",
        .max_arguments = SSFR_MAX_LIST,
        .sets = sets,
        .help = "Measures the tables of papers, all unless some are named, and holds them to what the papers claim. "
                "What was stopped goes on by the same command."};
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    set_options(&r, &line, argc, argv);
    SSFR_TRY(ssfr_papers_create(&r.papers));
    SSFR_TRY(choose(&r, &line.arguments));
    SSFR_TRY(words.list ? list(&r) : run(&r));
end:
    finish(&r);
    return ssfr_exit_status(result);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_switches.c: every word of every switch of a reproduced pipeline stands in a sweep of its paper. */
#include "experiments/papers.h"
#include "experiments/recipe.h"
#include "experiments/sweep_spec.h"
#include "tests/frames.h"

enum { MAX_ITEMS = 64 };

typedef struct item_sweeps {
    size_t n;
    ssfr_sweep_spec *specs[MAX_ITEMS];
} item_sweeps;

static const ssfr_paper *find_paper(const ssfr_papers *papers, const char *name)
{
    const ssfr_paper *found = NULL;
    for (size_t i = 0; i < papers->n; i++)
        if (strcmp(papers->papers[i].name, name) == 0) found = &papers->papers[i];
    assert_non_null(found);
    return found;
}

/* All items of a paper but those that are other commands. */
static item_sweeps load(const char *name)
{
    item_sweeps sweeps = {0};
    ssfr_papers *papers = NULL;
    assert_int_equal(ssfr_papers_create(&papers), SSFR_OK);
    const ssfr_paper *paper = find_paper(papers, name);
    assert_true(paper->n_items <= MAX_ITEMS);
    for (size_t i = 0; i < paper->n_items; i++) {
        char file[SSFR_PAPER_PATH], path[SSFR_PAPER_PATH], *text = NULL;
        size_t size;
        ssfr_recipe *recipe = NULL;
        snprintf(file, sizeof file, "%s.yaml", paper->items[i]);
        ssfr_papers_path(papers, name, file, path);
        assert_int_equal(ssfr_papers_read(papers, name, file, &text, &size), SSFR_OK);
        assert_int_equal(ssfr_recipe_parse(&recipe, path, text, size), SSFR_OK);
        if (!recipe) assert_int_equal(ssfr_sweep_spec_parse(&sweeps.specs[sweeps.n++], path, text, size), SSFR_OK);
        ssfr_recipe_destroy(&recipe);
        free(text);
    }
    ssfr_papers_destroy(&papers);
    return sweeps;
}

/* Whether a value of a switch has the word; that of a set has several, with commas between. */
static bool has_word(const char *value, const char *word)
{
    const size_t length = strlen(word);
    bool found = false;
    for (const char *at = strstr(value, word); at && !found; at = strstr(at + 1, word))
        found = (at == value || at[-1] == ',') && (at[length] == '\0' || at[length] == ',');
    return found;
}

static bool has_setting(const ssfr_settings *settings, const char *key, const char *word)
{
    bool found = false;
    for (int i = 0; i < settings->n && !found; i++)
        found = strcmp(settings->items[i].key, key) == 0 && has_word(settings->items[i].value, word);
    return found;
}

static bool is_run(const ssfr_sweep_spec *spec, const char *key, const char *word)
{
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, key);
    bool found = has_setting(&spec->settings, key, word);
    for (int i = 0; i < spec->n_variants && !found; i++) found = has_setting(&spec->variants[i]->settings, key, word);
    for (size_t i = 0; axis && i < axis->n && !found; i++) found = has_word(axis->values[i], word);
    return found;
}

static void assert_measured(const item_sweeps *sweeps, const ssfr_graph *graph, const char *key, const char *word)
{
    char usual[64];
    assert_int_equal(ssfr_graph_get(graph, key, usual, sizeof usual), SSFR_OK);
    bool found = strcmp(usual, word) == 0;
    for (size_t i = 0; i < sweeps->n && !found; i++) found = is_run(sweeps->specs[i], key, word);
    if (!found) fail_msg("no sweep has %s=%s", key, word);
}

static bool is_of_group(const char *key)
{
    bool found = false;
    for (int i = 0; ssfr_group_at(i, &(const ssfr_param *){NULL}); i++) {
        const char *group = ssfr_group_at(i, &(const ssfr_param *){NULL});
        found |= strncmp(key, group, strlen(group)) == 0 && key[strlen(group)] == '.';
    }
    return found;
}

/* Approximations and errata are choices, flags and sets; what else is a number. */
static void every_switch_of_bagar2010_is_measured(void **state)
{
    (void)state;
    static const char *const flag[] = {"0", "1", NULL};
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("bagar2010"), NULL);
    item_sweeps sweeps = load("bagar2010");
    int n_words = 0;
    for (int i = 0; ssfr_graph_key_at(graph, i); i++) {
        const char *key = ssfr_graph_key_at(graph, i);
        const ssfr_param *row = ssfr_graph_row(graph, key);
        const bool is_switch = row->type == SSFR_CHOICE || row->type == SSFR_FLAG || row->type == SSFR_SET;
        if (!is_switch || is_of_group(key) || strcmp(row->name, "off") == 0) continue;
        for (const char *const *word = row->type == SSFR_FLAG ? flag : row->words; *word; word++, n_words++)
            assert_measured(&sweeps, graph, key, *word);
    }
    assert_true(n_words > 100);
    for (size_t i = 0; i < sweeps.n; i++) ssfr_sweep_spec_destroy(&sweeps.specs[i]);
    ssfr_graph_destroy(&graph);
}

static void a_word_of_a_set_is_whole(void **state)
{
    (void)state;
    assert_true(has_word("B10", "B10") && has_word("B10,B36", "B36") && has_word("B2,B28", "B28"));
    assert_false(has_word("B28", "B2") || has_word("B10,B36", "B3") || has_word("", "B1"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_switch_of_bagar2010_is_measured),
        cmocka_unit_test(a_word_of_a_set_is_whole),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

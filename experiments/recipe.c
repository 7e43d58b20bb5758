/* SPDX-License-Identifier: GPL-3.0-or-later */
/* recipe.c: reading which commands make an item of a paper, with file, line and column in every error. */
#include "experiments/recipe.h"
#include "experiments/command.h"
#include "experiments/sweep_spec_internal.h"

enum { MOST_STEPS = 256, MOST_WORDS = 256 /* of a step */ };
static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";

/* ---- the object -------------------------------------------------------------------------------------------------- */

static void finish_steps(ssfr_steps *steps)
{
    for (size_t i = 0; i < steps->n; i++) {
        for (int k = 0; k < steps->items[i].n; k++) free(steps->items[i].words[k]);
        free(steps->items[i].words);
        free(steps->items[i].name);
    }
    free(steps->items);
    *steps = (ssfr_steps){0};
}

void ssfr_recipe_destroy(ssfr_recipe **recipe)
{
    ssfr_recipe *r = *recipe;
    if (!r) return;
    finish_steps(&r->steps);
    ssfr_published_spec_finish(&r->published);
    ssfr_recipe_destroy(&r->quick);
    free(r->title);
    free(r);
    *recipe = NULL;
}

void ssfr_recipe_quicken(ssfr_recipe *recipe)
{
    ssfr_recipe *quick = recipe->quick;
    if (quick && quick->title) {
        free(recipe->title);
        recipe->title = quick->title;
        quick->title = NULL;
    }
    if (quick && quick->steps.n > 0) {
        finish_steps(&recipe->steps);
        recipe->steps = quick->steps;
        quick->steps = (ssfr_steps){0};
    }
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static bool is_output(const char *word)
{
    return strncmp(word, "-o", 2) == 0 || strncmp(word, "--output", 8) == 0;
}

/* Adds the words of a list behind those that the step has. */
static ssfr_result read_words(const ssfr_yaml_node *node, ssfr_step *step)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_LIST));
    if (node->n == 0 || node->n > (size_t)(MOST_WORDS - step->n))
        return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%s: expected 1 to %d words", node->name, MOST_WORDS);
    for (size_t i = 0; i < node->n; i++) {
        const ssfr_yaml_node *word = node->values[i];
        SSFR_TRY(ssfr_yaml_expect(word, SSFR_YAML_TEXT));
        if (is_output(word->text))
            return ssfr_yaml_fail(word, SSFR_ERR_VALUE, "%s: %.40s: where it goes is not its own to say", node->name,
                                  word->text);
        SSFR_TRY(ssfr_yaml_copy(&step->words[step->n], "", word->text));
        step->n++;
    }
end:
    return result;
}

static ssfr_result new_steps(ssfr_recipe *recipe, const ssfr_yaml_node *node, size_t n)
{
    if (recipe->steps.n > 0)
        return ssfr_yaml_fail(node->key, SSFR_ERR_FORMAT, "command and pictures: an item has one of the two");
    return ssfr_alloc(&recipe->steps.items, n, sizeof *recipe->steps.items, "steps");
}

static ssfr_result init_step(ssfr_step *step, const char *name)
{
    ssfr_result result = ssfr_yaml_copy(&step->name, "", name);
    if (result == SSFR_OK) result = ssfr_alloc(&step->words, MOST_WORDS, sizeof *step->words, "words");
    return result;
}

static ssfr_result read_command(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_recipe *recipe = to;
    (void)row;
    SSFR_TRY(new_steps(recipe, node, 1));
    ssfr_step *step = &recipe->steps.items[recipe->steps.n++];
    SSFR_TRY(init_step(step, ""));
    SSFR_TRY(read_words(node, step));
    const bool item = strcmp(step->words[0], "sweep") == 0 || strcmp(step->words[0], "reproduce") == 0;
    if (item || !ssfr_command_find(step->words[0]))
        result = ssfr_yaml_fail(node->values[0], SSFR_ERR_UNKNOWN, "command: %.40s: %s", step->words[0],
                                item ? "a sweep is an item by itself" : "there is no such command");
end:
    return result;
}

typedef struct entry { /* of a picture */
    char *name;
    const ssfr_yaml_node *args;
} entry;

static ssfr_result check_name(const ssfr_recipe *recipe, const ssfr_yaml_node *node, const char *name)
{
    if (!name[0] || name[strspn(name, letters)])
        return ssfr_yaml_fail(node, SSFR_ERR_VALUE, "name: %.40s: expected letters, digits and _", name);
    for (size_t i = 0; i < recipe->steps.n; i++)
        if (strcmp(recipe->steps.items[i].name, name) == 0)
            return ssfr_yaml_fail(node, SSFR_ERR_VALUE, "the name %.40s stands twice", name);
    return SSFR_OK;
}

static ssfr_result read_picture(ssfr_recipe *recipe, const ssfr_yaml_node *node)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("name", ssfr_yaml_read_text, entry, name, .needed = true),
        SSFR_YAML_ROW("args", ssfr_yaml_read_node, entry, args, .needed = true),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    entry e = {0};
    SSFR_TRY(ssfr_yaml_read_map(node, rows, &e));
    SSFR_TRY(check_name(recipe, node, e.name));
    ssfr_step *step = &recipe->steps.items[recipe->steps.n++];
    SSFR_TRY(init_step(step, e.name));
    SSFR_TRY(ssfr_yaml_copy(&step->words[0], "", "render"));
    step->n = 1;
    SSFR_TRY(read_words(e.args, step));
end:
    free(e.name);
    return result;
}

static ssfr_result read_pictures(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_recipe *recipe = to;
    (void)row;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_LIST));
    if (node->n == 0 || node->n > MOST_STEPS)
        return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%s: expected 1 to %d pictures", node->name, MOST_STEPS);
    SSFR_TRY(new_steps(recipe, node, node->n));
    recipe->pictures = true;
    for (size_t i = 0; i < node->n; i++) SSFR_TRY(read_picture(recipe, node->values[i]));
end:
    return result;
}

/* Is read when all steps are known. */
static ssfr_result leave_args(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    (void)node, (void)row, (void)to;
    return SSFR_OK;
}

static ssfr_result read_quick(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("title", ssfr_yaml_read_text, ssfr_recipe, title),
        SSFR_YAML_ROW_ALL("command", read_command),
        SSFR_YAML_ROW_ALL("pictures", read_pictures),
        SSFR_YAML_ROW_ALL("args", leave_args),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    ssfr_recipe *recipe = to;
    (void)row;
    SSFR_TRY(ssfr_alloc(&recipe->quick, 1, sizeof *recipe->quick, "a recipe"));
    SSFR_TRY(ssfr_yaml_read_map(node, rows, recipe->quick));
end:
    return result;
}

static ssfr_result add_args(ssfr_recipe *recipe, const ssfr_yaml_node *args)
{
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; args && i < recipe->steps.n; i++) SSFR_TRY(read_words(args, &recipe->steps.items[i]));
end:
    return result;
}

/* What all steps have behind their own words; at quick scale others, if it has some, behind the same. */
static ssfr_result share_args(ssfr_recipe *recipe, const ssfr_yaml_node *root)
{
    ssfr_result result = SSFR_OK;
    const ssfr_yaml_node *args = ssfr_yaml_find(root, "args"), *command = ssfr_yaml_find(root, "command");
    const ssfr_yaml_node *own = recipe->quick ? ssfr_yaml_find(ssfr_yaml_find(root, "quick"), "args") : NULL;
    ssfr_recipe *quick = recipe->quick;
    if (own && quick->steps.n == 0)
        SSFR_TRY(command ? read_command(command, NULL, quick)
                         : read_pictures(ssfr_yaml_find(root, "pictures"), NULL, quick));
    SSFR_TRY(add_args(recipe, args));
    if (quick) SSFR_TRY(add_args(quick, own ? own : args));
end:
    return result;
}

/* Pictures have no table that numbers could stand in, and at quick scale an item is of the same kind. */
static ssfr_result check_kind(const ssfr_recipe *recipe, const ssfr_yaml_node *root)
{
    const ssfr_recipe *quick = recipe->quick;
    if (recipe->pictures && recipe->published.file)
        return ssfr_yaml_fail(ssfr_yaml_find(root, "published")->key, SSFR_ERR_FORMAT, "published: beside pictures");
    if (quick && quick->steps.n > 0 && quick->pictures != recipe->pictures)
        return ssfr_yaml_fail(ssfr_yaml_find(root, "quick")->key, SSFR_ERR_FORMAT,
                              "quick: an item is a command or pictures at both scales");
    return SSFR_OK;
}

static ssfr_result read_root(ssfr_recipe **out, const ssfr_yaml_node *root)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("title", ssfr_yaml_read_text, ssfr_recipe, title),
        SSFR_YAML_ROW_ALL("command", read_command),
        SSFR_YAML_ROW_ALL("pictures", read_pictures),
        SSFR_YAML_ROW_ALL("args", leave_args),
        SSFR_YAML_ROW("published", ssfr_published_spec_read, ssfr_recipe, published),
        SSFR_YAML_ROW_ALL("quick", read_quick),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    ssfr_recipe *recipe = NULL;
    SSFR_TRY(ssfr_alloc(&recipe, 1, sizeof *recipe, "a recipe"));
    SSFR_TRY(ssfr_yaml_read_map(root, rows, recipe));
    SSFR_TRY(share_args(recipe, root));
    SSFR_TRY(check_kind(recipe, root));
    *out = recipe;
    recipe = NULL;
end:
    ssfr_recipe_destroy(&recipe);
    return result;
}

ssfr_result ssfr_recipe_parse(ssfr_recipe **out, const char *path, const char *text, size_t size)
{
    ssfr_result result = SSFR_OK;
    ssfr_yaml *tree = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_yaml_parse(&tree, path, "reproduction", text, size));
    const ssfr_yaml_node *root = ssfr_yaml_root(tree);
    if (root->kind == SSFR_YAML_MAP && (ssfr_yaml_find(root, "command") || ssfr_yaml_find(root, "pictures")))
        SSFR_TRY(read_root(out, root));
end:
    ssfr_yaml_destroy(&tree);
    return result;
}

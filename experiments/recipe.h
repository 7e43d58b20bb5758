/* SPDX-License-Identifier: GPL-3.0-or-later */
/* recipe.h: an item of a paper that is no sweep: another command of ssfr that leaves a table, or renderings.
 *
 *      title: what the table says
 *      command: [bench, truth, --scene, block]             # words; -o is the item's table
 *      published: {file: tab1.csv, on: [node], column: ms} # may be missing: the paper's numbers, see published.h
 *      quick: {title: the same, smaller, command: [bench, truth, --scene, block, --quick]} # at quick scale
 *
 *      title: what is to be seen
 *      pictures:                                           # `ssfr render ARGS -o <item>/<name>.png`
 *        - {name: foam, args: [corridor, --frame, 40]}
 *      args: [--scale, full, --size, 640x360]              # behind those of each picture, or behind the command
 *      quick: {args: [--size, 320x180]}                    # the same pictures, these in the place of those
 *
 * A line in <item>.made.txt says what was made, so that it is not made again. */
#ifndef SSFR_RECIPE_H
#define SSFR_RECIPE_H

#include "experiments/published.h"

typedef struct ssfr_step {
    char *name; /* of a picture; "" for the table */
    int n;
    char **words; /* the command and its arguments, without -o */
} ssfr_step;

typedef struct ssfr_steps {
    size_t n;
    ssfr_step *items;
} ssfr_steps;

typedef struct ssfr_recipe ssfr_recipe;
struct ssfr_recipe {
    char *title; /* NULL when not given */
    bool pictures;
    ssfr_steps steps;
    ssfr_published_spec published; /* file NULL: none */
    ssfr_recipe *quick;            /* title and steps in the place of those above; NULL for none */
};

/* From the text of an item; path is what errors call it. *out is NULL when it has neither key, but is a sweep. */
SSFR_MUST ssfr_result ssfr_recipe_parse(ssfr_recipe **out, const char *path, const char *text, size_t size);
void ssfr_recipe_destroy(ssfr_recipe **recipe);
/* Makes it what it is at quick scale. */
void ssfr_recipe_quicken(ssfr_recipe *recipe);

typedef struct ssfr_recipe_options {
    const char *item;                /* "results/paper/item": where all goes, without an ending */
    const char *what;                /* for messages */
    const char *scale;               /* for the record */
    const ssfr_published *published; /* NULL for none */
    bool anew;                       /* what is there does not stay */
} ssfr_recipe_options;

/* Makes what is missing. What another build or recipe made is not mixed with: that is an error. After SIGINT or SIGTERM
 * no further step is begun, and a command that heeds them ends as it does by itself. */
SSFR_MUST ssfr_result ssfr_recipe_run(const ssfr_recipe *recipe, const ssfr_recipe_options *options);

#endif

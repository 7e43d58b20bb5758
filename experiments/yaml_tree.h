/* SPDX-License-Identifier: GPL-3.0-or-later */
/* yaml_tree.h: a YAML document as a tree whose every error names file, line and column; rows of a table read its maps.
 *
 * Keys are texts and stand once in their map. Anchors and aliases are taken; tags are ignored. */
#ifndef SSFR_YAML_TREE_H
#define SSFR_YAML_TREE_H

#include "base/base.h"

enum {
    SSFR_YAML_FILE = 1 << 20, /* bytes, the largest document */
    SSFR_YAML_KEYS = 1000,    /* the most keys of a map */
    SSFR_YAML_PLACE = 512,    /* bytes of a place's text */
};

typedef struct ssfr_yaml ssfr_yaml;

typedef enum ssfr_yaml_kind { SSFR_YAML_TEXT, SSFR_YAML_LIST, SSFR_YAML_MAP } ssfr_yaml_kind;

typedef struct ssfr_yaml_node ssfr_yaml_node;
struct ssfr_yaml_node {
    const ssfr_yaml *tree;
    ssfr_yaml_kind kind;
    size_t line, column;       /* from 1 */
    const char *name;          /* what errors call it: its key; in a list, the list's name */
    const ssfr_yaml_node *key; /* of a value in a map, else NULL */
    const char *text;          /* of a TEXT, else NULL */
    size_t n;                  /* of values, in the file's order */
    ssfr_yaml_node **keys;     /* of a MAP; each a TEXT */
    ssfr_yaml_node **values;
};

/* Parses text[size]; path is what errors call the file, and what is its kind: "sweep". The text need not stay. */
SSFR_MUST ssfr_result ssfr_yaml_parse(ssfr_yaml **out, const char *path, const char *what, const char *text,
                                      size_t size);
void ssfr_yaml_destroy(ssfr_yaml **tree);
const ssfr_yaml_node *ssfr_yaml_root(const ssfr_yaml *tree); /* never NULL */

/* "sweep.yaml:7:3", of the node itself. */
const char *ssfr_yaml_place(const ssfr_yaml_node *node, char text[SSFR_YAML_PLACE]);
/* The key of a value in a map, else the node: where an error about all of it is best seen. */
const ssfr_yaml_node *ssfr_yaml_head(const ssfr_yaml_node *node);

/* Fails at a node: ssfr_yaml_fail(node, SSFR_ERR_VALUE, "%s: too wide", node->name). */
#define ssfr_yaml_fail(node, code, ...) ssfr_yaml_fail_at((node), (code), SSFR_HERE, __VA_ARGS__)
__attribute__((format(printf, 4, 5))) ssfr_result ssfr_yaml_fail_at(const ssfr_yaml_node *node, ssfr_result code,
                                                                   const char *where, const char *format, ...);

/* Fails unless the node is of that kind. */
SSFR_MUST ssfr_result ssfr_yaml_expect(const ssfr_yaml_node *node, ssfr_yaml_kind kind);
/* The value of a key of a map; NULL when it is not there. */
const ssfr_yaml_node *ssfr_yaml_find(const ssfr_yaml_node *map, const char *name);

/* A new text of two, to free(). */
SSFR_MUST ssfr_result ssfr_yaml_copy(char **out, const char *before, const char *text);

/* Reads the value of one parameter into its struct; name is what errors call it. */
SSFR_MUST ssfr_result ssfr_yaml_read_param(const ssfr_yaml_node *value, const char *name, const ssfr_param *param,
                                           void *to);

/* ---- rows: what a map may hold, and where it goes ---------------------------------------------------------------- */

typedef struct ssfr_yaml_row ssfr_yaml_row;
typedef ssfr_result ssfr_yaml_read(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to);

struct ssfr_yaml_row {
    const char *name;
    ssfr_yaml_read *read;
    size_t offset;            /* into what the map is read to */
    bool needed;
    const char *unit;         /* of numbers; NULL for none */
    double min, max;          /* closed; both 0: all finite numbers */
    const char *const *words; /* NULL-terminated */
    const ssfr_param *params;
};

/* A row of `key`, read by `reader` to a member of a struct; further members of the row may follow. */
#define SSFR_YAML_ROW(key, reader, type, member, ...) \
    {.name = (key), .read = (reader), .offset = offsetof(type, member), __VA_ARGS__}
/* The same to the struct itself. */
#define SSFR_YAML_ROW_ALL(key, reader, ...) {.name = (key), .read = (reader), __VA_ARGS__}
#define SSFR_YAML_ROW_END {.name = NULL}

/* Reads a map by rows that end with SSFR_YAML_ROW_END. A key that no row has is an error that lists those there
 * are; so is a needed key that is missing. What is not given stays as it is. */
SSFR_MUST ssfr_result ssfr_yaml_read_map(const ssfr_yaml_node *node, const ssfr_yaml_row *rows, void *to);

/* Readers for rows. `to` is... */
ssfr_yaml_read ssfr_yaml_read_node;   /* const ssfr_yaml_node *: kept for later, valid as long as the tree */
ssfr_yaml_read ssfr_yaml_read_text;   /* char *, which is freed before and belongs to the caller */
ssfr_yaml_read ssfr_yaml_read_real;   /* double */
ssfr_yaml_read ssfr_yaml_read_real2;  /* double[2] */
ssfr_yaml_read ssfr_yaml_read_real3;  /* double[3] */
ssfr_yaml_read ssfr_yaml_read_count;  /* size_t, a whole number */
ssfr_yaml_read ssfr_yaml_read_flag;   /* bool */
ssfr_yaml_read ssfr_yaml_read_word;   /* int, index into the row's words */
ssfr_yaml_read ssfr_yaml_read_words;  /* bool[], one a word: true when it stands in the list */
ssfr_yaml_read ssfr_yaml_read_params; /* the struct of the row's params */

#endif

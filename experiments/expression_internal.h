/* SPDX-License-Identifier: GPL-3.0-or-later */
/* expression_internal.h: a rule as a tree, between its parser and its evaluator. */
#ifndef SSFR_EXPRESSION_INTERNAL_H
#define SSFR_EXPRESSION_INTERNAL_H

#include "experiments/expression.h"

enum {
    SSFR_RULE_NODES = 64,
    SSFR_RULE_FILTERS = 12, /* of one function */
    SSFR_RULE_CELLS = 12,   /* of one filter */
    SSFR_RULE_DEPTH = 16,   /* of parentheses */
};

typedef enum ssfr_compare {
    SSFR_EQUAL,
    SSFR_UNEQUAL,
    SSFR_AT_MOST,
    SSFR_BELOW,
    SSFR_AT_LEAST,
    SSFR_ABOVE,
} ssfr_compare;

/* X(name, number of arguments, what it gives): list or single. */
#define SSFR_RULE_FUNCTIONS(X) \
    X(max, 1, SINGLE)          \
    X(min, 1, SINGLE)          \
    X(mean, 1, SINGLE)         \
    X(median, 1, SINGLE)       \
    X(count, 1, SINGLE)        \
    X(slope, 2, SINGLE)        \
    X(monotone, 2, SINGLE)     \
    X(ratio, 1, LIST)          \
    X(abs, 1, SAME)            \
    X(log, 1, SAME)

typedef enum ssfr_rule_function {
#define X(name, n, gives) SSFR_RULE_##name,
    SSFR_RULE_FUNCTIONS(X)
#undef X
        SSFR_N_RULE_FUNCTIONS
} ssfr_rule_function;

typedef struct ssfr_rule_filter {
    const char *column;
    ssfr_compare compare;
    int n_cells;
    const char *cells[SSFR_RULE_CELLS]; /* any of them */
} ssfr_rule_filter;

typedef enum ssfr_rule_kind { SSFR_RULE_NUMBER, SSFR_RULE_COLUMN, SSFR_RULE_OPERATOR, SSFR_RULE_CALL } ssfr_rule_kind;

typedef struct ssfr_rule_node ssfr_rule_node;
struct ssfr_rule_node {
    ssfr_rule_kind kind;
    bool is_list;
    double number;
    const char *table, *column;
    char operator; /* + - * /, between both arguments */
    ssfr_rule_function function;
    int n_arguments, n_filters;
    const ssfr_rule_node *arguments[2];
    ssfr_rule_filter filters[SSFR_RULE_FILTERS]; /* of a ratio, the first two are its pair */
};

struct ssfr_expression {
    char *words; /* what the nodes' texts point into */
    int n_nodes;
    ssfr_rule_node nodes[SSFR_RULE_NODES];
    const ssfr_rule_node *left, *right;
    ssfr_compare compare;
};

static inline bool ssfr_compare_holds(ssfr_compare compare, double a, double b)
{
    switch (compare) {
    case SSFR_EQUAL: return a == b;
    case SSFR_UNEQUAL: return a != b;
    case SSFR_AT_MOST: return a <= b;
    case SSFR_BELOW: return a < b;
    case SSFR_AT_LEAST: return a >= b;
    case SSFR_ABOVE: return a > b;
    }
    return false;
}

#endif

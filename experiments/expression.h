/* SPDX-License-Identifier: GPL-3.0-or-later */
/* expression.h: rules of claims: one comparison between numbers that are made of tables' columns.
 *
 *      rule       = sum ("<=" | "<" | ">=" | ">" | "==" | "!=") sum
 *      sum        = product {("+" | "-") product}
 *      product    = factor {("*" | "/") factor}
 *      factor     = "-" factor | number | "(" sum ")" | table "." column | function "(" sum {"," sum | "," filter} ")"
 *      filter     = column ("=" | "!=" | "<=" | "<" | ">=" | ">") cell {"|" cell}
 *
 * A column is a list, a value for each row that passes the filters of all functions around it. Rows whose status is
 * neither ok nor ran, and cells that are no finite numbers, have none. Both sides of the comparison must be single
 * numbers.
 *
 *      max min mean median count       of a list, a number
 *      abs log                         of each value; the logarithm is natural
 *      ratio(list, key=a, key=b)       a over b, for each pair of rows that is else of the same keys: the columns before
 *                                      `status`
 *      slope(y, x)                     of the line by least squares
 *      monotone(y, x)                  1: y never falls and somewhere rises with x; -1: the reverse; 0: neither */
#ifndef SSFR_EXPRESSION_H
#define SSFR_EXPRESSION_H

#include "experiments/csv.h"

typedef struct ssfr_expression ssfr_expression;

/* Where the text begins, for messages: "claims.yaml:7:11: ...". Line and column count from 1. */
typedef struct ssfr_text_place {
    const char *path;
    size_t line, column;
} ssfr_text_place;

SSFR_MUST ssfr_result ssfr_expression_parse(ssfr_expression **out, const char *text, const ssfr_text_place *place);
void ssfr_expression_destroy(ssfr_expression **expression);

/* Gives the table of a name, NULL when there is none; it must stay until the judgement is made. */
typedef struct ssfr_table_source {
    ssfr_result (*find)(void *user, const char *name, const ssfr_csv_table **table);
    void *user;
} ssfr_table_source;

typedef struct ssfr_verdict {
    bool measured, holds;
    double left, right; /* of the comparison; NaN when not measured */
    bool constant;      /* the right side needs no table */
    size_t left_out;    /* values that are missing in lists: of a run that failed, or no number */
    char why[256];      /* not measured, in words */
} ssfr_verdict;

/* What a rule says of tables. What is missing in them, or cannot be computed from them, is no error: the verdict says
 * that it was not measured, and why. */
SSFR_MUST ssfr_result ssfr_expression_judge(const ssfr_expression *expression, const ssfr_table_source *source,
                                            ssfr_verdict *out);

#endif

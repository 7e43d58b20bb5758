/* SPDX-License-Identifier: GPL-3.0-or-later */
/* expression_judge.c: what a rule's tree says of tables. */
#include "experiments/expression_internal.h"

#include <stdarg.h>

enum { MOST_AROUND = SSFR_RULE_DEPTH + 1 }; /* functions around a column */

typedef struct list { /* one value a row of a table, NaN where it is missing; or a single number */
    bool single;
    size_t n;
    double *values;
    size_t *rows;
    const ssfr_csv_table *table;
} list;

/* Filters around what is evaluated: all of a call's from `first` on, and of a ratio one of the two before. */
typedef struct around {
    const ssfr_rule_node *call;
    int first, also; /* also: -1 for none */
} around;

typedef struct judge {
    const ssfr_table_source *source;
    int n_around;
    around around[MOST_AROUND];
    ssfr_verdict *verdict;
    ssfr_result result;
} judge;

/* ---- stopping: parts give false when there is nothing to go on with ---------------------------------------------- */

__attribute__((format(printf, 2, 3))) static bool stop(judge *j, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(j->verdict->why, sizeof j->verdict->why, format, list);
    va_end(list);
    return false;
}

static bool check(judge *j, ssfr_result result)
{
    if (j->result == SSFR_OK) j->result = result;
    return result == SSFR_OK;
}

/* ---- lists ------------------------------------------------------------------------------------------------------- */

static void finish(list *l)
{
    free(l->values);
    free(l->rows);
    *l = (list){0};
}

static bool make(judge *j, list *out, size_t n, const ssfr_csv_table *table)
{
    *out = (list){.table = table};
    if (!check(j, ssfr_alloc(&out->values, n, sizeof *out->values, "values of a rule"))) return false;
    return check(j, ssfr_alloc(&out->rows, n, sizeof *out->rows, "rows of a rule"));
}

static bool make_single(judge *j, list *out, double value)
{
    if (!make(j, out, 1, NULL)) return false;
    out->single = true;
    out->n = 1;
    out->values[0] = value;
    return true;
}

static bool same_rows(const list *a, const list *b)
{
    return a->table == b->table && a->n == b->n && memcmp(a->rows, b->rows, a->n * sizeof *a->rows) == 0;
}

/* ---- columns and filters ----------------------------------------------------------------------------------------- */

static bool has_cell(const ssfr_rule_filter *filter, const char *cell)
{
    bool found = false;
    double a, b;
    for (int i = 0; i < filter->n_cells && !found; i++)
        found = strcmp(cell, filter->cells[i]) == 0 ||
                (ssfr_parse_number(cell, &a) && ssfr_parse_number(filter->cells[i], &b) && a == b);
    return found;
}

static bool passes(const ssfr_rule_filter *filter, const char *cell)
{
    double a, b;
    if (filter->compare == SSFR_EQUAL || filter->compare == SSFR_UNEQUAL)
        return has_cell(filter, cell) == (filter->compare == SSFR_EQUAL);
    return ssfr_parse_number(cell, &a) && ssfr_parse_number(filter->cells[0], &b) &&
           ssfr_compare_holds(filter->compare, a, b);
}

/* Of all filters around, one after the other; NULL past the end. */
static const ssfr_rule_filter *filter_at(const judge *j, int i)
{
    for (int k = 0; k < j->n_around; k++) {
        const around *a = &j->around[k];
        const int n = a->call->n_filters - a->first + (a->also >= 0);
        if (i >= n) {
            i -= n;
            continue;
        }
        return &a->call->filters[a->also >= 0 && i == 0 ? a->also : a->first + i - (a->also >= 0)];
    }
    return NULL;
}

static bool find_column(judge *j, const ssfr_csv_table *table, const char *name, const char *column, int *out)
{
    *out = ssfr_csv_column(table, column);
    return *out >= 0 || stop(j, "table %s has no column %s", name, column);
}

static bool row_passes(const judge *j, const ssfr_csv_table *table, size_t row)
{
    const ssfr_rule_filter *filter;
    bool all = true;
    for (int i = 0; all && (filter = filter_at(j, i)); i++)
        all = passes(filter, ssfr_csv_cell(table, row, ssfr_csv_column(table, filter->column)));
    return all;
}

/* A sweep's run that came to its end, or a bench's pass that had something to do. */
static bool has_run(const ssfr_csv_table *table, size_t row)
{
    const int column = ssfr_csv_column(table, "status");
    const char *status = column < 0 ? "ok" : ssfr_csv_cell(table, row, column);
    return strcmp(status, "ok") == 0 || strcmp(status, "ran") == 0;
}

static bool eval_column(judge *j, const ssfr_rule_node *node, list *out)
{
    const ssfr_csv_table *table = NULL;
    const ssfr_rule_filter *filter;
    int column, unused;
    if (!check(j, j->source->find(j->source->user, node->table, &table))) return false;
    if (!table) return stop(j, "there is no table %s", node->table);
    if (!find_column(j, table, node->table, node->column, &column)) return false;
    for (int i = 0; (filter = filter_at(j, i)); i++)
        if (!find_column(j, table, node->table, filter->column, &unused)) return false;
    if (!make(j, out, table->n_rows, table)) return false;
    for (size_t row = 0; row < table->n_rows; row++) {
        if (!row_passes(j, table, row)) continue;
        out->rows[out->n] = row;
        out->values[out->n++] = has_run(table, row) ? ssfr_csv_cell_number(table, row, column) : NAN;
    }
    return true;
}

/* ---- operators --------------------------------------------------------------------------------------------------- */

static bool eval(judge *j, const ssfr_rule_node *node, list *out);

static bool apply(judge *j, char operator, double a, double b, double *out)
{
    if (operator == '/' && b == 0) return stop(j, "division by 0");
    *out = operator == '+' ? a + b : operator == '-' ? a - b : operator == '*' ? a * b : a / b;
    return true;
}

static bool combine(judge *j, char operator, const list *a, const list *b, list *out)
{
    const list *shape = a->single ? b : a;
    if (!a->single && !b->single && !same_rows(a, b))
        return stop(j, "%c is between lists of different rows", operator);
    if (!make(j, out, shape->n, shape->table)) return false;
    out->single = shape->single;
    out->n = shape->n;
    memcpy(out->rows, shape->rows, shape->n * sizeof *shape->rows);
    for (size_t i = 0; i < out->n; i++)
        if (!apply(j, operator, a->values[a->single ? 0 : i], b->values[b->single ? 0 : i], &out->values[i]))
            return false;
    return true;
}

static bool eval_operator(judge *j, const ssfr_rule_node *node, list *out)
{
    list a = {0}, b = {0};
    const bool done = eval(j, node->arguments[0], &a) && eval(j, node->arguments[1], &b) &&
                      combine(j, node->operator, &a, &b, out);
    finish(&a);
    finish(&b);
    return done;
}

/* ---- functions of one list --------------------------------------------------------------------------------------- */

/* Takes out what is missing; y goes with x, or is NULL. */
static void compact(judge *j, list *x, list *y)
{
    size_t n = 0;
    for (size_t i = 0; i < x->n; i++) {
        if (!isfinite(x->values[i]) || (y && !isfinite(y->values[i]))) continue;
        x->values[n] = x->values[i];
        if (y) y->values[n] = y->values[i];
        n++;
    }
    j->verdict->left_out += x->n - n;
    x->n = n;
    if (y) y->n = n;
}

static double mean_of(const list *l)
{
    double sum = 0;
    for (size_t i = 0; i < l->n; i++) sum += l->values[i];
    return sum / (double)l->n;
}

static bool summarise(judge *j, ssfr_rule_function function, list *l, list *out)
{
    compact(j, l, NULL);
    if (function == SSFR_RULE_count) return make_single(j, out, (double)l->n);
    if (l->n == 0) return stop(j, "no row has the number that is asked for");
    qsort(l->values, l->n, sizeof *l->values, ssfr_by_value);
    const double *v = l->values;
    const double median = (v[(l->n - 1) / 2] + v[l->n / 2]) / 2;
    const double value = function == SSFR_RULE_max    ? v[l->n - 1]
                         : function == SSFR_RULE_min  ? v[0]
                         : function == SSFR_RULE_mean ? mean_of(l)
                                                      : median;
    return make_single(j, out, value);
}

static bool map(judge *j, ssfr_rule_function function, const list *l, list *out)
{
    if (!make(j, out, l->n, l->table)) return false;
    out->single = l->single;
    out->n = l->n;
    memcpy(out->rows, l->rows, l->n * sizeof *l->rows);
    for (size_t i = 0; i < l->n; i++) {
        const double v = l->values[i];
        if (function == SSFR_RULE_log && v <= 0) return stop(j, "the logarithm of %g", v);
        out->values[i] = function == SSFR_RULE_log ? log(v) : fabs(v);
    }
    return true;
}

/* ---- functions of y over x --------------------------------------------------------------------------------------- */

static bool slope(judge *j, const list *y, const list *x, list *out)
{
    double xy = 0, xx = 0;
    if (y->n < 2) return stop(j, "a slope needs two rows with numbers, there are %zu", y->n);
    const double x_mean = mean_of(x), y_mean = mean_of(y);
    for (size_t i = 0; i < y->n; i++) {
        xy += (x->values[i] - x_mean) * (y->values[i] - y_mean);
        xx += ssfr_square(x->values[i] - x_mean);
    }
    return xx > 0 ? make_single(j, out, xy / xx) : stop(j, "a slope over rows that are all at %g", x_mean);
}

typedef struct point {
    double x, y;
} point;

static int compare_points(const void *a, const void *b)
{
    return ssfr_by_value(&((const point *)a)->x, &((const point *)b)->x);
}

static bool follow(judge *j, const point *points, size_t n, list *out)
{
    bool rises = false, falls = false;
    for (size_t i = 1; i < n; i++) {
        if (points[i].x == points[i - 1].x)
            return stop(j, "several rows stand at %g: filters must leave one", points[i].x);
        rises |= points[i].y > points[i - 1].y;
        falls |= points[i].y < points[i - 1].y;
    }
    return make_single(j, out, rises == falls ? 0 : rises ? 1 : -1);
}

static bool monotone(judge *j, const list *y, const list *x, list *out)
{
    point *points = NULL;
    if (y->n < 2) return stop(j, "a trend needs two rows with numbers, there are %zu", y->n);
    if (!check(j, ssfr_alloc(&points, y->n, sizeof *points, "points of a rule"))) return false;
    for (size_t i = 0; i < y->n; i++) points[i] = (point){x->values[i], y->values[i]};
    qsort(points, y->n, sizeof *points, compare_points);
    const bool done = follow(j, points, y->n, out);
    free(points);
    return done;
}

static bool eval_trend(judge *j, const ssfr_rule_node *call, list *out)
{
    list y = {0}, x = {0};
    bool done = eval(j, call->arguments[0], &y) && eval(j, call->arguments[1], &x);
    if (done && !same_rows(&y, &x)) done = stop(j, "y and x are of different rows");
    if (done) {
        compact(j, &y, &x);
        done = (call->function == SSFR_RULE_slope ? slope : monotone)(j, &y, &x, out);
    }
    finish(&y);
    finish(&x);
    return done;
}

/* ---- ratios ------------------------------------------------------------------------------------------------------ */

/* The rows are alike in all columns before the status but one. */
static bool is_pair(const list *a, size_t i, const list *b, size_t k, int n_keys, int varied)
{
    bool same = true;
    for (int c = 0; c < n_keys && same; c++)
        same = c == varied ||
               strcmp(ssfr_csv_cell(a->table, a->rows[i], c), ssfr_csv_cell(b->table, b->rows[k], c)) == 0;
    return same;
}

static bool divide_pairs(judge *j, const list *a, const list *b, const char *key, list *out)
{
    const int n_keys = a->table ? ssfr_csv_column(a->table, "status") : -1;
    const int varied = a->table ? ssfr_csv_column(a->table, key) : -1;
    if (a->table != b->table || n_keys < 0) return stop(j, "a ratio needs a table with keys before its column status");
    if (varied >= n_keys) return stop(j, "%s is no key: it stands behind the column status", key);
    if (!make(j, out, a->n, a->table)) return false;
    for (size_t i = 0; i < a->n; i++) {
        size_t n_partners = 0, partner = 0;
        for (size_t k = 0; k < b->n; k++)
            if (is_pair(a, i, b, k, n_keys, varied)) n_partners++, partner = k;
        if (n_partners > 1) return stop(j, "a row has %zu partners of another %s", n_partners, key);
        out->rows[out->n] = a->rows[i];
        out->values[out->n] = NAN; /* a row without a partner */
        if (n_partners && !apply(j, '/', a->values[i], b->values[partner], &out->values[out->n])) return false;
        out->n++;
    }
    return true;
}

static bool eval_ratio(judge *j, const ssfr_rule_node *call, list *out)
{
    list parts[2] = {{0}, {0}};
    bool done = true;
    for (int i = 0; i < 2 && done; i++) {
        j->around[j->n_around++] = (around){call, 2, i};
        done = eval(j, call->arguments[0], &parts[i]);
        j->n_around--;
    }
    done = done && divide_pairs(j, &parts[0], &parts[1], call->filters[0].column, out);
    for (int i = 0; i < 2; i++) finish(&parts[i]);
    return done;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static bool eval_list_function(judge *j, const ssfr_rule_node *call, list *out)
{
    list l = {0};
    bool done = eval(j, call->arguments[0], &l);
    if (done && (call->function == SSFR_RULE_abs || call->function == SSFR_RULE_log))
        done = map(j, call->function, &l, out);
    else if (done)
        done = summarise(j, call->function, &l, out);
    finish(&l);
    return done;
}

static bool eval_call(judge *j, const ssfr_rule_node *call, list *out)
{
    if (call->function == SSFR_RULE_ratio) return eval_ratio(j, call, out);
    j->around[j->n_around++] = (around){call, 0, -1};
    const bool is_trend = call->function == SSFR_RULE_slope || call->function == SSFR_RULE_monotone;
    const bool done = is_trend ? eval_trend(j, call, out) : eval_list_function(j, call, out);
    j->n_around--;
    return done;
}

static bool eval(judge *j, const ssfr_rule_node *node, list *out)
{
    switch (node->kind) {
    case SSFR_RULE_NUMBER: return make_single(j, out, node->number);
    case SSFR_RULE_COLUMN: return eval_column(j, node, out);
    case SSFR_RULE_OPERATOR: return eval_operator(j, node, out);
    case SSFR_RULE_CALL: return eval_call(j, node, out);
    }
    return false;
}

static bool eval_side(judge *j, const ssfr_rule_node *node, double *out)
{
    list l = {0};
    const bool done = eval(j, node, &l);
    if (done) *out = l.values[0];
    finish(&l);
    return done && (isfinite(*out) || stop(j, "it comes to %g", *out));
}

static bool is_constant(const ssfr_rule_node *node)
{
    bool constant = node->kind != SSFR_RULE_COLUMN;
    for (int i = 0; i < node->n_arguments && constant; i++) constant = is_constant(node->arguments[i]);
    return constant;
}

ssfr_result ssfr_expression_judge(const ssfr_expression *expression, const ssfr_table_source *source, ssfr_verdict *out)
{
    judge j = {.source = source, .verdict = out, .result = SSFR_OK};
    double left = NAN, right = NAN;
    *out = (ssfr_verdict){.left = NAN, .right = NAN, .constant = is_constant(expression->right)};
    out->measured = eval_side(&j, expression->left, &left) && eval_side(&j, expression->right, &right);
    if (!out->measured) return j.result;
    out->left = left, out->right = right;
    out->holds = ssfr_compare_holds(expression->compare, left, right);
    return SSFR_OK;
}

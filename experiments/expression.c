/* SPDX-License-Identifier: GPL-3.0-or-later */
/* expression.c: from the text of a rule to its tree, by recursive descent; errors name file, line and column. */
#include "experiments/expression_internal.h"

#include <ctype.h>
#include <stdarg.h>

enum { MOST_SHOWN = 40 }; /* characters of a rule in an error */
enum { GIVES_SINGLE, GIVES_LIST, GIVES_SAME }; /* as its argument */

static const struct {
    const char *name;
    int n_arguments, gives;
} functions[SSFR_N_RULE_FUNCTIONS] = {
#define X(name, n, gives) {#name, n, GIVES_##gives},
    SSFR_RULE_FUNCTIONS(X)
#undef X
};

typedef struct parser {
    ssfr_expression *e;
    const ssfr_text_place *place;
    const char *text, *at;
    char *word; /* where the next word goes */
    int depth;
} parser;

/* ---- words ------------------------------------------------------------------------------------------------------- */

/* With the text that follows, because YAML may have folded lines. */
#define fail(p, where, ...) fail_at((p), (where), SSFR_HERE, __VA_ARGS__)
__attribute__((format(printf, 4, 5))) static ssfr_result fail_at(const parser *p, const char *where, const char *here,
                                                                const char *format, ...)
{
    char text[300];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    return ssfr_fail_at(SSFR_ERR_FORMAT, here, "%s:%zu:%zu: %s%s%.*s", p->place->path, p->place->line,
                        p->place->column + (size_t)(where - p->text), text, *where ? " at " : " at the end",
                        ssfr_min_int((int)strcspn(where, "\n"), MOST_SHOWN), where);
}

static void skip_space(parser *p)
{
    while (isspace((unsigned char)*p->at)) p->at++;
}

static bool take(parser *p, char c)
{
    skip_space(p);
    if (*p->at != c) return false;
    p->at++;
    return true;
}

static ssfr_result expect(parser *p, char c)
{
    return take(p, c) ? SSFR_OK : fail(p, p->at, "expected %c", c);
}

/* Words go into one buffer, which has room for all there can be. */
static const char *keep(parser *p, const char *begin, size_t length)
{
    char *word = p->word;
    memcpy(word, begin, length);
    word[length] = '\0';
    p->word += length + 1;
    return word;
}

static bool begins_name(char c)
{
    return isalpha((unsigned char)c) || c == '_';
}

static size_t name_length(const char *at)
{
    size_t n = 0;
    while (begins_name(at[n]) || (n > 0 && (isdigit((unsigned char)at[n]) || at[n] == '.'))) n++;
    return n;
}

static bool read_compare(const char **at, ssfr_compare *out)
{
    static const struct {
        const char *text;
        ssfr_compare compare;
    } list[] = {{"<=", SSFR_AT_MOST}, {">=", SSFR_AT_LEAST}, {"==", SSFR_EQUAL}, {"!=", SSFR_UNEQUAL},
                {"<", SSFR_BELOW},    {">", SSFR_ABOVE}};
    for (size_t i = 0; i < SSFR_COUNT(list); i++)
        if (strncmp(*at, list[i].text, strlen(list[i].text)) == 0) {
            *at += strlen(list[i].text);
            *out = list[i].compare;
            return true;
        }
    return false;
}

/* ---- the tree ---------------------------------------------------------------------------------------------------- */

static ssfr_result parse_sum(parser *p, const ssfr_rule_node **out);

static ssfr_result new_node(parser *p, ssfr_rule_kind kind, ssfr_rule_node **out)
{
    if (p->e->n_nodes == SSFR_RULE_NODES) return fail(p, p->at, "more than %d parts", SSFR_RULE_NODES);
    *out = &p->e->nodes[p->e->n_nodes++];
    (*out)->kind = kind;
    return SSFR_OK;
}

static ssfr_result parse_number(parser *p, const ssfr_rule_node **out)
{
    ssfr_result result = SSFR_OK;
    ssfr_rule_node *node = NULL;
    const char *begin = p->at;
    size_t n = strspn(begin, "0123456789.");
    if (begin[n] == 'e' || begin[n] == 'E') {
        const size_t sign = begin[n + 1] == '+' || begin[n + 1] == '-';
        n += 1 + sign + strspn(begin + n + 1 + sign, "0123456789");
    }
    SSFR_TRY(new_node(p, SSFR_RULE_NUMBER, &node));
    if (!ssfr_parse_number(keep(p, begin, n), &node->number)) return fail(p, begin, "no number");
    p->at += n;
    *out = node;
end:
    return result;
}

static ssfr_result parse_column(parser *p, const ssfr_rule_node **out)
{
    ssfr_result result = SSFR_OK;
    ssfr_rule_node *node = NULL;
    const size_t n = name_length(p->at), table = strcspn(p->at, ".");
    if (table + 1 >= n) return fail(p, p->at, "expected a number, table.column or function()");
    SSFR_TRY(new_node(p, SSFR_RULE_COLUMN, &node));
    node->table = keep(p, p->at, table);
    node->column = keep(p, p->at + table + 1, n - table - 1);
    node->is_list = true;
    p->at += n;
    *out = node;
end:
    return result;
}

/* Bare up to what ends it, or quoted. */
static ssfr_result parse_cell(parser *p, ssfr_rule_filter *filter)
{
    skip_space(p);
    const char *begin = p->at;
    const bool quoted = *begin == '\'';
    size_t n = quoted ? strcspn(begin + 1, "'") : strcspn(begin, ",|()'");
    if (filter->n_cells == SSFR_RULE_CELLS) return fail(p, begin, "more than %d cells", SSFR_RULE_CELLS);
    if (quoted && begin[1 + n] != '\'') return fail(p, begin, "a quote without its end");
    p->at = begin + n + (quoted ? 2 : 0);
    while (!quoted && n > 0 && isspace((unsigned char)begin[n - 1])) n--;
    if (!quoted && n == 0) return fail(p, begin, "expected a cell");
    filter->cells[filter->n_cells++] = keep(p, begin + quoted, n);
    return SSFR_OK;
}

/* An order is one of numbers, and of one cell. */
static ssfr_result check_order(const parser *p, const char *where, const ssfr_rule_filter *filter)
{
    double value;
    if (filter->compare == SSFR_EQUAL || filter->compare == SSFR_UNEQUAL) return SSFR_OK;
    if (filter->n_cells == 1 && ssfr_parse_number(filter->cells[0], &value)) return SSFR_OK;
    return fail(p, where, "expected one number");
}

/* Leaves the place as it was when no filter begins there: then *is_filter is false. */
static ssfr_result parse_filter(parser *p, ssfr_rule_node *call, bool *is_filter)
{
    ssfr_result result = SSFR_OK;
    skip_space(p);
    const char *begin = p->at, *at = begin + name_length(begin);
    const size_t n = (size_t)(at - begin);
    ssfr_rule_filter filter = {.compare = SSFR_EQUAL};
    while (isspace((unsigned char)*at)) at++;
    *is_filter = n > 0 && (read_compare(&at, &filter.compare) || *at++ == '=');
    if (!*is_filter) return SSFR_OK;
    if (call->n_filters == SSFR_RULE_FILTERS) return fail(p, begin, "more than %d filters", SSFR_RULE_FILTERS);
    filter.column = keep(p, begin, n);
    p->at = at;
    do {
        SSFR_TRY(parse_cell(p, &filter));
    } while (take(p, '|'));
    SSFR_TRY(check_order(p, at, &filter));
    call->filters[call->n_filters++] = filter;
end:
    return result;
}

/* Moves the two filters of one column to the front: a over b. */
static ssfr_result pair_filters(const parser *p, const char *where, ssfr_rule_node *call)
{
    int n_pairs = 0, first = 0, second = 0;
    for (int i = 0; i < call->n_filters; i++)
        for (int k = i + 1; k < call->n_filters; k++)
            if (call->filters[i].compare == SSFR_EQUAL && call->filters[k].compare == SSFR_EQUAL &&
                strcmp(call->filters[i].column, call->filters[k].column) == 0)
                n_pairs++, first = i, second = k;
    if (n_pairs != 1) return fail(p, where, "a ratio needs one pair of key=a, key=b of one key");
    ssfr_rule_filter *f = call->filters;
    const ssfr_rule_filter a = f[first], b = f[second];
    memmove(f + second, f + second + 1, (size_t)(call->n_filters - second - 1) * sizeof *f);
    memmove(f + first, f + first + 1, (size_t)(call->n_filters - first - 2) * sizeof *f);
    memmove(f + 2, f, (size_t)(call->n_filters - 2) * sizeof *f);
    f[0] = a, f[1] = b;
    return SSFR_OK;
}

static ssfr_result check_call(const parser *p, const char *where, ssfr_rule_node *call)
{
    const char *name = functions[call->function].name;
    const int gives = functions[call->function].gives, n = functions[call->function].n_arguments;
    if (call->n_arguments != n)
        return fail(p, where, "%s takes %d before its filters, not %d", name, n, call->n_arguments);
    for (int i = 0; i < n; i++)
        if (!call->arguments[i]->is_list && gives != GIVES_SAME)
            return fail(p, where, "%s is of a column, not of one number", name);
    call->is_list = gives == GIVES_LIST || (gives == GIVES_SAME && call->arguments[0]->is_list);
    return call->function == SSFR_RULE_ratio ? pair_filters(p, where, call) : SSFR_OK;
}

static ssfr_result find_function(const parser *p, size_t n, ssfr_rule_function *out)
{
    char list[200] = "";
    size_t used = 0;
    for (int i = 0; i < SSFR_N_RULE_FUNCTIONS; i++) {
        *out = (ssfr_rule_function)i;
        if (strlen(functions[i].name) == n && strncmp(functions[i].name, p->at, n) == 0) return SSFR_OK;
        ssfr_list_name(list, sizeof list, &used, functions[i].name);
    }
    return fail(p, p->at, "no such function; there are %s:", list);
}

static ssfr_result parse_argument(parser *p, ssfr_rule_node *call)
{
    ssfr_result result = SSFR_OK;
    bool is_filter = false;
    SSFR_TRY(parse_filter(p, call, &is_filter));
    if (is_filter) goto end;
    if (call->n_filters > 0) return fail(p, p->at, "expected a filter");
    if (call->n_arguments == (int)SSFR_COUNT(call->arguments)) return fail(p, p->at, "expected a filter or )");
    SSFR_TRY(parse_sum(p, &call->arguments[call->n_arguments]));
    call->n_arguments++;
end:
    return result;
}

static ssfr_result parse_call(parser *p, size_t n_name, const ssfr_rule_node **out)
{
    ssfr_result result = SSFR_OK;
    ssfr_rule_node *call = NULL;
    const char *begin = p->at;
    SSFR_TRY(new_node(p, SSFR_RULE_CALL, &call));
    SSFR_TRY(find_function(p, n_name, &call->function));
    p->at += n_name;
    SSFR_TRY(expect(p, '('));
    do {
        SSFR_TRY(parse_argument(p, call));
    } while (take(p, ','));
    SSFR_TRY(expect(p, ')'));
    SSFR_TRY(check_call(p, begin, call));
    *out = call;
end:
    return result;
}

static ssfr_result new_operator(parser *p, char operator, const ssfr_rule_node *left, const ssfr_rule_node *right,
                                const ssfr_rule_node **out)
{
    ssfr_rule_node *node = NULL;
    const ssfr_result result = new_node(p, SSFR_RULE_OPERATOR, &node);
    if (result != SSFR_OK) return result;
    node->operator = operator;
    node->n_arguments = 2;
    node->arguments[0] = left, node->arguments[1] = right;
    node->is_list = left->is_list || right->is_list;
    *out = node;
    return SSFR_OK;
}

/* -x is 0 - x. */
static ssfr_result parse_negative(parser *p, const ssfr_rule_node **out);

static ssfr_result parse_factor(parser *p, const ssfr_rule_node **out)
{
    ssfr_result result = SSFR_OK;
    if (p->depth == SSFR_RULE_DEPTH) return fail(p, p->at, "deeper than %d", SSFR_RULE_DEPTH);
    p->depth++;
    if (take(p, '-')) {
        SSFR_TRY(parse_negative(p, out));
    } else if (take(p, '(')) {
        SSFR_TRY(parse_sum(p, out));
        SSFR_TRY(expect(p, ')'));
    } else if (isdigit((unsigned char)*p->at) || *p->at == '.') {
        SSFR_TRY(parse_number(p, out));
    } else {
        const size_t n = name_length(p->at);
        const bool is_call = n > 0 && p->at[n + strspn(p->at + n, " \t\n")] == '(';
        SSFR_TRY(is_call ? parse_call(p, n, out) : parse_column(p, out));
    }
    p->depth--;
end:
    return result;
}

static ssfr_result parse_negative(parser *p, const ssfr_rule_node **out)
{
    ssfr_result result = SSFR_OK;
    ssfr_rule_node *zero = NULL;
    const ssfr_rule_node *factor = NULL;
    SSFR_TRY(new_node(p, SSFR_RULE_NUMBER, &zero));
    SSFR_TRY(parse_factor(p, &factor));
    SSFR_TRY(new_operator(p, '-', zero, factor, out));
end:
    return result;
}

typedef ssfr_result parse_part(parser *p, const ssfr_rule_node **out);

/* Parts with one of two operators between them, from left to right. */
static ssfr_result parse_chain(parser *p, const char operators[2], parse_part *part, const ssfr_rule_node **out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_rule_node *right = NULL;
    SSFR_TRY(part(p, out));
    for (;;) {
        const char operator = take(p, operators[0]) ? operators[0] : take(p, operators[1]) ? operators[1] : '\0';
        if (!operator) break;
        SSFR_TRY(part(p, &right));
        SSFR_TRY(new_operator(p, operator, *out, right, out));
    }
end:
    return result;
}

static ssfr_result parse_product(parser *p, const ssfr_rule_node **out)
{
    return parse_chain(p, "*/", parse_factor, out);
}

static ssfr_result parse_sum(parser *p, const ssfr_rule_node **out)
{
    return parse_chain(p, "+-", parse_product, out);
}

static ssfr_result parse_side(parser *p, const ssfr_rule_node **out)
{
    ssfr_result result = SSFR_OK;
    skip_space(p);
    const char *begin = p->at;
    SSFR_TRY(parse_sum(p, out));
    if ((*out)->is_list) result = fail(p, begin, "a list: max, min, mean or median make it one number");
end:
    return result;
}

static ssfr_result parse_rule(parser *p)
{
    ssfr_result result = SSFR_OK;
    ssfr_compare second;
    SSFR_TRY(parse_side(p, &p->e->left));
    skip_space(p);
    if (!read_compare(&p->at, &p->e->compare)) return fail(p, p->at, "expected one of <= < >= > == !=");
    SSFR_TRY(parse_side(p, &p->e->right));
    skip_space(p);
    const char *rest = p->at;
    if (read_compare(&rest, &second)) return fail(p, p->at, "a second comparison");
    if (*p->at) result = fail(p, p->at, "expected an operator or the end");
end:
    return result;
}

ssfr_result ssfr_expression_parse(ssfr_expression **out, const char *text, const ssfr_text_place *place)
{
    ssfr_result result = SSFR_OK;
    ssfr_expression *e = NULL;
    parser p = {.place = place, .text = text, .at = text};
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&e, 1, sizeof *e, "a rule"));
    SSFR_TRY(ssfr_alloc(&e->words, 2 * strlen(text) + 2, 1, "a rule's words")); /* each with a zero byte */
    p.e = e, p.word = e->words;
    SSFR_TRY(parse_rule(&p));
    *out = e;
    e = NULL;
end:
    ssfr_expression_destroy(&e);
    return result;
}

void ssfr_expression_destroy(ssfr_expression **expression)
{
    if (*expression) free((*expression)->words);
    free(*expression);
    *expression = NULL;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* yaml_tree.c: a tree from libyaml's events, and reading its maps by tables of rows. */
#include "experiments/yaml_tree.h"
#include "base/param.h"

#include <stdarg.h>
#include <yaml.h>

enum {
    MAX_DEPTH = 32,       /* of lists and maps in each other */
    MAX_NODES = 1 << 18,  /* what a file of the largest size may make of little text */
    MAX_ANCHORS = 100,
};

typedef struct stored { /* a node, and what the tree keeps of it */
    ssfr_yaml_node node;
    struct stored *next;         /* of the tree, to free it */
    const ssfr_yaml_node *alias; /* what it stands for, NULL for itself */
    char text[];
} stored;

struct ssfr_yaml {
    char *path, *what, *root_name;
    stored *all;
    int n_nodes;
    ssfr_yaml_node *root;
};

/* ---- errors ------------------------------------------------------------------------------------------------------ */

const char *ssfr_yaml_place(const ssfr_yaml_node *node, char text[SSFR_YAML_PLACE])
{
    snprintf(text, SSFR_YAML_PLACE, "%.400s:%zu:%zu", node->tree->path, node->line, node->column);
    return text;
}

const ssfr_yaml_node *ssfr_yaml_head(const ssfr_yaml_node *node)
{
    return node->key ? node->key : node;
}

ssfr_result ssfr_yaml_fail_at(const ssfr_yaml_node *node, ssfr_result code, const char *where, const char *format, ...)
{
    char place[SSFR_YAML_PLACE], text[SSFR_YAML_PLACE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return ssfr_fail_at(code, where, "%s: %s", ssfr_yaml_place(node, place), text);
}

ssfr_result ssfr_yaml_expect(const ssfr_yaml_node *node, ssfr_yaml_kind kind)
{
    static const char *const names[] = {"one value", "a list", "a map of key: value"};
    if (node->kind == kind) return SSFR_OK;
    return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%.80s: expected %s", node->name, names[kind]);
}

/* ---- the tree from events ---------------------------------------------------------------------------------------- */

typedef struct builder {
    ssfr_yaml *tree;
    yaml_parser_t parser;
    int depth;
    struct {
        ssfr_yaml_node *node, *key; /* key: of a map, the one whose value comes next */
    } open[MAX_DEPTH];
    int n_anchors;
    struct {
        char *name;
        const ssfr_yaml_node *node;
    } anchors[MAX_ANCHORS];
} builder;

static ssfr_result fail_yaml(const builder *b, const char *text)
{
    const yaml_parser_t *parser = &b->parser;
    const char *path = b->tree->path, *problem = parser->problem ? parser->problem : "malformed YAML";
    size_t line = parser->problem_mark.line + 1, column = parser->problem_mark.column + 1;
    if (parser->error == YAML_MEMORY_ERROR) return ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for its YAML", path);
    if (parser->error != YAML_READER_ERROR)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu:%zu: %s", path, line, column, problem);
    line = column = 1;
    for (size_t i = 0; i < parser->problem_offset; i++, column++)
        if (text[i] == '\n') line++, column = 0;
    return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu:%zu: byte %zu: %s", path, line, column, parser->problem_offset, problem);
}

static ssfr_result new_node(builder *b, const yaml_event_t *event, const char *text, size_t length,
                            ssfr_yaml_node **out)
{
    ssfr_result result = SSFR_OK;
    stored *s = NULL;
    ssfr_yaml *tree = b->tree;
    const size_t line = event->start_mark.line + 1, column = event->start_mark.column + 1;
    const ssfr_yaml_node *parent = b->depth ? b->open[b->depth - 1].node : NULL,
                         *key = b->depth ? b->open[b->depth - 1].key : NULL;
    if (++tree->n_nodes > MAX_NODES)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu:%zu: more than %d values", tree->path, line, column, MAX_NODES);
    SSFR_TRY(ssfr_alloc(&s, 1, sizeof *s + length + 1, "YAML"));
    if (text) memcpy(s->text, text, length);
    s->node = (ssfr_yaml_node){.tree = tree, .line = line, .column = column, .key = key, .text = text ? s->text : NULL,
                               .name = key ? key->text : parent ? parent->name : tree->root_name};
    s->next = tree->all;
    tree->all = s;
    *out = &s->node;
    if (text && strlen(s->text) != length)
        result = ssfr_yaml_fail(*out, SSFR_ERR_FORMAT, "%.80s: a zero byte in the value", s->node.name);
end:
    return result;
}

/* Doubles at powers of two. */
static ssfr_result grow(ssfr_yaml_node ***array, size_t n)
{
    if (n & (n - 1)) return SSFR_OK;
    ssfr_yaml_node **bigger = realloc(*array, 2 * (n ? n : 1) * sizeof *bigger);
    if (!bigger) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %zu values of YAML", n);
    *array = bigger;
    return SSFR_OK;
}

static ssfr_result add_key(const ssfr_yaml_node *map, ssfr_yaml_node *key)
{
    if (key->kind != SSFR_YAML_TEXT || !key->text)
        return ssfr_yaml_fail(key, SSFR_ERR_FORMAT, "%.80s: expected one value as a key", map->name);
    for (size_t i = 0; i < map->n; i++)
        if (strcmp(map->keys[i]->text, key->text) == 0)
            return ssfr_yaml_fail(key, SSFR_ERR_FORMAT, "%.80s stands twice", key->text);
    if (map->n == SSFR_YAML_KEYS)
        return ssfr_yaml_fail(key, SSFR_ERR_FORMAT, "%.80s: more than %d keys", map->name, SSFR_YAML_KEYS);
    return SSFR_OK;
}

/* Puts a node where it belongs: it is the root, a list's next item, a map's next key or the value of that. */
static ssfr_result attach(builder *b, ssfr_yaml_node *node)
{
    ssfr_result result = SSFR_OK;
    ssfr_yaml_node *parent = b->depth ? b->open[b->depth - 1].node : NULL,
                   **key = b->depth ? &b->open[b->depth - 1].key : NULL;
    if (!parent) {
        b->tree->root = node;
    } else if (parent->kind == SSFR_YAML_MAP && !*key) {
        SSFR_TRY(add_key(parent, node));
        *key = node;
    } else {
        SSFR_TRY(grow(&parent->values, parent->n));
        if (*key) SSFR_TRY(grow(&parent->keys, parent->n));
        if (*key) parent->keys[parent->n] = *key;
        parent->values[parent->n++] = node;
        *key = NULL;
    }
end:
    return result;
}

static ssfr_result open_node(builder *b, ssfr_yaml_node *node, ssfr_yaml_kind kind)
{
    ssfr_result result = SSFR_OK;
    node->kind = kind;
    SSFR_TRY(attach(b, node));
    if (b->depth == MAX_DEPTH)
        return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "lists and maps in each other more than %d deep", MAX_DEPTH);
    b->open[b->depth].node = node;
    b->open[b->depth++].key = NULL;
end:
    return result;
}

static ssfr_result add_anchor(builder *b, const yaml_char_t *name, const ssfr_yaml_node *node)
{
    ssfr_result result = SSFR_OK;
    if (!name) return SSFR_OK;
    if (b->n_anchors == MAX_ANCHORS)
        return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "more than %d anchors", MAX_ANCHORS);
    SSFR_TRY(ssfr_text_print(&b->anchors[b->n_anchors].name, "an anchor", "%s", (const char *)name));
    b->anchors[b->n_anchors++].node = node;
end:
    return result;
}

/* An alias takes its anchor's content when the tree is complete. */
static ssfr_result add_alias(builder *b, const yaml_event_t *event)
{
    ssfr_result result = SSFR_OK;
    const char *name = (const char *)event->data.alias.anchor;
    ssfr_yaml_node *node = NULL;
    int at = b->n_anchors - 1; /* the last of a name is meant */
    while (at >= 0 && strcmp(b->anchors[at].name, name) != 0) at--;
    SSFR_TRY(new_node(b, event, NULL, 0, &node));
    if (at < 0) return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "found undefined alias *%.80s", name);
    ((stored *)node)->alias = b->anchors[at].node;
    result = attach(b, node);
end:
    return result;
}

static ssfr_result add_scalar(builder *b, const yaml_event_t *event)
{
    ssfr_result result = SSFR_OK;
    ssfr_yaml_node *node = NULL;
    SSFR_TRY(new_node(b, event, (const char *)event->data.scalar.value, event->data.scalar.length, &node));
    SSFR_TRY(add_anchor(b, event->data.scalar.anchor, node));
    result = attach(b, node);
end:
    return result;
}

static ssfr_result add_collection(builder *b, const yaml_event_t *event, const yaml_char_t *anchor,
                                  ssfr_yaml_kind kind)
{
    ssfr_result result = SSFR_OK;
    ssfr_yaml_node *node = NULL;
    SSFR_TRY(new_node(b, event, NULL, 0, &node));
    SSFR_TRY(add_anchor(b, anchor, node));
    result = open_node(b, node, kind);
end:
    return result;
}

static ssfr_result add_event(builder *b, const yaml_event_t *event)
{
    switch (event->type) {
    case YAML_SCALAR_EVENT: return add_scalar(b, event);
    case YAML_ALIAS_EVENT: return add_alias(b, event);
    case YAML_SEQUENCE_START_EVENT: return add_collection(b, event, event->data.sequence_start.anchor, SSFR_YAML_LIST);
    case YAML_MAPPING_START_EVENT: return add_collection(b, event, event->data.mapping_start.anchor, SSFR_YAML_MAP);
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT: b->depth--; return SSFR_OK;
    default: return SSFR_OK; /* begins and ends of stream and document */
    }
}

/* Reads all events. What follows a first document would be ignored: it is an error. */
static ssfr_result build(builder *b, const char *text)
{
    ssfr_result result = SSFR_OK;
    for (bool ended = false; result == SSFR_OK && !ended;) {
        yaml_event_t event;
        if (!yaml_parser_parse(&b->parser, &event)) return fail_yaml(b, text);
        ended = event.type == YAML_STREAM_END_EVENT;
        if (b->tree->root && b->depth == 0 && event.type != YAML_DOCUMENT_START_EVENT &&
            event.type != YAML_DOCUMENT_END_EVENT && !ended)
            result = ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu:%zu: a second document, a %s has one", b->tree->path,
                               event.start_mark.line + 1, event.start_mark.column + 1, b->tree->what);
        else
            result = add_event(b, &event);
        yaml_event_delete(&event);
    }
    if (result == SSFR_OK && !b->tree->root)
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s:1:1: an empty file, expected a map of key: value", b->tree->path);
    return result;
}

static void resolve_aliases(ssfr_yaml *tree)
{
    for (stored *s = tree->all; s; s = s->next) {
        if (!s->alias) continue;
        s->node.kind = s->alias->kind;
        s->node.text = s->alias->text;
        s->node.n = s->alias->n;
        s->node.keys = s->alias->keys;
        s->node.values = s->alias->values;
    }
}

ssfr_result ssfr_yaml_copy(char **out, const char *before, const char *text)
{
    return ssfr_text_print(out, "a text", "%s%s", before, text);
}

static ssfr_result new_tree(ssfr_yaml **out, const char *path, const char *what)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_alloc(out, 1, sizeof **out, "YAML"));
    SSFR_TRY(ssfr_yaml_copy(&(*out)->path, "", path));
    SSFR_TRY(ssfr_yaml_copy(&(*out)->what, "", what));
    SSFR_TRY(ssfr_yaml_copy(&(*out)->root_name, "the ", what));
end:
    return result;
}

ssfr_result ssfr_yaml_parse(ssfr_yaml **out, const char *path, const char *what, const char *text, size_t size)
{
    ssfr_result result = SSFR_OK;
    builder b = {0};
    *out = NULL;
    if (size > SSFR_YAML_FILE)
        return ssfr_fail(SSFR_ERR_VALUE, "%s:1:1: %zu bytes, a %s has at most %d", path, size, what, SSFR_YAML_FILE);
    if (!yaml_parser_initialize(&b.parser))
        return ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for a YAML parser", path);
    const size_t mark = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0; /* of byte order: UTF-8 it must be */
    text += mark;
    yaml_parser_set_input_string(&b.parser, (const unsigned char *)text, size - mark);
    yaml_parser_set_encoding(&b.parser, YAML_UTF8_ENCODING);
    SSFR_TRY(new_tree(&b.tree, path, what));
    SSFR_TRY(build(&b, text));
    resolve_aliases(b.tree);
    *out = b.tree;
    b.tree = NULL;
end:
    for (int i = 0; i < b.n_anchors; i++) free(b.anchors[i].name);
    yaml_parser_delete(&b.parser);
    ssfr_yaml_destroy(&b.tree);
    return result;
}

void ssfr_yaml_destroy(ssfr_yaml **tree)
{
    ssfr_yaml *t = *tree;
    if (!t) return;
    for (stored *s = t->all, *next; s; s = next) {
        next = s->next;
        if (!s->alias) free(s->node.keys);
        if (!s->alias) free(s->node.values);
        free(s);
    }
    free(t->path);
    free(t->what);
    free(t->root_name);
    free(t);
    *tree = NULL;
}

const ssfr_yaml_node *ssfr_yaml_root(const ssfr_yaml *tree)
{
    return tree->root;
}

/* ---- maps by rows ------------------------------------------------------------------------------------------------ */

static ssfr_result fail_unknown(const ssfr_yaml_node *map, const ssfr_yaml_node *key, const char *list)
{
    if (map == map->tree->root)
        return ssfr_yaml_fail(key, SSFR_ERR_FORMAT, "no key %.80s: a %s has %s", key->text, map->tree->what, list);
    return ssfr_yaml_fail(key, SSFR_ERR_FORMAT, "%.80s: no key %.80s: it has %s", map->name, key->text, list);
}

static ssfr_result fail_no_row(const ssfr_yaml_node *map, const ssfr_yaml_node *key, const ssfr_yaml_row *rows)
{
    char list[400] = "";
    size_t used = 0;
    for (const ssfr_yaml_row *row = rows; row->name; row++) ssfr_list_name(list, sizeof list, &used, row->name);
    return fail_unknown(map, key, list);
}

const ssfr_yaml_node *ssfr_yaml_find(const ssfr_yaml_node *map, const char *name)
{
    const ssfr_yaml_node *found = NULL;
    for (size_t i = 0; i < map->n && !found; i++)
        if (strcmp(map->keys[i]->text, name) == 0) found = map->values[i];
    return found;
}

ssfr_result ssfr_yaml_read_map(const ssfr_yaml_node *node, const ssfr_yaml_row *rows, void *to)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_MAP));
    for (size_t i = 0; i < node->n; i++) {
        const ssfr_yaml_row *row = rows;
        while (row->name && strcmp(row->name, node->keys[i]->text) != 0) row++;
        if (!row->name) return fail_no_row(node, node->keys[i], rows);
        SSFR_TRY(row->read(node->values[i], row, (char *)to + row->offset));
    }
    for (const ssfr_yaml_row *row = rows; row->name; row++)
        if (row->needed && !ssfr_yaml_find(node, row->name))
            return ssfr_yaml_fail(ssfr_yaml_head(node), SSFR_ERR_FORMAT, "%.80s: %s must be given", node->name,
                                  row->name);
end:
    return result;
}

/* ---- readers ----------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_yaml_read_node(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    (void)row;
    *(const ssfr_yaml_node **)to = node;
    return SSFR_OK;
}

ssfr_result ssfr_yaml_read_text(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    char **text = to;
    (void)row;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_TEXT));
    free(*text);
    *text = NULL;
    result = ssfr_yaml_copy(text, "", node->text);
end:
    return result;
}

ssfr_result ssfr_yaml_read_real(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    double value = 0;
    ssfr_plain plain = ssfr_plain_begin();
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_TEXT));
    if (!ssfr_parse_number(node->text, &value))
        result = ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%.80s: \"%.80s\" is not a finite number", node->name,
                                node->text);
    else if ((row->min != 0 || row->max != 0) && (value < row->min || value > row->max))
        result = ssfr_yaml_fail(node, SSFR_ERR_VALUE, "%.80s: %.80s is out of range [%g, %g]%s%s", node->name,
                                node->text, row->min, row->max, row->unit ? " " : "",
                                row->unit ? row->unit : "");
    else
        *(double *)to = value;
end:
    ssfr_plain_end(&plain);
    return result;
}

static ssfr_result read_reals(const ssfr_yaml_node *node, const ssfr_yaml_row *row, double *to, size_t n)
{
    ssfr_result result = SSFR_OK;
    if (node->kind != SSFR_YAML_LIST || node->n != n)
        return ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%.80s: expected a list of %zu numbers", node->name, n);
    for (size_t i = 0; i < n; i++) SSFR_TRY(ssfr_yaml_read_real(node->values[i], row, to + i));
end:
    return result;
}

ssfr_result ssfr_yaml_read_real2(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    return read_reals(node, row, to, 2);
}

ssfr_result ssfr_yaml_read_real3(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    return read_reals(node, row, to, 3);
}

ssfr_result ssfr_yaml_read_count(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    double value = 0;
    SSFR_TRY(ssfr_yaml_read_real(node, row, &value));
    if (value < 0 || value != floor(value) || value > 9007199254740992.0) /* 2^53, beyond which not all are doubles */
        result = ssfr_yaml_fail(node, SSFR_ERR_VALUE, "%.80s: %.80s is not a whole number", node->name, node->text);
    else
        *(size_t *)to = (size_t)value;
end:
    return result;
}

ssfr_result ssfr_yaml_read_flag(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    static const char *const words[] = {"false", "true", "off", "on", "no", "yes"};
    ssfr_result result = SSFR_OK;
    size_t at = 0;
    (void)row;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_TEXT));
    while (at < SSFR_COUNT(words) && strcmp(words[at], node->text) != 0) at++;
    if (at == SSFR_COUNT(words))
        result = ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%.80s: \"%.80s\" is neither true nor false", node->name,
                                node->text);
    else
        *(bool *)to = at % 2 != 0;
end:
    return result;
}

ssfr_result ssfr_yaml_read_word(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    char list[200] = "";
    size_t used = 0;
    int at = 0;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_TEXT));
    for (; row->words[at] && strcmp(row->words[at], node->text) != 0; at++)
        ssfr_list_name(list, sizeof list, &used, row->words[at]);
    if (row->words[at])
        *(int *)to = at;
    else
        result = ssfr_yaml_fail(node, SSFR_ERR_VALUE, "%.80s: \"%.80s\" is none of %s", node->name, node->text, list);
end:
    return result;
}

ssfr_result ssfr_yaml_read_words(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    bool *there = to;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_LIST));
    for (size_t i = 0; i < node->n; i++) {
        int word = 0;
        SSFR_TRY(ssfr_yaml_read_word(node->values[i], row, &word));
        if (there[word])
            return ssfr_yaml_fail(node->values[i], SSFR_ERR_FORMAT, "%.80s: %s stands twice", node->name,
                                  row->words[word]);
        there[word] = true;
    }
end:
    return result;
}

static ssfr_result fail_no_param(const ssfr_yaml_node *map, const ssfr_yaml_node *key, const ssfr_param *params)
{
    char list[400] = "";
    size_t used = 0;
    for (const ssfr_param *param = params; param->name; param++) ssfr_list_name(list, sizeof list, &used, param->name);
    return fail_unknown(map, key, list);
}

ssfr_result ssfr_yaml_read_param(const ssfr_yaml_node *value, const char *name, const ssfr_param *param, void *to)
{
    ssfr_result result = SSFR_OK;
    char place[SSFR_YAML_PLACE], about[SSFR_YAML_PLACE + 200];
    SSFR_TRY(ssfr_yaml_expect(value, SSFR_YAML_TEXT));
    snprintf(about, sizeof about, "%s: %.160s", ssfr_yaml_place(value, place), name);
    result = ssfr_param_set(param, to, about, value->text);
end:
    return result;
}

ssfr_result ssfr_yaml_read_params(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_MAP));
    for (size_t i = 0; i < node->n; i++) {
        const ssfr_param *param = ssfr_param_find(row->params, node->keys[i]->text);
        char name[160];
        if (!param) return fail_no_param(node, node->keys[i], row->params);
        snprintf(name, sizeof name, "%.80s.%s", node->name, param->name);
        SSFR_TRY(ssfr_yaml_read_param(node->values[i], name, param, to));
    }
end:
    return result;
}

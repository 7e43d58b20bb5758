/* SPDX-License-Identifier: GPL-3.0-or-later */
/* claims.c: reading claims, holding them to tables, and writing what came of them. */
#include "experiments/claims.h"
#include "experiments/yaml_tree.h"

#include <unistd.h>

enum { MOST_PATH = 4096, MOST_TABLES = 64 };

static const char *const columns[] = {"claim",    "paper", "where", "statement", "published",
                                      "measured", "unit",  "rule",  "holds",     "note"};
enum { N_COLUMNS = SSFR_COUNT(columns), PAPER = 1 };

/* ---- reading ----------------------------------------------------------------------------------------------------- */

/* Where the rule's text begins in the file, behind its quote. Where it is folded or has escapes, columns count from
 * there all the same. */
static ssfr_text_place place_of(const ssfr_yaml_node *rule, const char *path, const char *text)
{
    const char *line = text;
    for (size_t i = 1; i < rule->line; i++) line += strcspn(line, "\n") + 1;
    const char first = line[rule->column - 1];
    return (ssfr_text_place){path, rule->line, rule->column + (first == '"' || first == '\'')};
}

static ssfr_result read_claim(const ssfr_yaml_node *node, ssfr_claim *claim, const char *path, const char *text)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("id", ssfr_yaml_read_text, ssfr_claim, id, .needed = true),
        SSFR_YAML_ROW("where", ssfr_yaml_read_text, ssfr_claim, where, .needed = true),
        SSFR_YAML_ROW("statement", ssfr_yaml_read_text, ssfr_claim, statement, .needed = true),
        SSFR_YAML_ROW("published", ssfr_yaml_read_text, ssfr_claim, published),
        SSFR_YAML_ROW("unit", ssfr_yaml_read_text, ssfr_claim, unit),
        SSFR_YAML_ROW("rule", ssfr_yaml_read_text, ssfr_claim, rule, .needed = true),
        SSFR_YAML_ROW("note", ssfr_yaml_read_text, ssfr_claim, note),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_yaml_read_map(node, rows, claim));
    const ssfr_text_place place = place_of(ssfr_yaml_find(node, "rule"), path, text);
    SSFR_TRY(ssfr_expression_parse(&claim->expression, claim->rule, &place));
end:
    return result;
}

static ssfr_result read_claims(ssfr_claims *c, const ssfr_yaml_node *root, const char *path, const char *text)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_yaml_expect(root, SSFR_YAML_LIST));
    SSFR_TRY(ssfr_alloc(&c->claims, root->n, sizeof *c->claims, "claims"));
    for (c->n = 0; c->n < root->n; c->n++) {
        ssfr_claim *claim = &c->claims[c->n];
        result = read_claim(root->values[c->n], claim, path, text);
        for (size_t i = 0; i < c->n && result == SSFR_OK; i++)
            if (strcmp(c->claims[i].id, claim->id) == 0)
                result = ssfr_yaml_fail(root->values[c->n], SSFR_ERR_FORMAT, "the id %.80s stands twice", claim->id);
        if (result != SSFR_OK) {
            c->n++; /* counted even when it is refused, so that it is freed */
            goto end;
        }
    }
end:
    return result;
}

ssfr_result ssfr_claims_parse(ssfr_claims **out, const char *paper, const char *path, const char *text, size_t size)
{
    ssfr_result result = SSFR_OK;
    ssfr_claims *c = NULL;
    ssfr_yaml *tree = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&c, 1, sizeof *c, "claims"));
    SSFR_TRY(ssfr_yaml_copy(&c->paper, "", paper));
    SSFR_TRY(ssfr_yaml_parse(&tree, path, "list of claims", text, size));
    SSFR_TRY(read_claims(c, ssfr_yaml_root(tree), path, text));
    *out = c;
    c = NULL;
end:
    ssfr_yaml_destroy(&tree);
    ssfr_claims_destroy(&c);
    return result;
}

void ssfr_claims_destroy(ssfr_claims **claims)
{
    ssfr_claims *c = *claims;
    for (size_t i = 0; c && i < c->n; i++) {
        ssfr_claim *claim = &c->claims[i];
        char *const texts[] = {claim->id,   claim->where, claim->statement, claim->published,
                               claim->unit, claim->rule,  claim->note};
        for (size_t k = 0; k < SSFR_COUNT(texts); k++) free(texts[k]);
        ssfr_expression_destroy(&claim->expression);
    }
    if (c) free(c->claims), free(c->paper);
    free(c);
    *claims = NULL;
}

/* ---- judging ----------------------------------------------------------------------------------------------------- */

typedef struct shelf { /* tables that were read */
    const char *folder, *paper;
    int n;
    struct {
        const char *name;
        ssfr_csv_table *table; /* NULL: there is none */
    } tables[MOST_TABLES];
} shelf;

static ssfr_result find_table(void *user, const char *name, const ssfr_csv_table **out)
{
    shelf *s = user;
    char path[MOST_PATH];
    ssfr_result result = SSFR_OK;
    *out = NULL;
    for (int i = 0; i < s->n; i++)
        if (strcmp(s->tables[i].name, name) == 0) {
            *out = s->tables[i].table;
            return SSFR_OK;
        }
    if (s->n == MOST_TABLES)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: claims ask for more than %d tables", s->paper, MOST_TABLES);
    s->tables[s->n].name = name;
    snprintf(path, sizeof path, "%s/%s/%s.csv", s->folder, s->paper, name);
    if (access(path, F_OK) == 0) SSFR_TRY(ssfr_csv_load(&s->tables[s->n].table, path));
    *out = s->tables[s->n++].table;
end:
    return result;
}

ssfr_result ssfr_claims_judge(ssfr_claims *claims, const char *folder)
{
    ssfr_result result = SSFR_OK;
    shelf s = {.folder = folder, .paper = claims->paper};
    const ssfr_table_source source = {find_table, &s};
    for (size_t i = 0; i < claims->n; i++)
        SSFR_TRY(ssfr_expression_judge(claims->claims[i].expression, &source, &claims->claims[i].verdict));
end:
    for (int i = 0; i < s.n; i++) ssfr_csv_table_destroy(&s.tables[i].table);
    return result;
}

const char *ssfr_claim_holds(const ssfr_claim *claim)
{
    return !claim->verdict.measured ? "not measured" : claim->verdict.holds ? "yes" : "no";
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

/* What is to be known of a claim, and of this measurement. */
static void write_note(const ssfr_claim *claim, char *text, size_t size)
{
    const ssfr_verdict *v = &claim->verdict;
    char about[400] = "";
    if (!v->measured)
        snprintf(about, sizeof about, "not measured: %s", v->why);
    else if (!v->constant)
        snprintf(about, sizeof about, "compared with %.4g", v->right);
    const size_t used = strlen(about);
    if (v->measured && v->left_out)
        snprintf(about + used, sizeof about - used, "%smissing values left out: %zu", used ? "; " : "",
                 v->left_out);
    snprintf(text, size, "%s%s%s", claim->note ? claim->note : "", claim->note && about[0] ? "; " : "", about);
}

static ssfr_result write_claim(ssfr_csv *csv, const char *paper, const ssfr_claim *claim)
{
    ssfr_result result = SSFR_OK;
    char note[4096], measured[32] = "";
    if (claim->verdict.measured) snprintf(measured, sizeof measured, "%.4g", claim->verdict.left);
    write_note(claim, note, sizeof note);
    const char *const cells[N_COLUMNS] = {claim->id, paper, claim->where, claim->statement,
                                          claim->published ? claim->published : "", measured,
                                          claim->unit ? claim->unit : "1", claim->rule, ssfr_claim_holds(claim), note};
    for (int i = 0; i < N_COLUMNS; i++) SSFR_TRY(ssfr_csv_text(csv, cells[i]));
    SSFR_TRY(ssfr_csv_end_row(csv));
end:
    return result;
}

static ssfr_result write_claims(ssfr_csv *csv, const ssfr_claims *claims)
{
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < claims->n && result == SSFR_OK; i++)
        result = write_claim(csv, claims->paper, &claims->claims[i]);
    return result;
}

/* The new rows stand where the first of the old ones stood, or at the end. */
static ssfr_result write_table(ssfr_csv *csv, const ssfr_csv_table *before, const ssfr_claims *claims)
{
    ssfr_result result = SSFR_OK;
    bool written = false;
    for (size_t row = 0; before && row < before->n_rows; row++) {
        const bool own = strcmp(ssfr_csv_cell(before, row, PAPER), claims->paper) == 0;
        if (own && !written) SSFR_TRY(write_claims(csv, claims));
        written |= own;
        for (int i = 0; i < N_COLUMNS && !own; i++) SSFR_TRY(ssfr_csv_text(csv, ssfr_csv_cell(before, row, i)));
        if (!own) SSFR_TRY(ssfr_csv_end_row(csv));
    }
    if (!written) SSFR_TRY(write_claims(csv, claims));
end:
    return result;
}

static ssfr_result load_before(ssfr_csv_table **out, const char *path)
{
    ssfr_result result = SSFR_OK;
    *out = NULL;
    if (access(path, F_OK) != 0) return SSFR_OK;
    SSFR_TRY(ssfr_csv_load(out, path));
    bool same = (*out)->n_columns == N_COLUMNS;
    for (int i = 0; i < N_COLUMNS && same; i++) same = strcmp((*out)->cells[i], columns[i]) == 0;
    if (!same && (*out)->n_columns > 0) result = ssfr_fail(SSFR_ERR_FORMAT, "%s: is no table of claims", path);
end:
    return result;
}

ssfr_result ssfr_claims_save(const ssfr_claims *claims, const char *folder)
{
    ssfr_result result = SSFR_OK;
    ssfr_csv_table *before = NULL;
    ssfr_csv *csv = NULL;
    ssfr_aside aside = {0};
    char path[MOST_PATH];
    snprintf(path, sizeof path, "%s/claims.csv", folder);
    SSFR_TRY(load_before(&before, path));
    SSFR_TRY(ssfr_aside_begin(&aside, path));
    SSFR_TRY(ssfr_csv_create(&csv, aside.temporary, N_COLUMNS, columns, N_COLUMNS, false));
    SSFR_TRY(write_table(csv, before, claims));
end:
    ssfr_csv_destroy(&csv);
    result = ssfr_aside_end(&aside, result);
    ssfr_csv_table_destroy(&before);
    return result;
}

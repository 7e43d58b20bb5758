/* SPDX-License-Identifier: GPL-3.0-or-later */
/* published.c: reading a paper's table and finding the partner of a row in it. */
#include "experiments/published.h"
#include "experiments/hash.h"

enum { MOST_FILE = 1 << 20, MOST_PATH = 4096 }; /* bytes */

static bool same(const char *a, const char *b)
{
    double x, y;
    return strcmp(a, b) == 0 || (ssfr_parse_number(a, &x) && ssfr_parse_number(b, &y) && x == y);
}

static bool row_has(const ssfr_published *p, size_t row, const char *const *cells)
{
    bool all = true;
    for (int i = 0; i < p->spec->n_on && all; i++) all = same(ssfr_csv_cell(p->table, row, p->on[i]), cells[i]);
    return all;
}

const char *ssfr_published_find(const ssfr_published *p, const char *const *cells)
{
    const char *found = "";
    for (size_t row = 0; row < p->table->n_rows && !found[0]; row++)
        if (row_has(p, row, cells)) found = ssfr_csv_cell(p->table, row, p->column);
    return found;
}

/* A second row of the same cells would never be found. */
static ssfr_result check_rows(const ssfr_published *p, const char *path)
{
    for (size_t row = 0; row < p->table->n_rows; row++) {
        const char *cells[SSFR_MAX_ON];
        for (int i = 0; i < p->spec->n_on; i++) cells[i] = ssfr_csv_cell(p->table, row, p->on[i]);
        for (size_t before = 0; before < row; before++)
            if (row_has(p, before, cells))
                return ssfr_fail(SSFR_ERR_FORMAT, "%s: published: rows %zu and %zu of %s have the same %s",
                                 p->spec->where, before + 1, row + 1, path, p->spec->on[0]);
    }
    return SSFR_OK;
}

static ssfr_result find_column(const ssfr_published *p, const char *path, const char *name, int *out)
{
    *out = ssfr_csv_column(p->table, name);
    if (*out >= 0) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: published: %s has no column %s", p->spec->where, path, name);
}

ssfr_result ssfr_published_parse(ssfr_published **out, const ssfr_published_spec *spec, const char *path,
                                 const char *text, size_t size)
{
    ssfr_result result = SSFR_OK;
    ssfr_published *p = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&p, 1, sizeof *p, "published numbers"));
    p->spec = spec;
    snprintf(p->header, sizeof p->header, "published_%s", spec->column);
    SSFR_TRY(ssfr_csv_parse(&p->table, path, text, size));
    if (p->table->whole < size) { /* a sweep's table may be torn, a paper's is whole */
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: the last line does not end", path);
        goto end;
    }
    SSFR_TRY(find_column(p, path, spec->column, &p->column));
    for (int i = 0; i < spec->n_on; i++) SSFR_TRY(find_column(p, path, spec->on[i], &p->on[i]));
    SSFR_TRY(check_rows(p, path));
    *out = p;
    p = NULL;
end:
    ssfr_published_destroy(&p);
    return result;
}

ssfr_result ssfr_published_load(ssfr_published **out, const ssfr_published_spec *spec, const char *sweep)
{
    ssfr_result result = SSFR_OK;
    const char *slash = strrchr(sweep, '/');
    char path[MOST_PATH], *text = NULL;
    size_t size;
    *out = NULL;
    snprintf(path, sizeof path, "%.*spublished/%s", slash ? (int)(slash + 1 - sweep) : 0, sweep, spec->file);
    SSFR_TRY(ssfr_read_file(path, MOST_FILE, &text, &size));
    SSFR_TRY(ssfr_published_parse(out, spec, path, text, size));
end:
    free(text);
    return result;
}

void ssfr_published_destroy(ssfr_published **published)
{
    if (*published) ssfr_csv_table_destroy(&(*published)->table);
    free(*published);
    *published = NULL;
}

uint64_t ssfr_published_hash(const ssfr_published *p, uint64_t hash)
{
    hash = ssfr_hash_text(hash, p->header);
    for (int i = 0; i < p->spec->n_on; i++)
        hash = ssfr_hash_text(ssfr_hash_text(hash, p->spec->on[i]), p->spec->with[i]);
    for (size_t i = 0; i < (p->table->n_rows + 1) * (size_t)p->table->n_columns; i++)
        hash = ssfr_hash_text(hash, p->table->cells[i]);
    return hash;
}

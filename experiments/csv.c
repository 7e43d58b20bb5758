/* SPDX-License-Identifier: GPL-3.0-or-later */
/* csv.c: tables after RFC 4180: read whole, written row by row, resumed after a kill. */
#include "experiments/csv.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAX_FILE = 1 << 30 /* bytes of a table that is read back */,
       KEEP = 1 /* s: rows that come quicker are waited for together, which takes as long as for one */ };

/* ---- reading: cells are unquoted in place, so each ends no later than it began ----------------------------------- */

typedef struct reader {
    const char *path;
    char *text;
    size_t size, at; /* bytes */
    size_t line;     /* of the record being read, from 1 */
    size_t n_cells, capacity;
    char **cells;
} reader;

typedef enum record_end { RECORD_WHOLE, RECORD_TORN, RECORD_BAD } record_end;

static ssfr_result add_cell(reader *r, char *cell)
{
    if (r->n_cells == r->capacity) {
        const size_t capacity = r->capacity ? 2 * r->capacity : 256;
        char **cells = realloc(r->cells, capacity * sizeof *cells);
        if (!cells) return ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for %zu cells", r->path, capacity);
        r->cells = cells;
        r->capacity = capacity;
    }
    r->cells[r->n_cells++] = cell;
    return SSFR_OK;
}

/* Moves the inside of a quoted cell to its front. False when the text ends first. */
static bool unquote(reader *r, char **to)
{
    for (r->at++; r->at < r->size; r->at++) {
        if (r->text[r->at] == '"' && r->text[r->at + 1] != '"') break;
        if (r->text[r->at] == '"') r->at++;
        if (r->text[r->at] == '\n') r->line++;
        *(*to)++ = r->text[r->at];
    }
    return r->at++ < r->size;
}

/* Reads one cell and the separator behind it; *separator is '\0' where the text ends. */
static bool read_cell(reader *r, char **cell, char *separator)
{
    char *to = r->text + r->at;
    *cell = to;
    *separator = '\0';
    if (r->text[r->at] == '"') {
        if (!unquote(r, &to)) return true;
    } else {
        r->at += strcspn(r->text + r->at, ",\"\n");
        to = r->text + r->at;
        if (to > *cell && to[-1] == '\r' && *to == '\n') to--;
    }
    if (r->text[r->at] == '\r' && r->text[r->at + 1] == '\n') r->at++;
    *separator = r->text[r->at];
    if (*separator != ',' && *separator != '\n' && r->at < r->size) return false;
    r->at++;
    *to = '\0';
    return true;
}

static ssfr_result read_record(reader *r, record_end *end)
{
    ssfr_result result = SSFR_OK;
    char separator = ',';
    while (separator == ',' && result == SSFR_OK) {
        char *cell;
        if (!read_cell(r, &cell, &separator))
            return ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: expected a comma or the line's end at byte %zu", r->path,
                             r->line, r->at);
        result = add_cell(r, cell);
    }
    *end = separator == '\n' ? RECORD_WHOLE : RECORD_TORN;
    return result;
}

static ssfr_result read_records(reader *r, ssfr_csv_table *table)
{
    ssfr_result result = SSFR_OK;
    record_end end = RECORD_WHOLE;
    while (end == RECORD_WHOLE && r->at < r->size) {
        const size_t first = r->n_cells;
        r->line++;
        SSFR_TRY(read_record(r, &end));
        if (end == RECORD_TORN) break;
        if (first == 0) table->n_columns = (int)r->n_cells;
        if (r->n_cells - first != (size_t)table->n_columns) {
            result = ssfr_fail(SSFR_ERR_FORMAT, "%s:%zu: %zu cells, the header has %d", r->path, r->line,
                               r->n_cells - first, table->n_columns);
            goto end;
        }
        if (first) table->n_rows++;
        table->whole = r->at;
    }
end:
    return result;
}

/* Takes over the text. */
static ssfr_result read_table(ssfr_csv_table **out, const char *path, char *text, size_t size)
{
    ssfr_result result = SSFR_OK;
    ssfr_csv_table *table = NULL;
    reader r = {.path = path, .text = text, .size = size};
    SSFR_TRY(ssfr_alloc(&table, 1, sizeof *table, "a table"));
    table->text = text;
    text = NULL;
    if (strlen(r.text) != r.size) {
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: a zero byte at byte %zu: not a CSV file", path, strlen(r.text));
        goto end;
    }
    result = read_records(&r, table);
    table->cells = r.cells;
    if (result == SSFR_OK) {
        *out = table;
        table = NULL;
    }
end:
    free(text);
    ssfr_csv_table_destroy(&table);
    return result;
}

ssfr_result ssfr_csv_parse(ssfr_csv_table **out, const char *path, const char *text, size_t size)
{
    ssfr_result result = SSFR_OK;
    char *copy = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&copy, size + 1, 1, "a table's text"));
    memcpy(copy, text, size);
    SSFR_TRY(read_table(out, path, copy, size));
end:
    return result;
}

ssfr_result ssfr_csv_load(ssfr_csv_table **out, const char *path)
{
    ssfr_result result = SSFR_OK;
    char *text = NULL;
    size_t size;
    *out = NULL;
    SSFR_TRY(ssfr_read_file(path, MAX_FILE, &text, &size));
    SSFR_TRY(read_table(out, path, text, size));
end:
    return result;
}

void ssfr_csv_table_destroy(ssfr_csv_table **table)
{
    if (*table) {
        free((*table)->cells);
        free((*table)->text);
    }
    free(*table);
    *table = NULL;
}

const char *ssfr_csv_cell(const ssfr_csv_table *table, size_t row, int column)
{
    assert(row < table->n_rows && column >= 0 && column < table->n_columns);
    return table->cells[(row + 1) * (size_t)table->n_columns + (size_t)column];
}

bool ssfr_csv_same_cells(const ssfr_csv_table *table, size_t a, size_t b, int n)
{
    bool same = true;
    for (int i = 0; i < n && same; i++) same = strcmp(ssfr_csv_cell(table, a, i), ssfr_csv_cell(table, b, i)) == 0;
    return same;
}

double ssfr_csv_cell_number(const ssfr_csv_table *table, size_t row, int column)
{
    const char *text = ssfr_csv_cell(table, row, column);
    char *end = NULL;
    const double value = strtod(text, &end);
    return end != text && *end == '\0' ? value : NAN;
}

bool ssfr_csv_is_column(const char *header, const char *name)
{
    const size_t length = strlen(name);
    return strncmp(header, name, length) == 0 && (header[length] == '\0' || strncmp(header + length, " [", 2) == 0);
}

int ssfr_csv_column(const ssfr_csv_table *table, const char *name)
{
    int found = -1;
    for (int i = 0; i < table->n_columns && found < 0; i++)
        if (ssfr_csv_is_column(table->cells[i], name)) found = i;
    return found;
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

struct ssfr_csv {
    char *path; /* for messages */
    int fd;
    bool regular; /* a file, not a pipe or a terminal */
    bool written; /* since it was last waited for */
    double kept;  /* s, on ssfr_clock: when all of it was last on the disk */
    int n_columns, n_keys;
    int n_cells; /* of the row in progress */
    char *row;
    size_t used, capacity;    /* bytes of row */
    ssfr_csv_table *before;   /* the rows of the file that is resumed, or NULL */
    size_t next;              /* where the next row of `before` is expected */
};

static ssfr_result append(ssfr_csv *csv, const char *text, size_t length)
{
    if (csv->used + length >= csv->capacity) {
        const size_t capacity = 2 * (csv->used + length) + 256;
        char *row = realloc(csv->row, capacity);
        if (!row) return ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for a row of %zu bytes", csv->path, capacity);
        csv->row = row;
        csv->capacity = capacity;
    }
    memcpy(csv->row + csv->used, text, length);
    csv->used += length;
    return SSFR_OK;
}

static ssfr_result append_quoted(ssfr_csv *csv, const char *text)
{
    ssfr_result result = append(csv, "\"", 1);
    for (const char *at = text; *at && result == SSFR_OK; at++)
        result = *at == '"' ? append(csv, "\"\"", 2) : append(csv, at, 1);
    return result == SSFR_OK ? append(csv, "\"", 1) : result;
}

ssfr_result ssfr_csv_text(ssfr_csv *csv, const char *text)
{
    const bool quoted = text[strcspn(text, ",\"\r\n")] != '\0';
    ssfr_result result = csv->n_cells++ > 0 ? append(csv, ",", 1) : SSFR_OK;
    if (result == SSFR_OK) result = quoted ? append_quoted(csv, text) : append(csv, text, strlen(text));
    return result;
}

ssfr_result ssfr_csv_number(ssfr_csv *csv, double value)
{
    char text[32];
    snprintf(text, sizeof text, "%.9g", value);
    return ssfr_csv_text(csv, isnan(value) ? "NaN" : text);
}

/* Waits until the rows are on the disk. */
static bool keep(ssfr_csv *csv)
{
    const bool ok = !csv->written || fsync(csv->fd) == 0;
    csv->written = false;
    csv->kept = ssfr_clock();
    return ok;
}

/* A row that does not fit on the disk is taken back, so that the file ends in a complete line. */
static ssfr_result write_row(ssfr_csv *csv)
{
    const off_t end = csv->regular ? lseek(csv->fd, 0, SEEK_END) : 0;
    size_t done = 0;
    ssize_t n = 0;
    errno = 0;
    while (done < csv->used && (n >= 0 || errno == EINTR)) {
        n = write(csv->fd, csv->row + done, csv->used - done);
        if (n > 0) done += (size_t)n;
    }
    csv->written = csv->regular;
    if (done == csv->used && (ssfr_clock() < csv->kept + KEEP || keep(csv))) return SSFR_OK;
    const int code = errno;
    if (csv->regular && ftruncate(csv->fd, end) != 0)
        ssfr_log(SSFR_WARNING, "%s: a torn line stays at its end: %s", csv->path, strerror(errno));
    return ssfr_fail(SSFR_ERR_IO, "%s: %s", csv->path, strerror(code));
}

ssfr_result ssfr_csv_end_row(ssfr_csv *csv)
{
    ssfr_result result = SSFR_OK;
    assert(csv->n_cells == csv->n_columns);
    SSFR_TRY(append(csv, "\n", 1));
    SSFR_TRY(write_row(csv));
end:
    csv->n_cells = 0;
    csv->used = 0;
    return result;
}

static ssfr_result check_header(const ssfr_csv *csv, const char *const *columns)
{
    const ssfr_csv_table *t = csv->before;
    for (int i = 0; i < ssfr_max_int(t->n_columns, csv->n_columns); i++) {
        const char *is = i < t->n_columns ? t->cells[i] : "missing", *should = i < csv->n_columns ? columns[i] : "none";
        if (strcmp(is, should) != 0)
            return ssfr_fail(SSFR_ERR_VALUE, "%s: column %d is %s, expected %s: another table, nothing to resume",
                             csv->path, i + 1, is, should);
    }
    return SSFR_OK;
}

/* Only one process may write a table: a second one would cut off rows of the first. A file system without locks has to
 * do without. */
static ssfr_result open_file(ssfr_csv *csv)
{
    struct stat info;
    csv->fd = open(csv->path, O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (csv->fd < 0 || fstat(csv->fd, &info) != 0) return ssfr_fail(SSFR_ERR_IO, "%s: %s", csv->path, strerror(errno));
    csv->regular = S_ISREG(info.st_mode);
    if (csv->regular && flock(csv->fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return ssfr_fail(SSFR_ERR_IO, "%s: another process is writing it", csv->path);
    return SSFR_OK;
}

/* Takes over what a file holds: nothing, or its complete lines. *empty: it needs a header. */
static ssfr_result take_over(ssfr_csv *csv, const char *const *columns, bool resume, bool *empty)
{
    ssfr_result result = SSFR_OK;
    *empty = true;
    if (!csv->regular) return SSFR_OK;
    if (resume) {
        SSFR_TRY(ssfr_csv_load(&csv->before, csv->path));
        *empty = csv->before->n_columns == 0;
        if (!*empty) SSFR_TRY(check_header(csv, columns));
    }
    if (ftruncate(csv->fd, csv->before ? (off_t)csv->before->whole : 0) != 0)
        result = ssfr_fail(SSFR_ERR_IO, "%s: %s", csv->path, strerror(errno));
end:
    return result;
}

ssfr_result ssfr_csv_create(ssfr_csv **out, const char *path, int n_columns, const char *const *columns, int n_keys,
                            bool resume)
{
    ssfr_result result = SSFR_OK;
    ssfr_csv *csv = NULL;
    bool empty = true;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&csv, 1, sizeof *csv, "a table"));
    *csv = (ssfr_csv){.fd = -1, .n_columns = n_columns, .n_keys = n_keys};
    SSFR_TRY(ssfr_text_print(&csv->path, "a path", "%s", path ? path : "standard output"));
    if (path)
        SSFR_TRY(open_file(csv));
    else
        csv->fd = STDOUT_FILENO;
    SSFR_TRY(take_over(csv, columns, resume, &empty));
    for (int i = 0; empty && i < n_columns; i++) SSFR_TRY(ssfr_csv_text(csv, columns[i]));
    if (empty) SSFR_TRY(ssfr_csv_end_row(csv));
    *out = csv;
    csv = NULL;
end:
    ssfr_csv_destroy(&csv);
    return result;
}

void ssfr_csv_destroy(ssfr_csv **csv)
{
    if (*csv) {
        if (!keep(*csv)) ssfr_log(SSFR_WARNING, "%s: %s", (*csv)->path, strerror(errno));
        if ((*csv)->fd > STDERR_FILENO) close((*csv)->fd);
        ssfr_csv_table_destroy(&(*csv)->before);
        free((*csv)->row);
        free((*csv)->path);
    }
    free(*csv);
    *csv = NULL;
}

static bool row_is(const ssfr_csv *csv, size_t row, const char *const *key)
{
    bool same = true;
    for (int k = 0; k < csv->n_keys && same; k++) same = strcmp(ssfr_csv_cell(csv->before, row, k), key[k]) == 0;
    return same;
}

/* Rows come back in the order in which they were written, so the search begins behind the row found last. */
bool ssfr_csv_has(ssfr_csv *csv, const char *const *key)
{
    const size_t n = csv->before ? csv->before->n_rows : 0;
    bool found = false;
    for (size_t i = 0; i < n && !found; i++) {
        const size_t row = (csv->next + i) % n;
        found = row_is(csv, row, key);
        if (found) csv->next = row + 1;
    }
    return found;
}

size_t ssfr_csv_resumed(const ssfr_csv *csv)
{
    return csv->before ? csv->before->n_rows : 0;
}

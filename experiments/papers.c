/* SPDX-License-Identifier: GPL-3.0-or-later */
/* papers.c: finding papers; the build lists those inside the program in paper_files.def: X(number, name, path). */
#include "experiments/papers.h"

#include <dirent.h>
#include <errno.h>
#include <unistd.h>

/* The assembler reads each file, relative to the folder that make runs in. */
#define X(i, name, path)                                                                               \
    __asm__(".pushsection .rodata\npaper_file_" #i "_begin: .incbin \"" path "\"\n"                    \
            "paper_file_" #i "_end: .byte 0\n.popsection\n");                                          \
    extern const char paper_file_##i##_begin[], paper_file_##i##_end[];
#include "paper_files.def"
#undef X

static const struct {
    const char *name, *begin, *end; /* "paper/name.yaml"; its bytes, and a zero byte at end */
} files[] = {
#define X(i, name, path) {name, paper_file_##i##_begin, paper_file_##i##_end},
#include "paper_files.def"
#undef X
};

enum { MOST_FILE = 1 << 20 }; /* bytes */
static const char folder[] = "experiments", ending[] = ".yaml", claims[] = "claims.yaml";

/* ---- the list ---------------------------------------------------------------------------------------------------- */

static ssfr_result copy(char **out, const char *text, size_t length)
{
    return ssfr_text_print(out, "a name", "%.*s", (int)length, text);
}

/* An item, unless the file is the claims or no sweep. */
static ssfr_result add_item(ssfr_paper *paper, const char *file)
{
    ssfr_result result = SSFR_OK;
    const char *dot = strrchr(file, '.');
    if (!dot || dot == file || strcmp(dot, ending) != 0 || strcmp(file, claims) == 0) goto end;
    char **items = realloc(paper->items, (paper->n_items + 1) * sizeof *items);
    if (!items) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %zu items of %s", paper->n_items + 1, paper->name);
    paper->items = items;
    SSFR_TRY(copy(&items[paper->n_items], file, (size_t)(dot - file)));
    paper->n_items++;
end:
    return result;
}

static ssfr_result add_paper(ssfr_papers *papers, const char *name, size_t length, ssfr_paper **out)
{
    ssfr_result result = SSFR_OK;
    ssfr_paper *list = realloc(papers->papers, (papers->n + 1) * sizeof *list);
    if (!list) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %zu papers", papers->n + 1);
    papers->papers = list;
    *out = &list[papers->n];
    **out = (ssfr_paper){0};
    SSFR_TRY(copy(&(*out)->name, name, length));
    papers->n++;
end:
    return result;
}

/* ---- on disk ----------------------------------------------------------------------------------------------------- */

static int is_visible(const struct dirent *entry)
{
    return entry->d_name[0] != '.';
}

static void free_entries(struct dirent **entries, int n)
{
    for (int i = 0; i < n; i++) free(entries[i]);
    if (n >= 0) free(entries);
}

static ssfr_result list_paper(ssfr_papers *papers, const char *name)
{
    ssfr_result result = SSFR_OK;
    char path[SSFR_PAPER_PATH];
    struct dirent **entries = NULL;
    ssfr_paper *paper;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    const int n = scandir(path, &entries, is_visible, alphasort);
    if (n < 0) return ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
    SSFR_TRY(add_paper(papers, name, strlen(name), &paper));
    for (int i = 0; i < n; i++) SSFR_TRY(add_item(paper, entries[i]->d_name));
end:
    free_entries(entries, n);
    return result;
}

/* What cannot be looked into must not be taken for what is not there: then other papers than those here would run. */
static ssfr_result check_absent(const char *path)
{
    return errno == ENOENT || errno == ENOTDIR ? SSFR_OK : ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
}

/* A folder that is not there holds no papers. */
static ssfr_result list_disk(ssfr_papers *papers)
{
    ssfr_result result = SSFR_OK;
    char path[SSFR_PAPER_PATH];
    struct dirent **entries = NULL;
    const int n = scandir(folder, &entries, is_visible, alphasort);
    if (n < 0) SSFR_TRY(check_absent(folder));
    for (int i = 0; i < n; i++) {
        snprintf(path, sizeof path, "%s/%s/%s", folder, entries[i]->d_name, claims);
        SSFR_TRY(access(path, F_OK) == 0 ? list_paper(papers, entries[i]->d_name) : check_absent(path));
    }
    papers->on_disk = papers->n > 0;
end:
    free_entries(entries, n);
    return result;
}

/* ---- inside the program: the build sorts the files, so that those of a paper follow each other ------------------- */

static ssfr_result list_files(ssfr_papers *papers)
{
    ssfr_result result = SSFR_OK;
    ssfr_paper *paper = NULL;
    for (size_t i = 0; i < SSFR_COUNT(files); i++) {
        const size_t length = strcspn(files[i].name, "/");
        const char *file = files[i].name + length + 1;
        if (!paper || strlen(paper->name) != length || strncmp(paper->name, files[i].name, length) != 0)
            SSFR_TRY(add_paper(papers, files[i].name, length, &paper));
        if (!strchr(file, '/')) SSFR_TRY(add_item(paper, file));
    }
end:
    return result;
}

/* ---- the object -------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_papers_create(ssfr_papers **out)
{
    ssfr_result result = SSFR_OK;
    ssfr_papers *papers = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&papers, 1, sizeof *papers, "papers"));
    SSFR_TRY(list_disk(papers));
    if (!papers->on_disk) SSFR_TRY(list_files(papers));
    *out = papers;
    papers = NULL;
end:
    ssfr_papers_destroy(&papers);
    return result;
}

void ssfr_papers_destroy(ssfr_papers **papers)
{
    ssfr_papers *p = *papers;
    for (size_t i = 0; p && i < p->n; i++) {
        for (size_t k = 0; k < p->papers[i].n_items; k++) free(p->papers[i].items[k]);
        free(p->papers[i].items);
        free(p->papers[i].name);
    }
    if (p) free(p->papers);
    free(p);
    *papers = NULL;
}

const char *ssfr_papers_path(const ssfr_papers *papers, const char *paper, const char *name,
                             char path[SSFR_PAPER_PATH])
{
    snprintf(path, SSFR_PAPER_PATH, "%s%s/%s/%s", papers->on_disk ? "" : "built-in ", folder, paper, name);
    return path;
}

ssfr_result ssfr_papers_read(const ssfr_papers *papers, const char *paper, const char *name, char **text,
                             size_t *size)
{
    ssfr_result result = SSFR_OK;
    char path[SSFR_PAPER_PATH], wanted[SSFR_PAPER_PATH];
    ssfr_papers_path(papers, paper, name, path);
    *text = NULL;
    if (papers->on_disk) return ssfr_read_file(path, MOST_FILE, text, size);
    snprintf(wanted, sizeof wanted, "%s/%s", paper, name);
    for (size_t i = 0; i < SSFR_COUNT(files); i++) {
        if (strcmp(files[i].name, wanted) != 0) continue;
        *size = (size_t)(files[i].end - files[i].begin);
        SSFR_TRY(copy(text, files[i].begin, *size));
        return SSFR_OK;
    }
    result = ssfr_fail(SSFR_ERR_IO, "%s: no such file", path);
end:
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sequence.c: files that are numbered, one a frame: patterns, ranges, and what is on the disk. */
#include "experiments/sequence.h"

#include <dirent.h>
#include <errno.h>

/* ---- patterns ---------------------------------------------------------------------------------------------------- */

enum { MAX_DIGITS = 9 }; /* of a frame's number, as SSFR_MAX_FRAME has */

/* A pattern taken apart; a pattern itself never goes to printf. */
typedef struct parts {
    size_t folder; /* length of the folder's name with its slash, 0 for none */
    size_t before; /* length of all that stands before the number */
    int width;     /* fewest digits */
    const char *after;
} parts;

bool ssfr_sequence_is(const char *name)
{
    return strchr(name, '%') != NULL;
}

static ssfr_result take_apart(const char *pattern, parts *out)
{
    const char *number = strchr(pattern, '%'), *slash = strrchr(pattern, '/');
    const bool wide = number && number[1] == '0' && number[2] >= '1' && number[2] <= '0' + MAX_DIGITS;
    const char *letter = number ? number + (wide ? 3 : 1) : "";
    if (*letter != 'd' || strchr(letter, '%') || (slash && slash > number))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: expected one number in a file's name, as %%d or as %%01d to %%09d",
                         pattern);
    *out = (parts){.folder = slash ? (size_t)(slash - pattern) + 1 : 0,
                   .before = (size_t)(number - pattern),
                   .width = wide ? number[2] - '0' : 1,
                   .after = letter + 1};
    return SSFR_OK;
}

ssfr_result ssfr_sequence_check(const char *pattern)
{
    parts p;
    return take_apart(pattern, &p);
}

ssfr_result ssfr_sequence_path(const char *pattern, long frame, char **out)
{
    ssfr_result result = SSFR_OK;
    parts p;
    *out = NULL;
    SSFR_TRY(take_apart(pattern, &p));
    if (frame < 0 || frame > SSFR_MAX_FRAME) {
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: frame %ld: expected a number from 0 to %d", pattern, frame,
                           SSFR_MAX_FRAME);
        goto end;
    }
    SSFR_TRY(ssfr_text_print(out, "a path", "%.*s%0*ld%s", (int)p.before, pattern, p.width, frame, p.after));
end:
    return result;
}

/* ---- what is on the disk ----------------------------------------------------------------------------------------- */

/* The number of a frame at the text's start, -1 for none or a longer one. */
static long read_number(const char *text, const char **end)
{
    const size_t digits = strspn(text, "0123456789");
    *end = text + digits;
    return digits > 0 && digits <= MAX_DIGITS ? strtol(text, NULL, 10) : -1;
}

/* The frame whose name this is, -1 when it is none's. */
static long frame_of(const char *pattern, const parts *p, const char *name)
{
    const char *before = pattern + p->folder, *end;
    const size_t length = p->before - p->folder;
    char digits[MAX_DIGITS + 1];
    if (strncmp(name, before, length) != 0) return -1;
    const long frame = read_number(name + length, &end);
    if (frame < 0 || strcmp(end, p->after) != 0) return -1;
    snprintf(digits, sizeof digits, "%0*ld", p->width, frame);
    return strncmp(digits, name + length, (size_t)(end - name) - length) == 0 ? frame : -1;
}

static ssfr_result add(long frame, size_t *n, size_t *room, long **frames)
{
    if (*n == *room) {
        *room = *room ? 2 * *room : 256;
        long *more = realloc(*frames, *room * sizeof *more);
        if (!more) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for the numbers of %zu frames", *room);
        *frames = more;
    }
    (*frames)[(*n)++] = frame;
    return SSFR_OK;
}

static int by_number(const void *a, const void *b)
{
    const long x = *(const long *)a, y = *(const long *)b;
    return (x > y) - (x < y);
}

static ssfr_result open_folder(const char *pattern, const parts *p, DIR **out)
{
    ssfr_result result = SSFR_OK;
    char *path = NULL;
    SSFR_TRY(ssfr_text_print(&path, "a path", "%.*s", p->folder ? (int)p->folder : 1, p->folder ? pattern : "."));
    *out = opendir(path);
    if (!*out) result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
end:
    free(path);
    return result;
}

ssfr_result ssfr_sequence_find(const char *pattern, size_t *n, long **frames)
{
    ssfr_result result = SSFR_OK;
    DIR *dir = NULL;
    parts p;
    long *found = NULL;
    size_t room = 0;
    *n = 0;
    *frames = NULL;
    SSFR_TRY(take_apart(pattern, &p));
    SSFR_TRY(open_folder(pattern, &p, &dir));
    for (const struct dirent *entry = readdir(dir); entry; entry = readdir(dir)) {
        const long frame = frame_of(pattern, &p, entry->d_name);
        if (frame >= 0) SSFR_TRY(add(frame, n, &room, &found));
    }
    if (*n > 1) qsort(found, *n, sizeof *found, by_number);
    *frames = found;
    found = NULL;
end:
    if (dir) closedir(dir);
    free(found);
    if (result != SSFR_OK) *n = 0;
    return result;
}

/* ---- ranges ------------------------------------------------------------------------------------------------------ */

const ssfr_frame_range ssfr_frame_range_all = {0, SSFR_MAX_FRAME, 1, true, true};

/* A number, or nothing where a colon or the text's end stands: then *out stays. */
static bool read_part(const char **text, long *out)
{
    if (**text == ':' || **text == '\0') return true;
    const long number = read_number(*text, text);
    if (number >= 0) *out = number;
    return number >= 0 && (**text == ':' || **text == '\0');
}

ssfr_result ssfr_frame_range_parse(ssfr_frame_range *out, const char *text)
{
    ssfr_frame_range r = ssfr_frame_range_all;
    const char *at = text;
    bool ok = *at != '\0' && read_part(&at, &r.first);
    r.from_start = at == text;
    if (ok && *at == '\0') {
        r.last = r.first;
        r.to_end = false;
    } else if (ok) {
        const char *const last = ++at;
        ok = read_part(&at, &r.last);
        r.to_end = at == last;
    }
    if (ok && *at == ':') {
        at++;
        ok = *at != '\0' && read_part(&at, &r.step);
    }
    if (!ok || *at != '\0' || r.step < 1 || r.first > r.last)
        return ssfr_fail(SSFR_ERR_VALUE, "frames '%s': expected A, A:B or A:B:STEP with A <= B and STEP from 1", text);
    *out = r;
    return SSFR_OK;
}

/* The error line for a range between said ends of which frames are missing. */
static ssfr_result fail_missing(const ssfr_frame_range *r, const char *what, long missing, long n_missing)
{
    if (n_missing == 1) return ssfr_fail(SSFR_ERR_VALUE, "%s: there is no frame %ld", what, missing);
    return ssfr_fail(SSFR_ERR_VALUE, "%s: there is no frame %ld, and %ld more of %ld to %ld are missing", what, missing,
                     n_missing - 1, r->first, r->last);
}

ssfr_result ssfr_frame_range_choose(const ssfr_frame_range *r, const char *what, size_t n, const long *there,
                                    size_t *n_frames, long **frames)
{
    ssfr_result result = SSFR_OK;
    size_t i = 0, chosen = 0;
    long missing = -1; /* the first of them */
    *n_frames = 0;
    *frames = NULL;
    SSFR_TRY(ssfr_alloc(frames, n, sizeof **frames, "the numbers of frames"));
    while (i < n && there[i] < r->first) i++;
    const long start = r->from_start && i < n ? there[i] : r->first;
    for (; i < n && there[i] <= r->last; i++) {
        if ((there[i] - start) % r->step != 0) continue;
        if (missing < 0 && there[i] != start + (long)chosen * r->step) missing = start + (long)chosen * r->step;
        (*frames)[chosen++] = there[i];
    }
    const long wanted = (r->last - r->first) / r->step + 1;
    if (missing < 0) missing = start + (long)chosen * r->step;
    if (!r->from_start && !r->to_end && (long)chosen < wanted)
        result = fail_missing(r, what, missing, wanted - (long)chosen);
    else if (chosen == 0)
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: there are no frames from %ld to %ld", what, r->first, r->last);
    *n_frames = chosen;
end:
    if (result != SSFR_OK) {
        free(*frames);
        *frames = NULL;
        *n_frames = 0;
    }
    return result;
}

ssfr_result ssfr_sequence_frames(const char *pattern, const ssfr_frame_range *range, size_t *n_frames, long **frames)
{
    ssfr_result result = SSFR_OK;
    long *there = NULL;
    size_t n = 0;
    *n_frames = 0;
    *frames = NULL;
    SSFR_TRY(ssfr_sequence_find(pattern, &n, &there));
    SSFR_TRY(ssfr_frame_range_choose(range, pattern, n, there, n_frames, frames));
end:
    free(there);
    return result;
}

/* SPDX-License-Identifier: MIT */
/* result.c: result codes, the log, and the few system calls everything needs. */
#include "base/base.h"

#include <errno.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static void print_to_stderr(void *user, ssfr_level level, const char *where, const char *text)
{
    (void)user, (void)where;
    if (level <= SSFR_WARNING) fprintf(stderr, "ssfr: %s%s\n", level == SSFR_WARNING ? "warning: " : "", text);
}

static ssfr_log_fn *log_fn = print_to_stderr;
static void *log_user;
static const char *log_about;

const char *ssfr_result_text(ssfr_result code)
{
    static const char *const texts[] = {
#define X(name, text) text,
        SSFR_RESULTS(X)
#undef X
    };
    return (size_t)code < SSFR_COUNT(texts) ? texts[code] : "unknown result code";
}

const char *ssfr_version(void)
{
    return SSFR_VERSION;
}

void ssfr_log_to(ssfr_log_fn *fn, void *user)
{
    log_fn = fn ? fn : print_to_stderr;
    log_user = user;
}

void ssfr_log_about(const char *what)
{
    log_about = what;
}

static void log_va(ssfr_level level, const char *where, const char *format, va_list args)
{
    char text[1024];
    const int used = log_about ? snprintf(text, sizeof text, "%.256s: ", log_about) : 0;
    vsnprintf(text + used, sizeof text - (size_t)used, format, args);
    /* A value from outside may hold line ends: the log keeps to one line. */
    for (char *at = text; *at; at++)
        if (*at == '\n' || *at == '\r') *at = ' ';
    log_fn(log_user, level, where, text);
}

void ssfr_log_at(ssfr_level level, const char *where, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    log_va(level, where, format, args);
    va_end(args);
}

ssfr_result ssfr_fail_at(ssfr_result code, const char *where, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    log_va(SSFR_ERROR, where, format, args);
    va_end(args);
    return code;
}

ssfr_result ssfr_alloc(void *out, size_t n, size_t size, const char *what)
{
    void *memory = calloc(n ? n : 1, size ? size : 1);
    memcpy(out, &memory, sizeof memory);
    return memory ? SSFR_OK : ssfr_fail(SSFR_ERR_MEMORY, "no memory for %zu x %zu bytes of %s", n, size, what);
}

ssfr_result ssfr_text_print_va(char **out, const char *what, const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    const size_t size = (size_t)vsnprintf(NULL, 0, format, again) + 1;
    va_end(again);
    const ssfr_result result = ssfr_alloc(out, size, 1, what);
    if (result == SSFR_OK) vsnprintf(*out, size, format, args);
    return result;
}

ssfr_result ssfr_text_print(char **out, const char *what, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const ssfr_result result = ssfr_text_print_va(out, what, format, args);
    va_end(args);
    return result;
}

double ssfr_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

ssfr_plain ssfr_plain_begin(void)
{
    ssfr_plain p = {.plain = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0)};
    p.before = uselocale(p.plain); /* without memory for one, the locale stays */
    return p;
}

void ssfr_plain_end(ssfr_plain *plain)
{
    uselocale(plain->before);
    if (plain->plain) freelocale(plain->plain);
}

bool ssfr_parse_number(const char *text, double *out)
{
    char *end = NULL;
    const double value = strtod(text, &end);
    const bool ok = end != text && *end == '\0' && isfinite(value);
    if (ok) *out = value;
    return ok;
}

ssfr_result ssfr_read_file(const char *path, size_t max_size, char **out, size_t *size)
{
    ssfr_result result = SSFR_OK;
    char *text = NULL;
    struct stat info;
    FILE *file = fopen(path, "rb");
    *out = NULL;
    if (!file || fstat(fileno(file), &info) != 0) {
        result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
        goto end;
    }
    if (!S_ISREG(info.st_mode)) {
        result = ssfr_fail(SSFR_ERR_IO, "%s: not a regular file", path);
        goto end;
    }
    if ((uintmax_t)info.st_size > max_size) {
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: %jd bytes, at most %zu are read", path, (intmax_t)info.st_size,
                           max_size);
        goto end;
    }
    *size = (size_t)info.st_size;
    SSFR_TRY(ssfr_alloc(&text, *size + 1, 1, path));
    if (fread(text, 1, *size, file) != *size) {
        result = ssfr_fail(SSFR_ERR_IO, "%s: read error", path);
        goto end;
    }
    *out = text;
    text = NULL;
end:
    free(text);
    if (file) fclose(file);
    return result;
}

ssfr_result ssfr_aside_begin(ssfr_aside *aside, const char *path)
{
    ssfr_result result = SSFR_OK;
    struct stat info;
    *aside = (ssfr_aside){0};
    /* Renaming would put a file in the place of a device or a pipe. */
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return ssfr_fail(SSFR_ERR_IO, "%s: %s", path, S_ISDIR(info.st_mode) ? strerror(EISDIR) : "not a regular file");
    SSFR_TRY(ssfr_text_print(&aside->path, "a path", "%s", path));
    SSFR_TRY(ssfr_text_print(&aside->temporary, "a path", "%s.%ld.part", path, (long)getpid()));
end:
    return result;
}

ssfr_result ssfr_aside_end(ssfr_aside *aside, ssfr_result so_far)
{
    ssfr_result result = so_far;
    if (aside->temporary) {
        if (result == SSFR_OK && rename(aside->temporary, aside->path) != 0)
            result = ssfr_fail(SSFR_ERR_IO, "%s: %s", aside->path, strerror(errno));
        if (result != SSFR_OK) unlink(aside->temporary);
    }
    free(aside->path);
    free(aside->temporary);
    *aside = (ssfr_aside){0};
    return result;
}

void ssfr_list_name(char *list, size_t size, size_t *used, const char *name)
{
    if (*used < size) *used += (size_t)snprintf(list + *used, size - *used, "%s%s", *used ? ", " : "", name);
}

/* SPDX-License-Identifier: MIT */
/* base.h: what every file of the library uses: failing, logging, checked allocation, the clock. */
#ifndef SSFR_BASE_H
#define SSFR_BASE_H

#include "ssfr.h"

#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SSFR_STR_(x) #x
#define SSFR_STR(x) SSFR_STR_(x)
#define SSFR_HERE __FILE__ ":" SSFR_STR(__LINE__)

/* Logs the error, once and where it is first known, and gives its code: `return ssfr_fail(SSFR_ERR_VALUE, "...")`. */
#define ssfr_fail(code, ...) ssfr_fail_at((code), SSFR_HERE, __VA_ARGS__)
#define ssfr_log(level, ...) ssfr_log_at((level), SSFR_HERE, __VA_ARGS__)

/* Passes an error up to the single exit. */
#define SSFR_TRY(expr)                   \
    do {                                 \
        result = (expr);                 \
        if (result != SSFR_OK) goto end; \
    } while (0)

__attribute__((format(printf, 3, 4))) ssfr_result ssfr_fail_at(ssfr_result code, const char *where, const char *format,
                                                               ...);
__attribute__((format(printf, 3, 4))) void ssfr_log_at(ssfr_level level, const char *where, const char *format, ...);

/* Until NULL is given, each line of the log begins with `what`: for work whose parts do not know what they are part of.
 * The text must stay. */
void ssfr_log_about(const char *what);

/* Zeroed memory for n items of `size` bytes; never returns NULL for n = 0. Logs when there is none. */
SSFR_MUST ssfr_result ssfr_alloc(void *out, size_t n, size_t size, const char *what);

/* A new text as printf has it; free it. what: it is called so where there is no memory for it. */
__attribute__((format(printf, 3, 4))) SSFR_MUST ssfr_result ssfr_text_print(char **out, const char *what,
                                                                            const char *format, ...);
__attribute__((format(printf, 3, 0))) SSFR_MUST ssfr_result ssfr_text_print_va(char **out, const char *what,
                                                                               const char *format, va_list args);

/* Seconds since an arbitrary start, monotonic. */
double ssfr_clock(void);

/* Numbers have a decimal point, whatever locale a host program has set: between begin and end, for this thread. */
typedef struct ssfr_plain {
    locale_t plain, before;
} ssfr_plain;

ssfr_plain ssfr_plain_begin(void);
void ssfr_plain_end(ssfr_plain *plain);

/* True when text is a finite number with nothing after it; the value goes to *out, which else stays. */
bool ssfr_parse_number(const char *text, double *out);

/* Appends a name to the list "a, b" in list[size], for an error line that tells what there is; it is cut where it is
 * full. *used is its length, 0 at first. */
void ssfr_list_name(char *list, size_t size, size_t *used, const char *name);

/* The whole file with a closing zero byte; *size is without it. Refuses files over max_size bytes. */
SSFR_MUST ssfr_result ssfr_read_file(const char *path, size_t max_size, char **out, size_t *size);

/* A file written aside and renamed when complete, so that nothing half-written is ever seen under its name.
 * The name aside differs between processes. ssfr_aside_end renames when so_far is SSFR_OK, else removes, and
 * frees all; also after a begin that failed. */
typedef struct ssfr_aside {
    char *path, *temporary;
} ssfr_aside;

SSFR_MUST ssfr_result ssfr_aside_begin(ssfr_aside *aside, const char *path);
SSFR_MUST ssfr_result ssfr_aside_end(ssfr_aside *aside, ssfr_result so_far);

#define SSFR_COUNT(array) (sizeof(array) / sizeof((array)[0]))

static inline int ssfr_min_int(int a, int b) { return a < b ? a : b; }
static inline int ssfr_max_int(int a, int b) { return a > b ? a : b; }
static inline int ssfr_clamp_int(int v, int lo, int hi) { return v < lo ? lo : v > hi ? hi : v; }
static inline double ssfr_clamp(double v, double lo, double hi) { return v < lo ? lo : v > hi ? hi : v; }
static inline double ssfr_mix(double a, double b, double t) { return a + (b - a) * t; }
static inline double ssfr_square(double v) { return v * v; }
static inline double ssfr_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static inline bool ssfr_all_finite(const double v[3]) { return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]); }

/* The finaliser of SplitMix64 (Steele, Lea and Flood 2014): every bit of the result depends on every bit of v. Random
 * numbers made of a seed and of whom they are for depend on no order. */
static inline uint64_t ssfr_mix_bits(uint64_t v)
{
    v = (v ^ v >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    v = (v ^ v >> 27) * UINT64_C(0x94d049bb133111eb);
    return v ^ v >> 31;
}

/* Of two doubles, rising: for qsort. */
static inline int ssfr_by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Normalises v in place and returns its length; a zero vector is left as it is. */
static inline double ssfr_normalize(double v[3])
{
    const double length = sqrt(ssfr_dot(v, v));
    if (length > 0)
        for (int k = 0; k < 3; k++) v[k] /= length;
    return length;
}

static inline void ssfr_cross(const double a[3], const double b[3], double out[3])
{
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x, out[1] = y, out[2] = z;
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* util.h: what every test uses beside cmocka. */
#ifndef SSFR_TESTS_UTIL_H
#define SSFR_TESTS_UTIL_H

#include "base/field.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

/* |a - b| <= abs + rel |b|; NaN fails. cmocka's own comparison casts to float. */
#define assert_close(a, b, abs, rel) test_assert_close((a), (b), (abs), (rel), __FILE__, __LINE__)
void test_assert_close(double a, double b, double eps_abs, double eps_rel, const char *file, int line);

/* The call fails with this code, and logs exactly one line, which holds `text`. */
#define assert_fails(code, call, text)                                \
    do {                                                              \
        test_clear_log();                                             \
        assert_int_equal(call, code);                                 \
        test_assert_logged((text), __FILE__, __LINE__);               \
    } while (0)

/* Group setup: from here on errors and warnings are kept, not printed. */
int test_capture_log(void **state);
void test_clear_log(void);
void test_assert_logged(const char *text, const char *file, int line);
const char *test_last_error(void);
int test_n_errors(void);

/* A path in a folder of this process' own, removed at exit. The string lives until exit. */
const char *test_path(const char *name);
/* One that has not been given before: the name and a number. */
const char *test_new_path(const char *name);
void test_write_file(const char *path, const void *data, size_t size);

/* The folder that SSFR_DATA names, or skips the test. */
const char *test_data_or_skip(void);

/* Deterministic numbers in [lo, hi). */
double test_random(uint64_t *state, double lo, double hi);

/* The caller's to destroy. */
ssfr_field *test_image(int w, int h, int c, double value);

#endif

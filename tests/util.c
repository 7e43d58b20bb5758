/* SPDX-License-Identifier: GPL-3.0-or-later */
/* util.c: what every test uses beside cmocka. */
#include "tests/util.h"

#include <dirent.h>
#include <unistd.h>

static char last_error[1024];
static int n_errors;

static void keep(void *user, ssfr_level level, const char *where, const char *text)
{
    (void)user, (void)where;
    if (level != SSFR_ERROR) return;
    n_errors++;
    snprintf(last_error, sizeof last_error, "%s", text);
}

int test_capture_log(void **state)
{
    (void)state;
    ssfr_log_to(keep, NULL);
    return 0;
}

void test_clear_log(void)
{
    n_errors = 0;
    last_error[0] = '\0';
}

const char *test_last_error(void)
{
    return last_error;
}

int test_n_errors(void)
{
    return n_errors;
}

void test_assert_logged(const char *text, const char *file, int line)
{
    if (n_errors != 1 || !strstr(last_error, text) || strchr(last_error, '\n')) {
        print_error("%d error lines, the last \"%s\"; expected one with \"%s\"\n", n_errors, last_error, text);
        _fail(file, line);
    }
}

void test_assert_close(double a, double b, double eps_abs, double eps_rel, const char *file, int line)
{
    if (!(fabs(a - b) <= eps_abs + eps_rel * fabs(b)) && a != b) {
        print_error("%.17g differs from %.17g by %g, allowed %g + %g of it\n", a, b, fabs(a - b), eps_abs, eps_rel);
        _fail(file, line);
    }
}

static char folder[64];

static void remove_folder(void)
{
    DIR *dir = opendir(folder);
    for (struct dirent *entry = dir ? readdir(dir) : NULL; entry; entry = readdir(dir)) {
        char path[sizeof folder + sizeof entry->d_name + 1];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (entry->d_name[0] != '.') unlink(path);
    }
    if (dir) closedir(dir);
    rmdir(folder);
}

const char *test_path(const char *name)
{
    static char paths[256][128];
    static int n;
    if (!folder[0]) {
        snprintf(folder, sizeof folder, "/tmp/ssfr-test-XXXXXX");
        assert_non_null(mkdtemp(folder));
        atexit(remove_folder);
    }
    assert_true(n < 256);
    snprintf(paths[n], sizeof paths[n], "%s/%s", folder, name);
    return paths[n++];
}

/* Over what is there: to empty a file first makes the disk wait, a thousand times over in a test of damaged ones. */
const char *test_new_path(const char *name)
{
    static int n;
    char numbered[32];
    snprintf(numbered, sizeof numbered, "%s%d", name, n++);
    return test_path(numbered);
}

void test_write_file(const char *path, const void *data, size_t size)
{
    FILE *file = fopen(path, access(path, F_OK) == 0 ? "r+b" : "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fflush(file), 0);
    assert_int_equal(ftruncate(fileno(file), (off_t)size), 0);
    assert_int_equal(fclose(file), 0);
}

const char *test_data_or_skip(void)
{
    const char *data = getenv("SSFR_DATA");
    if (!data || !data[0]) skip();
    return data;
}

ssfr_field *test_image(int w, int h, int c, double value)
{
    ssfr_field *field = NULL;
    assert_int_equal(ssfr_field_create(&field, w, h, c), SSFR_OK);
    ssfr_field_fill(field, value);
    return field;
}

double test_random(uint64_t *state, double lo, double hi)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * (double)(*state >> 11) / 9007199254740992.0;
}

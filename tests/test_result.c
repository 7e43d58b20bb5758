/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_result.c: result codes, the log, numbers from text, files read whole, files written aside. */
#include "tests/util.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- codes and the log ------------------------------------------------------------------------------------------- */

static void every_code_has_a_text_of_its_own(void **state)
{
    (void)state;
    for (int i = SSFR_OK; i <= SSFR_ERR_GL; i++)
        for (int k = SSFR_OK; k < i; k++)
            assert_string_not_equal(ssfr_result_text((ssfr_result)i), ssfr_result_text((ssfr_result)k));
    assert_string_equal(ssfr_result_text(SSFR_OK), "no error");
    assert_string_equal(ssfr_result_text((ssfr_result)(SSFR_ERR_GL + 1)), "unknown result code");
    assert_string_equal(ssfr_result_text((ssfr_result)-1), "unknown result code");
    assert_string_equal(ssfr_version(), SSFR_VERSION);
}

typedef struct heard {
    int n;
    ssfr_level level;
    char where[256], text[2048];
} heard;

static void hear(void *user, ssfr_level level, const char *where, const char *text)
{
    heard *h = user;
    h->n++;
    h->level = level;
    snprintf(h->where, sizeof h->where, "%s", where);
    snprintf(h->text, sizeof h->text, "%s", text);
}

static void log_gets_level_place_and_text(void **state)
{
    (void)state;
    heard h = {0};
    ssfr_log_to(hear, &h);
    ssfr_log(SSFR_INFO, "%d particles of %g m", 23, 0.02385);
    assert_int_equal(h.n, 1);
    assert_int_equal(h.level, SSFR_INFO);
    assert_string_equal(h.text, "23 particles of 0.02385 m");
    assert_non_null(strstr(h.where, "test_result.c:"));
    assert_int_equal(ssfr_fail(SSFR_ERR_FORMAT, "line %d", 17), SSFR_ERR_FORMAT);
    assert_int_equal(h.n, 2);
    assert_int_equal(h.level, SSFR_ERROR);
    assert_string_equal(h.text, "line 17");
    ssfr_log_to(NULL, NULL);
    assert_int_equal(test_capture_log(NULL), 0);
}

static void lines_of_the_log_say_what_they_are_about(void **state)
{
    (void)state;
    heard h = {0};
    char about[400];
    ssfr_log_to(hear, &h);
    ssfr_log_about("waves, frame 17");
    assert_int_equal(ssfr_fail(SSFR_ERR_VALUE, "particle %d", 23), SSFR_ERR_VALUE);
    assert_string_equal(h.text, "waves, frame 17: particle 23");
    memset(about, 'x', sizeof about - 1);
    about[sizeof about - 1] = '\0';
    ssfr_log_about(about); /* leaves room for the line itself */
    ssfr_log(SSFR_INFO, "particle %d", 23);
    assert_string_equal(h.text + 256, ": particle 23");
    ssfr_log_about(NULL);
    ssfr_log(SSFR_INFO, "particle %d", 23);
    assert_string_equal(h.text, "particle 23");
    ssfr_log_to(NULL, NULL);
    assert_int_equal(test_capture_log(NULL), 0);
}

static void a_text_too_long_for_the_log_is_cut(void **state)
{
    (void)state;
    heard h = {0};
    char text[4096];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    ssfr_log_to(hear, &h);
    ssfr_log(SSFR_WARNING, "%s", text);
    assert_int_equal(strlen(h.text), 1023);
    assert_int_equal(test_capture_log(NULL), 0);
}

/* What a call of the default log prints to stderr. */
static const char *printed(ssfr_level level, const char *text)
{
    static char line[256];
    const char *path = test_path("stderr.txt");
    const int kept = dup(STDERR_FILENO), file = open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);
    assert_true(kept >= 0 && file >= 0);
    fflush(stderr);
    dup2(file, STDERR_FILENO);
    ssfr_log_to(NULL, NULL);
    ssfr_log(level, "%s", text);
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    const ssize_t n = pread(file, line, sizeof line - 1, 0);
    assert_true(n >= 0);
    line[n] = '\0';
    close(kept), close(file);
    assert_int_equal(test_capture_log(NULL), 0);
    return line;
}

static void default_log_prints_errors_and_warnings_alone(void **state)
{
    (void)state;
    assert_string_equal(printed(SSFR_ERROR, "no such file"), "ssfr: no such file\n");
    assert_string_equal(printed(SSFR_WARNING, "2 of 5"), "ssfr: warning: 2 of 5\n");
    assert_string_equal(printed(SSFR_INFO, "hello"), "");
    assert_string_equal(printed(SSFR_DEBUG, "hello"), "");
}

/* ---- memory and numbers ------------------------------------------------------------------------------------------ */

static void memory_comes_zeroed_even_for_nothing(void **state)
{
    (void)state;
    unsigned char *bytes = NULL;
    assert_int_equal(ssfr_alloc(&bytes, 23, 5, "bytes"), SSFR_OK);
    for (int i = 0; i < 115; i++) assert_int_equal(bytes[i], 0);
    free(bytes);
    assert_int_equal(ssfr_alloc(&bytes, 0, 8, "nothing"), SSFR_OK);
    assert_non_null(bytes);
    free(bytes);
    assert_int_equal(ssfr_alloc(&bytes, 3, 0, "nothing"), SSFR_OK);
    assert_non_null(bytes);
    free(bytes);
}

static void more_memory_than_there_is_is_an_error(void **state)
{
    (void)state;
    void *memory = &memory;
    assert_fails(SSFR_ERR_MEMORY, ssfr_alloc(&memory, SIZE_MAX / 4, 16, "a wish"), "16 bytes of a wish");
    assert_null(memory);
    memory = &memory;
    assert_fails(SSFR_ERR_MEMORY, ssfr_alloc(&memory, (size_t)1 << 58, 1, "a wish"), "288230376151711744 x 1 bytes");
    assert_null(memory);
}

static void a_text_is_as_long_as_what_is_printed(void **state)
{
    (void)state;
    char *text = NULL;
    assert_int_equal(ssfr_text_print(&text, "a text", "%s/%.*s_%04d%%", "folder", 2, "name", 23), SSFR_OK);
    assert_string_equal(text, "folder/na_0023%");
    free(text);
    assert_int_equal(ssfr_text_print(&text, "a text", "%5000d", 7), SSFR_OK);
    assert_int_equal(strlen(text), 5000);
    assert_int_equal(text[4999], '7');
    free(text);
    assert_int_equal(ssfr_text_print(&text, "a text", "%s", ""), SSFR_OK);
    assert_string_equal(text, "");
    free(text);
}

static void numbers_are_finite_and_stand_alone(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value;
    } good[] = {{"2.385", 2.385}, {"-1e-310", -1e-310}, {"+4", 4}, {" 7", 7}, {"1e308", 1e308}, {"0x10", 16}};
    static const char *const bad[] = {"",       " ",   "nan", "inf", "-infinity", "1e309",
                                      "2.385m", "1,5", "1 2", "--1", "e5",        "3 "};
    double value = 1;
    for (size_t i = 0; i < SSFR_COUNT(good); i++) {
        assert_true(ssfr_parse_number(good[i].text, &value));
        assert_true(value == good[i].value);
    }
    value = 2.385;
    for (size_t i = 0; i < SSFR_COUNT(bad); i++) assert_false(ssfr_parse_number(bad[i], &value));
    assert_true(value == 2.385);
}

static void clock_runs_forwards(void **state)
{
    (void)state;
    double before = ssfr_clock();
    for (int i = 0; i < 1000; i++) {
        const double now = ssfr_clock();
        assert_true(now >= before);
        before = now;
    }
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static void a_file_is_read_whole(void **state)
{
    (void)state;
    const char *path = test_path("whole.txt"), text[] = "two\0 words";
    char *got = NULL;
    size_t size = 0;
    test_write_file(path, text, sizeof text - 1);
    assert_int_equal(ssfr_read_file(path, sizeof text - 1, &got, &size), SSFR_OK);
    assert_int_equal(size, sizeof text - 1);
    assert_memory_equal(got, text, sizeof text);
    free(got);
    test_write_file(path, "", 0);
    assert_int_equal(ssfr_read_file(path, 0, &got, &size), SSFR_OK);
    assert_int_equal(size, 0);
    assert_int_equal(got[0], '\0');
    free(got);
}

static void files_that_cannot_be_read_are_refused(void **state)
{
    (void)state;
    char where[1] = "", *got = where;
    size_t size = 0;
    const char *path = test_path("large.txt"), *pipe = test_path("pipe");
    assert_fails(SSFR_ERR_IO, ssfr_read_file(test_path("none.txt"), 100, &got, &size), "none.txt: No such file");
    assert_null(got);
    assert_fails(SSFR_ERR_IO, ssfr_read_file("/tmp", 100, &got, &size), "/tmp: not a regular file");
    test_write_file(path, "twelve bytes", 12);
    assert_fails(SSFR_ERR_VALUE, ssfr_read_file(path, 11, &got, &size), "large.txt: 12 bytes, at most 11");
    assert_null(got);
    assert_int_equal(mkfifo(pipe, 0600), 0);
    const int held = open(pipe, O_RDWR); /* else opening it would wait for a writer */
    assert_fails(SSFR_ERR_IO, ssfr_read_file(pipe, 100, &got, &size), "pipe: not a regular file");
    close(held);
}

static bool exists(const char *path)
{
    return access(path, F_OK) == 0;
}

static void what_is_no_file_is_not_replaced(void **state)
{
    (void)state;
    ssfr_aside aside;
    struct stat info;
    const char *path = test_path("fifo");
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_fails(SSFR_ERR_IO, ssfr_aside_begin(&aside, path), "fifo: not a regular file");
    assert_int_equal(ssfr_aside_end(&aside, SSFR_ERR_IO), SSFR_ERR_IO);
    assert_int_equal(stat(path, &info), 0);
    assert_true(S_ISFIFO(info.st_mode));
    assert_fails(SSFR_ERR_IO, ssfr_aside_begin(&aside, "/tmp"), "/tmp: Is a directory");
}

static void a_file_written_aside_appears_when_complete(void **state)
{
    (void)state;
    ssfr_aside aside;
    const char *path = test_path("result.csv");
    char temporary[256];
    test_write_file(path, "old", 3);
    assert_int_equal(ssfr_aside_begin(&aside, path), SSFR_OK);
    snprintf(temporary, sizeof temporary, "%s", aside.temporary);
    test_write_file(aside.temporary, "newer", 5);
    char *text = NULL;
    size_t size;
    assert_int_equal(ssfr_read_file(path, 10, &text, &size), SSFR_OK);
    assert_string_equal(text, "old");
    free(text);
    assert_int_equal(ssfr_aside_end(&aside, SSFR_OK), SSFR_OK);
    assert_int_equal(ssfr_read_file(path, 10, &text, &size), SSFR_OK);
    assert_string_equal(text, "newer");
    free(text);
    assert_false(exists(temporary));
    assert_int_equal(ssfr_aside_end(&aside, SSFR_OK), SSFR_OK); /* zeroed: nothing is left to do */
}

static void a_file_that_failed_leaves_nothing(void **state)
{
    (void)state;
    ssfr_aside aside;
    const char *path = test_path("failed.csv"), *folder = test_path("folder");
    char temporary[256];
    assert_int_equal(ssfr_aside_begin(&aside, path), SSFR_OK);
    snprintf(temporary, sizeof temporary, "%s", aside.temporary);
    test_write_file(temporary, "half", 4);
    test_clear_log();
    assert_int_equal(ssfr_aside_end(&aside, SSFR_ERR_FORMAT), SSFR_ERR_FORMAT);
    assert_int_equal(test_n_errors(), 0);
    assert_false(exists(path) || exists(temporary));
    assert_int_equal(ssfr_aside_begin(&aside, folder), SSFR_OK);
    assert_int_equal(mkdir(folder, 0700), 0); /* somebody makes a folder meanwhile */
    snprintf(temporary, sizeof temporary, "%s", aside.temporary);
    test_write_file(temporary, "half", 4);
    assert_fails(SSFR_ERR_IO, ssfr_aside_end(&aside, SSFR_OK), "folder: Is a directory");
    assert_false(exists(temporary));
    assert_int_equal(rmdir(folder), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_code_has_a_text_of_its_own),
        cmocka_unit_test(log_gets_level_place_and_text),
        cmocka_unit_test(lines_of_the_log_say_what_they_are_about),
        cmocka_unit_test(a_text_too_long_for_the_log_is_cut),
        cmocka_unit_test(default_log_prints_errors_and_warnings_alone),
        cmocka_unit_test(memory_comes_zeroed_even_for_nothing),
        cmocka_unit_test(more_memory_than_there_is_is_an_error),
        cmocka_unit_test(a_text_is_as_long_as_what_is_printed),
        cmocka_unit_test(numbers_are_finite_and_stand_alone),
        cmocka_unit_test(clock_runs_forwards),
        cmocka_unit_test(a_file_is_read_whole),
        cmocka_unit_test(files_that_cannot_be_read_are_refused),
        cmocka_unit_test(what_is_no_file_is_not_replaced),
        cmocka_unit_test(a_file_written_aside_appears_when_complete),
        cmocka_unit_test(a_file_that_failed_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

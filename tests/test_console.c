/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_console.c: the time left is that of the work a bar tells of, whatever that is part of. */
#include "experiments/console.h"
#include "tests/util.h"

#define assert_begun(what, done, total, now, begun) \
    assert_close(ssfr_console_begun((what), (done), (total), (now)), (begun), 0, 0)

static void work_began_when_it_was_first_told_of(void **state)
{
    (void)state;
    assert_begun("sweep", 0, 9, 10, 10);
    assert_begun("sweep", 0, 9, 11, 10);
    assert_begun("sweep", 3, 9, 12, 10);
    assert_begun("sweep", 9, 9, 13, 10);
    assert_begun("sweep", 0, 9, 14, 14); /* once more */
    assert_begun("sweep", 9, 9, 15, 14);
}

static void a_part_of_work_begins_by_itself_and_leaves_the_whole_alone(void **state)
{
    (void)state;
    assert_begun("sweep", 0, 9, 10, 10);
    for (int row = 0; row < 3; row++) {
        const double now = 20 + 10 * row;
        assert_begun("play", 0, 2, now, now);
        assert_begun("play", 1, 2, now + 1, now);
        if (row < 2) assert_begun("play", 2, 2, now + 2, now); /* once it fails, and never ends */
        assert_begun("sweep", (size_t)row + 1, 9, now + 3, 10);
    }
    assert_begun("play", 0, 2, 60, 60);
    assert_begun("sweep", 9, 9, 61, 10);
}

static void parts_deeper_than_bars_are_counted_from_the_last(void **state)
{
    static const char *const works[] = {"a", "b", "c", "d", "e", "f"};
    (void)state;
    for (size_t i = 0; i < SSFR_COUNT(works); i++) assert_begun(works[i], 0, 2, (double)i, (double)i);
    assert_begun("f", 1, 2, 7, 5);
    assert_begun("a", 1, 2, 8, 0);
    assert_begun("a", 2, 2, 9, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(work_began_when_it_was_first_told_of),
        cmocka_unit_test(a_part_of_work_begins_by_itself_and_leaves_the_whole_alone),
        cmocka_unit_test(parts_deeper_than_bars_are_counted_from_the_last),
    };
    return cmocka_run_group_tests_name("console", tests, test_capture_log, NULL);
}

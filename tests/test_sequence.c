/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_sequence.c: names with a number in them, ranges of frames, and which files of a sequence are there. */
#include "experiments/sequence.h"
#include "tests/util.h"

#include <unistd.h>

static void assert_path(const char *pattern, long frame, const char *expected)
{
    char *path = NULL;
    assert_int_equal(ssfr_sequence_path(pattern, frame, &path), SSFR_OK);
    assert_string_equal(path, expected);
    free(path);
}

static void a_frames_path_has_its_number_filled_up_with_zeros(void **state)
{
    (void)state;
    assert_path("dir/frame_%d.vtk", 2385, "dir/frame_2385.vtk");
    assert_path("dir/frame_%d.vtk", 0, "dir/frame_0.vtk");
    assert_path("frame_%04d.ply", 7, "frame_0007.ply");
    assert_path("frame_%04d.ply", 23850, "frame_23850.ply");
    assert_path("%09d", 1, "000000001");
    assert_path("/%01d", SSFR_MAX_FRAME, "/999999999");
    assert_path("d%dd", 5, "d5d");
}

static void only_names_with_a_percent_sign_are_sequences(void **state)
{
    (void)state;
    assert_true(ssfr_sequence_is("a_%d.ply") && ssfr_sequence_is("100%") && ssfr_sequence_is("%s/a.ply"));
    assert_false(ssfr_sequence_is("a_1.ply") || ssfr_sequence_is(""));
    assert_int_equal(ssfr_sequence_check("a_%03d.ply"), SSFR_OK);
}

static void patterns_of_another_form_are_refused(void **state)
{
    (void)state;
    static const char *const patterns[] = {
        "a.ply", "",     "%",     "a_%",  "%0",    "%0d",   "%00d",   "%010d", "%10d",  "%4d",         "%-4d",
        "%+d",   "% d",  "%ld",   "%i",   "%u",    "%x",    "%s",     "%n",    "%*d",   "%.3d",        "%1$d",
        "%%",    "%%d",  "%d%d",  "%d_%s", "%s_%d", "%04d%", "%D",    "100%/%d.ply", "%d/a.ply", "a_%d/%d.ply",
    };
    for (size_t i = 0; i < SSFR_COUNT(patterns); i++) {
        size_t n = 1;
        long *frames = NULL;
        char *path = NULL;
        char says[64];
        snprintf(says, sizeof says, "%s: expected one number in a file's name", patterns[i]);
        assert_fails(SSFR_ERR_VALUE, ssfr_sequence_check(patterns[i]), says);
        assert_fails(SSFR_ERR_VALUE, ssfr_sequence_path(patterns[i], 3, &path), says);
        assert_fails(SSFR_ERR_VALUE, ssfr_sequence_find(patterns[i], &n, &frames), says);
        assert_fails(SSFR_ERR_VALUE, ssfr_sequence_frames(patterns[i], &ssfr_frame_range_all, &n, &frames), says);
        assert_true(!path && !frames && n == 0);
    }
}

static void frames_below_0_or_of_too_many_digits_have_no_path(void **state)
{
    (void)state;
    char *path = NULL;
    assert_fails(SSFR_ERR_VALUE, ssfr_sequence_path("a_%d.ply", -1, &path), "a_%d.ply: frame -1: expected a number");
    assert_fails(SSFR_ERR_VALUE, ssfr_sequence_path("a_%d.ply", SSFR_MAX_FRAME + 1L, &path), "frame 1000000000");
    assert_null(path);
}

/* ---- ranges ------------------------------------------------------------------------------------------------------ */

static void ranges_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        ssfr_frame_range range;
    } cases[] = {
        {"23", {23, 23, 1, false, false}},         {"0", {0, 0, 1, false, false}},
        {"3:85", {3, 85, 1, false, false}},        {"3:85:2", {3, 85, 2, false, false}},
        {"7:7", {7, 7, 1, false, false}},          {"007:0085", {7, 85, 1, false, false}},
        {":", {0, SSFR_MAX_FRAME, 1, true, true}}, {"3:", {3, SSFR_MAX_FRAME, 1, false, true}},
        {":85", {0, 85, 1, true, false}},          {"3::2", {3, SSFR_MAX_FRAME, 2, false, true}},
        {":85:2", {0, 85, 2, true, false}},        {"::2", {0, SSFR_MAX_FRAME, 2, true, true}},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_frame_range r = {0};
        const ssfr_frame_range *e = &cases[i].range;
        assert_int_equal(ssfr_frame_range_parse(&r, cases[i].text), SSFR_OK);
        assert_true(r.first == e->first && r.last == e->last && r.step == e->step);
        assert_true(r.from_start == e->from_start && r.to_end == e->to_end);
    }
}

static void ranges_of_another_form_are_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "", "a", "-1", "+1", " 1", "1 ", "1:a", "a:1", "1:2:", "::", "1:2:0", "1:2:-1", "1:2:3:", "1:2:3:4", "3:2",
        "1.5", "1-2", "1,2", "1000000000", "0:1000000000", "99999999999999999999", "1:-2", "0x10",
    };
    for (size_t i = 0; i < SSFR_COUNT(texts); i++) {
        ssfr_frame_range r = {1, 2, 3, false, false};
        char says[64];
        snprintf(says, sizeof says, "frames '%s': expected A, A:B or A:B:STEP", texts[i]);
        assert_fails(SSFR_ERR_VALUE, ssfr_frame_range_parse(&r, texts[i]), says);
        assert_true(r.first == 1 && r.last == 2 && r.step == 3);
    }
}

/* Joins the frames with commas. */
static const char *join(size_t n, const long *frames)
{
    static char text[128];
    size_t length = 0;
    text[0] = '\0';
    for (size_t i = 0; i < n; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, i ? ",%ld" : "%ld", frames[i]);
    return text;
}

static const long gaps[] = {2, 3, 5, 8, 11, 12}, whole[] = {0, 1, 2, 3, 4, 5};

static void a_range_chooses_among_the_frames_that_are_there(void **state)
{
    (void)state;
    static const struct {
        const char *range;
        const long *there;
        const char *frames;
    } cases[] = {
        {":", gaps, "2,3,5,8,11,12"}, {":", whole, "0,1,2,3,4,5"},  {"3", gaps, "3"},      {"2:3", gaps, "2,3"},
        {"11:12", gaps, "11,12"},     {"5:", gaps, "5,8,11,12"},    {"4:", gaps, "5,8,11,12"},
        {":8", gaps, "2,3,5,8"},      {":9", gaps, "2,3,5,8"},      {"2:11:3", gaps, "2,5,8,11"},
        {"2:13:3", gaps, "2,5,8,11"}, {"::3", gaps, "2,5,8,11"},    {"::2", gaps, "2,8,12"}, {"3::2", gaps, "3,5,11"},
        {"0:5:2", whole, "0,2,4"},    {"0:4:2", whole, "0,2,4"},    {":5:5", whole, "0,5"},  {"1:5:9", whole, "1"},
        {"12:999999999:999999999", gaps, "12"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_frame_range range;
        size_t n = 0;
        long *frames = NULL;
        assert_int_equal(ssfr_frame_range_parse(&range, cases[i].range), SSFR_OK);
        assert_int_equal(ssfr_frame_range_choose(&range, "set", SSFR_COUNT(gaps), cases[i].there, &n, &frames),
                         SSFR_OK);
        assert_string_equal(join(n, frames), cases[i].frames);
        free(frames);
    }
}

static void missing_frames_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *range, *says;
    } cases[] = {
        {"4", "set: there is no frame 4"},
        {"1:3", "set: there is no frame 1"},
        {"2:5", "set: there is no frame 4"},
        {"11:13", "set: there is no frame 13"},
        {"2:8", "set: there is no frame 4, and 2 more of 2 to 8 are missing"},
        {"11:20", "set: there is no frame 13, and 7 more of 11 to 20 are missing"},
        {"20:30:5", "set: there is no frame 20, and 2 more of 20 to 30 are missing"},
        {"0:999999999", "set: there is no frame 0, and 999999993 more of 0 to 999999999 are missing"},
        {"13:", "set: there are no frames from 13 to"},
        {":1", "set: there are no frames from 0 to 1"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_frame_range range;
        size_t n = 1;
        long *frames = NULL;
        assert_int_equal(ssfr_frame_range_parse(&range, cases[i].range), SSFR_OK);
        assert_fails(SSFR_ERR_VALUE, ssfr_frame_range_choose(&range, "set", SSFR_COUNT(gaps), gaps, &n, &frames),
                     cases[i].says);
        assert_true(!frames && n == 0);
    }
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

/* A file of this test's folder. */
static const char *touch(const char *name)
{
    const char *path = test_path(name);
    test_write_file(path, "", 0);
    return path;
}

static void the_files_that_are_there_are_found(void **state)
{
    (void)state;
    static const char *const names[] = {
        "s_0010.ply",      "s_0002.ply",   "s_0003.ply", "s_12345.ply", "s_012345.ply",
        "s_2.ply",         "s_007.ply",    "s_0005.vtk", "s_-001.ply",  "s_0x12.ply",
        "s_0006.ply.part", "a_s_0008.ply", "s_.ply",     "s_1000000000.ply", "s_00000000000000000011.ply",
    };
    size_t n = 0;
    long *frames = NULL;
    for (size_t i = 0; i < SSFR_COUNT(names); i++) touch(names[i]);
    assert_int_equal(ssfr_sequence_find(test_path("s_%04d.ply"), &n, &frames), SSFR_OK);
    assert_string_equal(join(n, frames), "2,3,10,12345");
    free(frames);
    assert_int_equal(ssfr_sequence_find(test_path("s_%d.ply"), &n, &frames), SSFR_OK);
    assert_string_equal(join(n, frames), "2,12345");
    free(frames);
    assert_int_equal(ssfr_sequence_find(test_path("t_%d.ply"), &n, &frames), SSFR_OK);
    assert_int_equal(n, 0);
    free(frames);
}

static void many_files_are_found_in_their_order(void **state)
{
    (void)state;
    enum { N = 700 };
    const char *pattern = test_path("many_%03d.h5");
    size_t n = 0;
    long *frames = NULL;
    for (long i = 0; i < N; i++) {
        char *path = NULL;
        assert_int_equal(ssfr_sequence_path(pattern, i * 271 % N, &path), SSFR_OK); /* in another order */
        test_write_file(path, "", 0);
        free(path);
    }
    assert_int_equal(ssfr_sequence_frames(pattern, &ssfr_frame_range_all, &n, &frames), SSFR_OK);
    assert_int_equal(n, N);
    for (long i = 0; i < N; i++) assert_int_equal(frames[i], i);
    free(frames);
}

static void a_range_of_files_needs_each_of_them(void **state)
{
    (void)state;
    const ssfr_frame_range range = {3, 5, 1, false, false};
    const char *pattern = test_path("r_%d.vtk");
    size_t n = 0;
    long *frames = NULL;
    touch("r_3.vtk");
    touch("r_5.vtk");
    assert_fails(SSFR_ERR_VALUE, ssfr_sequence_frames(pattern, &range, &n, &frames), "r_%d.vtk: there is no frame 4");
    touch("r_4.vtk");
    assert_int_equal(ssfr_sequence_frames(pattern, &range, &n, &frames), SSFR_OK);
    assert_string_equal(join(n, frames), "3,4,5");
    free(frames);
    assert_fails(SSFR_ERR_VALUE, ssfr_sequence_frames(test_path("q_%d.vtk"), &ssfr_frame_range_all, &n, &frames),
                 "q_%d.vtk: there are no frames from 0");
    assert_fails(SSFR_ERR_IO, ssfr_sequence_frames(test_path("missing/q_%d.vtk"), &range, &n, &frames),
                 "missing/: No such file");
    assert_true(!frames && n == 0);
}

static void a_pattern_without_a_folder_is_of_the_current_one(void **state)
{
    (void)state;
    char before[1024], folder[128];
    size_t n = 0;
    long *frames = NULL;
    assert_non_null(getcwd(before, sizeof before));
    snprintf(folder, sizeof folder, "%s", touch("here_0.pos"));
    *strrchr(folder, '/') = '\0';
    assert_int_equal(chdir(folder), 0);
    const ssfr_result result = ssfr_sequence_find("here_%d.pos", &n, &frames);
    assert_int_equal(chdir(before), 0);
    assert_int_equal(result, SSFR_OK);
    assert_string_equal(join(n, frames), "0");
    free(frames);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frames_path_has_its_number_filled_up_with_zeros),
        cmocka_unit_test(only_names_with_a_percent_sign_are_sequences),
        cmocka_unit_test(patterns_of_another_form_are_refused),
        cmocka_unit_test(frames_below_0_or_of_too_many_digits_have_no_path),
        cmocka_unit_test(ranges_are_read),
        cmocka_unit_test(ranges_of_another_form_are_refused),
        cmocka_unit_test(a_range_chooses_among_the_frames_that_are_there),
        cmocka_unit_test(missing_frames_are_named),
        cmocka_unit_test(the_files_that_are_there_are_found),
        cmocka_unit_test(many_files_are_found_in_their_order),
        cmocka_unit_test(a_range_of_files_needs_each_of_them),
        cmocka_unit_test(a_pattern_without_a_folder_is_of_the_current_one),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_slot_picture.c: false colours rise from blue to yellow, what holds nothing is grey, ends are found and kept. */
#include "experiments/slot_picture.h"
#include "tests/util.h"

enum { W = 100, H = 4 };

/* Thickness rises along x from 0, which is none, to 0.99 m; one pixel is NaN. */
static ssfr_field *make_thickness(void)
{
    ssfr_field *field = NULL;
    assert_int_equal(ssfr_field_create(&field, W, H, 1), SSFR_OK);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) *ssfr_field_at(field, x, y) = 0.01 * x;
    *ssfr_field_at(field, 50, 3) = NAN;
    return field;
}

static ssfr_field *draw(const ssfr_field *field, const ssfr_slot_picture *picture)
{
    const char *path = test_path("slot.png");
    ssfr_field *drawn = NULL;
    assert_int_equal(ssfr_slot_picture_save(path, field, picture), SSFR_OK);
    assert_int_equal(ssfr_png_load(path, &drawn), SSFR_OK);
    assert_int_equal(drawn->w, field->w);
    assert_int_equal(drawn->h, field->h);
    return drawn;
}

static double luminance(const double *c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

static bool is_grey(const double *c) { return c[0] == c[1] && c[1] == c[2]; }

static void lightness_rises_with_the_value_and_nothing_is_grey(void **state)
{
    (void)state;
    ssfr_field *field = make_thickness();
    ssfr_field *drawn = draw(field, &(ssfr_slot_picture){.slot = "thickness", .lo = 0, .hi = 0.99});
    const double *low = ssfr_field_at(drawn, 1, 0), *high = ssfr_field_at(drawn, W - 1, 0);
    assert_true(low[2] > 2 * low[1]);
    assert_true(high[0] > 5 * high[2] && high[1] > 5 * high[2]);
    for (int x = 2; x < W; x++)
        assert_true(luminance(ssfr_field_at(drawn, x, 0)) >= luminance(ssfr_field_at(drawn, x - 1, 0)));
    assert_true(is_grey(ssfr_field_at(drawn, 0, 0)));
    assert_true(is_grey(ssfr_field_at(drawn, 50, 3)));
    assert_false(is_grey(ssfr_field_at(drawn, 50, 2)));
    ssfr_field_destroy(&drawn);
    ssfr_field_destroy(&field);
}

static void what_is_beyond_the_range_has_the_colour_of_its_end(void **state)
{
    (void)state;
    ssfr_field *field = make_thickness();
    ssfr_field *drawn = draw(field, &(ssfr_slot_picture){.slot = "thickness", .lo = 0.25, .hi = 0.75});
    assert_memory_equal(ssfr_field_at(drawn, 1, 0), ssfr_field_at(drawn, 25, 0), 3 * sizeof(double));
    assert_memory_equal(ssfr_field_at(drawn, 99, 0), ssfr_field_at(drawn, 75, 0), 3 * sizeof(double));
    assert_true(luminance(ssfr_field_at(drawn, 27, 0)) > luminance(ssfr_field_at(drawn, 25, 0)));
    ssfr_field_destroy(&drawn);
    ssfr_field_destroy(&field);
}

/* 396 values but for three of nothing and NaN: two of each hundred are beyond each end, however far they are. */
static void a_range_that_nobody_gives_leaves_out_the_farthest(void **state)
{
    (void)state;
    ssfr_field *field = make_thickness();
    *ssfr_field_at(field, 99, 0) = 1e9;
    ssfr_field *own = draw(field, &(ssfr_slot_picture){.slot = "thickness", .lo = NAN, .hi = NAN});
    ssfr_field *given = draw(field, &(ssfr_slot_picture){.slot = "thickness", .lo = 0.02, .hi = 0.98});
    for (int i = 0; i < W * H * 3; i++) assert_true(fabs(own->data[i] - given->data[i]) < 0.05);
    ssfr_field_destroy(&own);
    ssfr_field_destroy(&given);
    ssfr_field_destroy(&field);
}

static void an_image_of_nothing_and_one_of_one_value_have_a_colour(void **state)
{
    (void)state;
    ssfr_field *field = NULL;
    assert_int_equal(ssfr_field_create(&field, 2, 2, 1), SSFR_OK);
    const ssfr_slot_picture picture = {.slot = "thickness", .lo = NAN, .hi = NAN};
    ssfr_field *none = draw(field, &picture);
    for (int i = 0; i < 4; i++) field->data[i] = 3;
    ssfr_field *one = draw(field, &picture);
    assert_true(is_grey(none->data));
    assert_false(is_grey(one->data));
    ssfr_field_destroy(&none);
    ssfr_field_destroy(&one);
    ssfr_field_destroy(&field);
}

static void colours_are_of_one_channel_and_go_where_a_file_can(void **state)
{
    (void)state;
    ssfr_field *three = NULL, *one = NULL;
    const ssfr_slot_picture normal = {.slot = "normal", .lo = NAN, .hi = NAN}, depth = {.slot = "fluid_depth"};
    assert_int_equal(ssfr_field_create(&three, 2, 2, 3), SSFR_OK);
    assert_int_equal(ssfr_field_create(&one, 2, 2, 1), SSFR_OK);
    assert_fails(ssfr_slot_picture_save("a.png", three, &normal), SSFR_ERR_VALUE, "normal has 3 channels");
    assert_fails(ssfr_slot_picture_save(test_path("absent/a.png"), one, &depth), SSFR_ERR_IO, "absent");
    ssfr_field_destroy(&three);
    ssfr_field_destroy(&one);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lightness_rises_with_the_value_and_nothing_is_grey),
        cmocka_unit_test(what_is_beyond_the_range_has_the_colour_of_its_end),
        cmocka_unit_test(a_range_that_nobody_gives_leaves_out_the_farthest),
        cmocka_unit_test(an_image_of_nothing_and_one_of_one_value_have_a_colour),
        cmocka_unit_test(colours_are_of_one_channel_and_go_where_a_file_can),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

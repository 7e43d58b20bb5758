/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_difference_picture.c: what is nearer is red, what is farther blue, and what only one image has stands apart. */
#include "experiments/difference_picture.h"
#include "tests/util.h"

#include <unistd.h>

enum { W = 40, H = 30 };

typedef struct images {
    ssfr_field *a, *b;
} images;

/* Columns of four kinds from the left: A nearer by 2.385 radii, A farther, only in A, only in B; below all: nothing. */
static void make_images(images *i, double radius)
{
    assert_int_equal(ssfr_field_create(&i->a, W, H, 1), SSFR_OK);
    assert_int_equal(ssfr_field_create(&i->b, W, H, 1), SSFR_OK);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            const int kind = y < H / 2 ? x * 4 / W : 4;
            *ssfr_field_at(i->a, x, y) = kind > 2 ? -SSFR_EMPTY : -5 + (kind == 0 ? 2.385 : -2.385) * radius;
            *ssfr_field_at(i->b, x, y) = kind == 2 || kind == 4 ? -SSFR_EMPTY : -5;
        }
}

static void finish(images *i)
{
    ssfr_field_destroy(&i->a);
    ssfr_field_destroy(&i->b);
}

/* The picture's pixel in the middle of a pixel of the images, which are drawn 16 times as large. */
static const double *pixel_of(const ssfr_field *picture, int x, int y)
{
    return ssfr_field_at(picture, 20 + 16 * x + 8, picture->h - 20 - 16 * (H - y) + 8);
}

static ssfr_field *draw_or_skip(const images *i, const ssfr_difference_picture *picture)
{
    const char *path = test_path("difference.png");
    ssfr_field *drawn = NULL;
    assert_int_equal(ssfr_difference_picture_save(path, i->a, i->b, picture), SSFR_OK);
    if (access(path, R_OK) != 0) skip(); /* no gnuplot */
    assert_int_equal(ssfr_png_load(path, &drawn), SSFR_OK);
    return drawn;
}

static void colours_say_which_is_nearer_and_which_is_missing(void **state)
{
    (void)state;
    images i;
    make_images(&i, 0.02);
    const ssfr_difference_picture picture = {.title = "A and B", .radius = 0.02, .range = 3};
    ssfr_field *drawn = draw_or_skip(&i, &picture);
    const double *nearer = pixel_of(drawn, 5, 5), *farther = pixel_of(drawn, 15, 5), *only_a = pixel_of(drawn, 25, 5),
                 *only_b = pixel_of(drawn, 35, 5), *none = pixel_of(drawn, 20, 25);
    assert_true(nearer[0] > 2 * nearer[2] && nearer[0] > 2 * nearer[1]);
    assert_true(farther[2] > 2 * farther[0]);
    assert_true(only_a[0] > 0.5 && only_a[1] > 0.2 && only_a[2] < 0.05);  /* orange */
    assert_true(only_b[1] > 2 * only_b[0] && only_b[1] > 1.5 * only_b[2]); /* green */
    assert_true(none[0] == none[1] && none[1] == none[2] && none[0] > 0.3 && none[0] < 0.7);
    assert_int_equal(drawn->w, 16 * W + 170);
    ssfr_field_destroy(&drawn);
    finish(&i);
}

/* The same difference is dark against a narrow bar and pale against a wide one. */
static void the_range_is_what_is_asked_for_or_what_there_is(void **state)
{
    (void)state;
    static const double ranges[] = {100, 0, 2};
    double last = 2;
    images i;
    make_images(&i, 1);
    for (size_t k = 0; k < SSFR_COUNT(ranges); k++) {
        const ssfr_difference_picture picture = {.title = "", .range = ranges[k]};
        ssfr_field *drawn = draw_or_skip(&i, &picture);
        const double *nearer = pixel_of(drawn, 5, 5);
        assert_true(nearer[1] < last); /* paler is greener */
        last = nearer[1];
        ssfr_field_destroy(&drawn);
    }
    finish(&i);
}

/* Of 20 pixels 18 differ by 2.1 at most, one by 2.385, one by 9: 95 of 100 lie within 2.385, so a bar to 5 holds. */
static void the_bar_holds_95_of_100_pixels_and_ends_at_a_round_number(void **state)
{
    (void)state;
    images i;
    make_images(&i, 1);
    for (int k = 0; k < W * H; k++) {
        i.b->data[k] = -5;
        i.a->data[k] = -5 + (k % 20 == 19 ? 9 : k % 20 == 18 || k == 0 ? 2.385 : 2.1 * (k % 20) / 17);
    }
    ssfr_field *own = draw_or_skip(&i, &(ssfr_difference_picture){.title = "own"});
    ssfr_field *same = draw_or_skip(&i, &(ssfr_difference_picture){.title = "own", .range = 5});
    assert_memory_equal(own->data, same->data, (size_t)own->w * (size_t)own->h * (size_t)own->c * sizeof *own->data);
    ssfr_field_destroy(&own), ssfr_field_destroy(&same);
    finish(&i);
}

static void images_without_a_surface_are_drawn_too(void **state)
{
    (void)state;
    images i;
    make_images(&i, 1);
    ssfr_field_fill(i.a, -SSFR_EMPTY);
    ssfr_field_fill(i.b, -SSFR_EMPTY);
    ssfr_field *drawn = draw_or_skip(&i, &(ssfr_difference_picture){.title = "nothing"});
    const double *none = pixel_of(drawn, 5, 5);
    assert_true(none[0] == none[1] && none[1] == none[2]);
    ssfr_field_destroy(&drawn);
    finish(&i);
}

static void what_is_not_counted_is_not_drawn(void **state)
{
    (void)state;
    images i;
    ssfr_field *mask = NULL;
    make_images(&i, 1);
    assert_int_equal(ssfr_field_create(&mask, W, H, 1), SSFR_OK);
    *ssfr_field_at(mask, 5, 5) = 1;
    ssfr_field *drawn = draw_or_skip(&i, &(ssfr_difference_picture){.title = "a sample", .range = 3, .mask = mask});
    const double *counted = pixel_of(drawn, 5, 5);
    assert_true(counted[0] > 2 * counted[2]);
    for (int x = 6; x < W; x += 10) assert_true(pixel_of(drawn, x, 5)[0] == pixel_of(drawn, x, 5)[2]); /* grey */
    ssfr_field_destroy(&mask);
    ssfr_field_destroy(&drawn);
    finish(&i);
}

static void images_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    const ssfr_difference_picture picture = {.title = ""};
    images i;
    ssfr_field *other = NULL, *colour = NULL;
    make_images(&i, 1);
    assert_int_equal(ssfr_field_create(&other, W, H + 1, 1), SSFR_OK);
    assert_int_equal(ssfr_field_create(&colour, W, H, 3), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_difference_picture_save("d.png", i.a, other, &picture), "40x30 and 40x31 pixels");
    assert_fails(SSFR_ERR_VALUE, ssfr_difference_picture_save("d.png", i.a, colour, &picture), "of 1 and 3 channels");
    assert_fails(SSFR_ERR_IO, ssfr_difference_picture_save("/nowhere/d.png", i.a, i.b, &picture), "/nowhere/d.png");
    ssfr_field_destroy(&other);
    ssfr_field_destroy(&colour);
    finish(&i);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_say_which_is_nearer_and_which_is_missing),
        cmocka_unit_test(the_range_is_what_is_asked_for_or_what_there_is),
        cmocka_unit_test(the_bar_holds_95_of_100_pixels_and_ends_at_a_round_number),
        cmocka_unit_test(images_without_a_surface_are_drawn_too),
        cmocka_unit_test(what_is_not_counted_is_not_drawn),
        cmocka_unit_test(images_that_do_not_fit_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

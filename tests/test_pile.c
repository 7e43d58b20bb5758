/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_pile.c: what may be over a pixel is counted there, and nowhere far from it. */
#include "experiments/pile.h"
#include "tests/frames.h"

enum { W = 80, H = 60 };

static ssfr_field *pile(const test_scene *s, double reach, const float *sizes, bool by_size)
{
    ssfr_field *out = NULL;
    const ssfr_pile_options options = {.sizes = sizes, .reach = reach, .by_size = by_size};
    assert_int_equal(ssfr_pile(&out, s->scene.particles, &s->scene.camera, &options), SSFR_OK);
    assert_true(out->w == s->scene.camera.w && out->h == s->scene.camera.h && out->c == 1);
    return out;
}

static void create(test_scene *s, size_t n, const double *places)
{
    test_scene_create(s, n, places, 0.1);
    test_scene_look(s, (const double[3]){0, 0, 0}, (const double[3]){0, 0, -1}, 60, W, H);
}

/* 60 px are 2 tan(30 degrees) at 1 m, so 0.2 m at 2 m are 5.2 px; nearer than its middle a little more. */
static void a_particle_counts_where_it_may_be_seen(void **state)
{
    (void)state;
    test_scene s;
    create(&s, 1, (const double[]){0.4, 0.2, -2});
    ssfr_field *one = pile(&s, 0.1, NULL, false);
    const int x = 50, y = 24; /* 40 + 0.2 52, 30 - 0.1 52 */
    for (int j = 0; j < H; j++)
        for (int i = 0; i < W; i++) {
            const int far = abs(i - x) > abs(j - y) ? abs(i - x) : abs(j - y);
            if (far <= 3) assert_close(*ssfr_field_at(one, i, j), 1, 0, 0);
            if (far >= 7) assert_close(*ssfr_field_at(one, i, j), 0, 0, 0);
        }
    ssfr_field_destroy(&one);
    test_scene_destroy(&s);
}

/* No less than chords add up to; a splat twice as wide has a quarter of the chord. */
static void spheres_that_are_drawn_are_no_more_than_their_pile(void **state)
{
    (void)state;
    test_scene s;
    test_scene_create_usual(&s, 4 * W, 4 * H);
    ssfr_graph *graph = test_graph(ssfr_pipeline_find("vanderlaan2009"), NULL);
    test_graph_set(graph, (const char *[]){"thickness.splat=exact", "thickness.radius_scale=2", NULL});
    assert_int_equal(ssfr_graph_want(graph, "thickness"), SSFR_OK);
    ssfr_field *drawn = test_graph_picture(graph, &s.scene, "thickness", false);
    ssfr_field *most = pile(&s, 2 * s.particles->radius, NULL, false);
    int n_tight = 0;
    for (int i = 0; i < drawn->w * drawn->h; i++) {
        const double bound = s.particles->radius / 2 * most->data[i];
        assert_true(drawn->data[i] <= bound);
        n_tight += bound > 0 && drawn->data[i] > 0.4 * bound; /* a ball is 0.52 of its cube */
    }
    assert_true(n_tight > 100);
    ssfr_field_destroy(&most), ssfr_field_destroy(&drawn);
    ssfr_graph_destroy(&graph);
    test_scene_destroy(&s);
}

static void particles_count_by_their_size_rounded_up(void **state)
{
    (void)state;
    static const float sizes[] = {0.5F, 0, 0.3F, NAN};
    test_scene s;
    create(&s, 4, (const double[12]){0, 0, -2, 0, 0, -3, 0, 0, -4, 0, 0, -5});
    ssfr_field *by_size = pile(&s, 0.1, sizes, true), *each = pile(&s, 0.1, sizes, false);
    assert_close(*ssfr_field_at(by_size, W / 2, H / 2), 0.5 + 77.0 / 256, 0, 0);
    assert_close(*ssfr_field_at(each, W / 2, H / 2), 2, 0, 0);
    assert_close(*ssfr_field_at(by_size, 0, 0), 0, 0, 0);
    ssfr_field_destroy(&by_size), ssfr_field_destroy(&each);
    test_scene_destroy(&s);
}

/* Beside the view and behind it there is nothing; around the eye there may be something at every pixel. */
static void what_reaches_behind_the_eye_may_be_anywhere(void **state)
{
    (void)state;
    test_scene s;
    create(&s, 4, (const double[12]){5, 0, -2, 0, -9, -2, 0, 0, 3, 0.02, 0.01, -0.05});
    ssfr_field *around = pile(&s, 0.1, NULL, false), *none = pile(&s, 0.01, NULL, false);
    for (int i = 0; i < W * H; i++) assert_close(around->data[i], 1, 0, 0);
    assert_close(*ssfr_field_at(none, 0, 0), 0, 0, 0);
    ssfr_field_destroy(&around), ssfr_field_destroy(&none);
    s.scene.particles = NULL;
    none = pile(&s, 0.1, NULL, false);
    for (int i = 0; i < W * H; i++) assert_close(none->data[i], 0, 0, 0);
    ssfr_field_destroy(&none);
    test_scene_destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_counts_where_it_may_be_seen),
        cmocka_unit_test(spheres_that_are_drawn_are_no_more_than_their_pile),
        cmocka_unit_test(particles_count_by_their_size_rounded_up),
        cmocka_unit_test(what_reaches_behind_the_eye_may_be_anywhere),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_boxes.c: which balls a ray meets, by the tree and by trying all of them. */
#include "experiments/truth/boxes.h"
#include "tests/util.h"

#include <omp.h>

enum { MOST = 4096 };

static double centre[MOST][3], reach[MOST];
static bool seen[MOST];

typedef struct visits {
    uint32_t n, leaves, last_end, stop_after;
} visits;

/* Leaves come in their order and are never empty. */
static bool visit(void *user, uint32_t begin, uint32_t end)
{
    visits *v = user;
    assert_true(begin < end && begin >= v->last_end && end - begin <= SSFR_BOXES_LEAF);
    for (uint32_t i = begin; i < end; i++) seen[i] = true;
    v->n += end - begin;
    v->leaves++;
    v->last_end = end;
    return v->leaves != v->stop_after;
}

static visits walk(const ssfr_boxes *boxes, const ssfr_ray *ray, double from, double to)
{
    visits v = {0};
    memset(seen, 0, sizeof seen);
    ssfr_boxes_along(boxes, ray, from, to, visit, &v);
    assert_true(v.last_end <= boxes->n);
    return v;
}

/* Whether the ray meets a ball, in more digits than the tree has. */
static bool meets(const ssfr_ray *ray, double from, double to, const double c[3], double r)
{
    long double along = 0, dir2 = 0, aside2 = 0, o[3];
    for (int k = 0; k < 3; k++) {
        o[k] = (long double)ray->origin[k] - (long double)c[k];
        along -= o[k] * (long double)ray->dir[k];
        dir2 += (long double)ray->dir[k] * (long double)ray->dir[k];
    }
    for (int k = 0; k < 3; k++) {
        const long double aside = o[k] + along / dir2 * (long double)ray->dir[k];
        aside2 += aside * aside;
    }
    const long double left = (long double)r * (long double)r - aside2;
    if (!(left >= 0)) return false;
    const long double half = sqrtl(left / dir2), middle = along / dir2;
    return middle + half >= (long double)from && middle - half <= (long double)to;
}

/* Every ball that the ray meets is among those visited, and within what the ray is clipped to; gives how many. */
static size_t check(const ssfr_boxes *boxes, const ssfr_ray *ray, double from, double to)
{
    size_t n_met = 0;
    double enter = from, leave = to;
    walk(boxes, ray, from, to);
    const bool clipped = ssfr_boxes_clip(boxes, ray, &enter, &leave);
    assert_true(enter >= from && leave <= to);
    for (size_t i = 0; i < boxes->n; i++) {
        if (!meets(ray, from, to, centre[i], reach[i])) continue;
        assert_true(seen[i]);
        assert_true(clipped && meets(ray, enter, leave, centre[i], reach[i]));
        n_met++;
    }
    return n_met;
}

static void scatter(size_t n, double extent, double least, double most)
{
    uint64_t seed = 2385;
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) centre[i][k] = test_random(&seed, -extent, extent);
        reach[i] = test_random(&seed, least, most);
    }
}

static ssfr_boxes boxes_of(size_t n, const double *reaches, double same)
{
    ssfr_boxes boxes;
    assert_int_equal(ssfr_boxes_init(&boxes, n, (const double(*)[3])centre, reaches, same), SSFR_OK);
    assert_int_equal(boxes.n, n);
    return boxes;
}

/* From a place near the balls towards one of them, past its middle by up to its reach. */
static ssfr_ray ray_at(uint64_t *seed, size_t n, double extent)
{
    ssfr_ray ray;
    const size_t i = (size_t)test_random(seed, 0, (double)n);
    for (int k = 0; k < 3; k++) ray.origin[k] = test_random(seed, -1.5 * extent, 1.5 * extent);
    for (int k = 0; k < 3; k++) ray.dir[k] = centre[i][k] + test_random(seed, -1, 1) * reach[i] - ray.origin[k];
    ssfr_normalize(ray.dir);
    return ray;
}

static void every_ball_that_a_ray_meets_is_visited(void **state)
{
    (void)state;
    uint64_t seed = 17;
    size_t n_met = 0;
    scatter(2385, 1.7, 0.01, 0.1);
    ssfr_boxes boxes = boxes_of(2385, reach, 0);
    for (int i = 0; i < 500; i++) {
        const ssfr_ray ray = ray_at(&seed, boxes.n, 1.7);
        const double from = test_random(&seed, 0, 2);
        n_met += check(&boxes, &ray, 0, INFINITY);
        n_met += check(&boxes, &ray, from, from + test_random(&seed, 0, 2));
    }
    assert_true(n_met > 500);
    ssfr_boxes_finish(&boxes);
    assert_null(boxes.boxes);
}

static void any_number_of_balls_makes_a_tree(void **state)
{
    (void)state;
    uint64_t seed = 71;
    size_t n_met = 0;
    scatter(70, 0.3, 0.02, 0.05);
    for (size_t n = 1; n <= 70; n++) {
        ssfr_boxes boxes = boxes_of(n, reach, 0);
        assert_int_equal(boxes.count[boxes.n_levels - 1], 1);
        assert_int_equal(boxes.count[0], (n + SSFR_BOXES_LEAF - 1) / SSFR_BOXES_LEAF);
        assert_true(ssfr_boxes_bytes(&boxes) >= boxes.count[0] * sizeof(ssfr_box));
        for (int i = 0; i < 20; i++) {
            const ssfr_ray ray = ray_at(&seed, n, 0.3);
            n_met += check(&boxes, &ray, 0, INFINITY);
        }
        ssfr_boxes_finish(&boxes);
    }
    assert_true(n_met > 700);
}

static void no_balls_are_never_met(void **state)
{
    (void)state;
    const ssfr_ray ray = {{0, 0, 0}, {0, 0, 1}};
    double from = 0, to = INFINITY;
    ssfr_boxes boxes;
    assert_int_equal(ssfr_boxes_init(&boxes, 0, NULL, NULL, 0.1), SSFR_OK);
    assert_int_equal(boxes.n_levels, 0);
    assert_int_equal(ssfr_boxes_bytes(&boxes), 0);
    assert_int_equal(walk(&boxes, &ray, from, to).n, 0);
    assert_false(ssfr_boxes_clip(&boxes, &ray, &from, &to));
    ssfr_boxes_finish(&boxes);
}

/* Along each axis, forwards and backwards, with 0 and -0 aside, beginning on the sides of boxes, too. */
static void rays_along_an_axis_meet_what_others_would(void **state)
{
    (void)state;
    size_t n = 0, n_met = 0;
    for (int x = 0; x < 6; x++)
        for (int y = 0; y < 6; y++)
            for (int z = 0; z < 6; z++, n++) {
                centre[n][0] = 0.25 * x, centre[n][1] = 0.25 * y, centre[n][2] = 0.25 * z;
                reach[n] = 0.125;
            }
    ssfr_boxes boxes = boxes_of(n, NULL, 0.125);
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2)
            for (int a = -2; a <= 12; a++)
                for (int b = -2; b <= 12; b++) {
                    ssfr_ray ray = {{0}, {sign * 0.0, sign * -0.0, sign * 0.0}};
                    ray.dir[axis] = sign;
                    ray.origin[axis] = -2 * sign;
                    ray.origin[(axis + 1) % 3] = 0.125 * a, ray.origin[(axis + 2) % 3] = 0.125 * b;
                    n_met += check(&boxes, &ray, 0, INFINITY);
                }
    assert_int_equal(n_met, 6 * (36 * 6 + 2 * 12 * 6 * 6)); /* through middles; half-way between, touching */
    ssfr_boxes_finish(&boxes);
}

/* Rays that touch a ball where it touches its box, or miss it by a corner. */
static void a_touch_is_no_miss(void **state)
{
    (void)state;
    uint64_t seed = 5;
    size_t n_met = 0;
    scatter(300, 1.3, 0.02, 0.03);
    ssfr_boxes boxes = boxes_of(300, reach, 0);
    for (size_t i = 0; i < 300; i++)
        for (int k = 0; k < 3; k++) {
            ssfr_ray ray = {{0}, {0}};
            for (int c = 0; c < 3; c++) ray.origin[c] = centre[i][c];
            ray.dir[(k + 1) % 3] = test_random(&seed, -1, 1), ray.dir[(k + 2) % 3] = test_random(&seed, -1, 1);
            ssfr_normalize(ray.dir);
            ray.origin[k] += reach[i] * (i % 2 ? 1 : -1);
            for (int c = 0; c < 3; c++) ray.origin[c] -= 3 * ray.dir[c];
            n_met += check(&boxes, &ray, 0, INFINITY);
        }
    assert_true(n_met >= 300);
    ssfr_boxes_finish(&boxes);
}

static void rays_that_begin_among_the_balls_meet_those_ahead(void **state)
{
    (void)state;
    uint64_t seed = 6;
    scatter(1000, 0.5, 0.02, 0.06);
    ssfr_boxes boxes = boxes_of(1000, reach, 0);
    for (size_t i = 0; i < 200; i++) {
        ssfr_ray ray = ray_at(&seed, 1000, 0.1);
        memcpy(ray.origin, centre[i], sizeof ray.origin);
        assert_true(check(&boxes, &ray, 0, INFINITY) > 0);
        assert_true(check(&boxes, &ray, 0, 1e-3) > 0);
        assert_true(check(&boxes, &ray, 0, 0) > 0);
    }
    ssfr_boxes_finish(&boxes);
}

static void balls_in_one_place_are_all_met(void **state)
{
    (void)state;
    const ssfr_ray through = {{0.2385, -3, 0.5}, {0, 1, 0}}, past = {{0.2585, -3, 0.5}, {0, 1, 0}};
    for (size_t i = 0; i < 1000; i++) {
        centre[i][0] = 0.2385, centre[i][1] = 7.7, centre[i][2] = 0.5;
        reach[i] = 0;
    }
    ssfr_boxes boxes = boxes_of(1000, NULL, 0);
    assert_int_equal(check(&boxes, &through, 0, INFINITY), 1000);
    assert_int_equal(walk(&boxes, &past, 0, INFINITY).n, 0);
    ssfr_boxes_finish(&boxes);
}

/* Floats are then coarser than the balls. */
static void small_balls_are_met_in_large_scenes(void **state)
{
    (void)state;
    uint64_t seed = 8;
    size_t n_met = 0;
    scatter(1000, 1e6, 0.01, 0.01);
    ssfr_boxes boxes = boxes_of(1000, NULL, 0.01);
    for (int i = 0; i < 1000; i++) {
        const ssfr_ray ray = ray_at(&seed, boxes.n, 1e6);
        n_met += check(&boxes, &ray, 0, INFINITY);
    }
    assert_true(n_met > 200); /* those that are near enough to the ball's middle */
    ssfr_boxes_finish(&boxes);
}

/* The ray's places are then coarser than a float's step at the balls. */
static void balls_at_the_origin_are_met_from_far_away(void **state)
{
    (void)state;
    uint64_t seed = 9;
    size_t n_met = 0;
    scatter(64, 1e-3, 1e-5, 2e-5);
    ssfr_boxes boxes = boxes_of(64, reach, 0);
    for (int i = 0; i < 1000; i++) {
        const ssfr_ray ray = ray_at(&seed, boxes.n, 1e7);
        n_met += check(&boxes, &ray, 0, INFINITY);
    }
    assert_true(n_met > 500);
    ssfr_boxes_finish(&boxes);
}

static void a_centre_and_a_reach_that_cancel_lose_nothing(void **state)
{
    (void)state;
    /* 1e6 + 0.1 is rounded by 1e-11 m, while a float near its lower end would have steps of 1e-18 m or so. */
    const ssfr_ray ray = {{1e6 + 0.1 - (1e6 + 0.1), 1, 0}, {0, -1, 0}};
    centre[0][0] = 1e6 + 0.1, centre[0][1] = centre[0][2] = 0;
    reach[0] = 1e6 + 0.1;
    ssfr_boxes boxes = boxes_of(1, reach, 0);
    assert_int_equal(check(&boxes, &ray, 0, INFINITY), 1);
    assert_true(boxes.boxes[0].lo[0] < -1e-11F);
    ssfr_boxes_finish(&boxes);
}

static void a_visitor_stops_the_walk(void **state)
{
    (void)state;
    const ssfr_ray ray = {{-2, 0, 0}, {1, 0, 0}};
    visits v = {.stop_after = 3};
    scatter(1000, 1, 0.5, 0.5);
    ssfr_boxes boxes = boxes_of(1000, NULL, 0.5);
    assert_true(walk(&boxes, &ray, 0, INFINITY).leaves > 3);
    ssfr_boxes_along(&boxes, &ray, 0, INFINITY, visit, &v);
    assert_int_equal(v.leaves, 3);
    ssfr_boxes_finish(&boxes);
}

/* Along Morton's curve, as particles are packed: a ray visits less than a tenth of them, a shorter one less. */
static void a_ray_visits_what_is_near_it(void **state)
{
    (void)state;
    const ssfr_ray ray = {{-1, 0.5, 0.5}, {1, 0, 0}};
    for (size_t i = 0; i < MOST; i++) {
        int at[3] = {0};
        for (int bit = 0; bit < 12; bit++) at[bit % 3] |= (int)(i >> bit & 1) << bit / 3;
        for (int k = 0; k < 3; k++) centre[i][k] = at[k] / 16.0;
    }
    ssfr_boxes boxes = boxes_of(MOST, NULL, 1.0 / 16);
    const visits whole = walk(&boxes, &ray, 0, INFINITY), begun = walk(&boxes, &ray, 0, 1.25);
    assert_true(whole.n > 100 && whole.n < MOST / 10);
    assert_true(begun.n > 10 && begun.n < whole.n / 2);
    const visits rest = walk(&boxes, &ray, 1.75, INFINITY);
    assert_true(rest.n > 10 && rest.n < whole.n / 2);
    assert_int_equal(walk(&boxes, &ray, 1.25, 1).n, 0);
    assert_int_equal(walk(&boxes, &ray, NAN, 1).n, 0);
    ssfr_boxes_finish(&boxes);
}

static void clipping_is_as_tight_as_the_box(void **state)
{
    (void)state;
    const ssfr_ray ray = {{-2.385, 0, 0}, {1, 0, 0}}, away = {{-2.385, 0, 0}, {-1, 0, 0}};
    double from = 0, to = INFINITY;
    memset(centre[0], 0, sizeof centre[0]);
    ssfr_boxes boxes = boxes_of(1, NULL, 0.5);
    assert_true(ssfr_boxes_clip(&boxes, &ray, &from, &to));
    assert_close(from, 1.885, 1e-6, 0);
    assert_close(to, 2.885, 1e-6, 0);
    from = 2, to = 2.5;
    assert_true(ssfr_boxes_clip(&boxes, &ray, &from, &to));
    assert_true(from == 2 && to == 2.5);
    from = 3, to = 4;
    assert_false(ssfr_boxes_clip(&boxes, &ray, &from, &to));
    assert_true(from == 3 && to == 4);
    assert_false(ssfr_boxes_clip(&boxes, &away, &from, &to));
    ssfr_boxes_finish(&boxes);
}

static void threads_change_no_bit(void **state)
{
    (void)state;
    const int threads = omp_get_max_threads();
    scatter(MOST, 3, 0.01, 0.2);
    omp_set_num_threads(1);
    ssfr_boxes one = boxes_of(MOST, reach, 0);
    omp_set_num_threads(3);
    ssfr_boxes three = boxes_of(MOST, reach, 0);
    omp_set_num_threads(threads);
    assert_int_equal(ssfr_boxes_bytes(&one), ssfr_boxes_bytes(&three));
    assert_memory_equal(one.boxes, three.boxes, ssfr_boxes_bytes(&one));
    ssfr_boxes_finish(&one);
    ssfr_boxes_finish(&three);
}

static void more_balls_than_numbers_are_refused(void **state)
{
    (void)state;
    ssfr_boxes boxes;
    assert_fails(SSFR_ERR_UNSUPPORTED,
                 ssfr_boxes_init(&boxes, UINT32_MAX, (const double(*)[3])centre, NULL, 0.1), "4294967295 balls");
    assert_null(boxes.boxes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ball_that_a_ray_meets_is_visited),
        cmocka_unit_test(any_number_of_balls_makes_a_tree),
        cmocka_unit_test(no_balls_are_never_met),
        cmocka_unit_test(rays_along_an_axis_meet_what_others_would),
        cmocka_unit_test(a_touch_is_no_miss),
        cmocka_unit_test(rays_that_begin_among_the_balls_meet_those_ahead),
        cmocka_unit_test(balls_in_one_place_are_all_met),
        cmocka_unit_test(small_balls_are_met_in_large_scenes),
        cmocka_unit_test(balls_at_the_origin_are_met_from_far_away),
        cmocka_unit_test(a_centre_and_a_reach_that_cancel_lose_nothing),
        cmocka_unit_test(a_visitor_stops_the_walk),
        cmocka_unit_test(a_ray_visits_what_is_near_it),
        cmocka_unit_test(clipping_is_as_tight_as_the_box),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(more_balls_than_numbers_are_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

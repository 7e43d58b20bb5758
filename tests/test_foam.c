/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_foam.c: spray, foam and bubbles: potentials by hand, emission, motion by kind, walls, and the state on disk. */
#include "base/param.h"
#include "experiments/scenes/foam.h"
#include "tests/util.h"

#include <omp.h>

#define R 0.02385             /* m, radius of the fluid's particles */
#define H (SSFR_SUPPORT * R)
#define S 0.0442818           /* m, about 2 R 0.8^(1/3): as far apart as particles at rest are */
#define DT 0.0041             /* s */

static const double down[3] = {0, -9.81, 0}, weightless[3] = {0};

/* ---- a fluid of particles placed by hand ------------------------------------------------------------------------- */

enum { MAX_WATER = 40000 };

typedef struct water {
    float position[3 * MAX_WATER], velocity[3 * MAX_WATER], density[MAX_WATER];
    ssfr_grid *grid;
    ssfr_fluid fluid;
} water;

static water *pour(double radius)
{
    water *w = calloc(1, sizeof *w);
    assert_non_null(w);
    w->fluid = (ssfr_fluid){.position = w->position, .velocity = w->velocity, .density = w->density, .radius = radius};
    assert_int_equal(ssfr_grid_create(&w->grid), SSFR_OK);
    w->fluid.grid = w->grid;
    return w;
}

/* at: m, relative to the fluid's origin. */
static void put(water *w, const double at[3], const double velocity[3])
{
    const size_t i = w->fluid.n++;
    assert_true(i < MAX_WATER);
    for (size_t k = 0; k < 3; k++) {
        w->position[3 * i + k] = (float)at[k];
        w->velocity[3 * i + k] = (float)velocity[k];
    }
    w->density[i] = (float)SSFR_REST_DENSITY;
}

/* A cubic lattice of nx ny nz, the first particle half a spacing from lo. */
static void put_lattice(water *w, const double lo[3], int nx, int ny, int nz, const double velocity[3])
{
    for (int i = 0; i < nx * ny * nz; i++) {
        const int x = i % nx, y = i / nx % ny, z = i / nx / ny;
        put(w, (double[3]){lo[0] + (x + 0.5) * S, lo[1] + (y + 0.5) * S, lo[2] + (z + 0.5) * S}, velocity);
    }
}

static const ssfr_fluid *still(water *w)
{
    assert_int_equal(ssfr_grid_build(w->grid, w->fluid.n, w->position, SSFR_SUPPORT * w->fluid.radius), SSFR_OK);
    return &w->fluid;
}

static void drain(water **w)
{
    ssfr_grid_destroy(&(*w)->grid);
    free(*w);
    *w = NULL;
}

static ssfr_foam_params defaults(void)
{
    ssfr_foam_params p;
    ssfr_params_default(ssfr_foam_rows, &p);
    return p;
}

static ssfr_foam *make(const ssfr_foam_params *params, const double gravity[3], uint64_t seed)
{
    ssfr_foam *foam = NULL;
    assert_int_equal(ssfr_foam_create(&foam, params, gravity, seed), SSFR_OK);
    return foam;
}

static ssfr_foam *make_plain(const double gravity[3])
{
    const ssfr_foam_params p = defaults();
    return make(&p, gravity, 2385);
}

static void add(ssfr_foam *foam, const double at[3], const double velocity[3], double lifetime)
{
    const float v[3] = {(float)velocity[0], (float)velocity[1], (float)velocity[2]}, l = (float)lifetime;
    assert_int_equal(ssfr_foam_add(foam, 1, at, v, &l), SSFR_OK);
}

static void step(ssfr_foam *foam, const ssfr_fluid *fluid, double dt)
{
    assert_int_equal(ssfr_foam_step(foam, fluid, dt, 0, NULL), SSFR_OK);
}

/* What is exported of a particle. */
typedef struct seen {
    double at[3], velocity[3], lifetime, initial_lifetime;
    uint32_t id, kind;
} seen;

static int by_id(const void *a, const void *b)
{
    const uint32_t x = ((const seen *)a)->id, y = ((const seen *)b)->id;
    return x < y ? -1 : x > y;
}

/* All, by id. To free(). */
static seen *see(const ssfr_foam *foam)
{
    ssfr_particles *p = NULL;
    assert_int_equal(ssfr_foam_export(foam, 0.25 * R, &p), SSFR_OK);
    assert_int_equal(p->n, ssfr_foam_count(foam));
    assert_true(p->radius == 0.25 * R);
    seen *all = calloc(p->n + 1, sizeof *all);
    assert_non_null(all);
    for (size_t i = 0; i < p->n; i++) {
        seen *s = all + i;
        *s = (seen){.lifetime = (double)p->lifetime[i], .initial_lifetime = (double)p->initial_lifetime[i],
                    .id = p->id[i], .kind = p->kind[i]};
        ssfr_particles_position(p, i, s->at);
        for (size_t k = 0; k < 3; k++) s->velocity[k] = (double)p->velocity[3 * i + k];
    }
    qsort(all, p->n, sizeof *all, by_id);
    ssfr_particles_destroy(&p);
    return all;
}

static seen see_only(const ssfr_foam *foam)
{
    assert_int_equal(ssfr_foam_count(foam), 1);
    seen *all = see(foam), one = all[0];
    free(all);
    return one;
}

/* ---- potentials -------------------------------------------------------------------------------------------------- */

static ssfr_foam_cause *find_causes(ssfr_foam *foam, const ssfr_fluid *fluid)
{
    ssfr_foam_cause *causes = calloc(fluid->n, sizeof *causes);
    assert_non_null(causes);
    assert_int_equal(ssfr_foam_causes(foam, fluid, 0, NULL, causes), SSFR_OK);
    return causes;
}

/* Of the first of two particles, the second at -d x^ from it, that move apart with the velocity v. */
static ssfr_foam_cause of_two(const double x[3], double d, const double v[3])
{
    water *w = pour(R);
    ssfr_foam *foam = make_plain(down);
    const double base[3] = {0.31, -0.12, 0.2};
    put(w, base, v);
    put(w, (double[3]){base[0] - d * x[0], base[1] - d * x[1], base[2] - d * x[2]}, (double[3]){0});
    ssfr_foam_cause *causes = find_causes(foam, still(w)), first = causes[0];
    free(causes);
    ssfr_foam_destroy(&foam);
    drain(&w);
    return first;
}

static void two_particles_trap_air_as_eq_2_says(void **state)
{
    (void)state;
    const double x[3] = {0.48, -0.6, 0.64}, across[3] = {0.8, 0, -0.6}, d = 0.6 * H, w = 1 - 0.6;
    const double ways[][2] = {{-2.385, 0}, {2.385, 0}, {0, 2.385}, {1.1, 0.7}, {-0.4, 1.9}}; /* m/s, along and across */
    for (size_t i = 0; i < SSFR_COUNT(ways); i++) {
        double v[3];
        for (int k = 0; k < 3; k++) v[k] = ways[i][0] * x[k] + ways[i][1] * across[k];
        const double speed = hypot(ways[i][0], ways[i][1]), cosine = ways[i][0] / speed;
        const ssfr_foam_cause cause = of_two(x, d, v);
        assert_close((double)cause.trapped_air, speed * (1 - cosine) * w, 4e-6, 0);
        assert_close((double)cause.energy, 0.5 * ssfr_particle_mass(R) * speed * speed, 0, 1e-6);
    }
    assert_true(of_two(x, 1.001 * H, (double[3]){3, 2, 1}).trapped_air == 0);
    assert_true(of_two(x, d, (double[3]){0}).trapped_air == 0);
    assert_close((double)of_two(x, 0, (double[3]){0, 2.385, 0}).trapped_air, 2.385, 0, 1e-6);
}

static void trapped_air_is_summed_over_neighbours(void **state)
{
    (void)state;
    water *w = pour(R);
    ssfr_foam *foam = make_plain(down);
    put(w, (double[3]){0}, (double[3]){2, 0, 0});
    put(w, (double[3]){0.25 * H, 0, 0}, (double[3]){0});
    put(w, (double[3]){0, 0.5 * H, 0}, (double[3]){0});
    put(w, (double[3]){0, 0, 0.75 * H}, (double[3]){2, 0, -1.5});
    ssfr_foam_cause *causes = find_causes(foam, still(w));
    assert_close((double)causes[0].trapped_air, 2 * 2 * 0.75 + 2 * 0.5 + 1.5 * 2 * 0.25, 0, 2e-6);
    free(causes);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void two_particles_are_a_crest_where_they_move_along_their_normal(void **state)
{
    (void)state;
    const double x[3] = {0.48, -0.6, 0.64}, across[3] = {0.8, 0, -0.6}, d = 0.3 * H;
    const double cosines[] = {1, 0.61, 0.59, 0, -1}, expected[] = {2 * 0.7, 2 * 0.7, 0, 0, 0};
    for (size_t i = 0; i < SSFR_COUNT(cosines); i++) {
        double v[3];
        for (int k = 0; k < 3; k++) v[k] = 1.7 * (cosines[i] * x[k] + sqrt(1 - cosines[i] * cosines[i]) * across[k]);
        assert_close((double)of_two(x, d, v).wave_crest, expected[i], 4e-6, 0);
    }
    assert_true(of_two(x, d, (double[3]){0}).wave_crest == 0);
}

static double crest_of(water *w, size_t i)
{
    ssfr_foam *foam = make_plain(down);
    ssfr_foam_cause *causes = find_causes(foam, still(w));
    const double crest = (double)causes[i].wave_crest;
    free(causes);
    ssfr_foam_destroy(&foam);
    drain(&w);
    return crest;
}

/* The lattice below y = slope |x|, the particle at the origin first; all goes up. */
static double crest_below(double slope)
{
    enum { N = 7 };
    const double up[3] = {0, 1.3, 0};
    water *w = pour(R);
    put(w, (double[3]){0}, up);
    for (int x = -N; x <= N; x++)
        for (int y = -N; y <= N; y++)
            for (int z = -N; z <= N; z++)
                if ((x || y || z) && y <= slope * abs(x)) put(w, (double[3]){x * S, y * S, z * S}, up);
    return crest_of(w, 0);
}

static void a_ridge_is_a_crest_and_a_plain_and_a_trough_are_none(void **state)
{
    (void)state;
    assert_close(crest_below(0), 0, 1e-5, 0);
    assert_true(crest_below(-1) > 0.3);
    assert_close(crest_below(1), 0, 1e-5, 0);
}

enum { POOL_X = 10, POOL_Y = 6, POOL_Z = 8 };

static double largest_crest(ssfr_foam *foam, water *w, int n_obstacles, const ssfr_obstacle *obstacles)
{
    ssfr_foam_cause *causes = calloc(w->fluid.n, sizeof *causes);
    double largest = 0;
    assert_non_null(causes);
    assert_int_equal(ssfr_foam_causes(foam, still(w), n_obstacles, obstacles, causes), SSFR_OK);
    for (size_t i = 0; i < w->fluid.n; i++) largest = fmax(largest, (double)causes[i].wave_crest);
    free(causes);
    return largest;
}

/* A wall as a solid without end, whose normal is along axis k. */
static ssfr_obstacle make_plane(double x, double y, double z, int k, double sign)
{
    ssfr_solid plane = {.shape = SSFR_PLANE, .centre = {x, y, z}};
    for (int i = 0; i < 3; i++) plane.axis[1][(k + i) % 3] = i == 0 ? sign : 0;
    plane.axis[2][(k + 1) % 3] = 1;
    ssfr_cross(plane.axis[1], plane.axis[2], plane.axis[0]);
    return (ssfr_obstacle){plane, plane, 0};
}

static void water_that_fills_its_basin_has_no_crests_at_the_walls(void **state)
{
    (void)state;
    const double lo[3] = {0}, hi[3] = {POOL_X * S, 2 * POOL_Y * S, POOL_Z * S};
    const bool open[6] = {0};
    const ssfr_obstacle planes[] = {make_plane(0, 0, 0, 0, 1), make_plane(hi[0], 0, 0, 0, -1),
                                    make_plane(0, 0, 0, 1, 1), make_plane(0, 0, 0, 2, 1),
                                    make_plane(0, 0, hi[2], 2, -1)};
    water *w = pour(R);
    ssfr_foam *foam = make_plain(down);
    put_lattice(w, lo, POOL_X, POOL_Y, POOL_Z, (double[3]){0, 1.3, 0});
    assert_true(largest_crest(foam, w, 0, NULL) > 1);
    assert_close(largest_crest(foam, w, SSFR_COUNT(planes), planes), 0, 1e-5, 0);
    ssfr_foam_bound(foam, lo, hi, open);
    assert_close(largest_crest(foam, w, 0, NULL), 0, 1e-5, 0);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

/* Close to the floor, yet up from it: two particles, and one above them. */
static void beside_a_wall_what_faces_away_from_it_is_surface(void **state)
{
    (void)state;
    const double lo[3] = {-1, 0, -1}, hi[3] = {1, 1, 1}, base = 0.2 * H, half = 0.2 * H, high = 0.3 * H;
    const bool closed[6] = {0};
    water *w = pour(R);
    ssfr_foam *foam = make_plain(down);
    put(w, (double[3]){0.1, base + high, 0}, (double[3]){0, 1.3, 0});
    put(w, (double[3]){0.1 - half, base, 0}, (double[3]){0, 1.3, 0});
    put(w, (double[3]){0.1 + half, base, 0}, (double[3]){0, 1.3, 0});
    ssfr_foam_bound(foam, lo, hi, closed);
    ssfr_foam_cause *causes = find_causes(foam, still(w));
    assert_close((double)causes[0].wave_crest, 2 * (1 - hypot(0.2, 0.3)), 4e-6, 0); /* their normals are level */
    assert_true(causes[1].wave_crest == 0 && causes[2].wave_crest == 0);
    free(causes);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

/* ---- emission ---------------------------------------------------------------------------------------------------- */

enum { PAIRS_X = 16, PAIRS = 2048 };

/* Pairs out of each other's reach. The particles of each approach with 1.3 m/s: v_diff is 2.6 m/s. */
static water *put_pairs(double radius)
{
    const double h = SSFR_SUPPORT * radius;
    water *w = pour(radius);
    for (int i = 0; i < PAIRS; i++) {
        const int x = i % PAIRS_X, y = i / PAIRS_X % PAIRS_X, z = i / PAIRS_X / PAIRS_X;
        const double at[3] = {3 * h * (x - PAIRS_X / 2), 3 * h * (y - PAIRS_X / 2), 3 * h * (z - PAIRS_X / 2)};
        put(w, at, (double[3]){1.3, 0, 0});
        put(w, (double[3]){at[0] + 0.5 * h, at[1], at[2]}, (double[3]){-1.3, 0, 0});
    }
    return w;
}

/* I_ta of the pairs is 0.4, their energy suffices by far. */
static ssfr_foam_params air_only(double rate)
{
    ssfr_foam_params p = defaults();
    p.trapped_air_rate = rate, p.wave_crest_rate = 0;
    p.trapped_air_min = 1, p.trapped_air_max = 5;
    p.energy_min = 0, p.energy_max = 1e-6;
    return p;
}

static void as_many_are_born_as_n_d_says(void **state)
{
    (void)state;
    const double rates[] = {97, 850, 2385};
    water *w = put_pairs(R);
    const ssfr_fluid *fluid = still(w);
    for (size_t i = 0; i < SSFR_COUNT(rates); i++) {
        const ssfr_foam_params p = air_only(rates[i]);
        const double n_d = rates[i] * 0.4 * DT, part = n_d - floor(n_d), n = 2 * PAIRS;
        ssfr_foam *foam = make(&p, down, 1 + i);
        step(foam, fluid, DT);
        assert_close((double)ssfr_foam_count(foam), n * n_d, 4 * sqrt(n * part * (1 - part)), 0);
        ssfr_foam_destroy(&foam);
    }
    drain(&w);
}

static double variance(double n_d)
{
    return (n_d - floor(n_d)) * (1 - n_d + floor(n_d));
}

/* Both of a pair trap the same air; the second runs ahead of the first along its normal, but it has less energy. */
static void the_potentials_of_causes_add_up_and_that_of_energy_multiplies(void **state)
{
    (void)state;
    const double radii[] = {0.01, R, 0.05};
    for (size_t r = 0; r < SSFR_COUNT(radii); r++) {
        water *w = put_pairs(radii[r]);
        ssfr_foam_params p = air_only(900);
        for (size_t i = 0; i < PAIRS; i++) w->velocity[6 * i] = 3.9f, w->velocity[6 * i + 3] = 1.3f;
        const double energy = 0.5 * ssfr_particle_mass(0.02) * 1.3 * 1.3; /* J, at any radius: it is scaled */
        p.energy_min = 0.2 * energy, p.energy_max = 1.8 * energy;
        p.wave_crest_rate = 700, p.wave_crest_min = 0.1, p.wave_crest_max = 2;
        const double first = 900 * 0.4 * DT, second = 0.5 * (900 * 0.4 + 700 * 0.9 / 1.9) * DT;
        ssfr_foam *foam = make(&p, down, 5);
        step(foam, still(w), DT);
        assert_close((double)ssfr_foam_count(foam), PAIRS * (first + second),
                     4 * sqrt(PAIRS * (variance(first) + variance(second))), 0);
        ssfr_foam_destroy(&foam);
        drain(&w);
    }
}

/* The pair's particle i, at the end of the step. */
static void place(const water *w, size_t i, double at[3])
{
    for (size_t k = 0; k < 3; k++) at[k] = w->fluid.origin[k] + (double)w->position[3 * i + k];
}

static size_t nearest(const water *w, const double at[3])
{
    size_t best = 0;
    double least = INFINITY;
    for (size_t i = 0; i < w->fluid.n; i++) {
        double other[3], d = 0;
        place(w, i, other);
        for (int k = 0; k < 3; k++) d += ssfr_square(at[k] - other[k]);
        if (d < least) least = d, best = i;
    }
    return best;
}

static void births_fill_the_cylinder_of_the_way_and_come_in_the_order_of_particles(void **state)
{
    (void)state;
    const ssfr_foam_params p = air_only(1100); /* n_d is 1.8 */
    water *w = put_pairs(R);
    w->fluid.n = 400;
    for (int k = 0; k < 3; k++) w->fluid.origin[k] = 1000.25 * (k + 1);
    ssfr_foam *foam = make(&p, down, 9);
    step(foam, still(w), DT);
    seen *all = see(foam);
    const size_t n = ssfr_foam_count(foam);
    double square = 0, back = 0;
    size_t last = 0, births[400] = {0};
    assert_in_range(n, 650, 800);
    for (size_t e = 0; e < n; e++) {
        double from[3];
        const size_t i = nearest(w, all[e].at);
        const double sign = i % 2 ? -1 : 1;
        place(w, i, from);
        const double y = all[e].at[1] - from[1], z = all[e].at[2] - from[2], x = sign * (from[0] - all[e].at[0]);
        assert_int_equal(all[e].id, e);
        assert_true(i >= last && x > -1e-6 && x < 1.3 * DT + 1e-6 && hypot(y, z) < R + 1e-6);
        assert_close(all[e].velocity[0], sign * 1.3, 1e-6, 0);
        assert_close(all[e].velocity[1], y, 1e-6, 0);
        assert_close(all[e].velocity[2], z, 1e-6, 0);
        assert_close(all[e].lifetime, 2 + 0.4 * 3, 1e-5, 0);
        assert_true(all[e].lifetime == all[e].initial_lifetime && all[e].kind == SSFR_SPRAY);
        square += y * y + z * z, back += x, last = i, births[i]++;
    }
    for (size_t i = 0; i < 400; i++) assert_in_range(births[i], 1, 2);
    /* r^2 and x are uniform; the deviation of such is its range / sqrt(12). */
    assert_close(square / (double)n, 0.5 * R * R, 4 * R * R / sqrt(12 * (double)n), 0);
    assert_close(back / (double)n, 0.5 * 1.3 * DT, 4 * 1.3 * DT / sqrt(12 * (double)n), 0);
    free(all);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

/* The pairs move obliquely, and each particle has births enough to compare with each other. */
static void births_of_any_direction_have_numbers_of_their_own(void **state)
{
    (void)state;
    const double way[3] = {0.48, -0.6, 0.64};
    const ssfr_foam_params p = air_only(20000);
    water *w = put_pairs(R);
    w->fluid.n = 60;
    for (size_t i = 0; i < 3 * w->fluid.n; i++) w->velocity[i] = (float)((i / 3 % 2 ? -1.3 : 1.3) * way[i % 3]);
    ssfr_foam *foam = make(&p, down, 10);
    step(foam, still(w), DT);
    seen *all = see(foam);
    const size_t n = ssfr_foam_count(foam);
    double *r = calloc(n, sizeof *r), *back = calloc(n, sizeof *back), mean[2] = {0}, apart[2] = {0};
    assert_true(r && back && n > 800);
    for (size_t e = 0; e < n; e++) {
        double d[3], from[3];
        const size_t i = nearest(w, all[e].at);
        const double sign = i % 2 ? -1 : 1;
        place(w, i, from);
        for (int k = 0; k < 3; k++) d[k] = all[e].at[k] - from[k];
        const double along = ssfr_dot(d, way);
        for (int k = 0; k < 3; k++)
            assert_close(all[e].velocity[k], sign * 1.3 * way[k] + d[k] - along * way[k], 1e-6, 0);
        r[e] = (ssfr_dot(d, d) - along * along) / (R * R), back[e] = -sign * along / (1.3 * DT); /* uniform in [0, 1) */
        assert_true(r[e] < 1 + 1e-5 && back[e] > -1e-4 && back[e] < 1 + 1e-4);
        mean[0] += r[e] / (double)n, mean[1] += back[e] / (double)n;
    }
    for (int k = 0; k < 2; k++) assert_close(mean[k], 0.5, 4 / sqrt(12 * (double)n), 0);
    /* Two such numbers are 1/3 apart, with a deviation of sqrt(1/18). */
    for (size_t e = 0; e + 2 < n; e++)
        for (size_t k = 0; k < 2; k++) apart[k] += fabs(back[e] - r[e + 1 + k]) / (double)(n - 2);
    for (int k = 0; k < 2; k++) assert_close(apart[k], 1.0 / 3, 4 / sqrt(18 * (double)n), 0);
    free(all), free(r), free(back);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

/* As above where causes add up: 0.4 of trapped air alone, and half of the energy with 0.4 and a crest of 9/19. */
static void what_is_born_of_more_potential_lasts_longer(void **state)
{
    (void)state;
    const double energy = 0.5 * ssfr_particle_mass(0.02) * 1.3 * 1.3; /* J */
    ssfr_foam_params p = air_only(3000);
    water *w = put_pairs(R);
    w->fluid.n = 60;
    for (size_t i = 0; i < 30; i++) w->velocity[6 * i] = 3.9f, w->velocity[6 * i + 3] = 1.3f;
    p.energy_min = 0.2 * energy, p.energy_max = 1.8 * energy;
    p.wave_crest_rate = 1000, p.wave_crest_min = 0.1, p.wave_crest_max = 2;
    p.lifetime_min = 1.5, p.lifetime_max = 6.5;
    ssfr_foam *foam = make(&p, down, 5);
    step(foam, still(w), DT);
    seen *all = see(foam);
    assert_true(ssfr_foam_count(foam) > 150);
    for (size_t e = 0; e < ssfr_foam_count(foam); e++)
        assert_close(all[e].lifetime, 1.5 + 5 * (nearest(w, all[e].at) % 2 ? 0.5 * 9 / 19 : 0.4), 1e-5, 0);
    free(all);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void births_have_the_kind_of_their_place(void **state)
{
    (void)state;
    const double lo[3] = {-3 * S, -3 * S, -3 * S};
    ssfr_foam_params p = air_only(30000);
    water *w = pour(R);
    put(w, (double[3]){20 * S, 0, 0}, (double[3]){1.3, 0, 0}); /* a pair in the air */
    put(w, (double[3]){20 * S + 0.5 * H, 0, 0}, (double[3]){-1.3, 0, 0});
    put_lattice(w, lo, 6, 6, 6, weightless);
    put(w, (double[3]){0.1 * S, 0.2 * S, 0}, (double[3]){0, 2, 0}); /* and one that shoots through water */
    ssfr_foam *foam = make(&p, down, 5);
    step(foam, still(w), DT);
    seen *all = see(foam);
    size_t kinds[3] = {0};
    for (size_t e = 0; e < ssfr_foam_count(foam); e++) {
        kinds[all[e].kind]++;
        assert_int_equal(all[e].kind, all[e].at[0] > 15 * S ? SSFR_SPRAY : SSFR_BUBBLE);
    }
    assert_true(kinds[SSFR_SPRAY] > 50 && kinds[SSFR_BUBBLE] > 50);
    free(all);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void other_seeds_and_other_steps_draw_other_numbers(void **state)
{
    (void)state;
    const ssfr_foam_params p = air_only(1100);
    water *w = put_pairs(R);
    w->fluid.n = 100;
    ssfr_foam *one = make(&p, weightless, 1), *two = make(&p, weightless, 2);
    step(one, still(w), DT);
    step(two, &w->fluid, DT);
    seen *a = see(one), *b = see(two);
    assert_true(a[0].at[1] != b[0].at[1]);
    const size_t n = ssfr_foam_count(one);
    step(one, &w->fluid, DT);
    free(b);
    b = see(one);
    assert_true(b[n].velocity[1] != a[0].velocity[1]);
    free(a), free(b);
    ssfr_foam_destroy(&one), ssfr_foam_destroy(&two);
    drain(&w);
}

static void at_the_limit_the_new_are_thinned_evenly_and_the_old_stay(void **state)
{
    (void)state;
    ssfr_foam_params p = air_only(2385); /* n_d is 3.9 */
    p.max_particles = 1003;
    water *w = put_pairs(R);
    ssfr_foam *foam = make(&p, weightless, 9);
    for (int i = 0; i < 3; i++) add(foam, (double[3]){50 + i, 0, 0}, weightless, 1);
    step(foam, still(w), DT);
    assert_int_equal(ssfr_foam_count(foam), 1003);
    seen *all = see(foam);
    int births[8] = {0};
    for (int i = 0; i < 3; i++) assert_true(all[i].at[0] == 50 + i);
    for (size_t e = 3; e < 1003; e++) {
        assert_int_equal(all[e].id, e);
        births[nearest(w, all[e].at) / (2 * PAIRS / 8)]++;
    }
    for (int i = 0; i < 8; i++) assert_in_range(births[i], 120, 130);
    step(foam, &w->fluid, DT);
    assert_int_equal(ssfr_foam_count(foam), 1003);
    const float none[3] = {0};
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_add(foam, 1, weightless, none, none), "1 diffuse particles more");
    free(all);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void slow_water_emits_nothing(void **state)
{
    (void)state;
    ssfr_foam_params p = air_only(2385);
    p.energy_min = p.energy_max = 1.01 * 0.5 * ssfr_particle_mass(0.02) * 1.3 * 1.3;
    water *w = put_pairs(R);
    ssfr_foam *foam = make(&p, down, 9);
    step(foam, still(w), DT);
    assert_int_equal(ssfr_foam_count(foam), 0);
    ssfr_foam_destroy(&foam);
    p.energy_min = p.energy_max = 0.99 / 1.01 * p.energy_min; /* a step */
    foam = make(&p, down, 9);
    step(foam, &w->fluid, DT);
    assert_true(ssfr_foam_count(foam) > 10000);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

/* ---- motion ------------------------------------------------------------------------------------------------------ */

static void spray_follows_its_parabola_bit_by_bit(void **state)
{
    (void)state;
    const double start[3] = {1000.3, 2.385, -0.7}, speed[3] = {1.25, 3.75, -0.5}, gravity[3] = {0.3, -9.81, 0.1};
    water *w = pour(R); /* without any fluid */
    ssfr_foam *foam = make_plain(gravity);
    double at[3], v[3];
    memcpy(at, start, sizeof at), memcpy(v, speed, sizeof v);
    add(foam, start, speed, 0.5);
    for (int n = 1; n <= 200; n++) {
        step(foam, &w->fluid, DT);
        const seen s = see_only(foam);
        for (int k = 0; k < 3; k++) {
            v[k] = v[k] + DT * gravity[k];
            at[k] = at[k] + DT * v[k];
            v[k] = (double)(float)v[k];
            assert_true(s.at[k] == at[k] && s.velocity[k] == v[k]);
            assert_close(at[k], start[k] + n * DT * speed[k] + gravity[k] * DT * DT * n * (n + 1) / 2, 1e-5, 0);
        }
        assert_true(s.kind == SSFR_SPRAY && s.lifetime == 0.5);
    }
    ssfr_foam_destroy(&foam);
    drain(&w);
}

/* n fluid particles around a place or above it, `share` of the support away. */
static void surround(water *w, const double at[3], int n, double share, bool above)
{
    for (int i = 0; i < n; i++) {
        const double y = 1 - (i + 0.5) / n, angle = 2.4 * i, r = sqrt(1 - y * y); /* about the golden angle */
        const double d[3] = {r * cos(angle), above || i % 2 ? y : -y, r * sin(angle)};
        put(w, (double[3]){at[0] + share * H * d[0], at[1] + share * H * d[1], at[2] + share * H * d[2]}, weightless);
    }
}

/* A particle on the floor y = 0.3 m, or far above one, with n neighbours. */
static seen see_among(int n, double share, bool on_floor, const bool open[6], int n_obstacles,
                      const ssfr_obstacle *obstacles)
{
    const double lo[3] = {-9, on_floor ? 0.3 : -9, -9}, hi[3] = {9, 9, 9}, at[3] = {0.2, 0.3, -0.1};
    water *w = pour(R);
    ssfr_foam *foam = make_plain(weightless);
    ssfr_foam_bound(foam, lo, hi, open);
    surround(w, at, n, share, on_floor || n_obstacles > 0);
    add(foam, at, weightless, 1);
    assert_int_equal(ssfr_foam_step(foam, still(w), DT, n_obstacles, obstacles), SSFR_OK);
    const seen s = see_only(foam);
    ssfr_foam_destroy(&foam);
    drain(&w);
    return s;
}

static void kinds_go_by_the_count_of_neighbours(void **state)
{
    (void)state;
    const bool closed[6] = {0};
    const struct {
        int n;
        ssfr_kind kind;
    } cases[] = {{0, SSFR_SPRAY}, {1, SSFR_SPRAY}, {5, SSFR_SPRAY}, {6, SSFR_FOAM}, {13, SSFR_FOAM}, {20, SSFR_FOAM},
                 {21, SSFR_BUBBLE}, {60, SSFR_BUBBLE}};
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        assert_int_equal(see_among(cases[i].n, 0.7, false, closed, 0, NULL).kind, cases[i].kind);
        assert_int_equal(see_among(cases[i].n, 0.999, false, closed, 0, NULL).kind, cases[i].kind);
        assert_int_equal(see_among(cases[i].n, 1.001, false, closed, 0, NULL).kind, SSFR_SPRAY);
        assert_int_equal(see_among(cases[i].n, 0, false, closed, 0, NULL).kind, cases[i].kind);
    }
}

static void beside_a_wall_half_as_many_neighbours_make_a_bubble(void **state)
{
    (void)state;
    const bool closed[6] = {0}, open[6] = {[2] = true};
    const ssfr_obstacle plane = make_plane(0, 0.3, 0, 1, 1);
    assert_int_equal(see_among(11, 0.7, true, closed, 0, NULL).kind, SSFR_BUBBLE);
    assert_int_equal(see_among(10, 0.7, true, closed, 0, NULL).kind, SSFR_FOAM);
    assert_int_equal(see_among(5, 0.7, true, closed, 0, NULL).kind, SSFR_SPRAY);
    assert_int_equal(see_among(11, 0.7, true, open, 0, NULL).kind, SSFR_FOAM);
    assert_int_equal(see_among(11, 0.7, false, closed, 1, &plane).kind, SSFR_BUBBLE);
    assert_int_equal(see_among(10, 0.7, false, closed, 1, &plane).kind, SSFR_FOAM);
}

/* The cubic spline as textbooks have it. */
static double spline(double q)
{
    return q <= 0.5 ? 6 * (q * q * q - q * q) + 1 : 2 * (1 - q) * (1 - q) * (1 - q);
}

static void foam_moves_with_the_average_of_the_flow(void **state)
{
    (void)state;
    const double shares[] = {0.2, 0.45, 0.8}, speeds[][3] = {{1, 0.5, 0}, {-0.4, 2, 1}, {3, 0, -2.385}};
    ssfr_foam_params p = defaults();
    p.spray_below = 0;
    water *w = pour(R);
    double weight = 0, v[3] = {0};
    for (int i = 0; i < 3; i++) {
        double at[3] = {0};
        at[i] = shares[i] * H;
        put(w, at, speeds[i]);
        weight += spline(shares[i]);
        for (int k = 0; k < 3; k++) v[k] += spline(shares[i]) * speeds[i][k];
    }
    ssfr_foam *foam = make(&p, down, 1);
    add(foam, weightless, (double[3]){9, 9, 9}, 1);
    step(foam, still(w), DT);
    const seen s = see_only(foam);
    assert_int_equal(s.kind, SSFR_FOAM);
    for (int k = 0; k < 3; k++) {
        assert_close(s.velocity[k], v[k] / weight, 1e-6, 0);
        assert_close(s.at[k], DT * v[k] / weight, 1e-8, 0);
    }
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void foam_moves_with_a_uniform_flow(void **state)
{
    (void)state;
    const double v[3] = {1.3, 0, -0.4}, lo[3] = {-10 * S, -6 * S, -10 * S}, start[3] = {0.01, 0.4 * S, 0.02};
    water *w = pour(R);
    put_lattice(w, lo, 20, 6, 20, v);
    ssfr_foam *foam = make_plain(down);
    add(foam, start, weightless, 1);
    still(w);
    for (int n = 1; n <= 40; n++) {
        step(foam, &w->fluid, DT);
        const seen s = see_only(foam);
        assert_int_equal(s.kind, SSFR_FOAM);
        for (int k = 0; k < 3; k++) {
            assert_close(s.at[k], start[k] + n * DT * v[k], 1e-6, 0);
            assert_close(s.velocity[k], v[k], 1e-6, 0);
        }
    }
    ssfr_foam_destroy(&foam);
    drain(&w);
}

/* v_n = v_T (1 - (1 - k_d)^n) is the scheme's solution in still water, where v_T = k_b g dt / k_d. */
static void check_bubble(double bubble_step, double k_d, double terminal, double drag)
{
    const double lo[3] = {-6 * S, -6 * S, -6 * S};
    ssfr_foam_params p = defaults();
    p.buoyancy = 1.7, p.drag = k_d, p.bubble_step = bubble_step;
    water *w = pour(R);
    put_lattice(w, lo, 12, 12, 12, weightless);
    ssfr_foam *foam = make(&p, down, 1);
    add(foam, weightless, weightless, 1);
    still(w);
    double y = 0;
    for (int n = 1; n <= 40; n++) {
        step(foam, &w->fluid, DT);
        const seen s = see_only(foam);
        const double v = terminal * (1 - pow(1 - drag, n));
        y += DT * v;
        assert_int_equal(s.kind, SSFR_BUBBLE);
        assert_close(s.velocity[1], v, 1e-7, 1e-6);
        assert_close(s.at[1], y, 1e-6, 0);
        assert_true(s.lifetime == 1 && s.velocity[0] == 0 && s.at[2] == 0);
    }
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void a_bubble_rises_with_its_terminal_velocity(void **state)
{
    (void)state;
    check_bubble(0, 0.3, 1.7 * 9.81 * DT / 0.3, 0.3); /* the paper's, in every step */
    check_bubble(DT, 0.3, 1.7 * 9.81 * DT / 0.3, 0.3);
    check_bubble(3 * DT, 0.3, 1.7 * 9.81 * 3 * DT / 0.3, 1 - cbrt(0.7));
}

/* How fast a bubble is after 0.12 s, which are n steps. */
static double speed_in_steps(int n, double bubble_step, double drag)
{
    const double lo[3] = {-6 * S, -6 * S, -6 * S};
    ssfr_foam_params p = defaults();
    p.bubble_step = bubble_step, p.drag = drag;
    water *w = pour(R);
    put_lattice(w, lo, 12, 12, 12, weightless);
    ssfr_foam *foam = make(&p, down, 1);
    add(foam, (double[3]){0, -2 * S, 0}, weightless, 1);
    still(w);
    for (int i = 0; i < n; i++) step(foam, &w->fluid, 0.12 / n);
    const seen s = see_only(foam);
    assert_int_equal(s.kind, SSFR_BUBBLE);
    ssfr_foam_destroy(&foam);
    drain(&w);
    return s.velocity[1];
}

static void a_bubble_is_as_fast_in_steps_of_any_length(void **state)
{
    (void)state;
    const double paper = speed_in_steps(6, 0, 0.2); /* of 0.02 s */
    assert_close(paper, 2 * 9.81 * 0.02 / 0.2 * (1 - pow(0.8, 6)), 0, 1e-6);
    assert_close(speed_in_steps(6, 0.02, 0.2), paper, 0, 1e-6);
    assert_close(speed_in_steps(48, 0.02, 0.2), paper, 0, 1e-6);
    assert_true(speed_in_steps(48, 0, 0.2) < 0.2 * paper); /* otherwise it goes with the step */
    assert_close(speed_in_steps(24, 0.02, 0), 2 * 9.81 * 0.12, 0, 1e-6);
    assert_close(speed_in_steps(24, 0.02, 1), 2 * 9.81 * 0.02, 0, 1e-6);
}

static void only_foam_ages_and_it_ends_with_its_lifetime(void **state)
{
    (void)state;
    const double lo[3] = {-6 * S, -12 * S, -6 * S}, spray[3] = {0, 1, 0}, bubble[3] = {0, -6 * S, 0};
    const double surface[3] = {0, 0.4 * S, 0};
    water *w = pour(R);
    put_lattice(w, lo, 12, 12, 12, weightless);
    ssfr_foam *foam = make_plain(weightless);
    add(foam, spray, weightless, 0.5), add(foam, surface, weightless, 9.5 * DT), add(foam, bubble, weightless, 0.25);
    add(foam, surface, weightless, 0.5);
    still(w);
    for (int n = 1; n <= 12; n++) {
        step(foam, &w->fluid, DT);
        seen *all = see(foam);
        const size_t last = ssfr_foam_count(foam) - 1;
        assert_int_equal(last, n < 10 ? 3 : 2);
        assert_true(all[0].lifetime == 0.5 && all[0].kind == SSFR_SPRAY);
        assert_true(all[last - 1].lifetime == 0.25 && all[last - 1].kind == SSFR_BUBBLE);
        assert_true(all[last].kind == SSFR_FOAM && all[last].id == 3 && all[last].initial_lifetime == 0.5);
        assert_close(all[last].lifetime, 0.5 - n * DT, 1e-6, 0);
        free(all);
    }
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void foam_ends_when_its_lifetime_is_spent_to_the_last_bit_and_others_stay_with_none(void **state)
{
    (void)state;
    const double lo[3] = {-6 * S, -12 * S, -6 * S}, dt = 0x1p-8; /* s */
    water *w = pour(R);
    put_lattice(w, lo, 12, 12, 12, weightless);
    ssfr_foam *foam = make_plain(weightless);
    add(foam, (double[3]){0, 1, 0}, weightless, 0), add(foam, (double[3]){0, -6 * S, 0}, weightless, 0);
    add(foam, (double[3]){0, 0.4 * S, 0}, weightless, 3 * dt);
    still(w);
    for (int n = 1; n <= 4; n++) {
        step(foam, &w->fluid, dt);
        assert_int_equal(ssfr_foam_count(foam), n < 3 ? 3 : 2);
    }
    ssfr_foam_destroy(&foam);
    drain(&w);
}

/* ---- walls ------------------------------------------------------------------------------------------------------- */

static void add_spray(ssfr_foam *foam, int n, uint64_t seed)
{
    for (int i = 0; i < n; i++) {
        double at[3], v[3];
        for (int k = 0; k < 3; k++) at[k] = test_random(&seed, -0.5, -0.2), v[k] = test_random(&seed, -6, 6);
        add(foam, at, v, 1);
    }
}

/* A plate thinner than a step is long, a ball, and a ram that moves to and fro. */
static void find_obstacles(ssfr_obstacle obstacles[3], double time)
{
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const ssfr_solid solids[3] = {
        {.shape = SSFR_BOX, .half = {0.0008, 2, 2}},
        {.shape = SSFR_SPHERE, .centre = {-0.5, -0.6, -0.1}, .half = {0.2, 0.2, 0.2}},
        {.shape = SSFR_BOX, .centre = {-0.4, 0.3, 0}, .half = {0.1, 0.05, 0.2}},
    };
    for (int i = 0; i < 3; i++) {
        ssfr_solid *both[] = {&obstacles[i].before, &obstacles[i].now};
        obstacles[i] = (ssfr_obstacle){solids[i], solids[i], 0.3};
        for (int b = 0; b < 2; b++) {
            memcpy(both[b]->axis, axes, sizeof axes);
            if (i == 2) both[b]->centre[1] += 0.3 * sin(20 * (time - DT + b * DT)); /* up to 6 m/s */
        }
    }
}

static void nothing_leaves_through_a_wall(void **state)
{
    (void)state;
    enum { N = 300 };
    const double lo[3] = {-0.9, -0.8, -0.7}, hi[3] = {0.9, 0.8, 0.7};
    const bool closed[6] = {0};
    water *w = pour(R);
    ssfr_foam *foam = make_plain(down);
    ssfr_foam_bound(foam, lo, hi, closed);
    add_spray(foam, N, 5);
    for (int n = 1; n <= 80; n++) {
        ssfr_obstacle obstacles[3];
        find_obstacles(obstacles, n * DT);
        assert_int_equal(ssfr_foam_step(foam, &w->fluid, DT, 3, obstacles), SSFR_OK);
        assert_int_equal(ssfr_foam_count(foam), N);
        seen *all = see(foam);
        for (int i = 0; i < N; i++) {
            double normal[3];
            assert_true(all[i].at[0] < -0.0008 + 1e-6);
            for (int k = 0; k < 3; k++) assert_true(all[i].at[k] >= lo[k] - 1e-6 && all[i].at[k] <= hi[k] + 1e-6);
            for (int s = 0; s < 3; s++)
                assert_true(ssfr_solid_distance(&obstacles[s].now, all[i].at, normal) > -1e-6);
        }
        free(all);
    }
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void births_do_not_end_up_in_solids(void **state)
{
    (void)state;
    const ssfr_foam_params p = air_only(10000);
    ssfr_obstacle plane = make_plane(0, 0.2 * R, 0, 1, 1); /* through the pairs' cylinders */
    water *w = put_pairs(R);
    w->fluid.n = 20;
    for (size_t i = 0; i < w->fluid.n; i++) w->position[3 * i + 1] = (float)(0.3 * R);
    ssfr_foam *foam = make(&p, down, 4);
    assert_int_equal(ssfr_foam_step(foam, still(w), DT, 1, &plane), SSFR_OK);
    seen *all = see(foam);
    const size_t n = ssfr_foam_count(foam);
    size_t on = 0;
    assert_true(n > 200);
    for (size_t i = 0; i < n; i++) {
        assert_true(all[i].at[1] > 0.2 * R - 1e-7);
        if (all[i].at[1] < 0.2 * R + 1e-7) on++;
    }
    assert_in_range(on, n / 3, n / 2); /* the segment below 0.1 R holds 0.44 of the disc */
    free(all);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void what_leaves_by_an_open_side_or_gets_into_a_sink_is_removed(void **state)
{
    (void)state;
    const double lo[3] = {-1, -1, -1}, hi[3] = {1, 1, 1};
    const bool open[6] = {[1] = true};
    const ssfr_solid sink = {.shape = SSFR_SPHERE, .centre = {0.2, 0, 0}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                             .half = {0.1, 0.1, 0.1}};
    water *w = pour(R);
    ssfr_foam *foam = make_plain(weightless);
    ssfr_foam_bound(foam, lo, hi, open);
    for (int i = 0; i < 10; i++) add(foam, (double[3]){0.1 * i, 0, 0}, (double[3]){i == 9 ? 0.2 / DT : 0}, 1);
    for (int i = 0; i < 3; i++) add(foam, (double[3]){-0.1 * i, 0, 0}, (double[3]){0, i == 2 ? 2 / DT : 0}, 1);
    step(foam, &w->fluid, DT);
    assert_int_equal(ssfr_foam_count(foam), 12);
    ssfr_foam_remove(foam, &sink); /* particles 2 and the border's 1 and 3 or not, by rounding */
    const size_t left = ssfr_foam_count(foam);
    assert_in_range(left, 9, 11);
    seen *all = see(foam);
    assert_int_equal(all[0].id, 0);
    for (size_t i = 1; i < left; i++) assert_true(all[i].id > all[i - 1].id && all[i].id != 2 && all[i].id != 9);
    free(all);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

/* ---- the same bits ----------------------------------------------------------------------------------------------- */

/* Violent water in a closed box, with a ball in it and spray above. */
typedef struct storm {
    water *w;
    ssfr_foam *foam;
    ssfr_obstacle ball;
} storm;

static const double storm_lo[3] = {-0.6, -0.4, -0.5}, storm_hi[3] = {0.6, 0.5, 0.5};

static ssfr_foam *make_storm_foam(void)
{
    const bool closed[6] = {0};
    ssfr_foam_params p = defaults();
    p.lifetime_min = 2.5 * DT, p.lifetime_max = 6 * DT;
    p.trapped_air_rate = 300, p.wave_crest_rate = 1200;
    ssfr_foam *foam = make(&p, down, 77);
    ssfr_foam_bound(foam, storm_lo, storm_hi, closed);
    for (uint64_t i = 0, seed = 6; i < 60; i++) {
        double at[3], v[3];
        for (int k = 0; k < 3; k++) at[k] = test_random(&seed, 0.2, 0.6), v[k] = test_random(&seed, -5, 5);
        add(foam, at, v, 1);
    }
    return foam;
}

static storm begin_storm(void)
{
    storm s = {.w = pour(R), .foam = make_storm_foam()};
    uint64_t seed = 8;
    for (int i = 0; i < 2500; i++) {
        double at[3], v[3];
        for (int k = 0; k < 3; k++) {
            at[k] = test_random(&seed, storm_lo[k], k == 1 ? 0 : storm_hi[k]);
            v[k] = test_random(&seed, -2.5, 2.5);
        }
        put(s.w, at, v);
    }
    const ssfr_solid ball = {.shape = SSFR_SPHERE, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .half = {0.1, 0.1, 0.1}};
    s.ball = (ssfr_obstacle){ball, ball, 0.1};
    s.ball.now.centre[0] = 0.01;
    still(s.w);
    return s;
}

static void end_storm(storm *s)
{
    ssfr_foam_destroy(&s->foam);
    drain(&s->w);
}

static void go_on(const storm *s, ssfr_foam *foam, int n)
{
    for (int i = 0; i < n; i++) assert_int_equal(ssfr_foam_step(foam, &s->w->fluid, DT, 1, &s->ball), SSFR_OK);
}

/* The state as bytes, to free(). */
static char *save(const ssfr_foam *foam, size_t *size)
{
    FILE *file = tmpfile();
    assert_non_null(file);
    assert_int_equal(ssfr_foam_write(foam, file), SSFR_OK);
    *size = (size_t)ftello(file);
    char *bytes = malloc(*size);
    assert_non_null(bytes);
    rewind(file);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

static ssfr_result load(ssfr_foam *foam, const char *bytes, size_t size)
{
    FILE *file = tmpfile();
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    rewind(file);
    const ssfr_result result = ssfr_foam_read(foam, file);
    fclose(file);
    return result;
}

static void assert_same_state(const ssfr_foam *a, const ssfr_foam *b)
{
    size_t n_a, n_b;
    char *x = save(a, &n_a), *y = save(b, &n_b);
    assert_int_equal(n_a, n_b);
    assert_memory_equal(x, y, n_a);
    free(x), free(y);
}

static void the_bits_are_the_same_for_any_number_of_threads(void **state)
{
    (void)state;
    const int threads[] = {1, 2, 16}, before = omp_get_max_threads();
    storm s = begin_storm();
    for (size_t t = 0; t < SSFR_COUNT(threads); t++) {
        ssfr_foam *foam = make_storm_foam();
        omp_set_num_threads(threads[t]);
        go_on(&s, foam, 6);
        if (t == 0) {
            size_t kinds[3] = {0};
            seen *all = see(foam);
            for (size_t i = 0; i < ssfr_foam_count(foam); i++) kinds[all[i].kind]++;
            for (int k = 0; k < 3; k++) assert_true(kinds[k] > 20); /* all that moves is there */
            free(all);
            ssfr_foam_destroy(&s.foam);
            s.foam = foam;
        } else {
            assert_same_state(foam, s.foam);
            ssfr_foam_destroy(&foam);
        }
    }
    omp_set_num_threads(before);
    end_storm(&s);
}

static void a_state_read_back_goes_on_as_if_it_had_never_stopped(void **state)
{
    (void)state;
    storm s = begin_storm();
    ssfr_foam *other = make_storm_foam();
    size_t size;
    go_on(&s, s.foam, 3);
    char *bytes = save(s.foam, &size);
    assert_int_equal(load(other, bytes, size), SSFR_OK);
    assert_same_state(other, s.foam);
    go_on(&s, s.foam, 4);
    go_on(&s, other, 4);
    assert_same_state(other, s.foam);
    assert_int_equal(load(s.foam, bytes, size), SSFR_OK); /* over what is there */
    go_on(&s, s.foam, 4);
    assert_same_state(other, s.foam);
    free(bytes);
    ssfr_foam_destroy(&other);
    end_storm(&s);
}

static void a_state_stands_between_others_in_a_file(void **state)
{
    (void)state;
    ssfr_foam *foam = make_plain(down), *other = make_plain(down);
    FILE *file = tmpfile();
    assert_non_null(file);
    assert_int_equal(fputs("before", file) >= 0, 1);
    assert_int_equal(ssfr_foam_write(foam, file), SSFR_OK); /* without a particle */
    add(foam, (double[3]){1, 2, 3}, down, 0.5);
    assert_int_equal(ssfr_foam_write(foam, file), SSFR_OK);
    fputs("after", file);
    fseek(file, 6, SEEK_SET);
    assert_int_equal(ssfr_foam_read(other, file), SSFR_OK);
    assert_int_equal(ssfr_foam_count(other), 0);
    assert_int_equal(ssfr_foam_read(other, file), SSFR_OK);
    assert_same_state(foam, other);
    assert_int_equal(fgetc(file), 'a');
    fclose(file);
    ssfr_foam_destroy(&foam), ssfr_foam_destroy(&other);
}

static void every_truncated_state_is_refused(void **state)
{
    (void)state;
    storm s = begin_storm();
    size_t size;
    go_on(&s, s.foam, 2);
    char *bytes = save(s.foam, &size);
    for (size_t cut = 0; cut < size; cut += cut < 64 ? 1 : 1 + size / 97) {
        assert_fails(SSFR_ERR_FORMAT, load(s.foam, bytes, cut), "state of foam: ");
        assert_int_equal(ssfr_foam_count(s.foam), 0);
    }
    free(bytes);
    end_storm(&s);
}

/* One particle: header of 4 x 8 bytes, position, velocity, lifetime, initial lifetime, id, kind. */
static void states_that_cannot_be_are_refused(void **state)
{
    (void)state;
    static const struct {
        size_t at, size;
        uint64_t value;
        const char *text;
    } damages[] = {
        {0, 8, 1, "begins with 0x1 instead"},
        {16, 8, (uint64_t)UINT32_MAX + 1, "1 particles of 4294967296 births"},
        {24, 8, 3, "3 particles of 2 births"},
        {24, 8, 2, "2 particles of 49 bytes, but 49 bytes follow"},
        {32, 8, UINT64_C(0x7ff0000000000000), "particle 0 (from 0)"}, /* infinite */
        {60, 4, 0x7fc00000, "particle 0 (from 0)"},                   /* NaN */
        {68, 4, 0x7fc00000, "nan s"},
        {72, 4, 0x7f800000, "particle 0 (from 0)"},
        {76, 4, 2, "id 2 of 2"},
        {80, 1, 3, "kind 3"},
    };
    ssfr_foam *foam = make_plain(down);
    size_t size;
    const ssfr_solid sink = {.shape = SSFR_SPHERE, .centre = {5, 2, 3}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                             .half = {1, 1, 1}};
    add(foam, sink.centre, down, 0.5), add(foam, (double[3]){1, 2, 3}, down, 0.5);
    ssfr_foam_remove(foam, &sink);
    char *bytes = save(foam, &size);
    assert_int_equal(size, 32 + 49);
    for (size_t i = 0; i < SSFR_COUNT(damages); i++) {
        char copy[32 + 49];
        memcpy(copy, bytes, size);
        memcpy(copy + damages[i].at, &damages[i].value, damages[i].size);
        assert_fails(SSFR_ERR_FORMAT, load(foam, copy, size), damages[i].text);
    }
    assert_int_equal(load(foam, bytes, size), SSFR_OK);
    free(bytes);
    ssfr_foam_destroy(&foam);
}

static void a_state_that_cannot_be_written_is_an_error(void **state)
{
    (void)state;
    ssfr_foam *foam = make_plain(down);
    const char *path = test_path("state.bin");
    test_write_file(path, "", 0);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_fails(SSFR_ERR_IO, ssfr_foam_write(foam, file), "writing the state of foam: ");
    fclose(file);
    ssfr_foam_destroy(&foam);
}

/* ---- extremes and errors ----------------------------------------------------------------------------------------- */

static void coincident_particles_and_those_at_rest_give_finite_numbers(void **state)
{
    (void)state;
    ssfr_foam_params p = defaults();
    p.energy_min = p.energy_max = p.trapped_air_min = p.trapped_air_max = p.wave_crest_min = p.wave_crest_max = 0;
    p.trapped_air_rate = 20000, p.spray_below = 0;
    water *w = pour(R);
    const double at[3] = {0.1, 0.2, 0.3};
    for (int i = 0; i < 60; i++) put(w, at, (double[3]){i % 3 ? 0 : 1, 0, i % 2});
    ssfr_foam *foam = make(&p, down, 3);
    add(foam, at, weightless, 1);
    add(foam, (double[3]){1e20, -1e30, 1e-300}, (double[3]){1e30, 0, -1e-40}, 1);
    still(w);
    for (int n = 0; n < 3; n++) step(foam, &w->fluid, DT);
    assert_true(ssfr_foam_count(foam) > 1000);
    seen *all = see(foam);
    for (size_t i = 0; i < ssfr_foam_count(foam); i++)
        for (int k = 0; k < 3; k++) assert_true(isfinite(all[i].at[k]) && isfinite(all[i].velocity[k]));
    free(all);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void water_at_rest_emits_nothing_even_without_limits(void **state)
{
    (void)state;
    ssfr_foam_params p = defaults();
    p.energy_min = p.energy_max = p.trapped_air_min = p.trapped_air_max = 0;
    water *w = pour(R);
    put_lattice(w, weightless, 5, 5, 5, weightless);
    ssfr_foam *foam = make(&p, down, 3);
    step(foam, still(w), DT);
    assert_int_equal(ssfr_foam_count(foam), 0);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void a_step_of_no_time_changes_nothing(void **state)
{
    (void)state;
    storm s = begin_storm();
    ssfr_foam *other = make_storm_foam();
    size_t size;
    go_on(&s, s.foam, 2);
    char *bytes = save(s.foam, &size);
    assert_int_equal(load(other, bytes, size), SSFR_OK);
    step(s.foam, &s.w->fluid, 0);
    assert_same_state(s.foam, other);
    free(bytes);
    ssfr_foam_destroy(&other);
    end_storm(&s);
}

static void time_steps_that_cannot_be_are_refused(void **state)
{
    (void)state;
    const double steps[] = {-0.01, NAN, INFINITY};
    const char *texts[] = {"-0.01 s", "nan s", "inf s"};
    water *w = pour(R);
    ssfr_foam *foam = make_plain(down);
    for (size_t i = 0; i < SSFR_COUNT(steps); i++)
        assert_fails(SSFR_ERR_VALUE, ssfr_foam_step(foam, &w->fluid, steps[i], 0, NULL), texts[i]);
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_step(foam, &w->fluid, DT, 65, NULL), "65 obstacles");
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_causes(foam, &w->fluid, 65, NULL, NULL), "65 obstacles");
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void parameters_out_of_range_are_refused(void **state)
{
    (void)state;
    ssfr_foam *foam = NULL;
    ssfr_foam_params p = defaults();
    p.drag = 1.01;
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_create(&foam, &p, down, 1), "foam.drag=1.01");
    p = defaults(), p.trapped_air_rate = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_create(&foam, &p, down, 1), "foam.trapped_air_rate=nan");
    p = defaults(), p.trapped_air_min = 20.5;
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_create(&foam, &p, down, 1), "trapped_air_min=20.5 is above");
    p = defaults(), p.wave_crest_max = 1.5;
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_create(&foam, &p, down, 1), "wave_crest_max=1.5");
    p = defaults(), p.energy_max = 0.025;
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_create(&foam, &p, down, 1), "energy_max=0.025");
    p = defaults(), p.lifetime_min = 5.5;
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_create(&foam, &p, down, 1), "lifetime_min=5.5");
    assert_null(foam);
    ssfr_foam_destroy(&foam);
}

static void particles_that_are_not_finite_are_not_added(void **state)
{
    (void)state;
    ssfr_foam *foam = make_plain(down);
    double positions[6] = {1, 2, 3, 4, 5, 6};
    float velocities[6] = {0}, lifetimes[2] = {1, 1};
    positions[4] = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_add(foam, 2, positions, velocities, lifetimes), "particle 1 (from 0)");
    positions[4] = 5, velocities[0] = INFINITY;
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_add(foam, 2, positions, velocities, lifetimes), "particle 0 (from 0)");
    velocities[0] = 0, lifetimes[1] = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_add(foam, 2, positions, velocities, lifetimes), "particle 1 (from 0)");
    lifetimes[1] = 1;
    assert_int_equal(ssfr_foam_count(foam), 0);
    assert_int_equal(ssfr_foam_add(foam, 2, positions, velocities, lifetimes), SSFR_OK);
    seen *all = see(foam);
    assert_true(all[1].id == 1 && all[1].at[2] == 6);
    free(all);
    ssfr_foam_destroy(&foam);
}

/* Ids are 32 bits: a state near their end. */
static void ids_that_would_repeat_are_refused(void **state)
{
    (void)state;
    const ssfr_foam_params p = air_only(1100);
    water *w = put_pairs(R);
    w->fluid.n = 100;
    ssfr_foam *foam = make(&p, down, 4);
    size_t size;
    char *bytes = save(foam, &size);
    const uint64_t births = UINT32_MAX - 10;
    memcpy(bytes + 16, &births, sizeof births);
    assert_int_equal(load(foam, bytes, size), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_step(foam, still(w), DT, 0, NULL), "after 4294967285 births");
    const float none[33] = {0};
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_add(foam, 11, (double[33]){0}, none, none), "11 diffuse particles more");
    assert_int_equal(ssfr_foam_add(foam, 10, (double[33]){0}, none, none), SSFR_OK);
    free(bytes);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void more_births_than_counts_hold_are_refused(void **state)
{
    (void)state;
    ssfr_foam_params p = air_only(1e7);
    p.max_particles = 0;
    water *w = put_pairs(R);
    ssfr_foam *foam = make(&p, down, 4);
    assert_fails(SSFR_ERR_VALUE, ssfr_foam_step(foam, still(w), 1, 0, NULL), "counts and ids go up to 4294967295");
    assert_int_equal(ssfr_foam_count(foam), 0);
    ssfr_foam_destroy(&foam);
    drain(&w);
}

static void larger_particles_take_larger_limits_of_trapped_air(void **state)
{
    (void)state;
    ssfr_foam_params p = defaults();
    const ssfr_foam_params before = p;
    ssfr_foam_params_coarsen(&p, 2.385);
    assert_true(p.trapped_air_min == 2.385 * 5 && p.trapped_air_max == 2.385 * 20);
    p.trapped_air_min = before.trapped_air_min, p.trapped_air_max = before.trapped_air_max;
    assert_memory_equal(&p, &before, sizeof p);
    p.trapped_air_max = 1e6;
    ssfr_foam_params_coarsen(&p, 2.385);
    assert_int_equal(ssfr_params_check(ssfr_foam_rows, &p, "foam"), SSFR_OK);
    ssfr_foam *foam = make(&p, down, 1);
    ssfr_foam_destroy(&foam);
}

static void rows_have_units_and_defaults_that_hold_to_them(void **state)
{
    (void)state;
    const ssfr_foam_params p = defaults();
    assert_int_equal(ssfr_params_check(ssfr_foam_rows, &p, "foam"), SSFR_OK);
    assert_true(p.trapped_air_min == 5 && p.wave_crest_max == 8 && p.spray_below == 6 && p.bubbles_above == 20);
    int n = 0;
    for (const ssfr_param *row = ssfr_foam_rows; row->name; row++, n++) assert_true(row->unit[0] && row->help[0]);
    assert_int_equal(n, 16);
}

/* ---- the data of SPlisHSPlasH ------------------------------------------------------------------------------------ */

static const double tank_lo[3] = {-2.4, 0, -1}, tank_hi[3] = {2.4, 3.2, 1};

static ssfr_particles *load_particles(const char *name)
{
    char path[1024];
    ssfr_particles *p = NULL;
    ssfr_load_options options = {.radius = 0.02};
    snprintf(path, sizeof path, "%s/%s", test_data_or_skip(), name);
    assert_int_equal(ssfr_particles_load(&p, path, &options), SSFR_OK);
    return p;
}

typedef struct frame {
    ssfr_particles *particles;
    float *points;
    ssfr_grid *grid;
    ssfr_fluid fluid;
} frame;

static frame open_frame(const char *name)
{
    frame f = {.particles = load_particles(name)};
    f.fluid = (ssfr_fluid){.n = f.particles->n, .velocity = f.particles->velocity, .density = f.particles->density,
                           .radius = 0.02};
    assert_int_equal(ssfr_grid_points(f.particles, f.fluid.origin, &f.points), SSFR_OK);
    assert_int_equal(ssfr_grid_create(&f.grid), SSFR_OK);
    assert_int_equal(ssfr_grid_build(f.grid, f.fluid.n, f.points, SSFR_SUPPORT * 0.02), SSFR_OK);
    f.fluid.position = f.points;
    f.fluid.grid = f.grid;
    return f;
}

static void close_frame(frame *f)
{
    ssfr_particles_destroy(&f->particles);
    ssfr_grid_destroy(&f->grid);
    free(f->points);
}

/* The file's kinds are those before the last move, which its velocities undo, of 0.02 s. Beside walls it corrects
 * counts in another way: places there are left out. */
static void kinds_agree_with_those_of_splishsplash(void **state)
{
    (void)state;
    frame f = open_frame("ddb_mid_fluid.ply");
    ssfr_particles *given = load_particles("ddb_mid_foam.ply");
    double *before = malloc(3 * given->n * sizeof *before);
    const bool closed[6] = {0};
    ssfr_foam *foam = make_plain(weightless);
    assert_non_null(before);
    for (size_t i = 0; i < given->n; i++) {
        ssfr_particles_position(given, i, before + 3 * i);
        for (size_t k = 0; k < 3; k++) before[3 * i + k] -= 0.02 * (double)given->velocity[3 * i + k];
    }
    ssfr_foam_bound(foam, tank_lo, tank_hi, closed);
    assert_int_equal(ssfr_foam_add(foam, given->n, before, given->velocity, given->lifetime), SSFR_OK);
    step(foam, &f.fluid, 1e-9);
    seen *all = see(foam);
    size_t n = 0, same = 0;
    for (size_t i = 0; i < given->n; i++) {
        bool inside = true;
        for (size_t k = 0; k < 3; k++)
            inside = inside && before[3 * i + k] > tank_lo[k] + 0.08 && before[3 * i + k] < tank_hi[k] - 0.08;
        n += inside, same += inside && all[i].kind == given->kind[i];
    }
    assert_true(n > 100000);
    assert_true((double)same > 0.99 * (double)n);
    free(all), free(before);
    ssfr_particles_destroy(&given);
    ssfr_foam_destroy(&foam);
    close_frame(&f);
}

/* When the columns of water meet there is much air to trap, half a second later hardly any. */
static void the_impact_of_a_dam_break_emits_and_what_follows_hardly_does(void **state)
{
    (void)state;
    const char *names[] = {"ddb_early_fluid.ply", "ddb_mid_fluid.ply"};
    const bool closed[6] = {0};
    size_t n[2], airy[2] = {0};
    for (int i = 0; i < 2; i++) {
        frame f = open_frame(names[i]);
        ssfr_foam *foam = make_plain(down);
        ssfr_foam_bound(foam, tank_lo, tank_hi, closed);
        ssfr_foam_cause *causes = find_causes(foam, &f.fluid);
        for (size_t p = 0; p < f.fluid.n; p++) airy[i] += causes[p].trapped_air > 5;
        step(foam, &f.fluid, 0.004);
        n[i] = ssfr_foam_count(foam);
        free(causes);
        ssfr_foam_destroy(&foam);
        close_frame(&f);
    }
    assert_in_range(n[0], 2000, 10000);
    assert_in_range(n[1], 1, n[0] / 100);
    assert_true(airy[0] > 0.04 * 104400 && airy[0] < 0.08 * 104400);
    assert_true(airy[1] < 0.002 * 104400);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_particles_trap_air_as_eq_2_says),
        cmocka_unit_test(trapped_air_is_summed_over_neighbours),
        cmocka_unit_test(two_particles_are_a_crest_where_they_move_along_their_normal),
        cmocka_unit_test(a_ridge_is_a_crest_and_a_plain_and_a_trough_are_none),
        cmocka_unit_test(water_that_fills_its_basin_has_no_crests_at_the_walls),
        cmocka_unit_test(beside_a_wall_what_faces_away_from_it_is_surface),
        cmocka_unit_test(as_many_are_born_as_n_d_says),
        cmocka_unit_test(the_potentials_of_causes_add_up_and_that_of_energy_multiplies),
        cmocka_unit_test(births_fill_the_cylinder_of_the_way_and_come_in_the_order_of_particles),
        cmocka_unit_test(births_of_any_direction_have_numbers_of_their_own),
        cmocka_unit_test(what_is_born_of_more_potential_lasts_longer),
        cmocka_unit_test(births_have_the_kind_of_their_place),
        cmocka_unit_test(other_seeds_and_other_steps_draw_other_numbers),
        cmocka_unit_test(at_the_limit_the_new_are_thinned_evenly_and_the_old_stay),
        cmocka_unit_test(slow_water_emits_nothing),
        cmocka_unit_test(spray_follows_its_parabola_bit_by_bit),
        cmocka_unit_test(kinds_go_by_the_count_of_neighbours),
        cmocka_unit_test(beside_a_wall_half_as_many_neighbours_make_a_bubble),
        cmocka_unit_test(foam_moves_with_the_average_of_the_flow),
        cmocka_unit_test(foam_moves_with_a_uniform_flow),
        cmocka_unit_test(a_bubble_rises_with_its_terminal_velocity),
        cmocka_unit_test(a_bubble_is_as_fast_in_steps_of_any_length),
        cmocka_unit_test(only_foam_ages_and_it_ends_with_its_lifetime),
        cmocka_unit_test(foam_ends_when_its_lifetime_is_spent_to_the_last_bit_and_others_stay_with_none),
        cmocka_unit_test(nothing_leaves_through_a_wall),
        cmocka_unit_test(births_do_not_end_up_in_solids),
        cmocka_unit_test(what_leaves_by_an_open_side_or_gets_into_a_sink_is_removed),
        cmocka_unit_test(the_bits_are_the_same_for_any_number_of_threads),
        cmocka_unit_test(a_state_read_back_goes_on_as_if_it_had_never_stopped),
        cmocka_unit_test(a_state_stands_between_others_in_a_file),
        cmocka_unit_test(every_truncated_state_is_refused),
        cmocka_unit_test(states_that_cannot_be_are_refused),
        cmocka_unit_test(a_state_that_cannot_be_written_is_an_error),
        cmocka_unit_test(coincident_particles_and_those_at_rest_give_finite_numbers),
        cmocka_unit_test(water_at_rest_emits_nothing_even_without_limits),
        cmocka_unit_test(a_step_of_no_time_changes_nothing),
        cmocka_unit_test(time_steps_that_cannot_be_are_refused),
        cmocka_unit_test(parameters_out_of_range_are_refused),
        cmocka_unit_test(particles_that_are_not_finite_are_not_added),
        cmocka_unit_test(ids_that_would_repeat_are_refused),
        cmocka_unit_test(more_births_than_counts_hold_are_refused),
        cmocka_unit_test(larger_particles_take_larger_limits_of_trapped_air),
        cmocka_unit_test(rows_have_units_and_defaults_that_hold_to_them),
        cmocka_unit_test(kinds_agree_with_those_of_splishsplash),
        cmocka_unit_test(the_impact_of_a_dam_break_emits_and_what_follows_hardly_does),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_classify.c: foam by Weber number through its phases, splashes by density, spray and strays by neighbours. */
#include "tests/util.h"

#include "scene/classify.h"

#include <float.h>
#include <omp.h>

enum { MAX = 4000 };

/* A frame of particles of 1000 kg/m^3 at rest or, with speed[i], moving; ids as given. */
static ssfr_particles *frame(size_t n, const uint32_t *ids, const double *speeds)
{
    static double positions[3 * MAX];
    static float velocity[3 * MAX], density[MAX];
    uint64_t seed = 2385;
    ssfr_particles *particles = NULL;
    uint32_t id[MAX];
    assert_true(n <= MAX);
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < 3; k++) positions[3 * i + k] = test_random(&seed, 0, 2.385);
        velocity[3 * i] = (float)(0.6 * speeds[i]), velocity[3 * i + 2] = (float)(-0.8 * speeds[i]);
        density[i] = 1000;
        if (ids) id[i] = ids[i];
    }
    const ssfr_particles given = {.velocity = velocity, .density = density, .id = ids ? id : NULL, .radius = 0.02385};
    assert_int_equal(ssfr_particles_create(&particles, n, positions, &given), SSFR_OK);
    return particles;
}

static ssfr_weber *create(const ssfr_weber_params *params, int seed)
{
    ssfr_weber_params own = params ? *params : ssfr_weber_defaults();
    ssfr_weber *weber = NULL;
    own.seed = seed;
    assert_int_equal(ssfr_weber_create(&weber, &own), SSFR_OK);
    return weber;
}

static ssfr_weber_params at_once(void)
{
    ssfr_weber_params params = ssfr_weber_defaults();
    params.lag = 0;
    return params;
}

static ssfr_weber_params started_as_water(void)
{
    ssfr_weber_params params = at_once();
    params.start = SSFR_START_WATER;
    return params;
}

/* rho v^2 reaches the default threshold of 1900 at 1.378 m/s. */
static const double slow = 1.37, fast = 1.39;

typedef struct outcome {
    double foam, lifetime; /* 1, s */
    int phase;
} outcome;

/* One step of one particle. */
static outcome step_one(ssfr_weber *weber, uint32_t id, double speed, double dt)
{
    ssfr_particles *p = frame(1, &id, &speed);
    float foam = -1, lifetime = -1;
    unsigned char phase = 99;
    assert_int_equal(ssfr_weber_step(weber, p, dt, &foam, &lifetime, &phase), SSFR_OK);
    ssfr_particles_destroy(&p);
    return (outcome){(double)foam, (double)lifetime, phase};
}

/* ---- a particle's phases ----------------------------------------------------------------------------------------- */

static void a_particle_goes_through_the_phases_of_the_listings(void **state)
{
    (void)state;
    const ssfr_weber_params params = started_as_water();
    const double dt = 0.03;
    ssfr_weber *weber = create(&params, 2385);
    outcome o = step_one(weber, 7, slow, dt);
    assert_true(o.phase == SSFR_PHASE_WATER && o.foam == 0);
    o = step_one(weber, 7, fast, dt);
    assert_true(o.phase == SSFR_PHASE_WATER_TO_FOAM && o.foam == 0);
    o = step_one(weber, 7, fast, dt);
    const double rise = dt / o.foam; /* s, drawn between 0.25 and 0.5 */
    assert_true(rise >= 0.25 && rise < 0.5);
    for (int k = 2; k * dt < rise; k++) {
        o = step_one(weber, 7, fast, dt);
        assert_int_equal(o.phase, SSFR_PHASE_WATER_TO_FOAM);
        assert_close(o.foam, k * dt / rise, 1e-6, 0);
    }
    for (int k = 0; k < 3; k++) {
        o = step_one(weber, 7, fast, dt);
        assert_true(o.phase == SSFR_PHASE_FOAM && o.foam == 1);
    }
    o = step_one(weber, 7, slow, dt);
    assert_true(o.phase == SSFR_PHASE_FOAM_TO_WATER && o.foam == 1);
    o = step_one(weber, 7, slow, dt);
    const double fall = dt / (1 - o.foam); /* s, drawn between 0.5 and 1.5 */
    assert_true(fall >= 0.5 && fall < 1.5);
    for (int k = 2; k * dt < fall; k++) {
        o = step_one(weber, 7, slow, dt);
        assert_int_equal(o.phase, SSFR_PHASE_FOAM_TO_WATER);
        assert_close(o.foam, 1 - k * dt / fall, 2e-6, 0);
    }
    o = step_one(weber, 7, slow, dt);
    assert_true(o.phase == SSFR_PHASE_WATER && o.foam == 0);
    ssfr_weber_destroy(&weber);
    assert_null(weber);
}

static void a_fade_that_began_goes_on_to_its_end(void **state)
{
    (void)state;
    const ssfr_weber_params params = started_as_water();
    ssfr_weber *weber = create(&params, 2385);
    step_one(weber, 7, fast, 0.1);
    double last = 0;
    outcome o = step_one(weber, 7, slow, 0.1);
    for (; o.phase == SSFR_PHASE_WATER_TO_FOAM; o = step_one(weber, 7, slow, 0.1)) {
        assert_true(o.foam > last);
        last = o.foam;
    }
    assert_true(o.phase == SSFR_PHASE_FOAM && o.foam == 1);
    assert_int_equal(step_one(weber, 7, slow, 0.1).phase, SSFR_PHASE_FOAM_TO_WATER);
    for (o = step_one(weber, 7, fast, 0.1), last = 1; o.phase == SSFR_PHASE_FOAM_TO_WATER;
         o = step_one(weber, 7, fast, 0.1)) {
        assert_true(o.foam < last);
        last = o.foam;
    }
    assert_true(o.phase == SSFR_PHASE_WATER && o.foam == 0);
    ssfr_weber_destroy(&weber);
}

static void a_lone_frame_is_in_the_phase_of_its_weber_numbers(void **state)
{
    (void)state;
    ssfr_weber *weber = create(NULL, 0);
    const uint32_t ids[] = {30, 10, 20};
    const double speeds[] = {fast, slow, 0};
    ssfr_particles *p = frame(3, ids, speeds);
    float foam[3];
    unsigned char phase[3];
    assert_int_equal(ssfr_weber_step(weber, p, 0, foam, NULL, phase), SSFR_OK);
    for (size_t i = 0; i < 3; i++) {
        assert_true(foam[i] == (p->id[i] == 30 ? 1.0f : 0.0f));
        assert_int_equal(phase[i], p->id[i] == 30 ? SSFR_PHASE_FOAM : SSFR_PHASE_WATER);
    }
    ssfr_particles_destroy(&p);
    ssfr_weber_destroy(&weber);
    weber = create(NULL, 0);
    p = frame(3, NULL, speeds); /* which needs no ids */
    assert_int_equal(ssfr_weber_step(weber, p, 0, foam, NULL, NULL), SSFR_OK);
    assert_true(foam[0] + foam[1] + foam[2] == 1);
    ssfr_particles_destroy(&p);
    ssfr_weber_destroy(&weber);
}

static void what_appears_later_begins_as_water(void **state)
{
    (void)state;
    const ssfr_weber_params params = at_once();
    ssfr_weber *weber = create(&params, 2385);
    assert_int_equal(step_one(weber, 7, fast, 0).phase, SSFR_PHASE_FOAM);
    assert_int_equal(step_one(weber, 8, fast, 0.1).phase, SSFR_PHASE_WATER_TO_FOAM); /* 7 is gone */
    assert_int_equal(step_one(weber, 7, fast, 0.1).phase, SSFR_PHASE_WATER_TO_FOAM); /* and was forgotten */
    ssfr_particles *none = frame(0, NULL, NULL);
    assert_int_equal(ssfr_weber_step(weber, none, 0.1, NULL, NULL, NULL), SSFR_OK);
    assert_int_equal(step_one(weber, 7, slow, 0.1).phase, SSFR_PHASE_WATER);
    ssfr_weber_destroy(&weber);
    weber = create(&params, 2385);
    assert_int_equal(ssfr_weber_step(weber, none, 0, NULL, NULL, NULL), SSFR_OK); /* a sequence that begins empty */
    assert_int_equal(step_one(weber, 7, fast, 0.1).phase, SSFR_PHASE_WATER_TO_FOAM);
    ssfr_particles_destroy(&none);
    ssfr_weber_destroy(&weber);
}

static void a_lifetime_counts_from_the_turn_to_foam(void **state)
{
    (void)state;
    const ssfr_weber_params params = started_as_water();
    const double dt = 0.03;
    ssfr_weber *weber = create(&params, 2385);
    assert_close(step_one(weber, 7, slow, dt).lifetime, 0, 0, 0);
    outcome o = step_one(weber, 7, fast, dt);
    assert_true(o.phase == SSFR_PHASE_WATER_TO_FOAM && o.lifetime == 0);
    double time = 0, fade = 0;
    for (int turn = 0; turn < 100 && o.phase != SSFR_PHASE_WATER; turn++) {
        o = step_one(weber, 7, turn < 20 ? fast : slow, dt);
        time += dt;
        assert_close(o.lifetime, o.phase == SSFR_PHASE_WATER ? 0 : time, 1e-6, 0);
        if (o.phase != SSFR_PHASE_WATER_TO_FOAM) continue;
        if (fade == 0) fade = o.lifetime / o.foam;
        assert_close(o.foam, o.lifetime / fade, 1e-5, 0); /* both are linear in time */
    }
    assert_true(o.phase == SSFR_PHASE_WATER && time > 1 && fade > 0.25);
    step_one(weber, 7, fast, dt);
    assert_close(step_one(weber, 7, fast, dt).lifetime, dt, 1e-7, 0); /* a second turn counts anew */
    ssfr_weber_destroy(&weber);
}

static void by_the_text_a_lifetime_is_that_of_a_number_over_the_band(void **state)
{
    (void)state;
    ssfr_weber_params params = started_as_water();
    params.transition = SSFR_TRANSITION_WEBER;
    params.threshold = 1000, params.band = 0.2;
    ssfr_weber *weber = create(&params, 0);
    const double numbers[] = {900, 850, 2000, 799, 801, 1e4}, lifetimes[] = {0, 0.1, 0.2, 0, 0, 0.1};
    for (size_t i = 0; i < SSFR_COUNT(numbers); i++)
        assert_close(step_one(weber, 7, sqrt(numbers[i] / 1000), 0.1).lifetime, lifetimes[i], 1e-7, 0);
    ssfr_weber_destroy(&weber);
}

/* ---- many particles ---------------------------------------------------------------------------------------------- */

enum { N = 3000, FRAMES = 12 };

static double speed_of(uint32_t id, int frame_number)
{
    uint64_t seed = id * 977u + (uint32_t)frame_number;
    test_random(&seed, 0, 1);
    return test_random(&seed, 0, 1.2 * fast);
}

/* Plays a sequence in which particle `id` is there in the frames that keep(id, frame) says, in an order by `stride`
 * (coprime to N); the last frame's values go to foam[id], -1 for those that are not there. */
static void play(int stride, int threads, bool (*keep)(uint32_t, int), float foam[N], unsigned char phase[N])
{
    const ssfr_weber_params params = started_as_water();
    ssfr_weber *weber = create(&params, 1117);
    const int before = omp_get_max_threads();
    float values[N];
    unsigned char phases[N];
    omp_set_num_threads(threads);
    for (uint32_t i = 0; i < N; i++) foam[i] = -1;
    for (int f = 0; f < FRAMES; f++) {
        uint32_t ids[N];
        double speeds[N];
        size_t n = 0;
        for (uint32_t i = 0; i < N; i++) {
            const uint32_t id = i * (uint32_t)stride % N;
            if (!keep(id, f)) continue;
            ids[n] = id, speeds[n++] = speed_of(id, f);
        }
        ssfr_particles *p = frame(n, ids, speeds);
        assert_int_equal(ssfr_weber_step(weber, p, 0.11, values, NULL, phases), SSFR_OK);
        for (size_t i = 0; i < n && f == FRAMES - 1; i++) foam[p->id[i]] = values[i], phase[p->id[i]] = phases[i];
        ssfr_particles_destroy(&p);
    }
    omp_set_num_threads(before);
    ssfr_weber_destroy(&weber);
}

static bool always(uint32_t id, int frame_number)
{
    (void)id, (void)frame_number;
    return true;
}

/* Every third comes late or leaves early. */
static bool coming_and_going(uint32_t id, int frame_number)
{
    return id % 3 != 0 || (id % 2 ? frame_number > (int)(id % 11) : frame_number < (int)(id % 11));
}

static void order_and_threads_change_no_bit(void **state)
{
    (void)state;
    static float foam[4][N];
    static unsigned char phase[4][N];
    size_t n_phases[SSFR_N_PHASES] = {0};
    play(1, 1, always, foam[0], phase[0]);
    play(7, 2, always, foam[1], phase[1]);
    play(1999, 16, always, foam[2], phase[2]);
    for (int k = 1; k < 3; k++) {
        assert_memory_equal(foam[0], foam[k], sizeof foam[0]);
        assert_memory_equal(phase[0], phase[k], sizeof phase[0]);
    }
    for (size_t i = 0; i < N; i++) n_phases[phase[0][i]]++;
    for (int k = 0; k < SSFR_N_PHASES; k++) assert_true(n_phases[k] > N / 50); /* all were there to compare */
    play(7, 2, coming_and_going, foam[3], phase[3]);
    for (uint32_t i = 0; i < N; i++)
        if (i % 3) assert_true(foam[3][i] == foam[0][i] && phase[3][i] == phase[0][i]);
}

static double mean(const double *values, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += values[i];
    return sum / (double)n;
}

enum { TOLD = 3 };

/* What three numbers a particle had in a frame: foam, lifetime and phase; NaN where it was not there. */
typedef double told[N][TOLD];

/* Plays the sequence of coming_and_going. */
static void play_told(int transition, int start, int lag, told frames[FRAMES])
{
    ssfr_weber_params params = ssfr_weber_defaults();
    params.transition = transition, params.start = start, params.lag = lag;
    ssfr_weber *weber = create(&params, 7);
    for (int f = 0; f < FRAMES; f++) {
        static float foam[N], lifetime[N];
        static unsigned char phase[N];
        uint32_t ids[N];
        double speeds[N];
        size_t n = 0;
        for (uint32_t id = 0; id < N; id++) {
            for (int k = 0; k < TOLD; k++) frames[f][id][k] = NAN;
            if (coming_and_going(id, f)) ids[n] = id, speeds[n++] = speed_of(id, f);
        }
        ssfr_particles *p = frame(n, ids, speeds);
        assert_int_equal(ssfr_weber_step(weber, p, 0.11, foam, lifetime, phase), SSFR_OK);
        for (size_t i = 0; i < n; i++) {
            double *to = frames[f][p->id[i]];
            to[0] = (double)foam[i], to[1] = (double)lifetime[i], to[2] = phase[i];
        }
        ssfr_particles_destroy(&p);
    }
    ssfr_weber_destroy(&weber);
}

static void foam_that_lags_is_that_of_the_frame_before(void **state)
{
    (void)state;
    static told now[FRAMES], late[FRAMES];
    static const double water[TOLD] = {0, 0, SSFR_PHASE_WATER};
    for (int mode = 0; mode < 4; mode++) {
        size_t n_new = 0, n_foam = 0;
        play_told(mode % 2, mode / 2, 0, now);
        play_told(mode % 2, mode / 2, 1, late);
        assert_memory_equal(now[0], late[0], sizeof now[0]); /* a first frame has none before it */
        for (int f = 1; f < FRAMES; f++)
            for (uint32_t id = 0; id < N; id++) {
                if (!coming_and_going(id, f)) continue;
                const bool is_new = !coming_and_going(id, f - 1);
                assert_memory_equal(late[f][id], is_new ? water : now[f - 1][id], sizeof water);
                n_new += is_new, n_foam += late[f][id][0] > 0;
            }
        assert_true(n_new > N / 10 && n_foam > N);
    }
}

/* Since more than a fade takes, over as long as foam lasts. */
static void what_a_lone_frame_implies_is_foam_since_a_random_time(void **state)
{
    (void)state;
    static float lifetime[4][N];
    uint32_t ids[N];
    double speeds[N], *foam = NULL;
    for (uint32_t i = 0; i < N; i++) ids[i] = i, speeds[i] = i % 2 ? fast : slow;
    ssfr_particles *p = frame(N, ids, speeds);
    assert_int_equal(ssfr_alloc(&foam, N, sizeof *foam, "lifetimes"), SSFR_OK);
    for (int k = 0; k < 4; k++) {
        ssfr_weber_params params = ssfr_weber_defaults();
        params.fade_in_min = k == 2 ? 0.5 : 0.25, params.fade_in_max = k == 2 ? 0.25 : 0.5; /* in any order */
        params.lifetime = 3;
        if (k == 3) params.start = SSFR_START_WATER;
        ssfr_weber *weber = create(&params, k == 1 ? 2 : 1);
        assert_int_equal(ssfr_weber_step(weber, p, 0, NULL, lifetime[k], NULL), SSFR_OK);
        ssfr_weber_destroy(&weber);
    }
    assert_memory_equal(lifetime[0], lifetime[2], sizeof lifetime[0]);
    size_t n = 0, n_same = 0;
    for (size_t i = 0; i < N; i++) {
        const double seconds = (double)lifetime[0][i];
        if (p->id[i] % 2) assert_true(seconds >= 0.5 && seconds < 3.5);
        else assert_true(seconds == 0);
        if (p->id[i] % 2) foam[n++] = seconds, n_same += lifetime[0][i] == lifetime[1][i];
        assert_true(lifetime[3][i] == 0); /* begun as water, it turns now */
    }
    assert_close(mean(foam, n), 2, 4 * 3 / sqrt(12.0 * (double)n), 0);
    assert_true(n_same < 3); /* another seed */
    ssfr_particles_destroy(&p);
    free(foam);
}

/* How long each of N particles takes to turn to foam, s, from the first step of its fade. */
static void fade_times(int seed, ssfr_weber *weber, double times[N])
{
    const ssfr_weber_params params = started_as_water();
    ssfr_weber *const own = weber ? weber : create(&params, seed);
    static float foam[N];
    uint32_t ids[N];
    double speeds[N];
    for (uint32_t i = 0; i < N; i++) ids[i] = i, speeds[i] = fast;
    ssfr_particles *p = frame(N, ids, speeds);
    assert_int_equal(ssfr_weber_step(own, p, 0.1, foam, NULL, NULL), SSFR_OK);
    assert_int_equal(ssfr_weber_step(own, p, 0.1, foam, NULL, NULL), SSFR_OK);
    for (size_t i = 0; i < N; i++) times[p->id[i]] = 0.1 / (double)foam[i];
    ssfr_particles_destroy(&p);
    if (!weber) ssfr_weber_destroy((ssfr_weber *[]){own});
}

static double correlation(const double *a, const double *b, size_t n)
{
    const double mean_a = mean(a, n), mean_b = mean(b, n);
    double ab = 0, aa = 0, bb = 0;
    for (size_t i = 0; i < n; i++) {
        ab += (a[i] - mean_a) * (b[i] - mean_b);
        aa += ssfr_square(a[i] - mean_a), bb += ssfr_square(b[i] - mean_b);
    }
    return ab / sqrt(aa * bb);
}

static void random_times_are_uniform_and_independent(void **state)
{
    (void)state;
    static double one[N], again[N], other[N], later[N];
    fade_times(1, NULL, one);
    fade_times(1, NULL, again);
    fade_times(2, NULL, other);
    assert_memory_equal(one, again, sizeof one);
    double lo = INFINITY, hi = 0;
    for (size_t i = 0; i < N; i++) lo = fmin(lo, one[i]), hi = fmax(hi, one[i]);
    assert_true(lo >= 0.2499 && lo < 0.2505 && hi > 0.4995 && hi < 0.5001);
    assert_close(mean(one, N), 0.375, 4 * 0.25 / sqrt(12.0 * N), 0);
    const double chance = 4 / sqrt(N);
    assert_close(correlation(one, other, N), 0, chance, 0);
    assert_close(correlation(one, one + 1, N - 1), 0, chance, 0);
    assert_close(correlation(one, one + 64, N - 64), 0, chance, 0);
    /* and a second fade of the same particles */
    const ssfr_weber_params params = started_as_water();
    ssfr_weber *weber = create(&params, 1);
    fade_times(1, weber, again);
    assert_memory_equal(one, again, sizeof one);
    uint32_t ids[N];
    double speeds[N];
    for (uint32_t i = 0; i < N; i++) ids[i] = i, speeds[i] = slow;
    ssfr_particles *p = frame(N, ids, speeds);
    for (int k = 0; k < 3; k++) assert_int_equal(ssfr_weber_step(weber, p, 2, NULL, NULL, NULL), SSFR_OK);
    ssfr_particles_destroy(&p);
    fade_times(1, weber, later);
    assert_close(mean(later, N), 0.375, 4 * 0.25 / sqrt(12.0 * N), 0);
    assert_close(correlation(one, later, N), 0, chance, 0);
    ssfr_weber_destroy(&weber);
}

/* Ids that differ in one byte alone, in another order in each frame. */
static void ids_are_told_apart_by_all_their_bits(void **state)
{
    (void)state;
    static const uint32_t ids[2][5] = {{0x01020304, 0x02020304, 0x01030304, 0x01020404, 0x01020305},
                                       {0x01020305, 0x01020304, 0x01020404, 0x02020304, 0x01030304}};
    const ssfr_weber_params params = started_as_water();
    unsigned char phase[5];
    for (int moving = 0; moving < 5; moving++) {
        ssfr_weber *weber = create(&params, 2385);
        for (int f = 0; f < 2; f++) {
            double speeds[5];
            for (int i = 0; i < 5; i++) speeds[i] = f == 0 && ids[0][i] == ids[0][moving] ? fast : slow;
            ssfr_particles *p = frame(5, ids[f], speeds);
            assert_int_equal(ssfr_weber_step(weber, p, 0.1, NULL, NULL, phase), SSFR_OK);
            for (int i = 0; i < 5; i++)
                assert_int_equal(phase[i], p->id[i] == ids[0][moving] ? SSFR_PHASE_WATER_TO_FOAM : SSFR_PHASE_WATER);
            ssfr_particles_destroy(&p);
        }
        ssfr_weber_destroy(&weber);
    }
}

/* ---- numbers and thresholds -------------------------------------------------------------------------------------- */

static bool is_foam(const ssfr_weber_params *params, double speed)
{
    ssfr_weber *weber = create(params, 0);
    const outcome o = step_one(weber, 1, speed, 0);
    ssfr_weber_destroy(&weber);
    return o.phase == SSFR_PHASE_FOAM;
}

static void length_and_tension_scale_the_number(void **state)
{
    (void)state;
    ssfr_weber_params params = ssfr_weber_defaults();
    assert_true(is_foam(&params, fast) && !is_foam(&params, slow));
    params.length = 0.25;
    assert_true(is_foam(&params, 2 * fast) && !is_foam(&params, 2 * slow));
    params.tension = 4;
    assert_true(is_foam(&params, 4 * fast) && !is_foam(&params, 4 * slow));
    /* the text's own: a drop as wide as the particle, 2 x 0.02385 m, of water at 20 degrees */
    params.length = 0, params.tension = 0.0728;
    params.threshold = 1000 * 2.385 * 2.385 * (2 * 0.02385) / 0.0728;
    assert_true(is_foam(&params, 2.386) && !is_foam(&params, 2.384));
}

/* As the listings compare: foam begins where the number equals the threshold, and ends below it. */
static void a_number_that_equals_the_threshold_is_foam(void **state)
{
    (void)state;
    const uint32_t id = 7;
    ssfr_weber_params params = started_as_water();
    ssfr_particles *p = frame(1, &id, &fast);
    assert_int_equal(ssfr_weber_threshold(p, NULL, 1, &params.threshold), SSFR_OK);
    ssfr_particles_destroy(&p);
    ssfr_weber *weber = create(&params, 2385);
    assert_int_equal(step_one(weber, 7, fast, 0.1).phase, SSFR_PHASE_WATER_TO_FOAM);
    assert_int_equal(step_one(weber, 7, fast, 1).phase, SSFR_PHASE_FOAM);
    assert_int_equal(step_one(weber, 7, fast, 1).phase, SSFR_PHASE_FOAM);
    ssfr_weber_destroy(&weber);
}

static void extreme_thresholds_and_velocities_have_a_phase(void **state)
{
    (void)state;
    ssfr_weber_params params = ssfr_weber_defaults();
    params.threshold = 0;
    assert_true(is_foam(&params, 0) && is_foam(&params, (double)FLT_MAX));
    params.threshold = INFINITY;
    assert_false(is_foam(&params, 0) || is_foam(&params, (double)FLT_MAX));
    params.threshold = 1900;
    assert_true(is_foam(&params, (double)FLT_MAX));
    assert_false(is_foam(&params, (double)FLT_TRUE_MIN));
    params.transition = SSFR_TRANSITION_WEBER;
    const double thresholds[] = {0, INFINITY, 1900}, bands[] = {1e-3, 0.5, 1}, speeds[] = {0, 1.378, (double)FLT_MAX};
    for (size_t t = 0; t < 3; t++)
        for (size_t b = 0; b < 3; b++)
            for (size_t s = 0; s < 3; s++) {
                params.threshold = thresholds[t], params.band = bands[b];
                ssfr_weber *weber = create(&params, 0);
                const outcome o = step_one(weber, 1, speeds[s], 0);
                if (t == 0 || (t == 2 && s == 2)) assert_true(o.foam == 1);
                if (t == 1 || (t == 2 && s == 0)) assert_true(o.foam == 0);
                if (t == 2 && s == 1) assert_close(o.foam, 0.5, 0.3, 0);
                ssfr_weber_destroy(&weber);
            }
}

static void no_time_between_frames_changes_no_value(void **state)
{
    (void)state;
    const ssfr_weber_params params = started_as_water();
    ssfr_weber *weber = create(&params, 2385);
    step_one(weber, 7, fast, 0);
    const double foam = step_one(weber, 7, fast, 0.1).foam;
    for (int k = 0; k < 3; k++) assert_true(step_one(weber, 7, fast, 0).foam == foam);
    assert_int_equal(step_one(weber, 7, fast, 1e300).phase, SSFR_PHASE_FOAM);
    ssfr_weber_destroy(&weber);
}

static void fades_may_take_no_time_at_all(void **state)
{
    (void)state;
    ssfr_weber_params params = started_as_water();
    params.fade_in_min = params.fade_in_max = params.lifetime = 0;
    ssfr_weber *weber = create(&params, 2385);
    const double speeds[] = {fast, fast, slow, slow};
    const double foams[] = {0, 1, 1, 0};
    const int phases[] = {SSFR_PHASE_WATER_TO_FOAM, SSFR_PHASE_FOAM, SSFR_PHASE_FOAM_TO_WATER, SSFR_PHASE_WATER};
    for (size_t k = 0; k < 4; k++) {
        const outcome o = step_one(weber, 7, speeds[k], 0);
        assert_true(o.foam == foams[k] && o.phase == phases[k]);
    }
    ssfr_weber_destroy(&weber);
}

static void the_texts_transition_is_linear_in_the_number(void **state)
{
    (void)state;
    ssfr_weber_params params = at_once();
    params.transition = SSFR_TRANSITION_WEBER;
    params.threshold = 1000, params.band = 0.2;
    ssfr_weber *weber = create(&params, 0);
    const double numbers[] = {0, 799, 850, 1000, 1100, 1201, 1e6}, foams[] = {0, 0, 0.125, 0.5, 0.75, 1, 1};
    for (size_t i = 0; i < SSFR_COUNT(numbers); i++) { /* ids come again in other states: there is none */
        const outcome o = step_one(weber, 7, sqrt(numbers[i] / 1000), 0.1);
        assert_close(o.foam, foams[i], 1e-6, 0);
        assert_int_equal(o.phase, foams[i] <= 0  ? SSFR_PHASE_WATER
                                  : foams[i] < 1 ? SSFR_PHASE_WATER_TO_FOAM
                                                 : SSFR_PHASE_FOAM);
    }
    ssfr_weber_destroy(&weber);
}

static double share_of_foam(const ssfr_particles *p, double threshold)
{
    ssfr_weber_params params = ssfr_weber_defaults();
    params.threshold = threshold;
    ssfr_weber *weber = create(&params, 0);
    float *foam = NULL;
    double sum = 0;
    assert_int_equal(ssfr_alloc(&foam, p->n, sizeof *foam, "foam"), SSFR_OK);
    assert_int_equal(ssfr_weber_step(weber, p, 0, foam, NULL, NULL), SSFR_OK);
    for (size_t i = 0; i < p->n; i++) sum += (double)foam[i];
    ssfr_weber_destroy(&weber);
    free(foam);
    return sum / (double)p->n;
}

static void a_threshold_is_found_for_a_share_of_foam(void **state)
{
    (void)state;
    uint32_t ids[N];
    double speeds[N], threshold = 0;
    for (uint32_t i = 0; i < N; i++) ids[i] = i, speeds[i] = speed_of(i, 0);
    ssfr_particles *p = frame(N, ids, speeds);
    const double shares[] = {0, 1.0 / N, 0.07, 0.1, 0.5, 0.93, 1};
    for (size_t s = 0; s < SSFR_COUNT(shares); s++) {
        assert_int_equal(ssfr_weber_threshold(p, NULL, shares[s], &threshold), SSFR_OK);
        assert_close(share_of_foam(p, threshold), shares[s], 1e-9, 0);
    }
    assert_int_equal(ssfr_weber_threshold(p, NULL, 300.6 / N, &threshold), SSFR_OK);
    assert_close(share_of_foam(p, threshold), 301.0 / N, 1e-9, 0); /* rounded */
    ssfr_weber_params params = ssfr_weber_defaults();
    double scaled = 0;
    params.length = 0.5;
    assert_int_equal(ssfr_weber_threshold(p, NULL, 0.1, &threshold), SSFR_OK);
    assert_int_equal(ssfr_weber_threshold(p, &params, 0.1, &scaled), SSFR_OK);
    assert_close(scaled, 0.5 * threshold, 0, 1e-15);
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_threshold(p, NULL, -0.1, &threshold), "share of -0.1");
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_threshold(p, NULL, NAN, &threshold), "share of nan");
    params.tension = 0;
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_threshold(p, &params, 0.1, &threshold), "weber.tension=0");
    ssfr_particles_destroy(&p);
    p = frame(0, NULL, NULL);
    assert_int_equal(ssfr_weber_threshold(p, NULL, 0.5, &threshold), SSFR_OK);
    assert_true(isinf(threshold));
    ssfr_particles_destroy(&p);
}

/* ---- what is refused --------------------------------------------------------------------------------------------- */

static void remove_array(float **array)
{
    free(*array);
    *array = NULL;
}

static void missing_arrays_are_named(void **state)
{
    (void)state;
    const uint32_t ids[] = {1, 2};
    const double speeds[] = {fast, slow};
    double threshold = 0;
    ssfr_weber *weber = create(NULL, 0);
    ssfr_particles *p = frame(2, NULL, speeds), *named = frame(2, ids, speeds);
    assert_int_equal(ssfr_weber_step(weber, p, 0, NULL, NULL, NULL), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, 0.1, NULL, NULL, NULL), "no array \"id\"");
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, named, 0.1, NULL, NULL, NULL), "no array \"id\"");
    ssfr_weber_destroy(&weber);
    weber = create(NULL, 0);
    assert_int_equal(ssfr_weber_step(weber, named, 0, NULL, NULL, NULL), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, 0.1, NULL, NULL, NULL), "no array \"id\"");
    remove_array(&p->density);
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, 0, NULL, NULL, NULL), "no array \"density\"");
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_threshold(p, NULL, 0.1, &threshold), "no array \"density\"");
    remove_array(&p->velocity);
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, 0, NULL, NULL, NULL), "no array \"velocity\"");
    ssfr_weber_destroy(&weber);
    ssfr_particles_destroy(&p);
    ssfr_particles_destroy(&named);
}

static void a_call_that_fails_changes_no_state(void **state)
{
    (void)state;
    const ssfr_weber_params params = started_as_water();
    const uint32_t twice[] = {7, 9, 7};
    const double speeds[] = {slow, slow, slow};
    ssfr_weber *weber = create(&params, 2385), *other = create(&params, 2385);
    step_one(weber, 7, fast, 0.1), step_one(other, 7, fast, 0.1);
    ssfr_particles *p = frame(3, twice, speeds);
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, 0.1, NULL, NULL, NULL), "both have the id 7");
    ssfr_particles_destroy(&p);
    p = frame(1, twice, speeds);
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, -0.1, NULL, NULL, NULL), "-0.1 s after");
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, NAN, NULL, NULL, NULL), "nan s after");
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, INFINITY, NULL, NULL, NULL), "inf s after");
    p->velocity[1] = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, 0.1, NULL, NULL, NULL), "particle 0 (from 0): velocity (");
    p->velocity[1] = 0, p->density[0] = INFINITY;
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, 0.1, NULL, NULL, NULL), "density inf");
    ssfr_particles_destroy(&p);
    assert_true(step_one(weber, 7, fast, 0.1).foam == step_one(other, 7, fast, 0.1).foam);
    ssfr_weber_destroy(&weber);
    ssfr_weber_destroy(&other);
}

static void the_first_particle_without_a_number_is_named(void **state)
{
    (void)state;
    static const double speeds[4] = {0};
    const int before = omp_get_max_threads();
    ssfr_weber *weber = create(NULL, 0);
    ssfr_particles *p = frame(4, NULL, speeds);
    for (int k = 1; k < 4; k++) p->density[k] = NAN;
    for (int threads = 1; threads <= 4; threads++) {
        omp_set_num_threads(threads);
        assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, p, 0, NULL, NULL, NULL), "particle 1 (from 0)");
    }
    omp_set_num_threads(before);
    ssfr_particles_destroy(&p);
    ssfr_weber_destroy(&weber);
}

static void parameters_out_of_range_are_refused(void **state)
{
    (void)state;
    ssfr_weber *weber = NULL;
    ssfr_weber_params p = ssfr_weber_defaults();
    p.threshold = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_create(&weber, &p), "weber.threshold=nan");
    assert_null(weber);
    p = ssfr_weber_defaults(), p.tension = 0;
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_create(&weber, &p), "weber.tension=0");
    p = ssfr_weber_defaults(), p.start = 2;
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_create(&weber, &p), "weber.start=2");
    p = ssfr_weber_defaults(), p.lifetime = INFINITY;
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_create(&weber, &p), "weber.lifetime=inf");
    p = ssfr_weber_defaults(), p.length = 0;
    weber = create(&p, 0);
    ssfr_particles *particles = frame(1, NULL, &fast);
    particles->radius = 0;
    assert_fails(SSFR_ERR_VALUE, ssfr_weber_step(weber, particles, 0, NULL, NULL, NULL), "weber.length=0");
    ssfr_particles_destroy(&particles);
    ssfr_weber_destroy(&weber);
}

static void memory_grows_with_the_most_particles(void **state)
{
    (void)state;
    ssfr_weber *weber = create(NULL, 0);
    uint32_t ids[N];
    double speeds[N];
    for (uint32_t i = 0; i < N; i++) ids[i] = UINT32_MAX - i, speeds[i] = slow;
    const size_t none = ssfr_weber_bytes(weber);
    const size_t counts[] = {N, N / 2, N};
    for (size_t k = 0; k < 3; k++) {
        ssfr_particles *p = frame(counts[k], ids, speeds);
        assert_int_equal(ssfr_weber_step(weber, p, 0.1, NULL, NULL, NULL), SSFR_OK);
        assert_int_equal(ssfr_weber_bytes(weber) - none, 96 * N);
        ssfr_particles_destroy(&p);
    }
    ssfr_weber_destroy(&weber);
}

/* ---- by density and by neighbours -------------------------------------------------------------------------------- */

static ssfr_particles *counted(size_t n, float *density, uint32_t *neighbours)
{
    double positions[3 * 16];
    ssfr_particles *p = NULL;
    for (size_t i = 0; i < 3 * n; i++) positions[i] = 2.385 * (double)(i / 3); /* along the diagonal: the order stays */
    const ssfr_particles given = {.density = density, .neighbours = neighbours};
    assert_int_equal(ssfr_particles_create(&p, n, positions, &given), SSFR_OK);
    return p;
}

static void splashes_have_a_density_below_the_threshold(void **state)
{
    (void)state;
    float density[] = {254.6f, 499.9f, 500, 1000, 0, (float)INFINITY};
    const unsigned char expected[] = {1, 1, 0, 0, 1, 0};
    unsigned char classes[6];
    size_t counts[SSFR_N_CLASSES];
    ssfr_particles *p = counted(6, density, NULL);
    assert_int_equal(ssfr_classify_by_density(p, 500, classes, counts), SSFR_OK);
    assert_memory_equal(classes, expected, 6);
    assert_true(counts[SSFR_CLASS_LIQUID] == 3 && counts[SSFR_CLASS_SPLASH] == 3);
    assert_true(counts[SSFR_CLASS_FOAM] == 0 && counts[SSFR_CLASS_STRAY] == 0);
    assert_int_equal(ssfr_classify_by_density(p, 0, classes, counts), SSFR_OK);
    assert_int_equal(counts[SSFR_CLASS_SPLASH], 0);
    assert_int_equal(ssfr_classify_by_density(p, INFINITY, classes, NULL), SSFR_OK);
    assert_int_equal(classes[3], SSFR_CLASS_SPLASH);
    assert_fails(SSFR_ERR_VALUE, ssfr_classify_by_density(p, NAN, classes, NULL), "nan kg/m^3");
    p->density[2] = NAN;
    assert_fails(SSFR_ERR_VALUE, ssfr_classify_by_density(p, 500, classes, NULL), "particle 2 (from 0): density nan");
    ssfr_particles_destroy(&p);
    p = counted(6, NULL, NULL);
    assert_fails(SSFR_ERR_VALUE, ssfr_classify_by_density(p, 500, classes, NULL), "no array \"density\"");
    ssfr_particles_destroy(&p);
}

static void few_neighbours_are_strays_and_more_are_foam(void **state)
{
    (void)state;
    uint32_t neighbours[] = {0, 2, 3, 10, 11, UINT32_MAX};
    const unsigned char expected[] = {SSFR_CLASS_STRAY, SSFR_CLASS_STRAY,  SSFR_CLASS_FOAM,
                                      SSFR_CLASS_FOAM,  SSFR_CLASS_LIQUID, SSFR_CLASS_LIQUID};
    unsigned char classes[6];
    size_t counts[SSFR_N_CLASSES];
    ssfr_particles *p = counted(6, NULL, neighbours);
    assert_int_equal(ssfr_classify_by_neighbours(p, 2, 10, classes, counts), SSFR_OK);
    assert_memory_equal(classes, expected, 6);
    assert_true(counts[SSFR_CLASS_LIQUID] == 2 && counts[SSFR_CLASS_FOAM] == 2 && counts[SSFR_CLASS_STRAY] == 2);
    assert_int_equal(ssfr_classify_by_neighbours(p, -1, -1, classes, counts), SSFR_OK);
    assert_int_equal(counts[SSFR_CLASS_LIQUID], 6);
    assert_int_equal(ssfr_classify_by_neighbours(p, INT32_MAX, 0, classes, counts), SSFR_OK);
    assert_int_equal(counts[SSFR_CLASS_STRAY], 5);
    ssfr_particles_destroy(&p);
    p = counted(6, NULL, NULL);
    assert_fails(SSFR_ERR_VALUE, ssfr_classify_by_neighbours(p, 2, 10, classes, NULL), "no array \"neighbours\"");
    ssfr_particles_destroy(&p);
    p = counted(0, NULL, NULL);
    assert_int_equal(ssfr_classify_by_neighbours(p, 2, 10, NULL, counts), SSFR_OK);
    assert_int_equal(ssfr_classify_by_density(p, 500, NULL, counts), SSFR_OK);
    ssfr_particles_destroy(&p);
}

/* ---- a simulation ------------------------------------------------------------------------------------------------ */

static ssfr_particles *load(const char *name)
{
    char path[512];
    ssfr_particles *p = NULL;
    snprintf(path, sizeof path, "%s/%s", test_data_or_skip(), name);
    assert_int_equal(ssfr_particles_load(&p, path, &(ssfr_load_options){.radius = 0.02}), SSFR_OK);
    return p;
}

/* docs/errata.md, B15: what rho v^2 says of a dam break, in SI units. */
static void a_dam_break_has_the_shares_of_the_errata(void **state)
{
    (void)state;
    const char *const names[] = {"ddb_early_fluid.ply", "ddb_mid_fluid.ply"};
    const double shares[] = {0.97, 0.93}, thresholds[] = {10400, 1900};
    for (size_t k = 0; k < 2; k++) {
        ssfr_particles *p = load(names[k]);
        double threshold = 0;
        const double start = ssfr_clock();
        assert_close(share_of_foam(p, 50), shares[k], 0.005, 0);
        const double middle = ssfr_clock();
        assert_int_equal(ssfr_weber_threshold(p, NULL, 0.1, &threshold), SSFR_OK);
        print_message("%s: %.4f foam from 50 (%.1f ms), a tenth from %.0f (%.1f ms)\n", names[k], share_of_foam(p, 50),
                      1e3 * (middle - start), threshold, 1e3 * (ssfr_clock() - middle));
        assert_close(threshold, thresholds[k], 0, 0.02);
        ssfr_particles_destroy(&p);
    }
}

static void a_dam_break_has_few_splashes_and_strays(void **state)
{
    (void)state;
    ssfr_particles *p = load("ddb_mid_fluid.ply");
    unsigned char *classes = NULL;
    size_t counts[SSFR_N_CLASSES];
    assert_int_equal(ssfr_alloc(&classes, p->n, 1, "classes"), SSFR_OK);
    assert_int_equal(ssfr_classify_by_density(p, 500, classes, counts), SSFR_OK);
    print_message("density below 500: %.2f %%\n", 100 * (double)counts[SSFR_CLASS_SPLASH] / (double)p->n);
    assert_true(counts[SSFR_CLASS_SPLASH] > p->n / 100 && counts[SSFR_CLASS_SPLASH] < p->n / 10);
    assert_int_equal(ssfr_classify_by_neighbours(p, 2, 10, classes, counts), SSFR_OK);
    print_message("up to 2 neighbours: %.2f %%, up to 10: %.2f %%\n",
                  100 * (double)counts[SSFR_CLASS_STRAY] / (double)p->n,
                  100 * (double)counts[SSFR_CLASS_FOAM] / (double)p->n);
    assert_true(counts[SSFR_CLASS_STRAY] > 0 && counts[SSFR_CLASS_STRAY] < 1892); /* 1892 have up to 4 */
    assert_true(counts[SSFR_CLASS_STRAY] + counts[SSFR_CLASS_FOAM] > 1892 + 1402);
    free(classes);
    ssfr_particles_destroy(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_goes_through_the_phases_of_the_listings),
        cmocka_unit_test(a_fade_that_began_goes_on_to_its_end),
        cmocka_unit_test(a_lone_frame_is_in_the_phase_of_its_weber_numbers),
        cmocka_unit_test(what_appears_later_begins_as_water),
        cmocka_unit_test(a_lifetime_counts_from_the_turn_to_foam),
        cmocka_unit_test(by_the_text_a_lifetime_is_that_of_a_number_over_the_band),
        cmocka_unit_test(order_and_threads_change_no_bit),
        cmocka_unit_test(foam_that_lags_is_that_of_the_frame_before),
        cmocka_unit_test(what_a_lone_frame_implies_is_foam_since_a_random_time),
        cmocka_unit_test(random_times_are_uniform_and_independent),
        cmocka_unit_test(ids_are_told_apart_by_all_their_bits),
        cmocka_unit_test(length_and_tension_scale_the_number),
        cmocka_unit_test(a_number_that_equals_the_threshold_is_foam),
        cmocka_unit_test(extreme_thresholds_and_velocities_have_a_phase),
        cmocka_unit_test(no_time_between_frames_changes_no_value),
        cmocka_unit_test(fades_may_take_no_time_at_all),
        cmocka_unit_test(the_texts_transition_is_linear_in_the_number),
        cmocka_unit_test(a_threshold_is_found_for_a_share_of_foam),
        cmocka_unit_test(missing_arrays_are_named),
        cmocka_unit_test(a_call_that_fails_changes_no_state),
        cmocka_unit_test(the_first_particle_without_a_number_is_named),
        cmocka_unit_test(parameters_out_of_range_are_refused),
        cmocka_unit_test(memory_grows_with_the_most_particles),
        cmocka_unit_test(splashes_have_a_density_below_the_threshold),
        cmocka_unit_test(few_neighbours_are_strays_and_more_are_foam),
        cmocka_unit_test(a_dam_break_has_the_shares_of_the_errata),
        cmocka_unit_test(a_dam_break_has_few_splashes_and_strays),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}

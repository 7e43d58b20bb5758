/* SPDX-License-Identifier: MIT */
/* weber.c: foam by Weber number: four phases, followed by the particles' ids (Bagar 2010, secs 3.2.1 and 4.2). */
#include "scene/classify.h"

#include <limits.h>

static const char *const transitions[] = {"time", "weber", NULL};
static const char *const starts[] = {"implied", "water", NULL};

#define REAL(name, unit, def, min, max, help) SSFR_PARAM_REAL(ssfr_weber_params, name, unit, def, min, max, help)

const ssfr_param ssfr_weber_rows[] = {
    SSFR_PARAM_CHOICE(ssfr_weber_params, transition, transitions, SSFR_TRANSITION_TIME,
                      "between water and foam: in time (listings A.1, A.2), or linear in the Weber number (the text)"),
    SSFR_PARAM_CHOICE(ssfr_weber_params, start, starts, SSFR_START_IMPLIED,
                      "the first frame's particles are what their Weber numbers imply, or water (listing A.1)"),
    /* By default a tenth of a double dam break that comes to rest is foam (docs/errata.md, B15). */
    REAL(threshold, "1", 1900, 0, INFINITY, "Weber number from which a particle is foam"),
    REAL(length, "m", 1, 0, 1e6, "characteristic length; 0: the particle's diameter"),
    REAL(tension, "N/m", 1, 1e-6, 1e6, "surface tension; length and tension of 1 make the number rho v^2"),
    REAL(band, "1", 0.5, 1e-3, 1, "half the transition in the Weber number, in thresholds"),
    REAL(fade_in_min, "s", 0.25, 0, 1e6, "least time from water to foam"),
    REAL(fade_in_max, "s", 0.5, 0, 1e6, "longest time from water to foam"),
    REAL(lifetime, "s", 1, 0, 1e6, "time from foam to water, before it is varied"),
    REAL(lifetime_share_min, "1", 0.5, 0, 1e3, "least share of the lifetime"),
    REAL(lifetime_share_max, "1", 1.5, 0, 1e3, "largest share of the lifetime"),
    SSFR_PARAM_INT(ssfr_weber_params, lag, "frames", 1, 0, 1,
                   "how late foam is: it is updated while the next frame is simulated (sec. 4.2, listing A.3)"),
    SSFR_PARAM_INT(ssfr_weber_params, seed, "1", 0, 0, INT_MAX, "of the random times"),
    SSFR_PARAM_END,
};

#undef REAL

ssfr_weber_params ssfr_weber_defaults(void)
{
    ssfr_weber_params params;
    ssfr_params_default(ssfr_weber_rows, &params);
    return params;
}

/* ---- Weber numbers ----------------------------------------------------------------------------------------------- */

/* l / sigma, m^2/N */
static double weber_scale(const ssfr_weber_params *params, const ssfr_particles *particles)
{
    return (params->length > 0 ? params->length : 2 * particles->radius) / params->tension;
}

static double weber_number(const ssfr_particles *particles, size_t i, double scale)
{
    const float *v = particles->velocity + 3 * i;
    const double velocity[3] = {(double)v[0], (double)v[1], (double)v[2]};
    return (double)particles->density[i] * ssfr_dot(velocity, velocity) * scale;
}

static ssfr_result check_particles(const ssfr_weber_params *params, const ssfr_particles *particles)
{
    ssfr_result result = SSFR_OK;
    const double scale = weber_scale(params, particles);
    size_t bad = SIZE_MAX;
    SSFR_TRY(ssfr_particles_need(particles, "velocity", "a Weber number"));
    SSFR_TRY(ssfr_particles_need(particles, "density", "a Weber number"));
    if (particles->n && !(scale > 0))
        SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "weber.length=0: the particles have no radius to take its place"));
#pragma omp parallel for schedule(static) reduction(min : bad)
    for (size_t i = 0; i < particles->n; i++)
        if (!isfinite(weber_number(particles, i, scale)) && i < bad) bad = i;
    if (bad != SIZE_MAX) {
        const float *v = particles->velocity + 3 * bad;
        SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "particle %zu (from 0): velocity (%g, %g, %g) m/s, density %g kg/m^3: they "
                                           "give no Weber number",
                           bad, (double)v[0], (double)v[1], (double)v[2], (double)particles->density[bad]));
    }
end:
    return result;
}

static int by_falling_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

ssfr_result ssfr_weber_threshold(const ssfr_particles *particles, const ssfr_weber_params *params, double share,
                                 double *threshold)
{
    ssfr_result result = SSFR_OK;
    const ssfr_weber_params p = params ? *params : ssfr_weber_defaults();
    double *numbers = NULL;
    SSFR_TRY(ssfr_params_check(ssfr_weber_rows, &p, "weber"));
    if (!(share >= 0 && share <= 1))
        SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "foam of a share of %g of the particles: expected 0 to 1", share));
    SSFR_TRY(check_particles(&p, particles));
    SSFR_TRY(ssfr_alloc(&numbers, particles->n, sizeof *numbers, "Weber numbers"));
    const double scale = weber_scale(&p, particles);
    for (size_t i = 0; i < particles->n; i++) numbers[i] = weber_number(particles, i, scale);
    qsort(numbers, particles->n, sizeof *numbers, by_falling_value);
    const size_t n_foam = (size_t)rint(share * (double)particles->n);
    *threshold = n_foam ? numbers[n_foam - 1] : INFINITY;
end:
    free(numbers);
    return result;
}

/* ---- a particle's phases ----------------------------------------------------------------------------------------- */

typedef struct state {
    uint32_t id;
    unsigned draws : 30; /* random numbers taken so far */
    unsigned phase : 2;
    double timer;        /* s, left of the fade */
    double fade;         /* s, its whole time */
    double lifetime;     /* s, since the turn to foam began */
    float foam;
} state;

struct ssfr_weber {
    ssfr_weber_params params;
    bool started, nameless; /* a frame was seen; it had no ids */
    size_t n, capacity;
    state *states, *next;   /* by rising id */
    uint64_t *keys, *spare; /* id << 32 | index */
};

/* In [lo, hi). */
static double draw(const ssfr_weber *weber, state *s, double lo, double hi)
{
    const uint64_t seed = (uint64_t)weber->params.seed + 0x9e3779b97f4a7c15u;
    const uint64_t who = ssfr_mix_bits((uint64_t)s->id << 32 | s->draws);
    const uint64_t bits = ssfr_mix_bits(ssfr_mix_bits(seed) ^ who);
    s->draws = (s->draws + 1) & 0x3fffffff;
    return ssfr_mix(lo, hi, (double)(bits >> 11) * 0x1p-53);
}

static void begin_fade(state *s, ssfr_phase phase, double time)
{
    s->phase = (unsigned)phase & 3;
    s->timer = s->fade = time;
    if (phase == SSFR_PHASE_WATER) s->lifetime = 0;
}

static float faded(const state *s)
{
    const double left = s->fade > 0 ? s->timer / s->fade : 1;
    switch ((ssfr_phase)s->phase) {
    case SSFR_PHASE_WATER_TO_FOAM: return (float)(1 - left);
    case SSFR_PHASE_FOAM: return 1;
    case SSFR_PHASE_FOAM_TO_WATER: return (float)left;
    default: return 0;
    }
}

/* Listings A.1 and A.2. */
static void turn_in_time(const ssfr_weber *weber, state *s, double number, double dt)
{
    const ssfr_weber_params *p = &weber->params;
    if (s->phase != SSFR_PHASE_WATER) s->lifetime += dt;
    switch ((ssfr_phase)s->phase) {
    case SSFR_PHASE_WATER:
        if (number >= p->threshold)
            begin_fade(s, SSFR_PHASE_WATER_TO_FOAM, draw(weber, s, p->fade_in_min, p->fade_in_max));
        break;
    case SSFR_PHASE_FOAM:
        if (number < p->threshold)
            begin_fade(s, SSFR_PHASE_FOAM_TO_WATER,
                       p->lifetime * draw(weber, s, p->lifetime_share_min, p->lifetime_share_max));
        break;
    default:
        s->timer -= dt;
        if (s->timer <= 0)
            begin_fade(s, s->phase == SSFR_PHASE_WATER_TO_FOAM ? SSFR_PHASE_FOAM : SSFR_PHASE_WATER, 0);
        break;
    }
    s->foam = faded(s);
}

/* From 0 at 1 - band thresholds to 1 at 1 + band. */
static double linear_foam(const ssfr_weber_params *p, double number)
{
    if (number >= p->threshold * (1 + p->band)) return 1;
    return ssfr_clamp((number / p->threshold - (1 - p->band)) / (2 * p->band), 0, 1);
}

/* The text: the Weber number alone says how much is foam. */
static void turn_by_number(const ssfr_weber *weber, state *s, double number, double dt)
{
    const double foam = linear_foam(&weber->params, number);
    s->lifetime = s->phase == SSFR_PHASE_WATER || foam <= 0 ? 0 : s->lifetime + dt;
    s->phase = foam <= 0 ? SSFR_PHASE_WATER : foam < 1 ? SSFR_PHASE_WATER_TO_FOAM : SSFR_PHASE_FOAM;
    s->foam = (float)foam;
}

/* As if for long: since a random time that is more than a fade takes, over as long as foam lasts. */
static void imply(const ssfr_weber *weber, state *s, double number)
{
    const ssfr_weber_params *p = &weber->params;
    if (p->transition == SSFR_TRANSITION_WEBER) {
        turn_by_number(weber, s, number, 0);
    } else {
        s->phase = number >= p->threshold ? SSFR_PHASE_FOAM : SSFR_PHASE_WATER;
        s->foam = faded(s);
    }
    const double fade = fmax(p->fade_in_min, p->fade_in_max);
    if (s->phase != SSFR_PHASE_WATER) s->lifetime = draw(weber, s, fade, fade + p->lifetime);
}

static void turn(const ssfr_weber *weber, state *s, double number, double dt)
{
    if (!weber->started && weber->params.start == SSFR_START_IMPLIED) imply(weber, s, number);
    else if (weber->params.transition == SSFR_TRANSITION_WEBER) turn_by_number(weber, s, number, dt);
    else turn_in_time(weber, s, number, dt);
}

/* ---- all particles, by id ---------------------------------------------------------------------------------------- */

static void release(ssfr_weber *weber)
{
    free(weber->states), free(weber->next), free(weber->keys), free(weber->spare);
}

static ssfr_result reserve(ssfr_weber *weber, size_t n)
{
    ssfr_result result = SSFR_OK;
    ssfr_weber grown = *weber;
    if (n <= weber->capacity) return SSFR_OK;
    grown.states = grown.next = NULL, grown.keys = grown.spare = NULL;
    SSFR_TRY(ssfr_alloc(&grown.states, n, sizeof *grown.states, "foam phases"));
    SSFR_TRY(ssfr_alloc(&grown.next, n, sizeof *grown.next, "foam phases"));
    SSFR_TRY(ssfr_alloc(&grown.keys, n, sizeof *grown.keys, "particle ids"));
    SSFR_TRY(ssfr_alloc(&grown.spare, n, sizeof *grown.spare, "particle ids"));
    if (weber->n) memcpy(grown.states, weber->states, weber->n * sizeof *grown.states);
    release(weber);
    grown.capacity = n;
    *weber = grown;
    grown = (ssfr_weber){0};
end:
    if (result != SSFR_OK) release(&grown);
    return result;
}

/* Sorts n keys by their upper halves, in place; the spare array is as long. */
static void sort_by_id(uint64_t *keys, uint64_t *spare, size_t n)
{
    enum { DIGIT_BITS = 8, N_DIGITS = 1 << DIGIT_BITS };
    for (int shift = 32; shift < 64; shift += DIGIT_BITS) { /* four passes: the result is back in keys */
        size_t starts[N_DIGITS + 1] = {0};
        for (size_t i = 0; i < n; i++) starts[(keys[i] >> shift & (N_DIGITS - 1)) + 1]++;
        for (int d = 0; d < N_DIGITS; d++) starts[d + 1] += starts[d];
        for (size_t i = 0; i < n; i++) spare[starts[keys[i] >> shift & (N_DIGITS - 1)]++] = keys[i];
        uint64_t *const swap = keys;
        keys = spare;
        spare = swap;
    }
}

static uint32_t id_of(uint64_t key)
{
    return (uint32_t)(key >> 32);
}

/* Lists the frame's particles by rising id; without ids they are numbered. */
static ssfr_result list_ids(ssfr_weber *weber, const ssfr_particles *particles)
{
    const size_t n = particles->n;
    for (size_t i = 0; i < n; i++)
        weber->keys[i] = (uint64_t)(particles->id ? particles->id[i] : (uint32_t)i) << 32 | (uint32_t)i;
    sort_by_id(weber->keys, weber->spare, n);
    for (size_t k = 1; k < n; k++)
        if (id_of(weber->keys[k]) == id_of(weber->keys[k - 1]))
            return ssfr_fail(SSFR_ERR_VALUE, "particles %u and %u (from 0) both have the id %u",
                             (uint32_t)weber->keys[k - 1], (uint32_t)weber->keys[k], id_of(weber->keys[k]));
    return SSFR_OK;
}

/* The last frame's states of those that are still there; the others begin as water. */
static void take_over(ssfr_weber *weber, size_t n)
{
    const state *old = weber->states, *const end = old + weber->n;
    for (size_t k = 0; k < n; k++) {
        const uint32_t id = id_of(weber->keys[k]);
        while (old < end && old->id < id) old++;
        weber->next[k] = old < end && old->id == id ? *old : (state){.id = id};
    }
}

/* What a step is asked for; each may be NULL. */
typedef struct told {
    float *foam, *lifetime;
    unsigned char *phase;
} told;

static void tell(const told *to, size_t i, const state *s)
{
    if (to->foam) to->foam[i] = s->foam;
    if (to->lifetime) to->lifetime[i] = (float)s->lifetime;
    if (to->phase) to->phase[i] = s->phase;
}

/* Foam that lags is what it was before this turn; those that are new were water. */
static void turn_all(ssfr_weber *weber, const ssfr_particles *particles, double dt, const told *to)
{
    const bool late = weber->params.lag && weber->started;
    const double scale = weber_scale(&weber->params, particles);
#pragma omp parallel for schedule(static)
    for (size_t k = 0; k < particles->n; k++) {
        state *s = &weber->next[k];
        const size_t i = (uint32_t)weber->keys[k];
        if (late) tell(to, i, s);
        turn(weber, s, weber_number(particles, i, scale), dt);
        if (!late) tell(to, i, s);
    }
}

static ssfr_result check_ids(const ssfr_weber *weber, const ssfr_particles *particles)
{
    ssfr_result result = SSFR_OK;
    if (weber->started && particles->n) SSFR_TRY(ssfr_particles_need(particles, "id", "foam from frame to frame"));
    if (weber->nameless)
        SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "the last frame's particles had no array \"id\": foam from frame to frame "
                                           "needs it"));
end:
    return result;
}

ssfr_result ssfr_weber_create(ssfr_weber **out, const ssfr_weber_params *params)
{
    ssfr_result result = SSFR_OK;
    const ssfr_weber_params p = params ? *params : ssfr_weber_defaults();
    *out = NULL;
    SSFR_TRY(ssfr_params_check(ssfr_weber_rows, &p, "weber"));
    SSFR_TRY(ssfr_alloc(out, 1, sizeof **out, "foam phases"));
    (*out)->params = p;
end:
    return result;
}

void ssfr_weber_destroy(ssfr_weber **weber)
{
    if (*weber) release(*weber);
    free(*weber);
    *weber = NULL;
}

void ssfr_weber_restart(ssfr_weber *weber, const ssfr_weber_params *params)
{
    weber->params = *params;
    weber->started = weber->nameless = false;
    weber->n = 0;
}

ssfr_result ssfr_weber_step(ssfr_weber *weber, const ssfr_particles *particles, double dt, float *foam, float *lifetime,
                            unsigned char *phase)
{
    ssfr_result result = SSFR_OK;
    if (!(dt >= 0 && isfinite(dt))) SSFR_TRY(ssfr_fail(SSFR_ERR_VALUE, "foam: a frame %g s after the last", dt));
    SSFR_TRY(check_particles(&weber->params, particles));
    SSFR_TRY(check_ids(weber, particles));
    SSFR_TRY(reserve(weber, particles->n));
    SSFR_TRY(list_ids(weber, particles));
    take_over(weber, particles->n);
    turn_all(weber, particles, dt, &(told){foam, lifetime, phase});
    state *const swap = weber->states;
    weber->states = weber->next;
    weber->next = swap;
    weber->n = particles->n;
    weber->nameless = particles->n && !particles->id;
    weber->started = true;
end:
    return result;
}

size_t ssfr_weber_bytes(const ssfr_weber *weber)
{
    return sizeof *weber + weber->capacity * 2 * (sizeof(state) + sizeof(uint64_t));
}

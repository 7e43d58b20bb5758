/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foam.c: spray, foam and bubbles: emission by potentials, motion by kind, lifetimes (Ihmsen et al. 2012). */
#include "experiments/scenes/foam.h"

#include "base/param.h"
#include "experiments/scenes/foam_flow.h"

#include <errno.h>
#include <sys/stat.h>

/* ---- parameters -------------------------------------------------------------------------------------------------- */

#define AIR_MOST 1e6 /* m/s, where the limits of trapped air end */

/* The limits of trapped air and crests are the paper's. Where streams meet, velocity differences do not depend on the
 * radius; in smooth flow they, and with them trapped air, shrink as it does. Those of the energy are a hundredth of the
 * paper's, which has bigger waters: with the mass of 51.2 g they are reached at 1.4 and 4.4 m/s, at any radius. */
#define REAL(name, unit, def, max, help) SSFR_PARAM_REAL(ssfr_foam_params, name, unit, def, 0, max, help)
#define WHOLE(name, def, max, help) SSFR_PARAM_INT(ssfr_foam_params, name, "1", def, 0, max, help)
const ssfr_param ssfr_foam_rows[] = {
    REAL(trapped_air_rate, "1/s", 4000, 1e7,
         "k_ta of n_d = I_k (k_ta I_ta + k_wc I_wc) dt, which a fluid particle emits in a step"),
    REAL(wave_crest_rate, "1/s", 50000, 1e7, "k_wc of n_d"),
    REAL(trapped_air_min, "m/s", 5, AIR_MOST,
         "tau_ta: I_ta rises from 0 here to 1 at the maximum, over sum |v_ij| (1 - v_ij . x_ij) (1 - |x_ij| / h)"),
    REAL(trapped_air_max, "m/s", 20, AIR_MOST, "tau_ta"),
    REAL(wave_crest_min, "1", 2, 1e6,
         "tau_wc: of I_wc, over sum (1 - n_i . n_j) (1 - |x_ij| / h) of the surface below n_i where v_i . n_i >= 0.6"),
    REAL(wave_crest_max, "1", 8, 1e6, "tau_wc"),
    REAL(energy_min, "J", 0.05, 1e9,
         "tau_k: of I_k, over m v^2 / 2 of a particle of the radius 0.02 m; for others it grows with the mass"),
    REAL(energy_max, "J", 0.5, 1e9, "tau_k"),
    REAL(lifetime_min, "s", 2, 1e6, "of foam born of potentials near 0; spray and bubbles do not age"),
    REAL(lifetime_max, "s", 5, 1e6, "of foam born of full potentials: its lifetime rises with I_k max(I_ta, I_wc)"),
    WHOLE(spray_below, 6, 1000, "with fewer fluid neighbours it is spray"),
    WHOLE(bubbles_above, 20, 1000, "with more it is a bubble, between them foam"),
    REAL(buoyancy, "g", 2, 1000, "k_b of bubbles: v += -k_b g dt + k_d (v_fluid - v)"),
    REAL(drag, "1", 0.8, 1, "k_d of bubbles; they come to rise at k_b g dt / k_d"),
    REAL(bubble_step, "s", 0.02, 10,
         "dt of these two: so long later a bubble is as fast as after one step of it, in however many; 0: every step"),
    WHOLE(max_particles, 2000000, 2e9, "where they find no room, fewer are emitted; 0: no limit"),
    SSFR_PARAM_END};
#undef REAL
#undef WHOLE

#define ENERGY_RADIUS 0.02 /* m, of the particle whose energy the limits mean */

/* As the columns of a double dam break meet, 5 % of its particles are above trapped_air_min when their radius is 0.02 m
 * and 28 % when it is 0.05 m; with a limit in proportion 4 % are. Those of the energy follow the mass by themselves. */
void ssfr_foam_params_coarsen(ssfr_foam_params *params, double scale)
{
    params->trapped_air_min = fmin(scale * params->trapped_air_min, AIR_MOST);
    params->trapped_air_max = fmin(scale * params->trapped_air_max, AIR_MOST);
}

static ssfr_result check_pair(const char *what, double min, double max)
{
    if (min <= max) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_VALUE, "foam.%s_min=%g is above foam.%s_max=%g", what, min, what, max);
}

static ssfr_result check_params(const ssfr_foam_params *p)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_params_check(ssfr_foam_rows, p, "foam"));
    SSFR_TRY(check_pair("trapped_air", p->trapped_air_min, p->trapped_air_max));
    SSFR_TRY(check_pair("wave_crest", p->wave_crest_min, p->wave_crest_max));
    SSFR_TRY(check_pair("energy", p->energy_min, p->energy_max));
    SSFR_TRY(check_pair("lifetime", p->lifetime_min, p->lifetime_max));
end:
    return result;
}

/* ---- state ------------------------------------------------------------------------------------------------------- */

/* Of a particle: name, C type, values. */
#define ARRAYS(X)                                             \
    X(position, double, 3)        /* m, world */              \
    X(velocity, float, 3)         /* m/s */                   \
    X(lifetime, float, 1)         /* s, remaining */          \
    X(initial_lifetime, float, 1) /* s */                     \
    X(id, uint32_t, 1)            /* in the order of birth */ \
    X(kind, uint8_t, 1)           /* ssfr_kind, or DEAD */

#define X(name, type, count) + sizeof(type) * (count)
enum { PARTICLE_BYTES = 0 ARRAYS(X) };
#undef X
_Static_assert(PARTICLE_BYTES == 49, "foam.h says how many");

enum { DEAD = SSFR_BUBBLE + 1 }; /* to be removed */

struct ssfr_foam {
    ssfr_foam_params params;
    double gravity[3]; /* m/s^2 */
    uint64_t seed;
    ssfr_domain domain;
    uint64_t steps, births; /* so far; the next id is `births` */
    size_t n, capacity;
#define X(name, type, count) type *name;
    ARRAYS(X)
#undef X
    ssfr_foam_flow flow;
    size_t n_first;   /* of the two below, by the fluid's index: */
    uint32_t *first;  /* n + 1, how many are born of those before */
    float *longevity; /* n, where between the shortest lifetime and the longest, [0, 1] */
};

ssfr_result ssfr_foam_create(ssfr_foam **out, const ssfr_foam_params *params, const double gravity[3], uint64_t seed)
{
    ssfr_result result = SSFR_OK;
    *out = NULL;
    SSFR_TRY(check_params(params));
    SSFR_TRY(ssfr_alloc(out, 1, sizeof **out, "foam"));
    **out = (ssfr_foam){.params = *params, .gravity = {gravity[0], gravity[1], gravity[2]}, .seed = seed,
                        .domain = {.lo = {-INFINITY, -INFINITY, -INFINITY}, .hi = {INFINITY, INFINITY, INFINITY}}};
end:
    return result;
}

void ssfr_foam_destroy(ssfr_foam **foam)
{
    ssfr_foam *f = *foam;
    if (f) {
#define X(name, type, count) free(f->name);
        ARRAYS(X)
#undef X
        ssfr_foam_flow_finish(&f->flow);
        free(f->first);
        free(f->longevity);
    }
    free(f);
    *foam = NULL;
}

void ssfr_foam_bound(ssfr_foam *foam, const double lo[3], const double hi[3], const bool open[6])
{
    memcpy(foam->domain.lo, lo, sizeof foam->domain.lo);
    memcpy(foam->domain.hi, hi, sizeof foam->domain.hi);
    memcpy(foam->domain.open, open, sizeof foam->domain.open);
}

size_t ssfr_foam_count(const ssfr_foam *foam)
{
    return foam->n;
}

/* array: the address of a pointer. */
static ssfr_result resize(void *array, size_t n, size_t size)
{
    void *memory;
    memcpy(&memory, array, sizeof memory);
    memory = realloc(memory, n * size);
    if (!memory) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %zu x %zu bytes of foam", n, size);
    memcpy(array, &memory, sizeof memory);
    return SSFR_OK;
}

/* Room for n particles; half as much again each time, so that a particle is moved a few times at most. */
static ssfr_result reserve(ssfr_foam *foam, size_t n)
{
    ssfr_result result = SSFR_OK;
    const size_t more = foam->capacity + foam->capacity / 2, capacity = n > more ? n : more;
    if (n <= foam->capacity) return SSFR_OK;
#define X(name, type, count) SSFR_TRY(resize(&foam->name, capacity, (count) * sizeof(type)));
    ARRAYS(X)
#undef X
    foam->capacity = capacity;
end:
    return result;
}

/* At most so many particles at a time. */
static uint64_t limit(const ssfr_foam *foam)
{
    return foam->params.max_particles ? (uint64_t)foam->params.max_particles : UINT32_MAX;
}

ssfr_result ssfr_foam_add(ssfr_foam *foam, size_t n, const double *positions, const float *velocities,
                          const float *lifetimes)
{
    ssfr_result result = SSFR_OK;
    if (n > UINT32_MAX || foam->n + n > limit(foam) || foam->births + n > UINT32_MAX)
        return ssfr_fail(SSFR_ERR_VALUE, "%zu diffuse particles more beside %zu: at most %ju, and %u ever", n, foam->n,
                         (uintmax_t)limit(foam), UINT32_MAX);
    SSFR_TRY(reserve(foam, foam->n + n));
    for (size_t i = 0; i < n; i++) {
        const size_t to = foam->n + i;
        bool finite = isfinite(lifetimes[i]);
        for (size_t k = 0; k < 3; k++) {
            finite = finite && isfinite(positions[3 * i + k]) && isfinite(velocities[3 * i + k]);
            foam->position[3 * to + k] = positions[3 * i + k];
            foam->velocity[3 * to + k] = velocities[3 * i + k];
        }
        if (!finite) return ssfr_fail(SSFR_ERR_VALUE, "diffuse particle %zu (from 0) is not finite", i);
        foam->lifetime[to] = foam->initial_lifetime[to] = lifetimes[i];
        foam->id[to] = (uint32_t)(foam->births + i);
        foam->kind[to] = SSFR_SPRAY;
    }
    foam->n += n;
    foam->births += n;
end:
    return result;
}

/* Removes the dead; the others keep their order. */
static void sweep(ssfr_foam *foam)
{
    size_t to = 0;
    for (size_t i = 0; i < foam->n; i++) {
        if (foam->kind[i] == DEAD) continue;
#define X(name, type, count) \
    if (to < i) memcpy(foam->name + to * (count), foam->name + i * (count), (count) * sizeof(type));
        ARRAYS(X)
#undef X
        to++;
    }
    foam->n = to;
}

void ssfr_foam_remove(ssfr_foam *foam, const ssfr_solid *sink)
{
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < foam->n; i++) {
        double normal[3];
        if (ssfr_solid_distance(sink, foam->position + 3 * i, normal) < 0) foam->kind[i] = DEAD;
    }
    sweep(foam);
}

/* ---- motion ------------------------------------------------------------------------------------------------------ */

/* By the count of fluid neighbours. What seems foam may be a bubble beside a wall, behind which there is no fluid to
 * count. */
static ssfr_kind classify(const ssfr_foam_params *p, const ssfr_walls *walls, int n_neighbours, const double at[3])
{
    if (n_neighbours < p->spray_below) return SSFR_SPRAY;
    if (n_neighbours > p->bubbles_above) return SSFR_BUBBLE;
    return n_neighbours / ssfr_walls_free(walls, at) > p->bubbles_above ? SSFR_BUBBLE : SSFR_FOAM;
}

/* What is the same for all particles in a step. */
typedef struct pace {
    double dt;   /* s */
    double drag; /* of the difference to the fluid's velocity, which a bubble loses */
    double lift; /* s, by which buoyancy accelerates it */
} pace;

/* The paper steps from frame to frame, and its bubbles rise with a velocity that goes with the step. In a part of
 * bubble_step, T, they go the part of the way that dt / T steps would: v - v_T shrinks by (1 - k_d)^(dt / T) and
 * v_T = -k_b g T / k_d stays. */
static pace find_pace(const ssfr_foam_params *p, double dt)
{
    const double drag = p->bubble_step > 0 ? 1 - pow(1 - p->drag, dt / p->bubble_step) : p->drag;
    const double lift = p->bubble_step > 0 && p->drag > 0 ? p->bubble_step * drag / p->drag : dt;
    return (pace){dt, drag, lift};
}

/* The velocity that a particle moves with in this step. */
static void accelerate(const ssfr_foam *foam, ssfr_kind kind, const ssfr_foam_average *around, const pace *pace,
                       double v[3])
{
    for (int k = 0; k < 3; k++) {
        const double g = foam->gravity[k];
        const double fluid = around->weight > 0 ? (double)(around->momentum[k] / around->weight) : v[k];
        switch (kind) {
        case SSFR_SPRAY: v[k] += pace->dt * g; break;
        case SSFR_FOAM: v[k] = fluid; break;
        case SSFR_BUBBLE: v[k] += -pace->lift * foam->params.buoyancy * g + pace->drag * (fluid - v[k]); break;
        }
    }
}

static void move(ssfr_foam *foam, const ssfr_walls *walls, const pace *pace, size_t i)
{
    double from[3], at[3], v[3];
    for (size_t k = 0; k < 3; k++) from[k] = foam->position[3 * i + k], v[k] = (double)foam->velocity[3 * i + k];
    const ssfr_foam_average around = ssfr_foam_flow_average(&foam->flow, from);
    const ssfr_kind kind = classify(&foam->params, walls, around.n, from);
    accelerate(foam, kind, &around, pace, v);
    for (int k = 0; k < 3; k++) at[k] = from[k] + pace->dt * v[k];
    ssfr_walls_keep(walls, from, at, v);
    for (size_t k = 0; k < 3; k++) foam->position[3 * i + k] = at[k], foam->velocity[3 * i + k] = (float)v[k];
    if (kind == SSFR_FOAM) foam->lifetime[i] -= (float)pace->dt;
    const bool dead = (kind == SSFR_FOAM && foam->lifetime[i] <= 0) || ssfr_domain_leaves(&foam->domain, at);
    foam->kind[i] = dead ? DEAD : (uint8_t)kind;
}

/* ---- random numbers ---------------------------------------------------------------------------------------------- */

/* An output of SplitMix64, whose state is x. */
static uint64_t mix(uint64_t x)
{
    return ssfr_mix_bits(x + UINT64_C(0x9e3779b97f4a7c15));
}

/* Number `draw` of fluid particle i in this step, [0, 1). */
static double draw_number(const ssfr_foam *foam, size_t i, uint64_t draw)
{
    const uint64_t bits = mix(mix(mix(mix(foam->seed) ^ foam->steps) ^ i) ^ draw);
    return (double)(bits >> 11) * 0x1p-53;
}

/* ---- emission ---------------------------------------------------------------------------------------------------- */

/* Phi of eq. 1: from 0 at min to 1 at max; a step where they are one. */
static double rise(double value, double min, double max)
{
    if (max > min) return (fmin(value, max) - fmin(value, min)) / (max - min);
    return value > min ? 1 : 0;
}

static double energy_potential(const ssfr_foam_params *p, const float velocity[3], double radius)
{
    const double scale = ssfr_particle_mass(radius) / ssfr_particle_mass(ENERGY_RADIUS);
    return rise((double)ssfr_foam_flow_energy(velocity, radius), p->energy_min * scale, p->energy_max * scale);
}

/* How many are born of particle s, and how long they last: larger clusters are more stable. */
static void count_births(ssfr_foam *foam, size_t s, double dt)
{
    const ssfr_foam_params *p = &foam->params;
    const ssfr_foam_flow *f = &foam->flow;
    const size_t i = f->order[s];
    float velocity[3];
    ssfr_foam_flow_velocity(f, s, velocity);
    const double i_k = energy_potential(p, velocity, f->radius);
    foam->first[i] = 0;
    foam->longevity[i] = 0;
    if (!(i_k > 0)) return;
    const ssfr_foam_cause cause = ssfr_foam_flow_cause(f, s);
    const double i_ta = rise((double)cause.trapped_air, p->trapped_air_min, p->trapped_air_max);
    const double i_wc = rise((double)cause.wave_crest, p->wave_crest_min, p->wave_crest_max);
    const double n_d = i_k * (p->trapped_air_rate * i_ta + p->wave_crest_rate * i_wc) * dt;
    const double whole = fmin(floor(n_d), UINT32_MAX - 1);
    foam->first[i] = (uint32_t)whole + (draw_number(foam, i, 0) < n_d - whole ? 1 : 0);
    foam->longevity[i] = (float)(i_k * fmax(i_ta, i_wc));
}

/* Turns counts into sums of those before; when there is no room for all, they are thinned evenly. */
static ssfr_result sum_births(ssfr_foam *foam, size_t n, size_t *n_born)
{
    uint64_t total = 0, before = 0;
    for (size_t i = 0; i < n; i++) total += foam->first[i];
    const uint64_t room = limit(foam) > foam->n ? limit(foam) - foam->n : 0;
    const uint64_t born = foam->params.max_particles && total > room ? room : total;
    if (total > UINT32_MAX || born > room || foam->births + born > UINT32_MAX)
        return ssfr_fail(SSFR_ERR_VALUE,
                         "%ju diffuse particles more beside %zu, after %ju births: counts and ids go up to %u",
                         (uintmax_t)total, foam->n, (uintmax_t)foam->births, UINT32_MAX);
    for (size_t i = 0; i < n; i++) {
        const uint64_t count = foam->first[i];
        foam->first[i] = (uint32_t)(total ? before * born / total : 0);
        before += count;
    }
    foam->first[n] = (uint32_t)born;
    *n_born = (size_t)born;
    return SSFR_OK;
}

/* Two unit vectors at right angles to the unit vector v and to each other. */
static void span_plane(const double v[3], double a[3], double b[3])
{
    double axis[3] = {0};
    int least = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(v[k]) < fabs(v[least])) least = k;
    axis[least] = 1;
    ssfr_cross(v, axis, a);
    ssfr_normalize(a);
    ssfr_cross(v, a, b);
}

/* Particle e of those born of fluid particle i, somewhere in the cylinder along the way that the fluid particle went in
 * this step. It moves off the cylinder's axis by itself, by as much in a second as it is away from it. */
static void bear(ssfr_foam *foam, const ssfr_fluid *fluid, const ssfr_walls *walls, size_t i, uint32_t e)
{
    const ssfr_foam_params *p = &foam->params;
    const size_t to = foam->n + foam->first[i] + e;
    const uint64_t draw = 1 + 3 * (uint64_t)e;
    const double r = fluid->radius * sqrt(draw_number(foam, i, draw));
    const double theta = 2 * M_PI * draw_number(foam, i, draw + 1);
    double from[3], at[3], v[3], direction[3], a[3], b[3];
    for (size_t k = 0; k < 3; k++) direction[k] = v[k] = (double)fluid->velocity[3 * i + k];
    const double back = ssfr_normalize(direction) * walls->dt * draw_number(foam, i, draw + 2);
    span_plane(direction, a, b);
    for (size_t k = 0; k < 3; k++) {
        const double aside = r * (cos(theta) * a[k] + sin(theta) * b[k]);
        from[k] = fluid->origin[k] + (double)fluid->position[3 * i + k];
        at[k] = from[k] + aside - back * direction[k];
        v[k] += aside;
    }
    ssfr_walls_keep(walls, from, at, v);
    for (size_t k = 0; k < 3; k++) foam->position[3 * to + k] = at[k], foam->velocity[3 * to + k] = (float)v[k];
    foam->lifetime[to] = (float)ssfr_mix(p->lifetime_min, p->lifetime_max, (double)foam->longevity[i]);
    foam->initial_lifetime[to] = foam->lifetime[to];
    foam->id[to] = (uint32_t)(foam->births + foam->first[i] + e);
    foam->kind[to] = (uint8_t)classify(p, walls, ssfr_foam_flow_average(&foam->flow, at).n, at);
}

/* False for a fluid that is too slow to emit anything: then nothing else of it need be known. */
static bool is_lively(const ssfr_foam *foam, const ssfr_fluid *fluid)
{
    bool lively = false;
    for (size_t i = 0; i < fluid->n && !lively; i++)
        lively = energy_potential(&foam->params, fluid->velocity + 3 * i, fluid->radius) > 0;
    return lively;
}

static ssfr_result reserve_births(ssfr_foam *foam, size_t n)
{
    ssfr_result result = SSFR_OK;
    if (n <= foam->n_first) return SSFR_OK;
    SSFR_TRY(resize(&foam->first, n + 1, sizeof *foam->first));
    SSFR_TRY(resize(&foam->longevity, n, sizeof *foam->longevity));
    foam->n_first = n;
end:
    return result;
}

static ssfr_result emit(ssfr_foam *foam, const ssfr_fluid *fluid, const ssfr_walls *walls)
{
    ssfr_result result = SSFR_OK;
    size_t n_born = 0;
    if (!is_lively(foam, fluid)) return SSFR_OK;
    SSFR_TRY(reserve_births(foam, fluid->n));
    ssfr_foam_flow_find_normals(&foam->flow, walls);
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t s = 0; s < fluid->n; s++) count_births(foam, s, walls->dt);
    SSFR_TRY(sum_births(foam, fluid->n, &n_born));
    SSFR_TRY(reserve(foam, foam->n + n_born));
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t i = 0; i < fluid->n; i++)
        for (uint32_t e = 0; e < foam->first[i + 1] - foam->first[i]; e++) bear(foam, fluid, walls, i, e);
    foam->n += n_born;
    foam->births += n_born;
end:
    return result;
}

/* ---- steps ------------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_foam_step(ssfr_foam *foam, const ssfr_fluid *fluid, double dt, int n_obstacles,
                           const ssfr_obstacle *obstacles)
{
    ssfr_result result = SSFR_OK;
    const double support = SSFR_SUPPORT * fluid->radius;
    const pace pace = find_pace(&foam->params, dt);
    ssfr_walls walls;
    if (!(dt >= 0 && isfinite(dt)))
        return ssfr_fail(SSFR_ERR_VALUE, "time step of foam: %g s: expected one from 0", dt);
    SSFR_TRY(ssfr_walls_init(&walls, &foam->domain, support, dt, n_obstacles, obstacles));
    if (dt == 0) goto end;
    SSFR_TRY(ssfr_foam_flow_sort(&foam->flow, fluid));
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t i = 0; i < foam->n; i++) move(foam, &walls, &pace, i);
    sweep(foam);
    SSFR_TRY(emit(foam, fluid, &walls));
    foam->steps++;
end:
    return result;
}

ssfr_result ssfr_foam_causes(ssfr_foam *foam, const ssfr_fluid *fluid, int n_obstacles, const ssfr_obstacle *obstacles,
                             ssfr_foam_cause *out)
{
    ssfr_result result = SSFR_OK;
    ssfr_walls walls;
    ssfr_foam_flow *f = &foam->flow;
    SSFR_TRY(ssfr_walls_init(&walls, &foam->domain, SSFR_SUPPORT * fluid->radius, 0, n_obstacles, obstacles));
    SSFR_TRY(ssfr_foam_flow_sort(f, fluid));
    ssfr_foam_flow_find_normals(f, &walls);
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t s = 0; s < f->n; s++) out[f->order[s]] = ssfr_foam_flow_cause(f, s);
end:
    return result;
}

/* ---- export, and the state on disk ------------------------------------------------------------------------------- */

ssfr_result ssfr_foam_export(const ssfr_foam *foam, double radius, ssfr_particles **out)
{
    ssfr_result result = SSFR_OK;
    uint32_t *kind = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&kind, foam->n, sizeof *kind, "the foam's kinds"));
    for (size_t i = 0; i < foam->n; i++) kind[i] = foam->kind[i];
    const ssfr_particles given = {.velocity = foam->velocity, .lifetime = foam->lifetime,
                                  .initial_lifetime = foam->initial_lifetime, .id = foam->id, .kind = kind,
                                  .radius = radius};
    SSFR_TRY(ssfr_particles_create(out, foam->n, foam->position, &given));
end:
    free(kind);
    return result;
}

typedef struct header {
    uint64_t magic; /* tells the byte order too */
    uint64_t steps, births, n;
} header;

#define MAGIC UINT64_C(0x31306d616f667373) /* "ssfoam01" */

ssfr_result ssfr_foam_write(const ssfr_foam *foam, FILE *file)
{
    const header h = {MAGIC, foam->steps, foam->births, foam->n};
    bool ok = fwrite(&h, sizeof h, 1, file) == 1;
#define X(name, type, count) \
    ok = ok && (foam->n == 0 || fwrite(foam->name, (count) * sizeof(type), foam->n, file) == foam->n);
    ARRAYS(X)
#undef X
    return ok ? SSFR_OK : ssfr_fail(SSFR_ERR_IO, "writing the state of foam: %s", strerror(errno));
}

/* Bytes from here to the file's end; 0 when it cannot be told. */
static uintmax_t bytes_left(FILE *file)
{
    struct stat info;
    const off_t at = ftello(file);
    return fstat(fileno(file), &info) == 0 && at >= 0 && info.st_size > at ? (uintmax_t)(info.st_size - at) : 0;
}

static ssfr_result read_header(FILE *file, header *h)
{
    if (fread(h, sizeof *h, 1, file) != 1)
        return ssfr_fail(SSFR_ERR_FORMAT, "state of foam: the file ends within its header of %zu bytes", sizeof *h);
    if (h->magic != MAGIC)
        return ssfr_fail(SSFR_ERR_FORMAT, "state of foam: begins with 0x%jx instead of 0x%jx", (uintmax_t)h->magic,
                         (uintmax_t)MAGIC);
    if (h->births > UINT32_MAX || h->n > h->births)
        return ssfr_fail(SSFR_ERR_FORMAT, "state of foam: %ju particles of %ju births", (uintmax_t)h->n,
                         (uintmax_t)h->births);
    if (h->n > bytes_left(file) / PARTICLE_BYTES)
        return ssfr_fail(SSFR_ERR_FORMAT, "state of foam: %ju particles of %d bytes, but %ju bytes follow",
                         (uintmax_t)h->n, PARTICLE_BYTES, bytes_left(file));
    return SSFR_OK;
}

static ssfr_result check_particles(const ssfr_foam *foam)
{
    for (size_t i = 0; i < foam->n; i++) {
        bool ok = foam->kind[i] < DEAD && foam->id[i] < foam->births && isfinite(foam->lifetime[i]) &&
                  isfinite(foam->initial_lifetime[i]);
        for (size_t k = 0; k < 3; k++)
            ok = ok && isfinite(foam->position[3 * i + k]) && isfinite(foam->velocity[3 * i + k]);
        if (!ok)
            return ssfr_fail(SSFR_ERR_FORMAT, "state of foam: particle %zu (from 0): kind %d, id %ju of %ju, %g s: no "
                             "such can be", i, foam->kind[i], (uintmax_t)foam->id[i], (uintmax_t)foam->births,
                             (double)foam->lifetime[i]);
    }
    return SSFR_OK;
}

ssfr_result ssfr_foam_read(ssfr_foam *foam, FILE *file)
{
    ssfr_result result = SSFR_OK;
    header h;
    bool ok = true;
    foam->n = 0;
    SSFR_TRY(read_header(file, &h));
    SSFR_TRY(reserve(foam, (size_t)h.n));
#define X(name, type, count) \
    ok = ok && (h.n == 0 || fread(foam->name, (count) * sizeof(type), (size_t)h.n, file) == h.n);
    ARRAYS(X)
#undef X
    if (!ok) {
        result = ssfr_fail(SSFR_ERR_IO, "reading the state of foam: %s", strerror(errno));
        goto end;
    }
    foam->steps = h.steps, foam->births = h.births, foam->n = (size_t)h.n;
    SSFR_TRY(check_particles(foam));
end:
    if (result != SSFR_OK) foam->n = 0;
    return result;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foam.c: spray, foam and bubbles: emission by potentials, motion by kind, lifetimes (Ihmsen et al. 2012). */
#include "experiments/scenes/foam.h"

#include "base/param.h"

#include <assert.h>
#include <errno.h>
#include <sys/stat.h>

/* ---- parameters -------------------------------------------------------------------------------------------------- */

/* Velocity differences of streams that meet do not depend on the radius; those of smooth flow shrink as it does. */
#define REAL(name, unit, def, max, help) SSFR_PARAM_REAL(ssfr_foam_params, name, unit, def, 0, max, help)
const ssfr_param ssfr_foam_rows[] = {
    REAL(trapped_air_rate, "1/s", 4000, 1e7,
         "k_ta of n_d = I_k (k_ta I_ta + k_wc I_wc) dt: particles that one of the fluid emits in a second"),
    REAL(wave_crest_rate, "1/s", 50000, 1e7, "k_wc of n_d"),
    REAL(trapped_air_min, "m/s", 5, 1e6,
         "tau_ta: I_ta rises from 0 here to 1 at the maximum, over sum |v_ij| (1 - v_ij . x_ij) (1 - |x_ij| / h)"),
    REAL(trapped_air_max, "m/s", 20, 1e6, "tau_ta"),
    REAL(wave_crest_min, "1", 2, 1e6,
         "tau_wc: of I_wc, over sum (1 - n_i . n_j) (1 - |x_ij| / h) of the surface below n_i where v_i . n_i >= 0.6"),
    REAL(wave_crest_max, "1", 8, 1e6, "tau_wc"),
    REAL(energy_min, "J", 0.05, 1e9,
         "tau_k: of I_k, over m v^2 / 2 of a particle of the radius 0.02 m (51.2 g); for others it grows with the mass"),
    REAL(energy_max, "J", 0.5, 1e9, "tau_k"),
    REAL(lifetime_min, "s", 2, 1e6, "of foam born of potentials near 0; spray and bubbles do not age"),
    REAL(lifetime_max, "s", 5, 1e6, "of foam born of full potentials: its lifetime grows with I_k max(I_ta, I_wc)"),
    SSFR_PARAM_INT(ssfr_foam_params, spray_below, "1", 6, 0, 1000, "with fewer fluid neighbours it is spray"),
    SSFR_PARAM_INT(ssfr_foam_params, bubbles_above, "1", 20, 0, 1000, "with more it is a bubble, between them foam"),
    REAL(buoyancy, "g", 2, 1000, "k_b of bubbles: v += -k_b g dt + k_d (v_fluid - v); they rise at k_b g dt / k_d"),
    REAL(drag, "1", 0.8, 1, "k_d of bubbles, of every step"),
    SSFR_PARAM_INT(ssfr_foam_params, max_particles, "1", 2000000, 0, 2e9, "at this count no more are emitted; 0: never"),
    SSFR_PARAM_END};
#undef REAL

#define ENERGY_RADIUS 0.02 /* m, of the particle whose energy the limits mean */
#define CREST_COSINE 0.6   /* eq. 7: between velocity and normal, from which a crest counts */
/* Of the colour field's gradient, in the sum of its terms' magnitudes: 0.28 at the flat surface of a cubic lattice; inside a
 * simulated fluid (39 neighbours and more) it stays below 0.18. */
#define SURFACE_SHARE 0.2f

static ssfr_result check_pair(const char *what, double min, double max)
{
    return min <= max ? SSFR_OK : ssfr_fail(SSFR_ERR_VALUE, "foam: %s_min = %g is above %s_max = %g", what, min, what, max);
}

static ssfr_result check_params(const ssfr_foam_params *p)
{
    ssfr_result result = SSFR_OK;
    for (const ssfr_param *row = ssfr_foam_rows; row->name; row++) {
        const double value = ssfr_param_number(row, p);
        if (!(value >= row->min && value <= row->max))
            return ssfr_fail(SSFR_ERR_VALUE, "foam: %s = %g: out of range [%g, %g]", row->name, value, row->min,
                             row->max);
    }
    SSFR_TRY(check_pair("trapped_air", p->trapped_air_min, p->trapped_air_max));
    SSFR_TRY(check_pair("wave_crest", p->wave_crest_min, p->wave_crest_max));
    SSFR_TRY(check_pair("energy", p->energy_min, p->energy_max));
    SSFR_TRY(check_pair("lifetime", p->lifetime_min, p->lifetime_max));
end:
    return result;
}

/* ---- state ------------------------------------------------------------------------------------------------------- */

/* Of a particle: name, C type, values. */
#define ARRAYS(X)                                            \
    X(position, double, 3)        /* m, world */             \
    X(velocity, float, 3)         /* m/s */                  \
    X(lifetime, float, 1)         /* s, remaining */         \
    X(initial_lifetime, float, 1) /* s */                    \
    X(id, uint32_t, 1)            /* in the order of birth */ \
    X(kind, uint8_t, 1)           /* ssfr_kind, or DEAD */

#define X(name, type, count) + sizeof(type) * (count)
enum { PARTICLE_BYTES = 0 ARRAYS(X) };
#undef X
_Static_assert(PARTICLE_BYTES == 49, "foam.h says how many");

enum { DEAD = SSFR_BUBBLE + 1 }; /* to be removed */

typedef struct domain {
    double lo[3], hi[3]; /* m, world */
    bool open[6];
} domain;

/* The fluid in the order of the grid's cells: neighbours are neighbours in memory. */
typedef struct flow {
    size_t n, capacity;
    const ssfr_grid *grid;
    const uint32_t *order;  /* the fluid's index of each */
    double origin[3];       /* m, world */
    float support;          /* m */
    float lo[3], hi[3];     /* m, relative to origin: nobody outside has a neighbour */
    float *at, *velocity;   /* 3 n */
    float *normal;          /* 3 n, unit; 0 where there is no surface */
    uint32_t *first;        /* n + 1, by the fluid's index: how many are born of those before */
    float *share;           /* n, by the fluid's index: of the way from the shortest lifetime to the longest */
} flow;

struct ssfr_foam {
    ssfr_foam_params params;
    double gravity[3]; /* m/s^2 */
    uint64_t seed;
    domain domain;
    uint64_t steps, births; /* so far; the next id is `births` */
    size_t n, capacity;
#define X(name, type, count) type *name;
    ARRAYS(X)
#undef X
    flow flow;
};

ssfr_result ssfr_foam_create(ssfr_foam **out, const ssfr_foam_params *params, const double gravity[3], uint64_t seed)
{
    ssfr_result result = SSFR_OK;
    ssfr_foam *foam = NULL;
    *out = NULL;
    SSFR_TRY(check_params(params));
    SSFR_TRY(ssfr_alloc(&foam, 1, sizeof *foam, "foam"));
    foam->params = *params;
    foam->seed = seed;
    for (int k = 0; k < 3; k++) {
        foam->gravity[k] = gravity[k];
        foam->domain.lo[k] = -INFINITY, foam->domain.hi[k] = INFINITY;
    }
    *out = foam;
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
        free(f->flow.at);
        free(f->flow.velocity);
        free(f->flow.normal);
        free(f->flow.first);
        free(f->flow.share);
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

static ssfr_result resize(void *array, size_t n, size_t size)
{
    void *memory;
    memcpy(&memory, array, sizeof memory);
    memory = realloc(memory, n * size);
    if (!memory) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %zu x %zu bytes of foam", n, size);
    memcpy(array, &memory, sizeof memory);
    return SSFR_OK;
}

/* Room for n particles. Half as much again each time, so that growing costs a constant share of all. */
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
        return ssfr_fail(SSFR_ERR_VALUE, "foam: %zu more beside %zu particles: at most %ju, and %u ever", n, foam->n,
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
        if (!finite) return ssfr_fail(SSFR_ERR_VALUE, "foam: particle %zu (from 0) to be added is not finite", i);
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

void ssfr_foam_keep(ssfr_foam *foam, const double lo[3], const double hi[3])
{
    for (size_t i = 0; i < foam->n; i++)
        for (size_t k = 0; k < 3; k++) {
            const double at = foam->position[3 * i + k];
            if (at < lo[k] || at > hi[k]) foam->kind[i] = DEAD;
        }
    sweep(foam);
}

/* ---- solids and the domain's walls ------------------------------------------------------------------------------- */

typedef struct box {
    double lo[3], hi[3]; /* m, world */
} box;

typedef struct walls {
    int n;
    const ssfr_obstacle *obstacles;
    box reach[SSFR_MAX_SOLIDS]; /* around each in the whole step, and the support more */
    const domain *domain;
    double support; /* m */
    double dt;      /* s */
} walls;

static ssfr_result find_walls(walls *w, const domain *domain, double support, double dt, int n,
                              const ssfr_obstacle *obstacles)
{
    if (n < 0 || n > SSFR_MAX_SOLIDS)
        return ssfr_fail(SSFR_ERR_VALUE, "foam: %d obstacles, at most %d", n, SSFR_MAX_SOLIDS);
    *w = (walls){.n = n, .obstacles = obstacles, .domain = domain, .support = support, .dt = dt};
    for (int i = 0; i < n; i++) {
        box before, *now = w->reach + i;
        ssfr_solid_bounds(&obstacles[i].before, before.lo, before.hi);
        ssfr_solid_bounds(&obstacles[i].now, now->lo, now->hi);
        for (int k = 0; k < 3; k++) {
            now->lo[k] = fmin(now->lo[k], before.lo[k]) - support;
            now->hi[k] = fmax(now->hi[k], before.hi[k]) + support;
        }
    }
    return SSFR_OK;
}

/* Whether the box between the two places meets the other. */
static bool passes(const box *b, const double from[3], const double to[3])
{
    bool meets = true;
    for (int k = 0; k < 3; k++)
        meets = meets && fmax(from[k], to[k]) >= b->lo[k] && fmin(from[k], to[k]) <= b->hi[k];
    return meets;
}

/* Distance to a closed side of the domain, m; infinite for an open one. Its normal points inwards. */
static double side_distance(const domain *d, int side, const double at[3], double normal[3])
{
    const int k = side / 2;
    const bool high = side % 2;
    normal[0] = normal[1] = normal[2] = 0;
    normal[k] = high ? -1 : 1;
    return d->open[side] ? INFINITY : high ? d->hi[k] - at[k] : at[k] - d->lo[k];
}

/* Distance and normal of wall i, solids first, then the domain's sides; infinite when out of the support's reach. */
static double wall_distance(const walls *w, int i, const double at[3], double normal[3])
{
    if (i >= w->n) return side_distance(w->domain, i - w->n, at, normal);
    return passes(w->reach + i, at, at) ? ssfr_solid_distance(&w->obstacles[i].now, at, normal) : INFINITY;
}

static int n_walls(const walls *w)
{
    return w->n + 6;
}

/* The share of the support's ball around a place that is on the fluid's side of all walls: each cuts off a cap. */
static double free_share(const walls *w, const double at[3])
{
    double share = 1, normal[3];
    for (int i = 0; i < n_walls(w); i++) {
        const double x = ssfr_clamp(wall_distance(w, i, at, normal) / w->support, 0, 1);
        share *= 1 - ssfr_square(1 - x) * (2 + x) / 4;
    }
    return share;
}

/* Takes from the velocity what points into the obstacle, and friction's share of what runs along it. */
static void stop_at(const ssfr_obstacle *obstacle, const double at[3], const double normal[3], double dt, double v[3])
{
    double wall[3], relative[3];
    ssfr_obstacle_motion(obstacle, at, wall);
    for (int k = 0; k < 3; k++) wall[k] /= dt, relative[k] = v[k] - wall[k];
    const double inwards = ssfr_dot(relative, normal);
    for (int k = 0; k < 3 && inwards < 0; k++)
        v[k] = wall[k] + (1 - obstacle->friction) * (relative[k] - inwards * normal[k]);
}

/* Keeps a path out of an obstacle: it slides along the place where it enters, and what is inside is pushed out. */
static bool meet_obstacle(const walls *w, const ssfr_obstacle *obstacle, const double from[3], double at[3], double v[3])
{
    double normal[3], local[3], start[3], path[3], face[3];
    double distance = ssfr_solid_distance(&obstacle->now, at, normal);
    ssfr_solid_local(&obstacle->before, from, local); /* the path as seen from the solid, */
    ssfr_solid_world(&obstacle->now, local, start);   /* which may move */
    for (int k = 0; k < 3; k++) path[k] = at[k] - start[k];
    /* Farther off than the path is long, it cannot have passed through. */
    if (distance >= sqrt(ssfr_dot(path, path))) return false;
    const double t = ssfr_solid_enter(&obstacle->now, start, path, face);
    const bool entered = t >= 0 && t <= 1;
    if (!entered && distance >= 0) return false;
    if (entered) {
        const double inwards = (1 - t) * ssfr_dot(path, face);
        for (int k = 0; k < 3; k++) at[k] -= inwards * face[k];
        distance = ssfr_solid_distance(&obstacle->now, at, normal);
    }
    for (int k = 0; k < 3 && distance < 0; k++) at[k] -= distance * normal[k];
    stop_at(obstacle, at, entered ? face : normal, w->dt, v);
    return true;
}

/* Puts what is beyond a closed side back onto it. */
static bool meet_sides(const domain *d, double at[3], double v[3])
{
    bool met = false;
    for (int side = 0; side < 6; side++) {
        double normal[3];
        const double distance = side_distance(d, side, at, normal);
        if (distance >= 0) continue;
        const int k = side / 2;
        at[k] = side % 2 ? d->hi[k] : d->lo[k];
        if (v[k] * normal[k] < 0) v[k] = 0;
        met = true;
    }
    return met;
}

/* Ends the path from one place to another before walls. Where several meet, pushing out of one may push into the next. */
static void keep_out(const walls *w, const double from[3], double at[3], double v[3])
{
    enum { ROUNDS = 4 };
    bool met = true;
    for (int round = 0; round < ROUNDS && met; round++) {
        met = false;
        for (int i = 0; i < w->n; i++)
            if (passes(w->reach + i, from, at)) met = meet_obstacle(w, w->obstacles + i, from, at, v) || met;
        met = meet_sides(w->domain, at, v) || met;
    }
}

static bool is_outside(const domain *d, const double at[3])
{
    bool outside = false;
    for (int k = 0; k < 3; k++) outside = outside || at[k] < d->lo[k] || at[k] > d->hi[k];
    return outside;
}

/* ---- the fluid around a place ------------------------------------------------------------------------------------ */

static ssfr_result reserve_flow(flow *f, size_t n)
{
    ssfr_result result = SSFR_OK;
    if (n <= f->capacity) return SSFR_OK;
    SSFR_TRY(resize(&f->at, n, 3 * sizeof *f->at));
    SSFR_TRY(resize(&f->velocity, n, 3 * sizeof *f->velocity));
    SSFR_TRY(resize(&f->normal, n, 3 * sizeof *f->normal));
    SSFR_TRY(resize(&f->first, n + 1, sizeof *f->first));
    SSFR_TRY(resize(&f->share, n, sizeof *f->share));
    f->capacity = n;
end:
    return result;
}

static ssfr_result sort_fluid(flow *f, const ssfr_fluid *fluid)
{
    ssfr_result result = SSFR_OK;
    const double support = SSFR_SUPPORT * fluid->radius;
    SSFR_TRY(reserve_flow(f, fluid->n));
    f->n = fluid->n;
    f->support = (float)support;
    memcpy(f->origin, fluid->origin, sizeof f->origin);
    for (int k = 0; k < 3; k++) f->lo[k] = INFINITY, f->hi[k] = -INFINITY;
    if (f->n == 0) return SSFR_OK;
    assert(ssfr_grid_cell(fluid->grid) > 0.999999 * support);
    f->grid = fluid->grid;
    f->order = ssfr_grid_order(fluid->grid);
    for (size_t s = 0; s < f->n; s++)
        for (size_t k = 0; k < 3; k++) {
            const float at = fluid->position[3 * (size_t)f->order[s] + k];
            f->at[3 * s + k] = at;
            f->velocity[3 * s + k] = fluid->velocity[3 * (size_t)f->order[s] + k];
            f->lo[k] = fminf(f->lo[k], at - f->support);
            f->hi[k] = fmaxf(f->hi[k], at + f->support);
        }
end:
    return result;
}

/* What is done with neighbour s at `distance` (m) from a place; d points from the neighbour to the place. */
typedef void visit(void *sums, const flow *f, size_t s, const float d[3], float distance);

/* Visits all fluid particles nearer than the support. Inlined, so that the visit costs no call. */
__attribute__((always_inline)) static inline void each_near(const flow *f, const float at[3], visit *visit, void *sums)
{
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    const float reach = f->support * f->support;
    int n = 0;
    /* False also for the places far away that no float holds. */
    if (at[0] > f->lo[0] && at[0] < f->hi[0] && at[1] > f->lo[1] && at[1] < f->hi[1] && at[2] > f->lo[2] &&
        at[2] < f->hi[2])
        n = ssfr_grid_near(f->grid, at, ranges);
    for (int r = 0; r < n; r++)
        for (size_t s = ranges[r].begin; s < ranges[r].end; s++) {
            const float *other = f->at + 3 * s;
            const float d[3] = {at[0] - other[0], at[1] - other[1], at[2] - other[2]};
            const float square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            if (square < reach) visit(sums, f, s, d, sqrtf(square));
        }
}

static inline float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The cubic spline and minus its slope, not normalised; q is the distance in supports, [0, 1). */
static inline float spline(float q)
{
    const float a = 1 - q, b = q < 0.5f ? 0.5f - q : 0;
    return 2 * a * a * a - 8 * b * b * b;
}

static inline float spline_slope(float q)
{
    const float a = 1 - q, b = q < 0.5f ? 0.5f - q : 0;
    return 6 * a * a - 24 * b * b;
}

/* The fluid's velocity, averaged by the cubic spline, and how many neighbours there are. */
typedef struct average {
    float momentum[3], weight;
    int n;
} average;

static inline void add_velocity(void *sums, const flow *f, size_t s, const float d[3], float distance)
{
    average *a = sums;
    const float weight = spline(distance / f->support);
    (void)d;
    for (size_t k = 0; k < 3; k++) a->momentum[k] += weight * f->velocity[3 * s + k];
    a->weight += weight;
    a->n++;
}

static average average_flow(const flow *f, const double at[3])
{
    average a = {0};
    float relative[3];
    for (int k = 0; k < 3; k++) relative[k] = (float)(at[k] - f->origin[k]);
    each_near(f, relative, add_velocity, &a);
    return a;
}

/* ---- causes: what potentials are made of ------------------------------------------------------------------------- */

/* The gradient of the colour field, of particles of one volume, and its terms' magnitudes; only their ratio counts. */
typedef struct gradient {
    float sum[3], magnitude;
} gradient;

static inline void add_gradient(void *sums, const flow *f, size_t s, const float d[3], float distance)
{
    gradient *g = sums;
    const float slope = spline_slope(distance / f->support), scale = distance > 0 ? slope / distance : 0;
    (void)s;
    for (int k = 0; k < 3; k++) g->sum[k] += scale * d[k];
    g->magnitude += slope;
}

/* Were there fluid behind a wall, mirrored, nothing would point into the wall. */
static void mirror(const walls *w, const double at[3], float sum[3])
{
    for (int i = 0; i < n_walls(w); i++) {
        double normal[3];
        if (!(wall_distance(w, i, at, normal) < w->support)) continue;
        const double away = normal[0] * (double)sum[0] + normal[1] * (double)sum[1] + normal[2] * (double)sum[2];
        for (int k = 0; k < 3 && away < 0; k++) sum[k] -= (float)(away * normal[k]);
    }
}

static void find_normal(flow *f, const walls *w, size_t s)
{
    gradient g = {0};
    float *normal = f->normal + 3 * s;
    each_near(f, f->at + 3 * s, add_gradient, &g);
    if (dot(g.sum, g.sum) > ssfr_square((double)(SURFACE_SHARE * g.magnitude))) {
        double at[3];
        for (size_t k = 0; k < 3; k++) at[k] = f->origin[k] + (double)f->at[3 * s + k];
        mirror(w, at, g.sum);
    }
    const float length = sqrtf(dot(g.sum, g.sum));
    const bool surface = length > SURFACE_SHARE * g.magnitude;
    for (int k = 0; k < 3; k++) normal[k] = surface ? g.sum[k] / length : 0;
}

/* Of particle s. */
typedef struct meeting {
    const float *velocity, *normal;
    float trapped_air, curvature;
} meeting;

static inline void add_meeting(void *sums, const flow *f, size_t s, const float d[3], float distance)
{
    meeting *m = sums;
    const float *v = f->velocity + 3 * s, *normal = f->normal + 3 * s;
    const float weight = 1 - distance / f->support;
    const float apart[3] = {m->velocity[0] - v[0], m->velocity[1] - v[1], m->velocity[2] - v[2]};
    /* |v| (1 - v^ . x^) without dividing by |v|; in one place there is no x^, and no direction counts. */
    const float leaving = distance > 0 ? dot(apart, d) / distance : 0;
    m->trapped_air += (sqrtf(dot(apart, apart)) - leaving) * weight;
    /* Of neighbours that are surface themselves and lie below: x_ji . n_i < 0. */
    if (dot(d, m->normal) > 0 && dot(normal, normal) > 0) m->curvature += (1 - dot(m->normal, normal)) * weight;
}

static bool is_crest(const float v[3], const float normal[3])
{
    const float along = dot(v, normal);
    return along > 0 && along >= (float)CREST_COSINE * sqrtf(dot(v, v));
}

static float energy(const float v[3], double radius)
{
    return (float)(0.5 * ssfr_particle_mass(radius) * (double)dot(v, v));
}

static ssfr_foam_cause find_cause(const flow *f, size_t s, double radius)
{
    meeting m = {f->velocity + 3 * s, f->normal + 3 * s, 0, 0};
    each_near(f, f->at + 3 * s, add_meeting, &m);
    return (ssfr_foam_cause){.trapped_air = m.trapped_air,
                             .wave_crest = is_crest(m.velocity, m.normal) ? m.curvature : 0,
                             .energy = energy(m.velocity, radius)};
}

static void find_normals(flow *f, const walls *w)
{
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t s = 0; s < f->n; s++) find_normal(f, w, s);
}

ssfr_result ssfr_foam_causes(ssfr_foam *foam, const ssfr_fluid *fluid, int n_obstacles, const ssfr_obstacle *obstacles,
                             ssfr_foam_cause *out)
{
    ssfr_result result = SSFR_OK;
    walls w;
    flow *f = &foam->flow;
    SSFR_TRY(find_walls(&w, &foam->domain, SSFR_SUPPORT * fluid->radius, 1, n_obstacles, obstacles));
    SSFR_TRY(sort_fluid(f, fluid));
    find_normals(f, &w);
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t s = 0; s < f->n; s++) out[f->order[s]] = find_cause(f, s, fluid->radius);
end:
    return result;
}

/* ---- random numbers ---------------------------------------------------------------------------------------------- */

/* The output function of SplitMix64 (Steele, Lea and Flood 2014). */
static uint64_t mix(uint64_t x)
{
    x += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
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
    return max > min ? (fmin(value, max) - fmin(value, min)) / (max - min) : value > min ? 1 : 0;
}

static double energy_potential(const ssfr_foam_params *p, double energy, double radius)
{
    const double scale = ssfr_particle_mass(radius) / ssfr_particle_mass(ENERGY_RADIUS);
    return rise(energy, p->energy_min * scale, p->energy_max * scale);
}

/* How many are born of particle s, and for how long: where many are born together they last longer. */
static void count_births(ssfr_foam *foam, size_t s, double radius, double dt)
{
    const ssfr_foam_params *p = &foam->params;
    flow *f = &foam->flow;
    const size_t i = f->order[s];
    const double i_k = energy_potential(p, (double)energy(f->velocity + 3 * s, radius), radius);
    f->first[i] = 0;
    f->share[i] = 0;
    if (!(i_k > 0)) return;
    const ssfr_foam_cause cause = find_cause(f, s, radius);
    const double i_ta = rise((double)cause.trapped_air, p->trapped_air_min, p->trapped_air_max);
    const double i_wc = rise((double)cause.wave_crest, p->wave_crest_min, p->wave_crest_max);
    const double rate = i_k * (p->trapped_air_rate * i_ta + p->wave_crest_rate * i_wc);
    const double n_d = fmin(rate * dt, UINT32_MAX), whole = floor(n_d);
    if (!(rate > 0)) return;
    f->first[i] = (uint32_t)whole + (draw_number(foam, i, 0) < n_d - whole ? 1 : 0);
    f->share[i] = (float)(i_k * fmax(i_ta, i_wc));
}

/* Turns counts into sums of those before; when there is no room for all, thins them evenly. */
static ssfr_result sum_births(ssfr_foam *foam, size_t *n_born)
{
    flow *f = &foam->flow;
    uint64_t total = 0, before = 0;
    for (size_t i = 0; i < f->n; i++) total += f->first[i];
    const uint64_t room = limit(foam) > foam->n ? limit(foam) - foam->n : 0;
    const uint64_t born = foam->params.max_particles && total > room ? room : total;
    if (total > UINT32_MAX || born > room || foam->births + born > UINT32_MAX)
        return ssfr_fail(SSFR_ERR_VALUE,
                         "foam: %ju births after %ju, with %zu particles: counts and ids go up to %u; lower the rates",
                         (uintmax_t)total, (uintmax_t)foam->births, foam->n, UINT32_MAX);
    for (size_t i = 0; i < f->n; i++) {
        const uint64_t count = f->first[i];
        f->first[i] = (uint32_t)(total ? before * born / total : 0);
        before += count;
    }
    f->first[f->n] = (uint32_t)born;
    *n_born = (size_t)born;
    return SSFR_OK;
}

/* Two unit vectors at right angles to the unit vector v and to each other. */
static void span_plane(const double v[3], double a[3], double b[3])
{
    const int smallest = fabs(v[0]) < fabs(v[1]) ? (fabs(v[0]) < fabs(v[2]) ? 0 : 2) : (fabs(v[1]) < fabs(v[2]) ? 1 : 2);
    double axis[3] = {0};
    axis[smallest] = 1;
    ssfr_cross(v, axis, a);
    ssfr_normalize(a);
    ssfr_cross(v, a, b);
}

static uint8_t classify(const ssfr_foam_params *p, const walls *w, int n_neighbours, const double at[3]);

/* Particle e of those born of fluid particle i: somewhere in the cylinder that the fluid particle's volume swept in the
 * step, which ends where it is now. */
static void bear(ssfr_foam *foam, const ssfr_fluid *fluid, const walls *w, size_t i, uint32_t e)
{
    const size_t to = foam->n + foam->flow.first[i] + e;
    const uint64_t draw = 1 + 3 * (uint64_t)e;
    const double r = fluid->radius * sqrt(draw_number(foam, i, draw));
    const double theta = 2 * M_PI * draw_number(foam, i, draw + 1);
    double from[3], at[3], v[3], direction[3], a[3], b[3];
    for (size_t k = 0; k < 3; k++) direction[k] = v[k] = (double)fluid->velocity[3 * i + k];
    const double back = ssfr_normalize(direction) * w->dt * draw_number(foam, i, draw + 2);
    span_plane(direction, a, b);
    for (size_t k = 0; k < 3; k++) {
        const double aside = r * (cos(theta) * a[k] + sin(theta) * b[k]);
        from[k] = fluid->origin[k] + (double)fluid->position[3 * i + k];
        at[k] = from[k] + aside - back * direction[k];
        v[k] += aside; /* 1/s: jets widen by themselves once a second */
    }
    keep_out(w, from, at, v);
    for (size_t k = 0; k < 3; k++) foam->position[3 * to + k] = at[k], foam->velocity[3 * to + k] = (float)v[k];
    const ssfr_foam_params *p = &foam->params;
    foam->lifetime[to] = (float)ssfr_mix(p->lifetime_min, p->lifetime_max, (double)foam->flow.share[i]);
    foam->initial_lifetime[to] = foam->lifetime[to];
    foam->id[to] = (uint32_t)(foam->births + foam->flow.first[i] + e);
    foam->kind[to] = classify(p, w, average_flow(&foam->flow, at).n, at);
}

/* False for a fluid that is too slow to emit anything: then nothing else of it need be known. */
static bool is_lively(const ssfr_foam *foam, const ssfr_fluid *fluid)
{
    bool lively = false;
    for (size_t i = 0; i < fluid->n && !lively; i++)
        lively = energy_potential(&foam->params, (double)energy(fluid->velocity + 3 * i, fluid->radius),
                                  fluid->radius) > 0;
    return lively;
}

static ssfr_result emit(ssfr_foam *foam, const ssfr_fluid *fluid, const walls *w)
{
    ssfr_result result = SSFR_OK;
    flow *f = &foam->flow;
    size_t n_born = 0;
    if (!is_lively(foam, fluid)) return SSFR_OK;
    find_normals(f, w);
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t s = 0; s < f->n; s++) count_births(foam, s, fluid->radius, w->dt);
    SSFR_TRY(sum_births(foam, &n_born));
    SSFR_TRY(reserve(foam, foam->n + n_born));
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t i = 0; i < f->n; i++)
        for (uint32_t e = 0; e < f->first[i + 1] - f->first[i]; e++) bear(foam, fluid, w, i, e);
    foam->n += n_born;
    foam->births += n_born;
end:
    return result;
}

/* ---- motion ------------------------------------------------------------------------------------------------------ */

/* By the count of fluid neighbours. What seems foam beside a wall may be a bubble that sees a part of its support only. */
static uint8_t classify(const ssfr_foam_params *p, const walls *w, int n_neighbours, const double at[3])
{
    if (n_neighbours < p->spray_below) return SSFR_SPRAY;
    const bool bubble = n_neighbours > p->bubbles_above || n_neighbours / free_share(w, at) > p->bubbles_above;
    return bubble ? SSFR_BUBBLE : SSFR_FOAM;
}

/* The velocity a particle moves with in this step. */
static void accelerate(const ssfr_foam *foam, ssfr_kind kind, const average *fluid, double dt, double v[3])
{
    const ssfr_foam_params *p = &foam->params;
    for (int k = 0; k < 3; k++) {
        const double g = foam->gravity[k];
        const double around = fluid->weight > 0 ? (double)(fluid->momentum[k] / fluid->weight) : v[k];
        if (kind == SSFR_SPRAY)
            v[k] += dt * g;
        else if (kind == SSFR_FOAM)
            v[k] = around;
        else
            v[k] += -dt * p->buoyancy * g + p->drag * (around - v[k]);
    }
}

static void move(ssfr_foam *foam, const walls *w, size_t i)
{
    double from[3], at[3], v[3];
    for (size_t k = 0; k < 3; k++) from[k] = foam->position[3 * i + k], v[k] = (double)foam->velocity[3 * i + k];
    const average fluid = average_flow(&foam->flow, from);
    const uint8_t kind = classify(&foam->params, w, fluid.n, from);
    accelerate(foam, kind, &fluid, w->dt, v);
    for (int k = 0; k < 3; k++) at[k] = from[k] + w->dt * v[k];
    keep_out(w, from, at, v);
    for (size_t k = 0; k < 3; k++) foam->position[3 * i + k] = at[k], foam->velocity[3 * i + k] = (float)v[k];
    if (kind == SSFR_FOAM) foam->lifetime[i] -= (float)w->dt;
    const bool dead = (kind == SSFR_FOAM && !(foam->lifetime[i] > 0)) || is_outside(w->domain, at);
    foam->kind[i] = dead ? DEAD : kind;
}

ssfr_result ssfr_foam_step(ssfr_foam *foam, const ssfr_fluid *fluid, double dt, int n_obstacles,
                           const ssfr_obstacle *obstacles)
{
    ssfr_result result = SSFR_OK;
    walls w;
    if (!(dt >= 0 && isfinite(dt))) return ssfr_fail(SSFR_ERR_VALUE, "foam: time step %g s: expected one from 0", dt);
    SSFR_TRY(find_walls(&w, &foam->domain, SSFR_SUPPORT * fluid->radius, dt, n_obstacles, obstacles));
    if (dt == 0) goto end;
    SSFR_TRY(sort_fluid(&foam->flow, fluid));
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t i = 0; i < foam->n; i++) move(foam, &w, i);
    sweep(foam);
    SSFR_TRY(emit(foam, fluid, &w));
    foam->steps++;
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
    uint64_t magic; /* says the byte order too */
    uint64_t steps, births, n;
} header;

#define MAGIC UINT64_C(0x3130204d414f4653) /* "SFOAM 01" */

ssfr_result ssfr_foam_write(const ssfr_foam *foam, FILE *file)
{
    const header h = {MAGIC, foam->steps, foam->births, foam->n};
    bool ok = fwrite(&h, sizeof h, 1, file) == 1;
#define X(name, type, count) ok = ok && (foam->n == 0 || fwrite(foam->name, (count) * sizeof(type), foam->n, file) == foam->n);
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
        return ssfr_fail(SSFR_ERR_FORMAT, "state of foam: the file ends before its %zu bytes of header", sizeof *h);
    if (h->magic != MAGIC)
        return ssfr_fail(SSFR_ERR_FORMAT, "state of foam: begins with 0x%jx, not with SFOAM 01", (uintmax_t)h->magic);
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
        bool ok = foam->kind[i] < DEAD && foam->id[i] < foam->births && isfinite(foam->lifetime[i]);
        for (size_t k = 0; k < 3; k++)
            ok = ok && isfinite(foam->position[3 * i + k]) && isfinite(foam->velocity[3 * i + k]);
        if (!ok) return ssfr_fail(SSFR_ERR_FORMAT, "state of foam: particle %zu (from 0) holds what cannot be", i);
    }
    return SSFR_OK;
}

ssfr_result ssfr_foam_read(ssfr_foam *foam, FILE *file)
{
    ssfr_result result = SSFR_OK;
    header h;
    bool ok = true;
    SSFR_TRY(read_header(file, &h));
    foam->n = 0;
    SSFR_TRY(reserve(foam, (size_t)h.n));
#define X(name, type, count) ok = ok && (h.n == 0 || fread(foam->name, (count) * sizeof(type), (size_t)h.n, file) == h.n);
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

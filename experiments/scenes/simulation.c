/* SPDX-License-Identifier: GPL-3.0-or-later */
/* simulation.c: steps from frame to frame: emitters feed, sinks drain, solids move, the solver and its foam follow. */
#include "experiments/scenes/simulation.h"
#include "experiments/interrupt.h"

#include <inttypes.h>

static const double shortest_step = 1e-4; /* of max_step: where less is needed, the simulation has blown up */
static const double foam_radius = 0.25;   /* of the fluid's: what diffuse particles are drawn with */
static const double stray = 0.02;         /* of the spacing: how far emitted particles are off their lattice */
static const double room = 0.5;           /* of the spacing: where a particle is as near as that, none is emitted */
static const double mouth_time = 1e-4;    /* s, in which the speed of a moving emitter is measured */

struct ssfr_simulation {
    const ssfr_description *d;
    uint64_t seed;
    ssfr_solver *solver;
    ssfr_foam *foam; /* NULL for none */
    ssfr_obstacle *obstacles;
    double spacing;  /* m, of particles at rest on a cubic lattice */
    double time;     /* s; negative during the time of rest */
    int32_t frame;
    int64_t steps;
    uint64_t *emitted; /* layers, an emitter */
};

/* ---- making ------------------------------------------------------------------------------------------------------ */

static ssfr_result fill(ssfr_simulation *s)
{
    ssfr_result result = SSFR_OK;
    size_t n = 0;
    double *positions = NULL;
    float *velocities = NULL;
    SSFR_TRY(ssfr_description_fill(s->d, &n, &positions, &velocities));
    SSFR_TRY(ssfr_solver_add(s->solver, n, positions, velocities));
end:
    free(positions);
    free(velocities);
    return result;
}

ssfr_result ssfr_simulation_create(ssfr_simulation **out, const ssfr_description *description, uint64_t seed)
{
    ssfr_result result = SSFR_OK;
    ssfr_simulation *s = NULL;
    const ssfr_description *d = description;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&s, 1, sizeof *s, "a simulation"));
    s->d = d;
    s->seed = seed;
    s->frame = -1 - (int)ceil(d->rest_time * d->frame_rate - 1e-9);
    s->time = -d->rest_time;
    s->spacing = 2 * d->solver.radius * cbrt(SSFR_VOLUME_SHARE);
    SSFR_TRY(ssfr_alloc(&s->obstacles, (size_t)d->n_bodies, sizeof *s->obstacles, "obstacles"));
    SSFR_TRY(ssfr_alloc(&s->emitted, (size_t)d->n_emitters, sizeof *s->emitted, "counts of emitters"));
    SSFR_TRY(ssfr_solver_create(&s->solver, &d->solver));
    if (d->has_foam) {
        SSFR_TRY(ssfr_foam_create(&s->foam, &d->foam, d->solver.gravity, seed));
        ssfr_foam_bound(s->foam, d->solver.lo, d->solver.hi, d->solver.open);
    }
    SSFR_TRY(fill(s));
    *out = s;
    s = NULL;
end:
    ssfr_simulation_destroy(&s);
    return result;
}

void ssfr_simulation_destroy(ssfr_simulation **simulation)
{
    ssfr_simulation *s = *simulation;
    if (s) {
        ssfr_solver_destroy(&s->solver);
        ssfr_foam_destroy(&s->foam);
        free(s->obstacles);
        free(s->emitted);
    }
    free(s);
    *simulation = NULL;
}

/* Solids stand still during the time of rest. */
static void move_solids(ssfr_simulation *s, double from, double to)
{
    for (int i = 0; i < s->d->n_bodies; i++) {
        const ssfr_body *body = &s->d->bodies[i];
        s->obstacles[i] = (ssfr_obstacle){.before = ssfr_body_at(s->d, body, fmax(from, 0)),
                                          .now = ssfr_body_at(s->d, body, fmax(to, 0)),
                                          .friction = body->friction};
    }
}

/* ---- emitters ---------------------------------------------------------------------------------------------------- */

/* Particles to be added in a step. */
typedef struct batch {
    size_t n, capacity;
    double *positions;
    float *velocities;
} batch;

static ssfr_result grow(batch *b)
{
    const size_t capacity = b->capacity ? 2 * b->capacity : 1024;
    double *positions = realloc(b->positions, capacity * 3 * sizeof *positions);
    if (positions) b->positions = positions;
    float *velocities = positions ? realloc(b->velocities, capacity * 3 * sizeof *velocities) : NULL;
    if (!velocities) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %zu emitted particles", capacity);
    b->velocities = velocities;
    b->capacity = capacity;
    return SSFR_OK;
}

/* A number in [-1, 1) that depends on nothing but what is given. */
static double random_at(uint64_t a, uint64_t b)
{
    return 2 * ldexp((double)(ssfr_mix_bits(a * UINT64_C(0x9e3779b97f4a7c15) + b) >> 11), -53) - 1;
}

/* In the domain, and in no solid. */
static bool is_open(const ssfr_simulation *s, const double at[3])
{
    const ssfr_solver_setup *setup = &s->d->solver;
    bool open = true;
    double normal[3];
    for (int k = 0; k < 3; k++) open = open && at[k] >= setup->lo[k] && at[k] <= setup->hi[k];
    for (int i = 0; i < s->d->n_bodies && open; i++) open = ssfr_solid_distance(&s->obstacles[i].now, at, normal) >= 0;
    return open;
}

static bool has_room(const ssfr_fluid *fluid, const double at[3], double distance)
{
    ssfr_grid_range ranges[SSFR_GRID_ROWS];
    const uint32_t *order = fluid->n ? ssfr_grid_order(fluid->grid) : NULL;
    float local[3];
    bool free_of_others = true;
    for (int k = 0; k < 3; k++) local[k] = (float)(at[k] - fluid->origin[k]);
    const int n = fluid->n ? ssfr_grid_near(fluid->grid, local, ranges) : 0;
    for (int r = 0; r < n; r++)
        for (uint32_t i = ranges[r].begin; i < ranges[r].end && free_of_others; i++) {
            const float *p = fluid->position + 3 * (size_t)order[i];
            const double d[3] = {(double)p[0] - (double)local[0], (double)p[1] - (double)local[1],
                                 (double)p[2] - (double)local[2]};
            free_of_others = ssfr_dot(d, d) >= ssfr_square(distance);
        }
    return free_of_others;
}

/* A layer that left the mouth: where it is now. */
typedef struct layer {
    ssfr_emitter mouth;  /* when it left */
    double velocity[3];  /* m/s */
    double way;          /* m, gone since */
    uint64_t key;        /* of its random numbers */
} layer;

static layer layer_of(const ssfr_simulation *s, int emitter, uint64_t number, double born, double now)
{
    const ssfr_emitter *e = &s->d->emitters[emitter];
    const ssfr_emitter before = ssfr_emitter_at(s->d, e, born - mouth_time);
    layer l = {.mouth = ssfr_emitter_at(s->d, e, born), .way = e->speed * (now - born)};
    for (int k = 0; k < 3; k++) /* a hose that is moved adds its own speed */
        l.velocity[k] = e->speed * l.mouth.direction[k] + (l.mouth.centre[k] - before.centre[k]) / mouth_time;
    l.key = s->seed ^ ((uint64_t)emitter << 48) ^ (number << 20);
    return l;
}

/* A square lattice of particles as wide as at rest, centred in the mouth. */
static ssfr_result emit_layer(const ssfr_simulation *s, const ssfr_fluid *fluid, const layer *l, batch *b)
{
    ssfr_result result = SSFR_OK;
    const ssfr_emitter *mouth = &l->mouth;
    double side[3];
    int n[2];
    ssfr_cross(mouth->direction, mouth->up, side);
    for (int k = 0; k < 2; k++) n[k] = ssfr_max_int(1, (int)(2 * mouth->half[k] / s->spacing + 1e-9));
    for (int i = 0; i < n[0] * n[1]; i++) {
        const double x = s->spacing * (i % n[0] - 0.5 * (n[0] - 1)), y = s->spacing * (i / n[0] - 0.5 * (n[1] - 1));
        double at[3];
        if (mouth->disc && hypot(x, y) > mouth->half[0]) continue;
        const double dx = stray * s->spacing * random_at(l->key, 2 * (uint64_t)i);
        const double dy = stray * s->spacing * random_at(l->key, 2 * (uint64_t)i + 1);
        for (int k = 0; k < 3; k++)
            at[k] = mouth->centre[k] + (x + dx) * side[k] + (y + dy) * mouth->up[k] + l->way * mouth->direction[k];
        if (!is_open(s, at) || !has_room(fluid, at, room * s->spacing)) continue;
        if (b->n == b->capacity) SSFR_TRY(grow(b));
        for (size_t k = 0; k < 3; k++) {
            b->positions[3 * b->n + k] = at[k];
            b->velocities[3 * b->n + k] = (float)l->velocity[k];
        }
        b->n++;
    }
end:
    return result;
}

/* Layers leave a mouth one spacing apart, so that the stream has the density of rest. All that have left until now are
 * added, each as far on its way as it should be. */
static ssfr_result emit(ssfr_simulation *s)
{
    ssfr_result result = SSFR_OK;
    const ssfr_fluid fluid = ssfr_solver_fluid(s->solver);
    batch b = {0};
    for (int i = 0; i < s->d->n_emitters; i++) {
        const ssfr_emitter *e = &s->d->emitters[i];
        for (;;) {
            const double born = e->start + (double)s->emitted[i] * s->spacing / e->speed;
            if (born > s->time || born >= e->stop) break;
            const layer l = layer_of(s, i, s->emitted[i], born, s->time);
            SSFR_TRY(emit_layer(s, &fluid, &l, &b));
            s->emitted[i]++;
        }
    }
    if (b.n) SSFR_TRY(ssfr_solver_add(s->solver, b.n, b.positions, b.velocities));
end:
    free(b.positions);
    free(b.velocities);
    return result;
}

/* ---- steps ------------------------------------------------------------------------------------------------------- */

static void drain(ssfr_simulation *s)
{
    for (int i = 0; i < s->d->n_sinks; i++) {
        ssfr_solver_remove(s->solver, &s->d->sinks[i]);
        if (s->foam) ssfr_foam_remove(s->foam, &s->d->sinks[i]);
    }
}

/* The particle that asks for the shortest step. */
static size_t fastest(const ssfr_fluid *fluid)
{
    size_t found = 0;
    double most = -1;
    for (size_t i = 0; i < fluid->n; i++) {
        const float *v = fluid->velocity + 3 * i;
        const double speed = hypot(hypot((double)v[0], (double)v[1]), (double)v[2]);
        if (!(speed <= most)) found = i, most = isnan(speed) ? INFINITY : speed;
    }
    return found;
}

static ssfr_result fail_blown_up(const ssfr_simulation *s, double limit)
{
    const ssfr_fluid fluid = ssfr_solver_fluid(s->solver);
    const size_t i = fastest(&fluid);
    const float *v = fluid.velocity + 3 * i;
    return ssfr_fail(SSFR_ERR_VALUE, "particle %u has a velocity of (%g, %g, %g) m/s: steps of %g s would be needed",
                     ssfr_solver_id(s->solver, i), (double)v[0], (double)v[1], (double)v[2], limit);
}

/* m/s, of the emitters that are open before `to`. */
static double emitters_speed(const ssfr_simulation *s, double to)
{
    double speed = 0;
    for (int i = 0; i < s->d->n_emitters; i++) {
        const ssfr_emitter *e = &s->d->emitters[i];
        if (e->start < to && e->stop > s->time) speed = fmax(speed, e->speed);
    }
    return speed;
}

/* m, the longest way of a corner of the box around a solid; of its centre, where it has no end. */
static double solids_way(const ssfr_simulation *s)
{
    double longest = 0;
    for (int i = 0; i < s->d->n_bodies; i++) {
        const ssfr_obstacle *o = &s->obstacles[i];
        double lo[3], hi[3], at[3], way[3];
        ssfr_solid_bounds(&o->now, lo, hi);
        for (int corner = 0; corner < 8; corner++) {
            for (int k = 0; k < 3; k++) {
                at[k] = corner >> k & 1 ? hi[k] : lo[k];
                if (!isfinite(at[k])) at[k] = o->now.centre[k];
            }
            ssfr_obstacle_motion(o, at, way);
            longest = fmax(longest, sqrt(ssfr_dot(way, way)));
        }
    }
    return longest;
}

/* As long as allowed, and so that the last step before `end` is no shorter than the others. What flows out of emitters
 * and solids keep to the same condition as the fluid does. */
static ssfr_result choose_step(ssfr_simulation *s, double end, double *dt)
{
    const ssfr_solver_setup *setup = &s->d->solver;
    const double left = end - s->time, way = setup->params.cfl * setup->radius;
    const double fluid = ssfr_solver_limit(s->solver), first = fmin(fluid, left);
    move_solids(s, s->time, s->time + first);
    const double others = fmin(way / fmax(emitters_speed(s, s->time + first), 1e-300),
                               first * way / fmax(solids_way(s), 1e-300));
    const double limit = fmin(fluid, others), shortest = shortest_step * setup->params.max_step;
    if (!(fluid >= shortest)) return fail_blown_up(s, fluid);
    if (!(limit >= fmin(shortest, left)))
        return ssfr_fail(SSFR_ERR_VALUE, "an emitter or a solid is so fast that steps of %g s would be needed", limit);
    *dt = left / ceil(left / limit);
    return SSFR_OK;
}

static ssfr_result step(ssfr_simulation *s, double end)
{
    ssfr_result result = SSFR_OK;
    double dt = 0;
    move_solids(s, s->time, s->time);
    SSFR_TRY(emit(s));
    drain(s);
    SSFR_TRY(choose_step(s, end, &dt));
    const double to = end - s->time <= dt ? end : s->time + dt;
    move_solids(s, s->time, to);
    SSFR_TRY(ssfr_solver_step(s->solver, dt, s->d->n_bodies, s->obstacles));
    s->time = to;
    s->steps++;
    if (s->foam && s->frame >= 0) { /* what settles at rest makes none */
        const ssfr_fluid fluid = ssfr_solver_fluid(s->solver);
        SSFR_TRY(ssfr_foam_step(s->foam, &fluid, dt, s->d->n_bodies, s->obstacles));
    }
end:
    return result;
}

ssfr_result ssfr_simulation_advance(ssfr_simulation *simulation)
{
    ssfr_result result = SSFR_OK;
    ssfr_simulation *s = simulation;
    const double end = fmax((s->frame + 1) / s->d->frame_rate, -s->d->rest_time);
    while (s->time < end) {
        if (ssfr_interrupt_came()) {
            result = ssfr_fail(SSFR_ERR_IO, "interrupted; the frames before it stay");
            goto end;
        }
        SSFR_TRY(step(s, end));
    }
    s->frame++;
end:
    return result;
}

int ssfr_simulation_frame(const ssfr_simulation *simulation)
{
    return simulation->frame;
}

long ssfr_simulation_steps(const ssfr_simulation *simulation)
{
    return (long)simulation->steps;
}

ssfr_result ssfr_simulation_export(const ssfr_simulation *simulation, ssfr_particles **fluid, ssfr_particles **foam)
{
    ssfr_result result = SSFR_OK;
    *fluid = *foam = NULL;
    SSFR_TRY(ssfr_solver_export(simulation->solver, fluid));
    if (simulation->foam)
        SSFR_TRY(ssfr_foam_export(simulation->foam, foam_radius * simulation->d->solver.radius, foam));
end:
    if (result != SSFR_OK) ssfr_particles_destroy(fluid);
    return result;
}

/* ---- the state --------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_simulation_write(const ssfr_simulation *simulation, FILE *file)
{
    ssfr_result result = SSFR_OK;
    const ssfr_simulation *s = simulation;
    const size_t n = (size_t)s->d->n_emitters;
    const bool ok = fwrite(&s->frame, sizeof s->frame, 1, file) == 1 &&
                    fwrite(&s->steps, sizeof s->steps, 1, file) == 1 &&
                    fwrite(&s->time, sizeof s->time, 1, file) == 1 &&
                    fwrite(s->emitted, sizeof *s->emitted, n, file) == n;
    if (!ok) return ssfr_fail(SSFR_ERR_IO, "cannot write the state of a simulation");
    SSFR_TRY(ssfr_solver_write(s->solver, file));
    if (s->foam) SSFR_TRY(ssfr_foam_write(s->foam, file));
end:
    return result;
}

ssfr_result ssfr_simulation_read(ssfr_simulation *simulation, FILE *file)
{
    ssfr_result result = SSFR_OK;
    ssfr_simulation *s = simulation;
    const size_t n = (size_t)s->d->n_emitters;
    const bool ok = fread(&s->frame, sizeof s->frame, 1, file) == 1 &&
                    fread(&s->steps, sizeof s->steps, 1, file) == 1 &&
                    fread(&s->time, sizeof s->time, 1, file) == 1 &&
                    fread(s->emitted, sizeof *s->emitted, n, file) == n;
    if (!ok) return ssfr_fail(SSFR_ERR_FORMAT, "the state of a simulation ends too early");
    SSFR_TRY(ssfr_solver_read(s->solver, file));
    if (s->foam) SSFR_TRY(ssfr_foam_read(s->foam, file));
end:
    return result;
}

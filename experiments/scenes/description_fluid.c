/* SPDX-License-Identifier: GPL-3.0-or-later */
/* description_fluid.c: reading where fluid is at the start, where it comes from and where it goes. */
#include "experiments/scenes/description_read.h"

static const double slack = 1e-9; /* m, by which boxes may miss each other by rounding */

#define SPEED .unit = "m/s", .min = -SSFR_MAX_SPEED, .max = SSFR_MAX_SPEED

static ssfr_result check_box(const ssfr_yaml_node *node, const double lo[3], const double hi[3])
{
    for (int k = 0; k < 3; k++)
        if (!(lo[k] < hi[k]))
            return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE, "%.80s: lo %g m is not below hi %g m along %c",
                                  node->name, lo[k], hi[k], "xyz"[k]);
    return SSFR_OK;
}

/* ---- pools ------------------------------------------------------------------------------------------------------- */

static ssfr_result check_pool(const ssfr_reading *r, const ssfr_yaml_node *node, const ssfr_pool *pool)
{
    const ssfr_solver_setup *s = &r->d.solver;
    const double places = ssfr_description_places(pool, ssfr_description_spacing(&r->d));
    for (int k = 0; k < 3; k++)
        if (pool->lo[k] < s->lo[k] - slack || pool->hi[k] > s->hi[k] + slack)
            return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE,
                                  "%.80s: from %g to %g m along %c, the domain goes from %g to %g m",
                                  node->name, pool->lo[k], pool->hi[k], "xyz"[k], s->lo[k], s->hi[k]);
    if (places > SSFR_MAX_FLUID)
        return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE, "%.80s: room for %.4g particles of radius %g m, at most %d",
                              node->name, places, s->radius, SSFR_MAX_FLUID);
    for (const ssfr_pool *other = r->d.pools; other < pool; other++) {
        bool overlap = true;
        for (int k = 0; k < 3; k++)
            overlap &= pool->lo[k] < other->hi[k] - slack && pool->hi[k] > other->lo[k] + slack;
        if (overlap)
            return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE, "%.80s: overlaps %.80s", node->name, other->name);
    }
    return SSFR_OK;
}

/* At full scale, whichever is read: at the other the lattice has another number of places. */
static ssfr_result check_count(const ssfr_reading *r, const ssfr_yaml_node *node, const ssfr_pool *pool)
{
    const double places = ssfr_description_places(pool, r->spacing);
    if (!((double)pool->count > places)) return SSFR_OK;
    return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE, "%.80s: count: %zu, but there is room for %.0f at full scale",
                          node->name, pool->count, places);
}

static ssfr_result read_pool(ssfr_reading *r, const ssfr_yaml_node *node, ssfr_pool *pool)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("lo", ssfr_yaml_read_real3, ssfr_pool, lo, .needed = true, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("hi", ssfr_yaml_read_real3, ssfr_pool, hi, .needed = true, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("velocity", ssfr_yaml_read_real3, ssfr_pool, velocity, SPEED),
        SSFR_YAML_ROW("count", ssfr_yaml_read_count, ssfr_pool, count, .min = 1, .max = SSFR_MAX_FLUID),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_yaml_copy(&pool->name, "", node->name));
    SSFR_TRY(ssfr_yaml_read_map(node, rows, pool));
    SSFR_TRY(check_box(node, pool->lo, pool->hi));
    SSFR_TRY(check_pool(r, node, pool));
    SSFR_TRY(check_count(r, node, pool));
end:
    return result;
}

ssfr_result ssfr_reading_pools(ssfr_reading *r)
{
    ssfr_result result = SSFR_OK;
    size_t total = 0;
    SSFR_TRY(ssfr_reading_make(r->pools, SSFR_YAML_MAP, sizeof *r->d.pools, &r->d.pools, &r->d.n_pools));
    for (int i = 0; i < r->d.n_pools; i++) {
        ssfr_pool *pool = &r->d.pools[i];
        SSFR_TRY(read_pool(r, r->pools->values[i], pool));
        total += pool->count;
        if (total > r->particles)
            return ssfr_yaml_fail(r->pools->keys[i], SSFR_ERR_VALUE, "%.80s: pools of %zu particles, the scene has %zu",
                                  pool->name, total, r->particles);
        if (pool->count > 0 && r->d.scale == SSFR_SCALE_QUICK)
            pool->count = pool->count < SSFR_QUICK_SHARE ? 1 : (pool->count + SSFR_QUICK_SHARE / 2) / SSFR_QUICK_SHARE;
    }
end:
    return result;
}

/* ---- emitters ---------------------------------------------------------------------------------------------------- */

typedef struct entry { /* an emitter as it is written */
    ssfr_emitter e;
    double up[3];
    double radius, size[2]; /* m; 0 when not given */
    const ssfr_yaml_node *motion;
} entry;

/* The up given, but for what of it lies along the direction. */
static bool find_up(const entry *in, double up[3])
{
    const double along = ssfr_dot(in->up, in->e.direction);
    for (int k = 0; k < 3; k++) up[k] = in->up[k] - along * in->e.direction[k];
    return ssfr_normalize(up) > SSFR_MIN_LENGTH;
}

/* Vertical streams have the horizon's -z as their up. */
static void default_up(entry *in)
{
    const bool given = ssfr_dot(in->up, in->up) > 0, upright = fabs(in->e.direction[1]) > 1 - SSFR_MIN_LENGTH;
    if (!given) in->up[upright ? 2 : 1] = upright ? -1 : 1;
}

/* Places in the mouth. */
static double count_mouth(const ssfr_reading *r, const entry *in)
{
    const double spacing = ssfr_description_spacing(&r->d);
    double n = 1;
    for (int k = 0; k < 2; k++) n *= fmax((in->radius > 0 ? 2 * in->radius : in->size[k]) / spacing, 1);
    return n;
}

static ssfr_result check_emitter(const ssfr_reading *r, const ssfr_yaml_node *node, const entry *in)
{
    const ssfr_solver_setup *s = &r->d.solver;
    const ssfr_emitter *e = &in->e;
    const ssfr_emitter there = ssfr_emitter_at(&r->d, e, e->start);
    if ((in->radius > 0) == (in->size[0] > 0))
        return ssfr_yaml_fail(node->key, SSFR_ERR_FORMAT, "%.80s: either radius or size must be given", node->name);
    if (count_mouth(r, in) > SSFR_MAX_FLUID)
        return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE, "%.80s: room for %.4g particles of radius %g m, at most %d",
                              node->name, count_mouth(r, in), s->radius, SSFR_MAX_FLUID);
    if (!(e->stop > e->start))
        return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE, "%.80s: stops at %g s, starts at %g s", node->name, e->stop,
                              e->start);
    for (int k = 0; k < 3; k++)
        if (!(there.centre[k] >= s->lo[k] && there.centre[k] <= s->hi[k]))
            return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE,
                                  "%.80s: starts at %g m along %c, the domain goes from %g to %g m",
                                  node->name, there.centre[k], "xyz"[k], s->lo[k], s->hi[k]);
    return SSFR_OK;
}

static ssfr_result read_emitter(const ssfr_reading *r, const ssfr_yaml_node *node, ssfr_emitter *out)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("centre", ssfr_yaml_read_real3, entry, e.centre, .needed = true, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("direction", ssfr_reading_direction, entry, e.direction, .needed = true),
        SSFR_YAML_ROW("up", ssfr_reading_direction, entry, up),
        SSFR_YAML_ROW("radius", ssfr_yaml_read_real, entry, radius, SSFR_RANGE_LENGTH),
        SSFR_YAML_ROW("size", ssfr_yaml_read_real2, entry, size, SSFR_RANGE_LENGTH),
        SSFR_YAML_ROW("speed", ssfr_yaml_read_real, entry, e.speed, .needed = true, .unit = "m/s", .min = 1e-3,
                      .max = SSFR_MAX_SPEED),
        SSFR_YAML_ROW("start", ssfr_yaml_read_real, entry, e.start, SSFR_RANGE_TIME),
        SSFR_YAML_ROW("stop", ssfr_yaml_read_real, entry, e.stop, SSFR_RANGE_TIME),
        SSFR_YAML_ROW("motion", ssfr_yaml_read_node, entry, motion),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    entry in = {.e.stop = INFINITY};
    SSFR_TRY(ssfr_yaml_read_map(node, rows, &in));
    SSFR_TRY(ssfr_reading_find_motion(r, in.motion, &in.e.motion));
    default_up(&in);
    if (!find_up(&in, in.e.up))
        return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE, "%.80s: up is along the direction", node->name);
    SSFR_TRY(check_emitter(r, node, &in));
    in.e.disc = in.radius > 0;
    for (int k = 0; k < 2; k++) in.e.half[k] = in.e.disc ? in.radius : in.size[k] / 2;
    *out = in.e;
end:
    return result;
}

ssfr_result ssfr_reading_emitters(ssfr_reading *r)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_reading_make(r->emitters, SSFR_YAML_MAP, sizeof *r->d.emitters, &r->d.emitters, &r->d.n_emitters));
    for (int i = 0; i < r->d.n_emitters; i++) SSFR_TRY(read_emitter(r, r->emitters->values[i], &r->d.emitters[i]));
end:
    return result;
}

/* ---- sinks ------------------------------------------------------------------------------------------------------- */

static ssfr_result read_sink(const ssfr_yaml_node *node, ssfr_solid *out)
{
    typedef struct box {
        double lo[3], hi[3];
    } box;
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("lo", ssfr_yaml_read_real3, box, lo, .needed = true, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("hi", ssfr_yaml_read_real3, box, hi, .needed = true, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    box b = {0};
    SSFR_TRY(ssfr_yaml_read_map(node, rows, &b));
    SSFR_TRY(check_box(node, b.lo, b.hi));
    *out = (ssfr_solid){.shape = SSFR_BOX, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int k = 0; k < 3; k++) {
        out->centre[k] = ssfr_mix(b.lo[k], b.hi[k], 0.5);
        out->half[k] = (b.hi[k] - b.lo[k]) / 2;
    }
end:
    return result;
}

ssfr_result ssfr_reading_sinks(ssfr_reading *r)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_reading_make(r->sinks, SSFR_YAML_MAP, sizeof *r->d.sinks, &r->d.sinks, &r->d.n_sinks));
    for (int i = 0; i < r->d.n_sinks; i++) SSFR_TRY(read_sink(r->sinks->values[i], &r->d.sinks[i]));
end:
    return result;
}

/* ---- room -------------------------------------------------------------------------------------------------------- */

/* A look at no more than this many places along each axis, for scenes without pools: is one off all solids? */
static ssfr_result check_domain(const ssfr_reading *r)
{
    static const double most = 32;
    ssfr_result result = SSFR_OK;
    const ssfr_solver_setup *s = &r->d.solver;
    double spacing[3];
    bool room = false;
    for (int k = 0; k < 3; k++)
        spacing[k] = fmax(ssfr_description_spacing(&r->d), (s->hi[k] - s->lo[k]) / most);
    SSFR_TRY(ssfr_description_has_room(&r->d, s->lo, s->hi, spacing, &room));
    if (!room)
        result = ssfr_yaml_fail(r->domain->key, SSFR_ERR_VALUE, "domain: the solids leave no room in it");
end:
    return result;
}

ssfr_result ssfr_reading_check_room(const ssfr_reading *r)
{
    ssfr_result result = SSFR_OK;
    const double gap = ssfr_description_spacing(&r->d), spacing[3] = {gap, gap, gap};
    if (r->d.n_pools + r->d.n_emitters == 0)
        return ssfr_yaml_fail(r->domain->key, SSFR_ERR_FORMAT, "the scene has neither fluid nor emitters");
    for (int i = 0; i < r->d.n_pools; i++) {
        const ssfr_pool *pool = &r->d.pools[i];
        bool room = false;
        SSFR_TRY(ssfr_description_has_room(&r->d, pool->lo, pool->hi, spacing, &room));
        if (!room)
            return ssfr_yaml_fail(r->pools->keys[i], SSFR_ERR_VALUE,
                                  "%.80s: no room for a particle of radius %g m in it", pool->name, r->d.solver.radius);
    }
    if (r->d.n_pools == 0) SSFR_TRY(check_domain(r));
end:
    return result;
}

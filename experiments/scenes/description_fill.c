/* SPDX-License-Identifier: GPL-3.0-or-later */
/* description_fill.c: filling pools with particles on lattices, from below, around solids. */
#include "experiments/scenes/description_read.h"

static const double hit = 1e-9; /* spacings by which a pool may be too narrow for its last place */

/* ---- solids at the start ----------------------------------------------------------------------------------------- */

typedef struct statics {
    int n;
    double radius; /* m, of particles: how far they keep off */
    struct item {
        ssfr_solid solid;
        double lo[3], hi[3]; /* m: beyond, it is out of reach */
    } *items;
} statics;

static ssfr_result init_statics(statics *s, const ssfr_description *d)
{
    const ssfr_result result = ssfr_alloc(&s->items, (size_t)d->n_bodies, sizeof *s->items, "solids");
    s->n = result == SSFR_OK ? d->n_bodies : 0;
    s->radius = d->solver.radius;
    for (int i = 0; i < s->n; i++) {
        struct item *item = &s->items[i];
        item->solid = ssfr_body_at(d, &d->bodies[i], 0);
        ssfr_solid_bounds(&item->solid, item->lo, item->hi);
        for (int k = 0; k < 3; k++) item->lo[k] -= s->radius, item->hi[k] += s->radius;
    }
    return result;
}

static bool is_free(const statics *s, const double at[3])
{
    bool ok = true;
    for (int i = 0; i < s->n && ok; i++) {
        const struct item *item = &s->items[i];
        double normal[3];
        bool near = true;
        for (int k = 0; k < 3; k++) near &= at[k] > item->lo[k] && at[k] < item->hi[k];
        ok = !near || ssfr_solid_distance(&item->solid, at, normal) >= s->radius * (1 - hit);
    }
    return ok;
}

/* ---- lattices ---------------------------------------------------------------------------------------------------- */

typedef struct lattice {
    double first[3];   /* m, world */
    double spacing[3]; /* m */
    size_t n[3];
} lattice;

/* Whole spacings that fit in a width. */
static double count_places(double width, double spacing)
{
    return floor(width / spacing + hit);
}

double ssfr_description_places(const ssfr_pool *pool, double spacing)
{
    double n = 1;
    for (int k = 0; k < 3; k++) n *= count_places(pool->hi[k] - pool->lo[k], spacing);
    return n;
}

/* On the pool's bottom, and in its middle sideways, so that what is symmetric stays so. */
static lattice make_lattice(const double lo[3], const double hi[3], const double spacing[3])
{
    lattice l;
    for (int k = 0; k < 3; k++) {
        const double width = hi[k] - lo[k], n = count_places(width, spacing[k]);
        l.spacing[k] = spacing[k];
        l.n[k] = (size_t)n;
        l.first[k] = lo[k] + (k == 1 ? 0 : (width - n * spacing[k]) / 2) + spacing[k] / 2;
    }
    return l;
}

static void place_at(const lattice *l, size_t layer, size_t i, double out[3])
{
    const size_t cell[3] = {i % l->n[0], layer, i / l->n[0]};
    for (int k = 0; k < 3; k++) out[k] = l->first[k] + (double)cell[k] * l->spacing[k];
}

/* Appends at most `most` particles to positions; layer by layer, each looked at by all threads at once. */
static ssfr_result fill_lattice(const lattice *l, const statics *s, size_t most, double *positions, size_t *n)
{
    ssfr_result result = SSFR_OK;
    bool *keep = NULL;
    const size_t layer_size = l->n[0] * l->n[2];
    *n = 0;
    SSFR_TRY(ssfr_alloc(&keep, layer_size, sizeof *keep, "a layer of places"));
    for (size_t layer = 0; layer < l->n[1] && *n < most; layer++) {
#pragma omp parallel for schedule(dynamic, 256)
        for (size_t i = 0; i < layer_size; i++) {
            double at[3];
            place_at(l, layer, i, at);
            keep[i] = is_free(s, at);
        }
        for (size_t i = 0; i < layer_size && *n < most; i++)
            if (keep[i]) place_at(l, layer, i, positions + 3 * (*n)++);
    }
end:
    free(keep);
    return result;
}

ssfr_result ssfr_description_has_room(const ssfr_description *d, const double lo[3], const double hi[3],
                                      const double spacing[3], bool *out)
{
    ssfr_result result = SSFR_OK;
    statics s = {0};
    const lattice l = make_lattice(lo, hi, spacing);
    double at[3];
    size_t n = 0;
    SSFR_TRY(init_statics(&s, d));
    SSFR_TRY(fill_lattice(&l, &s, 1, at, &n));
    *out = n == 1;
end:
    free(s.items);
    return result;
}

static size_t most_of(const ssfr_description *d, const ssfr_pool *pool, size_t left)
{
    const double places = ssfr_description_places(pool, ssfr_description_spacing(d));
    size_t most = places < (double)left ? (size_t)places : left;
    return pool->count > 0 && pool->count < most ? pool->count : most;
}

ssfr_result ssfr_description_fill(const ssfr_description *d, size_t *n, double **positions, float **velocities)
{
    ssfr_result result = SSFR_OK;
    statics s = {0};
    const double gap = ssfr_description_spacing(d), spacing[3] = {gap, gap, gap};
    size_t most = 0;
    *n = 0;
    *positions = NULL;
    *velocities = NULL;
    for (int i = 0; i < d->n_pools; i++) most += most_of(d, &d->pools[i], d->solver.max_particles - most);
    SSFR_TRY(ssfr_alloc(positions, most, 3 * sizeof **positions, "positions"));
    SSFR_TRY(ssfr_alloc(velocities, most, 3 * sizeof **velocities, "velocities"));
    SSFR_TRY(init_statics(&s, d));
    for (int i = 0; i < d->n_pools; i++) {
        const ssfr_pool *pool = &d->pools[i];
        const lattice l = make_lattice(pool->lo, pool->hi, spacing);
        const size_t wanted = most_of(d, pool, most - *n);
        size_t added = 0;
        SSFR_TRY(fill_lattice(&l, &s, wanted, *positions + 3 * *n, &added));
        for (size_t j = 3 * *n; j < 3 * (*n + added); j++) (*velocities)[j] = (float)pool->velocity[j % 3];
        *n += added;
        if (pool->count > 0 && added < wanted && d->scale == SSFR_SCALE_FULL) /* quick's wide lattice loses a few */
            ssfr_log(SSFR_WARNING, "%s: %s: solids leave room for %zu of its %zu particles", d->name, pool->name,
                     added, wanted);
    }
end:
    if (result != SSFR_OK) {
        free(*positions);
        free(*velocities);
        *positions = NULL;
        *velocities = NULL;
    }
    free(s.items);
    return result;
}

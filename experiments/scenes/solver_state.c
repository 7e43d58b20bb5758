/* SPDX-License-Identifier: GPL-3.0-or-later */
/* solver_state.c: the solver's particles: adding, removing, sorting, packing, writing and reading. */
#include "experiments/hash.h"
#include "experiments/scenes/solver_internal.h"

#include "base/param.h"

#include <sys/stat.h>

/* ---- memory ------------------------------------------------------------------------------------------------------ */

/* An array of `size` bytes an item with room for n, that keeps the first n_kept. */
static ssfr_result grow(void *array, size_t n_kept, size_t n, size_t size)
{
    ssfr_result result = SSFR_OK;
    void *before, *after = NULL;
    memcpy(&before, array, sizeof before);
    SSFR_TRY(ssfr_alloc(&after, n, size, "particles"));
    if (before) memcpy(after, before, n_kept * size);
    memcpy(array, &after, sizeof after);
    free(before);
end:
    return result;
}

ssfr_result ssfr_solver_reserve(ssfr_solver *solver, size_t n)
{
    ssfr_result result = SSFR_OK;
    ssfr_solver *s = solver;
    if (s->x && n <= s->capacity) return SSFR_OK;
    size_t room = n + n / 8;
    if (room > s->setup.max_particles) room = s->setup.max_particles;
    ssfr_lanes **const lanes[] = {&s->x, &s->at, &s->from, &s->moved, &s->v};
    for (size_t a = 0; a < SSFR_COUNT(lanes); a++)
        SSFR_TRY(grow(lanes[a], s->n, room + SSFR_LANES, sizeof **lanes[a]));
    for (int k = 0; k < 3; k++) SSFR_TRY(grow(&s->axes[k], 0, room + SSFR_LANES, sizeof *s->axes[k]));
    SSFR_TRY(grow(&s->labels, s->n, room, sizeof *s->labels));
    SSFR_TRY(grow(&s->spare_labels, 0, room, sizeof *s->labels));
    SSFR_TRY(grow(&s->position, 3 * s->n, 3 * room, sizeof *s->position));
    SSFR_TRY(grow(&s->velocity, 3 * s->n, 3 * room, sizeof *s->velocity));
    SSFR_TRY(grow(&s->density, s->n, room, sizeof *s->density));
    SSFR_TRY(grow(&s->neighbours, s->n, room, sizeof *s->neighbours));
    SSFR_TRY(grow(&s->list_begin, 0, room, sizeof *s->list_begin));
    SSFR_TRY(grow(&s->list_end, 0, room, sizeof *s->list_end));
    s->capacity = room;
end:
    return result;
}

size_t ssfr_solver_bytes(const ssfr_solver *solver)
{
    const ssfr_solver *s = solver;
    const size_t per_particle = 5 * sizeof *s->x + 2 * sizeof *s->labels + 9 * sizeof *s->position +
                                sizeof *s->density + sizeof *s->neighbours + sizeof *s->list_begin +
                                sizeof *s->list_end;
    return sizeof *s + s->capacity * per_particle + s->listed_capacity * sizeof *s->listed +
           s->contacts_capacity * sizeof *s->contacts + ssfr_grid_bytes(s->grid);
}

/* ---- order ------------------------------------------------------------------------------------------------------- */

void ssfr_solver_publish(ssfr_solver *solver)
{
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < solver->n; i++)
        for (size_t k = 0; k < 3; k++) {
            solver->position[3 * i + k] = solver->axes[k][i] = solver->x[i][k];
            solver->velocity[3 * i + k] = solver->v[i][k];
        }
}

static void sort(ssfr_solver *solver)
{
    const uint32_t *order = ssfr_grid_order(solver->grid);
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < solver->n; i++) {
        solver->at[i] = solver->x[order[i]];
        solver->moved[i] = solver->v[order[i]];
        solver->spare_labels[i] = solver->labels[order[i]];
    }
    ssfr_lanes *const x = solver->x, *const v = solver->v;
    ssfr_label *const labels = solver->labels;
    solver->x = solver->at, solver->at = x;
    solver->v = solver->moved, solver->moved = v;
    solver->labels = solver->spare_labels, solver->spare_labels = labels;
    ssfr_grid_settle(solver->grid);
}

/* Fills up lists: so far from everything that no kernel reaches it, near enough that squares of distances are
 * finite. */
static void place_filler(ssfr_solver *solver)
{
    const size_t n = solver->n;
    solver->x[n] = solver->at[n] = solver->from[n] = (ssfr_lanes){1e18f, 1e18f, 1e18f, 0};
    solver->moved[n] = solver->v[n] = (ssfr_lanes){0};
}

/* Outside of a step obstacles are not known. */
static ssfr_result find_walls(ssfr_solver *solver)
{
    memset(solver->moved, 0, solver->n * sizeof *solver->moved);
    return ssfr_solver_find_contacts(solver, false, 0, NULL);
}

ssfr_result ssfr_solver_sort(ssfr_solver *solver)
{
    ssfr_result result = SSFR_OK;
    ssfr_solver_publish(solver);
    SSFR_TRY(ssfr_grid_build(solver->grid, solver->n, solver->position, (double)solver->kernel.support));
    sort(solver);
    ssfr_solver_publish(solver);
    place_filler(solver);
    ssfr_solver_lap(solver, SSFR_SOLVER_SORT);
    SSFR_TRY(ssfr_solver_list(solver));
    ssfr_solver_lap(solver, SSFR_SOLVER_LIST);
end:
    return result;
}

ssfr_result ssfr_solver_arrange(ssfr_solver *solver)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_solver_sort(solver));
    if (solver->stale) SSFR_TRY(find_walls(solver));
    ssfr_solver_sum_density(solver);
    ssfr_solver_lap(solver, SSFR_SOLVER_DENSITY);
    solver->stale = false;
end:
    return result;
}

const double *ssfr_solver_seconds(const ssfr_solver *solver)
{
    return solver->seconds;
}

/* ---- adding and removing ----------------------------------------------------------------------------------------- */

ssfr_result ssfr_solver_add(ssfr_solver *solver, size_t n, const double *positions, const float *velocities)
{
    ssfr_result result = SSFR_OK;
    const size_t room = solver->setup.max_particles - solver->n;
    const size_t first = solver->n, n_added = n < room ? n : room;
    const double outside = (double)solver->kernel.support;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++)
            if (!isfinite(positions[3 * i + k]) || (velocities && !isfinite(velocities[3 * i + k])))
                return ssfr_fail(SSFR_ERR_VALUE, "particle %zu (from 0) to be added: position %g m, velocity %g m/s "
                                 "along %c", i, positions[3 * i + k], velocities ? (double)velocities[3 * i + k] : 0.0,
                                 "xyz"[k]);
    SSFR_TRY(ssfr_solver_reserve(solver, first + n_added));
    for (size_t i = 0; i < n_added; i++) {
        ssfr_lanes x = {0}, v = {0};
        for (size_t k = 0; k < 3; k++) {
            /* What is outside comes to a wall in the first step, or leaves: how far outside makes no difference. */
            x[k] = (float)ssfr_clamp(positions[3 * i + k] - solver->origin[k], solver->lo[k] - outside,
                                     solver->hi[k] + outside);
            v[k] = velocities ? velocities[3 * i + k] : 0;
        }
        solver->x[first + i] = x;
        solver->v[first + i] = v;
        solver->labels[first + i] = (ssfr_label){.birth = solver->time, .id = solver->next_id++};
    }
    solver->n += n_added;
    solver->stale = solver->stale || n_added > 0;
end:
    return result;
}

/* Removes the particles whose spare label has an id. */
static size_t drop_marked(ssfr_solver *solver)
{
    size_t kept = 0;
    for (size_t i = 0; i < solver->n; i++) {
        if (solver->spare_labels[i].id) continue;
        solver->x[kept] = solver->x[i];
        solver->v[kept] = solver->v[i];
        solver->labels[kept++] = solver->labels[i];
    }
    const size_t n_dropped = solver->n - kept;
    solver->n = kept;
    solver->stale = solver->stale || n_dropped;
    return n_dropped;
}

void ssfr_solver_drop_left(ssfr_solver *solver)
{
    const bool *open = solver->setup.open;
    for (size_t i = 0; i < solver->n; i++) {
        bool left = false;
        for (int k = 0; k < 3; k++)
            left = left || (open[2 * k] && (double)solver->x[i][k] < solver->lo[k]) ||
                   (open[2 * k + 1] && (double)solver->x[i][k] > solver->hi[k]);
        solver->spare_labels[i].id = left;
    }
    drop_marked(solver);
}

size_t ssfr_solver_remove(ssfr_solver *solver, const ssfr_solid *sink)
{
    const ssfr_solid local = ssfr_solver_local(solver, sink);
    double lo[3], hi[3];
    ssfr_solid_bounds(&local, lo, hi);
#pragma omp parallel for schedule(dynamic, SSFR_PASS_CHUNK)
    for (size_t i = 0; i < solver->n; i++) {
        double at[3], normal[3];
        bool inside = true;
        for (int k = 0; k < 3; k++) {
            at[k] = (double)solver->x[i][k];
            inside = inside && at[k] >= lo[k] && at[k] <= hi[k];
        }
        solver->spare_labels[i].id = inside && ssfr_solid_distance(&local, at, normal) < 0;
    }
    return drop_marked(solver);
}

/* ---- what others see --------------------------------------------------------------------------------------------- */

/* Sums are made when they are asked for first after particles came or went; then nothing else of the solver changes. */
static ssfr_result settle(const ssfr_solver *solver)
{
    ssfr_solver *s;
    memcpy(&s, &solver, sizeof s); /* made by create, hence not constant */
    return s->stale ? ssfr_solver_arrange(s) : SSFR_OK;
}

ssfr_fluid ssfr_solver_fluid(const ssfr_solver *solver)
{
    const size_t n = settle(solver) == SSFR_OK ? solver->n : 0;
    ssfr_fluid fluid = {.n = n, .position = solver->position, .velocity = solver->velocity,
                        .density = solver->density, .radius = solver->setup.radius, .grid = solver->grid};
    memcpy(fluid.origin, solver->origin, sizeof fluid.origin);
    return fluid;
}

uint32_t ssfr_solver_id(const ssfr_solver *solver, size_t i)
{
    return solver->labels[i].id;
}

ssfr_result ssfr_solver_export(const ssfr_solver *solver, ssfr_particles **out)
{
    ssfr_result result = SSFR_OK;
    double *positions = NULL;
    uint32_t *ids = NULL;
    float *ages = NULL;
    *out = NULL;
    SSFR_TRY(settle(solver));
    SSFR_TRY(ssfr_alloc(&positions, solver->n, 3 * sizeof *positions, "particles"));
    SSFR_TRY(ssfr_alloc(&ids, solver->n, sizeof *ids, "particles"));
    SSFR_TRY(ssfr_alloc(&ages, solver->n, sizeof *ages, "particles"));
    for (size_t i = 0; i < solver->n; i++) {
        for (size_t k = 0; k < 3; k++) positions[3 * i + k] = solver->origin[k] + (double)solver->position[3 * i + k];
        ids[i] = solver->labels[i].id;
        ages[i] = (float)(solver->time - solver->labels[i].birth);
    }
    const ssfr_particles given = {.velocity = solver->velocity, .density = solver->density, .age = ages, .id = ids,
                                  .neighbours = solver->neighbours, .radius = solver->setup.radius};
    SSFR_TRY(ssfr_particles_create(out, solver->n, positions, &given));
end:
    free(positions);
    free(ids);
    free(ages);
    return result;
}

/* ---- writing and reading ----------------------------------------------------------------------------------------- */

static const char magic[8] = "ssfrpbf";

typedef struct header {
    char magic[8];
    uint32_t version, next_id;
    uint64_t n, setup; /* particles; hash of the setup */
    double radius, time, felt_step;
} header;

typedef struct record { /* of a particle, in the solver's order */
    double birth;
    float x[3], v[3];
    uint32_t id;
    float density;
} record;

/* Of all that the bits of a step depend on but the radius, which is named when it differs. */
static uint64_t hash_setup(const ssfr_solver_setup *s)
{
    uint64_t hash = ssfr_hash_bytes(SSFR_HASH, s->gravity, sizeof s->gravity);
    hash = ssfr_hash_bytes(hash, s->lo, sizeof s->lo);
    hash = ssfr_hash_bytes(hash, s->hi, sizeof s->hi);
    hash = ssfr_hash_bytes(hash, s->open, sizeof s->open);
    for (const ssfr_param *row = ssfr_solver_rows; row->name; row++) {
        const double value = ssfr_param_number(row, &s->params);
        hash = ssfr_hash_bytes(hash, &value, sizeof value);
    }
    return hash;
}

ssfr_result ssfr_solver_write(const ssfr_solver *solver, FILE *file)
{
    header h = {.version = SSFR_SOLVER_VERSION, .next_id = solver->next_id, .n = solver->n,
                .setup = hash_setup(&solver->setup), .radius = solver->setup.radius, .time = solver->time,
                .felt_step = solver->felt_step};
    ssfr_result result = settle(solver);
    if (result != SSFR_OK) return result;
    memcpy(h.magic, magic, sizeof magic);
    bool ok = fwrite(&h, sizeof h, 1, file) == 1;
    for (size_t i = 0; i < solver->n && ok; i++) {
        const ssfr_lanes x = solver->x[i], v = solver->v[i];
        const record r = {.birth = solver->labels[i].birth, .x = {x[0], x[1], x[2]}, .v = {v[0], v[1], v[2]},
                          .id = solver->labels[i].id, .density = solver->density[i]};
        ok = fwrite(&r, sizeof r, 1, file) == 1;
    }
    return ok ? SSFR_OK : ssfr_fail(SSFR_ERR_IO, "solver: state of %zu particles cannot be written", solver->n);
}

/* Whether n records may follow in the file. */
static bool holds(FILE *file, uint64_t n)
{
    struct stat info;
    const off_t at = ftello(file);
    return at >= 0 && fstat(fileno(file), &info) == 0 && info.st_size >= at &&
           n <= (uint64_t)(info.st_size - at) / sizeof(record);
}

static ssfr_result read_header(const ssfr_solver *solver, FILE *file, header *h)
{
    if (fread(h, sizeof *h, 1, file) != 1) return ssfr_fail(SSFR_ERR_FORMAT, "solver: the state ends in its header");
    if (memcmp(h->magic, magic, sizeof magic) != 0 || h->version != SSFR_SOLVER_VERSION)
        return ssfr_fail(SSFR_ERR_FORMAT, "solver: not a state of version %d", SSFR_SOLVER_VERSION);
    if (h->radius != solver->setup.radius || h->n > solver->setup.max_particles)
        return ssfr_fail(SSFR_ERR_FORMAT, "solver: a state of %ju particles of radius %g m, not of this setup",
                         (uintmax_t)h->n, h->radius);
    if (h->setup != hash_setup(&solver->setup))
        return ssfr_fail(SSFR_ERR_FORMAT, "solver: a state of another domain, gravity or parameters");
    if (!(h->time >= 0 && isfinite(h->time) && h->felt_step >= 0 && isfinite(h->felt_step)))
        return ssfr_fail(SSFR_ERR_FORMAT, "solver: a state after %g s with steps of %g s", h->time, h->felt_step);
    if (!holds(file, h->n))
        return ssfr_fail(SSFR_ERR_FORMAT, "solver: the state ends before its %ju particles do", (uintmax_t)h->n);
    return SSFR_OK;
}

static ssfr_result read_record(ssfr_solver *solver, FILE *file, size_t i, const header *h)
{
    record r;
    if (fread(&r, sizeof r, 1, file) != 1)
        return ssfr_fail(SSFR_ERR_FORMAT, "solver: the state ends in particle %zu", i);
    bool ok = r.id < h->next_id && r.birth >= 0 && r.birth <= h->time;
    const double outside = 1.001 * (double)solver->kernel.support; /* as far as those that were added may stand */
    for (int k = 0; k < 3; k++)
        ok = ok && isfinite(r.v[k]) && (double)r.x[k] > solver->lo[k] - outside &&
             (double)r.x[k] < solver->hi[k] + outside;
    ok = ok && isfinite(r.density);
    if (!ok) return ssfr_fail(SSFR_ERR_FORMAT, "solver: the state's particle %zu is malformed", i);
    solver->x[i] = (ssfr_lanes){r.x[0], r.x[1], r.x[2], 0};
    solver->v[i] = (ssfr_lanes){r.v[0], r.v[1], r.v[2], 0};
    solver->labels[i] = (ssfr_label){.birth = r.birth, .id = r.id};
    solver->density[i] = r.density;
    return SSFR_OK;
}

ssfr_result ssfr_solver_read(ssfr_solver *solver, FILE *file)
{
    ssfr_result result = SSFR_OK;
    header h;
    SSFR_TRY(read_header(solver, file, &h));
    solver->n = 0; /* whatever happens from here on */
    solver->stale = true;
    SSFR_TRY(ssfr_solver_reserve(solver, (size_t)h.n));
    for (size_t i = 0; i < (size_t)h.n; i++) SSFR_TRY(read_record(solver, file, i, &h));
    solver->n = (size_t)h.n;
    solver->next_id = h.next_id;
    solver->time = h.time;
    solver->felt_step = h.felt_step;
    SSFR_TRY(ssfr_solver_sort(solver)); /* changes no order: what was written had been sorted */
    solver->stale = false;
end:
    return result;
}

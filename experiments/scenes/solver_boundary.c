/* SPDX-License-Identifier: GPL-3.0-or-later */
/* solver_boundary.c: walls of the domain and obstacles, as planes through the points of them that are nearest. All
 * places are relative to the solver's origin. */
#include "experiments/scenes/solver_internal.h"

#define TOUCHING 1.0 /* radii from a surface, below which there is friction */
#define LEAVING 0.1  /* radii a step, that a particle put too close to a surface is moved away */
#define SAME 0.9     /* cosine between the normals of surfaces that are taken for one */

/* An obstacle in this step. */
typedef struct moving {
    const ssfr_obstacle *obstacle;
    double lo[3], hi[3]; /* m, its bounds at the step's end */
    bool still;
    double turn;         /* bound on how much further than another a place moves, a metre between them */
} moving;

static double find_turn(const ssfr_obstacle *o)
{
    double sum = 0; /* of squares of (now^T before - 1) */
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            double entry = r == c ? -1 : 0;
            for (int k = 0; k < 3; k++) entry += o->now.axis[k][r] * o->before.axis[k][c];
            sum += entry * entry;
        }
    return sqrt(sum);
}

static moving prepare(const ssfr_obstacle *o)
{
    moving m = {.obstacle = o, .turn = find_turn(o)};
    m.still = memcmp(o->now.axis, o->before.axis, sizeof o->now.axis) == 0 &&
              memcmp(o->now.centre, o->before.centre, sizeof o->now.centre) == 0;
    ssfr_solid_bounds(&o->now, m.lo, m.hi);
    return m;
}

/* How far the solid carries a place that is `at` at the step's begin. */
static void carry(const ssfr_obstacle *o, const double at[3], double out[3])
{
    double local[3];
    ssfr_solid_local(&o->before, at, local);
    ssfr_solid_world(&o->now, local, out);
}

static void widen(ssfr_lanes x, double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = (double)x[k];
}

/* ---- finding ----------------------------------------------------------------------------------------------------- */

typedef struct finding {
    const moving *obstacles;
    int n_obstacles;
    double reach;   /* m, from which a surface is not felt */
    double closest; /* m */
    double rate;    /* m, that a particle found too close is moved away, a step; 0 outside of a step */
    ssfr_lanes x, moved; /* m, of the particle; x becomes the place that it is moved away to */
    int n;
    ssfr_contact found[SSFR_MAX_CONTACTS];
    double distance[SSFR_MAX_CONTACTS];
} finding;

/* Of surfaces that face the same way only the nearest is felt: a box that stands on the floor adds no second floor. */
static void add(finding *f, const double normal[3], const double on[3], double distance, double keep, int obstacle)
{
    int at = f->n;
    for (int c = 0; c < f->n; c++) {
        const float *other = f->found[c].normal;
        if ((double)other[0] * normal[0] + (double)other[1] * normal[1] + (double)other[2] * normal[2] > SAME) at = c;
    }
    if (at < f->n && f->distance[at] <= distance) return;
    if (at == SSFR_MAX_CONTACTS) return;
    f->found[at] = (ssfr_contact){{(float)normal[0], (float)normal[1], (float)normal[2]},
                                  (float)-ssfr_dot(normal, on), (float)keep, obstacle};
    f->distance[at] = distance;
    if (at == f->n) f->n++;
}

/* A particle that begins the step too close to a surface or behind it was put there. It is moved, not thrown: by what
 * this returns (m), without a velocity; out at once, but then slowly. *keep is how near it may come in this step. */
static double make_room(const finding *f, double begin, double *keep)
{
    const bool close = f->rate > 0 && begin < f->closest;
    const double shift = close ? fmin(fmax(-begin, 0) + f->rate, f->closest - begin) : 0;
    *keep = fmin(begin + shift, f->closest);
    return shift;
}

/* Walls around the place where the particle is going. */
static void find_walls(finding *f, const ssfr_solver *solver)
{
    for (int k = 0; k < 3; k++)
        for (int side = 0; side < 2; side++) {
            const double wall = side ? solver->hi[k] : solver->lo[k], out = side ? -1 : 1;
            if (solver->setup.open[2 * k + side]) continue;
            double keep;
            const double shift = make_room(f, out * ((double)f->x[k] - wall), &keep);
            if (shift > 0) f->x[k] = (float)((double)f->x[k] + out * shift);
            const double distance = out * ((double)f->x[k] + (double)f->moved[k] - wall);
            if (distance >= f->reach) continue;
            double normal[3] = {0}, on[3] = {0};
            normal[k] = out;
            on[k] = wall;
            add(f, normal, on, distance, keep, -1);
        }
}

static void shift_by(double at[3], double distance, const double normal[3])
{
    for (int k = 0; k < 3; k++) at[k] += distance * normal[k];
}

/* The contact with an obstacle near which the particle goes. Solids move; in the frame of the solid at the step's end
 * the particle goes from where the solid has carried its place to where it is predicted, and is stopped where it
 * enters. */
static void find_obstacle(finding *f, int o)
{
    const ssfr_solid *solid = &f->obstacles[o].obstacle->now;
    double from[3], to[3], path[3], normal[3], enter[3], on[3], keep = f->closest;
    widen(f->x, from);
    widen(f->x + f->moved, to);
    if (!f->obstacles[o].still) carry(f->obstacles[o].obstacle, from, from);
    for (int k = 0; k < 3; k++) path[k] = to[k] - from[k];
    double distance = ssfr_solid_distance(solid, to, normal), t = -1;
    if (distance < sqrt(ssfr_dot(path, path)) + f->closest) { /* it may have come through the surface, or begun there */
        const double shift = make_room(f, ssfr_solid_distance(solid, from, enter), &keep);
        if (shift > 0) {
            for (int k = 0; k < 3; k++) f->x[k] += (float)(shift * enter[k]);
            shift_by(from, shift, enter);
            shift_by(to, shift, enter);
            distance = ssfr_solid_distance(solid, to, normal);
        }
        t = ssfr_solid_enter(solid, from, path, enter);
    }
    memcpy(on, to, sizeof on);
    shift_by(on, -distance, normal);
    if (t >= 0 && t <= 1) {
        memcpy(on, from, sizeof on);
        shift_by(on, t, path);
        memcpy(normal, enter, sizeof normal);
        distance = ssfr_dot(normal, to) - ssfr_dot(normal, on);
    }
    if (distance >= f->reach) return;
    add(f, normal, on, distance, keep, o);
}

static double length(ssfr_lanes a)
{
    return sqrt((double)a[0] * (double)a[0] + (double)a[1] * (double)a[1] + (double)a[2] * (double)a[2]);
}

/* Bit o is set when a particle of the cell may feel obstacle o in this step. */
static uint64_t obstacles_near(const finding *f, const ssfr_solver *solver, ssfr_grid_range members)
{
    uint64_t near = 0;
    double at[3], normal[3], around = 0; /* m, from the first particle to any other and to where that goes */
    widen(solver->x[members.begin], at);
    for (size_t i = members.begin; i < members.end; i++) {
        const ssfr_lanes d = solver->x[i] - solver->x[members.begin];
        around = fmax(around, length(d) + length(solver->moved[i]));
    }
    for (int o = 0; o < f->n_obstacles; o++) {
        const moving *m = f->obstacles + o;
        double outside = 0, carried[3], limit = f->reach + 2 * around;
        if (!m->still) {
            carry(m->obstacle, at, carried);
            const double d[3] = {carried[0] - at[0], carried[1] - at[1], carried[2] - at[2]};
            limit += sqrt(ssfr_dot(d, d)) + m->turn * around;
        }
        for (int k = 0; k < 3; k++) outside += ssfr_square(fmax(fmax(m->lo[k] - at[k], at[k] - m->hi[k]), 0));
        if (outside < limit * limit && ssfr_solid_distance(&m->obstacle->now, at, normal) < limit)
            near |= (uint64_t)1 << o;
    }
    return near;
}

/* Places that particles are moved to go to `at`: x stays, for a second attempt to begin with. */
static void find_in_cell(ssfr_solver *solver, const finding *all, size_t cell, size_t *used)
{
    const ssfr_grid_range members = ssfr_grid_cell_at(solver->grid, cell);
    const uint64_t near = obstacles_near(all, solver, members);
    for (size_t i = members.begin; i < members.end; i++) {
        finding f = *all;
        size_t begin;
        f.x = solver->x[i];
        f.moved = solver->moved[i];
        find_walls(&f, solver);
        for (int o = 0; o < f.n_obstacles && near; o++)
            if (near >> o & 1) find_obstacle(&f, o);
        solver->at[i] = f.x;
        solver->labels[i].n_contacts = (uint8_t)f.n;
        if (!f.n) continue;
#pragma omp atomic capture
        {
            begin = *used;
            *used += (size_t)f.n;
        }
        solver->labels[i].contact_begin = (uint32_t)begin;
        if (begin + (size_t)f.n <= solver->contacts_capacity)
            memcpy(solver->contacts + begin, f.found, (size_t)f.n * sizeof *f.found);
    }
}

ssfr_result ssfr_solver_find_contacts(ssfr_solver *solver, bool in_step, int n_obstacles,
                                      const ssfr_obstacle *obstacles)
{
    ssfr_result result = SSFR_OK;
    moving prepared[SSFR_MAX_OBSTACLES];
    const double radius = solver->setup.radius;
    for (int o = 0; o < n_obstacles; o++) prepared[o] = prepare(obstacles + o);
    /* Corrections in the step may move a particle closer by about a radius. */
    const finding all = {.obstacles = prepared, .n_obstacles = n_obstacles, .closest = solver->closest,
                         .rate = in_step ? LEAVING * radius : 0, .reach = (double)solver->kernel.support + radius};
    for (;;) {
        const size_t n_cells = ssfr_grid_n_cells(solver->grid);
        size_t used = 0;
#pragma omp parallel for schedule(dynamic, 32)
        for (size_t c = 0; c < n_cells; c++) find_in_cell(solver, &all, c, &used);
        if (used <= solver->contacts_capacity) break;
        free(solver->contacts);
        solver->contacts = NULL;
        solver->contacts_capacity = 0;
        SSFR_TRY(ssfr_alloc(&solver->contacts, used + used / 8, sizeof *solver->contacts, "contacts"));
        solver->contacts_capacity = used + used / 8;
    }
    ssfr_lanes *const x = solver->x;
    solver->x = solver->at, solver->at = x;
end:
    return result;
}

/* ---- using ------------------------------------------------------------------------------------------------------- */

static float distance_from(const ssfr_contact *contact, ssfr_lanes x)
{
    const float *n = contact->normal;
    return n[0] * x[0] + n[1] * x[1] + n[2] * x[2] + contact->offset;
}

/* Where surfaces meet, what is left free by all of them is the product of what each leaves free: exact for walls at
 * right angles if kernels were Gaussians. */
float ssfr_solver_boundary(const ssfr_solver *solver, size_t i, ssfr_lanes x, float gradient[3])
{
    float free = 1;
    gradient[0] = gradient[1] = gradient[2] = 0;
    for (int c = 0; c < solver->labels[i].n_contacts; c++) {
        const ssfr_contact *contact = solver->contacts + solver->labels[i].contact_begin + (uint32_t)c;
        const float *n = contact->normal, per_support = solver->kernel.per_support;
        float slope;
        const float behind =
            ssfr_kernel_behind((distance_from(contact, x) + solver->wall) * per_support, &slope);
        /* d/dx (1 - free (1 - behind)) */
        for (int k = 0; k < 3; k++) gradient[k] = gradient[k] * (1 - behind) + free * slope * per_support * n[k];
        free *= 1 - behind;
    }
    return 1 - free;
}

ssfr_lanes ssfr_solver_project(const ssfr_solver *solver, size_t i, ssfr_lanes x)
{
    for (int c = 0; c < solver->labels[i].n_contacts; c++) {
        const ssfr_contact *contact = solver->contacts + solver->labels[i].contact_begin + (uint32_t)c;
        const float short_by = contact->keep - distance_from(contact, x);
        if (short_by > 0)
            for (int k = 0; k < 3; k++) x[k] += short_by * contact->normal[k];
    }
    return x;
}

/* Takes away a share of the particle's motion along the surface, relative to the solid. */
static void rub(ssfr_solver *solver, size_t i, const ssfr_obstacle *obstacle, const double normal[3], double share)
{
    double at[3], motion[3], slip[3];
    widen(solver->x[i] + solver->moved[i], at);
    ssfr_obstacle_motion(obstacle, at, motion);
    for (int k = 0; k < 3; k++) slip[k] = (double)solver->moved[i][k] - motion[k];
    const double along = ssfr_dot(slip, normal);
    for (int k = 0; k < 3; k++)
        solver->moved[i][k] -= (float)(share * (slip[k] - along * normal[k]));
}

/* A contact with an obstacle at the step's end, with the exact distance where its plane was only near. */
static void finish_obstacle(ssfr_solver *solver, size_t i, double dt, const ssfr_contact *contact,
                            const ssfr_obstacle *obstacle)
{
    const double touching = TOUCHING * solver->setup.radius;
    const ssfr_lanes x = solver->x[i] + solver->moved[i];
    double at[3], normal[3];
    if ((double)distance_from(contact, x) > touching) return;
    widen(x, at);
    const double distance = ssfr_solid_distance(&obstacle->now, at, normal);
    const double short_by = (double)contact->keep - distance;
    if (short_by > 0)
        for (int k = 0; k < 3; k++) solver->moved[i][k] += (float)(short_by * normal[k]);
    /* Drag that takes away the share `friction` in a step of max_step, by the implicit Euler scheme. */
    const double part = obstacle->friction * dt / solver->setup.params.max_step;
    const double share = part / fmax(1 - obstacle->friction + part, 1e-300);
    if (obstacle->friction > 0 && distance < touching) rub(solver, i, obstacle, normal, share);
}

static void finish(ssfr_solver *solver, size_t i, double dt, const ssfr_obstacle *obstacles)
{
    for (int c = 0; c < solver->labels[i].n_contacts; c++) {
        const ssfr_contact *contact = solver->contacts + solver->labels[i].contact_begin + (uint32_t)c;
        if (contact->obstacle >= 0) finish_obstacle(solver, i, dt, contact, obstacles + contact->obstacle);
    }
    for (int k = 0; k < 3; k++) { /* whatever obstacles did, nothing leaves by a wall */
        const double end = (double)solver->x[i][k] + (double)solver->moved[i][k];
        if (!solver->setup.open[2 * k] && end < solver->lo[k]) solver->moved[i][k] += (float)(solver->lo[k] - end);
        if (!solver->setup.open[2 * k + 1] && end > solver->hi[k]) solver->moved[i][k] -= (float)(end - solver->hi[k]);
    }
}

void ssfr_solver_finish_contacts(ssfr_solver *solver, double dt, const ssfr_obstacle *obstacles)
{
#pragma omp parallel for schedule(dynamic, SSFR_PASS_CHUNK)
    for (size_t i = 0; i < solver->n; i++)
        if (solver->labels[i].n_contacts) finish(solver, i, dt, obstacles);
}

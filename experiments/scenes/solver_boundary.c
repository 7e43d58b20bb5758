/* SPDX-License-Identifier: GPL-3.0-or-later */
/* solver_boundary.c: walls of the domain and obstacles, as planes through the points of them that are nearest. */
#include "experiments/scenes/solver_internal.h"

#define TOUCHING 1.0 /* radii, below which there is friction */
#define SAME 0.9     /* cosine between the normals of surfaces that are taken for one */

/* An obstacle in this step. */
typedef struct moving {
    const ssfr_obstacle *obstacle;
    double lo[3], hi[3]; /* m, world, its bounds at the step's end */
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

static void to_world(const ssfr_solver *solver, ssfr_lanes x, double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = solver->origin[k] + (double)x[k];
}

static void to_local(const ssfr_solver *solver, const double world[3], ssfr_lanes *x)
{
    for (int k = 0; k < 3; k++) (*x)[k] = (float)(world[k] - solver->origin[k]);
}

/* ---- finding ------------------------------------------------------------------------------------------------------ */

typedef struct finding {
    const ssfr_solver *solver;
    const moving *obstacles;
    int n_obstacles;
    double reach; /* m, from which a surface is not felt */
    double closest; /* m */
    int n;
    ssfr_contact found[SSFR_MAX_CONTACTS];
    double distance[SSFR_MAX_CONTACTS];
} finding;

/* Of surfaces that face the same way only the nearest is felt: a box that stands on the floor adds no second floor. */
static void add(finding *f, const double normal[3], const double on[3], double distance, int obstacle)
{
    int at = f->n;
    for (int c = 0; c < f->n; c++) {
        const float *other = f->found[c].normal;
        if ((double)other[0] * normal[0] + (double)other[1] * normal[1] + (double)other[2] * normal[2] > SAME) at = c;
    }
    if (at < f->n && f->distance[at] <= distance) return;
    if (at == SSFR_MAX_CONTACTS) return;
    f->found[at] = (ssfr_contact){{(float)normal[0], (float)normal[1], (float)normal[2]},
                                  (float)-ssfr_dot(normal, on), obstacle};
    f->distance[at] = distance;
    if (at == f->n) f->n++;
}

/* Walls around the place where particle i is going. One that begins outside is put on the wall, without a velocity. */
static void find_walls(finding *f, ssfr_solver *solver, size_t i)
{
    for (int k = 0; k < 3; k++)
        for (int side = 0; side < 2; side++) {
            const double wall = side ? solver->hi[k] : solver->lo[k], out = side ? -1 : 1;
            if (solver->setup.open[2 * k + side]) continue;
            const double begin = out * ((double)solver->x[i][k] - wall);
            if (begin < 0) solver->x[i][k] = (float)(wall + out * f->closest);
            const double distance = out * ((double)solver->x[i][k] + (double)solver->moved[i][k] - wall);
            if (distance >= f->reach) continue;
            double normal[3] = {0}, on[3] = {0};
            normal[k] = out;
            on[k] = wall;
            add(f, normal, on, distance, -1);
        }
}

/* The contact with an obstacle near which particle i goes. Solids move; in the frame of the solid at the step's end the
 * particle goes from where the solid has carried its place to where it is predicted, and is stopped where it enters. */
static void find_obstacle(finding *f, ssfr_solver *solver, size_t i, int o)
{
    const ssfr_obstacle *obstacle = f->obstacles[o].obstacle;
    double from[3], to[3], path[3], normal[3], on[3];
    to_world(solver, solver->x[i], from);
    to_world(solver, solver->x[i] + solver->moved[i], to);
    if (!f->obstacles[o].still) carry(obstacle, from, from);
    for (int k = 0; k < 3; k++) path[k] = to[k] - from[k];
    double distance = ssfr_solid_distance(&obstacle->now, to, normal);
    for (int k = 0; k < 3; k++) on[k] = to[k] - distance * normal[k];
    const double length = sqrt(ssfr_dot(path, path));
    if (distance < length) { /* it may have come through the surface */
        double begin_normal[3];
        const double begin = ssfr_solid_distance(&obstacle->now, from, begin_normal);
        if (begin < 0) { /* it was inside before: out, without a velocity */
            double world[3];
            to_world(solver, solver->x[i], world);
            for (int k = 0; k < 3; k++) world[k] += (f->closest - begin) * begin_normal[k];
            to_local(solver, world, &solver->x[i]);
            for (int k = 0; k < 3; k++) {
                on[k] = from[k] - begin * begin_normal[k];
                normal[k] = begin_normal[k];
                to[k] += (f->closest - begin) * begin_normal[k];
            }
        } else {
            double enter_normal[3];
            const double t = ssfr_solid_enter(&obstacle->now, from, path, enter_normal);
            if (t >= 0 && t <= 1)
                for (int k = 0; k < 3; k++) {
                    on[k] = from[k] + t * path[k];
                    normal[k] = enter_normal[k];
                }
        }
        distance = 0;
        for (int k = 0; k < 3; k++) distance += normal[k] * (to[k] - on[k]);
    }
    if (distance < f->reach) {
        for (int k = 0; k < 3; k++) on[k] -= solver->origin[k];
        add(f, normal, on, distance, o);
    }
}

/* Bit o is set when a particle of the cell may feel obstacle o in this step. */
static uint64_t obstacles_near(const finding *f, const ssfr_solver *solver, ssfr_grid_range members)
{
    uint64_t near = 0;
    double at[3], normal[3], longest = 0;
    to_world(solver, solver->x[members.begin], at);
    for (size_t i = members.begin; i < members.end; i++) {
        const ssfr_lanes m = solver->moved[i];
        longest = fmax(longest, sqrt((double)(m[0] * m[0] + m[1] * m[1] + m[2] * m[2])));
    }
    /* From the first particle to any other and to where that goes. */
    const double around = sqrt(3) * 1.001 * (double)solver->kernel.support + longest;
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

static void find_in_cell(ssfr_solver *solver, const finding *all, size_t cell, size_t *used)
{
    const ssfr_grid_range members = ssfr_grid_cell_at(solver->grid, cell);
    const uint64_t near = obstacles_near(all, solver, members);
    for (size_t i = members.begin; i < members.end; i++) {
        finding f = *all;
        size_t begin;
        find_walls(&f, solver, i);
        for (int o = 0; o < f.n_obstacles && near; o++)
            if (near >> o & 1) find_obstacle(&f, solver, i, o);
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

ssfr_result ssfr_solver_find_contacts(ssfr_solver *solver, int n_obstacles, const ssfr_obstacle *obstacles)
{
    ssfr_result result = SSFR_OK;
    moving prepared[SSFR_MAX_OBSTACLES];
    const double radius = solver->setup.radius;
    for (int o = 0; o < n_obstacles; o++) prepared[o] = prepare(obstacles + o);
    /* Corrections in the step may move a particle closer by about a radius. */
    const finding all = {.solver = solver, .obstacles = prepared, .n_obstacles = n_obstacles,
                         .reach = (double)solver->kernel.support + radius, .closest = solver->closest};
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
end:
    return result;
}

/* ---- using -------------------------------------------------------------------------------------------------------- */

/* Where surfaces meet, what is left free by all of them is the product of what each leaves free: exact for walls at
 * right angles if kernels were Gaussians. */
float ssfr_solver_boundary(const ssfr_solver *solver, size_t i, ssfr_lanes x, float gradient[3])
{
    float free = 1;
    gradient[0] = gradient[1] = gradient[2] = 0;
    for (int c = 0; c < solver->labels[i].n_contacts; c++) {
        const ssfr_contact *contact = solver->contacts + solver->labels[i].contact_begin + (uint32_t)c;
        const float *n = contact->normal, per_support = solver->kernel.per_support;
        const float distance = n[0] * x[0] + n[1] * x[1] + n[2] * x[2] + contact->offset + solver->wall;
        float slope;
        const float behind = ssfr_kernel_behind(distance * per_support, &slope);
        /* d/dx (1 - free (1 - behind)) */
        for (int k = 0; k < 3; k++) gradient[k] = gradient[k] * (1 - behind) + free * slope * per_support * n[k];
        free *= 1 - behind;
    }
    return 1 - free;
}

ssfr_lanes ssfr_solver_project(const ssfr_solver *solver, size_t i, ssfr_lanes x)
{
    const float closest = (float)solver->closest;
    for (int c = 0; c < solver->labels[i].n_contacts; c++) {
        const ssfr_contact *contact = solver->contacts + solver->labels[i].contact_begin + (uint32_t)c;
        const float *n = contact->normal;
        const float short_by = closest - (n[0] * x[0] + n[1] * x[1] + n[2] * x[2] + contact->offset);
        if (short_by > 0)
            for (int k = 0; k < 3; k++) x[k] += short_by * n[k];
    }
    return x;
}

/* Takes away a share of the particle's motion along the surface, relative to the solid. */
static void rub(ssfr_solver *solver, size_t i, const ssfr_obstacle *obstacle, const double normal[3], double share)
{
    double at[3], motion[3], slip[3];
    to_world(solver, solver->x[i] + solver->moved[i], at);
    ssfr_obstacle_motion(obstacle, at, motion);
    for (int k = 0; k < 3; k++) slip[k] = (double)solver->moved[i][k] - motion[k];
    const double along = ssfr_dot(slip, normal);
    for (int k = 0; k < 3; k++)
        solver->moved[i][k] -= (float)(share * (slip[k] - along * normal[k]));
}

static void finish(ssfr_solver *solver, size_t i, double dt, const ssfr_obstacle *obstacles)
{
    const double radius = solver->setup.radius, closest = solver->closest;
    for (int c = 0; c < solver->labels[i].n_contacts; c++) {
        const ssfr_contact *contact = solver->contacts + solver->labels[i].contact_begin + (uint32_t)c;
        const float *n = contact->normal;
        if (contact->obstacle < 0) continue;
        const ssfr_lanes x = solver->x[i] + solver->moved[i];
        const float near = n[0] * x[0] + n[1] * x[1] + n[2] * x[2] + contact->offset;
        if ((double)near > TOUCHING * radius) continue;
        const ssfr_obstacle *o = obstacles + contact->obstacle;
        double at[3], normal[3];
        to_world(solver, x, at);
        const double distance = ssfr_solid_distance(&o->now, at, normal);
        if (distance < closest)
            for (int k = 0; k < 3; k++) solver->moved[i][k] += (float)((closest - distance) * normal[k]);
        if (o->friction > 0 && distance < TOUCHING * radius)
            rub(solver, i, o, normal, 1 - pow(1 - o->friction, dt / solver->setup.params.max_step));
    }
    for (int k = 0; k < 3; k++) { /* whatever obstacles did, nothing leaves by a wall */
        const double end = (double)solver->x[i][k] + (double)solver->moved[i][k];
        if (!solver->setup.open[2 * k] && end < solver->lo[k] + closest)
            solver->moved[i][k] += (float)(solver->lo[k] + closest - end);
        if (!solver->setup.open[2 * k + 1] && end > solver->hi[k] - closest)
            solver->moved[i][k] -= (float)(end - (solver->hi[k] - closest));
    }
}

void ssfr_solver_finish_contacts(ssfr_solver *solver, double dt, const ssfr_obstacle *obstacles)
{
#pragma omp parallel for schedule(dynamic, SSFR_PASS_CHUNK)
    for (size_t i = 0; i < solver->n; i++)
        if (solver->labels[i].n_contacts) finish(solver, i, dt, obstacles);
}

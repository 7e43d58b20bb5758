/* SPDX-License-Identifier: GPL-3.0-or-later */
/* walls.c: what keeps loose particles in: distances, the share of a ball that is free, paths that end at walls. */
#include "experiments/scenes/walls.h"

ssfr_result ssfr_walls_init(ssfr_walls *walls, const ssfr_domain *domain, double support, double dt, int n,
                            const ssfr_obstacle *obstacles)
{
    if (n < 0 || n > SSFR_MAX_SOLIDS)
        return ssfr_fail(SSFR_ERR_VALUE, "%d obstacles: from 0 to %d may be there", n, SSFR_MAX_SOLIDS);
    *walls = (ssfr_walls){.n = n, .obstacles = obstacles, .domain = domain, .support = support, .dt = dt};
    for (int i = 0; i < n; i++) {
        ssfr_walls_box before, *reach = walls->reach + i;
        ssfr_solid_bounds(&obstacles[i].before, before.lo, before.hi);
        ssfr_solid_bounds(&obstacles[i].now, reach->lo, reach->hi);
        for (int k = 0; k < 3; k++) {
            reach->lo[k] = fmin(reach->lo[k], before.lo[k]) - support;
            reach->hi[k] = fmax(reach->hi[k], before.hi[k]) + support;
        }
    }
    return SSFR_OK;
}

/* Whether the box between two places meets the other. */
static bool meets(const ssfr_walls_box *box, const double a[3], const double b[3])
{
    bool all = true;
    for (int k = 0; k < 3; k++) all = all && fmax(a[k], b[k]) >= box->lo[k] && fmin(a[k], b[k]) <= box->hi[k];
    return all;
}

static double side_distance(const ssfr_domain *domain, int side, const double at[3], double normal[3])
{
    const int k = side / 2;
    const bool high = side % 2 == 1;
    normal[0] = normal[1] = normal[2] = 0;
    normal[k] = high ? -1 : 1;
    return domain->open[side] ? INFINITY : high ? domain->hi[k] - at[k] : at[k] - domain->lo[k];
}

double ssfr_walls_distance(const ssfr_walls *walls, int i, const double at[3], double normal[3])
{
    if (i >= walls->n) return side_distance(walls->domain, i - walls->n, at, normal);
    if (!meets(walls->reach + i, at, at)) return INFINITY;
    return ssfr_solid_distance(&walls->obstacles[i].now, at, normal);
}

double ssfr_walls_free(const ssfr_walls *walls, const double at[3])
{
    double share = 1, normal[3];
    for (int i = 0; i < ssfr_walls_count(walls); i++) {
        const double x = ssfr_clamp(ssfr_walls_distance(walls, i, at, normal) / walls->support, 0, 1);
        share *= 1 - ssfr_square(1 - x) * (2 + x) / 4; /* without the cap of the unit ball beyond x */
    }
    return share;
}

bool ssfr_domain_leaves(const ssfr_domain *domain, const double at[3])
{
    bool leaves = false;
    for (int k = 0; k < 3; k++) leaves = leaves || at[k] < domain->lo[k] || at[k] > domain->hi[k];
    return leaves;
}

/* ---- paths ------------------------------------------------------------------------------------------------------- */

/* Takes from v what points into the obstacle, and friction's share of what runs along it. */
static void stop(const ssfr_obstacle *obstacle, const double at[3], const double normal[3], double dt, double v[3])
{
    double wall[3], relative[3];
    ssfr_obstacle_motion(obstacle, at, wall);
    for (int k = 0; k < 3; k++) wall[k] /= dt, relative[k] = v[k] - wall[k];
    const double outwards = ssfr_dot(relative, normal);
    for (int k = 0; k < 3 && outwards < 0; k++)
        v[k] = wall[k] + (1 - obstacle->friction) * (relative[k] - outwards * normal[k]);
}

/* True when the path met the obstacle and was changed. */
static bool meet_obstacle(const ssfr_obstacle *obstacle, double dt, const double from[3], double at[3], double v[3])
{
    double local[3], start[3], path[3], normal[3], face[3];
    double distance = ssfr_solid_distance(&obstacle->now, at, normal);
    ssfr_solid_local(&obstacle->before, from, local); /* The path as the solid sees it, */
    ssfr_solid_world(&obstacle->now, local, start);   /* which moves itself. */
    for (int k = 0; k < 3; k++) path[k] = at[k] - start[k];
    /* Farther away than it came, it did not pass through. */
    if (distance >= sqrt(ssfr_dot(path, path))) return false;
    const double t = ssfr_solid_enter(&obstacle->now, start, path, face);
    const bool entered = t > 0 && t <= 1;
    if (!entered && distance >= 0) return false;
    if (entered) { /* the rest of the path, along the face */
        const double outwards = (1 - t) * ssfr_dot(path, face);
        for (int k = 0; k < 3; k++) at[k] -= outwards * face[k];
        distance = ssfr_solid_distance(&obstacle->now, at, normal);
    }
    for (int k = 0; k < 3 && distance < 0; k++) at[k] -= distance * normal[k];
    stop(obstacle, at, entered ? face : normal, dt, v);
    return true;
}

static bool meet_sides(const ssfr_domain *domain, double at[3], double v[3])
{
    bool met = false;
    for (int side = 0; side < SSFR_DOMAIN_SIDES; side++) {
        double normal[3];
        const int k = side / 2;
        if (side_distance(domain, side, at, normal) >= 0) continue;
        at[k] = side % 2 ? domain->hi[k] : domain->lo[k];
        if (v[k] * normal[k] < 0) v[k] = 0;
        met = true;
    }
    return met;
}

void ssfr_walls_keep(const ssfr_walls *walls, const double from[3], double at[3], double v[3])
{
    enum { ROUNDS = 4 }; /* where walls meet, one may push into the next */
    bool met = true;
    for (int round = 0; round < ROUNDS && met; round++) {
        met = false;
        for (int i = 0; i < walls->n; i++)
            if (meets(walls->reach + i, from, at))
                met = meet_obstacle(walls->obstacles + i, walls->dt, from, at, v) || met;
        met = meet_sides(walls->domain, at, v) || met;
    }
}
